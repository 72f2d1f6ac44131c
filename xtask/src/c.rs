//! The library for C: its header is what its sources say, and a program in C replays the captures of
//! `tests/sessions` to the same text, on the host and on two Cortex-M in QEMU.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, ensure};

use crate::command;
use crate::firmware::{self, CORTEX_M4F, CORTEX_M7};
use crate::same_plan::SESSIONS;
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};

const HEADER: &str = "core/c/include/vantage.h";

/// What every compiler is told: warnings are errors, and the header must please an old C too.
const STRICT: &[&str] = &["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O2"];

const CORTEX_M: &[&str] =
    &["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-ffreestanding"];

/// Rewrites the header.
pub fn write_header(workspace: &Workspace) -> Result<()> {
    generate(workspace, &workspace.path(HEADER))
}

/// The header is what its generator writes today.
pub fn check_header(workspace: &Workspace) -> Result<()> {
    let today = folder(workspace)?.join("vantage.h");
    generate(workspace, &today)?;
    let (today, committed) = (fs::read(today)?, fs::read(workspace.path(HEADER))?);
    ensure!(today == committed, "{HEADER} differs from its sources: run `cargo xtask header`");
    println!("{HEADER}: {} bytes, as committed", committed.len());
    Ok(())
}

fn generate(workspace: &Workspace, header: &Path) -> Result<()> {
    let mut generator = command::new(&workspace.root, cargo());
    generator.args(["run", "--quiet", "--profile", "tools", "--package", "xtask-header", "--"]);
    command::run(generator.arg("core/c").arg(header))
}

/// The program on the host.
pub fn on_host(workspace: &Workspace) -> Result<()> {
    let mut build = command::new(&workspace.root, cargo());
    command::run(build.args(["build", "--quiet", "--release", "--package", "vantage-c"]))?;
    let folder = folder(workspace)?;
    for standard in ["-std=c99", "-std=c17"] {
        let mut check = compiler(workspace, "cc", &[standard, "-fsyntax-only", "-x", "c"]);
        command::run(check.arg(HEADER))?;
    }
    let mut example = compiler(workspace, "cc", &["-std=c11", "-fsyntax-only"]);
    command::run(example.arg(readme_example(workspace, &folder)?))?;

    let program = folder.join("replay");
    let mut compile = compiler(workspace, "cc", &["-std=c11"]);
    compile.args(["examples/c/main.c", "examples/c/port_host.c", "examples/c/data.S"]);
    compile.arg(workspace.target.join("release/libvantage.a"));
    // What Rust's standard library wants of the system.
    compile.args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
    command::run(&mut compile)?;
    let mut replay = command::new(&folder, &program);
    SESSIONS.compare(workspace, &command::capture_within(&mut replay, Duration::from_secs(120))?)
}

/// The program that the README shows, with what it says is the reader's, as a file.
fn readme_example(workspace: &Workspace, folder: &Path) -> Result<PathBuf> {
    let readme = fs::read_to_string(workspace.path("examples/c/README.md"))?;
    let (_, rest) = readme.split_once("```c\n").context("the README shows no program in C")?;
    let (example, _) = rest.split_once("```").context("the README's program does not end")?;
    let yours = "#include <stdbool.h>\n#include \"vantage.h\"\n\
                 bool move_camera(const vantage_pose *to, vantage_pose *reached);\n\
                 size_t take_photo(const uint8_t **pixels);\n\
                 vantage_status guide(void);\n";
    let file = folder.join("readme.c");
    fs::write(&file, format!("{yours}{example}"))?;
    Ok(file)
}

/// The program on the Cortex-M, with a library that can only be linked if it has no way to panic.
pub fn on_cortex_m(workspace: &Workspace) -> Result<()> {
    let (mut build, built) = Target::Thumbv7em.build_with(workspace, "firmware", "");
    command::run(build.args(["--package", "vantage-c", "--features", "prove-no-panic"]))?;
    let program = folder(workspace)?.join("replay.elf");
    let mut compile = compiler(workspace, "arm-none-eabi-gcc", CORTEX_M);
    compile.args([
        "-std=c11",
        "-nostdlib",
        "-Wl,--gc-sections,-z,noexecstack",
        "-T",
        "examples/c/cortex_m.ld",
    ]);
    compile.args(["examples/c/main.c", "examples/c/port_cortex_m.c", "examples/c/data.S"]);
    compile.arg(built.join("libvantage.a")).arg("-o").arg(&program);
    command::run(&mut compile)?;
    for machine in [CORTEX_M4F, CORTEX_M7] {
        print!("{machine}: ");
        SESSIONS.compare(workspace, &firmware::run_on(workspace, machine, &program)?)?;
    }
    Ok(())
}

fn compiler(workspace: &Workspace, program: &str, more: &[&str]) -> std::process::Command {
    let mut compiler = command::new(&workspace.root, program);
    compiler.args(STRICT).args(more).arg("-Icore/c/include");
    compiler
}

/// Where programs in C are built.
fn folder(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.target.join("xtask/c");
    fs::create_dir_all(&folder).with_context(|| format!("no folder {}", folder.display()))?;
    Ok(folder)
}
