//! Vantage for C: `include/vantage.h`, which `cargo xtask header` writes from these sources.
//!
//! - Memory is the caller's: one block for a session, asked for by `vantage_session_size`. There is no
//!   heap and no global state.
//! - Every call returns a status. All arguments are checked, null pointers too; what cannot be checked
//!   (that a pointer leads to as many bytes as is said) is the caller's promise, under `# Safety`.
//! - Numbers of enumerations come in as `uint32_t`, because C may pass any number.
//! - Nothing here plans: the functions turn C's types into the core's and call it.
#![no_std]

// On a computer the archive takes its panic handler from there.
#[cfg(not(target_os = "none"))]
extern crate std;

#[cfg(target_os = "none")]
mod halt;
mod memory;
mod pose;
mod session;
mod status;
mod types;

#[cfg(test)]
mod tests;

/// The version of this interface: it changes when a program must be compiled again.
pub const VANTAGE_ABI: u32 = 1;

/// Bytes of a session that do not depend on its candidates and views: for `VANTAGE_SESSION_SIZE`.
pub const VANTAGE_SESSION_BYTES: usize = 81_152;
/// Bytes for each candidate, for models of the default sizes.
pub const VANTAGE_CANDIDATE_BYTES: usize = 528;
/// Bytes for each view, for models of the default sizes.
pub const VANTAGE_VIEW_BYTES: usize = 628;

/// The version of the interface that the library was built with; compare it with `VANTAGE_ABI`.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn vantage_abi() -> u32 {
    VANTAGE_ABI
}

/// The library's version, such as "0.1.0".
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn vantage_version() -> *const core::ffi::c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}
