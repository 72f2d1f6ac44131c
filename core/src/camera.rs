//! Pinhole intrinsics.
//!
//! A pixel's centre lies at half-integer coordinates; the picture's origin is its upper left corner,
//! x to the right and y down. A point `(x, y, z)` in the camera's frame (OpenGL axes, see
//! [`pose`](crate::pose)) falls on `(cx - fx x / z, cy + fy y / z)` where `z < 0`.

use core::fmt;

use glam::{Vec2, Vec3};

use crate::math;

/// A camera without lens distortion: focal lengths and principal point in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Camera {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Horizontal focal length in pixels.
    pub fx: f32,
    /// Vertical focal length in pixels.
    pub fy: f32,
    /// Principal point from the left edge, pixels.
    pub cx: f32,
    /// Principal point from the upper edge, pixels.
    pub cy: f32,
}

/// Why numbers do not make a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraError {
    /// The picture has no pixels.
    Empty,
    /// A focal length is not positive, or a number is not finite.
    BadFocalLength,
    /// The field of view is not between 0 and pi.
    BadFieldOfView,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "the camera's picture has no pixels",
            Self::BadFocalLength => "the camera's focal length must be positive and finite",
            Self::BadFieldOfView => "the camera's field of view must lie between 0 and pi radians",
        })
    }
}

impl core::error::Error for CameraError {}

impl Camera {
    /// A camera from intrinsics in pixels.
    pub fn try_new(
        width: u32,
        height: u32,
        focal: Vec2,
        centre: Vec2,
    ) -> Result<Self, CameraError> {
        if width == 0 || height == 0 {
            return Err(CameraError::Empty);
        }
        if !(focal.x > 0.0 && focal.y > 0.0 && focal.is_finite() && centre.is_finite()) {
            return Err(CameraError::BadFocalLength);
        }
        Ok(Self { width, height, fx: focal.x, fy: focal.y, cx: centre.x, cy: centre.y })
    }

    /// A camera with square pixels and a centred principal point, from its horizontal field of view.
    pub fn from_fov(width: u32, height: u32, fov_x_rad: f32) -> Result<Self, CameraError> {
        if !(fov_x_rad > 0.0 && fov_x_rad < core::f32::consts::PI) {
            return Err(CameraError::BadFieldOfView);
        }
        let focal = 0.5 * width as f32 / math::tan(0.5 * fov_x_rad);
        let centre = Vec2::new(0.5 * width as f32, 0.5 * height as f32);
        Self::try_new(width, height, Vec2::splat(focal), centre)
    }

    /// The horizontal field of view in radians, for a centred principal point.
    pub fn fov_x_rad(&self) -> f32 {
        2.0 * math::atan(0.5 * self.width as f32 / self.fx)
    }

    /// The same field of view at another size in pixels.
    pub fn resized(&self, width: u32, height: u32) -> Result<Self, CameraError> {
        if self.width == 0 || self.height == 0 {
            return Err(CameraError::Empty);
        }
        let scale = Vec2::new(width as f32 / self.width as f32, height as f32 / self.height as f32);
        let focal = Vec2::new(self.fx, self.fy) * scale;
        Self::try_new(width, height, focal, Vec2::new(self.cx, self.cy) * scale)
    }

    /// Where a point in the camera's frame falls, in pixels; `None` behind the camera.
    pub fn project(&self, point_in_camera: Vec3) -> Option<Vec2> {
        let Vec3 { x, y, z } = point_in_camera;
        (z < 0.0).then(|| Vec2::new(self.cx - self.fx * x / z, self.cy + self.fy * y / z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_up_and_right_is_right() {
        let camera = Camera::from_fov(100, 80, 1.0).unwrap();
        let ahead = camera.project(Vec3::NEG_Z).unwrap();
        assert_eq!(ahead, Vec2::new(50.0, 40.0));
        let corner = camera.project(Vec3::new(0.1, 0.1, -1.0)).unwrap();
        assert!(corner.x > 50.0 && corner.y < 40.0);
        assert_eq!(camera.project(Vec3::Z), None);
    }

    #[test]
    fn the_edge_of_the_field_of_view_is_the_edge_of_the_picture() {
        let camera = Camera::from_fov(640, 480, 0.7).unwrap();
        let edge = camera.project(Vec3::new(math::tan(0.35), 0.0, -1.0)).unwrap();
        assert!((edge.x - 640.0).abs() < 1e-3);
        assert!((camera.fov_x_rad() - 0.7).abs() < 1e-6);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        assert_eq!(Camera::from_fov(0, 10, 1.0), Err(CameraError::Empty));
        assert_eq!(Camera::from_fov(10, 10, f32::NAN), Err(CameraError::BadFieldOfView));
        assert_eq!(
            Camera::try_new(4, 4, Vec2::new(-1.0, 1.0), Vec2::ZERO),
            Err(CameraError::BadFocalLength)
        );
    }
}
