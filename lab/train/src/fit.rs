//! The training loop: resumable, its course on record.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use burn::grad_clipping::GradientClippingConfig;
use burn::module::Module;
use burn::nn::loss::{HuberLossConfig, Reduction};
use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer};
use burn::store::ModuleRecord;
use burn::tensor::activation::{log_softmax, relu, softmax};
use burn::tensor::{Device, Tensor};
use indicatif::{ProgressBar, ProgressStyle};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::files::write_whole;
use crate::measure::{Measured, measure};
use crate::net::{Answer, Network, Shape};
use crate::samples::{Ask, Batch, MOST_VIEWS, Object, Target};

/// Everything that the trained weights depend on beside the data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    pub shape: Shape,
    /// Whether H learns F_n+1 itself, not the order of gains.
    pub cumulative: bool,
    /// Passes over the training objects, a capture of each.
    pub epochs: usize,
    /// Captures in a step.
    pub batch: usize,
    /// Highest rate of Adam.
    pub rate: f64,
    /// Whether the rate is halved once, at 60 %; else it rises over 200 steps and falls as a cosine.
    pub halved: bool,
    /// How much the best views count beyond the others: the weight of a listwise cross-entropy.
    pub listwise: f32,
    /// Weight of the sketches, the seen and the recalled.
    pub sketch: f32,
    /// Whether photos are changed by chance.
    pub augment: bool,
    /// Epochs without improvement after which training ends.
    pub patience: usize,
    pub seed: u64,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            shape: Shape::default(),
            cumulative: false,
            epochs: 36,
            batch: 8,
            rate: 1.5e-3,
            halved: false,
            listwise: 0.2,
            sketch: 2.0,
            augment: true,
            patience: 20,
            seed: 1,
        }
    }
}

impl Recipe {
    /// The paper's wording: views averaged, cumulative targets, its rate and epochs.
    pub fn literal() -> Self {
        Self {
            shape: Shape { relative: false, maximum: false, outlook: false, ..Shape::default() },
            cumulative: true,
            epochs: 12,
            rate: 3e-5,
            halved: true,
            listwise: 0.0,
            sketch: 0.0,
            augment: false,
            ..Self::default()
        }
    }

    /// What no training can do with.
    fn check(&self) -> Result<()> {
        ensure!(self.epochs > 0, "--epochs is 0: train for one at least");
        ensure!(self.batch > 0, "--batch is 0: a step takes one capture at least");
        let rate = self.rate;
        ensure!(rate.is_finite() && rate > 0.0, "--rate is {rate}: give one above 0");
        let weight = self.listwise;
        ensure!(weight.is_finite() && weight >= 0.0, "--listwise is {weight}: give 0 or more");
        Ok(())
    }

    /// The rate at a step of so many.
    fn rate_at(&self, step: usize, steps: usize) -> f64 {
        let share = step as f64 / steps as f64;
        if self.halved {
            return self.rate * if share < 0.6 { 1.0 } else { 0.5 };
        }
        let rise = ((step + 1) as f64 / 200.0).min(1.0);
        self.rate * rise * (0.5 + 0.5 * (std::f64::consts::PI * share).cos()).max(0.01)
    }
}

/// One line of the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    pub epoch: usize,
    pub loss: f32,
    pub seconds: f64,
    pub validation: Measured,
}

/// Where a run stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Course {
    pub recipe: Recipe,
    /// Tells data sets apart.
    pub data: String,
    pub epochs: Vec<Epoch>,
}

impl Course {
    /// The best epoch so far, by validation.
    pub fn best(&self) -> Option<&Epoch> {
        self.epochs.iter().max_by(|a, b| a.validation.mean().total_cmp(&b.validation.mean()))
    }

    fn is_over(&self) -> bool {
        let stale = self
            .best()
            .is_some_and(|best| self.epochs.len() - (best.epoch + 1) >= self.recipe.patience);
        self.epochs.len() >= self.recipe.epochs || stale
    }
}

/// The files of a run.
pub struct Run {
    dir: PathBuf,
}

impl Run {
    /// Opens a folder for a run of this recipe on this data: a new one, or one to go on with.
    ///
    /// Nothing is written before [`fit`]: what is refused meanwhile leaves no folder behind.
    pub fn open(dir: &Path, recipe: &Recipe, data: &str) -> Result<(Self, Course)> {
        recipe.check()?;
        ensure!(!dir.is_file(), "{} is a file: name a folder", dir.display());
        let run = Self { dir: dir.to_owned() };
        let fresh = Course { recipe: recipe.clone(), data: data.to_owned(), epochs: Vec::new() };
        if !run.course_file().exists() {
            let occupied = fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_some());
            ensure!(!occupied, "{} is not empty: name another folder", dir.display());
            return Ok((run, fresh));
        }
        let course = run.course()?;
        ensure!(
            course.recipe == *recipe && course.data == data,
            "{} holds a run of another recipe or on other data: name another folder",
            dir.display()
        );
        Ok((run, course))
    }

    /// Opens the folder of a run that has trained something.
    pub fn existing(dir: &Path) -> Result<Self> {
        let run = Self { dir: dir.to_owned() };
        ensure!(
            run.course_file().exists(),
            "{} holds no run: train one with `cargo vantage train --out {}`",
            dir.display(),
            dir.display()
        );
        Ok(run)
    }

    fn course_file(&self) -> PathBuf {
        self.dir.join("course.json")
    }

    /// What is on record.
    pub fn course(&self) -> Result<Course> {
        let path = self.course_file();
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        serde_json::from_str(&text).with_context(|| format!("{} is damaged", path.display()))
    }

    /// The weights of the best epoch.
    pub fn best_file(&self) -> PathBuf {
        self.dir.join("best.bpk")
    }

    /// The weights and the optimiser after an epoch.
    fn checkpoint(&self, epochs: usize) -> (PathBuf, PathBuf) {
        let of = |what: &str| self.dir.join(format!("{what}-{epochs:04}.bpk"));
        (of("weights"), of("optimizer"))
    }

    /// Weights first, the course last: whatever is interrupted, the course names whole files.
    fn save(&self, net: &Network, optimizer: &ModuleOptimizer, course: &Course) -> Result<()> {
        let epochs = course.epochs.len();
        let (weights, state) = self.checkpoint(epochs);
        save_record(net.valid().into_record(), &weights)?;
        let partial = state.with_extension("partial.bpk");
        optimizer.save(&partial).map_err(|error| anyhow::anyhow!("cannot write: {error}"))?;
        fs::rename(&partial, &state)?;
        if course.best().is_some_and(|best| best.epoch + 1 == epochs) {
            let partial = self.dir.join("best.partial.bpk");
            fs::copy(&weights, &partial)?;
            fs::rename(&partial, self.best_file())?;
        }
        write_whole(&self.dir.join("metrics.csv"), csv(course).as_bytes())?;
        write_whole(&self.course_file(), serde_json::to_string_pretty(course)?.as_bytes())?;
        if epochs > 1 {
            let (weights, state) = self.checkpoint(epochs - 1);
            let _ = (fs::remove_file(weights), fs::remove_file(state));
        }
        Ok(())
    }
}

/// Writes weights; the file appears whole or not at all.
pub fn save_record(record: ModuleRecord, path: &Path) -> Result<()> {
    let partial = path.with_extension("partial.bpk");
    record
        .save(&partial)
        .map_err(|error| anyhow::anyhow!("cannot write {}: {error}", partial.display()))?;
    fs::rename(&partial, path).with_context(|| format!("cannot write {}", path.display()))
}

/// A network of a shape with the weights of a file.
pub fn load_network(shape: &Shape, path: &Path, device: &Device) -> Result<Network> {
    let record = ModuleRecord::load(path)
        .map_err(|error| anyhow::anyhow!("cannot read {}: {error}", path.display()))?;
    Ok(Network::new(shape, device).load_record(record))
}

fn csv(course: &Course) -> String {
    let mut text = "epoch,loss,seconds,spearman_c,spearman_q,spearman_d,spearman_t,\
                    share_c,share_q,share_d,share_t\n"
        .to_owned();
    for Epoch { epoch, loss, seconds, validation } in &course.epochs {
        text += &format!("{epoch},{loss:.5},{seconds:.1}");
        for value in validation.spearman.iter().chain(&validation.share) {
            text += &format!(",{value:.4}");
        }
        text += "\n";
    }
    text
}

/// Trains until the recipe's last epoch, or until validation no longer improves.
pub fn fit(
    run: &Run,
    course: Course,
    train: &[Object],
    validation: &[Object],
    device: &Device,
) -> Result<Course> {
    fit_until(run, course, train, validation, device, usize::MAX)
}

/// The same, but stops once so many epochs are done, as if interrupted.
pub fn fit_until(
    run: &Run,
    mut course: Course,
    train: &[Object],
    validation: &[Object],
    device: &Device,
    stop: usize,
) -> Result<Course> {
    fs::create_dir_all(&run.dir).with_context(|| format!("cannot create {}", run.dir.display()))?;
    let recipe = course.recipe.clone();
    let device = device.clone().autodiff();
    device.seed(recipe.seed);
    let mut net = Network::new(&recipe.shape, &device);
    let clip = GradientClippingConfig::Norm(1.0);
    let mut optimizer = AdamConfig::new()
        .with_amsgrad(true)
        .with_epsilon(1e-8)
        .with_grad_clipping(Some(clip))
        .init();
    let done = course.epochs.len();
    if done > 0 {
        let (weights, state) = run.checkpoint(done);
        let record = ModuleRecord::load(&weights)
            .map_err(|error| anyhow::anyhow!("cannot read {}: {error}", weights.display()))?;
        net = net.load_record(record);
        optimizer = optimizer
            .load(&state)
            .map_err(|error| anyhow::anyhow!("cannot read {}: {error}", state.display()))?;
    }
    let longest = train.iter().map(Object::steps).min().unwrap_or(0);
    let a_pass = train.len().div_ceil(recipe.batch);
    let steps = recipe.epochs * a_pass;
    let bar = ProgressBar::new(steps as u64).with_style(ProgressStyle::with_template(
        "{elapsed_precise} {bar:30} {pos}/{len} steps, {eta} left {msg}",
    )?);
    bar.set_position((done * a_pass) as u64);
    bar.reset_eta();

    while !course.is_over() && course.epochs.len() < stop {
        let epoch = course.epochs.len();
        let start = Instant::now();
        let mut sum = 0.0;
        thread::scope(|scope| {
            let (send, batches) = sync_channel::<Batch>(2);
            let recipe = &recipe;
            scope.spawn(move || {
                let mut chance = Pcg64::seed_from_u64(recipe.seed ^ ((epoch as u64 + 1) << 32));
                let mut order: Vec<&Object> = train.iter().collect();
                order.shuffle(&mut chance);
                for objects in order.chunks(recipe.batch) {
                    let ask = ask(recipe, longest, &mut chance);
                    // Long captures, half as many.
                    let objects = &objects[..objects.len().div_ceil(ask.views.div_ceil(16))];
                    if send.send(Batch::draw(objects, None, &ask, &mut chance)).is_err() {
                        return;
                    }
                }
            });
            for (place, batch) in batches.iter().enumerate() {
                let answer = net.forward(batch.question(&device));
                let loss = loss(recipe, answer, batch.target(recipe.cumulative, &device));
                let gradients = GradientsParams::from_grads(loss.backward(), &net);
                let rate = recipe.rate_at(epoch * a_pass + place, steps);
                net = optimizer.step(rate, net.clone(), gradients);
                sum += loss.into_scalar::<f32>();
                bar.inc(1);
                bar.set_message(format!("(loss {:.4})", sum / (place + 1) as f32));
            }
        });
        let validation = measure(&net.valid(), validation, 2, &device.clone().inner());
        let loss = sum / a_pass as f32;
        ensure!(loss.is_finite(), "the loss is no longer finite: lower --rate");
        course.epochs.push(Epoch {
            epoch,
            loss,
            seconds: start.elapsed().as_secs_f64(),
            validation,
        });
        run.save(&net, &optimizer, &course)?;
        let [c, q, d, t] = validation.spearman;
        bar.println(format!(
            "epoch {epoch}: loss {loss:.4}, rank correlation C {c:.3} Q {q:.3} D {d:.3} T {t:.3}, \
             mean with share of best gain {:.3}",
            validation.mean()
        ));
    }
    bar.finish_and_clear();
    Ok(course)
}

/// Most captures are short; some are long, so that the counts beyond are known too.
fn ask(recipe: &Recipe, steps: usize, chance: &mut Pcg64) -> Ask {
    let long = chance.random_bool(0.15);
    let (views, every) = if long { (MOST_VIEWS.min(steps), 2) } else { (12.min(steps), 1) };
    let counts = (every..=views).step_by(every).collect();
    let photos = recipe.shape.embedding > 0;
    Ask { views, counts, candidates: 64, augment: recipe.augment, photos }
}

fn loss(recipe: &Recipe, answer: Answer, target: Target) -> Tensor<1> {
    let huber = HuberLossConfig::new(1.0).init();
    let listwise = (recipe.listwise > 0.0).then(|| {
        // The distribution over views that prefers better ones, e^2 times for each spread.
        let wanted = softmax(target.ranks.clone() * 2.0, 1);
        let given = log_softmax(answer.ranks.clone() * 2.0, 1);
        ((wanted * given).sum_dim(1) * target.stakes.clone()).mean().neg() * recipe.listwise
    });
    // States and objectives in which there is more to win count more.
    let ranks = huber.forward_no_reduction(answer.ranks, target.ranks) * target.stakes.clone();
    let ranks = ranks.mean();
    // Scores and gains are small numbers; a tenth is much.
    let state = huber.forward(answer.state * 10.0, target.state * 10.0, Reduction::Mean) * 0.1;
    let mut loss = ranks + state;
    if let Some(listwise) = listwise {
        loss = loss + listwise;
    }
    if let (Some(told), Some(wanted)) = (answer.sketches, target.sketches) {
        // Too little cover carves the object away; too much only leaves some space standing.
        let off = |told: Tensor<2>| {
            let off = told - wanted.clone();
            (off.clone().powi_scalar(2) + relu(-off).powi_scalar(2) * 2.0).mean()
        };
        loss = loss + (off(told.seen) * 2.0 + off(told.recalled)) * recipe.sketch;
    }
    loss
}
