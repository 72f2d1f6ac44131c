//! Plans by poses alone: without a mesh, a photo or a network.

use anyhow::Result;
use vantage_core::Pose;
use vantage_core::planner::{Blind, Plan, Session};

use crate::heap::Heap;

/// The candidates that a plan takes, in order, every photo being taken where it was asked for.
///
/// A plan that asks for gains finds them all 0: see [`Blind`].
pub fn views(poses: &[Pose], plan: Plan) -> Result<Vec<usize>> {
    let mut session = Session::try_new(Heap::default(), poses.iter().copied(), Blind, plan)?;
    let mut views = Vec::with_capacity(plan.budget());
    while let Some(next) = session.next_view() {
        session.observe(next.index, next.pose, &())?;
        views.push(next.index);
    }
    Ok(views)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pool::DISTANCE;
    use vantage_core::candidates::{Pool, ViewSpace};

    #[test]
    fn farthest_points_lie_apart() {
        let pool = Pool::try_new(ViewSpace::RandomSphere { seed: 2 }, 60, DISTANCE).unwrap();
        let poses: Vec<Pose> = pool.iter().collect();
        let views = views(&poses, Plan::farthest_point(4)).unwrap();
        assert_eq!(views.len(), 4);
        for (place, &one) in views.iter().enumerate() {
            for &other in &views[..place] {
                let apart = poses[one].position().angle_between(poses[other].position());
                assert!(apart.to_degrees() > 60.0);
            }
        }
        assert!(super::views(&poses, Plan::farthest_point(61)).is_err());
    }
}
