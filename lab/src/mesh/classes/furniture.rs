//! A bookcase, a chair, a toilet. They stand on z = 0 and face -y.

use vantage_core::math::{cos, sin};
use vantage_core::{Quat, Vec2, Vec3};

use super::maker::Maker;
use super::paint::{Pattern, is_ink};
use super::parts::{ball, cushion, extruded, hoop, limb, oval, pipe, rod};
use crate::mesh::kit::{hsv, mix, painted, scaled};
use crate::mesh::shapes::{TURN, block, turned};

const WOODEN: [Pattern; 5] =
    [Pattern::Wood, Pattern::Wood, Pattern::Plain, Pattern::Scuffed, Pattern::Speckle];

/// A wood's colour, or now and then any paint.
fn timber(m: &mut Maker) -> [f32; 3] {
    if m.maybe(0.6) {
        hsv(m.between(0.04, 0.11), m.between(0.25, 0.65), m.between(0.3, 0.9))
    } else {
        m.colour()
    }
}

pub(super) fn bookcase(m: &mut Maker) {
    let tone = timber(m);
    let frame = m.printed(&WOODEN, [tone, scaled(tone, 0.7), scaled(tone, 1.2)]);
    let seed = m.chance.bits();
    let (paper, ink) = ([0.93; 3], [0.25, 0.2, 0.1]);
    let spine = m.material(painted("spine", 64, |u, v| {
        let band = (0.10..0.14).contains(&v) || (0.84..0.87).contains(&v);
        let title = (0.2..0.7).contains(&v) && is_ink(v * 1.6, (u - 0.2) * 1.6, 3.0, seed);
        if band { [1.0, 0.9, 0.5] } else { mix(paper, ink, f32::from(u8::from(title)) * 0.9) }
    }));
    let thing = m.covered();
    let (columns, rows) = (1 + m.chance.below(3), 2 + m.chance.below(4));
    let cell = Vec2::new(m.between(0.5, 0.9), m.between(0.34, 0.5));
    let (board, depth) = (m.between(0.02, 0.05), m.between(0.28, 0.45));
    let width = columns as f32 * (cell.x + board) + board;
    let height = rows as f32 * (cell.y + board) + board;
    let plank = |size: Vec3| block(size, 0.12, 0.7);
    for column in 0..=columns {
        let x = -0.5 * width + 0.5 * board + column as f32 * (cell.x + board);
        m.add(frame, plank(Vec3::new(board, depth, height)).moved(Vec3::new(x, 0.0, 0.5 * height)));
    }
    for row in 0..=rows {
        let z = 0.5 * board + row as f32 * (cell.y + board);
        // A hair shallower and inside the sides, so that no faces coincide.
        let size = Vec3::new(width - 0.2 * board, depth - 0.01, board * 0.98);
        m.add(frame, plank(size).moved(Vec3::Z * z));
    }
    if m.maybe(0.75) {
        let back = if m.maybe(0.5) { frame } else { m.covered() };
        let panel = block(Vec3::new(width * 0.99, 0.015, height * 0.99), 0.4, 0.6);
        m.add(back, panel.moved(Vec3::new(0.0, 0.5 * depth, 0.5 * height)));
    }
    if m.maybe(0.5) {
        for x in [-1.0, 1.0] {
            for y in [-1.0, 1.0] {
                let foot = Vec3::new(x * (0.5 * width - 0.06), y * (0.5 * depth - 0.06), 0.0);
                m.add(frame, rod(foot - Vec3::Z * 0.12, foot, [0.02, 0.035], 8, 1));
            }
        }
    }
    let full = m.between(0.5, 0.95);
    for column in 0..columns {
        for row in 0..rows {
            let left = -0.5 * width + board + column as f32 * (cell.x + board);
            let corner = Vec3::new(left, -0.5 * depth, board + row as f32 * (cell.y + board));
            let room = Vec3::new(cell.x, depth, cell.y);
            match m.chance.below(8) {
                0 => {}
                1 => {
                    let radius = 0.32 * room.z.min(room.x);
                    let at = corner + Vec3::new(0.5 * room.x, 0.5 * room.y, radius);
                    m.add(thing, ball(Vec3::splat(radius), 16, 10).moved(at));
                }
                2 => {
                    let (r, h) = (0.28 * room.z, 0.75 * room.z);
                    let at = corner + Vec3::new(0.45 * room.x, 0.5 * room.y, 0.0);
                    let profile = [
                        (0.0, 0.0),
                        (0.6 * r, 0.0),
                        (r, 0.4 * h),
                        (0.4 * r, 0.8 * h),
                        (0.6 * r, h),
                        (0.0, h),
                    ];
                    m.add(thing, turned(&profile, 14, 12).moved(at));
                }
                3 => {
                    let mut z = 0.0;
                    while z < 0.6 * room.z {
                        let thick = m.between(0.03, 0.07);
                        let size = Vec3::new(room.y * 0.9, room.y * m.between(0.5, 0.75), thick);
                        let turn = Quat::from_rotation_z(m.between(-0.25, 0.25));
                        let at = corner + Vec3::new(0.4 * room.x, 0.45 * room.y, z + 0.5 * thick);
                        let tint = m.colour();
                        m.add(spine, block(size, 1.0, size.x).placed(turn, at).tinted(tint));
                        z += thick + 0.001;
                    }
                }
                _ => books(m, spine, corner, room, full),
            }
        }
    }
}

/// Books from the left, the last of them leaning.
fn books(m: &mut Maker, spine: u16, corner: Vec3, room: Vec3, full: f32) {
    let mut x = 0.01;
    let end = room.x * (full + m.between(-0.2, 0.05)).min(0.98);
    loop {
        let thick = m.between(0.025, 0.075);
        if x + thick > end {
            return;
        }
        let size = Vec3::new(thick, room.y * m.between(0.55, 0.85), room.z * m.between(0.55, 0.93));
        let lean = if m.maybe(0.06) { m.between(0.05, 0.2) } else { 0.0 };
        let at = corner + Vec3::new(x + 0.5 * thick, 0.02 + 0.5 * size.y, 0.5 * size.z);
        let tint = m.colour();
        let turn = Quat::from_rotation_y(-lean);
        m.add(spine, block(size, 1.0, size.z).placed(turn, at).tinted(tint));
        x += thick + lean * size.z * 0.5 + 0.003;
    }
}

pub(super) fn chair(m: &mut Maker) {
    match m.chance.below(4) {
        0 => swivel_chair(m),
        1 => armchair(m),
        _ => wooden_chair(m),
    }
}

fn wooden_chair(m: &mut Maker) {
    let tone = timber(m);
    let frame = m.printed(&WOODEN, [tone, scaled(tone, 0.6), scaled(tone, 1.2)]);
    let seat_cover = if m.maybe(0.5) { frame } else { m.covered() };
    let (wide, deep) = (m.between(0.4, 0.55), m.between(0.38, 0.5));
    let (seat, back) = (m.between(0.4, 0.62), m.between(0.0, 0.62));
    let has_back = back > 0.15;
    let (thick, splay) = (m.between(0.016, 0.035), m.between(0.0, 0.1));
    let lean = m.between(0.02, 0.14);
    let (n, square) = (m.cells(12), m.maybe(0.4));
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x * 0.45 * wide, y * 0.44 * deep, z);
    let leg = |from: Vec3, to: Vec3| {
        if square {
            rod(from, to, [thick, thick * 1.2], 4, 4)
        } else {
            rod(from, to, [thick * 0.7, thick], n, 5)
        }
    };
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            m.add(
                frame,
                leg(corner(x * (1.0 + splay), y * (1.0 + splay), 0.0), corner(x, y, seat)),
            );
        }
        if m.maybe(0.7) {
            let z = 0.35 * seat;
            m.add(frame, leg(corner(x, -1.0, z), corner(x, 1.0, z)));
        }
    }
    if m.maybe(0.5) {
        m.add(frame, leg(corner(-1.0, 0.0, 0.35 * seat), corner(1.0, 0.0, 0.35 * seat)));
    }
    let plate = m.between(0.03, 0.09);
    if m.maybe(0.25) {
        let round =
            extruded(oval(Vec2::new(0.66 * wide, 0.66 * deep), 0.0), plate, 0.02, m.cells(28), 4);
        m.add(seat_cover, round.moved(Vec3::Z * seat));
    } else {
        let seat_plate = cushion(Vec3::new(wide, deep, plate), 0.45 * plate, m.cells(4), 3);
        m.add(seat_cover, seat_plate.moved(Vec3::Z * seat));
    }
    if !has_back {
        return;
    }
    let post = |x: f32, t: f32| Vec3::new(x * 0.45 * wide, 0.44 * deep + lean * t, seat + back * t);
    for x in [-1.0, 1.0] {
        m.add(frame, leg(post(x, 0.0), post(x, 1.0)));
    }
    let bow = m.between(0.0, 0.06);
    let rail = |t: f32, tall: f32, m: &mut Maker| {
        let middle = 0.5 * (post(-1.0, t) + post(1.0, t));
        let slab = cushion(Vec3::new(0.9 * wide, 0.025, tall), 0.012, 6, 2);
        let slab = slab.warped(|p| p + Vec3::Y * bow * (1.0 - (p.x / (0.45 * wide)).powi(2)));
        m.add(frame, slab.moved(middle));
    };
    rail(0.93, m.between(0.05, 0.14), m);
    match m.chance.below(3) {
        0 => {
            for i in 1..=2 + m.chance.below(2) {
                rail(0.93 - 0.22 * i as f32, 0.05, m);
            }
        }
        1 => {
            let slats = 3 + m.chance.below(4);
            for i in 0..slats {
                let x = (i as f32 + 0.5) / slats as f32 * 2.0 - 1.0;
                let bend = Vec3::Y * bow * (1.0 - x * x);
                m.add(frame, rod(post(x, 0.0), post(x, 0.93) + bend, [0.012, 0.012], 8, 3));
            }
        }
        _ => {
            let pad = cushion(Vec3::new(0.8 * wide, 0.05, 0.6 * back), 0.024, m.cells(4), 3);
            m.add(seat_cover, pad.moved(0.5 * (post(-1.0, 0.5) + post(1.0, 0.5))));
        }
    }
    if m.maybe(0.25) {
        for x in [-1.0, 1.0] {
            let front = corner(x * 1.1, -0.9, seat);
            let elbow = front + Vec3::Z * 0.22;
            m.add(frame, leg(front, elbow));
            m.add(frame, leg(elbow, post(x * 1.05, 0.4)));
        }
    }
}

fn swivel_chair(m: &mut Maker) {
    let cover = m.covered();
    let metal = {
        let grey = m.between(0.1, 0.7);
        m.plain([grey; 3])
    };
    let (seat, wide) = (m.between(0.42, 0.52), m.between(0.44, 0.54));
    let arms = 4 + m.chance.below(2);
    let n = m.cells(12);
    for i in 0..arms {
        let angle = TURN * i as f32 / arms as f32;
        let out = Vec3::new(cos(angle), sin(angle), 0.0);
        m.add(metal, rod(Vec3::Z * 0.12, out * 0.3 + Vec3::Z * 0.07, [0.03, 0.018], 8, 2));
        m.add(metal, ball(Vec3::splat(0.035), 10, 6).moved(out * 0.3 + Vec3::Z * 0.035));
    }
    m.add(metal, rod(Vec3::Z * 0.08, Vec3::Z * seat, [0.035, 0.025], n, 3));
    let pad = cushion(Vec3::new(wide, wide, 0.09), 0.042, m.cells(5), 4);
    m.add(cover, pad.moved(Vec3::Z * seat));
    let (tall, bend) = (m.between(0.3, 0.65), m.between(0.05, 0.25));
    let back = cushion(Vec3::new(wide * 0.92, 0.07, tall), 0.033, m.cells(6), 3);
    let back = back.warped(|p| p - Vec3::Y * bend * p.x * p.x * 4.0);
    let lean = Quat::from_rotation_x(-m.between(0.05, 0.25));
    m.add(cover, back.placed(lean, Vec3::new(0.0, 0.5 * wide, seat + 0.14 + 0.5 * tall)));
    let stem = [
        Vec3::new(0.0, 0.2, seat - 0.03),
        Vec3::new(0.0, 0.54 * wide, seat),
        Vec3::new(0.0, 0.55 * wide, seat + 0.25),
    ];
    m.add(metal, pipe(&stem, 8, 10, |_| 0.02));
    if m.maybe(0.7) {
        for x in [-1.0, 1.0] {
            let at = |y: f32, z: f32| Vec3::new(x * (0.5 * wide + 0.03), y, seat + z);
            m.add(metal, pipe(&[at(0.05, -0.02), at(0.02, 0.12), at(0.0, 0.2)], 8, 6, |_| 0.016));
            let rest = cushion(Vec3::new(0.06, 0.26, 0.03), 0.014, 3, 2);
            m.add(metal, rest.moved(at(0.0, 0.21)));
        }
    }
}

fn armchair(m: &mut Maker) {
    let cover = m.covered();
    let seat_cover = if m.maybe(0.5) { cover } else { m.covered() };
    let leg = m.any_plain();
    let (wide, deep) =
        (m.between(0.6, 0.8) * if m.maybe(0.25) { 1.9 } else { 1.0 }, m.between(0.6, 0.75));
    let (arm, tall, back) = (m.between(0.1, 0.17), m.between(0.45, 0.6), m.between(0.7, 1.0));
    let n = m.cells(4);
    let body = cushion(Vec3::new(wide, deep, 0.3), 0.04, n, 2);
    m.add(cover, body.moved(Vec3::Z * 0.25));
    let pad = cushion(Vec3::new(wide - 2.0 * arm, deep - 0.08, 0.14), 0.06, n, 4);
    m.add(seat_cover, pad.moved(Vec3::new(0.0, -0.05, 0.43)));
    for x in [-1.0, 1.0] {
        let side = cushion(Vec3::new(arm, deep, tall - 0.1), 0.45 * arm, n, 4);
        m.add(
            cover,
            side.moved(Vec3::new(x * 0.5 * (wide - 0.8 * arm), 0.0, 0.1 + 0.5 * (tall - 0.1))),
        );
        for y in [-1.0, 1.0] {
            let foot = Vec3::new(x * (0.5 * wide - 0.06), y * (0.5 * deep - 0.06), 0.0);
            m.add(leg, rod(foot, foot + Vec3::Z * 0.12, [0.02, 0.03], 8, 1));
        }
    }
    let rest = cushion(Vec3::new(wide - 0.5 * arm, 0.18, back - 0.12), 0.08, n, 4);
    let lean = Quat::from_rotation_x(-m.between(0.05, 0.2));
    m.add(cover, rest.placed(lean, Vec3::new(0.0, 0.5 * deep - 0.06, 0.12 + 0.5 * (back - 0.12))));
    if m.maybe(0.5) {
        let pillow = m.covered();
        let turn = Quat::from_rotation_x(-0.35) * Quat::from_rotation_y(m.between(-0.5, 0.5));
        let soft = cushion(Vec3::new(0.3, 0.12, 0.3), 0.059, 3, 4);
        let at = Vec3::new(m.between(-0.1, 0.1), 0.15, 0.65);
        m.add(pillow, soft.placed(turn, at));
    }
}

pub(super) fn toilet(m: &mut Maker) {
    // China is mostly white, now and then of a colour that its decade liked.
    let china = if m.maybe(0.6) {
        hsv(m.between(0.1, 0.6), m.between(0.0, 0.06), m.between(0.85, 1.0))
    } else {
        m.colour()
    };
    let body = m.printed(
        &[Pattern::Plain, Pattern::Speckle, Pattern::Stone, Pattern::Scuffed],
        [china, scaled(china, 0.9), scaled(china, 0.75)],
    );
    let lid_cover = if m.maybe(0.5) { body } else { m.covered() };
    let grey = m.between(0.4, 0.8);
    let metal = m.plain([grey, grey, grey * 0.95]);
    let (wide, long) = (m.between(0.19, 0.24), m.between(0.25, 0.32));
    let (rim, n) = (m.between(0.38, 0.46), m.cells(30));
    let foot = m.between(0.5, 0.75);
    // Up outside, down inside to the water.
    let profile = [
        (0.0, 0.0),
        (foot, 0.0),
        (foot * 0.95, 0.08),
        (foot * 0.85, 0.3),
        (0.8, 0.62),
        (0.98, 0.85),
        (1.0, 0.97),
        (0.97, 1.0),
        (0.80, 1.0),
        (0.76, 0.93),
        (0.62, 0.72),
        (0.35, 0.58),
        (0.0, 0.55),
    ];
    let egg =
        |p: Vec3| Vec3::new(p.x * wide, p.y * long * if p.y < 0.0 { 1.0 } else { 0.8 }, p.z * rim);
    m.add(body, turned(&profile, n, m.cells(30)).boxed(2.0).warped(egg));
    let water = m.plain([0.35, 0.55, 0.65]);
    m.add(water, ball(Vec3::new(0.5 * wide, 0.5 * long, 0.004), 16, 4).moved(Vec3::Z * rim * 0.62));
    // The seat: a ring, and the lid, up or down.
    let ring = hoop(Vec2::new(0.88, 0.88), 0.11, 8, n).warped(|p| {
        Vec3::new(p.x * wide, p.y * long * if p.y < 0.0 { 1.0 } else { 0.8 }, p.z * 0.18)
    });
    m.add(lid_cover, ring.boxed(0.5).moved(Vec3::Z * (rim + 0.015)));
    let hinge = Vec3::new(0.0, long * 0.8, rim + 0.04);
    let lid = extruded(oval(Vec2::new(wide, 0.9 * long), 0.15), 0.025, 0.01, n, 4);
    let opened = if m.maybe(0.7) { m.between(1.45, 1.75) } else { 0.0 };
    let lid = lid.moved(Vec3::new(0.0, -0.9 * long, 0.012)).rotated(Quat::from_rotation_x(-opened));
    m.add(lid_cover, lid.moved(hinge));
    // A tank behind, with its cover and a lever or a button.
    let tank = Vec3::new(wide * m.between(1.8, 2.3), m.between(0.15, 0.2), m.between(0.3, 0.42));
    let behind = Vec3::new(0.0, 0.8 * long + 0.6 * tank.y + 0.06, rim + 0.02);
    m.add(body, cushion(tank, 0.03, m.cells(4), 3).moved(behind + Vec3::Z * 0.5 * tank.z));
    let top = cushion(Vec3::new(tank.x * 1.06, tank.y * 1.12, 0.035), 0.012, 4, 2);
    m.add(body, top.moved(behind + Vec3::Z * (tank.z + 0.015)));
    if m.maybe(0.5) {
        let at = behind + Vec3::new(-0.36 * tank.x, -0.54 * tank.y, 0.8 * tank.z);
        m.add(metal, limb(at, at + Vec3::new(0.09, -0.02, -0.01), [0.012, 0.009], 8, 8));
    } else {
        m.add(
            metal,
            rod(
                behind + Vec3::Z * tank.z,
                behind + Vec3::Z * (tank.z + 0.045),
                [0.03, 0.03],
                14,
                1,
            ),
        );
    }
    // What joins bowl and tank.
    let bridge = cushion(Vec3::new(1.2 * wide, 0.2, 0.14), 0.04, 3, 2);
    m.add(body, bridge.moved(Vec3::new(0.0, 0.8 * long + 0.05, rim - 0.06)));
    let neck = cushion(Vec3::new(1.0 * wide, 0.24, rim - 0.1), 0.05, 3, 2);
    m.add(body, neck.moved(Vec3::new(0.0, 0.7 * long, 0.5 * (rim - 0.1))));
}
