//! The ledger's running sums against the equations themselves, over random surfaces and photos.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::reference::{self, Score};
use common::{Photo, Scene, cases, texture_total};
use proptest::prelude::*;
use vantage_core::objectives::{Face, FaceAccount, Form, Ledger, LedgerError, Reading, Surface};
use vantage_core::{Objective, Vec3};

fn coordinates(reach: f32) -> impl Strategy<Value = Vec3> {
    [-reach..reach, -reach..reach, -reach..reach].prop_map(Vec3::from)
}

fn faces() -> impl Strategy<Value = Vec<Face>> {
    let normal = coordinates(1.0).prop_map(|v| v.try_normalize().unwrap_or(Vec3::Z));
    // Complexity is often nothing at all, as on a box.
    let complexity = prop_oneof![Just(0.0f32), 0.0f32..3.0];
    let face = (coordinates(1.0), normal, 0.01f32..1.0, complexity).prop_map(
        |(centroid, normal, area_share, complexity)| Face {
            centroid,
            normal,
            area_share,
            complexity,
        },
    );
    prop::collection::vec(face, 1..=40).prop_map(|mut faces| {
        let area: f32 = faces.iter().map(|face| face.area_share).sum();
        faces.iter_mut().for_each(|face| face.area_share /= area);
        faces
    })
}

fn photo(faces: usize) -> impl Strategy<Value = Photo> {
    let shown = prop::collection::vec((any::<bool>(), 0u32..100), faces);
    (coordinates(4.0), shown, 0u32..20, 0u32..50).prop_map(
        |(camera, shown, textured_background, bare)| {
            let mut words = vec![0; shown.len().div_ceil(32)];
            let mut textured = Vec::new();
            for (index, &(is_seen, count)) in shown.iter().enumerate() {
                if is_seen {
                    words[index / 32] |= 1 << (index % 32);
                    textured.push(count);
                }
            }
            // Each textured pixel counts up to twice; none may be left at all.
            let pixels = (textured.iter().sum::<u32>() + textured_background).div_ceil(2) + bare;
            Photo { camera, words, textured, textured_background, pixels }
        },
    )
}

fn scene() -> impl Strategy<Value = Scene> {
    faces().prop_flat_map(|faces| {
        let photos = prop::collection::vec(photo(faces.len()), 1..=14);
        (Just(faces), photos).prop_map(|(faces, photos)| {
            let texture_total = texture_total(faces.len(), &photos, 0.25);
            Scene { faces, texture_total, photos }
        })
    })
}

fn reading() -> impl Strategy<Value = Reading> {
    let form = prop_oneof![Just(Form::Default), Just(Form::Literal)];
    (form, 0.0f32..0.95, 0.0f32..0.95, 0.5f32..3.0, 0.1f32..3.0).prop_map(
        |(form, geometry_discount, texture_discount, sigma_q, beta_q)| Reading {
            form,
            geometry_discount,
            texture_discount,
            sigma_q,
            beta_q,
        },
    )
}

/// Walks through the photos and compares every score and the gains of three photos with the
/// equations.
fn compare(scene: &Scene, reading: Reading) -> Result<(), TestCaseError> {
    let mut accounts = scene.accounts();
    let mut ledger = scene.ledger(reading, &mut accounts);
    let mut taken: Vec<&Photo> = Vec::new();
    for next in 0..=scene.photos.len() {
        let scores = ledger.scores();
        let now = Objective::ALL.map(|o| reference::score(scene, &reading, &taken, o));
        for (objective, Score { value, slack }) in Objective::ALL.into_iter().zip(now) {
            let got = f64::from(scores.get(objective));
            prop_assert!(
                (got - value).abs() <= slack + 1e-12,
                "{} of {} views: {} is not within {} of {}",
                objective,
                next,
                got,
                slack,
                value
            );
        }
        // The one that comes next, one that has been taken, and one that comes last.
        let others = [scene.photos.get(next), scene.photos.first(), scene.photos.last()];
        for photo in others.into_iter().flatten() {
            let mut more = taken.clone();
            more.push(photo);
            for (objective, before) in Objective::ALL.into_iter().zip(now) {
                let after = reference::score(scene, &reading, &more, objective);
                // A gain stands on what both scores stand on.
                let slack = before.slack + after.slack;
                let expected = after.value - before.value;
                let got = f64::from(ledger.gain(objective, photo.camera, &photo.sighting()));
                prop_assert!(
                    (got - expected).abs() <= slack + 1e-12,
                    "gain in {} after {} views: {} is not within {} of {}",
                    objective,
                    next,
                    got,
                    slack,
                    expected
                );
            }
        }
        if let Some(photo) = scene.photos.get(next) {
            ledger.add(photo.camera, &photo.sighting());
            taken.push(photo);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn scores_and_gains_are_those_of_the_equations(scene in scene(), reading in reading()) {
        compare(&scene, reading)?;
    }

    #[test]
    fn values_stay_in_their_ranges(scene in scene(), reading in reading()) {
        let mut accounts = scene.accounts();
        let mut ledger = scene.ledger(reading, &mut accounts);
        for photo in &scene.photos {
            ledger.add(photo.camera, &photo.sighting());
            let scores = ledger.scores();
            prop_assert!((0.0..=1.0).contains(&scores.coverage));
            prop_assert!(reading.form == Form::Literal || (0.0..=1.0).contains(&scores.geometry));
            prop_assert!((0.0..=1.0).contains(&scores.diversity));
            prop_assert!(scores.texture >= 0.0 && scores.texture.is_finite());
        }
    }
}

#[test]
fn a_whole_ball_has_the_scores_of_the_equations() {
    let scene = Scene::ball(150, 25, 4);
    for reading in [Reading::default(), Reading::literal()] {
        compare(&scene, reading).unwrap();
    }
}

/// The face, a photo of it from `camera` with 8 of 10 pixel channels textured, and those numbers.
fn one_face(camera: Vec3) -> Scene {
    let face = Face {
        centroid: Vec3::new(0.5, 0.25, 0.125),
        normal: Vec3::Z,
        area_share: 1.0,
        complexity: 1.0,
    };
    let photo =
        Photo { camera, words: vec![1], textured: vec![8], textured_background: 0, pixels: 5 };
    Scene { faces: vec![face], texture_total: 1.0, photos: vec![photo] }
}

#[test]
fn each_further_sight_counts_for_less() {
    let scene = one_face(Vec3::new(1.0, 2.0, 3.0));
    let mut accounts = scene.accounts();
    let mut ledger = scene.ledger(Reading::default(), &mut accounts);
    let mut seen = Vec::new();
    for _ in 0..3 {
        ledger.add(scene.photos[0].camera, &scene.photos[0].sighting());
        let scores = ledger.scores();
        seen.push((scores.geometry, scores.texture));
    }
    // 1 - 1/2^m, and 0.8 (1 + 1/4 + 1/16).
    assert_eq!(seen, [(0.5, 0.8), (0.75, 1.0), (0.875, 1.05)]);
    assert_eq!((ledger.views(), ledger.times_seen(0), ledger.times_seen(1)), (3, 3, 0));
}

#[test]
fn a_camera_on_a_face_gains_what_it_then_adds() {
    let scene = one_face(Vec3::new(0.5, 0.25, 0.125));
    for reading in [Reading::default(), Reading::literal()] {
        let mut accounts = scene.accounts();
        let mut ledger = scene.ledger(reading, &mut accounts);
        let around = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.0, 2.0)];
        for camera in around.into_iter().chain([scene.photos[0].camera; 2]) {
            let sighting = scene.photos[0].sighting();
            let (before, gain) =
                (ledger.scores(), ledger.gain(Objective::Diversity, camera, &sighting));
            ledger.add(camera, &sighting);
            let change = ledger.scores().diversity - before.diversity;
            assert!((gain - change).abs() < 1e-6, "{gain} is not {change}");
        }
    }
}

#[test]
fn missing_texture_counts_are_zero() {
    let mut scene = one_face(Vec3::ONE);
    scene.photos[0].textured.clear();
    let mut accounts = scene.accounts();
    let mut ledger = scene.ledger(Reading::default(), &mut accounts);
    ledger.add(Vec3::ONE, &scene.photos[0].sighting());
    assert_eq!(ledger.scores().texture, 0.0);
    assert_eq!(ledger.scores().coverage, 1.0);
}

#[test]
fn faces_that_the_surface_lacks_are_passed_over() {
    let mut scene = one_face(Vec3::ONE);
    scene.photos[0].words = vec![0b11, 1];
    scene.photos[0].textured = vec![8, 1, 1];
    let mut accounts = scene.accounts();
    let mut ledger = scene.ledger(Reading::default(), &mut accounts);
    let sighting = scene.photos[0].sighting();
    let gains = Objective::ALL.map(|o| ledger.gain(o, Vec3::ONE, &sighting));
    assert_eq!(gains, [1.0, 0.5, 0.0, 0.8]);
    ledger.add(Vec3::ONE, &sighting);
    assert_eq!(ledger.scores().coverage, 1.0);
}

#[test]
fn an_object_without_complexity_or_texture_scores_nothing_for_them() {
    let mut scene = one_face(Vec3::ONE);
    scene.faces[0].complexity = 0.0;
    for nothing in [0.0, -1.0, f32::NAN] {
        scene.texture_total = nothing;
        let mut accounts = scene.accounts();
        let mut ledger = scene.ledger(Reading::default(), &mut accounts);
        let sighting = scene.photos[0].sighting();
        assert_eq!(ledger.gain(Objective::Geometry, Vec3::ONE, &sighting), 0.0);
        assert_eq!(ledger.gain(Objective::Texture, Vec3::ONE, &sighting), 0.0);
        ledger.add(Vec3::ONE, &sighting);
        assert_eq!((ledger.scores().geometry, ledger.scores().texture), (0.0, 0.0));
    }
}

#[test]
fn one_account_is_needed_for_each_face() {
    let scene = one_face(Vec3::ONE);
    let surface = Surface::try_new(&scene.faces, 1.0).unwrap();
    let mut accounts = [FaceAccount::default(); 2];
    let refused = Ledger::try_new(surface, Reading::default(), &mut accounts);
    assert_eq!(refused.err(), Some(LedgerError::WrongLength { expected: 1, got: 2 }));
}

#[test]
fn a_reading_out_of_range_is_refused() {
    let scene = one_face(Vec3::ONE);
    let surface = Surface::try_new(&scene.faces, 1.0).unwrap();
    let reading = Reading::default();
    for wrong in [
        Reading { geometry_discount: 1.0, ..reading },
        Reading { texture_discount: -0.1, ..reading },
        Reading { texture_discount: f32::NAN, ..reading },
        Reading { sigma_q: 0.0, ..reading },
        Reading { beta_q: f32::INFINITY, ..reading },
    ] {
        let mut accounts = [FaceAccount::default()];
        let refused = Ledger::try_new(surface, wrong, &mut accounts);
        assert_eq!(refused.err(), Some(LedgerError::BadReading), "{wrong:?}");
    }
}
