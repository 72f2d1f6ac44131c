//! Which views each scheme takes of an object.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::Reading;
use vantage_core::{Camera, Pose};
use vantage_lab::exact::Labelled;
use vantage_lab::label::RESOLUTION;
use vantage_lab::mesh::Mesh;
use vantage_lab::network::{self, Network};
use vantage_lab::pool::{DISTANCE, FOV_X_RAD};
use vantage_lab::scheme;

use crate::active;

/// Evenly spread views that are no candidates.
pub const FIBONACCI: &str = "fibonacci";

/// The best of several runs in hindsight, by their PSNR: no planner, but what luck or a perfect choice
/// among objectives would give.
pub const HINDSIGHT: [(&str, &str); 2] = [
    ("best-of-4-random", "the best of four random plans in hindsight"),
    ("optimal-cqdt", "the best of the four exact objectives in hindsight"),
];

/// The runs among which a scheme of [`HINDSIGHT`] takes the best, or the run itself: schemes and seeds.
pub fn parts(scheme: &str, seed: u64) -> Vec<(String, u64)> {
    match scheme {
        "best-of-4-random" => (4 * seed..4 * seed + 4).map(|s| ("random".to_owned(), s)).collect(),
        "optimal-cqdt" => ["c", "q", "d", "t"].map(|scheme| (scheme.to_owned(), seed)).to_vec(),
        _ => vec![(scheme.to_owned(), seed)],
    }
}

/// The name under which a scheme is known: `e-exact` is how people tell `e` from a prediction of it.
pub fn canonical(name: &str) -> String {
    match name.strip_prefix("e-exact") {
        Some(rest) if rest.is_empty() || rest.starts_with(['@', '+']) => format!("e{rest}"),
        _ => name.to_owned(),
    }
}

/// What a scheme is, in words.
pub fn describe(scheme: &str) -> &str {
    let hindsight = HINDSIGHT.iter().find(|(name, _)| *name == scheme).map(|(_, words)| *words);
    match scheme {
        FIBONACCI => "an even lattice on the sphere, not from the candidates",
        active::NAME => "ActiveNeRF at a small size: where a network in training is least sure",
        _ => hindsight.unwrap_or_else(|| scheme::describe(scheme)),
    }
}

/// Whether a scheme's views depend on a seed for the same candidates; where they do not, one run tells
/// all of them.
pub fn has_chance(scheme: &str) -> bool {
    !matches!(scheme::base(scheme), FIBONACCI | "pc-fps" | "e-literal")
}

/// Fails for a name that is none.
pub fn check(name: &str) -> Result<()> {
    let known = matches!(name, FIBONACCI | active::NAME)
        || HINDSIGHT.iter().any(|(known, _)| *known == name)
        || scheme::plan(name, 1, 0).is_some();
    let others = ["e-exact", FIBONACCI, active::NAME];
    let others: Vec<&str> = others.into_iter().chain(HINDSIGHT.map(|(name, _)| name)).collect();
    ensure!(known, "{}", scheme::unknown(name, &others));
    if let Some(plan) = scheme::plan(name, 1, 0) {
        plan.check(1).with_context(|| format!("the scheme {name}"))?;
    }
    Ok(())
}

/// The views of one plan, the first ones first.
#[derive(Clone, Debug)]
pub struct Views {
    /// World from camera.
    pub poses: Vec<Pose>,
    /// Which candidates they are; none for views that are no candidates.
    pub candidates: Option<Vec<usize>>,
    /// Seconds of planning until each view, what had to be rendered to know the object not counted.
    pub seconds: Vec<f64>,
}

impl Views {
    /// Of a plan for more views, what the plan of a smaller budget is: every scheme is greedy. A plan
    /// that ended before has no more views than it has.
    pub fn first(&self, budget: usize) -> Self {
        let budget = budget.min(self.poses.len());
        Self {
            poses: self.poses[..budget].to_vec(),
            candidates: self.candidates.as_ref().map(|all| all[..budget].to_vec()),
            seconds: self.seconds[..budget].to_vec(),
        }
    }

    /// How far the camera goes from view to view around the origin, in order, degrees.
    pub fn travel_deg(&self) -> f64 {
        let leg = |leg: &[Pose]| leg[0].position().angle_between(leg[1].position());
        self.poses.windows(2).map(|two| f64::from(leg(two).to_degrees())).sum()
    }
}

/// Fails if a plan has fewer views than were asked for, unless its scheme may stop.
pub fn check_length(name: &str, views: usize, budget: usize) -> Result<()> {
    ensure!(
        views >= budget || scheme::stops(name),
        "{name} chose {views} views of {budget}: lower the budget or add candidates"
    );
    Ok(())
}

/// Plans for one object.
pub struct Planner<'a> {
    labelled: Labelled,
    photos: Vec<image::RgbImage>, // (candidates); empty if no network will be asked
    networks: &'a [(scheme::Network, Network)],
}

impl<'a> Planner<'a> {
    /// Labels the candidates of an object, and prepares what these schemes look at.
    pub fn new(
        mesh: &Mesh,
        poses: &[Pose],
        networks: &'a [(scheme::Network, Network)],
        schemes: &[&str],
    ) -> Result<Self> {
        let camera = Camera::from_fov(RESOLUTION, RESOLUTION, FOV_X_RAD)?;
        let mut labelled = Labelled::new(mesh, &camera, poses.to_vec(), Reading::default(), || {});
        if schemes.iter().any(|name| scheme::needs_support(name)) {
            labelled = labelled.with_support(mesh)?;
        }
        let asked = schemes.iter().any(|name| scheme::network(name).is_some());
        let photos = if asked { network::photos(mesh, poses)? } else { Vec::new() };
        Ok(Self { labelled, photos, networks })
    }

    /// The views of a scheme.
    pub fn views(&self, name: &str, budget: usize, seed: u64) -> Result<Views> {
        let start = Instant::now();
        if name == FIBONACCI {
            let pool = Pool::try_new(ViewSpace::FibonacciSphere, budget, DISTANCE)?;
            let poses: Vec<Pose> = pool.iter().collect();
            let seconds = vec![start.elapsed().as_secs_f64(); poses.len()];
            return Ok(Views { poses, candidates: None, seconds });
        }
        let plan = scheme::plan(name, budget, seed).with_context(|| scheme::unknown(name, &[]))?;
        let steps = match scheme::network(name) {
            Some((asked, _)) => {
                let network = self.networks.iter().find(|(known, _)| *known == asked);
                let (_, network) = network.context("a network is missing")?;
                let photo = |index: usize| self.photos[index].clone();
                network.run(&self.labelled, photo, plan, || {})?
            }
            None => self.labelled.run(plan, || {})?,
        };
        check_length(name, steps.len(), budget)?;
        Ok(Views {
            poses: steps.iter().map(|step| step.next.pose).collect(),
            candidates: Some(steps.iter().map(|step| step.next.index).collect()),
            seconds: steps.iter().map(|step| step.seconds).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hindsight_is_made_of_other_runs() {
        let random = parts("best-of-4-random", 2);
        assert_eq!(random.iter().map(|(_, seed)| *seed).collect::<Vec<_>>(), [8, 9, 10, 11]);
        assert_eq!(parts("optimal-cqdt", 1).len(), 4);
        assert_eq!(parts("fps", 3), [("fps".to_owned(), 3)]);
    }

    #[test]
    fn names_are_known_or_refused() {
        for name in [
            "random",
            "soarnet",
            "fibonacci",
            "activenerf",
            "optimal-cqdt",
            "best-of-4-random",
            "d",
        ] {
            check(name).unwrap();
            assert_ne!(describe(name), name);
        }
        assert!(format!("{:#}", check("best").unwrap_err()).contains("fibonacci"));
        assert_eq!(canonical("e-exact"), "e");
        assert_eq!(canonical("e-exact+move=1"), "e+move=1");
        assert_eq!(canonical("e-exactly"), "e-exactly");
    }
}
