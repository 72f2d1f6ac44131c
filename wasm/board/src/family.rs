//! The tag family 36h11: what a tag looks like, and which tag a pattern of cells is.
//!
//! A tag is a square of 8 x 8 cells: a black border one cell wide around 6 x 6 cells of code. Any
//! two of its 587 code words, turned as one likes, differ in at least 11 cells (Olson, "AprilTag: a
//! robust and flexible visual fiducial system", ICRA 2011), so that two wrong cells can be mended.
//! A random pattern is taken for a tag once in 44,000. A tag stands upright as OpenCV's
//! `generateImageMarker` draws it; AprilTag's own pictures of this family are turned by 180 degrees.

use crate::codes::CODES;

/// Cells along a side of the code.
pub const CODE_CELLS: u32 = 6;

/// Cells along a tag's side, its black border included.
pub const TAG_CELLS: u32 = 8;

/// Wrong cells that are mended.
const MOST_WRONG_CELLS: u32 = 2;

/// Number of tags in the family.
pub const TAGS: u32 = CODES.len() as u32;

/// Whether a cell of an upright tag is white; row and column from the upper left, border included.
pub fn is_white(id: u32, row: u32, column: u32) -> bool {
    let inside = 1..=CODE_CELLS;
    if !inside.contains(&row) || !inside.contains(&column) {
        return false;
    }
    let bit = CODE_CELLS * CODE_CELLS - 1 - ((row - 1) * CODE_CELLS + column - 1);
    CODES.get(id as usize).is_some_and(|code| code >> bit & 1 == 1)
}

/// A pattern that was recognised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Match {
    /// Which tag.
    pub id: u32,
    /// Quarter turns anticlockwise that set the pattern upright, 0 to 3.
    pub turns: u32,
    /// Cells that were wrong.
    pub wrong_cells: u32,
}

/// The tag that a pattern of 6 x 6 cells shows, bits as in the table of codes.
pub fn recognise(pattern: u64) -> Option<Match> {
    let mut turned = pattern;
    for turns in 0..4 {
        for (id, code) in (0..).zip(&CODES) {
            let wrong_cells = (code ^ turned).count_ones();
            // Words are 11 cells apart: no other is as near.
            if wrong_cells <= MOST_WRONG_CELLS {
                return Some(Match { id, turns, wrong_cells });
            }
        }
        turned = turn(turned);
    }
    None
}

/// A pattern turned by a quarter anticlockwise.
fn turn(pattern: u64) -> u64 {
    let n = CODE_CELLS;
    let mut turned = 0;
    for row in 0..n {
        for column in 0..n {
            // What comes to (row, column) was at (column, n - 1 - row).
            let bit = pattern >> (n * n - 1 - (column * n + n - 1 - row)) & 1;
            turned = turned << 1 | bit;
        }
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tag_is_recognised_in_every_turn_with_two_cells_wrong() {
        for (id, &code) in (0..).zip(&CODES) {
            let mut pattern = code;
            for turns in [0, 3, 2, 1] {
                assert_eq!(recognise(pattern), Some(Match { id, turns, wrong_cells: 0 }));
                let spoilt = pattern ^ (1 << (id % 36)) ^ (1 << ((id + 7) % 36));
                assert_eq!(recognise(spoilt), Some(Match { id, turns, wrong_cells: 2 }));
                assert_eq!(recognise(spoilt ^ 1 << ((id + 20) % 36)), None);
                pattern = turn(pattern);
            }
        }
    }

    #[test]
    fn a_blank_square_is_no_tag() {
        assert_eq!(recognise(0), None);
        assert_eq!(recognise((1 << 36) - 1), None);
    }

    #[test]
    fn tag_0_looks_as_opencv_draws_it() {
        let picture: Vec<String> = (0..TAG_CELLS)
            .map(|row| {
                (0..TAG_CELLS).map(|c| if is_white(0, row, c) { '#' } else { '.' }).collect()
            })
            .collect();
        let drawn = [
            "........", "...#....", "..##.#..", "....#.#.", "....##..", ".#.###..", ".#.#.##.",
            "........",
        ];
        assert_eq!(picture, drawn);
    }
}
