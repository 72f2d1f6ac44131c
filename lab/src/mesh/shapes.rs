//! Parts of objects: patches, boxes, turned bodies and tubes, each with UVs and smooth normals.
//!
//! Parts are built z-up with their corners anticlockwise seen from outside.

use vantage_core::math::{cos, sin, unit};
use vantage_core::{Quat, Vec2, Vec3};

use crate::mesh::{Material, Mesh};

pub(super) const TURN: f32 = std::f32::consts::TAU;

/// Which sides of a patch are joined to each other.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Joined {
    Nowhere,
    /// u = 0 and u = 1 are one line.
    Round,
    /// So are v = 0 and v = 1.
    Ring,
}

/// A patch of `nu` by `nv` cells over (u, v) in [0, 1]²; its outside is `∂u × ∂v`.
///
/// Cells without area (at a pole) are left to be dropped by [`Object::finished`].
pub(super) fn patch(nu: u32, nv: u32, joined: Joined, point: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let (wrap_u, wrap_v) = (joined != Joined::Nowhere, joined == Joined::Ring);
    let columns = if wrap_u { nu } else { nu + 1 };
    let rows = if wrap_v { nv } else { nv + 1 };
    let at = |i: u32, n: u32| i as f32 / n as f32;
    let mut mesh = Mesh::default();
    let mut normals = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let (u, v) = (at(i, nu), at(j, nv));
            mesh.positions.push(point(u, v));
            // At a pole all directions of u are one: look a little beside it.
            let (du, dv) = (0.2 / nu as f32, 0.2 / nv as f32);
            let beside = if wrap_v { v } else { v.clamp(dv, 1.0 - dv) };
            let along_u = point(u + du, beside) - point(u - du, beside);
            let along_v = point(u, beside + dv) - point(u, beside - dv);
            normals.push(unit(along_u.cross(along_v) * 1e6).unwrap_or(Vec3::Z));
        }
    }
    let index = |i: u32, j: u32| (j % rows) * columns + i % columns;
    for j in 0..nv {
        for i in 0..nu {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                let triangle = triangle.map(|k: usize| corners[k]);
                let face = triangle.map(|(i, j)| index(i, j));
                mesh.faces.push(face);
                mesh.uvs.push(triangle.map(|(i, j)| Vec2::new(at(i, nu), at(j, nv))));
                mesh.normals.push(face.map(|vertex| normals[vertex as usize]));
                mesh.face_material.push(0);
            }
        }
    }
    mesh
}

/// A direction on the sphere from (u, v) in [0, 1]², v downwards, as a world map has it.
pub(super) fn on_globe(u: f32, v: f32) -> Vec3 {
    let (azimuth, polar) = (u * TURN, v * 0.5 * TURN);
    // Exactly on the axis at the poles, where the sine only nearly vanishes.
    let ring = if v <= 0.0 || v >= 1.0 { 0.0 } else { sin(polar) };
    Vec3::new(ring * cos(azimuth), ring * sin(azimuth), cos(polar))
}

/// A box of the given size around the origin, each side in cells of about `cell`; a UV unit is
/// `uv_unit` long, and v runs along the box's longest side.
pub(super) fn block(size: Vec3, cell: f32, uv_unit: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let longest = size.max_element();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0f32)] {
        let unit_of = |i: usize| [Vec3::X, Vec3::Y, Vec3::Z][i % 3];
        let (a, b) = if sign > 0.0 { (axis + 1, axis + 2) } else { (axis + 2, axis + 1) };
        let (along_u, along_v) = (unit_of(a) * size, unit_of(b) * size);
        let middle = unit_of(axis) * size * 0.5 * sign;
        let cells = |length: f32| ((length / cell + 0.5) as u32).clamp(1, 40);
        let (lu, lv) = (along_u.length(), along_v.length());
        let mut side = patch(cells(lu), cells(lv), Joined::Nowhere, |u, v| {
            middle + along_u * (u - 0.5) + along_v * (v - 0.5)
        });
        for uv in side.uvs.iter_mut().flatten() {
            *uv = *uv * Vec2::new(lu, lv) / uv_unit;
            if lu > lv || (lu == longest && lv < longest) {
                *uv = Vec2::new(uv.y, uv.x);
            }
            // Sides should not all show the same piece of the picture.
            *uv += Vec2::new(0.37, 0.21) * (axis as f32 + 0.5 * sign);
        }
        mesh.append(side);
    }
    mesh
}

/// A body turned about z from points (radius, height), from the bottom up, outside outwards.
///
/// The points are joined by a Catmull-Rom curve; u runs around, v from the last point (0) down.
pub(super) fn turned(profile: &[(f32, f32)], around: u32, along: u32) -> Mesh {
    patch(around, along, Joined::Round, |u, v| {
        let (radius, height) = on_curve(profile, v);
        Vec3::new(radius * cos(u * TURN), radius * sin(u * TURN), height)
    })
    .with_v_flipped()
}

/// A point of the curve through `profile` at `t` in [0, 1]; the radius is never negative.
fn on_curve(profile: &[(f32, f32)], t: f32) -> (f32, f32) {
    let last = profile.len() - 1;
    let t = t.clamp(0.0, 1.0) * last as f32;
    let i = (t as usize).min(last - 1);
    let s = t - i as f32;
    let point = |k: usize| Vec2::new(profile[k].0, profile[k].1);
    let (b, c) = (point(i), point(i + 1));
    if s == 0.0 || s == 1.0 {
        let end = if s == 0.0 { b } else { c };
        return (end.x, end.y);
    }
    let a = if i == 0 { b * 2.0 - c } else { point(i - 1) };
    let d = if i + 1 == last { c * 2.0 - b } else { point(i + 2) };
    let p = b
        + ((c - a) * s
            + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (s * s)
            + ((b - c) * 3.0 + d - a) * (s * s * s))
            * 0.5;
    (p.x.max(0.0), p.y)
}

/// A tube around `middle(t)`, `radius(t)` thick; `aside(t)` says which way its u = 0 looks.
pub(super) fn tube(
    around: u32,
    along: u32,
    joined: Joined,
    middle: impl Fn(f32) -> Vec3,
    aside: impl Fn(f32) -> Vec3,
    radius: impl Fn(f32) -> f32,
) -> Mesh {
    patch(around, along, joined, |u, t| {
        let tangent = unit(middle(t + 1e-3) - middle(t - 1e-3)).unwrap_or(Vec3::Z);
        let out = aside(t);
        let out =
            unit(out - tangent * out.dot(tangent)).unwrap_or(tangent.any_orthonormal_vector());
        let across = tangent.cross(out);
        middle(t) + (out * cos(u * TURN) + across * sin(u * TURN)) * radius(t)
    })
}

/// A straight round bar with flat ends.
pub(super) fn bar(
    from: Vec3,
    to: Vec3,
    radius: impl Fn(f32) -> f32,
    around: u32,
    along: u32,
) -> Mesh {
    let aside = unit((to - from).cross(Vec3::new(0.3, 0.9, 0.1))).unwrap_or(Vec3::X);
    // The first and last ring close the ends.
    let cells = along + 2;
    tube(
        around,
        cells,
        Joined::Round,
        move |t| from + (to - from) * t,
        move |_| aside,
        move |t| if t <= 0.0 || t >= 1.0 { 0.0 } else { radius(t) },
    )
}

impl Mesh {
    /// UVs with v the other way up.
    pub(super) fn with_v_flipped(mut self) -> Self {
        for uv in self.uvs.iter_mut().flatten() {
            uv.y = 1.0 - uv.y;
        }
        self
    }

    /// UVs times a factor, so that the picture repeats.
    pub(super) fn tiled(mut self, u: f32, v: f32) -> Self {
        for uv in self.uvs.iter_mut().flatten() {
            *uv *= Vec2::new(u, v);
        }
        self
    }

    /// Turned and then moved.
    pub(super) fn placed(mut self, rotation: Quat, translation: Vec3) -> Self {
        for position in &mut self.positions {
            *position = rotation * *position + translation;
        }
        for normal in self.normals.iter_mut().flatten() {
            *normal = rotation * *normal;
        }
        self
    }

    /// Moved.
    pub(super) fn moved(self, translation: Vec3) -> Self {
        self.placed(Quat::IDENTITY, translation)
    }

    /// Multiplied with an sRGB colour.
    pub(super) fn tinted(mut self, srgb: [f32; 3]) -> Self {
        let linear = srgb.map(crate::mesh::colour::linear_from_srgb);
        self.colours = vec![[linear; 3]; self.faces.len()];
        self
    }
}

/// A mesh in the making.
#[derive(Default)]
pub(super) struct Object {
    mesh: Mesh,
    materials: Vec<Material>,
}

impl Object {
    /// Adds a material and gives its index.
    pub fn material(&mut self, material: Material) -> u16 {
        self.materials.push(material);
        (self.materials.len() - 1) as u16
    }

    /// Adds a part made of a material.
    pub fn add(&mut self, material: u16, mut part: Mesh) {
        part.face_material.fill(material);
        self.mesh.append(part);
    }

    /// The object, y-up as a file would have it, without triangles of no area.
    pub fn finished(self) -> Mesh {
        let mut mesh = self.mesh;
        mesh.materials = self.materials;
        let y_up = |p: Vec3| Vec3::new(p.x, p.z, -p.y);
        for position in &mut mesh.positions {
            *position = y_up(*position);
        }
        for normal in mesh.normals.iter_mut().flatten() {
            *normal = y_up(*normal);
        }
        mesh.retain_faces(|mesh, face| mesh.area(face) > 1e-12);
        mesh
    }
}
