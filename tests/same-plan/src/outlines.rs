//! What candidates would see of a visual hull: every number of every outlook.
//!
//! The network of the later sections draws outlines by chance; here they are those of three balls, drawn
//! with the four basic operations only, so that the hull has a shape.

use core::fmt::{self, Write};

use vantage_core::Vec3;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::soarnet::features::{Direction, Stance};
use vantage_core::soarnet::{COVER, DETAIL, Form, OUTLOOK, SKETCH};

const CANDIDATES: usize = 40;
const VIEWS: usize = 10;

/// Centres and radii of the balls, in radii of the bounding sphere.
const BALLS: [(Vec3, f32); 3] = [
    (Vec3::new(-0.4, 0.1, -0.2), 0.45),
    (Vec3::new(0.4, -0.2, 0.1), 0.35),
    (Vec3::new(0.1, 0.3, 0.6), 0.25),
];

/// Outlooks of all candidates after 1, 2, 5 and 10 photos of the balls.
pub fn outlooks(out: &mut dyn Write) -> fmt::Result {
    let pool =
        Pool::try_new(ViewSpace::FibonacciSphere, CANDIDATES, 3.0).map_err(|_| fmt::Error)?;
    let mut directions = [Direction::default(); CANDIDATES];
    for (place, pose) in directions.iter_mut().zip(pool.iter()) {
        *place = Direction::try_from_vector(pose.position()).ok_or(fmt::Error)?;
    }
    let mut views = [(Stance::default(), [0; SKETCH]); VIEWS];
    let mut form = Form::new();
    form.begin();
    // Far from each other: 13 has no common part with 40.
    let poses = (0..VIEWS).filter_map(|view| pool.pose(13 * view % CANDIDATES));
    for (view, pose) in poses.enumerate() {
        let stance = Stance::try_new(&pose, Vec3::ZERO).ok_or(fmt::Error)?;
        let place = views.get_mut(view).ok_or(fmt::Error)?;
        let eye = pose.position();
        *place = (stance, drawing(eye, pose.right(), pose.up(), eye * (-1.0 / 3.0)));
        form.take_in(&stance, &place.1);
        if ![1, 2, 5, VIEWS].contains(&(view + 1)) {
            continue;
        }
        writeln!(out, "after {}", view + 1)?;
        let seen = views.iter().take(view + 1).map(|(stance, sketch)| (stance, sketch.as_slice()));
        let mut outlooks = [[0; OUTLOOK]; CANDIDATES];
        form.outlooks(seen, &directions, &mut outlooks, |_, _| ());
        for (index, outlook) in outlooks.iter().enumerate() {
            writeln!(out, "  {index} {outlook:?}")?;
        }
    }
    Ok(())
}

/// The sketch of the balls: 4 x 4 rays for a cover, details by a rule without meaning.
fn drawing(eye: Vec3, right: Vec3, up: Vec3, forward: Vec3) -> [i8; SKETCH] {
    let mut sketch = [0; SKETCH];
    for (place, number) in sketch.iter_mut().enumerate() {
        *number = match place.checked_sub(COVER * COVER) {
            Some(detail) => (detail % DETAIL * 13 + detail / DETAIL * 3) as i8,
            None => {
                let rays = (0..16).filter(|ray| {
                    let across = (place % COVER * 4 + ray % 4) as f32 + 0.5;
                    let down = (place / COVER * 4 + ray / 4) as f32 + 0.5;
                    let x = (across / 32.0 - 1.0) * 0.36;
                    let y = (1.0 - down / 32.0) * 0.36;
                    hits(eye, forward + right * x + up * y)
                });
                (rays.count() * 127 / 16) as i8
            }
        };
    }
    sketch
}

/// Whether a ray meets a ball.
fn hits(eye: Vec3, ray: Vec3) -> bool {
    BALLS.iter().any(|&(centre, radius)| {
        let towards = centre - eye;
        let along = towards.dot(ray);
        let beside = towards.dot(towards) - along * along / ray.dot(ray);
        beside < radius * radius
    })
}
