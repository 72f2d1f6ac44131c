//! What C passes and is given, and what the core makes of it.

use vantage_core::planner::{Plan as CorePlan, Reason as CoreReason, Stop};
use vantage_core::soarnet::{Image, Photo as CorePhoto, Pixels, Window};
use vantage_core::{Objective, Pose as CorePose, Quat, Vec3};

use crate::memory::bytes;
use crate::status::Status;

/// How views are chosen: `scheme` of a plan.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// One objective a view, C Q Q D D T in turn: the paper's.
    Ensemble = 0,
    /// The largest sum of the four gains.
    Sum = 1,
    /// Most new surface.
    Coverage = 2,
    /// Most fine shape.
    Geometry = 3,
    /// Most new directions.
    Diversity = 4,
    /// Most fine texture.
    Texture = 5,
    /// Farthest from all views so far; looks at no photo.
    FarthestPoint = 6,
    /// By chance; looks at no photo.
    Random = 7,
    /// Most support for later views, well away from all views so far and, for six views, from their
    /// opposite sides. Needs a model that looks at photos.
    Support = 8,
}

/// How pixels lie in memory: `format` of a photo.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Two bytes, a little-endian number: 5 bits red (highest), 6 green, 5 blue.
    Rgb565 = 0,
    /// Three bytes: red, green, blue.
    Rgb888 = 1,
    /// One byte of brightness.
    Luma8 = 2,
}

/// Why a view was chosen.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// One of the first views.
    Start = 0,
    /// By chance.
    Chance = 1,
    /// Farthest from all views so far.
    Farthest = 2,
    /// Most new surface expected.
    Coverage = 3,
    /// Most fine shape left to see.
    Geometry = 4,
    /// Most new viewing directions.
    Diversity = 5,
    /// Most surface detail left to see.
    Texture = 6,
    /// Most gain over all four objectives.
    AllObjectives = 7,
    /// Most support for what later views will look for; no scheme of this header asks for it.
    Support = 8,
}

/// Why there is no next view.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// There is one.
    NotYet = 0,
    /// As many views as asked for have been taken.
    BudgetSpent = 1,
    /// The stop rule: further views promise too little.
    GoodEnough = 2,
    /// Every candidate has been visited, blocked or skipped.
    NothingLeft = 3,
}

/// What has become of a candidate.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CandidateStatus {
    /// It may be chosen.
    Available = 0,
    /// A photo was taken of it.
    Visited = 1,
    /// Not before another photo has been taken.
    Skipped = 2,
    /// It cannot be reached.
    Blocked = 3,
}

/// Where a camera stands and looks: `world_from_camera`. The world is right-handed with +Z up; the
/// camera looks along its -Z, +X right, +Y up (OpenGL's axes).
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Camera centre x, y, z in the world, metres.
    pub position_m: [f32; 3],
    /// Unit quaternion x, y, z, w; off unit length by 1e-3 at most.
    pub rotation: [f32; 4],
}

/// What is asked of the planner.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// A `vantage_scheme`.
    pub scheme: u32,
    /// Views asked for, from 1 to the number of candidates.
    pub budget_views: u32,
    /// For what is left to chance: the first view, and the random scheme.
    pub seed: u64,
    /// In [0, 1]: the share of a gain that half a turn around the centre costs.
    pub movement_cost: f32,
    /// The stop rule: a choice of less expected gain is weak.
    pub stop_gain: f32,
    /// So many weak choices in a row end the session; 0 for no stop rule.
    pub stop_patience: u32,
    /// The object's middle in the world, metres.
    pub centre_m: [f32; 3],
}

/// A photo in the caller's memory, row by row from the top, without gaps.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Photo {
    /// The pixels.
    pub pixels: *const u8,
    /// Bytes there are: width x height x bytes of a pixel.
    pub length: usize,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// A `vantage_format`.
    pub format: u32,
    /// The square to look at: its left edge in pixels; it may reach over the border.
    pub window_left: i32,
    /// Its upper edge.
    pub window_top: i32,
    /// Its side; 0 for the largest square in the middle.
    pub window_side: u32,
}

/// The next view, and why.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Next {
    /// Its index among the candidates.
    pub index: u32,
    /// Where to stand.
    pub pose: Pose,
    /// Why it was chosen.
    pub reason: Reason,
    /// The gain expected of it, in the objective's own units; metres for farthest points.
    pub gain: f32,
}

/// Scores of the views so far, in [0, 1], as the model sees them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scores {
    /// How much of the surface has been seen.
    pub coverage: f32,
    /// How much fine shape has been seen, and how often.
    pub geometry: f32,
    /// From how many directions it has been seen.
    pub diversity: f32,
    /// How much fine texture has been seen, and how often.
    pub texture: f32,
}

impl Pose {
    /// The core's pose.
    pub fn check(&self) -> Result<CorePose, Status> {
        let rotation = Quat::from_array(self.rotation);
        Ok(CorePose::try_new(Vec3::from_array(self.position_m), rotation)?)
    }
}

impl From<&CorePose> for Pose {
    fn from(pose: &CorePose) -> Self {
        Self { position_m: pose.position().to_array(), rotation: pose.rotation().to_array() }
    }
}

impl Plan {
    /// The core's plan; what its numbers are is checked when a session takes it.
    pub fn check(&self) -> Result<CorePlan, Status> {
        const ENSEMBLE: u32 = Scheme::Ensemble as u32;
        const SUM: u32 = Scheme::Sum as u32;
        const COVERAGE: u32 = Scheme::Coverage as u32;
        const GEOMETRY: u32 = Scheme::Geometry as u32;
        const DIVERSITY: u32 = Scheme::Diversity as u32;
        const TEXTURE: u32 = Scheme::Texture as u32;
        const FARTHEST_POINT: u32 = Scheme::FarthestPoint as u32;
        const RANDOM: u32 = Scheme::Random as u32;
        const SUPPORT: u32 = Scheme::Support as u32;
        let budget = self.budget_views as usize;
        let plan = match self.scheme {
            ENSEMBLE => CorePlan::ensemble(budget),
            SUM => CorePlan::sum(budget),
            COVERAGE => CorePlan::single(Objective::Coverage, budget),
            GEOMETRY => CorePlan::single(Objective::Geometry, budget),
            DIVERSITY => CorePlan::single(Objective::Diversity, budget),
            TEXTURE => CorePlan::single(Objective::Texture, budget),
            FARTHEST_POINT => CorePlan::farthest_point(budget),
            RANDOM => CorePlan::random(budget),
            SUPPORT => CorePlan::support(budget),
            _ => return Err(Status::BadNumber),
        };
        let plan = plan
            .with_seed(self.seed)
            .with_movement_cost(self.movement_cost)
            .with_centre(Vec3::from_array(self.centre_m));
        let patience = u16::try_from(self.stop_patience).map_err(|_| Status::BadPlan)?;
        let stop = Stop { gain: self.stop_gain, patience };
        Ok(if patience > 0 { plan.with_stop(stop) } else { plan })
    }
}

impl Photo {
    /// The core's photo.
    ///
    /// # Safety
    ///
    /// `pixels` is null or leads to `length` bytes that do not change while the photo is in use.
    pub unsafe fn check<'a>(&self) -> Result<CorePhoto<'a>, Status> {
        const RGB565: u32 = Format::Rgb565 as u32;
        const RGB888: u32 = Format::Rgb888 as u32;
        const LUMA8: u32 = Format::Luma8 as u32;
        let pixels = match self.format {
            RGB565 => Pixels::Rgb565,
            RGB888 => Pixels::Rgb888,
            LUMA8 => Pixels::Luma8,
            _ => return Err(Status::BadNumber),
        };
        // SAFETY: the caller's promise is the same.
        let bytes = unsafe { bytes(self.pixels, self.length) }?;
        let photo = CorePhoto::new(Image::try_new(self.width, self.height, pixels, bytes)?);
        let Self { window_left, window_top, window_side, .. } = *self;
        if window_side == 0 {
            return Ok(photo);
        }
        Ok(photo.with_window(Window::try_new(window_left, window_top, window_side)?))
    }
}

impl From<CoreReason> for Reason {
    fn from(reason: CoreReason) -> Self {
        match reason {
            CoreReason::Start => Self::Start,
            CoreReason::Chance => Self::Chance,
            CoreReason::Farthest => Self::Farthest,
            CoreReason::Objective(Objective::Coverage) => Self::Coverage,
            CoreReason::Objective(Objective::Geometry) => Self::Geometry,
            CoreReason::Objective(Objective::Diversity) => Self::Diversity,
            CoreReason::Objective(Objective::Texture) => Self::Texture,
            CoreReason::AllObjectives => Self::AllObjectives,
            CoreReason::Support => Self::Support,
        }
    }
}
