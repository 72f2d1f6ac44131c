//! Whether a frame is sharp and well lit, in four numbers.
//!
//! Sharpness is the variance of the Laplacian (Pech-Pacheco et al., ICPR 2000) of the frame at half
//! size, divided by the frame's own variance. Halving first takes away most of the sensor's noise;
//! the division makes the number the same in dim and in bright light: it is a mean square
//! frequency. It depends on what is seen, so it is to be compared with other frames of the same
//! scene, not with a fixed limit.

use crate::frame::{Frame, HalfFrame};

/// Luma at or below which a pixel counts as dark.
const DARK: u8 = 16;

/// Luma at or above which a pixel counts as blown out.
const BRIGHT: u8 = 250;

/// The variance of luma that no frame is taken to be below: one of noise alone.
const LEAST_VARIANCE: f64 = 4.0;

/// How a frame looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// Variance of the Laplacian over variance; 0 of a plain frame, about 1 of a sharp one.
    pub sharpness: f64,
    /// 0 to 255.
    pub mean_luma: f64,
    /// Share of pixels that are dark, 0 to 1.
    pub dark_share: f64,
    /// Share of pixels that are blown out, 0 to 1.
    pub bright_share: f64,
}

/// Measures a frame.
pub fn quality(frame: &Frame<'_>) -> Quality {
    let mut histogram = [0u32; 256];
    for &value in frame.luma() {
        histogram[usize::from(value)] += 1;
    }
    let all = frame.luma().len() as f64;
    let share = |values: &[u32]| values.iter().sum::<u32>() as f64 / all;
    let mean = (0..).zip(&histogram).map(|(v, &n)| f64::from(v) * f64::from(n)).sum::<f64>() / all;
    Quality {
        sharpness: sharpness(frame),
        mean_luma: mean,
        dark_share: share(&histogram[..=usize::from(DARK)]),
        bright_share: share(&histogram[usize::from(BRIGHT)..]),
    }
}

fn sharpness(frame: &Frame<'_>) -> f64 {
    let mut half = HalfFrame::default();
    let Some(half) = half.shrink(frame) else { return 0.0 };
    let (mut laplacian, mut luma) = (Sums::default(), Sums::default());
    let rows: Vec<&[u8]> = half.rows().collect();
    for band in rows.windows(3) {
        let [above, row, below] = [band[0], band[1], band[2]];
        let around = row.windows(3).zip(&above[1..]).zip(&below[1..]);
        for ((row, &above), &below) in around {
            let [left, middle, right] = [row[0], row[1], row[2]].map(i64::from);
            laplacian.add(i64::from(above) + i64::from(below) + left + right - 4 * middle);
            luma.add(middle);
        }
    }
    laplacian.variance() / luma.variance().max(LEAST_VARIANCE)
}

/// Sums for a variance; exact.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: i64,
    sum: i64,
    squares: i64,
}

impl Sums {
    fn add(&mut self, value: i64) {
        self.count += 1;
        self.sum += value;
        self.squares += value * value;
    }

    /// 0 of nothing.
    fn variance(&self) -> f64 {
        let n = self.count.max(1) as f64;
        let mean = self.sum as f64 / n;
        (self.squares as f64 / n - mean * mean).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 96;

    /// Blocks of several sizes and shades.
    fn scene() -> Vec<f64> {
        (0..SIDE * SIDE)
            .map(|i| {
                let (x, y) = (i % SIDE, i / SIDE);
                let block = (x / 7 * 31 + y / 11 * 17) % 13 * 12;
                40.0 + block as f64
            })
            .collect()
    }

    /// A box blur of 2 r + 1 pixels along x: motion.
    fn blurred(scene: &[f64], r: isize) -> Vec<f64> {
        (0..scene.len() as isize)
            .map(|i| {
                let row = i / SIDE as isize * SIDE as isize;
                let column = |d: isize| (i - row + d).clamp(0, SIDE as isize - 1);
                (-r..=r).map(|d| scene[(row + column(d)) as usize]).sum::<f64>()
                    / (2 * r + 1) as f64
            })
            .collect()
    }

    fn measure(scene: &[f64], exposure: f64, noise: f64) -> Quality {
        let luma: Vec<u8> = (0u64..)
            .zip(scene)
            .map(|(i, value)| {
                // A cheap hash spreads -0.5 to 0.5.
                let random =
                    (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1 << 24) as f64;
                (value * exposure + noise * (random - 0.5)).round() as u8
            })
            .collect();
        quality(&Frame::try_new(&luma, SIDE, SIDE).unwrap())
    }

    #[test]
    fn the_more_motion_the_less_sharp() {
        let sharp: Vec<f64> =
            (0..6).map(|r| measure(&blurred(&scene(), r), 1.0, 6.0).sharpness).collect();
        assert!(sharp.windows(2).all(|pair| pair[1] < pair[0]), "{sharp:?}");
        assert!(sharp[3] < 0.7 * sharp[0], "{sharp:?}");
    }

    #[test]
    fn sharpness_is_the_same_in_dim_light() {
        let bright = measure(&scene(), 1.2, 6.0).sharpness;
        let dim = measure(&scene(), 0.3, 6.0).sharpness;
        assert!((dim / bright - 1.0).abs() < 0.05, "{dim} {bright}");
    }

    #[test]
    fn dark_and_bright_are_counted() {
        let dark = measure(&scene(), 0.1, 0.0);
        assert!(dark.dark_share > 0.6 && dark.bright_share == 0.0 && dark.mean_luma < 20.0);
        let bright = measure(&scene(), 2.0, 0.0);
        assert!(bright.bright_share > 0.2 && bright.dark_share == 0.0, "{bright:?}");
        let half: Vec<u8> = [16, 17, 249, 250].repeat(16);
        let quality = quality(&Frame::try_new(&half, 8, 8).unwrap());
        assert_eq!((quality.dark_share, quality.bright_share), (0.25, 0.25));
        assert_eq!(quality.mean_luma, 133.0);
    }

    #[test]
    fn a_plain_or_tiny_frame_has_no_sharpness() {
        for (width, height) in [(1, 1), (2, 2), (5, 4), (64, 64)] {
            let luma = vec![77; width * height];
            assert_eq!(quality(&Frame::try_new(&luma, width, height).unwrap()).sharpness, 0.0);
        }
    }
}
