//! Laws that the objectives and the plans obey, whatever the object.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::{Chance, Room, Scene, cases, follow};
use proptest::prelude::*;
use vantage_core::objectives::{Face, Reading, smoothing};
use vantage_core::planner::{Plan, Scorer, Session, Start};
use vantage_core::{Objective, Pose, PoseError, Quat, Scores, Vec3};

const READINGS: [fn() -> Reading; 2] = [Reading::default, Reading::literal];

/// The scene after a linear map of the world: faces, normals and cameras together.
fn moved(scene: &Scene, map: impl Fn(Vec3) -> Vec3) -> Scene {
    let mut moved = scene.clone();
    for Face { centroid, normal, .. } in &mut moved.faces {
        (*centroid, *normal) = (map(*centroid), map(*normal));
    }
    moved.photos.iter_mut().for_each(|photo| photo.camera = map(photo.camera));
    moved
}

/// The scores after each of the scene's photos.
fn course(scene: &Scene, reading: Reading) -> Vec<Scores> {
    let mut accounts = scene.accounts();
    let mut ledger = scene.ledger(reading, &mut accounts);
    let step = |photo: &common::Photo| {
        ledger.add(photo.camera, &photo.sighting());
        ledger.scores()
    };
    scene.photos.iter().map(step).collect()
}

fn any_rotation(chance: &mut Chance) -> Quat {
    // Even over all rotations: a point of the unit ball in four dimensions, made unit.
    loop {
        let [x, y, z, w] = [(); 4].map(|()| 2.0 * chance.share() - 1.0);
        let length = (x * x + y * y + z * z + w * w).sqrt();
        if length > 0.1 && length < 1.0 {
            return Quat::from_xyzw(x, y, z, w) / length;
        }
    }
}

#[test]
fn coverage_never_falls_as_views_are_added() {
    for reading in READINGS {
        for seed in 0..20 {
            let scores = course(&Scene::ball(70, 20, seed), reading());
            assert!(scores.windows(2).all(|pair| pair[1].coverage >= pair[0].coverage));
            assert!(scores[19].coverage > scores[0].coverage);
        }
    }
}

#[test]
fn geometry_and_default_texture_never_fall_as_views_are_added() {
    for seed in 0..20 {
        let scene = Scene::ball(70, 20, seed);
        let scores = course(&scene, Reading::default());
        assert!(scores.windows(2).all(|pair| pair[1].geometry >= pair[0].geometry));
        assert!(scores.windows(2).all(|pair| pair[1].texture >= pair[0].texture));
        let scores = course(&scene, Reading::literal());
        assert!(scores.windows(2).all(|pair| pair[1].geometry >= pair[0].geometry));
    }
}

#[test]
fn a_view_taken_twice_adds_no_coverage() {
    for reading in READINGS {
        let scene = Scene::ball(70, 20, 3);
        let mut accounts = scene.accounts();
        let mut ledger = scene.ledger(reading(), &mut accounts);
        for photo in &scene.photos {
            ledger.add(photo.camera, &photo.sighting());
            let once = ledger.scores().coverage;
            assert_eq!(ledger.gain(Objective::Coverage, photo.camera, &photo.sighting()), 0.0);
            // From elsewhere too: what counts is what is seen.
            assert_eq!(ledger.gain(Objective::Coverage, Vec3::ONE, &photo.sighting()), 0.0);
            ledger.add(photo.camera, &photo.sighting());
            assert_eq!(ledger.scores().coverage, once);
        }
    }
}

#[test]
fn gains_never_rise_as_views_are_added() {
    // Exactly, to the last bit: lazy greedy takes an old gain for an upper bound.
    for (reading, seed) in READINGS.into_iter().flat_map(|r| (0..15).map(move |s| (r, s))) {
        let scene = Scene::ball(90, 30, seed);
        let discounts = [(0.5, 0.25), (0.0, 0.0), (0.3, 0.9), (0.95, 0.123), (0.999, 0.7)];
        let (geometry_discount, texture_discount) = discounts[seed as usize % discounts.len()];
        let reading = Reading { geometry_discount, texture_discount, ..reading() };
        let mut accounts = scene.accounts();
        let mut ledger = scene.ledger(reading, &mut accounts);
        let mut chance = Chance::new(seed);
        let diminishing = Objective::ALL.into_iter().filter(|&o| ledger.diminishes(o));
        let diminishing: Vec<Objective> = diminishing.collect();
        assert!(diminishing.len() >= 2 && !diminishing.contains(&Objective::Diversity));
        let mut bounds = vec![[f32::INFINITY; 4]; scene.photos.len()];
        // More views than candidates: some are taken again and again.
        for _ in 0..60 {
            let photo = &scene.photos[chance.below(scene.photos.len())];
            ledger.add(photo.camera, &photo.sighting());
            for (photo, bounds) in scene.photos.iter().zip(&mut bounds) {
                for &objective in &diminishing {
                    let gain = ledger.gain(objective, photo.camera, &photo.sighting());
                    let bound = &mut bounds[objective as usize];
                    assert!(gain <= *bound, "{objective}: {gain:e} after {bound:e}");
                    *bound = gain;
                }
            }
        }
    }
}

#[test]
fn quarter_turns_and_mirrors_change_diversity_by_rounding_only() {
    let scene = Scene::ball(70, 12, 5);
    let turns: [fn(Vec3) -> Vec3; 8] = [
        |v| Vec3::new(-v.y, v.x, v.z),
        |v| Vec3::new(-v.x, -v.y, v.z),
        |v| Vec3::new(v.y, -v.x, v.z),
        |v| Vec3::new(v.x, -v.z, v.y),
        |v| Vec3::new(v.z, v.y, -v.x),
        |v| Vec3::new(v.y, v.z, v.x),
        |v| Vec3::new(-v.x, v.y, v.z),
        |v| Vec3::new(v.x, v.y, -v.z),
    ];
    for reading in READINGS {
        let straight = course(&scene, reading());
        for turn in turns {
            for (a, b) in straight.iter().zip(course(&moved(&scene, turn), reading())) {
                assert_eq!(
                    (a.coverage, a.geometry, a.texture),
                    (b.coverage, b.geometry, b.texture)
                );
                // The three axes are multiplied, and a dot product summed, in another order.
                assert!((a.diversity - b.diversity).abs() <= 2e-6 * a.diversity, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_turn_by_any_angle_changes_diversity_within_bounds_and_nothing_else() {
    // D multiplies the variances along three fixed axes, so it is not the same for a turned object.
    // Measured over 40 other objects x 50 rotations, relative to D as the object stands: after 6, 12
    // and 30 views it changes by 17, 8.5 and 3.1 % in the mean and by 89, 53 and 17 % at most. The
    // fewer rays a face has, the more it matters how they lie to the axes.
    for (views, mean_limit, largest_limit) in [(6, 0.25, 1.2), (12, 0.15, 0.8), (30, 0.06, 0.3)] {
        let (mut sum, mut largest, mut count) = (0.0, 0.0f32, 0);
        for seed in 0..8 {
            let scene = Scene::ball(70, views, seed);
            let straight = course(&scene, Reading::default())[views - 1];
            let mut chance = Chance::new(seed);
            for _ in 0..50 {
                let rotation = any_rotation(&mut chance);
                let turned = moved(&scene, |v| rotation * v);
                let turned = course(&turned, Reading::default())[views - 1];
                assert_eq!(turned.coverage, straight.coverage);
                assert_eq!(turned.geometry, straight.geometry);
                assert_eq!(turned.texture, straight.texture);
                let change = (turned.diversity / straight.diversity - 1.0).abs();
                (sum, largest, count) = (sum + change, largest.max(change), count + 1);
            }
        }
        let mean = sum / count as f32;
        println!("D under rotation, {views} views: mean change {mean:.4}, largest {largest:.4}");
        assert!(mean < mean_limit && largest < largest_limit, "mean {mean}, largest {largest}");
        // Were it rotation invariant after all, this page and METHOD would be wrong.
        assert!(mean > 1e-3);
    }
}

#[test]
fn a_plan_for_coverage_geometry_or_texture_turns_with_the_object() {
    for objective in [Objective::Coverage, Objective::Geometry, Objective::Texture] {
        for seed in 0..5 {
            let scene = Scene::ball(70, 40, seed);
            let rotation = any_rotation(&mut Chance::new(seed));
            let plans = [scene.clone(), moved(&scene, |v| rotation * v)].map(|scene| {
                let (sightings, mut accounts) = (scene.sightings(), scene.accounts());
                let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
                let plan = Plan::single(objective, 20).with_seed(seed);
                let mut session =
                    Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
                follow(&mut session, &sightings)
            });
            assert_eq!(plans[0], plans[1]);
        }
    }
}

#[test]
fn ties_go_to_the_lowest_index() {
    // Every candidate twice: the second of a pair only ever comes after the first.
    let mut scene = Scene::ball(60, 12, 1);
    scene.photos = scene.photos.iter().flat_map(|p| [p.clone(), p.clone()]).collect();
    let (sightings, poses) = (scene.sightings(), scene.poses());
    let plans = Objective::ALL.map(|objective| Plan::single(objective, 24));
    let others = [Plan::ensemble(24), Plan::sum(24), Plan::pseudo_coverage(24)];
    for plan in plans.into_iter().chain(others) {
        for movement_cost in [0.0, 0.5] {
            let plan = plan.with_start(Start::PseudoCoverage).with_movement_cost(movement_cost);
            let mut accounts = scene.accounts();
            let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
            let mut session =
                Session::try_new(Room::default(), poses.iter().copied(), exact, plan).unwrap();
            let order = follow(&mut session, &sightings);
            for (step, &index) in order.iter().enumerate() {
                let first = index - index % 2;
                assert!(order[..=step].contains(&first), "{plan:?}: {order:?}");
            }
        }
    }
}

/// Expects every gain to be what a function says.
struct Says<F>(F);

impl<F: Fn(usize) -> f32> Scorer for Says<F> {
    type Shot<'s> = ();
    type Error = core::convert::Infallible;

    fn observe(&mut self, _pose: &Pose, _shot: &()) -> Result<(), Self::Error> {
        Ok(())
    }

    fn gain(&self, _objective: Objective, index: usize, _pose: &Pose) -> f32 {
        (self.0)(index)
    }

    fn scores(&self) -> Scores {
        Scores::default()
    }
}

#[test]
fn a_gain_that_is_not_a_number_is_never_chosen() {
    let poses = Scene::ball(1, 9, 2).poses();
    let odd = |index: usize| if index.is_multiple_of(2) { f32::NAN } else { -1.0 };
    for plan in [Plan::single(Objective::Diversity, 9), Plan::sum(9), Plan::ensemble(9)] {
        let plan = plan.with_start(Start::PseudoCoverage);
        let mut session =
            Session::try_new(Room::default(), poses.iter().copied(), Says(odd), plan).unwrap();
        while let Some(next) = session.next_view() {
            assert!(session.views().len() < 3 || next.index % 2 == 1);
            session.observe(next.index, next.pose, &()).unwrap();
        }
        assert!(session.candidates().iter().skip(1).step_by(2).all(|c| !c.is_available()));
        assert!(session.views().len() < 9);
    }
}

#[test]
fn smoothing_rises_and_stays_between_0_and_1() {
    let mut before = smoothing(f32::NEG_INFINITY);
    for step in -200_000..=200_000 {
        let value = smoothing(step as f32 * 1e-5);
        assert!(value >= before && (0.0..=1.0).contains(&value));
        before = value;
    }
    assert_eq!((smoothing(f32::NEG_INFINITY), smoothing(f32::INFINITY)), (0.0, 1.0));
    assert!(smoothing(f32::NAN).is_nan());
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn smoothing_never_turns_an_order_around(a in any::<f32>(), b in any::<f32>()) {
        let (low, high) = if a <= b { (a, b) } else { (b, a) };
        prop_assert!(smoothing(low) <= smoothing(high));
        prop_assert!((0.0..=1.0).contains(&smoothing(a)));
    }

    #[test]
    fn a_pose_is_finite_and_unit_or_refused(bits in any::<[u32; 7]>(), scale in 0.0f32..2.0) {
        let [x, y, z, a, b, c, d] = bits.map(f32::from_bits);
        let position = Vec3::new(x, y, z);
        let checked = Pose::try_new(position, Quat::from_xyzw(a, b, c, d));
        if !bits.map(f32::from_bits).iter().all(|v| v.is_finite()) {
            prop_assert_eq!(checked, Err(PoseError::NotFinite));
        }
        let checked = Pose::try_new(Vec3::ONE, Quat::from_xyzw(0.0, 0.6 * scale, 0.8 * scale, 0.0));
        match checked {
            Ok(pose) => {
                prop_assert!((scale - 1.0).abs() < 1.001e-3);
                prop_assert!((pose.rotation().length() - 1.0).abs() < 1e-6);
            }
            Err(PoseError::NotUnit { length }) => {
                prop_assert!((length - scale).abs() < 1e-5 && (scale - 1.0).abs() > 0.999e-3);
            }
            Err(other) => prop_assert!(false, "{other:?}"),
        }
    }
}
