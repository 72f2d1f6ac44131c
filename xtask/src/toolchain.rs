//! The targets we cross-compile to, and how cargo is called for them.
//!
//! The ordinary way is a target that rustup installed. Where rustup cannot download, Debian's
//! `rustc-web`, `cargo-web` and `rust-web-src` build the standard library from source: that needs
//! the unstable `-Zbuild-std`, which RUSTC_BOOTSTRAP=1 allows on a stable compiler.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command;
use crate::workspace::{Workspace, cargo};

/// A target besides the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// WebAssembly in a browser or in Node.
    Wasm32,
    /// Cortex-M4F and Cortex-M7 without an operating system.
    Thumbv7em,
    /// Cortex-M33, such as in the RP2350.
    Thumbv8m,
    /// RISC-V without floating point, such as the RP2350's other cores.
    Riscv32,
}

/// The packages that hold Debian's newest compiler and the sources of its standard library.
pub const DEBIAN_PACKAGES: &[&str] = &["rustc-web", "cargo-web", "rust-web-src", "lld"];

const DEBIAN_CARGO: &str = "/usr/bin/cargo";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

impl Target {
    /// The name that rustc knows.
    pub fn triple(self) -> &'static str {
        match self {
            Self::Wasm32 => "wasm32-unknown-unknown",
            Self::Thumbv7em => "thumbv7em-none-eabihf",
            Self::Thumbv8m => "thumbv8m.main-none-eabihf",
            Self::Riscv32 => "riscv32imac-unknown-none-elf",
        }
    }

    /// The parts of the standard library to build where it is not installed.
    fn build_std(self) -> &'static str {
        match self {
            Self::Wasm32 => "-Zbuild-std=std,panic_abort",
            Self::Thumbv7em | Self::Thumbv8m | Self::Riscv32 => "-Zbuild-std=core,alloc",
        }
    }

    /// Whether anything on this machine can build for the target.
    pub fn is_available(self) -> bool {
        self.is_installed() || can_build_std()
    }

    /// Whether the compiler in use has the target's standard library.
    fn is_installed(self) -> bool {
        let mut rustc = command::new(Path::new("."), rustc());
        rustc.args(["--print", "target-libdir", "--target", self.triple()]);
        command::probe(&mut rustc).is_some_and(|folder| Path::new(&folder).is_dir())
    }

    /// `cargo build --release` for this target; add packages and features. Returns the folder where
    /// its programs will lie.
    pub fn build(self, workspace: &Workspace) -> (Command, PathBuf) {
        self.build_with(workspace, "release", "")
    }

    /// The same in another profile and with flags for rustc besides those of the environment.
    pub fn build_with(
        self,
        workspace: &Workspace,
        profile: &str,
        flags: &str,
    ) -> (Command, PathBuf) {
        let (mut command, target) = if self.is_installed() {
            (command::new(&workspace.root, cargo()), workspace.target.clone())
        } else {
            (debian_cargo(workspace), workspace.target.join("build-std"))
        };
        command.args(["build", "--quiet", "--profile", profile, "--target", self.triple()]);
        if !self.is_installed() {
            command.arg(self.build_std()).arg("--target-dir").arg(&target);
        }
        if !flags.is_empty() {
            let before = env::var("RUSTFLAGS").unwrap_or_default();
            command.env("RUSTFLAGS", format!("{before} {flags}").trim());
        }
        (command, target.join(self.triple()).join(profile))
    }
}

fn rustc() -> OsString {
    env::var_os("RUSTC").unwrap_or_else(|| "rustc".into())
}

/// Whether Debian's compiler and the sources of its standard library are here.
fn can_build_std() -> bool {
    let mut rustc = command::new(Path::new("/"), DEBIAN_RUSTC);
    command::probe(rustc.args(["--print", "sysroot"])).is_some_and(|sysroot| {
        Path::new(DEBIAN_CARGO).exists()
            && Path::new(&sysroot).join("lib/rustlib/src/rust/library/core").is_dir()
    })
}

/// Debian's cargo with a linker: `rust-lld` where a rustup toolchain has one, else Debian's `lld`.
fn debian_cargo(workspace: &Workspace) -> Command {
    let mut cargo = command::new(&workspace.root, DEBIAN_CARGO);
    cargo.env("RUSTC", DEBIAN_RUSTC).env("RUSTC_BOOTSTRAP", "1").env_remove("RUSTUP_TOOLCHAIN");
    let mut here = command::new(&workspace.root, rustc());
    let libraries = command::probe(here.args(["--print", "target-libdir"])).unwrap_or_default();
    let programs = Path::new(&libraries).with_file_name("bin");
    if programs.join("rust-lld").exists() {
        let path = env::var_os("PATH").unwrap_or_default();
        let folders = env::split_paths(&path).chain([programs]);
        if let Ok(path) = env::join_paths(folders) {
            cargo.env("PATH", path);
        }
    } else {
        cargo.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", "wasm-ld");
        cargo.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld");
        cargo.env("CARGO_TARGET_THUMBV8M_MAIN_NONE_EABIHF_LINKER", "ld.lld");
    }
    cargo
}
