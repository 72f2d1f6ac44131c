//! Times an encoding on the host, with the shipped network and the picture of the counts, and writes
//! JSON: milliseconds of an encoding and of the part of it that brings the picture to the network's
//! size (fastest of the rounds), a digest of the result, and the sketch.

use std::hint::black_box;
use std::time::Instant;

use kernel_suite::layers::{digest, picture};
use vantage_core::soarnet::{INPUT, Image, Model, Pixels, SIDE, Scratch};

static FILE: &[u8] = include_bytes!("../../../../lab/models/soarnet.model");

const ROUNDS: usize = 200;
const PHOTOS: u32 = 20;

/// Milliseconds of a call, fastest of the rounds.
fn fastest(mut call: impl FnMut()) -> f64 {
    let round = |_| {
        let begin = Instant::now();
        (0..PHOTOS).for_each(|_| call());
        begin.elapsed().as_secs_f64() * 1e3 / f64::from(PHOTOS)
    };
    (0..ROUNDS).map(round).fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let bytes = picture();
    let model = Model::parse(FILE)?;
    let image = Image::try_new(SIDE as u32, SIDE as u32, Pixels::Rgb888, &bytes)?;
    let window = image.middle()?;
    let mut scratch = Box::new(Scratch::new());
    let seen = model.encode(&image, &window, &mut scratch);
    let result = digest(seen.embedding.iter().chain(seen.sketch));
    let sketch = seen.sketch.to_vec();

    let mut resized = [0; INPUT];
    let resize = fastest(|| image.resize(black_box(&window), &mut resized));
    let encode = fastest(|| {
        black_box(model.encode(black_box(&image), &window, &mut scratch).embedding);
    });
    println!(
        "{{\"milliseconds\":{encode:.4},\"resize\":{resize:.4},\"digest\":\"{result:08x}\",\
         \"sketch\":{sketch:?}}}"
    );
    Ok(())
}
