//! Options of integrators: one map, filled from the scene file and the command line.

use std::collections::{BTreeMap, BTreeSet};

use super::import::xml::did_you_mean;

/// Options by their names.
pub type Options = BTreeMap<String, OptionValue>;

/// Value of an option, as far as its text tells.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionValue {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Float(f64),
    /// Anything else.
    Text(String),
}

impl OptionValue {
    /// Reads the text after the `=` of `--set KEY=VALUE`.
    pub fn parse(text: &str) -> Self {
        match text {
            "true" => return Self::Boolean(true),
            "false" => return Self::Boolean(false),
            _ => {}
        }
        if let Ok(number) = text.parse() {
            return Self::Integer(number);
        }
        match text.parse() {
            Ok(number) => Self::Float(number),
            Err(_) => Self::Text(text.to_owned()),
        }
    }
}

impl std::fmt::Display for OptionValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Boolean(value) => value.fmt(f),
            Self::Integer(value) => value.fmt(f),
            Self::Float(value) => value.fmt(f),
            Self::Text(value) => value.fmt(f),
        }
    }
}

/// Why an integrator could not be made from its options.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// The value is of another kind than the option, or out of its range.
    #[error("option \"{name}\": found \"{found}\", expected {expected}")]
    Value {
        /// The option.
        name: String,
        /// Its value's text.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// No integrator has this name.
    #[error("unknown integrator \"{name}\"")]
    UnknownIntegrator {
        /// The name.
        name: String,
    },
}

/// Reads options with their kinds and defaults, and remembers which it was asked for.
#[derive(Debug)]
pub struct OptionReader<'o> {
    options: &'o Options,
    /// Every option asked for, with the value that is used: given or default.
    used: BTreeMap<String, OptionValue>,
}

impl<'o> OptionReader<'o> {
    /// Starts reading.
    pub fn new(options: &'o Options) -> Self {
        Self {
            options,
            used: BTreeMap::new(),
        }
    }

    /// A whole number in a range.
    ///
    /// # Errors
    /// [`OptionError::Value`] for another kind of value, or one out of the range.
    pub fn integer(
        &mut self,
        name: &str,
        range: std::ops::RangeInclusive<i64>,
        default: i64,
    ) -> Result<i64, OptionError> {
        let value = self.take(name, OptionValue::Integer(default));
        let number = match value {
            OptionValue::Integer(number) => Some(number),
            // Old files write whole numbers as floats.
            OptionValue::Float(number) if number.fract() == 0.0 => Some(number as i64),
            _ => None,
        };
        let expected = || match (*range.start(), *range.end()) {
            (low, i64::MAX) => format!("a whole number from {low} on"),
            (low, high) => format!("a whole number from {low} to {high}"),
        };
        number
            .filter(|number| range.contains(number))
            .ok_or_else(|| wrong(name, &value, expected()))
    }

    /// A number in a range.
    ///
    /// # Errors
    /// [`OptionError::Value`] for another kind of value, or one out of the range.
    pub fn float(
        &mut self,
        name: &str,
        range: std::ops::RangeInclusive<f64>,
        default: f64,
    ) -> Result<f64, OptionError> {
        let value = self.take(name, OptionValue::Float(default));
        let number = match value {
            OptionValue::Integer(number) => Some(number as f64),
            OptionValue::Float(number) => Some(number),
            _ => None,
        };
        let expected = || match (*range.start(), *range.end()) {
            (low, high) if high.is_infinite() => format!("a number from {low} on"),
            (low, high) => format!("a number from {low} to {high}"),
        };
        number
            .filter(|number| number.is_finite() && range.contains(number))
            .ok_or_else(|| wrong(name, &value, expected()))
    }

    /// One or several numbers in a range, with commas between, or slashes where commas mean something else.
    ///
    /// # Errors
    /// [`OptionError::Value`] for anything else.
    pub fn floats(
        &mut self,
        name: &str,
        range: std::ops::RangeInclusive<f64>,
        default: &str,
    ) -> Result<Vec<f64>, OptionError> {
        let value = self.take(name, OptionValue::Text(default.to_owned()));
        let text = value.to_string();
        let numbers = text.split([',', '/']).map(|part| {
            let number = part.trim().parse().ok();
            number.filter(|number| range.contains(number))
        });
        let expected = || {
            let (low, high) = (range.start(), range.end());
            format!("numbers from {low} to {high} with commas between")
        };
        numbers
            .collect::<Option<Vec<f64>>>()
            .ok_or_else(|| wrong(name, &value, expected()))
    }

    /// The error for an option that was read, but whose value will not do.
    pub fn refused(&self, name: &str, expected: &str) -> OptionError {
        let found = self.used.get(name).map(ToString::to_string);
        OptionError::Value {
            name: name.to_owned(),
            found: found.unwrap_or_default(),
            expected: expected.to_owned(),
        }
    }

    /// `true` or `false`.
    ///
    /// # Errors
    /// [`OptionError::Value`] for another kind of value.
    pub fn boolean(&mut self, name: &str, default: bool) -> Result<bool, OptionError> {
        match self.take(name, OptionValue::Boolean(default)) {
            OptionValue::Boolean(value) => Ok(value),
            other => Err(wrong(name, &other, "true or false".to_owned())),
        }
    }

    /// One of several names.
    ///
    /// # Errors
    /// [`OptionError::Value`] for any other text.
    pub fn choice(
        &mut self,
        name: &str,
        choices: &[&str],
        default: &str,
    ) -> Result<String, OptionError> {
        let value = self.take(name, OptionValue::Text(default.to_owned()));
        match &value {
            OptionValue::Text(text) if choices.contains(&text.as_str()) => Ok(text.clone()),
            other => {
                let hint = did_you_mean(&other.to_string(), choices.iter().copied());
                let expected = format!("one of {}{hint}", choices.join(", "));
                Err(wrong(name, other, expected))
            }
        }
    }

    /// The options that were given and never asked for.
    pub fn unused(&self) -> Vec<String> {
        let asked: BTreeSet<_> = self.used.keys().collect();
        self.options
            .keys()
            .filter(|name| !asked.contains(name))
            .cloned()
            .collect()
    }

    /// All options that were asked for, with the values in use.
    pub fn used(&self) -> &BTreeMap<String, OptionValue> {
        &self.used
    }

    fn take(&mut self, name: &str, default: OptionValue) -> OptionValue {
        let value = self.options.get(name).cloned().unwrap_or(default);
        self.used.insert(name.to_owned(), value.clone());
        value
    }
}

fn wrong(name: &str, found: &OptionValue, expected: String) -> OptionError {
    OptionError::Value {
        name: name.to_owned(),
        found: found.to_string(),
        expected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(pairs: &[(&str, &str)]) -> Options {
        pairs
            .iter()
            .map(|(k, v)| ((*k).to_owned(), OptionValue::parse(v)))
            .collect()
    }

    #[test]
    fn kinds_and_ranges_are_checked() {
        let given = options(&[
            ("depth", "5"),
            ("rr", "2.0"),
            ("hide", "true"),
            ("mis", "maxi"),
        ]);
        let mut reader = OptionReader::new(&given);
        assert_eq!(reader.integer("depth", -1..=i64::MAX, 7), Ok(5));
        assert_eq!(reader.integer("rr", 1..=9, 7), Ok(2));
        assert_eq!(reader.integer("absent", 1..=9, 7), Ok(7));
        assert_eq!(reader.boolean("hide", false), Ok(true));
        let error = reader
            .choice("mis", &["balance", "power"], "power")
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "option \"mis\": found \"maxi\", expected one of balance, power"
        );
        let error = reader.integer("depth", 6..=i64::MAX, 7).unwrap_err();
        assert!(
            error.to_string().contains("a whole number from 6 on"),
            "{error}"
        );
        assert!(reader.boolean("depth", false).is_err());
    }

    #[test]
    fn lists_have_one_or_more_numbers() {
        let given = options(&[
            ("a", "5,10, 50"),
            ("b", "7"),
            ("c", "5;6"),
            ("e", "2/8"),
            ("d", "5,600"),
        ]);
        let mut reader = OptionReader::new(&given);
        let mut floats = |name| reader.floats(name, 0.0..=100.0, "1,2");
        assert_eq!(floats("a"), Ok(vec![5.0, 10.0, 50.0]));
        assert_eq!(floats("b"), Ok(vec![7.0]));
        assert_eq!(floats("absent"), Ok(vec![1.0, 2.0]));
        assert_eq!(floats("e"), Ok(vec![2.0, 8.0]));
        assert!(floats("c").is_err());
        let error = floats("d").unwrap_err().to_string();
        assert!(error.contains("numbers from 0 to 100"), "{error}");
    }

    #[test]
    fn options_that_nobody_asked_for_are_known() {
        let given = options(&[("depth", "5"), ("dpeth", "5")]);
        let mut reader = OptionReader::new(&given);
        reader.integer("depth", 0..=9, 0).unwrap();
        reader.boolean("hide", true).unwrap();
        assert_eq!(reader.unused(), ["dpeth"]);
        assert_eq!(reader.used().len(), 2);
    }
}
