//! What a candidate would add to the support of later views, by the outlines alone.
//!
//! [`SupportLedger`](crate::objectives::SupportLedger) tells from a mesh whether what later views look
//! for has been seen from near their direction. Here the hull stands in for the mesh, and candidates
//! stand in for later views: every so many-th, 32 at most, wants each of the hull's spots that it sees.
//! Such a pair of a spot and a later view is a *target*. A photo that sees the spot counts
//! `a = (135° / (φ + 15°))²` for it, `φ` being the angle between photo and later view around the centre,
//! and with `w` the area of a target's spot
//!
//! ```text
//! L = Σ w ln(1 + Σ a) / (ln 82 · Σ w)
//! ```
//!
//! which is 1 where each later view has been taken. A spot is seen up to 75 degrees of incidence; nearer
//! to squarely counts no more, and `φ` is not that at the spot: so a byte for each pair of a photo and a
//! later view and a bit for each of a photo and a spot tell all, whatever the order of the photos.

use super::features::Direction;
use super::outlook::{SPOTS, Spot};
use crate::math;

/// Later views at most.
const LATER: usize = 32;

/// A bit for each spot.
pub type Seen = [u32; SPOTS.div_ceil(32)];

/// What is known of a place that photos are or may be taken from.
#[derive(Clone, Copy, Debug)]
pub struct Standpoint {
    near: [u8; LATER], // root of `a`, units of 1 / NEAR, for each later view
    pub(super) seen: Seen,
    pub(super) gain: f32, // of L, if a photo is taken
}

/// One, in units of a root of `a`: the largest root is 9.
const NEAR: f32 = 28.0;

/// ln 82: what a target has where its later view itself has been taken.
const WHOLE: f32 = 4.406_719;

impl Standpoint {
    /// What memory holds before there is one.
    pub const NONE: Self = Self { near: [0; LATER], seen: [0; SPOTS.div_ceil(32)], gain: 0.0 };

    /// In a direction from the centre, among candidates.
    pub(super) fn new(direction: Direction, candidates: &[Direction]) -> Self {
        let mut standpoint = Self::NONE;
        for (near, later) in standpoint.near.iter_mut().zip(later(candidates)) {
            let apart = math::acos(direction.vector().dot(later.vector())).to_degrees();
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

/// Those of the candidates that stand in for later views.
fn later<T>(candidates: &[T]) -> impl Iterator<Item = &T> {
    let count = candidates.len().min(LATER);
    let every = move |place: usize| (place * candidates.len()).checked_div(count);
    (0..count).filter_map(move |place| candidates.get(every(place)?))
}

/// Tells every candidate what L would gain by a photo from there; 0 where no later view sees a spot.
pub(super) fn gains(spots: &[Spot], views: &[Standpoint], candidates: &mut [Standpoint]) {
    for candidate in candidates.iter_mut() {
        candidate.gain = 0.0;
    }
    let mut wanted = 0.0;
    for (place, spot) in spots.iter().enumerate() {
        // Of the spot's targets, 1 / (1 + Σ a), units of NEAR²; 0 where the later view does not see it.
        let mut sums = [0u32; LATER];
        for view in views.iter().filter(|view| view.sees(place)) {
            for (sum, &near) in sums.iter_mut().zip(&view.near) {
                *sum += u32::from(near).pow(2);
            }
        }
        let mut open = [0.0; LATER];
        let mut targets = 0.0;
        for ((open, later), sum) in open.iter_mut().zip(later(candidates)).zip(sums) {
            if later.sees(place) {
                *open = 1.0 / (NEAR * NEAR + sum as f32);
                targets += 1.0;
            }
        }
        let area = spot.area as f32;
        wanted += area * targets;
        for candidate in candidates.iter_mut().filter(|candidate| candidate.sees(place)) {
            // A product of 16 factors of at most 82 is a number.
            let halves = open.chunks_exact(16).zip(candidate.near.chunks_exact(16));
            for (open, near) in halves {
                let mut product = 1.0;
                for (open, &near) in open.iter().zip(near) {
                    product *= 1.0 + (u32::from(near).pow(2)) as f32 * open;
                }
                candidate.gain += area * math::ln(product);
            }
        }
    }
    let share = if wanted > 0.0 { 1.0 / (WHOLE * wanted) } else { 0.0 };
    for candidate in candidates {
        candidate.gain *= share;
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::super::features::Stance;
    use super::super::hull::tests::{Ball, any_stance, cases, sketch_of, stances};
    use super::super::image::SKETCH;
    use super::super::outlook::{Eye, Form};
    use super::*;

    /// What candidates gain after photos with these sketches.
    fn told(
        sketch: impl Fn(&Stance) -> Vec<i8>,
        photos: &[Stance],
        candidates: &[Direction],
    ) -> Vec<f32> {
        let mut form = Form::new();
        form.begin();
        let sketches: Vec<_> = photos.iter().map(sketch).collect();
        for (stance, sketch) in photos.iter().zip(&sketches) {
            form.take_in(stance, sketch);
        }
        let new = |&direction: &Direction| Standpoint::new(direction, candidates);
        let mut views: Vec<_> = photos.iter().map(|stance| new(&stance.direction)).collect();
        let mut standpoints: Vec<_> = candidates.iter().map(new).collect();
        let photos = photos.iter().zip(sketches.iter().map(Vec::as_slice));
        let mut outlooks = vec![Default::default(); candidates.len()];
        form.outlooks(photos, candidates, &mut outlooks, |eye, seen| match eye {
            Eye::View(view) => views[view].seen = *seen,
            Eye::Candidate(candidate) => standpoints[candidate].seen = *seen,
        });
        form.support(&views, &mut standpoints);
        standpoints.iter().map(|standpoint| standpoint.gain).collect()
    }

    #[test]
    fn of_a_ball_the_view_again_gains_least_and_one_from_behind_most() {
        let all = stances(64);
        let candidates: Vec<_> = all.iter().map(|stance| stance.direction).collect();
        for view in [0, 9, 30, 63] {
            let ball = |stance: &Stance| sketch_of(&[Ball::new(0.0, 0.0, 0.0, 0.6)], stance);
            let gains = told(ball, &all[view..=view], &candidates);
            let by = |a: &usize, b: &usize| gains[*a].total_cmp(&gains[*b]);
            let most = (0..64).max_by(by).unwrap();
            assert_eq!((0..64).min_by(by), Some(view));
            let cosine = candidates[view].vector().dot(candidates[most].vector());
            assert!(cosine < -0.2, "{view} {most} {cosine}");
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
        assert_eq!(told(one_cell, &all[..2], &candidates), vec![0.0; 7]);
        assert_eq!(told(one_cell, &all[..2], &[]), Vec::<f32>::new());
    }

    #[test]
    fn all_that_can_be_had_is_one() {
        // A single spot, candidates all in one place: a photo is what each later view wants.
        let direction = stances(5)[2].direction;
        let mut spot = Spot::default();
        spot.area = 77;
        let mut candidates = [Standpoint::new(direction, &[direction; 40]); 40];
        for candidate in &mut candidates {
            candidate.seen[0] = 1;
        }
        gains(&[spot], &[], &mut candidates);
        // But for the rounding of the direction, whose length is not quite one.
        assert!(candidates.iter().all(|candidate| (candidate.gain - 1.0).abs() < 0.02));
    }

    /// Photos, candidates, and spots with their areas; what is seen is drawn too.
    type Case = (Vec<(Stance, Seen)>, Vec<(Stance, Seen)>, Vec<i32>);

    fn any_case() -> impl Strategy<Value = Case> {
        let seen = || any::<[u32; SPOTS.div_ceil(32)]>();
        let photos = prop::collection::vec((any_stance(), seen()), 0..5);
        let candidates = prop::collection::vec((any_stance(), seen()), 1..70);
        (photos, candidates, prop::collection::vec(1..2000i32, 1..60))
    }

    fn standpoints(of: &[(Stance, Seen)], candidates: &[Direction]) -> Vec<Standpoint> {
        let standpoint = |(stance, seen): &(Stance, Seen)| Standpoint {
            seen: *seen,
            ..Standpoint::new(stance.direction, candidates)
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
            let mut views = standpoints(&photos, &directions);
            let mut told = standpoints(&candidates, &directions);
            gains(&spots, &views, &mut told);

            let sees = |seen: &Seen, spot: usize| seen[spot / 32] >> (spot % 32) & 1 == 1;
            let counts = |(from, seen): &(Stance, Seen), spot: usize, to: &Stance| {
                let cosine = from.direction.vector().as_dvec3().dot(to.direction.vector().as_dvec3());
                let apart = cosine.clamp(-1.0, 1.0).acos().to_degrees();
                if sees(seen, spot) { (135.0 / (apart + 15.0)).powi(2) } else { 0.0 }
            };
            let count = candidates.len().min(32);
            let later: Vec<_> = (0..count).map(|k| &candidates[k * candidates.len() / count]).collect();
            for (one, told) in candidates.iter().zip(&told) {
                let (mut sum, mut wanted) = (0.0, 0.0);
                for (spot, &area) in areas.iter().enumerate() {
                    for (to, _) in later.iter().filter(|(_, seen)| sees(seen, spot)) {
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
            gains(&spots, &views, &mut told);
            prop_assert_eq!(before, told.iter().map(|standpoint| standpoint.gain).collect::<Vec<_>>());
        }
    }

    #[test]
    fn as_many_photos_as_there_may_be_do_not_overflow() {
        let direction = stances(5)[2].direction;
        let mut standpoint = Standpoint::new(direction, &[direction]);
        standpoint.seen = [u32::MAX; SPOTS.div_ceil(32)];
        let mut spots = [Spot::default(); SPOTS];
        for spot in &mut spots {
            spot.area = i32::from(i16::MAX);
        }
        let mut candidates = [standpoint];
        gains(&spots, &[standpoint; 256], &mut candidates);
        let expected = (1.0 + 81.0 / (1.0 + 256.0 * 81.0f32)).ln() / 82f32.ln();
        assert!((candidates[0].gain / expected - 1.0).abs() < 1e-3);
    }
}
