//! What to train: each field at two sizes.
//!
//! What `small` reaches on 100 views spread evenly over the sphere, seen from 24 places on the test
//! circle: PSNR in dB and, in parentheses, seconds of processor time for everything (x86-64, AMD EPYC,
//! 2026-11-25; `cargo vantage field chair --field plenoxels` and so on):
//!
//! | | chair | vase | knot |
//! |---|---|---|---|
//! | plenoxels | 29.3 (8) | 27.4 (17) | 30.9 (13) |
//! | tensorf | 29.5 (13) | 26.5 (18) | 29.1 (18) |
//! | nerf | 28.1 (18) | 24.1 (39) | 23.6 (31) |
//!
//! The `paper` sizes have not been trained here.

use anyhow::{Result, ensure};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::field::Field;
use crate::nerf::{self, Nerf};
use crate::tensorf::{self, Tensorf};
use crate::voxels::{self, Voxels};

/// The kinds of fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// TensoRF-VM: planes times lines
    Tensorf,
    /// A voxel grid with spherical harmonics
    Plenoxels,
    /// A network of position and direction
    Nerf,
}

impl Kind {
    /// As the command line names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tensorf => "tensorf",
            Self::Plenoxels => "plenoxels",
            Self::Nerf => "nerf",
        }
    }
}

/// Sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Photos of 100 x 100; about a minute on two processor cores
    Small,
    /// The papers' sizes, photos of 400 x 400: many hours on a processor
    Paper,
}

impl Preset {
    /// As the command line names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Small => "small",
            Self::Paper => "paper",
        }
    }

    /// Side of the photos in pixels.
    pub const fn photo_side(self) -> u32 {
        match self {
            Self::Small => 100,
            Self::Paper => 400,
        }
    }
}

/// Everything that a trained field depends on beside its photos and its seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Steps of the optimiser.
    pub steps: usize,
    /// Rays in a step.
    pub rays: usize,
    /// Samples along a ray through the middle of the unit sphere.
    pub samples: usize,
    /// Rates fall exponentially to this share of theirs.
    pub last_rate: f32,
    /// The field itself.
    pub field: FieldConfig,
}

/// A field's own part of a recipe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FieldConfig {
    Tensorf(tensorf::Config),
    Plenoxels(voxels::Config),
    Nerf(nerf::Config),
}

impl Recipe {
    /// A ready recipe.
    pub fn new(kind: Kind, preset: Preset) -> Self {
        match (kind, preset) {
            (Kind::Plenoxels, Preset::Small) => Self {
                steps: 600,
                rays: 1024,
                samples: 128,
                last_rate: 0.1,
                field: FieldConfig::Plenoxels(voxels::Config {
                    nodes: vec![24, 48, 96],
                    degree: 1,
                    density_rate: 0.3,
                    colour_rate: 0.1,
                    density_smoothness: 1e-8,
                    colour_smoothness: 1e-9,
                }),
            },
            (Kind::Plenoxels, Preset::Paper) => Self {
                steps: 30_000,
                rays: 5_000,
                samples: 512,
                last_rate: 0.05,
                field: FieldConfig::Plenoxels(voxels::Config {
                    nodes: vec![64, 128, 256],
                    degree: 2,
                    density_rate: 0.1,
                    colour_rate: 0.03,
                    density_smoothness: 1e-9,
                    colour_smoothness: 1e-10,
                }),
            },
            (Kind::Tensorf, Preset::Small) => Self {
                steps: 400,
                rays: 1024,
                samples: 128,
                last_rate: 0.1,
                field: FieldConfig::Tensorf(tensorf::Config {
                    nodes: vec![24, 48, 80],
                    density_rank: 8,
                    colour_rank: 16,
                    degree: 1,
                    grid_rate: 0.05,
                    basis_rate: 5e-3,
                    smoothness: 1e-6,
                }),
            },
            (Kind::Tensorf, Preset::Paper) => Self {
                steps: 30_000,
                rays: 4_096,
                samples: 512,
                last_rate: 0.1,
                field: FieldConfig::Tensorf(tensorf::Config {
                    nodes: vec![128, 192, 300],
                    density_rank: 16,
                    colour_rank: 48,
                    degree: 2,
                    grid_rate: 0.02,
                    basis_rate: 1e-3,
                    smoothness: 1e-6,
                }),
            },
            (Kind::Nerf, Preset::Small) => Self {
                steps: 1500,
                rays: 512,
                samples: 64,
                last_rate: 0.1,
                field: FieldConfig::Nerf(nerf::Config {
                    layers: 4,
                    width: 64,
                    position_frequencies: 6,
                    direction_frequencies: 2,
                    rate: 5e-3,
                }),
            },
            (Kind::Nerf, Preset::Paper) => Self {
                steps: 200_000,
                rays: 4_096,
                samples: 192,
                last_rate: 0.1,
                field: FieldConfig::Nerf(nerf::Config {
                    layers: 8,
                    width: 256,
                    position_frequencies: 10,
                    direction_frequencies: 4,
                    rate: 5e-4,
                }),
            },
        }
    }

    /// A field as it is before training.
    pub fn field(&self, seed: u64) -> Box<dyn Field> {
        match &self.field {
            FieldConfig::Tensorf(config) => Box::new(Tensorf::new(config.clone(), seed)),
            FieldConfig::Plenoxels(config) => Box::new(Voxels::new(config.clone())),
            FieldConfig::Nerf(config) => Box::new(Nerf::new(config.clone(), seed)),
        }
    }

    /// Metres between two samples of a ray.
    pub fn step_m(&self) -> f32 {
        2.0 / self.samples as f32
    }

    /// What multiplies the optimiser's rates at a step.
    pub fn rate_at(&self, step: usize) -> f32 {
        self.last_rate.powf(step as f32 / self.steps.max(1) as f32)
    }

    /// What no training can do with.
    pub fn check(&self) -> Result<()> {
        ensure!(self.steps > 0, "--steps is 0: train for one step at least");
        Ok(())
    }
}

/// The level of detail at a share of the training: the first half goes through all levels but the last
/// in equal parts.
pub fn level(levels: &[usize], done: f32) -> usize {
    let last = levels.len() - 1;
    levels[((2.0 * done * last as f32) as usize).min(last)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_level_has_half_the_training() {
        let levels = [10, 20, 30];
        let found = [0.0, 0.24, 0.26, 0.49, 0.5, 1.0].map(|done| level(&levels, done));
        assert_eq!(found, [10, 10, 20, 20, 30, 30]);
        assert_eq!(level(&[7], 0.9), 7);
    }

    #[test]
    fn rates_fall_to_the_last() {
        let recipe = Recipe::new(Kind::Plenoxels, Preset::Small);
        assert_eq!(recipe.rate_at(0), 1.0);
        assert!((recipe.rate_at(recipe.steps) - recipe.last_rate).abs() < 1e-6);
    }
}
