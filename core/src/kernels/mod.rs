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
//! This is our own requantisation (one rounding), not TensorFlow Lite's (two). `scalar` is the
//! definition; whatever else may be chosen here equals it bit for bit.
//!
//! Numbers of 32 bits are given as their little-endian bytes and weights as bytes, because that is
//! how they lie in a file in flash, at any alignment.

mod scalar;

pub use scalar::{
    accumulate, add_residual, convolve, fully_connected, fully_connected_wide, mean, requantize,
    requantize_wide,
};

/// The most input channels of [`convolve`].
pub const MAX_CHANNELS: usize = 64;

/// The largest sum of an [`Addition`]'s multipliers: `255 · sum + 2^25 + 2^17` stays below 2^31.
///
/// Together the inputs may take steps 31 times as long as the output's.
pub const LARGEST_ADDITION: i32 = (i32::MAX - (1 << 26)) / 255;

/// A linear map, (rows) from (columns).
#[derive(Clone, Copy, Debug, Default)]
pub struct Linear<'a> {
    /// Shape (rows, [`padded`] columns), signed bytes in -127..=127; the padding is 0.
    pub weights: &'a [u8],
    /// Numbers of the input.
    pub columns: usize,
    /// Shape (rows), i32 little-endian.
    pub bias: &'a [[u8; 4]],
    /// Shape (rows), i32 little-endian, units of 2^-32; units of 2^-20 where the output is wide.
    pub multipliers: &'a [[u8; 4]],
    /// The output's zero point.
    pub zero: i8,
    /// The least output: the zero point where negative values are cut off, otherwise -128.
    pub low: i8,
}

impl Linear<'_> {
    /// Bytes from one row of weights to the next, never 0.
    pub fn stride(&self) -> usize {
        padded(self.columns).max(4)
    }
}

/// The length of a row of weights with its padding: the next multiple of 4.
pub const fn padded(columns: usize) -> usize {
    columns.div_ceil(4) * 4
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

#[cfg(test)]
mod tests;
