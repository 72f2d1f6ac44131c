//! The page of a capture in progress: the photos so far, and where to stand next.

use std::fmt::Write as _;

use anyhow::Result;
use image::DynamicImage;
use vantage_core::Vec3;

use super::dome::{self, Cameras, Shown};
use super::html::{self, Thumbnail};
use super::palette;
use super::svg::{escape, number};
use crate::photos::Capture;
use crate::photos::words::towards;
use crate::record::PhotosRecord;
use crate::scheme;

/// The whole page; every string is escaped.
///
/// `candidates`: directions from the object, the plan's coordinates, shape (candidates).
pub fn page(record: &PhotosRecord, capture: &Capture, candidates: &[Vec3]) -> Result<String> {
    let name = escape(&record.capture);
    let mut page = html::beginning(&format!("{name}: next views"));
    let skipped = match record.skipped.len() {
        0 => String::new(),
        count => format!(", {count} skipped"),
    };
    let _ = write!(
        page,
        "<header>\n<p class=\"kicker\">Vantage · capture in progress</p>\n<h1>{name}</h1>\n<p \
         class=\"lead\">{} photos{skipped}; the next view of {} candidates by <b>{}</b>: \
         {}.</p>\n</header>\n",
        record.photos.len(),
        record.candidates,
        escape(&record.scheme),
        escape(scheme::describe(&record.scheme)),
    );
    next(&mut page, record);
    cameras(&mut page, record, capture, candidates);
    gallery(&mut page, capture)?;
    left_out(&mut page, record);
    page.push_str(html::END);
    Ok(page)
}

fn next(page: &mut String, record: &PhotosRecord) {
    page.push_str(
        "<section aria-labelledby=\"next\">\n<h2 id=\"next\">Where to stand next</h2>\n<div \
         class=\"scroll\" role=\"region\" aria-labelledby=\"next\" \
         tabindex=\"0\">\n<table>\n<thead><tr><th scope=\"col\">View</th><th \
         scope=\"col\">Where</th><th scope=\"col\">Why</th><th scope=\"col\">Azimuth</th><th \
         scope=\"col\">Elevation</th><th scope=\"col\">Gain</th></tr></thead>\n<tbody>\n",
    );
    for (place, next) in record.next.iter().enumerate() {
        let class = palette::class(palette::objective(next.objective.as_deref()));
        let _ = writeln!(
            page,
            "<tr class=\"{class}\" id=\"view-{0}\"><th scope=\"row\"><span \
             class=\"badge\">{0}</span></th><td>{1}</td><td class=\"why\">{2}</td><td \
             class=\"n\">{3}°</td><td class=\"n\">{4}°</td><td class=\"n\">{5}</td></tr>",
            place + 1,
            escape(&next.place),
            escape(&next.reason),
            number(next.azimuth, 0),
            number(next.elevation, 0),
            number(next.gain, 3),
        );
    }
    page.push_str(
        "</tbody>\n</table>\n</div>\n<p class=\"small\">The first is the next view. The others are \
         for when it cannot be reached: each the best among those well apart from the ones before. \
         Left and right are those of someone who faces the object.</p>\n</section>\n",
    );
}

fn cameras(page: &mut String, record: &PhotosRecord, capture: &Capture, candidates: &[Vec3]) {
    let taken: Vec<Vec3> = capture.photos.iter().map(|photo| photo.direction).collect();
    let shown = |next| -> Shown<'_> {
        let next: &crate::record::NextRecord = next;
        Shown {
            position: towards(next.azimuth, next.elevation),
            objective: next.objective.as_deref(),
            reason: &next.reason,
        }
    };
    let views = record.next.iter().map(shown).collect();
    let cameras = Cameras { object: &record.capture, candidates, taken: &taken, views, tour: &[] };
    let _ = write!(
        page,
        "<section aria-labelledby=\"cameras\">\n<h2 id=\"cameras\">The cameras around the \
         object</h2>\n<div class=\"pair\">\n<figure class=\"panel\">{}<figcaption>From above: the \
         object’s zenith in the middle, rings by elevation.</figcaption></figure>\n<figure \
         class=\"panel\">{}<figcaption>From the side; all cameras are brought to one \
         distance.</figcaption></figure>\n</div>\n{}<p class=\"small\">Rings are photos, faint dots \
         candidates, numbers the views named above.</p>\n</section>\n",
        dome::from_above(&cameras),
        dome::from_side(&cameras),
        html::objective_legend(record.next.iter().map(|next| next.objective.as_deref())),
    );
}

fn gallery(page: &mut String, capture: &Capture) -> Result<()> {
    page.push_str(
        "<section aria-labelledby=\"photos\">\n<h2 id=\"photos\">The photos, as the planner sees \
         them</h2>\n<ol class=\"gallery\">\n",
    );
    for photo in &capture.photos {
        let picture = DynamicImage::from(photo.picture.clone()).into_rgba8();
        let thumbnail = Thumbnail::of(&picture, capture.photos.len())?;
        let _ = writeln!(
            page,
            "<li><figure class=\"plain\"><img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"Photo \
             {number}\"><figcaption><span class=\"badge\">{number}</span><span \
             class=\"words\">{}</span></figcaption></figure></li>",
            thumbnail.url,
            thumbnail.width,
            thumbnail.height,
            escape(&photo.file),
            number = photo.number,
        );
    }
    page.push_str(
        "</ol>\n<p class=\"small\">Each is turned upright and towards the object’s middle and cut to \
         its sphere; beyond a photo’s edges its last pixels are repeated.</p>\n</section>\n",
    );
    Ok(())
}

fn left_out(page: &mut String, record: &PhotosRecord) {
    if record.skipped.is_empty() && record.notes.is_empty() {
        return;
    }
    page.push_str(
        "<section aria-labelledby=\"notes\">\n<h2 id=\"notes\">Left out and noted</h2>\n<ul>\n",
    );
    for skipped in &record.skipped {
        let (file, why) = (escape(&skipped.file_path), escape(&skipped.why));
        let _ = writeln!(page, "<li>Photo {}, {file}: {why}</li>", skipped.number);
    }
    for note in &record.notes {
        let _ = writeln!(page, "<li>Note: {}</li>", escape(note));
    }
    page.push_str("</ul>\n</section>\n");
}
