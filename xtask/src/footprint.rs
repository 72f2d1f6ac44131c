//! What a device needs: `tests/footprint`, a whole capture of 30 views on a Cortex-M, built to be small,
//! run in QEMU, and held against the budgets of the design. And that it cannot panic.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use serde_json::json;

use crate::command;
use crate::firmware::{self, CORTEX_M4F, Size};
use crate::toolchain::Target;
use crate::workspace::Workspace;

/// What a panic would call, and no object file has.
const NOWHERE: &str = "vantage_has_a_way_to_panic";

const KIB: u64 = 1024;

/// What something takes, and what it may, in bytes.
#[derive(Debug, PartialEq)]
struct Row {
    what: &'static str,
    bytes: u64,
    /// The most there may be, and the most there should be.
    budget: Option<(u64, u64)>,
}

impl Row {
    fn is_met(&self) -> bool {
        self.budget.is_none_or(|(must, _)| self.bytes <= must)
    }

    fn verdict(&self) -> &'static str {
        match self.budget {
            None => "",
            Some((must, _)) if self.bytes > must => "MISSED",
            Some((_, aim)) if self.bytes > aim => "must met",
            Some(_) => "aim met",
        }
    }
}

/// Measures and shows the table, or JSON; an error where a budget that must be met is missed.
pub fn size(workspace: &Workspace, arguments: &[String]) -> Result<()> {
    let as_json = match arguments {
        [] => false,
        [option] if option == "--json" => true,
        _ => bail!("`size` takes --json or nothing; see `cargo xtask help`"),
    };
    let rows = measure(workspace)?;
    print!("{}", if as_json { to_json(&rows)? } else { to_table(&rows) });
    let missed: Vec<&str> = rows.iter().filter(|row| !row.is_met()).map(|row| row.what).collect();
    ensure!(missed.is_empty(), "over what must be met: {}", missed.join(", "));
    Ok(())
}

/// The firmware links, which it can only without a way to panic; and with one it does not.
pub fn panic_free(workspace: &Workspace) -> Result<()> {
    let (mut build, _) = build(workspace, Some("everything"));
    command::run(&mut build)?;
    let (mut build, _) = self::build(workspace, Some("with-a-panic"));
    let output = build.output().context("cargo did not start")?;
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(!output.status.success(), "a firmware that can panic links: the proof proves nothing");
    ensure!(
        errors.contains(&format!("undefined symbol: {NOWHERE}")),
        "a firmware that can panic fails, but not for want of {NOWHERE}:\n{errors}"
    );
    println!(
        "planning, inference, snapshots and the device behind a line: no way to panic; one put in on \
         purpose is found"
    );
    Ok(())
}

fn build(workspace: &Workspace, feature: Option<&str>) -> (std::process::Command, PathBuf) {
    let (mut build, folder) = Target::Thumbv7em.build_with(workspace, "firmware", "");
    build.args(["--package", "footprint"]);
    if let Some(feature) = feature {
        build.args(["--features", feature]);
    }
    (build, folder.join("footprint"))
}

fn measure(workspace: &Workspace) -> Result<Vec<Row>> {
    let (mut build, program) = build(workspace, None);
    command::capture(&mut build)?;
    let size = Size::of_elf(&fs::read(&program)?)
        .with_context(|| format!("{} is no 32-bit ELF file", program.display()))?;
    let told = firmware::run_on(workspace, CORTEX_M4F, &program)?;
    let told = |name: &str| number(&told, name);
    let model = fs::metadata(workspace.path("lab/models/soarnet.model"))?.len();
    let session = told("lists")? + told("network")? + told("session")?;
    let row = |what, bytes| Row { what, bytes, budget: None };
    let budget =
        |what, bytes, must, aim| Row { what, bytes, budget: Some((must * KIB, aim * KIB)) };
    Ok(vec![
        budget("flash: model", model, 512, 256),
        // The firmware carries recorded photos too, where a device has a camera.
        budget("flash: code and constants", size.flash - told("data")?, 64, 32),
        budget("RAM: session, 128 candidates, 64 views", session, 192, 96),
        row("  of which candidates and views", told("lists")?),
        row("  of which network, scratch included", told("network")?),
        row("  of which scratch", told("scratch")?),
        row("  of which session and scorer", told("session")?),
        row("RAM: room for a snapshot of 64 views", told("snapshot")?),
        row("RAM: static in all", size.ram),
        budget("stack: high water, 30 views", told("stack")?, 8, 4),
    ])
}

/// The number in the line `name number`.
fn number(text: &str, name: &str) -> Result<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
    let line = line.with_context(|| format!("the firmware tells no `{name}`:\n{text}"))?;
    line.parse().with_context(|| format!("`{name} {line}` is no number"))
}

fn to_table(rows: &[Row]) -> String {
    let mut text =
        format!("{:40} {:>8} {:>9} {:>6} {:>5}\n", "thumbv7em", "bytes", "KiB", "must", "aim");
    for row in rows {
        let kib = row.bytes as f64 / KIB as f64;
        let (must, aim) = row.budget.unzip();
        let limit = |limit: Option<u64>| limit.map_or(String::new(), |l| (l / KIB).to_string());
        let line = format!(
            "{:40} {:8} {kib:9.1} {:>6} {:>5}  {}",
            row.what,
            row.bytes,
            limit(must),
            limit(aim),
            row.verdict()
        );
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text + "panics: none, or it would not have linked; heap: none, for it has no allocator\n"
}

fn to_json(rows: &[Row]) -> Result<String> {
    let rows: Vec<_> = rows
        .iter()
        .map(|row| {
            let (must, aim) = row.budget.unzip();
            let what = row.what.trim_start();
            json!({ "what": what, "bytes": row.bytes, "must": must, "aim": aim })
        })
        .collect();
    let target = Target::Thumbv7em.triple();
    let all = json!({ "target": target, "machine": CORTEX_M4F, "rows": rows });
    Ok(serde_json::to_string_pretty(&all)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> [Row; 4] {
        let row = |bytes, budget| Row { what: "flash", bytes, budget };
        let budget = Some((2 * KIB, KIB));
        [row(KIB, budget), row(KIB + 1, budget), row(2 * KIB + 1, budget), row(9 * KIB, None)]
    }

    #[test]
    fn a_budget_is_met_up_to_its_last_byte() {
        assert_eq!(rows().map(|row| row.verdict()), ["aim met", "must met", "MISSED", ""]);
        assert_eq!(rows().map(|row| row.is_met()), [true, true, false, true]);
    }

    #[test]
    fn table_and_json_say_the_same() {
        let table = to_table(&rows());
        assert!(table.contains("1025       1.0      2     1  must met\n"), "{table}");
        let json: serde_json::Value = serde_json::from_str(&to_json(&rows()).unwrap()).unwrap();
        assert_eq!(
            (&json["rows"][2]["bytes"], &json["rows"][2]["must"]),
            (&json!(2049), &json!(2048))
        );
        assert_eq!(json["rows"][3]["must"], json!(null));
    }

    #[test]
    fn numbers_are_told_by_their_whole_names() {
        assert_eq!(number("stacks 1\nstack 2\n", "stack").unwrap(), 2);
        assert!(number("stack 2\n", "data").is_err() && number("stack two\n", "stack").is_err());
    }
}
