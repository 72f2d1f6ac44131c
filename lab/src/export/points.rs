//! The point cloud from which splatting starts: padding, and the PLY file.

use std::borrow::Cow;
use std::f32::consts::PI;

use vantage_core::Vec3;

use super::Point;

/// A folder holds at least this many points: trainers look for several neighbours of each.
pub const LEAST_POINTS: usize = 100;

/// The points, with grey ones added up to [`LEAST_POINTS`].
///
/// Point `i` of the padding stands on a golden spiral that fills the unit sphere evenly by volume:
/// the same count gives the same points.
pub(super) fn padded(points: &[Point]) -> Cow<'_, [Point]> {
    if points.len() >= LEAST_POINTS {
        return Cow::Borrowed(points);
    }
    let count = LEAST_POINTS - points.len();
    let golden_angle = PI * (3.0 - 5.0f32.sqrt());
    let filling = (0..count).map(|i| {
        let share = (i as f32 + 0.5) / count as f32;
        let height = 1.0 - 2.0 * share;
        let ring = (1.0 - height * height).sqrt();
        let (sin, cos) = (i as f32 * golden_angle).sin_cos();
        // The radius follows its own irrational step, so that it does not grow with the height.
        let radius = (i as f32 * 0.618_034).fract().cbrt();
        Point { position: Vec3::new(ring * cos, ring * sin, height) * radius, colour: [128; 3] }
    });
    points.iter().copied().chain(filling).collect()
}

/// A binary PLY: x y z as float, red green blue as uchar, little endian.
pub(super) fn ply(points: &[Point]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float \
         y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar \
         blue\nend_header\n",
        points.len()
    )
    .into_bytes();
    for point in points {
        for coordinate in point.position.to_array() {
            bytes.extend(coordinate.to_le_bytes());
        }
        bytes.extend(point.colour);
    }
    bytes
}
