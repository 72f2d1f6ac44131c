//! Carries a recorded capture out and writes what happens. `examples/c/main.c` does the same in C.

use core::fmt::{self, Write};

use vantage_core::planner::{self, Finish, NextView, Reason, Session};
use vantage_core::soarnet::{self, Image, Model, Photo, SoarNet};
use vantage_core::{Objective, Pose, Scores, Vec3};

use crate::recording::{Entry, Header, Mishap, Recording};

/// Candidates of the largest recording.
pub const CANDIDATES: usize = 64;
/// Views that the largest recording asks for, photos of other places included.
pub const VIEWS: usize = 40;

/// All memory that a replay needs, but for its stack.
#[derive(Debug)]
pub struct Memory {
    lists: planner::Fixed<CANDIDATES, VIEWS>,
    network: soarnet::Fixed<CANDIDATES, VIEWS>,
    snapshot: [u8; 32 * 1024],
}

impl Memory {
    /// Zeros, which cost no flash in a `static`.
    pub const fn new() -> Self {
        Self {
            lists: planner::Fixed::new(),
            network: soarnet::Fixed::new(),
            snapshot: [0; 32 * 1024],
        }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

type Lists<'a> = &'a mut planner::Fixed<CANDIDATES, VIEWS>;
type Network<'a> = &'a mut soarnet::Fixed<CANDIDATES, VIEWS>;
type Capture<'a> = Session<SoarNet<'a, Network<'a>>, Lists<'a>>;

/// Writes a line for everything that happens in a capture; `fmt::Error` where the recording does not
/// fit the memory or the model is none.
pub fn replay(
    out: &mut dyn Write,
    recording: &Recording<'_>,
    model: &[u8],
    memory: &mut Memory,
) -> fmt::Result {
    let header = recording.header();
    let Memory { lists, network, snapshot } = memory;
    let model = Model::parse(model).map_err(|_| fmt::Error)?;
    let plan = header.plan().ok_or(fmt::Error)?;
    writeln!(out, "{} candidates, budget {}", header.candidates, header.budget)?;

    let used = {
        let scorer = scorer(model, network, recording)?;
        let mut session = Session::try_new(&mut *lists, recording.candidates(), scorer, plan)
            .map_err(|_| fmt::Error)?;
        refusals(out, &mut session, recording)?;
        let mut missed = 0;
        carry_on(out, &mut session, recording, &mut missed, usize::from(header.snapshot_after))?;
        session.snapshot(snapshot).map_err(|_| fmt::Error)?
    };

    let kept = snapshot.get_mut(..used).ok_or(fmt::Error)?;
    writeln!(out, "snapshot {used} {:08x}", digest(kept))?;
    // A damaged one is refused, and the memory can be used again.
    flip(kept);
    let refused = Session::restore(&mut *lists, scorer(model, network, recording)?, kept).is_err();
    says(out, "a damaged snapshot", refused)?;
    flip(kept);
    let mut session = Session::restore(&mut *lists, scorer(model, network, recording)?, kept)
        .map_err(|_| fmt::Error)?;
    let mut missed = u64::MAX; // whoever is asked again after the power loss is not missed again
    carry_on(out, &mut session, recording, &mut missed, usize::MAX)?;
    let finish = match session.finish() {
        Some(Finish::BudgetSpent) => "budget spent",
        Some(Finish::GoodEnough) => "good enough",
        Some(Finish::NothingLeft) => "nothing left",
        None => "more views",
    };
    writeln!(out, "{finish}")
}

fn scorer<'a>(
    model: Model<'a>,
    network: Network<'a>,
    recording: &Recording<'_>,
) -> Result<SoarNet<'a, Network<'a>>, fmt::Error> {
    SoarNet::try_new(model, network, recording.header().centre, recording.candidates())
        .map_err(|_| fmt::Error)
}

/// Takes what the planner asks for until there are so many photos or no next view.
///
/// `missed` has a bit for every candidate whose first attempt has failed.
fn carry_on(
    out: &mut dyn Write,
    session: &mut Capture<'_>,
    recording: &Recording<'_>,
    missed: &mut u64,
    photos: usize,
) -> fmt::Result {
    while session.views().len() < photos {
        let Some(next) = session.next_view() else { break };
        let entry = recording.entry(next.index).ok_or(fmt::Error)?;
        let bit = 1u64 << (next.index % 64);
        match entry.mishap {
            Mishap::Blocked => {
                session.block(next.index).map_err(|_| fmt::Error)?;
                writeln!(out, "{} blocked", next.index)?;
            }
            Mishap::Missed if *missed & bit == 0 => {
                *missed |= bit;
                session.skip(next.index).map_err(|_| fmt::Error)?;
                writeln!(out, "{} missed", next.index)?;
            }
            Mishap::Elsewhere => {
                let photo = photo(recording.header(), &entry)?;
                session.observe_elsewhere(entry.reached, &photo).map_err(|_| fmt::Error)?;
                session.block(next.index).map_err(|_| fmt::Error)?;
                line(out, &next, "elsewhere", session.scores())?;
            }
            Mishap::None | Mishap::Missed => {
                let photo = photo(recording.header(), &entry)?;
                session.observe(next.index, entry.reached, &photo).map_err(|_| fmt::Error)?;
                line(out, &next, "taken", session.scores())?;
            }
        }
    }
    Ok(())
}

/// Bad input is refused, and the session goes on as if nothing had been.
fn refusals(
    out: &mut dyn Write,
    session: &mut Capture<'_>,
    recording: &Recording<'_>,
) -> fmt::Result {
    let Header { width, height, pixels, candidates, .. } = *recording.header();
    let entry = recording.entry(0).ok_or(fmt::Error)?;
    let short = entry.frame.split_last().map_or(entry.frame, |(_, rest)| rest);
    let image = Image::try_new(width.into(), height.into(), pixels, short);
    says(out, "a frame cut short", image.is_err())?;
    let nowhere = Pose::try_new(Vec3::NAN, entry.reached.rotation());
    says(out, "a pose that is not a number", nowhere.is_err())?;
    let photo = photo(recording.header(), &entry)?;
    let unknown = session.observe(candidates.into(), entry.reached, &photo);
    says(out, "a candidate that is none", unknown.is_err())?;
    let plan = recording.header().plan().ok_or(fmt::Error)?.with_movement_cost(2.0);
    says(out, "a movement cost of 2", session.replan(plan).is_err())
}

fn photo<'a>(header: &Header, entry: &Entry<'a>) -> Result<Photo<'a>, fmt::Error> {
    let (width, height) = (header.width.into(), header.height.into());
    let image = Image::try_new(width, height, header.pixels, entry.frame);
    image.map(Photo::new).map_err(|_| fmt::Error)
}

fn says(out: &mut dyn Write, what: &str, refused: bool) -> fmt::Result {
    writeln!(out, "{} {what}", if refused { "refused" } else { "accepted" })
}

/// Candidate, what became of it, reason, then gain and the four scores as bits.
fn line(out: &mut dyn Write, next: &NextView, what: &str, scores: Scores) -> fmt::Result {
    let reason = match next.reason {
        Reason::Start => "start",
        Reason::Chance => "chance",
        Reason::Farthest => "farthest",
        Reason::Objective(Objective::Coverage) => "coverage",
        Reason::Objective(Objective::Geometry) => "geometry",
        Reason::Objective(Objective::Diversity) => "diversity",
        Reason::Objective(Objective::Texture) => "texture",
        Reason::AllObjectives => "all",
        Reason::Support => "support",
    };
    write!(out, "{} {what} {reason}", next.index)?;
    let Scores { coverage, geometry, diversity, texture } = scores;
    for number in [next.gain, coverage, geometry, diversity, texture] {
        write!(out, " {:08x}", number.to_bits())?;
    }
    writeln!(out)
}

/// Changes a byte in the middle, and back.
fn flip(bytes: &mut [u8]) {
    let middle = bytes.len() / 2;
    if let Some(byte) = bytes.get_mut(middle) {
        *byte ^= 0x10;
    }
}

/// A short number that stands for many: FNV-1a.
fn digest(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193))
}
