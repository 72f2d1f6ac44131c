//! Next-best-view planning for radiance-field capture: no `std`, no heap, no panics.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod camera;
pub mod candidates;
mod exact;
pub mod math;
pub mod objectives;
pub mod planner;
pub mod pose;
#[cfg(feature = "serde")]
pub mod record;

pub use camera::{Camera, CameraError};
pub use exact::Exact;
pub use glam::{Quat, Vec2, Vec3};
pub use objectives::{Objective, Scores};
pub use pose::{Pose, PoseError};
