//! A film for a fake camera: an object stands on the tag board, a hand leads the camera around it.
//!
//! `cargo run -p vantage-lab --example fake_camera -- FILM.y4m [OBJECT]`
//!
//! Chromium takes the film with `--use-fake-device-for-media-stream
//! --use-file-for-fake-video-capture=FILM.y4m` and plays it again and again. `FILM.json` beside it
//! holds the truth: intrinsics, board, and for each frame its kind and pose (rows of
//! world_from_camera, 12 numbers; the world is the board's frame). Each picture carries the number
//! of its frame: [`STAMP_BITS`] squares of [`STAMP_PX`] pixels from the lower left corner, the lowest
//! bit first, white is 1.
//!
//! The camera stops at many places. Some frames are spoilt on purpose: blurred, dark, bright, and
//! looking away. OBJECT is a built-in object or one of a class, as `name` or `name:seed`.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};
use image::RgbaImage;
use serde_json::json;
use vantage_board::{Board, TAG_CELLS, is_white};
use vantage_core::{Camera, Pose, Vec2, Vec3};
use vantage_lab::mesh::{self, Material, Mesh};
use vantage_lab::render::{PhotoOptions, Renderer};

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;
const FOCAL_PX: f32 = 560.0;
const FPS: u32 = 10;

/// Stops on a ring, and the rings' elevations.
const STOPS: u32 = 12;
const ELEVATIONS_DEG: [f32; 2] = [30.0, 50.0];
const DISTANCE_M: f32 = 0.42;

/// Frames at a stop, and on the way to the next.
const STEADY_FRAMES: u32 = 10;
const MOVING_FRAMES: u32 = 5;

/// Frames spoilt in one way.
const SPOILT_FRAMES: u32 = 5;

/// The share of the time between frames for which the shutter is open.
const EXPOSURE: f32 = 0.1;

/// Pictures averaged over an exposure.
const BLUR_SAMPLES: u32 = 5;

/// Standard deviation of luma.
const NOISE: f32 = 2.0;

const STAMP_BITS: usize = 10;
const STAMP_PX: usize = 8;

/// One frame: how the camera moves while the shutter is open.
struct Shot {
    kind: &'static str,
    from: Stand,
    to: Stand,
    gain: f32, // of linear light
}

/// Where the camera stands: on a sphere around a point that it looks past.
#[derive(Clone, Copy)]
struct Stand {
    azimuth_rad: f32,
    elevation_rad: f32,
    /// From the point above the board's middle that it would look at.
    aside: Vec3,
}

impl Stand {
    fn pose(&self) -> Result<Pose> {
        let (sin, cos) = self.elevation_rad.sin_cos();
        let (y, x) = self.azimuth_rad.sin_cos();
        let middle = Vec3::Z * 0.04;
        let eye = middle + Vec3::new(cos * x, cos * y, sin) * DISTANCE_M;
        Ok(Pose::looking_at(eye, middle + self.aside)?)
    }

    fn between(&self, other: &Self, share: f32) -> Self {
        let mix = |a: f32, b: f32| a + share * (b - a);
        Self {
            azimuth_rad: mix(self.azimuth_rad, other.azimuth_rad),
            elevation_rad: mix(self.elevation_rad, other.elevation_rad),
            aside: self.aside.lerp(other.aside, share),
        }
    }
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let film = arguments.next().context("name a .y4m file to write, then perhaps an object")?;
    let name = arguments.next().unwrap_or_else(|| "vase".to_owned());
    let board = Board::default();
    let scene = scene(&board, &name)?;
    let shots = shots();
    write_truth(Path::new(&film), &board, &name, &shots)?;
    write_film(Path::new(&film), &Renderer::new(&scene), &shots)?;
    println!("{film}: {} frames of {WIDTH} x {HEIGHT}, {FPS} a second", shots.len());
    Ok(())
}

/// The whole film.
fn shots() -> Vec<Shot> {
    let mut shots = Vec::new();
    let stands: Vec<Stand> = ELEVATIONS_DEG
        .into_iter()
        .flat_map(|elevation| (0..STOPS).map(move |stop| (elevation, stop)))
        .map(|(elevation, stop)| Stand {
            azimuth_rad: (-90.0 + 360.0 / STOPS as f32 * stop as f32).to_radians(),
            elevation_rad: elevation.to_radians(),
            aside: Vec3::ZERO,
        })
        .collect();
    for (number, stand) in stands.iter().enumerate() {
        // A hand is never quite still: a tenth of a millimetre or so between frames.
        for frame in 0..STEADY_FRAMES {
            let phase = number as f32 + 0.9 * frame as f32;
            let tremor = Vec3::new(phase.sin(), (1.7 * phase).cos(), (2.3 * phase).sin()) * 3e-4;
            let held = Stand { aside: stand.aside + tremor, ..*stand };
            shots.push(Shot { kind: "steady", from: held, to: held, gain: 1.0 });
        }
        spoil(number, stand, &mut shots);
        let Some(next) = stands.get(number + 1) else { continue };
        let mut next = *next;
        if next.azimuth_rad < stand.azimuth_rad {
            next.azimuth_rad += std::f32::consts::TAU; // on to the next ring
        }
        let eased = |time: f32| time * time * (3.0 - 2.0 * time);
        for frame in 1..=MOVING_FRAMES {
            let at = |share: f32| stand.between(&next, eased(share / (MOVING_FRAMES + 1) as f32));
            let (from, to) = (at(frame as f32 - 0.5 * EXPOSURE), at(frame as f32 + 0.5 * EXPOSURE));
            shots.push(Shot { kind: "moving", from, to, gain: 1.0 });
        }
    }
    shots
}

/// What goes wrong at some stops.
fn spoil(stop: usize, stand: &Stand, shots: &mut Vec<Shot>) {
    let looking = |aside: Vec3| Stand { aside, ..*stand };
    // To the right of someone who looks at the board's middle.
    let (y, x) = stand.azimuth_rad.sin_cos();
    let right = Vec3::new(-y, x, 0.0);
    let (kind, from, to, gain) = match stop {
        2 => ("blurred", looking(right * -0.006), looking(right * 0.006), 1.0),
        5 => ("dark", *stand, *stand, 0.012),
        8 => ("lost", looking(Vec3::Z * 0.6), looking(Vec3::Z * 0.6), 1.0),
        11 => ("bright", *stand, *stand, 8.0),
        _ => return,
    };
    shots.extend((0..SPOILT_FRAMES).map(|_| Shot { kind, from, to, gain }));
}

/// The object on the board on a table.
fn scene(board: &Board, name: &str) -> Result<Mesh> {
    let (stem, seed) = name.split_once(':').unwrap_or((name, "7"));
    let seed = seed.parse().with_context(|| format!("`{seed}` is not a seed"))?;
    let mut scene = mesh::builtin(stem, seed)
        .or_else(|| mesh::class(stem, seed))
        .with_context(|| format!("there is no object `{stem}`"))?;
    mesh::normalise(&mut scene);
    const OBJECT_RADIUS_M: f32 = 0.06;
    let lowest = scene.positions.iter().map(|p| p.z).fold(f32::INFINITY, f32::min);
    for position in &mut scene.positions {
        *position = (*position - Vec3::Z * lowest) * OBJECT_RADIUS_M;
    }
    let first = scene.materials.len() as u16;
    scene.materials.push(Material::plain("paper", [0.75, 0.74, 0.71]));
    scene.materials.push(Material::plain("ink", [0.03, 0.03, 0.035]));
    scene.materials.push(Material::plain("table", [0.20, 0.13, 0.08]));
    let [columns, rows] = [0, 1].map(|axis| lines(board, axis));
    for (row, y) in rows.windows(2).enumerate() {
        for (column, x) in columns.windows(2).enumerate() {
            let ink = is_ink(board, column, row);
            rectangle(&mut scene, [x[0], y[1]], [x[1], y[0]], 0.0, first + u16::from(ink));
        }
    }
    rectangle(&mut scene, [-0.8, -0.8], [0.8, 0.8], -0.002, first + 2);
    Ok(scene)
}

/// Where cells, gaps and margins meet along x, ascending, or along y from the far edge down.
fn lines(board: &Board, axis: usize) -> Vec<f32> {
    const MARGIN_M: f64 = 0.012;
    let spec = board.spec();
    let tags = [spec.columns, spec.rows][axis];
    let half = 0.5 * board.size_m()[axis];
    let mut lines = vec![-half - MARGIN_M];
    for tag in 0..tags {
        let start = -half + f64::from(tag) * (spec.tag_size_m + spec.gap_m);
        let cell = |i: u32| start + spec.tag_size_m * f64::from(i) / f64::from(TAG_CELLS);
        lines.extend((0..=TAG_CELLS).map(cell));
    }
    lines.push(half + MARGIN_M);
    let sign = if axis == 0 { 1.0 } else { -1.0 };
    lines.into_iter().map(|line| (sign * line) as f32).collect()
}

/// Whether a cell between [`lines`] is printed black.
fn is_ink(board: &Board, column: usize, row: usize) -> bool {
    let pitch = TAG_CELLS as usize + 1; // a tag's cells and a gap
    let inside = |i: usize| (!i.is_multiple_of(pitch)).then(|| ((i - 1) / pitch, (i - 1) % pitch));
    let (Some((tag_column, cell_column)), Some((tag_row, cell_row))) =
        (inside(column), inside(row))
    else {
        return false;
    };
    let spec = board.spec();
    let id = spec.first_id + tag_row as u32 * spec.columns + tag_column as u32;
    !is_white(id, cell_row as u32, cell_column as u32)
}

/// A rectangle that looks up.
fn rectangle(mesh: &mut Mesh, low: [f32; 2], high: [f32; 2], z: f32, material: u16) {
    let first = mesh.positions.len() as u32;
    let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
    mesh.positions.extend(corners.map(|[x, y]| Vec3::new(x, y, z)));
    for face in [[0, 1, 2], [0, 2, 3]] {
        mesh.faces.push(face.map(|corner| first + corner));
        mesh.face_material.push(material);
        // Attributes that the object has and this has not.
        if !mesh.uvs.is_empty() {
            mesh.uvs.push([Vec2::ZERO; 3]);
        }
        if !mesh.normals.is_empty() {
            mesh.normals.push([Vec3::Z; 3]);
        }
        if !mesh.colours.is_empty() {
            mesh.colours.push([[1.0; 3]; 3]);
        }
    }
}

fn write_truth(film: &Path, board: &Board, object: &str, shots: &[Shot]) -> Result<()> {
    let spec = board.spec();
    let frames = shots.iter().map(|shot| {
        let pose = shot.from.between(&shot.to, 0.5).pose()?;
        Ok(json!({ "kind": shot.kind, "pose": pose.rows().concat() }))
    });
    let frames = frames.collect::<Result<Vec<_>>>()?;
    let truth = json!({
        "object": object,
        "width": WIDTH, "height": HEIGHT, "fps": FPS,
        "focalPx": FOCAL_PX, "cx": 0.5 * WIDTH as f32, "cy": 0.5 * HEIGHT as f32,
        "board": {
            "columns": spec.columns, "rows": spec.rows, "tagSizeM": spec.tag_size_m,
            "gapM": spec.gap_m, "firstId": spec.first_id,
        },
        "stamp": { "bits": STAMP_BITS, "px": STAMP_PX },
        "frames": frames,
    });
    let file = BufWriter::new(File::create(film.with_extension("json"))?);
    Ok(serde_json::to_writer(file, &truth)?)
}

fn write_film(film: &Path, renderer: &Renderer, shots: &[Shot]) -> Result<()> {
    let centre = Vec2::new(0.5 * WIDTH as f32, 0.5 * HEIGHT as f32);
    let camera = Camera::try_new(WIDTH, HEIGHT, Vec2::splat(FOCAL_PX), centre)?;
    let mut file = BufWriter::new(File::create(film)?);
    writeln!(file, "YUV4MPEG2 W{WIDTH} H{HEIGHT} F{FPS}:1 Ip A1:1 C420jpeg")?;
    for (number, shot) in shots.iter().enumerate() {
        let mut light = expose(renderer, &camera, shot)?;
        for value in &mut light {
            *value *= shot.gain;
        }
        let mut luma_chroma = to_yuv(&light, number as u64);
        stamp(&mut luma_chroma[..(WIDTH * HEIGHT) as usize], number);
        file.write_all(b"FRAME\n")?;
        file.write_all(&luma_chroma)?;
    }
    Ok(file.flush()?)
}

/// Linear light of a frame, the mean over the exposure; shape (height, width, 3).
fn expose(renderer: &Renderer, camera: &Camera, shot: &Shot) -> Result<Vec<f32>> {
    let moves = shot.kind == "moving" || shot.kind == "blurred";
    let (samples, supersampling) = if moves { (BLUR_SAMPLES, 1) } else { (1, 2) };
    let options = PhotoOptions { supersampling, background: Some([150, 160, 170]) };
    let mut light = vec![0.0; (WIDTH * HEIGHT * 3) as usize];
    for sample in 0..samples {
        let share = (sample as f32 + 0.5) / samples as f32;
        let pose = shot.from.between(&shot.to, share).pose()?;
        add_linear(&mut light, &renderer.photo(camera, &pose, &options), 1.0 / samples as f32);
    }
    Ok(light)
}

fn add_linear(light: &mut [f32], photo: &RgbaImage, weight: f32) {
    let table: Vec<f32> = (0..256).map(|v| (v as f32 / 255.0).powf(2.2) * weight).collect();
    for (light, pixel) in light.chunks_exact_mut(3).zip(photo.pixels()) {
        for (light, &value) in light.iter_mut().zip(&pixel.0) {
            *light += table[usize::from(value)];
        }
    }
}

/// Planar 4:2:0 of BT.601, luma 16 to 235, with noise.
fn to_yuv(light: &[f32], seed: u64) -> Vec<u8> {
    /// Steps of linear light; the darkest is half a step of luma.
    const LEVELS: usize = 1 << 16;
    let (width, height) = (WIDTH as usize, HEIGHT as usize);
    let mut random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut uniform = move || {
        // Marsaglia's xorshift.
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 40) as f32 / (1 << 24) as f32 - 0.5
    };
    let table: Vec<f32> =
        (0..=LEVELS).map(|v| (v as f32 / LEVELS as f32).powf(1.0 / 2.2) * 255.0).collect();
    let encode = |value: f32| table[(value.min(1.0) * LEVELS as f32 + 0.5) as usize];
    let rgb: Vec<[f32; 3]> =
        light.chunks_exact(3).map(|p| [encode(p[0]), encode(p[1]), encode(p[2])]).collect();
    let mut planes = Vec::with_capacity(width * height * 3 / 2);
    for [r, g, b] in &rgb {
        // Four uniform numbers have a variance of a third.
        let noise = (uniform() + uniform() + uniform() + uniform()) * 3.0f32.sqrt() * NOISE;
        let luma = 0.299 * r + 0.587 * g + 0.114 * b + noise;
        planes.push((16.0 + luma.clamp(0.0, 255.0) * 219.0 / 255.0 + 0.5) as u8);
    }
    for chroma in [[-0.168_736, -0.331_264, 0.5], [0.5, -0.418_688, -0.081_312]] {
        for y in (0..height).step_by(2) {
            for x in (0..width).step_by(2) {
                let square =
                    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| rgb[(y + j) * width + x + i]);
                let sum: f32 =
                    square.iter().flat_map(|p| p.iter().zip(chroma)).map(|(v, c)| v * c).sum();
                planes.push((128.0 + 0.25 * sum * 224.0 / 255.0 + 0.5) as u8);
            }
        }
    }
    planes
}

/// Writes a frame's number into its lower left corner.
fn stamp(luma: &mut [u8], number: usize) {
    let width = WIDTH as usize;
    for row in luma.chunks_exact_mut(width).rev().take(STAMP_PX) {
        for (bit, square) in row.chunks_exact_mut(STAMP_PX).take(STAMP_BITS).enumerate() {
            square.fill(if number >> bit & 1 == 1 { 235 } else { 16 });
        }
    }
}
