//! Perspective maps between a plane and its picture.
//!
//! The direct linear transform (Hartley and Zisserman, "Multiple View Geometry", 2nd ed., algorithm
//! 4.2) with normalised coordinates. The lower right entry is 1 in these coordinates, which is
//! right wherever the points' middle lies in front of the camera.

use nalgebra::{Matrix3, Point2, SMatrix, SVector, Vector2};

/// The map that takes each first point to the second, of least algebraic error.
///
/// `None` of fewer than four pairs, or of points on one line.
pub fn fit(
    pairs: impl Iterator<Item = (Point2<f64>, Point2<f64>)> + Clone,
) -> Option<Matrix3<f64>> {
    let from = Normaliser::of(pairs.clone().map(|(from, _)| from))?;
    let to = Normaliser::of(pairs.clone().map(|(_, to)| to))?;
    let mut normal = SMatrix::<f64, 8, 8>::zeros();
    let mut right = SVector::<f64, 8>::zeros();
    let mut count = 0;
    for (a, b) in pairs {
        let (a, b) = (from.apply(a), to.apply(b));
        let u = SVector::from([a.x, a.y, 1.0, 0.0, 0.0, 0.0, -b.x * a.x, -b.x * a.y]);
        let v = SVector::from([0.0, 0.0, 0.0, a.x, a.y, 1.0, -b.y * a.x, -b.y * a.y]);
        normal += u * u.transpose() + v * v.transpose();
        right += u * b.x + v * b.y;
        count += 1;
    }
    if count < 4 {
        return None;
    }
    let h = normal.cholesky()?.solve(&right);
    let normalised = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0);
    let homography = to.inverse() * normalised * from.matrix();
    homography.iter().all(|entry| entry.is_finite()).then_some(homography)
}

/// Where a map takes a point; not finite on the horizon.
pub fn apply(homography: &Matrix3<f64>, point: Point2<f64>) -> Point2<f64> {
    let p = homography * point.to_homogeneous();
    Point2::new(p.x / p.z, p.y / p.z)
}

/// Moves points to the origin and to a mean distance of about 1.
#[derive(Clone, Copy, Debug)]
struct Normaliser {
    middle: Vector2<f64>,
    scale: f64,
}

impl Normaliser {
    fn of(points: impl Iterator<Item = Point2<f64>> + Clone) -> Option<Self> {
        let count = points.clone().count() as f64;
        let middle = points.clone().map(|p| p.coords).sum::<Vector2<f64>>() / count;
        let spread = points.map(|p| (p.coords - middle).norm()).sum::<f64>() / count;
        (spread > 1e-9 && spread.is_finite()).then(|| Self { middle, scale: 1.0 / spread })
    }

    fn apply(&self, point: Point2<f64>) -> Point2<f64> {
        Point2::from((point.coords - self.middle) * self.scale)
    }

    fn matrix(&self) -> Matrix3<f64> {
        let (s, m) = (self.scale, self.middle * self.scale);
        Matrix3::new(s, 0.0, -m.x, 0.0, s, -m.y, 0.0, 0.0, 1.0)
    }

    fn inverse(&self) -> Matrix3<f64> {
        let (s, m) = (1.0 / self.scale, self.middle);
        Matrix3::new(s, 0.0, m.x, 0.0, s, m.y, 0.0, 0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_map_is_found_again_from_its_pairs(
            tilt in -0.4f64..0.4, lean in -0.4f64..0.4, size in 0.01f64..900.0,
        ) {
            let map = Matrix3::new(9.0, 2.0, 300.0, -1.0, 8.0, 200.0, tilt / size, lean / size, 1.0);
            let grid = (0..9).map(|i| {
                let point = Point2::new(f64::from(i % 3), f64::from(i / 3)) * (0.5 * size);
                (point, apply(&map, point))
            });
            let found = fit(grid.clone()).unwrap();
            for (from, to) in grid {
                prop_assert!((apply(&found, from) - to).norm() < 1e-6 * to.coords.norm());
            }
        }
    }

    #[test]
    fn a_line_of_points_gives_no_map() {
        let line = (0..5).map(|i| Point2::new(f64::from(i), 2.0 * f64::from(i)));
        assert_eq!(fit(line.clone().zip(line)), None);
        let three = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Point2::from);
        assert_eq!(fit(three.into_iter().zip(three)), None);
    }
}
