//! The surface whose views are scored, and what one photo shows of it.

use core::fmt;

use glam::Vec3;

/// One face of the mesh, as far as the objectives need it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Face {
    /// Its centroid in world, metres.
    pub centroid: Vec3,
    /// Its outward normal, unit length.
    pub normal: Vec3,
    /// Its share of the surface's area; all shares add up to 1.
    pub area_share: f32,
    /// `|LoG(normal)|` over the mesh (eq. `obj_Q_1`), at least 0.
    pub complexity: f32,
}

/// A mesh as the objectives need it: its faces, and the totals that bring sums to [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    faces: &'a [Face],
    complexity_total: f32, // sum of area_share * complexity
    texture_total: f32,
}

/// Why faces do not make a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceError {
    /// There is no face.
    Empty,
    /// A face has a NaN, an infinity, a negative share or complexity, or a normal off unit length.
    BadFace {
        /// Which.
        index: usize,
    },
    /// The area shares do not add up to 1.
    BadShares,
}

impl fmt::Display for SurfaceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the surface has no faces"),
            Self::BadFace { index } => write!(f, "face {index} holds a number that cannot be"),
            Self::BadShares => f.write_str("the faces' area shares do not add up to 1"),
        }
    }
}

impl core::error::Error for SurfaceError {}

impl<'a> Surface<'a> {
    /// Checks the faces and sums their totals.
    ///
    /// `texture_total` is the most that T's sum can come to: over the faces, the sum of the largest
    /// share of a picture's pixels that are textured and on the face (over the candidates), divided
    /// by `1 - d_T`. Anything not positive means that the object has no texture, and T is 0
    /// throughout.
    pub fn try_new(faces: &'a [Face], texture_total: f32) -> Result<Self, SurfaceError> {
        if faces.is_empty() {
            return Err(SurfaceError::Empty);
        }
        let (mut shares, mut complexities) = (0.0f64, 0.0f64);
        for (index, face) in faces.iter().enumerate() {
            let fine = face.centroid.is_finite()
                && (face.normal.length_squared() - 1.0).abs() < 1e-3
                && face.area_share >= 0.0
                && face.area_share.is_finite()
                && face.complexity >= 0.0
                && face.complexity.is_finite();
            if !fine {
                return Err(SurfaceError::BadFace { index });
            }
            shares += f64::from(face.area_share);
            complexities += f64::from(face.area_share * face.complexity);
        }
        if (shares - 1.0).abs() > 1e-3 {
            return Err(SurfaceError::BadShares);
        }
        let texture_total = if texture_total > 0.0 { texture_total } else { 0.0 };
        Ok(Self { faces, complexity_total: complexities as f32, texture_total })
    }

    /// The faces.
    pub fn faces(&self) -> &'a [Face] {
        self.faces
    }

    /// Sum of area share times complexity.
    pub fn complexity_total(&self) -> f32 {
        self.complexity_total
    }

    /// What T is divided by; 0 for an object without texture.
    pub fn texture_total(&self) -> f32 {
        self.texture_total
    }
}

/// A set of faces: bit `i % 32` of word `i / 32` says whether face `i` is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceSet<'a> {
    words: &'a [u32],
}

impl<'a> FaceSet<'a> {
    /// The set that these words spell; words past the surface's faces must be 0 to no effect.
    pub const fn new(words: &'a [u32]) -> Self {
        Self { words }
    }

    /// Words needed for a surface of `faces` faces.
    pub const fn words_for(faces: usize) -> usize {
        faces.div_ceil(32)
    }

    /// How many faces are in it.
    pub fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether no face is in it.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// The faces in it, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + 'a {
        self.words.iter().enumerate().flat_map(|(place, &word)| Bits { word, base: place * 32 })
    }

    /// Whether face `index` is in it.
    pub fn contains(&self, index: usize) -> bool {
        self.words.get(index / 32).is_some_and(|word| word >> (index % 32) & 1 == 1)
    }
}

/// The set bits of one word.
struct Bits {
    word: u32,
    base: usize,
}

impl Iterator for Bits {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        if self.word == 0 {
            return None;
        }
        let bit = self.word.trailing_zeros() as usize;
        self.word &= self.word - 1;
        Some(self.base + bit)
    }
}

/// What one photo shows of the surface.
///
/// Whoever renders it decides on the resolution (the paper's and our default: 256 x 256) and, for
/// the texture counts, on the reading: see [`Reading`](crate::objectives::Reading).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sighting<'a> {
    /// Faces with at least one pixel.
    pub faces: FaceSet<'a>,
    /// For each face of `faces`, in their order, the pixels that are textured, counted once for the
    /// hue and once for the saturation channel. Missing entries count as 0.
    pub textured: &'a [u32],
    /// Textured pixels on no face, counted likewise; 0 in the default reading.
    pub textured_background: u32,
    /// Pixels that could be textured: the object's, or in the literal reading the whole picture's.
    pub pixels: u32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_face_set_lists_its_faces_in_order() {
        let words = [0b1001, 0, 1 << 31];
        let set = FaceSet::new(&words);
        assert_eq!(set.iter().collect::<Vec<_>>(), [0, 3, 95]);
        assert_eq!(set.len(), 3);
        assert!(set.contains(95) && !set.contains(94) && !set.contains(4000));
        assert_eq!(FaceSet::words_for(33), 2);
    }

    #[test]
    fn nonsense_faces_are_refused() {
        let face = Face { centroid: Vec3::ZERO, normal: Vec3::Z, area_share: 1.0, complexity: 0.0 };
        assert!(Surface::try_new(&[face], 0.0).is_ok());
        assert_eq!(Surface::try_new(&[], 0.0).err(), Some(SurfaceError::Empty));
        assert_eq!(Surface::try_new(&[face, face], 0.0).err(), Some(SurfaceError::BadShares));
        let nan = Face { complexity: f32::NAN, ..face };
        assert_eq!(Surface::try_new(&[nan], 0.0).err(), Some(SurfaceError::BadFace { index: 0 }));
    }
}
