//! Candidate pools, and whole plans that look at poses alone.

use core::fmt::{self, Write};

use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::{Blind, Finish, Fixed, NextView, Plan, Session};

use crate::{Bits, line};

const CANDIDATES: usize = 48;

type Memory = Fixed<CANDIDATES, 16>;

const SPACES: [(&str, ViewSpace); 5] = [
    ("random sphere", ViewSpace::RandomSphere { seed: 7 }),
    ("fibonacci sphere", ViewSpace::FibonacciSphere),
    ("hemisphere", ViewSpace::Hemisphere { min_elevation_rad: 0.1, max_elevation_rad: 1.2 }),
    ("rings", ViewSpace::Rings { rings: 3, min_elevation_rad: -0.2, max_elevation_rad: 0.9 }),
    ("spiral", ViewSpace::Spiral { turns: 4.0, min_elevation_rad: 0.0, max_elevation_rad: 1.5 }),
];

/// Camera centres of every view space.
pub fn candidates(out: &mut dyn Write) -> fmt::Result {
    for (name, space) in SPACES {
        writeln!(out, "{name}")?;
        let Ok(pool) = Pool::try_new(space, 12, 1.5) else {
            writeln!(out, "refused")?;
            continue;
        };
        for (index, pose) in pool.iter().enumerate() {
            let p = pose.position();
            line(out, format_args!("  {index}"), &[p.x, p.y, p.z])?;
        }
    }
    Ok(())
}

/// Plans that look at poses alone, with a blocked and a skipped view on the way.
pub fn blind(out: &mut dyn Write) -> fmt::Result {
    let plans = [
        ("random", Plan::random(10).with_seed(5)),
        ("farthest point", Plan::farthest_point(10).with_seed(5)),
        ("pseudo-coverage", Plan::pseudo_coverage(10)),
        ("farthest point, movement costs 0.8", Plan::farthest_point(10).with_movement_cost(0.8)),
    ];
    for (name, plan) in plans {
        for (space_name, space) in SPACES {
            writeln!(out, "{name}, {space_name}")?;
            let Ok(pool) = Pool::try_new(space, CANDIDATES, 1.5) else { continue };
            match Session::try_new(Memory::default(), pool.iter(), Blind, plan) {
                Ok(mut session) => {
                    carry_out(out, &mut session)?;
                    tour(out, &session)?;
                }
                Err(error) => writeln!(out, "refused: {error}")?,
            }
        }
    }
    Ok(())
}

/// Takes every view but the third, which is blocked, and the fifth, which is skipped once.
fn carry_out(out: &mut dyn Write, session: &mut Session<Blind, Memory>) -> fmt::Result {
    let mut asked = 0;
    while let Some(NextView { index, pose, gain, .. }) = session.next_view() {
        asked += 1;
        let refused = match asked {
            3 => session.block(index).is_err(),
            5 => session.skip(index).is_err(),
            _ => session.observe(index, pose, &()).is_err(),
        };
        let mark = match (refused, asked) {
            (true, _) => " refused",
            (false, 3) => " blocked",
            (false, 5) => " skipped",
            _ => "",
        };
        writeln!(out, "  {index} {}{mark}", Bits(gain))?;
        if refused {
            break;
        }
    }
    let end = match session.finish() {
        Some(Finish::BudgetSpent) => "budget spent",
        Some(Finish::GoodEnough) => "good enough",
        Some(Finish::NothingLeft) => "nothing left",
        None => "not over",
    };
    writeln!(out, "  {end}")
}

/// The way through the first candidates that were not visited.
fn tour(out: &mut dyn Write, session: &Session<Blind, Memory>) -> fmt::Result {
    let mut remaining = [0; 12];
    let left = session.candidates().iter().enumerate().filter(|(_, c)| c.is_available());
    let mut count = 0;
    for (place, (index, _)) in remaining.iter_mut().zip(left) {
        *place = index;
        count += 1;
    }
    let order = remaining.get_mut(..count).unwrap_or_default();
    let length = session.order_by_travel(order);
    write!(out, "  tour {}", Bits(length))?;
    for index in order {
        write!(out, " {index}")?;
    }
    writeln!(out)
}
