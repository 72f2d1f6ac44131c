//! Which encoder? Trains networks that differ in their encoder alone, on equal terms, and tells how
//! well each plans.
//!
//! ```sh
//! cargo vantage dataset --objects 320 --seed 5 --resolution 128 --views 64 --validation-views 1 \
//!     --steps 16 --out DATA
//! cargo run --release -p vantage-train --example encoders -- DATA RUNS
//! ```
//!
//! An interrupted study continues. What the encoders cost on a Cortex-M is counted by
//! `cargo xtask bench kernels`; `lab/ENCODERS.md` has both.

use std::env;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use burn::tensor::Device;
use vantage_lab::dataset::{Dataset, Split};
use vantage_train::fit::{self, Recipe, Run};
use vantage_train::measure::{Measured, measure_drawn};
use vantage_train::net::{Build, Shape};
use vantage_train::samples::{self, Object};

/// Passes over the training objects.
const EPOCHS: usize = 16;
/// Captures in a step: fewer than for the shipped network, as there are fewer objects.
const BATCH: usize = 4;
const SEEDS: [u64; 2] = [1, 2];
/// Walks of each held-out object that are measured.
const WALKS: usize = 2;

/// Encoders by name, as the counts have them; the shipped one first.
const ENCODERS: [(&str, Build, [usize; 4]); 4] = [
    ("plain-16-16-32-48", Build::Plain, [16, 16, 32, 48]),
    ("plain-8-8-16-24", Build::Plain, [8, 8, 16, 24]),
    ("halved-16-16-32-48", Build::Halved, [16, 16, 32, 48]),
    ("separable-16-16-32-48", Build::Separable, [16, 16, 32, 48]),
];

fn main() -> Result<()> {
    let mut arguments = env::args_os().skip(1).map(PathBuf::from);
    let data = arguments.next().context("name the data set, then a folder for the runs")?;
    let runs = arguments.next().context("name a folder for the runs, after the data set")?;
    let dataset = Dataset::open(&data)?;
    let load = |split| samples::load(&dataset, split, None, true, || {});
    let (train, validation) = (load(Split::Train)?, load(Split::Validation)?);
    let test = load(Split::Test)?;
    let study = Study {
        data: serde_json::to_string(&dataset.manifest().parameters)?,
        runs,
        train,
        validation,
        test,
    };
    println!("{:24} {:>4}  {:^31}  {:^31}", "encoder", "seed", "rank correlation", "closed gap");
    let shapes = ENCODERS
        .map(|(name, build, channels)| (name, Shape { build, channels, ..Shape::default() }));
    let poses = ("no photos", Shape::default().without_photos());
    // Seed by seed, so that an unfinished study compares equals too.
    for seed in SEEDS {
        for (name, shape) in shapes.iter().chain([&poses]) {
            let measured = study.run(name, *shape, seed)?;
            let row = |values: [f32; 4]| {
                let mean = values.iter().sum::<f32>() / 4.0;
                values.iter().chain([&mean]).map(|value| format!("{value:6.3}")).collect::<String>()
            };
            let (correlation, gap) = (row(measured.spearman), row(measured.share));
            println!("{name:24} {seed:>4} {correlation}   {gap}");
        }
    }
    Ok(())
}

struct Study {
    data: String,
    runs: PathBuf,
    train: Vec<Object>,
    validation: Vec<Object>,
    test: Vec<Object>,
}

impl Study {
    /// Trains, or goes on where it ended; measures the epoch that was best on the validation objects on
    /// the test objects, with the outlines that the network draws.
    fn run(&self, name: &str, shape: Shape, seed: u64) -> Result<Measured> {
        let recipe = Recipe { shape, epochs: EPOCHS, batch: BATCH, seed, ..Recipe::default() };
        let folder = self.runs.join(Path::new(&format!("{name}-{seed}").replace(' ', "-")));
        let (run, course) = Run::open(&folder, &recipe, &self.data)?;
        let device = Device::flex();
        fit::fit(&run, course, &self.train, &self.validation, &device)?;
        let net = fit::load_network(&shape, &run.best_file(), &device)?;
        Ok(measure_drawn(&net, &self.test, WALKS, &device))
    }
}
