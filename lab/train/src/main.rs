//! Trains SOARNet, exports it and quantises it.

use std::path::PathBuf;

use anyhow::Result;
use burn::tensor::Device;
use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use vantage_lab::dataset::{Dataset, Split};
use vantage_train::fit::{self, Recipe, Run};
use vantage_train::measure::measure;
use vantage_train::samples;

#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Train(TrainArgs),
}

/// Ready recipes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// What is shipped
    Default,
    /// The same without photos: what poses alone tell
    Poses,
    /// The paper's wording: mean over views, cumulative targets
    Literal,
}

/// Train a network on a data set
#[derive(Args, Clone, Debug)]
struct TrainArgs {
    /// The data set: see `cargo vantage dataset`
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Folder of the run; an interrupted run continues
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// Recipe to start from
    #[arg(long, value_enum, default_value = "default")]
    preset: Preset,
    /// Passes over the training objects
    #[arg(long, value_name = "N")]
    epochs: Option<usize>,
    /// Captures in a step
    #[arg(long, value_name = "N")]
    batch: Option<usize>,
    /// Highest learning rate
    #[arg(long, value_name = "RATE")]
    rate: Option<f64>,
    /// Weight of the listwise loss
    #[arg(long, value_name = "W")]
    listwise: Option<f32>,
    /// Seed of weights, order and augmentation
    #[arg(long, value_name = "K")]
    seed: Option<u64>,
}

fn main() -> Result<()> {
    match Cli::parse().command {
        Command::Train(args) => train(&args),
    }
}

fn train(args: &TrainArgs) -> Result<()> {
    let mut recipe = match args.preset {
        Preset::Default => Recipe::default(),
        Preset::Literal => Recipe::literal(),
        Preset::Poses => {
            let mut recipe = Recipe::default();
            recipe.shape.embedding = 0;
            recipe
        }
    };
    recipe.epochs = args.epochs.unwrap_or(recipe.epochs);
    recipe.batch = args.batch.unwrap_or(recipe.batch);
    recipe.rate = args.rate.unwrap_or(recipe.rate);
    recipe.listwise = args.listwise.unwrap_or(recipe.listwise);
    recipe.seed = args.seed.unwrap_or(recipe.seed);

    let dataset = Dataset::open(&args.data)?;
    let (run, course) =
        Run::open(&args.out, &recipe, &serde_json::to_string(&dataset.manifest().parameters)?)?;
    let bar = ProgressBar::new(dataset.len() as u64)
        .with_style(ProgressStyle::with_template("reading {bar:30} {pos}/{len}")?);
    let load = |split| samples::load(&dataset, split, || bar.inc(1));
    let (train, validation) = (load(Split::Train)?, load(Split::Validation)?);
    bar.finish_and_clear();
    let device = Device::flex();
    let course = fit::fit(&run, course, &train, &validation, &device)?;
    let net = fit::load_network(&recipe.shape, &run.best_file(), &device)?;
    let best = measure(&net, &validation, 4, &device);
    println!("best epoch {:?}: {best:?}", course.best().map(|best| best.epoch));
    Ok(())
}
