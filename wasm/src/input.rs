//! What JavaScript passes, checked: numbers, fields of objects, poses.

use js_sys::Reflect;
use vantage_core::Pose;
use wasm_bindgen::JsValue;

use crate::Refusal;

/// The most candidates of a pool: far above any capture, far below what a tab's memory holds.
pub const MOST_CANDIDATES: u32 = 1 << 16;

/// A whole number from 0 to `most`.
pub fn whole(name: &str, value: f64, most: u32) -> Result<usize, Refusal> {
    // NaN fails the range.
    if (0.0..=f64::from(most)).contains(&value) && value.trunc() == value {
        return Ok(value as usize);
    }
    Err(Refusal::bad_argument(format!(
        "`{name}` must be a whole number from 0 to {most}, not {value}"
    )))
}

/// A seed: any whole number that JavaScript holds exactly.
pub fn seed(value: f64) -> Result<u64, Refusal> {
    const MOST: f64 = ((1u64 << 53) - 1) as f64;
    if (0.0..=MOST).contains(&value) && value.trunc() == value {
        return Ok(value as u64);
    }
    let message = format!("`seed` must be a whole number from 0 to 2^53 - 1, not {value}");
    Err(Refusal::bad_argument(message))
}

/// The poses in a row of numbers, 12 for each: the rows of `world_from_camera`, shape (3, 4).
pub fn pose(numbers: &[f32]) -> Result<Pose, Refusal> {
    let [a, b, c, x, d, e, f, y, g, h, i, z] = *numbers else {
        let message =
            format!("a pose has 12 numbers, the rows of a 3 x 4 matrix, not {}", { numbers.len() });
        return Err(Refusal::bad_argument(message));
    };
    Ok(Pose::try_from_rows([[a, b, c, x], [d, e, f, y], [g, h, i, z]])?)
}

/// The 12 numbers of a pose.
pub fn numbers(pose: &Pose) -> [f32; 12] {
    let [[a, b, c, x], [d, e, f, y], [g, h, i, z]] = pose.rows();
    [a, b, c, x, d, e, f, y, g, h, i, z]
}

/// A field of an object; `None` where it is undefined.
fn field(object: &JsValue, name: &str) -> Option<JsValue> {
    let value = Reflect::get(object, &name.into()).ok()?;
    (!value.is_undefined()).then_some(value)
}

/// A field that must be a number; `None` where it is undefined.
pub fn optional_number(object: &JsValue, name: &str) -> Result<Option<f64>, Refusal> {
    let number = |value: JsValue| {
        value.as_f64().ok_or_else(|| Refusal::bad_argument(format!("`{name}` must be a number")))
    };
    field(object, name).map(number).transpose()
}

/// A field that must be there and a number.
pub fn number(object: &JsValue, name: &str) -> Result<f64, Refusal> {
    optional_number(object, name)?
        .ok_or_else(|| Refusal::bad_argument(format!("`{name}` is missing; it must be a number")))
}

/// A field that must be there and a text.
pub fn text(object: &JsValue, name: &str) -> Result<String, Refusal> {
    field(object, name)
        .and_then(|value| value.as_string())
        .ok_or_else(|| Refusal::bad_argument(format!("`{name}` must be a text")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_numbers_in_range_pass() {
        assert_eq!(whole("count", 7.0, 9), Ok(7));
        for value in [-1.0, 0.5, 10.0, f64::NAN, f64::INFINITY] {
            assert_eq!(whole("count", value, 9).unwrap_err().code(), "bad-argument", "{value}");
        }
        assert_eq!(seed(9_007_199_254_740_991.0), Ok((1 << 53) - 1));
        assert!(seed(-1.0).is_err() && seed(1e300).is_err() && seed(f64::NAN).is_err());
    }

    #[test]
    fn a_pose_survives_the_way_there_and_back() {
        let rows = [1.0, 0.0, 0.0, 3.0, 0.0, 0.0, -1.0, 4.0, 0.0, 1.0, 0.0, 5.0];
        let again = numbers(&pose(&rows).unwrap());
        assert!(again.iter().zip(rows).all(|(a, b)| (a - b).abs() < 1e-6), "{again:?}");
        assert_eq!(pose(&rows[1..]).unwrap_err().code(), "bad-argument");
        assert_eq!(pose(&[0.0; 12]).unwrap_err().code(), "bad-pose");
    }
}
