//! The model file: read in place from flash, at any alignment, and written by one definition.
//!
//! `FORMAT.md` beside this file is its page: every field, and a worked example in hexadecimal.
//! [`Model::parse`] checks everything once, so that the layers need not: after it no index is out of
//! bounds and no sum leaves an i32.

use core::fmt;

use super::features::{COUNT, DIRECTION, RELATION};
use super::image::CELL;
use super::outlook::OUTLOOK;
use crate::checksum::CRC;
use crate::kernels::{
    Addition, EDGE, LARGEST_ADDITION, LARGEST_SECOND, Linear, Order, pack, unpack,
};

/// The version of model files that is written, and the only one that is read.
pub const VERSION: u16 = 3;

const MAGIC: [u8; 4] = *b"SOAR";
const HEADER: usize = 28;
const CHECKSUM: usize = 4;

/// Outputs of the head of a candidate: a rank score for each objective.
pub const RANKS: usize = 4;
/// Outputs of the head of the state: score, mean gain and spread of gains for each objective.
pub const STATE: usize = 12;

/// The widest embedding, token and hidden layer of a head.
pub const WIDEST: usize = 128;

/// Sizes of a network; all are multiples of 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions {
    /// Channels of the stem and of the three stages, at most 16, 24, 64, 64; all 0 without images.
    pub channels: [usize; 4],
    /// E: numbers of an embedding, at most 128; 0 for a network without images.
    pub embedding: usize,
    /// H: numbers of a token, 4 to 128.
    pub width: usize,
    /// K: hidden numbers of a candidate's head, 4 to 128.
    pub head: usize,
    /// G: hidden numbers of the state's head, 4 to 128.
    pub context: usize,
}

impl Default for Dimensions {
    fn default() -> Self {
        Self { channels: [16, 16, 32, 48], embedding: 96, width: 96, head: 96, context: 64 }
    }
}

/// What becomes of a layer's sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Output {
    Cut,    // bytes, negative values cut off
    Signed, // bytes
    Wide,   // 32 bits
}

/// The name and shape of a layer.
#[derive(Clone, Copy, Debug)]
struct Shape {
    name: &'static str,
    rows: usize,
    order: Order,
    output: Output,
}

impl Shape {
    const fn new(name: &'static str, rows: usize, columns: usize, output: Output) -> Self {
        Self { name, rows, order: Order::Plain { columns }, output }
    }

    const fn window(name: &'static str, rows: usize, channels: usize, output: Output) -> Self {
        Self { name, rows, order: Order::Window { channels }, output }
    }

    /// Rows in the file.
    fn packed_rows(&self) -> usize {
        self.rows.next_multiple_of(EDGE)
    }

    /// Bytes in the file.
    fn length(&self) -> usize {
        4 + self.packed_rows() * (8 + self.order.packed())
    }
}

/// Bytes of the sum of two maps in the file.
const ADDITION: usize = 12;

impl Dimensions {
    /// The sizes without images that are otherwise the same.
    pub fn without_images(self) -> Self {
        Self { channels: [0; 4], embedding: 0, ..self }
    }

    fn stem(&self) -> Shape {
        let [stem, ..] = self.channels;
        Shape { name: "stem", rows: stem, order: Order::Colours, output: Output::Cut }
    }

    fn stages(&self) -> [[Shape; 3]; 3] {
        let [c0, c1, c2, c3] = self.channels;
        let stage = |[down, first, second]: [&'static str; 3], from: usize, to: usize| {
            [
                Shape::window(down, to, from, Output::Cut),
                Shape::window(first, to, to, Output::Cut),
                Shape::window(second, to, to, Output::Signed),
            ]
        };
        [
            stage(["stage 1 down", "stage 1 first", "stage 1 second"], c0, c1),
            stage(["stage 2 down", "stage 2 first", "stage 2 second"], c1, c2),
            stage(["stage 3 down", "stage 3 first", "stage 3 second"], c2, c3),
        ]
    }

    /// Of each cell of the second stage's map: four covers, then the detail.
    fn sketch(&self) -> Shape {
        let [_, _, middle, _] = self.channels;
        Shape::new("sketch", CELL, middle, Output::Signed)
    }

    fn embed(&self) -> Shape {
        let [.., last] = self.channels;
        Shape::new("embed", self.embedding, 16 * last, Output::Signed)
    }

    fn token(&self) -> [Shape; 2] {
        let columns = self.embedding + DIRECTION + RELATION;
        [
            Shape::new("token 1", self.width, columns, Output::Cut),
            Shape::new("token 2", self.width, self.width, Output::Cut),
        ]
    }

    fn candidate(&self) -> [Shape; 2] {
        let outlook = if self.embedding > 0 { OUTLOOK } else { 0 };
        let columns = 2 * self.width + outlook + DIRECTION + COUNT;
        [
            Shape::new("candidate hidden", self.head, columns, Output::Cut),
            Shape::new("candidate output", RANKS, self.head, Output::Wide),
        ]
    }

    fn state(&self) -> [Shape; 2] {
        let columns = 2 * self.width + COUNT;
        [
            Shape::new("state hidden", self.context, columns, Output::Cut),
            Shape::new("state output", STATE, self.context, Output::Wide),
        ]
    }

    /// Bytes of a model file of these sizes.
    pub fn file_length(&self) -> usize {
        let heads = [self.token(), self.candidate(), self.state()];
        let heads: usize = heads.as_flattened().iter().map(Shape::length).sum();
        let stages = self.stages();
        let stages: usize = stages.as_flattened().iter().map(Shape::length).sum();
        let ends = self.stem().length() + self.sketch().length() + self.embed().length();
        let encoder = stages + 3 * ADDITION + ends;
        HEADER + heads + if self.embedding > 0 { encoder } else { 0 } + CHECKSUM
    }

    fn in_order(&self) -> [usize; 8] {
        let [c0, c1, c2, c3] = self.channels;
        [c0, c1, c2, c3, self.embedding, self.width, self.head, self.context]
    }

    fn check(&self) -> Result<(), ModelError> {
        const BOUNDS: [(&str, usize); 8] = [
            ("channels of the stem", 16),
            ("channels of stage 1", 24),
            ("channels of stage 2", 64),
            ("channels of stage 3", 64),
            ("embedding", WIDEST),
            ("token width", WIDEST),
            ("width of the candidate head", WIDEST),
            ("width of the state head", WIDEST),
        ];
        for (place, (got, (name, most))) in self.in_order().into_iter().zip(BOUNDS).enumerate() {
            let absent = place < 5 && self.embedding == 0;
            let (least, most) = if absent { (0, 0) } else { (4, most) };
            if got < least || got > most || !got.is_multiple_of(4) {
                return Err(ModelError::Dimension { name, got, most });
            }
        }
        Ok(())
    }
}

/// Why bytes are not a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelError {
    /// They do not begin as a model file does.
    Foreign,
    /// They were written in another version.
    Version {
        /// The version found; [`VERSION`] is needed.
        got: u16,
    },
    /// Bytes are missing or follow after the end.
    Length {
        /// Bytes the header asks for.
        expected: usize,
        /// Bytes there are.
        got: usize,
    },
    /// A byte has changed since it was written.
    Checksum,
    /// A size is out of bounds or no multiple of 4.
    Dimension {
        /// Of what.
        name: &'static str,
        /// The size found.
        got: usize,
        /// The largest there may be.
        most: usize,
    },
    /// A number of a layer is out of its range.
    Field {
        /// The layer.
        layer: &'static str,
        /// Which number.
        fault: Fault,
    },
}

/// Which number of a layer is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A reserved byte or one of padding is not 0.
    Reserved,
    /// The zero point of an output of 32 bits is not 0.
    Zero,
    /// A multiplier is negative, or those of a sum of maps are too large.
    Multiplier,
    /// A weight is -128.
    Weight,
    /// The sum of a row could leave 32 bits.
    Overflow {
        /// The row.
        row: usize,
    },
    /// The sum of a second row of two, without its bias, could leave 24 bits.
    Second {
        /// The row.
        row: usize,
    },
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => {
                f.write_str("these bytes are not a SOARNet model: check which file was given")
            }
            Self::Version { got } => write!(
                f,
                "the model has version {got}, this build reads version {VERSION} only: quantize it \
                 anew with the tools of this build"
            ),
            Self::Length { expected, got } => write!(
                f,
                "the model is cut short or too long, {got} bytes instead of {expected}: copy the \
                 file again"
            ),
            Self::Checksum => f.write_str(
                "the model is damaged, its checksum does not match: copy the file again",
            ),
            Self::Dimension { name, got, most } => write!(
                f,
                "the model's {name} is {got}, but must be a multiple of 4 up to {most}: train a \
                 network within these bounds"
            ),
            Self::Field { layer, fault } => {
                write!(f, "in the model's layer `{layer}` {fault}: quantize the network anew")
            }
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reserved => f.write_str("a reserved byte is not 0"),
            Self::Zero => f.write_str("the zero point of a 32-bit output is not 0"),
            Self::Multiplier => f.write_str("a multiplier is negative or too large"),
            Self::Weight => f.write_str("a weight is -128, which no kernel takes"),
            Self::Overflow { row } => write!(f, "the sum of row {row} could leave 32 bits"),
            Self::Second { row } => write!(f, "the weights of row {row} could leave 24 bits"),
        }
    }
}

impl core::error::Error for ModelError {}

/// A stage of the encoder: halves the map, then adds to it what two convolutions make of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct StageLayers<'a> {
    pub down: Linear<'a>,
    pub first: Linear<'a>,
    pub second: Linear<'a>,
    pub sum: Addition,
}

/// The layers that make an embedding of a photo.
#[derive(Clone, Copy, Debug)]
pub(super) struct EncoderLayers<'a> {
    pub stem: Linear<'a>,
    pub stages: [StageLayers<'a>; 3],
    pub sketch: Linear<'a>,
    pub embed: Linear<'a>,
}

/// A network that lies in a file in memory, checked.
#[derive(Clone, Copy)]
pub struct Model<'a> {
    dimensions: Dimensions,
    checksum: u32,
    pub(super) encoder: Option<EncoderLayers<'a>>,
    pub(super) token: [Linear<'a>; 2],
    pub(super) candidate: [Linear<'a>; 2],
    pub(super) state: [Linear<'a>; 2],
}

/// Without the weights.
impl fmt::Debug for Model<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { dimensions, checksum, .. } = self;
        f.debug_struct("Model")
            .field("dimensions", dimensions)
            .field("checksum", checksum)
            .finish_non_exhaustive()
    }
}

impl<'a> Model<'a> {
    /// The model in a file's bytes, which may lie at any address. See `FORMAT.md`.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, ModelError> {
        let (magic, rest) = bytes.split_first_chunk::<4>().ok_or(ModelError::Foreign)?;
        if *magic != MAGIC {
            return Err(ModelError::Foreign);
        }
        let short = ModelError::Length { expected: HEADER + CHECKSUM, got: bytes.len() };
        let (version, rest) = rest.split_first_chunk::<2>().ok_or(short)?;
        let got = u16::from_le_bytes(*version);
        if got != VERSION {
            return Err(ModelError::Version { got });
        }
        let (reserved, rest) = rest.split_first_chunk::<2>().ok_or(short)?;
        let (length, rest) = rest.split_first_chunk::<4>().ok_or(short)?;
        let (sizes, _) = rest.split_first_chunk::<16>().ok_or(short)?;
        let expected = u32::from_le_bytes(*length) as usize;
        if expected != bytes.len() {
            return Err(ModelError::Length { expected, got: bytes.len() });
        }
        let (covered, checksum) = bytes.split_last_chunk::<CHECKSUM>().ok_or(short)?;
        let checksum = u32::from_le_bytes(*checksum);
        if CRC.checksum(covered) != checksum {
            return Err(ModelError::Checksum);
        }
        if *reserved != [0; 2] {
            return Err(ModelError::Field { layer: "header", fault: Fault::Reserved });
        }
        let mut sizes =
            sizes.as_chunks::<2>().0.iter().map(|size| u16::from_le_bytes(*size).into());
        let mut size = || sizes.next().unwrap_or_default();
        let dimensions = Dimensions {
            channels: [size(), size(), size(), size()],
            embedding: size(),
            width: size(),
            head: size(),
            context: size(),
        };
        dimensions.check()?;
        let expected = dimensions.file_length();
        if expected != bytes.len() {
            return Err(ModelError::Length { expected, got: bytes.len() });
        }

        let mut reader = Reader { rest: covered.get(HEADER..).unwrap_or_default(), short };
        let mut encoder = None;
        if dimensions.embedding > 0 {
            let stem = reader.linear(&dimensions.stem())?;
            let [first, second, third] = dimensions.stages();
            let stages = [reader.stage(&first)?, reader.stage(&second)?, reader.stage(&third)?];
            let sketch = reader.linear(&dimensions.sketch())?;
            let embed = reader.linear(&dimensions.embed())?;
            encoder = Some(EncoderLayers { stem, stages, sketch, embed });
        }
        Ok(Self {
            dimensions,
            checksum,
            encoder,
            token: reader.pair(&dimensions.token())?,
            candidate: reader.pair(&dimensions.candidate())?,
            state: reader.pair(&dimensions.state())?,
        })
    }

    /// The network's sizes.
    pub fn dimensions(&self) -> &Dimensions {
        &self.dimensions
    }

    /// The file's checksum, by which models are told apart.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }
}

/// Bytes that lie at a multiple of 4, as the kernels of a Cortex-M want a model file for speed.
///
/// ```
/// # use vantage_core::soarnet::{Aligned, Model, ModelError};
/// # macro_rules! include_bytes { ($path:literal) => { b"foreign" } }
/// static FILE: &Aligned<[u8]> = &Aligned(*include_bytes!("soarnet.model"));
/// assert_eq!(Model::parse(&FILE.0).err(), Some(ModelError::Foreign));
/// ```
#[derive(Clone, Copy, Debug)]
#[repr(C, align(4))]
pub struct Aligned<T: ?Sized>(
    /// The bytes.
    pub T,
);

/// What is left of a file.
struct Reader<'a> {
    rest: &'a [u8],
    short: ModelError, // cannot happen: the length has been compared
}

impl<'a> Reader<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], ModelError> {
        let (taken, rest) = self.rest.split_at_checked(length).ok_or(self.short)?;
        self.rest = rest;
        Ok(taken)
    }

    /// A zero point and three reserved bytes.
    fn zero(&mut self, layer: &'static str) -> Result<i8, ModelError> {
        let (word, _) = self.take(4)?.as_chunks::<4>();
        match word {
            [[zero, 0, 0, 0]] => Ok(*zero as i8),
            _ => Err(ModelError::Field { layer, fault: Fault::Reserved }),
        }
    }

    fn linear(&mut self, shape: &Shape) -> Result<Linear<'a>, ModelError> {
        let fault = |fault| ModelError::Field { layer: shape.name, fault };
        let zero = self.zero(shape.name)?;
        if shape.output == Output::Wide && zero != 0 {
            return Err(fault(Fault::Zero));
        }
        let (rows, columns) = (shape.packed_rows(), shape.order.packed());
        let (bias, _) = self.take(4 * rows)?.as_chunks::<4>();
        let (multipliers, _) = self.take(4 * rows)?.as_chunks::<4>();
        let (weights, _) = self.take(rows * columns)?.as_chunks::<{ EDGE * EDGE }>();
        if multipliers.iter().any(|multiplier| i32::from_le_bytes(*multiplier) < 0) {
            return Err(fault(Fault::Multiplier));
        }
        let low = if shape.output == Output::Cut { zero } else { -128 };
        let linear = Linear { weights, columns, bias, multipliers, zero, low };

        let blocks = weights.chunks_exact(linear.stride()).zip(bias.as_chunks::<EDGE>().0);
        let blocks = blocks.zip(multipliers.as_chunks::<EDGE>().0);
        for (first, ((tiles, bias), multipliers)) in (0..).step_by(EDGE).zip(blocks) {
            let mut sizes = [0; EDGE]; // of the weights of each row, at most 127 · 1152
            for (at, tile) in (0..).step_by(EDGE).zip(tiles) {
                let used = [0, 1, 2, 3].map(|within| shape.order.source(at + within).is_some());
                for (row, (size, weights)) in sizes.iter_mut().zip(unpack(tile)).enumerate() {
                    for (weight, used) in weights.into_iter().zip(used) {
                        if weight == i8::MIN {
                            return Err(fault(Fault::Weight));
                        }
                        if weight != 0 && !(used && first + row < shape.rows) {
                            return Err(fault(Fault::Reserved));
                        }
                        *size += u32::from(weight.unsigned_abs());
                    }
                }
            }
            let numbers = sizes.into_iter().zip(bias).zip(multipliers).enumerate();
            for (within, ((size, bias), multiplier)) in numbers {
                let row = first + within;
                if row >= shape.rows && [*bias, *multiplier] != [[0; 4]; 2] {
                    return Err(fault(Fault::Reserved));
                }
                let bias = i32::from_le_bytes(*bias).unsigned_abs();
                if (128 * size).saturating_add(bias) > i32::MAX as u32 {
                    return Err(fault(Fault::Overflow { row }));
                }
                if within % 2 == 1 && 128 * size > LARGEST_SECOND {
                    return Err(fault(Fault::Second { row }));
                }
            }
        }
        Ok(linear)
    }

    fn pair(&mut self, [first, second]: &[Shape; 2]) -> Result<[Linear<'a>; 2], ModelError> {
        Ok([self.linear(first)?, self.linear(second)?])
    }

    fn stage(&mut self, shapes: &[Shape; 3]) -> Result<StageLayers<'a>, ModelError> {
        let [down, first, second] = shapes;
        let layer = second.name;
        let (down, first, second) = (self.linear(down)?, self.linear(first)?, self.linear(second)?);
        let zero = self.zero(layer)?;
        let (multipliers, _) = self.take(8)?.as_chunks::<4>();
        let mut multipliers = multipliers.iter().map(|bytes| i32::from_le_bytes(*bytes));
        let mut next = || multipliers.next().unwrap_or_default();
        let (multiplier, other_multiplier) = (next(), next());
        let sum = i64::from(multiplier) + i64::from(other_multiplier);
        if multiplier < 0 || other_multiplier < 0 || sum > i64::from(LARGEST_ADDITION) {
            return Err(ModelError::Field { layer, fault: Fault::Multiplier });
        }
        let (zero_in, other_zero_in) = (down.zero, second.zero);
        let sum = Addition { multiplier, other_multiplier, zero_in, other_zero_in, zero };
        Ok(StageLayers { down, first, second, sum })
    }
}

/// A linear map to be written: (rows) from (columns), as the layer's place in [`Network`] says.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layer<'a> {
    /// Shape (rows, columns), -127..=127.
    pub weights: &'a [i8],
    /// Shape (rows); with the input's zero point taken in: `bias - zero_in · Σ_c weights[c]`.
    pub bias: &'a [i32],
    /// Shape (rows), not negative: what a step of the sum is worth, units of 2^-32 of a step of the
    /// output. Of the two `output` layers: units of 2^-20 of the output's 2^-16, that is 2^-36.
    pub multipliers: &'a [i32],
    /// The output's zero point; 0 for the two `output` layers.
    pub zero: i8,
}

/// A stage of the encoder, to be written; `c` channels from `b`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stage<'a> {
    /// Window of 3 x 3, stride 2, negative values cut off: (c) from (3, 3, b).
    pub down: Layer<'a>,
    /// Window of 3 x 3, negative values cut off: (c) from (3, 3, c).
    pub first: Layer<'a>,
    /// Window of 3 x 3: (c) from (3, 3, c).
    pub second: Layer<'a>,
    /// What a step of `down`'s output is worth in the sum, units of 2^-18 of its step; not negative,
    /// both together at most [`LARGEST_ADDITION`].
    pub multiplier: i32,
    /// The same of a step of `second`'s output.
    pub second_multiplier: i32,
    /// The sum's zero point; negative values are cut off.
    pub zero: i8,
}

/// The encoder, to be written.
#[derive(Clone, Copy, Debug, Default)]
pub struct EncoderParts<'a> {
    /// Window of 3 x 3, stride 2, negative values cut off: (c0) from (3, 3, RGB) of `colour - 128`.
    pub stem: Layer<'a>,
    /// From 32 x 32 to 16 x 16, 8 x 8, 4 x 4.
    pub stages: [Stage<'a>; 3],
    /// (5) from (c2), of each cell of stage 2's map: the shares of its four quarters that the object
    /// covers (upper left, upper right, lower left, lower right), then how much its colours change;
    /// zero point 0, 127 for 1.
    pub sketch: Layer<'a>,
    /// (E) from (4, 4, c3) = (row, column, channel).
    pub embed: Layer<'a>,
}

/// A network to be written as a model file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Network<'a> {
    /// Its sizes.
    pub dimensions: Dimensions,
    /// The encoder; `None` in a network without images.
    pub encoder: Option<EncoderParts<'a>>,
    /// (H) from [embedding (E) | view's direction (16) | relation to the candidate (16)], then (H)
    /// from (H); negative values of both cut off.
    pub token: [Layer<'a>; 2],
    /// (K) from [mean (H) | maximum (H) | outlook (8), only with an encoder | candidate's direction (16)
    /// | count (4)], negative values cut off, then the output (4) from (K): rank scores of C, Q, D, T.
    pub candidate: [Layer<'a>; 2],
    /// (G) from [mean of means (H) | mean of maxima (H) | count (4)], negative values cut off, then the
    /// output (12) from (G): score, mean gain, spread of gains, each of C, Q, D, T.
    pub state: [Layer<'a>; 2],
}

/// Why a network cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteError {
    /// The buffer is too small.
    NoRoom {
        /// Bytes needed.
        needed: usize,
        /// Bytes there are.
        got: usize,
    },
    /// The sizes ask for an encoder and there is none, or the other way round.
    Encoder,
    /// A layer has not as many numbers as the sizes ask for.
    Shape {
        /// The layer.
        layer: &'static str,
        /// Rows asked for.
        rows: usize,
        /// Columns asked for.
        columns: usize,
    },
    /// What was written would be refused.
    Model(ModelError),
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoom { needed, got } => {
                write!(f, "the model needs {needed} bytes and the buffer has {got}")
            }
            Self::Encoder => {
                f.write_str("a network has an encoder where its embedding is not 0, and only there")
            }
            Self::Shape { layer, rows, columns } => write!(
                f,
                "the layer `{layer}` needs {rows} rows of {columns} weights, and a bias and a \
                 multiplier for each"
            ),
            Self::Model(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for WriteError {}

impl From<ModelError> for WriteError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

impl Network<'_> {
    /// Writes the model file, checks it as [`Model::parse`] does and gives the number of bytes used.
    pub fn write(&self, buffer: &mut [u8]) -> Result<usize, WriteError> {
        let dimensions = &self.dimensions;
        dimensions.check()?;
        let (needed, got) = (dimensions.file_length(), buffer.len());
        let no_room = WriteError::NoRoom { needed, got };
        let file = buffer.get_mut(..needed).ok_or(no_room)?;
        let (body, checksum) = file.split_last_chunk_mut::<CHECKSUM>().ok_or(no_room)?;

        let mut writer = Writer { rest: body, no_room };
        writer.put(&MAGIC)?;
        writer.put(&VERSION.to_le_bytes())?;
        writer.put(&[0; 2])?;
        writer.put(&u32::try_from(needed).map_err(|_| no_room)?.to_le_bytes())?;
        for size in dimensions.in_order() {
            writer.put(&(size as u16).to_le_bytes())?; // at most 128
        }
        match &self.encoder {
            Some(encoder) if dimensions.embedding > 0 => {
                writer.layer(&dimensions.stem(), &encoder.stem)?;
                for ([down, first, second], stage) in
                    dimensions.stages().iter().zip(&encoder.stages)
                {
                    writer.layer(down, &stage.down)?;
                    writer.layer(first, &stage.first)?;
                    writer.layer(second, &stage.second)?;
                    writer.zero(stage.zero)?;
                    writer.put(&stage.multiplier.to_le_bytes())?;
                    writer.put(&stage.second_multiplier.to_le_bytes())?;
                }
                writer.layer(&dimensions.sketch(), &encoder.sketch)?;
                writer.layer(&dimensions.embed(), &encoder.embed)?;
            }
            None if dimensions.embedding == 0 => {}
            _ => return Err(WriteError::Encoder),
        }
        let shapes = [dimensions.token(), dimensions.candidate(), dimensions.state()];
        let layers = [self.token, self.candidate, self.state];
        for (shape, layer) in shapes.as_flattened().iter().zip(layers.as_flattened()) {
            writer.layer(shape, layer)?;
        }
        *checksum = CRC.checksum(body).to_le_bytes();
        Model::parse(file)?;
        Ok(needed)
    }
}

/// What is still to be filled of a file.
struct Writer<'a> {
    rest: &'a mut [u8],
    no_room: WriteError, // cannot happen: the length has been compared
}

impl Writer<'_> {
    fn put(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        let place = self.rest.split_off_mut(..bytes.len()).ok_or(self.no_room)?;
        place.copy_from_slice(bytes);
        Ok(())
    }

    fn zero(&mut self, zero: i8) -> Result<(), WriteError> {
        self.put(&[zero as u8, 0, 0, 0])
    }

    fn layer(&mut self, shape: &Shape, layer: &Layer<'_>) -> Result<(), WriteError> {
        let &Shape { name, rows, order, .. } = shape;
        let columns = order.columns();
        let Layer { weights, bias, multipliers, zero } = layer;
        if weights.len() != rows * columns || bias.len() != rows || multipliers.len() != rows {
            return Err(WriteError::Shape { layer: name, rows, columns });
        }
        self.zero(*zero)?;
        for list in [bias, multipliers] {
            let zeros = [0].iter().cycle();
            for value in list.iter().chain(zeros).take(shape.packed_rows()) {
                self.put(&value.to_le_bytes())?;
            }
        }
        let weight = |row: usize, packed: usize| {
            let column = order.source(packed)?;
            weights.get(row * columns + column).copied()
        };
        for first in (0..rows).step_by(EDGE) {
            for at in (0..order.packed()).step_by(EDGE) {
                let mut tile = [[0; EDGE]; EDGE];
                for (row, weights) in (first..).zip(&mut tile) {
                    for (packed, place) in (at..).zip(weights) {
                        *place = weight(row, packed).unwrap_or(0);
                    }
                }
                self.put(&pack(tile))?;
            }
        }
        Ok(())
    }
}
