//! `cargo vantage ceiling`: how much better than farthest-point sampling any choice of views could be.
//!
//! A local search on the true quality: from the views of farthest-point sampling, one view after the
//! other is exchanged for a candidate by chance, a field is trained, and the exchange stays if the field
//! is better. No planner can know that; what it finds is a lower bound of what there is to win.
//!
//! The search looks at every second test view. Since the best of many noisy figures is too good, what it
//! finds is measured again on the other test views, with another seed of the field.
//!
//! Every finished fit is a line in a file, so that an interrupted search goes on where it was.

use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use anyhow::{Context, Result, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use vantage_core::planner::Plan;
use vantage_core::{Camera, Pose};
use vantage_lab::blind;
use vantage_lab::commands::compare::objects_of;
use vantage_lab::object::Object;
use vantage_lab::pool::{FOV_X_RAD, PoolArgs};
use vantage_lab::render::Renderer;

use crate::metrics::psnr;
use crate::photos::{Photos, test_circle};
use crate::recipe::{Kind, Preset, Recipe};
use crate::study::{Kept, Study, command, name_of};
use crate::train::Trainer;

/// Test views, half of them to search by and half to measure by.
const TEST_VIEWS: usize = 24;

/// Search for the best views by training fields on them: what there is to win for a planner
#[derive(Args, Clone, Debug)]
pub struct CeilingArgs {
    /// Objects, as for `evaluate`
    pub objects: Vec<String>,
    /// Budgets, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "6,12,20")]
    pub budgets: Vec<usize>,
    /// Fields trained in each search
    #[arg(long, default_value_t = 300, value_name = "N")]
    pub fits: usize,
    /// The field that is trained
    #[arg(long, value_enum, default_value = "plenoxels")]
    pub field: Kind,
    /// Its size, and that of the photos
    #[arg(long, value_enum, default_value = "small")]
    pub preset: Preset,
    /// Steps of training [default: the preset's]
    #[arg(long, value_name = "N")]
    pub steps: Option<usize>,
    /// Seed of a built-in object
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub object_seed: u64,
    #[command(flatten)]
    pub pool: PoolArgs,
    /// Searches side by side, each on one thread [default: the processor's cores]
    #[arg(long, value_name = "J")]
    pub jobs: Option<usize>,
    /// Add what was found to a file from which `results` writes its page
    #[arg(long, value_name = "FILE")]
    pub keep: Option<PathBuf>,
    /// Folder of the searches; an interrupted one continues
    #[arg(long, short, value_name = "DIR")]
    pub out: PathBuf,
}

/// A line of a search's file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Trial {
    views: Vec<usize>,
    psnr: f64,
}

/// What a search found; PSNR in dB.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Search {
    /// As it was named.
    pub object: String,
    /// Views.
    pub budget: usize,
    /// Fields that were trained.
    pub fits: usize,
    /// Of farthest-point sampling and of the best views, on the test views of the search.
    pub searched: [f64; 2],
    /// The same on the other test views, with another seed of the field.
    pub others: [f64; 2],
}

impl Kept for Search {
    fn kept(&self) -> Self {
        Self { object: name_of(&self.object), ..self.clone() }
    }

    fn is_again(&self, other: &Self) -> bool {
        (self.object.as_str(), self.budget) == (other.object.as_str(), other.budget)
    }
}

/// Searches, and prints what was found.
pub fn run(args: &CeilingArgs) -> Result<()> {
    let objects = objects_of(&args.objects)?;
    let poses = args.pool.poses()?;
    let mut recipe = Recipe::new(args.field, args.preset);
    recipe.steps = args.steps.unwrap_or(recipe.steps);
    recipe.check()?;
    ensure!(args.fits > 0, "--fits is 0: train at least one field");
    ensure!(args.jobs != Some(0), "--jobs is 0: search at least one object at a time");
    for &budget in &args.budgets {
        ensure!(
            (1..poses.len()).contains(&budget),
            "a budget of {budget} leaves nothing to exchange among {} candidates: lower it or add some",
            poses.len()
        );
    }
    args.keep.as_deref().map_or(Ok(()), Study::<Search>::check)?;
    // Trials of other settings must not be mixed.
    let settings = serde_json::to_string(&(
        &recipe,
        args.preset.photo_side(),
        args.pool.record(),
        args.pool.seed(),
        poses.len(),
        args.object_seed,
    ))?;
    open(&args.out, &settings)?;

    let searches: Vec<(&String, usize)> = objects
        .iter()
        .flat_map(|object| args.budgets.iter().map(move |&budget| (object, budget)))
        .collect();
    let bar = ProgressBar::new((searches.len() * (args.fits + 2)) as u64);
    bar.set_style(ProgressStyle::with_template(
        "{elapsed_precise} {wide_bar} {pos}/{len} fits, {eta} left",
    )?);
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Result<Search>)>> = Mutex::new(Vec::new());
    let jobs = args.jobs.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from));
    thread::scope(|scope| {
        for _ in 0..jobs.min(searches.len()) {
            scope.spawn(|| {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(&(object, budget)) = searches.get(place) else { break };
                    let found = search(args, &recipe, &poses, object, budget, &bar)
                        .with_context(|| format!("{object} cannot be searched"));
                    done.lock().unwrap_or_else(|poison| poison.into_inner()).push((place, found));
                }
            });
        }
    });
    bar.finish_and_clear();
    let mut done = done.into_inner().unwrap_or_else(|poison| poison.into_inner());
    done.sort_by_key(|(place, _)| *place);
    let (mut found, mut failed) = (Vec::new(), 0);
    for (_, search) in done {
        match search {
            Ok(search) => found.push(search),
            Err(error) => {
                failed += 1;
                eprintln!("error: {error:#}");
            }
        }
    }
    print!("{}", table(&found));
    if let Some(file) = &args.keep {
        Study::keep(file, &command(), &found)?;
    }
    ensure!(failed == 0, "{failed} searches failed: what the others found is kept");
    Ok(())
}

/// What was found as text of fixed width.
fn table(searches: &[Search]) -> String {
    let mut text = format!(
        "PSNR in dB of farthest-point sampling and of what a search found, on its test views and on \
         others:\n\n{:<24} {:>6} {:>6} {:>15} {:>15} {:>8}\n",
        "object", "budget", "fits", "searched", "others", "gain"
    );
    for Search { object, budget, fits, searched: [start, best], others: [from, to] } in searches {
        text += &format!(
            "{object:<24} {budget:>6} {fits:>6} {start:>6.2} -> {best:>5.2} {from:>6.2} -> {to:>5.2} \
             {:>+8.2}\n",
            to - from
        );
    }
    text
}

/// What was found as a table of Markdown.
pub fn markdown(searches: &[Search]) -> String {
    let mut text = String::from(
        "| object | B | fits | PSNR in dB of farthest points, of the found: on the test views of the \
         search | on others | gain there |\n|---|---|---|---|---|---|\n",
    );
    for Search { object, budget, fits, searched: [start, best], others: [from, to] } in searches {
        let object = object.replace('_', " ");
        text += &format!(
            "| {object} | {budget} | {fits} | {start:.2}, {best:.2} | {from:.2}, {to:.2} | {:+.2} |\n",
            to - from
        );
    }
    text
}

/// Makes the folder, or checks that it holds searches of the same settings.
fn open(folder: &Path, settings: &str) -> Result<()> {
    let path = folder.join("settings.json");
    if path.exists() {
        let known =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        ensure!(
            known == settings,
            "{} holds searches of other settings: name another folder",
            folder.display()
        );
        return Ok(());
    }
    let occupied = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
    ensure!(!occupied, "{} is not empty: name another folder", folder.display());
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    crate::runs::write_whole(&path, settings.as_bytes())
}

fn search(
    args: &CeilingArgs,
    recipe: &Recipe,
    poses: &[Pose],
    name: &str,
    budget: usize,
    bar: &ProgressBar,
) -> Result<Search> {
    let object = Object::open(Some(name), args.object_seed)?;
    let renderer = Renderer::new(&object.mesh);
    let side = args.preset.photo_side();
    let camera = Camera::from_fov(side, side, FOV_X_RAD)?;
    let circle = test_circle(TEST_VIEWS)?;
    let half = |first: usize| {
        let poses = circle.iter().skip(first).step_by(2).copied().collect();
        Photos::of_mesh(&renderer, camera, poses)
    };
    let (searched, others) = (half(0), half(1));
    let fit = |views: &[usize], seed: u64, test: &Photos| -> Result<f64> {
        let poses = views.iter().map(|&view| poses[view]).collect();
        let photos = Photos::of_mesh(&renderer, camera, poses);
        let mut trainer = Trainer::new(recipe, &photos, seed);
        while !trainer.is_over() {
            ensure!(trainer.advance().is_finite(), "the loss is no longer finite");
        }
        let found = trainer.render(&test.camera, &test.poses);
        let values = found.iter().zip(&test.pictures).map(|(found, truth)| psnr(found, truth));
        bar.inc(1);
        Ok(values.sum::<f64>() / found.len() as f64)
    };

    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    let file: String = name.chars().map(plain).collect();
    let mut trials = Trials::open(&args.out.join(format!("{file}.{budget}.jsonl")))?;
    bar.inc(trials.known.len() as u64);
    let start = blind::views(poses, Plan::farthest_point(budget))?;
    let mut best: Option<Trial> = None;
    for number in 0..args.fits {
        let mut chance = Pcg64::seed_from_u64(number as u64);
        let mut views = best.as_ref().map_or(&start, |best| &best.views).clone();
        if best.is_some() {
            let place = chance.random_range(0..budget);
            let rest: Vec<usize> = (0..poses.len()).filter(|view| !views.contains(view)).collect();
            views[place] = rest[chance.random_range(0..rest.len())];
        }
        let trial = match trials.known.get(number) {
            Some(known) => {
                ensure!(
                    known.views == views,
                    "the trials of {name} for {budget} views are of another search: delete them"
                );
                known.clone()
            }
            None => trials.keep(Trial { psnr: fit(&views, 0, &searched)?, views })?,
        };
        if best.as_ref().is_none_or(|best| trial.psnr > best.psnr) {
            best = Some(trial);
        }
    }
    let best = best.context("nothing was tried")?;
    Ok(Search {
        object: name.to_owned(),
        budget,
        fits: args.fits,
        searched: [trials.known[0].psnr, best.psnr],
        others: [fit(&start, 1, &others)?, fit(&best.views, 1, &others)?],
    })
}

/// The trials of a search, each a line of its file.
struct Trials {
    file: fs::File,
    known: Vec<Trial>,
}

impl Trials {
    /// Reads those that are whole; what was cut off in the middle is written over.
    fn open(path: &Path) -> Result<Self> {
        let text = if path.exists() {
            fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?
        } else {
            String::new()
        };
        let whole = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        let known: Vec<Trial> = whole.map_while(|line| serde_json::from_str(line).ok()).collect();
        let lines: Vec<&str> = text.split_inclusive('\n').take(known.len()).collect();
        let length = lines.iter().map(|line| line.len() as u64).sum();
        let file = OpenOptions::new().create(true).append(true).open(path);
        let file = file.with_context(|| format!("cannot write {}", path.display()))?;
        file.set_len(length)?;
        Ok(Self { file, known })
    }

    fn keep(&mut self, trial: Trial) -> Result<Trial> {
        let line = serde_json::to_string(&trial)? + "\n";
        self.file.write_all(line.as_bytes()).context("a trial cannot be kept")?;
        self.known.push(trial.clone());
        Ok(trial)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_was_cut_off_is_dropped() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("ball.3.jsonl");
        let trial = |psnr: f64| Trial { views: vec![1, 2, 3], psnr };
        let mut trials = Trials::open(&path).unwrap();
        for psnr in [20.0, 21.5] {
            trials.keep(trial(psnr)).unwrap();
        }
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, &text[..text.len() - 4]).unwrap();
        let mut trials = Trials::open(&path).unwrap();
        assert_eq!(trials.known, [trial(20.0)]);
        trials.keep(trial(22.0)).unwrap();
        assert_eq!(Trials::open(&path).unwrap().known, [trial(20.0), trial(22.0)]);
    }

    #[test]
    fn what_was_found_becomes_tables() {
        let one = Search {
            object: "../a_b.glb".to_owned(),
            budget: 6,
            fits: 40,
            searched: [20.0, 21.5],
            others: [20.25, 21.0],
        };
        let again = Search { fits: 60, ..one.kept() };
        assert!(
            one.kept().is_again(&again) && !again.is_again(&Search { budget: 12, ..one.kept() })
        );
        let (text, page) = (table(std::slice::from_ref(&one)), markdown(&[one.kept()]));
        assert!(text.contains("20.00 -> 21.50") && text.ends_with("+0.75\n"), "{text}");
        assert!(
            page.ends_with("| a b | 6 | 40 | 20.00, 21.50 | 20.25, 21.00 | +0.75 |\n"),
            "{page}"
        );
    }

    #[test]
    fn searches_of_other_settings_are_not_mixed() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("searches");
        open(&folder, "one").unwrap();
        open(&folder, "one").unwrap();
        assert!(open(&folder, "other").unwrap_err().to_string().contains("other settings"));
        assert!(open(home.path(), "one").unwrap_err().to_string().contains("not empty"));
    }
}
