//! Fully connected layers on vectors of 128 bits or more: a line of one pixel.

use core::mem::MaybeUninit;

use super::windows::{Lines, Shape, is_whole};
use super::{EDGE, Linear, Tile};

/// Columns that are widened at once, 2 KiB of stack.
const WIDENED: usize = 1024;

/// What an instruction set does with the tiles of a block.
pub(super) trait Vectors: Lines {
    /// The sums of four rows: of as many tiles as there are groups of four widened numbers.
    ///
    /// # Safety
    ///
    /// There must be four numbers for each tile.
    unsafe fn sums(tiles: &[Tile], input: *const i16) -> [i32; EDGE];

    /// Widens groups of four bytes into the order of lanes, as many as there are, and more zeros up to
    /// `count` groups. Gives what `to` holds then.
    fn widen_all(from: &[i8], count: usize, to: &mut [MaybeUninit<i16>; WIDENED]) -> *const i16 {
        let (places, _) = to.as_chunks_mut::<EDGE>();
        let (fours, rest) = from.as_chunks::<EDGE>();
        let mut last = [0; EDGE];
        for (place, value) in last.iter_mut().zip(rest) {
            *place = *value;
        }
        let fours = fours.iter().chain([&last]);
        for (place, &[a, b, c, d]) in places.iter_mut().zip(fours).take(count) {
            *place = [a, c, b, d].map(|value| MaybeUninit::new(i16::from(value)));
        }
        to.as_ptr().cast()
    }
}

/// As [`scalar::accumulate`](super::scalar::accumulate); `false` where that must do it.
pub(super) fn accumulate<V: Vectors>(
    map: &Linear<'_>,
    first: usize,
    input: &[i8],
    sums: &mut [i32],
) -> bool {
    if input.len() > WIDENED {
        return false;
    }
    let (tile, stride) = (first / EDGE, map.stride());
    let count = input.len().div_ceil(EDGE).min(stride.saturating_sub(tile));
    let mut buffer = [MaybeUninit::uninit(); WIDENED];
    let widened = V::widen_all(input, count, &mut buffer);
    for (sums, tiles) in sums.chunks_mut(EDGE).zip(map.weights.chunks_exact(stride)) {
        let tiles = tiles.get(tile..tile.saturating_add(count)).unwrap_or_default();
        // SAFETY: `count` groups have been written, or less tiles are given.
        let more = unsafe { V::sums(tiles, widened) };
        for (sum, more) in sums.iter_mut().zip(more) {
            *sum = sum.wrapping_add(more);
        }
    }
    true
}

/// As [`scalar::fully_connected`](super::scalar::fully_connected); `false` where that must do it.
pub(super) fn fully_connected<V: Vectors>(
    map: &Linear<'_>,
    input: &[i8],
    output: &mut [i8],
) -> bool {
    let stride = map.stride();
    let count = input.len().div_ceil(EDGE);
    let Some(line) = output.get_mut(..map.bias.len()) else { return false };
    // Inputs that are missing would need fewer tiles of each block.
    if !V::takes(map) || !is_whole(map, map.columns) || EDGE * stride > WIDENED || count < stride {
        return false;
    }
    let mut buffer = [MaybeUninit::uninit(); WIDENED];
    let window = V::widen_all(input, stride, &mut buffer);
    let shape = Shape { pixels: 1, distance: 0, group: 0, tiles: stride };
    // SAFETY: a group for every tile has been written; the line has room for all rows, and the map is
    // whole.
    unsafe { V::run(map, &shape, window, line) };
    true
}
