//! `cargo vantage results`: the page of results from kept runs.
//!
//! [`Study`] files hold the runs that were kept of sweeps (`evaluate --keep FILE`); `page.md` beside
//! them is the page with marks where tables go:
//!
//! | mark | what takes its place |
//! |---|---|
//! | `{{command STUDY}}` | the commands that made the runs |
//! | `{{quality STUDY}}` | PSNR and SSIM of each scheme and budget, with intervals |
//! | `{{against STUDY BASELINE}}` | paired differences of PSNR from a baseline, with intervals |
//! | `{{less STUDY A B …}}` | the same of A less B alone, a row for each such pair |
//! | `{{plot STUDY BASELINE}}` | both as a picture, `STUDY-BASELINE.svg` in that folder |
//! | `{{objects STUDY BUDGET}}` | PSNR of each object and scheme at a budget |
//! | `{{classes STUDY}}` | PSNR of each class, means over all budgets, beside the paper's |
//! | `{{ceiling STUDY}}` | what searches of `ceiling --keep FILE` found, and their commands |
//! | `{{travel STUDY}}` | photos taken, degrees of travel from the first to the last |
//! | `{{times STUDY}}` | seconds of planning and of training |

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::ceiling::{self, Search};
use crate::page::psnr_svg;
use crate::plans;
use crate::runs::{Run, write_whole};
use crate::study::Study;
use crate::summary::{Difference, Estimate, Row, Summary, summarise, summarise_against};
use vantage_lab::statistics::mean;

/// Write the page of results from the runs that were kept
#[derive(Args, Clone, Debug)]
pub struct ResultsArgs {
    /// Folder of the studies and of page.md
    #[arg(default_value = "lab/results")]
    pub folder: PathBuf,
    /// The page
    #[arg(long, short, default_value = "lab/RESULTS.md", value_name = "FILE")]
    pub out: PathBuf,
}

/// Writes the page.
pub fn run(args: &ResultsArgs) -> Result<()> {
    let page = page(&args.folder)?;
    for (name, svg) in &page.plots {
        write_whole(&args.folder.join(name), svg.as_bytes())?;
    }
    write_whole(&args.out, page.text.as_bytes())?;
    eprintln!("wrote {}", args.out.display());
    Ok(())
}

/// A page, and its pictures: their names in the studies' folder, and what they hold.
#[derive(Clone, Debug, Default)]
pub struct Page {
    pub text: String,
    pub plots: Vec<(String, String)>,
}

/// The page of a folder. Its pictures are named as from the folder's parent.
pub fn page(folder: &Path) -> Result<Page> {
    let path = folder.join("page.md");
    let text =
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut studies: BTreeMap<String, (Study<Run>, Summary)> = BTreeMap::new();
    let (mut page, mut plots) = (String::new(), Vec::new());
    for line in text.lines() {
        let Some(mark) = line.strip_prefix("{{").and_then(|rest| rest.strip_suffix("}}")) else {
            page += line;
            page.push('\n');
            continue;
        };
        let words: Vec<&str> = mark.split_whitespace().collect();
        let Some(&name) = words.get(1) else {
            bail!("{}: the mark {line} names no study", path.display());
        };
        let file = folder.join(name).with_extension("json");
        if words[0] == "ceiling" {
            let study = Study::<Search>::open(&file)?;
            let _ = write!(page, "{}\n{}", commands(&study), ceiling::markdown(&study.runs));
            continue;
        }
        if !studies.contains_key(name) {
            let study = Study::open(&file)?;
            let summary = study.summary();
            studies.insert(name.to_owned(), (study, summary));
        }
        let (study, summary) = &studies[name];
        page += &match words.as_slice() {
            ["command", _] => commands(study),
            ["quality", _] => quality(summary),
            ["plot", _, baseline] => {
                let (svg, words) = plot(summary, baseline)?;
                let home = folder.file_name().unwrap_or_default().to_string_lossy();
                let file = format!("{name}-{baseline}.svg");
                let mark = format!("![{words}]({home}/{file})\n");
                plots.push((file, svg));
                mark
            }
            ["against", _, baseline] => against(summary, baseline)?,
            ["less", _, pairs @ ..] => {
                less(study, pairs).with_context(|| format!("the mark {line}"))?
            }
            ["objects", _, budget] => {
                let budget = budget.parse().with_context(|| format!("no budget in {line}"))?;
                of_objects(study, budget)
            }
            ["classes", _] => classes(study),
            ["travel", _] => travel(summary),
            ["times", _] => times(summary),
            _ => bail!("{}: there is no mark {line}", path.display()),
        };
    }
    Ok(Page { text: page, plots })
}

fn commands<T>(study: &Study<T>) -> String {
    format!("```sh\n{}\n```\n", study.commands.join("\n"))
}

fn cell(estimate: &Estimate, decimals: usize, sign: bool) -> String {
    let number = |value: f64| {
        if sign { format!("{value:+.decimals$}") } else { format!("{value:.decimals$}") }
    };
    let ends = estimate.interval.map(|[low, high]| format!(" [{}, {}]", number(low), number(high)));
    format!("{}{}", number(estimate.value), ends.unwrap_or_default())
}

/// A table with a column for each budget; `of` gives a scheme's cells.
fn by_budget(
    summary: &Summary,
    corner: &str,
    of: impl Fn(&str, usize) -> Option<String>,
) -> String {
    let (mut schemes, mut budgets) = (Vec::new(), Vec::new());
    for row in &summary.rows {
        if !schemes.contains(&row.scheme.as_str()) {
            schemes.push(row.scheme.as_str());
        }
        if !budgets.contains(&row.budget) {
            budgets.push(row.budget);
        }
    }
    let mut text = format!("| {corner} |");
    for budget in &budgets {
        let _ = write!(text, " B = {budget} |");
    }
    text += "\n|---|";
    text += &"---|".repeat(budgets.len());
    for scheme in schemes {
        let cells: Vec<Option<String>> = budgets.iter().map(|&b| of(scheme, b)).collect();
        if cells.iter().any(Option::is_some) {
            let cells: Vec<String> = cells.into_iter().map(Option::unwrap_or_default).collect();
            let _ = write!(text, "\n| {scheme} | {} |", cells.join(" | "));
        }
    }
    text.push('\n');
    text
}

fn quality(summary: &Summary) -> String {
    by_budget(summary, "PSNR in dB, SSIM", |scheme, budget| {
        let row = summary.rows.iter().find(|row| row.scheme == scheme && row.budget == budget)?;
        Some(format!("{}, {}", cell(&row.psnr, 2, false), cell(&row.ssim, 3, false)))
    })
}

/// A picture of the schemes without suffixes that planned every object, and what it shows in words.
///
/// Means over fewer objects would lie beside those over all as if they could be compared.
fn plot(summary: &Summary, baseline: &str) -> Result<(String, String)> {
    let all = summary.rows.iter().map(|row| row.objects).max();
    let is_whole = |scheme: &str| {
        let mut rows = summary.rows.iter().filter(|row| row.scheme == scheme);
        rows.all(|row| Some(row.objects) == all)
    };
    let mut schemes: Vec<String> = Vec::new();
    for Row { scheme, .. } in &summary.rows {
        let is_hindsight = plans::HINDSIGHT.iter().any(|(name, _)| name == scheme);
        let is_plain = !scheme.contains(['@', '+']);
        if is_plain && !is_hindsight && is_whole(scheme) && !schemes.contains(scheme) {
            schemes.push(scheme.clone());
        }
    }
    let words = format!(
        "PSNR of {} against the number of views, and above that of {baseline} for each object",
        schemes.join(", ")
    );
    let is_shown = |scheme: &String| schemes.contains(scheme);
    let mut shown = summary.clone();
    shown.rows.retain(|row| is_shown(&row.scheme));
    shown.differences.retain(|row| is_shown(&row.scheme));
    check_baseline(&shown, baseline)?;
    Ok((psnr_svg(&shown, &schemes, baseline)?, words))
}

/// Fails if nothing is compared with it.
fn check_baseline(summary: &Summary, baseline: &str) -> Result<()> {
    let is_one = summary.differences.iter().any(|row| row.minus == baseline);
    ensure!(
        is_one,
        "there is nothing to compare with {baseline}: name random or fps, if it was run"
    );
    Ok(())
}

fn against(summary: &Summary, baseline: &str) -> Result<String> {
    check_baseline(summary, baseline)?;
    Ok(by_budget(summary, &format!("PSNR less that of {baseline}, dB"), |scheme, budget| {
        let difference = summary.differences.iter().find(|row| {
            (row.scheme.as_str(), row.minus.as_str(), row.budget) == (scheme, baseline, budget)
        })?;
        Some(better(difference))
    }))
}

fn better(difference: &Difference) -> String {
    let (wins, all) = (difference.wins, difference.of_objects.len());
    format!("{}, better on {wins} of {all}", cell(&difference.psnr, 2, true))
}

/// A row for each pair of schemes: what the first has more than the second.
fn less(study: &Study<Run>, pairs: &[&str]) -> Result<String> {
    let budgets = study.budgets();
    let heads: String = budgets.iter().map(|budget| format!(" B = {budget} |")).collect();
    let mut text = format!("| PSNR in dB |{heads}\n|---|{}\n", "---|".repeat(budgets.len()));
    for pair in pairs.chunks(2) {
        let [scheme, minus] = pair else { bail!("{} has nothing to be less", pair.concat()) };
        let schemes = [(*scheme).to_owned()];
        let summary = summarise_against(&study.runs, &schemes, &budgets, &[*minus]);
        ensure!(!summary.differences.is_empty(), "nothing is known of {scheme} less {minus}");
        let cells = budgets.iter().map(|&budget| {
            let row = summary.differences.iter().find(|row| row.budget == budget);
            format!(" {} |", row.map(better).unwrap_or_default())
        });
        let _ = writeln!(text, "| {scheme} less {minus} |{}", cells.collect::<String>());
    }
    Ok(text)
}

fn of_objects(study: &Study<Run>, budget: usize) -> String {
    let schemes = study.schemes();
    let mut objects: Vec<&str> = study.runs.iter().map(|run| run.object.as_str()).collect();
    objects.sort_unstable();
    objects.dedup();
    let column = |object: &str| {
        let runs: Vec<Run> =
            study.runs.iter().filter(|run| run.object == object).cloned().collect();
        let summary = summarise(&runs, &schemes, &[budget]);
        schemes
            .iter()
            .map(|scheme| {
                let row = summary.rows.iter().find(|row| row.scheme == *scheme);
                row.map_or(String::new(), |row| format!("{:.2}", row.psnr.value))
            })
            .collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = objects.iter().map(|object| column(object)).collect();
    let used: Vec<usize> =
        (0..schemes.len()).filter(|&s| rows.iter().any(|row| !row[s].is_empty())).collect();
    let pick = |cells: &[String]| -> String {
        used.iter().map(|&s| cells[s].as_str()).collect::<Vec<_>>().join(" | ")
    };
    let mut text = format!("| PSNR in dB, B = {budget} | {} |\n|---|", pick(&schemes));
    text += &"---|".repeat(used.len());
    for (object, row) in objects.iter().zip(&rows) {
        let _ = write!(text, "\n| {} | {} |", object.replace('_', " "), pick(row));
    }
    text.push('\n');
    text
}

/// PSNR in dB of TensoRF on views of Random, E and Optimal CQDT, means over budgets: table
/// `tab:result_1` of SO-NeRF (Lee et al., 2023).
const PAPER: [(&str, [f64; 3]); 18] = [
    ("bookcase", [28.94, 30.37, 30.42]),
    ("chair", [29.33, 29.59, 30.00]),
    ("cone", [27.64, 28.37, 28.59]),
    ("control", [29.33, 30.41, 30.48]),
    ("earphone", [29.16, 29.74, 30.05]),
    ("fan", [27.30, 27.01, 26.98]),
    ("fireplug", [30.21, 30.37, 31.30]),
    ("globe", [25.54, 26.05, 26.14]),
    ("gravestone", [31.43, 31.52, 31.59]),
    ("guitar", [32.22, 32.43, 32.33]),
    ("lion", [30.53, 30.70, 30.57]),
    ("shoe", [26.23, 26.97, 26.73]),
    ("snowman", [32.01, 32.49, 32.62]),
    ("soccer_ball", [25.53, 24.24, 25.10]),
    ("sunglasses", [28.26, 28.01, 28.61]),
    ("teddy_bear", [30.92, 31.44, 31.53]),
    ("toilet", [28.95, 29.53, 30.13]),
    ("vase", [29.75, 30.92, 30.97]),
];

/// The schemes of the paper's columns.
const COLUMNS: [&str; 3] = ["random", "e", "optimal-cqdt"];

fn classes(study: &Study<Run>) -> String {
    let schemes = COLUMNS.map(str::to_owned);
    let budgets = study.budgets();
    let mean_of = |object: &str| -> Option<[f64; 3]> {
        let runs: Vec<Run> =
            study.runs.iter().filter(|run| run.object == object).cloned().collect();
        let summary = summarise(&runs, &schemes, &budgets);
        let of_scheme = |scheme: &str| {
            let rows = summary.rows.iter().filter(|row| row.scheme == scheme);
            mean(rows.map(|row| row.psnr.value))
        };
        Some([of_scheme(COLUMNS[0])?, of_scheme(COLUMNS[1])?, of_scheme(COLUMNS[2])?])
    };
    let mut text = "| class | paper: Random, E, Optimal CQDT | here: Random, E, Optimal CQDT | \
                    paper: E - Random | here |\n|---|---|---|---|---|\n"
        .to_owned();
    let mut gains: [Vec<f64>; 2] = Default::default();
    for (class, paper) in &PAPER {
        let Some(own) = mean_of(&format!("class:{class}")) else { continue };
        let three = |[a, b, c]: &[f64; 3]| format!("{a:.2}, {b:.2}, {c:.2}");
        let both = [paper[1] - paper[0], own[1] - own[0]];
        for (gains, gain) in gains.iter_mut().zip(both) {
            gains.push(gain);
        }
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:+.2} | {:+.2} |",
            class.replace('_', " "),
            three(paper),
            three(&own),
            both[0],
            both[1]
        );
    }
    let estimates = gains.each_ref().map(|gains| Estimate::of(gains));
    if let [Some(paper), Some(own)] = &estimates {
        let _ = writeln!(text, "| mean | | | {} | {} |", cell(paper, 2, true), cell(own, 2, true));
    }
    text
}

fn travel(summary: &Summary) -> String {
    by_budget(summary, "photos, degrees of travel", |scheme, budget| {
        let row = summary.rows.iter().find(|row| row.scheme == scheme && row.budget == budget)?;
        Some(format!("{:.1}, {:.0}", row.photos?, row.travel_deg?))
    })
}

fn times(summary: &Summary) -> String {
    by_budget(summary, "seconds of planning, of training", |scheme, budget| {
        let row = summary.rows.iter().find(|row| row.scheme == scheme && row.budget == budget)?;
        Some(format!("{:.2}, {:.1}", row.planning_seconds, row.training_seconds))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::tests::run;

    fn folder_of(page: &str) -> tempfile::TempDir {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join("page.md"), page).unwrap();
        let file = home.path().join("small.json");
        let mut runs = Vec::new();
        for (object, base) in [("../a.glb", 20.0), ("b_c", 30.0)] {
            for seed in 0..2 {
                runs.push(run(object, "random", seed, 6, base + seed as f64));
            }
            runs.push(run(object, "fps", 0, 6, base + 1.0));
        }
        Study::keep(&file, "first", &runs[..3]).unwrap();
        Study::keep(&file, "second", &runs).unwrap();
        home
    }

    #[test]
    fn marks_become_tables() {
        let home = folder_of(
            "Title\n{{command small}}\n{{against small random}}\n{{objects small 6}}\n\
                       {{travel small}}\n{{less small fps random random fps}}\n",
        );
        let page = page(home.path()).unwrap().text;
        let expected = "Title\n```sh\nfirst\nsecond\n```\n\
            | PSNR less that of random, dB | B = 6 |\n|---|---|\n\
            | fps | +0.50 [+0.50, +0.50], better on 2 of 2 |\n\
            | PSNR in dB, B = 6 | random | fps |\n|---|---|---|\n\
            | a | 20.50 | 21.00 |\n| b c | 30.50 | 31.00 |\n\
            | photos, degrees of travel | B = 6 |\n|---|---|\n\
            | random | 6.0, 90 |\n| fps | 6.0, 90 |\n\
            | PSNR in dB | B = 6 |\n|---|---|\n\
            | fps less random | +0.50 [+0.50, +0.50], better on 2 of 2 |\n\
            | random less fps | -0.50 [-0.50, -0.50], better on 0 of 2 |\n";
        assert_eq!(page, expected);
    }

    #[test]
    fn runs_are_kept_once_and_without_their_views() {
        let home = folder_of("");
        let study = Study::<Run>::open(&home.path().join("small.json")).unwrap();
        assert_eq!(study.runs.len(), 6);
        assert!(study.runs.iter().all(|run| run.views.is_none()));
        assert_eq!(study.commands, ["first", "second"]);
        Study::<Run>::check(&home.path().join("other.json")).unwrap();
        let error = Study::<Run>::check(&home.path().join("page.md")).unwrap_err();
        assert!(error.to_string().contains("is no study"), "{error}");
    }

    #[test]
    fn what_cannot_be_is_told() {
        for (mark, told) in [
            ("{{quality}}", "names no study"),
            ("{{quality other}}", "cannot read"),
            ("{{ceiling other}}", "cannot read"),
            ("{{best small}}", "there is no mark"),
            ("{{objects small x}}", "no budget"),
            ("{{against small e}}", "nothing to compare"),
            ("{{less small fps e}}", "nothing is known of fps less e"),
            ("{{less small fps}}", "nothing to be less"),
            ("{{plot small e}}", "nothing to compare"),
        ] {
            let error = format!("{:#}", page(folder_of(mark).path()).unwrap_err());
            assert!(error.contains(told), "{error}");
        }
    }

    #[test]
    fn the_page_in_the_repository_is_the_one_of_its_runs() {
        let lab = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let known = fs::read_to_string(lab.join("RESULTS.md")).unwrap();
        let made = page(&lab.join("results")).unwrap();
        let told = "run `cargo vantage results`: lab/RESULTS.md is not of these runs";
        assert!(known == made.text, "{told}");
        for (name, svg) in made.plots {
            assert!(fs::read_to_string(lab.join("results").join(name)).unwrap() == svg, "{told}");
        }
    }
}
