//! What tells the planner how much a view would bring.

use core::convert::Infallible;

use super::memory::Candidate;
use crate::objectives::{Objective, Scores};
use crate::pose::Pose;

/// Scores views: exactly from a mesh ([`Exact`](crate::Exact)), or by prediction from photos.
///
/// The greedy choice knows nothing else of it.
pub trait Scorer {
    /// What a photo brings: its picture, or what is seen in it. It is borrowed only while it is taken
    /// in, so that one buffer serves all photos.
    type Shot<'s>: ?Sized;
    /// Why a photo cannot be used.
    type Error: core::error::Error;

    /// Takes in a photo that was taken at `pose`.
    ///
    /// After an error nothing has changed.
    fn observe(&mut self, pose: &Pose, shot: &Self::Shot<'_>) -> Result<(), Self::Error>;

    /// What one more photo, of candidate `index` at `pose`, is expected to add to an objective.
    ///
    /// In the objective's own units before smoothing; may be negative. NaN is never chosen.
    fn gain(&self, objective: Objective, index: usize, pose: &Pose) -> f32;

    /// [`gain`](Self::gain) for every available candidate, noted by [`Candidate::set_gain`].
    ///
    /// A scorer that can do better than one after the other says so here; the gains must be equal.
    fn gains(&self, objective: Objective, candidates: &mut [Candidate]) {
        for (index, candidate) in candidates.iter_mut().enumerate() {
            if candidate.is_available() {
                let gain = self.gain(objective, index, candidate.pose());
                candidate.set_gain(objective, gain);
            }
        }
    }

    /// What one more photo, of candidate `index` at `pose`, is expected to add to
    /// [support](crate::objectives::SupportLedger); 0 for a scorer that does not know.
    fn support(&self, _index: usize, _pose: &Pose) -> f32 {
        0.0
    }

    /// Whether a candidate's gain can only fall as photos are added: exactly, not just nearly.
    ///
    /// The planner then asks again only for those that could still win (lazy greedy; Minoux, 1978).
    fn diminishes(&self, _objective: Objective) -> bool {
        false
    }

    /// The scores of the photos so far, before smoothing.
    fn scores(&self) -> Scores;
}

/// A scorer that lies elsewhere, such as in a `static`, so that a session that moves does not move it.
impl<S: Scorer + ?Sized> Scorer for &mut S {
    type Shot<'s> = S::Shot<'s>;
    type Error = S::Error;

    fn observe(&mut self, pose: &Pose, shot: &Self::Shot<'_>) -> Result<(), Self::Error> {
        (**self).observe(pose, shot)
    }

    fn gain(&self, objective: Objective, index: usize, pose: &Pose) -> f32 {
        (**self).gain(objective, index, pose)
    }

    fn gains(&self, objective: Objective, candidates: &mut [Candidate]) {
        (**self).gains(objective, candidates);
    }

    fn support(&self, index: usize, pose: &Pose) -> f32 {
        (**self).support(index, pose)
    }

    fn diminishes(&self, objective: Objective) -> bool {
        (**self).diminishes(objective)
    }

    fn scores(&self) -> Scores {
        (**self).scores()
    }
}

/// Knows nothing: for schemes that look at poses alone.
///
/// Every gain is 0, so a scheme that asks for one takes the candidates in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blind;

impl Scorer for Blind {
    type Shot<'s> = ();
    type Error = Infallible;

    fn observe(&mut self, _pose: &Pose, _shot: &()) -> Result<(), Infallible> {
        Ok(())
    }

    fn gain(&self, _objective: Objective, _index: usize, _pose: &Pose) -> f32 {
        0.0
    }

    fn scores(&self) -> Scores {
        Scores::default()
    }
}
