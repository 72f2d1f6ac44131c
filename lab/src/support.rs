//! What each candidate view shows of a mesh and of the space around it, for plans by support.

use anyhow::Result;
use rayon::prelude::*;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::{Glimpse, SupportError, SupportLedger, Target};
use vantage_core::{Camera, Pose, Vec3};

use crate::label::RESOLUTION;
use crate::mesh::{Chance, Mesh};
use crate::pool::{DISTANCE, FOV_X_RAD};
use crate::render::{FaceImage, NO_FACE, Renderer};

/// New views that are looked from, spread evenly over the sphere, and targets of each.
const NEW_VIEWS: usize = 128;
const TARGETS: usize = 32;

/// Side of the new views, pixels.
const NEW_SIDE: u32 = 32;

/// Voxels along each side of the cube around the unit sphere; those inside the sphere count.
const VOXELS: usize = 40;

/// So much nearer to the camera, metres, something else must be to hide a target.
const DEPTH: f32 = 0.03;

/// Targets and voxels of a mesh, and what candidates show of them.
pub struct Support {
    targets: Vec<Target>,
    voxels: usize,
    shown: Vec<[Vec<u32>; 2]>, // (candidates), bit sets of targets seen and of voxels empty
}

impl Support {
    /// Looks at a mesh inside the unit sphere from new views and from the candidates.
    pub fn new(mesh: &Mesh, poses: &[Pose]) -> Result<Self> {
        let renderer = Renderer::new(mesh);
        let targets = targets(mesh, &renderer)?;
        let voxels = voxels();
        let camera = Camera::from_fov(RESOLUTION, RESOLUTION, FOV_X_RAD)?;
        let shown = poses.par_iter().map(|pose| {
            let image = renderer.faces(&camera, pose);
            let look = Look { mesh, camera: &camera, pose, image: &image };
            let sees = targets.iter().map(|target| look.sees(target.place));
            let empty = voxels.iter().map(|&voxel| look.is_beside(voxel));
            [bits(sees), bits(empty)]
        });
        Ok(Self { voxels: voxels.len(), shown: shown.collect(), targets })
    }

    /// What each candidate shows.
    pub fn glimpses(&self) -> Vec<Glimpse<'_>> {
        self.shown.iter().map(|[seen, empty]| Glimpse { seen, empty }).collect()
    }

    /// Memory for a [`ledger`](Self::ledger).
    pub fn memory(&self) -> (Vec<f32>, Vec<u32>) {
        (vec![0.0; self.targets.len()], vec![0; self.voxels.div_ceil(32)])
    }

    /// An empty account; fails where no new view sees the mesh.
    pub fn ledger<'a>(
        &'a self,
        sums: &'a mut [f32],
        empty: &'a mut [u32],
    ) -> Result<SupportLedger<'a>, SupportError> {
        SupportLedger::try_new(&self.targets, self.voxels, sums, empty)
    }
}

/// Of each new view some pixels that show the mesh, drawn without repetition.
fn targets(mesh: &Mesh, renderer: &Renderer) -> Result<Vec<Target>> {
    let camera = Camera::from_fov(NEW_SIDE, NEW_SIDE, FOV_X_RAD)?;
    let views = Pool::try_new(ViewSpace::FibonacciSphere, NEW_VIEWS, DISTANCE)?;
    let of_view = |(view, pose): (usize, Pose)| {
        let image = renderer.faces(&camera, &pose);
        let look = Look { mesh, camera: &camera, pose: &pose, image: &image };
        let mut chance = Chance::new(view as u64);
        let mut pixels: Vec<u32> = (0..NEW_SIDE * NEW_SIDE).collect();
        pixels.retain(|&pixel| image.faces[pixel as usize] != NO_FACE);
        let drawn = TARGETS.min(pixels.len());
        for place in 0..drawn {
            let rest = (pixels.len() - place) as u32;
            pixels.swap(place, place + chance.below(rest) as usize);
        }
        pixels.truncate(drawn);
        pixels.into_iter().filter_map(move |pixel| look.target(pixel)).collect::<Vec<_>>()
    };
    Ok(views.iter().enumerate().flat_map(of_view).collect())
}

/// The middles of the voxels inside the unit sphere.
fn voxels() -> Vec<Vec3> {
    let middle = |index: usize| (index as f32 + 0.5) * (2.0 / VOXELS as f32) - 1.0;
    let place = |i: usize| {
        Vec3::new(middle(i % VOXELS), middle(i / VOXELS % VOXELS), middle(i / VOXELS / VOXELS))
    };
    (0..VOXELS.pow(3)).map(place).filter(|voxel| voxel.length_squared() < 1.0).collect()
}

/// A face-id image and where it was taken.
struct Look<'a> {
    mesh: &'a Mesh,
    camera: &'a Camera,
    pose: &'a Pose,
    image: &'a FaceImage,
}

impl Look<'_> {
    /// The pixel of a point, if it lies in the picture, and the face there.
    fn pixel_of(&self, point: Vec3) -> Option<(u32, u32)> {
        let place = self.camera.project(self.pose.camera_from_world(point))?;
        let (x, y) = (place.x.floor(), place.y.floor());
        let inside = x >= 0.0 && y >= 0.0 && x < self.image.width as f32;
        let inside = inside && y < self.image.height as f32;
        inside
            .then(|| y as u32 * self.image.width + x as u32)
            .map(|pixel| (pixel, self.image.faces[pixel as usize]))
    }

    /// From the camera through the middle of a pixel, unit length.
    fn direction(&self, pixel: u32) -> Vec3 {
        let (x, y) = (pixel % self.image.width, pixel / self.image.width);
        let right = (x as f32 + 0.5 - self.camera.cx) / self.camera.fx;
        let up = (self.camera.cy - y as f32 - 0.5) / self.camera.fy;
        let direction = self.pose.forward() + self.pose.right() * right + self.pose.up() * up;
        direction.normalize()
    }

    /// How far away the face of a pixel is; not finite where it is looked at edge on.
    fn distance(&self, pixel: u32, face: u32) -> f32 {
        let normal = self.mesh.normal(face as usize);
        let [corner, ..] = self.mesh.corners(face as usize);
        (corner - self.pose.position()).dot(normal) / self.direction(pixel).dot(normal)
    }

    /// What a pixel shows, as a target.
    fn target(&self, pixel: u32) -> Option<Target> {
        let face = self.image.faces[pixel as usize];
        let direction = self.direction(pixel);
        let place = self.pose.position() + direction * self.distance(pixel, face);
        let normal = self.mesh.normal(face as usize);
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let whole = place.length_squared() < 2.0 && normal != Vec3::ZERO;
        whole.then_some(Target { place, normal, towards: -direction })
    }

    /// Whether nothing hides a point of the surface.
    fn sees(&self, point: Vec3) -> bool {
        let Some((pixel, face)) = self.pixel_of(point) else { return false };
        if face == NO_FACE {
            return false;
        }
        let distance = self.distance(pixel, face);
        // What is looked at edge on hides nothing.
        !distance.is_finite() || distance >= point.distance(self.pose.position()) - DEPTH
    }

    /// Whether a point lies beside the outline, in the picture.
    fn is_beside(&self, point: Vec3) -> bool {
        self.pixel_of(point).is_some_and(|(_, face)| face == NO_FACE)
    }
}

/// A bit set: bit `i % 32` of word `i / 32` is the i-th answer.
fn bits(answers: impl Iterator<Item = bool>) -> Vec<u32> {
    let answers: Vec<bool> = answers.collect();
    let word = |part: &[bool]| part.iter().rev().fold(0, |word, &bit| word << 1 | u32::from(bit));
    answers.chunks(32).map(word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;

    /// A ball of radius 0.5 with its candidates.
    fn ball() -> (Mesh, Vec<Pose>, Support) {
        let mut ball = mesh::builtin("ball", 0).unwrap();
        mesh::normalise(&mut ball);
        for place in &mut ball.positions {
            *place *= 0.5;
        }
        let poses = Pool::try_new(ViewSpace::FibonacciSphere, 12, DISTANCE).unwrap();
        let poses: Vec<Pose> = poses.iter().collect();
        let support = Support::new(&ball, &poses).unwrap();
        (ball, poses, support)
    }

    fn holds(words: &[u32], bit: usize) -> bool {
        words[bit / 32] >> (bit % 32) & 1 == 1
    }

    #[test]
    fn targets_lie_on_the_surface_and_face_their_views() {
        let (_, _, support) = ball();
        assert_eq!(support.targets.len(), NEW_VIEWS * TARGETS);
        for target in &support.targets {
            assert!((target.place.length() - 0.5).abs() < 0.01, "{target:?}");
            assert!(
                target.normal.dot(target.place) > 0.49 && target.towards.dot(target.normal) > 0.0
            );
        }
    }

    #[test]
    fn a_ball_hides_its_far_side_and_is_empty_around() {
        let (_, poses, support) = ball();
        let voxels = voxels();
        // Of a ball of radius r from distance d the places beyond the plane at r^2 / d are hidden, and
        // a line of sight that passes the centre by more than r misses it.
        for (pose, glimpse) in poses.iter().zip(support.glimpses()) {
            let eye = pose.position();
            for (index, target) in support.targets.iter().enumerate() {
                let above = target.place.dot(eye.normalize()) - 0.25 / DISTANCE;
                // Where the surface is seen edge on, a pixel spans more depth than hides.
                if above.abs() > 0.12 {
                    assert_eq!(holds(glimpse.seen, index), above > 0.0, "{target:?} from {eye}");
                }
            }
            for (index, &voxel) in voxels.iter().enumerate() {
                let passes = voxel.cross(eye).length() / (voxel - eye).length();
                if (passes - 0.5).abs() > 0.03 {
                    assert_eq!(holds(glimpse.empty, index), passes > 0.5, "{voxel} from {eye}");
                }
            }
        }
    }
}
