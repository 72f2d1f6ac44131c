//! `transforms.json` and its kin: intrinsics and `world_from_camera` matrices.

use serde::Serialize;
use vantage_core::{Camera, Pose};

use super::{Capture, ExportError, Point};
use crate::record::Matrix4;

/// nerfstudio's and instant-ngp's file.
#[derive(Serialize)]
pub(super) struct Trainer {
    camera_model: &'static str,
    #[serde(flatten)]
    intrinsics: Intrinsics,
    k1: f64,
    k2: f64,
    p1: f64,
    p2: f64,
    aabb_scale: u32,
    ply_file_path: &'static str,
    frames: Vec<Frame>,
}

/// The file of one split of a NeRF-synthetic scene.
///
/// The format knows `camera_angle_x` only; the rest is for readers that else assume 800 x 800.
#[derive(Serialize)]
pub(super) struct Split {
    #[serde(flatten)]
    intrinsics: Intrinsics,
    frames: Vec<Frame>,
}

#[derive(Serialize)]
struct Intrinsics {
    camera_angle_x: f64, // radians
    fl_x: f64,           // pixels, as all below
    fl_y: f64,
    cx: f64,
    cy: f64,
    w: u32,
    h: u32,
}

#[derive(Serialize)]
struct Frame {
    file_path: String,
    transform_matrix: Matrix4, // world_from_camera, OpenGL axes
}

/// The trainers' file; shape: `names` (photos), each with its extension.
pub(super) fn trainer(capture: &Capture, names: &[String], points: &[Point]) -> Trainer {
    let frames = names.iter().zip(&capture.photos).map(|(name, photo)| Frame {
        file_path: format!("images/{name}"),
        transform_matrix: matrix_of(&photo.pose),
    });
    Trainer {
        camera_model: "OPENCV",
        intrinsics: Intrinsics::of(&capture.camera),
        k1: 0.0,
        k2: 0.0,
        p1: 0.0,
        p2: 0.0,
        aabb_scale: aabb_scale(points),
        ply_file_path: "sparse_pc.ply",
        frames: frames.collect(),
    }
}

/// A split whose pictures stand in `folder` as `r_0.png`, `r_1.png` …
pub(super) fn split(folder: &str, capture: &Capture) -> Result<Split, ExportError> {
    let Camera { width, height, fx, fy, cx, cy, .. } = capture.camera;
    let off_centre = (cx - 0.5 * width as f32).abs().max((cy - 0.5 * height as f32).abs()) > 1e-3;
    if (fx - fy).abs() > 1e-6 * fx || off_centre {
        return Err(ExportError::CameraNotCentred);
    }
    let frames = capture.photos.iter().enumerate().map(|(index, photo)| Frame {
        file_path: format!("./{folder}/r_{index}"),
        transform_matrix: matrix_of(&photo.pose),
    });
    Ok(Split { intrinsics: Intrinsics::of(&capture.camera), frames: frames.collect() })
}

impl Intrinsics {
    fn of(camera: &Camera) -> Self {
        let (fl_x, width) = (f64::from(camera.fx), f64::from(camera.width));
        Self {
            camera_angle_x: 2.0 * (0.5 * width / fl_x).atan(),
            fl_x,
            fl_y: f64::from(camera.fy),
            cx: f64::from(camera.cx),
            cy: f64::from(camera.cy),
            w: camera.width,
            h: camera.height,
        }
    }
}

/// `world_from_camera` in double precision, shape (4, 4).
pub(super) fn matrix_of(pose: &Pose) -> Matrix4 {
    let rotation = glam::DMat3::from_quat(pose.rotation().as_dquat().normalize());
    let [x, y, z] = pose.position().to_array().map(f64::from);
    let [right, up, back] = rotation.to_cols_array_2d();
    [
        [right[0], up[0], back[0], x],
        [right[1], up[1], back[1], y],
        [right[2], up[2], back[2], z],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// The cube of space that instant-ngp models: the least power of two, up to its 128, that holds the
/// points.
///
/// instant-ngp scales the world by 0.33 about the middle of the unit cube: 1 holds |x| <= 1.51.
fn aabb_scale(points: &[Point]) -> u32 {
    const WORLD_PER_UNIT: f32 = 0.5 / 0.33;
    let reach = points.iter().map(|p| p.position.abs().max_element()).fold(0.0, f32::max);
    let mut scale = 1;
    while scale < 128 && reach > scale as f32 * WORLD_PER_UNIT {
        scale *= 2;
    }
    scale
}
