//! The definition of every kernel: plain loops, written to be read.
//!
//! Sums wrap where they leave an i32. They do not where, in every row,
//! `128 · Σ|weights| + |bias| < 2^31`, which [`Model::parse`](crate::soarnet::Model::parse) checks.

#[cfg(doc)]
use super::LARGEST_ADDITION;
use super::{
    Addition, EDGE, GROUP, Grid, Linear, MAX_CHANNELS, Rows, Tile, requantize, requantize_wide,
    unpack,
};

/// Adds `Σ weights[r, c] · input[c]` to the sums of four rows; what is missing of the input is 0.
#[inline]
fn add_tiles(tiles: &[Tile], input: &[i8], sums: &mut [i32; EDGE]) {
    for (tile, input) in tiles.iter().zip(input.chunks(EDGE)) {
        for (sum, weights) in sums.iter_mut().zip(unpack(tile)) {
            for (weight, &value) in weights.into_iter().zip(input) {
                *sum = sum.wrapping_add(i32::from(weight) * i32::from(value));
            }
        }
    }
}

/// The sums of four rows, beginning with their bias.
#[inline]
fn sums(tiles: &[Tile], bias: &[[u8; 4]], input: &[i8]) -> [i32; EDGE] {
    let mut sums = [0; EDGE];
    for (sum, bias) in sums.iter_mut().zip(bias) {
        *sum = i32::from_le_bytes(*bias);
    }
    add_tiles(tiles, input, &mut sums);
    sums
}

/// Adds a part of a linear map, without its bias: the columns from `first` on, a multiple of 4.
///
/// Shapes: `input` (up to columns - first), `sums` (rows).
/// `sums[r] += Σ_c weights[r, first + c] · input[c]`
pub fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]) {
    for (sums, tiles) in sums.chunks_mut(EDGE).zip(map.weights.chunks_exact(map.stride())) {
        let mut block = [0; EDGE];
        add_tiles(tiles.get(first / EDGE..).unwrap_or_default(), input, &mut block);
        for (sum, more) in sums.iter_mut().zip(block) {
            *sum = sum.wrapping_add(more);
        }
    }
}

/// Brings sums to bytes. Shapes: `sums` and `output` (rows).
pub fn requantize_all(map: &Linear<'_>, sums: &[i32], output: &mut [i8]) {
    for ((output, &sum), multiplier) in output.iter_mut().zip(sums).zip(map.multipliers) {
        *output = requantize(sum, i32::from_le_bytes(*multiplier), map.zero, map.low);
    }
}

/// A fully connected layer. Shapes: `input` (columns), `output` (rows).
pub fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]) {
    let rows = map.bias.chunks(EDGE).zip(map.multipliers.chunks(EDGE));
    let tiles = map.weights.chunks_exact(map.stride());
    for ((tiles, (bias, multipliers)), output) in tiles.zip(rows).zip(output.chunks_mut(EDGE)) {
        let sums = sums(tiles, bias, input);
        for ((output, sum), multiplier) in output.iter_mut().zip(sums).zip(multipliers) {
            *output = requantize(sum, i32::from_le_bytes(*multiplier), map.zero, map.low);
        }
    }
}

/// A fully connected layer with numbers of 32 bits. Shapes: `input` (columns), `output` (rows).
pub fn fully_connected_wide(map: &Linear<'_>, input: &[i8], output: &mut [i32]) {
    let rows = map.bias.chunks(EDGE).zip(map.multipliers.chunks(EDGE));
    let tiles = map.weights.chunks_exact(map.stride());
    for ((tiles, (bias, multipliers)), output) in tiles.zip(rows).zip(output.chunks_mut(EDGE)) {
        let sums = sums(tiles, bias, input);
        for ((output, sum), multiplier) in output.iter_mut().zip(sums).zip(multipliers) {
            *output = requantize_wide(sum, i32::from_le_bytes(*multiplier));
        }
    }
}

/// A fully connected layer of every pixel by itself: a convolution with a window of 1 x 1.
///
/// Shapes: `input` (pixels, channels), weights (rows, channels), `output` (pixels, rows).
pub fn pointwise(
    map: &Linear<'_>,
    channels: usize,
    input: &[i8],
    _rows: &mut Rows,
    output: &mut [i8],
) {
    let outputs = output.chunks_exact_mut(map.bias.len().max(1));
    for (pixel, output) in input.chunks_exact(channels.max(1)).zip(outputs) {
        fully_connected(map, pixel, output);
    }
}

/// A convolution with a window of 3 x 3 pixels.
///
/// Shapes: `input` (side, side, channels), weights (rows, [`Order::Window`](super::Order)), `output`
/// (side / stride, side / stride, rows), rounded up; at most [`MAX_CHANNELS`] channels, more give
/// nothing. The window of output pixel (y, x) is centred on input pixel (stride · y, stride · x).
pub fn convolve(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    _rows: &mut Rows,
    output: &mut [i8],
) {
    let channels = input.channels;
    let mut buffer = [0; 9 * MAX_CHANNELS]; // (group, column, row, channel of the group)
    let (Some(window), 1..) = (buffer.get_mut(..9 * channels.next_multiple_of(GROUP)), channels)
    else {
        return;
    };
    each_window(map, stride, input, output, |y, x, output| {
        for (place, eight) in window.chunks_exact_mut(GROUP).enumerate() {
            let (group, column, row) = (place / 9, place / 3 % 3, place % 3);
            let pixel = pixel(input, y + row, x + column);
            for (within, value) in eight.iter_mut().enumerate() {
                // Weights are 0 where there is no such channel.
                let there = pixel.and_then(|pixel| pixel.get(GROUP * group + within));
                *value = there.copied().unwrap_or(input.border);
            }
        }
        fully_connected(map, window, output);
    });
}

/// A convolution with a window of 3 x 3 pixels of three colours: as [`convolve`], with weights (rows,
/// [`Order::Colours`](super::Order)).
pub fn convolve_colours(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    _rows: &mut Rows,
    output: &mut [i8],
) {
    each_window(map, stride, input, output, |y, x, output| {
        let mut lanes = [0; 32]; // (column, 10 numbers), two zeros
        for (column, lanes) in lanes.chunks_exact_mut(10).enumerate() {
            for (row, lanes) in lanes.chunks_exact_mut(3).enumerate() {
                let pixel = pixel(input, y + row, x + column);
                for (colour, lane) in lanes.iter_mut().enumerate() {
                    let there = pixel.and_then(|pixel| pixel.get(colour));
                    *lane = there.copied().unwrap_or(input.border);
                }
            }
        }
        // From the order of lanes to that of columns.
        for four in lanes.as_chunks_mut::<EDGE>().0 {
            four.swap(1, 2);
        }
        fully_connected(map, &lanes, output);
    });
}

/// A convolution with a window of 3 x 3 pixels of every channel by itself. No shipped network has one.
///
/// Shapes: `input` (side, side, channels), weights (channels, 9 = (row, column)), `output` (side /
/// stride, side / stride, channels), rounded up. Windows are centred as those of [`convolve`]; where the
/// input has not as many channels as the map has rows, nothing is done.
pub fn depthwise(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    _rows: &mut Rows,
    output: &mut [i8],
) {
    if input.channels != map.bias.len() {
        return;
    }
    each_window(map, stride, input, output, |y, x, output| {
        let mut window = [None; 9];
        for (place, there) in window.iter_mut().enumerate() {
            *there = pixel(input, y + place / 3, x + place % 3);
        }
        let blocks = map.weights.chunks_exact(map.stride()).zip(output.chunks_mut(EDGE));
        let lists = map.bias.chunks(EDGE).zip(map.multipliers.chunks(EDGE));
        for (first, ((tiles, output), (bias, multipliers))) in
            (0..).step_by(EDGE).zip(blocks.zip(lists))
        {
            let mut sums = sums(&[], bias, &[]);
            for (tile, pixels) in tiles.iter().zip(window.chunks(EDGE)) {
                for ((channel, sum), weights) in (first..).zip(&mut sums).zip(unpack(tile)) {
                    for (weight, pixel) in weights.into_iter().zip(pixels) {
                        let there = pixel.and_then(|pixel| pixel.get(channel));
                        let value = i32::from(there.copied().unwrap_or(input.border));
                        *sum = sum.wrapping_add(i32::from(weight) * value);
                    }
                }
            }
            for ((output, sum), multiplier) in output.iter_mut().zip(sums).zip(multipliers) {
                *output = requantize(sum, i32::from_le_bytes(*multiplier), map.zero, map.low);
            }
        }
    });
}

/// Calls `each` with the row and the column before an output pixel's window, both one too large so
/// that nothing is negative, and with the output pixel.
fn each_window(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    output: &mut [i8],
    mut each: impl FnMut(usize, usize, &mut [i8]),
) {
    let centres = || (0..input.side).step_by(stride.max(1));
    let places = centres().flat_map(|y| centres().map(move |x| (y, x)));
    for ((y, x), output) in places.zip(output.chunks_exact_mut(map.bias.len().max(1))) {
        each(y, x, output);
    }
}

/// The channels of a pixel whose row and column are one too large; `None` beyond the border.
fn pixel<'a>(input: &Grid<'a>, y: usize, x: usize) -> Option<&'a [i8]> {
    let inside = 1..=input.side;
    if !inside.contains(&y) || !inside.contains(&x) {
        return None;
    }
    let from = ((y - 1) * input.side + (x - 1)) * input.channels;
    input.values.get(from..from + input.channels)
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
    let constant = add.constant();
    for (value, &other) in values.iter_mut().zip(others) {
        let sum = constant
            .wrapping_add(i32::from(*value).wrapping_mul(add.multiplier))
            .wrapping_add(i32::from(other).wrapping_mul(add.other_multiplier));
        *value = (sum >> 18).min(127).max(i32::from(add.zero)) as i8;
    }
}
