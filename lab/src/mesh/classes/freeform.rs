//! Shapes that are nothing in particular, so that a network does not learn twenty things by heart.

use vantage_core::math::{cos, sin, unit};
use vantage_core::{Quat, Vec2, Vec3};

use super::implicit::{Bone, smooth_min, surface, union};
use super::maker::Maker;
use super::parts::{ball, cushion, extruded, hoop, limb, oval, pipe, rod, sheet, towards};
use crate::mesh::Mesh;
use crate::mesh::kit::{fractal, noise, step};
use crate::mesh::shapes::{Joined, TURN, block, patch, turned};

pub(super) fn freeform(m: &mut Maker) {
    match m.chance.below(12) {
        0 => pile(m),
        1 => melted(m),
        2 => tangle(m),
        3 => blob(m),
        4 => lattice(m),
        5 => dish(m),
        6 => sheets(m),
        7 => scatter(m),
        8 | 9 => cabinet(m),
        10 => service(m),
        _ => knot(m),
    }
}

fn direction(m: &mut Maker) -> Vec3 {
    let z = m.between(-1.0, 1.0);
    let (angle, ring) = (m.between(0.0, TURN), (1.0 - z * z).sqrt());
    Vec3::new(ring * cos(angle), ring * sin(angle), z)
}

fn turn(m: &mut Maker) -> Quat {
    towards(direction(m)) * Quat::from_rotation_z(m.between(0.0, TURN))
}

fn lengths(m: &mut Maker, low: f32, high: f32) -> Vec3 {
    Vec3::new(m.between(low, high), m.between(low, high), m.between(low, high))
}

/// A part of any simple shape, about 1 across and bent a little.
fn primitive(m: &mut Maker) -> Mesh {
    let n = m.cells(20);
    let mesh = match m.chance.below(6) {
        0 => ball(lengths(m, 0.25, 0.55), n, n / 2),
        1 => {
            let size = lengths(m, 0.3, 1.0);
            cushion(size, m.between(0.02, 0.3), 5, 3)
        }
        2 => {
            rod(Vec3::Z * -0.5, Vec3::Z * 0.5, [m.between(0.15, 0.45), m.between(0.05, 0.45)], n, 8)
        }
        3 => hoop(
            Vec2::new(m.between(0.3, 0.5), m.between(0.3, 0.5)),
            m.between(0.05, 0.18),
            8,
            n + 8,
        ),
        4 => {
            let half = Vec2::new(m.between(0.25, 0.55), m.between(0.25, 0.55));
            extruded(oval(half, m.between(0.0, 1.0)), m.between(0.1, 0.8), 0.03, n + 8, 4)
        }
        _ => {
            limb(Vec3::Z * -0.35, Vec3::Z * 0.35, [m.between(0.1, 0.3), m.between(0.1, 0.3)], n, 14)
        }
    };
    let (twist, bend, taper) = (m.between(-1.5, 1.5), m.between(-0.5, 0.5), m.between(-0.5, 0.5));
    mesh.warped(|p| {
        let (c, s) = (cos(twist * p.z), sin(twist * p.z));
        let wide = 1.0 + taper * p.z;
        let q = Vec3::new((p.x * c - p.y * s) * wide, (p.x * s + p.y * c) * wide, p.z);
        q + Vec3::X * bend * q.z * q.z
    })
}

/// Deformed primitives, each touching one before it.
fn pile(m: &mut Maker) {
    let covers = [m.covered(), m.covered(), m.covered()];
    let mut places = vec![Vec3::ZERO];
    for _ in 0..3 + m.chance.below(6) {
        let from = places[m.chance.below(places.len() as u32) as usize];
        let at = from + direction(m) * m.between(0.3, 0.75);
        let size = m.between(0.5, 1.3);
        let part = primitive(m).stretched(Vec3::splat(size));
        let turn = turn(m);
        let cover = m.pick(&covers);
        m.add(cover, part.placed(turn, at));
        places.push(at);
    }
}

/// A smooth union of bones with hollows cut out.
fn melted(m: &mut Maker) {
    let cover = m.covered();
    let mut bones = Vec::new();
    let mut from = Vec3::ZERO;
    for _ in 0..4 + m.chance.below(7) {
        let to = if m.maybe(0.3) { from } else { from * 0.6 + direction(m) * m.between(0.3, 0.8) };
        bones.push(Bone { from, to, radii: [m.between(0.08, 0.3), m.between(0.06, 0.3)] });
        if m.maybe(0.7) {
            from = to;
        }
    }
    let hollows: Vec<Bone> = (0..m.chance.below(4))
        .map(|_| Bone::ball(direction(m) * m.between(0.2, 0.7), m.between(0.12, 0.35)))
        .collect();
    let (blend, seed, rough) = (m.between(0.02, 0.25), m.chance.bits(), m.pick(&[0.0, 0.03, 0.1]));
    let field = |p: Vec3| {
        let solid = union(&bones, blend, p) + rough * (noise(p * 5.0, seed) - 0.5);
        hollows.iter().fold(solid, |solid, hollow| -smooth_min(-solid, hollow.distance(p), 0.04))
    };
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for bone in &bones {
        for (end, radius) in [bone.from, bone.to].into_iter().zip(bone.radii) {
            low = low.min(end - radius - 0.15);
            high = high.max(end + radius + 0.15);
        }
    }
    let cells = m.cells(32);
    m.add(cover, surface(low, high, cells, field));
}

/// Swept tubes through chance points.
fn tangle(m: &mut Maker) {
    let covers = [m.covered(), m.covered()];
    for _ in 0..1 + m.chance.below(5) {
        let spread = lengths(m, 0.4, 1.0);
        let points: Vec<Vec3> = (0..4 + m.chance.below(7))
            .map(|_| direction(m) * spread * m.between(0.2, 1.0))
            .collect();
        let (thick, waves, deep) =
            (m.between(0.03, 0.16), m.between(2.0, 12.0), m.pick(&[0.0, 0.2, 0.5]));
        let (around, along) = (m.cells(9), m.cells(60));
        let tube = pipe(&points, around, along, |t| thick * (1.0 + deep * sin(t * waves * TURN)));
        let cover = m.pick(&covers);
        let repeat = m.between(2.0, 8.0);
        m.add(cover, tube.tiled(1.0, repeat));
    }
}

/// A closed tube that winds around itself.
fn knot(m: &mut Maker) {
    let cover = m.covered();
    let (p, q) = m.pick(&[
        (2.0, 3.0),
        (3.0, 2.0),
        (2.0, 5.0),
        (3.0, 4.0),
        (1.0, 3.0),
        (1.0, 5.0),
        (0.0, 1.0),
    ]);
    let (small, high, thick) = (m.between(0.3, 0.5), m.between(0.5, 1.3), m.between(0.08, 0.2));
    let flat = m.between(0.4, 1.0);
    let middle = move |t: f32| {
        let (a, b) = (if p == 0.0 { t } else { t * p } * TURN, t * q * TURN);
        let ring = 1.0 + small * cos(b);
        Vec3::new(ring * cos(a), ring * sin(a), small * high * sin(b))
    };
    let tube = crate::mesh::shapes::tube(
        m.cells(12),
        m.cells(150),
        Joined::Ring,
        middle,
        |t| Vec3::new(0.2 * cos(t * TURN), 0.2 * sin(t * TURN), 1.0),
        move |t| thick * (1.0 + (1.0 - flat) * cos(t * 9.0 * TURN)),
    );
    let repeat = m.between(4.0, 12.0);
    m.add(cover, tube.tiled(1.0, repeat));
}

/// A lump of noise, round or angular, now and then terraced.
fn blob(m: &mut Maker) {
    let cover = m.covered();
    let (seed, scale, deep) = (m.chance.bits(), m.between(1.0, 4.0), m.between(0.3, 1.3));
    let (radii, octaves, ridged) = (lengths(m, 0.5, 1.0), 1 + m.chance.below(4), m.chance.below(3));
    let n = m.cells(60);
    let lump = ball(Vec3::ONE, n, n / 2).warped(|p| {
        let value = fractal(p * scale + 3.0, octaves, seed);
        let value = match ridged {
            0 => value,
            1 => 1.0 - 2.0 * (value - 0.5).abs(),
            _ => {
                let level = value * 6.0;
                (level.floor() + step(0.25, 0.75, level.fract())) / 6.0
            }
        };
        p * (1.0 + deep * (value - 0.5))
    });
    m.add(cover, lump.stretched(radii).tiled(2.0, 1.0));
    for _ in 0..m.chance.below(4) {
        let spike = m.covered();
        let (way, size) = (direction(m), m.between(0.05, 0.2));
        let tip = way * m.between(0.9, 1.5);
        m.add(spike, rod(way * 0.3, tip, [size, 0.02], 10, 6));
    }
}

/// Bars and balls on a grid, on a ball, or in a tower; some are missing.
fn lattice(m: &mut Maker) {
    let (bars, joints) = (m.covered(), m.any_plain());
    let (thick, full) = (m.between(0.02, 0.06), m.between(0.55, 1.0));
    let has_joints = m.maybe(0.5);
    let mut nodes = Vec::new();
    let mut edges = Vec::new();
    if m.maybe(0.5) {
        let size = [2 + m.chance.below(2), 2 + m.chance.below(2), 2 + m.chance.below(3)];
        let cell = lengths(m, 0.35, 0.7);
        let (shear, seed) = (m.between(-0.4, 0.4), m.chance.bits());
        for k in 0..=size[2] {
            for j in 0..=size[1] {
                for i in 0..=size[0] {
                    let p = Vec3::new(i as f32, j as f32, k as f32) * cell;
                    let shaken = Vec3::X * (noise(p * 3.0, seed) - 0.5) * 0.15;
                    nodes.push(p + Vec3::X * shear * p.z + shaken);
                    let here = nodes.len() as u32 - 1;
                    let row = size[0] + 1;
                    let steps = [(i, 1), (j, row), (k, row * (size[1] + 1))];
                    edges.extend(
                        steps.iter().filter(|(at, _)| *at > 0).map(|(_, back)| (here - back, here)),
                    );
                }
            }
        }
    } else {
        // Neighbours among points spread over a ball or a tube.
        let count = 18 + m.chance.below(22);
        let (tall, round) = (m.between(0.5, 1.6), m.maybe(0.5));
        for i in 0..count {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
            let angle = i as f32 * 2.399_963;
            let ring = if round { (1.0 - z * z).sqrt() } else { 0.45 };
            nodes.push(Vec3::new(ring * cos(angle), ring * sin(angle), z * tall));
        }
        for i in 0..count {
            let mut near: Vec<u32> = (0..count).filter(|&j| j != i).collect();
            let far = |j: u32| nodes[i as usize].distance_squared(nodes[j as usize]);
            near.sort_by(|a, b| far(*a).total_cmp(&far(*b)));
            edges.extend(near.iter().take(4).filter(|&&j| j > i).map(|&j| (i, j)));
        }
    }
    // A large lattice has bars of fewer sides.
    let round = if nodes.len() > 45 { 4 } else { 6 };
    for (i, j) in edges {
        if m.maybe(full) {
            m.add(bars, rod(nodes[i as usize], nodes[j as usize], [thick; 2], round, 1));
        }
    }
    for node in nodes {
        if has_joints && m.maybe(0.9) {
            m.add(joints, ball(Vec3::splat(thick * 2.0), 7, 4).moved(node));
        } else if m.maybe(0.1) {
            m.add(joints, ball(Vec3::splat(0.16), 12, 8).moved(node));
        }
    }
}

/// The profiles of a bowl or a tube, outside and inside.
fn vessel(wide: f32, tall: f32, wall: f32, belly: f32) -> [[(f32, f32); 5]; 2] {
    let outer = [
        (0.0, 0.0),
        (0.5 * wide, 0.0),
        (wide * belly, 0.4 * tall),
        (0.9 * wide, 0.8 * tall),
        (wide, tall),
    ];
    let inner = [
        (0.0, wall),
        (0.4 * wide, wall),
        (wide * belly - wall, 0.4 * tall),
        (0.9 * wide - wall, 0.8 * tall),
        (wide, tall),
    ];
    [outer, inner]
}

/// A box with a side or two open, boards across it and things between them.
fn cabinet(m: &mut Maker) {
    let (walls, boards) = (m.covered(), m.covered());
    let (size, wall) = (lengths(m, 0.5, 1.2), m.between(0.02, 0.06));
    let cell = m.cell(0.12);
    let plank = |size: Vec3| block(size, cell, 0.7);
    let open = [m.chance.below(6), m.chance.below(9)];
    for side in (0..6u32).filter(|side| !open.contains(side)) {
        let (axis, sign) = ((side / 2) as usize, 1.0 - 2.0 * (side % 2) as f32);
        // A hair smaller from axis to axis, so that no faces coincide.
        let mut panel = size * (1.0 - 0.004 * axis as f32);
        panel[axis] = wall;
        let mut at = Vec3::ZERO;
        at[axis] = sign * 0.5 * size[axis];
        m.add(walls, plank(panel).moved(at));
    }
    for _ in 0..m.chance.below(5) {
        let axis = m.chance.below(3) as usize;
        let mut board = size * Vec3::new(m.between(0.4, 0.98), m.between(0.4, 0.98), 0.96);
        board[axis] = wall * 0.7;
        let mut at =
            (size - board) * 0.5 * Vec3::new(m.pick(&[-1.0, 1.0]), m.pick(&[-1.0, 1.0]), 0.0);
        at[axis] = size[axis] * m.between(-0.35, 0.35);
        m.add(boards, plank(board).moved(at));
    }
    for _ in 0..m.chance.below(6) {
        let at = size
            * 0.5
            * Vec3::new(m.between(-0.7, 0.7), m.between(-0.7, 0.7), m.between(-0.7, 0.7));
        let (cover, turn) = (m.covered(), turn(m));
        let thing = primitive(m).stretched(Vec3::splat(size.min_element() * m.between(0.2, 0.5)));
        m.add(cover, thing.placed(turn, at));
    }
    if m.maybe(0.4) {
        // A lid or a drawer, ajar.
        let (cover, axis) = (m.covered(), m.chance.below(3) as usize);
        let mut panel = size * 0.9;
        panel[axis] = wall;
        let mut at = Vec3::ZERO;
        at[axis] = size[axis] * m.pick(&[-1.0, 1.0]) * m.between(0.55, 0.9);
        let tilt = Quat::from_rotation_x(m.between(-0.5, 0.5));
        m.add(cover, plank(panel).placed(tilt, at));
    }
}

/// Vessels and small things beside each other, on a board or on nothing.
fn service(m: &mut Maker) {
    let covers = [m.covered(), m.covered(), m.any_plain()];
    let count = 2 + m.chance.below(5);
    if m.maybe(0.5) {
        let half = Vec2::new(1.0, m.between(0.6, 1.0));
        let board = extruded(oval(half, m.between(0.0, 1.0)), 0.05, 0.02, 36, 6);
        m.add(covers[2], board);
    }
    for i in 0..count {
        let angle = TURN * (i as f32 + m.between(0.0, 0.5)) / count as f32;
        let at = Vec3::new(cos(angle), sin(angle), 0.04) * Vec3::new(0.62, 0.5, 1.0);
        let (wide, tall) = (m.between(0.12, 0.4), m.between(0.05, 0.6));
        let [outer, inner] = vessel(wide, tall, m.between(0.01, 0.04), m.between(0.4, 1.1));
        let (n, outside, inside) = (m.cells(22), m.pick(&covers), m.pick(&covers));
        if m.maybe(0.7) {
            m.add(outside, turned(&outer, n, m.cells(12)).moved(at));
            m.add(inside, turned(&inner, n, m.cells(10)).inside_out().moved(at));
        } else {
            let turn = turn(m);
            let thing = primitive(m).stretched(Vec3::splat(wide * 1.6));
            m.add(outside, thing.placed(turn, at + Vec3::Z * wide * 0.5));
        }
    }
}

/// Bowls, tubes and boxes that one can look into.
fn dish(m: &mut Maker) {
    let (outside, inside) = (m.covered(), m.covered());
    let (wide, tall, wall) = (m.between(0.5, 1.0), m.between(0.3, 1.6), m.between(0.03, 0.12));
    let (belly, n) = (m.between(0.3, 1.3), m.cells(40));
    let [outer, inner] = vessel(wide, tall, wall, belly);
    let (square, flutes) = (m.between(0.0, 0.5), m.pick(&[0.0, 0.0, 0.15]));
    let shaped = |p: Vec3| {
        let angle_like = unit(Vec3::new(p.x, p.y, 0.0)).unwrap_or(Vec3::X);
        let four = angle_like.x * angle_like.x * angle_like.y * angle_like.y * 4.0;
        Vec3::new(p.x, p.y, p.z + flutes * four * p.z)
            * Vec3::new(1.0 + square * four, 1.0 + square * four, 1.0)
    };
    m.add(outside, turned(&outer, n, m.cells(22)).warped(shaped).tiled(2.0, 1.0));
    m.add(inside, turned(&inner, n, m.cells(18)).warped(shaped).inside_out());
    for _ in 0..m.chance.below(7) {
        let size = m.between(0.1, 0.3) * wide;
        let spread = 0.4 * wide;
        let at = Vec3::new(m.between(-spread, spread), m.between(-spread, spread), wall + size);
        let cover = m.covered();
        let turn = turn(m);
        let thing = primitive(m).stretched(Vec3::splat(size * 1.6));
        m.add(cover, thing.placed(turn, at));
    }
    if m.maybe(0.3) {
        let points = [
            Vec3::new(wide * 0.9, 0.0, 0.7 * tall),
            Vec3::new(wide * 1.5, 0.0, 0.6 * tall),
            Vec3::new(wide * 0.9, 0.0, 0.2 * tall),
        ];
        m.add(outside, pipe(&points, 8, 14, |_| 0.06));
    }
}

/// Thin sheets: leaves, spirals, waves, fans of cards.
fn sheets(m: &mut Maker) {
    let covers = [m.covered(), m.covered()];
    let count = 1 + m.chance.below(6);
    let (kind, n) = (m.chance.below(4), m.cells(22));
    for i in 0..count {
        let (a, b, c) = (m.between(0.5, 1.0), m.between(0.3, 1.2), m.between(0.0, 0.4));
        let (waves, seed) = (m.between(0.5, 2.5), m.chance.bits());
        let mesh = sheet(n, n, 0.015, |u, v| {
            let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
            match kind {
                0 => Vec3::new(x * a, y * b, c * sin(waves * x * 0.5 * TURN) * cos(waves * y)),
                1 => {
                    let angle = u * TURN * waves;
                    let ring = 0.2 + 0.6 * u;
                    Vec3::new(ring * cos(angle), ring * sin(angle), y * b)
                }
                2 => {
                    let width = (1.0 - y * y).max(0.0).sqrt() + 0.02;
                    Vec3::new(x * 0.4 * a * width, y * b, 0.4 * y * y + c * x * x)
                }
                _ => Vec3::new(
                    x * a,
                    y * b,
                    0.8 * c * (fractal(Vec3::new(x, y, 0.0) * 2.0, 3, seed) - 0.5),
                ),
            }
        });
        let place = if count == 1 {
            Quat::from_rotation_x(0.2 * TURN)
        } else if kind == 2 {
            Quat::from_rotation_z(TURN * i as f32 / count as f32)
                * Quat::from_rotation_x(m.between(0.3, 1.2))
        } else {
            turn(m)
        };
        let at = if kind == 2 { place * Vec3::Y * b } else { direction(m) * 0.25 };
        let cover = m.pick(&covers);
        m.add(cover, mesh.placed(place, at));
    }
}

/// Many small things in clusters, on a plate or in the air.
fn scatter(m: &mut Maker) {
    let covers = [m.covered(), m.any_plain(), m.covered(), m.any_plain()];
    let on_plate = m.maybe(0.6);
    if on_plate {
        let plate = extruded(
            oval(Vec2::new(1.0, m.between(0.6, 1.0)), m.between(0.0, 1.0)),
            0.06,
            0.02,
            40,
            6,
        );
        m.add(covers[0], plate);
    }
    let clusters: Vec<Vec3> = (0..1 + m.chance.below(4)).map(|_| direction(m) * 0.6).collect();
    let [n8, n10, n12, n16] = [8, 10, 12, 16].map(|usual| m.few_cells(usual));
    for _ in 0..14 + m.chance.below(30) {
        let near = clusters[m.chance.below(clusters.len() as u32) as usize];
        let size = m.between(0.06, 0.2);
        let p = near + direction(m) * m.between(0.1, 0.4);
        let at = if on_plate { Vec3::new(p.x, p.y * 0.8, size * m.between(0.4, 3.0)) } else { p };
        let thing = match m.chance.below(4) {
            0 => ball(Vec3::splat(size), n12, m.few_cells(7)),
            1 => cushion(Vec3::splat(1.6 * size), 0.15 * size, 2, 1),
            2 => rod(Vec3::Z * -size, Vec3::Z * size, [size * 0.5, size * 0.5], n10, 2),
            _ => patch(n16, n8, Joined::Ring, |u, v| {
                let ring = 1.0 + 0.35 * cos(v * TURN);
                Vec3::new(ring * cos(u * TURN), ring * sin(u * TURN), 0.35 * sin(v * TURN)) * size
            }),
        };
        let turn = turn(m);
        let cover = m.pick(&covers);
        m.add(cover, thing.placed(turn, at));
    }
}
