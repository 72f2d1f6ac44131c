//! Where a session keeps its candidates and views: in whatever memory its owner has.

use glam::Vec3;
use heapless::Vec;

use crate::objectives::Objective;
use crate::pose::Pose;

/// What has become of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// It may be chosen.
    Available,
    /// A photo was taken of it.
    Visited,
    /// Not now: it may be chosen again once another photo has been taken.
    Skipped,
    /// It cannot be reached.
    Blocked,
}

/// A view that may be chosen.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    pose: Pose,
    pub(super) status: Status,
    nearest_squared: f32, // squared distance to the nearest view, metres²; infinite at first
    opposite_squared: f32, // to the nearest place opposite a view, likewise
    gains: [f32; 4],      // as last asked, by objective
    asked: [u32; 4],      // after how many views, plus one; 0 for never
}

impl Candidate {
    pub(super) fn new(pose: Pose) -> Self {
        Self {
            pose,
            status: Status::Available,
            nearest_squared: f32::INFINITY,
            opposite_squared: f32::INFINITY,
            gains: [0.0; 4],
            asked: [0; 4],
        }
    }

    /// Where it stands.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// What has become of it.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Whether it may be chosen now.
    pub fn is_available(&self) -> bool {
        self.status == Status::Available
    }

    /// Takes a view's distance into account, around the centre of the views.
    pub(super) fn see(&mut self, view: Vec3, centre: Vec3) {
        let here = self.pose.position();
        self.nearest_squared = self.nearest_squared.min(here.distance_squared(view));
        let opposite = here.distance_squared(2.0 * centre - view);
        self.opposite_squared = self.opposite_squared.min(opposite);
    }

    /// Forgets all distances.
    pub(super) fn unsee(&mut self) {
        (self.nearest_squared, self.opposite_squared) = (f32::INFINITY, f32::INFINITY);
    }

    /// How far it is from the views, squared, metres²: the nearest one, or the nearest place opposite one,
    /// that distance divided by `opposite` if this is not 0.
    pub(super) fn apart_squared(&self, opposite: f32) -> f32 {
        if opposite > 0.0 {
            self.nearest_squared.min(self.opposite_squared / (opposite * opposite))
        } else {
            self.nearest_squared
        }
    }

    /// The gain in an objective as last asked, which may be some views ago; 0 where never.
    pub fn gain(&self, objective: Objective) -> f32 {
        let [coverage, geometry, diversity, texture] = self.gains;
        match objective {
            Objective::Coverage => coverage,
            Objective::Geometry => geometry,
            Objective::Diversity => diversity,
            Objective::Texture => texture,
        }
    }

    /// Notes the gain in an objective: what a [`Scorer`](super::Scorer) does with its answers.
    pub fn set_gain(&mut self, objective: Objective, gain: f32) {
        if let Some(place) = self.gains.get_mut(objective as usize) {
            *place = gain;
        }
    }

    /// After how many views, plus one, the gain was last asked; 0 for never.
    pub(super) fn asked(&self, objective: Objective) -> u32 {
        self.asked.get(objective as usize).copied().unwrap_or_default()
    }

    pub(super) fn set_asked(&mut self, objective: Objective, stamp: u32) {
        if let Some(place) = self.asked.get_mut(objective as usize) {
            *place = stamp;
        }
    }
}

/// A photo that was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct View {
    /// Where it was really taken.
    pub pose: Pose,
    /// The candidate that it was taken for, if any.
    pub candidate: Option<usize>,
    /// The objective that chose it, if one did.
    pub objective: Option<Objective>,
    /// The gain expected when it was chosen; 0 if it was not the planner's choice.
    pub gain: f32,
}

/// The lists of a session. [`Fixed`] is the one for a controller.
pub trait Memory {
    /// The candidates, in order.
    fn candidates(&self) -> &[Candidate];
    /// The candidates, to change.
    fn candidates_mut(&mut self) -> &mut [Candidate];
    /// Adds a candidate; hands it back where there is no room.
    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate>;
    /// The views taken, in order.
    fn views(&self) -> &[View];
    /// Adds a view; hands it back where there is no room.
    fn push_view(&mut self, view: View) -> Result<(), View>;
    /// How many views there is room for.
    fn view_capacity(&self) -> usize;
    /// Forgets everything.
    fn clear(&mut self);
}

/// Lists that lie elsewhere, such as in a `static`, so that a session that moves does not move them.
impl<M: Memory + ?Sized> Memory for &mut M {
    fn candidates(&self) -> &[Candidate] {
        (**self).candidates()
    }

    fn candidates_mut(&mut self) -> &mut [Candidate] {
        (**self).candidates_mut()
    }

    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate> {
        (**self).push_candidate(candidate)
    }

    fn views(&self) -> &[View] {
        (**self).views()
    }

    fn push_view(&mut self, view: View) -> Result<(), View> {
        (**self).push_view(view)
    }

    fn view_capacity(&self) -> usize {
        (**self).view_capacity()
    }

    fn clear(&mut self) {
        (**self).clear();
    }
}

/// Room for a fixed number of candidates and views, without a heap.
#[derive(Clone, Debug, Default)]
pub struct Fixed<const CANDIDATES: usize, const VIEWS: usize> {
    candidates: Vec<Candidate, CANDIDATES>,
    views: Vec<View, VIEWS>,
}

impl<const CANDIDATES: usize, const VIEWS: usize> Fixed<CANDIDATES, VIEWS> {
    /// Empty memory, for a `static`.
    pub const fn new() -> Self {
        Self { candidates: Vec::new(), views: Vec::new() }
    }
}

impl<const CANDIDATES: usize, const VIEWS: usize> Memory for Fixed<CANDIDATES, VIEWS> {
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn candidates_mut(&mut self) -> &mut [Candidate] {
        &mut self.candidates
    }

    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate> {
        self.candidates.push(candidate)
    }

    fn views(&self) -> &[View] {
        &self.views
    }

    fn push_view(&mut self, view: View) -> Result<(), View> {
        self.views.push(view)
    }

    fn view_capacity(&self) -> usize {
        VIEWS
    }

    fn clear(&mut self) {
        self.candidates.clear();
        self.views.clear();
    }
}
