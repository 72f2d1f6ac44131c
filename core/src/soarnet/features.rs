//! What the network is told of poses: directions as spherical harmonics, angles as hats, counts as
//! hats. Integers throughout, so that training and every target see the same numbers.
//!
//! A feature is a signed byte; its value is `feature / 127`. Lengths inside are in units of 2^-14.
//!
//! ```text
//! of a direction        (16): every harmonic of degree 1 to 3, and the zonal one of degree 4
//! of a view and another (16): the other's direction in the view's camera frame: the harmonics of
//!                             degree 1 and 2; the sine of half their angle over 8 hats
//! of a count             (4): log4 of the number of views, piecewise linear, over 4 hats
//! ```

use glam::Vec3;

use crate::math;
use crate::pose::Pose;

/// Features of a direction.
pub const DIRECTION: usize = 16;
/// Features of a view together with another direction.
pub const RELATION: usize = 16;
/// Features of a number of views.
pub const COUNT: usize = 4;

/// One, in units of lengths.
const ONE: i32 = 1 << 14;

/// A unit vector, each coordinate in units of 2^-14.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[i32; 3]", into = "[i32; 3]"))]
pub struct Direction {
    x: i32,
    y: i32,
    z: i32,
}

#[cfg(feature = "serde")]
impl From<Direction> for [i32; 3] {
    fn from(Direction { x, y, z }: Direction) -> Self {
        [x, y, z]
    }
}

/// Refuses what is no unit vector but for the rounding of its coordinates.
#[cfg(feature = "serde")]
impl TryFrom<[i32; 3]> for Direction {
    type Error = &'static str;

    fn try_from([x, y, z]: [i32; 3]) -> Result<Self, Self::Error> {
        let squared: i64 = [x, y, z].into_iter().map(|part| i64::from(part).pow(2)).sum();
        // Half a unit in each coordinate changes the length by less than one.
        let (least, most) = (i64::from(ONE - 1).pow(2), i64::from(ONE + 1).pow(2));
        if (least..=most).contains(&squared) { Ok(Self { x, y, z }) } else { Err("no direction") }
    }
}

impl Direction {
    /// What memory holds before there is one.
    pub(super) const NONE: Self = Self { x: 0, y: 0, z: 0 };

    /// The direction of a vector of any length but zero, NaN and infinity.
    pub fn try_from_vector(vector: Vec3) -> Option<Self> {
        let Vec3 { x, y, z } = math::unit(vector).filter(|unit| unit.is_finite())?;
        let fixed = |part: f32| math::floor(part * ONE as f32 + 0.5) as i32;
        Some(Self { x: fixed(x), y: fixed(y), z: fixed(z) })
    }

    /// The same in floating point, of unit length but for the rounding of its coordinates.
    pub(super) fn vector(self) -> Vec3 {
        Vec3::new(self.x as f32, self.y as f32, self.z as f32) * (1.0 / ONE as f32)
    }

    /// The cosine of the angle to another direction, in units of 2^-14.
    fn dot(self, other: Self) -> i32 {
        (self.x * other.x + self.y * other.y + self.z * other.z + ONE / 2) >> 14
    }

    /// The network's features of this direction, shape (16).
    pub fn features(self) -> [i8; DIRECTION] {
        let Self { x, y, z } = self;
        let [xx, yy, zz] = [x, y, z].map(|part| times(part, part));
        // Each polynomial is brought to a largest value of 1 on the sphere.
        let five_zz = 5 * zz - ONE;
        let fourth = 35 * times(zz, zz) - 30 * zz + 3 * ONE;
        [
            x,
            y,
            z,
            2 * times(x, y),
            2 * times(y, z),
            2 * times(z, x),
            xx - yy,
            (3 * zz - ONE) / 2,
            times(times(x, five_zz), 11_899), // 0.7262
            times(times(y, five_zz), 11_899),
            times(z, 5 * zz - 3 * ONE) / 2,
            times(times(z, xx - yy), 42_567),         // 2.5981
            times(times(times(x, y), z), 2 * 42_567), // 5.1962
            times(x, xx - 3 * yy),
            times(y, 3 * xx - yy),
            fourth / 8,
        ]
        .map(feature)
    }
}

/// Where a view was taken from, and how its camera was held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stance {
    /// From the object's centre to the camera, in the world.
    pub direction: Direction,
    /// The camera's axes in the world.
    right: Direction,
    up: Direction,
    back: Direction,
}

impl Stance {
    /// What memory holds before there is one.
    pub(super) const NONE: Self = Self {
        direction: Direction::NONE,
        right: Direction::NONE,
        up: Direction::NONE,
        back: Direction::NONE,
    };

    /// Of a camera at `pose`, around `centre` (world, metres); `None` where it stands on the centre.
    pub fn try_new(pose: &Pose, centre: Vec3) -> Option<Self> {
        Some(Self {
            direction: Direction::try_from_vector(pose.position() - centre)?,
            right: Direction::try_from_vector(pose.right())?,
            up: Direction::try_from_vector(pose.up())?,
            back: Direction::try_from_vector(-pose.forward())?,
        })
    }

    /// The camera's right, in the world.
    pub(super) fn right(&self) -> Vec3 {
        self.right.vector()
    }

    /// The same view of a world turned by `quarters` times 90 degrees about +Z, then, if
    /// `mirrored`, with its x reversed and the photo's left and right exchanged.
    pub fn turned(self, quarters: u32, mirrored: bool) -> Self {
        let turn = |d: Direction| {
            let Direction { x, y, z } = d;
            let (x, y) = match quarters % 4 {
                0 => (x, y),
                1 => (-y, x),
                2 => (-x, -y),
                _ => (y, -x),
            };
            Direction { x: if mirrored { -x } else { x }, y, z }
        };
        let right = turn(self.right);
        let reversed = Direction { x: -right.x, y: -right.y, z: -right.z };
        Self {
            direction: turn(self.direction),
            right: if mirrored { reversed } else { right },
            up: turn(self.up),
            back: turn(self.back),
        }
    }

    /// The network's features of this view and another direction, shape (16).
    pub fn relation(self, other: Direction) -> [i8; RELATION] {
        let (x, y, z) = (self.right.dot(other), self.up.dot(other), self.back.dot(other));
        let [xx, yy, zz] = [x, y, z].map(|part| times(part, part));
        // sin^2(a / 2) = (1 - cos a) / 2; the root of it times 2^28 is in units of 2^-14.
        let versine = (ONE - self.direction.dot(other)).clamp(0, 2 * ONE);
        let half_sine = ((versine << 13) as u32).isqrt() as i32;
        let [a, b, c, d, e, f, g, h] = hats(7 * half_sine);
        [
            feature(x),
            feature(y),
            feature(z),
            feature(2 * times(x, y)),
            feature(2 * times(y, z)),
            feature(2 * times(z, x)),
            feature(xx - yy),
            feature((3 * zz - ONE) / 2),
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
        ]
    }
}

/// The network's features of a number of views from 1 to 64, shape (4); others as the nearest.
pub fn count(views: usize) -> [i8; COUNT] {
    let views = views.clamp(1, 64) as i32;
    let whole = views.ilog2() as i32;
    // log2, linear between powers of two; half of it is log4.
    let log2 = whole * ONE + ((views << 14) >> whole) - ONE;
    hats(log2 / 2)
}

/// The product of two numbers in units of 2^-14, rounded down.
fn times(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 14) as i32
}

/// A value as a feature: 127 times it, rounded, halves up.
fn feature(value: i32) -> i8 {
    ((value * 127 + ONE / 2) >> 14).clamp(-127, 127) as i8
}

/// How near a place is to 0, 1, 2 and so on: 1 there, falling to 0 at the neighbours.
fn hats<const N: usize>(place: i32) -> [i8; N] {
    let mut knot = -ONE;
    [0; N].map(|_: i32| {
        knot += ONE;
        feature((ONE - (place - knot).abs()).max(0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same features in floating point, by their definitions.
    fn harmonics(d: Vec3) -> [f32; DIRECTION] {
        let Vec3 { x, y, z } = d;
        [
            x,
            y,
            z,
            2.0 * x * y,
            2.0 * y * z,
            2.0 * z * x,
            x * x - y * y,
            1.5 * z * z - 0.5,
            0.7262 * x * (5.0 * z * z - 1.0),
            0.7262 * y * (5.0 * z * z - 1.0),
            2.5 * z * z * z - 1.5 * z,
            2.5981 * z * (x * x - y * y),
            5.1962 * x * y * z,
            x * x * x - 3.0 * x * y * y,
            3.0 * x * x * y - y * y * y,
            (35.0 * z * z * z * z - 30.0 * z * z + 3.0) / 8.0,
        ]
    }

    fn direction() -> impl Strategy<Value = Vec3> {
        (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
            .prop_map(|(x, y, z)| Vec3::new(x, y, z))
            .prop_filter("long enough", |v| v.length() > 0.1)
            .prop_map(|v| v / v.length())
    }

    proptest! {
        #[test]
        fn features_of_a_direction_are_the_harmonics(d in direction()) {
            let got = Direction::try_from_vector(d).unwrap().features();
            for (got, expected) in got.into_iter().zip(harmonics(d)) {
                prop_assert!((f32::from(got) / 127.0 - expected).abs() < 0.006, "{got} {expected}");
            }
        }

        #[test]
        fn a_relation_is_the_direction_in_the_camera_and_the_angle(eye in direction(), d in direction()) {
            let pose = Pose::looking_at(eye * 3.0, Vec3::ZERO).unwrap();
            let stance = Stance::try_new(&pose, Vec3::ZERO).unwrap();
            let got = stance.relation(Direction::try_from_vector(d).unwrap());
            let seen = Vec3::new(pose.right().dot(d), pose.up().dot(d), -pose.forward().dot(d));
            for (got, expected) in got.into_iter().zip(harmonics(seen)).take(8) {
                prop_assert!((f32::from(got) / 127.0 - expected).abs() < 0.006, "{got} {expected}");
            }
            let place = 7.0 * ((1.0 - eye.dot(d)) / 2.0).max(0.0).sqrt();
            for (knot, &got) in got[8..].iter().enumerate() {
                let expected = (1.0 - (place - knot as f32).abs()).max(0.0);
                // Where the angle is small its sine is known to 1/128 only: 7 hats make that 0.06.
                prop_assert!((f32::from(got) / 127.0 - expected).abs() < 0.07, "{got} {expected}");
            }
        }

        #[test]
        fn turning_the_world_changes_no_relation(
            eye in direction(), d in direction(), quarters in 0u32..4, mirrored: bool,
        ) {
            let of = |v: Vec3| {
                let pose = Pose::looking_at(v * 3.0, Vec3::ZERO).unwrap();
                Stance::try_new(&pose, Vec3::ZERO).unwrap()
            };
            let (view, other) = (of(eye), of(d));
            let (view_turned, other_turned) =
                (view.turned(quarters, mirrored), other.turned(quarters, mirrored));
            let before = view.relation(other.direction);
            let after = view_turned.relation(other_turned.direction);
            for (place, (before, after)) in before.into_iter().zip(after).enumerate() {
                // In a mirror left and right change places.
                let odd = matches!(place, 0 | 3 | 5);
                let before = i32::from(before) * if mirrored && odd { -1 } else { 1 };
                prop_assert!((before - i32::from(after)).abs() <= 1, "{place}");
            }
        }
    }

    #[test]
    fn a_mirrored_camera_stands_where_a_mirrored_photo_was_taken() {
        // Only cameras with the picture's top towards +Z, so the pose is known without the photo.
        let of = |eye: Vec3| {
            Stance::try_new(&Pose::looking_at(eye, Vec3::ZERO).unwrap(), Vec3::ZERO).unwrap()
        };
        assert_eq!(of(Vec3::new(1.0, 2.0, 0.5)).turned(0, true), of(Vec3::new(-1.0, 2.0, 0.5)));
        assert_eq!(of(Vec3::new(1.0, 2.0, 0.5)).turned(1, false), of(Vec3::new(-2.0, 1.0, 0.5)));
    }

    #[test]
    fn counts_are_hats_over_log4() {
        assert_eq!(count(1), [127, 0, 0, 0]);
        assert_eq!(count(2), [64, 64, 0, 0]);
        assert_eq!(count(4), [0, 127, 0, 0]);
        assert_eq!(count(16), [0, 0, 127, 0]);
        assert_eq!(count(64), [0, 0, 0, 127]);
        assert_eq!(count(0), count(1));
        assert_eq!(count(1000), count(64));
    }

    #[test]
    fn no_direction_and_no_number_are_refused() {
        assert_eq!(Direction::try_from_vector(Vec3::ZERO), None);
        assert_eq!(Direction::try_from_vector(Vec3::new(f32::NAN, 1.0, 0.0)), None);
        assert_eq!(Direction::try_from_vector(Vec3::INFINITY), None);
    }
}
