//! The greedy choice: which candidate comes next. Ties go to the lowest index.
//!
//! Functions over slices, so that they are compiled once whatever the session's capacity.

use glam::Vec3;
use rand_core::Rng;

use super::memory::{Candidate, View};
use super::plan::Start;
use super::scorer::Scorer;
use crate::candidates::chance;
use crate::math;
use crate::objectives::Objective;

/// A chosen candidate and the gain expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub(super) index: usize,
    pub(super) gain: f32,
}

/// What moving the camera takes off a gain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Movement {
    cost: f32,
    from: Option<Vec3>, // the last view's direction from the centre
    centre: Vec3,
}

impl Movement {
    pub(super) fn new(cost: f32, centre: Vec3, views: &[View]) -> Self {
        let from = views.last().map(|view| view.pose.position() - centre);
        Self { cost, from: from.filter(|_| cost > 0.0), centre }
    }

    /// `gain - cost * angle / pi * |gain|`, written as one product: a product with a number that is
    /// not negative never falls as the gain rises, rounding included, so an upper bound of a gain
    /// bounds its value too. The difference would not do: it can fall by a rounding.
    fn value(&self, candidate: &Candidate, gain: f32) -> f32 {
        let Some(from) = self.from else { return gain };
        let to = candidate.pose().position() - self.centre;
        let share = math::angle_between(from, to) / core::f32::consts::PI;
        let loss = self.cost * share.min(1.0);
        gain * if gain < 0.0 { 1.0 + loss } else { 1.0 - loss }
    }
}

/// How far candidates are from the views as a plan counts it, and how far they must be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart {
    opposite: f32,
    least_squared: f32, // metres²
}

impl Apart {
    /// Any distance will do.
    const ANY: Self = Self { opposite: 0.0, least_squared: 0.0 };

    /// As a plan has it: at least `share` of the distance that the farthest candidate has.
    pub(super) fn new(candidates: &[Candidate], opposite: f32, share: f32) -> Self {
        let available = candidates.iter().filter(|c| c.is_available());
        let farthest = available.map(|c| c.apart_squared(opposite)).fold(0.0, f32::max);
        // Before the first view everything is as far as anything.
        let least_squared = if farthest.is_finite() { share * share * farthest } else { 0.0 };
        Self { opposite, least_squared }
    }

    fn squared(&self, candidate: &Candidate) -> f32 {
        candidate.apart_squared(self.opposite)
    }
}

/// The available candidate of the highest value, of those far enough from the views; NaN never wins.
fn best(
    candidates: &[Candidate],
    apart: Apart,
    value: impl Fn(usize, &Candidate) -> f32,
) -> Option<(usize, f32)> {
    let mut best = None;
    for (index, candidate) in candidates.iter().enumerate() {
        if !candidate.is_available() || apart.squared(candidate) < apart.least_squared {
            continue;
        }
        let value = value(index, candidate);
        let wins = match best {
            None => !value.is_nan(),
            Some((_, highest)) => value > highest,
        };
        if wins {
            best = Some((index, value));
        }
    }
    best
}

/// The candidate that gains most in an objective.
pub(super) fn by_objective<S: Scorer>(
    scorer: &S,
    objective: Objective,
    candidates: &mut [Candidate],
    views: usize,
    movement: Movement,
    apart: Apart,
) -> Option<Choice> {
    // The stamp of an answer that is up to date.
    let now = (views as u32).saturating_add(1);
    let known = candidates.iter().all(|c| !c.is_available() || c.asked(objective) > 0);
    if !(scorer.diminishes(objective) && known) {
        refresh(scorer, objective, candidates, now);
    }
    // Lazy greedy. A gain asked earlier is an upper bound of today's. Ask anew for the highest
    // bound until the highest is up to date: no other can then exceed it, and of those that could
    // equal it each one of a lower index has been asked.
    loop {
        let (index, _) = best(candidates, apart, |_, c| movement.value(c, c.gain(objective)))?;
        let candidate = candidates.get_mut(index)?;
        if candidate.asked(objective) == now {
            return Some(Choice { index, gain: candidate.gain(objective) });
        }
        let gain = scorer.gain(objective, index, candidate.pose());
        candidate.set_gain(objective, gain);
        candidate.set_asked(objective, now);
    }
}

/// The candidate of the largest sum of gains, each brought to [0, 1] over the candidates.
pub(super) fn by_sum<S: Scorer>(
    scorer: &S,
    candidates: &mut [Candidate],
    views: usize,
    movement: Movement,
    apart: Apart,
) -> Option<Choice> {
    let now = (views as u32).saturating_add(1);
    let ranges = Objective::ALL.map(|objective| {
        refresh(scorer, objective, candidates, now);
        let gains = candidates.iter().filter(|c| c.is_available()).map(|c| c.gain(objective));
        let (low, high) = gains
            .filter(|gain| !gain.is_nan())
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), g| (l.min(g), h.max(g)));
        (objective, low, high - low)
    });
    let sum = |candidate: &Candidate| -> f32 {
        let shares = ranges.iter().map(|&(objective, low, range)| {
            // What is not a number stays so, and is not chosen.
            let gain = candidate.gain(objective);
            if range > 0.0 || gain.is_nan() { (gain - low) / range } else { 0.0 }
        });
        shares.sum()
    };
    let (index, _) = best(candidates, apart, |_, c| movement.value(c, sum(c)))?;
    // The mean of the four gains is what the stop rule compares.
    let gains = candidates.get(index).map(|c| Objective::ALL.map(|o| c.gain(o)));
    let gain = gains.map_or(0.0, |gains| gains.iter().sum::<f32>() / 4.0);
    Some(Choice { index, gain })
}

/// The candidate that gains most support.
pub(super) fn by_support<S: Scorer>(
    scorer: &S,
    candidates: &[Candidate],
    movement: Movement,
    apart: Apart,
) -> Option<Choice> {
    let gain = |index: usize, c: &Candidate| scorer.support(index, c.pose());
    let (index, _) = best(candidates, apart, |index, c| movement.value(c, gain(index, c)))?;
    Some(Choice { index, gain: gain(index, candidates.get(index)?) })
}

/// Asks the scorer for the gains of all available candidates.
pub(super) fn refresh<S: Scorer>(
    scorer: &S,
    objective: Objective,
    candidates: &mut [Candidate],
    now: u32,
) {
    scorer.gains(objective, candidates);
    for candidate in candidates.iter_mut().filter(|c| c.is_available()) {
        candidate.set_asked(objective, now);
    }
}

/// The candidate farthest from every view; its gain is that distance in metres, as it counts.
///
/// `None` where no view has been taken: everything is as far as anything.
fn by_distance(candidates: &[Candidate], movement: Movement, apart: Apart) -> Option<Choice> {
    let distance = |c: &Candidate| math::sqrt(apart.squared(c));
    let (index, _) = best(candidates, Apart::ANY, |_, c| movement.value(c, distance(c)))?;
    let gain = candidates.get(index).map(distance)?;
    gain.is_finite().then_some(Choice { index, gain })
}

/// A candidate by chance. Each draw has its own stream, so a restored session draws on.
pub(super) fn by_chance(candidates: &[Candidate], seed: u64, draw: u64) -> Option<Choice> {
    let available = candidates.iter().filter(|c| c.is_available()).count() as u64;
    // The high half of the product is even over [0, available) to one part in 2^32 / available.
    let place = (u64::from(chance(seed, draw).next_u32()) * available) >> 32;
    let mut rest = candidates.iter().enumerate().filter(|(_, c)| c.is_available());
    rest.nth(place as usize).map(|(index, _)| Choice { index, gain: 0.0 })
}

/// The candidate farthest from every view; one by chance where no view has been taken.
pub(super) fn farthest(
    candidates: &[Candidate],
    movement: Movement,
    apart: Apart,
    chance: (u64, u64),
) -> Option<Choice> {
    by_distance(candidates, movement, apart).or_else(|| by_chance(candidates, chance.0, chance.1))
}

/// The extreme candidate along the axis of a starting step: +x, +y, +z.
fn by_axis(candidates: &[Candidate], step: usize, centre: Vec3) -> Option<Choice> {
    let axis = *[Vec3::X, Vec3::Y, Vec3::Z].get(step)?;
    let along = |_, c: &Candidate| (c.pose().position() - centre).dot(axis);
    let (index, gain) = best(candidates, Apart::ANY, along)?;
    Some(Choice { index, gain })
}

/// The choice of a starting step, counted from 0.
pub(super) fn by_start(
    start: Start,
    step: usize,
    candidates: &[Candidate],
    centre: Vec3,
    movement: Movement,
    apart: Apart,
    chance: (u64, u64),
) -> Option<Choice> {
    let extreme = match start {
        Start::PseudoCoverage => by_axis(candidates, step, centre),
        Start::FarthestPoint => None,
    };
    extreme.or_else(|| farthest(candidates, movement, apart, chance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::Pose;

    /// The value of a gain at an angle from the last view.
    fn value(cost: f32, angle_rad: f32, gain: f32) -> f32 {
        let eye = Vec3::new(math::cos(angle_rad), math::sin(angle_rad), 0.0);
        let candidate = Candidate::new(Pose::looking_at(eye, Vec3::ZERO).unwrap());
        Movement { cost, from: Some(Vec3::X), centre: Vec3::ZERO }.value(&candidate, gain)
    }

    #[test]
    fn the_value_of_a_larger_gain_is_never_smaller() {
        // Lazy greedy stands on it to the last bit. A gain less its product with a share would
        // break it where the product crosses a power of two, as near 1 / share.
        for step in 0..=100 {
            let (cost, angle) = (1.0, core::f32::consts::PI * step as f32 / 100.0);
            let share = step as f32 / 100.0;
            for around in [1.0 / share.max(0.01), 1.0, -1.0, 0.3] {
                let mut gain = around * (1.0 - 2e-6);
                for _ in 0..40 {
                    let next = gain.next_up();
                    assert!(value(cost, angle, next) >= value(cost, angle, gain), "{share} {gain}");
                    gain = next;
                }
            }
        }
    }

    #[test]
    fn half_a_turn_costs_the_share_asked_for() {
        use core::f32::consts::{FRAC_PI_2, PI};
        assert_eq!(value(0.5, 0.0, 2.0), 2.0);
        assert!((value(0.5, FRAC_PI_2, 2.0) - 1.5).abs() < 1e-6);
        assert!((value(0.5, PI, 2.0) - 1.0).abs() < 1e-6);
        assert!((value(0.5, PI, -2.0) + 3.0).abs() < 1e-6);
        assert_eq!(value(0.0, PI, 2.0), 2.0);
    }
}
