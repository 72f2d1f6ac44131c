//! WebAssembly with 128-bit vectors, for builds with `-C target-feature=+simd128`.
//!
//! ```text
//! plain:   sum = bias + Σ_c weights[r, c] · input[c], for each output pixel and each row r
//! here:    R, S += a tile at once: i32x4.dot_i16x8_s of the lanes as they are, and of their low bytes,
//!          for four rows and for four neighbouring pixels
//!          first rows' sums = S, second rows' sums = (R - S) >> 8
//! ```
//!
//! A module cannot ask what it runs on: a page builds it with and without, and chooses when it loads.

use core::arch::wasm32::*;

use super::depthwise::{self, Alone, Eight};
use super::vectors::{self, Vectors};
use super::windows::{self, Lines, Shape};
use super::{EDGE, GROUP, Grid, Linear, Rows, Tile, scalar};

pub use scalar::{add_residual, fully_connected_wide, requantize_all};

/// Adds a part of a linear map, without its bias. As [`scalar::accumulate`].
pub fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]) {
    if !vectors::accumulate::<Simd>(map, first, input, sums) {
        scalar::accumulate(map, first, input, sums);
    }
}

/// A fully connected layer. As [`scalar::fully_connected`].
pub fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]) {
    if !vectors::fully_connected::<Simd>(map, input, output) {
        scalar::fully_connected(map, input, output);
    }
}

/// A fully connected layer of every pixel by itself. As [`scalar::pointwise`].
pub fn pointwise(
    map: &Linear<'_>,
    channels: usize,
    input: &[i8],
    rows: &mut Rows,
    output: &mut [i8],
) {
    if !windows::pointwise::<Simd>(map, channels, input, rows, output) {
        scalar::pointwise(map, channels, input, rows, output);
    }
}

/// A convolution with a window of 3 x 3 pixels. As [`scalar::convolve`].
pub fn convolve(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) {
    if !windows::convolve::<Simd>(map, stride, input, rows, output) {
        scalar::convolve(map, stride, input, rows, output);
    }
}

/// A convolution with a window of 3 x 3 pixels of three colours. As [`scalar::convolve_colours`].
pub fn convolve_colours(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) {
    if !windows::convolve_colours::<Simd>(map, stride, input, rows, output) {
        scalar::convolve_colours(map, stride, input, rows, output);
    }
}

/// A convolution with a window of 3 x 3 pixels of every channel by itself. As [`scalar::depthwise`].
pub fn depthwise(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) {
    if !depthwise::depthwise::<Simd>(map, stride, input, rows, output) {
        scalar::depthwise(map, stride, input, rows, output);
    }
}

/// Vectors of 128 bits.
enum Simd {}

impl Lines for Simd {
    const LEAST: usize = 1;

    fn takes(_map: &Linear<'_>) -> bool {
        true
    }

    unsafe fn widen(
        from: *const i8,
        to: *mut i16,
        distance: usize,
        pixels: usize,
        channels: usize,
    ) {
        for pixel in 0..pixels {
            // SAFETY: eight bytes and room for eight numbers are the caller's promise.
            unsafe {
                let wide = i16x8_load_extend_i8x8(from.add(pixel * channels));
                let lanes = i16x8_shuffle::<0, 2, 1, 3, 4, 6, 5, 7>(wide, wide);
                v128_store(to.add(pixel * distance).cast(), lanes);
            }
        }
    }

    unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]) {
        const AT_ONCE: usize = 4;
        let &Shape { pixels, distance, group, tiles: per_group } = shape;
        let low = i8x16_splat(map.low);
        let lists = map.bias.chunks(EDGE).zip(map.multipliers.chunks(EDGE));
        let blocks = map.weights.chunks_exact(map.stride()).zip(lists);
        for (index, (tiles, (bias, multipliers))) in blocks.enumerate() {
            let block = Block::new(bias, multipliers, map.zero);
            let outputs = line.chunks_exact_mut(map.bias.len().max(1));
            let mut outputs = outputs.filter_map(|pixel| pixel.get_mut(EDGE * index..));
            let mut put = |bytes: i32| {
                let places = outputs.next().unwrap_or_default();
                for (place, byte) in places.iter_mut().zip(bytes.to_le_bytes()) {
                    *place = byte as i8;
                }
            };
            let mut pixel = 0;
            while pixel < pixels {
                // SAFETY: the caller's promise: from each pixel's window on lie all groups.
                unsafe {
                    let window = window.add(pixel * distance);
                    if pixel + AT_ONCE <= pixels {
                        let mut sums = [Sums::new(); AT_ONCE];
                        for (at, tiles) in tiles.chunks(per_group.max(1)).enumerate() {
                            add_tiles(tiles, window.add(at * group), distance, &mut sums);
                        }
                        let [a, b, c, d] = sums.map(|sums| block.finish(sums));
                        let (ab, cd) = (i16x8_narrow_i32x4(a, b), i16x8_narrow_i32x4(c, d));
                        let bytes = i8x16_max(i8x16_narrow_i16x8(ab, cd), low);
                        put(i32x4_extract_lane::<0>(bytes));
                        put(i32x4_extract_lane::<1>(bytes));
                        put(i32x4_extract_lane::<2>(bytes));
                        put(i32x4_extract_lane::<3>(bytes));
                        pixel += AT_ONCE;
                    } else {
                        let mut sums = [Sums::new()];
                        for (at, tiles) in tiles.chunks(per_group.max(1)).enumerate() {
                            add_tiles(tiles, window.add(at * group), distance, &mut sums);
                        }
                        let [a] = sums.map(|sums| block.finish(sums));
                        let a = i16x8_narrow_i32x4(a, a);
                        put(i32x4_extract_lane::<0>(i8x16_max(i8x16_narrow_i16x8(a, a), low)));
                        pixel += 1;
                    }
                }
            }
        }
    }
}

impl Vectors for Simd {
    unsafe fn sums(tiles: &[Tile], input: *const i16) -> [i32; EDGE] {
        let mut sums = [Sums::new()];
        // SAFETY: the caller's promise.
        unsafe { add_tiles(tiles, input, 0, &mut sums) };
        let [(first, second)] = sums.map(Sums::reduce);
        [
            i32x4_extract_lane::<0>(first),
            i32x4_extract_lane::<0>(second),
            i32x4_extract_lane::<1>(first),
            i32x4_extract_lane::<1>(second),
        ]
    }
}

impl Alone for Simd {
    unsafe fn outputs(eight: &Eight, window: *const i16) -> [i8; GROUP] {
        // SAFETY: 32 bytes of each list and of each pair's weights; the numbers are the caller's
        // promise.
        unsafe {
            let list = |list: &[i32; GROUP]| {
                let list = list.as_ptr().cast::<v128>();
                (v128_load(list), v128_load(list.add(1)))
            };
            let (mut low, mut high) = list(&eight.bias);
            for (pair, weights) in eight.weights.iter().enumerate() {
                let at = window.add(2 * GROUP * pair);
                let one = v128_load(at.cast());
                let is_last = pair + 1 == eight.weights.len();
                let other = if is_last { one } else { v128_load(at.add(GROUP).cast()) };
                let weights = weights.as_ptr().cast::<v128>();
                let turns = i16x8_shuffle::<0, 8, 1, 9, 2, 10, 3, 11>(one, other);
                low = i32x4_add(low, i32x4_dot_i16x8(turns, v128_load(weights)));
                let turns = i16x8_shuffle::<4, 12, 5, 13, 6, 14, 7, 15>(one, other);
                high = i32x4_add(high, i32x4_dot_i16x8(turns, v128_load(weights.add(1))));
            }
            let constant = i64x2_splat((i64::from(eight.zero) << 32) + (1 << 31));
            let finish = |sums, multipliers| {
                let first = i64x2_add(i64x2_extmul_low_i32x4(sums, multipliers), constant);
                let second = i64x2_add(i64x2_extmul_high_i32x4(sums, multipliers), constant);
                // The upper halves of 64 bits are the results.
                i32x4_shuffle::<1, 3, 5, 7>(first, second)
            };
            let (first, second) = list(&eight.multipliers);
            let lanes = i16x8_narrow_i32x4(finish(low, first), finish(high, second));
            let lanes = i16x8_max(lanes, i16x8_splat(eight.low.into()));
            let channels = i16x8_shuffle::<0, 2, 1, 3, 4, 6, 5, 7>(lanes, lanes);
            let bytes = i64x2_extract_lane::<0>(i8x16_narrow_i16x8(channels, channels));
            bytes.to_le_bytes().map(|byte| byte as i8)
        }
    }
}

/// R and S: rows 0 and 1 twice, rows 2 and 3 twice.
#[derive(Clone, Copy)]
struct Sums {
    raw: v128,
    low: v128,
}

impl Sums {
    fn new() -> Self {
        Self { raw: i32x4_splat(0), low: i32x4_splat(0) }
    }

    /// The sums of rows 0 and 2, and of rows 1 and 3, as the first two of 32 bits.
    fn reduce(self) -> (v128, v128) {
        let halves = |sums| {
            let even = i32x4_shuffle::<0, 2, 0, 2>(sums, sums);
            i32x4_add(even, i32x4_shuffle::<1, 3, 1, 3>(sums, sums))
        };
        let (raw, low) = (halves(self.raw), halves(self.low));
        (low, i32x4_shr(i32x4_sub(raw, low), 8))
    }
}

/// What a block of four rows adds to its sums.
struct Block {
    first_bias: v128,  // rows 0 and 2
    second_bias: v128, // rows 1 and 3
    first_multipliers: v128,
    second_multipliers: v128,
    constant: v128, // i64: zero point and a half
}

impl Block {
    fn new(bias: &[[u8; 4]], multipliers: &[[u8; 4]], zero: i8) -> Self {
        let number = |list: &[[u8; 4]], row| list.get(row).map_or(0, |n| i32::from_le_bytes(*n));
        let pair = |list, a, b| i32x4(number(list, a), number(list, b), 0, 0);
        Self {
            first_bias: pair(bias, 0, 2),
            second_bias: pair(bias, 1, 3),
            first_multipliers: pair(multipliers, 0, 2),
            second_multipliers: pair(multipliers, 1, 3),
            constant: i64x2_splat((i64::from(zero) << 32) + (1 << 31)),
        }
    }

    /// Rows 0 to 3 of a pixel, as 32 bits, not yet saturated.
    fn finish(&self, sums: Sums) -> v128 {
        let (first, second) = sums.reduce();
        let first = i32x4_add(first, self.first_bias);
        let second = i32x4_add(second, self.second_bias);
        let first = i64x2_extmul_low_i32x4(first, self.first_multipliers);
        let second = i64x2_extmul_low_i32x4(second, self.second_multipliers);
        let (first, second) = (i64x2_add(first, self.constant), i64x2_add(second, self.constant));
        // The upper halves of 64 bits are the results.
        i32x4_shuffle::<1, 5, 3, 7>(first, second)
    }
}

/// R and S of a run of tiles for some pixels.
///
/// # Safety
///
/// There must be four numbers for each tile, from each pixel's window on.
unsafe fn add_tiles<const PIXELS: usize>(
    tiles: &[Tile],
    window: *const i16,
    distance: usize,
    sums: &mut [Sums; PIXELS],
) {
    let mut window = window;
    for tile in tiles {
        // SAFETY: 16 bytes of a tile; four numbers are the caller's promise.
        unsafe {
            let tile = v128_load(tile.as_ptr().cast());
            let low = i16x8_shr(i16x8_shl(tile, 8), 8);
            for (pixel, sums) in sums.iter_mut().enumerate() {
                let twice = v128_load64_splat(window.add(pixel * distance).cast());
                sums.raw = i32x4_add(sums.raw, i32x4_dot_i16x8(tile, twice));
                sums.low = i32x4_add(sums.low, i32x4_dot_i16x8(low, twice));
            }
            window = window.add(EDGE);
        }
    }
}
