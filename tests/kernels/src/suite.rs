//! Every kernel of an instruction set against the definition.

use core::fmt;

use vantage_core::kernels::{
    Addition, EDGE, Grid, LARGEST_ADDITION, Linear, Order, Rows, requantize, scalar,
};

use crate::Kernels;
use crate::chance::{Chance, Extreme, Owned, ROWS};

/// Lengths are tried up to here, one by one: past three times 32 bytes.
const WIDEST: usize = 100;
/// Bytes before and behind an output, which no kernel may touch.
const MARGIN: usize = 36;
const MARK: i8 = 0x5a;
/// The largest map that is tried.
const MAP: usize = 32 * 32 * 16;
/// The largest output.
const OUTPUT: usize = 32 * 32 * 16;

/// Where a kernel differs from the definition.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// The instruction set.
    pub kernels: &'static str,
    /// The kernel.
    pub kernel: &'static str,
    /// The case: sizes, in the order of its test.
    pub case: [usize; 6],
    /// The seed of its numbers.
    pub seed: u64,
    /// The first place that differs; that of the margin is counted from before the output.
    pub place: usize,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kernels, kernel, case, seed, place } = self;
        write!(f, "{kernels}: {kernel} differs at {place} in the case {case:?} of seed {seed}")
    }
}

/// Memory of the suite: 200 KB.
pub struct Room {
    layer: Owned,
    input: [i8; MAP + 8],
    output: [i8; OUTPUT + 2 * MARGIN],
    expected: [i8; OUTPUT + 2 * MARGIN],
    rows: Rows,
}

impl Room {
    /// Zeros.
    pub const fn new() -> Self {
        Self {
            layer: Owned::new(),
            input: [0; MAP + 8],
            output: [0; OUTPUT + 2 * MARGIN],
            expected: [0; OUTPUT + 2 * MARGIN],
            rows: Rows::new(),
        }
    }
}

impl Default for Room {
    fn default() -> Self {
        Self::new()
    }
}

/// Runs every test with numbers from a seed; gives how many cases were compared.
///
/// `rounds` is how many layers of each kind are drawn by chance.
pub fn run<K: Kernels>(room: &mut Room, seed: u64, rounds: usize) -> Result<usize, Difference> {
    let mut suite = Suite { room, seed, count: 0 };
    suite.dense::<K>()?;
    suite.requantized::<K>()?;
    suite.residual::<K>()?;
    suite.pixels::<K>()?;
    suite.convolutions::<K>()?;
    for round in 0..rounds {
        suite.seed = seed.wrapping_add(1 + round as u64);
        suite.by_chance::<K>()?;
    }
    Ok(suite.count)
}

struct Suite<'r> {
    room: &'r mut Room,
    seed: u64,
    count: usize,
}

/// A convolution to be tried.
#[derive(Clone, Copy)]
struct Case {
    channels: usize,
    rows: usize,
    side: usize,
    stride: usize,
    offset: usize,
    extreme: Extreme,
    windows: Windows,
}

/// What a window of 3 x 3 is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Windows {
    All,
    Colours,
    Alone,
}

impl Suite<'_> {
    /// Every number of columns past three vector widths, and some more; every alignment.
    fn dense<K: Kernels>(&mut self) -> Result<(), Difference> {
        for columns in (0..=WIDEST).chain([255, 256, 288, 292, 516, 768, 1024]) {
            for rows in [1, 4, 7, 8] {
                let offset = (columns + rows) % 4;
                self.fully_connected::<K>(columns, rows, offset, Extreme::None)?;
            }
            for extreme in [Extreme::None, Extreme::Sums] {
                self.fully_connected::<K>(columns, 12, 0, extreme)?;
            }
        }
        self.fully_connected::<K>(64, 128, 0, Extreme::None)?;
        self.fully_connected::<K>(20, 0, 0, Extreme::None)
    }

    fn fully_connected<K: Kernels>(
        &mut self,
        columns: usize,
        rows: usize,
        offset: usize,
        extreme: Extreme,
    ) -> Result<(), Difference> {
        let case = [columns, rows, offset, extreme as usize, 0, 0];
        let Room { layer, input, output, expected, .. } = &mut *self.room;
        let mut chance = Chance::new(self.seed);
        layer.draw(rows, Order::Plain { columns }, extreme, offset, &mut chance);
        let map = layer.linear();
        let input = &mut input[offset..][..columns];
        draw(input, extreme, &mut chance);

        output.fill(MARK);
        expected.fill(MARK);
        K::fully_connected(&map, input, &mut output[MARGIN + offset..][..rows]);
        scalar::fully_connected(&map, input, &mut expected[MARGIN + offset..][..rows]);
        let narrow = difference(output, expected);

        let (mut wide, mut expected_wide) = ([1; ROWS], [1; ROWS]);
        K::fully_connected_wide(&map, input, &mut wide[..rows]);
        scalar::fully_connected_wide(&map, input, &mut expected_wide[..rows]);

        // The whole in two parts, of which the first has whole tiles.
        let cut = columns / 3 / EDGE * EDGE;
        let (mut sums, mut expected_sums) = ([7; ROWS], [7; ROWS]);
        for (first, part) in [(0, 0..cut), (cut, cut..columns)] {
            let part = &input[part];
            K::accumulate(&map, first, part, &mut sums[..rows]);
            scalar::accumulate(&map, first, part, &mut expected_sums[..rows]);
        }
        self.check::<K>("fully_connected", case, narrow)?;
        self.check::<K>("fully_connected_wide", case, difference(&wide, &expected_wide))?;
        self.check::<K>("accumulate", case, difference(&sums, &expected_sums))
    }

    /// Halves of both signs, sums at the ends of 32 bits, every zero point and cut.
    fn requantized<K: Kernels>(&mut self) -> Result<(), Difference> {
        let halves = [-7, -6, -5, -3, -2, -1, 0, 1, 2, 3, 5, 6, 7];
        let mut sums = [0; 64];
        let ends = [i32::MIN, i32::MIN + 1, -(1 << 30), 1 << 30, i32::MAX - 1, i32::MAX];
        for (place, sum) in sums.iter_mut().zip(halves.into_iter().chain(ends).cycle()) {
            *place = sum;
        }
        let multipliers = [0, 1, 1 << 29, 1 << 30, (1 << 30) + 1, i32::MAX - 1, i32::MAX];
        for multiplier in multipliers.map(i32::to_le_bytes) {
            for zero in [-128, -127, -1, 0, 1, 126, 127] {
                for low in [-128, zero] {
                    for count in [0, 1, 3, 4, 5, 17, 63, 64] {
                        let multipliers = [multiplier; 64];
                        let multipliers = &multipliers[..count];
                        let map = Linear { multipliers, zero, low, ..Linear::default() };
                        let mut output = [MARK; 64];
                        K::requantize_all(&map, &sums[..count], &mut output);
                        let mut expected = [MARK; 64];
                        for (place, &sum) in expected.iter_mut().zip(&sums).take(count) {
                            *place = requantize(sum, i32::from_le_bytes(multiplier), zero, low);
                        }
                        let multiplier = i32::from_le_bytes(multiplier) as usize;
                        let case =
                            [multiplier, zero as u8 as usize, low as u8 as usize, count, 0, 0];
                        self.check::<K>("requantize_all", case, difference(&output, &expected))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Every length and alignment; the largest multipliers.
    fn residual<K: Kernels>(&mut self) -> Result<(), Difference> {
        for length in 0..=WIDEST {
            for (offset, other) in [(0, 0), (1, 0), (0, 3), (2, 1), (3, 3)] {
                let mut chance = Chance::new(self.seed);
                let multiplier = match length % 3 {
                    0 => LARGEST_ADDITION,
                    _ => chance.below(LARGEST_ADDITION as usize) as i32,
                };
                let rest = LARGEST_ADDITION - multiplier;
                let other_multiplier = if length % 2 == 0 { rest } else { rest / 2 };
                let add = Addition {
                    multiplier,
                    other_multiplier,
                    zero_in: chance.byte(),
                    other_zero_in: chance.byte(),
                    zero: chance.byte(),
                };
                let Room { input, output, expected, .. } = &mut *self.room;
                let others = &mut input[other..][..length];
                others.fill_with(|| chance.byte());
                output.fill_with(|| chance.byte());
                expected.copy_from_slice(output);
                K::add_residual(&add, &mut output[MARGIN + offset..][..length], others);
                let place = &mut expected[MARGIN + offset..][..length];
                scalar::add_residual(&add, place, others);
                let place = difference(output, expected);
                self.check::<K>("add_residual", [length, offset, other, 0, 0, 0], place)?;
            }
        }
        Ok(())
    }

    /// Every number of pixels past three vector widths.
    fn pixels<K: Kernels>(&mut self) -> Result<(), Difference> {
        for (channels, rows) in [(8, 4), (32, 8), (5, 8), (24, 5), (64, 12)] {
            for pixels in (0..=WIDEST).step_by(if channels == 32 { 1 } else { 7 }) {
                self.pointwise::<K>(channels, rows, pixels, pixels % 5 % 4)?;
            }
        }
        Ok(())
    }

    fn pointwise<K: Kernels>(
        &mut self,
        channels: usize,
        rows: usize,
        pixels: usize,
        offset: usize,
    ) -> Result<(), Difference> {
        let Room { layer, input, output, expected, rows: memory } = &mut *self.room;
        let mut chance = Chance::new(self.seed);
        let order = Order::Plain { columns: channels };
        layer.draw(rows, order, Extreme::None, offset, &mut chance);
        let input = &mut input[offset..][..pixels * channels];
        input.fill_with(|| chance.byte());
        output.fill(MARK);
        expected.fill(MARK);
        let part = MARGIN + offset..MARGIN + offset + pixels * rows;
        K::pointwise(&layer.linear(), channels, input, memory, &mut output[part.clone()]);
        scalar::pointwise(&layer.linear(), channels, input, memory, &mut expected[part]);
        let place = difference(output, expected);
        self.check::<K>("pointwise", [channels, rows, pixels, offset, 0, 0], place)
    }

    /// Every side up to 14 and those of networks, every number of channels past two groups.
    fn convolutions<K: Kernels>(&mut self) -> Result<(), Difference> {
        let extremes = [Extreme::None, Extreme::Sums];
        let plain = Case {
            channels: 8,
            rows: 4,
            side: 6,
            stride: 1,
            offset: 0,
            extreme: Extreme::None,
            windows: Windows::All,
        };
        let alone = Case { windows: Windows::Alone, ..plain };
        for stride in [1, 2] {
            for side in 0..15 {
                self.convolve::<K>(Case { side, stride, ..plain })?;
                self.convolve::<K>(Case { side, stride, offset: side % 4, ..plain })?;
                self.colours::<K>(side, stride, side % 4, Extreme::None)?;
                self.colours::<K>(side, stride, 0, Extreme::Sums)?;
                let offset = (side + stride) % 4;
                self.convolve::<K>(Case { side, stride, offset, channels: 12, ..alone })?;
            }
            for channels in (0..=WIDEST).chain([127, 128]) {
                let offset = channels % 5 % 4;
                self.convolve::<K>(Case { channels, side: 5, stride, offset, ..alone })?;
                let extreme = Extreme::Sums;
                self.convolve::<K>(Case { channels, side: 4, stride, extreme, ..alone })?;
            }
            // Sides that are too long for some kernels' memory, and one of a network.
            for (side, channels) in [(76, 2), (77, 2), (79, 2), (120, 1), (32, 16)] {
                self.convolve::<K>(Case { side, channels, stride, ..alone })?;
            }
            for channels in (1..=20).chain([24, 32, 48, 60, 64, 65]) {
                for extreme in extremes {
                    self.convolve::<K>(Case { channels, stride, extreme, ..plain })?;
                }
            }
            for rows in [1, 2, 3, 6, 8, 20] {
                self.convolve::<K>(Case { rows, stride, ..plain })?;
            }
            for (side, channels, rows) in [(32, 16, 16), (16, 24, 12), (8, 64, 8), (4, 48, 48)] {
                self.convolve::<K>(Case { side, channels, rows, stride, ..plain })?;
            }
            self.colours::<K>(64, stride, 0, Extreme::None)?;
        }
        // A stride that no network has.
        self.convolve::<K>(Case { stride: 3, ..plain })?;
        self.convolve::<K>(Case { stride: 3, ..alone })
    }

    fn colours<K: Kernels>(
        &mut self,
        side: usize,
        stride: usize,
        offset: usize,
        extreme: Extreme,
    ) -> Result<(), Difference> {
        let rows = if side > 32 { 4 } else { 8 };
        let windows = Windows::Colours;
        self.convolve::<K>(Case { channels: 3, rows, side, stride, offset, extreme, windows })
    }

    fn convolve<K: Kernels>(&mut self, case: Case) -> Result<(), Difference> {
        let Case { channels, side, stride, offset, extreme, windows, .. } = case;
        let (order, rows) = match windows {
            Windows::All => (Order::Window { channels }, case.rows),
            Windows::Colours => (Order::Colours, case.rows),
            Windows::Alone => (Order::Plain { columns: 9 }, channels),
        };
        let Room { layer, input, output, expected, rows: memory } = &mut *self.room;
        let mut chance = Chance::new(self.seed);
        layer.draw(rows, order, extreme, offset, &mut chance);
        let values = &mut input[offset..][..side * side * channels];
        draw(values, extreme, &mut chance);
        let border = chance.byte();
        let grid = Grid { values, side, channels, border };
        output.fill(MARK);
        expected.fill(MARK);
        let out = side.div_ceil(stride);
        let part = MARGIN + offset..MARGIN + offset + out * out * rows;
        let (got, wanted) = (&mut output[part.clone()], &mut expected[part]);
        let map = layer.linear();
        let name = match windows {
            Windows::All => {
                K::convolve(&map, stride, &grid, memory, got);
                scalar::convolve(&map, stride, &grid, memory, wanted);
                "convolve"
            }
            Windows::Colours => {
                K::convolve_colours(&map, stride, &grid, memory, got);
                scalar::convolve_colours(&map, stride, &grid, memory, wanted);
                "convolve_colours"
            }
            Windows::Alone => {
                K::depthwise(&map, stride, &grid, memory, got);
                scalar::depthwise(&map, stride, &grid, memory, wanted);
                "depthwise"
            }
        };
        let place = difference(output, expected);
        self.check::<K>(name, [channels, rows, side, stride, offset, extreme as usize], place)
    }

    /// One case of each kind, all sizes by chance.
    fn by_chance<K: Kernels>(&mut self) -> Result<(), Difference> {
        let mut chance = Chance::new(!self.seed);
        let mut below = |bound| chance.below(bound);
        let extreme = if below(4) == 0 { Extreme::Sums } else { Extreme::None };
        self.fully_connected::<K>(below(300), below(33), below(4), extreme)?;
        self.pointwise::<K>(1 + below(64), 1 + below(16), below(100), below(4))?;
        let case = Case {
            channels: 4 * (1 + below(16)),
            rows: 4 * (1 + below(6)),
            side: below(11),
            stride: 1 + below(2),
            offset: if below(2) == 0 { 0 } else { below(4) },
            extreme,
            windows: Windows::All,
        };
        self.convolve::<K>(case)?;
        let [channels, side] = [1 + below(64), below(16)];
        self.convolve::<K>(Case { channels, side, windows: Windows::Alone, ..case })?;
        let windows = Windows::Colours;
        self.convolve::<K>(Case { channels: 3, side: below(20), windows, ..case })
    }

    fn check<K: Kernels>(
        &mut self,
        kernel: &'static str,
        case: [usize; 6],
        place: Option<usize>,
    ) -> Result<(), Difference> {
        self.count += 1;
        match place {
            Some(place) => {
                Err(Difference { kernels: K::NAME, kernel, case, seed: self.seed, place })
            }
            None => Ok(()),
        }
    }
}

/// An input by chance, or one that drives sums to their ends.
fn draw(input: &mut [i8], extreme: Extreme, chance: &mut Chance) {
    match extreme {
        Extreme::None => input.fill_with(|| chance.byte()),
        Extreme::Sums => input.fill(if chance.below(2) == 0 { -128 } else { 127 }),
    }
}

fn difference<T: PartialEq>(a: &[T], b: &[T]) -> Option<usize> {
    a.iter().zip(b).position(|(a, b)| a != b)
}
