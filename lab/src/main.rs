//! `cargo vantage`: plans and compares captures.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use vantage_lab::commands::train::Program;
use vantage_lab::commands::{compare, dataset, device, plan, train};

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
    /// Talk to a device that holds a session: a microcontroller behind a serial port
    Device(device::DeviceArgs),
    /// Train a network on a data set (builds a deep-learning library first: some minutes, once)
    Train(train::NetworkArgs),
    /// Write a trained network as ONNX
    Export(train::NetworkArgs),
    /// Turn an exported network into the model file that controllers and browsers read
    Quantize(train::NetworkArgs),
    /// Measure this program's networks and write their card
    Card(train::NetworkArgs),
    /// Compare schemes by the radiance fields that are trained on their views (builds a
    /// deep-learning library first: some minutes, once)
    Evaluate(train::NetworkArgs),
    /// Search for the best views by training fields on them: what there is to win for a planner
    Ceiling(train::NetworkArgs),
    /// Train one radiance field of an object and measure it
    Field(train::NetworkArgs),
    /// Write the page of results from the runs that were kept of sweeps
    Results(train::NetworkArgs),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Plan(args) => done(plan::run(&args)),
        Command::Compare(args) => done(compare::run(&args)),
        Command::Dataset(args) => done(dataset::run(&args)),
        Command::Device(args) => done(device::run(&args)),
        Command::Train(args) => train::run(Program::Train, "train", &args),
        Command::Export(args) => train::run(Program::Train, "export", &args),
        Command::Quantize(args) => train::run(Program::Train, "quantize", &args),
        Command::Card(args) => train::run(Program::Train, "card", &args),
        Command::Evaluate(args) => train::run(Program::Fields, "evaluate", &args),
        Command::Ceiling(args) => train::run(Program::Fields, "ceiling", &args),
        Command::Field(args) => train::run(Program::Fields, "field", &args),
        Command::Results(args) => train::run(Program::Fields, "results", &args),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn done(result: anyhow::Result<()>) -> anyhow::Result<ExitCode> {
    result.map(|()| ExitCode::SUCCESS)
}
