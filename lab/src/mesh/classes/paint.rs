//! Colours that go together, and pictures to print on things: small, and without a seam where they
//! repeat.

use vantage_core::math::sin;

use crate::mesh::colour::linear_from_srgb;
use crate::mesh::kit::{Chance, hsv, mix, painted, scaled, step};
use crate::mesh::shapes::TURN;
use crate::mesh::{Material, Texture};

/// sRGB, each in [0, 1].
pub(super) type Rgb = [f32; 3];

/// What the colours of one object have in common.
#[derive(Clone, Copy)]
pub(super) struct Palette {
    mood: Mood,
    hue: f32,
    spread: f32, // turns of hue between the colours, at most
}

#[derive(Clone, Copy)]
enum Mood {
    Saturated,
    Muted,
    Pale,
    Grey,
    Dark,
    Mixed,
}

impl Palette {
    pub fn new(chance: &mut Chance) -> Self {
        const MOODS: [Mood; 8] = [
            Mood::Saturated,
            Mood::Saturated,
            Mood::Muted,
            Mood::Muted,
            Mood::Pale,
            Mood::Grey,
            Mood::Dark,
            Mood::Mixed,
        ];
        let mood = MOODS[chance.below(MOODS.len() as u32) as usize];
        Self { mood, hue: chance.unit(), spread: [0.06, 0.2, 1.0][chance.below(3) as usize] }
    }

    /// One of its colours.
    pub fn colour(&self, chance: &mut Chance) -> Rgb {
        let mut hue = self.hue + self.spread * (chance.unit() - 0.5);
        let (saturation, value) = match self.mood {
            Mood::Saturated => ((0.7, 1.0), (0.6, 1.0)),
            Mood::Muted => ((0.25, 0.55), (0.35, 0.8)),
            Mood::Pale => ((0.06, 0.3), (0.8, 1.0)),
            Mood::Grey => ((0.0, 0.06), (0.2, 0.95)),
            Mood::Dark => ((0.1, 0.7), (0.08, 0.35)),
            Mood::Mixed => {
                hue = chance.unit();
                ((0.0, 1.0), (0.15, 1.0))
            }
        };
        let saturation = chance.between(saturation.0, saturation.1);
        hsv(hue, saturation, chance.between(value.0, value.1))
    }
}

/// A material of one colour and no picture.
pub(super) fn plain(colour: Rgb) -> Material {
    Material::plain("plain", colour.map(linear_from_srgb))
}

/// Ways to cover a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pattern {
    Plain,
    Speckle,
    Clouds,
    Stripes,
    Bands,
    Checks,
    Dots,
    Patches,
    Marks,
    Wood,
    Stone,
    Weave,
    Scuffed,
    Gradient,
}

impl Pattern {
    pub const ALL: [Self; 14] = [
        Self::Plain,
        Self::Speckle,
        Self::Clouds,
        Self::Stripes,
        Self::Bands,
        Self::Checks,
        Self::Dots,
        Self::Patches,
        Self::Marks,
        Self::Wood,
        Self::Stone,
        Self::Weave,
        Self::Scuffed,
        Self::Gradient,
    ];

    pub fn one_of(chance: &mut Chance, choice: &[Self]) -> Self {
        choice[chance.below(choice.len() as u32) as usize]
    }

    /// A material of this pattern in colours that go from the first to the others.
    pub fn material(self, [a, b, c]: [Rgb; 3], size: u32, chance: &mut Chance) -> Material {
        let seed = chance.bits();
        let count = |chance: &mut Chance, low: u32, more: u32| (low + chance.below(more)) as f32;
        match self {
            Self::Plain => plain(a),
            Self::Speckle => {
                let (n, amount) = (24 + 8 * chance.below(4), chance.between(0.15, 0.6));
                painted("speckle", size, |u, v| mix(a, b, amount * tile_noise(u, v, n, seed)))
            }
            Self::Clouds => {
                let n = 2 + chance.below(4);
                painted("clouds", size, |u, v| {
                    let t = tile_fractal(u, v, n, seed);
                    mix(mix(a, b, step(0.3, 0.55, t)), c, step(0.55, 0.75, t))
                })
            }
            Self::Stripes | Self::Bands => {
                let across = self == Self::Stripes;
                let (n, share) = (count(chance, 2, 7), chance.between(0.2, 0.6));
                let (waves, high) = (count(chance, 1, 3), 0.12 * chance.below(2) as f32);
                painted("stripes", size, |u, v| {
                    let (along, over) = if across { (u, v) } else { (v, u) };
                    let at = (along * n + high * sin(over * waves * TURN) + 1.0).fract();
                    let line = (at - share).abs() < 0.05 || at < 0.05;
                    let colour = if at < share { a } else { b };
                    let colour = if line { c } else { colour };
                    scaled(colour, 0.92 + 0.1 * tile_noise(u, v, 32, seed))
                })
            }
            Self::Checks => {
                let (n, thin) = (2.0 * count(chance, 1, 4), chance.below(2) == 0);
                painted("checks", size, |u, v| {
                    let odd = ((u * n) as i32 + (v * n) as i32) & 1 == 1;
                    let line = (u * n).fract().min((v * n).fract()) < 0.08;
                    let colour = if odd { a } else { b };
                    let colour = if line && thin { c } else { colour };
                    scaled(colour, 0.92 + 0.1 * tile_noise(u, v, 32, seed))
                })
            }
            Self::Dots => {
                let (n, radius) = (count(chance, 3, 5), chance.between(0.18, 0.42));
                painted("dots", size, |u, v| {
                    let row = (v * n) as u32;
                    let shift = 0.5 * (row & 1) as f32;
                    let (x, y) = ((u * n + shift).fract() - 0.5, (v * n).fract() - 0.5);
                    let far = (x * x + y * y).sqrt();
                    let dot = if row.is_multiple_of(3) { c } else { b };
                    mix(dot, a, step(radius - 0.05, radius + 0.05, far))
                })
            }
            Self::Patches => {
                let n = 2 + chance.below(3);
                painted("patches", size, |u, v| {
                    let one = tile_fractal(u, v, n, seed);
                    let other = tile_fractal(u, v, n + 1, seed ^ 1);
                    let colour = if other > 0.58 { c } else { a };
                    if one > 0.55 { b } else { colour }
                })
            }
            Self::Marks => {
                let rows = count(chance, 6, 7);
                painted("marks", size, |u, v| {
                    let ground = scaled(a, 0.95 + 0.07 * tile_noise(u, v, 16, seed ^ 1));
                    let heading = v < 2.0 / rows;
                    if is_ink(u, v, if heading { 0.5 * rows } else { rows }, seed) {
                        if heading { c } else { b }
                    } else {
                        ground
                    }
                })
            }
            Self::Wood => {
                let (planks, rings) = (1 + chance.below(3), count(chance, 3, 4));
                painted("wood", size, |u, v| {
                    let plank = (u * planks as f32) as u32;
                    let own = seed ^ u64::from(plank) << 7;
                    let warp = tile_fractal(u, v, 3, own);
                    let ring = (u * rings + warp * 2.5).fract();
                    let ring = step(0.0, 0.7, ring) * (1.0 - step(0.85, 1.0, ring));
                    let fibre = tile_noise_of([u, v], [64, 6], own ^ 1);
                    let seam = planks > 1 && (u * planks as f32).fract() < 0.03;
                    let tone = mix(a, scaled(a, 0.6), 0.6 * ring + 0.3 * fibre);
                    if seam { scaled(a, 0.35) } else { tone }
                })
            }
            Self::Stone => {
                let veined = chance.below(2) == 0;
                painted("stone", size, |u, v| {
                    let large = tile_fractal(u, v, 3, seed);
                    let grain = tile_noise(u, v, 56, seed ^ 2);
                    let vein = (tile_fractal(u, v, 4, seed ^ 3) - 0.5).abs();
                    let colour = scaled(a, 0.6 + 0.45 * large + 0.25 * grain);
                    if veined { mix(c, colour, step(0.0, 0.035, vein)) } else { colour }
                })
            }
            Self::Weave => {
                let n = 4.0 * count(chance, 3, 4);
                painted("weave", size, |u, v| {
                    let (x, y) = ((u * n).fract() - 0.5, (v * n).fract() - 0.5);
                    let over = ((u * n) as i32 + (v * n) as i32) & 1 == 0;
                    let (colour, edge) = if over { (a, y) } else { (b, x) };
                    scaled(colour, 1.05 - 0.9 * edge * edge)
                })
            }
            Self::Scuffed => {
                let wear = chance.between(0.5, 0.62);
                painted("scuffed", size, |u, v| {
                    let worn = tile_fractal(u, v, 5, seed);
                    let dirt = tile_fractal(u, v, 3, seed ^ 1);
                    scaled(mix(a, b, step(wear, wear + 0.05, worn)), 0.75 + 0.4 * dirt)
                })
            }
            Self::Gradient => {
                let lines = count(chance, 1, 2);
                painted("gradient", size, |_, v| mix(a, b, 0.5 - 0.5 * sin(v * lines * TURN)))
            }
        }
    }
}

/// Whether a text of that many lines has ink at (u, v): letters of 3 by 5 dots, words, short lines.
pub(super) fn is_ink(u: f32, v: f32, lines: f32, seed: u64) -> bool {
    let columns = (lines * 1.5).floor().max(2.0);
    let (line, column) = ((v * lines) as u64, (u * columns) as u64);
    let mut letter = Chance::new(seed ^ line << 20 ^ column << 40);
    let bits = letter.bits();
    let end = Chance::new(seed ^ line << 8).between(0.55, 1.0);
    let (x, y) = ((u * columns).fract() * 4.0, (v * lines).fract() * 7.0);
    let is_letter = bits >> 60 != 0 && u < end && x < 3.0 && y < 5.0;
    is_letter && bits >> (x as u64 + 3 * y as u64) & 1 == 1
}

/// Value noise on a grid of `cells` by `cells` that repeats at 0 and 1, in [0, 1].
pub(super) fn tile_noise(u: f32, v: f32, cells: u32, seed: u64) -> f32 {
    tile_noise_of([u, v], [cells, cells], seed)
}

fn tile_noise_of(at: [f32; 2], cells: [u32; 2], seed: u64) -> f32 {
    let place: [(u32, f32); 2] = std::array::from_fn(|i| {
        let x = (at[i] - at[i].floor()) * cells[i] as f32;
        let t = x.fract();
        (x as u32, t * t * (3.0 - 2.0 * t))
    });
    let [(i, s), (j, t)] = place;
    let corner = |di: u32, dj: u32| {
        let (x, y) = ((i + di) % cells[0], (j + dj) % cells[1]);
        Chance::new(seed ^ u64::from(x) << 32 ^ u64::from(y)).unit()
    };
    let low = corner(0, 0) * (1.0 - s) + corner(1, 0) * s;
    let high = corner(0, 1) * (1.0 - s) + corner(1, 1) * s;
    low * (1.0 - t) + high * t
}

/// [`tile_noise`] with finer detail, in [0, 1].
pub(super) fn tile_fractal(u: f32, v: f32, cells: u32, seed: u64) -> f32 {
    let octave = |k: u32| tile_noise(u, v, cells << k, seed.wrapping_add(u64::from(k)));
    (octave(0) * 4.0 + octave(1) * 2.0 + octave(2)) / 7.0
}

/// A picture for a globe's (u, v), from a function of the direction.
pub(super) fn all_around(size: u32, colour: impl Fn(vantage_core::Vec3) -> Rgb) -> Material {
    let mut material = painted("globe", size, |u, v| colour(crate::mesh::shapes::on_globe(u, v)));
    if let Some(Texture { wrap, .. }) = &mut material.texture {
        wrap[1] = crate::mesh::Wrap::Clamp;
    }
    material
}
