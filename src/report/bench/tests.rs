use super::*;

/// A trial of 2 s in which relMSE is `relative_mse`, with a reference whose own share is 0.001.
pub(super) fn trial(integrator: &str, budget: &str, seed: u64, relative_mse: f64) -> Trial {
    Trial {
        scene: "box, small".to_owned(),
        integrator: integrator.to_owned(),
        budget: budget.to_owned(),
        seed,
        wall_seconds: 2.5,
        cpu_seconds: 2.0,
        overrun_seconds: 0.0,
        work: Some(Work {
            passes: 8,
            samples: 8,
            paths: 100,
            rays: 300,
            rejected: 0,
        }),
        errors: Errors {
            mse: 0.5,
            luminance_mse: 0.25,
            relative_mse,
            reference_noise: Some(0.001),
            mean_ratio: 1.0 + 0.1 * seed as f64,
            flip: 0.1,
        },
        statistics: vec![("Mpaths/CPU s".to_owned(), 0.5)],
    }
}

fn bench() -> Bench {
    let mut other = trial("direct", "1 s", 1, 0.0015);
    other.statistics.push(("acceptance".to_owned(), 0.75));
    let trials = vec![
        trial("path", "1 s", 1, 0.021),
        other,
        trial("path", "1 s", 2, 0.041),
        trial("path", "1 s", 3, 0.031),
    ];
    Bench {
        about: vec![("command".to_owned(), "lumiflow bench".to_owned())],
        scenes: vec![BenchScene {
            name: "box, small".to_owned(),
            file: "box.xml".to_owned(),
            size: (4, 3),
            pixels: 10,
            reference: "reference.exr".to_owned(),
            reference_variance: None,
            mask: Some("mask.png".to_owned()),
            integrators: vec![(
                "path".to_owned(),
                vec![("max_depth".to_owned(), "-1".to_owned())],
            )],
        }],
        trials,
        missed: Vec::new(),
        wanted: 6,
    }
}

#[test]
fn measures_stand_in_their_order() {
    for (index, (_, measure)) in Measure::NAMES.into_iter().enumerate() {
        assert_eq!(measure as usize, index);
    }
}

#[test]
fn the_constant_is_error_without_the_references_noise_times_processor_time() {
    let mut found = trial("path", "1 s", 1, 0.021);
    assert!((Measure::EfficiencyConstant.of(&found) - 0.02 * 2.0).abs() < 1e-12);
    found.errors.reference_noise = None;
    assert!((Measure::EfficiencyConstant.of(&found) - 0.021 * 2.0).abs() < 1e-12);
    assert!(Measure::Corrected.of(&found).is_nan());
    assert!(found.is_beyond_noise());
}

#[test]
fn seeds_are_put_together() {
    let standings = standings(&bench().trials);
    let names: Vec<_> = standings.iter().map(|s| s.integrator.as_str()).collect();
    assert_eq!(names, ["path", "direct"]);
    let path = &standings[0];
    assert_eq!((path.seeds, path.beyond_noise), (3, true));
    let efficiency = path.spread(Measure::EfficiencyConstant);
    assert!((efficiency.median - 0.06).abs() < 1e-12);
    assert!((efficiency.min - 0.04).abs() < 1e-12);
    assert!((efficiency.max - 0.08).abs() < 1e-12);
    // 1.1, 1.2 and 1.3: a sample variance of 0.01 over three.
    assert!((path.ratio.value - 1.2).abs() < 1e-12);
    let error = path.ratio.standard_error.unwrap();
    assert!((error - 0.1 / 3.0_f64.sqrt()).abs() < 1e-12);
    assert!(!standings[1].beyond_noise);
}

#[test]
fn the_table_shows_what_some_integrators_tell_and_what_is_not_to_be_trusted() {
    let text = bench().markdown();
    let lines: Vec<&str> = text.lines().collect();
    let cells = |line: &str| -> Vec<String> {
        let cells = line.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let head = cells(lines[0]);
    assert_eq!(head[..3], ["scene", "integrator", "budget"]);
    assert_eq!(head.len(), 14);
    let path = cells(lines[2]);
    assert_eq!(path[3..6], ["3", "2.00", "0.500"]);
    let rest = [
        "1.2000 ± 0.0577",
        "0.250",
        "2.00",
        "0.0600",
        "0.0400 … 0.0800",
    ];
    assert_eq!(path[9..], rest);
    let direct = cells(lines[3]);
    assert_eq!(
        (direct[6].as_str(), direct[9].as_str()),
        ("! 0.00150", "1.1000")
    );
    let work = lines
        .iter()
        .rposition(|line| line.contains("wall s"))
        .unwrap();
    let head = cells(lines[work]);
    let columns = ["wall s", "passes", "spp", "Mpaths/CPU s", "acceptance"];
    assert_eq!(head[3..], columns);
    assert_eq!(
        cells(lines[work + 2])[3..],
        ["2.50", "8", "8", "0.500", "–"]
    );
    assert_eq!(cells(lines[work + 3])[7], "0.750");
    for part in [
        "- box, small: 10 of 12 pixels count; the reference's noise is 0.00100.",
        "- ! relMSE is below",
        "- Incomplete: 4 of 6 renders.",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn every_trial_is_a_line_of_csv() {
    let text = String::from_utf8(bench().csv().unwrap()).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5);
    assert!(
        lines[0].starts_with("scene,integrator,budget,seed,wall_s,cpu_s,overrun_s,passes,spp,mse,")
    );
    assert!(lines[0].ends_with("efficiency_constant,paths,rays,rejected,Mpaths/CPU s,acceptance"));
    assert!(lines[1].starts_with("\"box, small\",path,1 s,1,2.5,2,0,8,8,0.5,0.021,0.001,"));
    assert!(lines[1].ends_with(",100,300,0,0.5,") && lines[2].ends_with(",0.5,0.75"));
}

#[test]
fn all_of_it_is_in_the_json() {
    let all = bench().json();
    assert_eq!(all["command"], "lumiflow bench");
    assert_eq!(all["complete"], false);
    assert_eq!(all["scenes"][0]["integrators"]["path"]["max_depth"], -1);
    assert!(all["scenes"][0]["reference_variance"].is_null());
    assert_eq!(all["runs"].as_array().unwrap().len(), 4);
    assert_eq!(all["runs"][1]["statistics"]["acceptance"], 0.75);
    assert_eq!(all["runs"][0]["passes"], 8);
    assert_eq!(all["summary"][0]["seeds"], 3);
    assert_eq!(all["summary"][0]["cpu_s"]["median"], 2.0);
    assert!(
        all["summary"][0]["efficiency_constant"]["upper_quartile"]
            .as_f64()
            .unwrap()
            > 0.06
    );
    assert!(all["summary"][1]["mean_ratio"]["standard_error"].is_null());
}

#[test]
fn err_and_eff_are_those_of_the_paper() {
    // Two pixels whose luminances differ by 0.5 and 0.1, in 2 s.
    let row = |values: [f32; 2]| crate::report::Pixels {
        width: 2,
        height: 1,
        colours: values.map(crate::math::Rgb::grey).to_vec(),
    };
    let (image, reference) = (row([1.5, 0.4]), row([1.0, 0.5]));
    let subject = crate::report::Subject {
        image: &image,
        reference: &reference,
        variance: None,
        reference_variance: None,
        counted: &[],
    };
    let mut found = trial("path", "1 s", 1, 0.0);
    found.errors = Errors::of(&subject, 0.0);
    let err = (0.25 + 0.01) / 2.0;
    assert!((Measure::Err.of(&found) - err).abs() < 1e-6);
    assert!((Measure::Eff.of(&found) - 1.0 / (2.0 * err)).abs() < 1e-4);
}

#[test]
fn what_failed_and_what_overran_is_named() {
    let mut bench = bench();
    bench.trials[0].overrun_seconds = 0.5;
    let missed = |integrator: &str, seed| Missed {
        scene: "box, small".to_owned(),
        integrator: integrator.to_owned(),
        budget: "1 s".to_owned(),
        seed,
        reason: "it wrote no picture".to_owned(),
    };
    bench.missed = vec![missed("peer", 1), missed("peer", 2), missed("path", 4)];
    let text = bench.markdown();
    let rows = text.lines().filter(|line| line.contains("| peer "));
    let rows: Vec<&str> = rows.collect();
    assert_eq!(rows.len(), 1, "{text}");
    assert!(rows[0].contains("|     0 |"), "{text}");
    for part in [
        "- FAILED: box, small peer 1 s seed 2: it wrote no picture",
        "- FAILED: box, small path 1 s seed 4: it wrote no picture",
        "- box, small path 1 s: over the budget by up to 0.500 s.",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let all = bench.json();
    assert_eq!(all["failures"].as_array().unwrap().len(), 3);
    assert_eq!(all["failures"][0]["reason"], "it wrote no picture");
}

#[test]
fn peers_tell_nothing_of_their_work() {
    let mut bench = bench();
    bench.trials[0].work = None;
    let text = String::from_utf8(bench.csv().unwrap()).unwrap();
    let line = text.lines().nth(1).unwrap();
    assert!(
        line.contains(",1,2.5,2,0,,,0.5,") && line.ends_with(",,,,0.5,"),
        "{line}"
    );
    let all = bench.json();
    assert!(all["runs"][0]["passes"].is_null() && all["runs"][0]["paths"].is_null());
}

#[test]
fn options_keep_their_kinds() {
    use serde_json::json;
    assert_eq!(option_value("true"), json!(true));
    assert_eq!(option_value("-1"), json!(-1));
    assert_eq!(option_value("0.5"), json!(0.5));
    assert_eq!(option_value("power"), json!("power"));
}
