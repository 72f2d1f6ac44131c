//! Texts that every target writes, and all must equal the committed one: the plans of
//! `tests/same-plan` and the recorded captures of `tests/sessions`.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};

use crate::command;
use crate::firmware;
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};

/// A text and who writes it.
pub struct Text {
    /// What is committed.
    golden: &'static str,
    /// The package whose program writes it on the host.
    host: &'static str,
    /// The package of the WebAssembly module that writes it, and its file.
    wasm: (&'static str, &'static str),
    /// The program of `examples/firmware` that writes it.
    firmware: &'static str,
}

/// Plans over made-up scenes and networks.
pub const PLANS: Text = Text {
    golden: "tests/same-plan/golden/plans.txt",
    host: "same-plan",
    wasm: ("same-plan-wasm", "same_plan_wasm.wasm"),
    firmware: "firmware-same-plan",
};

/// Recorded captures with the shipped network.
pub const SESSIONS: Text = Text {
    golden: "tests/sessions/golden/sessions.txt",
    host: "golden-sessions",
    wasm: ("golden-sessions-wasm", "golden_sessions_wasm.wasm"),
    firmware: "firmware-sessions",
};

/// The visibility table that plans are made over: generated Rust, compiled into every target.
const SCENE: &str = "tests/same-plan/src/scene.rs";

/// Where the recorded captures lie.
const RECORDINGS: &str = "tests/sessions/golden";

impl Text {
    /// The release build of the host.
    pub fn on_host(&self, workspace: &Workspace) -> Result<()> {
        self.compare(workspace, &self.host_text(workspace)?)
    }

    /// WebAssembly, in Node.
    pub fn on_wasm32(&self, workspace: &Workspace) -> Result<()> {
        let (package, file) = self.wasm;
        let (mut build, folder) = Target::Wasm32.build(workspace);
        command::run(build.args(["--package", package]))?;
        let mut node = command::new(&workspace.root, "node");
        node.arg("tests/same-plan/run-wasm.mjs").arg(folder.join(file));
        self.compare(workspace, &command::capture_within(&mut node, Duration::from_secs(120))?)
    }

    /// The firmware, in QEMU, on each of the machines.
    pub fn on_cortex_m(&self, workspace: &Workspace, machines: &[&str]) -> Result<()> {
        let program = firmware::build(workspace)?.join(self.firmware);
        for machine in machines {
            print!("{machine}: ");
            self.compare(workspace, &firmware::run_on(workspace, machine, &program)?)?;
        }
        Ok(())
    }

    /// Compares what was written with the committed text.
    pub fn compare(&self, workspace: &Workspace, written: &str) -> Result<()> {
        compare(workspace, self.golden, written)
    }

    fn host_text(&self, workspace: &Workspace) -> Result<String> {
        let mut host = command::new(&workspace.root, cargo());
        host.args(["run", "--quiet", "--release", "--package", self.host]);
        command::capture_within(&mut host, Duration::from_secs(1800))
    }
}

/// The recorded scene is what its generator writes today.
pub fn scene(workspace: &Workspace) -> Result<()> {
    compare(workspace, SCENE, &scene_text(workspace)?)
}

/// The recorded captures are what their generator writes today.
pub fn recordings(workspace: &Workspace) -> Result<()> {
    for (name, bytes) in record(workspace)? {
        let committed = fs::read(workspace.path(RECORDINGS).join(&name))
            .with_context(|| format!("{RECORDINGS}/{name} is not there"))?;
        ensure!(
            bytes == committed,
            "{RECORDINGS}/{name} differs from what is recorded today; if the change is meant, run \
             `cargo xtask golden` and commit it"
        );
        println!("{name}: {} bytes, as committed", bytes.len());
    }
    Ok(())
}

/// Records scene and captures anew, then rewrites the committed texts from the host's builds.
pub fn write_golden(workspace: &Workspace) -> Result<()> {
    rewrite(workspace, SCENE, &scene_text(workspace)?)?;
    for (name, bytes) in record(workspace)? {
        fs::write(workspace.path(RECORDINGS).join(&name), bytes)
            .with_context(|| format!("{RECORDINGS}/{name} could not be written"))?;
    }
    for text in [PLANS, SESSIONS] {
        rewrite(workspace, text.golden, &text.host_text(workspace)?)?;
    }
    Ok(())
}

/// The names and bytes of the captures as they are recorded today.
fn record(workspace: &Workspace) -> Result<Vec<(String, Vec<u8>)>> {
    let folder = workspace.target.join("xtask/recordings");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let mut record = command::new(&workspace.root, cargo());
    record.args(["run", "--quiet", "--release", "--package", "record-sessions", "--"]).arg(&folder);
    command::run(&mut record)?;
    let mut recorded = Vec::new();
    for file in fs::read_dir(&folder)? {
        let file = file?;
        recorded.push((file.file_name().to_string_lossy().into_owned(), fs::read(file.path())?));
    }
    recorded.sort();
    ensure!(!recorded.is_empty(), "record-sessions wrote nothing");
    Ok(recorded)
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
pub fn first_difference(written: &str, committed: &str) -> Option<String> {
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
