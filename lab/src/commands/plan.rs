//! `cargo vantage plan`: from an object to a plan, its photos, and a folder that trainers open.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::{Plan, Start, Stop, shortest_tour};
use vantage_core::{Camera, Pose, Scores, Vec3};

use super::photos::PhotosArgs;
use super::{ModelArgs, ScoreArgs};
use crate::exact::{Labelled, Step};
use crate::export::{self, Capture, Photo, Profile, Staging};
use crate::network;
use crate::object::Object;
use crate::pool::{DISTANCE, FOV_X_RAD, PoolArgs};
use crate::record::{Curve, Normalise, PlanRecord, Seconds, ViewRecord, matrix_of};
use crate::render::{PhotoOptions, Renderer};
use crate::report::Report;
use crate::scheme;
use crate::seen_points;

/// Options of `plan`.
#[derive(Args, Clone, Debug)]
pub struct PlanArgs {
    /// A GLB, glTF or OBJ file, or a built-in object: shelf (if left out), chair, vase, knot, blob
    /// or ball
    #[arg(conflicts_with = "photos")]
    pub object: Option<String>,
    /// Number of views to choose
    #[arg(long, short, default_value_t = 20, value_name = "B", conflicts_with = "photos")]
    pub budget: usize,
    /// How views are chosen. By what a network sees in the photos: soarnet-support (what later views
    /// will look for), soarnet (the paper's ensemble), soarnet-c, -q, -d or -t (one objective alone),
    /// soarnet-sum; soarnet-poses… without looking at photos. Exactly, from the mesh: support, e,
    /// e-literal, c, q, d, t, sum. By poses: fps (farthest-point sampling), pc-fps (the same after
    /// pseudo-coverage), random [default: soarnet-support]
    #[arg(long, short, value_name = "S")]
    pub scheme: Option<String>,
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub photos: PhotosArgs,
    #[command(flatten)]
    pub pool: PoolArgs,
    /// Seed of what the planner leaves to chance: the first view, and the random scheme
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub seed: u64,
    /// How the first views are chosen (one for support, else three), where the scheme leaves it open
    #[arg(long, value_enum)]
    pub start: Option<StartArg>,
    /// Share of a view's gain that half a turn of the camera costs it, 0 to 1
    #[arg(long, default_value_t = 0.0, value_name = "COST")]
    pub movement_cost: f32,
    /// Stop early once six choices in a row promise less than this gain (1 is all there is; of support,
    /// about 2.5)
    #[arg(long, value_name = "GAIN", conflicts_with = "photos")]
    pub stop: Option<f32>,
    #[command(flatten)]
    pub score: ScoreArgs,
    /// Folder to write: photos, transforms.json, COLMAP model, plan.json, report.html; with --photos
    /// next.json and report.html; new or empty
    #[arg(long, short, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Layout of the folder
    #[arg(long, value_enum, default_value_t = ProfileArg::Trainer, conflicts_with = "photos")]
    pub profile: ProfileArg,
    /// Width and height of the photos in pixels
    #[arg(long, default_value_t = 512, value_name = "PIXELS", conflicts_with = "photos")]
    pub size: u32,
    /// Print the plan as JSON
    #[arg(long)]
    pub json: bool,
}

/// Ways to the first views.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartArg {
    /// One by chance, then the farthest from those taken
    Fps,
    /// The extreme view along +x, +y and +z
    PseudoCoverage,
}

/// Layouts of the folder.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileArg {
    /// One folder for nerfstudio, instant-ngp, brush, gsplat, Inria 3DGS and COLMAP
    Trainer,
    /// The layout of NeRF's synthetic scenes, with 200 test views on a smooth spiral
    NerfSynthetic,
}

impl PlanArgs {
    /// The scheme: the network's where none is named.
    pub(super) fn scheme(&self) -> &str {
        self.scheme.as_deref().unwrap_or("soarnet-support")
    }
}

/// Views held out for the scores in NeRF's synthetic layout.
const TEST_VIEWS: usize = 200;

/// Seeds of the random plans drawn beside the plan.
const RANDOM_SEEDS: u64 = 10;

/// Points in the sparse cloud.
const POINTS: usize = 5_000;

/// Makes the plan and writes what was asked for.
pub fn run(args: &PlanArgs) -> Result<()> {
    if let Some(folder) = &args.photos.photos {
        return super::photos::run(args, folder);
    }
    // Whatever can be refused is refused before the long work.
    let plan = plan_of(args)?;
    super::checked_size(args.size, "--size")?;
    let label_camera = args.score.camera()?;
    let poses = args.pool.poses()?;
    plan.check(poses.len())?;
    let network = args.model.network_of(args.scheme())?;
    let staging = args.out.as_deref().map(Staging::begin).transpose()?;

    let start = Instant::now();
    let object = Object::open(args.object.as_deref(), args.score.object_seed)?;
    super::warn(&object, None);
    let mut seconds = Seconds { load: start.elapsed().as_secs_f64(), ..Seconds::default() };

    let start = Instant::now();
    let reading = args.score.reading();
    let bar = super::progress("labelling", poses.len());
    let mut labelled = Labelled::new(&object.mesh, &label_camera, poses, reading, || bar.inc(1));
    if scheme::needs_support(args.scheme()) {
        labelled = labelled.with_support(&object.mesh)?;
    }
    bar.finish_and_clear();
    seconds.label = start.elapsed().as_secs_f64();

    let bar = super::progress("planning", args.budget);
    let steps = match &network {
        None => labelled.run(plan, || bar.inc(1))?,
        Some(network) => {
            let photos = network::photos(&object.mesh, &labelled.poses)?;
            network.run(&labelled, |index| photos[index].clone(), plan, || bar.inc(1))?
        }
    };
    bar.finish_and_clear();
    seconds.plan = steps.last().map_or(0.0, |step| step.seconds);

    let mut record = record_of(args, &object, &labelled, &steps, seconds);
    if let Some(staging) = staging {
        let start = Instant::now();
        let folder = staging.path();
        write_folder(folder, args, &object, &labelled, &label_camera, &steps, &record)?;
        record.seconds.write = start.elapsed().as_secs_f64();
        super::save_json(&staging.path().join("plan.json"), &record)?;
        let folder = staging.commit()?;
        eprintln!("wrote {}", folder.display());
    }
    if args.json {
        super::print(&format!("{}\n", serde_json::to_string(&record)?))
    } else {
        super::print(&table(&record, args.budget))
    }
}

fn plan_of(args: &PlanArgs) -> Result<Plan> {
    let plan = with_options(args, args.scheme(), args.budget)?;
    Ok(match args.stop {
        Some(gain) => plan.with_stop(Stop { gain, ..Stop::default() }),
        None => plan,
    })
}

/// The plan of a scheme with the options that all plans share.
pub(super) fn with_options(args: &PlanArgs, scheme: &str, budget: usize) -> Result<Plan> {
    if ["+move=", "+stop="].iter().any(|mark| scheme.contains(mark)) {
        bail!(
            "leave out +move and +stop in {scheme}: `plan` has --movement-cost and --stop for them"
        );
    }
    let plan = scheme::plan(scheme, budget, args.seed)
        .with_context(|| scheme::unknown(scheme, &[]))?
        .with_movement_cost(args.movement_cost);
    if args.start.is_some() && matches!(scheme, "e-literal" | "pc-fps" | "random") {
        bail!("the scheme {scheme} says itself how it starts: leave out --start");
    }
    Ok(match args.start {
        Some(StartArg::Fps) => plan.with_start(Start::FarthestPoint),
        Some(StartArg::PseudoCoverage) => plan.with_start(Start::PseudoCoverage),
        None => plan,
    })
}

fn record_of(
    args: &PlanArgs,
    object: &Object,
    labelled: &Labelled,
    steps: &[Step],
    seconds: Seconds,
) -> PlanRecord {
    let view = |step: &Step| ViewRecord {
        index: step.next.index,
        position: step.next.pose.position().to_array(),
        world_from_camera: matrix_of(&step.next.pose),
        objective: step.next.objective.map(|objective| objective.name().to_owned()),
        reason: step.next.reason.to_string(),
        gain: step.next.gain,
        scores: step.scores,
    };
    let place = |index: usize| -> Vec3 { steps[index].next.pose.position() };
    let mut tour: Vec<usize> = (0..steps.len()).collect();
    shortest_tour(None, place, &mut tour);
    let exact = steps.last().map(|step| step.scores);
    PlanRecord {
        object: object.name.clone(),
        scheme: args.scheme().to_owned(),
        budget: args.budget,
        seed: args.seed,
        pool_seed: args.pool.seed(),
        candidates: labelled.poses.len(),
        pool: args.pool.record(),
        scoring: args.score.scoring(),
        start: args.start.and_then(|start| Some(start.to_possible_value()?.get_name().to_owned())),
        movement_cost: args.movement_cost,
        stop: args.stop,
        normalise: Normalise { world_from_object: object.world_from_object },
        views: steps.iter().map(view).collect(),
        tour,
        exact,
        smoothed: exact.map(|scores| scores.smoothed()),
        seconds,
    }
}

/// Everything but `plan.json`, into the folder in the making.
fn write_folder(
    folder: &Path,
    args: &PlanArgs,
    object: &Object,
    labelled: &Labelled,
    label_camera: &Camera,
    steps: &[Step],
    record: &PlanRecord,
) -> Result<()> {
    let renderer = Renderer::new(&object.mesh);
    let camera = Camera::from_fov(args.size, args.size, FOV_X_RAD)?;
    let poses: Vec<Pose> = steps.iter().map(|step| step.next.pose).collect();
    let seen: Vec<_> = poses
        .par_iter()
        .map(|pose| {
            let (faces, colours) = renderer.labelled(label_camera, pose);
            (*pose, faces, colours)
        })
        .collect();
    let points = seen_points::points(&seen, label_camera, labelled.faces(), POINTS);
    let capture = Capture { camera, photos: photos(&renderer, &camera, &poses), points };
    let test = match args.profile {
        ProfileArg::Trainer => None,
        ProfileArg::NerfSynthetic => Some(test_capture(&renderer, camera)?),
    };
    let profile = match &test {
        None => Profile::Trainer,
        Some(test) => Profile::NerfSynthetic { val: None, test },
    };
    export::write_into(folder, profile, &capture)?;

    let images: Vec<_> = capture.photos.into_iter().map(|photo| photo.image).collect();
    let candidates: Vec<Vec3> = labelled.poses.iter().map(Pose::position).collect();
    let report = Report {
        plan: record,
        photos: &images,
        candidates: &candidates,
        curves: &curves(args, labelled, steps)?,
        profile,
        folder: &args.out.as_deref().unwrap_or(Path::new("out")).to_string_lossy(),
        command: &command_line(),
    };
    report.write(folder)
}

/// The command as it was typed.
pub(super) fn command_line() -> String {
    let quoted = |argument: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=+:".contains(c);
        if !argument.is_empty() && argument.chars().all(plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', r"'\''"))
        }
    };
    let arguments = std::env::args_os().skip(1).map(|a| quoted(a.to_string_lossy().into_owned()));
    ["cargo vantage".to_owned()].into_iter().chain(arguments).collect::<Vec<_>>().join(" ")
}

fn photos(renderer: &Renderer, camera: &Camera, poses: &[Pose]) -> Vec<Photo> {
    let bar = super::progress("rendering", poses.len());
    let photo = |pose: &Pose| {
        let image = renderer.photo(camera, pose, &PhotoOptions::default());
        bar.inc(1);
        Photo { pose: *pose, image }
    };
    let photos = poses.par_iter().map(photo).collect();
    bar.finish_and_clear();
    photos
}

/// The views of the smooth spiral on which reconstructions are scored.
fn test_capture(renderer: &Renderer, camera: Camera) -> Result<Capture> {
    let spiral = ViewSpace::Spiral {
        turns: 5.0,
        min_elevation_rad: (-40f32).to_radians(),
        max_elevation_rad: 70f32.to_radians(),
    };
    let poses: Vec<Pose> = Pool::try_new(spiral, TEST_VIEWS, DISTANCE)?.iter().collect();
    Ok(Capture { camera, photos: photos(renderer, &camera, &poses), points: Vec::new() })
}

/// The plan's scores against the number of views, with farthest points and chance beside it.
fn curves(args: &PlanArgs, labelled: &Labelled, steps: &[Step]) -> Result<Vec<Curve>> {
    let scores_of = |steps: &[Step]| -> Vec<Scores> {
        [Scores::default()].into_iter().chain(steps.iter().map(|step| step.scores)).collect()
    };
    let other = |name: &str, seed: u64| -> Result<Vec<Scores>> {
        let plan = scheme::plan(name, args.budget, seed).context("a scheme by its name")?;
        Ok(scores_of(&labelled.run(plan, || {})?))
    };
    let mut curves = vec![Curve {
        label: args.scheme().to_owned(),
        scores: scores_of(steps),
        low: Vec::new(),
        high: Vec::new(),
    }];
    if args.scheme() != "fps" {
        let scores = other("fps", args.seed)?;
        curves.push(Curve { label: "fps".into(), scores, low: Vec::new(), high: Vec::new() });
    }
    let random = (0..RANDOM_SEEDS).map(|seed| other("random", seed)).collect::<Result<Vec<_>>>()?;
    curves.push(Curve::of_runs("random", &random));
    Ok(curves)
}

fn table(record: &PlanRecord, budget: usize) -> String {
    let mut text = format!(
        "{}: {} of {} candidate views by {}\n",
        record.object,
        record.views.len(),
        record.candidates,
        scheme::describe(&record.scheme)
    );
    text += &format!(
        "{:>4} {:>6}  {:<10} {:>8}  {:>8} {:>8} {:>9} {:>8}  why\n",
        "view", "index", "objective", "gain", "coverage", "geometry", "diversity", "texture"
    );
    for (number, view) in record.views.iter().enumerate() {
        let Scores { coverage, geometry, diversity, texture } = view.scores;
        // The first views, and those by chance, expect nothing.
        let gain = if view.gain == 0.0 { "-".to_owned() } else { format!("{:.4}", view.gain) };
        text += &format!(
            "{:>4} {:>6}  {:<10} {gain:>8}  {coverage:>8.4} {geometry:>8.4} {diversity:>9.4} \
             {texture:>8.4}  {}\n",
            number + 1,
            view.index,
            view.objective.as_deref().unwrap_or("-"),
            view.reason
        );
    }
    let taken = record.views.len();
    if taken < budget {
        text += &format!("good enough after {taken} views: further ones promise too little\n");
    }
    let Seconds { load, label, plan, write } = record.seconds;
    text + &format!("seconds: load {load:.2}, label {label:.2}, plan {plan:.3}, write {write:.2}\n")
}
