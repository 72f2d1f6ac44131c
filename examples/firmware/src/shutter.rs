//! A camera that a pin releases: photos that the controller does not see.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use vantage_core::soarnet::Photo;

use crate::rig::Camera;

/// An optocoupler across a camera's remote release, or a phone's headset button.
///
/// The network that goes with it is one that looks at poses alone.
#[derive(Clone, Debug)]
pub struct Shutter<P, W> {
    pin: P, // high closes the contact
    delay: W,
    press_ms: u32,
    exposure_ms: u32,
}

impl<P: OutputPin, W: DelayNs> Shutter<P, W> {
    /// Presses for `press_ms` and then keeps still for `exposure_ms`, until the photo is taken.
    pub fn new(pin: P, delay: W, press_ms: u32, exposure_ms: u32) -> Self {
        Self { pin, delay, press_ms, exposure_ms }
    }
}

impl<P: OutputPin, W: DelayNs> Camera for Shutter<P, W> {
    type Error = P::Error;

    fn photograph<'f>(&mut self, _frame: &'f mut [u8]) -> Result<Photo<'f>, P::Error> {
        self.pin.set_high()?;
        self.delay.delay_ms(self.press_ms);
        self.pin.set_low()?;
        self.delay.delay_ms(self.exposure_ms);
        Ok(Photo::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal_mock::eh1::MockError;
    use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
    use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
    use std::io::ErrorKind;

    #[test]
    fn a_photo_is_a_press_and_a_wait() {
        let mut pin = Mock::new(&[Transaction::set(State::High), Transaction::set(State::Low)]);
        let mut delay = CheckedDelay::new(&[Wait::delay_ms(150), Wait::delay_ms(800)]);
        let mut camera = Shutter::new(pin.clone(), delay.clone(), 150, 800);
        assert_eq!(camera.photograph(&mut []), Ok(Photo::default()));
        pin.done();
        delay.done();
    }

    #[test]
    fn a_pin_that_fails_is_no_photo() {
        let error = MockError::Io(ErrorKind::NotConnected);
        let mut pin = Mock::new(&[Transaction::set(State::High).with_error(error.clone())]);
        let mut camera = Shutter::new(pin.clone(), CheckedDelay::new(&[]), 1, 1);
        assert_eq!(camera.photograph(&mut []), Err(error));
        pin.done();
        camera.delay.done();
    }
}
