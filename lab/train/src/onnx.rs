//! The network as ONNX: one graph that answers for one state of a capture.
//!
//! | input | shape | |
//! |---|---|---|
//! | `photos` | (K, 3, 64, 64) | each value (pixel - 128) / 128; absent in a network without photos |
//! | `views` | (K, 16) | features of each view's direction |
//! | `relations` | (K, Z, 16) | features of each view and candidate |
//! | `candidates` | (Z, 16) | features of each candidate's direction |
//! | `count` | (1, 4) | features of K |
//! | `outlooks` | (Z, 8) | of each candidate, number · 4 / 127; absent in a network without photos |
//!
//! Outputs: `ranks` (Z, 4) and `state` (1, 12), as [`net`](crate::net) has them, and with photos
//! `sketch` (K, 5, 8, 8), from which `core` makes the outlooks. K views, Z candidates. Opset 17.

use std::path::Path;

use anyhow::Result;
use burn::nn::Linear;
use burn::tensor::Tensor;
use prost::Message;
use tract_onnx::pb::{
    AttributeProto, GraphProto, ModelProto, NodeProto, OperatorSetIdProto, TensorProto,
    TensorShapeProto, TypeProto, ValueInfoProto,
    attribute_proto::AttributeType,
    tensor_shape_proto::{Dimension, dimension::Value},
    type_proto,
};
use vantage_core::soarnet::features::{COUNT, DIRECTION, RELATION};
use vantage_core::soarnet::{CELL, DETAIL, OUTLOOK};

use crate::files::write_whole;
use crate::net::{Encoder, Network, Normalised, OBJECTIVES, SIDE, STATE};

/// The ONNX operator set that is used.
const OPSET: i64 = 17;
/// The version of the container that came with it.
const IR_VERSION: i64 = 8;
/// `TensorProto.DataType.FLOAT` and `INT64`.
const FLOAT: i32 = 1;
const INT64: i32 = 7;

/// Writes a network; the file appears whole or not at all.
pub fn export(net: &Network, path: &Path) -> Result<()> {
    write_whole(path, &model(net).encode_to_vec())
}

/// A network as an ONNX model.
pub fn model(net: &Network) -> ModelProto {
    let mut graph = Graph::default();
    graph.network(net);
    let GraphProto { node, initializer, .. } = graph.proto;
    let mut input = vec![
        value("views", &[Err("views"), Ok(DIRECTION)]),
        value("relations", &[Err("views"), Err("candidates"), Ok(RELATION)]),
        value("candidates", &[Err("candidates"), Ok(DIRECTION)]),
        value("count", &[Ok(1), Ok(COUNT)]),
    ];
    if net.encoder.is_some() {
        input.insert(0, value("photos", &[Err("views"), Ok(3), Ok(SIDE), Ok(SIDE)]));
        input.push(value("outlooks", &[Err("candidates"), Ok(OUTLOOK)]));
    }
    let mut output = vec![
        value("ranks", &[Err("candidates"), Ok(OBJECTIVES)]),
        value("state", &[Ok(1), Ok(STATE)]),
    ];
    if net.encoder.is_some() {
        output.push(value("sketch", &[Err("views"), Ok(CELL), Ok(DETAIL), Ok(DETAIL)]));
    }
    ModelProto {
        ir_version: IR_VERSION,
        opset_import: vec![OperatorSetIdProto { domain: String::new(), version: OPSET }],
        producer_name: "vantage".to_owned(),
        producer_version: env!("CARGO_PKG_VERSION").to_owned(),
        graph: Some(GraphProto {
            name: "SOARNet".to_owned(),
            node,
            initializer,
            input,
            output,
            ..GraphProto::default()
        }),
        ..ModelProto::default()
    }
}

/// A named tensor of floats; a dimension is a number or a name.
fn value(name: &str, shape: &[Result<usize, &str>]) -> ValueInfoProto {
    let dim = shape.iter().map(|&size| Dimension {
        value: Some(match size {
            Ok(size) => Value::DimValue(size as i64),
            Err(name) => Value::DimParam(name.to_owned()),
        }),
        ..Dimension::default()
    });
    let tensor = type_proto::Tensor {
        elem_type: FLOAT,
        shape: Some(TensorShapeProto { dim: dim.collect() }),
    };
    ValueInfoProto {
        name: name.to_owned(),
        r#type: Some(TypeProto {
            value: Some(type_proto::Value::TensorType(tensor)),
            ..TypeProto::default()
        }),
        ..ValueInfoProto::default()
    }
}

fn integers(name: &str, values: &[i64]) -> AttributeProto {
    AttributeProto {
        name: name.to_owned(),
        r#type: AttributeType::Ints as i32,
        ints: values.to_vec(),
        ..AttributeProto::default()
    }
}

fn integer(name: &str, value: i64) -> AttributeProto {
    AttributeProto {
        name: name.to_owned(),
        r#type: AttributeType::Int as i32,
        i: value,
        ..AttributeProto::default()
    }
}

/// A graph as it grows. Every tensor is named by what it is; a node is named as its output.
#[derive(Default)]
struct Graph {
    proto: GraphProto,
}

impl Graph {
    fn node(&mut self, op: &str, inputs: &[&str], output: &str, attribute: Vec<AttributeProto>) {
        self.proto.node.push(NodeProto {
            op_type: op.to_owned(),
            name: output.to_owned(),
            input: inputs.iter().map(|&name| name.to_owned()).collect(),
            output: vec![output.to_owned()],
            attribute,
            ..NodeProto::default()
        });
    }

    fn floats<const D: usize>(&mut self, name: &str, tensor: Tensor<D>) {
        let dims = tensor.dims().map(|size| size as i64).to_vec();
        let values: Vec<f32> = tensor.into_data().try_to_vec().expect("weights are f32");
        let raw_data = values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
        self.proto.initializer.push(TensorProto {
            name: name.to_owned(),
            dims,
            data_type: FLOAT,
            raw_data,
            ..TensorProto::default()
        });
    }

    fn axes(&mut self, name: &str, values: &[i64]) {
        self.proto.initializer.push(TensorProto {
            name: name.to_owned(),
            dims: vec![values.len() as i64],
            data_type: INT64,
            raw_data: values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            ..TensorProto::default()
        });
    }

    fn relu(&mut self, input: &str, output: &str) {
        self.node("Relu", &[input], output, Vec::new());
    }

    fn conv(&mut self, layer: &Normalised, name: &str, input: &str, output: &str) {
        let names = [format!("{name}.weight"), format!("{name}.bias")];
        let (weight, bias) = layer.folded();
        self.floats(&names[0], weight);
        self.floats(&names[1], bias);
        let stride = [layer.stride() as i64; 2];
        let attributes = vec![
            integers("kernel_shape", &[3, 3]),
            integers("strides", &stride),
            integers("pads", &[1, 1, 1, 1]),
        ];
        self.node("Conv", &[input, &names[0], &names[1]], output, attributes);
    }

    /// `input . weight + bias`, the weights of shape (inputs, outputs).
    fn linear(&mut self, layer: &Linear, name: &str, input: &str, output: &str) {
        let weight = format!("{name}.weight");
        self.floats(&weight, layer.weight.val());
        match &layer.bias {
            Some(bias) => {
                let (bias_name, product) = (format!("{name}.bias"), format!("{output}.product"));
                self.floats(&bias_name, bias.val());
                self.node("MatMul", &[input, &weight], &product, Vec::new());
                self.node("Add", &[&product, &bias_name], output, Vec::new());
            }
            None => self.node("MatMul", &[input, &weight], output, Vec::new()),
        }
    }

    /// The same, where the last `COUNT` inputs are those of `count`, equal for all rows.
    fn linear_and_count(&mut self, layer: &Linear, name: &str, input: &str, output: &str) {
        let [inputs, _] = layer.weight.dims();
        let weight = layer.weight.val();
        let of_count = weight.clone().narrow(0, inputs - COUNT, COUNT);
        let names = ["weight", "count_weight", "bias"].map(|part| format!("{name}.{part}"));
        self.floats(&names[0], weight.narrow(0, 0, inputs - COUNT));
        self.floats(&names[1], of_count);
        self.floats(&names[2], layer.bias.as_ref().expect("heads have a bias").val());
        let parts = ["product", "count", "offset"].map(|part| format!("{output}.{part}"));
        self.node("MatMul", &[input, &names[0]], &parts[0], Vec::new());
        self.node("MatMul", &["count", &names[1]], &parts[1], Vec::new());
        self.node("Add", &[&parts[1], &names[2]], &parts[2], Vec::new());
        self.node("Add", &[&parts[0], &parts[2]], output, Vec::new());
    }

    fn encoder(&mut self, encoder: &Encoder) {
        self.conv(&encoder.stem, "stem", "photos", "stem.sum");
        self.relu("stem.sum", "stem");
        let mut last = "stem".to_owned();
        for (stage, (down, residual)) in encoder.down.iter().zip(&encoder.residual).enumerate() {
            let of = |part: &str| format!("stage{}.{part}", stage + 1);
            self.conv(&down.full, &of("down"), &last, &of("down.sum"));
            self.relu(&of("down.sum"), &of("down"));
            self.conv(&residual.first.full, &of("first"), &of("down"), &of("first.sum"));
            self.relu(&of("first.sum"), &of("first"));
            self.conv(&residual.second.full, &of("second"), &of("first"), &of("second"));
            self.node("Add", &[&of("down"), &of("second")], &of("sum"), Vec::new());
            last = format!("stage{}", stage + 1);
            self.relu(&of("sum"), &last);
        }
        self.floats("sketch.weight", encoder.sketch.weight.val());
        self.floats("sketch.bias", encoder.sketch.bias.as_ref().expect("it has a bias").val());
        let inputs = ["stage2", "sketch.weight", "sketch.bias"];
        self.node("Conv", &inputs, "sketch", vec![integers("kernel_shape", &[1, 1])]);
        self.node("Flatten", &[&last], "map", vec![integer("axis", 1)]);
        self.linear(&encoder.embed, "embed", "map", "embedding");
    }

    fn network(&mut self, net: &Network) {
        let seen = match &net.encoder {
            Some(encoder) => {
                self.encoder(encoder);
                self.node("Concat", &["embedding", "views"], "seen", vec![integer("axis", 1)]);
                "seen"
            }
            None => "views",
        };
        self.linear(&net.view, "view", seen, "view");
        self.axes("axis1", &[1]);
        self.node("Unsqueeze", &["view", "axis1"], "view.each", Vec::new());
        let relation =
            net.relation.as_ref().expect("only networks of relative tokens are exported");
        self.linear(relation, "relation", "relations", "relation");
        self.node("Add", &["view.each", "relation"], "hidden.sum", Vec::new());
        self.relu("hidden.sum", "hidden");
        self.linear(&net.token, "token", "hidden", "token.sum");
        self.relu("token.sum", "token");
        let over_views = || vec![integers("axes", &[0]), integer("keepdims", 0)];
        self.node("ReduceMean", &["token"], "mean", over_views());
        self.node("ReduceMax", &["token"], "maximum", over_views());

        let parts: &[&str] = match &net.encoder {
            Some(_) => &["mean", "maximum", "outlooks", "candidates"],
            None => &["mean", "maximum", "candidates"],
        };
        self.node("Concat", parts, "head.in", vec![integer("axis", 1)]);
        self.linear_and_count(&net.head_in, "head_in", "head.in", "head.sum");
        self.relu("head.sum", "head");
        self.linear(&net.head_out, "head_out", "head", "ranks");

        self.node("Concat", &parts[..2], "pooled", vec![integer("axis", 1)]);
        let over_candidates = vec![integers("axes", &[0]), integer("keepdims", 1)];
        self.node("ReduceMean", &["pooled"], "context", over_candidates);
        self.linear_and_count(&net.state_in, "state_in", "context", "state.sum");
        self.relu("state.sum", "state.hidden");
        self.linear(&net.state_out, "state_out", "state.hidden", "state");
    }
}
