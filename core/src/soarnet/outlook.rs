//! What a candidate would see of the visual hull: the objectives, by the outlines alone.
//!
//! About 384 *spots* are spread over the hull's surface. From every view so far each spot learns how
//! squarely it was seen, from which directions and how textured its place in the photo was; from there
//! the four objectives of a further view follow as they do on a mesh. Nothing here is learned: the
//! candidate's head is told these numbers and decides what to make of them.
//!
//! With `e` the weight of a sight, `min(1, 2 cos incidence)` where nothing of the hull stands between,
//! `a` a spot's area, `t` its texture beside the mean of the photos, and sums over spots:
//!
//! | | of a candidate's sights e, over the total area | |
//! |---|---|---|
//! | 0 | `Σ a e` | how much surface it faces |
//! | 1 | `Σ a max(0, e - max_k e_k)` | C: seen better than from any view so far |
//! | 2 | `Σ a e` over spots not seen at all | C |
//! | 3 | `Σ a e 2^-s`, s the sum of `e_k` | Q, all spots alike |
//! | 4 | `Σ a t e 2^-s` | Q, where texture is fine |
//! | 5 | `Σ a cos 4^-s / Σ a cos` | T, all spots alike |
//! | 6 | `Σ a t cos 4^-s / Σ a cos` | T |
//! | 7 | `Σ a (d_after - d_before)`, d as in eqs. `obj_D_1` to `obj_D_7_2` | D |
//!
//! Geometry is in single precision, spot by spot; whatever is added up over views or candidates is a
//! whole number, so that their order changes nothing.

use glam::Vec3;

use super::features::{Direction, Stance};
use super::hull::{Camera, Hull};
use super::image::{COVER, DETAIL};
use crate::math;
use crate::objectives::inlier_weight;

/// Numbers of an outlook.
pub const OUTLOOK: usize = 8;

/// Spots wanted, and at most kept: how many a lattice hits is not quite certain.
const WANTED: u64 = 384;
const SPOTS: usize = 400;

/// A sight of full weight.
const WHOLE: i32 = 256;

/// A place on the hull's surface, and what is known of it.
#[derive(Clone, Copy, Debug, Default)]
struct Spot {
    centre: Vec3,
    normal: Vec3,
    area: i32,         // units of 2^-8 voxel sides squared
    best: i32,         // max of e, units of 2^-8
    sum: i32,          // of e, units of 2^-8
    detail: i32,       // sum of cos · detail, units of 2^-8 · 1/127
    covered: i32,      // sum of cos · cover, likewise
    rays: Rays,        // of all views that see it
    discount: [i32; 2], // 2^-s and 4^-s, units of 2^-8
    texture: i32,      // t, units of 2^-8
}

/// The moments of a spot's rays to cameras, in whole numbers.
#[derive(Clone, Copy, Debug, Default)]
struct Rays {
    count: u32,
    sums: [i32; 3],    // units of 2^-12
    squares: [u32; 3], // units of 2^-24
    inliers: i32,      // sum of psi, units of 2^-16
    value: f32,        // delta · phi
}

impl Rays {
    fn add(&mut self, direction: Vec3, cosine: f32) {
        self.count += 1;
        let parts = direction.to_array().map(|part| fixed(part, 4096.0));
        for ((sum, square), part) in self.sums.iter_mut().zip(&mut self.squares).zip(parts) {
            *sum += part;
            *square = square.saturating_add((part * part).unsigned_abs());
        }
        self.inliers += fixed(inlier_weight(cosine), 65536.0);
    }

    /// `3 cbrt(var_x var_y var_z) · mean psi`.
    fn value(&self) -> f32 {
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
fn fixed(value: f32, units: f32) -> i32 {
    math::floor(value * units + 0.5) as i32
}

/// How a spot is seen from a camera: the direction to it, the cosine of incidence and the weight of
/// the sight; `None` if it is not.
fn sight(hull: &Hull, spot: &Spot, eye: Vec3) -> Option<(Vec3, f32, i32)> {
    let towards = eye - spot.centre;
    let direction = towards * math::inverse_sqrt(towards.length_squared());
    // What is thin is seen squarely from everywhere.
    let thin = spot.normal == Vec3::ZERO;
    let cosine = if thin { 1.0 } else { direction.dot(spot.normal) };
    let open = cosine > 0.0 && hull.is_open(spot.centre, spot.normal, direction);
    open.then(|| (direction, cosine, fixed(2.0 * cosine, WHOLE as f32).min(WHOLE)))
}

/// The hull and its spots: 41 KiB. What is in them before [`begin`](Self::begin) does not matter.
#[derive(Clone, Debug)]
pub struct Form {
    hull: Hull,
    spots: heapless::Vec<Spot, SPOTS>,
}

impl Form {
    /// Empty, at no cost of flash in a `static`.
    pub const fn new() -> Self {
        Self { hull: Hull::new(), spots: heapless::Vec::new() }
    }

    /// As before the first photo.
    pub fn begin(&mut self) {
        self.hull.fill();
        self.spots.clear();
    }

    /// Takes in the outline of a photo, as its sketch has it: shape (320).
    pub fn take_in(&mut self, stance: &Stance, sketch: &[i8]) {
        if let Some(camera) = Camera::try_new(stance) {
            self.hull.carve(&camera, sketch);
        }
    }

    /// What candidates would see, as the network is told it: [`OUTLOOK`] numbers each, of mean 0 and
    /// spread 127 / 4 over the candidates, at most 127. `views` are those taken in, in any order.
    ///
    /// Shapes: `candidates` and `outlooks` (n).
    pub fn outlooks<'a>(
        &mut self,
        views: impl Iterator<Item = (&'a Stance, &'a [i8])>,
        candidates: &[Direction],
        outlooks: &mut [[i32; OUTLOOK]],
    ) {
        self.survey(views.filter_map(|(stance, sketch)| Some((Camera::try_new(stance)?, sketch))));
        for (outlook, &candidate) in outlooks.iter_mut().zip(candidates) {
            *outlook = self.outlook(candidate);
        }
        standardise(outlooks);
    }

    /// Spreads the spots anew and tells them of all views.
    fn survey<'a>(&mut self, views: impl Iterator<Item = (Camera, &'a [i8])>) {
        // The lattice of least discrepancy in three dimensions (Roberts, 2018): a voxel that comes or
        // goes leaves the other spots where they are.
        let share = (WANTED << 32).checked_div(self.hull.surface_count().into()).unwrap_or(0);
        let on_lattice = |x: u32, y: u32, z: u32| {
            let place = x.wrapping_mul(0xd1b5_4a33);
            let place = place.wrapping_add(y.wrapping_mul(0xabc9_8388));
            u64::from(place.wrapping_add(z.wrapping_mul(0x8cb9_2ba7))) < share
        };
        self.spots.clear();
        for voxel in self.hull.surface(on_lattice) {
            let (centre, normal, area) = (voxel.centre, voxel.normal, fixed(voxel.area, 256.0));
            let spot = Spot { centre, normal, area, ..Spot::default() };
            if self.spots.push(spot).is_err() {
                break;
            }
        }
        for (camera, sketch) in views {
            for spot in &mut self.spots {
                let Some((direction, cosine, weight)) = sight(&self.hull, spot, camera.eye) else {
                    continue;
                };
                spot.best = spot.best.max(weight);
                spot.sum += weight;
                spot.rays.add(direction, cosine);
                let (detail, cover) = detail_at(sketch, camera.project(spot.centre));
                let weight = fixed(cosine, 256.0);
                spot.detail += weight * detail;
                spot.covered += weight * cover;
            }
        }
        self.conclude();
    }

    /// From sums over views to what gains are made of.
    fn conclude(&mut self) {
        let total = |of: fn(&Spot) -> i32| -> f32 {
            self.spots.iter().map(|spot| i64::from(of(spot))).sum::<i64>() as f32
        };
        let mean = total(|spot| spot.detail) / total(|spot| spot.covered).max(1.0);
        // As much as a third of a sight says that a spot is like the others.
        let prior = 0.3 * 256.0 * 127.0;
        for spot in &mut self.spots {
            spot.rays.value = spot.rays.value();
            let half = math::exp(-core::f32::consts::LN_2 * spot.sum as f32 / WHOLE as f32);
            spot.discount = [half, half * half].map(|share| fixed(share, 256.0));
            let texture = (spot.detail as f32 + prior * mean) / (spot.covered as f32 + prior);
            spot.texture = fixed(texture / (mean + 0.01), 256.0).min(2048);
        }
    }

    /// The outlook of a candidate, units of 2^-20; see the [module](self).
    fn outlook(&self, candidate: Direction) -> [i32; OUTLOOK] {
        let eye = Camera::eye_in(candidate);
        let mut sums = [0i64; OUTLOOK];
        let mut facing = 0i64; // sum of a · cos, units of 2^-16
        let mut all = 0i64; // sum of a, units of 2^-8
        for spot in &self.spots {
            let area = i64::from(spot.area);
            all += area;
            let Some((direction, cosine, weight)) = sight(&self.hull, spot, eye) else { continue };
            let mut rays = spot.rays;
            rays.add(direction, cosine);
            let [half, quarter] = spot.discount.map(i64::from);
            let texture = i64::from(spot.texture);
            let turned = area * i64::from(fixed(cosine, 256.0));
            let sight = area * i64::from(weight);
            facing += turned;
            // Units of 2^-16, 2^-16, 2^-16, 2^-24, 2^-32, 2^-24, 2^-32, 2^-28.
            let parts = [
                sight,
                area * i64::from((weight - spot.best).max(0)),
                if spot.best == 0 { sight } else { 0 },
                sight * half,
                sight * half * texture,
                turned * quarter,
                turned * quarter * texture,
                area * i64::from(fixed(rays.value() - spot.rays.value, 1_048_576.0)),
            ];
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum += part;
            }
        }
        let [surface, better, new, geometry, fine, texture, textured, diversity] = sums;
        let over = |sum: i64, total: i64| sum.checked_div_euclid(total).unwrap_or(0);
        [
            over(surface << 12, all),
            over(better << 12, all),
            over(new << 12, all),
            over(geometry << 4, all),
            over(fine >> 4, all),
            over(texture << 12, facing),
            over(textured << 4, facing),
            over(diversity, all),
        ]
        .map(|share| share as i32) // at most 8, units of 2^-20
    }
}

impl Default for Form {
    fn default() -> Self {
        Self::new()
    }
}

/// Detail and cover of a cell of the picture, each of 127; none outside.
fn detail_at(sketch: &[i8], (u, v): (f32, f32)) -> (i32, i32) {
    let cell = |at: f32| ((at * DETAIL as f32) as usize).min(DETAIL - 1); // not below 0
    let (x, y) = (cell(u), cell(v));
    let at = |place: usize| i32::from(sketch.get(place).copied().unwrap_or(0)).max(0);
    let cover = |dx: usize, dy: usize| at((2 * y + dy) * COVER + 2 * x + dx);
    let covers = cover(0, 0) + cover(1, 0) + cover(0, 1) + cover(1, 1);
    (at(COVER * COVER + y * DETAIL + x), (covers + 2) >> 2)
}

/// Brings the outlooks of all candidates to mean 0 and spread 1, each number by itself: what the
/// network is told, `127 / 4` for one spread, at most 127.
///
/// What all candidates share to less than 2^-17 counts as equal.
fn standardise(outlooks: &mut [[i32; OUTLOOK]]) {
    let count = (outlooks.len() as i64).max(1);
    for place in 0..OUTLOOK {
        let of = |outlook: &[i32; OUTLOOK]| i64::from(outlook.get(place).copied().unwrap_or(0));
        let sum: i64 = outlooks.iter().map(of).sum();
        let mean = sum.checked_div_euclid(count).unwrap_or(0);
        let squares: i64 = outlooks.iter().map(|outlook| (of(outlook) - mean).pow(2)).sum();
        let variance = squares.checked_div_euclid(count).unwrap_or(0);
        let spread = i64::from((variance.unsigned_abs().isqrt()).max(8) as u32);
        for outlook in outlooks.iter_mut() {
            let above = of(outlook) - mean;
            let rounded = (127 * above + 2 * spread).checked_div_euclid(4 * spread).unwrap_or(0);
            if let Some(number) = outlook.get_mut(place) {
                *number = rounded.clamp(-127, 127) as i32;
            }
        }
    }
}
