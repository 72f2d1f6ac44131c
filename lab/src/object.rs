//! The object of a plan: a file, or one made here: a built-in object or one of a class.

use std::path::Path;

use anyhow::{Result, anyhow, bail};
use glam::DMat4;

use crate::mesh::{self, BUILTIN, CLASSES, Mesh};
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
    /// The object of a name: a file's path, or a built-in object or one of a class made from
    /// `seed`. No name means the first built-in one; where a built-in object and a class share a
    /// name, `class:NAME` means the class. `NAME:SEED` is made from that seed instead.
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
        } else if let Some(mesh) = made_here(name, seed) {
            (name.to_owned(), mesh, Vec::new())
        } else {
            bail!(
                "there is no file `{name}` and no built-in object of that name: \
                 name a GLB, glTF or OBJ file, one of {}, or of a class: {}",
                BUILTIN.join(", "),
                CLASSES.join(", ")
            );
        };
        let world_from_object = rows_of(mesh::normalise(&mut mesh));
        Ok(Self { name, mesh, world_from_object, warnings })
    }
}

/// A built-in object, or one of a class.
fn made_here(name: &str, seed: u64) -> Option<Mesh> {
    let of_seed = name.rsplit_once(':').and_then(|(name, seed)| Some((name, seed.parse().ok()?)));
    let (name, seed) = of_seed.unwrap_or((name, seed));
    if let Some(class) = name.strip_prefix("class:") {
        return mesh::class(class, seed);
    }
    mesh::builtin(name, seed).or_else(|| mesh::class(name, seed))
}

fn rows_of(matrix: DMat4) -> Matrix4 {
    matrix.transpose().to_cols_array_2d()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_may_carry_its_seed() {
        let same = |a: &str, b: &str, seed: u64| {
            Object::open(Some(a), 0).unwrap().mesh == Object::open(Some(b), seed).unwrap().mesh
        };
        assert!(same("fan:7", "fan", 7));
        assert!(same("class:vase:7", "class:vase", 7));
        assert!(same("vase:7", "vase", 7) && !same("vase:7", "class:vase", 7));
        assert!(Object::open(Some("fan:x"), 0).is_err());
    }
}
