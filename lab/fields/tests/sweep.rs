//! A sweep that is interrupted goes on, and does nothing twice.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use clap::Parser;
use vantage_fields::evaluate::{self, EvaluateArgs};
use vantage_fields::runs::Run;

#[derive(Parser)]
struct Cli {
    #[command(flatten)]
    evaluate: EvaluateArgs,
}

fn sweep(out: &Path, schemes: &str, jobs: &str) -> anyhow::Result<()> {
    sweep_of(&["ball"], out, schemes, jobs)
}

fn sweep_of(objects: &[&str], out: &Path, schemes: &str, jobs: &str) -> anyhow::Result<()> {
    let out = out.to_str().unwrap();
    let words = [
        "--field",
        "plenoxels",
        "--steps",
        "12",
        "--test-views",
        "2",
        "--candidates",
        "12",
        "--budgets",
        "3,5",
        "--seeds",
        "2",
        "--schemes",
        schemes,
        "--jobs",
        jobs,
        "--out",
        out,
    ];
    let words = ["evaluate"].iter().chain(objects).chain(&words);
    evaluate::run(&Cli::parse_from(words).evaluate)
}

/// The runs by the names of their files, and when each was written.
fn runs(out: &Path) -> Vec<(String, Run, SystemTime)> {
    let mut runs: Vec<_> = fs::read_dir(out.join("runs"))
        .unwrap()
        .map(|entry| {
            let path = entry.unwrap().path();
            let run = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
            let written = fs::metadata(&path).unwrap().modified().unwrap();
            (path.file_name().unwrap().to_str().unwrap().to_owned(), run, written)
        })
        .collect();
    runs.sort_by(|a, b| a.0.cmp(&b.0));
    runs
}

#[test]
fn what_is_missing_is_done_and_nothing_else() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("sweep");
    sweep(&out, "random,soarnet", "2").unwrap();
    let whole = runs(&out);
    assert_eq!(whole.len(), 2 * 2 * 2);
    // Views of a smaller budget are the first of those of a larger.
    let views =
        |name: &str| whole.iter().find(|run| run.0 == name).unwrap().1.views.clone().unwrap();
    assert_eq!(views("ball.soarnet.1.5.json")[..3], views("ball.soarnet.1.3.json")[..]);
    assert_ne!(views("ball.random.0.5.json"), views("ball.random.1.5.json"));

    // As if it had been killed before two of the runs were kept.
    for name in ["ball.random.1.5.json", "ball.soarnet.0.3.json"] {
        fs::remove_file(out.join("runs").join(name)).unwrap();
    }
    sweep(&out, "random,soarnet,fibonacci", "1").unwrap();
    let again = runs(&out);
    assert_eq!(again.len(), whole.len() + 2); // fibonacci has no chance: one seed, two budgets
    let mut redone = 0;
    for (name, run, written) in &whole {
        let (_, other, then) = again.iter().find(|other| other.0 == *name).unwrap();
        redone += usize::from(then != written);
        let seconds = (run.planning_seconds, run.training_seconds);
        let other =
            Run { planning_seconds: seconds.0, training_seconds: seconds.1, ..other.clone() };
        assert_eq!(*run, other, "{name}");
    }
    assert_eq!(redone, 2);
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("fibonacci") && report.contains("no weights"));
    assert_eq!(fs::read_to_string(out.join("runs.csv")).unwrap().lines().count(), 11);
}

#[test]
fn objects_have_candidates_of_their_own_unless_told_otherwise() {
    let home = tempfile::tempdir().unwrap();
    // Farthest points depend on candidates and seed alone.
    let folder = |options: &[&str]| home.path().join(options.concat()).join("sweep");
    let views = |options: &[&str]| {
        let out = folder(options);
        sweep_of(&[&["ball", "knot"], options].concat(), &out, "fps", "2").unwrap();
        let runs = runs(&out).into_iter().filter(|(_, run, _)| run.budget == 5);
        runs.map(|(_, run, _)| run.views.unwrap()).collect::<Vec<_>>()
    };
    let [ball_0, ball_1, knot_0, knot_1] = &views(&["--same-candidates"])[..] else { panic!() };
    assert_eq!((ball_0, ball_1), (knot_0, knot_1));
    let [ball_0, ball_1, knot_0, knot_1] = &views(&[])[..] else { panic!() };
    assert!(ball_0 != knot_0 && ball_1 != knot_1);

    // A lattice has no candidates of anybody's own, but first views.
    let lattice = "--space=hemisphere";
    let [ball_0, ball_1, knot_0, knot_1] = &views(&[lattice])[..] else { panic!() };
    assert!(ball_0[0] != knot_0[0] || ball_1[0] != knot_1[0]);
    let shared = [lattice, "--same-candidates"];
    let [ball_0, ball_1, knot_0, knot_1] = &views(&shared)[..] else { panic!() };
    assert_eq!((ball_0, ball_1), (knot_0, knot_1));
    // A folder that holds runs of one kind takes none of another.
    let error = sweep_of(&["ball", lattice], &folder(&shared), "fps", "2").unwrap_err();
    assert!(format!("{error:#}").contains("other settings"), "{error:#}");
}

#[test]
fn moving_has_a_price_and_plans_may_end_early() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("sweep");
    let schemes = "fps,fps+move=1,e+stop=1";
    sweep_of(&["ball", "--budgets=12"], &out, schemes, "2").unwrap();
    let runs = runs(&out);
    let mean = |scheme: &str, of: fn(&Run) -> f64| {
        let chosen = runs.iter().map(|(_, run, _)| run);
        let of: Vec<f64> =
            chosen.filter(|run| run.scheme == scheme && run.budget == 12).map(of).collect();
        assert_eq!(of.len(), 2, "{scheme}");
        of.iter().sum::<f64>() / 2.0
    };
    let travel = |run: &Run| run.travel_deg.unwrap();
    assert!(mean("fps+move=1", travel) < 0.8 * mean("fps", travel));
    let photos = |run: &Run| run.photos.unwrap() as f64;
    // Three views to start with, six that are too weak.
    assert_eq!((mean("e+stop=1", photos), mean("fps", photos)), (9.0, 12.0));
    let error = sweep(&home.path().join("other"), "fps+stop=1", "1").unwrap_err();
    assert!(format!("{error:#}").contains("leave it out"), "{error:#}");
}
