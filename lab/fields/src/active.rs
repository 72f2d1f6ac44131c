//! ActiveNeRF (Pan et al., 2022) at a small size: views where a network is least sure.
//!
//! ```text
//! the first `start` views by farthest-point sampling
//! until there are enough views:
//!     train the network with its variances on all photos so far, `steps` steps
//!     take the photos of the `each` candidates with the largest gain
//! ```
//!
//! `variance` has the loss and the gain; a candidate's is the sum over a coarse picture of it. The `each`
//! candidates are taken by that one ranking, as the authors take them. No choice depends on how many follow, so a plan begins with every smaller one.
//!
//! Where the SO-NeRF paper's setting differs: it trains 200,000 steps at the authors' size on a GPU, 5
//! seed views it does not name, then 5 more every 40,000. Here are 5 and 5 too, but a network of the
//! `small` preset, photos of its size, and [`Active::default`]'s steps; the seed views are the first
//! that `fps` takes. It says what the method chooses at this size, not what it could at theirs.

use std::time::Instant;

use anyhow::{Result, bail, ensure};
use rand::RngExt;
use vantage_core::planner::Plan;
use vantage_core::{Camera, Pose};
use vantage_lab::blind;

use crate::field::Field;
use crate::nerf::{self, Nerf};
use crate::occupancy::Occupancy;
use crate::photos::{Photos, Ray, rays_of};
use crate::plans::Views;
use crate::recipe::{FieldConfig, Kind, Preset, Recipe};
use crate::train::{EVERY, draw};
use crate::variance::Sight;
use crate::volume::{Samples, look};

/// The name of the scheme.
pub const NAME: &str = "activenerf";

/// How views are chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Active {
    /// Of a NeRF; rates fall over its steps.
    pub recipe: Recipe,
    /// Views before the first training.
    pub start: usize,
    /// Views that are added after each.
    pub each: usize,
    /// Steps of each training.
    pub steps: usize,
    /// Side of the coarse pictures, pixels.
    pub side: u32,
}

impl Default for Active {
    fn default() -> Self {
        let steps = 500;
        let recipe = Recipe::new(Kind::Nerf, Preset::Small);
        Self { recipe: Recipe { steps: 5 * steps, ..recipe }, start: 5, each: 5, steps, side: 20 }
    }
}

impl Active {
    /// The views of a budget, from candidates whose photos `take` takes.
    pub fn views(
        &self,
        poses: &[Pose],
        take: impl Fn(&[usize]) -> Photos,
        budget: usize,
        seed: u64,
    ) -> Result<Views> {
        let FieldConfig::Nerf(config) = &self.recipe.field else {
            bail!("{NAME} trains a NeRF and no other field");
        };
        let start = Instant::now();
        let first = budget.min(self.start);
        let plan = Plan::farthest_point(first).with_seed(seed);
        let mut chosen = blind::views(poses, plan)?;
        let mut seconds = vec![start.elapsed().as_secs_f64(); chosen.len()];
        let mut learner = Learner::new(&self.recipe, config, seed);
        let mut learnt = 0;
        while chosen.len() < budget {
            let photos = take(&chosen[learnt..]);
            learnt = chosen.len();
            learner.see(&photos);
            for _ in 0..self.steps {
                let loss = learner.advance();
                ensure!(loss.is_finite(), "the loss of {NAME} is no longer finite");
            }
            let coarse = photos.camera.resized(self.side, self.side)?;
            learner.look_for_space();
            let mut gains: Vec<(usize, f64)> = (0..poses.len())
                .filter(|index| !chosen.contains(index))
                .map(|index| (index, learner.gain(&coarse, &poses[index])))
                .collect();
            ensure!(!gains.is_empty(), "no candidate is left for {NAME}");
            // Stable: ties go to the lowest index.
            gains.sort_by(|a, b| b.1.total_cmp(&a.1));
            gains.truncate(self.each.min(budget - chosen.len()));
            chosen.extend(gains.iter().map(|(index, _)| *index));
            seconds.resize(chosen.len(), start.elapsed().as_secs_f64());
        }
        Ok(Views {
            poses: chosen.iter().map(|&index| poses[index]).collect(),
            candidates: Some(chosen),
            seconds,
        })
    }
}

/// A network with variances, and the photos that it is trained on.
struct Learner {
    recipe: Recipe,
    seed: u64,
    network: Nerf,
    occupancy: Occupancy,
    rays: Vec<(Ray, [f32; 3])>,
    step: usize,
}

impl Learner {
    fn new(recipe: &Recipe, config: &nerf::Config, seed: u64) -> Self {
        Self {
            recipe: recipe.clone(),
            seed,
            network: Nerf::with_variance(config.clone(), seed),
            occupancy: Occupancy::full(),
            rays: Vec::new(),
            step: 0,
        }
    }

    /// Trains on more photos from now on.
    fn see(&mut self, photos: &Photos) {
        self.rays.extend(photos.rays());
    }

    /// Finds out which space is empty.
    fn look_for_space(&mut self) {
        self.occupancy = Occupancy::of(&mut self.network, self.recipe.step_m());
    }

    /// One step; gives the loss before it.
    fn advance(&mut self) -> f32 {
        if self.step > 0 && self.step.is_multiple_of(EVERY) {
            self.look_for_space();
        }
        let (drawn, mut chance) = draw(&self.rays, &self.recipe, self.seed, self.step);
        let (rays, truth): (Vec<Ray>, Vec<[f32; 3]>) = drawn.into_iter().unzip();
        let step = self.recipe.step_m();
        let samples = Samples::along(&rays, &self.occupancy, step, || chance.random());
        let loss = self.sight(&rays, &samples).loss(&samples, &truth);
        let (slopes, by_variance) = (&loss.slopes, &loss.by_variance);
        self.network.accumulate_all(&slopes.by_density, &slopes.by_colour, by_variance);
        let done = self.step.min(self.recipe.steps);
        self.network.advance(self.recipe.rate_at(done));
        self.step += 1;
        loss.value
    }

    fn sight(&mut self, rays: &[Ray], samples: &Samples) -> Sight {
        let seen = look(&mut self.network, rays, samples);
        let raw = self.network.variance();
        Sight::new(seen, raw, samples)
    }

    /// How much variance a photo is expected to take away.
    fn gain(&mut self, camera: &Camera, pose: &Pose) -> f64 {
        let (sight, samples) = self.sees(camera, pose);
        sight.gain(&samples)
    }

    fn sees(&mut self, camera: &Camera, pose: &Pose) -> (Sight, Samples) {
        let rays = rays_of(camera, pose);
        let samples = Samples::along(&rays, &self.occupancy, self.recipe.step_m(), || 0.5);
        (self.sight(&rays, &samples), samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photos::dense_views;
    use crate::scene;
    use vantage_core::Vec3;

    fn small() -> Active {
        let config = nerf::Config {
            layers: 3,
            width: 24,
            position_frequencies: 3,
            direction_frequencies: 1,
            rate: 5e-3,
        };
        let recipe = Recipe {
            steps: 300,
            rays: 256,
            samples: 32,
            last_rate: 0.3,
            field: FieldConfig::Nerf(config),
        };
        Active { recipe, start: 3, each: 2, steps: 60, side: 8 }
    }

    fn camera() -> Camera {
        Camera::from_fov(24, 24, 0.69).unwrap()
    }

    fn chosen(budget: usize, seed: u64) -> Vec<usize> {
        let poses = dense_views(14).unwrap();
        let take = |indices: &[usize]| {
            scene::photos(camera(), indices.iter().map(|&index| poses[index]).collect()).unwrap()
        };
        let views = small().views(&poses, take, budget, seed).unwrap();
        assert!(views.seconds.is_sorted() && views.seconds.len() == budget);
        views.candidates.unwrap()
    }

    #[test]
    fn a_seed_gives_one_plan_that_begins_with_every_smaller_one() {
        let whole = chosen(8, 1);
        assert_eq!(whole, chosen(8, 1));
        for budget in [2, 4, 5] {
            assert_eq!(chosen(budget, 1), whole[..budget]);
        }
        assert_ne!(chosen(8, 2), whole);
        let poses = dense_views(14).unwrap();
        let fps = blind::views(&poses, Plan::farthest_point(3).with_seed(1)).unwrap();
        assert_eq!(whole[..3], fps);
        let mut each = whole.clone();
        each.sort_unstable();
        each.dedup();
        assert_eq!(each.len(), 8);
    }

    #[test]
    fn variance_falls_where_rays_have_been_seen() {
        let Active { recipe, .. } = small();
        let FieldConfig::Nerf(config) = &recipe.field else { panic!() };
        let all = dense_views(40).unwrap();
        let seen_from = |side: f32| -> Vec<Pose> {
            let from = |pose: &&Pose| side * pose.position().dot(Vec3::X) > 1.5;
            all.iter().filter(from).copied().collect()
        };
        let (near, far) = (seen_from(1.0), seen_from(-1.0));
        let mut learner = Learner::new(&recipe, config, 0);
        learner.see(&scene::photos(camera(), near.clone()).unwrap());
        let mean = |learner: &mut Learner, poses: &[Pose]| -> f32 {
            let of = |pose| learner.sees(&camera(), pose).0.of_what_is_seen();
            poses.iter().map(of).sum::<f32>() / poses.len() as f32
        };
        let before = [mean(&mut learner, &near), mean(&mut learner, &far)];
        for _ in 0..300 {
            learner.advance();
        }
        let after = [mean(&mut learner, &near), mean(&mut learner, &far)];
        assert!(after[0] < 0.5 * before[0], "{before:?} -> {after:?}");
        assert!(after[0] < 0.8 * after[1], "{before:?} -> {after:?}");
        let gain = |learner: &mut Learner, poses: &[Pose]| -> f64 {
            poses.iter().map(|pose| learner.gain(&camera(), pose)).sum::<f64>() / poses.len() as f64
        };
        let gains = [gain(&mut learner, &near), gain(&mut learner, &far)];
        assert!(gains[0] < gains[1], "{gains:?}");
    }
}
