//! Convolutions as lines of windows over widened rows: what the fast kernels have in common.
//!
//! ```text
//! plain:   for each output pixel: gather its window, multiply it with each row of the layer
//! here:    for each line of output pixels:
//!              widen three rows of the map to 16 bits, [group of 8 channels][column][row][channel]
//!              for each block of rows, for some neighbouring pixels: multiply
//! ```
//!
//! Within a group a window is one run of memory, in the order of the weights' columns, and the windows
//! of neighbours lie a constant distance apart: nothing is gathered.

use super::{GROUP, Grid, LANES, Linear, MAX_CHANNELS, Order, Rows};

/// Numbers of a column of the rows of [`convolve_colours`].
const COLUMN: usize = 10;

/// How the windows of a line of output pixels lie, in numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub pixels: usize,
    /// From one pixel's window to the next.
    pub distance: usize,
    /// From one group of channels to the next.
    pub group: usize,
    /// That belong to a group.
    pub tiles: usize,
}

/// What an instruction set does with a line.
pub(super) trait Lines {
    /// The fewest pixels of a line.
    const LEAST: usize;

    /// Whether a map's lists are as they must be.
    fn takes(map: &Linear<'_>) -> bool;

    /// Widens eight channels of each pixel into the order of lanes. Pixels are `channels` bytes apart
    /// and come to lie `distance` numbers apart, 8 or 24.
    ///
    /// # Safety
    ///
    /// All that must be there; `to` must be aligned to 4 bytes.
    unsafe fn widen(from: *const i8, to: *mut i16, distance: usize, pixels: usize, channels: usize);

    /// Computes all rows of the pixels of a line, at least [`Self::LEAST`].
    ///
    /// # Safety
    ///
    /// The map must be whole and taken; from `window` on there must be what `shape` says, with the
    /// numbers of all tiles of every group; `line` must have room for all rows of all pixels.
    unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]);
}

/// Whether all tiles of all rows are there, for so many columns.
pub(super) fn is_whole(map: &Linear<'_>, columns: usize) -> bool {
    let rows = map.bias.len();
    rows > 0
        && map.columns == columns
        && map.multipliers.len() == rows
        && map.weights.len() >= rows.div_ceil(4).saturating_mul(map.stride())
}

/// As [`scalar::pointwise`](super::scalar::pointwise); `false` where that must do it.
pub(super) fn pointwise<L: Lines>(
    map: &Linear<'_>,
    channels: usize,
    input: &[i8],
    rows: &mut Rows,
    output: &mut [i8],
) -> bool {
    let outputs = map.bias.len();
    let groups = channels.div_ceil(GROUP);
    let most = Rows::LENGTH.checked_div(GROUP * groups).unwrap_or(0);
    let fits = L::takes(map)
        && is_whole(map, Order::Plain { columns: channels }.packed())
        && channels.is_multiple_of(GROUP)
        && most > 2 * L::LEAST;
    let pixels = |input: &[i8], output: &[i8]| {
        let there = input.len().checked_div(channels).unwrap_or(0);
        there.min(output.len().checked_div(outputs).unwrap_or(0))
    };
    if !fits || pixels(input, output) < L::LEAST {
        return false;
    }
    let (mut input, mut output) = (input, output);
    loop {
        let left = pixels(input, output);
        // So many that enough are left for the end.
        let now = if left > most { most - L::LEAST } else { left };
        let Some((pixels, later)) = input.split_at_checked(now * channels) else { return true };
        let Some((line, rest)) = core::mem::take(&mut output).split_at_mut_checked(now * outputs)
        else {
            return true;
        };
        (input, output) = (later, rest);
        if now == 0 {
            return true;
        }
        let buffers = rows.0.chunks_exact_mut(GROUP * now).take(groups);
        for (from, buffer) in pixels.chunks(GROUP).zip(buffers) {
            // SAFETY: `pixels` has `now` times `channels` bytes, of which eight of every pixel are read,
            // from this group's on; the buffer has room for as many times eight numbers.
            unsafe { L::widen(from.as_ptr(), buffer.as_mut_ptr(), GROUP, now, channels) };
        }
        let shape = Shape { pixels: now, distance: GROUP, group: GROUP * now, tiles: 2 };
        // SAFETY: the groups have just been written, each with two tiles' numbers for every pixel; the
        // line has room for all rows, and the map is whole.
        unsafe { L::run(map, &shape, rows.0.as_ptr(), line) };
    }
}

/// As [`scalar::convolve`](super::scalar::convolve); `false` where that must do it.
pub(super) fn convolve<L: Lines>(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) -> bool {
    let Grid { values, side, channels, border } = *input;
    let groups = channels.div_ceil(GROUP);
    let group = (3 * GROUP).saturating_mul(side.saturating_add(2)); // numbers
    let pixels = if stride == 2 { side.div_ceil(2) } else { side };
    let fits = L::takes(map)
        && is_whole(map, Order::Window { channels }.packed())
        && (1..=2).contains(&stride)
        && (1..=MAX_CHANNELS).contains(&channels)
        && pixels >= L::LEAST
        && groups.saturating_mul(group) <= Rows::LENGTH
        && values.len() >= side * side * channels
        && output.len() >= pixels * pixels * map.bias.len();
    if !fits {
        return false;
    }
    // What is beyond the border at both sides, and where there is no channel, is never overwritten.
    rows.0.get_mut(..groups * group).unwrap_or_default().fill(border.into());
    let shape = Shape { pixels, distance: 3 * GROUP * stride, group, tiles: 18 };
    let lines = output.chunks_exact_mut((pixels * map.bias.len()).max(1)).take(pixels);
    for (y, line) in lines.enumerate() {
        for row in 0..3 {
            let from = (y * stride + row).checked_sub(1).filter(|from| *from < side);
            let from = from.and_then(|from| values.get(from * side * channels..));
            let buffers = rows.0.chunks_exact_mut(group.max(1)).take(groups);
            for (first, buffer) in (0..).step_by(GROUP).zip(buffers) {
                let to = buffer.get_mut(GROUP * (3 + row)..).unwrap_or_default();
                // SAFETY: the row has `side` pixels of `channels` bytes; the buffer has room for `side`
                // pixels after the one beyond the border.
                unsafe { widen_eight::<L>(from, side, first, channels, border, to) };
            }
        }
        // SAFETY: the groups have just been written, with room for the windows of all pixels; the line
        // has room for all rows, and the map is whole.
        unsafe { L::run(map, &shape, rows.0.as_ptr(), line) };
    }
    true
}

/// As [`scalar::convolve_colours`](super::scalar::convolve_colours); `false` where that must do it.
pub(super) fn convolve_colours<L: Lines>(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) -> bool {
    let Grid { values, side, channels, border } = *input;
    let pixels = if stride == 2 { side.div_ceil(2) } else { side };
    let fits = L::takes(map)
        && is_whole(map, Order::Colours.packed())
        && (1..=2).contains(&stride)
        && channels == 3
        && pixels >= L::LEAST
        && side <= Rows::LENGTH / COLUMN - 4
        && values.len() >= side * side * channels
        && output.len() >= pixels * pixels * map.bias.len();
    if !fits {
        return false;
    }
    // The last window's 32 numbers reach past the column beyond the border.
    rows.0.get_mut(..COLUMN * (side + 4)).unwrap_or_default().fill(border.into());
    let shape = Shape { pixels, distance: COLUMN * stride, group: 0, tiles: 8 };
    let lines = output.chunks_exact_mut((pixels * map.bias.len()).max(1)).take(pixels);
    for (y, line) in lines.enumerate() {
        for row in 0..3 {
            let columns = rows.0.chunks_exact_mut(COLUMN).skip(1).take(side);
            let columns = columns.filter_map(|column| column.get_mut(3 * row..3 * row + 3));
            let from = (y * stride + row).checked_sub(1).filter(|from| *from < side);
            match from.and_then(|from| values.get(from * side * 3..)) {
                Some(from) => {
                    for (column, pixel) in columns.zip(from.as_chunks::<3>().0) {
                        for (number, value) in column.iter_mut().zip(pixel) {
                            *number = i16::from(*value);
                        }
                    }
                }
                None => columns.for_each(|column| column.fill(border.into())),
            }
        }
        // SAFETY: the columns are written, and 32 numbers from the last window's begin; the line has room
        // for all rows, and the map is whole.
        unsafe { L::run(map, &shape, rows.0.as_ptr(), line) };
    }
    true
}

/// Widens eight channels of each of a row's pixels, or what is left of them from `first` on, to places
/// three times eight numbers apart; the border's value where there is no row.
///
/// # Safety
///
/// The row must be whole, and `to` have room for all pixels.
pub(super) unsafe fn widen_eight<L: Lines>(
    from: Option<&[i8]>,
    pixels: usize,
    first: usize,
    channels: usize,
    border: i8,
    to: &mut [i16],
) {
    match from.and_then(|from| from.get(first..)) {
        Some(from) if first + GROUP <= channels => {
            // SAFETY: the caller's promise.
            unsafe { L::widen(from.as_ptr(), to.as_mut_ptr(), 3 * GROUP, pixels, channels) };
        }
        Some(from) => widen_part(from, channels, channels - first, pixels, to),
        None => fill_row(to, pixels, border),
    }
}

/// As [`Lines::widen`] for the last channels of a map, of which there are `count`, fewer than eight.
fn widen_part(from: &[i8], channels: usize, count: usize, pixels: usize, to: &mut [i16]) {
    let pixels = from.chunks(channels.max(1)).take(pixels);
    for (eight, pixel) in to.chunks_mut(3 * GROUP).zip(pixels) {
        let pixel = pixel.get(..count).unwrap_or_default();
        for (four, values) in eight.chunks_mut(LANES.len()).zip(pixel.chunks(LANES.len())) {
            for (value, lane) in values.iter().zip(LANES) {
                if let Some(place) = four.get_mut(lane) {
                    *place = i16::from(*value);
                }
            }
        }
    }
}

/// Fills eight channels of each pixel of a row.
fn fill_row(to: &mut [i16], pixels: usize, border: i8) {
    for eight in to.chunks_mut(3 * GROUP).take(pixels) {
        for place in eight.iter_mut().take(GROUP) {
            *place = border.into();
        }
    }
}
