//! SSE2, which every x86-64 has.

use core::arch::x86_64::*;

use super::{Alone, EDGE, Eight, GROUP, Linear, Lines, Shape, Tile, Vectors};

/// SSE2.
pub(super) enum Sse2 {}

impl Lines for Sse2 {
    const LEAST: usize = 1;

    fn takes(map: &Linear<'_>) -> bool {
        map.bias.len().is_multiple_of(EDGE)
    }

    unsafe fn widen(
        from: *const i8,
        to: *mut i16,
        distance: usize,
        pixels: usize,
        channels: usize,
    ) {
        // SAFETY: the caller's promise.
        unsafe { widen(from, to, distance, pixels, channels) };
    }

    unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]) {
        // SAFETY: the caller's promise.
        unsafe { run(map, shape, window, line) };
    }
}

impl Vectors for Sse2 {
    unsafe fn sums(tiles: &[Tile], input: *const i16) -> [i32; EDGE] {
        // SAFETY: the caller's promise.
        unsafe { sums(tiles, input) }
    }
}

impl Alone for Sse2 {
    #[inline]
    unsafe fn outputs(eight: &Eight, window: *const i16) -> [i8; GROUP] {
        // SAFETY: the caller's promise.
        unsafe { outputs(eight, window) }
    }
}

/// As [`Lines::widen`].
///
/// # Safety
///
/// As there.
#[target_feature(enable = "sse2")]
unsafe fn widen(from: *const i8, to: *mut i16, distance: usize, pixels: usize, channels: usize) {
    for pixel in 0..pixels {
        // SAFETY: eight bytes and room for eight numbers are the caller's promise.
        unsafe {
            let bytes = _mm_loadl_epi64(from.add(pixel * channels).cast());
            let wide = _mm_srai_epi16(_mm_unpacklo_epi8(bytes, bytes), 8);
            let lanes = _mm_shufflehi_epi16(_mm_shufflelo_epi16(wide, 0xd8), 0xd8);
            _mm_storeu_si128(to.add(pixel * distance).cast(), lanes);
        }
    }
}

/// As [`Lines::run`].
///
/// # Safety
///
/// As there.
#[target_feature(enable = "sse2")]
unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]) {
    const AT_ONCE: usize = 4;
    let &Shape { pixels, distance, group, tiles: per_group } = shape;
    let low = _mm_set1_epi16(map.low.into());
    let lists = map.bias.chunks(EDGE).zip(map.multipliers.chunks(EDGE));
    for (index, (tiles, (bias, multipliers))) in
        map.weights.chunks_exact(map.stride()).zip(lists).enumerate()
    {
        let block = Block::new(bias, multipliers, map.zero);
        let outputs = line.chunks_exact_mut(map.bias.len().max(1));
        let mut outputs = outputs.filter_map(|pixel| pixel.get_mut(EDGE * index..));
        let mut put = |bytes: __m128i| {
            let bytes = _mm_cvtsi128_si32(bytes).to_le_bytes();
            for (place, byte) in outputs.next().unwrap_or_default().iter_mut().zip(bytes) {
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
                    let (ab, cd) = (_mm_packs_epi32(a, b), _mm_packs_epi32(c, d));
                    let bytes = _mm_packs_epi16(_mm_max_epi16(ab, low), _mm_max_epi16(cd, low));
                    put(bytes);
                    put(_mm_srli_si128(bytes, 4));
                    put(_mm_srli_si128(bytes, 8));
                    put(_mm_srli_si128(bytes, 12));
                    pixel += AT_ONCE;
                } else {
                    let mut sums = [Sums::new()];
                    for (at, tiles) in tiles.chunks(per_group.max(1)).enumerate() {
                        add_tiles(tiles, window.add(at * group), distance, &mut sums);
                    }
                    let [a] = sums.map(|sums| block.finish(sums));
                    let a = _mm_max_epi16(_mm_packs_epi32(a, a), low);
                    put(_mm_packs_epi16(a, a));
                    pixel += 1;
                }
            }
        }
    }
}

/// As [`Vectors::sums`].
///
/// # Safety
///
/// As there.
#[target_feature(enable = "sse2")]
unsafe fn sums(tiles: &[Tile], input: *const i16) -> [i32; EDGE] {
    let mut sums = [Sums::new()];
    // SAFETY: the caller's promise.
    unsafe { add_tiles(tiles, input, 0, &mut sums) };
    let [(first, second)] = sums.map(|sums| sums.reduce());
    let third = _mm_unpackhi_epi64(first, first);
    let fourth = _mm_unpackhi_epi64(second, second);
    [first, second, third, fourth].map(|sum| _mm_cvtsi128_si32(sum))
}

/// R and S: rows 0 and 1 twice, rows 2 and 3 twice.
#[derive(Clone, Copy)]
struct Sums {
    raw: __m128i,
    low: __m128i,
}

impl Sums {
    #[target_feature(enable = "sse2")]
    fn new() -> Self {
        Self { raw: _mm_setzero_si128(), low: _mm_setzero_si128() }
    }

    /// The sums of rows 0 and 2, and of rows 1 and 3, in the lower halves of 64 bits.
    #[target_feature(enable = "sse2")]
    fn reduce(self) -> (__m128i, __m128i) {
        let halves = |sums| _mm_add_epi32(sums, _mm_srli_epi64(sums, 32));
        let (raw, low) = (halves(self.raw), halves(self.low));
        (low, _mm_srai_epi32(_mm_sub_epi32(raw, low), 8))
    }
}

/// What a block of four rows adds to its sums: numbers in the lower halves of 64 bits.
struct Block {
    first_bias: __m128i,  // rows 0 and 2
    second_bias: __m128i, // rows 1 and 3
    first_multipliers: __m128i,
    second_multipliers: __m128i,
    constant: __m128i, // i64: zero point and a half
}

impl Block {
    #[target_feature(enable = "sse2")]
    fn new(bias: &[[u8; 4]], multipliers: &[[u8; 4]], zero: i8) -> Self {
        let number = |list: &[[u8; 4]], row| list.get(row).map_or(0, |n| i32::from_le_bytes(*n));
        let pair = |list, a, b| _mm_setr_epi32(number(list, a), 0, number(list, b), 0);
        Self {
            first_bias: pair(bias, 0, 2),
            second_bias: pair(bias, 1, 3),
            first_multipliers: pair(multipliers, 0, 2),
            second_multipliers: pair(multipliers, 1, 3),
            constant: _mm_set1_epi64x((i64::from(zero) << 32) + (1 << 31)),
        }
    }

    /// Rows 0 to 3 of a pixel, as 32 bits, not yet saturated.
    #[target_feature(enable = "sse2")]
    fn finish(&self, sums: Sums) -> __m128i {
        let (first, second) = sums.reduce();
        let first = multiply(_mm_add_epi32(first, self.first_bias), self.first_multipliers);
        let second = multiply(_mm_add_epi32(second, self.second_bias), self.second_multipliers);
        // The upper halves of 64 bits are the results.
        let first = _mm_srli_epi64(_mm_add_epi64(first, self.constant), 32);
        let second = _mm_add_epi64(second, self.constant);
        _mm_or_si128(first, _mm_and_si128(second, _mm_set1_epi64x(!0 << 32)))
    }
}

/// Products of 64 bits of the lower halves, of which the second are not negative.
#[target_feature(enable = "sse2")]
fn multiply(sums: __m128i, multipliers: __m128i) -> __m128i {
    // SSE2 multiplies without signs: a negative sum counts as 2^32 more.
    let too_much = _mm_and_si128(_mm_srai_epi32(sums, 31), multipliers);
    _mm_sub_epi64(_mm_mul_epu32(sums, multipliers), _mm_slli_epi64(too_much, 32))
}

/// R and S of a run of tiles for some pixels.
///
/// # Safety
///
/// There must be four numbers for each tile, from each pixel's window on.
#[target_feature(enable = "sse2")]
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
            let tile = _mm_loadu_si128(tile.as_ptr().cast());
            let low = _mm_srai_epi16(_mm_slli_epi16(tile, 8), 8);
            for (pixel, sums) in sums.iter_mut().enumerate() {
                let four = _mm_loadl_epi64(window.add(pixel * distance).cast());
                let twice = _mm_unpacklo_epi64(four, four);
                sums.raw = _mm_add_epi32(sums.raw, _mm_madd_epi16(tile, twice));
                sums.low = _mm_add_epi32(sums.low, _mm_madd_epi16(low, twice));
            }
            window = window.add(GROUP / 2);
        }
    }
}

/// As [`Alone::outputs`].
///
/// # Safety
///
/// As there.
#[inline]
#[target_feature(enable = "sse2")]
unsafe fn outputs(eight: &Eight, window: *const i16) -> [i8; GROUP] {
    // SAFETY: 32 bytes of each list and of each pair's weights; the numbers are the caller's promise.
    unsafe {
        let list = |list: &[i32; GROUP]| {
            let list = list.as_ptr().cast::<__m128i>();
            (_mm_loadu_si128(list), _mm_loadu_si128(list.add(1)))
        };
        let (mut low, mut high) = list(&eight.bias);
        for (pair, weights) in eight.weights.iter().enumerate() {
            let at = window.add(2 * GROUP * pair);
            let one = _mm_loadu_si128(at.cast());
            let is_last = pair + 1 == eight.weights.len();
            let other = if is_last { one } else { _mm_loadu_si128(at.add(GROUP).cast()) };
            let weights = weights.as_ptr().cast::<__m128i>();
            let turns = _mm_unpacklo_epi16(one, other);
            low = _mm_add_epi32(low, _mm_madd_epi16(turns, _mm_loadu_si128(weights)));
            let turns = _mm_unpackhi_epi16(one, other);
            high = _mm_add_epi32(high, _mm_madd_epi16(turns, _mm_loadu_si128(weights.add(1))));
        }
        let constant = _mm_set1_epi64x((i64::from(eight.zero) << 32) + (1 << 31));
        let finish = |sums: __m128i, multipliers: __m128i| {
            let even = _mm_add_epi64(multiply(sums, multipliers), constant);
            let (sums, multipliers) = (_mm_srli_epi64(sums, 32), _mm_srli_epi64(multipliers, 32));
            let odd = _mm_add_epi64(multiply(sums, multipliers), constant);
            // The upper halves of 64 bits are the results.
            let odd = _mm_and_si128(odd, _mm_set1_epi64x(!0 << 32));
            _mm_or_si128(_mm_srli_epi64(even, 32), odd)
        };
        let (first, second) = list(&eight.multipliers);
        let lanes = _mm_packs_epi32(finish(low, first), finish(high, second));
        let lanes = _mm_max_epi16(lanes, _mm_set1_epi16(eight.low.into()));
        let channels = _mm_shufflehi_epi16(_mm_shufflelo_epi16(lanes, 0xd8), 0xd8);
        let bytes = _mm_cvtsi128_si64(_mm_packs_epi16(channels, channels));
        bytes.to_le_bytes().map(|byte| byte as i8)
    }
}
