//! `cargo vantage evaluate`: schemes by the fields that their views give.
//!
//! For every object the schemes choose views, a field is trained on each choice, and its renders are
//! compared with photos from a circle of test views. Every finished run is a file of its own; the
//! same command again, or with more schemes, budgets, seeds or objects, does what is missing.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use vantage_core::{Camera, Pose};
use vantage_lab::commands::ModelArgs;
use vantage_lab::commands::compare::{objects_of, seed_of};
use vantage_lab::network::Network;
use vantage_lab::object::Object;
use vantage_lab::photos::Scene;
use vantage_lab::pool::{FOV_X_RAD, PoolArgs};
use vantage_lab::scheme;

use crate::fly;
use crate::lpips::Lpips;
use crate::metrics::{psnr, ssim};
use crate::page;
use crate::photos::{Photos, Picture, test_circle, test_wave};
use crate::plans::{self, Views};
use crate::recipe::{Kind, Preset, Recipe};
use crate::runs::{Run, Settings, Store, csv};
use crate::study::{Study, command, name_of};
use crate::subject::{self, Photographed, Rendered, Subject, scenes_in};
use crate::summary::{self, Summary, summarise};
use crate::train::Trainer;

/// Compare schemes by the radiance fields that are trained on their views
#[derive(Args, Clone, Debug)]
pub struct EvaluateArgs {
    /// Objects: files, built-in names, classes, NAME:SEED, or folders of GLB, glTF and OBJ files; every
    /// built-in one if none is named. A folder like NeRF's synthetic scenes (transforms_train.json and
    /// transforms_test.json), or a folder of such, gives photos: its training views are the candidates
    pub objects: Vec<String>,
    /// Schemes, separated by commas: those of `plan`, e-exact (the same as e), fibonacci (an even
    /// lattice, not from the candidates), best-of-4-random and optimal-cqdt (the best in hindsight),
    /// activenerf (ActiveNeRF at a small size; it trains a network to choose: a minute for 20 views).
    /// Behind those of `plan` may stand, in this order, @SHARE, the least distance from the views so
    /// far, +opposite=WEIGHT, how much the side opposite a view counts as that view, +start=VIEWS, the
    /// number of first views, +move=COST, as --movement-cost of `plan`, +stop=GAIN, as its --stop:
    /// fps+opposite=0.5+move=0.5
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "random,fps,e-exact,soarnet,soarnet-support"
    )]
    pub schemes: Vec<String>,
    /// Budgets, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "6,12,20")]
    pub budgets: Vec<usize>,
    /// The field that is trained
    #[arg(long, value_enum, default_value = "plenoxels")]
    pub field: Kind,
    /// Its size, and that of the photos
    #[arg(long, value_enum, default_value = "small")]
    pub preset: Preset,
    /// Steps of training [default: the preset's]
    #[arg(long, value_name = "N")]
    pub steps: Option<usize>,
    /// Runs of each scheme that leaves something to chance, with seeds 0, 1, 2 …
    #[arg(long, default_value_t = 3, value_name = "N")]
    pub seeds: u64,
    /// Fields trained side by side, each on one thread [default: the processor's cores]
    #[arg(long, value_name = "J")]
    pub jobs: Option<usize>,
    /// Test views on a tilted circle, or between the lowest and highest elevation, 1 to 200; of a folder
    /// of photos so many of its test views, or all
    #[arg(long, default_value_t = 24, value_name = "N")]
    pub test_views: usize,
    /// Measure LPIPS by this ONNX file: two pictures (1, 3, height, width) in [-1, 1], one number
    #[arg(long, value_name = "FILE")]
    pub lpips: Option<PathBuf>,
    /// Add the runs, without their views, to a file from which `results` writes its page
    #[arg(long, value_name = "FILE")]
    pub keep: Option<PathBuf>,
    /// Show in the report, instead of one test view of each scheme, a flight along all of them
    #[arg(long)]
    pub fly: bool,
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub pool: PoolArgs,
    /// The same candidates for all objects and seeds. Without it each object and seed draws its own, so
    /// that no layout of views is common to all; where the candidates are no matter of chance, as of
    /// `hemisphere` or --pool FILE, it draws its own first view
    #[arg(long)]
    pub same_candidates: bool,
    /// Seed of a built-in object
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub object_seed: u64,
    /// Folder of the runs; an interrupted sweep continues
    #[arg(long, short, value_name = "DIR")]
    pub out: PathBuf,
}

/// `results.json`.
#[derive(Serialize)]
struct Results<'a> {
    settings: &'a Settings,
    runs: &'a [Run],
    #[serde(flatten)]
    summary: &'a Summary,
}

/// A run that is wanted: a scheme that is planned, not one in hindsight.
#[derive(Clone, Debug, PartialEq)]
struct Wanted {
    scheme: String,
    seed: u64,
    budget: usize,
}

/// Runs what is missing, then writes and prints what all of it says.
pub fn run(args: &EvaluateArgs) -> Result<()> {
    let schemes = schemes_of(args)?;
    let objects = objects_and_scenes(&args.objects)?;
    subject::check(&schemes, &objects)?;
    let poses = args.pool.poses()?;
    check(args, poses.len())?;
    let networks = args.model.networks(&schemes)?;
    let settings = settings_of(args)?;
    settings.recipe.check()?;
    let side = settings.photo_side;
    let camera = Camera::from_fov(side, side, FOV_X_RAD)?;
    let test_poses = match args.pool.limits_deg() {
        Some(limits) => test_wave(args.test_views, limits)?,
        None => test_circle(args.test_views)?,
    };
    let lpips = args.lpips.as_ref();
    let lpips = lpips.map(|file| Lpips::open(file, side as usize, side as usize)).transpose()?;
    let store = Store::open(&args.out, &settings)?;
    args.keep.as_deref().map_or(Ok(()), Study::<Run>::check)?;

    let wanted = wanted_of(args, &schemes);
    let jobs = args.jobs.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from));
    let bar = ProgressBar::new((objects.len() * wanted.len()) as u64);
    bar.set_style(ProgressStyle::with_template(
        "{elapsed_precise} {wide_bar} {pos}/{len} runs, {eta} left",
    )?);
    bar.enable_steady_tick(Duration::from_millis(500));
    let sweep = Sweep {
        args,
        settings: &settings,
        store: &store,
        camera,
        poses: &poses,
        test_poses: &test_poses,
        networks: &networks,
        lpips: lpips.as_ref(),
        jobs: jobs.max(1),
        bar: &bar,
    };
    let (mut runs, mut failed) = (Vec::new(), 0);
    for name in &objects {
        match sweep.object(name, &wanted) {
            Ok(found) => runs.extend(found),
            Err(error) => {
                failed += 1;
                bar.suspend(|| eprintln!("error: {name} is left out: {error:#}"));
            }
        }
    }
    bar.finish_and_clear();
    ensure!(!runs.is_empty(), "none of the objects could be evaluated");

    let summary = summarise(&runs, &schemes, &args.budgets);
    store.write("runs.csv", csv(&runs).as_bytes())?;
    let results = Results { settings: &settings, runs: &runs, summary: &summary };
    store.write("results.json", serde_json::to_string_pretty(&results)?.as_bytes())?;
    store.write("psnr.svg", page::psnr_svg(&summary, &schemes, "random")?.as_bytes())?;
    let html = page::page(&settings, &runs, &summary, &schemes, &store)?;
    let report = store.write("report.html", html.as_bytes())?;
    if let Some(file) = &args.keep {
        Study::keep(file, &command(), &runs)?;
    }
    print!("{}", summary::table(&summary));
    eprintln!("wrote {}", report.display());
    if failed > 0 {
        bail!("{failed} objects were left out");
    }
    Ok(())
}

/// The schemes by their own names, each once.
fn schemes_of(args: &EvaluateArgs) -> Result<Vec<String>> {
    let mut schemes: Vec<String> = Vec::new();
    for name in &args.schemes {
        let name = plans::canonical(name);
        plans::check(&name)?;
        if !schemes.contains(&name) {
            schemes.push(name);
        }
    }
    ensure!(!schemes.is_empty(), "name at least one scheme");
    Ok(schemes)
}

/// The objects that are named, folders of scenes and of meshes opened.
fn objects_and_scenes(names: &[String]) -> Result<Vec<String>> {
    if names.is_empty() {
        return objects_of(names);
    }
    let mut objects = Vec::new();
    for name in names {
        let scenes = scenes_in(Path::new(name));
        if scenes.is_empty() {
            objects.extend(objects_of(std::slice::from_ref(name))?);
        }
        objects.extend(scenes.into_iter().map(|scene| scene.to_string_lossy().into_owned()));
    }
    Ok(objects)
}

fn check(args: &EvaluateArgs, candidates: usize) -> Result<()> {
    let (Some(&most), Some(&least)) = (args.budgets.iter().max(), args.budgets.iter().min()) else {
        bail!("name at least one budget");
    };
    ensure!(least > 0, "a budget is 0: ask for at least one view");
    ensure!(args.seeds > 0, "--seeds is 0: ask for at least one run of each scheme");
    ensure!(args.jobs != Some(0), "--jobs is 0: train at least one field at a time");
    scheme::plan("e", most, 0).context("the ensemble")?.check(candidates)?;
    Ok(())
}

fn settings_of(args: &EvaluateArgs) -> Result<Settings> {
    let mut recipe = Recipe::new(args.field, args.preset);
    recipe.steps = args.steps.unwrap_or(recipe.steps);
    let count = args.pool.candidates;
    let pool = (args.pool.record(), args.pool.seed(), count, own(args));
    Ok(Settings {
        field: args.field,
        preset: args.preset,
        recipe,
        photo_side: args.preset.photo_side(),
        test_views: args.test_views,
        pool: serde_json::to_value(pool)?,
        object_seed: args.object_seed,
        lpips: args.lpips.clone(),
        models: [args.model.model.clone(), args.model.poses_model.clone()],
    })
}

/// What each object and seed draws for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Own {
    /// Its candidates.
    Candidates,
    /// Of the candidates that all share, the first.
    FirstView,
    /// Nothing that another does not draw too.
    Nothing,
}

fn own(args: &EvaluateArgs) -> Own {
    match (args.same_candidates, args.pool.has_chance()) {
        (true, _) => Own::Nothing,
        (false, true) => Own::Candidates,
        (false, false) => Own::FirstView,
    }
}

/// The candidates that an object and seed have of their own.
fn drawn(pool: &PoolArgs, object: &str, seed: u64) -> Result<Vec<Pose>> {
    let pool_seed = pool.pool_seed ^ seed_of(&name_of(object), seed);
    PoolArgs { pool_seed, ..pool.clone() }.poses()
}

/// All runs of one object, each once.
fn wanted_of(args: &EvaluateArgs, schemes: &[String]) -> Vec<Wanted> {
    let mut wanted: Vec<Wanted> = Vec::new();
    for scheme in schemes {
        for (scheme, seed) in (0..args.seeds).flat_map(|seed| plans::parts(scheme, seed)) {
            for &budget in &args.budgets {
                let one = Wanted { scheme: scheme.clone(), seed, budget };
                let differs = seed == 0
                    || plans::has_chance(&scheme)
                    || own(args) == Own::Candidates && scheme != plans::FIBONACCI;
                if differs && !wanted.contains(&one) {
                    wanted.push(one);
                }
            }
        }
    }
    wanted
}

/// What all runs share.
struct Sweep<'a> {
    args: &'a EvaluateArgs,
    settings: &'a Settings,
    store: &'a Store,
    camera: Camera,
    poses: &'a [Pose],
    test_poses: &'a [Pose],
    networks: &'a [(scheme::Network, Network)],
    lpips: Option<&'a Lpips>,
    jobs: usize,
    bar: &'a ProgressBar,
}

impl Sweep<'_> {
    /// All runs of an object, the finished ones as they were.
    fn object(&self, name: &str, wanted: &[Wanted]) -> Result<Vec<Run>> {
        let find = |one: &Wanted| self.store.find(name, &one.scheme, one.seed, one.budget);
        let found: Vec<Option<Run>> = wanted.iter().map(find).collect::<Result<_>>()?;
        let missing: Vec<&Wanted> = wanted
            .iter()
            .zip(&found)
            .filter(|(_, run)| run.is_none())
            .map(|(one, _)| one)
            .collect();
        self.bar.inc((wanted.len() - missing.len()) as u64);
        // What is done at once must not count for how fast the rest will be.
        self.bar.reset_eta();
        let mut new = if missing.is_empty() {
            Vec::new()
        } else {
            self.train(name, &missing).inspect_err(|_| self.bar.inc(missing.len() as u64))?
        };
        new.extend(found.into_iter().flatten());
        let place = |run: &Run| {
            wanted.iter().position(|one| {
                (one.scheme == run.scheme) && (one.seed, one.budget) == (run.seed, run.budget)
            })
        };
        new.sort_by_key(place);
        Ok(new)
    }

    fn train(&self, name: &str, missing: &[&Wanted]) -> Result<Vec<Run>> {
        let folder = Path::new(name);
        if Scene::is_in(folder) {
            let side = self.settings.photo_side;
            let scene = Photographed::open(folder, side, self.args.test_views, self.networks)?;
            return self.train_on(name, missing, &scene);
        }
        let object = Object::open(Some(name), self.args.object_seed)?;
        for warning in &object.warnings {
            self.bar.suspend(|| eprintln!("warning: {name}: {warning}"));
        }
        let train = |poses: &[Pose], missing: &[&Wanted]| {
            let views = [poses, self.test_poses];
            let schemes: Vec<&str> = missing.iter().map(|one| one.scheme.as_str()).collect();
            let (mesh, networks) = (&object.mesh, self.networks);
            let subject = Rendered::new(mesh, self.camera, views, networks, &schemes)?;
            self.train_on(name, missing, &subject)
        };
        if own(self.args) != Own::Candidates {
            return train(self.poses, missing);
        }
        let mut runs = Vec::new();
        for seed in 0..missing.iter().map(|one| one.seed + 1).max().unwrap_or(0) {
            let missing: Vec<&Wanted> =
                missing.iter().copied().filter(|one| one.seed == seed).collect();
            if !missing.is_empty() {
                runs.extend(train(&drawn(&self.args.pool, name, seed)?, &missing)?);
            }
        }
        Ok(runs)
    }

    fn train_on(&self, name: &str, missing: &[&Wanted], subject: &dyn Subject) -> Result<Vec<Run>> {
        let test = subject.test();
        // Where all choose from the same views, each object begins elsewhere, or all had one layout.
        let begins = own(self.args) == Own::FirstView;
        let chance = |seed| if begins { seed_of(&name_of(name), seed) } else { seed };
        // One plan for all budgets, unless it is no greedy one.
        let mut plans: Vec<(&str, u64, Views)> = Vec::new();
        let mut tasks: Vec<(&Wanted, Views)> = Vec::new();
        for one in missing {
            let known = |plan: &&(&str, u64, Views)| plan.0 == one.scheme && plan.1 == one.seed;
            let views = if one.scheme == plans::FIBONACCI {
                subject.views(&one.scheme, one.budget, chance(one.seed))?
            } else if let Some((_, _, views)) = plans.iter().find(known) {
                views.first(one.budget)
            } else {
                let most = self.args.budgets.iter().copied().max().unwrap_or(one.budget);
                let views = subject.views(&one.scheme, most, chance(one.seed))?;
                plans.push((&one.scheme, one.seed, views.clone()));
                views.first(one.budget)
            };
            tasks.push((one, views));
        }
        self.store.create(self.settings)?;
        // Photos are taken here, on all cores; the threads below train, each on one.
        let photos: Vec<Photos> = tasks.iter().map(|(_, views)| subject.photos(views)).collect();

        let next = AtomicUsize::new(0);
        let done: Mutex<Vec<Result<Run>>> = Mutex::new(Vec::new());
        let push = |run| done.lock().unwrap_or_else(|poison| poison.into_inner()).push(run);
        thread::scope(|scope| {
            for _ in 0..self.jobs.min(tasks.len()) {
                scope.spawn(|| {
                    loop {
                        let place = next.fetch_add(1, Ordering::Relaxed);
                        let (Some((one, views)), Some(photos)) =
                            (tasks.get(place), photos.get(place))
                        else {
                            break;
                        };
                        push(self.one(name, one, views, photos, &test));
                        self.bar.inc(1);
                    }
                });
            }
        });
        done.into_inner().unwrap_or_else(|poison| poison.into_inner()).into_iter().collect()
    }

    /// Trains a field, and measures it.
    fn one(
        &self,
        object: &str,
        wanted: &Wanted,
        views: &Views,
        photos: &Photos,
        test: &Photos,
    ) -> Result<Run> {
        let start = Instant::now();
        let mut trainer = Trainer::new(&self.settings.recipe, photos, wanted.seed);
        while !trainer.is_over() {
            let loss = trainer.advance();
            ensure!(loss.is_finite(), "the loss is no longer finite");
        }
        let training_seconds = start.elapsed().as_secs_f64();
        let found = trainer.render(&test.camera, &test.poses);
        let quality = Quality::of(&found, &test.pictures, self.lpips)?;
        let run = Run {
            object: object.to_owned(),
            scheme: wanted.scheme.clone(),
            seed: wanted.seed,
            budget: wanted.budget,
            photos: Some(views.poses.len()),
            travel_deg: Some(views.travel_deg()),
            views: views.candidates.clone(),
            psnr: quality.psnr,
            ssim: quality.ssim,
            lpips: quality.lpips,
            planning_seconds: views.seconds.last().copied().unwrap_or(0.0),
            training_seconds,
        };
        page::beside(&found[0], &test.pictures[0])
            .save(self.store.render(&run))
            .context("a render cannot be written")?;
        if self.args.fly {
            fly::write(&self.store.flight(&run), &found, &test.pictures)?;
        }
        self.store.keep(&run)?;
        Ok(run)
    }
}

/// How good renders are, the mean over them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Decibels.
    pub psnr: f64,
    /// At most 1.
    pub ssim: f64,
    /// None without weights.
    pub lpips: Option<f64>,
}

impl Quality {
    /// Compares renders with photos from the same places.
    pub fn of(found: &[Picture], truth: &[Picture], lpips: Option<&Lpips>) -> Result<Self> {
        let count = found.len().max(1) as f64;
        let (mut sums, mut distance) = ([0.0; 2], 0.0);
        for (found, truth) in found.iter().zip(truth) {
            sums[0] += psnr(found, truth);
            sums[1] += ssim(found, truth).context("the pictures are too small for SSIM")?;
            if let Some(lpips) = lpips {
                distance += lpips.distance(found, truth)?;
            }
        }
        let lpips = lpips.map(|_| distance / count);
        Ok(Self { psnr: sums[0] / count, ssim: sums[1] / count, lpips })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        pool: PoolArgs,
    }

    #[test]
    fn objects_and_seeds_draw_candidates_of_their_own() {
        let pool = Cli::parse_from(["evaluate", "--candidates", "10"]).pool;
        let of = |object: &str, seed: u64| drawn(&pool, object, seed).unwrap();
        assert_eq!(of("../a.glb", 1), of("a", 1));
        assert!(of("a", 1) != of("a", 0) && of("a", 1) != of("b", 1));
        let other = Cli::parse_from(["evaluate", "--candidates", "10", "--pool-seed", "1"]).pool;
        assert_ne!(drawn(&other, "a", 1).unwrap(), of("a", 1));
    }
}
