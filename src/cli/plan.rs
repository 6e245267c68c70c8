//! What a scene's render will do: the scene's wishes and the arguments, brought together.

use super::args::FilterName;
use super::failure::Failure;
use super::notes::Notes;
use crate::film::{Filter, FilterKind};
use crate::integrator::{self, Algorithm, Aov};
use crate::scene::Scene;
use crate::scene::import::IntegratorRequest;
use crate::scene::import::xml::{Diagnostic, Name, Severity, did_you_mean};
use crate::scene::options::{OptionError, OptionReader, OptionValue, Options};

/// Used where a scene names no integrator, or one that we do not have.
const DEFAULT_INTEGRATOR: &str = "path";

/// Options that mean the same to any integrator: what is kept when another one takes over.
const SHARED_OPTIONS: [&str; 3] = ["max_depth", "rr_depth", "hide_emitters"];

/// What finds the light of beams without width.
const SEERS_OF_BEAMS: &str = "bdpt, ptracer, mmlt, pssmlt with bidirectional=true, and erpt, pmc-er \
                              and mlt with seeds=bdpt";

/// Name under which the variance of the image's mean is asked for.
const VARIANCE: &str = "variance";

/// What a scene's render will do.
pub(super) struct Plan {
    /// Name of the integrator.
    pub(super) name: String,
    /// The integrator.
    pub(super) integrator: Box<dyn Algorithm>,
    /// Its options, defaults included.
    pub(super) options: Vec<(String, String)>,
    /// Layers about the first surface.
    pub(super) aovs: Vec<Aov>,
    /// Layers of the integrator's own.
    pub(super) own_layers: Vec<String>,
    /// Whether the variance of the mean is wanted.
    pub(super) variance: bool,
}

/// What the arguments wish of a scene's render.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish<'a> {
    /// Name of the integrator; `None` leaves it to the scene.
    pub(super) integrator: Option<&'a str>,
    /// Options of the integrator, the last one wins.
    pub(super) settings: &'a [(String, String)],
    /// Names of further layers.
    pub(super) layers: &'a [String],
}

/// An integrator's name, and where its options come from.
struct Choice<'r> {
    name: &'r str,
    /// Whether it stands in for the one that the scene names.
    stands_in: bool,
}

impl Plan {
    /// Brings the scene's wishes and the arguments together.
    ///
    /// # Errors
    /// Names and values that the command line has wrong, and values that the scene has wrong.
    pub(super) fn new(
        wish: &Wish<'_>,
        request: &IntegratorRequest,
        notes: &mut Notes,
    ) -> Result<Self, Failure> {
        let choice = choose(wish, request);
        let given: Options = wish
            .settings
            .iter()
            .map(|(key, value)| (Name::new(key).normalised, OptionValue::parse(value)))
            .collect();
        let mut options = request.options.clone();
        if choice.stands_in {
            options.retain(|name, _| SHARED_OPTIONS.contains(&name.as_str()));
        }
        options.extend(given.clone());
        let mut reader = OptionReader::new(&options);
        let integrator = integrator::from_options(choice.name, &mut reader)
            .map_err(|error| wrong_value(&error, &given, request))?;
        for name in reader.unused() {
            let hint = did_you_mean(&name, reader.used().keys().map(String::as_str));
            let integrator = choice.name;
            let message = format!("integrator \"{integrator}\" has no option \"{name}\"{hint}");
            if given.contains_key(&name) {
                return Err(Failure::Usage(message));
            }
            if !choice.stands_in {
                let location = request.option_locations.get(&name);
                notes.warn(location, format!("{message}; ignored"));
            }
        }
        let used = reader.used().iter();
        let options: Vec<_> = used
            .map(|(name, value)| (name.clone(), value.to_string()))
            .collect();
        if choice.stands_in && wish.integrator.is_none() {
            note_replacement(request, choice.name, &options, notes);
        }
        let mut layers = named_layers(wish.layers)?;
        layers.check(choice.name, &*integrator)?;
        if request.second_moment && !integrator.has_second_moment() {
            let name = choice.name;
            let message = format!("integrator \"{name}\" makes no layer \"moment2\"; left out");
            notes.warn(request.location.as_ref(), message);
        }
        add_scene_layers(&mut layers.aovs, request, notes);
        Ok(Self {
            name: choice.name.to_owned(),
            integrator,
            options,
            aovs: layers.aovs,
            own_layers: layers.own_layers,
            variance: layers.variance,
        })
    }
}

/// Finds out what is wrong with the names in the arguments before any scene is read.
///
/// # Errors
/// [`Failure::Usage`] for an integrator or a layer that does not exist.
pub(super) fn check_names(wish: &Wish<'_>) -> Result<(), Failure> {
    if let Some(name) = wish.integrator.filter(|name| !is_known(name)) {
        let known = integrator::NAMES.map(|(known, _)| known);
        let hint = did_you_mean(name, known);
        let known = known.join(", ");
        return Err(Failure::Usage(format!(
            "unknown integrator \"{name}\"{hint}; there are {known}"
        )));
    }
    named_layers(wish.layers).map(|_| ())
}

/// Warns where integrators do not find some light of a scene.
///
/// - `plans`: each with the name that the message has for it.
pub(super) fn note_unseen_beams<'p>(
    scene: &Scene,
    plans: impl IntoIterator<Item = (&'p str, &'p Plan)>,
    notes: &mut Notes,
) {
    if !scene.lights().has_beams() {
        return;
    }
    let blind = plans
        .into_iter()
        .filter(|(_, plan)| !plan.integrator.shows_traced_light());
    let blind: Vec<String> = blind.map(|(name, _)| format!("\"{name}\"")).collect();
    if !blind.is_empty() {
        let verb = if blind.len() == 1 { "does" } else { "do" };
        let names = blind.join(", ");
        notes.warn(
            None,
            format!("{names} {verb} not find the light of collimated beams; {SEERS_OF_BEAMS} do"),
        );
    }
}

/// The filter that the arguments ask for.
pub(super) fn filter(name: FilterName) -> Option<Filter> {
    Filter::new(match name {
        FilterName::Box => FilterKind::Box { radius: 0.5 },
        FilterName::Tent => FilterKind::Tent { radius: 1.0 },
        FilterName::Gaussian => FilterKind::Gaussian { stddev: 0.5 },
        FilterName::Mitchell => FilterKind::Mitchell {
            b: 1.0 / 3.0,
            c: 1.0 / 3.0,
        },
        FilterName::Catmullrom => FilterKind::CatmullRom,
        FilterName::Lanczos => FilterKind::Lanczos { lobes: 3.0 },
    })
}

fn is_known(name: &str) -> bool {
    let name = integrator::canonical_name(name);
    integrator::NAMES.iter().any(|(known, _)| *known == name)
}

fn choose<'r>(wish: &Wish<'r>, request: &'r IntegratorRequest) -> Choice<'r> {
    let wanted = integrator::canonical_name(&request.name);
    let given = wish.integrator.map(integrator::canonical_name);
    let (name, stands_in) = match given {
        Some(name) => (name, !wanted.is_empty() && name != wanted),
        None if is_known(wanted) => (wanted, false),
        None => (DEFAULT_INTEGRATOR, !wanted.is_empty()),
    };
    Choice { name, stands_in }
}

fn note_replacement(
    request: &IntegratorRequest,
    name: &str,
    options: &[(String, String)],
    notes: &mut Notes,
) {
    let kept: Vec<String> = options
        .iter()
        .filter(|(option, _)| request.options.contains_key(option))
        .map(|(option, value)| format!("{option}={value}"))
        .collect();
    let kept = if kept.is_empty() {
        String::new()
    } else {
        format!(", with its {}", kept.join(" "))
    };
    let message = format!(
        "unknown integrator \"{}\"; \"{name}\" is used instead{kept}",
        request.name
    );
    notes.replace(request.location.as_ref(), message);
}

/// The failure for a value that is wrong: whose fault it is depends on where it comes from.
fn wrong_value(error: &OptionError, given: &Options, request: &IntegratorRequest) -> Failure {
    let message = error.to_string();
    match error {
        OptionError::Value { name, .. } if !given.contains_key(name) => {
            Failure::Scene(vec![Diagnostic {
                severity: Severity::Error,
                location: request.option_locations.get(name).cloned(),
                message,
                is_replacement: false,
            }])
        }
        _ => Failure::Usage(message),
    }
}

/// Layers that are asked for by name.
#[derive(Debug, Default)]
struct NamedLayers {
    aovs: Vec<Aov>,
    own_layers: Vec<String>,
    variance: bool,
}

impl NamedLayers {
    /// Finds out whether an integrator makes the layers.
    ///
    /// # Errors
    /// [`Failure::Usage`] for one that it does not make.
    fn check(&self, name: &str, integrator: &dyn Algorithm) -> Result<(), Failure> {
        let made = integrator.own_layers();
        let missing = self.own_layers.iter().find(|l| !made.contains(&l.as_str()));
        match missing {
            None => Ok(()),
            Some(layer) => Err(Failure::Usage(format!(
                "integrator \"{name}\" has no layer \"{layer}\""
            ))),
        }
    }
}

/// The layers of a list of names, each once.
fn named_layers(names: &[String]) -> Result<NamedLayers, Failure> {
    let mut found = NamedLayers::default();
    for name in names.iter().map(|name| name.trim()) {
        match Aov::from_name(name) {
            Some(aov) if !found.aovs.contains(&aov) => found.aovs.push(aov),
            Some(_) => {}
            None if name == VARIANCE => found.variance = true,
            None if integrator::OWN_LAYERS.concat().contains(&name) => {
                if !found.own_layers.iter().any(|known| known == name) {
                    found.own_layers.push(name.to_owned());
                }
            }
            None => {
                let known = Aov::NAMES.map(|(known, _)| known).into_iter();
                let known: Vec<&str> = known
                    .chain(integrator::OWN_LAYERS.concat())
                    .chain([VARIANCE])
                    .collect();
                let hint = did_you_mean(name, known.iter().copied());
                let known = known.join(", ");
                return Err(Failure::Usage(format!(
                    "unknown layer \"{name}\"{hint}; there are {known}"
                )));
            }
        }
    }
    Ok(found)
}

/// Adds the layers that the scene asks for as `name:kind`; their names are ours, not the scene's.
fn add_scene_layers(aovs: &mut Vec<Aov>, request: &IntegratorRequest, notes: &mut Notes) {
    for entry in &request.aovs {
        let kind = entry.rsplit(':').next().unwrap_or(entry).trim();
        match Aov::from_name(kind) {
            Some(aov) if !aovs.contains(&aov) => aovs.push(aov),
            Some(_) => {}
            None => {
                let hint = did_you_mean(kind, Aov::NAMES.map(|(known, _)| known));
                let message = format!("unknown layer \"{kind}\"{hint}; left out");
                notes.warn(request.location.as_ref(), message);
            }
        }
    }
}

#[cfg(test)]
mod tests;
