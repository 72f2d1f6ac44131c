//! How sure a ray's colour is: the loss and the gain of ActiveNeRF (Pan et al., 2022).
//!
//! Every point has a variance of its colour beside the colour; with the weights `w_i` and the light
//! `T_end` of [`volume`](crate::volume):
//!
//! ```text
//! v_i  = LEAST + softplus(raw_i)
//! V    = sum_i w_i^2 v_i + T_end^2 LEAST
//! loss = mean_c (C - truth)^2 / (2 V) + ln(V) / 2 + SPARSENESS mean_i sigma_i
//! gain = sum_i v_i - 1 / (1 / v_i + w_i^2 / V) = sum_i w_i^2 v_i^2 / (V + w_i^2 v_i)
//! ```
//!
//! The gain is the variance that the photo of the ray is expected to take away: Bayes' rule for each
//! point, the others of the ray held as they are. Constants are the authors'.
//!
//! Where we depart from them: the known background has the least variance too, as a last point of the
//! ray. Without it V is 0 on empty rays, so that the loss has no lower end. Densities are averaged over
//! all steps of a ray through the middle of the unit sphere, of which those in space known to be empty
//! count as 0.

use crate::volume::{Samples, Seen, Slopes, depth_slope, sigmoid, softplus};

/// The least variance of a colour.
const LEAST: f32 = 0.01;
/// What density costs: it keeps space empty where that harms no photo.
const SPARSENESS: f32 = 0.01;

/// What rays see, and how sure it is.
#[derive(Clone, Debug)]
pub struct Sight {
    seen: Seen,
    raw: Vec<f32>,       // (points)
    of_points: Vec<f32>, // (points), v_i
    /// Of the colours that are seen, `V`; shape (rays).
    pub variances: Vec<f32>,
}

/// The mean loss of rays, and its derivatives by what a field gave.
pub struct Loss {
    pub value: f32,
    pub slopes: Slopes,
    /// By raw variances; shape (points).
    pub by_variance: Vec<f32>,
}

impl Sight {
    /// Of what is seen, and raw variances of all samples; shape (points).
    pub fn new(seen: Seen, raw: Vec<f32>, samples: &Samples) -> Self {
        let of_points: Vec<f32> = raw.iter().map(|&raw| LEAST + softplus(raw)).collect();
        let mut variances = Vec::with_capacity(seen.colours.len());
        for range in samples.ranges() {
            let mut left = 1.0;
            let mut variance = 0.0;
            for i in range {
                left = passes(&seen, i);
                let weight = seen.light[i] - left;
                variance += weight * weight * of_points[i];
            }
            variances.push(variance + left * left * LEAST);
        }
        Self { seen, raw, of_points, variances }
    }

    /// The loss where the photos have these colours; shape (rays, 3).
    pub fn loss(&self, samples: &Samples, truth: &[[f32; 3]]) -> Loss {
        let rays = truth.len().max(1) as f32;
        let all_steps = 2.0 / samples.step;
        let (mut value, mut by_ray) = (0.0, Vec::with_capacity(truth.len()));
        let mut by_ray_variance = Vec::with_capacity(truth.len());
        for ((found, wanted), &variance) in self.seen.colours.iter().zip(truth).zip(&self.variances)
        {
            let off: [f32; 3] = std::array::from_fn(|c| found[c] - wanted[c]);
            let square = off.iter().map(|off| off * off).sum::<f32>() / 3.0;
            value += (0.5 * square / variance + 0.5 * variance.ln()) / rays;
            by_ray.push(off.map(|off| off / (3.0 * variance * rays)));
            by_ray_variance.push(0.5 * (1.0 - square / variance) / (variance * rays));
        }
        let mut slopes = self.seen.slopes(samples, &by_ray);
        let mut by_variance = vec![0.0; self.raw.len()];
        let of_density = SPARSENESS / (all_steps * samples.step * rays);
        for (range, slope) in samples.ranges().zip(by_ray_variance) {
            let Some(last) = range.clone().next_back() else { continue };
            let left = passes(&self.seen, last);
            // From far to near, as for colours: what lies behind a sample fades as it thickens.
            let mut behind = left * left * LEAST;
            for i in range.rev() {
                let passes = passes(&self.seen, i);
                let weight = self.seen.light[i] - passes;
                let by_depth = slope * 2.0 * (weight * self.of_points[i] * passes - behind);
                slopes.by_density[i] +=
                    (by_depth + of_density) * depth_slope(self.seen.raw_density[i], samples.step);
                behind += weight * weight * self.of_points[i];
                by_variance[i] = slope * weight * weight * sigmoid(self.raw[i]);
                value += of_density * self.seen.depths[i];
            }
        }
        Loss { value, slopes, by_variance }
    }

    /// The variance that photos of these rays are expected to take away.
    pub fn gain(&self, samples: &Samples) -> f64 {
        let mut gain = 0.0;
        for (range, &variance) in samples.ranges().zip(&self.variances) {
            for i in range {
                let weight = self.seen.light[i] - passes(&self.seen, i);
                let own = weight * weight * self.of_points[i];
                gain += f64::from(own * self.of_points[i] / (variance + own));
            }
        }
        gain
    }

    /// The mean variance of what is seen: of points by their weights.
    #[cfg(test)]
    pub fn of_what_is_seen(&self) -> f32 {
        let weights = (0..self.raw.len()).map(|i| self.seen.light[i] - passes(&self.seen, i));
        let (mut sum, mut all) = (0.0, 0.0);
        for (weight, variance) in weights.zip(&self.of_points) {
            sum += weight * variance;
            all += weight;
        }
        sum / all
    }
}

/// The light behind a sample.
#[inline]
fn passes(seen: &Seen, i: usize) -> f32 {
    seen.light[i] * (-seen.depths[i]).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::look;
    use crate::volume::tests::{Given, two_rays};

    fn raw_variances(points: usize) -> Vec<f32> {
        (0..points).map(|i| (i as f32 * 0.9).cos() * 3.0 - 1.0).collect()
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let (rays, samples, mut field) = two_rays();
        let mut raw = raw_variances(samples.points.len());
        let truth = [[0.9, 0.2, 0.4], [0.1, 0.6, 0.3], [0.9; 3]];
        let sight = |field: &mut Given, raw: &[f32]| {
            Sight::new(look(field, &rays, &samples), raw.to_vec(), &samples)
        };
        let value = |field: &mut Given, raw: &[f32]| -> f64 {
            f64::from(sight(field, raw).loss(&samples, &truth).value)
        };
        let loss = sight(&mut field, &raw).loss(&samples, &truth);
        let h = 2e-2;
        let agree = |found: f64, told: f32, what: &str| {
            let told = f64::from(told);
            assert!((found - told).abs() < 3e-4 + 5e-3 * told.abs(), "{what}: {found} {told}");
            usize::from(told.abs() > 2e-3)
        };
        let mut matter = [0; 3];
        for i in 0..samples.points.len() {
            let mut difference = |change: &dyn Fn(&mut Given, &mut [f32], f32)| {
                change(&mut field, &mut raw, h);
                let above = value(&mut field, &raw);
                change(&mut field, &mut raw, -2.0 * h);
                let below = value(&mut field, &raw);
                change(&mut field, &mut raw, h);
                (above - below) / f64::from(2.0 * h)
            };
            let found = difference(&|field, _, h| field.density[i] += h);
            matter[0] += agree(found, loss.slopes.by_density[i], "density");
            let found = difference(&|_, raw, h| raw[i] += h);
            matter[1] += agree(found, loss.by_variance[i], "variance");
            for c in 0..3 {
                let found = difference(&|field, _, h| field.colour[i][c] += h);
                matter[2] += agree(found, loss.slopes.by_colour[i][c], "colour");
            }
        }
        assert!(matter.into_iter().all(|count| count > 5), "{matter:?}");
    }

    #[test]
    fn what_is_surely_empty_has_the_least_variance_and_nothing_to_gain() {
        let (rays, samples, mut field) = two_rays();
        field.density.fill(-100.0);
        let raw = raw_variances(samples.points.len());
        let sight = Sight::new(look(&mut field, &rays, &samples), raw, &samples);
        assert!(sight.variances.iter().all(|variance| (variance - LEAST).abs() < 1e-6));
        assert!(sight.gain(&samples) < 1e-6);
    }

    #[test]
    fn a_photo_of_one_point_halves_its_variance() {
        // The first sample hides the others: V is its own variance, and so is the photo's.
        let (rays, samples, mut field) = two_rays();
        field.density.fill(-100.0);
        field.density[0] = 100.0;
        let raw = raw_variances(samples.points.len());
        let own = LEAST + softplus(raw[0]);
        let sight = Sight::new(look(&mut field, &rays, &samples), raw, &samples);
        assert!((sight.variances[0] - own).abs() < 1e-5);
        assert!((sight.gain(&samples) - 0.5 * f64::from(own)).abs() < 1e-5);
    }
}
