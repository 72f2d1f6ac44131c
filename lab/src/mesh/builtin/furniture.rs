//! Things with cavities and thin parts: a shelf with things in it, a chair.

use vantage_core::math::sin;
use vantage_core::{Quat, Vec3};

use crate::mesh::Mesh;
use crate::mesh::kit::{Chance, fractal, hsv, mix, noise, painted, scaled, step, wood};
use crate::mesh::shapes::{Joined, Object, TURN, bar, block, on_globe, patch, turned};

/// A bookcase of two columns and four rows: books, bowls, balls, boxes and vases in front of a
/// papered back.
pub(super) fn shelf(seed: u64) -> Mesh {
    let mut chance = Chance::new(seed ^ 0x0073_6865_6c66);
    let mut object = Object::default();
    let tone =
        hsv(chance.between(0.05, 0.09), chance.between(0.45, 0.62), chance.between(0.62, 0.8));
    let frame = object.material(wood("wood", tone, chance.bits()));
    let paper_hue = chance.unit();
    let back = object.material(paper(paper_hue, chance.bits()));
    let things = Things::new(&mut object, &mut chance);

    let (columns, rows) = (2u32, 4u32);
    let width = chance.between(1.0, 1.2);
    let depth = chance.between(0.34, 0.42);
    let board = 0.035;
    let heights: Vec<f32> = (0..rows).map(|_| chance.between(0.30, 0.40)).collect();
    let height: f32 = heights.iter().sum::<f32>() + board * (rows + 1) as f32;
    let inner = (width - board * (columns + 1) as f32) / columns as f32;

    let plank = |size: Vec3| block(size, 0.14, 0.55);
    for column in 0..=columns {
        let x = -0.5 * width + board * 0.5 + (inner + board) * column as f32;
        object.add(
            frame,
            plank(Vec3::new(board, depth, height)).moved(Vec3::new(x, 0.0, 0.5 * height)),
        );
    }
    let mut z = 0.0;
    for row in 0..=rows as usize {
        for column in 0..columns {
            let x = -0.5 * width + board + (inner + board) * column as f32 + 0.5 * inner;
            let at = Vec3::new(x, 0.0, z + 0.5 * board);
            object.add(frame, plank(Vec3::new(inner, depth, board)).moved(at));
            if let Some(&room) = heights.get(row) {
                // The front of a shelf looks along -y, its things stand on the board.
                let corner = Vec3::new(x - 0.5 * inner, -0.5 * depth, z + board);
                let cell = Cell { corner, size: Vec3::new(inner, depth - 0.03, room) };
                let kind = (row as u32 * 3 + column * 2 + (seed % 5) as u32) % 5;
                things.fill(&mut object, &mut chance, cell, kind);
            }
        }
        z += board + heights.get(row).copied().unwrap_or(0.0);
    }
    let panel = block(Vec3::new(width, 0.02, height), 0.11, 0.5);
    object.add(back, panel.moved(Vec3::new(0.0, 0.5 * depth + 0.011, 0.5 * height)));
    // A crown on top and a plinth below, a little wider than the case.
    for (z, tall) in [(height + 0.02, 0.04), (-0.03, 0.06)] {
        let slab = plank(Vec3::new(width + 0.07, depth + 0.05, tall));
        object.add(frame, slab.moved(Vec3::new(0.0, 0.0, z)));
    }
    let top = Cell {
        corner: Vec3::new(-0.5 * width + 0.1, -0.4 * depth, height + 0.04),
        size: Vec3::new(width * 0.45, depth * 0.8, 0.36),
    };
    things.fill(&mut object, &mut chance, top, 4);
    object.finished()
}

/// Wallpaper: diamonds with a dot in each.
fn paper(hue: f32, seed: u64) -> crate::mesh::Material {
    painted("wallpaper", 256, |u, v| {
        let (a, b) = ((u + v) * 4.0, (u - v) * 4.0 + 8.0);
        let (x, y) = (a.fract() - 0.5, b.fract() - 0.5);
        let odd = (a.floor() + b.floor()) as i32 & 1 == 1;
        let ground = if odd { hsv(hue, 0.42, 0.72) } else { hsv(hue + 0.07, 0.30, 0.84) };
        let dot = (x * x + y * y).sqrt();
        let colour = mix(hsv(hue + 0.5, 0.6, 0.8), ground, step(0.14, 0.18, dot));
        scaled(colour, 0.85 + 0.3 * fractal(Vec3::new(u * 40.0, v * 40.0, 0.0), 2, seed))
    })
}

/// A colour as book cloth and toys have it: any hue, yellows and greens seldom at full strength.
fn paint_tone(chance: &mut Chance) -> [f32; 3] {
    const HUES: [f32; 12] = [0.0, 0.02, 0.05, 0.09, 0.13, 0.22, 0.40, 0.50, 0.57, 0.62, 0.74, 0.94];
    let hue = HUES[chance.below(HUES.len() as u32) as usize] + chance.between(-0.015, 0.015);
    hsv(hue, chance.between(0.45, 0.75), chance.between(0.55, 0.95))
}

/// A compartment: its lower left front corner and its size.
#[derive(Clone, Copy)]
struct Cell {
    corner: Vec3,
    size: Vec3,
}

/// The materials of what stands in a shelf; parts tint them.
struct Things {
    cover: u16,
    pages: u16,
    checks: u16,
    glaze: u16,
}

impl Things {
    fn new(object: &mut Object, chance: &mut Chance) -> Self {
        let seed = chance.bits();
        let cover = object.material(painted("book cover", 128, |u, v| {
            let cloth = noise(Vec3::new(u * 64.0, v * 64.0, 0.0), seed);
            let band = ((v * 4.0).fract() - 0.5).abs();
            let base = [0.93, 0.93, 0.93];
            let base = if band < 0.06 { [1.0, 0.92, 0.55] } else { base };
            let base = if (0.2..0.24).contains(&band) { [0.5, 0.5, 0.5] } else { base };
            scaled(base, 0.84 + 0.2 * cloth)
        }));
        let pages = object.material(painted("pages", 64, |u, v| {
            scaled([0.96, 0.92, 0.80], 0.8 + 0.2 * noise(Vec3::new(u * 60.0, v * 3.0, 0.0), seed))
        }));
        let hue = chance.unit();
        let checks = object.material(painted("checks", 128, |u, v| {
            let odd = ((u * 6.0) as i32 + (v * 6.0) as i32) & 1 == 1;
            let line = (u * 6.0).fract().min((v * 6.0).fract()) < 0.08;
            let base = if odd { [0.95, 0.93, 0.88] } else { hsv(hue, 0.65, 0.85) };
            let base = if line { hsv(hue + 0.35, 0.7, 0.5) } else { base };
            scaled(base, 0.85 + 0.2 * noise(Vec3::new(u * 50.0, v * 50.0, 2.0), seed))
        }));
        let glaze = object.material(painted("glaze", 256, |u, v| {
            let drip = 0.45 + 0.12 * sin(u * TURN * 5.0) + 0.05 * sin(u * TURN * 11.0);
            let crackle = (fractal(Vec3::new(u * 12.0, v * 12.0, 0.0), 3, seed ^ 2) - 0.5).abs();
            let base = if v < drip { [0.98, 0.95, 0.9] } else { hsv(v * 0.5 + hue, 0.45, 0.8) };
            let base = if (v - drip).abs() < 0.02 { hsv(hue + 0.5, 0.6, 0.5) } else { base };
            scaled(base, 0.78 + 0.24 * step(0.0, 0.04, crackle))
        }));
        Self { cover, pages, checks, glaze }
    }

    fn fill(&self, object: &mut Object, chance: &mut Chance, cell: Cell, kind: u32) {
        let Cell { corner, size } = cell;
        let floor = |x: f32, y: f32| corner + Vec3::new(x, y, 0.0) * size;
        match kind {
            0 | 1 => {
                let end = size.x * chance.between(0.7, 0.95);
                let start = self.books(object, chance, cell, end);
                if start + 0.16 < size.x {
                    let radius = 0.065;
                    let at = corner + Vec3::new(start + 0.09, 0.4 * size.y, radius);
                    self.globe(object, chance, at, radius);
                }
            }
            2 => {
                for x in [0.3, 0.74] {
                    self.pot(object, chance, floor(x, 0.45), 0.3 * size.x, 0.82 * size.z);
                }
            }
            3 => {
                // Boxes, one on top of the other, each turned a little.
                let mut z = 0.0;
                let mut side = 0.58 * size.x.min(size.y);
                while z + 0.08 < size.z * 0.9 && side > 0.07 {
                    let tall = chance.between(0.06, 0.11);
                    let turn = Quat::from_rotation_z(chance.between(-0.4, 0.4));
                    let at = floor(0.38, 0.45) + Vec3::Z * (z + 0.5 * tall);
                    let parcel = block(Vec3::new(side * 1.25, side, tall), 0.05, 0.22);
                    object.add(
                        self.checks,
                        parcel.placed(turn, at).tinted(hsv(chance.unit(), 0.35, 1.0)),
                    );
                    z += tall;
                    side *= 0.8;
                }
                self.globe(object, chance, floor(0.83, 0.4) + Vec3::Z * 0.07, 0.07);
            }
            _ => {
                self.bowl(object, chance, floor(0.34, 0.45), 0.27 * size.x, 0.42 * size.z);
                let end = size.x * 0.98;
                let right = Cell {
                    corner: corner + Vec3::X * 0.66 * size.x,
                    size: Vec3::new(0.33 * size.x, size.y, size.z),
                };
                self.books(object, chance, right, end * 0.33);
            }
        }
    }

    /// Books from the left until `end`; gives where the last one stops.
    fn books(&self, object: &mut Object, chance: &mut Chance, cell: Cell, end: f32) -> f32 {
        let mut x = 0.01;
        loop {
            let thick = chance.between(0.022, 0.055);
            if x + thick > end {
                return x;
            }
            let tall = cell.size.z * chance.between(0.6, 0.92);
            let deep = cell.size.y * chance.between(0.6, 0.82);
            let from = cell.corner + Vec3::new(x + 0.5 * thick, 0.03 + chance.unit() * 0.03, 0.0);
            let tint = paint_tone(chance);
            let at = from + Vec3::new(0.0, 0.5 * deep, 0.5 * tall);
            let jacket = block(Vec3::new(thick, deep, tall), 0.08, tall);
            object.add(self.cover, jacket.moved(at).tinted(tint));
            // The pages show at the top.
            let paper = block(Vec3::new(thick * 0.7, deep * 0.9, 0.004), 0.08, 0.1);
            object.add(self.pages, paper.moved(from + Vec3::new(0.0, 0.52 * deep, tall + 0.001)));
            x += thick + 0.002;
        }
    }

    fn globe(&self, object: &mut Object, chance: &mut Chance, at: Vec3, radius: f32) {
        let ball = patch(24, 12, Joined::Round, |u, v| on_globe(u, 1.0 - v) * radius);
        let tint = hsv(chance.unit(), 0.3, 1.0);
        object.add(self.checks, ball.tiled(2.0, 1.0).moved(at).tinted(tint));
    }

    fn pot(&self, object: &mut Object, chance: &mut Chance, at: Vec3, wide: f32, tall: f32) {
        let (r, h) = (0.5 * wide, tall);
        let belly = chance.between(0.25, 0.6);
        let profile = [
            (0.0, 0.0),
            (0.55 * r, 0.0),
            (0.7 * r, 0.06 * h),
            (r, belly * h),
            (0.72 * r, (0.45 + 0.5 * belly) * h),
            (0.36 * r, 0.88 * h),
            (0.55 * r, h),
            (0.47 * r, 0.98 * h),
            (0.28 * r, 0.86 * h),
            (0.5 * r, 0.6 * h),
            (0.0, 0.5 * h),
        ];
        let tint = hsv(chance.unit(), 0.25, 1.0);
        object.add(self.glaze, turned(&profile, 28, 24).moved(at).tinted(tint));
    }

    fn bowl(&self, object: &mut Object, chance: &mut Chance, at: Vec3, radius: f32, tall: f32) {
        let (r, h) = (radius, tall);
        let profile = [
            (0.0, 0.0),
            (0.42 * r, 0.0),
            (0.45 * r, 0.08 * h),
            (0.85 * r, 0.5 * h),
            (r, h),
            (0.93 * r, h),
            (0.76 * r, 0.55 * h),
            (0.38 * r, 0.18 * h),
            (0.0, 0.14 * h),
        ];
        let tint = hsv(chance.unit(), 0.3, 1.0);
        object.add(self.glaze, turned(&profile, 32, 18).tiled(2.0, 1.0).moved(at).tinted(tint));
        for i in 0..5 {
            let angle = i as f32 / 4.0 * TURN;
            let size = 0.30 * r;
            let (offset, lift) = if i == 4 { (0.0, 1.1) } else { (0.36 * r, 0.62) };
            let place = Quat::from_rotation_z(angle) * Vec3::X * offset + Vec3::Z * lift * h;
            let fruit = patch(14, 8, Joined::Round, |u, v| on_globe(u, 1.0 - v) * size);
            let tint = hsv(chance.between(-0.03, 0.3), 0.75, 0.95);
            object.add(self.pages, fruit.moved(at + place).tinted(tint));
        }
    }
}

/// A kitchen chair: turned legs and rungs, a slatted back, a woven cushion.
pub(super) fn chair(seed: u64) -> Mesh {
    let mut chance = Chance::new(seed ^ 0x0063_6861_6972);
    let mut object = Object::default();
    let tone = hsv(chance.between(0.03, 0.10), chance.between(0.5, 0.7), chance.between(0.55, 0.8));
    let frame = object.material(wood("wood", tone, chance.bits()));
    let paint_hue = chance.unit();
    let paint_seed = chance.bits();
    let paint = object.material(painted("paint", 256, |u, v| {
        let worn = fractal(Vec3::new(u * 9.0, v * 9.0, 0.0), 4, paint_seed);
        let base = mix(hsv(paint_hue, 0.6, 0.62), tone, step(0.60, 0.66, worn));
        scaled(base, 0.85 + 0.25 * noise(Vec3::new(u * 70.0, v * 8.0, 1.0), paint_seed))
    }));
    let hue = paint_hue + chance.between(0.3, 0.7);
    let thread = chance.bits();
    let cloth = object.material(painted("weave", 256, |u, v| {
        let (x, y) = (u * 8.0, v * 8.0);
        let (across, along) = ((x.fract() - 0.5).abs(), (y.fract() - 0.5).abs());
        let base = hsv(hue, 0.55, 0.85);
        let base = if across < 0.14 { hsv(hue + 0.35, 0.7, 0.75) } else { base };
        let base = if along < 0.14 { mix(base, hsv(hue + 0.6, 0.75, 0.55), 0.75) } else { base };
        let weave = ((u * 128.0) as i32 + (v * 128.0) as i32) & 1;
        scaled(
            base,
            0.8 + 0.1 * weave as f32 + 0.2 * noise(Vec3::new(x * 9.0, y * 9.0, 0.0), thread),
        )
    }));

    let wide = chance.between(0.42, 0.5);
    let deep = chance.between(0.40, 0.46);
    let seat = chance.between(0.44, 0.5);
    let back = chance.between(0.46, 0.6);
    let leg = chance.between(0.017, 0.022);
    let slats = 4 + chance.below(3);
    let lean = 0.16;

    // Turned: swellings and grooves along the leg.
    let lathe = move |t: f32| leg * (1.0 + 0.28 * sin(t * TURN * 3.5) * (1.0 - t) + 0.3 * t);
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0f32)] {
        let top = Vec3::new(sx * 0.42 * wide, sy * 0.40 * deep, seat);
        let foot = Vec3::new(sx * 0.5 * wide, sy * 0.52 * deep, 0.0);
        object.add(frame, bar(foot, top, lathe, 14, 26).tiled(0.4, 2.0));
    }
    let rung = move |t: f32| leg * (0.5 + 0.35 * sin(t * 0.5 * TURN));
    let at = |sx: f32, sy: f32, z: f32| {
        let spread = z / seat;
        Vec3::new(sx * wide * (0.5 - 0.08 * spread), sy * deep * (0.52 - 0.12 * spread), z)
    };
    for z in [0.28 * seat, 0.5 * seat] {
        for side in [-1.0, 1.0] {
            object.add(frame, bar(at(side, -1.0, z), at(side, 1.0, z), rung, 12, 12));
        }
    }
    object.add(frame, bar(at(-1.0, -1.0, 0.4 * seat), at(1.0, -1.0, 0.4 * seat), rung, 12, 12));
    object.add(frame, bar(at(-1.0, 1.0, 0.4 * seat), at(1.0, 1.0, 0.4 * seat), rung, 12, 12));

    // A seat with a hollow, its rim rounded.
    let plate = pillow(wide * 1.02, deep * 1.04, 0.022, 0.25);
    object.add(paint, plate.tiled(1.0, 1.0).moved(Vec3::Z * (seat + 0.012)));
    let cushion = pillow(wide * 0.86, deep * 0.86, 0.032, 0.7);
    object.add(cloth, cushion.moved(Vec3::Z * (seat + 0.055)));

    // Posts that lean back, a bent rail, slats.
    let post_at = |x: f32, z: f32| {
        let bow = 0.045 * (1.0 - x * x * 4.0 / (wide * wide));
        Vec3::new(x, 0.42 * deep + lean * z / back * 0.7 + bow, seat + z)
    };
    for side in [-1.0, 1.0] {
        let x = side * 0.46 * wide;
        let post =
            bar(post_at(x, -0.02), post_at(x, back), move |t| leg * (1.0 - 0.25 * t), 14, 20);
        object.add(frame, post.tiled(0.4, 2.0));
    }
    let rail = |z: f32, tall: f32, thick: f32| {
        patch(20, 24, Joined::Round, move |u, v| {
            // u around the section, v from left to right.
            let x = (v - 0.5) * wide * 1.06;
            let (c, s) = (vantage_core::math::cos(u * TURN), sin(u * TURN));
            let end = if v <= 0.0 || v >= 1.0 { 0.0 } else { 1.0 };
            let swell = tall * (1.0 - 1.2 * (v - 0.5) * (v - 0.5)) * end;
            post_at(x.clamp(-0.5 * wide, 0.5 * wide), z) * Vec3::new(0.0, 1.0, 1.0)
                + Vec3::new(x, thick * c * end, swell * s)
        })
    };
    object.add(paint, rail(back, 0.05, 0.014).tiled(1.0, 2.0));
    object.add(frame, rail(0.12, 0.018, 0.011).tiled(1.0, 2.0));
    for i in 0..slats {
        let x = ((i as f32 + 0.5) / slats as f32 - 0.5) * wide * 0.84;
        let wide_slat = 0.3 * wide * 0.84 / slats as f32;
        let slat = patch(12, 14, Joined::Round, |u, v| {
            let (c, s) = (vantage_core::math::cos(u * TURN), sin(u * TURN));
            post_at(x, 0.12 + (back - 0.12) * v) + Vec3::new(wide_slat * c, 0.006 * s, 0.0)
        });
        object.add(if i % 2 == 0 { paint } else { frame }, slat.tiled(0.5, 1.5));
    }
    object.finished()
}

/// A rounded slab around the origin; `puff` says how much thicker the middle is than the rim.
fn pillow(wide: f32, deep: f32, half: f32, puff: f32) -> Mesh {
    let mut mesh = patch(40, 20, Joined::Round, |u, v| {
        // A rounded square: the globe's directions, pushed outwards to the corners.
        let d = on_globe(u, 1.0 - v);
        let ring = (d.x * d.x + d.y * d.y).sqrt();
        let longest = d.x.abs().max(d.y.abs()).max(1e-6);
        let square = ring / longest;
        let reach = ring.min(1.0).sqrt() * (1.0 + 0.8 * (square - 1.0)) / ring.max(1e-6);
        let (x, y) = (d.x * reach * 0.5 * wide, d.y * reach * 0.5 * deep);
        let flat = d.z.signum() * d.z.abs().sqrt();
        let middle = (1.0 - ring * ring).max(0.0);
        Vec3::new(x, y, flat * half * (1.0 - puff + puff * middle) + 0.0)
    });
    // Its picture from above.
    for (uvs, face) in mesh.uvs.iter_mut().zip(&mesh.faces) {
        *uvs = face.map(|vertex| {
            let p = mesh.positions[vertex as usize];
            vantage_core::Vec2::new(p.x / wide + 0.5, 0.5 - p.y / deep)
        });
    }
    mesh
}
