//! Records of a snapshot: what is written one after the other, and why that can fail.

use core::fmt;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// The version of snapshots that is written, and the only one that is read.
pub const VERSION: u16 = 3;

/// Why a snapshot cannot be written or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SnapshotError {
    /// The buffer is too small for the session.
    NoRoom,
    /// The bytes are not a snapshot of a session.
    Foreign,
    /// The snapshot was written by another version.
    Version {
        /// The version found; [`VERSION`] is needed.
        got: u16,
    },
    /// Bytes are missing or follow after the end.
    Length {
        /// Bytes the snapshot says it has.
        expected: usize,
        /// Bytes there are.
        got: usize,
    },
    /// A byte has changed since it was written.
    Checksum,
    /// The records do not hold what they should.
    Malformed,
    /// The snapshot is of a session with another scorer: another mesh, model or reading.
    OtherScorer,
    /// The memory is too small for the session's candidates or views.
    TooLarge,
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoom => f.write_str("the buffer is too small for a snapshot of this session"),
            Self::Foreign => f.write_str("these bytes are not a snapshot of a session"),
            Self::Version { got } => write!(
                f,
                "the snapshot has version {got}, this build reads version {VERSION} only: \
                 start the session anew"
            ),
            Self::Length { expected, got } => {
                write!(
                    f,
                    "the snapshot is cut short or too long: {got} bytes instead of {expected}"
                )
            }
            Self::Checksum => f.write_str("the snapshot is damaged: its checksum does not match"),
            Self::Malformed => f.write_str("the snapshot's records do not hold what they should"),
            Self::OtherScorer => {
                f.write_str("the snapshot belongs to another object, model or reading")
            }
            Self::TooLarge => {
                f.write_str("the session in the snapshot is too large for the memory")
            }
        }
    }
}

impl core::error::Error for SnapshotError {}

/// Where records are written.
#[derive(Debug)]
pub struct Sink<'a> {
    pub(crate) buffer: &'a mut [u8],
    pub(crate) used: usize,
}

impl Sink<'_> {
    /// Writes one record.
    pub fn put<T: Serialize>(&mut self, record: &T) -> Result<(), SnapshotError> {
        let rest = self.buffer.get_mut(self.used..).ok_or(SnapshotError::NoRoom)?;
        let written = postcard::to_slice(record, rest).map_err(|_| SnapshotError::NoRoom)?;
        self.used += written.len();
        Ok(())
    }
}

/// Where records are read from, in the order they were written.
#[derive(Debug)]
pub struct Source<'a> {
    pub(crate) rest: &'a [u8],
}

impl Source<'_> {
    /// Reads one record.
    pub fn take<T: DeserializeOwned>(&mut self) -> Result<T, SnapshotError> {
        let (record, rest) =
            postcard::take_from_bytes(self.rest).map_err(|_| SnapshotError::Malformed)?;
        self.rest = rest;
        Ok(record)
    }
}
