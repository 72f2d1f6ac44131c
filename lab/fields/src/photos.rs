//! Photos with known poses, as rays and colours.

use anyhow::{Result, ensure};
use image::RgbaImage;
use rayon::prelude::*;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::{Camera, Pose, Vec3};
use vantage_lab::pool::DISTANCE;
use vantage_lab::render::{PhotoOptions, Renderer};

/// The colour behind the object, where photos and renders are compared: white, as in the synthetic
/// scenes of NeRF (Mildenhall et al., 2020).
pub const BACKGROUND: [f32; 3] = [1.0; 3];

/// From the highest to the lowest of the test views' elevations and back: degrees.
const TEST_TILT_DEG: f32 = 45.0;

/// A half-line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// World, metres.
    pub origin: Vec3,
    /// Unit length.
    pub direction: Vec3,
}

impl Ray {
    /// Through the centre of a pixel.
    pub fn through(camera: &Camera, pose: &Pose, x: u32, y: u32) -> Self {
        let right = (x as f32 + 0.5 - camera.cx) / camera.fx;
        let up = -(y as f32 + 0.5 - camera.cy) / camera.fy;
        let direction = pose.forward() + pose.right() * right + pose.up() * up;
        Self { origin: pose.position(), direction: direction.normalize() }
    }

    /// Distances at which it enters and leaves the unit sphere; `None` where it misses it.
    pub fn within_unit_sphere(&self) -> Option<[f32; 2]> {
        let nearest = -self.origin.dot(self.direction);
        let off = self.origin + self.direction * nearest;
        let half = (1.0 - off.length_squared()).max(0.0).sqrt();
        (half > 0.0 && nearest + half > 0.0).then(|| [(nearest - half).max(0.0), nearest + half])
    }
}

/// A picture as numbers: sRGB in [0, 1], row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// In pixels.
    pub width: usize,
    /// Shape (height, width).
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A photo with straight alpha on the background. It is mixed in sRGB, as readers of NeRF's
    /// synthetic scenes mix, not in linear light.
    pub fn on_background(photo: &RgbaImage) -> Self {
        let mixed = |rgba: &[u8]| {
            let alpha = f32::from(rgba[3]) / 255.0;
            let mix = |c: usize| f32::from(rgba[c]) / 255.0 * alpha + BACKGROUND[c] * (1.0 - alpha);
            [mix(0), mix(1), mix(2)]
        };
        let pixels = photo.as_raw().chunks_exact(4).map(mixed).collect();
        Self { width: photo.width() as usize, pixels }
    }

    /// A square picture at a smaller side: every pixel is the mean of what it covers.
    pub fn smaller(&self, side: usize) -> Self {
        let scale = self.width as f32 / side as f32;
        // Along one axis: which pixels a new one covers, and how much of each.
        let covered: Vec<Vec<(usize, f32)>> = (0..side)
            .map(|new| {
                let (low, high) = (new as f32 * scale, (new + 1) as f32 * scale);
                let last = (high.ceil() as usize).min(self.width);
                let share = |old: usize| high.min(old as f32 + 1.0) - low.max(old as f32);
                (low as usize..last).map(|old| (old, share(old) / scale)).collect()
            })
            .collect();
        let pixel = |place: usize| {
            let mut sum = [0.0; 3];
            for &(y, tall) in &covered[place / side] {
                for &(x, wide) in &covered[place % side] {
                    let old = self.pixels[y * self.width + x];
                    sum = std::array::from_fn(|c| sum[c] + tall * wide * old[c]);
                }
            }
            sum
        };
        Self { width: side, pixels: (0..side * side).map(pixel).collect() }
    }

    /// In 8 bits.
    pub fn to_image(&self) -> image::RgbImage {
        let level = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let height = self.pixels.len() / self.width.max(1);
        image::RgbImage::from_fn(self.width as u32, height as u32, |x, y| {
            image::Rgb(self.pixels[y as usize * self.width + x as usize].map(level))
        })
    }
}

/// Photos of one camera.
#[derive(Clone, Debug)]
pub struct Photos {
    /// That of all of them.
    pub camera: Camera,
    /// World from camera; shape (photos).
    pub poses: Vec<Pose>,
    /// Shape (photos).
    pub pictures: Vec<Picture>,
}

impl Photos {
    /// Photos of a mesh, nine samples a pixel.
    pub fn of_mesh(renderer: &Renderer, camera: Camera, poses: Vec<Pose>) -> Self {
        let options = PhotoOptions::default();
        let photo = |pose: &Pose| Picture::on_background(&renderer.photo(&camera, pose, &options));
        let pictures = poses.par_iter().map(photo).collect();
        Self { camera, poses, pictures }
    }

    /// Every ray that meets the unit sphere, with the colour that was seen along it.
    pub fn rays(&self) -> Vec<(Ray, [f32; 3])> {
        let of_photo = |(pose, picture): (&Pose, &Picture)| {
            rays_of(&self.camera, pose)
                .into_iter()
                .zip(picture.pixels.iter().copied())
                .filter(|(ray, _)| ray.within_unit_sphere().is_some())
                .collect::<Vec<_>>()
        };
        self.poses.iter().zip(&self.pictures).flat_map(of_photo).collect()
    }
}

/// The rays of all pixels, row by row.
pub fn rays_of(camera: &Camera, pose: &Pose) -> Vec<Ray> {
    let row = |y: u32| (0..camera.width).map(move |x| (x, y));
    (0..camera.height).flat_map(row).map(|(x, y)| Ray::through(camera, pose, x, y)).collect()
}

/// Test views: a circle around the object, tilted by 45 degrees, so that it rises and sinks smoothly
/// and sees the object from above and from below.
pub fn test_circle(count: usize) -> Result<Vec<Pose>> {
    ensure!((1..=200).contains(&count), "there are 1 to 200 test views, not {count}");
    let tilt = TEST_TILT_DEG.to_radians();
    let pose = |index: usize| {
        let turn = std::f32::consts::TAU * index as f32 / count as f32;
        let eye = Vec3::new(turn.cos() * tilt.cos(), turn.sin(), turn.cos() * tilt.sin());
        Ok(Pose::looking_at(eye * DISTANCE, Vec3::ZERO)?)
    };
    (0..count).map(pose).collect()
}

/// Test views where nobody gets above or below two elevations in degrees: once around the object, three
/// times up and down between them.
pub fn test_wave(count: usize, [low, high]: [f32; 2]) -> Result<Vec<Pose>> {
    ensure!((1..=200).contains(&count), "there are 1 to 200 test views, not {count}");
    let pose = |index: usize| {
        let turn = std::f32::consts::TAU * index as f32 / count as f32;
        let elevation = 0.5 * (low + high) + 0.5 * (high - low) * (3.0 * turn).sin();
        let (sin, cos) = elevation.to_radians().sin_cos();
        let eye = Vec3::new(turn.cos() * cos, turn.sin() * cos, sin);
        Ok(Pose::looking_at(eye * DISTANCE, Vec3::ZERO)?)
    };
    (0..count).map(pose).collect()
}

/// Views spread evenly over the sphere: what a field can do that has seen everything.
pub fn dense_views(count: usize) -> Result<Vec<Pose>> {
    Ok(Pool::try_new(ViewSpace::FibonacciSphere, count, DISTANCE)?.iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_goes_through_the_point_that_its_pixel_shows() {
        let camera = Camera::from_fov(40, 30, 0.7).unwrap();
        let pose = Pose::looking_at(Vec3::new(2.0, -1.5, 1.0), Vec3::new(0.1, 0.0, 0.2)).unwrap();
        let ray = Ray::through(&camera, &pose, 7, 21);
        let on_ray = ray.origin + ray.direction * 2.3;
        let pixel = camera.project(pose.camera_from_world(on_ray)).unwrap();
        assert!((pixel.x - 7.5).abs() < 1e-4 && (pixel.y - 21.5).abs() < 1e-4, "{pixel}");
    }

    #[test]
    fn a_ray_is_cut_by_the_unit_sphere() {
        let ray = Ray { origin: Vec3::new(3.0, 0.6, 0.0), direction: Vec3::NEG_X };
        let [near, far] = ray.within_unit_sphere().unwrap();
        assert!((near - 2.2).abs() < 1e-5 && (far - 3.8).abs() < 1e-5);
        assert_eq!(Ray { direction: Vec3::X, ..ray }.within_unit_sphere(), None);
        assert_eq!(Ray { direction: Vec3::Y, ..ray }.within_unit_sphere(), None);
        let inside = Ray { origin: Vec3::ZERO, direction: Vec3::Z };
        assert_eq!(inside.within_unit_sphere(), Some([0.0, 1.0]));
    }

    #[test]
    fn test_views_look_at_the_object_from_one_distance() {
        let poses = test_circle(8).unwrap();
        for pose in &poses {
            let position = pose.position();
            assert!((position.length() - DISTANCE).abs() < 1e-4);
            assert!(pose.forward().dot(-position.normalize()) > 0.9999);
        }
        assert!(test_circle(0).is_err() && test_circle(201).is_err());
    }

    #[test]
    fn test_views_of_a_hemisphere_stay_in_it() {
        let poses = test_wave(24, [5.0, 60.0]).unwrap();
        let elevation = |pose: &Pose| (pose.position().z / DISTANCE).asin().to_degrees();
        let (low, high) = poses
            .iter()
            .map(elevation)
            .fold((90.0f32, -90.0f32), |(low, high), at| (low.min(at), high.max(at)));
        assert!((4.9..10.0).contains(&low) && (55.0..60.1).contains(&high), "{low} {high}");
        assert!(test_wave(0, [5.0, 60.0]).is_err());
    }

    #[test]
    fn a_smaller_picture_is_of_means() {
        let pixels: Vec<[f32; 3]> = (0..36).map(|i| [i as f32, (i % 6) as f32, 0.5]).collect();
        let picture = Picture { width: 6, pixels };
        let small = picture.smaller(3);
        assert_eq!(small.pixels[4], [(14.0 + 15.0 + 20.0 + 21.0) / 4.0, 2.5, 0.5]);
        assert_eq!(picture.smaller(6), picture);
        let uneven = picture.smaller(4);
        let mean = |picture: &Picture| {
            picture.pixels.iter().map(|pixel| pixel[0]).sum::<f32>() / picture.pixels.len() as f32
        };
        assert!((mean(&uneven) - mean(&picture)).abs() < 1e-4);
        assert!((uneven.pixels[0][1] - 1.0 / 3.0).abs() < 1e-6); // all of column 0, half of 1
    }

    #[test]
    fn half_covered_pixels_are_half_background() {
        let photo = RgbaImage::from_pixel(1, 1, image::Rgba([0, 51, 255, 0x80]));
        let [r, g, b] = Picture::on_background(&photo).pixels[0];
        let clear = 127.0 / 255.0;
        assert!((r - clear).abs() < 1e-6 && (b - 1.0).abs() < 1e-6);
        assert!((g - (clear + 0.2 * (1.0 - clear))).abs() < 1e-6);
    }
}
