//! The board: a grid of tags, what stands where.
//!
//! The board's frame is the world's: the origin in the middle of the board, **x** to the right,
//! **y** to the far edge, **z** up out of the paper, metres. Tags are numbered along the rows from
//! the upper left one, and stand upright towards +y.

use core::fmt;

use nalgebra::Point2;

use crate::family::{TAG_CELLS, TAGS};

/// The sizes of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardSpec {
    /// Tags in a row.
    pub columns: u32,
    /// Rows of tags.
    pub rows: u32,
    /// Side of a tag's black border, metres.
    pub tag_size_m: f64,
    /// White between two tags, metres.
    pub gap_m: f64,
    /// Number of the upper left tag.
    pub first_id: u32,
}

impl Default for BoardSpec {
    /// Fills A4 or Letter in landscape: 5 x 4 tags of 40 mm, 10 mm apart.
    fn default() -> Self {
        Self { columns: 5, rows: 4, tag_size_m: 0.04, gap_m: 0.01, first_id: 0 }
    }
}

/// Why sizes do not make a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoardError {
    /// No column or no row.
    NoTags,
    /// More tags than the family has.
    TooManyTags {
        /// First id plus columns times rows.
        needed: u64,
    },
    /// The tag's size is not from 5 mm to 1 m.
    BadTagSize {
        /// Metres.
        tag_size_m: f64,
    },
    /// The gap is smaller than a tag's cell, or larger than 1 m: tags need white around them.
    BadGap {
        /// Metres.
        gap_m: f64,
        /// Metres.
        least_m: f64,
    },
}

impl fmt::Display for BoardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTags => f.write_str("a board needs at least one column and one row of tags"),
            Self::TooManyTags { needed } => {
                write!(f, "the board needs tags up to number {needed} and there are {TAGS}")
            }
            Self::BadTagSize { tag_size_m } => {
                write!(f, "a tag's size must be from 0.005 to 1 m, not {tag_size_m}")
            }
            Self::BadGap { gap_m, least_m } => write!(
                f,
                "the gap between tags must be from an eighth of a tag, {least_m} m, to 1 m, not {gap_m}"
            ),
        }
    }
}

impl core::error::Error for BoardError {}

/// A board whose sizes have been checked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Board {
    spec: BoardSpec,
}

impl Board {
    /// A board of these sizes.
    pub fn try_new(spec: BoardSpec) -> Result<Self, BoardError> {
        let BoardSpec { columns, rows, tag_size_m, gap_m, first_id } = spec;
        if columns == 0 || rows == 0 {
            return Err(BoardError::NoTags);
        }
        let needed = u64::from(first_id) + u64::from(columns) * u64::from(rows);
        if needed > u64::from(TAGS) {
            return Err(BoardError::TooManyTags { needed });
        }
        // NaN fails the ranges.
        if !(0.005..=1.0).contains(&tag_size_m) {
            return Err(BoardError::BadTagSize { tag_size_m });
        }
        let least_m = tag_size_m / f64::from(TAG_CELLS);
        if !(least_m * (1.0 - 1e-9)..=1.0).contains(&gap_m) {
            return Err(BoardError::BadGap { gap_m, least_m });
        }
        Ok(Self { spec })
    }

    /// Its sizes.
    pub fn spec(&self) -> &BoardSpec {
        &self.spec
    }

    /// The tags it shows.
    pub fn ids(&self) -> core::ops::Range<u32> {
        let BoardSpec { columns, rows, first_id, .. } = self.spec;
        first_id..first_id + columns * rows
    }

    /// Its size across all tags in x and y, without the margin: metres.
    pub fn size_m(&self) -> [f64; 2] {
        let BoardSpec { columns, rows, tag_size_m, gap_m, .. } = self.spec;
        [columns, rows].map(|n| f64::from(n) * (tag_size_m + gap_m) - gap_m)
    }

    /// The corners of a tag on the board, clockwise from its upper left one, z = 0; `None` of a tag
    /// that the board does not show.
    pub fn corners(&self, id: u32) -> Option<[Point2<f64>; 4]> {
        let BoardSpec { columns, tag_size_m, gap_m, first_id, .. } = self.spec;
        if !self.ids().contains(&id) {
            return None;
        }
        let index = id - first_id;
        let [width, height] = self.size_m();
        let pitch = tag_size_m + gap_m;
        let left = f64::from(index % columns) * pitch - 0.5 * width;
        let top = 0.5 * height - f64::from(index / columns) * pitch;
        let (right, bottom) = (left + tag_size_m, top - tag_size_m);
        Some([[left, top], [right, top], [right, bottom], [left, bottom]].map(Point2::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_lie_around_the_middle_row_by_row_from_the_far_left() {
        let spec = BoardSpec { columns: 3, rows: 2, tag_size_m: 0.04, gap_m: 0.02, first_id: 7 };
        let board = Board::try_new(spec).unwrap();
        assert_eq!(board.ids(), 7..13);
        let near = |a: [Point2<f64>; 4], b: [[f64; 2]; 4]| {
            a.iter().zip(b).all(|(a, b)| (a - Point2::from(b)).norm() < 1e-12)
        };
        let far_left = [[-0.08, 0.05], [-0.04, 0.05], [-0.04, 0.01], [-0.08, 0.01]];
        assert!(near(board.corners(7).unwrap(), far_left));
        let near_right = [[0.04, -0.01], [0.08, -0.01], [0.08, -0.05], [0.04, -0.05]];
        assert!(near(board.corners(12).unwrap(), near_right));
        assert_eq!((board.corners(6), board.corners(13)), (None, None));
    }

    #[test]
    fn what_cannot_be_a_board_is_refused() {
        let with = |change: fn(&mut BoardSpec)| {
            let mut spec = BoardSpec::default();
            change(&mut spec);
            Board::try_new(spec)
        };
        assert!(with(|_| {}).is_ok());
        assert_eq!(with(|s| s.rows = 0), Err(BoardError::NoTags));
        assert_eq!(with(|s| s.first_id = 568), Err(BoardError::TooManyTags { needed: 588 }));
        assert!(with(|s| s.columns = u32::MAX).is_err());
        assert!(with(|s| s.tag_size_m = f64::NAN).is_err());
        assert!(matches!(with(|s| s.gap_m = 0.004), Err(BoardError::BadGap { .. })));
        assert!(with(|s| s.gap_m = 0.005).is_ok());
    }
}
