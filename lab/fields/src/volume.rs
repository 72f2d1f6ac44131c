//! Volume rendering: what a ray sees of a field, and the derivatives of that.
//!
//! A ray is sampled at equal steps `d`, of which each has its own offset (stratified sampling). With
//! the optical depth `tau_i = d * sigma_i` of sample i (Max, 1995; Mildenhall et al., 2020, eq. 3):
//!
//! ```text
//! alpha_i = 1 - exp(-tau_i)        T_i = exp(-sum_{j < i} tau_j)        w_i = T_i alpha_i
//! C = sum_i w_i c_i + T_end * background
//! dC / dtau_i = T_{i+1} c_i - (sum_{j > i} w_j c_j + T_end * background)
//! ```
//!
//! `sigma = 50 softplus(raw - 4.6)` and `c = sigmoid(raw)`: raw numbers of 0 are a grey fog of which a
//! step of 0.02 hides one per cent. The field is not asked for the colour of samples that less than
//! a thousandth of the light reaches; they count as black.

use vantage_core::Vec3;

use crate::field::Field;
use crate::occupancy::Occupancy;
use crate::photos::{BACKGROUND, Ray};

/// Density where softplus is 1, per metre.
const SCALE: f32 = 50.0;
/// What is added to a raw density: softplus of it is 0.01.
const SHIFT: f32 = -4.6;
/// Samples that less of the light reaches have no colour.
const LEAST_LIGHT: f32 = 1e-3;

/// The optical depth of a step through a raw density.
#[inline]
pub fn optical_depth(raw: f32, step: f32) -> f32 {
    step * SCALE * softplus(raw + SHIFT)
}

/// `ln(1 + e^x)` without overflow; its derivative is the sigmoid.
#[inline]
pub(crate) fn softplus(x: f32) -> f32 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// Its derivative by the raw density.
#[inline]
pub(crate) fn depth_slope(raw: f32, step: f32) -> f32 {
    step * SCALE * sigmoid(raw + SHIFT)
}

#[inline]
pub(crate) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}

/// Sample points along rays.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// World; those of the first ray first, from near to far.
    pub points: Vec<Vec3>,
    /// Where the samples of each ray end; shape (rays).
    ends: Vec<u32>,
    /// Metres between two samples.
    pub(crate) step: f32,
}

impl Samples {
    /// Samples at equal steps within the unit sphere, where there may be something. `offset` gives
    /// where in its step a sample lies, from 0 to 1.
    pub fn along(
        rays: &[Ray],
        occupancy: &Occupancy,
        step: f32,
        mut offset: impl FnMut() -> f32,
    ) -> Self {
        let mut samples = Self { step, ..Self::default() };
        for ray in rays {
            if let Some([near, far]) = ray.within_unit_sphere() {
                for place in 0..((far - near) / step) as usize {
                    let at = near + (place as f32 + offset()) * step;
                    let point = ray.origin + ray.direction * at;
                    if occupancy.is_open(point) {
                        samples.points.push(point);
                    }
                }
            }
            samples.ends.push(samples.points.len() as u32);
        }
        samples
    }

    /// The samples of each ray.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| start as usize..end as usize)
    }
}

/// What rays see, and what their derivatives need.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Shape (rays).
    pub colours: Vec<[f32; 3]>,
    pub(crate) raw_density: Vec<f32>, // (points)
    pub(crate) depths: Vec<f32>,      // (points), optical
    pub(crate) light: Vec<f32>,       // (points), T_i
    shown: Vec<u32>,                  // indices of points that have a colour
    by_point: Vec<[f32; 3]>,          // (points), 0 where not shown
}

/// The loss's derivatives by what a field gave: by raw densities of all samples, and by raw colours of
/// those shown.
pub struct Slopes {
    /// Shape (points).
    pub by_density: Vec<f32>,
    /// Shape (shown, 3).
    pub by_colour: Vec<[f32; 3]>,
}

/// Looks at a field along rays.
pub fn look(field: &mut dyn Field, rays: &[Ray], samples: &Samples) -> Seen {
    let raw_density = field.density(&samples.points);
    let depths: Vec<f32> =
        raw_density.iter().map(|&raw| optical_depth(raw, samples.step)).collect();
    let mut light = vec![0.0; depths.len()];
    let (mut shown, mut directions) = (Vec::new(), Vec::new());
    let mut left = Vec::with_capacity(rays.len());
    for (ray, range) in rays.iter().zip(samples.ranges()) {
        let mut reaches = 1.0;
        for i in range {
            light[i] = reaches;
            if reaches >= LEAST_LIGHT {
                shown.push(i as u32);
                directions.push(ray.direction);
            }
            reaches *= (-depths[i]).exp();
        }
        left.push(reaches);
    }
    let mut by_point = vec![[0.0; 3]; depths.len()];
    for (&i, raw) in shown.iter().zip(field.colour(&shown, &directions)) {
        by_point[i as usize] = raw.map(sigmoid);
    }
    let seen = |(range, left): (std::ops::Range<usize>, f32)| {
        let mut colour = BACKGROUND.map(|c| c * left);
        for i in range {
            let weight = light[i] * (1.0 - (-depths[i]).exp());
            for (sum, part) in colour.iter_mut().zip(by_point[i]) {
                *sum += weight * part;
            }
        }
        colour
    };
    let colours = samples.ranges().zip(left.iter().copied()).map(seen).collect();
    Seen { colours, raw_density, depths, light, shown, by_point }
}

impl Seen {
    /// From the loss's derivatives by the colours of rays to those by what the field gave.
    pub fn slopes(&self, samples: &Samples, by_ray: &[[f32; 3]]) -> Slopes {
        let mut by_density = vec![0.0; self.depths.len()];
        let mut of_points = vec![[0.0; 3]; self.depths.len()];
        for (range, slope) in samples.ranges().zip(by_ray) {
            let dot = |colour: [f32; 3]| -> f32 { (0..3).map(|c| slope[c] * colour[c]).sum() };
            let Some(last) = range.clone().next_back() else { continue };
            let left = self.light[last] * (-self.depths[last]).exp();
            // From far to near: what lies behind a sample is known when it is reached.
            let mut behind = left * dot(BACKGROUND);
            for i in range.rev() {
                let passes = self.light[i] * (-self.depths[i]).exp();
                let weight = self.light[i] - passes;
                let own = dot(self.by_point[i]);
                by_density[i] =
                    (passes * own - behind) * depth_slope(self.raw_density[i], samples.step);
                behind += weight * own;
                of_points[i] = std::array::from_fn(|c| {
                    let colour = self.by_point[i][c];
                    slope[c] * weight * colour * (1.0 - colour)
                });
            }
        }
        let by_colour = self.shown.iter().map(|&i| of_points[i as usize]).collect();
        Slopes { by_density, by_colour }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::path::Path;

    use anyhow::Result;

    use super::*;

    /// Raw numbers that are given for every sample.
    pub struct Given {
        pub density: Vec<f32>,
        pub colour: Vec<[f32; 3]>,
    }

    impl Field for Given {
        fn density(&mut self, _: &[Vec3]) -> Vec<f32> {
            self.density.clone()
        }
        fn colour(&mut self, shown: &[u32], _: &[Vec3]) -> Vec<[f32; 3]> {
            shown.iter().map(|&i| self.colour[i as usize]).collect()
        }
        fn accumulate(&mut self, _: &[f32], _: &[[f32; 3]]) {}
        fn advance(&mut self, _: f32) {}
        fn refine(&mut self, _: f32) {}
        fn save(&self, _: &Path) -> Result<()> {
            Ok(())
        }
        fn load(&mut self, _: &Path) -> Result<()> {
            Ok(())
        }
    }

    pub fn two_rays() -> (Vec<Ray>, Samples, Given) {
        let ray = |y: f32| Ray { origin: Vec3::new(3.0, y, 0.1), direction: Vec3::NEG_X };
        let rays = vec![ray(0.1), ray(-0.7), ray(5.0)];
        let samples = Samples::along(&rays, &Occupancy::full(), 0.2, || 0.5);
        let n = samples.points.len();
        let density = (0..n).map(|i| (i as f32 * 1.7).sin() * 2.0).collect();
        let colour =
            (0..n).map(|i| [0, 1, 2].map(|c| ((3 * i + c) as f32 * 2.3).cos() * 1.5)).collect();
        (rays, samples, Given { density, colour })
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let (rays, samples, mut field) = two_rays();
        let by_ray = [[0.7, -0.3, 0.4], [-0.2, 0.9, 0.5], [1.0; 3]];
        let value = |field: &mut Given| -> f64 {
            let seen = look(field, &rays, &samples);
            let parts = seen.colours.iter().flatten().zip(by_ray.iter().flatten());
            parts.map(|(a, b)| f64::from(a * b)).sum()
        };
        let seen = look(&mut field, &rays, &samples);
        let slopes = seen.slopes(&samples, &by_ray);
        assert_eq!(seen.colours[2], BACKGROUND);
        assert!(samples.points.len() > 14 && seen.shown.len() == samples.points.len());
        let h = 2e-2;
        for i in 0..samples.points.len() {
            let mut difference = |change: &dyn Fn(&mut Given, f32)| {
                change(&mut field, h);
                let above = value(&mut field);
                change(&mut field, -2.0 * h);
                let below = value(&mut field);
                change(&mut field, h);
                (above - below) / f64::from(2.0 * h)
            };
            let found = difference(&|field, h| field.density[i] += h);
            let told = f64::from(slopes.by_density[i]);
            assert!((found - told).abs() < 2e-4 + 2e-3 * told.abs(), "{i}: {found} {told}");
            for c in 0..3 {
                let found = difference(&|field, h| field.colour[i][c] += h);
                let told = f64::from(slopes.by_colour[i][c]);
                assert!(
                    (found - told).abs() < 2e-4 + 2e-3 * told.abs(),
                    "{i}, {c}: {found} {told}"
                );
            }
        }
    }

    #[test]
    fn what_is_solid_hides_what_lies_behind() {
        let (rays, samples, mut field) = two_rays();
        field.density.fill(20.0);
        field.colour.fill([0.0; 3]);
        field.colour[0] = [2.0, 0.0, -2.0];
        let seen = look(&mut field, &rays, &samples);
        let expected = [2.0, 0.0, -2.0].map(sigmoid);
        assert!(seen.colours[0].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5));
        assert_eq!(seen.shown.len(), 2); // the first sample of each ray that has any
    }

    #[test]
    fn raw_zero_is_thin_fog() {
        let alpha = 1.0 - (-optical_depth(0.0, 0.02)).exp();
        assert!((alpha - 0.01).abs() < 1e-3, "{alpha}");
        assert!(optical_depth(200.0, 0.02).is_finite() && optical_depth(-200.0, 0.02) >= 0.0);
    }
}
