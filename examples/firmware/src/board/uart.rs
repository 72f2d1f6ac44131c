//! The first serial port of the `mps2` boards: a CMSDK APB UART (Arm DDI 0479, chapter 4.3).

use core::ptr;

/// Its registers.
#[derive(Debug)]
pub struct Uart {
    _private: (),
}

const BASE: usize = 0x4000_4000;
const DATA: *mut u32 = BASE as *mut u32;
const STATE: *const u32 = (BASE + 4) as *const u32;
const CONTROL: *mut u32 = (BASE + 8) as *mut u32;
const DIVIDER: *mut u32 = (BASE + 16) as *mut u32;

const SEND_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 2;

impl Uart {
    /// Switches the port on: 25 MHz by 217, 115,200 bits a second.
    ///
    /// # Safety
    ///
    /// The program runs on an `mps2` board and has no other [`Uart`].
    pub unsafe fn new() -> Self {
        // SAFETY: the caller says that these are the port's registers; no one else writes them.
        unsafe {
            ptr::write_volatile(DIVIDER, 217);
            ptr::write_volatile(CONTROL, 3); // send and receive
        }
        Self { _private: () }
    }

    /// The next byte, if one has come.
    pub fn receive(&mut self) -> Option<u8> {
        // SAFETY: as in `new`.
        unsafe {
            let has = ptr::read_volatile(STATE) & RECEIVE_FULL != 0;
            has.then(|| ptr::read_volatile(DATA) as u8)
        }
    }

    /// Sends bytes, one after the other.
    pub fn send(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            // SAFETY: as in `new`.
            unsafe {
                while ptr::read_volatile(STATE) & SEND_FULL != 0 {}
                ptr::write_volatile(DATA, u32::from(byte));
            }
        }
    }
}
