//! Where a camera stands as the angles of a machine.

use core::f32::consts::{PI, TAU};

use vantage_core::{Pose, PoseError, Vec2, Vec3, math};

/// A direction from the object: azimuth counter-clockwise from +X as seen from above, and elevation
/// above the horizontal plane, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// In [-π, π].
    pub azimuth_rad: f32,
    /// In [-π/2, π/2].
    pub elevation_rad: f32,
}

impl Place {
    /// Where a pose stands, seen from `centre`; `None` at the centre itself.
    pub fn of(pose: &Pose, centre: Vec3) -> Option<Self> {
        let direction = math::unit(pose.position() - centre)?;
        let azimuth_rad = Vec2::new(direction.x, direction.y).to_angle();
        Some(Self { azimuth_rad, elevation_rad: math::asin(direction.z) })
    }

    /// The pose of a camera that stands there, `radius_m` from `centre`, and looks at it.
    pub fn pose(self, centre: Vec3, radius_m: f32) -> Result<Pose, PoseError> {
        let level = math::cos(self.elevation_rad);
        let (x, y) = (math::cos(self.azimuth_rad), math::sin(self.azimuth_rad));
        let direction = Vec3::new(level * x, level * y, math::sin(self.elevation_rad));
        Pose::looking_at(centre + radius_m * direction, centre)
    }
}

/// The same angle in [-π, π].
pub fn wrapped(angle_rad: f32) -> f32 {
    angle_rad - TAU * math::floor((angle_rad + PI) / TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_where_its_pose_stands() {
        let centre = Vec3::new(0.1, -0.2, 0.3);
        for (azimuth_rad, elevation_rad) in [(0.0, 0.0), (3.1, 1.2), (-2.0, -0.4), (1.5, 0.7)] {
            let place = Place { azimuth_rad, elevation_rad };
            let pose = place.pose(centre, 0.4).unwrap();
            assert!(((pose.position() - centre).length() - 0.4).abs() < 1e-6);
            let again = Place::of(&pose, centre).unwrap();
            assert!((again.azimuth_rad - azimuth_rad).abs() < 1e-5, "{again:?}");
            assert!((again.elevation_rad - elevation_rad).abs() < 1e-5, "{again:?}");
        }
        assert_eq!(Place::of(&Place::default().pose(centre, 1.0).unwrap(), centre + Vec3::X), None);
    }

    #[test]
    fn angles_wrap_to_the_shortest() {
        for (angle, same) in [(0.5, 0.5), (3.5, 3.5 - TAU), (-3.5, TAU - 3.5), (7.0, 7.0 - TAU)] {
            assert!((wrapped(angle) - same).abs() < 1e-6, "{angle}");
        }
    }
}
