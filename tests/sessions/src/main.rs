//! Writes the text of [`golden_sessions::run`] to standard output: the host's side of the comparison.

use std::io::Write;

fn main() -> std::io::Result<()> {
    let mut text = String::new();
    let mut memory = Box::new(golden_sessions::Memory::new());
    golden_sessions::run(&mut text, &mut memory).map_err(std::io::Error::other)?;
    std::io::stdout().write_all(text.as_bytes())
}
