//! A vertex on the picture: whole sub-sample positions, and its inverse depth.

/// Sub-sample positions along each axis.
pub(super) const STEPS: i32 = 1 << STEP_BITS;
pub(super) const STEP_BITS: u32 = 8;

/// Coordinates beyond this many steps from the picture's middle are clipped. Edge functions of
/// what remains are below 2^48.
pub(super) const FAR_ASIDE: f32 = ((1 << 22) - 64) as f32;

/// A vertex on the picture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Projected {
    /// From the picture's middle, in steps.
    pub x: i32,
    pub y: i32,
    /// Inverse depth; 0 marks a vertex that has to be clipped.
    pub w: f32,
}

/// The nearest integer, halves to even, of a number below 2^22 in size; anything for others.
///
/// Adding 1.5 · 2^23 leaves the integer in the low bits of the mantissa: two instructions, where
/// `round` is a call on processors without SSE 4.1.
#[inline]
pub(super) fn rounded(x: f32) -> i32 {
    const MAGIC: f32 = 12_582_912.0;
    ((x + MAGIC).to_bits() as i32).wrapping_sub(MAGIC.to_bits() as i32)
}

/// What a clipped vertex, given in double precision, becomes.
pub(super) fn projected(x: f64, y: f64, depth: f64) -> Projected {
    let steps = |v: f64| rounded(((v * f64::from(STEPS)) as f32).clamp(-FAR_ASIDE, FAR_ASIDE));
    Projected { x: steps(x), y: steps(y), w: (1.0 / depth) as f32 }
}
