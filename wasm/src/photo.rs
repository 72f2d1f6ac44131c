//! Photos as JavaScript has them.

use vantage_core::soarnet::{Image, Photo as CorePhoto, Pixels, Window};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::{Refusal, input};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** A photo: bytes row by row from the top, 3, 4 or 1 for each pixel; alpha is not looked at.
 *  `window` is the square that shows the object, in pixels, and may reach over the border; without
 *  it, it is the largest square in the middle. */
export type Photo = {
  pixels: Uint8Array | Uint8ClampedArray; width: number; height: number;
  format: "rgb" | "rgba" | "luma";
  window?: { left: number; top: number; side: number };
};
"#;

/// A photo, copied.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    bytes: Vec<u8>,
    pixels: Pixels,
    width: u32,
    height: u32,
    window: Option<Window>,
}

impl Photo {
    /// The photo that JavaScript describes; `None` where it is undefined.
    pub fn read(photo: &JsValue) -> Result<Option<Self>, Refusal> {
        if photo.is_undefined() {
            return Ok(None);
        }
        let side = |name| -> Result<u32, Refusal> {
            Ok(input::whole(name, input::number(photo, name)?, u32::MAX)? as u32)
        };
        let (width, height) = (side("width")?, side("height")?);
        let format = format_named(&input::text(photo, "format")?)?;
        let window =
            input::field(photo, "window").map(|window| read_window(&window)).transpose()?;
        let pixels = input::field(photo, "pixels").unwrap_or(JsValue::UNDEFINED);
        let bytes = input::bytes("pixels", &pixels)?;
        Self::try_new(bytes, format, width, height, window).map(Some)
    }

    fn try_new(
        bytes: Vec<u8>,
        pixels: Pixels,
        width: u32,
        height: u32,
        window: Option<Window>,
    ) -> Result<Self, Refusal> {
        let photo = Self { bytes, pixels, width, height, window };
        photo.core()?;
        Ok(photo)
    }

    /// As the network takes it.
    pub fn core(&self) -> Result<CorePhoto<'_>, Refusal> {
        let Self { bytes, pixels, width, height, window } = self;
        let image = Image::try_new(*width, *height, *pixels, bytes)?;
        Ok(CorePhoto { image: Some(image), window: *window })
    }
}

fn format_named(name: &str) -> Result<Pixels, Refusal> {
    match name {
        "rgb" => Ok(Pixels::Rgb888),
        "rgba" => Ok(Pixels::Rgba8888),
        "luma" => Ok(Pixels::Luma8),
        other => Err(Refusal::bad_argument(format!(
            "there is no format `{other}`; there are rgb, rgba and luma"
        ))),
    }
}

fn read_window(window: &JsValue) -> Result<Window, Refusal> {
    let left = input::integer("left", input::number(window, "left")?)?;
    let top = input::integer("top", input::number(window, "top")?)?;
    let side = input::whole("side", input::number(window, "side")?, u32::MAX)?;
    Ok(Window::try_new(left, top, side as u32)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_their_names() {
        assert_eq!(format_named("rgba"), Ok(Pixels::Rgba8888));
        assert_eq!(format_named("hsv").unwrap_err().code(), "bad-argument");
    }

    #[test]
    fn a_picture_of_another_size_is_refused() {
        let code = |bytes: &[u8], pixels, width, height| {
            Photo::try_new(bytes.to_vec(), pixels, width, height, None).unwrap_err().code()
        };
        assert_eq!(code(&[0; 11], Pixels::Rgba8888, 3, 1), "bad-photo");
        assert_eq!(code(&[0; 12], Pixels::Rgba8888, u32::MAX, u32::MAX), "bad-photo");
        assert_eq!(code(&[0; 8], Pixels::Rgb888, 3, 1), "bad-photo");
        assert_eq!(code(&[0; 4], Pixels::Luma8, 3, 1), "bad-photo");
        assert_eq!(code(&[], Pixels::Rgba8888, 0, 7), "bad-photo");
        assert!(Photo::try_new(vec![0; 12], Pixels::Rgba8888, 3, 1, None).is_ok());
    }
}
