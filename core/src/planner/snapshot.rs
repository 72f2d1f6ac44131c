//! A session as bytes, to survive a power loss or a reload: versioned, checksummed, and refused
//! with a reason where they do not fit.
//!
//! | bytes | what |
//! |---|---|
//! | 0 .. 4 | `VNTG` |
//! | 4 .. 6 | version, u16 little-endian: [`VERSION`](crate::record::VERSION) |
//! | 6 .. 10 | length of the payload in bytes, u32 little-endian |
//! | 10 .. n | payload: records in [postcard](https://postcard.jamesmunns.com) encoding |
//! | n .. n + 4 | CRC-32 (ISO-HDLC) of everything before it, u32 little-endian |
//!
//! The payload holds the plan, the number of choices settled, the candidates' poses and status, the
//! views, and what the scorer adds. Distances, gains and the view that is due are not kept: they
//! follow from the rest.
//!
//! The snapshot of a new session, `Plan::random(1)` over one candidate at (1, 2, 3) with the
//! [`Blind`] scorer, is these 79 bytes (`core/tests/snapshot.rs` compares them):
//!
//! ```text
//! 56 4e 54 47                          magic
//! 03 00                                version 3
//! 41 00 00 00                          65 bytes of payload
//! 00 01 01 00 00                       plan: Random, budget 1, FarthestPoint, 0 start views, seed 0
//! 00 00 00 00  00 00 00 00  00 00 00 00   movement cost, dispersion, opposite: 0.0
//! 00                                   no stop rule
//! 00 00 00 00  00 00 00 00  00 00 00 00   centre (0, 0, 0)
//! 00 00 00 01 00 00                    0 settled, 0 weak, scorer 0, 1 candidate, 0 views, none due
//! 00 00 80 3f  00 00 00 40  00 00 40 40   position (1, 2, 3)
//! 00 00 00 00  00 00 00 00  00 00 00 00  00 00 80 3f   rotation (0, 0, 0, 1)
//! 00                                   Available
//! df 91 c9 a4                          CRC-32
//! ```

use serde::{Deserialize, Serialize};

use super::memory::{Candidate, Memory, Status, View};
use super::plan::Plan;
use super::scorer::{Blind, Scorer};
use super::session::Session;
use crate::checksum::CRC;
use crate::pose::Pose;
use crate::record::{Sink, SnapshotError, Source, VERSION};

const MAGIC: [u8; 4] = *b"VNTG";
const HEADER: usize = 10;
const CHECKSUM: usize = 4;

/// A scorer whose state can be kept in a snapshot.
pub trait Persist: Scorer {
    /// Tells scorers apart whose state must not be mixed: another mesh, model or reading.
    fn fingerprint(&self) -> u32;
    /// Writes the state.
    fn save(&self, sink: &mut Sink<'_>) -> Result<(), SnapshotError>;
    /// Takes on a state that [`save`](Self::save) wrote; after an error the scorer is of no use.
    fn load(&mut self, source: &mut Source<'_>) -> Result<(), SnapshotError>;
}

impl<S: Persist + ?Sized> Persist for &mut S {
    fn fingerprint(&self) -> u32 {
        (**self).fingerprint()
    }

    fn save(&self, sink: &mut Sink<'_>) -> Result<(), SnapshotError> {
        (**self).save(sink)
    }

    fn load(&mut self, source: &mut Source<'_>) -> Result<(), SnapshotError> {
        (**self).load(source)
    }
}

impl Persist for Blind {
    fn fingerprint(&self) -> u32 {
        0
    }

    fn save(&self, _sink: &mut Sink<'_>) -> Result<(), SnapshotError> {
        Ok(())
    }

    fn load(&mut self, _source: &mut Source<'_>) -> Result<(), SnapshotError> {
        Ok(())
    }
}

/// The first record of the payload.
#[derive(Serialize, Deserialize)]
struct Head {
    plan: Plan,
    draws: u64,
    weak: u16,
    scorer: u32,
    candidates: usize,
    views: usize,
    pending: bool, // a view was chosen and not yet settled
}

impl<S: Persist, M: Memory> Session<S, M> {
    /// Writes the session into a buffer and gives the number of bytes used.
    pub fn snapshot(&self, buffer: &mut [u8]) -> Result<usize, SnapshotError> {
        let payload = buffer.get_mut(HEADER..).ok_or(SnapshotError::NoRoom)?;
        let mut sink = Sink { buffer: payload, used: 0 };
        sink.put(&Head {
            plan: self.plan,
            draws: self.draws,
            weak: self.weak,
            scorer: self.scorer.fingerprint(),
            candidates: self.memory.candidates().len(),
            views: self.memory.views().len(),
            pending: self.pending.is_some(),
        })?;
        for candidate in self.memory.candidates() {
            sink.put(&(candidate.pose(), candidate.status()))?;
        }
        for view in self.memory.views() {
            sink.put(view)?;
        }
        self.scorer.save(&mut sink)?;

        let used = sink.used;
        let length = u32::try_from(used).map_err(|_| SnapshotError::NoRoom)?;
        let header = MAGIC.into_iter().chain(VERSION.to_le_bytes()).chain(length.to_le_bytes());
        for (byte, value) in buffer.iter_mut().zip(header) {
            *byte = value;
        }
        let (written, rest) =
            buffer.split_at_mut_checked(HEADER + used).ok_or(SnapshotError::NoRoom)?;
        let place = rest.first_chunk_mut::<CHECKSUM>().ok_or(SnapshotError::NoRoom)?;
        *place = CRC.checksum(written).to_le_bytes();
        Ok(HEADER + used + CHECKSUM)
    }

    /// A session as it stood when its snapshot was written; it goes on to the same plan.
    ///
    /// `memory` is cleared first. `scorer` must be one over the same mesh or model, before any photo.
    pub fn restore(mut memory: M, mut scorer: S, bytes: &[u8]) -> Result<Self, SnapshotError> {
        memory.clear();
        let mut source = Source { rest: payload(bytes)? };
        let head: Head = source.take()?;
        if head.scorer != scorer.fingerprint() {
            return Err(SnapshotError::OtherScorer);
        }
        for _ in 0..head.candidates {
            let (pose, status): (Pose, Status) = source.take()?;
            let mut candidate = Candidate::new(pose);
            candidate.status = status;
            memory.push_candidate(candidate).map_err(|_| SnapshotError::TooLarge)?;
        }
        for _ in 0..head.views {
            let view: View = source.take()?;
            if view.candidate.is_some_and(|index| index >= head.candidates) {
                return Err(SnapshotError::Malformed);
            }
            for candidate in memory.candidates_mut() {
                candidate.see(view.pose.position(), head.plan.centre);
            }
            memory.push_view(view).map_err(|_| SnapshotError::TooLarge)?;
        }
        head.plan.check(head.candidates).map_err(|_| SnapshotError::Malformed)?;
        if head.plan.budget > memory.view_capacity() {
            return Err(SnapshotError::TooLarge);
        }
        scorer.load(&mut source)?;
        if !source.rest.is_empty() {
            return Err(SnapshotError::Malformed);
        }
        let mut session = Self::from_parts(memory, scorer, head.plan, head.draws, head.weak);
        if head.pending {
            // The same choice again: it follows from what has just been read.
            session.pending = session.choose();
        }
        Ok(session)
    }
}

/// What a snapshot holds, for the scorer that [`Session::restore`] needs.
///
/// ```
/// # use vantage_core::planner::{Blind, Contents, Fixed, Plan, Session};
/// # use vantage_core::{Pose, Vec3};
/// # let pose = Pose::looking_at(Vec3::X, Vec3::ZERO)?;
/// # let session = Session::try_new(Fixed::<4, 4>::default(), [pose], Blind, Plan::random(1))?;
/// let mut bytes = [0; 128];
/// let used = session.snapshot(&mut bytes)?;
/// let contents = Contents::parse(&bytes[..used])?;
/// assert_eq!(contents.plan().centre(), Vec3::ZERO);
/// assert!(contents.candidates().eq([pose]));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Contents<'a> {
    plan: Plan,
    scorer: u32,
    candidates: usize,
    records: &'a [u8], // of the candidates and what follows
}

impl<'a> Contents<'a> {
    /// Checks the frame and the first record; what follows is checked by [`Session::restore`].
    pub fn parse(bytes: &'a [u8]) -> Result<Self, SnapshotError> {
        let mut source = Source { rest: payload(bytes)? };
        let Head { plan, scorer, candidates, .. } = source.take()?;
        Ok(Self { plan, scorer, candidates, records: source.rest })
    }

    /// The plan that was being carried out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The scorer's [`Persist::fingerprint`].
    pub fn fingerprint(&self) -> u32 {
        self.scorer
    }

    /// The candidates' poses, in order; fewer where the records are malformed.
    pub fn candidates(&self) -> impl Iterator<Item = Pose> + use<'a> {
        let mut source = Source { rest: self.records };
        (0..self.candidates)
            .map_while(move |_| source.take::<(Pose, Status)>().ok().map(|(pose, _)| pose))
    }
}

/// The payload, once magic, version, length and checksum are found right.
fn payload(bytes: &[u8]) -> Result<&[u8], SnapshotError> {
    let (magic, rest) = bytes.split_first_chunk::<4>().ok_or(SnapshotError::Foreign)?;
    if *magic != MAGIC {
        return Err(SnapshotError::Foreign);
    }
    let short = SnapshotError::Length { expected: HEADER + CHECKSUM, got: bytes.len() };
    let (version, rest) = rest.split_first_chunk::<2>().ok_or(short)?;
    let got = u16::from_le_bytes(*version);
    if got != VERSION {
        return Err(SnapshotError::Version { got });
    }
    let (length, rest) = rest.split_first_chunk::<4>().ok_or(short)?;
    let length = u32::from_le_bytes(*length) as usize;
    let expected = length.saturating_add(HEADER + CHECKSUM);
    if expected != bytes.len() {
        return Err(SnapshotError::Length { expected, got: bytes.len() });
    }
    let (covered, checksum) = bytes.split_last_chunk::<CHECKSUM>().ok_or(short)?;
    if CRC.checksum(covered) != u32::from_le_bytes(*checksum) {
        return Err(SnapshotError::Checksum);
    }
    rest.get(..length).ok_or(short)
}
