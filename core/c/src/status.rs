//! What a call returns, and how the core's refusals become that.

use core::ffi::{CStr, c_char};

use vantage_core::PoseError;
use vantage_core::candidates::PoolError;
use vantage_core::planner::{ObserveError, PlanError, SessionError};
use vantage_core::record::SnapshotError;
use vantage_core::soarnet::{ImageError, ModelError, PhotoError, SetupError};

/// What became of a call. After anything but `VANTAGE_STATUS_OK` and `VANTAGE_STATUS_DONE` nothing has
/// changed, but where a session was to be made or restored: its memory may then be used anew.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It did what it says.
    Ok = 0,
    /// There is no next view: see `vantage_finish`.
    Done = 1,
    /// A pointer is null.
    NullPointer = 2,
    /// The pointer does not lead to a session.
    NotASession = 3,
    /// A pointer is not aligned as its type asks, or the memory not to `VANTAGE_SESSION_ALIGN`.
    Misaligned = 4,
    /// The memory is smaller than `vantage_session_size` says.
    MemoryTooSmall = 5,
    /// A number means nothing: a scheme, a format, a view space, a length beyond all memory.
    BadNumber = 6,
    /// The bytes are no model, or a damaged one.
    BadModel = 7,
    /// The model was written in another version.
    OtherModelVersion = 8,
    /// A coordinate is not finite, or the rotation no rotation.
    BadPose = 9,
    /// The view space's radius, elevations, rings, turns or target make no candidates.
    BadPool = 10,
    /// The plan cannot be carried out: budget, movement cost, stop rule or centre.
    BadPlan = 11,
    /// A candidate or a camera stands on the object's centre.
    OnTheCentre = 12,
    /// The photo's bytes are not as many as width, height and format ask for, it has no pixels, or its
    /// window is too large.
    BadPhoto = 13,
    /// The model looks at photos and was given none.
    NoPhoto = 14,
    /// There is no candidate of this index.
    UnknownCandidate = 15,
    /// There is no room for so many candidates.
    TooManyCandidates = 16,
    /// There is no room for so many views.
    TooManyViews = 17,
    /// The buffer is too small for the snapshot.
    NoRoom = 18,
    /// The bytes are no snapshot, or a damaged one.
    BadSnapshot = 19,
    /// The snapshot was written in another version.
    OtherSnapshotVersion = 20,
    /// The snapshot is of a session with another model.
    OtherModel = 21,
}

impl Status {
    const TEXTS: [&'static CStr; 22] = [
        c"ok",
        c"there is no next view",
        c"a pointer is null",
        c"the pointer does not lead to a session",
        c"a pointer is not aligned",
        c"the memory is smaller than vantage_session_size says",
        c"a number means nothing here",
        c"the bytes are no model, or a damaged one",
        c"the model was written in another version",
        c"the pose is not finite or its rotation is none",
        c"these numbers make no view space",
        c"the plan cannot be carried out",
        c"a camera stands on the object's centre",
        c"the photo's bytes do not fit its width, height and format",
        c"the model looks at photos: give it one",
        c"there is no such candidate",
        c"there is no room for so many candidates",
        c"there is no room for so many views",
        c"the buffer is too small for the snapshot",
        c"the bytes are no snapshot, or a damaged one",
        c"the snapshot was written in another version",
        c"the snapshot is of a session with another model",
    ];

    /// The status of a call that either did what it says or did not.
    pub fn of(result: Result<(), Self>) -> Self {
        result.err().unwrap_or(Self::Ok)
    }
}

/// One sentence for a status; never null, also for numbers that are none.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn vantage_status_text(status: u32) -> *const c_char {
    Status::TEXTS.get(status as usize).unwrap_or(&c"this status is none").as_ptr()
}

impl From<PoseError> for Status {
    fn from(_: PoseError) -> Self {
        Self::BadPose
    }
}

impl From<PoolError> for Status {
    fn from(_: PoolError) -> Self {
        Self::BadPool
    }
}

impl From<PlanError> for Status {
    fn from(_: PlanError) -> Self {
        Self::BadPlan
    }
}

impl From<ModelError> for Status {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Version { .. } => Self::OtherModelVersion,
            _ => Self::BadModel,
        }
    }
}

impl From<SetupError> for Status {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::TooManyCandidates { .. } => Self::TooManyCandidates,
            SetupError::NoDirection { .. } => Self::OnTheCentre,
        }
    }
}

impl From<SessionError> for Status {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Plan(error) => error.into(),
            SessionError::TooManyCandidates { .. } => Self::TooManyCandidates,
            SessionError::TooManyViews { .. } => Self::TooManyViews,
            SessionError::UnknownCandidate { .. } => Self::UnknownCandidate,
        }
    }
}

impl From<ImageError> for Status {
    fn from(_: ImageError) -> Self {
        Self::BadPhoto
    }
}

impl From<ObserveError<PhotoError>> for Status {
    fn from(error: ObserveError<PhotoError>) -> Self {
        match error {
            ObserveError::Session(error) => error.into(),
            ObserveError::Scorer(PhotoError::NoImage) => Self::NoPhoto,
            ObserveError::Scorer(PhotoError::Image(error)) => error.into(),
            ObserveError::Scorer(PhotoError::NoDirection) => Self::OnTheCentre,
            ObserveError::Scorer(PhotoError::TooManyViews { .. }) => Self::TooManyViews,
        }
    }
}

impl From<SnapshotError> for Status {
    fn from(error: SnapshotError) -> Self {
        match error {
            SnapshotError::NoRoom => Self::NoRoom,
            SnapshotError::Version { .. } => Self::OtherSnapshotVersion,
            SnapshotError::OtherScorer => Self::OtherModel,
            SnapshotError::TooLarge => Self::TooManyViews,
            SnapshotError::Foreign
            | SnapshotError::Length { .. }
            | SnapshotError::Checksum
            | SnapshotError::Malformed => Self::BadSnapshot,
        }
    }
}
