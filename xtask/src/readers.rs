//! Other people's programs read the folders and networks that we export.
//!
//! `tests/readers/README.md` says what each script checks. Each reader has its own virtual
//! environment under the target directory, since they need different versions of numpy.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result};

use crate::cli;
use crate::command;
use crate::test::Outcome;
use crate::web;
use crate::workspace::{Workspace, cargo};

const FOLDER: &str = "tests/readers";

/// One script with its requirements: `check_<name>.py`, `requirements-<name>.txt`.
struct Reader {
    name: &'static str,
    /// What pip is told besides the requirements.
    pip: &'static [&'static str],
    /// For each run the folders it is given, below the one that is written for it.
    runs: &'static [&'static [&'static str]],
    /// Whether it also shows that it finds faults, in the folders of its first run.
    shows_faults: bool,
}

/// Every reader of folders. To add one, add a line.
const READERS: &[Reader] = &[
    Reader { name: "colmap", pip: &[], runs: &[&["trainer"], &["planned"]], shows_faults: true },
    Reader {
        name: "nerfbaselines",
        pip: &["--no-deps"],
        runs: &[&["trainer", "synthetic"], &["planned", "synthetic"]],
        shows_faults: true,
    },
];

/// The same for the folder that the page saved.
const PAGE_READERS: &[Reader] = &[
    Reader { name: "colmap", pip: &[], runs: &[&["toy-engine"]], shows_faults: false },
    Reader {
        name: "nerfbaselines",
        pip: &["--no-deps"],
        runs: &[&["toy-engine", "synthetic"]],
        shows_faults: false,
    },
];

/// The versions of Python for which every reader has a wheel.
const PYTHONS: [&str; 2] = ["3.11", "3.12"];

/// The reader of networks: apart, since writing one takes a deep-learning library.
const ONNX: Reader = Reader { name: "onnx", pip: &[], runs: &[&["."]], shows_faults: true };

/// Writes folders, and has them read.
pub fn test(workspace: &Workspace) -> Result<Outcome> {
    read(workspace, READERS, write_folders)
}

/// The same for the folder that step `page` has left.
pub fn test_page(workspace: &Workspace) -> Result<Outcome> {
    if !web::browser_output(workspace).join("toy-engine").exists() {
        return Ok(Outcome::Skipped("step `page` has saved nothing".into()));
    }
    read(workspace, PAGE_READERS, |workspace| {
        let out = web::browser_output(workspace);
        write_samples(workspace, &out)?;
        Ok(out)
    })
}

/// The same for the reader of networks; `write` makes the folder that it is given.
pub fn test_onnx(
    workspace: &Workspace,
    write: fn(&Workspace) -> Result<PathBuf>,
) -> Result<Outcome> {
    read(workspace, &[ONNX], write)
}

/// Installs readers, makes folders and runs each reader; every script also shows that it finds
/// faults.
fn read(
    workspace: &Workspace,
    readers: &[Reader],
    write: fn(&Workspace) -> Result<PathBuf>,
) -> Result<Outcome> {
    let Some(python) = python(workspace) else {
        return Ok(Outcome::Skipped(format!("Python {} is missing", PYTHONS.join(" or "))));
    };
    let mut environments = Vec::new();
    for reader in readers {
        let requirements = format!("{FOLDER}/requirements-{}.txt", reader.name);
        environments.push(install(workspace, &python, reader.name, &requirements, reader.pip)?);
    }
    let folders = write(workspace)?;
    for (reader, environment) in readers.iter().zip(environments) {
        // Faults are planted in one run's folders only: once is enough.
        let plain = reader.runs.iter().map(|run| (None, *run));
        let planted = reader.runs.first().filter(|_| reader.shows_faults);
        let planted = planted.map(|run| (Some("--self-test"), *run));
        for (mode, run) in plain.chain(planted) {
            let mut check = command::new(&workspace.root, &environment);
            check.arg(format!("{FOLDER}/check_{}.py", reader.name)).args(mode);
            command::run(check.args(run.iter().map(|folder| folders.join(folder))))?;
        }
    }
    Ok(Outcome::Passed)
}

/// `trainer` and `synthetic`, made without a mesh or a renderer, and `planned`, a whole plan.
fn write_folders(workspace: &Workspace) -> Result<PathBuf> {
    let out = workspace.target.join("xtask/readers-folders");
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    fs::create_dir_all(&out)?;
    write_samples(workspace, &out)?;
    let mut plan = command::new(&workspace.root, cli::build(workspace)?);
    plan.args(["plan", "--candidates", "40", "--budget", "12", "--size", "128", "--out"]);
    command::run(plan.arg(out.join("planned")).stdout(Stdio::null()))?;
    Ok(out)
}

/// `trainer` and `synthetic`; those that are there already are replaced.
fn write_samples(workspace: &Workspace, out: &Path) -> Result<()> {
    for name in ["trainer", "synthetic"] {
        let folder = out.join(name);
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
    }
    let mut example = command::new(&workspace.root, cargo());
    example.args(["run", "--quiet", "--package", "vantage-lab", "--example", "sample_folders"]);
    command::run(example.arg("--").arg(out))
}

/// A Python of a version that the readers have wheels for.
pub fn python(workspace: &Workspace) -> Option<String> {
    let names = PYTHONS.iter().map(|version| format!("python{version}"));
    ["python3".to_owned()].into_iter().chain(names).find(|name| {
        let mut version = command::new(&workspace.root, name);
        let script = "import ensurepip, sys, venv; print('%d.%d' % sys.version_info[:2])";
        command::probe(version.args(["-c", script]))
            .is_some_and(|found| PYTHONS.contains(&found.as_str()))
    })
}

/// Makes an environment, unless it holds these requirements already; gives its Python.
pub fn install(
    workspace: &Workspace,
    python: &str,
    name: &str,
    requirements: &str,
    pip_arguments: &[&str],
) -> Result<PathBuf> {
    let requirements = workspace.path(requirements);
    let wanted = fs::read_to_string(&requirements)
        .with_context(|| format!("{} is not there", requirements.display()))?;
    let environment = workspace.target.join("xtask/readers").join(name);
    let inside = environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let stamp = environment.join("installed.txt");
    if is_installed(&inside, &stamp, &wanted) {
        return Ok(inside);
    }
    let mut venv = command::new(&workspace.root, python);
    command::run(venv.args(["-m", "venv", "--clear"]).arg(&environment))?;
    let mut pip = command::new(&workspace.root, &inside);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    command::run(pip.args(pip_arguments).arg("--requirement").arg(&requirements))
        .with_context(|| format!("{name} could not be installed"))?;
    fs::write(stamp, wanted)?;
    Ok(inside)
}

fn is_installed(python: &Path, stamp: &Path, wanted: &str) -> bool {
    python.exists() && fs::read_to_string(stamp).is_ok_and(|installed| installed == wanted)
}
