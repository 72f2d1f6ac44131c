//! The course of training as a picture: loss, and how well views are ranked.

use anyhow::{Result, anyhow};
use plotters::prelude::*;

use crate::fit::Course;

/// C, Q, D, T: blue, vermilion, green, purple, as in reports.
const COLOURS: [RGBColor; 4] = [
    RGBColor(0x00, 0x6b, 0xa8),
    RGBColor(0xbd, 0x4f, 0x00),
    RGBColor(0x00, 0x7d, 0x5c),
    RGBColor(0xa2, 0x40, 0x87),
];
const INK: RGBColor = RGBColor(0x1b, 0x24, 0x30);
const GRID: RGBColor = RGBColor(0xe2, 0xe4, 0xe8);
const FONT: &str = "sans-serif";

/// An SVG file on white, 800 x 320 pixels: loss on the left, rank correlation over the validation
/// objects on the right. The first course's lines are strong, others thin.
pub fn training_svg(courses: &[&Course]) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (800, 320)).into_drawing_area();
        draw(&root, courses).map_err(|error| anyhow!("the plot cannot be drawn: {error}"))?;
    }
    Ok(svg)
}

type Failure = Box<dyn std::error::Error>;

fn draw(
    root: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    courses: &[&Course],
) -> Result<(), Failure> {
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(400);
    let epochs = courses.iter().map(|course| course.epochs.len()).max().unwrap_or(1).max(2) as f32;
    let losses = || courses.iter().flat_map(|course| &course.epochs).map(|epoch| epoch.loss);
    let (low, high) = losses().fold((f32::MAX, 0f32), |(l, h), loss| (l.min(loss), h.max(loss)));

    let mut chart = panel(&left, "loss", 1.0..epochs, 0.9 * low.min(high)..1.05 * high)?;
    for (place, course) in courses.iter().enumerate() {
        let points = course.epochs.iter().map(|epoch| ((epoch.epoch + 1) as f32, epoch.loss));
        chart.draw_series(LineSeries::new(points, INK.stroke_width(width(place))))?;
    }

    let title = "rank correlation, validation";
    let mut chart = panel(&right, title, 1.0..epochs, 0.5..1.0)?;
    for (objective, (name, colour)) in ["C", "Q", "D", "T"].iter().zip(COLOURS).enumerate() {
        for (place, course) in courses.iter().enumerate() {
            let value = |epoch: &crate::fit::Epoch| epoch.validation.spearman[objective];
            let points = course.epochs.iter().map(|epoch| ((epoch.epoch + 1) as f32, value(epoch)));
            chart.draw_series(LineSeries::new(points, colour.stroke_width(width(place))))?;
        }
        let last = courses.first().and_then(|course| course.epochs.last());
        if let Some(last) = last {
            let at = (epochs, last.validation.spearman[objective]);
            let style = (FONT, 13).into_font().color(&colour);
            chart.draw_series([Text::new((*name).to_owned(), at, style)])?;
        }
    }
    root.present()?;
    Ok(())
}

fn width(place: usize) -> u32 {
    if place == 0 { 3 } else { 1 }
}

type Panel<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf32, plotters::coord::types::RangedCoordf32>,
>;

fn panel<'a, 'b>(
    area: &DrawingArea<SVGBackend<'b>, plotters::coord::Shift>,
    title: &str,
    epochs: std::ops::Range<f32>,
    values: std::ops::Range<f32>,
) -> Result<Panel<'a, 'b>, Failure> {
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .caption(title, (FONT, 15).into_font().color(&INK))
        .x_label_area_size(34)
        .y_label_area_size(44)
        .build_cartesian_2d(epochs, values)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&|epoch| format!("{epoch:.0}"))
        .y_label_formatter(&|value| format!("{value:.2}"))
        .x_desc("epoch")
        .draw()?;
    Ok(chart)
}
