//! Replays the recorded captures of `tests/sessions` and writes their text to the debugger's standard
//! output; `cargo xtask test sessions` compares it with the committed one.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // Too large for the stack. The attribute hands it over as `&'static mut`, once.
    static mut MEMORY: golden_sessions::Memory = golden_sessions::Memory::new();

    use vantage_firmware::{Console, exit};
    exit(Console::try_new().and_then(|mut console| {
        golden_sessions::run(&mut console, MEMORY)?;
        console.flush()
    }))
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("firmware: this program runs on a Cortex-M; `cargo xtask test sessions` runs it");
}
