//! The lists of a session and of a network on the heap, which a browser has.

use vantage_core::planner::{Candidate, Memory, View};
use vantage_core::soarnet::{
    self, Form, Lists, ListsMut, Model, OUTLOOK, SKETCH, Scratch, Standpoint, features,
};

use crate::Refusal;
use crate::input::{MOST_CANDIDATES, filled};

/// The views that a network remembers: the sums of more tokens might not fit.
pub const MOST_NETWORK_VIEWS: usize = 256;

/// Room for as many candidates and views as are pushed, up to a limit.
#[derive(Debug)]
pub struct Growing {
    candidates: Vec<Candidate>,
    views: Vec<View>,
    most_views: usize,
}

impl Growing {
    /// Empty, with room for so many views.
    pub fn new(most_views: usize) -> Self {
        Self { candidates: Vec::new(), views: Vec::new(), most_views }
    }
}

/// Adds a value, or hands it back where there is no memory for it.
fn push<T>(list: &mut Vec<T>, value: T) -> Result<(), T> {
    if list.try_reserve(1).is_err() {
        return Err(value);
    }
    list.push(value);
    Ok(())
}

impl Memory for Growing {
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn candidates_mut(&mut self) -> &mut [Candidate] {
        &mut self.candidates
    }

    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate> {
        if self.candidates.len() >= MOST_CANDIDATES as usize {
            return Err(candidate);
        }
        push(&mut self.candidates, candidate)
    }

    fn views(&self) -> &[View] {
        &self.views
    }

    fn push_view(&mut self, view: View) -> Result<(), View> {
        if self.views.len() >= self.most_views {
            return Err(view);
        }
        push(&mut self.views, view)
    }

    fn view_capacity(&self) -> usize {
        self.most_views
    }

    fn clear(&mut self) {
        self.candidates.clear();
        self.views.clear();
    }
}

/// The memory of a network over so many candidates, with room for [`MOST_NETWORK_VIEWS`].
#[derive(Debug)]
pub struct NetworkMemory {
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

impl NetworkMemory {
    /// Memory for a model's sizes.
    pub fn try_new(model: &Model<'_>, candidates: usize) -> Result<Self, Refusal> {
        let sizes = model.dimensions();
        let views = MOST_NETWORK_VIEWS;
        Ok(Self {
            directions: filled(candidates, features::Direction::default())?,
            sums: filled(candidates * sizes.width, 0)?,
            maxima: filled(candidates * sizes.width, 0)?,
            outlooks: filled(candidates, [0; OUTLOOK])?,
            ranks: filled(candidates, [0; 4])?,
            standpoints: filled(candidates, Standpoint::NONE)?,
            embeddings: filled(views * sizes.embedding, 0)?,
            sketches: filled(if sizes.embedding > 0 { views } else { 0 }, [0; SKETCH])?,
            stances: filled(views, features::Stance::default())?,
            taken: filled(views, Standpoint::NONE)?,
            form: Box::default(),
            scratch: Box::default(),
        })
    }
}

impl soarnet::Memory for NetworkMemory {
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
