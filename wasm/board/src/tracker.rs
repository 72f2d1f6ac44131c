//! Follows the camera from frame to frame, and learns its intrinsics on the way.
//!
//! Until the views tell the focal length, one is assumed; distances are then off by as much as it
//! is. Views from new sides are kept (their corners, not their pictures), up to
//! [`MOST_VIEWS`]; with each new one the camera is calibrated again. A frame of another size
//! belongs to another camera: what was learned is forgotten.

use nalgebra::{Point2, Rotation3};
use vantage_core::Pose;

use crate::calibrate::{self, Calibration};
use crate::detector::{Detector, Tag};
use crate::frame::Frame;
use crate::pose::{self, Estimate, Intrinsics, Sighting};
use crate::spec::Board;

/// Focal length over a frame's longer side before it is known: a horizontal field of view of 64
/// degrees. The main cameras of phones have 60 to 70 degrees in video, webcams 55 to 80.
const ASSUMED_FOCAL: f64 = 0.8;

/// Views kept for calibration.
pub const MOST_VIEWS: usize = 24;

/// Views nearer to one another than this are one view: 8 degrees.
const NEW_VIEW_RAD: f64 = 0.14;

/// A view with fewer tags says too little of the camera.
const LEAST_TAGS_OF_VIEW: usize = 4;

/// Where intrinsics come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntrinsicsSource {
    /// Nothing is known: a usual field of view.
    Assumed,
    /// Views of the board agree.
    Calibrated,
    /// The caller said so.
    Given,
}

/// What a frame shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// The board's tags in the frame, by id.
    pub tags: Vec<Tag>,
    /// The camera's pose in the board's frame, if any tag was seen.
    pub pose: Option<TrackedPose>,
    /// The intrinsics the pose was computed with.
    pub intrinsics: Intrinsics,
    /// Where they come from.
    pub source: IntrinsicsSource,
}

/// A pose and how far to trust it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPose {
    /// `world_from_camera`; the world is the board's frame.
    pub pose: Pose,
    /// Root mean square of the corners' distances to where the pose puts them, pixels.
    pub rms_px: f64,
    /// Whether another pose fits nearly as well.
    pub is_ambiguous: bool,
    /// Tags that the pose explains.
    pub tags: usize,
}

/// A view kept for calibration.
#[derive(Clone, Debug)]
struct View {
    rotation: Rotation3<f64>,
    sightings: Vec<Sighting>,
}

/// Tracks one board with one camera.
#[derive(Clone, Debug, Default)]
pub struct Tracker {
    board: Board,
    detector: Detector,
    size: [usize; 2], // of the frames that the following belongs to
    given: Option<Intrinsics>,
    calibration: Option<Calibration>,
    views: Vec<View>,
}

/// The focal length is not positive, or a number is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadIntrinsics;

impl core::fmt::Display for BadIntrinsics {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("a focal length must be positive, and all intrinsics finite")
    }
}

impl core::error::Error for BadIntrinsics {}

impl Tracker {
    /// A tracker that knows nothing of the camera.
    pub fn new(board: Board) -> Self {
        Self { board, ..Self::default() }
    }

    /// The board.
    pub fn board(&self) -> &Board {
        &self.board
    }

    /// Uses these intrinsics instead of assumed or calibrated ones, whatever the frame's size.
    pub fn set_intrinsics(&mut self, intrinsics: Intrinsics) -> Result<(), BadIntrinsics> {
        let Intrinsics { focal_px, cx, cy } = intrinsics;
        if !(focal_px > 0.0 && focal_px.is_finite() && cx.is_finite() && cy.is_finite()) {
            return Err(BadIntrinsics);
        }
        self.given = Some(intrinsics);
        Ok(())
    }

    /// Finds the board's tags and the camera's pose.
    pub fn track(&mut self, frame: &Frame<'_>) -> Tracked {
        let size = [frame.width(), frame.height()];
        if self.size != size {
            self.size = size;
            self.calibration = None;
            self.views.clear();
        }
        let mut tags = self.detector.detect(frame);
        tags.retain(|tag| self.board.ids().contains(&tag.id));
        let sightings: Vec<Sighting> = tags.iter().filter_map(|tag| self.sighting(tag)).collect();
        let (mut intrinsics, mut source) = self.intrinsics();
        let mut estimate = pose::estimate(&sightings, &intrinsics);
        if let Some(found) = &estimate
            && self.keep(found)
            && let Some(calibration) = self.calibrate()
            && self.given.is_none()
        {
            (intrinsics, source) = (calibration.intrinsics, IntrinsicsSource::Calibrated);
            estimate = pose::estimate(&sightings, &intrinsics);
        }
        let pose = estimate.and_then(|found| {
            let rows = found.extrinsics.world_from_camera().map(|row| row.map(|v| v as f32));
            Some(TrackedPose {
                pose: Pose::try_from_rows(rows).ok()?,
                rms_px: found.rms_px,
                is_ambiguous: found.is_ambiguous,
                tags: found.inliers.len(),
            })
        });
        Tracked { tags, pose, intrinsics, source }
    }

    /// The camera as the views so far tell it, if they do; from now on poses are computed with it.
    pub fn calibrate(&mut self) -> Option<Calibration> {
        let [width, height] = self.size;
        let views: Vec<Vec<Sighting>> = self.views.iter().map(|v| v.sightings.clone()).collect();
        // Views that were of use before still are: a calibration is not lost with a new one.
        self.calibration = calibrate::calibrate(&views, width, height).or(self.calibration);
        self.calibration
    }

    /// The newest calibration, without computing one.
    pub fn calibration(&self) -> Option<Calibration> {
        self.calibration
    }

    fn sighting(&self, tag: &Tag) -> Option<Sighting> {
        let board = self.board.corners(tag.id)?;
        Some(Sighting { id: tag.id, board, pixels: tag.corners.map(Point2::from) })
    }

    fn intrinsics(&self) -> (Intrinsics, IntrinsicsSource) {
        if let Some(given) = self.given {
            return (given, IntrinsicsSource::Given);
        }
        if let Some(calibration) = &self.calibration {
            return (calibration.intrinsics, IntrinsicsSource::Calibrated);
        }
        let [width, height] = self.size.map(|side| side as f64);
        let focal_px = ASSUMED_FOCAL * width.max(height);
        let assumed = Intrinsics { focal_px, cx: 0.5 * width, cy: 0.5 * height };
        (assumed, IntrinsicsSource::Assumed)
    }

    /// Keeps a view that shows a new side, or an old side with more tags; says whether it did.
    fn keep(&mut self, found: &Estimate) -> bool {
        if found.inliers.len() < LEAST_TAGS_OF_VIEW || found.is_ambiguous {
            return false;
        }
        let rotation = found.extrinsics.rotation;
        let view = View { rotation, sightings: found.inliers.clone() };
        let nearest = (0..self.views.len())
            .map(|i| (pose::angle_between(&self.views[i].rotation, &rotation), i))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            Some((angle, i)) if angle < NEW_VIEW_RAD => {
                if self.views[i].sightings.len() >= view.sightings.len() {
                    return false;
                }
                self.views[i] = view;
            }
            _ if self.views.len() < MOST_VIEWS => self.views.push(view),
            _ => return false,
        }
        true
    }
}
