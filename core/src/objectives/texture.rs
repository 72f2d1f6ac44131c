//! T's picture side: which pixels are textured (eqs. `obj_T_1`, `obj_T_2`).
//!
//! A local binary pattern with P = 3 neighbours at radius R = 3 on the hue and on the saturation
//! channel. With three neighbours no pattern is "non-uniform", so the histogram's last bin is the
//! all-ones code, every neighbour at least as bright as the centre, which flat pixels give; a pixel
//! is *textured* where the code is any other.
//!
//! Everything is integer, so that flat pixels never flip by rounding: channels have 8 bits, the
//! neighbours off the grid are interpolated with 12-bit weights and compared without a division.
//! A neighbour that is not inside (off the picture, or in the default reading off the object) reads
//! as the centre itself, so neither a border nor a silhouette makes texture.

/// Offsets of the three neighbours from the centre, in 1/4096 pixel: (right, down).
///
/// `(3 cos a, -3 sin a)` for a = 0, 120, 240 degrees, as scikit-image places them.
const NEIGHBOURS: [(i32, i32); 3] = [(3 * ONE, 0), (-6144, -10_642), (-6144, 10_642)];
const ONE: i32 = 1 << 12;

/// The code of a pixel whose neighbours are all at least as bright: the histogram's last bin.
pub const FLAT: u8 = 0b111;

/// The local binary pattern of the pixel at (x, y); bit i is set where neighbour i is at least as
/// bright as the centre.
///
/// `sample(x, y)` gives a channel's value, or `None` where the pixel is not inside. A centre that
/// is not inside has the code [`FLAT`].
pub fn local_binary_pattern(x: i32, y: i32, sample: impl Fn(i32, i32) -> Option<u8>) -> u8 {
    let Some(centre) = sample(x, y) else { return FLAT };
    let mut code = 0;
    for (bit, (right, down)) in NEIGHBOURS.into_iter().enumerate() {
        let (column, row) = (x + right.div_euclid(ONE), y + down.div_euclid(ONE));
        let (across, along) = (right.rem_euclid(ONE) as u32, down.rem_euclid(ONE) as u32);
        let one = ONE as u32;
        let taps = [
            (column, row, (one - across) * (one - along)),
            (column + 1, row, across * (one - along)),
            (column, row + 1, (one - across) * along),
            (column + 1, row + 1, across * along),
        ];
        // A tap of no weight is not looked at: it may be off the picture.
        let bright = taps
            .into_iter()
            .filter(|&(_, _, weight)| weight > 0)
            .try_fold(0u32, |sum, (column, row, weight)| {
                Some(sum + weight * u32::from(sample(column, row)?))
            });
        // The weights of one neighbour add up to 2^24.
        if bright.is_none_or(|bright| bright >= u32::from(centre) << 24) {
            code |= 1 << bit;
        }
    }
    code
}

/// Hue and saturation of a pixel, each in 0 ..= 255, rounded to the nearest.
///
/// Hue goes once around in 256 steps from red over green and blue; grey has hue 0, black
/// saturation 0.
pub fn hue_saturation([red, green, blue]: [u8; 3]) -> [u8; 2] {
    let (r, g, b) = (i32::from(red), i32::from(green), i32::from(blue));
    let brightest = r.max(g).max(b);
    let range = brightest - r.min(g).min(b);
    if range == 0 {
        return [0, 0];
    }
    // Sixths of the circle, in units of `range`.
    let sixths = if brightest == r {
        (g - b).rem_euclid(6 * range)
    } else if brightest == g {
        2 * range + b - r
    } else {
        4 * range + r - g
    };
    let hue = (sixths * 256 + 3 * range) / (6 * range);
    // The brightest is at least `range`, which is not 0.
    let saturation = (range * 255 + brightest / 2).checked_div(brightest).unwrap_or(0);
    [hue as u8, saturation as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_pixels_are_never_textured() {
        for value in 0..=255 {
            assert_eq!(local_binary_pattern(9, 9, |_, _| Some(value)), FLAT);
        }
    }

    #[test]
    fn each_neighbour_has_its_bit() {
        // Dark to the right of the centre only, and so on.
        let right = |x: i32, _: i32| Some(if x > 1 { 0 } else { 100 });
        assert_eq!(local_binary_pattern(0, 0, right), 0b110);
        let above = |_: i32, y: i32| Some(if y < -1 { 0 } else { 100 });
        assert_eq!(local_binary_pattern(0, 0, above), 0b101);
        let below = |_: i32, y: i32| Some(if y > 1 { 0 } else { 100 });
        assert_eq!(local_binary_pattern(0, 0, below), 0b011);
    }

    #[test]
    fn what_is_not_inside_reads_as_the_centre() {
        let alone = |x: i32, y: i32| (x == 0 && y == 0).then_some(77);
        assert_eq!(local_binary_pattern(0, 0, alone), FLAT);
        assert_eq!(local_binary_pattern(5, 5, alone), FLAT);
    }

    #[test]
    fn hues_of_pure_colours_divide_the_circle() {
        assert_eq!(hue_saturation([255, 0, 0]), [0, 255]);
        assert_eq!(hue_saturation([0, 255, 0]), [85, 255]);
        assert_eq!(hue_saturation([0, 0, 255]), [171, 255]);
        assert_eq!(hue_saturation([90, 90, 90]), [0, 0]);
        assert_eq!(hue_saturation([0, 0, 0]), [0, 0]);
        assert_eq!(hue_saturation([200, 100, 100]), [0, 128]);
        // Just below red the hue is near the top of its range, or rounds over to 0.
        assert_eq!(hue_saturation([255, 0, 10]), [254, 255]);
        assert_eq!(hue_saturation([255, 0, 1]), [0, 255]);
    }
}
