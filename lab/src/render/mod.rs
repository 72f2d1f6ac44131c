//! Pictures of a mesh: which face each pixel shows, photos, and both at once for labelling.
//!
//! A z-buffer rasteriser for the processor. Its coverage is exact: vertices are rounded to 1/256
//! of a pixel and edges decided in integers with a top-left rule, so that triangles which share an
//! edge leave no gap and share no pixel. A pixel shows what lies at its centre, (0.5, 0.5) from its
//! upper left corner. Of faces at equal depth the lowest index wins. Both sides of a face are seen.
//!
//! Every picture is a function of its arguments alone: threads share views or rows, never a pixel.
//!
//! Not handled: transparency (a surface is there or not), shadows, reflections.
//!
//! ```
//! use vantage_core::{Camera, Pose, Vec3};
//! use vantage_lab::{mesh, render::{PhotoOptions, Renderer}};
//!
//! let mut vase = mesh::builtin("vase", 7).unwrap();
//! mesh::normalise(&mut vase);
//! let renderer = Renderer::new(&vase);
//! let camera = Camera::from_fov(64, 48, 0.8).unwrap();
//! let pose = Pose::looking_at(Vec3::new(2.0, 2.0, 1.0), Vec3::ZERO).unwrap();
//!
//! let seen = renderer.faces(&camera, &pose).visible();
//! assert!(seen.len() > 100 && seen.len() < vase.faces.len());
//! let photo = renderer.photo(&camera, &pose, &PhotoOptions::default());
//! assert_eq!(photo.dimensions(), (64, 48));
//! ```

use std::cell::RefCell;

use image::{Rgba, RgbaImage};
use rayon::prelude::*;
use vantage_core::{Camera, Pose, Vec3};

use self::raster::{Scene, Window};
use self::shade::Shader;
use self::srgb::{encode, linear};
use self::vertex::Projected;
use self::view::View;
use crate::mesh::Mesh;

mod clip;
mod raster;
mod shade;
pub(crate) mod srgb;
#[cfg(test)]
mod tests;
mod texture;
mod vertex;
mod view;

/// Where a pixel shows no face.
pub const NO_FACE: u32 = u32::MAX;

/// Neither side of a picture, times its supersampling, may be longer than this many pixels.
pub const MAX_SIDE: u32 = 32_000;

/// Which face each pixel shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaceImage {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Indices into the mesh's faces, or [`NO_FACE`]; shape (height, width), the top row first.
    pub faces: Vec<u32>,
}

impl FaceImage {
    /// The faces that own at least one pixel, ascending.
    pub fn visible(&self) -> Vec<u32> {
        let mut seen: Vec<u32> = self.faces.iter().copied().filter(|f| *f != NO_FACE).collect();
        seen.sort_unstable();
        seen.dedup();
        seen
    }
}

/// How a photo is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotoOptions {
    /// Samples along each side of a pixel, at least 1.
    pub supersampling: u32,
    /// sRGB colour behind the object; `None` leaves it transparent.
    pub background: Option<[u8; 3]>,
}

impl Default for PhotoOptions {
    fn default() -> Self {
        Self { supersampling: 3, background: None }
    }
}

/// Takes pictures of one mesh; holds a copy of what it needs of it.
pub struct Renderer {
    scene: Scene,
    shader: Shader,
}

/// What one thread needs while it draws a view; kept between views.
#[derive(Default)]
struct Scratch {
    projected: Vec<Projected>, // (vertices)
    keys: Vec<u64>,            // (rows, width), see `raster`
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

impl Renderer {
    /// Prepares a mesh: welds its vertices, lights its corners, shrinks its textures.
    pub fn new(mesh: &Mesh) -> Self {
        Self { scene: Scene::new(mesh), shader: Shader::new(mesh) }
    }

    /// Which face each pixel shows.
    ///
    /// # Panics
    ///
    /// Where a side is longer than [`MAX_SIDE`]; so do the other pictures.
    pub fn faces(&self, camera: &Camera, pose: &Pose) -> FaceImage {
        let view = View::new(camera, pose, 1);
        self.with_keys(&view, |keys| FaceImage {
            width: camera.width,
            height: camera.height,
            faces: keys.iter().map(|&key| raster::face_of(key)).collect(),
        })
    }

    /// [`faces`](Self::faces) of several poses on all threads, in their order.
    pub fn faces_of_all(&self, camera: &Camera, poses: &[Pose]) -> Vec<FaceImage> {
        poses.par_iter().map(|pose| self.faces(camera, pose)).collect()
    }

    /// Which face each pixel shows, and the colour at its centre: transparent black where none.
    ///
    /// One sample a pixel, so that every colour belongs to exactly the face beside it.
    pub fn labelled(&self, camera: &Camera, pose: &Pose) -> (FaceImage, RgbaImage) {
        let faces = self.faces(camera, pose);
        let view = View::new(camera, pose, 1);
        let mut shading = self.shader.start(&self.scene, &view);
        let mut bytes = vec![0; faces.faces.len() * 4];
        let mut pixels = bytes.chunks_exact_mut(4);
        for (y, row) in (0..).zip(faces.faces.chunks_exact(camera.width as usize)) {
            for (x, (&face, pixel)) in (0..).zip(row.iter().zip(&mut pixels)) {
                if face != NO_FACE {
                    let [r, g, b] = shading.light_at(face, x, y).map(encode);
                    pixel.copy_from_slice(&[r, g, b, 255]);
                }
            }
        }
        (faces, rgba(camera, bytes))
    }

    /// A photo with straight alpha: the share of a pixel's samples that show the object.
    ///
    /// Colours are averaged in linear light. Rows are drawn on all threads.
    pub fn photo(&self, camera: &Camera, pose: &Pose, options: &PhotoOptions) -> RgbaImage {
        let n = options.supersampling.max(1);
        let view = View::new(camera, pose, n);
        let mut projected = Vec::new();
        self.scene.project(&view, &mut projected);
        let width = camera.width as usize;
        let mut bytes = vec![0; width * camera.height as usize * 4];
        // Bands of about 2^18 samples: their depths stay in the cache.
        let rows = ((1 << 18) / (width * (n * n) as usize)).max(1);
        bytes.par_chunks_mut(rows * width * 4).enumerate().for_each(|(band, bytes)| {
            let first_row = (band * rows) as u32 * n;
            let window = Window { y0: first_row, rows: (bytes.len() / (width * 4)) as u32 * n };
            self.photo_band(&view, &projected, window, n, options.background, bytes);
        });
        rgba(camera, bytes)
    }

    fn photo_band(
        &self,
        view: &View,
        projected: &[Projected],
        window: Window,
        n: u32,
        background: Option<[u8; 3]>,
        bytes: &mut [u8],
    ) {
        let behind = background.map(|rgb| rgb.map(linear));
        let samples_wide = view.width as usize;
        let all = (n * n) as f32;
        SCRATCH.with_borrow_mut(|scratch| {
            let Scratch { keys, .. } = scratch;
            self.draw(view, projected, window, keys);
            let mut shading = self.shader.start(&self.scene, view);
            let width = samples_wide / n as usize;
            for (row, bytes) in (0..).zip(bytes.chunks_exact_mut(width * 4)) {
                for (column, pixel) in (0..).zip(bytes.chunks_exact_mut(4)) {
                    let (mut sum, mut covered) = ([0.0f32; 3], 0u32);
                    for sample in 0..n * n {
                        let (x, y) = (column * n + sample % n, row * n + sample / n);
                        let face = raster::face_of(keys[y as usize * samples_wide + x as usize]);
                        if face == NO_FACE {
                            continue;
                        }
                        covered += 1;
                        let light = shading.light_at(face, x, window.y0 + y);
                        for (total, part) in sum.iter_mut().zip(light) {
                            *total += part;
                        }
                    }
                    let share = covered as f32 / all;
                    let (rgb, alpha) = match behind {
                        Some(behind) => {
                            let mix = |c: usize| sum[c] / all + behind[c] * (1.0 - share);
                            ([mix(0), mix(1), mix(2)], 1.0)
                        }
                        None => (sum.map(|total| total / covered.max(1) as f32), share),
                    };
                    let [r, g, b] = rgb.map(encode);
                    pixel.copy_from_slice(&[r, g, b, (alpha * 255.0 + 0.5) as u8]);
                }
            }
        });
    }

    /// The unit normal, in the world, of the face that each pixel shows, turned to the camera; zero
    /// where there is none. Shape (height, width), the top row first.
    pub fn normals(&self, camera: &Camera, pose: &Pose) -> Vec<Vec3> {
        let faces = self.faces(camera, pose);
        let view = View::new(camera, pose, 1);
        let mut normals = Vec::with_capacity(faces.faces.len());
        for (y, row) in (0..).zip(faces.faces.chunks_exact(camera.width as usize)) {
            normals.extend((0..).zip(row).map(|(x, &face)| {
                if face == NO_FACE {
                    return Vec3::ZERO;
                }
                let normal = self.shader.normal(face);
                if normal.dot(view.ray(x, y)) > 0.0 { -normal } else { normal }
            }));
        }
        normals
    }

    /// Draws a whole view in this thread's scratch space and hands its keys on.
    fn with_keys<T>(&self, view: &View, use_keys: impl FnOnce(&[u64]) -> T) -> T {
        SCRATCH.with_borrow_mut(|scratch| {
            let Scratch { projected, keys } = scratch;
            self.scene.project(view, projected);
            self.draw(view, projected, Window { y0: 0, rows: view.height }, keys);
            use_keys(keys)
        })
    }

    fn draw(&self, view: &View, projected: &[Projected], window: Window, keys: &mut Vec<u64>) {
        keys.clear();
        keys.resize(window.rows as usize * view.width as usize, 0);
        let mut shading = self.shader.start(&self.scene, view);
        self.scene.draw(
            view,
            projected,
            window,
            keys,
            |face| self.shader.has_holes(face),
            |f, x, y| shading.is_there(f, x, y),
        );
    }
}

fn rgba(camera: &Camera, bytes: Vec<u8>) -> RgbaImage {
    // The buffer was made for this size; an empty picture can only be one without pixels.
    RgbaImage::from_raw(camera.width, camera.height, bytes)
        .unwrap_or_else(|| RgbaImage::from_pixel(camera.width, camera.height, Rgba([0; 4])))
}
