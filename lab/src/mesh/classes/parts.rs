//! Further parts, and changes to parts; z-up, corners anticlockwise seen from outside.

use vantage_core::math::{cos, sin, unit};
use vantage_core::{Quat, Vec2, Vec3};

use crate::mesh::Mesh;
use crate::mesh::shapes::{Joined, TURN, on_globe, patch};

/// An ellipsoid with the given half axes.
pub(super) fn ball(radii: Vec3, around: u32, along: u32) -> Mesh {
    patch(around, along, Joined::Round, |u, v| on_globe(u, 1.0 - v) * radii).with_v_flipped()
}

/// A box with rounded edges; `radius` is at most half its smallest side.
pub(super) fn cushion(size: Vec3, radius: f32, flat: u32, round: u32) -> Mesh {
    let half = 0.5 * size;
    let radius = radius.min(0.999 * half.min_element());
    let cells = flat + 2 * round;
    // Cells are spent on the round edges: `round` of them on each.
    let reach = |t: f32, half: f32| {
        let at = t * cells as f32;
        let (edge, bend) = (round as f32, half - radius);
        if at < edge {
            -half + radius * at / edge
        } else if at > edge + flat as f32 {
            bend + radius * (at - edge - flat as f32) / edge
        } else {
            -bend + 2.0 * bend * (at - edge) / flat as f32
        }
    };
    let mut mesh = Mesh::default();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0f32)] {
        let (a, b) = if sign > 0.0 { (axis + 1, axis + 2) } else { (axis + 2, axis + 1) };
        mesh.append(patch(cells, cells, Joined::Nowhere, |u, v| {
            let mut p = Vec3::ZERO;
            p[axis] = half[axis] * sign;
            p[a % 3] = reach(u, half[a % 3]);
            p[b % 3] = reach(v, half[b % 3]);
            let inner = p.clamp(radius - half, half - radius);
            inner + unit(p - inner).unwrap_or(Vec3::ZERO) * radius
        }));
    }
    mesh.boxed(size.max_element())
}

/// An outline around the z axis, seen from it everywhere, made `height` thick, its rims bevelled.
pub(super) fn extruded(
    outline: impl Fn(f32) -> Vec2,
    height: f32,
    bevel: f32,
    around: u32,
    rings: u32,
) -> Mesh {
    let (half, slope) = (0.5 * height, 0.5 * bevel);
    let mut profile: Vec<(f32, f32, f32)> = Vec::new(); // share of the outline, inset, height
    for i in 0..rings {
        profile.push((i as f32 / rings as f32, bevel, -half));
    }
    profile.extend([
        (1.0, bevel, -half),
        (1.0, 0.3 * slope, slope - half),
        (1.0, 0.0, bevel - half),
    ]);
    profile.extend([
        (1.0, 0.0, half - bevel),
        (1.0, 0.3 * slope, half - slope),
        (1.0, bevel, half),
    ]);
    for i in (0..rings).rev() {
        profile.push((i as f32 / rings as f32, bevel, half));
    }
    let last = profile.len() - 1;
    let mesh = patch(around, last as u32, Joined::Round, |u, v| {
        let at = v.clamp(0.0, 1.0) * last as f32;
        let i = (at as usize).min(last - 1);
        let t = at - i as f32;
        let blend =
            |f: fn(&(f32, f32, f32)) -> f32| f(&profile[i]) * (1.0 - t) + f(&profile[i + 1]) * t;
        let p = outline(u - u.floor());
        let length = p.length().max(1e-6);
        let p = p * (blend(|p| p.0) * (1.0 - blend(|p| p.1) / length).max(0.0));
        p.extend(blend(|p| p.2))
    });
    mesh.boxed(1.0)
}

/// A rounded rectangle or an oval: `|x / a|^n + |y / b|^n = 1` for n = 2 (`square` 0) up to 8.
pub(super) fn oval(half: Vec2, square: f32) -> impl Fn(f32) -> Vec2 {
    move |u| {
        let (c, s) = (cos(u * TURN), sin(u * TURN));
        let (c2, s2) = (c * c, s * s);
        let round = 1.0;
        let boxy = 1.0 / (c2 * c2 * c2 * c2 + s2 * s2 * s2 * s2).sqrt().sqrt().sqrt();
        Vec2::new(c, s) * (round + (boxy - round) * square) * half
    }
}

/// The outline through points at equal steps around.
pub(super) fn ring_of(points: Vec<Vec2>) -> impl Fn(f32) -> Vec2 {
    move |u| {
        let n = points.len();
        let at = u * n as f32;
        let (i, t) = (at as usize, at.fract());
        let p = |k: usize| points[(i + k + n - 1) % n];
        catmull_rom([p(0), p(1), p(2), p(3)], t)
    }
}

/// The polygon of these corners, `corner` by `corner` in equal shares of u.
pub(super) fn polygon(points: Vec<Vec2>) -> impl Fn(f32) -> Vec2 {
    move |u| {
        let n = points.len();
        let at = u * n as f32;
        let (i, t) = (at as usize % n, at.fract());
        points[i] * (1.0 - t) + points[(i + 1) % n] * t
    }
}

fn catmull_rom<V>([a, b, c, d]: [V; 4], t: f32) -> V
where
    V: Copy
        + std::ops::Add<Output = V>
        + std::ops::Sub<Output = V>
        + std::ops::Mul<f32, Output = V>,
{
    b + ((c - a) * t
        + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t)
        + ((b - c) * 3.0 + d - a) * (t * t * t))
        * 0.5
}

/// A tube of `radius(t)` through points, along a Catmull-Rom curve, its ends closed and flat.
pub(super) fn pipe(points: &[Vec3], around: u32, along: u32, radius: impl Fn(f32) -> f32) -> Mesh {
    let last = points.len() - 1;
    let place = |t: f32| {
        let at = t.clamp(0.0, 1.0) * last as f32;
        let i = (at as usize).min(last - 1);
        let before = if i == 0 { points[0] * 2.0 - points[1] } else { points[i - 1] };
        let after = if i + 1 == last { points[last] * 2.0 - points[i] } else { points[i + 2] };
        catmull_rom([before, points[i], points[i + 1], after], at - i as f32)
    };
    // Frames that turn no more than the curve does.
    let steps = 4 * along as usize;
    let mut frames: Vec<(Vec3, Vec3)> = Vec::with_capacity(steps + 1);
    for i in 0..=steps {
        let t = i as f32 / steps as f32;
        let (from, to) = (place(t - 0.5 / steps as f32), place(t + 0.5 / steps as f32));
        let tangent = unit(to - from).unwrap_or(Vec3::Z);
        let aside = frames.last().map_or(tangent.any_orthonormal_vector(), |(aside, _)| *aside);
        let aside =
            unit(aside - tangent * aside.dot(tangent)).unwrap_or(tangent.any_orthonormal_vector());
        frames.push((aside, tangent.cross(aside)));
    }
    let rows = along + 2;
    patch(around, rows, Joined::Round, |u, v| {
        let at = v.clamp(0.0, 1.0) * rows as f32;
        let t = ((at - 1.0) / along as f32).clamp(0.0, 1.0);
        let full = at.min(rows as f32 - at).min(1.0);
        let (aside, across) = frames[(t * steps as f32 + 0.5) as usize];
        place(t) + (aside * cos(u * TURN) + across * sin(u * TURN)) * (radius(t) * full)
    })
}

/// A straight rod from one radius to another, its ends flat.
pub(super) fn rod(from: Vec3, to: Vec3, radii: [f32; 2], around: u32, along: u32) -> Mesh {
    pipe(&[from, to], around, along, |t| radii[0] + (radii[1] - radii[0]) * t)
}

/// A rod with round ends around its two end points.
pub(super) fn limb(from: Vec3, to: Vec3, radii: [f32; 2], around: u32, along: u32) -> Mesh {
    let ahead = unit(to - from).unwrap_or(Vec3::Z);
    let length = from.distance(to);
    let total = length + radii[0] + radii[1];
    let ends = [from - ahead * radii[0], to + ahead * radii[1]];
    // Rows are closer near the ends.
    let eased = |t: f32| t * t * (3.0 - 2.0 * t);
    let axis = ends.map(|end| end);
    let turn = Quat::from_rotation_arc(Vec3::Z, ahead);
    let mesh = patch(around, along, Joined::Round, |u, v| {
        let s = eased(v.clamp(0.0, 1.0)) * total;
        let radius = if s < radii[0] {
            (radii[0] * radii[0] - (radii[0] - s) * (radii[0] - s)).max(0.0).sqrt()
        } else if s > total - radii[1] {
            let beyond = s - (total - radii[1]);
            (radii[1] * radii[1] - beyond * beyond).max(0.0).sqrt()
        } else {
            radii[0] + (radii[1] - radii[0]) * (s - radii[0]) / length.max(1e-6)
        };
        Vec3::new(radius * cos(u * TURN), radius * sin(u * TURN), s)
    });
    mesh.placed(turn, axis[0])
}

/// A ring: a round tube around an oval in the xy plane.
pub(super) fn hoop(half: Vec2, thick: f32, around: u32, along: u32) -> Mesh {
    patch(along, around, Joined::Ring, |u, v| {
        let (c, s) = (cos(u * TURN), sin(u * TURN));
        let out = unit(Vec3::new(c * half.y, s * half.x, 0.0)).unwrap_or(Vec3::X);
        let middle = Vec3::new(c * half.x, s * half.y, 0.0);
        middle + (out * cos(v * TURN) + Vec3::Z * sin(v * TURN)) * thick
    })
}

/// Turns the z axis to a direction.
pub(super) fn towards(direction: Vec3) -> Quat {
    Quat::from_rotation_arc(Vec3::Z, unit(direction).unwrap_or(Vec3::Z))
}

impl Mesh {
    /// UVs from the side that each face looks to, `unit` long.
    pub(super) fn boxed(mut self, unit: f32) -> Self {
        self.uvs = (0..self.faces.len())
            .map(|face| {
                let facing = self.normal(face).abs();
                let axis = facing.max_position();
                self.corners(face).map(|p| {
                    let p = p / unit + 0.5;
                    match axis {
                        0 => Vec2::new(p.y, 1.0 - p.z),
                        1 => Vec2::new(p.x, 1.0 - p.z),
                        _ => Vec2::new(p.x, 1.0 - p.y),
                    }
                })
            })
            .collect();
        self
    }

    /// Every point moved by a function that keeps left and right apart; normals follow.
    pub(super) fn warped(mut self, to: impl Fn(Vec3) -> Vec3) -> Self {
        let reach = 1e-3;
        for (normals, face) in self.normals.iter_mut().zip(&self.faces) {
            for (normal, &vertex) in normals.iter_mut().zip(face) {
                let p = self.positions[vertex as usize];
                let (a, b) = normal.any_orthonormal_pair();
                let (from, one, other) = (to(p), to(p + a * reach), to(p + b * reach));
                let turned = (one - from).cross(other - from);
                *normal = unit(turned * 1e6).unwrap_or(*normal);
            }
        }
        for position in &mut self.positions {
            *position = to(*position);
        }
        self
    }

    /// Scaled along the axes, by positive factors.
    pub(super) fn stretched(self, factors: Vec3) -> Self {
        self.warped(|p| p * factors)
    }

    /// Turned about the origin.
    pub(super) fn rotated(self, rotation: Quat) -> Self {
        self.placed(rotation, Vec3::ZERO)
    }

    /// The inside of what it was the outside of.
    pub(super) fn inside_out(mut self) -> Self {
        for face in &mut self.faces {
            face.swap(1, 2);
        }
        for uvs in &mut self.uvs {
            uvs.swap(1, 2);
        }
        for normals in &mut self.normals {
            normals.swap(1, 2);
            *normals = normals.map(|normal| -normal);
        }
        self
    }
}

/// A sheet that is seen from both sides, a little apart: a patch and its back.
pub(super) fn sheet(nu: u32, nv: u32, thick: f32, point: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let normal = |u: f32, v: f32| {
        let e = 1e-3;
        let along_u = point(u + e, v) - point(u - e, v);
        let along_v = point(u, v + e) - point(u, v - e);
        unit(along_u.cross(along_v) * 1e6).unwrap_or(Vec3::Z)
    };
    let half = 0.5 * thick;
    let mut mesh = patch(nu, nv, Joined::Nowhere, |u, v| point(u, v) + normal(u, v) * half);
    let back = patch(nu, nv, Joined::Nowhere, |u, v| point(u, v) - normal(u, v) * half);
    mesh.append(back.inside_out());
    mesh
}
