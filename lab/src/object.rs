//! The object of a plan: a file, or one made here.

use std::path::Path;

use anyhow::{Result, anyhow, bail};
use glam::DMat4;

use crate::mesh::{self, BUILTIN, Mesh};
use crate::record::Matrix4;

/// An object inside the unit sphere, +Z up.
pub struct Object {
    /// The file's stem, or the built-in object's name.
    pub name: String,
    /// Normalised.
    pub mesh: Mesh,
    /// How it was normalised, shape (4, 4).
    pub world_from_object: Matrix4,
    /// What could not be read as it was meant.
    pub warnings: Vec<String>,
}

impl Object {
    /// The object of a name: a file's path, or a built-in object made from `seed`. No name means
    /// the first built-in one.
    pub fn open(name: Option<&str>, seed: u64) -> Result<Self> {
        let name = name.unwrap_or(BUILTIN[0]);
        let path = Path::new(name);
        let (name, mut mesh, warnings) = if path.exists() {
            if path.is_dir() {
                bail!("{name} is a folder: name a GLB, glTF or OBJ file, or use `compare`");
            }
            let loaded = mesh::load(path).map_err(|error| anyhow!("{error}"))?;
            let stem = path.file_stem().unwrap_or(path.as_os_str());
            (stem.to_string_lossy().into_owned(), loaded.mesh, loaded.warnings)
        } else if let Some(mesh) = mesh::builtin(name, seed) {
            (name.to_owned(), mesh, Vec::new())
        } else {
            bail!(
                "there is no file `{name}` and no built-in object of that name: \
                 name a GLB, glTF or OBJ file, or one of {}",
                BUILTIN.join(", ")
            );
        };
        let world_from_object = rows_of(mesh::normalise(&mut mesh));
        Ok(Self { name, mesh, world_from_object, warnings })
    }
}

fn rows_of(matrix: DMat4) -> Matrix4 {
    matrix.transpose().to_cols_array_2d()
}
