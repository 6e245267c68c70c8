//! Who races, for how long, and whether that makes sense: all that is known before a scene is read.

use std::time::Duration;

use crate::cli::args::{BenchArgs, BenchEffort};
use crate::cli::budget::Goal;
use crate::cli::failure::Failure;
use crate::cli::notes::Notes;
use crate::cli::plan::{Plan, Wish, check_names};
use crate::scene::import::IntegratorRequest;
use crate::scene::import::xml::{Strictness, did_you_mean};

/// An integrator with what the arguments set of its options.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entrant {
    pub(super) name: String,
    pub(super) settings: Vec<(String, String)>,
}

/// How much each of them renders.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Effort {
    /// Such as `5 s`.
    pub(super) label: String,
    pub(super) goal: Goal,
}

impl Entrant {
    /// What it wishes of a scene's render.
    pub(super) fn wish(&self) -> Wish<'_> {
        Wish {
            integrator: Some(&self.name),
            settings: &self.settings,
            layers: &[],
        }
    }
}

/// The integrators with their settings: what is set for one of them beats what is set for all.
///
/// # Errors
/// [`Failure::Usage`] for integrators and options that do not exist, and for wrong values.
pub(super) fn entrants(args: &BenchArgs) -> Result<Vec<Entrant>, Failure> {
    let names: Vec<&str> = args.integrators.iter().map(|name| name.trim()).collect();
    only_once("--integrators", &names)?;
    for (key, _) in &args.settings {
        let owner = key.split_once('.').map(|(owner, _)| owner);
        if let Some(owner) = owner.filter(|owner| !names.contains(owner)) {
            let hint = did_you_mean(owner, names.iter().copied());
            return Err(Failure::Usage(format!(
                "--set {key}: no integrator \"{owner}\" takes part{hint}"
            )));
        }
    }
    let entrants: Vec<Entrant> = names
        .iter()
        .map(|name| Entrant {
            name: (*name).to_owned(),
            settings: settings_of(name, &args.settings),
        })
        .collect();
    for entrant in &entrants {
        check_names(&entrant.wish())?;
        // A scene without wishes: what is wrong now is wrong in the arguments.
        let mut notes = Notes::new(Strictness::Normal, true, Vec::new());
        Plan::new(&entrant.wish(), &IntegratorRequest::default(), &mut notes)?;
    }
    Ok(entrants)
}

/// What is set for an integrator: first for all, then for it alone, since the last one wins.
fn settings_of(name: &str, settings: &[(String, String)]) -> Vec<(String, String)> {
    let for_all = settings.iter().filter(|(key, _)| !key.contains('.'));
    let own = settings.iter().filter_map(|(key, value)| {
        let (owner, key) = key.split_once('.')?;
        (owner == name).then(|| (key.to_owned(), value.clone()))
    });
    for_all.cloned().chain(own).collect()
}

/// The budgets.
///
/// # Errors
/// [`Failure::Usage`] for one that is given twice.
pub(super) fn efforts(effort: &BenchEffort) -> Result<Vec<Effort>, Failure> {
    let counted = |counts: &[u32], unit: &str| -> Vec<Effort> {
        let counts = counts.iter().map(|&count| Effort {
            label: format!("{count} {unit}"),
            goal: Goal::Passes(count),
        });
        counts.collect()
    };
    let timed = effort.time.iter().map(|&seconds| Effort {
        label: format!("{seconds} s"),
        goal: Goal::Time(Duration::from_secs_f64(seconds)),
    });
    let mut efforts: Vec<Effort> = timed.collect();
    efforts.extend(counted(&effort.spp, "spp"));
    efforts.extend(counted(&effort.passes, "passes"));
    let labels: Vec<&str> = efforts.iter().map(|effort| effort.label.as_str()).collect();
    only_once("budget", &labels)?;
    Ok(efforts)
}

/// Refuses what would be measured twice and could not be told apart.
pub(super) fn only_once(what: &str, names: &[&str]) -> Result<(), Failure> {
    let mut rest = names;
    while let Some((name, others)) = rest.split_first() {
        if others.contains(name) {
            return Err(Failure::Usage(format!("{what}: {name} is given twice")));
        }
        rest = others;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Cli, Command};
    use clap::Parser;

    fn args(words: &[&str]) -> BenchArgs {
        let words = ["lumiflow", "bench", "a.xml"].iter().chain(words);
        match Cli::try_parse_from(words).unwrap().command {
            Some(Command::Bench(args)) => *args,
            other => panic!("{other:?}"),
        }
    }

    fn message<T: std::fmt::Debug>(result: Result<T, Failure>) -> String {
        match result {
            Err(Failure::Usage(message)) => message,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_set_for_one_beats_what_is_set_for_all() {
        let words = [
            "-i",
            "path,direct",
            "--set",
            "path.hide_emitters=false",
            "--set",
        ];
        let args = args(&[&words[..], &["hide_emitters=true", "--spp", "4"]].concat());
        let entrants = entrants(&args).unwrap();
        let pair = |value: &str| ("hide_emitters".to_owned(), value.to_owned());
        assert_eq!(entrants[0].settings, [pair("true"), pair("false")]);
        assert_eq!(entrants[1].settings, [pair("true")]);
    }

    #[test]
    fn mistakes_are_found_before_a_scene_is_read() {
        let found = |words: &[&str]| message(entrants(&args(&[words, &["--spp", "4"]].concat())));
        assert!(found(&["-i", "path,dirct"]).contains("did you mean \"direct\"?"));
        assert_eq!(
            found(&["-i", "path,path"]),
            "--integrators: path is given twice"
        );
        assert_eq!(
            found(&["--set", "pth.mis=power"]),
            "--set pth.mis: no integrator \"pth\" takes part (did you mean \"path\"?)"
        );
        assert!(found(&["--set", "path.max_dept=3"]).contains("did you mean \"max_depth\"?"));
        assert!(found(&["--set", "rr_depth=x"]).contains("expected a whole number"));
        // All integrators must know what is set for all of them.
        assert!(
            found(&["-i", "path,depth", "--set", "mis=power"]).contains("\"depth\" has no option")
        );
    }

    #[test]
    fn budgets_have_names() {
        let labels = |words: &[&str]| -> Vec<String> {
            let efforts = efforts(&args(words).effort).unwrap();
            efforts.into_iter().map(|effort| effort.label).collect()
        };
        assert_eq!(labels(&["--time", "0.5,20"]), ["0.5 s", "20 s"]);
        assert_eq!(labels(&["--spp", "1,64"]), ["1 spp", "64 spp"]);
        assert_eq!(labels(&["--passes", "8"]), ["8 passes"]);
        let twice = message(efforts(&args(&["--spp", "4,4"]).effort));
        assert_eq!(twice, "budget: 4 spp is given twice");
    }
}
