//! Scenes that the integration tests share.
#![allow(dead_code, reason = "each test file is a crate of its own and uses its own part")]
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

pub mod reference;

use proptest::test_runner::{Config, RngSeed};
use rand_core::Rng;
use rand_pcg::Pcg32;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::{Face, FaceAccount, FaceSet, Ledger, Reading, Sighting, Surface};
use vantage_core::planner::{Fixed, Scorer, Session};
use vantage_core::{Exact, Pose, Vec3};

/// Memory for every session of these tests.
pub type Room = Fixed<64, 64>;

/// The same cases in every run, and nothing written to disk.
pub fn cases(cases: u32) -> Config {
    Config {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(0x5eed),
        ..Config::default()
    }
}

/// What one photo shows, with the memory that a [`Sighting`] borrows.
#[derive(Clone, Debug)]
pub struct Photo {
    pub camera: Vec3,
    pub words: Vec<u32>,
    pub textured: Vec<u32>,
    pub textured_background: u32,
    pub pixels: u32,
}

impl Photo {
    pub fn sighting(&self) -> Sighting<'_> {
        Sighting {
            faces: FaceSet::new(&self.words),
            textured: &self.textured,
            textured_background: self.textured_background,
            pixels: self.pixels,
        }
    }

    /// Whether it shows a face, asked without [`FaceSet`].
    pub fn shows(&self, face: usize) -> bool {
        self.words[face / 32] & (1 << (face % 32)) != 0
    }

    /// The faces it shows.
    pub fn faces(&self) -> Vec<usize> {
        (0..self.words.len() * 32).filter(|&face| self.shows(face)).collect()
    }
}

/// An object and a photo from every candidate.
#[derive(Clone, Debug)]
pub struct Scene {
    pub faces: Vec<Face>,
    pub texture_total: f32,
    pub photos: Vec<Photo>,
}

impl Scene {
    /// A bumpy ball around the origin, seen from `views` random directions.
    ///
    /// A face is seen where it faces the camera, less one in eight that something hides.
    pub fn ball(faces: usize, views: usize, seed: u64) -> Self {
        let mut chance = Chance::new(seed);
        let normals = Pool::try_new(ViewSpace::FibonacciSphere, faces, 1.0).unwrap();
        let mut faces: Vec<Face> = normals
            .iter()
            .map(|pose| {
                let tilt = Vec3::new(chance.share(), chance.share(), chance.share()) - 0.5;
                Face {
                    centroid: pose.position() * (0.4 + 0.2 * chance.share()),
                    normal: (pose.position() + 0.5 * tilt).normalize(),
                    area_share: 0.2 + chance.share(),
                    complexity: chance.share() * chance.share(),
                }
            })
            .collect();
        let area: f32 = faces.iter().map(|face| face.area_share).sum();
        faces.iter_mut().for_each(|face| face.area_share /= area);
        let texture: Vec<f32> = faces.iter().map(|_| 40.0 * chance.share()).collect();

        let pool = Pool::try_new(ViewSpace::RandomSphere { seed }, views, 2.0).unwrap();
        let photo = |pose: Pose| {
            let camera = pose.position();
            let mut words = vec![0; FaceSet::words_for(faces.len())];
            let (mut textured, mut pixels) = (Vec::new(), 0);
            for (index, face) in faces.iter().enumerate() {
                let cosine = face.normal.dot((camera - face.centroid).normalize());
                if cosine > 0.05 && chance.below(8) > 0 {
                    words[index / 32] |= 1 << (index % 32);
                    textured.push((texture[index] * cosine) as u32);
                    pixels += 1 + (40.0 * cosine) as u32;
                }
            }
            Photo { camera, words, textured, textured_background: 0, pixels }
        };
        let photos: Vec<Photo> = pool.iter().map(photo).collect();
        let texture_total = texture_total(faces.len(), &photos, 0.25);
        Self { faces, texture_total, photos }
    }

    /// A pose at each photo's camera that looks at the origin.
    pub fn poses(&self) -> Vec<Pose> {
        self.photos.iter().map(|p| Pose::looking_at(p.camera, Vec3::ZERO).unwrap()).collect()
    }

    pub fn sightings(&self) -> Vec<Sighting<'_>> {
        self.photos.iter().map(Photo::sighting).collect()
    }

    pub fn accounts(&self) -> Vec<FaceAccount> {
        vec![FaceAccount::default(); self.faces.len()]
    }

    pub fn ledger<'a>(&'a self, reading: Reading, accounts: &'a mut [FaceAccount]) -> Ledger<'a> {
        let surface = Surface::try_new(&self.faces, self.texture_total).unwrap();
        Ledger::try_new(surface, reading, accounts).unwrap()
    }

    pub fn exact<'a>(
        &'a self,
        reading: Reading,
        sightings: &'a [Sighting<'a>],
        accounts: &'a mut [FaceAccount],
    ) -> Exact<'a> {
        Exact::new(self.ledger(reading, accounts), sightings)
    }
}

/// What T's sum tends to: see [`Surface::try_new`].
pub fn texture_total(faces: usize, photos: &[Photo], discount: f32) -> f32 {
    let mut total = 0.0f64;
    for face in 0..faces {
        let shares: Vec<f64> = photos
            .iter()
            .filter_map(|photo| {
                let place = photo.faces().iter().position(|&seen| seen == face)?;
                Some(f64::from(photo.textured[place]) / (2.0 * f64::from(photo.pixels)))
            })
            .collect();
        if !shares.is_empty() {
            total += shares.iter().sum::<f64>() / shares.len() as f64;
        }
    }
    (total / (1.0 - f64::from(discount))) as f32
}

/// Takes the photo of every view the session asks for, where it asks for it; gives the indices.
pub fn follow<'a, S>(session: &mut Session<S, Room>, sightings: &[Sighting<'a>]) -> Vec<usize>
where
    S: for<'s> Scorer<Shot<'s> = Sighting<'a>>,
{
    let mut plan = Vec::new();
    while let Some(next) = session.next_view() {
        session.observe(next.index, next.pose, &sightings[next.index]).unwrap();
        plan.push(next.index);
    }
    plan
}

/// Numbers by chance, the same for the same seed.
pub struct Chance(Pcg32);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::new(seed, 0x7e57))
    }

    /// In [0, 1).
    pub fn share(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    /// In 0 .. limit.
    pub fn below(&mut self, limit: usize) -> usize {
        ((u64::from(self.0.next_u32()) * limit as u64) >> 32) as usize
    }
}
