use std::path::PathBuf;
use std::sync::Arc;

use super::*;
use crate::scene::import::xml::{Location, Source, Strictness};

/// The wish of `-i`, `--set` and `--aov` in `words`.
struct Words<'w> {
    integrator: Option<&'w str>,
    settings: Vec<(String, String)>,
    layers: Vec<String>,
}

impl<'w> Words<'w> {
    fn new(words: &[&'w str]) -> Self {
        let values = |flag: &str| {
            let pairs = words.chunks(2).filter(move |pair| pair[0] == flag);
            pairs.map(|pair| pair[1]).collect::<Vec<&'w str>>()
        };
        let setting = |text: &&str| {
            let (key, value) = text.split_once('=').unwrap();
            (key.to_owned(), value.to_owned())
        };
        let layers = values("--aov").into_iter().flat_map(|list| list.split(','));
        Self {
            integrator: values("-i").pop(),
            settings: values("--set").iter().map(setting).collect(),
            layers: layers.map(str::to_owned).collect(),
        }
    }

    fn wish(&self) -> Wish<'_> {
        Wish {
            integrator: self.integrator,
            settings: &self.settings,
            layers: &self.layers,
        }
    }
}

fn at(line: u32) -> Location {
    let source = Arc::new(Source {
        path: PathBuf::from("a.xml"),
        order: 0,
    });
    Location {
        source,
        line,
        column: 3,
    }
}

fn request(name: &str, options: &[(&str, &str)]) -> IntegratorRequest {
    let mut request = IntegratorRequest {
        name: name.to_owned(),
        location: Some(at(5)),
        ..IntegratorRequest::default()
    };
    for (line, (key, value)) in (6..).zip(options) {
        let key = (*key).to_owned();
        request.option_locations.insert(key.clone(), at(line));
        request.options.insert(key, OptionValue::parse(value));
    }
    request
}

/// Name and options of the plan as text, and the warnings.
fn plan(words: &[&str], request: &IntegratorRequest) -> Result<(String, Vec<String>), String> {
    let mut notes = Notes::new(Strictness::Normal, true, Vec::new());
    match Plan::new(&Words::new(words).wish(), request, &mut notes) {
        Ok(plan) => {
            let options = plan
                .options
                .iter()
                .map(|(key, value)| format!(" {key}={value}"));
            Ok((plan.name + &options.collect::<String>(), notes.lines()))
        }
        Err(Failure::Usage(message)) => Err(format!("usage: {message}")),
        Err(Failure::Scene(list)) => Err(format!("scene: {}", list[0])),
        Err(other) => panic!("{other:?}"),
    }
}

#[test]
fn the_scene_decides_and_arguments_win() {
    let request = request("path", &[("max_depth", "8"), ("rr_depth", "3")]);
    let (text, warnings) = plan(&["--set", "maxDepth=4"], &request).unwrap();
    assert_eq!(
        text,
        "path hide_emitters=false max_depth=4 mis=power rr_depth=3 strict_normals=false"
    );
    assert_eq!(warnings, Vec::<String>::new());
    let (text, _) = plan(&[], &IntegratorRequest::default()).unwrap();
    assert!(text.starts_with("path "), "{text}");
}

#[test]
fn unknown_integrators_of_the_scene_are_replaced() {
    let request = request("sppm", &[("max_depth", "8"), ("photon_count", "1000")]);
    let (text, warnings) = plan(&[], &request).unwrap();
    assert!(text.contains("max_depth=8"), "{text}");
    assert_eq!(
        warnings,
        [
            "a.xml:5:3: warning: unknown integrator \"sppm\"; \"path\" is used instead, with its \
          max_depth=8"
        ]
    );
    let (text, warnings) = plan(&["-i", "depth"], &request).unwrap();
    assert_eq!((text.as_str(), warnings.len()), ("depth", 0));
}

#[test]
fn unknown_options_are_named_where_they_stand() {
    let request = request("path", &[("max_dept", "8")]);
    let (_, warnings) = plan(&[], &request).unwrap();
    assert_eq!(
        warnings,
        [
            "a.xml:6:3: warning: integrator \"path\" has no option \"max_dept\" (did you mean \
          \"max_depth\"?); ignored"
        ]
    );
    let none = IntegratorRequest::default();
    assert_eq!(
        plan(&["--set", "rr_dpeth=2"], &none).unwrap_err(),
        "usage: integrator \"path\" has no option \"rr_dpeth\" (did you mean \"rr_depth\"?)"
    );
}

#[test]
fn wrong_values_are_the_fault_of_where_they_stand() {
    let request = request("path", &[("rr_depth", "0")]);
    assert_eq!(
        plan(&[], &request).unwrap_err(),
        "scene: a.xml:6:3: option \"rr_depth\": found \"0\", expected a whole number from 1 on"
    );
    assert_eq!(
        plan(&["--set", "rr_depth=x"], &request).unwrap_err(),
        "usage: option \"rr_depth\": found \"x\", expected a whole number from 1 on"
    );
}

#[test]
fn layers_come_from_both_sides() {
    let mut request = request("path", &[]);
    request.aovs = vec![
        "dd.y:depth".to_owned(),
        "nn:sh_normal".to_owned(),
        "x:dp_du".to_owned(),
    ];
    let mut notes = Notes::new(Strictness::Normal, true, Vec::new());
    let words = Words::new(&["--aov", "uv,depth, variance"]);
    let plan = Plan::new(&words.wish(), &request, &mut notes).ok().unwrap();
    assert_eq!(plan.aovs, [Aov::Uv, Aov::Depth, Aov::ShadingNormal]);
    assert!(plan.variance);
    assert_eq!(
        notes.lines(),
        ["a.xml:5:3: warning: unknown layer \"dp_du\"; left out"]
    );
}

#[test]
fn names_in_arguments_are_checked_first() {
    let message = |words: &[&str]| match check_names(&Words::new(words).wish()) {
        Err(Failure::Usage(message)) => message,
        other => panic!("{other:?}"),
    };
    assert_eq!(
        message(&["-i", "pth"]),
        "unknown integrator \"pth\" (did you mean \"path\"?); there are path, direct, bdpt, \
         ptracer, depth, erpt, pmc-er, mlt, pssmlt, mmlt"
    );
    assert_eq!(
        message(&["--aov", "uv,albdo"]),
        "unknown layer \"albdo\" (did you mean \"albedo\"?); there are albedo, sh_normal, \
         geo_normal, depth, position, uv, proposals, acceptance, chains, strategy, mutations, \
         population_age, techniques, variance"
    );
    check_names(&Words::new(&["-i", "direct", "--aov", "uv"]).wish()).unwrap();
}

#[test]
fn every_filter_exists() {
    use clap::ValueEnum;
    for name in FilterName::value_variants() {
        let filter = filter(*name).unwrap();
        let value = name.to_possible_value().unwrap();
        assert_eq!(filter.kind().name(), value.get_name());
    }
}
