//! LPIPS (Zhang et al., 2018) by a network that the user supplies as ONNX.
//!
//! The file takes two pictures, each of shape (1, 3, height, width), red, green and blue in [-1, 1],
//! and gives one number: what `torch.onnx.export` makes of the authors' `lpips.LPIPS()`. We ship no
//! weights, and without a file there is no figure.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use tract_onnx::prelude::*;

use crate::photos::Picture;

/// A network for pictures of one size.
pub struct Lpips {
    path: PathBuf,
    plan: Arc<TypedRunnableModel>,
    size: [usize; 2], // height, width
}

impl Lpips {
    /// Prepares a file for pictures of a size.
    pub fn open(path: &Path, width: usize, height: usize) -> Result<Self> {
        let prepare = || -> TractResult<Arc<TypedRunnableModel>> {
            let mut model = tract_onnx::onnx().model_for_path(path)?;
            for input in 0..2 {
                model.set_input_fact(input, f32::fact([1, 3, height, width]).into())?;
            }
            model.into_optimized()?.into_runnable()
        };
        let plan = prepare()
            .map_err(|error| anyhow!("{error:#}"))
            .with_context(|| format!("cannot use {} for LPIPS", path.display()))?;
        Ok(Self { path: path.to_owned(), plan, size: [height, width] })
    }

    /// The distance between two pictures.
    pub fn distance(&self, found: &Picture, truth: &Picture) -> Result<f64> {
        let [height, width] = self.size;
        let tensor = |picture: &Picture| -> TractResult<TValue> {
            let value =
                |channel: usize, i: usize| 2.0 * picture.pixels[i][channel].clamp(0.0, 1.0) - 1.0;
            let all = height * width;
            let values: Vec<f32> = (0..3 * all).map(|i| value(i / all, i % all)).collect();
            Ok(Tensor::from_shape(&[1, 3, height, width], &values)?.into_tvalue())
        };
        let run = || -> TractResult<Vec<f32>> {
            let outputs = self.plan.run(tvec![tensor(found)?, tensor(truth)?])?;
            Ok(outputs[0].to_plain_array_view::<f32>()?.iter().copied().collect())
        };
        let values = run()
            .map_err(|error| anyhow!("{error:#}"))
            .with_context(|| format!("cannot run {}", self.path.display()))?;
        let one = values.first().filter(|value| values.len() == 1 && value.is_finite());
        ensure!(one.is_some(), "{} gives {} numbers, not one", self.path.display(), values.len());
        Ok(one.map_or(f64::NAN, |&value| f64::from(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prost::Message;
    use tract_onnx::pb::{
        AttributeProto, GraphProto, ModelProto, NodeProto, OperatorSetIdProto, TensorShapeProto,
        TypeProto, ValueInfoProto, attribute_proto::AttributeType, type_proto,
    };

    /// The mean absolute difference, as a network of the right inputs.
    fn mean_difference() -> Vec<u8> {
        let value = |name: &str| ValueInfoProto {
            name: name.to_owned(),
            r#type: Some(TypeProto {
                value: Some(type_proto::Value::TensorType(type_proto::Tensor {
                    elem_type: 1,
                    shape: Some(TensorShapeProto::default()),
                })),
                ..TypeProto::default()
            }),
            ..ValueInfoProto::default()
        };
        let node = |op: &str, input: &[&str], output: &str| NodeProto {
            op_type: op.to_owned(),
            input: input.iter().map(|&name| name.to_owned()).collect(),
            output: vec![output.to_owned()],
            ..NodeProto::default()
        };
        let mut mean = node("ReduceMean", &["size"], "distance");
        mean.attribute.push(AttributeProto {
            name: "axes".to_owned(),
            r#type: AttributeType::Ints as i32,
            ints: vec![0, 1, 2, 3],
            ..AttributeProto::default()
        });
        let graph = GraphProto {
            node: vec![node("Sub", &["a", "b"], "off"), node("Abs", &["off"], "size"), mean],
            input: vec![value("a"), value("b")],
            output: vec![value("distance")],
            name: "mean difference".to_owned(),
            ..GraphProto::default()
        };
        let model = ModelProto {
            ir_version: 8,
            opset_import: vec![OperatorSetIdProto { version: 17, ..Default::default() }],
            graph: Some(graph),
            ..ModelProto::default()
        };
        model.encode_to_vec()
    }

    #[test]
    fn a_supplied_network_is_given_both_pictures_in_its_range() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("lpips.onnx");
        let says = |path: &Path| format!("{:#}", Lpips::open(path, 5, 4).err().unwrap());
        assert!(says(&path).contains("cannot use"), "{}", says(&path));
        std::fs::write(&path, mean_difference()).unwrap();
        let lpips = Lpips::open(&path, 5, 4).unwrap();
        let picture = |r: f32| Picture { width: 5, pixels: vec![[r, 0.5, 0.25]; 20] };
        // In [-1, 1] a difference of 0.3 is one of 0.6, in one channel of three.
        let distance = lpips.distance(&picture(0.9), &picture(0.6)).unwrap();
        assert!((distance - 0.2).abs() < 1e-6, "{distance}");
    }
}
