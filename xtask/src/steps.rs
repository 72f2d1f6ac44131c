//! The steps of `cargo xtask test`, in their order: what is quick and says most comes first.

use anyhow::Result;

use crate::command;
use crate::firmware::{CORTEX_M4F, CORTEX_M7};
use crate::same_plan::{PLANS, SESSIONS};
use crate::setup::Need;
use crate::test::Outcome;
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};
use crate::{
    board, c, cli, core_rules, footprint, guidance, kernels, readers, same_plan, train, wasm, web,
};

/// One step of the tests.
pub struct Step {
    /// What one types to run it alone.
    pub name: &'static str,
    /// What it shows, in one line.
    pub about: &'static str,
    /// Left out by `--quick`.
    pub slow: bool,
    /// Without these it is skipped, by name.
    pub needs: &'static [Need],
    /// Runs it; an error is a failure.
    pub run: fn(&Workspace) -> Result<Outcome>,
}

/// Every step.
pub const STEPS: &[Step] = &[
    Step {
        name: "core-rules",
        about: "core names no std, no alloc, and no unsafe outside its kernels",
        slow: false,
        needs: &[],
        run: |workspace| core_rules::check(workspace).map(Outcome::passed),
    },
    Step {
        name: "format",
        about: "the sources are as rustfmt writes them",
        slow: false,
        needs: &[Need::Rustfmt],
        run: |workspace| run_cargo(workspace, &["fmt", "--all", "--check"]),
    },
    Step {
        name: "clippy",
        about: "the linter finds nothing, with all features",
        slow: false,
        needs: &[Need::Clippy],
        run: clippy,
    },
    Step {
        name: "unit",
        about: "cargo test of the whole workspace but the training, whose libraries take minutes",
        slow: false,
        needs: &[],
        run: unit,
    },
    Step {
        name: "core-features",
        about: "core's tests with no features, each alone, and all",
        slow: true,
        needs: &[],
        run: core_features,
    },
    Step {
        name: "core-wasm32",
        about: "core builds for wasm32-unknown-unknown",
        slow: false,
        needs: &[Need::Wasm32],
        run: |workspace| build_core(workspace, Target::Wasm32),
    },
    Step {
        name: "core-thumbv7em",
        about: "core builds for thumbv7em-none-eabihf, where there is no std",
        slow: false,
        needs: &[Need::Thumbv7em],
        run: |workspace| build_core(workspace, Target::Thumbv7em),
    },
    Step {
        name: "rustdoc",
        about: "the documentation builds without a warning",
        slow: true,
        needs: &[],
        run: rustdoc,
    },
    Step {
        name: "same-plan-scene",
        about: "the recorded scene is what its generator writes",
        slow: true,
        needs: &[],
        run: |workspace| same_plan::scene(workspace).map(Outcome::passed),
    },
    Step {
        name: "same-plan-host",
        about: "the host's release build writes the committed plans",
        slow: false,
        needs: &[],
        run: |workspace| PLANS.on_host(workspace).map(Outcome::passed),
    },
    Step {
        name: "same-plan-wasm32",
        about: "WebAssembly in Node writes the committed plans",
        slow: false,
        needs: &[Need::Wasm32, Need::Node],
        run: |workspace| PLANS.on_wasm32(workspace).map(Outcome::passed),
    },
    Step {
        name: "same-plan-thumbv7em",
        about: "a Cortex-M4F in QEMU writes the committed plans",
        slow: false,
        needs: &[Need::Thumbv7em, Need::Qemu],
        run: |workspace| PLANS.on_cortex_m(workspace, &[CORTEX_M4F]).map(Outcome::passed),
    },
    Step {
        name: "kernels",
        about: "the int8 kernels equal their definition, at the instructions that they may cost",
        slow: true,
        needs: &[Need::Thumbv7em, Need::Qemu, Need::Wasm32, Need::Node],
        run: |workspace| kernels::test(workspace).map(Outcome::passed),
    },
    Step {
        name: "sessions-recordings",
        about: "the recorded captures are what their generator writes",
        slow: true,
        needs: &[],
        run: |workspace| same_plan::recordings(workspace).map(Outcome::passed),
    },
    Step {
        name: "sessions-host",
        about: "the host's release build replays the captures to the committed text",
        slow: false,
        needs: &[],
        run: |workspace| SESSIONS.on_host(workspace).map(Outcome::passed),
    },
    Step {
        name: "sessions-wasm32",
        about: "WebAssembly in Node does the same",
        slow: false,
        needs: &[Need::Wasm32, Need::Node],
        run: |workspace| SESSIONS.on_wasm32(workspace).map(Outcome::passed),
    },
    Step {
        name: "sessions-cortex-m",
        about: "a Cortex-M4F and a Cortex-M7 in QEMU do the same",
        slow: false,
        needs: &[Need::Thumbv7em, Need::Qemu],
        run: |workspace| {
            SESSIONS.on_cortex_m(workspace, &[CORTEX_M4F, CORTEX_M7]).map(Outcome::passed)
        },
    },
    Step {
        name: "firmware",
        about: "guidance, a device and the count of instructions on a Cortex-M4F and a Cortex-M7",
        slow: true,
        needs: &[Need::Thumbv7em, Need::Qemu],
        run: |workspace| guidance::test(workspace).map(Outcome::passed),
    },
    Step {
        name: "firmware-builds",
        about: "a Cortex-M33 gives the same plans; a Pico 2's program and RISC-V build",
        slow: true,
        needs: &[Need::Thumbv8m, Need::Riscv32, Need::Qemu],
        run: |workspace| guidance::other_targets(workspace).map(Outcome::passed),
    },
    Step {
        name: "panic-free",
        about: "planning, inference, snapshots and the device have no way to panic on a Cortex-M",
        slow: true,
        needs: &[Need::Thumbv7em],
        run: |workspace| footprint::panic_free(workspace).map(Outcome::passed),
    },
    Step {
        name: "size",
        about: "flash, RAM and stack of a device are within the budgets",
        slow: true,
        needs: &[Need::Thumbv7em, Need::Qemu],
        run: |workspace| footprint::size(workspace, &[]).map(Outcome::passed),
    },
    Step {
        name: "c-header",
        about: "the header for C is what its sources say",
        slow: true,
        needs: &[],
        run: |workspace| c::check_header(workspace).map(Outcome::passed),
    },
    Step {
        name: "c-host",
        about: "a program in C replays the captures to the committed text",
        slow: false,
        needs: &[Need::Cc],
        run: |workspace| c::on_host(workspace).map(Outcome::passed),
    },
    Step {
        name: "c-cortex-m",
        about: "the same on a Cortex-M4F and a Cortex-M7 in QEMU, without a way to panic",
        slow: false,
        needs: &[Need::Thumbv7em, Need::Qemu, Need::ArmGcc],
        run: |workspace| c::on_cortex_m(workspace).map(Outcome::passed),
    },
    Step {
        name: "wasm-package",
        about: "the npm package in Node: the committed plans, every refusal, misuse, the example",
        slow: true,
        needs: &[Need::Wasm32, Need::Npm],
        run: |workspace| wasm::test(workspace).map(Outcome::passed),
    },
    Step {
        name: "cli",
        about: "the command line writes what it says and refuses bad input",
        slow: false,
        needs: &[],
        run: |workspace| cli::test(workspace).map(Outcome::passed),
    },
    Step {
        name: "readers",
        about: "other people's programs read our exports",
        slow: true,
        needs: &[Need::Python],
        run: readers::test,
    },
    Step {
        name: "board-opencv",
        about: "the tag board's corners, poses and drawing against the truth and OpenCV",
        slow: true,
        needs: &[Need::Python],
        run: board::test,
    },
    Step {
        name: "train",
        about: "a small data set becomes a trained network, ONNX, a model file and a plan",
        slow: true,
        needs: &[],
        run: |workspace| train::test(workspace).map(Outcome::passed),
    },
    Step {
        name: "train-onnx",
        about: "ONNX's checker and onnxruntime agree with the network as it is trained",
        slow: true,
        needs: &[Need::Python],
        run: train::onnx,
    },
    Step {
        name: "web",
        about: "the page's types and tests, and its production build",
        slow: true,
        needs: &[Need::Wasm32, Need::Npm],
        run: web::test,
    },
    Step {
        name: "page",
        about: "the built page in Chromium: captures, bad input, offline, accessibility",
        slow: true,
        needs: &[Need::Wasm32, Need::Npm, Need::Chromium],
        run: web::test_in_browser,
    },
    Step {
        name: "page-readers",
        about: "other people's programs read what the page has saved",
        slow: true,
        needs: &[Need::Python],
        run: readers::test_page,
    },
];

fn run_cargo(workspace: &Workspace, arguments: &[&str]) -> Result<Outcome> {
    command::run(command::new(&workspace.root, cargo()).args(arguments))?;
    Ok(Outcome::Passed)
}

fn clippy(workspace: &Workspace) -> Result<Outcome> {
    let scope = ["clippy", "--quiet", "--workspace", "--all-targets", "--all-features"];
    run_cargo(workspace, &[scope.as_slice(), &["--", "-D", "warnings"]].concat())
}

fn unit(workspace: &Workspace) -> Result<Outcome> {
    // Step `train` tests both with optimisation, and so builds burn and tract once.
    let scope = ["--workspace", "--exclude", "vantage-train", "--exclude", "vantage-fields"];
    run_cargo(workspace, &[["test", "--quiet"].as_slice(), &scope].concat())
}

fn core_features(workspace: &Workspace) -> Result<Outcome> {
    let features = workspace.features("vantage-core")?;
    let mut sets = vec![String::new()];
    sets.extend(features.iter().cloned());
    if features.len() > 1 {
        sets.push(features.join(","));
    }
    for set in &sets {
        let base = ["test", "--quiet", "--package", "vantage-core", "--no-default-features"];
        run_cargo(workspace, &[base.as_slice(), &["--features", set]].concat())?;
    }
    Ok(Outcome::Passed)
}

fn build_core(workspace: &Workspace, target: Target) -> Result<Outcome> {
    for features in ["--no-default-features", "--all-features"] {
        let (mut build, _) = target.build(workspace);
        command::run(build.args(["--package", "vantage-core", features]))?;
    }
    Ok(Outcome::Passed)
}

fn rustdoc(workspace: &Workspace) -> Result<Outcome> {
    let mut doc = command::new(&workspace.root, cargo());
    doc.args(["doc", "--quiet", "--workspace", "--no-deps", "--all-features"]);
    command::run(doc.env("RUSTDOCFLAGS", "-D warnings"))?;
    Ok(Outcome::Passed)
}
