//! Reads a mesh from a file, whatever the bytes: a clear error, or a mesh that upholds its promises.

use std::fmt;
use std::path::{Path, PathBuf};

use super::source::{Files, Problem, Warnings};
use super::{Mesh, gltf, obj};

/// A mesh and what was not quite right with its file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// As in the file: y-up, in the file's units.
    pub mesh: Mesh,
    /// One sentence for each thing that was left out or replaced.
    pub warnings: Vec<String>,
}

/// The file formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary glTF 2.0.
    Glb,
    /// glTF 2.0 in JSON, with buffers and images beside it or as data URIs.
    Gltf,
    /// Wavefront OBJ, with its MTL beside it.
    Obj,
}

/// Why a file gives no mesh. Its `Display` is one sentence that says what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: Problem,
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match &self.problem {
            Problem::Missing => {
                write!(f, "{path} does not exist; check the path")
            }
            Problem::Unreadable(why) => {
                write!(f, "{path} cannot be read ({why}); check that it is complete and readable")
            }
            Problem::UnknownFormat => {
                write!(f, "{path} is not a mesh that can be read; give a .glb, .gltf or .obj file")
            }
            Problem::Corrupt(how) => {
                write!(f, "{path} is damaged ({how}); download or export it again")
            }
            Problem::NeedsExtension(name) => write!(
                f,
                "{path} needs the glTF extension {name}, which is not supported; \
                 export it again without that extension"
            ),
            Problem::NoFaces => {
                write!(f, "{path} has no triangles; export a mesh with faces")
            }
            Problem::NotFinite => write!(
                f,
                "{path} has a vertex whose coordinates are NaN or infinite; repair the mesh first"
            ),
            Problem::AllDegenerate(count) => write!(
                f,
                "{path} has {count} triangles and none has any area; export a mesh with a surface"
            ),
            Problem::TooLarge(limit) => {
                write!(f, "{path} has more than {limit} triangles or vertices; simplify it first")
            }
        }
    }
}

impl std::error::Error for LoadError {}

/// Loads a GLB, glTF or OBJ file; the content decides before the extension does.
pub fn load(path: impl AsRef<Path>) -> Result<Loaded, LoadError> {
    let path = path.as_ref();
    let fail = |problem| LoadError { path: path.to_owned(), problem };
    let bytes = std::fs::read(path).map_err(|error| {
        fail(match error.kind() {
            std::io::ErrorKind::NotFound => Problem::Missing,
            _ => Problem::Unreadable(error.to_string()),
        })
    })?;
    let format = format_of(path, &bytes).ok_or_else(|| fail(Problem::UnknownFormat))?;
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    from_bytes(&bytes, format, Some(folder)).map_err(fail)
}

/// Loads a mesh from a file's bytes; `folder` is where the files it names are looked for.
///
/// Without a folder no other file is read: textures are missing, outer buffers are an error.
pub fn from_bytes(bytes: &[u8], format: Format, folder: Option<&Path>) -> Result<Loaded, Problem> {
    let mut warnings = Warnings::default();
    let files = Files::new(folder);
    let mesh = match format {
        Format::Glb => gltf::read_glb(bytes, files, &mut warnings)?,
        Format::Gltf => gltf::read_gltf(bytes, files, &mut warnings)?,
        Format::Obj => obj::read(bytes, files, &mut warnings)?,
    };
    let mesh = checked(mesh, &mut warnings)?;
    Ok(Loaded { mesh, warnings: warnings.into_sentences() })
}

fn format_of(path: &Path, bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    match extension.as_str() {
        "glb" => Some(Format::Glb),
        "gltf" => Some(Format::Gltf),
        "obj" => Some(Format::Obj),
        _ => None,
    }
}

/// Refuses what cannot be used, drops faces without area, and closes gaps in the attributes.
fn checked(mut mesh: Mesh, warnings: &mut Warnings) -> Result<Mesh, Problem> {
    let total = mesh.faces.len();
    if total == 0 {
        return Err(Problem::NoFaces);
    }
    for &vertex in mesh.faces.iter().flatten() {
        let Some(position) = mesh.positions.get(vertex as usize) else {
            return Err(Problem::Corrupt(format!(
                "a face names vertex {vertex} of {}",
                mesh.positions.len()
            )));
        };
        if !position.is_finite() {
            return Err(Problem::NotFinite);
        }
    }
    // Vertices that no face uses may be anything in a file, but nobody should meet a NaN later.
    for position in &mut mesh.positions {
        if !position.is_finite() {
            *position = vantage_core::Vec3::ZERO;
        }
    }
    for uv in mesh.uvs.iter_mut().flatten() {
        if !uv.is_finite() {
            *uv = vantage_core::Vec2::ZERO;
        }
    }
    mesh.retain_faces(|mesh, face| mesh.normal(face) != vantage_core::Vec3::ZERO);
    let dropped = total - mesh.faces.len();
    if mesh.faces.is_empty() {
        return Err(Problem::AllDegenerate(total));
    }
    if dropped > 0 {
        warnings.add(format!("{dropped} of {total} triangles have no area and were dropped"));
    }
    // Normals that are missing, or no direction, are the face's own.
    for face in 0..mesh.normals.len() {
        let own = mesh.normal(face);
        for normal in &mut mesh.normals[face] {
            *normal = vantage_core::math::unit(*normal).unwrap_or(own);
        }
    }
    for colour in mesh.colours.iter_mut().flatten().flatten() {
        *colour = super::colour::in_unit(*colour);
    }
    Ok(mesh)
}
