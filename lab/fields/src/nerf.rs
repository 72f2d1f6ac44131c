//! A network of position and direction, after NeRF (Mildenhall et al., 2020), trained with burn.
//!
//! ```text
//! [p, sin 2^k p, cos 2^k p]      -> L layers of W, relu; the encoded position joins again after half
//!                                -> linear -> raw density
//! [last layer, the same of the direction] -> W / 2, relu -> linear -> raw colour
//! ```
//!
//! Where we depart from the paper: one network, and [`Occupancy`](crate::occupancy) instead of its
//! second, finer one to find where samples are worth taking; softplus instead of relu for densities.
//!
//! [`Nerf::with_variance`] has one more head, `last layer -> linear -> raw variance`, for
//! `variance`.

use std::path::Path;

use anyhow::{Result, anyhow};
use burn::module::{Module, Param};
use burn::nn::Linear;
use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer};
use burn::store::ModuleRecord;
use burn::tensor::activation::relu;
use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use vantage_core::Vec3;

use crate::field::Field;

/// Everything that a network depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// Layers before the density.
    pub layers: usize,
    /// Their width.
    pub width: usize,
    /// Octaves of the position.
    pub position_frequencies: usize,
    /// Octaves of the direction.
    pub direction_frequencies: usize,
    /// Adam's rate.
    pub rate: f32,
}

#[derive(Module, Debug)]
struct Network {
    trunk: Vec<Linear>,
    density: Linear,
    branch: Linear,
    colour: Linear,
    variance: Option<Linear>,
}

/// A network in training.
pub struct Nerf {
    config: Config,
    device: Device,
    network: Network,
    optimizer: ModuleOptimizer,
    density: Option<Tensor<1>>,  // (points), what the last call gave
    features: Option<Tensor<2>>, // (points, width)
    colour: Option<Tensor<2>>,   // (shown, 3)
    variance: Option<Tensor<1>>, // (points)
    gradients: Option<GradientsParams>,
}

/// Numbers of an encoded vector.
const fn encoded(frequencies: usize) -> usize {
    3 + 6 * frequencies
}

/// The vectors themselves and sine and cosine of their octaves; shape (vectors, encoded).
fn encode(vectors: &[Vec3], frequencies: usize, device: &Device) -> Tensor<2> {
    let mut values = Vec::with_capacity(vectors.len() * encoded(frequencies));
    for vector in vectors {
        values.extend(vector.to_array());
        for octave in 0..frequencies {
            for at in vector.to_array() {
                let (sine, cosine) = (at * (1 << octave) as f32).sin_cos();
                values.extend([sine, cosine]);
            }
        }
    }
    Tensor::from_data(TensorData::new(values, [vectors.len(), encoded(frequencies)]), device)
}

impl Nerf {
    /// A network of random weights.
    pub fn new(config: Config, seed: u64) -> Self {
        Self::made(config, seed, false)
    }

    /// The same, with a head for the variance of colours.
    pub fn with_variance(config: Config, seed: u64) -> Self {
        Self::made(config, seed, true)
    }

    fn made(config: Config, seed: u64, has_variance: bool) -> Self {
        let device = Device::flex().autodiff();
        let mut chance = Pcg64::seed_from_u64(seed);
        // Drawn here, not by burn, whose source of chance all threads share. He et al. (2015).
        let mut linear = |from: usize, to: usize, gain: f32| {
            let most = gain * (6.0 / from as f32).sqrt();
            let mut draw = |count: usize| -> Vec<f32> {
                (0..count).map(|_| chance.random_range(-most..most)).collect()
            };
            Linear {
                weight: Param::from_data(TensorData::new(draw(from * to), [from, to]), &device),
                bias: Some(Param::from_data(TensorData::new(vec![0.0f32; to], [to]), &device)),
            }
        };
        let position = encoded(config.position_frequencies);
        let half = config.width / 2;
        let trunk = (0..config.layers).map(|layer| {
            let from = match layer {
                0 => position,
                _ if layer == config.layers / 2 => config.width + position,
                _ => config.width,
            };
            linear(from, config.width, 1.0)
        });
        let trunk = trunk.collect();
        let density = linear(config.width, 1, 0.3);
        let branch = linear(config.width + encoded(config.direction_frequencies), half, 1.0);
        let colour = linear(half, 3, 0.3);
        // Last, so that the others are the same with it and without.
        let variance = has_variance.then(|| linear(config.width, 1, 0.3));
        let network = Network { trunk, density, branch, colour, variance };
        let optimizer = AdamConfig::new().with_epsilon(1e-8).init();
        Self {
            config,
            device,
            network,
            optimizer,
            density: None,
            features: None,
            colour: None,
            variance: None,
            gradients: None,
        }
    }

    /// Raw variance of the points whose density was asked for last; shape (points), empty without
    /// that head.
    pub fn variance(&mut self) -> Vec<f32> {
        let (Some(features), Some(head)) = (self.features.clone(), &self.network.variance) else {
            return Vec::new();
        };
        let variance = head.forward(features).squeeze_dim::<1>(1);
        self.variance = Some(variance.clone());
        numbers(variance)
    }

    /// [`Field::accumulate`], of the loss's derivatives by raw variances too.
    pub fn accumulate_all(
        &mut self,
        by_density: &[f32],
        by_colour: &[[f32; 3]],
        by_variance: &[f32],
    ) {
        // A sum of which these are the derivatives by density, colour and variance.
        let given = |values: &[f32]| {
            let data = TensorData::new(values.to_vec(), [values.len()]);
            Tensor::<1>::from_data(data, &self.device)
        };
        let Some(density) = self.density.take() else { return };
        let mut sum = (density * given(by_density)).sum();
        if let Some(colour) = self.colour.take() {
            let slopes = given(by_colour.as_flattened()).reshape([by_colour.len(), 3]);
            sum = sum + (colour * slopes).sum();
        }
        if let Some(variance) = self.variance.take() {
            sum = sum + (variance * given(by_variance)).sum();
        }
        self.gradients = Some(GradientsParams::from_grads(sum.backward(), &self.network));
    }
}

/// burn's tensors are made of the numbers that were asked for.
fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor.into_data().try_to_vec().expect("tensors are f32")
}

impl Field for Nerf {
    fn density(&mut self, points: &[Vec3]) -> Vec<f32> {
        (self.density, self.features, self.colour) = (None, None, None);
        self.variance = None;
        if points.is_empty() {
            return Vec::new();
        }
        let position = encode(points, self.config.position_frequencies, &self.device);
        let mut features = position.clone();
        for (layer, linear) in self.network.trunk.iter().enumerate() {
            if layer > 0 && layer == self.config.layers / 2 {
                features = Tensor::cat(vec![features, position.clone()], 1);
            }
            features = relu(linear.forward(features));
        }
        let density = self.network.density.forward(features.clone()).squeeze_dim::<1>(1);
        self.density = Some(density.clone());
        self.features = Some(features);
        numbers(density)
    }

    fn colour(&mut self, shown: &[u32], directions: &[Vec3]) -> Vec<[f32; 3]> {
        let Some(features) = self.features.clone().filter(|_| !shown.is_empty()) else {
            return Vec::new();
        };
        let indices: Vec<i64> = shown.iter().map(|&index| i64::from(index)).collect();
        let indices =
            Tensor::<1, Int>::from_data(TensorData::new(indices, [shown.len()]), &self.device);
        let direction = encode(directions, self.config.direction_frequencies, &self.device);
        let seen = Tensor::cat(vec![features.select(0, indices), direction], 1);
        let colour = self.network.colour.forward(relu(self.network.branch.forward(seen)));
        self.colour = Some(colour.clone());
        numbers(colour).as_chunks::<3>().0.to_vec()
    }

    fn accumulate(&mut self, by_density: &[f32], by_colour: &[[f32; 3]]) {
        self.variance = None;
        self.accumulate_all(by_density, by_colour, &[]);
    }

    fn advance(&mut self, rate: f32) {
        if let Some(gradients) = self.gradients.take() {
            let rate = f64::from(rate * self.config.rate);
            self.network = self.optimizer.step(rate, self.network.clone(), gradients);
        }
    }

    fn refine(&mut self, _: f32) {}

    fn save(&self, folder: &Path) -> Result<()> {
        let (weights, state) = files(folder);
        let failed =
            |path: &Path, error: String| anyhow!("cannot write {}: {error}", path.display());
        let record = self.network.valid().into_record();
        record.save(&weights).map_err(|error| failed(&weights, error.to_string()))?;
        self.optimizer.save(&state).map_err(|error| failed(&state, error.to_string()))
    }

    fn load(&mut self, folder: &Path) -> Result<()> {
        let (weights, state) = files(folder);
        let failed =
            |path: &Path, error: String| anyhow!("cannot read {}: {error}", path.display());
        let record =
            ModuleRecord::load(&weights).map_err(|error| failed(&weights, error.to_string()))?;
        let has_variance = self.network.variance.is_some();
        let fresh = Self::made(self.config.clone(), 0, has_variance);
        self.network = fresh.network.load_record(record);
        let optimizer: ModuleOptimizer = AdamConfig::new().with_epsilon(1e-8).init();
        self.optimizer =
            optimizer.load(&state).map_err(|error| failed(&state, error.to_string()))?;
        Ok(())
    }
}

/// Weights and the optimiser's state.
fn files(folder: &Path) -> (std::path::PathBuf, std::path::PathBuf) {
    (folder.join("nerf.bpk"), folder.join("nerf-optimizer.bpk"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Nerf {
        let config = Config {
            layers: 2,
            width: 8,
            position_frequencies: 2,
            direction_frequencies: 1,
            rate: 0.01,
        };
        Nerf::new(config, 3)
    }

    /// One of a network's layers.
    type Layer = fn(&mut Network) -> &mut Linear;

    /// burn knows its own derivatives; this is about what goes in and comes out.
    #[test]
    fn slopes_reach_the_parameters() {
        let points: Vec<Vec3> =
            (0..5).map(|i| Vec3::new(0.1 * i as f32, -0.3, 0.2 - 0.1 * i as f32)).collect();
        let shown = [1, 3, 4];
        let directions = [Vec3::X, Vec3::Y, Vec3::NEG_Z];
        let by_density = [0.5, -1.0, 0.0, 2.0, 0.3];
        let by_colour = [[1.0, 0.0, -1.0], [0.5, 0.5, 0.5], [0.0, 2.0, 0.0]];
        let by_variance = [-0.7, 1.5, 0.4, 0.0, 1.0];
        let value = |nerf: &mut Nerf| -> f32 {
            let density = nerf.density(&points);
            let colour = nerf.colour(&shown, &directions);
            let variance = nerf.variance();
            let of_density = density.iter().zip(&by_density);
            let of_colour = colour.iter().flatten().zip(by_colour.as_flattened());
            let of_variance = variance.iter().zip(&by_variance); // of a head that may be missing
            of_density.chain(of_colour).chain(of_variance).map(|(a, b)| a * b).sum()
        };
        let layers: [Layer; 4] = [
            |network| &mut network.trunk[1],
            |network| &mut network.density,
            |network| &mut network.colour,
            |network| network.variance.as_mut().unwrap(),
        ];
        for (has_variance, layers) in [(false, &layers[..3]), (true, &layers[..])] {
            let mut nerf = Nerf::made(small().config, 3, has_variance);
            value(&mut nerf);
            if has_variance {
                nerf.accumulate_all(&by_density, &by_colour, &by_variance);
            } else {
                nerf.accumulate(&by_density, &by_colour);
            }
            let gradients = nerf.gradients.take().unwrap();
            for (place, layer) in layers.iter().enumerate() {
                let weight = layer(&mut nerf.network).weight.clone();
                let told = numbers(gradients.get::<2>(weight.id).unwrap());
                let values = numbers(weight.val());
                let mut compared = 0;
                for index in 0..values.len() {
                    let mut at = |off: f32| {
                        let mut values = values.clone();
                        values[index] += off;
                        let data = TensorData::new(values, weight.dims());
                        let weight = Param::from_data(data, &nerf.device);
                        layer(&mut nerf.network).weight = weight;
                        value(&mut nerf)
                    };
                    let found = (at(1e-2) - at(-1e-2)) / 2e-2;
                    at(0.0);
                    let told = told[index];
                    let close = (found - told).abs() < 2e-3 + 0.02 * told.abs();
                    assert!(close, "layer {place}, {index}: {found} {told}");
                    compared += usize::from(told.abs() > 0.05);
                }
                assert!(compared > 2, "layer {place}: {compared}");
            }
        }
    }

    #[test]
    fn the_head_for_variance_changes_no_other() {
        let points = [Vec3::splat(0.3), Vec3::X];
        let (mut without, mut with) = (small(), Nerf::with_variance(small().config, 3));
        assert_eq!(without.density(&points), with.density(&points));
        let seen = |nerf: &mut Nerf| nerf.colour(&[0, 1], &[Vec3::Y; 2]);
        assert_eq!(seen(&mut without), seen(&mut with));
        assert_eq!((without.variance().len(), with.variance().len()), (0, 2));
    }

    #[test]
    fn weights_depend_on_the_seed_alone() {
        let of = |seed| Nerf::new(small().config, seed).density(&[Vec3::splat(0.3)]);
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
    }
}
