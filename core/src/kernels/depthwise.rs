//! Convolutions of every channel by itself on vectors of 128 bits: eight channels at once.
//!
//! ```text
//! for each group of 8 channels, for each line of output pixels:
//!     widen three rows of the map to 16 bits, [column][row][channel]
//!     for each pixel: places 2p and 2p + 1 of its window in turns, multiplied and added in pairs
//! ```

use super::windows::{Lines, is_whole, widen_eight};
use super::{EDGE, GROUP, Grid, LANES, Linear, Order, Rows, unpack};

/// Pairs of a window's places; the tenth place is empty.
const PAIRS: usize = 5;

/// What an instruction set does with a window of eight channels.
pub(super) trait Alone: Lines {
    /// The outputs of a window's eight channels.
    ///
    /// # Safety
    ///
    /// From `window` on there must be 72 numbers.
    unsafe fn outputs(eight: &Eight, window: *const i16) -> [i8; GROUP];
}

/// Eight channels of a layer in the order of lanes; 0 where there are fewer.
#[derive(Clone, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Eight {
    /// Shape (pair, lane, place of the pair).
    pub weights: [[[i16; 2]; GROUP]; PAIRS],
    pub bias: [i32; GROUP],
    pub multipliers: [i32; GROUP],
    pub zero: i8,
    pub low: i8,
}

impl Eight {
    /// The channels from `first` on.
    fn new(map: &Linear<'_>, first: usize) -> Self {
        let mut eight = Self { zero: map.zero, low: map.low, ..Self::default() };
        let lanes = eight.bias.iter_mut().zip(&mut eight.multipliers);
        for (channel, (bias, multiplier)) in channels_of_lanes(first).zip(lanes) {
            let number = |list: &[[u8; 4]]| list.get(channel).map_or(0, |n| i32::from_le_bytes(*n));
            (*bias, *multiplier) = (number(map.bias), number(map.multipliers));
        }
        for (pair, places) in (0..).step_by(2).zip(&mut eight.weights) {
            for (channel, lane) in channels_of_lanes(first).zip(places) {
                *lane = [pair, pair + 1].map(|place| weight(map, channel, place).into());
            }
        }
        eight
    }
}

/// The channels of eight lanes.
fn channels_of_lanes(first: usize) -> impl Iterator<Item = usize> {
    [first, first + EDGE].into_iter().flat_map(|four| LANES.map(|lane| four + lane))
}

/// The weight of a place of the window, columns before rows; 0 where there is none.
fn weight(map: &Linear<'_>, channel: usize, place: usize) -> i8 {
    let column = place % 3 * 3 + place / 3;
    let tile = map.weights.get(channel / EDGE * map.stride() + column / EDGE);
    let row = tile.and_then(|tile| unpack(tile).get(channel % EDGE).copied());
    row.and_then(|row| row.get(column % EDGE).copied()).filter(|_| place < 9).unwrap_or(0)
}

/// As [`scalar::depthwise`](super::scalar::depthwise); `false` where that must do it.
pub(super) fn depthwise<A: Alone>(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) -> bool {
    let Grid { values, side, channels, border } = *input;
    let columns = side.saturating_add(2).saturating_mul(3 * GROUP); // numbers
    let pixels = if stride == 2 { side.div_ceil(2) } else { side };
    let fits = is_whole(map, Order::Plain { columns: 9 }.packed())
        && channels == map.bias.len()
        && (1..=2).contains(&stride)
        && values.len() >= side * side * channels
        && output.len() >= pixels * pixels * channels;
    let (Some(buffer), true) = (rows.0.get_mut(..columns), fits) else { return false };
    // What is beyond the border at both sides is never overwritten.
    buffer.fill(border.into());
    for first in (0..channels).step_by(GROUP) {
        let eight = Eight::new(map, first);
        let lines = output.chunks_exact_mut((pixels * channels).max(1)).take(pixels);
        for (y, line) in lines.enumerate() {
            for (row, above) in (y * stride..).take(3).enumerate() {
                let from = above.checked_sub(1).filter(|from| *from < side);
                let from = from.and_then(|from| values.get(from * side * channels..));
                let to = buffer.get_mut(GROUP * (3 + row)..).unwrap_or_default();
                // SAFETY: the input is whole; the buffer has room for `side` pixels after the one
                // beyond the border.
                unsafe { widen_eight::<A>(from, side, first, channels, border, to) };
            }
            let windows = buffer.windows(9 * GROUP).step_by(3 * GROUP * stride);
            for (pixel, window) in line.chunks_exact_mut(channels).zip(windows) {
                // SAFETY: a window has 72 numbers.
                let bytes = unsafe { A::outputs(&eight, window.as_ptr()) };
                let places = pixel.get_mut(first..).unwrap_or_default();
                for (place, byte) in places.iter_mut().zip(bytes) {
                    *place = byte;
                }
            }
        }
    }
    true
}
