//! Writes sample folders without a mesh or a renderer: what `tests/readers` checks, and a report.
//!
//! ```sh
//! cargo run -p vantage-lab --example sample_folders -- OUT
//! ```
//!
//! makes `OUT/trainer` (with a report) and `OUT/synthetic`. The object is a painted ball, drawn by
//! solving one quadratic equation a pixel; views, gains and scores of the report are made up.

use std::path::PathBuf;

use anyhow::{Context, Result};
use image::{Rgba, RgbaImage};
use vantage_core::{Camera, Objective, Pose, Scores, Vec3};
use vantage_lab::export::{self, Capture, Photo, Point, Profile, Staging};
use vantage_lab::record::{
    Curve, Normalise, PlanRecord, PoolRecord, Scoring, Seconds, ViewRecord, matrix_of,
};
use vantage_lab::report::Report;

const RADIUS: f32 = 0.8;

fn main() -> Result<()> {
    let out: PathBuf =
        std::env::args_os().nth(1).context("name a folder to write the samples to")?.into();
    let train = capture(20, 0.0)?;
    let test = capture(3, 0.4)?;
    let staging = Staging::begin(&out.join("trainer"))?;
    export::write_into(staging.path(), Profile::Trainer, &train)?;
    write_report(staging.path(), &train)?;
    staging.commit()?;
    let synthetic = Profile::NerfSynthetic { val: None, test: &test };
    export::write(&out.join("synthetic"), synthetic, &train)?;
    Ok(())
}

/// A report of views that look plausible.
fn write_report(folder: &std::path::Path, capture: &Capture) -> Result<()> {
    let count = capture.photos.len();
    let level = |n: usize, speed: f32| 1.0 - (-speed * n as f32).exp();
    let scores = |n: usize, pace: f32| Scores {
        coverage: level(n, 0.42 * pace),
        geometry: level(n, 0.3 * pace),
        diversity: 0.75 * level(n, 0.2 * pace),
        texture: level(n, 0.25 * pace),
    };
    let reasons = [
        "sees the most surface that no view has seen",
        "sees bends seen too seldom so far",
        "looks from a new direction",
        "sees fine texture seen too seldom so far",
    ];
    let mut views = Vec::new();
    for (index, photo) in capture.photos.iter().enumerate() {
        let choice = (index * index + index / 3) % 4;
        let objective = Objective::ALL[choice];
        let (before, after) = (scores(index, 1.0), scores(index + 1, 1.0));
        views.push(ViewRecord {
            index: 37 * index % 256,
            position: photo.pose.position().to_array(),
            world_from_camera: matrix_of(&photo.pose),
            objective: Some(objective.name().to_owned()),
            reason: reasons[choice].to_owned(),
            gain: after.get(objective) - before.get(objective),
            scores: after,
        });
    }
    let curve = |label: &str, pace: f32, spread: f32| {
        let all = |pace: f32| (0..=count).map(|n| scores(n, pace)).collect::<Vec<_>>();
        let band = |pace| if spread > 0.0 { all(pace) } else { Vec::new() };
        let (low, high) = (band(pace - spread), band(pace + spread));
        Curve { label: label.to_owned(), scores: all(pace), low, high }
    };
    let plan = PlanRecord {
        object: "painted ball".to_owned(),
        scheme: "made up".to_owned(),
        budget: count,
        seed: 7,
        pool_seed: Some(0),
        candidates: 256,
        pool: PoolRecord { space: "sphere".to_owned(), file: None, elevations: None, rings: None },
        scoring: Scoring { reading: "default".to_owned(), resolution: 256, object_seed: 0 },
        start: None,
        movement_cost: 0.0,
        stop: None,
        normalise: Normalise {
            world_from_object: matrix_of(&Pose::looking_at(Vec3::X, Vec3::ZERO)?),
        },
        tour: (0..count).collect(),
        exact: Some(scores(count, 1.0)),
        smoothed: Some(scores(count, 1.0).smoothed()),
        seconds: Seconds { load: 0.02, label: 3.1, plan: 0.4, write: 1.2 },
        views,
    };
    let photos: Vec<RgbaImage> = capture.photos.iter().map(|photo| photo.image.clone()).collect();
    let candidates: Vec<Vec3> = spiral(256, 0.7).map(|direction| direction * 3.2).collect();
    Report {
        plan: &plan,
        photos: &photos,
        candidates: &candidates,
        curves: &[curve("made up", 1.0, 0.0), curve("random", 0.6, 0.2), curve("fps", 0.8, 0.0)],
        profile: Profile::Trainer,
        folder: "out/ball",
        command: "cargo run -p vantage-lab --example sample_folders -- out",
    }
    .write(folder)
}

/// `count` photos of the ball from a spiral about it, the first one turned by `start_rad`.
fn capture(count: usize, start_rad: f32) -> Result<Capture> {
    let camera = Camera::from_fov(200, 200, 0.62)?;
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
    if (column + row).is_multiple_of(2) {
        [230, 60 + 20 * row, 40 + 20 * column]
    } else {
        [40 + 20 * row, 120, 90 + 20 * column]
    }
}
