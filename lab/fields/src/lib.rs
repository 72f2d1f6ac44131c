//! Radiance fields trained on planned views, and what schemes are worth by them.
//!
//! ```text
//! photos -> volume, occupancy -> voxels, tensorf, nerf -> recipe -> train -> evaluate -> page, fly
//!                                  nerf -> variance -> active -> subject -> evaluate
//! ```
//!
//! One [trainer and renderer](train) serves three [kinds](recipe::Kind) of fields. The two grids have
//! their derivatives written by hand, each checked against finite differences; the network uses burn.
//! burn was measured for the grids too: see `examples/burn_grid.rs`, which trains nothing but does
//! what a voxel grid asks of a step (figures in its first lines).
//!
//! A field is trained on one thread, so that the same seed gives the same field; several are trained
//! side by side. The `paper` presets have the papers' sizes and no GPU: they take many hours.
//!
//! Photos come from the lab's renderer, on white; test views lie on a [circle](photos::test_circle). Or
//! both come from a [folder](subject) like those of NeRF's synthetic scenes. Beside the schemes of the
//! lab stands [ActiveNeRF](active), which trains a network to choose, at a small size.
//!
//! ```
//! use vantage_core::Camera;
//! use vantage_fields::photos::{dense_views, test_circle};
//! use vantage_fields::recipe::{Kind, Preset, Recipe};
//! use vantage_fields::{metrics, scene, train::Trainer};
//!
//! let camera = Camera::from_fov(24, 24, 0.69)?;
//! let photos = scene::photos(camera, dense_views(12)?)?;
//! let recipe = Recipe { steps: 20, rays: 128, samples: 32, ..Recipe::new(Kind::Tensorf, Preset::Small) };
//! let mut trainer = Trainer::new(&recipe, &photos, 0);
//! while !trainer.is_over() {
//!     trainer.advance();
//! }
//! let test = scene::photos(camera, test_circle(1)?)?;
//! let found = trainer.render(&camera, &test.poses);
//! assert!(metrics::psnr(&found[0], &test.pictures[0]) > 10.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod active;
mod adam;
pub mod ceiling;
#[cfg(test)]
mod checks;
pub mod evaluate;
pub mod field;
mod fly;
mod grid;
mod harmonics;
pub mod lpips;
pub mod metrics;
pub mod nerf;
pub mod occupancy;
pub mod one;
mod page;
pub mod photos;
pub mod plans;
pub mod recipe;
pub mod results;
pub mod runs;
pub mod scene;
pub mod study;
pub mod subject;
pub mod summary;
pub mod tensorf;
pub mod train;
mod variance;
pub mod volume;
pub mod voxels;
