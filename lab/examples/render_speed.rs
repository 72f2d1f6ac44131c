//! Measures pictures a second after checking what they show.
//!
//! `cargo run --release -p vantage-lab --example render_speed [-- triangles views side]`

use std::time::Instant;

use anyhow::{Result, ensure};
use rayon::prelude::*;
use vantage_core::{Camera, Pose, Vec3};
use vantage_lab::mesh;
use vantage_lab::render::{NO_FACE, PhotoOptions, Renderer};

fn main() -> Result<()> {
    let numbers: Vec<usize> = std::env::args().skip(1).flat_map(|word| word.parse()).collect();
    let triangles = numbers.first().copied().unwrap_or(100_000);
    let count = numbers.get(1).copied().unwrap_or(100);
    let side = numbers.get(2).copied().unwrap_or(256) as u32;
    let mut blob = mesh::noisy_blob(triangles, 1);
    mesh::normalise(&mut blob);
    let camera = Camera::from_fov(side, side, 0.8)?;
    let poses: Vec<Pose> = spread(count)
        .into_iter()
        .map(|direction| Pose::looking_at(direction * 2.8, Vec3::ZERO))
        .collect::<Result<_, _>>()?;
    let start = Instant::now();
    let renderer = Renderer::new(&blob);
    println!("{} triangles, prepared in {:.3} s", blob.faces.len(), start.elapsed().as_secs_f64());
    check(&renderer, &blob, &camera, &poses[0])?;

    let threads = rayon::current_num_threads();
    let report = |what: &str, run: &dyn Fn()| {
        run();
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let start = Instant::now();
            run();
            best = best.min(start.elapsed().as_secs_f64());
        }
        println!(
            "{what}: {best:.3} s for {count} views of {side} x {side} on {threads} threads, best of 5"
        );
    };
    report("face ids", &|| {
        std::hint::black_box(renderer.faces_of_all(&camera, &poses));
    });
    report("labelled views", &|| {
        poses.par_iter().for_each(|pose| {
            std::hint::black_box(renderer.labelled(&camera, pose));
        });
    });
    report("photos, 3 x 3 samples", &|| {
        poses.par_iter().for_each(|pose| {
            std::hint::black_box(renderer.photo(&camera, pose, &PhotoOptions::default()));
        });
    });
    Ok(())
}

/// The face at a pixel must be the nearest one that the ray through the pixel's centre meets.
fn check(renderer: &Renderer, mesh: &mesh::Mesh, camera: &Camera, pose: &Pose) -> Result<()> {
    let image = renderer.faces(camera, pose);
    let (mut compared, mut different) = (0, 0);
    for pixel in (0..image.faces.len()).step_by(image.faces.len() / 200 + 1) {
        let (x, y) = (pixel as u32 % camera.width, pixel as u32 / camera.width);
        let right = (x as f32 + 0.5 - camera.cx) / camera.fx;
        let up = (camera.cy - y as f32 - 0.5) / camera.fy;
        let ray = pose.forward() + pose.right() * right + pose.up() * up;
        let nearest = (0..mesh.faces.len())
            .filter_map(|face| Some((hit(mesh.corners(face), pose.position(), ray)?, face as u32)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        compared += 1;
        different += usize::from(nearest.map_or(NO_FACE, |(_, f)| f) != image.faces[pixel]);
    }
    // Vertices are rounded to 1/256 pixel, so a ray beside an edge may meet the neighbour.
    println!("{different} of {compared} pixels differ from rays");
    ensure!(different * 20 <= compared, "the picture is wrong");
    Ok(())
}

/// Where a ray meets a triangle (Möller and Trumbore, 1997), in double precision.
fn hit(corners: [Vec3; 3], eye: Vec3, ray: Vec3) -> Option<f64> {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let (eye, ray) = (eye.as_dvec3(), ray.as_dvec3());
    let (p, q) = (b - a, c - a);
    let across = ray.cross(q);
    let scale = 1.0 / p.dot(across);
    let from = eye - a;
    let u = from.dot(across) * scale;
    let v = ray.dot(from.cross(p)) * scale;
    let t = q.dot(from.cross(p)) * scale;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// Directions spread evenly over the sphere (a Fibonacci lattice).
fn spread(count: usize) -> Vec<Vec3> {
    let direction = |i: usize| {
        let z = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        Vec3::new(ring * cos, ring * sin, z)
    };
    (0..count).map(direction).collect()
}
