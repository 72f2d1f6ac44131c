//! The sRGB transfer function (IEC 61966-2-1), both ways.

/// The nearest value in [0, 1]; NaN gives 0.
pub fn in_unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Linear light of an sRGB value, both in [0, 1].
pub fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        // In double precision, so that rounding to single hides the library's last bit.
        ((f64::from(value) + 0.055) / 1.055).powf(2.4) as f32
    }
}

/// The sRGB value of linear light, both in [0, 1].
pub fn srgb_from_linear(light: f32) -> f32 {
    if light <= 0.003_130_8 {
        light * 12.92
    } else {
        (1.055 * f64::from(light).powf(1.0 / 2.4) - 0.055) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_same_pixel() {
        for byte in 0..=255u8 {
            let light = linear_from_srgb(f32::from(byte) / 255.0);
            assert_eq!((srgb_from_linear(light) * 255.0).round() as u8, byte);
        }
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6);
    }
}
