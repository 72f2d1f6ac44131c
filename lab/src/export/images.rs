//! PNG files, one thread a photo.

use std::fs;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};
use rayon::prelude::*;

use super::{ExportError, Photo, make_folder};

/// Writes each photo under its name; shapes: `names` and `photos` (photos).
pub(super) fn write(folder: &Path, names: &[String], photos: &[Photo]) -> Result<(), ExportError> {
    make_folder(folder)?;
    names.par_iter().zip(photos).try_for_each(|(name, photo)| {
        let path = folder.join(name);
        let mut bytes = Vec::new();
        let (width, height) = photo.image.dimensions();
        // Lossless at any level; adaptive filters halve renders at little cost in time.
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
            .write_image(photo.image.as_raw(), width, height, ExtendedColorType::Rgba8)
            .map_err(|error| ExportError::io("write", &path, into_io(error)))?;
        fs::write(&path, bytes).map_err(|error| ExportError::io("write", &path, error))
    })
}

fn into_io(error: ImageError) -> std::io::Error {
    match error {
        ImageError::IoError(error) => error,
        other => std::io::Error::other(other),
    }
}
