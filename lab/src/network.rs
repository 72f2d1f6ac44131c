//! SOARNet on the host: its file, its memory, and whole plans and predictions by it.

use std::borrow::Cow;
use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use image::{RgbImage, RgbaImage};
use rayon::prelude::*;
use vantage_core::objectives::{FaceAccount, Ledger};
use vantage_core::planner::{NextView, Plan, Scorer, Session};
use vantage_core::soarnet::{
    Form, Image, Lists, ListsMut, Memory, Model, OUTLOOK, Photo, Pixels, SIDE, SKETCH, Scratch,
    SoarNet, Standpoint, features,
};
use vantage_core::{Camera, Objective, Pose, Vec3};

use crate::exact::{Labelled, Step};
use crate::heap::Heap;
use crate::mesh::Mesh;
use crate::metrics::Four;
use crate::pool::FOV_X_RAD;
use crate::render::{PhotoOptions, Renderer};

/// The network that comes with the program: see `lab/MODEL_CARD.md`.
const SHIPPED: &[u8] = include_bytes!("../models/soarnet.model");

/// The one that looks at poses alone.
const SHIPPED_POSES: &[u8] = include_bytes!("../models/soarnet-poses.model");

/// The views that a network remembers: the sums of more tokens might not fit.
pub const MOST_VIEWS: usize = 256;

/// Behind rendered objects, sRGB: what a network takes for nothing at all.
const BACKGROUND: [u8; 3] = [128; 3];

/// A network's file, checked.
#[derive(Clone, Debug)]
pub struct Network {
    bytes: Cow<'static, [u8]>,
}

/// A scorer over candidates with all its memory.
pub type NetworkScorer<'m> = SoarNet<'m, HeapMemory>;

impl Network {
    /// The network that comes with the program.
    pub fn shipped() -> Self {
        Self { bytes: Cow::Borrowed(SHIPPED) }
    }

    /// The network that comes with the program and looks at poses alone.
    pub fn shipped_poses() -> Self {
        Self { bytes: Cow::Borrowed(SHIPPED_POSES) }
    }

    /// The network of a file.
    pub fn open(file: &Path) -> Result<Self> {
        let bytes =
            fs::read(file).with_context(|| format!("cannot read the model {}", file.display()))?;
        Model::parse(&bytes)
            .with_context(|| format!("the model {} cannot be used", file.display()))?;
        Ok(Self { bytes: Cow::Owned(bytes) })
    }

    fn model(&self) -> Result<Model<'_>> {
        Model::parse(&self.bytes).context("the model cannot be used")
    }

    /// The checksum of its file.
    pub fn checksum(&self) -> Result<u32> {
        Ok(self.model()?.checksum())
    }

    /// Whether it looks at photos, not at poses alone.
    pub fn sees(&self) -> Result<bool> {
        Ok(self.model()?.dimensions().embedding > 0)
    }

    /// A scorer over candidates around the origin, with room for so many views.
    pub fn scorer(&self, candidates: &[Pose], views: usize) -> Result<NetworkScorer<'_>> {
        let model = self.model()?;
        let memory = HeapMemory::new(&model, candidates.len(), views);
        Ok(SoarNet::try_new(model, memory, Vec3::ZERO, candidates.iter().copied())?)
    }

    /// Carries a plan out by predicted gains, every photo being taken where it was asked for. The
    /// scores of the steps are exact; `photo` is what a candidate's camera takes.
    ///
    /// `done` is called after each view.
    pub fn run(
        &self,
        labelled: &Labelled,
        photo: impl Fn(usize) -> RgbImage,
        plan: Plan,
        mut done: impl FnMut(),
    ) -> Result<Vec<Step>> {
        let sightings = labelled.sightings();
        let mut accounts = vec![FaceAccount::default(); labelled.faces().len()];
        let mut ledger = Ledger::try_new(labelled.surface()?, labelled.reading, &mut accounts)?;
        let mut steps = Vec::with_capacity(plan.budget());
        self.choose(&labelled.poses, photo, plan, |next, seconds| {
            ledger.add(next.pose.position(), &sightings[next.index]);
            steps.push(Step { next, scores: ledger.scores(), seconds });
            done();
        })?;
        Ok(steps)
    }

    /// The same without a mesh, and without scores. `taken` is called after each
    /// view with the seconds from the start of planning until then.
    pub fn choose(
        &self,
        poses: &[Pose],
        photo: impl Fn(usize) -> RgbImage,
        plan: Plan,
        mut taken: impl FnMut(NextView, f64),
    ) -> Result<()> {
        let scorer = self.scorer(poses, plan.budget())?;
        let start = Instant::now();
        let mut session = Session::try_new(Heap::default(), poses.iter().copied(), scorer, plan)?;
        while let Some(next) = session.next_view() {
            session.observe(next.index, next.pose, &shot(&photo(next.index))?)?;
            taken(next, start.elapsed().as_secs_f64());
        }
        Ok(())
    }

    /// The predicted gains of every candidate along a path of views: shapes as of
    /// [`Labelled::gains_along`].
    pub fn gains_along(
        &self,
        poses: &[Pose],
        photo: impl Fn(usize) -> RgbImage,
        path: &[usize],
        from: usize,
    ) -> Result<Vec<Four<Vec<f32>>>> {
        let mut scorer = self.scorer(poses, path.len())?;
        let mut gains = Vec::new();
        for (taken, &view) in path.iter().enumerate() {
            if taken >= from {
                gains.push(Objective::ALL.map(|objective| {
                    let gain = |(index, pose)| scorer.gain(objective, index, pose);
                    poses.iter().enumerate().map(gain).collect()
                }));
            }
            scorer.observe(&poses[view], &shot(&photo(view))?)?;
        }
        Ok(gains)
    }
}

/// A photo as the network takes it: its largest square in the middle.
pub fn shot(photo: &RgbImage) -> Result<Photo<'_>> {
    let image = Image::try_new(photo.width(), photo.height(), Pixels::Rgb888, photo.as_raw())?;
    Ok(Photo::new(image))
}

/// What a network sees of a mesh from each pose: 64 x 64 pixels, the object on grey.
pub fn photos(mesh: &Mesh, poses: &[Pose]) -> Result<Vec<RgbImage>> {
    let renderer = Renderer::new(mesh);
    let camera = Camera::from_fov(SIDE as u32, SIDE as u32, FOV_X_RAD)?;
    let options = PhotoOptions { background: Some(BACKGROUND), ..PhotoOptions::default() };
    let photo = |pose: &Pose| without_alpha(&renderer.photo(&camera, pose, &options));
    Ok(poses.par_iter().map(photo).collect())
}

fn without_alpha(photo: &RgbaImage) -> RgbImage {
    RgbImage::from_fn(photo.width(), photo.height(), |x, y| {
        let [r, g, b, _] = photo.get_pixel(x, y).0;
        image::Rgb([r, g, b])
    })
}

/// The memory of a scorer, as long as is needed.
#[derive(Clone, Debug)]
pub struct HeapMemory {
    directions: Vec<features::Direction>,
    sums: Vec<i16>,
    maxima: Vec<i8>,
    outlooks: Vec<[i32; OUTLOOK]>,
    ranks: Vec<[i32; 4]>,
    standpoints: Vec<Standpoint>,
    embeddings: Vec<i8>,
    sketches: Vec<[i8; SKETCH]>,
    stances: Vec<features::Stance>,
    taken: Vec<Standpoint>,
    form: Box<Form>,
    scratch: Box<Scratch>,
}

impl HeapMemory {
    fn new(model: &Model<'_>, candidates: usize, views: usize) -> Self {
        let sizes = model.dimensions();
        Self {
            directions: vec![features::Direction::default(); candidates],
            sums: vec![0; candidates * sizes.width],
            maxima: vec![0; candidates * sizes.width],
            outlooks: vec![[0; OUTLOOK]; candidates],
            ranks: vec![[0; 4]; candidates],
            standpoints: vec![Standpoint::NONE; candidates],
            embeddings: vec![0; views * sizes.embedding],
            sketches: vec![[0; SKETCH]; if sizes.embedding > 0 { views } else { 0 }],
            stances: vec![features::Stance::default(); views],
            taken: vec![Standpoint::NONE; views],
            form: Box::default(),
            scratch: Box::default(),
        }
    }
}

impl Memory for HeapMemory {
    fn lists(&self) -> Lists<'_> {
        Lists {
            sums: &self.sums,
            maxima: &self.maxima,
            outlooks: &self.outlooks,
            ranks: &self.ranks,
            standpoints: &self.standpoints,
            embeddings: &self.embeddings,
            sketches: &self.sketches,
            stances: &self.stances,
            taken: &self.taken,
        }
    }

    fn lists_mut(&mut self) -> ListsMut<'_> {
        ListsMut {
            directions: &mut self.directions,
            sums: &mut self.sums,
            maxima: &mut self.maxima,
            outlooks: &mut self.outlooks,
            ranks: &mut self.ranks,
            standpoints: &mut self.standpoints,
            embeddings: &mut self.embeddings,
            sketches: &mut self.sketches,
            stances: &mut self.stances,
            taken: &mut self.taken,
            form: &mut self.form,
            scratch: &mut self.scratch,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::mesh;
    use crate::pool::DISTANCE;
    use vantage_core::candidates::{Pool, ViewSpace};
    use vantage_core::objectives::Reading;
    use vantage_core::soarnet::{self, Dimensions, Layer};

    /// A network without images whose weights say something, if nothing sensible.
    pub fn file() -> Vec<u8> {
        let sizes = Dimensions { width: 8, head: 8, context: 4, ..Dimensions::default() };
        let weights: Vec<i8> = (0..512i32).map(|i| (i * 37 % 255 - 127) as i8).collect();
        let layer = |rows: usize, columns: usize| Layer {
            weights: &weights[..rows * columns],
            bias: &[90; 12][..rows],
            multipliers: &[1 << 24; 12][..rows],
            zero: 0,
        };
        let network = soarnet::Network {
            dimensions: sizes.without_images(),
            encoder: None,
            token: [layer(8, 32), layer(8, 8)],
            candidate: [layer(8, 36), layer(4, 8)],
            state: [layer(4, 20), layer(12, 4)],
        };
        let mut file = vec![0; 4096];
        let length = network.write(&mut file).unwrap();
        file.truncate(length);
        file
    }

    pub fn network() -> Network {
        Network { bytes: Cow::Owned(file()) }
    }

    #[test]
    fn a_plan_takes_the_highest_prediction_and_tells_exact_scores() {
        let mut vase = mesh::class("vase", 1).unwrap();
        mesh::normalise(&mut vase);
        let space = ViewSpace::RandomSphere { seed: 3 };
        let poses: Vec<Pose> = Pool::try_new(space, 30, DISTANCE).unwrap().iter().collect();
        let camera = Camera::from_fov(48, 48, FOV_X_RAD).unwrap();
        let labelled = Labelled::new(&vase, &camera, poses, Reading::default(), || {});
        let photos = photos(&vase, &labelled.poses).unwrap();
        let photo = |index: usize| photos[index].clone();
        let network = network();
        assert!(!network.sees().unwrap());
        let plan = Plan::single(Objective::Diversity, 6);
        let steps = network.run(&labelled, photo, plan, || {}).unwrap();
        let path: Vec<usize> = steps.iter().map(|step| step.next.index).collect();
        let gains = network.gains_along(&labelled.poses, photo, &path, 3).unwrap();
        assert_eq!(gains.len(), 3);
        for (state, gains) in gains.iter().enumerate() {
            let [_, _, diversity, _] = gains;
            let open = (0..30).filter(|index| !path[..3 + state].contains(index));
            let highest = open.max_by(|&a, &b| {
                diversity[a].total_cmp(&diversity[b]).then(b.cmp(&a)) // ties to the lowest index
            });
            assert_eq!(highest, Some(path[3 + state]));
            assert_eq!(diversity[path[3 + state]], steps[3 + state].next.gain);
        }
        // The same views, exactly scored.
        let exact = labelled.gains_along(&path, 0).unwrap();
        let coverage: f32 = path.iter().zip(&exact).map(|(&view, gains)| gains[0][view]).sum();
        assert!((coverage - steps[5].scores.coverage).abs() < 1e-5);
    }

    #[test]
    fn the_shipped_networks_are_models() {
        assert!(Network::shipped().sees().unwrap());
        assert!(!Network::shipped_poses().sees().unwrap());
    }

    #[test]
    fn a_file_that_is_no_model_is_refused_by_name() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("soarnet.model");
        let says = |path: &Path| format!("{:#}", Network::open(path).unwrap_err());
        assert!(says(&path).contains("cannot read the model"), "{}", says(&path));
        for length in [0, 10, file().len() - 1] {
            fs::write(&path, &file()[..length]).unwrap();
            assert!(says(&path).contains("cannot be used"), "{}", says(&path));
        }
        fs::write(&path, file()).unwrap();
        Network::open(&path).unwrap();
    }
}
