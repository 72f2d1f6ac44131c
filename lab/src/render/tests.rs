//! Laws of the pictures, each on a mesh made for it.

use std::sync::Arc;

use image::{Rgba, RgbaImage};
use vantage_core::{Camera, Pose, Vec2, Vec3};

use super::{FaceImage, NO_FACE, PhotoOptions, Renderer};
use crate::mesh::{Material, Mesh, Texture, Wrap, builtin, noisy_blob, normalise};

/// One pixel is one unit long at depth 1; the camera stands at the origin and looks along -Z.
fn pixels(width: u32, height: u32) -> Camera {
    let (w, h) = (width as f32, height as f32);
    Camera::try_new(width, height, Vec2::ONE, Vec2::new(0.5 * w, 0.5 * h)).unwrap()
}

fn at_origin() -> Pose {
    Pose::try_new(Vec3::ZERO, vantage_core::Quat::IDENTITY).unwrap()
}

fn mesh_of(positions: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh {
        face_material: vec![0; faces.len()],
        positions,
        faces,
        materials: vec![Material::plain("white", [1.0; 3])],
        ..Mesh::default()
    }
}

/// Points on the plane at depth 1, in pixels from the upper left corner of an 8 x 8 picture.
fn flat(points: &[(f32, f32)]) -> Vec<Vec3> {
    points.iter().map(|&(x, y)| Vec3::new(x - 4.0, 4.0 - y, -1.0)).collect()
}

fn drawing(image: &FaceImage) -> String {
    let letter = |face: &u32| if *face == NO_FACE { '.' } else { (b'0' + *face as u8) as char };
    let row = |row: &[u32]| row.iter().map(letter).collect::<String>();
    image.faces.chunks(image.width as usize).map(row).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_triangle_covers_the_pixels_whose_centres_it_holds() {
    let mesh = mesh_of(flat(&[(1.0, 1.0), (7.0, 1.0), (1.0, 7.0)]), vec![[0, 1, 2]]);
    let image = Renderer::new(&mesh).faces(&pixels(8, 8), &at_origin());
    // The slanted edge runs through centres: it is a right edge and does not own them.
    let expected = "\
        ........\n\
        .00000..\n\
        .0000...\n\
        .000....\n\
        .00.....\n\
        .0......\n\
        ........\n\
        ........";
    assert_eq!(drawing(&image), expected);
}

#[test]
fn two_triangles_share_a_square_pixel_by_pixel() {
    let corners = flat(&[(1.5, 1.5), (6.5, 1.5), (6.5, 6.5), (1.5, 6.5)]);
    let mesh = mesh_of(corners, vec![[0, 3, 2], [0, 2, 1]]);
    let image = Renderer::new(&mesh).faces(&pixels(8, 8), &at_origin());
    // All edges run through centres: the left and the upper ones own them.
    let expected = "\
        ........\n\
        .11111..\n\
        .01111..\n\
        .00111..\n\
        .00011..\n\
        .00001..\n\
        ........\n\
        ........";
    assert_eq!(drawing(&image), expected);
}

/// A grid of cells over the whole picture, its inner vertices moved about, in random triangles.
fn shaken_grid(cells: u32, side: f32) -> Mesh {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for j in 0..=cells {
        for i in 0..=cells {
            let is_inner = i > 0 && i < cells && j > 0 && j < cells;
            let mut shift = || if is_inner { 0.6 * random() } else { 0.0 };
            let (x, y) = ((i as f32 + shift()) / cells as f32, (j as f32 + shift()) / cells as f32);
            // A tilted plane, twice as far on the right; x and y are what they are on the picture.
            let depth = 1.0 + x;
            let place = Vec3::new((x - 0.5) * side * depth, (0.5 - y) * side * depth, -depth);
            positions.push(place);
        }
    }
    let row = cells + 1;
    for j in 0..cells {
        for i in 0..cells {
            let a = j * row + i;
            let (b, c, d) = (a + 1, a + row, a + row + 1);
            if random() > 0.0 {
                faces.extend([[a, c, b], [b, c, d]]);
            } else {
                faces.extend([[a, c, d], [d, b, a]]);
            }
        }
    }
    mesh_of(positions, faces)
}

#[test]
fn a_subdivided_plane_hits_each_pixel_exactly_once() {
    for (cells, side) in [(1, 64u32), (5, 64), (23, 64), (90, 48), (40, 300)] {
        let mesh = shaken_grid(cells, side as f32);
        let camera = pixels(side, side);
        let renderer = Renderer::new(&mesh);
        let whole = renderer.faces(&camera, &at_origin());
        assert!(whole.faces.iter().all(|face| *face != NO_FACE), "a gap among {cells} cells");
        // Exactly once: each face drawn alone covers what it owns in the whole, and no more.
        let mut hits = 0;
        for face in 0..mesh.faces.len() {
            let alone = mesh_of(mesh.positions.clone(), vec![mesh.faces[face]]);
            let image = Renderer::new(&alone).faces(&camera, &at_origin());
            hits += image.faces.iter().filter(|face| **face != NO_FACE).count();
            if cells > 23 && face > 200 {
                hits = whole.faces.len(); // the rest by the same law, in less time
                break;
            }
        }
        assert_eq!(hits, whole.faces.len(), "{cells} cells");
    }
}

#[test]
fn a_sphere_has_the_silhouette_that_geometry_gives_it() {
    let mut ball = builtin("ball", 0).unwrap();
    normalise(&mut ball);
    let (distance, focal) = (3.0f32, 400.0f32);
    let camera = Camera::try_new(400, 320, Vec2::new(focal, 0.7 * focal), Vec2::new(190.0, 170.0));
    let pose = Pose::looking_at(Vec3::new(0.0, -distance, 0.0), Vec3::ZERO).unwrap();
    let image = Renderer::new(&ball).faces(&camera.unwrap(), &pose);
    let area = image.faces.iter().filter(|face| **face != NO_FACE).count() as f32;
    // The cone around the sphere has tan² = 1 / (d² - 1); chords of 96 sides are a little inside.
    let expected = std::f32::consts::PI * focal * 0.7 * focal / (distance * distance - 1.0);
    assert!((area / expected - 1.0).abs() < 0.006, "{area} pixels, expected {expected}");
}

#[test]
fn of_coincident_faces_the_lower_index_wins() {
    let corners = flat(&[(1.0, 0.3), (7.7, 2.1), (2.4, 7.9)]);
    let positions: Vec<Vec3> = (0..3).flat_map(|_| corners.clone()).collect();
    // The same triangle with its corners rotated, reversed, and with vertices of its own.
    for (first, second) in [([0, 1, 2], [1, 2, 0]), ([0, 1, 2], [2, 1, 0]), ([4, 5, 3], [0, 2, 1])]
    {
        let mesh = mesh_of(positions.clone(), vec![first, second]);
        for camera in [pixels(8, 8), Camera::from_fov(300, 200, 1.2).unwrap()] {
            let seen = Renderer::new(&mesh).faces(&camera, &at_origin()).visible();
            assert_eq!(seen, [0], "{first:?} {second:?}");
        }
    }
}

#[test]
fn the_nearer_face_hides_the_other_whatever_their_order() {
    let near = flat(&[(0.0, 0.0), (8.0, 0.0), (0.0, 8.0)]);
    let far: Vec<Vec3> = near.iter().map(|p| *p * 1.01).collect();
    let both: Vec<Vec3> = near.iter().chain(&far).copied().collect();
    for (faces, winner) in [([[0, 1, 2], [3, 4, 5]], 0), ([[3, 4, 5], [0, 1, 2]], 1)] {
        let image = Renderer::new(&mesh_of(both.clone(), faces.to_vec()));
        assert_eq!(image.faces(&pixels(8, 8), &at_origin()).visible(), [winner]);
    }
}

#[test]
fn a_floor_that_runs_under_the_camera_is_cut_at_the_near_plane() {
    // Four huge corners: none of them can be projected as it is.
    let corner = |x: f32, z: f32| Vec3::new(x, -1.0, z);
    let corners = vec![corner(-1e6, 1e6), corner(1e6, 1e6), corner(1e6, -1e6), corner(-1e6, -1e6)];
    let mesh = mesh_of(corners, vec![[0, 1, 2], [0, 2, 3]]);
    let camera = Camera::from_fov(64, 64, 1.0).unwrap();
    let image =
        Renderer::new(&mesh_of(mesh.positions.clone(), vec![])).faces(&camera, &at_origin());
    assert!(image.visible().is_empty());
    // Nearer than 1e-3 of this mesh's size nothing is drawn, so the camera rises.
    let pose = Pose::try_new(Vec3::Y * 1e5, vantage_core::Quat::IDENTITY).unwrap();
    let image = Renderer::new(&mesh).faces(&camera, &pose);
    for (pixel, face) in image.faces.iter().enumerate() {
        let row = pixel / 64;
        let is_floor = *face != NO_FACE;
        // The horizon is the middle row; far off the floor ends 1e6 away, 0.1 below it.
        let horizon = 32.0 + 0.1 * camera.fy;
        assert_eq!(is_floor, row as f32 + 0.5 > horizon, "row {row}");
    }
}

#[test]
fn inside_an_object_every_pixel_shows_it() {
    let mut ball = builtin("ball", 1).unwrap();
    normalise(&mut ball);
    let renderer = Renderer::new(&ball);
    let camera = Camera::from_fov(80, 60, 1.5).unwrap();
    for eye in [Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.99, 0.0, 0.02), Vec3::new(0.0, 0.0, -0.995)] {
        let pose = Pose::looking_at(eye, Vec3::new(0.0, 0.05, 0.0)).unwrap();
        let (image, colours) = renderer.labelled(&camera, &pose);
        assert!(image.faces.iter().all(|face| *face != NO_FACE), "from {eye}");
        assert!(colours.pixels().all(|pixel| pixel[3] == 255));
    }
}

#[test]
fn threads_change_no_byte() {
    let mut blob = noisy_blob(5_000, 3);
    normalise(&mut blob);
    let renderer = Renderer::new(&blob);
    let camera = Camera::from_fov(150, 110, 0.8).unwrap();
    let eye = |i: usize| Vec3::new((i as f32).cos() * 2.4, (i as f32).sin() * 2.4, 0.3 * i as f32);
    let poses: Vec<Pose> = (0..6).map(|i| Pose::looking_at(eye(i), Vec3::ZERO).unwrap()).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let photo = renderer.photo(&camera, &poses[0], &PhotoOptions::default());
            (renderer.faces_of_all(&camera, &poses), photo)
        })
    };
    let (one, two) = (run(1), run(2));
    assert!(one.0 == two.0 && one.1.as_raw() == two.1.as_raw());
}

#[test]
fn a_photo_of_one_sample_is_the_labelled_view() {
    let mut chair = builtin("chair", 2).unwrap();
    normalise(&mut chair);
    let renderer = Renderer::new(&chair);
    // Large enough that the photo is drawn in several bands.
    let camera = Camera::from_fov(700, 800, 0.8).unwrap();
    let pose = Pose::looking_at(Vec3::new(1.5, -2.0, 0.9), Vec3::ZERO).unwrap();
    let options = PhotoOptions { supersampling: 1, background: None };
    let (faces, colours) = renderer.labelled(&camera, &pose);
    assert!(renderer.photo(&camera, &pose, &options) == colours);
    for (face, pixel) in faces.faces.iter().zip(colours.pixels()) {
        assert_eq!(*face != NO_FACE, pixel[3] == 255);
    }
}

/// A square of side 2 in the plane x = 0, seen from +x: u to the right (+y), v downwards (-z).
fn picture(image: RgbaImage) -> Mesh {
    let corner = |u: f32, v: f32| Vec3::new(0.0, 2.0 * u - 1.0, 1.0 - 2.0 * v);
    let uv = [Vec2::ZERO, Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0)];
    let mut mesh = mesh_of(uv.map(|p| corner(p.x, p.y)).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    mesh.uvs = vec![[uv[0], uv[1], uv[2]], [uv[0], uv[2], uv[3]]];
    mesh.materials[0].texture = Some(Texture { image: Arc::new(image), wrap: [Wrap::Clamp; 2] });
    mesh
}

#[test]
fn the_first_row_of_a_texture_is_at_its_top() {
    let colours = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];
    let image = RgbaImage::from_fn(2, 2, |x, y| Rgba(colours[(y * 2 + x) as usize]));
    let camera = Camera::from_fov(40, 40, 0.9).unwrap();
    let pose = Pose::looking_at(Vec3::X * 3.0, Vec3::ZERO).unwrap();
    let photo = Renderer::new(&picture(image)).photo(&camera, &pose, &PhotoOptions::default());
    let hue_at = |x: u32, y: u32| photo.get_pixel(x, y).0.map(|byte| byte > 128);
    let (red, green) = ([true, false, false, true], [false, true, false, true]);
    let (blue, yellow) = ([false, false, true, true], [true, true, false, true]);
    assert_eq!([hue_at(10, 10), hue_at(30, 10)], [red, green]);
    assert_eq!([hue_at(10, 30), hue_at(30, 30)], [blue, yellow]);
    assert_eq!(photo.get_pixel(0, 0).0[3], 0);
}

#[test]
fn a_slanted_texture_is_seen_in_perspective() {
    // White above v = 1/2. Tilted, that line is not in the middle of the picture but where the
    // plane's middle is, at the camera's axis.
    let image =
        RgbaImage::from_fn(64, 64, |_, y| Rgba(if y < 32 { [255; 4] } else { [0, 0, 0, 255] }));
    let mut mesh = picture(image);
    for position in &mut mesh.positions {
        position.x += 0.9 * position.z; // the upper edge comes nearer
    }
    let camera = Camera::from_fov(101, 101, 0.9).unwrap();
    let pose = Pose::looking_at(Vec3::X * 3.0, Vec3::ZERO).unwrap();
    let photo = Renderer::new(&mesh).photo(&camera, &pose, &PhotoOptions::default());
    for column in [40, 50, 60] {
        assert!(photo.get_pixel(column, 47).0[0] > 120, "column {column}");
        assert!(photo.get_pixel(column, 53).0[0] < 60, "column {column}");
    }
}

#[test]
fn where_a_texture_is_cut_out_there_is_no_surface() {
    let image = RgbaImage::from_fn(2, 1, |x, _| Rgba([200, 200, 200, x as u8 * 255]));
    let mut mesh = picture(image);
    mesh.materials[0].alpha_cutoff = Some(0.5);
    // A second square behind it shows through.
    let mut behind = picture(RgbaImage::from_pixel(1, 1, Rgba([255; 4])));
    for position in &mut behind.positions {
        position.x -= 0.5;
    }
    mesh.append(behind);
    let camera = Camera::from_fov(40, 40, 0.5).unwrap();
    let pose = Pose::looking_at(Vec3::X * 3.0, Vec3::ZERO).unwrap();
    let image = Renderer::new(&mesh).faces(&camera, &pose);
    for (pixel, face) in image.faces.iter().enumerate() {
        assert_eq!(*face >= 2, pixel % 40 < 20, "pixel {pixel}");
    }
}

#[test]
fn photos_are_never_dark_and_edges_are_soft() {
    let mut ball = builtin("ball", 0).unwrap();
    ball.materials = vec![Material::plain("white", [1.0; 3])];
    normalise(&mut ball);
    let renderer = Renderer::new(&ball);
    let camera = Camera::from_fov(60, 60, 0.9).unwrap();
    let below = Pose::looking_at(Vec3::new(-1.0, 1.0, -3.0), Vec3::ZERO).unwrap();
    let photo = renderer.photo(&camera, &below, &PhotoOptions::default());
    let solid: Vec<_> = photo.pixels().filter(|pixel| pixel[3] == 255).collect();
    // 0.45 in linear light is level 179.
    assert!(solid.iter().all(|pixel| pixel[0] >= 178), "{:?}", solid.iter().map(|p| p[0]).min());
    assert!(photo.pixels().any(|pixel| (1..255).contains(&pixel[3])));
    let paper = PhotoOptions { background: Some([10, 200, 30]), ..PhotoOptions::default() };
    let photo = renderer.photo(&camera, &below, &paper);
    assert_eq!(photo.get_pixel(0, 0).0, [10, 200, 30, 255]);
    assert!(photo.pixels().all(|pixel| pixel[3] == 255));
}

#[test]
fn normals_look_at_the_camera() {
    let mut ball = builtin("ball", 0).unwrap();
    normalise(&mut ball);
    let camera = Camera::from_fov(60, 60, 0.9).unwrap();
    let pose = Pose::looking_at(Vec3::Y * -3.0, Vec3::ZERO).unwrap();
    let normals = Renderer::new(&ball).normals(&camera, &pose);
    assert!(normals[30 * 60 + 30].dot(Vec3::NEG_Y) > 0.99);
    assert_eq!(normals[0], Vec3::ZERO);
    assert!(normals[30 * 60 + 45].x > 0.3, "right of the middle they turn right");
}
