//! Which pixels of a picture are held out, to estimate its error from: with known probabilities, high where error is
//! likely, so that each counts by the inverse of its own (Hansen and Hurwitz 1943, "On the Theory of Sampling from Finite
//! Populations"; systematically, Madow 1949).

/// The part of the held-out pixels that is taken from all with equal probabilities: error may be where none is expected.
const EQUAL_PART: f64 = 0.2;

/// A pixel that is held out: its index among those that could be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChosenPixel {
    pub(crate) pixel: usize,
    /// How often it is chosen; at least once.
    pub(crate) times: u32,
    /// The expected number of times, as a multiple of the mean over all pixels.
    pub(crate) density: f64,
    /// The probability that it is chosen at all.
    pub(super) chance: f64,
}

/// Chooses pixels by their weights. All choices cost about `budget`, where each of a pixel costs what `cost` gives;
/// `random`, in 0..1, decides on them.
pub(crate) fn hold_out(
    weights: &[f32],
    cost: impl Fn(usize) -> f64,
    budget: f64,
    random: f32,
) -> Vec<ChosenPixel> {
    let count = weights.len() as f64;
    let (mut all_weights, mut all_costs, mut weighted_costs) = (0.0, 0.0, 0.0);
    for (pixel, &weight) in weights.iter().enumerate() {
        let (weight, cost) = (f64::from(weight), cost(pixel));
        all_weights += weight;
        all_costs += cost;
        weighted_costs += cost * weight;
    }
    // The density of a pixel is the sum of an equal part and of one in proportion to its weight.
    let [equal, per_weight] = match all_weights > 0.0 {
        true => [EQUAL_PART, (1.0 - EQUAL_PART) * count / all_weights],
        false => [1.0, 0.0],
    };
    let per_choice = (equal * all_costs + per_weight * weighted_costs) / count;
    let step = count / (budget / per_choice).ceil();
    let mut next = f64::from(random) * step;
    let mut held_out = Vec::new();
    let mut sum = 0.0;
    for (pixel, &weight) in weights.iter().enumerate() {
        let density = equal + per_weight * f64::from(weight);
        sum += density;
        let mut times = 0;
        while next < sum {
            next += step;
            times += 1;
        }
        if times > 0 {
            held_out.push(ChosenPixel {
                pixel,
                times,
                density,
                chance: (density / step).min(1.0),
            });
        }
    }
    held_out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    /// Whatever the weights, what is chosen sums up to the sum over all pixels, on average, for about the budget.
    #[test]
    fn choices_are_unbiased_and_cost_the_budget() {
        let mut random = Random::new(1);
        let weights: Vec<f32> = (0..500).map(|_| random.unit().powi(8)).collect();
        let values: Vec<f64> = (0..500).map(|_| f64::from(random.unit())).collect();
        let cost = |pixel: usize| 1.0 + (pixel % 7) as f64;
        let (mut mean, mut costs) = (0.0, 0.0);
        const RUNS: u32 = 4096;
        for run in 0..RUNS {
            let start = (run as f32 + 0.5) / RUNS as f32;
            let held_out = hold_out(&weights, cost, 400.0, start);
            let choices: u32 = held_out.iter().map(|chosen| chosen.times).sum();
            let value = |of: &ChosenPixel| f64::from(of.times) * values[of.pixel] / of.density;
            let sum: f64 = held_out.iter().map(value).sum();
            mean += sum / f64::from(choices) / f64::from(RUNS);
            let cost = |of: &ChosenPixel| f64::from(of.times) * cost(of.pixel);
            costs += held_out.iter().map(cost).sum::<f64>() / f64::from(RUNS);
        }
        let exact = values.iter().sum::<f64>() / 500.0;
        assert!((mean / exact - 1.0).abs() < 0.01, "{mean} {exact}");
        assert!((costs / 400.0 - 1.0).abs() < 0.02, "{costs}");
    }

    #[test]
    fn without_weights_all_pixels_are_alike() {
        let held_out = hold_out(&[0.0; 12], |_| 1.0, 4.0, 0.5);
        let pixels: Vec<usize> = held_out.iter().map(|chosen| chosen.pixel).collect();
        assert_eq!(pixels, [1, 4, 7, 10]);
        assert!(held_out.iter().all(|chosen| chosen.density == 1.0));
    }
}
