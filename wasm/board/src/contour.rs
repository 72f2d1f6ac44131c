//! Outlines of dark areas, followed along the cracks between pixels.
//!
//! A crack separates a dark pixel from a light one. Walking with the dark pixel on the right, each
//! crack is walked once, in one outline; outlines of areas run clockwise in the picture, those of
//! holes anticlockwise. Dark pixels that touch at a corner only belong to different areas. Points
//! of an outline are corners of pixels, so that a straight edge is not shifted by half a pixel, as
//! it is where one follows pixels.

use crate::binary::Binary;

/// A corner between pixels: x to the right, y down.
pub type Corner = [i32; 2];

/// Calls `use_outline` with the outline of every area of `least_area` pixels or more, holes filled.
///
/// Outlines of more than `most_corners` are left out, and those that the frame's edge cuts are
/// closed along that edge.
pub fn outlines(
    binary: &Binary,
    least_area: i64,
    most_corners: usize,
    walked: &mut Vec<bool>,
    mut use_outline: impl FnMut(&[Corner]),
) {
    let (dark, stride) = (binary.dark(), binary.stride());
    walked.clear();
    walked.resize(dark.len(), false);
    let mut outline = Vec::new();
    for start in 1..dark.len() {
        if !dark[start] || dark[start - 1] || walked[start] {
            continue;
        }
        outline.clear();
        let area = walk(dark, stride, start, walked, most_corners, &mut outline);
        if area >= least_area && outline.len() <= most_corners {
            use_outline(&outline);
        }
    }
}

/// Walks the outline that runs up the left side of `start`; gives the area that it encloses,
/// negative for a hole. Stops writing down corners one after `most_corners`.
fn walk(
    dark: &[bool],
    stride: usize,
    start: usize,
    walked: &mut [bool],
    most_corners: usize,
    outline: &mut Vec<Corner>,
) -> i64 {
    // The corner at (x, y) of the padded picture is the upper left one of pixel y * stride + x.
    // Headings: 0 up, 1 right, 2 down, 3 left. Steps in the array, and to the pixel on the right
    // hand behind a step's end, the last one passed.
    let steps = [-(stride as isize), 1, stride as isize, -1];
    let shift = [[0, -1], [1, 0], [0, 1], [-1, 0]];
    // From a corner to the pixels ahead on the left and on the right hand.
    let row = stride as isize;
    let ahead_left = [-row - 1, -row, 0, -1];
    let ahead_right = [-row, 0, -1, -row - 1];
    let at = |corner: isize, offset: isize| dark[(corner + offset) as usize];

    let first = start as isize + row; // the lower left corner of `start`
    let (mut corner, mut heading) = (first, 0usize);
    let (mut x, mut y) = ((first % row) as i32 - 1, (first / row) as i32 - 1);
    let mut area = 0i64;
    loop {
        if outline.len() <= most_corners {
            outline.push([x, y]);
        }
        if heading == 0 {
            walked[(corner - row) as usize] = true;
        }
        area += i64::from(x) * i64::from(shift[heading][1]);
        corner += steps[heading];
        x += shift[heading][0];
        y += shift[heading][1];
        heading = if !at(corner, ahead_right[heading]) {
            (heading + 1) % 4
        } else if !at(corner, ahead_left[heading]) {
            heading
        } else {
            (heading + 3) % 4
        };
        if corner == first && heading == 0 {
            return area;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use proptest::prelude::*;

    fn outlines_of(rows: &[&str]) -> Vec<(i64, usize)> {
        let luma: Vec<u8> =
            rows.iter().flat_map(|r| r.bytes().map(|c| if c == b'#' { 0 } else { 200 })).collect();
        let mut binary = Binary::default();
        binary.threshold(&Frame::try_new(&luma, rows[0].len(), rows.len()).unwrap());
        let mut found = Vec::new();
        outlines(&binary, i64::MIN, 1000, &mut Vec::new(), |outline| {
            let n = outline.len();
            let area = (0..n).map(|i| {
                let ([x, y], [u, v]) = (outline[i], outline[(i + 1) % n]);
                i64::from(x * v - u * y)
            });
            found.push((area.sum::<i64>() / 2, n));
        });
        found
    }

    #[test]
    fn an_area_and_its_hole_have_an_outline_each() {
        let rows = ["......", ".####.", ".#..#.", ".####.", "......"];
        assert_eq!(outlines_of(&rows), [(12, 14), (-2, 6)]);
    }

    #[test]
    fn areas_that_touch_at_a_corner_are_apart() {
        assert_eq!(outlines_of(&["##..", "##..", "..##", "..##"]), [(4, 8), (4, 8)]);
    }

    #[test]
    fn the_frame_s_edge_closes_an_outline() {
        assert_eq!(outlines_of(&["#.#", "###", "..."]), [(5, 12)]);
    }

    proptest! {
        /// Every crack lies on one outline: areas minus holes is the number of dark pixels.
        #[test]
        fn areas_add_up(cells in proptest::collection::vec(any::<bool>(), 63)) {
            let luma: Vec<u8> = cells.iter().map(|d| if *d { 0 } else { 200 }).collect();
            let mut binary = Binary::default();
            binary.threshold(&Frame::try_new(&luma, 9, 7).unwrap());
            let dark = binary.dark().iter().filter(|d| **d).count() as i64;
            let mut sum = 0;
            outlines(&binary, i64::MIN, 1000, &mut Vec::new(), |outline| {
                let n = outline.len();
                for i in 0..n {
                    let ([x, y], [u, v]) = (outline[i], outline[(i + 1) % n]);
                    sum += i64::from(x * v - u * y);
                }
            });
            prop_assert_eq!(sum, 2 * dark);
        }
    }
}
