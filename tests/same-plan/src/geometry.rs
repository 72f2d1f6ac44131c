//! Poses that look at a target, and where points fall in their pictures.

use core::fmt::{self, Write};

use vantage_core::{Camera, Pose, Vec3, math};

use crate::line;

const TARGET: Vec3 = Vec3::new(0.1, -0.2, 0.05);

/// Camera centres on a rising spiral around the target, metres; the last stands straight above it.
fn eyes() -> impl Iterator<Item = Vec3> {
    let spiral = (0..16).map(|step| {
        let step = step as f32;
        let azimuth_rad = 0.9 * step;
        let elevation_rad = -0.3 + 0.1 * step;
        let range_m = 2.0 + 0.13 * step;
        let flat = math::cos(elevation_rad);
        TARGET
            + range_m
                * Vec3::new(
                    flat * math::cos(azimuth_rad),
                    flat * math::sin(azimuth_rad),
                    math::sin(elevation_rad),
                )
    });
    spiral.chain([TARGET + Vec3::Z * 2.0])
}

/// One line per pose: rotation x y z w, then its forward and upward directions.
pub fn poses(out: &mut dyn Write) -> fmt::Result {
    for (index, eye) in eyes().enumerate() {
        match Pose::looking_at(eye, TARGET) {
            Ok(pose) => {
                let (q, forward, up) = (pose.rotation(), pose.forward(), pose.up());
                let values =
                    [q.x, q.y, q.z, q.w, forward.x, forward.y, forward.z, up.x, up.y, up.z];
                line(out, format_args!("pose {index}"), &values)?;
            }
            Err(error) => writeln!(out, "pose {index} refused: {error}")?,
        }
    }
    Ok(())
}

/// What is no pose is refused in the same words everywhere.
pub fn refused(out: &mut dyn Write) -> fmt::Result {
    for eye in [TARGET, Vec3::new(f32::NAN, 0.0, 1.0), Vec3::INFINITY] {
        match Pose::looking_at(eye, TARGET) {
            Ok(pose) => writeln!(out, "accepted: {:?}", pose.rows())?,
            Err(error) => writeln!(out, "{error}")?,
        }
    }
    Ok(())
}

/// The eight corners of a box seen from every pose: pixel coordinates, or `behind`.
pub fn projections(out: &mut dyn Write) -> fmt::Result {
    let camera = match Camera::from_fov(640, 480, 0.9) {
        Ok(camera) => camera,
        Err(error) => return writeln!(out, "camera refused: {error}"),
    };
    line(out, format_args!("focal fov"), &[camera.fx, camera.fy, camera.fov_x_rad()])?;
    for (index, eye) in eyes().enumerate() {
        let Ok(pose) = Pose::looking_at(eye, TARGET) else {
            writeln!(out, "view {index} refused")?;
            continue;
        };
        for corner in 0..8u8 {
            let sign = |bit: u8| if corner >> bit & 1 == 1 { 1.5 } else { -1.5 };
            let point_in_world = TARGET + Vec3::new(sign(0), sign(1), sign(2));
            match camera.project(pose.camera_from_world(point_in_world)) {
                Some(pixel) => {
                    line(out, format_args!("view {index} corner {corner}"), &[pixel.x, pixel.y])?
                }
                None => writeln!(out, "view {index} corner {corner} behind")?,
            }
        }
    }
    Ok(())
}
