//! A stepper motor behind a driver with a step and a direction input (A4988, DRV8825, TMC2209).
//!
//! A move of `n` steps rises to full speed over the ramp's steps and falls again before its end:
//!
//! ```text
//! rate of step i = slow + (fast - slow) · min(i, n - 1 - i, ramp) / ramp        steps a second
//! ```
//!
//! Not handled: lost steps (the motor is open loop), microsteps that change on the way.

use core::f32::consts::TAU;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{OutputPin, PinState};
use vantage_core::math;

use crate::place::wrapped;

/// How fast a motor may turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ramp {
    /// At the beginning and the end of a move, steps a second, at least 1.
    pub slow_hz: u32,
    /// On the way, steps a second.
    pub fast_hz: u32,
    /// From slow to fast in so many steps.
    pub steps: u32,
}

impl Default for Ramp {
    /// What a geared NEMA 17 with a camera on it does without losing steps.
    fn default() -> Self {
        Self { slow_hz: 200, fast_hz: 1600, steps: 200 }
    }
}

impl Ramp {
    /// Steps a second in step `index` of `count`.
    fn rate_hz(&self, index: u32, count: u32) -> u32 {
        let (slow, fast) = (self.slow_hz.max(1), self.fast_hz.max(self.slow_hz).max(1));
        let from_end = index.min(count.saturating_sub(1).saturating_sub(index)).min(self.steps);
        let rise = u64::from(fast - slow) * u64::from(from_end) / u64::from(self.steps.max(1));
        slow + rise as u32
    }
}

/// One motor and where it stands.
#[derive(Clone, Debug)]
pub struct Stepper<S, D> {
    step: S,
    direction: D,
    steps_per_turn: u32, // of what it turns: full steps, microsteps and gears together
    ramp: Ramp,
    position: i32, // steps from where it was switched on
}

impl<S: OutputPin, D: OutputPin<Error = S::Error>> Stepper<S, D> {
    /// A motor that takes `steps_per_turn` (at least 1) for a turn of what it moves, and stands at
    /// angle 0.
    pub fn new(step: S, direction: D, steps_per_turn: u32, ramp: Ramp) -> Self {
        Self { step, direction, steps_per_turn: steps_per_turn.max(1), ramp, position: 0 }
    }

    /// The angle where it stands, radians; more than a turn where it has turned so far.
    pub fn angle_rad(&self) -> f32 {
        self.position as f32 * (TAU / self.steps_per_turn as f32)
    }

    /// Turns to an angle, to the nearest step; gives the steps taken.
    pub fn turn_to(&mut self, angle_rad: f32, delay: &mut impl DelayNs) -> Result<u32, S::Error> {
        let steps = math::floor(angle_rad * (self.steps_per_turn as f32 / TAU) + 0.5);
        self.go(steps as i32, delay)
    }

    /// The same by the shorter way around, for what may turn for ever.
    pub fn turn_around_to(
        &mut self,
        angle_rad: f32,
        delay: &mut impl DelayNs,
    ) -> Result<u32, S::Error> {
        let way_rad = wrapped(angle_rad - self.angle_rad());
        self.turn_to(self.angle_rad() + way_rad, delay)
    }

    fn go(&mut self, target: i32, delay: &mut impl DelayNs) -> Result<u32, S::Error> {
        let count = target.abs_diff(self.position);
        let forward = target > self.position;
        if count > 0 {
            self.direction.set_state(PinState::from(forward))?;
            delay.delay_us(2); // drivers ask for 0.2 to 0.65 µs before a step
        }
        for index in 0..count {
            let half_ns = 500_000_000 / self.ramp.rate_hz(index, count);
            self.step.set_high()?;
            delay.delay_ns(half_ns);
            self.step.set_low()?;
            delay.delay_ns(half_ns);
            self.position += if forward { 1 } else { -1 };
        }
        Ok(count)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use embedded_hal_mock::eh1::delay::NoopDelay;
    use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
    use std::vec::Vec;

    /// What a step pin sees of so many steps.
    pub fn pulses(count: usize) -> Vec<Transaction> {
        let level = |index: usize| if index.is_multiple_of(2) { State::High } else { State::Low };
        (0..2 * count).map(|index| Transaction::set(level(index))).collect()
    }

    #[test]
    fn a_move_sets_the_direction_and_gives_a_pulse_for_every_step() {
        let mut step = Mock::new(&pulses(3 + 5));
        let mut direction =
            Mock::new(&[Transaction::set(State::High), Transaction::set(State::Low)]);
        let mut motor = Stepper::new(step.clone(), direction.clone(), 400, Ramp::default());
        assert_eq!(motor.turn_to(3.2 / 400.0 * TAU, &mut NoopDelay), Ok(3));
        assert_eq!(motor.turn_to(-2.0 / 400.0 * TAU, &mut NoopDelay), Ok(5));
        assert_eq!(motor.turn_to(-2.0 / 400.0 * TAU, &mut NoopDelay), Ok(0));
        assert!((motor.angle_rad() + 2.0 / 400.0 * TAU).abs() < 1e-6);
        step.done();
        direction.done();
    }

    /// Sums what it is asked to wait.
    #[derive(Default)]
    struct Clock(Vec<u32>);

    impl DelayNs for Clock {
        fn delay_ns(&mut self, ns: u32) {
            self.0.push(ns);
        }
    }

    #[derive(Clone)]
    struct Nothing;

    impl embedded_hal::digital::ErrorType for Nothing {
        type Error = core::convert::Infallible;
    }

    impl OutputPin for Nothing {
        fn set_low(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
        fn set_high(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
    }

    #[test]
    fn speed_rises_to_the_fastest_and_falls_again() {
        let ramp = Ramp { slow_hz: 100, fast_hz: 1000, steps: 10 };
        let mut motor = Stepper::new(Nothing, Nothing, 100, ramp);
        let mut clock = Clock::default();
        motor.turn_to(0.4 * TAU, &mut clock).unwrap();
        let halves: Vec<u32> = clock.0.iter().skip(1).step_by(2).copied().collect();
        assert_eq!(halves.len(), 40);
        assert_eq!((halves[0], halves[39]), (5_000_000, 5_000_000));
        assert!(halves[10..30].iter().all(|&half| half == 500_000));
        assert!(halves[..10].is_sorted_by(|a, b| a > b));
        let reversed: Vec<u32> = halves.iter().rev().copied().collect();
        assert_eq!(halves, reversed);
    }

    #[test]
    fn the_shorter_way_around_is_taken() {
        let mut motor = Stepper::new(Nothing, Nothing, 360, Ramp::default());
        let degree = TAU / 360.0;
        assert_eq!(motor.turn_around_to(170.0 * degree, &mut Clock::default()), Ok(170));
        assert_eq!(motor.turn_around_to(-170.0 * degree, &mut Clock::default()), Ok(20));
        assert_eq!(motor.turn_around_to(0.0, &mut Clock::default()), Ok(170));
        assert!((motor.angle_rad() - TAU).abs() < 1e-5);
    }

    #[test]
    fn a_ramp_of_zeros_still_moves() {
        let mut motor =
            Stepper::new(Nothing, Nothing, 0, Ramp { slow_hz: 0, fast_hz: 0, steps: 0 });
        assert_eq!(motor.turn_to(2.0 * TAU, &mut Clock::default()), Ok(2));
    }
}
