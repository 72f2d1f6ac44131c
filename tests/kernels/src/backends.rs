//! The kernels that can be tried here.

use vantage_core::kernels::{Addition, Grid, Linear, Rows};

/// The functions of one instruction set.
pub trait Kernels {
    /// As it is named in messages.
    const NAME: &'static str;
    /// Whether this machine has the instructions.
    fn are_here() -> bool {
        true
    }
    /// See `vantage_core::kernels::scalar`.
    fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]);
    /// See there.
    fn requantize_all(map: &Linear<'_>, sums: &[i32], output: &mut [i8]);
    /// See there.
    fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]);
    /// See there.
    fn fully_connected_wide(map: &Linear<'_>, input: &[i8], output: &mut [i32]);
    /// See there.
    fn pointwise(
        map: &Linear<'_>,
        channels: usize,
        input: &[i8],
        rows: &mut Rows,
        output: &mut [i8],
    );
    /// See there.
    fn convolve(
        map: &Linear<'_>,
        stride: usize,
        input: &Grid<'_>,
        rows: &mut Rows,
        output: &mut [i8],
    );
    /// See there.
    fn convolve_colours(
        map: &Linear<'_>,
        stride: usize,
        input: &Grid<'_>,
        rows: &mut Rows,
        output: &mut [i8],
    );
    /// See there.
    fn depthwise(
        map: &Linear<'_>,
        stride: usize,
        input: &Grid<'_>,
        rows: &mut Rows,
        output: &mut [i8],
    );
    /// See there.
    fn add_residual(add: &Addition, values: &mut [i8], others: &[i8]);
}

macro_rules! kernels {
    ($(#[$doc:meta])* $type:ident, $name:literal, $module:path $(, $are_here:expr)?) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $type;

        impl Kernels for $type {
            const NAME: &'static str = $name;
            $(fn are_here() -> bool {
                $are_here
            })?
            fn accumulate(map: &Linear<'_>, first: usize, input: &[i8], sums: &mut [i32]) {
                use $module as module;
                module::accumulate(map, first, input, sums)
            }
            fn requantize_all(map: &Linear<'_>, sums: &[i32], output: &mut [i8]) {
                use $module as module;
                module::requantize_all(map, sums, output)
            }
            fn fully_connected(map: &Linear<'_>, input: &[i8], output: &mut [i8]) {
                use $module as module;
                module::fully_connected(map, input, output)
            }
            fn fully_connected_wide(map: &Linear<'_>, input: &[i8], output: &mut [i32]) {
                use $module as module;
                module::fully_connected_wide(map, input, output)
            }
            fn pointwise(
                map: &Linear<'_>,
                channels: usize,
                input: &[i8],
                rows: &mut Rows,
                output: &mut [i8],
            ) {
                use $module as module;
                module::pointwise(map, channels, input, rows, output)
            }
            fn convolve(
                map: &Linear<'_>,
                stride: usize,
                input: &Grid<'_>,
                rows: &mut Rows,
                output: &mut [i8],
            ) {
                use $module as module;
                module::convolve(map, stride, input, rows, output)
            }
            fn convolve_colours(
                map: &Linear<'_>,
                stride: usize,
                input: &Grid<'_>,
                rows: &mut Rows,
                output: &mut [i8],
            ) {
                use $module as module;
                module::convolve_colours(map, stride, input, rows, output)
            }
            fn depthwise(
                map: &Linear<'_>,
                stride: usize,
                input: &Grid<'_>,
                rows: &mut Rows,
                output: &mut [i8],
            ) {
                use $module as module;
                module::depthwise(map, stride, input, rows, output)
            }
            fn add_residual(add: &Addition, values: &mut [i8], others: &[i8]) {
                use $module as module;
                module::add_residual(add, values, others)
            }
        }
    };
}

kernels!(
    /// What callers of the core get.
    Chosen,
    "chosen",
    vantage_core::kernels
);
kernels!(
    /// The definition.
    Scalar,
    "scalar",
    vantage_core::kernels::scalar
);

#[cfg(all(feature = "arch", target_arch = "x86_64"))]
mod x86 {
    use vantage_core::kernels::x86::Level;

    use super::*;

    kernels!(
        /// What every x86-64 has.
        Sse2,
        "sse2",
        vantage_core::kernels::x86::only_sse2
    );
    kernels!(
        /// Vectors of 256 bits.
        Avx2,
        "avx2",
        vantage_core::kernels::x86::up_to_avx2,
        Level::here() >= Level::Avx2
    );
    kernels!(
        /// These with `vpdpwssd`.
        Vnni,
        "avx-512 vnni",
        vantage_core::kernels::x86,
        Level::here() >= Level::Vnni
    );
}

#[cfg(all(feature = "arch", target_arch = "x86_64"))]
pub use x86::{Avx2, Sse2, Vnni};
