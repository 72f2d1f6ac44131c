//! The board as a drawing to print, true to size.

use core::fmt::{self, Write};

use crate::family::{self, TAG_CELLS};
use crate::spec::Board;

/// Paper; it is used in landscape or portrait, as the board fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Page {
    /// 297 x 210 mm.
    A4,
    /// 279.4 x 215.9 mm.
    Letter,
}

impl Page {
    /// Long and short side in millimetres.
    pub fn size_mm(self) -> [f64; 2] {
        match self {
            Self::A4 => [297.0, 210.0],
            Self::Letter => [279.4, 215.9],
        }
    }
}

/// The board does not fit the page with its margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoesNotFit {
    /// The board with its margin, width and height in millimetres.
    pub needed_mm: [f64; 2],
    /// The page.
    pub page_mm: [f64; 2],
}

impl fmt::Display for DoesNotFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([w, h], [long, short]) = (self.needed_mm, self.page_mm);
        write!(f, "the board needs {w:.0} x {h:.0} mm and the page has {long:.0} x {short:.0} mm")
    }
}

impl core::error::Error for DoesNotFit {}

/// White that printers leave at the paper's edges; title and scale bar lie just inside it.
const MARGIN_MM: f64 = 10.0;

/// The scale bar's length.
const BAR_MM: f64 = 100.0;

impl Board {
    /// An SVG of one page: the tags, a title that says how to print it, a bar of 100 mm to check.
    ///
    /// Its width, height and view box are in millimetres.
    pub fn svg(&self, page: Page) -> Result<String, DoesNotFit> {
        let board = self.size_m().map(|m| 1000.0 * m);
        let [long, short] = page.size_mm();
        let fits = |[w, h]: [f64; 2]| {
            board[0] + 2.0 * MARGIN_MM <= w + 1e-6 && board[1] + 2.0 * MARGIN_MM <= h + 1e-6
        };
        let [width, height] = [[long, short], [short, long]]
            .into_iter()
            .find(|size| fits(*size))
            .ok_or_else(|| DoesNotFit {
            needed_mm: board.map(|side| side + 2.0 * MARGIN_MM),
            page_mm: [long, short],
        })?;
        Ok(self.draw(width, height))
    }

    fn draw(&self, width: f64, height: f64) -> String {
        let spec = self.spec();
        let [board_width, board_height] = self.size_m().map(|m| 1000.0 * m);
        let (left, top) = (0.5 * (width - board_width), 0.5 * (height - board_height));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {width} {height}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <path fill=\"#000\" shape-rendering=\"crispEdges\" d=\""
        );
        let cell = 1000.0 * spec.tag_size_m / f64::from(TAG_CELLS);
        let pitch = 1000.0 * (spec.tag_size_m + spec.gap_m);
        for id in self.ids() {
            let index = id - spec.first_id;
            let x = left + f64::from(index % spec.columns) * pitch;
            let y = top + f64::from(index / spec.columns) * pitch;
            write_tag(&mut svg, id, x, y, cell);
        }
        svg.push_str("\"/>\n");
        let text = "font-family=\"sans-serif\" font-size=\"3\" fill=\"#000\"";
        let title = format!(
            "Vantage tag board, {} x {} tags of {} mm, ids {} to {}. Print at 100 %, lay it flat.",
            spec.columns,
            spec.rows,
            rounded(1000.0 * spec.tag_size_m),
            spec.first_id,
            spec.first_id + spec.columns * spec.rows - 1,
        );
        let base = top - 3.0;
        // Writing to a string does not fail.
        let _ = writeln!(svg, "<text x=\"{left}\" y=\"{base}\" {text}>{title}</text>");
        let (bar, bar_end) = (top + board_height + 3.5, left + BAR_MM);
        let _ = writeln!(
            svg,
            "<path stroke=\"#000\" stroke-width=\"0.3\" fill=\"none\" \
             d=\"M{left} {}v2m0 -1h{BAR_MM}m0 -1v2\"/>",
            bar - 1.0,
        );
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" {text}>this bar must measure 100 mm</text>\n</svg>",
            bar_end + 3.0,
            bar + 1.0,
        );
        svg
    }
}

/// Appends a tag's black cells to a path: each run of a row as one rectangle.
fn write_tag(path: &mut String, id: u32, x: f64, y: f64, cell: f64) {
    for row in 0..TAG_CELLS {
        let mut column = 0;
        while column < TAG_CELLS {
            let start = column;
            while column < TAG_CELLS && !family::is_white(id, row, column) {
                column += 1;
            }
            let run = column - start;
            if run > 0 {
                let (x, y) = (x + f64::from(start) * cell, y + f64::from(row) * cell);
                let (x, y, w, h) =
                    (rounded(x), rounded(y), rounded(f64::from(run) * cell), rounded(cell));
                let _ = write!(path, "M{x} {y}h{w}v{h}h-{w}z");
            }
            column += 1;
        }
    }
}

/// To a tenth of a micrometre: short numbers in the file.
fn rounded(mm: f64) -> f64 {
    (mm * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BoardSpec;

    #[test]
    fn the_default_board_fits_both_pages() {
        let board = Board::default();
        for (page, size) in
            [(Page::A4, "width=\"297mm\" height=\"210mm\""), (Page::Letter, "279.4")]
        {
            assert!(board.svg(page).unwrap().contains(size));
        }
    }

    #[test]
    fn a_tall_board_stands_and_a_large_one_is_refused() {
        let spec = BoardSpec { columns: 3, rows: 5, ..BoardSpec::default() };
        let tall = Board::try_new(spec).unwrap().svg(Page::A4).unwrap();
        assert!(tall.contains("viewBox=\"0 0 210 297\""));
        let spec = BoardSpec { columns: 6, ..BoardSpec::default() };
        let error = Board::try_new(spec).unwrap().svg(Page::A4).unwrap_err();
        assert_eq!(error.needed_mm.map(f64::round), [310.0, 210.0]);
    }
}
