//! Whole plans over a recorded visibility table: every scheme in both readings, sessions in which
//! things go wrong, and snapshots.

use core::fmt::{self, Write};

use vantage_core::candidates::Pool;
use vantage_core::objectives::{FaceAccount, Ledger, Reading, Sighting, Surface};
use vantage_core::planner::{Fixed, NextView, Plan, Session, Start, Stop};
use vantage_core::{Exact, Objective, Scores};

use crate::scene::{self, CANDIDATES, FACES};
use crate::{Bits, line};

type Room = Fixed<CANDIDATES, 40>;
type SceneSession<'a> = Session<Exact<'a>, Room>;

/// The plans that are made over the scene.
const PLANS: usize = 16;

fn plans() -> [(&'static str, Plan); PLANS] {
    [
        ("e 20", Plan::ensemble(20)),
        ("e 6", Plan::ensemble(6)),
        ("e pseudo-coverage 12", Plan::ensemble(12).with_start(Start::PseudoCoverage)),
        ("e literal 12", Plan::literal_ensemble(12)),
        ("e movement 0.5 12", Plan::ensemble(12).with_movement_cost(0.5)),
        ("e stop 30", Plan::ensemble(30).with_stop(Stop { gain: 0.02, patience: 6 })),
        ("c 12", Plan::single(Objective::Coverage, 12)),
        ("c movement 0.3 12", Plan::single(Objective::Coverage, 12).with_movement_cost(0.3)),
        ("q 12", Plan::single(Objective::Geometry, 12)),
        ("d 12", Plan::single(Objective::Diversity, 12)),
        ("t 12", Plan::single(Objective::Texture, 12)),
        ("sum 12", Plan::sum(12)),
        ("fps 12", Plan::farthest_point(12)),
        ("pc-fps 12", Plan::pseudo_coverage(12)),
        ("random 12", Plan::random(12)),
        ("e seed 7 12", Plan::ensemble(12).with_seed(7)),
    ]
}

/// Every scheme in the default and in the literal reading.
pub fn schemes(out: &mut dyn Write) -> fmt::Result {
    for (reading_name, reading) in
        [("default", Reading::default()), ("literal", Reading::literal())]
    {
        for (name, plan) in plans() {
            writeln!(out, "{name}, {reading_name} reading")?;
            over_scene(out, reading, plan, |out, session| {
                carry_on(out, session, usize::MAX)?;
                writeln!(out, "  {:?}", session.finish())
            })?;
        }
    }
    Ok(())
}

/// Blocked, skipped and missed views, and a change of plan half way.
pub fn mishaps(out: &mut dyn Write) -> fmt::Result {
    over_scene(out, Reading::default(), Plan::ensemble(16), |out, session| {
        for step in 0.. {
            let Some(next) = session.next_view() else { break };
            match step % 5 {
                1 => {
                    writeln!(out, "  {} blocked {}", next.index, session.block(next.index).is_ok())?
                }
                3 => {
                    writeln!(out, "  {} skipped {}", next.index, session.skip(next.index).is_ok())?
                }
                // A neighbour of the view asked for was reached, and shows something else.
                2 => take(out, session, &next, (next.index + 1) % CANDIDATES)?,
                _ => take(out, session, &next, next.index)?,
            }
            if step == 11 {
                let replanned = session.replan(Plan::sum(14).with_movement_cost(0.2)).is_ok();
                writeln!(out, "  replanned {replanned}")?;
            }
        }
        let mut rest = [9, 30, 2, 17, 44, 23, 5];
        let length = session.order_by_travel(&mut rest);
        writeln!(out, "  tour {rest:?} {}", Bits(length))
    })
}

/// A snapshot after every step, as length and checksum; then the plan that goes on from the fifth.
pub fn snapshots(out: &mut dyn Write) -> fmt::Result {
    let mut kept = [0u8; 24 * 1024];
    let mut used = 0;
    over_scene(out, Reading::default(), Plan::ensemble(9).with_seed(3), |out, session| {
        for _ in 0..5 {
            carry_on(out, session, 1)?;
            match session.snapshot(&mut kept) {
                Ok(length) => {
                    used = length;
                    let checksum = kept.get(..length).and_then(<[u8]>::last_chunk::<4>);
                    let checksum = checksum.map_or(0, |bytes| u32::from_le_bytes(*bytes));
                    writeln!(out, "  {length} bytes, checksum {checksum:08x}")?;
                }
                Err(error) => writeln!(out, "  not written: {error}")?,
            }
        }
        Ok(())
    })?;

    let mut accounts = [FaceAccount::default(); FACES];
    let scorer = scorer(Reading::default(), &mut accounts)?;
    let bytes = kept.get(..used).unwrap_or_default();
    match Session::restore(Room::default(), scorer, bytes) {
        Ok(mut session) => {
            writeln!(out, "  restored")?;
            carry_on(out, &mut session, usize::MAX)
        }
        Err(error) => writeln!(out, "  not restored: {error}"),
    }
}

/// Takes up to `most` views where they are asked for.
fn carry_on(out: &mut dyn Write, session: &mut SceneSession<'_>, most: usize) -> fmt::Result {
    for _ in 0..most {
        let Some(next) = session.next_view() else { break };
        take(out, session, &next, next.index)?;
    }
    Ok(())
}

/// Takes a view where candidate `reached` stands; a line of index, objective, gain and scores.
fn take(
    out: &mut dyn Write,
    session: &mut SceneSession<'_>,
    next: &NextView,
    reached: usize,
) -> fmt::Result {
    let pose = session.candidate(reached).map(|candidate| *candidate.pose());
    let taken = match (pose, scene::SIGHTINGS.get(reached)) {
        (Ok(pose), Some(seen)) => session.observe(next.index, pose, seen).is_ok(),
        _ => false,
    };
    let letter = next.objective.map_or('-', Objective::letter);
    let Scores { coverage, geometry, diversity, texture } = session.scores();
    let numbers = [next.gain, coverage, geometry, diversity, texture];
    let refused = if taken { "" } else { " refused" };
    line(out, format_args!("  {} {letter}{refused}", next.index), &numbers)
}

/// Runs `act` with a session over the scene.
fn over_scene(
    out: &mut dyn Write,
    reading: Reading,
    plan: Plan,
    mut act: impl FnMut(&mut dyn Write, &mut SceneSession<'_>) -> fmt::Result,
) -> fmt::Result {
    let mut accounts = [FaceAccount::default(); FACES];
    let scorer = scorer(reading, &mut accounts)?;
    let Ok(pool) = Pool::try_new(scene::SPACE, CANDIDATES, scene::DISTANCE_M) else {
        return writeln!(out, "  the pool is refused");
    };
    match Session::try_new(Room::default(), pool.iter(), scorer, plan) {
        Ok(mut session) => act(out, &mut session),
        Err(error) => writeln!(out, "  refused: {error}"),
    }
}

fn scorer(reading: Reading, accounts: &mut [FaceAccount; FACES]) -> Result<Exact<'_>, fmt::Error> {
    let sightings: &'static [Sighting<'static>] = &scene::SIGHTINGS;
    let surface =
        Surface::try_new(&scene::SURFACE, scene::TEXTURE_LIMIT).map_err(|_| fmt::Error)?;
    let ledger = Ledger::try_new(surface, reading, accounts).map_err(|_| fmt::Error)?;
    Ok(Exact::new(ledger, sightings))
}
