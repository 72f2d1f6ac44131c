//! Tables of the sRGB transfer function for pixels.

use std::sync::LazyLock;

use crate::mesh::colour::{linear_from_srgb, srgb_from_linear};

static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// Steps of linear light: where the curve is steepest one step is 0.4 of a level.
const STEPS: usize = 8192;

static ENCODED: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let level = |i: usize| srgb_from_linear(i as f32 / STEPS as f32) * 255.0 + 0.5;
    (0..=STEPS).map(|i| level(i) as u8).collect()
});

/// Linear light of an sRGB level.
#[inline]
pub(crate) fn linear(byte: u8) -> f32 {
    LINEAR[usize::from(byte)]
}

/// The sRGB level of linear light, at most one beside the nearest; NaN and less than 0 give 0.
#[inline]
pub(crate) fn encode(light: f32) -> u8 {
    let step = (light * STEPS as f32 + 0.5) as usize; // saturates
    ENCODED[step.min(STEPS)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_survives() {
        for byte in 0..=255 {
            assert_eq!(encode(linear(byte)), byte);
        }
        assert_eq!((encode(f32::NAN), encode(-1.0), encode(9.0)), (0, 0, 255));
    }
}
