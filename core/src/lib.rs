//! Next-best-view planning for radiance-field capture: no `std`, no heap, no panics.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod camera;
pub mod candidates;
pub mod math;
pub mod objectives;
pub mod pose;

pub use camera::{Camera, CameraError};
pub use glam::{Quat, Vec2, Vec3};
pub use objectives::{Objective, Scores};
pub use pose::{Pose, PoseError};
