//! The bare WebAssembly module that `tests/kernels/run-wasm.mjs` executes in Node. No imports.

use std::sync::{Mutex, OnceLock};

use kernel_suite::backends::Chosen;
use kernel_suite::layers::{digest, picture};
use kernel_suite::suite::{Room, run};
use vantage_core::soarnet::{Image, Model, Pixels, SIDE, Scratch};

const SEED: u64 = 1;
const ROUNDS: usize = 400;

static TEXT: OnceLock<String> = OnceLock::new();

fn text() -> &'static str {
    TEXT.get_or_init(|| {
        let vectors = if cfg!(target_feature = "simd128") { "with" } else { "without" };
        match run::<Chosen>(&mut Box::new(Room::new()), SEED, ROUNDS) {
            Ok(count) => format!("{vectors} vectors: {count} cases agree, seed {SEED}"),
            Err(difference) => format!("{vectors} vectors: {difference}"),
        }
    })
}

/// Runs the suite and returns the length of what there is to say, in bytes.
// SAFETY: no other symbol of this module bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn kernels_run() -> usize {
    text().len()
}

/// The address of the text's first byte.
// SAFETY: no other symbol of this module bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn kernels_text() -> *const u8 {
    text().as_ptr()
}

static FILE: &[u8] = include_bytes!("../../../../lab/models/soarnet.model");

static SCRATCH: Mutex<Scratch> = Mutex::new(Scratch::new());

/// Encodes the picture of the counts `times` times with the shipped network and returns a digest of
/// the result; 0 where there is none.
// SAFETY: no other symbol of this module bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn kernels_encode(times: u32) -> u32 {
    let bytes = picture();
    let image = Image::try_new(SIDE as u32, SIDE as u32, Pixels::Rgb888, &bytes);
    let (Ok(model), Ok(image), Ok(mut scratch)) = (Model::parse(FILE), image, SCRATCH.lock())
    else {
        return 0;
    };
    let Ok(window) = image.middle() else { return 0 };
    let mut result = 0;
    for _ in 0..times {
        let seen = model.encode(&image, &window, &mut scratch);
        result = digest(seen.embedding.iter().chain(seen.sketch));
    }
    result
}
