//! Poses and candidates for programs that have none of their own.

use vantage_core::Vec3;
use vantage_core::candidates::{Pool as CorePool, ViewSpace as CoreSpace};

use crate::memory::{reference, reference_mut};
use crate::status::Status;
use crate::types::Pose;

/// From where a camera may look at the object: `space` of a pool.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Drawn evenly from the whole sphere by `seed`.
    RandomSphere = 0,
    /// An even lattice on the whole sphere.
    FibonacciSphere = 1,
    /// An even lattice between two elevations: what is above a table.
    Hemisphere = 2,
    /// Level rings one above the other: a turntable.
    Rings = 3,
    /// One line that winds upwards.
    Spiral = 4,
}

/// A numbered set of candidates that look at one point. Fields that a space does not name are not read.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pool {
    /// A `vantage_space`.
    pub space: u32,
    /// How many candidates.
    pub count: u32,
    /// Their distance from the target, metres.
    pub radius_m: f32,
    /// The point they look at, metres.
    pub target_m: [f32; 3],
    /// Lowest elevation in radians: hemisphere, rings, spiral.
    pub min_elevation_rad: f32,
    /// Highest elevation in radians: hemisphere, rings, spiral.
    pub max_elevation_rad: f32,
    /// Number of rings: rings.
    pub rings: u32,
    /// How often the line goes around: spiral.
    pub turns: f32,
    /// The same seed gives the same candidates: random sphere.
    pub seed: u64,
}

impl Pool {
    fn check(&self) -> Result<CorePool, Status> {
        const RANDOM_SPHERE: u32 = Space::RandomSphere as u32;
        const FIBONACCI_SPHERE: u32 = Space::FibonacciSphere as u32;
        const HEMISPHERE: u32 = Space::Hemisphere as u32;
        const RINGS: u32 = Space::Rings as u32;
        const SPIRAL: u32 = Space::Spiral as u32;
        let Self { min_elevation_rad, max_elevation_rad, .. } = *self;
        let space = match self.space {
            RANDOM_SPHERE => CoreSpace::RandomSphere { seed: self.seed },
            FIBONACCI_SPHERE => CoreSpace::FibonacciSphere,
            HEMISPHERE => CoreSpace::Hemisphere { min_elevation_rad, max_elevation_rad },
            RINGS => {
                let rings = self.rings as usize;
                CoreSpace::Rings { rings, min_elevation_rad, max_elevation_rad }
            }
            SPIRAL => {
                let turns = self.turns;
                CoreSpace::Spiral { turns, min_elevation_rad, max_elevation_rad }
            }
            _ => return Err(Status::BadNumber),
        };
        let pool = CorePool::try_new(space, self.count as usize, self.radius_m)?;
        Ok(pool.with_target(Vec3::from_array(self.target_m))?)
    }
}

/// Writes the pose of candidate `index` of a pool.
///
/// # Safety
///
/// Both pointers are null or valid for one value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_pool_pose(
    pool: *const Pool,
    index: u32,
    pose: *mut Pose,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (pool, pose) = unsafe { (reference(pool)?, reference_mut(pose)?) };
        let found = pool.check()?.pose(index as usize).ok_or(Status::UnknownCandidate)?;
        *pose = Pose::from(&found);
        Ok(())
    })())
}

/// Writes the pose of a camera at `eye_m` that looks at `target_m` with the photo's top towards +Z, each
/// three numbers in metres.
///
/// # Safety
///
/// The pointers are null or valid for three numbers, `pose` for one value.
// SAFETY: no other symbol of the library bears the name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn vantage_pose_looking_at(
    eye_m: *const f32,
    target_m: *const f32,
    pose: *mut Pose,
) -> Status {
    Status::of((|| {
        // SAFETY: the caller's promise.
        let (eye, target, pose) = unsafe {
            let vector = |numbers: *const f32| reference(numbers.cast::<[f32; 3]>());
            (vector(eye_m)?, vector(target_m)?, reference_mut(pose)?)
        };
        let (eye, target) = (Vec3::from_array(*eye), Vec3::from_array(*target));
        *pose = Pose::from(&vantage_core::Pose::looking_at(eye, target)?);
        Ok(())
    })())
}
