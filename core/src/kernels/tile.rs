//! How weights lie in memory: tiles of 4 rows x 4 columns in 16 bytes.
//!
//! A lane of 16 bits holds the weights of two rows, `256 · second + first`. A multiplication of
//! 16-bit numbers takes both at once: the sum `R` of `lane · input` is `S0 + 256 · S1`, and with `S0`,
//! the sum of the lanes' low bytes, `S1 = (R - S0) >> 8` is exact while `|S1| < 2^23`. So a weight takes
//! one byte and two instructions unpack four of them.
//!
//! ```text
//! bytes 0..8    rows 0 and 1:  columns 0, 2, 1, 3         each lane little-endian
//! bytes 8..16   rows 2 and 3:  columns 0, 2, 1, 3
//! ```
//!
//! The columns' order is the one in which `sxtb16` of a Cortex-M widens four bytes. Tiles follow each
//! other by columns, then by rows; what is missing of the last ones is 0.

/// Rows and columns of a tile.
pub const EDGE: usize = 4;

/// 4 x 4 weights as they lie in memory.
pub type Tile = [u8; 16];

/// The place of each column among the lanes, and of each lane's column: the order is its own inverse.
pub const LANES: [usize; EDGE] = [0, 2, 1, 3];

/// Channels of a map that are kept together.
pub const GROUP: usize = 8;

/// A tile of weights in -127..=127. Shape (row, column).
pub const fn pack(weights: [[i8; EDGE]; EDGE]) -> Tile {
    let [one, two, three, four] = weights;
    let (a, b) = (pack_pair(one, two), pack_pair(three, four));
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a, b);
    let lanes = [a0, a2, a1, a3, b0, b2, b1, b3];
    let [[c0, c1], [c2, c3], [c4, c5], [c6, c7], [d0, d1], [d2, d3], [d4, d5], [d6, d7]] = lanes;
    [c0, c1, c2, c3, c4, c5, c6, c7, d0, d1, d2, d3, d4, d5, d6, d7]
}

const fn pack_pair(first: [i8; EDGE], second: [i8; EDGE]) -> [[u8; 2]; EDGE] {
    let ([a, b, c, d], [e, f, g, h]) = (first, second);
    [pack_lane(a, e), pack_lane(b, f), pack_lane(c, g), pack_lane(d, h)]
}

const fn pack_lane(first: i8, second: i8) -> [u8; 2] {
    (second as i16).wrapping_mul(256).wrapping_add(first as i16).to_le_bytes()
}

/// The weights of a tile, shape (row, column); -128 where a tile holds what [`pack`] does not write.
#[inline(always)]
pub const fn unpack(tile: &Tile) -> [[i8; EDGE]; EDGE] {
    let &[c0, c1, c2, c3, c4, c5, c6, c7, d0, d1, d2, d3, d4, d5, d6, d7] = tile;
    let ([a, e], [c, g]) = (unpack_lane([c0, c1]), unpack_lane([c2, c3]));
    let ([b, f], [d, h]) = (unpack_lane([c4, c5]), unpack_lane([c6, c7]));
    let ([i, m], [k, o]) = (unpack_lane([d0, d1]), unpack_lane([d2, d3]));
    let ([j, n], [l, p]) = (unpack_lane([d4, d5]), unpack_lane([d6, d7]));
    [[a, b, c, d], [e, f, g, h], [i, j, k, l], [m, n, o, p]]
}

#[inline(always)]
const fn unpack_lane(bytes: [u8; 2]) -> [i8; 2] {
    let lane = i16::from_le_bytes(bytes) as i32;
    let first = lane as i8;
    // 128 only where the lane is none of ours; it becomes -128.
    [first, ((lane - first as i32) >> 8) as i8]
}

/// The order of a layer's columns in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// As they are counted: fully connected layers and windows of one pixel.
    Plain {
        /// How many there are.
        columns: usize,
    },
    /// A window of 3 x 3 pixels: (group of 8 channels, column of the window, its row, channel of the
    /// group), so that what one group contributes is one run of a buffer of three widened rows.
    Window {
        /// Channels of the input.
        channels: usize,
    },
    /// A window of 3 x 3 pixels of three colours, in the order of lanes, not of columns: (column of the
    /// window, 10 numbers), where the numbers are (row of the window, colour) and a 0.
    Colours,
}

impl Order {
    /// Columns in memory: a multiple of 4.
    pub const fn packed(self) -> usize {
        match self {
            Self::Plain { columns } => columns.div_ceil(EDGE) * EDGE,
            Self::Window { channels } => 9 * GROUP * channels.div_ceil(GROUP),
            Self::Colours => 32,
        }
    }

    /// Columns as a layer is written down: those of a window are (row, column, channel).
    pub const fn columns(self) -> usize {
        match self {
            Self::Plain { columns } => columns,
            Self::Window { channels } => 9 * channels,
            Self::Colours => 27,
        }
    }

    /// Which column of the layer a column in memory holds; `None` where it holds zeros.
    pub const fn source(self, packed: usize) -> Option<usize> {
        match self {
            Self::Plain { columns } => {
                if packed < columns {
                    Some(packed)
                } else {
                    None
                }
            }
            Self::Window { channels } => {
                let (place, within) = (packed / GROUP, packed % GROUP);
                let (group, place) = (place / 9, place % 9);
                let (column, row, channel) = (place / 3, place % 3, GROUP * group + within);
                if channel < channels {
                    Some((3 * row + column) * channels + channel)
                } else {
                    None
                }
            }
            Self::Colours => {
                // Columns 1 and 2 of a tile have each other's lane.
                let lane = match packed % EDGE {
                    1 => packed + 1,
                    2 => packed - 1,
                    _ => packed,
                };
                let (column, number) = (lane / 10, lane % 10);
                if column < 3 && number < 9 {
                    Some((3 * (number / 3) + column) * 3 + number % 3)
                } else {
                    None
                }
            }
        }
    }
}
