//! A scene made ready: all that can be wrong with it is known before anything is rendered.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use xxhash_rust::xxh3::xxh3_64;

use super::entrants::{Effort, Entrant, Runner};
use super::yardstick::{Course, Yardstick};
use crate::cli::args::{BenchArgs, Crop};
use crate::cli::failure::Failure;
use crate::cli::notes::Notes;
use crate::cli::plan::{Plan, note_unseen_beams};
use crate::report::{BenchScene, option_value};
use crate::scene::import::{Imported, View};

/// Sides of what is shown where nothing else is asked for, at most; in pixels.
const SHOWN: u32 = 256;

/// A scene with all that is needed to measure on it, but for the scene itself.
pub(super) struct Stage {
    pub(super) course: Course,
    pub(super) yardstick: Yardstick,
    /// Of what is rendered, in pixels.
    pub(super) size: (u32, u32),
    /// What each entrant does; `None` for peers.
    pub(super) plans: Vec<Option<Plan>>,
    pub(super) notes: Notes,
    /// Parts of the images that are shown side by side.
    pub(super) shown: Vec<Crop>,
    /// What decides what is measured, as far as all renders share it.
    key: Map<String, Value>,
    /// The scene as long as nobody took it.
    imported: Option<Imported>,
}

impl Stage {
    /// Reads and checks a scene and the files that it is measured against.
    ///
    /// # Errors
    /// For a broken scene, for wrong options, and for pictures that cannot be read or do not fit.
    pub(super) fn prepare(
        course: Course,
        args: &BenchArgs,
        entrants: &[Entrant],
    ) -> Result<Self, Failure> {
        let imported = load(&course, args)?;
        let warnings = imported.warnings.clone();
        let mut notes = Notes::new(args.scene.strictness(), args.quiet, warnings);
        let window = view(&course, &imported)?.window;
        let size = (window.width, window.height);
        let yardstick = Yardstick::read(&course, args, size)?;
        let plan = |entrant: &Entrant| {
            let wish = entrant.wish();
            wish.map(|wish| Plan::new(&wish, &imported.integrator, &mut notes))
                .transpose()
        };
        let plans: Vec<Option<Plan>> = entrants.iter().map(plan).collect::<Result<_, _>>()?;
        let labelled = entrants.iter().zip(&plans);
        let labelled = labelled.filter_map(|(e, plan)| Some((&*e.label, plan.as_ref()?)));
        note_unseen_beams(&imported.scene, labelled, &mut notes);
        warn_of_equal_seeds(&course, args, &yardstick, &mut notes);
        notes.settle()?;
        Ok(Self {
            shown: shown(args, &yardstick)?,
            key: shared_key(&course, args, &imported, size)?,
            course,
            yardstick,
            size,
            plans,
            notes,
            imported: Some(imported),
        })
    }

    /// Gives the scene's memory back.
    pub(super) fn forget_scene(&mut self) {
        self.imported = None;
    }

    /// The scene.
    ///
    /// # Errors
    /// When it can no longer be read.
    pub(super) fn take_scene(&mut self, args: &BenchArgs) -> Result<Imported, Failure> {
        match self.imported.take() {
            Some(imported) => Ok(imported),
            None => load(&self.course, args),
        }
    }

    /// The sensor that is rendered.
    ///
    /// # Errors
    /// [`Failure::Usage`] where there is none.
    pub(super) fn view<'i>(&self, imported: &'i Imported) -> Result<&'i View, Failure> {
        view(&self.course, imported)
    }

    /// All that decides what is measured of a render.
    pub(super) fn key(&self, index: usize, entrant: &Entrant, effort: &Effort, seed: u64) -> Value {
        let mut key = self.key.clone();
        match (&entrant.runner, &self.plans[index]) {
            (Runner::Peer(peer), _) => {
                // What this program is changes nothing for another one.
                key.remove("program");
                key.insert("command".to_owned(), json!(peer.command));
            }
            (Runner::Integrator { name, .. }, plan) => {
                let options = plan.iter().flat_map(|plan| &plan.options);
                let options = options.map(|(name, value)| (name.clone(), option_value(value)));
                key.insert("algorithm".to_owned(), json!(name));
                key.insert("options".to_owned(), Value::Object(options.collect()));
            }
        }
        key.insert("entrant".to_owned(), json!(entrant.label));
        key.insert("budget".to_owned(), json!(effort.label));
        key.insert("seed".to_owned(), json!(seed));
        Value::Object(key)
    }

    /// What tables say of the scene.
    pub(super) fn described(&self, entrants: &[Entrant]) -> BenchScene {
        let path = |path: &Path| path.display().to_string();
        let course = &self.course;
        let integrators = entrants.iter().zip(&self.plans).map(|(entrant, plan)| {
            let options = match (&entrant.runner, plan) {
                (Runner::Peer(peer), _) => vec![("command".to_owned(), peer.command.clone())],
                (_, plan) => plan.iter().flat_map(|plan| plan.options.clone()).collect(),
            };
            (entrant.label.clone(), options)
        });
        BenchScene {
            name: course.name.clone(),
            file: path(&course.scene),
            size: self.size,
            pixels: self.yardstick.pixels(),
            reference: path(&course.reference),
            reference_variance: course.variance.as_deref().map(path),
            mask: course.mask.as_deref().map(path),
            integrators: integrators.collect(),
        }
    }
}

/// Reads a scene; its wishes for further layers would cost time that is not the integrators'.
fn load(course: &Course, args: &BenchArgs) -> Result<Imported, Failure> {
    let loaded = args
        .scene
        .load(&course.scene, true, args.tracer.accel.engine())?;
    let mut imported = loaded.imported;
    imported.integrator.aovs.clear();
    imported.integrator.second_moment = false;
    Ok(imported)
}

fn view<'i>(course: &Course, imported: &'i Imported) -> Result<&'i View, Failure> {
    imported.views.first().ok_or_else(|| {
        let scene = course.scene.display();
        Failure::Usage(format!("{scene} has no sensor"))
    })
}

/// The parts that are shown, all within the picture.
fn shown(args: &BenchArgs, yardstick: &Yardstick) -> Result<Vec<Crop>, Failure> {
    let whole = &yardstick.whole;
    for &Crop {
        x,
        y,
        width,
        height,
    } in &args.show
    {
        if whole.crop(x, y, width, height).is_none() {
            return Err(Failure::Usage(format!(
                "--show {x},{y},{width},{height} reaches beyond the {}x{} pixels of the images",
                whole.width, whole.height
            )));
        }
    }
    if !args.show.is_empty() {
        return Ok(args.show.clone());
    }
    let (width, height) = (whole.width.min(SHOWN), whole.height.min(SHOWN));
    let middle = Crop {
        x: (whole.width - width) / 2,
        y: (whole.height - height) / 2,
        width,
        height,
    };
    Ok(vec![args.crop.unwrap_or(middle)])
}

/// What all renders on a scene share.
fn shared_key(
    course: &Course,
    args: &BenchArgs,
    imported: &Imported,
    size: (u32, u32),
) -> Result<Map<String, Value>, Failure> {
    let hash = |path: &PathBuf| -> Result<String, Failure> {
        let bytes = fs::read(path)
            .map_err(|error| Failure::File(format!("cannot read {}: {error}", path.display())))?;
        Ok(format!("{:016x}", xxh3_64(&bytes)))
    };
    let optional = |path: &Option<PathBuf>| path.as_ref().map(hash).transpose();
    let program = std::env::current_exe().map_err(|error| {
        Failure::File(format!("the file of this program cannot be found: {error}"))
    })?;
    let crop = args
        .crop
        .map(|crop| [crop.x, crop.y, crop.width, crop.height]);
    let pairs = [
        ("program", json!(hash(&program)?)),
        ("scene", json!(course.name)),
        ("scene_hash", json!(format!("{:016x}", imported.hash))),
        (
            "strictness",
            json!(format!("{:?}", args.scene.strictness())),
        ),
        ("size", json!([size.0, size.1])),
        ("threads", json!(args.threads)),
        ("accel", json!(args.tracer.accel.engine().name())),
        ("reference", json!(hash(&course.reference)?)),
        ("reference_variance", json!(optional(&course.variance)?)),
        ("mask", json!(optional(&course.mask)?)),
        ("crop", json!(crop)),
        ("skip_rows", json!(args.skip_rows)),
        ("exposure", json!(args.exposure)),
    ];
    Ok(pairs
        .map(|(name, value)| (name.to_owned(), value))
        .into_iter()
        .collect())
}

fn warn_of_equal_seeds(
    course: &Course,
    args: &BenchArgs,
    yardstick: &Yardstick,
    notes: &mut Notes,
) {
    let Some(seed) = yardstick.reference_seed else {
        return;
    };
    if seed.wrapping_sub(args.seed) < u64::from(args.seeds) {
        let reference = course.reference.display();
        notes.remark(format!(
            "{reference} was rendered with seed {seed}, which is among those measured: equal noise \
             looks like no error; choose others with --seed"
        ));
    }
}
