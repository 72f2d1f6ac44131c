//! Mostly turned on a lathe: a cone, a globe, a fire hydrant, a snowman, a vase.

use vantage_core::math::{cos, sin, unit};
use vantage_core::{Quat, Vec2, Vec3};

use super::maker::Maker;
use super::paint::{Pattern, all_around, tile_noise};
use super::parts::{ball, cushion, extruded, hoop, limb, oval, pipe, rod, towards};
use crate::mesh::kit::{fractal, hsv, mix, noise, painted, scaled, step};
use crate::mesh::shapes::{TURN, turned};

pub(super) fn cone(m: &mut Maker) {
    match m.chance.below(4) {
        0 => ice_cream(m),
        1 => plain_cone(m),
        _ => traffic_cone(m),
    }
}

fn traffic_cone(m: &mut Maker) {
    let hue = if m.maybe(0.6) { m.between(0.01, 0.1) } else { m.chance.unit() };
    let (bright, pale) = (
        hsv(hue, m.between(0.7, 1.0), m.between(0.7, 1.0)),
        hsv(m.between(0.0, 0.2), 0.05, m.between(0.75, 1.0)),
    );
    let (bands, share) = (1.0 + m.chance.below(3) as f32, m.between(0.3, 0.55));
    let (grain, dirt) = (m.chance.bits(), m.between(0.0, 0.5));
    let skin = m.material(painted("cone", 96, |u, v| {
        let stripe = v > 0.12 && v < 0.78 && ((v - 0.12) / 0.66 * bands).fract() > 1.0 - share;
        let colour = if stripe { pale } else { bright };
        let spot = step(0.5, 0.8, tile_noise(u, v, 6, grain));
        scaled(
            mix(colour, [0.25, 0.22, 0.2], dirt * spot),
            0.9 + 0.15 * tile_noise(u, v, 40, grain),
        )
    }));
    let base = if m.maybe(0.6) { m.plain(scaled(bright, 0.9)) } else { m.plain([0.12; 3]) };
    let (foot, tip, tall) = (m.between(0.26, 0.36), m.between(0.04, 0.07), m.between(0.75, 1.15));
    let (side, n) = (m.between(0.85, 1.1), m.cells(32));
    let profile = [
        (0.0, 0.0),
        (foot, 0.0),
        (foot, 0.02),
        (tip, tall),
        (tip * 0.8, tall),
        (tip * 0.7, tall - 0.15),
        (0.0, tall - 0.2),
    ];
    m.add(skin, straight(&profile, n, m.cells(10)).moved(Vec3::Z * 0.04));
    let is_square = m.maybe(0.8);
    if is_square {
        let plate = cushion(Vec3::new(side, side, 0.06), 0.025, m.cells(5), 2);
        m.add(base, plate.moved(Vec3::Z * 0.03));
    } else {
        m.add(base, rod(Vec3::ZERO, Vec3::Z * 0.06, [0.5 * side, 0.45 * side], n, 2));
    }
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0].into_iter().filter(|_| is_square) {
            let pad = cushion(Vec3::new(0.16, 0.16, 0.04), 0.015, 2, 1);
            m.add(base, pad.moved(Vec3::new(x, y, 0.0) * (0.5 * side - 0.1)));
        }
    }
}

/// [`turned`], with straight lines between the points of the profile.
fn straight(profile: &[(f32, f32)], around: u32, along: u32) -> crate::mesh::Mesh {
    let mut fine = Vec::new();
    for pair in profile.windows(2) {
        let length = Vec2::from(pair[0]).distance(Vec2::from(pair[1]));
        let steps = (length * along as f32).ceil().max(1.0);
        for i in 0..steps as u32 {
            let t = i as f32 / steps;
            fine.push((
                pair[0].0 + (pair[1].0 - pair[0].0) * t,
                pair[0].1 + (pair[1].1 - pair[0].1) * t,
            ));
        }
    }
    fine.extend(profile.last());
    turned(&fine, around, fine.len() as u32 - 1)
}

fn ice_cream(m: &mut Maker) {
    let (light, dark) = (hsv(0.09, m.between(0.4, 0.6), 0.85), hsv(0.07, 0.6, 0.55));
    let lines = 8.0 + m.chance.below(6) as f32;
    let waffle = m.material(painted("waffle", 128, |u, v| {
        let (a, b) = ((u * lines + v * lines).fract(), (u * lines - v * lines + 40.0).fract());
        if a.min(b) < 0.16 { dark } else { light }
    }));
    let (top, tall, n) = (m.between(0.2, 0.28), m.between(0.6, 0.9), m.cells(32));
    let profile = [
        (0.0, 0.0),
        (0.02, 0.0),
        (top, tall),
        (top * 1.12, tall + 0.02),
        (top * 1.12, tall + 0.1),
        (top, tall + 0.1),
        (top * 0.9, tall),
        (0.0, tall),
    ];
    m.add(waffle, straight(&profile, n, m.cells(20)));
    let scoops = 1 + m.chance.below(3);
    let mut z = tall + 0.12;
    let mut radius = top * m.between(1.05, 1.25);
    for _ in 0..scoops {
        let cream = m.patterned(&[
            Pattern::Speckle,
            Pattern::Clouds,
            Pattern::Patches,
            Pattern::Dots,
            Pattern::Plain,
        ]);
        let (seed, rough) = (m.chance.bits(), m.between(0.04, 0.14));
        let lumps = |p: Vec3| {
            let skirt = 0.18 * step(0.2, 0.75, -p.z) * noise(p * 3.0, seed ^ 1);
            p * (1.0 + rough * (fractal(p * 3.0, 3, seed) - 0.5) + skirt)
        };
        let scoop = ball(Vec3::ONE, n, m.cells(22)).warped(lumps).stretched(Vec3::splat(radius));
        let at = Vec3::new(m.between(-0.02, 0.02), 0.0, z);
        m.add(cream, scoop.tiled(2.0, 1.0).moved(at));
        z += radius * 1.25;
        radius *= m.between(0.8, 0.98);
    }
    if m.maybe(0.5) {
        let cherry = m.plain([0.75, 0.05, 0.1]);
        m.add(cherry, ball(Vec3::splat(0.07), 14, 10).moved(Vec3::Z * (z - radius * 0.2)));
        m.add(
            cherry,
            rod(Vec3::Z * (z - radius * 0.1), Vec3::new(0.05, 0.02, z + 0.1), [0.006; 2], 5, 3),
        );
    }
}

fn plain_cone(m: &mut Maker) {
    let skin = m.covered();
    let (foot, tall, n) = (m.between(0.25, 0.55), m.between(0.7, 1.3), m.cells(36));
    let tip = m.pick(&[0.0, 0.0, 0.1, 0.25]) * foot;
    m.add(
        skin,
        straight(&[(0.0, 0.0), (foot, 0.0), (tip, tall), (0.0, tall)], n, m.cells(16))
            .tiled(3.0, 1.0),
    );
    if m.maybe(0.5) {
        // A party hat: a brim and a pompom.
        let trim = m.covered();
        m.add(trim, hoop(Vec2::splat(foot), 0.05, 8, n).moved(Vec3::Z * 0.03));
        let seed = m.chance.bits();
        let tuft = ball(Vec3::ONE, 20, 14).warped(|p| p * (0.8 + 0.5 * noise(p * 6.0, seed)));
        m.add(trim, tuft.stretched(Vec3::splat(0.1)).moved(Vec3::Z * tall));
    }
}

pub(super) fn globe(m: &mut Maker) {
    let (seed, level) = (m.chance.bits(), m.between(0.5, 0.56));
    let antique = m.maybe(0.3);
    let (sea, land, high) = if antique {
        (hsv(0.11, 0.3, 0.85), hsv(0.08, 0.5, 0.6), hsv(0.05, 0.6, 0.4))
    } else if m.maybe(0.6) {
        (
            hsv(m.between(0.53, 0.64), m.between(0.4, 0.9), m.between(0.4, 0.9)),
            hsv(m.between(0.2, 0.36), m.between(0.4, 0.8), m.between(0.4, 0.8)),
            hsv(0.1, 0.45, 0.7),
        )
    } else {
        (m.colour(), m.colour(), m.colour())
    };
    let (grid, frost) = (m.maybe(0.6), m.maybe(0.6));
    let map = m.material(all_around(160, |p| {
        let ground = fractal(p * 1.8 + 7.0, 4, seed);
        let colour = if ground > level {
            mix(land, high, step(level + 0.02, level + 0.14, ground))
        } else {
            scaled(sea, 0.8 + 0.4 * ground)
        };
        let colour = if frost && p.z.abs() > 0.9 { [0.95; 3] } else { colour };
        // Parallels and meridians are where a multiple of 15 degrees is near.
        let polar = vantage_core::math::acos(p.z.clamp(-1.0, 1.0)) / TURN * 24.0;
        let near = (polar - polar.round()).abs();
        if grid && near < 0.06 { scaled(colour, 0.65) } else { colour }
    }));
    let frame = if m.maybe(0.5) {
        m.printed(&[Pattern::Wood], [hsv(0.07, 0.6, 0.5), hsv(0.06, 0.6, 0.3), [0.3; 3]])
    } else {
        m.patterned(&[Pattern::Plain, Pattern::Speckle, Pattern::Scuffed])
    };
    let (n, tilt) = (m.cells(44), m.between(0.0, 0.5));
    let lift = m.between(1.3, 1.75);
    let turn = Quat::from_rotation_y(tilt);
    m.add(map, ball(Vec3::ONE, n, n / 2).placed(turn, Vec3::Z * lift));
    let arc = m.between(1.06, 1.16);
    // A meridian of half a circle or a whole one, with the axis' pins.
    let whole = m.maybe(0.3);
    let (from, to) = if whole { (0.25, 1.25) } else { (0.2, 0.8) };
    let points: Vec<Vec3> = (0..=16)
        .map(|i| {
            let angle = TURN * (from + (to - from) * i as f32 / 16.0 + 0.0);
            Vec3::new(arc * cos(angle), 0.0, arc * sin(angle))
        })
        .collect();
    let thick = m.between(0.03, 0.06);
    let meridian = pipe(&points, 8, 40, |_| thick);
    m.add(frame, meridian.placed(turn, Vec3::Z * lift));
    for end in [-1.0, 1.0] {
        let pin = rod(Vec3::Z * end * 0.97, Vec3::Z * end * (arc + 0.08), [0.04, 0.03], 8, 1);
        m.add(frame, pin.placed(turn, Vec3::Z * lift));
    }
    let (foot, n) = (m.between(0.5, 0.8), m.cells(28));
    let neck = m.between(0.06, 0.12);
    let low = lift - arc;
    let profile = [
        (0.0, 0.0),
        (foot, 0.0),
        (foot, 0.06),
        (foot * 0.7, 0.12),
        (neck, 0.2),
        (neck * 1.4, 0.5 * (0.2 + low)),
        (neck, low),
        (0.0, low + 0.02),
    ];
    m.add(frame, turned(&profile, n, m.cells(22)));
    if m.maybe(0.25) {
        // A table's horizon, on four legs.
        let rim = 1.35;
        m.add(frame, hoop(Vec2::splat(rim), 0.07, 8, n).moved(Vec3::Z * lift));
        for i in 0..4 {
            let angle = TURN * (i as f32 + 0.5) / 4.0;
            let out = Vec3::new(cos(angle), sin(angle), 0.0) * rim;
            m.add(frame, rod(out * 0.8, out + Vec3::Z * lift, [0.05, 0.06], 8, 4));
        }
    }
}

pub(super) fn fireplug(m: &mut Maker) {
    let body_colour = if m.maybe(0.5) {
        hsv(m.pick(&[0.0, 0.0, 0.13, 0.6]), m.between(0.7, 0.95), m.between(0.5, 0.9))
    } else {
        m.colour()
    };
    let other = m.colour();
    let paint = [Pattern::Plain, Pattern::Scuffed, Pattern::Speckle, Pattern::Clouds];
    let rust = hsv(0.06, 0.6, 0.35);
    let body = m.printed(&paint, [body_colour, rust, scaled(body_colour, 0.7)]);
    let caps =
        if m.maybe(0.5) { body } else { m.printed(&paint, [other, rust, scaled(other, 0.7)]) };
    let (r, tall) = (m.between(0.17, 0.24), m.between(0.75, 1.0));
    let (n, rows) = (m.cells(28), m.cells(26));
    let profile = [
        (0.0, 0.0),
        (1.5 * r, 0.0),
        (1.5 * r, 0.05),
        (1.05 * r, 0.07),
        (r, 0.12),
        (0.95 * r, 0.68 * tall),
        (1.25 * r, 0.7 * tall),
        (1.25 * r, 0.74 * tall),
        (1.05 * r, 0.75 * tall),
    ];
    let mut lower: Vec<(f32, f32)> = profile.to_vec();
    lower.push((0.0, 0.75 * tall));
    m.add(body, straight(&lower, n, rows).tiled(2.0, 1.0));
    let dome = m.between(0.7, 1.2);
    let cap: Vec<(f32, f32)> = (0..=8)
        .map(|i| {
            let angle = TURN * 0.25 * i as f32 / 8.0;
            (1.1 * r * cos(angle), 0.75 * tall + dome * r * sin(angle))
        })
        .collect();
    m.add(caps, turned(&cap, n, 14).tiled(2.0, 1.0));
    let top = 0.75 * tall + dome * r;
    m.add(caps, rod(Vec3::Z * (top - 0.02), Vec3::Z * (top + 0.07), [0.05, 0.045], 5, 1));
    // Bolts around the flanges.
    let bolts = 6 + m.chance.below(5);
    for (z, radius) in [(0.07, 1.35 * r), (0.76 * tall, 1.15 * r)] {
        for i in 0..bolts {
            let angle = TURN * i as f32 / bolts as f32;
            let at = Vec3::new(radius * cos(angle), radius * sin(angle), z);
            m.add(caps, rod(at - Vec3::Z * 0.03, at + Vec3::Z * 0.02, [0.02, 0.018], 6, 1));
        }
    }
    // Nozzles: two at the sides, a larger one in front.
    let z = m.between(0.5, 0.6) * tall;
    let nozzle = |m: &mut Maker, way: Vec3, size: f32| {
        let from = way * 0.8 * r + Vec3::Z * z;
        let steps = [
            (0.0, size),
            (r * 0.65, size),
            (r * 0.65, size * 1.25),
            (r * 0.95, size * 1.25),
            (r * 1.0, size * 1.1),
            (r * 1.0, 0.0),
        ];
        let profile: Vec<(f32, f32)> = steps.iter().map(|&(h, radius)| (radius, h)).collect();
        m.add(caps, straight(&profile, 18, 14).placed(towards(way), from));
        let nut = rod(Vec3::ZERO, Vec3::Z * 0.05, [0.035, 0.035], 5, 1);
        m.add(caps, nut.placed(towards(way), from + way * r));
    };
    let size = m.between(0.4, 0.5) * r;
    nozzle(m, Vec3::X, size);
    nozzle(m, Vec3::NEG_X, size);
    if m.maybe(0.75) {
        nozzle(m, Vec3::NEG_Y, size * 1.35);
    }
    if m.maybe(0.5) {
        // A chain that hangs from a nozzle.
        let metal = m.plain([0.45; 3]);
        let points = [
            Vec3::new(1.7 * r, -0.02, z),
            Vec3::new(1.6 * r, -0.08, z - 0.2),
            Vec3::new(1.1 * r, -0.1, z - 0.12),
            Vec3::new(0.9 * r, -0.1, z - 0.05),
        ];
        m.add(
            metal,
            pipe(&points, 6, 24, |t| if (t * 12.0).fract() < 0.5 { 0.016 } else { 0.009 }),
        );
    }
}

pub(super) fn snowman(m: &mut Maker) {
    let tint = if m.maybe(0.75) {
        hsv(m.between(0.5, 0.65), m.between(0.0, 0.12), m.between(0.85, 1.0))
    } else {
        m.colour()
    };
    let snow = m.printed(
        &[Pattern::Plain, Pattern::Speckle, Pattern::Clouds, Pattern::Stone],
        [tint, scaled(tint, 0.86), scaled(tint, 0.95)],
    );
    let balls = 2 + m.chance.below(5).min(1);
    let (mut radius, shrink) = (m.between(0.36, 0.46), m.between(0.66, 0.8));
    let (mut z, seed, rough) = (0.0, m.chance.bits(), m.between(0.0, 0.1));
    let (n, mut heads) = (m.cells(28), Vec::new());
    for i in 0..balls {
        z += radius * if i == 0 { 0.85 } else { 0.8 };
        let lumpy = |p: Vec3| p * (1.0 + rough * (fractal(p * 2.5, 3, seed ^ u64::from(i)) - 0.5));
        let flat = m.between(0.88, 1.0);
        let part = ball(Vec3::ONE, n, n / 2).warped(lumpy).stretched(Vec3::new(
            radius,
            radius,
            radius * flat,
        ));
        m.add(snow, part.tiled(2.0, 1.0).moved(Vec3::Z * z));
        heads.push((z, radius));
        z += radius * 0.8;
        radius *= shrink;
    }
    let (head, r) = heads[heads.len() - 1];
    let (body, body_r) = heads[heads.len() - 2];
    let coal = {
        let grey = m.between(0.02, 0.15);
        m.plain([grey; 3])
    };
    let on = |z: f32, r: f32, side: f32, up: f32| {
        let way = unit(Vec3::new(side, -1.0, up)).unwrap_or(Vec3::NEG_Y);
        Vec3::Z * z + way * r
    };
    for side in [-0.35, 0.35] {
        m.add(coal, ball(Vec3::splat(0.13 * r), 10, 6).moved(on(head, r * 0.97, side, 0.3)));
    }
    for i in 0..5 {
        let side = (i as f32 - 2.0) * 0.2;
        m.add(
            coal,
            ball(Vec3::splat(0.07 * r), 8, 5).moved(on(head, r * 0.97, side, -0.55 + side * side)),
        );
    }
    let buttons = m.covered();
    for i in 0..2 + m.chance.below(2) {
        m.add(
            buttons,
            ball(Vec3::splat(0.11 * r), 10, 6).moved(on(
                body,
                body_r * 0.96,
                0.0,
                0.45 - 0.4 * i as f32,
            )),
        );
    }
    let carrot = m.printed(
        &[Pattern::Bands, Pattern::Plain],
        [hsv(0.07, 0.85, 0.95), hsv(0.06, 0.9, 0.8), hsv(0.05, 0.9, 0.7)],
    );
    let long = m.between(0.5, 1.1) * r;
    let tip = on(head, r + long, m.between(-0.1, 0.1), 0.0);
    m.add(carrot, rod(on(head, r * 0.9, 0.0, -0.05), tip, [0.15 * r, 0.01], 12, 6));
    let stick = m.printed(&[Pattern::Wood], [hsv(0.07, 0.5, 0.4), hsv(0.07, 0.5, 0.2), [0.2; 3]]);
    for side in [-1.0, 1.0] {
        if m.maybe(0.9) {
            let shoulder = Vec3::new(side * 0.85 * body_r, 0.0, body + 0.3 * body_r);
            let elbow = shoulder + Vec3::new(side * 0.25, -0.08, m.between(-0.05, 0.15));
            let hand = elbow + Vec3::new(side * 0.2, m.between(-0.1, 0.1), m.between(0.0, 0.25));
            m.add(stick, pipe(&[shoulder, elbow, hand], 7, 10, |t| 0.025 - 0.012 * t));
            for twig in [-0.1, 0.1] {
                m.add(
                    stick,
                    rod(
                        elbow.lerp(hand, 0.7),
                        hand + Vec3::new(side * 0.04, twig, 0.06),
                        [0.012, 0.006],
                        5,
                        2,
                    ),
                );
            }
        }
    }
    if m.maybe(0.75) {
        let hat = m.patterned(&[Pattern::Plain, Pattern::Weave, Pattern::Bands, Pattern::Checks]);
        let (brim, tall) = (m.between(0.9, 1.2) * r, m.between(0.6, 1.3) * r);
        let lift = head + 0.72 * r;
        let tilt = Quat::from_rotation_y(m.between(-0.2, 0.2));
        if m.maybe(0.65) {
            let profile = [
                (0.0, 0.0),
                (brim, 0.0),
                (brim, 0.04),
                (0.62 * brim, 0.05),
                (0.58 * brim, tall),
                (0.0, tall),
            ];
            m.add(hat, straight(&profile, n, 14).placed(tilt, Vec3::Z * lift));
        } else {
            // A bobble hat.
            let profile = [
                (0.0, 0.0),
                (0.85 * r, 0.0),
                (0.9 * r, 0.2 * r),
                (0.8 * r, 0.5 * r),
                (0.4 * r, 0.85 * r),
                (0.0, 0.95 * r),
            ];
            m.add(
                hat,
                turned(&profile, n, 14).tiled(3.0, 1.0).placed(tilt, Vec3::Z * (lift - 0.2 * r)),
            );
            let bobble = m.covered();
            m.add(bobble, ball(Vec3::splat(0.24 * r), 14, 10).moved(Vec3::Z * (lift + 0.8 * r)));
        }
    }
    if m.maybe(0.7) {
        let scarf = m.patterned(&[
            Pattern::Stripes,
            Pattern::Checks,
            Pattern::Bands,
            Pattern::Weave,
            Pattern::Dots,
        ]);
        let (neck, wide) = (head - 0.8 * r, 0.75 * r);
        m.add(scarf, hoop(Vec2::splat(wide), 0.2 * r, 10, n).tiled(6.0, 1.0).moved(Vec3::Z * neck));
        let end = cushion(Vec3::new(0.3 * r, 0.1 * r, m.between(0.7, 1.3) * r), 0.04 * r, 4, 2);
        m.add(
            scarf,
            end.placed(
                Quat::from_rotation_x(0.25),
                Vec3::new(0.4 * r, -body_r * 0.85, neck - 0.4 * r),
            ),
        );
    }
}

pub(super) fn vase(m: &mut Maker) {
    let glaze = m.covered();
    let lining = m.any_plain();
    let (n, rows) = (m.cells(40), m.cells(40));
    // A random profile: foot, belly, shoulder, neck, lip.
    let foot = m.between(0.15, 0.35);
    let belly = m.between(0.3, 0.6);
    let neck = m.between(0.1, 0.32);
    let lip = neck * m.between(1.0, 1.9);
    let tall = m.between(0.8, 1.7);
    let (low, high) = (m.between(0.2, 0.6), m.between(0.72, 0.88));
    let outside = vec![
        (foot, 0.0),
        (foot * 1.02, 0.03),
        (0.6 * foot + 0.4 * belly, 0.45 * low * tall),
        (belly, low * tall),
        (0.5 * (belly + neck), 0.5 * (low + high) * tall),
        (neck, high * tall),
        (lip, tall),
    ];
    let wall = m.between(0.02, 0.045);
    let mut profile = vec![(0.0, 0.0)];
    profile.extend(&outside);
    profile.push(((lip - wall).max(0.02), tall));
    // Down the inside as far as one can see.
    for &(radius, z) in outside.iter().rev().skip(1).take(5) {
        profile.push(((radius - wall).max(0.02), z.max(wall)));
    }
    profile.push((0.0, wall + 0.02));
    let (flutes, deep, twist) = (
        m.pick(&[0.0, 0.0, 6.0, 8.0, 12.0, 20.0]),
        m.between(0.02, 0.09),
        m.pick(&[0.0, 0.0, 1.5, -2.5]),
    );
    let square = if m.maybe(0.2) { m.between(0.4, 0.9) } else { 0.0 };
    let shaped = |p: Vec3| {
        let mut flat = Vec2::new(p.x, p.y);
        let r = flat.length();
        if r < 1e-6 {
            return p;
        }
        let way = flat / r;
        let (c2, s2) = (way.x * way.x, way.y * way.y);
        let boxy = 1.0 / (c2 * c2 + s2 * s2).sqrt().sqrt();
        flat *= 1.0 + square * 0.8 * (boxy - 1.0);
        if flutes > 0.0 {
            // The angle times the number of flutes, by repeated rotation.
            let (mut c, mut s) = (cos(twist * p.z), sin(twist * p.z));
            for _ in 0..flutes as u32 {
                (c, s) = (c * way.x - s * way.y, s * way.x + c * way.y);
            }
            flat *= 1.0 + deep * c;
        }
        flat.extend(p.z)
    };
    let body = turned(&profile, n.max(if flutes > 8.0 { 60 } else { 0 }), rows + 6).warped(shaped);
    let repeat = m.pick(&[1.0, 2.0, 3.0]);
    let down = m.between(1.0, 2.5);
    m.add(glaze, body.tiled(repeat, down));
    let (handles, reach) = (m.chance.below(3), m.between(0.1, 0.28));
    for side in [-1.0, 1.0].into_iter().take(handles as usize) {
        let at = |r: f32, t: f32| Vec3::new(side * r, 0.0, t * tall);
        let points = [
            at(neck * 0.95, high),
            at(0.5 * (neck + belly) + reach, 0.6 * high + 0.4 * low + 0.1),
            at(belly + reach * 0.4, 0.5 * (low + high)),
            at(belly * 0.9, low),
        ];
        m.add(lining, pipe(&points, 8, 20, |_| 0.032));
    }
    if m.maybe(0.25) {
        // Flowers.
        let stem = m.plain(hsv(0.3, 0.6, 0.4));
        let petal = m.patterned(&[Pattern::Plain, Pattern::Bands, Pattern::Gradient]);
        let middle = m.plain(hsv(0.13, 0.9, 0.9));
        for i in 0..3 + m.chance.below(4) {
            let angle = TURN * (i as f32 * 0.381_97) + m.between(-0.3, 0.3);
            let out = Vec3::new(cos(angle), sin(angle), 0.0) * m.between(0.1, 0.45);
            let top = out + Vec3::Z * (tall + m.between(0.2, 0.5));
            m.add(
                stem,
                pipe(&[Vec3::Z * (0.5 * tall), out * 0.25 + Vec3::Z * tall, top], 6, 8, |_| 0.013),
            );
            let face = towards(out * 1.5 + Vec3::Z);
            m.add(middle, ball(Vec3::new(0.05, 0.05, 0.03), 10, 6).placed(face, top));
            for k in 0..6 {
                let turn = face * Quat::from_rotation_z(TURN * k as f32 / 6.0);
                let leaf = ball(Vec3::new(0.07, 0.04, 0.012), 8, 6).moved(Vec3::X * 0.09);
                m.add(petal, leaf.placed(turn, top));
            }
        }
    }
    if m.maybe(0.2) {
        let saucer = extruded(oval(Vec2::splat(foot * 1.6), 0.0), 0.05, 0.02, n, 3);
        m.add(lining, saucer.moved(Vec3::Z * -0.02));
        m.add(
            lining,
            limb(
                Vec3::new(foot * 1.5, 0.0, 0.0),
                Vec3::new(foot * 1.9, 0.0, 0.03),
                [0.03, 0.03],
                8,
                8,
            ),
        );
    }
}
