//! Triangles to pixels: projection, exact coverage, depth.
//!
//! A sample holds a **key**: the bits of the inverse depth above the inverted face index. Both
//! orders are those of unsigned integers, so the larger key is the nearer face, and of equally near
//! ones that of the lower index; zero is no face. Then drawing is, in pseudo-code:
//!
//! ```text
//! for each face, for each sample of its bounding box:
//!     e_i = twice the signed area of (sample, the edge opposite corner i)      (integers, exact)
//!     if all e_i > 0, or e_i = 0 on a top or left edge:
//!         inverse depth = Σ e_i w_i / Σ e_i
//!         key[sample] = max(key[sample], (inverse depth, !face))
//! ```
//!
//! The loops below do that, with four changes: boxes without a sample centre are left at once
//! (most triangles of a fine mesh), and tiny ones behind what is drawn already; large triangles get
//! the span of each row by division instead of trying each sample; and what crosses the near plane
//! or lies very far aside is clipped first.
//!
//! Depth is linear in its inverse on the picture, so this interpolation is perspective-correct. The
//! corners of a face are taken in the order of their welded index: two faces on the same three
//! points get the same depth, bit by bit, whatever their winding, and the tie goes to the lower one.

use vantage_core::Vec3;

use super::clip;
use super::vertex::{FAR_ASIDE, Projected, STEP_BITS, STEPS, rounded};
use super::view::View;
use crate::mesh::Mesh;

/// Boxes with fewer samples than this along both sides are tried sample by sample. Edge functions
/// inside them are below 2 · (256 · 13)² < 2^25.
const SMALL: i32 = 12;

/// The face that a key shows; zero gives `NO_FACE`.
#[inline]
pub(super) fn face_of(key: u64) -> u32 {
    !(key as u32)
}

/// The rows of samples that are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub y0: u32,
    pub rows: u32,
}

/// The mesh in the form that drawing needs.
pub(super) struct Scene {
    pub positions: Vec<Vec3>,
    /// Corners in the mesh's order.
    pub faces: Vec<[u32; 3]>,
    /// The same corners in the order of their welded index.
    sorted: Vec<[u32; 3]>,
    /// Nothing nearer than this is drawn: 1e-3 of the mesh's radius.
    pub near: f32,
}

impl Scene {
    pub fn new(mesh: &Mesh) -> Self {
        let welded = mesh.welded();
        let sorted = mesh.faces.iter().map(|&face| {
            let mut face = face;
            face.sort_unstable_by_key(|&vertex| (welded[vertex as usize], vertex));
            face
        });
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &vertex in mesh.faces.iter().flatten() {
            low = low.min(mesh.positions[vertex as usize]);
            high = high.max(mesh.positions[vertex as usize]);
        }
        let radius = (0.5 * (high - low)).max_element();
        Self {
            positions: mesh.positions.clone(),
            faces: mesh.faces.clone(),
            sorted: sorted.collect(),
            near: if radius > 0.0 { radius * 1e-3 } else { 1e-3 },
        }
    }

    /// Projects every vertex into `out`, shape (vertices).
    pub fn project(&self, view: &View, out: &mut Vec<Projected>) {
        out.clear();
        out.extend(self.positions.iter().map(|&position| {
            let p = position - view.eye;
            let depth = p.dot(view.forward);
            let w = 1.0 / depth;
            let x = (p.dot(view.right) * w * view.fx + view.offset_x) * STEPS as f32;
            let y = (view.offset_y - p.dot(view.up) * w * view.fy) * STEPS as f32;
            let is_inside = depth >= self.near && x.abs() <= FAR_ASIDE && y.abs() <= FAR_ASIDE;
            Projected { x: rounded(x), y: rounded(y), w: if is_inside { w } else { 0.0 } }
        }));
    }

    /// Draws every face into `keys`, shape (window.rows, view.width), which starts as it should end
    /// where nothing covers it.
    ///
    /// For faces that `has_holes`, `is_there(face, x, y)` says whether there is any surface.
    pub fn draw(
        &self,
        view: &View,
        projected: &[Projected],
        window: Window,
        keys: &mut [u64],
        has_holes: impl Fn(u32) -> bool,
        mut is_there: impl FnMut(u32, u32, u32) -> bool,
    ) {
        let mut target = Target::new(view, window, keys);
        for (face, corners) in (0u32..).zip(&self.sorted) {
            let corners = corners.map(|vertex| projected[vertex as usize]);
            let [a, b, c] = corners;
            if a.w != 0.0 && b.w != 0.0 && c.w != 0.0 {
                let Some(extent) = target.extent_of(&corners) else { continue };
                if has_holes(face) {
                    target.fill(face, &corners, extent, |x, y| is_there(face, x, y));
                } else {
                    target.fill(face, &corners, extent, |_, _| true);
                }
                continue;
            }
            let points = self.sorted[face as usize].map(|vertex| self.positions[vertex as usize]);
            for triangle in clip::clipped(view, self.near, &points, &corners) {
                let Some(extent) = target.extent_of(&triangle) else { continue };
                if has_holes(face) {
                    target.fill(face, &triangle, extent, |x, y| is_there(face, x, y));
                } else {
                    target.fill(face, &triangle, extent, |_, _| true);
                }
            }
        }
    }
}

/// Samples to draw on.
struct Target<'a> {
    keys: &'a mut [u64],
    width: i32,
    /// First row and one past the last.
    rows: [i32; 2],
    /// Where the centre of sample (0, 0) lies, in steps from the picture's middle.
    origin_x: i32,
    origin_y: i32,
}

/// The samples whose centres a triangle's bounding box holds: first and last column and row.
struct Extent {
    x: [i32; 2],
    y: [i32; 2],
    is_small: bool,
}

impl<'a> Target<'a> {
    fn new(view: &View, window: Window, keys: &'a mut [u64]) -> Self {
        let origin = |side: u32| STEPS / 2 - STEPS / 2 * side as i32;
        Self {
            keys,
            width: view.width as i32,
            rows: [window.y0 as i32, (window.y0 + window.rows) as i32],
            origin_x: origin(view.width),
            origin_y: origin(view.height),
        }
    }

    /// `None` where no sample's centre can be covered.
    #[inline]
    fn extent_of(&self, corners: &[Projected; 3]) -> Option<Extent> {
        let [a, b, c] = corners;
        // The first centre at or after the low end, the last at or before the high end.
        let first = |low: i32, origin: i32| (low - origin + STEPS - 1) >> STEP_BITS;
        let last = |high: i32, origin: i32| (high - origin) >> STEP_BITS;
        let x0 = first(a.x.min(b.x).min(c.x), self.origin_x);
        let x1 = last(a.x.max(b.x).max(c.x), self.origin_x);
        let y0 = first(a.y.min(b.y).min(c.y), self.origin_y);
        let y1 = last(a.y.max(b.y).max(c.y), self.origin_y);
        // Of the whole box, so that the way of filling does not depend on the window.
        let is_small = (x1 - x0).max(y1 - y0) < SMALL;
        let (x0, x1) = (x0.max(0), x1.min(self.width - 1));
        let (y0, y1) = (y0.max(self.rows[0]), y1.min(self.rows[1] - 1));
        (x0 <= x1 && y0 <= y1).then_some(Extent { x: [x0, x1], y: [y0, y1], is_small })
    }

    /// Writes a face's key to each sample that it covers, is nearest at, and is there.
    #[inline]
    fn fill(
        &mut self,
        face: u32,
        corners: &[Projected; 3],
        extent: Extent,
        is_there: impl FnMut(u32, u32) -> bool,
    ) {
        if extent.is_small {
            self.fill_small(face, corners, extent, is_there);
        } else {
            self.fill_spans(face, corners, extent, is_there);
        }
    }

    /// Tries every sample of the box; the edge functions fit 32 bits.
    #[inline]
    fn fill_small(
        &mut self,
        face: u32,
        corners: &[Projected; 3],
        extent: Extent,
        mut is_there: impl FnMut(u32, u32) -> bool,
    ) {
        let [a, b, c] = corners;
        let Extent { x: [x0, x1], y: [y0, y1], .. } = extent;
        let nearest = a.w.max(b.w).max(c.w);
        let width = self.width as usize;
        let at = |x: i32, y: i32| (y - self.rows[0]) as usize * width + x as usize;
        if x1 - x0 <= 1 && y1 - y0 <= 1 {
            // Most often hidden already; then nothing needs to be set up.
            let best = key_of(face, nearest);
            let hidden = |x: i32, y: i32| self.keys[at(x, y)] >= best;
            if hidden(x0, y0) && hidden(x1, y0) && hidden(x0, y1) && hidden(x1, y1) {
                return;
            }
        }
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if area == 0 {
            return;
        }
        let sign = area.signum();
        let (start_x, start_y) = (self.origin_x + x0 * STEPS, self.origin_y + y0 * STEPS);
        let edges = [
            Edge::<i32>::new(b, c, sign, start_x, start_y),
            Edge::<i32>::new(c, a, sign, start_x, start_y),
            Edge::<i32>::new(a, b, sign, start_x, start_y),
        ];
        let per_area = 1.0 / (area * sign) as f32;
        let mut at_row = edges.map(|edge| edge.start);
        for y in y0..=y1 {
            let row_start = (y - self.rows[0]) as usize * width;
            let row = &mut self.keys[row_start + x0 as usize..=row_start + x1 as usize];
            let [mut e0, mut e1, mut e2] = at_row;
            for (x, cell) in (x0..).zip(row) {
                let is_covered =
                    (e0 + edges[0].bias) | (e1 + edges[1].bias) | (e2 + edges[2].bias) >= 0;
                if is_covered {
                    let w = (e0 as f32 * a.w + e1 as f32 * b.w + e2 as f32 * c.w) * per_area;
                    let key = key_of(face, w.min(nearest));
                    if key > *cell && is_there(x as u32, y as u32) {
                        *cell = key;
                    }
                }
                e0 += edges[0].dx;
                e1 += edges[1].dx;
                e2 += edges[2].dx;
            }
            for (value, edge) in at_row.iter_mut().zip(&edges) {
                *value += edge.dy;
            }
        }
    }

    /// Finds the covered span of each row by division.
    fn fill_spans(
        &mut self,
        face: u32,
        corners: &[Projected; 3],
        extent: Extent,
        mut is_there: impl FnMut(u32, u32) -> bool,
    ) {
        let [a, b, c] = corners;
        let Extent { x: [x0, x1], y: [y0, y1], .. } = extent;
        let area = i64::from(b.x - a.x) * i64::from(c.y - a.y)
            - i64::from(b.y - a.y) * i64::from(c.x - a.x);
        if area == 0 {
            return;
        }
        let sign = area.signum();
        let (start_x, start_y) = (self.origin_x + x0 * STEPS, self.origin_y + y0 * STEPS);
        let edges = [
            Edge::<i64>::new(b, c, sign, start_x, start_y),
            Edge::<i64>::new(c, a, sign, start_x, start_y),
            Edge::<i64>::new(a, b, sign, start_x, start_y),
        ];
        // Σ e_i = |area| at every sample, so one division serves the whole triangle.
        let per_area = 1.0 / (area * sign) as f32;
        let weights = [a.w * per_area, b.w * per_area, c.w * per_area];
        let slope: f32 = (0..3).map(|i| edges[i].dx as f32 * weights[i]).sum();
        let (nearest, farthest) = (a.w.max(b.w).max(c.w), a.w.min(b.w).min(c.w));
        let mut at_row = edges.map(|edge| edge.start);
        for y in y0..=y1 {
            if let Some([from, to]) = span(&edges, &at_row, i64::from(x1 - x0)) {
                let first: f32 =
                    (0..3).map(|i| (at_row[i] + edges[i].dx * from) as f32 * weights[i]).sum();
                let row_start = (y - self.rows[0]) as usize * self.width as usize + x0 as usize;
                let cells = &mut self.keys[row_start + from as usize..=row_start + to as usize];
                for (k, cell) in (0u32..).zip(cells) {
                    // Rounding must not take the depth out of the triangle's range.
                    let w = (first + slope * k as f32).max(farthest).min(nearest);
                    let key = key_of(face, w);
                    if key > *cell && is_there(x0 as u32 + from as u32 + k, y as u32) {
                        *cell = key;
                    }
                }
            }
            for (value, edge) in at_row.iter_mut().zip(&edges) {
                *value += edge.dy;
            }
        }
    }
}

#[inline]
fn key_of(face: u32, w: f32) -> u64 {
    u64::from(w.to_bits()) << 32 | u64::from(!face)
}

/// Twice the area of a sample and an edge, positive inside, as a linear function.
#[derive(Clone, Copy)]
struct Edge<T> {
    start: T,
    /// Per sample to the right and downwards.
    dx: T,
    dy: T,
    /// 0 on edges that own the samples on them (left ones, and level ones above), else -1.
    bias: T,
}

macro_rules! edge_over {
    ($int:ty) => {
        impl Edge<$int> {
            #[inline]
            fn new(from: &Projected, to: &Projected, sign: $int, x: i32, y: i32) -> Self {
                let along_x = sign * (to.x - from.x) as $int;
                let along_y = sign * (to.y - from.y) as $int;
                let start = along_x * (y - from.y) as $int - along_y * (x - from.x) as $int;
                let owns = (along_y < 0) | ((along_y == 0) & (along_x > 0));
                Self {
                    start,
                    dx: -along_y * STEPS as $int,
                    dy: along_x * STEPS as $int,
                    bias: if owns { 0 } else { -1 },
                }
            }
        }
    };
}

edge_over!(i32);
edge_over!(i64);

/// The first and last column, from 0 to `last`, where no edge is negative in this row.
#[inline]
fn span(edges: &[Edge<i64>; 3], at_row: &[i64; 3], last: i64) -> Option<[i64; 2]> {
    let (mut from, mut to) = (0, last);
    for (edge, value) in edges.iter().zip(at_row) {
        let value = value + edge.bias;
        if edge.dx > 0 {
            if value < 0 {
                from = from.max((-value + edge.dx - 1) / edge.dx);
            }
        } else if value < 0 {
            return None;
        } else if edge.dx < 0 {
            to = to.min(value / -edge.dx);
        }
    }
    (from <= to).then_some([from, to])
}
