//! The picture of the object that the network is trained on, from a photo taken anyhow.
//!
//! Training renders the unit sphere from [`DISTANCE`] in the middle of a square picture of
//! [`FOV_X_RAD`]. A photo shows the object at another distance `d`, through another lens, off the
//! middle, perhaps on its side. The window is what a camera at the same place shows that looks at
//! the centre with its top towards the sky: turning a camera about its own centre only moves pixels
//! about, exactly. Its field of view is such that the object is as large as in training:
//! `tan(half) = tan(FOV_X_RAD / 2) * DISTANCE * radius / d`, so along the optical axis the window's
//! side is `2 f tan(half)` pixels. What remains is perspective: a nearer camera sees less of the
//! object's sides.

use glam::{DMat3, DVec3};
use image::{Rgb, RgbImage, Rgba, RgbaImage};

use super::layout::{Layout, Taken};
use crate::pool::{DISTANCE, FOV_X_RAD};
use crate::render::srgb::{encode, linear};

/// Behind photos that are transparent.
const BACKDROP: u32 = 128;

/// Half the window's width at distance 1.
fn half_width(layout: &Layout, distance: f64) -> f64 {
    f64::from(0.5 * FOV_X_RAD).tan() * f64::from(DISTANCE) * layout.radius / distance
}

/// The window of a photo, and which share of it the photo covers; beyond the photo's edges its
/// nearest pixels are repeated.
///
/// `axes`: right, up and back of the camera that looks at the centre, in the file's coordinates.
pub(super) fn cut(
    photo: &Light,
    camera: &Taken,
    axes: DMat3,
    layout: &Layout,
    side: u32,
) -> (RgbImage, f64) {
    let half = half_width(layout, camera.position.distance(layout.centre));
    // Samples along a pixel's side: about one for each of the photo's pixels.
    let pixels = 2.0 * half * camera.lens.focal[0] / f64::from(side);
    let n = (pixels.ceil() as u32).clamp(2, 8);
    let (mut inside, mut all) = (0u64, 0u64);
    let window = RgbImage::from_fn(side, side, |x, y| {
        let mut sum = [0.0f32; 3];
        for sample in 0..n * n {
            let place = |pixel: u32, part: u32| {
                2.0 * (f64::from(pixel) + (f64::from(part) + 0.5) / f64::from(n)) / f64::from(side)
                    - 1.0
            };
            let (u, v) = (half * place(x, sample % n), half * place(y, sample / n));
            let ray: DVec3 = axes.x_axis * u - axes.y_axis * v - axes.z_axis;
            all += 1;
            let Some([px, py]) = camera.project_direction(ray) else { continue };
            let [w, h] = camera.lens.size;
            inside += u64::from(px >= 0.0 && py >= 0.0 && px < w && py < h);
            for (total, part) in sum.iter_mut().zip(photo.at(px, py)) {
                *total += part;
            }
        }
        let all = (n * n) as f32;
        Rgb(sum.map(|total| encode(total / all)))
    });
    (window, inside as f64 / all as f64)
}

/// A photo in linear light.
pub(super) struct Light {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>, // (height, width)
}

impl Light {
    /// Of a photo in sRGB with straight alpha, over the backdrop; without pixels it is black.
    pub fn of(photo: &RgbaImage) -> Self {
        let pixel = |Rgba([r, g, b, a]): &Rgba<u8>| {
            let (over, under) = (u32::from(*a), u32::from(255 - *a) * BACKDROP);
            [r, g, b].map(|&level| linear(((u32::from(level) * over + under + 127) / 255) as u8))
        };
        let (width, height) = photo.dimensions();
        Self { width, height, pixels: photo.pixels().map(pixel).collect() }
    }

    /// The light at a place between the pixels' centres; beyond the edges, at the nearest pixel.
    fn at(&self, x: f64, y: f64) -> [f32; 3] {
        let last = |size: u32| f64::from(size.saturating_sub(1));
        let (width, height) = (last(self.width), last(self.height));
        let (x, y) = ((x - 0.5).clamp(0.0, width), (y - 0.5).clamp(0.0, height));
        let (left, top) = (x.floor(), y.floor());
        let (s, t) = ((x - left) as f32, (y - top) as f32);
        let pixel = |dx: f64, dy: f64| {
            let (x, y) = ((left + dx).min(width) as usize, (top + dy).min(height) as usize);
            self.pixels.get(y * self.width as usize + x).copied().unwrap_or_default()
        };
        let [a, b, c, d] = [pixel(0.0, 0.0), pixel(1.0, 0.0), pixel(0.0, 1.0), pixel(1.0, 1.0)];
        std::array::from_fn(|i| {
            let (above, below) = (a[i] + (b[i] - a[i]) * s, c[i] + (d[i] - c[i]) * s);
            above + (below - above) * t
        })
    }
}
