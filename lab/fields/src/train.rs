//! The trainer and the renderer of all fields.
//!
//! A step takes rays by chance from all photos, looks along them, and lowers the mean squared
//! difference of colours. Everything drawn by chance depends on the seed and the number of the step,
//! so that an interrupted training goes on as if nothing had happened.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use vantage_core::{Camera, Pose};

use crate::field::Field;
use crate::occupancy::Occupancy;
use crate::photos::{Photos, Picture, Ray, rays_of};
use crate::recipe::Recipe;
use crate::volume::{Samples, look};

/// Steps from one look for empty space to the next; trainings can be interrupted there.
pub const EVERY: usize = 50;

/// Rays that are rendered at once.
const RENDERED: usize = 4096;

/// The rays of a step, and the source of what else it leaves to chance.
pub(crate) fn draw(
    rays: &[(Ray, [f32; 3])],
    recipe: &Recipe,
    seed: u64,
    step: usize,
) -> (Vec<(Ray, [f32; 3])>, Pcg64) {
    let mut chance = Pcg64::seed_from_u64(seed ^ (step as u64 + 1) << 32);
    let drawn = (0..recipe.rays.min(rays.len()))
        .map(|_| rays[chance.random_range(0..rays.len())])
        .collect();
    (drawn, chance)
}

/// A field and how far its training is.
pub struct Trainer {
    recipe: Recipe,
    seed: u64,
    rays: Vec<(Ray, [f32; 3])>,
    field: Box<dyn Field>,
    occupancy: Occupancy,
    step: usize,
}

impl Trainer {
    /// Nothing is trained yet.
    pub fn new(recipe: &Recipe, photos: &Photos, seed: u64) -> Self {
        Self {
            field: recipe.field(seed),
            rays: photos.rays(),
            recipe: recipe.clone(),
            seed,
            occupancy: Occupancy::full(),
            step: 0,
        }
    }

    /// Steps that are done.
    pub fn step(&self) -> usize {
        self.step
    }

    /// The field.
    pub fn field(&self) -> &dyn Field {
        &*self.field
    }

    /// Goes on from a field that was saved after so many steps, a multiple of [`EVERY`].
    pub fn resume(
        &mut self,
        step: usize,
        load: impl FnOnce(&mut dyn Field) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        load(&mut *self.field)?;
        self.step = step;
        Ok(())
    }

    /// Whether all steps are done.
    pub fn is_over(&self) -> bool {
        self.step >= self.recipe.steps
    }

    /// One step; gives the mean squared difference before it.
    pub fn advance(&mut self) -> f32 {
        if self.step.is_multiple_of(EVERY) {
            self.field.refine(self.step as f32 / self.recipe.steps as f32);
            // The first rounds have not told fog from nothing yet.
            if self.step > 0 {
                self.occupancy = Occupancy::of(&mut *self.field, self.recipe.step_m());
            }
        }
        let (drawn, mut chance) = draw(&self.rays, &self.recipe, self.seed, self.step);
        let rays: Vec<Ray> = drawn.iter().map(|(ray, _)| *ray).collect();
        let samples =
            Samples::along(&rays, &self.occupancy, self.recipe.step_m(), || chance.random());
        let seen = look(&mut *self.field, &rays, &samples);
        let scale = 1.0 / (3 * rays.len().max(1)) as f32;
        let mut loss = 0.0;
        let difference = |(found, (_, wanted)): (&[f32; 3], &(Ray, [f32; 3]))| {
            std::array::from_fn(|c| {
                let difference = found[c] - wanted[c];
                loss += difference * difference * scale;
                2.0 * difference * scale
            })
        };
        let by_ray: Vec<[f32; 3]> = seen.colours.iter().zip(&drawn).map(difference).collect();
        let slopes = seen.slopes(&samples, &by_ray);
        self.field.accumulate(&slopes.by_density, &slopes.by_colour);
        self.field.advance(self.recipe.rate_at(self.step));
        self.step += 1;
        loss
    }

    /// Pictures from other places.
    pub fn render(&mut self, camera: &Camera, poses: &[Pose]) -> Vec<Picture> {
        let step = self.recipe.step_m();
        let occupancy = Occupancy::of(&mut *self.field, step);
        let mut picture = |pose: &Pose| {
            let rays = rays_of(camera, pose);
            let mut pixels = Vec::with_capacity(rays.len());
            for rays in rays.chunks(RENDERED) {
                let samples = Samples::along(rays, &occupancy, step, || 0.5);
                pixels.extend(look(&mut *self.field, rays, &samples).colours);
            }
            Picture { width: camera.width as usize, pixels }
        };
        poses.iter().map(&mut picture).collect()
    }
}
