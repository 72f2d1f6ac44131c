//! Refusals: a sentence for people and a code for programs.

use core::convert::Infallible;

use js_sys::{Error, Reflect};
use vantage_core::PoseError;
use vantage_core::candidates::PoolError;
use vantage_core::planner::{ObserveError, PlanError, SessionError};
use vantage_core::record::SnapshotError;
use vantage_core::soarnet::{ImageError, ModelError, PhotoError, SetupError};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen(typescript_custom_section)]
const _: &str = TYPES;

#[allow(dead_code, reason = "the section above is empty on targets other than wasm32")]
const TYPES: &str = r#"
/** The `code` of every `Error` that this package throws. */
export type RefusalCode =
  | "bad-argument" | "bad-pool" | "bad-plan" | "bad-pose" | "bad-photo" | "bad-model" | "bad-mesh"
  | "needs-model" | "needs-photo" | "unknown-candidate" | "too-large"
  | "bad-snapshot" | "other-version" | "other-model";
"#;

/// Why a call was refused; JavaScript sees an `Error` with `code` and `message`.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    code: &'static str,
    message: String,
}

impl Refusal {
    /// An argument that JavaScript passed is not of the kind that is needed.
    pub fn bad_argument(message: String) -> Self {
        Self { code: "bad-argument", message }
    }

    /// Poses or a view space are no candidates.
    pub fn bad_pool(message: String) -> Self {
        Self { code: "bad-pool", message }
    }

    /// Numbers are no mesh.
    pub fn bad_mesh(message: String) -> Self {
        Self { code: "bad-mesh", message }
    }

    /// More than there is room for.
    pub fn too_large(message: String) -> Self {
        Self { code: "too-large", message }
    }

    /// What is asked takes a network.
    pub fn needs_model(message: String) -> Self {
        Self { code: "needs-model", message }
    }

    /// The stable code.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// The sentence.
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl From<Refusal> for JsValue {
    fn from(refusal: Refusal) -> Self {
        let error = Error::new(&refusal.message);
        // A fresh object takes a new property; were it not so, the message would still be there.
        Reflect::set(&error, &"code".into(), &refusal.code.into()).ok();
        error.into()
    }
}

impl From<PoolError> for Refusal {
    fn from(error: PoolError) -> Self {
        Self { code: "bad-pool", message: error.to_string() }
    }
}

impl From<PoseError> for Refusal {
    fn from(error: PoseError) -> Self {
        Self { code: "bad-pose", message: error.to_string() }
    }
}

impl From<PlanError> for Refusal {
    fn from(error: PlanError) -> Self {
        Self { code: "bad-plan", message: error.to_string() }
    }
}

impl From<SessionError> for Refusal {
    fn from(error: SessionError) -> Self {
        let code = match error {
            SessionError::Plan(_) => "bad-plan",
            SessionError::TooManyCandidates { .. } | SessionError::TooManyViews { .. } => {
                "too-large"
            }
            SessionError::UnknownCandidate { .. } => "unknown-candidate",
        };
        Self { code, message: error.to_string() }
    }
}

impl<E: Into<Refusal>> From<ObserveError<E>> for Refusal {
    fn from(error: ObserveError<E>) -> Self {
        match error {
            ObserveError::Session(error) => error.into(),
            ObserveError::Scorer(error) => error.into(),
        }
    }
}

impl From<Infallible> for Refusal {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

impl From<ImageError> for Refusal {
    fn from(error: ImageError) -> Self {
        Self { code: "bad-photo", message: error.to_string() }
    }
}

impl From<PhotoError> for Refusal {
    fn from(error: PhotoError) -> Self {
        let code = match error {
            PhotoError::NoImage => "needs-photo",
            PhotoError::Image(_) => "bad-photo",
            PhotoError::NoDirection => "bad-pose",
            PhotoError::TooManyViews { .. } => "too-large",
        };
        Self { code, message: error.to_string() }
    }
}

impl From<ModelError> for Refusal {
    fn from(error: ModelError) -> Self {
        Self { code: "bad-model", message: error.to_string() }
    }
}

impl From<SetupError> for Refusal {
    fn from(error: SetupError) -> Self {
        let code = match error {
            SetupError::TooManyCandidates { .. } => "too-large",
            SetupError::NoDirection { .. } => "bad-pose",
        };
        Self { code, message: error.to_string() }
    }
}

impl From<SnapshotError> for Refusal {
    fn from(error: SnapshotError) -> Self {
        let code = match error {
            SnapshotError::Version { .. } => "other-version",
            SnapshotError::TooLarge | SnapshotError::NoRoom => "too-large",
            SnapshotError::OtherScorer => "other-model",
            _ => "bad-snapshot",
        };
        Self { code, message: error.to_string() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_follow_the_kind_of_error_and_messages_the_core() {
        let refusal = Refusal::from(SessionError::Plan(PlanError::ZeroBudget));
        assert_eq!(refusal.code(), "bad-plan");
        assert_eq!(refusal.message(), PlanError::ZeroBudget.to_string());
        let unknown = SessionError::UnknownCandidate { index: 9, candidates: 3 };
        assert_eq!(Refusal::from(unknown).code(), "unknown-candidate");
        assert_eq!(Refusal::from(SnapshotError::Version { got: 7 }).code(), "other-version");
        assert_eq!(Refusal::from(SnapshotError::Checksum).code(), "bad-snapshot");
    }

    #[test]
    fn every_code_is_in_the_typescript_union() {
        for code in [
            Refusal::bad_argument(String::new()).code,
            Refusal::from(PoolError::Empty).code,
            Refusal::from(PoseError::NotFinite).code,
            Refusal::from(PlanError::ZeroBudget).code,
            Refusal::from(ImageError::Empty).code,
            Refusal::from(ModelError::Foreign).code,
            Refusal::bad_mesh(String::new()).code,
            Refusal::needs_model(String::new()).code,
            Refusal::from(PhotoError::NoImage).code,
            Refusal::from(SessionError::TooManyViews { capacity: 1 }).code,
            Refusal::from(SessionError::UnknownCandidate { index: 0, candidates: 0 }).code,
            Refusal::from(SnapshotError::Foreign).code,
            Refusal::from(SnapshotError::Version { got: 2 }).code,
            Refusal::from(SnapshotError::OtherScorer).code,
        ] {
            assert!(TYPES.contains(&format!("\"{code}\"")), "{code}");
        }
    }
}
