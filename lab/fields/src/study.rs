//! Studies: runs that were kept of sweeps and searches, to write results from.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::plans;
use crate::runs::{Run, write_whole};
use crate::summary::{Summary, summarise};

/// What a study is made of.
pub trait Kept: Clone + Serialize + DeserializeOwned {
    /// As it is kept.
    fn kept(&self) -> Self;

    /// Whether another one answers the same.
    fn is_again(&self, other: &Self) -> bool;
}

impl Kept for Run {
    fn kept(&self) -> Self {
        Self { object: name_of(&self.object), views: None, ..self.clone() }
    }

    fn is_again(&self, other: &Self) -> bool {
        (self.object.as_str(), self.scheme.as_str()) == (&other.object, &other.scheme)
            && (self.seed, self.budget) == (other.seed, other.budget)
    }
}

/// Runs of one question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study<T> {
    /// The commands that made them, first to last.
    pub commands: Vec<String>,
    /// In the order in which they were kept.
    pub runs: Vec<T>,
}

impl<T: Kept> Study<T> {
    /// Reads a file.
    pub fn open(path: &Path) -> Result<Self> {
        let text = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        serde_json::from_slice(&text)
            .with_context(|| format!("{} is no study: name another file", path.display()))
    }

    /// Fails if runs cannot be added to a file: before they are made, which may take hours.
    pub fn check(path: &Path) -> Result<()> {
        if path.exists() { Self::open(path).map(drop) } else { Ok(()) }
    }

    /// Adds runs to a file, which need not exist; those that answer the same are replaced.
    pub fn keep(path: &Path, command: &str, runs: &[T]) -> Result<()> {
        let mut study = if path.exists() {
            Self::open(path)?
        } else {
            Self { commands: Vec::new(), runs: Vec::new() }
        };
        if !study.commands.iter().any(|known| known == command) {
            study.commands.push(command.to_owned());
        }
        for run in runs.iter().map(Kept::kept) {
            match study.runs.iter_mut().find(|known| known.is_again(&run)) {
                Some(known) => *known = run,
                None => study.runs.push(run),
            }
        }
        // A run a line, so that a change shows.
        let commands = serde_json::to_string(&study.commands)?;
        let runs: Vec<String> =
            study.runs.iter().map(serde_json::to_string).collect::<serde_json::Result<_>>()?;
        let text = format!("{{\"commands\":{commands},\"runs\":[\n{}\n]}}\n", runs.join(",\n"));
        write_whole(path, text.as_bytes())
    }
}

impl Study<Run> {
    /// All that they say.
    pub fn summary(&self) -> Summary {
        summarise(&self.runs, &self.schemes(), &self.budgets())
    }

    /// Those planned, in the order in which they were kept, and those in hindsight that follow.
    pub fn schemes(&self) -> Vec<String> {
        let mut schemes: Vec<String> = Vec::new();
        for run in &self.runs {
            if !schemes.contains(&run.scheme) {
                schemes.push(run.scheme.clone());
            }
        }
        schemes.extend(plans::HINDSIGHT.iter().map(|(name, _)| (*name).to_owned()));
        schemes
    }

    /// Ascending, each once.
    pub fn budgets(&self) -> Vec<usize> {
        let mut budgets: Vec<usize> = self.runs.iter().map(|run| run.budget).collect();
        budgets.sort_unstable();
        budgets.dedup();
        budgets
    }
}

/// The command as it was typed, without where things were put.
pub fn command() -> String {
    let mut words = vec!["cargo vantage".to_owned()];
    let mut rest = std::env::args().skip(1);
    while let Some(word) = rest.next() {
        let (option, has_value) =
            word.split_once('=').map_or((word.as_str(), false), |(o, _)| (o, true));
        if !matches!(option, "--out" | "-o" | "--keep" | "--jobs") {
            words.push(word);
        } else if !has_value {
            rest.next();
        }
    }
    words.join(" ")
}

/// A file's stem, or the name of what is no file.
pub fn name_of(object: &str) -> String {
    let stem = Path::new(object).file_stem().filter(|_| object.contains('.'));
    stem.map_or(object.to_owned(), |stem| stem.to_string_lossy().into_owned())
}
