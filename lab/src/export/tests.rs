//! The layout of the folders, and that every file holds the poses that were given.

use std::collections::BTreeSet;
use std::path::PathBuf;

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use serde_json::Value;

use super::colmap::CameraFromWorld;
use super::*;

fn capture(photos: usize, points: usize) -> Capture {
    let camera = Camera::from_fov(6, 4, 0.8).unwrap();
    let photo = |index: usize| {
        let angle = index as f32;
        let eye = Vec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.5 * angle - 1.0);
        let pose = Pose::looking_at(eye, Vec3::ZERO).unwrap();
        let shade = image::Rgba([index as u8 * 9, 50, 200, 128]);
        Photo { pose, image: RgbaImage::from_pixel(6, 4, shade) }
    };
    let point = |index: usize| Point {
        position: Vec3::new(index as f32 * 0.004, -0.5, 0.25),
        colour: [index as u8, 2, 3],
    };
    Capture {
        camera,
        photos: (0..photos).map(photo).collect(),
        points: (0..points).map(point).collect(),
    }
}

fn written(profile: Profile<'_>, capture: &Capture) -> (tempfile::TempDir, PathBuf) {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("out");
    write(&dir, profile, capture).unwrap();
    (home, dir)
}

fn tree(dir: &Path) -> BTreeSet<String> {
    fn walk(dir: &Path, root: &Path, files: &mut BTreeSet<String>) {
        for entry in fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, root, files);
            } else {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap();
                files.insert(name.replace('\\', "/"));
            }
        }
    }
    let mut files = BTreeSet::new();
    walk(dir, dir, &mut files);
    files
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn the_trainer_folder_has_these_files_and_no_others() {
    let (_home, dir) = written(Profile::Trainer, &capture(2, 120));
    let expected = [
        "images/frame_00001.png",
        "images/frame_00002.png",
        "nb-info.json",
        "sparse/0/cameras.bin",
        "sparse/0/cameras.txt",
        "sparse/0/images.bin",
        "sparse/0/images.txt",
        "sparse/0/points3D.bin",
        "sparse/0/points3D.txt",
        "sparse_pc.ply",
        "transforms.json",
    ];
    assert_eq!(tree(&dir), expected.map(String::from).into());
}

#[test]
fn transforms_json_says_what_the_trainers_ask() {
    let capture = capture(3, 0);
    let (_home, dir) = written(Profile::Trainer, &capture);
    let found = json(&dir.join("transforms.json"));
    assert_eq!(found["camera_model"], "OPENCV");
    assert_eq!((found["w"].as_u64(), found["h"].as_u64()), (Some(6), Some(4)));
    for (key, value) in [("k1", 0.0), ("p2", 0.0), ("cx", 3.0), ("cy", 2.0)] {
        assert_eq!(found[key], value, "{key}");
    }
    assert!((found["camera_angle_x"].as_f64().unwrap() - 0.8).abs() < 1e-6);
    assert_eq!(found["aabb_scale"], 1);
    assert_eq!(found["ply_file_path"], "sparse_pc.ply");
    assert_eq!(found["frames"][2]["file_path"], "images/frame_00003.png");
    for (frame, photo) in found["frames"].as_array().unwrap().iter().zip(&capture.photos) {
        for (row, expected) in photo.pose.rows().into_iter().enumerate() {
            for (column, expected) in expected.into_iter().enumerate() {
                let got = frame["transform_matrix"][row][column].as_f64().unwrap();
                assert!((got - f64::from(expected)).abs() < 1e-6);
            }
        }
        assert_eq!(frame["transform_matrix"][3], serde_json::json!([0.0, 0.0, 0.0, 1.0]));
    }
}

#[test]
fn each_image_of_the_model_is_followed_by_a_blank_line() {
    let (_home, dir) = written(Profile::Trainer, &capture(3, 0));
    let text = fs::read_to_string(dir.join("sparse/0/images.txt")).unwrap();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines.len(), 6);
    for (index, pair) in lines.chunks(2).enumerate() {
        let fields: Vec<&str> = pair[0].split(' ').collect();
        assert_eq!(fields.len(), 10);
        assert_eq!(fields[0], (index + 1).to_string());
        assert_eq!(fields[9], format!("frame_{:05}.png", index + 1));
        assert_eq!(pair[1], "");
    }
    let cameras = fs::read_to_string(dir.join("sparse/0/cameras.txt")).unwrap();
    assert!(cameras.lines().any(|line| line.starts_with("1 PINHOLE 6 4 ")), "{cameras}");
}

#[test]
fn the_binary_model_has_the_size_its_format_gives() {
    let (_home, dir) = written(Profile::Trainer, &capture(3, 130));
    let size = |name: &str| fs::metadata(dir.join("sparse/0").join(name)).unwrap().len();
    assert_eq!(size("cameras.bin"), 8 + 4 + 4 + 8 + 8 + 4 * 8);
    assert_eq!(size("images.bin"), 8 + 3 * (4 + 7 * 8 + 4 + "frame_00001.png\0".len() as u64 + 8));
    assert_eq!(size("points3D.bin"), 8 + 130 * (8 + 3 * 8 + 3 + 8 + 8));
}

#[test]
fn too_few_points_are_padded_within_the_unit_sphere() {
    for given in [0, 1, 99] {
        let points = capture(1, given).points;
        let all = points::padded(&points);
        assert_eq!(all.len(), LEAST_POINTS);
        assert_eq!(all[..given], points);
        assert!(all[given..].iter().all(|point| point.position.length() <= 1.0));
        assert_eq!(all, points::padded(&points));
    }
    assert_eq!(points::padded(&capture(1, 150).points).len(), 150);
    let (_home, dir) = written(Profile::Trainer, &capture(1, 0));
    let ply = fs::read(dir.join("sparse_pc.ply")).unwrap();
    let header = ply.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    assert!(String::from_utf8_lossy(&ply[..header]).contains("element vertex 100\n"));
    assert_eq!(ply.len() - header, 100 * 15);
}

#[test]
fn a_far_point_widens_the_box_of_instant_ngp() {
    let mut capture = capture(1, 0);
    capture.points.push(Point { position: Vec3::new(0.0, -5.0, 0.0), colour: [0; 3] });
    let (_home, dir) = written(Profile::Trainer, &capture);
    assert_eq!(json(&dir.join("transforms.json"))["aabb_scale"], 4);
}

#[test]
fn the_synthetic_folder_has_three_splits() {
    let (train, val, test) = (capture(3, 0), capture(1, 0), capture(2, 0));
    let profile = Profile::NerfSynthetic { val: Some(&val), test: &test };
    let (_home, dir) = written(profile, &train);
    let expected = [
        "nb-info.json",
        "test/r_0.png",
        "test/r_1.png",
        "train/r_0.png",
        "train/r_1.png",
        "train/r_2.png",
        "transforms_test.json",
        "transforms_train.json",
        "transforms_val.json",
        "val/r_0.png",
    ];
    assert_eq!(tree(&dir), expected.map(String::from).into());
    let found = json(&dir.join("transforms_train.json"));
    assert_eq!(found["frames"][2]["file_path"], "./train/r_2");
    assert!((found["camera_angle_x"].as_f64().unwrap() - 0.8).abs() < 1e-6);
    let saved = image::open(dir.join("train/r_1.png")).unwrap();
    assert_eq!(saved.color(), image::ColorType::Rgba8);
    assert_eq!(saved.to_rgba8(), train.photos[1].image);
}

#[test]
fn without_validation_views_the_test_views_are_named_openly() {
    let (train, test) = (capture(3, 0), capture(2, 0));
    let (_home, dir) = written(Profile::NerfSynthetic { val: None, test: &test }, &train);
    let val = fs::read(dir.join("transforms_val.json")).unwrap();
    assert_eq!(val, fs::read(dir.join("transforms_test.json")).unwrap());
    assert!(!dir.join("val").exists());
}

#[test]
fn what_no_file_can_hold_is_refused_and_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("out");
    let good = capture(2, 0);
    let refuse = |profile: Profile<'_>, capture: &Capture, words: &str| {
        let refused = write(&dir, profile, capture).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0);
    };
    refuse(Profile::Trainer, &capture(0, 0), "no photos");
    refuse(Profile::NerfSynthetic { val: None, test: &capture(0, 0) }, &good, "no photos");
    let mut wrong = capture(2, 0);
    wrong.photos[1].image = RgbaImage::new(5, 4);
    refuse(Profile::Trainer, &wrong, "photo 1 is 5 x 4 pixels where the camera has 6 x 4");
    let mut wrong = capture(2, 3);
    wrong.points[2].position.y = f32::NAN;
    refuse(Profile::Trainer, &wrong, "point 2");
    let mut wrong = capture(2, 0);
    wrong.camera.cx += 1.0;
    refuse(Profile::NerfSynthetic { val: None, test: &good }, &wrong, "central principal point");
}

proptest! {
    #[test]
    fn the_colmap_pose_sees_what_the_pose_sees(
        eye in prop::array::uniform3(-4.0f32..4.0),
        turn in prop::array::uniform4(-1.0f32..1.0),
        point in prop::array::uniform3(-1.0f32..1.0),
    ) {
        let turn = vantage_core::Quat::from_array(turn);
        prop_assume!(turn.length() > 0.1);
        let pose = Pose::try_new(Vec3::from_array(eye), turn / turn.length()).unwrap();
        let CameraFromWorld { rotation, translation } = CameraFromWorld::from(&pose);
        prop_assert!((rotation.length() - 1.0).abs() < 1e-12 && rotation.w >= 0.0);

        // A point: OpenCV's y and z are OpenGL's, reversed. f32 rounds at |p| ~ 7.
        let point = Vec3::from_array(point);
        let ours = pose.camera_from_world(point).as_dvec3() * DVec3::new(1.0, -1.0, -1.0);
        let theirs = rotation * point.as_dvec3() + translation;
        prop_assert!((ours - theirs).abs().max_element() < 5e-6);

        // Back again: the rows of the pose, and transforms.json to the last digits.
        let back = DMat3::from_quat(rotation).transpose();
        let position = -(back * translation);
        let matrix = transforms::matrix_of(&pose);
        let rows = pose.rows();
        for row in 0..3 {
            for (column, sign) in [1.0, -1.0, -1.0].into_iter().enumerate() {
                let got = sign * back.col(column)[row];
                prop_assert!((got - matrix[row][column]).abs() < 1e-12);
                prop_assert!((got - f64::from(rows[row][column])).abs() < 1e-6);
            }
            prop_assert!((position[row] - matrix[row][3]).abs() < 1e-12);
            prop_assert!((position[row] - f64::from(rows[row][3])).abs() < 1e-6);
        }
    }
}
