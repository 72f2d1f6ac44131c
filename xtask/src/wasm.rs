//! Builds `vantage-wasm` twice, with and without vectors, and makes an npm package of it in
//! `wasm/pkg`, which git ignores.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::command;
use crate::toolchain::Target;
use crate::web;
use crate::workspace::{Workspace, cargo};

/// The package's folder.
const PACKAGE: &str = "wasm/pkg";

/// Files of the package that lie in the repository, and where.
const SOURCES: &[(&str, &[&str])] = &[
    ("wasm/js", &["package.json", "index.d.ts", "browser.js", "node.js", "load.js"]),
    ("wasm", &["README.md"]),
    ("lab/models", &["soarnet.model", "soarnet-poses.model"]),
    (".", &["LICENSE-APACHE", "LICENSE-MIT"]),
];

/// What the generator writes; the same for both builds.
const BINDINGS: &[&str] = &["vantage_wasm.js", "vantage_wasm.d.ts"];

/// The builds, and what rustc is told for each.
const BUILDS: &[(&str, &str)] = &[("scalar", ""), ("simd", "-Ctarget-feature=+simd128")];

/// Its tests, in `wasm/tests`.
const TESTS: &[&str] =
    &["golden", "session", "board", "errors", "misuse", "load", "readme", "example"];

/// Builds the package; returns its folder.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    let package = workspace.path(PACKAGE);
    fs::create_dir_all(&package)?;
    let mut last: Option<PathBuf> = None;
    for &(name, flags) in BUILDS {
        let bound = bind(workspace, name, flags)?;
        let wasm = format!("vantage_{name}.wasm");
        copy(&bound.join("vantage_wasm_bg.wasm"), &package.join(&wasm))?;
        let size = fs::metadata(package.join(&wasm))?.len();
        println!("{PACKAGE}/{wasm}: {size} bytes");
        for file in BINDINGS {
            // One script serves both wasm files, so they must not ask for two.
            if let Some(last) = &last
                && fs::read(last.join(file))? != fs::read(bound.join(file))?
            {
                bail!("the builds' {file} differ: see {} and {}", last.display(), bound.display());
            }
            copy(&bound.join(file), &package.join(file))?;
        }
        last = Some(bound);
    }
    for &(folder, files) in SOURCES {
        for file in files {
            copy(&workspace.path(folder).join(file), &package.join(file))?;
        }
    }
    Ok(package)
}

/// The package in Node: the committed plans in both builds, refusals, misuse, and the example.
pub fn test(workspace: &Workspace) -> Result<()> {
    build(workspace)?;
    let inputs = workspace.target.join("same-plan-inputs");
    let mut same_plan = command::new(&workspace.root, cargo());
    same_plan.args(["run", "--quiet", "--release", "--package", "same-plan", "--"]).arg(&inputs);
    command::run(&mut same_plan)?;

    web::install(workspace, "examples/node")?;
    let capture = workspace.target.join("example-capture");
    if capture.exists() {
        fs::remove_dir_all(&capture)?;
    }
    let mut plan = command::new(&workspace.root, cargo());
    plan.args([
        "run",
        "--quiet",
        "--release",
        "--package",
        "vantage-lab",
        "--bin",
        "vantage",
        "--",
    ]);
    plan.args(["plan", "knot", "--budget", "8", "--candidates", "60", "--out"]).arg(&capture);
    command::run(&mut plan)?;

    // The scalar build may differ in its plans alone.
    for (name, tests) in [("simd", TESTS), ("scalar", &["golden"])] {
        let mut node = command::new(&workspace.root, "node");
        node.args(["--test", "--test-reporter=dot"]);
        node.args(tests.iter().map(|test| format!("wasm/tests/{test}.test.mjs")));
        node.env("VANTAGE_BUILD", name).env("VANTAGE_INPUTS", &inputs);
        command::run(node.env("VANTAGE_CAPTURE", &capture))?;
    }
    Ok(())
}

/// Compiles one build and writes its bindings; returns their folder.
fn bind(workspace: &Workspace, name: &str, flags: &str) -> Result<PathBuf> {
    let (mut build, built) = Target::Wasm32.build_with(workspace, "wasm", flags);
    command::run(build.args(["--package", "vantage-wasm"]))?;
    let folder = workspace.target.join("bindings").join(name);
    let mut bindgen = command::new(&workspace.root, cargo());
    bindgen.args(["run", "--quiet", "--profile", "tools", "--package", "xtask-bindgen", "--"]);
    command::run(bindgen.arg(built.join("vantage_wasm.wasm")).arg(&folder))?;
    Ok(folder)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to)
        .with_context(|| format!("{} was not copied to {}", from.display(), to.display()))?;
    Ok(())
}
