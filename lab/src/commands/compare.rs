//! `cargo vantage compare`: exact scores of schemes over objects and budgets.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use image::RgbImage;
use indicatif::ProgressBar;
use rayon::prelude::*;
use vantage_core::planner::Plan;
use vantage_core::{Camera, Objective, Pose, Scores};

use super::{ModelArgs, ScoreArgs};
use crate::exact::{Labelled, Step};
use crate::mesh::Chance;
use crate::metrics;
use crate::network::{self, Network};
use crate::object::Object;
use crate::pool::PoolArgs;
use crate::record::{
    ComparisonRecord, ComparisonRow, Estimate, Measure, MetricRow, MetricsRecord, OfObjective,
    Spread, SummaryRow,
};
use crate::scheme;

/// Options of `compare`.
#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    /// Objects: files, built-in names, classes, NAME:SEED for one made from another seed, or folders
    /// of GLB, glTF and OBJ files; every built-in one if none is named
    #[arg(conflicts_with = "procedural")]
    pub objects: Vec<String>,
    /// Compare on the first N objects of the test split of `dataset`'s, of the data set whose seed is
    /// --object-seed: never trained on
    #[arg(long, value_name = "N")]
    pub procedural: Option<usize>,
    /// Schemes, separated by commas: those of `plan`, where soarnet and soarnet-poses bring their
    /// plans of each objective along, and oracle (c, q, d and t: the exact plan of each objective).
    /// With oracle or a network, rank correlations and closed gaps are measured too. Behind those of
    /// `plan` may stand, in this order, @SHARE, the least distance from the views so far,
    /// +opposite=WEIGHT, how much the side opposite a view counts as that view, +start=VIEWS, the
    /// number of first views, +move=COST, a price on moving: fps+move=0.5
    #[arg(long, value_delimiter = ',', default_value = "random,fps,e,c,q,d,t,sum")]
    pub schemes: Vec<String>,
    /// Budgets, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "3,6,12,20,30")]
    pub budgets: Vec<usize>,
    /// Runs of each scheme, with seeds 0, 1, 2 …
    #[arg(long, default_value_t = 5, value_name = "N")]
    pub seeds: u64,
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub pool: PoolArgs,
    /// Draw other candidates from the sphere for each object and each seed
    #[arg(long, conflicts_with_all = ["pool", "pool_seed", "space"])]
    pub random_candidates: bool,
    #[command(flatten)]
    pub score: ScoreArgs,
    /// Print rows, summary and metrics as JSON
    #[arg(long)]
    pub json: bool,
}

/// A row, and its scores relative to the exact oracle of each objective.
struct Run {
    row: ComparisonRow,
    relative: Option<Scores>, // none where the oracle has not chosen yet
}

/// All runs of one object.
#[derive(Default)]
struct Compared {
    runs: Vec<Run>,
    measured: Vec<metrics::Run>,
}

/// Runs the comparison and prints it.
pub fn run(args: &CompareArgs) -> Result<()> {
    let (comparison, failed) = compare(args)?;
    if args.json {
        super::print(&format!("{}\n", serde_json::to_string(&comparison)?))?;
    } else {
        let mut objects: Vec<&str> =
            comparison.rows.iter().map(|row| row.object.as_str()).collect();
        objects.dedup();
        super::print(&table(&comparison.summary, objects.len(), args.seeds))?;
        if let Some(metrics) = &comparison.metrics {
            super::print(&metrics_table(metrics))?;
        }
    }
    if failed > 0 {
        bail!("{failed} objects were left out");
    }
    Ok(())
}

/// Runs the comparison; gives its record, and how many objects could not be used.
pub fn compare(args: &CompareArgs) -> Result<(ComparisonRecord, usize)> {
    let objects = match args.procedural {
        Some(count) => procedural(args.score.object_seed, count)?,
        None => objects_of(&args.objects)?,
    };
    let poses = args.pool.poses()?;
    for scheme in &args.schemes {
        if scheme != scheme::ORACLE && scheme::plan(scheme, 1, 0).is_none() {
            bail!("{}", scheme::unknown(scheme, &[scheme::ORACLE]));
        }
        if scheme::stops(scheme) {
            bail!(
                "{scheme} may end before its budget, where there is nothing to compare: leave out +stop"
            );
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
    let networks = args.model.networks(&args.schemes)?;
    let comparison = Comparison { args, poses: &poses, camera: &camera, most, networks };

    let bar = super::progress("comparing", objects.len() * comparison.views_labelled());
    let compared = |(number, name): (usize, &String)| -> Option<Compared> {
        let compared = comparison.object(number, name, &bar);
        compared
            .map_err(|error| {
                bar.suspend(|| eprintln!("error: {name} is left out: {error:#}"));
            })
            .ok()
    };
    // Objects side by side are sooner done, but not if seconds of planning are the question.
    let found: Vec<Option<Compared>> = if comparison.is_measured() {
        objects.par_iter().enumerate().map(compared).collect()
    } else {
        objects.iter().enumerate().map(compared).collect()
    };
    bar.finish_and_clear();
    let failed = found.iter().filter(|found| found.is_none()).count();
    if failed == objects.len() {
        bail!("none of the objects could be compared");
    }
    let (mut runs, mut measured) = (Vec::new(), Vec::new());
    for found in found.into_iter().flatten() {
        runs.extend(found.runs);
        measured.extend(found.measured);
    }
    let summary = summarise(&runs, args);
    let metrics = comparison
        .is_measured()
        .then(|| metrics::summarise(&measured, &args.budgets, Plan::START_VIEWS));
    let drawn = args.random_candidates;
    let record = ComparisonRecord {
        rows: runs.into_iter().map(|run| run.row).collect(),
        summary,
        pool_seed: args.pool.seed().filter(|_| !drawn),
        pool: args.pool.record(),
        random_candidates: drawn,
        scoring: args.score.scoring(),
        metrics,
    };
    Ok((record, failed))
}

/// Names of the first objects of a data set's test split.
fn procedural(seed: u64, count: usize) -> Result<Vec<String>> {
    if !(1..=10_000).contains(&count) {
        bail!("--procedural must lie between 1 and 10000, not be {count}");
    }
    let objects = crate::dataset::test_objects(seed, count);
    Ok(objects.into_iter().map(|(class, seed)| format!("class:{class}:{seed}")).collect())
}

/// The files in folders, and whatever else is named.
pub fn objects_of(names: &[String]) -> Result<Vec<String>> {
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

/// What all objects are compared by.
struct Comparison<'a> {
    args: &'a CompareArgs,
    poses: &'a [Pose],
    camera: &'a Camera,
    most: usize, // the largest budget
    networks: Vec<(scheme::Network, Network)>,
}

impl Comparison<'_> {
    /// Whether rank correlations and closed gaps are wanted.
    fn is_measured(&self) -> bool {
        let oracle = self.args.schemes.iter().any(|scheme| scheme == scheme::ORACLE);
        oracle || !self.networks.is_empty()
    }

    /// The network that a scheme asks.
    fn network_of(&self, scheme: &str) -> Option<&Network> {
        let (asked, _) = scheme::network(scheme)?;
        self.networks.iter().find(|(known, _)| *known == asked).map(|(_, network)| network)
    }

    /// Candidates that are labelled for each object.
    fn views_labelled(&self) -> usize {
        let pools = if self.args.random_candidates { self.args.seeds as usize } else { 1 };
        pools * self.poses.len()
    }

    fn object(&self, number: usize, name: &str, bar: &ProgressBar) -> Result<Compared> {
        let args = self.args;
        let views = self.views_labelled() as u64;
        let mut object =
            Object::open(Some(name), args.score.object_seed).inspect_err(|_| bar.inc(views))?;
        // Two objects made from different seeds bear different names.
        if name.starts_with("class:") {
            object.name = name.trim_start_matches("class:").to_owned();
        }
        super::warn(&object, Some(bar));
        let label = |poses: Vec<Pose>| -> Result<Labelled> {
            let reading = args.score.reading();
            let labelled = Labelled::new(&object.mesh, self.camera, poses, reading, || bar.inc(1));
            let supported = args.schemes.iter().any(|scheme| scheme::needs_support(scheme));
            if supported { labelled.with_support(&object.mesh) } else { Ok(labelled) }
        };
        let mut compared = Compared::default();
        let common = if args.random_candidates { None } else { Some(label(self.poses.to_vec())?) };
        let mut photos = Vec::new();
        for seed in 0..args.seeds {
            let (pool_seed, own);
            let labelled = match &common {
                Some(labelled) => {
                    pool_seed = args.pool.seed();
                    labelled
                }
                None => {
                    let drawn = seed_of(name, seed);
                    pool_seed = Some(drawn);
                    own = label(PoolArgs { pool_seed: drawn, ..args.pool.clone() }.poses()?)?;
                    &own
                }
            };
            if photos.is_empty() || args.random_candidates {
                let wanted = !self.networks.is_empty();
                photos =
                    if wanted { network::photos(&object.mesh, &labelled.poses)? } else { vec![] };
            }
            let one = OneSeed {
                comparison: self,
                name: &object.name,
                labelled,
                photos: &photos,
                seed,
                pool_seed,
            };
            one.compare(number, &mut compared)?;
        }
        Ok(compared)
    }
}

/// The seed of candidates that are an object's own.
pub fn seed_of(name: &str, seed: u64) -> u64 {
    let salt = name.bytes().fold(0, |salt: u64, byte| salt.rotate_left(7) ^ u64::from(byte));
    Chance::new(salt ^ seed << 48).bits()
}

/// One object with its candidates and one seed.
struct OneSeed<'a> {
    comparison: &'a Comparison<'a>,
    name: &'a str,
    labelled: &'a Labelled,
    photos: &'a [RgbImage], // (candidates); empty where no network asks
    seed: u64,
    pool_seed: Option<u64>,
}

impl OneSeed<'_> {
    fn compare(&self, number: usize, into: &mut Compared) -> Result<()> {
        let args = self.comparison.args;
        let mut done: HashMap<String, Vec<Step>> = HashMap::new();
        for objective in Objective::ALL {
            let name = scheme::oracle(objective);
            done.insert(name.to_owned(), self.steps_of(name)?);
        }
        for scheme in &args.schemes {
            for name in plans_of(scheme) {
                if !done.contains_key(name) {
                    done.insert(name.to_owned(), self.steps_of(name)?);
                }
            }
        }
        let oracles = Objective::ALL.map(|objective| done[scheme::oracle(objective)].as_slice());
        for name in rows_of(&args.schemes) {
            let steps = &done[name];
            // A greedy plan of a smaller budget is the beginning of one of a larger.
            for &budget in &args.budgets {
                let Some(step) = steps.get(budget - 1) else { continue };
                let row = ComparisonRow {
                    object: self.name.to_owned(),
                    scheme: name.to_owned(),
                    budget,
                    seed: self.seed,
                    pool_seed: self.pool_seed,
                    scores: step.scores,
                    views: steps[..budget].iter().map(|step| step.next.index).collect(),
                    seconds: step.seconds,
                };
                let relative =
                    (budget > Plan::START_VIEWS).then(|| relative(&step.scores, &oracles, budget));
                into.runs.push(Run { row, relative });
            }
        }
        if self.comparison.is_measured() && self.comparison.most > Plan::START_VIEWS {
            into.measured.push(self.measure(number, &done)?);
        }
        Ok(())
    }

    fn steps_of(&self, name: &str) -> Result<Vec<Step>> {
        let plan = scheme::plan(name, self.comparison.most, self.seed);
        let plan = plan.with_context(|| scheme::unknown(name, &[]))?;
        match self.comparison.network_of(name) {
            None => self.labelled.run(plan, || {}),
            Some(network) => network.run(self.labelled, self.photo(), plan, || {}),
        }
    }

    /// What a candidate's camera takes.
    fn photo(&self) -> impl Fn(usize) -> RgbImage {
        |index| self.photos[index].clone()
    }

    /// Rank correlations and scores for closed gaps, of plans that are done.
    fn measure(&self, number: usize, done: &HashMap<String, Vec<Step>>) -> Result<metrics::Run> {
        let start = Plan::START_VIEWS;
        let random = self.labelled.random_after_start(self.comparison.most, self.seed)?;
        let path: Vec<usize> = random.iter().map(|step| step.next.index).collect();
        let random: Vec<Scores> = random.iter().map(|step| step.scores).collect();
        let exact = self.labelled.gains_along(&path, start)?;
        // By objective, the scores of the plan for it.
        let scores = |plan_for: &dyn Fn(Objective) -> Vec<Scores>| -> Vec<[f32; 4]> {
            let plans = Objective::ALL.map(plan_for);
            let score = |step: usize| {
                Objective::ALL.map(|objective| plans[objective as usize][step].get(objective))
            };
            let length = plans.iter().map(Vec::len).min().unwrap_or(0);
            (0..length).map(score).collect()
        };
        let scores_of = |steps: &[Step]| steps.iter().map(|step| step.scores).collect();
        let scheme = |scheme: &String| -> Result<metrics::SchemeRun> {
            let poses = &self.labelled.poses;
            let predicted = match (scheme.as_str(), self.comparison.network_of(scheme)) {
                (_, Some(network)) => {
                    Some(network.gains_along(poses, self.photo(), &path, start)?)
                }
                ("fps", _) => Some(metrics::distances_along(poses, &path, start)),
                (scheme::ORACLE, _) => Some(exact.clone()),
                _ => None,
            };
            let spearman = predicted.map_or(Vec::new(), |predicted| {
                metrics::rank_correlations(&path, start, &predicted, &exact)
            });
            let scores = scores(&|objective| match scheme.as_str() {
                // Chance after the same first views, which the scheme itself is without.
                "random" => random.clone(),
                _ => scores_of(&done[plan_for(scheme, objective)]),
            });
            Ok(metrics::SchemeRun { scheme: scheme.clone(), scores, spearman })
        };
        Ok(metrics::Run {
            number,
            object: self.name.to_owned(),
            schemes: self.comparison.args.schemes.iter().map(scheme).collect::<Result<_>>()?,
            oracle: scores(&|objective| scores_of(&done[scheme::oracle(objective)])),
            random,
        })
    }
}

/// The plans that a scheme of a comparison stands for: the first is its own.
fn plans_of(scheme: &str) -> Vec<&str> {
    match (scheme, family(scheme)) {
        (scheme::ORACLE, _) => Objective::ALL.map(scheme::oracle).to_vec(),
        (_, Some(network)) => {
            let singles = Objective::ALL.map(|objective| network.single(objective));
            [scheme].into_iter().chain(singles).collect()
        }
        _ => vec![scheme],
    }
}

/// The plan of a scheme for one objective.
fn plan_for(scheme: &str, objective: Objective) -> &str {
    match (scheme, family(scheme)) {
        (scheme::ORACLE, _) => scheme::oracle(objective),
        (_, Some(network)) => network.single(objective),
        _ => scheme,
    }
}

/// The network whose plans of each objective belong to a scheme.
fn family(scheme: &str) -> Option<scheme::Network> {
    let networks = [scheme::Network::Soarnet, scheme::Network::Poses];
    networks.into_iter().find(|network| network.name() == scheme)
}

/// All plans that have rows, each once, in the order of the schemes.
fn rows_of(schemes: &[String]) -> Vec<&str> {
    let mut rows: Vec<&str> = Vec::new();
    for name in schemes.iter().flat_map(|scheme| plans_of(scheme)) {
        if !rows.contains(&name) {
            rows.push(name);
        }
    }
    rows
}

fn relative(scores: &Scores, oracles: &[&[Step]; 4], budget: usize) -> Scores {
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
        for scheme in rows_of(&args.schemes) {
            let chosen: Vec<&Run> = runs
                .iter()
                .filter(|run| run.row.scheme == scheme && run.row.budget == budget)
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
                scheme: scheme.to_owned(),
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

fn metrics_table(metrics: &MetricsRecord) -> String {
    let line = |scheme: &str, budget: usize, of: &OfObjective<Estimate>, mean: &Estimate| {
        let cells = [of.coverage, of.geometry, of.diversity, of.texture, *mean].map(|estimate| {
            let Estimate { value, low, high } = estimate;
            let interval = low.zip(high).map(|(low, high)| format!(" [{low:.2}, {high:.2}]"));
            let cell = value.map_or("–".to_owned(), |value| format!("{value:.3}"));
            format!(" {:>20}", cell + &interval.unwrap_or_default())
        });
        format!("{budget:>6}  {scheme:<24}{}\n", cells.concat())
    };
    let mut text = format!(
        "\nAfter the same three first views by farthest points (plans by support: one); means over \
         objects with 95 % intervals from {} bootstrap\nresamples of the objects.\n",
        metrics.resamples
    );
    let head = format!(
        "{:>6}  {:<24} {:>20} {:>20} {:>20} {:>20} {:>20}\n",
        "budget", "scheme", "coverage", "geometry", "diversity", "texture", "mean"
    );
    let section = |title: &str| format!("\n{title}\n\n{head}");
    let rows = |rows: &[MetricRow]| -> String {
        rows.iter().map(|row| line(&row.scheme, row.budget, &row.of_objective, &row.mean)).collect()
    };
    text += &section("Spearman's rank correlation of predicted with exact gains:");
    text += &rows(&metrics.spearman);
    text += &section("Closed gap, (scheme - random) / (exact oracle - random), ratio of means:");
    text += &rows(&metrics.closed_gap);
    for (measure, title) in [
        (Measure::Spearman, "Paired differences of the rank correlations:"),
        (Measure::ClosedGap, "Paired differences of the closed gaps:"),
    ] {
        let rows: String = metrics
            .differences
            .iter()
            .filter(|row| row.measure == measure)
            .map(|row| {
                let name = format!("{} - {}", row.scheme, row.minus);
                line(&name, row.budget, &row.of_objective, &row.mean)
            })
            .collect();
        if !rows.is_empty() {
            text += &section(title);
            text += &rows;
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(clap::Parser)]
    struct Cli {
        #[command(flatten)]
        compare: CompareArgs,
    }

    fn says(arguments: &[&str]) -> String {
        match <Cli as clap::Parser>::try_parse_from(["compare"].iter().chain(arguments)) {
            Ok(Cli { compare }) => format!("{:#}", run(&compare).unwrap_err()),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn what_cannot_be_compared_is_said() {
        for (arguments, words) in [
            (&["--schemes", "best"][..], "no scheme `best`"),
            (&["--schemes", "e+stop=0.01"], "leave out +stop"),
            (
                &["--schemes", "soarnet", "--model", "none.model"],
                "cannot read the model none.model",
            ),
            (&["--budgets", "0"], "a budget is 0"),
            (&["--budgets", "101"], "larger than the 100 candidates"),
            (&["--seeds", "0"], "--seeds is 0"),
            (&["--procedural", "0"], "--procedural must lie"),
            (&["chair", "--procedural", "2"], "cannot be used with"),
            (&["--random-candidates", "--space", "rings"], "cannot be used with"),
            (&["no-such-object", "--budgets", "4"], "none of the objects"),
        ] {
            let found = says(arguments);
            assert!(found.contains(words), "{found}");
        }
    }

    #[test]
    fn schemes_stand_for_plans() {
        let schemes = ["fps", "oracle", "soarnet", "c"].map(str::to_owned);
        let rows = [
            "fps",
            "c",
            "q",
            "d",
            "t",
            "soarnet",
            "soarnet-c",
            "soarnet-q",
            "soarnet-d",
            "soarnet-t",
        ];
        assert_eq!(rows_of(&schemes), rows);
        assert_eq!(plan_for("soarnet-poses", Objective::Texture), "soarnet-poses-t");
        assert_eq!(plan_for("soarnet-q", Objective::Texture), "soarnet-q");
        assert_eq!(plan_for("oracle", Objective::Diversity), "d");
    }

    #[test]
    fn procedural_objects_are_of_the_test_split() {
        let names = procedural(0, 12).unwrap();
        assert_eq!(names, procedural(0, 12).unwrap());
        assert_ne!(names, procedural(1, 12).unwrap());
        assert!(names.iter().any(|name| name.starts_with("class:fan:")));
        for name in &names {
            Object::open(Some(name), 0).unwrap();
        }
        assert!(procedural(0, 0).is_err());
    }

    #[test]
    fn mean_and_spread_of_known_values() {
        assert_eq!(mean_and_sd(&[1.0, 2.0, 3.0]), (2.0, 1.0));
        assert_eq!(mean_and_sd(&[4.0]), (4.0, 0.0));
    }
}
