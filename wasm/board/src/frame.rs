//! A camera frame: one byte of luma for each pixel.

use core::fmt;

/// A picture's luma, row-major from the upper left corner.
///
/// Positions are in pixels from that corner; a pixel's centre lies at half-integer coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    luma: &'a [u8], // (height, width)
    width: usize,
    height: usize,
}

/// The longest side of a frame, in pixels.
pub const MAX_SIDE: usize = 8192;

/// Why bytes do not make a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// A side is zero or longer than [`MAX_SIDE`].
    BadSize {
        /// In pixels.
        width: usize,
        /// In pixels.
        height: usize,
    },
    /// There is not one byte for each pixel.
    WrongLength {
        /// Width times height.
        expected: usize,
        /// Bytes given.
        got: usize,
    },
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadSize { width, height } => write!(
                f,
                "a frame of {width} x {height} pixels cannot be read; sides are 1 to {MAX_SIDE}"
            ),
            Self::WrongLength { expected, got } => {
                write!(f, "the frame has {got} bytes of luma where its size needs {expected}")
            }
        }
    }
}

impl core::error::Error for FrameError {}

impl<'a> Frame<'a> {
    /// A frame from its luma, shape (height, width).
    pub fn try_new(luma: &'a [u8], width: usize, height: usize) -> Result<Self, FrameError> {
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(FrameError::BadSize { width, height });
        }
        if luma.len() != width * height {
            return Err(FrameError::WrongLength { expected: width * height, got: luma.len() });
        }
        Ok(Self { luma, width, height })
    }

    /// In pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// In pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, shape (height, width).
    pub fn luma(&self) -> &'a [u8] {
        self.luma
    }

    /// The rows from the top.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &'a [u8]> {
        self.luma.chunks_exact(self.width)
    }

    /// Luma between pixel centres, bilinear; outside of the frame that of its edge.
    #[inline]
    pub(crate) fn sample(&self, x: f64, y: f64) -> f64 {
        let clamp = |value: f64, side: usize| (value - 0.5).clamp(0.0, (side - 1) as f64);
        let (x, y) = (clamp(x, self.width), clamp(y, self.height));
        let (left, top) = (x as usize, y as usize);
        let (right, bottom) = ((left + 1).min(self.width - 1), (top + 1).min(self.height - 1));
        let at = |row: usize, column: usize| f64::from(self.luma[row * self.width + column]);
        let (dx, dy) = (x - left as f64, y - top as f64);
        let upper = at(top, left) + dx * (at(top, right) - at(top, left));
        let lower = at(bottom, left) + dx * (at(bottom, right) - at(bottom, left));
        upper + dy * (lower - upper)
    }
}

/// A frame at half the size, each pixel the mean of 2 x 2; an odd last row or column is left out.
#[derive(Clone, Debug, Default)]
pub(crate) struct HalfFrame {
    luma: Vec<u8>, // (height, width)
    width: usize,
    height: usize,
}

impl HalfFrame {
    /// Shrinks a frame; `None` where a side has a single pixel.
    pub(crate) fn shrink<'s>(&'s mut self, frame: &Frame<'_>) -> Option<Frame<'s>> {
        (self.width, self.height) = (frame.width / 2, frame.height / 2);
        self.luma.clear();
        for rows in frame.luma.chunks_exact(2 * frame.width) {
            let (upper, lower) = rows.split_at(frame.width);
            let pairs = upper.chunks_exact(2).zip(lower.chunks_exact(2));
            self.luma.extend(pairs.map(|(a, b)| {
                let sum: u32 = a.iter().chain(b).map(|&v| u32::from(v)).sum();
                ((sum + 2) / 4) as u8
            }));
        }
        Frame::try_new(&self.luma, self.width, self.height).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_sizes_are_refused() {
        let luma = [0; 12];
        assert!(Frame::try_new(&luma, 4, 3).is_ok());
        let wrong = Frame::try_new(&luma, 4, 4).unwrap_err();
        assert_eq!(wrong, FrameError::WrongLength { expected: 16, got: 12 });
        assert_eq!(
            Frame::try_new(&[], 0, 3).unwrap_err(),
            FrameError::BadSize { width: 0, height: 3 }
        );
        assert!(Frame::try_new(&luma, usize::MAX, 2).is_err());
    }

    #[test]
    fn samples_are_exact_at_centres_and_linear_between() {
        let frame = Frame::try_new(&[0, 100, 40, 60], 2, 2).unwrap();
        assert_eq!(frame.sample(0.5, 0.5), 0.0);
        assert_eq!(frame.sample(1.5, 1.5), 60.0);
        assert_eq!(frame.sample(1.0, 0.5), 50.0);
        assert_eq!(frame.sample(1.0, 1.0), 50.0);
        assert_eq!(frame.sample(-9.0, f64::NAN.max(9.0)), 40.0);
    }

    #[test]
    fn half_a_frame_is_the_mean_of_squares() {
        let luma = [1, 3, 9, 5, 7, 9, 0, 0, 0];
        let mut half = HalfFrame::default();
        let shrunk = half.shrink(&Frame::try_new(&luma, 3, 3).unwrap()).unwrap();
        assert_eq!((shrunk.width(), shrunk.height(), shrunk.luma()), (1, 1, &[4u8][..]));
        assert!(half.shrink(&Frame::try_new(&[1, 2], 2, 1).unwrap()).is_none());
    }
}
