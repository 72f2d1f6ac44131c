//! The exact scorers: they know what every candidate sees of the mesh.

use core::convert::Infallible;

use crate::objectives::{Glimpse, Ledger, Objective, Scores, Sighting, SupportLedger};
#[cfg(feature = "serde")]
use crate::planner::Persist;
use crate::planner::Scorer;
use crate::pose::Pose;
#[cfg(feature = "serde")]
use crate::record::{Sink, SnapshotError, Source};

/// Scores views by the [`Ledger`] of a mesh and each candidate's [`Sighting`].
///
/// A photo's shot is what it really shows, which is the candidate's own sighting only if the camera
/// really stood there.
#[derive(Debug)]
pub struct Exact<'a> {
    ledger: Ledger<'a>,
    sightings: &'a [Sighting<'a>], // (candidates), in the session's order
}

impl<'a> Exact<'a> {
    /// A scorer over candidates that show `sightings`, in the session's order.
    ///
    /// A candidate without a sighting gains nothing.
    pub fn new(ledger: Ledger<'a>, sightings: &'a [Sighting<'a>]) -> Self {
        Self { ledger, sightings }
    }

    /// The account of what has been seen.
    pub fn ledger(&self) -> &Ledger<'a> {
        &self.ledger
    }
}

impl<'a> Scorer for Exact<'a> {
    type Shot<'s> = Sighting<'a>;
    type Error = Infallible;

    fn observe(&mut self, pose: &Pose, shot: &Sighting<'a>) -> Result<(), Infallible> {
        self.ledger.add(pose.position(), shot);
        Ok(())
    }

    fn gain(&self, objective: Objective, index: usize, pose: &Pose) -> f32 {
        let sighting = self.sightings.get(index);
        sighting.map_or(0.0, |sighting| self.ledger.gain(objective, pose.position(), sighting))
    }

    fn diminishes(&self, objective: Objective) -> bool {
        self.ledger.diminishes(objective)
    }

    fn scores(&self) -> Scores {
        self.ledger.scores()
    }
}

#[cfg(feature = "serde")]
impl Persist for Exact<'_> {
    fn fingerprint(&self) -> u32 {
        self.ledger.fingerprint()
    }

    fn save(&self, sink: &mut Sink<'_>) -> Result<(), SnapshotError> {
        self.ledger.save(sink)
    }

    fn load(&mut self, source: &mut Source<'_>) -> Result<(), SnapshotError> {
        self.ledger.load(source)
    }
}

/// Scores views by the [`SupportLedger`] of a mesh and each candidate's [`Glimpse`]: for
/// [`Plan::support`](crate::planner::Plan::support). The four objectives are not known to it: 0.
#[derive(Debug)]
pub struct ExactSupport<'a> {
    ledger: SupportLedger<'a>,
    glimpses: &'a [Glimpse<'a>], // (candidates), in the session's order
}

impl<'a> ExactSupport<'a> {
    /// A scorer over candidates that show `glimpses`, in the session's order.
    ///
    /// A candidate without a glimpse gains nothing.
    pub fn new(ledger: SupportLedger<'a>, glimpses: &'a [Glimpse<'a>]) -> Self {
        Self { ledger, glimpses }
    }

    /// The account of what has been seen.
    pub fn ledger(&self) -> &SupportLedger<'a> {
        &self.ledger
    }
}

impl<'a> Scorer for ExactSupport<'a> {
    type Shot<'s> = Glimpse<'a>;
    type Error = Infallible;

    fn observe(&mut self, pose: &Pose, shot: &Glimpse<'a>) -> Result<(), Infallible> {
        self.ledger.add(pose.position(), shot);
        Ok(())
    }

    fn gain(&self, _objective: Objective, _index: usize, _pose: &Pose) -> f32 {
        0.0
    }

    fn support(&self, index: usize, pose: &Pose) -> f32 {
        let glimpse = self.glimpses.get(index);
        glimpse.map_or(0.0, |glimpse| self.ledger.gain(pose.position(), glimpse))
    }

    fn scores(&self) -> Scores {
        Scores::default()
    }
}
