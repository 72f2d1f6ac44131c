//! Other people's programs read the folders that `cargo vantage plan` writes.
//!
//! `tests/readers` holds Python scripts and `requirements*.txt`; its README says what each reads.
//! They run in a virtual environment of their own under the target directory.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cli;
use crate::command;
use crate::test::Outcome;
use crate::workspace::Workspace;

/// Where the scripts lie.
const FOLDER: &str = "tests/readers";

/// Writes a plan, installs the readers and runs each of them on it.
pub fn test(workspace: &Workspace) -> Result<Outcome> {
    let folder = workspace.path(FOLDER);
    if !folder.is_dir() {
        return Ok(Outcome::Skipped(format!("{FOLDER} does not exist")));
    }
    let environment = workspace.target.join("xtask/readers");
    let python = match install(workspace, &folder, &environment) {
        Ok(python) => python,
        Err(error) => return Ok(Outcome::Skipped(format!("pip could not install: {error:#}"))),
    };
    let plan = write_plan(workspace)?;
    for script in files(&folder, "", ".py")? {
        command::run(command::new(&workspace.root, &python).arg(script).arg(&plan))?;
    }
    Ok(Outcome::Passed)
}

/// A folder with every export of one plan.
fn write_plan(workspace: &Workspace) -> Result<PathBuf> {
    let out = workspace.target.join("xtask/readers-plan");
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    let program = cli::build(workspace)?;
    let mut plan = command::new(&workspace.root, program);
    command::run(plan.args(["plan", "--out"]).arg(&out))?;
    Ok(out)
}

/// Makes the environment, unless it holds these very requirements already; returns its Python.
fn install(workspace: &Workspace, folder: &Path, environment: &Path) -> Result<PathBuf> {
    let requirements = files(folder, "requirements", ".txt")?;
    let mut wanted = String::new();
    for path in &requirements {
        wanted += &fs::read_to_string(path)?;
    }
    let stamp = environment.join("installed.txt");
    let python = environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if python.exists() && fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    let mut venv = command::new(&workspace.root, "python3");
    command::run(venv.args(["-m", "venv", "--clear"]).arg(environment))?;
    if !requirements.is_empty() {
        let mut pip = command::new(&workspace.root, &python);
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        for path in &requirements {
            pip.arg("--requirement").arg(path);
        }
        command::run(&mut pip)?;
    }
    fs::write(stamp, wanted)?;
    Ok(python)
}

/// The files of a folder whose names begin and end so, sorted.
fn files(folder: &Path, begin: &str, end: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("no folder {}", folder.display()))? {
        let entry = entry?;
        let name = entry.file_name();
        if name.to_str().is_some_and(|name| name.starts_with(begin) && name.ends_with(end)) {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}
