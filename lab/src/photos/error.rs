//! Why photos cannot be planned from: one sentence each, with the frame it is about.

use std::fmt;
use std::path::PathBuf;

/// Why a folder of photos cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum PhotosError {
    /// There is no such folder.
    NoFolder(PathBuf),
    /// The folder has no `transforms.json`.
    NoTransforms(PathBuf),
    /// The file cannot be read: the system's reason.
    Unreadable(PathBuf, String),
    /// The file is not JSON: the parser's reason.
    NotJson(PathBuf, String),
    /// A field is missing at the top of the file.
    NoField(&'static str),
    /// The list of frames is empty.
    NoFrames,
    /// The file's lens model is not a pinhole.
    Lens(String),
    /// Something is wrong with one frame.
    Frame {
        /// Its place in the list, from 1.
        number: usize,
        /// Its `file_path`, where it has one.
        file: String,
        /// What is wrong.
        why: FrameError,
    },
    /// Photos of several sizes share one set of intrinsics.
    MixedSizes {
        /// A photo and its width and height in pixels.
        one: (String, [u32; 2]),
        /// Another, of another size.
        other: (String, [u32; 2]),
    },
    /// None of the photos can be used: how many are listed, and why not the first.
    NoneLeft(usize, String),
    /// The optical axes are (nearly) parallel, so they meet nowhere.
    Parallel(usize),
    /// The cameras' upward directions contradict each other.
    NoUp,
    /// The centre of the object lies outside every photo.
    NotFramed,
    /// One of NeRF's synthetic scenes lacks a list of photos: the folder and the file.
    NoSplit(PathBuf, &'static str),
    /// Something is wrong with a list of photos of that name.
    Split(&'static str, Box<PhotosError>),
    /// A photo that is needed cannot be used: its name and why not.
    Photo(String, String),
    /// Photos that are compared must have one camera.
    ManyCameras,
    /// No photo has a pixel of the object.
    Nothing,
    /// A length or a point given on the command line is of no use: which option.
    BadOption(&'static str),
}

/// What is wrong with one frame.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameError {
    /// A field is missing.
    Missing(&'static str),
    /// A field is not what it should be: what it should be.
    NotA(&'static str, &'static str),
    /// The columns of the rotation have this length instead of 1.
    Scaled(f64),
    /// The columns of the rotation are not at right angles, or of different lengths.
    NotARotation,
    /// The rotation exchanges left and right.
    Mirrored,
    /// The photo's size is not in proportion to the size that the intrinsics are of.
    Size {
        /// Width and height in the file.
        expected: [f64; 2],
        /// Width and height of the photo.
        got: [u32; 2],
    },
}

impl fmt::Display for PhotosError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFolder(path) => write!(f, "there is no folder {}", path.display()),
            Self::NoTransforms(path) => write!(
                f,
                "{} holds no transforms.json: export the capture as nerfstudio, Polycam and \
                 Record3D do, with poses",
                path.display()
            ),
            Self::Unreadable(path, why) => write!(f, "cannot read {} ({why})", path.display()),
            Self::NotJson(path, why) => write!(f, "{} is not JSON: {why}", path.display()),
            Self::NoField(field) => write!(f, "transforms.json has no list `{field}`"),
            Self::NoFrames => f.write_str("transforms.json lists no frames"),
            Self::Lens(model) => write!(
                f,
                "the lens model {model} is not a pinhole: undistort the photos first (nerfstudio \
                 and COLMAP do)"
            ),
            Self::Frame { number, file, why } if file.is_empty() => {
                write!(f, "frame {number} of transforms.json {why}")
            }
            Self::Frame { number, file, why } => {
                write!(f, "frame {number} of transforms.json, {file}, {why}")
            }
            Self::MixedSizes { one: (a, [aw, ah]), other: (b, [bw, bh]) } => write!(
                f,
                "the photos share one set of intrinsics but not one size: {a} has {aw} x {ah} \
                 pixels and {b} has {bw} x {bh}; give each frame its own fl_x, cx, cy, w and h"
            ),
            Self::NoneLeft(listed, why) => {
                write!(f, "none of the {listed} photos listed can be used; the first: {why}")
            }
            Self::Parallel(photos) => write!(
                f,
                "the optical axes of {photos} {} meet nowhere (they are parallel to about a \
                 degree): take photos from other sides, or give --centre X,Y,Z",
                if *photos == 1 { "photo" } else { "photos" }
            ),
            Self::NoUp => f.write_str(
                "the photos do not agree on which way is up: give the upward direction as \
                 --up X,Y,Z in the coordinates of transforms.json",
            ),
            Self::NotFramed => f.write_str(
                "the point that the cameras look at lies outside every photo: give the object's \
                 place as --centre X,Y,Z and --radius R in the coordinates of transforms.json",
            ),
            Self::NoSplit(folder, file) => write!(
                f,
                "{} holds no {file}: scenes like NeRF's synthetic ones have transforms_train.json and \
                 transforms_test.json",
                folder.display()
            ),
            // The others name the file that captures have.
            Self::Split(file, why) => {
                f.write_str(&why.to_string().replace("transforms.json", file))
            }
            Self::Photo(file, why) => write!(f, "the photo {file} cannot be used: {why}"),
            Self::ManyCameras => f.write_str(
                "the photos are of more than one camera: give all one size and one camera_angle_x",
            ),
            Self::Nothing => {
                f.write_str("the photos to train on show nothing: all their pixels are transparent")
            }
            Self::BadOption(option) => write!(f, "{option} must be finite and not zero"),
        }
    }
}

impl std::error::Error for PhotosError {}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(field) => write!(f, "has no `{field}`, nor has the top of the file"),
            Self::NotA(field, what) => write!(f, "has a `{field}` that is not {what}"),
            Self::Scaled(length) => write!(
                f,
                "has a `transform_matrix` scaled by {length:.4}: its rotation must have columns of \
                 length 1 (scale positions only)"
            ),
            Self::NotARotation => {
                f.write_str("has a `transform_matrix` that is no rotation: it shears or stretches")
            }
            Self::Mirrored => f.write_str(
                "has a `transform_matrix` that mirrors: its columns are not right-handed",
            ),
            Self::Size { expected: [ew, eh], got: [w, h] } => {
                write!(f, "has {w} x {h} pixels where the intrinsics are of {ew} x {eh}")?;
                let sideways = (f64::from(*w) * ew - f64::from(*h) * eh).abs() < 2.0 * ew;
                f.write_str(if sideways { ": is it stored sideways?" } else { "" })
            }
        }
    }
}
