//! `cargo xtask test`: runs the steps, times them, and ends with a table and one line of counts.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

use crate::setup::{Need, Tools};
use crate::steps::{STEPS, Step};
use crate::workspace::Workspace;

/// How a step ended.
#[derive(Debug, PartialEq)]
pub enum Outcome {
    /// What it shows is so.
    Passed,
    /// What it shows is not so, or it could not be tried.
    Failed(String),
    /// It was not tried, for this reason.
    Skipped(String),
}

impl Outcome {
    /// For steps that either pass or fail.
    pub fn passed((): ()) -> Self {
        Self::Passed
    }
}

/// What the arguments of `test` ask for.
#[derive(Debug, Default, PartialEq)]
struct Request<'a> {
    quick: bool,
    list: bool,
    names: Vec<&'a str>,
}

/// Runs the steps that the arguments select; the exit code says whether any failed.
pub fn run(workspace: &Workspace, arguments: &[String]) -> Result<ExitCode> {
    let request = parse(arguments)?;
    let selected = select(&request)?;
    if request.list {
        for step in selected {
            println!("{:20} {}{}", step.name, step.about, if step.slow { " (slow)" } else { "" });
        }
        return Ok(ExitCode::SUCCESS);
    }

    let needs: Vec<Need> = Need::ALL
        .into_iter()
        .filter(|need| selected.iter().any(|step| step.needs.contains(need)))
        .collect();
    let tools = Tools::obtain(workspace, &needs);
    if let Some(message) = tools.missing_message() {
        println!("{message}\nThe steps that need them are skipped.");
    }

    let mut rows = Vec::new();
    for (index, step) in selected.iter().enumerate() {
        println!("\n==> {}/{} {}: {}", index + 1, selected.len(), step.name, step.about);
        let begin = Instant::now();
        let outcome = attempt(workspace, &tools, step, request.quick && request.names.is_empty());
        let row = Row { name: step.name, outcome, elapsed: begin.elapsed() };
        println!("<== {row}");
        rows.push(row);
    }
    println!("\n{}", table(&rows));
    let failed = rows.iter().any(|row| matches!(row.outcome, Outcome::Failed(_)));
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn attempt(workspace: &Workspace, tools: &Tools, step: &Step, quick: bool) -> Outcome {
    if quick && step.slow {
        return Outcome::Skipped("--quick".into());
    }
    if let Some(need) = tools.first_missing(step.needs) {
        // A developer may lack a tool; what runs unattended may not.
        let reason = format!("{} is missing", need.name());
        let unattended = std::env::var_os("CI").is_some();
        return if unattended { Outcome::Failed(reason) } else { Outcome::Skipped(reason) };
    }
    (step.run)(workspace).unwrap_or_else(|error| Outcome::Failed(format!("{error:#}")))
}

fn parse(arguments: &[String]) -> Result<Request<'_>> {
    let mut request = Request::default();
    for argument in arguments {
        match argument.as_str() {
            "--quick" => request.quick = true,
            "--list" => request.list = true,
            option if option.starts_with('-') => {
                bail!("`test` has no option `{option}`; it has --quick and --list");
            }
            name => request.names.push(name),
        }
    }
    Ok(request)
}

/// The steps of the names asked for, or else those whose names begin so; all where none is given.
fn select(request: &Request<'_>) -> Result<Vec<&'static Step>> {
    let is_full = |name: &str| STEPS.iter().any(|step| step.name == name);
    let matches = |step: &Step, name: &str| {
        step.name == name || (!is_full(name) && step.name.starts_with(name))
    };
    if let Some(name) = request.names.iter().find(|name| !STEPS.iter().any(|s| matches(s, name))) {
        bail!("no step's name begins with `{name}`; see `cargo xtask test --list`");
    }
    let asked = |step: &Step| request.names.iter().any(|name| matches(step, name));
    Ok(STEPS.iter().filter(|step| request.names.is_empty() || asked(step)).collect())
}

struct Row {
    name: &'static str,
    outcome: Outcome,
    elapsed: Duration,
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (state, reason) = match &self.outcome {
            Outcome::Passed => ("passed", ""),
            Outcome::Failed(reason) => ("FAILED", reason.as_str()),
            Outcome::Skipped(reason) => ("skipped", reason.as_str()),
        };
        let line = format!("{:20} {state:8} {:7.1} s", self.name, self.elapsed.as_secs_f64());
        write!(f, "{line}  {}", reason.lines().next().unwrap_or_default())?;
        reason.lines().skip(1).try_for_each(|line| write!(f, "\n    {line}"))
    }
}

/// One row per step, then the counts alone on the last line.
fn table(rows: &[Row]) -> String {
    let count = |is: fn(&Outcome) -> bool| rows.iter().filter(|row| is(&row.outcome)).count();
    let lines: String = rows.iter().map(|row| format!("{row}\n")).collect();
    format!(
        "{lines}{} passed, {} failed, {} skipped",
        count(|outcome| matches!(outcome, Outcome::Passed)),
        count(|outcome| matches!(outcome, Outcome::Failed(_))),
        count(|outcome| matches!(outcome, Outcome::Skipped(_)))
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_counts() {
        let row = |name, outcome| Row { name, outcome, elapsed: Duration::from_millis(1250) };
        let text = table(&[
            row("unit", Outcome::Passed),
            row("web", Outcome::Skipped("npm is missing".into())),
            row("cli", Outcome::Failed("it panicked\nhere".into())),
        ]);
        assert_eq!(text.lines().last(), Some("1 passed, 1 failed, 1 skipped"));
        assert!(text.contains("npm is missing") && text.contains("it panicked\n    here"));
    }

    #[test]
    fn a_name_selects_what_begins_with_it() {
        let arguments = ["same-plan".to_owned()];
        let selected = select(&parse(&arguments).unwrap()).unwrap();
        assert!(selected.len() > 1 && selected.iter().all(|s| s.name.starts_with("same-plan")));
        let full = ["cli".to_owned()];
        assert_eq!(select(&parse(&full).unwrap()).unwrap().len(), 1, "not clippy too");
        assert_eq!(select(&Request::default()).unwrap().len(), STEPS.len());
    }

    #[test]
    fn unknown_names_and_options_are_refused() {
        let nothing = ["nothing".to_owned()];
        assert!(select(&parse(&nothing).unwrap()).is_err());
        assert!(parse(&["--slow".to_owned()]).is_err());
    }
}
