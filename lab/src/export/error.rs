//! Why an export failed, each in one sentence that says what to do.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a folder was not written.
#[derive(Debug)]
pub enum ExportError {
    /// The folder to write has something in it.
    NotEmpty(PathBuf),
    /// The folder to write, or one above it, is a file.
    NotAFolder(PathBuf),
    /// The path has no last name: `/`, or one that ends in `..`.
    NoName(PathBuf),
    /// There is nothing to write.
    NoPhotos,
    /// A photo's size is not its camera's.
    PhotoSize {
        /// Position among the photos, from 0.
        index: usize,
        /// Width and height of the camera.
        expected: (u32, u32),
        /// Width and height of the photo.
        got: (u32, u32),
    },
    /// A point has a coordinate that is NaN or infinite.
    PointNotFinite {
        /// Position among the points, from 0.
        index: usize,
    },
    /// The layout of NeRF's synthetic scenes cannot hold this camera.
    CameraNotCentred,
    /// Reading or writing failed.
    Io {
        /// The verb: "create", "write".
        action: &'static str,
        /// What could not be created or written.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
}

impl ExportError {
    pub(super) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }
}

impl fmt::Display for ExportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotEmpty(path) => write!(
                f,
                "{} is not empty: name a folder that does not exist yet, or empty this one first",
                path.display()
            ),
            Self::NotAFolder(path) => {
                write!(f, "{} is a file: name a folder that does not exist yet", path.display())
            }
            Self::NoName(path) => write!(
                f,
                "{} does not name a folder to create: end the path in a name",
                path.display()
            ),
            Self::NoPhotos => f.write_str("there are no photos to export: plan at least one view"),
            Self::PhotoSize { index, expected: (width, height), got } => write!(
                f,
                "photo {index} is {} x {} pixels where the camera has {width} x {height}: render \
                 it with the camera of the capture",
                got.0, got.1
            ),
            Self::PointNotFinite { index } => {
                write!(f, "point {index} has a coordinate that is NaN or infinite: leave it out")
            }
            Self::CameraNotCentred => f.write_str(
                "the NeRF-synthetic layout holds only cameras with square pixels and a central \
                 principal point: use such a camera, or the trainer layout",
            ),
            // Opened up here: a chain of sources would say the path twice.
            Self::Io { action, path, source } => {
                let what_to_do = match source.kind() {
                    io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                        ": choose a place where you may write"
                    }
                    io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                        ": make room or choose another disk"
                    }
                    _ => "",
                };
                write!(f, "cannot {action} {} ({source}){what_to_do}", path.display())
            }
        }
    }
}

impl std::error::Error for ExportError {}
