use super::*;
use crate::report::Ratio;

/// A trial of 2 s in which relMSE is `relative_mse`, with a reference whose own share is 0.001.
fn trial(integrator: &str, budget: &str, seed: u64, relative_mse: f64) -> Trial {
    let ratio = Ratio {
        value: 1.0 + 0.1 * seed as f64,
        standard_error: None,
    };
    Trial {
        scene: "box, small".to_owned(),
        integrator: integrator.to_owned(),
        budget: budget.to_owned(),
        seed,
        wall_seconds: 2.5,
        cpu_seconds: 2.0,
        passes: 8,
        samples: 8,
        counters: Counters {
            paths: 100,
            rays: 300,
            rejected: 0,
            ..Counters::default()
        },
        comparison: Comparison {
            pixels: 10,
            mse: 0.5,
            relative_mse,
            reference_noise: Some(0.001),
            ratios: [ratio; 4],
        },
        flip: 0.1,
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
    assert!((Measure::Efficiency.of(&found) - 0.02 * 2.0).abs() < 1e-12);
    found.comparison.reference_noise = None;
    assert!((Measure::Efficiency.of(&found) - 0.021 * 2.0).abs() < 1e-12);
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
    let efficiency = path.spread(Measure::Efficiency);
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
    assert_eq!(head[12..], ["Mpaths/CPU s", "acceptance"]);
    let path = cells(lines[2]);
    assert_eq!(path[3..6], ["3", "2.00", "8"]);
    assert_eq!(
        path[9..],
        ["1.2000 ± 0.0577", "0.0600", "0.0400 … 0.0800", "0.500", "–"]
    );
    let direct = cells(lines[3]);
    assert_eq!(
        (direct[6].as_str(), direct[9].as_str()),
        ("! 0.00150", "1.1000")
    );
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
    assert!(lines[0].starts_with("scene,integrator,budget,seed,wall_s,cpu_s,passes,spp,mse,"));
    assert!(lines[0].ends_with("efficiency,paths,rays,rejected,Mpaths/CPU s,acceptance"));
    assert!(lines[1].starts_with("\"box, small\",path,1 s,1,2.5,2,8,8,0.5,0.021,0.001,"));
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
        all["summary"][0]["efficiency"]["upper_quartile"]
            .as_f64()
            .unwrap()
            > 0.06
    );
    assert!(all["summary"][1]["mean_ratio"]["standard_error"].is_null());
}

#[test]
fn options_keep_their_kinds() {
    use serde_json::json;
    assert_eq!(option_value("true"), json!(true));
    assert_eq!(option_value("-1"), json!(-1));
    assert_eq!(option_value("0.5"), json!(0.5));
    assert_eq!(option_value("power"), json!("power"));
}
