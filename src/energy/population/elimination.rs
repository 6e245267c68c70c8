//! Who survives.

/// Probability of surviving for each member, in proportion to its strength, one at most.
///
/// The probabilities sum to `survivors`, or are all one where there are no more members than that.
///
/// - `strengths`: not negative.
///
/// ```
/// use lumiflow::energy::survival_probabilities;
/// assert_eq!(survival_probabilities(&[1.0, 1.0, 2.0], 2.0), [0.5, 0.5, 1.0]);
/// // The strongest cannot survive more than once: the others share what is left.
/// assert_eq!(survival_probabilities(&[1.0, 1.0, 98.0], 2.0), [0.5, 0.5, 1.0]);
/// assert_eq!(survival_probabilities(&[1.0, 2.0], 3.0), [1.0, 1.0]);
/// ```
pub fn survival_probabilities(strengths: &[f64], survivors: f64) -> Vec<f64> {
    let mut probabilities = vec![1.0; strengths.len()];
    if strengths.len() as f64 <= survivors {
        return probabilities;
    }
    let mut order: Vec<usize> = (0..strengths.len()).collect();
    order.sort_by(|a, b| strengths[*b].total_cmp(&strengths[*a]));
    // What each has together with all weaker ones; summed from the weakest, so that none is lost.
    let mut rests = vec![0.0; order.len() + 1];
    for (place, index) in order.iter().enumerate().rev() {
        rests[place] = rests[place + 1] + strengths[*index];
    }
    // Those that surely survive are set apart, strongest first, until the rest can share.
    let mut places = survivors;
    let mut sure = 0;
    while places > 1.0 && strengths[order[sure]] * places >= rests[sure] {
        places -= 1.0;
        sure += 1;
    }
    for index in &order[sure..] {
        probabilities[*index] = (strengths[*index] * places / rests[sure]).min(1.0);
    }
    probabilities
}

/// Systematic resampling: a function that decides for one member after the other whether it survives,
/// so that the number of survivors is the sum of the probabilities, rounded up or down.
///
/// - `u`: uniform in `[0, 1)`.
///
/// Source: Kitagawa 1996.
pub(super) fn systematic(u: f64) -> impl FnMut(f64) -> bool {
    let mut before = u;
    move |probability: f64| {
        let after = before + probability;
        let survives = after.floor() > before.floor();
        before = after;
        survives
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_proportional_and_sum_up() {
        let strengths: Vec<f64> = (0..100)
            .map(|i| f64::from(i) + if i > 90 { 1000.0 } else { 0.5 })
            .collect();
        let probabilities = survival_probabilities(&strengths, 37.0);
        let sum: f64 = probabilities.iter().sum();
        assert!((sum - 37.0).abs() < 1e-9, "{sum}");
        let scale = probabilities[0] / strengths[0];
        for (strength, probability) in strengths.iter().zip(&probabilities) {
            assert!((probability - (scale * strength).min(1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_weak_are_never_left_without_a_chance() {
        let probabilities = survival_probabilities(&[1e-30, 1e30, 1.0, 1.0], 2.0);
        assert!(probabilities.iter().all(|p| *p > 0.0), "{probabilities:?}");
        assert!((probabilities[2] - 0.5).abs() < 1e-12, "{probabilities:?}");
    }

    #[test]
    fn systematic_resampling_keeps_the_sum_and_the_chances() {
        let probabilities = [0.3, 0.9, 0.05, 1.0, 0.75];
        let mut survivals = [0; 5];
        const COUNT: u32 = 1000;
        for step in 0..COUNT {
            let mut survives = systematic((f64::from(step) + 0.5) / f64::from(COUNT));
            let survived = probabilities.map(&mut survives);
            let count = survived.iter().filter(|survived| **survived).count();
            assert_eq!(count, 3);
            for (sum, survived) in survivals.iter_mut().zip(survived) {
                *sum += u32::from(survived);
            }
        }
        for (probability, survivals) in probabilities.iter().zip(survivals) {
            let share = f64::from(survivals) / f64::from(COUNT);
            assert!((share - probability).abs() < 2e-3, "{share}, {probability}");
        }
    }
}
