//! The loop, turned inside out: the planner says where to stand next and is told what happened. It
//! never waits, reads a clock or allocates.

use core::fmt;

use glam::Vec3;

use super::choice::{self, Apart, Choice, Movement};
use super::memory::{Candidate, Memory, Status, View};
use super::plan::{ENSEMBLE, Phase, Plan, PlanError, Scheme};
use super::scorer::Scorer;
use super::tour::shortest_tour;
use crate::objectives::{Objective, Scores};
use crate::pose::Pose;

/// A capture in progress.
///
/// ```
/// use vantage_core::candidates::{Pool, ViewSpace};
/// use vantage_core::planner::{Blind, Fixed, Plan, Session};
///
/// let pool = Pool::try_new(ViewSpace::FibonacciSphere, 60, 0.4)?;
/// let memory = Fixed::<64, 16>::default();
/// let mut session = Session::try_new(memory, pool.iter(), Blind, Plan::farthest_point(8))?;
/// while let Some(next) = session.next_view() {
///     // Move the camera to next.pose; if it cannot get there, block the view and ask again.
///     if next.pose.position().z < -0.3 {
///         session.block(next.index)?;
///     } else {
///         session.observe(next.index, next.pose, &())?;
///     }
/// }
/// assert_eq!(session.views().len(), 8);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Session<S, M> {
    pub(super) memory: M,
    pub(super) scorer: S,
    pub(super) plan: Plan,
    pub(super) draws: u64, // choices settled so far, photographed or not
    pub(super) weak: u16,  // photos in a row of less gain than the stop rule asks for
    pub(super) pending: Option<NextView>, // chosen and not yet settled
}

/// The next view, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NextView {
    /// Its index among the candidates.
    pub index: usize,
    /// Where to stand.
    pub pose: Pose,
    /// The objective that chose it, if one did.
    pub objective: Option<Objective>,
    /// The gain expected of it: of the objective, before smoothing; of the mean of all four in the
    /// sum scheme; of support; for farthest points the distance to the nearest view in metres, or to a
    /// view's opposite side [as it counts](Plan::with_opposite); 0 for the first views and for chance.
    pub gain: f32,
    /// Why it was chosen.
    pub reason: Reason,
}

/// Why a view was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Reason {
    /// One of the first views.
    Start,
    /// By chance.
    Chance,
    /// It is the farthest from all views so far.
    Farthest,
    /// It gains most in an objective.
    Objective(Objective),
    /// It gains most over all four objectives together.
    AllObjectives,
    /// It gains most support: see [`SupportLedger`](crate::objectives::SupportLedger).
    Support,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "first look",
            Self::Chance => "by chance",
            Self::Farthest => "farthest yet",
            Self::Objective(Objective::Coverage) => "most new surface expected",
            Self::Objective(Objective::Geometry) => "most fine shape left to see",
            Self::Objective(Objective::Diversity) => "most new viewing directions",
            Self::Objective(Objective::Texture) => "most surface detail left to see",
            Self::AllObjectives => "most gain over all four objectives",
            Self::Support => "least seen from near here",
        })
    }
}

/// Why there is no next view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Finish {
    /// As many views as asked for have been taken.
    BudgetSpent,
    /// The stop rule: further views promise too little.
    GoodEnough,
    /// Every candidate has been visited, blocked or skipped.
    NothingLeft,
}

/// What a session refuses. Nothing has changed where it does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SessionError {
    /// The plan cannot be carried out.
    Plan(PlanError),
    /// There are more candidates than the memory holds.
    TooManyCandidates {
        /// How many it holds.
        capacity: usize,
    },
    /// There are more views than the memory holds.
    TooManyViews {
        /// How many it holds.
        capacity: usize,
    },
    /// There is no candidate of this index.
    UnknownCandidate {
        /// The index given.
        index: usize,
        /// Candidates there are.
        candidates: usize,
    },
}

impl fmt::Display for SessionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plan(error) => error.fmt(f),
            Self::TooManyCandidates { capacity } => {
                write!(f, "the session has room for {capacity} candidates and was given more")
            }
            Self::TooManyViews { capacity } => {
                write!(f, "the session has room for {capacity} views and needs more")
            }
            Self::UnknownCandidate { index, candidates } => {
                write!(f, "there is no candidate {index}: the session has {candidates}")
            }
        }
    }
}

impl core::error::Error for SessionError {}

impl From<PlanError> for SessionError {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

/// Why a photo was not taken in. Nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObserveError<E> {
    /// The session has no room or no such candidate.
    Session(SessionError),
    /// The scorer cannot use the photo.
    Scorer(E),
}

impl<E: fmt::Display> fmt::Display for ObserveError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Session(error) => error.fmt(f),
            Self::Scorer(error) => error.fmt(f),
        }
    }
}

impl<E: core::error::Error> core::error::Error for ObserveError<E> {}

impl<S: Scorer, M: Memory> Session<S, M> {
    /// A session over candidates, in the caller's memory, which is cleared first.
    pub fn try_new(
        mut memory: M,
        candidates: impl IntoIterator<Item = Pose>,
        scorer: S,
        plan: Plan,
    ) -> Result<Self, SessionError> {
        memory.clear();
        for pose in candidates {
            if memory.push_candidate(Candidate::new(pose)).is_err() {
                return Err(SessionError::TooManyCandidates {
                    capacity: memory.candidates().len(),
                });
            }
        }
        let session = Self { memory, scorer, plan, draws: 0, weak: 0, pending: None };
        session.check(&plan)?;
        Ok(session)
    }

    fn check(&self, plan: &Plan) -> Result<(), SessionError> {
        plan.check(self.memory.candidates().len())?;
        let capacity = self.memory.view_capacity();
        if plan.budget > capacity {
            return Err(SessionError::TooManyViews { capacity });
        }
        Ok(())
    }

    /// Where to stand next, or `None` when the session is over: see [`finish`](Self::finish).
    ///
    /// Asking again gives the same answer until a photo is taken in, a candidate changes its status
    /// or the plan is changed.
    pub fn next_view(&mut self) -> Option<NextView> {
        if self.pending.is_none() {
            self.pending = self.choose();
        }
        self.pending
    }

    pub(super) fn choose(&mut self) -> Option<NextView> {
        let step = self.memory.views().len();
        if step >= self.plan.budget || self.is_good_enough() {
            return None;
        }
        let Plan { scheme, start, start_views, seed, movement_cost, centre, .. } = self.plan;
        let movement = Movement::new(movement_cost, centre, self.memory.views());
        let chance = (seed, self.draws);
        let candidates = self.memory.candidates_mut();
        let opposite = if step < Plan::OPPOSITE_VIEWS { self.plan.opposite } else { 0.0 };
        let apart = Apart::new(candidates, opposite, self.plan.dispersion);
        let (choice, objective, reason) = if step < start_views {
            let choice = choice::by_start(start, step, candidates, centre, movement, apart, chance);
            (choice.map(|choice| Choice { gain: 0.0, ..choice }), None, Reason::Start)
        } else {
            match scheme {
                Scheme::Random => {
                    (choice::by_chance(candidates, chance.0, chance.1), None, Reason::Chance)
                }
                Scheme::FarthestPoint => {
                    let choice = choice::farthest(candidates, movement, apart, chance);
                    (choice, None, Reason::Farthest)
                }
                Scheme::Single(_) | Scheme::Ensemble(_) => {
                    let objective = objective_of(scheme, step, start_views)?;
                    let choice = choice::by_objective(
                        &self.scorer,
                        objective,
                        candidates,
                        step,
                        movement,
                        apart,
                    );
                    (choice, Some(objective), Reason::Objective(objective))
                }
                Scheme::Sum => {
                    let choice = choice::by_sum(&self.scorer, candidates, step, movement, apart);
                    (choice, None, Reason::AllObjectives)
                }
                Scheme::Support => {
                    let choice = choice::by_support(&self.scorer, candidates, movement, apart);
                    match choice.filter(|choice| choice.gain > 0.0) {
                        // A scorer that does not know support, or an object that no photo shows.
                        None => {
                            let choice = choice::farthest(candidates, movement, apart, chance);
                            (choice, None, Reason::Farthest)
                        }
                        some => (some, None, Reason::Support),
                    }
                }
            }
        };
        let Choice { index, gain } = choice?;
        let pose = *candidates.get(index)?.pose();
        Some(NextView { index, pose, objective, gain, reason })
    }

    /// Takes in the photo of a candidate, at the pose that was really reached.
    ///
    /// The candidate need not be the one that was asked for, and may have been visited before.
    pub fn observe(
        &mut self,
        index: usize,
        pose: Pose,
        shot: &S::Shot<'_>,
    ) -> Result<(), ObserveError<S::Error>> {
        self.candidate(index).map_err(ObserveError::Session)?;
        self.take_in(Some(index), pose, shot)
    }

    /// Takes in a photo that was taken anywhere, for no candidate.
    pub fn observe_elsewhere(
        &mut self,
        pose: Pose,
        shot: &S::Shot<'_>,
    ) -> Result<(), ObserveError<S::Error>> {
        self.take_in(None, pose, shot)
    }

    fn take_in(
        &mut self,
        index: Option<usize>,
        pose: Pose,
        shot: &S::Shot<'_>,
    ) -> Result<(), ObserveError<S::Error>> {
        let capacity = self.memory.view_capacity();
        if self.memory.views().len() >= capacity {
            return Err(ObserveError::Session(SessionError::TooManyViews { capacity }));
        }
        self.scorer.observe(&pose, shot).map_err(ObserveError::Scorer)?;
        let chosen = self.pending.filter(|next| Some(next.index) == index);
        let view = View {
            pose,
            candidate: index,
            objective: chosen.and_then(|next| next.objective),
            gain: chosen.map_or(0.0, |next| next.gain),
        };
        if self.memory.push_view(view).is_err() {
            return Err(ObserveError::Session(SessionError::TooManyViews { capacity }));
        }
        for (place, candidate) in self.memory.candidates_mut().iter_mut().enumerate() {
            candidate.see(pose.position(), self.plan.centre);
            if Some(place) == index {
                candidate.status = Status::Visited;
            } else if candidate.status == Status::Skipped {
                candidate.status = Status::Available;
            }
        }
        if let (Some(stop), Some(next)) = (self.plan.stop, chosen) {
            let expected = matches!(
                next.reason,
                Reason::Objective(_) | Reason::AllObjectives | Reason::Support
            );
            if expected {
                self.weak = if next.gain < stop.gain { self.weak.saturating_add(1) } else { 0 };
            }
        }
        self.settle();
        Ok(())
    }

    /// Marks a candidate as out of reach, for good or until it is [`unblock`](Self::unblock)ed.
    pub fn block(&mut self, index: usize) -> Result<(), SessionError> {
        self.set_status(index, Status::Blocked)
    }

    /// Marks a blocked or skipped candidate as within reach again.
    pub fn unblock(&mut self, index: usize) -> Result<(), SessionError> {
        self.set_status(index, Status::Available)
    }

    /// Passes over a candidate until another photo has been taken. A blocked one stays blocked.
    pub fn skip(&mut self, index: usize) -> Result<(), SessionError> {
        self.set_status(index, Status::Skipped)
    }

    fn set_status(&mut self, index: usize, status: Status) -> Result<(), SessionError> {
        let candidates = self.memory.candidates().len();
        let unknown = SessionError::UnknownCandidate { index, candidates };
        let candidate = self.memory.candidates_mut().get_mut(index).ok_or(unknown)?;
        let stays = match candidate.status {
            Status::Visited => true,
            Status::Blocked => status == Status::Skipped,
            Status::Available | Status::Skipped => false,
        };
        if !stays && candidate.status != status {
            candidate.status = status;
            self.settle();
        }
        Ok(())
    }

    /// The last choice has been dealt with; the next one is made when it is asked for.
    fn settle(&mut self) {
        self.pending = None;
        self.draws = self.draws.wrapping_add(1);
    }

    /// Goes on with another plan; views, blocked candidates and scores stay.
    pub fn replan(&mut self, plan: Plan) -> Result<(), SessionError> {
        self.check(&plan)?;
        if plan.centre != self.plan.centre {
            self.measure(plan.centre);
        }
        self.plan = plan;
        self.weak = 0;
        self.pending = None;
        Ok(())
    }

    /// Tells the candidates how far they are from the views around a centre.
    fn measure(&mut self, centre: Vec3) {
        for candidate in self.memory.candidates_mut() {
            candidate.unsee();
        }
        for index in 0..self.memory.views().len() {
            let Some(view) = self.memory.views().get(index) else { break };
            let eye = view.pose.position();
            for candidate in self.memory.candidates_mut() {
                candidate.see(eye, centre);
            }
        }
    }

    /// Why there is no next view; `None` while there is one.
    pub fn finish(&mut self) -> Option<Finish> {
        if self.next_view().is_some() {
            None
        } else if self.memory.views().len() >= self.plan.budget {
            Some(Finish::BudgetSpent)
        } else if self.is_good_enough() {
            Some(Finish::GoodEnough)
        } else {
            Some(Finish::NothingLeft)
        }
    }

    fn is_good_enough(&self) -> bool {
        self.plan.stop.is_some_and(|stop| self.weak >= stop.patience)
    }

    /// Puts candidates into the order that moves the camera least, from the last view on; gives the
    /// length of the way in radians around the plan's centre. Indices that do not exist stay last.
    pub fn order_by_travel(&self, remaining: &mut [usize]) -> f32 {
        let centre = self.plan.centre;
        let start = self.memory.views().last().map(|view| view.pose.position() - centre);
        let place = |index: usize| {
            let candidate = self.memory.candidates().get(index);
            candidate.map_or(Vec3::ZERO, |c| c.pose().position() - centre)
        };
        shortest_tour(start, place, remaining)
    }

    /// All candidates with their gains in one objective brought up to date.
    pub fn score_all(&mut self, objective: Objective) -> &[Candidate] {
        let now = (self.memory.views().len() as u32).saturating_add(1);
        choice::refresh(&self.scorer, objective, self.memory.candidates_mut(), now);
        self.memory.candidates()
    }

    /// The scores of the views so far, before smoothing.
    pub fn scores(&self) -> Scores {
        self.scorer.scores()
    }

    /// The views taken, in order.
    pub fn views(&self) -> &[View] {
        self.memory.views()
    }

    /// The candidates, in order.
    pub fn candidates(&self) -> &[Candidate] {
        self.memory.candidates()
    }

    /// One candidate.
    pub fn candidate(&self, index: usize) -> Result<&Candidate, SessionError> {
        let candidates = self.memory.candidates();
        let unknown = SessionError::UnknownCandidate { index, candidates: candidates.len() };
        candidates.get(index).ok_or(unknown)
    }

    /// The plan being carried out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The scorer.
    pub fn scorer(&self) -> &S {
        &self.scorer
    }

    /// Hands memory and scorer back.
    pub fn into_parts(self) -> (M, S) {
        (self.memory, self.scorer)
    }

    /// A session as it stood, for [`restore`](Self::restore).
    #[cfg(feature = "serde")]
    pub(super) fn from_parts(memory: M, scorer: S, plan: Plan, draws: u64, weak: u16) -> Self {
        Self { memory, scorer, plan, draws, weak, pending: None }
    }
}

/// The objective of a step of a single-objective or ensemble scheme; steps count from 0.
fn objective_of(scheme: Scheme, step: usize, start_views: usize) -> Option<Objective> {
    let place = match scheme {
        Scheme::Single(objective) => return Some(objective),
        Scheme::Ensemble(Phase::FromStart) => step.saturating_sub(start_views),
        Scheme::Ensemble(Phase::Literal) => step + 1,
        Scheme::Random | Scheme::FarthestPoint | Scheme::Sum | Scheme::Support => return None,
    };
    ENSEMBLE.get(place % ENSEMBLE.len()).copied()
}
