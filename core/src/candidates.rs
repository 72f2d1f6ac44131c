//! View spaces: from where a camera may look at the object.
//!
//! A [`Pool`] is a view space with a size, a radius and a target. Its poses are numbered and each
//! is computed on its own, so a pool costs no memory and a controller can hold one of thousands of
//! views. All of them look at the target.
//!
//! ```
//! use vantage_core::candidates::{Pool, Reach, ViewSpace};
//! let space = ViewSpace::Rings { rings: 3, min_elevation_rad: 0.1, max_elevation_rad: 1.0 };
//! let turntable = Pool::try_new(space, 36, 0.5).unwrap();
//! let low = Reach::default().with_elevation(0.0, 0.3);
//! assert_eq!(turntable.reachable(&low).count(), 12);
//! ```

use core::f32::consts::{FRAC_PI_2, TAU};
use core::fmt;

use glam::Vec3;
use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::math;
use crate::pose::Pose;

/// The shape of a view space. Elevations are radians above the horizontal plane through the target.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ViewSpace {
    /// Directions drawn evenly from the whole sphere; a longer pool starts with the shorter one.
    RandomSphere {
        /// The same seed gives the same directions.
        seed: u64,
    },
    /// The golden-angle lattice on the whole sphere: even and without chance.
    FibonacciSphere,
    /// The golden-angle lattice between two elevations, even by area: what is above a table.
    Hemisphere {
        /// Lowest elevation, radians.
        min_elevation_rad: f32,
        /// Highest elevation, radians.
        max_elevation_rad: f32,
    },
    /// Level rings one above the other, each turned by half a step against the last: a turntable.
    Rings {
        /// How many; the views are dealt to them as evenly as can be, the lower ones first.
        rings: usize,
        /// Elevation of the lowest ring, radians.
        min_elevation_rad: f32,
        /// Elevation of the highest ring, radians; a single ring stands halfway.
        max_elevation_rad: f32,
    },
    /// One line that winds upwards, even by area.
    Spiral {
        /// How often it goes around; 1 with equal elevations is a circle.
        turns: f32,
        /// Elevation where it starts, radians.
        min_elevation_rad: f32,
        /// Elevation where it ends, radians.
        max_elevation_rad: f32,
    },
}

/// Why numbers do not make a pool.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PoolError {
    /// A pool needs at least one view.
    Empty,
    /// The radius is not between 1e-6 and 1e6 metres.
    BadRadius {
        /// The radius given, metres.
        radius_m: f32,
    },
    /// Elevations must satisfy -pi/2 <= lowest <= highest <= pi/2.
    BadElevations {
        /// Lowest elevation given, radians.
        min_rad: f32,
        /// Highest elevation given, radians.
        max_rad: f32,
    },
    /// There must be at least one ring, and no more rings than views.
    BadRings {
        /// Rings asked for.
        rings: usize,
        /// Views to deal to them.
        count: usize,
    },
    /// The number of turns is not finite, or too large to wind.
    BadTurns,
    /// The target is not finite, or so far from the origin that single precision cannot tell the
    /// cameras around it apart.
    BadTarget,
}

impl fmt::Display for PoolError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a candidate pool needs at least one view"),
            Self::BadRadius { radius_m } => {
                write!(f, "the camera's distance must lie between 1e-6 and 1e6 m, not {radius_m}")
            }
            Self::BadElevations { min_rad, max_rad } => write!(
                f,
                "elevations must rise from at least -90 to at most 90 degrees, not from {:.1} to {:.1}",
                min_rad.to_degrees(),
                max_rad.to_degrees()
            ),
            Self::BadRings { rings, count } => {
                write!(f, "{count} views cannot be dealt to {rings} rings: give 1 to {count} rings")
            }
            Self::BadTurns => f.write_str("the spiral's turns must lie between -1e4 and 1e4"),
            Self::BadTarget => f.write_str(
                "the views' target must lie within a thousand radii of the world's origin",
            ),
        }
    }
}

impl core::error::Error for PoolError {}

/// A numbered set of poses in a view space, all looking at one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pool {
    space: ViewSpace,
    count: usize,
    radius_m: f32,
    target: Vec3, // in world, metres
}

impl Pool {
    /// `count` views of a space at `radius_m` from the world's origin.
    pub fn try_new(space: ViewSpace, count: usize, radius_m: f32) -> Result<Self, PoolError> {
        if count == 0 {
            return Err(PoolError::Empty);
        }
        if !(1e-6..=1e6).contains(&radius_m) {
            return Err(PoolError::BadRadius { radius_m });
        }
        if let Some((min_rad, max_rad)) = space.elevations()
            && !(-FRAC_PI_2 <= min_rad && min_rad <= max_rad && max_rad <= FRAC_PI_2)
        {
            return Err(PoolError::BadElevations { min_rad, max_rad });
        }
        match space {
            ViewSpace::Rings { rings, .. } if rings == 0 || rings > count => {
                return Err(PoolError::BadRings { rings, count });
            }
            ViewSpace::Spiral { turns, .. } if !(-1e4..=1e4).contains(&turns) => {
                return Err(PoolError::BadTurns);
            }
            _ => {}
        }
        Ok(Self { space, count, radius_m, target: Vec3::ZERO })
    }

    /// The same views around another point of the world, metres, within a thousand radii of the
    /// origin.
    pub fn with_target(self, target: Vec3) -> Result<Self, PoolError> {
        let near = target.is_finite() && target.abs().max_element() <= 1e3 * self.radius_m;
        if near { Ok(Self { target, ..self }) } else { Err(PoolError::BadTarget) }
    }

    /// How many views the pool has; never 0.
    #[expect(clippy::len_without_is_empty, reason = "a pool is never empty")]
    pub fn len(&self) -> usize {
        self.count
    }

    /// The pose of view `index`, or `None` past the end.
    pub fn pose(&self, index: usize) -> Option<Pose> {
        if index >= self.count {
            return None;
        }
        let eye = self.target + self.radius_m * self.space.direction(index, self.count);
        Pose::looking_at(eye, self.target).ok()
    }

    /// All poses in order.
    pub fn iter(&self) -> impl Iterator<Item = Pose> + '_ {
        (0..self.count).filter_map(|index| self.pose(index))
    }

    /// The views that can be reached, with their numbers in the pool.
    pub fn reachable<'a, P: Fn(&Pose) -> bool>(
        &'a self,
        reach: &'a Reach<'a, P>,
    ) -> impl Iterator<Item = (usize, Pose)> + 'a {
        self.iter().enumerate().filter(|(index, pose)| reach.allows(*index, pose, self.target))
    }
}

impl ViewSpace {
    fn elevations(&self) -> Option<(f32, f32)> {
        match *self {
            Self::RandomSphere { .. } | Self::FibonacciSphere => None,
            Self::Hemisphere { min_elevation_rad: low, max_elevation_rad: high }
            | Self::Rings { min_elevation_rad: low, max_elevation_rad: high, .. }
            | Self::Spiral { min_elevation_rad: low, max_elevation_rad: high, .. } => {
                Some((low, high))
            }
        }
    }

    /// The direction from the target to view `index` of `count`, unit length.
    fn direction(&self, index: usize, count: usize) -> Vec3 {
        // The middle of the index-th of `count` equal parts of [0, 1].
        let part = |index: usize, count: usize| (index as f32 + 0.5) / count as f32;
        match *self {
            Self::RandomSphere { seed } => {
                // Its own stream for each view: any view of the pool without those before it.
                let mut chance = chance(seed, index as u64);
                let height = 2.0 * unit_interval(&mut chance) - 1.0;
                on_sphere(height, unit_interval(&mut chance))
            }
            Self::FibonacciSphere => on_sphere(1.0 - 2.0 * part(index, count), golden(index)),
            Self::Hemisphere { min_elevation_rad, max_elevation_rad } => {
                let (low, high) = (math::sin(min_elevation_rad), math::sin(max_elevation_rad));
                on_sphere(high + (low - high) * part(index, count), golden(index))
            }
            Self::Rings { rings, min_elevation_rad, max_elevation_rad } => {
                // Ring r holds the views from start(r) to start(r + 1); the first ones are longer.
                let (share, longer) = (count / rings.max(1), count % rings.max(1));
                let long = share.saturating_add(1); // saturates for usize::MAX in one ring: none is longer
                let boundary = longer * long;
                let (ring, place, size) = if index < boundary {
                    (index / long, index % long, long)
                } else {
                    let after = index - boundary;
                    (longer + after / share.max(1), after % share.max(1), share)
                };
                let rise = if rings > 1 { ring as f32 / (rings - 1) as f32 } else { 0.5 };
                let elevation = min_elevation_rad + (max_elevation_rad - min_elevation_rad) * rise;
                let turn = (place as f32 + 0.5 * (ring % 2) as f32) / size.max(1) as f32;
                on_sphere(math::sin(elevation), turn)
            }
            Self::Spiral { turns, min_elevation_rad, max_elevation_rad } => {
                let (low, high) = (math::sin(min_elevation_rad), math::sin(max_elevation_rad));
                let along = part(index, count);
                on_sphere(low + (high - low) * along, turns * along)
            }
        }
    }
}

/// Which poses of a pool the camera can get to.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a, P = fn(&Pose) -> bool> {
    min_elevation_rad: f32,
    max_elevation_rad: f32,
    blocked: &'a [usize],
    predicate: P,
}

impl Default for Reach<'_> {
    /// Everything is reachable.
    fn default() -> Self {
        Self {
            min_elevation_rad: -FRAC_PI_2,
            max_elevation_rad: FRAC_PI_2,
            blocked: &[],
            predicate: |_| true,
        }
    }
}

impl<'a, P: Fn(&Pose) -> bool> Reach<'a, P> {
    /// Only elevations in `[min_rad, max_rad]`, radians above the target's horizontal plane.
    pub fn with_elevation(self, min_rad: f32, max_rad: f32) -> Self {
        Self { min_elevation_rad: min_rad, max_elevation_rad: max_rad, ..self }
    }

    /// Without the views of these numbers.
    pub fn without(self, blocked: &'a [usize]) -> Self {
        Self { blocked, ..self }
    }

    /// Only poses of which `predicate` says yes: walls, a cable's length, a keep-out zone.
    pub fn with_predicate<R: Fn(&Pose) -> bool>(self, predicate: R) -> Reach<'a, R> {
        Reach {
            min_elevation_rad: self.min_elevation_rad,
            max_elevation_rad: self.max_elevation_rad,
            blocked: self.blocked,
            predicate,
        }
    }

    /// Whether view `index` at `pose` around `target` can be reached.
    pub fn allows(&self, index: usize, pose: &Pose, target: Vec3) -> bool {
        // Half a thousandth of a degree, so that a ring on the limit is on the allowed side of it.
        const SLACK_RAD: f32 = 1e-5;
        let Some(direction) = math::unit(pose.position() - target) else { return false };
        let elevation = math::asin(direction.z);
        elevation >= self.min_elevation_rad - SLACK_RAD
            && elevation <= self.max_elevation_rad + SLACK_RAD
            && !self.blocked.contains(&index)
            && (self.predicate)(pose)
    }
}

/// The point of the unit sphere at a height in [-1, 1] and an azimuth in turns.
fn on_sphere(height: f32, turn: f32) -> Vec3 {
    let height = height.clamp(-1.0, 1.0);
    let level = math::sqrt((1.0 - height * height).max(0.0));
    let azimuth = TAU * turn;
    Vec3::new(level * math::cos(azimuth), level * math::sin(azimuth), height)
}

/// The fraction of a turn after `index` golden angles, exact to 2^-24 however large the index.
fn golden(index: usize) -> f32 {
    // 2^32 / golden ratio; the product wraps as the angle does.
    let turn = (index as u32).wrapping_mul(0x9e37_79b9);
    (turn >> 8) as f32 / (1 << 24) as f32
}

/// Chance for one of many draws from one seed, each on its own.
///
/// Seed and number are scrambled together first. A PCG alone starts streams that are shifts of each
/// other: seed + 2 draws at any number what seed draws at the next one.
pub(crate) fn chance(seed: u64, number: u64) -> Pcg32 {
    Pcg32::new(scrambled(scrambled(seed).wrapping_add(number)), number)
}

/// The mixing of SplitMix64 (Steele, Lea and Flood, 2014): one to one, each bit depends on all.
fn scrambled(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The next number in [0, 1) with 24 bits.
pub(crate) fn unit_interval(chance: &mut Pcg32) -> f32 {
    (chance.next_u32() >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_4;
    use proptest::prelude::*;
    use std::vec::Vec;

    const SPACES: [ViewSpace; 5] = [
        ViewSpace::RandomSphere { seed: 7 },
        ViewSpace::FibonacciSphere,
        ViewSpace::Hemisphere { min_elevation_rad: 0.1, max_elevation_rad: 1.2 },
        ViewSpace::Rings { rings: 3, min_elevation_rad: -0.2, max_elevation_rad: 0.9 },
        ViewSpace::Spiral { turns: 4.0, min_elevation_rad: 0.0, max_elevation_rad: 1.5 },
    ];

    #[test]
    fn every_view_lies_on_its_sphere_and_looks_at_the_target() {
        let target = Vec3::new(1.0, -2.0, 0.5);
        for space in SPACES {
            let pool = Pool::try_new(space, 50, 2.5).unwrap().with_target(target).unwrap();
            assert_eq!(pool.iter().count(), 50);
            for pose in pool.iter() {
                let offset = pose.position() - target;
                assert!((offset.length() - 2.5).abs() < 1e-5, "{space:?}");
                assert!((pose.forward() + offset / 2.5).length() < 1e-5, "{space:?}");
                if let Some((low, high)) = space.elevations() {
                    let elevation = math::asin(offset.z / 2.5);
                    assert!(elevation > low - 1e-4 && elevation < high + 1e-4, "{space:?}");
                }
            }
        }
    }

    #[test]
    fn the_lattice_and_the_draw_are_even() {
        for space in [ViewSpace::FibonacciSphere, ViewSpace::RandomSphere { seed: 3 }] {
            let pool = Pool::try_new(space, 2000, 1.0).unwrap();
            let mean = pool.iter().map(|p| p.position()).sum::<Vec3>() / 2000.0;
            assert!(mean.length() < 0.05, "{space:?}: {mean}");
            let spread = pool.iter().map(|p| p.position() * p.position()).sum::<Vec3>() / 2000.0;
            assert!((spread - Vec3::splat(1.0 / 3.0)).length() < 0.03, "{space:?}: {spread}");
        }
    }

    #[test]
    fn a_longer_random_pool_starts_with_the_shorter_one() {
        let pool = |count| Pool::try_new(ViewSpace::RandomSphere { seed: 9 }, count, 3.0).unwrap();
        assert!(pool(20).iter().eq(pool(60).iter().take(20)));
    }

    #[test]
    fn pools_of_neighbouring_seeds_share_no_view() {
        let pool = |seed| Pool::try_new(ViewSpace::RandomSphere { seed }, 40, 1.0).unwrap();
        let views = |seed| pool(seed).iter().map(|pose| pose.position()).collect::<Vec<Vec3>>();
        for seed in 1..20 {
            assert!(views(0).iter().all(|view| !views(seed).contains(view)), "seed {seed}");
        }
    }

    #[test]
    fn rings_share_the_views_out_evenly() {
        let space =
            ViewSpace::Rings { rings: 3, min_elevation_rad: 0.0, max_elevation_rad: FRAC_PI_4 };
        let pool = Pool::try_new(space, 10, 1.0).unwrap();
        let heights: Vec<i32> = pool.iter().map(|p| (p.position().z * 1000.0) as i32).collect();
        assert_eq!(heights, [0, 0, 0, 0, 382, 382, 382, 707, 707, 707]);
    }

    #[test]
    fn reach_filters_by_elevation_number_and_predicate() {
        let pool = Pool::try_new(ViewSpace::FibonacciSphere, 100, 1.0).unwrap();
        let above = Reach::default().with_elevation(0.0, FRAC_PI_2);
        assert_eq!(pool.reachable(&above).count(), 50);
        let without = above.without(&[0, 1]);
        assert_eq!(pool.reachable(&without).count(), 48);
        let front = without.with_predicate(|pose| pose.position().x > 0.0);
        assert!(pool.reachable(&front).all(|(i, p)| i > 1 && p.position().x > 0.0));
    }

    #[test]
    fn impossible_pools_are_refused() {
        let sphere = ViewSpace::FibonacciSphere;
        assert_eq!(Pool::try_new(sphere, 0, 1.0), Err(PoolError::Empty));
        assert!(matches!(Pool::try_new(sphere, 1, f32::NAN), Err(PoolError::BadRadius { .. })));
        for radius in [1e-13, 1e30] {
            assert!(matches!(Pool::try_new(sphere, 1, radius), Err(PoolError::BadRadius { .. })));
        }
        let pool = Pool::try_new(sphere, 10, 0.4).unwrap();
        assert_eq!(pool.with_target(Vec3::splat(1e7)), Err(PoolError::BadTarget));
        assert_eq!(pool.with_target(Vec3::NAN), Err(PoolError::BadTarget));
        for radius in [1e-6, 1e6] {
            let pool = Pool::try_new(sphere, 10, radius).unwrap();
            let pool = pool.with_target(Vec3::splat(1e3 * radius)).unwrap();
            assert_eq!(pool.iter().count(), pool.len());
        }
        let upside_down = ViewSpace::Hemisphere { min_elevation_rad: 1.0, max_elevation_rad: 0.0 };
        assert!(matches!(Pool::try_new(upside_down, 4, 1.0), Err(PoolError::BadElevations { .. })));
        let rings = ViewSpace::Rings { rings: 5, min_elevation_rad: 0.0, max_elevation_rad: 0.0 };
        assert_eq!(Pool::try_new(rings, 4, 1.0), Err(PoolError::BadRings { rings: 5, count: 4 }));
    }

    #[test]
    fn a_pool_of_as_many_views_as_there_are_numbers_has_its_poses() {
        let one = ViewSpace::Rings { rings: 1, min_elevation_rad: 0.0, max_elevation_rad: 0.0 };
        for space in SPACES.into_iter().chain([one]) {
            let pool = Pool::try_new(space, usize::MAX, 1.0).unwrap();
            for index in [0, 1, usize::MAX / 2, usize::MAX - 1] {
                assert!(pool.pose(index).is_some(), "{space:?} {index}");
            }
        }
    }

    proptest! {
        #[test]
        fn every_ring_layout_deals_all_views(count in 1usize..200, rings in 1usize..200) {
            prop_assume!(rings <= count);
            let space = ViewSpace::Rings { rings, min_elevation_rad: -1.0, max_elevation_rad: 1.0 };
            prop_assert_eq!(Pool::try_new(space, count, 1.0).unwrap().iter().count(), count);
        }
    }
}
