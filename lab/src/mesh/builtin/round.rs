//! Round objects: a vase, a knot, a blob, a ball.

use vantage_core::Vec3;
use vantage_core::math::{cos, sin};

use crate::mesh::Mesh;
use crate::mesh::kit::{Chance, fractal, hsv, mix, noise, painted, scaled, step};
use crate::mesh::shapes::{Joined, Object, TURN, on_globe, patch, tube, turned};

/// A painted two-handled vase, hollow, with a waist and a narrow neck.
pub(super) fn vase(seed: u64) -> Mesh {
    let mut chance = Chance::new(seed ^ 0x7661_7365);
    let belly = chance.between(0.42, 0.56);
    let neck = chance.between(0.15, 0.21);
    let lip = chance.between(0.26, 0.34);
    let foot = chance.between(0.22, 0.28);
    let shoulder = chance.between(0.78, 0.95);
    let outside = [
        (0.0, 0.0),
        (foot, 0.0),
        (foot * 1.05, 0.03),
        (foot * 0.72, 0.12),
        (belly * 0.86, 0.42),
        (belly, 0.66),
        (belly * 0.86, shoulder),
        (neck * 1.15, 1.12),
        (neck, 1.26),
        (lip * 0.9, 1.42),
        (lip, 1.45),
    ];
    // Down again inside, a wall's thickness nearer the axis.
    let wall = 0.035;
    let inside = [
        (0.0, 0.10),
        (foot * 0.5, 0.12),
        (belly * 0.86 - wall, 0.44),
        (belly - wall, 0.66),
        (belly * 0.86 - wall, shoulder),
        (neck * 1.15 - wall, 1.12),
        (neck - wall, 1.26),
        (lip * 0.9 - wall, 1.44),
        (lip, 1.45),
    ];

    let hue = chance.unit();
    let clay = hsv(0.06 + 0.02 * chance.unit(), 0.62, 0.78);
    let dark = hsv(hue, 0.75, 0.34);
    let bright = hsv(hue + chance.between(0.3, 0.5), 0.72, 0.86);
    let pale = hsv(0.12, 0.22, 0.94);
    let petals = (6 + chance.below(5)) as f32 * 2.0;
    let grain = chance.bits();
    let glaze = painted("glaze", 512, |u, v| {
        let speckle = fractal(Vec3::new(u * 60.0, v * 60.0, 1.0), 2, grain);
        let wave = 0.012 * sin(u * TURN * petals);
        let band = |low: f32, high: f32| v > low && v < high;
        let zigzag = ((u * petals * 2.0).fract() - 0.5).abs() * 2.0;
        let colour = if band(0.12, 0.17) || band(0.29, 0.31) {
            bright
        } else if band(0.17, 0.29) {
            // Tongues on the shoulder.
            if zigzag < (v - 0.17) / 0.12 { dark } else { pale }
        } else if band(0.31, 0.47) {
            // Flowers on the belly.
            let (x, y) = ((u * petals * 0.5).fract() - 0.5, (v - 0.39) * 4.2);
            let radius = (x * x + y * y).sqrt();
            let angle = if radius > 0.0 { x / radius } else { 0.0 };
            let petal = 0.24 + 0.1 * (8.0 * angle * angle * (1.0 - angle * angle) - 1.0);
            if radius < 0.08 {
                hsv(0.13, 0.85, 0.95)
            } else if radius < petal {
                mix(bright, pale, step(0.1, 0.3, radius))
            } else {
                dark
            }
        } else if band(0.47, 0.50) || band(0.62 + wave, 0.66 + wave) || band(0.70, 0.715) {
            dark
        } else if band(0.50, 0.56) {
            // A meander, roughly.
            let (a, b) = ((u * petals * 2.0).fract(), (v - 0.50) / 0.06);
            if (a < 0.2) || (b < 0.25) || (a > 0.5 && a < 0.7 && b > 0.45) { bright } else { pale }
        } else {
            mix(clay, scaled(clay, 0.75), step(0.4, 0.7, speckle))
        };
        scaled(colour, 0.86 + 0.26 * speckle)
    });

    let mut object = Object::default();
    let glaze = object.material(glaze);
    let plain = object.material(painted("inside", 128, |u, v| {
        let speckle = fractal(Vec3::new(u * 30.0, v * 30.0, 2.0), 3, grain ^ 3);
        scaled(mix(clay, dark, 0.25), 0.7 + 0.5 * speckle)
    }));
    object.add(glaze, turned(&outside, 72, 56));
    let mut lining = turned(&inside, 72, 32);
    for face in &mut lining.faces {
        face.swap(1, 2);
    }
    for corners in &mut lining.uvs {
        corners.swap(1, 2);
    }
    for corners in &mut lining.normals {
        corners.swap(1, 2);
        *corners = corners.map(|normal| -normal);
    }
    object.add(plain, lining);
    for side in [0.0, 0.5] {
        let (c, s) = (cos(side * TURN), sin(side * TURN));
        let handle = tube(
            12,
            30,
            Joined::Round,
            |t| {
                let bow = sin(t * 0.5 * TURN);
                let radius = (belly * 0.86 - 0.012) * (1.0 - t) + (neck - 0.008) * t + 0.2 * bow;
                let height = shoulder * (1.0 - t) + 1.3 * t + 0.1 * bow;
                Vec3::new(radius * c, radius * s, height)
            },
            |_| Vec3::new(-s, c, 0.0),
            |t| 0.034 - 0.01 * sin(t * 0.5 * TURN),
        );
        object.add(plain, handle.tiled(0.3, 1.0).tinted(hsv(hue, 0.35, 0.95)));
    }
    object.finished()
}

/// A torus knot, a striped and spotted tube.
pub(super) fn knot(seed: u64) -> Mesh {
    let mut chance = Chance::new(seed ^ 0x6b6e_6f74);
    let (p, q) = [(2.0, 3.0), (3.0, 2.0), (2.0, 5.0), (3.0, 4.0)][(seed % 4) as usize];
    let thick = if p + q > 6.0 { 0.15 } else { 0.2 } + chance.between(-0.02, 0.02);
    let small = chance.between(0.40, 0.48);
    let hue = chance.unit();
    let spread = chance.between(0.5, 1.0);
    let spots = chance.bits();
    let skin = painted("skin", 512, |u, v| {
        let base = hsv(hue + spread * (v + 0.06 * sin(u * TURN)), 0.72, 0.85);
        let stripe = ((v * 28.0 + u).fract() - 0.5).abs() * 2.0;
        let base = mix(base, hsv(hue + spread * v + 0.45, 0.55, 0.95), step(0.62, 0.68, stripe));
        // Spots on a grid of their own, each moved a little and now and then left out.
        let (x, y) = (u * 4.0, v * 36.0);
        let cell = Vec3::new(x.floor(), y.floor(), 0.0);
        let shift = Vec3::new(noise(cell + 0.1, spots), noise(cell + 0.1, spots ^ 1), 0.0) - 0.5;
        let centre = cell + 0.5 + shift * 0.5;
        let distance = ((x - centre.x) * (x - centre.x) + (y - centre.y) * (y - centre.y)).sqrt();
        let ink = hsv(hue + 0.55, 0.8, 0.25);
        let colour = mix(ink, base, step(0.2, 0.26, distance));
        let grain = fractal(Vec3::new(u * 24.0, v * 240.0, 3.0), 3, spots ^ 7);
        scaled(colour, 0.8 + 0.35 * grain)
    });
    let mut object = Object::default();
    let skin = object.material(skin);
    let on_torus = move |t: f32| {
        let (a, b) = (p * t * TURN, q * t * TURN);
        let radius = 1.0 + small * cos(b);
        Vec3::new(radius * cos(a), radius * sin(a), small * sin(b))
    };
    let core = move |t: f32| Vec3::new(cos(p * t * TURN), sin(p * t * TURN), 0.0);
    let knot = tube(
        24,
        220,
        Joined::Ring,
        on_torus,
        move |t| on_torus(t) - core(t),
        move |t| thick * (1.0 + 0.12 * sin(t * TURN * 11.0)),
    );
    object.add(skin, knot);
    object.finished()
}

/// A sphere with lumps and dents in soft coloured patches.
pub(super) fn blob(triangles: usize, seed: u64) -> Mesh {
    let mut chance = Chance::new(seed ^ 0x626c_6f62);
    // 2 · nu · nv cells of which a row at each pole counts half; nu = 2 nv keeps them square.
    let rows = ((triangles as f32 / 4.0).sqrt() + 0.5).max(3.0) as u32;
    let (lumps, deep) = (chance.bits(), chance.between(0.5, 0.75));
    let scale = chance.between(1.3, 1.9);
    let hue = chance.unit();
    let ink = chance.bits();
    let radius = move |d: Vec3| {
        let large = fractal(d * scale + 7.0, 3, lumps) - 0.5;
        let small = fractal(d * 7.0, 2, lumps ^ 5) - 0.5;
        1.0 + 1.5 * deep * large + 0.09 * small
    };
    let coat = painted("coat", 512, |u, v| {
        let d = on_globe(u, v);
        let tone = fractal(d * 1.7 + 3.0, 3, ink);
        let base = hsv(hue + 1.3 * tone, 0.66, 0.88);
        let vein = (fractal(d * 3.0, 4, ink ^ 1) - 0.5).abs();
        let base = mix(hsv(hue + 0.5 + tone, 0.75, 0.3), base, step(0.012, 0.035, vein));
        let speck = noise(d * 26.0, ink ^ 2);
        let base = mix(base, hsv(hue + 0.15, 0.15, 0.97), step(0.80, 0.86, speck));
        scaled(base, 0.82 + 0.3 * fractal(d * 40.0, 2, ink ^ 3))
    });
    let mut object = Object::default();
    let coat = object.material(coat);
    let mut skin = patch(rows * 2, rows, Joined::Round, |u, v| {
        let d = on_globe(u, 1.0 - v);
        d * radius(d)
    });
    for uv in skin.uvs.iter_mut().flatten() {
        uv.y = 1.0 - uv.y;
    }
    object.add(coat, skin);
    object.finished()
}

/// A painted ball: a planet, a beach ball, or a football, by the seed.
pub(super) fn ball(seed: u64) -> Mesh {
    let mut chance = Chance::new(seed ^ 0x6261_6c6c);
    let hue = chance.unit();
    let ink = chance.bits();
    let grain = move |d: Vec3| 0.86 + 0.2 * fractal(d * 30.0, 3, ink ^ 9);
    let coat = match seed % 3 {
        0 => painted("planet", 512, |u, v| {
            let d = on_globe(u, v);
            let height = fractal(d * 2.1 + 5.0, 5, ink);
            let sea = hsv(0.58 + 0.1 * hue, 0.8, 0.35 + 0.7 * height);
            let land = mix(hsv(0.30, 0.65, 0.55), hsv(0.09, 0.6, 0.72), step(0.54, 0.66, height));
            let land = mix(land, hsv(0.0, 0.05, 0.95), step(0.66, 0.72, height));
            let ground = mix(sea, land, step(0.495, 0.51, height));
            let cold = d.z.abs() + 0.25 * (fractal(d * 4.0, 3, ink ^ 2) - 0.5);
            let ground = mix(ground, [0.95, 0.97, 1.0], step(0.84, 0.9, cold));
            let cloud = fractal(d * 3.0 + Vec3::new(0.0, 0.0, d.z * 3.0), 5, ink ^ 4);
            mix(ground, [1.0; 3], 0.85 * step(0.58, 0.70, cloud))
        }),
        1 => painted("beach ball", 512, |u, v| {
            let d = on_globe(u, v);
            let sector = (u * 8.0) as u32;
            let base = if sector.is_multiple_of(2) {
                hsv(hue + 0.125 * sector as f32, 0.82, 0.9)
            } else {
                hsv(0.12, 0.1, 0.96)
            };
            let x = (u * 8.0).fract() - 0.5;
            let y = (v - 0.5) * 4.0;
            let star = (x * x + y * y).sqrt() < 0.22;
            let base = if star { hsv(hue + 0.4 + 0.2 * sector as f32, 0.7, 0.6) } else { base };
            let cap = d.z.abs() > 0.95;
            scaled(if cap { hsv(hue + 0.6, 0.8, 0.75) } else { base }, grain(d))
        }),
        _ => painted("football", 512, |u, v| {
            let d = on_globe(u, v);
            // Five-cornered patches around the icosahedron's corners, seams between its faces.
            let (mut first, mut second) = (-1.0f32, -1.0f32);
            let mut which = 0;
            for (i, corner) in icosahedron().into_iter().enumerate() {
                let along = d.dot(corner);
                if along > first {
                    (second, first, which) = (first, along, i);
                } else if along > second {
                    second = along;
                }
            }
            let base = if first > 0.93 {
                hsv(hue + 0.08 * which as f32, 0.8, 0.42)
            } else if first - second < 0.02 || first > 0.921 {
                hsv(hue, 0.3, 0.22)
            } else {
                hsv(hue + 0.5 + 0.03 * which as f32, 0.16 + 0.04 * (which % 4) as f32, 0.95)
            };
            scaled(base, grain(d))
        }),
    };
    let mut object = Object::default();
    let coat = object.material(coat);
    let mut skin = patch(96, 48, Joined::Round, |u, v| on_globe(u, 1.0 - v));
    for uv in skin.uvs.iter_mut().flatten() {
        uv.y = 1.0 - uv.y;
    }
    object.add(coat, skin);
    object.finished()
}

/// The corners of an icosahedron in the unit sphere.
fn icosahedron() -> [Vec3; 12] {
    // (0, ±1, ±golden ratio) and its rotations, at unit length.
    let (a, b) = (0.525_731_1, 0.850_650_8);
    std::array::from_fn(|i| {
        let (s, t) = (if i & 1 == 0 { a } else { -a }, if i & 2 == 0 { b } else { -b });
        match i / 4 {
            0 => Vec3::new(0.0, s, t),
            1 => Vec3::new(t, 0.0, s),
            _ => Vec3::new(s, t, 0.0),
        }
    })
}
