//! Layers whose cost is counted: those of KERNELS and the network's own.

use vantage_core::kernels::{Addition, Grid, Linear, Order, Rows};
use vantage_core::soarnet::{Dimensions, INPUT};

use crate::Kernels;
use crate::chance::{Chance, Extreme, Owned};

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// A window of 3 x 3 pixels.
    Window {
        /// Pixels from one window to the next.
        stride: usize,
        /// Pixels of a row of the input.
        side: usize,
        /// Its channels.
        channels: usize,
    },
    /// A window of 3 x 3 pixels of three colours.
    Colours {
        /// Pixels from one window to the next.
        stride: usize,
        /// Pixels of a row of the input.
        side: usize,
    },
    /// A window of 3 x 3 pixels of every channel by itself; the rows are the channels.
    Alone {
        /// Pixels from one window to the next.
        stride: usize,
        /// Pixels of a row of the input.
        side: usize,
    },
    /// A window of one pixel.
    Pixels {
        /// How many there are.
        pixels: usize,
        /// Channels of the input.
        channels: usize,
    },
    /// Fully connected.
    Whole {
        /// Numbers of the input.
        columns: usize,
    },
    /// The sum of two maps: elements instead of products are counted.
    Sum {
        /// Elements.
        elements: usize,
    },
}

/// A layer to be counted.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// As it is named in tables.
    pub name: &'static str,
    /// What is done.
    pub work: Work,
    /// Rows: channels of the output.
    pub rows: usize,
}

impl Layer {
    const fn new(name: &'static str, work: Work, rows: usize) -> Self {
        Self { name, work, rows }
    }

    /// Products, or elements of a sum.
    pub fn products(&self) -> usize {
        let area = |side: usize, stride: usize| side.div_ceil(stride) * side.div_ceil(stride);
        match self.work {
            Work::Window { stride, side, channels } => {
                area(side, stride) * 9 * channels * self.rows
            }
            Work::Colours { stride, side } => area(side, stride) * 27 * self.rows,
            Work::Alone { stride, side } => area(side, stride) * 9 * self.rows,
            Work::Pixels { pixels, channels } => pixels * channels * self.rows,
            Work::Whole { columns } => columns * self.rows,
            Work::Sum { elements } => elements,
        }
    }

    fn order(&self) -> Order {
        match self.work {
            Work::Window { channels, .. } => Order::Window { channels },
            Work::Colours { .. } => Order::Colours,
            Work::Alone { .. } => Order::Plain { columns: 9 },
            Work::Pixels { channels, .. } => Order::Plain { columns: channels },
            Work::Whole { columns } => Order::Plain { columns },
            Work::Sum { .. } => Order::Plain { columns: 0 },
        }
    }

    fn outputs(&self) -> usize {
        let area = |side: usize, stride: usize| side.div_ceil(stride) * side.div_ceil(stride);
        match self.work {
            Work::Window { stride, side, .. }
            | Work::Colours { stride, side }
            | Work::Alone { stride, side } => area(side, stride) * self.rows,
            Work::Pixels { pixels, .. } => pixels * self.rows,
            Work::Whole { .. } => self.rows,
            Work::Sum { elements } => elements,
        }
    }

    fn inputs(&self) -> usize {
        match self.work {
            Work::Window { side, channels, .. } => side * side * channels,
            Work::Colours { side, .. } => side * side * 3,
            Work::Alone { side, .. } => side * side * self.rows,
            Work::Pixels { pixels, channels } => pixels * channels,
            Work::Whole { columns } => columns,
            Work::Sum { elements } => elements,
        }
    }
}

/// The layers that CMSIS-NN was counted with, in its order.
pub const ANCHORS: [Layer; 9] = [
    Layer::new("3x3 s1, 32x32, 16->16", Work::Window { stride: 1, side: 32, channels: 16 }, 16),
    Layer::new("3x3 s2, 32x32, 16->32", Work::Window { stride: 2, side: 32, channels: 16 }, 32),
    Layer::new("3x3 s1, 16x16, 32->32", Work::Window { stride: 1, side: 16, channels: 32 }, 32),
    Layer::new("3x3 s1, 8x8, 64->64", Work::Window { stride: 1, side: 8, channels: 64 }, 64),
    Layer::new("1x1, 16x16, 32->64", Work::Pixels { pixels: 256, channels: 32 }, 64),
    Layer::new("fully connected 256->128", Work::Whole { columns: 256 }, 128),
    Layer::new("first layer 3x3, 64x64, 3->16", Work::Colours { stride: 1, side: 64 }, 16),
    Layer::new("depthwise 3x3, 32x32, C = 32", Work::Alone { stride: 1, side: 32 }, 32),
    Layer::new("residual add, 16,384 elements", Work::Sum { elements: 16_384 }, 0),
];

/// The layers of the default network's encoder; a stage's second convolution costs what its first does.
pub const ENCODER: [Layer; 12] = [
    Layer::new("stem", Work::Colours { stride: 2, side: 64 }, 16),
    Layer::new("stage 1 down", Work::Window { stride: 2, side: 32, channels: 16 }, 16),
    Layer::new("stage 1 first", Work::Window { stride: 1, side: 16, channels: 16 }, 16),
    Layer::new("stage 1 sum", Work::Sum { elements: 16 * 16 * 16 }, 0),
    Layer::new("stage 2 down", Work::Window { stride: 2, side: 16, channels: 16 }, 32),
    Layer::new("stage 2 first", Work::Window { stride: 1, side: 8, channels: 32 }, 32),
    Layer::new("stage 2 sum", Work::Sum { elements: 8 * 8 * 32 }, 0),
    Layer::new("sketch, of which 3 rows are padding", Work::Pixels { pixels: 64, channels: 32 }, 8),
    Layer::new("stage 3 down", Work::Window { stride: 2, side: 8, channels: 32 }, 48),
    Layer::new("stage 3 first", Work::Window { stride: 1, side: 4, channels: 48 }, 48),
    Layer::new("stage 3 sum", Work::Sum { elements: 4 * 4 * 48 }, 0),
    Layer::new("embed", Work::Whole { columns: 768 }, 96),
];

/// How an encoder is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// As the shipped one.
    Plain,
    /// After the stem every window is over a channel by itself, with a layer of one pixel after it.
    Separable,
    /// Of photos with half as many pixels on each side; the second stage leaves the map as large as it
    /// is.
    Halved,
}

/// The encoders of `lab/ENCODERS.md`, the shipped one first: name, build, channels.
pub const ENCODERS: [(&str, Build, [usize; 4]); 4] = [
    ("encoder plain-16-16-32-48", Build::Plain, [16, 16, 32, 48]),
    ("encoder plain-8-8-16-24", Build::Plain, [8, 8, 16, 24]),
    ("encoder separable-16-16-32-48", Build::Separable, [16, 16, 32, 48]),
    ("encoder halved-16-16-32-48", Build::Halved, [16, 16, 32, 48]),
];

/// Calls `each` with the layers of an encoder, from the photo to an embedding of 96 numbers.
pub fn each_layer(build: Build, channels: [usize; 4], mut each: impl FnMut(Work, usize)) {
    let [c0, c1, c2, c3] = channels;
    let (photo, strides) = match build {
        Build::Plain | Build::Separable => (64, [2, 2, 2]),
        Build::Halved => (32, [2, 1, 2]),
    };
    each(Work::Colours { stride: 2, side: photo }, c0);
    let mut side = photo / 2;
    let stages = [[c0, c1], [c1, c2], [c2, c3]].into_iter().zip(strides);
    for (stage, ([from, to], stride)) in (1..).zip(stages) {
        let half = side / stride;
        let pixels = half * half;
        for (stride, side, channels) in [(stride, side, from), (1, half, to), (1, half, to)] {
            if build == Build::Separable {
                each(Work::Alone { stride, side }, channels);
                each(Work::Pixels { pixels, channels }, to);
            } else {
                each(Work::Window { stride, side, channels }, to);
            }
        }
        each(Work::Sum { elements: pixels * to }, 0);
        side = half;
        if stage == 2 {
            each(Work::Pixels { pixels, channels: to }, 8); // the sketch, with its padding
        }
    }
    each(Work::Whole { columns: side * side * c3 }, 96);
}

/// Products of the network's encoder.
pub fn encoder_products(sizes: &Dimensions) -> usize {
    let [c0, c1, c2, c3] = sizes.channels;
    let stage = |half: usize, from: usize, to: usize| half * half * 9 * to * (from + 2 * to);
    let stages = stage(16, c0, c1) + stage(8, c1, c2) + stage(4, c2, c3);
    32 * 32 * 27 * c0 + stages + 64 * 5 * c2 + 16 * c3 * sizes.embedding
}

/// The largest map that a layer makes, and the largest that one takes.
const MAP: usize = 64 * 64 * 16;
const INPUTS: usize = 32 * 32 * 32;

/// Memory for a layer and its maps: 290 KB.
pub struct Bench {
    layer: Owned,
    input: [i8; INPUTS],
    output: [i8; MAP],
    rows: Rows,
}

impl Bench {
    /// Zeros.
    pub const fn new() -> Self {
        Self { layer: Owned::new(), input: [0; INPUTS], output: [0; MAP], rows: Rows::new() }
    }

    /// Draws a layer and its input by chance.
    pub fn prepare(&mut self, layer: &Layer) {
        let mut chance = Chance::new(1);
        self.layer.draw(layer.rows, layer.order(), Extreme::None, 0, &mut chance);
        self.input.fill_with(|| chance.byte());
        self.output.fill_with(|| chance.byte());
    }

    /// Runs a layer that has been prepared.
    pub fn run<K: Kernels>(&mut self, layer: &Layer) {
        // Negative values are cut off at -128, as in networks whose quantiser has the choice.
        let map = Linear { low: -128, ..self.layer.linear() };
        let (Some(values), Some(output)) =
            (self.input.get(..layer.inputs()), self.output.get_mut(..layer.outputs()))
        else {
            return;
        };
        let rows = &mut self.rows;
        match layer.work {
            Work::Window { stride, side, channels } => {
                let grid = Grid { values, side, channels, border: -128 };
                K::convolve(&map, stride, &grid, rows, output);
            }
            Work::Colours { stride, side } => {
                let grid = Grid { values, side, channels: 3, border: 0 };
                K::convolve_colours(&map, stride, &grid, rows, output);
            }
            Work::Alone { stride, side } => {
                let grid = Grid { values, side, channels: layer.rows, border: -128 };
                K::depthwise(&map, stride, &grid, rows, output);
            }
            Work::Pixels { channels, .. } => K::pointwise(&map, channels, values, rows, output),
            Work::Whole { .. } => K::fully_connected(&map, values, output),
            Work::Sum { .. } => {
                let add = Addition {
                    multiplier: 200_000,
                    other_multiplier: 150_000,
                    zero_in: -128,
                    other_zero_in: 5,
                    zero: -128,
                };
                K::add_residual(&add, output, values);
            }
        }
    }

    /// What came of a layer, as a short number.
    pub fn digest(&self, layer: &Layer) -> u32 {
        digest(self.output.iter().take(layer.outputs()))
    }
}

/// The picture that whole encodings are counted and timed on, shape (64, 64, 3).
pub fn picture() -> [u8; INPUT] {
    let mut bytes = [0; INPUT];
    for (index, byte) in bytes.iter_mut().enumerate() {
        *byte = ((index * 31) >> 4) as u8;
    }
    bytes
}

/// A short number that stands for many: FNV-1a.
pub fn digest<'a>(values: impl IntoIterator<Item = &'a i8>) -> u32 {
    values
        .into_iter()
        .fold(0x811c_9dc5, |hash, &value| (hash ^ u32::from(value as u8)).wrapping_mul(0x0100_0193))
}

impl Default for Bench {
    fn default() -> Self {
        Self::new()
    }
}
