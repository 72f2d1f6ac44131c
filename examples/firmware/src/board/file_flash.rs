//! A flash memory that is a file of the host, reached over semihosting: it survives the machine.

use core::ffi::CStr;

use cortex_m_semihosting::{nr, syscall};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// A file as long as the flash, all ones at first.
#[derive(Debug)]
pub struct FileFlash {
    file: usize, // the debugger's handle
    length: u32,
}

/// The debugger refused, or the place is not in the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileError;

impl NorFlashError for FileError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

const PAGE: usize = 4096;

impl FileFlash {
    /// Opens a file of `length` bytes, a multiple of 4,096; makes it where there is none.
    pub fn try_new(path: &CStr, length: u32) -> Result<Self, FileError> {
        let open = |mode: usize| {
            // SAFETY: the path ends with a zero and lives through the call.
            let file = unsafe { syscall!(OPEN, path.as_ptr(), mode, path.count_bytes()) };
            (file != usize::MAX).then_some(file)
        };
        if let Some(file) = open(nr::open::RW_BINARY) {
            return Ok(Self { file, length });
        }
        let file = open(nr::open::RW_TRUNC_BINARY).ok_or(FileError)?;
        let mut flash = Self { file, length };
        flash.erase(0, length)?;
        Ok(flash)
    }

    fn seek(&mut self, offset: u32, count: usize) -> Result<(), FileError> {
        if offset as usize + count > self.length as usize {
            return Err(FileError);
        }
        // SAFETY: a call with numbers alone.
        let failed = unsafe { syscall!(SEEK, self.file, offset) };
        if failed == 0 { Ok(()) } else { Err(FileError) }
    }
}

impl ErrorType for FileFlash {
    type Error = FileError;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FileError> {
        self.seek(offset, bytes.len())?;
        // SAFETY: the debugger writes into `bytes` and no further.
        let left = unsafe { syscall!(READ, self.file, bytes.as_mut_ptr(), bytes.len()) };
        if left == 0 { Ok(()) } else { Err(FileError) }
    }

    fn capacity(&self) -> usize {
        self.length as usize
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FileError> {
        for page in (from..to).step_by(PAGE) {
            self.write(page, &[0xff; PAGE])?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FileError> {
        self.seek(offset, bytes.len())?;
        // SAFETY: the debugger reads `bytes` and no further.
        let left = unsafe { syscall!(WRITE, self.file, bytes.as_ptr(), bytes.len()) };
        if left == 0 { Ok(()) } else { Err(FileError) }
    }
}

/// The words that follow the program's name on the debugger's command line, each ended by a zero.
pub fn argument(buffer: &mut [u8; 256]) -> Option<&CStr> {
    let block = [buffer.as_mut_ptr() as usize, buffer.len()];
    // SAFETY: the debugger writes the line and a zero into `buffer`, and fails where it is too short.
    let failed = unsafe { cortex_m_semihosting::syscall(nr::GET_CMDLINE, &block) };
    let line = CStr::from_bytes_until_nul(buffer).ok().filter(|_| failed == 0)?;
    let start = line.to_bytes().iter().position(|&byte| byte == b' ')? + 1;
    CStr::from_bytes_with_nul(line.to_bytes_with_nul().get(start..)?).ok()
}
