//! Writes sample folders without a mesh or a renderer: what `tests/readers` checks, and a report.
//!
//! ```sh
//! cargo run -p vantage-lab --example sample_folders -- OUT
//! ```
//!
//! makes `OUT/trainer` and `OUT/synthetic`. The object is a painted ball, drawn by solving one
//! quadratic equation a pixel.

use std::path::PathBuf;

use anyhow::{Context, Result};
use image::{Rgba, RgbaImage};
use vantage_core::{Camera, Pose, Vec3};
use vantage_lab::export::{self, Capture, Photo, Point, Profile};

const RADIUS: f32 = 0.8;

fn main() -> Result<()> {
    let out: PathBuf =
        std::env::args_os().nth(1).context("name a folder to write the samples to")?.into();
    let train = capture(12, 0.0)?;
    let test = capture(3, 0.4)?;
    export::write(&out.join("trainer"), Profile::Trainer, &train)?;
    let synthetic = Profile::NerfSynthetic { val: None, test: &test };
    export::write(&out.join("synthetic"), synthetic, &train)?;
    Ok(())
}

/// `count` photos of the ball from a spiral about it, the first one turned by `start_rad`.
fn capture(count: usize, start_rad: f32) -> Result<Capture> {
    let camera = Camera::from_fov(160, 160, 0.7)?;
    let photos = spiral(count, start_rad).map(|direction| {
        let pose = Pose::looking_at(direction * 3.2, Vec3::ZERO)?;
        Ok(Photo { pose, image: draw(&camera, &pose) })
    });
    let points =
        spiral(400, 0.0).map(|normal| Point { position: normal * RADIUS, colour: paint(normal) });
    Ok(Capture { camera, photos: photos.collect::<Result<_>>()?, points: points.collect() })
}

/// Unit vectors on a golden spiral from the top to the bottom.
fn spiral(count: usize, start_rad: f32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let z = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (start_rad + 2.399_963 * i as f32).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        Vec3::new(ring * cos, ring * sin, z)
    })
}

fn draw(camera: &Camera, pose: &Pose) -> RgbaImage {
    let right = pose.forward().cross(pose.up());
    RgbaImage::from_fn(camera.width, camera.height, |x, y| {
        let across = (x as f32 + 0.5 - camera.cx) / camera.fx;
        let down = (y as f32 + 0.5 - camera.cy) / camera.fy;
        let ray = (pose.forward() + right * across - pose.up() * down).normalize();
        let along = pose.position().dot(ray);
        let inside = along * along - pose.position().length_squared() + RADIUS * RADIUS;
        if inside < 0.0 {
            return Rgba([255, 255, 255, 0]);
        }
        let normal = (pose.position() + ray * (-along - inside.sqrt())) / RADIUS;
        let light = 0.45 + 0.55 * normal.dot(Vec3::new(0.4, 0.3, 0.866)).max(0.0);
        let [r, g, b] = paint(normal).map(|channel| (f32::from(channel) * light) as u8);
        Rgba([r, g, b, 255])
    })
}

/// Eight times eight fields, each of its own colour.
fn paint(normal: Vec3) -> [u8; 3] {
    let column = ((normal.y.atan2(normal.x) / std::f32::consts::TAU + 0.5) * 8.0) as u8;
    let row = ((normal.z * 0.5 + 0.5) * 8.0) as u8;
    if (column + row) % 2 == 0 {
        [230, 60 + 20 * row, 40 + 20 * column]
    } else {
        [40 + 20 * row, 120, 90 + 20 * column]
    }
}
