//! The page in `web/`: installs its tools, checks types, runs its tests, builds it; and the built
//! page in a browser, `tests/page`.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::board;
use crate::command;
use crate::setup;
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

/// The built page in a browser: whole captures, with and without a camera, bad input, accessibility,
/// offline.
pub fn test_in_browser(workspace: &Workspace) -> Result<Outcome> {
    let dist = build(workspace)?;
    install(workspace, BROWSER_TESTS)?;
    let out = browser_output(workspace);
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    let browser = setup::chromium().context("Chromium has gone")?;
    let mut tests = command::new(&workspace.path(BROWSER_TESTS), "node");
    tests.args(["--test", "--test-reporter=spec", "--test-concurrency=1"]);
    tests.env("VANTAGE_DIST", dist).env("VANTAGE_OUT", out).env("VANTAGE_CHROMIUM", browser);
    tests.env("VANTAGE_FILM", board::film(workspace)?);
    command::run(&mut tests)?;
    Ok(Outcome::Passed)
}

/// Where the browser tests leave what the page wrote: zips, one of them unpacked, and screenshots.
pub fn browser_output(workspace: &Workspace) -> PathBuf {
    workspace.target.join("xtask/page")
}

/// Builds the WebAssembly package and the page; returns the folder to serve.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    wasm::build(workspace)?;
    install(workspace, "web")?;
    npm(workspace, "web", &["run", "--silent", "build"])?;
    Ok(workspace.path("web/dist"))
}

/// The browser tests and their packages, which the page itself does not need.
const BROWSER_TESTS: &str = "tests/page";

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
