//! `manifest.json`: what a data set was made from, and its shards.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use vantage_core::objectives::Reading;

use super::error::DatasetError;
use super::shard::{VERSION, checksum};
use crate::mesh::{CLASSES, Chance};

/// The manifest's name in the folder.
pub(super) const MANIFEST: &str = "manifest.json";

/// Classes whose objects are all in the test split: never trained on, one of thin wires, one
/// organic.
pub const HELD_OUT_CLASSES: [&str; 2] = ["fan", "lion"];

/// Of 28 objects in a row, one is of each class and these are of none.
const FREEFORM_SHARE: usize = 8;

/// What an object may be used for. Objects, not views, are divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// To fit weights: 8 of 10 objects of the classes that are not held out.
    Train,
    /// To choose among networks: 1 of 10.
    Validation,
    /// To report: 1 of 10, and every object of a [held-out class](HELD_OUT_CLASSES).
    Test,
}

/// What a data set is made from. The same parameters give the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// How many objects.
    pub objects: usize,
    /// Of everything that is left to chance.
    pub seed: u64,
    /// Side of photos and masks in pixels.
    pub image_size: u32,
    /// Side of the face-id images behind the labels in pixels.
    pub resolution: u32,
    /// Views that may be chosen.
    pub train_views: usize,
    /// Further views of the same object.
    pub validation_views: usize,
    /// Views on a smooth spiral.
    pub test_views: usize,
    /// Random walks over the train views.
    pub trajectories: usize,
    /// Views of each walk.
    pub steps: usize,
    /// How the objectives are read.
    pub reading: Reading,
    /// The files the objects come from, in order; empty where they are made here.
    pub files: Vec<SourceFile>,
}

/// A file that an object comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SourceFile {
    /// Its name in the folder.
    pub name: String,
    /// Its length.
    pub bytes: u64,
}

/// One object's line in the manifest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// From 0, without gaps.
    pub number: u32,
    /// A file's stem, or the class and the number.
    pub name: String,
    /// One of [`CLASSES`], or `file`.
    pub class: String,
    /// Of the object's shape and views.
    pub seed: u64,
    /// What it may be used for.
    pub split: Split,
    /// Triangles of its mesh.
    pub faces: usize,
    /// Its shard, relative to the folder.
    pub shard: String,
    /// The shard's length.
    pub bytes: u64,
    /// The shard's CRC-32, as eight hexadecimal digits.
    pub crc32: String,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Always `vantage-dataset`.
    pub format: String,
    /// The version of the shards' format.
    pub version: u32,
    /// Program and version that made it.
    pub generator: String,
    /// What it is made from.
    pub parameters: Parameters,
    /// All classes there are.
    pub classes: Vec<String>,
    /// Those that are only in the test split.
    pub held_out_classes: Vec<String>,
    /// One for each object, in order; empty until the last shard is written.
    pub objects: Vec<Entry>,
}

/// An object to be made.
pub(super) struct Assignment {
    pub name: String,
    pub class: String,
    pub seed: u64,
    pub split: Split,
}

impl Parameters {
    /// Refuses what cannot be made.
    pub(super) fn check(&self) -> Result<(), String> {
        let within = |what: &str, value: usize, low: usize, high: usize| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(format!("{what} must lie between {low} and {high}, not be {value}"))
            }
        };
        within("the number of objects", self.objects, 1, 1_000_000)?;
        within("the image size", self.image_size as usize, 8, 512)?;
        within("the resolution", self.resolution as usize, 16, 1024)?;
        within("the number of train views", self.train_views, 1, 10_000)?;
        within("the number of validation views", self.validation_views, 1, 10_000)?;
        within("the number of test views", self.test_views, 1, 10_000)?;
        within("the number of trajectories", self.trajectories, 0, 1_000)?;
        within("the steps of a trajectory", self.steps, 1, self.train_views)
    }

    /// Tells data sets apart: the checksum of the parameters as JSON.
    pub(super) fn fingerprint(&self) -> u32 {
        // Numbers and names alone always have a JSON form.
        checksum(&serde_json::to_vec(self).unwrap_or_default()) ^ VERSION
    }

    /// What object `number` is.
    pub(super) fn assignment(&self, number: u32) -> Assignment {
        let seed = seed_of(self.seed, number);
        let (name, class) = match self.files.get(number as usize) {
            Some(file) => {
                let stem = Path::new(&file.name).file_stem().unwrap_or_default();
                (stem.to_string_lossy().into_owned(), "file")
            }
            None => {
                let class = class_of(number);
                (format!("{class}-{number:06}"), class)
            }
        };
        let split = split_of(number, class);
        Assignment { name, class: class.to_owned(), seed, split }
    }
}

/// The seed of an object, in a data set of some seed.
fn seed_of(seed: u64, number: u32) -> u64 {
    Chance::new(seed ^ u64::from(number) << 32).bits()
}

/// The class of an object that is made here.
fn class_of(number: u32) -> &'static str {
    // `freeform` is the last class, after one of each other.
    let ordinary = CLASSES.len() - 1;
    CLASSES[(number as usize % (ordinary + FREEFORM_SHARE)).min(ordinary)]
}

/// By the object's number alone, so that a larger data set keeps the division of a smaller.
fn split_of(number: u32, class: &str) -> Split {
    match Chance::new(u64::from(number)).bits() % 10 {
        _ if HELD_OUT_CLASSES.contains(&class) => Split::Test,
        0 => Split::Test,
        1 => Split::Validation,
        _ => Split::Train,
    }
}

/// The first objects of the test split of a data set of some seed, made here: class and seed, as
/// [`mesh::class`](crate::mesh::class) takes them.
pub fn test_objects(seed: u64, count: usize) -> Vec<(&'static str, u64)> {
    (0..u32::MAX)
        .map(|number| (number, class_of(number)))
        .filter(|&(number, class)| split_of(number, class) == Split::Test)
        .map(|(number, class)| (class, seed_of(seed, number)))
        .take(count)
        .collect()
}

/// Where an object's shard lies in the folder.
pub(super) fn shard_name(number: u32) -> String {
    format!("objects/{number:06}.shard")
}

impl Manifest {
    /// The manifest of a data set in the making.
    pub(super) fn unfinished(parameters: Parameters) -> Self {
        let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        Self {
            format: "vantage-dataset".to_owned(),
            version: VERSION,
            generator: format!("vantage-lab {}", env!("CARGO_PKG_VERSION")),
            parameters,
            classes: owned(CLASSES),
            held_out_classes: owned(&HELD_OUT_CLASSES),
            objects: Vec::new(),
        }
    }

    /// Reads and checks the manifest of a folder.
    pub(super) fn read(dir: &Path) -> Result<Self, DatasetError> {
        let path = dir.join(MANIFEST);
        let text = fs::read_to_string(&path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
                DatasetError::NotADataset(dir.to_owned())
            }
            _ => DatasetError::io("read", &path, error),
        })?;
        Self::parse(&text).map_err(|why| DatasetError::BadManifest { path, why })
    }

    /// The manifest of a text, if it does not contradict itself.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let value: serde_json::Value =
            serde_json::from_str(text).map_err(|error| format!("it is not JSON: {error}"))?;
        if value.get("format").and_then(|format| format.as_str()) != Some("vantage-dataset") {
            return Err("it is no manifest of a data set".to_owned());
        }
        match value.get("version").and_then(|version| version.as_u64()) {
            Some(version) if version == u64::from(VERSION) => {}
            Some(version) => {
                return Err(format!(
                    "it has version {version}, and this program reads version {VERSION}"
                ));
            }
            None => return Err("it has no version".to_owned()),
        }
        let manifest: Self = serde_json::from_value(value).map_err(|error| error.to_string())?;
        manifest.parameters.check()?;
        let (expected, got) = (manifest.parameters.objects, manifest.objects.len());
        if got != 0 && got != expected {
            return Err(format!("it lists {got} objects of {expected}"));
        }
        for (number, entry) in (0..).zip(&manifest.objects) {
            // A shard's name is never a way out of the folder.
            if entry.number != number || entry.shard != shard_name(number) {
                return Err(format!("its entry {number} is not of object {number}"));
            }
        }
        Ok(manifest)
    }

    /// Writes it into a folder: under another name first, then by one rename.
    pub(super) fn write(&self, dir: &Path) -> Result<(), DatasetError> {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        super::write_whole(&dir.join(MANIFEST), text.as_bytes())
    }
}
