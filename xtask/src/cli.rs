//! Smoke tests of the command line: real commands, and bad input that must be refused well.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::command;
use crate::workspace::{Workspace, cargo};

/// A call of `cargo vantage` and what must come of it.
struct Check {
    /// What follows `cargo vantage`; `{out}` stands for an empty folder of this check.
    arguments: &'static [&'static str],
    expect: Expect,
}

/// What must come of a call.
#[allow(dead_code, reason = "not every kind is in use yet")]
enum Expect {
    /// Exit code 0, and these files in `{out}`, none of them empty.
    Files(&'static [&'static str]),
    /// Exit code 0, and this text on standard output.
    Says(&'static str),
    /// Another exit code, this text on standard error, and no panic.
    Refusal(&'static str),
}

/// Every check. To add one, add a line.
const CHECKS: &[Check] = &[Check { arguments: &["--help"], expect: Expect::Files(&[]) }];

/// Builds `vantage` and makes every check.
pub fn test(workspace: &Workspace) -> Result<()> {
    let program = build(workspace)?;
    let mut failures = Vec::new();
    for (index, check) in CHECKS.iter().enumerate() {
        let out = workspace.target.join("xtask/cli").join(index.to_string());
        let result = run(&program, check, &out);
        let title = format!("vantage {}", check.arguments.join(" "));
        match result {
            Ok(()) => println!("  ok    {title}"),
            Err(error) => {
                println!("  wrong {title}\n        {error:#}");
                failures.push(title);
            }
        }
    }
    ensure!(failures.is_empty(), "{} of {} checks failed", failures.len(), CHECKS.len());
    Ok(())
}

/// Builds the release program once; returns its path.
pub fn build(workspace: &Workspace) -> Result<std::path::PathBuf> {
    let mut build = command::new(&workspace.root, cargo());
    build.args(["build", "--quiet", "--release", "--package", "vantage-lab", "--bin", "vantage"]);
    command::run(&mut build)?;
    Ok(workspace.target.join("release").join(format!("vantage{}", std::env::consts::EXE_SUFFIX)))
}

fn run(program: &Path, check: &Check, out: &Path) -> Result<()> {
    if out.exists() {
        fs::remove_dir_all(out)?;
    }
    fs::create_dir_all(out)?;
    let mut call: Command = command::new(out, program);
    let folder = out.to_str().context("the target directory's path is not UTF-8")?;
    call.args(check.arguments.iter().map(|argument| argument.replace("{out}", folder)));
    let output = call.output().context("the program did not start")?;
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr);
    if stderr.contains("panicked at") {
        bail!("it panicked: {stderr}");
    }
    match &check.expect {
        Expect::Files(files) => {
            ensure!(output.status.success(), "{}: {stderr}", output.status);
            for file in *files {
                let size = fs::metadata(out.join(file)).map_or(0, |metadata| metadata.len());
                ensure!(size > 0, "it wrote no {file}");
            }
        }
        Expect::Says(text) => {
            ensure!(output.status.success(), "{}: {stderr}", output.status);
            ensure!(stdout.contains(text), "it does not say `{text}`: {stdout}");
        }
        Expect::Refusal(text) => {
            ensure!(!output.status.success(), "it accepted what it must refuse");
            ensure!(stderr.contains(text), "its refusal does not say `{text}`: {stderr}");
        }
    }
    Ok(())
}
