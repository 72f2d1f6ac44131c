//! A window of 3 x 3 pixels of every channel by itself, channel after channel.
//!
//! ```text
//! three rows of a channel: a, b, c of each column; a new row takes the place of the oldest
//! a column's two words:    P = (a, b),  Q = (c, c of the next column)
//! an output:               bias + Σ P · taps of three columns + Q · taps of the first and third
//! ```
//!
//! So a row is widened once for all outputs that see it, and the place of the oldest tells which of
//! three sets of taps meets them. Two outputs take 22 instructions for 18 products.

use core::arch::{asm, naked_asm};

use super::{EDGE, Grid, Linear, Rows, Tile, cut, is_whole, scalar};
use crate::kernels::{Order, unpack};

/// Three rows of a channel, and the third's next column.
type Column = [i16; EDGE];

/// A channel's weights in the order in which a window's words meet them, and its bias.
#[repr(C)]
struct Taps {
    words: [u32; 5], // P of three columns, Q of the first, Q of the third
    bias: i32,
}

/// What an inner loop keeps on its stack, in this order.
#[repr(C)]
struct Pairs {
    multiplier: i32,
    zero: i32,
    channels: usize, // bytes from one pixel to the next
    end: *const Column,
}

/// Computes pairs of outputs, at least one, until the windows' end.
type Kernel = unsafe extern "C" fn(&Taps, *const Column, *mut i8, &Pairs);

/// A convolution with a window of 3 x 3 pixels of every channel by itself. As [`scalar::depthwise`].
pub fn depthwise(
    map: &Linear<'_>,
    stride: usize,
    input: &Grid<'_>,
    rows: &mut Rows,
    output: &mut [i8],
) {
    let Grid { values, side, channels, border } = *input;
    let pixels = if stride == 2 { side.div_ceil(2) } else { side };
    let fits = is_whole(map, Order::Plain { columns: 9 }.packed())
        && channels == map.bias.len()
        && (1..=2).contains(&stride)
        && pixels >= 2
        && side <= Rows::LENGTH / EDGE - 2
        && values.len() >= side * side * channels
        && output.len() >= pixels * pixels * channels;
    if !fits {
        return scalar::depthwise(map, stride, input, rows, output);
    }
    let (columns, _) = rows.0.as_chunks_mut::<EDGE>();
    let columns = columns.get_mut(..side + 2).unwrap_or_default();
    let kernel: Kernel = if stride == 2 { pairs_of_two } else { pairs_of_one };
    let window = columns.as_ptr();
    // An odd last output makes a pair with the one before it, once more.
    let last = window.wrapping_add(stride * (pixels - 2));
    let [end, last_end] =
        [window.wrapping_add(stride * (pixels & !1)), last.wrapping_add(2 * stride)];
    let weights = map.weights.as_chunks::<3>().0.iter().flat_map(weights_of_block);
    let lists = map.bias.iter().zip(map.multipliers).zip(weights);
    for (channel, ((bias, multiplier), weights)) in lists.enumerate() {
        let [bias, multiplier] = [bias, multiplier].map(|bytes| i32::from_le_bytes(*bytes));
        let pairs = Pairs { multiplier, zero: map.zero.into(), channels, end };
        let taps = Taps::all(&weights, bias);
        // What is beyond the border above and at both sides.
        columns.fill([border.into(); EDGE]);
        let mut inputs = values.get(channel..).unwrap_or_default().chunks(side * channels);
        let lines = output.get_mut(channel..).unwrap_or_default().chunks_mut(pixels * channels);
        // Of the first window's three rows one is there, and it is the oldest.
        let (mut oldest, mut place, mut missing) = (0, 1, 2);
        for line in lines.take(pixels) {
            for _ in 0..missing {
                put_row(columns, place, inputs.next(), channels, border);
                place = after(place);
            }
            let Some(taps) = taps.get(oldest) else { return };
            // SAFETY: the line has `pixels` outputs, `channels` apart, and each has a window of columns.
            unsafe {
                kernel(taps, window, line.as_mut_ptr(), &pairs);
                if pixels % 2 == 1 {
                    let output = line.as_mut_ptr().add((pixels - 2) * channels);
                    kernel(taps, last, output, &Pairs { end: last_end, ..pairs });
                }
            }
            missing = stride;
            oldest = if stride == 2 { after(after(oldest)) } else { after(oldest) };
        }
    }
    cut(output.get_mut(..pixels * pixels * channels).unwrap_or_default(), map.low);
}

/// The next of three places.
fn after(place: usize) -> usize {
    if place == 2 { 0 } else { place + 1 }
}

/// The weights of four channels, shape (row, column) each.
fn weights_of_block(tiles: &[Tile; 3]) -> [[[i8; 3]; 3]; 4] {
    let [one, two, three] = tiles.each_ref().map(unpack);
    let of = |[a, b, c, d]: [i8; 4], [e, f, g, h]: [i8; 4], [i, ..]: [i8; 4]| {
        [[a, b, c], [d, e, f], [g, h, i]]
    };
    let ([a, b, c, d], [e, f, g, h], [i, j, k, l]) = (one, two, three);
    [of(a, e, i), of(b, f, j), of(c, g, k), of(d, h, l)]
}

impl Taps {
    /// For each place that the oldest of three rows may have.
    fn all(&[one, two, three]: &[[i8; 3]; 3], bias: i32) -> [Self; 3] {
        let of = |[a, b, c]: [i8; 3], [d, e, f]: [i8; 3], [g, h, i]: [i8; 3]| {
            let pair = |low: i8, high: i8| u32::from(low as i16 as u16) | (high as u32) << 16;
            Self { words: [pair(a, d), pair(b, e), pair(c, f), pair(g, h), pair(i, 0)], bias }
        };
        [of(one, two, three), of(three, one, two), of(two, three, one)]
    }
}

/// Puts a row of a channel in its place among three; the border's value where there is none.
fn put_row(columns: &mut [Column], place: usize, from: Option<&[i8]>, channels: usize, border: i8) {
    let pixels = columns.len().saturating_sub(2);
    let Some(from) = from else {
        for column in columns {
            let numbers = column.iter_mut().skip(place);
            numbers.take(if place == 2 { 2 } else { 1 }).for_each(|number| *number = border.into());
        }
        return;
    };
    let to = columns.as_mut_ptr().wrapping_add(1).cast::<i16>().wrapping_add(place);
    // SAFETY: the input is whole: from here on there are so many bytes, `channels` apart, at least one;
    // there is a column for each, and one before them.
    unsafe {
        match place {
            2 => spread::<1>(from.as_ptr(), channels, to, pixels),
            _ => spread::<0>(from.as_ptr(), channels, to, pixels),
        }
    }
}

/// Widens `pixels` bytes, `channels` apart, to places of columns; where `TWICE` is 1, to the last place
/// of the column before, too.
///
/// # Safety
///
/// All that must be there; `pixels` must not be 0.
unsafe fn spread<const TWICE: usize>(
    from: *const i8,
    channels: usize,
    to: *mut i16,
    pixels: usize,
) {
    // SAFETY: the caller's promise.
    unsafe {
        asm!(
            "subs {pixels}, #4",
            "blt 3f",
            "2:",
            "ldrsb {a}, [{from}]",
            "ldrsb {b}, [{from}, {channels}]",
            "ldrsb {c}, [{from}, {channels}, lsl #1]",
            "ldrsb {d}, [{from}, {three}]",
            "add {from}, {from}, {channels}, lsl #2",
            ".if {twice}",
            "strh {a}, [{to}, #-6]",
            "strh {b}, [{to}, #2]",
            "strh {c}, [{to}, #10]",
            "strh {d}, [{to}, #18]",
            ".endif",
            "strh {b}, [{to}, #8]",
            "strh {c}, [{to}, #16]",
            "strh {d}, [{to}, #24]",
            "strh {a}, [{to}], #32",
            "subs {pixels}, #4",
            "bge 2b",
            "3:",
            "adds {pixels}, #4",
            "beq 5f",
            "4:",
            "ldrsb {a}, [{from}]",
            "add {from}, {channels}",
            ".if {twice}",
            "strh {a}, [{to}, #-6]",
            ".endif",
            "strh {a}, [{to}], #8",
            "subs {pixels}, #1",
            "bne 4b",
            "5:",
            a = out(reg) _,
            b = out(reg) _,
            c = out(reg) _,
            d = out(reg) _,
            from = inout(reg) from => _,
            to = inout(reg) to => _,
            pixels = inout(reg) pixels => _,
            channels = in(reg) channels,
            three = in(reg) 3 * channels,
            twice = const TWICE,
            options(nostack),
        );
    }
}

/// An inner loop, with the taps in r0 to r5, two columns in r6 to r9 and two outputs in r10 and r11.
macro_rules! pairs {
    ($name:ident, $middle:literal) => {
        #[unsafe(naked)]
        unsafe extern "C" fn $name(_: &Taps, _: *const Column, _: *mut i8, _: &Pairs) {
            naked_asm!(
                "push {{r4-r11, lr}}
                ldm r3, {{r6-r9}}
                push {{r6-r9}}
                mov r12, r1
                mov lr, r2
                ldm r0, {{r0-r5}}
                2:
                ldm r12!, {{r6-r9}}
                smlad r10, r6, r0, r5
                smlad r10, r7, r3, r10
                smlad r10, r8, r1, r10",
                $middle,
                "ldm sp, {{r6-r9}}
                smmlar r10, r10, r6, r7
                smmlar r11, r11, r6, r7
                ssat r10, #8, r10
                ssat r11, #8, r11
                strb r10, [lr]
                strb r11, [lr, r8]
                add lr, lr, r8, lsl #1
                cmp r12, r9
                bne 2b
                add sp, #16
                pop {{r4-r11, pc}}"
            )
        }
    };
}

pairs!(
    pairs_of_one,
    "smlad r11, r8, r0, r5
    smlad r11, r9, r3, r11
    ldm r12, {{r6-r9}}
    smlad r10, r6, r2, r10
    smlad r10, r7, r4, r10
    smlad r11, r6, r1, r11
    smlad r11, r8, r2, r11
    smlad r11, r9, r4, r11"
);
pairs!(
    pairs_of_two,
    "ldm r12!, {{r6-r9}}
    smlad r10, r6, r2, r10
    smlad r10, r7, r4, r10
    smlad r11, r6, r0, r5
    smlad r11, r7, r3, r11
    smlad r11, r8, r1, r11
    ldrd r6, r7, [r12]
    smlad r11, r6, r2, r11
    smlad r11, r7, r4, r11"
);
