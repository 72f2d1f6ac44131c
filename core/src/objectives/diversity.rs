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

/// The paper's psi (eq. `obj_D_2` with alpha_1 = 1 and alpha_2 = -10) of a cosine of incidence.
///
/// `1 - 1 / (1 + exp(-theta - 10))` with theta the incidence in degrees less 90 (eq. `obj_D_1`).
fn inlier_weight(cosine: f32) -> f32 {
    if cosine >= CERTAIN_INLIER {
        return 1.0;
    }
    let theta = math::acos(cosine).to_degrees() - 90.0;
    1.0 - 1.0 / (1.0 + math::exp(-theta - 10.0))
}

/// The ray from a face to a camera, unit length, and its inlier weight.
///
/// A camera on the centroid itself sends a ray of no length and no weight.
fn ray(face: &Face, camera: Vec3, two_sided: bool) -> (Vec3, f32) {
    let direction = camera - face.centroid;
    let direction =
        direction * (1.0 / math::sqrt(direction.length_squared().max(f32::MIN_POSITIVE)));
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

/// `delta * phi` from the sums of `1 / share` rays.
#[inline(always)]
fn effective<const CUBE_ROOT: bool>(deviation: [f32; 3], share: f32, inliers: f32) -> f32 {
    let [x, y, z] = deviation;
    // Scaled one by one, so that a small variance is not lost to underflow of the product.
    let product = (x * share) * (y * share) * (z * share);
    let delta = if CUBE_ROOT { 3.0 * math::cbrt(product) } else { product };
    delta * (inliers * share)
}

/// Faces evaluated side by side. Eight lanes fill two SSE registers; the sums over them come out
/// the same on every target because their order is written down here, not chosen by a compiler.
const LANES: usize = 8;

/// What the gain needs of up to eight faces, lane by lane.
#[derive(Default)]
struct Batch {
    used: usize,
    towards: [[f32; LANES]; 3],
    normal: [[f32; LANES]; 3],
    mean: [[f32; LANES]; 3],
    deviation: [[f32; LANES]; 3],
    count: [f32; LANES],
    inliers: [f32; LANES],
    value: [f32; LANES],
    weight: [f32; LANES],
}

impl Batch {
    #[inline(always)]
    fn push(&mut self, face: &Face, rays: &Rays, camera: Vec3, weight: f32) {
        let towards = (camera - face.centroid).to_array();
        let lane = self.used % LANES;
        let axes = towards.into_iter().zip(face.normal.to_array());
        let sums = rays.mean.to_array().into_iter().zip(rays.deviation.to_array());
        let lanes = self.towards.iter_mut().zip(&mut self.normal);
        let lanes = lanes.zip(self.mean.iter_mut().zip(&mut self.deviation));
        for (((t, n), (m, d)), ((towards, normal), (mean, deviation))) in lanes.zip(axes.zip(sums))
        {
            set(t, lane, towards);
            set(n, lane, normal);
            set(m, lane, mean);
            set(d, lane, deviation);
        }
        set(&mut self.count, lane, rays.count);
        set(&mut self.inliers, lane, rays.inliers);
        set(&mut self.value, lane, rays.value);
        set(&mut self.weight, lane, weight);
        self.used += 1;
    }

    /// The weighted gain of one more ray, summed over the lanes in use.
    #[inline(always)]
    fn gain<const CUBE_ROOT: bool>(&self, two_sided: bool) -> f32 {
        let mut cosine = [0.0f32; LANES];
        let mut direction = [[0.0f32; LANES]; 3];
        for lane in 0..LANES {
            let [x, y, z] = self.towards.map(|axis| at(&axis, lane));
            let [a, b, c] = self.normal.map(|axis| at(&axis, lane));
            let inverse = 1.0 / math::sqrt((x * x + y * y + z * z).max(f32::MIN_POSITIVE));
            let [x, y, z] = [x * inverse, y * inverse, z * inverse];
            let [dx, dy, dz] = &mut direction;
            set(dx, lane, x);
            set(dy, lane, y);
            set(dz, lane, z);
            let dot = x * a + y * b + z * c;
            set(&mut cosine, lane, if two_sided { dot.abs() } else { dot });
        }
        // The one step that branches: psi is 1 for four rays in five.
        let mut psi = [1.0f32; LANES];
        if cosine.iter().any(|&cosine| cosine < CERTAIN_INLIER) {
            for (psi, &cosine) in psi.iter_mut().zip(&cosine) {
                *psi = inlier_weight(cosine);
            }
        }
        let mut gains = [0.0f32; LANES];
        for (lane, gain) in gains.iter_mut().enumerate() {
            let count = at(&self.count, lane);
            let share = 1.0 / (count + 1.0);
            let grown: [f32; 3] = [0, 1, 2].map(|axis| {
                let offset = axis_at(&direction, axis, lane) - axis_at(&self.mean, axis, lane);
                axis_at(&self.deviation, axis, lane) + offset * offset * (count * share)
            });
            let inliers = at(&self.inliers, lane) + at(&psi, lane);
            let value = effective::<CUBE_ROOT>(grown, share, inliers);
            *gain = at(&self.weight, lane) * (value - at(&self.value, lane));
        }
        gains.iter().take(self.used).sum()
    }
}

#[inline(always)]
fn at(lanes: &[f32; LANES], lane: usize) -> f32 {
    lanes.get(lane).copied().unwrap_or_default()
}

#[inline(always)]
fn axis_at(axes: &[[f32; LANES]; 3], axis: usize, lane: usize) -> f32 {
    axes.get(axis).map_or(0.0, |lanes| at(lanes, lane))
}

#[inline(always)]
fn set(lanes: &mut [f32; LANES], lane: usize, value: f32) {
    if let Some(place) = lanes.get_mut(lane) {
        *place = value;
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
    for (face, rays, weight) in seen.iter().filter_map(entry) {
        // A face's first ray has no variance: its gain is exactly 0.
        if rays.count > 0.0 {
            batch.push(face, rays, camera, weight);
        }
        if batch.used == LANES {
            total += f64::from(batch.gain::<CUBE_ROOT>(two_sided));
            batch.used = 0;
        }
    }
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
    fn the_shortcut_of_the_inlier_weight_changes_no_bit() {
        let mut cosine = CERTAIN_INLIER;
        while cosine <= 1.0 {
            let theta = math::acos(cosine).to_degrees() - 90.0;
            assert_eq!(1.0 - 1.0 / (1.0 + math::exp(-theta - 10.0)), 1.0, "at {cosine}");
            cosine += 1e-5;
        }
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
