//! The names of the four objectives, a value for each, and the smoothing of them.

use core::fmt;

use crate::math;

/// One of the four surrogate objectives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Objective {
    /// C: how much of the surface has been seen.
    Coverage,
    /// Q: how much of the surface's geometric complexity has been seen, and how often.
    Geometry,
    /// D: from how many different directions the surface has been seen.
    Diversity,
    /// T: how much of the surface's textural complexity has been seen, and how often.
    Texture,
}

impl Objective {
    /// All four, in the order of [`Scores`] and of every array indexed by objective.
    pub const ALL: [Self; 4] = [Self::Coverage, Self::Geometry, Self::Diversity, Self::Texture];

    /// The name that scores bear in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Coverage => "coverage",
            Self::Geometry => "geometry",
            Self::Diversity => "diversity",
            Self::Texture => "texture",
        }
    }

    /// The paper's letter: C, Q, D or T.
    pub const fn letter(self) -> char {
        match self {
            Self::Coverage => 'C',
            Self::Geometry => 'Q',
            Self::Diversity => 'D',
            Self::Texture => 'T',
        }
    }
}

impl fmt::Display for Objective {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A value for each objective, before smoothing; 0 for no views.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scores {
    /// C: share of the surface seen, in [0, 1].
    pub coverage: f32,
    /// Q: share of the surface's geometric complexity seen often, in [0, 1].
    pub geometry: f32,
    /// D: mean spread of the directions from which the surface is seen, in [0, 1].
    pub diversity: f32,
    /// T: share of the surface's textural complexity seen often, in [0, 1] over candidate views; 1
    /// would be every part seen again and again, each time from where it fills most of a picture.
    pub texture: f32,
}

impl Scores {
    /// The value of one objective.
    pub const fn get(&self, objective: Objective) -> f32 {
        match objective {
            Objective::Coverage => self.coverage,
            Objective::Geometry => self.geometry,
            Objective::Diversity => self.diversity,
            Objective::Texture => self.texture,
        }
    }

    /// Each value through [`smoothing`].
    pub fn smoothed(&self) -> Self {
        Self {
            coverage: smoothing(self.coverage),
            geometry: smoothing(self.geometry),
            diversity: smoothing(self.diversity),
            texture: smoothing(self.texture),
        }
    }
}

/// The paper's xi (eq. `smoothing`): a logistic curve through (0.5, 0.5), clipped to [0, 1].
///
/// `xi(x) = 1 / (1 + exp(-a e x + a e / 2))` with `a = 3` and `e` Euler's number. It is monotone:
/// applied last, it never changes which candidate an objective prefers. NaN stays NaN.
///
/// ```
/// use vantage_core::objectives::smoothing;
/// assert_eq!(smoothing(0.5), 0.5);
/// assert!(smoothing(0.0) < 0.017 && smoothing(1.0) > 0.983);
/// ```
pub fn smoothing(x: f32) -> f32 {
    const ALPHA: f32 = 3.0;
    let slope = ALPHA * core::f32::consts::E;
    (1.0 / (1.0 + math::exp(slope * (0.5 - x)))).clamp(0.0, 1.0)
}
