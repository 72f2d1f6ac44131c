//! Semihosting console, exit code, panic and fault handlers.

use core::fmt::{self, Write};
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{debug, hio};

/// The debugger's standard output, a call at a time.
pub struct Text(hio::HostStream);

impl Text {
    /// Opens it.
    pub fn try_new() -> Result<Self, fmt::Error> {
        hio::hstdout().map(Self).map_err(|_| fmt::Error)
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.write_all(text.as_bytes()).map_err(|_| fmt::Error)
    }
}

/// Ends the program: exit code 0 for success, 1 for failure.
pub fn exit(is_success: bool) -> ! {
    debug::exit(if is_success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if let Ok(mut text) = Text::try_new() {
        writeln!(text, "firmware: {info}").ok();
    }
    exit(false)
}

/// A fault must fail instead of hang.
// SAFETY: the handler touches no state of the program and never returns.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    exit(false)
}
