//! Where there is something: a coarse grid that spares the samples of empty space.

use vantage_core::Vec3;

use crate::field::Field;
use crate::volume::optical_depth;

/// Cells along each side of the cube around the unit sphere.
const SIDE: usize = 48;

/// A cell counts as empty where a step through it would hide less than this share of what is behind.
const LEAST_ALPHA: f32 = 2e-3;

/// Which cells are not empty.
#[derive(Clone, Debug)]
pub struct Occupancy {
    open: Vec<bool>, // (SIDE, SIDE, SIDE), z first
}

impl Occupancy {
    /// Nothing is known to be empty.
    pub fn full() -> Self {
        Self { open: vec![true; SIDE * SIDE * SIDE] }
    }

    /// Looks at a field at the middle of every cell; neighbours of cells that hold something stay
    /// open too, so that what is there can grow.
    pub fn of(field: &mut dyn Field, step: f32) -> Self {
        let middle = |cell: usize| (cell as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
        let mut open = vec![false; SIDE * SIDE * SIDE];
        for z in 0..SIDE {
            let place = |i: usize| Vec3::new(middle(i % SIDE), middle(i / SIDE), middle(z));
            let points: Vec<Vec3> = (0..SIDE * SIDE).map(place).collect();
            for (i, raw) in field.density(&points).into_iter().enumerate() {
                if 1.0 - (-optical_depth(raw, step)).exp() < LEAST_ALPHA {
                    continue;
                }
                let around = |at: usize| at.saturating_sub(1)..=(at + 1).min(SIDE - 1);
                for near_z in around(z) {
                    for near_y in around(i / SIDE) {
                        for near_x in around(i % SIDE) {
                            open[(near_z * SIDE + near_y) * SIDE + near_x] = true;
                        }
                    }
                }
            }
        }
        Self { open }
    }

    /// Whether a sample there is worth taking.
    #[inline]
    pub fn is_open(&self, point: Vec3) -> bool {
        let cell = |at: f32| (((at + 1.0) * 0.5 * SIDE as f32) as usize).min(SIDE - 1);
        self.open[(cell(point.z) * SIDE + cell(point.y)) * SIDE + cell(point.x)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxels::{Config, Voxels};

    #[test]
    fn fog_is_open_and_what_is_thinner_is_not() {
        let config = Config {
            nodes: vec![2],
            degree: 0,
            density_rate: 20.0,
            colour_rate: 0.0,
            density_smoothness: 0.0,
            colour_smoothness: 0.0,
        };
        let mut field = Voxels::new(config);
        assert!(Occupancy::of(&mut field, 0.02).open.iter().all(|&open| open));
        // Adam's first step is as long as the rate: the four lower nodes become empty.
        let lower = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
        field.density(&lower.map(|[x, y]| Vec3::new(x, y, -1.0)));
        field.accumulate(&[1.0; 4], &[]);
        field.advance(1.0);
        let occupancy = Occupancy::of(&mut field, 0.02);
        assert!(occupancy.is_open(Vec3::new(0.3, -0.4, 0.95)));
        assert!(!occupancy.is_open(Vec3::new(0.3, -0.4, -0.95)));
    }
}
