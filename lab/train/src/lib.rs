//! Trains SOARNet on the data sets of `vantage-lab`, exports it to ONNX and quantises it for
//! `vantage-core`.

pub mod augment;
pub mod card;
mod files;
pub mod fit;
pub mod measure;
pub mod net;
pub mod onnx;
pub mod plot;
pub mod quantize;
pub mod reference;
pub mod samples;
