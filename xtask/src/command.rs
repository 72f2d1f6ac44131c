//! Running programs: never with our stdin, always with a sentence when they fail.

use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};

/// A command that starts in `folder` and reads nothing.
pub fn new(folder: &Path, program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.current_dir(folder).stdin(Stdio::null());
    command
}

/// Runs a command whose output the developer sees; an exit code other than 0 is an error.
pub fn run(command: &mut Command) -> Result<()> {
    let line = line(command);
    println!("$ {line}");
    let status = command.status().with_context(|| format!("`{line}` did not start"))?;
    check(status, &line)
}

/// Runs a command and returns what it wrote to standard output; standard error passes through.
pub fn capture(command: &mut Command) -> Result<String> {
    let line = line(command);
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("`{line}` did not start"))?;
    check(output.status, &line)?;
    String::from_utf8(output.stdout).with_context(|| format!("`{line}` wrote no UTF-8"))
}

/// Like [`capture`], but a command that runs longer than `limit` is ended and is an error.
pub fn capture_within(command: &mut Command, limit: Duration) -> Result<String> {
    let line = line(command);
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("`{line}` did not start"))?;
    let mut pipe = child.stdout.take().context("the pipe was asked for above")?;
    let reader = thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).map(|_| bytes)
    });
    let begin = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if begin.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            bail!("`{line}` did not end within {} s", limit.as_secs());
        }
        thread::sleep(Duration::from_millis(20));
    };
    let bytes = reader.join().map_err(|_| anyhow!("the reader of `{line}` panicked"))??;
    let text = String::from_utf8(bytes).with_context(|| format!("`{line}` wrote no UTF-8"))?;
    if !status.success() {
        print!("{text}");
    }
    check(status, &line)?;
    Ok(text)
}

/// Whether a command runs and succeeds; its output is dropped.
pub fn succeeds(command: &mut Command) -> bool {
    let quiet = command.stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

/// What a command writes to standard output, trimmed; `None` where it cannot run or fails.
pub fn probe(command: &mut Command) -> Option<String> {
    let output = command.stderr(Stdio::null()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// The command as one would type it, programs by their names.
pub fn line(command: &Command) -> String {
    let program = Path::new(command.get_program());
    let mut line = program.file_name().unwrap_or(command.get_program()).to_string_lossy().into();
    for argument in command.get_args() {
        let argument = argument.to_string_lossy();
        let quote = if argument.is_empty() || argument.contains(' ') { "'" } else { "" };
        line = format!("{line} {quote}{argument}{quote}");
    }
    line
}

fn check(status: ExitStatus, line: &str) -> Result<()> {
    if !status.success() {
        bail!("`{line}` failed: {status}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = new(Path::new("."), "sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn a_program_that_hangs_is_ended() {
        let error = capture_within(&mut shell("exec sleep 30"), Duration::from_millis(50));
        assert!(error.unwrap_err().to_string().contains("did not end"));
    }

    #[test]
    fn an_exit_code_is_an_error_and_output_is_kept() {
        assert_eq!(capture_within(&mut shell("echo a"), Duration::from_secs(9)).unwrap(), "a\n");
        assert!(capture_within(&mut shell("exit 3"), Duration::from_secs(9)).is_err());
        assert!(run(&mut shell("exit 3")).is_err());
        assert!(capture(&mut shell("exit 3")).is_err());
        assert_eq!(probe(&mut shell("echo ' a '")), Some("a".to_owned()));
        assert_eq!(probe(&mut shell("exit 1")), None);
    }

    #[test]
    fn a_line_quotes_arguments_with_spaces() {
        assert_eq!(line(&shell("exit 3")), "sh -c 'exit 3'");
    }
}
