//! What a sweep says: means over objects with intervals, and paired differences.

use serde::{Deserialize, Serialize};
use vantage_lab::statistics::{interval, mean};

use crate::plans::parts;
use crate::runs::Run;

/// A mean over objects and its 95 % bootstrap interval; none for a single object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean.
    pub value: f64,
    /// Lower and upper end.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// Of a value for each object; none of no value.
    pub fn of(values: &[f64]) -> Option<Self> {
        let value = mean(values.iter().copied())?;
        let of_draw = |drawn: &[usize]| mean(drawn.iter().map(|&object| values[object]));
        Some(Self { value, interval: interval(values.len(), of_draw) })
    }
}

/// A scheme at a budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub scheme: String,
    pub budget: usize,
    /// Objects that have all their runs.
    pub objects: usize,
    /// Decibels.
    pub psnr: Estimate,
    pub ssim: Estimate,
    /// None without weights.
    pub lpips: Option<Estimate>,
    /// Photos taken, mean over all runs; none if a run does not tell.
    pub photos: Option<f64>,
    /// Degrees of travel around the object, likewise.
    pub travel_deg: Option<f64>,
    /// Mean over all runs.
    pub planning_seconds: f64,
    /// Mean over all runs.
    pub training_seconds: f64,
}

/// How much better one scheme is than another at a budget, paired by object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    pub scheme: String,
    pub minus: String,
    pub budget: usize,
    /// PSNR, decibels.
    pub psnr: Estimate,
    /// Of each object; shape (objects).
    pub of_objects: Vec<f64>,
    /// Objects where the first is better.
    pub wins: usize,
}

/// Everything that is told of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    pub rows: Vec<Row>,
    pub differences: Vec<Difference>,
}

/// The schemes that others are compared with, where they are among them.
const BASELINES: [&str; 2] = ["random", "fps"];

/// The runs of a scheme on one object: of each of its seeds the best part, for schemes in hindsight.
fn runs_of<'a>(runs: &'a [Run], object: &str, scheme: &str, budget: usize) -> Vec<&'a Run> {
    let of = |scheme: &str, seed: u64| {
        runs.iter().find(|run| {
            (run.object.as_str(), run.scheme.as_str()) == (object, scheme)
                && (run.seed, run.budget) == (seed, budget)
        })
    };
    let seeds = runs.iter().map(|run| run.seed).max().map_or(0, |most| most + 1);
    let best = |seed: u64| -> Option<&Run> {
        let found: Option<Vec<&Run>> =
            parts(scheme, seed).iter().map(|(scheme, seed)| of(scheme, *seed)).collect();
        found?.into_iter().max_by(|a, b| a.psnr.total_cmp(&b.psnr))
    };
    (0..seeds).filter_map(best).collect()
}

/// Means over the seeds of each object, then over objects.
pub fn summarise(runs: &[Run], schemes: &[String], budgets: &[usize]) -> Summary {
    summarise_against(runs, schemes, budgets, &BASELINES)
}

/// The same, with differences from these schemes.
pub fn summarise_against(
    runs: &[Run],
    schemes: &[String],
    budgets: &[usize],
    baselines: &[&str],
) -> Summary {
    let mut objects: Vec<&str> = Vec::new();
    for run in runs {
        if !objects.contains(&run.object.as_str()) {
            objects.push(&run.object);
        }
    }
    let of_object = |scheme: &str, budget: usize, object: &str, value: fn(&Run) -> Option<f64>| {
        let runs = runs_of(runs, object, scheme, budget);
        let values: Option<Vec<f64>> = runs.into_iter().map(value).collect();
        mean(values?)
    };
    let psnr = |run: &Run| Some(run.psnr);
    let mut summary = Summary { rows: Vec::new(), differences: Vec::new() };
    for &budget in budgets {
        for scheme in schemes {
            let over = |value: fn(&Run) -> Option<f64>| -> Vec<f64> {
                objects
                    .iter()
                    .filter_map(|object| of_object(scheme, budget, object, value))
                    .collect()
            };
            let values = over(psnr);
            let all: Vec<&Run> =
                objects.iter().flat_map(|object| runs_of(runs, object, scheme, budget)).collect();
            let (Some(of_psnr), Some(ssim)) =
                (Estimate::of(&values), Estimate::of(&over(|run| Some(run.ssim))))
            else {
                continue;
            };
            let seconds = |of: fn(&Run) -> f64| mean(all.iter().map(|run| of(run))).unwrap_or(0.0);
            let told = |of: fn(&Run) -> Option<f64>| {
                mean(all.iter().map(|run| of(run)).collect::<Option<Vec<f64>>>()?)
            };
            summary.rows.push(Row {
                scheme: scheme.clone(),
                budget,
                objects: values.len(),
                psnr: of_psnr,
                ssim,
                lpips: Estimate::of(&over(|run| run.lpips)),
                photos: told(|run| run.photos.map(|photos| photos as f64)),
                travel_deg: told(|run| run.travel_deg),
                planning_seconds: seconds(|run| run.planning_seconds),
                training_seconds: seconds(|run| run.training_seconds),
            });
            for minus in baselines.iter().filter(|minus| *minus != scheme) {
                let difference = |object: &&str| {
                    let own = of_object(scheme, budget, object, psnr)?;
                    Some(own - of_object(minus, budget, object, psnr)?)
                };
                let of_objects: Vec<f64> = objects.iter().filter_map(difference).collect();
                let Some(psnr) = Estimate::of(&of_objects) else { continue };
                summary.differences.push(Difference {
                    scheme: scheme.clone(),
                    minus: (*minus).to_owned(),
                    budget,
                    psnr,
                    wins: of_objects.iter().filter(|&&value| value > 0.0).count(),
                    of_objects,
                });
            }
        }
    }
    summary
}

fn cell(estimate: &Estimate, decimals: usize) -> String {
    let ends =
        estimate.interval.map(|[low, high]| format!(" [{low:.decimals$}, {high:.decimals$}]"));
    format!("{:.decimals$}{}", estimate.value, ends.unwrap_or_default())
}

/// The summary as text of fixed width.
pub fn table(summary: &Summary) -> String {
    let mut text = format!(
        "Means over objects of their means over seeds, with 95 % bootstrap intervals over objects.\n\n\
         {:>6}  {:<18} {:>7} {:>24} {:>24} {:>24} {:>9} {:>9}\n",
        "budget", "scheme", "objects", "PSNR in dB", "SSIM", "LPIPS", "plan s", "train s"
    );
    let mut last = None;
    for row in &summary.rows {
        if last.is_some_and(|last| last != row.budget) {
            text.push('\n');
        }
        last = Some(row.budget);
        let lpips = row.lpips.map_or("no weights".to_owned(), |lpips| cell(&lpips, 4));
        text += &format!(
            "{:>6}  {:<18} {:>7} {:>24} {:>24} {:>24} {:>9.3} {:>9.1}\n",
            row.budget,
            row.scheme,
            row.objects,
            cell(&row.psnr, 2),
            cell(&row.ssim, 4),
            lpips,
            row.planning_seconds,
            row.training_seconds
        );
    }
    if !summary.differences.is_empty() {
        text +=
            "\nPaired differences of PSNR in dB, and on how many objects the first is better:\n\n";
    }
    for row in &summary.differences {
        text += &format!(
            "{:>6}  {:<32} {:>24} {:>8}\n",
            row.budget,
            format!("{} - {}", row.scheme, row.minus),
            cell(&row.psnr, 2),
            format!("{} of {}", row.wins, row.of_objects.len())
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::tests::run;

    #[test]
    fn differences_are_paired_by_object_and_hindsight_takes_the_best() {
        let mut runs = Vec::new();
        for (object, base) in [("a", 20.0), ("b", 30.0)] {
            for (seed, off) in [-1.0, 0.0, 2.0, -1.0].into_iter().enumerate() {
                runs.push(run(object, "random", seed as u64, 6, base + off));
            }
            runs.push(run(object, "fps", 0, 6, base + if object == "a" { 1.5 } else { -0.5 }));
        }
        let schemes = ["random", "best-of-4-random", "fps"].map(str::to_owned);
        let summary = summarise(&runs, &schemes, &[6, 12]);
        let means: Vec<f64> = summary.rows.iter().map(|row| row.psnr.value).collect();
        assert_eq!(means, [25.0, 27.0, 25.5]);
        let find = |scheme: &str, minus: &str| {
            let is = |row: &&Difference| row.scheme == scheme && row.minus == minus;
            summary.differences.iter().find(is).unwrap()
        };
        let fps = find("fps", "random");
        assert_eq!((fps.of_objects.as_slice(), fps.wins), ([1.5, -0.5].as_slice(), 1));
        assert_eq!(fps.psnr.interval, Some([-0.5, 1.5]));
        assert_eq!(find("best-of-4-random", "random").psnr.value, 2.0);
        assert!(summary.rows.iter().all(|row| row.lpips.is_none() && row.objects == 2));
        assert!(table(&summary).contains("no weights"));
    }
}
