//! Scores by number of views: four small panels, one per objective.
//!
//! The plan's curve is strong and in the objective's colour; the others are thin, each with its own
//! colour and dashes, with a band from low to high where a curve is a mean over seeds. Panels share
//! the axis of views; each has its own range of scores, from 0, for a reader compares curves within
//! a panel, not areas between panels.

use anyhow::{Result, anyhow, ensure};
use plotters::coord::types::RangedCoordf32;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use vantage_core::{Objective, Scores};

use super::palette::{self, BASELINES, GRID, INK, MUTED, Rgb};
use crate::record::Curve;

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

const FONT: &str = "sans-serif";
const PANEL: (u32, u32) = (400, 264);
const LEGEND_HEIGHT: u32 = 44;
/// Lengths of dash and gap per baseline, pixels.
const DASHES: [(u32, u32); BASELINES.len()] = [(6, 4), (2, 3), (10, 4), (4, 6)];

/// All four panels with a legend, a whole SVG file on white, 800 x 572 pixels.
///
/// `curves`: first the plan's, then those beside it. Fails only if there are none.
pub fn scores_svg(curves: &[Curve]) -> Result<String> {
    let size = (2 * PANEL.0, 2 * PANEL.1 + LEGEND_HEIGHT);
    drawn(size, |root| {
        root.fill(&WHITE).map_err(failed)?;
        let (legend, panels) = root.split_vertically(LEGEND_HEIGHT);
        draw_legend(&legend, curves)?;
        for (panel, objective) in panels.split_evenly((2, 2)).iter().zip(Objective::ALL) {
            draw_panel(panel, objective, curves)?;
        }
        Ok(())
    })
}

/// One panel without a legend, transparent, 400 x 264 pixels. Fails only if there are no curves.
pub fn panel_svg(objective: Objective, curves: &[Curve]) -> Result<String> {
    drawn(PANEL, |root| draw_panel(root, objective, curves))
}

/// The colour of the curve at that position beside the plan's (0 is the first one beside it).
pub(super) fn baseline_colour(position: usize) -> Rgb {
    BASELINES[position % BASELINES.len()]
}

fn drawn(size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Result<()>) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        draw(&root)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn draw_panel(area: &Area<'_>, objective: Objective, curves: &[Curve]) -> Result<()> {
    ensure!(!curves.is_empty(), "there are no curves to plot");
    let (views, top) = ranges(objective, curves);
    let colour = palette::colour(Some(objective));
    let mut chart = ChartBuilder::on(area)
        .margin_top(32)
        .margin_right(16)
        .margin_left(4)
        .margin_bottom(4)
        .x_label_area_size(38)
        .y_label_area_size(52)
        .build_cartesian_2d(0.0..views, 0.0..top)
        .map_err(failed)?;
    let title = (FONT, 15, FontStyle::Bold).into_font().color(&rgb(colour));
    area.draw_text(&format!("{objective} ({})", objective.letter()), &title, (56, 9))
        .map_err(failed)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .bold_line_style(rgb(GRID))
        .light_line_style(TRANSPARENT)
        .axis_style(rgb(MUTED))
        .x_labels(6)
        .y_labels(5)
        .x_label_formatter(&|views| format!("{views:.0}"))
        .y_label_formatter(&|score| format!("{score:.2}"))
        .label_style((FONT, 12).into_font().color(&rgb(MUTED)))
        .axis_desc_style((FONT, 12).into_font().color(&rgb(INK)))
        .x_desc("number of views")
        .y_desc("score before smoothing")
        .draw()
        .map_err(failed)?;

    for (position, curve) in curves.iter().skip(1).enumerate() {
        let colour = rgb(baseline_colour(position));
        draw_band(&mut chart, objective, curve, colour)?;
        let dashes = DASHES[position % DASHES.len()];
        let points = points(objective, &curve.scores);
        let line = DashedLineSeries::new(points, dashes.0, dashes.1, colour.stroke_width(2));
        chart.draw_series(line).map_err(failed)?;
    }
    let plan = points(objective, &curves[0].scores);
    chart
        .draw_series(LineSeries::new(plan.clone(), rgb(colour).stroke_width(3)))
        .map_err(failed)?;
    // A dot a view, as long as dots can be told apart.
    if plan.len() <= 42 {
        let dots = plan.into_iter().map(|point| Circle::new(point, 3, rgb(colour).filled()));
        chart.draw_series(dots).map_err(failed)?;
    }
    Ok(())
}

fn draw_band<'a>(
    chart: &mut ChartContext<'_, SVGBackend<'a>, Cartesian2d<RangedCoordf32, RangedCoordf32>>,
    objective: Objective,
    curve: &Curve,
    colour: RGBColor,
) -> Result<()> {
    let mut outline = points(objective, &curve.low);
    let mut high = points(objective, &curve.high);
    high.reverse();
    outline.append(&mut high);
    if outline.len() >= 3 {
        let band = Polygon::new(outline, colour.mix(0.18).filled());
        chart.draw_series([band]).map_err(failed)?;
    }
    Ok(())
}

fn draw_legend(area: &Area<'_>, curves: &[Curve]) -> Result<()> {
    let text = (FONT, 13).into_font().color(&rgb(INK)).pos(Pos::new(HPos::Left, VPos::Center));
    let middle = LEGEND_HEIGHT as i32 / 2 + 2;
    let mut x = 56;
    for (position, curve) in curves.iter().enumerate() {
        if position == 0 {
            // Four colours in one stroke: the plan's line is in the colour of each panel.
            for (quarter, objective) in (0..).zip(Objective::ALL) {
                let style = rgb(palette::colour(Some(objective))).stroke_width(4);
                let from = x + 8 * quarter;
                let line = PathElement::new([(from, middle), (from + 8, middle)], style);
                area.draw(&line).map_err(failed)?;
            }
        } else {
            let style = rgb(baseline_colour(position - 1)).stroke_width(2);
            let (dash, gap) = DASHES[(position - 1) % DASHES.len()];
            let ends = [(x, middle), (x + 32, middle)];
            area.draw(&DashedPathElement::new(ends, dash, gap, style)).map_err(failed)?;
        }
        let label = label(position, curve);
        area.draw_text(&label, &text, (x + 40, middle)).map_err(failed)?;
        // No font is loaded to measure with; 7 pixels a letter is wide enough for this size.
        x += 40 + 20 + 7 * label.chars().count() as i32;
    }
    Ok(())
}

/// What the legend calls a curve.
pub(super) fn label(position: usize, curve: &Curve) -> String {
    let mean = if curve.low.is_empty() { "" } else { " (mean, low to high)" };
    let plan = if position == 0 { "this plan: " } else { "" };
    format!("{plan}{}{mean}", curve.label)
}

/// Number of views against score; what is not finite is left out.
fn points(objective: Objective, scores: &[Scores]) -> Vec<(f32, f32)> {
    let scores = scores.iter().map(|scores| scores.get(objective)).enumerate();
    scores.filter(|(_, score)| score.is_finite()).map(|(n, score)| (n as f32, score)).collect()
}

/// The ends of both axes: the longest curve, and the least round number above every score.
fn ranges(objective: Objective, curves: &[Curve]) -> (f32, f32) {
    let all = || curves.iter().flat_map(|curve| [&curve.scores, &curve.low, &curve.high]);
    let views = all().map(Vec::len).max().unwrap_or(0).saturating_sub(1).max(1);
    let most = all().flat_map(|scores| points(objective, scores)).map(|(_, score)| score);
    let most = most.fold(0.0, f32::max);
    const ROUND: [f32; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
    let top = ROUND.into_iter().find(|&round| round >= most).unwrap_or(most);
    (views as f32, top)
}

const fn rgb([r, g, b]: Rgb) -> RGBColor {
    RGBColor(r, g, b)
}

/// The back end writes to memory: what fails is the drawing, and the reader cannot mend it.
fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("cannot draw the plot: {error}")
}
