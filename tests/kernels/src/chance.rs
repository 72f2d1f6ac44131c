//! Layers and inputs by chance, in memory that is given.

use rand_core::Rng;
use rand_pcg::Pcg32;
use vantage_core::kernels::{EDGE, Linear, Order, Tile, pack};

/// The most rows of a layer.
pub const ROWS: usize = 128;
/// The most tiles of a layer.
pub const TILES: usize = 8192;

/// Numbers by chance, the same for the same seed.
pub struct Chance(Pcg32);

impl Chance {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::new(seed, 0x6b65_726e_656c))
    }

    /// In 0 .. bound.
    pub fn below(&mut self, bound: usize) -> usize {
        ((u64::from(self.0.next_u32()) * bound as u64) >> 32) as usize
    }

    /// Any 32 bits.
    pub fn word(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// A byte, an extreme in a quarter of cases.
    pub fn byte(&mut self) -> i8 {
        let word = self.word();
        match word >> 28 {
            0 | 1 => -128,
            2 | 3 => 127,
            _ => word as i8,
        }
    }
}

/// How extreme a layer and its input are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// By chance.
    None,
    /// The largest sums that a layer may have, of either sign.
    Sums,
}

/// Memory of a layer. The tiles and the lists begin at any of 4 addresses.
pub struct Owned {
    tiles: [u8; 16 * TILES + 4],
    bias: [u8; 4 * ROWS + 4],
    multipliers: [u8; 4 * ROWS + 4],
    offset: usize,
    rows: usize,
    columns: usize,
    zero: i8,
    low: i8,
}

impl Owned {
    /// Nothing.
    pub const fn new() -> Self {
        Self {
            tiles: [0; 16 * TILES + 4],
            bias: [0; 4 * ROWS + 4],
            multipliers: [0; 4 * ROWS + 4],
            offset: 0,
            rows: 0,
            columns: 0,
            zero: 0,
            low: 0,
        }
    }

    /// A layer by chance whose lists begin `offset` bytes from a multiple of 4.
    ///
    /// Outputs spread over their range: a sum is about 60 times the root of the columns squared.
    pub fn draw(
        &mut self,
        rows: usize,
        order: Order,
        extreme: Extreme,
        offset: usize,
        chance: &mut Chance,
    ) {
        let packed = order.packed();
        let columns = order.columns();
        self.offset = offset + self.tiles.as_ptr().align_offset(4);
        self.columns = packed;
        self.rows = rows;
        self.zero = chance.byte();
        self.low = if chance.below(2) == 0 { -128 } else { self.zero };
        // Second rows have 24 bits: 128 · Σ|w| < 2^23.
        let second = (((1 << 16) - 1) / columns.max(1)).min(127);
        let typical = 5_476 * (columns as u64).isqrt().max(1);
        for row in 0..rows {
            let multiplier = match (extreme, chance.below(8)) {
                (Extreme::None, 0) => (chance.word() >> 1) as i32,
                (Extreme::Sums, 0) => i32::MAX,
                _ => ((60 << 32) / typical) as i32 + chance.below(1000) as i32,
            };
            let bias = match extreme {
                Extreme::None => chance.below(20_000) as i32 - 10_000,
                // What the weights leave of 32 bits, of either sign; odd rows have less.
                Extreme::Sums => {
                    let room = i32::MAX - 128 * 127 * columns as i32;
                    if chance.below(2) == 0 { room } else { -room }
                }
            };
            put(&mut self.bias, self.offset, row, bias);
            put(&mut self.multipliers, self.offset, row, multiplier);
        }
        let mut signs = [false; ROWS];
        for sign in &mut signs {
            *sign = chance.below(2) == 0;
        }
        let tiles = self.tiles.get_mut(self.offset..).unwrap_or_default();
        let mut tiles = tiles.as_chunks_mut::<16>().0.iter_mut();
        for first in (0..rows).step_by(EDGE) {
            for at in (0..packed).step_by(EDGE) {
                let mut tile = [[0; EDGE]; EDGE];
                for (within, row) in tile.iter_mut().enumerate() {
                    let most = if within % 2 == 1 { second } else { 127 };
                    for (column, weight) in row.iter_mut().enumerate() {
                        let there = first + within < rows && order.source(at + column).is_some();
                        let value = match extreme {
                            Extreme::None => chance.below(2 * most + 1) as i32 - most as i32,
                            Extreme::Sums if signs[first + within] => most as i32,
                            Extreme::Sums => -(most as i32),
                        };
                        *weight = if there { value as i8 } else { 0 };
                    }
                }
                if let Some(place) = tiles.next() {
                    *place = pack(tile);
                }
            }
        }
    }

    /// The layer.
    pub fn linear(&self) -> Linear<'_> {
        let tiles = self.rows.div_ceil(EDGE) * self.columns.div_ceil(EDGE);
        let weights: &[Tile] = self.tiles.get(self.offset..).unwrap_or_default().as_chunks().0;
        let list = |bytes| -> &[[u8; 4]] {
            <[u8]>::get(bytes, self.offset..).unwrap_or_default().as_chunks().0
        };
        Linear {
            weights: weights.get(..tiles).unwrap_or_default(),
            columns: self.columns,
            bias: list(&self.bias).get(..self.rows).unwrap_or_default(),
            multipliers: list(&self.multipliers).get(..self.rows).unwrap_or_default(),
            zero: self.zero,
            low: self.low,
        }
    }
}

impl Default for Owned {
    fn default() -> Self {
        Self::new()
    }
}

fn put(list: &mut [u8], offset: usize, row: usize, value: i32) {
    if let Some(place) = list.get_mut(offset + 4 * row..offset + 4 * row + 4) {
        place.copy_from_slice(&value.to_le_bytes());
    }
}
