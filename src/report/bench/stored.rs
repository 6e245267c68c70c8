//! Trials as records: what a race keeps of a render, so that it need not be made again.

use serde_json::{Map, Value, json};
use thiserror::Error;
use xxhash_rust::xxh3::xxh3_64;

use super::{Errors, Trial, Work};

/// Changes when old records can no longer be used.
const FORMAT: u64 = 1;

/// Why a record cannot be used.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum RecordError {
    /// It is no JSON, or cut off.
    #[error("it is not whole")]
    Broken,
    /// A field is missing or of another kind.
    #[error("expected {expected} for \"{field}\"")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// What should be there.
        expected: &'static str,
    },
    /// Its content was changed.
    #[error("its checksum is not that of its content")]
    Checksum,
    /// It belongs to another render.
    #[error("it is the record of another render")]
    Other,
}

/// The text of a trial's record.
///
/// - `key`: all that decides what is measured.
pub fn stored_trial(key: &Value, trial: &Trial) -> String {
    let content = json!({ "format": FORMAT, "key": key, "trial": fields(trial) });
    let sum = checksum(&content);
    let mut record = content;
    record["checksum"] = json!(sum);
    format!("{record:#}\n")
}

/// The trial of a record.
///
/// - `text`: of [`stored_trial`].
/// - `key`: of the render that is looked for.
///
/// # Errors
/// For a text that is no record, was changed, or is the record of another render.
pub fn read_trial(text: &str, key: &Value) -> Result<Trial, RecordError> {
    let mut record: Value = serde_json::from_str(text).map_err(|_| RecordError::Broken)?;
    let fields = record.as_object_mut().ok_or(RecordError::Broken)?;
    let sum = fields.remove("checksum").ok_or(RecordError::Broken)?;
    if sum.as_str() != Some(checksum(&record).as_str()) {
        return Err(RecordError::Checksum);
    }
    if record["format"] != FORMAT || record["key"] != *key {
        return Err(RecordError::Other);
    }
    trial(&record["trial"])
}

fn checksum(content: &Value) -> String {
    format!("{:016x}", xxh3_64(content.to_string().as_bytes()))
}

/// JSON has neither infinity nor what is not a number: these are texts.
fn number(value: f64) -> Value {
    if value.is_finite() {
        json!(value)
    } else {
        json!(value.to_string())
    }
}

fn fields(trial: &Trial) -> Value {
    let errors = &trial.errors;
    let statistics = trial.statistics.iter();
    let statistics = statistics.map(|(name, value)| (name.clone(), number(*value)));
    let work = trial.work.map(|work| {
        json!({
            "passes": work.passes,
            "spp": work.samples,
            "paths": work.paths,
            "rays": work.rays,
            "rejected": work.rejected,
        })
    });
    json!({
        "scene": trial.scene,
        "integrator": trial.integrator,
        "budget": trial.budget,
        "seed": trial.seed,
        "wall_s": number(trial.wall_seconds),
        "cpu_s": number(trial.cpu_seconds),
        "overrun_s": number(trial.overrun_seconds),
        "work": work,
        "mse": number(errors.mse),
        "err": number(errors.luminance_mse),
        "relmse": number(errors.relative_mse),
        "reference_noise": errors.reference_noise.map(number),
        "mean_ratio": number(errors.mean_ratio),
        "flip": number(errors.flip),
        "statistics": statistics.collect::<Map<String, Value>>(),
    })
}

/// The fields of an object, each asked for with its kind.
struct Fields<'a>(&'a Value);

impl Fields<'_> {
    fn text(&self, field: &'static str) -> Result<String, RecordError> {
        let expected = "a text";
        let text = self.0[field].as_str();
        let text = text.ok_or(RecordError::Field { field, expected })?;
        Ok(text.to_owned())
    }

    fn count(&self, field: &'static str) -> Result<u64, RecordError> {
        let expected = "a whole number";
        let count = self.0[field].as_u64();
        count.ok_or(RecordError::Field { field, expected })
    }

    fn small_count(&self, field: &'static str) -> Result<u32, RecordError> {
        let expected = "a whole number below 2^32";
        u32::try_from(self.count(field)?).map_err(|_| RecordError::Field { field, expected })
    }

    fn number(&self, field: &'static str) -> Result<f64, RecordError> {
        number_in(&self.0[field], field)
    }
}

fn number_in(value: &Value, field: &'static str) -> Result<f64, RecordError> {
    let expected = "a number";
    let number = match value {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => text.parse().ok(),
        _ => None,
    };
    number.ok_or(RecordError::Field { field, expected })
}

fn trial(value: &Value) -> Result<Trial, RecordError> {
    let fields = Fields(value);
    let optional = |field| Some(&value[field]).filter(|value| !value.is_null());
    let noise = optional("reference_noise").map(|noise| number_in(noise, "reference_noise"));
    let statistics = value["statistics"].as_object().into_iter().flatten();
    let statistics =
        statistics.map(|(name, value)| Ok((name.clone(), number_in(value, "statistics")?)));
    Ok(Trial {
        scene: fields.text("scene")?,
        integrator: fields.text("integrator")?,
        budget: fields.text("budget")?,
        seed: fields.count("seed")?,
        wall_seconds: fields.number("wall_s")?,
        cpu_seconds: fields.number("cpu_s")?,
        overrun_seconds: fields.number("overrun_s")?,
        work: optional("work").map(work).transpose()?,
        errors: Errors {
            mse: fields.number("mse")?,
            luminance_mse: fields.number("err")?,
            relative_mse: fields.number("relmse")?,
            reference_noise: noise.transpose()?,
            mean_ratio: fields.number("mean_ratio")?,
            flip: fields.number("flip")?,
        },
        statistics: statistics.collect::<Result<_, _>>()?,
    })
}

fn work(value: &Value) -> Result<Work, RecordError> {
    let fields = Fields(value);
    Ok(Work {
        passes: fields.small_count("passes")?,
        samples: fields.small_count("spp")?,
        paths: fields.count("paths")?,
        rays: fields.count("rays")?,
        rejected: fields.count("rejected")?,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::trial;
    use super::*;

    #[test]
    fn what_is_stored_comes_back_to_the_last_bit() {
        let key = json!({ "seed": 7, "options": { "a": 0.1 } });
        let mut stored = trial("path", "1 s", u64::MAX, 0.1 + 0.2);
        stored.errors.mse = f64::INFINITY;
        stored.wall_seconds = 1.0 / 3.0;
        let text = stored_trial(&key, &stored);
        assert_eq!(read_trial(&text, &key), Ok(stored.clone()));
        stored.work = None;
        stored.errors.reference_noise = None;
        let text = stored_trial(&key, &stored);
        assert_eq!(read_trial(&text, &key), Ok(stored));
    }

    #[test]
    fn damage_and_other_renders_are_found() {
        let key = json!({ "seed": 7 });
        let text = stored_trial(&key, &trial("path", "1 s", 7, 0.25));
        let half = &text[..text.len() / 2];
        assert_eq!(read_trial(half, &key), Err(RecordError::Broken));
        assert_eq!(read_trial("{}", &key), Err(RecordError::Broken));
        let changed = text.replace("0.25", "0.125");
        assert_ne!(changed, text);
        assert_eq!(read_trial(&changed, &key), Err(RecordError::Checksum));
        let other = json!({ "seed": 8 });
        assert_eq!(read_trial(&text, &other), Err(RecordError::Other));
        let trial = json!({ "scene": "box" });
        let mut content = json!({ "format": FORMAT, "key": key, "trial": trial });
        content["checksum"] = json!(checksum(&content));
        let expected = RecordError::Field {
            field: "integrator",
            expected: "a text",
        };
        assert_eq!(read_trial(&content.to_string(), &key), Err(expected));
    }
}
