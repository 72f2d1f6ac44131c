//! Developer tasks of Vantage. `cargo xtask help` lists them; users' commands are `cargo vantage`.

mod board;
mod c;
mod cli;
mod command;
mod core_rules;
mod firmware;
mod footprint;
mod guidance;
mod kernels;
mod models;
mod readers;
mod same_plan;
mod serve;
mod setup;
mod steps;
mod test;
mod toolchain;
mod train;
mod wasm;
mod web;
mod workspace;

use std::env;
use std::process::ExitCode;

use anyhow::{Result, bail};

use setup::{Need, Tools};
use workspace::Workspace;

const HELP: &str = "\
Developer tasks of Vantage. Usage: cargo xtask <task>

  test [--quick] [--list] [STEP…]  run what CI runs: all steps, or those whose names begin so;
                                   --quick leaves out the slow ones, --list only names them
  setup                            obtain what the tasks need: Rust targets and components, QEMU,
                                   Node, Chromium; says in one message what is still missing
  golden                           record the scene of tests/same-plan and the captures of
                                   tests/sessions anew and rewrite their texts
  firmware [--json]                run the guidance of recorded captures, and a device behind a serial
                                   port, on a Cortex-M4F and a Cortex-M7 in QEMU; the plans, which
                                   must be this computer's, and what a step costs in instructions
  size [--json]                    what a device needs in flash, RAM and stack, against the budgets
  panic-free                       show that planning, inference and the device have no way to panic
  bench kernels [--json]           count the kernels' instructions beside CMSIS-NN's, and time an
                                   encoding beside tract and onnxruntime; results are compared first
  header                           rewrite core/c/include/vantage.h from its sources
  wasm                             build the npm package of WebAssembly into wasm/pkg
  serve [PORT]                     build the page and serve it on localhost (default port 8080)
  models [--real DIR]              train the shipped networks again from nothing, under three hours on
                                   two cores; with a folder of GLB files, measure them and write
                                   lab/MODEL_CARD.md
  help                             this text

Environment: CARGO_TARGET_DIR is respected; VANTAGE_SETUP=off makes every task use only what is
installed already.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match run(&arguments) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Result<ExitCode> {
    let (task, rest) = match arguments {
        [] => ("help", [].as_slice()),
        [task, rest @ ..] => (task.as_str(), rest),
    };
    if matches!(task, "help" | "--help" | "-h") {
        print!("{HELP}");
        return Ok(ExitCode::SUCCESS);
    }
    if !rest.is_empty()
        && !matches!(task, "test" | "serve" | "models" | "firmware" | "size" | "bench")
    {
        bail!("`{task}` takes no arguments, but got `{}`; see `cargo xtask help`", rest.join(" "));
    }
    let workspace = Workspace::find()?;
    match task {
        "test" => return test::run(&workspace, rest),
        "setup" => {
            let tools = Tools::obtain(&workspace, &Need::ALL);
            println!("{}", tools.summary());
            if let Some(message) = tools.missing_message() {
                bail!("{message}");
            }
        }
        "golden" => same_plan::write_golden(&workspace)?,
        "firmware" => {
            require(&workspace, &[Need::Thumbv7em, Need::Qemu])?;
            guidance::task(&workspace, rest)?;
        }
        "size" => {
            require(&workspace, &[Need::Thumbv7em, Need::Qemu])?;
            footprint::size(&workspace, rest)?;
        }
        "panic-free" => {
            require(&workspace, &[Need::Thumbv7em])?;
            footprint::panic_free(&workspace)?;
        }
        "bench" => match rest {
            [what, options @ ..] if what == "kernels" => {
                require(&workspace, &[Need::Thumbv7em, Need::Qemu, Need::Wasm32, Need::Node])?;
                kernels::bench(&workspace, options)?;
            }
            _ => bail!("`bench` takes `kernels`; planning: cargo bench -p vantage-lab"),
        },
        "header" => c::write_header(&workspace)?,
        "wasm" => {
            require(&workspace, &[Need::Wasm32])?;
            wasm::build(&workspace)?;
        }
        "serve" => {
            let listener = serve::listen(rest)?; // before minutes of building
            require(&workspace, &[Need::Wasm32, Need::Npm])?;
            serve::serve(&web::build(&workspace)?, &listener)?;
        }
        "models" => models::make(&workspace, models::real(rest)?)?,
        other => bail!("there is no task `{other}`; see `cargo xtask help`"),
    }
    Ok(ExitCode::SUCCESS)
}

/// Obtains what a task cannot do without.
fn require(workspace: &Workspace, needs: &[Need]) -> Result<()> {
    match Tools::obtain(workspace, needs).missing_message() {
        Some(message) => bail!("{message}"),
        None => Ok(()),
    }
}
