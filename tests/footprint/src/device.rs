//! A device behind a serial line, with whatever may come over it. For the proof, which only links.

use core::hint::black_box;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use golden_sessions::MODEL;
use vantage_device::{Device, Memory, Store};

/// Room for a photo of 64 x 64 in two bytes a pixel, and for a snapshot.
pub type Room = Memory<32, 12, 16_384>;

const FLASH: usize = 1 << 16;

/// A flash memory that is none: whatever is read and whether it succeeds is hidden from the compiler.
struct Flash;

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, _from: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        bytes.fill(black_box(0));
        black_box(Ok(()))
    }

    fn capacity(&self) -> usize {
        FLASH
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        black_box((from, to));
        black_box(Ok(()))
    }

    fn write(&mut self, from: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        black_box((from, bytes));
        black_box(Ok(()))
    }
}

/// Bytes that may be anything, and what is answered.
#[inline(never)]
pub fn converse(room: &Room) -> Option<()> {
    let store = Store::try_new(Flash, black_box(0), black_box(FLASH as u32)).ok()?;
    let mut device = Device::new(black_box(MODEL), room, store);
    for byte in black_box([0; 8]) {
        black_box(device.receive(byte));
    }
    Some(())
}
