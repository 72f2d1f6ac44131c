//! Bytes in two slots of a flash memory, of which a cut of power at any write leaves one good.
//!
//! A slot is half of the region. It begins with a header, padded with ones to whole writes:
//!
//! | bytes | what |
//! |---|---|
//! | 0 .. 4 | `VSLT` |
//! | 4 .. 8 | number of the record, u32 little-endian: the higher one is the newer |
//! | 8 .. 12 | length in bytes, u32 little-endian |
//! | 12 .. 16 | CRC-32 (ISO-HDLC) of the record |
//! | 16 .. 20 | CRC-32 of the sixteen bytes before |
//!
//! and goes on with the record. [`save`](Store::save) erases the slot that does not hold the newest
//! good record, writes the record, and the header last: until its last byte is written, the header's
//! checksum is wrong and the other slot counts. Whatever an interrupted erase or write leaves behind is
//! found by a checksum, which a page of flash that was erased only by half might pass once in 2^32.
//!
//! Not handled: flash that wears out within a slot (every save moves to the other, so each sees half of
//! them), and reads that fail now and then.

use core::fmt;

use embedded_storage::nor_flash::NorFlash;

use crate::frame::CRC;

const MAGIC: [u8; 4] = *b"VSLT";
const HEADER: usize = 20;

/// Bytes that are read or written at once; every flash's smallest read and write divide it.
const BLOCK: usize = 256;

/// Two slots in a region of a flash memory.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    from: u32,
    slot: u32,              // bytes of a slot
    newest: Option<Record>, // that is good
}

/// A good record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Record {
    in_second: bool,
    number: u32,
    length: u32,
    checksum: u32,
}

/// Why bytes are not kept or not found again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError<E> {
    /// The region does not consist of two times the same number of pages that can be erased.
    Region,
    /// The record is longer than a slot.
    TooLong {
        /// Bytes that a slot holds.
        room: usize,
    },
    /// The buffer is shorter than the record.
    NoRoom,
    /// The flash memory refused.
    Flash(E),
}

impl<E: fmt::Debug> fmt::Display for StoreError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Region => f.write_str(
                "the region must consist of two times the same number of pages inside the flash",
            ),
            Self::TooLong { room } => write!(f, "a slot holds {room} bytes, the record is longer"),
            Self::NoRoom => f.write_str("the buffer is shorter than the record"),
            Self::Flash(error) => write!(f, "the flash memory refused: {error:?}"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for StoreError<E> {}

impl<F: NorFlash> Store<F> {
    /// The slots in `from .. to` of a flash memory, as they were left.
    pub fn try_new(flash: F, from: u32, to: u32) -> Result<Self, StoreError<F::Error>> {
        const { assert!(BLOCK.is_multiple_of(F::WRITE_SIZE) && BLOCK.is_multiple_of(F::READ_SIZE)) }
        let pages = 2 * F::ERASE_SIZE as u32;
        let aligned = from.is_multiple_of(F::ERASE_SIZE as u32);
        if to <= from || !aligned || !(to - from).is_multiple_of(pages) {
            return Err(StoreError::Region);
        }
        if to as usize > flash.capacity() {
            return Err(StoreError::Region);
        }
        let mut store = Self { flash, from, slot: (to - from) / 2, newest: None };
        let first = store.look(false)?;
        let second = store.look(true)?;
        store.newest = match (first, second) {
            // The numbers differ by one; they may have begun again at 0.
            (Some(a), Some(b)) if b.number.wrapping_sub(a.number) as i32 > 0 => Some(b),
            (Some(a), _) => Some(a),
            (None, b) => b,
        };
        Ok(store)
    }

    /// Bytes before a record: the header in whole writes and reads.
    const fn head() -> usize {
        HEADER.next_multiple_of(F::WRITE_SIZE).next_multiple_of(F::READ_SIZE)
    }

    /// Bytes that a record may have.
    pub fn room(&self) -> usize {
        self.slot as usize - Self::head()
    }

    fn address(&self, in_second: bool) -> u32 {
        self.from + if in_second { self.slot } else { 0 }
    }

    /// The record of a slot, if it is good.
    fn look(&mut self, in_second: bool) -> Result<Option<Record>, StoreError<F::Error>> {
        let address = self.address(in_second);
        let mut block = [0; BLOCK];
        let head = block.get_mut(..HEADER.next_multiple_of(F::READ_SIZE)).unwrap_or_default();
        self.flash.read(address, head).map_err(StoreError::Flash)?;
        let Some(&[magic, number, length, checksum, own]) =
            block.as_chunks::<4>().0.first_chunk::<5>()
        else {
            return Ok(None);
        };
        let covered = block.get(..HEADER - 4).unwrap_or_default();
        let length = u32::from_le_bytes(length);
        if magic != MAGIC
            || u32::from_le_bytes(own) != CRC.checksum(covered)
            || length as usize > self.room()
        {
            return Ok(None);
        }
        let mut digest = CRC.digest();
        self.read(address, length, |bytes| digest.update(bytes))?;
        let checksum = u32::from_le_bytes(checksum);
        let number = u32::from_le_bytes(number);
        let record = Record { in_second, number, length, checksum };
        Ok((digest.finalize() == checksum).then_some(record))
    }

    /// Hands the record of the slot at `address` on, block by block.
    fn read(
        &mut self,
        address: u32,
        length: u32,
        mut take: impl FnMut(&[u8]),
    ) -> Result<(), StoreError<F::Error>> {
        let mut block = [0; BLOCK];
        let start = address + Self::head() as u32;
        let mut done = 0;
        while done < length {
            let count = (length - done).min(BLOCK as u32) as usize;
            let whole = block.get_mut(..count.next_multiple_of(F::READ_SIZE)).unwrap_or_default();
            self.flash.read(start + done, whole).map_err(StoreError::Flash)?;
            take(whole.get(..count).unwrap_or_default());
            done += count as u32;
        }
        Ok(())
    }

    /// Reads the newest good record; gives its length, or `None` where there is none.
    pub fn load(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, StoreError<F::Error>> {
        let Some(record) = self.newest else { return Ok(None) };
        let length = record.length as usize;
        let mut rest = buffer.get_mut(..length).ok_or(StoreError::NoRoom)?;
        self.read(self.address(record.in_second), record.length, |bytes| {
            if let Some((place, left)) =
                core::mem::take(&mut rest).split_at_mut_checked(bytes.len())
            {
                place.copy_from_slice(bytes);
                rest = left;
            }
        })?;
        Ok(Some(length))
    }

    /// Keeps a record in place of the older one. After an error the newest good one is still there.
    pub fn save(&mut self, bytes: &[u8]) -> Result<(), StoreError<F::Error>> {
        let room = self.room();
        if bytes.len() > room {
            return Err(StoreError::TooLong { room });
        }
        let record = Record {
            in_second: self.newest.is_some_and(|newest| !newest.in_second),
            number: self.newest.map_or(0, |newest| newest.number.wrapping_add(1)),
            length: bytes.len() as u32,
            checksum: CRC.checksum(bytes),
        };
        let address = self.address(record.in_second);
        self.flash.erase(address, address + self.slot).map_err(StoreError::Flash)?;

        let mut place = address + Self::head() as u32;
        for part in bytes.chunks(BLOCK) {
            self.write(place, part)?;
            place += part.len() as u32;
        }

        let mut header = [0; HEADER];
        let numbers = [record.number, record.length, record.checksum].map(u32::to_le_bytes);
        let fields = MAGIC.iter().chain(numbers.as_flattened());
        for (byte, value) in header.iter_mut().zip(fields) {
            *byte = *value;
        }
        if let Some((covered, own)) = header.split_last_chunk_mut::<4>() {
            *own = CRC.checksum(covered).to_le_bytes();
        }
        self.write(address, &header)?;
        self.newest = Some(record);
        Ok(())
    }

    /// Writes at most a block, padded with ones to whole writes.
    fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), StoreError<F::Error>> {
        let mut block = [0xff; BLOCK];
        for (place, byte) in block.iter_mut().zip(bytes) {
            *place = *byte;
        }
        let whole = block.get(..bytes.len().next_multiple_of(F::WRITE_SIZE)).unwrap_or_default();
        self.flash.write(address, whole).map_err(StoreError::Flash)
    }
}
