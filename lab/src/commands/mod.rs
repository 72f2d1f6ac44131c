//! The commands of `cargo vantage`.

pub mod compare;
pub mod dataset;
pub mod plan;

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on the error stream, with the time left; invisible where that is no terminal.
fn progress(what: &'static str, steps: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:<11} {wide_bar} {pos}/{len}, {eta} left");
    let bar = ProgressBar::new(steps as u64).with_message(what);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}
