//! `cargo vantage dataset`: views of many objects, exactly labelled, to train on.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::Args;
use vantage_core::objectives::Reading;

use crate::dataset::{self, HELD_OUT_CLASSES, Parameters, Split};
use crate::label::RESOLUTION;

/// Options of `dataset`.
#[derive(Args, Clone, Debug)]
pub struct DatasetArgs {
    /// Folder to write: manifest.json and a shard for each object; an interrupted run continues
    #[arg(long, short, value_name = "DIR")]
    pub out: PathBuf,
    /// Number of objects [default: 640, or all of --from]
    #[arg(long, value_name = "N")]
    pub objects: Option<usize>,
    /// Seed of objects, views and walks
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub seed: u64,
    /// Take the GLB, glTF and OBJ files of this folder instead of objects made here
    #[arg(long, value_name = "DIR")]
    pub from: Option<PathBuf>,
    /// Width and height of photos and masks in pixels
    #[arg(long, default_value_t = 64, value_name = "PIXELS")]
    pub image_size: u32,
    /// Width and height of the face-id images behind the exact scores, in pixels; `plan` scores at
    /// the default, half of it takes half the time
    #[arg(long, default_value_t = RESOLUTION, value_name = "PIXELS")]
    pub resolution: u32,
    /// Random walks over the train views of each object
    #[arg(long, default_value_t = 4, value_name = "N")]
    pub trajectories: usize,
    /// Views of each walk
    #[arg(long, default_value_t = 30, value_name = "N")]
    pub steps: usize,
    /// Train views of each object; as many validation views, twice as many test views
    #[arg(long, default_value_t = 100, value_name = "N")]
    pub views: usize,
    /// Validation views of each object, where another number is wanted: training looks at none of
    /// them, and without most of them an object takes half the time and room
    #[arg(long, value_name = "N")]
    pub validation_views: Option<usize>,
    /// Threads [default: one for each processor]; the data do not depend on it
    #[arg(long, value_name = "N")]
    pub jobs: Option<usize>,
}

/// Makes the data set, or the rest of it.
pub fn run(args: &DatasetArgs) -> Result<()> {
    let parameters = parameters_of(args)?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(args.jobs.unwrap_or(0))
        .build()
        .context("cannot start threads")?;
    let start = Instant::now();
    let bar = super::progress("objects", parameters.objects);
    let from = args.from.as_deref();
    let written =
        threads.install(|| dataset::write(&args.out, from, &parameters, || bar.inc(1)))?;
    bar.finish_and_clear();

    let seconds = start.elapsed().as_secs_f64();
    let objects = &written.manifest.objects;
    let count = |split| objects.iter().filter(|entry| entry.split == split).count();
    println!(
        "{} objects ({} train, {} validation, {} test), {:.1} MB, {:.2} MB an object",
        objects.len(),
        count(Split::Train),
        count(Split::Validation),
        count(Split::Test),
        written.bytes as f64 / 1e6,
        written.bytes as f64 / 1e6 / objects.len() as f64,
    );
    if args.from.is_none() {
        println!("never trained on: {}", HELD_OUT_CLASSES.join(", "));
    }
    let made = objects.len() - written.kept;
    println!(
        "made {made} and kept {} in {seconds:.1} s: {:.0} objects a minute",
        written.kept,
        made as f64 * 60.0 / seconds
    );
    eprintln!("wrote {}", args.out.display());
    Ok(())
}

fn parameters_of(args: &DatasetArgs) -> Result<Parameters> {
    let mut files = Vec::new();
    if let Some(folder) = &args.from {
        files = dataset::files_of(folder)?;
        if files.is_empty() {
            bail!("{} holds no GLB, glTF or OBJ file", folder.display());
        }
        files.truncate(args.objects.unwrap_or(usize::MAX));
    }
    if args.objects == Some(0) {
        bail!("a data set has at least one object");
    }
    Ok(Parameters {
        objects: if args.from.is_some() { files.len() } else { args.objects.unwrap_or(640) },
        seed: args.seed,
        image_size: args.image_size,
        resolution: args.resolution,
        train_views: args.views,
        validation_views: args.validation_views.unwrap_or(args.views),
        test_views: args.views.saturating_mul(2),
        trajectories: args.trajectories,
        steps: args.steps,
        reading: Reading::default(),
        files,
    })
}
