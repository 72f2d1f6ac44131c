//! The printed tag board: `vantage-board` for JavaScript.

use js_sys::{Array, Float32Array};
use vantage_board::{
    Board, BoardSpec, Calibration, Frame, Intrinsics, IntrinsicsSource, Page, Tag, Tracked, Tracker,
};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::output::object;
use crate::{Refusal, input};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** A grid of AprilTags 36h11, numbered along the rows from the far left. The board's frame has its
 *  origin in the middle, x to the right, y to the far edge, z up; metres. What is left out is as
 *  in the usual board: 5 x 4 tags of 40 mm, 10 mm apart, from number 0. */
export type BoardSpec = {
  columns?: number; rows?: number; tagSizeM?: number; gapM?: number; firstId?: number;
};

/** Where intrinsics come from: a usual field of view, views of the board, the caller. */
export type IntrinsicsSource = "assumed" | "calibrated" | "given";

/** What a frame shows. `tags`: corners in pixels, 8 numbers, clockwise from the upright tag's upper
 *  left one. `pose`: rows of world_from_camera, in the board's frame; there with `rmsPx` (root mean
 *  square of the corners' reprojection errors), `tagsUsed` and `isAmbiguous` (another pose fits
 *  nearly as well), if any tag was seen. */
export type TrackResult = {
  tags: { id: number; corners: Float32Array }[];
  pose?: Float32Array; rmsPx?: number; isAmbiguous?: boolean; tagsUsed?: number;
  focalPx: number; cx: number; cy: number; intrinsicsSource: IntrinsicsSource;
};

/** What the views of the board tell of the camera; pixels. `focalSigmaPx` is a standard deviation. */
export type Calibration = {
  focalPx: number; cx: number; cy: number; rmsPx: number; views: number; focalSigmaPx: number;
};

/** How a frame looks. `sharpness`: variance of the Laplacian over variance; compare it with other
 *  frames of the same scene. `darkShare`, `brightShare`: shares of black and of blown-out pixels. */
export type FrameQuality = {
  sharpness: number; meanLuma: number; darkShare: number; brightShare: number;
};
"#;

/// Follows a camera by a printed board, and learns its intrinsics on the way.
#[wasm_bindgen]
#[derive(Debug)]
pub struct BoardTracker {
    tracker: Tracker,
}

#[wasm_bindgen]
impl BoardTracker {
    /// A tracker of a board, with a camera that nothing is known of.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        #[wasm_bindgen(unchecked_optional_param_type = "BoardSpec")] spec: &JsValue,
    ) -> Result<BoardTracker, Refusal> {
        let board = Board::try_new(read_spec(spec)?).map_err(refused)?;
        Ok(Self { tracker: Tracker::new(board) })
    }

    /// Finds the board in a frame: one byte of luma for each pixel, row by row.
    ///
    /// Frames of another size than the ones before make it forget the calibration.
    #[wasm_bindgen(unchecked_return_type = "TrackResult")]
    pub fn track(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Uint8Array | Uint8ClampedArray")] luma: &JsValue,
        width: f64,
        height: f64,
    ) -> Result<JsValue, Refusal> {
        let luma = input::bytes("luma", luma)?;
        let frame = read_frame(&luma, width, height)?;
        Ok(write_tracked(&self.tracker.track(&frame)))
    }

    /// What the views so far tell of the camera; undefined while they do not tell it. `track` asks
    /// by itself with every new side of the board.
    #[wasm_bindgen(unchecked_return_type = "Calibration | undefined")]
    pub fn calibrate(&mut self) -> JsValue {
        self.tracker.calibrate().map_or(JsValue::UNDEFINED, |found| write_calibration(&found))
    }

    /// Uses these intrinsics from now on; pixels of the frames that will come.
    #[wasm_bindgen(js_name = setIntrinsics)]
    pub fn set_intrinsics(
        &mut self,
        #[wasm_bindgen(js_name = focalPx)] focal_px: f64,
        cx: f64,
        cy: f64,
    ) -> Result<(), Refusal> {
        self.tracker.set_intrinsics(Intrinsics { focal_px, cx, cy }).map_err(refused)
    }

    /// The board to print, true to size, with a bar of 100 mm to check.
    pub fn svg(
        &self,
        #[wasm_bindgen(unchecked_param_type = "\"a4\" | \"letter\"")] page: &JsValue,
    ) -> Result<String, Refusal> {
        let page = match page.as_string().as_deref() {
            Some("a4") => Page::A4,
            Some("letter") => Page::Letter,
            _ => {
                let message = "`page` must be \"a4\" or \"letter\"".to_owned();
                return Err(Refusal::bad_argument(message));
            }
        };
        self.tracker.board().svg(page).map_err(refused)
    }
}

/// Whether a frame is sharp and well lit; one byte of luma for each pixel, row by row.
#[wasm_bindgen(js_name = frameQuality, unchecked_return_type = "FrameQuality")]
pub fn frame_quality(
    #[wasm_bindgen(unchecked_param_type = "Uint8Array | Uint8ClampedArray")] luma: &JsValue,
    width: f64,
    height: f64,
) -> Result<JsValue, Refusal> {
    let luma = input::bytes("luma", luma)?;
    let quality = vantage_board::quality(&read_frame(&luma, width, height)?);
    Ok(object([
        ("sharpness", quality.sharpness.into()),
        ("meanLuma", quality.mean_luma.into()),
        ("darkShare", quality.dark_share.into()),
        ("brightShare", quality.bright_share.into()),
    ]))
}

fn refused(error: impl core::error::Error) -> Refusal {
    Refusal::bad_argument(error.to_string())
}

fn read_spec(spec: &JsValue) -> Result<BoardSpec, Refusal> {
    let usual = BoardSpec::default();
    if spec.is_undefined() {
        return Ok(usual);
    }
    if !spec.is_object() {
        return Err(Refusal::bad_argument("a board's sizes must be an object".to_owned()));
    }
    let number = |name, usual: f64| -> Result<f64, Refusal> {
        Ok(input::optional_number(spec, name)?.unwrap_or(usual))
    };
    // Whether there are as many tags is the board's to say.
    let whole = |name, usual: u32| -> Result<u32, Refusal> {
        Ok(input::whole(name, number(name, usual.into())?, 1 << 16)? as u32)
    };
    Ok(BoardSpec {
        columns: whole("columns", usual.columns)?,
        rows: whole("rows", usual.rows)?,
        tag_size_m: number("tagSizeM", usual.tag_size_m)?,
        gap_m: number("gapM", usual.gap_m)?,
        first_id: whole("firstId", usual.first_id)?,
    })
}

fn read_frame(luma: &[u8], width: f64, height: f64) -> Result<Frame<'_>, Refusal> {
    let side = |name, value| input::whole(name, value, vantage_board::MAX_SIDE as u32);
    Frame::try_new(luma, side("width", width)?, side("height", height)?).map_err(refused)
}

fn write_tracked(tracked: &Tracked) -> JsValue {
    let tags: Array = tracked.tags.iter().map(write_tag).collect();
    let pose = tracked.pose.as_ref();
    let or_undefined = |value: Option<JsValue>| value.unwrap_or(JsValue::UNDEFINED);
    let numbers = pose.map(|found| Float32Array::from(input::numbers(&found.pose).as_slice()));
    object([
        ("tags", tags.into()),
        ("pose", or_undefined(numbers.map(Into::into))),
        ("rmsPx", or_undefined(pose.map(|found| found.rms_px.into()))),
        ("isAmbiguous", or_undefined(pose.map(|found| found.is_ambiguous.into()))),
        ("tagsUsed", or_undefined(pose.map(|found| (found.tags as u32).into()))),
        ("focalPx", tracked.intrinsics.focal_px.into()),
        ("cx", tracked.intrinsics.cx.into()),
        ("cy", tracked.intrinsics.cy.into()),
        ("intrinsicsSource", source_name(tracked.source).into()),
    ])
}

fn write_tag(tag: &Tag) -> JsValue {
    let corners: Vec<f32> = tag.corners.as_flattened().iter().map(|&v| v as f32).collect();
    object([("id", tag.id.into()), ("corners", Float32Array::from(corners.as_slice()).into())])
}

fn write_calibration(found: &Calibration) -> JsValue {
    object([
        ("focalPx", found.intrinsics.focal_px.into()),
        ("cx", found.intrinsics.cx.into()),
        ("cy", found.intrinsics.cy.into()),
        ("rmsPx", found.rms_px.into()),
        ("views", (found.views as u32).into()),
        ("focalSigmaPx", found.focal_sigma_px.into()),
    ])
}

fn source_name(source: IntrinsicsSource) -> &'static str {
    match source {
        IntrinsicsSource::Assumed => "assumed",
        IntrinsicsSource::Calibrated => "calibrated",
        IntrinsicsSource::Given => "given",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_checked() {
        assert!(read_frame(&[0; 6], 3.0, 2.0).is_ok());
        for (width, height) in [(3.0, 3.0), (0.0, 2.0), (2.5, 2.0), (f64::NAN, 2.0), (1e9, 2.0)] {
            let error = read_frame(&[0; 6], width, height).unwrap_err();
            assert_eq!(error.code(), "bad-argument", "{width} x {height}");
        }
    }
}
