//! Candidate views.

use vantage_core::candidates::{Pool as CorePool, ViewSpace};
use vantage_core::{Pose, Vec3};
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

/** A point of the world, metres. */
export type Point = readonly [number, number, number];
"#;

/// A numbered set of candidate poses around an object.
#[wasm_bindgen]
#[derive(Clone, Debug)]
pub struct Pool {
    pub(crate) poses: Vec<Pose>,
    pub(crate) centre: Vec3, // of the object, in world, metres
}

#[wasm_bindgen]
impl Pool {
    /// `count` views of a space at `radiusM` metres from the object's `centre`, which all look at it.
    /// Without a centre it is the world's origin.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        #[wasm_bindgen(unchecked_param_type = "ViewSpace")] space: &JsValue,
        count: f64,
        #[wasm_bindgen(js_name = radiusM)] radius_m: f64,
        #[wasm_bindgen(unchecked_optional_param_type = "Point")] centre: &JsValue,
    ) -> Result<Pool, Refusal> {
        let count = input::whole("count", count, input::MOST_CANDIDATES)?;
        let centre = input::optional_point("centre", centre)?.unwrap_or(Vec3::ZERO);
        Self::of_space(view_space(space)?, count, radius_m as f32, centre)
    }

    /// Views at poses of one's own, shape (n, 3, 4). Without the object's `centre` it is the world's
    /// origin.
    #[wasm_bindgen(js_name = fromPoses)]
    pub fn from_poses(
        #[wasm_bindgen(unchecked_param_type = "Float32Array")] poses: &JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Point")] centre: &JsValue,
    ) -> Result<Pool, Refusal> {
        let centre = input::optional_point("centre", centre)?.unwrap_or(Vec3::ZERO);
        Self::of_numbers(&input::floats("poses", poses)?, centre)
    }

    /// How many views there are.
    #[wasm_bindgen(getter)]
    pub fn length(&self) -> usize {
        self.poses.len()
    }

    /// All poses, shape (length, 3, 4): the rows of `world_from_camera`.
    pub fn poses(&self) -> Vec<f32> {
        self.poses.iter().flat_map(input::numbers).collect()
    }
}

impl Pool {
    fn of_space(
        space: ViewSpace,
        count: usize,
        radius_m: f32,
        centre: Vec3,
    ) -> Result<Self, Refusal> {
        let pool = CorePool::try_new(space, count, radius_m)?.with_target(centre)?;
        Ok(Self { poses: pool.iter().collect(), centre })
    }

    fn of_numbers(numbers: &[f32], centre: Vec3) -> Result<Self, Refusal> {
        let count = numbers.len() / input::POSE;
        if count == 0 || !numbers.len().is_multiple_of(input::POSE) {
            return Err(Refusal::bad_pool(format!(
                "`poses` must hold 12 numbers for each pose, at least one; it holds {}",
                numbers.len()
            )));
        }
        if count > input::MOST_CANDIDATES as usize {
            return Err(Refusal::too_large(format!(
                "{count} candidates are too many: {} at most",
                input::MOST_CANDIDATES
            )));
        }
        if !centre.is_finite() {
            return Err(Refusal::bad_pool("the object's centre must be finite".into()));
        }
        let poses = numbers.chunks_exact(input::POSE).map(input::pose);
        Ok(Self { poses: poses.collect::<Result<_, _>>()?, centre })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_come_back_as_they_were_given() {
        let centre = Vec3::new(0.1, 0.2, 0.3);
        let pool = Pool::of_space(ViewSpace::FibonacciSphere, 20, 2.0, centre).unwrap();
        let again = Pool::of_numbers(&pool.poses(), centre).unwrap();
        assert_eq!(again.length(), 20);
        for (a, b) in pool.poses().iter().zip(again.poses()) {
            assert!((a - b).abs() < 1e-6);
        }
    }

    #[test]
    fn what_are_no_poses_is_refused() {
        let code = |numbers: &[f32]| Pool::of_numbers(numbers, Vec3::ZERO).unwrap_err().code();
        assert_eq!(code(&[]), "bad-pool");
        assert_eq!(code(&[0.0; 13]), "bad-pool");
        assert_eq!(code(&[f32::NAN; 12]), "bad-pose");
        assert_eq!(code(&vec![0.0; 12 * ((1 << 16) + 1)]), "too-large");
    }
}
