//! What can be wrong with a data set.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a data set cannot be made or read. One sentence each, with the file it is about.
#[derive(Debug)]
pub enum DatasetError {
    /// A file or folder cannot be read or written.
    Io {
        /// What was tried: `read`, `write`, `create`.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The folder has no manifest.
    NotADataset(PathBuf),
    /// The manifest is there, but its run has not come to its end.
    Incomplete(PathBuf),
    /// The manifest is not one of ours, or contradicts itself.
    BadManifest {
        /// The manifest.
        path: PathBuf,
        /// In words.
        why: String,
    },
    /// The folder holds something else, or a data set of other parameters.
    Occupied {
        /// The folder.
        path: PathBuf,
        /// In words.
        why: String,
    },
    /// A shard is not what the manifest says or the format allows.
    BadShard {
        /// The shard.
        path: PathBuf,
        /// How.
        why: ShardError,
    },
    /// There is no object of that index.
    NoObject {
        /// The index asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A parameter is out of its range.
    BadParameter(String),
    /// An object cannot be used.
    BadObject {
        /// Its name.
        name: String,
        /// In words.
        why: String,
    },
}

/// How a shard's bytes are wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShardError {
    /// It does not start with the magic bytes.
    Foreign,
    /// It was written by a later version.
    Version {
        /// The version that we read.
        expected: u32,
        /// The version it has.
        got: u32,
    },
    /// It is shorter or longer than its header says.
    Length {
        /// Bytes by the header or the manifest.
        expected: u64,
        /// Bytes there are.
        got: u64,
    },
    /// Its checksum does not agree.
    Checksum,
    /// It belongs to another data set or another object.
    Mismatch,
    /// Its body cannot be decompressed.
    Compression,
    /// A field of its body ends beyond it, or holds what cannot be.
    Field(&'static str),
}

impl DatasetError {
    pub(super) fn io(action: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), error }
    }
}

impl fmt::Display for DatasetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { action, path, error } => {
                write!(f, "cannot {action} {}: {error}", path.display())
            }
            Self::NotADataset(path) => write!(
                f,
                "{} holds no data set: make one with `cargo vantage dataset --out {}`",
                path.display(),
                path.display()
            ),
            Self::Incomplete(path) => write!(
                f,
                "the data set in {} is not finished: run `cargo vantage dataset` with its \
                 parameters again, and it continues",
                path.display()
            ),
            Self::BadManifest { path, why } => {
                write!(f, "{} cannot be used: {why}", path.display())
            }
            Self::Occupied { path, why } => {
                write!(f, "{} {why}: name another folder", path.display())
            }
            Self::BadShard { path, why } => write!(
                f,
                "{} {why}: delete it and run `cargo vantage dataset` again",
                path.display()
            ),
            Self::NoObject { index, count } => {
                write!(f, "there is no object {index} in a data set of {count}")
            }
            Self::BadParameter(why) => f.write_str(why),
            Self::BadObject { name, why } => write!(f, "{name} cannot be used: {why}"),
        }
    }
}

// No `source`: the sentences above hold the system's words already.
impl std::error::Error for DatasetError {}

impl fmt::Display for ShardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("is no shard of a data set"),
            Self::Version { expected, got } => {
                write!(f, "is a shard of version {got}, and this program reads version {expected}")
            }
            Self::Length { expected, got } => {
                write!(f, "has {got} bytes where {expected} are expected")
            }
            Self::Checksum => f.write_str("is damaged: its checksum does not agree"),
            Self::Mismatch => f.write_str("belongs to another data set or object"),
            Self::Compression => f.write_str("cannot be decompressed"),
            Self::Field(field) => write!(f, "is damaged in its {field}"),
        }
    }
}

impl std::error::Error for ShardError {}
