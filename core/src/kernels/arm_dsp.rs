//! The DSP extension of Armv7E-M: Cortex-M4, M7.
//!
//! ```text
//! plain:   sum = bias + Σ_c weights[r, c] · input[c], for each output pixel and each row r
//! here:    R, S += two columns at once: smlad of the lanes as they are, and of their low bytes,
//!          for two rows and for three (or two) neighbouring pixels
//!          first row's sum = S, second row's sum = (R - S) >> 8
//! ```
//!
//! The windows of neighbours lie a constant distance apart (see `windows`), so one pointer reaches them
//! all. Six sums, four registers of weights, two of an input and two
//! pointers are all there are; hence functions without a prologue, whose registers are ours, and whose
//! other numbers lie on the stack. A step of four columns takes 18 instructions for 24 products.
//!
//! Numbers are read a word at a time: `ldr` takes any address, `ldrd` and `ldm` (weights, widened
//! rows) want a multiple of 4. What is aligned otherwise, or has another shape, goes to [`scalar`].

use core::arch::{asm, naked_asm};
use core::mem::MaybeUninit;

use super::windows::{self, Lines, Shape, is_whole};
use super::{Addition, EDGE, GROUP, Grid, Linear, Rows, Tile, scalar};

mod depthwise;

pub use depthwise::depthwise;
pub use scalar::fully_connected_wide;

/// Columns that are widened at once, 2 KiB of stack.
const WIDENED: usize = 1024;

/// Adds a part of a linear map, without its bias. As [`scalar::accumulate`].
pub fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]) {
    let stride = map.stride();
    let fits = is_aligned(map) && first.is_multiple_of(EDGE) && sums.len().is_multiple_of(EDGE);
    if !fits {
        return scalar::accumulate(map, first, input, sums);
    }
    let mut buffer = MaybeUninit::<[u32; WIDENED / 2]>::uninit();
    let mut tile = first / EDGE;
    for part in input.chunks(WIDENED) {
        let count = part.len().div_ceil(EDGE).min(stride.saturating_sub(tile));
        if count == 0 {
            return;
        }
        // SAFETY: `count` groups of four are at most `WIDENED` numbers, which the buffer holds, and
        // four times `count` is at least the number of bytes that are read.
        unsafe { widen(part, buffer.as_mut_ptr().cast(), count) };
        let blocks = sums.as_chunks_mut::<EDGE>().0.iter_mut();
        for (sums, tiles) in blocks.zip(map.weights.chunks_exact(stride)) {
            if let Some(tiles) = tiles.get(tile..tile.saturating_add(count)) {
                // SAFETY: there are `count` tiles, aligned to 4 bytes, and as many groups of four
                // widened numbers, written just now.
                unsafe { dot(tiles.as_ptr(), buffer.as_ptr().cast(), count, sums) };
            }
        }
        tile += count;
    }
}

/// Brings sums to bytes. As [`scalar::requantize_all`].
pub fn requantize_all(map: &Linear<'_>, sums: &[i32], output: &mut [i8]) {
    let zero = i32::from(map.zero);
    for ((output, &sum), multiplier) in output.iter_mut().zip(sums).zip(map.multipliers) {
        let value: i32;
        // SAFETY: arithmetic in registers: `(zero << 32) + sum · multiplier`, its rounded upper half,
        // brought to a byte.
        unsafe {
            asm!(
                "smmlar {value}, {sum}, {multiplier}, {zero}",
                "ssat {value}, #8, {value}",
                value = lateout(reg) value,
                sum = in(reg) sum,
                multiplier = in(reg) i32::from_le_bytes(*multiplier),
                zero = in(reg) zero,
                options(pure, nomem, nostack, preserves_flags),
            );
        }
        *output = (value as i8).max(map.low);
    }
}

/// A fully connected layer. As [`scalar::fully_connected`].
pub fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]) {
    let (rows, stride) = (map.bias.len(), map.stride());
    let fits = Dsp::takes(map)
        && is_whole(map, map.columns)
        && (1..=WIDENED).contains(&input.len())
        && output.len() >= rows;
    if !fits {
        return scalar::fully_connected(map, input, output);
    }
    let count = input.len().div_ceil(EDGE).min(stride);
    let mut buffer = MaybeUninit::<[u32; WIDENED / 2]>::uninit();
    let dense = Dense {
        input: buffer.as_ptr().cast(),
        eights: 8 * (count / 8 * 8),
        twos: 8 * (count / 2 * 2),
        all: 8 * count,
        rest: size_of::<Tile>() * (stride - count),
        bias: map.bias.as_ptr(),
        multipliers: map.multipliers.as_ptr(),
        output: output.as_mut_ptr(),
        blocks: rows / EDGE,
        zero: map.zero.into(),
    };
    // SAFETY: the buffer holds `WIDENED` numbers, and `count` groups of four are no more. Map and
    // output are whole and the map is aligned.
    unsafe {
        widen(input, buffer.as_mut_ptr().cast(), count);
        dense_rows(map.weights.as_ptr(), &dense);
    }
    cut(output.get_mut(..rows).unwrap_or_default(), map.low);
}

/// A fully connected layer of every pixel by itself. As [`scalar::pointwise`].
pub fn pointwise(
    map: &Linear<'_>,
    channels: usize,
    input: &[i8],
    rows: &mut Rows,
    output: &mut [i8],
) {
    if !windows::pointwise::<Dsp>(map, channels, input, rows, output) {
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
    if !windows::convolve::<Dsp>(map, stride, input, rows, output) {
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
    if !windows::convolve_colours::<Dsp>(map, stride, input, rows, output) {
        scalar::convolve_colours(map, stride, input, rows, output);
    }
}

/// Adds a map onto another. As [`scalar::add_residual`].
pub fn add_residual(add: &Addition, values: &mut [i8], others: &[i8]) {
    let constant = add.constant();
    let count = values.len().min(others.len());
    let (Some(values), Some(others)) = (values.get_mut(..count), others.get(..count)) else {
        return;
    };
    let (fours, rest) = values.as_chunks_mut::<4>();
    let (other_fours, other_rest) = others.as_chunks::<4>();
    if !fours.is_empty() {
        // SAFETY: reads as many bytes of both as there are in fours, and writes those of the first.
        unsafe {
            asm!(
                "2:",
                ".rept 4",
                "ldrsb {a}, [{values}]",
                "ldrsb {b}, [{others}], #1",
                "mla {a}, {a}, {m}, {constant}",
                "mla {a}, {b}, {n}, {a}",
                "ssat {a}, #8, {a}, asr #18",
                "strb {a}, [{values}], #1",
                ".endr",
                "subs {count}, {count}, #1",
                "bne 2b",
                a = out(reg) _,
                b = out(reg) _,
                values = inout(reg) fours.as_mut_ptr() => _,
                others = inout(reg) other_fours.as_ptr() => _,
                count = inout(reg) fours.len() => _,
                m = in(reg) add.multiplier,
                n = in(reg) add.other_multiplier,
                constant = in(reg) constant,
                options(nostack),
            );
        }
    }
    scalar::add_residual(add, rest, other_rest);
    cut(fours.as_flattened_mut(), add.zero);
}

/// Raises what is below `low` to it.
fn cut(values: &mut [i8], low: i8) {
    if low > -128 {
        for value in values {
            *value = low.max(*value);
        }
    }
}

/// Whether the lists lie where `ldrd` and `ldm` can read them.
fn is_aligned(map: &Linear<'_>) -> bool {
    let lists =
        [map.weights.as_ptr().addr(), map.bias.as_ptr().addr(), map.multipliers.as_ptr().addr()];
    lists.iter().all(|address| address.is_multiple_of(4))
}

/// Widens `count` groups of four bytes into the order of lanes; what is missing is 0.
///
/// # Safety
///
/// `to` must be aligned to 4 bytes and have room for `4 * count` numbers.
unsafe fn widen(from: &[i8], to: *mut u32, count: usize) {
    let (fours, rest) = from.as_chunks::<EDGE>();
    let mut to = to;
    let last = rest.iter().rev().fold(0, |word, &value| (word << 8) | u32::from(value as u8));
    let words = fours.iter().map(|four| u32::from_le_bytes(four.map(|value| value as u8)));
    for word in words.chain([last]).take(count) {
        // SAFETY: at most `count` words are written twice.
        unsafe {
            asm!(
                "sxtb16 {low}, {word}",
                "sxtb16 {word}, {word}, ror #8",
                "strd {low}, {word}, [{to}], #8",
                word = inout(reg) word => _,
                low = out(reg) _,
                to = inout(reg) to,
                options(nostack, preserves_flags),
            );
        }
    }
}

/// Widens eight channels of each of the `pixels` of a line, `channels` bytes apart, to places
/// `DISTANCE` bytes apart.
///
/// # Safety
///
/// All that must be there; `to` must be aligned to 4 bytes.
unsafe fn widen_row<const DISTANCE: usize>(
    from: *const i8,
    to: *mut i16,
    pixels: usize,
    channels: usize,
) {
    if pixels == 0 {
        return;
    }
    // SAFETY: the caller's promise.
    unsafe {
        asm!(
            "2:",
            "ldr {b}, [{from}, #4]",
            "ldr {a}, [{from}]",
            "add {from}, {channels}",
            "sxtb16 {c}, {b}",
            "sxtb16 {b}, {b}, ror #8",
            "strd {c}, {b}, [{to}, #8]",
            "sxtb16 {c}, {a}",
            "sxtb16 {a}, {a}, ror #8",
            "strd {c}, {a}, [{to}], #{distance}",
            "subs {pixels}, {pixels}, #1",
            "bne 2b",
            a = out(reg) _,
            b = out(reg) _,
            c = out(reg) _,
            from = inout(reg) from => _,
            to = inout(reg) to => _,
            pixels = inout(reg) pixels => _,
            channels = in(reg) channels,
            distance = const DISTANCE,
            options(nostack),
        );
    }
}

/// What an inner loop needs beyond its registers, in the order of its stack.
#[repr(C)]
struct Run {
    weights: *const u8, // two rows of the first tile
    bias: i32,          // the first row's
    window: *const i16, // the first pixel's
    end: *const i16,    // that of the pixel after the last
    group: usize,       // bytes from one group to the next
    last: *const u8,    // behind the weights
    multipliers: [i32; 2],
    second_bias: i32,
    zero: i32,
    output: *mut i8, // both rows of the first pixel
    rows: usize,     // bytes from one pixel to the next
}

type Kernel = unsafe extern "C" fn(&Run);

/// The DSP extension.
enum Dsp {}

impl Lines for Dsp {
    /// There is a loop for two pixels and none for one.
    const LEAST: usize = 2;

    fn takes(map: &Linear<'_>) -> bool {
        is_aligned(map) && map.bias.len().is_multiple_of(EDGE)
    }

    unsafe fn widen(
        from: *const i8,
        to: *mut i16,
        distance: usize,
        pixels: usize,
        channels: usize,
    ) {
        // SAFETY: the caller's promise.
        unsafe {
            match distance {
                GROUP => widen_row::<16>(from, to, pixels, channels),
                _ => widen_row::<48>(from, to, pixels, channels),
            }
        }
    }

    unsafe fn run(map: &Linear<'_>, shape: &Shape, window: *const i16, line: &mut [i8]) {
        let kernels: [Kernel; 2] = match (shape.tiles, shape.distance) {
            (8, 20) => [three_colours_of_two, two_colours_of_two],
            (8, _) => [three_colours_of_one, two_colours_of_one],
            (18, 48) => [three_of_two, two_of_two],
            (18, _) => [three_of_one, two_of_one],
            _ => [three_single, two_single],
        };
        // SAFETY: the caller's promise; the kernels are those of the distance.
        unsafe { run_line(map, shape, kernels, window, line) };
    }
}

/// Computes a line of output pixels: as many threes as leave twos.
///
/// # Safety
///
/// As [`Lines::run`], with the kernels of the shape.
unsafe fn run_line(
    map: &Linear<'_>,
    shape: &Shape,
    [three, two]: [Kernel; 2],
    window: *const i16,
    line: &mut [i8],
) {
    let &Shape { pixels, distance, group, .. } = shape;
    let twos = match pixels % 3 {
        0 => 0,
        1 => 2,
        _ => 1,
    };
    let threes = pixels - 2 * twos;
    let pairs = map.bias.as_chunks::<2>().0.iter().zip(map.multipliers.as_chunks::<2>().0);
    let bytes = size_of::<Tile>() * map.stride();
    let mut weights: *const u8 = map.weights.as_ptr().cast();
    let mut output = line.as_mut_ptr();
    for (index, (biases, multipliers)) in pairs.enumerate() {
        let [bias, second_bias] = biases.map(i32::from_le_bytes);
        // SAFETY: all stay within the rows, the tiles and the line, or just behind them.
        unsafe {
            let mut run = Run {
                weights,
                bias,
                window,
                end: window.add(distance * threes),
                group: 2 * group,
                last: weights.add(bytes),
                multipliers: multipliers.map(i32::from_le_bytes),
                second_bias,
                zero: map.zero.into(),
                output,
                rows: map.bias.len(),
            };
            if threes > 0 {
                three(&run);
            }
            if twos > 0 {
                run.window = run.end;
                run.end = window.add(distance * pixels);
                run.output = output.add(threes * run.rows);
                two(&run);
            }
            // The other half of a tile, then the next block.
            weights = weights.add(if index % 2 == 0 { 8 } else { bytes - 8 });
            output = output.add(2);
        }
    }
    cut(line, map.low);
}

/// An inner loop of three neighbouring pixels whose windows lie `$distance` bytes apart. `$tiles` are
/// the places of a group's tiles in a window, `$half` that of a tile of which two columns count.
macro_rules! three {
    ($name:ident, $distance:expr, $tiles:literal, $half:literal, $groups:literal) => {
        #[unsafe(naked)]
        unsafe extern "C" fn $name(_run: &Run) {
            naked_asm!(
                "push {{r4-r11, lr}}",
                "ldmia r0, {{r1-r12}}",
                "push {{r1-r12}}",
                "mov lr, r3",
                "2:", // three pixels: R and S of each in r0 to r5
                "ldrd r12, r0, [sp]",
                "mov r1, r0",
                "mov r2, r0",
                "mov r3, r0",
                "mov r4, r0",
                "mov r5, r0",
                "3:", // a group of channels
                concat!(".irp at, ", $tiles),
                "ldrd r6, r7, [r12], #16",
                "sxtb16 r8, r6",
                "sxtb16 r9, r7",
                "ldrd r10, r11, [lr, #\\at]",
                "smlad r0, r6, r10, r0",
                "smlad r1, r8, r10, r1",
                "smlad r0, r7, r11, r0",
                "smlad r1, r9, r11, r1",
                "ldrd r10, r11, [lr, #\\at + {distance}]",
                "smlad r2, r6, r10, r2",
                "smlad r3, r8, r10, r3",
                "smlad r2, r7, r11, r2",
                "smlad r3, r9, r11, r3",
                "ldrd r10, r11, [lr, #\\at + 2 * {distance}]",
                "smlad r4, r6, r10, r4",
                "smlad r5, r8, r10, r5",
                "smlad r4, r7, r11, r4",
                "smlad r5, r9, r11, r5",
                ".endr",
                concat!(".irp at, ", $half),
                ".ifnb \\at",
                "ldr r6, [r12]",
                "sxtb16 r8, r6",
                "ldr r10, [lr, #\\at]",
                "smlad r0, r6, r10, r0",
                "smlad r1, r8, r10, r1",
                "ldr r10, [lr, #\\at + {distance}]",
                "smlad r2, r6, r10, r2",
                "smlad r3, r8, r10, r3",
                "ldr r10, [lr, #\\at + 2 * {distance}]",
                "smlad r4, r6, r10, r4",
                "smlad r5, r8, r10, r5",
                ".endif",
                ".endr",
                concat!(".if ", $groups),
                "ldrd r6, r7, [sp, #16]",
                "add lr, r6",
                "cmp r12, r7",
                "bne 3b",
                ".endif",
                "ldrd r6, r7, [sp, #24]", // multipliers
                "ldrd r8, r9, [sp, #32]", // second bias, zero point
                "ldrd r10, r11, [sp, #40]", // output, bytes of a pixel
                "subs r0, r0, r1",
                "subs r2, r2, r3",
                "subs r4, r4, r5",
                "add r0, r8, r0, asr #8",
                "add r2, r8, r2, asr #8",
                "add r4, r8, r4, asr #8",
                "smmlar r1, r1, r6, r9",
                "smmlar r3, r3, r6, r9",
                "smmlar r5, r5, r6, r9",
                "ssat r1, #8, r1",
                "ssat r3, #8, r3",
                "ssat r5, #8, r5",
                "strb r1, [r10]",
                "strb r3, [r10, r11]",
                "strb r5, [r10, r11, lsl #1]",
                "add r10, #1",
                "smmlar r0, r0, r7, r9",
                "smmlar r2, r2, r7, r9",
                "smmlar r4, r4, r7, r9",
                "ssat r0, #8, r0",
                "ssat r2, #8, r2",
                "ssat r4, #8, r4",
                "strb r0, [r10]",
                "strb r2, [r10, r11]",
                "strb r4, [r10, r11, lsl #1]",
                "add r10, r11",
                "add r10, r10, r11, lsl #1",
                "subs r10, #1",
                "str r10, [sp, #40]",
                "ldrd lr, r7, [sp, #8]",
                "add lr, #3 * {distance}",
                "str lr, [sp, #8]",
                "cmp lr, r7",
                "bne 2b",
                "add sp, #48",
                "pop {{r4-r11, pc}}",
                distance = const $distance,
            )
        }
    };
}

/// The same of two neighbouring pixels.
macro_rules! two {
    ($name:ident, $distance:expr, $tiles:literal, $half:literal, $groups:literal) => {
        #[unsafe(naked)]
        unsafe extern "C" fn $name(_run: &Run) {
            naked_asm!(
                "push {{r4-r11, lr}}",
                "ldmia r0, {{r1-r12}}",
                "push {{r1-r12}}",
                "ldrd r4, r5, [sp, #16]", // bytes between groups, end of the weights
                "mov lr, r3",
                "2:", // two pixels: R and S of each in r0 to r3
                "ldrd r12, r0, [sp]",
                "mov r1, r0",
                "mov r2, r0",
                "mov r3, r0",
                "3:",
                concat!(".irp at, ", $tiles),
                "ldrd r6, r7, [r12], #16",
                "ldrd r8, r9, [lr, #\\at]",
                "ldrd r10, r11, [lr, #\\at + {distance}]",
                "smlad r0, r6, r8, r0",
                "smlad r2, r6, r10, r2",
                "smlad r0, r7, r9, r0",
                "smlad r2, r7, r11, r2",
                "sxtb16 r6, r6",
                "sxtb16 r7, r7",
                "smlad r1, r6, r8, r1",
                "smlad r3, r6, r10, r3",
                "smlad r1, r7, r9, r1",
                "smlad r3, r7, r11, r3",
                ".endr",
                concat!(".irp at, ", $half),
                ".ifnb \\at",
                "ldr r6, [r12]",
                "ldr r8, [lr, #\\at]",
                "ldr r10, [lr, #\\at + {distance}]",
                "smlad r0, r6, r8, r0",
                "smlad r2, r6, r10, r2",
                "sxtb16 r6, r6",
                "smlad r1, r6, r8, r1",
                "smlad r3, r6, r10, r3",
                ".endif",
                ".endr",
                concat!(".if ", $groups),
                "add lr, r4",
                "cmp r12, r5",
                "bne 3b",
                ".endif",
                "ldrd r6, r7, [sp, #24]",
                "ldrd r8, r9, [sp, #32]",
                "ldrd r10, r11, [sp, #40]",
                "subs r0, r0, r1",
                "subs r2, r2, r3",
                "add r0, r8, r0, asr #8",
                "add r2, r8, r2, asr #8",
                "smmlar r1, r1, r6, r9",
                "smmlar r3, r3, r6, r9",
                "ssat r1, #8, r1",
                "ssat r3, #8, r3",
                "strb r1, [r10]",
                "strb r3, [r10, r11]",
                "add r10, #1",
                "smmlar r0, r0, r7, r9",
                "smmlar r2, r2, r7, r9",
                "ssat r0, #8, r0",
                "ssat r2, #8, r2",
                "strb r0, [r10]",
                "strb r2, [r10, r11]",
                "add r10, r10, r11, lsl #1",
                "subs r10, #1",
                "str r10, [sp, #40]",
                "ldrd lr, r7, [sp, #8]",
                "add lr, #2 * {distance}",
                "str lr, [sp, #8]",
                "cmp lr, r7",
                "bne 2b",
                "add sp, #48",
                "pop {{r4-r11, pc}}",
                distance = const $distance,
            )
        }
    };
}

three!(three_of_one, 48, "0,8,16,24,32,40,48,56,64,72,80,88,96,104,112,120,128,136", "", "1");
three!(three_of_two, 96, "0,8,16,24,32,40,48,56,64,72,80,88,96,104,112,120,128,136", "", "1");
three!(three_single, 16, "0,8", "", "1");
three!(three_colours_of_one, 20, "0,8,16,24,32,40,48", "56", "0");
three!(three_colours_of_two, 40, "0,8,16,24,32,40,48", "56", "0");
two!(two_of_one, 48, "0,8,16,24,32,40,48,56,64,72,80,88,96,104,112,120,128,136", "", "1");
two!(two_of_two, 96, "0,8,16,24,32,40,48,56,64,72,80,88,96,104,112,120,128,136", "", "1");
two!(two_single, 16, "0,8", "", "1");
two!(two_colours_of_one, 20, "0,8,16,24,32,40,48", "56", "0");
two!(two_colours_of_two, 40, "0,8,16,24,32,40,48", "56", "0");

/// The sums of four rows, of as many tiles as there are groups of four inputs. With the tiles in r0, the
/// inputs in r1, and their ends after eights, twos and all tiles from [sp] on; gives R and S of rows 0
/// and 1 in r4 and r5, of rows 2 and 3 in r6 and r7. A step of eight columns takes 27 instructions for
/// 32 products.
macro_rules! dot {
    ($before:literal, $after:literal) => {
        concat!(
            ".macro vantage_dot low, high\n",
            "ldm r0!, {{r8-r11}}\n",
            "smlad r4, r8, \\low, r4\n",
            "smlad r6, r10, \\low, r6\n",
            "smlad r4, r9, \\high, r4\n",
            "smlad r6, r11, \\high, r6\n",
            "sxtb16 r8, r8\n",
            "sxtb16 r9, r9\n",
            "sxtb16 r10, r10\n",
            "sxtb16 r11, r11\n",
            "smlad r5, r8, \\low, r5\n",
            "smlad r7, r10, \\low, r7\n",
            "smlad r5, r9, \\high, r5\n",
            "smlad r7, r11, \\high, r7\n",
            ".endm\n",
            $before,
            "ldr r2, [sp]\n",
            "cmp r1, r2\n",
            "beq 3f\n",
            "2:\n",
            ".rept 4\n",
            "ldm r1!, {{r2, r3, r12, lr}}\n",
            "vantage_dot r2, r3\n",
            "vantage_dot r12, lr\n",
            ".endr\n",
            "ldr r2, [sp]\n",
            "cmp r1, r2\n",
            "bne 2b\n",
            "3:\n",
            "ldr r2, [sp, #4]\n",
            "cmp r1, r2\n",
            "beq 5f\n",
            "4:\n",
            "ldm r1!, {{r2, r3, r12, lr}}\n",
            "vantage_dot r2, r3\n",
            "vantage_dot r12, lr\n",
            "ldr r2, [sp, #4]\n",
            "cmp r1, r2\n",
            "bne 4b\n",
            "5:\n",
            "ldr r2, [sp, #8]\n",
            "cmp r1, r2\n",
            "beq 6f\n",
            "ldrd r2, r3, [r1]\n",
            "vantage_dot r2, r3\n",
            "6:\n",
            $after,
            ".purgem vantage_dot\n",
        )
    };
}

/// Adds to the sums of four rows the products of `count` tiles with as many groups of four inputs.
///
/// # Safety
///
/// All that must be there, both aligned to 4 bytes.
#[unsafe(naked)]
unsafe extern "C" fn dot(
    _tiles: *const Tile,
    _input: *const u32,
    _count: usize,
    _sums: &mut [i32; EDGE],
) {
    naked_asm!(dot!(
        "push {{r3-r11, lr}}
        add r4, r1, r2, lsl #3
        bic r3, r2, #1
        add r3, r1, r3, lsl #3
        bic r2, r2, #7
        add r2, r1, r2, lsl #3
        push {{r2-r4}}
        mov r4, #0
        mov r5, #0
        mov r6, #0
        mov r7, #0
        ",
        "add sp, #12
        pop {{r3}}
        subs r4, r4, r5
        subs r6, r6, r7
        ldm r3, {{r8-r11}}
        add r8, r5
        add r9, r9, r4, asr #8
        add r10, r7
        add r11, r11, r6, asr #8
        stm r3, {{r8-r11}}
        pop {{r4-r11, pc}}
        "
    ))
}

/// What a fully connected layer needs beyond its registers, in the order of its stack.
#[repr(C)]
struct Dense {
    input: *const u32, // widened, groups of four
    eights: usize,     // bytes of the input's groups in eights
    twos: usize,       // in twos
    all: usize,
    rest: usize, // bytes of a block's tiles that have no input
    bias: *const [u8; 4],
    multipliers: *const [u8; 4],
    output: *mut i8,
    blocks: usize, // at least 1
    zero: i32,
}

/// Computes a fully connected layer, block by block.
///
/// # Safety
///
/// All that must be there, all but the output aligned to 4 bytes.
#[unsafe(naked)]
unsafe extern "C" fn dense_rows(_tiles: *const Tile, _dense: &Dense) {
    naked_asm!(dot!(
        "push {{r4-r11, lr}}
        ldm r1, {{r2-r11}}
        add r3, r2
        add r4, r2
        add r5, r2
        push {{r2}}
        push {{r3-r11}}
        1:
        ldr r1, [sp, #36]
        ldr r8, [sp, #16]
        ldr r4, [r8]
        ldr r6, [r8, #8]
        mov r5, r4
        mov r7, r6
        ",
        "ldr r1, [sp, #12]
        add r0, r1
        ldrd r8, r9, [sp, #16]
        ldr r10, [r8, #4]
        ldr r11, [r8, #12]
        ldm r9!, {{r1-r3, r12}}
        add r8, #16
        strd r8, r9, [sp, #16]
        ldrd r8, r9, [sp, #24]
        ldr lr, [sp, #32]
        subs r4, r4, r5
        subs r6, r6, r7
        add r4, r10, r4, asr #8
        add r6, r11, r6, asr #8
        smmlar r5, r5, r1, lr
        smmlar r4, r4, r2, lr
        smmlar r7, r7, r3, lr
        smmlar r6, r6, r12, lr
        ssat r5, #8, r5
        ssat r4, #8, r4
        ssat r7, #8, r7
        ssat r6, #8, r6
        strb r5, [r8], #1
        strb r4, [r8], #1
        strb r7, [r8], #1
        strb r6, [r8], #1
        subs r9, #1
        strd r8, r9, [sp, #24]
        bne 1b
        add sp, #40
        pop {{r4-r11, pc}}
        "
    ))
}
