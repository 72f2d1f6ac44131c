//! `cargo vantage field`: one field of one object, trained and measured.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use vantage_core::Camera;
use vantage_lab::object::Object;
use vantage_lab::pool::FOV_X_RAD;
use vantage_lab::render::Renderer;

use crate::evaluate::Quality;
use crate::fly;
use crate::lpips::Lpips;
use crate::photos::{Photos, dense_views, test_circle};
use crate::recipe::{Kind, Preset, Recipe};
use crate::runs::write_whole;
use crate::train::{EVERY, Trainer};

/// Steps from one checkpoint to the next.
const CHECKPOINT: usize = 4 * EVERY;

/// Train one radiance field on views spread evenly around an object, and measure it
#[derive(Args, Clone, Debug)]
pub struct FieldArgs {
    /// A GLB, glTF or OBJ file, a built-in object or one of a class
    pub object: String,
    /// The field
    #[arg(long, value_enum, default_value = "tensorf")]
    pub field: Kind,
    /// Its size, and that of the photos
    #[arg(long, value_enum, default_value = "small")]
    pub preset: Preset,
    /// Steps of training [default: the preset's]
    #[arg(long, value_name = "N")]
    pub steps: Option<usize>,
    /// Photos to train on
    #[arg(long, default_value_t = 100, value_name = "N")]
    pub views: usize,
    /// Test views on the circle, 1 to 200
    #[arg(long, default_value_t = 24, value_name = "N")]
    pub test_views: usize,
    /// Seed of the field
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub seed: u64,
    /// Measure LPIPS by this ONNX file: see `evaluate`
    #[arg(long, value_name = "FILE")]
    pub lpips: Option<PathBuf>,
    /// Fly along the test views, the render beside the truth: write an animated GIF, or, for a name
    /// without ending, a folder of numbered PNG files; more --test-views make a smoother flight
    #[arg(long, value_name = "FILE.gif")]
    pub fly: Option<PathBuf>,
    /// Folder of the training; an interrupted one continues
    #[arg(long, short, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `course.json`: what is trained, and how far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Course {
    object: String,
    recipe: Recipe,
    photo_side: u32,
    views: usize,
    seed: u64,
    step: usize,
    seconds: f64,
}

/// Trains, measures, prints, and writes the renders.
pub fn run(args: &FieldArgs) -> Result<()> {
    let mut recipe = Recipe::new(args.field, args.preset);
    recipe.steps = args.steps.unwrap_or(recipe.steps);
    recipe.check()?;
    args.fly.as_deref().map(fly::check).transpose()?;
    let object = Object::open(Some(&args.object), 0)?;
    let side = args.preset.photo_side();
    let camera = Camera::from_fov(side, side, FOV_X_RAD)?;
    let lpips = args.lpips.as_ref();
    let lpips = lpips.map(|file| Lpips::open(file, side as usize, side as usize)).transpose()?;
    let test_poses = test_circle(args.test_views)?;
    let train_poses = dense_views(args.views)?;
    let mut course = Course {
        object: args.object.clone(),
        recipe,
        photo_side: side,
        views: args.views,
        seed: args.seed,
        step: 0,
        seconds: 0.0,
    };
    if let Some(folder) = &args.out {
        open(folder, &mut course)?;
    }
    let renderer = Renderer::new(&object.mesh);
    let photos = Photos::of_mesh(&renderer, camera, train_poses);
    let mut trainer = Trainer::new(&course.recipe, &photos, args.seed);
    if let (Some(folder), 1..) = (&args.out, course.step) {
        let folder = checkpoint(folder, course.step);
        trainer.resume(course.step, |field| field.load(&folder))?;
    }

    let bar = ProgressBar::new(course.recipe.steps as u64);
    bar.set_style(ProgressStyle::with_template(
        "{elapsed_precise} {wide_bar} {pos}/{len} steps, {eta} left {msg}",
    )?);
    bar.set_position(course.step as u64);
    bar.reset_eta();
    let start = Instant::now();
    let before = course.seconds;
    while !trainer.is_over() {
        let loss = trainer.advance();
        ensure!(loss.is_finite(), "the loss is no longer finite");
        bar.inc(1);
        bar.set_message(format!("({:.1} dB)", -10.0 * loss.log10()));
        course.seconds = before + start.elapsed().as_secs_f64();
        if let Some(folder) = &args.out
            && (trainer.step().is_multiple_of(CHECKPOINT) || trainer.is_over())
        {
            save(folder, &trainer, &mut course)?;
        }
    }
    bar.finish_and_clear();
    let found = trainer.render(&camera, &test_poses);
    let test = Photos::of_mesh(&renderer, camera, test_poses);
    let quality = Quality::of(&found, &test.pictures, lpips.as_ref())?;
    if let Some(folder) = &args.out {
        for (index, picture) in found.iter().enumerate() {
            let path = folder.join(format!("render-{index:03}.png"));
            picture
                .to_image()
                .save(&path)
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
    }
    if let Some(path) = &args.fly {
        fly::write(path, &found, &test.pictures)?;
    }
    let lpips = quality.lpips.map_or("no weights".to_owned(), |lpips| format!("{lpips:.4}"));
    println!(
        "{}, {} of {} views: PSNR {:.2} dB, SSIM {:.4}, LPIPS {lpips}; {:.1} s of training on one thread",
        args.object,
        args.field.name(),
        args.views,
        quality.psnr,
        quality.ssim,
        course.seconds
    );
    Ok(())
}

/// A new folder, or one whose training goes on.
fn open(folder: &Path, course: &mut Course) -> Result<()> {
    ensure!(!folder.is_file(), "{} is a file: name a folder", folder.display());
    let path = folder.join("course.json");
    if !path.exists() {
        let occupied = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
        ensure!(!occupied, "{} is not empty: name another folder", folder.display());
        return fs::create_dir_all(folder)
            .with_context(|| format!("cannot create {}", folder.display()));
    }
    let text = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let known: Course =
        serde_json::from_slice(&text).with_context(|| format!("{} is damaged", path.display()))?;
    let fresh = Course { step: 0, seconds: 0.0, ..known.clone() };
    ensure!(fresh == *course, "{} holds another training: name another folder", folder.display());
    *course = known;
    Ok(())
}

fn checkpoint(folder: &Path, step: usize) -> PathBuf {
    folder.join(format!("step-{step:07}"))
}

/// The field first, the course last: whatever is interrupted, the course names whole files.
fn save(folder: &Path, trainer: &Trainer, course: &mut Course) -> Result<()> {
    let last = checkpoint(folder, course.step);
    let new = checkpoint(folder, trainer.step());
    fs::create_dir_all(&new).with_context(|| format!("cannot create {}", new.display()))?;
    trainer.field().save(&new)?;
    course.step = trainer.step();
    let text = serde_json::to_string_pretty(course)?;
    write_whole(&folder.join("course.json"), text.as_bytes())?;
    if last != new {
        // There is none before the first.
        let _ = fs::remove_dir_all(last);
    }
    Ok(())
}
