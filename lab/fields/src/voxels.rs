//! A voxel grid with spherical harmonics, after Plenoxels (Fridovich-Keil et al., 2022).
//!
//! Each node of a cube of n^3 nodes holds a raw density and, for each colour channel, the
//! coefficients of spherical harmonics; a point's values are interpolated from the eight nodes
//! around it. The grid starts coarse and is doubled on the way. Neighbouring nodes are drawn
//! together (the paper's total variation, here the sum of squared differences).
//!
//! Where we depart from the paper: the grid is dense, empty space being skipped by
//! [`Occupancy`](crate::occupancy); Adam instead of RMSProp; softplus and sigmoid instead of cut-off
//! linear values; no grid of the background.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use vantage_core::Vec3;

use crate::adam::Rows;
use crate::field::Field;
use crate::grid::{coordinate, cube};
use crate::harmonics::{basis, count};

/// Everything that a grid depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// Nodes along each side, one level after the other.
    pub nodes: Vec<usize>,
    /// Highest degree of the harmonics: 0, 1 or 2.
    pub degree: usize,
    /// Adam's rate for densities.
    pub density_rate: f32,
    /// Adam's rate for colours.
    pub colour_rate: f32,
    /// Weight of the squared differences between neighbouring densities.
    pub density_smoothness: f32,
    /// The same for colours.
    pub colour_smoothness: f32,
}

/// A grid in training.
pub struct Voxels {
    config: Config,
    grid: Grid,
    points: Vec<Vec3>,
    shown: Vec<u32>,
    directions: Vec<Vec3>, // (shown)
}

#[derive(Serialize, Deserialize)]
struct Grid {
    nodes: usize,
    density: Rows, // (nodes^3, 1)
    colour: Rows,  // (nodes^3, 3 * harmonics)
}

impl Grid {
    fn new(nodes: usize, density: Vec<f32>, colour: Vec<f32>) -> Self {
        let width = colour.len() / density.len();
        Self { nodes, density: Rows::new(1, density), colour: Rows::new(width, colour) }
    }

    /// The same values between more nodes.
    fn resampled(&self, nodes: usize) -> Self {
        let all = nodes * nodes * nodes;
        let width = self.colour.row(0).len();
        let (mut density, mut colour) = (vec![0.0; all], vec![0.0; all * width]);
        for (node, colour) in colour.chunks_exact_mut(width).enumerate() {
            let place = [node % nodes, node / nodes % nodes, node / nodes / nodes];
            for (old, weight) in cube(place.map(|at| coordinate(at, nodes)), self.nodes) {
                density[node] += weight * self.density.row(old)[0];
                for (sum, value) in colour.iter_mut().zip(self.colour.row(old)) {
                    *sum += weight * value;
                }
            }
        }
        Self::new(nodes, density, colour)
    }
}

impl Voxels {
    /// A grid of grey fog.
    ///
    /// # Panics
    ///
    /// If the configuration has no level, a level of less than 2 nodes, or a degree above 2.
    pub fn new(config: Config) -> Self {
        assert!(config.degree <= 2 && config.nodes.iter().all(|&nodes| nodes >= 2));
        let all = config.nodes[0].pow(3);
        let grid =
            Grid::new(config.nodes[0], vec![0.0; all], vec![0.0; all * 3 * count(config.degree)]);
        Self { config, grid, points: vec![], shown: vec![], directions: vec![] }
    }

    /// `W` is 3 `K`, which the type system cannot say.
    fn colours<const K: usize, const W: usize>(&self) -> Vec<[f32; 3]> {
        let colour = |(&point, &direction): (&u32, &Vec3)| {
            let harmonics = basis::<K>(direction);
            let mut sums = [0.0; W];
            for (node, weight) in cube(self.points[point as usize].to_array(), self.grid.nodes) {
                for (sum, value) in sums.iter_mut().zip(self.grid.colour.row(node)) {
                    *sum += weight * value;
                }
            }
            std::array::from_fn(|c| (0..K).map(|k| harmonics[k] * sums[c * K + k]).sum())
        };
        self.shown.iter().zip(&self.directions).map(colour).collect()
    }

    fn colour_slopes<const K: usize, const W: usize>(&mut self, by_colour: &[[f32; 3]]) {
        for ((&point, &direction), slope) in self.shown.iter().zip(&self.directions).zip(by_colour)
        {
            let harmonics = basis::<K>(direction);
            let slopes: [f32; W] = std::array::from_fn(|i| slope[i / K] * harmonics[i % K]);
            for (node, weight) in cube(self.points[point as usize].to_array(), self.grid.nodes) {
                for (sum, part) in self.grid.colour.touch(node).iter_mut().zip(slopes) {
                    *sum += weight * part;
                }
            }
        }
    }
}

impl Field for Voxels {
    fn density(&mut self, points: &[Vec3]) -> Vec<f32> {
        self.points.clear();
        self.points.extend_from_slice(points);
        let density = |point: &Vec3| -> f32 {
            let corners = cube(point.to_array(), self.grid.nodes);
            corners.iter().map(|&(node, weight)| weight * self.grid.density.row(node)[0]).sum()
        };
        points.iter().map(density).collect()
    }

    fn colour(&mut self, shown: &[u32], directions: &[Vec3]) -> Vec<[f32; 3]> {
        self.shown.clear();
        self.shown.extend_from_slice(shown);
        self.directions.clear();
        self.directions.extend_from_slice(directions);
        match self.config.degree {
            0 => self.colours::<1, 3>(),
            1 => self.colours::<4, 12>(),
            _ => self.colours::<9, 27>(),
        }
    }

    fn accumulate(&mut self, by_density: &[f32], by_colour: &[[f32; 3]]) {
        for (point, &slope) in self.points.iter().zip(by_density) {
            // Hidden samples have none.
            if slope != 0.0 {
                for (node, weight) in cube(point.to_array(), self.grid.nodes) {
                    self.grid.density.touch(node)[0] += weight * slope;
                }
            }
        }
        match self.config.degree {
            0 => self.colour_slopes::<1, 3>(by_colour),
            1 => self.colour_slopes::<4, 12>(by_colour),
            _ => self.colour_slopes::<9, 27>(by_colour),
        }
    }

    fn advance(&mut self, rate: f32) {
        let Grid { nodes, density, colour } = &mut self.grid;
        let strides = [1, *nodes, *nodes * *nodes];
        density.draw_together(*nodes, &strides, self.config.density_smoothness);
        colour.draw_together(*nodes, &strides, self.config.colour_smoothness);
        density.advance(rate * self.config.density_rate);
        colour.advance(rate * self.config.colour_rate);
    }

    fn refine(&mut self, done: f32) {
        let nodes = crate::recipe::level(&self.config.nodes, done);
        if nodes != self.grid.nodes {
            self.grid = self.grid.resampled(nodes);
        }
    }

    fn save(&self, folder: &Path) -> Result<()> {
        let path = folder.join("voxels.bin");
        fs::write(&path, postcard::to_stdvec(&self.grid)?)
            .with_context(|| format!("cannot write {}", path.display()))
    }

    fn load(&mut self, folder: &Path) -> Result<()> {
        let path = folder.join("voxels.bin");
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let Grid { nodes, density, colour } = postcard::from_bytes(&bytes)
            .with_context(|| format!("{} is damaged", path.display()))?;
        let all = nodes.checked_pow(3);
        ensure!(
            self.config.nodes.contains(&nodes)
                && Some(density.len()) == all
                && all.and_then(|all| all.checked_mul(3 * count(self.config.degree)))
                    == Some(colour.len()),
            "{} belongs to a field of another size",
            path.display()
        );
        self.grid = Grid { nodes, density: density.ready()?, colour: colour.ready()? };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks;

    fn small(degree: usize) -> Voxels {
        let config = Config {
            nodes: vec![3, 5],
            degree,
            density_rate: 0.1,
            colour_rate: 0.1,
            density_smoothness: 0.0,
            colour_smoothness: 0.0,
        };
        let mut field = Voxels::new(config);
        // Not all the same, as they begin.
        for (i, rows) in [&mut field.grid.density, &mut field.grid.colour].into_iter().enumerate() {
            for index in 0..rows.len() {
                *rows.at(index).0 = ((index * (i + 2)) as f32 * 1.3).sin();
            }
        }
        field
    }

    fn rows(field: &mut Voxels) -> Vec<&mut Rows> {
        vec![&mut field.grid.density, &mut field.grid.colour]
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        for degree in 0..=2 {
            checks::gradient(&mut small(degree), rows);
        }
    }

    #[test]
    fn more_nodes_hold_the_same_values() {
        // Every node of the coarse grid is one of the fine grid.
        checks::refinement(&mut small(1));
    }

    #[test]
    fn what_is_saved_goes_on_alike() {
        checks::resumption(|| small(1));
    }
}
