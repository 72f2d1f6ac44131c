//! Times tract on the encoder of `lab/models/soarnet.onnx`, one photo, one thread, and writes JSON:
//! milliseconds, fastest of the rounds, and the largest difference of the sketch from that of the
//! kernels, in steps of 1/127.

use std::time::Instant;

use anyhow::{Context, Result, anyhow, ensure};
use kernel_suite::layers::picture;
use tract_onnx::prelude::*;
use vantage_core::soarnet::{COVER, DETAIL, Image, Model, Pixels, SIDE, Scratch};

const ROUNDS: usize = 100;
const PHOTOS: u32 = 10;

/// Shapes of the network's inputs for one photo and one candidate; the first is the photo.
const INPUTS: [&[usize]; 6] =
    [&[1, 3, SIDE, SIDE], &[1, 16], &[1, 1, 16], &[1, 16], &[1, 4], &[1, 8]];

fn told(error: TractError) -> anyhow::Error {
    anyhow!("{error:#}")
}

fn main() -> Result<()> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../lab/models");
    let run = plan(&format!("{root}/soarnet.onnx")).map_err(told)?;
    let file = std::fs::read(format!("{root}/soarnet.model"))?;
    let model = Model::parse(&file)?;
    let bytes = picture();
    let image = Image::try_new(SIDE as u32, SIDE as u32, Pixels::Rgb888, &bytes)?;
    let mut scratch = Box::new(Scratch::new());
    let seen = model.encode(&image, &image.middle()?, &mut scratch);

    // (channel, row, column), as the network in training is given colours.
    let at = |channel: usize, pixel: usize| f32::from(bytes[3 * pixel + channel]);
    let values = (0..3).flat_map(|channel| (0..SIDE * SIDE).map(move |pixel| (channel, pixel)));
    let values: Vec<f32> = values.map(|(c, p)| (at(c, p) - 128.0) / 128.0).collect();
    // The other inputs do not reach the outputs, but must be there.
    let inputs = INPUTS.map(Tensor::zero::<f32>);
    let mut inputs = inputs.into_iter().collect::<TractResult<Vec<_>>>().map_err(told)?;
    if let Some(photo) = inputs.first_mut() {
        *photo = Tensor::from_shape(INPUTS[0], &values).map_err(told)?;
    }
    let inputs: TVec<TValue> = inputs.into_iter().map(Tensor::into_tvalue).collect();
    let call = || run.run(inputs.clone()).map_err(told);

    let outputs = call()?;
    let sketch = outputs.first().context("the network draws no sketch")?;
    let sketch: Vec<f32> =
        sketch.to_plain_array_view::<f32>().map_err(told)?.iter().copied().collect();
    let difference = difference(&sketch, seen.sketch);
    ensure!(difference < 16.0, "tract draws another sketch, {difference} steps off");

    let mut fastest = f64::INFINITY;
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        for _ in 0..PHOTOS {
            call()?;
        }
        fastest = fastest.min(begin.elapsed().as_secs_f64() * 1e3 / f64::from(PHOTOS));
    }
    println!("{{\"milliseconds\":{fastest:.4},\"difference\":{difference:.1}}}");
    Ok(())
}

/// The encoder: from a photo to its sketch and its embedding.
fn plan(path: &str) -> TractResult<Arc<TypedRunnableModel>> {
    let mut model = tract_onnx::onnx().model_for_path(path)?;
    model.select_outputs_by_name(["sketch", "embedding"])?;
    for (place, shape) in INPUTS.into_iter().enumerate() {
        model.set_input_fact(place, f32::fact(shape).into())?;
    }
    model.into_optimized()?.into_runnable()
}

/// The largest difference, in steps of 1/127, of cells (5, 8, 8) from a sketch.
fn difference(cells: &[f32], sketch: &[i8]) -> f32 {
    let differences = cells.iter().enumerate().map(|(place, &share)| {
        let (number, cell) = (place / (DETAIL * DETAIL), place % (DETAIL * DETAIL));
        let (y, x) = (cell / DETAIL, cell % DETAIL);
        let at = match number {
            0..4 => (2 * y + number / 2) * COVER + 2 * x + number % 2,
            _ => COVER * COVER + cell,
        };
        let step = sketch.get(at).copied().map_or(f32::NAN, f32::from);
        ((share * 127.0).round().clamp(-128.0, 127.0) - step).abs()
    });
    differences.fold(0.0, f32::max)
}
