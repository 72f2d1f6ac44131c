//! The float reference: an exported network, run by `tract`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use tract_onnx::pb::ModelProto;
use tract_onnx::prelude::*;
use vantage_core::soarnet::features::{COUNT, DIRECTION, RELATION};
use vantage_core::soarnet::{CELL, OUTLOOK};

use crate::net::{Build, LAST, OBJECTIVES, SIDE, STATE, Shape};
use crate::samples::State;

/// A named array.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    pub dims: Vec<usize>,
    pub values: Vec<f32>,
}

/// A network read from ONNX.
pub struct Reference {
    path: PathBuf,
    proto: ModelProto,
    weights: HashMap<String, Weights>,
    shape: Shape,
}

/// A network prepared for a number of views and candidates.
pub struct Runner {
    plan: Arc<TypedRunnableModel>,
    photos: bool,
}

impl Reference {
    /// Reads a file that `vantage export` wrote.
    pub fn open(path: &Path) -> Result<Self> {
        let foreign = || {
            format!(
                "{} is no network that `cargo vantage export` wrote: export it anew",
                path.display()
            )
        };
        let proto = tract_onnx::onnx()
            .proto_model_for_path(path)
            .map_err(|error| anyhow!("{error:#}"))
            .with_context(|| format!("cannot read {}", path.display()))?;
        let graph = proto.graph.as_ref().with_context(foreign)?;
        let mut weights = HashMap::new();
        for tensor in &graph.initializer {
            if tensor.data_type != 1 {
                continue;
            }
            let dims: Vec<usize> = tensor.dims.iter().map(|&size| size as usize).collect();
            let (bytes, _) = tensor.raw_data.as_chunks::<4>();
            let values: Vec<f32> = bytes.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
            let length = dims.iter().try_fold(1usize, |length, &size| length.checked_mul(size));
            ensure!(length == Some(values.len()), foreign());
            ensure!(
                values.iter().all(|value| value.is_finite()),
                "{} holds a weight that is not finite: train it again",
                path.display()
            );
            weights.insert(tensor.name.clone(), Weights { dims, values });
        }
        let shape = shape_of(&weights).with_context(foreign)?;
        Ok(Self { path: path.to_owned(), proto, weights, shape })
    }

    /// The network's shape.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// An array of weights.
    pub fn weights(&self, name: &str) -> Result<&Weights> {
        self.weights
            .get(name)
            .with_context(|| format!("{} has no `{name}`: export it anew", self.path.display()))
    }

    /// Prepares the network for a number of views and candidates; `outputs` are names of tensors.
    pub fn runner(&self, views: usize, candidates: usize, outputs: &[&str]) -> Result<Runner> {
        let photos = self.shape.embedding > 0;
        let prepare = || -> TractResult<Arc<TypedRunnableModel>> {
            let mut model = tract_onnx::onnx().model_for_proto_model(&self.proto)?;
            model.select_outputs_by_name(outputs)?;
            let mut facts: Vec<TVec<usize>> = vec![
                tvec![views, DIRECTION],
                tvec![views, candidates, RELATION],
                tvec![candidates, DIRECTION],
                tvec![1, COUNT],
            ];
            if photos {
                facts.insert(0, tvec![views, 3, SIDE, SIDE]);
                facts.push(tvec![candidates, OUTLOOK]);
            }
            for (place, shape) in facts.into_iter().enumerate() {
                model.set_input_fact(place, f32::fact(&shape).into())?;
            }
            model.into_optimized()?.into_runnable()
        };
        let plan = prepare()
            .map_err(|error| anyhow!("{error:#}"))
            .with_context(|| format!("cannot run {}", self.path.display()))?;
        Ok(Runner { plan, photos })
    }
}

impl Runner {
    /// The values of the outputs in one state.
    pub fn run(&self, state: &State) -> Result<Vec<Vec<f32>>> {
        let (views, candidates) =
            (state.views.len() / DIRECTION, state.candidates.len() / DIRECTION);
        let tensor = |shape: &[usize], values: &[f32]| -> TractResult<TValue> {
            Ok(Tensor::from_shape(shape, values)?.into_tvalue())
        };
        let run = || -> TractResult<Vec<Vec<f32>>> {
            let mut inputs = tvec![
                tensor(&[views, DIRECTION], &state.views)?,
                tensor(&[views, candidates, RELATION], &state.relations)?,
                tensor(&[candidates, DIRECTION], &state.candidates)?,
                tensor(&[1, COUNT], &state.count)?,
            ];
            if self.photos {
                inputs.insert(0, tensor(&[views, 3, SIDE, SIDE], &state.photos)?);
                inputs.push(tensor(&[candidates, OUTLOOK], &state.outlooks)?);
            }
            let outputs = self.plan.run(inputs)?;
            outputs
                .iter()
                .map(|value| Ok(value.to_plain_array_view::<f32>()?.iter().copied().collect()))
                .collect()
        };
        run().map_err(|error| anyhow!("the network cannot be run: {error:#}"))
    }
}

/// The shape that weights have; `None` where they are none of ours.
fn shape_of(weights: &HashMap<String, Weights>) -> Option<Shape> {
    let dim = |name: &str, place: usize| weights.get(name)?.dims.get(place).copied();
    let embedding = dim("embed.weight", 1).unwrap_or(0);
    let mut channels = [0; 4];
    if embedding > 0 {
        channels = [
            dim("stem.weight", 0)?,
            dim("stage1.down.weight", 0)?,
            dim("stage2.down.weight", 0)?,
            dim("stage3.down.weight", 0)?,
        ];
    }
    let shape = Shape {
        build: Build::Plain,
        channels,
        embedding,
        token: dim("token.weight", 1)?,
        head: dim("head_in.weight", 1)?,
        state: dim("state_in.weight", 1)?,
        relative: true,
        maximum: true,
        outlook: embedding > 0,
    };
    let fits = |(name, dims): &(String, Vec<usize>)| {
        weights.get(name).is_some_and(|weights| weights.dims == *dims)
    };
    arrays(&shape).iter().all(fits).then_some(shape)
}

/// The arrays of a network and their dimensions, as `onnx` writes them.
fn arrays(shape: &Shape) -> Vec<(String, Vec<usize>)> {
    let Shape { channels, embedding, token, head, state, .. } = *shape;
    let mut arrays = Vec::new();
    let mut add = |name: &str, dims: &[usize]| arrays.push((name.to_owned(), dims.to_vec()));
    if embedding > 0 {
        let mut convolution = |name: &str, from: usize, to: usize| {
            add(&format!("{name}.weight"), &[to, from, 3, 3]);
            add(&format!("{name}.bias"), &[to]);
        };
        convolution("stem", 3, channels[0]);
        for stage in 1..channels.len() {
            let (from, to) = (channels[stage - 1], channels[stage]);
            convolution(&format!("stage{stage}.down"), from, to);
            convolution(&format!("stage{stage}.first"), to, to);
            convolution(&format!("stage{stage}.second"), to, to);
        }
        add("embed.weight", &[channels[3].saturating_mul(LAST * LAST), embedding]);
        add("embed.bias", &[embedding]);
        add("sketch.weight", &[CELL, channels[2], 1, 1]);
        add("sketch.bias", &[CELL]);
    }
    let pooled = token.saturating_mul(2);
    let outlook = if embedding > 0 { OUTLOOK } else { 0 };
    for (name, dims) in [
        ("view.weight", [embedding.saturating_add(DIRECTION), token]),
        ("relation.weight", [RELATION, token]),
        ("token.weight", [token, token]),
        ("head_in.weight", [pooled.saturating_add(outlook + DIRECTION), head]),
        ("head_in.count_weight", [COUNT, head]),
        ("head_out.weight", [head, OBJECTIVES]),
        ("state_in.weight", [pooled, state]),
        ("state_in.count_weight", [COUNT, state]),
        ("state_out.weight", [state, STATE]),
    ] {
        add(name, &dims);
    }
    for (name, length) in [
        ("view.bias", token),
        ("token.bias", token),
        ("head_in.bias", head),
        ("head_out.bias", OBJECTIVES),
        ("state_in.bias", state),
        ("state_out.bias", STATE),
    ] {
        add(name, &[length]);
    }
    arrays
}
