//! Real spherical harmonics up to degree 2: how a colour may change with the direction of view.
//!
//! Constants and order as in Plenoxels (Fridovich-Keil et al., 2022) and PlenOctrees.

use vantage_core::Vec3;

/// Harmonics of the highest degree that is known.
pub const MOST: usize = 9;

/// How many there are up to a degree.
pub const fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 1)
}

/// The first `K` harmonics at a unit direction, `K` being 1, 4 or 9.
#[inline]
pub fn basis<const K: usize>(direction: Vec3) -> [f32; K] {
    let Vec3 { x, y, z } = direction;
    let all: [f32; MOST] = [
        0.282_094_8,
        -0.488_602_5 * y,
        0.488_602_5 * z,
        -0.488_602_5 * x,
        1.092_548_4 * x * y,
        -1.092_548_4 * y * z,
        0.315_391_57 * (2.0 * z * z - x * x - y * y),
        -1.092_548_4 * x * z,
        0.546_274_2 * (x * x - y * y),
    ];
    std::array::from_fn(|k| all[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_are_orthonormal_on_the_sphere() {
        // The golden-angle lattice integrates low degrees to about 1e-4.
        let n = 4000;
        let mut products = [[0.0f64; MOST]; MOST];
        for i in 0..n {
            let z = 1.0 - (2 * i + 1) as f32 / n as f32;
            let turn = i as f32 * 2.399_963_2;
            let flat = (1.0 - z * z).sqrt();
            let y = basis::<MOST>(Vec3::new(flat * turn.cos(), flat * turn.sin(), z));
            for (a, row) in products.iter_mut().enumerate() {
                for (b, product) in row.iter_mut().enumerate() {
                    *product += f64::from(y[a] * y[b]) * 4.0 * std::f64::consts::PI / f64::from(n);
                }
            }
        }
        for (a, row) in products.iter().enumerate() {
            for (b, product) in row.iter().enumerate() {
                let expected = if a == b { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 2e-3, "{a} {b} {product}");
            }
        }
    }
}
