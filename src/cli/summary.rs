//! What is told about a finished render: in the file, in a line for people, in a line of JSON.

use serde_json::{Map, Value, json};

use super::console::duration;
use super::execute::Finished;
use super::memory::resident;
use super::notes::Notes;
use super::outputs::Target;
use super::plan::Plan;
use super::scenes::LoadCost;
use crate::image::Rows;
use crate::mutation::{Move, Rejection};
use crate::output::Record;
use crate::report::option_value;
use crate::scene::SceneMemory;
use crate::scene::import::{Imported, View};

/// A finished render.
pub(super) struct Summary<'a> {
    pub(super) target: &'a Target,
    pub(super) imported: &'a Imported,
    pub(super) plan: &'a Plan,
    pub(super) view: &'a View,
    pub(super) finished: &'a Finished,
    pub(super) seed: u64,
    pub(super) filter: &'static str,
}

impl Summary<'_> {
    /// For the EXR file.
    pub(super) fn record(&self, notes: &Notes) -> Record {
        let counters = self.finished.rendered.counters;
        Record {
            scene: self.target.name.clone(),
            scene_hash: self.imported.hash,
            integrator: self.plan.name.clone(),
            accel: self.imported.scene.accel().engine().name().to_owned(),
            options: self.plan.options.clone(),
            sampler: self.view.sampler.name().to_owned(),
            filter: self.filter.to_owned(),
            seed: self.seed,
            passes: self.finished.rendered.passes,
            samples: self.finished.rendered.passes,
            paths: counters.paths,
            rays: counters.rays,
            rejected: counters.rejected,
            chains: counters.chains,
            mutations: counters.mutations,
            replaced: notes.replaced(),
            run: self.finished.run,
        }
    }

    /// For people: what was rendered, and what became of mutations where there were any.
    pub(super) fn lines(&self, notes: &Notes) -> String {
        let mutations = self.mutation_lines(notes);
        [Some(self.line()), mutations]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join("\n")
    }

    fn line(&self) -> String {
        let counters = self.finished.rendered.counters;
        let per_second = |count: u64| count as f64 / self.finished.run.wall_seconds.max(1e-9) / 1e6;
        let files: Vec<String> = self.files();
        format!(
            "{}: {} samples a pixel in {}, {:.2} Msamples/s, {:.2} Mrays/s; wrote {}",
            self.target.name,
            self.finished.rendered.passes,
            duration(self.finished.run.wall_seconds),
            per_second(counters.paths),
            per_second(counters.rays),
            files.join(", ")
        )
    }

    /// For scripts. Times are those of rendering, without loading and writing.
    pub(super) fn json(
        &self,
        notes: &Notes,
        image: &dyn Rows,
        load: &LoadCost,
        interrupted: bool,
    ) -> Value {
        let record = self.record(notes);
        let options = record.options.iter();
        let options: Map<String, Value> = options
            .map(|(name, value)| (name.clone(), option_value(value)))
            .collect();
        json!({
            "scene": self.target.scene.display().to_string(),
            "outputs": self.files(),
            "integrator": record.integrator,
            "options": options,
            "accel": record.accel,
            "seed": record.seed,
            "threads": self.finished.run.threads,
            "load_s": load.seconds,
            "build_s": load.build_seconds,
            "prepare_s": self.finished.prepare_seconds,
            "wall_s": self.finished.run.wall_seconds,
            "cpu_s": self.finished.run.cpu_seconds,
            "passes": record.passes,
            "spp": record.samples,
            "paths": record.paths,
            "rays": record.rays,
            "mean": mean(image),
            "memory": self.memory(load),
            "rejected": record.rejected,
            "interrupted": interrupted,
            "chains": record.chains,
            "mutations": mutations(&record),
            "replaced": record.replaced,
            "warnings": notes.lines(),
        })
    }

    /// Where memory went, in bytes.
    fn memory(&self, load: &LoadCost) -> Value {
        let mut memory = scene_memory(self.imported.scene.memory());
        memory["film"] = self.finished.film_memory.into();
        memory["loaded"] = load.memory.map(|memory| memory.now).into();
        memory["load_peak"] = load.memory.map(|memory| memory.peak).into();
        memory["peak"] = resident().map(|memory| memory.peak).into();
        memory
    }

    /// What became of the chains' mutations, for people; `None` where there were none.
    fn mutation_lines(&self, notes: &Notes) -> Option<String> {
        let counters = &self.finished.rendered.counters;
        let text = self.record(notes).mutations_text();
        (!text.is_empty()).then(|| {
            format!(
                "{} chains, {:.2} Mmutations/CPU s\n  {}",
                counters.chains,
                counters.mutation_count() as f64 / 1e6 / self.finished.run.cpu_seconds.max(1e-9),
                text.replace('\n', "\n  ")
            )
        })
    }

    fn files(&self) -> Vec<String> {
        let files = self.target.files.iter();
        files.map(|file| file.display().to_string()).collect()
    }
}

/// What a scene takes, in bytes.
pub(super) fn scene_memory(memory: SceneMemory) -> Value {
    json!({
        "tree": memory.tree.held,
        "tree_peak": memory.tree.peak,
        "buffers": memory.buffers,
        "surfaces": memory.surfaces,
        "pictures": memory.pictures,
    })
}

/// What became of the mutations, by kind.
fn mutations(record: &Record) -> Value {
    let kinds = Move::all().zip(&record.mutations);
    let tried = kinds.filter(|(_, statistics)| statistics.proposed > 0);
    let entries = tried.map(|(mutation, statistics)| {
        let reasons = Rejection::NAMES
            .map(|(reason, name)| (name.to_owned(), statistics.rejections(reason).into()));
        let numbers = json!({
            "proposed": statistics.proposed,
            "accepted": statistics.accepted,
            "mean_acceptance": statistics.mean_acceptance(),
            "rejected": Map::from_iter(reasons),
        });
        (mutation.name().to_owned(), numbers)
    });
    Value::Object(entries.collect())
}

/// Mean of red, green and blue over the image.
fn mean(image: &dyn Rows) -> [f64; 3] {
    let (width, height) = (image.data_window().width(), image.data_window().height());
    let mut samples = vec![0.0; width as usize];
    ["R", "G", "B"].map(|name| {
        let mut sum = 0.0;
        if let Some(channel) = image.channel_index(name) {
            for row in 0..height as usize {
                image.fill(channel, row..row + 1, &mut samples);
                samples.iter().for_each(|value| sum += f64::from(*value));
            }
        }
        sum / (f64::from(width) * f64::from(height))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, Precision};

    #[test]
    fn the_mean_is_over_all_pixels() {
        let mut image = Image::new(2, 1);
        image.push_rgb("", Precision::Float, &[[1.0, 2.0, 3.0], [3.0, 2.0, 0.0]]);
        assert_eq!(mean(&image), [2.0, 2.0, 1.5]);
    }
}
