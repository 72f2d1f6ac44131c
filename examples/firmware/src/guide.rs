//! The loop of a capture: ask where to stand, go there, take a photo, tell the planner.

use core::fmt;

use vantage_core::planner::{Finish, Memory, NextView, Scorer, Session};
use vantage_core::soarnet::Photo;
use vantage_core::{Pose, Scores, Vec3};

use crate::place::{Place, wrapped};
use crate::rig::{Camera, Cue, Indicator, Miss, Mount, Rig};

/// What came of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// A photo, and the session took it in.
    Photo,
    /// The mount cannot get there: the view is blocked.
    OutOfReach,
    /// The mount did not get there this time, or the camera took no photo: the view is skipped.
    Missed,
    /// The session cannot use the photo or the pose: the view is skipped.
    Refused,
}

/// A view that was asked for, and what came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The view.
    pub next: NextView,
    /// What came of it.
    pub outcome: Outcome,
    /// Scores of all views so far.
    pub scores: Scores,
}

/// How a capture ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guidance<E> {
    /// The planner has no next view.
    Finished(Finish),
    /// The mount is broken; the session goes on where it stands, once it is mended.
    Broken(E),
}

impl<E: fmt::Debug> fmt::Display for Guidance<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finished(Finish::BudgetSpent) => f.write_str("budget spent"),
            Self::Finished(Finish::GoodEnough) => f.write_str("good enough"),
            Self::Finished(Finish::NothingLeft) => f.write_str("nothing left"),
            Self::Broken(error) => write!(f, "the mount is broken: {error:?}"),
        }
    }
}

/// Carries a session out with a rig. `frame` is where the camera puts its photos; `report` is called
/// after each view, with the session as it stands: the place to keep a snapshot.
pub fn guide<S, L, C, M, I>(
    session: &mut Session<S, L>,
    rig: &mut Rig<C, M, I>,
    frame: &mut [u8],
    mut report: impl FnMut(&Session<S, L>, &Step),
) -> Guidance<M::Error>
where
    S: for<'p> Scorer<Shot<'p> = Photo<'p>>,
    L: Memory,
    C: Camera,
    M: Mount,
    I: Indicator,
{
    while let Some(next) = session.next_view() {
        let last = session.views().last().map(|view| view.pose);
        rig.indicator.show(way(last, &next.pose, session.plan().centre()));
        let outcome = match rig.mount.move_to(&next.pose) {
            Ok(reached) => {
                rig.indicator.show(Cue::Photo);
                match rig.camera.photograph(frame) {
                    Ok(photo) => match session.observe(next.index, reached, &photo) {
                        Ok(()) => Outcome::Photo,
                        Err(_) => Outcome::Refused,
                    },
                    Err(_) => Outcome::Missed,
                }
            }
            Err(Miss::OutOfReach) => Outcome::OutOfReach,
            Err(Miss::NotNow) => Outcome::Missed,
            Err(Miss::Broken(error)) => return Guidance::Broken(error),
        };
        // Of a candidate that the session itself has named, neither can fail.
        match outcome {
            Outcome::Photo => {}
            Outcome::OutOfReach => session.block(next.index).unwrap_or_default(),
            Outcome::Missed | Outcome::Refused => session.skip(next.index).unwrap_or_default(),
        }
        if outcome != Outcome::Photo {
            rig.indicator.show(Cue::Missed);
        }
        #[cfg(feature = "defmt")]
        defmt::info!("view {}: {}, gain {}", next.index, outcome, next.gain);
        report(session, &Step { next, outcome, scores: session.scores() });
    }
    // There is no next view, so there is a reason.
    let finish = session.finish().unwrap_or(Finish::NothingLeft);
    rig.indicator.show(Cue::Done(finish));
    Guidance::Finished(finish)
}

/// Where to go from the last view; nowhere from none.
fn way(last: Option<Pose>, next: &Pose, centre: Vec3) -> Cue {
    let from = last.and_then(|pose| Place::of(&pose, centre));
    let to = Place::of(next, centre).unwrap_or_default();
    let from = from.unwrap_or(to);
    Cue::Move {
        right_rad: wrapped(to.azimuth_rad - from.azimuth_rad),
        up_rad: to.elevation_rad - from.elevation_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;
    use std::vec::Vec;
    use vantage_core::candidates::{Pool, ViewSpace};
    use vantage_core::planner::{self, Plan, Status};

    /// A scorer that takes photos and learns nothing.
    struct Nothing;

    impl Scorer for Nothing {
        type Shot<'p> = Photo<'p>;
        type Error = core::convert::Infallible;

        fn observe(&mut self, _: &Pose, _: &Photo<'_>) -> Result<(), Self::Error> {
            Ok(())
        }

        fn gain(&self, _: vantage_core::Objective, _: usize, _: &Pose) -> f32 {
            0.0
        }

        fn scores(&self) -> Scores {
            Scores::default()
        }
    }

    /// Answers as told, then always with the pose asked for.
    #[derive(Default)]
    struct Told(VecDeque<Result<(), Miss<&'static str>>>, VecDeque<bool>, Vec<Cue>);

    impl Mount for Told {
        type Error = &'static str;

        fn move_to(&mut self, pose: &Pose) -> Result<Pose, Miss<Self::Error>> {
            self.0.pop_front().unwrap_or(Ok(())).map(|()| *pose)
        }
    }

    impl Camera for Told {
        type Error = ();

        fn photograph<'f>(&mut self, _: &'f mut [u8]) -> Result<Photo<'f>, ()> {
            if self.1.pop_front().unwrap_or(true) { Ok(Photo::default()) } else { Err(()) }
        }
    }

    impl Indicator for Told {
        fn show(&mut self, cue: Cue) {
            self.2.push(cue);
        }
    }

    type Capture = Session<Nothing, planner::Fixed<12, 4>>;

    fn session() -> Capture {
        let pool = Pool::try_new(ViewSpace::FibonacciSphere, 12, 1.0).unwrap();
        let plan = Plan::farthest_point(4);
        Session::try_new(planner::Fixed::default(), pool.iter(), Nothing, plan).unwrap()
    }

    fn rig(moves: &[Result<(), Miss<&'static str>>], photos: &[bool]) -> Rig<Told, Told, Told> {
        Rig {
            camera: Told(VecDeque::new(), photos.iter().copied().collect(), Vec::new()),
            mount: Told(moves.iter().copied().collect(), VecDeque::new(), Vec::new()),
            indicator: Told::default(),
        }
    }

    #[test]
    fn what_is_out_of_reach_is_blocked_and_what_is_missed_comes_again() {
        let mut session = session();
        let mut rig =
            rig(&[Err(Miss::OutOfReach), Ok(()), Err(Miss::NotNow)], &[true, false, true]);
        let mut outcomes = Vec::new();
        let end = guide(&mut session, &mut rig, &mut [], |_, step| {
            outcomes.push((step.next.index, step.outcome));
        });
        assert_eq!(end, Guidance::Finished(Finish::BudgetSpent));
        let kinds: Vec<Outcome> = outcomes.iter().map(|(_, outcome)| *outcome).collect();
        use Outcome::{Missed, OutOfReach, Photo};
        assert_eq!(kinds, [OutOfReach, Photo, Missed, Missed, Photo, Photo, Photo]);
        let blocked = outcomes[0].0;
        assert_eq!(session.candidates()[blocked].status(), Status::Blocked);
        // The two that were missed are open again, or were taken since.
        for (index, _) in &outcomes[2..4] {
            let status = session.candidates()[*index].status();
            assert!(matches!(status, Status::Available | Status::Visited));
        }
        assert_eq!(rig.indicator.2.last(), Some(&Cue::Done(Finish::BudgetSpent)));
        assert_eq!(rig.indicator.2.iter().filter(|&&cue| cue == Cue::Missed).count(), 3);
        assert_eq!(rig.indicator.2.iter().filter(|&&cue| cue == Cue::Photo).count(), 5);
    }

    #[test]
    fn a_broken_mount_ends_the_capture_and_not_the_session() {
        let mut session = session();
        let mut rig = rig(&[Ok(()), Err(Miss::Broken("driver hot"))], &[]);
        let end = guide(&mut session, &mut rig, &mut [], |_, _| {});
        assert_eq!(end, Guidance::Broken("driver hot"));
        assert_eq!(session.views().len(), 1);
        let end = guide(&mut session, &mut rig, &mut [], |_, _| {});
        assert_eq!(end, Guidance::Finished(Finish::BudgetSpent));
    }

    #[test]
    fn a_rig_that_reaches_nothing_ends() {
        let mut session = session();
        let mut rig = rig(&[Err(Miss::NotNow); 12], &[]);
        let mut steps = 0;
        let end = guide(&mut session, &mut rig, &mut [], |_, _| steps += 1);
        assert_eq!((end, steps), (Guidance::Finished(Finish::NothingLeft), 12));
    }

    #[test]
    fn the_way_is_the_shorter_one_around_and_right_is_right() {
        let pose = |azimuth_rad, elevation_rad| {
            Place { azimuth_rad, elevation_rad }.pose(Vec3::ZERO, 1.0).unwrap()
        };
        let from = pose(3.0, 0.2);
        let Cue::Move { right_rad, up_rad } = way(Some(from), &pose(-3.0, 0.5), Vec3::ZERO) else {
            panic!("a move")
        };
        assert!((right_rad - (core::f32::consts::TAU - 6.0)).abs() < 1e-5);
        assert!((up_rad - 0.3).abs() < 1e-5);
        // To the right is where the camera's own right points.
        let to = pose(3.0 + right_rad, 0.2);
        assert!((to.position() - from.position()).dot(from.right()) > 0.0);
    }
}
