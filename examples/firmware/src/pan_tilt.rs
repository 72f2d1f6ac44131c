//! A pan-tilt head with a boom: two steppers carry the camera around the object, within limits.

use core::ops::RangeInclusive;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use vantage_core::{Pose, Vec3};

use crate::place::Place;
use crate::rig::{Miss, Mount};
use crate::stepper::Stepper;

/// A camera on a boom, whose axes meet at the object's centre: pan is azimuth, tilt is elevation.
/// At the start both motors stand at their zeros: azimuth 0, elevation 0.
#[derive(Clone, Debug)]
pub struct PanTilt<S, D, W> {
    pan: Stepper<S, D>,
    tilt: Stepper<S, D>,
    delay: W,
    centre: Vec3,  // of the object, metres
    radius_m: f32, // from centre to camera
    pan_rad: RangeInclusive<f32>,
    tilt_rad: RangeInclusive<f32>,
    settle_ms: u32,
}

impl<S, D, W> PanTilt<S, D, W>
where
    S: OutputPin,
    D: OutputPin<Error = S::Error>,
    W: DelayNs,
{
    /// A head around `centre` with a boom of `radius_m`, which goes nearly a turn each way (its cable
    /// is wound up no further) and from the table to the top. After a move it waits `settle_ms`.
    pub fn new(
        pan: Stepper<S, D>,
        tilt: Stepper<S, D>,
        delay: W,
        centre: Vec3,
        radius_m: f32,
        settle_ms: u32,
    ) -> Self {
        let (pan_rad, tilt_rad) = (-3.2..=3.2, 0.0..=1.5);
        Self { pan, tilt, delay, centre, radius_m, pan_rad, tilt_rad, settle_ms }
    }

    /// The same within other limits, radians.
    pub fn with_limits(self, pan_rad: RangeInclusive<f32>, tilt_rad: RangeInclusive<f32>) -> Self {
        Self { pan_rad, tilt_rad, ..self }
    }
}

impl<S, D, W> Mount for PanTilt<S, D, W>
where
    S: OutputPin,
    D: OutputPin<Error = S::Error>,
    W: DelayNs,
{
    type Error = S::Error;

    fn move_to(&mut self, pose: &Pose) -> Result<Pose, Miss<S::Error>> {
        let Place { azimuth_rad, elevation_rad } =
            Place::of(pose, self.centre).ok_or(Miss::OutOfReach)?;
        if !(self.pan_rad.contains(&azimuth_rad) && self.tilt_rad.contains(&elevation_rad)) {
            return Err(Miss::OutOfReach);
        }
        self.pan.turn_to(azimuth_rad, &mut self.delay).map_err(Miss::Broken)?;
        self.tilt.turn_to(elevation_rad, &mut self.delay).map_err(Miss::Broken)?;
        self.delay.delay_ms(self.settle_ms);
        let place =
            Place { azimuth_rad: self.pan.angle_rad(), elevation_rad: self.tilt.angle_rad() };
        place.pose(self.centre, self.radius_m).map_err(|_| Miss::OutOfReach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recorded::CountingPin;
    use crate::stepper::Ramp;
    use embedded_hal_mock::eh1::delay::NoopDelay;
    use vantage_core::candidates::{Pool, ViewSpace};

    fn head(steps: u32) -> PanTilt<CountingPin, CountingPin, NoopDelay> {
        let motor =
            || Stepper::new(CountingPin::default(), CountingPin::default(), steps, Ramp::default());
        PanTilt::new(motor(), motor(), NoopDelay, Vec3::ZERO, 3.0, 100)
    }

    #[test]
    fn every_pose_within_the_limits_is_reached_to_half_a_step() {
        let mut head = head(3200).with_limits(-3.2..=3.2, 0.2..=1.2);
        let pool = Pool::try_new(ViewSpace::FibonacciSphere, 60, 3.0).unwrap();
        let mut reached = 0;
        for pose in pool.iter() {
            let elevation = Place::of(&pose, Vec3::ZERO).unwrap().elevation_rad;
            match head.move_to(&pose) {
                Ok(at) => {
                    reached += 1;
                    assert!((0.2..=1.2).contains(&elevation));
                    let half = 3.0 * core::f32::consts::PI / 3200.0;
                    assert!((at.position() - pose.position()).length() < 1.5 * half);
                    // The pose that was really reached is told, not the one that was asked for.
                    assert_ne!(at, pose);
                }
                Err(miss) => {
                    assert_eq!(miss, Miss::OutOfReach);
                    assert!(!(0.2..=1.2).contains(&elevation));
                }
            }
        }
        assert!(reached > 10);
    }

    #[test]
    fn what_the_cable_does_not_reach_is_out_of_reach() {
        let mut head = head(3200).with_limits(-1.0..=1.0, 0.0..=1.5);
        let place = Place { azimuth_rad: 1.1, elevation_rad: 0.5 };
        let pose = place.pose(Vec3::ZERO, 3.0).unwrap();
        assert_eq!(head.move_to(&pose), Err(Miss::OutOfReach));
    }
}
