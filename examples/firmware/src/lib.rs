//! The board: text to the debugger over semihosting, an exit code, and what happens on a panic.
//!
//! QEMU's `mps2-an386` (Cortex-M4F) runs these programs: `cargo xtask firmware`. On real hardware
//! replace `Console` and `exit` by what the board has; nothing else here touches it. Without a
//! debugger attached, the semihosting breakpoint stops the chip.
#![no_std]

#[cfg(target_os = "none")]
mod board;

#[cfg(target_os = "none")]
pub use board::{Console, exit};
