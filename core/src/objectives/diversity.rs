//! D, ray diversity: from how many different directions each face is seen (eqs. `obj_D_1` to
//! `obj_D_7_2`).
//!
//! Each photo sends one ray from every visible face's centroid **to the camera**, of unit length.
//! `phi` is the mean over a face's rays of the inlier weight `psi`, which falls from 1 head-on to
//! 0.5 at 80 degrees of incidence and 0.007 at 85; `delta` is how the rays spread along the three
//! axes. D is the mean of `delta * phi` over the surface.
//!
//! A face keeps a count, the mean ray, the sums of squared deviations and the sum of psi, never the
//! rays. The squares are kept around the mean (Welford, 1962): sums of raw squares in single
//! precision lose a small variance along one axis to cancellation, and the cube root magnifies it.
//!
//! D is neither monotone nor submodular, so its gains are always evaluated anew. Because `delta`
//! multiplies the variances of the three axes, D changes when object and cameras are turned
//! together by anything but quarter turns.

use core::ops::{Add, Mul, Sub};

use glam::Vec3;

use super::surface::{Face, FaceSet};
use crate::math;

/// How `delta` is made of the three axis variances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spread {
    /// `3 * cbrt(var_x * var_y * var_z)`: the same order as the product, and in [0, 1].
    CubeRoot,
    /// `var_x * var_y * var_z` (eq. `obj_D_7`): at most 1/27.
    Product,
}

/// The rays of one face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Rays {
    count: f32,
    mean: Vec3,
    deviation: Vec3, // sum of squared deviations from the mean, per axis
    inliers: f32,    // sum of psi
    value: f32,      // delta * phi as it stands
}

/// Cosine of incidence from which psi is exactly 1 in single precision: the outlier score is below
/// half a unit in the last place of 1 where theta < -27.4 degrees, that is 62.6 degrees of incidence.
const CERTAIN_INLIER: f32 = 0.461;

/// The paper's psi (eq. `obj_D_2` with alpha_1 = 1 and alpha_2 = -10) of a cosine of incidence; off
/// by at most 2e-6.
///
/// `1 - 1 / (1 + exp(-theta - 10))` with theta the incidence in degrees less 90 (eq. `obj_D_1`), so
/// `1 / (1 + exp(10 - asin(cosine) in degrees))`. The arc sine is its series to the ninth power,
/// which is off by more than rounding only where psi is constant.
#[inline(always)]
pub(crate) fn inlier_weight(cosine: f32) -> f32 {
    let x = cosine.clamp(-CERTAIN_INLIER, CERTAIN_INLIER);
    let square = x * x;
    let series = 15.0 / 336.0 + square * (105.0 / 3456.0);
    let arc_sine = x * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * series)));
    1.0 / (1.0 + math::exp_lanewise(10.0 - arc_sine * (180.0 / core::f32::consts::PI)))
}

/// The ray from a face to a camera, unit length, and its inlier weight.
fn ray(face: &Face, camera: Vec3, two_sided: bool) -> (Vec3, f32) {
    let towards = camera - face.centroid;
    // On the centroid there is no direction; nothing of length 0 has any incidence.
    let direction = towards * math::inverse_sqrt(towards.length_squared());
    let cosine = direction.dot(face.normal);
    (direction, inlier_weight(if two_sided { cosine.abs() } else { cosine }))
}

impl Rays {
    /// `delta * phi` of the rays so far.
    pub(crate) fn value(&self) -> f32 {
        self.value
    }

    /// Adds the ray to a camera.
    pub(crate) fn add(&mut self, face: &Face, camera: Vec3, rule: Rule) {
        let (direction, psi) = ray(face, camera, rule.two_sided);
        let count = self.count + 1.0;
        let offset = direction - self.mean;
        self.mean += offset / count;
        self.deviation += offset * offset * (self.count / count);
        self.inliers += psi;
        self.count = count;
        self.value = match rule.spread {
            Spread::CubeRoot => {
                effective::<true>(self.deviation.to_array(), 1.0 / count, self.inliers)
            }
            Spread::Product => {
                effective::<false>(self.deviation.to_array(), 1.0 / count, self.inliers)
            }
        };
    }
}

/// How D is read: see [`Form`](super::Form).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rule {
    pub(crate) spread: Spread,
    /// A face seen from behind counts as seen from the front: meshes are not always wound right.
    pub(crate) two_sided: bool,
}

/// `delta` from the product of the three axis variances.
#[inline(always)]
fn delta_of<const CUBE_ROOT: bool>(product: f32) -> f32 {
    if CUBE_ROOT { 3.0 * math::cbrt(product) } else { product }
}

/// `delta * phi` from the sums of `1 / share` rays.
fn effective<const CUBE_ROOT: bool>(deviation: [f32; 3], share: f32, inliers: f32) -> f32 {
    let [x, y, z] = deviation;
    // Scaled one by one, so that a small variance is not lost to underflow of the product.
    delta_of::<CUBE_ROOT>((x * share) * (y * share) * (z * share)) * (inliers * share)
}

/// Faces evaluated side by side. Eight lanes fill two SSE registers; the sums over them come out
/// the same on every target because their order is written down here, not chosen by a compiler.
const LANES: usize = 8;

/// One number for each of eight faces.
#[derive(Clone, Copy, Default)]
struct Lanes([f32; LANES]);

impl Lanes {
    #[inline(always)]
    fn of(number: f32) -> Self {
        Self([number; LANES])
    }

    #[inline(always)]
    fn map(mut self, f: impl Fn(f32) -> f32) -> Self {
        self.0.iter_mut().for_each(|lane| *lane = f(*lane));
        self
    }

    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        self.0.iter_mut().zip(other.0).for_each(|(lane, other)| *lane = f(*lane, other));
        self
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, number: f32) {
        if let Some(place) = self.0.get_mut(lane) {
            *place = number;
        }
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

/// What the gain needs of up to eight faces, lane by lane; vectors as one `Lanes` an axis.
#[derive(Default)]
struct Batch {
    used: usize,
    towards: [Lanes; 3],
    normal: [Lanes; 3],
    mean: [Lanes; 3],
    deviation: [Lanes; 3],
    count: Lanes,
    inliers: Lanes,
    value: Lanes,
    weight: Lanes,
}

impl Batch {
    #[inline(always)]
    fn push(&mut self, face: &Face, rays: &Rays, camera: Vec3, weight: f32) {
        let lane = self.used;
        let vectors = [
            (&mut self.towards, camera - face.centroid),
            (&mut self.normal, face.normal),
            (&mut self.mean, rays.mean),
            (&mut self.deviation, rays.deviation),
        ];
        for ([x, y, z], vector) in vectors {
            x.set(lane, vector.x);
            y.set(lane, vector.y);
            z.set(lane, vector.z);
        }
        self.count.set(lane, rays.count);
        self.inliers.set(lane, rays.inliers);
        self.value.set(lane, rays.value);
        self.weight.set(lane, weight);
        self.used = lane + 1;
    }

    /// The weighted gain of one more ray, summed over the lanes in use.
    #[inline(always)]
    fn gain<const CUBE_ROOT: bool>(&self, two_sided: bool) -> f32 {
        let [x, y, z] = self.towards;
        let inverse = (x * x + y * y + z * z).map(math::inverse_sqrt);
        let direction = [x * inverse, y * inverse, z * inverse];
        let [x, y, z] = direction;
        let [a, b, c] = self.normal;
        let cosine = x * a + y * b + z * c;
        let cosine = if two_sided { cosine.map(f32::abs) } else { cosine };
        let psi = cosine.map(inlier_weight);

        let share = (self.count + Lanes::of(1.0)).map(|count| 1.0 / count);
        let pull = self.count * share;
        let grown = |direction: Lanes, mean: Lanes, deviation: Lanes| {
            let offset = direction - mean;
            deviation + offset * offset * pull
        };
        let [mean_x, mean_y, mean_z] = self.mean;
        let [deviation_x, deviation_y, deviation_z] = self.deviation;
        let product = (grown(x, mean_x, deviation_x) * share)
            * (grown(y, mean_y, deviation_y) * share)
            * (grown(z, mean_z, deviation_z) * share);
        let delta = product.map(delta_of::<CUBE_ROOT>);
        let value = delta * ((self.inliers + psi) * share);
        let gains = self.weight * (value - self.value);
        gains.0.iter().take(self.used).sum()
    }
}

/// What D would gain if a camera saw these faces: the sum over them of weight times the change of
/// `delta * phi`. `weight` gives a face's share in the mean.
pub(crate) fn gain<'a>(
    seen: FaceSet<'_>,
    camera: Vec3,
    rule: Rule,
    entry: impl Fn(usize) -> Option<(&'a Face, &'a Rays, f32)>,
) -> f32 {
    match rule.spread {
        Spread::CubeRoot => gain_by::<true>(seen, camera, rule.two_sided, entry),
        Spread::Product => gain_by::<false>(seen, camera, rule.two_sided, entry),
    }
}

fn gain_by<'a, const CUBE_ROOT: bool>(
    seen: FaceSet<'_>,
    camera: Vec3,
    two_sided: bool,
    entry: impl Fn(usize) -> Option<(&'a Face, &'a Rays, f32)>,
) -> f32 {
    let mut total = 0.0f64;
    let mut batch = Batch::default();
    // `for_each` runs over words and bits as two plain loops, where `for` would resume in between.
    seen.iter().filter_map(entry).for_each(|(face, rays, weight)| {
        // A face's first ray has no variance: its gain is exactly 0.
        if rays.count > 0.0 {
            batch.push(face, rays, camera, weight);
        }
        if batch.used == LANES {
            total += f64::from(batch.gain::<CUBE_ROOT>(two_sided));
            batch.used = 0;
        }
    });
    if batch.used > 0 {
        total += f64::from(batch.gain::<CUBE_ROOT>(two_sided));
    }
    total as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inlier_weight_has_the_papers_values() {
        let at_degrees = |degrees: f32| inlier_weight(math::cos(degrees.to_radians()));
        assert_eq!(at_degrees(0.0), 1.0);
        assert!((at_degrees(80.0) - 0.5).abs() < 1e-4);
        assert!((at_degrees(85.0) - 0.006_69).abs() < 1e-4);
        assert!(at_degrees(120.0) < 1e-6);
    }

    #[test]
    fn the_inlier_weight_stays_within_its_bound() {
        let mut cosine = -1.0f32;
        while cosine <= 1.0 {
            let theta = f64::from(cosine).acos().to_degrees() - 90.0;
            let truth = 1.0 - 1.0 / (1.0 + (-theta - 10.0).exp());
            let error = (f64::from(inlier_weight(cosine)) - truth).abs();
            assert!(error < 2e-6, "psi({cosine}) is off by {error:e}");
            cosine += 1e-5;
        }
        assert_eq!(inlier_weight(CERTAIN_INLIER), 1.0);
    }

    #[test]
    fn a_gain_is_the_difference_that_adding_makes() {
        let face = Face { centroid: Vec3::ZERO, normal: Vec3::Z, area_share: 1.0, complexity: 0.0 };
        for rule in [
            Rule { spread: Spread::CubeRoot, two_sided: true },
            Rule { spread: Spread::Product, two_sided: false },
        ] {
            let mut rays = Rays::default();
            for camera in [
                Vec3::new(1.0, 0.2, 3.0),
                Vec3::new(-2.0, 1.0, 2.0),
                Vec3::new(0.3, -2.0, 1.0),
                Vec3::new(3.0, 2.0, 0.1),
            ] {
                let words = [1];
                let gain = gain(FaceSet::new(&words), camera, rule, |_| Some((&face, &rays, 1.0)));
                let mut grown = rays;
                grown.add(&face, camera, rule);
                assert!((gain - (grown.value() - rays.value())).abs() < 1e-6, "{rule:?}");
                rays = grown;
            }
            assert!(rays.value() > 0.0);
        }
    }

    #[test]
    fn rays_in_one_plane_have_no_diversity() {
        let face = Face { centroid: Vec3::ZERO, normal: Vec3::X, area_share: 1.0, complexity: 0.0 };
        let rule = Rule { spread: Spread::CubeRoot, two_sided: true };
        let mut rays = Rays::default();
        for step in 0..20 {
            let angle = step as f32 * 0.3;
            rays.add(&face, Vec3::new(math::cos(angle), math::sin(angle), 0.0), rule);
        }
        assert_eq!(rays.value(), 0.0);
    }
}
