//! What the readers of all formats stand on: why a file is refused, what was left out of it, and
//! the files and pictures it names.

use std::path::Path;
use std::sync::Arc;

use image::{ImageReader, Limits, RgbaImage};

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// There is no such file.
    Missing,
    /// The file, or a buffer it names, cannot be read: the system's reason.
    Unreadable(String),
    /// Neither the content nor the extension is one that is read.
    UnknownFormat,
    /// The content breaks its format's rules: how.
    Corrupt(String),
    /// The file needs a glTF extension that is not supported: its name.
    NeedsExtension(String),
    /// No triangles in it.
    NoFaces,
    /// A coordinate that a face uses is NaN or infinite.
    NotFinite,
    /// All triangles have zero area: how many.
    AllDegenerate(usize),
    /// More than this many triangles or vertices.
    TooLarge(usize),
}

/// More triangles, or vertices of them, than this are refused, so that no file can exhaust memory.
pub(super) const MAX_ELEMENTS: usize = 16_000_000;

/// Sentences about what was left out, each once.
#[derive(Debug, Default)]
pub(super) struct Warnings(Vec<String>);

impl Warnings {
    pub(super) fn add(&mut self, sentence: String) {
        if !self.0.contains(&sentence) {
            self.0.push(sentence);
        }
    }

    pub(super) fn into_sentences(self) -> Vec<String> {
        self.0
    }
}

/// Where the files that a mesh names are looked for: relative to its own folder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Files<'a> {
    folder: Option<&'a Path>,
}

impl<'a> Files<'a> {
    pub(super) fn new(folder: Option<&'a Path>) -> Self {
        Self { folder }
    }

    /// The bytes of a file beside the mesh, or why there are none.
    pub(super) fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let folder = self.folder.ok_or("no folder to look in")?;
        // Exporters on Windows write back slashes; absolute paths of the author's machine are
        // tried by their last part.
        let name = name.replace('\\', "/");
        let direct = folder.join(&name);
        let last = folder.join(name.rsplit('/').next().unwrap_or(&name));
        read_file(&direct).or_else(|why| read_file(&last).map_err(|_| why))
    }
}

/// A regular file of at most 1 GiB: a mesh may name anything, also a device without end.
fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    let about = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if !about.is_file() || about.len() > 1 << 30 {
        return Err("not a file of at most 1 GiB".to_owned());
    }
    std::fs::read(path).map_err(|error| error.to_string())
}

/// Decodes a PNG or JPEG image to RGBA, or says why it cannot.
pub(super) fn decode_image(bytes: &[u8]) -> Result<Arc<RgbaImage>, String> {
    let mut reader = ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| error.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(16_384);
    limits.max_image_height = Some(16_384);
    limits.max_alloc = Some(1 << 30);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?;
    if image.width() == 0 || image.height() == 0 {
        return Err("it has no pixels".to_owned());
    }
    Ok(Arc::new(image.into_rgba8()))
}
