//! Integer arithmetic on signed bytes, the same bits on every target: no layers, no poses.
//!
//! A tensor holds signed bytes `q` that stand for `scale * (q - zero)`. A linear map multiplies bytes
//! with 32-bit sums and brings each sum back to a byte with a multiplier of its row:
//!
//! ```text
//! sum[r]    = bias[r] + Σ_c weights[r, c] · input[c]              i32; the bias holds the input's zero point
//! output[r] = clamp(round(sum[r] · multiplier[r] / 2^32) + zero, low, 127)        halves up
//! ```
//!
//! This is our own requantisation (one rounding), not TensorFlow Lite's (two). [`scalar`] is the
//! definition; whatever else is chosen here equals it bit for bit, and is chosen here alone:
//!
//! | target | instructions |
//! |---|---|
//! | Cortex-M4 and M7 (thumbv7em) | `arm_dsp`: `smlad` |
//! | WebAssembly built with `-C target-feature=+simd128` | `wasm_simd`: `i32x4.dot_i16x8_s` |
//! | x86-64 | `x86`: `pmaddwd` of SSE2 or AVX2, or `vpdpwssd`, as the processor says that it has them |
//!
//! Elsewhere, and everywhere without the feature `arch`, the definition runs. (`build.rs` names these
//! targets `vantage_…`: a stable compiler does not tell the sources what a Cortex-M has.)
//!
//! Numbers of 32 bits are given as their little-endian bytes and weights as tiles of bytes, because
//! that is how they lie in a file in flash, at any alignment; on a Cortex-M what is not aligned to 4
//! bytes is slow.

pub mod scalar;
mod tile;
#[cfg(any(vantage_dsp, vantage_x86, vantage_wasm))]
#[allow(unsafe_code, reason = "memory that has been measured before")]
mod windows;

#[cfg(any(vantage_x86, vantage_wasm))]
#[allow(unsafe_code, reason = "memory that has been measured before")]
mod vectors;

#[cfg(any(vantage_x86, vantage_wasm))]
#[allow(unsafe_code, reason = "memory that has been measured before")]
mod depthwise;

#[cfg(vantage_dsp)]
#[allow(unsafe_code, reason = "instructions that the language has no name for")]
pub mod arm_dsp;

#[cfg(vantage_wasm)]
#[allow(unsafe_code, reason = "vectors read memory by its address")]
pub mod wasm_simd;

#[cfg(vantage_x86)]
#[allow(unsafe_code, reason = "instructions that not every processor has")]
pub mod x86;

#[cfg(vantage_dsp)]
use arm_dsp as chosen;
#[cfg(not(any(vantage_dsp, vantage_x86, vantage_wasm)))]
use scalar as chosen;
#[cfg(vantage_wasm)]
use wasm_simd as chosen;
#[cfg(vantage_x86)]
use x86 as chosen;

pub use chosen::{
    accumulate, add_residual, convolve, convolve_colours, depthwise, fully_connected,
    fully_connected_wide, pointwise, requantize_all,
};
pub use tile::{EDGE, GROUP, LANES, Order, Tile, pack, unpack};

/// The most input channels of [`convolve`].
pub const MAX_CHANNELS: usize = 64;

/// The largest sum of an [`Addition`]'s multipliers: `255 · sum + 2^25 + 2^17` stays below 2^31.
///
/// Together the inputs may take steps 31 times as long as the output's.
pub const LARGEST_ADDITION: i32 = (i32::MAX - (1 << 26)) / 255;

/// The largest `128 · Σ|weights|` of the second and fourth row of a tile.
pub const LARGEST_SECOND: u32 = (1 << 23) - 1;

/// A linear map, (rows) from (columns).
#[derive(Clone, Copy, Debug, Default)]
pub struct Linear<'a> {
    /// Shape (rows / 4, columns / 4), rounded up; weights in -127..=127, at most [`LARGEST_SECOND`]
    /// in every second row.
    pub weights: &'a [Tile],
    /// Numbers of the input, in memory: [`Order::packed`].
    pub columns: usize,
    /// Shape (rows), i32 little-endian.
    pub bias: &'a [[u8; 4]],
    /// Shape (rows), i32 little-endian, not negative, units of 2^-32; units of 2^-20 where the output is
    /// wide.
    pub multipliers: &'a [[u8; 4]],
    /// The output's zero point.
    pub zero: i8,
    /// The least output: the zero point where negative values are cut off, otherwise -128.
    pub low: i8,
}

impl Linear<'_> {
    /// Tiles from one block of four rows to the next, never 0.
    pub fn stride(&self) -> usize {
        self.columns.div_ceil(EDGE).max(1)
    }
}

/// A square map of pixels with channels, to read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Grid<'a> {
    /// Shape (side, side, channels).
    pub values: &'a [i8],
    /// Pixels of a row.
    pub side: usize,
    /// Numbers of a pixel.
    pub channels: usize,
    /// What stands beyond the border.
    pub border: i8,
}

/// Memory for the widened rows of a map, or for one window. What is in it does not matter.
#[derive(Clone, Debug)]
#[repr(C, align(16))]
pub struct Rows([i16; Rows::LENGTH]);

impl Rows {
    /// Three rows of a map with its border: 32 pixels of 16 channels, 16 of 24 or 32, 8 of 64.
    const LENGTH: usize = 3 * 10 * MAX_CHANNELS;

    /// Zeros, which cost no flash in a `static`.
    pub const fn new() -> Self {
        Self([0; Self::LENGTH])
    }
}

impl Default for Rows {
    fn default() -> Self {
        Self::new()
    }
}

/// The sum of two maps, both brought to the scale of the output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Addition {
    /// What a step of the first input is worth, units of 2^-18 of a step of the output.
    pub multiplier: i32,
    /// The same of the second input.
    pub other_multiplier: i32,
    /// The first input's zero point.
    pub zero_in: i8,
    /// The second input's zero point.
    pub other_zero_in: i8,
    /// The output's zero point, and its least value: negative sums are cut off.
    pub zero: i8,
}

impl Addition {
    /// What does not depend on the inputs: `(zero << 18) + 2^17 - Σ zero_in · multiplier`.
    fn constant(&self) -> i32 {
        (i32::from(self.zero) << 18)
            .wrapping_add(1 << 17)
            .wrapping_sub(i32::from(self.zero_in).wrapping_mul(self.multiplier))
            .wrapping_sub(i32::from(self.other_zero_in).wrapping_mul(self.other_multiplier))
    }
}

/// A sum as a byte: `clamp(round(sum · multiplier / 2^32) + zero, low, 127)`, halves up.
///
/// `((zero << 32) + sum · multiplier + (1 << 31)) >> 32` cannot leave an i64.
#[inline]
pub fn requantize(sum: i32, multiplier: i32, zero: i8, low: i8) -> i8 {
    let product = i64::from(sum) * i64::from(multiplier);
    let value = ((i64::from(zero) << 32) + product + (1 << 31)) >> 32;
    // Not `clamp`, which leaves a panic path where a bound is not a constant.
    value.min(127).max(i64::from(low)) as i8
}

/// A sum as a number of 32 bits: `round(sum · multiplier / 2^20)`, halves up, saturated.
#[inline]
pub fn requantize_wide(sum: i32, multiplier: i32) -> i32 {
    let value = (i64::from(sum) * i64::from(multiplier) + (1 << 19)) >> 20;
    value.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

/// The mean of `count` bytes from their sum, halves up; 0 for none.
#[inline]
pub fn mean(sum: i32, count: i32) -> i8 {
    let mean = (2 * i64::from(sum) + i64::from(count)).checked_div_euclid(2 * i64::from(count));
    mean.unwrap_or(0).clamp(-128, 127) as i8
}

#[cfg(test)]
mod tests;
