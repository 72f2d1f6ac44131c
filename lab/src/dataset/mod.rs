//! Data to train a network on that predicts the objectives: views of hundreds of objects, exactly
//! labelled.
//!
//! Of each object there are photos of 100 train views and 100 validation views, masks of 200 test
//! views on a smooth spiral, the faces with what each view shows of them, and random walks over the
//! train views with the exact scores after each step and the exact gain of every further view
//! (Lee et al., 2023, section 4). Every other walk is drawn evenly; the rest begin with views far
//! apart and take half of their steps to the view that gains most in an objective, so that states
//! as a planner meets them are among the samples. Because faces and labels are kept, a
//! [`Ledger`](vantage_core::objectives::Ledger) gives the exact gains of any other state too.
//!
//! A data set is a folder: `manifest.json` and one compressed shard for each object, described byte
//! by byte in `FORMAT.md`. The same parameters give the same bytes on any number of threads. A run
//! that was interrupted continues where it stopped.
//!
//! Objects are divided, not views: about 8, 1 and 1 of 10 are for training, validation and test,
//! and all objects of [two classes](HELD_OUT_CLASSES) are for test.
//!
//! ```no_run
//! use vantage_lab::dataset::{Dataset, Split};
//!
//! let dataset = Dataset::open("data".as_ref())?;
//! for index in dataset.objects(Split::Train) {
//!     let object = dataset.load(index)?;
//!     for walk in &object.trajectories {
//!         let state = &walk.states[2]; // three photos were taken
//!         let gains = &state.gains; // (views, 4): C, Q, D, T
//!         let first = object.train.photo(walk.views[0].into()); // (height, width, 4)
//!         # let _ = (gains, first);
//!     }
//! }
//! # Ok::<(), vantage_lab::dataset::DatasetError>(())
//! ```

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

mod data;
mod error;
mod make;
mod manifest;
mod shard;
#[cfg(test)]
mod tests;
mod write;

pub use data::{ObjectData, State, TestViews, Trajectory, Views};
pub use error::{DatasetError, ShardError};
pub use manifest::{
    Entry, HELD_OUT_CLASSES, Manifest, Parameters, SourceFile, Split, test_objects,
};
pub use write::{Written, files_of, write};

/// A finished data set, open for reading; may be shared between threads.
#[derive(Clone, Debug)]
pub struct Dataset {
    dir: PathBuf,
    manifest: Manifest,
    fingerprint: u32,
}

impl Dataset {
    /// Opens a folder; reads its manifest only.
    pub fn open(dir: &Path) -> Result<Self, DatasetError> {
        let manifest = Manifest::read(dir)?;
        if manifest.objects.is_empty() {
            return Err(DatasetError::Incomplete(dir.to_owned()));
        }
        let fingerprint = manifest.parameters.fingerprint();
        Ok(Self { dir: dir.to_owned(), manifest, fingerprint })
    }

    /// What the data set was made from, and a line for each object.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// How many objects there are.
    pub fn len(&self) -> usize {
        self.manifest.objects.len()
    }

    /// Whether there are none; an open data set always has some.
    pub fn is_empty(&self) -> bool {
        self.manifest.objects.is_empty()
    }

    /// The indices of a split's objects, ascending.
    pub fn objects(&self, split: Split) -> Vec<usize> {
        let entries = self.manifest.objects.iter().enumerate();
        entries.filter(|(_, entry)| entry.split == split).map(|(index, _)| index).collect()
    }

    /// Reads an object: about 5 MB in memory at the default sizes. Length, checksum and every field
    /// are checked.
    pub fn load(&self, index: usize) -> Result<ObjectData, DatasetError> {
        let count = self.len();
        let entry =
            self.manifest.objects.get(index).ok_or(DatasetError::NoObject { index, count })?;
        let path = self.dir.join(&entry.shard);
        let bad = |why| DatasetError::BadShard { path: path.clone(), why };
        let bytes = read_at_most(&path, entry.bytes)?;
        if bytes.len() as u64 != entry.bytes {
            let got = fs::metadata(&path).map_or(bytes.len() as u64, |found| found.len());
            return Err(bad(ShardError::Length { expected: entry.bytes, got }));
        }
        if hex(shard::checksum(&bytes)) != entry.crc32 {
            return Err(bad(ShardError::Checksum));
        }
        let tag = shard::Tag { fingerprint: self.fingerprint, number: entry.number };
        let object = shard::decode(&bytes, self.manifest.parameters.image_size, tag);
        let object = object.map_err(bad)?;
        let Parameters { train_views, validation_views, test_views, .. } = self.manifest.parameters;
        let views =
            [object.train.poses.len(), object.validation.poses.len(), object.test.poses.len()];
        if views != [train_views, validation_views, test_views] {
            return Err(bad(ShardError::Mismatch));
        }
        Ok(object)
    }
}

/// A checksum as the manifest has it.
fn hex(checksum: u32) -> String {
    format!("{checksum:08x}")
}

/// A file's bytes, but hardly more than are expected.
fn read_at_most(path: &Path, expected: u64) -> Result<Vec<u8>, DatasetError> {
    let read = || {
        let mut bytes = Vec::new();
        File::open(path)?.take(expected.saturating_add(1)).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|error| DatasetError::io("read", path, error))
}

/// Writes a file that appears whole or not at all.
fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    let partial = path.with_extension("partial");
    let write = || {
        let mut file = File::create(&partial)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&partial, path)
    };
    write().map_err(|error| DatasetError::io("write", path, error))
}
