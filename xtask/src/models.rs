//! The shipped networks, trained again from nothing.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::command;
use crate::workspace::{Workspace, cargo};

/// What the networks learn from. Training looks at no validation views.
const DATA: &str =
    "dataset --objects 2200 --seed 1 --resolution 128 --trajectories 6 --validation-views 1";

/// The shipped network, the same without photos, and the paper's wording to compare with: the folder
/// of each run, its preset, and the name of its files.
const RUNS: [(&str, &str, Option<&str>); 3] = [
    ("run", "default", Some("soarnet")),
    ("run-poses", "poses", Some("soarnet-poses")),
    ("run-literal", "literal", None),
];

/// Makes the data, trains, exports and quantizes into `lab/models`; with a folder of real objects,
/// measures the networks and writes their card too. Whatever is there already is kept, so an
/// interrupted call goes on where it stopped.
pub fn make(workspace: &Workspace, real: Option<&Path>) -> Result<()> {
    let home = workspace.target.join("models");
    std::fs::create_dir_all(&home).with_context(|| format!("cannot make {}", home.display()))?;
    let of = |name: &str| path(&home.join(name));
    let data = of("data")?;
    vantage(workspace, &[words(DATA), vec!["--out", &data]].concat())?;
    for (folder, preset, name) in RUNS {
        let run = of(folder)?;
        vantage(workspace, &["train", "--data", &data, "--out", &run, "--preset", preset])?;
        let Some(name) = name else { continue };
        let shipped = |kind: &str| path(&workspace.root.join(format!("lab/models/{name}.{kind}")));
        let [onnx, model] = [shipped("onnx")?, shipped("model")?];
        vantage(workspace, &["export", &run, "--out", &onnx])?;
        vantage(workspace, &["quantize", &onnx, "--data", &data, "--out", &model])?;
    }
    let Some(real) = real else {
        println!("without --real DIR, a folder of GLB files, the networks were not measured");
        return Ok(());
    };
    let [run, poses, literal] = [of("run")?, of("run-poses")?, of("run-literal")?];
    let real = path(real)?;
    let runs = ["--run", &run, "--poses-run", &poses, "--literal-run", &literal];
    vantage(workspace, &[&["card", "--data", &data, "--real", &real], runs.as_slice()].concat())
}

/// The folder of `models --real DIR`.
pub fn real(arguments: &[String]) -> Result<Option<&Path>> {
    match arguments {
        [] => Ok(None),
        [flag, folder] if flag == "--real" => Ok(Some(Path::new(folder))),
        _ => bail!("`models` takes `--real DIR` or nothing, but got `{}`", arguments.join(" ")),
    }
}

fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

fn path(path: &Path) -> Result<String> {
    let text = path.to_str().with_context(|| format!("{} is not UTF-8", path.display()))?;
    Ok(text.to_owned())
}

fn vantage(workspace: &Workspace, arguments: &[&str]) -> Result<()> {
    println!("$ cargo vantage {}", arguments.join(" "));
    command::run(command::new(&workspace.root, cargo()).arg("vantage").args(arguments))
}
