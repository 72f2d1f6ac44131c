//! Every target writes the text of `tests/same-plan`; all must equal the committed one.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use crate::command;
use crate::firmware;
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};

const GOLDEN: &str = "tests/same-plan/golden/plans.txt";

/// The visibility table that plans are made over: generated Rust, compiled into every target.
const SCENE: &str = "tests/same-plan/src/scene.rs";

/// The recorded scene is what its generator writes today.
pub fn scene(workspace: &Workspace) -> Result<()> {
    compare(workspace, SCENE, &scene_text(workspace)?)
}

/// The release build of the host.
pub fn on_host(workspace: &Workspace) -> Result<()> {
    compare(workspace, GOLDEN, &host_text(workspace)?)
}

/// WebAssembly, in Node.
pub fn on_wasm32(workspace: &Workspace) -> Result<()> {
    let (mut build, folder) = Target::Wasm32.build(workspace);
    command::run(build.args(["--package", "same-plan-wasm"]))?;
    let mut node = command::new(&workspace.root, "node");
    node.arg("tests/same-plan/run-wasm.mjs").arg(folder.join("same_plan_wasm.wasm"));
    compare(workspace, GOLDEN, &command::capture_within(&mut node, Duration::from_secs(120))?)
}

/// The firmware, in QEMU.
pub fn on_thumbv7em(workspace: &Workspace) -> Result<()> {
    let folder = firmware::build(workspace)?;
    compare(workspace, GOLDEN, &firmware::run(workspace, &folder.join("firmware-same-plan"))?)
}

/// Records the scene anew, then rewrites the committed text from the host's build.
pub fn write_golden(workspace: &Workspace) -> Result<()> {
    rewrite(workspace, SCENE, &scene_text(workspace)?)?;
    rewrite(workspace, GOLDEN, &host_text(workspace)?)
}

fn rewrite(workspace: &Workspace, file: &str, text: &str) -> Result<()> {
    let path = workspace.path(file);
    let before = fs::read_to_string(&path).unwrap_or_default();
    match first_difference(text, &before) {
        None => println!("{file} stays as it is"),
        Some(difference) => {
            fs::write(&path, text).with_context(|| format!("{file} could not be written"))?;
            println!("{file} is rewritten; the first change:\n{difference}");
        }
    }
    Ok(())
}

fn scene_text(workspace: &Workspace) -> Result<String> {
    let mut record = command::new(&workspace.root, cargo());
    // A program and not an example: examples build all that tests need besides.
    let program = ["--package", "vantage-lab", "--bin", "record_scene"];
    record.args(["run", "--quiet", "--release"]).args(program);
    command::capture_within(&mut record, Duration::from_secs(1800))
}

fn host_text(workspace: &Workspace) -> Result<String> {
    let mut host = command::new(&workspace.root, cargo());
    host.args(["run", "--quiet", "--release", "--package", "same-plan"]);
    command::capture_within(&mut host, Duration::from_secs(1800))
}

fn compare(workspace: &Workspace, file: &str, written: &str) -> Result<()> {
    let path: PathBuf = workspace.path(file);
    let committed = fs::read_to_string(path).with_context(|| format!("{file} is not there"))?;
    if let Some(difference) = first_difference(written, &committed) {
        bail!(
            "the text differs from {file}:\n{difference}\nIf the change is meant, run \
             `cargo xtask golden` and commit the difference"
        );
    }
    println!("{} lines, {} bytes: as committed", written.lines().count(), written.len());
    Ok(())
}

/// The first line in which two texts differ, with the section it is in; `None` if equal.
fn first_difference(written: &str, committed: &str) -> Option<String> {
    if written == committed {
        return None;
    }
    let mut section = "";
    let mut ours = written.split_inclusive('\n');
    let mut theirs = committed.split_inclusive('\n');
    for number in 1.. {
        let (a, b) = (ours.next(), theirs.next());
        if a != b || a.is_none() {
            let show = |line: Option<&str>| line.map_or("(no line)".into(), |l| format!("{l:?}"));
            return Some(format!(
                "  line {number}, section {section}\n  written:   {}\n  committed: {}",
                show(a),
                show(b)
            ));
        }
        section = a.filter(|line| line.starts_with('[')).map_or(section, str::trim_end);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::first_difference;

    #[test]
    fn equal_texts_do_not_differ() {
        assert_eq!(first_difference("[a]\n1\n", "[a]\n1\n"), None);
    }

    #[test]
    fn the_first_differing_line_is_named_with_its_section() {
        let difference = first_difference("[a]\n1\n[b]\n2\n", "[a]\n1\n[b]\n3\n").unwrap();
        assert!(difference.contains("line 4, section [b]"), "{difference}");
    }

    #[test]
    fn a_missing_line_and_a_missing_line_end_differ() {
        assert!(first_difference("[a]\n", "[a]\n1\n").unwrap().contains("(no line)"));
        assert!(first_difference("1", "1\n").is_some());
        assert!(first_difference("", "1\n").is_some());
    }
}
