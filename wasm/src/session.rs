//! A capture in progress, for plans that look at poses alone.

use js_sys::{Object, Reflect};
use vantage_core::planner::{Blind, Finish, Plan, Reason, Session as CoreSession, Status};
use vantage_core::record::SnapshotError;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::memory::Growing;
use crate::{Pool, Refusal, input};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** How the next view is chosen: by chance, farthest from all views so far, or the latter after
 *  the extreme views along the axes. */
export type PoseScheme = "random" | "farthest-point" | "pseudo-coverage";

/** A whole plan. `movementCost` in [0, 1] is the share of a gain that half a turn costs. */
export type PosePlan = {
  scheme: PoseScheme; budget: number; seed?: number; movementCost?: number;
};

/** The next view: its number, pose (rows of world_from_camera, 12 numbers), and why. `gainM` is
 *  the distance to the nearest view so far in metres, 0 where chance or the start chose. */
export type NextView = {
  index: number; pose: Float32Array; gainM: number;
  reason: "start" | "chance" | "farthest"; why: string;
};

/** Why there is no next view. */
export type Finish = "budget-spent" | "good-enough" | "nothing-left";

/** What has become of a candidate. */
export type Status = "available" | "visited" | "skipped" | "blocked";

/** Candidates in the order that moves the camera least, and the length of the way. */
export type Tour = { order: Uint32Array; lengthRad: number };
"#;

/// A capture in progress.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Session {
    core: CoreSession<Blind, Growing>,
}

#[wasm_bindgen]
impl Session {
    /// A session over the views of a pool.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        pool: &Pool,
        #[wasm_bindgen(unchecked_param_type = "PosePlan")] plan: &JsValue,
    ) -> Result<Session, Refusal> {
        let plan = read_plan(plan)?;
        let core = CoreSession::try_new(Growing::default(), pool.core.iter(), Blind, plan)?;
        Ok(Self { core })
    }

    /// Where to stand next; undefined when the session is over. Asking again changes nothing.
    #[wasm_bindgen(js_name = nextView, unchecked_return_type = "NextView | undefined")]
    pub fn next_view(&mut self) -> JsValue {
        let Some(next) = self.core.next_view() else { return JsValue::UNDEFINED };
        let is_farthest = next.reason == Reason::Farthest;
        object([
            ("index", (next.index as u32).into()),
            ("pose", js_sys::Float32Array::from(input::numbers(&next.pose).as_slice()).into()),
            ("gainM", if is_farthest { next.gain } else { 0.0 }.into()),
            ("reason", reason_name(next.reason).into()),
            ("why", next.reason.to_string().into()),
        ])
    }

    /// Takes in that candidate `index` was photographed, at `pose` if not exactly at its own.
    pub fn observe(
        &mut self,
        index: f64,
        #[wasm_bindgen(unchecked_optional_param_type = "Float32Array")] pose: Option<Vec<f32>>,
    ) -> Result<(), Refusal> {
        let index = self.index(index)?;
        let pose = match pose {
            Some(numbers) => input::pose(&numbers)?,
            None => *self.core.candidate(index)?.pose(),
        };
        Ok(self.core.observe(index, pose, &())?)
    }

    /// Candidate `index` cannot be reached.
    pub fn block(&mut self, index: f64) -> Result<(), Refusal> {
        let index = self.index(index)?;
        Ok(self.core.block(index)?)
    }

    /// Candidate `index` can be reached after all.
    pub fn unblock(&mut self, index: f64) -> Result<(), Refusal> {
        let index = self.index(index)?;
        Ok(self.core.unblock(index)?)
    }

    /// Not candidate `index` now; perhaps after the next photo.
    pub fn skip(&mut self, index: f64) -> Result<(), Refusal> {
        let index = self.index(index)?;
        Ok(self.core.skip(index)?)
    }

    /// Why there is no next view; undefined while there is one.
    #[wasm_bindgen(unchecked_return_type = "Finish | undefined")]
    pub fn finish(&mut self) -> JsValue {
        self.core.finish().map(finish_name).map_or(JsValue::UNDEFINED, Into::into)
    }

    /// What has become of every candidate, in order.
    #[wasm_bindgen(unchecked_return_type = "Status[]")]
    pub fn statuses(&self) -> Vec<JsValue> {
        self.core.candidates().iter().map(|c| status_name(c.status()).into()).collect()
    }

    /// The candidates that were photographed, in order.
    pub fn views(&self) -> Vec<u32> {
        let views = self.core.views().iter();
        views.filter_map(|view| view.candidate).map(|index| index as u32).collect()
    }

    /// The poses at which photos were really taken, shape (views, 3, 4).
    #[wasm_bindgen(js_name = viewPoses)]
    pub fn view_poses(&self) -> Vec<f32> {
        self.core.views().iter().flat_map(|view| input::numbers(&view.pose)).collect()
    }

    /// All poses of the candidates, shape (candidates, 3, 4).
    pub fn poses(&self) -> Vec<f32> {
        self.core.candidates().iter().flat_map(|c| input::numbers(c.pose())).collect()
    }

    /// How many views the plan asks for.
    #[wasm_bindgen(getter)]
    pub fn budget(&self) -> usize {
        self.core.plan().budget()
    }

    /// Puts candidates into the order that moves the camera least, from the last view on.
    #[wasm_bindgen(unchecked_return_type = "Tour")]
    pub fn tour(&self, indices: Vec<u32>) -> Result<JsValue, Refusal> {
        let mut order: Vec<usize> = indices.into_iter().map(|index| index as usize).collect();
        for index in &order {
            self.core.candidate(*index)?;
        }
        let length_rad = self.core.order_by_travel(&mut order);
        let order: Vec<u32> = order.into_iter().map(|index| index as u32).collect();
        Ok(object([
            ("order", js_sys::Uint32Array::from(order.as_slice()).into()),
            ("lengthRad", length_rad.into()),
        ]))
    }

    /// The session as bytes, to go on after a reload.
    pub fn snapshot(&self) -> Result<Vec<u8>, Refusal> {
        let mut buffer = vec![0; 4096];
        loop {
            match self.core.snapshot(&mut buffer) {
                Ok(length) => {
                    buffer.truncate(length);
                    return Ok(buffer);
                }
                // A candidate or view takes less than 64 bytes, so this ends before 16 MiB.
                Err(SnapshotError::NoRoom) if buffer.len() < 1 << 24 => {
                    buffer.resize(buffer.len() * 2, 0);
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// The session that wrote these bytes.
    pub fn restore(bytes: &[u8]) -> Result<Session, Refusal> {
        Ok(Self { core: CoreSession::restore(Growing::default(), Blind, bytes)? })
    }

    fn index(&self, index: f64) -> Result<usize, Refusal> {
        input::whole("index", index, u32::MAX)
    }
}

fn read_plan(plan: &JsValue) -> Result<Plan, Refusal> {
    let budget = input::whole("budget", input::number(plan, "budget")?, input::MOST_CANDIDATES)?;
    let scheme = input::text(plan, "scheme")?;
    let plan_of = scheme_named(&scheme).ok_or_else(|| {
        Refusal::bad_argument(format!(
            "there is no scheme `{scheme}`; there are random, farthest-point and pseudo-coverage"
        ))
    })?;
    let seed = input::optional_number(plan, "seed")?.map_or(Ok(0), input::seed)?;
    let movement_cost = input::optional_number(plan, "movementCost")?.unwrap_or(0.0) as f32;
    Ok(plan_of(budget).with_seed(seed).with_movement_cost(movement_cost))
}

fn scheme_named(name: &str) -> Option<fn(usize) -> Plan> {
    match name {
        "random" => Some(Plan::random),
        "farthest-point" => Some(Plan::farthest_point),
        "pseudo-coverage" => Some(Plan::pseudo_coverage),
        _ => None,
    }
}

fn finish_name(finish: Finish) -> &'static str {
    match finish {
        Finish::BudgetSpent => "budget-spent",
        Finish::GoodEnough => "good-enough",
        Finish::NothingLeft => "nothing-left",
    }
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Available => "available",
        Status::Visited => "visited",
        Status::Skipped => "skipped",
        Status::Blocked => "blocked",
    }
}

fn reason_name(reason: Reason) -> &'static str {
    match reason {
        Reason::Start => "start",
        Reason::Chance => "chance",
        Reason::Farthest => "farthest",
        // Not for plans that look at poses alone.
        Reason::Objective(objective) => objective.name(),
        Reason::AllObjectives => "all-objectives",
    }
}

pub(crate) fn object<const N: usize>(fields: [(&str, JsValue); N]) -> JsValue {
    let object = Object::new();
    for (name, value) in fields {
        // A fresh object takes every property.
        Reflect::set(&object, &name.into(), &value).ok();
    }
    object.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vantage_core::planner::{Scheme, Start};

    #[test]
    fn scheme_names_give_their_plans() {
        for (name, scheme) in [
            ("random", Scheme::Random),
            ("farthest-point", Scheme::FarthestPoint),
            ("pseudo-coverage", Scheme::FarthestPoint),
        ] {
            assert_eq!(scheme_named(name).unwrap()(9).scheme(), scheme);
        }
        let start = Plan::farthest_point(9).with_start(Start::PseudoCoverage);
        assert_eq!(scheme_named("pseudo-coverage").unwrap()(9), start);
        assert!(scheme_named("ensemble").is_none());
    }
}
