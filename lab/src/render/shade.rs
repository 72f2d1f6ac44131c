//! The colour of a face at a pixel: texture, colours and light.
//!
//! Light is white and fixed in the world, as in a light tent: for a unit normal `n`,
//!
//! `L(n) = 0.45 + 0.25 (1 + n_z) / 2 + 0.30 max(0, (n · l + 0.3) / 1.3)`
//!
//! with `l` towards a large lamp above, to the front and right. So `L` lies in [0.45, 1]: no face
//! is dark, none too bright, and hue and saturation are the surface's own. The side that faces the
//! camera is lit. Light is computed at the corners, from the file's normals where it has some.
//!
//! Where on a face a pixel lies follows from its ray: with corner `a` seen from the eye, edges `p`
//! and `q` and ray `d`, the point `a + u p + v q` on it has `u = d · (q × a) / d · (p × q)` and
//! `v = d · (a × p) / d · (p × q)`. That is perspective-correct, and works for clipped faces too.

use vantage_core::{Vec2, Vec3};

use super::raster::Scene;
use super::texture::Pyramid;
use super::view::View;
use crate::mesh::Mesh;

/// What shading needs of a mesh.
pub(super) struct Shader {
    normals: Vec<Vec3>,          // (faces)
    light: Vec<[[f32; 3]; 2]>,   // (faces, [front, back], corners)
    uvs: Vec<[Vec2; 3]>,         // (faces) or empty
    colours: Vec<[[f32; 3]; 3]>, // (faces) or empty
    density: Vec<f32>,           // (faces), texture pixels per unit of length
    face_material: Vec<u16>,     // (faces)
    materials: Vec<Surface>,
    has_any_holes: bool,
}

struct Surface {
    rgb: [f32; 3],
    alpha: f32,
    alpha_cutoff: Option<f32>,
    texture: Option<Pyramid>,
}

/// Towards the lamp, unit length: (0.36, -0.48, 0.8).
const LAMP: Vec3 = Vec3::new(0.36, -0.48, 0.8);

fn light_of(normal: Vec3) -> f32 {
    let sky = 0.5 * (1.0 + normal.z);
    let lamp = ((normal.dot(LAMP) + 0.3) / 1.3).max(0.0);
    0.45 + 0.25 * sky + 0.30 * lamp
}

impl Shader {
    pub fn new(mesh: &Mesh) -> Self {
        let faces = 0..mesh.faces.len();
        let normals: Vec<Vec3> = faces.clone().map(|face| mesh.normal(face)).collect();
        let light = faces.clone().map(|face| {
            let own = normals[face];
            let corners = mesh.normals.get(face).copied().unwrap_or([own; 3]);
            // Files disagree about which side normals stand on; the winding decides.
            let outwards = corners.map(|n| if n.dot(own) < 0.0 { -n } else { n });
            [outwards.map(light_of), outwards.map(|normal| light_of(-normal))]
        });
        let light = light.collect();
        let materials: Vec<Surface> = mesh
            .materials
            .iter()
            .map(|material| {
                let [r, g, b, alpha] = material.base_colour;
                let texture = material.texture.as_ref().map(Pyramid::new);
                let alpha_cutoff = material.alpha_cutoff;
                Surface { rgb: [r, g, b], alpha, alpha_cutoff, texture }
            })
            .collect();
        let density = faces.map(|face| {
            let texture = materials[usize::from(mesh.face_material[face])].texture.as_ref();
            let (Some(texture), Some([a, b, c])) = (texture, mesh.uvs.get(face)) else {
                return 0.0;
            };
            let uv_area = 0.5 * (*b - *a).perp_dot(*c - *a).abs();
            (uv_area * texture.pixels() / mesh.area(face)).sqrt()
        });
        let density = density.collect();
        Self {
            normals,
            light,
            uvs: mesh.uvs.clone(),
            colours: mesh.colours.clone(),
            density,
            face_material: mesh.face_material.clone(),
            has_any_holes: materials.iter().any(|material| material.alpha_cutoff.is_some()),
            materials,
        }
    }

    /// A face's unit normal by its winding.
    pub fn normal(&self, face: u32) -> Vec3 {
        self.normals[face as usize]
    }

    /// Whether parts of a face may not be there.
    #[inline]
    pub fn has_holes(&self, face: u32) -> bool {
        self.has_any_holes && self.surface(face).alpha_cutoff.is_some()
    }

    fn surface(&self, face: u32) -> &Surface {
        &self.materials[usize::from(self.face_material[face as usize])]
    }

    /// Begins shading a view.
    pub fn start<'a>(&'a self, scene: &'a Scene, view: &'a View) -> Shading<'a> {
        let focal = (view.fx * view.fy).sqrt();
        Shading { shader: self, scene, view, focal, ready: None }
    }
}

/// Shades a view's samples; neighbours mostly show the same face, whose preparation is kept.
pub(super) struct Shading<'a> {
    shader: &'a Shader,
    scene: &'a Scene,
    view: &'a View,
    focal: f32,
    ready: Option<Prepared<'a>>,
}

#[derive(Clone, Copy)]
struct Prepared<'a> {
    face: u32,
    surface: &'a Surface,
    /// See the module's equations.
    u_row: Vec3,
    v_row: Vec3,
    normal: Vec3,
    /// Of the texture.
    level: usize,
}

impl<'a> Shading<'a> {
    /// Linear light that leaves a face towards the eye at a sample, red, green and blue in [0, 1].
    #[inline]
    pub fn light_at(&mut self, face: u32, x: u32, y: u32) -> [f32; 3] {
        let prepared = self.prepared(face);
        let (weights, is_front) = prepared.weights(self.view.ray(x, y));
        let shader = self.shader;
        let light = shader.light[face as usize][usize::from(!is_front)];
        let light = light[0] * weights[0] + light[1] * weights[1] + light[2] * weights[2];
        let mut rgb = prepared.surface.rgb.map(|c| c * light);
        if let Some(texture) = &prepared.surface.texture
            && let Some(uvs) = shader.uvs.get(face as usize)
        {
            let uv = uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2];
            for (c, texel) in rgb.iter_mut().zip(texture.light(prepared.level, uv)) {
                *c *= texel;
            }
        }
        if let Some(colours) = shader.colours.get(face as usize) {
            for (i, c) in rgb.iter_mut().enumerate() {
                *c *= (0..3).map(|corner| colours[corner][i] * weights[corner]).sum::<f32>();
            }
        }
        rgb
    }

    /// Whether a face with holes has any surface at a sample.
    pub fn is_there(&mut self, face: u32, x: u32, y: u32) -> bool {
        let prepared = self.prepared(face);
        let surface = prepared.surface;
        let Some(cutoff) = surface.alpha_cutoff else { return true };
        let (Some(texture), Some(uvs)) = (&surface.texture, self.shader.uvs.get(face as usize))
        else {
            return surface.alpha >= cutoff;
        };
        let (weights, _) = prepared.weights(self.view.ray(x, y));
        let uv = uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2];
        texture.alpha(uv) * surface.alpha >= cutoff
    }

    #[inline]
    fn prepared(&mut self, face: u32) -> Prepared<'a> {
        match self.ready {
            Some(ready) if ready.face == face => ready,
            _ => {
                let ready = self.prepare(face);
                self.ready = Some(ready);
                ready
            }
        }
    }

    fn prepare(&self, face: u32) -> Prepared<'a> {
        let corners = self.scene.faces[face as usize];
        let [a, b, c] = corners.map(|v| self.scene.positions[v as usize] - self.view.eye);
        let (p, q) = (b - a, c - a);
        let surface = self.shader.surface(face);
        let level = surface.texture.as_ref().map_or(0, |texture| {
            // A sample's width on the surface at the face's middle; seen aslant it is longer one
            // way, and the geometric mean of both is a fair compromise between blur and noise.
            let middle = (a + b + c) / 3.0;
            let depth = middle.dot(self.view.forward).max(self.scene.near);
            let slant = self.shader.normal(face).dot(middle).abs() / middle.length();
            let width = depth / (self.focal * slant.max(0.06).sqrt());
            texture.level_for(self.shader.density[face as usize] * width)
        });
        Prepared { face, surface, u_row: q.cross(a), v_row: a.cross(p), normal: p.cross(q), level }
    }
}

impl Prepared<'_> {
    /// The weights of the three corners where a ray meets the face, and whether at its front.
    ///
    /// A vertex is rounded before coverage is decided, so a ray may just miss: then the nearest
    /// edge counts.
    #[inline]
    fn weights(&self, ray: Vec3) -> ([f32; 3], bool) {
        let along = ray.dot(self.normal);
        let inverse = 1.0 / along;
        let mut u = (ray.dot(self.u_row) * inverse).max(0.0);
        let mut v = (ray.dot(self.v_row) * inverse).max(0.0);
        let sum = u + v;
        if sum > 1.0 {
            if sum.is_infinite() {
                (u, v) = (1.0 / 3.0, 1.0 / 3.0); // exactly from the side
            } else {
                u /= sum;
                v /= sum;
            }
        }
        ([1.0 - u - v, u, v], along < 0.0)
    }
}
