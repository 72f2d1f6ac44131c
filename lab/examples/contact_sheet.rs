//! A PNG with four views of each object named: files, or built-in objects and those of classes as
//! `name` or `name:seed`.
//!
//! `cargo run --release -p vantage-lab --example contact_sheet -- sheet.png shelf chair:3 fox.glb`

use anyhow::{Context, Result};
use image::{RgbaImage, imageops};
use vantage_core::{Camera, Pose, Vec3};
use vantage_lab::mesh::{self, Mesh};
use vantage_lab::render::{PhotoOptions, Renderer};

const SIDE: u32 = 320;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let out = arguments.next().context("name a PNG to write, then objects")?;
    let names: Vec<String> = arguments.collect();
    let camera = Camera::from_fov(SIDE, SIDE, 0.72)?;
    let options = PhotoOptions { background: Some([236, 238, 240]), ..PhotoOptions::default() };
    let mut sheet = RgbaImage::new(SIDE * 4, SIDE * names.len() as u32);
    for (row, name) in (0..).zip(&names) {
        let mut mesh = object(name)?;
        mesh::normalise(&mut mesh);
        println!("{name}: {} faces, {} materials", mesh.faces.len(), mesh.materials.len());
        let renderer = Renderer::new(&mesh);
        let eyes = [[0.5, -2.8, 0.7], [2.6, -1.0, 1.0], [-1.2, 2.6, 0.6], [0.8, -1.6, 2.3]];
        for (column, eye) in (0..).zip(eyes) {
            let pose = Pose::looking_at(Vec3::from_array(eye), Vec3::ZERO)?;
            let photo = renderer.photo(&camera, &pose, &options);
            imageops::replace(&mut sheet, &photo, column * i64::from(SIDE), row * i64::from(SIDE));
        }
    }
    sheet.save(&out)?;
    Ok(())
}

fn object(name: &str) -> Result<Mesh> {
    let (stem, seed) = name.split_once(':').unwrap_or((name, "0"));
    if let Some(mesh) = seed
        .parse()
        .ok()
        .and_then(|seed| mesh::builtin(stem, seed).or_else(|| mesh::class(stem, seed)))
    {
        return Ok(mesh);
    }
    let loaded = mesh::load(name)?;
    for warning in loaded.warnings {
        println!("{name}: {warning}");
    }
    Ok(loaded.mesh)
}
