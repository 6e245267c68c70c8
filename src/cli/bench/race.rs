//! The renders of a race, one after the other: which are there already, and which are to be made.

use std::sync::Arc;

use serde_json::Value;

use super::entrants::{Effort, Entrant, Runner};
use super::files::{Folder, stem};
use super::render::{Outcome, Start};
use super::show::show;
use super::stage::Stage;
use crate::cli::args::BenchArgs;
use crate::cli::budget::Goal;
use crate::cli::console::{duration, say};
use crate::cli::failure::Failure;
use crate::cli::signals::Interruption;
use crate::report::{Bench, Measure, Missed, Trial, three_digits};

/// Exit code when a peer failed.
const PEER_FAILED: u8 = 4;

/// What holds for the whole race.
pub(super) struct Rules<'a> {
    pub(super) args: &'a BenchArgs,
    pub(super) entrants: Vec<Entrant>,
    pub(super) efforts: Vec<Effort>,
    pub(super) folder: Option<Folder<'a>>,
    pub(super) interruption: &'a Arc<Interruption>,
    /// How the numbers are made.
    pub(super) about: Vec<(String, String)>,
    /// Number of renders, with those of scenes that are broken.
    pub(super) wanted: usize,
}

/// A race under way.
pub(super) struct Race<'a> {
    pub(super) rules: Rules<'a>,
    stages: Vec<Stage>,
    slots: Vec<Slot>,
}

/// One of the renders.
#[derive(Debug)]
pub(super) struct Slot {
    stage: usize,
    pub(super) entrant: usize,
    pub(super) effort: usize,
    pub(super) seed: u64,
    /// Of its files' names.
    pub(super) stem: String,
    /// What decides what is measured.
    key: Value,
    state: State,
}

#[derive(Debug)]
enum State {
    Pending,
    Done(Trial),
    Missed(Missed),
}

impl Slot {
    /// What was measured, if anything was.
    pub(super) fn trial(&self) -> Option<&Trial> {
        match &self.state {
            State::Done(trial) => Some(trial),
            State::Pending | State::Missed(_) => None,
        }
    }

    fn is_pending(&self) -> bool {
        matches!(self.state, State::Pending)
    }
}

impl Rules<'_> {
    /// Whether the image of a render is kept.
    pub(super) fn keeps_image(&self, seed: u64) -> bool {
        self.folder.is_some() && (self.args.all_images || seed == self.args.seed)
    }
}

impl<'a> Race<'a> {
    /// Puts the renders in order, and takes those that are there from their records. The seeds go
    /// around last, so that what changes on the machine meets all integrators, and what is
    /// interrupted has as many of each.
    ///
    /// # Errors
    /// For a damaged record.
    pub(super) fn new(rules: Rules<'a>, stages: Vec<Stage>) -> Result<Self, Failure> {
        let (mut slots, args) = (Vec::new(), rules.args);
        for (index, stage) in stages.iter().enumerate() {
            for seed in (0..args.seeds).map(|n| args.seed.wrapping_add(u64::from(n))) {
                for (effort, e) in rules.efforts.iter().enumerate() {
                    for (entrant, who) in rules.entrants.iter().enumerate() {
                        let key = stage.key(entrant, who, e, seed);
                        let names = [&*stage.course.name, &who.label, &e.label, &seed.to_string()];
                        slots.push(Slot {
                            stage: index,
                            entrant,
                            effort,
                            seed,
                            stem: stem(names, &key),
                            key,
                            state: State::Pending,
                        });
                    }
                }
            }
        }
        for slot in &mut slots {
            let recorded = rules.folder.as_ref().map(|folder| {
                let trial = folder.recorded(&slot.stem, &slot.key)?;
                let needed = rules.keeps_image(slot.seed);
                let whole = !needed || folder.of_run(&slot.stem, "exr").is_file();
                Ok::<_, Failure>(trial.filter(|_| whole))
            });
            if let Some(trial) = recorded.transpose()?.flatten() {
                slot.state = State::Done(trial);
            }
        }
        Ok(Self {
            rules,
            stages,
            slots,
        })
    }

    /// Measures scene after scene; the exit code.
    pub(super) fn run(&mut self) -> u8 {
        let mut code = 0;
        for stage in 0..self.stages.len() {
            if let Err(failure) = self.measure(stage) {
                failure.report("bench");
                code = if code == 0 { failure.exit_code() } else { code };
            }
            if let Some(interrupted) = self.rules.interruption.exit_code() {
                return if code == 0 { interrupted } else { code };
            }
        }
        let is_missed = |slot: &Slot| matches!(slot.state, State::Missed(_));
        if code == 0 && self.slots.iter().any(is_missed) {
            return PEER_FAILED;
        }
        code
    }

    /// What is measured so far.
    pub(super) fn bench(&self) -> Bench {
        let rules = &self.rules;
        let stages = self.stages.iter().enumerate();
        let begun = stages.filter(|(index, _)| {
            let mut own = self.slots.iter().filter(|slot| slot.stage == *index);
            own.any(|slot| !slot.is_pending())
        });
        let missed = self.slots.iter().filter_map(|slot| match &slot.state {
            State::Missed(missed) => Some(missed.clone()),
            State::Pending | State::Done(_) => None,
        });
        Bench {
            about: rules.about.clone(),
            scenes: begun
                .map(|(_, stage)| stage.described(&rules.entrants))
                .collect(),
            trials: self
                .slots
                .iter()
                .filter_map(|slot| slot.trial().cloned())
                .collect(),
            missed: missed.collect(),
            wanted: rules.wanted,
        }
    }

    /// Makes what is not there of a scene, and shows what came out.
    fn measure(&mut self, stage: usize) -> Result<(), Failure> {
        let own = |slot: &&Slot| slot.stage == stage;
        let all = self.slots.iter().filter(own).count();
        let is_pending = |index: &usize| {
            let slot = &self.slots[*index];
            slot.stage == stage && slot.is_pending()
        };
        let pending: Vec<usize> = (0..self.slots.len()).filter(is_pending).collect();
        if pending.len() < all && !self.rules.args.quiet {
            let (name, there) = (&self.stages[stage].course.name, all - pending.len());
            say(&format!(
                "{name}: {there} of {all} renders are there, and not made again"
            ));
        }
        let made = self.make(stage, &pending);
        let shown = self.show(stage);
        made.and(shown)
    }

    fn make(&mut self, stage: usize, pending: &[usize]) -> Result<(), Failure> {
        let is_ours = |index: &usize| {
            let entrant = &self.rules.entrants[self.slots[*index].entrant];
            matches!(entrant.runner, Runner::Integrator { .. })
        };
        let imported = if pending.iter().any(is_ours) {
            Some(self.stages[stage].take_scene(self.rules.args)?)
        } else {
            None
        };
        for &index in pending {
            let slot = &self.slots[index];
            let title = format!("{} ({}/{})", self.title(slot), index + 1, self.slots.len());
            let start = Start {
                rules: &self.rules,
                stage: &self.stages[stage],
                slot,
                entrant: &self.rules.entrants[slot.entrant],
                effort: &self.rules.efforts[slot.effort],
                title: &title,
            };
            let state = match start.make(imported.as_ref())? {
                Outcome::Interrupted => return Ok(()),
                Outcome::Measured(trial) => {
                    if let Some(folder) = &self.rules.folder {
                        folder.record(&slot.stem, &slot.key, &trial)?;
                    }
                    State::Done(trial)
                }
                Outcome::Missed(missed) => State::Missed(missed),
            };
            self.slots[index].state = state;
            self.tell(&title, &self.slots[index]);
            self.write_tables()?;
        }
        Ok(())
    }

    fn title(&self, slot: &Slot) -> String {
        let scene = &self.stages[slot.stage].course.name;
        let entrant = &self.rules.entrants[slot.entrant].label;
        let effort = &self.rules.efforts[slot.effort].label;
        format!("{scene} {entrant} {effort} seed {}", slot.seed)
    }

    /// A line on how a render went, and how long the rest will take.
    fn tell(&self, title: &str, slot: &Slot) {
        if self.rules.args.quiet {
            return;
        }
        let left = self.seconds_left().filter(|left| *left > 0.0);
        let left = left.map_or_else(String::new, |left| format!("; {} left", duration(left)));
        match &slot.state {
            State::Pending => {}
            State::Missed(missed) => say(&format!("{title}: FAILED: {}{left}", missed.reason)),
            State::Done(trial) => {
                let over = Measure::Overrun.of(trial);
                let over = if over > 0.0 {
                    format!(", {} over the budget", duration(over))
                } else {
                    String::new()
                };
                say(&format!(
                    "{title}: relMSE {}, constant {} in {}{over}{left}",
                    three_digits(Measure::RelativeMse.of(trial)),
                    three_digits(Measure::EfficiencyConstant.of(trial)),
                    duration(trial.wall_seconds)
                ));
            }
        }
    }

    /// Seconds that the renders to be made will take, as far as that can be told: from those of the
    /// same kind, or from their budgets.
    fn seconds_left(&self) -> Option<f64> {
        let pending = self.slots.iter().filter(|slot| slot.is_pending());
        pending.map(|slot| self.expected_seconds(slot)).sum()
    }

    fn expected_seconds(&self, slot: &Slot) -> Option<f64> {
        let kind = |slot: &Slot| (slot.stage, slot.entrant, slot.effort);
        let alike = self.slots.iter().filter(|other| kind(other) == kind(slot));
        let known: Vec<f64> = alike
            .filter_map(|other| Some(other.trial()?.wall_seconds))
            .collect();
        if !known.is_empty() {
            return Some(known.iter().sum::<f64>() / known.len() as f64);
        }
        match self.rules.efforts[slot.effort].goal {
            Goal::Passes(_) => None,
            Goal::Time(limit) => Some(limit.as_secs_f64()),
            Goal::CpuTime(limit) => Some(limit.as_secs_f64() / f64::from(self.rules.args.threads)),
        }
    }

    fn write_tables(&self) -> Result<(), Failure> {
        let folder = self.rules.folder.as_ref();
        folder.map_or(Ok(()), |folder| folder.write(&self.bench()))
    }

    /// Draws what there is of a scene.
    fn show(&self, stage: usize) -> Result<(), Failure> {
        let Some(folder) = &self.rules.folder else {
            return Ok(());
        };
        let own = self.slots.iter().filter(|slot| slot.stage == stage);
        let own: Vec<&Slot> = own.filter(|slot| slot.trial().is_some()).collect();
        show(folder, &self.rules, &self.stages[stage], &own)?;
        // The tables name the pictures that there are.
        self.write_tables()
    }
}
