//! The guidance firmware: recorded captures and a device behind a serial port on QEMU's Cortex-M4F and
//! Cortex-M7, and what a step costs.
//!
//! The plans must be those of the same program on this computer. Times are estimates: one instruction
//! a cycle, as from memory that never waits.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::command;
use crate::firmware::{self, CORTEX_M4F, CORTEX_M7, CORTEX_M33, Size};
use crate::same_plan::{PLANS, first_difference};
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};

const MACHINES: [&str; 2] = [CORTEX_M4F, CORTEX_M7];

/// The programs whose size is told.
const PROGRAMS: [&str; 2] = ["firmware-guidance", "firmware-device"];

/// Clocks for which times are estimated: an nRF52840, an RP2350, an STM32F7 and an STM32H7.
const CLOCKS_MHZ: [u32; 4] = [64, 150, 216, 480];

/// A whole step may take so long at the highest of them, milliseconds.
const LIMIT_MS: f64 = 100.0;

/// What a part of a step costs.
struct Part {
    name: String,
    products: u64, // of signed bytes; 0 where that says nothing
    instructions: u64,
}

/// What was found.
struct Report {
    plan: String,
    parts: Vec<Part>,
    sizes: Vec<(&'static str, Size)>,
    device: Vec<String>,
}

/// `cargo xtask firmware`.
pub fn task(workspace: &Workspace, arguments: &[String]) -> Result<()> {
    let json = match arguments {
        [] => false,
        [option] if option == "--json" => true,
        _ => bail!("`firmware` takes no argument but --json"),
    };
    let report = run(workspace)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&report.json())?);
    } else {
        report.print();
    }
    report.check()
}

/// The same as a step of the tests.
pub fn test(workspace: &Workspace) -> Result<()> {
    task(workspace, &[])
}

/// A Cortex-M33 in QEMU gives the same plans; the program of the Pico 2 and the library for RISC-V
/// are built.
pub fn other_targets(workspace: &Workspace) -> Result<()> {
    let programs = ["firmware-guidance", "firmware-same-plan"];
    let (mut build, folder) = Target::Thumbv8m.build(workspace);
    build.args(["--package", "vantage-firmware"]);
    command::run(build.args(programs.iter().flat_map(|program| ["--bin", program])))?;
    let there = firmware::run_on(workspace, CORTEX_M33, &folder.join("firmware-guidance"))?;
    must_equal(&there, &plan_here(workspace)?, CORTEX_M33)?;
    PLANS.compare(
        workspace,
        &firmware::run_on(workspace, CORTEX_M33, &folder.join("firmware-same-plan"))?,
    )?;
    println!("the same plans on {CORTEX_M33}");

    let (mut build, folder) = Target::Thumbv8m.build(workspace);
    build.args(["--package", "vantage-firmware", "--bin", "firmware-pico2"]);
    command::run(build.args(["--features", "pico2,defmt"]))?;
    let Size { flash, ram } = size(&folder.join("firmware-pico2"))?;
    println!("firmware-pico2: flash {flash} bytes, static RAM {ram} bytes; not run");

    let (mut build, _) = Target::Riscv32.build(workspace);
    command::run(build.args(["--package", "vantage-firmware", "--lib"]))
}

/// What the guidance program writes on this computer.
fn plan_here(workspace: &Workspace) -> Result<String> {
    let mut host = command::new(&workspace.root, cargo());
    host.args(["run", "--quiet", "--release", "--package", "vantage-firmware"]);
    host.args(["--bin", "firmware-guidance"]);
    command::capture_within(&mut host, Duration::from_secs(1800))
}

fn must_equal(there: &str, here: &str, machine: &str) -> Result<()> {
    match first_difference(there, here) {
        Some(difference) => {
            bail!("the plan of {machine} differs from this computer's (committed):\n{difference}")
        }
        None => Ok(()),
    }
}

fn run(workspace: &Workspace) -> Result<Report> {
    let folder = firmware::build(workspace)?;
    let plan = plan_here(workspace)?;
    let mut counts = Vec::new();
    let mut device = Vec::new();
    for machine in MACHINES {
        let there = firmware::run_on(workspace, machine, &folder.join("firmware-guidance"))?;
        must_equal(&there, &plan, machine)?;
        counts.push(firmware::run_counted(workspace, machine, &folder.join("firmware-speed"))?);
        device.push(format!("{machine}: {}", talk(workspace, machine, &folder)?));
    }
    ensure!(
        counts[0] == counts[1],
        "the machines count differently:\n{}\n{}",
        counts[0],
        counts[1]
    );
    let parts = counts[0].lines().map(Part::read).collect::<Result<_>>()?;
    let sizes = PROGRAMS
        .iter()
        .map(|program| Ok((*program, size(&folder.join(program))?)))
        .collect::<Result<_>>()?;
    Ok(Report { plan, parts, sizes, device })
}

fn size(program: &Path) -> Result<Size> {
    Size::of_elf(&fs::read(program)?)
        .with_context(|| format!("{} is not a 32-bit little-endian ELF file", program.display()))
}

impl Part {
    /// A line of `firmware-speed`.
    fn read(line: &str) -> Result<Self> {
        let fields: Vec<&str> = line.split('\t').collect();
        let [name, products, instructions] = fields[..] else {
            bail!("firmware-speed wrote `{line}`, which is not three columns");
        };
        Ok(Self {
            name: name.to_owned(),
            products: products.parse()?,
            instructions: instructions.parse()?,
        })
    }

    /// Milliseconds at one instruction a cycle.
    fn ms(&self, clock_mhz: u32) -> f64 {
        self.instructions as f64 / (1e3 * f64::from(clock_mhz))
    }

    fn per_product(&self) -> Option<f64> {
        (self.products > 0).then(|| self.instructions as f64 / self.products as f64)
    }
}

impl Report {
    fn print(&self) {
        print!("{}", self.plan);
        println!("the same plan on {} and {}\n", MACHINES[0], MACHINES[1]);
        let heads: String = CLOCKS_MHZ.iter().map(|clock| format!("{clock:>5} MHz")).collect();
        println!("{:<28}{:>13}{:>11}{:>7}{heads}", "", "instructions", "products", "each");
        for part in &self.parts {
            let (products, each) = match part.per_product() {
                Some(each) => (part.products.to_string(), format!("{each:.2}")),
                None => (String::new(), String::new()),
            };
            let times: String =
                CLOCKS_MHZ.iter().map(|clock| format!("{:>6.1} ms", part.ms(*clock))).collect();
            println!("{:<28}{:>13}{products:>11}{each:>7}{times}", part.name, part.instructions);
        }
        println!("times are estimates, at one instruction a cycle\n");
        for (program, Size { flash, ram }) in &self.sizes {
            println!("{program}: flash {flash} bytes, static RAM {ram} bytes");
        }
        for line in &self.device {
            println!("device on {line}");
        }
    }

    fn json(&self) -> Value {
        let part = |part: &Part| {
            let estimates: serde_json::Map<String, Value> = CLOCKS_MHZ
                .iter()
                .map(|clock| (format!("{clock} MHz"), json!(part.ms(*clock))))
                .collect();
            json!({
                "name": part.name,
                "instructions": part.instructions,
                "products": part.products,
                "instructions_per_product": part.per_product(),
                "estimated_ms": estimates,
            })
        };
        let sizes: Vec<Value> = self
            .sizes
            .iter()
            .map(|(name, size)| json!({ "name": name, "flash": size.flash, "ram": size.ram }))
            .collect();
        json!({
            "machines": MACHINES,
            "plan": self.plan.lines().collect::<Vec<_>>(),
            "parts": self.parts.iter().map(part).collect::<Vec<_>>(),
            "programs": sizes,
            "device": self.device,
        })
    }

    fn check(&self) -> Result<()> {
        let whole = self.parts.last().context("firmware-speed wrote nothing")?;
        let ms = whole.ms(CLOCKS_MHZ[CLOCKS_MHZ.len() - 1]);
        ensure!(
            ms <= LIMIT_MS,
            "{} takes an estimated {ms:.1} ms at 480 MHz; {LIMIT_MS} ms are allowed",
            whole.name
        );
        Ok(())
    }
}

/// An emulator that ends with this value.
struct Machine(Child);

impl Drop for Machine {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// A command is sent again after so many seconds, eight times; an emulator that gets a twentieth of a
/// busy core needs half a minute for a view.
const PATIENCE_S: &str = "20";

/// Lets `cargo vantage device` plan with a device in QEMU, which loses power twice on the way; says
/// what came of it.
fn talk(workspace: &Workspace, machine: &str, folder: &Path) -> Result<String> {
    let mut build = command::new(&workspace.root, cargo());
    build.args(["build", "--quiet", "--release", "--package", "vantage-lab", "--bin", "vantage"]);
    command::capture(&mut build)?;
    let vantage = workspace.target.join("release").join("vantage");
    let flash = workspace.target.join(format!("{machine}.flash"));
    if flash.exists() {
        fs::remove_file(&flash)?;
    }
    // Free now, and nobody else asks for one here.
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let power = || power(workspace, machine, &folder.join("firmware-device"), &flash, port);

    let mut emulator = Some(power()?);
    let name = format!("tcp:127.0.0.1:{port}");
    let device = ["device", "--port", &name, "--patience", PATIENCE_S];
    await_port(port)?;
    let mut plan = command::new(&workspace.root, &vantage);
    plan.args(device).args(["plan", "vase", "--budget", "7", "--candidates", "40"]);
    let mut plan = plan.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let lines = BufReader::new(plan.stdout.take().context("the pipe was asked for")?).lines();
    let mut last = String::new();
    for (view, line) in lines.enumerate() {
        last = line?;
        if view == 2 || view == 4 {
            drop(emulator.take());
            emulator = Some(power()?);
        }
    }
    let mut error = String::new();
    plan.stderr.take().context("the pipe was asked for")?.read_to_string(&mut error)?;
    ensure!(plan.wait()?.success(), "`vantage device … plan` on {machine}: {last} {error}");

    let mut status = command::new(&workspace.root, &vantage);
    let status = command::capture(status.args(device).args(["status", "--json"]))?;
    let status: Value = serde_json::from_str(&status).context("the status is no JSON")?;
    drop(emulator);
    let (views, revision) = (&status["session"]["views"], &status["session"]["revision"]);
    ensure!(
        *views == 7 && *revision == 7 && status["flash"] == "Session",
        "the device on {machine} ended with {status}"
    );
    Ok(format!("{last}, though it lost power twice"))
}

/// Switches a device on.
fn power(
    workspace: &Workspace,
    machine: &str,
    program: &Path,
    flash: &Path,
    port: u16,
) -> Result<Machine> {
    let mut qemu: Command = command::new(&workspace.root, "qemu-system-arm");
    qemu.args(["-M", machine, "-display", "none", "-monitor", "none", "-serial"]);
    qemu.arg(format!("tcp:127.0.0.1:{port},server=on,wait=off"));
    let flash = flash.to_str().context("the target folder's name is not UTF-8")?;
    // A comma would end the name.
    let flash = flash.replace(',', ",,");
    qemu.arg("-semihosting-config");
    qemu.arg(format!("enable=on,target=native,arg=device,arg={flash}"));
    qemu.arg("-kernel").arg(program);
    Ok(Machine(qemu.spawn().context("qemu-system-arm did not start")?))
}

/// Waits until an emulator listens.
fn await_port(port: u16) -> Result<()> {
    for _ in 0..200 {
        if std::net::TcpStream::connect(("127.0.0.1", port)).is_ok() {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    bail!("QEMU did not open port {port} within ten seconds")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_columns_is_a_part_with_its_times() {
        let part = Part::read("encode\t1000\t2500000").unwrap();
        assert_eq!(
            (part.name.as_str(), part.products, part.instructions),
            ("encode", 1000, 2_500_000)
        );
        assert_eq!(part.ms(64), 2_500_000.0 / 64_000.0);
        assert_eq!(part.per_product(), Some(2500.0));
        assert_eq!(Part::read("choose\t0\t5").unwrap().per_product(), None);
        assert!(Part::read("encode\t1000").is_err());
        assert!(Part::read("encode\tmany\t1").is_err());
    }

    #[test]
    fn a_step_that_takes_too_long_fails() {
        let report = |instructions| Report {
            plan: String::new(),
            parts: vec![Part { name: "whole step".into(), products: 1, instructions }],
            sizes: vec![],
            device: vec![],
        };
        assert!(report(48_000_000).check().is_ok());
        assert!(report(48_000_001).check().is_err());
    }
}
