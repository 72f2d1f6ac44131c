//! What makes a set of views good: the four surrogate objectives of SO-NeRF (Lee et al., 2023),
//! computed exactly from what each view shows of a mesh.
//!
//! [`Ledger`] keeps the account as views are added and tells what a further one would gain;
//! [`Reading`] says where we follow the paper to the letter and where we depart from it.
//! [`SupportLedger`] is an objective of our own, which follows the quality of radiance fields closer.

mod diversity;
mod ledger;
mod reading;
mod scores;
mod support;
mod surface;
mod texture;

pub(crate) use diversity::inlier_weight;
pub use ledger::{FaceAccount, Ledger, LedgerError};
pub use reading::{Form, Reading};
pub use scores::{Objective, Scores, smoothing};
pub use support::{Glimpse, SupportError, SupportLedger, Target};
pub use surface::{Face, FaceSet, Sighting, Surface, SurfaceError};
pub use texture::{FLAT, hue_saturation, local_binary_pattern};
