//! Finds tags in a frame.
//!
//! Threshold, outlines of dark areas, quads, decoding: each step has its own module. Frames of more
//! than a million pixels are searched at half their size and measured at full size.
//!
//! Not handled: mirrored pictures (as a selfie preview shows them), tags whose border is partly
//! hidden or touches something dark in the picture, and in blurred frames tags whose cells are
//! narrower than the blur.

use nalgebra::Point2;

use crate::binary::Binary;
use crate::contour::{self, Corner};
use crate::decode;
use crate::frame::{Frame, HalfFrame};
use crate::quad::{self, Quad};

/// Above, frames are searched at half their size.
const MOST_PIXELS: usize = 1_000_000;

/// The smallest area of a tag in pixels, where it is searched.
const LEAST_AREA: i64 = 64;

/// A tag in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tag {
    /// Which tag of the family.
    pub id: u32,
    /// The corners of its black border in pixels, clockwise from the upright tag's upper left one.
    pub corners: [[f64; 2]; 4],
    /// Cells of its code that were wrong and mended, 0 to 2.
    pub wrong_cells: u32,
}

impl Tag {
    /// The area of its picture in pixels.
    pub fn area_px(&self) -> f64 {
        let [a, b, c, d] = self.corners.map(Point2::from);
        0.5 * (c - a).perp(&(d - b)).abs()
    }
}

/// Finds tags; keeps its memory from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Detector {
    half: HalfFrame,
    binary: Binary,
    walked: Vec<bool>,
}

impl Detector {
    /// The tags of family 36h11 in a frame, by id; of several with one id the largest.
    pub fn detect(&mut self, frame: &Frame<'_>) -> Vec<Tag> {
        let Self { half, binary, walked } = self;
        let is_large = frame.width() * frame.height() > MOST_PIXELS;
        let (searched, scale) = match is_large.then(|| half.shrink(frame)).flatten() {
            Some(half) => (half, 2.0),
            None => (*frame, 1.0),
        };
        binary.threshold(&searched);
        // A tag as large as the frame; anything longer is clutter.
        let most_corners = 4 * (searched.width() + searched.height());
        let mut tags: Vec<Tag> = Vec::new();
        contour::outlines(binary, LEAST_AREA, most_corners, walked, |outline| {
            tags.extend(read(frame, outline, scale));
        });
        tags.sort_by(|a, b| a.id.cmp(&b.id).then(b.area_px().total_cmp(&a.area_px())));
        tags.dedup_by_key(|tag| tag.id);
        tags
    }
}

/// The tag that an outline belongs to; `scale` is the frame's size over the searched one's.
fn read(frame: &Frame<'_>, outline: &[Corner], scale: f64) -> Option<Tag> {
    let coarse: Quad = quad::fit(outline)?.map(|corner| corner * scale);
    let fine = quad::refine(frame, &coarse, 1.0 + scale)?;
    let (found, upright) = decode::decode(frame, &fine)?;
    let corners = upright.map(|corner| [corner.x, corner.y]);
    Some(Tag { id: found.id, corners, wrong_cells: found.wrong_cells })
}
