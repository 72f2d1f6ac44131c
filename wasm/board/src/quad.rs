//! Squares seen in perspective: four corners of an outline, and where they are to a fraction of a
//! pixel.
//!
//! 1. Douglas and Peucker's subdivision (1973) of the outline must end with four corners.
//! 2. A line is fitted to the outline along each side (total least squares).
//! 3. Each line is fitted again to where the luma changes fastest across it, as AprilTag 3 does
//!    (`refine_edges`), twice; corners are where neighbouring lines meet.
//!
//! Not handled: lens distortion that bends a tag's sides by more than a fraction of a pixel.

use nalgebra::{Point2, Vector2};

use crate::contour::Corner;
use crate::frame::Frame;

/// Four corners in pixels, clockwise in the picture.
pub type Quad = [Point2<f64>; 4];

/// The share of the outline's length that a side may bulge.
const BULGE: f64 = 0.02;

/// Pixels that a side may bulge however short it is.
const LEAST_BULGE: f64 = 1.5;

/// The shortest side in pixels: below, eight cells cannot be told apart.
const SHORTEST_SIDE: f64 = 6.0;

/// The share of a side next to each corner that no line is fitted to: corners are rounded.
const CORNER_SHARE: f64 = 0.1;

/// A line: a point on it and its unit direction.
#[derive(Clone, Copy, Debug)]
struct Line {
    point: Point2<f64>,
    direction: Vector2<f64>,
}

/// Sums for a line through weighted points.
#[derive(Clone, Copy, Debug, Default)]
struct LineSums {
    count: u32,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl LineSums {
    fn add(&mut self, x: f64, y: f64) {
        self.count += 1;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// The line of least squared distances; `None` of fewer than three points, or of one place.
    fn line(&self) -> Option<Line> {
        if self.count < 3 {
            return None;
        }
        let n = f64::from(self.count);
        let (x, y) = (self.x / n, self.y / n);
        let (xx, xy, yy) = (self.xx / n - x * x, self.xy / n - x * y, self.yy / n - y * y);
        // The direction of the greatest spread: half the angle of (xx - yy, 2 xy).
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        let direction = Vector2::new(angle.cos(), angle.sin());
        (xx + yy > 1e-9).then_some(Line { point: Point2::new(x, y), direction })
    }
}

/// The square that an outline shows, corners to about a tenth of a pixel.
pub fn fit(outline: &[Corner]) -> Option<Quad> {
    let ends = split(outline)?;
    let n = outline.len();
    let mut lines = [None; 4];
    for (side, line) in lines.iter_mut().enumerate() {
        let (from, to) = (ends[side], ends[(side + 1) % 4]);
        let length = (to + n - from) % n;
        let skip = ((length as f64 * CORNER_SHARE) as usize).max(1);
        let mut sums = LineSums::default();
        for i in skip..=length.saturating_sub(skip) {
            let [x, y] = outline[(from + i) % n];
            sums.add(f64::from(x), f64::from(y));
        }
        *line = sums.line();
    }
    let quad = meet(lines)?;
    // Each corner must be near the outline's own: lines that hardly cross meet far away.
    let near = quad.iter().zip(ends).all(|(corner, end)| {
        let [x, y] = outline[end].map(f64::from);
        (corner - Point2::new(x, y)).norm() <= 2.0 * LEAST_BULGE + BULGE * n as f64
    });
    (near && is_convex(&quad)).then_some(quad)
}

/// Corners moved to where the luma changes fastest, dark inside.
///
/// `reach` is how many pixels they may be off by now; it is kept below half a cell.
pub fn refine(frame: &Frame<'_>, quad: &Quad, reach: f64) -> Option<Quad> {
    let mut refined = *quad;
    for reach in [reach, 1.0] {
        refined = refine_once(frame, &refined, reach)?;
    }
    let moved = refined.iter().zip(quad).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    (moved <= 2.0 * reach + 1.0 && is_convex(&refined)).then_some(refined)
}

fn refine_once(frame: &Frame<'_>, quad: &Quad, reach: f64) -> Option<Quad> {
    let mut lines = [None; 4];
    for (side, line) in lines.iter_mut().enumerate() {
        let (from, to) = (quad[side], quad[(side + 1) % 4]);
        let along = to - from;
        let length = along.norm();
        // Clockwise in the picture, y down: outwards is to the left.
        let outward = Vector2::new(along.y, -along.x) / length;
        let depth = depth(quad, side) / 8.0; // a cell, measured across this side
        let reach = reach.min(0.5 * depth).max(0.5);
        let samples = (length * 0.5).clamp(8.0, 48.0) as u32;
        let mut sums = LineSums::default();
        for i in 0..samples {
            let share = (f64::from(i) + 0.5) / f64::from(samples);
            let base = from + along * (CORNER_SHARE + (1.0 - 2.0 * CORNER_SHARE) * share);
            if let Some(offset) = steepest(frame, base, outward, reach) {
                let point = base + outward * offset;
                sums.add(point.x, point.y);
            }
        }
        // Half of a side may be hidden or blotted; of less there is no line to trust.
        *line = if sums.count * 2 >= samples { sums.line() } else { None };
    }
    meet(lines)
}

/// How far along `outward` the luma rises fastest: the mean place, weighted by the squared rise.
fn steepest(
    frame: &Frame<'_>,
    base: Point2<f64>,
    outward: Vector2<f64>,
    reach: f64,
) -> Option<f64> {
    const STEP: f64 = 0.25;
    const SPAN: usize = 4; // steps to each side over which a rise is taken: one pixel
    const MOST: usize = 64;
    let steps = ((reach / STEP) as usize).min(MOST / 2 - SPAN - 1);
    let mut values = [0.0; MOST];
    let count = 2 * (steps + SPAN) + 1;
    let first = -((steps + SPAN) as f64) * STEP;
    for (i, value) in values[..count].iter_mut().enumerate() {
        let at = base + outward * (first + i as f64 * STEP);
        *value = frame.sample(at.x, at.y);
    }
    let (mut weights, mut sum) = (0.0, 0.0);
    for i in 0..=2 * steps {
        let rise = values[i + 2 * SPAN] - values[i];
        if rise > 0.0 {
            weights += rise * rise;
            sum += rise * rise * (i as f64 - steps as f64) * STEP;
        }
    }
    (weights > 1.0).then(|| sum / weights)
}

/// How far the quad reaches inwards from a side, in pixels.
fn depth(quad: &Quad, side: usize) -> f64 {
    let (from, to) = (quad[side], quad[(side + 1) % 4]);
    let along = (to - from).normalize();
    let across = |corner: Point2<f64>| along.perp(&(corner - from)).abs();
    across(quad[(side + 2) % 4]).min(across(quad[(side + 3) % 4]))
}

/// Corner i is where the lines of sides i - 1 and i meet.
fn meet(lines: [Option<Line>; 4]) -> Option<Quad> {
    let mut quad = [Point2::origin(); 4];
    for (i, corner) in quad.iter_mut().enumerate() {
        let (before, after) = (lines[(i + 3) % 4]?, lines[i]?);
        let sine = before.direction.perp(&after.direction);
        if sine.abs() < 0.02 {
            return None;
        }
        let along = (after.point - before.point).perp(&after.direction) / sine;
        *corner = before.point + before.direction * along;
    }
    Some(quad)
}

/// Whether the corners turn right everywhere and no side is too short; false for NaN.
fn is_convex(quad: &Quad) -> bool {
    (0..4).all(|i| {
        let (a, b, c) = (quad[i], quad[(i + 1) % 4], quad[(i + 2) % 4]);
        (b - a).norm() >= SHORTEST_SIDE && (b - a).perp(&(c - b)) > 0.0
    })
}

/// Four places of an outline between which it is nearly straight, ascending; `None` if there are
/// more or fewer.
fn split(outline: &[Corner]) -> Option<[usize; 4]> {
    const MOST_ENDS: usize = 8;
    let n = outline.len();
    if (n as f64) < 4.0 * SHORTEST_SIDE {
        return None;
    }
    let bulge = (BULGE * n as f64).max(LEAST_BULGE);
    // The farthest from anywhere is a corner, and so is the farthest from that.
    let first = farthest_from(outline, 0);
    let second = farthest_from(outline, first);
    let (low, high) = (first.min(second), first.max(second));
    let mut ends = vec![low, high];
    let mut open = vec![(low, high), (high, low + n)];
    while let Some((from, to)) = open.pop() {
        let (distance, at) = farthest_from_chord(outline, from, to);
        if distance > bulge {
            if ends.len() == MOST_ENDS {
                return None;
            }
            ends.push(at % n);
            open.extend([(from, at), (at, to)]);
        }
    }
    ends.sort_unstable();
    // Where a side is parallel to the chord, any of its points may have been the farthest, and the
    // corner beside it was found as well, to a bulge: what lies between its neighbours is none.
    while ends.len() > 4 {
        let (i, distance) = flattest(outline, &ends);
        if distance > 1.5 * bulge {
            return None;
        }
        ends.remove(i);
    }
    ends.try_into().ok()
}

/// Which end is nearest to the chord between its neighbours, and how near.
fn flattest(outline: &[Corner], ends: &[usize]) -> (usize, f64) {
    let count = ends.len();
    let height = |i: usize| {
        let place = |i: usize| Point2::from(outline[ends[i % count]].map(f64::from));
        let (before, here, after) = (place(i + count - 1), place(i), place(i + 1));
        let chord = after - before;
        chord.perp(&(here - before)).abs() / chord.norm().max(1.0)
    };
    let heights = (0..count).map(|i| (i, height(i)));
    heights.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY))
}

fn farthest_from(outline: &[Corner], from: usize) -> usize {
    let [x, y] = outline[from];
    let distance = |[u, v]: &Corner| {
        let (dx, dy) = (i64::from(u - x), i64::from(v - y));
        dx * dx + dy * dy
    };
    (0..outline.len()).max_by_key(|&i| distance(&outline[i])).unwrap_or(from)
}

/// The point between two places that is farthest from the chord between them; `to` may count on
/// past the outline's end.
fn farthest_from_chord(outline: &[Corner], from: usize, to: usize) -> (f64, usize) {
    let n = outline.len();
    let point = |i: usize| outline[if i < n { i } else { i - n }];
    let ([x, y], [u, v]) = (point(from), point(to));
    let (dx, dy) = (i64::from(u - x), i64::from(v - y));
    let (mut most, mut at) = (-1, from);
    for i in from + 1..to {
        let [p, q] = point(i);
        let distance = (dx * i64::from(q - y) - dy * i64::from(p - x)).abs();
        if distance > most {
            (most, at) = (distance, i);
        }
    }
    let length = ((dx * dx + dy * dy) as f64).sqrt().max(1.0);
    (most as f64 / length, at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A dark quad on white, each pixel the mean of 8 x 8 samples.
    fn draw(quad: &Quad, width: usize, height: usize) -> Vec<u8> {
        let inside = |p: Point2<f64>| {
            (0..4).all(|i| (quad[(i + 1) % 4] - quad[i]).perp(&(p - quad[i])) > 0.0)
        };
        let mut luma = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let dark = (0..64).filter(|i| {
                    let at = |whole: usize, part: usize| whole as f64 + (part as f64 + 0.5) / 8.0;
                    inside(Point2::new(at(x, i % 8), at(y, i / 8)))
                });
                luma.push((220.0 - 180.0 * dark.count() as f64 / 64.0).round() as u8);
            }
        }
        luma
    }

    fn find(luma: &[u8], width: usize, height: usize) -> Vec<Quad> {
        let frame = Frame::try_new(luma, width, height).unwrap();
        let mut binary = crate::binary::Binary::default();
        binary.threshold(&frame);
        let mut quads = Vec::new();
        crate::contour::outlines(&binary, 36, 4000, &mut Vec::new(), |outline| {
            quads.extend(fit(outline).and_then(|quad| refine(&frame, &quad, 2.0)));
        });
        quads
    }

    proptest! {
        /// Corners of an antialiased quad are found to a fifth of a pixel at worst.
        #[test]
        fn corners_are_found_to_a_fraction_of_a_pixel(
            angle in 0.0f64..6.3,
            radius in 25.0f64..40.0,
            squash in 0.5f64..1.0,
            x in 45.0f64..46.0,
            y in 45.0f64..46.0,
        ) {
            let quad: Quad = [0.0, 1.6, 3.1, 4.6].map(|turn| {
                let (sin, cos) = f64::sin_cos(angle + turn);
                Point2::new(x + radius * cos, y + squash * radius * sin)
            });
            let quads = find(&draw(&quad, 91, 91), 91, 91);
            prop_assert_eq!(quads.len(), 1);
            for corner in quad {
                let error = quads[0].iter().map(|c| (c - corner).norm()).fold(9.0, f64::min);
                prop_assert!(error < 0.2, "{} px", error);
            }
        }
    }

    #[test]
    fn a_disc_and_a_triangle_are_no_quads() {
        let inside = |p: [f64; 2], disc: bool| {
            if disc {
                p[0].hypot(p[1]) < 20.0
            } else {
                p[1] < 15.0 && p[1] > p[0].abs() * 2.0 - 20.0
            }
        };
        for disc in [true, false] {
            let luma: Vec<u8> = (0..60 * 60)
                .map(|i| [f64::from(i % 60) - 30.0, f64::from(i / 60) - 30.0])
                .map(|p| if inside(p, disc) { 30 } else { 200 })
                .collect();
            assert!(find(&luma, 60, 60).is_empty());
        }
    }
}
