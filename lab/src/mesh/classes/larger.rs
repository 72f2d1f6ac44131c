//! A fighter jet, a gravestone, a guitar.

use vantage_core::math::{cos, sin};
use vantage_core::{Quat, Vec2, Vec3};

use super::maker::Maker;
use super::paint::{Pattern, is_ink, tile_fractal, tile_noise};
use super::parts::{ball, cushion, extruded, limb, oval, pipe, polygon, ring_of, rod};
use crate::mesh::Mesh;
use crate::mesh::kit::{fractal, hsv, mix, painted, scaled};
use crate::mesh::shapes::{Joined, TURN, block, patch};

/// A flat plate with these corners in the xy plane, anticlockwise.
fn plate(corners: &[(f32, f32)], thick: f32, m: &Maker) -> Mesh {
    let centre = corners.iter().map(|&c| Vec2::from(c)).sum::<Vec2>() / corners.len() as f32;
    let around = corners.iter().map(|&c| Vec2::from(c) - centre).collect();
    // A whole number of cells on each side, so that corners stay corners.
    let cells = m.cells(4) * corners.len() as u32;
    extruded(polygon(around), thick, 0.45 * thick, cells, 2).moved(centre.extend(0.0))
}

/// The jet flies along -y.
pub(super) fn fighter_jet(m: &mut Maker) {
    let camouflage = [
        Pattern::Patches,
        Pattern::Patches,
        Pattern::Clouds,
        Pattern::Plain,
        Pattern::Scuffed,
        Pattern::Bands,
    ];
    let skin = m.patterned(&camouflage);
    let (dark, nozzle) = (m.plain([0.08, 0.09, 0.12]), m.plain([0.2, 0.19, 0.18]));
    let glass_colour = if m.maybe(0.5) { hsv(0.12, 0.6, 0.5) } else { hsv(0.58, 0.3, 0.35) };
    let glass = m.plain(glass_colour);
    let accent = m.any_plain();
    let (wide, tall) = (m.between(0.13, 0.18), m.between(0.12, 0.17));
    let (n, rows) = (m.cells(22), m.cells(30));
    let long = m.between(1.25, 1.6);
    let nose = m.between(0.35, 0.55);
    let width = move |t: f32| {
        let rise = (t / nose).min(1.0);
        (rise * (2.0 - rise)).max(0.0).sqrt().min(1.0) * (1.0 - 0.25 * (t - 0.7).max(0.0) / 0.3)
    };
    let boxy = m.between(0.0, 0.6);
    let section = oval(Vec2::ONE, boxy);
    let hull = patch(n, rows, Joined::Round, |u, v| {
        let v = v.clamp(0.0, 1.0);
        let p = section(u - u.floor()) * Vec2::new(wide, tall) * width(v);
        Vec3::new(p.x, -long + 2.0 * long * v, p.y - 0.06 * (1.0 - v) * (1.0 - v))
    });
    m.add(skin, hull.inside_out().boxed(1.2));
    let needle = m.between(0.1, 0.3);
    m.add(
        dark,
        rod(
            Vec3::new(0.0, -long - needle, -0.06),
            Vec3::new(0.0, -long + 0.05, -0.06),
            [0.004, 0.018],
            6,
            2,
        ),
    );
    let twin = m.maybe(0.5);
    let apart = if twin { 0.55 * wide } else { 0.0 };
    for x in if twin { vec![-apart, apart] } else { vec![0.0] } {
        let radius = if twin { 0.09 } else { 0.12 };
        let tail = Vec3::new(x, long - 0.12, 0.0);
        m.add(
            nozzle,
            rod(tail, tail + Vec3::Y * 0.24, [radius * 1.1, radius * 0.8], m.cells(18), 3),
        );
        m.add(
            dark,
            ball(Vec3::new(0.65, 0.15, 0.65) * radius, 14, 6).moved(tail + Vec3::Y * 0.235),
        );
    }
    // The cockpit.
    let at = m.between(0.3, 0.42);
    let cockpit = Vec3::new(0.0, -long + 2.0 * long * at, 0.72 * tall);
    let canopy = Vec3::new(0.6 * wide, m.between(0.25, 0.4), 0.11);
    m.add(glass, ball(canopy, 18, 12).moved(cockpit));
    // Intakes at the sides.
    if m.maybe(0.8) {
        let (mouth, end) = (m.between(-0.35, -0.05), 0.85 * long);
        let size = Vec3::new(0.13, end - mouth, 0.2);
        let duct = cushion(size, 0.045, m.cells(5), 2);
        let middle = Vec3::new(0.9 * wide, 0.5 * (mouth + end), -0.02);
        m.add_pair(skin, duct.boxed(1.2).moved(middle));
        let hole = cushion(Vec3::new(0.1, 0.02, 0.16), 0.008, 2, 1);
        m.add_pair(dark, hole.moved(Vec3::new(0.92 * wide, mouth - 0.005, -0.02)));
    }
    // Wings: swept or delta.
    let (span, sweep) = (m.between(0.75, 1.15), m.between(0.25, 0.9));
    let (root, tip) = (m.between(0.6, 1.0), m.between(0.08, 0.4));
    let front = m.between(-0.25, 0.15);
    let (x, y) = (0.6 * wide, front);
    let wing = plate(&[(x, y + root), (x, y), (span, y + sweep), (span, y + sweep + tip)], 0.04, m);
    let dihedral = Quat::from_rotation_y(m.between(-0.08, 0.08));
    m.add_pair(skin, wing.rotated(dihedral));
    let (tail_span, back) = (m.between(0.4, 0.6), 0.6 * long);
    if m.maybe(0.75) {
        let fin = plate(
            &[(x, back + 0.42), (x, back), (tail_span, back + 0.28), (tail_span, back + 0.48)],
            0.03,
            m,
        );
        m.add_pair(skin, fin);
    } else {
        // Canards.
        let at = front - 0.4;
        let fin = plate(&[(x, at + 0.25), (x, at), (0.5, at + 0.2), (0.5, at + 0.32)], 0.025, m);
        m.add_pair(skin, fin.moved(Vec3::Z * 0.06));
    }
    // Upright fins: built flat, then turned up.
    let high = m.between(0.35, 0.55);
    let upright = [(0.0, back + 0.5), (0.0, back), (high, back + 0.35), (high, back + 0.58)];
    if twin || m.maybe(0.3) {
        let cant = m.between(0.0, 0.4);
        let fin = plate(&upright, 0.03, m).rotated(Quat::from_rotation_y(cant - 0.25 * TURN));
        m.add_pair(skin, fin.moved(Vec3::new(0.75 * wide, 0.0, 0.6 * tall)));
    } else {
        let fin = plate(&upright, 0.03, m).rotated(Quat::from_rotation_y(-0.25 * TURN));
        m.add(skin, fin.moved(Vec3::Z * 0.7 * tall));
        let band = cushion(Vec3::new(0.045, 0.18, 0.06), 0.01, 2, 1);
        m.add(accent, band.moved(Vec3::new(0.0, back + 0.45, 0.65 * tall + 0.8 * high)));
    }
    // What hangs under the wings.
    for i in 0..m.chance.below(3) {
        let along = 0.35 + 0.3 * i as f32;
        let x = wide + (span - wide) * along;
        let y = front + sweep * along + 0.1;
        let tilt = dihedral * Vec3::new(x, y, 0.0);
        let store = tilt - Vec3::Z * 0.1;
        let half = Vec3::Y * m.between(0.14, 0.24);
        m.add_pair(accent, limb(store - half, store + half, [0.03, 0.03], 10, 12));
        m.add_pair(
            dark,
            cushion(Vec3::new(0.02, 0.14, 0.1), 0.008, 2, 1).moved(tilt - Vec3::Z * 0.05),
        );
        let fins = cushion(Vec3::new(0.16, 0.07, 0.008), 0.003, 2, 1);
        m.add_pair(accent, fins.moved(store + half * 0.9));
    }
    if m.maybe(0.35) {
        // Landed: three wheels.
        for (x, y) in [(0.0, -0.55 * long), (-0.22, 0.2 * long), (0.22, 0.2 * long)] {
            let top = Vec3::new(x, y, -0.05);
            let low = Vec3::new(x * 1.3, y, -0.36);
            m.add(nozzle, rod(low, top, [0.018, 0.022], 8, 2));
            let wheel = rod(low - Vec3::X * 0.03, low + Vec3::X * 0.03, [0.07; 2], 16, 1);
            m.add(dark, wheel);
        }
    }
}

pub(super) fn gravestone(m: &mut Maker) {
    let tone = if m.maybe(0.7) {
        hsv(m.between(0.05, 0.6), m.between(0.0, 0.18), m.between(0.2, 0.9))
    } else {
        m.colour()
    };
    let stony =
        [Pattern::Stone, Pattern::Stone, Pattern::Speckle, Pattern::Scuffed, Pattern::Clouds];
    let moss = hsv(0.28, 0.4, 0.35);
    let grown = mix(tone, moss, m.between(0.0, 0.8));
    let stone = m.printed(&stony, [tone, grown, scaled(tone, 1.35)]);
    let (seed, gilt) = (m.chance.bits(), m.maybe(0.3));
    let cut = if gilt { hsv(0.13, 0.6, 0.8) } else { scaled(tone, 0.4) };
    let lines = 5.0 + m.chance.below(5) as f32;
    let text = m.material(painted("inscription", 128, |u, v| {
        let ground = scaled(
            tone,
            0.75 + 0.35 * tile_fractal(u, v, 4, seed) + 0.1 * tile_noise(u, v, 60, seed ^ 1),
        );
        // The lines stand in the middle.
        let inset = (u - 0.08) / 0.84;
        let on_plate = (0.0..1.0).contains(&inset) && (0.06..0.94).contains(&v);
        if on_plate && is_ink(inset, v, lines, seed) { cut } else { ground }
    }));
    let (wide, tall, thick) = (m.between(0.55, 0.9), m.between(0.8, 1.4), m.between(0.1, 0.25));
    let base =
        Vec3::new(wide * m.between(1.15, 1.5), thick * m.between(1.8, 2.6), m.between(0.08, 0.2));
    m.add(stone, cushion(base, 0.02, m.cells(5), 2).moved(Vec3::Z * 0.5 * base.z));
    let style = m.chance.below(5);
    let lean = Quat::from_rotation_y(m.between(-0.06, 0.06))
        * Quat::from_rotation_x(m.between(-0.08, 0.08));
    let stand = Vec3::Z * (base.z - 0.02);
    let around = m.cells(44);
    let facing = Quat::from_rotation_x(0.25 * TURN);
    let slab = |outline: Vec<Vec2>, smooth: bool, m: &mut Maker| {
        let mesh = if smooth {
            extruded(ring_of(outline), thick, 0.02, around, 7)
        } else {
            let cells = m.cells(5) * outline.len() as u32;
            extruded(polygon(outline), thick, 0.02, cells, 7)
        };
        m.add(stone, mesh.placed(lean * facing, stand + lean * Vec3::Z * 0.5 * tall));
    };
    let (hw, hh) = (0.5 * wide, 0.5 * tall);
    let mut inscription_at = 0.5;
    match style {
        0 | 1 => {
            // A round or pointed top: an arch over straight sides.
            let pointed = style == 1 && m.maybe(0.6);
            let mut outline = vec![
                Vec2::new(-hw, -hh),
                Vec2::new(0.0, -hh),
                Vec2::new(hw, -hh),
                Vec2::new(hw, 0.0),
            ];
            let spring = hh - hw.min(hh);
            for i in 0..=12 {
                let angle = 0.5 * TURN * i as f32 / 12.0;
                let p = Vec2::new(cos(angle), sin(angle)) * hw.min(hh);
                let lift = if pointed { 0.25 * hw * (1.0 - (p.x / hw).abs()) } else { 0.0 };
                outline.push(Vec2::new(p.x / hw.min(hh) * hw, spring + p.y + lift));
            }
            outline.push(Vec2::new(-hw, 0.0));
            slab(outline, false, m);
            inscription_at = 0.47;
        }
        2 => slab(
            vec![
                Vec2::new(-hw, -hh),
                Vec2::new(hw, -hh),
                Vec2::new(hw, hh * 0.8),
                Vec2::new(0.0, hh),
                Vec2::new(-hw, hh * 0.8),
            ],
            false,
            m,
        ),
        3 => {
            // A cross.
            let (beam, at) = (m.between(0.16, 0.26), m.between(0.62, 0.74));
            let post = cushion(Vec3::new(beam, thick, tall), 0.025, m.cells(6), 2);
            m.add(stone, post.placed(lean, stand + lean * Vec3::Z * hh));
            let arms = cushion(Vec3::new(wide, thick * 0.98, beam), 0.025, m.cells(6), 2);
            m.add(stone, arms.placed(lean, stand + lean * Vec3::Z * at * tall));
            if m.maybe(0.5) {
                let ring = super::parts::hoop(Vec2::splat(0.32 * wide), 0.05, 8, 36);
                m.add(stone, ring.placed(lean * facing, stand + lean * Vec3::Z * at * tall));
            }
            let panel = block(Vec3::new(base.x * 0.7, 0.02, base.z * 0.7), 0.2, base.x * 0.7);
            m.add(
                text,
                panel.boxed(0.5).moved(Vec3::new(0.0, -0.5 * base.y - 0.005, 0.5 * base.z)),
            );
        }
        _ => {
            // An obelisk on a pedestal.
            let side = m.between(0.2, 0.32);
            let foot = cushion(Vec3::new(side * 1.5, side * 1.5, 0.3), 0.02, 4, 2);
            m.add(stone, foot.moved(stand + Vec3::Z * 0.15));
            let shaft = block(Vec3::new(1.0, 1.0, 1.0), 0.14, 1.0).warped(|p| {
                let t = p.z + 0.5;
                let narrow =
                    if t > 0.9 { 0.62 * (1.0 - (t - 0.9) / 0.1 * 0.98) } else { 1.0 - 0.42 * t };
                Vec3::new(p.x * side * narrow, p.y * side * narrow, t * tall * 1.1)
            });
            m.add(stone, shaft.moved(stand + Vec3::Z * 0.29));
            let panel = block(Vec3::new(side * 1.2, 0.02, 0.22), 0.2, 0.3);
            m.add(text, panel.boxed(0.4).moved(stand + Vec3::new(0.0, -0.75 * side - 0.005, 0.15)));
        }
    }
    if style < 3 {
        let size = Vec3::new(wide * 0.78, 0.02, tall * 0.55);
        let mut panel = block(size, 0.2, 1.0);
        // One picture over the whole front.
        panel.uvs = (0..panel.faces.len())
            .map(|face| {
                panel.corners(face).map(|p| Vec2::new(p.x / size.x + 0.5, 0.5 - p.z / size.z))
            })
            .collect();
        let at = lean * Vec3::new(0.0, -0.5 * thick - 0.004, inscription_at * tall);
        m.add(text, panel.placed(lean, stand + at));
    }
    if m.maybe(0.5) {
        // The mound, or a slab on the ground, with flowers.
        let ground = m.printed(
            &[Pattern::Clouds, Pattern::Speckle, Pattern::Patches],
            [hsv(0.28, 0.5, 0.4), hsv(0.09, 0.5, 0.35), hsv(0.3, 0.6, 0.55)],
        );
        let bumps = m.chance.bits();
        let long = m.between(0.9, 1.5);
        let mound =
            ball(Vec3::ONE, 28, 14).warped(|p| p * (0.9 + 0.2 * fractal(p * 3.0, 2, bumps)));
        m.add(
            ground,
            mound
                .stretched(Vec3::new(0.6 * wide, 0.5 * long, 0.12))
                .tiled(3.0, 2.0)
                .moved(Vec3::new(0.0, -0.5 * (long + base.y), 0.02)),
        );
        for _ in 0..m.chance.below(6) {
            let at = Vec3::new(m.between(-0.3, 0.3), -m.between(0.3, 0.6) - 0.5 * base.y, 0.1);
            let (stem, bloom) = (m.plain(hsv(0.3, 0.6, 0.35)), m.any_plain());
            m.add(stem, rod(at, at + Vec3::Z * 0.14, [0.01; 2], 5, 1));
            m.add(bloom, ball(Vec3::new(0.05, 0.05, 0.035), 10, 6).moved(at + Vec3::Z * 0.15));
        }
    }
}

/// The guitar stands upright and faces -y.
pub(super) fn guitar(m: &mut Maker) {
    let electric = m.maybe(0.45);
    let tone = if m.maybe(0.6) {
        hsv(m.between(0.03, 0.1), m.between(0.5, 0.85), m.between(0.35, 0.9))
    } else {
        m.colour()
    };
    let body = m.printed(
        &[
            Pattern::Wood,
            Pattern::Wood,
            Pattern::Plain,
            Pattern::Gradient,
            Pattern::Scuffed,
            Pattern::Patches,
        ],
        [tone, scaled(tone, 0.55), scaled(tone, 1.2)],
    );
    let dark_wood = m.printed(
        &[Pattern::Wood, Pattern::Plain],
        [hsv(0.06, 0.5, 0.25), hsv(0.06, 0.5, 0.15), [0.1; 3]],
    );
    let (black, metal) = (m.plain([0.05; 3]), m.plain([0.7, 0.7, 0.68]));
    let ivory = m.plain([0.92, 0.9, 0.82]);
    let (hip, waist, bust) = (m.between(0.36, 0.44), m.between(0.22, 0.29), m.between(0.27, 0.34));
    let (low, high) = (0.5, m.between(0.4, 0.48));
    let horn = if electric { m.between(0.1, 0.3) } else { 0.0 };
    // The outline in (x, z), anticlockwise as seen by the player's public.
    let outline = vec![
        Vec2::new(waist, 0.02),
        Vec2::new(bust * 0.95, 0.6 * high),
        Vec2::new(bust, 0.85 * high + horn),
        Vec2::new(bust * 0.55, high + horn * 0.5),
        Vec2::new(0.0, high - horn * 0.4),
        Vec2::new(-bust * 0.55, high + horn * 0.3),
        Vec2::new(-bust, 0.85 * high + horn * 1.3),
        Vec2::new(-bust * 0.95, 0.6 * high),
        Vec2::new(-waist, 0.02),
        Vec2::new(-hip * 0.95, -0.45 * low),
        Vec2::new(-hip * 0.8, -0.9 * low),
        Vec2::new(0.0, -1.15 * low),
        Vec2::new(hip * 0.8, -0.9 * low),
        Vec2::new(hip * 0.95, -0.45 * low),
    ];
    let deep = if electric { m.between(0.08, 0.12) } else { m.between(0.17, 0.26) };
    let facing = Quat::from_rotation_x(0.25 * TURN);
    let around = m.cells(52);
    let sound_box =
        extruded(ring_of(outline), deep, if electric { 0.035 } else { 0.015 }, around, 6);
    m.add(body, sound_box.rotated(facing));
    let front = -0.5 * deep;
    let length = m.between(0.85, 1.1);
    let neck_end = high + length;
    // Neck and fingerboard, frets, head.
    let neck = cushion(Vec3::new(0.085, 0.05, length + 0.1), 0.022, 6, 2);
    m.add(dark_wood, neck.moved(Vec3::new(0.0, front + 0.01, high + 0.5 * length)));
    let board = block(Vec3::new(0.088, 0.016, length + 0.25), 0.2, 0.4);
    m.add(dark_wood, board.moved(Vec3::new(0.0, front - 0.02, high + 0.5 * length - 0.12)));
    for fret in 0..14 {
        let z = neck_end - length * (1.0 - 0.92f32.powi(fret + 1)) * 1.25;
        m.add(
            metal,
            block(Vec3::new(0.088, 0.008, 0.006), 1.0, 1.0).moved(Vec3::new(0.0, front - 0.03, z)),
        );
    }
    let tilt = Quat::from_rotation_x(-m.between(0.1, 0.3));
    let head_long = m.between(0.2, 0.28);
    let head = cushion(Vec3::new(0.16, 0.035, head_long), 0.012, 5, 2);
    let head_at = Vec3::new(0.0, front + 0.02, neck_end + 0.5 * head_long);
    let head_cover = if m.maybe(0.5) { body } else { dark_wood };
    m.add(head_cover, head.placed(tilt, head_at));
    for side in [-1.0, 1.0] {
        for i in 0..3 {
            let z = (i as f32 - 1.0) * 0.3 * head_long;
            let at = head_at + tilt * Vec3::new(side * 0.075, 0.0, z);
            m.add(metal, rod(at, at + Vec3::X * side * 0.045, [0.009; 2], 6, 1));
            m.add(
                ivory,
                ball(Vec3::new(0.022, 0.012, 0.018), 10, 6).moved(at + Vec3::X * side * 0.055),
            );
        }
    }
    let bridge_z = -m.between(0.2, 0.28);
    for i in 0..6 {
        let x = (i as f32 - 2.5) * 0.013;
        let (from, to) =
            (Vec3::new(x * 1.1, front - 0.035, bridge_z), Vec3::new(x, front - 0.033, neck_end));
        m.add(metal, rod(from, to, [0.003; 2], 4, 1));
    }
    m.add(
        dark_wood,
        cushion(Vec3::new(0.2, 0.035, 0.04), 0.012, 4, 2).moved(Vec3::new(
            0.0,
            front - 0.01,
            bridge_z,
        )),
    );
    if electric {
        let guard_cover = m.covered();
        let guard = extruded(oval(Vec2::new(0.2, 0.26), 0.3), 0.012, 0.004, 32, 3);
        m.add(guard_cover, guard.placed(facing, Vec3::new(0.05, front - 0.004, -0.05)));
        for z in [-0.12, 0.02, 0.15] {
            m.add(
                black,
                cushion(Vec3::new(0.12, 0.03, 0.04), 0.01, 3, 1).moved(Vec3::new(
                    0.0,
                    front - 0.012,
                    z,
                )),
            );
        }
        for i in 0..3 {
            let at = Vec3::new(0.17 + 0.02 * i as f32, front, -0.15 - 0.09 * i as f32);
            m.add(ivory, rod(at, at - Vec3::Y * 0.035, [0.024, 0.02], 12, 1));
        }
    } else {
        let hole = Vec3::new(0.0, front - 0.002, 0.13);
        let size = m.between(0.1, 0.13);
        m.add(black, ball(Vec3::new(size, 0.004, size), 28, 6).moved(hole));
        let rosette = m.patterned(&[Pattern::Checks, Pattern::Stripes, Pattern::Plain]);
        m.add(
            rosette,
            super::parts::hoop(Vec2::splat(size), 0.012, 5, 36)
                .tiled(8.0, 1.0)
                .placed(facing, hole),
        );
        if m.maybe(0.5) {
            let guard = extruded(oval(Vec2::new(0.07, 0.13), 0.2), 0.008, 0.003, 24, 3);
            m.add(
                dark_wood,
                guard.placed(
                    facing * Quat::from_rotation_z(0.4),
                    Vec3::new(0.17, front - 0.003, 0.02),
                ),
            );
        }
    }
    if m.maybe(0.3) {
        let strap = m.covered();
        let points = [
            Vec3::new(0.0, 0.5 * deep, -1.1 * low),
            Vec3::new(-0.5, 0.25, -0.2),
            Vec3::new(-0.45, 0.3, 0.6),
            Vec3::new(-0.05, 0.1, neck_end - 0.1),
        ];
        m.add(strap, pipe(&points, 6, 30, |_| 0.025).tiled(1.0, 6.0));
    }
}
