//! What is said on the line, in [postcard](https://postcard.jamesmunns.com) encoding.
//!
//! | request | answer | |
//! |---|---|---|
//! | version u8, id u32, [`Command`] | version u8, the same id, [`Answer`] | ids are the client's; an answer to another id is dropped |
//!
//! Version and id stand first in every version, so that a device can tell a client of another version
//! so: [`Refusal::Version`]. Numbers of 8 bits and floats are plain bytes, other integers postcard's
//! varints. New commands and answers are added at the end; any other change is a new version.
//!
//! `PROTOCOL.md` beside this crate is the page for other languages: every number, and examples in
//! hexadecimal, which `tests/session.rs` compares.

use core::fmt;

use serde::{Deserialize, Serialize};
use vantage_core::candidates::{PoolError, ViewSpace};
use vantage_core::planner::{Finish, NextView, Plan, PlanError, SessionError};
use vantage_core::record::SnapshotError;
use vantage_core::soarnet::{ImageError, ModelError, PhotoError, Pixels, SetupError};
use vantage_core::{Pose, PoseError, Quat, Scores, Vec3};

/// The version that is spoken here.
pub const VERSION: u8 = 3;

/// A question or an order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command<'a> {
    /// How things stand. Answered with [`Answer::Status`].
    Status,
    /// Puts a part of a transfer into the buffer, `offset` bytes from its start. [`Answer::Done`].
    Write {
        /// Where, bytes.
        offset: u32,
        /// At most [`CHUNK`](crate::frame::CHUNK).
        bytes: &'a [u8],
    },
    /// Asks for a part of the buffer. [`Answer::Bytes`].
    Read {
        /// From where, bytes.
        offset: u32,
        /// How many, at most [`CHUNK`](crate::frame::CHUNK); fewer come at the end of the buffer.
        length: u16,
    },
    /// Where to stand next. [`Answer::Next`].
    Next,
    /// Writes a snapshot of the session into the buffer. [`Answer::Transfer`].
    Snapshot,
    /// Begins a session in place of another. [`Answer::Done`].
    Open {
        /// The session it takes the place of; 0 for none.
        over: u32,
        /// Its number, not 0: the client's choice, best by chance.
        session: u32,
        /// What it is.
        how: Opening,
    },
    /// Changes the session. [`Answer::Done`].
    Change {
        /// Its number.
        session: u32,
        /// How many changes it has seen.
        revision: u32,
        /// The next one.
        change: Change,
    },
}

/// How a session begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Opening {
    /// With no view taken yet. The plan's centre is the object's middle.
    Plan {
        /// What is asked for.
        plan: Plan,
        /// Where a camera may stand.
        candidates: Candidates,
    },
    /// As a snapshot in the buffer says, which any build of Vantage wrote.
    Snapshot(Transfer),
}

/// Where a camera may stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Candidates {
    /// In a view space: a [`Pool`](vantage_core::candidates::Pool).
    Pool {
        /// Its shape.
        space: ViewSpace,
        /// How many.
        count: u32,
        /// How far from the target, metres.
        radius_m: f32,
        /// What they look at (world, metres).
        target: [f32; 3],
    },
    /// In a list in the buffer: of each the position and the rotation (x, y, z, w) as little-endian
    /// floats, 28 bytes; see [`Posture::to_bytes`].
    Listed(Transfer),
}

/// What the buffer must hold, from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transfer {
    /// Bytes.
    pub length: u32,
    /// Their CRC-32 (ISO-HDLC).
    pub checksum: u32,
}

/// What changes a session.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Change {
    /// A photo was taken.
    Observe {
        /// For which candidate, if for one.
        candidate: Option<u32>,
        /// Where really.
        pose: Posture,
        /// The photo in the buffer; `None` for a network that looks at poses alone.
        photo: Option<PhotoHead>,
    },
    /// A candidate is out of reach.
    Block(u32),
    /// A candidate is within reach again.
    Unblock(u32),
    /// A candidate is passed over until another photo has been taken.
    Skip(u32),
    /// Another plan from here on.
    Replan(Plan),
}

/// A pose as numbers, which may be none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Posture {
    /// The camera's centre in the world, metres.
    pub position: [f32; 3],
    /// `world_from_camera` as a quaternion (x, y, z, w); the camera looks along its -Z.
    pub rotation: [f32; 4],
}

impl Posture {
    /// Bytes of a posture in a list.
    pub const BYTES: usize = 28;

    /// As it stands in a list of candidates.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let numbers = self.position.iter().chain(&self.rotation);
        for (place, number) in bytes.chunks_exact_mut(4).zip(numbers) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    /// The posture of bytes in a list.
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        let mut numbers = [0.0; 7];
        for (number, bytes) in numbers.iter_mut().zip(bytes.as_chunks::<4>().0) {
            *number = f32::from_le_bytes(*bytes);
        }
        let [x, y, z, rotation @ ..] = numbers;
        Self { position: [x, y, z], rotation }
    }

    /// The pose, if the numbers are one.
    pub fn pose(self) -> Result<Pose, PoseError> {
        Pose::try_new(Vec3::from_array(self.position), Quat::from_array(self.rotation))
    }
}

impl From<&Pose> for Posture {
    fn from(pose: &Pose) -> Self {
        Self { position: pose.position().to_array(), rotation: pose.rotation().to_array() }
    }
}

/// A photo in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhotoHead {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// How a pixel lies.
    pub pixels: Pixels,
    /// Row by row from the top, without gaps.
    pub transfer: Transfer,
}

/// What the device says.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer<'a> {
    /// How things stand.
    Status(Status),
    /// It was done, now or when it was asked before; so many changes has the session seen.
    Done {
        /// Changes so far; 0 for a transfer.
        revision: u32,
    },
    /// A part of the buffer.
    Bytes(#[serde(borrow)] &'a [u8]),
    /// What the buffer holds now.
    Transfer(Transfer),
    /// Where to stand next.
    Next(Next),
    /// It was not done, and nothing has changed.
    Refused(Refusal),
}

/// Where to stand next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Next {
    /// At this view.
    View(NextView),
    /// Nowhere: the session is over.
    Finished(Finish),
}

/// How things stand with the device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Its network.
    pub model: Result<Sees, ModelFault>,
    /// What it has room for.
    pub room: Room,
    /// Its session, if it has one.
    pub session: Option<Progress>,
    /// What has come over the line since it was switched on.
    pub line: Traffic,
    /// What is in flash.
    pub kept: Kept,
}

/// What a network is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sees {
    /// The checksum of its file.
    pub checksum: u32,
    /// Whether it looks at photos, not at poses alone.
    pub photos: bool,
}

/// What there is room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Room {
    /// Candidates.
    pub candidates: u32,
    /// Views.
    pub views: u32,
    /// Bytes of a transfer.
    pub transfer: u32,
}

/// How far a session is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Its number.
    pub session: u32,
    /// Changes so far.
    pub revision: u32,
    /// Candidates there are.
    pub candidates: u32,
    /// Views taken.
    pub views: u32,
    /// Views asked for.
    pub budget: u32,
    /// Scores of the views so far, as the network tells them.
    pub scores: Scores,
}

/// What has come over the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Traffic {
    /// Packets, damaged ones too.
    pub packets: u32,
    /// Packets whose checksum was wrong.
    pub damaged: u32,
    /// Requests that were refused.
    pub refused: u32,
}

/// What is in flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kept {
    /// Nothing.
    Nothing,
    /// The session as it stands.
    Session,
    /// The last change could not be written: a reset would undo it.
    Failed,
}

/// Why a device's network cannot be used. [`ModelError`] says more, where the file was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelFault {
    /// The bytes are no model.
    Foreign,
    /// It has another version.
    Version {
        /// The version found; the device needs [`vantage_core::soarnet::VERSION`].
        got: u16,
    },
    /// A byte is missing, added or changed.
    Damaged,
    /// A number in it cannot be.
    Unsound,
}

impl From<ModelError> for ModelFault {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Foreign => Self::Foreign,
            ModelError::Version { got } => Self::Version { got },
            ModelError::Length { .. } | ModelError::Checksum => Self::Damaged,
            _ => Self::Unsound,
        }
    }
}

impl fmt::Display for ModelFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("the device's model is not one: flash it again"),
            Self::Version { got } => write!(
                f,
                "the device's model has version {got}, its firmware needs version {}: flash both \
                 from one release",
                vantage_core::soarnet::VERSION
            ),
            Self::Damaged => f.write_str("the device's model is damaged: flash it again"),
            Self::Unsound => {
                f.write_str("the device's model has a number that cannot be: flash it again")
            }
        }
    }
}

/// Why something was not done. Nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// The client speaks another version.
    Version {
        /// The version the device speaks.
        speaks: u8,
    },
    /// The message is none of this version.
    Malformed,
    /// The device's network cannot be used.
    Model(ModelFault),
    /// There is no session.
    NoSession,
    /// The session is another, or has seen other changes than the client believes.
    Conflict {
        /// The session there is; 0 for none.
        session: u32,
        /// The changes it has seen.
        revision: u32,
    },
    /// A transfer is longer than the buffer.
    TooLong {
        /// Bytes of the buffer.
        room: u32,
    },
    /// The buffer does not hold what the command says: transfer it again.
    Transfer,
    /// A list of candidates is no multiple of 28 bytes long.
    BadList,
    /// The numbers of a view space make no pool.
    Pool(PoolError),
    /// A candidate of a list is no pose.
    Candidate {
        /// Its index.
        index: u32,
        /// Why.
        error: PoseError,
    },
    /// A candidate stands on the centre.
    NoDirection {
        /// Its index.
        index: u32,
    },
    /// The pose is none.
    Pose(PoseError),
    /// The camera stands on the object's centre.
    PoseAtCentre,
    /// The network looks at photos and was given none.
    NoPhoto,
    /// The photo's size, format and length do not agree.
    Photo(ImageError),
    /// The plan, a number of candidates or of views is too large, or there is no such candidate.
    Session(SessionError),
    /// The snapshot cannot be used.
    Snapshot(SnapshotError),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Version { speaks } => write!(
                f,
                "the device speaks version {speaks} of the protocol, this program version {VERSION}"
            ),
            Self::Malformed => f.write_str("the device does not understand the message"),
            Self::Model(fault) => fault.fmt(f),
            Self::NoSession => f.write_str("the device has no session: open one first"),
            Self::Conflict { session: 0, .. } => {
                f.write_str("the device has no session any more: open one again")
            }
            Self::Conflict { session, revision } => write!(
                f,
                "the device is at change {revision} of session {session}, which is not what this \
                 program knows of: ask for its status"
            ),
            Self::TooLong { room } => {
                write!(f, "the device has room for transfers of {room} bytes and needs more")
            }
            Self::Transfer => f.write_str("the transfer is not complete: send it again"),
            Self::BadList => f.write_str("a list of candidates needs 28 bytes for each"),
            Self::Pool(error) => error.fmt(f),
            Self::Candidate { index, error } => write!(f, "candidate {index}: {error}"),
            Self::NoDirection { index } => {
                SetupError::NoDirection { index: *index as usize }.fmt(f)
            }
            Self::Pose(error) => error.fmt(f),
            Self::PoseAtCentre => PhotoError::NoDirection.fmt(f),
            Self::NoPhoto => PhotoError::NoImage.fmt(f),
            Self::Photo(error) => error.fmt(f),
            Self::Session(error) => error.fmt(f),
            Self::Snapshot(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Refusal {}

impl From<SessionError> for Refusal {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}

impl From<PlanError> for Refusal {
    fn from(error: PlanError) -> Self {
        Self::Session(SessionError::Plan(error))
    }
}

impl From<SetupError> for Refusal {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::TooManyCandidates { capacity } => {
                SessionError::TooManyCandidates { capacity }.into()
            }
            SetupError::NoDirection { index } => Self::NoDirection { index: index as u32 },
        }
    }
}

impl From<PhotoError> for Refusal {
    fn from(error: PhotoError) -> Self {
        match error {
            PhotoError::NoImage => Self::NoPhoto,
            PhotoError::Image(error) => Self::Photo(error),
            PhotoError::NoDirection => Self::PoseAtCentre,
            PhotoError::TooManyViews { capacity } => SessionError::TooManyViews { capacity }.into(),
        }
    }
}
