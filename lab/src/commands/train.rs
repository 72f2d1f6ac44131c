//! The commands that are handed to programs of their own, `vantage-train` and `vantage-fields`, because
//! a deep-learning library takes minutes to compile and nothing else needs one.

use std::ffi::OsString;
use std::process::{Command, ExitCode};

use anyhow::{Context, Result};
use clap::Args;

/// Options of these commands: all go to the other program.
#[derive(Args, Clone, Debug)]
#[command(disable_help_flag = true)]
pub struct NetworkArgs {
    /// See `--help` of the command
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    args: Vec<OsString>,
}

/// The programs, by their folders beside this package's sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// `vantage-train`.
    Train,
    /// `vantage-fields`.
    Fields,
}

/// Runs a command of another program, which cargo builds where it has not been built yet.
pub fn run(program: Program, command: &str, args: &NetworkArgs) -> Result<ExitCode> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = match program {
        Program::Train => concat!(env!("CARGO_MANIFEST_DIR"), "/train/Cargo.toml"),
        Program::Fields => concat!(env!("CARGO_MANIFEST_DIR"), "/fields/Cargo.toml"),
    };
    // Built aloud, since that may take minutes; run quietly, or cargo would add its own words to
    // whatever the program refuses.
    let built =
        succeeds(Command::new(&cargo).args(["build", "--release", "--manifest-path", manifest]))?;
    let run = ["run", "--quiet", "--release", "--manifest-path", manifest, "--", command];
    let done = built && succeeds(Command::new(&cargo).args(run).args(&args.args))?;
    Ok(if done { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Whether a program succeeds; one that fails has told its reason.
fn succeeds(command: &mut Command) -> Result<bool> {
    let status = command.status();
    let status =
        status.with_context(|| format!("cannot start {}", command.get_program().display()))?;
    Ok(status.success())
}
