//! The float functions on a sweep of arguments.

use core::f32::consts::{E, FRAC_PI_2, PI};
use core::fmt::{self, Write};

use vantage_core::{Vec3, math};

use crate::line;

/// Arguments with something to get wrong: zeros, the edges of reduction, subnormals, infinities.
const ARGUMENTS: [f32; 16] = [
    0.0,
    -0.0,
    1e-40, // subnormal
    f32::MIN_POSITIVE,
    1e-4,
    0.1,
    0.5,
    1.0,
    FRAC_PI_2,
    E,
    PI,
    10.0,
    88.5, // just below where exp overflows
    1e6,  // far out in the reduction of sine and cosine
    f32::MAX,
    f32::INFINITY,
];

/// Every function of one argument on every argument and its negative; then angles between vectors.
pub fn functions(out: &mut dyn Write) -> fmt::Result {
    line(out, format_args!("# x sin cos tan asin acos exp sqrt cbrt"), &[])?;
    for magnitude in ARGUMENTS {
        for x in [magnitude, -magnitude] {
            let values = [
                math::sin(x),
                math::cos(x),
                math::tan(x),
                math::asin(x),
                math::acos(x),
                math::exp(x),
                math::sqrt(x),
                math::cbrt(x.abs()),
            ];
            line(out, format_args!("{:08x}", x.to_bits()), &values)?;
        }
    }
    for step in 0..8 {
        let turn = 0.4 * step as f32;
        let other = Vec3::new(math::cos(turn), math::sin(turn), 0.3 * turn);
        let angle = math::angle_between(Vec3::new(1.0, 0.2, -0.1), other);
        line(out, format_args!("angle {step}"), &[angle])?;
    }
    Ok(())
}
