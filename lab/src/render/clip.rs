//! Cuts off what cannot be projected: behind the near plane, or very far aside.

use glam::DVec3;
use vantage_core::Vec3;

use super::vertex::{FAR_ASIDE, Projected, projected};
use super::view::View;

/// A corner of the polygon that is left, in the camera's frame: right, up, depth.
#[derive(Clone, Copy)]
struct Corner {
    point: DVec3,
    /// The projection that the neighbours of this vertex use too, if it needs no clipping.
    original: Option<Projected>,
}

/// The parts of a triangle that can be projected.
///
/// A cut edge is always followed from its inner to its outer end, in double precision, so that two
/// faces which share it get the same point and stay without a gap.
pub(super) fn clipped(
    view: &View,
    near: f32,
    points: &[Vec3; 3],
    corners: &[Projected; 3],
) -> Vec<[Projected; 3]> {
    let axes = [view.right, view.up, view.forward].map(|axis| axis.as_dvec3());
    let mut polygon: Vec<Corner> = points
        .iter()
        .zip(corners)
        .map(|(point, corner)| {
            let p = point.as_dvec3() - view.eye.as_dvec3();
            let point = DVec3::new(p.dot(axes[0]), p.dot(axes[1]), p.dot(axes[2]));
            Corner { point, original: (corner.w != 0.0).then_some(*corner) }
        })
        .collect();

    // A plane keeps where its product with (right, up, depth) is not below its offset. On the
    // picture x = fx right / depth + offset_x stays within ± limit, and y likewise downwards.
    let limit = f64::from(FAR_ASIDE / 256.0);
    let (fx, fy) = (f64::from(view.fx), f64::from(view.fy));
    let (ox, oy) = (f64::from(view.offset_x), f64::from(view.offset_y));
    let planes = [
        (DVec3::new(0.0, 0.0, 1.0), f64::from(near)),
        (DVec3::new(fx, 0.0, limit + ox), 0.0),
        (DVec3::new(-fx, 0.0, limit - ox), 0.0),
        (DVec3::new(0.0, -fy, limit + oy), 0.0),
        (DVec3::new(0.0, fy, limit - oy), 0.0),
    ];
    for (normal, offset) in planes {
        let inside = |corner: &Corner| normal.dot(corner.point) - offset;
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, corner) in polygon.iter().enumerate() {
            let next = &polygon[(i + 1) % polygon.len()];
            let (here, there) = (inside(corner), inside(next));
            if here >= 0.0 {
                kept.push(*corner);
            }
            if (here >= 0.0) != (there >= 0.0) {
                let (inner, outer, t) = if here >= 0.0 {
                    (corner.point, next.point, here / (here - there))
                } else {
                    (next.point, corner.point, there / (there - here))
                };
                kept.push(Corner { point: inner + (outer - inner) * t, original: None });
            }
        }
        polygon = kept;
        if polygon.len() < 3 {
            return Vec::new();
        }
    }

    let on_picture: Vec<Projected> = polygon
        .iter()
        .map(|corner| {
            let DVec3 { x, y, z } = corner.point;
            corner.original.unwrap_or_else(|| projected(fx * x / z + ox, oy - fy * y / z, z))
        })
        .collect();
    on_picture[1..].windows(2).map(|pair| [on_picture[0], pair[0], pair[1]]).collect()
}
