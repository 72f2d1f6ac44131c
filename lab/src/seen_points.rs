//! Coloured points on the surface that the photos show: what splatting starts from.

use image::RgbaImage;
use vantage_core::objectives::Face;
use vantage_core::{Camera, Pose, Vec3};

use crate::export::Point;
use crate::render::{FaceImage, NO_FACE};

/// One photo as labelled: where it was taken, its face ids and its colours at the same size.
pub type LabelledPhoto = (Pose, FaceImage, RgbaImage);

/// About `wanted` points, spread evenly over the pixels of the photos that show the object.
///
/// A point lies where the pixel's ray meets the plane of its face, and has the pixel's colour.
pub fn points(
    photos: &[LabelledPhoto],
    camera: &Camera,
    faces: &[Face],
    wanted: usize,
) -> Vec<Point> {
    let shown: usize = photos
        .iter()
        .map(|(_, image, _)| image.faces.iter().filter(|&&face| face != NO_FACE).count())
        .sum();
    let stride = (shown / wanted.max(1)).max(1);
    let mut points = Vec::with_capacity(wanted);
    let mut count = 0;
    for (pose, image, colours) in photos {
        for (place, &face) in image.faces.iter().enumerate() {
            if face == NO_FACE {
                continue;
            }
            count += 1;
            if count % stride != 0 {
                continue;
            }
            let (x, y) = (place as u32 % image.width, place as u32 / image.width);
            let face = &faces[face as usize];
            if let Some(position) = on_plane(pose, camera, x, y, face) {
                let [red, green, blue, _] = colours.get_pixel(x, y).0;
                points.push(Point { position, colour: [red, green, blue] });
            }
        }
    }
    points
}

/// Where the ray through a pixel's centre meets a face's plane; `None` where it hardly does.
fn on_plane(pose: &Pose, camera: &Camera, x: u32, y: u32, face: &Face) -> Option<Vec3> {
    let right = (x as f32 + 0.5 - camera.cx) / camera.fx;
    let down = (y as f32 + 0.5 - camera.cy) / camera.fy;
    let direction = pose.forward() + right * pose.right() - down * pose.up();
    let fall = direction.dot(face.normal);
    let distance = (face.centroid - pose.position()).dot(face.normal) / fall;
    let point = pose.position() + distance * direction;
    // Grazing rays and rounding may throw a point far off its small face.
    (fall.abs() > 0.05 && distance > 0.0 && point.length() < 1.1).then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_on_the_plane_that_the_photo_shows() {
        let face = Face {
            centroid: Vec3::new(0.0, 0.0, 0.5),
            normal: Vec3::Z,
            area_share: 1.0,
            complexity: 0.0,
        };
        let camera = Camera::from_fov(16, 16, 0.3).unwrap();
        let pose = Pose::looking_at(Vec3::new(1.0, 0.5, 3.0), Vec3::new(0.0, 0.0, 0.5)).unwrap();
        let image = FaceImage { width: 16, height: 16, faces: vec![0; 256] };
        let colours = RgbaImage::from_pixel(16, 16, image::Rgba([9, 8, 7, 255]));
        let points = points(&[(pose, image, colours)], &camera, &[face], 64);
        assert_eq!(points.len(), 64);
        for point in points {
            assert!((point.position.z - 0.5).abs() < 1e-5);
            assert_eq!(point.colour, [9, 8, 7]);
        }
    }
}
