//! Tracks the board through a film, and writes all that was found as JSON.
//!
//! `cargo run --release -p vantage-board --example track_film -- FILM.y4m FOCAL_PX OUT`
//!
//! `OUT/tracked.json` has the frames twice: `given` with the focal length named and the principal
//! point in the middle, `learned` by a tracker that knows nothing of the camera. `OUT/board.svg` is
//! the board to print. `tests/board/check_opencv.py` compares both with the truth and with OpenCV.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use vantage_board::{
    Board, Frame, Intrinsics, IntrinsicsSource, Page, Quality, Tracked, Tracker, quality,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [film, focal_px, out] = arguments.as_slice() else {
        return Err("name a film, its focal length in pixels, and a folder to write".into());
    };
    let Film { frames, width, height } = read_film(&std::fs::read(film)?)?;
    let board = Board::default();
    let (cx, cy) = (0.5 * width as f64, 0.5 * height as f64);
    let mut given = Tracker::new(board);
    given.set_intrinsics(Intrinsics { focal_px: focal_px.parse()?, cx, cy })?;
    let mut learned = Tracker::new(board);
    let (mut by_given, mut by_learned) = (Vec::new(), Vec::new());
    let mut milliseconds = Vec::new();
    for luma in &frames {
        let frame = Frame::try_new(luma, width, height)?;
        let quality = quality(&frame);
        let start = Instant::now();
        let tracked = given.track(&frame);
        milliseconds.push(1e3 * start.elapsed().as_secs_f64());
        by_given.push(json(&tracked, &quality));
        by_learned.push(json(&learned.track(&frame), &quality));
    }
    milliseconds.sort_by(f64::total_cmp);
    let median = milliseconds.get(milliseconds.len() / 2).copied().unwrap_or_default();
    let calibration = learned.calibration().map_or("null".to_owned(), |found| {
        format!(
            "{{\"focalPx\":{},\"cx\":{},\"cy\":{},\"rmsPx\":{},\"views\":{},\"focalSigmaPx\":{}}}",
            found.intrinsics.focal_px,
            found.intrinsics.cx,
            found.intrinsics.cy,
            found.rms_px,
            found.views,
            found.focal_sigma_px
        )
    });
    let text = format!(
        "{{\"calibration\":{calibration},\"medianMs\":{median},\n\"given\":[\n{}\n],\n\
         \"learned\":[\n{}\n]}}\n",
        by_given.join(",\n"),
        by_learned.join(",\n")
    );
    std::fs::create_dir_all(out)?;
    std::fs::write(Path::new(out).join("tracked.json"), text)?;
    std::fs::write(Path::new(out).join("board.svg"), board.svg(Page::A4)?)?;
    Ok(())
}

/// Frames of luma.
struct Film {
    frames: Vec<Vec<u8>>, // (frames, height, width)
    width: usize,
    height: usize,
}

/// The luma of a YUV4MPEG2 film of 4:2:0, spread from 16 to 235 to all of a byte, as a browser's
/// canvas gives it.
fn read_film(bytes: &[u8]) -> Result<Film, Box<dyn Error>> {
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or("the film has no header")?;
    let header = std::str::from_utf8(&bytes[..end])?;
    let field = |letter| {
        let mut words = header.split(' ').skip(1);
        words.find_map(|word| word.strip_prefix(letter)?.parse().ok())
    };
    let (Some(width), Some(height)) = (field('W'), field('H')) else {
        return Err("the film's header names no size".into());
    };
    let size: usize = width * height;
    let marker = b"FRAME\n".len();
    let frames = bytes[end + 1..].chunks_exact(marker + size * 3 / 2).map(|frame| {
        let spread = |&y: &u8| ((f32::from(y) - 16.0) * 255.0 / 219.0).round() as u8;
        frame[marker..marker + size].iter().map(spread).collect()
    });
    Ok(Film { frames: frames.collect(), width, height })
}

fn json(tracked: &Tracked, quality: &Quality) -> String {
    let mut text = String::from("{\"tags\":{");
    for (i, tag) in tracked.tags.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let _ = write!(text, "{comma}\"{}\":{:?}", tag.id, tag.corners.as_flattened());
    }
    text.push('}');
    if let Some(found) = &tracked.pose {
        let _ = write!(
            text,
            ",\"pose\":{:?},\"rmsPx\":{},\"isAmbiguous\":{}",
            found.pose.rows().as_flattened(),
            found.rms_px,
            found.is_ambiguous
        );
    }
    let calibrated = tracked.source == IntrinsicsSource::Calibrated;
    let Quality { sharpness, mean_luma, dark_share, bright_share } = quality;
    let _ = write!(
        text,
        ",\"focalPx\":{},\"isCalibrated\":{calibrated},\"sharpness\":{sharpness},\
         \"meanLuma\":{mean_luma},\"darkShare\":{dark_share},\"brightShare\":{bright_share}}}",
        tracked.intrinsics.focal_px
    );
    text
}
