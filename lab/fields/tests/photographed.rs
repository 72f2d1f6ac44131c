//! A folder like one of NeRF's synthetic scenes is evaluated as an object is.

use std::fs;
use std::path::Path;

use clap::Parser;
use vantage_core::Camera;
use vantage_fields::evaluate::{self, EvaluateArgs};
use vantage_fields::photos::{dense_views, test_circle};
use vantage_fields::runs::Run;
use vantage_lab::export::{self, Capture, Profile};
use vantage_lab::object::Object;
use vantage_lab::pool::FOV_X_RAD;
use vantage_lab::render::{PhotoOptions, Renderer};

#[derive(Parser)]
struct Cli {
    #[command(flatten)]
    evaluate: EvaluateArgs,
}

/// A scene of photos of 120 x 120 pixels, 12 to train on and 3 to test by.
fn scene(folder: &Path) {
    let object = Object::open(Some("knot"), 0).unwrap();
    let camera = Camera::from_fov(120, 120, FOV_X_RAD).unwrap();
    let renderer = Renderer::new(&object.mesh);
    let capture = |poses: Vec<vantage_core::Pose>| {
        let photo = |pose| {
            let image = renderer.photo(&camera, &pose, &PhotoOptions::default());
            export::Photo { pose, image }
        };
        Capture { camera, photos: poses.into_iter().map(photo).collect(), points: Vec::new() }
    };
    let [train, test] = [dense_views(12), test_circle(3)].map(|poses| capture(poses.unwrap()));
    export::write(folder, Profile::NerfSynthetic { val: None, test: &test }, &train).unwrap();
}

fn sweep(object: &str, out: &Path, more: &str) -> anyhow::Result<()> {
    let out = out.to_str().unwrap();
    let words = ["evaluate", object, "--field", "plenoxels", "--steps", "40", "--seeds", "1"];
    let cli = Cli::try_parse_from(words.into_iter().chain(["--out", out]).chain(more.split(' ')))?;
    evaluate::run(&cli.evaluate)
}

#[test]
fn views_to_train_on_are_the_candidates_and_views_to_test_by_the_test() {
    let home = tempfile::tempdir().unwrap();
    let all = home.path().join("synthetic");
    fs::create_dir(&all).unwrap();
    scene(&all.join("knot"));
    let (all, out) = (all.to_str().unwrap(), home.path().join("sweep"));
    sweep(all, &out, "--schemes random,fps,soarnet --budgets 3,8 --test-views 2 --fly").unwrap();
    let name = Path::new(all).join("knot").to_str().unwrap().to_owned();
    let mut runs: Vec<Run> = fs::read_dir(out.join("runs"))
        .unwrap()
        .map(|file| serde_json::from_slice(&fs::read(file.unwrap().path()).unwrap()).unwrap())
        .collect();
    runs.sort_by_key(|run: &Run| (run.scheme.clone(), run.budget));
    assert_eq!(runs.len(), 6);
    for pair in runs.chunks(2) {
        let [few, many] = pair else { panic!() };
        let views = |run: &Run| run.views.clone().unwrap();
        assert_eq!(views(few), views(many)[..3]);
        let mut each = views(many);
        each.sort_unstable();
        each.dedup();
        assert!(each.len() == 8 && each.iter().all(|&view| view < 12));
        assert!(many.object == name && many.psnr > few.psnr.max(15.0), "{few:?} {many:?}");
    }
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert_eq!(report.matches("data:image/gif").count(), 3);

    // What cannot be done is said before anything is.
    let other = home.path().join("other");
    for (object, more, words) in [
        (all, "--schemes fps,e", "the scheme e needs a mesh"),
        (all, "--schemes optimal-cqdt", "the scheme optimal-cqdt needs a mesh"),
        (all, "--schemes fibonacci", "the scheme fibonacci needs a mesh"),
        (all, "--schemes fps --budgets 20", "none of the objects"),
        (all, "--schemes fps --budgets 3 --preset paper", "none of the objects"),
        (home.path().to_str().unwrap(), "--schemes fps", "holds no GLB"),
    ] {
        let error = sweep(object, &other, more).unwrap_err();
        assert!(format!("{error:#}").contains(words), "{error:#}");
        assert!(!other.exists());
    }
}
