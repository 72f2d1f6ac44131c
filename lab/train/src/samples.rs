//! Samples to train on: states of captures, and what each further view would have gained.

use anyhow::{Context, Result};
use burn::tensor::{Device, Tensor, TensorData};
use rand::seq::SliceRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use vantage_core::soarnet::features::{self, COUNT, DIRECTION, Direction, RELATION, Stance};
use vantage_core::soarnet::{CELL, DETAIL, Form, OUTLOOK, SKETCH, places_in_sketch};
use vantage_core::{Pose, Scores, Vec3};
use vantage_lab::dataset::{Dataset, ObjectData, Split};

use crate::augment::{Look, PHOTO};
use crate::net::{OBJECTIVES, Question, SIDE, STATE};

/// One object, as far as training needs it.
pub struct Object {
    pub class: String,
    photos: Vec<u8>, // (views, 64, 64, 4)
    poses: Vec<Pose>,
    stances: Vec<Stance>,
    walks: Vec<Walk>,
}

struct Walk {
    views: Vec<u16>,
    scores: Vec<[f32; OBJECTIVES]>,     // (steps, 4)
    gains: Vec<Vec<[f32; OBJECTIVES]>>, // (steps, views, 4)
    outlooks: Vec<Vec<[i8; OUTLOOK]>>,  // (steps, views, 8), from true outlines
}

/// Views of a walk that training needs: a first look, and some states after it.
pub const FEWEST_STEPS: usize = 6;

/// The objects of a split, at most so many, in parallel; `done` is called after each. `hulls`: whether
/// outlooks are wanted, which take most of the time.
pub fn load(
    dataset: &Dataset,
    split: Split,
    most: Option<usize>,
    hulls: bool,
    done: impl Fn() + Sync,
) -> Result<Vec<Object>> {
    anyhow::ensure!(
        dataset.manifest().parameters.image_size as usize == SIDE,
        "the data set's photos have {} pixels a side and the network takes {SIDE}: make it with \
         --image-size {SIDE}",
        dataset.manifest().parameters.image_size
    );
    let mut indices = dataset.objects(split);
    indices.truncate(most.unwrap_or(usize::MAX));
    anyhow::ensure!(
        !indices.is_empty(),
        "the data set has no objects for {split:?}: make one of 24 objects or more"
    );
    let parameters = &dataset.manifest().parameters;
    anyhow::ensure!(
        parameters.trajectories > 0 && parameters.steps >= FEWEST_STEPS,
        "the data set's walks are too short: make it with --trajectories 1 or more and --steps \
         {FEWEST_STEPS} or more"
    );
    let objects = indices.into_par_iter().map(|index| {
        let object = Object::new(dataset.load(index)?, hulls)?;
        done();
        Ok(object)
    });
    objects.collect()
}

impl Object {
    fn new(data: ObjectData, hulls: bool) -> Result<Self> {
        let stances = data.train.poses.iter().map(|pose| Stance::try_new(pose, Vec3::ZERO));
        let stances: Option<Vec<Stance>> = stances.collect();
        let walks = data.trajectories.into_iter().map(|walk| Walk {
            scores: walk.states.iter().map(|state| in_order(&state.scores)).collect(),
            gains: walk.states.into_iter().map(|state| state.gains).collect(),
            views: walk.views,
            outlooks: Vec::new(),
        });
        let mut object = Self {
            class: data.class,
            photos: data.train.photos,
            poses: data.train.poses,
            stances: stances
                .with_context(|| format!("{}: a view stands on its object", data.name))?,
            walks: walks.collect(),
        };
        if hulls {
            object.look();
        }
        Ok(object)
    }

    /// Fills in every walk's outlooks. Every other pair of walks has outlines with errors, as a network
    /// draws them.
    fn look(&mut self) {
        let sketches: Vec<[i8; SKETCH]> =
            (0..self.stances.len()).map(|view| self.sketch(view)).collect();
        let directions: Vec<Direction> = self.stances.iter().map(|s| s.direction).collect();
        let mut form = Box::<Form>::default();
        let mut chance = Pcg64::seed_from_u64(self.walks.len() as u64);
        for number in 0..self.walks.len() {
            let mut sketches = sketches.clone();
            if number % 4 >= 2 {
                for value in sketches.as_flattened_mut() {
                    *value = (*value as i16 + chance.random_range(-18..=18)).clamp(-128, 127) as i8;
                }
            }
            let walk = &mut self.walks[number];
            form.begin();
            for (step, &view) in walk.views.iter().enumerate() {
                let view = usize::from(view);
                form.take_in(&self.stances[view], &sketches[view]);
                let mut outlooks = vec![[0; OUTLOOK]; directions.len()];
                if is_asked(step + 1) {
                    let seen = walk.views[..=step].iter().map(|&view| usize::from(view));
                    let seen = seen.map(|view| (&self.stances[view], sketches[view].as_slice()));
                    form.outlooks(seen, &directions, &mut outlooks, |_, _| ());
                }
                let bytes = |outlook: [i32; OUTLOOK]| outlook.map(|number| number as i8);
                walk.outlooks.push(outlooks.into_iter().map(bytes).collect());
            }
        }
    }

    /// What a view's photo shows, as a network that makes no mistakes would draw it.
    fn sketch(&self, view: usize) -> [i8; SKETCH] {
        let size = SIDE * SIDE * 4;
        let rgba = &self.photos[view * size..(view + 1) * size];
        let (mut values, mut sketch) = (vec![0.0; PHOTO], [0.0; SKETCH]);
        Look::plain().photo(rgba, &mut Pcg64::seed_from_u64(0), &mut values, &mut sketch);
        sketch.map(|share| (share * 127.0).round() as i8)
    }
}

/// The most views of a capture in training.
pub const MOST_VIEWS: usize = 26;

/// Whether training, measuring or calibration asks about so many views.
fn is_asked(views: usize) -> bool {
    views <= 12 || (views.is_multiple_of(2) && views <= MOST_VIEWS)
}

impl Object {
    /// The candidates.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// How a view was taken.
    pub fn stance(&self, view: usize) -> &Stance {
        &self.stances[view]
    }

    /// The views of the shortest walk.
    pub fn steps(&self) -> usize {
        self.walks.iter().map(|walk| walk.views.len()).min().unwrap_or(0)
    }

    /// The views of a walk, in order.
    pub fn walk(&self, walk: usize) -> impl Iterator<Item = usize> + '_ {
        self.walks[walk % self.walks.len()].views.iter().map(|&view| view.into())
    }

    /// What the hull of the first views' sketches lets each candidate see, as the network is told it,
    /// (Z, 8); nothing without sketches.
    pub fn outlooks(&self, views: &[usize], sketches: &[[i8; SKETCH]]) -> Vec<f32> {
        if sketches.is_empty() {
            return Vec::new();
        }
        let stances = views.iter().map(|&view| &self.stances[view]);
        let seen = || stances.clone().zip(sketches.iter().map(|sketch| sketch.as_slice()));
        let mut form = Box::<Form>::default();
        form.begin();
        for (stance, sketch) in seen() {
            form.take_in(stance, sketch);
        }
        let candidates: Vec<Direction> = self.stances.iter().map(|s| s.direction).collect();
        let mut outlooks = vec![[0; OUTLOOK]; candidates.len()];
        form.outlooks(seen(), &candidates, &mut outlooks, |_, _| ());
        outlooks.as_flattened().iter().map(|&number| outlook(number as i8)).collect()
    }

    /// A view's photo before neutral grey, as bytes, shape (64, 64, 3).
    pub fn photo(&self, view: usize) -> Vec<u8> {
        let size = SIDE * SIDE * 4;
        let mut values = vec![0.0; PHOTO];
        let rgba = &self.photos[view * size..(view + 1) * size];
        // Nothing of a plain look is left to chance.
        Look::plain().photo(rgba, &mut Pcg64::seed_from_u64(0), &mut values, &mut []);
        let places = 0..SIDE * SIDE;
        let byte = |value: f32| (value * 128.0 + 128.0) as u8;
        places.flat_map(|at| [0, 1, 2].map(|c| byte(values[c * SIDE * SIDE + at]))).collect()
    }
}

/// C, Q, D, T.
fn in_order(scores: &Scores) -> [f32; OBJECTIVES] {
    [scores.coverage, scores.geometry, scores.diversity, scores.texture]
}

/// What the network should have answered.
pub struct Truth {
    /// Gains of the candidates in each state, (P * B, Z, 4).
    pub gains: Vec<f32>,
    /// F_n of each state, (P * B, 4).
    pub scores: Vec<f32>,
}

/// Captures of some objects, in plain numbers: made on any thread.
pub struct Batch {
    photos: Vec<f32>,
    sketches: Vec<f32>,
    views: Vec<f32>,
    relations: Vec<Vec<f32>>,
    candidates: Vec<f32>,
    outlooks: Vec<Vec<f32>>,
    pub counts: Vec<usize>,
    pub objects: usize,
    pub others: usize,
    /// Whether a candidate has been visited in a state, (P * B, Z).
    pub visited: Vec<bool>,
    pub truth: Truth,
}

/// What the network is told of one state, n views and Z candidates.
#[derive(Clone, Debug)]
pub struct State {
    /// (n, 3, 64, 64), or empty.
    pub photos: Vec<f32>,
    /// (n, 16).
    pub views: Vec<f32>,
    /// (n, Z, 16).
    pub relations: Vec<f32>,
    /// (Z, 16).
    pub candidates: Vec<f32>,
    /// (Z, 8), or empty.
    pub outlooks: Vec<f32>,
    /// (4).
    pub count: Vec<f32>,
}

/// Which captures a batch shows.
#[derive(Clone, Debug)]
pub struct Ask {
    /// Views in order of each capture.
    pub views: usize,
    /// The numbers of views asked about, ascending.
    pub counts: Vec<usize>,
    /// Candidates asked about; at most the views of the data set.
    pub candidates: usize,
    /// Whether photos and poses are changed by chance.
    pub augment: bool,
    /// Whether photos are needed at all.
    pub photos: bool,
}

impl Batch {
    /// One capture of each object: the walk of that number, or any.
    pub fn draw(
        objects: &[&Object],
        walk: Option<usize>,
        ask: &Ask,
        chance: &mut impl Rng,
    ) -> Self {
        let number = objects.len();
        let others = ask.candidates.min(objects[0].stances.len());
        let states = ask.counts.len() * number;
        let mut batch = Self {
            photos: vec![0.0; if ask.photos { number * ask.views * PHOTO } else { 0 }],
            sketches: vec![0.0; if ask.photos { number * ask.views * SKETCH } else { 0 }],
            views: Vec::with_capacity(number * ask.views * DIRECTION),
            relations: vec![Vec::with_capacity(number * others * RELATION); ask.views],
            candidates: Vec::with_capacity(number * others * DIRECTION),
            outlooks: vec![Vec::with_capacity(number * others * OUTLOOK); ask.counts.len()],
            counts: ask.counts.clone(),
            objects: number,
            others,
            visited: vec![false; states * others],
            truth: Truth {
                gains: vec![0.0; states * others * OBJECTIVES],
                scores: vec![0.0; states * OBJECTIVES],
            },
        };
        for (place, object) in objects.iter().enumerate() {
            let walks = object.walks.len();
            let drawn = chance.random_range(0..walks);
            let walk = &object.walks[walk.map_or(drawn, |walk| walk % walks)];
            batch.add(place, object, walk, ask, chance);
        }
        batch
    }

    fn add(
        &mut self,
        place: usize,
        object: &Object,
        walk: &Walk,
        ask: &Ask,
        chance: &mut impl Rng,
    ) {
        let (quarters, mirrored) =
            if ask.augment { (chance.random_range(0..4), chance.random()) } else { (0, false) };
        let look = if ask.augment { Look::draw(chance, mirrored) } else { Look::plain() };
        let mut candidates: Vec<usize> = (0..object.stances.len()).collect();
        if self.others < candidates.len() {
            candidates.shuffle(chance);
            candidates.truncate(self.others);
        }
        let turned = |view: usize| object.stances[view].turned(quarters, mirrored);
        let directions: Vec<Direction> =
            candidates.iter().map(|&view| turned(view).direction).collect();
        for direction in &directions {
            self.candidates.extend(direction.features().map(value));
        }
        for (step, &view) in walk.views.iter().take(ask.views).enumerate() {
            let view = usize::from(view);
            let stance = turned(view);
            self.views.extend(stance.direction.features().map(value));
            for &direction in &directions {
                self.relations[step].extend(stance.relation(direction).map(value));
            }
            if ask.photos {
                let size = SIDE * SIDE * 4;
                let rgba = &object.photos[view * size..(view + 1) * size];
                let at = place * ask.views + step;
                let photo = &mut self.photos[at * PHOTO..(at + 1) * PHOTO];
                let sketch = &mut self.sketches[at * SKETCH..(at + 1) * SKETCH];
                look.photo(rgba, chance, photo, sketch);
            }
        }
        // Now and then nothing is known of the hull, as where no outline could be made out.
        let blind = ask.augment && chance.random_bool(0.1);
        for (row, &count) in ask.counts.iter().enumerate() {
            if let Some(outlooks) = walk.outlooks.get(count - 1) {
                let of =
                    |view: &usize| outlooks[*view].map(|n| if blind { 0.0 } else { outlook(n) });
                self.outlooks[row].extend(candidates.iter().flat_map(of));
            }
            let state = row * self.objects + place;
            let at = state * OBJECTIVES;
            self.truth.scores[at..at + OBJECTIVES].copy_from_slice(&walk.scores[count - 1]);
            for (other, &view) in candidates.iter().enumerate() {
                let at = (state * self.others + other) * OBJECTIVES;
                self.truth.gains[at..at + OBJECTIVES].copy_from_slice(&walk.gains[count - 1][view]);
                self.visited[state * self.others + other] =
                    walk.views[..count].contains(&(view as u16));
            }
        }
    }

    /// The question to the network.
    pub fn question(&self, device: &Device) -> Question {
        let (objects, others) = (self.objects, self.others);
        let views = self.relations.len();
        let of = |values: &[f32], shape: [usize; 3]| {
            Tensor::<3>::from_data(TensorData::new(values.to_vec(), shape), device)
        };
        let photos = if self.photos.is_empty() {
            Tensor::zeros([1, 3, 1, 1], device)
        } else {
            let shape = [objects * views, 3, SIDE, SIDE];
            Tensor::from_data(TensorData::new(self.photos.clone(), shape), device)
        };
        let relations = self.relations.iter();
        Question {
            photos,
            views: of(&self.views, [objects, views, DIRECTION]),
            relations: relations.map(|values| of(values, [objects, others, RELATION])).collect(),
            candidates: of(&self.candidates, [objects, others, DIRECTION]),
            outlooks: self
                .outlooks
                .iter()
                .filter(|values| !values.is_empty())
                .map(|values| of(values, [objects, others, OUTLOOK]))
                .collect(),
            counts: self.counts.clone(),
        }
    }

    /// What the network is told of one capture after its first `count` views.
    pub fn state(&self, object: usize, count: usize) -> State {
        let (others, views) = (self.others, self.relations.len());
        let part = |values: &[f32], width: usize, from: usize, length: usize| {
            let at = from * width..(from + length) * width;
            values.get(at).unwrap_or_default().to_vec()
        };
        let relations = self.relations[..count].iter();
        State {
            photos: part(&self.photos, PHOTO, object * views, count),
            views: part(&self.views, DIRECTION, object * views, count),
            relations: relations
                .flat_map(|values| part(values, RELATION, object * others, others))
                .collect(),
            candidates: part(&self.candidates, DIRECTION, object * others, others),
            outlooks: self
                .counts
                .iter()
                .position(|&asked| asked == count)
                .map(|row| part(&self.outlooks[row], OUTLOOK, object * others, others))
                .unwrap_or_default(),
            count: features::count(count).map(value).to_vec(),
        }
    }

    /// Each state's number of views, (P * B).
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        self.counts.iter().flat_map(|&count| std::iter::repeat_n(count, self.objects))
    }
}

/// What training aims at, from the gains of each state.
pub struct Target {
    /// (P * B, Z, 4).
    pub ranks: Tensor<3>,
    /// How much a state's order counts in an objective, 1 in the mean: the root of the gains' spread,
    /// cut off at 3. (P * B, 1, 4).
    pub stakes: Tensor<3>,
    /// (P * B, 12): scores, and the number of views times mean and spread of the gains.
    pub state: Tensor<2>,
    /// What each photo shows, (B * K, 320) = (.., 5, 8, 8); `None` without photos.
    pub sketches: Option<Tensor<2>>,
}

/// A gain's distance from the state's mean below which it counts as equal.
const SMALLEST_SPREAD: f64 = 1e-4;

impl Batch {
    /// Gains brought to mean 0 and spread 1 within each state, and what undoes that; or, where
    /// `cumulative`, F_n+1 as it is.
    pub fn target(&self, cumulative: bool, device: &Device) -> Target {
        let (others, states) = (self.others, self.counts.len() * self.objects);
        let mut ranks = self.truth.gains.clone();
        let mut state = vec![0f32; states * STATE];
        let mut stakes = vec![0f32; states * OBJECTIVES];
        for (index, number) in self.numbers().enumerate() {
            for objective in 0..OBJECTIVES {
                let score = self.truth.scores[index * OBJECTIVES + objective];
                let at = |other: usize| (index * others + other) * OBJECTIVES + objective;
                let gains = || (0..others).map(|other| f64::from(self.truth.gains[at(other)]));
                let mean = gains().sum::<f64>() / others as f64;
                let variance =
                    gains().map(|gain| (gain - mean).powi(2)).sum::<f64>() / others as f64;
                let spread = variance.sqrt();
                for other in 0..others {
                    let gain = f64::from(self.truth.gains[at(other)]);
                    ranks[at(other)] = if cumulative {
                        score + gain as f32
                    } else {
                        ((gain - mean) / (spread + SMALLEST_SPREAD)) as f32
                    };
                }
                let row = &mut state[index * STATE..(index + 1) * STATE];
                row[objective] = score;
                row[OBJECTIVES + objective] = (mean * number as f64) as f32;
                row[2 * OBJECTIVES + objective] = (spread * number as f64) as f32;
                stakes[index * OBJECTIVES + objective] =
                    if cumulative { 1.0 } else { spread.sqrt() as f32 };
            }
        }
        for objective in 0..OBJECTIVES {
            let of = stakes.iter().skip(objective).step_by(OBJECTIVES);
            let mean = of.sum::<f32>() / states as f32;
            for stake in stakes.iter_mut().skip(objective).step_by(OBJECTIVES) {
                *stake = (*stake / mean.max(1e-6)).min(3.0);
            }
        }
        let shape = [states, others, OBJECTIVES];
        Target {
            stakes: Tensor::from_data(TensorData::new(stakes, [states, 1, OBJECTIVES]), device),
            ranks: Tensor::from_data(TensorData::new(ranks, shape), device),
            state: Tensor::from_data(TensorData::new(state, [states, STATE]), device),
            sketches: (!self.sketches.is_empty()).then(|| {
                let shape = [self.sketches.len() / SKETCH, SKETCH];
                let sketches = self.sketches.chunks_exact(SKETCH);
                let cells: Vec<f32> = sketches
                    .flat_map(|sketch| places_by_cell().map(|place| sketch[place]))
                    .collect();
                Tensor::from_data(TensorData::new(cells, shape), device)
            }),
        }
    }
}

/// For each number of the network's map of cells, (5, 8, 8) in row-major order, its place in a sketch.
fn places_by_cell() -> impl Iterator<Item = usize> {
    (0..CELL)
        .flat_map(|number| (0..DETAIL * DETAIL).map(move |cell| places_in_sketch(cell)[number]))
}

/// A sketch as `core` has it, from a map of cells (5, 8, 8).
pub fn sketch_of(cells: &[f32]) -> [i8; SKETCH] {
    let mut sketch = [0; SKETCH];
    for (place, &share) in places_by_cell().zip(cells) {
        sketch[place] = (share * 127.0).round().clamp(-128.0, 127.0) as i8;
    }
    sketch
}

/// What an outlook's number stands for: spreads from the mean.
pub fn outlook(number: i8) -> f32 {
    f32::from(number) * (4.0 / 127.0)
}

/// The features of a number of views, shape (4).
pub fn count(views: usize, device: &Device) -> Tensor<1> {
    Tensor::from_data(TensorData::new(features::count(views).map(value).to_vec(), [COUNT]), device)
}

/// A feature's value.
fn value(feature: i8) -> f32 {
    f32::from(feature) / 127.0
}
