//! Text and exit code over semihosting, for the two programs of this package.
#![no_std]

#[cfg(target_os = "none")]
mod board;

#[cfg(target_os = "none")]
pub use board::{Text, exit};
