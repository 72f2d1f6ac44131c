//! AVX2, and `vpdpwssd` of AVX-512 VNNI in place of `vpmaddwd` and `vpaddd`.

use core::arch::x86_64::*;

use super::sse2::Sse2;
use super::{Addition, EDGE, GROUP, Linear, Lines, Shape, Tile, Vectors, scalar};

/// What a block of four rows adds to its sums, twice, for two pixels.
struct Block {
    first_bias: __m128i,         // rows 0, 2, 0, 2
    second_bias: __m128i,        // rows 1, 3, 1, 3
    first_multipliers: __m256i,  // i64
    second_multipliers: __m256i, // i64
    constant: __m256i,           // i64: zero point and a half
}

impl Block {
    #[target_feature(enable = "avx2")]
    fn new(bias: &[[u8; 4]], multipliers: &[[u8; 4]], zero: i8) -> Self {
        let number = |list: &[[u8; 4]], row| list.get(row).map_or(0, |n| i32::from_le_bytes(*n));
        let pair = |list, a, b| {
            let (a, b) = (number(list, a), number(list, b));
            _mm_setr_epi32(a, b, a, b)
        };
        Self {
            first_bias: pair(bias, 0, 2),
            second_bias: pair(bias, 1, 3),
            first_multipliers: _mm256_cvtepi32_epi64(pair(multipliers, 0, 2)),
            second_multipliers: _mm256_cvtepi32_epi64(pair(multipliers, 1, 3)),
            constant: _mm256_set1_epi64x((i64::from(zero) << 32) + (1 << 31)),
        }
    }

    /// Rows 0 to 3 of two pixels, as 32 bits, not yet saturated.
    #[target_feature(enable = "avx2")]
    fn finish(&self, one: Sums, other: Sums) -> __m256i {
        let (one, other) = (one.reduce(), other.reduce());
        let r = _mm_unpacklo_epi64(one, other);
        let first = _mm_unpackhi_epi64(one, other);
        let second = _mm_srai_epi32(_mm_sub_epi32(r, first), 8);
        let first = _mm256_cvtepi32_epi64(_mm_add_epi32(first, self.first_bias));
        let second = _mm256_cvtepi32_epi64(_mm_add_epi32(second, self.second_bias));
        let first = _mm256_mul_epi32(first, self.first_multipliers);
        let second = _mm256_mul_epi32(second, self.second_multipliers);
        // The upper halves of 64 bits are the results.
        let first = _mm256_srli_epi64(_mm256_add_epi64(first, self.constant), 32);
        _mm256_blend_epi32(first, _mm256_add_epi64(second, self.constant), 0b1010_1010)
    }
}

/// R and S: (rows 0 and 1, rows 0 and 1, rows 2 and 3, rows 2 and 3) of even tiles, then of odd ones.
#[derive(Clone, Copy)]
struct Sums {
    raw: __m256i,
    low: __m256i,
}

impl Sums {
    #[target_feature(enable = "avx2")]
    fn new() -> Self {
        Self { raw: _mm256_setzero_si256(), low: _mm256_setzero_si256() }
    }

    /// R of both pairs of rows, then S.
    #[target_feature(enable = "avx2")]
    fn reduce(self) -> __m128i {
        let halves =
            |sums| _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
        _mm_hadd_epi32(halves(self.raw), halves(self.low))
    }

    /// Adds the products of tiles with their numbers.
    #[target_feature(enable = "avx2")]
    fn add(&mut self, tiles: __m256i, low: __m256i, numbers: __m256i) {
        self.raw = _mm256_add_epi32(self.raw, _mm256_madd_epi16(tiles, numbers));
        self.low = _mm256_add_epi32(self.low, _mm256_madd_epi16(low, numbers));
    }

    /// The same in half as many instructions.
    #[target_feature(enable = "avx2,avx512f,avx512vl,avx512vnni")]
    fn add_vnni(&mut self, tiles: __m256i, low: __m256i, numbers: __m256i) {
        self.raw = _mm256_dpwssd_epi32(self.raw, tiles, numbers);
        self.low = _mm256_dpwssd_epi32(self.low, low, numbers);
    }
}

/// The low bytes of lanes.
#[target_feature(enable = "avx2")]
fn low_bytes(lanes: __m256i) -> __m256i {
    _mm256_srai_epi16(_mm256_slli_epi16(lanes, 8), 8)
}

/// The inner loops and the type of a level.
macro_rules! level {
    ($(#[$doc:meta])* $type:ident, $module:ident, $features:literal, $add:ident) => {
        $(#[$doc])*
        pub(super) enum $type {}

        impl Lines for $type {
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
                unsafe { Sse2::widen(from, to, distance, pixels, channels) };
            }

            unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]) {
                // SAFETY: the caller's promise, and the processor has what is needed.
                unsafe { $module::run(map, shape, window, line) };
            }
        }

        impl Vectors for $type {
            unsafe fn sums(tiles: &[Tile], input: *const i16) -> [i32; EDGE] {
                // SAFETY: the caller's promise, and the processor has what is needed.
                unsafe { $module::sums(tiles, input) }
            }
        }

        mod $module {
            use super::*;

        /// R and S of a run of tiles for some pixels.
        ///
        /// # Safety
        ///
        /// There must be four numbers for each tile, from each pixel's window on.
        #[target_feature(enable = $features)]
        unsafe fn add_tiles<const PIXELS: usize>(
            tiles: &[Tile],
            window: *const i16,
            distance: usize,
            sums: &mut [Sums; PIXELS],
        ) {
            let (pairs, rest) = tiles.as_chunks::<2>();
            let mut window = window;
            for pair in pairs {
                // SAFETY: 32 bytes of two tiles; the numbers are the caller's promise.
                unsafe {
                    let tiles = _mm256_loadu_si256(pair.as_ptr().cast());
                    let low = low_bytes(tiles);
                    for (pixel, sums) in sums.iter_mut().enumerate() {
                        let eight = _mm_loadu_si128(window.add(pixel * distance).cast());
                        // Each four twice: for both halves of its tile.
                        let eight = _mm256_broadcastsi128_si256(eight);
                        let twice = _mm256_permute_pd(_mm256_castsi256_pd(eight), 0b1100);
                        sums.$add(tiles, low, _mm256_castpd_si256(twice));
                    }
                    window = window.add(GROUP);
                }
            }
            if let [tile] = rest {
                // SAFETY: 16 bytes of a tile; four numbers are the caller's promise.
                unsafe {
                    let tile = _mm256_zextsi128_si256(_mm_loadu_si128(tile.as_ptr().cast()));
                    let low = low_bytes(tile);
                    for (pixel, sums) in sums.iter_mut().enumerate() {
                        let four = _mm_loadl_epi64(window.add(pixel * distance).cast());
                        let twice = _mm256_zextsi128_si256(_mm_unpacklo_epi64(four, four));
                        sums.$add(tile, low, twice);
                    }
                }
            }
        }

        /// As [`Lines::run`].
        ///
        /// # Safety
        ///
        /// As there.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]) {
            const AT_ONCE: usize = 4;
            let &Shape { pixels, distance, group, tiles: per_group } = shape;
            let low = _mm256_set1_epi8(map.low);
            let rows = map.bias.len();
            let lists = map.bias.chunks(EDGE).zip(map.multipliers.chunks(EDGE));
            for (index, (tiles, (bias, multipliers))) in
                map.weights.chunks_exact(map.stride()).zip(lists).enumerate()
            {
                let block = Block::new(bias, multipliers, map.zero);
                let first = line.as_mut_ptr().wrapping_add(EDGE * index);
                let mut pixel = 0;
                while pixel < pixels {
                    // SAFETY: the caller's promise: from each pixel's window on lie all groups, and the line has
                    // room for the four rows of this block of each pixel.
                    unsafe {
                        let window = window.add(pixel * distance);
                        let put = |at: usize, bytes: i32| {
                            first.add((pixel + at) * rows).cast::<i32>().write_unaligned(bytes);
                        };
                        if pixel + AT_ONCE <= pixels {
                            let mut sums = [Sums::new(); AT_ONCE];
                            for (at, tiles) in tiles.chunks(per_group.max(1)).enumerate() {
                                add_tiles(tiles, window.add(at * group), distance, &mut sums);
                            }
                            let [a, b, c, d] = sums;
                            // (a, c | b, d) after the first pack, which works within halves.
                            let packed = _mm256_packs_epi32(block.finish(a, b), block.finish(c, d));
                            let packed = _mm256_max_epi8(_mm256_packs_epi16(packed, packed), low);
                            put(0, _mm256_extract_epi32(packed, 0));
                            put(1, _mm256_extract_epi32(packed, 4));
                            put(2, _mm256_extract_epi32(packed, 1));
                            put(3, _mm256_extract_epi32(packed, 5));
                            pixel += AT_ONCE;
                        } else {
                            let mut sums = [Sums::new()];
                            for (at, tiles) in tiles.chunks(per_group.max(1)).enumerate() {
                                add_tiles(tiles, window.add(at * group), distance, &mut sums);
                            }
                            let [a] = sums;
                            let packed = block.finish(a, a);
                            let packed = _mm256_packs_epi32(packed, packed);
                            let packed = _mm256_max_epi8(_mm256_packs_epi16(packed, packed), low);
                            put(0, _mm256_extract_epi32(packed, 0));
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
        #[target_feature(enable = $features)]
        pub(super) unsafe fn sums(tiles: &[Tile], input: *const i16) -> [i32; EDGE] {
            let mut sums = [Sums::new()];
            // SAFETY: the caller's promise.
            unsafe { add_tiles(tiles, input, 0, &mut sums) };
            let [sums] = sums.map(|sums| sums.reduce());
            let (ra, rb) = (_mm_extract_epi32(sums, 0), _mm_extract_epi32(sums, 1));
            let (sa, sb) = (_mm_extract_epi32(sums, 2), _mm_extract_epi32(sums, 3));
            [sa, ra.wrapping_sub(sa) >> 8, sb, rb.wrapping_sub(sb) >> 8]
        }

        }
    };
}

level!(
    /// AVX2. Only a processor that has it may come here.
    Avx2,
    of_avx2,
    "avx2",
    add
);
level!(
    /// AVX2 with AVX-512 VNNI. Only a processor that has both may come here.
    Vnni,
    of_vnni,
    "avx2,avx512f,avx512vl,avx512vnni",
    add_vnni
);

/// The definition, compiled for AVX2: four sums at once.
#[target_feature(enable = "avx2")]
pub(super) fn requantize_all(map: &Linear<'_>, sums: &[i32], output: &mut [i8]) {
    scalar::requantize_all(map, sums, output);
}

/// The definition, compiled for AVX2: eight elements at once.
#[target_feature(enable = "avx2")]
pub(super) fn add_residual(add: &Addition, values: &mut [i8], others: &[i8]) {
    scalar::add_residual(add, values, others);
}
