//! Writes the C header of `vantage-c`.
//!
//! Usage: `xtask-header <folder of the crate> <header>`; `cargo xtask header` calls it. What the header
//! looks like is said in the crate's `cbindgen.toml`.

use std::path::Path;
use std::{env, fs};

use anyhow::{Context, Result, anyhow, bail};
use cbindgen::{Builder, Config};

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, header] = arguments.as_slice() else {
        bail!("usage: xtask-header <folder of the crate> <header>");
    };
    let settings = Path::new(folder).join("cbindgen.toml");
    let config = Config::from_file(&settings).map_err(|error| anyhow!("{error}"))?;
    let bindings = Builder::new()
        .with_crate(folder)
        .with_config(config)
        .generate()
        .with_context(|| format!("no header of {folder}"))?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    // What Rust heads so, C programmers have no heading for.
    let text = String::from_utf8(text)?.replace(" # Safety\n\n", " The caller promises:\n");
    fs::write(header, text).with_context(|| format!("{header} could not be written"))
}
