//! Toys and beasts: a die, a football, a teddy bear, a lion.

use vantage_core::math::unit;
use vantage_core::{Quat, Vec2, Vec3};

use super::implicit::{Bone, surface, union};
use super::maker::Maker;
use super::paint::{Pattern, all_around};
use super::parts::{ball, cushion, hoop, limb, pipe, towards};
use crate::mesh::kit::{fractal, hsv, mix, noise, scaled, step};

/// Where the pips of a face stand, by its number less one.
const PIPS: [&[(f32, f32)]; 6] = [
    &[(0.0, 0.0)],
    &[(-1.0, -1.0), (1.0, 1.0)],
    &[(-1.0, -1.0), (0.0, 0.0), (1.0, 1.0)],
    &[(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)],
    &[(-1.0, -1.0), (-1.0, 1.0), (0.0, 0.0), (1.0, -1.0), (1.0, 1.0)],
    &[(-1.0, -1.0), (-1.0, 0.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0)],
];

pub(super) fn die(m: &mut Maker) {
    let cover = m.patterned(&[
        Pattern::Plain,
        Pattern::Plain,
        Pattern::Speckle,
        Pattern::Clouds,
        Pattern::Stone,
        Pattern::Wood,
        Pattern::Scuffed,
        Pattern::Patches,
    ]);
    let bright = m.maybe(0.5);
    let ink = if bright { hsv(m.chance.unit(), 0.1, 0.95) } else { scaled(m.colour(), 0.25) };
    let pip = m.plain(ink);
    let count = if m.maybe(0.75) { 1 } else { 2 };
    let (round, spread, size) =
        (m.between(0.08, 0.4), m.between(0.42, 0.54), m.between(0.13, 0.22));
    // Pips are sunk a little, flat, or stand out.
    let bulge = m.pick(&[0.02, 0.05, 0.14]);
    let flat = m.cells(if count == 1 { 8 } else { 4 });
    for i in 0..count {
        let turn = if i == 0 { Quat::IDENTITY } else { Quat::from_rotation_z(m.between(0.2, 1.3)) };
        let at = if i == 0 {
            Vec3::Z
        } else if m.maybe(0.5) {
            Vec3::new(m.between(-0.3, 0.3), 0.2, 3.0)
        } else {
            Vec3::new(2.6, m.between(-1.0, 1.0), 1.0)
        };
        let body = cushion(Vec3::splat(2.0), round, flat, 3);
        m.add(cover, body.placed(turn, at));
        // Opposite sides add up to seven.
        let sides = [
            (Vec3::Z, 0),
            (Vec3::NEG_Z, 5),
            (Vec3::X, 1),
            (Vec3::NEG_X, 4),
            (Vec3::Y, 2),
            (Vec3::NEG_Y, 3),
        ];
        for (way, number) in sides {
            for &(x, y) in PIPS[number] {
                let dot = ball(Vec3::new(size, size, bulge), 14, 4);
                let place = Vec3::new(x * spread, y * spread, 1.0);
                m.add(pip, dot.moved(place).rotated(towards(way)).placed(turn, at));
            }
        }
    }
}

pub(super) fn soccer_ball(m: &mut Maker) {
    let classic = m.maybe(0.5);
    let (pale, dark) = if classic { ([0.95; 3], [0.06; 3]) } else { (m.colour(), m.colour()) };
    let (seam, third) = (scaled(mix(pale, dark, 0.5), 0.5), m.colour());
    let golden = 1.618_034f32;
    let mut pentagons = Vec::new();
    let mut hexagons = Vec::new();
    for a in [-1.0f32, 1.0] {
        for b in [-1.0f32, 1.0] {
            for turn in 0..3 {
                let cycle = |p: [f32; 3]| Vec3::new(p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]);
                pentagons.extend(unit(cycle([0.0, a, b * golden])));
                hexagons.extend(unit(cycle([0.0, a * golden, b / golden])));
            }
        }
    }
    for i in 0..8 {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        hexagons.extend(unit(Vec3::new(sign(0), sign(1), sign(2))));
    }
    let turn =
        Quat::from_rotation_x(m.between(0.0, 6.0)) * Quat::from_rotation_z(m.between(0.0, 6.0));
    let style = m.chance.below(4);
    // For a direction: how near to the seam, and the panel. A pentagon is as far from its middle
    // as 0.349 of a radian, a hexagon 0.412: cosines 0.9398 and 0.9163 at the edges' middles.
    let panel = move |p: Vec3| -> (f32, usize) {
        let q = turn * p;
        let (mut best, mut second, mut which) = (f32::NEG_INFINITY, f32::NEG_INFINITY, 0);
        let all = pentagons.iter().map(|c| q.dot(*c) / 0.9393);
        for (i, value) in all.chain(hexagons.iter().map(|c| q.dot(*c) / 0.9153)).enumerate() {
            if value > best {
                (second, best, which) = (best, value, i);
            } else if value > second {
                second = value;
            }
        }
        (best - second, which)
    };
    let (grain, worn) = (m.chance.bits(), m.between(0.0, 0.35));
    let skin = all_around(192, |p| {
        let (gap, which) = panel(p);
        let colour = match (style, which < 12) {
            (0 | 1, true) => dark,
            (0 | 1, false) => pale,
            (2, true) => third,
            (2, false) => {
                if which % 3 == 0 {
                    dark
                } else {
                    pale
                }
            }
            (_, _) => mix(pale, dark, step(0.45, 0.55, noise(p * 2.0, grain))),
        };
        let dirt = scaled(colour, 1.0 - worn * fractal(p * 3.0, 3, grain));
        if gap < 0.012 { seam } else { dirt }
    });
    let skin = m.material(skin);
    let (n, deep, flat) =
        (m.cells(64), m.between(0.008, 0.03), if m.maybe(0.2) { m.between(0.6, 0.9) } else { 1.0 });
    let sphere = ball(Vec3::ONE, n, n / 2)
        .warped(|p| p * (1.0 - deep * (1.0 - step(0.0, 0.04, panel(p).0))));
    // A ball that lost its air stands on a flat side.
    let sphere = sphere
        .warped(|p| if p.z < -flat { Vec3::new(p.x, p.y, -flat + 0.1 * (p.z + flat)) } else { p });
    m.add(skin, sphere);
}

pub(super) fn teddy_bear(m: &mut Maker) {
    let fur_colour = if m.maybe(0.6) {
        hsv(m.between(0.05, 0.1), m.between(0.3, 0.65), m.between(0.3, 0.85))
    } else {
        m.colour()
    };
    let soft = [
        Pattern::Plain,
        Pattern::Speckle,
        Pattern::Clouds,
        Pattern::Weave,
        Pattern::Patches,
        Pattern::Dots,
    ];
    let fur = m.printed(&soft, [fur_colour, scaled(fur_colour, 0.7), scaled(fur_colour, 1.25)]);
    let light_colour = mix(fur_colour, [1.0, 0.95, 0.85], m.between(0.4, 0.8));
    let light = m.plain(light_colour);
    let black = m.plain([0.04; 3]);
    let sitting = m.maybe(0.65);
    let (belly, head) = (m.between(0.26, 0.34), m.between(0.24, 0.32));
    let tall = m.between(0.3, 0.38);
    let (seed, rough) = (m.chance.bits(), m.pick(&[0.0, 0.05, 0.12]));
    let furry = move |p: Vec3| p * (1.0 + rough * (noise(p * 9.0, seed) - 0.5));
    let n = m.cells(22);
    let part =
        |radii: Vec3| ball(Vec3::ONE, n, n / 2).warped(furry).stretched(radii).tiled(2.0, 1.0);
    let low = if sitting { 0.26 } else { 0.5 };
    let chest = Vec3::Z * low;
    m.add(fur, part(Vec3::new(belly, belly * 0.88, tall)).moved(chest));
    if m.maybe(0.6) {
        m.add(
            light,
            part(Vec3::new(belly * 0.7, belly * 0.5, tall * 0.7))
                .moved(chest + Vec3::new(0.0, -belly * 0.46, -0.02)),
        );
    }
    let face = chest + Vec3::new(m.between(-0.02, 0.02), -0.02, tall + head * 0.68);
    m.add(fur, part(Vec3::new(head * 1.08, head * 0.95, head)).moved(face));
    let snout = m.between(0.38, 0.5) * head;
    let muzzle = face + Vec3::new(0.0, -head * 0.85, -head * 0.25);
    m.add(light, part(Vec3::new(snout * 1.2, snout, snout * 0.85)).moved(muzzle));
    m.add(
        black,
        ball(Vec3::new(0.34, 0.22, 0.24) * snout, 12, 8)
            .moved(muzzle + Vec3::new(0.0, -snout * 0.92, snout * 0.35)),
    );
    m.add(
        black,
        limb(
            muzzle + Vec3::new(0.0, -snout, snout * 0.2),
            muzzle + Vec3::new(0.0, -snout * 0.95, -snout * 0.3),
            [0.008; 2],
            6,
            6,
        ),
    );
    let eye = head * m.between(0.09, 0.14);
    m.add_pair(
        black,
        ball(Vec3::splat(eye), 10, 7)
            .moved(face + Vec3::new(head * 0.38, -head * 0.85, head * 0.15)),
    );
    let ear = m.between(0.3, 0.46) * head;
    let ear_at = face + Vec3::new(head * 0.78, 0.0, head * 0.75);
    m.add_pair(fur, ball(Vec3::new(ear, ear * 0.5, ear), 14, 9).moved(ear_at));
    m.add_pair(
        light,
        ball(Vec3::new(ear, ear * 0.4, ear) * 0.65, 12, 7).moved(ear_at - Vec3::Y * ear * 0.35),
    );
    let (arm, swing) = (m.between(0.09, 0.13), m.between(-0.25, 0.3));
    let shoulder = chest + Vec3::new(belly * 0.8, -0.02, tall * 0.55);
    let hand = shoulder + Vec3::new(0.2, -0.14, -0.12 + swing);
    let along = m.cells(14);
    m.add_pair(fur, limb(shoulder, hand, [arm, arm * 1.15], n * 2 / 3, along).tiled(1.0, 2.0));
    m.add_pair(
        light,
        ball(Vec3::splat(arm * 0.75), 12, 8).moved(hand + Vec3::new(0.04, -0.06, -0.02)),
    );
    let leg = m.between(0.11, 0.15);
    let hip = chest + Vec3::new(belly * 0.6, -0.02, -tall * 0.62);
    let foot = if sitting {
        hip + Vec3::new(0.12, -0.33, -0.03)
    } else {
        Vec3::new(belly * 0.65, -0.02, leg)
    };
    m.add_pair(fur, limb(hip, foot, [leg, leg * 1.1], n * 2 / 3, along).tiled(1.0, 2.0));
    let sole =
        if sitting { Vec3::new(0.03, -leg * 0.95, 0.0) } else { Vec3::new(0.0, -leg * 0.8, -0.03) };
    let pad = if sitting { Vec3::new(0.75, 0.3, 0.85) } else { Vec3::new(0.8, 0.9, 0.6) };
    m.add_pair(light, ball(pad * leg, 14, 8).moved(foot + sole));
    m.add(
        fur,
        ball(Vec3::splat(0.09), 12, 8).moved(chest + Vec3::new(0.0, belly * 0.9, -tall * 0.55)),
    );
    if m.maybe(0.5) {
        let cloth = m.covered();
        let neck = face - Vec3::new(0.0, 0.0, head * 0.85);
        let bow = ball(Vec3::new(0.1, 0.05, 0.075), 12, 8).rotated(Quat::from_rotation_y(0.2));
        m.add_pair(cloth, bow.moved(neck + Vec3::new(0.1, -belly * 0.85, 0.0)));
        m.add(cloth, ball(Vec3::splat(0.04), 10, 6).moved(neck - Vec3::Y * belly * 0.88));
        m.add(cloth, hoop(Vec2::new(belly * 0.75, belly * 0.78), 0.03, 6, 24).moved(neck));
    }
}

pub(super) fn lion(m: &mut Maker) {
    let coat_colour = if m.maybe(0.7) {
        hsv(m.between(0.07, 0.12), m.between(0.3, 0.7), m.between(0.5, 0.95))
    } else {
        m.colour()
    };
    let coat = m.printed(
        &[
            Pattern::Plain,
            Pattern::Speckle,
            Pattern::Clouds,
            Pattern::Stone,
            Pattern::Scuffed,
            Pattern::Patches,
        ],
        [coat_colour, scaled(coat_colour, 0.8), scaled(coat_colour, 1.2)],
    );
    let mane_colour = if m.maybe(0.7) {
        hsv(m.between(0.03, 0.08), m.between(0.5, 0.8), m.between(0.2, 0.6))
    } else {
        m.colour()
    };
    let mane = m.printed(
        &[Pattern::Stripes, Pattern::Speckle, Pattern::Clouds, Pattern::Plain],
        [mane_colour, scaled(mane_colour, 0.6), scaled(mane_colour, 1.3)],
    );
    let (dark, light) = (m.plain([0.05, 0.04, 0.04]), m.plain(mix(coat_colour, [1.0; 3], 0.55)));
    let (posture, stout) = (m.chance.below(3), m.between(0.85, 1.2));
    // The lion faces -y. Points of the skeleton: hips, shoulders, head; then its legs.
    let (hips, shoulders, head) = match posture {
        0 => (Vec3::new(0.0, 0.45, 0.55), Vec3::new(0.0, -0.3, 0.6), Vec3::new(0.0, -0.62, 0.92)),
        1 => (Vec3::new(0.0, 0.3, 0.22), Vec3::new(0.0, -0.12, 0.68), Vec3::new(0.0, -0.3, 1.08)),
        _ => (Vec3::new(0.0, 0.45, 0.2), Vec3::new(0.0, -0.3, 0.27), Vec3::new(0.0, -0.55, 0.62)),
    };
    let bone =
        |from: Vec3, to: Vec3, a: f32, b: f32| Bone { from, to, radii: [a * stout, b * stout] };
    let skull = m.between(0.17, 0.22);
    let mut bones = vec![bone(hips, shoulders, 0.19, 0.23), bone(shoulders, head, 0.17, 0.13)];
    bones.push(bone(head, head, skull, skull));
    bones.push(bone(
        head + Vec3::new(0.0, -0.14, -0.04),
        head + Vec3::new(0.0, -0.24, -0.06),
        0.12,
        0.09,
    ));
    let stride = m.between(-0.1, 0.1);
    for x in [-1.0f32, 1.0] {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let (hip, arm) = (hips + at(x * 0.12, 0.0, 0.0), shoulders + at(x * 0.13, -0.02, 0.0));
        let ear = head + at(x * 0.14, 0.0, 0.17);
        bones.push(Bone::ball(ear, 0.055));
        let legs = match posture {
            0 => [
                [
                    hip,
                    at(x * 0.16, hips.y + 0.06 + x * stride, 0.3),
                    at(x * 0.16, hips.y + x * stride, 0.06),
                ],
                [
                    arm,
                    at(x * 0.15, shoulders.y - x * stride, 0.3),
                    at(x * 0.15, shoulders.y - x * stride, 0.06),
                ],
            ],
            1 => [
                [hip + at(0.0, 0.02, 0.0), at(x * 0.26, -0.02, 0.2), at(x * 0.24, -0.08, 0.06)],
                [
                    arm,
                    at(x * 0.14, shoulders.y - 0.1, 0.32),
                    at(x * 0.14, shoulders.y - 0.14, 0.06),
                ],
            ],
            _ => [
                [hip, at(x * 0.26, hips.y - 0.16, 0.16), at(x * 0.26, hips.y - 0.3, 0.06)],
                [
                    arm,
                    at(x * 0.18, shoulders.y - 0.1, 0.08),
                    at(x * 0.17, shoulders.y - 0.45, 0.06),
                ],
            ],
        };
        for [top, knee, foot] in legs {
            bones.push(bone(top, knee, 0.13, 0.08));
            bones.push(bone(knee, foot, 0.075, 0.06));
            bones.push(bone(foot, foot - Vec3::Y * 0.09, 0.07, 0.06));
        }
    }
    let reach = 0.34;
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for bone in &bones {
        for end in [bone.from, bone.to] {
            low = low.min(end - reach);
            high = high.max(end + reach);
        }
    }
    let cells = m.cells(36);
    m.add(coat, surface(low, high, cells, |p| union(&bones, 0.07, p)));
    if m.maybe(0.85) {
        // The mane: a lumpy collar behind the face.
        let (seed, full) = (m.chance.bits(), m.between(0.9, 1.25));
        let n = m.cells(30);
        let tufts =
            ball(Vec3::ONE, n, n * 2 / 3).warped(|p| p * (0.85 + 0.4 * fractal(p * 3.5, 2, seed)));
        let collar = tufts.stretched(Vec3::new(0.33, 0.24, 0.36) * full).tiled(5.0, 1.0);
        m.add(mane, collar.moved(head + Vec3::new(0.0, 0.13, -0.07)));
    }
    m.add_pair(
        dark,
        ball(Vec3::splat(0.032), 10, 6).moved(head + Vec3::new(0.085, -skull * stout * 0.9, 0.07)),
    );
    m.add(
        dark,
        ball(Vec3::new(0.05, 0.035, 0.035), 10, 6)
            .moved(head + Vec3::new(0.0, -0.24 - 0.085 * stout, -0.02)),
    );
    m.add_pair(
        light,
        ball(Vec3::new(0.06, 0.05, 0.045), 10, 7)
            .moved(head + Vec3::new(0.045, -0.24 - 0.06 * stout, -0.085)),
    );
    let rump = hips + Vec3::new(0.0, 0.17, 0.05);
    let side = m.between(-0.3, 0.3);
    let lift = if posture == 0 { m.between(-0.3, 0.25) } else { 0.0 };
    let tip = Vec3::new(side, rump.y + 0.36, (rump.z + lift).max(0.05));
    let points = [
        rump,
        rump + Vec3::new(0.2 * side, 0.2, 0.02),
        0.5 * (rump + tip) + Vec3::new(side * 0.5, 0.16, -0.05),
        tip,
    ];
    m.add(coat, pipe(&points, 8, 16, |t| 0.04 - 0.012 * t));
    m.add(mane, ball(Vec3::new(0.06, 0.1, 0.06), 12, 8).moved(tip));
    if m.maybe(0.3) {
        // On a plinth, as a statue.
        let base = m.patterned(&[Pattern::Stone, Pattern::Plain, Pattern::Speckle]);
        let tall = m.between(0.06, 0.3);
        let slab = cushion(Vec3::new(0.8, 1.6, tall), 0.02, m.cells(5), 1);
        m.add(base, slab.moved(Vec3::new(0.0, -0.05, -0.5 * tall + 0.01)));
    }
}
