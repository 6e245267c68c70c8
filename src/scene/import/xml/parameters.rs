//! `$name`: values from the command line and from `<default>`.

use std::collections::BTreeMap;

use super::diagnostics::Diagnostics;
use super::source::Location;
use super::suggest::did_you_mean;

/// The most bytes that parameters insert into a scene. Each may be made of ten others, and so on.
const MOST_INSERTED: usize = 1 << 24;

/// The parameters known so far. The first definition of a name wins, the command line before all.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    known: BTreeMap<String, Parameter>,
    /// Uses of names that had no value then; judged at the end, when all names are known.
    undefined: Vec<(String, Location)>,
    /// Bytes inserted so far, and where they became too many.
    inserted: usize,
    overflow: Option<Location>,
}

#[derive(Debug)]
struct Parameter {
    value: String,
    /// `None` for the command line.
    defined_at: Option<Location>,
    used: bool,
}

impl Parameters {
    /// Takes the definitions of the command line; a later one replaces an earlier one.
    pub(super) fn new(definitions: &[(String, String)]) -> Self {
        let parameter = |value: &String| Parameter {
            value: value.clone(),
            defined_at: None,
            used: false,
        };
        let known = definitions
            .iter()
            .map(|(name, value)| (name.clone(), parameter(value)))
            .collect();
        Self {
            known,
            ..Self::default()
        }
    }

    /// Adds a `<default>`.
    pub(super) fn define(&mut self, name: &str, value: String, location: Location) {
        self.known.entry(name.to_owned()).or_insert(Parameter {
            value,
            defined_at: Some(location),
            used: false,
        });
    }

    /// Replaces each `$name` in `text`, the longest known name first. Inserted values are not
    /// looked at again. An undefined name is noted and `None` returned, as where values become too
    /// long.
    pub(super) fn substitute(&mut self, text: &str, location: &Location) -> Option<String> {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        let mut complete = true;
        while let Some(dollar) = rest.find('$') {
            result.push_str(&rest[..dollar]);
            let after = &rest[dollar + 1..];
            let is_name = |c: char| c.is_alphanumeric() || c == '_';
            let word = &after[..after.find(|c| !is_name(c)).unwrap_or(after.len())];
            if let Some((name, parameter)) = self.longest_prefix(after) {
                parameter.used = true;
                result.push_str(&parameter.value);
                self.inserted += parameter.value.len();
                rest = &after[name..];
                if self.inserted > MOST_INSERTED {
                    self.overflow.get_or_insert_with(|| location.clone());
                    return None;
                }
            } else if word.is_empty() {
                result.push('$');
                rest = after;
            } else {
                self.undefined.push((word.to_owned(), location.clone()));
                complete = false;
                rest = &after[word.len()..];
            }
        }
        result.push_str(rest);
        complete.then_some(result)
    }

    /// The longest known name that `text` starts with, as its length in bytes.
    fn longest_prefix(&mut self, text: &str) -> Option<(usize, &mut Parameter)> {
        self.known
            .iter_mut()
            .filter(|(name, _)| !name.is_empty() && text.starts_with(name.as_str()))
            .max_by_key(|(name, _)| name.len())
            .map(|(name, parameter)| (name.len(), parameter))
    }

    /// Reports undefined names, values that became too long, and definitions of the command line that nothing uses.
    pub(super) fn report(&self, problems: &Diagnostics) {
        if let Some(location) = &self.overflow {
            let message = format!("the values of parameters fill more than {MOST_INSERTED} bytes");
            return problems.error(location, message);
        }
        for (name, location) in &self.undefined {
            let later = self
                .known
                .get(name)
                .and_then(|parameter| parameter.defined_at.as_ref());
            let hint = match later {
                Some(later) => format!("; its <default> at {later} comes too late"),
                None => did_you_mean(name, self.known.keys().map(String::as_str)),
            };
            problems.error(location, format!("undefined parameter \"${name}\"{hint}"));
        }
        let used = self.known.iter().filter(|(_, parameter)| parameter.used);
        let used: Vec<&str> = used.map(|(name, _)| name.as_str()).collect();
        for (name, parameter) in &self.known {
            if parameter.defined_at.is_none() && !parameter.used {
                let hint = did_you_mean(name, used.iter().copied());
                problems.warning_without_location(format!(
                    "the scene does not use the parameter \"{name}\" given by -D{hint}"
                ));
            }
        }
    }
}
