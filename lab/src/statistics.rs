//! Rank correlation, and how sure a figure over objects is.

use crate::mesh::Chance;

/// Ranks from 1; those of equal values are the mean of the places they share.
///
/// NaN ranks above every number.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for tied in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let rank = before as f64 + (tied.len() + 1) as f64 / 2.0;
        for &index in tied {
            ranks[index] = rank;
        }
        before += tied.len();
    }
    ranks
}

/// Spearman's rank correlation of a prediction with the truth, ties by average ranks.
///
/// `None` where the truth is the same throughout, so that there is no order to find; 0 where the
/// prediction is.
///
/// # Panics
///
/// If their lengths differ.
pub fn spearman(prediction: &[f64], truth: &[f64]) -> Option<f64> {
    assert_eq!(prediction.len(), truth.len(), "a prediction for each value");
    let (a, b) = (ranks(prediction), ranks(truth));
    let middle = (a.len() as f64 + 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum()
    };
    let (spread, truth_spread) = (product(&a, &a), product(&b, &b));
    if truth_spread <= 0.0 {
        return None;
    }
    Some(if spread > 0.0 { product(&a, &b) / (spread * truth_spread).sqrt() } else { 0.0 })
}

/// Resamples behind every interval.
pub const RESAMPLES: usize = 4000;

/// Seed of the resamples: the same figures give the same intervals, and figures over the same
/// number of objects the same resamples.
const SEED: u64 = 95;

/// The 95 % bootstrap interval of a statistic over objects (Efron, 1979; percentiles): objects are
/// drawn with replacement, as many as there are, and the statistic is computed of each draw.
///
/// The statistic gets indices of objects; draws of which it has none are left out. `None` below two
/// objects, or where most draws give nothing.
pub fn interval(objects: usize, statistic: impl Fn(&[usize]) -> Option<f64>) -> Option<[f64; 2]> {
    if objects < 2 {
        return None;
    }
    let mut chance = Chance::new(SEED);
    let mut drawn = vec![0; objects];
    let mut values = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        drawn.fill_with(|| chance.below(objects as u32) as usize);
        values.extend(statistic(&drawn).filter(|value| value.is_finite()));
    }
    if values.len() < RESAMPLES / 2 {
        return None;
    }
    values.sort_by(f64::total_cmp);
    Some([quantile(&values, 0.025), quantile(&values, 0.975)])
}

/// A quantile of ascending values, linear between them.
fn quantile(ascending: &[f64], share: f64) -> f64 {
    let place = share * (ascending.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(ascending.len() - 1);
    ascending[below] + (ascending[above] - ascending[below]) * (place - below as f64)
}

/// The mean, or `None` of nothing.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0u32);
    for value in values {
        sum += value;
        count += 1;
    }
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_share_their_ranks() {
        assert_eq!(ranks(&[10.0, 20.0, 10.0, 5.0, 10.0]), [3.0, 5.0, 3.0, 1.0, 3.0]);
        assert_eq!(ranks(&[0.0, -0.0]), [1.5, 1.5]);
        assert!(ranks(&[]).is_empty());
    }

    #[test]
    fn spearman_is_scipys() {
        // scipy.stats.spearmanr, SciPy 1.17.1.
        let truth = [1.0, 2.0, 3.0, 4.0, 5.0];
        for (prediction, expected) in [
            ([5.0, 6.0, 7.0, 8.0, 7.0], 0.820_782_681_668_123_4),
            ([1.0, 2.0, 3.0, 4.0, 5.0], 1.0),
            ([5.0, 4.0, 3.0, 2.0, 1.0], -1.0),
            ([2.0, 1.0, 4.0, 3.0, 5.0], 0.8),
            ([1.0, 1.0, 2.0, 2.0, 2.0], 0.866_025_403_784_438_6),
        ] {
            let found = spearman(&prediction, &truth).unwrap();
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let prediction = [0.3, 0.1, 0.3, 0.0, 0.7, 0.2, 0.2, 0.2, 0.9, 0.5];
        let truth = [0.0, 0.0, 0.1, 0.0, 0.4, 0.3, 0.1, 0.1, 0.4, 0.2];
        let found = spearman(&prediction, &truth).unwrap();
        assert!((found - 0.727_906_420_091_385_3).abs() < 1e-12, "{found}");
    }

    #[test]
    fn without_an_order_there_is_no_correlation() {
        assert_eq!(spearman(&[1.0, 2.0, 3.0], &[4.0; 3]), None);
        assert_eq!(spearman(&[4.0; 3], &[1.0, 2.0, 3.0]), Some(0.0));
        assert_eq!(spearman(&[], &[]), None);
    }

    #[test]
    fn an_interval_is_the_same_every_time_and_holds_the_mean() {
        let values = [0.2, 0.5, 0.9, 0.4, 0.7, 0.6, 0.1, 0.8];
        let statistic = |drawn: &[usize]| mean(drawn.iter().map(|&index| values[index]));
        let [low, high] = interval(values.len(), statistic).unwrap();
        assert_eq!(interval(values.len(), statistic), Some([low, high]));
        // The mean is 0.525, its standard error 0.097.
        assert!((low - 0.335).abs() < 0.02 && (high - 0.715).abs() < 0.02, "{low} {high}");
        assert_eq!(interval(1, |_| Some(1.0)), None);
        assert_eq!(interval(5, |_| None), None);
        assert_eq!(interval(5, |_| Some(3.0)), Some([3.0, 3.0]));
    }

    #[test]
    fn quantiles_lie_between_values() {
        assert_eq!(quantile(&[0.0, 1.0, 2.0], 0.25), 0.5);
        assert_eq!(quantile(&[7.0], 0.975), 7.0);
    }
}
