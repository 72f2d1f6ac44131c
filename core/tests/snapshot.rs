//! Snapshots: what is restored goes on as if nothing had happened, and nothing else is restored.
#![cfg(feature = "serde")]
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::{Room, Scene, cases};
use proptest::prelude::*;
use vantage_core::objectives::{FaceAccount, Reading, Sighting};
use vantage_core::planner::{
    Blind, Finish, Fixed, Memory, Plan, Session, SessionError, Status, Stop,
};
use vantage_core::record::{SnapshotError, VERSION};
use vantage_core::{Exact, Objective, Pose, Quat, Vec3};

type Capture<'a> = Session<Exact<'a>, Room>;

/// CRC-32 (ISO-HDLC) bit by bit, as its definition has it.
fn crc(bytes: &[u8]) -> u32 {
    let mut register = u32::MAX;
    for byte in bytes {
        register ^= u32::from(*byte);
        for _ in 0..8 {
            register = (register >> 1) ^ if register & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    !register
}

/// A snapshot with this payload, right in everything else.
fn sealed(payload: &[u8]) -> Vec<u8> {
    let mut bytes = b"VNTG\x03\x00".to_vec();
    bytes.extend((payload.len() as u32).to_le_bytes());
    bytes.extend(payload);
    bytes.extend(crc(&bytes).to_le_bytes());
    bytes
}

fn payload(snapshot: &[u8]) -> Vec<u8> {
    snapshot[10..snapshot.len() - 4].to_vec()
}

fn written(session: &Capture<'_>) -> Vec<u8> {
    let mut buffer = vec![0xaa; 100_000];
    let used = session.snapshot(&mut buffer).unwrap();
    assert!(buffer[used..].iter().all(|&byte| byte == 0xaa));
    buffer.truncate(used);
    buffer
}

/// One thing that happens, the same for the same step: a photo, a block, a skip or a photo taken
/// elsewhere. Gives what was asked for, or `None` at the end.
fn happen<'a>(
    session: &mut Capture<'a>,
    sightings: &[Sighting<'a>],
    step: usize,
) -> Option<(usize, u32)> {
    let next = session.next_view()?;
    let index = next.index;
    match step % 7 {
        2 => session.block((index + 3) % sightings.len()).unwrap(),
        4 => session.skip(index).unwrap(),
        5 => session.observe_elsewhere(next.pose, &sightings[index]).unwrap(),
        _ => session.observe(index, next.pose, &sightings[index]).unwrap(),
    }
    Some((index, next.gain.to_bits()))
}

fn score_bits(session: &Capture<'_>) -> [u32; 4] {
    Objective::ALL.map(|objective| session.scores().get(objective).to_bits())
}

fn every_plan() -> Vec<Plan> {
    let stop = Stop { gain: 0.02, patience: 2 };
    vec![
        Plan::ensemble(12),
        Plan::ensemble(12).with_movement_cost(0.5).with_stop(stop).with_seed(u64::MAX),
        Plan::literal_ensemble(12).with_centre(Vec3::new(0.1, -0.2, 0.3)),
        Plan::single(Objective::Coverage, 12).with_stop(stop),
        Plan::single(Objective::Diversity, 12),
        Plan::single(Objective::Texture, 12),
        Plan::sum(12).with_stop(stop).with_dispersion(0.5),
        Plan::farthest_point(12).with_opposite(0.5).with_centre(Vec3::new(0.1, -0.2, 0.3)),
        Plan::pseudo_coverage(12),
        Plan::random(12).with_seed(9),
    ]
}

#[test]
fn a_snapshot_of_any_step_goes_on_to_the_same_plan_and_scores() {
    let scene = Scene::ball(60, 20, 7);
    let (sightings, poses) = (scene.sightings(), scene.poses());
    for plan in every_plan() {
        for reading in [Reading::default(), Reading::literal()] {
            let mut accounts = scene.accounts();
            let exact = scene.exact(reading, &sightings, &mut accounts);
            let mut session =
                Session::try_new(Room::default(), poses.iter().copied(), exact, plan).unwrap();
            let mut snapshots = Vec::new();
            let mut story = Vec::new();
            loop {
                // With nothing due, and with a view due that the camera is on its way to.
                let before = written(&session);
                session.next_view();
                snapshots.push([before, written(&session)]);
                let Some(what) = happen(&mut session, &sightings, story.len()) else { break };
                story.push(what);
            }
            assert!(story.len() > 4, "{plan:?}");
            let (end, scores) = (written(&session), score_bits(&session));
            for (step, bytes) in snapshots.iter().enumerate() {
                for bytes in bytes {
                    let mut accounts = scene.accounts();
                    let exact = scene.exact(reading, &sightings, &mut accounts);
                    let mut again = Session::restore(Room::default(), exact, bytes).unwrap();
                    assert_eq!(&written(&again), bytes, "{plan:?}, step {step}");
                    let rest: Vec<_> =
                        (step..).map_while(|step| happen(&mut again, &sightings, step)).collect();
                    assert_eq!(rest, story[step..], "{plan:?}, step {step}");
                    assert_eq!(score_bits(&again), scores);
                    assert_eq!(again.finish(), session.finish());
                    assert_eq!(written(&again), end);
                }
            }
        }
    }
}

#[test]
fn a_view_that_was_due_keeps_its_objective_and_counts_for_the_stop_rule() {
    let scene = Scene::ball(40, 12, 7);
    let (sightings, poses) = (scene.sightings(), scene.poses());
    let plan = Plan::single(Objective::Geometry, 12).with_stop(Stop { gain: 2.0, patience: 1 });
    let (mut accounts, mut other) = (scene.accounts(), scene.accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let mut session = Session::try_new(Room::default(), poses, exact, plan).unwrap();
    for step in [0, 1, 3] {
        happen(&mut session, &sightings, step);
    }
    let next = session.next_view().unwrap();
    let exact = scene.exact(Reading::default(), &sightings, &mut other);
    let mut again = Session::restore(Room::default(), exact, &written(&session)).unwrap();
    // The photo is taken without asking again.
    again.observe(next.index, next.pose, &sightings[next.index]).unwrap();
    let view = again.views()[3];
    assert_eq!((view.objective, view.gain), (Some(Objective::Geometry), next.gain));
    assert_eq!(again.finish(), Some(Finish::GoodEnough));
}

/// Two faces, three candidates, and a little of everything: a photo, a block, a skip, a view due.
fn small() -> Scene {
    let mut scene = Scene::ball(2, 3, 1);
    scene.photos[0].words[0] = 0b11;
    scene.photos[0].textured = vec![3, 5];
    scene
}

fn small_accounts() -> [FaceAccount; 2] {
    [FaceAccount::default(); 2]
}

fn small_snapshot(scene: &Scene) -> Vec<u8> {
    let (sightings, mut accounts) = (scene.sightings(), small_accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let plan = Plan::ensemble(3).with_stop(Stop::default()).with_seed(300);
    let mut session = Session::try_new(Room::default(), scene.poses(), exact, plan).unwrap();
    let next = session.next_view().unwrap();
    session.observe(next.index, next.pose, &sightings[0]).unwrap();
    let other = (0..3).find(|&index| session.candidates()[index].is_available()).unwrap();
    session.block(other).unwrap();
    session.next_view().unwrap();
    written(&session)
}

/// What comes of restoring bytes as a session over the small scene.
fn restored<M: Memory>(scene: &Scene, memory: M, bytes: &[u8]) -> Result<(), SnapshotError> {
    let (sightings, mut accounts) = (scene.sightings(), small_accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let mut session = Session::restore(memory, exact, bytes)?;
    // Whatever was restored can be used without a panic and comes to an end.
    for _ in 0..20 {
        let Some(next) = session.next_view() else { break };
        let shot = sightings.get(next.index).unwrap_or(&sightings[0]);
        if session.observe(next.index, next.pose, shot).is_err() {
            break;
        }
    }
    session.finish();
    session.scores().smoothed();
    session.score_all(Objective::Diversity);
    session.order_by_travel(&mut [0, 1, 2, 99]);
    Ok(())
}

#[test]
fn the_example_in_the_documentation_is_the_snapshot() {
    // The same bytes as on the page of the format, field by field.
    #[rustfmt::skip]
    let expected = [
        0x56, 0x4e, 0x54, 0x47, // "VNTG"
        0x03, 0x00, // version 3
        0x41, 0x00, 0x00, 0x00, // 65 bytes of payload
        // The plan: scheme Random, budget 1, start FarthestPoint, no start views, seed 0.
        0x00, 0x01, 0x01, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, // movement cost 0.0
        0x00, 0x00, 0x00, 0x00, // dispersion 0.0
        0x00, 0x00, 0x00, 0x00, // opposite 0.0
        0x00, // no stop rule
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, // centre
        0x00, 0x00, // no choices settled, none of them weak
        0x00, // the blind scorer's fingerprint
        0x01, 0x00, // one candidate, no views
        0x00, // no view is due
        // Candidate 0: position (1, 2, 3), rotation (0, 0, 0, 1), available.
        0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x40, 0x40,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3f,
        0x00,
        0xdf, 0x91, 0xc9, 0xa4, // CRC-32
    ];
    let pose = Pose::try_new(Vec3::new(1.0, 2.0, 3.0), Quat::IDENTITY).unwrap();
    let session =
        Session::try_new(Fixed::<1, 1>::default(), [pose], Blind, Plan::random(1)).unwrap();
    let mut buffer = [0; 79];
    assert_eq!(session.snapshot(&mut buffer), Ok(79));
    assert_eq!(buffer, expected);
    assert_eq!(sealed(&payload(&buffer)), buffer);
    let again = Session::restore(Fixed::<1, 1>::default(), Blind, &buffer).unwrap();
    assert_eq!(again.plan(), &Plan::random(1));
    assert_eq!(again.candidate(0).unwrap().pose(), &pose);
    assert_eq!(again.candidate(0).unwrap().status(), Status::Available);
    assert!(matches!(again.candidate(1), Err(SessionError::UnknownCandidate { .. })));
}

#[test]
fn every_flipped_bit_is_refused_with_its_reason() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    assert_eq!(restored(&scene, Room::default(), &bytes), Ok(()));
    for place in 0..bytes.len() {
        for bit in 0..8 {
            let mut bytes = bytes.clone();
            bytes[place] ^= 1 << bit;
            let error = restored(&scene, Room::default(), &bytes).unwrap_err();
            let field = |range: core::ops::Range<usize>| {
                let bytes = &bytes[range];
                bytes.iter().rev().fold(0usize, |sum, &byte| sum << 8 | usize::from(byte))
            };
            let expected = match place {
                0..4 => SnapshotError::Foreign,
                4..6 => SnapshotError::Version { got: field(4..6) as u16 },
                6..10 => SnapshotError::Length { expected: field(6..10) + 14, got: bytes.len() },
                _ => SnapshotError::Checksum,
            };
            assert_eq!(error, expected, "byte {place}, bit {bit}");
        }
    }
}

#[test]
fn every_truncation_and_extension_is_refused_with_its_reason() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    for length in 0..bytes.len() {
        let error = restored(&scene, Room::default(), &bytes[..length]).unwrap_err();
        let expected = match length {
            0..4 => SnapshotError::Foreign,
            // Before it says how long it is, it must at least hold a header and a checksum.
            4..10 => SnapshotError::Length { expected: 14, got: length },
            _ => SnapshotError::Length { expected: bytes.len(), got: length },
        };
        assert_eq!(error, expected, "{length} bytes");
    }
    for more in 1..20 {
        let mut longer = bytes.clone();
        longer.resize(bytes.len() + more, 0x47);
        let error = SnapshotError::Length { expected: bytes.len(), got: longer.len() };
        assert_eq!(restored(&scene, Room::default(), &longer), Err(error));
        // Sealed again, the records end before the payload does.
        let longer = sealed(&longer[10..longer.len() - 4]);
        assert_eq!(restored(&scene, Room::default(), &longer), Err(SnapshotError::Malformed));
    }
    // And the other way around.
    let all = payload(&bytes);
    for length in 0..all.len() {
        let shorter = sealed(&all[..length]);
        assert_eq!(restored(&scene, Room::default(), &shorter), Err(SnapshotError::Malformed));
    }
}

#[test]
fn another_version_is_named() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    for got in [0, VERSION + 1, u16::MAX] {
        // The version decides how the rest is read, so it is looked at before the checksum.
        let mut bytes = bytes.clone();
        bytes[4..6].copy_from_slice(&got.to_le_bytes());
        let error = restored(&scene, Room::default(), &bytes).unwrap_err();
        assert_eq!(error, SnapshotError::Version { got });
        assert!(error.to_string().contains(&format!("version {got},")));
    }
}

#[test]
fn a_snapshot_of_another_scorer_is_refused() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    let mut others = [scene.clone(), scene.clone(), scene.clone(), scene.clone(), scene.clone()];
    others[0].faces[1].centroid.x += 1e-3;
    others[1].faces[1].normal.y *= -1.0;
    others[2].faces[0].complexity += 0.5;
    others[3].texture_total *= 2.0;
    others[4].faces.swap(0, 1);
    for other in &others {
        assert_eq!(restored(other, Room::default(), &bytes), Err(SnapshotError::OtherScorer));
    }
    let readings = [
        Reading::literal(),
        Reading { geometry_discount: 0.25, ..Reading::default() },
        Reading { texture_discount: 0.0, ..Reading::default() },
    ];
    for reading in readings {
        let (sightings, mut accounts) = (scene.sightings(), small_accounts());
        let exact = scene.exact(reading, &sightings, &mut accounts);
        let other = Session::restore(Room::default(), exact, &bytes);
        assert_eq!(other.err(), Some(SnapshotError::OtherScorer));
    }
    let blind = Session::restore(Room::default(), Blind, &bytes);
    assert_eq!(blind.err(), Some(SnapshotError::OtherScorer));
}

#[test]
fn too_small_a_memory_is_refused() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    assert_eq!(restored(&scene, Fixed::<3, 3>::default(), &bytes), Ok(()));
    for error in [
        restored(&scene, Fixed::<2, 3>::default(), &bytes),
        restored(&scene, Fixed::<0, 3>::default(), &bytes),
        restored(&scene, Fixed::<3, 0>::default(), &bytes),
        // Room for the view taken, but not for the budget.
        restored(&scene, Fixed::<3, 2>::default(), &bytes),
    ] {
        assert_eq!(error, Err(SnapshotError::TooLarge));
    }
}

#[test]
fn too_small_a_buffer_is_refused() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    let (sightings, mut accounts) = (scene.sightings(), small_accounts());
    let exact = scene.exact(Reading::default(), &sightings, &mut accounts);
    let session = Session::restore(Room::default(), exact, &bytes).unwrap();
    for size in 0..bytes.len() {
        assert_eq!(session.snapshot(&mut vec![0; size]), Err(SnapshotError::NoRoom), "{size}");
    }
    let mut buffer = vec![0; bytes.len()];
    assert_eq!(session.snapshot(&mut buffer), Ok(bytes.len()));
    assert_eq!(buffer, bytes);
}

#[test]
fn records_that_cannot_be_are_refused() {
    let scene = small();
    let bytes = small_snapshot(&scene);
    let all = payload(&bytes);
    let refused = |place: usize, expected: u8, value: &[u8]| {
        assert_eq!(all[place], expected, "the byte meant is elsewhere");
        let mut payload = all.clone();
        payload[place..place + value.len()].copy_from_slice(value);
        let error = restored(&scene, Room::default(), &sealed(&payload));
        assert_eq!(error, Err(SnapshotError::Malformed), "{value:?} at {place}");
    };
    // The plan: scheme Ensemble(FromStart), budget 3, start FarthestPoint, 3 start views, seed 300.
    refused(0, 3, &[9]); // an unknown scheme
    refused(2, 3, &[0]); // no budget
    refused(2, 3, &[4]); // a budget larger than the candidates
    let seed = 5;
    assert_eq!(all[seed..seed + 2], [0xac, 0x02]);
    refused(seed + 2, 0, &f32::NAN.to_le_bytes()); // the movement cost
    refused(seed + 2, 0, &2.0f32.to_le_bytes());
    refused(seed + 6, 0, &(-0.5f32).to_le_bytes()); // the dispersion
    refused(seed + 10, 0, &1.5f32.to_le_bytes()); // the weight of opposite sides
    let stop = seed + 14;
    refused(stop, 1, &[2]); // neither with a stop rule nor without
    refused(stop + 5, 6, &[0]); // no patience
    refused(stop + 6, 0, &f32::NAN.to_le_bytes()); // the centre
    let pose = scene.poses()[0].position().x.to_le_bytes();
    let first = all.windows(4).position(|window| window == pose).unwrap();
    refused(first, pose[0], &f32::INFINITY.to_le_bytes());
    refused(first + 28, all[first + 28], &[4]); // an unknown status
    // A candidate takes 29 bytes; the view comes after the three of them.
    let view = first + 3 * 29;
    assert_eq!(all[view + 28], 1);
    refused(view + 29, all[view + 29], &[3]); // a view of a candidate that does not exist
}

proptest! {
    #![proptest_config(cases(3000))]

    #[test]
    fn foreign_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(restored(&small(), Room::default(), &bytes).is_err());
    }

    #[test]
    fn no_sealed_payload_panics(payload in prop::collection::vec(any::<u8>(), 0..300)) {
        // Random records hardly ever get past the fingerprint; the next test does.
        let _ = restored(&small(), Room::default(), &sealed(&payload));
    }

    #[test]
    fn no_damaged_payload_panics(
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::weighted(0.2, any::<prop::sample::Index>()),
        room in 0usize..3,
    ) {
        let scene = small();
        let mut payload = payload(&small_snapshot(&scene));
        for (place, value) in flips {
            let place = place.index(payload.len());
            payload[place] = value;
        }
        if let Some(cut) = cut {
            payload.truncate(cut.index(payload.len()));
        }
        let bytes = sealed(&payload);
        let result = match room {
            0 => restored(&scene, Room::default(), &bytes),
            1 => restored(&scene, Fixed::<3, 3>::default(), &bytes),
            _ => restored(&scene, Fixed::<2, 1>::default(), &bytes),
        };
        let outer = [SnapshotError::Foreign, SnapshotError::Checksum, SnapshotError::NoRoom];
        prop_assert!(result.err().is_none_or(|error| !outer.contains(&error)));
    }
}
