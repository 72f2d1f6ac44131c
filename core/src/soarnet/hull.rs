//! The visual hull (Laurentini, 1994): the space that no photo has shown to be empty.
//!
//! A grid of 32 x 32 x 32 voxels over the cube around the object's bounding sphere, one bit each: 4 KiB.
//! It begins as the ball; each photo's outline, as the network sees it, carves away what lies beside the
//! object. Lengths are in radii of the sphere, coordinates the world's about the object's centre.
//!
//! Every photo is read as if its camera stood three radii off, looked at the centre and had a field of
//! view that just holds the sphere ([`HALF_TAN`]): that is how the network's photos are made. A window
//! of a real photo is near enough to it: a little perspective moves an outline by less than a cell.
//!
//! What carving leaves does not depend on the order of the photos.

use glam::Vec3;

use super::features::{Direction, Stance};
use super::image::{COVER, SKETCH};
use crate::math;

/// Voxels along an axis, and the bits of a row.
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

/// The voxels that no photo has shown to be empty; see the [module](self).
#[derive(Clone, Debug)]
pub(super) struct Hull {
    rows: [u32; ROWS], // row y + 32 z, bit x
}

/// A voxel at the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Voxel {
    pub(super) centre: Vec3,
    /// Outward, unit length; zero where as much of the hull lies on one side as on the other.
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
    /// A view's, turned to look at the centre; `None` where the centre lies straight to its right or
    /// left, so that its picture has no right.
    pub(super) fn try_new(stance: &Stance) -> Option<Self> {
        let back = stance.direction.vector();
        let right = stance.right();
        let across = right - back * right.dot(back);
        // Of what should be nothing, the rounding of both leaves 1e-4.
        if across.length_squared() < 1e-4 {
            return None;
        }
        let right = math::unit(across)?;
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

    /// Takes away what a photo shows to be empty. `sketch` is what the network sees in it, shape (320);
    /// where that is no object at all, or too short, nothing is taken away.
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

    /// Where the hull ends, for [`is_open`](Self::is_open).
    pub(super) fn bounds(&self) -> Bounds {
        let (mut low, mut high) = (Vec3::splat(SIDE as f32), Vec3::ZERO);
        for (place, &row) in self.rows.iter().enumerate().filter(|(_, row)| **row != 0) {
            let (y, z) = (place as i32 % SIDE, place as i32 / SIDE);
            let (first, last) =
                (row.trailing_zeros() as i32, SIDE - 1 - row.leading_zeros() as i32);
            let corner = |x: i32| Vec3::new(x as f32, y as f32, z as f32);
            low = low.min(corner(first));
            high = high.max(corner(last) + Vec3::ONE);
        }
        Bounds { low, high }
    }

    /// Whether nothing of the hull stands between a surface voxel, given by its centre and normal, and
    /// a camera outside in `direction`, of unit length.
    ///
    /// Looks every 0.7 voxels along a line that begins 1.2 voxels above the centre. On a ball it takes
    /// a place for hidden by its neighbours only beyond 76 degrees of incidence. `bounds` are the hull's
    /// and change nothing but how long it takes.
    pub(super) fn is_open(
        &self,
        bounds: &Bounds,
        centre: Vec3,
        normal: Vec3,
        direction: Vec3,
    ) -> bool {
        // What is thin has no outside of its own.
        let away = if normal == Vec3::ZERO { direction } else { normal };
        let begin = (centre + away * (1.2 * VOXEL) + Vec3::ONE) * (1.0 / VOXEL);
        let step = direction * 0.7;
        let mut place = begin + step * 0.5;
        // It leaves the cube, whose diagonal is 55 voxels, after 80 steps at most. The plain version:
        //
        //     80 times:
        //         if place is outside the cube: open
        //         if place is in the hull: not open
        //         place += step
        //     open
        //
        // Before it has left the hull's box it need not be asked whether it is inside the cube, and
        // after it has, nothing is left to meet.
        if !is_inside(place) {
            return true;
        }
        let (within, beyond) = bounds.steps(place, step);
        for _ in 0..within {
            if self.holds(place) {
                return false;
            }
            place += step;
        }
        for _ in within..beyond {
            if !is_inside(place) {
                return true;
            }
            if self.holds(place) {
                return false;
            }
            place += step;
        }
        true
    }

    /// Whether the voxel of a place is of the hull; any answer outside the cube.
    fn holds(&self, place: Vec3) -> bool {
        let [x, y, z] = place.to_array().map(|at| at as i32 as u32);
        let row = y.wrapping_add(z << SIDE.trailing_zeros()) as usize % ROWS;
        self.rows.get(row).is_some_and(|row| row.wrapping_shr(x) & 1 == 1)
    }
}

/// Whether a place is in the cube, in voxel sides from its corner.
fn is_inside(place: Vec3) -> bool {
    place.to_array().into_iter().all(|at| (0.0..SIDE as f32).contains(&at))
}

/// The box that holds a hull; in voxel sides from the cube's corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    /// Of nothing.
    pub(super) const NONE: Self = Self { low: Vec3::ZERO, high: Vec3::ZERO };

    /// Of how many places from the first on a line is certainly inside the box by the sides ahead of
    /// it, and after how many it is certainly outside; at most 80.
    fn steps(&self, place: Vec3, step: Vec3) -> (i32, i32) {
        // More than 80 additions are off by, of which each rounds to 2^-20 at most.
        const SLACK: f32 = 1e-3;
        let (mut within, mut beyond) = (80.0f32, 80.0f32);
        let sides = self.low.to_array().into_iter().zip(self.high.to_array());
        let line = place.to_array().into_iter().zip(step.to_array());
        for ((low, high), (place, step)) in sides.zip(line) {
            let inverse = 1.0 / step;
            let ahead = if step < 0.0 { low } else { high };
            // Along a side it is infinite, or on it no number, which is less than none.
            let steps = (ahead - place) * inverse;
            let slack = (SLACK * inverse).abs();
            // Not `min`, which takes a call where no instruction does it.
            if steps - slack < within {
                within = steps - slack;
            }
            if steps + slack < beyond {
                beyond = steps + slack;
            }
        }
        ((within as i32).max(0), (beyond + 1.0) as i32)
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

#[cfg(test)]
pub(super) mod tests {
    use std::string::String;
    use std::vec::Vec;

    use glam::{DVec3, Quat};
    use proptest::prelude::*;

    use super::*;
    use crate::candidates::{Pool, ViewSpace};
    use crate::pose::Pose;

    /// A ball, in radii of the bounding sphere about its centre.
    #[derive(Clone, Copy, Debug)]
    pub struct Ball {
        pub centre: DVec3,
        pub radius: f64,
    }

    impl Ball {
        pub const fn new(x: f64, y: f64, z: f64, radius: f64) -> Self {
            Self { centre: DVec3::new(x, y, z), radius }
        }
    }

    /// Views from all around that look at the centre.
    pub fn stances(count: usize) -> Vec<Stance> {
        let pool = Pool::try_new(ViewSpace::FibonacciSphere, count, 3.0).unwrap();
        pool.iter().map(|pose| Stance::try_new(&pose, Vec3::ZERO).unwrap()).collect()
    }

    /// Any camera that does not stand on the centre, whatever it looks at.
    pub fn any_stance() -> impl Strategy<Value = Stance> {
        let part = || -1.0f32..1.0;
        ((part(), part(), part()), (part(), part(), part(), part())).prop_filter_map(
            "no pose",
            |((x, y, z), (a, b, c, d))| {
                let turn = Quat::from_xyzw(a, b, c, d).normalize();
                let pose = Pose::try_new(Vec3::new(x, y, z) * 3.0, turn).ok()?;
                Stance::try_new(&pose, Vec3::ZERO)
            },
        )
    }

    /// Any signed bytes, a sketch's number of them.
    pub fn any_sketch() -> impl Strategy<Value = Vec<i8>> {
        prop::collection::vec(any::<i8>(), SKETCH)
    }

    /// A camera by its definition, in double precision.
    struct Plain {
        eye: DVec3,
        right: DVec3,
        up: DVec3,
        back: DVec3,
    }

    impl Plain {
        fn new(stance: &Stance) -> Self {
            let double = |v: Vec3| DVec3::new(v.x.into(), v.y.into(), v.z.into());
            let back = double(stance.direction.vector()).normalize();
            let right = double(stance.right());
            let right = (right - back * right.dot(back)).normalize();
            Self { eye: back * 3.0, right, up: back.cross(right), back }
        }

        fn project(&self, point: DVec3) -> (f64, f64) {
            let seen = point - self.eye;
            let half = -seen.dot(self.back) * 0.36;
            (0.5 + 0.5 * seen.dot(self.right) / half, 0.5 - 0.5 * seen.dot(self.up) / half)
        }

        fn ray(&self, u: f64, v: f64) -> DVec3 {
            let (x, y) = ((2.0 * u - 1.0) * 0.36, (1.0 - 2.0 * v) * 0.36);
            (self.right * x + self.up * y - self.back).normalize()
        }
    }

    /// The true sketch of balls without texture: 8 x 8 rays for a cell.
    pub fn sketch_of(balls: &[Ball], stance: &Stance) -> Vec<i8> {
        let camera = Plain::new(stance);
        let hits = |u: f64, v: f64| {
            let ray = camera.ray(u, v);
            balls.iter().any(|ball| (ball.centre - camera.eye).cross(ray).length() < ball.radius)
        };
        let mut sketch = std::vec![0; SKETCH];
        for (place, cover) in sketch[..COVER * COVER].iter_mut().enumerate() {
            let at = |cell: usize, step: usize| (8 * cell + step) as f64 / 128.0 + 1.0 / 256.0;
            let steps = (0..64).map(|step| (step % 8, step / 8));
            let count =
                steps.filter(|&(x, y)| hits(at(place % COVER, x), at(place / COVER, y))).count();
            *cover = ((count * 127 + 32) / 64) as i8;
        }
        sketch
    }

    /// The hull that true sketches leave.
    pub fn hull_of(balls: &[Ball], views: usize) -> Hull {
        let mut hull = whole();
        for stance in stances(views) {
            hull.carve(&Camera::try_new(&stance).unwrap(), &sketch_of(balls, &stance));
        }
        hull
    }

    /// A level square of 16 x 16 voxels, one voxel thick, about the centre.
    pub fn sheet() -> Hull {
        let mut hull = Hull::new();
        hull.rows[(8 + SIDE * 16) as usize..(24 + SIDE * 16) as usize].fill(0x00ff_ff00);
        hull
    }

    /// As before the first photo.
    pub fn whole() -> Hull {
        let mut hull = Hull::new();
        hull.fill();
        hull
    }

    fn holds(hull: &Hull, x: i32, y: i32, z: i32) -> bool {
        (0..SIDE).contains(&x) && hull.row(y, z) >> x & 1 == 1
    }

    /// The plain version of `is_open`.
    fn plainly_open(hull: &Hull, centre: Vec3, normal: Vec3, direction: Vec3) -> bool {
        let away = if normal == Vec3::ZERO { direction } else { normal };
        let begin = (centre + away * (1.2 * VOXEL) + Vec3::ONE) * (1.0 / VOXEL);
        let step = direction * 0.7;
        let mut place = begin + step * 0.5;
        for _ in 0..80 {
            if !place.to_array().into_iter().all(|at| (0.0..SIDE as f32).contains(&at)) {
                return true;
            }
            let [x, y, z] = place.to_array().map(|at| at as i32);
            if holds(hull, x, y, z) {
                return false;
            }
            place += step;
        }
        true
    }

    fn count(hull: &Hull) -> u32 {
        hull.rows.iter().map(|row| row.count_ones()).sum()
    }

    fn places() -> impl Iterator<Item = (i32, i32, i32)> {
        (0..ROWS as i32 * SIDE).map(|place| (place % 32, place / 32 % 32, place / 1024))
    }

    fn centre_of(x: i32, y: i32, z: i32) -> DVec3 {
        (DVec3::new(x.into(), y.into(), z.into()) + 0.5) / 16.0 - 1.0
    }

    const BALL: Ball = Ball::new(0.15, -0.1, 0.05, 0.6);

    #[test]
    fn before_the_first_photo_the_hull_is_the_ball() {
        let hull = whole();
        for (x, y, z) in places() {
            assert_eq!(holds(&hull, x, y, z), centre_of(x, y, z).length_squared() <= 1.0);
        }
    }

    #[test]
    fn the_hull_of_a_ball_holds_it_and_little_beyond() {
        let hull = hull_of(&[BALL], 12);
        for (x, y, z) in places() {
            let inside = (centre_of(x, y, z) - BALL.centre).length() < BALL.radius;
            assert!(holds(&hull, x, y, z) || !inside, "({x}, {y}, {z}) is gone");
        }
        let volume = f64::from(count(&hull)) / 4096.0;
        let ball = 4.0 / 3.0 * core::f64::consts::PI * BALL.radius.powi(3);
        // An outline runs a third to two thirds of a cell wide of the ball, and each photo carves: what
        // is left is a third wide, 0.045, or 1.24 of it in volume, and corners between twelve photos.
        assert!((1.24..1.4).contains(&(volume / ball)), "{}", volume / ball);
    }

    #[test]
    fn the_hull_of_two_balls_keeps_them_apart() {
        let balls = [Ball::new(-0.5, 0.0, 0.0, 0.35), Ball::new(0.45, 0.2, 0.0, 0.4)];
        let hull = hull_of(&balls, 12);
        // The slice z = 0, x to the right, y upwards: # a ball in the hull, o hull beside it, - a ball
        // that was carved.
        let mut picture = String::new();
        for y in (8..28).rev().step_by(2) {
            for x in 0..32 {
                let point = centre_of(x, y, 16);
                let ball = balls.iter().any(|ball| (point - ball.centre).length() < ball.radius);
                picture.push(match (holds(&hull, x, y, 16), ball) {
                    (true, true) => '#',
                    (true, false) => 'o',
                    (false, true) => '-',
                    (false, false) => '.',
                });
            }
            picture.push('\n');
        }
        let expected = "\
................................
....................oo##ooo.....
.................o##########o...
.....oo##ooo....o############o..
..oo########o...o#############o.
.oo##########o..o############o..
.o############...o##########o...
..o##########o....oo######oo....
....o######o....................
.........o......................
";
        assert_eq!(picture, expected, "\n{picture}");
    }

    #[test]
    fn what_carves_nothing() {
        let camera = Camera::try_new(&stances(5)[2]).unwrap();
        let mut hull = whole();
        let faint = [EMPTY as i8 - 1; SKETCH];
        for sketch in [&[0; SKETCH][..], &faint, &[-128; SKETCH], &[127; 255], &[]] {
            hull.carve(&camera, sketch);
            assert_eq!(hull.rows, whole().rows);
        }
        // A whole picture of object takes away nothing either, for the ball is in the picture.
        hull.carve(&camera, &[127; SKETCH]);
        assert_eq!(hull.rows, whole().rows);
        // A single cell leaves something, and the faintest takes something away.
        let carved = |cover: i8| {
            let (mut hull, mut one) = (whole(), [0; SKETCH]);
            one[8 * COVER + 7] = cover;
            hull.carve(&camera, &one);
            count(&hull)
        };
        assert!((1..1000).contains(&carved(127)), "{}", carved(127));
        assert!(carved(EMPTY as i8) < carved(127));
        assert_eq!(carved(EMPTY as i8 - 1), count(&whole()));
    }

    #[test]
    fn a_camera_sideways_to_the_object_is_none() {
        // Of every view, the camera is turned by an angle about its picture's vertical.
        let turned = |pose: &Pose, angle_rad: f32| {
            let turn = Quat::from_axis_angle(pose.up(), angle_rad) * pose.rotation();
            let stance =
                Stance::try_new(&Pose::try_new(pose.position(), turn).unwrap(), Vec3::ZERO);
            Camera::try_new(&stance.unwrap())
        };
        let sideways = core::f32::consts::FRAC_PI_2;
        for pose in Pool::try_new(ViewSpace::FibonacciSphere, 200, 3.0).unwrap().iter() {
            assert!(turned(&pose, sideways).is_none() && turned(&pose, -sideways).is_none());
            let straight = turned(&pose, 0.0).unwrap();
            for angle_rad in [sideways - 0.05, 0.05 - sideways] {
                let camera = turned(&pose, angle_rad).unwrap();
                assert!((camera.right - straight.right).length() < 5e-3, "{camera:?} {straight:?}");
            }
        }
    }

    #[test]
    fn a_surface_voxel_has_a_free_side() {
        let hull = hull_of(&[BALL, Ball::new(-0.6, 0.3, 0.2, 0.2)], 4);
        let sides = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)];
        let expected: Vec<_> = places()
            .filter(|&(x, y, z)| {
                let free = |(a, b, c): &(i32, i32, i32)| !holds(&hull, x + a, y + b, z + c);
                holds(&hull, x, y, z) && sides.iter().any(free)
            })
            .map(|(x, y, z)| Vec3::new(middle(x), middle(y), middle(z)))
            .collect();
        let got: Vec<_> = hull.surface(|_, _, _| true).map(|voxel| voxel.centre).collect();
        assert_eq!(got, expected);
        assert_eq!(hull.surface_count() as usize, expected.len());
        let half = hull.surface(|x, y, z| (x + y + z) % 2 == 0).count();
        assert!(half > expected.len() / 3 && half < expected.len() * 2 / 3);
    }

    #[test]
    fn normals_of_a_ball_point_outward_and_areas_add_up_to_its_surface() {
        let hull = whole();
        let (mut worst, mut sum, mut area) = (1.0f32, 0.0, 0.0);
        for voxel in hull.surface(|_, _, _| true) {
            assert!((voxel.normal.length() - 1.0).abs() < 1e-5);
            let cosine = voxel.normal.dot(voxel.centre.normalize());
            worst = worst.min(cosine);
            sum += math::acos(cosine).to_degrees();
            area += voxel.area * VOXEL * VOXEL;
        }
        let mean = sum / hull.surface_count() as f32;
        assert!(math::acos(worst).to_degrees() < 10.0 && mean < 5.0, "{worst} {mean}");
        let share = area / (4.0 * core::f32::consts::PI);
        assert!((0.95..1.0).contains(&share), "{share}");
    }

    #[test]
    fn a_ball_hides_nothing_in_front() {
        // What few photos leave of it has corners, and a corner of a voxel or two may hide itself.
        let hulls = [(whole(), 0.0), (hull_of(&[BALL], 100), 2e-4), (hull_of(&[BALL], 12), 2e-3)];
        let least = 76f32.to_radians().cos();
        for (hull, most) in hulls {
            let bounds = hull.bounds();
            let (mut front, mut hidden) = (0, 0);
            for voxel in hull.surface(|_, _, _| true) {
                for stance in stances(60) {
                    let towards = (Camera::eye_in(stance.direction) - voxel.centre).normalize();
                    let cosine = towards.dot(voxel.normal);
                    if cosine > least {
                        front += 1;
                        hidden +=
                            u32::from(!hull.is_open(&bounds, voxel.centre, voxel.normal, towards));
                    }
                }
            }
            assert!(f64::from(hidden) <= most * f64::from(front), "{hidden} of {front}");
        }
    }

    #[test]
    fn a_flat_sheet_is_open_to_both_sides() {
        let hull = sheet();
        let bounds = hull.bounds();
        // The line begins at 1.2 + 0.35 voxels: at a lesser height than half a voxel still in the sheet.
        let least = 0.5 / 1.55;
        // Away from the edges, whose normals point outward.
        let middle = 10..22;
        for voxel in hull.surface(|x, y, _| middle.contains(&x) && middle.contains(&y)) {
            assert_eq!((voxel.normal, voxel.area), (Vec3::ZERO, 1.0));
            for stance in stances(100) {
                let towards = (Camera::eye_in(stance.direction) - voxel.centre).normalize();
                let open = hull.is_open(&bounds, voxel.centre, voxel.normal, towards);
                assert_eq!(open, towards.z.abs() > least, "{voxel:?} from {towards}");
            }
        }
    }

    #[test]
    fn one_ball_hides_the_other() {
        let hull = hull_of(&[Ball::new(-0.55, 0.0, 0.0, 0.3), Ball::new(0.55, 0.0, 0.0, 0.3)], 40);
        let bounds = hull.bounds();
        let open = |from: core::ops::Range<f32>| {
            let facing = hull.surface(|_, _, _| true);
            let facing = facing.filter(|v| from.contains(&v.centre.x) && v.normal.x > 0.9);
            facing.map(|v| hull.is_open(&bounds, v.centre, v.normal, Vec3::X)).collect::<Vec<_>>()
        };
        let (inner, outer) = (open(-0.4..-0.1), open(0.7..1.0));
        assert!(inner.len() > 5 && outer.len() > 5, "{} {}", inner.len(), outer.len());
        assert!(inner.iter().all(|open| !open) && outer.iter().all(|open| *open));
    }

    /// The same few cases in every run, and nothing written to disk.
    pub fn cases(cases: u32) -> ProptestConfig {
        let rng_seed = prop::test_runner::RngSeed::Fixed(0x5eed);
        ProptestConfig { cases, rng_seed, failure_persistence: None, ..ProptestConfig::default() }
    }

    proptest! {
        #![proptest_config(cases(16))]

        #[test]
        fn the_order_of_photos_changes_nothing(
            photos in prop::collection::vec((any_stance(), any_sketch()), 1..6), first in 0usize..6,
        ) {
            let carved = |photos: &[(Stance, Vec<i8>)]| {
                let mut hull = whole();
                for (stance, sketch) in photos {
                    if let Some(camera) = Camera::try_new(stance) {
                        hull.carve(&camera, sketch);
                    }
                }
                hull
            };
            let before = carved(&photos);
            let mut photos = photos;
            photos.reverse();
            prop_assert_eq!(&before.rows, &carved(&photos).rows);
            let middle = first % photos.len();
            photos.rotate_left(middle);
            prop_assert_eq!(&before.rows, &carved(&photos).rows);
            // A photo again takes away nothing.
            photos.extend_from_within(..);
            prop_assert_eq!(&before.rows, &carved(&photos).rows);
        }

        #[test]
        fn a_voxel_goes_where_its_place_in_the_picture_shows_no_object(
            stance in any_stance(), sketch in any_sketch(),
        ) {
            let (plain, camera) = (Plain::new(&stance), Camera::try_new(&stance));
            prop_assume!(camera.is_some());
            let mut hull = whole();
            hull.carve(&camera.unwrap(), &sketch);
            let cell = |x: f64, y: f64| {
                let inside = (0.0..16.0).contains(&x) && (0.0..16.0).contains(&y);
                if inside { f64::from(sketch[16 * y as usize + x as usize]) } else { 0.0 }
            };
            let before = whole();
            for (x, y, z) in places().filter(|&(x, y, z)| holds(&before, x, y, z)) {
                let (u, v) = plain.project(centre_of(x, y, z));
                let (u, v) = (16.0 * u - 0.5, 16.0 * v - 0.5);
                let (left, top) = (u.floor(), v.floor());
                let (a, b) = (u - left, v - top);
                let above = (1.0 - a) * cell(left, top) + a * cell(left + 1.0, top);
                let below = (1.0 - a) * cell(left, top + 1.0) + a * cell(left + 1.0, top + 1.0);
                let cover = (1.0 - b) * above + b * below;
                // Places are cut to 1/256 of a cell, in which a cover changes by 1 in each direction.
                let above = cover - f64::from(EMPTY);
                if above.abs() > 3.0 {
                    prop_assert_eq!(holds(&hull, x, y, z), above > 0.0, "{} at {} {}", cover, u, v);
                }
            }
        }

        #[test]
        fn a_line_is_as_open_as_by_its_definition(
            sketches in prop::collection::vec((any_stance(), any_sketch()), 0..4),
            eyes in prop::collection::vec(any_stance(), 20),
        ) {
            let mut hull = whole();
            for (stance, sketch) in &sketches {
                if let Some(camera) = Camera::try_new(stance) {
                    hull.carve(&camera, sketch);
                }
            }
            let bounds = hull.bounds();
            for voxel in hull.surface(|x, y, z| (x + 3 * y + 5 * z) % 3 == 0) {
                let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
                // As near to a side as a line can come: its length is in units of 2^-14.
                let near = Vec3::new(3.0, 1.0 / 16384.0, -1.0 / 16384.0);
                let eyes = eyes.iter().map(|eye| Camera::eye_in(eye.direction) - voxel.centre);
                for towards in eyes.chain(axes).chain([near]).map(|towards| towards.normalize()) {
                    let open = hull.is_open(&bounds, voxel.centre, voxel.normal, towards);
                    let plain = plainly_open(&hull, voxel.centre, voxel.normal, towards);
                    prop_assert_eq!(open, plain, "{:?} {}", voxel, towards);
                }
            }
        }

        #[test]
        fn a_place_is_open_where_a_line_of_small_steps_meets_no_voxel(
            sketches in prop::collection::vec((any_stance(), any_sketch()), 1..3),
            eye in any_stance(),
        ) {
            let mut hull = whole();
            for (stance, sketch) in &sketches {
                if let Some(camera) = Camera::try_new(stance) {
                    hull.carve(&camera, sketch);
                }
            }
            let bounds = hull.bounds();
            for voxel in hull.surface(|x, y, z| (x + 3 * y + 5 * z) % 17 == 0) {
                let towards = (Camera::eye_in(eye.direction) - voxel.centre).normalize();
                if towards.dot(voxel.normal) <= 0.0 {
                    continue;
                }
                let begin = (voxel.centre + voxel.normal * 1.2 * VOXEL + 1.0) * 16.0;
                let (mut longest, mut inside) = (0, 0);
                for step in 0..6000 {
                    let at = begin + towards * (0.35 + step as f32 * 0.01);
                    if at.min_element() < 0.0 || at.max_element() >= 32.0 {
                        break;
                    }
                    let [x, y, z] = at.to_array().map(|part| part as i32);
                    inside = if holds(&hull, x, y, z) { inside + 1 } else { 0 };
                    longest = longest.max(inside);
                }
                let open = hull.is_open(&bounds, voxel.centre, voxel.normal, towards);
                // A run as long as a step cannot be stepped over.
                if longest == 0 {
                    prop_assert!(open);
                } else if longest > 72 {
                    prop_assert!(!open);
                }
            }
        }
    }
}
