//! A texture at all its sizes, and its colour at a place.

use image::RgbaImage;
use vantage_core::Vec2;

use super::srgb::{encode, linear};
use crate::mesh::{Texture, Wrap};

/// The picture and its halves, quarters … down to one pixel.
pub(super) struct Pyramid {
    levels: Vec<Level>,
    wrap: [Wrap; 2],
}

struct Level {
    width: i32,
    height: i32,
    pixels: Vec<[u8; 4]>, // (height, width), sRGB and alpha
}

impl Pyramid {
    pub fn new(texture: &Texture) -> Self {
        let mut levels = vec![Level::of(&texture.image)];
        while let Some(half) = levels.last().and_then(Level::halved) {
            levels.push(half);
        }
        Self { levels, wrap: texture.wrap }
    }

    /// Pixels of the largest level.
    pub fn pixels(&self) -> f32 {
        self.levels.first().map_or(0.0, |level| level.width as f32 * level.height as f32)
    }

    /// The level where a sample is about one pixel wide, from its width in pixels of the largest.
    pub fn level_for(&self, pixels_per_sample: f32) -> usize {
        let (mut level, mut width) = (0, pixels_per_sample);
        // Nearest on a logarithmic scale; a NaN stays at the largest.
        while width > std::f32::consts::SQRT_2 && level + 1 < self.levels.len() {
            width *= 0.5;
            level += 1;
        }
        level
    }

    /// Bilinear colour in linear light at a UV.
    #[inline]
    pub fn light(&self, level: usize, uv: Vec2) -> [f32; 3] {
        let level = &self.levels[level];
        let (x, right) = split(uv.x, level.width, self.wrap[0]);
        let (y, down) = split(uv.y, level.height, self.wrap[1]);
        let (x0, x1) =
            (wrapped(x, level.width, self.wrap[0]), wrapped(x + 1, level.width, self.wrap[0]));
        let (y0, y1) =
            (wrapped(y, level.height, self.wrap[1]), wrapped(y + 1, level.height, self.wrap[1]));
        let pixel = |x: i32, y: i32| level.pixels[(y * level.width + x) as usize];
        let (a, b, c, d) = (pixel(x0, y0), pixel(x1, y0), pixel(x0, y1), pixel(x1, y1));
        let weights = [
            (1.0 - right) * (1.0 - down),
            right * (1.0 - down),
            (1.0 - right) * down,
            right * down,
        ];
        std::array::from_fn(|i| {
            linear(a[i]) * weights[0]
                + linear(b[i]) * weights[1]
                + linear(c[i]) * weights[2]
                + linear(d[i]) * weights[3]
        })
    }

    /// Alpha in [0, 1] of the nearest pixel of the largest level.
    pub fn alpha(&self, uv: Vec2) -> f32 {
        let level = &self.levels[0];
        let (x, right) = split(uv.x, level.width, self.wrap[0]);
        let (y, down) = split(uv.y, level.height, self.wrap[1]);
        let x = wrapped(x + i32::from(right >= 0.5), level.width, self.wrap[0]);
        let y = wrapped(y + i32::from(down >= 0.5), level.height, self.wrap[1]);
        f32::from(level.pixels[(y * level.width + x) as usize][3]) / 255.0
    }
}

impl Level {
    fn of(image: &RgbaImage) -> Self {
        Self {
            width: image.width() as i32,
            height: image.height() as i32,
            pixels: image.pixels().map(|pixel| pixel.0).collect(),
        }
    }

    /// Half the size, rounded down; each pixel the mean of those it replaces, in linear light.
    fn halved(&self) -> Option<Self> {
        if self.width <= 1 && self.height <= 1 {
            return None;
        }
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        // An odd side has three pixels for its last one.
        let range = |i: i32, new: i32, old: i32| {
            let last = if i == new - 1 { old - 1 } else { i * 2 + 1 };
            (i * 2).min(old - 1)..=last
        };
        let mut pixels = Vec::with_capacity((width * height) as usize);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut alpha, mut count) = ([0.0; 3], 0u32, 0u32);
                for row in range(y, height, self.height) {
                    for column in range(x, width, self.width) {
                        let pixel = self.pixels[(row * self.width + column) as usize];
                        for (total, &byte) in sum.iter_mut().zip(&pixel[..3]) {
                            *total += linear(byte);
                        }
                        alpha += u32::from(pixel[3]);
                        count += 1;
                    }
                }
                let [r, g, b] = sum.map(|total| encode(total / count as f32));
                pixels.push([r, g, b, (alpha / count) as u8]);
            }
        }
        Some(Self { width, height, pixels })
    }
}

/// The pixel to the left of (or above) a coordinate, and how far beyond its centre it lies.
#[inline]
fn split(coordinate: f32, size: i32, wrap: Wrap) -> (i32, f32) {
    // Whole turns go first, so that the fraction keeps its digits.
    let coordinate = match wrap {
        Wrap::Repeat => coordinate - floor(coordinate) as f32,
        Wrap::Mirror => coordinate - 2.0 * floor(coordinate * 0.5) as f32,
        Wrap::Clamp => coordinate,
    };
    // Beyond what `floor` can count, turns remain; nothing sensible is lost.
    let position = coordinate.clamp(-1.0, 2.0) * size as f32 - 0.5;
    let whole = floor(position);
    (whole, position - whole as f32)
}

/// A call-free floor; saturates.
#[inline]
fn floor(x: f32) -> i32 {
    let whole = x as i32;
    whole.saturating_sub(i32::from(x < whole as f32))
}

/// A pixel's index, in range, of any index; fast where it is in range already.
#[inline]
fn wrapped(index: i32, size: i32, wrap: Wrap) -> i32 {
    if (0..size).contains(&index) {
        return index;
    }
    match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::Mirror => {
            let turn = index.rem_euclid(2 * size);
            turn.min(2 * size - 1 - turn)
        }
        Wrap::Clamp => index.clamp(0, size - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;
    use std::sync::Arc;

    /// Four grey pixels in a row: 0, 80, 160, 240.
    fn row(wrap: Wrap) -> Pyramid {
        let image = RgbaImage::from_fn(4, 1, |x, _| Rgba([x as u8 * 80, 0, 0, x as u8 * 85]));
        Pyramid::new(&Texture { image: Arc::new(image), wrap: [wrap; 2] })
    }

    fn red(pyramid: &Pyramid, u: f32) -> u8 {
        encode(pyramid.light(0, Vec2::new(u, 0.5))[0])
    }

    #[test]
    fn pixel_centres_are_exact_and_wrap_as_told() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            assert_eq!([0.125, 0.375, 0.625, 0.875].map(|u| red(&row(wrap), u)), [0, 80, 160, 240]);
        }
        assert_eq!([-0.125, 1.125, 9.375].map(|u| red(&row(Wrap::Repeat), u)), [240, 0, 80]);
        assert_eq!([-0.125, 1.125, 2.125].map(|u| red(&row(Wrap::Mirror), u)), [0, 240, 0]);
        assert_eq!([-0.5, 1.5, 7.0].map(|u| red(&row(Wrap::Clamp), u)), [0, 240, 240]);
    }

    #[test]
    fn impossible_coordinates_give_some_pixel() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for u in [f32::NAN, f32::INFINITY, f32::MIN, 3e9, -7e8] {
                let uv = Vec2::new(u, -u);
                let pyramid = row(wrap);
                assert!(pyramid.alpha(uv) <= 1.0);
                pyramid.light(1, uv);
            }
        }
    }

    #[test]
    fn smaller_levels_keep_the_mean_light() {
        let image = RgbaImage::from_fn(5, 3, |x, y| Rgba([((x + y) % 2 * 255) as u8, 9, 9, 255]));
        let pyramid = Pyramid::new(&Texture { image: Arc::new(image), wrap: [Wrap::Repeat; 2] });
        assert_eq!(pyramid.levels.len(), 3);
        let light = pyramid.light(2, Vec2::ZERO);
        assert!((light[0] - 0.5).abs() < 0.06, "{light:?}");
        assert_eq!(pyramid.level_for(4.0), 2);
        assert_eq!(pyramid.level_for(1.0), 0);
    }
}
