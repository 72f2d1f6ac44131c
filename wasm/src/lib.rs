//! Vantage for JavaScript: types over `vantage-core`, no algorithm.
//!
//! ```js
//! const pool = new Pool({ kind: "hemisphere", minElevationRad: 0.1, maxElevationRad: 1.2 }, 60, 0.5);
//! const session = new Session(pool, { scheme: "farthest-point", budget: 20 });
//! for (let next = session.nextView(); next; next = session.nextView()) {
//!   session.observe(next.index);
//! }
//! ```
//!
//! - Whatever is refused is thrown as an `Error` with a stable `code` beside its message.
//! - Lengths are metres, angles radians, poses the rows of `world_from_camera`, shape (3, 4).
//! - Numbers are checked here, because JavaScript would turn -1 into 4294967295 on the way.

mod board;
mod error;
mod input;
mod memory;
mod pool;
mod session;

pub use board::{BoardTracker, frame_quality};
pub use error::Refusal;
pub use pool::Pool;
pub use session::Session;
