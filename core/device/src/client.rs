//! The host's side: asks, and asks again where the line was silent.

use core::fmt;

use vantage_core::Pose;
use vantage_core::planner::Plan;
use vantage_core::soarnet::Pixels;

use crate::frame::{self, CHUNK, CRC, PACKET, Packet, Reader};
use crate::message::{
    Answer, Candidates, Change, Command, Next, Opening, PhotoHead, Posture, Refusal, Status,
    Transfer, VERSION,
};

/// A line of bytes to a device.
pub trait Line {
    /// Why the line is of no use any more.
    type Error;
    /// Sends bytes.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;
    /// The next byte; `None` where none has come for as long as an answer may take.
    fn receive(&mut self) -> Result<Option<u8>, Self::Error>;
}

/// A photo as it lies in the host's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// How a pixel lies.
    pub pixels: Pixels,
    /// Row by row from the top, without gaps.
    pub bytes: &'a [u8],
}

/// Why something could not be asked or was not done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClientError<E> {
    /// The line is of no use any more.
    Line(E),
    /// The device does not answer.
    Silent {
        /// How often it was asked.
        attempts: u32,
    },
    /// The device refused.
    Refused(Refusal),
    /// The device answered something else than what was asked.
    Unexpected,
    /// The message is too long, or the buffer for what was asked too short.
    NoRoom,
}

impl<E: fmt::Display> fmt::Display for ClientError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(error) => error.fmt(f),
            Self::Silent { attempts } => write!(
                f,
                "the device has not answered after {attempts} attempts: check the port, its speed \
                 and the firmware"
            ),
            Self::Refused(refusal) => refusal.fmt(f),
            Self::Unexpected => f.write_str("the device answered something that was not asked"),
            Self::NoRoom => f.write_str("there is no room for the message or its answer"),
        }
    }
}

impl<E: core::error::Error> core::error::Error for ClientError<E> {}

/// A conversation with a device.
#[derive(Debug)]
pub struct Client<L> {
    line: L,
    reader: Reader,
    id: u32,
    attempts: u32,
    session: u32, // that this client opened or found
    revision: u32,
}

/// How often a silent device is asked.
const ATTEMPTS: u32 = 8;

impl<L: Line> Client<L> {
    /// A conversation over a line. `id` is the number of its first request: take one by chance, so
    /// that a late answer to somebody else is not taken for one's own.
    pub fn new(line: L, id: u32) -> Self {
        Self { line, reader: Reader::new(), id, attempts: ATTEMPTS, session: 0, revision: 0 }
    }

    /// The same, asking a silent device so often.
    pub fn with_attempts(self, attempts: u32) -> Self {
        Self { attempts, ..self }
    }

    /// The line.
    pub fn line_mut(&mut self) -> &mut L {
        &mut self.line
    }

    /// Sends a command until it is answered; `take` reads the answer, which may borrow.
    pub fn ask<T>(
        &mut self,
        command: &Command<'_>,
        take: impl FnOnce(&Answer<'_>) -> Option<T>,
    ) -> Result<T, ClientError<L::Error>> {
        self.id = self.id.wrapping_add(1);
        let Self { line, reader, id, attempts, .. } = self;
        let mut out = [0; PACKET];
        let packet = frame::write(&(VERSION, *id, command), &mut out).ok_or(ClientError::NoRoom)?;
        for _ in 0..*attempts {
            line.send(packet).map_err(ClientError::Line)?;
            while let Some(byte) = line.receive().map_err(ClientError::Line)? {
                let Some(Packet::Message(message)) = reader.push(byte) else { continue };
                let Ok(((_, answered), rest)) = postcard::take_from_bytes::<(u8, u32)>(message)
                else {
                    continue;
                };
                if answered != *id {
                    continue;
                }
                let answer: Answer<'_> =
                    postcard::from_bytes(rest).map_err(|_| ClientError::Unexpected)?;
                if let Answer::Refused(refusal) = answer {
                    return Err(ClientError::Refused(refusal));
                }
                return take(&answer).ok_or(ClientError::Unexpected);
            }
        }
        Err(ClientError::Silent { attempts: *attempts })
    }

    /// How things stand. The device's session becomes this client's.
    pub fn status(&mut self) -> Result<Status, ClientError<L::Error>> {
        let status = self.ask(&Command::Status, |answer| match answer {
            Answer::Status(status) => Some(*status),
            _ => None,
        })?;
        let (session, revision) =
            status.session.map_or((0, 0), |progress| (progress.session, progress.revision));
        (self.session, self.revision) = (session, revision);
        Ok(status)
    }

    /// Begins a session of a number, which must not be 0, in place of the device's.
    pub fn open(
        &mut self,
        session: u32,
        plan: Plan,
        candidates: Candidates,
    ) -> Result<(), ClientError<L::Error>> {
        self.status()?;
        self.begin(session, Opening::Plan { plan, candidates })
    }

    /// The same with candidates that lie in no view space.
    pub fn open_listed(
        &mut self,
        session: u32,
        plan: Plan,
        candidates: &[Pose],
    ) -> Result<(), ClientError<L::Error>> {
        self.status()?;
        let bytes = |index: usize| {
            let pose = candidates.get(index / Posture::BYTES)?;
            Posture::from(pose).to_bytes().get(index % Posture::BYTES).copied()
        };
        let length = candidates.len() * Posture::BYTES;
        self.with_transfer(length, bytes, |client, transfer| {
            let candidates = Candidates::Listed(transfer);
            client.begin(session, Opening::Plan { plan, candidates })
        })
    }

    /// Begins a session as a snapshot says, in place of the device's.
    pub fn restore(&mut self, session: u32, snapshot: &[u8]) -> Result<(), ClientError<L::Error>> {
        self.status()?;
        let bytes = |index: usize| snapshot.get(index).copied();
        self.with_transfer(snapshot.len(), bytes, |client, transfer| {
            client.begin(session, Opening::Snapshot(transfer))
        })
    }

    fn begin(&mut self, session: u32, how: Opening) -> Result<(), ClientError<L::Error>> {
        let command = Command::Open { over: self.session, session, how };
        self.revision = self.ask(&command, done)?;
        self.session = session;
        Ok(())
    }

    /// Where to stand next.
    pub fn next_view(&mut self) -> Result<Next, ClientError<L::Error>> {
        self.ask(&Command::Next, |answer| match answer {
            Answer::Next(next) => Some(*next),
            _ => None,
        })
    }

    /// Hands over a photo, of a candidate if of one, with the pose that was really reached.
    pub fn observe(
        &mut self,
        candidate: Option<usize>,
        pose: &Pose,
        frame: Option<Frame<'_>>,
    ) -> Result<(), ClientError<L::Error>> {
        let candidate = candidate.map(|index| index as u32);
        let pose = Posture::from(pose);
        let Some(Frame { width, height, pixels, bytes }) = frame else {
            return self.change(Change::Observe { candidate, pose, photo: None });
        };
        let byte = |index: usize| bytes.get(index).copied();
        self.with_transfer(bytes.len(), byte, |client, transfer| {
            let photo = Some(PhotoHead { width, height, pixels, transfer });
            client.change(Change::Observe { candidate, pose, photo })
        })
    }

    /// Changes the session.
    pub fn change(&mut self, change: Change) -> Result<(), ClientError<L::Error>> {
        let command = Command::Change { session: self.session, revision: self.revision, change };
        self.revision = self.ask(&command, done)?;
        Ok(())
    }

    /// Reads a snapshot of the session into a buffer; gives its length.
    pub fn snapshot(&mut self, buffer: &mut [u8]) -> Result<usize, ClientError<L::Error>> {
        for _ in 0..self.attempts {
            let transfer = self.ask(&Command::Snapshot, |answer| match answer {
                Answer::Transfer(transfer) => Some(*transfer),
                _ => None,
            })?;
            let length = transfer.length as usize;
            let bytes = buffer.get_mut(..length).ok_or(ClientError::NoRoom)?;
            for (part, place) in bytes.chunks_mut(CHUNK).enumerate() {
                let offset = (part * CHUNK) as u32;
                let command = Command::Read { offset, length: place.len() as u16 };
                self.ask(&command, |answer| match answer {
                    Answer::Bytes(bytes) if bytes.len() == place.len() => {
                        place.copy_from_slice(bytes);
                        Some(())
                    }
                    _ => None,
                })?;
            }
            // Otherwise the device was reset on the way.
            if CRC.checksum(bytes) == transfer.checksum {
                return Ok(length);
            }
        }
        Err(ClientError::Silent { attempts: self.attempts })
    }

    /// Transfers bytes and then does what needs them, again where the device lost them on the way.
    fn with_transfer(
        &mut self,
        length: usize,
        byte: impl Fn(usize) -> Option<u8>,
        mut use_it: impl FnMut(&mut Self, Transfer) -> Result<(), ClientError<L::Error>>,
    ) -> Result<(), ClientError<L::Error>> {
        let mut digest = CRC.digest();
        let mut part = [0; CHUNK];
        for attempt in 0..=self.attempts {
            for from in (0..length).step_by(CHUNK) {
                let part = part.get_mut(..CHUNK.min(length - from)).unwrap_or_default();
                for (index, place) in part.iter_mut().enumerate() {
                    *place = byte(from + index).unwrap_or_default();
                }
                if attempt == 0 {
                    digest.update(part);
                }
                self.ask(&Command::Write { offset: from as u32, bytes: part }, done)?;
            }
            let checksum = digest.clone().finalize();
            let transfer = Transfer { length: length as u32, checksum };
            match use_it(self, transfer) {
                Err(ClientError::Refused(Refusal::Transfer)) => {}
                result => return result,
            }
        }
        Err(ClientError::Silent { attempts: self.attempts })
    }
}

fn done(answer: &Answer<'_>) -> Option<u32> {
    match answer {
        Answer::Done { revision } => Some(*revision),
        _ => None,
    }
}
