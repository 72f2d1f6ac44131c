//! What JavaScript is given: objects and the names in them.

use js_sys::{Float32Array, Object, Reflect};
use vantage_core::planner::{Finish, NextView, Reason, Status};
use vantage_core::{Objective, Pose, Scores};
use wasm_bindgen::JsValue;

use crate::input;

/// An object with these fields; those that are undefined are left out.
pub fn object<const N: usize>(fields: [(&str, JsValue); N]) -> JsValue {
    let object = Object::new();
    for (name, value) in fields {
        if !value.is_undefined() {
            // A fresh object takes every property.
            Reflect::set(&object, &name.into(), &value).ok();
        }
    }
    object.into()
}

/// The 12 numbers of a pose.
pub fn pose(pose: &Pose) -> JsValue {
    Float32Array::from(input::numbers(pose).as_slice()).into()
}

/// A number for each objective.
pub fn scores(scores: &Scores) -> JsValue {
    object(Objective::ALL.map(|objective| (objective.name(), scores.get(objective).into())))
}

/// The next view and why.
pub fn next_view(next: &NextView) -> JsValue {
    let objective = next.objective.map(|objective| objective.name());
    object([
        ("index", (next.index as u32).into()),
        ("pose", pose(&next.pose)),
        ("gain", next.gain.into()),
        ("objective", objective.map_or(JsValue::UNDEFINED, Into::into)),
        ("reason", reason(next.reason).into()),
        ("why", next.reason.to_string().into()),
    ])
}

fn reason(reason: Reason) -> &'static str {
    match reason {
        Reason::Start => "start",
        Reason::Chance => "chance",
        Reason::Farthest => "farthest",
        Reason::Objective(objective) => objective.name(),
        Reason::AllObjectives => "all-objectives",
        Reason::Support => "support",
    }
}

/// Why there is no next view.
pub fn finish(finish: Finish) -> &'static str {
    match finish {
        Finish::BudgetSpent => "budget-spent",
        Finish::GoodEnough => "good-enough",
        Finish::NothingLeft => "nothing-left",
    }
}

/// What has become of a candidate.
pub fn status(status: Status) -> &'static str {
    match status {
        Status::Available => "available",
        Status::Visited => "visited",
        Status::Skipped => "skipped",
        Status::Blocked => "blocked",
    }
}
