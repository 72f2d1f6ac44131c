//! What a plan looks like: a page to read, a sheet of its photos, plots of its scores.
//!
//! [`Report::write`] puts three files into a folder:
//!
//! - `report.html` asks nothing of the network and adapts to light, dark and narrow screens;
//! - `contact_sheet.png`, the chosen photos in order;
//! - `scores.svg`, the scores by number of views.
//!
//! Everything is drawn from the [record](crate::record), so a report never says what the plan's JSON
//! does not.

pub mod contact_sheet;
pub mod dome;
pub mod html;
mod palette;
pub mod photos;
pub mod plot;
pub mod svg;
mod trainers;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use image::RgbaImage;
use vantage_core::Vec3;

use crate::export::Profile;
use crate::record::{Curve, PlanRecord};

/// All that a report shows.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// The plan.
    pub plan: &'a PlanRecord,
    /// The photos of its views, shape (views), straight alpha.
    pub photos: &'a [RgbaImage],
    /// The camera centres of the whole pool, world, metres, shape (candidates).
    pub candidates: &'a [Vec3],
    /// Scores by number of views: first the plan's own curve, then those to compare it with.
    /// May be empty; then there are no plots.
    pub curves: &'a [Curve],
    /// The folder's layout, which decides how each trainer is called.
    pub profile: Profile<'a>,
    /// The folder as its user calls it.
    pub folder: &'a str,
    /// The command that makes this plan again, to be shown and copied.
    pub command: &'a str,
}

impl Report<'_> {
    /// Writes `report.html`, `contact_sheet.png` and, if there are curves, `scores.svg`.
    ///
    /// Fails if the numbers of photos and views differ, or if a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        self.check()?;
        save(&folder.join("report.html"), html::page(self)?.as_bytes())?;
        let sheet = contact_sheet::draw(self.plan, self.photos);
        let path = folder.join("contact_sheet.png");
        sheet.save(&path).with_context(|| format!("cannot write {}", path.display()))?;
        if !self.curves.is_empty() {
            save(&folder.join("scores.svg"), plot::scores_svg(self.curves)?.as_bytes())?;
        }
        Ok(())
    }

    fn check(&self) -> Result<()> {
        ensure!(
            self.photos.len() == self.plan.views.len(),
            "a report needs a photo for each view: there are {} photos and {} views",
            self.photos.len(),
            self.plan.views.len()
        );
        let empty = self.photos.iter().position(|photo| photo.width() == 0 || photo.height() == 0);
        if let Some(index) = empty {
            anyhow::bail!("photo {index} has no pixels");
        }
        Ok(())
    }
}

fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests;
