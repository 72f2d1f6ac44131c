use super::*;
use crate::mesh;
use crate::pool::{DISTANCE, FOV_X_RAD};
use crate::render::{PhotoOptions, Renderer};
use glam::{DMat4, DQuat};
use serde_json::{Value, json};
use tempfile::TempDir;
use vantage_core::{Camera, Vec2};

/// Matrices of cameras on a ring around the origin, as rows.
fn ring(count: usize, distance: f32) -> Vec<Pose> {
    let place = |index: usize| {
        let azimuth = index as f32 / count as f32 * std::f32::consts::TAU;
        Vec3::new(azimuth.cos(), azimuth.sin(), 0.3) * distance
    };
    (0..count).map(|index| Pose::looking_at(place(index), Vec3::ZERO).unwrap()).collect()
}

fn matrix(pose: &Pose) -> Value {
    json!(crate::record::matrix_of(pose))
}

/// A capture of a ring of photos of 40 x 30 pixels.
fn transforms(count: usize) -> Value {
    let frames: Vec<Value> = (ring(count, 4.0).iter().enumerate())
        .map(|(index, pose)| {
            json!({"file_path": format!("images/{index}"), "transform_matrix": matrix(pose)})
        })
        .collect();
    json!({"fl_x": 50.0, "w": 40, "h": 30, "aabb_scale": 4, "frames": frames})
}

fn folder(transforms: &Value, sizes: &[[u32; 2]]) -> TempDir {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("transforms.json"), transforms.to_string()).unwrap();
    fs::create_dir(home.path().join("images")).unwrap();
    for (index, [width, height]) in sizes.iter().enumerate() {
        let picture = RgbImage::from_pixel(*width, *height, image::Rgb([90, 120, 150]));
        picture.save(home.path().join(format!("images/{index}.png"))).unwrap();
    }
    home
}

fn open(home: &TempDir) -> Result<Capture, PhotosError> {
    Capture::open(home.path(), &Known::default(), |_| {})
}

#[test]
fn a_ring_of_cameras_tells_centre_distance_and_up() {
    let home = folder(&transforms(8), &[[40, 30]; 8]);
    let capture = open(&home).unwrap();
    assert_eq!((capture.photos.len(), capture.skipped.len()), (8, 0));
    assert!(capture.layout.centre.length() < 1e-6);
    assert!((capture.layout.up() - DVec3::Z).length() < 1e-6);
    let distance = 4.0 * 1.09f64.sqrt();
    assert!((capture.layout.distance - distance).abs() < 1e-5);
    // The largest sphere in a picture 30 pixels high: sin(atan(15 / 50)) at that distance.
    assert!((capture.layout.radius - distance * 15.0 / 50f64.hypot(15.0)).abs() < 1e-5);
}

#[test]
fn a_turned_moved_and_scaled_world_gives_the_same_plan_back_in_its_own_coordinates() {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 1.1, -0.4, 0.7);
    let (shift, scale) = (DVec3::new(500.0, -20.0, 7.0), 0.25);
    let mut value = transforms(8);
    for (frame, pose) in value["frames"].as_array_mut().unwrap().iter_mut().zip(ring(8, 4.0)) {
        let position = shift + turn * pose.position().as_dvec3() * scale;
        let rotation = turn * pose.rotation().as_dquat().normalize();
        let matrix = DMat4::from_rotation_translation(rotation, position).transpose();
        frame["transform_matrix"] = json!(matrix.to_cols_array_2d());
    }
    let capture = open(&folder(&value, &[[40, 30]; 8])).unwrap();
    let layout = &capture.layout;
    assert!(layout.centre.distance(shift) < 1e-4);
    // The cameras look 17 degrees down: the mean of their tops is the world's all the same.
    assert!((layout.up() - turn * DVec3::Z).length() < 1e-5);
    for photo in &capture.photos {
        let elevation = words::elevation_deg(photo.direction);
        assert!((elevation - 16.7).abs() < 0.1, "{elevation}");
        let (position, axes) = layout.in_file(&photo.pose);
        assert!(position.distance(photo.position) < 1e-4);
        let back = (position - layout.centre).normalize();
        assert!(axes.z_axis.distance(back) < 1e-5);
    }
}

#[test]
fn a_few_photos_of_something_else_do_not_move_the_centre_far() {
    let mut value = transforms(12);
    let astray = Pose::looking_at(Vec3::new(4.0, 0.0, 1.0), Vec3::new(0.0, 5.0, 1.0)).unwrap();
    value["frames"][3]["transform_matrix"] = matrix(&astray);
    let capture = open(&folder(&value, &[[40, 30]; 12])).unwrap();
    assert!(capture.layout.centre.length() < 0.02, "{}", capture.layout.centre);
    assert_eq!(capture.skipped.len(), 1);
    assert!(capture.skipped[0].why.contains("hardly shows"), "{:?}", capture.skipped);
}

#[test]
fn cameras_on_their_side_have_their_up_too() {
    let mut value = transforms(8);
    for (frame, pose) in value["frames"].as_array_mut().unwrap().iter_mut().zip(ring(8, 4.0)) {
        let rolled =
            pose.rotation() * vantage_core::Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
        frame["transform_matrix"] = matrix(&Pose::try_new(pose.position(), rolled).unwrap());
    }
    let capture = open(&folder(&value, &[[40, 30]; 8])).unwrap();
    assert!((capture.layout.up() - DVec3::Z).length() < 1e-3);
}

#[test]
fn a_photo_taken_anyhow_gives_the_picture_of_training() {
    let mut shoe = mesh::class("shoe", 3).unwrap();
    mesh::normalise(&mut shoe);
    let renderer = Renderer::new(&shoe);
    let options = PhotoOptions { background: Some([128; 3]), ..PhotoOptions::default() };
    let direction = Vec3::new(0.6, -0.7, 0.39).normalize();
    let training = Camera::from_fov(WINDOW, WINDOW, FOV_X_RAD).unwrap();

    // Another focal length, an uneven principal point, off the middle and rolled, from three
    // distances: from that of training it is the same picture, from others nearly.
    for (distance, most) in [(DISTANCE, 1.5), (1.6 * DISTANCE, 5.0), (0.8 * DISTANCE, 5.0)] {
        let looking = Pose::looking_at(direction * distance, Vec3::new(0.2, 0.1, 0.15)).unwrap();
        let roll = vantage_core::Quat::from_rotation_z(0.5);
        let pose = Pose::try_new(looking.position(), looking.rotation() * roll).unwrap();
        let camera =
            Camera::try_new(900, 700, Vec2::new(650.0, 655.0), Vec2::new(470.0, 330.0)).unwrap();
        let photo = renderer.photo(&camera, &pose, &options);
        let taken = Taken {
            position: pose.position().as_dvec3(),
            rotation: pose.rotation().as_dquat().normalize(),
            lens: layout::tests::lens(&camera),
        };
        let layout = layout::tests::around_origin(1.0, f64::from(distance));
        let expected_pose = layout.looking_from(direction).unwrap();
        let (_, axes) = layout.in_file(&expected_pose);
        let (window, share) = window::cut(&Light::of(&photo), &taken, axes, &layout, WINDOW);
        assert!(share > 0.95, "{share}");
        let expected = renderer.photo(&training, &expected_pose, &options);
        let difference: f64 = (window.pixels().zip(expected.pixels()))
            .map(|(a, b)| (0..3).map(|c| f64::from(a.0[c].abs_diff(b.0[c]))).sum::<f64>() / 3.0)
            .sum::<f64>()
            / f64::from(WINDOW * WINDOW);
        assert!(difference < most, "{distance}: {difference}");
    }
}

#[test]
fn absent_and_corrupt_photos_are_reported_and_skipped() {
    let home = folder(&transforms(8), &[[40, 30]; 8]);
    fs::remove_file(home.path().join("images/2.png")).unwrap();
    fs::write(home.path().join("images/4.png"), "no picture").unwrap();
    let whole = fs::read(home.path().join("images/5.png")).unwrap();
    fs::write(home.path().join("images/5.png"), &whole[..whole.len() / 2]).unwrap();
    let capture = open(&home).unwrap();
    let skipped: Vec<(usize, &str)> =
        capture.skipped.iter().map(|skipped| (skipped.number, skipped.why.as_str())).collect();
    assert_eq!(capture.photos.len(), 5);
    assert_eq!(skipped[0], (3, "there is no such file"));
    assert_eq!(skipped[1].0, 5);
    assert!(skipped[1].1.contains("neither PNG nor JPEG"), "{skipped:?}");
    assert!(skipped[2].0 == 6 && skipped[2].1.contains("cannot be decoded"), "{skipped:?}");

    let home = folder(&transforms(8), &[]);
    let error = open(&home).unwrap_err();
    assert!(matches!(error, PhotosError::NoneLeft(8, _)), "{error}");
}

#[test]
fn sizes_may_differ_only_with_intrinsics_of_their_own() {
    let mut sizes = [[40, 30]; 8];
    sizes[6] = [80, 60];
    let error = open(&folder(&transforms(8), &sizes)).unwrap_err();
    assert!(matches!(error, PhotosError::MixedSizes { .. }), "{error}");
    let mut own = transforms(8);
    for (frame, [w, h]) in own["frames"].as_array_mut().unwrap().iter_mut().zip(sizes) {
        frame["fl_x"] = json!(1.25 * f64::from(w));
        frame["w"] = json!(w);
        frame["h"] = json!(h);
    }
    assert_eq!(open(&folder(&own, &sizes)).unwrap().photos.len(), 8);
    // All photos half as large as the file says: its numbers are of the originals.
    let halved = open(&folder(&transforms(8), &[[20, 15]; 8])).unwrap();
    let whole = open(&folder(&transforms(8), &[[40, 30]; 8])).unwrap();
    assert!((halved.layout.radius - whole.layout.radius).abs() < 1e-9);
    let error = open(&folder(&transforms(8), &[[30, 40]; 8])).unwrap_err().to_string();
    assert!(error.contains("frame 1") && error.contains("sideways"), "{error}");
}

#[test]
fn what_is_wrong_is_said_with_the_frame_and_the_field() {
    let set = |change: fn(&mut Value)| {
        let mut value = transforms(8);
        change(&mut value);
        value
    };
    let scaled: fn(&mut Value) = |v| {
        for row in v["frames"][1]["transform_matrix"].as_array_mut().unwrap().iter_mut().take(3) {
            for part in row.as_array_mut().unwrap().iter_mut().take(3) {
                *part = json!(2.0 * part.as_f64().unwrap());
            }
        }
    };
    let mirrored: fn(&mut Value) = |v| {
        for row in v["frames"][1]["transform_matrix"].as_array_mut().unwrap().iter_mut().take(3) {
            row[0] = json!(-row[0].as_f64().unwrap());
        }
    };
    let parallel: fn(&mut Value) = |v| {
        for (index, frame) in v["frames"].as_array_mut().unwrap().iter_mut().enumerate() {
            frame["transform_matrix"] =
                json!([[1, 0, 0, index], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]);
        }
    };
    for (value, says) in [
        (set(|v| *v = json!({})), "no list `frames`"),
        (set(|v| v["frames"] = json!([])), "lists no frames"),
        (set(|v| v["fl_x"] = Value::Null), "frame 1 of transforms.json, images/0, has no `fl_x`"),
        (set(|v| v["fl_x"] = json!(-1.0)), "`fl_x` that is not more than 0"),
        (set(|v| v["cx"] = json!("left")), "`cx` that is not a finite number"),
        (set(|v| v["h"] = Value::Null), "has no `h`"),
        (set(|v| v["frames"][2]["file_path"] = json!(7)), "frame 3 of transforms.json has"),
        (
            set(|v| v["frames"][4]["transform_matrix"] = json!([[1, 0], [0, 1]])),
            "images/4, has a `transform_matrix` that is not 4 rows",
        ),
        (set(|v| v["camera_model"] = json!("OPENCV_FISHEYE")), "lens model OPENCV_FISHEYE"),
        (set(scaled), "scaled by 2.0000"),
        (set(mirrored), "mirrors"),
        (set(parallel), "meet nowhere"),
    ] {
        let error = open(&folder(&value, &[[40, 30]; 8])).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    let one = open(&folder(&transforms(1), &[[40, 30]])).unwrap_err();
    assert_eq!(one, PhotosError::Parallel(1));

    let home = tempfile::tempdir().unwrap();
    let missing = home.path().join("nothing");
    let error = Capture::open(&missing, &Known::default(), |_| {}).unwrap_err();
    assert_eq!(error, PhotosError::NoFolder(missing));
    assert!(matches!(open(&home), Err(PhotosError::NoTransforms(_))));
    fs::write(home.path().join("transforms.json"), "{").unwrap();
    assert!(open(&home).unwrap_err().to_string().contains("is not JSON"));
}

#[test]
fn what_is_known_need_not_be_found_out() {
    let home = folder(&transforms(1), &[[40, 30]]);
    let known = Known { centre: Some([0.0; 3]), radius: Some(1.0), up: Some([0.0, 0.0, 2.0]) };
    let capture = Capture::open(home.path(), &known, |_| {}).unwrap();
    assert_eq!(capture.layout.centre, DVec3::ZERO);
    assert_eq!(capture.layout.radius, 1.0);
    for known in [
        Known { centre: Some([f64::NAN; 3]), ..known },
        Known { radius: Some(-1.0), ..known },
        Known { up: Some([0.0; 3]), ..known },
    ] {
        let error = Capture::open(home.path(), &known, |_| {}).unwrap_err();
        assert!(matches!(error, PhotosError::BadOption(_)), "{error}");
    }
}
