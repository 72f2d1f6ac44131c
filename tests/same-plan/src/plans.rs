//! Whole plans: which views are chosen, in which order, with which gains, and what they score.

use core::fmt::{self, Write};

use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::{
    Face, FaceAccount, FaceSet, Ledger, Reading, Sighting, Surface, SurfaceError, WrongLength,
};
use vantage_core::planner::{
    Blind, Finish, Fixed, NextView, Plan, Scorer, Session, SessionError, Start, Stop,
};
use vantage_core::{Exact, Objective, Pose, Vec3};

use crate::{Bits, line};

const CANDIDATES: usize = 48;
const VIEWS: usize = 16;
const FACES: usize = 160;
const WORDS: usize = FaceSet::words_for(FACES);

type Memory = Fixed<CANDIDATES, VIEWS>;

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
                    carry_out(out, &mut session, |_, _| Some(()))?;
                    tour(out, &session)?;
                }
                Err(error) => writeln!(out, "refused: {error}")?,
            }
        }
    }
    Ok(())
}

/// Plans over the exact scores of a bumpy ball, both readings.
pub fn exact(out: &mut dyn Write) -> fmt::Result {
    let plans = [
        ("ensemble", Plan::ensemble(12)),
        ("ensemble to the letter", Plan::literal_ensemble(12)),
        ("coverage", Plan::single(Objective::Coverage, 12)),
        ("geometry", Plan::single(Objective::Geometry, 8)),
        ("diversity", Plan::single(Objective::Diversity, 8)),
        ("texture", Plan::single(Objective::Texture, 8)),
        ("sum", Plan::sum(12)),
        (
            "ensemble, movement costs 0.5, stops",
            Plan::ensemble(VIEWS)
                .with_movement_cost(0.5)
                .with_start(Start::PseudoCoverage)
                .with_stop(Stop { gain: 0.05, patience: 2 }),
        ),
    ];
    for (reading_name, reading) in
        [("default", Reading::default()), ("literal", Reading::literal())]
    {
        for (name, plan) in plans {
            writeln!(out, "{name}, {reading_name} reading")?;
            if let Err(refusal) = over_ball(out, reading, plan) {
                writeln!(out, "refused: {refusal}")?;
            }
        }
    }
    Ok(())
}

/// Why a plan over the ball could not begin, or the writer's own error.
enum Refusal {
    Surface(SurfaceError),
    Accounts(WrongLength),
    Session(SessionError),
    NoPool,
    Writer,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Surface(error) => error.fmt(f),
            Self::Accounts(error) => error.fmt(f),
            Self::Session(error) => error.fmt(f),
            Self::NoPool => f.write_str("the pool is refused"),
            Self::Writer => Err(fmt::Error),
        }
    }
}

fn over_ball(out: &mut dyn Write, reading: Reading, plan: Plan) -> Result<(), Refusal> {
    let pool =
        Pool::try_new(ViewSpace::FibonacciSphere, CANDIDATES, 2.5).map_err(|_| Refusal::NoPool)?;
    let ball = Ball::new();
    let shown: [Shown; CANDIDATES] =
        core::array::from_fn(|index| pool.pose(index).map_or(Shown::NOTHING, |p| ball.seen(&p)));
    let sightings = shown.each_ref().map(Shown::sighting);
    let surface = Surface::try_new(&ball.faces, 0.05).map_err(Refusal::Surface)?;
    let mut accounts = [FaceAccount::default(); FACES];
    let ledger = Ledger::try_new(surface, reading, &mut accounts).map_err(Refusal::Accounts)?;
    let scorer = Exact::new(ledger, &sightings);
    let mut session =
        Session::try_new(Memory::default(), pool.iter(), scorer, plan).map_err(Refusal::Session)?;
    carry_out(out, &mut session, |index, _| sightings.get(index).copied())
        .map_err(|_| Refusal::Writer)
}

/// Takes every view but the third, which is blocked, and the fifth, which is skipped once.
fn carry_out<S: Scorer<Shot: Sized>>(
    out: &mut dyn Write,
    session: &mut Session<S, Memory>,
    shoot: impl Fn(usize, &Pose) -> Option<S::Shot>,
) -> fmt::Result {
    let mut asked = 0;
    while let Some(NextView { index, pose, objective, gain, .. }) = session.next_view() {
        asked += 1;
        let refused = match asked {
            3 => session.block(index).is_err(),
            5 => session.skip(index).is_err(),
            _ => {
                let shot = shoot(index, &pose);
                shot.is_none_or(|shot| session.observe(index, pose, &shot).is_err())
            }
        };
        let mark = match (refused, asked) {
            (true, _) => " refused",
            (false, 3) => " blocked",
            (false, 5) => " skipped",
            _ => "",
        };
        let letter = objective.map_or('-', Objective::letter);
        writeln!(out, "  {index} {letter} {}{mark}", Bits(gain))?;
        if refused {
            break;
        }
    }
    let scores = Objective::ALL.map(|objective| session.scores().get(objective));
    let end = match session.finish() {
        Some(Finish::BudgetSpent) => "budget spent",
        Some(Finish::GoodEnough) => "good enough",
        Some(Finish::NothingLeft) => "nothing left",
        None => "not over",
    };
    line(out, format_args!("  {end}"), &scores)
}

/// The way through the first candidates that were not visited.
fn tour<S: Scorer>(out: &mut dyn Write, session: &Session<S, Memory>) -> fmt::Result {
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

/// A ball of radius 1 around the origin whose faces differ in area, complexity and texture.
struct Ball {
    faces: [Face; FACES],
}

impl Ball {
    fn new() -> Self {
        let nothing =
            Face { centroid: Vec3::ZERO, normal: Vec3::Z, area_share: 0.0, complexity: 0.0 };
        let mut faces = [nothing; FACES];
        // The pool's lattice serves for the faces too; weights 1, 2, 3, 1, … add up to the divisor.
        let weight = |index: usize| (index % 3 + 1) as f32;
        let total: f32 = (0..FACES).map(weight).sum();
        if let Ok(lattice) = Pool::try_new(ViewSpace::FibonacciSphere, FACES, 1.0) {
            for (index, (face, pose)) in faces.iter_mut().zip(lattice.iter()).enumerate() {
                let normal = -pose.forward();
                let complexity = (index * 7 % 11) as f32 / 11.0;
                let area_share = weight(index) / total;
                *face = Face { centroid: normal, normal, area_share, complexity };
            }
        }
        Self { faces }
    }

    /// What a convex ball shows: the faces turned towards the camera.
    fn seen(&self, pose: &Pose) -> Shown {
        let mut shown = Shown::NOTHING;
        for (index, face) in self.faces.iter().enumerate() {
            if (pose.position() - face.centroid).dot(face.normal) > 0.0 {
                if let Some(word) = shown.words.get_mut(index / 32) {
                    *word |= 1 << (index % 32);
                }
                if let Some(place) = shown.textured.get_mut(shown.count) {
                    *place = (index * 13 % 17) as u32;
                }
                shown.count += 1;
            }
        }
        shown
    }
}

/// The memory behind one [`Sighting`].
#[derive(Clone, Copy)]
struct Shown {
    words: [u32; WORDS],
    textured: [u32; FACES],
    count: usize, // faces seen
}

impl Shown {
    const NOTHING: Self = Self { words: [0; WORDS], textured: [0; FACES], count: 0 };

    fn sighting(&self) -> Sighting<'_> {
        Sighting {
            faces: FaceSet::new(&self.words),
            textured: self.textured.get(..self.count).unwrap_or_default(),
            textured_background: 0,
            pixels: 2000,
        }
    }
}
