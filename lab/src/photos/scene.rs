//! One of NeRF's synthetic scenes (Mildenhall et al., 2020): photos to train on and to test by.
//!
//! ```text
//! transforms_train.json, transforms_test.json   camera_angle_x, and frames as in transforms.json
//! train/r_0.png …, test/r_0.png …               straight alpha; the object where it is not 0
//! ```
//!
//! +Z is up. The centre is where the optical axes meet, as for any capture; the radius is that of the
//! least sphere there that holds what the photos to train on show, found from their alpha. Without
//! alpha that is all the pictures show, and the object appears small in it.

use std::path::Path;

use glam::DVec3;
use image::{RgbImage, RgbaImage};
use rayon::prelude::*;
use vantage_core::{Camera, Pose, Vec2};

use super::layout::{Known, Layout, Taken};
use super::window::{self, Light};
use super::{Decoded, PhotosError, WINDOW, decode, taken, transforms};

/// The photos to train on.
pub const TRAIN: &str = "transforms_train.json";

/// The photos to test by.
const TEST: &str = "transforms_test.json";

/// The object's pixels end between samples: so much wider than them is the sphere.
const MARGIN: f64 = 1.02;

/// A scene, its object in the unit sphere.
#[derive(Clone, Debug)]
pub struct Scene {
    /// That of all photos.
    pub camera: Camera,
    /// The photos to train on, in the file's order.
    pub train: Vec<View>,
    /// The photos to test by.
    pub test: Vec<View>,
    layout: Layout,
}

/// A photo, whole.
#[derive(Clone, Debug)]
pub struct View {
    /// World from camera: where it was really taken.
    pub pose: Pose,
    /// Shape (height, width, 4), straight alpha, sRGB.
    pub photo: RgbaImage,
    taken: Taken,
}

impl Scene {
    /// Whether a folder looks like one.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(TRAIN).is_file()
    }

    /// Reads a folder; of the photos to test by so many, spread evenly over the list, or all.
    pub fn open(folder: &Path, test_views: usize) -> Result<Self, PhotosError> {
        let train = split(folder, TRAIN, usize::MAX)?;
        let test = split(folder, TEST, test_views)?;
        let camera = camera_of(&train[0].0)?;
        for (taken, _) in train.iter().chain(&test) {
            if camera_of(taken)? != camera {
                return Err(PhotosError::ManyCameras);
            }
        }
        let cameras: Vec<Taken> = train.iter().map(|(taken, _)| *taken).collect();
        let centre = Layout::of(&cameras, &Known::default(), true)?.centre;
        let reach = train.par_iter().map(|(taken, photo)| reach(taken, photo, centre));
        let radius = reach.reduce(|| 0.0, f64::max);
        if radius == 0.0 {
            return Err(PhotosError::Nothing);
        }
        let known = Known {
            centre: Some(centre.to_array()),
            radius: Some(MARGIN * radius),
            ..Known::default()
        };
        let layout = Layout::of(&cameras, &known, true)?;
        let view = |(taken, photo): (Taken, RgbaImage)| {
            let pose = layout.pose(&taken).map_err(|_| PhotosError::NotFramed)?;
            Ok(View { pose, photo, taken })
        };
        let views = |split: Vec<_>| split.into_iter().map(view).collect::<Result<Vec<_>, _>>();
        Ok(Self { camera, train: views(train)?, test: views(test)?, layout })
    }

    /// What networks are given of a photo to train on: a camera that looks at the object from there
    /// at the distance of their training, and what it shows, shape (64, 64).
    pub fn for_network(&self, View { photo, taken, .. }: &View) -> Result<Looked, PhotosError> {
        let direction = self.layout.direction(taken.position).ok_or(PhotosError::NotFramed)?;
        let pose = self.layout.looking_from(direction).map_err(|_| PhotosError::NotFramed)?;
        let (_, axes) = self.layout.in_file(&pose);
        let (window, _) = window::cut(&Light::of(photo), taken, axes, &self.layout, WINDOW);
        Ok(Looked { pose, window })
    }
}

/// A photo as networks look at it.
#[derive(Clone, Debug)]
pub struct Looked {
    /// World from camera.
    pub pose: Pose,
    /// Shape (64, 64).
    pub window: RgbImage,
}

/// The photos of one list, at most so many, and their cameras.
fn split(
    folder: &Path,
    file: &'static str,
    most: usize,
) -> Result<Vec<(Taken, RgbaImage)>, PhotosError> {
    let path = folder.join(file);
    if !path.is_file() {
        return Err(PhotosError::NoSplit(folder.to_owned(), file));
    }
    let within = |why| PhotosError::Split(file, Box::new(why));
    let frames = transforms::read_file(path).map_err(within)?.frames;
    let count = frames.len().min(most);
    let wanted: Vec<usize> = (0..count).map(|place| place * frames.len() / count).collect();
    let read = |&index: &usize| {
        let frame = &frames[index];
        let decoded = decode(folder, &frame.file);
        let decoded = decoded.map_err(|why| PhotosError::Photo(frame.file.clone(), why))?;
        let usable = (index + 1, frame, decoded);
        let taken = taken(&usable).map_err(within)?;
        let Decoded { small, .. } = usable.2;
        Ok((taken, small))
    };
    wanted.par_iter().map(read).collect()
}

fn camera_of(Taken { lens, .. }: &Taken) -> Result<Camera, PhotosError> {
    let pair = |[x, y]: [f64; 2]| Vec2::new(x as f32, y as f32);
    let [width, height] = lens.size.map(|side| side as u32);
    let camera = Camera::try_new(width, height, pair(lens.focal), pair(lens.centre));
    camera.map_err(|_| PhotosError::ManyCameras)
}

/// The radius of the sphere around the centre that the rays of the object's pixels just touch; 0
/// where there are none.
fn reach(taken: &Taken, photo: &RgbaImage, centre: DVec3) -> f64 {
    let distance = |x: u32, y: u32| {
        let [px, py] = [x, y].map(|at| f64::from(at) + 0.5);
        let ray = taken.ray([px, py]);
        (centre - taken.position).cross(ray).length()
    };
    // The farthest of a row's pixels are its first and its last.
    let of_row = |y: u32| {
        let is_object = |x: &u32| photo.get_pixel(*x, y).0[3] >= 128;
        let first = (0..photo.width()).find(is_object)?;
        let last = (0..photo.width()).rev().find(is_object)?;
        Some(distance(first, y).max(distance(last, y)))
    };
    (0..photo.height()).filter_map(of_row).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use image::Rgba;
    use tempfile::TempDir;
    use vantage_core::Vec3;

    use super::*;
    use crate::export::{self, Capture, Profile};
    use crate::mesh::{self, Mesh};
    use crate::pool::{DISTANCE, FOV_X_RAD};
    use crate::render::{PhotoOptions, Renderer};

    fn vase() -> Mesh {
        let mut mesh = mesh::class("vase", 1).unwrap();
        mesh::normalise(&mut mesh);
        mesh
    }

    fn camera() -> Camera {
        Camera::from_fov(80, 80, FOV_X_RAD).unwrap()
    }

    /// Photos of a mesh from a ring of places, which looks down from above and from below.
    fn capture(mesh: &Mesh, count: usize) -> Capture {
        let renderer = Renderer::new(mesh);
        let photo = |index: usize| {
            let azimuth = index as f32 / count as f32 * std::f32::consts::TAU;
            let place = Vec3::new(azimuth.cos(), azimuth.sin(), (2.0 * azimuth).sin() * 0.6);
            let pose = Pose::looking_at(place.normalize() * DISTANCE, Vec3::ZERO).unwrap();
            let image = renderer.photo(&camera(), &pose, &PhotoOptions::default());
            export::Photo { pose, image }
        };
        Capture { camera: camera(), photos: (0..count).map(photo).collect(), points: Vec::new() }
    }

    fn folder(train: &Capture, test: &Capture) -> TempDir {
        let home = tempfile::tempdir().unwrap();
        let profile = Profile::NerfSynthetic { val: None, test };
        export::write(&home.path().join("scene"), profile, train).unwrap();
        home
    }

    fn open(home: &TempDir, test_views: usize) -> Result<Scene, PhotosError> {
        Scene::open(&home.path().join("scene"), test_views)
    }

    #[test]
    fn the_object_fills_the_unit_sphere() {
        let mesh = vase();
        let (train, test) = (capture(&mesh, 12), capture(&mesh, 7));
        let home = folder(&train, &test);
        let scene = open(&home, 3).unwrap();
        assert!(Scene::is_in(&home.path().join("scene")) && !Scene::is_in(home.path()));
        assert_eq!((scene.train.len(), scene.test.len()), (12, 3));
        assert_eq!((scene.camera.width, scene.camera.height), (80, 80));
        assert!((scene.camera.fx - camera().fx).abs() < 1e-3);
        let Layout { centre, radius, .. } = scene.layout;
        assert!(centre.length() < 1e-5, "{centre}");
        assert!((0.93..1.03).contains(&radius), "{radius}");
        for (view, photo) in scene.train.iter().zip(&train.photos) {
            let place = photo.pose.position() / radius as f32;
            assert!(view.pose.position().distance(place) < 1e-4);
            assert!(view.pose.forward().distance(photo.pose.forward()) < 1e-4);
            assert_eq!(view.photo, photo.image);
        }
        // Spread evenly over the seven.
        for (view, index) in scene.test.iter().zip([0, 2, 4]) {
            assert_eq!(view.photo, test.photos[index].image);
        }
        assert_eq!(open(&home, 200).unwrap().test.len(), 7);
    }

    #[test]
    fn networks_are_given_what_they_were_trained_on() {
        let mesh = vase();
        let home = folder(&capture(&mesh, 6), &capture(&mesh, 1));
        let scene = open(&home, 1).unwrap();
        let looked = scene.for_network(&scene.train[2]).unwrap();
        assert!((looked.pose.position().length() - DISTANCE).abs() < 1e-4);
        let training = Camera::from_fov(WINDOW, WINDOW, FOV_X_RAD).unwrap();
        let options = PhotoOptions { background: Some([128; 3]), ..PhotoOptions::default() };
        let expected = Renderer::new(&mesh).photo(&training, &looked.pose, &options);
        let difference: f64 = (looked.window.pixels().zip(expected.pixels()))
            .map(|(a, b)| (0..3).map(|c| f64::from(a.0[c].abs_diff(b.0[c]))).sum::<f64>() / 3.0)
            .sum::<f64>()
            / f64::from(WINDOW * WINDOW);
        assert!(difference < 3.0, "{difference}");
    }

    #[test]
    fn what_is_missing_or_uneven_is_said() {
        let mesh = vase();
        let (train, test) = (capture(&mesh, 4), capture(&mesh, 2));
        let says = |home: &TempDir| open(home, 9).unwrap_err().to_string();

        let home = folder(&train, &test);
        fs::remove_file(home.path().join("scene/test/r_1.png")).unwrap();
        assert!(says(&home).contains("./test/r_1 cannot be used: there is no such file"));
        fs::remove_file(home.path().join("scene").join(TEST)).unwrap();
        assert!(says(&home).contains("holds no transforms_test.json"));

        let home = folder(&train, &test);
        let list = home.path().join("scene").join(TRAIN);
        let text = fs::read_to_string(&list).unwrap();
        fs::write(&list, text.replace("transform_matrix", "matrix")).unwrap();
        assert!(says(&home).contains("frame 1 of transforms_train.json"), "{}", says(&home));

        let mut small = test.clone();
        small.camera = camera().resized(40, 40).unwrap();
        for photo in &mut small.photos {
            photo.image = RgbaImage::new(40, 40);
        }
        assert!(says(&folder(&train, &small)).contains("more than one camera"));

        let mut empty = train.clone();
        for photo in &mut empty.photos {
            photo.image = RgbaImage::from_pixel(80, 80, Rgba([9, 9, 9, 0]));
        }
        assert!(says(&folder(&empty, &test)).contains("show nothing"));
    }
}
