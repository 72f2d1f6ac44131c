//! `transforms.json`, as the exporters write it.

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3};
use serde_json::Value;

use super::error::{FrameError, PhotosError};

/// One listed photo: not yet looked at.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// As the file names it.
    pub file: String,
    /// Camera centre, in the file's coordinates and units.
    pub position: DVec3,
    /// The file's coordinates from the camera's (OpenGL axes).
    pub rotation: DQuat,
    pub intrinsics: Intrinsics,
    /// Whether the intrinsics are the frame's own.
    pub own_intrinsics: bool,
}

/// What the file says of a lens. Numbers are of `size`, or of the photo where it says none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intrinsics {
    size: Option<[f64; 2]>,
    focal: [Option<f64>; 2],
    /// Fields of view, in radians.
    angle: [Option<f64>; 2],
    centre: [Option<f64>; 2],
}

/// A pinhole in pixels of a photo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lens {
    pub focal: [f64; 2],
    pub centre: [f64; 2],
    pub size: [f64; 2],
}

/// The whole file.
#[derive(Debug)]
pub(super) struct Transforms {
    pub frames: Vec<Frame>,
    /// What was read and has no effect, in sentences.
    pub notes: Vec<String>,
    /// Whether the file says that its +Z is up and shall stay so.
    pub keeps_z_up: bool,
}

/// Reads `transforms.json` of a folder.
pub(super) fn read(folder: &Path) -> Result<Transforms, PhotosError> {
    if !folder.is_dir() {
        return Err(PhotosError::NoFolder(folder.to_owned()));
    }
    let path = folder.join("transforms.json");
    if !path.is_file() {
        return Err(PhotosError::NoTransforms(folder.to_owned()));
    }
    read_file(path)
}

/// Reads a file of that kind, whatever its name.
pub(super) fn read_file(path: PathBuf) -> Result<Transforms, PhotosError> {
    let text = fs::read_to_string(&path)
        .map_err(|error| PhotosError::Unreadable(path.clone(), error.to_string()))?;
    let value: Value = serde_json::from_str(&text)
        .map_err(|error| PhotosError::NotJson(path, error.to_string()))?;
    parse(&value)
}

pub(super) fn parse(top: &Value) -> Result<Transforms, PhotosError> {
    let frames =
        top.get("frames").and_then(Value::as_array).ok_or(PhotosError::NoField("frames"))?;
    if frames.is_empty() {
        return Err(PhotosError::NoFrames);
    }
    let frames: Vec<Frame> = frames
        .iter()
        .enumerate()
        .map(|(index, value)| {
            let file = value.get("file_path").and_then(Value::as_str).unwrap_or_default();
            frame(top, value).map_err(|why| match why {
                Refused::Lens(model) => PhotosError::Lens(model),
                Refused::Frame(why) => {
                    PhotosError::Frame { number: index + 1, file: file.to_owned(), why }
                }
            })
        })
        .collect::<Result<_, _>>()?;

    let mut notes = Vec::new();
    let distorted = |value: &Value| {
        ["k1", "k2", "k3", "k4", "p1", "p2"]
            .iter()
            .any(|key| value.get(key).and_then(Value::as_f64).is_some_and(|k| k != 0.0))
    };
    if distorted(top) || top["frames"].as_array().is_some_and(|all| all.iter().any(distorted)) {
        notes.push(
            "lens distortion is not corrected: it moves little within the 64 pixels looked at"
                .to_owned(),
        );
    }
    if top.get("applied_transform").is_some() || top.get("applied_scale").is_some() {
        notes.push(
            "poses are taken and given as they stand in the file, after its applied_transform"
                .to_owned(),
        );
    }
    // Polycam's exports say so: ARKit's upward axis has become +Z.
    let keeps_z_up = top.get("orientation_override").and_then(Value::as_str) == Some("none");
    if keeps_z_up {
        notes.push("orientation_override is none: +Z is up".to_owned());
    }
    Ok(Transforms { frames, notes, keeps_z_up })
}

/// Why a frame is refused.
enum Refused {
    Lens(String),
    Frame(FrameError),
}

impl From<FrameError> for Refused {
    fn from(why: FrameError) -> Self {
        Self::Frame(why)
    }
}

fn frame(top: &Value, value: &Value) -> Result<Frame, Refused> {
    let file = match value.get("file_path") {
        None => return Err(FrameError::Missing("file_path").into()),
        Some(Value::String(file)) if !file.is_empty() => file.clone(),
        Some(_) => return Err(FrameError::NotA("file_path", "a name").into()),
    };
    let model = value.get("camera_model").or(top.get("camera_model")).and_then(Value::as_str);
    if let Some(model) = model
        && !["OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "PERSPECTIVE", "SIMPLE_RADIAL", "RADIAL"]
            .contains(&model.to_uppercase().as_str())
    {
        return Err(Refused::Lens(model.to_owned()));
    }
    let (position, rotation) = pose(value.get("transform_matrix"))?;
    let own = |key: &str| value.get(key).is_some();
    let number = |key: &'static str| -> Result<Option<f64>, FrameError> {
        match value.get(key).or(top.get(key)) {
            None | Some(Value::Null) => Ok(None),
            Some(found) => {
                let number = found.as_f64().filter(|number| number.is_finite());
                number.map(Some).ok_or(FrameError::NotA(key, "a finite number"))
            }
        }
    };
    let positive = |key: &'static str| match number(key)? {
        Some(number) if number <= 0.0 => Err(FrameError::NotA(key, "more than 0")),
        number => Ok(number),
    };
    let size = match (positive("w")?, positive("h")?) {
        (Some(w), Some(h)) => Some([w, h]),
        (None, None) => None,
        (Some(_), None) => return Err(FrameError::Missing("h").into()),
        (None, Some(_)) => return Err(FrameError::Missing("w").into()),
    };
    let angle = |key: &'static str| match positive(key)? {
        Some(angle) if angle >= std::f64::consts::PI => {
            Err(FrameError::NotA(key, "an angle below pi"))
        }
        angle => Ok(angle),
    };
    let intrinsics = Intrinsics {
        size,
        focal: [positive("fl_x")?, positive("fl_y")?],
        angle: [angle("camera_angle_x")?, angle("camera_angle_y")?],
        centre: [number("cx")?, number("cy")?],
    };
    if intrinsics.focal[0].or(intrinsics.angle[0]).is_none() {
        return Err(FrameError::Missing("fl_x").into());
    }
    let own_intrinsics = own("fl_x") || own("camera_angle_x");
    Ok(Frame { file, position, rotation, intrinsics, own_intrinsics })
}

/// How far a rotation's columns may be from unit length or from right angles; as
/// [`Pose::try_from_rows`](vantage_core::Pose::try_from_rows) has it.
const TOLERANCE: f64 = 1e-3;

fn pose(matrix: Option<&Value>) -> Result<(DVec3, DQuat), FrameError> {
    const FIELD: &str = "transform_matrix";
    let matrix = matrix.ok_or(FrameError::Missing(FIELD))?;
    let shape = FrameError::NotA(FIELD, "4 rows of 4 finite numbers");
    let rows: Vec<[f64; 4]> = serde_json::from_value(matrix.clone()).map_err(|_| shape.clone())?;
    let (&[a, b, c], last) = match rows.as_slice() {
        [top @ .., last] if top.len() == 3 => {
            (<&[_; 3]>::try_from(top).map_err(|_| shape.clone())?, *last)
        }
        top => (<&[_; 3]>::try_from(top).map_err(|_| shape.clone())?, [0.0, 0.0, 0.0, 1.0]),
    };
    if last.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(got, want)| (got - want).abs() > 1e-6) {
        return Err(FrameError::NotA(FIELD, "a rigid pose: its last row must be 0 0 0 1"));
    }
    let column = |i: usize| DVec3::new(a[i], b[i], c[i]);
    let (right, up, back, position) = (column(0), column(1), column(2), column(3));
    if ![right, up, back, position].iter().all(|column| column.is_finite()) {
        return Err(shape);
    }
    let lengths = [right.length(), up.length(), back.length()];
    let mean = lengths.iter().sum::<f64>() / 3.0;
    let even = lengths.iter().all(|length| (length - mean).abs() <= TOLERANCE * mean);
    let products = [right.dot(up), up.dot(back), back.dot(right)];
    let square = products.iter().all(|product| product.abs() <= 3.0 * TOLERANCE * mean * mean);
    if !(even && square) {
        return Err(FrameError::NotARotation);
    }
    if right.cross(up).dot(back) < 0.0 {
        return Err(FrameError::Mirrored);
    }
    if (mean - 1.0).abs() > TOLERANCE {
        return Err(FrameError::Scaled(mean));
    }
    let rotation = DQuat::from_mat3(&DMat3::from_cols(right / mean, up / mean, back / mean));
    Ok((position, rotation.normalize()))
}

impl Intrinsics {
    /// The lens in pixels of a photo of that size.
    ///
    /// The photo may be larger or smaller than the file says, as trainers' reduced copies are, if
    /// its proportions are the same to within a pixel and a half.
    pub(super) fn of_photo(&self, [width, height]: [u32; 2]) -> Result<Lens, FrameError> {
        let got = [f64::from(width), f64::from(height)];
        let size = self.size.unwrap_or(got);
        let expected_height = got[0] / size[0] * size[1];
        let expected_width = got[1] / size[1] * size[0];
        if (expected_height - got[1]).abs().min((expected_width - got[0]).abs()) > 1.5 {
            return Err(FrameError::Size { expected: size, got: [width, height] });
        }
        let from_angle =
            |axis: usize| self.angle[axis].map(|angle| 0.5 * size[axis] / (0.5 * angle).tan());
        let x = self.focal[0].or(from_angle(0)).ok_or(FrameError::Missing("fl_x"))?;
        let y = self.focal[1].or(from_angle(1).filter(|_| self.focal[0].is_none())).unwrap_or(x);
        let scale = [got[0] / size[0], got[1] / size[1]];
        let centre = |axis: usize| self.centre[axis].unwrap_or(0.5 * size[axis]) * scale[axis];
        Ok(Lens { focal: [x * scale[0], y * scale[1]], centre: [centre(0), centre(1)], size: got })
    }
}

/// Where a frame's photo may lie: as named, then with the extensions that exporters leave out.
pub(super) fn places(folder: &Path, file: &str) -> Vec<PathBuf> {
    let path = folder.join(file.replace('\\', "/"));
    let mut places = vec![path.clone()];
    let pictures = ["png", "jpg", "jpeg", "PNG", "JPG", "JPEG"];
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("");
    if !pictures.contains(&extension) {
        for picture in pictures {
            let mut name = path.clone().into_os_string();
            name.push(".");
            name.push(picture);
            places.push(name.into());
        }
    }
    places
}
