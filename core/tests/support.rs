//! Support and the least distance from earlier views, by their plain definitions.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::{Chance, Room, Scene, cases};
use proptest::prelude::*;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::{Glimpse, Reading, SupportError, SupportLedger, Target};
use vantage_core::planner::{Blind, Plan, PlanError, Reason, Session};
use vantage_core::{ExactSupport, Objective, Pose, Vec3};

const CANDIDATES: usize = 40;
const VOXELS: usize = 77; // not a multiple of 32

/// Targets all over a ball, and what each candidate shows: by chance, so that bits matter.
struct Ball {
    poses: Vec<Pose>,
    targets: Vec<Target>,
    seen: Vec<Vec<u32>>,
    empty: Vec<Vec<u32>>,
}

impl Ball {
    fn new(targets: usize, seed: u64) -> Self {
        let mut chance = Chance::new(seed);
        let normals = Pool::try_new(ViewSpace::FibonacciSphere, targets, 1.0).unwrap();
        let target = |pose: Pose| {
            let normal = pose.position();
            let across = Vec3::new(chance.share(), chance.share(), chance.share()) - 0.5;
            Target { place: normal * 0.8, normal, towards: (normal + across).normalize() }
        };
        let targets: Vec<Target> = normals.iter().map(target).collect();
        let poses = Pool::try_new(ViewSpace::RandomSphere { seed }, CANDIDATES, 3.0).unwrap();
        let mut words = |bits: usize| -> Vec<Vec<u32>> {
            let mut of_one = || -> Vec<u32> {
                let mut words = vec![0; bits.div_ceil(32)];
                for bit in 0..bits {
                    words[bit / 32] |= u32::from(chance.share() < 0.4) << (bit % 32);
                }
                words
            };
            (0..CANDIDATES).map(|_| of_one()).collect()
        };
        let (seen, empty) = (words(targets.len()), words(VOXELS));
        Self { poses: poses.iter().collect(), targets, seen, empty }
    }

    fn glimpses(&self) -> Vec<Glimpse<'_>> {
        let parts = self.seen.iter().zip(&self.empty);
        parts.map(|(seen, empty)| Glimpse { seen, empty }).collect()
    }

    /// F = L + 15 V of a set of views, in double precision.
    fn value(&self, views: &[usize]) -> f64 {
        let holds = |words: &[u32], bit: usize| words[bit / 32] >> (bit % 32) & 1 == 1;
        let of_target = |(index, target): (usize, &Target)| {
            let seen = views.iter().filter(|&&view| holds(&self.seen[view], index));
            let support = seen.map(|&view| {
                let to = (self.poses[view].position() - target.place).as_dvec3().normalize();
                let facing = (2.0 * to.dot(target.normal.as_dvec3())).clamp(0.0, 1.0);
                let apart = to.dot(target.towards.as_dvec3()).clamp(-1.0, 1.0).acos().to_degrees();
                facing * (135.0 / (apart + 15.0)).powi(2)
            });
            (1.0 + support.sum::<f64>()).ln()
        };
        let angular: f64 = self.targets.iter().enumerate().map(of_target).sum();
        let is_empty = |&bit: &usize| views.iter().any(|&view| holds(&self.empty[view], bit));
        let carved = (0..VOXELS).filter(is_empty).count();
        angular / self.targets.len() as f64 + 15.0 * carved as f64 / VOXELS as f64
    }
}

#[test]
fn support_is_whole_straight_on_and_falls_with_the_angle() {
    let target = Target { place: Vec3::X, normal: Vec3::X, towards: Vec3::X };
    assert!((target.support(Vec3::X * 3.0) - 81.0).abs() < 1e-3);
    // At 45 degrees 135 / 60, at 75 degrees half facing: 2 cos 75 = 0.518.
    let at = |degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        target.support(Vec3::X + 2.0 * Vec3::new(cos, sin, 0.0))
    };
    assert!((at(45.0) - 5.0625).abs() < 1e-3);
    assert!((at(75.0) - 2.25 * 0.517_638).abs() < 1e-3);
    assert_eq!(at(100.0), 0.0);
    assert_eq!(target.support(Vec3::X), 0.0);
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn gains_are_differences_of_the_plain_definition_and_diminish(
        targets in 1usize..130, seed: u64, order in Just((0..CANDIDATES).collect::<Vec<_>>()).prop_shuffle(),
    ) {
        let ball = Ball::new(targets, seed);
        let glimpses = ball.glimpses();
        let (mut sums, mut empty) = (vec![7.0; targets], vec![7; VOXELS.div_ceil(32)]);
        let mut ledger = SupportLedger::try_new(&ball.targets, VOXELS, &mut sums, &mut empty).unwrap();
        let mut last = [f32::INFINITY; CANDIDATES];
        for step in 0..6 {
            let views = &order[..step];
            prop_assert!((f64::from(ledger.value()) - ball.value(views)).abs() < 1e-4);
            for (candidate, last) in last.iter_mut().enumerate() {
                let gain = ledger.gain(ball.poses[candidate].position(), &glimpses[candidate]);
                let all = [views, &[candidate]].concat();
                // A view again adds support, but nothing that is empty.
                let expected = if views.contains(&candidate) { f64::from(gain) }
                    else { ball.value(&all) - ball.value(views) };
                prop_assert!((f64::from(gain) - expected).abs() < 1e-4, "{gain} {expected}");
                prop_assert!(gain >= 0.0 && gain <= *last + 1e-6);
                *last = gain;
            }
            ledger.add(ball.poses[order[step]].position(), &glimpses[order[step]]);
        }
    }

    #[test]
    fn a_plan_by_support_takes_the_most_of_what_is_far_enough(
        seed: u64, share in 0.0f32..=1.0, opposite in 0.0f32..=1.0,
    ) {
        let ball = Ball::new(60, seed);
        let glimpses = ball.glimpses();
        let (mut sums, mut empty) = (vec![0.0; 60], vec![0; VOXELS.div_ceil(32)]);
        let ledger = SupportLedger::try_new(&ball.targets, VOXELS, &mut sums, &mut empty).unwrap();
        let scorer = ExactSupport::new(ledger, &glimpses);
        let plan = Plan::support(9).with_dispersion(share).with_opposite(opposite);
        let poses = ball.poses.iter().copied();
        let mut session = Session::try_new(Room::default(), poses, scorer, plan).unwrap();
        let mut views: Vec<usize> = Vec::new();
        while let Some(next) = session.next_view() {
            let away = |index: usize| {
                let from = views.iter().map(|&view| ball.poses[view].position());
                let here = ball.poses[index].position();
                let weight = if views.len() < Plan::OPPOSITE_VIEWS { opposite } else { 0.0 };
                let near = |view: Vec3| here.distance(view).min(here.distance(-view) / weight);
                from.map(near).fold(f32::INFINITY, f32::min)
            };
            let rest: Vec<usize> = (0..CANDIDATES).filter(|index| !views.contains(index)).collect();
            let farthest = rest.iter().map(|&index| away(index)).fold(0.0, f32::max);
            if !views.is_empty() {
                prop_assert_eq!(next.reason, Reason::Support);
                prop_assert!(away(next.index) >= share * farthest * 0.9999);
                let gain = |index: usize| ball.value(&[views.as_slice(), &[index]].concat());
                let eligible = rest.iter().filter(|&&index| away(index) >= share * farthest * 1.0001);
                let most = eligible.map(|&index| gain(index)).fold(0.0, f64::max);
                prop_assert!(gain(next.index) >= most - 1e-4);
                prop_assert!((f64::from(next.gain) - (gain(next.index) - ball.value(&views))).abs() < 1e-4);
            }
            session.observe(next.index, next.pose, &glimpses[next.index]).unwrap();
            views.push(next.index);
        }
        prop_assert_eq!(views.len(), 9);
    }
}

/// The candidates that a plan takes of a scene.
fn taken(scene: &Scene, plan: Plan) -> Vec<usize> {
    let (sightings, mut accounts) = (scene.sightings(), scene.accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let poses = scene.poses().into_iter();
    let mut session = Session::try_new(Room::default(), poses, exact, plan).unwrap();
    let mut taken = Vec::new();
    while let Some(next) = session.next_view() {
        session.observe(next.index, next.pose, &sightings[next.index]).unwrap();
        taken.push(next.index);
    }
    taken
}

#[test]
fn the_whole_dispersion_is_farthest_point_sampling_and_none_changes_nothing() {
    let scene = Scene::ball(80, 50, 3);
    let fps = taken(&scene, Plan::farthest_point(14));
    for plan in [Plan::ensemble(14), Plan::sum(14), Plan::single(Objective::Coverage, 14)] {
        assert_eq!(taken(&scene, plan.with_dispersion(1.0)), fps);
        assert_ne!(taken(&scene, plan), fps);
        assert_ne!(taken(&scene, plan.with_dispersion(0.6)), taken(&scene, plan));
    }
}

/// So many views evenly around the vertical axis at a centre.
fn around(centre: Vec3, views: usize) -> Vec<Pose> {
    let space = ViewSpace::Spiral { turns: 1.0, min_elevation_rad: 0.0, max_elevation_rad: 0.0 };
    Pool::try_new(space, views, 1.0).unwrap().with_target(centre).unwrap().iter().collect()
}

#[test]
fn the_opposite_side_of_a_view_counts_by_its_weight() {
    let second = |opposite: f32| {
        let plan = Plan::farthest_point(2).with_opposite(opposite).with_start_views(0);
        let poses = around(Vec3::ZERO, 36);
        let mut session = Session::try_new(Room::default(), poses.clone(), Blind, plan).unwrap();
        session.observe(0, poses[0], &()).unwrap();
        let angle =
            poses[session.next_view().unwrap().index].position().angle_between(poses[0].position());
        angle.to_degrees().round() as u32
    };
    // Around a circle of radius 1 the chords to both sides are equal where sin(x / 2) = cos(x / 2) / w.
    assert_eq!([0.0, 0.5, 1.0].map(second), [180, 120, 90]); // 120 and not 130: 127 is not there
}

#[test]
fn opposite_sides_are_those_of_the_plans_centre_also_of_a_later_plan() {
    let (here, there) = (Vec3::ZERO, Vec3::new(0.3, -0.2, 0.1));
    let poses = around(there, 30);
    let plan = Plan::farthest_point(9).with_opposite(0.5).with_start_views(0);
    let follow = |first: Plan, then: Plan| {
        let mut session = Session::try_new(Room::default(), poses.clone(), Blind, first).unwrap();
        for index in [3, 11, 12] {
            session.observe(index, poses[index], &()).unwrap();
        }
        session.replan(then).unwrap();
        let mut taken = Vec::new();
        while let Some(next) = session.next_view() {
            session.observe(next.index, next.pose, &()).unwrap();
            taken.push(next.index);
        }
        taken
    };
    let (plan_here, plan_there) = (plan.with_centre(here), plan.with_centre(there));
    assert_eq!(follow(plan_here, plan_there), follow(plan_there, plan_there));
    assert_ne!(follow(plan_here, plan_here), follow(plan_there, plan_there));
}

#[test]
fn support_with_no_first_views_begins_by_chance() {
    let ball = Ball::new(60, 5);
    let glimpses = ball.glimpses();
    let (mut sums, mut empty) = (vec![0.0; 60], vec![0; VOXELS.div_ceil(32)]);
    let poses = || ball.poses.iter().copied();
    let blind = Plan::support(3).with_start_views(0).with_seed(4);
    let mut session = Session::try_new(Room::default(), poses(), Blind, blind).unwrap();
    let first = session.next_view().unwrap();
    session.observe(first.index, first.pose, &()).unwrap();
    assert_eq!(session.next_view().unwrap().reason, Reason::Farthest);
    let ledger = SupportLedger::try_new(&ball.targets, VOXELS, &mut sums, &mut empty).unwrap();
    let exact = ExactSupport::new(ledger, &glimpses);
    let mut session = Session::try_new(Room::default(), poses(), exact, blind).unwrap();
    assert_eq!(session.next_view().unwrap().reason, Reason::Support);
}

#[test]
fn what_cannot_be_is_refused() {
    let ball = Ball::new(33, 1);
    let open = |targets: &[Target], voxels: usize, sums: usize, words: usize| {
        let (mut sums, mut empty) = (vec![0.0; sums], vec![0; words]);
        SupportLedger::try_new(targets, voxels, &mut sums, &mut empty).err()
    };
    assert_eq!(open(&ball.targets, 64, 33, 2), None);
    assert_eq!(open(&[], 64, 0, 2), Some(SupportError::Empty));
    assert_eq!(open(&ball.targets, 0, 33, 0), Some(SupportError::Empty));
    let wrong = SupportError::WrongLength { expected: [33, 2], got: [32, 3] };
    assert_eq!(open(&ball.targets, 64, 32, 3), Some(wrong));
    assert!(wrong.to_string().contains("33 sums and 2 words of voxels, not 32 and 3"));
    let mut bad = ball.targets.clone();
    bad[5].normal *= 1.1;
    assert_eq!(open(&bad, 64, 33, 2), Some(SupportError::BadTarget { index: 5 }));
    for share in [-0.1, 1.1, f32::NAN] {
        let error = Plan::ensemble(3).with_dispersion(share).check(9).unwrap_err();
        assert!(matches!(error, PlanError::BadDispersion { .. }));
        let error = Plan::ensemble(3).with_opposite(share).check(9).unwrap_err();
        assert!(matches!(error, PlanError::BadOpposite { .. }));
    }
}
