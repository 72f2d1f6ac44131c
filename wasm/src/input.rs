//! What JavaScript passes, checked: numbers, fields of objects, arrays, poses.

use js_sys::{Float32Array, Reflect, Uint8Array, Uint8ClampedArray, Uint32Array};
use vantage_core::{Objective, Pose, Vec3};
use wasm_bindgen::{JsCast, JsValue};

use crate::Refusal;

/// The most candidates of a pool: far above any capture, far below what a tab's memory holds.
pub const MOST_CANDIDATES: u32 = 1 << 16;

/// Numbers of a pose: the rows of a 3 x 4 matrix.
pub const POSE: usize = 12;

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

/// A whole number of either sign.
pub fn integer(name: &str, value: f64) -> Result<i32, Refusal> {
    if (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value) && value.trunc() == value {
        return Ok(value as i32);
    }
    Err(Refusal::bad_argument(format!("`{name}` must be a whole number, not {value}")))
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
            format!("a pose has 12 numbers, the rows of a 3 x 4 matrix, not {}", numbers.len());
        return Err(Refusal::bad_argument(message));
    };
    Ok(Pose::try_from_rows([[a, b, c, x], [d, e, f, y], [g, h, i, z]])?)
}

/// The 12 numbers of a pose.
pub fn numbers(pose: &Pose) -> [f32; POSE] {
    let [[a, b, c, x], [d, e, f, y], [g, h, i, z]] = pose.rows();
    [a, b, c, x, d, e, f, y, g, h, i, z]
}

/// An objective by its name; `None` where there is none of that name.
pub fn objective(name: &str) -> Option<Objective> {
    Objective::ALL.into_iter().find(|objective| objective.name() == name)
}

/// A field of an object; `None` where it is undefined.
pub fn field(object: &JsValue, name: &str) -> Option<JsValue> {
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

/// A field that must be a text; `None` where it is undefined.
pub fn optional_text(object: &JsValue, name: &str) -> Result<Option<String>, Refusal> {
    let text = |value: JsValue| {
        value.as_string().ok_or_else(|| Refusal::bad_argument(format!("`{name}` must be a text")))
    };
    field(object, name).map(text).transpose()
}

/// A field that must be there and a text.
pub fn text(object: &JsValue, name: &str) -> Result<String, Refusal> {
    optional_text(object, name)?
        .ok_or_else(|| Refusal::bad_argument(format!("`{name}` must be a text")))
}

/// A point as three numbers; `None` where the value is undefined.
pub fn optional_point(name: &str, value: &JsValue) -> Result<Option<Vec3>, Refusal> {
    if value.is_undefined() {
        return Ok(None);
    }
    let at = |place: u32| {
        let value = Reflect::get_u32(value, place).ok().and_then(|value| value.as_f64());
        value.map(|value| value as f32)
    };
    match (at(0), at(1), at(2)) {
        (Some(x), Some(y), Some(z)) => Ok(Some(Vec3::new(x, y, z))),
        _ => Err(Refusal::bad_argument(format!("`{name}` must be three numbers: [x, y, z]"))),
    }
}

/// The bytes of a `Uint8Array` or `Uint8ClampedArray`.
pub fn bytes(name: &str, value: &JsValue) -> Result<Vec<u8>, Refusal> {
    if let Some(array) = value.dyn_ref::<Uint8Array>() {
        return copied(array.length(), |place| array.copy_to(place));
    }
    if let Some(array) = value.dyn_ref::<Uint8ClampedArray>() {
        return copied(array.length(), |place| array.copy_to(place));
    }
    Err(Refusal::bad_argument(format!("`{name}` must be a Uint8Array")))
}

/// The numbers of a `Float32Array`.
pub fn floats(name: &str, value: &JsValue) -> Result<Vec<f32>, Refusal> {
    match value.dyn_ref::<Float32Array>() {
        Some(array) => copied(array.length(), |place| array.copy_to(place)),
        None => Err(Refusal::bad_argument(format!("`{name}` must be a Float32Array"))),
    }
}

/// The numbers of a `Uint32Array`.
pub fn whole_numbers(name: &str, value: &JsValue) -> Result<Vec<u32>, Refusal> {
    match value.dyn_ref::<Uint32Array>() {
        Some(array) => copied(array.length(), |place| array.copy_to(place)),
        None => Err(Refusal::bad_argument(format!("`{name}` must be a Uint32Array"))),
    }
}

/// A pose where one is given.
pub fn optional_pose(name: &str, value: &JsValue) -> Result<Option<Pose>, Refusal> {
    if value.is_undefined() {
        return Ok(None);
    }
    floats(name, value).and_then(|numbers| pose(&numbers)).map(Some)
}

fn copied<T: Copy + Default>(length: u32, copy: impl FnOnce(&mut [T])) -> Result<Vec<T>, Refusal> {
    let mut list = filled(length as usize, T::default())?;
    copy(&mut list);
    Ok(list)
}

/// A list of one value over and over; refused, not aborted, where memory does not suffice.
pub fn filled<T: Clone>(length: usize, value: T) -> Result<Vec<T>, Refusal> {
    let mut list = Vec::new();
    if list.try_reserve_exact(length).is_err() {
        let bytes = length.saturating_mul(size_of::<T>());
        return Err(Refusal::too_large(format!("there is no memory for {bytes} more bytes")));
    }
    list.resize(length, value);
    Ok(list)
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
        assert_eq!(integer("left", -7.0), Ok(-7));
        for value in [0.5, 2_147_483_648.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(integer("left", value).unwrap_err().code(), "bad-argument", "{value}");
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

    #[test]
    fn objectives_go_by_their_names() {
        assert_eq!(objective("texture"), Some(Objective::Texture));
        assert_eq!(objective("Texture"), None);
    }

    #[test]
    fn a_list_that_fits_no_memory_is_refused() {
        assert_eq!(filled(usize::MAX / 8, 0u64).unwrap_err().code(), "too-large");
        assert_eq!(filled(3, 7u8), Ok(vec![7; 3]));
    }
}
