//! What a radiance field is to the trainer and the renderer.
//!
//! A field gives raw numbers; [`volume`](crate::volume) turns them into optical depth and colour.
//! Raw numbers of 0 mean the same in every field, a thin grey fog, and so every field starts alike.

use std::path::Path;

use anyhow::Result;
use vantage_core::Vec3;

/// A density and a colour at every point and direction.
///
/// Calls come in this order: [`density`](Self::density), [`colour`](Self::colour) for some of its
/// points, and, to learn, [`accumulate`](Self::accumulate) and [`advance`](Self::advance). A field
/// remembers what the later calls need of the earlier.
pub trait Field: Send {
    /// Raw density at points within the unit sphere; shape (points).
    fn density(&mut self, points: &[Vec3]) -> Vec<f32>;

    /// Raw colour of some of those points, `shown`, each looked at along a unit direction; shape
    /// (shown, 3).
    fn colour(&mut self, shown: &[u32], directions: &[Vec3]) -> Vec<[f32; 3]>;

    /// Takes the loss's derivatives by what the two calls before gave.
    fn accumulate(&mut self, by_density: &[f32], by_colour: &[[f32; 3]]);

    /// One step of the optimiser, its rates multiplied by `rate`.
    fn advance(&mut self, rate: f32);

    /// Goes on at the level of detail that belongs to a share of the training that is done.
    fn refine(&mut self, done: f32);

    /// Writes parameters and the optimiser's state into a folder.
    fn save(&self, folder: &Path) -> Result<()>;

    /// Reads what [`save`](Self::save) wrote for a field of the same configuration.
    fn load(&mut self, folder: &Path) -> Result<()>;
}
