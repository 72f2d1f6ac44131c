//! Where the network keeps what it knows of candidates and views.

use super::encoder::Scratch;
use super::features::{Direction, Stance};
use super::image::SKETCH;
use super::outlook::{Form, OUTLOOK};
use super::support::Standpoint;

/// What is kept, to read. `H` and `E` are the model's; lists may be longer than what is in use.
#[derive(Clone, Copy, Debug)]
pub struct Lists<'a> {
    /// Sums of the tokens of all views, shape (candidates, H).
    pub sums: &'a [i16],
    /// Maxima of the same, shape (candidates, H).
    pub maxima: &'a [i8],
    /// Outlooks, shape (candidates, 8).
    pub outlooks: &'a [[i32; OUTLOOK]],
    /// Rank scores, shape (candidates, 4).
    pub ranks: &'a [[i32; 4]],
    /// What candidates are to later views, shape (candidates).
    pub standpoints: &'a [Standpoint],
    /// Embeddings of the photos, shape (views, E).
    pub embeddings: &'a [i8],
    /// Sketches of the photos, shape (views, 320).
    pub sketches: &'a [[i8; SKETCH]],
    /// Where the photos were taken, shape (views).
    pub stances: &'a [Stance],
    /// What the photos are to later views, shape (views).
    pub taken: &'a [Standpoint],
}

/// What is kept, to change. Shapes as in [`Lists`].
#[derive(Debug)]
pub struct ListsMut<'a> {
    /// Where the candidates lie, shape (candidates).
    pub directions: &'a mut [Direction],
    /// Sums of the tokens of all views, shape (candidates, H).
    pub sums: &'a mut [i16],
    /// Maxima of the same, shape (candidates, H).
    pub maxima: &'a mut [i8],
    /// Outlooks, shape (candidates, 8).
    pub outlooks: &'a mut [[i32; OUTLOOK]],
    /// Rank scores, shape (candidates, 4).
    pub ranks: &'a mut [[i32; 4]],
    /// What candidates are to later views, shape (candidates).
    pub standpoints: &'a mut [Standpoint],
    /// Embeddings of the photos, shape (views, E).
    pub embeddings: &'a mut [i8],
    /// Sketches of the photos, shape (views, 320).
    pub sketches: &'a mut [[i8; SKETCH]],
    /// Where the photos were taken, shape (views).
    pub stances: &'a mut [Stance],
    /// What the photos are to later views, shape (views).
    pub taken: &'a mut [Standpoint],
    /// The visual hull.
    pub form: &'a mut Form,
    /// Where photos are encoded.
    pub scratch: &'a mut Scratch,
}

/// Memory of a [`SoarNet`](super::SoarNet), of lengths that do not change. [`Fixed`] is the one for a
/// controller; a host may keep the lists on its heap.
pub trait Memory {
    /// To read.
    fn lists(&self) -> Lists<'_>;
    /// To change.
    fn lists_mut(&mut self) -> ListsMut<'_>;
}

/// Memory that lies elsewhere, such as in a `static`.
impl<M: Memory + ?Sized> Memory for &mut M {
    fn lists(&self) -> Lists<'_> {
        (**self).lists()
    }

    fn lists_mut(&mut self) -> ListsMut<'_> {
        (**self).lists_mut()
    }
}

/// Room for a fixed number of candidates and views of a network with tokens of `WIDTH` and embeddings
/// of `EMBEDDING`, without a heap.
///
/// A smaller network fits too. 128 candidates and 64 views of the default sizes take 170 KiB: 33 to
/// encode photos in, 45 for the visual hull, 36 for the views and 56 for the candidates.
#[derive(Clone, Debug)]
pub struct Fixed<
    const CANDIDATES: usize,
    const VIEWS: usize,
    const WIDTH: usize = 96,
    const EMBEDDING: usize = 96,
> {
    directions: [Direction; CANDIDATES],
    sums: [[i16; WIDTH]; CANDIDATES],
    maxima: [[i8; WIDTH]; CANDIDATES],
    outlooks: [[i32; OUTLOOK]; CANDIDATES],
    ranks: [[i32; 4]; CANDIDATES],
    standpoints: [Standpoint; CANDIDATES],
    embeddings: [[i8; EMBEDDING]; VIEWS],
    sketches: [[i8; SKETCH]; VIEWS],
    stances: [Stance; VIEWS],
    taken: [Standpoint; VIEWS],
    form: Form,
    scratch: Scratch,
}

impl<const CANDIDATES: usize, const VIEWS: usize, const WIDTH: usize, const EMBEDDING: usize>
    Fixed<CANDIDATES, VIEWS, WIDTH, EMBEDDING>
{
    /// Empty memory: zeros, which cost no flash in a `static`.
    pub const fn new() -> Self {
        Self {
            directions: [Direction::NONE; CANDIDATES],
            sums: [[0; WIDTH]; CANDIDATES],
            maxima: [[0; WIDTH]; CANDIDATES],
            outlooks: [[0; OUTLOOK]; CANDIDATES],
            ranks: [[0; 4]; CANDIDATES],
            standpoints: [Standpoint::NONE; CANDIDATES],
            embeddings: [[0; EMBEDDING]; VIEWS],
            sketches: [[0; SKETCH]; VIEWS],
            stances: [Stance::NONE; VIEWS],
            taken: [Standpoint::NONE; VIEWS],
            form: Form::new(),
            scratch: Scratch::new(),
        }
    }
}

impl<const CANDIDATES: usize, const VIEWS: usize, const WIDTH: usize, const EMBEDDING: usize>
    Default for Fixed<CANDIDATES, VIEWS, WIDTH, EMBEDDING>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<const CANDIDATES: usize, const VIEWS: usize, const WIDTH: usize, const EMBEDDING: usize> Memory
    for Fixed<CANDIDATES, VIEWS, WIDTH, EMBEDDING>
{
    fn lists(&self) -> Lists<'_> {
        Lists {
            sums: self.sums.as_flattened(),
            maxima: self.maxima.as_flattened(),
            outlooks: &self.outlooks,
            ranks: &self.ranks,
            standpoints: &self.standpoints,
            embeddings: self.embeddings.as_flattened(),
            sketches: &self.sketches,
            stances: &self.stances,
            taken: &self.taken,
        }
    }

    fn lists_mut(&mut self) -> ListsMut<'_> {
        ListsMut {
            directions: &mut self.directions,
            sums: self.sums.as_flattened_mut(),
            maxima: self.maxima.as_flattened_mut(),
            outlooks: &mut self.outlooks,
            ranks: &mut self.ranks,
            standpoints: &mut self.standpoints,
            embeddings: self.embeddings.as_flattened_mut(),
            sketches: &mut self.sketches,
            stances: &mut self.stances,
            taken: &mut self.taken,
            form: &mut self.form,
            scratch: &mut self.scratch,
        }
    }
}
