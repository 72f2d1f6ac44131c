//! From a photo to its sketch and its embedding: once, when the photo is taken.
//!
//! A small residual network (He et al., 2016) in place of the paper's ResNet encoder: a stem and
//! three stages, each of which halves the map and adds to it what two convolutions make of it. All
//! windows are 3 x 3, and beyond a border stands the map's zero point.
//!
//! ```text
//! photo 64 x 64 x 3 → stem 32 x 32 x c0 → 16 x 16 x c1 → 8 x 8 x c2 → 4 x 4 x c3 → embedding (E)
//!                                                       8 x 8 x c2 → sketch (320)
//! stage:  x = cut(down(map)),  b = second(cut(first(x))),  map = cut(x + b)
//! ```
//!
//! With the default sizes this takes 4.7 million multiplications. Two buffers suffice: a stage reads
//! its map from one and leaves the next in the other.

use super::image::{DETAIL, INPUT, Image, SIDE, SKETCH, Window, places_in_sketch};
use super::model::{Model, StageLayers};
use crate::kernels::{
    Grid, Rows, add_residual, convolve, convolve_colours, fully_connected, pointwise,
};

const LARGE: usize = 32 * 32 * 16;

/// Memory to encode a photo in: 33 KiB. What is in it does not matter.
#[derive(Clone, Debug)]
#[repr(C)] // the kernels' first, and with it the maps, so that all are aligned
pub struct Scratch {
    rows: Rows,
    large: [i8; LARGE], // (32, 32, 16) or smaller maps
    small: [i8; INPUT], // (64, 64, 3) or smaller maps
    sketch: [i8; SKETCH],
}

/// What the network makes of a photo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Impression<'s> {
    /// The shares of the picture's 16 x 16 cells that the object covers, then how much its colours
    /// change in 8 x 8, rows from the top; 127 for 1. Shape (320), empty without an encoder.
    pub sketch: &'s [i8],
    /// Shape (E).
    pub embedding: &'s [i8],
}

impl Scratch {
    /// Zeros, which cost no flash in a `static`.
    pub const fn new() -> Self {
        Self { rows: Rows::new(), large: [0; LARGE], small: [0; INPUT], sketch: [0; SKETCH] }
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

impl Model<'_> {
    /// What a window of a picture shows; nothing without an encoder.
    pub fn encode<'s>(
        &self,
        image: &Image<'_>,
        window: &Window,
        scratch: &'s mut Scratch,
    ) -> Impression<'s> {
        let Scratch { rows, large, small, sketch } = scratch;
        let Some(encoder) = &self.encoder else { return Impression::default() };
        image.resize(window, small);

        let [c0, _, c2, _] = self.dimensions().channels;
        let map = large.get_mut(..SIDE / 2 * (SIDE / 2) * c0).unwrap_or_default();
        let colours = Grid { values: small, side: SIDE, channels: 3, border: 0 };
        convolve_colours(&encoder.stem, 2, &colours, rows, map);

        let [first, second, third] = &encoder.stages;
        run(first, [32, c0], encoder.stem.zero, large, small, rows);
        let [c1, c3] = [first, third].map(|stage| stage.down.bias.len());
        run(second, [16, c1], first.sum.zero, small, large, rows);
        let map = large.get(..DETAIL * DETAIL * c2).unwrap_or_default();
        pointwise(&encoder.sketch, c2, map, rows, small);
        // Its rows are filled up to a multiple of four.
        let cells = small.chunks_exact(encoder.sketch.bias.len().max(1));
        for (cell, values) in cells.take(DETAIL * DETAIL).enumerate() {
            for (place, value) in places_in_sketch(cell).into_iter().zip(values) {
                if let Some(number) = sketch.get_mut(place) {
                    *number = *value;
                }
            }
        }
        run(third, [8, c2], second.sum.zero, large, small, rows);
        let map = small.get(..4 * 4 * c3).unwrap_or_default();

        let embedding = large.get_mut(..self.dimensions().embedding).unwrap_or_default();
        fully_connected(&encoder.embed, map, embedding);
        Impression { sketch, embedding }
    }
}

/// Runs a stage on the map of `side` pixels of some channels in `from`, which is lost, and leaves its
/// result in `to`.
///
/// `to` must hold two maps of the result, `from` one: the bounds of [`Model::parse`] see to it.
fn run(
    stage: &StageLayers<'_>,
    [side, channels]: [usize; 2],
    zero: i8,
    from: &mut [i8],
    to: &mut [i8],
    rows: &mut Rows,
) {
    let (half, outputs) = (side / 2, stage.down.bias.len());
    let length = half * half * outputs;
    let Some((x, rest)) = to.split_at_mut_checked(length) else { return };
    let (Some(a), true) = (rest.get_mut(..length), from.len() >= length) else { return };
    convolve(&stage.down, 2, &Grid { values: from, side, channels, border: zero }, rows, x);
    let grid = |values, border| Grid { values, side: half, channels: outputs, border };
    convolve(&stage.first, 1, &grid(x, stage.down.zero), rows, a);
    let b = from.get_mut(..length).unwrap_or_default();
    convolve(&stage.second, 1, &grid(a, stage.first.zero), rows, b);
    add_residual(&stage.sum, x, b);
}
