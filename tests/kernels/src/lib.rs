//! The kernels of an instruction set against their definition, bit for bit, and layers to count.
//!
//! [`suite::run`] is generic over the [`Kernels`] it tries: every length from 0 past three vector
//! widths, every misalignment, -128 and 127, the largest sums, rounding halves of both signs, and
//! layers by chance from a seed that a failure names. It needs no heap, so that firmware runs it too.
//! [`layers`] are those of a network and of other people's measurements.
#![no_std]

pub mod backends;
pub mod chance;
pub mod layers;
pub mod suite;

pub use backends::Kernels;
