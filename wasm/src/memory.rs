//! A session's lists on the heap, which a browser has.

use vantage_core::planner::{Candidate, Memory, View};

/// Room for as many candidates and views as are pushed.
#[derive(Debug, Default)]
pub struct Growing {
    candidates: Vec<Candidate>,
    views: Vec<View>,
}

impl Memory for Growing {
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
