//! Whole captures, recorded once and replayed with the shipped network: x86-64, wasm32, Cortex-M4F,
//! Cortex-M7 and a program in C all must write the bytes of `golden/sessions.txt`.
//!
//! A recording holds candidates, and for each what comes of sending a camera there: the pose it
//! reaches, which is a little off, the frame it takes, or a mishap. So it does not depend on the plan:
//! another network makes another plan over the same recording. `cargo xtask golden` records and writes
//! anew.
//!
//! ```
//! use golden_sessions::{Memory, Recording, SESSIONS};
//!
//! let (name, bytes) = SESSIONS[0];
//! let chair = Recording::parse(bytes)?;
//! assert_eq!((name, chair.header().candidates), ("chair", 64));
//! assert_eq!(chair.entry(0).map(|entry| entry.frame.len()), Some(64 * 64 * 2));
//! # Ok::<(), golden_sessions::RecordingError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod recording;
mod replay;

use core::fmt::{self, Write};

use vantage_core::soarnet::Aligned;

pub use recording::{
    ENTRY, Entry, HEADER, Header, Mishap, PIXELS, Recording, RecordingError, SCHEMES, VERSION,
};
pub use replay::{CANDIDATES, Memory, VIEWS, replay};

/// The network that comes with the program, where its weights lie best.
pub static MODEL: &[u8] = {
    static MODEL: &Aligned<[u8]> = &Aligned(*include_bytes!("../../../lab/models/soarnet.model"));
    &MODEL.0
};

/// Every recording with its name.
pub static SESSIONS: [(&str, &[u8]); 2] = [
    ("chair", include_bytes!("../golden/chair.recording")),
    ("vase", include_bytes!("../golden/vase.recording")),
];

/// Writes the whole text: a heading `[name]` and its lines for each recording.
pub fn run(out: &mut dyn Write, memory: &mut Memory) -> fmt::Result {
    for (index, (name, bytes)) in SESSIONS.iter().enumerate() {
        if index > 0 {
            writeln!(out)?;
        }
        writeln!(out, "[{name}]")?;
        let recording = Recording::parse(bytes).map_err(|_| fmt::Error)?;
        replay(out, &recording, MODEL, memory)?;
    }
    Ok(())
}
