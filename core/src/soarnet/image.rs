//! A photo as the caller has it, and the square of it that the network sees.
//!
//! A [`Window`] is brought to 64 x 64 pixels by an exact area filter in integers. In units of 1/64
//! of a pixel the window is `64 side` long, so the box of an output pixel is `side` long and its
//! borders are whole numbers, however long the window:
//!
//! ```text
//! box of output column i:     64 left + i · side  ..  64 left + (i + 1) · side
//! weight of picture column x: how long the box and 64 x .. 64 x + 64 overlap; together `side`
//! output[i, j] = round(Σ_x Σ_y weight_x · weight_y · picture[y, x] / side²)        halves up
//! ```
//!
//! Where the window has the network's size, every box is a pixel and is copied: the same bytes, for a
//! sixth of the instructions. A box smaller than a pixel works the same way, so a small window is
//! enlarged by its nearest pixels, with mixed ones in between. Beyond the picture's border the nearest pixel is repeated.

use core::fmt;

/// Pixels on each side of what the network sees.
pub const SIDE: usize = 64;

/// Bytes of what the network sees, shape (64, 64, 3).
pub const INPUT: usize = SIDE * SIDE * 3;

/// Cells on each side in which the network tells how much of them the object covers.
pub const COVER: usize = 16;

/// Cells on each side in which it tells how much the object's colours change.
pub const DETAIL: usize = 8;

/// Numbers of a sketch: covers, shape (16, 16), then details, shape (8, 8), each of 127.
pub const SKETCH: usize = COVER * COVER + DETAIL * DETAIL;

/// Numbers of a sketch that the network tells of each of its 8 x 8 cells: the covers of the cell's
/// quarters, row by row, then its detail.
pub const CELL: usize = 5;

/// Where in a sketch the numbers of cell `cell` lie, 0 to 63, row by row.
pub const fn places_in_sketch(cell: usize) -> [usize; CELL] {
    let corner = 2 * (cell / DETAIL) * COVER + 2 * (cell % DETAIL);
    [corner, corner + 1, corner + COVER, corner + COVER + 1, COVER * COVER + cell]
}

/// The longest side of a window, pixels.
pub const LONGEST_WINDOW: u32 = 1 << 15;

/// How a pixel lies in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Pixels {
    /// Three bytes: red, green, blue.
    Rgb888,
    /// Two bytes, a little-endian number: 5 bits red (highest), 6 green, 5 blue (lowest).
    ///
    /// The highest bits are repeated below the lowest, so that black is 0 and white 255: five bits `v`
    /// are `v << 3 | v >> 2`, six are `v << 2 | v >> 4`.
    Rgb565,
    /// One byte of brightness: red, green and blue alike.
    Luma8,
    /// Four bytes: red, green, blue, and an alpha that is not looked at.
    Rgba8888,
}

impl Pixels {
    /// Bytes of a pixel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Rgb888 => 3,
            Self::Rgb565 => 2,
            Self::Luma8 => 1,
            Self::Rgba8888 => 4,
        }
    }
}

/// A picture in the caller's memory, row by row from the top, without gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image<'a> {
    width: u32,
    height: u32,
    pixels: Pixels,
    bytes: &'a [u8],
}

/// A square of a picture, in its pixels; it may reach over the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    left: i32,
    top: i32,
    side: u32,
}

/// Why numbers do not make a picture or a window of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ImageError {
    /// The picture or the window has no pixels.
    Empty,
    /// The bytes are not as many as the picture's size asks for.
    Length {
        /// Bytes the size asks for.
        expected: u64,
        /// Bytes there are.
        got: usize,
    },
    /// The window is longer than [`LONGEST_WINDOW`].
    TooLarge {
        /// Its side in pixels.
        side: u32,
    },
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the picture has no pixels: give it a width and a height"),
            Self::Length { expected, got } => write!(
                f,
                "the picture has {got} bytes where its size and format need {expected}: check \
                 width, height and format"
            ),
            Self::TooLarge { side } => write!(
                f,
                "the window is {side} pixels long, {LONGEST_WINDOW} at most can be used: shrink \
                 the picture first"
            ),
        }
    }
}

impl core::error::Error for ImageError {}

impl Window {
    /// The window from `left` and `top` (pixels, from the picture's upper left corner), `side` long.
    pub fn try_new(left: i32, top: i32, side: u32) -> Result<Self, ImageError> {
        match side {
            0 => Err(ImageError::Empty),
            1..=LONGEST_WINDOW => Ok(Self { left, top, side }),
            _ => Err(ImageError::TooLarge { side }),
        }
    }

    /// The columns of the picture under output column `index`, each with its weight; a column beyond
    /// the border as the nearest. Likewise for rows.
    fn under(&self, start: i32, length: u32, index: usize) -> impl Iterator<Item = (usize, u32)> {
        let side = i64::from(self.side);
        let from = (i64::from(start) << 6) + index as i64 * side;
        let to = from + side;
        let last = i64::from(length) - 1;
        ((from >> 6)..((to + 63) >> 6)).map(move |x| {
            let weight = to.min((x << 6) + 64) - from.max(x << 6);
            (x.min(last).max(0) as usize, weight as u32)
        })
    }
}

impl<'a> Image<'a> {
    /// A picture of `width` x `height` pixels.
    pub fn try_new(
        width: u32,
        height: u32,
        pixels: Pixels,
        bytes: &'a [u8],
    ) -> Result<Self, ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::Empty);
        }
        // A size of more than 64 bits fits no memory either.
        let count = u64::from(width) * u64::from(height);
        let expected = count.saturating_mul(pixels.bytes() as u64);
        if bytes.len() as u64 != expected {
            return Err(ImageError::Length { expected, got: bytes.len() });
        }
        Ok(Self { width, height, pixels, bytes })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The largest square in the middle; where it cannot be in the middle, half a pixel towards the
    /// upper left.
    pub fn middle(&self) -> Result<Window, ImageError> {
        let side = self.width.min(self.height);
        let offset = |length: u32| ((length - side) / 2).min(i32::MAX as u32) as i32;
        Window::try_new(offset(self.width), offset(self.height), side)
    }

    /// The window at 64 x 64 pixels, as the network sees it: shape (64, 64, 3) = (row, column, RGB),
    /// each value `colour - 128`.
    pub fn resize(&self, window: &Window, output: &mut [i8; INPUT]) {
        if window.side as usize == SIDE {
            self.copy(window, output);
        } else {
            self.filter(window, output);
        }
    }

    /// As [`Self::filter`] where every box is one pixel.
    fn copy(&self, window: &Window, output: &mut [i8; INPUT]) {
        let (lines, _) = output.as_chunks_mut::<{ 3 * SIDE }>();
        for (line, y) in lines.iter_mut().zip(Self::nearest(window.top, self.height)) {
            let places = line.as_chunks_mut::<3>().0.iter_mut();
            for (place, x) in places.zip(Self::nearest(window.left, self.width)) {
                *place = self.pixel(x, y).map(|colour| (colour ^ 0x80) as i8);
            }
        }
    }

    /// The pixels of a row from `start` on, those beyond the border as the nearest.
    fn nearest(start: i32, length: u32) -> impl Iterator<Item = usize> {
        let before = start.min(0).unsigned_abs(); // steps until the border
        let from = start.max(0) as u32; // plus a step stays below 2^32
        (0..SIDE as u32)
            .map(move |step| (from + step.saturating_sub(before)).min(length - 1) as usize)
    }

    /// The means under all boxes.
    fn filter(&self, window: &Window, output: &mut [i8; INPUT]) {
        let area = window.side * window.side; // at most 2^30
        let (lines, _) = output.as_chunks_mut::<{ 3 * SIDE }>();
        for (j, line) in lines.iter_mut().enumerate() {
            let (places, _) = line.as_chunks_mut::<3>();
            for (i, place) in places.iter_mut().enumerate() {
                let mut sums = [0u64; 3];
                for (y, height) in window.under(window.top, self.height, j) {
                    // A row of the box holds at most 255 · 2^15.
                    let mut row = [0u32; 3];
                    for (x, width) in window.under(window.left, self.width, i) {
                        for (sum, colour) in row.iter_mut().zip(self.pixel(x, y)) {
                            *sum += width * u32::from(colour);
                        }
                    }
                    for (sum, row) in sums.iter_mut().zip(row) {
                        *sum += u64::from(height) * u64::from(row);
                    }
                }
                *place = sums.map(|sum| mean(sum, area));
            }
        }
    }

    /// The colour of a pixel: red, green, blue; black outside, where nobody asks.
    fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let index = y * self.width as usize + x;
        match self.pixels {
            Pixels::Rgb888 => self.bytes.as_chunks::<3>().0.get(index).copied().unwrap_or_default(),
            Pixels::Rgb565 => {
                let bytes = self.bytes.as_chunks::<2>().0.get(index).copied().unwrap_or_default();
                let value = u16::from_le_bytes(bytes);
                let (red, green, blue) = (value >> 11, value >> 5 & 0x3f, value & 0x1f);
                [red << 3 | red >> 2, green << 2 | green >> 4, blue << 3 | blue >> 2]
                    .map(|colour| colour as u8)
            }
            Pixels::Luma8 => [self.bytes.get(index).copied().unwrap_or_default(); 3],
            Pixels::Rgba8888 => {
                let pixel = self.bytes.as_chunks::<4>().0.get(index).copied();
                let [red, green, blue, _] = pixel.unwrap_or_default();
                [red, green, blue]
            }
        }
    }
}

/// `sum / area - 128`, rounded, halves up.
fn mean(sum: u64, area: u32) -> i8 {
    let sum = sum + u64::from(area / 2);
    // A controller divides 32 bits by 32 in one instruction, and 64 in a hundred.
    let quotient = match u32::try_from(sum) {
        Ok(sum) => sum.checked_div(area).unwrap_or_default(),
        Err(_) => sum.checked_div(u64::from(area)).unwrap_or_default() as u32,
    };
    (quotient.min(255) as u8 ^ 0x80) as i8
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    fn seen(image: &Image<'_>, window: &Window) -> Vec<u8> {
        let mut output = [0; INPUT];
        image.resize(window, &mut output);
        output.into_iter().map(|value| (i16::from(value) + 128) as u8).collect()
    }

    fn any_pixels() -> impl Strategy<Value = Pixels> {
        use Pixels::*;
        prop::sample::select(vec![Rgb888, Rgb565, Luma8, Rgba8888])
    }

    /// Where a window begins: near the picture, or at the ends of what can be said.
    fn start() -> impl Strategy<Value = i32> {
        prop_oneof![8 => -80i32..100, 1 => i32::MIN..i32::MIN + 80, 1 => i32::MAX - 80..=i32::MAX]
    }

    /// The mean colour under a box, by its definition, in floating point.
    fn reference(image: &Image<'_>, window: &Window, i: usize, j: usize) -> [f64; 3] {
        let step = f64::from(window.side) / SIDE as f64;
        let overlaps = |start: i32, index: usize, length: u32| {
            let from = f64::from(start) + index as f64 * step;
            let to = from + step;
            let mut parts = Vec::new();
            let mut x = from.floor();
            while x < to {
                let part = to.min(x + 1.0) - from.max(x);
                parts.push((x.clamp(0.0, f64::from(length) - 1.0) as usize, part / step));
                x += 1.0;
            }
            parts
        };
        let mut sum = [0.0; 3];
        for (y, height) in overlaps(window.top, j, image.height) {
            for (x, width) in overlaps(window.left, i, image.width) {
                for (sum, colour) in sum.iter_mut().zip(image.pixel(x, y)) {
                    *sum += height * width * f64::from(colour);
                }
            }
        }
        sum
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn every_pixel_is_the_mean_under_its_box(
            (width, height, bytes) in (1u32..90, 1u32..90).prop_flat_map(|(w, h)| {
                (Just(w), Just(h), prop::collection::vec(any::<u8>(), (w * h * 3) as usize))
            }),
            left in -60i32..60, top in -60i32..60, side in 1u32..160,
        ) {
            let image = Image::try_new(width, height, Pixels::Rgb888, &bytes).unwrap();
            let window = Window::try_new(left, top, side).unwrap();
            for (index, got) in seen(&image, &window).chunks(3).enumerate() {
                let expected = reference(&image, &window, index % SIDE, index / SIDE);
                for (&got, expected) in got.iter().zip(expected) {
                    prop_assert!((f64::from(got) - expected).abs() < 0.5 + 1e-9, "{got} {expected}");
                }
            }
        }

        #[test]
        fn a_window_of_the_networks_size_is_copied_as_it_would_be_filtered(
            (width, height, pixels, bytes) in (1u32..90, 1u32..90, any_pixels()).prop_flat_map(
                |(w, h, pixels)| {
                    let length = w as usize * h as usize * pixels.bytes();
                    let bytes = prop::collection::vec(any::<u8>(), length);
                    (Just(w), Just(h), Just(pixels), bytes)
                },
            ),
            left in start(), top in start(),
        ) {
            let image = Image::try_new(width, height, pixels, &bytes).unwrap();
            let window = Window::try_new(left, top, SIDE as u32).unwrap();
            let (mut copied, mut filtered) = ([0; INPUT], [0; INPUT]);
            image.copy(&window, &mut copied);
            image.filter(&window, &mut filtered);
            prop_assert_eq!(copied, filtered);
        }

        #[test]
        fn a_flat_picture_stays_flat(
            colour: [u8; 3], left in any::<i32>(), top in any::<i32>(), side in 1u32..300,
        ) {
            let bytes = colour.repeat(35);
            let image = Image::try_new(5, 7, Pixels::Rgb888, &bytes).unwrap();
            let window = Window::try_new(left, top, side).unwrap();
            prop_assert!(seen(&image, &window).chunks(3).all(|pixel| pixel == colour));
        }
    }

    #[test]
    fn a_picture_of_the_networks_size_is_taken_as_it_is() {
        let bytes: Vec<u8> = (0..INPUT).map(|i| ((i * 7919) >> 3) as u8).collect();
        let image = Image::try_new(64, 64, Pixels::Rgb888, &bytes).unwrap();
        assert_eq!(seen(&image, &image.middle().unwrap()), bytes);
    }

    #[test]
    fn the_longest_window_of_white_is_white() {
        let image = Image::try_new(1, 1, Pixels::Rgb888, &[255, 0, 3]).unwrap();
        // One box instead of all 4096, which take half a minute: the sums are the same.
        let side = LONGEST_WINDOW;
        let sum = u64::from(side) * u64::from(side * 255);
        assert_eq!(mean(sum, side * side), 127);
        assert_eq!(Window::try_new(0, 0, side + 1), Err(ImageError::TooLarge { side: side + 1 }));
        assert!(
            seen(&image, &Window::try_new(i32::MAX, i32::MIN, 999).unwrap())
                .chunks(3)
                .all(|pixel| pixel == [255, 0, 3])
        );
    }

    #[test]
    fn halves_go_up() {
        // Two columns, 4 and 7, under every box: the mean is 5.5.
        let bytes: Vec<u8> =
            (0..128 * 128).flat_map(|i| [if i % 2 == 0 { 4 } else { 7 }; 3]).collect();
        let image = Image::try_new(128, 128, Pixels::Rgb888, &bytes).unwrap();
        assert!(seen(&image, &image.middle().unwrap()).iter().all(|&value| value == 6));
    }

    #[test]
    fn five_and_six_bits_reach_black_and_white() {
        let bytes: Vec<u8> = [0x0000u16, 0xffff, 0xf800, 0x07e0, 0x001f, 0x8410]
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let image = Image::try_new(6, 1, Pixels::Rgb565, &bytes).unwrap();
        let colours: Vec<[u8; 3]> = (0..6).map(|x| image.pixel(x, 0)).collect();
        let expected =
            [[0, 0, 0], [255, 255, 255], [255, 0, 0], [0, 255, 0], [0, 0, 255], [132, 130, 132]];
        assert_eq!(colours, expected);
    }

    #[test]
    fn brightness_is_grey_in_all_colours() {
        let image = Image::try_new(3, 1, Pixels::Luma8, &[0, 77, 255]).unwrap();
        let colours: Vec<[u8; 3]> = (0..3).map(|x| image.pixel(x, 0)).collect();
        assert_eq!(colours, [[0; 3], [77; 3], [255; 3]]);
        let short = ImageError::Length { expected: 3, got: 2 };
        assert_eq!(Image::try_new(3, 1, Pixels::Luma8, &[0; 2]), Err(short));
    }

    #[test]
    fn alpha_is_not_looked_at() {
        let image = Image::try_new(2, 1, Pixels::Rgba8888, &[1, 2, 3, 99, 4, 5, 6, 0]).unwrap();
        assert_eq!([image.pixel(0, 0), image.pixel(1, 0)], [[1, 2, 3], [4, 5, 6]]);
        let short = ImageError::Length { expected: 8, got: 6 };
        assert_eq!(Image::try_new(2, 1, Pixels::Rgba8888, &[0; 6]), Err(short));
    }

    #[test]
    fn the_middle_of_a_wide_picture_is_its_largest_square() {
        let bytes = vec![0; 7 * 4 * 2];
        let image = Image::try_new(7, 4, Pixels::Rgb565, &bytes).unwrap();
        assert_eq!(image.middle(), Window::try_new(1, 0, 4));
    }

    #[test]
    fn wrong_sizes_are_refused() {
        let short = ImageError::Length { expected: 12, got: 11 };
        assert_eq!(Image::try_new(2, 2, Pixels::Rgb888, &[0; 11]), Err(short));
        assert_eq!(Image::try_new(0, 2, Pixels::Rgb888, &[]), Err(ImageError::Empty));
        assert!(Image::try_new(u32::MAX, u32::MAX, Pixels::Rgb888, &[]).is_err());
        assert_eq!(Window::try_new(0, 0, 0), Err(ImageError::Empty));
    }
}
