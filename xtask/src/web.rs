//! The page in `web/`: installs its tools, checks types, runs its tests, builds it.

use std::fs;
use std::path::PathBuf;

use anyhow::Result;

use crate::command;
use crate::test::Outcome;
use crate::wasm;
use crate::workspace::Workspace;

/// Types, lints and tests of the page, and its production build.
pub fn test(workspace: &Workspace) -> Result<Outcome> {
    if !workspace.path("web/package.json").exists() {
        return Ok(Outcome::Skipped("web/package.json does not exist".into()));
    }
    wasm::build(workspace)?;
    install(workspace)?;
    for script in ["check", "test", "build"] {
        npm(workspace, &["run", "--silent", script])?;
    }
    Ok(Outcome::Passed)
}

/// Builds the WebAssembly package and the page; returns the folder to serve.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    wasm::build(workspace)?;
    install(workspace)?;
    npm(workspace, &["run", "--silent", "build"])?;
    Ok(workspace.path("web/dist"))
}

/// `npm ci`, unless the installed packages are those of the lock file already.
fn install(workspace: &Workspace) -> Result<()> {
    let lock = fs::read(workspace.path("web/package-lock.json"))?;
    let stamp = workspace.path("web/node_modules/.installed-lock.json");
    if fs::read(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    npm(workspace, &["ci", "--no-audit", "--no-fund"])?;
    fs::write(stamp, lock)?;
    Ok(())
}

fn npm(workspace: &Workspace, arguments: &[&str]) -> Result<()> {
    command::run(command::new(&workspace.path("web"), "npm").args(arguments))
}
