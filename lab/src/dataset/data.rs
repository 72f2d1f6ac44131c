//! What a data set holds of one object.

use vantage_core::objectives::{Face, FaceAccount, Ledger, Reading, Sighting, Surface};
use vantage_core::{Pose, Scores, Vec3};

use crate::label::Label;

/// Everything about one object. Its mesh is not kept: faces and labels give every exact score.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectData {
    /// A file's stem, or the class and the number.
    pub name: String,
    /// One of [`CLASSES`](crate::mesh::CLASSES), or `file`.
    pub class: String,
    /// The normalised mesh's faces, shape (faces): centroid in the world (the object fills the unit
    /// sphere), unit normal, area share, complexity.
    pub faces: Vec<Face>,
    /// What T is divided by: see [`Surface::try_new`]. From the train views.
    pub texture_limit: f32,
    /// The candidates of the trajectories.
    pub train: Views,
    /// Other views of the same object.
    pub validation: Views,
    /// The views on which reconstructions are scored.
    pub test: TestViews,
    /// Walks over the train views, the even ones by chance alone.
    pub trajectories: Vec<Trajectory>,
}

/// Views with photos and labels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Views {
    /// World from camera, shape (views).
    pub poses: Vec<Pose>,
    /// What each shows of the mesh, at the data set's resolution, shape (views).
    pub labels: Vec<Label>,
    /// sRGB with straight alpha, shape (views, height, width, 4), the top row first.
    pub photos: Vec<u8>,
}

/// Views with masks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TestViews {
    /// World from camera, shape (views).
    pub poses: Vec<Pose>,
    /// 1 where a pixel's centre shows the object, else 0; shape (views, height, width).
    pub masks: Vec<u8>,
}

/// A walk over the train views, and what each further view would have gained.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Indices of the train views in the order of the walk, none twice, shape (steps).
    pub views: Vec<u16>,
    /// After the first view, after the second, and so on; shape (steps).
    pub states: Vec<State>,
}

/// The exact scores of some views, and the exact gains of one more.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// F_n = (C, Q, D, T), before smoothing.
    pub scores: Scores,
    /// F_n+1 - F_n in the order C, Q, D, T, before smoothing, by train view; shape (views, 4). Views
    /// already taken have theirs too.
    pub gains: Vec<[f32; 4]>,
}

impl ObjectData {
    /// The surface of the objectives.
    ///
    /// # Panics
    ///
    /// If the faces were changed so that they are no surface any more.
    pub fn surface(&self) -> Surface<'_> {
        Surface::try_new(&self.faces, self.texture_limit).expect("faces are checked when read")
    }

    /// An empty account over the surface, in the caller's memory: `accounts` is resized.
    ///
    /// With it the exact scores and gains of any views follow:
    /// `ledger.add(pose.position(), &label.sighting())`.
    ///
    /// # Panics
    ///
    /// As [`surface`](Self::surface).
    pub fn ledger<'a>(&'a self, accounts: &'a mut Vec<FaceAccount>) -> Ledger<'a> {
        accounts.resize(self.faces.len(), FaceAccount::default());
        Ledger::try_new(self.surface(), Reading::default(), accounts)
            .expect("there is an account for each face")
    }
}

impl Views {
    /// The photo of one view, shape (height, width, 4).
    ///
    /// # Panics
    ///
    /// Where there is no such view; so do the other methods that take one.
    pub fn photo(&self, view: usize) -> &[u8] {
        let size = self.photos.len() / self.poses.len();
        &self.photos[view * size..(view + 1) * size]
    }

    /// What one view shows.
    pub fn sighting(&self, view: usize) -> Sighting<'_> {
        self.labels[view].sighting()
    }

    /// Where the camera of one view stands, in the world.
    pub fn position(&self, view: usize) -> Vec3 {
        self.poses[view].position()
    }
}

impl TestViews {
    /// The mask of one view, shape (height, width).
    ///
    /// # Panics
    ///
    /// Where there is no such view.
    pub fn mask(&self, view: usize) -> &[u8] {
        let size = self.masks.len() / self.poses.len();
        &self.masks[view * size..(view + 1) * size]
    }
}
