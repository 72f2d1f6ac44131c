//! The running account of what has been seen: constant memory per face, whatever the views.
//!
//! - C, surface coverage (eq. `obj_C`): the share of the surface seen at least once.
//! - Q, geometric complexity (eqs. `obj_Q_1`, `obj_Q_2`): the m-th time a face is seen it adds
//!   `d_Q^(m-1)` of its complexity.
//! - T, textural complexity (eqs. `obj_T_1`, `obj_T_2`): a view's textured pixels count `d_T^m` on a
//!   face seen m times before.
//! - D, ray diversity: see [`diversity`](super::diversity).
//!
//! C, Q and the default T are monotone and have diminishing gains; see [`Ledger::diminishes`].
//! Sums run over the faces in ascending order in double precision: a sum over fewer or smaller
//! non-negative terms then never comes out larger, which is what lazy greedy stands on.

use glam::Vec3;

use super::diversity::{self, Rays};
use super::reading::{Form, Reading};
use super::scores::{Objective, Scores};
use super::surface::{Face, Sighting, Surface};
#[cfg(feature = "serde")]
use crate::checksum::CRC;
#[cfg(feature = "serde")]
use crate::record::{Sink, SnapshotError, Source};

/// What is known of one face. The caller owns an array of these, one for each face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FaceAccount {
    seen: u32,
    geometry_spent: f32, // 1 - d_Q^seen
    texture_left: f32,   // d_T^seen
    rays: Rays,
}

const _: () = assert!(size_of::<FaceAccount>() == 48, "the docs of `try_new` state the size");

/// The four objectives over one surface, as views are added.
#[derive(Debug)]
pub struct Ledger<'a> {
    surface: Surface<'a>,
    reading: Reading,
    accounts: &'a mut [FaceAccount],
    texture: f64, // sum over the views of their discounted share of textured pixels
    views: u32,
}

/// Why a ledger cannot be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LedgerError {
    /// The caller's array has not one account for each face.
    WrongLength {
        /// Faces of the surface.
        expected: usize,
        /// Accounts handed over.
        got: usize,
    },
    /// A discount of the reading is not in [0, 1), or its sigma or beta is not positive and finite.
    BadReading,
}

impl core::fmt::Display for LedgerError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::WrongLength { expected, got } => {
                write!(f, "the ledger needs {expected} accounts, one for each face, not {got}")
            }
            Self::BadReading => f.write_str(
                "the reading's discounts must lie in [0, 1), its sigma and beta above 0",
            ),
        }
    }
}

impl core::error::Error for LedgerError {}

impl<'a> Ledger<'a> {
    /// An empty account over a surface, in the caller's memory (48 bytes a face).
    pub fn try_new(
        surface: Surface<'a>,
        reading: Reading,
        accounts: &'a mut [FaceAccount],
    ) -> Result<Self, LedgerError> {
        let (expected, got) = (surface.faces().len(), accounts.len());
        if expected != got {
            return Err(LedgerError::WrongLength { expected, got });
        }
        if !reading.is_sound() {
            return Err(LedgerError::BadReading);
        }
        accounts.fill(FaceAccount { texture_left: 1.0, ..FaceAccount::default() });
        Ok(Self { surface, reading, accounts, texture: 0.0, views: 0 })
    }

    /// How many views have been added.
    pub fn views(&self) -> u32 {
        self.views
    }

    /// Whether a candidate's gain can only fall as views are added, exactly and not just nearly.
    pub fn diminishes(&self, objective: Objective) -> bool {
        match objective {
            Objective::Coverage | Objective::Geometry => true,
            Objective::Texture => self.reading.form == Form::Default,
            Objective::Diversity => false,
        }
    }

    /// Adds a view from `camera` (world, metres).
    pub fn add(&mut self, camera: Vec3, sighting: &Sighting<'_>) {
        self.texture += self.texture_of(sighting);
        self.views = self.views.saturating_add(1);
        let rule = self.reading.diversity_rule();
        for index in sighting.faces.iter() {
            let (Some(face), Some(account)) =
                (self.surface.faces().get(index), self.accounts.get_mut(index))
            else {
                continue;
            };
            account.seen = account.seen.saturating_add(1);
            account.geometry_spent +=
                (1.0 - account.geometry_spent) * (1.0 - self.reading.geometry_discount);
            account.texture_left *= self.reading.texture_discount;
            account.rays.add(face, camera, rule);
        }
    }

    /// What one objective would gain by a view from `camera` (world, metres), before smoothing.
    pub fn gain(&self, objective: Objective, camera: Vec3, sighting: &Sighting<'_>) -> f32 {
        match objective {
            Objective::Coverage => {
                let unseen = self.entries(sighting).filter(|(_, account)| account.seen == 0);
                unseen.map(|(face, _)| self.weight(face)).sum::<f64>() as f32
            }
            Objective::Geometry => {
                let step = 1.0 - f64::from(self.reading.geometry_discount);
                let sum: f64 = self
                    .entries(sighting)
                    .map(|(face, account)| {
                        self.complexity(face) * (1.0 - f64::from(account.geometry_spent))
                    })
                    .sum();
                self.geometry_score(sum * step) - self.geometry_score(0.0)
            }
            Objective::Diversity => {
                let entry = |index: usize| {
                    let (face, account) =
                        (self.surface.faces().get(index)?, self.accounts.get(index)?);
                    Some((face, &account.rays, self.weight(face) as f32))
                };
                diversity::gain(sighting.faces, camera, self.reading.diversity_rule(), entry)
            }
            Objective::Texture => {
                let added = self.texture_of(sighting);
                match self.reading.form {
                    // Not as a difference of sums: its rounding would move with the sums.
                    Form::Default => self.texture_score(added, 1),
                    Form::Literal => {
                        self.texture_score(self.texture + added, self.views.saturating_add(1))
                            - self.texture_score(self.texture, self.views)
                    }
                }
            }
        }
    }

    /// The scores of the views added so far, before smoothing.
    pub fn scores(&self) -> Scores {
        let (mut coverage, mut geometry, mut diversity) = (0.0f64, 0.0f64, 0.0f64);
        for (face, account) in self.surface.faces().iter().zip(&*self.accounts) {
            let weight = self.weight(face);
            if account.seen > 0 {
                coverage += weight;
            }
            geometry += self.complexity(face) * f64::from(account.geometry_spent);
            diversity += weight * f64::from(account.rays.value());
        }
        Scores {
            coverage: (coverage as f32).min(1.0),
            geometry: self.geometry_score(geometry),
            diversity: diversity as f32,
            texture: self.texture_score(self.texture, self.views),
        }
    }

    /// How often face `index` has been seen; 0 past the end.
    pub fn times_seen(&self, index: usize) -> u32 {
        self.accounts.get(index).map_or(0, |account| account.seen)
    }

    /// The faces of a sighting with their accounts, in ascending order.
    fn entries<'s>(
        &'s self,
        sighting: &Sighting<'s>,
    ) -> impl Iterator<Item = (&'s Face, &'s FaceAccount)> + 's {
        let faces = self.surface.faces();
        let accounts = &*self.accounts;
        sighting.faces.iter().filter_map(|index| Some((faces.get(index)?, accounts.get(index)?)))
    }

    /// A face's share in C and D.
    fn weight(&self, face: &Face) -> f64 {
        match self.reading.form {
            Form::Default => f64::from(face.area_share),
            Form::Literal => 1.0 / self.surface.faces().len() as f64,
        }
    }

    /// A face's part in Q's sum.
    fn complexity(&self, face: &Face) -> f64 {
        match self.reading.form {
            Form::Default => f64::from(face.area_share * face.complexity),
            Form::Literal => f64::from(face.complexity),
        }
    }

    /// Q from the sum over the faces of complexity times `1 - d_Q^seen`.
    fn geometry_score(&self, spent: f64) -> f32 {
        match self.reading.form {
            Form::Default => {
                let total = f64::from(self.surface.complexity_total());
                if total > 0.0 { (spent / total) as f32 } else { 0.0 }
            }
            Form::Literal => {
                // A face seen m times has added (1 - d^m) / (1 - d) of its complexity; each face
                // brings the paper's "+ 1" besides.
                let faces = self.surface.faces().len() as f64;
                let added = spent / (1.0 - f64::from(self.reading.geometry_discount));
                let sigma = 5.0 * f64::from(self.reading.sigma_q);
                ((f64::from(self.reading.beta_q) * added + faces) / (faces * sigma * sigma)) as f32
            }
        }
    }

    /// The share of a view's pixels that are textured, each discounted by how often its face has
    /// been seen.
    fn texture_of(&self, sighting: &Sighting<'_>) -> f64 {
        if sighting.pixels == 0 {
            return 0.0;
        }
        let mut sum = f64::from(sighting.textured_background);
        for (index, &textured) in sighting.faces.iter().zip(sighting.textured) {
            if let Some(account) = self.accounts.get(index) {
                sum += f64::from(textured) * f64::from(account.texture_left);
            }
        }
        // Two channels: hue and saturation.
        sum / (2.0 * f64::from(sighting.pixels))
    }

    /// T from the sum over the views.
    fn texture_score(&self, sum: f64, views: u32) -> f32 {
        match self.reading.form {
            Form::Default => {
                let total = f64::from(self.surface.texture_total());
                if total > 0.0 { (sum / total) as f32 } else { 0.0 }
            }
            Form::Literal => (sum / f64::from(views.max(1))) as f32,
        }
    }
}

#[cfg(feature = "serde")]
impl Ledger<'_> {
    /// Tells surfaces and readings apart.
    pub(crate) fn fingerprint(&self) -> u32 {
        let mut digest = CRC.digest();
        let Reading { form, geometry_discount, texture_discount, sigma_q, beta_q } = self.reading;
        let numbers = [geometry_discount, texture_discount, sigma_q, beta_q];
        digest.update(&[u8::from(form == Form::Literal)]);
        let faces = self.surface.faces().iter().flat_map(|face| {
            let [x, y, z] = face.centroid.to_array();
            let [a, b, c] = face.normal.to_array();
            [x, y, z, a, b, c, face.area_share, face.complexity]
        });
        let totals = [self.surface.texture_total()];
        for number in numbers.into_iter().chain(totals).chain(faces) {
            digest.update(&number.to_bits().to_le_bytes());
        }
        digest.finalize()
    }

    /// Writes the account.
    pub(crate) fn save(&self, sink: &mut Sink<'_>) -> Result<(), SnapshotError> {
        sink.put(&(self.views, self.texture))?;
        self.accounts.iter().try_for_each(|account| sink.put(account))
    }

    /// Takes on an account that [`save`](Self::save) wrote.
    pub(crate) fn load(&mut self, source: &mut Source<'_>) -> Result<(), SnapshotError> {
        (self.views, self.texture) = source.take()?;
        for account in &mut *self.accounts {
            *account = source.take()?;
        }
        Ok(())
    }
}
