//! The schemes by the names that the command line knows.

use vantage_core::Objective;
use vantage_core::planner::Plan;

/// Every name, with what it stands for.
pub const SCHEMES: [(&str, &str); 10] = [
    ("e", "the ensemble of objectives, C Q Q D D T in turn"),
    ("e-literal", "the ensemble as the paper words it: pseudo-coverage start, absolute phase"),
    ("c", "surface coverage alone"),
    ("q", "geometric complexity alone"),
    ("d", "ray diversity alone"),
    ("t", "textural complexity alone"),
    ("sum", "the sum of the four gains, each brought to the same range"),
    ("fps", "farthest-point sampling"),
    ("pc-fps", "pseudo-coverage, then farthest-point sampling"),
    ("random", "candidates by chance"),
];

/// The plan of a scheme, or `None` for a name that is none.
pub fn plan(name: &str, budget: usize, seed: u64) -> Option<Plan> {
    let plan = match name {
        "e" => Plan::ensemble(budget),
        "e-literal" => Plan::literal_ensemble(budget),
        "c" => Plan::single(Objective::Coverage, budget),
        "q" => Plan::single(Objective::Geometry, budget),
        "d" => Plan::single(Objective::Diversity, budget),
        "t" => Plan::single(Objective::Texture, budget),
        "sum" => Plan::sum(budget),
        "fps" => Plan::farthest_point(budget),
        "pc-fps" => Plan::pseudo_coverage(budget),
        "random" => Plan::random(budget),
        _ => return None,
    };
    Some(plan.with_seed(seed))
}

/// The scheme that is greedy on one objective: its exact oracle.
pub fn oracle(objective: Objective) -> &'static str {
    match objective {
        Objective::Coverage => "c",
        Objective::Geometry => "q",
        Objective::Diversity => "d",
        Objective::Texture => "t",
    }
}

/// Whether a scheme can choose by poses alone: without a mesh and without a network.
pub fn needs_poses_only(name: &str) -> bool {
    matches!(name, "fps" | "pc-fps" | "random")
}

/// The exact plan of each objective, taken together.
pub const ORACLE: &str = "oracle";

/// A sentence for a name that is none.
pub fn unknown(name: &str) -> String {
    let names: Vec<&str> = SCHEMES.iter().map(|(name, _)| *name).collect();
    format!("there is no scheme `{name}`: choose one of {}", names.join(", "))
}

/// What a scheme is, in words.
pub fn describe(name: &str) -> &str {
    SCHEMES.iter().find(|(known, _)| *known == name).map_or(name, |(_, words)| words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_makes_a_plan_and_no_other_does() {
        for (name, _) in SCHEMES {
            assert!(plan(name, 5, 0).is_some(), "{name}");
        }
        assert!(plan("best", 5, 0).is_none());
        assert!(unknown("best").contains("pc-fps"));
    }
}
