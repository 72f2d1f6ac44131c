//! Trains radiance fields, and compares schemes by them.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use vantage_fields::ceiling::{self, CeilingArgs};
use vantage_fields::evaluate::{self, EvaluateArgs};
use vantage_fields::one::{self, FieldArgs};
use vantage_fields::results::{self, ResultsArgs};

#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Evaluate(EvaluateArgs),
    Ceiling(CeilingArgs),
    Field(FieldArgs),
    Results(ResultsArgs),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Evaluate(args) => evaluate::run(&args),
        Command::Ceiling(args) => ceiling::run(&args),
        Command::Field(args) => one::run(&args),
        Command::Results(args) => results::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
