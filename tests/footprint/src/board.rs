//! The board: what happens on a panic, how much stack was used, and numbers to the debugger.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{debug, hio};

/// A panic calls a function that exists nowhere. Where the compiler finds that nothing can panic, it
/// drops this handler, and the program links.
#[panic_handler]
fn panic(_info: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn vantage_has_a_way_to_panic() -> !;
    }
    // SAFETY: a program that could reach this call does not link.
    unsafe { vantage_has_a_way_to_panic() }
}

/// A fault without a handler of its own would hang; it must fail instead.
// SAFETY: the handler touches no state of the program and never returns.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    exit(false)
}

/// Ends the program: exit code 0 for success, 1 for failure.
pub fn exit(done: bool) -> ! {
    debug::exit(if done { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        core::hint::spin_loop();
    }
}

/// Writes `name number` and a line's end to the debugger's standard output.
pub fn tell(name: &str, mut number: usize) {
    let mut digits = [b'\n'; 11];
    let mut first = digits.len() - 1;
    loop {
        first = first.saturating_sub(1);
        if let Some(digit) = digits.get_mut(first) {
            *digit = b'0' + (number % 10) as u8;
        }
        number /= 10;
        if number == 0 {
            break;
        }
    }
    if let Ok(mut stdout) = hio::hstdout() {
        let number = digits.get(first..).unwrap_or_default();
        for part in [name.as_bytes(), b" ", number] {
            stdout.write_all(part).ok();
        }
    }
}

/// Bytes of stack that have been used since the start, which painted all of it.
pub fn stack_high_water() -> usize {
    unsafe extern "C" {
        // From the linker: where the stack ends, low, and where it starts, high.
        static _stack_end: u32;
        static _stack_start: u32;
    }
    const PAINT: u32 = 0xcccc_cccc; // of cortex-m-rt
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut place = end;
    // SAFETY: from the stack's end to its start lies memory that nothing else occupies, in words; what
    // is read may change at any time, as stack does.
    while place < start && unsafe { place.read_volatile() } == PAINT {
        place = place.wrapping_add(1);
    }
    start.addr() - place.addr()
}
