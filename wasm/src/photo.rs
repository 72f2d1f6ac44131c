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
        let format = Format::named(&input::text(photo, "format")?)?;
        let window =
            input::field(photo, "window").map(|window| read_window(&window)).transpose()?;
        let pixels = input::field(photo, "pixels").unwrap_or(JsValue::UNDEFINED);
        let bytes = input::bytes("pixels", &pixels)?;
        Self::try_new(bytes, format, width, height, window).map(Some)
    }

    fn try_new(
        mut bytes: Vec<u8>,
        format: Format,
        width: u32,
        height: u32,
        window: Option<Window>,
    ) -> Result<Self, Refusal> {
        let pixels = match format {
            Format::Luma => Pixels::Luma8,
            Format::Rgb => Pixels::Rgb888,
            Format::Rgba => {
                let expected = u64::from(width) * u64::from(height);
                if bytes.len() as u64 != expected.saturating_mul(4) {
                    return Err(Refusal::bad_photo(format!(
                        "the picture has {} bytes where {width} x {height} pixels of rgba need \
                         {}: check width, height and format",
                        bytes.len(),
                        expected.saturating_mul(4)
                    )));
                }
                without_alpha(&mut bytes);
                Pixels::Rgb888
            }
        };
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Rgb,
    Rgba,
    Luma,
}

impl Format {
    fn named(name: &str) -> Result<Self, Refusal> {
        match name {
            "rgb" => Ok(Self::Rgb),
            "rgba" => Ok(Self::Rgba),
            "luma" => Ok(Self::Luma),
            other => Err(Refusal::bad_argument(format!(
                "there is no format `{other}`; there are rgb, rgba and luma"
            ))),
        }
    }
}

fn read_window(window: &JsValue) -> Result<Window, Refusal> {
    let left = input::integer("left", input::number(window, "left")?)?;
    let top = input::integer("top", input::number(window, "top")?)?;
    let side = input::whole("side", input::number(window, "side")?, u32::MAX)?;
    Ok(Window::try_new(left, top, side as u32)?)
}

/// Leaves the first three bytes of every four.
fn without_alpha(bytes: &mut Vec<u8>) {
    let pixels = bytes.len() / 4;
    for pixel in 1..pixels {
        bytes.copy_within(4 * pixel..4 * pixel + 3, 3 * pixel);
    }
    bytes.truncate(3 * pixels);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(bytes: &[u8], format: Format, width: u32, height: u32) -> &'static str {
        Photo::try_new(bytes.to_vec(), format, width, height, None).unwrap_err().code()
    }

    #[test]
    fn alpha_is_left_out() {
        let rgba = [1, 2, 3, 99, 4, 5, 6, 0, 7, 8, 9, 255];
        let photo = Photo::try_new(rgba.to_vec(), Format::Rgba, 3, 1, None).unwrap();
        let rgb = Photo::try_new((1..=9).collect(), Format::Rgb, 3, 1, None).unwrap();
        assert_eq!(photo, rgb);
    }

    #[test]
    fn a_picture_of_another_size_is_refused() {
        assert_eq!(code(&[0; 11], Format::Rgba, 3, 1), "bad-photo");
        assert_eq!(code(&[0; 12], Format::Rgba, u32::MAX, u32::MAX), "bad-photo");
        assert_eq!(code(&[0; 8], Format::Rgb, 3, 1), "bad-photo");
        assert_eq!(code(&[0; 4], Format::Luma, 3, 1), "bad-photo");
        assert_eq!(code(&[], Format::Rgba, 0, 7), "bad-photo");
        assert_eq!(Format::named("hsv").unwrap_err().code(), "bad-argument");
    }
}
