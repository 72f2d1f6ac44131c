//! A COLMAP model of known poses: cameras, images without features, points without tracks.
//!
//! COLMAP's poses are `camera_from_world` with OpenCV camera axes: +X right, +Y down, the camera
//! looks along **+Z**. Ours are `world_from_camera` with OpenGL axes; half a turn about the camera's
//! X takes one to the other:
//!
//! `camera_from_world = (world_from_camera · turn_x(pi))⁻¹`
//!
//! The model stands there twice, as text to be read and compared and as binary for the readers that
//! know no other (gsplat up to 1.5). A reader that knows both takes the binary one; the two hold the
//! same doubles. Formats: <https://colmap.github.io/format.html>.

use std::fmt::Write as _;
use std::path::Path;

use glam::{DQuat, DVec3};
use vantage_core::{Camera, Pose};

use super::{Capture, ExportError, Point, make_folder, save};

/// The only camera of the model.
const CAMERA_ID: u32 = 1;
/// COLMAP's number for its model PINHOLE: fx, fy, cx, cy.
const PINHOLE: u32 = 1;

/// A pose as COLMAP has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CameraFromWorld {
    /// OpenCV axes, unit length, `w >= 0`.
    pub rotation: DQuat,
    /// The world's origin in the camera's frame, metres.
    pub translation: DVec3,
}

impl From<&Pose> for CameraFromWorld {
    fn from(pose: &Pose) -> Self {
        let half_turn = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
        let world_from_camera = pose.rotation().as_dquat().normalize() * half_turn;
        let mut rotation = world_from_camera.conjugate();
        if rotation.w < 0.0 {
            rotation = -rotation;
        }
        Self { rotation, translation: -(rotation * pose.position().as_dvec3()) }
    }
}

/// Writes `{cameras,images,points3D}.{txt,bin}`; shape: `names` (photos).
pub(super) fn write(
    folder: &Path,
    capture: &Capture,
    names: &[String],
    points: &[Point],
) -> Result<(), ExportError> {
    make_folder(folder)?;
    let poses: Vec<CameraFromWorld> =
        capture.photos.iter().map(|photo| CameraFromWorld::from(&photo.pose)).collect();
    save(folder, "cameras.txt", cameras_text(&capture.camera).as_bytes())?;
    save(folder, "images.txt", images_text(&poses, names).as_bytes())?;
    save(folder, "points3D.txt", points_text(points).as_bytes())?;
    save(folder, "cameras.bin", &cameras_binary(&capture.camera))?;
    save(folder, "images.bin", &images_binary(&poses, names))?;
    save(folder, "points3D.bin", &points_binary(points))
}

// Writing to a `String` cannot fail: the results below are dropped for that reason.

fn cameras_text(camera: &Camera) -> String {
    let [fx, fy, cx, cy] = parameters(camera);
    format!(
        "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n{CAMERA_ID} PINHOLE {} {} {fx} {fy} {cx} {cy}\n",
        camera.width, camera.height
    )
}

fn images_text(poses: &[CameraFromWorld], names: &[String]) -> String {
    let mut text = String::from(
        "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, \
         POINT3D_ID)\n",
    );
    for (index, (pose, name)) in poses.iter().zip(names).enumerate() {
        let CameraFromWorld { rotation: q, translation: t } = pose;
        let _ = write!(text, "{} {} {} {} {}", index + 1, q.w, q.x, q.y, q.z);
        // The second line of an image lists its features. It has none, but the line must be there.
        let _ = writeln!(text, " {} {} {} {CAMERA_ID} {name}\n", t.x, t.y, t.z);
    }
    text
}

fn points_text(points: &[Point]) -> String {
    let mut text = String::from("# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]\n");
    for (index, point) in points.iter().enumerate() {
        let [x, y, z] = point.position.to_array().map(f64::from);
        let [r, g, b] = point.colour;
        let _ = writeln!(text, "{} {x} {y} {z} {r} {g} {b} 0", index + 1);
    }
    text
}

fn cameras_binary(camera: &Camera) -> Vec<u8> {
    let mut bytes = 1u64.to_le_bytes().to_vec();
    bytes.extend(CAMERA_ID.to_le_bytes());
    bytes.extend(PINHOLE.to_le_bytes());
    bytes.extend(u64::from(camera.width).to_le_bytes());
    bytes.extend(u64::from(camera.height).to_le_bytes());
    extend_doubles(&mut bytes, parameters(camera));
    bytes
}

fn images_binary(poses: &[CameraFromWorld], names: &[String]) -> Vec<u8> {
    let mut bytes = (poses.len() as u64).to_le_bytes().to_vec();
    for (id, (pose, name)) in (1u32..).zip(poses.iter().zip(names)) {
        let CameraFromWorld { rotation: q, translation: t } = pose;
        bytes.extend(id.to_le_bytes());
        extend_doubles(&mut bytes, [q.w, q.x, q.y, q.z, t.x, t.y, t.z]);
        bytes.extend(CAMERA_ID.to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.push(0);
        bytes.extend(0u64.to_le_bytes()); // features
    }
    bytes
}

fn points_binary(points: &[Point]) -> Vec<u8> {
    let mut bytes = (points.len() as u64).to_le_bytes().to_vec();
    for (id, point) in (1u64..).zip(points) {
        bytes.extend(id.to_le_bytes());
        extend_doubles(&mut bytes, point.position.to_array().map(f64::from));
        bytes.extend(point.colour);
        extend_doubles(&mut bytes, [0.0]); // error
        bytes.extend(0u64.to_le_bytes()); // track
    }
    bytes
}

/// fx, fy, cx, cy in pixels. COLMAP and we both put the origin at the picture's upper left corner.
fn parameters(camera: &Camera) -> [f64; 4] {
    [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from)
}

fn extend_doubles<const N: usize>(bytes: &mut Vec<u8>, values: [f64; N]) {
    for value in values {
        bytes.extend(value.to_le_bytes());
    }
}
