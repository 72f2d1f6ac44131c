//! What C may get wrong, and what it is told.

use core::ffi::CStr;
use core::mem::MaybeUninit;
use core::ptr::{null, null_mut};
use std::vec;
use std::vec::Vec;

use vantage_core::soarnet::{Dimensions, Model};

use crate::memory::VANTAGE_SESSION_ALIGN;
use crate::pose::{Pool, Space, vantage_pool_pose, vantage_pose_looking_at};
use crate::session::*;
use crate::status::{Status, vantage_status_text};
use crate::types::{CandidateStatus, Finish, Format, Next, Photo, Plan, Pose, Scheme, Scores};
use crate::{VANTAGE_CANDIDATE_BYTES, VANTAGE_SESSION_BYTES, VANTAGE_VIEW_BYTES, vantage_version};

static MODEL: &[u8] = include_bytes!("../../../lab/models/soarnet.model");
static POSES_MODEL: &[u8] = include_bytes!("../../../lab/models/soarnet-poses.model");

const PLAN: Plan = Plan {
    scheme: Scheme::Ensemble as u32,
    budget_views: 4,
    seed: 0,
    movement_cost: 0.0,
    stop_gain: 0.0,
    stop_patience: 0,
    centre_m: [0.0; 3],
};

const POOL: Pool = Pool {
    space: Space::FibonacciSphere as u32,
    count: 12,
    radius_m: 2.0,
    target_m: [0.0; 3],
    min_elevation_rad: 0.0,
    max_elevation_rad: 1.0,
    rings: 2,
    turns: 2.0,
    seed: 0,
};

/// Memory on the required border.
struct Memory(Vec<u128>);

impl Memory {
    fn new(bytes: usize) -> Self {
        assert_eq!(align_of::<u128>() % VANTAGE_SESSION_ALIGN, 0);
        Self(vec![0xa5a5_a5a5; bytes.div_ceil(16)])
    }

    fn start(&mut self) -> *mut u8 {
        self.0.as_mut_ptr().cast()
    }
}

fn poses() -> Vec<Pose> {
    let mut pose = Pose::default();
    // SAFETY: references are valid.
    (0..12).map(|i| unsafe { (vantage_pool_pose(&POOL, i, &mut pose), pose).1 }).collect()
}

fn size(model: &[u8], candidates: u32, views: u32) -> usize {
    // SAFETY: a slice is valid for its length.
    unsafe { vantage_session_size(model.as_ptr(), model.len(), candidates, views) }
}

fn make(
    memory: &mut Memory,
    bytes: usize,
    model: &'static [u8],
    poses: &[Pose],
    plan: &Plan,
    views: u32,
) -> Result<*mut Session, Status> {
    let mut session = null_mut();
    // SAFETY: references and slices are valid, and every test keeps its memory while it uses a session.
    let status = unsafe {
        vantage_session_new(
            memory.start(),
            bytes,
            model.as_ptr(),
            model.len(),
            poses.as_ptr(),
            poses.len(),
            plan,
            views,
            &mut session,
        )
    };
    if status == Status::Ok { Ok(session) } else { Err(status) }
}

fn restore(memory: &mut Memory, model: &'static [u8], kept: &[u8], views: u32) -> Status {
    let mut session = null_mut();
    // SAFETY: as of `make`.
    unsafe {
        vantage_session_restore(
            memory.start(),
            16 * memory.0.len(),
            model.as_ptr(),
            model.len(),
            kept.as_ptr(),
            kept.len(),
            views,
            &mut session,
        )
    }
}

fn next(session: *mut Session) -> Result<Next, Status> {
    let mut next = MaybeUninit::uninit();
    // SAFETY: a session of `make`, and a place to write to.
    match unsafe { vantage_next_view(session, next.as_mut_ptr()) } {
        // SAFETY: it has been written.
        Status::Ok => Ok(unsafe { next.assume_init() }),
        status => Err(status),
    }
}

fn observe(session: *mut Session, index: u32, pose: &Pose, photo: Option<&Photo>) -> Status {
    // SAFETY: a session of `make`, references, and a photo of a slice.
    unsafe { vantage_observe(session, index, pose, photo.map_or(null(), |photo| photo)) }
}

fn photo(bytes: &[u8]) -> Photo {
    Photo {
        pixels: bytes.as_ptr(),
        length: bytes.len(),
        width: 8,
        height: 8,
        format: Format::Rgb565 as u32,
        window_left: 0,
        window_top: 0,
        window_side: 0,
    }
}

#[test]
fn a_session_needs_no_byte_more_than_its_size() {
    for (model, views) in [(MODEL, 4), (POSES_MODEL, 9)] {
        let bytes = size(model, 12, views);
        let mut memory = Memory::new(bytes);
        for short in [0, 16, bytes / 2, bytes - 1] {
            let refused = make(&mut memory, short, model, &poses(), &PLAN, views);
            assert_eq!(refused, Err(Status::MemoryTooSmall), "{short} of {bytes}");
        }
        make(&mut memory, bytes, model, &poses(), &PLAN, views).unwrap();
    }
    assert_eq!(size(&MODEL[1..], 12, 4), 0);
    assert!(size(MODEL, u32::MAX, u32::MAX) > u32::MAX as usize, "no overflow");
}

#[test]
fn the_headers_size_is_never_less() {
    assert_eq!(*Model::parse(MODEL).unwrap().dimensions(), Dimensions::default());
    for candidates in [0, 1, 3, 64, 128, 1000] {
        for views in [0, 1, 7, 64, 255] {
            let bytes = VANTAGE_SESSION_BYTES
                + candidates as usize * VANTAGE_CANDIDATE_BYTES
                + views as usize * VANTAGE_VIEW_BYTES;
            let needed = size(MODEL, candidates, views);
            assert!((needed..needed + 4096).contains(&bytes), "{candidates} {views}: {needed}");
        }
    }
}

#[test]
fn null_is_refused_everywhere() {
    let bytes = size(POSES_MODEL, 12, 4);
    let mut memory = Memory::new(bytes);
    let session = make(&mut memory, bytes, POSES_MODEL, &poses(), &PLAN, 4).unwrap();
    let (pose, start, list) = (poses()[0], memory.start(), poses());
    let (model, length) = (POSES_MODEL.as_ptr(), POSES_MODEL.len());
    let (mut place, mut count, mut used) = (null_mut(), 0, 0);
    let mut scores = Scores { coverage: 0.0, geometry: 0.0, diversity: 0.0, texture: 0.0 };
    let (mut finish, mut candidate) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    let mut room = [0; 8];
    // SAFETY: every pointer is null or valid.
    let statuses = unsafe {
        [
            vantage_model_check(null(), 5),
            vantage_pool_pose(null(), 0, &mut Pose::default()),
            vantage_pool_pose(&POOL, 0, null_mut()),
            vantage_pose_looking_at(null(), [0.0; 3].as_ptr(), &mut Pose::default()),
            vantage_pose_looking_at([0.0; 3].as_ptr(), null(), &mut Pose::default()),
            vantage_pose_looking_at([1.0; 3].as_ptr(), [0.0; 3].as_ptr(), null_mut()),
            vantage_session_new(
                null_mut(),
                bytes,
                model,
                length,
                list.as_ptr(),
                12,
                &PLAN,
                4,
                &mut place,
            ),
            vantage_session_new(
                start,
                bytes,
                null(),
                length,
                list.as_ptr(),
                12,
                &PLAN,
                4,
                &mut place,
            ),
            vantage_session_new(start, bytes, model, length, null(), 12, &PLAN, 4, &mut place),
            vantage_session_new(
                start,
                bytes,
                model,
                length,
                list.as_ptr(),
                12,
                null(),
                4,
                &mut place,
            ),
            vantage_session_new(
                start,
                bytes,
                model,
                length,
                list.as_ptr(),
                12,
                &PLAN,
                4,
                null_mut(),
            ),
            vantage_session_restore(start, bytes, model, length, null(), 9, 4, &mut place),
            vantage_next_view(null_mut(), null_mut()),
            vantage_next_view(session, null_mut()),
            vantage_observe(null_mut(), 0, &pose, null()),
            vantage_observe(session, 0, null(), null()),
            vantage_observe(session, 0, &pose, &Photo { pixels: null(), ..photo(&[0; 128]) }),
            vantage_observe_elsewhere(null_mut(), &pose, null()),
            vantage_block(null_mut(), 0),
            vantage_unblock(null_mut(), 0),
            vantage_skip(null_mut(), 0),
            vantage_replan(null_mut(), &PLAN),
            vantage_replan(session, null()),
            vantage_finish(null_mut(), &mut finish),
            vantage_finish(session, null_mut()),
            vantage_scores(null_mut(), &mut scores),
            vantage_scores(session, null_mut()),
            vantage_view_count(null_mut(), &mut count),
            vantage_view_count(session, null_mut()),
            vantage_candidate(null_mut(), 0, &mut candidate),
            vantage_candidate(session, 0, null_mut()),
            vantage_snapshot(null_mut(), room.as_mut_ptr(), 8, &mut used),
            vantage_snapshot(session, null_mut(), 8, &mut used),
            vantage_snapshot(session, room.as_mut_ptr(), 8, null_mut()),
        ]
    };
    for (call, status) in statuses.into_iter().enumerate() {
        assert_eq!(status, Status::NullPointer, "call {call}");
    }
    assert_eq!(next(session).map(|_| ()), Ok(()), "the session goes on");
}

#[test]
fn what_is_misaligned_or_no_session_is_refused() {
    let bytes = size(POSES_MODEL, 12, 4);
    let mut memory = Memory::new(bytes + 16);
    let mut place = null_mut();
    for offset in 1..16 {
        // SAFETY: the memory is longer by 16 bytes than what is passed.
        let status = unsafe {
            vantage_session_new(
                memory.start().add(offset),
                bytes,
                POSES_MODEL.as_ptr(),
                POSES_MODEL.len(),
                poses().as_ptr(),
                12,
                &PLAN,
                4,
                &mut place,
            )
        };
        assert_eq!(status, Status::Misaligned);
    }
    // SAFETY: aligned memory of a session's length, which is none; then an address within it.
    let (none, odd) = unsafe {
        let start = memory.start();
        (vantage_block(start.cast(), 0), vantage_block(start.add(1).cast(), 0))
    };
    assert_eq!((none, odd), (Status::NotASession, Status::Misaligned));
}

#[test]
fn numbers_that_mean_nothing_are_refused() {
    let bytes = size(POSES_MODEL, 12, 4);
    let mut memory = Memory::new(bytes);
    let mut refused = |plan: Plan, poses: &[Pose]| {
        make(&mut memory, bytes, POSES_MODEL, poses, &plan, 4).map(|_| ()).unwrap_err()
    };
    let list = poses();
    assert_eq!(refused(Plan { scheme: 9, ..PLAN }, &list), Status::BadNumber);
    assert_eq!(refused(Plan { budget_views: 0, ..PLAN }, &list), Status::BadPlan);
    assert_eq!(refused(Plan { budget_views: 13, ..PLAN }, &list), Status::BadPlan);
    assert_eq!(refused(Plan { budget_views: 5, ..PLAN }, &list), Status::TooManyViews);
    assert_eq!(refused(Plan { movement_cost: f32::NAN, ..PLAN }, &list), Status::BadPlan);
    assert_eq!(refused(Plan { stop_patience: 1 << 16, ..PLAN }, &list), Status::BadPlan);
    let off = Plan { centre_m: [f32::INFINITY, 0.0, 0.0], ..PLAN };
    assert!(matches!(refused(off, &list), Status::BadPlan | Status::OnTheCentre));
    let on = Plan { centre_m: list[3].position_m, ..PLAN };
    assert_eq!(refused(on, &list), Status::OnTheCentre);
    let mut bad = list.clone();
    bad[5].rotation[2] = f32::NAN;
    assert_eq!(refused(PLAN, &bad), Status::BadPose);
    bad[5].rotation = [0.0, 0.0, 0.0, 1.1];
    assert_eq!(refused(PLAN, &bad), Status::BadPose);
    assert_eq!(refused(PLAN, &[list.as_slice(), &list].concat()), Status::MemoryTooSmall);

    let mut pose = Pose::default();
    // SAFETY: references are valid.
    let mut pool = |pool: Pool, index| unsafe { vantage_pool_pose(&pool, index, &mut pose) };
    for space in 0..5 {
        assert_eq!(pool(Pool { space, ..POOL }, 11), Status::Ok);
    }
    assert_eq!(pool(Pool { space: 5, ..POOL }, 0), Status::BadNumber);
    assert_eq!(pool(POOL, 12), Status::UnknownCandidate);
    assert_eq!(pool(Pool { radius_m: f32::NAN, ..POOL }, 0), Status::BadPool);
    assert_eq!(pool(Pool { target_m: [f32::NAN; 3], ..POOL }, 0), Status::BadPool);
    // SAFETY: three numbers each.
    let same = unsafe { vantage_pose_looking_at([1.0; 3].as_ptr(), [1.0; 3].as_ptr(), &mut pose) };
    assert_eq!(same, Status::BadPose);
}

#[test]
fn bad_photos_are_refused_and_the_session_goes_on() {
    let bytes = size(MODEL, 12, 4);
    let mut memory = Memory::new(bytes);
    let session = make(&mut memory, bytes, MODEL, &poses(), &PLAN, 4).unwrap();
    let first = next(session).unwrap();
    let pixels = [7; 128];
    let good = photo(&pixels);
    for (bad, status) in [
        (Photo { length: 127, ..good }, Status::BadPhoto),
        (Photo { width: 0, ..good }, Status::BadPhoto),
        (Photo { width: u32::MAX, height: u32::MAX, ..good }, Status::BadPhoto),
        (Photo { length: usize::MAX, ..good }, Status::BadNumber),
        (Photo { format: 3, ..good }, Status::BadNumber),
        (Photo { window_side: u32::MAX, ..good }, Status::BadPhoto),
    ] {
        assert_eq!(observe(session, first.index, &first.pose, Some(&bad)), status);
    }
    assert_eq!(observe(session, first.index, &first.pose, None), Status::NoPhoto);
    assert_eq!(observe(session, 12, &first.pose, Some(&good)), Status::UnknownCandidate);
    let on_the_centre = Pose { position_m: [0.0; 3], ..first.pose };
    let refused = observe(session, first.index, &on_the_centre, Some(&good));
    assert_eq!(refused, Status::OnTheCentre);
    assert_eq!(next(session), Ok(first));

    let window = Photo { window_left: -2, window_top: 1, window_side: 6, ..good };
    for index in 0..4 {
        assert_eq!(observe(session, index, &first.pose, Some(&window)), Status::Ok);
    }
    assert_eq!(observe(session, 4, &first.pose, Some(&good)), Status::TooManyViews);
    assert_eq!(next(session), Err(Status::Done));
    let (mut finish, mut candidate) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    let mut count = 0;
    // SAFETY: a session of `make` and places to write to, which are read once written.
    let told = unsafe {
        let statuses = [
            vantage_finish(session, &mut finish),
            vantage_candidate(session, 3, &mut candidate),
            vantage_view_count(session, &mut count),
        ];
        assert_eq!(statuses, [Status::Ok; 3]);
        (finish.assume_init(), candidate.assume_init(), count)
    };
    assert_eq!(told, (Finish::BudgetSpent, CandidateStatus::Visited, 4));
}

#[test]
fn snapshots_that_do_not_fit_are_refused_by_reason() {
    let bytes = size(MODEL, 12, 4);
    let mut memory = Memory::new(bytes);
    let session = make(&mut memory, bytes, MODEL, &poses(), &PLAN, 4).unwrap();
    let first = next(session).unwrap();
    assert_eq!(observe(session, first.index, &first.pose, Some(&photo(&[9; 128]))), Status::Ok);
    let second = next(session).unwrap();
    let (mut kept, mut used) = (vec![0; 4096], 0);
    // SAFETY: a session of `make`, and slices.
    let mut save = |size| unsafe { vantage_snapshot(session, kept.as_mut_ptr(), size, &mut used) };
    assert_eq!(save(100), Status::NoRoom);
    assert_eq!(save(4096), Status::Ok);
    kept.truncate(used);

    let mut other = Memory::new(bytes);
    let mut refused = |kept: &[u8], model, views| restore(&mut other, model, kept, views);
    assert_eq!(refused(&kept[..used - 1], MODEL, 4), Status::BadSnapshot);
    assert_eq!(refused(&kept, POSES_MODEL, 4), Status::OtherModel);
    assert_eq!(refused(&kept, MODEL, 3), Status::TooManyViews);
    assert_eq!(refused(&kept, MODEL, 400), Status::MemoryTooSmall);
    let mut older = kept.clone();
    older[4] = 0;
    assert_eq!(refused(&older, MODEL, 4), Status::OtherSnapshotVersion);
    assert_eq!(refused(&kept, MODEL, 4), Status::Ok);
    let session: *mut Session = other.start().cast();
    assert_eq!(next(session), Ok(second));
}

#[test]
fn blocked_skipped_and_replanned_as_in_the_core() {
    let bytes = size(POSES_MODEL, 12, 6);
    let mut memory = Memory::new(bytes);
    let session = make(&mut memory, bytes, POSES_MODEL, &poses(), &PLAN, 6).unwrap();
    let first = next(session).unwrap();
    // SAFETY: a session of `make`, and references.
    unsafe {
        assert_eq!(vantage_block(session, first.index), Status::Ok);
        assert_ne!(next(session).unwrap().index, first.index);
        assert_eq!(vantage_unblock(session, first.index), Status::Ok);
        assert_eq!(vantage_skip(session, 12), Status::UnknownCandidate);
        for index in 0..12 {
            assert_eq!(vantage_skip(session, index), Status::Ok);
        }
        assert_eq!(next(session), Err(Status::Done));
        assert_eq!(vantage_observe_elsewhere(session, &first.pose, null()), Status::Ok);
        assert!(next(session).is_ok(), "what was skipped may be asked for again");
        let longer = Plan { budget_views: 7, ..PLAN };
        assert_eq!(vantage_replan(session, &longer), Status::TooManyViews);
        assert_eq!(vantage_replan(session, &Plan { budget_views: 1, ..PLAN }), Status::Ok);
    }
    assert_eq!(next(session), Err(Status::Done));
}

#[test]
fn texts_end_and_are_sentences() {
    for status in 0..24 {
        // SAFETY: it is never null and ends with a zero.
        let text = unsafe { CStr::from_ptr(vantage_status_text(status)) }.to_str().unwrap();
        assert_eq!(text == "this status is none", status > Status::OtherModel as u32, "{status}");
    }
    // SAFETY: as above.
    let version = unsafe { CStr::from_ptr(vantage_version()) }.to_str().unwrap();
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
}

#[test]
fn a_model_is_checked() {
    // SAFETY: slices are valid for their length.
    let check = |model: &[u8]| unsafe { vantage_model_check(model.as_ptr(), model.len()) };
    assert_eq!(check(MODEL), Status::Ok);
    assert_eq!(check(&MODEL[..MODEL.len() - 1]), Status::BadModel);
    let mut newer = MODEL.to_vec();
    newer[4] = 0xee;
    assert_eq!(check(&newer), Status::OtherModelVersion);
}
