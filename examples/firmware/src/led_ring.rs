//! A ring of lights that points to where the camera goes: up is up, right is right.

use core::f32::consts::TAU;

use smart_leds_trait::{RGB8, SmartLedsWrite};
use vantage_core::planner::Finish;
use vantage_core::{Vec2, math};

use crate::rig::{Cue, Indicator};

/// Where it goes.
const WAY: RGB8 = RGB8::new(0, 16, 48);
/// Nearly there: less than a twelfth of a turn.
const NEAR: RGB8 = RGB8::new(0, 48, 0);
/// Not to be had.
const MISSED: RGB8 = RGB8::new(48, 0, 0);
/// Hold still.
const PHOTO: RGB8 = RGB8::new(32, 32, 32);
const DARK: RGB8 = RGB8::new(0, 0, 0);

/// `N` lights, clockwise from the top as one looks at them, behind any driver of `smart-leds`.
#[derive(Clone, Debug)]
pub struct LedRing<W, const N: usize> {
    lights: W,
}

impl<W: SmartLedsWrite<Color = RGB8>, const N: usize> LedRing<W, N> {
    /// A ring behind its driver.
    pub fn new(lights: W) -> Self {
        Self { lights }
    }
}

/// The colours of the lights.
fn colours<const N: usize>(cue: Cue) -> [RGB8; N] {
    match cue {
        Cue::Move { right_rad, up_rad } => {
            let way = Vec2::new(up_rad, right_rad);
            let colour = if way.length() < TAU / 12.0 { NEAR } else { WAY };
            let place = math::floor(way.to_angle() / TAU * N as f32 + 0.5) as i32;
            let place = place.rem_euclid(N.max(1) as i32) as usize;
            core::array::from_fn(|light| if light == place { colour } else { DARK })
        }
        Cue::Photo => [PHOTO; N],
        Cue::Missed => [MISSED; N],
        Cue::Done(Finish::BudgetSpent | Finish::GoodEnough) => [NEAR; N],
        // Half a ring: it ended before it had what was asked for.
        Cue::Done(Finish::NothingLeft) => {
            core::array::from_fn(|light| if light % 2 == 0 { NEAR } else { DARK })
        }
    }
}

impl<W: SmartLedsWrite<Color = RGB8>, const N: usize> Indicator for LedRing<W, N> {
    fn show(&mut self, cue: Cue) {
        // A broken light stops no capture.
        self.lights.write(colours::<N>(cue)).ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Remembers what was written.
    #[derive(Default)]
    struct Lights(Vec<RGB8>);

    impl SmartLedsWrite for Lights {
        type Error = ();
        type Color = RGB8;

        fn write<T, I>(&mut self, iterator: T) -> Result<(), ()>
        where
            T: IntoIterator<Item = I>,
            I: Into<RGB8>,
        {
            self.0 = iterator.into_iter().map(Into::into).collect();
            Ok(())
        }
    }

    /// A ring of twelve as one sees it: `*` for the way, `o` for nearly there.
    fn drawn(right_rad: f32, up_rad: f32) -> Vec<char> {
        let mut ring = LedRing::<Lights, 12>::new(Lights::default());
        ring.show(Cue::Move { right_rad, up_rad });
        let sign = |colour: &RGB8| match *colour {
            WAY => '*',
            NEAR => 'o',
            _ => '.',
        };
        ring.lights.0.iter().map(sign).collect()
    }

    #[test]
    fn the_light_points_to_the_next_view() {
        let at = |right, up| drawn(right, up).iter().position(|&sign| sign != '.');
        assert_eq!(at(0.0, 1.0), Some(0)); // up: twelve o'clock
        assert_eq!(at(1.0, 0.0), Some(3)); // right: three
        assert_eq!(at(0.0, -1.0), Some(6));
        assert_eq!(at(-1.0, 0.0), Some(9));
        assert_eq!(at(2.0, 2.0), Some(2)); // half past one, to the next full hour
        assert_eq!(at(-0.01, 1.0), Some(0));
        assert_eq!(at(f32::NAN, 1.0), Some(0));
    }

    #[test]
    fn the_colour_says_how_far_it_is() {
        assert_eq!(drawn(0.2, 0.1).iter().filter(|&&sign| sign == 'o').count(), 1);
        assert_eq!(drawn(1.5, 0.1).iter().filter(|&&sign| sign == '*').count(), 1);
    }

    #[test]
    fn the_whole_ring_says_what_is_going_on() {
        assert_eq!(colours::<4>(Cue::Photo), [PHOTO; 4]);
        assert_eq!(colours::<4>(Cue::Missed), [MISSED; 4]);
        assert_eq!(colours::<2>(Cue::Done(Finish::BudgetSpent)), [NEAR; 2]);
        assert_eq!(colours::<2>(Cue::Done(Finish::NothingLeft)), [NEAR, DARK]);
        assert_eq!(colours::<0>(Cue::Move { right_rad: 1.0, up_rad: 1.0 }), []);
    }
}
