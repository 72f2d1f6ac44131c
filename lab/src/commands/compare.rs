//! `cargo vantage compare`: exact scores of schemes over objects and budgets.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Serialize;
use vantage_core::objectives::Reading;
use vantage_core::{Camera, Objective, Scores};

use crate::exact::{Labelled, Step};
use crate::label::RESOLUTION;
use crate::object::Object;
use crate::pool::{FOV_X_RAD, PoolArgs};
use crate::scheme;

/// Options of `compare`.
#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    /// Objects: files, built-in names, or folders of GLB, glTF and OBJ files; every built-in one if
    /// none is named
    pub objects: Vec<String>,
    /// Schemes, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "random,fps,e,c,q,d,t,sum")]
    pub schemes: Vec<String>,
    /// Budgets, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "3,6,12,20,30")]
    pub budgets: Vec<usize>,
    /// Runs of each scheme, with seeds 0, 1, 2 …
    #[arg(long, default_value_t = 5, value_name = "N")]
    pub seeds: u64,
    #[command(flatten)]
    pub pool: PoolArgs,
    /// Seed of built-in objects
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub object_seed: u64,
    /// Compute the paper's equations to the letter
    #[arg(long)]
    pub literal: bool,
    /// Print rows and summary as JSON
    #[arg(long)]
    pub json: bool,
}

/// One scheme on one object, with one seed, cut at one budget.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    object: String,
    scheme: String,
    budget: usize,
    seed: u64,
    #[serde(flatten)]
    scores: Scores,
    views: Vec<usize>,
    seconds: f64,
    #[serde(skip)]
    relative: Scores, // to the exact oracle of each objective, on the same object and seed
}

/// Mean and spread over all objects and seeds.
#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    mean: f64,
    /// Standard deviation over the runs.
    sd: f64,
    /// Mean of the score divided by that of the plan that is greedy on this objective alone, with
    /// exact scores, on the same object and with the same seed. The oracle looks one view ahead,
    /// so a scheme can exceed 1.
    relative_mean: f64,
    /// Standard deviation of the same.
    relative_sd: f64,
}

#[derive(Clone, Debug, Serialize)]
struct SummaryRow {
    scheme: String,
    budget: usize,
    runs: usize,
    coverage: Spread,
    geometry: Spread,
    diversity: Spread,
    texture: Spread,
    seconds: f64,
}

#[derive(Serialize)]
struct Comparison<'a> {
    rows: &'a [Row],
    summary: &'a [SummaryRow],
}

/// Runs the comparison and prints it.
pub fn run(args: &CompareArgs) -> Result<()> {
    let objects = objects_of(&args.objects)?;
    let poses = args.pool.poses()?;
    for scheme in &args.schemes {
        if scheme::plan(scheme, 1, 0).is_none() {
            bail!(scheme::unknown(scheme));
        }
    }
    let (Some(&most), Some(&least)) = (args.budgets.iter().max(), args.budgets.iter().min()) else {
        bail!("name at least one budget");
    };
    if least == 0 {
        bail!("a budget is 0: ask for at least one view");
    }
    if args.seeds == 0 {
        bail!("--seeds is 0: ask for at least one run of each scheme");
    }
    scheme::plan("e", most, 0).context("the ensemble")?.check(poses.len())?;

    let mut rows = Vec::new();
    let mut failed = 0;
    let bar = super::progress("comparing", objects.len());
    for name in &objects {
        match compare_object(name, &poses, most, args) {
            Ok(found) => rows.extend(found),
            Err(error) => {
                bar.suspend(|| eprintln!("error: {name} is left out: {error:#}"));
                failed += 1;
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if failed == objects.len() {
        bail!("none of the objects could be compared");
    }
    let summary = summarise(&rows, args);
    if args.json {
        let comparison = Comparison { rows: &rows, summary: &summary };
        println!("{}", serde_json::to_string(&comparison)?);
    } else {
        print_table(&summary, objects.len() - failed, args.seeds);
    }
    if failed > 0 {
        bail!("{failed} of {} objects were left out", objects.len());
    }
    Ok(())
}

/// The files in folders, and whatever else is named.
fn objects_of(names: &[String]) -> Result<Vec<String>> {
    if names.is_empty() {
        return Ok(crate::mesh::BUILTIN.iter().map(|name| (*name).to_owned()).collect());
    }
    let mut objects = Vec::new();
    for name in names {
        let path = Path::new(name);
        if !path.is_dir() {
            objects.push(name.clone());
            continue;
        }
        let entries = std::fs::read_dir(path).with_context(|| format!("cannot read {name}"))?;
        let mut files: Vec<PathBuf> =
            entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|p| is_mesh(p)).collect();
        if files.is_empty() {
            bail!("{name} holds no GLB, glTF or OBJ file");
        }
        files.sort();
        objects.extend(files.into_iter().map(|path| path.to_string_lossy().into_owned()));
    }
    Ok(objects)
}

fn is_mesh(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    matches!(extension.as_deref(), Some("glb" | "gltf" | "obj"))
}

fn compare_object(
    name: &str,
    poses: &[vantage_core::Pose],
    most: usize,
    args: &CompareArgs,
) -> Result<Vec<Row>> {
    let object = Object::open(Some(name), args.object_seed)?;
    super::warn(&object.warnings);
    let camera = Camera::from_fov(RESOLUTION, RESOLUTION, FOV_X_RAD)?;
    let reading = if args.literal { Reading::literal() } else { Reading::default() };
    let bar = super::progress("labelling", poses.len());
    let labelled = Labelled::new(&object.mesh, &camera, poses.to_vec(), reading, || bar.inc(1));
    bar.finish_and_clear();

    let mut rows = Vec::new();
    for seed in 0..args.seeds {
        let steps_of = |name: &str| -> Result<Vec<Step>> {
            let plan = scheme::plan(name, most, seed).with_context(|| scheme::unknown(name))?;
            labelled.run(plan, || {})
        };
        let oracles = [steps_of("c")?, steps_of("q")?, steps_of("d")?, steps_of("t")?];
        for scheme in &args.schemes {
            // A greedy plan of a smaller budget is the beginning of one of a larger.
            let own = Objective::ALL.iter().position(|&o| scheme::oracle(o) == scheme);
            let steps = match own {
                Some(place) => oracles[place].clone(),
                None => steps_of(scheme)?,
            };
            for &budget in &args.budgets {
                let Some(step) = steps.get(budget - 1) else { continue };
                rows.push(Row {
                    object: object.name.clone(),
                    scheme: scheme.clone(),
                    budget,
                    seed,
                    scores: step.scores,
                    views: steps[..budget].iter().map(|step| step.next.index).collect(),
                    seconds: step.seconds,
                    relative: relative(&step.scores, &oracles, budget),
                });
            }
        }
    }
    Ok(rows)
}

fn relative(scores: &Scores, oracles: &[Vec<Step>; 4], budget: usize) -> Scores {
    let [coverage, geometry, diversity, texture] = Objective::ALL.map(|objective| {
        let best = oracles[objective as usize][budget - 1].scores.get(objective);
        // An object without texture scores 0 whatever is done: nothing is lost.
        if best > 0.0 { scores.get(objective) / best } else { 1.0 }
    });
    Scores { coverage, geometry, diversity, texture }
}

fn summarise(rows: &[Row], args: &CompareArgs) -> Vec<SummaryRow> {
    let mut summary = Vec::new();
    for &budget in &args.budgets {
        for scheme in &args.schemes {
            let runs: Vec<&Row> =
                rows.iter().filter(|row| row.scheme == *scheme && row.budget == budget).collect();
            let spread = |objective: Objective| {
                let (mean, sd) = mean_and_sd(runs.iter().map(|row| row.scores.get(objective)));
                let (relative_mean, relative_sd) =
                    mean_and_sd(runs.iter().map(|row| row.relative.get(objective)));
                Spread { mean, sd, relative_mean, relative_sd }
            };
            summary.push(SummaryRow {
                scheme: scheme.clone(),
                budget,
                runs: runs.len(),
                coverage: spread(Objective::Coverage),
                geometry: spread(Objective::Geometry),
                diversity: spread(Objective::Diversity),
                texture: spread(Objective::Texture),
                seconds: mean_and_sd(runs.iter().map(|row| row.seconds as f32)).0,
            });
        }
    }
    summary
}

/// Mean and standard deviation (n - 1); the latter is 0 for a single value.
fn mean_and_sd(values: impl Iterator<Item = f32> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().map(f64::from).sum::<f64>() / count;
    let squares: f64 = values.map(|value| (f64::from(value) - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

fn print_table(summary: &[SummaryRow], objects: usize, seeds: u64) {
    println!(
        "{objects} objects, {seeds} seeds: mean ± sd, and the share of the exact oracle's score"
    );
    println!(
        "{:>6}  {:<10} {:>20} {:>20} {:>20} {:>20} {:>9}",
        "budget", "scheme", "coverage", "geometry", "diversity", "texture", "seconds"
    );
    let mut last = 0;
    for row in summary {
        if last != row.budget && last != 0 {
            println!();
        }
        last = row.budget;
        let cell =
            |s: &Spread| format!("{:.3} ± {:.3} {:>5.1} %", s.mean, s.sd, 100.0 * s.relative_mean);
        println!(
            "{:>6}  {:<10} {:>20} {:>20} {:>20} {:>20} {:>9.3}",
            row.budget,
            row.scheme,
            cell(&row.coverage),
            cell(&row.geometry),
            cell(&row.diversity),
            cell(&row.texture),
            row.seconds
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_spread_of_known_values() {
        assert_eq!(mean_and_sd([1.0, 2.0, 3.0].into_iter()), (2.0, 1.0));
        assert_eq!(mean_and_sd([4.0].into_iter()), (4.0, 0.0));
    }
}
