//! x86-64: AVX2 where the processor has it, with `vpdpwssd` where it has AVX-512 VNNI too, else SSE2,
//! which all have.
//!
//! ```text
//! plain:   sum = bias + Σ_c weights[r, c] · input[c], for each output pixel and each row r
//! here:    R, S += two tiles at once: pmaddwd of the lanes as they are, and of their low bytes,
//!          for four rows and for four neighbouring pixels
//!          first rows' sums = S, second rows' sums = (R - S) >> 8
//! ```

use core::sync::atomic::{AtomicU8, Ordering};

use super::depthwise::{self, Alone, Eight};
use super::vectors::{self, Vectors};
use super::windows::{self, Lines, Shape};
use super::{Addition, EDGE, GROUP, Grid, Linear, Rows, Tile, scalar};

mod avx2;
mod sse2;

use avx2::{Avx2, Vnni};
use sse2::Sse2;

/// What a processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What all have.
    Sse2,
    /// Vectors of 256 bits.
    Avx2,
    /// These with `vpdpwssd`, of AVX-512 VNNI.
    Vnni,
}

impl Level {
    /// The highest that this processor has. It is asked once: under a hypervisor that takes long.
    pub fn here() -> Self {
        const NOT_ASKED: u8 = u8::MAX;
        static KNOWN: AtomicU8 = AtomicU8::new(NOT_ASKED);
        let mut known = KNOWN.load(Ordering::Relaxed);
        if known == NOT_ASKED {
            known = Self::ask() as u8;
            KNOWN.store(known, Ordering::Relaxed);
        }
        match known {
            0 => Self::Sse2,
            1 => Self::Avx2,
            _ => Self::Vnni,
        }
    }

    fn ask() -> Self {
        cpufeatures::new!(avx2, "avx2");
        cpufeatures::new!(avx512, "avx2", "avx512f", "avx512vl");
        if avx512::get() {
            // Leaf 7 is there where AVX-512 is. Bit 11 is VNNI, which cpufeatures does not know.
            let leaf = core::arch::x86_64::__cpuid_count(7, 0);
            return if leaf.ecx & (1 << 11) != 0 { Self::Vnni } else { Self::Avx2 };
        }
        if avx2::get() { Self::Avx2 } else { Self::Sse2 }
    }
}

/// The kernels of one level, and of a lower one where the processor has no more.
macro_rules! kernels {
    ($level:expr) => {
        pub use scalar::fully_connected_wide;

        /// Adds a part of a linear map, without its bias. As [`scalar::accumulate`].
        pub fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]) {
            let is_done = match $level {
                Level::Sse2 => vectors::accumulate::<Sse2>(map, first, input, sums),
                Level::Avx2 => vectors::accumulate::<Avx2>(map, first, input, sums),
                Level::Vnni => vectors::accumulate::<Vnni>(map, first, input, sums),
            };
            if !is_done {
                scalar::accumulate(map, first, input, sums);
            }
        }

        /// Brings sums to bytes. As [`scalar::requantize_all`].
        pub fn requantize_all(map: &Linear<'_>, sums: &[i32], output: &mut [i8]) {
            if $level == Level::Sse2 {
                scalar::requantize_all(map, sums, output);
            } else {
                // SAFETY: the processor has AVX2.
                unsafe { avx2::requantize_all(map, sums, output) };
            }
        }

        /// A fully connected layer. As [`scalar::fully_connected`].
        pub fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]) {
            let is_done = match $level {
                Level::Sse2 => vectors::fully_connected::<Sse2>(map, input, output),
                Level::Avx2 => vectors::fully_connected::<Avx2>(map, input, output),
                Level::Vnni => vectors::fully_connected::<Vnni>(map, input, output),
            };
            if !is_done {
                scalar::fully_connected(map, input, output);
            }
        }

        /// A fully connected layer of every pixel by itself. As [`scalar::pointwise`].
        pub fn pointwise(
            map: &Linear<'_>,
            channels: usize,
            input: &[i8],
            rows: &mut Rows,
            output: &mut [i8],
        ) {
            let is_done = match $level {
                Level::Sse2 => windows::pointwise::<Sse2>(map, channels, input, rows, output),
                Level::Avx2 => windows::pointwise::<Avx2>(map, channels, input, rows, output),
                Level::Vnni => windows::pointwise::<Vnni>(map, channels, input, rows, output),
            };
            if !is_done {
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
            let is_done = match $level {
                Level::Sse2 => windows::convolve::<Sse2>(map, stride, input, rows, output),
                Level::Avx2 => windows::convolve::<Avx2>(map, stride, input, rows, output),
                Level::Vnni => windows::convolve::<Vnni>(map, stride, input, rows, output),
            };
            if !is_done {
                scalar::convolve(map, stride, input, rows, output);
            }
        }

        /// A convolution with a window of 3 x 3 pixels of three colours. As
        /// [`scalar::convolve_colours`].
        pub fn convolve_colours(
            map: &Linear<'_>,
            stride: usize,
            input: &Grid<'_>,
            rows: &mut Rows,
            output: &mut [i8],
        ) {
            let is_done = match $level {
                Level::Sse2 => windows::convolve_colours::<Sse2>(map, stride, input, rows, output),
                Level::Avx2 => windows::convolve_colours::<Avx2>(map, stride, input, rows, output),
                Level::Vnni => windows::convolve_colours::<Vnni>(map, stride, input, rows, output),
            };
            if !is_done {
                scalar::convolve_colours(map, stride, input, rows, output);
            }
        }

        /// A convolution with a window of 3 x 3 pixels of every channel by itself. As
        /// [`scalar::depthwise`].
        pub fn depthwise(
            map: &Linear<'_>,
            stride: usize,
            input: &Grid<'_>,
            rows: &mut Rows,
            output: &mut [i8],
        ) {
            // No network has one yet: what all processors have will do.
            if !depthwise::depthwise::<Sse2>(map, stride, input, rows, output) {
                scalar::depthwise(map, stride, input, rows, output);
            }
        }

        /// Adds a map onto another. As [`scalar::add_residual`].
        pub fn add_residual(add: &Addition, values: &mut [i8], others: &[i8]) {
            if $level == Level::Sse2 {
                scalar::add_residual(add, values, others);
            } else {
                // SAFETY: the processor has AVX2.
                unsafe { avx2::add_residual(add, values, others) };
            }
        }
    };
}

kernels!(Level::here());

/// The kernels of a processor that has no more than SSE2.
pub mod only_sse2 {
    use super::*;

    kernels!(Level::Sse2);
}

/// The kernels of a processor that has no more than AVX2.
pub mod up_to_avx2 {
    use super::*;

    kernels!(Level::here().min(Level::Avx2));
}
