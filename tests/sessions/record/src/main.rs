//! Records the captures of `tests/sessions/golden` into a folder: `record-sessions <folder>`.
//! `cargo xtask golden` runs it. Every number comes from fixed seeds, so the bytes are always the same.

use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context, Result};
use golden_sessions::{Entry, Header, Mishap, PIXELS, Recording, SCHEMES};
use rand_core::Rng;
use rand_pcg::Pcg32;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::Stop;
use vantage_core::soarnet::{Pixels, SIDE};
use vantage_core::{Camera, Pose, Vec3};
use vantage_lab::mesh;
use vantage_lab::pool::{DISTANCE, FOV_X_RAD};
use vantage_lab::render::{PhotoOptions, Renderer};

/// Behind the object, sRGB.
const BACKGROUND: [u8; 3] = [128; 3];

/// How far from its place a camera comes to rest, and how far beside the centre it looks, metres.
const SLACK_M: f32 = 0.04;

/// Of how many candidates one is blocked, one is missed at first and one lands elsewhere.
const MISHAP_EVERY: u32 = 9;

/// A capture to record.
struct Take {
    object: &'static str,
    object_seed: u64,
    space: ViewSpace,
    header: Header,
}

fn takes() -> [Take; 2] {
    let frame = Header {
        candidates: 64,
        width: SIDE as u16,
        height: SIDE as u16,
        pixels: Pixels::Rgb565,
        scheme: 0, // the ensemble
        budget: 30,
        seed: 9,
        movement_cost: 0.2,
        stop: Stop { gain: 0.0, patience: 0 },
        snapshot_after: 11,
        centre: Vec3::ZERO,
    };
    [
        Take {
            object: "chair",
            object_seed: 3,
            space: ViewSpace::Hemisphere { min_elevation_rad: 0.1, max_elevation_rad: 1.4 },
            header: frame,
        },
        Take {
            object: "vase",
            object_seed: 5,
            space: ViewSpace::Rings { rings: 3, min_elevation_rad: -0.1, max_elevation_rad: 1.0 },
            header: Header {
                candidates: 24,
                pixels: Pixels::Rgb888,
                scheme: 1, // the sum
                budget: 16,
                seed: 5,
                movement_cost: 0.0,
                stop: Stop { gain: 0.01, patience: 3 },
                snapshot_after: 4,
                centre: Vec3::new(0.3, -0.2, 0.5),
                ..frame
            },
        },
    ]
}

fn main() -> Result<()> {
    let folder: PathBuf = env::args_os().nth(1).context("name the folder to record into")?.into();
    for take in takes() {
        let path = folder.join(take.object).with_extension("recording");
        fs::write(&path, record(&take)?)
            .with_context(|| format!("{} could not be written", Path::new(&path).display()))?;
    }
    Ok(())
}

/// The bytes of a recording.
fn record(take: &Take) -> Result<Vec<u8>> {
    let Header { candidates, width, height, pixels, scheme, centre, .. } = take.header;
    anyhow::ensure!(usize::from(scheme) < SCHEMES.len() && PIXELS.contains(&pixels));
    let mut object = mesh::builtin(take.object, take.object_seed).context("no such object")?;
    mesh::normalise(&mut object);
    for position in &mut object.positions {
        *position += centre;
    }
    let renderer = Renderer::new(&object);
    let camera = Camera::from_fov(width.into(), height.into(), FOV_X_RAD)?;
    let options = PhotoOptions { background: Some(BACKGROUND), ..PhotoOptions::default() };
    let pool = Pool::try_new(take.space, candidates.into(), DISTANCE)?.with_target(centre)?;
    let mut chance = Pcg32::new(take.header.seed, 11);

    let mut bytes = take.header.to_bytes().to_vec();
    for candidate in pool.iter() {
        let mishap = match chance.next_u32() % MISHAP_EVERY {
            0 => Mishap::Blocked,
            1 => Mishap::Missed,
            2 => Mishap::Elsewhere,
            _ => Mishap::None,
        };
        let mut slack = || {
            let part = (chance.next_u32() >> 8) as f32 / (1 << 23) as f32 - 1.0;
            part * SLACK_M
        };
        let [beside, aim] = [(); 2].map(|()| Vec3::new(slack(), slack(), slack()));
        let eye = candidate.position() - centre;
        let eye = if mishap == Mishap::Elsewhere {
            // A good step on around the object, and nearer to it.
            0.9 * (eye + 0.4 * DISTANCE * candidate.right()).normalize() * DISTANCE
        } else {
            eye
        };
        let reached = Pose::looking_at(centre + eye + beside, centre + aim)?;
        let photo = renderer.photo(&camera, &reached, &options);
        let frame: Vec<u8> = photo.pixels().flat_map(|pixel| packed(pixels, pixel.0)).collect();
        let (candidate, reached) = (settled(candidate)?, settled(reached)?);
        let entry = Entry { mishap, candidate, reached, frame: &frame };
        bytes.extend(entry.to_bytes());
        bytes.extend(&frame);
    }
    Recording::parse(&bytes)?;
    Ok(bytes)
}

/// The pose whose rotation stays as it is when it is brought to unit length again, as readers do.
fn settled(mut pose: Pose) -> Result<Pose> {
    for _ in 0..16 {
        let again = Pose::try_new(pose.position(), pose.rotation())?;
        if again == pose {
            return Ok(pose);
        }
        pose = again;
    }
    anyhow::bail!("the rotation {} does not settle", pose.rotation())
}

/// A pixel's bytes.
fn packed(pixels: Pixels, [red, green, blue, _]: [u8; 4]) -> Vec<u8> {
    match pixels {
        Pixels::Rgb888 => vec![red, green, blue],
        Pixels::Rgba8888 => vec![red, green, blue, 255],
        Pixels::Luma8 => vec![green],
        Pixels::Rgb565 => {
            let [red, green, blue] = [red >> 3, green >> 2, blue >> 3].map(u16::from);
            (red << 11 | green << 5 | blue).to_le_bytes().to_vec()
        }
    }
}
