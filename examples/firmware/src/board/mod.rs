//! What one machine has, and nothing else: one folder, one board a build.

#[cfg(all(target_os = "none", target_arch = "arm", not(feature = "pico2")))]
mod console;
#[cfg(all(target_os = "none", target_arch = "arm", not(feature = "pico2")))]
mod file_flash;
#[cfg(all(target_os = "none", target_arch = "arm", not(feature = "pico2")))]
mod uart;

#[cfg(all(target_os = "none", target_arch = "arm", not(feature = "pico2")))]
pub use self::{console::*, file_flash::*, uart::*};

#[cfg(all(target_os = "none", feature = "pico2"))]
pub mod pico2;
