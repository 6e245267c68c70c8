//! Who races, for how long, and whether that makes sense: all that is known before a scene is read.

use std::time::Duration;

use super::peer::Peer;
use crate::cli::args::{BenchArgs, BenchEffort};
use crate::cli::budget::Goal;
use crate::cli::execute::check_cpu_clock;
use crate::cli::failure::Failure;
use crate::cli::notes::Notes;
use crate::cli::plan::{Plan, Wish, check_names};
use crate::scene::import::IntegratorRequest;
use crate::scene::import::xml::{Strictness, did_you_mean};

/// Races when nothing else is asked for.
const DEFAULT_INTEGRATOR: &str = "path";

/// Who races.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entrant {
    /// What tables call it: its name, with the options that were spelled with it.
    pub(super) label: String,
    pub(super) runner: Runner,
}

/// What renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Runner {
    /// An integrator with what the arguments set of its options.
    Integrator {
        name: String,
        settings: Vec<(String, String)>,
    },
    /// Another program.
    Peer(Peer),
}

/// How much each of them renders.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Effort {
    /// Such as `5 s`.
    pub(super) label: String,
    pub(super) goal: Goal,
    /// The same as a placeholder of a peer's command, and what to put there.
    pub(super) amount: (&'static str, String),
}

impl Entrant {
    /// What it wishes of a scene's render; `None` for a peer.
    pub(super) fn wish(&self) -> Option<Wish<'_>> {
        match &self.runner {
            Runner::Integrator { name, settings } => Some(Wish {
                integrator: Some(name),
                settings,
                layers: &[],
            }),
            Runner::Peer(_) => None,
        }
    }
}

/// The integrators with their settings, and then the peers. What is spelled with an integrator beats
/// what is set by its name, and that beats what is set for all.
///
/// # Errors
/// [`Failure::Usage`] for integrators and options that do not exist, for wrong values, and for
/// commands that cannot work.
pub(super) fn entrants(args: &BenchArgs, efforts: &[Effort]) -> Result<Vec<Entrant>, Failure> {
    let spelled: Vec<&str> = match args.integrators.as_slice() {
        [] if args.peers.is_empty() => vec![DEFAULT_INTEGRATOR],
        some => some.iter().map(|text| text.trim()).collect(),
    };
    let names: Vec<&str> = spelled.iter().map(|text| name_in(text)).collect();
    for (key, _) in &args.settings {
        let owner = key.split_once('.').map(|(owner, _)| owner);
        if let Some(owner) = owner.filter(|owner| !names.contains(owner)) {
            let hint = did_you_mean(owner, names.iter().copied());
            return Err(Failure::Usage(format!(
                "--set {key}: no integrator \"{owner}\" takes part{hint}"
            )));
        }
    }
    let integrators = spelled.iter().map(|text| integrator(text, &args.settings));
    let peers = args.peers.iter().map(|(name, command)| {
        let peer = Peer::new(name, command, efforts)?;
        Ok(Entrant {
            label: name.clone(),
            runner: Runner::Peer(peer),
        })
    });
    let entrants: Vec<Entrant> = integrators.chain(peers).collect::<Result<_, _>>()?;
    let labels: Vec<&str> = entrants.iter().map(|entrant| &*entrant.label).collect();
    only_once("--integrators", &labels)?;
    for wish in entrants.iter().filter_map(Entrant::wish) {
        check_names(&wish)?;
        // A scene without wishes: what is wrong now is wrong in the arguments.
        let mut notes = Notes::new(Strictness::Normal, true, Vec::new());
        Plan::new(&wish, &IntegratorRequest::default(), &mut notes)?;
    }
    Ok(entrants)
}

/// The name of a spelled integrator, without its options.
fn name_in(text: &str) -> &str {
    text.split(':').next().unwrap_or(text).trim()
}

/// An integrator from its name and options: `erpt:chain_length=50`.
fn integrator(text: &str, settings: &[(String, String)]) -> Result<Entrant, Failure> {
    let name = name_in(text);
    let mut settings = settings_of(name, settings);
    for option in text.split(':').skip(1) {
        let pair = option
            .split_once('=')
            .filter(|(key, _)| !key.trim().is_empty());
        let Some((key, value)) = pair else {
            return Err(Failure::Usage(format!(
                "--integrators {text}: found \"{option}\", expected KEY=VALUE after the colon"
            )));
        };
        settings.push((key.trim().to_owned(), value.trim().to_owned()));
    }
    Ok(Entrant {
        label: text.to_owned(),
        runner: Runner::Integrator {
            name: name.to_owned(),
            settings,
        },
    })
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
/// [`Failure::Usage`] for one that is given twice, and [`Failure::File`] where processor time is
/// asked for and the system tells none.
pub(super) fn efforts(effort: &BenchEffort) -> Result<Vec<Effort>, Failure> {
    let counted = |counts: &[u32], unit: &'static str| -> Vec<Effort> {
        let counts = counts.iter().map(|&count| Effort {
            label: format!("{count} {unit}"),
            goal: Goal::Passes(count),
            amount: (unit, count.to_string()),
        });
        counts.collect()
    };
    let timed = |seconds: &[f64], unit: &str, goal: fn(Duration) -> Goal| -> Vec<Effort> {
        let seconds = seconds.iter().map(|&seconds| Effort {
            label: format!("{seconds} {unit}"),
            goal: goal(Duration::from_secs_f64(seconds)),
            amount: ("seconds", seconds.to_string()),
        });
        seconds.collect()
    };
    if !effort.cpu.is_empty() {
        check_cpu_clock()?;
    }
    let mut efforts = timed(&effort.time, "s", Goal::Time);
    efforts.extend(timed(&effort.cpu, "CPU s", Goal::CpuTime));
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

    fn entrants_of(args: &BenchArgs) -> Result<Vec<Entrant>, Failure> {
        entrants(args, &efforts(&args.effort)?)
    }

    fn settings(entrant: &Entrant) -> Vec<(String, String)> {
        entrant.wish().unwrap().settings.to_vec()
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
        let entrants = entrants_of(&args).unwrap();
        let pair = |value: &str| ("hide_emitters".to_owned(), value.to_owned());
        assert_eq!(settings(&entrants[0]), [pair("true"), pair("false")]);
        assert_eq!(settings(&entrants[1]), [pair("true")]);
    }

    #[test]
    fn one_integrator_races_with_several_settings() {
        let words = [
            "-i",
            "erpt, erpt:chain_length=50:num_chains=2",
            "--spp",
            "4",
        ];
        let more = ["--set", "chain_length=10", "--set", "erpt.num_chains=3"];
        let entrants = entrants_of(&args(&[&words[..], &more].concat())).unwrap();
        let labels: Vec<&str> = entrants.iter().map(|entrant| &*entrant.label).collect();
        assert_eq!(labels, ["erpt", "erpt:chain_length=50:num_chains=2"]);
        let last = |entrant: &Entrant, name: &str| {
            let settings = settings(entrant);
            let found = settings.into_iter().rfind(|(key, _)| key == name);
            found.unwrap().1
        };
        assert_eq!(last(&entrants[0], "chain_length"), "10");
        assert_eq!(last(&entrants[0], "num_chains"), "3");
        assert_eq!(last(&entrants[1], "chain_length"), "50");
        assert_eq!(last(&entrants[1], "num_chains"), "2");
    }

    #[test]
    fn path_races_unless_others_do() {
        let labels = |words: &[&str]| -> Vec<String> {
            let entrants = entrants_of(&args(&[words, &["--spp", "4"]].concat())).unwrap();
            entrants.into_iter().map(|entrant| entrant.label).collect()
        };
        assert_eq!(labels(&[]), ["path"]);
        let peer = ["-o", "d", "--peer", "other=x {scene} {spp} {out}"];
        assert_eq!(labels(&peer), ["other"]);
        assert_eq!(
            labels(&[&peer[..], &["-i", "depth"]].concat()),
            ["depth", "other"]
        );
    }

    #[test]
    fn mistakes_are_found_before_a_scene_is_read() {
        let found =
            |words: &[&str]| message(entrants_of(&args(&[words, &["--spp", "4"]].concat())));
        assert!(found(&["-i", "path,dirct"]).contains("did you mean \"direct\"?"));
        assert_eq!(
            found(&["-i", "path,path"]),
            "--integrators: path is given twice"
        );
        assert_eq!(
            found(&["--set", "pth.mis=power"]),
            "--set pth.mis: no integrator \"pth\" takes part (did you mean \"path\"?)"
        );
        assert_eq!(
            found(&["-i", "path:max_depth"]),
            "--integrators path:max_depth: found \"max_depth\", expected KEY=VALUE after the colon"
        );
        assert!(found(&["-i", "path:max_dept=3"]).contains("did you mean \"max_depth\"?"));
        let peer = [
            "--peer",
            "path=x {scene} {spp} {out}",
            "-o",
            "d",
            "-i",
            "path",
        ];
        assert_eq!(found(&peer), "--integrators: path is given twice");
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
        assert_eq!(labels(&["--cpu", "1.5,6"]), ["1.5 CPU s", "6 CPU s"]);
        assert_eq!(labels(&["--spp", "1,64"]), ["1 spp", "64 spp"]);
        assert_eq!(labels(&["--passes", "8"]), ["8 passes"]);
        let twice = message(efforts(&args(&["--spp", "4,4"]).effort));
        assert_eq!(twice, "budget: 4 spp is given twice");
    }
}
