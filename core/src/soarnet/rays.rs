//! The moments of a spot's rays to cameras, in whole numbers, so that the order of views changes no bit.

use glam::Vec3;

use crate::math;
use crate::objectives::inlier_weight;

/// Sums over the rays of one spot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rays {
    pub(super) count: u32,
    sums: [i32; 3],         // units of 2^-12
    squares: [u32; 3],      // units of 2^-24
    inliers: i32,           // sum of psi, units of 2^-16
    pub(super) before: f32, // delta · phi without the view to come
}

impl Rays {
    pub(super) fn add(&mut self, direction: Vec3, cosine: f32) {
        self.count += 1;
        let parts = direction.to_array().map(|part| fixed(part, 4096.0));
        for ((sum, square), part) in self.sums.iter_mut().zip(&mut self.squares).zip(parts) {
            *sum += part;
            *square = square.saturating_add((part * part).unsigned_abs());
        }
        self.inliers += fixed(inlier_weight(cosine), 65536.0);
    }

    /// `3 cbrt(var_x var_y var_z) · mean psi`.
    pub(super) fn value(&self) -> f32 {
        if self.count < 2 {
            return 0.0;
        }
        let share = 1.0 / self.count as f32;
        let mut product = 1.0;
        for (&sum, &square) in self.sums.iter().zip(&self.squares) {
            let spread = i64::from(self.count) * i64::from(square) - i64::from(sum).pow(2);
            product *= spread as f32 * (share * share / 16_777_216.0);
        }
        3.0 * math::cbrt(product) * (self.inliers as f32 * share / 65536.0)
    }
}

/// A number in whole units of `1 / units`, halves up.
pub(super) fn fixed(value: f32, units: f32) -> i32 {
    let value = value * units + 0.5;
    // As `floor(value) as i32`, which takes a call where no instruction rounds down.
    let towards_zero = value as i32;
    towards_zero.saturating_sub(i32::from(towards_zero as f32 > value))
}

#[cfg(test)]
pub mod tests {
    use std::vec::Vec;

    use glam::DVec3;
    use proptest::prelude::*;

    use super::super::hull::tests::{any_stance, cases};
    use super::*;

    #[test]
    fn fixed_numbers_are_rounded_down_after_a_half_is_added() {
        let wide = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e9, -3e9, 2147483520.0, -0.0];
        let near = (-2000..2000).map(|at| at as f32 / 256.0);
        for value in near.flat_map(|at| [at.next_down(), at, at.next_up()]).chain(wide) {
            for units in [1.0, 256.0, 65_536.0] {
                let expected = (value * units + 0.5).floor() as i32;
                assert_eq!(fixed(value, units), expected, "{value} {units}");
            }
        }
    }

    /// Eq. D of rays to cameras, in double precision.
    pub fn diversity(rays: &[(DVec3, f64)]) -> f64 {
        let count = rays.len() as f64;
        let mean = rays.iter().map(|(ray, _)| *ray).sum::<DVec3>() / count;
        let variance =
            rays.iter().map(|(ray, _)| (*ray - mean) * (*ray - mean)).sum::<DVec3>() / count;
        let weight = |cosine: f64| {
            let theta = cosine.clamp(-1.0, 1.0).acos().to_degrees() - 90.0;
            1.0 - 1.0 / (1.0 + (-theta - 10.0).exp())
        };
        let inliers = rays.iter().map(|(_, cosine)| weight(*cosine)).sum::<f64>() / count;
        3.0 * (variance.x * variance.y * variance.z).cbrt() * inliers
    }

    pub fn double(v: Vec3) -> DVec3 {
        DVec3::new(v.x.into(), v.y.into(), v.z.into())
    }

    proptest! {
        #![proptest_config(cases(24))]

        #[test]
        fn moments_of_rays_are_their_plain_definition(
            rays in prop::collection::vec(any_stance(), 0..40),
        ) {
            let (mut moments, mut plain) = (Rays::default(), Vec::new());
            for ray in &rays {
                let ray = ray.direction.vector().normalize();
                moments.add(ray, ray.z);
                plain.push((double(ray), f64::from(ray.z)));
                let expected = if plain.len() < 2 { 0.0 } else { diversity(&plain) };
                let got = f64::from(moments.value());
                // A cube root has no bound where one variance is near nothing.
                let narrow = plain.len() < 4;
                prop_assert!((got - expected).abs() < if narrow { 0.02 } else { 1e-3 }, "{got} {expected}");
            }
        }
    }
}
