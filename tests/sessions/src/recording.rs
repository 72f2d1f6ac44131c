//! A recorded capture: candidates, and what came of sending the camera to each. The bytes are laid
//! out in `tests/sessions/FORMAT.md`.

use core::fmt;

use vantage_core::planner::{Plan, Stop};
use vantage_core::soarnet::Pixels;
use vantage_core::{Objective, Pose, Quat, Vec3};

/// The first bytes of a recording.
const MAGIC: [u8; 4] = *b"VREC";
/// The version that is written, and the only one that is read.
pub const VERSION: u16 = 1;
/// Bytes before the first entry.
pub const HEADER: usize = 64;
/// Bytes of an entry before its frame.
pub const ENTRY: usize = 64;

/// Why bytes are no recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingError {
    /// They do not begin as one.
    Foreign,
    /// Another version.
    Version {
        /// The version found.
        got: u16,
    },
    /// Bytes are missing or follow after the end.
    Length {
        /// Bytes the header asks for.
        expected: usize,
        /// Bytes there are.
        got: usize,
    },
    /// A number means nothing, or an entry holds no pose.
    Malformed,
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("these bytes are not a recorded capture"),
            Self::Version { got } => {
                write!(f, "the recording has version {got}, {VERSION} is needed: record it anew")
            }
            Self::Length { expected, got } => {
                write!(f, "the recording has {got} bytes instead of {expected}")
            }
            Self::Malformed => f.write_str("the recording holds a number that means nothing"),
        }
    }
}

impl core::error::Error for RecordingError {}

/// How views are chosen: the numbers that the header and the C interface know.
pub const SCHEMES: [fn(usize) -> Plan; 9] = [
    Plan::ensemble,
    Plan::sum,
    |budget| Plan::single(Objective::Coverage, budget),
    |budget| Plan::single(Objective::Geometry, budget),
    |budget| Plan::single(Objective::Diversity, budget),
    |budget| Plan::single(Objective::Texture, budget),
    Plan::farthest_point,
    Plan::random,
    Plan::support,
];

/// How pixels lie in memory: the numbers that the header and the C interface know.
pub const PIXELS: [Pixels; 3] = [Pixels::Rgb565, Pixels::Rgb888, Pixels::Luma8];

/// What the header says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// How many candidates there are.
    pub candidates: u16,
    /// Width of the frames, pixels.
    pub width: u16,
    /// Height of the frames, pixels.
    pub height: u16,
    /// How their pixels lie in memory.
    pub pixels: Pixels,
    /// Index into [`SCHEMES`].
    pub scheme: u8,
    /// Views asked for.
    pub budget: u16,
    /// Of the plan.
    pub seed: u64,
    /// Of the plan, in [0, 1].
    pub movement_cost: f32,
    /// The stop rule's gain and patience; patience 0 for no rule.
    pub stop: Stop,
    /// After so many photos the session is saved, dropped and restored.
    pub snapshot_after: u16,
    /// The object's middle, in the world, metres.
    pub centre: Vec3,
}

/// What comes of sending the camera to a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mishap {
    /// A photo.
    None,
    /// It cannot get there.
    Blocked,
    /// No photo at the first attempt, one at the second.
    Missed,
    /// A photo of another place; the candidate itself cannot be reached.
    Elsewhere,
}

impl Mishap {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::None, Self::Blocked, Self::Missed, Self::Elsewhere];
}

/// A candidate and what came of it.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    /// What comes of sending the camera there.
    pub mishap: Mishap,
    /// Where it was sent.
    pub candidate: Pose,
    /// Where it got to.
    pub reached: Pose,
    /// What it saw there, shape (height, width) of pixels.
    pub frame: &'a [u8],
}

/// A recording in the caller's memory, such as in flash.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    header: Header,
    entries: &'a [u8],
}

impl Header {
    /// Bytes of an entry with its frame; `None` where they are more than any memory has.
    fn entry(&self) -> Option<usize> {
        let pixels = usize::from(self.width).checked_mul(self.height.into())?;
        pixels.checked_mul(self.pixels.bytes())?.checked_add(ENTRY)
    }

    /// The plan that was recorded.
    pub fn plan(&self) -> Option<Plan> {
        let plan = SCHEMES.get(usize::from(self.scheme))?(usize::from(self.budget))
            .with_seed(self.seed)
            .with_movement_cost(self.movement_cost)
            .with_centre(self.centre);
        Some(if self.stop.patience > 0 { plan.with_stop(self.stop) } else { plan })
    }

    /// The header's bytes.
    pub fn to_bytes(self) -> [u8; HEADER] {
        let mut bytes = [0; HEADER];
        let [x, y, z] = self.centre.to_array().map(f32::to_le_bytes);
        let fields: [&[u8]; 15] = [
            &MAGIC,
            &VERSION.to_le_bytes(),
            &self.candidates.to_le_bytes(),
            &self.width.to_le_bytes(),
            &self.height.to_le_bytes(),
            &[number_of(&PIXELS, &self.pixels), self.scheme],
            &self.budget.to_le_bytes(),
            &self.seed.to_le_bytes(),
            &self.movement_cost.to_le_bytes(),
            &self.stop.gain.to_le_bytes(),
            &self.stop.patience.to_le_bytes(),
            &self.snapshot_after.to_le_bytes(),
            &x,
            &y,
            &z,
        ];
        for (place, byte) in bytes.iter_mut().zip(fields.into_iter().flatten()) {
            *place = *byte;
        }
        bytes
    }

    fn from_bytes(bytes: &[u8; HEADER]) -> Result<Self, RecordingError> {
        let mut rest = Reader(bytes);
        if rest.take()? != MAGIC {
            return Err(RecordingError::Foreign);
        }
        let got = u16::from_le_bytes(rest.take()?);
        if got != VERSION {
            return Err(RecordingError::Version { got });
        }
        Ok(Self {
            candidates: u16::from_le_bytes(rest.take()?),
            width: u16::from_le_bytes(rest.take()?),
            height: u16::from_le_bytes(rest.take()?),
            pixels: rest.one_of(&PIXELS)?,
            scheme: u8::from_le_bytes(rest.take()?),
            budget: u16::from_le_bytes(rest.take()?),
            seed: u64::from_le_bytes(rest.take()?),
            movement_cost: f32::from_le_bytes(rest.take()?),
            stop: Stop {
                gain: f32::from_le_bytes(rest.take()?),
                patience: u16::from_le_bytes(rest.take()?),
            },
            snapshot_after: u16::from_le_bytes(rest.take()?),
            centre: rest.vector()?,
        })
    }
}

impl Entry<'_> {
    /// The entry's bytes before its frame.
    pub fn to_bytes(self) -> [u8; ENTRY] {
        let mut bytes = [0; ENTRY];
        let poses = [self.candidate, self.reached].into_iter().flat_map(|pose| {
            let (position, rotation) = (pose.position().to_array(), pose.rotation().to_array());
            position.into_iter().chain(rotation).flat_map(f32::to_le_bytes)
        });
        let fields = [number_of(&Mishap::ALL, &self.mishap), 0, 0, 0].into_iter().chain(poses);
        for (place, byte) in bytes.iter_mut().zip(fields) {
            *place = byte;
        }
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Result<Entry<'_>, RecordingError> {
        let mut rest = Reader(bytes);
        let mishap = rest.one_of(&Mishap::ALL)?;
        let [_, _, _] = rest.take()?;
        let (candidate, reached) = (rest.pose()?, rest.pose()?);
        let [_, _, _, _] = rest.take()?;
        Ok(Entry { mishap, candidate, reached, frame: rest.0 })
    }
}

impl<'a> Recording<'a> {
    /// Checks the bytes of a recording.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, RecordingError> {
        let (header, entries) =
            bytes.split_first_chunk::<HEADER>().ok_or(RecordingError::Foreign)?;
        let header = Header::from_bytes(header)?;
        let entry = header.entry().ok_or(RecordingError::Malformed)?;
        let expected = entry.saturating_mul(header.candidates.into());
        if entries.len() != expected {
            let expected = expected.saturating_add(HEADER);
            return Err(RecordingError::Length { expected, got: bytes.len() });
        }
        if header.plan().is_none() {
            return Err(RecordingError::Malformed);
        }
        let recording = Self { header, entries };
        let count = usize::from(header.candidates);
        if (0..count).any(|index| recording.entry(index).is_none()) {
            return Err(RecordingError::Malformed);
        }
        Ok(recording)
    }

    /// What it says of the whole.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// What came of a candidate; `None` where there is no such candidate.
    pub fn entry(&self, index: usize) -> Option<Entry<'a>> {
        let size = self.header.entry()?;
        let from = index.checked_mul(size)?;
        Entry::from_bytes(self.entries.get(from..from.checked_add(size)?)?).ok()
    }

    /// The candidates, in order.
    pub fn candidates(&self) -> impl Iterator<Item = Pose> + 'a {
        let recording = *self;
        (0..usize::from(self.header.candidates))
            .filter_map(move |index| Some(recording.entry(index)?.candidate))
    }
}

/// The number of a value in the list of its kind.
fn number_of<T: PartialEq>(all: &[T], value: &T) -> u8 {
    all.iter().position(|one| one == value).unwrap_or_default() as u8
}

/// Bytes that have not been read yet.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], RecordingError> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(RecordingError::Malformed)?;
        self.0 = rest;
        Ok(*bytes)
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> Result<T, RecordingError> {
        let [number] = self.take()?;
        all.get(usize::from(number)).copied().ok_or(RecordingError::Malformed)
    }

    fn vector(&mut self) -> Result<Vec3, RecordingError> {
        let (x, y, z) = (self.take()?, self.take()?, self.take()?);
        Ok(Vec3::from_array([x, y, z].map(f32::from_le_bytes)))
    }

    fn pose(&mut self) -> Result<Pose, RecordingError> {
        let position = self.vector()?;
        let (x, y, z, w) = (self.take()?, self.take()?, self.take()?, self.take()?);
        let rotation = Quat::from_array([x, y, z, w].map(f32::from_le_bytes));
        Pose::try_new(position, rotation).map_err(|_| RecordingError::Malformed)
    }
}
