//! The definition of every kernel: plain loops, written to be read.
//!
//! Sums wrap where they leave an i32. They do not where, in every row,
//! `128 · Σ|weights| + |bias| < 2^31`, which [`Model::parse`](crate::soarnet::Model::parse) checks.

#[cfg(doc)]
use super::LARGEST_ADDITION;
use super::{Addition, Linear, MAX_CHANNELS};

/// A sum as a byte: `clamp(round(sum · multiplier / 2^32) + zero, low, 127)`, halves up.
///
/// `((zero << 32) + sum · multiplier + (1 << 31)) >> 32` cannot leave an i64.
#[inline]
pub fn requantize(sum: i32, multiplier: i32, zero: i8, low: i8) -> i8 {
    let product = i64::from(sum) * i64::from(multiplier);
    let value = ((i64::from(zero) << 32) + product + (1 << 31)) >> 32;
    value.clamp(i64::from(low), 127) as i8
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

/// `Σ weights[c] · input[c]`, over the shorter of the two.
#[inline]
fn dot(weights: &[u8], input: &[i8]) -> i32 {
    weights.iter().zip(input).fold(0, |sum: i32, (&weight, &value)| {
        sum.wrapping_add(i32::from(weight as i8) * i32::from(value))
    })
}

/// Adds a part of a linear map, without its bias: the columns from `first` on.
///
/// Shapes: `input` (up to columns - first), `sums` (rows).
/// `sums[r] += Σ_c weights[r, first + c] · input[c]`
pub fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]) {
    for (sum, row) in sums.iter_mut().zip(map.weights.chunks_exact(map.stride())) {
        *sum = sum.wrapping_add(dot(row.get(first..).unwrap_or_default(), input));
    }
}

/// A fully connected layer. Shapes: `input` (columns), `output` (rows).
pub fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]) {
    let rows = map.weights.chunks_exact(map.stride());
    for (((row, bias), multiplier), output) in rows.zip(map.bias).zip(map.multipliers).zip(output) {
        let sum = i32::from_le_bytes(*bias).wrapping_add(dot(row, input));
        *output = requantize(sum, i32::from_le_bytes(*multiplier), map.zero, map.low);
    }
}

/// A fully connected layer with numbers of 32 bits. Shapes: `input` (columns), `output` (rows).
pub fn fully_connected_wide(map: &Linear<'_>, input: &[i8], output: &mut [i32]) {
    let rows = map.weights.chunks_exact(map.stride());
    for (((row, bias), multiplier), output) in rows.zip(map.bias).zip(map.multipliers).zip(output) {
        let sum = i32::from_le_bytes(*bias).wrapping_add(dot(row, input));
        *output = requantize_wide(sum, i32::from_le_bytes(*multiplier));
    }
}

/// A convolution with a window of 3 x 3 pixels over a square map; beyond the border stands `border`.
///
/// Shapes: `input` (side, side, channels), weights (rows, 3, 3, channels), `output` (side / stride,
/// side / stride, rows); at most [`MAX_CHANNELS`] channels, more give nothing. The window of output
/// pixel (y, x) is centred on input pixel (stride · y, stride · x).
pub fn convolve(
    map: &Linear<'_>,
    stride: usize,
    side: usize,
    border: i8,
    input: &[i8],
    output: &mut [i8],
) {
    let (channels, rows) = (map.columns / 9, map.bias.len());
    let mut buffer = [0; 9 * MAX_CHANNELS]; // (3, 3, channels)
    let (Some(window), 1.., 1..) = (buffer.get_mut(..9 * channels), channels, rows) else { return };
    let centres = || (0..side).step_by(stride.max(1));
    let places = centres().flat_map(|y| centres().map(move |x| (y, x)));
    for ((y, x), output) in places.zip(output.chunks_exact_mut(rows)) {
        for (place, pixel) in window.chunks_exact_mut(channels).enumerate() {
            // Both are one too large, so that nothing is negative.
            let (y, x) = (y + place / 3, x + place % 3);
            let inside = (1..=side).contains(&y) && (1..=side).contains(&x);
            let from = if inside { ((y - 1) * side + (x - 1)) * channels } else { usize::MAX };
            match input.get(from..from.saturating_add(channels)) {
                Some(values) if inside => pixel.copy_from_slice(values),
                _ => pixel.fill(border),
            }
        }
        fully_connected(map, window, output);
    }
}

/// Adds a map onto another, negative sums cut off. Shapes: `values` and `others` alike.
///
/// ```text
/// values[i] = clamp(((values[i] - zero_in) · multiplier + (others[i] - other_zero_in) · other_multiplier
///                    + (zero << 18) + (1 << 17)) >> 18, zero, 127)
/// ```
///
/// Exact in i32 while neither multiplier is negative and their sum is at most [`LARGEST_ADDITION`].
pub fn add_residual(add: &Addition, values: &mut [i8], others: &[i8]) {
    let constant = (i32::from(add.zero) << 18)
        .wrapping_add(1 << 17)
        .wrapping_sub(i32::from(add.zero_in).wrapping_mul(add.multiplier))
        .wrapping_sub(i32::from(add.other_zero_in).wrapping_mul(add.other_multiplier));
    for (value, &other) in values.iter_mut().zip(others) {
        let sum = constant
            .wrapping_add(i32::from(*value).wrapping_mul(add.multiplier))
            .wrapping_add(i32::from(other).wrapping_mul(add.other_multiplier));
        *value = (sum >> 18).clamp(i32::from(add.zero), 127) as i8;
    }
}
