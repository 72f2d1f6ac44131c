//! A capture guided by a microcontroller, without an operating system or a heap.
//!
//! ```text
//!            next view                    reached                     photo
//!  ┌──────┐  LED ring   ┌────────┐  settled   ┌─────────┐  taken   ┌─────────┐
//!  │ plan │────────────▶│  move  │───────────▶│  shoot  │─────────▶│ observe │──┐
//!  └──────┘             └────────┘            └─────────┘          └─────────┘  │
//!   ▲  ▲ │ no view          │ out of reach: block │ failed: skip                │
//!   │  │ ▼                  │ missed: skip        │                             │
//!   │  │ done               ▼                     ▼                             │
//!   │  └──────────────── next view ◀──────────────┘                             │
//!   └───────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! A [`Rig`] is a camera, a mount that moves it, and an indicator; [`guide`] is the loop above.
//!
//! | part | over `embedded-hal` 1.0 |
//! |---|---|
//! | [`Stepper`] | step and direction pins, a ramp of speed |
//! | [`Turntable`] | one stepper turns the object; the camera stands still |
//! | [`PanTilt`] | two steppers carry the camera around the object, within limits |
//! | [`Shutter`] | a pin that releases a camera, whose photos the controller does not see |
//! | [`LedRing`] | lights that point to where the camera must go |
//!
//! `board` holds what one machine has: QEMU's `mps2` boards, and a Raspberry Pi Pico 2, which was
//! built and not run. `README.md` beside this crate says how to use it on a board.
#![no_std]

#[cfg(test)]
extern crate std;

mod board;
mod guide;
mod led_ring;
mod pan_tilt;
mod place;
mod recorded;
mod rig;
mod shutter;
mod stepper;
mod turntable;

#[cfg(all(target_os = "none", any(target_arch = "arm", feature = "pico2")))]
pub use board::*;
pub use guide::{Guidance, Outcome, Step, guide};
pub use led_ring::LedRing;
pub use pan_tilt::PanTilt;
pub use place::Place;
pub use recorded::{CountingPin, Memory, NoWait, RecordedCamera, RecordedMount, recorded_plan};
pub use rig::{Camera, Cue, Indicator, Miss, Mount, Rig};
pub use shutter::Shutter;
pub use stepper::{Ramp, Stepper};
pub use turntable::Turntable;
