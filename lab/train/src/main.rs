//! Trains SOARNet, exports it and quantises it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, ensure};
use burn::tensor::Device;
use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use vantage_lab::dataset::{Dataset, Split};
use vantage_train::card::{self, Card, Figures};
use vantage_train::fit::{self, Recipe, Run};
use vantage_train::measure::measure;
use vantage_train::net::Build;
use vantage_train::reference::Reference;
use vantage_train::{onnx, plot, quantize, samples};

#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Train(TrainArgs),
    Export(ExportArgs),
    Quantize(QuantizeArgs),
    Card(CardArgs),
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

/// Write a trained network as ONNX
#[derive(Args, Clone, Debug)]
struct ExportArgs {
    /// Folder of the run: see `cargo vantage train`
    run: PathBuf,
    /// File to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
}

/// Turn an exported network into the model file that controllers and browsers read
#[derive(Args, Clone, Debug)]
struct QuantizeArgs {
    /// What `cargo vantage export` wrote
    network: PathBuf,
    /// The data set to calibrate with, and to compare on
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// File to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Objects to calibrate with
    #[arg(long, default_value_t = 200, value_name = "N")]
    objects: usize,
    /// Seed of the calibration captures
    #[arg(long, default_value_t = 1, value_name = "K")]
    seed: u64,
}

/// Measure the networks of this program and write their card
#[derive(Args, Clone, Debug)]
struct CardArgs {
    /// Folder of the run that trained lab/models/soarnet.onnx
    #[arg(long, value_name = "DIR")]
    run: PathBuf,
    /// Folder of the run that trained lab/models/soarnet-poses.onnx
    #[arg(long, value_name = "DIR")]
    poses_run: PathBuf,
    /// Folder of a run of the literal preset
    #[arg(long, value_name = "DIR")]
    literal_run: Option<PathBuf>,
    /// The data set of the runs
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Folder of real objects
    #[arg(long, value_name = "DIR")]
    real: PathBuf,
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Train(args) => train(&args),
        Command::Export(args) => export(&args),
        Command::Quantize(args) => quantize(&args),
        Command::Card(args) => card(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn export(args: &ExportArgs) -> Result<()> {
    let run = Run::existing(&args.run)?;
    let recipe = run.course()?.recipe;
    ensure!(
        recipe.shape.build == Build::Plain,
        "{} holds a run of an encoder that is for comparison and is not exported",
        args.run.display()
    );
    ensure!(
        recipe.shape.relative && recipe.shape.maximum,
        "{} holds a run of the literal preset, which is for comparison and is not exported",
        args.run.display()
    );
    let net = fit::load_network(&recipe.shape, &run.best_file(), &Device::flex())?;
    onnx::export(&net, &args.out)?;
    eprintln!("wrote {}", args.out.display());
    Ok(())
}

fn quantize(args: &QuantizeArgs) -> Result<()> {
    let reference = Reference::open(&args.network)?;
    let dataset = Dataset::open(&args.data)?;
    let bar =
        ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {msg}")?);
    bar.set_message("reading");
    let hulls = reference.shape().outlook;
    let load = |split| samples::load(&dataset, split, Some(args.objects), hulls, || bar.tick());
    let (train, validation) = (load(Split::Train)?, load(Split::Validation)?);
    bar.set_message("calibrating");
    let file = quantize::quantize(&reference, &train, args.seed)?;
    bar.set_message("comparing");
    let agreement = quantize::agreement(&reference, &file, &validation, 3..=11)?;
    bar.finish_and_clear();
    quantize::save(&file, &args.out)?;
    println!(
        "{} bytes; against floating point on {} validation objects: rank correlation {:.4}, the same \
         first choice in {:.1} % of {} steps",
        file.len(),
        validation.len(),
        agreement.spearman,
        100.0 * agreement.same_choice,
        agreement.steps
    );
    eprintln!("wrote {}", args.out.display());
    Ok(())
}

fn card(args: &CardArgs) -> Result<()> {
    let lab = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let models = lab.join("models");
    let dataset = Dataset::open(&args.data)?;
    let parameters = dataset.manifest().parameters.clone();
    let validation = samples::load(&dataset, Split::Validation, None, true, || {})?;
    let figures = |name: &str, run: &Path| -> Result<Figures> {
        let course = Run::existing(run)?.course()?;
        let reference = Reference::open(&models.join(format!("{name}.onnx")))?;
        let path = models.join(format!("{name}.model"));
        let file = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let agreement = quantize::agreement(&reference, &file, &validation, 3..=11)?;
        Figures::new(course, agreement, &file)
    };
    let (soarnet, poses) =
        (figures("soarnet", &args.run)?, figures("soarnet-poses", &args.poses_run)?);
    let literal = args.literal_run.as_ref().map(|run| Run::existing(run)?.course()).transpose()?;
    let [procedural, real] = card::compared(&args.real, &parameters)?;
    let count = |split| dataset.objects(split).len();
    let card = Card {
        generator: concat!("vantage-train ", env!("CARGO_PKG_VERSION")).to_owned(),
        objects: [count(Split::Train), count(Split::Validation), count(Split::Test)],
        data: parameters,
        soarnet,
        poses,
        literal,
        procedural,
        real,
    };
    let courses = [&card.soarnet.course, &card.poses.course];
    fs::write(models.join("training.svg"), plot::training_svg(&courses)?)?;
    fs::write(models.join("card.json"), serde_json::to_string_pretty(&card)? + "\n")?;
    fs::write(lab.join("MODEL_CARD.md"), card.page())?;
    eprintln!("wrote {}", lab.join("MODEL_CARD.md").display());
    Ok(())
}

fn train(args: &TrainArgs) -> Result<()> {
    let mut recipe = match args.preset {
        Preset::Default => Recipe::default(),
        Preset::Literal => Recipe::literal(),
        Preset::Poses => {
            let recipe = Recipe::default();
            Recipe { shape: recipe.shape.without_photos(), ..recipe }
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
    let hulls = recipe.shape.outlook;
    let load = |split| samples::load(&dataset, split, None, hulls, || bar.inc(1));
    let (train, validation) = (load(Split::Train)?, load(Split::Validation)?);
    bar.finish_and_clear();
    let device = Device::flex();
    let course = fit::fit(&run, course, &train, &validation, &device)?;
    let net = fit::load_network(&recipe.shape, &run.best_file(), &device)?;
    let best = measure(&net, &validation, 4, &device);
    fs::write(args.out.join("training.svg"), plot::training_svg(&[&course])?)?;
    let epoch = course.best().map_or(0, |best| best.epoch);
    let four = |values: [f32; 4]| values.map(|value| format!("{value:.3}")).join(" ");
    println!(
        "best epoch {epoch}: on {} validation objects rank correlation C Q D T {}, share of the best \
         gain {}",
        validation.len(),
        four(best.spearman),
        four(best.share)
    );
    println!("next: cargo vantage export {} --out network.onnx", args.out.display());
    Ok(())
}
