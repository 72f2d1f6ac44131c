//! Which tag a quad shows.
//!
//! Cells are sampled through the map from the tag's square to the picture. Two planes over the tag,
//! one through the black cells of its border, one through the white around it, say how bright
//! black and white are at each cell (as in AprilTag 2, Wang and Olson, IROS 2016), so that light
//! may fall off across a tag. A cell is white above the middle of the two.

use nalgebra::{Matrix3, Point2, Vector3};

use crate::family::{self, CODE_CELLS, Match, TAG_CELLS};
use crate::frame::Frame;
use crate::homography;
use crate::quad::Quad;

/// The least difference of white and black in luma.
const LEAST_CONTRAST: f64 = 10.0;

/// Cells of the border, of 28, that may look white.
const MOST_WHITE_IN_BORDER: u32 = 3;

/// Side of the tag with the ring of white cells around it.
const RING_CELLS: u32 = TAG_CELLS + 2;

/// Luma over the tag: a + b x + c y, for x and y from -1 to 1.
#[derive(Clone, Copy, Debug)]
struct Shade(Vector3<f64>);

impl Shade {
    fn at(&self, x: f64, y: f64) -> f64 {
        self.0.dot(&Vector3::new(1.0, x, y))
    }
}

/// Sums for a [`Shade`] through samples.
#[derive(Clone, Copy, Debug)]
struct ShadeSums {
    normal: Matrix3<f64>,
    right: Vector3<f64>,
}

impl ShadeSums {
    fn new() -> Self {
        Self { normal: Matrix3::zeros(), right: Vector3::zeros() }
    }

    fn add(&mut self, x: f64, y: f64, luma: f64) {
        let row = Vector3::new(1.0, x, y);
        self.normal += row * row.transpose();
        self.right += row * luma;
    }

    fn shade(&self) -> Option<Shade> {
        Some(Shade(self.normal.cholesky()?.solve(&self.right)))
    }
}

/// The tag in a quad, and its corners from the upright tag's upper left one, clockwise.
pub fn decode(frame: &Frame<'_>, quad: &Quad) -> Option<(Match, Quad)> {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Point2::from);
    let picture_from_tag = homography::fit(square.into_iter().zip(*quad))?;
    let mut cells = [[None; RING_CELLS as usize]; RING_CELLS as usize];
    let (mut black, mut white) = (ShadeSums::new(), ShadeSums::new());
    for (row, line) in (0..).zip(&mut cells) {
        for (column, cell) in (0..).zip(line) {
            let (x, y) = (place(column), place(row));
            *cell = cell_luma(frame, &picture_from_tag, x, y);
            let Some(luma) = *cell else { continue };
            match ring_of(row, column) {
                0 => white.add(x, y, luma),
                1 => black.add(x, y, luma),
                _ => {}
            }
        }
    }
    let (black, white) = (black.shade()?, white.shade()?);
    let corners_differ = square.iter().all(|p| {
        let (dark, light) = (black.at(p.x, p.y), white.at(p.x, p.y));
        light - dark >= LEAST_CONTRAST
    });
    if !corners_differ {
        return None;
    }
    let (mut pattern, mut white_in_border) = (0u64, 0);
    for (row, line) in (0..).zip(&cells) {
        for (column, cell) in (0..).zip(line) {
            let ring = ring_of(row, column);
            if ring == 0 {
                continue;
            }
            let (x, y) = (place(column), place(row));
            let is_white = (*cell)? > 0.5 * (black.at(x, y) + white.at(x, y));
            if ring == 1 {
                white_in_border += u32::from(is_white);
            } else {
                pattern = pattern << 1 | u64::from(is_white);
            }
        }
    }
    if white_in_border > MOST_WHITE_IN_BORDER {
        return None;
    }
    let found = family::recognise(pattern)?;
    let mut upright = *quad;
    // Set upright by quarter turns anticlockwise: the upper left corner comes from that many on.
    upright.rotate_left(found.turns as usize);
    Some((found, upright))
}

/// How many cells lie between a cell and the outside: 0 white around, 1 border, 2 or more code.
fn ring_of(row: u32, column: u32) -> u32 {
    let from_edge = |i: u32| i.min(RING_CELLS - 1 - i);
    from_edge(row).min(from_edge(column))
}

/// The middle of a cell on the tag's square from -1 to 1; the ring's cells lie outside.
fn place(cell: u32) -> f64 {
    (2.0 * f64::from(cell) + 1.0 - f64::from(RING_CELLS)) / f64::from(TAG_CELLS)
}

/// The mean of four samples around a cell's middle; `None` outside of the frame.
fn cell_luma(frame: &Frame<'_>, picture_from_tag: &Matrix3<f64>, x: f64, y: f64) -> Option<f64> {
    const ASIDE: f64 = 0.4 / TAG_CELLS as f64; // a fifth of a cell
    let (width, height) = (frame.width() as f64, frame.height() as f64);
    let mut sum = 0.0;
    for (dx, dy) in [(-ASIDE, -ASIDE), (ASIDE, -ASIDE), (-ASIDE, ASIDE), (ASIDE, ASIDE)] {
        let at = homography::apply(picture_from_tag, Point2::new(x + dx, y + dy));
        if !((0.0..=width).contains(&at.x) && (0.0..=height).contains(&at.y)) {
            return None;
        }
        sum += frame.sample(at.x, at.y);
    }
    Some(sum / 4.0)
}

const _: () = assert!(CODE_CELLS + 4 == RING_CELLS);

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: usize = 8;
    const MARGIN: usize = 16;
    const SIDE: usize = 8 * CELL + 2 * MARGIN;

    /// An upright tag of cells of 8 pixels; light falls off to the right. `spoilt` cells of its
    /// border's upper side are white.
    fn picture(id: u32, spoilt: u32) -> Vec<u8> {
        (0..SIDE * SIDE)
            .map(|i| {
                // Cells count from 1 inside the tag.
                let cell = |at: usize| ((at + CELL).saturating_sub(MARGIN) / CELL) as u32;
                let (row, column) = (cell(i / SIDE), cell(i % SIDE));
                let inside = (1..=TAG_CELLS).contains(&row) && (1..=TAG_CELLS).contains(&column);
                let is_white = !inside
                    || family::is_white(id, row - 1, column - 1)
                    || (row == 1 && column <= spoilt);
                let light = 1.0 - 0.6 * (i % SIDE) as f64 / SIDE as f64;
                (if is_white { 230.0 } else { 60.0 } * light) as u8
            })
            .collect()
    }

    fn read(luma: &[u8], turns: usize) -> Option<(Match, Quad)> {
        let (low, high) = (MARGIN as f64, (SIDE - MARGIN) as f64);
        let mut quad = [[low, low], [high, low], [high, high], [low, high]].map(Point2::from);
        quad.rotate_left(turns);
        decode(&Frame::try_new(luma, SIDE, SIDE).unwrap(), &quad)
    }

    #[test]
    fn the_first_corner_is_the_upright_tag_s_wherever_the_quad_starts() {
        // White at the dark end is darker than black at the bright end would allow.
        let luma = picture(137, 0);
        for turns in 0..4 {
            let (found, quad) = read(&luma, turns).unwrap();
            assert_eq!((found.id, found.wrong_cells), (137, 0));
            assert_eq!(quad[0], Point2::new(MARGIN as f64, MARGIN as f64));
        }
    }

    #[test]
    fn a_border_with_many_white_cells_is_none() {
        assert!(read(&picture(137, 3), 0).is_some());
        assert!(read(&picture(137, 5), 0).is_none());
    }

    #[test]
    fn a_plain_square_is_no_tag() {
        assert!(read(&[128; SIDE * SIDE], 0).is_none());
    }
}
