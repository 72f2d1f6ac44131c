//! Adam (Kingma and Ba, 2015) on rows of numbers that a step may leave untouched.

use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};

const BETA: [f32; 2] = [0.9, 0.99];
const EPSILON: f32 = 1e-8;

/// Parameters in rows with their gradient and the optimiser's moments.
///
/// Only touched rows move, and only their moments age: a grid has a hundred times more cells than a
/// step looks at. Moments start at 0 and age by touches of their row. Their bias is not corrected:
/// with these betas a row's first move is one rate long without it, 0.1 g / sqrt(0.01 g^2) = 1.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Rows {
    width: usize,
    values: Vec<f32>,
    mean: Vec<f32>,
    square: Vec<f32>,
    #[serde(skip)]
    gradient: Vec<f32>,
    #[serde(skip)]
    touched: Vec<u64>, // a bit for each row; going through them in order keeps memory near
}

impl Rows {
    /// Rows of so many numbers.
    pub fn new(width: usize, values: Vec<f32>) -> Self {
        let zero = || vec![0.0; values.len()];
        let (mean, square) = (zero(), zero());
        let gradient = zero();
        let touched = vec![0; (values.len() / width).div_ceil(64)];
        Self { width, values, mean, square, gradient, touched }
    }

    /// Rows that were read, with room for gradients, which are not stored.
    pub fn ready(self) -> Result<Self> {
        let Self { width, values, mean, square, .. } = self;
        ensure!(
            width > 0 && mean.len() == values.len() && square.len() == values.len(),
            "the file of a field is damaged"
        );
        Ok(Self { mean, square, ..Self::new(width, values) })
    }

    /// How many numbers there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// A row's numbers.
    #[inline]
    pub fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.width..][..self.width]
    }

    /// The place for a row's gradient, which thereby is touched.
    #[inline]
    pub fn touch(&mut self, row: usize) -> &mut [f32] {
        self.touched[row / 64] |= 1 << (row % 64);
        &mut self.gradient[row * self.width..][..self.width]
    }

    /// Draws each touched row of a grid of `nodes` along each axis towards its neighbours: adds the
    /// gradient of half the squared differences. `strides` are the rows from a node to the next along
    /// each axis.
    pub fn draw_together(&mut self, nodes: usize, strides: &[usize], weight: f32) {
        if weight == 0.0 {
            return;
        }
        // With a width that the compiler knows it is twice as fast: those of a voxel grid.
        match self.width {
            1 => self.draw_rows_together(1, nodes, strides, weight),
            12 => self.draw_rows_together(12, nodes, strides, weight),
            width => self.draw_rows_together(width, nodes, strides, weight),
        }
    }

    #[inline(always)]
    fn draw_rows_together(&mut self, width: usize, nodes: usize, strides: &[usize], weight: f32) {
        let Self { values, gradient, touched, .. } = self;
        let of = |row: usize| &values[row * width..][..width];
        for_each(touched, |row| {
            let slopes = &mut gradient[row * width..][..width];
            let mut draw = |neighbour: usize| {
                for ((slope, own), other) in slopes.iter_mut().zip(of(row)).zip(of(neighbour)) {
                    *slope += weight * (own - other);
                }
            };
            for &stride in strides {
                let at = row / stride % nodes;
                if at > 0 {
                    draw(row - stride);
                }
                if at + 1 < nodes {
                    draw(row + stride);
                }
            }
        });
    }

    /// A step of all touched rows, after which none is touched.
    pub fn advance(&mut self, rate: f32) {
        match self.width {
            1 => self.advance_rows(1, rate),
            12 => self.advance_rows(12, rate),
            width => self.advance_rows(width, rate),
        }
        self.touched.fill(0);
    }

    #[inline(always)]
    fn advance_rows(&mut self, width: usize, rate: f32) {
        let Self { values, mean, square, gradient, touched, .. } = self;
        for_each(touched, |row| {
            let values = values[row * width..][..width].iter_mut();
            let means = mean[row * width..][..width].iter_mut();
            let squares = square[row * width..][..width].iter_mut();
            let gradients = gradient[row * width..][..width].iter_mut();
            for ((value, (mean, square)), gradient) in values.zip(means.zip(squares)).zip(gradients)
            {
                *mean += (1.0 - BETA[0]) * (*gradient - *mean);
                *square += (1.0 - BETA[1]) * (*gradient * *gradient - *square);
                *value -= rate * *mean / (square.sqrt() + EPSILON);
                *gradient = 0.0;
            }
        });
    }

    /// For a gradient check: a value that may be changed, and its gradient.
    #[cfg(test)]
    pub fn at(&mut self, index: usize) -> (&mut f32, f32) {
        (&mut self.values[index], self.gradient[index])
    }
}

/// Does something for every row whose bit is set, in ascending order.
#[inline(always)]
fn for_each(touched: &[u64], mut of_row: impl FnMut(usize)) {
    for (place, &word) in touched.iter().enumerate() {
        let mut left = word;
        while left != 0 {
            of_row(64 * place + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_is_as_long_as_the_rate_and_leaves_other_rows_alone() {
        let mut rows = Rows::new(2, vec![1.0; 6]);
        rows.touch(1).copy_from_slice(&[0.3, -40.0]);
        rows.advance(0.1);
        let expected = [1.0, 1.0, 0.9, 1.1, 1.0, 1.0];
        assert!(rows.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5));
        assert_eq!(rows.touched, [0]);
    }

    #[test]
    fn neighbours_are_drawn_together_on_their_own_line_only() {
        // Three by three; the last of a row is no neighbour of the next row's first.
        let mut rows = Rows::new(1, vec![0.0, 0.0, 4.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        rows.touch(2);
        rows.draw_together(3, &[1, 3], 0.5);
        assert_eq!(rows.at(2).1, 0.5 * (4.0 + 4.0));
        assert_eq!(rows.at(3).1, 0.0);
    }

    #[test]
    fn a_valley_is_descended() {
        let mut rows = Rows::new(1, vec![3.0, -2.0]);
        for step in 0..400 {
            for row in 0..2 {
                let slope = 2.0 * (rows.row(row)[0] - 1.0);
                rows.touch(row)[0] += slope;
            }
            rows.advance(0.1 * 0.99f32.powi(step));
        }
        assert!(rows.values.iter().all(|value| (value - 1.0).abs() < 0.01), "{rows:?}");
    }
}
