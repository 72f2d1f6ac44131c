//! Brings a model file of version 2 to the version of this build, without loss: the same numbers in
//! another order.
//!
//! `cargo run --package vantage-core --example repack -- OLD NEW`
//!
//! Version 2 had the weights row after row, each row filled up with zeros to a multiple of 4 bytes.
//! This program can go once no such file is left.

use std::error::Error;
use std::{env, fs};

use vantage_core::soarnet::{Dimensions, EncoderParts, Layer, Network, Stage};

const OLD: u16 = 2;
const HEADER: usize = 28;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [old, new] = arguments.as_slice() else { return Err("usage: repack OLD NEW".into()) };
    let bytes = fs::read(old).map_err(|error| format!("cannot read {old}: {error}"))?;
    let file = repack(&bytes).map_err(|error| format!("{old}: {error}"))?;
    fs::write(new, &file).map_err(|error| format!("cannot write {new}: {error}"))?;
    println!("{new}: {} bytes, {} before", file.len(), bytes.len());
    Ok(())
}

/// The numbers of a layer.
struct Numbers {
    weights: Vec<i8>,
    bias: Vec<i32>,
    multipliers: Vec<i32>,
    zero: i8,
}

impl Numbers {
    fn layer(&self) -> Layer<'_> {
        let Self { weights, bias, multipliers, zero } = self;
        Layer { weights, bias, multipliers, zero: *zero }
    }
}

/// What is left of a file.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take(&mut self, length: usize) -> Result<&[u8], Box<dyn Error>> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or("it is cut short")?;
        self.0 = rest;
        Ok(taken)
    }

    fn zero(&mut self) -> Result<i8, Box<dyn Error>> {
        Ok(self.take(4)?.first().copied().unwrap_or_default() as i8)
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<i32>, Box<dyn Error>> {
        let (words, _) = self.take(4 * count)?.as_chunks::<4>();
        Ok(words.iter().map(|word| i32::from_le_bytes(*word)).collect())
    }

    fn layer(&mut self, rows: usize, columns: usize) -> Result<Numbers, Box<dyn Error>> {
        let zero = self.zero()?;
        let (bias, multipliers) = (self.numbers(rows)?, self.numbers(rows)?);
        let padded = columns.next_multiple_of(4);
        let bytes = self.take(rows * padded)?.chunks_exact(padded);
        let weights = bytes.flat_map(|row| row.iter().take(columns)).map(|&byte| byte as i8);
        Ok(Numbers { weights: weights.collect(), bias, multipliers, zero })
    }
}

fn repack(bytes: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    if !bytes.starts_with(b"SOAR") {
        return Err("it is not a SOARNet model".into());
    }
    let (covered, checksum) = bytes.split_last_chunk::<4>().ok_or("it is cut short")?;
    if crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(covered)
        != u32::from_le_bytes(*checksum)
    {
        return Err("it is damaged: its checksum does not match".into());
    }
    let header = covered.get(..HEADER).ok_or("it is cut short")?;
    let halves: Vec<u16> =
        header.as_chunks::<2>().0.iter().map(|half| u16::from_le_bytes(*half)).collect();
    let &[_, _, version, _, _, _, c0, c1, c2, c3, e, h, k, g] = halves.as_slice() else {
        return Err("it is cut short".into());
    };
    if version != OLD {
        return Err(format!("it has version {version}, and this program reads {OLD}").into());
    }
    let [c0, c1, c2, c3, e, h, k, g] = [c0, c1, c2, c3, e, h, k, g].map(usize::from);
    let dimensions =
        Dimensions { channels: [c0, c1, c2, c3], embedding: e, width: h, head: k, context: g };

    let mut reader = Reader(covered.get(HEADER..).unwrap_or_default());
    let (mut layers, mut sums) = (Vec::new(), Vec::new());
    if e > 0 {
        layers.push(reader.layer(c0, 27)?);
        for (from, to) in [(c0, c1), (c1, c2), (c2, c3)] {
            for channels in [from, to, to] {
                layers.push(reader.layer(to, 9 * channels)?);
            }
            sums.push((reader.zero()?, reader.numbers(2)?));
        }
        layers.push(reader.layer(5, c2)?);
        layers.push(reader.layer(e, 16 * c3)?);
    }
    let outlook = if e > 0 { 8 } else { 0 };
    let shapes = [(h, e + 32), (h, h), (k, 2 * h + outlook + 20), (4, k), (g, 2 * h + 4), (12, g)];
    let mut heads = Vec::new();
    for (rows, columns) in shapes {
        heads.push(reader.layer(rows, columns)?);
    }
    if !reader.0.is_empty() {
        return Err("it is too long".into());
    }

    let encoder = match (layers.as_slice(), sums.as_slice()) {
        ([stem, stages @ .., sketch, embed], [first, second, third]) => {
            let (stages, _) = stages.as_chunks::<3>();
            let mut parts = [Stage::default(); 3];
            let sums = [first, second, third].into_iter().zip(stages);
            for (part, ((zero, multipliers), [down, first, second])) in parts.iter_mut().zip(sums) {
                let &[multiplier, second_multiplier] = multipliers.as_slice() else { continue };
                let [down, first, second] = [down, first, second].map(Numbers::layer);
                *part = Stage { down, first, second, multiplier, second_multiplier, zero: *zero };
            }
            Some(EncoderParts {
                stem: stem.layer(),
                stages: parts,
                sketch: sketch.layer(),
                embed: embed.layer(),
            })
        }
        _ => None,
    };
    let heads: Vec<Layer<'_>> = heads.iter().map(Numbers::layer).collect();
    let &[a, b, c, d, e, f] = heads.as_slice() else { return Err("it is cut short".into()) };
    let network = Network { dimensions, encoder, token: [a, b], candidate: [c, d], state: [e, f] };
    let mut file = vec![0; dimensions.file_length()];
    network.write(&mut file)?;
    Ok(file)
}
