//! SOARNet in floating point, as it is trained.
//!
//! ```text
//! photo (3, 64, 64) -> encoder -> embedding (E), sketch (5, 8, 8)                once per photo
//! [embedding | direction of the view] -> U ; U + W relation(view, candidate) -> relu
//!                                     -> relu(linear) = token                    per (view, candidate)
//! tokens of all views -> mean, maximum                                           per candidate
//! [mean | maximum | outlook | direction of the candidate | count of views] -> H -> 4 ranks
//! [mean over candidates of (mean | maximum) | count of views]    -> G -> 12      per state
//! ```
//!
//! From the sketches `core` carves the object's visual hull and tells what each candidate would see of
//! it: the outlook. That is no part of what is trained; training is given outlooks of true outlines.
//!
//! G gives the scores F_n and, times the number of views, mean and spread of the gains over the
//! candidates, so that a gain in the objective's own units is mean + spread * rank. With cumulative
//! targets H gives F_n+1 itself.

use burn::module::{Initializer, Module};
use burn::nn::conv::{Conv2d, Conv2dConfig};
use burn::nn::{BatchNorm, BatchNormConfig, Linear, LinearConfig, PaddingConfig2d};
use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor};
use serde::{Deserialize, Serialize};
use vantage_core::soarnet::features::{COUNT, DIRECTION, RELATION};
use vantage_core::soarnet::{CELL, OUTLOOK, SKETCH};

/// Side of a photo in pixels.
pub const SIDE: usize = 64;
/// Side of the last map.
pub const LAST: usize = 4;
/// Outputs of G: scores, means, spreads.
pub const STATE: usize = 12;
/// C, Q, D, T.
pub const OBJECTIVES: usize = 4;

/// How an encoder is built. Only the first is exported; the others are there to be compared with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Build {
    /// As `core` runs it.
    #[default]
    Plain,
    /// After the stem every window of 3 x 3 is over a channel by itself, and one pixel's channels are
    /// mixed after it.
    Separable,
    /// Of photos with half as many pixels on each side; the second stage leaves the map as large as it
    /// is.
    Halved,
}

/// The shape of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shape {
    /// How the encoder is built.
    #[serde(default)]
    pub build: Build,
    /// Channels after the stem and after each of the three stages.
    pub channels: [usize; 4],
    /// Width of an embedding; 0 for a network that sees no photos.
    pub embedding: usize,
    /// Width of a token.
    pub token: usize,
    /// Width of head H.
    pub head: usize,
    /// Width of head G.
    pub state: usize,
    /// Whether tokens know where the candidate lies from their view; else they are of views alone.
    pub relative: bool,
    /// Whether tokens are pooled by their maximum too.
    pub maximum: bool,
    /// Whether head H is told the candidate's outlook; a network without photos has none.
    pub outlook: bool,
}

impl Default for Shape {
    fn default() -> Self {
        Self {
            build: Build::Plain,
            channels: [16, 16, 32, 48],
            embedding: 96,
            token: 96,
            head: 96,
            state: 64,
            relative: true,
            maximum: true,
            outlook: true,
        }
    }
}

impl Shape {
    /// The same without photos.
    pub fn without_photos(self) -> Self {
        Self { embedding: 0, outlook: false, ..self }
    }
}

/// A convolution whose outputs are normalised over the batch. Where the network leaves training,
/// the normalisation is part of its weights: see [`Normalised::folded`].
#[derive(Module, Debug)]
pub struct Normalised {
    conv: Conv2d,
    norm: BatchNorm,
}

impl Normalised {
    /// A window of `edge` x `edge`, over channels in so many groups.
    fn new(
        [from, to]: [usize; 2],
        edge: usize,
        stride: usize,
        groups: usize,
        device: &Device,
    ) -> Self {
        let around = edge / 2;
        let conv = Conv2dConfig::new([from, to], [edge, edge])
            .with_stride([stride, stride])
            .with_padding(PaddingConfig2d::Explicit(around, around, around, around))
            .with_groups(groups)
            .with_bias(false)
            .with_initializer(Initializer::KaimingNormal {
                gain: 2f64.sqrt(),
                fan_out_only: false,
            });
        Self { conv: conv.init(device), norm: BatchNormConfig::new(to).init(device) }
    }

    fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        self.norm.forward(self.conv.forward(x))
    }

    /// Pixels from one window to the next.
    pub fn stride(&self) -> usize {
        self.conv.stride[0]
    }

    /// The same as one convolution after training: weights (out, in, 3, 3), biases (out).
    pub fn folded(&self) -> (Tensor<4>, Tensor<1>) {
        let variance = self.norm.running_var.value();
        let scale = self.norm.gamma.val() / variance.add_scalar(self.norm.epsilon).sqrt();
        let bias = self.norm.beta.val() - self.norm.running_mean.value() * scale.clone();
        let channels = scale.dims()[0];
        (self.conv.weight.val() * scale.reshape([channels, 1, 1, 1]), bias)
    }
}

/// A window of 3 x 3 over all channels, in one convolution or in two.
#[derive(Module, Debug)]
pub struct Windows {
    /// Over each channel by itself, where the encoder is separable.
    alone: Option<Normalised>,
    /// Over all channels, then of one pixel.
    pub full: Normalised,
}

impl Windows {
    fn new(build: Build, [from, to]: [usize; 2], stride: usize, device: &Device) -> Self {
        let new = |channels, edge, stride, groups| {
            Normalised::new(channels, edge, stride, groups, device)
        };
        match build {
            Build::Separable => Self {
                alone: Some(new([from, from], 3, stride, from)),
                full: new([from, to], 1, 1, 1),
            },
            Build::Plain | Build::Halved => {
                Self { alone: None, full: new([from, to], 3, stride, 1) }
            }
        }
    }

    fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        match &self.alone {
            Some(alone) => self.full.forward(relu(alone.forward(x))),
            None => self.full.forward(x),
        }
    }
}

/// Two convolutions around which the input is passed.
#[derive(Module, Debug)]
pub struct Residual {
    pub first: Windows,
    pub second: Windows,
}

impl Residual {
    fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        let inner = relu(self.first.forward(x.clone()));
        relu(x + self.second.forward(inner))
    }
}

/// Photo to embedding and sketch.
#[derive(Module, Debug)]
pub struct Encoder {
    pub stem: Normalised,
    pub down: Vec<Windows>,
    pub residual: Vec<Residual>,
    pub embed: Linear,
    /// Tells a sketch's cells from the second stage's map.
    pub sketch: Conv2d,
    /// Tells the sketch from the embedding; for training only. Without it the embedding, noise at
    /// first, is silenced before it means anything.
    pub recall: Linear,
    halved: bool,
}

/// The stage of whose map the sketch is told.
const SKETCHED: usize = 1;

impl Encoder {
    fn new(shape: &Shape, device: &Device) -> Self {
        let [stem, rest @ ..] = shape.channels;
        let from = [shape.channels[0], shape.channels[1], shape.channels[2]];
        let halved = shape.build == Build::Halved;
        let layer = |from, to, stride| Windows::new(shape.build, [from, to], stride, device);
        let strides = if halved { [2, 1, 2] } else { [2; 3] };
        let down = from.iter().zip(rest).zip(strides);
        Self {
            halved,
            stem: Normalised::new([3, stem], 3, 2, 1, device),
            down: down.map(|((&from, to), stride)| layer(from, to, stride)).collect(),
            residual: rest
                .iter()
                .map(|&c| Residual { first: layer(c, c, 1), second: layer(c, c, 1) })
                .collect(),
            embed: LinearConfig::new(shape.channels[3] * LAST * LAST, shape.embedding).init(device),
            sketch: Conv2dConfig::new([shape.channels[2], CELL], [1, 1]).init(device),
            recall: LinearConfig::new(shape.embedding, SKETCH).init(device),
        }
    }

    /// Photos, shape (n, 3, 64, 64), each value (pixel - 128) / 128, to embeddings (n, E) and
    /// sketches (n, 5, 8, 8).
    pub fn forward(&self, photos: Tensor<4>) -> (Tensor<2>, Tensor<4>) {
        let photos = match self.halved {
            true => half_as_large(photos),
            false => photos,
        };
        let mut x = relu(self.stem.forward(photos));
        let mut sketch = None;
        for (stage, (down, residual)) in self.down.iter().zip(&self.residual).enumerate() {
            x = residual.forward(relu(down.forward(x)));
            if stage == SKETCHED {
                sketch = Some(self.sketch.forward(x.clone()));
            }
        }
        let sketch = sketch.expect("there are three stages");
        (self.embed.forward(x.flatten::<2>(1, 3)), sketch)
    }
}

/// Photos (n, 3, 64, 64) to (n, 3, 32, 32): the means of four pixels.
fn half_as_large(photos: Tensor<4>) -> Tensor<4> {
    const HALF: usize = SIDE / 2;
    let [number, colours, ..] = photos.dims();
    let pairs = photos.reshape([number * colours * HALF, 2, HALF, 2]);
    pairs.mean_dim(1).mean_dim(3).reshape([number, colours, HALF, HALF])
}

/// The whole network.
#[derive(Module, Debug)]
pub struct Network {
    pub encoder: Option<Encoder>,
    pub view: Linear,
    pub relation: Option<Linear>,
    pub token: Linear,
    pub head_in: Linear,
    pub head_out: Linear,
    pub state_in: Linear,
    pub state_out: Linear,
    maximum: bool,
    outlook: bool,
}

/// What the network is asked: of each of B objects, K views in order and Z candidates.
#[derive(Clone, Debug)]
pub struct Question {
    /// (B * K, 3, 64, 64); without an encoder it is not looked at.
    pub photos: Tensor<4>,
    /// (B, K, 16).
    pub views: Tensor<3>,
    /// Of each view, (B, Z, 16).
    pub relations: Vec<Tensor<3>>,
    /// (B, Z, 16).
    pub candidates: Tensor<3>,
    /// For each of the counts, (B, Z, 8); without an outlook they are not looked at.
    pub outlooks: Vec<Tensor<3>>,
    /// The numbers of views asked about, ascending, each at most K.
    pub counts: Vec<usize>,
}

/// What it answers for each of P counts of views.
#[derive(Clone, Debug)]
pub struct Answer {
    /// (P * B, Z, 4).
    pub ranks: Tensor<3>,
    /// (P * B, 12).
    pub state: Tensor<2>,
    /// What each photo shows.
    pub sketches: Option<Sketches>,
}

/// What photos show, twice.
#[derive(Clone, Debug)]
pub struct Sketches {
    /// Cell by cell, (B * K, 320) = (.., 5, 8, 8).
    pub seen: Tensor<2>,
    /// The same, told from the embedding.
    pub recalled: Tensor<2>,
}

impl Network {
    /// A network with random weights.
    pub fn new(shape: &Shape, device: &Device) -> Self {
        let linear = |from: usize, to: usize| {
            LinearConfig::new(from, to)
                .with_initializer(Initializer::KaimingNormal { gain: 1.4, fan_out_only: false })
                .init(device)
        };
        let last = |from: usize, to: usize| {
            LinearConfig::new(from, to)
                .with_initializer(Initializer::KaimingNormal { gain: 0.3, fan_out_only: false })
                .init(device)
        };
        let pooled = shape.token * if shape.maximum { 2 } else { 1 };
        let outlook = if shape.outlook { OUTLOOK } else { 0 };
        let relation = || {
            LinearConfig::new(RELATION, shape.token)
                .with_bias(false)
                .with_initializer(Initializer::KaimingNormal { gain: 1.4, fan_out_only: false })
                .init(device)
        };
        Self {
            encoder: (shape.embedding > 0).then(|| Encoder::new(shape, device)),
            view: linear(shape.embedding + DIRECTION, shape.token),
            relation: shape.relative.then(relation),
            token: linear(shape.token, shape.token),
            head_in: linear(pooled + outlook + DIRECTION + COUNT, shape.head),
            head_out: last(shape.head, OBJECTIVES),
            state_in: linear(pooled + COUNT, shape.state),
            state_out: last(shape.state, STATE),
            maximum: shape.maximum,
            outlook: shape.outlook,
        }
    }

    /// Answers for every count of views.
    pub fn forward(&self, question: Question) -> Answer {
        let Question { photos, views, relations, candidates, outlooks, counts } = question;
        let mut outlooks = outlooks.into_iter();
        let [objects, number, _] = views.dims();
        let device = views.device();
        let mut sketches = None;
        let seen = match &self.encoder {
            Some(encoder) => {
                let (embeddings, cells) = encoder.forward(photos);
                let recalled = encoder.recall.forward(embeddings.clone());
                sketches = Some(Sketches { seen: cells.flatten::<2>(1, 3), recalled });
                let width = embeddings.dims()[1];
                Tensor::cat(vec![embeddings.reshape([objects, number, width]), views], 2)
            }
            None => views,
        };
        let from_views = self.view.forward(seen);
        let [_, others, _] = candidates.dims();

        let mut sum: Option<Tensor<3>> = None;
        let mut highest: Option<Tensor<3>> = None;
        let (mut ranks, mut states) = (Vec::new(), Vec::new());
        for (place, relation) in relations.into_iter().enumerate() {
            let of_view = from_views.clone().narrow(1, place, 1);
            let hidden = match &self.relation {
                Some(linear) => of_view + linear.forward(relation),
                None => of_view.repeat_dim(1, others),
            };
            let token = relu(self.token.forward(relu(hidden)));
            sum = Some(match sum {
                Some(sum) => sum + token.clone(),
                None => token.clone(),
            });
            if self.maximum {
                highest = Some(match highest {
                    Some(highest) => highest.max_pair(token),
                    None => token,
                });
            }
            let taken = place + 1;
            let (Some(sum), true) = (&sum, counts.contains(&taken)) else { continue };
            let mean = sum.clone().div_scalar(taken as f32);
            let pooled = match &highest {
                Some(highest) => Tensor::cat(vec![mean, highest.clone()], 2),
                None => mean,
            };
            let count = crate::samples::count(taken, &device);
            let of_each = count.clone().reshape([1, 1, COUNT]).repeat(&[objects, others, 1]);
            let mut parts = vec![pooled.clone()];
            parts.extend(outlooks.next().filter(|_| self.outlook));
            parts.extend([candidates.clone(), of_each]);
            ranks.push(Tensor::cat(parts, 2));
            let context = pooled.mean_dim(1).squeeze_dim::<2>(1);
            let of_state = count.reshape([1, COUNT]).repeat_dim(0, objects);
            states.push(Tensor::cat(vec![context, of_state], 1));
        }
        let ranks = self.head_out.forward(relu(self.head_in.forward(Tensor::cat(ranks, 0))));
        let state = self.state_out.forward(relu(self.state_in.forward(Tensor::cat(states, 0))));
        Answer { ranks, state, sketches }
    }

    /// Weights and biases there are.
    pub fn parameters(&self) -> usize {
        self.num_params()
    }
}
