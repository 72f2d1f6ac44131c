//! Chance, noise, colours and painted textures: plain arithmetic, so that a seed means one object.

use std::sync::Arc;

use image::{Rgba, RgbaImage};
use vantage_core::Vec3;

use crate::mesh::{Material, Texture, Wrap};

/// SplitMix64 (Steele, Lea and Flood, 2014): small, and good from any seed.
pub(crate) struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed(self.0)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [low, high).
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// In 0..count.
    pub fn below(&mut self, count: u32) -> u32 {
        (((self.bits() >> 32) * u64::from(count)) >> 32) as u32
    }
}

fn mixed(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Value noise in [0, 1], smooth, with one value for each point of the integer grid.
pub(super) fn noise(p: Vec3, seed: u64) -> f32 {
    let floor = p.floor();
    let t = p - floor;
    let t = t * t * (3.0 - 2.0 * t);
    let cell = [floor.x as i32, floor.y as i32, floor.z as i32];
    let corner = |dx: i32, dy: i32, dz: i32| {
        let [x, y, z] = [cell[0] + dx, cell[1] + dy, cell[2] + dz].map(|v| u64::from(v as u32));
        let word = mixed(mixed(mixed(seed ^ x) ^ y) ^ z);
        (word >> 40) as f32 / (1u64 << 24) as f32
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |dy, dz| mix(corner(0, dy, dz), corner(1, dy, dz), t.x);
    let along_y = |dz| mix(along_x(0, dz), along_x(1, dz), t.y);
    mix(along_y(0), along_y(1), t.z)
}

/// Noise with finer detail, `octaves` times half as large and half as strong, in [0, 1].
pub(super) fn fractal(p: Vec3, octaves: u32, seed: u64) -> f32 {
    let (mut sum, mut total, mut weight, mut scale) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..octaves {
        sum += weight * noise(p * scale, seed.wrapping_add(u64::from(octave)));
        total += weight;
        weight *= 0.5;
        scale *= 2.03;
    }
    sum / total
}

/// sRGB colour of a hue (in turns, any number), saturation and value in [0, 1].
pub(super) fn hsv(hue: f32, saturation: f32, value: f32) -> [f32; 3] {
    [5.0f32, 3.0, 1.0].map(|offset| {
        let k = (offset + (hue - hue.floor()) * 6.0) % 6.0;
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

/// Between two colours.
pub(super) fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t.clamp(0.0, 1.0))
}

/// A colour made darker or lighter.
pub(super) fn scaled(a: [f32; 3], factor: f32) -> [f32; 3] {
    a.map(|c| (c * factor).clamp(0.0, 1.0))
}

/// 0 below `low`, 1 above `high`, smooth between.
pub(super) fn step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A square material painted by a function of (u, v), v downwards, that gives sRGB in [0, 1].
pub(super) fn painted(name: &str, size: u32, colour: impl Fn(f32, f32) -> [f32; 3]) -> Material {
    let image = RgbaImage::from_fn(size, size, |x, y| {
        let at = |i: u32| (i as f32 + 0.5) / size as f32;
        let [r, g, b] = colour(at(x), at(y)).map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
        Rgba([r, g, b, 255])
    });
    let texture = Texture { image: Arc::new(image), wrap: [Wrap::Repeat; 2] };
    Material { texture: Some(texture), ..Material::plain(name, [1.0; 3]) }
}

/// Planed wood: year rings along v, fibres, and a few knots.
pub(super) fn wood(name: &str, tone: [f32; 3], seed: u64) -> Material {
    painted(name, 256, |u, v| {
        let warp = fractal(Vec3::new(u * 3.0, v * 1.2, 0.0), 3, seed);
        let rings = ((u * 5.0 + warp * 3.0) * 4.0) % 1.0;
        let ring = step(0.0, 0.7, rings) * (1.0 - step(0.85, 1.0, rings));
        let fibre = noise(Vec3::new(u * 110.0, v * 9.0, 5.0), seed ^ 1);
        let patch = fractal(Vec3::new(u * 2.0, v * 2.0, 9.0), 3, seed ^ 2);
        let [r, g, b] =
            scaled(tone, 0.80 + 0.16 * ring + 0.14 * (fibre - 0.5) + 0.22 * (patch - 0.3));
        [r, g * (0.94 + 0.1 * patch), b * (0.82 + 0.3 * ring)]
    })
}
