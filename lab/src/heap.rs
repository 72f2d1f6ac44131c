//! A session's memory on the host.

use vantage_core::planner::{Candidate, Memory, View};

/// A session's memory on the heap: as many candidates and views as there are.
#[derive(Debug, Default)]
pub(crate) struct Heap {
    candidates: Vec<Candidate>,
    views: Vec<View>,
}

impl Memory for Heap {
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn candidates_mut(&mut self) -> &mut [Candidate] {
        &mut self.candidates
    }

    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate> {
        self.candidates.push(candidate);
        Ok(())
    }

    fn views(&self) -> &[View] {
        &self.views
    }

    fn push_view(&mut self, view: View) -> Result<(), View> {
        self.views.push(view);
        Ok(())
    }

    fn view_capacity(&self) -> usize {
        usize::MAX
    }

    fn clear(&mut self) {
        self.candidates.clear();
        self.views.clear();
    }
}
