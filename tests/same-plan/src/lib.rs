//! One text of whole plans. x86-64, wasm32 and thumbv7em each write it, and all must write the
//! bytes of `golden/plans.txt`: the same plan, not merely a good one.
//!
//! Numbers are the bits of an `f32` in hexadecimal, so that a difference in the last place shows.
//! NaN is written `nan`, because its payload is not specified across targets.
//!
//! A section is a function in `SECTIONS` that writes lines. To add one, write the function, name
//! it there, and run `cargo xtask golden`; the difference is reviewed like code.
#![no_std]
#![forbid(unsafe_code)]

mod arithmetic;
mod geometry;
mod outlines;
mod plans;
mod predicted;
mod recorded;
mod scene;

use core::fmt::{self, Write};

pub use predicted::{CANDIDATES, FILE, PICTURE, network, paint};

/// A section's writer.
type Section = fn(&mut dyn Write) -> fmt::Result;

/// Every section, in the order of the text. Ground first: where a float function differs, every
/// plan differs, and the first differing line should be the one to look at.
const SECTIONS: &[(&str, Section)] = &[
    ("math", arithmetic::functions),
    ("poses", geometry::poses),
    ("refused poses", geometry::refused),
    ("projections", geometry::projections),
    ("candidates", plans::candidates),
    ("plans by poses", plans::blind),
    ("plans over a recorded scene", recorded::schemes),
    ("mishaps", recorded::mishaps),
    ("snapshots", recorded::snapshots),
    ("outlooks on a hull", outlines::outlooks),
    ("gains by a network", predicted::gains),
    ("plans by a network", predicted::plans),
];

/// Writes the whole text: a heading `[name]` and its lines for each section.
pub fn run(out: &mut dyn Write) -> fmt::Result {
    for (index, (name, section)) in SECTIONS.iter().enumerate() {
        if index > 0 {
            writeln!(out)?;
        }
        writeln!(out, "[{name}]")?;
        section(out)?;
    }
    Ok(())
}

/// An `f32` as its bits in hexadecimal, or `nan`.
pub(crate) struct Bits(pub f32);

impl fmt::Display for Bits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_nan() { f.write_str("nan") } else { write!(f, "{:08x}", self.0.to_bits()) }
    }
}

/// A name and its numbers on one line, as [`Bits`].
pub(crate) fn line(out: &mut dyn Write, name: fmt::Arguments<'_>, values: &[f32]) -> fmt::Result {
    write!(out, "{name}")?;
    for value in values {
        write!(out, " {}", Bits(*value))?;
    }
    writeln!(out)
}
