//! The planner: propose, score, choose, observe.
//!
//! A [`Plan`] says what is asked for, a [`Scorer`] how much a view would bring, and a [`Session`]
//! holds the conversation with whoever moves the camera.

mod choice;
mod memory;
mod plan;
mod scorer;
mod session;
#[cfg(feature = "serde")]
mod snapshot;
mod tour;

pub use memory::{Candidate, Fixed, Memory, Status, View};
pub use plan::{ENSEMBLE, Phase, Plan, PlanError, Scheme, Start, Stop};
pub use scorer::{Blind, Scorer};
pub use session::{Finish, NextView, ObserveError, Reason, Session, SessionError};
#[cfg(feature = "serde")]
pub use snapshot::{Contents, Persist};
pub use tour::shortest_tour;
