//! The schemes by the names that the command line knows.
//!
//! Some things may follow a name, in this order: `@SHARE`, another least distance from the views so
//! far ([`Plan::with_dispersion`]); `+opposite=WEIGHT`, another weight of the views' opposite sides in
//! that distance ([`Plan::with_opposite`]); `+start=VIEWS`, another number of first views
//! ([`Plan::with_start_views`]); `+move=COST`, a price on moving the camera
//! ([`Plan::with_movement_cost`]); `+stop=GAIN`, an end before the budget is spent
//! ([`Plan::with_stop`], its patience as in [`Stop::default`]).

use vantage_core::Objective;
use vantage_core::planner::{Plan, Scheme, Stop};

/// Every name, with what it stands for.
pub const SCHEMES: [(&str, &str); 24] = [
    ("soarnet-support", "support of the hull that a network sees in the photos"),
    ("soarnet", "the ensemble as a network predicts it from photos"),
    ("soarnet-c", "surface coverage as a network predicts it from photos"),
    ("soarnet-q", "geometric complexity as a network predicts it from photos"),
    ("soarnet-d", "ray diversity as a network predicts it from photos"),
    ("soarnet-t", "textural complexity as a network predicts it from photos"),
    ("soarnet-sum", "the sum of the four gains as a network predicts them from photos"),
    ("soarnet-poses", "the ensemble as a network predicts it from poses alone"),
    ("soarnet-poses-c", "surface coverage as a network predicts it from poses alone"),
    ("soarnet-poses-q", "geometric complexity as a network predicts it from poses alone"),
    ("soarnet-poses-d", "ray diversity as a network predicts it from poses alone"),
    ("soarnet-poses-t", "textural complexity as a network predicts it from poses alone"),
    ("soarnet-poses-sum", "the sum of the four gains as a network predicts them from poses alone"),
    ("e", "the ensemble of objectives, C Q Q D D T in turn"),
    ("e-literal", "the ensemble as the paper words it: pseudo-coverage start, absolute phase"),
    ("c", "surface coverage alone"),
    ("q", "geometric complexity alone"),
    ("d", "ray diversity alone"),
    ("t", "textural complexity alone"),
    ("sum", "the sum of the four gains, each brought to the same range"),
    (
        "support",
        "angular support and empty space, among views away from earlier ones and their opposites",
    ),
    ("fps", "farthest-point sampling"),
    ("pc-fps", "pseudo-coverage, then farthest-point sampling"),
    ("random", "candidates by chance"),
];

/// The plan of a scheme, or `None` for a name that is none.
pub fn plan(name: &str, budget: usize, seed: u64) -> Option<Plan> {
    let Parts { base, share, opposite, start, cost, stop } = parts(name)?;
    let plan = match network(base).map_or(base, |(_, plan)| plan) {
        "e" => Plan::ensemble(budget),
        "e-literal" => Plan::literal_ensemble(budget),
        "c" => Plan::single(Objective::Coverage, budget),
        "q" => Plan::single(Objective::Geometry, budget),
        "d" => Plan::single(Objective::Diversity, budget),
        "t" => Plan::single(Objective::Texture, budget),
        "sum" => Plan::sum(budget),
        "support" => Plan::support(budget),
        "fps" => Plan::farthest_point(budget),
        "pc-fps" => Plan::pseudo_coverage(budget),
        "random" => Plan::random(budget),
        _ => return None,
    };
    let plan = share.map_or(plan, |share| plan.with_dispersion(share));
    let plan = opposite.map_or(plan, |weight| plan.with_opposite(weight));
    let plan = start.map_or(plan, |views| plan.with_start_views(views as usize));
    let plan = cost.map_or(plan, |cost| plan.with_movement_cost(cost));
    let plan = stop.map_or(plan, |gain| plan.with_stop(Stop { gain, ..Stop::default() }));
    Some(plan.with_seed(seed))
}

/// A scheme's name, and what follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parts<'a> {
    base: &'a str,
    share: Option<f32>,
    opposite: Option<f32>,
    start: Option<f32>,
    cost: Option<f32>,
    stop: Option<f32>,
}

/// More first views than anybody asks for.
const MOST_VIEWS: f32 = 65_536.0;

/// `None` if what follows the name cannot be read or is out of range.
fn parts(name: &str) -> Option<Parts<'_>> {
    let (rest, stop) = cut(name, "+stop=", f32::MAX)?;
    let (rest, cost) = cut(rest, "+move=", 1.0)?;
    let (rest, start) = cut(rest, "+start=", MOST_VIEWS)?;
    let (rest, opposite) = cut(rest, "+opposite=", 1.0)?;
    let (base, share) = cut(rest, "@", 1.0)?;
    let whole = start.is_none_or(|views| views.fract() == 0.0);
    whole.then_some(Parts { base, share, opposite, start, cost, stop })
}

/// What stands before a mark, and the number from 0 to `most` behind it, if the mark is there.
fn cut<'a>(text: &'a str, mark: &str, most: f32) -> Option<(&'a str, Option<f32>)> {
    let Some((before, number)) = text.split_once(mark) else { return Some((text, None)) };
    let number = number.parse().ok().filter(|number| (0.0..=most).contains(number))?;
    Some((before, Some(number)))
}

/// The name without what follows it.
pub fn base(name: &str) -> &str {
    parts(name).map_or(name, |parts| parts.base)
}

/// Whether a plan of the scheme may end before its budget is spent.
pub fn stops(name: &str) -> bool {
    parts(name).is_some_and(|parts| parts.stop.is_some())
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

/// Whether a scheme looks for support, which must be prepared.
pub fn needs_support(name: &str) -> bool {
    network(name).is_none() && plan(name, 1, 0).is_some_and(|plan| plan.scheme() == Scheme::Support)
}

/// Whether a scheme can choose by poses alone: without a mesh and without a network.
pub fn needs_poses_only(name: &str) -> bool {
    matches!(base(name), "fps" | "pc-fps" | "random")
}

/// The networks that schemes may ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Network {
    /// The one that looks at photos.
    Soarnet,
    /// The one that looks at poses alone.
    Poses,
}

impl Network {
    /// The scheme's name for the ensemble; those of its other plans begin with it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Soarnet => "soarnet",
            Self::Poses => "soarnet-poses",
        }
    }

    /// The scheme that is greedy on one objective as this network predicts it.
    pub const fn single(self, objective: Objective) -> &'static str {
        match (self, objective) {
            (Self::Soarnet, Objective::Coverage) => "soarnet-c",
            (Self::Soarnet, Objective::Geometry) => "soarnet-q",
            (Self::Soarnet, Objective::Diversity) => "soarnet-d",
            (Self::Soarnet, Objective::Texture) => "soarnet-t",
            (Self::Poses, Objective::Coverage) => "soarnet-poses-c",
            (Self::Poses, Objective::Geometry) => "soarnet-poses-q",
            (Self::Poses, Objective::Diversity) => "soarnet-poses-d",
            (Self::Poses, Objective::Texture) => "soarnet-poses-t",
        }
    }
}

/// The network that a scheme asks, and the scheme that it would be with exact gains.
pub fn network(name: &str) -> Option<(Network, &str)> {
    let Parts { base, .. } = parts(name)?;
    [Network::Poses, Network::Soarnet].into_iter().find_map(|network| {
        let rest = base.strip_prefix(network.name())?;
        let plan = if rest.is_empty() { "e" } else { rest.strip_prefix('-')? };
        let known = matches!(plan, "e" | "c" | "q" | "d" | "t" | "sum")
            || (plan == "support" && network == Network::Soarnet);
        known.then_some((network, plan))
    })
}

/// The exact plan of each objective, taken together.
pub const ORACLE: &str = "oracle";

/// A sentence for a name that is none, where other names than [`SCHEMES`] may be known too.
pub fn unknown(name: &str, others: &[&str]) -> String {
    let names = SCHEMES.iter().map(|(name, _)| name).chain(others);
    let names: Vec<&str> = names.copied().collect();
    format!(
        "there is no scheme `{name}`: choose one of {}; behind it may stand @SHARE (0 to 1), the least \
         distance from the views so far, +opposite=WEIGHT (0 to 1), how much the side opposite a view \
         counts as that view, +start=VIEWS, the number of first views, then for `compare` and \
         `evaluate` +move=COST (0 to 1), then for `evaluate` +stop=GAIN (0 or more)",
        names.join(", ")
    )
}

/// What a scheme is, in words.
pub fn describe(name: &str) -> &str {
    SCHEMES.iter().find(|(known, _)| *known == base(name)).map_or(name, |(_, words)| words)
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
        assert!(plan("soarnet-fps", 5, 0).is_none() && plan("soarnet-", 5, 0).is_none());
        assert_eq!(network("soarnet-poses"), Some((Network::Poses, "e")));
        assert_eq!(network("soarnet-q"), Some((Network::Soarnet, "q")));
        for (network, objective) in
            [Network::Soarnet, Network::Poses].into_iter().zip(Objective::ALL)
        {
            let single = plan(network.single(objective), 5, 0).unwrap();
            assert_eq!(single, Plan::single(objective, 5));
        }
        assert_eq!(
            plan("e@0.25", 5, 3),
            Some(Plan::ensemble(5).with_dispersion(0.25).with_seed(3))
        );
        assert_eq!(network("soarnet-q@1"), Some((Network::Soarnet, "q")));
        let stop = Stop { gain: 0.02, ..Stop::default() };
        let priced = Plan::support(5).with_movement_cost(0.5).with_stop(stop);
        assert_eq!(plan("soarnet-support+move=0.5+stop=0.02", 5, 0), Some(priced));
        let begun = Plan::farthest_point(5).with_opposite(0.5).with_start_views(1);
        assert_eq!(plan("fps+opposite=0.5+start=1", 5, 0), Some(begun));
        for name in [
            "e+start=1.5",
            "e+opposite=2",
            "e@1.1",
            "e@",
            "e+move=2",
            "e+move=",
            "e+stop=-1",
            "e+stop=1+move=1",
            "e+2",
        ] {
            assert!(plan(name, 5, 0).is_none(), "{name}");
        }
        assert!(stops("e@0.5+stop=0.02") && !stops("e+move=0.5"));
        assert!(!needs_support("soarnet-support") && network("soarnet-poses-support").is_none());
        assert!(needs_support("support@0.3") && !needs_support("fps") && !needs_support("best"));
        assert!(needs_poses_only("fps@0.5") && !needs_poses_only("e"));
        assert!(unknown("best", &["oracle"]).contains("random, oracle; behind"));
    }
}
