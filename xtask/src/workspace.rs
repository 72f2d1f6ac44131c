//! Where things are: the repository's root, cargo's target directory, the features of a package.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use serde_json::Value;

use crate::command;

/// What `cargo metadata` says about this workspace.
pub struct Workspace {
    /// The repository's root.
    pub root: PathBuf,
    /// Cargo's target directory, from CARGO_TARGET_DIR or the configuration.
    pub target: PathBuf,
    metadata: Value,
}

impl Workspace {
    /// The workspace that xtask belongs to, wherever it is called from.
    pub fn find() -> Result<Self> {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = manifest.parent().context("xtask lies in the repository's root")?.to_owned();
        let mut cargo = command::new(&root, cargo());
        cargo.args(["metadata", "--format-version=1", "--no-deps", "--quiet"]);
        let text = command::capture(&mut cargo)?;
        let metadata: Value = serde_json::from_str(&text).context("`cargo metadata` is no JSON")?;
        let target = metadata["target_directory"].as_str().context("no target directory")?.into();
        Ok(Self { root, target, metadata })
    }

    /// A path inside the repository.
    pub fn path(&self, relative: &str) -> PathBuf {
        self.root.join(relative)
    }

    /// The names of a package's features without `default`, sorted.
    pub fn features(&self, package: &str) -> Result<Vec<String>> {
        let packages = self.metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
        let features = packages
            .iter()
            .find(|candidate| candidate["name"] == package)
            .and_then(|found| found["features"].as_object())
            .ok_or_else(|| anyhow!("the workspace has no package `{package}`"))?;
        Ok(features.keys().filter(|name| *name != "default").cloned().collect())
    }
}

/// The cargo that runs us, so that one toolchain builds everything.
pub fn cargo() -> impl AsRef<OsStr> {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}
