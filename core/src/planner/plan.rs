//! What is asked of the planner: the scheme, the budget, and when to stop.

use core::fmt;

use glam::Vec3;

use crate::objectives::Objective;

/// How the next view is chosen. Ties always go to the lowest index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Scheme {
    /// Any candidate, with equal chance.
    Random,
    /// The candidate farthest from every view taken (farthest-point sampling). Needs no scores.
    FarthestPoint,
    /// The candidate that gains most in one objective.
    Single(Objective),
    /// The paper's ensemble: one objective a step, from [`ENSEMBLE`] in turn.
    Ensemble(Phase),
    /// The largest sum of the four gains, each brought to [0, 1] over the candidates.
    Sum,
    /// The candidate that gains most [support](crate::objectives::SupportLedger); where none gains any,
    /// the farthest.
    Support,
}

/// The ensemble's sequence of objectives (algorithm `algo:trajectory`).
pub const ENSEMBLE: [Objective; 6] = [
    Objective::Coverage,
    Objective::Geometry,
    Objective::Geometry,
    Objective::Diversity,
    Objective::Diversity,
    Objective::Texture,
];

/// Where in [`ENSEMBLE`] the first step after the start stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// With coverage, whatever the number of starting views.
    #[default]
    FromStart,
    /// At the step's number, counted from 1, modulo 6: the algorithm to the letter. With three
    /// starting views it begins with the first D.
    Literal,
}

/// How the first views are chosen, before the scheme takes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Start {
    /// The paper's pseudo-coverage: the extreme candidate along +x, +y, +z.
    PseudoCoverage,
    /// One by chance, then the farthest from those taken.
    FarthestPoint,
}

/// When further views are no longer worth it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stop {
    /// A choice is weak if its expected gain is below this, in the objective's own units, where 1 is
    /// all that can be had; of support, about 2.5.
    pub gain: f32,
    /// So many weak choices in a row end the session. Six is once through the ensemble, so that
    /// each objective has had its say.
    pub patience: u16,
}

impl Default for Stop {
    fn default() -> Self {
        Self { gain: 0.005, patience: ENSEMBLE.len() as u16 }
    }
}

/// A whole plan. Made by [`Plan::ensemble`] and its neighbours, varied by the `with_` functions,
/// checked when a session takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plan {
    pub(crate) scheme: Scheme,
    pub(crate) budget: usize,
    pub(crate) start: Start,
    pub(crate) start_views: usize,
    pub(crate) seed: u64,
    pub(crate) movement_cost: f32,
    pub(crate) dispersion: f32,
    pub(crate) opposite: f32,
    pub(crate) stop: Option<Stop>,
    pub(crate) centre: Vec3,
}

/// Why a plan cannot be carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PlanError {
    /// No views are asked for.
    ZeroBudget,
    /// More views are asked for than there are candidates.
    BudgetTooLarge {
        /// Views asked for.
        budget: usize,
        /// Candidates there are.
        candidates: usize,
    },
    /// The movement cost is not in [0, 1].
    BadMovementCost {
        /// The cost given.
        cost: f32,
    },
    /// The dispersion is not in [0, 1].
    BadDispersion {
        /// The share given.
        share: f32,
    },
    /// The weight of opposite sides is not in [0, 1].
    BadOpposite {
        /// The weight given.
        weight: f32,
    },
    /// The stop rule's gain is negative or NaN, or its patience is 0.
    BadStop,
    /// Random and farthest-point schemes expect no gain, so no rule on it can end them.
    StopNeedsObjective,
    /// The centre is not finite.
    BadCentre,
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ZeroBudget => f.write_str("the budget is 0: ask for at least one view"),
            Self::BudgetTooLarge { budget, candidates } => write!(
                f,
                "the budget of {budget} views is larger than the {candidates} candidates: \
                 lower it or add candidates"
            ),
            Self::BadMovementCost { cost } => {
                write!(f, "the movement cost must lie between 0 and 1, not {cost}")
            }
            Self::BadDispersion { share } => {
                write!(f, "the dispersion must lie between 0 and 1, not {share}")
            }
            Self::BadOpposite { weight } => {
                write!(f, "the weight of opposite sides must lie between 0 and 1, not {weight}")
            }
            Self::BadStop => {
                f.write_str("the stop rule needs a gain of at least 0 and a patience of at least 1")
            }
            Self::StopNeedsObjective => f.write_str(
                "the stop rule looks at expected gain, which random and farthest-point plans lack: \
                 leave it out or choose another scheme",
            ),
            Self::BadCentre => f.write_str("the centre of the views must be finite"),
        }
    }
}

impl core::error::Error for PlanError {}

impl Plan {
    /// The views that the paper starts with, and all plans here but those by support and by chance.
    pub const START_VIEWS: usize = 3;

    /// After so many views opposite sides count no more: by then the outline is known from all around,
    /// and what they show of the surface is all new.
    pub const OPPOSITE_VIEWS: usize = 6;

    fn new(scheme: Scheme, budget: usize) -> Self {
        Self {
            scheme,
            budget,
            start: Start::FarthestPoint,
            start_views: Self::START_VIEWS,
            seed: 0,
            movement_cost: 0.0,
            dispersion: 0.0,
            opposite: 0.0,
            stop: None,
            centre: Vec3::ZERO,
        }
    }

    /// The ensemble of objectives: the default scheme.
    pub fn ensemble(budget: usize) -> Self {
        Self::new(Scheme::Ensemble(Phase::FromStart), budget)
    }

    /// The ensemble to the letter: pseudo-coverage start, absolute phase.
    pub fn literal_ensemble(budget: usize) -> Self {
        Self::new(Scheme::Ensemble(Phase::Literal), budget).with_start(Start::PseudoCoverage)
    }

    /// One objective throughout.
    pub fn single(objective: Objective, budget: usize) -> Self {
        Self::new(Scheme::Single(objective), budget)
    }

    /// The sum of the four gains.
    pub fn sum(budget: usize) -> Self {
        Self::new(Scheme::Sum, budget)
    }

    /// The most support from the second view on, among the candidates that stand at least 0.6 of the way
    /// out, where opposite sides count half.
    pub fn support(budget: usize) -> Self {
        let plan = Self::new(Scheme::Support, budget).with_start_views(1);
        plan.with_dispersion(0.6).with_opposite(0.5)
    }

    /// Farthest-point sampling from a candidate drawn by the seed.
    pub fn farthest_point(budget: usize) -> Self {
        Self::new(Scheme::FarthestPoint, budget)
    }

    /// Pseudo-coverage, then farthest-point sampling.
    pub fn pseudo_coverage(budget: usize) -> Self {
        Self::new(Scheme::FarthestPoint, budget).with_start(Start::PseudoCoverage)
    }

    /// Candidates by chance, from the first view on.
    pub fn random(budget: usize) -> Self {
        Self { start_views: 0, ..Self::new(Scheme::Random, budget) }
    }

    /// Another way to the first views.
    pub fn with_start(self, start: Start) -> Self {
        Self { start, ..self }
    }

    /// Another number of first views than the scheme's own: none by chance, one by support, else
    /// [`START_VIEWS`](Self::START_VIEWS); photos taken before the
    /// session may serve as them.
    pub fn with_start_views(self, start_views: usize) -> Self {
        Self { start_views, ..self }
    }

    /// Another seed for what is left to chance: the first view, and the random scheme.
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// A price on moving the camera, in [0, 1]: the share of a candidate's gain that half a turn
    /// around the centre costs it; a smaller move costs in proportion to its angle.
    pub fn with_movement_cost(self, movement_cost: f32) -> Self {
        Self { movement_cost, ..self }
    }

    /// How far from all views so far the next one must be at least, in [0, 1]: as a share of the distance
    /// that the farthest candidate has, opposite sides [as they count](Self::with_opposite). Objectives choose among those only; 0 leaves them all.
    pub fn with_dispersion(self, dispersion: f32) -> Self {
        Self { dispersion, ..self }
    }

    /// How much standing opposite a view counts as standing at it, in [0, 1], until
    /// [`OPPOSITE_VIEWS`](Self::OPPOSITE_VIEWS) have been taken: seen around the centre, a photo from the
    /// opposite side shows the same outline, mirrored. With 0.5 a candidate 10 degrees from there is as
    /// near as one 20 degrees from the view; 0 counts views alone.
    pub fn with_opposite(self, opposite: f32) -> Self {
        Self { opposite, ..self }
    }

    /// A rule that ends the session before its budget is spent.
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop: Some(stop), ..self }
    }

    /// Another centre of the views than the world's origin, metres: the object's middle.
    pub fn with_centre(self, centre: Vec3) -> Self {
        Self { centre, ..self }
    }

    /// How many views are asked for.
    pub fn budget(&self) -> usize {
        self.budget
    }

    /// The centre of the views, metres.
    pub fn centre(&self) -> Vec3 {
        self.centre
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// Says why the plan cannot be carried out over so many candidates, if it cannot.
    pub fn check(&self, candidates: usize) -> Result<(), PlanError> {
        if self.budget == 0 {
            return Err(PlanError::ZeroBudget);
        }
        if self.budget > candidates {
            return Err(PlanError::BudgetTooLarge { budget: self.budget, candidates });
        }
        if !(0.0..=1.0).contains(&self.movement_cost) {
            return Err(PlanError::BadMovementCost { cost: self.movement_cost });
        }
        if !(0.0..=1.0).contains(&self.dispersion) {
            return Err(PlanError::BadDispersion { share: self.dispersion });
        }
        if !(0.0..=1.0).contains(&self.opposite) {
            return Err(PlanError::BadOpposite { weight: self.opposite });
        }
        if let Some(Stop { gain, patience }) = self.stop {
            if !(gain >= 0.0 && patience > 0) {
                return Err(PlanError::BadStop);
            }
            if matches!(self.scheme, Scheme::Random | Scheme::FarthestPoint) {
                return Err(PlanError::StopNeedsObjective);
            }
        }
        if !self.centre.is_finite() {
            return Err(PlanError::BadCentre);
        }
        Ok(())
    }
}
