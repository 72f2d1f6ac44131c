//! What each candidate view shows of a mesh, by rendering it.

use rayon::prelude::*;
use vantage_core::objectives::{
    FLAT, FaceSet, Form, Reading, Sighting, hue_saturation, local_binary_pattern,
};
use vantage_core::{Camera, Pose};

use crate::render::{FaceImage, NO_FACE, Renderer};

/// The side of the square face-id images by default, pixels; recorded with every score.
pub const RESOLUTION: u32 = 256;

/// What one view shows; owns what a [`Sighting`] borrows.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    words: Vec<u32>,    // the faces seen, as a bit set
    textured: Vec<u32>, // for each of them, textured pixels over both channels
    textured_background: u32,
    pixels: u32,
}

impl Label {
    /// A label as it was stored; `textured` has an entry for each face that `words` spell.
    pub(crate) fn from_parts(
        words: Vec<u32>,
        textured: Vec<u32>,
        textured_background: u32,
        pixels: u32,
    ) -> Self {
        Self { words, textured, textured_background, pixels }
    }

    /// The faces seen: bit `i % 32` of word `i / 32`.
    pub(crate) fn words(&self) -> &[u32] {
        &self.words
    }

    /// The label as the objectives take it.
    pub fn sighting(&self) -> Sighting<'_> {
        Sighting {
            faces: FaceSet::new(&self.words),
            textured: &self.textured,
            textured_background: self.textured_background,
            pixels: self.pixels,
        }
    }
}

/// Renders the views and labels them, in parallel; `done` is called after each, in any order.
pub fn label_all(
    renderer: &Renderer,
    camera: &Camera,
    poses: &[Pose],
    face_count: usize,
    reading: &Reading,
    done: impl Fn() + Sync,
) -> Vec<Label> {
    let label = |pose| {
        let (faces, colours) = renderer.labelled(camera, pose);
        let label = label(&faces, colours.as_raw(), face_count, reading.form);
        done();
        label
    };
    poses.par_iter().map(label).collect()
}

/// The label of one view from its face ids and its RGBA picture, shape (height, width, 4).
pub fn label(image: &FaceImage, rgba: &[u8], face_count: usize, form: Form) -> Label {
    let channels: Vec<[u8; 2]> = rgba
        .chunks_exact(4)
        .map(|pixel| {
            // What shows through where there is no object is black in both readings.
            if pixel[3] == 0 { [0, 0] } else { hue_saturation([pixel[0], pixel[1], pixel[2]]) }
        })
        .collect();
    let (width, height) = (image.width as i32, image.height as i32);
    let place = |x: i32, y: i32| {
        let inside = x >= 0 && y >= 0 && x < width && y < height;
        inside.then(|| (y * width + x) as usize)
    };
    // The default reading looks at the object's pixels only, and neighbours off it do not count.
    let whole_picture = form == Form::Literal;
    let sample = |x: i32, y: i32, channel: usize| {
        let place = place(x, y)?;
        (whole_picture || image.faces[place] != NO_FACE).then(|| channels[place][channel])
    };

    let mut words = vec![0u32; FaceSet::words_for(face_count)];
    let mut pixels = 0;
    for &face in image.faces.iter().filter(|&&face| face != NO_FACE) {
        words[face as usize / 32] |= 1 << (face % 32);
        pixels += 1;
    }
    // The number of faces seen before each word, to find a face's place among those seen.
    let before: Vec<u32> = words
        .iter()
        .scan(0, |seen, word| {
            let before = *seen;
            *seen += word.count_ones();
            Some(before)
        })
        .collect();
    let seen = FaceSet::new(&words).len();
    let mut textured = vec![0u32; seen];
    let mut textured_background = 0;
    for y in 0..height {
        for x in 0..width {
            let face = image.faces[(y * width + x) as usize];
            if face == NO_FACE && !whole_picture {
                continue;
            }
            let codes =
                [0, 1].map(|channel| local_binary_pattern(x, y, |x, y| sample(x, y, channel)));
            let count = codes.iter().filter(|&&code| code != FLAT).count() as u32;
            if face == NO_FACE {
                textured_background += count;
            } else {
                let (word, bit) = (face as usize / 32, face % 32);
                let rank = before[word] + (words[word] & ((1 << bit) - 1)).count_ones();
                textured[rank as usize] += count;
            }
        }
    }
    if whole_picture {
        pixels = image.width * image.height;
    }
    Label { words, textured, textured_background, pixels }
}

/// The most that T's sum over views of `labels` can come to: see
/// [`Surface::try_new`](vantage_core::objectives::Surface::try_new).
pub fn texture_limit(labels: &[Label], face_count: usize, reading: &Reading) -> f32 {
    let mut most = vec![0.0f64; face_count];
    for label in labels.iter().filter(|label| label.pixels > 0) {
        let channels = 2.0 * f64::from(label.pixels);
        for (face, &textured) in FaceSet::new(&label.words).iter().zip(&label.textured) {
            most[face] = most[face].max(f64::from(textured) / channels);
        }
    }
    // Seen m times a face adds at most 1 + d + … + d^(m-1) < 1 / (1 - d) times its best.
    (most.iter().sum::<f64>() / (1.0 - f64::from(reading.texture_discount))) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 7 x 7 picture: a letter a face, a dot for none.
    fn picture(rows: [&str; 7]) -> FaceImage {
        let ids = rows.iter().flat_map(|row| row.bytes());
        let faces = ids.map(|b| if b == b'.' { NO_FACE } else { u32::from(b - b'a') }).collect();
        FaceImage { width: 7, height: 7, faces }
    }

    const TWO_FACES: [&str; 7] =
        [".......", ".aaaaa.", ".aaaaa.", ".aaabb.", ".abbbb.", ".bbbbb.", "......."];

    #[test]
    fn a_label_lists_the_faces_that_own_a_pixel() {
        let label = label(&picture(TWO_FACES), &[200; 7 * 7 * 4], 40, Form::Default);
        let sighting = label.sighting();
        assert!(sighting.faces.iter().eq([0, 1]));
        assert_eq!((sighting.pixels, sighting.textured), (25, [0, 0].as_slice()));
    }

    #[test]
    fn a_silhouette_is_no_texture_by_default() {
        let image = picture(TWO_FACES);
        let colour = |&face: &u32| if face == NO_FACE { [0, 0, 0, 0] } else { [200, 60, 20, 255] };
        let rgba: Vec<u8> = image.faces.iter().flat_map(colour).collect();
        let default = label(&image, &rgba, 2, Form::Default);
        assert_eq!(default.sighting().textured, [0, 0]);
        let literal = label(&image, &rgba, 2, Form::Literal);
        assert!(literal.sighting().textured.iter().sum::<u32>() > 0);
        assert_eq!(literal.sighting().pixels, 49);
    }

    #[test]
    fn textured_pixels_go_to_their_faces() {
        // Two faces with a gap between; the left one flat green, the right one checked with red.
        let (width, height) = (20, 8);
        let mut faces = Vec::new();
        let mut rgba = Vec::new();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            faces.push(match x {
                0..8 => 0,
                8..12 => NO_FACE,
                _ => 1,
            });
            let red = x >= 12 && (x + y) % 2 == 0;
            rgba.extend(if red { [220u8, 30, 30, 255] } else { [30, 220, 30, 255] });
        }
        let image = FaceImage { width, height, faces };
        let label = label(&image, &rgba, 2, Form::Default);
        let textured = label.sighting().textured;
        assert_eq!(textured[0], 0);
        // On the hue channel every green pixel whose right neighbour is on the face, at the least.
        assert!(textured[1] >= 20, "{textured:?}");
    }
}
