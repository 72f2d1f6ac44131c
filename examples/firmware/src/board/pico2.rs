//! The flash memory of a Raspberry Pi Pico 2, through the boot ROM's functions (RP2350 datasheet,
//! section 5.4.8). Built, not run on hardware.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use rp235x_hal::rom_data;

/// The part behind the program: see `boards/pico2.x`.
#[derive(Debug)]
pub struct Flash {
    _private: (),
}

/// Bytes of that part.
pub const LENGTH: u32 = 128 * 1024;

const START: u32 = 4 * 1024 * 1024 - LENGTH; // from the beginning of the chip
const WINDOW: usize = 0x1000_0000; // where the chip is mapped

/// The place is not in this part of the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfBounds;

impl NorFlashError for OutOfBounds {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::OutOfBounds
    }
}

impl Flash {
    /// The part of the flash behind the program.
    ///
    /// # Safety
    ///
    /// There is one of them, the other core does not run, and no DMA reads flash.
    pub const unsafe fn new() -> Self {
        Self { _private: () }
    }

    /// Runs `operation` while nothing else reads flash, and brings fast reading back.
    fn alone(operation: impl FnOnce()) {
        critical_section::with(|_| {
            // SAFETY: this is the only core that runs, no interrupt comes between, and the boot ROM's
            // functions leave flash readable when they return.
            unsafe {
                rom_data::connect_internal_flash();
                rom_data::flash_exit_xip();
                operation();
                rom_data::flash_flush_cache();
                // Quad reads at a third of the system's 150 MHz.
                rom_data::flash_select_xip_read_mode(3, 3);
            }
        });
    }
}

fn check(from: u32, length: usize) -> Result<(), OutOfBounds> {
    let fits = from as usize + length <= LENGTH as usize;
    if fits { Ok(()) } else { Err(OutOfBounds) }
}

impl ErrorType for Flash {
    type Error = OutOfBounds;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), OutOfBounds> {
        check(offset, bytes.len())?;
        let from = (WINDOW + START as usize + offset as usize) as *const u8;
        // SAFETY: the range lies in flash, which is mapped there, and `bytes` in RAM.
        unsafe { core::ptr::copy_nonoverlapping(from, bytes.as_mut_ptr(), bytes.len()) };
        Ok(())
    }

    fn capacity(&self) -> usize {
        LENGTH as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 256;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), OutOfBounds> {
        let length = to.checked_sub(from).ok_or(OutOfBounds)? as usize;
        check(from, length)?;
        // SAFETY: whole pages behind the program, which the linker keeps free; `alone`'s conditions
        // are this value's. 0xd8 erases 64 KiB at once where they are whole.
        Self::alone(|| unsafe {
            rom_data::flash_range_erase(START + from, length, 1 << 16, 0xd8);
        });
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), OutOfBounds> {
        check(offset, bytes.len())?;
        let start = bytes.as_ptr() as usize;
        if (WINDOW..WINDOW + (1 << 25)).contains(&start) {
            return Err(OutOfBounds); // flash cannot be read while it is written
        }
        // SAFETY: as in `erase`; `bytes` lie in RAM.
        Self::alone(|| unsafe {
            rom_data::flash_range_program(START + offset, bytes.as_ptr(), bytes.len());
        });
        Ok(())
    }
}
