//! The page: one file, no scripts, nothing fetched.

use std::fmt::Write as _;
use std::io::Cursor;

use anyhow::Result;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType as PngFilter, PngEncoder};
use image::imageops::{self, FilterType};
use image::{DynamicImage, Rgba, RgbaImage};
use vantage_core::{Objective, Scores};

use super::svg::{escape, hex, number};
use super::trainers::openings;
use super::{Report, dome, palette, plot};
use crate::record::ViewRecord;
use crate::scheme;

const STYLE: &str = include_str!("page.css");

/// The whole page.
///
/// Every string of the report is escaped. Fails if the numbers of photos and views differ, or if a
/// photo cannot be encoded.
pub fn page(report: &Report<'_>) -> Result<String> {
    report.check()?;
    let plan = report.plan;
    let object = escape(&plan.object);
    let views = plan.views.len();
    let mut html = beginning(&format!("{object}: {views} planned views"));
    header(&mut html, report);
    gallery(&mut html, report)?;
    domes(&mut html, report);
    plots(&mut html, report)?;
    table(&mut html, report);
    opening(&mut html, report);
    html.push_str(END);
    Ok(html)
}

/// A page until its content; the title is escaped.
pub fn beginning(title: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta \
         name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta \
         name=\"color-scheme\" content=\"light dark\">\n<title>{title} · \
         Vantage</title>\n<style>\n{}{STYLE}</style>\n</head>\n<body>\n<main>\n",
        colours()
    )
}

/// What ends a page.
pub const END: &str = "</main>\n</body>\n</html>\n";

/// The palette as CSS, so that the colours stand in one place.
fn colours() -> String {
    let objectives = || Objective::ALL.map(Some).into_iter().chain([None]);
    let mut css = String::from(":root{");
    for objective in objectives() {
        let (class, colour) = (palette::class(objective), hex(palette::colour(objective)));
        let _ = write!(css, "--{class}:{colour};");
    }
    css.push_str("}\n");
    // Plots come with fixed colours; on a dark page the plan's curve is lifted as all text is.
    for objective in objectives() {
        let colour = hex(palette::colour(objective)).to_uppercase();
        for property in ["fill", "stroke"] {
            let _ = writeln!(css, ".plot [{property}=\"{colour}\"]{{{property}:var(--own-text)}}");
        }
    }
    css
}

fn header(html: &mut String, report: &Report<'_>) {
    let plan = report.plan;
    let views = plan.views.len();
    let _ = write!(
        html,
        "<header>\n<p class=\"kicker\">Vantage · view plan</p>\n<h1>{}</h1>\n<p \
         class=\"lead\">{views} {} chosen from {} candidates by <b>{}</b>: {}.</p>\n",
        escape(&plan.object),
        if views == 1 { "view" } else { "views" },
        plan.candidates,
        escape(&plan.scheme),
        escape(scheme::describe(&plan.scheme)),
    );
    let (scores, source) = match plan.exact {
        Some(scores) => (Some(scores), "exact, from the mesh"),
        None => (plan.views.last().map(|view| view.scores), "as the planner knew it"),
    };
    html.push_str("<ul class=\"figures\">\n");
    // By poses or by support, no objective chooses.
    let do_choose = plan.views.iter().any(|view| view.objective.is_some());
    for objective in Objective::ALL {
        let score = scores.map_or(f32::NAN, |scores| scores.get(objective));
        let share = if score.is_finite() { score.clamp(0.0, 1.0) } else { 0.0 };
        let chose = plan
            .views
            .iter()
            .filter(|view| palette::objective(view.objective.as_deref()) == Some(objective))
            .count();
        let _ = writeln!(
            html,
            "<li class=\"{0}\"><span class=\"name\"><b>{1}</b> {0}</span><span \
             class=\"value\">{2}</span><span class=\"bar\"><i \
             style=\"width:{3:.1}%\"></i></span><span class=\"chose\">{4}</span></li>",
            objective.name(),
            objective.letter(),
            number(score, 3),
            100.0 * share,
            match chose {
                0 if !do_choose => String::new(),
                0 => String::from("chose no view"),
                1 => String::from("chose 1 view"),
                count => format!("chose {count} views"),
            },
        );
    }
    let seconds = &plan.seconds;
    let pool = match (&plan.pool.file, plan.pool_seed) {
        (Some(file), _) => file.clone(),
        (None, Some(seed)) => format!("{} with seed {seed}", plan.pool.space),
        (None, None) => plan.pool.space.clone(),
    };
    let _ = write!(
        html,
        "</ul>\n<p class=\"small\">Scores before smoothing, {source}; 1 is the most there can be. \
         Reading {}, faces seen at {} pixels; seed {}, pool {}. Seconds: {} loading, {} labelling, \
         {} planning.</p>\n</header>\n",
        escape(&plan.scoring.reading),
        plan.scoring.resolution,
        plan.seed,
        escape(&pool),
        short(seconds.load),
        short(seconds.label),
        short(seconds.plan),
    );
}

fn gallery(html: &mut String, report: &Report<'_>) -> Result<()> {
    let count = report.plan.views.len();
    html.push_str(
        "<section aria-labelledby=\"views\">\n<h2 id=\"views\">The views, in order</h2>\n<ol \
         class=\"gallery\">\n",
    );
    for (index, (view, photo)) in report.plan.views.iter().zip(report.photos).enumerate() {
        let place = index + 1;
        let objective = palette::objective(view.objective.as_deref());
        let class = palette::class(objective);
        let thumbnail = Thumbnail::of(photo, count)?;
        let words = objective.map_or(view.reason.as_str(), |objective| objective.name());
        let _ = writeln!(
            html,
            "<li id=\"view-{place}\"><figure class=\"{class}\"><img src=\"{}\" width=\"{}\" \
             height=\"{}\" alt=\"View {place} of {count}, candidate {}: {}\"><figcaption><span \
             class=\"badge\">{place}</span><span class=\"words\">{}</span><span \
             class=\"gain\">{}</span></figcaption></figure></li>",
            thumbnail.url,
            thumbnail.width,
            thumbnail.height,
            view.index,
            escape(&view.reason),
            escape(words),
            gain(view),
        );
    }
    html.push_str(
        "</ol>\n<p class=\"small\">The number at the right is the gain expected when the view was \
         chosen.</p>\n</section>\n",
    );
    Ok(())
}

fn domes(html: &mut String, report: &Report<'_>) {
    let cameras = dome::Cameras::of_plan(report.plan, report.candidates);
    let _ = write!(
        html,
        "<section aria-labelledby=\"cameras\">\n<h2 id=\"cameras\">Where the cameras \
         stand</h2>\n<div class=\"pair\">\n<figure class=\"panel\">{}<figcaption>From above: the \
         object’s zenith in the middle, rings by elevation.</figcaption></figure>\n<figure \
         class=\"panel\">{}<figcaption>From the side, with the object’s unit \
         sphere.</figcaption></figure>\n</div>\n{}<p class=\"small\">Faint dots are the candidates \
         that were not chosen, the line is the shortest tour found. A number leads to its \
         photo.</p>\n</section>\n",
        dome::from_above(&cameras),
        dome::from_side(&cameras),
        objective_legend(report.plan.views.iter().map(|view| view.objective.as_deref())),
    );
}

/// What the colours of views mean, if any has one.
pub(super) fn objective_legend<'a>(mut chosen_by: impl Iterator<Item = Option<&'a str>>) -> String {
    if chosen_by.all(|objective| objective.is_none()) {
        return String::new();
    }
    let entries = Objective::ALL.map(|objective| {
        format!(
            "<li class=\"{0}\"><span class=\"badge\">{1}</span> {0}</li>",
            objective.name(),
            objective.letter()
        )
    });
    format!("<ul class=\"legend\" aria-label=\"Objectives\">{}</ul>\n", entries.concat())
}

fn plots(html: &mut String, report: &Report<'_>) -> Result<()> {
    if report.curves.is_empty() {
        return Ok(());
    }
    html.push_str(
        "<section aria-labelledby=\"scores\">\n<h2 id=\"scores\">Scores by number of \
         views</h2>\n<ul class=\"legend\" aria-label=\"Curves\">",
    );
    for (position, curve) in report.curves.iter().enumerate() {
        let swatch = match position {
            0 => String::from("<span class=\"swatch plan\"></span>"),
            _ => format!(
                "<span class=\"swatch\" style=\"border-color:{}\"></span>",
                hex(plot::baseline_colour(position - 1))
            ),
        };
        let _ = write!(html, "<li>{swatch} {}</li>", escape(&plot::label(position, curve)));
    }
    html.push_str("</ul>\n<div class=\"pair\">\n");
    for objective in Objective::ALL {
        let svg = plot::panel_svg(objective, report.curves)?;
        let _ = writeln!(
            html,
            "<figure class=\"panel plot {objective}\" role=\"img\" \
             aria-label=\"{}\">{svg}</figure>",
            escape(&summary(objective, report))
        );
    }
    html.push_str("</div>\n</section>\n");
    Ok(())
}

/// What a plot shows, in words: each curve's last score.
fn summary(objective: Objective, report: &Report<'_>) -> String {
    let ends = report.curves.iter().enumerate().filter_map(|(position, curve)| {
        let last = curve.scores.last()?;
        let views = curve.scores.len() - 1;
        let label = plot::label(position, curve);
        Some(format!("{label}, {} after {views} views", number(last.get(objective), 3)))
    });
    format!("Plot of {objective} by number of views. {}.", ends.collect::<Vec<_>>().join("; "))
}

fn table(html: &mut String, report: &Report<'_>) {
    html.push_str(
        "<section aria-labelledby=\"each\">\n<h2 id=\"each\">View by view</h2>\n<div \
         class=\"scroll\" role=\"region\" aria-labelledby=\"each\" \
         tabindex=\"0\">\n<table>\n<thead><tr><th scope=\"col\">View</th><th \
         scope=\"col\">Candidate</th><th scope=\"col\">Objective</th><th scope=\"col\">Why</th><th \
         scope=\"col\">Gain</th>",
    );
    for objective in Objective::ALL {
        let (name, letter) = (objective.name(), objective.letter());
        let _ = write!(html, "<th scope=\"col\"><abbr title=\"{name}\">{letter}</abbr></th>");
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for (index, view) in report.plan.views.iter().enumerate() {
        let place = index + 1;
        let objective = palette::objective(view.objective.as_deref());
        let class = palette::class(objective);
        let _ = writeln!(
            html,
            "<tr class=\"{class}\"><th scope=\"row\"><a class=\"badge\" \
             href=\"#view-{place}\">{place}</a></th><td class=\"n\">{}</td><td \
             class=\"objective\">{}</td><td class=\"why\">{}</td><td class=\"n\">{}</td>{}</tr>",
            view.index,
            objective.map_or("–", Objective::name),
            escape(&view.reason),
            gain(view),
            score_cells(&view.scores),
        );
    }
    if let Some(exact) = &report.plan.exact {
        let _ = write!(
            html,
            "</tbody>\n<tfoot><tr><th scope=\"row\" colspan=\"5\">Exact, whole plan</th>{}</tr>",
            score_cells(exact)
        );
        if let Some(smoothed) = &report.plan.smoothed {
            let _ = write!(
                html,
                "<tr><th scope=\"row\" colspan=\"5\">The same, smoothed</th>{}</tr>",
                score_cells(smoothed)
            );
        }
        html.push_str("</tfoot>\n");
    } else {
        html.push_str("</tbody>\n");
    }
    html.push_str(
        "</table>\n</div>\n<p class=\"small\">C, Q, D and T: coverage, geometry, diversity and \
         texture once the view is taken, before smoothing.</p>\n</section>\n",
    );
}

fn score_cells(scores: &Scores) -> String {
    let cell = |objective| format!("<td class=\"n\">{}</td>", number(scores.get(objective), 3));
    Objective::ALL.map(cell).concat()
}

fn opening(html: &mut String, report: &Report<'_>) {
    html.push_str(
        "<section aria-labelledby=\"open\">\n<h2 id=\"open\">Open it in a trainer</h2>\n<dl \
         class=\"commands\">\n",
    );
    for opening in openings(report.profile, report.folder) {
        let _ = write!(
            html,
            "<div><dt>{}</dt><dd><pre tabindex=\"0\"><code>{}</code></pre>",
            escape(opening.name),
            escape(&opening.command)
        );
        if !opening.note.is_empty() {
            let _ = write!(html, "<p class=\"small\">{}</p>", escape(opening.note));
        }
        html.push_str("</dd></div>\n");
    }
    let _ = write!(
        html,
        "</dl>\n</section>\n<section aria-labelledby=\"again\">\n<h2 id=\"again\">Make this plan \
         again</h2>\n<pre tabindex=\"0\"><code>{}</code></pre>\n<p class=\"small\">The same object, \
         seeds and version give the same views.</p>\n</section>\n",
        escape(report.command)
    );
}

fn gain(view: &ViewRecord) -> String {
    match view.gain {
        0.0 => String::from("–"), // the first views, and those by chance, expect nothing
        gain if gain > 0.0 => format!("+{}", number(gain, 3)),
        gain => number(gain, 3),
    }
}

/// Seconds with two digits that matter.
fn short(seconds: f64) -> String {
    if seconds < 10.0 { format!("{seconds:.2}") } else { format!("{seconds:.0}") }
}

/// A small picture as a `data:` URL.
pub(super) struct Thumbnail {
    pub url: String,
    pub width: u32,
    pub height: u32,
}

impl Thumbnail {
    /// The more photos a page has, the smaller they are: a page stays below some 4 MB.
    pub fn of(photo: &RgbaImage, photos: usize) -> Result<Self> {
        let most = match photos {
            0..=24 => 320,
            25..=60 => 224,
            _ => 144,
        };
        let scale = (most as f32 / photo.width().max(photo.height()) as f32).min(1.0);
        let side = |length: u32| ((length as f32 * scale).round() as u32).max(1);
        let (width, height) = (side(photo.width()), side(photo.height()));
        let small = resized(photo, width, height);
        let mut bytes = Vec::new();
        let opaque = small.pixels().all(|pixel| pixel.0[3] == 255);
        let kind = if opaque {
            let picture = DynamicImage::from(small).into_rgb8();
            picture.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, 86))?;
            "jpeg"
        } else {
            let encoder = PngEncoder::new_with_quality(
                Cursor::new(&mut bytes),
                CompressionType::Best,
                PngFilter::Adaptive,
            );
            small.write_with_encoder(encoder)?;
            "png"
        };
        let url = format!("data:image/{kind};base64,{}", BASE64_STANDARD.encode(&bytes));
        Ok(Self { url, width, height })
    }
}

/// Made smaller with premultiplied alpha: what stands under alpha 0 must not bleed into the edges.
fn resized(photo: &RgbaImage, width: u32, height: u32) -> RgbaImage {
    if photo.dimensions() == (width, height) {
        return photo.clone();
    }
    let mut premultiplied = photo.clone();
    for pixel in premultiplied.pixels_mut() {
        let [r, g, b, a] = pixel.0.map(u16::from);
        let times = |channel: u16| ((channel * a + 127) / 255) as u8;
        *pixel = Rgba([times(r), times(g), times(b), a as u8]);
    }
    let mut small = imageops::resize(&premultiplied, width, height, FilterType::CatmullRom);
    for pixel in small.pixels_mut() {
        let [r, g, b, a] = pixel.0.map(u16::from);
        let over = |channel: u16| (channel * 255).checked_div(a).unwrap_or(0).min(255) as u8;
        *pixel = Rgba([over(r), over(g), over(b), a as u8]);
    }
    small
}
