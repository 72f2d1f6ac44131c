//! What a sweep looks like: plots, renders beside the truth, a page.

use std::fmt::Write as _;
use std::fs;

use anyhow::{Context, Result, anyhow};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use image::RgbImage;
use plotters::prelude::*;
use vantage_lab::report::html::{END, beginning};
use vantage_lab::report::svg::escape;

use crate::photos::Picture;
use crate::plans;
use crate::runs::{Run, Settings, Store};
use crate::summary::{self, Summary};

/// After Okabe and Ito (2008).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x5f, 0x6b, 0x7c),
    RGBColor(0x00, 0x6b, 0xa8),
    RGBColor(0xbd, 0x4f, 0x00),
    RGBColor(0x00, 0x7d, 0x5c),
    RGBColor(0xa2, 0x40, 0x87),
    RGBColor(0xb4, 0x7b, 0x00),
    RGBColor(0x3f, 0x9f, 0x9b),
    RGBColor(0x7a, 0x5c, 0x3e),
];
const INK: RGBColor = RGBColor(0x1b, 0x24, 0x30);
const GRID: RGBColor = RGBColor(0xe2, 0xe4, 0xe8);
const FONT: &str = "sans-serif";

/// Two pictures of one size side by side.
pub fn beside(left: &Picture, right: &Picture) -> RgbImage {
    let (left, right) = (left.to_image(), right.to_image());
    let (width, height) = left.dimensions();
    RgbImage::from_fn(2 * width, height, |x, y| {
        if x < width { *left.get_pixel(x, y) } else { *right.get_pixel(x - width, y) }
    })
}

/// An SVG file on white, 900 x 380 pixels: PSNR against budget with the intervals as bands on the left;
/// on the right the differences from a baseline, a dot an object, the mean a line.
pub fn psnr_svg(summary: &Summary, schemes: &[String], baseline: &str) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (900, 380)).into_drawing_area();
        draw(&root, summary, schemes, baseline)
            .map_err(|error| anyhow!("the plot cannot be drawn: {error}"))?;
    }
    Ok(svg)
}

type Failure = Box<dyn std::error::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw(
    root: &Area<'_>,
    summary: &Summary,
    schemes: &[String],
    baseline: &str,
) -> Result<(), Failure> {
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(450);
    draw_curves(&left, summary, schemes)?;
    draw_differences(&right, summary, schemes, baseline)?;
    root.present()?;
    Ok(())
}

/// The least range that holds all numbers, a little wider; a range around 0 for none.
fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let ends = values.fold(None, |ends: Option<(f64, f64)>, value| {
        Some(ends.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
    });
    let (low, high) = ends.unwrap_or((-1.0, 1.0));
    let more = (0.06 * (high - low)).max(0.1);
    low - more..high + more
}

/// The budgets of a summary, ascending; they stand at 0, 1, 2 … on both axes.
fn budgets_of(summary: &Summary) -> Vec<usize> {
    let mut budgets: Vec<usize> = summary.rows.iter().map(|row| row.budget).collect();
    budgets.sort_unstable();
    budgets.dedup();
    budgets
}

type Panel<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn panel<'a, 'b>(
    area: &Area<'b>,
    title: &str,
    budgets: &[usize],
    values: std::ops::Range<f64>,
) -> Result<Panel<'a, 'b>, Failure> {
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .caption(title, (FONT, 15).into_font().color(&INK))
        .x_label_area_size(34)
        .y_label_area_size(44)
        .build_cartesian_2d(-0.5..budgets.len() as f64 - 0.5, values)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .x_desc("views")
        .x_labels(2 * budgets.len())
        .x_label_formatter(&|place| {
            let is_whole = (place - place.round()).abs() < 0.1;
            let nearest = budgets.get(place.round().max(0.0) as usize).filter(|_| is_whole);
            nearest.map_or(String::new(), usize::to_string)
        })
        .y_label_formatter(&|value| format!("{value:.1}"))
        .draw()?;
    Ok(chart)
}

fn draw_curves(area: &Area<'_>, summary: &Summary, schemes: &[String]) -> Result<(), Failure> {
    let budgets = budgets_of(summary);
    let x = |budget: usize| budgets.partition_point(|&less| less < budget) as f64;
    let values = range(summary.rows.iter().flat_map(|row| {
        let [low, high] = row.psnr.interval.unwrap_or([row.psnr.value; 2]);
        [low, high]
    }));
    let mut chart = panel(area, "PSNR in dB, mean over objects", &budgets, values)?;
    for (place, scheme) in schemes.iter().enumerate() {
        let colour = COLOURS[place % COLOURS.len()];
        let mut rows: Vec<_> = summary.rows.iter().filter(|row| row.scheme == *scheme).collect();
        rows.sort_by_key(|row| row.budget);
        let at = |end: usize| {
            rows.iter().filter_map(move |row| Some((x(row.budget), row.psnr.interval?[end])))
        };
        let outline: Vec<(f64, f64)> =
            at(0).chain(at(1).collect::<Vec<_>>().into_iter().rev()).collect();
        if outline.len() > 3 {
            chart.draw_series([Polygon::new(outline, colour.mix(0.1).filled())])?;
        }
        let points: Vec<_> = rows.iter().map(|row| (x(row.budget), row.psnr.value)).collect();
        chart
            .draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?
            .label(scheme.clone())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        chart.draw_series(points.into_iter().map(|at| Circle::new(at, 3, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.8))
        .label_font((FONT, 12).into_font().color(&INK))
        .draw()?;
    Ok(())
}

fn draw_differences(
    area: &Area<'_>,
    summary: &Summary,
    schemes: &[String],
    baseline: &str,
) -> Result<(), Failure> {
    let budgets = budgets_of(summary);
    let rows = || summary.differences.iter().filter(|row| row.minus == baseline);
    let values = range(rows().flat_map(|row| row.of_objects.iter().copied()).chain([0.0]));
    let mut chart =
        panel(area, &format!("dB above {baseline}, a dot an object"), &budgets, values)?;
    let ends = [(-0.5, 0.0), (budgets.len() as f64 - 0.5, 0.0)];
    chart.draw_series([PathElement::new(ends, INK.stroke_width(1))])?;
    for row in rows() {
        let (Some(scheme), Some(budget)) = (
            schemes.iter().position(|scheme| *scheme == row.scheme),
            budgets.iter().position(|&budget| budget == row.budget),
        ) else {
            continue;
        };
        let colour = COLOURS[scheme % COLOURS.len()];
        let x = budget as f64 + 0.8 * ((scheme as f64 + 0.5) / schemes.len() as f64 - 0.5);
        let dots = row.of_objects.iter().map(|&y| Circle::new((x, y), 2, colour.mix(0.5).filled()));
        chart.draw_series(dots)?;
        let mean = [(x - 0.05, row.psnr.value), (x + 0.05, row.psnr.value)];
        chart.draw_series([PathElement::new(mean, colour.stroke_width(3))])?;
        if let Some([low, high]) = row.psnr.interval {
            chart.draw_series([PathElement::new([(x, low), (x, high)], colour.stroke_width(1))])?;
        }
    }
    Ok(())
}

/// The whole page, which asks nothing of the network.
pub fn page(
    settings: &Settings,
    runs: &[Run],
    summary: &Summary,
    schemes: &[String],
    store: &Store,
) -> Result<String> {
    let mut html = beginning("Schemes by reconstruction");
    let field = settings.field.name();
    let _ = write!(
        html,
        "<header>\n<p class=\"kicker\">Vantage · evaluation</p>\n<h1>Schemes by reconstruction</h1>\n\
         <p class=\"lead\">A {field} field ({}, {} steps) is trained on the views of each scheme, and \
         compared with photos of {} x {} pixels from {} other places around the object. {} runs. \
         Photos stand on white, alpha mixed in sRGB.</p>\n</header>\n",
        settings.preset.name(),
        settings.recipe.steps,
        settings.photo_side,
        settings.photo_side,
        settings.test_views,
        runs.len(),
    );
    let _ = write!(
        html,
        "<section><h2>Quality</h2>\n<div>{}</div>\n<pre>{}</pre></section>\n",
        psnr_svg(summary, schemes, "random")?,
        escape(&summary::table(summary))
    );
    html.push_str("<section><h2>Schemes</h2>\n<ul>\n");
    for scheme in schemes {
        let _ = writeln!(html, "<li><b>{scheme}</b>: {}</li>", escape(plans::describe(scheme)));
    }
    html.push_str("</ul></section>\n");
    renders(&mut html, runs, schemes, store)?;
    html.push_str(END);
    Ok(html)
}

/// Of every object the first run of each scheme at the smallest budget, beside the truth.
fn renders(html: &mut String, runs: &[Run], schemes: &[String], store: &Store) -> Result<()> {
    let Some(budget) = runs.iter().map(|run| run.budget).min() else { return Ok(()) };
    let _ = writeln!(
        html,
        "<section><h2>Renders</h2>\n<p>After {budget} views, seed 0: the first test view, or where there \
         are flights all of them in turn; the field's render on the left, the truth on the right.</p>"
    );
    let mut last = None;
    let shown = |run: &&Run| run.budget == budget && run.seed == 0 && schemes.contains(&run.scheme);
    for run in runs.iter().filter(shown) {
        if last != Some(&run.object) {
            let _ = writeln!(html, "<h3>{}</h3>", escape(&run.object));
            last = Some(&run.object);
        }
        let flight = store.flight(run);
        let (path, kind) =
            if flight.exists() { (flight, "gif") } else { (store.render(run), "png") };
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let _ = writeln!(
            html,
            "<figure style=\"display:inline-block;margin:4px\"><img alt=\"render and truth\" \
             src=\"data:image/{kind};base64,{}\"><figcaption>{} {:.2} dB</figcaption></figure>",
            BASE64_STANDARD.encode(bytes),
            escape(&run.scheme),
            run.psnr
        );
    }
    html.push_str("</section>\n");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::tests::run;
    use crate::summary::summarise;

    #[test]
    fn a_plot_has_a_line_for_each_scheme_and_a_dot_for_each_difference() {
        let schemes = ["random", "fps"].map(str::to_owned);
        let mut runs = Vec::new();
        for (object, base) in [("a", 20.0), ("b", 24.0), ("c", 21.0)] {
            for budget in [6, 12] {
                for (scheme, off) in [("random", 0.0), ("fps", base / 20.0)] {
                    runs.push(run(object, scheme, 0, budget, base + off));
                }
            }
        }
        let svg = psnr_svg(&summarise(&runs, &schemes, &[6, 12]), &schemes, "random").unwrap();
        assert!(svg.contains("random") && svg.contains("fps"));
        let dots = svg.matches("<circle").count();
        assert_eq!(dots, 2 * 2 + 2 * 3); // of curves and of differences
        assert_eq!(svg.matches("<polygon").count(), 2);
    }
}
