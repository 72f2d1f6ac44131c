//! The candidate pool of a plan: generated from a seed, or read from a file.

use std::f32::consts::TAU;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use clap::{Args, ValueEnum};
use serde_json::Value;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::{Pose, Vec3};

use crate::mesh::kit::Chance;
use crate::record::PoolRecord;

/// Distance of the cameras from the object's centre, in radii of its bounding sphere. With
/// [`FOV_X_RAD`] the sphere just fits the picture, and readers of NeRF's synthetic scenes, who take
/// 2 to 6 as near and far, see all of it.
pub const DISTANCE: f32 = 3.0;

/// Horizontal field of view: that of NeRF's synthetic scenes (Mildenhall et al., 2020).
pub const FOV_X_RAD: f32 = 0.691_111_2;

/// More candidates than this would take hours to render.
const MOST_CANDIDATES: usize = 65_536;

/// Candidates, where nothing else is said.
const CANDIDATES: usize = 100;

/// Beyond the elevations that a photographer has reached, so much more is thought within reach.
const MARGIN_DEG: f32 = 15.0;

/// Steeper than this nobody is sent unasked.
const STEEPEST_DEG: f32 = 85.0;

/// The candidate pool. It depends on these alone, so that schemes choose from the same views.
#[derive(Args, Clone, Debug)]
pub struct PoolArgs {
    /// Number of candidate views [default: 100; with --photos at least twice as many as photos]
    #[arg(long, value_name = "N", conflicts_with = "pool")]
    pub candidates: Option<usize>,
    /// Seed of the candidate pool
    #[arg(long, default_value_t = 0, value_name = "K", conflicts_with = "pool")]
    pub pool_seed: u64,
    /// Where candidate views may stand [default: sphere; with --photos hemisphere]
    #[arg(long, value_enum, conflicts_with = "pool")]
    pub space: Option<Space>,
    /// Lowest elevation in degrees, for `hemisphere`, `rings` and `spiral` [default: 5; with --photos
    /// 15 below the lowest photo]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub min_elevation: Option<f32>,
    /// Highest elevation in degrees, likewise [default: 80; with --photos 15 above the highest]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub max_elevation: Option<f32>,
    /// Number of rings, for `rings`; number of turns, for `spiral`
    #[arg(long, default_value_t = 4, value_name = "N")]
    pub rings: usize,
    /// Take the candidates from a JSON file instead: a list of world_from_camera matrices (4 x 4,
    /// OpenGL camera axes), a transforms.json, or a plan.json
    #[arg(long, value_name = "FILE")]
    pub pool: Option<PathBuf>,
}

/// Spaces of views.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Drawn evenly from the whole sphere
    Sphere,
    /// A golden-angle lattice on the whole sphere
    Fibonacci,
    /// A golden-angle lattice between two elevations
    Hemisphere,
    /// Level rings, as from a turntable
    Rings,
    /// One line that winds upwards
    Spiral,
    /// Four of five near one of five places, the rest anywhere, all by chance: uneven, as photos are that
    /// somebody took already
    Clustered,
}

/// Of clustered candidates: the places, and half the width of a cluster's scatter before it is brought
/// to the sphere (a standard deviation of 10 degrees each way).
const PLACES: usize = 5;
const SCATTER: f32 = 0.3;

impl PoolArgs {
    /// The candidates, in order.
    pub fn poses(&self) -> Result<Vec<Pose>> {
        match &self.pool {
            Some(path) => {
                read(path).with_context(|| format!("cannot use the pool {}", path.display()))
            }
            None if self.count() > MOST_CANDIDATES => bail!(
                "{} candidates are too many to render: give --candidates up to {MOST_CANDIDATES}",
                self.count()
            ),
            None => match self.view_space() {
                Some(space) => Ok(Pool::try_new(space, self.count(), DISTANCE)?.iter().collect()),
                None => clustered(self.count(), self.pool_seed),
            },
        }
    }

    /// The same, and what was left open filled in for a capture of so many photos between two
    /// elevations in degrees: where its photographer can get to.
    pub fn around(&self, photos: usize, [lowest, highest]: [f32; 2]) -> Self {
        Self {
            candidates: self.candidates.or(Some(photos.saturating_mul(2).max(CANDIDATES))),
            space: self.space.or(Some(Space::Hemisphere)),
            min_elevation: self.min_elevation.or(Some((lowest - MARGIN_DEG).max(-STEEPEST_DEG))),
            max_elevation: self.max_elevation.or(Some((highest + MARGIN_DEG).min(STEEPEST_DEG))),
            ..self.clone()
        }
    }

    fn count(&self) -> usize {
        self.candidates.unwrap_or(CANDIDATES)
    }

    fn space(&self) -> Space {
        self.space.unwrap_or(Space::Sphere)
    }

    /// Whether another seed gives other candidates.
    pub fn has_chance(&self) -> bool {
        self.pool.is_none() && matches!(self.space(), Space::Sphere | Space::Clustered)
    }

    /// The lowest and highest elevation in degrees, where the space has such.
    pub fn limits_deg(&self) -> Option<[f32; 2]> {
        let between = matches!(self.space(), Space::Hemisphere | Space::Rings | Space::Spiral);
        (between && self.pool.is_none()).then(|| self.elevations_deg())
    }

    fn elevations_deg(&self) -> [f32; 2] {
        [self.min_elevation.unwrap_or(5.0), self.max_elevation.unwrap_or(80.0)]
    }

    /// What the record says of the pool.
    pub fn record(&self) -> PoolRecord {
        let space =
            self.space().to_possible_value().map_or(String::new(), |v| v.get_name().to_owned());
        let between = matches!(self.space(), Space::Hemisphere | Space::Rings | Space::Spiral);
        let wound = matches!(self.space(), Space::Rings | Space::Spiral);
        match &self.pool {
            Some(file) => PoolRecord {
                space: "file".to_owned(),
                file: Some(file.to_string_lossy().into_owned()),
                elevations: None,
                rings: None,
            },
            None => PoolRecord {
                space,
                file: None,
                elevations: between.then(|| self.elevations_deg()),
                rings: wound.then_some(self.rings),
            },
        }
    }

    /// The seed, where there is one.
    pub fn seed(&self) -> Option<u64> {
        self.pool.is_none().then_some(self.pool_seed)
    }

    /// The space as the core knows it; none for clusters.
    fn view_space(&self) -> Option<ViewSpace> {
        let [min_elevation_rad, max_elevation_rad] = self.elevations_deg().map(f32::to_radians);
        Some(match self.space() {
            Space::Sphere => ViewSpace::RandomSphere { seed: self.pool_seed },
            Space::Fibonacci => ViewSpace::FibonacciSphere,
            Space::Hemisphere => ViewSpace::Hemisphere { min_elevation_rad, max_elevation_rad },
            Space::Rings => {
                ViewSpace::Rings { rings: self.rings, min_elevation_rad, max_elevation_rad }
            }
            Space::Spiral => {
                let turns = self.rings as f32;
                ViewSpace::Spiral { turns, min_elevation_rad, max_elevation_rad }
            }
            Space::Clustered => return None,
        })
    }
}

/// So many poses of [`Space::Clustered`].
fn clustered(count: usize, seed: u64) -> Result<Vec<Pose>> {
    let mut chance = Chance::new(seed);
    let mut anywhere = move || {
        let (height, turn) = (chance.between(-1.0, 1.0), chance.between(0.0, TAU));
        let (sin, cos) = turn.sin_cos();
        (Vec3::new(cos, sin, 0.0) * (1.0 - height * height).sqrt()).with_z(height)
    };
    let places: Vec<Vec3> = (0..PLACES).map(|_| anywhere()).collect();
    let mut chance = Chance::new(!seed);
    let poses = (0..count).map(|number| {
        let [x, y, z] = [(); 3].map(|()| chance.between(-SCATTER, SCATTER));
        let place = places[chance.below(PLACES as u32) as usize];
        let direction = if number % 5 == 4 { anywhere() } else { place + Vec3::new(x, y, z) };
        Ok(Pose::looking_at(direction.normalize() * DISTANCE, Vec3::ZERO)?)
    });
    poses.collect()
}

/// The poses of a file: see [`PoolArgs::pool`].
pub(crate) fn read(path: &Path) -> Result<Vec<Pose>> {
    let text =
        std::fs::read_to_string(path).map_err(|error| anyhow!("it cannot be read: {error}"))?;
    let value: Value =
        serde_json::from_str(&text).map_err(|error| anyhow!("it is not JSON: {error}"))?;
    let entries = ["frames", "views"]
        .iter()
        .find_map(|key| value.get(key))
        .unwrap_or(&value)
        .as_array()
        .context("it holds no list of poses")?;
    if entries.is_empty() {
        bail!("its list of poses is empty");
    }
    let pose = |(index, entry): (usize, &Value)| {
        let matrix =
            ["transform_matrix", "world_from_camera"].iter().find_map(|key| entry.get(key));
        pose_of(matrix.unwrap_or(entry)).with_context(|| format!("pose {index} is wrong"))
    };
    entries.iter().enumerate().map(pose).collect()
}

fn pose_of(matrix: &Value) -> Result<Pose> {
    let rows: Vec<Vec<f32>> = serde_json::from_value(matrix.clone())
        .map_err(|_| anyhow!("it is not a matrix of numbers"))?;
    let row = |index: usize| -> Option<[f32; 4]> { rows.get(index)?.as_slice().try_into().ok() };
    let (Some(a), Some(b), Some(c), 3..=4) = (row(0), row(1), row(2), rows.len()) else {
        bail!("it is not a matrix of shape (4, 4) or (3, 4)");
    };
    Ok(Pose::try_from_rows([a, b, c])?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file_with(text: &str) -> (tempfile::TempDir, PathBuf) {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("pool.json");
        std::fs::write(&path, text).unwrap();
        (home, path)
    }

    #[test]
    fn poses_come_from_a_list_a_transforms_or_a_plan() {
        let matrix = "[[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]";
        for text in [
            format!("[{matrix}]"),
            format!(r#"{{"frames": [{{"transform_matrix": {matrix}}}]}}"#),
            format!(r#"{{"views": [{{"world_from_camera": {matrix}}}]}}"#),
        ] {
            let (_home, path) = file_with(&text);
            let poses = read(&path).unwrap();
            assert_eq!(poses.len(), 1);
            assert_eq!(poses[0].position().z, 3.0);
        }
    }

    #[test]
    fn clusters_are_uneven_and_drawn_by_their_seed() {
        let poses = clustered(100, 7).unwrap();
        assert_eq!(poses, clustered(100, 7).unwrap());
        assert_ne!(poses, clustered(100, 8).unwrap());
        let near = |a: &Pose, b: &Pose| a.position().angle_between(b.position()) < 0.35;
        let crowd = |a: &Pose| poses.iter().filter(|b| near(a, b)).count();
        // Evenly drawn, a view has three others within 20 degrees: 400 in all, each itself counted.
        let crowds: usize = poses.iter().map(crowd).sum();
        assert!((800..2_500).contains(&crowds), "{crowds}");
        let far = poses.iter().map(|a| a.position().length());
        assert!(far.into_iter().all(|far| (far - DISTANCE).abs() < 1e-4));
    }

    #[test]
    fn a_wrong_pose_is_named() {
        let fine = "[[1,0,0,0],[0,1,0,0],[0,0,1,3]]";
        let doubled = "[[2,0,0,0],[0,2,0,0],[0,0,2,3]]";
        for (text, says) in [
            (format!("[{fine}, {doubled}]"), "pose 1"),
            (format!("[{fine}, [1, 2]]"), "pose 1"),
            ("[]".to_owned(), "empty"),
            ("{}".to_owned(), "no list"),
            ("{".to_owned(), "not JSON"),
        ] {
            let (_home, path) = file_with(&text);
            let error = format!("{:#}", read(&path).unwrap_err());
            assert!(error.contains(says), "{error}");
        }
    }
}
