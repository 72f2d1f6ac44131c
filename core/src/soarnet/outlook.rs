//! What a candidate would see of the visual hull: the objectives, by the outlines alone.
//!
//! About 384 *spots* are spread over the hull's surface. From every view so far each spot learns how
//! squarely it was seen, from which directions and how textured its place in the photo was; from there
//! the four objectives of a further view follow as they do on a mesh. Nothing here is learned: the
//! candidate's head is told these numbers and decides what to make of them.
//!
//! A *sight* is of a spot that faces a camera, with nothing of the hull between: its weight is
//! `e = min(1, 2 cos)` of the angle of incidence. With `a` a spot's area, `A` that of all spots, `e_k`
//! the weight for view k (0 where it does not see the spot), `s = Σ_k e_k`, `t` how textured the spot is
//! beside the mean of all, at most 8, and sums over the spots that the candidate sees:
//!
//! | | number | what it tells |
//! |---|---|---|
//! | 0 | `Σ a e / A` | how much surface the candidate faces |
//! | 1 | `Σ a max(0, e - max_k e_k) / A` | C: seen better than from any view so far |
//! | 2 | `Σ a e / A` over spots not seen at all | C: seen for the first time |
//! | 3 | `Σ a e 2^-s / A` | Q, all spots alike |
//! | 4 | `Σ a t e 2^-s / A` | Q, more where there is texture |
//! | 5 | `Σ a cos 4^-s / Σ a cos` | T, all spots alike |
//! | 6 | `Σ a t cos 4^-s / Σ a cos` | T, more where there is texture |
//! | 7 | `Σ a (d_after - d_before) / A`, d as in eqs. `obj_D_1` to `obj_D_7_2` | D |
//!
//! Geometry is in single precision, spot by spot; whatever is added up over views or candidates is a
//! whole number, so that their order changes nothing.
//!
//! A spot without a normal, of a flat sheet as thin as a voxel, is seen squarely from both sides.
//!
//! Not handled: hollows that no outline shows, and a thin sheet that is bent or at a slant to the grid,
//! whose spots have a normal and so one side each.

use glam::Vec3;

use super::features::{Direction, Stance};
use super::hull::{Bounds, Camera, Hull};
use super::image::{COVER, DETAIL};
use super::rays::{Rays, fixed};
use super::support::{self, Seen, Standpoint};
use crate::math;

/// Numbers of an outlook.
pub const OUTLOOK: usize = 8;

/// Spots wanted, and at most kept: how many a lattice hits is not quite certain.
const WANTED: u64 = 384;
pub(super) const SPOTS: usize = 432;

/// The weight of a sight that is whole: e = 1.
const WHOLE: i32 = 256;

/// A place on the hull's surface, and what is known of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    centre: Vec3,
    normal: Vec3,
    pub(super) slant: f32, // least so far: see `slant_from`
    pub(super) area: i32,  // units of 2^-8 voxel sides squared
    best: i32,             // max of e, units of 2^-8
    sum: i32,              // of e, units of 2^-8
    detail: i32,           // sum of cos · detail, units of 2^-8 · 1/127
    covered: i32,          // sum of cos · cover, likewise
    rays: Rays,            // of all views that see it
    discount: [i32; 2],    // 2^-s and 4^-s, units of 2^-8
    texture: i32,          // t, units of 2^-8
}

impl Spot {
    /// How far the line of sight from a camera is from lying in the surface: the sine of the angle, 0 to 1.
    /// What is thin lies in all of them.
    pub(super) fn slant_from(&self, eye: Vec3) -> f32 {
        let towards = eye - self.centre;
        (towards.dot(self.normal) * math::inverse_sqrt(towards.length_squared())).abs()
    }
}

/// How a spot is seen from a camera: the direction to it, the cosine of incidence and the weight of
/// the sight; `None` if it is not.
#[inline]
fn sight(hull: &Hull, bounds: &Bounds, spot: &Spot, eye: Vec3) -> Option<(Vec3, f32, i32)> {
    let towards = eye - spot.centre;
    // What is thin is seen squarely from everywhere.
    let thin = spot.normal == Vec3::ZERO;
    // Away from the camera by more than what is rounded: the cosine below is negative.
    if !thin && towards.dot(spot.normal) < -1e-3 {
        return None;
    }
    let direction = towards * math::inverse_sqrt(towards.length_squared());
    let cosine = if thin { 1.0 } else { direction.dot(spot.normal) };
    let open = cosine > 0.0 && hull.is_open(bounds, spot.centre, spot.normal, direction);
    open.then(|| (direction, cosine, fixed(2.0 * cosine, WHOLE as f32).min(WHOLE)))
}

/// Notes that a spot is seen, if its sight has half a weight at least.
fn note(seen: &mut Seen, spot: usize, weight: i32) {
    if let Some(word) = seen.get_mut(spot / 32).filter(|_| 2 * weight >= WHOLE) {
        *word |= 1 << (spot % 32);
    }
}

/// Who looks at spots: a view or a candidate, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eye {
    /// A view so far.
    View(usize),
    /// A candidate.
    Candidate(usize),
}

/// The visual hull and the spots on it: 45 KiB. What is in it before [`begin`](Self::begin) does not
/// matter.
#[derive(Clone, Debug)]
pub struct Form {
    hull: Hull,
    bounds: Bounds, // of the hull, once its spots have been spread
    spots: heapless::Vec<Spot, SPOTS>,
}

impl Form {
    /// Empty, at no cost of flash in a `static`.
    pub const fn new() -> Self {
        Self { hull: Hull::new(), bounds: Bounds::NONE, spots: heapless::Vec::new() }
    }

    /// As before the first photo.
    pub fn begin(&mut self) {
        self.hull.fill();
        self.spots.clear();
    }

    /// Takes in the outline of a photo, as its sketch has it: shape (320). Nothing where the camera looks
    /// at a right angle past the object, which then lies straight to its right or left.
    pub fn take_in(&mut self, stance: &Stance, sketch: &[i8]) {
        if let Some(camera) = Camera::try_new(stance) {
            self.hull.carve(&camera, sketch);
        }
    }

    /// What candidates would see, as the network is told it: [`OUTLOOK`] numbers each, of mean 0 and
    /// spread 127 / 4 over the candidates, or less where they hardly differ, in -127..=127. `views` are
    /// those taken in with their sketches, in any order, at most 256. `saw` is told which spots views
    /// and candidates see.
    ///
    /// Shapes: `candidates` and `outlooks` (n), a sketch (320).
    pub fn outlooks<'a>(
        &mut self,
        views: impl Iterator<Item = (&'a Stance, &'a [i8])>,
        candidates: &[Direction],
        outlooks: &mut [[i32; OUTLOOK]],
        mut saw: impl FnMut(Eye, &Seen),
    ) {
        self.survey(views, &mut saw);
        for (index, (outlook, &candidate)) in outlooks.iter_mut().zip(candidates).enumerate() {
            let mut seen = [0; _];
            *outlook = self.outlook(candidate, &mut seen);
            saw(Eye::Candidate(index), &seen);
        }
        standardise(outlooks);
    }

    /// Tells every candidate what a photo from there would add to support; see [`support`].
    pub(super) fn support(
        &self,
        views: &[Standpoint],
        directions: &[Direction],
        candidates: &mut [Standpoint],
    ) {
        support::gains(&self.spots, views, directions, candidates);
    }

    /// Spreads the spots anew and tells them of all views.
    fn survey<'a>(
        &mut self,
        views: impl Iterator<Item = (&'a Stance, &'a [i8])>,
        mut saw: impl FnMut(Eye, &Seen),
    ) {
        // The lattice of least discrepancy in three dimensions (Roberts, 2018): a voxel that comes or
        // goes leaves the other spots where they are.
        let share = (WANTED << 32).checked_div(self.hull.surface_count().into()).unwrap_or(0);
        let on_lattice = |x: u32, y: u32, z: u32| {
            let place = x.wrapping_mul(0xd1b5_4a33);
            let place = place.wrapping_add(y.wrapping_mul(0xabc9_8388));
            u64::from(place.wrapping_add(z.wrapping_mul(0x8cb9_2ba7))) < share
        };
        self.bounds = self.hull.bounds();
        self.spots.clear();
        for voxel in self.hull.surface(on_lattice) {
            let (centre, normal, area) = (voxel.centre, voxel.normal, fixed(voxel.area, 256.0));
            let spot = Spot { centre, normal, area, slant: 1.0, ..Spot::default() };
            if self.spots.push(spot).is_err() {
                break;
            }
        }
        for (view, (stance, sketch)) in views.enumerate() {
            let mut seen = [0; _];
            let camera = Camera::try_new(stance);
            for (place, spot) in self.spots.iter_mut().enumerate() {
                let Some(camera) = &camera else { break };
                spot.slant = spot.slant.min(spot.slant_from(camera.eye));
                let Some((direction, cosine, weight)) =
                    sight(&self.hull, &self.bounds, spot, camera.eye)
                else {
                    continue;
                };
                note(&mut seen, place, weight);
                spot.best = spot.best.max(weight);
                spot.sum += weight;
                spot.rays.add(direction, cosine);
                let (detail, cover) = detail_at(sketch, camera.project(spot.centre));
                let weight = fixed(cosine, 256.0);
                spot.detail += weight * detail;
                spot.covered += weight * cover;
            }
            saw(Eye::View(view), &seen);
        }
        self.conclude();
    }

    /// From sums over views to what gains are made of.
    fn conclude(&mut self) {
        let total = |of: fn(&Spot) -> i32| -> f32 {
            self.spots.iter().map(|spot| i64::from(of(spot))).sum::<i64>() as f32
        };
        let mean = total(|spot| spot.detail) / total(|spot| spot.covered).max(1.0);
        // Of a spot nothing is known but that it is like the others: that counts as 0.3 of a sight.
        let prior = 0.3 * 256.0 * 127.0;
        for spot in &mut self.spots {
            spot.rays.before = spot.rays.value();
            let half = math::exp(-core::f32::consts::LN_2 * spot.sum as f32 / WHOLE as f32);
            spot.discount = [half, half * half].map(|share| fixed(share, 256.0));
            let texture = (spot.detail as f32 + prior * mean) / (spot.covered as f32 + prior);
            spot.texture = fixed(texture / (mean + 0.01), 256.0).min(2048);
        }
    }

    /// The outlook of a candidate, units of 2^-20; see the [module](self). Notes the spots it sees.
    fn outlook(&self, candidate: Direction, seen: &mut Seen) -> [i32; OUTLOOK] {
        let eye = Camera::eye_in(candidate);
        let mut sums = [0i64; OUTLOOK];
        let mut facing = 0i64; // sum of a · cos, units of 2^-16
        let mut all = 0i64; // sum of a, units of 2^-8
        for (place, spot) in self.spots.iter().enumerate() {
            let area = i64::from(spot.area);
            all += area;
            let Some((direction, cosine, weight)) = sight(&self.hull, &self.bounds, spot, eye)
            else {
                continue;
            };
            note(seen, place, weight);
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
                area * i64::from(fixed(rays.value() - spot.rays.before, 1_048_576.0)),
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

/// Detail and cover of the cell of 8 x 8 in which a place lies, or of the nearest; each of 127.
fn detail_at(sketch: &[i8], (u, v): (f32, f32)) -> (i32, i32) {
    let cell = |at: f32| ((at * DETAIL as f32) as usize).min(DETAIL - 1); // not below 0
    let (x, y) = (cell(u), cell(v));
    let at = |place: usize| i32::from(sketch.get(place).copied().unwrap_or(0)).max(0);
    let cover = |dx: usize, dy: usize| at((2 * y + dy) * COVER + 2 * x + dx);
    let covers = cover(0, 0) + cover(1, 0) + cover(0, 1) + cover(1, 1);
    (at(COVER * COVER + y * DETAIL + x), (covers + 2) >> 2)
}

/// 2^-7, in units of 2^-20.
const LEAST_SPREAD: u64 = 1 << 13;

/// Brings the outlooks of all candidates to mean 0 and spread 1, each number by itself: what the
/// network is told, `127 / 4` for one spread, at most 127.
///
/// A spread below [`LEAST_SPREAD`] counts as that, so that what hardly differs fades instead of being
/// blown up: late in a capture the last unseen spots of a hull say little.
fn standardise(outlooks: &mut [[i32; OUTLOOK]]) {
    let count = (outlooks.len() as i64).max(1);
    for place in 0..OUTLOOK {
        let of = |outlook: &[i32; OUTLOOK]| i64::from(outlook.get(place).copied().unwrap_or(0));
        let sum: i64 = outlooks.iter().map(of).sum();
        let mean = sum.checked_div_euclid(count).unwrap_or(0);
        let squares: i64 = outlooks.iter().map(|outlook| (of(outlook) - mean).pow(2)).sum();
        let variance = squares.checked_div_euclid(count).unwrap_or(0);
        let spread = i64::from(variance.unsigned_abs().isqrt().max(LEAST_SPREAD) as u32);
        for outlook in outlooks.iter_mut() {
            let above = of(outlook) - mean;
            let rounded = (127 * above + 2 * spread).checked_div_euclid(4 * spread).unwrap_or(0);
            if let Some(number) = outlook.get_mut(place) {
                *number = rounded.clamp(-127, 127) as i32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::super::hull::tests::{
        Ball, any_sketch, any_stance, cases, hull_of, sheet, sketch_of, stances,
    };
    use super::super::image::SKETCH;
    use super::super::rays::tests::{diversity, double};
    use super::*;
    use crate::pose::Pose;

    type Photo = (Stance, Vec<i8>);

    const BALLS: [Ball; 2] = [Ball::new(-0.4, 0.1, 0.0, 0.45), Ball::new(0.4, -0.1, 0.2, 0.4)];

    /// True outlines of balls; the details are those of `detail`, of column and row.
    fn photos_of(
        balls: &[Ball],
        stances: &[Stance],
        detail: impl Fn(usize, usize) -> i8,
    ) -> Vec<Photo> {
        let photo = |stance: &Stance| {
            let mut sketch = sketch_of(balls, stance);
            for (place, number) in sketch[COVER * COVER..].iter_mut().enumerate() {
                *number = detail(place % DETAIL, place / DETAIL);
            }
            (*stance, sketch)
        };
        stances.iter().map(photo).collect()
    }

    fn carved(photos: &[Photo]) -> Form {
        let mut form = Form::new();
        form.begin();
        for (stance, sketch) in photos {
            form.take_in(stance, sketch);
        }
        form
    }

    fn views(photos: &[Photo]) -> impl Iterator<Item = (&Stance, &[i8])> {
        photos.iter().map(|(stance, sketch)| (stance, sketch.as_slice()))
    }

    /// With all spots told of all photos.
    fn surveyed(photos: &[Photo]) -> Form {
        let mut form = carved(photos);
        form.survey(views(photos), |_, _| ());
        form
    }

    /// As the network is told them.
    fn told(photos: &[Photo], candidates: &[Direction]) -> Vec<[i32; OUTLOOK]> {
        let mut outlooks = vec![[7; OUTLOOK]; candidates.len()];
        carved(photos).outlooks(views(photos), candidates, &mut outlooks, |_, _| ());
        outlooks
    }

    fn outlook(form: &Form, candidate: Direction) -> [i32; OUTLOOK] {
        form.outlook(candidate, &mut [0; _])
    }

    fn directions(count: usize) -> Vec<Direction> {
        stances(count).iter().map(|stance| stance.direction).collect()
    }

    #[test]
    fn a_large_surface_has_about_384_spots_and_a_small_one_all_its_voxels() {
        let mut small = 0;
        for views in 1..40 {
            for radius in [0.1, 0.2, 0.35, 0.6] {
                let ball = Ball::new(0.02 * views as f64 - 0.4, 0.1, 0.0, radius);
                let mut form = Form { hull: hull_of(&[ball], views % 7 + 1), ..Form::new() };
                let voxels = form.hull.surface_count() as usize;
                form.survey(core::iter::empty(), |_, _| ());
                let spots = form.spots.len();
                if voxels <= 384 {
                    small += 1;
                    assert_eq!(spots, voxels);
                } else {
                    // Fewer than there is room for: none is left out.
                    assert!((350..SPOTS).contains(&spots), "{spots} of {voxels}");
                }
            }
        }
        assert!(small > 10, "{small}");
    }

    #[test]
    fn a_view_again_gains_nothing_and_the_opposite_one_most() {
        let all = stances(60);
        let sketch = [127; SKETCH]; // carves nothing away from the ball
        let mut form = carved(&[]);
        for view in [0, 7, 31, 59] {
            let camera = Camera::try_new(&all[view]).unwrap();
            form.survey(core::iter::once((&all[view], sketch.as_slice())), |_, _| ());
            let gains: Vec<_> = all.iter().map(|other| outlook(&form, other.direction)).collect();
            for number in [1, 2] {
                assert_eq!(gains[view][number], 0);
                let gain = |other: usize| gains[other][number];
                let most = (0..60).map(gain).max().unwrap();
                let eyes = all.iter().map(|other| Camera::eye_in(other.direction));
                let cosines: Vec<f32> = eyes.map(|eye| eye.dot(camera.eye) / 9.0).collect();
                let opposite = (0..60).min_by(|&a, &b| cosines[a].total_cmp(&cosines[b])).unwrap();
                // Weights are whole up to 60 degrees of incidence, so that its neighbours are as good but
                // for where spots happen to lie.
                let near = (0..60).filter(|&other| cosines[other] > 0.8).map(gain).max().unwrap();
                let opposite = gain(opposite);
                assert!(opposite > 150_000 && opposite * 5 > most * 4, "{opposite} {most}");
                assert!(near * 2 < opposite, "{near} {opposite}");
            }
            // A second ray from the same place spreads nothing.
            assert_eq!(gains[view][7], 0);
        }
    }

    #[test]
    fn a_thin_spot_is_seen_squarely_from_both_sides() {
        let [above, below] = [Vec3::new(0.3, 0.2, 1.0), Vec3::new(0.2, -0.4, -1.0)].map(|eye| {
            let pose = Pose::looking_at(eye, Vec3::ZERO).unwrap();
            Stance::try_new(&pose, Vec3::ZERO).unwrap()
        });
        let sketch = [127; SKETCH];
        let stances = [above, below];
        let cameras = stances.map(|stance| Camera::try_new(&stance).unwrap());
        for side in 0..2 {
            let mut form = Form { hull: sheet(), ..Form::new() };
            form.survey(core::iter::once((&stances[side], sketch.as_slice())), |_, _| ());
            let thin = form.spots.iter().filter(|spot| spot.normal == Vec3::ZERO);
            assert_eq!(thin.clone().count(), 12 * 12);
            for spot in thin {
                assert_eq!((spot.best, spot.rays.count), (WHOLE, 1));
                let other = sight(&form.hull, &form.bounds, spot, cameras[1 - side].eye).unwrap();
                assert_eq!((other.1, other.2), (1.0, WHOLE));
            }
        }
    }

    #[test]
    fn a_slant_is_the_least_sine_between_a_line_of_sight_and_the_surface() {
        let photos = photos_of(&BALLS, &stances(17)[4..9], |x, _| x as i8);
        let mut steep = 0;
        for spot in &surveyed(&photos).spots {
            let sine = |(stance, _): &Photo| {
                let ray = double(Camera::eye_in(stance.direction) - spot.centre).normalize();
                ray.dot(double(spot.normal).normalize()).abs()
            };
            let expected = photos.iter().map(sine).fold(1.0, f64::min);
            assert!((f64::from(spot.slant) - expected).abs() < 1e-5);
            steep += usize::from(expected > 0.2);
        }
        assert!(steep > 20, "{steep}");
        let mut form = carved(&photos);
        form.survey(core::iter::empty(), |_, _| ());
        assert!(form.spots.iter().all(|spot| spot.slant == 1.0));
    }

    #[test]
    fn an_outlook_is_its_plain_definition() {
        let photos = photos_of(&BALLS, &stances(17)[4..9], |x, y| (13 * x + 3 * y) as i8);
        let form = surveyed(&photos);
        let total: f64 = form.spots.iter().map(|spot| f64::from(spot.area)).sum();
        let mut largest = [0.0f64; OUTLOOK];
        for candidate in directions(30) {
            let (mut sums, mut facing) = ([0.0; OUTLOOK], 0.0);
            for spot in &form.spots {
                // Sights as the code has them: `is_open` has its own test.
                let see = |eye: Vec3| {
                    sight(&form.hull, &form.bounds, spot, eye)?;
                    let ray = (double(eye) - double(spot.centre)).normalize();
                    Some((ray, ray.dot(double(spot.normal).normalize())))
                };
                let Some(new) = see(Camera::eye_in(candidate)) else { continue };
                let seen = photos.iter().filter_map(|(s, _)| see(Camera::eye_in(s.direction)));
                let seen: Vec<_> = seen.collect();
                let weight = |cosine: f64| (2.0 * cosine).min(1.0);
                let sum: f64 = seen.iter().map(|ray| weight(ray.1)).sum();
                let best = seen.iter().map(|ray| weight(ray.1)).fold(0.0, f64::max);
                let area = f64::from(spot.area);
                let texture = f64::from(spot.texture) / 256.0;
                let (e, cosine) = (weight(new.1), new.1);
                let before = if seen.len() < 2 { 0.0 } else { diversity(&seen) };
                let after = [seen.as_slice(), &[new]].concat();
                let after = if after.len() < 2 { 0.0 } else { diversity(&after) };
                facing += area * cosine;
                let parts = [
                    e / total,
                    (e - best).max(0.0) / total,
                    if seen.is_empty() { e / total } else { 0.0 },
                    e * 0.5f64.powf(sum) / total,
                    texture * e * 0.5f64.powf(sum) / total,
                    cosine * 0.25f64.powf(sum),
                    texture * cosine * 0.25f64.powf(sum),
                    (after - before) / total,
                ];
                for (sum, part) in sums.iter_mut().zip(parts) {
                    *sum += area * part;
                }
            }
            sums[5] /= facing;
            sums[6] /= facing;
            let got = outlook(&form, candidate);
            for (number, (got, expected)) in got.into_iter().zip(sums).enumerate() {
                let got = f64::from(got) / 1_048_576.0;
                assert!((got - expected).abs() < 3e-3, "{number}: {got} instead of {expected}");
                largest[number] = largest[number].max(expected);
            }
        }
        assert!(largest.iter().all(|&largest| largest > 0.03), "{largest:?}");
    }

    #[test]
    fn a_place_is_textured_as_its_photos_show_it() {
        // Of a ball, the left half of the photo is textured; candidates to the left see that half.
        let pose = Pose::looking_at(Vec3::new(0.0, -3.0, 0.0), Vec3::ZERO).unwrap();
        let stance = Stance::try_new(&pose, Vec3::ZERO).unwrap();
        let ball = [Ball::new(0.0, 0.0, 0.0, 0.6)];
        let form = surveyed(&photos_of(&ball, &[stance], |x, _| if x < 4 { 80 } else { 4 }));
        let seen = |spot: &&Spot| spot.best > 200;
        let textures = form.spots.iter().filter(seen).map(|spot| (spot.centre.x, spot.texture));
        let (left, right): (Vec<_>, Vec<_>) =
            textures.filter(|(x, _)| x.abs() > 0.1).partition(|(x, _)| *x < 0.0);
        assert!(left.iter().all(|(_, texture)| *texture > 256), "{left:?}");
        assert!(right.iter().all(|(_, texture)| *texture < 230), "{right:?}");
        assert!(left.len() > 8 && right.len() > 8, "{} {}", left.len(), right.len());
        let [left, right] = [-1.0, 1.0]
            .map(|x| outlook(&form, Direction::try_from_vector(Vec3::new(x, -1.0, 0.0)).unwrap()));
        for (plain, fine) in [(3, 4), (5, 6)] {
            let share = |outlook: [i32; OUTLOOK]| outlook[fine] as f32 / outlook[plain] as f32;
            assert!(share(left) > 1.05 * share(right), "{left:?} {right:?}");
        }
        // Of what no photo shows, the texture is the mean.
        let behind = form.spots.iter().filter(|spot| spot.rays.count == 0);
        let textures: Vec<_> = behind.map(|spot| spot.texture).collect();
        assert!(textures.len() > 100 && textures.iter().all(|&t| (245..=256).contains(&t)));
    }

    /// Of one number of outlooks.
    fn mean_and_spread(outlooks: &[[i32; OUTLOOK]], number: usize) -> (f64, f64) {
        let all = || outlooks.iter().map(|outlook| f64::from(outlook[number]));
        let count = outlooks.len() as f64;
        let mean = all().sum::<f64>() / count;
        (mean, (all().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt())
    }

    #[test]
    fn told_numbers_have_mean_0_and_spread_127_over_4_or_fade() {
        let candidates = directions(100);
        for count in [1, 3, 10] {
            let photos = photos_of(&BALLS, &stances(11)[..count], |x, y| (9 * x + 7 * y) as i8);
            let outlooks = told(&photos, &candidates);
            let form = surveyed(&photos);
            let before: Vec<_> = candidates.iter().map(|&to| outlook(&form, to)).collect();
            for number in 0..OUTLOOK {
                let (mean, spread) = mean_and_spread(&outlooks, number);
                assert!(outlooks.iter().all(|outlook| outlook[number].abs() <= 127));
                assert!(mean.abs() < 0.25, "{count} {number}: {mean}");
                // A spread below 2^-7 counts as that. Ten views have seen nearly everything squarely.
                let share = mean_and_spread(&before, number).1 / 1_048_576.0 * 128.0;
                assert_eq!(share < 1.0, matches!((count, number), (10, 1 | 2)), "{share}");
                let expected = 31.75 * share.min(1.0);
                assert!((spread - expected).abs() < 0.25, "{count} {number}: {spread}");
            }
        }
    }

    #[test]
    fn what_stands_out_is_cut_off_and_what_is_equal_is_0() {
        let mut outlooks = vec![[5, -9, 1 << 23, 0, 3, 0, 0, 0]; 100];
        outlooks[40][1] = 1 << 20;
        outlooks[41][3] = -(1 << 20);
        outlooks[42][4] = 3 + LEAST_SPREAD as i32; // a tenth of it as spread
        standardise(&mut outlooks);
        assert_eq!(outlooks[0], [0, -3, 0, 3, 0, 0, 0, 0]);
        assert_eq!(outlooks[40], [0, 127, 0, 3, 0, 0, 0, 0]);
        assert_eq!(outlooks[41], [0, -3, 0, -127, 0, 0, 0, 0]);
        assert_eq!(outlooks[42], [0, -3, 0, 3, 31, 0, 0, 0]);
        standardise(&mut []);
        let mut alone = [[1 << 22; OUTLOOK]];
        standardise(&mut alone);
        assert_eq!(alone, [[0; OUTLOOK]]);
    }

    #[test]
    fn what_hardly_differs_fades() {
        let least = LEAST_SPREAD as i32;
        let apart = [4 * least, least + 1, least, least / 2, least / 8, least / 128, 1, 0];
        let mut outlooks = vec![apart, apart.map(|spread| -spread)];
        standardise(&mut outlooks);
        assert_eq!(outlooks[0], [32, 32, 32, 16, 4, 0, 0, 0]);
        assert_eq!(outlooks[1], [-32, -32, -32, -16, -4, 0, 0, 0]);
    }

    #[test]
    fn without_a_hull_or_candidates_nothing_is_told() {
        let mut one_cell = vec![0; SKETCH];
        one_cell[0] = 127; // in the corner, outside the ball
        let photos = [(stances(3)[1], one_cell)];
        assert_eq!(told(&photos, &directions(9)), vec![[0; OUTLOOK]; 9]);
        assert_eq!(told(&photos, &[]), Vec::<[i32; OUTLOOK]>::new());
        assert!(surveyed(&photos).spots.is_empty());
    }

    proptest! {
        #![proptest_config(cases(24))]

        #[test]
        fn neither_the_order_of_views_nor_of_candidates_changes_anything(
            photos in prop::collection::vec((any_stance(), any_sketch()), 1..6),
            order in Just((0..20).collect::<Vec<usize>>()).prop_shuffle(),
        ) {
            let candidates = directions(20);
            let before = told(&photos, &candidates);
            let mut turned = photos.clone();
            turned.reverse();
            prop_assert_eq!(&before, &told(&turned, &candidates));
            let moved: Vec<_> = order.iter().map(|&index| candidates[index]).collect();
            let after = told(&photos, &moved);
            for (outlook, &index) in after.iter().zip(&order) {
                prop_assert_eq!(outlook, &before[index]);
            }
        }

        /// Overflow checks are on in tests.
        #[test]
        fn no_sketch_and_no_stance_panics(
            photos in prop::collection::vec(
                (any_stance(), prop::collection::vec(any::<i8>(), 0..400)), 0..5,
            ),
            more in prop::collection::vec(any_stance(), 0..5), times in 1usize..60, fill: i8,
        ) {
            let mut all = Vec::new();
            for _ in 0..times {
                all.extend(photos.iter().cloned());
            }
            all.extend(more.into_iter().map(|stance| (stance, vec![fill; SKETCH])));
            all.truncate(256);
            for outlook in told(&all, &directions(7)) {
                prop_assert!(outlook.iter().all(|number| number.abs() <= 127));
            }
        }
    }
}
