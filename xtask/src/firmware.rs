//! Builds the Cortex-M firmware of `examples/firmware` and runs it in QEMU.
//!
//! The machines are `mps2-an386` (Cortex-M4F) and `mps2-an500` (Cortex-M7). Text and exit code come
//! over semihosting, so a firmware that panics, faults or hangs fails like any other program.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::Result;

use crate::command;
use crate::toolchain::Target;
use crate::workspace::Workspace;

/// No firmware of ours runs longer than this, even on a loaded machine.
const LIMIT: Duration = Duration::from_secs(120);

/// QEMU's board with a Cortex-M4F.
pub const CORTEX_M4F: &str = "mps2-an386";

/// QEMU's board with a Cortex-M7.
pub const CORTEX_M7: &str = "mps2-an500";

/// QEMU's board with a Cortex-M33.
pub const CORTEX_M33: &str = "mps2-an505";

/// Builds every program; returns the folder they lie in.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    let (mut build, folder) = Target::Thumbv7em.build(workspace);
    command::capture(build.args(["--package", "vantage-firmware"]))?;
    Ok(folder)
}

/// Runs one program and returns what it wrote; a failing exit code is an error.
pub fn run_on(workspace: &Workspace, machine: &str, program: &Path) -> Result<String> {
    command::capture_within(&mut qemu(workspace, machine, program), LIMIT)
}

/// The same with an instruction every nanosecond of the machine's time.
pub fn run_counted(workspace: &Workspace, machine: &str, program: &Path) -> Result<String> {
    command::capture_within(qemu(workspace, machine, program).args(["-icount", "shift=0"]), LIMIT)
}

fn qemu(workspace: &Workspace, machine: &str, program: &Path) -> Command {
    let mut qemu = command::new(&workspace.root, "qemu-system-arm");
    qemu.args(["-M", machine, "-nographic", "-monitor", "none", "-serial", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(program);
    qemu
}

/// What a program occupies, from the loadable segments of its ELF file.
#[derive(Debug, Default, PartialEq)]
pub struct Size {
    /// Bytes stored: code, constants, initial values.
    pub flash: u64,
    /// Bytes of .data and .bss at run time, without the stack.
    pub ram: u64,
}

impl Size {
    /// `None` where the bytes are no 32-bit little-endian ELF file.
    pub fn of_elf(bytes: &[u8]) -> Option<Self> {
        const RAM: u32 = 0x2000_0000;
        let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
        let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
        if bytes.get(..6)? != b"\x7fELF\x01\x01" {
            return None;
        }
        let (table, entry, count) = (word(28)? as usize, half(42)?, half(44)?);
        let mut size = Self::default();
        for index in 0..usize::from(count) {
            let header = table.checked_add(index * usize::from(entry))?;
            let (kind, address) = (word(header)?, word(header + 8)?);
            let (stored, occupied) = (word(header + 16)?, word(header + 20)?);
            if kind == 1 {
                size.flash += u64::from(stored);
                size.ram += if address >= RAM { u64::from(occupied) } else { 0 };
            }
        }
        Some(size)
    }
}

#[cfg(test)]
mod tests {
    use super::Size;

    /// An ELF header and the program headers of code at 0 and of data at 0x2000_0000.
    fn elf() -> Vec<u8> {
        let mut bytes = vec![0; 52 + 64];
        bytes[..6].copy_from_slice(b"\x7fELF\x01\x01");
        let mut word = |at: usize, value: u32| {
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        };
        word(28, 52);
        word(42, 32 | (2 << 16));
        for (header, address, stored, occupied) in [(52, 0, 100, 100), (84, 0x2000_0000, 8, 24)] {
            word(header, 1);
            word(header + 8, address);
            word(header + 16, stored);
            word(header + 20, occupied);
        }
        bytes
    }

    #[test]
    fn initial_values_count_in_flash_and_in_ram() {
        assert_eq!(Size::of_elf(&elf()), Some(Size { flash: 108, ram: 24 }));
    }

    #[test]
    fn what_is_cut_short_or_no_elf_file_is_refused() {
        assert_eq!(Size::of_elf(&elf()[..100]), None);
        assert_eq!(Size::of_elf(b"#!/bin/sh"), None);
        assert_eq!(Size::of_elf(b""), None);
    }
}
