//! Which pixels are dark beside their surroundings: a threshold that follows the light.
//!
//! As in AprilTag 3 (Krogius, Haggenmiller and Olson, "Flexible layouts for fiducial tags", IROS
//! 2019): the frame is cut into tiles of 4 x 4 pixels; a pixel is dark when it lies below the
//! middle between the lowest and the highest luma of its tile and the eight around. Where these
//! hardly differ there is no edge, and nothing is dark: a broad black area becomes a ring.

use crate::frame::Frame;

/// Side of a tile in pixels.
const TILE: usize = 4;

/// Luma steps below which a neighbourhood has no edge: four times the noise of a dim webcam.
const LEAST_CONTRAST: u8 = 20;

/// The dark pixels, with a light margin of one pixel around the frame.
#[derive(Clone, Debug, Default)]
pub struct Binary {
    dark: Vec<bool>, // (height + 2, stride)
    stride: usize,
    height: usize,
    low: Vec<u8>,  // (tile rows, tile columns), the tile's lowest luma
    high: Vec<u8>, // (tile rows, tile columns)
}

impl Binary {
    /// Thresholds a frame, into memory of the frame before.
    pub fn threshold(&mut self, frame: &Frame<'_>) {
        let (width, height) = (frame.width(), frame.height());
        let tiles_wide = width.div_ceil(TILE);
        self.stride = width + 2;
        self.height = height;
        self.dark.clear();
        self.dark.resize(self.stride * (height + 2), false);
        self.range_of_tiles(frame, tiles_wide);

        let tiles_high = height.div_ceil(TILE);
        let mut limits = vec![0u8; tiles_wide]; // a pixel is dark below it
        for (tile_row, band) in frame.luma().chunks(width * TILE).enumerate() {
            let rows = tile_row.saturating_sub(1)..(tile_row + 2).min(tiles_high);
            let around = rows.start * tiles_wide..rows.end * tiles_wide;
            let (low, high) = (&self.low[around.clone()], &self.high[around]);
            for (tile, limit) in limits.iter_mut().enumerate() {
                let columns = tile.saturating_sub(1)..(tile + 2).min(tiles_wide);
                let (mut lowest, mut highest) = (u8::MAX, u8::MIN);
                for (low, high) in low.chunks_exact(tiles_wide).zip(high.chunks_exact(tiles_wide)) {
                    lowest = low[columns.clone()].iter().fold(lowest, |a, &b| a.min(b));
                    highest = high[columns.clone()].iter().fold(highest, |a, &b| a.max(b));
                }
                let contrast = highest - lowest;
                *limit = if contrast < LEAST_CONTRAST { 0 } else { lowest + contrast.div_ceil(2) };
            }
            for (row, luma) in band.chunks_exact(width).enumerate() {
                let start = (tile_row * TILE + row + 1) * self.stride + 1;
                let dark = &mut self.dark[start..start + width];
                let tiles = dark.chunks_mut(TILE).zip(luma.chunks(TILE)).zip(&limits);
                for ((dark, luma), limit) in tiles {
                    for (dark, luma) in dark.iter_mut().zip(luma) {
                        *dark = luma < limit;
                    }
                }
            }
        }
    }

    fn range_of_tiles(&mut self, frame: &Frame<'_>, tiles_wide: usize) {
        self.low.clear();
        self.high.clear();
        for band in frame.luma().chunks(frame.width() * TILE) {
            let start = self.low.len();
            self.low.resize(start + tiles_wide, u8::MAX);
            self.high.resize(start + tiles_wide, u8::MIN);
            let (low, high) = (&mut self.low[start..], &mut self.high[start..]);
            for luma in band.chunks_exact(frame.width()) {
                for ((luma, low), high) in luma.chunks(TILE).zip(&mut *low).zip(&mut *high) {
                    for &value in luma {
                        *low = value.min(*low);
                        *high = value.max(*high);
                    }
                }
            }
        }
    }

    /// Pixels from one row to the next in [`dark`](Self::dark).
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Whether each pixel is dark, shape (height + 2, width + 2): the margin is light.
    pub fn dark(&self) -> &[bool] {
        &self.dark
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(frame: &Frame<'_>) -> Vec<String> {
        let mut binary = Binary::default();
        binary.threshold(frame);
        let rows = binary.dark.chunks_exact(binary.stride);
        rows.map(|row| row.iter().map(|d| if *d { '#' } else { '.' }).collect()).collect()
    }

    #[test]
    fn a_shade_across_the_frame_hides_no_edge() {
        // Light falls from left to right; a stripe is darker than what is around it.
        let luma: Vec<u8> = (0..5 * 30)
            .map(|i| {
                let (row, column) = (i / 30, i % 30);
                (250 - 6 * column - if row == 2 { 60 } else { 0 }) as u8
            })
            .collect();
        let rows = picture(&Frame::try_new(&luma, 30, 5).unwrap());
        assert_eq!(rows[3], format!(".{}.", "#".repeat(30)));
        assert!(rows[0] == rows[6] && !rows[0].contains('#'));
    }

    #[test]
    fn noise_on_a_plain_wall_is_not_dark() {
        let luma: Vec<u8> = (0..400u32).map(|i| 100 + (i * 7919 % 19) as u8).collect();
        let rows = picture(&Frame::try_new(&luma, 20, 20).unwrap());
        assert!(rows.iter().all(|row| !row.contains('#')));
    }
}
