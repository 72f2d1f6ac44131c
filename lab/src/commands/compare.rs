//! `cargo vantage compare`: exact scores of schemes over objects and budgets.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use indicatif::ProgressBar;
use vantage_core::planner::Plan;
use vantage_core::{Camera, Objective, Pose, Scores};

use super::ScoreArgs;
use crate::exact::{Labelled, Step};
use crate::object::Object;
use crate::pool::PoolArgs;
use crate::record::{ComparisonRecord, ComparisonRow, Spread, SummaryRow};
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
    #[command(flatten)]
    pub score: ScoreArgs,
    /// Print rows and summary as JSON
    #[arg(long)]
    pub json: bool,
}

/// A row, and its scores relative to the exact oracle of each objective.
struct Run {
    row: ComparisonRow,
    relative: Option<Scores>, // none where the oracle has not chosen yet
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

    let camera = args.score.camera()?;

    let mut runs = Vec::new();
    let mut failed = 0;
    let bar = super::progress("comparing", objects.len() * poses.len());
    for (number, name) in objects.iter().enumerate() {
        match compare_object(name, &poses, &camera, most, args, &bar) {
            Ok(found) => runs.extend(found),
            Err(error) => {
                bar.suspend(|| eprintln!("error: {name} is left out: {error:#}"));
                failed += 1;
            }
        }
        bar.set_position(((number + 1) * poses.len()) as u64);
    }
    bar.finish_and_clear();
    if failed == objects.len() {
        bail!("none of the objects could be compared");
    }
    let summary = summarise(&runs, args);
    if args.json {
        let comparison = ComparisonRecord {
            rows: runs.into_iter().map(|run| run.row).collect(),
            summary,
            pool_seed: args.pool.seed(),
            pool: args.pool.record(),
            scoring: args.score.scoring(),
        };
        super::print(&format!("{}\n", serde_json::to_string(&comparison)?))?;
    } else {
        super::print(&table(&summary, objects.len() - failed, args.seeds))?;
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
    poses: &[Pose],
    camera: &Camera,
    most: usize,
    args: &CompareArgs,
    bar: &ProgressBar,
) -> Result<Vec<Run>> {
    let object = Object::open(Some(name), args.score.object_seed)?;
    super::warn(&object, Some(bar));
    let reading = args.score.reading();
    let labelled = Labelled::new(&object.mesh, camera, poses.to_vec(), reading, || bar.inc(1));

    let mut runs = Vec::new();
    for seed in 0..args.seeds {
        let steps_of = |name: &str| -> Result<Vec<Step>> {
            let plan = scheme::plan(name, most, seed).with_context(|| scheme::unknown(name))?;
            labelled.run(plan, || {})
        };
        let oracles = [steps_of("c")?, steps_of("q")?, steps_of("d")?, steps_of("t")?];
        for scheme in &args.schemes {
            let own = Objective::ALL.iter().position(|&o| scheme::oracle(o) == scheme);
            let steps = match own {
                Some(place) => oracles[place].clone(),
                None => steps_of(scheme)?,
            };
            // A greedy plan of a smaller budget is the beginning of one of a larger.
            for &budget in &args.budgets {
                let Some(step) = steps.get(budget - 1) else { continue };
                let row = ComparisonRow {
                    object: object.name.clone(),
                    scheme: scheme.clone(),
                    budget,
                    seed,
                    scores: step.scores,
                    views: steps[..budget].iter().map(|step| step.next.index).collect(),
                    seconds: step.seconds,
                };
                let relative =
                    (budget > Plan::START_VIEWS).then(|| relative(&step.scores, &oracles, budget));
                runs.push(Run { row, relative });
            }
        }
    }
    Ok(runs)
}

fn relative(scores: &Scores, oracles: &[Vec<Step>; 4], budget: usize) -> Scores {
    let [coverage, geometry, diversity, texture] = Objective::ALL.map(|objective| {
        let best = oracles[objective as usize][budget - 1].scores.get(objective);
        // An object without texture scores 0 whatever is done: nothing is lost.
        if best > 0.0 { scores.get(objective) / best } else { 1.0 }
    });
    Scores { coverage, geometry, diversity, texture }
}

fn summarise(runs: &[Run], args: &CompareArgs) -> Vec<SummaryRow> {
    let mut summary = Vec::new();
    for &budget in &args.budgets {
        for scheme in &args.schemes {
            let chosen: Vec<&Run> = runs
                .iter()
                .filter(|run| run.row.scheme == *scheme && run.row.budget == budget)
                .collect();
            let spread = |objective: Objective| {
                let scores: Vec<f32> =
                    chosen.iter().map(|run| run.row.scores.get(objective)).collect();
                let relative: Option<Vec<f32>> =
                    chosen.iter().map(|run| Some(run.relative?.get(objective))).collect();
                let (mean, sd) = mean_and_sd(&scores);
                let relative = relative.map(|relative| mean_and_sd(&relative));
                Spread {
                    mean,
                    sd,
                    relative_mean: relative.map(|(mean, _)| mean),
                    relative_sd: relative.map(|(_, sd)| sd),
                }
            };
            let seconds: Vec<f32> = chosen.iter().map(|run| run.row.seconds as f32).collect();
            summary.push(SummaryRow {
                scheme: scheme.clone(),
                budget,
                runs: chosen.len(),
                coverage: spread(Objective::Coverage),
                geometry: spread(Objective::Geometry),
                diversity: spread(Objective::Diversity),
                texture: spread(Objective::Texture),
                seconds: mean_and_sd(&seconds).0,
            });
        }
    }
    summary
}

/// Mean and standard deviation (n - 1); the latter is 0 for a single value.
fn mean_and_sd(values: &[f32]) -> (f64, f64) {
    let count = values.len().max(1) as f64;
    let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / count;
    let squares: f64 = values.iter().map(|&value| (f64::from(value) - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

fn table(summary: &[SummaryRow], objects: usize, seeds: u64) -> String {
    let mut text = format!(
        "objects: {objects}, seeds: {seeds}. Mean ± sd over both, and the share of the exact \
         oracle's score:\nthe plan that is greedy on that objective alone after the same three \
         first views by farthest points.\n\n"
    );
    text += &format!(
        "{:>6}  {:<10} {:>21} {:>21} {:>21} {:>21} {:>9}\n",
        "budget", "scheme", "coverage", "geometry", "diversity", "texture", "seconds"
    );
    for (place, row) in summary.iter().enumerate() {
        if place > 0 && summary[place - 1].budget != row.budget {
            text.push('\n');
        }
        let cell = |s: &Spread| {
            let share = s.relative_mean.map_or("–".to_owned(), |r| format!("{:.1} %", 100.0 * r));
            format!("{:.3} ± {:.3} {share:>7}", s.mean, s.sd)
        };
        text += &format!(
            "{:>6}  {:<10} {:>21} {:>21} {:>21} {:>21} {:>9.3}\n",
            row.budget,
            row.scheme,
            cell(&row.coverage),
            cell(&row.geometry),
            cell(&row.diversity),
            cell(&row.texture),
            row.seconds
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_spread_of_known_values() {
        assert_eq!(mean_and_sd(&[1.0, 2.0, 3.0]), (2.0, 1.0));
        assert_eq!(mean_and_sd(&[4.0]), (4.0, 0.0));
    }
}
