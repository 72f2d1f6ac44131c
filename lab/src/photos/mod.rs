//! A capture in progress: a folder of photos with `transforms.json`, made ready to plan from.
//!
//! Read are the files that nerfstudio writes and the exports it makes of Polycam and Record3D
//! captures (nerfstudio, *Data conventions*; `process_data/polycam_utils.py`,
//! `process_data/record3d_utils.py`), instant-ngp's (`scripts/colmap2nerf.py`) and those of NeRF's
//! synthetic scenes (Mildenhall et al., 2020):
//!
//! ```text
//! fl_x, fl_y, cx, cy, w, h   in pixels, at the top or in each frame; a frame's own win
//! camera_angle_x             instead of fl_x; without fl_y pixels are square, without cx the
//!                            middle is meant, without w and h the photo's size
//! frames[].file_path         relative to the folder, with or without its extension
//! frames[].transform_matrix  (4, 4), the file's coordinates from the camera's, OpenGL axes
//! applied_transform          noted: poses are taken and given after it, as they stand in the file
//! orientation_override       `none` (Polycam): +Z is up
//! aabb_scale, sharpness …    ignored, as any other key
//! ```
//!
//! Photos are taken as stored, without regard to EXIF orientation, as trainers take them. They may
//! be smaller or larger copies of what the intrinsics describe. Distortion is not corrected; lenses
//! that are no pinhole are refused.
//!
//! A photo that is absent, cannot be decoded, or hardly shows the object is [`Skipped`] and
//! reported; everything else that is wrong is an error, before anything is planned.
//!
//! **Centre:** the point nearest to all optical axes, with little regard to those that pass far off.
//! **Radius:** of the largest sphere there that half of the photos could show whole if they were
//! aimed at it, since people fill their pictures with what they photograph but do not aim exactly.
//! **Up:** the mean of the cameras' upward directions. Each can be
//! [`Known`] instead.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use glam::DVec3;
use image::imageops;
use image::{ImageReader, Limits, RgbImage, RgbaImage};
use rayon::prelude::*;
use vantage_core::{Pose, Vec3};

mod error;
mod layout;
mod scene;
#[cfg(test)]
mod tests;
mod transforms;
mod window;
pub mod words;

pub use error::{FrameError, PhotosError};
pub use layout::{Known, Layout};
pub use scene::{Looked, Scene, View};

use layout::Taken;
use transforms::{Frame, Transforms, places};
use window::Light;

/// Side of the pictures that the network looks at, pixels.
pub const WINDOW: u32 = 64;

/// Side of the pictures that people look at, pixels.
pub const PICTURE: u32 = 232;

/// Photos are made this small at once: the object still has more pixels than are looked at.
const LONGEST_SIDE: u32 = 1024;

/// A photo of which less than this share of the window shows anything hardly shows the object.
const LEAST_SHARE: f64 = 0.25;

/// Photos of an object, and where they were taken from.
#[derive(Clone, Debug)]
pub struct Capture {
    /// The photos that can be used, in the file's order.
    pub photos: Vec<Photo>,
    /// Those that cannot.
    pub skipped: Vec<Skipped>,
    /// Where the object stands.
    pub layout: Layout,
    /// What was read and had no effect, in sentences.
    pub notes: Vec<String>,
}

/// A photo that was taken.
#[derive(Clone, Debug)]
pub struct Photo {
    /// Its place in the file's list, from 1.
    pub number: usize,
    /// As the file names it.
    pub file: String,
    /// Camera centre, in the file's coordinates.
    pub position: DVec3,
    /// From the object to the camera, in the plan's coordinates, unit length.
    pub direction: Vec3,
    /// The camera of the plan that looks from there.
    pub pose: Pose,
    /// What that camera shows, shape (64, 64).
    pub window: RgbImage,
    /// The same, for people.
    pub picture: RgbImage,
}

/// A photo that was not used.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// Its place in the file's list, from 1.
    pub number: usize,
    /// As the file names it.
    pub file: String,
    /// Why not.
    pub why: String,
}

impl Capture {
    /// Reads a folder; `done` is called after each photo with the number of all.
    pub fn open(
        folder: &Path,
        known: &Known,
        done: impl Fn(usize) + Sync,
    ) -> Result<Self, PhotosError> {
        let Transforms { frames, notes, keeps_z_up } = transforms::read(folder)?;
        let decoded: Vec<_> = frames
            .par_iter()
            .map(|frame| {
                let found = decode(folder, &frame.file);
                done(frames.len());
                found
            })
            .collect();
        let mut skipped = Vec::new();
        let mut usable = Vec::new();
        for (index, (frame, found)) in frames.iter().zip(decoded).enumerate() {
            let (number, file) = (index + 1, frame.file.clone());
            match found {
                Ok(decoded) => usable.push((number, frame, decoded)),
                Err(why) => skipped.push(Skipped { number, file, why }),
            }
        }
        let none_left = |skipped: &[Skipped]| {
            let first = skipped.first().map(|first| format!("{}, {}", first.file, first.why));
            PhotosError::NoneLeft(frames.len(), first.unwrap_or_default())
        };
        if usable.is_empty() {
            return Err(none_left(&skipped));
        }
        check_sizes(&usable)?;
        let cameras: Vec<Taken> = usable.iter().map(taken).collect::<Result<_, _>>()?;
        let layout = Layout::of(&cameras, known, keeps_z_up)?;

        let looked_at: Vec<_> = usable
            .par_iter()
            .zip(&cameras)
            .map(|(usable, camera)| photo(usable, camera, &layout))
            .collect();
        let mut photos = Vec::new();
        for ((number, frame, _), found) in usable.iter().zip(looked_at) {
            match found {
                Ok(photo) => photos.push(photo),
                Err(why) => {
                    skipped.push(Skipped { number: *number, file: frame.file.clone(), why })
                }
            }
        }
        skipped.sort_by_key(|skipped| skipped.number);
        if photos.is_empty() {
            return Err(none_left(&skipped));
        }
        Ok(Self { photos, skipped, layout, notes })
    }
}

/// A photo in memory, made smaller.
struct Decoded {
    size: [u32; 2], // as stored
    small: RgbaImage,
}

type Usable<'a> = (usize, &'a Frame, Decoded);

fn decode(folder: &Path, file: &str) -> Result<Decoded, String> {
    let places = places(folder, file);
    let path = places
        .iter()
        .find(|path| path.is_file())
        .ok_or_else(|| "there is no such file".to_owned())?;
    let bytes = fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
    let cannot = |why: String| format!("cannot be decoded: {why}");
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| cannot(error.to_string()))?;
    if reader.format().is_none() {
        return Err(cannot("it is neither PNG nor JPEG".to_owned()));
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(32_768);
    limits.max_image_height = Some(32_768);
    limits.max_alloc = Some(1 << 30);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| cannot(error.to_string()))?;
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err(cannot("it has no pixels".to_owned()));
    }
    let image = image.into_rgba8();
    let longest = width.max(height);
    let small = if longest > LONGEST_SIDE {
        let to = |side: u32| {
            let scaled = u64::from(side) * u64::from(LONGEST_SIDE) / u64::from(longest);
            (scaled as u32).max(1)
        };
        imageops::thumbnail(&image, to(width), to(height))
    } else {
        image
    };
    Ok(Decoded { size: [width, height], small })
}

/// Photos with common intrinsics must have one size.
fn check_sizes(usable: &[Usable<'_>]) -> Result<(), PhotosError> {
    let mut sharing = usable.iter().filter(|(_, frame, _)| !frame.own_intrinsics);
    let Some((_, first, Decoded { size, .. })) = sharing.next() else { return Ok(()) };
    match sharing.find(|(_, _, other)| other.size != *size) {
        None => Ok(()),
        Some((_, frame, other)) => Err(PhotosError::MixedSizes {
            one: (first.file.clone(), *size),
            other: (frame.file.clone(), other.size),
        }),
    }
}

/// The camera of a photo, in pixels of the small copy.
fn taken((number, frame, decoded): &Usable<'_>) -> Result<Taken, PhotosError> {
    let mut lens = frame.intrinsics.of_photo(decoded.size).map_err(|why| PhotosError::Frame {
        number: *number,
        file: frame.file.clone(),
        why,
    })?;
    let small = [decoded.small.width(), decoded.small.height()].map(f64::from);
    for (axis, side) in small.into_iter().enumerate() {
        let scale = side / lens.size[axis];
        lens.focal[axis] *= scale;
        lens.centre[axis] *= scale;
    }
    lens.size = small;
    Ok(Taken { position: frame.position, rotation: frame.rotation, lens })
}

/// What a photo shows of the object, or why it shows nothing of it.
fn photo(
    (number, frame, decoded): &Usable<'_>,
    camera: &Taken,
    layout: &Layout,
) -> Result<Photo, String> {
    let direction = layout
        .direction(camera.position)
        .ok_or_else(|| "it was taken from the object's very middle".to_owned())?;
    let pose = layout.looking_from(direction).map_err(|error| error.to_string())?;
    if camera.project(layout.centre).is_none() {
        return Err("it looks away from the object".to_owned());
    }
    let (_, axes) = layout.in_file(&pose);
    let light = Light::of(&decoded.small);
    let (window, share) = window::cut(&light, camera, axes, layout, WINDOW);
    if share < LEAST_SHARE {
        return Err(format!("it hardly shows the object: {:.0} % of its sphere", 100.0 * share));
    }
    let (picture, _) = window::cut(&light, camera, axes, layout, PICTURE);
    Ok(Photo {
        number: *number,
        file: frame.file.clone(),
        position: camera.position,
        direction,
        pose,
        window,
        picture,
    })
}
