//! Next-best-view planning for radiance-field capture (NeRF, Gaussian splatting), on whatever holds
//! the camera: no `std`, no heap, no panics, and the same plan bit for bit on x86-64, wasm32 and
//! thumbv7em.
//!
//! An object, candidate camera poses around it, a budget of views. Which photos give the best
//! radiance field, without seeing a photo before choosing its pose and without training a field?
//! SO-NeRF (Lee et al., 2023) answers with four surrogate objectives and a greedy planner; this crate
//! implements them and says where it departs from the paper.
//!
//! ```text
//! pose, camera    conventions, stated once           math    float functions, the same everywhere
//! candidates      view spaces: where a camera may stand, and what it can reach
//! objectives      coverage C, geometry Q, diversity D, texture T: exact, constant memory per face
//! kernels         int8 arithmetic, the same bits everywhere
//! planner         schemes, greedy choice, stop rule, tour; the session and its snapshots
//! Exact           the scorer that knows what each candidate sees of a mesh
//! soarnet         the scorer that predicts from photos: model file, encoder, heads
//! ```
//!
//! A whole capture of an object, here a cube of six faces whose visibility is known:
//!
//! ```
//! use vantage_core::candidates::{Pool, ViewSpace};
//! use vantage_core::objectives::{Face, FaceAccount, FaceSet, Ledger, Reading, Sighting, Surface};
//! use vantage_core::planner::{Fixed, Plan, Session};
//! use vantage_core::{Exact, Objective, Vec3};
//!
//! let sides = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
//! let cube = sides.map(|normal| Face {
//!     centroid: 0.5 * normal,
//!     normal,
//!     area_share: 1.0 / 6.0,
//!     complexity: 1.0,
//! });
//!
//! // What each of 40 candidates sees: a bit for every side that faces it.
//! let pool = Pool::try_new(ViewSpace::FibonacciSphere, 40, 3.0)?;
//! let mut words = [[0u32; 1]; 40];
//! for (word, pose) in words.iter_mut().zip(pool.iter()) {
//!     for (bit, face) in cube.iter().enumerate() {
//!         word[0] |= u32::from((pose.position() - face.centroid).dot(face.normal) > 0.0) << bit;
//!     }
//! }
//! let sightings = words.each_ref().map(|word| Sighting {
//!     faces: FaceSet::new(word),
//!     textured: &[],
//!     textured_background: 0,
//!     pixels: 0,
//! });
//!
//! // The ledger's memory is the caller's; so is the session's.
//! let mut accounts = [FaceAccount::default(); 6];
//! let ledger = Ledger::try_new(Surface::try_new(&cube, 0.0)?, Reading::default(), &mut accounts)?;
//! let scorer = Exact::new(ledger, &sightings);
//! let memory = Fixed::<40, 8>::default();
//! let plan = Plan::single(Objective::Coverage, 4);
//! let mut session = Session::try_new(memory, pool.iter(), scorer, plan)?;
//! while let Some(next) = session.next_view() {
//!     session.observe(next.index, next.pose, &sightings[next.index])?;
//! }
//! assert_eq!(session.scores().coverage, 1.0);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! What we chose not to do: no clock, no waiting, no drawing of pictures, no reading of files. The
//! caller moves the camera and says what happened.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod camera;
pub mod candidates;
mod checksum;
mod exact;
pub mod kernels;
pub mod math;
pub mod objectives;
pub mod planner;
pub mod pose;
#[cfg(feature = "serde")]
pub mod record;
pub mod soarnet;

pub use camera::{Camera, CameraError};
pub use exact::{Exact, ExactSupport};
pub use glam::{Quat, Vec2, Vec3};
pub use objectives::{Objective, Scores};
pub use pose::{Pose, PoseError};
