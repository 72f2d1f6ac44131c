//! Every kernel against plain sums in 128 bits, extremes and rounding halves included.

use std::vec;
use std::vec::Vec;

use super::*;
use proptest::prelude::*;

/// `value / 2^bits` rounded, halves up, by division instead of shifting.
fn rounded(value: i128, bits: u32) -> i128 {
    (2 * value + (1i128 << bits)).div_euclid(2i128 << bits)
}

fn byte() -> impl Strategy<Value = i8> {
    prop_oneof![1 => Just(-128i8), 1 => Just(127i8), 1 => Just(0i8), 3 => any::<i8>()]
}

fn weight() -> impl Strategy<Value = i8> {
    prop_oneof![1 => Just(-127i8), 1 => Just(127i8), 3 => -127i8..=127]
}

fn multiplier() -> impl Strategy<Value = i32> {
    prop_oneof![
        Just(0),
        Just(1),
        Just(i32::MAX),
        0..1 << 26,
        any::<i32>().prop_map(|m| m & i32::MAX)
    ]
}

/// A linear map with its memory.
#[derive(Clone, Debug)]
struct Owned {
    rows: Vec<Vec<i8>>,
    bias: Vec<i32>,
    multipliers: Vec<i32>,
    zero: i8,
    cut: bool,
    order: Order,
    tiles: Vec<Tile>,
    bias_bytes: Vec<[u8; 4]>,
    multiplier_bytes: Vec<[u8; 4]>,
}

/// The tiles of a layer, by the plain reading of [`Order`].
fn tiles(rows: &[Vec<i8>], order: Order) -> Vec<Tile> {
    let blocks = rows.chunks(EDGE).flat_map(|rows| {
        (0..order.packed()).step_by(EDGE).map(move |first| {
            let weight = |row: usize, within: usize| {
                let column = order.source(first + within)?;
                rows.get(row).map(|row| row[column])
            };
            let row = |row| [0, 1, 2, 3].map(|within| weight(row, within).unwrap_or(0));
            pack([0, 1, 2, 3].map(row))
        })
    });
    blocks.collect()
}

impl Owned {
    fn low(&self) -> i8 {
        if self.cut { self.zero } else { -128 }
    }

    fn linear(&self) -> Linear<'_> {
        Linear {
            weights: &self.tiles,
            columns: self.order.packed(),
            bias: &self.bias_bytes,
            multipliers: &self.multiplier_bytes,
            zero: self.zero,
            low: self.low(),
        }
    }

    fn sum(&self, row: usize, input: &[i8]) -> i128 {
        assert_eq!(input.len(), self.rows[row].len());
        let products =
            self.rows[row].iter().zip(input).map(|(&w, &q)| i128::from(w) * i128::from(q));
        i128::from(self.bias[row]) + products.sum::<i128>()
    }

    fn expected_of(&self, row: usize, input: &[i8]) -> i8 {
        let scaled = rounded(self.sum(row, input) * i128::from(self.multipliers[row]), 32);
        (scaled + i128::from(self.zero)).clamp(i128::from(self.low()), 127) as i8
    }

    fn expected(&self, input: &[i8]) -> Vec<i8> {
        (0..self.rows.len()).map(|row| self.expected_of(row, input)).collect()
    }
}

fn owned(rows: usize, order: Order) -> impl Strategy<Value = Owned> {
    let weights = prop::collection::vec(prop::collection::vec(weight(), order.columns()), rows);
    let bias = prop::collection::vec(-(1i32 << 24)..1 << 24, rows);
    let multipliers = prop::collection::vec(multiplier(), rows);
    (weights, bias, multipliers, byte(), any::<bool>()).prop_map(
        move |(rows, bias, multipliers, zero, cut)| {
            let le = |values: &[i32]| values.iter().map(|v| v.to_le_bytes()).collect();
            Owned {
                tiles: tiles(&rows, order),
                bias_bytes: le(&bias),
                multiplier_bytes: le(&multipliers),
                order,
                rows,
                bias,
                multipliers,
                zero,
                cut,
            }
        },
    )
}

/// A map and an input for it.
fn case() -> impl Strategy<Value = (Owned, Vec<i8>)> {
    (1usize..9, 1usize..70).prop_flat_map(|(rows, columns)| {
        (owned(rows, Order::Plain { columns }), prop::collection::vec(byte(), columns))
    })
}

/// A convolution: map, stride, side, channels, border and input.
fn convolution() -> impl Strategy<Value = (Owned, usize, usize, usize, i8, Vec<i8>)> {
    (1usize..9, 1usize..18, 1usize..=2, 1usize..7).prop_flat_map(
        |(rows, channels, stride, side)| {
            // Three channels at once are colours.
            let order = match channels {
                3 => Order::Colours,
                _ => Order::Window { channels },
            };
            let input = prop::collection::vec(byte(), side * side * channels);
            (owned(rows, order), Just(stride), Just(side), Just(channels), byte(), input)
        },
    )
}

/// A convolution of each channel alone: map, stride, side, border and input.
fn depthwise_convolution() -> impl Strategy<Value = (Owned, usize, usize, i8, Vec<i8>)> {
    (1usize..20, 1usize..=2, 1usize..9).prop_flat_map(|(channels, stride, side)| {
        let input = prop::collection::vec(byte(), side * side * channels);
        (owned(channels, Order::Plain { columns: 9 }), Just(stride), Just(side), byte(), input)
    })
}

proptest! {
    #[test]
    fn fully_connected_is_its_definition((map, input) in case()) {
        let mut output = vec![99; map.rows.len()];
        fully_connected(&map.linear(), &input, &mut output);
        prop_assert_eq!(output, map.expected(&input));
    }

    #[test]
    fn wide_is_its_definition((map, input) in case()) {
        let mut output = vec![99; map.rows.len()];
        fully_connected_wide(&map.linear(), &input, &mut output);
        for (row, output) in output.into_iter().enumerate() {
            let scaled = rounded(map.sum(row, &input) * i128::from(map.multipliers[row]), 20);
            prop_assert_eq!(i128::from(output), scaled.clamp(i32::MIN.into(), i32::MAX.into()));
        }
    }

    #[test]
    fn parts_accumulate_to_the_whole((map, input) in case(), cut in 0usize..70) {
        let cut = (cut / EDGE * EDGE).min(input.len() / EDGE * EDGE);
        let mut sums = map.bias.clone();
        accumulate(&map.linear(), 0, &input[..cut], &mut sums);
        accumulate(&map.linear(), cut, &input[cut..], &mut sums);
        for (row, &sum) in sums.iter().enumerate() {
            prop_assert_eq!(i128::from(sum), map.sum(row, &input));
        }
        let mut output = vec![99; sums.len()];
        requantize_all(&map.linear(), &sums, &mut output);
        prop_assert_eq!(output, map.expected(&input));
    }

    #[test]
    fn each_pixel_is_fully_connected((map, input) in case(), more in 0usize..9) {
        let (channels, rows) = (input.len(), map.rows.len());
        let mut pixels = input.repeat(more + 1);
        let half = pixels.len() / 2;
        pixels[..half].reverse();
        let mut output = vec![99; (more + 1) * rows];
        pointwise(&map.linear(), channels, &pixels, &mut Rows::new(), &mut output);
        for (pixel, output) in pixels.chunks(channels).zip(output.chunks(rows)) {
            prop_assert_eq!(output, map.expected(pixel));
        }
    }

    #[test]
    fn a_convolution_is_its_definition(
        (map, stride, side, channels, border, input) in convolution(),
    ) {
        let (rows, out) = (map.rows.len(), side.div_ceil(stride));
        let mut output = vec![99; out * out * rows];
        let grid = Grid { values: &input, side, channels, border };
        let kernel = if map.order == Order::Colours { convolve_colours } else { convolve };
        kernel(&map.linear(), stride, &grid, &mut Rows::new(), &mut output);
        for (index, got) in output.chunks(rows).enumerate() {
            let (y, x) = ((index / out * stride) as isize, (index % out * stride) as isize);
            let mut window = Vec::new();
            for (y, x) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (y + dy, x + dx))) {
                let inside = 0..side as isize;
                for channel in 0..channels {
                    let at = |y: isize, x: isize| input[(y as usize * side + x as usize) * channels + channel];
                    let is_inside = inside.contains(&y) && inside.contains(&x);
                    window.push(if is_inside { at(y, x) } else { border });
                }
            }
            prop_assert_eq!(got, map.expected(&window));
        }
    }

    #[test]
    fn a_convolution_of_each_channel_alone_is_its_definition(
        (map, stride, side, border, input) in depthwise_convolution(),
    ) {
        let (channels, out) = (map.rows.len(), side.div_ceil(stride));
        let mut output = vec![99; out * out * channels];
        let grid = Grid { values: &input, side, channels, border };
        depthwise(&map.linear(), stride, &grid, &mut Rows::new(), &mut output);
        for (index, got) in output.chunks(channels).enumerate() {
            let (y, x) = (index / out * stride, index % out * stride);
            for (channel, &got) in got.iter().enumerate() {
                let at = |place: usize| {
                    let (y, x) = ((y + place / 3).checked_sub(1)?, (x + place % 3).checked_sub(1)?);
                    (y < side && x < side).then(|| input[(y * side + x) * channels + channel])
                };
                let window: Vec<i8> = (0..9).map(|place| at(place).unwrap_or(border)).collect();
                prop_assert_eq!(got, map.expected_of(channel, &window));
            }
        }
    }

    #[test]
    fn a_tile_gives_its_weights_back(weights in prop::array::uniform4(prop::array::uniform4(weight()))) {
        prop_assert_eq!(unpack(&pack(weights)), weights);
    }

    #[test]
    fn a_tile_of_any_bytes_is_ours_or_shows_a_weight_of_minus_128(tile: Tile) {
        let weights = unpack(&tile);
        let ours = weights.as_flattened().iter().all(|&weight| weight != -128);
        prop_assert!(!ours || pack(weights) == tile);
    }

    #[test]
    fn a_sum_of_maps_is_its_definition(
        pairs in prop::collection::vec((byte(), byte()), 0..40),
        share in 0..=LARGEST_ADDITION, multiplier in 0..=LARGEST_ADDITION,
        zero_in in byte(), other_zero_in in byte(), zero in byte(),
    ) {
        let (multiplier, other_multiplier) = (multiplier.min(LARGEST_ADDITION - share), share);
        let add = Addition { multiplier, other_multiplier, zero_in, other_zero_in, zero };
        let (mut values, others): (Vec<i8>, Vec<i8>) = pairs.iter().copied().unzip();
        add_residual(&add, &mut values, &others);
        for ((value, other), got) in pairs.into_iter().zip(values) {
            let a = (i128::from(value) - i128::from(zero_in)) * i128::from(multiplier);
            let b = (i128::from(other) - i128::from(other_zero_in)) * i128::from(other_multiplier);
            let expected = (rounded(a + b, 18) + i128::from(zero)).clamp(zero.into(), 127);
            prop_assert_eq!(i128::from(got), expected);
        }
    }

    #[test]
    fn requantizing_rounds_halves_up(
        sum in any::<i32>(), multiplier in any::<i32>(), zero in byte(), low in byte(),
    ) {
        let scaled = rounded(i128::from(sum) * i128::from(multiplier), 32) + i128::from(zero);
        let expected = scaled.clamp(low.into(), 127);
        prop_assert_eq!(i128::from(requantize(sum, multiplier, zero, low)), expected);
    }

    #[test]
    fn a_mean_rounds_halves_up(values in prop::collection::vec(byte(), 1..70)) {
        let sum: i32 = values.iter().copied().map(i32::from).sum();
        let exact = f64::from(sum) / values.len() as f64;
        prop_assert_eq!(f64::from(mean(sum, values.len() as i32)), (exact + 0.5).floor());
    }
}

#[test]
fn halves_go_up_on_both_sides_of_zero() {
    let half = 1 << 30; // a quarter, in units of 2^-32
    for (sum, expected) in [(-6, -1), (-2, 0), (-1, 0), (0, 0), (1, 0), (2, 1), (3, 1), (6, 2)] {
        assert_eq!(requantize(sum, half, 0, -128), expected, "{sum} / 4");
    }
    assert_eq!(requantize(-6, half, 10, -128), 9);
    assert_eq!(requantize(i32::MAX, i32::MAX, 127, -128), 127);
    assert_eq!(requantize(i32::MIN, i32::MAX, -128, -128), -128);
    assert_eq!(requantize(i32::MIN, i32::MIN, -128, -128), 127);
    assert_eq!([requantize_wide(1, 1 << 19), requantize_wide(-1, 1 << 19)], [1, 0]);
    assert_eq!(requantize_wide(i32::MIN, i32::MAX), i32::MIN);
    assert_eq!([mean(1, 2), mean(-1, 2), mean(-3, 2), mean(5, 0)], [1, 0, -1, 0]);
}

#[test]
fn every_column_of_a_layer_has_one_place() {
    let orders = [Order::Plain { columns: 27 }, Order::Window { channels: 12 }, Order::Colours];
    for order in orders {
        let mut places: Vec<_> = (0..order.packed()).filter_map(|at| order.source(at)).collect();
        places.sort_unstable();
        assert_eq!(places, (0..order.columns()).collect::<Vec<_>>(), "{order:?}");
        assert_eq!(order.packed() % EDGE, 0);
    }
}

#[test]
fn odd_lengths_give_nothing_and_no_panic() {
    let mut output = [7; 4];
    let grid = Grid { values: &[1; 4], side: 2, channels: 1, border: 0 };
    let rows = &mut Rows::new();
    convolve(&Linear::default(), 1, &grid, rows, &mut output);
    convolve_colours(&Linear::default(), 1, &grid, rows, &mut output);
    pointwise(&Linear::default(), 0, &[], rows, &mut output);
    depthwise(&Linear::default(), 1, &grid, rows, &mut output);
    depthwise(&Linear::default(), 0, &Grid::default(), rows, &mut output);
    fully_connected(&Linear::default(), &[], &mut output);
    let bias = [[0; 4]];
    let wide = Linear { columns: 72 * 9, bias: &bias, ..Linear::default() };
    convolve(&wide, 1, &Grid { channels: 65, ..grid }, rows, &mut output);
    assert_eq!(output, [7; 4]);
}
