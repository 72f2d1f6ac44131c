//! A camera at a pose, in the form that drawing needs.

use vantage_core::{Camera, Pose, Vec3};

use super::MAX_SIDE;

/// Intrinsics in samples and the camera's axes in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub width: u32,
    pub height: u32,
    pub fx: f32,
    pub fy: f32,
    /// Principal point from the picture's middle: small numbers keep their fraction.
    pub offset_x: f32,
    pub offset_y: f32,
    pub eye: Vec3,
    pub right: Vec3,
    pub up: Vec3,
    pub forward: Vec3,
    /// Through the centre of sample (0, 0), and the steps to the next column and row.
    ray_origin: Vec3,
    ray_dx: Vec3,
    ray_dy: Vec3,
}

impl View {
    /// `samples`: how many along each side of a pixel.
    pub fn new(camera: &Camera, pose: &Pose, samples: u32) -> Self {
        let long = u64::from(camera.width.max(camera.height)) * u64::from(samples);
        assert!(long <= u64::from(MAX_SIDE), "a side of {long} samples is over {MAX_SIDE}");
        let n = samples as f32;
        let (width, height) = (camera.width * samples, camera.height * samples);
        let (fx, fy) = (camera.fx * n, camera.fy * n);
        let offset_x = (camera.cx - 0.5 * camera.width as f32) * n;
        let offset_y = (camera.cy - 0.5 * camera.height as f32) * n;
        let [r0, r1, r2] = pose.rows();
        let axis = |i: usize| Vec3::new(r0[i], r1[i], r2[i]);
        let (right, up, forward) = (axis(0), axis(1), -axis(2));
        let (ray_dx, ray_dy) = (right / fx, -up / fy);
        let x = 0.5 - 0.5 * width as f32 - offset_x;
        let y = 0.5 - 0.5 * height as f32 - offset_y;
        let ray_origin = forward + ray_dx * x + ray_dy * y;
        let eye = pose.position();
        Self {
            width,
            height,
            fx,
            fy,
            offset_x,
            offset_y,
            eye,
            right,
            up,
            forward,
            ray_origin,
            ray_dx,
            ray_dy,
        }
    }

    /// From the eye through the centre of a sample, in the world; its part along `forward` is 1.
    #[inline]
    pub fn ray(&self, x: u32, y: u32) -> Vec3 {
        self.ray_origin + self.ray_dx * x as f32 + self.ray_dy * y as f32
    }
}
