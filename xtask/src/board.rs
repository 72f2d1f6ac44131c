//! The tag board: a film for a fake camera, and OpenCV's opinion of what we see in it.

use std::fs;
use std::path::PathBuf;

use anyhow::Result;

use crate::command;
use crate::readers;
use crate::test::Outcome;
use crate::workspace::{Workspace, cargo};

/// The focal length of the film's camera; `lab/examples/fake_camera.rs` states it.
const FOCAL_PX: &str = "560";

/// The film of an object on the board, and its truth beside it as JSON; rendered again when the
/// program that renders it has changed.
pub fn film(workspace: &Workspace) -> Result<PathBuf> {
    let program = ["--quiet", "--package", "vantage-lab", "--example", "fake_camera"];
    let mut build = command::new(&workspace.root, cargo());
    command::run(build.arg("build").args(program))?;
    let film = workspace.target.join("xtask/fake-camera/film.y4m");
    let renderer = workspace
        .target
        .join("debug/examples")
        .join(format!("fake_camera{}", std::env::consts::EXE_SUFFIX));
    let changed = fs::metadata(&renderer)?.modified()?;
    let is_new = fs::metadata(&film).and_then(|film| film.modified()).is_ok_and(|at| at > changed);
    if !is_new {
        fs::create_dir_all(workspace.target.join("xtask/fake-camera"))?;
        // A film that was cut short must not be taken for a whole one.
        let unfinished = film.with_extension("part.y4m");
        command::run(command::new(&workspace.root, &renderer).arg(&unfinished))?;
        fs::rename(unfinished.with_extension("json"), film.with_extension("json"))?;
        fs::rename(&unfinished, &film)?;
    }
    Ok(film)
}

/// Compares tags, poses and drawing with OpenCV's and with the truth; the script also shows that it
/// finds faults.
pub fn test(workspace: &Workspace) -> Result<Outcome> {
    let Some(python) = readers::python(workspace) else {
        return Ok(Outcome::Skipped("there is no Python that OpenCV has a wheel for".into()));
    };
    let requirements = "tests/board/requirements.txt";
    let environment = readers::install(workspace, &python, "board", requirements, &[])?;
    let film = film(workspace)?;
    let out = workspace.target.join("xtask/board");
    let mut track = command::new(&workspace.root, cargo());
    track.args(["run", "--quiet", "--package", "vantage-board", "--example", "track_film", "--"]);
    command::run(track.arg(&film).arg(FOCAL_PX).arg(&out))?;
    for mode in [None, Some("--self-test")] {
        let mut check = command::new(&workspace.root, &environment);
        check.arg("tests/board/check_opencv.py").args(mode).arg(&film).arg(&out);
        command::run(&mut check)?;
    }
    Ok(Outcome::Passed)
}
