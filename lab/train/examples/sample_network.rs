//! Writes networks with random weights as ONNX, and what they answer: what `tests/readers` checks.
//!
//! ```sh
//! cargo run --release -p vantage-train --example sample_network -- OUT
//! ```
//!
//! makes `OUT/network.onnx`, `OUT/poses.onnx` (one without photos) and `OUT/states.json`: for each
//! file two states with different numbers of views and candidates, each as
//! `{"inputs": {NAME: {"shape": [..], "values": [..]}}, "outputs": likewise}`, in row-major order.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};
use burn::module::Module;
use burn::tensor::{Device, Tensor, TensorData};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::soarnet::features::{COUNT, DIRECTION, RELATION, Stance};
use vantage_core::soarnet::{CELL, DETAIL, OUTLOOK};
use vantage_core::{Pose, Vec3};
use vantage_train::net::{Network, OBJECTIVES, Question, SIDE, STATE, Shape};
use vantage_train::{onnx, samples};

/// Numbers of views and candidates of the states.
const STATES: [[usize; 2]; 2] = [[3, 40], [9, 17]];

/// Passes over photos, so that the encoder's normalisation has seen means and variances.
const PASSES: usize = 6;

/// An array with its shape.
#[derive(Serialize)]
struct Array {
    shape: Vec<usize>,
    values: Vec<f32>,
}

/// What a network is asked in one state, and what it answers.
#[derive(Serialize)]
struct State {
    inputs: BTreeMap<&'static str, Array>,
    outputs: BTreeMap<&'static str, Array>,
}

fn main() -> Result<()> {
    let out: PathBuf =
        std::env::args_os().nth(1).context("name a folder to write the networks to")?.into();
    fs::create_dir_all(&out).with_context(|| format!("cannot create {}", out.display()))?;
    let device = Device::flex();
    let mut chance = Pcg64::seed_from_u64(1);
    let mut states = BTreeMap::new();
    for (file, shape) in
        [("network.onnx", Shape::default()), ("poses.onnx", Shape::default().without_photos())]
    {
        let net = network(&shape, &device, &mut chance)?;
        onnx::export(&net, &out.join(file))?;
        let states_of = STATES.map(|[views, candidates]| {
            let ask = Ask::draw(views, candidates, shape.embedding > 0, &mut chance)?;
            ask.answered(&net, &device)
        });
        states.insert(file, states_of.into_iter().collect::<Result<Vec<_>>>()?);
    }
    fs::write(out.join("states.json"), serde_json::to_string(&states)?)?;
    Ok(())
}

/// A network of random weights, its normalisation settled on random photos.
fn network(shape: &Shape, device: &Device, chance: &mut Pcg64) -> Result<Network> {
    let training = device.clone().autodiff();
    training.seed(1);
    let net = Network::new(shape, &training);
    if shape.embedding > 0 {
        for _ in 0..PASSES {
            let ask = Ask::draw(8, 2, true, chance)?;
            let _ = net.forward(ask.question(&training));
        }
    }
    Ok(net.valid())
}

/// One state of a made-up capture, in plain numbers.
struct Ask {
    photos: Vec<f32>,         // (views, 3, 64, 64), or empty
    directions: Vec<f32>,     // (views, 16)
    relations: Vec<Vec<f32>>, // of each view, (candidates, 16)
    candidates: Vec<f32>,     // (candidates, 16)
    outlooks: Vec<f32>,       // (candidates, 8), or empty
    views: usize,
    others: usize,
}

impl Ask {
    fn draw(views: usize, others: usize, photos: bool, chance: &mut Pcg64) -> Result<Self> {
        let space = ViewSpace::RandomSphere { seed: chance.random() };
        let poses: Vec<Pose> = Pool::try_new(space, views + others, 2.8)?.iter().collect();
        let stances: Option<Vec<Stance>> =
            poses.iter().map(|pose| Stance::try_new(pose, Vec3::ZERO)).collect();
        let stances = stances.context("a view stands on the object")?;
        let (taken, free) = stances.split_at(views);
        let value = |feature: i8| f32::from(feature) / 127.0;
        let direction = |stance: &Stance| stance.direction.features().map(value);
        let relations = |view: &Stance| {
            free.iter().flat_map(|other| view.relation(other.direction).map(value)).collect()
        };
        // Two colours that meet at some row, with noise: a picture that has an inside and edges.
        let mut photo = Vec::new();
        for _ in 0..if photos { views * 3 } else { 0 } {
            let (above, below) = (chance.random_range(-100..100), chance.random_range(-100..100));
            let edge = chance.random_range(8..SIDE - 8);
            for place in 0..SIDE * SIDE {
                let level: i32 = if place / SIDE < edge { above } else { below };
                let byte = level + chance.random_range(-20..=20);
                photo.push(byte as f32 / 128.0);
            }
        }
        let numbers = if photos { others * OUTLOOK } else { 0 };
        Ok(Self {
            outlooks: (0..numbers)
                .map(|_| samples::outlook(chance.random_range(-127..=127)))
                .collect(),
            photos: photo,
            directions: taken.iter().flat_map(direction).collect(),
            relations: taken.iter().map(relations).collect(),
            candidates: free.iter().flat_map(direction).collect(),
            views,
            others,
        })
    }

    fn question(&self, device: &Device) -> Question {
        let Self { views, others, .. } = *self;
        let of = |values: &[f32], shape: [usize; 3]| {
            Tensor::<3>::from_data(TensorData::new(values.to_vec(), shape), device)
        };
        let shape =
            if self.photos.is_empty() { [0, 3, SIDE, SIDE] } else { [views, 3, SIDE, SIDE] };
        let relations = self.relations.iter();
        Question {
            photos: Tensor::from_data(TensorData::new(self.photos.clone(), shape), device),
            views: of(&self.directions, [1, views, DIRECTION]),
            relations: relations.map(|values| of(values, [1, others, RELATION])).collect(),
            candidates: of(&self.candidates, [1, others, DIRECTION]),
            outlooks: if self.outlooks.is_empty() {
                Vec::new()
            } else {
                vec![of(&self.outlooks, [1, others, OUTLOOK])]
            },
            counts: vec![views],
        }
    }

    fn answered(&self, net: &Network, device: &Device) -> Result<State> {
        let Self { views, others, .. } = *self;
        let answer = net.forward(self.question(device));
        let ranks = values(answer.ranks)?;
        let array = |shape: &[usize], values: &[f32]| Array {
            shape: shape.to_vec(),
            values: values.to_vec(),
        };
        let mut inputs = BTreeMap::from([
            ("views", array(&[views, DIRECTION], &self.directions)),
            ("relations", array(&[views, others, RELATION], &self.relations.concat())),
            ("candidates", array(&[others, DIRECTION], &self.candidates)),
            ("count", array(&[1, COUNT], &values(samples::count(views, device))?)),
        ]);
        if !self.photos.is_empty() {
            inputs.insert("photos", array(&[views, 3, SIDE, SIDE], &self.photos));
            inputs.insert("outlooks", array(&[others, OUTLOOK], &self.outlooks));
        }
        let mut outputs = BTreeMap::from([
            ("ranks", array(&[others, OBJECTIVES], &ranks)),
            ("state", array(&[1, STATE], &values(answer.state)?)),
        ]);
        if let Some(sketches) = answer.sketches {
            let cells = values(sketches.seen)?;
            outputs.insert("sketch", array(&[views, CELL, DETAIL, DETAIL], &cells));
        }
        Ok(State { inputs, outputs })
    }
}

fn values<const D: usize>(tensor: Tensor<D>) -> Result<Vec<f32>> {
    tensor.into_data().try_to_vec().map_err(|error| anyhow::anyhow!("{error:?}"))
}
