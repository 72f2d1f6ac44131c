//! Photos as a webcam might have taken them: other backgrounds, exposures, hues, framings; blurred
//! and noisy. What a capture has in common (light, room, lens) is drawn once for it, the rest for
//! each photo.

use rand::{Rng, RngExt};

use vantage_core::soarnet::{COVER, DETAIL, SKETCH};

use crate::net::SIDE;

/// Values of a photo as the network takes it: (3, 64, 64).
pub const PHOTO: usize = 3 * SIDE * SIDE;

/// Behind the object.
#[derive(Clone, Debug)]
enum Background {
    /// The grey that is 0 to the network.
    Neutral,
    /// One colour.
    Plain([f32; 3]),
    /// From one colour above to another below.
    Gradient([f32; 3], [f32; 3]),
    /// Blocks of colour around a mean: a cluttered room out of focus.
    Clutter([f32; 3], f32),
}

/// What the photos of one capture have in common.
#[derive(Clone, Debug)]
pub struct Look {
    background: Background,
    exposure: f32,
    gamma: f32,
    saturation: f32,
    hue: [[f32; 3]; 3],
    scale: f32,
    shift: f32,
    blur: f32,
    noise: f32,
    mirrored: bool,
}

impl Look {
    /// The photo as it is, before neutral grey.
    pub fn plain() -> Self {
        Self {
            background: Background::Neutral,
            exposure: 1.0,
            gamma: 1.0,
            saturation: 1.0,
            hue: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            scale: 1.0,
            shift: 0.0,
            blur: 0.0,
            noise: 0.0,
            mirrored: false,
        }
    }

    /// A look by chance; a third of all have the object before neutral grey, its light unchanged.
    pub fn draw(chance: &mut impl Rng, mirrored: bool) -> Self {
        if chance.random_bool(0.3) {
            return Self { mirrored, ..Self::plain() };
        }
        let background = match chance.random_range(0..10) {
            0..2 => Background::Neutral,
            2..5 => Background::Plain(chance.random()),
            5..7 => Background::Gradient(chance.random(), chance.random()),
            _ => Background::Clutter(chance.random(), chance.random_range(0.05..0.4)),
        };
        let hue_rad = if chance.random_bool(0.5) { chance.random_range(-3.0..3.0f32) } else { 0.0 };
        let framed = chance.random_bool(0.6);
        Self {
            background,
            exposure: chance.random_range(-0.5..0.5f32).exp2(),
            gamma: chance.random_range(-0.4..0.4f32).exp2(),
            saturation: chance.random_range(0.4..1.4),
            hue: turn_about_grey(hue_rad),
            scale: if framed { chance.random_range(-0.35..0.25f32).exp2() } else { 1.0 },
            shift: if framed { 4.0 } else { 0.0 },
            blur: if chance.random_bool(0.4) { chance.random_range(0.0..0.25) } else { 0.0 },
            noise: if chance.random_bool(0.5) { chance.random_range(0.0..0.06) } else { 0.0 },
            mirrored,
        }
    }

    /// A photo, sRGB with straight alpha, shape (64, 64, 4), as this look shows it: shape
    /// (3, 64, 64), each value (pixel - 128) / 128, in steps of a whole pixel value.
    ///
    /// `sketch`, of [`SKETCH`] zeros or empty, becomes what the network should see in it: the share of
    /// each cell that the object covers, and how much its colours change there.
    pub fn photo(&self, rgba: &[u8], chance: &mut impl Rng, out: &mut [f32], sketch: &mut [f32]) {
        debug_assert!(sketch.is_empty() || sketch.len() == SKETCH);
        let mut covers = vec![0f32; SIDE * SIDE];
        let mut picture = vec![[0f32; 3]; SIDE * SIDE];
        let behind = self.behind(chance);
        let mut jitter =
            |width: f32| if width > 0.0 { chance.random_range(-width..width) } else { 0.0 };
        let scale = self.scale * jitter(if self.shift > 0.0 { 0.06 } else { 0.0 }).exp2();
        let (right, down) = (jitter(self.shift), jitter(self.shift));
        let exposure = self.exposure * jitter(if self.exposure == 1.0 { 0.0 } else { 0.1 }).exp2();
        let half = 0.5 * SIDE as f32;
        for (place, pixel) in picture.iter_mut().enumerate() {
            let (x, y) = ((place % SIDE) as f32 + 0.5, (place / SIDE) as f32 + 0.5);
            let x = if self.mirrored { SIDE as f32 - x } else { x };
            let from = [(x - half) / scale + half + right, (y - half) / scale + half + down];
            let ([r, g, b], alpha) = sample(rgba, from);
            covers[place] = alpha;
            let back = behind(x, y);
            let lit = self.lit([r, g, b], exposure);
            for ((pixel, colour), back) in pixel.iter_mut().zip(lit).zip(back) {
                *pixel = colour * alpha + back * (1.0 - alpha);
            }
        }
        if self.blur > 0.0 {
            picture = blurred(&picture, self.blur);
        }
        if !sketch.is_empty() {
            draw_sketch(&picture, &covers, sketch);
        }
        for (place, pixel) in picture.iter().enumerate() {
            for (channel, &value) in pixel.iter().enumerate() {
                let noise = if self.noise > 0.0 {
                    // The sum of two even draws: bounded, and near enough to a sensor's.
                    self.noise * (chance.random::<f32>() + chance.random::<f32>() - 1.0) * 1.7
                } else {
                    0.0
                };
                let byte = ((value + noise) * 255.0).round().clamp(0.0, 255.0);
                out[channel * SIDE * SIDE + place] = (byte - 128.0) / 128.0;
            }
        }
    }

    fn lit(&self, colour: [f32; 3], exposure: f32) -> [f32; 3] {
        let turned = self.hue.map(|row| row.iter().zip(colour).map(|(m, c)| m * c).sum::<f32>());
        let grey = turned.iter().sum::<f32>() / 3.0;
        turned.map(|c| {
            let c = (grey + self.saturation * (c - grey)).clamp(0.0, 1.0);
            let c = if self.gamma == 1.0 { c } else { c.powf(self.gamma) };
            (c * exposure).clamp(0.0, 1.0)
        })
    }

    /// The background's colour at a pixel.
    fn behind(&self, chance: &mut impl Rng) -> Box<dyn Fn(f32, f32) -> [f32; 3]> {
        const BLOCKS: usize = 6;
        match self.background.clone() {
            Background::Neutral => Box::new(|_, _| [128.0 / 255.0; 3]),
            Background::Plain(colour) => Box::new(move |_, _| colour),
            Background::Gradient(above, below) => Box::new(move |_, y| {
                let share = y / SIDE as f32;
                [0, 1, 2].map(|c: usize| above[c] * (1.0 - share) + below[c] * share)
            }),
            Background::Clutter(mean, width) => {
                let blocks: Vec<[f32; 3]> = (0..(BLOCKS + 1) * (BLOCKS + 1))
                    .map(|_| mean.map(|m| (m + chance.random_range(-width..width)).clamp(0.0, 1.0)))
                    .collect();
                Box::new(move |x, y| {
                    let place = |at: f32| at / SIDE as f32 * BLOCKS as f32;
                    let (u, v) = (place(x), place(y));
                    let (i, j) = ((u as usize).min(BLOCKS - 1), (v as usize).min(BLOCKS - 1));
                    let (u, v) = (u - i as f32, v - j as f32);
                    let at = |i: usize, j: usize| blocks[j * (BLOCKS + 1) + i];
                    [0, 1, 2].map(|c: usize| {
                        let above = at(i, j)[c] * (1.0 - u) + at(i + 1, j)[c] * u;
                        let below = at(i, j + 1)[c] * (1.0 - u) + at(i + 1, j + 1)[c] * u;
                        above * (1.0 - v) + below * v
                    })
                })
            }
        }
    }
}

/// A change of colour from a pixel to its neighbours, summed over channels, that counts as full.
const FULL_CHANGE: f32 = 0.5;

fn draw_sketch(picture: &[[f32; 3]], covers: &[f32], sketch: &mut [f32]) {
    let cell = |place: usize, cells: usize| {
        let (x, y) = (place % SIDE, place / SIDE);
        y * cells / SIDE * cells + x * cells / SIDE
    };
    let share = |cells: usize| (cells * cells) as f32 / (SIDE * SIDE) as f32;
    let (cover, detail) = sketch.split_at_mut(COVER * COVER);
    for (place, &alpha) in covers.iter().enumerate() {
        cover[cell(place, COVER)] += alpha * share(COVER);
        let inside = place % SIDE + 1 < SIDE && place + SIDE < covers.len();
        if inside && alpha.min(covers[place + 1]).min(covers[place + SIDE]) > 0.9 {
            let change = |other: usize| -> f32 {
                picture[place].iter().zip(picture[other]).map(|(a, b)| (a - b).abs()).sum()
            };
            let both = change(place + 1) + change(place + SIDE);
            detail[cell(place, DETAIL)] += (both / FULL_CHANGE).min(1.0) * share(DETAIL);
        }
    }
}

/// The rotation of colours about the grey axis.
fn turn_about_grey(angle_rad: f32) -> [[f32; 3]; 3] {
    let (sin, cos) = angle_rad.sin_cos();
    let (same, rest) = ((1.0 + 2.0 * cos) / 3.0, (1.0 - cos) / 3.0);
    let aside = sin / 3f32.sqrt();
    let (a, b) = (rest - aside, rest + aside);
    [[same, a, b], [b, same, a], [a, b, same]]
}

/// Colour, weighted by what covers it, and cover at a place in pixels, linear between pixels;
/// nothing beyond the border.
fn sample(rgba: &[u8], [x, y]: [f32; 2]) -> ([f32; 3], f32) {
    let (x, y) = (x - 0.5, y - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (u, v) = (x - left, y - top);
    let (mut colour, mut cover) = ([0f32; 3], 0f32);
    for (dx, dy, share) in
        [(0, 0, (1.0 - u) * (1.0 - v)), (1, 0, u * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 1, u * v)]
    {
        let (x, y) = (left as i32 + dx, top as i32 + dy);
        let inside = |at: i32| (0..SIDE as i32).contains(&at);
        if share > 0.0 && inside(x) && inside(y) {
            let at = 4 * (y as usize * SIDE + x as usize);
            let alpha = share * f32::from(rgba[at + 3]) / 255.0;
            cover += alpha;
            for (sum, &byte) in colour.iter_mut().zip(&rgba[at..at + 3]) {
                *sum += alpha * f32::from(byte) / 255.0;
            }
        }
    }
    (if cover > 0.0 { colour.map(|c| c / cover) } else { colour }, cover)
}

/// Each pixel less a share that goes to either neighbour, along rows and then columns.
fn blurred(picture: &[[f32; 3]], share: f32) -> Vec<[f32; 3]> {
    let pass = |picture: &[[f32; 3]], step: usize, place: fn(usize) -> usize| -> Vec<[f32; 3]> {
        (0..picture.len())
            .map(|at| {
                let before = if place(at) > 0 { at - step } else { at };
                let after = if place(at) + 1 < SIDE { at + step } else { at };
                [0, 1, 2].map(|c: usize| {
                    picture[at][c] * (1.0 - 2.0 * share)
                        + share * (picture[before][c] + picture[after][c])
                })
            })
            .collect()
    };
    pass(&pass(picture, 1, |at| at % SIDE), SIDE, |at| at / SIDE)
}
