//! Smoke tests of the command line: real commands, and bad input that must be refused well.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::command;
use crate::workspace::{Workspace, cargo};

/// A call of `cargo vantage` and what must come of it.
struct Check {
    /// What follows `cargo vantage`, separated by spaces. `{out}` stands for a folder of this
    /// check, empty but for the folder `{in}` with [`FILES`].
    call: &'static str,
    expect: Expect,
}

/// What must come of a call.
enum Expect {
    /// Exit code 0, and these files in `{out}`, none of them empty.
    Files(&'static [&'static str]),
    /// Exit code 0, and this text on standard output.
    Says(&'static str),
    /// Another exit code, this text on standard error, no panic, and nothing new in `{out}`.
    Refusal(&'static str),
}

use Expect::{Files, Refusal, Says};

/// What is there before a call, by path below `{in}`.
const FILES: &[(&str, &[u8])] = &[
    // A GLB header that announces 4 GB, and no more.
    ("damaged.glb", b"glTF\x02\0\0\0\xff\xff\xff\xff"),
    ("no-list/transforms.json", br#"{"fl_x": 50}"#),
    ("no-json/transforms.json", b"frames"),
    ("no-pose/transforms.json", br#"{"fl_x": 50, "frames": [{"file_path": "photo.png"}]}"#),
    (
        "no-lens/transforms.json",
        br#"{"frames": [{"file_path": "photo.png", "transform_matrix":
        [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}]}"#,
    ),
    ("no-photo/transforms.json", ONE_FRAME),
    ("bad-photo/transforms.json", ONE_FRAME),
    ("bad-photo/photo.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"),
    ("poses.model", include_bytes!("../../lab/models/soarnet-poses.model")),
];

const ONE_FRAME: &[u8] = br#"{"fl_x": 50, "frames": [{"file_path": "photo.png", "transform_matrix":
    [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}]}"#;

const SMALL: &[&str] = &[
    "plan/transforms.json",
    "plan/plan.json",
    "plan/report.html",
    "plan/sparse_pc.ply",
    "plan/sparse/0/images.bin",
    "plan/images/frame_00001.png",
    "plan/images/frame_00005.png",
];

/// Every check. To add one, add a line.
#[rustfmt::skip]
const CHECKS: &[Check] = &[
    Check { call: "--help", expect: Says("plan") },
    Check { call: "plan --candidates 30 --budget 5 --size 64 --out {out}/plan", expect: Files(SMALL) },
    Check { call: "plan ball --scheme fps --candidates 30 --budget 5 --json", expect: Says("\"ball\"") },
    Check { call: "plan ball --space rings --candidates 24 --budget 4 --literal", expect: Says("4 of 24") },
    Check {
        call: "compare ball --schemes random,e --budgets 3,6 --seeds 1 --candidates 30",
        expect: Says("random"),
    },
    Check { call: "device --port {in}/no-port status", expect: Refusal("cannot open the port") },
    Check { call: "device --port {in}/no-port --patience 0 status", expect: Refusal("give --patience") },
    Check { call: "fly", expect: Refusal("unrecognized subcommand 'fly'") },
    Check { call: "plan --budget 0", expect: Refusal("at least one view") },
    Check { call: "plan --budget 101", expect: Refusal("larger than the 100 candidates") },
    Check { call: "plan --candidates 0", expect: Refusal("at least one view") },
    Check { call: "plan --scheme best", expect: Refusal("no scheme `best`") },
    Check {
        call: "plan ball --scheme soarnet-support --model {in}/poses.model",
        expect: Refusal("needs a model that looks at photos"),
    },
    Check { call: "plan --movement-cost nan", expect: Refusal("movement cost must lie between 0 and 1") },
    Check { call: "plan --size 0 --out {out}/plan", expect: Refusal("give --size between") },
    Check {
        call: "plan --space rings --min-elevation 80 --max-elevation 5",
        expect: Refusal("elevations must rise"),
    },
    Check { call: "plan no-such-object --out {out}/plan", expect: Refusal("no-such-object") },
    Check { call: "plan {in}/damaged.glb --out {out}/plan", expect: Refusal("damaged") },
    Check { call: "plan --pool {in}/damaged.glb", expect: Refusal("damaged.glb") },
    Check { call: "plan --candidates 30 --budget 5 --size 64 --out {out}", expect: Refusal("not empty") },
    Check { call: "plan --out {in}/damaged.glb/plan", expect: Refusal("damaged.glb is a file") },
    Check { call: "plan --photos {out}/none --out {out}/plan", expect: Refusal("there is no folder") },
    Check { call: "plan --photos {out} --out {out}/plan", expect: Refusal("holds no transforms.json") },
    Check { call: "plan --photos {in}/no-json --out {out}/plan", expect: Refusal("is not JSON") },
    Check { call: "plan --photos {in}/no-list --out {out}/plan", expect: Refusal("has no list `frames`") },
    Check { call: "plan --photos {in}/no-pose --out {out}/plan", expect: Refusal("has no `transform_matrix`") },
    Check { call: "plan --photos {in}/no-lens --out {out}/plan", expect: Refusal("has no `fl_x`") },
    Check { call: "plan --photos {in}/no-photo --out {out}/plan", expect: Refusal("there is no such file") },
    Check { call: "plan --photos {in}/bad-photo --out {out}/plan", expect: Refusal("cannot be decoded") },
    Check {
        call: "plan ball --scheme soarnet --model {in}/damaged.glb --out {out}/plan",
        expect: Refusal("damaged.glb cannot be used"),
    },
    Check { call: "compare --budgets 0", expect: Refusal("at least one view") },
    Check { call: "compare --schemes best", expect: Refusal("no scheme `best`") },
];

/// Builds `vantage` and makes every check.
pub fn test(workspace: &Workspace) -> Result<()> {
    let program = build(workspace)?;
    let mut failures = Vec::new();
    for (index, check) in CHECKS.iter().enumerate() {
        let out = workspace.target.join("xtask/cli").join(index.to_string());
        let result = run(&program, check, &out);
        let title = format!("vantage {}", check.call);
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

/// Builds the program with the tests' profile, whose dependencies are built already and whose
/// overflow checks are on; returns its path.
pub fn build(workspace: &Workspace) -> Result<PathBuf> {
    let mut build = command::new(&workspace.root, cargo());
    build.args(["build", "--quiet", "--package", "vantage-lab", "--bin", "vantage"]);
    command::run(&mut build)?;
    Ok(workspace.target.join("debug").join(format!("vantage{}", std::env::consts::EXE_SUFFIX)))
}

fn run(program: &Path, check: &Check, out: &Path) -> Result<()> {
    if out.exists() {
        fs::remove_dir_all(out)?;
    }
    for (name, bytes) in FILES {
        let file = out.join("in").join(name);
        fs::create_dir_all(file.parent().unwrap_or(out))?;
        fs::write(file, bytes)?;
    }
    let folder = out.to_str().context("the target directory's path is not UTF-8")?;
    let mut call = command::new(out, program);
    let words = check.call.split(' ');
    call.args(words.map(|word| word.replace("{in}", "{out}/in").replace("{out}", folder)));

    let output = call.output().context("the program did not start")?;
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr);
    ensure!(!stderr.contains("panicked at"), "it panicked: {stderr}");
    match check.expect {
        Files(files) => {
            ensure!(output.status.success(), "{}: {stderr}", output.status);
            for file in files {
                let size = fs::metadata(out.join(file)).map_or(0, |metadata| metadata.len());
                ensure!(size > 0, "it wrote no {file}");
            }
        }
        Says(text) => {
            ensure!(output.status.success(), "{}: {stderr}", output.status);
            ensure!(stdout.contains(text), "it does not say `{text}`: {stdout}");
        }
        Refusal(text) => {
            ensure!(!output.status.success(), "it accepted what it must refuse");
            ensure!(stderr.contains(text), "its refusal does not say `{text}`: {stderr}");
            let left = fs::read_dir(out)?.count();
            ensure!(left == 1, "it left {} files or folders behind", left - 1);
        }
    }
    Ok(())
}
