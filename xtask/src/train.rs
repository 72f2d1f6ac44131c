//! From a small data set to a plan by a network, with the release programs, as a user would.
//!
//! All calls run in one folder, one after the other, so that each takes what those before it made.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::command;
use crate::readers;
use crate::test::Outcome;
use crate::workspace::{Workspace, cargo};

/// A call of `cargo vantage` that succeeds.
struct Stage {
    /// What follows `cargo vantage`, separated by spaces.
    call: &'static str,
    /// What it says, on standard output or standard error.
    says: &'static str,
    /// Files that are there afterwards, none of them empty.
    files: &'static [&'static str],
}

/// A call that is refused.
struct Refusal {
    call: &'static str,
    /// What its one sentence says.
    says: &'static str,
}

const TRAIN: &str = "train --data data --out run --epochs 1";

/// The way from nothing to a plan.
#[rustfmt::skip]
const STAGES: &[Stage] = &[
    Stage {
        call: "dataset --objects 24 --seed 1 --resolution 64 --views 16 --trajectories 2 --steps 8 --out data",
        says: "24 objects (19 train, 1 validation, 4 test)",
        files: &["data/manifest.json"],
    },
    Stage {
        call: TRAIN,
        says: "best epoch 0",
        files: &["run/course.json", "run/metrics.csv", "run/best.bpk"],
    },
    Stage {
        call: "export run --out network.onnx",
        says: "wrote network.onnx",
        files: &["network.onnx"],
    },
    Stage {
        call: "quantize network.onnx --data data --objects 8 --out network.model",
        says: "rank correlation",
        files: &["network.model"],
    },
    Stage {
        call: "plan ball --scheme soarnet --model network.model --candidates 30 --budget 5 --json",
        says: "\"scheme\":\"soarnet\"",
        files: &[],
    },
    Stage {
        call: EVALUATE,
        says: "fps - random",
        files: &["sweep/runs.csv", "sweep/results.json", "sweep/psnr.svg", "sweep/report.html"],
    },
    Stage {
        call: "field ball --field plenoxels --views 12 --test-views 2 --steps 60 --fly fly.gif --out field",
        says: "LPIPS no weights",
        files: &["field/course.json", "field/render-001.png", "fly.gif"],
    },
    Stage {
        call: "plan ball --scheme fps --candidates 20 --budget 8 --size 100 --profile nerf-synthetic --out scene",
        says: "farthest",
        files: &["scene/transforms_train.json", "scene/transforms_test.json"],
    },
    Stage {
        call: SYNTHETIC,
        says: "fps - random",
        files: &["synthetic/runs.csv", "synthetic/report.html"],
    },
];

const EVALUATE: &str = "evaluate ball --schemes random,fps --budgets 3 --seeds 2 --field plenoxels \
                        --steps 20 --test-views 2 --candidates 20 --out sweep";

const SYNTHETIC: &str = "evaluate scene --schemes random,fps --budgets 3 --seeds 1 --field plenoxels \
                         --steps 20 --test-views 2 --fly --out synthetic";

/// What must be refused, in a folder that [`damage`] has prepared.
#[rustfmt::skip]
const REFUSALS: &[Refusal] = &[
    Refusal { call: "train --data empty --out other", says: "holds no data set" },
    Refusal { call: "train --data cut-data --out other", says: "cannot read cut-data/objects" },
    Refusal { call: "train --data data --out run --epochs 2", says: "another recipe" },
    Refusal { call: "train --data data --out data", says: "is not empty" },
    Refusal { call: "train --data data --out network.onnx", says: "is a file" },
    Refusal { call: "train --data data --out other --epochs 0", says: "--epochs is 0" },
    Refusal { call: "train --data data --out other --batch 0", says: "--batch is 0" },
    Refusal { call: "train --data data --out other --rate nan", says: "--rate is NaN" },
    Refusal { call: "export empty --out other.onnx", says: "holds no run" },
    Refusal { call: "export cut-run --out other.onnx", says: "cannot read cut-run/best.bpk" },
    Refusal { call: "export run --out empty", says: "cannot write empty" },
    Refusal { call: "export run --out missing/other.onnx", says: "cannot write missing/other.onnx" },
    Refusal { call: "quantize foreign --data data --out other.model", says: "cannot read foreign" },
    Refusal { call: "quantize cut.onnx --data data --out other.model", says: "cannot read cut.onnx" },
    Refusal { call: "quantize network.onnx --data empty --out other.model", says: "holds no data set" },
    Refusal { call: "quantize network.onnx --data data --objects 8 --out empty", says: "cannot write empty" },
    Refusal { call: "evaluate ball --schemes best --out other", says: "no scheme `best`" },
    Refusal { call: "evaluate ball --budgets 0 --out other", says: "a budget is 0" },
    Refusal { call: "evaluate ball --test-views 0 --out other", says: "1 to 200 test views" },
    Refusal { call: "evaluate ball --out data", says: "is not empty" },
    Refusal { call: "evaluate ball --field nerf --out sweep", says: "other settings" },
    Refusal { call: "evaluate ball --lpips foreign --out other", says: "cannot use foreign for LPIPS" },
    Refusal { call: "evaluate scene --schemes fps,e --out other", says: "the scheme e needs a mesh" },
    Refusal { call: "evaluate empty --out other", says: "empty holds no GLB" },
    Refusal { call: "field ball --views 13 --out field", says: "another training" },
    Refusal { call: "field ball --fly fly.mp4", says: "ends in .gif" },
    Refusal { call: "field ball --fly missing/fly.gif", says: "no folder for missing/fly.gif" },
    Refusal { call: "plan ball --scheme soarnet --model foreign --out plan", says: "foreign cannot be used" },
    Refusal { call: "plan ball --scheme soarnet --model cut.model --out plan", says: "cut.model cannot be used" },
    Refusal { call: "plan ball --scheme soarnet --model changed.model --out plan", says: "changed.model cannot be used" },
];

/// Tests `vantage-train` and `vantage-fields`, goes the whole way, and then every way that is barred.
pub fn test(workspace: &Workspace) -> Result<()> {
    let mut test = command::new(&workspace.root, cargo());
    command::run(
        test.args(["test", "--quiet", "--release", "--package", "vantage-train"])
            .args(["--package", "vantage-fields"]),
    )?;
    let user = User {
        program: build(workspace)?,
        home: empty_folder(workspace, "train")?,
        target: workspace.target.clone(),
    };
    for stage in STAGES {
        println!("$ vantage {}", stage.call);
        user.pass(stage).with_context(|| format!("vantage {}", stage.call))?;
    }
    user.resume()?;

    damage(&user.home)?;
    let mut wrong = 0;
    for refusal in REFUSALS {
        match user.refuse(refusal) {
            Ok(sentence) => println!("  ok    {}\n        {sentence}", refusal.call),
            Err(error) => {
                println!("  wrong {}\n        {error:#}", refusal.call);
                wrong += 1;
            }
        }
    }
    ensure!(wrong == 0, "{wrong} of {} calls were not refused well", REFUSALS.len());
    Ok(())
}

/// Other people's program runs networks of random weights, and answers as ours does.
pub fn onnx(workspace: &Workspace) -> Result<Outcome> {
    readers::test_onnx(workspace, |workspace| {
        let folder = empty_folder(workspace, "onnx")?;
        let mut example = command::new(&workspace.root, cargo());
        example.args(["run", "--quiet", "--release", "--package", "vantage-train"]);
        command::run(example.args(["--example", "sample_network", "--"]).arg(&folder))?;
        Ok(folder)
    })
}

fn build(workspace: &Workspace) -> Result<PathBuf> {
    let mut build = command::new(&workspace.root, cargo());
    build.args(["build", "--quiet", "--release", "--package", "vantage-lab", "--bin", "vantage"]);
    command::run(&mut build)?;
    Ok(workspace.target.join("release").join(format!("vantage{}", std::env::consts::EXE_SUFFIX)))
}

/// A folder of this step's own, as if for the first time.
fn empty_folder(workspace: &Workspace, name: &str) -> Result<PathBuf> {
    let folder = workspace.target.join("xtask").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// How a call ended.
struct Ended {
    success: bool,
    stdout: String,
    stderr: String,
}

/// Someone at work in a folder.
struct User {
    program: PathBuf,
    home: PathBuf,
    /// Where cargo, which `vantage` calls in turn, finds what is built already.
    target: PathBuf,
}

impl User {
    fn call(&self, words: &str) -> Result<Ended> {
        let mut call = command::new(&self.home, &self.program);
        call.args(words.split(' ')).env("CARGO_TARGET_DIR", &self.target);
        let output = call.output().context("the program did not start")?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
        ensure!(!stderr.contains("panicked at"), "it panicked: {stderr}");
        Ok(Ended { success: output.status.success(), stdout, stderr })
    }

    fn pass(&self, stage: &Stage) -> Result<()> {
        let Ended { success, stdout, stderr } = self.call(stage.call)?;
        ensure!(success, "it failed: {stderr}");
        let says = stage.says;
        ensure!(
            stdout.contains(says) || stderr.contains(says),
            "it does not say `{says}`: {stdout}{stderr}"
        );
        for file in stage.files {
            let size = fs::metadata(self.home.join(file)).map_or(0, |metadata| metadata.len());
            ensure!(size > 0, "it wrote no {file}");
        }
        Ok(())
    }

    /// The same command again finds its run at its end, and trains nothing.
    fn resume(&self) -> Result<()> {
        let files = ["best.bpk", "course.json"].map(|name| self.home.join("run").join(name));
        let bytes = || files.iter().map(fs::read).collect::<Result<Vec<_>, _>>();
        let before = bytes()?;
        println!("$ vantage {TRAIN} # again");
        self.pass(&Stage { call: TRAIN, says: "best epoch 0", files: &[] })?;
        ensure!(bytes()? == before, "vantage {TRAIN}: a run that was over has changed");
        Ok(())
    }

    /// One sentence, nothing else, and nothing written; gives the sentence.
    fn refuse(&self, refusal: &Refusal) -> Result<String> {
        let before = listing(&self.home)?;
        let Ended { success, stdout, stderr } = self.call(refusal.call)?;
        ensure!(!success, "it accepted what it must refuse: {stdout}");
        // Besides, cargo says that vantage-train is built.
        let is_own = |line: &&str| !line.trim_start().starts_with("Finished `release`");
        let mut lines = stderr.lines().filter(is_own);
        let sentence = lines.next().and_then(|line| line.strip_prefix("error: "));
        let sentence = sentence.with_context(|| format!("it gives no reason: {stderr}"))?;
        ensure!(lines.next().is_none(), "it says more than one sentence: {stderr}");
        let doubled = sentence.rsplit_once(": ").is_some_and(|(rest, last)| rest.ends_with(last));
        ensure!(!doubled, "it says the same twice: {sentence}");
        let says = refusal.says;
        ensure!(sentence.contains(says), "it does not say `{says}`: {sentence}");
        ensure!(listing(&self.home)? == before, "it has left something behind, or changed it");
        Ok(sentence.to_owned())
    }
}

/// Puts damaged copies beside what the stages made.
fn damage(home: &Path) -> Result<()> {
    fs::create_dir(home.join("empty"))?;
    fs::write(home.join("foreign"), "What is this?")?;
    copy_folder(&home.join("data"), &home.join("cut-data"))?;
    fs::remove_file(home.join("cut-data").join(a_train_shard(home)?))?;
    copy_folder(&home.join("run"), &home.join("cut-run"))?;
    cut(&home.join("run/best.bpk"), &home.join("cut-run/best.bpk"))?;
    cut(&home.join("network.onnx"), &home.join("cut.onnx"))?;
    cut(&home.join("network.model"), &home.join("cut.model"))?;
    let mut bytes = fs::read(home.join("network.model"))?;
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(home.join("changed.model"), bytes)?;
    Ok(())
}

/// The file of an object that is trained on, below the data set's folder.
fn a_train_shard(home: &Path) -> Result<String> {
    let text = fs::read_to_string(home.join("data/manifest.json"))?;
    let manifest: serde_json::Value = serde_json::from_str(&text)?;
    let objects = manifest["objects"].as_array().map(Vec::as_slice).unwrap_or_default();
    let shard = objects.iter().find(|entry| entry["split"] == "train");
    let shard = shard.and_then(|entry| entry["shard"].as_str());
    Ok(shard.context("the manifest names no object to train on")?.to_owned())
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

/// The first half of a file.
fn cut(from: &Path, to: &Path) -> Result<()> {
    let bytes = fs::read(from)?;
    Ok(fs::write(to, &bytes[..bytes.len() / 2])?)
}

/// Every file below a folder with its length, and every folder.
fn listing(folder: &Path) -> Result<Vec<(PathBuf, u64)>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        if metadata.is_dir() {
            found.push((entry.path(), 0));
            found.extend(listing(&entry.path())?);
        } else {
            found.push((entry.path(), metadata.len()));
        }
    }
    found.sort();
    Ok(found)
}
