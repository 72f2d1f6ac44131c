//! A flight along the test views: renders beside the truth, as an animated GIF or as numbered files.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use gif::{Encoder, Frame, Repeat};

use crate::page::beside;
use crate::photos::Picture;
use crate::runs::write_whole;

/// Hundredths of a second that a turn takes.
const TURN: usize = 600;

/// Most players slow down what is faster.
const LEAST_DELAY: usize = 2;

/// How carefully colours are chosen: from 1 to 30, from slow to fast.
const SPEED: i32 = 10;

/// Fails for a place that no flight can be written to.
pub fn check(path: &Path) -> Result<()> {
    let shown = path.display();
    if is_gif(path) {
        ensure!(!path.is_dir(), "{shown} is a folder: name a file that ends in .gif");
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let is_there = folder.is_none_or(Path::is_dir);
        ensure!(is_there, "there is no folder for {shown}: create it first");
        return Ok(());
    }
    ensure!(
        path.extension().is_none(),
        "{shown} is no GIF: name a file that ends in .gif, or a folder for numbered PNG files"
    );
    ensure!(!path.is_file(), "{shown} is a file: name one that ends in .gif, or a folder");
    let is_occupied = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
    ensure!(!is_occupied, "{shown} is not empty: name another folder");
    Ok(())
}

fn is_gif(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif"))
}

/// Writes renders on the left and the truth on the right, one view after the other: a GIF that turns
/// for ever, or a folder of `frame-000.png`, `frame-001.png` …
pub fn write(path: &Path, found: &[Picture], truth: &[Picture]) -> Result<()> {
    let pairs = found.iter().zip(truth);
    if is_gif(path) {
        let bytes = gif(found, truth)
            .with_context(|| format!("the flight {} cannot be encoded", path.display()))?;
        return write_whole(path, &bytes);
    }
    fs::create_dir_all(path).with_context(|| format!("cannot create {}", path.display()))?;
    for (index, (found, truth)) in pairs.enumerate() {
        let file = path.join(format!("frame-{index:03}.png"));
        let saved = beside(found, truth).save(&file);
        saved.with_context(|| format!("cannot write {}", file.display()))?;
    }
    Ok(())
}

fn gif(found: &[Picture], truth: &[Picture]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let (width, height) = match (found.first(), truth.first()) {
        (Some(found), Some(truth)) => beside(found, truth).dimensions(),
        _ => (1, 1),
    };
    let (width, height) = (u16::try_from(width)?, u16::try_from(height)?);
    {
        let mut encoder = Encoder::new(&mut bytes, width, height, &[])?;
        encoder.set_repeat(Repeat::Infinite)?;
        let delay = (TURN / found.len().max(1)).max(LEAST_DELAY);
        for (found, truth) in found.iter().zip(truth) {
            let picture = beside(found, truth);
            let mut frame = Frame::from_rgb_speed(width, height, picture.as_raw(), SPEED);
            frame.delay = u16::try_from(delay)?;
            encoder.write_frame(&frame)?;
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(colour: [f32; 3]) -> Picture {
        Picture { width: 9, pixels: vec![colour; 9 * 7] }
    }

    #[test]
    fn a_gif_shows_each_render_beside_its_truth() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("flight.gif");
        check(&path).unwrap();
        let found = [plain([1.0, 0.0, 0.0]), plain([0.0, 1.0, 0.0])];
        let truth = [plain([0.0, 0.0, 1.0]), plain([1.0; 3])];
        write(&path, &found, &truth).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(fs::File::open(&path).unwrap()).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (18, 7));
        assert_eq!(decoder.repeat(), Repeat::Infinite);
        for (found, truth) in found.iter().zip(&truth) {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, 300);
            let expected = [(0, found), (17, truth), (18 * 6 + 8, found)];
            for (place, picture) in expected {
                let shown = &frame.buffer[4 * place..][..3];
                for (level, part) in shown.iter().zip(picture.pixels[0]) {
                    assert!((f32::from(*level) - 255.0 * part).abs() < 8.0, "{shown:?}");
                }
            }
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
    }

    #[test]
    fn frames_are_numbered() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("flight");
        check(&path).unwrap();
        let two = |colour| [plain(colour), plain(colour)];
        write(&path, &two([0.5; 3]), &two([1.0; 3])).unwrap();
        let frame = image::open(path.join("frame-001.png")).unwrap().into_rgb8();
        assert_eq!((frame.get_pixel(0, 0).0, frame.get_pixel(17, 6).0), ([128; 3], [255; 3]));
        let says = |path: &Path| check(path).unwrap_err().to_string();
        assert!(says(&path).contains("not empty"));
        assert!(says(&home.path().join("flight.mp4")).contains("ends in .gif"));
        assert!(says(&home.path().join("none/flight.gif")).contains("no folder"));
        fs::create_dir(home.path().join("folder.gif")).unwrap();
        assert!(says(&home.path().join("folder.gif")).contains("is a folder"));
    }
}
