//! Exact planning on the host: a labelled object, and whole plans over it.

use std::convert::Infallible;
use std::time::Instant;

use anyhow::{Context, Result};
use rayon::prelude::*;
use vantage_core::objectives::{Face, FaceAccount, Ledger, Reading, Sighting, Surface};
use vantage_core::planner::{Candidate, NextView, Plan, Scheme, Scorer, Session};
use vantage_core::{Camera, Exact, ExactSupport, Objective, Pose, Scores};

use crate::heap::Heap;
use crate::label::{self, Label};
use crate::mesh::Mesh;
use crate::render::Renderer;
use crate::support::Support;
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
    support: Option<Support>,
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
        Self { poses, reading, faces, labels, texture_limit, support: None }
    }

    /// The same with what plans by support need of the mesh.
    pub fn with_support(self, mesh: &Mesh) -> Result<Self> {
        let support = Some(Support::new(mesh, &self.poses)?);
        Ok(Self { support, ..self })
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
    pub fn run(&self, plan: Plan, done: impl FnMut()) -> Result<Vec<Step>> {
        match plan.scheme() {
            Scheme::Support => self.run_support(plan, done),
            _ => self.run_then(plan, usize::MAX, plan, done),
        }
    }

    /// The first views of a plan, as every plan begins that does not say otherwise, and then
    /// candidates by chance.
    pub fn random_after_start(&self, budget: usize, seed: u64) -> Result<Vec<Step>> {
        let start = Plan::farthest_point(budget).with_seed(seed);
        self.run_then(start, Plan::START_VIEWS, Plan::random(budget).with_seed(seed), || {})
    }

    /// So many views by one plan, the rest by another.
    fn run_then(
        &self,
        first: Plan,
        views: usize,
        then: Plan,
        mut done: impl FnMut(),
    ) -> Result<Vec<Step>> {
        let sightings = self.sightings();
        let mut accounts = vec![FaceAccount::default(); self.faces.len()];
        let ledger = Ledger::try_new(self.surface()?, self.reading, &mut accounts)?;
        let scorer = Parallel(Exact::new(ledger, &sightings));
        let start = Instant::now();
        let candidates = self.poses.iter().copied();
        let mut session = Session::try_new(Heap::default(), candidates, scorer, first)?;
        let mut steps = Vec::with_capacity(first.budget());
        while let Some(next) = session.next_view() {
            session.observe(next.index, next.pose, &sightings[next.index])?;
            let seconds = start.elapsed().as_secs_f64();
            steps.push(Step { next, scores: session.scores(), seconds });
            done();
            if steps.len() == views {
                session.replan(then)?;
            }
        }
        Ok(steps)
    }

    fn run_support(&self, plan: Plan, mut done: impl FnMut()) -> Result<Vec<Step>> {
        let support =
            self.support.as_ref().context("what candidates support has not been looked at")?;
        let sightings = self.sightings();
        let mut accounts = vec![FaceAccount::default(); self.faces.len()];
        let mut ledger = Ledger::try_new(self.surface()?, self.reading, &mut accounts)?;
        let glimpses = support.glimpses();
        let (mut sums, mut empty) = support.memory();
        let scorer = ExactSupport::new(support.ledger(&mut sums, &mut empty)?, &glimpses);
        let start = Instant::now();
        let candidates = self.poses.iter().copied();
        let mut session = Session::try_new(Heap::default(), candidates, scorer, plan)?;
        let mut steps = Vec::with_capacity(plan.budget());
        while let Some(next) = session.next_view() {
            session.observe(next.index, next.pose, &glimpses[next.index])?;
            ledger.add(next.pose.position(), &sightings[next.index]);
            let seconds = start.elapsed().as_secs_f64();
            steps.push(Step { next, scores: ledger.scores(), seconds });
            done();
        }
        Ok(steps)
    }

    /// The exact gains of every candidate in each objective, after the first `from` views of a
    /// list, after one more, and so on, the last of the list being left out.
    ///
    /// Shape (list - from, 4, candidates); views already taken have theirs too.
    pub fn gains_along(&self, views: &[usize], from: usize) -> Result<Vec<[Vec<f32>; 4]>> {
        let sightings = self.sightings();
        let mut accounts = vec![FaceAccount::default(); self.faces.len()];
        let mut ledger = Ledger::try_new(self.surface()?, self.reading, &mut accounts)?;
        let mut gains = Vec::new();
        for (taken, &view) in views.iter().enumerate() {
            if taken >= from {
                gains.push(Objective::ALL.map(|objective| {
                    let gain = |(pose, sighting): (&Pose, &Sighting<'_>)| {
                        ledger.gain(objective, pose.position(), sighting)
                    };
                    self.poses.par_iter().zip(&sightings).map(gain).collect()
                }));
            }
            ledger.add(self.poses[view].position(), &sightings[view]);
        }
        Ok(gains)
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
