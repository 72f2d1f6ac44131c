//! A vector-matrix decomposition, TensoRF-VM (Chen et al., 2022).
//!
//! A grid is written as a sum of products of a plane and a line, R of them for each of the three ways
//! to split space (eq. 7 of the paper):
//!
//! ```text
//! raw density(x, y, z) = sum_r P^xy_r(x, y) L^z_r(z) + P^xz_r(x, z) L^y_r(y) + P^yz_r(y, z) L^x_r(x)
//! features(x, y, z)    = B [products of planes and lines of their own, 3 R' of them]
//! ```
//!
//! and the features are coefficients of spherical harmonics for each colour channel (the paper's
//! TensoRF-SH; its MLP costs twenty times more arithmetic than all the rest, and our photos show no
//! highlights). Planes and lines are interpolated linearly and grow on the way.
//!
//! Where we depart from the paper: empty space is skipped by [`Occupancy`](crate::occupancy); the box
//! is not shrunk; squared differences on the planes of density instead of total variation.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use vantage_core::Vec3;

use crate::adam::Rows;
use crate::field::Field;
use crate::grid::{between, coordinate, square};
use crate::harmonics::{basis, count};

/// Everything that a decomposition depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// Nodes along each side, one level after the other.
    pub nodes: Vec<usize>,
    /// R: products of the density for each of the three ways.
    pub density_rank: usize,
    /// R': products of the colours.
    pub colour_rank: usize,
    /// Highest degree of the harmonics: 0, 1 or 2.
    pub degree: usize,
    /// Adam's rate for planes and lines.
    pub grid_rate: f32,
    /// Adam's rate for B.
    pub basis_rate: f32,
    /// Weight of the squared differences between neighbours on the planes of density.
    pub smoothness: f32,
}

/// For each way to split space: the two axes of the plane, and that of the line.
const WAYS: [([usize; 2], usize); 3] = [([0, 1], 2), ([0, 2], 1), ([1, 2], 0)];

/// Spread of the first values of planes and lines, the paper's.
const SPREAD: f32 = 0.1;

/// The planes and lines of all three ways.
#[derive(Serialize, Deserialize)]
struct Products {
    nodes: usize,
    rank: usize,
    planes: [Rows; 3], // (nodes^2, rank)
    lines: [Rows; 3],  // (nodes, rank)
}

impl Products {
    fn new(nodes: usize, rank: usize, chance: &mut impl Rng) -> Self {
        // A sum of uniform numbers is near enough to the paper's normal ones.
        let mut draw = || {
            let sum: f32 = (0..3).map(|_| chance.random_range(-1.0f32..1.0)).sum();
            SPREAD * sum
        };
        let mut rows = |count: usize| Rows::new(rank, (0..count * rank).map(|_| draw()).collect());
        let planes = [(); 3].map(|()| rows(nodes * nodes));
        let lines = [(); 3].map(|()| rows(nodes));
        Self { nodes, rank, planes, lines }
    }

    /// The values of plane and line of one way at a point; shape (rank) each.
    #[inline]
    fn factors(&self, way: usize, point: Vec3, plane: &mut [f32], line: &mut [f32]) {
        let ([u, v], w) = WAYS[way];
        plane.fill(0.0);
        for (node, weight) in square(point[u], point[v], self.nodes) {
            for (sum, value) in plane.iter_mut().zip(self.planes[way].row(node)) {
                *sum += weight * value;
            }
        }
        let at = between(point[w], self.nodes);
        let ends = self.lines[way].row(at.node).iter().zip(self.lines[way].row(at.node + 1));
        for (value, (low, high)) in line.iter_mut().zip(ends) {
            *value = low + at.beyond * (high - low);
        }
    }

    /// Takes the loss's derivatives by the products of one way at a point; shape (rank).
    #[inline]
    fn slopes(&mut self, way: usize, point: Vec3, by_product: &[f32], scratch: &mut Scratch) {
        let rank = self.rank;
        let Scratch { plane, line } = scratch;
        self.factors(way, point, &mut plane[..rank], &mut line[..rank]);
        // From the factors' values to the derivatives by them, in place.
        for ((plane, line), slope) in plane.iter_mut().zip(line.iter_mut()).zip(by_product) {
            (*plane, *line) = (slope * *line, slope * *plane);
        }
        let ([u, v], w) = WAYS[way];
        for (node, weight) in square(point[u], point[v], self.nodes) {
            for (sum, slope) in self.planes[way].touch(node).iter_mut().zip(plane.iter()) {
                *sum += weight * slope;
            }
        }
        let at = between(point[w], self.nodes);
        for (node, weight) in [(at.node, 1.0 - at.beyond), (at.node + 1, at.beyond)] {
            for (sum, slope) in self.lines[way].touch(node).iter_mut().zip(line.iter()) {
                *sum += weight * slope;
            }
        }
    }

    /// The same values between more nodes.
    fn resampled(&self, nodes: usize) -> Self {
        let plane = |old: &Rows| {
            let mut values = vec![0.0; nodes * nodes * self.rank];
            for (node, values) in values.chunks_exact_mut(self.rank).enumerate() {
                let [u, v] = [node % nodes, node / nodes].map(|at| coordinate(at, nodes));
                for (node, weight) in square(u, v, self.nodes) {
                    for (sum, value) in values.iter_mut().zip(old.row(node)) {
                        *sum += weight * value;
                    }
                }
            }
            Rows::new(self.rank, values)
        };
        let line = |old: &Rows| {
            let mut values = Vec::with_capacity(nodes * self.rank);
            for node in 0..nodes {
                let at = between(coordinate(node, nodes), self.nodes);
                let ends = old.row(at.node).iter().zip(old.row(at.node + 1));
                values.extend(ends.map(|(low, high)| low + at.beyond * (high - low)));
            }
            Rows::new(self.rank, values)
        };
        Self {
            nodes,
            rank: self.rank,
            planes: self.planes.each_ref().map(plane),
            lines: self.lines.each_ref().map(line),
        }
    }

    fn all(&mut self) -> impl Iterator<Item = &mut Rows> {
        self.planes.iter_mut().chain(&mut self.lines)
    }

    fn fits(&self, rank: usize) -> bool {
        let of = |rows: &[Rows; 3], count: usize| {
            rows.iter().all(|rows| Some(rows.len()) == count.checked_mul(rank))
        };
        self.rank == rank
            && self.nodes.checked_pow(2).is_some_and(|all| of(&self.planes, all))
            && of(&self.lines, self.nodes)
    }

    fn ready(self) -> Result<Self> {
        let [a, b, c] = self.planes.map(Rows::ready);
        let [d, e, f] = self.lines.map(Rows::ready);
        Ok(Self { planes: [a?, b?, c?], lines: [d?, e?, f?], ..self })
    }
}

/// The values of one point's plane and line.
#[derive(Default)]
struct Scratch {
    plane: Vec<f32>, // (rank)
    line: Vec<f32>,  // (rank)
}

impl Scratch {
    fn new(rank: usize) -> Self {
        Self { plane: vec![0.0; rank], line: vec![0.0; rank] }
    }
}

/// A decomposition in training.
pub struct Tensorf {
    config: Config,
    parts: Parts,
    points: Vec<Vec3>,
    shown: Vec<u32>,
    directions: Vec<Vec3>, // (shown)
    products: Vec<f32>,    // (shown, 3 * colour rank)
}

#[derive(Serialize, Deserialize)]
struct Parts {
    density: Products,
    colour: Products,
    /// B; a row for each product: (3 * colour rank, 3 * harmonics).
    basis: Rows,
}

impl Tensorf {
    /// Planes and lines of small random values.
    ///
    /// # Panics
    ///
    /// If the configuration has no level, a level of less than 2 nodes, or a degree above 2.
    pub fn new(config: Config, seed: u64) -> Self {
        assert!(config.degree <= 2 && config.nodes.iter().all(|&nodes| nodes >= 2));
        let mut chance = Pcg64::seed_from_u64(seed);
        let nodes = config.nodes[0];
        let density = Products::new(nodes, config.density_rank, &mut chance);
        let colour = Products::new(nodes, config.colour_rank, &mut chance);
        let inputs = 3 * config.colour_rank;
        let outputs = 3 * count(config.degree);
        // As a linear layer begins: uniform within 1 / sqrt(inputs).
        let most = 1.0 / (inputs as f32).sqrt();
        let values = (0..inputs * outputs).map(|_| chance.random_range(-most..most)).collect();
        let parts = Parts { density, colour, basis: Rows::new(outputs, values) };
        Self { config, parts, points: vec![], shown: vec![], directions: vec![], products: vec![] }
    }

    /// `W` is 3 `K`, which the type system cannot say.
    fn colours<const K: usize, const W: usize>(&self) -> Vec<[f32; 3]> {
        let inputs = 3 * self.config.colour_rank;
        let colour = |(products, &direction): (&[f32], &Vec3)| {
            let harmonics = basis::<K>(direction);
            let mut features = [0.0; W];
            for (row, product) in products.iter().enumerate() {
                for (sum, value) in features.iter_mut().zip(self.parts.basis.row(row)) {
                    *sum += product * value;
                }
            }
            std::array::from_fn(|c| (0..K).map(|k| harmonics[k] * features[c * K + k]).sum())
        };
        self.products.chunks_exact(inputs).zip(&self.directions).map(colour).collect()
    }

    fn colour_slopes<const K: usize, const W: usize>(&mut self, by_colour: &[[f32; 3]]) {
        let rank = self.config.colour_rank;
        let mut scratch = Scratch::new(rank);
        let mut by_product = vec![0.0; 3 * rank];
        let looks = self.shown.iter().zip(&self.directions).zip(by_colour);
        for (((&point, &direction), slope), products) in
            looks.zip(self.products.chunks_exact(3 * rank))
        {
            if *slope == [0.0; 3] {
                continue;
            }
            let harmonics = basis::<K>(direction);
            let slopes: [f32; W] = std::array::from_fn(|i| slope[i / K] * harmonics[i % K]);
            for (row, (product, by_product)) in products.iter().zip(&mut by_product).enumerate() {
                let values = self.parts.basis.row(row).iter().zip(slopes);
                *by_product = values.map(|(value, slope)| value * slope).sum();
                for (sum, slope) in self.parts.basis.touch(row).iter_mut().zip(slopes) {
                    *sum += product * slope;
                }
            }
            let point = self.points[point as usize];
            for (way, by_product) in by_product.chunks_exact(rank).enumerate() {
                self.parts.colour.slopes(way, point, by_product, &mut scratch);
            }
        }
    }
}

impl Field for Tensorf {
    fn density(&mut self, points: &[Vec3]) -> Vec<f32> {
        self.points.clear();
        self.points.extend_from_slice(points);
        let Scratch { mut plane, mut line } = Scratch::new(self.config.density_rank);
        let mut density = |&point: &Vec3| -> f32 {
            let mut sum = 0.0;
            for way in 0..WAYS.len() {
                self.parts.density.factors(way, point, &mut plane, &mut line);
                sum += plane.iter().zip(&line).map(|(plane, line)| plane * line).sum::<f32>();
            }
            sum
        };
        points.iter().map(&mut density).collect()
    }

    fn colour(&mut self, shown: &[u32], directions: &[Vec3]) -> Vec<[f32; 3]> {
        self.shown.clear();
        self.shown.extend_from_slice(shown);
        self.directions.clear();
        self.directions.extend_from_slice(directions);
        self.products.clear();
        let Scratch { mut plane, mut line } = Scratch::new(self.config.colour_rank);
        for &point in shown {
            for way in 0..WAYS.len() {
                let point = self.points[point as usize];
                self.parts.colour.factors(way, point, &mut plane, &mut line);
                self.products.extend(plane.iter().zip(&line).map(|(plane, line)| plane * line));
            }
        }
        match self.config.degree {
            0 => self.colours::<1, 3>(),
            1 => self.colours::<4, 12>(),
            _ => self.colours::<9, 27>(),
        }
    }

    fn accumulate(&mut self, by_density: &[f32], by_colour: &[[f32; 3]]) {
        let mut scratch = Scratch::new(self.config.density_rank);
        let mut by_product = vec![0.0; self.config.density_rank];
        for (&point, &slope) in self.points.iter().zip(by_density) {
            // Hidden samples have none.
            if slope != 0.0 {
                by_product.fill(slope);
                for way in 0..WAYS.len() {
                    self.parts.density.slopes(way, point, &by_product, &mut scratch);
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
        let Parts { density, colour, basis } = &mut self.parts;
        for plane in &mut density.planes {
            let strides = [1, density.nodes];
            plane.draw_together(density.nodes, &strides, self.config.smoothness);
        }
        for rows in density.all().chain(colour.all()) {
            rows.advance(rate * self.config.grid_rate);
        }
        basis.advance(rate * self.config.basis_rate);
    }

    fn refine(&mut self, done: f32) {
        let nodes = crate::recipe::level(&self.config.nodes, done);
        if nodes != self.parts.density.nodes {
            self.parts.density = self.parts.density.resampled(nodes);
            self.parts.colour = self.parts.colour.resampled(nodes);
        }
    }

    fn save(&self, folder: &Path) -> Result<()> {
        let path = folder.join("tensorf.bin");
        fs::write(&path, postcard::to_stdvec(&self.parts)?)
            .with_context(|| format!("cannot write {}", path.display()))
    }

    fn load(&mut self, folder: &Path) -> Result<()> {
        let path = folder.join("tensorf.bin");
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let Parts { density, colour, basis } = postcard::from_bytes(&bytes)
            .with_context(|| format!("{} is damaged", path.display()))?;
        ensure!(
            self.config.nodes.contains(&density.nodes)
                && colour.nodes == density.nodes
                && density.fits(self.config.density_rank)
                && colour.fits(self.config.colour_rank)
                && basis.len() == self.parts.basis.len(),
            "{} belongs to a field of another size",
            path.display()
        );
        let basis = basis.ready()?;
        self.parts = Parts { density: density.ready()?, colour: colour.ready()?, basis };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks;

    fn small(degree: usize) -> Tensorf {
        let config = Config {
            nodes: vec![3, 5],
            density_rank: 2,
            colour_rank: 3,
            degree,
            grid_rate: 0.1,
            basis_rate: 0.1,
            smoothness: 0.0,
        };
        Tensorf::new(config, 5)
    }

    fn rows(field: &mut Tensorf) -> Vec<&mut Rows> {
        let Parts { density, colour, basis } = &mut field.parts;
        density.all().chain(colour.all()).chain([basis]).collect()
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
