//! What makes a set of views good: the four surrogate objectives of SO-NeRF (Lee et al., 2023).

mod scores;

pub use scores::{Objective, Scores, smoothing};
