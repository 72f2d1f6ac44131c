//! The whole way, from pictures of a board at known poses to poses.

mod picture;

use picture::{Occluder, Picture, errors};
use proptest::prelude::*;
use vantage_board::{Board, BoardSpec, Frame, Intrinsics, IntrinsicsSource, Tracker};
use vantage_core::{Pose, Vec3};

const FOCAL_PX: f64 = 540.0;

fn given() -> Intrinsics {
    Intrinsics { focal_px: FOCAL_PX, cx: 320.0, cy: 240.0 }
}

/// Looking at the board's middle from an azimuth and an elevation, both in degrees.
fn looking(azimuth: f32, elevation: f32, distance_m: f32) -> Pose {
    let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
    let eye = Vec3::new(
        elevation.cos() * azimuth.cos(),
        elevation.cos() * azimuth.sin(),
        elevation.sin(),
    );
    Pose::looking_at(eye * distance_m, Vec3::new(0.01, -0.01, 0.03)).unwrap()
}

/// Views all around at several elevations and distances.
fn around() -> Vec<Pose> {
    let mut poses = Vec::new();
    for (i, elevation) in [25.0f32, 40.0, 60.0, 80.0].into_iter().enumerate() {
        for j in 0..6 {
            let azimuth = 60.0 * j as f32 + 17.0 * i as f32;
            poses.push(looking(azimuth, elevation, 0.4 + 0.05 * ((i + j) % 5) as f32));
        }
    }
    poses
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn poses_are_found_with_an_object_in_the_middle_of_the_board() {
    let board = Board::default();
    let mut tracker = Tracker::new(board);
    tracker.set_intrinsics(given()).unwrap();
    let object = Occluder { radius_m: 0.06, height_m: 0.12 };
    let (mut degrees, mut shares) = (Vec::new(), Vec::new());
    for (i, pose) in (0..).zip(around()) {
        let picture = Picture {
            intrinsics: given(),
            occluder: Some(object),
            noise: 3.0,
            seed: i,
            ..Picture::default()
        };
        let luma = picture.draw(&board, &pose);
        let tracked = tracker.track(&Frame::try_new(&luma, 640, 480).unwrap());
        let found = tracked.pose.unwrap_or_else(|| panic!("no pose in view {i}"));
        assert!(tracked.tags.len() < 20, "the object hides nothing in view {i}");
        assert!(found.tags >= 2 && !found.is_ambiguous, "{i}: {found:?}");
        let (angle, share) = errors(&found.pose, &pose);
        assert!(angle < 1.0 && share < 0.02, "{i}: {angle} degrees, {share} of the distance");
        degrees.push(angle);
        shares.push(share);
    }
    let (angle, share) = (median(degrees), median(shares));
    println!("median {angle:.3} degrees, {:.3} % of the distance", 100.0 * share);
    assert!(angle < 0.1 && share < 0.002, "{angle} degrees, {share}");
}

#[test]
fn the_focal_length_is_learned_from_views_all_around() {
    let board = Board::default();
    // Fields of view of 39, 55 and 83 degrees; 64 are assumed.
    for focal_px in [900.0, 610.0, 360.0] {
        let mut tracker = Tracker::new(board);
        let truth = Intrinsics { focal_px, cx: 320.0, cy: 240.0 };
        let mut last = None;
        for (i, pose) in (0..).zip(around().into_iter().step_by(2)) {
            // As large in every camera.
            let away = pose.position() * (focal_px / 540.0 - 1.0) as f32;
            let pose = Pose::try_new(pose.position() + away, pose.rotation()).unwrap();
            let picture = Picture { intrinsics: truth, noise: 3.0, seed: i, ..Picture::default() };
            let luma = picture.draw(&board, &pose);
            let tracked = tracker.track(&Frame::try_new(&luma, 640, 480).unwrap());
            if i == 0 {
                assert_eq!(tracked.source, IntrinsicsSource::Assumed);
            }
            let found = tracked.pose.unwrap();
            last = Some((tracked.source, errors(&found.pose, &pose)));
        }
        let calibration = tracker.calibration().unwrap();
        println!("{calibration:?}");
        let off = calibration.intrinsics.focal_px / focal_px - 1.0;
        assert!(off.abs() < 0.005, "{focal_px}: {calibration:?}");
        let (source, (angle, share)) = last.unwrap();
        assert_eq!(source, IntrinsicsSource::Calibrated);
        assert!(angle < 0.5 && share < 0.01, "{focal_px}: {angle} degrees, {share}");
        // Another size is another camera.
        let luma = vec![0; 320 * 240];
        tracker.track(&Frame::try_new(&luma, 320, 240).unwrap());
        assert_eq!(tracker.calibration(), None);
    }
}

#[test]
fn a_principal_point_off_the_middle_is_learned_too() {
    let board = Board::default();
    let mut tracker = Tracker::new(board);
    let truth = Intrinsics { focal_px: 560.0, cx: 331.0, cy: 234.0 };
    for (i, pose) in (0..).zip(around()) {
        // The phone is held upright and across by turns.
        let rows = pose.rows();
        let turned = if i % 2 == 0 {
            pose
        } else {
            Pose::try_from_rows(rows.map(|[a, b, c, x]| [b, -a, c, x])).unwrap()
        };
        let picture = Picture { intrinsics: truth, noise: 2.0, seed: i, ..Picture::default() };
        let luma = picture.draw(&board, &turned);
        tracker.track(&Frame::try_new(&luma, 640, 480).unwrap());
    }
    let found = tracker.calibration().unwrap();
    println!("{found:?}");
    assert!((found.intrinsics.focal_px - 560.0).abs() < 3.0, "{found:?}");
    assert!((found.intrinsics.cx - 331.0).abs() < 2.0, "{found:?}");
    assert!((found.intrinsics.cy - 234.0).abs() < 2.0, "{found:?}");
}

/// From straight above any focal length fits, with the board as much nearer or farther.
#[test]
fn views_from_above_give_no_focal_length_however_the_camera_is_turned() {
    let board = Board::default();
    let mut tracker = Tracker::new(board);
    for i in 0..8 {
        let pose = looking(30.0 * i as f32, 89.0, 0.5);
        let picture =
            Picture { intrinsics: given(), noise: 3.0, seed: i, samples: 2, ..Picture::default() };
        let luma = picture.draw(&board, &pose);
        tracker.track(&Frame::try_new(&luma, 640, 480).unwrap());
    }
    assert_eq!(tracker.calibrate(), None);
}

#[test]
fn a_single_tag_is_called_ambiguous_and_two_are_not() {
    let spec = BoardSpec { columns: 1, rows: 1, ..BoardSpec::default() };
    let pose = looking(30.0, 55.0, 0.35);
    for (columns, is_ambiguous) in [(1, true), (2, false)] {
        let board = Board::try_new(BoardSpec { columns, ..spec }).unwrap();
        let mut tracker = Tracker::new(board);
        tracker.set_intrinsics(given()).unwrap();
        let luma = Picture { intrinsics: given(), ..Picture::default() }.draw(&board, &pose);
        let tracked = tracker.track(&Frame::try_new(&luma, 640, 480).unwrap());
        let found = tracked.pose.unwrap();
        assert_eq!(found.is_ambiguous, is_ambiguous, "{columns} tags: {found:?}");
        let (angle, share) = errors(&found.pose, &pose);
        assert!(angle < 1.0 && share < 0.02, "{angle} degrees, {share}");
    }
}

#[test]
fn a_frame_of_two_million_pixels_is_searched_at_half_its_size() {
    let board = Board::default();
    let pose = looking(200.0, 35.0, 0.7);
    let intrinsics = Intrinsics { focal_px: 1600.0, cx: 960.0, cy: 540.0 };
    let picture =
        Picture { intrinsics, width: 1920, height: 1080, noise: 3.0, ..Picture::default() };
    let luma = picture.draw(&board, &pose);
    let mut tracker = Tracker::new(board);
    tracker.set_intrinsics(intrinsics).unwrap();
    let tracked = tracker.track(&Frame::try_new(&luma, 1920, 1080).unwrap());
    assert_eq!(tracked.tags.len(), 20, "{:?}", tracked.tags);
    let found = tracked.pose.unwrap();
    assert!(found.rms_px < 0.15, "{found:?}");
    let (angle, share) = errors(&found.pose, &pose);
    assert!(angle < 0.05 && share < 0.001, "{angle} degrees, {share}");
}

#[test]
fn tags_of_another_board_are_not_taken_for_ours() {
    let theirs = Board::try_new(BoardSpec { first_id: 100, ..BoardSpec::default() }).unwrap();
    let luma = Picture { intrinsics: given(), ..Picture::default() }
        .draw(&theirs, &looking(0.0, 60.0, 0.5));
    let frame = Frame::try_new(&luma, 640, 480).unwrap();
    let tracked = Tracker::new(Board::default()).track(&frame);
    assert!(tracked.tags.is_empty() && tracked.pose.is_none());
    assert_eq!(Tracker::new(theirs).track(&frame).tags.len(), 20);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    /// Whatever the bytes, nothing panics and no tag is seen in noise.
    #[test]
    fn noise_shows_no_tag(
        width in 1usize..90,
        height in 1usize..90,
        seed in any::<u64>(),
        coarse in 1usize..12,
        levels in prop::sample::select(vec![2u64, 3, 255]),
    ) {
        let luma: Vec<u8> = (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width / coarse) as u64, (i / width / coarse) as u64);
                let mixed = (x * 0x9e37_79b9 + y * 0x85eb_ca6b + 1).wrapping_mul(seed | 1);
                let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40;
                (mixed % levels * (255 / (levels - 1))) as u8
            })
            .collect();
        let tracked = Tracker::default().track(&Frame::try_new(&luma, width, height).unwrap());
        prop_assert!(tracked.tags.is_empty());
    }

    /// A board with bytes overwritten is seen or not, and nothing panics; a pose that is called sure
    /// may be vague, from a few tags far away, but is not one from another side.
    #[test]
    fn a_spoilt_picture_gives_a_pose_or_none(
        azimuth in 0.0f32..360.0,
        elevation in 5.0f32..70.0,
        distance in 0.05f32..3.0,
        from in 0usize..640 * 480,
        length in 0usize..200_000,
        value in any::<u8>(),
    ) {
        let board = Board::default();
        let pose = looking(azimuth, elevation, distance);
        let picture = Picture { intrinsics: given(), samples: 1, ..Picture::default() };
        let mut luma = picture.draw(&board, &pose);
        let end = (from + length).min(luma.len());
        luma[from..end].fill(value);
        let mut tracker = Tracker::new(board);
        tracker.set_intrinsics(given()).unwrap();
        let tracked = tracker.track(&Frame::try_new(&luma, 640, 480).unwrap());
        if let Some(found) = tracked.pose && !found.is_ambiguous {
            let (angle, share) = errors(&found.pose, &pose);
            prop_assert!(angle < 15.0 && share < 0.25, "{} degrees, {}: {:?}", angle, share, found);
        }
    }
}
