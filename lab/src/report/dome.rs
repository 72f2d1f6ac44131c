//! Where the cameras stand around the object: from above and from the side.
//!
//! **From above**, the distance to the middle is the angle to the zenith (an azimuthal equidistant
//! map of the sphere of directions), so that cameras at the horizon are as far apart as they are, and
//! those below it lie outside its ring. **From the side** is a plain orthographic view along +Y, with
//! the object's unit sphere. Positions are taken from the world's origin, where the object stands.

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

use vantage_core::Vec3;

use super::palette;
use super::svg::escape;
use crate::record::{PlanRecord, ViewRecord};

/// Both drawings are squares of this side, in SVG units.
const SIDE: f32 = 520.0;
const MIDDLE: f32 = SIDE / 2.0;
const MARGIN: f32 = 44.0;
/// Points drawn along each leg of the tour, which follows the sphere.
const LEG_STEPS: usize = 40;

/// What is drawn: places in world, metres.
#[derive(Clone, Debug)]
pub struct Cameras<'a> {
    /// What stands in the middle.
    pub object: &'a str,
    /// Cameras to choose from, shape (candidates).
    pub candidates: &'a [Vec3],
    /// Cameras whose photos were there before, shape (photos).
    pub taken: &'a [Vec3],
    /// The chosen cameras, in order.
    pub views: Vec<Shown<'a>>,
    /// Positions into `views`, joined by a line.
    pub tour: &'a [usize],
}

/// A chosen camera.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Its centre; what is not finite is drawn in the middle.
    pub position: Vec3,
    /// The objective that chose it, by name.
    pub objective: Option<&'a str>,
    /// Why it was chosen.
    pub reason: &'a str,
}

impl<'a> Cameras<'a> {
    /// The cameras of a plan.
    pub fn of_plan(plan: &'a PlanRecord, candidates: &'a [Vec3]) -> Self {
        let shown = |view: &'a ViewRecord| Shown {
            position: Vec3::from_array(view.position),
            objective: view.objective.as_deref(),
            reason: &view.reason,
        };
        let views = plan.views.iter().map(shown).collect();
        Self { object: &plan.object, candidates, taken: &[], views, tour: &plan.tour }
    }
}

/// The view from above, one `<svg>` element.
///
/// Colours come from the page: classes `candidate`, `taken`, `tour`, `ring`, `axis`, `view` and the
/// name of the objective (or `plain`).
pub fn from_above(cameras: &Cameras<'_>) -> String {
    let lowest = positions(cameras).map(zenith_angle).fold(FRAC_PI_2, f32::max);
    let scale = (MIDDLE - MARGIN) / lowest.clamp(FRAC_PI_2 + 0.1, PI);
    let map = |position: Vec3| {
        let azimuth = position.y.atan2(position.x);
        let radius = scale * zenith_angle(position);
        (MIDDLE + radius * azimuth.cos(), MIDDLE - radius * azimuth.sin())
    };
    let mut svg = opening("The cameras from above", cameras);
    for degrees in [30.0f32, 60.0, 90.0, 120.0, 150.0] {
        let radius = scale * degrees.to_radians();
        if radius > MIDDLE - MARGIN + 1.0 {
            break;
        }
        let class = if degrees == 90.0 { "ring horizon" } else { "ring" };
        let _ =
            write!(svg, r#"<circle class="{class}" cx="{MIDDLE}" cy="{MIDDLE}" r="{radius:.1}"/>"#);
        let (x, y) = at(radius, PI * 0.375);
        let sign = if degrees > 90.0 { "−" } else { "" };
        label(&mut svg, x, y, &format!("{sign}{:.0}°", (90.0 - degrees).abs()));
    }
    for (quarter, name) in ["+x", "+y", "−x", "−y"].into_iter().enumerate() {
        let angle = quarter as f32 * FRAC_PI_2;
        let (x, y) = at(MIDDLE - MARGIN, angle);
        let _ = write!(
            svg,
            r#"<line class="axis" x1="{MIDDLE}" y1="{MIDDLE}" x2="{x:.1}" y2="{y:.1}"/>"#
        );
        let (x, y) = at(MIDDLE - 0.5 * MARGIN, angle);
        label(&mut svg, x, y, name);
    }
    draw_cameras(&mut svg, cameras, map);
    svg.push_str("</svg>");
    svg
}

/// The view from the side, along +Y, one `<svg>` element; see [`from_above`].
pub fn from_side(cameras: &Cameras<'_>) -> String {
    let reach = positions(cameras).map(|p| p.x.abs().max(p.z.abs())).fold(1.0, f32::max);
    let scale = (MIDDLE - MARGIN) / reach;
    let map = |position: Vec3| (MIDDLE + scale * position.x, MIDDLE - scale * position.z);
    let mut svg = opening("The cameras from the side", cameras);
    let (near, far) = (MARGIN, SIDE - MARGIN);
    let _ = write!(
        svg,
        r#"<line class="axis" x1="{near}" y1="{MIDDLE}" x2="{far}" y2="{MIDDLE}"/><line class="axis" x1="{MIDDLE}" y1="{near}" x2="{MIDDLE}" y2="{far}"/><circle class="object" cx="{MIDDLE}" cy="{MIDDLE}" r="{scale:.1}"/>"#
    );
    label(&mut svg, MIDDLE, MIDDLE, "object");
    label(&mut svg, SIDE - 0.5 * MARGIN, MIDDLE, "+x");
    label(&mut svg, 0.5 * MARGIN, MIDDLE, "−x");
    label(&mut svg, MIDDLE, 0.5 * MARGIN, "+z");
    label(&mut svg, MIDDLE, SIDE - 0.5 * MARGIN, "−z");
    draw_cameras(&mut svg, cameras, map);
    svg.push_str("</svg>");
    svg
}

fn opening(title: &str, cameras: &Cameras<'_>) -> String {
    let description = format!(
        "{} chosen cameras, numbered and coloured by objective, among {} candidates around {}",
        cameras.views.len(),
        cameras.candidates.len(),
        cameras.object
    );
    format!(
        r#"<svg class="dome" viewBox="0 0 {SIDE} {SIDE}" role="img" aria-label="{title}: {}">"#,
        escape(&description)
    )
}

fn draw_cameras(svg: &mut String, cameras: &Cameras<'_>, map: impl Fn(Vec3) -> (f32, f32)) {
    let mut dots = |group: &str, class: &str, places: &[Vec3], radius: u32| {
        let _ = write!(svg, r#"<g class="{group}">"#);
        for position in places.iter().filter(|position| position.is_finite()) {
            let (x, y) = map(*position);
            let _ =
                write!(svg, r#"<circle class="{class}" cx="{x:.1}" cy="{y:.1}" r="{radius}"/>"#);
        }
        svg.push_str("</g>");
    };
    dots("candidates", "candidate", cameras.candidates, 2);
    if !cameras.taken.is_empty() {
        dots("photos", "taken", cameras.taken, 4);
    }
    let views = &cameras.views;
    let stops: Vec<Vec3> =
        cameras.tour.iter().filter_map(|&view| views.get(view)).map(position).collect();
    if stops.len() > 1 {
        let legs = stops.windows(2).flat_map(|leg| along_sphere(leg[0], leg[1]));
        let points: Vec<String> = legs.map(&map).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = write!(svg, r#"<polyline class="tour" points="{}"/>"#, points.join(" "));
    }
    // Smaller the more there are; the first is drawn last, for it matters most.
    let radius = (40.0 / (views.len().max(1) as f32).sqrt()).clamp(6.0, 11.0);
    for (index, view) in views.iter().enumerate().rev() {
        let (x, y) = map(position(view));
        let class = palette::class(palette::objective(view.objective));
        let number = index + 1;
        let title = escape(&format!("View {number}: {}", view.reason));
        let baseline = y + 0.36 * radius;
        let size = if number < 100 { 1.05 * radius } else { 0.8 * radius };
        let _ = write!(
            svg,
            r##"<a href="#view-{number}" class="view {class}"><title>{title}</title><circle cx="{x:.1}" cy="{y:.1}" r="{radius:.1}"/><text x="{x:.1}" y="{baseline:.1}" font-size="{size:.1}">{number}</text></a>"##
        );
    }
}

/// Points from `a` to `b`: directions along the great circle, distances in between.
fn along_sphere(a: Vec3, b: Vec3) -> impl Iterator<Item = Vec3> {
    let (from, to) = (a.normalize_or_zero(), b.normalize_or_zero());
    let angle = from.angle_between(to);
    // For opposite or equal directions there is no one great circle: a straight line will do.
    let curved = angle.is_finite() && angle > 1e-3 && angle < PI - 1e-3;
    (0..=LEG_STEPS).map(move |step| {
        let t = step as f32 / LEG_STEPS as f32;
        if !curved {
            return a.lerp(b, t);
        }
        let direction = (from * ((1.0 - t) * angle).sin() + to * (t * angle).sin()) / angle.sin();
        direction * (a.length() * (1.0 - t) + b.length() * t)
    })
}

fn positions<'a>(cameras: &'a Cameras<'_>) -> impl Iterator<Item = Vec3> + 'a {
    let dots = cameras.candidates.iter().chain(cameras.taken).copied();
    dots.filter(|position| position.is_finite()).chain(cameras.views.iter().map(position))
}

/// A view's position; what is not finite is drawn in the middle.
fn position(view: &Shown<'_>) -> Vec3 {
    if view.position.is_finite() { view.position } else { Vec3::ZERO }
}

/// The angle to +Z in radians, in [0, pi].
fn zenith_angle(position: Vec3) -> f32 {
    position.truncate().length().atan2(position.z).clamp(0.0, PI)
}

/// A point of the drawing at that distance from its middle, at that angle from +x.
fn at(radius: f32, angle_rad: f32) -> (f32, f32) {
    let (sin, cos) = (angle_rad % TAU).sin_cos();
    (MIDDLE + radius * cos, MIDDLE - radius * sin)
}

fn label(svg: &mut String, x: f32, y: f32, text: &str) {
    let _ = write!(svg, r#"<text class="label" x="{x:.1}" y="{:.1}">{text}</text>"#, y + 4.5);
}
