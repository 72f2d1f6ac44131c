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
    install(workspace, "web")?;
    for script in ["check", "test", "build"] {
        npm(workspace, "web", &["run", "--silent", script])?;
    }
    Ok(Outcome::Passed)
}

/// Builds the WebAssembly package and the page; returns the folder to serve.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    wasm::build(workspace)?;
    install(workspace, "web")?;
    npm(workspace, "web", &["run", "--silent", "build"])?;
    Ok(workspace.path("web/dist"))
}

/// `npm ci`, unless the installed packages are those of the lock file already.
pub fn install(workspace: &Workspace, folder: &str) -> Result<()> {
    let lock = fs::read(workspace.path(folder).join("package-lock.json"))?;
    let stamp = workspace.path(folder).join("node_modules/.installed-lock.json");
    if fs::read(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    npm(workspace, folder, &["ci", "--no-audit", "--no-fund"])?;
    fs::write(stamp, lock)?;
    Ok(())
}

fn npm(workspace: &Workspace, folder: &str, arguments: &[&str]) -> Result<()> {
    command::run(command::new(&workspace.path(folder), "npm").args(arguments))
}
