//! Where a camera stands and where it looks. Every geometric convention is stated here, once.
//!
//! - Lengths are metres, angles radians. The world is right-handed with **+Z up**.
//! - A [`Pose`] is `world_from_camera`: it takes a point in the camera's frame to the world's.
//! - Camera axes are OpenGL's: +X right, +Y up, the camera looks along **-Z**.
//! - Matrices are written row by row; they multiply column vectors from the left.
//!
//! ```
//! use vantage_core::{Pose, Vec3};
//! let pose = Pose::looking_at(Vec3::new(3.0, 0.0, 0.0), Vec3::ZERO).unwrap();
//! assert!((pose.forward() - Vec3::NEG_X).length() < 1e-6);
//! assert!((pose.up() - Vec3::Z).length() < 1e-6);
//! ```

use core::fmt;

use glam::{Mat3, Quat, Vec3};

use crate::math;

/// A rigid camera pose, `world_from_camera`: always finite, its rotation always of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawPose"))]
pub struct Pose {
    position: Vec3, // camera centre in world, metres
    rotation: Quat, // world_from_camera
}

/// Why numbers do not make a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PoseError {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// The quaternion's length, or a matrix column's, is too far from 1.
    NotUnit {
        /// The length found.
        length: f32,
    },
    /// The matrix mirrors or shears: its columns are not a right-handed orthonormal frame.
    NotARotation,
    /// The camera stands on the point it should look at.
    NoDirection,
}

impl fmt::Display for PoseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => f.write_str("the pose has a coordinate that is NaN or infinite"),
            Self::NotUnit { length } => {
                write!(f, "the pose's rotation has length {length} where 1 is needed")
            }
            Self::NotARotation => {
                f.write_str("the pose's matrix is not a rotation: it mirrors or shears")
            }
            Self::NoDirection => f.write_str("the camera stands on the point it should look at"),
        }
    }
}

impl core::error::Error for PoseError {}

/// How far a rotation given from outside may be from unit length or from orthogonality: single
/// precision written with four digits passes, a scaled or sheared matrix does not.
const ROTATION_TOLERANCE: f32 = 1e-3;

impl Pose {
    /// A pose from the camera centre (world, metres) and the rotation `world_from_camera`.
    ///
    /// The quaternion may be off unit length by 1e-3 and is normalised. NaN is refused.
    pub fn try_new(position: Vec3, rotation: Quat) -> Result<Self, PoseError> {
        if !position.is_finite() || !rotation.is_finite() {
            return Err(PoseError::NotFinite);
        }
        let length = math::sqrt(rotation.length_squared());
        if (length - 1.0).abs() > ROTATION_TOLERANCE {
            return Err(PoseError::NotUnit { length });
        }
        Ok(Self { position, rotation: rotation / length })
    }

    /// A pose from the rows of `world_from_camera`, shape (3, 4) = [rotation | position].
    ///
    /// The rotation may be off by 1e-3 in any length or product of columns.
    pub fn try_from_rows(rows: [[f32; 4]; 3]) -> Result<Self, PoseError> {
        let [[a, b, c, x], [d, e, f, y], [g, h, i, z]] = rows;
        let position = Vec3::new(x, y, z);
        let (right, up, back) = (Vec3::new(a, d, g), Vec3::new(b, e, h), Vec3::new(c, f, i));
        if !(position.is_finite() && right.is_finite() && up.is_finite() && back.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        for column in [right, up, back] {
            let length = math::sqrt(column.length_squared());
            if (length - 1.0).abs() > ROTATION_TOLERANCE {
                return Err(PoseError::NotUnit { length });
            }
        }
        // Each column of a rotation is the cross product of the two before it.
        if (right.cross(up) - back).length_squared() > 9.0 * ROTATION_TOLERANCE * ROTATION_TOLERANCE
        {
            return Err(PoseError::NotARotation);
        }
        Self::from_axes(position, right, up, back)
    }

    /// A pose at `eye` that looks at `target` with the picture's top towards +Z (world, metres).
    ///
    /// Straight above or below the target, where +Z has no direction in the picture, +Y is the top.
    pub fn looking_at(eye: Vec3, target: Vec3) -> Result<Self, PoseError> {
        if !eye.is_finite() || !target.is_finite() {
            return Err(PoseError::NotFinite);
        }
        let back = math::unit(eye - target).ok_or(PoseError::NoDirection)?;
        // The cross product's length is the sine of the angle to +Z; below 1e-3 it is mostly rounding.
        let aside = Vec3::Z.cross(back);
        let aside = if aside.length_squared() < 1e-6 { Vec3::Y.cross(back) } else { aside };
        let right = math::unit(aside).ok_or(PoseError::NoDirection)?;
        Self::from_axes(eye, right, back.cross(right), back)
    }

    fn from_axes(position: Vec3, right: Vec3, up: Vec3, back: Vec3) -> Result<Self, PoseError> {
        let rotation = Quat::from_mat3(&Mat3::from_cols(right, up, back));
        let length = math::sqrt(rotation.length_squared());
        if !(length > 0.5 && length < 2.0) {
            return Err(PoseError::NotARotation);
        }
        Ok(Self { position, rotation: rotation / length })
    }

    /// The camera centre in the world, metres.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The rotation `world_from_camera`, of unit length.
    pub fn rotation(&self) -> Quat {
        self.rotation
    }

    /// The viewing direction in the world (the camera's -Z), unit length.
    pub fn forward(&self) -> Vec3 {
        -self.axes().z_axis
    }

    /// The picture's upward direction in the world (the camera's +Y), unit length.
    pub fn up(&self) -> Vec3 {
        self.axes().y_axis
    }

    /// The picture's rightward direction in the world (the camera's +X), unit length.
    pub fn right(&self) -> Vec3 {
        self.axes().x_axis
    }

    /// The rows of `world_from_camera`, shape (3, 4) = [rotation | position].
    pub fn rows(&self) -> [[f32; 4]; 3] {
        let m = self.axes();
        let p = self.position;
        [
            [m.x_axis.x, m.y_axis.x, m.z_axis.x, p.x],
            [m.x_axis.y, m.y_axis.y, m.z_axis.y, p.y],
            [m.x_axis.z, m.y_axis.z, m.z_axis.z, p.z],
        ]
    }

    /// A point of the world in the camera's frame, metres; visible points have negative z.
    pub fn camera_from_world(&self, point_in_world: Vec3) -> Vec3 {
        self.axes().transpose() * (point_in_world - self.position)
    }

    fn axes(&self) -> Mat3 {
        Mat3::from_quat(self.rotation)
    }
}

/// A pose as it stands in a file: not yet checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawPose {
    position: Vec3,
    rotation: Quat,
}

#[cfg(feature = "serde")]
impl TryFrom<RawPose> for Pose {
    type Error = PoseError;

    fn try_from(raw: RawPose) -> Result<Self, PoseError> {
        // Taken as it is, not normalised again: a restored session must hold the same bits.
        Self::try_new(raw.position, raw.rotation)?;
        Ok(Self { position: raw.position, rotation: raw.rotation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nan_and_infinity_are_refused() {
        let nan = Vec3::new(0.0, f32::NAN, 1.0);
        assert_eq!(Pose::try_new(nan, Quat::IDENTITY), Err(PoseError::NotFinite));
        assert_eq!(Pose::looking_at(Vec3::INFINITY, Vec3::ZERO), Err(PoseError::NotFinite));
        let rotation = Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0);
        assert_eq!(Pose::try_new(Vec3::ONE, rotation), Err(PoseError::NotFinite));
    }

    #[test]
    fn a_rotation_off_unit_length_is_refused() {
        let doubled = Quat::IDENTITY * 2.0;
        assert_eq!(Pose::try_new(Vec3::ONE, doubled), Err(PoseError::NotUnit { length: 2.0 }));
    }

    #[test]
    fn a_mirrored_matrix_is_refused() {
        let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]];
        assert_eq!(Pose::try_from_rows(rows), Err(PoseError::NotARotation));
    }

    #[test]
    fn standing_on_the_target_gives_no_direction() {
        assert_eq!(Pose::looking_at(Vec3::ONE, Vec3::ONE), Err(PoseError::NoDirection));
    }

    #[test]
    fn straight_down_has_y_at_the_top() {
        let pose = Pose::looking_at(Vec3::Z * 2.0, Vec3::ZERO).unwrap();
        assert!((pose.forward() - Vec3::NEG_Z).length() < 1e-6);
        assert!((pose.up() - Vec3::Y).length() < 1e-6);
    }

    proptest! {
        #[test]
        fn looking_at_puts_the_target_in_the_middle(
            x in -4.0f32..4.0, y in -4.0f32..4.0, z in -4.0f32..4.0,
        ) {
            let eye = Vec3::new(x, y, z);
            prop_assume!(eye.length() > 0.1);
            let pose = Pose::looking_at(eye, Vec3::ZERO).unwrap();
            let seen = pose.camera_from_world(Vec3::ZERO);
            prop_assert!(seen.x.abs() < 1e-5 && seen.y.abs() < 1e-5);
            prop_assert!((seen.z + eye.length()).abs() < 1e-5);
        }

        #[test]
        fn rows_and_back_is_the_same_pose(x in -4.0f32..4.0, y in -4.0f32..4.0, z in 0.2f32..4.0) {
            let pose = Pose::looking_at(Vec3::new(x, y, z), Vec3::ZERO).unwrap();
            let again = Pose::try_from_rows(pose.rows()).unwrap();
            prop_assert!(again.rotation().dot(pose.rotation()).abs() > 1.0 - 1e-6);
            prop_assert_eq!(again.position(), pose.position());
        }
    }
}
