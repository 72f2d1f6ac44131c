//! Vantage for JavaScript: types over `vantage-core`, no algorithm.
//!
//! ```js
//! const model = new Model(bytesOfTheModelFile);
//! const pool = new Pool({ kind: "hemisphere", minElevationRad: 0.1, maxElevationRad: 1.2 }, 100, 0.5);
//! const session = new Session(pool, { scheme: "support", budget: 20 }, model);
//! for (let next = session.nextView(); next; next = session.nextView()) {
//!   const { pixels, width, height } = await photographFrom(next.pose);
//!   session.observe(next.index, { pixels, width, height, format: "rgba" });
//! }
//! ```
//!
//! - Whatever is refused is thrown as an `Error` with a stable `code` beside its message.
//! - Lengths are metres, angles radians, poses the rows of `world_from_camera`, shape (3, 4).
//! - Numbers are checked here, because JavaScript would turn -1 into 4294967295 on the way; arrays too,
//!   because a length of 2^40 would end the module where it could be refused.

mod board;
mod error;
mod input;
mod memory;
mod mesh;
mod model;
mod output;
mod photo;
mod plan;
mod pool;
mod session;

pub use board::{BoardTracker, frame_quality};
pub use error::Refusal;
pub use mesh::MeshLedger;
pub use model::Model;
pub use pool::Pool;
pub use session::Session;
