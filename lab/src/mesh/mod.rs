//! Textured triangle meshes: from a file, or made here from a name and a seed.
//!
//! A mesh as loaded or built stands in its **object** frame, which is y-up as in glTF and OBJ.
//! [`normalise`] brings it into the world: +Z up, inside the unit sphere around the origin.
//!
//! Colours that are numbers ([`Material::base_colour`], [`Mesh::colours`]) are linear light in
//! [0, 1]; colours that are pixels ([`Texture::image`]) are sRGB with straight alpha. UVs follow
//! glTF: (0, 0) is the upper left corner of the image and v grows downwards.
//!
//! ```
//! use vantage_lab::mesh;
//! let mut vase = mesh::builtin("vase", 7).unwrap();
//! let world_from_object = mesh::normalise(&mut vase);
//! assert!(vase.faces.len() > 1000);
//! assert!(vase.positions.iter().all(|p| p.length() < 1.001));
//! # let _ = world_from_object;
//! ```

use std::collections::HashMap;
use std::sync::Arc;

use image::RgbaImage;
use vantage_core::{Vec2, Vec3};

mod builtin;
mod classes;
pub mod colour;
#[cfg(test)]
mod file_tests;
mod gltf;
pub(crate) mod kit;
mod load;
mod normalise;
mod obj;
mod shapes;
mod source;

pub use builtin::{BUILTIN, builtin, noisy_blob};
pub use classes::{CLASSES, class};
pub(crate) use kit::Chance;
pub use load::{Format, LoadError, Loaded, from_bytes, load};
pub use normalise::normalise;
pub use source::Problem;

/// Triangles with materials; every surface is seen from both sides.
///
/// The corner attributes are empty where the source has none, else as long as `faces`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices, shape (vertices), finite.
    pub positions: Vec<Vec3>,
    /// Indices into `positions`, shape (faces), anticlockwise seen from outside; none degenerate.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinates of each face's corners, shape (faces) or empty.
    pub uvs: Vec<[Vec2; 3]>,
    /// Unit normals of each face's corners, for smooth shading only, shape (faces) or empty.
    pub normals: Vec<[Vec3; 3]>,
    /// Linear colours of each face's corners, multiplied with the material's, (faces) or empty.
    pub colours: Vec<[[f32; 3]; 3]>,
    /// Index into `materials` of each face, shape (faces).
    pub face_material: Vec<u16>,
    /// At least one, all in range of `face_material`.
    pub materials: Vec<Material>,
}

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file, or a made-up one.
    pub name: String,
    /// Red, green, blue in linear light and alpha, each in [0, 1]; multiplies the texture.
    pub base_colour: [f32; 4],
    /// The picture on it, if any.
    pub texture: Option<Texture>,
    /// Where the alpha of texture times base colour is below this, there is no surface.
    pub alpha_cutoff: Option<f32>,
}

impl Material {
    /// A material of one colour, in linear light.
    pub fn plain(name: &str, rgb: [f32; 3]) -> Self {
        let [r, g, b] = rgb;
        Self {
            name: name.to_owned(),
            base_colour: [r, g, b, 1.0],
            texture: None,
            alpha_cutoff: None,
        }
    }
}

/// A picture and how it goes on beyond its edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// sRGB, straight alpha; may be shared between materials.
    pub image: Arc<RgbaImage>,
    /// For u and for v.
    pub wrap: [Wrap; 2],
}

/// What a texture coordinate outside [0, 1] means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture starts again.
    #[default]
    Repeat,
    /// The picture starts again, every second time mirrored.
    Mirror,
    /// The edge's colour goes on.
    Clamp,
}

impl Mesh {
    /// The three corners of a face.
    ///
    /// # Panics
    ///
    /// Where `face` is not below `faces.len()`; so do the other methods that take a face.
    pub fn corners(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|vertex| self.positions[vertex as usize])
    }

    /// The mean of a face's corners.
    pub fn centroid(&self, face: usize) -> Vec3 {
        let [a, b, c] = self.corners(face);
        (a + b + c) / 3.0
    }

    /// A face's unit normal, towards the side from which its corners run anticlockwise; zero for a
    /// face without area.
    pub fn normal(&self, face: usize) -> Vec3 {
        let cross = self.cross(face);
        let length = cross.length();
        if length > 0.0 { (cross / length).as_vec3() } else { Vec3::ZERO }
    }

    /// A face's area, in squared units of `positions`.
    pub fn area(&self, face: usize) -> f32 {
        (0.5 * self.cross(face).length()) as f32
    }

    /// In double precision: the square of a small edge underflows a single one.
    fn cross(&self, face: usize) -> glam::DVec3 {
        let [a, b, c] = self.corners(face).map(|corner| corner.as_dvec3());
        (b - a).cross(c - a)
    }

    /// For each vertex the lowest index of a vertex at the same place, shape (vertices).
    ///
    /// Files repeat a vertex wherever its normal or UV changes; adjacency needs it once. Places are
    /// the same that fall into the same cell of a grid of 1e-6 of the mesh's longest extent.
    pub fn welded(&self) -> Vec<u32> {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &position in &self.positions {
            low = low.min(position);
            high = high.max(position);
        }
        let cell = (f64::from((high - low).max_element()) * 1e-6).max(f64::MIN_POSITIVE);
        let mut first = HashMap::with_capacity(self.positions.len());
        let welded = self.positions.iter().zip(0u32..).map(|(&position, index)| {
            let place = (position - low).as_dvec3() / cell;
            let key = place.to_array().map(|steps| (steps + 0.5).floor() as i64);
            *first.entry(key).or_insert(index)
        });
        welded.collect()
    }

    /// Appends another mesh, its vertices and materials behind those here.
    ///
    /// Where only one of the two has a corner attribute the other's faces get UV 0, white, or no
    /// normal (zero) in its place.
    pub(crate) fn append(&mut self, other: Mesh) {
        fn join<T: Clone>(mine: &mut Vec<T>, faces: [usize; 2], theirs: Vec<T>, blank: T) {
            if !(mine.is_empty() && theirs.is_empty()) {
                mine.resize(faces[0], blank.clone());
                mine.extend(theirs);
                mine.resize(faces[0] + faces[1], blank);
            }
        }
        let faces = [self.faces.len(), other.faces.len()];
        let first_vertex = self.positions.len() as u32;
        let first_material = self.materials.len() as u16;
        self.positions.extend(other.positions);
        self.faces.extend(other.faces.iter().map(|face| face.map(|v| v + first_vertex)));
        join(&mut self.uvs, faces, other.uvs, [Vec2::ZERO; 3]);
        join(&mut self.normals, faces, other.normals, [Vec3::ZERO; 3]);
        join(&mut self.colours, faces, other.colours, [[1.0; 3]; 3]);
        self.face_material.extend(other.face_material.iter().map(|m| m + first_material));
        self.materials.extend(other.materials);
    }

    /// Appends a face with the attributes of another one, for building filtered copies.
    fn push_face_of(&mut self, other: &Mesh, face: usize) {
        self.faces.push(other.faces[face]);
        self.face_material.push(other.face_material[face]);
        self.uvs.extend(other.uvs.get(face));
        self.normals.extend(other.normals.get(face));
        self.colours.extend(other.colours.get(face));
    }

    /// Drops the faces for which `keep` says no.
    pub(crate) fn retain_faces(&mut self, keep: impl Fn(&Mesh, usize) -> bool) {
        let mut kept = Mesh::default();
        for face in 0..self.faces.len() {
            if keep(self, face) {
                kept.push_face_of(self, face);
            }
        }
        kept.positions = std::mem::take(&mut self.positions);
        kept.materials = std::mem::take(&mut self.materials);
        *self = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::X * 2.0],
            faces: vec![[0, 1, 2], [2, 3, 0]],
            face_material: vec![0, 0],
            materials: vec![Material::plain("grey", [0.5; 3])],
            ..Mesh::default()
        }
    }

    #[test]
    fn a_right_angled_triangle_has_its_textbook_figures() {
        let mesh = triangle();
        assert_eq!(mesh.area(0), 2.0);
        assert_eq!(mesh.normal(0), Vec3::Z);
        assert_eq!(mesh.normal(1), Vec3::NEG_Z);
        assert!((mesh.centroid(0) - Vec3::new(2.0, 2.0, 0.0) / 3.0).length() < 1e-7);
    }

    #[test]
    fn welding_names_the_first_vertex_at_a_place() {
        assert_eq!(triangle().welded(), [0, 1, 2, 1]);
    }

    #[test]
    fn tiny_faces_have_normals_too() {
        let mut mesh = triangle();
        for position in &mut mesh.positions {
            *position *= 1e-20;
        }
        assert_eq!(mesh.normal(0), Vec3::Z);
    }
}
