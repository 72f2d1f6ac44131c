//! A capture in progress.

use core::mem::MaybeUninit;

use vantage_core::planner::{
    Contents, Finish as CoreFinish, Session as CoreSession, Status as CoreStatus,
};
use vantage_core::soarnet::{Model, SoarNet};
use vantage_core::{Pose as CorePose, Vec3};

use crate::memory::{
    Block, NetworkLists, Room, SessionLists, bytes, bytes_mut, deal, list, padded, reference,
    reference_mut,
};
use crate::status::Status;
use crate::types::{CandidateStatus, Finish, Next, Photo, Plan, Pose, Scores};

/// Stands at the beginning of every session, so that other memory is not taken for one.
const TAG: u32 = u32::from_le_bytes(*b"VNTG");

type Scorer = SoarNet<'static, NetworkLists>;
type Core = CoreSession<&'static mut Scorer, SessionLists>;

/// A capture in progress, in the caller's memory.
#[derive(Debug)]
pub struct Session {
    tag: u32, // TAG
    // The scorer lies beside it: it is large, and would else be copied over the stack on its way here.
    core: Core,
}

/// A session of the caller's.
///
/// # Safety
///
/// `session` is null, misaligned, or valid for a session that nobody else uses meanwhile.
unsafe fn session<'a>(session: *mut Session) -> Result<&'a mut Session, Status> {
    // SAFETY: the caller's promise.
    let session = unsafe { reference_mut(session) }?;
    if session.tag == TAG { Ok(session) } else { Err(Status::NotASession) }
}

/// Bytes of a session; `None` where they are more than any memory has.
fn size(room: Room) -> Option<usize> {
    let objects = padded::<Session>(1)?.checked_add(padded::<Scorer>(1)?)?;
    objects.checked_add(room.size()?)
}

/// Says whether bytes are a model that this library can use.
///
/// # Safety
///
/// `model` is null or valid for `model_length` bytes.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_model_check(model: *const u8, model_length: usize) -> Status {
    // SAFETY: the caller's promise.
    let bytes = unsafe { bytes(model, model_length) };
    Status::of(bytes.and_then(|bytes| Ok(Model::parse(bytes).map(|_| ())?)))
}

/// The bytes that a session of so many candidates and views needs with a model; 0 where the model
/// cannot be used. `VANTAGE_SESSION_SIZE` is never less for models of the default sizes.
///
/// # Safety
///
/// `model` is null or valid for `model_length` bytes.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_session_size(
    model: *const u8,
    model_length: usize,
    candidates: u32,
    views: u32,
) -> usize {
    // SAFETY: the caller's promise.
    let model = unsafe { bytes(model, model_length) }.ok().and_then(|b| Model::parse(b).ok());
    let (candidates, views) = (candidates as usize, views as usize);
    let room = model.map(|model| Room { sizes: *model.dimensions(), candidates, views });
    room.and_then(size).unwrap_or_default()
}

/// What a session's memory must be aligned to: `VANTAGE_SESSION_ALIGN`.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn vantage_session_align() -> usize {
    crate::memory::VANTAGE_SESSION_ALIGN
}

/// Makes a session in `memory` over `count` candidates, with room for `views` views, and writes where it
/// is. The memory belongs to the session until the caller uses it for something else. The model may lie
/// anywhere; aligned to 4 bytes it is read many times faster.
///
/// # Safety
///
/// `memory` is null or valid for `size` bytes that nobody else uses while the session is used. `model`
/// is null or valid for `model_length` bytes that stay as they are just as long, such as in flash.
/// `candidates` is null or valid for `count` poses; `plan` and `session` are null or valid for one value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_session_new(
    memory: *mut u8,
    size: usize,
    model: *const u8,
    model_length: usize,
    candidates: *const Pose,
    count: usize,
    plan: *const Plan,
    views: u32,
    session: *mut *mut Session,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (block, model, candidates, plan, session) = unsafe {
            (
                Block::try_new(memory, size)?,
                bytes(model, model_length)?,
                list(candidates, count)?,
                reference(plan)?,
                reference_mut(session)?,
            )
        };
        let (model, plan) = (Model::parse(model)?, plan.check()?);
        for pose in candidates {
            pose.check()?;
        }
        let poses = || candidates.iter().filter_map(|pose| pose.check().ok());
        let Parts { place, scorer, lists } =
            parts(block, model, count, views, plan.centre(), poses())?;
        *session = put(place, CoreSession::try_new(lists, poses(), scorer, plan)?);
        Ok(())
    })())
}

/// Makes a session in `memory` as it stood when a snapshot of it was written, with room for `views`
/// views, and writes where it is.
///
/// # Safety
///
/// As of `vantage_session_new`; `snapshot` is null or valid for `length` bytes.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_session_restore(
    memory: *mut u8,
    size: usize,
    model: *const u8,
    model_length: usize,
    snapshot: *const u8,
    length: usize,
    views: u32,
    session: *mut *mut Session,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (block, model, snapshot, session) = unsafe {
            (
                Block::try_new(memory, size)?,
                bytes(model, model_length)?,
                bytes(snapshot, length)?,
                reference_mut(session)?,
            )
        };
        let (model, contents) = (Model::parse(model)?, Contents::parse(snapshot)?);
        let count = contents.candidates().count();
        let centre = contents.plan().centre();
        let Parts { place, scorer, lists } =
            parts(block, model, count, views, centre, contents.candidates())?;
        *session = put(place, CoreSession::restore(lists, scorer, snapshot)?);
        Ok(())
    })())
}

type Place = &'static mut MaybeUninit<Session>;

/// What a session is made of.
struct Parts {
    place: Place,
    scorer: &'static mut Scorer,
    lists: SessionLists,
}

/// Deals a block out to a session, its lists and its scorer. Apart from what uses them, so that what it
/// takes to make a scorer is off the stack by then.
#[inline(never)]
fn parts(
    mut block: Block,
    model: Model<'static>,
    candidates: usize,
    views: u32,
    centre: Vec3,
    poses: impl Iterator<Item = CorePose>,
) -> Result<Parts, Status> {
    let room = Room { sizes: *model.dimensions(), candidates, views: views as usize };
    let place = block.place()?;
    let scorer = block.place()?;
    let (lists, network) = deal(&mut block, room)?;
    let scorer = scorer.write(SoarNet::try_new(model, network, centre, poses)?);
    Ok(Parts { place, scorer, lists })
}

fn put(place: Place, core: Core) -> *mut Session {
    place.write(Session { tag: TAG, core })
}

/// Writes the next view; `VANTAGE_STATUS_DONE` where there is none. Asking again gives the same view.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `next` is null or valid for one value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_next_view(session: *mut Session, next: *mut Next) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (session, next) = unsafe { (self::session(session)?, reference_mut(next)?) };
        let view = session.core.next_view().ok_or(Status::Done)?;
        let index = view.index as u32;
        let (pose, reason) = (Pose::from(&view.pose), view.reason.into());
        *next = Next { index, pose, reason, gain: view.gain };
        Ok(())
    })())
}

/// Takes in the photo of a candidate, at the pose that was really reached. Any candidate may be
/// photographed, not only the one asked for. `photo` may be null for a model that looks at poses alone.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `reached` and `photo` are null or valid
/// for one value, and the photo's `pixels` for `length` bytes.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_observe(
    session: *mut Session,
    index: u32,
    reached: *const Pose,
    photo: *const Photo,
) -> Status {
    // SAFETY: the caller's promise.
    Status::of(unsafe { observe(session, Some(index), reached, photo) })
}

/// Takes in a photo that was taken anywhere, for no candidate.
///
/// # Safety
///
/// As of `vantage_observe`.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_observe_elsewhere(
    session: *mut Session,
    reached: *const Pose,
    photo: *const Photo,
) -> Status {
    // SAFETY: the caller's promise.
    Status::of(unsafe { observe(session, None, reached, photo) })
}

/// # Safety
///
/// As of [`vantage_observe`].
unsafe fn observe(
    session: *mut Session,
    index: Option<u32>,
    reached: *const Pose,
    photo: *const Photo,
) -> Result<(), Status> {
    // SAFETY: the caller's promise.
    let (session, reached) = unsafe { (self::session(session)?, reference(reached)?.check()?) };
    let photo = if photo.is_null() {
        vantage_core::soarnet::Photo::default()
    } else {
        // SAFETY: the caller's promise.
        unsafe { reference(photo)?.check()? }
    };
    match index {
        Some(index) => session.core.observe(index as usize, reached, &photo)?,
        None => session.core.observe_elsewhere(reached, &photo)?,
    }
    Ok(())
}

/// A candidate cannot be reached: it is not asked for again.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_block(session: *mut Session, index: u32) -> Status {
    // SAFETY: the caller's promise.
    let session = unsafe { self::session(session) };
    Status::of(session.and_then(|session| Ok(session.core.block(index as usize)?)))
}

/// A blocked or skipped candidate can be reached after all.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_unblock(session: *mut Session, index: u32) -> Status {
    // SAFETY: the caller's promise.
    let session = unsafe { self::session(session) };
    Status::of(session.and_then(|session| Ok(session.core.unblock(index as usize)?)))
}

/// Not this candidate now; perhaps after the next photo.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_skip(session: *mut Session, index: u32) -> Status {
    // SAFETY: the caller's promise.
    let session = unsafe { self::session(session) };
    Status::of(session.and_then(|session| Ok(session.core.skip(index as usize)?)))
}

/// Goes on with another plan; photos, blocked candidates and scores stay. The model goes on with the
/// centre that the session was made with.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `plan` is null or valid for one value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_replan(session: *mut Session, plan: *const Plan) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (session, plan) = unsafe { (self::session(session)?, reference(plan)?.check()?) };
        Ok(session.core.replan(plan)?)
    })())
}

/// Writes why there is no next view.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `finish` is null or valid for one
/// value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_finish(
    session: *mut Session,
    finish: *mut MaybeUninit<Finish>,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise; the place may hold any number before.
        let (session, finish) = unsafe { (self::session(session)?, reference_mut(finish)?) };
        finish.write(match session.core.finish() {
            None => Finish::NotYet,
            Some(CoreFinish::BudgetSpent) => Finish::BudgetSpent,
            Some(CoreFinish::GoodEnough) => Finish::GoodEnough,
            Some(CoreFinish::NothingLeft) => Finish::NothingLeft,
        });
        Ok(())
    })())
}

/// Writes the scores of the photos so far, as the model sees them.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `scores` is null or valid for one
/// value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_scores(session: *mut Session, scores: *mut Scores) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (session, scores) = unsafe { (self::session(session)?, reference_mut(scores)?) };
        let vantage_core::Scores { coverage, geometry, diversity, texture } = session.core.scores();
        *scores = Scores { coverage, geometry, diversity, texture };
        Ok(())
    })())
}

/// Writes how many photos have been taken in.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `count` is null or valid for one
/// number.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_view_count(session: *mut Session, count: *mut u32) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (session, count) = unsafe { (self::session(session)?, reference_mut(count)?) };
        *count = session.core.views().len() as u32;
        Ok(())
    })())
}

/// Writes what has become of a candidate.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `status` is null or valid for one
/// value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_candidate(
    session: *mut Session,
    index: u32,
    status: *mut MaybeUninit<CandidateStatus>,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise; the place may hold any number before.
        let (session, status) = unsafe { (self::session(session)?, reference_mut(status)?) };
        status.write(match session.core.candidate(index as usize)?.status() {
            CoreStatus::Available => CandidateStatus::Available,
            CoreStatus::Visited => CandidateStatus::Visited,
            CoreStatus::Skipped => CandidateStatus::Skipped,
            CoreStatus::Blocked => CandidateStatus::Blocked,
        });
        Ok(())
    })())
}

/// Writes the session as bytes, to go on after a power loss, and how many they are.
///
/// # Safety
///
/// `session` is null or a session that nobody else uses meanwhile; `buffer` is null or valid for `size`
/// bytes, `length` for one number.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_snapshot(
    session: *mut Session,
    buffer: *mut u8,
    size: usize,
    length: *mut usize,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (session, buffer, length) =
            unsafe { (self::session(session)?, bytes_mut(buffer, size)?, reference_mut(length)?) };
        *length = session.core.snapshot(buffer)?;
        Ok(())
    })())
}
