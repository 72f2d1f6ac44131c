//! Where a view lies, in words that a photographer can follow.

use vantage_core::Vec3;

/// Directions closer to the vertical than this have no side to speak of.
const STEEP_DEG: f32 = 75.0;

/// The elevation of a direction above the horizon, degrees.
pub fn elevation_deg(direction: Vec3) -> f32 {
    direction.z.clamp(-1.0, 1.0).asin().to_degrees()
}

/// The azimuth of a direction, anticlockwise from +x seen from above, degrees in (-180, 180].
pub fn azimuth_deg(direction: Vec3) -> f32 {
    direction.y.atan2(direction.x).to_degrees()
}

/// The direction of an azimuth and an elevation in degrees, unit length.
pub fn towards(azimuth_deg: f32, elevation_deg: f32) -> Vec3 {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    let (sin, cos) = azimuth.sin_cos();
    Vec3::new(cos, sin, 0.0) * elevation.cos() + Vec3::Z * elevation.sin()
}

/// How to get from one direction to another, both of unit length from the object's middle:
/// left and right are those of someone who stands at `from` and faces the object.
///
/// `from` is called by its name, as in `30 degrees to the left of photo 12, slightly higher`.
pub fn way(from: Vec3, to: Vec3, name: &str) -> String {
    let (low, high) = (elevation_deg(from), elevation_deg(to));
    if high > STEEP_DEG {
        return format!("from nearly straight above, nearest to {name}");
    }
    if high < -STEEP_DEG {
        return format!("from nearly straight below, nearest to {name}");
    }
    // Who faces the object has growing azimuths on the right-hand side.
    let turn = (azimuth_deg(to) - azimuth_deg(from) + 540.0).rem_euclid(360.0) - 180.0;
    let rise = high - low;
    let side = if turn > 0.0 { "right" } else { "left" };
    let rounded = turn.abs().round();
    let aside = match turn.abs() {
        _ if low.abs() > STEEP_DEG => format!("facing away from {name}"),
        turn if turn > 170.0 => format!("opposite {name}"),
        turn if turn >= 2.5 => {
            format!("{rounded:.0} degrees to the {side} of {name}")
        }
        _ => format!("straight at {name}"),
    };
    let steps = match rise.abs() {
        step if step < 2.5 => "at the same height",
        step if step < 15.0 => "slightly ",
        step if step > 40.0 => "much ",
        _ => "",
    };
    let higher = if rise > 0.0 { "higher" } else { "lower" };
    match (turn.abs() < 2.5, rise.abs() < 2.5) {
        (true, true) => format!("where {name} was taken"),
        (true, false) => {
            let side = if rise > 0.0 { "above" } else { "below" };
            format!("{:.0} degrees straight {side} {name}", rise.abs())
        }
        (false, true) => format!("{aside}, {steps}"),
        (false, false) => format!("{aside}, {steps}{higher}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_is_left_of_who_faces_the_object() {
        // At +x, facing -x with +z up, the right hand points to +y: to growing azimuths.
        let pose = vantage_core::Pose::looking_at(Vec3::X, Vec3::ZERO).unwrap();
        assert!(pose.right().y > 0.9);
        let words = way(towards(0.0, 10.0), towards(-30.0, 18.0), "photo 12");
        assert_eq!(words, "30 degrees to the left of photo 12, slightly higher");
        let words = way(towards(170.0, 10.0), towards(-170.0, 10.0), "photo 1");
        assert_eq!(words, "20 degrees to the right of photo 1, at the same height");
    }

    #[test]
    fn angles_and_directions_agree() {
        let direction = towards(-140.0, 35.0);
        assert!((azimuth_deg(direction) + 140.0).abs() < 1e-3);
        assert!((elevation_deg(direction) - 35.0).abs() < 1e-3);
    }

    #[test]
    fn every_direction_has_words() {
        let from = towards(0.0, 20.0);
        for (to, words) in [
            (towards(0.0, 20.0), "where it was taken"),
            (towards(1.0, 45.0), "25 degrees straight above it"),
            (towards(0.0, -20.0), "40 degrees straight below it"),
            (towards(178.0, 22.0), "opposite it, at the same height"),
            (towards(-90.0, 65.0), "90 degrees to the left of it, much higher"),
            (towards(90.0, 0.0), "90 degrees to the right of it, lower"),
            (Vec3::Z, "from nearly straight above, nearest to it"),
        ] {
            assert_eq!(way(from, to, "it"), words);
        }
    }
}
