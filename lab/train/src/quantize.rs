//! From floating point to signed bytes.
//!
//! Weights are symmetric with a scale for each row. Tensors between layers have one zero point each
//! and, except where maps are added, a scale for each channel: it costs nothing, since scales of
//! inputs are folded into the weights that read them. (With one scale for a whole tensor the first
//! choice was that of floating point in 92 % of steps.) Scales are chosen over calibration states so
//! that the mean squared error is least.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::RangeInclusive;
use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use vantage_core::Vec3;
use vantage_core::planner::Scorer;
use vantage_core::soarnet::features::{COUNT, DIRECTION, RELATION};
use vantage_core::soarnet::{
    self, Dimensions, EncoderParts, Image, Layer, Model, OUTLOOK, Photo, Pixels, SoarNet, Stage,
};
use vantage_lab::statistics::spearman;

use crate::files::write_whole;
use crate::net::{OBJECTIVES, SIDE, Shape};
use crate::reference::{Reference, Weights};
use crate::samples::{self, Ask, Batch, Object, State};

/// Numbers of views at which tensors are looked at.
const COUNTS: [usize; 5] = [1, 3, 6, 12, 24];
/// Candidates of a calibration state.
const CANDIDATES: usize = 48;
/// Values of a channel that are kept of each tensor, about.
const KEPT: usize = 1 << 13;

/// How a tensor's bytes stand for values: `scale * (byte - zero)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub scale: f64,
    pub zero: i32,
}

/// Photos, `byte / 128`.
const PIXELS: Scale = Scale { scale: 1.0 / 128.0, zero: 0 };
/// Features of poses and counts, and shares of a sketch.
const FEATURES: Scale = Scale { scale: 1.0 / 127.0, zero: 0 };
/// Numbers of an outlook.
const OUTLOOKS: Scale = Scale { scale: 4.0 / 127.0, zero: 0 };

impl Scale {
    /// The scale of least squared error; where `cut`, of values that are never negative.
    fn fit(values: &[f32], cut: bool) -> Self {
        let fold = |seed: f32, of: fn(f32, f32) -> f32| values.iter().copied().fold(seed, of);
        let low = if cut { 0.0 } else { f64::from(fold(0.0, f32::min)) };
        let high = f64::from(fold(0.0, f32::max)).max(low + 1e-6);
        let shares = (0..12).map(|step| 1.0 - 0.05 * f64::from(step));
        let tried = shares.map(|share| {
            let scale = Self::of_range(low * share, high * share);
            (scale, scale.error(values))
        });
        tried.min_by(|(_, a), (_, b)| a.total_cmp(b)).expect("a dozen were tried").0
    }

    /// The scales of channels whose bytes share a zero point.
    fn fit_each(channels: &[Vec<f32>], cut: bool) -> Vec<Self> {
        let mut scales: Vec<Self> = if cut {
            channels.iter().map(|values| Self::fit(values, true)).collect()
        } else {
            // As far below 0 as above it.
            let both = |values: &Vec<f32>| values.iter().flat_map(|&v| [v, -v]).collect::<Vec<_>>();
            let scales = channels.iter().map(|values| Self::fit(&both(values), false));
            scales.map(|fitted| Self { zero: 0, ..fitted }).collect()
        };
        // A channel that hardly ever speaks need not be heard finely.
        let widest = scales.iter().map(|scale| scale.scale).fold(0.0, f64::max);
        for scale in &mut scales {
            scale.scale = scale.scale.max(widest / 32.0);
        }
        scales
    }

    fn of_range(low: f64, high: f64) -> Self {
        let scale = (high - low) / 255.0;
        Self { scale, zero: (-128.0 - low / scale).round() as i32 }
    }

    fn error(&self, values: &[f32]) -> f64 {
        let step = values.len().div_ceil(20_000).max(1);
        let of = |value: f32| {
            let value = f64::from(value);
            let byte = ((value / self.scale).round() + f64::from(self.zero)).clamp(-128.0, 127.0);
            (value - self.scale * (byte - f64::from(self.zero))).powi(2)
        };
        values.iter().step_by(step).map(|&value| of(value)).sum()
    }
}

/// A layer in whole numbers; owns what [`Layer`] borrows.
#[derive(Clone, Debug, Default)]
struct Whole {
    weights: Vec<i8>,
    bias: Vec<i32>,
    multipliers: Vec<i32>,
    zero: i8,
}

/// What becomes of a layer's sums.
#[derive(Clone, Copy)]
enum Output<'a> {
    /// Scales of the rows, or of all; with one zero point.
    Bytes(&'a [Scale]),
    /// 32 bits in units of 2^-16.
    Wide,
}

impl Whole {
    fn layer(&self) -> Layer<'_> {
        Layer {
            weights: &self.weights,
            bias: &self.bias,
            multipliers: &self.multipliers,
            zero: self.zero,
        }
    }

    /// `weight(row, column)` over inputs with a scale each.
    fn new(
        weight: impl Fn(usize, usize) -> f32,
        bias: &[f32],
        inputs: &[Scale],
        output: Output<'_>,
    ) -> Result<Self> {
        let zero = if let Output::Bytes([first, ..]) = output { first.zero } else { 0 };
        let mut whole = Self { zero: zero as i8, ..Self::default() };
        for (row, &bias) in bias.iter().enumerate() {
            let unit = match output {
                Output::Bytes(scales) => scales[row.min(scales.len() - 1)].scale,
                // Its multipliers are in units of 2^-36, not 2^-32.
                Output::Wide => 1.0 / 16.0,
            };
            let scaled: Vec<f64> = inputs
                .iter()
                .enumerate()
                .map(|(column, input)| f64::from(weight(row, column)) * input.scale)
                .collect();
            let largest = scaled.iter().fold(0f64, |largest, w| largest.max(w.abs()));
            // A row of hardly any weight beside its bias is as good as constant.
            let step = (largest / 127.0).max(f64::from(bias.abs()) / f64::from(1 << 29)).max(1e-12);
            let bytes = scaled.iter().map(|w| (w / step).round() as i8);
            let first = whole.weights.len();
            whole.weights.extend(bytes);
            let offsets = whole.weights[first..].iter().zip(inputs);
            let offset: i64 = offsets.map(|(&w, input)| i64::from(w) * i64::from(input.zero)).sum();
            let bias = (f64::from(bias) / step).round() - offset as f64;
            let multiplier = (step / unit * 4_294_967_296.0).round();
            ensure!(
                bias.abs() < f64::from(i32::MAX) && multiplier < f64::from(i32::MAX),
                "a layer's weights are too far apart in size for whole numbers (bias {bias:e}, \
                 multiplier {multiplier:e})"
            );
            whole.bias.push(bias as i32);
            whole.multipliers.push(multiplier as i32);
        }
        Ok(whole)
    }

    /// A convolution: ONNX order (out, in, 3, 3) to (out, 3, 3, in).
    fn convolution(
        weight: &Weights,
        bias: &Weights,
        input: &[Scale],
        output: &[Scale],
    ) -> Result<Self> {
        let channels = weight.dims[1];
        let inputs: Vec<Scale> = input.iter().copied().cycle().take(9 * channels).collect();
        let of = |row: usize, column: usize| {
            let (window, channel) = (column / channels, column % channels);
            weight.values[(row * channels + channel) * 9 + window]
        };
        Self::new(of, &bias.values, &inputs, Output::Bytes(output))
    }

    /// A linear layer: ONNX order (in, out), one part after the other, to (out, in).
    fn linear(
        parts: &[&Weights],
        bias: &[f32],
        inputs: &[Scale],
        output: Output<'_>,
    ) -> Result<Self> {
        let columns: Vec<&[f32]> =
            parts.iter().flat_map(|part| part.values.chunks_exact(part.dims[1])).collect();
        ensure!(columns.len() == inputs.len(), "a layer has other inputs than the network");
        Self::new(|row, column| columns[column][row], bias, inputs, output)
    }
}

/// A stage of the encoder in whole numbers.
struct WholeStage {
    layers: [Whole; 3],
    /// What a step of `down` and of `second` is worth in the sum's.
    ratios: [f64; 2],
    zero: i8,
}

impl WholeStage {
    fn parts(&self) -> Stage<'_> {
        let [down, first, second] = self.layers.each_ref().map(Whole::layer);
        let [multiplier, second_multiplier] =
            self.ratios.map(|ratio| (ratio * f64::from(1 << 18)).round() as i32);
        Stage { down, first, second, multiplier, second_multiplier, zero: self.zero }
    }
}

/// A network in whole numbers, as the bytes of a model file.
pub fn quantize(reference: &Reference, objects: &[Object], seed: u64) -> Result<Vec<u8>> {
    let scales = calibrate(reference, objects, seed)?;
    let scale = |name: &str| scales[name].as_slice();
    let weights = |name: &str| reference.weights(name);
    let shape = reference.shape();

    let mut stem = Whole::default();
    let mut stages: Vec<WholeStage> = Vec::new();
    let [mut sketch, mut embed] = [Whole::default(), Whole::default()];
    if shape.embedding > 0 {
        let convolution = |name: &str, input: &[Scale], output: &[Scale]| {
            let (weight, bias) = (format!("{name}.weight"), format!("{name}.bias"));
            Whole::convolution(weights(&weight)?, weights(&bias)?, input, output)
        };
        stem = convolution("stem", &[PIXELS], scale("stem"))?;
        let mut last = scale("stem");
        for stage in 1..=3 {
            let name = |part: &str| format!("stage{stage}.{part}");
            let [down, first, second] = ["down", "first", "second"].map(|part| scale(&name(part)));
            let sum = scale(&format!("stage{stage}"));
            let added = sum[0];
            let layers = [
                convolution(&name("down"), last, down)?,
                convolution(&name("first"), down, first)?,
                convolution(&name("second"), first, second)?,
            ];
            let ratios = [down, second].map(|part| part[0].scale / added.scale);
            stages.push(WholeStage { layers, ratios, zero: added.zero as i8 });
            last = sum;
            if stage == 2 {
                let weight = &weights("sketch.weight")?.values;
                let inputs = vec![last[0]; shape.channels[2]];
                let of = |row: usize, column: usize| weight[row * inputs.len() + column];
                let output = Output::Bytes(&[FEATURES]);
                sketch = Whole::new(of, &weights("sketch.bias")?.values, &inputs, output)?;
            }
        }
        // ONNX flattens (channel, row, column); the model's maps are (row, column, channel).
        let weight = weights("embed.weight")?;
        let (channels, pixels) = (shape.channels[3], weight.dims[0] / shape.channels[3]);
        let of = |row: usize, column: usize| {
            let (pixel, channel) = (column / channels, column % channels);
            weight.values[(channel * pixels + pixel) * weight.dims[1] + row]
        };
        let inputs = vec![last[0]; weight.dims[0]];
        let output = Output::Bytes(scale("embedding"));
        embed = Whole::new(of, &weights("embed.bias")?.values, &inputs, output)?;
    }

    let token = scale("token");
    let mut inputs = Vec::new();
    if shape.embedding > 0 {
        inputs.extend_from_slice(scale("embedding"));
    }
    inputs.extend([FEATURES; DIRECTION + RELATION]);
    let bias = |name: &str| weights(name).map(|weights| weights.values.as_slice());
    let tokens = [
        Whole::linear(
            &[weights("view.weight")?, weights("relation.weight")?],
            bias("view.bias")?,
            &inputs,
            Output::Bytes(scale("hidden")),
        )?,
        Whole::linear(
            &[weights("token.weight")?],
            bias("token.bias")?,
            scale("hidden"),
            Output::Bytes(token),
        )?,
    ];
    let head =
        |name: &str, outlook: usize, features: usize, hidden: &[Scale]| -> Result<[Whole; 2]> {
            let mut inputs = [token, token].concat();
            inputs.extend(vec![OUTLOOKS; outlook]);
            inputs.extend(vec![FEATURES; features]);
            let of = |part: &str| format!("{name}_{part}");
            let [weight, count] = [of("in.weight"), of("in.count_weight")];
            Ok([
                Whole::linear(
                    &[weights(&weight)?, weights(&count)?],
                    bias(&of("in.bias"))?,
                    &inputs,
                    Output::Bytes(hidden),
                )?,
                Whole::linear(
                    &[weights(&of("out.weight"))?],
                    bias(&of("out.bias"))?,
                    hidden,
                    Output::Wide,
                )?,
            ])
        };
    let outlook = if shape.outlook { OUTLOOK } else { 0 };
    let candidate = head("head", outlook, DIRECTION + COUNT, scale("head"))?;
    let state = head("state", 0, COUNT, scale("state.hidden"))?;

    let network = soarnet::Network {
        dimensions: Dimensions {
            channels: shape.channels,
            embedding: shape.embedding,
            width: shape.token,
            head: shape.head,
            context: shape.state,
        },
        encoder: (shape.embedding > 0).then(|| EncoderParts {
            stem: stem.layer(),
            stages: [0, 1, 2].map(|stage: usize| stages[stage].parts()),
            sketch: sketch.layer(),
            embed: embed.layer(),
        }),
        token: tokens.each_ref().map(Whole::layer),
        candidate: candidate.each_ref().map(Whole::layer),
        state: state.each_ref().map(Whole::layer),
    };
    let mut file = vec![0; network.dimensions.file_length()];
    network.write(&mut file).map_err(|error| anyhow!("the network cannot be written: {error}"))?;
    Ok(file)
}

/// Tensors between layers.
struct Tensor {
    name: String,
    channels: usize,
    /// Values of a channel that stand together: pixels of a map.
    pixels: usize,
    /// Whether negative values are cut off.
    cut: bool,
    /// Whether it is added to another, so that all channels have one scale.
    added: bool,
}

impl Tensor {
    fn all(shape: &Shape) -> Vec<Self> {
        let vector = |name: &str, channels: usize| Self {
            name: name.to_owned(),
            channels,
            pixels: 1,
            cut: name != "embedding",
            added: false,
        };
        let mut all = vec![
            vector("hidden", shape.token),
            vector("token", shape.token),
            vector("head", shape.head),
            vector("state.hidden", shape.state),
        ];
        if shape.embedding > 0 {
            all.push(vector("embedding", shape.embedding));
            let map = |name: String, channels: usize, side: usize| Self {
                cut: !name.ends_with("second"),
                added: name != "stem" && !name.ends_with("first"),
                pixels: side * side,
                name,
                channels,
            };
            all.push(map("stem".to_owned(), shape.channels[0], SIDE / 2));
            for stage in 1..=3 {
                for part in [".down", ".first", ".second", ""] {
                    let name = format!("stage{stage}{part}");
                    all.push(map(name, shape.channels[stage], SIDE >> (stage + 1)));
                }
            }
        }
        all
    }
}

/// The scales of every tensor between layers, over captures of training objects: one for each
/// channel, or one.
fn calibrate(
    reference: &Reference,
    objects: &[Object],
    seed: u64,
) -> Result<BTreeMap<String, Vec<Scale>>> {
    let photos = reference.shape().embedding > 0;
    let tensors = Tensor::all(reference.shape());
    let names: Vec<&str> = tensors.iter().map(|tensor| tensor.name.as_str()).collect();
    let mut values: Vec<Vec<Vec<f32>>> =
        tensors.iter().map(|tensor| vec![Vec::new(); tensor.channels]).collect();
    let mut chance = Pcg64::seed_from_u64(seed);
    let steps = objects.iter().map(Object::steps).min().unwrap_or(0);
    let first = objects.first().context("there is no object to calibrate with")?;
    let others = CANDIDATES.min(first.poses().len());
    for (place, count) in COUNTS.iter().map(|&count| count.min(steps)).enumerate() {
        let runner = reference.runner(count, others, &names)?;
        // Different objects at each count; every other one as a webcam might see it.
        let mine = objects.iter().skip(place).step_by(COUNTS.len());
        for (index, object) in mine.enumerate() {
            let ask = Ask {
                views: count,
                counts: vec![count],
                candidates: others,
                augment: index % 2 == 1,
                photos,
            };
            let batch = Batch::draw(&[object], None, &ask, &mut chance);
            let outputs = runner.run(&batch.state(0, count))?;
            for ((tensor, kept), output) in tensors.iter().zip(&mut values).zip(outputs) {
                let runs = output.chunks_exact(tensor.pixels);
                // As many of every capture, so that no one of them decides.
                let share = (KEPT / objects.len()).max(1);
                let step = (output.len() / tensor.channels).div_ceil(share).max(1);
                for (channel, run) in (0..tensor.channels).cycle().zip(runs) {
                    let kept = &mut kept[channel];
                    kept.extend(run.iter().step_by(step.min(tensor.pixels)));
                    let largest = run.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()));
                    kept.extend(largest.filter(|_| tensor.pixels > 1));
                }
            }
        }
    }
    let scales = tensors.into_iter().zip(values).map(|(tensor, values)| {
        let scales = if tensor.added {
            vec![Scale::fit(&values.concat(), tensor.cut)]
        } else {
            Scale::fit_each(&values, tensor.cut)
        };
        (tensor.name, scales)
    });
    Ok(scales.collect())
}

/// How near a model file comes to its float reference.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Agreement {
    /// Mean Spearman's rank correlation of the two networks' ranks over the free candidates.
    pub spearman: f64,
    /// Share of the steps in which both choose the same candidate.
    pub same_choice: f64,
    /// The same where the reference is told the model's own outlooks: what the heads alone change.
    pub same_choice_of_outlines: f64,
    /// States and objectives compared.
    pub steps: usize,
}

/// The sketches of a capture's photos, as the float reference draws them; none without photos.
fn drawn(reference: &Reference, state: &State) -> Result<Vec<[i8; soarnet::SKETCH]>> {
    if reference.shape().embedding == 0 {
        return Ok(Vec::new());
    }
    let (views, others) = (state.views.len() / DIRECTION, state.candidates.len() / DIRECTION);
    let cells = reference.runner(views, others, &["sketch"])?.run(state)?.remove(0);
    Ok(cells.chunks_exact(soarnet::SKETCH).map(samples::sketch_of).collect())
}

/// Compares a model file with its reference on the captures of some objects, photos unchanged.
pub fn agreement(
    reference: &Reference,
    file: &[u8],
    objects: &[Object],
    counts: RangeInclusive<usize>,
) -> Result<Agreement> {
    let model = Model::parse(file).map_err(|error| anyhow!("{error}"))?;
    let photos = reference.shape().embedding > 0;
    let steps = objects.iter().map(Object::steps).min().unwrap_or(0);
    let counts = *counts.start()..=steps.min(*counts.end());
    let (mut sum, mut same, mut same_of_outlines, mut compared) = (0.0, 0usize, 0usize, 0usize);
    let mut runners = BTreeMap::new();
    for object in objects {
        let views: Vec<usize> = object.walk(1).collect();
        let others = object.poses().len();
        let ask = Ask {
            views: *counts.end(),
            counts: counts.clone().collect(),
            candidates: usize::MAX,
            augment: false,
            photos,
        };
        let batch = Batch::draw(&[object], Some(1), &ask, &mut Pcg64::seed_from_u64(0));
        let sketches = drawn(reference, &batch.state(0, *counts.end()))?;
        let mut memory = Box::new(soarnet::Fixed::<1000, 64>::new());
        let poses = object.poses().iter().copied();
        let mut scorer = SoarNet::try_new(model, &mut *memory, Vec3::ZERO, poses)?;
        for (place, &view) in views.iter().take(*counts.end()).enumerate() {
            let bytes = object.photo(view);
            let side = SIDE as u32;
            let image = Image::try_new(side, side, Pixels::Rgb888, &bytes)?;
            let photo = if photos { Photo::new(image) } else { Photo::default() };
            scorer.observe(&object.poses()[view], &photo)?;
            let count = place + 1;
            if !counts.contains(&count) {
                continue;
            }
            let runner = match runners.entry(count) {
                Entry::Occupied(there) => there.into_mut(),
                Entry::Vacant(none) => none.insert(reference.runner(count, others, &["ranks"])?),
            };
            let state = batch.state(0, count);
            let told = |outlooks: Vec<f32>| -> Result<Vec<f32>> {
                Ok(runner.run(&State { outlooks, ..state.clone() })?.remove(0))
            };
            let float = told(object.outlooks(&views[..count], &sketches))?;
            let own = (0..others).filter_map(|other| scorer.outlook(other)).flatten();
            let float_of_own = match photos {
                true => told(own.map(|number| samples::outlook(number as i8)).collect())?,
                false => float.clone(),
            };
            let free: Vec<usize> =
                (0..others).filter(|other| !views[..count].contains(other)).collect();
            for objective in 0..OBJECTIVES {
                let of = |float: &[f32]| -> Vec<f64> {
                    free.iter().map(|&other| float[other * OBJECTIVES + objective].into()).collect()
                };
                let a = of(&float);
                let b: Vec<f64> = free
                    .iter()
                    .map(|&other| scorer.ranks(other).map_or(0.0, |ranks| ranks[objective].into()))
                    .collect();
                let first = |values: &[f64]| {
                    (0..values.len()).rev().max_by(|&x, &y| values[x].total_cmp(&values[y]))
                };
                sum += spearman(&b, &a).unwrap_or(1.0);
                same += usize::from(first(&a) == first(&b));
                same_of_outlines += usize::from(first(&of(&float_of_own)) == first(&b));
                compared += 1;
            }
        }
    }
    let of = |sum: f64| sum / compared.max(1) as f64;
    Ok(Agreement {
        spearman: of(sum),
        same_choice: of(same as f64),
        same_choice_of_outlines: of(same_of_outlines as f64),
        steps: compared,
    })
}

/// Writes a model file that appears whole or not at all.
pub fn save(file: &[u8], path: &Path) -> Result<()> {
    write_whole(path, file)
}
