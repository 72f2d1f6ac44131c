//! `cargo vantage plan --photos`: the next views of a capture in progress.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::Args;
use vantage_core::planner::{Blind, NextView, Plan, Reason, Scorer, Session};
use vantage_core::soarnet::CLUTTERED;
use vantage_core::{Pose, Scores, Vec3};

use super::plan::{self, PlanArgs};
use crate::export::Staging;
use crate::heap::Heap;
use crate::network::{self, Network};
use crate::photos::words::{azimuth_deg, elevation_deg, way};
use crate::photos::{Capture, Known, Layout, Photo};
use crate::pool::{self, DISTANCE, PoolArgs};
use crate::record::{NextRecord, PhotoRecord, PhotosRecord, Seconds, SkippedRecord};
use crate::report;
use crate::scheme;

/// Options of `plan --photos`.
#[derive(Args, Clone, Debug)]
pub struct PhotosArgs {
    /// Plan from photos alone: a folder with transforms.json as nerfstudio, Polycam, Record3D and
    /// instant-ngp write it, and the photos it names
    #[arg(long, value_name = "DIR")]
    pub photos: Option<PathBuf>,
    /// Views to name: the first is the next view to take; each further one is the best that lies
    /// well apart from those before it (30 degrees, less where there is no such view), for when
    /// those cannot be reached. Take one, add its photo and pose, and ask again
    #[arg(long, default_value_t = 5, value_name = "K", requires = "photos")]
    pub next: usize,
    /// The object's middle in the coordinates of transforms.json [default: the point nearest to
    /// all optical axes]
    #[arg(long, value_name = "X,Y,Z", value_parser = three, requires = "photos", allow_hyphen_values = true)]
    pub centre: Option<[f64; 3]>,
    /// The radius of the object's bounding sphere, likewise [default: of the largest sphere there that
    /// half of the photos could show whole]
    #[arg(long, value_name = "R", requires = "photos")]
    pub radius: Option<f64>,
    /// The upward direction, likewise [default: the mean of the cameras']
    #[arg(long, value_name = "X,Y,Z", value_parser = three, requires = "photos", allow_hyphen_values = true)]
    pub up: Option<[f64; 3]>,
}

/// Three numbers with commas between them.
fn three(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.map_err(|error| error.to_string())?;
    numbers.try_into().map_err(|_| "three numbers with commas between them are needed".to_owned())
}

/// So far from each other, in degrees, are the views named, where there are such views.
const APART_DEG: f32 = 30.0;

/// A view that may be taken.
#[derive(Clone, Copy)]
struct Candidate {
    /// In the plan's coordinates.
    pose: Pose,
    /// As it stands in a pool's file, in the file's coordinates.
    given: Option<Pose>,
}

/// Names the next views.
pub fn run(args: &PlanArgs, folder: &Path) -> Result<()> {
    // Whatever can be refused is refused before the long work.
    let scheme = args.scheme();
    plan::with_options(args, scheme, 1)?;
    let network = args.model.network_of(scheme)?;
    if network.is_none() && !scheme::needs_poses_only(scheme) {
        bail!(
            "the scheme {scheme} needs a mesh: from photos choose soarnet-support, soarnet, soarnet-c, \
             -q, -d, -t or -sum, fps, pc-fps, or random"
        );
    }
    if args.photos.next == 0 {
        bail!("--next is 0: ask for at least one view");
    }
    let staging = args.out.as_deref().map(Staging::begin).transpose()?;

    let start = Instant::now();
    let known =
        Known { centre: args.photos.centre, radius: args.photos.radius, up: args.photos.up };
    let bar = super::progress("reading", 0);
    let capture = Capture::open(folder, &known, |all| {
        bar.set_length(all as u64);
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    for skipped in &capture.skipped {
        eprintln!(
            "warning: photo {}, {}, is skipped: {}",
            skipped.number, skipped.file, skipped.why
        );
    }
    let mut seconds = Seconds { load: start.elapsed().as_secs_f64(), ..Seconds::default() };

    let start = Instant::now();
    let reached = reached(&capture.photos);
    let pool = args.pool.around(capture.photos.len(), reached);
    let candidates = candidates(&pool, &capture.layout)?;
    let mut views = capture.photos.len();
    if network.is_some() && views > network::MOST_VIEWS {
        eprintln!(
            "warning: the network remembers {} photos: those farthest from each other are used",
            network::MOST_VIEWS
        );
        views = network::MOST_VIEWS;
    }
    let plan = plan::with_options(args, scheme, views + 1)?;
    let poses = candidates.iter().map(|candidate| candidate.pose).collect();
    let count = args.photos.next;
    let Proposal { next, scores, note } =
        propose(count, &capture.photos, poses, plan, network.as_ref())?;
    seconds.plan = start.elapsed().as_secs_f64();

    let record = PhotosRecord {
        capture: name_of(folder),
        scheme: scheme.to_owned(),
        seed: args.seed,
        pool_seed: pool.seed(),
        candidates: candidates.len(),
        pool: pool.record(),
        centre: capture.layout.centre.to_array(),
        radius: capture.layout.radius,
        distance: capture.layout.distance,
        up: capture.layout.up().to_array(),
        elevations: reached,
        photos: capture.photos.iter().map(photo_record).collect(),
        skipped: capture
            .skipped
            .iter()
            .map(|skipped| SkippedRecord {
                number: skipped.number,
                file_path: skipped.file.clone(),
                why: skipped.why.clone(),
            })
            .collect(),
        notes: capture.notes.iter().cloned().chain(note).collect(),
        scores,
        next: next
            .iter()
            .map(|next| next_record(next, &candidates[next.index], &capture))
            .collect(),
        seconds,
    };
    if let Some(staging) = staging {
        super::save_json(&staging.path().join("next.json"), &record)?;
        let directions: Vec<Vec3> =
            candidates.iter().map(|candidate| candidate.pose.position() / DISTANCE).collect();
        let page = report::photos::page(&record, &capture, &directions)?;
        let path = staging.path().join("report.html");
        fs::write(&path, page).with_context(|| format!("cannot write {}", path.display()))?;
        let folder = staging.commit()?;
        eprintln!("wrote {}", folder.display());
    }
    if args.json {
        super::print(&format!("{}\n", serde_json::to_string(&record)?))
    } else {
        super::print(&table(&record))
    }
}

/// The folder's own name, also of `.`.
fn name_of(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    whole.file_name().unwrap_or(whole.as_os_str()).to_string_lossy().into_owned()
}

/// The lowest and the highest elevation of the photos, degrees.
fn reached(photos: &[Photo]) -> [f32; 2] {
    photos
        .iter()
        .map(|photo| elevation_deg(photo.direction))
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], elevation| {
            [low.min(elevation), high.max(elevation)]
        })
}

/// The candidates around the object, or those of a file.
fn candidates(args: &PoolArgs, layout: &Layout) -> Result<Vec<Candidate>> {
    let Some(file) = &args.pool else {
        let poses = args.poses()?;
        return Ok(poses.into_iter().map(|pose| Candidate { pose, given: None }).collect());
    };
    let given = pool::read(file);
    let given = given.with_context(|| format!("cannot use the pool {}", file.display()))?;
    let candidate = |(index, given): (usize, Pose)| {
        let direction = layout.direction(given.position().as_dvec3());
        let direction = direction.with_context(|| {
            format!("pose {index} of the pool stands in the object's very middle")
        })?;
        Ok(Candidate { pose: layout.looking_from(direction)?, given: Some(given) })
    };
    given.into_iter().enumerate().map(candidate).collect()
}

/// What comes of the photos.
struct Proposal {
    next: Vec<NextView>,
    /// Of the photos, where a network predicts them.
    scores: Option<Scores>,
    /// What is wrong with the outlines that the network sees.
    note: Option<String>,
}

/// The next views by a plan.
///
/// The scorer is chosen here and nowhere else.
fn propose(
    count: usize,
    photos: &[Photo],
    candidates: Vec<Pose>,
    plan: Plan,
    network: Option<&Network>,
) -> Result<Proposal> {
    let Some(network) = network else {
        let mut session = Session::try_new(Heap::default(), candidates, Blind, plan)?;
        for photo in photos {
            session.observe_elsewhere(photo.pose, &())?;
        }
        return Ok(Proposal { next: apart(&mut session, count)?, scores: None, note: None });
    };
    let scorer = network.scorer(&candidates, photos.len())?;
    let remembered = spread(photos, scorer.view_capacity());
    let mut session = Session::try_new(Heap::default(), candidates, scorer, plan)?;
    for photo in remembered {
        let observed = session.observe_elsewhere(photo.pose, &network::shot(&photo.window)?);
        observed
            .with_context(|| format!("photo {}, {}, cannot be used", photo.number, photo.file))?;
    }
    let scores = Some(session.scores());
    let next = apart(&mut session, count)?;
    let note = doubt(session.scorer().clutter(), &next);
    Ok(Proposal { next, scores, note })
}

/// What to say of outlines that cannot be right, and of what comes of them.
fn doubt(clutter: f32, next: &[NextView]) -> Option<String> {
    if clutter > CLUTTERED {
        return Some(format!(
            "{:.0} % of what lies beside the object is taken for it, so views are spread more as over a \
             ball: a plain background helps",
            100.0 * clutter
        ));
    }
    (next.first()?.reason == Reason::Farthest).then(|| {
        "the outlines of the object in the photos contradict each other, so the farthest views are \
         named: check the poses, and that all photos show the same object"
            .to_owned()
    })
}

/// As many photos as a network remembers: all, or those farthest from each other, in their order.
fn spread(photos: &[Photo], most: usize) -> Vec<&Photo> {
    let mut kept: Vec<usize> = Vec::new();
    let mut nearest = vec![f32::INFINITY; photos.len()];
    while kept.len() < most.min(photos.len()) {
        let farthest = (0..photos.len()).rev().max_by(|&a, &b| nearest[a].total_cmp(&nearest[b]));
        let Some(next) = farthest else { break };
        kept.push(next);
        for (nearest, photo) in nearest.iter_mut().zip(photos) {
            *nearest = nearest.min(photo.direction.distance(photos[next].direction));
        }
        nearest[next] = -1.0;
    }
    kept.sort_unstable();
    kept.into_iter().map(|index| &photos[index]).collect()
}

/// The next view, and others in case it and its neighbours cannot be reached.
fn apart<S: Scorer>(session: &mut Session<S, Heap>, count: usize) -> Result<Vec<NextView>> {
    let places: Vec<Vec3> =
        session.candidates().iter().map(|candidate| candidate.pose().position()).collect();
    let mut chosen: Vec<NextView> = Vec::new();
    let mut apart = APART_DEG.to_radians();
    while chosen.len() < count.min(places.len()) {
        if let Some(next) = session.next_view() {
            block_around(session, &places, next.index, apart)?;
            chosen.push(next);
            continue;
        }
        // Nothing is left so far apart: look more closely, and in the end at every single view.
        if apart == 0.0 {
            break;
        }
        apart = if apart < 1e-3 { 0.0 } else { 0.5 * apart };
        for index in 0..places.len() {
            session.unblock(index)?;
        }
        for next in &chosen {
            block_around(session, &places, next.index, apart)?;
        }
    }
    Ok(chosen)
}

/// Blocks a candidate and those nearer to it than an angle.
fn block_around<S: Scorer>(
    session: &mut Session<S, Heap>,
    places: &[Vec3],
    index: usize,
    angle_rad: f32,
) -> Result<()> {
    for (other, place) in places.iter().enumerate() {
        if other == index || place.angle_between(places[index]) < angle_rad {
            session.block(other)?;
        }
    }
    Ok(())
}

fn photo_record(photo: &Photo) -> PhotoRecord {
    PhotoRecord {
        number: photo.number,
        file_path: photo.file.clone(),
        position: photo.position.to_array(),
        azimuth: azimuth_deg(photo.direction),
        elevation: elevation_deg(photo.direction),
    }
}

fn next_record(next: &NextView, candidate: &Candidate, capture: &Capture) -> NextRecord {
    let direction = next.pose.position().normalize();
    let angle = |photo: &Photo| photo.direction.angle_between(direction);
    let nearest = capture.photos.iter().min_by(|a, b| angle(a).total_cmp(&angle(b)));
    let place = nearest
        .map(|photo| way(photo.direction, direction, &format!("photo {}", photo.number)))
        .unwrap_or_default();
    let transform_matrix = match &candidate.given {
        Some(given) => crate::record::matrix_of(given),
        None => {
            let (position, axes) = capture.layout.in_file(&next.pose);
            let row = |axis: usize| {
                let part = |v: glam::DVec3| v.to_array()[axis];
                [part(axes.x_axis), part(axes.y_axis), part(axes.z_axis), part(position)]
            };
            [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
        }
    };
    NextRecord {
        index: next.index,
        position: [0, 1, 2].map(|axis| transform_matrix[axis][3]),
        transform_matrix,
        azimuth: azimuth_deg(direction),
        elevation: elevation_deg(direction),
        place,
        nearest: nearest.map_or(0, |photo| photo.number),
        angle: nearest.map_or(0.0, |photo| angle(photo).to_degrees()),
        objective: next.objective.map(|objective| objective.name().to_owned()),
        reason: next.reason.to_string(),
        gain: next.gain,
    }
}

fn table(record: &PhotosRecord) -> String {
    let [low, high] = record.elevations;
    let mut text = format!(
        "{}: {} photos from {low:.0} to {high:.0} degrees above the horizon{}\n",
        record.capture,
        record.photos.len(),
        match record.skipped.len() {
            0 => String::new(),
            skipped => format!(", and {skipped} skipped"),
        }
    );
    let [x, y, z] = record.centre;
    text += &format!(
        "the object: around ({x:.3}, {y:.3}, {z:.3}), radius {:.3}, seen from {:.3} in the middle\n",
        record.radius, record.distance
    );
    if let Some(Scores { coverage, geometry, diversity, texture }) = record.scores {
        text += &format!(
            "predicted scores so far: coverage {coverage:.3}, geometry {geometry:.3}, diversity \
             {diversity:.3}, texture {texture:.3}\n"
        );
    }
    for note in &record.notes {
        text += &format!("note: {note}\n");
    }
    text += &format!(
        "next view of {} candidates by {}, then others for when it cannot be reached:\n",
        record.candidates,
        scheme::describe(&record.scheme)
    );
    text += &format!(
        "{:>4} {:>6} {:>8} {:>9} {:>8}  {:<60} why\n",
        "view", "index", "azimuth", "elevation", "gain", "where"
    );
    for (place, next) in record.next.iter().enumerate() {
        let gain = if next.gain == 0.0 { "-".to_owned() } else { format!("{:.4}", next.gain) };
        text += &format!(
            "{:>4} {:>6} {:>8.0} {:>9.0} {gain:>8}  {:<60} {}\n",
            place + 1,
            next.index,
            next.azimuth,
            next.elevation,
            next.place,
            next.reason
        );
    }
    let Seconds { load, plan, .. } = record.seconds;
    text + &format!("seconds: load {load:.2}, plan {plan:.3}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        plan: PlanArgs,
    }

    fn says(arguments: &[&str]) -> String {
        let whole = ["plan"].iter().chain(arguments);
        match Cli::try_parse_from(whole) {
            Ok(Cli { plan }) => format!("{:#}", plan::run(&plan).unwrap_err()),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn what_cannot_be_asked_of_photos_is_said() {
        let here = ["--photos", "."];
        for (more, words) in [
            (vec!["--scheme", "e"], "needs a mesh"),
            (vec!["--scheme", "best"], "no scheme `best`"),
            (
                vec!["--scheme", "soarnet", "--model", "none.model"],
                "cannot read the model none.model",
            ),
            (vec!["--next", "0"], "--next is 0"),
            (vec!["chair"], "cannot be used with"),
            (vec!["--budget", "5"], "cannot be used with"),
            (vec!["--centre", "1,2"], "three numbers"),
            (vec!["--scheme", "fps"], "holds no transforms.json"),
        ] {
            let found = says(&[here.as_slice(), &more].concat());
            assert!(found.contains(words), "{found}");
        }
        assert!(says(&["--next", "3"]).contains("--photos"));
    }

    fn photo(direction: Vec3) -> Photo {
        Photo {
            number: 1,
            file: String::new(),
            position: direction.as_dvec3(),
            direction,
            pose: Pose::looking_at(direction * DISTANCE, Vec3::ZERO).unwrap(),
            window: image::RgbImage::new(64, 64),
            picture: image::RgbImage::new(4, 4),
        }
    }

    #[test]
    fn further_views_lie_apart() {
        let args = PoolArgs {
            candidates: Some(200),
            pool_seed: 0,
            space: Some(pool::Space::Fibonacci),
            min_elevation: None,
            max_elevation: None,
            rings: 4,
            pool: None,
        };
        let photos = [photo(Vec3::X), photo(Vec3::Y), photo(Vec3::NEG_X)];
        let poses = args.poses().unwrap();
        let Proposal { next, scores, note } =
            propose(6, &photos, poses.clone(), Plan::farthest_point(4), None).unwrap();
        assert_eq!((next.len(), scores, note), (6, None, None));
        for (place, one) in next.iter().enumerate() {
            for other in &next[..place] {
                let angle = one.pose.position().angle_between(other.pose.position());
                assert!(angle.to_degrees() >= APART_DEG);
            }
        }
        // More than there is room for so far apart, and more than there are.
        let all = propose(500, &photos, poses, Plan::farthest_point(4), None).unwrap().next;
        let mut indices: Vec<usize> = all.iter().map(|next| next.index).collect();
        indices.sort_unstable();
        assert_eq!(indices, (0..200).collect::<Vec<_>>());
    }

    #[test]
    fn a_network_names_views_and_scores() {
        let photos = [photo(Vec3::X), photo(Vec3::Y), photo(Vec3::NEG_X)];
        let poses: Vec<Pose> = [Vec3::Z, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::ONE]
            .map(|eye| Pose::looking_at(eye.normalize() * DISTANCE, Vec3::ZERO).unwrap())
            .into();
        let network = network::tests::network();
        let Proposal { next, scores, .. } =
            propose(2, &photos, poses, Plan::ensemble(4), Some(&network)).unwrap();
        assert_eq!(next.len(), 2);
        assert_eq!(next[0].objective, Some(vantage_core::Objective::Coverage));
        assert!(scores.is_some());
    }

    #[test]
    fn outlines_that_cannot_be_right_are_told() {
        let next = |reason| NextView {
            index: 0,
            pose: photo(Vec3::X).pose,
            objective: None,
            gain: 0.1,
            reason,
        };
        assert_eq!(doubt(0.05, &[next(Reason::Support)]), None);
        assert_eq!(doubt(0.0, &[]), None);
        assert!(
            doubt(0.2, &[next(Reason::Support)]).unwrap().starts_with("20 % of what lies beside")
        );
        assert!(doubt(0.0, &[next(Reason::Farthest)]).unwrap().contains("contradict each other"));
    }

    #[test]
    fn photos_beyond_a_networks_memory_are_the_close_ones() {
        let photos = [photo(Vec3::X), photo(Vec3::new(1.0, 0.01, 0.0)), photo(Vec3::NEG_X)];
        let kept: Vec<Vec3> = spread(&photos, 2).iter().map(|photo| photo.direction).collect();
        assert_eq!(kept, [Vec3::X, Vec3::NEG_X]);
        assert_eq!(spread(&photos, 256).len(), 3);
    }
}
