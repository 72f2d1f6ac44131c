//! A flash memory that loses power, and a network to plan with.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]
#![allow(dead_code, reason = "each test program uses its part")]

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use rand_core::Rng;
use rand_pcg::Pcg32;

/// What remains when power is cut.
#[derive(Debug)]
pub struct Chip {
    pub bytes: Vec<u8>,
    written: Vec<bool>, // since they were erased
    /// Writes and erases until power is cut, the last of which stops half way; `None` for ever.
    pub left: Option<u32>,
    /// Writes and erases so far.
    pub count: u32,
    chance: Pcg32, // where the last one stops
}

/// A handle to a chip; `WRITE` is its smallest write.
#[derive(Clone, Debug)]
pub struct Flash<const WRITE: usize>(pub Rc<RefCell<Chip>>);

/// There is no power, or the driver was called in a way that no chip allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoPower;

impl NorFlashError for NoPower {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

pub const PAGE: usize = 4096;

impl<const WRITE: usize> Flash<WRITE> {
    pub fn new(pages: usize, seed: u64) -> Self {
        let length = pages * PAGE;
        Self(Rc::new(RefCell::new(Chip {
            bytes: vec![0xff; length],
            written: vec![false; length],
            left: None,
            count: 0,
            chance: Pcg32::new(seed, 5),
        })))
    }

    /// Power is cut in the middle of the `after`-th write or erase from now on, counted from 0.
    pub fn cut(&self, after: Option<u32>) {
        self.0.borrow_mut().left = after;
    }

    pub fn has_power(&self) -> bool {
        self.0.borrow().left != Some(u32::MAX)
    }

    pub fn count(&self) -> u32 {
        self.0.borrow().count
    }
}

impl Chip {
    /// How many of `length` bytes an operation reaches before power is cut; an error after it.
    fn reach(&mut self, length: usize) -> (usize, Result<(), NoPower>) {
        self.count += 1;
        match &mut self.left {
            None => (length, Ok(())),
            Some(u32::MAX) => (0, Err(NoPower)),
            Some(0) => {
                self.left = Some(u32::MAX);
                (self.chance.next_u32() as usize % (length + 1), Err(NoPower))
            }
            Some(left) => {
                *left -= 1;
                (length, Ok(()))
            }
        }
    }
}

impl<const WRITE: usize> ErrorType for Flash<WRITE> {
    type Error = NoPower;
}

impl<const WRITE: usize> ReadNorFlash for Flash<WRITE> {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NoPower> {
        assert!(offset.is_multiple_of(4) && bytes.len().is_multiple_of(4), "whole reads");
        if !self.has_power() {
            return Err(NoPower);
        }
        bytes.copy_from_slice(&self.0.borrow().bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.borrow().bytes.len()
    }
}

impl<const WRITE: usize> NorFlash for Flash<WRITE> {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NoPower> {
        let (from, to) = (from as usize, to as usize);
        assert!(from < to && from.is_multiple_of(PAGE) && to.is_multiple_of(PAGE), "whole pages");
        let chip = &mut *self.0.borrow_mut();
        let (reach, result) = chip.reach(to - from);
        // Bits rise in no order: the first bytes are erased, a few behind them are neither nor.
        chip.bytes[from..from + reach].fill(0xff);
        for byte in chip.bytes[from + reach..to].iter_mut().take(64) {
            *byte |= chip.chance.next_u32() as u8;
        }
        chip.written[from..to].fill(result.is_err());
        result
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NoPower> {
        let from = offset as usize;
        assert!(from.is_multiple_of(WRITE) && bytes.len().is_multiple_of(WRITE), "whole writes");
        let chip = &mut *self.0.borrow_mut();
        let (reach, result) = chip.reach(bytes.len());
        if reach == 0 && result.is_err() {
            return result;
        }
        for (place, value) in bytes.iter().enumerate() {
            assert!(!chip.written[from + place], "byte {} is written twice", from + place);
            chip.written[from + place] = true;
            let half = if place == reach { chip.chance.next_u32() as u8 } else { 0 };
            if place <= reach {
                chip.bytes[from + place] &= value | half;
            }
        }
        result
    }
}
