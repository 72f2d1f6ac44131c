//! A scene whose photos follow from a formula: what every field must be able to learn.
//!
//! Three matt spheres of one colour each. A pixel is the mean of nine samples, as in the photos of
//! meshes.

use anyhow::Result;
use vantage_core::{Camera, Pose, Vec3};

use crate::photos::{BACKGROUND, Photos, Picture, Ray};

/// Centre, radius and colour.
const SPHERES: [(Vec3, f32, [f32; 3]); 3] = [
    (Vec3::new(0.3, 0.1, -0.2), 0.45, [0.8, 0.2, 0.1]),
    (Vec3::new(-0.4, -0.2, 0.1), 0.35, [0.1, 0.5, 0.2]),
    (Vec3::new(0.0, 0.2, 0.55), 0.25, [0.2, 0.3, 0.9]),
];

/// Samples along each side of a pixel.
const SAMPLES: u32 = 3;

/// The colour that a ray meets first.
fn seen(ray: &Ray) -> [f32; 3] {
    let hit = |(centre, radius, colour): (Vec3, f32, [f32; 3])| {
        let to_centre = centre - ray.origin;
        let along = to_centre.dot(ray.direction);
        let half = radius * radius - (to_centre.length_squared() - along * along);
        (half >= 0.0).then(|| (along - half.sqrt(), colour))
    };
    let nearest = SPHERES.into_iter().filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or(BACKGROUND, |(_, colour)| colour)
}

/// Photos of the three spheres.
pub fn photos(camera: Camera, poses: Vec<Pose>) -> Result<Photos> {
    let finer = camera.resized(camera.width * SAMPLES, camera.height * SAMPLES)?;
    let picture = |pose: &Pose| {
        let pixel = |i: u32| {
            let mut sum = [0.0; 3];
            for sample in 0..SAMPLES * SAMPLES {
                let x = i % camera.width * SAMPLES + sample % SAMPLES;
                let y = i / camera.width * SAMPLES + sample / SAMPLES;
                let colour = seen(&Ray::through(&finer, pose, x, y));
                for (sum, part) in sum.iter_mut().zip(colour) {
                    *sum += part / (SAMPLES * SAMPLES) as f32;
                }
            }
            sum
        };
        let pixels = (0..camera.width * camera.height).map(pixel).collect();
        Picture { width: camera.width as usize, pixels }
    };
    let pictures = poses.iter().map(picture).collect();
    Ok(Photos { camera, poses, pictures })
}
