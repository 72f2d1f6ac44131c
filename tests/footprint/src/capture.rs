//! A capture of 30 views with everything that happens on a device: mishaps, a power loss, another plan.

use core::hint::black_box;

use golden_sessions::{Entry, MODEL, Mishap, Recording, SESSIONS};
use vantage_core::planner::{self, Contents, Plan, Session, Stop};
use vantage_core::soarnet::{self, Image, Model, Photo, Scratch, SoarNet, Window};
use vantage_core::{Objective, Pose, Vec3};

/// The capacities that the budgets in the design name.
const CANDIDATES: usize = 128;
const VIEWS: usize = 64;

type Lists = planner::Fixed<CANDIDATES, VIEWS>;
type Network = soarnet::Fixed<CANDIDATES, VIEWS>;
type Scorer<'a> = SoarNet<'static, &'a mut Network>;
type Capture<'a> = Session<&'a mut Scorer<'a>, &'a mut Lists>;

/// Room for a snapshot of 64 views, in which a view has 96 numbers of an embedding and 320 of a sketch.
const SNAPSHOT: usize = 36 * 1024;

/// All memory of a capture, but for the stack.
pub struct Memory {
    lists: Lists,
    network: Network,
    snapshot: [u8; SNAPSHOT],
}

impl Memory {
    /// Zeros, which cost no flash in a `static`.
    pub const fn new() -> Self {
        Self { lists: Lists::new(), network: Network::new(), snapshot: [0; SNAPSHOT] }
    }
}

/// What the parts take, in bytes.
pub fn sizes() -> [(&'static str, usize); 6] {
    [
        ("lists", size_of::<Lists>()),
        ("network", size_of::<Network>()),
        ("scratch", size_of::<Scratch>()),
        ("snapshot", SNAPSHOT),
        ("session", size_of::<Capture<'_>>() + size_of::<Scorer<'_>>()),
        ("data", SESSIONS.iter().map(|(_, bytes)| bytes.len()).sum::<usize>() + MODEL.len()),
    ]
}

/// The capture; `None` where anything is not as it should be.
pub fn run(memory: &mut Memory) -> Option<()> {
    #[cfg(feature = "everything")]
    by_poses(&mut memory.lists)?;
    let used = start(memory)?;
    resume(memory, used)
}

// What lies in flash is hidden from the compiler, so that it must be ready for any bytes.
fn recording() -> Option<Recording<'static>> {
    let (_, bytes) = *black_box(&SESSIONS).first()?;
    Recording::parse(bytes).ok()
}

/// A scorer. Apart from what uses it, so that what it takes to make one is off the stack by then.
#[inline(never)]
fn scorer<'a>(
    network: &'a mut Network,
    centre: Vec3,
    candidates: impl Iterator<Item = Pose>,
) -> Option<Scorer<'a>> {
    SoarNet::try_new(Model::parse(black_box(MODEL)).ok()?, network, centre, candidates).ok()
}

/// Half of the views, and the length of the snapshot after them.
#[inline(never)]
fn start(Memory { lists, network, snapshot }: &mut Memory) -> Option<usize> {
    let recording = recording()?;
    let plan = recording.header().plan()?;
    let mut scorer = scorer(network, plan.centre(), recording.candidates())?;
    let candidates = recording.candidates();
    let mut session = Session::try_new(lists, candidates, &mut scorer, plan).ok()?;
    views(&mut session, &recording, 15)?;
    session.snapshot(snapshot).ok()
}

/// The rest of them, after the power has failed: what was kept says all.
#[inline(never)]
fn resume(Memory { lists, network, snapshot }: &mut Memory, used: usize) -> Option<()> {
    let recording = recording()?;
    let kept = black_box(snapshot.get(..used)?);
    let contents = Contents::parse(kept).ok()?;
    let mut scorer = scorer(network, contents.plan().centre(), contents.candidates())?;
    let mut session = Session::restore(lists, &mut scorer, kept).ok()?;
    views(&mut session, &recording, 24)?;
    session.score_all(Objective::Texture);
    // A rule that never ends this capture, as no gain is below 0.
    let stop = black_box(Stop { gain: 0.0, patience: 6 });
    let plan = Plan::sum(30).with_centre(session.plan().centre()).with_stop(stop);
    session.replan(plan).ok()?;
    views(&mut session, &recording, 30)?;

    let mut rest = [0, 1, 2, 3, 4, 5, 6, 7];
    black_box(session.order_by_travel(black_box(&mut rest)));
    black_box((session.scores(), session.finish()));
    (session.views().len() == 30).then_some(())
}

/// Takes views in, with whatever happens on the way, until there are so many.
fn views(session: &mut Capture<'_>, recording: &Recording<'_>, count: usize) -> Option<()> {
    while session.views().len() < count {
        let Some(next) = session.next_view() else { break };
        let entry = recording.entry(next.index)?;
        let photo = photo(recording, &entry)?;
        match entry.mishap {
            Mishap::Blocked => session.block(next.index).ok()?,
            Mishap::Missed => {
                session.skip(next.index).ok()?;
                session.unblock(next.index).ok()?;
                session.observe(next.index, entry.reached, &photo).ok()?;
            }
            Mishap::Elsewhere => {
                session.observe_elsewhere(entry.reached, &photo).ok()?;
                session.block(next.index).ok()?;
            }
            Mishap::None => session.observe(next.index, entry.reached, &photo).ok()?,
        }
    }
    Some(())
}

fn photo<'a>(recording: &Recording<'_>, entry: &Entry<'a>) -> Option<Photo<'a>> {
    let header = recording.header();
    let (width, height) = (header.width.into(), header.height.into());
    let image = Image::try_new(width, height, header.pixels, entry.frame).ok()?;
    let window = Window::try_new(black_box(-3), black_box(2), black_box(64)).ok()?;
    Some(Photo::new(image).with_window(window))
}

/// Plans by poses alone, over candidates of every view space.
#[cfg(feature = "everything")]
#[inline(never)]
fn by_poses(lists: &mut Lists) -> Option<()> {
    use vantage_core::candidates::{Pool, Reach, ViewSpace};
    use vantage_core::planner::Blind;

    let (min_elevation_rad, max_elevation_rad) = black_box((0.1, 1.2));
    let spaces = [
        ViewSpace::RandomSphere { seed: black_box(3) },
        ViewSpace::FibonacciSphere,
        ViewSpace::Hemisphere { min_elevation_rad, max_elevation_rad },
        ViewSpace::Rings { rings: black_box(3), min_elevation_rad, max_elevation_rad },
        ViewSpace::Spiral { turns: black_box(3.0), min_elevation_rad, max_elevation_rad },
    ];
    for space in black_box(spaces) {
        let pool = Pool::try_new(space, black_box(40), black_box(2.0)).ok()?;
        let pool = pool.with_target(black_box(Vec3::ZERO)).ok()?;
        let reach = Reach::default().with_elevation(black_box(-1.5), black_box(1.5));
        black_box(pool.reachable(&reach).count());
        for plan in black_box([Plan::random(5), Plan::farthest_point(5), Plan::pseudo_coverage(5)])
        {
            let mut session = Session::try_new(&mut *lists, pool.iter(), Blind, plan).ok()?;
            while let Some(next) = session.next_view() {
                let rows = black_box(next.pose.rows());
                let reached = Pose::try_from_rows(rows).ok()?;
                session.observe(next.index, reached, &()).ok()?;
            }
        }
    }
    #[cfg(feature = "with-a-panic")]
    black_box(black_box([1u8; 4].as_slice())[black_box(3)]);
    Some(())
}
