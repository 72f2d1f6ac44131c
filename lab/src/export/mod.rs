//! Photos with known poses, written as folders that radiance-field trainers open as they are.
//!
//! [`Profile::Trainer`] is one folder for nerfstudio, instant-ngp, brush, gsplat, Inria's 3DGS,
//! COLMAP and nerfbaselines:
//!
//! ```text
//! DIR/
//!   images/frame_00001.png …   RGBA, straight alpha, in the order given
//!   transforms.json            world_from_camera, OpenGL camera axes, +Z up
//!   sparse_pc.ply              the points; the only .ply, since brush starts from any it finds
//!   sparse/0/*.txt, *.bin      the same cameras, images and points for COLMAP's readers
//!   nb-info.json               tells nerfbaselines which of its loaders to use
//! ```
//!
//! [`Profile::NerfSynthetic`] is the layout of the Blender scenes of NeRF (Mildenhall et al. 2020):
//!
//! ```text
//! DIR/
//!   transforms_train.json, transforms_val.json, transforms_test.json
//!   train/r_0.png …, val/r_0.png …, test/r_0.png …
//!   nb-info.json               as above
//! ```
//!
//! Further files may stand beside these, with one rule: instant-ngp reads **every** `.json` in the
//! folder and skips those without `frames`. No other file may have a top-level key `frames`, `aabb`,
//! `aabb_scale`, `scale`, `offset`, `up` or `render_aabb`, or end in `.ply`.
//!
//! Poses are converted in double precision from the same normalised quaternion, so the files agree
//! with each other to 1e-12 and with [`Pose::rows`] to 1e-6.
//!
//! ```
//! use vantage_core::{Camera, Pose, Vec3};
//! use vantage_lab::export::{self, Capture, Photo, Profile};
//! # let home = tempfile::tempdir()?;
//! # let dir = home.path().join("cube");
//! let camera = Camera::from_fov(4, 4, 0.7)?;
//! let pose = Pose::looking_at(Vec3::new(3.0, 0.0, 1.0), Vec3::ZERO)?;
//! let photos = vec![Photo { pose, image: image::RgbaImage::new(4, 4) }];
//! export::write(&dir, Profile::Trainer, &Capture { camera, photos, points: vec![] })?;
//! assert!(dir.join("images/frame_00001.png").is_file());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod colmap;
mod error;
mod images;
mod points;
mod staging;
mod transforms;

use std::fs;
use std::path::Path;

use image::RgbaImage;
use vantage_core::{Camera, Pose, Vec3};

pub use error::ExportError;
pub use points::LEAST_POINTS;
pub use staging::Staging;

/// Photos taken with one camera, and points on what they show.
#[derive(Clone, Debug)]
pub struct Capture {
    /// The camera of every photo.
    pub camera: Camera,
    /// The photos, in the order in which they are numbered.
    pub photos: Vec<Photo>,
    /// Points on the surface, world, metres. Fewer than [`LEAST_POINTS`] are padded.
    pub points: Vec<Point>,
}

/// One photo.
#[derive(Clone, Debug)]
pub struct Photo {
    /// `world_from_camera`.
    pub pose: Pose,
    /// Shape (height, width, 4) of the camera, straight (not premultiplied) alpha, sRGB.
    ///
    /// Some readers drop alpha (gsplat): what stands under alpha 0 should be a background.
    pub image: RgbaImage,
}

/// One coloured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position in world, metres.
    pub position: Vec3,
    /// Red, green, blue, sRGB.
    pub colour: [u8; 3],
}

/// Which readers the folder is for.
#[derive(Clone, Copy, Debug)]
pub enum Profile<'a> {
    /// The trainers: one set of photos, from which each trainer holds out what it likes.
    Trainer,
    /// The layout of NeRF's synthetic scenes; the capture written is the training set.
    ///
    /// It names a field of view and nothing else, so pixels must be square and the principal point
    /// central. Readers of it take near and far as 2 and 6: stand between 3 and 5 from the object.
    NerfSynthetic {
        /// Views for validation. Without them `transforms_val.json` lists the frames of `test`
        /// again (under `./test/`, for all to see): nerfstudio needs some, and frames of the
        /// training set would flatter every score.
        val: Option<&'a Capture>,
        /// Views held out for the scores. Needed: Inria's 3DGS does not open a folder without
        /// `transforms_test.json`, and nerfbaselines and instant-ngp stop at an empty list.
        test: &'a Capture,
    },
}

impl Profile<'_> {
    /// Whether this is [`Profile::Trainer`].
    pub const fn is_trainer(&self) -> bool {
        matches!(self, Self::Trainer)
    }
}

/// Writes a whole folder, or nothing: [`Staging::begin`], [`write_into`], [`Staging::commit`].
///
/// `dir` must be missing or an empty folder. Missing parents are made.
pub fn write(dir: &Path, profile: Profile<'_>, capture: &Capture) -> Result<(), ExportError> {
    let staging = Staging::begin(dir)?;
    write_into(staging.path(), profile, capture)?;
    staging.commit()?;
    Ok(())
}

/// Writes the files of a profile into a folder that exists, most often [`Staging::path`].
///
/// Fails on a capture without photos, on a photo of another size than its camera, on points that are
/// not finite, and on a full disk; what was written until then stays.
pub fn write_into(
    folder: &Path,
    profile: Profile<'_>,
    capture: &Capture,
) -> Result<(), ExportError> {
    check(capture)?;
    match profile {
        Profile::Trainer => write_trainer(folder, capture),
        Profile::NerfSynthetic { val, test } => {
            check(test)?;
            val.map_or(Ok(()), check)?;
            write_synthetic(folder, "train", capture)?;
            write_synthetic(folder, "test", test)?;
            save(folder, "nb-info.json", NB_INFO_SYNTHETIC)?;
            match val {
                Some(val) => write_synthetic(folder, "val", val),
                None => save_json(folder, "transforms_val.json", &transforms::split("test", test)?),
            }
        }
    }
}

fn write_trainer(folder: &Path, capture: &Capture) -> Result<(), ExportError> {
    let names: Vec<String> =
        (1..=capture.photos.len()).map(|n| format!("frame_{n:05}.png")).collect();
    let points = points::padded(&capture.points);
    images::write(&folder.join("images"), &names, &capture.photos)?;
    save_json(folder, "transforms.json", &transforms::trainer(capture, &names, &points))?;
    save(folder, "sparse_pc.ply", &points::ply(&points))?;
    colmap::write(&folder.join("sparse").join("0"), capture, &names, &points)?;
    // Without it nerfbaselines finds two formats in one folder and stops.
    save(folder, "nb-info.json", NB_INFO_TRAINER)
}

/// nerfbaselines' own readers of the two layouts. It guesses the first wrongly, the second never.
const NB_INFO_TRAINER: &[u8] = br#"{"loader": "colmap", "type": "object-centric"}
"#;
const NB_INFO_SYNTHETIC: &[u8] = br#"{
  "loader": "nerfbaselines.datasets.blender:load_blender_dataset",
  "type": "object-centric",
  "evaluation_protocol": "nerf"
}
"#;

fn write_synthetic(folder: &Path, split: &str, capture: &Capture) -> Result<(), ExportError> {
    let names: Vec<String> = (0..capture.photos.len()).map(|n| format!("r_{n}.png")).collect();
    let transforms = transforms::split(split, capture)?;
    images::write(&folder.join(split), &names, &capture.photos)?;
    save_json(folder, &format!("transforms_{split}.json"), &transforms)
}

/// What no file can hold is refused before the first one is written.
fn check(capture: &Capture) -> Result<(), ExportError> {
    if capture.photos.is_empty() {
        return Err(ExportError::NoPhotos);
    }
    let expected = (capture.camera.width, capture.camera.height);
    for (index, photo) in capture.photos.iter().enumerate() {
        let got = photo.image.dimensions();
        if got != expected {
            return Err(ExportError::PhotoSize { index, expected, got });
        }
    }
    match capture.points.iter().position(|point| !point.position.is_finite()) {
        Some(index) => Err(ExportError::PointNotFinite { index }),
        None => Ok(()),
    }
}

fn save_json(folder: &Path, name: &str, value: &impl serde::Serialize) -> Result<(), ExportError> {
    let path = folder.join(name);
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| ExportError::io("write", &path, error.into()))?;
    text.push('\n');
    save(folder, name, text.as_bytes())
}

fn save(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), ExportError> {
    let path = folder.join(name);
    fs::write(&path, bytes).map_err(|error| ExportError::io("write", &path, error))
}

fn make_folder(path: &Path) -> Result<(), ExportError> {
    fs::create_dir_all(path).map_err(|error| ExportError::io("create", path, error))
}

#[cfg(test)]
mod tests;
