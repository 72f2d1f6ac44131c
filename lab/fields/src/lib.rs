//! Radiance fields trained on planned views, and what schemes are worth by them.
pub mod adam;
#[cfg(test)]
mod checks;
pub mod evaluate;
pub mod field;
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
pub mod runs;
pub mod scene;
pub mod summary;
pub mod tensorf;
pub mod train;
pub mod volume;
pub mod voxels;
