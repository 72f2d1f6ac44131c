//! The float functions that `no_std` lacks, each with its error bound.
//!
//! Everything goes through `libm` or through plain IEEE operations in a fixed order, never through
//! the platform's own mathematics library, so that x86-64, wasm32 and thumbv7em give the same bits.
//! `sqrt` is correctly rounded; the other `libm` functions are within 1 ulp (their documented bound).

use glam::Vec3;

/// Square root; correctly rounded.
#[inline]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// The largest whole number not above `x`.
#[inline]
pub fn floor(x: f32) -> f32 {
    libm::floorf(x)
}

/// Sine of an angle in radians.
#[inline]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of an angle in radians.
#[inline]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Tangent of an angle in radians.
#[inline]
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}

/// Arc tangent in radians.
#[inline]
pub fn atan(x: f32) -> f32 {
    libm::atanf(x)
}

/// Arc sine in radians; the argument is clamped to [-1, 1] first, so that rounding never gives NaN.
#[inline]
pub fn asin(x: f32) -> f32 {
    libm::asinf(x.clamp(-1.0, 1.0))
}

/// Arc cosine in radians; the argument is clamped to [-1, 1] first, so that rounding never gives NaN.
#[inline]
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// `e^x`.
#[inline]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// Cube root of `x >= 0`; relative error below 3e-7, and 0 for anything below `f32::MIN_POSITIVE`.
///
/// Written without a branch and without a table so that a loop over faces vectorises: a third of
/// the exponent by integer division (relative error below 6 %), then two steps of Halley's method,
/// each of which cubes the error.
#[inline]
pub fn cbrt(x: f32) -> f32 {
    // (127 - 127/3) << 23, shifted to centre the error of the linear mantissa.
    const BIAS: u32 = 0x2a51_19f2;
    let mut y = f32::from_bits(x.to_bits() / 3 + BIAS);
    for _ in 0..2 {
        let cube = y * y * y;
        y *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    if x < f32::MIN_POSITIVE { 0.0 } else { y }
}

/// `1 / sqrt(x)` of `x >= f32::MIN_POSITIVE`, relative error below 3e-7; 0 for anything smaller.
///
/// Written like [`cbrt`], to vectorise: a guess from the exponent (error below 4 %), then three steps
/// of Newton's method, each of which squares it.
#[inline]
pub fn inverse_sqrt(x: f32) -> f32 {
    // 1.5 * (127 << 23), shifted to centre the error (Lomont, 2003).
    const BIAS: u32 = 0x5f37_5a86;
    let mut y = f32::from_bits(BIAS.wrapping_sub(x.to_bits() >> 1));
    for _ in 0..3 {
        y *= 1.5 - (0.5 * x * y) * y;
    }
    if x < f32::MIN_POSITIVE { 0.0 } else { y }
}

/// `e^x` for x in [-80, 80], relative error below 5e-6 (a rounding of x / ln 2), clamped outside.
///
/// Written like [`cbrt`], to vectorise: two to a whole power by its bits, times the series of two to
/// the rest to the sixth power.
#[inline]
pub fn exp_lanewise(x: f32) -> f32 {
    use core::f32::consts::{LN_2, LOG2_E};
    // Adding 1.5 * 2^23 leaves the nearest integer in the low bits of the mantissa.
    const MAGIC: f32 = 12_582_912.0;
    let power = x.clamp(-80.0, 80.0) * LOG2_E;
    let shifted = power + MAGIC;
    let whole = shifted.to_bits().wrapping_sub(MAGIC.to_bits());
    let t = (power - (shifted - MAGIC)) * LN_2;
    let high = 1.0 / 24.0 + t * (1.0 / 120.0 + t * (1.0 / 720.0));
    let rest = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * high)));
    f32::from_bits(whole.wrapping_add(127) << 23) * rest
}

/// The angle between two directions in radians, in [0, pi].
///
/// Neither needs unit length. A zero vector has no direction: its angle to anything is a right one.
pub fn angle_between(a: Vec3, b: Vec3) -> f32 {
    let lengths = sqrt(a.length_squared() * b.length_squared());
    if lengths > 0.0 { acos(a.dot(b) / lengths) } else { core::f32::consts::FRAC_PI_2 }
}

/// The vector at unit length, or `None` where it is too short or not finite.
pub fn unit(v: Vec3) -> Option<Vec3> {
    let length = sqrt(v.length_squared());
    (length > 1e-12 && length.is_finite()).then(|| v / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cbrt_stays_within_its_bound() {
        let mut x = f32::MIN_POSITIVE;
        while x < 1e30 {
            let truth = f64::from(x).cbrt();
            let error = (f64::from(cbrt(x)) - truth).abs() / truth;
            assert!(error < 3e-7, "cbrt({x:e}) is off by {error:e}");
            x *= 1.000_37;
        }
    }

    #[test]
    fn inverse_sqrt_stays_within_its_bound() {
        let mut x = f32::MIN_POSITIVE;
        while x < 1e38 {
            let truth = 1.0 / f64::from(x).sqrt();
            let error = (f64::from(inverse_sqrt(x)) - truth).abs() / truth;
            assert!(error < 3e-7, "inverse_sqrt({x:e}) is off by {error:e}");
            x *= 1.000_37;
        }
        assert_eq!((inverse_sqrt(0.0), inverse_sqrt(1e-40)), (0.0, 0.0));
    }

    #[test]
    fn exp_lanewise_stays_within_its_bound() {
        let mut x = -80.0f32;
        while x <= 80.0 {
            let truth = f64::from(x).exp();
            let error = (f64::from(exp_lanewise(x)) - truth).abs() / truth;
            assert!(error < 5e-6, "exp_lanewise({x}) is off by {error:e}");
            x += 1e-3;
        }
        assert_eq!(exp_lanewise(1e9), exp_lanewise(80.0));
    }

    #[test]
    fn cbrt_of_nothing_is_nothing() {
        assert_eq!(cbrt(0.0), 0.0);
        assert_eq!(cbrt(1e-40), 0.0);
    }

    #[test]
    fn angles_of_known_directions() {
        use core::f32::consts::{FRAC_PI_2, PI};
        assert!((angle_between(Vec3::X, Vec3::Y * 4.0) - FRAC_PI_2).abs() < 3e-7);
        assert!((angle_between(Vec3::X, -Vec3::X) - PI).abs() < 3e-7);
        assert_eq!(angle_between(Vec3::X, Vec3::ZERO), FRAC_PI_2);
    }

    #[test]
    fn a_vector_without_length_has_no_direction() {
        assert_eq!(unit(Vec3::ZERO), None);
        assert_eq!(unit(Vec3::NAN), None);
        assert_eq!(unit(Vec3::Z * 3.0), Some(Vec3::Z));
    }
}
