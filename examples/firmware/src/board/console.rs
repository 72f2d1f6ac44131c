//! QEMU's `mps2` boards: semihosting console, exit code, panic and fault handlers.

use core::fmt::{self, Write};
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{debug, hio};

/// Bytes gathered before they go to the debugger: each trip stops the core.
const BUFFER: usize = 1024;

/// Standard output of the debugger. Buffered: call [`Console::flush`] at the end.
pub struct Console {
    stream: hio::HostStream,
    buffer: [u8; BUFFER],
    used: usize, // bytes of `buffer` that wait, at most BUFFER
}

impl Console {
    /// Opens the debugger's standard output.
    pub fn try_new() -> Result<Self, fmt::Error> {
        let stream = hio::hstdout().map_err(|_| fmt::Error)?;
        Ok(Self { stream, buffer: [0; BUFFER], used: 0 })
    }

    /// Sends what waits.
    pub fn flush(&mut self) -> fmt::Result {
        let waiting = self.buffer.get(..self.used).ok_or(fmt::Error)?;
        self.stream.write_all(waiting).map_err(|_| fmt::Error)?;
        self.used = 0;
        Ok(())
    }
}

impl Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for part in text.as_bytes().chunks(BUFFER) {
            if part.len() > BUFFER - self.used {
                self.flush()?;
            }
            let end = self.used + part.len();
            self.buffer.get_mut(self.used..end).ok_or(fmt::Error)?.copy_from_slice(part);
            self.used = end;
        }
        Ok(())
    }
}

/// Ends the program: exit code 0 for success, 1 for failure.
pub fn exit(result: fmt::Result) -> ! {
    debug::exit(if result.is_ok() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    // Only without a debugger: nothing is left to do.
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if let Ok(mut stderr) = hio::hstderr() {
        writeln!(stderr, "firmware: {info}").ok();
    }
    exit(Err(fmt::Error))
}

/// A fault without a handler of its own would hang; it must fail instead.
// SAFETY: the handler touches no state of the program and never returns.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    exit(Err(fmt::Error))
}
