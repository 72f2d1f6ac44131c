//! Exact planning on the host: a labelled object, and whole plans over it.

use std::convert::Infallible;
use std::time::Instant;

use anyhow::{Context, Result};
use rayon::prelude::*;
use vantage_core::objectives::{Face, FaceAccount, Ledger, Reading, Sighting, Surface};
use vantage_core::planner::{Candidate, NextView, Plan, Scorer, Session};
use vantage_core::{Camera, Exact, Objective, Pose, Scores};

use crate::heap::Heap;
use crate::label::{self, Label};
use crate::mesh::Mesh;
use crate::render::Renderer;
use crate::surface;

/// A mesh with a candidate pool, and what each candidate shows of it.
pub struct Labelled {
    /// The candidates, in order.
    pub poses: Vec<Pose>,
    /// The reading under which the labels hold.
    pub reading: Reading,
    faces: Vec<Face>,
    labels: Vec<Label>,
    texture_limit: f32,
}

/// One step of a finished plan.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The view and why it was chosen.
    pub next: NextView,
    /// The scores once it is taken.
    pub scores: Scores,
    /// Seconds from the start of planning until then.
    pub seconds: f64,
}

impl Labelled {
    /// Renders and labels every candidate at `camera`; `done` is called after each.
    pub fn new(
        mesh: &Mesh,
        camera: &Camera,
        poses: Vec<Pose>,
        reading: Reading,
        done: impl Fn() + Sync,
    ) -> Self {
        let faces = surface::faces(mesh, reading.sigma_q);
        let labels =
            label::label_all(&Renderer::new(mesh), camera, &poses, faces.len(), &reading, done);
        let texture_limit = label::texture_limit(&labels, faces.len(), &reading);
        Self { poses, reading, faces, labels, texture_limit }
    }

    /// The mesh's faces.
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// What each candidate shows.
    pub fn sightings(&self) -> Vec<Sighting<'_>> {
        self.labels.iter().map(Label::sighting).collect()
    }

    /// The surface of the objectives.
    pub fn surface(&self) -> Result<Surface<'_>> {
        Surface::try_new(&self.faces, self.texture_limit).context("the mesh cannot be scored")
    }

    /// Carries a plan out, every photo being taken where it was asked for.
    ///
    /// `done` is called after each view.
    pub fn run(&self, plan: Plan, mut done: impl FnMut()) -> Result<Vec<Step>> {
        let sightings = self.sightings();
        let mut accounts = vec![FaceAccount::default(); self.faces.len()];
        let ledger = Ledger::try_new(self.surface()?, self.reading, &mut accounts)?;
        let scorer = Parallel(Exact::new(ledger, &sightings));
        let memory = Heap::default();
        let start = Instant::now();
        let mut session = Session::try_new(memory, self.poses.iter().copied(), scorer, plan)?;
        let mut steps = Vec::with_capacity(plan.budget());
        while let Some(next) = session.next_view() {
            session.observe(next.index, next.pose, &sightings[next.index])?;
            let seconds = start.elapsed().as_secs_f64();
            steps.push(Step { next, scores: session.scores(), seconds });
            done();
        }
        Ok(steps)
    }
}

/// [`Exact`], asking for all candidates' gains on all cores. The gains are the same.
struct Parallel<'a>(Exact<'a>);

impl<'a> Scorer for Parallel<'a> {
    type Shot<'s> = Sighting<'a>;
    type Error = Infallible;

    fn observe(&mut self, pose: &Pose, shot: &Sighting<'a>) -> Result<(), Infallible> {
        self.0.observe(pose, shot)
    }

    fn gain(&self, objective: Objective, index: usize, pose: &Pose) -> f32 {
        self.0.gain(objective, index, pose)
    }

    fn gains(&self, objective: Objective, candidates: &mut [Candidate]) {
        candidates.par_iter_mut().enumerate().for_each(|(index, candidate)| {
            if candidate.is_available() {
                let gain = self.0.gain(objective, index, candidate.pose());
                candidate.set_gain(objective, gain);
            }
        });
    }

    fn diminishes(&self, objective: Objective) -> bool {
        self.0.diminishes(objective)
    }

    fn scores(&self) -> Scores {
        self.0.scores()
    }
}
