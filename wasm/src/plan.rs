//! What is asked of the planner.

use vantage_core::Vec3;
use vantage_core::planner::{Plan, Scheme, Start, Stop};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::{Refusal, input};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** What makes a view good: new surface, fine shape, new directions, fine texture. */
export type Objective = "coverage" | "geometry" | "diversity" | "texture";

/** How the next view is chosen. Those of the first line need a model; the others look at poses. */
export type Scheme =
  | "support" | "ensemble" | "sum" | Objective
  | "farthest-point" | "pseudo-coverage" | "random";

/** A whole plan. Without `seed` it is 0. `movementCost` in [0, 1] is the share of a gain that half a
 *  turn around `centre` costs; without `centre` (metres) it is the pool's. `dispersion` in [0, 1] is how
 *  far from all photos so far the next one must be, as a share of the distance that the farthest candidate
 *  has; only what asks for gains minds it. `opposite` in [0, 1] is how much standing opposite a photo
 *  counts as standing at it, until six have been taken: the outline is the same from there. `stop` ends
 *  the session after `patience` choices in a row that promised less than `gain`. `start` and `startViews`
 *  say how and how many first views are chosen: one for "support", none for
 *  "random", else 3, farthest from each other.
 *  "support" needs a model that looks at photos: with another it takes the farthest. */
export type Plan = {
  scheme: Scheme; budget: number; seed?: number; movementCost?: number; dispersion?: number;
  opposite?: number;
  stop?: { gain: number; patience: number };
  start?: "farthest-point" | "pseudo-coverage"; startViews?: number; centre?: Point;
};
"#;

/// The plan that JavaScript describes, around `centre` unless it names its own.
pub fn read(plan: &JsValue, centre: Vec3) -> Result<Plan, Refusal> {
    let budget = input::whole("budget", input::number(plan, "budget")?, input::MOST_CANDIDATES)?;
    let name = input::text(plan, "scheme")?;
    let mut read = of_scheme(&name, budget).ok_or_else(|| {
        Refusal::bad_argument(format!(
            "there is no scheme `{name}`; there are support, ensemble, sum, coverage, geometry, \
             diversity, texture, farthest-point, pseudo-coverage and random"
        ))
    })?;
    if let Some(seed) = input::optional_number(plan, "seed")? {
        read = read.with_seed(input::seed(seed)?);
    }
    if let Some(cost) = input::optional_number(plan, "movementCost")? {
        read = read.with_movement_cost(cost as f32);
    }
    if let Some(share) = input::optional_number(plan, "dispersion")? {
        read = read.with_dispersion(share as f32);
    }
    if let Some(weight) = input::optional_number(plan, "opposite")? {
        read = read.with_opposite(weight as f32);
    }
    if let Some(stop) = input::field(plan, "stop") {
        let patience = input::number(&stop, "patience")?;
        let patience = input::whole("patience", patience, u16::MAX.into())? as u16;
        read = read.with_stop(Stop { gain: input::number(&stop, "gain")? as f32, patience });
    }
    match input::optional_text(plan, "start")?.as_deref() {
        None => {}
        Some("farthest-point") => read = read.with_start(Start::FarthestPoint),
        Some("pseudo-coverage") => read = read.with_start(Start::PseudoCoverage),
        Some(other) => {
            return Err(Refusal::bad_argument(format!(
                "there is no start `{other}`; there are farthest-point and pseudo-coverage"
            )));
        }
    }
    if let Some(views) = input::optional_number(plan, "startViews")? {
        let views = input::whole("startViews", views, input::MOST_CANDIDATES)?;
        read = read.with_start_views(views);
    }
    let own = input::field(plan, "centre").unwrap_or(JsValue::UNDEFINED);
    Ok(read.with_centre(input::optional_point("centre", &own)?.unwrap_or(centre)))
}

fn of_scheme(name: &str, budget: usize) -> Option<Plan> {
    Some(match name {
        "support" => Plan::support(budget),
        "ensemble" => Plan::ensemble(budget),
        "sum" => Plan::sum(budget),
        "farthest-point" => Plan::farthest_point(budget),
        "pseudo-coverage" => Plan::pseudo_coverage(budget),
        "random" => Plan::random(budget),
        _ => Plan::single(input::objective(name)?, budget),
    })
}

/// Whether a plan asks what a view would bring, which poses alone do not tell.
pub fn needs_model(plan: &Plan) -> bool {
    match plan.scheme() {
        Scheme::Random | Scheme::FarthestPoint => false,
        Scheme::Single(_) | Scheme::Ensemble(_) | Scheme::Sum | Scheme::Support => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vantage_core::Objective;

    #[test]
    fn scheme_names_give_their_plans() {
        for (name, plan, needs) in [
            ("support", Plan::support(9), true),
            ("ensemble", Plan::ensemble(9), true),
            ("sum", Plan::sum(9), true),
            ("geometry", Plan::single(Objective::Geometry, 9), true),
            ("random", Plan::random(9), false),
            ("farthest-point", Plan::farthest_point(9), false),
            ("pseudo-coverage", Plan::pseudo_coverage(9), false),
        ] {
            assert_eq!(of_scheme(name, 9), Some(plan), "{name}");
            assert_eq!(needs_model(&plan), needs, "{name}");
        }
        assert_eq!(of_scheme("best", 9), None);
    }
}
