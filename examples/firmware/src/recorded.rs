//! A rig that plays a recording, and the plan that comes of it: the same code on the host and in QEMU.
//!
//! The photos, the poses reached and the mishaps are the recording's. What moves is a [`PanTilt`] head
//! whose pins count, so that steps and directions are those of a real one.

use core::cell::Cell;
use core::convert::Infallible;
use core::fmt::{self, Write};

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};
use golden_sessions::{CANDIDATES, Mishap, Recording, VIEWS};
use smart_leds_trait::{RGB8, SmartLedsWrite};
use vantage_core::planner::{self, Session};
use vantage_core::soarnet::{self, Image, ImageError, Model, Photo, SoarNet};
use vantage_core::{Objective, Pose, Scores};

use crate::guide::{Outcome, guide};
use crate::led_ring::LedRing;
use crate::pan_tilt::PanTilt;
use crate::rig::{Camera, Miss, Mount, Rig};
use crate::stepper::{Ramp, Stepper};

/// Lights of the ring in the plan's text.
const LIGHTS: usize = 12;

/// A pin that counts how often it rose.
#[derive(Clone, Copy, Debug, Default)]
pub struct CountingPin {
    rises: u32,
}

impl ErrorType for CountingPin {
    type Error = Infallible;
}

impl OutputPin for CountingPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.rises = self.rises.wrapping_add(1);
        Ok(())
    }
}

/// A pin elsewhere, so that its count can be read while a motor has it.
struct Wire<'a>(&'a Cell<CountingPin>);

impl ErrorType for Wire<'_> {
    type Error = Infallible;
}

impl OutputPin for Wire<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let mut pin = self.0.get();
        pin.set_high()?;
        self.0.set(pin);
        Ok(())
    }
}

/// A recording does not wait.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoWait;

impl DelayNs for NoWait {
    fn delay_ns(&mut self, _ns: u32) {}
}

/// The frames of a recording.
#[derive(Debug)]
pub struct RecordedCamera<'a> {
    recording: Recording<'a>,
    at: &'a Cell<usize>, // the candidate that the mount stands at
}

impl Camera for RecordedCamera<'_> {
    type Error = ImageError;

    fn photograph<'f>(&mut self, frame: &'f mut [u8]) -> Result<Photo<'f>, ImageError> {
        let recorded = self.recording.entry(self.at.get()).map(|entry| entry.frame);
        let recorded = recorded.ok_or(ImageError::Empty)?;
        let missing = ImageError::Length { expected: recorded.len() as u64, got: frame.len() };
        let frame = frame.get_mut(..recorded.len()).ok_or(missing)?;
        frame.copy_from_slice(recorded);
        let header = self.recording.header();
        let (width, height) = (header.width.into(), header.height.into());
        Ok(Photo::new(Image::try_new(width, height, header.pixels, frame)?))
    }
}

/// The poses and mishaps of a recording, with a head that really turns.
#[derive(Debug)]
pub struct RecordedMount<'a, H> {
    recording: Recording<'a>,
    head: H,
    at: &'a Cell<usize>,
    missed: u128, // a bit for each candidate that was missed once
}

impl<H: Mount> Mount for RecordedMount<'_, H> {
    type Error = H::Error;

    fn move_to(&mut self, pose: &Pose) -> Result<Pose, Miss<H::Error>> {
        let index = self.recording.candidates().position(|candidate| candidate == *pose);
        let index = index.ok_or(Miss::OutOfReach)?;
        let entry = self.recording.entry(index).ok_or(Miss::OutOfReach)?;
        let bit = 1 << (index % 128);
        match entry.mishap {
            Mishap::Blocked | Mishap::Elsewhere => return Err(Miss::OutOfReach),
            Mishap::Missed if self.missed & bit == 0 => {
                self.missed |= bit;
                return Err(Miss::NotNow);
            }
            Mishap::None | Mishap::Missed => {}
        }
        self.head.move_to(pose)?;
        self.at.set(index);
        Ok(entry.reached)
    }
}

/// The ring's lights as text: `*` for the way, `o` for one nearly there.
struct Lights<'a>(&'a Cell<[char; LIGHTS]>);

impl SmartLedsWrite for Lights<'_> {
    type Error = Infallible;
    type Color = RGB8;

    fn write<T, I>(&mut self, colours: T) -> Result<(), Infallible>
    where
        T: IntoIterator<Item = I>,
        I: Into<RGB8>,
    {
        let mut shown = ['.'; LIGHTS];
        for (place, colour) in shown.iter_mut().zip(colours) {
            let RGB8 { r, g, b } = colour.into();
            *place = match (r > 0, g > 0, b > 0) {
                (false, _, true) => '*',
                (false, true, false) => 'o',
                _ => '.',
            };
        }
        // The whole ring tells of photos and mishaps, which the text says in words.
        if shown.iter().filter(|sign| **sign != '.').count() == 1 {
            self.0.set(shown);
        }
        Ok(())
    }
}

/// All memory of a capture but its stack.
#[derive(Debug)]
pub struct Memory {
    lists: planner::Fixed<CANDIDATES, VIEWS>,
    network: soarnet::Fixed<CANDIDATES, VIEWS>,
    frame: [u8; 64 * 64 * 3],
}

impl Memory {
    /// Zeros, which cost no flash in a `static`.
    pub const fn new() -> Self {
        Self {
            lists: planner::Fixed::new(),
            network: soarnet::Fixed::new(),
            frame: [0; 64 * 64 * 3],
        }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

/// Carries a recorded capture out and writes its plan: a line for each view with its candidate, the
/// objective that chose it, its gain as bits, the ring's lights and what came of it; then how it ended,
/// the scores, and the steps of the motors.
pub fn recorded_plan(
    out: &mut dyn Write,
    recording: &Recording<'_>,
    model: &[u8],
    memory: &mut Memory,
) -> fmt::Result {
    let Memory { lists, network, frame } = memory;
    let model = Model::parse(model).map_err(|_| fmt::Error)?;
    let header = recording.header();
    let plan = header.plan().ok_or(fmt::Error)?;
    let scorer = SoarNet::try_new(model, network, header.centre, recording.candidates())
        .map_err(|_| fmt::Error)?;
    let mut session =
        Session::try_new(lists, recording.candidates(), scorer, plan).map_err(|_| fmt::Error)?;

    let [pan, tilt, unread, also] = [const { Cell::new(CountingPin { rises: 0 }) }; 4];
    let ring = Cell::new(['.'; LIGHTS]);
    let at = Cell::new(0);
    let motor = |step, direction| Stepper::new(Wire(step), Wire(direction), 3200, Ramp::default());
    let head =
        PanTilt::new(motor(&pan, &unread), motor(&tilt, &also), NoWait, header.centre, 3.0, 250)
            .with_limits(-3.2..=3.2, -1.6..=1.6);
    let mut rig = Rig {
        camera: RecordedCamera { recording: *recording, at: &at },
        mount: RecordedMount { recording: *recording, head, at: &at, missed: 0 },
        indicator: LedRing::<_, LIGHTS>::new(Lights(&ring)),
    };

    let mut written = Ok(());
    let end = guide(&mut session, &mut rig, frame, |_, step| {
        let letter = step.next.objective.map_or('-', Objective::letter);
        let outcome = match step.outcome {
            Outcome::Photo => "photo",
            Outcome::OutOfReach => "out of reach",
            Outcome::Missed => "missed",
            Outcome::Refused => "refused",
        };
        let mut line = || {
            write!(out, "{:3} {letter} {:08x} ", step.next.index, step.next.gain.to_bits())?;
            ring.get().iter().try_for_each(|sign| write!(out, "{sign}"))?;
            writeln!(out, " {outcome}")
        };
        written = written.and_then(|()| line());
    });
    written?;
    write!(out, "{end} after {} photos; scores", session.views().len())?;
    let Scores { coverage, geometry, diversity, texture } = session.scores();
    for score in [coverage, geometry, diversity, texture] {
        write!(out, " {:08x}", score.to_bits())?;
    }
    writeln!(out, "; {} steps of pan, {} of tilt", pan.get().rises, tilt.get().rises)
}

#[cfg(test)]
mod tests {
    use super::*;
    use golden_sessions::{MODEL, SESSIONS};
    use std::string::String;

    #[test]
    fn a_recorded_capture_meets_its_mishaps_and_spends_its_budget() {
        let mut memory = std::boxed::Box::new(Memory::new());
        for (name, bytes) in SESSIONS {
            let recording = Recording::parse(bytes).unwrap();
            let mut text = String::new();
            recorded_plan(&mut text, &recording, MODEL, &mut memory).unwrap();
            let photos = text.lines().filter(|line| line.ends_with(" photo")).count();
            assert!(text.contains("out of reach") && text.contains("missed"), "{name}\n{text}");
            assert!(!text.contains("refused"), "{name}\n{text}");
            let end = text.lines().last().unwrap();
            assert!(end.contains(&std::format!("after {photos} photos")), "{name}: {end}");
            assert!(photos >= 10, "{name}: {end}");
            assert!(!end.contains(" 0 steps"), "{name}: {end}");
        }
    }
}
