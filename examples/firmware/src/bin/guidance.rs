//! A whole capture by the rig that plays a recording: text of the plan of each recording. On the host
//! it is the same program; `cargo xtask firmware` compares the two.
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};

use golden_sessions::{Recording, SESSIONS};
use vantage_core::soarnet::Aligned;
use vantage_firmware::{Memory, recorded_plan};

/// The network, where its weights lie best.
static MODEL: &Aligned<[u8]> = &Aligned(*include_bytes!("../../../../lab/models/soarnet.model"));

fn plans(out: &mut dyn Write, memory: &mut Memory) -> fmt::Result {
    for (name, bytes) in SESSIONS {
        writeln!(out, "[{name}]")?;
        let recording = Recording::parse(bytes).map_err(|_| fmt::Error)?;
        recorded_plan(out, &recording, &MODEL.0, memory)?;
    }
    Ok(())
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use static_cell::ConstStaticCell;
    use vantage_firmware::{Console, exit};

    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::new());
    let memory = MEMORY.take();
    exit(Console::try_new().and_then(|mut console| {
        plans(&mut console, memory)?;
        console.flush()
    }))
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    let mut text = String::new();
    let result = plans(&mut text, &mut Box::new(Memory::new()));
    print!("{text}");
    if result.is_ok() { std::process::ExitCode::SUCCESS } else { std::process::ExitCode::FAILURE }
}
