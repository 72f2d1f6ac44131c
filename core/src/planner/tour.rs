//! A short way through a set of views: the order that moves the camera least.
//!
//! The length of a move is the great-circle angle between two directions from the centre, radians.
//! Nearest neighbour first, then 2-opt (turn a stretch around) and Or-opt (move a stretch of up to
//! three further on) until neither helps. For the few dozen views of a capture the result is within
//! a few per cent of the optimum; see the tests.

use glam::Vec3;

use crate::math;

/// Improvements below this are rounding, radians.
const NOTICEABLE: f32 = 1e-5;

/// Rounds of improvement after which to stop whatever is left: far more than a few dozen views need.
const MOST_ROUNDS: usize = 200;

/// Puts `order` into a short sequence and gives its length in radians.
///
/// `order` holds the numbers of the places to visit; `place` gives the direction of a number from
/// the centre (any length). The way begins at `start` where one is given and ends anywhere.
///
/// ```
/// use vantage_core::{Vec3, planner::shortest_tour};
/// let places = [Vec3::X, Vec3::NEG_X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
/// let mut order = [0, 1, 2, 3];
/// let length = shortest_tour(Some(Vec3::X), |place| places[place], &mut order);
/// assert_eq!(order, [0, 2, 3, 1]);
/// assert!((length - core::f32::consts::PI).abs() < 1e-5);
/// ```
pub fn shortest_tour(
    start: Option<Vec3>,
    place: impl Fn(usize) -> Vec3,
    order: &mut [usize],
) -> f32 {
    let tour = Tour { start, place };
    tour.nearest_neighbour(order);
    for _ in 0..MOST_ROUNDS {
        let turned = tour.two_opt(order);
        let moved = tour.or_opt(order);
        if !turned && !moved {
            break;
        }
    }
    tour.length(order)
}

struct Tour<P> {
    start: Option<Vec3>,
    place: P,
}

impl<P: Fn(usize) -> Vec3> Tour<P> {
    /// The angle of the step into position `to`, which comes after the place number `from`; a step
    /// from or to nowhere costs nothing.
    fn step(&self, from: Option<usize>, to: Option<usize>) -> f32 {
        match (from, to) {
            (Some(from), Some(to)) => math::angle_between((self.place)(from), (self.place)(to)),
            _ => 0.0,
        }
    }

    /// The same for the first place of the tour.
    fn first_step(&self, to: Option<usize>) -> f32 {
        match (self.start, to) {
            (Some(start), Some(to)) => math::angle_between(start, (self.place)(to)),
            _ => 0.0,
        }
    }

    /// The step into `to` from what stands before position `position`.
    fn into(&self, order: &[usize], position: usize, to: Option<usize>) -> f32 {
        match position.checked_sub(1) {
            Some(before) => self.step(order.get(before).copied(), to),
            None => self.first_step(to),
        }
    }

    fn length(&self, order: &[usize]) -> f32 {
        let first = self.first_step(order.first().copied());
        let steps = order.iter().zip(order.iter().skip(1));
        first + steps.map(|(&from, &to)| self.step(Some(from), Some(to))).sum::<f32>()
    }

    fn nearest_neighbour(&self, order: &mut [usize]) {
        for position in 0..order.len() {
            let mut nearest = (position, f32::INFINITY);
            for candidate in position..order.len() {
                let angle = self.into(order, position, order.get(candidate).copied());
                if angle < nearest.1 {
                    nearest = (candidate, angle);
                }
            }
            // Where the next place is the nearest, the stretch has no other end.
            if let Some([next, .., nearest]) = order.get_mut(position..=nearest.0) {
                core::mem::swap(next, nearest);
            }
        }
    }

    /// Turns a stretch around wherever that is shorter; whether it was anywhere.
    fn two_opt(&self, order: &mut [usize]) -> bool {
        let mut better = false;
        for from in 0..order.len() {
            for to in from + 1..order.len() {
                let (first, last) = (order.get(from).copied(), order.get(to).copied());
                let after = order.get(to + 1).copied();
                let before = self.into(order, from, first) + self.step(last, after);
                let turned = self.into(order, from, last) + self.step(first, after);
                if turned + NOTICEABLE < before
                    && let Some(stretch) = order.get_mut(from..=to)
                {
                    stretch.reverse();
                    better = true;
                }
            }
        }
        better
    }

    /// Moves a stretch of one to three places further on wherever that is shorter; whether it was.
    fn or_opt(&self, order: &mut [usize]) -> bool {
        let mut better = false;
        for size in 1..=3usize {
            for from in 0..order.len().saturating_sub(size - 1) {
                let end = from + size;
                let (first, last) = (order.get(from).copied(), order.get(end - 1).copied());
                let after = order.get(end).copied();
                let cut = self.into(order, from, first) + self.step(last, after)
                    - self.into(order, from, after);
                // Later, between `to - 1` and `to`: everything in between moves up.
                for to in end + 1..=order.len() {
                    let (left, right) = (order.get(to - 1).copied(), order.get(to).copied());
                    let added =
                        self.step(left, first) + self.step(last, right) - self.step(left, right);
                    if added + NOTICEABLE < cut
                        && let Some(stretch) = order.get_mut(from..to)
                    {
                        // As `rotate_left(size)`, which would be all of a controller's code for moves.
                        if let Some((moved, passed)) = stretch.split_at_mut_checked(size) {
                            moved.reverse();
                            passed.reverse();
                        }
                        stretch.reverse();
                        better = true;
                        break;
                    }
                }
            }
        }
        better
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates::{Pool, ViewSpace};
    use std::vec::Vec;

    /// The best length over all orders, by trying each.
    fn optimum(start: Vec3, places: &[Vec3]) -> f32 {
        fn go(at: Vec3, places: &[Vec3], left: u32, spent: f32, best: &mut f32) {
            if spent >= *best {
                return;
            }
            if left == 0 {
                *best = spent;
                return;
            }
            for (index, &place) in places.iter().enumerate() {
                if left >> index & 1 == 1 {
                    let step = math::angle_between(at, place);
                    go(place, places, left & !(1 << index), spent + step, best);
                }
            }
        }
        let mut best = f32::INFINITY;
        go(start, places, (1 << places.len()) - 1, 0.0, &mut best);
        best
    }

    #[test]
    fn eight_places_are_within_a_few_per_cent_of_the_optimum() {
        let (mut found, mut best) = (0.0, 0.0);
        for seed in 0..40 {
            let pool = Pool::try_new(ViewSpace::RandomSphere { seed }, 8, 1.0).unwrap();
            let places: Vec<Vec3> = pool.iter().map(|pose| pose.position()).collect();
            let mut order: Vec<usize> = (0..8).collect();
            let length = shortest_tour(Some(Vec3::X), |place| places[place], &mut order);
            let truth = optimum(Vec3::X, &places);
            assert!(length > truth - 1e-4 && length < 1.35 * truth, "seed {seed}");
            found += length;
            best += truth;
        }
        assert!(found < 1.04 * best, "{found} against {best}");
    }

    #[test]
    fn a_tour_keeps_its_places_and_is_no_longer_than_the_order_given() {
        for seed in 0..20 {
            let pool = Pool::try_new(ViewSpace::RandomSphere { seed }, 40, 2.0).unwrap();
            let places: Vec<Vec3> = pool.iter().map(|pose| pose.position()).collect();
            let mut order: Vec<usize> = (0..40).rev().collect();
            let as_given = Tour { start: None, place: |i: usize| places[i] }.length(&order);
            let length = shortest_tour(None, |place| places[place], &mut order);
            assert!(length <= as_given);
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..40));
        }
    }

    #[test]
    fn the_nearest_place_comes_next() {
        let angles = [0.9f32, 0.1, 2.0, 0.2, 0.4];
        let place = |index: usize| Vec3::new(angles[index].cos(), angles[index].sin(), 0.0);
        let mut order = [0, 1, 2, 3, 4];
        Tour { start: Some(Vec3::X), place }.nearest_neighbour(&mut order);
        assert_eq!(order, [1, 3, 4, 0, 2]);
    }

    #[test]
    fn nowhere_to_go_is_no_way() {
        assert_eq!(shortest_tour(Some(Vec3::X), |_| Vec3::Y, &mut []), 0.0);
        assert_eq!(shortest_tour(None, |_| Vec3::Y, &mut [7]), 0.0);
    }
}
