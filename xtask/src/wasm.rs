//! Builds `vantage-wasm` and its JavaScript side into `web/src/wasm`, which git ignores.

use std::fs;
use std::path::PathBuf;

use anyhow::Result;

use crate::command;
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};

/// Where the page imports the package from.
const PACKAGE: &str = "web/src/wasm";

/// Builds the package; returns its folder.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    let (mut build, built) = Target::Wasm32.build(workspace);
    command::run(build.args(["--package", "vantage-wasm"]))?;
    let folder = workspace.path(PACKAGE);
    let mut bindgen = command::new(&workspace.root, cargo());
    bindgen.args(["run", "--quiet", "--profile", "tools", "--package", "xtask-bindgen", "--"]);
    command::run(bindgen.arg(built.join("vantage_wasm.wasm")).arg(&folder))?;
    let size = fs::metadata(folder.join("vantage_wasm_bg.wasm"))?.len();
    println!("{PACKAGE}: vantage_wasm_bg.wasm has {size} bytes");
    Ok(folder)
}
