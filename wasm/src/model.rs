//! A network's file.

use std::rc::Rc;

use js_sys::{Function, Reflect};
use vantage_core::soarnet::Model as CoreModel;
use wasm_bindgen::convert::TryFromJsValue;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsCast, JsValue};

use crate::{Refusal, input};

/// A SOARNet model, read from the bytes of its file. Sessions share it; it may be freed before them.
#[wasm_bindgen]
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) bytes: Rc<Vec<u8>>,
    checksum: u32,
    sees: bool,
}

#[wasm_bindgen]
impl Model {
    /// Copies and checks the bytes of a model file.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        #[wasm_bindgen(unchecked_param_type = "Uint8Array")] bytes: &JsValue,
    ) -> Result<Model, Refusal> {
        Self::from_bytes(input::bytes("bytes", bytes)?)
    }

    /// Tells models apart: the CRC-32 of the file.
    #[wasm_bindgen(getter)]
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// Whether it looks at photos, not at poses alone.
    #[wasm_bindgen(getter, js_name = seesPhotos)]
    pub fn sees_photos(&self) -> bool {
        self.sees
    }

    /// Another handle to the same model, to be freed on its own.
    pub fn share(&self) -> Model {
        self.clone()
    }
}

impl Model {
    /// A model that a caller may leave out. Bindings of structs have no optional references, only
    /// optional values, which would take the model away from its owner.
    pub(crate) fn read(value: &JsValue) -> Result<Option<Self>, Refusal> {
        if value.is_undefined() {
            return Ok(None);
        }
        let shared = Reflect::get(value, &"share".into())
            .and_then(|share| share.dyn_into::<Function>())
            .and_then(|share| share.call0(value))
            .and_then(Self::try_from_js_value);
        let refused = |_| Refusal::bad_argument("`model` must be a Model that is not freed".into());
        shared.map(Some).map_err(refused)
    }

    fn from_bytes(bytes: Vec<u8>) -> Result<Self, Refusal> {
        let model = CoreModel::parse(&bytes)?;
        let (checksum, sees) = (model.checksum(), model.dimensions().embedding > 0);
        Ok(Self { bytes: Rc::new(bytes), checksum, sees })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The networks that come with the program.
    pub fn shipped() -> [Model; 2] {
        [
            include_bytes!("../../lab/models/soarnet.model").as_slice(),
            include_bytes!("../../lab/models/soarnet-poses.model").as_slice(),
        ]
        .map(|bytes| Model::from_bytes(bytes.to_vec()).unwrap())
    }

    #[test]
    fn the_shipped_models_are_models() {
        let [sees, poses] = shipped();
        assert!(sees.sees_photos() && !poses.sees_photos());
        assert_ne!(sees.checksum(), poses.checksum());
    }

    #[test]
    fn damaged_bytes_are_no_model() {
        let [_, model] = shipped();
        let code = |bytes: &[u8]| Model::from_bytes(bytes.to_vec()).unwrap_err().code();
        assert_eq!(code(&[]), "bad-model");
        assert_eq!(code(&model.bytes[..1000]), "bad-model");
        let mut damaged = (*model.bytes).clone();
        damaged[2000] ^= 1;
        assert_eq!(code(&damaged), "bad-model");
    }
}
