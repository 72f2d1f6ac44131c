//! Pictures of a board, by rays: slow, exact, and independent of the crate's own geometry.

use vantage_board::{Board, Intrinsics, TAG_CELLS, is_white};
use vantage_core::{Pose, Vec3};

/// An upright cylinder on the board's middle.
#[derive(Clone, Copy, Debug)]
pub struct Occluder {
    pub radius_m: f64,
    pub height_m: f64,
}

/// How a picture is taken.
#[derive(Clone, Copy, Debug)]
pub struct Picture {
    pub intrinsics: Intrinsics,
    pub width: usize,
    pub height: usize,
    pub occluder: Option<Occluder>,
    /// Samples along a pixel's side.
    pub samples: usize,
    /// Standard deviation of luma.
    pub noise: f64,
    pub seed: u64,
}

impl Default for Picture {
    fn default() -> Self {
        Self {
            intrinsics: Intrinsics { focal_px: 500.0, cx: 320.0, cy: 240.0 },
            width: 640,
            height: 480,
            occluder: None,
            samples: 4,
            noise: 0.0,
            seed: 0,
        }
    }
}

impl Picture {
    /// Luma, row by row.
    pub fn draw(&self, board: &Board, pose: &Pose) -> Vec<u8> {
        let Intrinsics { focal_px, cx, cy } = self.intrinsics;
        let [r0, r1, r2] = pose.rows().map(|row| row.map(f64::from));
        let eye = [r0[3], r1[3], r2[3]];
        let n = self.samples;
        let mut random = Random(self.seed);
        let mut luma = Vec::with_capacity(self.width * self.height);
        for y in 0..self.height {
            for x in 0..self.width {
                let mut sum = 0.0;
                for i in 0..n * n {
                    let at =
                        |whole: usize, part: usize| whole as f64 + (part as f64 + 0.5) / n as f64;
                    let (u, v) = ((at(x, i % n) - cx) / focal_px, (cy - at(y, i / n)) / focal_px);
                    let ray = [r0, r1, r2].map(|row| row[0] * u + row[1] * v - row[2]);
                    sum += self.luma_along(board, eye, ray);
                }
                let value = sum / (n * n) as f64 + self.noise * random.normal();
                luma.push(value.round().clamp(0.0, 255.0) as u8);
            }
        }
        luma
    }

    fn luma_along(&self, board: &Board, eye: [f64; 3], ray: [f64; 3]) -> f64 {
        if let Some(object) = self.occluder
            && let Some(depth) = object.hit(eye, ray)
        {
            // Stripes: the object has edges of its own.
            let height = eye[2] + depth * ray[2];
            return if (height * 200.0) as i64 % 3 == 0 { 60.0 } else { 150.0 };
        }
        if ray[2] >= -1e-9 {
            return 120.0;
        }
        let depth = -eye[2] / ray[2];
        paper(board, eye[0] + depth * ray[0], eye[1] + depth * ray[1])
    }
}

/// Luma of the sheet at a place, and of the table around it.
fn paper(board: &Board, x: f64, y: f64) -> f64 {
    const INK: f64 = 35.0;
    const WHITE: f64 = 205.0;
    const MARGIN_M: f64 = 0.015;
    let [width, height] = board.size_m();
    if x.abs() > 0.5 * width + MARGIN_M || y.abs() > 0.5 * height + MARGIN_M {
        return 90.0;
    }
    let spec = board.spec();
    let pitch = spec.tag_size_m + spec.gap_m;
    let (right, down) = (x + 0.5 * width, 0.5 * height - y);
    if right < 0.0 || down < 0.0 {
        return WHITE;
    }
    let (column, row) = ((right / pitch) as u32, (down / pitch) as u32);
    let cell = |along: f64| (along % pitch / spec.tag_size_m * f64::from(TAG_CELLS)) as u32;
    let (cell_column, cell_row) = (cell(right), cell(down));
    if column >= spec.columns
        || row >= spec.rows
        || cell_column >= TAG_CELLS
        || cell_row >= TAG_CELLS
    {
        return WHITE;
    }
    let id = spec.first_id + row * spec.columns + column;
    if is_white(id, cell_row, cell_column) { WHITE } else { INK }
}

impl Occluder {
    /// Where a ray meets the cylinder's side or top.
    fn hit(&self, eye: [f64; 3], ray: [f64; 3]) -> Option<f64> {
        let top = (self.height_m - eye[2]) / ray[2];
        let at = |depth: f64| [0, 1, 2].map(|i| eye[i] + depth * ray[i]);
        let [x, y, _] = at(top);
        if top > 0.0 && x.hypot(y) <= self.radius_m {
            return Some(top);
        }
        let a = ray[0] * ray[0] + ray[1] * ray[1];
        let b = eye[0] * ray[0] + eye[1] * ray[1];
        let c = eye[0] * eye[0] + eye[1] * eye[1] - self.radius_m * self.radius_m;
        let root = b * b - a * c;
        let depth = (-b - root.max(0.0).sqrt()) / a;
        (root > 0.0 && depth > 0.0 && (0.0..=self.height_m).contains(&at(depth)[2]))
            .then_some(depth)
    }
}

/// Normal numbers: sums of uniform ones.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        // Steele, Lea and Flood's SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// How far a pose is from the true one: the angle between them in degrees, and the distance of
/// their places as a share of the true distance from the origin.
pub fn errors(found: &Pose, truth: &Pose) -> (f64, f64) {
    // For unit quaternions a chord's length is twice the sine of a quarter of the angle.
    let (a, b) = (found.rotation(), truth.rotation());
    let chord = f64::from((a - b).length().min((a + b).length()));
    let angle = 4.0 * (0.5 * chord).asin();
    let apart: Vec3 = found.position() - truth.position();
    let share = apart.length() / truth.position().length();
    (angle.to_degrees(), f64::from(share))
}
