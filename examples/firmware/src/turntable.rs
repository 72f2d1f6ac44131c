//! A turntable: one stepper turns the object, the camera stands still.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use vantage_core::{Pose, Vec3};

use crate::place::Place;
use crate::rig::{Miss, Mount};
use crate::stepper::Stepper;

/// An object on a table that turns, before a camera on a tripod.
///
/// Poses are the object's: where the camera would stand if the object stood still. The table turns
/// counter-clockwise (seen from above) with the motor, so the camera goes the other way around.
/// A camera at one height reaches the candidates of one ring: whatever lies higher or lower by more
/// than the tolerance is out of reach.
#[derive(Clone, Debug)]
pub struct Turntable<S, D, W> {
    motor: Stepper<S, D>,
    delay: W,
    centre: Vec3,       // of the object, above the table's axis, metres
    camera: Place,      // where the camera stands while the table is at 0
    radius_m: f32,      // from centre to camera
    tolerance_rad: f32, // of elevation
    settle_ms: u32,
}

impl<S, D, W> Turntable<S, D, W>
where
    S: OutputPin,
    D: OutputPin<Error = S::Error>,
    W: DelayNs,
{
    /// A table whose axis goes through `centre`, with the camera at a place `radius_m` from there.
    /// After a move it waits `settle_ms` until nothing shakes.
    pub fn new(
        motor: Stepper<S, D>,
        delay: W,
        centre: Vec3,
        camera: Place,
        radius_m: f32,
        settle_ms: u32,
    ) -> Self {
        Self { motor, delay, centre, camera, radius_m, tolerance_rad: 0.05, settle_ms }
    }

    /// Where the camera stands, as the object sees it.
    fn place(&self) -> Place {
        let azimuth_rad = self.camera.azimuth_rad - self.motor.angle_rad();
        Place { azimuth_rad, ..self.camera }
    }
}

impl<S, D, W> Mount for Turntable<S, D, W>
where
    S: OutputPin,
    D: OutputPin<Error = S::Error>,
    W: DelayNs,
{
    type Error = S::Error;

    fn move_to(&mut self, pose: &Pose) -> Result<Pose, Miss<S::Error>> {
        let place = Place::of(pose, self.centre).ok_or(Miss::OutOfReach)?;
        let off = (place.elevation_rad - self.camera.elevation_rad).abs();
        if off > self.tolerance_rad {
            return Err(Miss::OutOfReach);
        }
        let angle_rad = self.camera.azimuth_rad - place.azimuth_rad;
        self.motor.turn_around_to(angle_rad, &mut self.delay).map_err(Miss::Broken)?;
        self.delay.delay_ms(self.settle_ms);
        self.place().pose(self.centre, self.radius_m).map_err(|_| Miss::OutOfReach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stepper::{Ramp, tests::pulses};
    use embedded_hal_mock::eh1::delay::{CheckedDelay, NoopDelay, Transaction as Wait};
    use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
    use vantage_core::candidates::{Pool, ViewSpace};

    #[test]
    fn the_table_turns_the_object_the_other_way_and_settles() {
        let mut step = Mock::new(&pulses(25));
        // The camera goes a quarter counter-clockwise: the table turns a quarter clockwise.
        let mut direction = Mock::new(&[Transaction::set(State::Low)]);
        let ramp = Ramp { slow_hz: 500, fast_hz: 500, steps: 1 };
        let mut waits = std::vec![Wait::delay_us(2)];
        waits.extend(core::iter::repeat_n(Wait::delay_ns(1_000_000), 50));
        waits.push(Wait::delay_ms(300));
        let mut delay = CheckedDelay::new(&waits);
        let motor = Stepper::new(step.clone(), direction.clone(), 100, ramp);
        let camera = Place { azimuth_rad: 0.0, elevation_rad: 0.4 };
        let mut table = Turntable::new(motor, delay.clone(), Vec3::ZERO, camera, 0.5, 300);
        let wanted = Place { azimuth_rad: core::f32::consts::FRAC_PI_2, elevation_rad: 0.4 };
        let reached = table.move_to(&wanted.pose(Vec3::ZERO, 0.6).unwrap()).unwrap();
        let expected = wanted.pose(Vec3::ZERO, 0.5).unwrap();
        assert!((reached.position() - expected.position()).length() < 1e-5);
        step.done();
        direction.done();
        delay.done();
    }

    #[test]
    fn of_three_rings_one_is_within_reach_and_every_pose_is_off_by_half_a_step_at_most() {
        let space = ViewSpace::Rings { rings: 3, min_elevation_rad: 0.1, max_elevation_rad: 1.1 };
        let pool = Pool::try_new(space, 36, 0.5).unwrap();
        let camera = Place { azimuth_rad: 0.3, elevation_rad: 0.6 };
        let counting = crate::recorded::CountingPin::default;
        let motor = Stepper::new(counting(), counting(), 200, Ramp::default());
        let mut table = Turntable::new(motor, NoopDelay, Vec3::ZERO, camera, 0.5, 0);
        let mut reached = 0;
        for pose in pool.iter() {
            match table.move_to(&pose) {
                Ok(at) => {
                    reached += 1;
                    let half = 0.5 * core::f32::consts::PI / 200.0;
                    assert!((at.position() - pose.position()).length() <= half + 1e-5);
                }
                Err(miss) => assert_eq!(miss, Miss::OutOfReach),
            }
        }
        assert_eq!(reached, 12);
    }
}
