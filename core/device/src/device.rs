//! The device's side: bytes in, bytes out. It never waits and knows no line.

use core::cell::{RefCell, RefMut};
use core::ops::{Deref, DerefMut};

use embedded_storage::nor_flash::NorFlash;
use vantage_core::candidates::Pool;
use vantage_core::planner::{
    self, Candidate, Contents, ObserveError, Plan, Session, SessionError, View,
};
use vantage_core::record::SnapshotError;
use vantage_core::soarnet::{self, Image, Lists, ListsMut, Model, Photo, SoarNet, features};
use vantage_core::{Pose, Vec3};

use crate::frame::{self, CHUNK, CRC, PACKET, Packet, Reader};
use crate::message::{
    Answer, Candidates, Change, Command, Kept, ModelFault, Next, Opening, PhotoHead, Posture,
    Progress, Refusal, Room, Sees, Status, Traffic, Transfer, VERSION,
};
use crate::store::Store;

/// All memory that a device's session needs: room for candidates and views, and for transfers of
/// `BUFFER` bytes, which must hold a photo, or the snapshot of a full session: about 500 bytes a view
/// and 30 a candidate. Zeros, which cost no flash in a `static`.
#[derive(Debug)]
pub struct Memory<const CANDIDATES: usize, const VIEWS: usize, const BUFFER: usize> {
    network: RefCell<soarnet::Fixed<CANDIDATES, VIEWS>>,
    lists: RefCell<planner::Fixed<CANDIDATES, VIEWS>>,
    buffer: RefCell<[u8; BUFFER]>,
}

impl<const CANDIDATES: usize, const VIEWS: usize, const BUFFER: usize>
    Memory<CANDIDATES, VIEWS, BUFFER>
{
    /// Empty memory.
    pub const fn new() -> Self {
        Self {
            network: RefCell::new(soarnet::Fixed::new()),
            lists: RefCell::new(planner::Fixed::new()),
            buffer: RefCell::new([0; BUFFER]),
        }
    }
}

impl<const CANDIDATES: usize, const VIEWS: usize, const BUFFER: usize> Default
    for Memory<CANDIDATES, VIEWS, BUFFER>
{
    fn default() -> Self {
        Self::new()
    }
}

/// Memory that comes back when its session ends, whether that succeeded or not.
#[derive(Debug)]
struct Lent<'a, T>(RefMut<'a, T>);

impl<T: soarnet::Memory> soarnet::Memory for Lent<'_, T> {
    fn lists(&self) -> Lists<'_> {
        self.0.deref().lists()
    }

    fn lists_mut(&mut self) -> ListsMut<'_> {
        self.0.deref_mut().lists_mut()
    }
}

impl<T: planner::Memory> planner::Memory for Lent<'_, T> {
    fn candidates(&self) -> &[Candidate] {
        self.0.candidates()
    }

    fn candidates_mut(&mut self) -> &mut [Candidate] {
        self.0.candidates_mut()
    }

    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate> {
        self.0.push_candidate(candidate)
    }

    fn views(&self) -> &[View] {
        self.0.views()
    }

    fn push_view(&mut self, view: View) -> Result<(), View> {
        self.0.push_view(view)
    }

    fn view_capacity(&self) -> usize {
        self.0.view_capacity()
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}

type Network<'a, const C: usize, const V: usize> = SoarNet<'a, Lent<'a, soarnet::Fixed<C, V>>>;
type Capture<'a, const C: usize, const V: usize> =
    Session<Network<'a, C, V>, Lent<'a, planner::Fixed<C, V>>>;

/// A device with its session, network and flash store.
#[derive(Debug)]
pub struct Device<'a, F, const C: usize, const V: usize, const B: usize> {
    reader: Reader,
    out: [u8; PACKET],
    desk: Desk<'a, F, C, V, B>,
}

impl<'a, F: NorFlash, const C: usize, const V: usize, const B: usize> Device<'a, F, C, V, B> {
    /// A device that goes on with the session that it finds in its store, if it finds one of its
    /// model. A model that cannot be used is told to whoever asks. `memory` is the device's alone.
    pub fn new(model: &'a [u8], memory: &'a Memory<C, V, B>, store: Store<F>) -> Self {
        let model = Model::parse(model).map_err(ModelFault::from);
        let mut desk = Desk {
            model,
            memory,
            session: None,
            history: History::default(),
            kept: Kept::Nothing,
            store,
            traffic: Traffic::default(),
        };
        // The memory is the device's alone, so the buffer is free.
        if let Ok(mut buffer) = memory.buffer.try_borrow_mut() {
            desk.load(buffer.as_mut_slice());
        }
        Self { reader: Reader::new(), out: [0; PACKET], desk }
    }

    /// Takes in a byte of the line; gives the packet to send back where one is due.
    pub fn receive(&mut self, byte: u8) -> Option<&[u8]> {
        let Self { reader, out, desk } = self;
        let packet = reader.push(byte)?;
        desk.traffic.packets = desk.traffic.packets.wrapping_add(1);
        let Packet::Message(message) = packet else {
            desk.traffic.damaged = desk.traffic.damaged.wrapping_add(1);
            return None;
        };
        let Ok(((version, id), rest)) = postcard::take_from_bytes::<(u8, u32)>(message) else {
            desk.traffic.damaged = desk.traffic.damaged.wrapping_add(1);
            return None;
        };
        let memory = desk.memory;
        let mut buffer = memory.buffer.try_borrow_mut().ok()?;
        let answer = if version == VERSION {
            desk.answer(rest, buffer.as_mut_slice())
        } else {
            Err(Refusal::Version { speaks: VERSION })
        };
        if answer.is_err() {
            desk.traffic.refused = desk.traffic.refused.wrapping_add(1);
        }
        frame::write(&(VERSION, id, answer.unwrap_or_else(Answer::Refused)), out)
    }
}

/// What has been done with a session, to know a request that comes again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct History {
    session: u32,  // its number; 0 for none
    revision: u32, // changes so far
    origin: u32,   // checksum of the request that opened it
    last: u32,     // checksum of the request that changed it last
}

impl History {
    /// Bytes in front of a snapshot in flash: the four numbers, little-endian.
    const BYTES: usize = 16;

    fn to_bytes(self) -> [[u8; 4]; 4] {
        [self.session, self.revision, self.origin, self.last].map(u32::to_le_bytes)
    }

    fn from_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        let mut numbers = bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
        let mut next = || numbers.next().unwrap_or_default();
        Self { session: next(), revision: next(), origin: next(), last: next() }
    }
}

/// All of a device but the line.
#[derive(Debug)]
struct Desk<'a, F, const C: usize, const V: usize, const B: usize> {
    model: Result<Model<'a>, ModelFault>,
    memory: &'a Memory<C, V, B>,
    session: Option<Capture<'a, C, V>>,
    history: History, // of `session`; of none all zeros
    kept: Kept,
    store: Store<F>,
    traffic: Traffic,
}

impl<'a, F: NorFlash, const C: usize, const V: usize, const B: usize> Desk<'a, F, C, V, B> {
    /// Does what a command says. A refusal leaves everything but the buffer as it was.
    fn answer<'b>(&mut self, bytes: &[u8], buffer: &'b mut [u8]) -> Result<Answer<'b>, Refusal> {
        let (command, rest) =
            postcard::take_from_bytes::<Command<'_>>(bytes).map_err(|_| Refusal::Malformed)?;
        if !rest.is_empty() {
            return Err(Refusal::Malformed);
        }
        match command {
            Command::Status => Ok(Answer::Status(self.status())),
            Command::Write { offset, bytes } => {
                let too_long = Refusal::TooLong { room: B as u32 };
                let place = buffer.get_mut(offset as usize..).ok_or(too_long)?;
                place.get_mut(..bytes.len()).ok_or(too_long)?.copy_from_slice(bytes);
                Ok(Answer::Done { revision: 0 })
            }
            Command::Read { offset, length } => {
                let rest = buffer.get(offset as usize..).unwrap_or_default();
                let length = rest.len().min(usize::from(length)).min(CHUNK);
                Ok(Answer::Bytes(rest.get(..length).unwrap_or_default()))
            }
            Command::Next => {
                let session = self.session.as_mut().ok_or(Refusal::NoSession)?;
                Ok(Answer::Next(match (session.next_view(), session.finish()) {
                    (Some(next), _) => Next::View(next),
                    (None, finish) => Next::Finished(finish.ok_or(Refusal::NoSession)?),
                }))
            }
            Command::Snapshot => {
                let session = self.session.as_ref().ok_or(Refusal::NoSession)?;
                let used = session.snapshot(buffer).map_err(Refusal::Snapshot)?;
                let bytes = buffer.get(..used).unwrap_or_default();
                Ok(Answer::Transfer(Transfer {
                    length: used as u32,
                    checksum: CRC.checksum(bytes),
                }))
            }
            Command::Open { over, session, how } => {
                let origin = CRC.checksum(bytes);
                let History { session: present, revision, .. } = self.history;
                if session != 0 && session == present && origin == self.history.origin {
                    return Ok(Answer::Done { revision });
                }
                if over != present || session == 0 || session == present {
                    return Err(Refusal::Conflict { session: present, revision });
                }
                match how {
                    Opening::Plan { plan, candidates } => self.begin(plan, candidates, buffer)?,
                    Opening::Snapshot(transfer) => self.restore(transfer, buffer)?,
                }
                self.history = History { session, revision: 0, origin, last: 0 };
                self.keep(buffer);
                Ok(Answer::Done { revision: 0 })
            }
            Command::Change { session, revision, change } => {
                let History { session: present, revision: done, last, .. } = self.history;
                let checksum = CRC.checksum(bytes);
                if present == 0 {
                    return Err(Refusal::NoSession);
                }
                if session == present && revision.wrapping_add(1) == done && checksum == last {
                    return Ok(Answer::Done { revision: done });
                }
                if session != present || revision != done {
                    return Err(Refusal::Conflict { session: present, revision: done });
                }
                self.change(change, buffer)?;
                self.history.revision = done.wrapping_add(1);
                self.history.last = checksum;
                self.keep(buffer);
                Ok(Answer::Done { revision: self.history.revision })
            }
        }
    }

    fn change(&mut self, change: Change, buffer: &[u8]) -> Result<(), Refusal> {
        let session = self.session.as_mut().ok_or(Refusal::NoSession)?;
        match change {
            Change::Observe { candidate, pose, photo } => {
                let pose = pose.pose().map_err(Refusal::Pose)?;
                let photo = match photo {
                    Some(head) => Photo::new(picture(head, buffer)?),
                    None => Photo::default(),
                };
                match candidate {
                    Some(index) => session.observe(index as usize, pose, &photo),
                    None => session.observe_elsewhere(pose, &photo),
                }
                .map_err(|error| match error {
                    ObserveError::Session(error) => error.into(),
                    ObserveError::Scorer(error) => error.into(),
                })
            }
            Change::Block(index) => Ok(session.block(index as usize)?),
            Change::Unblock(index) => Ok(session.unblock(index as usize)?),
            Change::Skip(index) => Ok(session.skip(index as usize)?),
            Change::Replan(plan) => {
                // The network's centre stays; the plan's must be the same.
                let centre = session.plan().centre();
                Ok(session.replan(plan.with_centre(centre))?)
            }
        }
    }

    /// Begins a session. What can be refused is refused before the present one is given up.
    fn begin(
        &mut self,
        plan: Plan,
        candidates: Candidates,
        buffer: &mut [u8],
    ) -> Result<(), Refusal> {
        let model = self.model.map_err(Refusal::Model)?;
        let (pool, list, count) = match candidates {
            Candidates::Pool { space, count, radius_m, target } => {
                let pool = Pool::try_new(space, count as usize, radius_m)
                    .and_then(|pool| pool.with_target(Vec3::from_array(target)))
                    .map_err(Refusal::Pool)?;
                (Some(pool), [].as_slice(), pool.len())
            }
            Candidates::Listed(transfer) => {
                let (list, rest) = transferred(transfer, buffer)?.as_chunks();
                if !rest.is_empty() {
                    return Err(Refusal::BadList);
                }
                (None, list, list.len())
            }
        };
        if count > C {
            return Err(SessionError::TooManyCandidates { capacity: C }.into());
        }
        plan.check(count)?;
        if plan.budget() > V {
            return Err(SessionError::TooManyViews { capacity: V }.into());
        }
        for (index, posture) in list.iter().enumerate() {
            let index = index as u32;
            Posture::from_bytes(posture)
                .pose()
                .map_err(|error| Refusal::Candidate { index, error })?;
        }
        let pose = |index: usize| match &pool {
            Some(pool) => pool.pose(index),
            None => list.get(index).and_then(|posture| Posture::from_bytes(posture).pose().ok()),
        };
        let poses = || (0..count).filter_map(pose);
        let centre = plan.centre();
        for (index, pose) in poses().enumerate() {
            features::Direction::try_from_vector(pose.position() - centre)
                .ok_or(Refusal::NoDirection { index: index as u32 })?;
        }
        self.session = None;
        let opened = self.open(model, centre, poses, |lists, scorer| {
            Ok(Session::try_new(lists, poses(), scorer, plan)?)
        });
        self.took(opened, buffer)
    }

    /// Takes on a snapshot from the buffer. What is no snapshot of this model or too large is refused
    /// before the present session is given up; one with unsound records only after it, which then comes
    /// back from flash.
    fn restore(&mut self, transfer: Transfer, buffer: &mut [u8]) -> Result<(), Refusal> {
        let bytes = transferred(transfer, buffer)?;
        let contents = self.contents(bytes)?;
        if contents.candidates().nth(C).is_some() || contents.plan().budget() > V {
            return Err(Refusal::Snapshot(SnapshotError::TooLarge));
        }
        self.session = None;
        let opened = self.reopen(bytes, &contents);
        self.took(opened, buffer)
    }

    /// A new session, or the one that was there before from flash.
    fn took(
        &mut self,
        opened: Result<Capture<'a, C, V>, Refusal>,
        buffer: &mut [u8],
    ) -> Result<(), Refusal> {
        let result = opened.map(|session| self.session = Some(session));
        if result.is_err() {
            self.history = History::default();
            self.kept = Kept::Nothing;
            self.load(buffer);
        }
        result
    }

    fn contents<'b>(&self, bytes: &'b [u8]) -> Result<Contents<'b>, Refusal> {
        let model = self.model.map_err(Refusal::Model)?;
        let contents = Contents::parse(bytes).map_err(Refusal::Snapshot)?;
        if contents.fingerprint() != model.checksum() {
            return Err(Refusal::Snapshot(SnapshotError::OtherScorer));
        }
        Ok(contents)
    }

    fn reopen(&self, bytes: &[u8], contents: &Contents<'_>) -> Result<Capture<'a, C, V>, Refusal> {
        let model = self.model.map_err(Refusal::Model)?;
        let poses = || contents.candidates();
        self.open(model, contents.plan().centre(), poses, |lists, scorer| {
            Session::restore(lists, scorer, bytes).map_err(Refusal::Snapshot)
        })
    }

    /// A session in the device's memory, which must be free.
    fn open<I: Iterator<Item = Pose>>(
        &self,
        model: Model<'a>,
        centre: Vec3,
        poses: impl Fn() -> I,
        make: impl FnOnce(
            Lent<'a, planner::Fixed<C, V>>,
            Network<'a, C, V>,
        ) -> Result<Capture<'a, C, V>, Refusal>,
    ) -> Result<Capture<'a, C, V>, Refusal> {
        // Both are free: only the session held them.
        let network = self.memory.network.try_borrow_mut().map_err(|_| Refusal::NoSession)?;
        let lists = self.memory.lists.try_borrow_mut().map_err(|_| Refusal::NoSession)?;
        let scorer = SoarNet::try_new(model, Lent(network), centre, poses())?;
        make(Lent(lists), scorer)
    }

    /// Goes on with the session in the store, if there is one of this model.
    fn load(&mut self, buffer: &mut [u8]) {
        let Ok(Some(length)) = self.store.load(buffer) else { return };
        let record = buffer.get(..length).unwrap_or_default();
        let Some((history, bytes)) = record.split_first_chunk() else { return };
        let opened = self.contents(bytes).and_then(|contents| self.reopen(bytes, &contents));
        if let Ok(session) = opened {
            self.session = Some(session);
            self.history = History::from_bytes(history);
            self.kept = Kept::Session;
        }
    }

    /// Keeps the session in flash. What fails is told by the status; the session goes on.
    fn keep(&mut self, buffer: &mut [u8]) {
        let kept = self.session.as_mut().and_then(|session| {
            // A view that was due keeps its objective: choose it before the snapshot.
            session.next_view();
            let (head, rest) = buffer.split_first_chunk_mut::<{ History::BYTES }>()?;
            let used = session.snapshot(rest).ok()?;
            head.copy_from_slice(self.history.to_bytes().as_flattened());
            self.store.save(buffer.get(..History::BYTES + used)?).ok()
        });
        self.kept = if kept.is_some() { Kept::Session } else { Kept::Failed };
    }

    fn status(&self) -> Status {
        let sees = |model: &Model<'_>| Sees {
            checksum: model.checksum(),
            photos: model.dimensions().embedding > 0,
        };
        Status {
            model: self.model.as_ref().map(sees).map_err(|fault| *fault),
            room: Room { candidates: C as u32, views: V as u32, transfer: B as u32 },
            session: self.session.as_ref().map(|session| Progress {
                session: self.history.session,
                revision: self.history.revision,
                candidates: session.candidates().len() as u32,
                views: session.views().len() as u32,
                budget: session.plan().budget() as u32,
                scores: session.scores(),
            }),
            line: self.traffic,
            kept: self.kept,
        }
    }
}

/// What a command says is in the buffer, if it is.
fn transferred(transfer: Transfer, buffer: &[u8]) -> Result<&[u8], Refusal> {
    let room = buffer.len() as u32;
    let bytes = buffer.get(..transfer.length as usize).ok_or(Refusal::TooLong { room })?;
    if CRC.checksum(bytes) == transfer.checksum { Ok(bytes) } else { Err(Refusal::Transfer) }
}

fn picture(head: PhotoHead, buffer: &[u8]) -> Result<Image<'_>, Refusal> {
    let bytes = transferred(head.transfer, buffer)?;
    Image::try_new(head.width, head.height, head.pixels, bytes).map_err(Refusal::Photo)
}
