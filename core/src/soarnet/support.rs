//! What a candidate would add to the support of later views, by the outlines alone: `F = L + 1.5 R`.
//!
//! [`SupportLedger`](crate::objectives::SupportLedger) tells from a mesh whether what later views look
//! for has been seen from near their direction, and how much has been shown to be empty. Here the visual
//! hull stands in for the mesh.
//!
//! **L, angular support.** Later views look from an even lattice of 48 directions, as far as there are
//! candidates within 30 degrees; each sees the spots that the candidate nearest to it sees. Such a pair of
//! a spot and a later view is a *target*. A photo that sees the spot counts `a = (135° / (φ + 15°))²` for
//! it, `φ` being the angle between photo and later view around the centre. With `w` the area of a target's
//! spot,
//!
//! ```text
//! L = Σ w ln(1 + Σ a) / (ln 82 · Σ w)
//! ```
//!
//! which is 1 where each later view has been taken. A spot is seen up to 75 degrees of incidence; nearer
//! to squarely counts no more, and `φ` is not that at the spot: so a byte for each pair of a photo and a
//! later view and a bit for each of a photo and a spot tell all, whatever the order of the photos.
//!
//! **R, rims.** A photo carves best where it looks along the surface. With `s` the sine of the angle
//! between a line of sight and the surface at a spot, `R` is the mean of `1 - min s` over the hull, by area;
//! before the first photo it is 0.
//!
//! The weight was chosen by radiance fields on ten procedural objects that shared their candidates: less
//! farthest-point sampling, plans by L alone gave +0.29 dB at 12 views and -0.50 at 20, with R +0.61 and
//! -0.22. On other objects and candidates: `lab/RESULTS.md`.

use glam::Vec3;

use super::features::Direction;
use super::hull::Camera;
use super::outlook::{SPOTS, Spot};
use crate::math;

/// Directions of later views.
const LATER: usize = 48;

/// A bit for each spot.
pub type Seen = [u32; SPOTS.div_ceil(32)];

/// What is known of a place that photos are or may be taken from.
#[derive(Clone, Copy, Debug)]
pub struct Standpoint {
    near: [u8; LATER], // root of `a`, units of 1 / NEAR, for each later view
    pub(super) seen: Seen,
    pub(super) gain: f32, // of F, if a photo is taken
}

/// One, in units of a root of `a`: the largest root is 9.
const NEAR: f32 = 28.0;

/// ln 82: what a target has where its later view itself has been taken.
const WHOLE: f32 = 4.406_719;

/// How much R counts beside L.
const RIMS: f32 = 1.5;

/// The cosine of 30 degrees: a later view farther than that from any candidate will not be.
const WITHIN: f32 = 0.866_025_4;

impl Standpoint {
    /// What memory holds before there is one.
    pub const NONE: Self = Self { near: [0; LATER], seen: [0; SPOTS.div_ceil(32)], gain: 0.0 };

    /// In a direction from the centre.
    pub(super) fn new(direction: Direction) -> Self {
        let mut standpoint = Self::NONE;
        for (near, later) in standpoint.near.iter_mut().zip(lattice()) {
            let apart = math::acos(direction.vector().dot(later)).to_degrees();
            *near = (NEAR * 135.0 / (apart + 15.0) + 0.5) as u8;
        }
        standpoint
    }

    fn sees(&self, spot: usize) -> bool {
        self.seen.get(spot / 32).is_some_and(|word| word >> (spot % 32) & 1 == 1)
    }
}

impl Default for Standpoint {
    fn default() -> Self {
        Self::NONE
    }
}

/// The directions of later views: slices of equal area, the golden angle from one to the next.
fn lattice() -> impl Iterator<Item = Vec3> {
    let turn = |(x, y): (f32, f32)| {
        (-0.737_368_9 * x - 0.675_490_3 * y, 0.675_490_3 * x - 0.737_368_9 * y)
    };
    let around = core::iter::successors(Some((1.0, 0.0)), move |&last| Some(turn(last)));
    around.take(LATER).enumerate().map(|(place, (x, y))| {
        let z = 1.0 - (2 * place + 1) as f32 / LATER as f32;
        let width = math::sqrt(1.0 - z * z);
        Vec3::new(width * x, width * y, z)
    })
}

/// A later view that can be: where in the lattice, and the candidate that sees what it sees.
#[derive(Clone, Copy, Debug)]
struct Later {
    place: usize,
    candidate: usize,
}

/// The later views among candidates.
fn later(directions: &[Direction]) -> heapless::Vec<Later, LATER> {
    let mut list = heapless::Vec::new();
    for (place, later) in lattice().enumerate() {
        let mut nearest = (WITHIN, None);
        for (candidate, direction) in directions.iter().enumerate() {
            let cosine = direction.vector().dot(later);
            if cosine > nearest.0 {
                nearest = (cosine, Some(candidate));
            }
        }
        if let Some(candidate) = nearest.1 {
            let _ = list.push(Later { place, candidate }); // there is room
        }
    }
    list
}

/// Tells every candidate what F would gain by a photo from there; 0 where there is no spot.
pub(super) fn gains(
    spots: &[Spot],
    views: &[Standpoint],
    directions: &[Direction],
    candidates: &mut [Standpoint],
) {
    for candidate in candidates.iter_mut() {
        candidate.gain = 0.0;
    }
    let later = later(directions);
    let looks = |later: &Later, candidates: &[Standpoint], spot: usize| {
        candidates.get(later.candidate).is_some_and(|candidate| candidate.sees(spot))
    };
    let (mut surface, mut wanted) = (0.0, 0.0);
    for (index, spot) in spots.iter().enumerate() {
        surface += spot.area as f32;
        let targets = later.iter().filter(|later| looks(later, candidates, index)).count();
        wanted += spot.area as f32 * targets as f32;
    }
    let part = |share: f32, whole: f32| if whole > 0.0 { share / whole } else { 0.0 };
    let (support, rims) = (part(1.0, WHOLE * wanted), part(RIMS, surface));
    for (index, spot) in spots.iter().enumerate() {
        let mut sums = [0u32; LATER];
        for view in views.iter().filter(|view| view.sees(index)) {
            for (sum, &near) in sums.iter_mut().zip(&view.near) {
                *sum += u32::from(near).pow(2);
            }
        }
        // The spot's targets: the place of the later view, and 1 / (1 + Σ a), units of NEAR².
        let mut targets: heapless::Vec<(usize, f32), LATER> = heapless::Vec::new();
        for later in later.iter().filter(|later| looks(later, candidates, index)) {
            let sum = sums.get(later.place).copied().unwrap_or_default();
            let _ = targets.push((later.place, 1.0 / (NEAR * NEAR + sum as f32))); // there is room
        }
        let area = spot.area as f32;
        for (candidate, &direction) in candidates.iter_mut().zip(directions) {
            let slant = spot.slant_from(Camera::eye_in(direction));
            candidate.gain += rims * area * (spot.slant - slant).max(0.0);
            if !candidate.sees(index) {
                continue;
            }
            // A product of 16 factors of at most 82 is a number.
            for targets in targets.chunks(16) {
                let mut product = 1.0;
                for &(place, open) in targets {
                    let near = candidate.near.get(place).copied().unwrap_or_default();
                    product *= 1.0 + u32::from(near).pow(2) as f32 * open;
                }
                candidate.gain += support * area * math::ln(product);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use glam::DVec3;
    use proptest::prelude::*;

    use super::super::features::Stance;
    use super::super::hull::tests::{Ball, any_stance, cases, sketch_of, stances};
    use super::super::image::SKETCH;
    use super::super::outlook::{Eye, Form};
    use super::*;

    /// What candidates gain after photos, over the hull that these sketches carve.
    fn told(
        sketch: impl Fn(&Stance) -> Vec<i8>,
        carving: &[Stance],
        photos: &[Stance],
        candidates: &[Direction],
    ) -> Vec<f32> {
        let mut form = Form::new();
        form.begin();
        let sketches: Vec<_> = photos.iter().map(&sketch).collect();
        for stance in carving {
            form.take_in(stance, &sketch(stance));
        }
        let new = |&direction: &Direction| Standpoint::new(direction);
        let mut views: Vec<_> = photos.iter().map(|stance| new(&stance.direction)).collect();
        let mut standpoints: Vec<_> = candidates.iter().map(new).collect();
        let photos = photos.iter().zip(sketches.iter().map(Vec::as_slice));
        let mut outlooks = vec![Default::default(); candidates.len()];
        form.outlooks(photos, candidates, &mut outlooks, |eye, seen| match eye {
            Eye::View(view) => views[view].seen = *seen,
            Eye::Candidate(candidate) => standpoints[candidate].seen = *seen,
        });
        form.support(&views, candidates, &mut standpoints);
        standpoints.iter().map(|standpoint| standpoint.gain).collect()
    }

    #[test]
    fn of_a_ball_the_view_again_gains_least_and_one_well_away_most() {
        let all = stances(64);
        let candidates: Vec<_> = all.iter().map(|stance| stance.direction).collect();
        for view in [0, 9, 30, 63] {
            let ball = |stance: &Stance| sketch_of(&[Ball::new(0.0, 0.0, 0.0, 0.6)], stance);
            let gains = told(ball, &all, &all[view..=view], &candidates);
            let by = |a: &usize, b: &usize| gains[*a].total_cmp(&gains[*b]);
            let most = (0..64).max_by(by).unwrap();
            assert_eq!((0..64).min_by(by), Some(view));
            let cosine = candidates[view].vector().dot(candidates[most].vector());
            // From straight behind, the ball has the same rim.
            assert!(cosine < 0.4, "{view} {most} {cosine}");
            assert!(gains[view] > 0.0 && gains[most] > 2.0 * gains[view] && gains[most] < 1.0);
        }
    }

    #[test]
    fn what_cannot_be_seen_gains_nothing() {
        let all = stances(7);
        let candidates: Vec<_> = all.iter().map(|stance| stance.direction).collect();
        let one_cell = |_: &Stance| {
            let mut sketch = vec![0; SKETCH];
            sketch[0] = 127; // in the corner, outside the ball that the hull begins with
            sketch
        };
        assert_eq!(told(one_cell, &all[..2], &all[..2], &candidates), vec![0.0; 7]);
        assert_eq!(told(one_cell, &all[..2], &all[..2], &[]), Vec::<f32>::new());
    }

    #[test]
    fn all_that_can_be_had_is_one() {
        // A photo from each later view, of a single spot that all of them see.
        let on_lattice = |later| Direction::try_from_vector(later).unwrap();
        let directions: Vec<_> = lattice().map(on_lattice).collect();
        let see = |&direction| Standpoint { seen: [1; _], ..Standpoint::new(direction) };
        let mut candidates: Vec<_> = directions.iter().map(see).collect();
        let mut spot = Spot::default();
        spot.area = 77;
        let (mut sum, mut first) = (0.0, 0.0);
        for taken in 0..LATER {
            let views = candidates.clone();
            gains(&[spot], &views[..taken], &directions, &mut candidates);
            sum += candidates[taken].gain;
            first = if taken == 0 { sum } else { first };
        }
        // Neighbours support each other too.
        assert!((1.0..1.3).contains(&sum), "{sum}");
        // Later views far from all candidates do not count.
        let alone = &mut [candidates[7]];
        gains(&[spot], &[], &directions[7..8], alone);
        assert!(alone[0].gain > 0.5 && first < 0.4, "{} {first}", alone[0].gain);
    }

    #[test]
    fn a_rim_not_yet_seen_counts_one_and_a_half() {
        // Spots without a normal, which lie in every line of sight, and which nobody sees.
        let spot = |area: i32, slant: f32| {
            let mut spot = Spot::default();
            (spot.area, spot.slant) = (area, slant);
            spot
        };
        let direction = stances(5)[2].direction;
        let mut candidates = [Standpoint::new(direction); 2];
        gains(&[spot(30, 0.5), spot(10, 0.1)], &[], &[direction; 2], &mut candidates);
        let expected = 1.5 * (0.75 * 0.5 + 0.25 * 0.1);
        assert!(candidates.iter().all(|candidate| (candidate.gain - expected).abs() < 1e-6));
    }

    /// Photos, candidates, and spots with their areas; what is seen is drawn too.
    type Case = (Vec<(Stance, Seen)>, Vec<(Stance, Seen)>, Vec<i32>);

    fn any_case() -> impl Strategy<Value = Case> {
        let seen = || any::<[u32; SPOTS.div_ceil(32)]>();
        let photos = prop::collection::vec((any_stance(), seen()), 0..5);
        let candidates = prop::collection::vec((any_stance(), seen()), 1..70);
        (photos, candidates, prop::collection::vec(1..2000i32, 1..60))
    }

    fn standpoints(of: &[(Stance, Seen)]) -> Vec<Standpoint> {
        let standpoint = |(stance, seen): &(Stance, Seen)| Standpoint {
            seen: *seen,
            ..Standpoint::new(stance.direction)
        };
        of.iter().map(standpoint).collect()
    }

    proptest! {
        #![proptest_config(cases(48))]

        #[test]
        fn a_gain_is_its_plain_definition((photos, candidates, areas) in any_case()) {
            let directions: Vec<_> = candidates.iter().map(|(stance, _)| stance.direction).collect();
            let spots: Vec<_> = areas.iter().map(|&area| {
                let mut spot = Spot::default();
                spot.area = area;
                spot
            }).collect();
            let mut views = standpoints(&photos);
            let mut told = standpoints(&candidates);
            gains(&spots, &views, &directions, &mut told);

            let sees = |seen: &Seen, spot: usize| seen[spot / 32] >> (spot % 32) & 1 == 1;
            let cosine = |from: &Stance, to: DVec3| from.direction.vector().as_dvec3().dot(to);
            let counts = |(from, seen): &(Stance, Seen), spot: usize, to: DVec3| {
                let apart = cosine(from, to).clamp(-1.0, 1.0).acos().to_degrees();
                if sees(seen, spot) { (135.0 / (apart + 15.0)).powi(2) } else { 0.0 }
            };
            let nearest = |to: DVec3| {
                let by = |a: &&(Stance, Seen), b: &&(Stance, Seen)| {
                    cosine(&a.0, to).total_cmp(&cosine(&b.0, to))
                };
                candidates.iter().max_by(by).filter(|one| cosine(&one.0, to) > 0.75f64.sqrt())
            };
            // Slices of the sphere, each turned by the golden angle from the one before.
            let later: Vec<(DVec3, &Seen)> = (0..48).filter_map(|k| {
                let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 48.0;
                let around = f64::from(k) * core::f64::consts::PI * (3.0 - 5f64.sqrt());
                let to = DVec3::new(around.cos(), around.sin(), 0.0) * (1.0 - z * z).sqrt();
                let to = to + DVec3::Z * z;
                Some((to, &nearest(to)?.1))
            }).collect();
            for (one, told) in candidates.iter().zip(&told) {
                let (mut sum, mut wanted) = (0.0, 0.0);
                for (spot, &area) in areas.iter().enumerate() {
                    for &(to, _) in later.iter().filter(|(_, seen)| sees(seen, spot)) {
                        let before: f64 = photos.iter().map(|photo| counts(photo, spot, to)).sum();
                        let after = before + counts(one, spot, to);
                        sum += f64::from(area) * ((1.0 + after) / (1.0 + before)).ln();
                        wanted += f64::from(area) * 82f64.ln();
                    }
                }
                let expected = if wanted > 0.0 { sum / wanted } else { 0.0 };
                prop_assert!((f64::from(told.gain) - expected).abs() < 6e-3, "{} {expected}", told.gain);
            }

            // Neither does the order of photos change a bit.
            let before: Vec<_> = told.iter().map(|standpoint| standpoint.gain).collect();
            views.reverse();
            gains(&spots, &views, &directions, &mut told);
            prop_assert_eq!(before, told.iter().map(|standpoint| standpoint.gain).collect::<Vec<_>>());
        }
    }

    #[test]
    fn as_many_photos_as_there_may_be_do_not_overflow() {
        let direction = Direction::try_from_vector(lattice().next().unwrap()).unwrap();
        let mut standpoint = Standpoint::new(direction);
        standpoint.seen = [u32::MAX; SPOTS.div_ceil(32)];
        let mut spots = [Spot::default(); SPOTS];
        for spot in &mut spots {
            spot.area = i32::from(i16::MAX);
        }
        let mut candidates = [standpoint];
        gains(&spots, &[standpoint; 256], &[direction], &mut candidates);
        let expected = (1.0 + 81.0 / (1.0 + 256.0 * 81.0f32)).ln() / 82f32.ln();
        assert!((candidates[0].gain / expected - 1.0).abs() < 1e-3);
    }
}
