//! Networks by chance, and a plain reading of what they compute.

use rand_core::Rng;
use rand_pcg::Pcg32;
use vantage_core::soarnet::{Dimensions, EncoderParts, Layer, Network, Stage};

/// Sizes that are quick to run, no two alike where they could be confused.
pub const SMALL: Dimensions =
    Dimensions { channels: [4, 8, 12, 16], embedding: 20, width: 24, head: 12, context: 8 };

/// A layer with its memory.
#[derive(Clone, Debug, Default)]
pub struct OwnLayer {
    pub weights: Vec<i8>,
    pub bias: Vec<i32>,
    pub multipliers: Vec<i32>,
    pub zero: i8,
}

impl OwnLayer {
    fn by_chance(chance: &mut Pcg32, rows: usize, columns: usize, zero: i8, gain: i64) -> Self {
        let mut below = |bound: u32| (chance.next_u32() >> 8) % bound;
        // Inputs and weights are about 74 large: a sum is about 74 · 74 · sqrt(columns).
        let typical = 5476 * (columns as u64).isqrt() as i64;
        Self {
            weights: (0..rows * columns).map(|_| (below(255) as i32 - 127) as i8).collect(),
            bias: (0..rows).map(|_| below(20_000) as i32 - 10_000).collect(),
            multipliers: (0..rows).map(|_| (gain / typical) as i32 + below(99) as i32).collect(),
            zero,
        }
    }

    pub fn layer(&self) -> Layer<'_> {
        let Self { weights, bias, multipliers, zero } = self;
        Layer { weights, bias, multipliers, zero: *zero }
    }
}

/// A network with its memory.
#[derive(Clone, Debug)]
pub struct OwnNetwork {
    pub dimensions: Dimensions,
    pub encoder: Vec<OwnLayer>, // stem; down, first, second of three stages; embed; sketch
    pub heads: Vec<OwnLayer>,   // token, candidate, state: two each
}

/// The multipliers and the zero point of the sums of maps.
pub const SUM: (i32, i32, i8) = (200_000, 150_000, -100);

impl OwnNetwork {
    pub fn by_chance(dimensions: Dimensions, seed: u64) -> Self {
        let mut chance = Pcg32::new(seed, 0x5eed);
        let Dimensions { channels: [c0, c1, c2, c3], embedding: e, width: h, head: k, context: g } =
            dimensions;
        // Bytes of about 60; numbers of 32 bits of about a half.
        let (byte, wide) = (60i64 << 32, 1i64 << (15 + 20));
        let mut layer =
            |rows, columns, zero, gain| OwnLayer::by_chance(&mut chance, rows, columns, zero, gain);
        let mut encoder = Vec::new();
        if e > 0 {
            encoder.push(layer(c0, 27, -128, byte));
            for (from, to) in [(c0, c1), (c1, c2), (c2, c3)] {
                encoder.push(layer(to, 9 * from, -128, byte));
                encoder.push(layer(to, 9 * to, -90, byte));
                encoder.push(layer(to, 9 * to, 5, byte));
            }
            encoder.push(layer(e, 16 * c3, -3, byte));
            // Above 0, so that a few photos leave something of the hull.
            encoder.push(layer(5, c2, 40, byte));
        }
        let outlook = if e > 0 { 8 } else { 0 };
        let heads = vec![
            layer(h, e + 32, -128, byte),
            layer(h, h, -120, byte),
            layer(k, 2 * h + outlook + 20, -128, byte),
            layer(4, k, 0, wide),
            layer(g, 2 * h + 4, -128, byte),
            layer(12, g, 0, wide),
        ];
        Self { dimensions, encoder, heads }
    }

    pub fn network(&self) -> Network<'_> {
        let encoder = (!self.encoder.is_empty()).then(|| {
            let at = |index: usize| self.encoder[index].layer();
            let stage = |index: usize| Stage {
                down: at(index),
                first: at(index + 1),
                second: at(index + 2),
                multiplier: SUM.0,
                second_multiplier: SUM.1,
                zero: SUM.2,
            };
            EncoderParts {
                stem: at(0),
                stages: [stage(1), stage(4), stage(7)],
                embed: at(10),
                sketch: at(11),
            }
        });
        let head = |index: usize| [self.heads[index].layer(), self.heads[index + 1].layer()];
        Network {
            dimensions: self.dimensions,
            encoder,
            token: head(0),
            candidate: head(2),
            state: head(4),
        }
    }

    /// The model file.
    pub fn file(&self) -> Vec<u8> {
        let mut file = vec![0; self.dimensions.file_length()];
        assert_eq!(self.network().write(&mut file), Ok(file.len()));
        file
    }
}
