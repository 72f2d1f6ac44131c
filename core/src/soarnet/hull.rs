//! The visual hull (Laurentini, 1994): the space that no photo has shown to be empty.
//!
//! A grid of 32 x 32 x 32 voxels over the cube around the object's bounding sphere, one bit each: 4 KiB.
//! It begins as the ball; each photo's outline, as the network sees it, carves away what lies beside the
//! object. Lengths are in radii of the sphere, coordinates the world's about the object's centre.
//!
//! Photos are taken for what the network is shown: cameras that look at the centre from three radii, of
//! a field of view that just holds the sphere ([`HALF_TAN`]). A window of a real photo is near enough to
//! that: what is carved wrongly by a little perspective is less than a cell of the outline.
//!
//! What carving leaves does not depend on the order of the photos.

use glam::Vec3;

use super::features::{Direction, Stance};
use super::image::{COVER, SKETCH};
use crate::math;

/// Voxels along an axis: the bits of a row.
const SIDE: i32 = 32;
const ROWS: usize = (SIDE * SIDE) as usize;
/// Side of a voxel.
pub(super) const VOXEL: f32 = 2.0 / SIDE as f32;

/// From the centre to a camera.
const DISTANCE: f32 = 3.0;
/// Tangent of half the field of view: that of NeRF's synthetic scenes (Mildenhall et al., 2020), in
/// which a sphere at three radii fits.
const HALF_TAN: f32 = 0.36;

/// The cover, of 127, below which a place of a photo shows no object. Between 0.1 and 0.3 of it the
/// ranks of gains on a hull changed by less than 0.01.
const EMPTY: i32 = 20;

/// Empty, half and whole are one bit a voxel; see the [module](self).
#[derive(Clone, Debug)]
pub(super) struct Hull {
    rows: [u32; ROWS], // row y + 32 z, bit x
}

/// A voxel at the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Voxel {
    pub(super) centre: Vec3,
    /// Outward, unit length; zero where the hull is as thin on either side.
    pub(super) normal: Vec3,
    /// Of the surface inside the voxel, about, in squares of its side.
    pub(super) area: f32,
}

/// A camera that looks at the centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub(super) eye: Vec3,
    right: Vec3,
    up: Vec3,
    back: Vec3,
}

impl Camera {
    /// A view's; `None` where it looks past the object at a right angle.
    pub(super) fn try_new(stance: &Stance) -> Option<Self> {
        let back = stance.direction.vector();
        let right = stance.right();
        let right = math::unit(right - back * right.dot(back))?;
        Some(Self { eye: Self::eye_in(stance.direction), right, up: back.cross(right), back })
    }

    /// Where a camera in a direction stands.
    pub(super) fn eye_in(direction: Direction) -> Vec3 {
        direction.vector() * DISTANCE
    }

    /// Where a point lies in the picture: 0 to 1 from the left and from the top.
    pub(super) fn project(&self, point: Vec3) -> (f32, f32) {
        let scale = 0.5 / (HALF_TAN * (DISTANCE - point.dot(self.back)));
        (0.5 + point.dot(self.right) * scale, 0.5 - point.dot(self.up) * scale)
    }
}

/// The coordinate of a voxel's middle.
fn middle(index: i32) -> f32 {
    (index as f32 + 0.5) * VOXEL - 1.0
}

impl Hull {
    /// No voxel at all: zeros, which cost no flash in a `static`.
    pub(super) const fn new() -> Self {
        Self { rows: [0; ROWS] }
    }

    /// As before the first photo: the ball.
    pub(super) fn fill(&mut self) {
        for (place, row) in self.rows.iter_mut().enumerate() {
            let (y, z) = (middle(place as i32 % SIDE), middle(place as i32 / SIDE));
            *row = (0..SIDE).fold(0, |row, x| {
                let inside = Vec3::new(middle(x), y, z).length_squared() <= 1.0;
                row | u32::from(inside).wrapping_shl(x as u32)
            });
        }
    }

    /// Takes away what a photo shows to be empty. `sketch` is what the network sees in it; where that
    /// is no object at all, nothing is taken away.
    pub(super) fn carve(&mut self, camera: &Camera, sketch: &[i8]) {
        let Some(cover) = sketch.get(..COVER * COVER) else { return };
        if cover.iter().all(|&share| i32::from(share) < EMPTY) {
            return;
        }
        for (place, row) in self.rows.iter_mut().enumerate() {
            let (y, z) = (middle(place as i32 % SIDE), middle(place as i32 / SIDE));
            let mut left = *row;
            while left != 0 {
                let x = left.trailing_zeros();
                left &= left - 1;
                if cover_at(cover, camera.project(Vec3::new(middle(x as i32), y, z))) < EMPTY {
                    *row &= !1u32.wrapping_shl(x);
                }
            }
        }
    }

    /// The row at (y, z); empty outside.
    fn row(&self, y: i32, z: i32) -> u32 {
        let inside = (0..SIDE).contains(&y) && (0..SIDE).contains(&z);
        let place = if inside { (y + SIDE * z) as usize } else { usize::MAX };
        self.rows.get(place).copied().unwrap_or(0)
    }

    /// Of a row, the voxels of which a side is free.
    fn surface_of(&self, y: i32, z: i32) -> u32 {
        let row = self.row(y, z);
        let sides = self.row(y - 1, z) & self.row(y + 1, z) & self.row(y, z - 1);
        row & !((row << 1) & (row >> 1) & sides & self.row(y, z + 1))
    }

    /// How many voxels lie at the surface.
    pub(super) fn surface_count(&self) -> u32 {
        let places = (0..SIDE).flat_map(|z| (0..SIDE).map(move |y| (y, z)));
        places.map(|(y, z)| self.surface_of(y, z).count_ones()).sum()
    }

    /// The voxels at the surface for which `wanted` holds, from the lowest z, y and x on.
    pub(super) fn surface(
        &self,
        wanted: impl Fn(u32, u32, u32) -> bool,
    ) -> impl Iterator<Item = Voxel> {
        let places = (0..SIDE).flat_map(|z| (0..SIDE).map(move |y| (y, z)));
        let voxels = places.flat_map(|(y, z)| {
            let row = self.surface_of(y, z);
            (0..SIDE).filter(move |&x| row.wrapping_shr(x as u32) & 1 == 1).map(move |x| (x, y, z))
        });
        let voxels = voxels.filter(move |&(x, y, z)| wanted(x as u32, y as u32, z as u32));
        voxels.map(|(x, y, z)| self.voxel(x, y, z))
    }

    /// A voxel of the hull. Its normal points away from the mass of the 5 x 5 x 5 around it.
    fn voxel(&self, x: i32, y: i32, z: i32) -> Voxel {
        let mut mass = Vec3::ZERO;
        for dz in -2..=2 {
            for dy in -2..=2 {
                let around = u64::from(self.row(y + dy, z + dz)) << 2;
                let around = (around.wrapping_shr(x as u32) & 31) as u32;
                let at = |bit: u32| around.wrapping_shr(bit) & 1;
                let count = around.count_ones() as f32;
                mass.x += 2.0 * (at(4) as f32 - at(0) as f32) + at(3) as f32 - at(1) as f32;
                mass.y += dy as f32 * count;
                mass.z += dz as f32 * count;
            }
        }
        let at = |x: i32, y: i32, z: i32| {
            let inside = (0..SIDE).contains(&x);
            if inside { (self.row(y, z).wrapping_shr(x as u32) & 1) as f32 } else { 0.0 }
        };
        let [left, right] = [at(x - 1, y, z), at(x + 1, y, z)];
        let [front, behind] = [at(x, y - 1, z), at(x, y + 1, z)];
        let [below, above] = [at(x, y, z - 1), at(x, y, z + 1)];
        let (normal, area) = match math::unit(-mass) {
            Some(normal) => {
                let open = Vec3::new(left - right, front - behind, below - above);
                (normal, open.dot(normal).max(0.3))
            }
            None => (Vec3::ZERO, 0.5 * (6.0 - left - right - front - behind - below - above)),
        };
        Voxel { centre: Vec3::new(middle(x), middle(y), middle(z)), normal, area }
    }

    /// Whether nothing of the hull stands between a surface voxel and a camera at `distance` in
    /// `direction`: steps of 0.7 voxels, from 1.55 voxels off the surface on.
    pub(super) fn is_open(&self, from: Vec3, normal: Vec3, direction: Vec3) -> bool {
        let place = (from + normal * (1.2 * VOXEL) + Vec3::ONE) * (1.0 / VOXEL);
        let step = direction * 0.7;
        let mut place = place + step * 0.5;
        // It leaves the cube, whose diagonal is 55 voxels, after 80 steps at most.
        for _ in 0..80 {
            let inside = |at: f32| (0.0..SIDE as f32).contains(&at);
            if !(inside(place.x) && inside(place.y) && inside(place.z)) {
                return true;
            }
            let row = self.row(place.y as i32, place.z as i32);
            if row.wrapping_shr(place.x as u32) & 1 == 1 {
                return false;
            }
            place += step;
        }
        true
    }
}

/// The cover of a place in the picture, linear between the middles of cells; none outside.
fn cover_at(cover: &[i8], (u, v): (f32, f32)) -> i32 {
    // One cell is added, so that nothing inside is negative.
    let [x, y] = [u, v].map(|at| ((at * COVER as f32 + 0.5) * 256.0) as i32);
    let at = |x: i32, y: i32| {
        let inside = (1..=COVER as i32).contains(&x) && (1..=COVER as i32).contains(&y);
        let place = if inside { (y - 1) as usize * COVER + (x - 1) as usize } else { SKETCH };
        i32::from(cover.get(place).copied().unwrap_or(0))
    };
    let (column, row) = (x >> 8, y >> 8);
    let (a, b) = (x & 255, y & 255);
    let above = (256 - a) * at(column, row) + a * at(column + 1, row);
    let below = (256 - a) * at(column, row + 1) + a * at(column + 1, row + 1);
    ((256 - b) * above + b * below + (1 << 15)) >> 16
}
