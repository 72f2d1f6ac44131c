//! Things to use and to wear: a control, an earphone, a fan, sunglasses, a shoe.

use vantage_core::math::{cos, sin, unit};
use vantage_core::{Quat, Vec2, Vec3};

use super::maker::Maker;
use super::paint::Pattern;
use super::parts::{ball, cushion, extruded, hoop, limb, oval, pipe, ring_of, rod, sheet, towards};
use crate::mesh::kit::{hsv, mix};
use crate::mesh::shapes::{Joined, TURN, patch, turned};

const CASING: [Pattern; 6] = [
    Pattern::Plain,
    Pattern::Plain,
    Pattern::Speckle,
    Pattern::Scuffed,
    Pattern::Patches,
    Pattern::Gradient,
];

/// A remote control or a game pad; it lies on its back.
pub(super) fn control(m: &mut Maker) {
    if m.maybe(0.5) { remote(m) } else { game_pad(m) }
}

fn remote(m: &mut Maker) {
    let shell = m.patterned(&CASING);
    let (wide, long, thick) = (m.between(0.36, 0.6), m.between(1.3, 2.2), m.between(0.12, 0.26));
    let waist = m.between(-0.12, 0.12);
    let flat = m.cells(8);
    let body = cushion(Vec3::new(wide, long, thick), m.between(0.2, 0.48) * thick, flat, 3);
    let slimmed = |p: Vec3| Vec3::new(p.x * (1.0 - waist * cos(p.y / long * TURN)), p.y, p.z);
    m.add(shell, body.warped(slimmed).moved(Vec3::Z * 0.5 * thick));
    let (plain, accent) = (m.any_plain(), hsv(m.pick(&[0.0, 0.35, 0.6, 0.14]), 0.8, 0.8));
    let red = m.plain(accent);
    let (columns, rows) = (3 + m.chance.below(2), 4 + m.chance.below(5));
    let (round, top) = (m.maybe(0.5), thick);
    let pitch = Vec2::new(0.8 * wide / columns as f32, 0.5 * long / rows as f32);
    let key = 0.36 * pitch.x.min(pitch.y);
    for row in 0..rows {
        for column in 0..columns {
            let x = (column as f32 + 0.5 - 0.5 * columns as f32) * pitch.x;
            let y = -0.42 * long + (row as f32 + 0.5) * pitch.y;
            let at = Vec3::new(x, y, top);
            let material = if (row + column).is_multiple_of(7) { red } else { plain };
            if round {
                m.add(
                    material,
                    rod(at - Vec3::Z * 0.03, at + Vec3::Z * 0.03, [key, key * 0.85], 10, 1),
                );
            } else {
                m.add(
                    material,
                    cushion(Vec3::new(2.0 * key, 1.5 * key, 0.06), 0.02, 2, 1).moved(at),
                );
            }
        }
    }
    let dial = m.covered();
    let at = Vec3::new(0.0, 0.24 * long, top);
    if m.maybe(0.6) {
        m.add(dial, hoop(Vec2::splat(0.26 * wide), 0.05, 8, 28).moved(at));
        m.add(plain, ball(Vec3::new(0.14 * wide, 0.14 * wide, 0.03), 16, 6).moved(at));
    } else {
        m.add(dial, cushion(Vec3::new(0.7 * wide, 0.22 * long, 0.03), 0.01, 3, 1).moved(at));
    }
    m.add(
        red,
        rod(
            Vec3::new(-0.3 * wide, 0.43 * long, top - 0.02),
            Vec3::new(-0.3 * wide, 0.43 * long, top + 0.03),
            [0.05; 2],
            12,
            1,
        ),
    );
    m.add(
        plain,
        cushion(Vec3::new(0.4 * wide, 0.06, 0.5 * thick), 0.02, 2, 1).moved(Vec3::new(
            0.0,
            0.5 * long,
            0.5 * thick,
        )),
    );
}

fn game_pad(m: &mut Maker) {
    let shell = m.patterned(&CASING);
    let grip = if m.maybe(0.6) { shell } else { m.covered() };
    let (wide, n) = (m.between(0.5, 0.65), m.cells(20));
    let thick = m.between(0.2, 0.3);
    m.add(shell, cushion(Vec3::new(2.0 * wide, 0.75, thick), 0.45 * thick, m.cells(6), 4));
    let (spread, length) = (m.between(0.0, 0.25), m.between(0.35, 0.6));
    let top = Vec3::new(wide * 0.85, 0.1, -0.02);
    let end = top + Vec3::new(spread, -length - 0.2, -0.12);
    m.add_pair(grip, limb(top, end, [thick * 0.95, thick * 0.6], n, m.cells(16)));
    let (black, plain) = (m.plain([0.07; 3]), m.any_plain());
    let stick = |at: Vec3, m: &mut Maker| {
        m.add(black, hoop(Vec2::splat(0.15), 0.03, 6, 20).moved(at));
        m.add(black, rod(at - Vec3::Z * 0.05, at + Vec3::Z * 0.1, [0.06, 0.05], 12, 2));
        m.add(plain, ball(Vec3::new(0.115, 0.115, 0.035), 16, 6).moved(at + Vec3::Z * 0.12));
    };
    let face = 0.5 * thick;
    let apart = m.maybe(0.5);
    stick(Vec3::new(-0.3, -0.18, face), m);
    stick(Vec3::new(0.3, if apart { -0.18 } else { 0.1 }, face), m);
    let cross =
        if apart { Vec3::new(-wide * 0.8, 0.12, face) } else { Vec3::new(-wide * 0.8, 0.05, face) };
    m.add(black, cushion(Vec3::new(0.28, 0.09, 0.08), 0.02, 3, 1).moved(cross));
    m.add(black, cushion(Vec3::new(0.09, 0.28, 0.079), 0.02, 3, 1).moved(cross));
    let right = Vec3::new(wide * 0.82, 0.12, face);
    for i in 0..4 {
        let angle = TURN * i as f32 / 4.0;
        let key = m.plain(hsv(i as f32 * 0.27, 0.75, 0.85));
        let at = right + Vec3::new(cos(angle), sin(angle), 0.0) * 0.14;
        m.add(key, ball(Vec3::new(0.065, 0.065, 0.06), 12, 6).moved(at));
    }
    for x in [-0.1, 0.1] {
        m.add(
            plain,
            cushion(Vec3::new(0.1, 0.05, 0.06), 0.02, 2, 1).moved(Vec3::new(x, 0.18, face)),
        );
    }
    m.add_pair(
        plain,
        cushion(Vec3::new(0.4, 0.12, 0.12), 0.05, 3, 2).moved(Vec3::new(wide * 0.75, 0.37, 0.02)),
    );
    if m.maybe(0.4) {
        let points = [
            Vec3::new(0.0, 0.35, 0.0),
            Vec3::new(0.0, 0.6, -0.05),
            Vec3::new(m.between(-0.5, 0.5), 0.8, -0.1),
            Vec3::new(m.between(-0.6, 0.6), 1.0, -0.12),
        ];
        m.add(black, pipe(&points, 7, 24, |_| 0.03));
    }
}

pub(super) fn earphone(m: &mut Maker) {
    if m.maybe(0.65) { headphones(m) } else { ear_buds(m) }
}

fn headphones(m: &mut Maker) {
    let shell = m.patterned(&CASING);
    let pad = m.patterned(&[Pattern::Plain, Pattern::Weave, Pattern::Speckle]);
    let band = if m.maybe(0.5) { pad } else { m.covered() };
    let (wide, tall) = (m.between(0.55, 0.7), m.between(0.6, 0.85));
    let steps = 14;
    let points: Vec<Vec3> = (0..=steps)
        .map(|i| {
            let angle = 0.5 * TURN * i as f32 / steps as f32;
            Vec3::new(wide * cos(angle), 0.0, tall * sin(angle))
        })
        .collect();
    let (thick, strip) = (m.between(0.02, 0.04), m.between(1.5, 4.5));
    let arch =
        pipe(&points, 10, m.cells(36), |_| thick).warped(|p| Vec3::new(p.x, p.y * strip, p.z));
    m.add(shell, arch.tiled(1.0, 6.0));
    // The cushion under the top of the band.
    let inner: Vec<Vec3> = points[4..=10].iter().map(|p| *p * 0.94).collect();
    let soft = pipe(&inner, 12, m.cells(20), |t| 0.055 * (0.6 + 0.4 * sin(t * 0.5 * TURN)));
    m.add(band, soft.warped(|p| Vec3::new(p.x, p.y * 1.8, p.z)).tiled(1.0, 4.0));
    let (cup, long) = (m.between(0.22, 0.32), m.between(1.0, 1.3));
    let deep = m.between(0.12, 0.2);
    let n = m.cells(28);
    let place = Vec3::new(wide, 0.0, -0.1);
    let side = Quat::from_rotation_y(0.25 * TURN + m.between(-0.1, 0.15));
    let dish = extruded(oval(Vec2::new(cup * long, cup), 0.0), deep, deep * 0.35, n, 4);
    m.add_pair(shell, dish.placed(side, place + Vec3::X * 0.05));
    let ring = hoop(Vec2::new(cup * long * 0.72, cup * 0.72), cup * 0.3, 10, n);
    m.add_pair(pad, ring.placed(side, place - Vec3::X * (0.5 * deep)));
    let label = m.covered();
    let badge = ball(Vec3::new(cup * 0.55, cup * 0.55, 0.02), n, 6);
    m.add_pair(label, badge.placed(side, place + Vec3::X * (0.05 + 0.5 * deep)));
    m.add_pair(
        shell,
        rod(Vec3::new(wide, 0.0, -0.02), Vec3::new(wide, 0.0, 0.25), [0.05, 0.035], 10, 2),
    );
    if m.maybe(0.5) {
        let cable = m.plain([0.08; 3]);
        let low = place - Vec3::Z * cup;
        let points = [
            low,
            low + Vec3::new(0.05, -0.1, -0.3),
            low + Vec3::new(-0.3, -0.3, -0.45),
            low + Vec3::new(-0.8, -0.2, -0.4),
            low + Vec3::new(-1.1, -0.5, -0.5),
        ];
        m.add(cable, pipe(&points, 6, 40, |_| 0.018));
    }
    if m.maybe(0.25) {
        let arm = [
            place + Vec3::new(0.1, 0.0, -0.1),
            place + Vec3::new(0.05, -0.4, -0.2),
            place + Vec3::new(-0.25, -0.6, -0.25),
        ];
        m.add(shell, pipe(&arm, 6, 14, |_| 0.02));
        m.add(pad, ball(Vec3::splat(0.06), 12, 8).moved(arm[2]));
    }
}

fn ear_buds(m: &mut Maker) {
    let shell = m.patterned(&CASING);
    let tip = m.any_plain();
    let mesh = m.plain([0.15; 3]);
    let wired = m.maybe(0.6);
    let (n, stem) = (m.cells(22), m.between(0.35, 0.75));
    let gap = m.between(0.3, 0.45);
    let head = Vec3::new(gap, 0.0, 0.6);
    let inward = Vec3::new(-0.5, -0.85, 0.15);
    m.add_pair(shell, ball(Vec3::new(0.19, 0.22, 0.2), n, n / 2).moved(head));
    let profile = [
        (0.0, 0.0),
        (0.1, 0.0),
        (0.15, 0.05),
        (0.13, 0.13),
        (0.09, 0.2),
        (0.05, 0.21),
        (0.0, 0.19),
    ];
    let bud = turned(&profile, n, m.cells(16));
    m.add_pair(tip, bud.placed(towards(inward), head + inward * 0.14));
    m.add_pair(
        mesh,
        ball(Vec3::new(0.08, 0.02, 0.08), 12, 6).moved(head + Vec3::new(0.05, 0.21, 0.05)),
    );
    let foot = head + Vec3::new(0.03, 0.0, -stem);
    m.add_pair(shell, limb(head, foot, [0.08, 0.055], n * 2 / 3, 14));
    if wired {
        let wire = m.any_plain();
        let join = Vec3::new(0.0, -0.05, -0.55);
        let points =
            [foot, foot + Vec3::new(0.02, -0.05, -0.2), Vec3::new(0.25 * gap, -0.05, -0.3), join];
        m.add_pair(wire, pipe(&points, 6, 24, |_| 0.018));
        let (a, b) = (m.between(-0.5, 0.5), m.between(-0.5, 0.5));
        let tail = [
            join,
            join + Vec3::new(a * 0.5, 0.1, -0.25),
            join + Vec3::new(b, -0.1, -0.4),
            join + Vec3::new(a + b, 0.15, -0.55),
        ];
        m.add(wire, pipe(&tail, 6, 30, |_| 0.02));
        m.add(shell, limb(join + Vec3::Z * 0.05, join - Vec3::Z * 0.05, [0.035; 2], 8, 8));
        m.add(shell, limb(tail[3], tail[3] + (tail[3] - tail[2]) * 0.4, [0.04, 0.035], 8, 8));
    } else if m.maybe(0.6) {
        // Their box, open behind them.
        let cover = m.patterned(&CASING);
        let box_size = Vec3::new(1.1, 0.45, 0.6);
        m.add(cover, cushion(box_size, 0.2, m.cells(4), 4).moved(Vec3::new(0.0, 0.55, 0.2)));
        let lid = cushion(Vec3::new(1.1, 0.45, 0.22), 0.1, m.cells(4), 3);
        m.add(cover, lid.placed(Quat::from_rotation_x(-1.2), Vec3::new(0.0, 0.85, 0.65)));
    }
}

pub(super) fn fan(m: &mut Maker) {
    let shell = m.patterned(&CASING);
    let metal_colour = if m.maybe(0.6) { [m.between(0.1, 0.85); 3] } else { m.colour() };
    let metal = m.plain(metal_colour);
    let blade_cover = m.covered();
    let (r, blades) = (m.between(0.55, 0.75), 3 + m.chance.below(3));
    let stand = m.between(0.75, 1.6);
    let tilt =
        Quat::from_rotation_x(m.between(-0.3, 0.15)) * Quat::from_rotation_z(m.between(-0.4, 0.4));
    let middle = Vec3::Z * (stand.max(r + 0.15));
    // The head is built around z and then looks along -y.
    let place =
        |mesh: crate::mesh::Mesh| mesh.placed(tilt * Quat::from_rotation_x(0.25 * TURN), middle);
    let wide = m.between(0.55, 1.0) * 4.5 / blades as f32;
    let twist = m.between(0.15, 0.5);
    let (phase, nu) = (m.between(0.0, 1.0), m.cells(8));
    for i in 0..blades {
        let start = TURN * (i as f32 + phase) / blades as f32;
        let blade = sheet(nu, 8, 0.012, |u, v| {
            let radius = 0.12 + (r * 0.9 - 0.12) * v;
            let spread = wide * (0.5 + 0.5 * sin(v * 0.42 * TURN)) * (0.4 + 0.35 * v);
            let angle = start + spread * (u - 0.5) + 0.3 * v;
            Vec3::new(radius * cos(angle), radius * sin(angle), twist * spread * (u - 0.5) * 0.4)
        });
        m.add(blade_cover, place(blade));
    }
    m.add(shell, place(ball(Vec3::new(0.14, 0.14, 0.09), 20, 10).moved(Vec3::Z * 0.02)));
    let motor = rod(Vec3::Z * -0.42, Vec3::Z * -0.05, [0.12, 0.17], m.cells(20), 4);
    m.add(shell, place(motor));
    if m.maybe(0.85) {
        // The cage: rings and wires, in front and behind.
        let wires = 12 + m.chance.below(9);
        let wire = m.between(0.008, 0.014);
        let deep = m.between(0.1, 0.18);
        m.add(metal, place(hoop(Vec2::splat(r * 1.02), 0.022, 6, m.cells(36))));
        for side in [-1.0, 1.0] {
            m.add(
                metal,
                place(hoop(Vec2::splat(r * 0.55), wire, 4, 26).moved(Vec3::Z * side * deep * 0.92)),
            );
            for i in 0..wires {
                let angle = TURN * i as f32 / wires as f32;
                let out = Vec3::new(cos(angle), sin(angle), 0.0);
                let hub = Vec3::Z * side * deep;
                let points = [out * 0.15 + hub, out * 0.75 * r + hub * 0.85, out * r * 1.02];
                m.add(metal, place(pipe(&points, 4, 5, |_| wire)));
            }
            m.add(
                shell,
                place(ball(Vec3::new(0.17, 0.17, 0.03), 20, 6).moved(Vec3::Z * side * deep)),
            );
        }
    }
    let behind = middle + tilt * Vec3::Y * 0.25;
    let (foot, n) = (m.between(0.35, 0.6), m.cells(26));
    m.add(
        metal,
        pipe(
            &[Vec3::new(0.0, 0.25, 0.03), Vec3::new(0.0, 0.25, 0.6 * behind.z), behind],
            12,
            8,
            |_| 0.05,
        ),
    );
    let profile = [
        (0.0, 0.0),
        (foot, 0.0),
        (foot, 0.05),
        (foot * 0.85, 0.09),
        (0.12, 0.13),
        (0.07, 0.2),
        (0.0, 0.2),
    ];
    m.add(shell, turned(&profile, n, 14).moved(Vec3::new(0.0, 0.2, 0.0)));
    for i in 0..3 {
        let at = Vec3::new((i as f32 - 1.0) * 0.1, 0.2 - 0.6 * foot, 0.1);
        m.add(metal, cushion(Vec3::new(0.07, 0.07, 0.05), 0.015, 2, 1).moved(at));
    }
}

pub(super) fn sunglasses(m: &mut Maker) {
    let frame = m.covered();
    let mirror = m.maybe(0.3);
    let tint = m.colour();
    let dark = mix(tint, [0.04; 3], if mirror { 0.2 } else { 0.85 });
    let lens = m.printed(&[Pattern::Plain, Pattern::Gradient], [dark, mix(dark, tint, 0.5), dark]);
    let (wide, tall) = (m.between(0.3, 0.4), m.between(0.2, 0.36));
    let (square, droop) = (m.between(0.0, 0.9), m.between(-0.25, 0.35));
    let (thick, gap) = (m.between(0.018, 0.05), m.between(0.06, 0.12));
    let (n, wrap) = (m.cells(36), m.between(0.05, 0.35));
    let shape = oval(Vec2::new(wide, tall), square);
    // Aviators hang outwards, cat eyes rise.
    let outline = move |u: f32| {
        let p = shape(u);
        Vec2::new(
            p.x * (1.0 - droop * 0.4 * p.y / tall),
            p.y - droop * 0.35 * p.x * p.y.abs() / wide,
        )
    };
    // The front lies in the xz plane and bends back at the sides.
    let centre = wide + gap;
    let bend = move |p: Vec2| Vec3::new(centre + p.x, wrap * (centre + p.x) * (centre + p.x), p.y);
    let rim = patch(n, 8, Joined::Ring, |u, v| {
        let (p, q) = (outline(u - u.floor()), outline((u + 0.01).fract()));
        let along = unit((q - p).extend(0.0)).unwrap_or(Vec3::X);
        let out = Vec2::new(along.y, -along.x);
        let p = p + out * thick * cos(v * TURN);
        bend(p) + Vec3::Y * thick * sin(v * TURN)
    });
    // `u` runs anticlockwise as seen from -y, where the outside of this patch is inside.
    let rim = if rim_is_inverted(&rim) { rim.inside_out() } else { rim };
    m.add_pair(frame, rim.boxed(0.7));
    let pane = extruded(outline, 0.012, 0.003, n, 5);
    let pane = pane.warped(|p| {
        let flat = bend(Vec2::new(p.x, p.y));
        Vec3::new(flat.x, flat.y - p.z, flat.z)
    });
    m.add_pair(lens, pane);
    let bridge_z = m.between(0.0, 0.5) * tall;
    let arch = [
        Vec3::new(-gap * 1.2, 0.0, bridge_z),
        Vec3::new(0.0, -0.03, bridge_z + 0.05),
        Vec3::new(gap * 1.2, 0.0, bridge_z),
    ];
    m.add(frame, pipe(&arch, 8, 10, |_| thick));
    if m.maybe(0.3) {
        let bar = [
            Vec3::new(-centre, wrap * centre * centre * 0.4, tall),
            Vec3::new(0.0, 0.0, tall * 0.95),
            Vec3::new(centre, wrap * centre * centre * 0.4, tall),
        ];
        m.add(frame, pipe(&bar, 8, 14, |_| thick * 0.7));
    }
    let hinge = bend(Vec2::new(wide, 0.35 * tall));
    let long = m.between(1.1, 1.5);
    let folded = m.maybe(0.2);
    let back = if folded {
        Vec3::new(-1.0, 0.12, 0.0)
    } else {
        Vec3::new(m.between(-0.15, 0.02), 1.0, 0.0)
    };
    let down = Vec3::Z * -0.28;
    let points = [
        hinge,
        hinge + back * long * 0.35 + Vec3::Z * 0.01,
        hinge + back * long * 0.75,
        hinge + back * long + down,
    ];
    let flat = m.between(1.0, 2.2);
    let temple = pipe(&points, 8, 24, |t| thick * (1.0 + 0.25 * t));
    m.add_pair(
        frame,
        temple
            .warped(|p| {
                Vec3::new(
                    p.x,
                    p.y,
                    hinge.z + (p.z - hinge.z) * if p.z > hinge.z - 0.1 { flat } else { 1.0 },
                )
            })
            .boxed(0.7),
    );
    m.add_pair(frame, ball(Vec3::splat(thick * 1.3), 8, 6).moved(hinge));
    m.add_pair(
        lens,
        ball(Vec3::new(0.02, 0.045, 0.06), 8, 6).moved(Vec3::new(gap * 0.75, 0.05, -0.1 * tall)),
    );
}

/// Whether a closed mesh encloses a negative volume.
fn rim_is_inverted(mesh: &crate::mesh::Mesh) -> bool {
    let volume: f32 = (0..mesh.faces.len())
        .map(|face| {
            let [a, b, c] = mesh.corners(face);
            a.cross(b).dot(c)
        })
        .sum();
    volume < 0.0
}

pub(super) fn shoe(m: &mut Maker) {
    let upper = m.covered();
    let sole_cover =
        m.patterned(&[Pattern::Plain, Pattern::Bands, Pattern::Speckle, Pattern::Scuffed]);
    let lining = m.any_plain();
    let lace = m.any_plain();
    // A foot's outline around its middle: toes at -y.
    let (wide, toe) = (m.between(0.34, 0.42), m.between(0.7, 1.1));
    let outline = ring_of(vec![
        Vec2::new(0.86 * wide, 0.0),
        Vec2::new(0.78 * wide, 0.45),
        Vec2::new(0.62 * wide, 0.85),
        Vec2::new(0.0, 1.02),
        Vec2::new(-0.62 * wide, 0.85),
        Vec2::new(-0.72 * wide, 0.4),
        Vec2::new(-0.86 * wide, 0.0),
        Vec2::new(-1.08 * wide, -0.45),
        Vec2::new(-0.75 * wide * toe, -0.85),
        Vec2::new(0.05, -1.08),
        Vec2::new(0.85 * wide * toe, -0.82),
        Vec2::new(1.08 * wide, -0.4),
    ]);
    let (sole, heel) = (m.between(0.07, 0.2), m.pick(&[0.0, 0.0, 0.1, 0.25]));
    let n = m.cells(48);
    let lifted = move |y: f32| {
        // Flat under the toes, up to the heel.
        let t = ((y + 0.35) / 1.1).clamp(0.0, 1.0);
        heel * t * t * (3.0 - 2.0 * t)
    };
    let spring = m.between(0.0, 0.08);
    let toes = move |y: f32| spring * ((-0.5 - y).max(0.0) / 0.5).powi(2);
    let plate = extruded(|u| outline(u) * 1.03, sole, 0.03, n, 6);
    m.add(sole_cover, plate.warped(|p| p + Vec3::Z * (0.5 * sole + lifted(p.y) + toes(p.y))));
    if heel > 0.02 {
        let block = extruded(
            |u| Vec2::new(0.55 * wide, 0.28) * oval(Vec2::ONE, 0.5)(u),
            heel + sole,
            0.02,
            24,
            3,
        );
        m.add(sole_cover, block.moved(Vec3::new(0.0, 0.68, 0.5 * heel)));
    }
    // The upper: from the sole up, out, and in to the opening; then down inside.
    let collar = m.pick(&[0.42, 0.5, 0.75, 1.25]) + 0.0;
    let (instep, box_height) = (m.between(0.36, 0.46), m.between(0.2, 0.32));
    let opening = move |u: f32| {
        let (c, s) = (cos(u * TURN), sin(u * TURN));
        Vec3::new(0.52 * wide * c, 0.56 + 0.3 * s, collar + 0.1 * s * s.abs())
    };
    let base = &outline;
    let shape = |u: f32, v: f32| {
        let foot = base(u - u.floor());
        let ground = Vec3::new(foot.x, foot.y, sole + lifted(foot.y) + toes(foot.y) - 0.01);
        let end = opening(u) + Vec3::Z * lifted(0.6);
        // Over the toes the leather is low, at the heel it stands up to the collar.
        let front = ((0.3 - foot.y) / 1.2).clamp(0.0, 1.0);
        let high = box_height * front + instep * (1.0 - front);
        let one = ground + Vec3::new(foot.x * 0.10, foot.y * 0.03, high * 1.0);
        let two = Vec3::new(
            end.x,
            end.y - 0.38 * front,
            (instep + 0.06 + lifted(0.2)).max(end.z * (1.0 - front)),
        );
        if v <= 0.8 {
            let t = v / 0.8;
            let s = 1.0 - t;
            ground * (s * s * s)
                + one * (3.0 * s * s * t)
                + two * (3.0 * s * t * t)
                + end * (t * t * t)
        } else {
            let t = (v - 0.8) / 0.2;
            Vec3::new(
                end.x * (0.93 - 0.1 * t),
                0.56 + (end.y - 0.56) * (0.94 - 0.1 * t),
                end.z - t * (collar - sole - 0.05),
            )
        }
    };
    let rows = m.cells(26);
    let leather = patch(n, rows * 4 / 5, Joined::Round, |u, v| shape(u, 0.8 * v.clamp(0.0, 1.0)));
    m.add(upper, leather.boxed(0.9));
    let inner = patch(n, 5, Joined::Round, |u, v| shape(u, 0.8 + 0.2 * v.clamp(0.0, 1.0)));
    m.add(lining, inner);
    let insole = ball(Vec3::new(0.45 * wide, 0.3, 0.02), 20, 6);
    m.add(lining, insole.moved(Vec3::new(0.0, 0.56, sole + 0.08 + lifted(0.6))));
    // Laces over the instep, where the surface runs from the opening to the toes.
    if m.maybe(0.75) {
        let rows = 4 + m.chance.below(3);
        for i in 0..rows {
            let v = 0.74 - 0.42 * i as f32 / rows as f32;
            let points: Vec<Vec3> = [0.69, 0.72, 0.75, 0.78, 0.81]
                .iter()
                .map(|&u| shape(u, v) + Vec3::Z * 0.02)
                .collect();
            m.add(lace, pipe(&points, 6, 10, |_| 0.022));
        }
        let knot = shape(0.75, 0.77) + Vec3::new(0.0, -0.02, 0.04);
        m.add_pair(
            lace,
            hoop(Vec2::new(0.1, 0.05), 0.015, 5, 16)
                .placed(Quat::from_rotation_z(0.4), knot + Vec3::X * 0.1),
        );
    } else if m.maybe(0.6) {
        let points: Vec<Vec3> =
            (0..7).map(|i| shape(0.6 + 0.05 * i as f32, 0.62) + Vec3::Z * 0.01).collect();
        m.add(lace, pipe(&points, 8, 16, |_| 0.045));
    }
    if m.maybe(0.5) {
        // A stripe on each side.
        for (from, to) in [(0.9, 1.0), (0.5, 0.6)] {
            let points: Vec<Vec3> = (0..6)
                .map(|i| shape(from + (to - from) * i as f32 / 5.0, 0.15 + 0.09 * i as f32))
                .collect();
            m.add(sole_cover, pipe(&points, 6, 14, |t| 0.03 * sin((0.08 + 0.84 * t) * 0.5 * TURN)));
        }
    }
}
