//! The int8 kernels of `core`: exact on every target, and what they cost beside other people's.
//!
//! Instructions are counted in QEMU and the same in every run; times are of this machine and minute,
//! side by side, and no test looks at them. Every program compares its result before it measures.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::command;
use crate::firmware::{self, CORTEX_M4F};
use crate::readers;
use crate::toolchain::Target;
use crate::workspace::{Workspace, cargo};

/// A layer that CMSIS-NN was counted with (99f736a, gcc 12.2 -O3, Cortex-M4): its instructions for a
/// product, for an element where maps are added, and our bars.
struct Anchor {
    name: &'static str, // as in tests/kernels/src/layers.rs
    theirs: f64,
    must: f64,
    stretch: f64,
}

const fn anchor(name: &'static str, theirs: f64, must: f64, stretch: f64) -> Anchor {
    Anchor { name, theirs, must, stretch }
}

/// What the whole encoder is called in the counts.
const ENCODER: &str = "whole encoder";

/// In the order of the counts.
const ANCHORS: [Anchor; 10] = [
    anchor("3x3 s1, 32x32, 16->16", 2.32, 1.00, 0.85),
    anchor("3x3 s2, 32x32, 16->32", 2.13, 1.00, 0.90),
    anchor("3x3 s1, 16x16, 32->32", 1.92, 1.00, 0.85),
    anchor("3x3 s1, 8x8, 64->64", 1.76, 1.00, 0.85),
    anchor("1x1, 16x16, 32->64", 2.65, 1.15, 1.00),
    anchor("fully connected 256->128", 2.11, 1.00, 0.92),
    anchor("first layer 3x3, 64x64, 3->16", 4.77, 1.30, 1.15),
    anchor("depthwise 3x3, 32x32, C = 32", 8.62, 3.0, 1.6),
    anchor("residual add, 16,384 elements", 79.3, 8.0, 6.0),
    anchor(ENCODER, 2.38, 1.05, 0.92),
];

/// A layer as the firmware counted it.
#[derive(Debug, PartialEq)]
struct Count {
    products: u64,
    instructions: u64,
    digest: String,
}

impl Count {
    fn each(&self) -> f64 {
        self.instructions as f64 / self.products as f64
    }
}

/// What of `tests/kernels` the shipped kernels are built with on WebAssembly.
const WASM_BUILDS: [(&str, &str); 2] =
    [("without vectors", ""), ("with vectors", "-C target-feature=+simd128")];

/// The suite on a Cortex-M4F and in WebAssembly, with their own instructions and without, and the
/// counts against the bars. (Step `unit` runs the suite at every level of this computer's processor.)
pub fn test(workspace: &Workspace) -> Result<()> {
    for (instructions, features) in [("without DSP", &["--no-default-features"][..]), ("DSP", &[])]
    {
        let programs = firmware(workspace, features)?;
        let said =
            firmware::run_on(workspace, CORTEX_M4F, &programs.join("kernel-suite-firmware"))?;
        println!("{CORTEX_M4F}, {instructions}: {}", said.trim());
    }
    for (_, flags) in WASM_BUILDS {
        print!("{}", node(workspace, &wasm(workspace, flags)?, &[])?);
    }
    let counts = counts(workspace)?;
    println!("{}", table(&counts));
    let missed = missed(&counts);
    ensure!(missed.is_empty(), "more instructions than the bar allows: {}", missed.join("; "));
    Ok(())
}

/// `cargo xtask bench kernels [--json]`.
pub fn bench(workspace: &Workspace, arguments: &[String]) -> Result<()> {
    let json = match arguments {
        [] => false,
        [option] if option == "--json" => true,
        _ => bail!("`bench kernels` takes no argument but --json"),
    };
    let counts = counts(workspace)?;
    let times = times(workspace, &counts)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&report(&counts, &times))?);
        return Ok(());
    }
    println!(
        "instructions on a Cortex-M4 (QEMU {CORTEX_M4F}, -icount shift=0)\n\n{}",
        table(&counts)
    );
    for missed in missed(&counts) {
        println!("missed: {missed}");
    }
    println!(
        "\nencoders that were compared, layer by layer: lab/ENCODERS.md\n\n{}",
        encoders(&counts)
    );
    println!("\nencode one 64 x 64 photo, one thread, fastest of the rounds, this machine\n");
    for (name, milliseconds) in &times {
        println!("{name:42} {milliseconds:8.3} ms");
    }
    Ok(())
}

/// Builds the programs of `tests/kernels/firmware`; returns their folder.
fn firmware(workspace: &Workspace, features: &[&str]) -> Result<PathBuf> {
    let (mut build, folder) = Target::Thumbv7em.build(workspace);
    command::capture(build.args(["--package", "kernel-firmware"]).args(features))?;
    Ok(folder)
}

/// What the layers cost.
fn counts(workspace: &Workspace) -> Result<BTreeMap<String, Count>> {
    let program = firmware(workspace, &[])?.join("kernel-count");
    parse(&firmware::run_counted(workspace, CORTEX_M4F, &program)?)
}

/// Lines of name, products, instructions and digest, parted by tabs.
fn parse(text: &str) -> Result<BTreeMap<String, Count>> {
    let mut counts = BTreeMap::new();
    for line in text.lines() {
        let [name, products, instructions, digest] = line.split('\t').collect::<Vec<_>>()[..]
        else {
            bail!("a line of the counts cannot be read: {line}");
        };
        let count = Count {
            products: products.parse().context("products")?,
            instructions: instructions.parse().context("instructions")?,
            digest: digest.to_owned(),
        };
        counts.insert(name.to_owned(), count);
    }
    for Anchor { name, .. } in &ANCHORS {
        ensure!(counts.contains_key(*name), "`{name}` was not counted");
    }
    Ok(counts)
}

fn table(counts: &BTreeMap<String, Count>) -> String {
    let mut lines = vec![format!(
        "{:30} {:>10} {:>13} {:>6} {:>9} {:>6} {:>8}",
        "layer", "products", "instructions", "each", "CMSIS-NN", "must", "stretch"
    )];
    for Anchor { name, theirs, must, stretch } in &ANCHORS {
        if let Some(count) = counts.get(*name) {
            lines.push(format!(
                "{name:30} {:>10} {:>13} {:>6.2} {theirs:>9.2} {must:>6.2} {stretch:>8.2}",
                count.products,
                count.instructions,
                count.each()
            ));
        }
    }
    lines.join("\n")
}

/// The encoders of `lab/ENCODERS.md`.
fn encoders(counts: &BTreeMap<String, Count>) -> String {
    let encoders = counts.iter().filter(|(name, _)| name.starts_with("encoder "));
    let lines = encoders.map(|(name, count)| {
        let Count { products, instructions, .. } = count;
        format!("{name:30} {products:>10} {instructions:>13} {:>6.2}", count.each())
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// The layers above their bars.
fn missed(counts: &BTreeMap<String, Count>) -> Vec<String> {
    let above = ANCHORS.iter().filter_map(|Anchor { name, must, .. }| {
        let each = counts.get(*name)?.each();
        (each > *must).then(|| format!("{name}: {each:.3}, must be {must}"))
    });
    above.collect()
}

fn report(counts: &BTreeMap<String, Count>, times: &[(String, f64)]) -> Value {
    let bars: BTreeMap<&str, &Anchor> =
        ANCHORS.iter().map(|anchor| (anchor.name, anchor)).collect();
    let layers = counts.iter().map(|(name, count)| {
        let anchor = bars.get(name.as_str());
        json!({
            "layer": name,
            "products": count.products,
            "instructions": count.instructions,
            "each": count.each(),
            "cmsis_nn": anchor.map(|anchor| anchor.theirs),
            "must": anchor.map(|anchor| anchor.must),
            "stretch": anchor.map(|anchor| anchor.stretch),
        })
    });
    let times = times
        .iter()
        .map(|(name, milliseconds)| json!({ "by": name, "milliseconds": milliseconds }));
    json!({
        "machine": CORTEX_M4F,
        "layers": layers.collect::<Vec<_>>(),
        "missed": missed(counts),
        "times": times.collect::<Vec<_>>(),
    })
}

/// Milliseconds of an encoding by us and by others, on this machine. Ours must be equal everywhere.
fn times(workspace: &Workspace, counts: &BTreeMap<String, Count>) -> Result<Vec<(String, f64)>> {
    let due = counts.get(ENCODER).context("the whole encoder was not counted")?.digest.as_str();
    let mut times = Vec::new();

    let ours = program(workspace, "kernel-suite", "kernel-time")?;
    same(&ours, due, "this computer")?;
    times.push(("vantage, this computer".to_owned(), milliseconds(&ours, "milliseconds")?));
    // The others are given floating-point numbers of the right size.
    times.push(("  of it, resizing the photo".to_owned(), milliseconds(&ours, "resize")?));
    for (name, flags) in WASM_BUILDS {
        let module = wasm(workspace, flags)?;
        let said: Value = serde_json::from_str(&node(workspace, &module, &["--time"])?)?;
        same(&said, due, name)?;
        times.push((format!("vantage, Node, {name}"), milliseconds(&said, "milliseconds")?));
    }
    let tract = program(workspace, "kernel-tract", "kernel-tract")?;
    times.push(("tract, float32".to_owned(), milliseconds(&tract, "milliseconds")?));

    let Some(python) = readers::python(workspace) else {
        println!("onnxruntime was left out: Python is missing");
        return Ok(times);
    };
    let requirements = "tests/readers/requirements-onnx.txt";
    let python = readers::install(workspace, &python, "onnx", requirements, &[])?;
    let sketch = workspace.target.join("xtask/kernels-sketch.json");
    fs::write(&sketch, ours["sketch"].to_string())?;
    let mut script = command::new(&workspace.root, python);
    script.args(["tests/kernels/time_onnxruntime.py", "lab/models/soarnet.onnx"]).arg(&sketch);
    let theirs: Value = serde_json::from_str(&command::capture(&mut script)?)?;
    for (name, key) in [("float32", "milliseconds"), ("int8", "milliseconds_int8")] {
        times.push((format!("onnxruntime, {name}"), milliseconds(&theirs, key)?));
    }
    Ok(times)
}

/// What a program of the host's release build says in JSON.
fn program(workspace: &Workspace, package: &str, name: &str) -> Result<Value> {
    let mut run = command::new(&workspace.root, cargo());
    run.args(["run", "--quiet", "--release", "--package", package, "--bin", name]);
    Ok(serde_json::from_str(&command::capture(&mut run)?)?)
}

fn milliseconds(said: &Value, key: &str) -> Result<f64> {
    said[key].as_f64().with_context(|| format!("no time in {said}"))
}

fn same(said: &Value, due: &str, place: &str) -> Result<()> {
    let digest = said["digest"].as_str().unwrap_or_default();
    ensure!(digest == due, "{place} encodes to {digest}, a Cortex-M4 to {due}");
    Ok(())
}

/// Builds the suite as a WebAssembly module; returns its file.
fn wasm(workspace: &Workspace, flags: &str) -> Result<PathBuf> {
    let (mut build, folder) = Target::Wasm32.build_with(workspace, "release", flags);
    command::capture(build.args(["--package", "kernel-wasm"]))?;
    // The two builds share a place.
    let kept = workspace.target.join(format!("xtask/kernels{}.wasm", flags.len()));
    fs::create_dir_all(workspace.target.join("xtask"))?;
    fs::copy(folder.join("kernel_wasm.wasm"), &kept)?;
    Ok(kept)
}

fn node(workspace: &Workspace, module: &PathBuf, arguments: &[&str]) -> Result<String> {
    let mut node = command::new(&workspace.root, "node");
    command::capture(node.arg("tests/kernels/run-wasm.mjs").arg(module).args(arguments))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(instructions: u64) -> String {
        let lines =
            ANCHORS.iter().map(|anchor| format!("{}\t100\t{instructions}\tff", anchor.name));
        lines.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn what_is_above_its_bar_is_named() {
        assert!(missed(&parse(&counted(100)).unwrap()).is_empty());
        let missed = missed(&parse(&counted(110)).unwrap());
        assert_eq!(missed.len(), 6, "{missed:?}");
        assert!(missed.contains(&"whole encoder: 1.100, must be 1.05".to_owned()), "{missed:?}");
    }

    #[test]
    fn counts_must_be_whole() {
        assert!(parse("3x3 s1, 32x32, 16->16\t1\t2\tff").is_err());
        assert!(parse(&format!("{}\nDIFFERS", counted(1))).is_err());
    }
}
