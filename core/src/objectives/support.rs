//! Support: whether what later views will look for has been seen from near enough a direction, and
//! whether the space around the object has been seen to be empty.
//!
//! The four objectives of the paper ask how much of the surface has been seen and from how many sides.
//! A radiance field must do more: give each place the colour that it has *towards a new view*, and keep
//! free what is free. `F = L + 15 V`, both monotone and with diminishing gains:
//!
//! - **L, log angular support.** For a target, a place of the surface as a new view would see it, a photo
//!   counts `a = visible · min(1, 2 cos θ) · (135° / (φ + 15°))²`, θ being the angle of incidence and φ
//!   that between the two lines of sight; `L` is the mean of `ln(1 + Σ a)` over all targets.
//! - **V, space shown to be empty.** The share of the voxels around the object that lie beside its outline
//!   in at least one photo. What no photo has carved away is where radiance fields put floating fog.
//!
//! The account is a number for each target and a bit for each voxel, whatever the views.

use core::fmt;

use glam::Vec3;

use crate::math;

/// How much V counts beside L.
const CARVING: f32 = 15.0;

/// Of the angle between two lines of sight: where support has fallen to a quarter, and what it is at none.
const HALF_DEG: f32 = 15.0;
const WHOLE_DEG: f32 = 135.0;

/// A place of the surface, and from where a new view would look at it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Target {
    /// World, metres.
    pub place: Vec3,
    /// The surface's normal on the side that is looked at, unit length.
    pub normal: Vec3,
    /// From the place to the new view's camera, unit length.
    pub towards: Vec3,
}

impl Target {
    /// What a photo from `camera` (world, metres) that sees the place counts for the new view: 0 to 81.
    pub fn support(&self, camera: Vec3) -> f32 {
        let Some(direction) = math::unit(camera - self.place) else { return 0.0 };
        let facing = (2.0 * direction.dot(self.normal)).clamp(0.0, 1.0);
        let apart = math::acos(direction.dot(self.towards).clamp(-1.0, 1.0)).to_degrees();
        let near = WHOLE_DEG / (apart + HALF_DEG);
        facing * near * near
    }
}

/// What a photo shows, as bit sets: bit `i % 32` of word `i / 32` stands for number `i`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Glimpse<'a> {
    /// The targets whose place it sees; shape (ceil(targets / 32)).
    pub seen: &'a [u32],
    /// The voxels that lie beside the object's outline; shape (ceil(voxels / 32)).
    pub empty: &'a [u32],
}

/// The account of support, as views are added.
#[derive(Debug)]
pub struct SupportLedger<'a> {
    targets: &'a [Target],
    sums: &'a mut [f32],  // (targets), support so far
    empty: &'a mut [u32], // (ceil(voxels / 32)), shown to be empty so far
    voxels: usize,
}

/// Why an account of support cannot be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SupportError {
    /// There is no target or no voxel.
    Empty,
    /// The caller's arrays do not have the length that targets and voxels need.
    WrongLength {
        /// Numbers and words needed.
        expected: [usize; 2],
        /// Numbers and words handed over.
        got: [usize; 2],
    },
    /// A target has a NaN or an infinity, or a direction off unit length.
    BadTarget {
        /// Which.
        index: usize,
    },
}

impl fmt::Display for SupportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("support needs at least one target and one voxel"),
            Self::WrongLength { expected, got } => write!(
                f,
                "support needs {} sums and {} words of voxels, not {} and {}",
                expected[0], expected[1], got[0], got[1]
            ),
            Self::BadTarget { index } => write!(f, "target {index} holds a number that cannot be"),
        }
    }
}

impl core::error::Error for SupportError {}

impl<'a> SupportLedger<'a> {
    /// An empty account in the caller's memory: a sum for each target, a bit for each of `voxels`.
    pub fn try_new(
        targets: &'a [Target],
        voxels: usize,
        sums: &'a mut [f32],
        empty: &'a mut [u32],
    ) -> Result<Self, SupportError> {
        if targets.is_empty() || voxels == 0 {
            return Err(SupportError::Empty);
        }
        let (expected, got) = ([targets.len(), voxels.div_ceil(32)], [sums.len(), empty.len()]);
        if expected != got {
            return Err(SupportError::WrongLength { expected, got });
        }
        let is_unit = |v: Vec3| (v.length_squared() - 1.0).abs() < 1e-3;
        let is_bad = |t: &Target| !(t.place.is_finite() && is_unit(t.normal) && is_unit(t.towards));
        if let Some(index) = targets.iter().position(is_bad) {
            return Err(SupportError::BadTarget { index });
        }
        sums.fill(0.0);
        empty.fill(0);
        Ok(Self { targets, sums, empty, voxels })
    }

    /// Adds a view from `camera` (world, metres).
    pub fn add(&mut self, camera: Vec3, glimpse: &Glimpse<'_>) {
        for (index, (sum, target)) in self.sums.iter_mut().zip(self.targets).enumerate() {
            if holds(glimpse.seen, index) {
                *sum += target.support(camera);
            }
        }
        for (known, new) in self.empty.iter_mut().zip(glimpse.empty) {
            *known |= new;
        }
    }

    /// What F would gain by a view from `camera`.
    pub fn gain(&self, camera: Vec3, glimpse: &Glimpse<'_>) -> f32 {
        let targets = self.sums.iter().zip(self.targets).enumerate();
        let seen = targets.filter(|(index, _)| holds(glimpse.seen, *index));
        let angular = seen.map(|(_, (sum, target))| {
            f64::from(math::ln(1.0 + target.support(camera) / (1.0 + sum)))
        });
        let fresh = self.empty.iter().zip(glimpse.empty).map(|(known, new)| new & !known);
        let carved: u32 = fresh.map(u32::count_ones).sum();
        self.of(angular.sum(), carved)
    }

    /// F of the views so far.
    pub fn value(&self) -> f32 {
        let angular = self.sums.iter().map(|sum| f64::from(math::ln(1.0 + sum))).sum();
        self.of(angular, self.empty.iter().map(|word| word.count_ones()).sum())
    }

    fn of(&self, angular: f64, carved: u32) -> f32 {
        let share = carved as f32 / self.voxels as f32;
        (angular / self.targets.len() as f64) as f32 + CARVING * share
    }
}

/// Whether a bit is set; not past the end.
fn holds(words: &[u32], index: usize) -> bool {
    words.get(index / 32).is_some_and(|word| word >> (index % 32) & 1 == 1)
}
