//! Letters for pictures: an 8 x 8 bitmap font, doubled and smoothed.
//!
//! Doubling alone leaves stairs; Scale2x (Mazzoleni 2001) rounds a corner where two neighbours agree
//! and the other two do not.

use font8x8::{BASIC_FONTS, LATIN_FONTS, UnicodeFonts};
use image::{Rgb, RgbImage};

/// Height of a line, and width of a letter, in pixels.
pub(super) const HEIGHT: u32 = 16;
/// Columns from one letter to the next: the font's letters leave their last column or two empty.
const ADVANCE: u32 = 14;

/// Width of a line of text in pixels.
pub(super) fn width(text: &str) -> u32 {
    text.chars().count() as u32 * ADVANCE
}

/// Writes a line with its upper left corner at (x, y); what falls outside is cut off.
pub(super) fn draw(picture: &mut RgbImage, (left, top): (u32, u32), text: &str, colour: Rgb<u8>) {
    for (position, character) in (0..).zip(text.chars()) {
        let glyph = glyph(character);
        for y in 0..HEIGHT {
            for x in 0..HEIGHT {
                let (to_x, to_y) = (left + position * ADVANCE + x, top + y);
                if is_set_doubled(&glyph, x, y) && to_x < picture.width() && to_y < picture.height()
                {
                    picture.put_pixel(to_x, to_y, colour);
                }
            }
        }
    }
}

/// Eight rows, the lowest bit leftmost; a question mark for letters the font lacks.
fn glyph(character: char) -> [u8; 8] {
    let known = BASIC_FONTS.get(character).or_else(|| LATIN_FONTS.get(character));
    known.or_else(|| BASIC_FONTS.get('?')).unwrap_or_default()
}

/// Whether a pixel of the doubled glyph is set; x and y in 0..16.
fn is_set_doubled(glyph: &[u8; 8], x: u32, y: u32) -> bool {
    let is_set = |x: i32, y: i32| {
        (0..8).contains(&x) && (0..8).contains(&y) && glyph[y as usize] >> x & 1 == 1
    };
    let (column, row) = ((x / 2) as i32, (y / 2) as i32);
    let (aside, down) =
        (if x.is_multiple_of(2) { -1 } else { 1 }, if y.is_multiple_of(2) { -1 } else { 1 });
    // The two neighbours of this quarter, and the two across.
    let (near_x, near_y) = (is_set(column + aside, row), is_set(column, row + down));
    let (far_x, far_y) = (is_set(column - aside, row), is_set(column, row - down));
    if near_x == near_y && near_x != far_y && near_y != far_x {
        near_x
    } else {
        is_set(column, row)
    }
}
