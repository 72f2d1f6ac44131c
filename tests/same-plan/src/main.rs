//! Writes the text of [`same_plan::run`] to standard output: the host's side of the comparison.

use std::io::Write;

fn main() -> std::io::Result<()> {
    let mut text = String::new();
    same_plan::run(&mut text).map_err(std::io::Error::other)?;
    std::io::stdout().write_all(text.as_bytes())
}
