//! Surfaces of smooth unions: where a field of signed distances is zero.
//!
//! Naive surface nets (Gibson, 1998): one vertex in each cell that the surface crosses, at the mean
//! of its crossings with the cell's edges, and one quadrilateral around each crossed edge of the
//! grid.

use std::collections::HashMap;

use vantage_core::Vec3;
use vantage_core::math::unit;

use crate::mesh::Mesh;

/// A blob between two balls, as a signed distance (Quilez' round cone, up to the ends' slant).
#[derive(Clone, Copy, Debug)]
pub(super) struct Bone {
    pub from: Vec3,
    pub to: Vec3,
    pub radii: [f32; 2],
}

impl Bone {
    pub fn ball(at: Vec3, radius: f32) -> Self {
        Self { from: at, to: at, radii: [radius; 2] }
    }

    pub fn distance(&self, p: Vec3) -> f32 {
        let axis = self.to - self.from;
        let t = ((p - self.from).dot(axis) / axis.length_squared().max(1e-9)).clamp(0.0, 1.0);
        p.distance(self.from + axis * t) - (self.radii[0] + (self.radii[1] - self.radii[0]) * t)
    }
}

/// The smooth union of bones: seams are rounded over a width of `blend`.
pub(super) fn union(bones: &[Bone], blend: f32, p: Vec3) -> f32 {
    bones.iter().fold(f32::INFINITY, |a, bone| smooth_min(a, bone.distance(p), blend))
}

/// The lesser of two numbers, rounded where they are nearly equal.
pub(super) fn smooth_min(a: f32, b: f32, blend: f32) -> f32 {
    let near = (blend - (a - b).abs()).max(0.0) / blend.max(1e-6);
    a.min(b) - near * near * blend * 0.25
}

/// The surface where `field` is zero, negative inside, within a box; `cells` along its longest side.
pub(super) fn surface(low: Vec3, high: Vec3, cells: u32, field: impl Fn(Vec3) -> f32) -> Mesh {
    let size = high - low;
    let cell = size.max_element() / cells as f32;
    let n: [usize; 3] = (size / cell).to_array().map(|side| side.ceil() as usize + 2);
    let place =
        |[i, j, k]: [usize; 3]| low + (Vec3::new(i as f32, j as f32, k as f32) - 0.5) * cell;
    let index = |[i, j, k]: [usize; 3]| (k * n[1] + j) * n[0] + i;
    let mut values = Vec::with_capacity(n[0] * n[1] * n[2]);
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                values.push(field(place([i, j, k])));
            }
        }
    }
    let mut mesh = Mesh::default();
    let mut vertices: HashMap<usize, u32> = HashMap::new();
    let mut normals = Vec::new();
    let mut vertex_of = |mesh: &mut Mesh, at: [usize; 3]| {
        *vertices.entry(index(at)).or_insert_with(|| {
            let (mut sum, mut crossings) = (Vec3::ZERO, 0.0);
            for corner in 0..8usize {
                for axis in (0..3).filter(|axis| corner >> axis & 1 == 0) {
                    let offset = |bits: usize| std::array::from_fn(|i| at[i] + (bits >> i & 1));
                    let (from, to) = (offset(corner), offset(corner | 1 << axis));
                    let (a, b) = (values[index(from)], values[index(to)]);
                    if (a < 0.0) != (b < 0.0) {
                        sum += place(from).lerp(place(to), a / (a - b));
                        crossings += 1.0;
                    }
                }
            }
            let p = sum / crossings;
            let here = field(p);
            let e = 0.25 * cell;
            let slope = Vec3::new(
                field(p + Vec3::X * e) - here,
                field(p + Vec3::Y * e) - here,
                field(p + Vec3::Z * e) - here,
            );
            mesh.positions.push(p);
            normals.push(unit(slope).unwrap_or(Vec3::Z));
            mesh.positions.len() as u32 - 1
        })
    };
    for k in 1..n[2] - 1 {
        for j in 1..n[1] - 1 {
            for i in 1..n[0] - 1 {
                let at = [i, j, k];
                for axis in 0..3 {
                    let mut next = at;
                    next[axis] += 1;
                    let (a, b) = (values[index(at)], values[index(next)]);
                    if (a < 0.0) == (b < 0.0) {
                        continue;
                    }
                    let (s, t) = ((axis + 1) % 3, (axis + 2) % 3);
                    let cell_at = |ds: usize, dt: usize| {
                        let mut cell = at;
                        cell[s] -= ds;
                        cell[t] -= dt;
                        cell
                    };
                    let mut quad = [(1, 1), (0, 1), (0, 0), (1, 0)]
                        .map(|(ds, dt)| vertex_of(&mut mesh, cell_at(ds, dt)));
                    if a > 0.0 {
                        quad.reverse();
                    }
                    mesh.faces.push([quad[0], quad[1], quad[2]]);
                    mesh.faces.push([quad[0], quad[2], quad[3]]);
                }
            }
        }
    }
    mesh.normals = mesh.faces.iter().map(|face| face.map(|v| normals[v as usize])).collect();
    mesh.face_material = vec![0; mesh.faces.len()];
    mesh.boxed(size.max_element())
}
