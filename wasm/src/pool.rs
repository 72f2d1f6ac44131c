//! Candidate views.

use vantage_core::candidates::{Pool as CorePool, ViewSpace};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::{Refusal, input};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** From where a camera may look at the object; elevations are above the horizontal plane. */
export type ViewSpace =
  | { kind: "random-sphere"; seed: number }
  | { kind: "fibonacci-sphere" }
  | { kind: "hemisphere"; minElevationRad: number; maxElevationRad: number }
  | { kind: "rings"; rings: number; minElevationRad: number; maxElevationRad: number }
  | { kind: "spiral"; turns: number; minElevationRad: number; maxElevationRad: number };
"#;

/// A numbered set of poses in a view space, all looking at the world's origin.
#[wasm_bindgen]
#[derive(Clone, Copy, Debug)]
pub struct Pool {
    pub(crate) core: CorePool,
}

#[wasm_bindgen]
impl Pool {
    /// `count` views of a space at `radiusM` metres from the origin.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        #[wasm_bindgen(unchecked_param_type = "ViewSpace")] space: &JsValue,
        count: f64,
        #[wasm_bindgen(js_name = radiusM)] radius_m: f32,
    ) -> Result<Pool, Refusal> {
        let count = input::whole("count", count, input::MOST_CANDIDATES)?;
        Ok(Self { core: CorePool::try_new(view_space(space)?, count, radius_m)? })
    }

    /// How many views there are.
    #[wasm_bindgen(getter)]
    pub fn length(&self) -> usize {
        self.core.len()
    }

    /// All poses, shape (length, 3, 4): the rows of `world_from_camera`.
    pub fn poses(&self) -> Vec<f32> {
        self.core.iter().flat_map(|pose| input::numbers(&pose)).collect()
    }
}

fn view_space(space: &JsValue) -> Result<ViewSpace, Refusal> {
    let min = || input::number(space, "minElevationRad").map(|angle| angle as f32);
    let max = || input::number(space, "maxElevationRad").map(|angle| angle as f32);
    Ok(match input::text(space, "kind")?.as_str() {
        "random-sphere" => {
            ViewSpace::RandomSphere { seed: input::seed(input::number(space, "seed")?)? }
        }
        "fibonacci-sphere" => ViewSpace::FibonacciSphere,
        "hemisphere" => {
            ViewSpace::Hemisphere { min_elevation_rad: min()?, max_elevation_rad: max()? }
        }
        "rings" => ViewSpace::Rings {
            rings: input::whole("rings", input::number(space, "rings")?, input::MOST_CANDIDATES)?,
            min_elevation_rad: min()?,
            max_elevation_rad: max()?,
        },
        "spiral" => ViewSpace::Spiral {
            turns: input::number(space, "turns")? as f32,
            min_elevation_rad: min()?,
            max_elevation_rad: max()?,
        },
        other => {
            let message = format!(
                "there is no view space `{other}`; there are random-sphere, fibonacci-sphere, \
                 hemisphere, rings and spiral"
            );
            return Err(Refusal::bad_argument(message));
        }
    })
}
