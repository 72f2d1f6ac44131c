//! SOARNet: what a further view would bring, predicted from the photos and poses so far.

pub mod features;
