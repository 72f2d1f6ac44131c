//! The planner as its caller meets it: what it chooses, how often it asks, and what it refuses.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use core::cell::Cell;
use core::convert::Infallible;
use core::fmt;
use std::collections::HashSet;

use common::{Chance, Room, Scene, follow};
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::math::angle_between;
use vantage_core::objectives::{Reading, Sighting};
use vantage_core::planner::{
    Blind, ENSEMBLE, Finish, Fixed, NextView, ObserveError, Phase, Plan, PlanError, Reason, Scheme,
    Scorer, Session, SessionError, Status, Stop,
};
use vantage_core::{Exact, Objective, Pose, Scores, Vec3};

/// The exact scorer, counting how often it is asked; not lazy, it denies that gains diminish.
struct Counted<'a> {
    exact: Exact<'a>,
    is_lazy: bool,
    asks: Cell<usize>,
}

impl<'a> Scorer for Counted<'a> {
    type Shot<'s> = Sighting<'a>;
    type Error = Infallible;

    fn observe(&mut self, pose: &Pose, shot: &Sighting<'a>) -> Result<(), Infallible> {
        self.exact.observe(pose, shot)
    }

    fn gain(&self, objective: Objective, index: usize, pose: &Pose) -> f32 {
        self.asks.set(self.asks.get() + 1);
        self.exact.gain(objective, index, pose)
    }

    fn diminishes(&self, objective: Objective) -> bool {
        self.is_lazy && self.exact.diminishes(objective)
    }

    fn scores(&self) -> Scores {
        self.exact.scores()
    }
}

/// A capture to the end; with `trouble`, candidates are blocked, freed, skipped and photographed
/// unasked along the way. Gives what was chosen and the number of asks.
fn capture(
    scene: &Scene,
    reading: Reading,
    plan: Plan,
    is_lazy: bool,
    trouble: Option<u64>,
) -> (Vec<NextView>, usize) {
    let (sightings, mut accounts) = (scene.sightings(), scene.accounts());
    let exact = scene.exact(reading, &sightings, &mut accounts);
    let scorer = Counted { exact, is_lazy, asks: Cell::new(0) };
    let mut session = Session::try_new(Room::default(), scene.poses(), scorer, plan).unwrap();
    let mut chance = trouble.map(Chance::new);
    let mut chosen = Vec::new();
    let mut patience = 500;
    while let Some(next) = session.next_view() {
        chosen.push(next);
        patience -= 1;
        let (index, taken) = (next.index, &sightings[next.index]);
        match chance.as_mut().filter(|_| patience > 0) {
            None => session.observe(index, next.pose, taken).unwrap(),
            Some(chance) => {
                let other = chance.below(sightings.len());
                match chance.below(8) {
                    0 => session.skip(index).unwrap(),
                    1 => session.block(index).unwrap(),
                    2 => session.block(other).unwrap(),
                    3 => session.unblock(other).unwrap(),
                    // The photo of another pose than the one asked for.
                    4 => session.observe(index, next.pose, &sightings[other]).unwrap(),
                    5 => session.observe_elsewhere(next.pose, taken).unwrap(),
                    _ => session.observe(index, next.pose, taken).unwrap(),
                }
            }
        }
    }
    (chosen, session.scorer().asks.get())
}

#[test]
fn lazy_greedy_chooses_what_plain_greedy_chooses_and_asks_less() {
    let readings: [fn() -> Reading; 2] = [Reading::default, Reading::literal];
    // By budget and objective.
    let (mut lazy_asks, mut plain_asks) = ([[0usize; 4]; 2], [[0usize; 4]; 2]);
    for (objective, seed) in [Objective::Coverage, Objective::Geometry, Objective::Texture]
        .into_iter()
        .flat_map(|o| (0..6).map(move |seed| (o, seed)))
    {
        let scene = Scene::ball(200, 60, seed);
        for (reading, cost) in readings.iter().flat_map(|r| [0.0, 0.4, 1.0].map(|c| (r(), c))) {
            for (budget, trouble) in [(12, None), (60, None), (60, Some(seed))] {
                let plan = Plan::single(objective, budget).with_seed(seed);
                let plan = plan.with_movement_cost(cost);
                let (lazy, fewer) = capture(&scene, reading, plan, true, trouble);
                let (plain, more) = capture(&scene, reading, plan, false, trouble);
                assert_eq!(lazy, plain, "{plan:?} {reading:?}");
                assert!(fewer <= more);
                if reading == Reading::default() && cost == 0.0 && trouble.is_none() {
                    lazy_asks[usize::from(budget == 60)][objective as usize] += fewer;
                    plain_asks[usize::from(budget == 60)][objective as usize] += more;
                }
            }
        }
    }
    // Least is saved where every candidate is taken in the end: each must be asked again then.
    for (place, budget, limits) in [(0, 12, [0.5, 0.7, 1.0, 0.65]), (1, 60, [0.25, 0.7, 1.0, 0.65])]
    {
        for objective in [Objective::Coverage, Objective::Geometry, Objective::Texture] {
            let (lazy, plain) =
                (lazy_asks[place][objective as usize], plain_asks[place][objective as usize]);
            let share = lazy as f32 / plain as f32;
            println!("{objective}, {budget} of 60 views: {share:.3} = {lazy} of {plain} asks");
            assert!(share < limits[objective as usize], "{objective}: {lazy} of {plain}");
        }
    }
}

#[test]
fn a_lazy_ensemble_chooses_what_a_plain_one_chooses() {
    for seed in 0..6 {
        let scene = Scene::ball(150, 50, seed);
        for (plan, trouble) in
            [Plan::ensemble(50), Plan::literal_ensemble(50).with_movement_cost(0.7)]
                .into_iter()
                .flat_map(|plan| [(plan, None), (plan, Some(seed))])
        {
            let (lazy, fewer) = capture(&scene, Reading::default(), plan, true, trouble);
            let (plain, more) = capture(&scene, Reading::default(), plan, false, trouble);
            assert_eq!(lazy, plain);
            assert!(fewer < more);
        }
    }
}

#[test]
fn each_step_takes_the_highest_gain() {
    let scene = Scene::ball(100, 40, 8);
    let sightings = scene.sightings();
    for objective in Objective::ALL {
        let (mut accounts, mut shadow) = (scene.accounts(), scene.accounts());
        let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
        let plan = Plan::single(objective, 40);
        let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
        let mut ledger = scene.ledger(Reading::default(), &mut shadow);
        let mut left: Vec<usize> = (0..40).collect();
        while let Some(next) = session.next_view() {
            if session.views().len() >= Plan::START_VIEWS {
                let gain = |&index: &usize| {
                    ledger.gain(objective, scene.photos[index].camera, &sightings[index])
                };
                let highest = left.iter().map(gain).fold(f32::NEG_INFINITY, f32::max);
                let expected = left.iter().copied().find(|index| gain(index) == highest);
                assert_eq!((Some(next.index), next.gain), (expected, highest));
                assert_eq!(next.reason, Reason::Objective(objective));
            }
            session.observe(next.index, next.pose, &sightings[next.index]).unwrap();
            ledger.add(next.pose.position(), &sightings[next.index]);
            left.retain(|&index| index != next.index);
        }
        assert!(left.is_empty());
    }
}

#[test]
fn the_sum_scheme_takes_the_highest_sum_of_gains_over_their_ranges() {
    let scene = Scene::ball(100, 30, 8);
    let (sightings, mut accounts, mut shadow) =
        (scene.sightings(), scene.accounts(), scene.accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let mut session =
        Session::try_new(Room::default(), scene.poses(), exact, Plan::sum(20)).unwrap();
    let mut ledger = scene.ledger(Reading::default(), &mut shadow);
    while let Some(next) = session.next_view() {
        if session.views().len() >= Plan::START_VIEWS {
            let mut sums = [0.0f64; 30];
            for objective in Objective::ALL {
                let gain = |i: usize| ledger.gain(objective, scene.photos[i].camera, &sightings[i]);
                let open: Vec<usize> =
                    (0..30).filter(|&i| session.candidates()[i].is_available()).collect();
                let low = open.iter().map(|&i| gain(i)).fold(f32::INFINITY, f32::min);
                let high = open.iter().map(|&i| gain(i)).fold(f32::NEG_INFINITY, f32::max);
                for &i in open.iter().filter(|_| high > low) {
                    sums[i] += f64::from(gain(i) - low) / f64::from(high - low);
                }
            }
            let highest = sums.iter().copied().fold(0.0, f64::max);
            // The session sums in single precision.
            assert!(sums[next.index] > highest - 1e-6);
            let gains = Objective::ALL
                .map(|o| ledger.gain(o, next.pose.position(), &sightings[next.index]));
            assert!((next.gain - gains.iter().sum::<f32>() / 4.0).abs() < 1e-7);
            assert_eq!((next.reason, next.objective), (Reason::AllObjectives, None));
        }
        session.observe(next.index, next.pose, &sightings[next.index]).unwrap();
        ledger.add(next.pose.position(), &sightings[next.index]);
    }
}

#[test]
fn the_ensemble_goes_through_its_sequence() {
    let scene = Scene::ball(60, 20, 1);
    let sightings = scene.sightings();
    let letters = |plan: Plan| -> String {
        let mut accounts = scene.accounts();
        let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
        let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
        follow(&mut session, &sightings);
        session.views().iter().map(|view| view.objective.map_or('-', Objective::letter)).collect()
    };
    assert_eq!(ENSEMBLE.map(Objective::letter), ['C', 'Q', 'Q', 'D', 'D', 'T']);
    assert_eq!(letters(Plan::ensemble(14)), "---CQQDDTCQQDD");
    // The fourth step is number 4 of the sequence when counted from 1, modulo 6 and from 0: a D.
    assert_eq!(Plan::literal_ensemble(14).scheme(), Scheme::Ensemble(Phase::Literal));
    assert_eq!(letters(Plan::literal_ensemble(14)), "---DTCQQDDTCQQ");
}

/// One plan of each scheme.
fn every_plan(budget: usize) -> Vec<Plan> {
    let mut plans: Vec<Plan> =
        Objective::ALL.map(|objective| Plan::single(objective, budget)).into();
    plans.extend([
        Plan::ensemble(budget),
        Plan::literal_ensemble(budget),
        Plan::sum(budget),
        Plan::farthest_point(budget),
        Plan::pseudo_coverage(budget),
        Plan::random(budget),
    ]);
    plans
}

#[test]
fn every_scheme_gives_distinct_candidates_until_the_budget() {
    let scene = Scene::ball(50, 24, 6);
    let sightings = scene.sightings();
    for (plan, cost) in
        [1, 2, 11, 24].into_iter().flat_map(every_plan).zip([0.0, 0.3].iter().cycle())
    {
        let plan = plan.with_movement_cost(*cost);
        let mut accounts = scene.accounts();
        let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
        let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
        let order = follow(&mut session, &sightings);
        assert_eq!(order.len(), plan.budget(), "{plan:?}");
        assert_eq!(order.iter().collect::<HashSet<_>>().len(), order.len(), "{plan:?}");
        assert_eq!(session.finish(), Some(Finish::BudgetSpent));
        let taken: Vec<_> = session.views().iter().map(|view| view.candidate.unwrap()).collect();
        assert_eq!(taken, order);
    }
}

#[test]
fn pseudo_coverage_starts_at_the_extremes() {
    let scene = Scene::ball(1, 40, 6);
    let poses = scene.poses();
    let mut session =
        Session::try_new(Room::default(), poses.iter().copied(), Blind, Plan::pseudo_coverage(3))
            .unwrap();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let next = session.next_view().unwrap();
        assert_eq!(next.reason, Reason::Start);
        let along = |pose: &Pose| pose.position().dot(axis);
        let open = session.candidates().iter().filter(|c| c.is_available());
        assert!(open.map(|c| along(c.pose())).all(|there| there <= along(&next.pose)));
        session.observe(next.index, next.pose, &()).unwrap();
    }
}

#[test]
fn farthest_point_sampling_takes_the_farthest() {
    let poses = Scene::ball(1, 40, 6).poses();
    let plan = Plan::farthest_point(40).with_seed(3);
    let mut session =
        Session::try_new(Room::default(), poses.iter().copied(), Blind, plan).unwrap();
    let mut taken: Vec<Vec3> = Vec::new();
    while let Some(next) = session.next_view() {
        let nearest =
            |at: Vec3| taken.iter().map(|t| at.distance(*t)).fold(f32::INFINITY, f32::min);
        if !taken.is_empty() {
            let open = session.candidates().iter().filter(|c| c.is_available());
            let farthest = open.map(|c| nearest(c.pose().position())).fold(0.0, f32::max);
            let is_measured = next.reason == Reason::Farthest;
            assert!(!is_measured || (next.gain - farthest).abs() < 1e-6);
            assert!((nearest(next.pose.position()) - farthest).abs() < 1e-6);
        }
        taken.push(next.pose.position());
        session.observe(next.index, next.pose, &()).unwrap();
    }
    assert_eq!(taken.len(), 40);
}

#[test]
fn a_price_on_movement_shortens_the_way() {
    let travel = |scene: &Scene, plan: Plan| -> f32 {
        let (sightings, mut accounts) = (scene.sightings(), scene.accounts());
        let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
        let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
        follow(&mut session, &sightings);
        let at: Vec<Vec3> = session.views().iter().map(|view| view.pose.position()).collect();
        at.windows(2).map(|pair| angle_between(pair[0], pair[1])).sum()
    };
    let plans = Objective::ALL.map(|objective| Plan::single(objective, 20));
    let others = [Plan::ensemble(20), Plan::sum(20), Plan::farthest_point(20)];
    for plan in plans.into_iter().chain(others) {
        let (mut free, mut dear) = (0.0, 0.0);
        for seed in 0..8 {
            let scene = Scene::ball(100, 40, seed);
            free += travel(&scene, plan.with_seed(seed)) / 8.0;
            dear += travel(&scene, plan.with_seed(seed).with_movement_cost(1.0)) / 8.0;
        }
        println!("{:?}: {free:.1} rad without a price, {dear:.1} rad with", plan.scheme());
        assert!(dear < 0.9 * free, "{:?}: {dear} rad against {free}", plan.scheme());
    }
}

/// Expects of every candidate the same, in every objective: the next of a list after each photo.
#[derive(Debug)]
struct Promises {
    gains: &'static [f32],
    photos: usize,
}

/// A photo that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Blurred;

impl fmt::Display for Blurred {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the photo is blurred")
    }
}

impl core::error::Error for Blurred {}

impl Scorer for Promises {
    type Shot<'s> = Result<(), Blurred>;
    type Error = Blurred;

    fn observe(&mut self, _pose: &Pose, shot: &Self::Shot<'_>) -> Result<(), Blurred> {
        (*shot)?;
        self.photos += 1;
        Ok(())
    }

    fn gain(&self, _objective: Objective, _index: usize, _pose: &Pose) -> f32 {
        self.gains.get(self.photos).copied().unwrap_or_default()
    }

    fn scores(&self) -> Scores {
        Scores { coverage: self.photos as f32, ..Scores::default() }
    }
}

fn promised(gains: &'static [f32], plan: Plan) -> Session<Promises, Room> {
    let poses = Scene::ball(1, 20, 0).poses();
    Session::try_new(Room::default(), poses, Promises { gains, photos: 0 }, plan).unwrap()
}

#[test]
fn the_stop_rule_ends_a_session_that_promises_too_little() {
    let stop = Stop { gain: 0.1, patience: 2 };
    // The start is not judged; one weak promise is forgiven by the strong one after it.
    let gains = &[0.0, 0.0, 0.0, 0.5, 0.05, 0.1, 0.09, 0.05, 0.5];
    for plan in [Plan::ensemble(20), Plan::single(Objective::Texture, 20), Plan::sum(20)] {
        let mut session = promised(gains, plan.with_stop(stop));
        while let Some(next) = session.next_view() {
            assert_eq!(session.finish(), None);
            session.observe(next.index, next.pose, &Ok(())).unwrap();
        }
        assert_eq!(session.finish(), Some(Finish::GoodEnough));
        assert_eq!(session.views().len(), 8);
        // A photo that nobody promised anything of changes nothing.
        let pose = *session.candidates()[0].pose();
        session.observe_elsewhere(pose, &Ok(())).unwrap();
        assert_eq!(session.finish(), Some(Finish::GoodEnough));
        // A new plan looks anew.
        session.replan(plan.with_stop(stop)).unwrap();
        assert!(session.next_view().is_some());
    }
}

#[test]
fn the_stop_rule_ends_a_real_capture_once_all_is_seen() {
    let scene = Scene::ball(60, 60, 2);
    let (sightings, mut accounts) = (scene.sightings(), scene.accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let plan = Plan::single(Objective::Coverage, 60).with_stop(Stop { gain: 1e-6, patience: 3 });
    let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
    follow(&mut session, &sightings);
    assert_eq!(session.finish(), Some(Finish::GoodEnough));
    let views = session.views();
    assert!(views.len() < 30, "{} views", views.len());
    assert!(views[views.len() - 3..].iter().all(|view| view.gain == 0.0));
    assert!(views[3..views.len() - 3].iter().all(|view| view.gain > 0.0));
    assert!(session.scores().coverage > 0.999_99);
}

#[test]
fn a_blocked_candidate_is_never_chosen_until_unblocked() {
    let mut session = promised(&[1.0; 20], Plan::single(Objective::Coverage, 20));
    for index in (0..20).filter(|index| index % 3 > 0) {
        session.block(index).unwrap();
    }
    // Skipping does not open what is blocked.
    session.skip(1).unwrap();
    while let Some(next) = session.next_view() {
        assert_eq!(next.index % 3, 0);
        session.observe(next.index, next.pose, &Ok(())).unwrap();
    }
    assert_eq!(session.finish(), Some(Finish::NothingLeft));
    assert_eq!(session.candidate(1).unwrap().status(), Status::Blocked);
    session.unblock(7).unwrap();
    assert_eq!(session.next_view().map(|next| next.index), Some(7));
    // Neither blocking nor unblocking brings a visited one back.
    session.block(0).unwrap();
    session.unblock(0).unwrap();
    session.skip(0).unwrap();
    assert_eq!(session.candidate(0).unwrap().status(), Status::Visited);
}

#[test]
fn a_skipped_candidate_comes_back_after_the_next_photo() {
    let plan = Plan::single(Objective::Coverage, 20);
    let mut session = promised(&[1.0; 20], plan);
    for _ in 0..3 {
        let next = session.next_view().unwrap();
        session.observe(next.index, next.pose, &Ok(())).unwrap();
    }
    let passed = session.next_view().unwrap().index;
    session.skip(passed).unwrap();
    let next = session.next_view().unwrap();
    assert_ne!(next.index, passed);
    assert_eq!(session.candidate(passed).unwrap().status(), Status::Skipped);
    session.observe(next.index, next.pose, &Ok(())).unwrap();
    assert_eq!(session.candidate(passed).unwrap().status(), Status::Available);
    assert_eq!(session.next_view().unwrap().index, passed);
    // Unblocking takes a skip back at once.
    session.skip(passed).unwrap();
    session.unblock(passed).unwrap();
    assert_eq!(session.next_view().unwrap().index, passed);
    // With everything passed over there is nothing left until one is taken back.
    for index in 0..20 {
        session.skip(index).unwrap();
    }
    assert_eq!(session.finish(), Some(Finish::NothingLeft));
}

#[test]
fn asking_again_gives_the_same_view() {
    let scene = Scene::ball(50, 20, 4);
    let sightings = scene.sightings();
    for plan in every_plan(12) {
        let mut accounts = scene.accounts();
        let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
        let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
        while let Some(next) = session.next_view() {
            assert_eq!(session.next_view(), Some(next));
            assert_eq!(session.finish(), None);
            session.score_all(Objective::Geometry);
            let visited = session.views().first().and_then(|view| view.candidate);
            visited.into_iter().for_each(|index| session.block(index).unwrap());
            assert_eq!(session.next_view(), Some(next));
            session.observe(next.index, next.pose, &sightings[next.index]).unwrap();
        }
        assert_eq!(session.next_view(), None);
    }
}

#[test]
fn a_change_of_status_that_changes_nothing_leaves_the_view_that_is_due() {
    let poses = Scene::ball(1, 30, 5).poses();
    let mut session = Session::try_new(Room::default(), poses, Blind, Plan::random(5)).unwrap();
    session.block(3).unwrap();
    for _ in 0..5 {
        let next = session.next_view().unwrap();
        session.block(3).unwrap();
        session.unblock(next.index).unwrap();
        assert_eq!(session.next_view(), Some(next));
        session.observe(next.index, next.pose, &()).unwrap();
    }
}

#[test]
fn the_pose_reached_counts_and_not_the_one_asked_for() {
    // Farthest points from where the camera really stood: asked for +x, taken at -x.
    let eyes = [Vec3::X, Vec3::NEG_X, Vec3::Y * 1.1];
    let poses = eyes.map(|eye| Pose::looking_at(eye, Vec3::ZERO).unwrap());
    let mut session =
        Session::try_new(Room::default(), poses, Blind, Plan::pseudo_coverage(3)).unwrap();
    assert_eq!(session.next_view().unwrap().index, 0);
    let reached = Pose::looking_at(Vec3::new(-1.0, 0.01, 0.0), Vec3::ZERO).unwrap();
    session.observe(0, reached, &()).unwrap();
    assert_eq!(session.views()[0].pose, reached);
    assert_eq!(session.candidate(0).unwrap().status(), Status::Visited);
    session.replan(Plan::farthest_point(3)).unwrap();
    assert_eq!(session.next_view().unwrap().index, 2);
    // A photo of no candidate counts for the distances and for the budget.
    let above = Pose::looking_at(eyes[2], Vec3::ZERO).unwrap();
    session.observe_elsewhere(above, &()).unwrap();
    assert_eq!(session.views()[1].candidate, None);
    assert_eq!(session.next_view().unwrap().index, 1);
    session.observe_elsewhere(above, &()).unwrap();
    assert_eq!(session.finish(), Some(Finish::BudgetSpent));
}

#[test]
fn the_scorer_learns_where_the_photo_was_really_taken() {
    let scene = Scene::ball(60, 12, 3);
    let (sightings, mut accounts, mut shadow) =
        (scene.sightings(), scene.accounts(), scene.accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let mut session =
        Session::try_new(Room::default(), scene.poses(), exact, Plan::ensemble(8)).unwrap();
    let mut ledger = scene.ledger(Reading::default(), &mut shadow);
    let poses = scene.poses();
    for _ in 0..8 {
        let next = session.next_view().unwrap();
        let really = (next.index + 5) % 12;
        session.observe(next.index, poses[really], &sightings[really]).unwrap();
        ledger.add(poses[really].position(), &sightings[really]);
        assert_eq!(session.scores(), ledger.scores());
    }
}

#[test]
fn a_photo_of_another_candidate_than_asked_for_bears_no_objective() {
    let mut session = promised(&[1.0; 20], Plan::single(Objective::Diversity, 20));
    for _ in 0..3 {
        let next = session.next_view().unwrap();
        session.observe(next.index, next.pose, &Ok(())).unwrap();
    }
    let next = session.next_view().unwrap();
    let other = (0..20).rfind(|&i| session.candidates()[i].is_available()).unwrap();
    assert_ne!(other, next.index);
    session.observe(other, next.pose, &Ok(())).unwrap();
    let view = session.views()[3];
    assert_eq!((view.candidate, view.objective, view.gain), (Some(other), None, 0.0));
    // A visited candidate may be photographed again.
    session.observe(other, next.pose, &Ok(())).unwrap();
    assert_eq!(session.views().len(), 5);
    let next = session.next_view().unwrap();
    session.observe(next.index, next.pose, &Ok(())).unwrap();
    let view = session.views()[5];
    assert_eq!((view.objective, view.gain), (Some(Objective::Diversity), 1.0));
}

#[test]
fn a_new_plan_keeps_views_blocks_and_scores() {
    let scene = Scene::ball(60, 20, 9);
    let (sightings, mut accounts) = (scene.sightings(), scene.accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let mut session =
        Session::try_new(Room::default(), scene.poses(), exact, Plan::random(4)).unwrap();
    follow(&mut session, &sightings);
    let (views, scores) = (session.views().to_vec(), session.scores());
    let closed = (0..20).find(|&i| session.candidates()[i].is_available()).unwrap();
    session.block(closed).unwrap();
    session.replan(Plan::ensemble(12)).unwrap();
    assert_eq!((session.views(), session.scores()), (&views[..], scores));
    assert_eq!(session.plan(), &Plan::ensemble(12));
    let order = follow(&mut session, &sightings);
    assert_eq!(order.len(), 8);
    assert!(!order.contains(&closed));
    assert!(views.iter().all(|view| !order.contains(&view.candidate.unwrap())));
    // A smaller budget than views taken is already spent.
    session.replan(Plan::random(2)).unwrap();
    assert_eq!(session.finish(), Some(Finish::BudgetSpent));
}

#[test]
fn errors_leave_the_session_as_it_was() {
    let poses = Scene::ball(1, 6, 0).poses();
    let scorer = Promises { gains: &[1.0], photos: 0 };
    let plan = Plan::ensemble(4);
    let mut session =
        Session::try_new(Fixed::<6, 4>::default(), poses.iter().copied(), scorer, plan).unwrap();
    for taken in 0..=4 {
        session.next_view();
        let before = format!("{session:?}");
        let pose = poses[0];
        let unknown = SessionError::UnknownCandidate { index: 6, candidates: 6 };
        assert_eq!(session.block(6), Err(unknown));
        assert_eq!(session.unblock(6), Err(unknown));
        assert_eq!(session.skip(6), Err(unknown));
        assert_eq!(session.candidate(6).err(), Some(unknown));
        assert_eq!(session.observe(6, pose, &Ok(())), Err(ObserveError::Session(unknown)));
        let full = ObserveError::Session(SessionError::TooManyViews { capacity: 4 });
        let refused = if taken < 4 { ObserveError::Scorer(Blurred) } else { full };
        assert_eq!(session.observe(0, pose, &Err(Blurred)), Err(refused));
        assert_eq!(session.observe_elsewhere(pose, &Err(Blurred)), Err(refused));
        for (plan, error) in [
            (Plan::random(0), PlanError::ZeroBudget),
            (Plan::random(7), PlanError::BudgetTooLarge { budget: 7, candidates: 6 }),
            (Plan::sum(2).with_movement_cost(1.5), PlanError::BadMovementCost { cost: 1.5 }),
            (Plan::sum(2).with_stop(Stop { gain: -1.0, patience: 1 }), PlanError::BadStop),
            (Plan::sum(2).with_stop(Stop { gain: f32::NAN, patience: 1 }), PlanError::BadStop),
            (Plan::sum(2).with_stop(Stop { gain: 0.1, patience: 0 }), PlanError::BadStop),
            (Plan::random(2).with_stop(Stop::default()), PlanError::StopNeedsObjective),
            (Plan::sum(2).with_centre(Vec3::NAN), PlanError::BadCentre),
        ] {
            assert_eq!(session.replan(plan), Err(SessionError::Plan(error)));
        }
        let costly = session.replan(Plan::sum(2).with_movement_cost(f32::NAN));
        assert!(matches!(costly, Err(SessionError::Plan(PlanError::BadMovementCost { .. }))));
        let many = SessionError::TooManyViews { capacity: 4 };
        assert_eq!(session.replan(Plan::random(5)), Err(many));
        assert_eq!(format!("{session:?}"), before);
        if taken < 4 {
            let next = session.next_view().unwrap();
            session.observe(next.index, next.pose, &Ok(())).unwrap();
        }
    }
    assert_eq!(session.observe(0, poses[0], &Ok(())).unwrap_err().to_string(), full_text());
    let small = Session::try_new(Fixed::<5, 4>::default(), poses, Blind, Plan::random(1));
    assert_eq!(small.err(), Some(SessionError::TooManyCandidates { capacity: 5 }));
    let none = Session::try_new(Room::default(), [], Blind, Plan::random(1));
    let none = none.err();
    let nothing = PlanError::BudgetTooLarge { budget: 1, candidates: 0 };
    assert_eq!(none, Some(SessionError::Plan(nothing)));
}

fn full_text() -> String {
    SessionError::TooManyViews { capacity: 4 }.to_string()
}

/// The order in which a blind session takes 30 candidates.
fn blind_order(plan: Plan) -> Vec<usize> {
    let pool = Pool::try_new(ViewSpace::FibonacciSphere, 30, 1.0).unwrap();
    let mut session = Session::try_new(Room::default(), pool.iter(), Blind, plan).unwrap();
    let mut order = Vec::new();
    while let Some(next) = session.next_view() {
        session.observe(next.index, next.pose, &()).unwrap();
        order.push(next.index);
    }
    order
}

#[test]
fn the_same_seed_gives_the_same_plan_and_another_seed_another() {
    let seeds = 0..200u64;
    let plans: Vec<Vec<usize>> =
        seeds.clone().map(|seed| blind_order(Plan::random(10).with_seed(seed))).collect();
    let again: Vec<Vec<usize>> =
        seeds.map(|seed| blind_order(Plan::random(10).with_seed(seed))).collect();
    assert_eq!(plans, again);
    assert_eq!(plans.iter().collect::<HashSet<_>>().len(), 200);
    let far: HashSet<usize> =
        (0..200).map(|seed| blind_order(Plan::farthest_point(5).with_seed(seed))[0]).collect();
    assert_eq!(far.len(), 30);
}

#[test]
fn plans_of_neighbouring_seeds_share_no_more_than_chance_would() {
    // 10 of 30 candidates share 10/3 with another 10 on average; in 200 pairs the mean is within
    // 0.1 of that at one standard deviation.
    for apart in 1..=8 {
        let shared = |seed: u64| {
            let [a, b] = [seed, seed + apart].map(|s| blind_order(Plan::random(10).with_seed(s)));
            a.iter().filter(|index| b.contains(index)).count()
        };
        let mean = (0..200).map(shared).sum::<usize>() as f64 / 200.0;
        assert!((mean - 10.0 / 3.0).abs() < 0.4, "seeds {apart} apart share {mean} of 10 views");
    }
}

/// Pearson's sum over equally likely outcomes: about `counts.len() - 1`, spread by
/// `sqrt(2 (counts.len() - 1))`.
fn chi_square(counts: &[u32]) -> f64 {
    let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
    counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum()
}

#[test]
fn random_choices_are_even() {
    // Over seeds: the first choice of 30, the fifth, and the pair of the first two.
    let (mut first, mut fifth, mut pair) = ([0; 30], [0; 30], [0; 30 * 30]);
    // Within one session: every draw, and pairs of draws that follow each other.
    let (mut draws, mut following) = ([0; 30], [0; 30 * 30]);
    for seed in 0..9000 {
        let order = blind_order(Plan::random(5).with_seed(seed));
        first[order[0]] += 1;
        fifth[order[4]] += 1;
        pair[order[0] * 30 + order[1]] += 1;
    }
    let pool = Pool::try_new(ViewSpace::FibonacciSphere, 30, 1.0).unwrap();
    let mut session =
        Session::try_new(Room::default(), pool.iter(), Blind, Plan::random(1).with_seed(1))
            .unwrap();
    let mut before = session.next_view().unwrap().index;
    for _ in 0..9000 {
        // Skipped and taken back: two draws are settled, and every candidate is available.
        session.skip(before).unwrap();
        session.unblock(before).unwrap();
        let index = session.next_view().unwrap().index;
        draws[index] += 1;
        following[before * 30 + index] += 1;
        before = index;
    }
    // No candidate comes twice, so 30 of the 900 pairs cannot be.
    let pair: Vec<u32> =
        pair.into_iter().enumerate().filter(|(i, _)| i / 30 != i % 30).map(|(_, n)| n).collect();
    // Limits at four standard deviations either way: too even is not chance either.
    for (name, counts) in [
        ("first", &first[..]),
        ("fifth", &fifth),
        ("pair", &pair),
        ("draws", &draws),
        ("following", &following),
    ] {
        let freedom = (counts.len() - 1) as f64;
        let off = (chi_square(counts) - freedom) / (2.0 * freedom).sqrt();
        println!("{name}: {:.0} for {freedom} degrees of freedom, {off:+.1}", chi_square(counts));
        assert!(off.abs() < 4.0, "{name}: {off} standard deviations off");
    }
}

#[test]
fn every_reason_has_words() {
    let objectives = Objective::ALL.map(Reason::Objective);
    let others =
        [Reason::Start, Reason::Chance, Reason::Farthest, Reason::AllObjectives, Reason::Support];
    let words: HashSet<String> =
        objectives.into_iter().chain(others).map(|reason| reason.to_string()).collect();
    assert_eq!(words.len(), 9);
}
