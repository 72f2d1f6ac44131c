//! Finished runs: one file each, so that an interrupted sweep goes on where it was.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use crate::recipe::{Kind, Preset, Recipe};

/// What every run of a sweep has in common; runs of other settings are not mixed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The kind of the field.
    pub field: Kind,
    /// Its size.
    pub preset: Preset,
    /// What was trained.
    pub recipe: Recipe,
    /// Side of photos and renders, pixels.
    pub photo_side: u32,
    /// Test views, see [`test_circle`](crate::photos::test_circle).
    pub test_views: usize,
    /// The candidates: their space and number, as `plan.json` has them.
    pub pool: serde_json::Value,
    /// Seed of built-in objects.
    pub object_seed: u64,
    /// The file that measures LPIPS.
    pub lpips: Option<PathBuf>,
    /// The files of networks that were given.
    pub models: [Option<PathBuf>; 2],
}

/// One trained field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// As it was named.
    pub object: String,
    /// As `evaluate` names it.
    pub scheme: String,
    /// That of the plan and of the field.
    pub seed: u64,
    /// Photos, at most.
    pub budget: usize,
    /// Photos that were taken: fewer where the plan ended before. None in runs of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub photos: Option<usize>,
    /// How far the camera went around the object from photo to photo, degrees. None likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel_deg: Option<f64>,
    /// Which candidates they are, in order; none for views that are no candidates.
    pub views: Option<Vec<usize>>,
    /// Mean over the test views, decibels.
    pub psnr: f64,
    /// Mean over the test views.
    pub ssim: f64,
    /// Mean over the test views; none without weights.
    pub lpips: Option<f64>,
    /// Seconds that choosing the views took.
    pub planning_seconds: f64,
    /// Seconds that training took, on one thread.
    pub training_seconds: f64,
}

/// The folder of a sweep.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// A new folder, or one that holds runs of the same settings. Nothing is written before
    /// [`create`](Self::create): what is refused meanwhile leaves no folder behind.
    pub fn open(folder: &Path, settings: &Settings) -> Result<Self> {
        let path = folder.join("settings.json");
        ensure!(!folder.is_file(), "{} is a file: name a folder", folder.display());
        if path.exists() {
            let text =
                fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
            let known: Settings = serde_json::from_slice(&text)
                .with_context(|| format!("{} is damaged", path.display()))?;
            ensure!(
                known == *settings,
                "{} holds runs of other settings: name another folder",
                folder.display()
            );
        } else {
            let occupied = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
            ensure!(!occupied, "{} is not empty: name another folder", folder.display());
        }
        Ok(Self { folder: folder.to_owned() })
    }

    /// Makes the folder, unless it is there.
    pub fn create(&self, settings: &Settings) -> Result<()> {
        let path = self.folder.join("settings.json");
        if path.exists() {
            return Ok(());
        }
        for folder in ["runs", "renders"].map(|name| self.folder.join(name)) {
            fs::create_dir_all(&folder)
                .with_context(|| format!("cannot create {}", folder.display()))?;
        }
        write_whole(&path, serde_json::to_string_pretty(settings)?.as_bytes())
    }

    /// The name of a run's files, without ending.
    fn name(object: &str, scheme: &str, seed: u64, budget: usize) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let object: String = object.chars().map(plain).collect();
        format!("{object}.{scheme}.{seed}.{budget}")
    }

    fn file(&self, object: &str, scheme: &str, seed: u64, budget: usize) -> PathBuf {
        let name = Self::name(object, scheme, seed, budget);
        self.folder.join("runs").join(format!("{name}.json"))
    }

    /// The picture of a run: render beside truth.
    pub fn render(&self, run: &Run) -> PathBuf {
        let name = Self::name(&run.object, &run.scheme, run.seed, run.budget);
        self.folder.join("renders").join(format!("{name}.png"))
    }

    /// The flight of a run along the test views, where there is one.
    pub fn flight(&self, run: &Run) -> PathBuf {
        self.render(run).with_extension("gif")
    }

    /// A run that is finished already.
    pub fn find(
        &self,
        object: &str,
        scheme: &str,
        seed: u64,
        budget: usize,
    ) -> Result<Option<Run>> {
        let path = self.file(object, scheme, seed, budget);
        if !path.exists() {
            return Ok(None);
        }
        let text = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let run: Run = serde_json::from_slice(&text)
            .with_context(|| format!("{} is damaged: delete it", path.display()))?;
        ensure!(
            run.object == object && run.scheme == scheme,
            "{} is of {}: give objects names that differ in letters and digits",
            path.display(),
            run.object
        );
        Ok(Some(run))
    }

    /// Keeps a finished run.
    pub fn keep(&self, run: &Run) -> Result<()> {
        let path = self.file(&run.object, &run.scheme, run.seed, run.budget);
        write_whole(&path, serde_json::to_string(run)?.as_bytes())
    }

    /// A file of results.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf> {
        let path = self.folder.join(name);
        write_whole(&path, bytes)?;
        Ok(path)
    }
}

/// Writes a file under another name and gives it its own by one rename.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let partial = path.with_extension("partial");
    let written = fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        // The error that counts is told already.
        let _ = fs::remove_file(&partial);
    }
    written.with_context(|| format!("cannot write {}", path.display()))
}

/// All runs as a table with a head.
pub fn csv(runs: &[Run]) -> String {
    let mut text =
        "object,scheme,seed,budget,photos,travel_deg,views,psnr,ssim,lpips,planning_seconds,\
         training_seconds\n"
            .to_owned();
    for run in runs {
        // A comma in a name must not start a new column.
        let object = format!("\"{}\"", run.object.replace('"', "\"\""));
        let views: Vec<String> = run.views.iter().flatten().map(usize::to_string).collect();
        let lpips = run.lpips.map_or("no weights".to_owned(), |value| format!("{value:.5}"));
        text += &format!(
            "{object},{},{},{},{},{},{},{:.4},{:.5},{lpips},{:.4},{:.2}\n",
            run.scheme,
            run.seed,
            run.budget,
            run.photos.map_or(String::new(), |photos| photos.to_string()),
            run.travel_deg.map_or(String::new(), |degrees| format!("{degrees:.1}")),
            views.join(" "),
            run.psnr,
            run.ssim,
            run.planning_seconds,
            run.training_seconds
        );
    }
    text
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub fn run(object: &str, scheme: &str, seed: u64, budget: usize, psnr: f64) -> Run {
        Run {
            object: object.to_owned(),
            scheme: scheme.to_owned(),
            seed,
            budget,
            photos: Some(budget),
            travel_deg: Some(90.0),
            views: Some(vec![4, 2]),
            psnr,
            ssim: 0.9,
            lpips: None,
            planning_seconds: 0.5,
            training_seconds: 3.0,
        }
    }

    fn settings(side: u32) -> Settings {
        Settings {
            field: Kind::Plenoxels,
            preset: Preset::Small,
            recipe: Recipe::new(Kind::Plenoxels, Preset::Small),
            photo_side: side,
            test_views: 8,
            pool: serde_json::Value::Null,
            object_seed: 0,
            lpips: None,
            models: [None, None],
        }
    }

    #[test]
    fn finished_runs_are_found_again_and_settings_are_not_mixed() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("sweep");
        let store = Store::open(&folder, &settings(100)).unwrap();
        assert!(!folder.exists());
        store.create(&settings(100)).unwrap();
        let one = run("a/b.glb", "fps", 1, 6, 21.5);
        store.keep(&one).unwrap();
        let store = Store::open(&folder, &settings(100)).unwrap();
        assert_eq!(store.find("a/b.glb", "fps", 1, 6).unwrap(), Some(one));
        assert_eq!(store.find("a/b.glb", "fps", 2, 6).unwrap(), None);
        let error = store.find("a_b.glb", "fps", 1, 6).unwrap_err();
        assert!(error.to_string().contains("names that differ"), "{error}");
        let error = Store::open(&folder, &settings(64)).err().unwrap();
        assert!(error.to_string().contains("other settings"), "{error}");
        let error = Store::open(home.path(), &settings(64)).err().unwrap();
        assert!(error.to_string().contains("not empty"), "{error}");
    }

    #[test]
    fn without_weights_there_is_no_figure() {
        let text = csv(&[run("a,b", "fps", 1, 6, 21.5)]);
        assert!(
            text.ends_with("\"a,b\",fps,1,6,6,90.0,4 2,21.5000,0.90000,no weights,0.5000,3.00\n"),
            "{text}"
        );
    }
}
