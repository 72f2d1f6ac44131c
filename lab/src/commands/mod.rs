//! The commands of `cargo vantage`.

pub mod compare;
pub mod dataset;
pub mod device;
pub mod photos;
pub mod plan;
pub mod train;

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use vantage_core::Camera;
use vantage_core::objectives::Reading;

use crate::label::RESOLUTION;
use crate::network::Network;
use crate::object::Object;
use crate::pool::FOV_X_RAD;
use crate::record::Scoring;
use crate::scheme;

/// A bar on the error stream, with the time left; invisible where that is no terminal.
fn progress(what: &'static str, steps: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:<11} {wide_bar} {pos}/{len}, {eta} left");
    let bar = ProgressBar::new(steps as u64).with_message(what);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// How views are scored.
#[derive(Args, Clone, Copy, Debug)]
pub struct ScoreArgs {
    /// Compute the paper's equations to the letter
    #[arg(long)]
    pub literal: bool,
    /// Side of the face-id images in pixels: what is smaller is not seen
    #[arg(long, default_value_t = RESOLUTION, value_name = "PIXELS")]
    pub resolution: u32,
    /// Seed of a built-in object
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub object_seed: u64,
}

impl ScoreArgs {
    fn reading(&self) -> Reading {
        if self.literal { Reading::literal() } else { Reading::default() }
    }

    fn camera(&self) -> Result<Camera> {
        let side = checked_size(self.resolution, "--resolution")?;
        Ok(Camera::from_fov(side, side, FOV_X_RAD)?)
    }

    fn scoring(&self) -> Scoring {
        let reading = if self.literal { "literal" } else { "default" };
        Scoring {
            reading: reading.to_owned(),
            resolution: self.resolution,
            object_seed: self.object_seed,
        }
    }
}

/// Which networks predict.
#[derive(Args, Clone, Debug, Default)]
pub struct ModelArgs {
    /// The network of the schemes soarnet… [default: the one that comes with the program]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The network without images of the schemes soarnet-poses… [default: the one that comes with the
    /// program]
    #[arg(long, value_name = "FILE")]
    pub poses_model: Option<PathBuf>,
}

impl ModelArgs {
    /// The network that a scheme asks, if it asks one.
    fn network_of(&self, scheme: &str) -> Result<Option<Network>> {
        scheme::network(scheme).map(|(network, plan)| self.open_for(network, plan)).transpose()
    }

    /// The networks that schemes ask, each once.
    pub fn networks(&self, schemes: &[String]) -> Result<Vec<(scheme::Network, Network)>> {
        let mut networks: Vec<(scheme::Network, Network)> = Vec::new();
        for (network, plan) in schemes.iter().filter_map(|scheme| scheme::network(scheme)) {
            // Opened for every plan, since not every network can serve every plan.
            let opened = self.open_for(network, plan)?;
            if !networks.iter().any(|(known, _)| *known == network) {
                networks.push((network, opened));
            }
        }
        Ok(networks)
    }

    /// The network of that kind, if it can serve the plan.
    fn open_for(&self, network: scheme::Network, plan: &str) -> Result<Network> {
        let opened = self.open(network)?;
        if plan == "support" && !opened.sees()? {
            bail!(
                "{}-support needs a model that looks at photos: give another --model",
                network.name()
            );
        }
        Ok(opened)
    }

    /// The network of that kind.
    fn open(&self, network: scheme::Network) -> Result<Network> {
        match (network, &self.model, &self.poses_model) {
            (scheme::Network::Soarnet, Some(file), _) => Network::open(file),
            (scheme::Network::Soarnet, None, _) => Ok(Network::shipped()),
            (scheme::Network::Poses, _, Some(file)) => {
                let network = Network::open(file)?;
                if network.sees()? {
                    bail!("the model {} looks at images: give it as --model", file.display());
                }
                Ok(network)
            }
            (scheme::Network::Poses, _, None) => Ok(Network::shipped_poses()),
        }
    }
}

/// A side of a picture that can be rendered.
fn checked_size(side: u32, option: &str) -> Result<u32> {
    if !(1..=8192).contains(&side) {
        bail!("pictures of {side} pixels cannot be rendered: give {option} between 1 and 8192");
    }
    Ok(side)
}

/// Says on the error stream what was not quite right with an object's file.
fn warn(object: &Object, bar: Option<&ProgressBar>) {
    for warning in &object.warnings {
        let say = || eprintln!("warning: {}: {warning}", object.name);
        bar.map_or_else(say, |bar| bar.suspend(say));
    }
}

/// Prints to standard output. A reader that has gone away has what it wanted.
fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("the result cannot be printed")
        }
        _ => Ok(()),
    }
}

/// Saves a record as JSON that people can read too.
fn save_json(path: &Path, record: &impl Serialize) -> Result<()> {
    let mut text = serde_json::to_string_pretty(record)?;
    text.push('\n');
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}
