//! What a plan and a comparison say to machines: the JSON that `--json` prints and `plan.json` holds.
//!
//! These names are stable. New fields may be added; none is renamed or changes its meaning.

use serde::{Deserialize, Serialize};
use vantage_core::{Objective, Pose, Scores};

/// A matrix of shape (4, 4), row by row.
pub type Matrix4 = [[f64; 4]; 4];

/// One plan: `plan --json` and `plan.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanRecord {
    /// The object's name: a file's stem or a built-in object.
    pub object: String,
    /// The scheme, as named on the command line.
    pub scheme: String,
    /// Views asked for.
    pub budget: usize,
    /// Seed of the planner's own chance.
    pub seed: u64,
    /// Seed of the candidate pool; null where the pool came from a file.
    pub pool_seed: Option<u64>,
    /// Size of the candidate pool.
    pub candidates: usize,
    /// Where the candidates stand.
    pub pool: PoolRecord,
    /// How the scores were computed.
    pub scoring: Scoring,
    /// How the first views were chosen where it was said: `fps` or `pseudo-coverage`; else null.
    pub start: Option<String>,
    /// Share of a view's gain that half a turn of the camera cost it.
    pub movement_cost: f32,
    /// The gain below which six choices in a row ended the plan; null for no such rule.
    pub stop: Option<f32>,
    /// How the object was brought into the unit sphere.
    pub normalise: Normalise,
    /// The chosen views, in the order of choice.
    pub views: Vec<ViewRecord>,
    /// Positions into `views`: the shortest tour through them that was found.
    pub tour: Vec<usize>,
    /// Exact scores of the whole plan; null where no mesh is known.
    pub exact: Option<Scores>,
    /// The exact scores after [`smoothing`](vantage_core::objectives::smoothing); null likewise.
    pub smoothed: Option<Scores>,
    /// Seconds spent, by phase.
    pub seconds: Seconds,
}

/// The similarity that brings an object into the unit sphere, +Z up.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Normalise {
    /// `world_from_object`, shape (4, 4).
    pub world_from_object: Matrix4,
}

/// Where the candidates stand.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PoolRecord {
    /// `sphere`, `fibonacci`, `hemisphere`, `rings`, `spiral`, `clustered`, or `file`.
    pub space: String,
    /// The file, if they were read from one.
    pub file: Option<String>,
    /// Lowest and highest elevation in degrees, for hemisphere, rings and spiral; else null.
    pub elevations: Option<[f32; 2]>,
    /// Number of rings, or of the spiral's turns; else null.
    pub rings: Option<usize>,
}

/// How scores were computed: without it a score means nothing.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Scoring {
    /// `default` or `literal`: see [`Form`](vantage_core::objectives::Form).
    pub reading: String,
    /// Side of the face-id images in pixels.
    pub resolution: u32,
    /// Seed of built-in objects; files have none.
    pub object_seed: u64,
}

/// One chosen view.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ViewRecord {
    /// Index into the candidate pool.
    pub index: usize,
    /// Camera centre in world, metres (the object's sphere has radius 1).
    pub position: [f32; 3],
    /// `world_from_camera`, OpenGL camera axes, shape (4, 4).
    pub world_from_camera: Matrix4,
    /// The objective that chose it: coverage, geometry, diversity, texture; null for a view that
    /// no single objective chose.
    pub objective: Option<String>,
    /// Why it was chosen, in words.
    pub reason: String,
    /// The expected gain of the objective (or of the scheme's own measure) when it was chosen.
    pub gain: f32,
    /// The scores once it is taken, before smoothing.
    pub scores: Scores,
}

/// Seconds by phase.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Seconds {
    /// Reading and normalising the object.
    pub load: f64,
    /// Rendering the candidates and labelling what each sees.
    pub label: f64,
    /// Planning alone.
    pub plan: f64,
    /// Rendering the chosen photos and writing the folder.
    pub write: f64,
}

/// `world_from_camera` as shape (4, 4).
pub fn matrix_of(pose: &Pose) -> Matrix4 {
    let [a, b, c] = pose.rows().map(|row| row.map(f64::from));
    [a, b, c, [0.0, 0.0, 0.0, 1.0]]
}

/// A capture in progress: `plan --photos --json`.
///
/// Everything that is a place or a pose is in the coordinates and units of the capture's own
/// `transforms.json`; azimuths and elevations are about the object's centre and upward direction.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PhotosRecord {
    /// The folder's name.
    pub capture: String,
    /// The scheme, as named on the command line.
    pub scheme: String,
    /// Seed of the planner's own chance.
    pub seed: u64,
    /// Seed of the candidate pool; null where the pool came from a file.
    pub pool_seed: Option<u64>,
    /// Size of the candidate pool.
    pub candidates: usize,
    /// Where the candidates stand.
    pub pool: PoolRecord,
    /// The object's middle: given, or the point nearest to all optical axes.
    pub centre: [f64; 3],
    /// The radius of the sphere around it that is planned for: given, or the largest that half of
    /// the photos could show whole.
    pub radius: f64,
    /// The middle distance of the photos from the centre; that of every generated candidate.
    pub distance: f64,
    /// The upward direction, unit length.
    pub up: [f64; 3],
    /// Lowest and highest elevation of the photos, degrees.
    pub elevations: [f32; 2],
    /// The photos planned from.
    pub photos: Vec<PhotoRecord>,
    /// The photos that could not be used, and why.
    pub skipped: Vec<SkippedRecord>,
    /// What was read and had no effect, in sentences.
    pub notes: Vec<String>,
    /// The scores of the photos so far as predicted, before smoothing; null where the scheme looks
    /// at poses alone.
    pub scores: Option<Scores>,
    /// The next view, then others in case it cannot be reached: each the best among those at some
    /// distance from the ones before.
    pub next: Vec<NextRecord>,
    /// Seconds spent: `load` reading the photos, `plan` planning.
    pub seconds: Seconds,
}

/// A photo that was planned from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PhotoRecord {
    /// Its place in the file's list, from 1.
    pub number: usize,
    /// As the file names it.
    pub file_path: String,
    /// Camera centre.
    pub position: [f64; 3],
    /// Degrees anticlockwise, seen from above.
    pub azimuth: f32,
    /// Degrees above the horizon.
    pub elevation: f32,
}

/// A photo that could not be used.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SkippedRecord {
    /// Its place in the file's list, from 1.
    pub number: usize,
    /// As the file names it.
    pub file_path: String,
    /// Why, in words.
    pub why: String,
}

/// A view to take next.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NextRecord {
    /// Index into the candidate pool.
    pub index: usize,
    /// Camera centre.
    pub position: [f64; 3],
    /// The file's coordinates from the camera's, OpenGL axes, shape (4, 4), as in `frames`.
    pub transform_matrix: Matrix4,
    /// Degrees anticlockwise, seen from above.
    pub azimuth: f32,
    /// Degrees above the horizon.
    pub elevation: f32,
    /// Where that is, from the nearest photo, in words.
    pub place: String,
    /// The number of the nearest photo.
    pub nearest: usize,
    /// The angle to it about the object, degrees.
    pub angle: f32,
    /// The objective that chose it; null for a view that no single objective chose.
    pub objective: Option<String>,
    /// Why it was chosen, in words.
    pub reason: String,
    /// The expected gain; for farthest points the distance to the nearest photo in radii, all
    /// cameras brought to three radii from the centre.
    pub gain: f32,
}

/// A comparison: `compare --json`.
#[derive(Clone, Debug, Serialize)]
pub struct ComparisonRecord {
    /// Every run, cut at every budget.
    pub rows: Vec<ComparisonRow>,
    /// Mean and spread over objects and seeds, by budget and scheme.
    pub summary: Vec<SummaryRow>,
    /// Seed of the candidate pool; null where the pool came from a file.
    pub pool_seed: Option<u64>,
    /// Where the candidates stand.
    pub pool: PoolRecord,
    /// Whether each object and seed had candidates of its own: see the rows' `pool_seed`.
    pub random_candidates: bool,
    /// How the scores were computed.
    pub scoring: Scoring,
    /// Rank correlations and closed gaps; null unless the oracle or a network was among the
    /// schemes.
    pub metrics: Option<MetricsRecord>,
}

/// How good schemes are at the objective they plan for: what each figure means is written in
/// [`metrics`](crate::metrics).
#[derive(Clone, Debug, Serialize)]
pub struct MetricsRecord {
    /// Bootstrap resamples behind each interval.
    pub resamples: usize,
    /// Rank correlations of predicted with exact gains, by budget and predictor.
    pub spearman: Vec<MetricRow>,
    /// Closed gaps, by budget and scheme: the ratio of means over objects.
    pub closed_gap: Vec<MetricRow>,
    /// Paired differences from farthest points, and from the network without images.
    pub differences: Vec<DifferenceRow>,
    /// The same of each object, means over its seeds.
    pub objects: Vec<ObjectMetrics>,
}

/// One scheme at one budget.
#[derive(Clone, Debug, Serialize)]
pub struct MetricRow {
    /// The scheme.
    pub scheme: String,
    /// Views taken; rank correlations are of the states before the last of them.
    pub budget: usize,
    /// `coverage`, `geometry`, `diversity` and `texture`.
    #[serde(flatten)]
    pub of_objective: OfObjective<Estimate>,
    /// The mean of the four.
    pub mean: Estimate,
}

/// One scheme less another at one budget.
#[derive(Clone, Debug, Serialize)]
pub struct DifferenceRow {
    /// Which figure: `spearman` or `closed_gap`.
    pub measure: Measure,
    /// The scheme.
    pub scheme: String,
    /// The scheme whose figure is taken off.
    pub minus: String,
    /// Views taken.
    pub budget: usize,
    /// `coverage`, `geometry`, `diversity` and `texture`.
    #[serde(flatten)]
    pub of_objective: OfObjective<Estimate>,
    /// The mean of the four.
    pub mean: Estimate,
}

/// A kind of figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Spearman's rank correlation.
    Spearman,
    /// The closed gap.
    ClosedGap,
}

/// A figure over objects with its 95 % bootstrap interval; null where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Over all objects.
    pub value: Option<f64>,
    /// The interval's lower end; null with fewer than two objects.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
}

/// One scheme on one object at one budget: means over seeds.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectMetrics {
    /// The object's name.
    pub object: String,
    /// The scheme.
    pub scheme: String,
    /// Views taken.
    pub budget: usize,
    /// In each objective, the exact score of the plan for that objective.
    pub scores: OfObjective<Option<f64>>,
    /// The same, by chance after the same first views.
    pub random: OfObjective<Option<f64>>,
    /// The same, of the exact oracle.
    pub oracle: OfObjective<Option<f64>>,
    /// Null where the oracle gains nothing over chance.
    pub closed_gap: OfObjective<Option<f64>>,
    /// Null where the scheme predicts nothing, or the object has no order to find.
    pub spearman: OfObjective<Option<f64>>,
}

/// Something of each objective.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OfObjective<T> {
    /// C.
    pub coverage: T,
    /// Q.
    pub geometry: T,
    /// D.
    pub diversity: T,
    /// T.
    pub texture: T,
}

/// One scheme on one object, with one seed, cut at one budget.
#[derive(Clone, Debug, Serialize)]
pub struct ComparisonRow {
    /// The object's name.
    pub object: String,
    /// The scheme.
    pub scheme: String,
    /// Views taken.
    pub budget: usize,
    /// Seed of the planner's own chance.
    pub seed: u64,
    /// Seed of the candidate pool; null where the pool came from a file.
    pub pool_seed: Option<u64>,
    /// `coverage`, `geometry`, `diversity` and `texture`, exact, before smoothing.
    #[serde(flatten)]
    pub scores: Scores,
    /// Indices into the candidate pool, in the order of choice.
    pub views: Vec<usize>,
    /// Seconds of planning until the last of them.
    pub seconds: f64,
}

/// One scheme at one budget, over all objects and seeds.
#[derive(Clone, Debug, Serialize)]
pub struct SummaryRow {
    /// The scheme.
    pub scheme: String,
    /// Views taken.
    pub budget: usize,
    /// Objects times seeds.
    pub runs: usize,
    /// C.
    pub coverage: Spread,
    /// Q.
    pub geometry: Spread,
    /// D.
    pub diversity: Spread,
    /// T.
    pub texture: Spread,
    /// Mean seconds of planning.
    pub seconds: f64,
}

/// Mean and spread of one objective.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    /// Mean over the runs.
    pub mean: f64,
    /// Standard deviation over the runs.
    pub sd: f64,
    /// Mean of the score divided by the exact oracle's: the plan that is greedy on this objective
    /// alone, with exact scores, after the same three first views by farthest points, on the same
    /// object and with the same seed. It looks one view ahead, so a scheme with other first views
    /// can exceed 1. Null up to three views, where the oracle has not chosen yet.
    pub relative_mean: Option<f64>,
    /// Standard deviation of the same.
    pub relative_sd: Option<f64>,
}

/// The scores of a growing set of views, for plots: entry `n` holds the scores after `n` views.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Curve {
    /// The scheme.
    pub label: String,
    /// Scores after 0, 1, 2 … views.
    pub scores: Vec<Scores>,
    /// Lowest and highest scores over several seeds, where the curve is their mean; else empty.
    pub low: Vec<Scores>,
    /// See `low`.
    pub high: Vec<Scores>,
}

impl Curve {
    /// The mean of several runs, with their lowest and highest scores.
    ///
    /// `runs` has shape (runs, views + 1); all runs have the same length.
    pub fn of_runs(label: &str, runs: &[Vec<Scores>]) -> Self {
        let length = runs.iter().map(Vec::len).min().unwrap_or(0);
        let at = |views: usize, fold: fn(&[f32]) -> f32| -> Scores {
            let of = |objective| {
                let values: Vec<f32> = runs.iter().map(|run| run[views].get(objective)).collect();
                fold(&values)
            };
            let [coverage, geometry, diversity, texture] = Objective::ALL.map(of);
            Scores { coverage, geometry, diversity, texture }
        };
        let all = |fold: fn(&[f32]) -> f32| (0..length).map(|views| at(views, fold)).collect();
        Self {
            label: label.to_owned(),
            scores: all(|values| values.iter().sum::<f32>() / values.len() as f32),
            low: all(|values| values.iter().copied().fold(f32::INFINITY, f32::min)),
            high: all(|values| values.iter().copied().fold(f32::NEG_INFINITY, f32::max)),
        }
    }
}
