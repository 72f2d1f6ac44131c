//! glTF's materials: base colour, its texture, and which texture coordinates it takes.

use std::sync::Arc;

use gltf::json::Root;
use gltf::json::material::AlphaMode;
use gltf::json::texture::{Info, WrappingMode};
use gltf::json::validation::Checked;
use image::RgbaImage;

use super::accessor::{Buffers, view_bytes};
use super::resource;
use crate::mesh::colour::in_unit;
use crate::mesh::source::{Files, Warnings, decode_image};
use crate::mesh::{Material, Texture, Wrap};

/// A material and the texture coordinates that go with it.
pub(super) struct Surface {
    material: Material,
    /// `n` of TEXCOORD_n; `None` without a texture.
    pub(super) uv_set: Option<u32>,
    /// Rows of the transform of (u, v, 1), shape (2, 3).
    pub(super) uv_rows: [[f32; 3]; 2],
}

/// All materials of a file, with one for primitives that name none at the end.
pub(super) struct Surfaces(Vec<Surface>);

const NO_UV_TRANSFORM: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

impl Surfaces {
    pub(super) fn read(
        root: &Root,
        buffers: &Buffers,
        files: Files<'_>,
        warnings: &mut Warnings,
    ) -> Self {
        let mut images = Images { root, buffers, files, decoded: vec![None; root.images.len()] };
        let mut surfaces = Vec::with_capacity(root.materials.len() + 1);
        for (index, source) in root.materials.iter().enumerate() {
            // Older files describe their colour by this extension instead.
            let specular =
                source.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref());
            let metallic = &source.pbr_metallic_roughness;
            let (factor, info) = match specular {
                Some(pbr) => (pbr.diffuse_factor.0, pbr.diffuse_texture.as_ref()),
                None => (metallic.base_color_factor.0, metallic.base_color_texture.as_ref()),
            };
            let name = source.name.clone().unwrap_or_else(|| format!("material {index}"));
            let texture = info.and_then(|info| match images.texture(info) {
                Ok(texture) => Some(texture),
                Err(why) => {
                    warnings.add(format!(
                        "the texture of {name} is left out ({why}); its base colour is used"
                    ));
                    None
                }
            });
            let mut base_colour = factor.map(in_unit);
            let cutoff = source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
            let alpha_cutoff = match source.alpha_mode {
                Checked::Valid(AlphaMode::Mask) => Some(cutoff),
                // What is nearly transparent in its picture is not there; glass counts as solid.
                Checked::Valid(AlphaMode::Blend) => {
                    base_colour[3] = 1.0;
                    texture.as_ref().map(|_| 0.1)
                }
                _ => None,
            };
            let (uv_set, uv_rows) = match info.filter(|_| texture.is_some()) {
                Some(info) => {
                    let (set, rows) = uv_of(info);
                    (Some(set), rows)
                }
                None => (None, NO_UV_TRANSFORM),
            };
            let material = Material { name, base_colour, texture, alpha_cutoff };
            surfaces.push(Surface { material, uv_set, uv_rows });
        }
        surfaces.push(Surface {
            material: Material::plain("default", [0.8; 3]),
            uv_set: None,
            uv_rows: NO_UV_TRANSFORM,
        });
        Self(surfaces)
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The surface a primitive names and its index; `None` where it is not there.
    pub(super) fn get(&self, material: Option<usize>) -> Option<(u16, &Surface)> {
        let default = self.0.len() - 1;
        let index = match material {
            Some(index) if index >= default => return None,
            Some(index) => index,
            None => default,
        };
        Some((u16::try_from(index).ok()?, self.0.get(index)?))
    }

    pub(super) fn into_materials(self) -> Vec<Material> {
        self.0.into_iter().map(|surface| surface.material).collect()
    }
}

/// The set of texture coordinates and their transform (KHR_texture_transform: scale, then rotate
/// anticlockwise as seen on the picture, then move).
fn uv_of(info: &Info) -> (u32, [[f32; 3]; 2]) {
    let Some(transform) = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref())
    else {
        return (info.tex_coord, NO_UV_TRANSFORM);
    };
    let (sin, cos) = transform.rotation.0.sin_cos();
    let [su, sv] = transform.scale.0;
    let [u, v] = transform.offset.0;
    let rows = [[cos * su, sin * sv, u], [-sin * su, cos * sv, v]];
    (transform.tex_coord.unwrap_or(info.tex_coord), rows)
}

/// Decodes each image once.
struct Images<'a> {
    root: &'a Root,
    buffers: &'a Buffers,
    files: Files<'a>,
    decoded: Vec<Option<Result<Arc<RgbaImage>, String>>>,
}

impl Images<'_> {
    fn texture(&mut self, info: &Info) -> Result<Texture, String> {
        let texture = self.root.textures.get(info.index.value()).ok_or("it is not in the file")?;
        let sampler = texture.sampler.as_ref().and_then(|s| self.root.samplers.get(s.value()));
        let wrap = |mode: &Checked<WrappingMode>| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let wrap = sampler.map_or([Wrap::Repeat; 2], |s| [wrap(&s.wrap_s), wrap(&s.wrap_t)]);
        Ok(Texture { image: self.image(texture.source.value())?, wrap })
    }

    fn image(&mut self, index: usize) -> Result<Arc<RgbaImage>, String> {
        if let Some(Some(known)) = self.decoded.get(index) {
            return known.clone();
        }
        let result = self.decode(index);
        if let Some(slot) = self.decoded.get_mut(index) {
            *slot = Some(result.clone());
        }
        result
    }

    fn decode(&self, index: usize) -> Result<Arc<RgbaImage>, String> {
        let image = self.root.images.get(index).ok_or("its image is in no format that is read")?;
        match (&image.buffer_view, &image.uri) {
            (Some(view), _) => match view_bytes(self.root, self.buffers, view.value()) {
                Ok(bytes) => decode_image(bytes),
                Err(_) => Err("its bytes are not in the file".to_owned()),
            },
            (None, Some(uri)) => decode_image(&resource(uri, self.files)?),
            (None, None) => Err("its image has no data".to_owned()),
        }
    }
}
