//! The model card: every figure measured here, kept as JSON, and the page drawn from it.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use clap::Parser;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use vantage_core::soarnet::features::{COUNT, DIRECTION, RELATION};
use vantage_core::soarnet::{CELL, Dimensions, Model, OUTLOOK, RANKS, STATE};
use vantage_lab::commands::compare::{CompareArgs, compare};
use vantage_lab::dataset::Parameters;

use crate::fit::Course;
use crate::quantize::Agreement;

/// The budgets that are measured.
const BUDGETS: &str = "6,12,20";
/// The budget of the tables.
const BUDGET: u64 = 12;
/// Held-out objects that are made here.
const PROCEDURAL: &str = "48";

/// Every figure.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Card {
    /// What made it.
    pub generator: String,
    /// The data that the networks were trained on.
    pub data: Parameters,
    /// Objects to train on, to choose among networks, and held out.
    pub objects: [usize; 3],
    /// The network that looks at photos.
    pub soarnet: Figures,
    /// The same without photos.
    pub poses: Figures,
    /// The literal preset's course, where it was trained.
    pub literal: Option<Course>,
    /// `compare` over held-out procedural objects: its `metrics`.
    pub procedural: Value,
    /// `compare` over real objects: its `metrics`.
    pub real: Value,
}

/// What is known of one network.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Figures {
    pub course: Course,
    pub agreement: Agreement,
    /// Bytes of the model file.
    pub bytes: usize,
    /// CRC-32 of the model file.
    pub checksum: u32,
    /// Multiplications to encode a photo.
    pub encoder_macs: usize,
    /// Multiplications for a step with 100 candidates, the encoder's apart.
    pub step_macs: usize,
}

impl Figures {
    /// Of a model file.
    pub fn new(course: Course, agreement: Agreement, file: &[u8]) -> Result<Self> {
        let model = Model::parse(file).map_err(|error| anyhow!("{error}"))?;
        let (encoder_macs, step_macs) = macs(model.dimensions());
        Ok(Self {
            course,
            agreement,
            bytes: file.len(),
            checksum: model.checksum(),
            encoder_macs,
            step_macs,
        })
    }
}

/// Multiplications of the encoder, and of everything else in a step with 100 candidates.
fn macs(sizes: &Dimensions) -> (usize, usize) {
    let [c0, c1, c2, c3] = sizes.channels;
    let stage = |side: usize, from: usize, to: usize| side * side * 9 * (from * to + 2 * to * to);
    let encoder = 32 * 32 * 27 * c0
        + stage(16, c0, c1)
        + stage(8, c1, c2)
        + stage(4, c2, c3)
        + 64 * CELL * c2
        + 16 * c3 * sizes.embedding;
    let view = (sizes.embedding + DIRECTION) * sizes.width;
    let token = RELATION * sizes.width + sizes.width * sizes.width;
    let outlook = if sizes.embedding > 0 { OUTLOOK } else { 0 };
    let head = (2 * sizes.width + outlook + DIRECTION + COUNT + RANKS) * sizes.head;
    let state = (2 * sizes.width + COUNT + STATE) * sizes.context;
    (encoder, view + 100 * (token + head) + state)
}

#[derive(Parser)]
struct Comparison {
    #[command(flatten)]
    args: CompareArgs,
}

/// The `metrics` of `cargo vantage compare` with these arguments.
fn metrics(arguments: &[&str]) -> Result<Value> {
    let schemes = "random,fps,soarnet,soarnet-poses,oracle";
    let fixed = ["compare", "--schemes", schemes, "--budgets", BUDGETS];
    let args = Comparison::try_parse_from(fixed.iter().chain(arguments))?.args;
    let (record, failed) = compare(&args)?;
    ensure!(failed == 0, "{failed} objects could not be compared");
    let metrics = record.metrics.context("networks were compared, so they were measured")?;
    let mut metrics = serde_json::to_value(metrics)?;
    if let Some(fields) = metrics.as_object_mut() {
        fields.remove("objects"); // a megabyte that the page does not show
    }
    Ok(metrics)
}

/// Compares on held-out procedural objects and on the objects of a folder.
pub fn compared(real: &Path, data: &Parameters) -> Result<[Value; 2]> {
    let real = real.to_str().context("the folder's name is not UTF-8")?;
    let seed = data.seed.to_string();
    Ok([
        metrics(&["--procedural", PROCEDURAL, "--object-seed", &seed, "--random-candidates"])?,
        metrics(&[real])?,
    ])
}

impl Card {
    /// Reads the figures.
    pub fn read(path: &Path) -> Result<Self> {
        let text =
            fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        serde_json::from_str(&text).with_context(|| format!("{} is no card", path.display()))
    }

    /// The page.
    pub fn page(&self) -> String {
        let Self { data, objects: [train, validation, test], soarnet, poses, .. } = self;
        let (minutes, epochs) = spent(&soarnet.course);
        let (poses_minutes, _) = spent(&poses.course);
        let mut page = format!(
            "# Model card: SOARNet\n\n\
             Drawn from `lab/models/card.json` by `cargo vantage card`; every figure was measured.\n\n\
             ## What it is\n\n\
             A network that ranks further views of an object by what they would add to four \
             objectives (coverage C, geometric complexity Q, ray diversity D, textural complexity \
             T), from the photos and poses so far. `lab/models/soarnet.model` ({} bytes, CRC-32 \
             {:08x}) is what `core` runs, integers only; `lab/models/soarnet.onnx` is the same in \
             floating point. In each photo it sees an outline; the outlines carve the object's visual \
             hull, and it is told what every candidate would see of that. `soarnet-poses` ({} bytes) \
             sees poses alone: what photos add is the difference between the two.\n\n\
             | | soarnet | soarnet-poses |\n|---|---|---|\n\
             | model file, bytes | {} | {} |\n\
             | multiplications to encode a photo | {:.2} M | {:.2} M |\n\
             | for a step with 100 candidates, apart from that | {:.2} M | {:.2} M |\n\
             | int8 against float: rank correlation | {:.4} | {:.4} |\n\
             | the same first choice | {:.1} % | {:.1} % |\n\
             | the same, given the same outlines | {:.1} % | {:.1} % |\n\n\
             The last three: {} and {} steps over the validation objects.\n\n",
            soarnet.bytes,
            soarnet.checksum,
            poses.bytes,
            soarnet.bytes,
            poses.bytes,
            soarnet.encoder_macs as f64 / 1e6,
            poses.encoder_macs as f64 / 1e6,
            soarnet.step_macs as f64 / 1e6,
            poses.step_macs as f64 / 1e6,
            soarnet.agreement.spearman,
            poses.agreement.spearman,
            100.0 * soarnet.agreement.same_choice,
            100.0 * poses.agreement.same_choice,
            100.0 * soarnet.agreement.same_choice_of_outlines,
            100.0 * poses.agreement.same_choice_of_outlines,
            soarnet.agreement.steps,
            poses.agreement.steps,
        );
        page += &format!(
            "## Data and training\n\n\
             {} procedural objects of 20 classes and free form, seed {}: {train} to train on, \
             {validation} to choose among networks, {test} held out, among them every object of two \
             classes (fan, lion). No real object was trained on. Labels at {} x {} pixels.\n\n\
             Training took {minutes:.0} minutes for {epochs} epochs (and {poses_minutes:.0} for the \
             network of poses), on two processor cores that other work kept busy at times. From \
             nothing:\n\n\
             ```sh\n\
             cargo xtask models --real DIR   # DIR: a folder of real objects as GLB files\n\
             ```\n\n\
             On the validation objects, rank correlation of predicted with exact gains, C / Q / D / \
             T: {}; without photos {}",
            data.objects,
            data.seed,
            data.resolution,
            data.resolution,
            of_course(&soarnet.course),
            of_course(&poses.course),
        );
        page += &match &self.literal {
            Some(course) => format!(
                "; the paper's wording (`--preset literal`: views averaged, cumulative targets) {}.\n\n",
                of_course(course)
            ),
            None => ".\n\n".to_owned(),
        };
        page += &format!(
            "![The course of training](models/training.svg)\n\n\
             ## How good it is\n\n\
             Budget {BUDGET}, after the same three first views by farthest points, 100 candidates, 5 \
             seeds; means over objects with 95 % bootstrap intervals. *Closed gap*: (scheme - \
             random) / (exact oracle - random). Definitions: `lab/src/metrics.rs`.\n\n"
        );
        page += &format!(
            "### {PROCEDURAL} held-out procedural objects, other candidates for each seed\n\n"
        );
        page += &tables(&self.procedural);
        page += "### 24 real objects, never trained on\n\n";
        page += &tables(&self.real);
        page += "The second is `cargo vantage compare` over a folder of GLB files with `--schemes \
                 random,fps,soarnet,soarnet-poses,oracle --budgets 6,12,20`.\n\n";
        page += LIMITS;
        page
    }
}

const LIMITS: &str = "\
## Limits and known failures

- Trained on cameras that look at the object's middle from one distance, the horizon level. Photos
  of a capture are brought to that view first (`plan --photos`); a lens with strong distortion is not
  undone.
- A hull has no hollows. What lies inside a container or behind a deep rim is where the exact oracle
  is farthest ahead, in coverage most of all.
- Outlines are drawn in cells of 4 x 4 of 64 x 64 pixels: parts thinner than about a fortieth of the
  picture may be carved away.
- What whole numbers change in the first choice comes through the outlines for the most part, as the
  last rows of the first table tell.
- Directions are all it knows of a candidate: cameras nearer or farther are ranked alike.
- Gains in an objective's own units are rough; their order is what it was trained for.
- Light, backgrounds and blur were varied by computer only. A busy background close behind the
  object has not been measured.
- Objects that are thin throughout (wires, trusses), transparent or mirroring are the worst known
  cases: what is seen through them is not what training showed.
- The literal diversity objective changes as the object is turned, and so does what was learned of
  it: training turns objects by quarter turns only.
";

/// Minutes and number of epochs.
fn spent(course: &Course) -> (f64, usize) {
    (course.epochs.iter().map(|epoch| epoch.seconds).sum::<f64>() / 60.0, course.epochs.len())
}

fn of_course(course: &Course) -> String {
    course.best().map_or_else(
        || "not measured".to_owned(),
        |best| best.validation.spearman.map(|value| format!("{value:.3}")).join(" / "),
    )
}

/// Rank correlations, closed gaps and their differences at the budget.
fn tables(metrics: &Value) -> String {
    let mut text = String::new();
    for (key, title) in [("spearman", "Rank correlation"), ("closed_gap", "Closed gap")] {
        text += &format!("| {title} | C | Q | D | T | mean |\n|---|---|---|---|---|---|\n");
        let rows = metrics[key].as_array().into_iter().flatten();
        for row in rows.filter(|row| row["budget"] == BUDGET && row["scheme"] != "random") {
            text += &format!("| {} |{}\n", row["scheme"].as_str().unwrap_or("?"), cells(row));
        }
        let rows = metrics["differences"].as_array().into_iter().flatten();
        for row in rows.filter(|row| {
            row["budget"] == BUDGET && row["measure"] == key && row["scheme"] == "soarnet"
        }) {
            let minus = row["minus"].as_str().unwrap_or("?");
            text += &format!("| soarnet - {minus}, paired |{}\n", cells(row));
        }
        text += "\n";
    }
    text
}

fn cells(row: &Value) -> String {
    let columns = ["coverage", "geometry", "diversity", "texture", "mean"];
    let cell = |column: &str| {
        let number = |value: &Value| value.as_f64().map_or("?".to_owned(), |v| format!("{v:.3}"));
        let estimate = &row[column];
        let [low, high] = ["low", "high"].map(|end| number(&estimate[end]));
        format!(" {} [{low}, {high}] |", number(&estimate["value"]))
    };
    columns.map(cell).concat()
}
