//! `lumiflow crosscheck`, and `--accel` of the other commands.

use lumiflow::image::read_exr;

use super::Place;

#[test]
fn a_sound_scene_passes_and_says_so() {
    let place = Place::with_room();
    let done = place.run(&[
        "crosscheck",
        "room.xml",
        "--rays",
        "9000",
        "--json",
        "-t",
        "2",
    ]);
    assert_eq!(done.code, Some(0), "{}{}", done.stdout, done.stderr);
    let (table, json) = done.stdout.trim_end().rsplit_once('\n').unwrap();
    for part in [
        "primary",
        "degenerate",
        "silhouette",
        "the referee sides with",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    let json: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!((&json["rays"], &json["real"]), (&9000.into(), &0.into()));
    assert_eq!(json["kinds"]["edge"]["rays"], 1000);
    assert!(
        done.stderr.contains("real disagreements: 0"),
        "{}",
        done.stderr
    );
    let quiet = place.run(&["crosscheck", "room.xml", "--rays", "9000", "-q", "-t", "1"]);
    assert_eq!(
        (quiet.stdout.trim_end(), quiet.stderr.as_str()),
        (table, "")
    );
}

#[test]
fn what_the_robust_mode_saves_is_shown() {
    let place = Place::with_room();
    let [robust, fast] = ["embree", "embree-fast"].map(|accel| {
        let words = ["--rays", "9000", "--json", "-q", "--accel", accel];
        let done = place.run(&[&["crosscheck", "room.xml"][..], &words].concat());
        assert_eq!(done.code, Some(0), "{}{}", done.stdout, done.stderr);
        let (_, json) = done.stdout.trim_end().rsplit_once('\n').unwrap();
        let json: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(json["accel"], accel);
        json["all"]["closest"]["limit"].as_u64().unwrap()
    });
    assert!(fast > robust, "{fast} of one, {robust} of the other");
    let ray = ["--accel", "embree-fast", "--replay", "12/edge"];
    let replayed = place.run(&[&["crosscheck", "room.xml"][..], &ray].concat());
    assert!(
        replayed.stdout.contains("\nembree-fast "),
        "{}",
        replayed.stdout
    );
}

#[test]
fn single_rays_are_told_all_about() {
    let place = Place::with_room();
    let done = place.run(&["crosscheck", "room.xml", "--replay", "12/edge"]);
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    let ray = done
        .stdout
        .lines()
        .next()
        .unwrap()
        .trim_start_matches("ray")
        .trim();
    let again = place.run(&["crosscheck", "room.xml", "--ray", ray]);
    assert_eq!(again.stdout, done.stdout);
    let through = place.run(&["crosscheck", "room.xml", "--ray", "0.5,0.5,4,0,0,-1,0,inf"]);
    for part in ["geometry 0", "referee     distance 4,", "both agree"] {
        assert!(through.stdout.contains(part), "{part}: {}", through.stdout);
    }
    // Embree's own distance depends on how the processor divides.
    let (_, rest) = through.stdout.split_once("embree      distance ").unwrap();
    let distance: f32 = rest.split(',').next().unwrap().parse().unwrap();
    assert!((distance - 4.0).abs() < 1e-5, "{}", through.stdout);
}

#[test]
fn nonsense_is_explained() {
    let place = Place::with_room();
    for (words, part) in [
        (["--replay", "7/egde"], "did you mean \"edge\"?"),
        (["--replay", "edge"], "expected INDEX/KIND"),
        (["--ray", "1,2,3"], "expected eight numbers"),
        (["--rays", "0"], "0 is not in"),
        (["--accel", "obvhs"], "expected embree or embree-fast"),
    ] {
        let done = place.run(&["crosscheck", "room.xml", words[0], words[1]]);
        assert_eq!(done.code, Some(2), "{words:?}");
        assert!(done.stderr.contains(part), "{words:?}: {}", done.stderr);
    }
    let done = place.run(&["render", "room.xml", "--accel", "embreefast"]);
    assert!(done.stderr.contains("'embree-fast'"), "{}", done.stderr);
    assert_eq!(done.code, Some(2));
}

#[test]
fn renders_by_all_tracers_are_nearly_the_same() {
    let place = Place::with_room();
    let [embree, fast, obvhs] = ["embree", "embree-fast", "obvhs"].map(|accel| {
        let file = format!("{accel}.exr");
        let words = [
            "render", "room.xml", "--spp", "32", "--json", "-o", &file, "--accel", accel,
        ];
        let done = place.run(&words);
        assert_eq!(done.code, Some(0), "{}", done.stderr);
        let json: serde_json::Value = serde_json::from_str(done.stdout.trim()).unwrap();
        assert_eq!(json["accel"], accel);
        let image = read_exr(&place.path(&file)).unwrap();
        let found = format!("{:?}", image.metadata["lumiflow.accel"]);
        assert!(found.contains(&format!("{accel:?}")), "{found}");
        image.rgb("").unwrap()
    });
    // One path in thousands goes another way, from a last bit on.
    let near = |(a, b): (&[f32; 3], &[f32; 3])| {
        a.iter()
            .zip(b)
            .all(|(a, b)| (a - b).abs() <= 1e-3 * a.abs().max(0.01))
    };
    let sum = |image: &[[f32; 3]]| -> f64 { image.iter().flatten().map(|v| f64::from(*v)).sum() };
    for other in [fast, obvhs] {
        let same = embree.iter().zip(&other).filter(|pair| near(*pair)).count();
        assert!(same * 10 >= embree.len() * 9, "{same} of {}", embree.len());
        let ratio = sum(&other) / sum(&embree);
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }
    let info = place.run(&["info", "room.xml", "--accel", "obvhs"]);
    assert!(info.stdout.contains("accel       obvhs"), "{}", info.stdout);
}
