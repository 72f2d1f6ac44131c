//! The scorer that predicts from photos, and what it refuses.

use core::fmt;

use glam::Vec3;

use super::features::{Direction, Stance};
use super::heads::Context;
use super::image::{COVER, Image, ImageError, SKETCH, Window};
use super::memory::{ListsMut, Memory};
use super::model::{Model, RANKS, STATE};
use super::outlook::{Eye, OUTLOOK};
use super::support::Standpoint;
use crate::objectives::{Objective, Scores};
#[cfg(feature = "serde")]
use crate::planner::Persist;
use crate::planner::Scorer;
use crate::pose::Pose;
#[cfg(feature = "serde")]
use crate::record::{Sink, SnapshotError, Source};

/// The most views: the sum of 256 tokens is an i16, of 257 it may not be.
const MOST_VIEWS: usize = 256;

/// A photo as the network takes it: a picture and the square of it to look at.
///
/// A network without images needs neither: [`Photo::default`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Photo<'a> {
    /// The picture.
    pub image: Option<Image<'a>>,
    /// The square that shows the object; `None` for the largest in the picture's middle.
    pub window: Option<Window>,
}

impl<'a> Photo<'a> {
    /// A picture whose object lies in the middle.
    pub fn new(image: Image<'a>) -> Self {
        Self { image: Some(image), window: None }
    }

    /// The same with another square.
    pub fn with_window(self, window: Window) -> Self {
        Self { window: Some(window), ..self }
    }
}

/// Why a network cannot score these candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetupError {
    /// There are more candidates than the memory holds for this model.
    TooManyCandidates {
        /// How many it holds.
        capacity: usize,
    },
    /// A candidate stands on the centre.
    NoDirection {
        /// Its index.
        index: usize,
    },
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyCandidates { capacity } => {
                write!(f, "the network's memory has room for {capacity} candidates of this model")
            }
            Self::NoDirection { index } => {
                write!(f, "candidate {index} stands on the object's centre: check the centre")
            }
        }
    }
}

impl core::error::Error for SetupError {}

/// Why a photo was not taken in. Nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhotoError {
    /// The network looks at pictures and the photo has none.
    NoImage,
    /// The picture's largest square cannot be used.
    Image(ImageError),
    /// The camera stands on the object's centre.
    NoDirection,
    /// The memory holds no more views.
    TooManyViews {
        /// How many it holds for this model.
        capacity: usize,
    },
}

impl fmt::Display for PhotoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoImage => f.write_str("the network looks at pictures: give the photo one"),
            Self::Image(error) => error.fmt(f),
            Self::NoDirection => {
                f.write_str("the camera stands on the object's centre: check pose and centre")
            }
            Self::TooManyViews { capacity } => {
                write!(f, "the network's memory has room for {capacity} views of this model")
            }
        }
    }
}

impl core::error::Error for PhotoError {}

/// [`SoarNet::clutter`] from which outlines are not to be relied on: 0 on rendered objects before plain
/// backgrounds, 0.2 in a capture of a toy before wallpaper.
pub const CLUTTERED: f32 = 0.1;

/// Scores views by what a [`Model`] predicts from the photos so far and where they were taken.
///
/// A photo is encoded once, when it is taken in; then the visual hull takes in its outline, every
/// candidate's pooled state one token, and all outlooks are computed anew. [`gain`](Scorer::gain) only
/// looks up, and knows candidates by their index: the pose it is given is not looked at. Before the
/// first photo all gains and scores are 0.
#[derive(Debug)]
pub struct SoarNet<'m, M> {
    model: Model<'m>,
    memory: M,
    centre: Vec3, // of the object, in the world, metres
    candidates: usize,
    views: usize,
    state: [i32; STATE], // units of 2^-16
}

impl<'m, M: Memory> SoarNet<'m, M> {
    /// A scorer over candidates, in the session's order, around an object's `centre` (world, metres).
    pub fn try_new(
        model: Model<'m>,
        memory: M,
        centre: Vec3,
        candidates: impl IntoIterator<Item = Pose>,
    ) -> Result<Self, SetupError> {
        let mut scorer = Self { model, memory, centre, candidates: 0, views: 0, state: [0; STATE] };
        for pose in candidates {
            scorer.add(&pose)?;
        }
        scorer.begin();
        Ok(scorer)
    }

    /// Adds a candidate.
    fn add(&mut self, pose: &Pose) -> Result<(), SetupError> {
        let index = self.candidates;
        let direction = Direction::try_from_vector(pose.position() - self.centre)
            .ok_or(SetupError::NoDirection { index })?;
        let width = self.model.dimensions().width.max(1);
        let ListsMut { directions, sums, maxima, outlooks, ranks, standpoints, .. } =
            self.memory.lists_mut();
        let capacity = directions.len().min(ranks.len()).min(outlooks.len());
        let capacity = capacity.min(standpoints.len());
        let capacity = capacity.min(sums.len() / width).min(maxima.len() / width);
        match directions.get_mut(index) {
            Some(place) if index < capacity => *place = direction,
            _ => return Err(SetupError::TooManyCandidates { capacity }),
        }
        self.candidates += 1;
        Ok(())
    }

    /// All candidates are known.
    fn begin(&mut self) {
        let ListsMut { directions, standpoints, .. } = self.memory.lists_mut();
        for (standpoint, &direction) in standpoints.iter_mut().zip(&*directions) {
            *standpoint = Standpoint::new(direction);
        }
        self.forget();
    }

    /// As before the first photo.
    fn forget(&mut self) {
        let ListsMut { sums, maxima, outlooks, ranks, standpoints, form, .. } =
            self.memory.lists_mut();
        sums.fill(0);
        maxima.fill(i8::MIN);
        outlooks.fill([0; OUTLOOK]);
        ranks.fill([0; RANKS]);
        for standpoint in standpoints {
            standpoint.gain = 0.0;
        }
        form.begin();
        self.views = 0;
        self.state = [0; STATE];
    }

    /// How many views there is room for.
    pub fn view_capacity(&self) -> usize {
        let lists = self.memory.lists();
        let most = match lists.embeddings.len().checked_div(self.model.dimensions().embedding) {
            Some(embeddings) => embeddings.min(lists.sketches.len()),
            None => MOST_VIEWS,
        };
        lists.stances.len().min(lists.taken.len()).min(most).min(MOST_VIEWS)
    }

    /// The network.
    pub fn model(&self) -> &Model<'m> {
        &self.model
    }

    /// The embedding of a view, shape (E); `None` where there is no such view.
    pub fn embedding(&self, view: usize) -> Option<&[i8]> {
        row(self.memory.lists().embeddings, view, self.model.dimensions().embedding)
            .filter(|_| view < self.views)
    }

    /// The sketch of a view, shape (320); `None` where there is none.
    pub fn sketch(&self, view: usize) -> Option<&[i8; SKETCH]> {
        let sees = self.model.dimensions().embedding > 0;
        self.memory.lists().sketches.get(view).filter(|_| sees && view < self.views)
    }

    /// How much of what lies beside the object is taken for it, in [0, 1]: the mean over all photos of the
    /// share of cells that the ball around the object cannot reach and that its outline covers. 0 before a
    /// plain background, before the first photo, and for a network without images.
    ///
    /// Above [`CLUTTERED`] outlines tell little: the hull is too large, and views are spread as over a ball.
    pub fn clutter(&self) -> f32 {
        // From the middle, in half cells.
        let from_middle = |place: usize| (2 * place + 1).abs_diff(COVER).pow(2);
        let is_beyond = |cell: usize| {
            let reach = 11 * COVER * COVER * 11 / 100; // a tenth beyond the ball's disc
            from_middle(cell % COVER) + from_middle(cell / COVER) > reach
        };
        let (mut beside, mut covered) = (0u32, 0u32);
        for sketch in (0..self.views).filter_map(|view| self.sketch(view)) {
            for (cell, &cover) in sketch.iter().enumerate().take(COVER * COVER) {
                beside += u32::from(is_beyond(cell));
                covered += u32::from(is_beyond(cell) && cover > 63);
            }
        }
        if beside > 0 { covered as f32 / beside as f32 } else { 0.0 }
    }

    /// A candidate's outlook as the network is told it, shape (8); `None` where there is none.
    pub fn outlook(&self, candidate: usize) -> Option<[i32; OUTLOOK]> {
        let outlooks = self.memory.lists().outlooks;
        outlooks.get(candidate).copied().filter(|_| candidate < self.candidates)
    }

    /// A candidate's sums and maxima of tokens, both shape (H); `None` where there is none.
    pub fn pooled(&self, candidate: usize) -> Option<(&[i16], &[i8])> {
        let (lists, width) = (self.memory.lists(), self.model.dimensions().width);
        let sums = row(lists.sums, candidate, width)?;
        let maxima = row(lists.maxima, candidate, width)?;
        (candidate < self.candidates).then_some((sums, maxima))
    }

    /// A candidate's rank scores of C, Q, D, T, units of 2^-16; `None` where there is none.
    pub fn ranks(&self, candidate: usize) -> Option<[i32; RANKS]> {
        self.memory.lists().ranks.get(candidate).copied().filter(|_| candidate < self.candidates)
    }

    /// Scores (4), mean gains (4) and spreads of gains (4), each of C, Q, D, T; units of 2^-16.
    ///
    /// Gains are times the number of views.
    pub fn state(&self) -> &[i32; STATE] {
        &self.state
    }

    /// Lets the hull and every candidate know of the last view in memory.
    fn take_in_last(&mut self) {
        let model = &self.model;
        let (width, size) = (model.dimensions().width.max(1), model.dimensions().embedding);
        let ListsMut {
            directions, sums, maxima, embeddings, sketches, stances, taken, form, ..
        } = self.memory.lists_mut();
        let Some(last) = self.views.checked_sub(1) else { return };
        let (Some(stance), Some(taken)) = (stances.get(last), taken.get_mut(last)) else { return };
        let directions = directions.get(..self.candidates).unwrap_or_default();
        *taken = Standpoint::new(stance.direction);
        let embedding = row(embeddings, last, size).unwrap_or_default();
        if let (Some(sketch), 1..) = (sketches.get(last), size) {
            form.take_in(stance, sketch);
        }
        let view = model.view_sums(embedding, stance);
        for (candidate, &direction) in directions.iter().enumerate() {
            let (sums, maxima) =
                (row_mut(sums, candidate, width), row_mut(maxima, candidate, width));
            if let (Some(sums), Some(maxima)) = (sums, maxima) {
                model.pool(&view, stance, direction, sums, maxima);
            }
        }
    }

    /// Scores all candidates from what they know.
    fn score(&mut self) {
        if self.views == 0 {
            return;
        }
        let model = &self.model;
        let width = model.dimensions().width.max(1);
        let ListsMut {
            directions,
            sums,
            maxima,
            outlooks,
            ranks,
            standpoints,
            sketches,
            stances,
            taken,
            form,
            ..
        } = self.memory.lists_mut();
        let directions = directions.get(..self.candidates).unwrap_or_default();
        let outlooks = outlooks.get_mut(..self.candidates).unwrap_or_default();
        let standpoints = standpoints.get_mut(..self.candidates).unwrap_or_default();
        let taken = taken.get_mut(..self.views).unwrap_or_default();
        if model.encoder.is_some() {
            let views = stances.iter().zip(sketches.iter().map(<[i8; SKETCH]>::as_slice));
            form.outlooks(views.take(self.views), directions, outlooks, |eye, seen| {
                let standpoint = match eye {
                    Eye::View(view) => taken.get_mut(view),
                    Eye::Candidate(candidate) => standpoints.get_mut(candidate),
                };
                if let Some(standpoint) = standpoint {
                    standpoint.seen = *seen;
                }
            });
            form.support(taken, directions, standpoints);
        }
        let candidates = directions.iter().zip(outlooks).zip(ranks).enumerate();
        let mut context = Context::default();
        for (candidate, ((&direction, outlook), ranks)) in candidates {
            let sums = row(sums, candidate, width).unwrap_or_default();
            let maxima = row(maxima, candidate, width).unwrap_or_default();
            *ranks =
                model.candidate_head(self.views, direction, sums, maxima, outlook, &mut context);
        }
        self.state = model.state_head(self.views, &context);
    }

    fn spread_and_mean(&self, objective: Objective) -> (i32, i32) {
        let at = |part: usize| self.state.get(4 * part + objective as usize).copied();
        (at(2).unwrap_or_default().max(1), at(1).unwrap_or_default())
    }
}

/// A row of a matrix with `width` columns.
fn row<T>(matrix: &[T], index: usize, width: usize) -> Option<&[T]> {
    let from = index.checked_mul(width)?;
    matrix.get(from..from.checked_add(width)?)
}

/// The same to be written.
fn row_mut<T>(matrix: &mut [T], index: usize, width: usize) -> Option<&mut [T]> {
    let from = index.checked_mul(width)?;
    matrix.get_mut(from..from.checked_add(width)?)
}

impl<M: Memory> Scorer for SoarNet<'_, M> {
    type Shot<'s> = Photo<'s>;
    type Error = PhotoError;

    fn observe(&mut self, pose: &Pose, photo: &Photo<'_>) -> Result<(), PhotoError> {
        let capacity = self.view_capacity();
        if self.views >= capacity {
            return Err(PhotoError::TooManyViews { capacity });
        }
        let stance = Stance::try_new(pose, self.centre).ok_or(PhotoError::NoDirection)?;
        let size = self.model.dimensions().embedding;
        let ListsMut { embeddings, sketches, stances, scratch, .. } = self.memory.lists_mut();
        if size > 0 {
            let image = photo.image.ok_or(PhotoError::NoImage)?;
            let window = match photo.window {
                Some(window) => window,
                None => image.middle().map_err(PhotoError::Image)?,
            };
            let seen = self.model.encode(&image, &window, scratch);
            let embedding = embeddings.chunks_exact_mut(size).skip(self.views).take(1).flatten();
            let sketch = sketches.get_mut(self.views).into_iter().flatten();
            let values = seen.embedding.iter().chain(seen.sketch);
            for (place, value) in embedding.chain(sketch).zip(values) {
                *place = *value;
            }
        }
        if let Some(place) = stances.get_mut(self.views) {
            *place = stance;
        }
        self.views += 1;
        self.take_in_last();
        self.score();
        Ok(())
    }

    /// `(mean + max(spread, 2^-16) · rank) / views`, in integers up to the division, so that the order
    /// of candidates is the order of their ranks.
    fn gain(&self, objective: Objective, index: usize, _pose: &Pose) -> f32 {
        let Some(ranks) = self.ranks(index).filter(|_| self.views > 0) else { return 0.0 };
        let rank = ranks.get(objective as usize).copied().unwrap_or_default();
        let (spread, mean) = self.spread_and_mean(objective);
        // At most 2^62 + 2^47; one rounding here, one in the division, and both keep the order.
        let fixed = (i64::from(mean) << 16) + i64::from(spread) * i64::from(rank);
        fixed as f32 / (self.views as f32 * (1u64 << 32) as f32)
    }

    /// What a photo of this candidate would add to `F` of `support.rs`, about 2.5 in all. 0 for a
    /// network without images.
    fn support(&self, index: usize, _pose: &Pose) -> f32 {
        let standpoint = self.memory.lists().standpoints.get(index);
        standpoint.filter(|_| index < self.candidates).map_or(0.0, |standpoint| standpoint.gain)
    }

    /// Cut off to [0, 1].
    fn scores(&self) -> Scores {
        let [coverage, geometry, diversity, texture, ..] =
            self.state.map(|score| (score as f32 / 65_536.0).clamp(0.0, 1.0));
        Scores { coverage, geometry, diversity, texture }
    }
}

#[cfg(feature = "serde")]
impl<M: Memory> Persist for SoarNet<'_, M> {
    fn fingerprint(&self) -> u32 {
        self.model.checksum()
    }

    /// The number of views, then the stance, the embedding and the sketch of each: all else follows.
    fn save(&self, sink: &mut Sink<'_>) -> Result<(), SnapshotError> {
        let stances = self.memory.lists().stances;
        sink.put(&self.views)?;
        for (view, stance) in stances.iter().enumerate().take(self.views) {
            sink.put(stance)?;
            let sketch = self.sketch(view).into_iter().flatten();
            for value in self.embedding(view).unwrap_or_default().iter().chain(sketch) {
                sink.put(value)?;
            }
        }
        Ok(())
    }

    fn load(&mut self, source: &mut Source<'_>) -> Result<(), SnapshotError> {
        self.forget();
        let views: usize = source.take()?;
        if views > self.view_capacity() {
            return Err(SnapshotError::TooLarge);
        }
        let size = self.model.dimensions().embedding;
        for view in 0..views {
            let ListsMut { embeddings, sketches, stances, .. } = self.memory.lists_mut();
            let stance: Stance = source.take()?;
            if let Some(place) = stances.get_mut(view) {
                *place = stance;
            }
            let embedding = embeddings.iter_mut().skip(view * size).take(size);
            let sketch = sketches.get_mut(view).filter(|_| size > 0).into_iter().flatten();
            for place in embedding.chain(sketch) {
                *place = source.take()?;
            }
            self.views = view + 1;
            self.take_in_last();
        }
        self.score();
        Ok(())
    }
}
