//! Writes the text of `same_plan::run` to the debugger's standard output; `cargo xtask test
//! same-plan` compares it with the committed one.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use vantage_firmware::{Console, exit};
    exit(Console::try_new().and_then(|mut console| {
        same_plan::run(&mut console)?;
        console.flush()
    }))
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "firmware: this program runs on a Cortex-M; `cargo xtask firmware` builds and runs it"
    );
}
