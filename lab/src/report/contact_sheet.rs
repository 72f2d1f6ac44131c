//! One picture of the chosen photos in their order, each with its number, objective and gain.

mod text;

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage, RgbaImage};

use super::palette;
use super::svg::number;
use crate::record::{PlanRecord, ViewRecord};
use text::{HEIGHT as TEXT, draw as draw_text, width as text_width};

const PAGE: Rgb<u8> = Rgb([0xf4, 0xf2, 0xee]);
const CARD: Rgb<u8> = Rgb([0xff, 0xff, 0xff]);
const EDGE: Rgb<u8> = Rgb([0xdd, 0xda, 0xd3]);
/// Behind the object where the photo is transparent.
const BACKDROP: Rgb<u8> = Rgb([0xfa, 0xf9, 0xf7]);

// Lengths in pixels.
const PHOTO_WIDTH: u32 = 232;
const MARGIN: u32 = 28;
const GAP: u32 = 16;
const STRIPE: u32 = 4;
const PADDING: u32 = 10;
const CAPTION: u32 = 2 * TEXT + 3 * PADDING;
const HEADER: u32 = 2 * TEXT + 22;

/// Draws the sheet; photos beyond the views, or views beyond the photos, are left out.
///
/// `photos`: shape (views), all in proportion to the first. The sheet is near 3 to 2, at most 8
/// columns wide, on a light background.
pub fn draw(plan: &PlanRecord, photos: &[RgbaImage]) -> RgbImage {
    let count = photos.len().min(plan.views.len()) as u32;
    let (width, height) = photos.first().map_or((1, 1), RgbaImage::dimensions);
    let photo_height =
        (PHOTO_WIDTH * height.max(1) / width.max(1)).clamp(PHOTO_WIDTH / 4, PHOTO_WIDTH * 4);
    let card = (PHOTO_WIDTH, STRIPE + photo_height + CAPTION);
    let columns = columns(count, card);
    let rows = count.div_ceil(columns);
    let mut sheet = RgbImage::from_pixel(
        2 * MARGIN + columns * (card.0 + GAP) - GAP,
        2 * MARGIN + HEADER + rows * (card.1 + GAP),
        PAGE,
    );
    draw_header(&mut sheet, plan);
    for (index, (view, photo)) in (0..).zip(plan.views.iter().zip(photos)) {
        let left = MARGIN + index % columns * (card.0 + GAP);
        let top = MARGIN + HEADER + index / columns * (card.1 + GAP);
        fill(&mut sheet, (left - 1, top - 1), (card.0 + 2, card.1 + 2), EDGE);
        fill(&mut sheet, (left, top), card, CARD);
        let photo = on_backdrop(photo, PHOTO_WIDTH, photo_height);
        imageops::replace(&mut sheet, &photo, left.into(), (top + STRIPE).into());
        draw_caption(&mut sheet, (left, top), photo_height, index + 1, view);
    }
    sheet
}

/// As many columns, at most 8, as bring the sheet near to 3 to 2 and leave few empty places.
fn columns(count: u32, (width, height): (u32, u32)) -> u32 {
    let cost = |columns: u32| {
        let rows = count.div_ceil(columns);
        let proportion = (columns * width) as f32 / (rows * height).max(1) as f32;
        let empty = (rows * columns - count) as f32 / count.max(1) as f32;
        (proportion / 1.5).ln().abs() + 8.0 * empty
    };
    // At least two where there are two: a title needs some room.
    let most = count.clamp(1, 8);
    (most.min(2)..=most).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(1)
}

fn draw_header(sheet: &mut RgbImage, plan: &PlanRecord) {
    let room = sheet.width() - 2 * MARGIN;
    let views = if plan.views.len() == 1 { "view" } else { "views" };
    let title = shortened(&format!("{}: {} {views}", plan.object, plan.views.len()), room);
    let line = format!("{}, of {} candidates", plan.scheme, plan.candidates);
    draw_text(sheet, (MARGIN, MARGIN - 4), &title, Rgb(palette::INK));
    let top = MARGIN - 4 + TEXT + 6;
    draw_text(sheet, (MARGIN, top), &shortened(&line, room), Rgb(palette::MUTED));
}

fn draw_caption(
    sheet: &mut RgbImage,
    (left, top): (u32, u32),
    photo_height: u32,
    place: u32,
    view: &ViewRecord,
) {
    let objective = palette::objective(view.objective.as_deref());
    let colour = Rgb(palette::colour(objective));
    fill(sheet, (left, top), (PHOTO_WIDTH, STRIPE), colour);

    let place = place.to_string();
    let badge = (text_width(&place) + 12, TEXT + 8);
    let top = top + STRIPE + photo_height + PADDING - 2;
    let left = left + PADDING;
    fill(sheet, (left, top), badge, colour);
    draw_text(sheet, (left + 6, top + 4), &place, CARD);

    let right_of_badge = left + badge.0 + PADDING;
    let room = PHOTO_WIDTH - 3 * PADDING - badge.0;
    let words = match objective {
        Some(objective) => format!("{} {}", objective.letter(), objective.name()),
        None => view.reason.clone(),
    };
    draw_text(sheet, (right_of_badge, top + 4), &shortened(&words, room), colour);
    // The first views, and those by chance, expect nothing.
    if view.gain != 0.0 {
        let gain = shortened(&format!("gain {}", number(view.gain, 3)), PHOTO_WIDTH - 2 * PADDING);
        draw_text(sheet, (left, top + badge.1 + PADDING - 3), &gain, Rgb(palette::MUTED));
    }
}

/// The photo over the backdrop, at another size.
fn on_backdrop(photo: &RgbaImage, width: u32, height: u32) -> RgbImage {
    // Blended before it is made smaller: what stands under alpha 0 must not bleed into the edges.
    let blended = RgbImage::from_fn(photo.width(), photo.height(), |x, y| {
        let pixel = photo.get_pixel(x, y).0;
        let alpha = u32::from(pixel[3]);
        let blend = |channel: usize| {
            let over = u32::from(pixel[channel]) * alpha;
            let under = u32::from(BACKDROP.0[channel]) * (255 - alpha);
            ((over + under + 127) / 255) as u8
        };
        Rgb([blend(0), blend(1), blend(2)])
    });
    imageops::resize(&blended, width, height, FilterType::CatmullRom)
}

/// The words, cut to fit into that many pixels, with two dots where they were cut.
fn shortened(words: &str, room: u32) -> String {
    if text_width(words) <= room {
        return words.to_owned();
    }
    let letters = (room / text_width("x")).saturating_sub(2) as usize;
    let mut cut: String = words.chars().take(letters).collect();
    cut.truncate(cut.trim_end().len());
    cut + ".."
}

fn fill(sheet: &mut RgbImage, (left, top): (u32, u32), size: (u32, u32), colour: Rgb<u8>) {
    for y in top..(top + size.1).min(sheet.height()) {
        for x in left..(left + size.0).min(sheet.width()) {
            sheet.put_pixel(x, y, colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_full_where_they_can_be() {
        let card = (232, 232 + 66);
        let found = [0, 1, 2, 10, 12, 20, 30, 400].map(|count| columns(count, card));
        assert_eq!(found, [1, 1, 2, 5, 4, 5, 6, 8]);
    }

    #[test]
    fn transparent_pixels_show_the_backdrop() {
        let photo = RgbaImage::from_pixel(2, 2, image::Rgba([0, 0, 0, 0]));
        assert_eq!(*on_backdrop(&photo, 4, 4).get_pixel(1, 1), BACKDROP);
    }

    #[test]
    fn long_words_are_cut_to_their_room() {
        let cut = shortened("the gain of coverage", 10 * text_width("x"));
        assert_eq!(cut, "the gain..");
        assert_eq!(shortened("short", 1000), "short");
    }
}
