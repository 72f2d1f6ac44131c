//! What the tasks need beyond cargo: whether it is here, how it is obtained, what to say if not.

use std::env;
use std::path::{Path, PathBuf};

use crate::command;
use crate::toolchain::{self, Target};
use crate::workspace::{Workspace, cargo};

/// Something that a task needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The formatter.
    Rustfmt,
    /// The linter.
    Clippy,
    /// The wasm32 standard library.
    Wasm32,
    /// The thumbv7em core library.
    Thumbv7em,
    /// The core library of the Cortex-M33.
    Thumbv8m,
    /// The core library of 32-bit RISC-V.
    Riscv32,
    /// The machine that runs the firmware.
    Qemu,
    /// Node, for WebAssembly outside a browser.
    Node,
    /// Node as new as the page's build asks, and npm.
    Npm,
    /// Python with venv, for other people's readers of our files.
    Python,
    /// A browser, for the page.
    Chromium,
    /// A compiler for C.
    Cc,
    /// GCC for Cortex-M.
    ArmGcc,
}

/// The oldest Node that the page's tools (`web/package.json`, `engines`) accept.
const NODE_FOR_PAGE: (u32, u32) = (20, 19);

impl Need {
    /// Every need, in the order of messages.
    pub const ALL: [Self; 13] = [
        Self::Rustfmt,
        Self::Clippy,
        Self::Wasm32,
        Self::Thumbv7em,
        Self::Thumbv8m,
        Self::Riscv32,
        Self::Qemu,
        Self::Node,
        Self::Npm,
        Self::Python,
        Self::Chromium,
        Self::Cc,
        Self::ArmGcc,
    ];

    /// What it is called in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rustfmt => "rustfmt",
            Self::Clippy => "clippy",
            Self::Wasm32 => "Rust target wasm32-unknown-unknown",
            Self::Thumbv7em => "Rust target thumbv7em-none-eabihf",
            Self::Thumbv8m => "Rust target thumbv8m.main-none-eabihf",
            Self::Riscv32 => "Rust target riscv32imac-unknown-none-elf",
            Self::Qemu => "qemu-system-arm",
            Self::Node => "Node (18 or later)",
            Self::Npm => "npm with Node 20.19 or later",
            Self::Python => "python3 with venv",
            Self::Chromium => "Chromium or Chrome",
            Self::Cc => "cc",
            Self::ArmGcc => "arm-none-eabi-gcc",
        }
    }

    /// How a person obtains it.
    fn how(self) -> &'static str {
        match self {
            Self::Rustfmt => "rustup component add rustfmt",
            Self::Clippy => "rustup component add clippy",
            Self::Wasm32 => {
                "rustup target add wasm32-unknown-unknown; on Debian without rustup: \
                 apt-get install rustc-web cargo-web rust-web-src lld"
            }
            Self::Thumbv7em => {
                "rustup target add thumbv7em-none-eabihf; on Debian without rustup: \
                 apt-get install rustc-web cargo-web rust-web-src lld"
            }
            Self::Thumbv8m => {
                "rustup target add thumbv8m.main-none-eabihf; on Debian without rustup: \
                 apt-get install rustc-web cargo-web rust-web-src lld"
            }
            Self::Riscv32 => {
                "rustup target add riscv32imac-unknown-none-elf; on Debian without rustup: \
                 apt-get install rustc-web cargo-web rust-web-src lld"
            }
            Self::Qemu => "apt-get install qemu-system-arm, or your system's QEMU for Arm",
            Self::Node => "apt-get install nodejs, or an installer from nodejs.org",
            Self::Npm => "an installer from nodejs.org, or your system's Node and npm packages",
            Self::Python => "apt-get install python3 python3-venv",
            Self::Chromium => "apt-get install chromium, or an installer from google.com/chrome",
            Self::Cc => "apt-get install gcc, or your system's compiler for C",
            Self::ArmGcc => "apt-get install gcc-arm-none-eabi, or Arm's GNU toolchain",
        }
    }

    /// Whether it is here.
    pub fn is_met(self) -> bool {
        let run = |program: &str, arguments: &[&str]| {
            command::succeeds(command::new(Path::new("."), program).args(arguments))
        };
        let run_cargo = |subcommand: &str| {
            command::succeeds(command::new(Path::new("."), cargo()).args([subcommand, "--version"]))
        };
        match self {
            Self::Rustfmt => run_cargo("fmt"),
            Self::Clippy => run_cargo("clippy"),
            Self::Wasm32 => Target::Wasm32.is_available(),
            Self::Thumbv7em => Target::Thumbv7em.is_available(),
            Self::Thumbv8m => Target::Thumbv8m.is_available(),
            Self::Riscv32 => Target::Riscv32.is_available(),
            Self::Qemu => run("qemu-system-arm", &["--version"]),
            Self::Node => node_version().is_some_and(|version| version >= (18, 0)),
            Self::Npm => {
                node_version().is_some_and(|version| version >= NODE_FOR_PAGE)
                    && run("npm", &["--version"])
            }
            Self::Python => run("python3", &["-c", "import venv, ensurepip"]),
            Self::Chromium => chromium().is_some(),
            Self::Cc => run("cc", &["--version"]),
            Self::ArmGcc => run("arm-none-eabi-gcc", &["--version"]),
        }
    }

    /// The arguments with which rustup obtains it.
    fn rustup(self) -> Option<[&'static str; 3]> {
        match self {
            Self::Rustfmt => Some(["component", "add", "rustfmt"]),
            Self::Clippy => Some(["component", "add", "clippy"]),
            Self::Wasm32 => Some(["target", "add", Target::Wasm32.triple()]),
            Self::Thumbv7em => Some(["target", "add", Target::Thumbv7em.triple()]),
            Self::Thumbv8m => Some(["target", "add", Target::Thumbv8m.triple()]),
            Self::Riscv32 => Some(["target", "add", Target::Riscv32.triple()]),
            Self::Qemu | Self::Node | Self::Npm | Self::Python => None,
            Self::Cc | Self::ArmGcc | Self::Chromium => None,
        }
    }

    /// The Debian packages that hold it. The targets' come only after rustup has failed.
    fn debian(self) -> &'static [&'static str] {
        match self {
            Self::Rustfmt | Self::Clippy => &[],
            Self::Wasm32 | Self::Thumbv7em | Self::Thumbv8m | Self::Riscv32 => {
                toolchain::DEBIAN_PACKAGES
            }
            Self::Qemu => &["qemu-system-arm"],
            Self::Node => &["nodejs"],
            // Debian's npm brings hundreds of packages: not worth it for a Node that is too old.
            Self::Npm if node_version().is_some_and(|found| found >= NODE_FOR_PAGE) => &["npm"],
            Self::Npm => &[],
            Self::Python => &["python3", "python3-venv"],
            Self::Chromium => &["chromium"],
            Self::Cc => &["gcc", "libc6-dev"],
            Self::ArmGcc => &["gcc-arm-none-eabi"],
        }
    }
}

/// The browser's program, by whichever of its names it goes here.
pub fn chromium() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let folders: Vec<PathBuf> = env::split_paths(&env::var_os("PATH")?).collect();
    names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(
        |program| {
            program.is_file()
                && command::succeeds(command::new(Path::new("."), program).arg("--version"))
        },
    )
}

/// Node's major and minor version.
fn node_version() -> Option<(u32, u32)> {
    let text = command::probe(command::new(Path::new("."), "node").arg("--version"))?;
    let mut numbers = text.trim_start_matches('v').split('.').map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

/// The result of a setup: what was asked for and what of it is missing.
pub struct Tools {
    asked: Vec<Need>,
    missing: Vec<Need>,
}

impl Tools {
    /// Obtains what is missing of `needs`, unless VANTAGE_SETUP=off; then looks again.
    pub fn obtain(workspace: &Workspace, needs: &[Need]) -> Self {
        let may_install = env::var("VANTAGE_SETUP").as_deref() != Ok("off");
        let mut missing = unmet(needs);
        if may_install && !missing.is_empty() {
            for arguments in missing.iter().filter_map(|need| need.rustup()) {
                attempt(workspace, "rustup", &arguments);
            }
            missing = unmet(&missing);
        }
        if may_install && !missing.is_empty() && is_debian_root() {
            let have_lists =
                command::new(&workspace.root, "apt-get").arg("update").status().is_ok();
            for need in missing.iter().filter(|need| have_lists && !need.is_met()) {
                if !need.debian().is_empty() {
                    let install = ["install", "-y", "--no-install-recommends"];
                    attempt(workspace, "apt-get", &[install.as_slice(), need.debian()].concat());
                }
            }
            missing = unmet(&missing);
        }
        Self { asked: needs.to_vec(), missing }
    }

    /// The first of `needs` that is missing.
    pub fn first_missing(&self, needs: &[Need]) -> Option<Need> {
        needs.iter().copied().find(|need| self.missing.contains(need))
    }

    /// One line per need: here or missing.
    pub fn summary(&self) -> String {
        let line = |need: &Need| {
            let state = if self.missing.contains(need) { "missing" } else { "here" };
            format!("{state:>8}  {}", need.name())
        };
        self.asked.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// One message that says what is missing and how to get it; `None` where nothing is.
    pub fn missing_message(&self) -> Option<String> {
        if self.missing.is_empty() {
            return None;
        }
        let lines = self.missing.iter().map(|need| format!("\n  {}: {}", need.name(), need.how()));
        Some(format!(
            "missing on this machine, and could not be obtained:{}",
            lines.collect::<String>()
        ))
    }
}

fn unmet(needs: &[Need]) -> Vec<Need> {
    needs.iter().copied().filter(|need| !need.is_met()).collect()
}

/// Runs an installer; its failure shows in what is still missing afterwards.
fn attempt(workspace: &Workspace, program: &str, arguments: &[&str]) {
    let mut installer = command::new(&workspace.root, program);
    installer.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
    if let Err(error) = command::run(&mut installer) {
        println!("setup: {error:#}");
    }
}

fn is_debian_root() -> bool {
    let here = Path::new(".");
    command::probe(command::new(here, "id").arg("-u")).as_deref() == Some("0")
        && command::succeeds(command::new(here, "apt-get").arg("--version"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_message_names_everything_missing_and_how_to_get_it() {
        let tools = Tools { asked: Need::ALL.to_vec(), missing: vec![Need::Qemu, Need::Node] };
        let message = tools.missing_message().unwrap();
        assert!(message.contains("qemu-system-arm: apt-get install qemu-system-arm"));
        assert!(message.contains("Node (18 or later): apt-get install nodejs"));
        assert!(!message.contains("clippy"));
        assert_eq!(tools.first_missing(&[Need::Clippy, Need::Node]), Some(Need::Node));
        assert!(tools.summary().contains("missing  qemu-system-arm"));
    }

    #[test]
    fn nothing_missing_says_nothing() {
        let tools = Tools { asked: Need::ALL.to_vec(), missing: vec![] };
        assert_eq!(tools.missing_message(), None);
        assert_eq!(tools.first_missing(&Need::ALL), None);
    }
}
