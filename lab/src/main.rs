//! `cargo vantage`: plans and compares captures.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use vantage_lab::commands::{compare, dataset, plan};

/// Plans the next best photo of an object for radiance-field capture
#[derive(Parser)]
#[command(name = "cargo vantage", version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Choose views of an object, and write their photos as a folder that trainers open
    Plan(plan::PlanArgs),
    /// Compare schemes by exact scores over objects and budgets
    Compare(compare::CompareArgs),
    /// Make views of many objects, exactly labelled, to train on
    Dataset(dataset::DatasetArgs),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Plan(args) => plan::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Dataset(args) => dataset::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
