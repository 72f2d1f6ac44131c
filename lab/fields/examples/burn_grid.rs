//! What burn takes for the look-ups of a voxel grid, against the grid of this crate.
//!
//! cargo run --release -p vantage-fields --example burn_grid
//!
//! A step is 20,000 samples in a grid of 64^3 nodes with 12 numbers each: eight weighted rows a sample,
//! their derivatives, and Adam. On two shared cores (x86-64, AMD EPYC), 2026-11-25: 6.0 ms by hand, 54 ms
//! by burn 0.22.1 flex, which touches every node of the grid where the other touches those looked up.

use std::time::Instant;

use burn::module::{Module, Param};
use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use vantage_core::Vec3;
use vantage_fields::field::Field;
use vantage_fields::voxels::{Config, Voxels};

const NODES: usize = 64;
const WIDTH: usize = 12;
const SAMPLES: usize = 20_000;
const STEPS: usize = 10;

#[derive(Module, Debug)]
struct Grid {
    values: Param<Tensor<2>>, // (nodes^3, numbers)
}

fn main() {
    let mut chance = Pcg64::seed_from_u64(1);
    // Around a sphere, as samples are once empty space is skipped.
    let points: Vec<Vec3> = (0..SAMPLES)
        .map(|_| {
            let at = Vec3::from_array([(); 3].map(|()| chance.random_range(-1.0f32..1.0)));
            at.normalize_or_zero() * chance.random_range(0.6f32..0.7)
        })
        .collect();

    let config = Config {
        nodes: vec![NODES],
        degree: 1,
        density_rate: 0.1,
        colour_rate: 0.1,
        density_smoothness: 0.0,
        colour_smoothness: 0.0,
    };
    let mut voxels = Voxels::new(config);
    let shown: Vec<u32> = (0..SAMPLES as u32).collect();
    let directions = vec![Vec3::X; SAMPLES];
    let start = Instant::now();
    for _ in 0..STEPS {
        voxels.density(&points);
        voxels.colour(&shown, &directions);
        voxels.accumulate(&vec![0.0; SAMPLES], &vec![[1.0; 3]; SAMPLES]);
        voxels.advance(1.0);
    }
    println!("by hand, one thread: {:.1} ms a step", milliseconds(start));

    let device = Device::flex().autodiff();
    let zeros = TensorData::new(vec![0.0f32; NODES.pow(3) * WIDTH], [NODES.pow(3), WIDTH]);
    let mut grid = Grid { values: Param::from_data(zeros, &device) };
    let mut optimizer = AdamConfig::new().init();
    let mut rows = Vec::with_capacity(8 * SAMPLES);
    let mut weights = Vec::with_capacity(8 * SAMPLES);
    for point in &points {
        let place = (*point + 1.0) * 0.5 * (NODES - 1) as f32;
        for corner in 0..8 {
            let (mut row, mut weight) = (0, 1.0);
            for axis in [2, 1, 0] {
                let beyond = place[axis] - place[axis].floor();
                let above = corner >> axis & 1;
                row = row * NODES + place[axis] as usize + above;
                weight *= if above == 1 { beyond } else { 1.0 - beyond };
            }
            rows.push(row as i64);
            weights.push(weight);
        }
    }
    let start = Instant::now();
    for _ in 0..STEPS {
        let rows = TensorData::new(rows.clone(), [8 * SAMPLES]);
        let weights = TensorData::new(weights.clone(), [8 * SAMPLES, 1]);
        let rows = Tensor::<1, Int>::from_data(rows, &device);
        let weights = Tensor::<2>::from_data(weights, &device);
        let values = grid.values.val().select(0, rows) * weights;
        let sums = values.reshape([SAMPLES, 8, WIDTH]).sum_dim(1);
        let gradients = GradientsParams::from_grads(sums.sum().backward(), &grid);
        grid = optimizer.step(0.1, grid, gradients);
    }
    println!("burn flex: {:.1} ms a step", milliseconds(start));
}

fn milliseconds(start: Instant) -> f64 {
    1000.0 * start.elapsed().as_secs_f64() / STEPS as f64
}
