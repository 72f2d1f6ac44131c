//! Writes the text of [`same_plan::run`] to standard output: the host's side of the comparison.
//!
//! With a folder as argument it writes there what the section "plans by a network" was made from: two
//! model files, and `pictures.rgb` with a picture of each candidate. The test of the npm package makes
//! the same plans from them.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

fn main() -> io::Result<()> {
    if let Some(folder) = std::env::args_os().nth(1) {
        return write_inputs(Path::new(&folder));
    }
    let mut text = String::new();
    same_plan::run(&mut text).map_err(io::Error::other)?;
    io::stdout().write_all(text.as_bytes())
}

fn write_inputs(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    for (name, with_images) in [("with-images.model", true), ("without-images.model", false)] {
        let mut file = [0; same_plan::FILE];
        let length = same_plan::network(with_images, &mut file).map_err(io::Error::other)?;
        fs::write(folder.join(name), &file[..length])?;
    }
    let mut pictures = Vec::new();
    for candidate in 0..same_plan::CANDIDATES {
        let mut picture = [0; same_plan::PICTURE];
        same_plan::paint(candidate, &mut picture);
        pictures.extend(picture);
    }
    fs::write(folder.join("pictures.rgb"), pictures)
}
