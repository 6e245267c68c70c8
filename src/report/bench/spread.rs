//! What several values of one quantity tell.

/// How values are spread: their order statistics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The least.
    pub min: f64,
    /// A quarter is less.
    pub lower_quartile: f64,
    /// Half of them are less.
    pub median: f64,
    /// Three quarters are less.
    pub upper_quartile: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// Order statistics; between two values, linear interpolation. Without any value, and where a
    /// value is not a number, all are NaN.
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let broken = sorted.iter().any(|value| value.is_nan());
        let quantile = |share: f64| {
            let Some(last) = sorted.len().checked_sub(1).filter(|_| !broken) else {
                return f64::NAN;
            };
            let place = share * last as f64;
            let (low, high) = (
                sorted[place.floor() as usize],
                sorted[place.ceil() as usize],
            );
            // Infinite neighbours have no difference.
            if low == high {
                return low;
            }
            low + (place - place.floor()) * (high - low)
        };
        Self {
            min: quantile(0.0),
            lower_quartile: quantile(0.25),
            median: quantile(0.5),
            upper_quartile: quantile(0.75),
            max: quantile(1.0),
        }
    }
}

/// A mean of independent values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Its standard error, from the spread of the values; a single value tells none.
    pub standard_error: Option<f64>,
}

impl Mean {
    /// The mean of some values, NaN for none.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let value = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|x| (x - value).powi(2)).sum();
        let standard_error = (squares / (count - 1.0) / count).sqrt();
        Self {
            value,
            standard_error: (values.len() > 1).then_some(standard_error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_statistics_are_those_counted_by_hand() {
        let odd = Spread::of(&[5.0, 1.0, 2.0, 4.0, 3.0]);
        let expected = Spread {
            min: 1.0,
            lower_quartile: 2.0,
            median: 3.0,
            upper_quartile: 4.0,
            max: 5.0,
        };
        assert_eq!(odd, expected);
        let even = Spread::of(&[4.0, 1.0, 2.0, 3.0]);
        assert_eq!((even.lower_quartile, even.median), (1.75, 2.5));
        let one = Spread::of(&[7.0]);
        assert_eq!((one.min, one.median, one.upper_quartile), (7.0, 7.0, 7.0));
    }

    #[test]
    fn what_is_not_a_number_is_not_hidden() {
        assert!(Spread::of(&[1.0, f64::NAN, 2.0]).median.is_nan());
        assert!(Spread::of(&[1.0, -f64::NAN, 2.0]).max.is_nan());
        assert!(Spread::of(&[]).min.is_nan());
        let with_infinity = Spread::of(&[1.0, f64::INFINITY, f64::INFINITY]);
        assert_eq!(with_infinity.median, f64::INFINITY);
        assert_eq!(with_infinity.min, 1.0);
    }

    #[test]
    fn means_know_their_error() {
        let mean = Mean::of(&[1.0, 2.0, 3.0, 4.0]);
        assert_eq!(mean.value, 2.5);
        // Sample variance 5/3, over four values.
        let error = mean.standard_error.unwrap();
        assert!((error - (5.0_f64 / 12.0).sqrt()).abs() < 1e-12);
        assert_eq!(Mean::of(&[3.0]).standard_error, None);
        assert!(Mean::of(&[]).value.is_nan());
    }
}
