//! Makes a data set, or the rest of one.

use std::fs;
use std::path::Path;

use rayon::prelude::*;

use super::error::DatasetError;
use super::manifest::{Entry, MANIFEST, Manifest, Parameters, SourceFile, shard_name};
use super::{hex, make, read_at_most, shard, write_whole};
use crate::mesh;

/// What a run has done.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The manifest as written.
    pub manifest: Manifest,
    /// Shards that were there already, whole.
    pub kept: usize,
    /// The sum of all shards' lengths in bytes.
    pub bytes: u64,
}

/// Writes a data set into `dir`, or completes the one that is there, on rayon's threads.
///
/// `from` is the folder of `parameters.files`. `done` is called after each object.
pub fn write(
    dir: &Path,
    from: Option<&Path>,
    parameters: &Parameters,
    done: impl Fn() + Sync,
) -> Result<Written, DatasetError> {
    parameters.check().map_err(DatasetError::BadParameter)?;
    let mut manifest = begin(dir, parameters)?;
    let fingerprint = parameters.fingerprint();
    let made: Result<Vec<(Entry, bool)>, DatasetError> = (0..parameters.objects as u32)
        .into_par_iter()
        .map(|number| {
            let tag = shard::Tag { fingerprint, number };
            let made = one(dir, from, parameters, tag)?;
            done();
            Ok(made)
        })
        .collect();
    let made = made?;
    let kept = made.iter().filter(|(_, kept)| *kept).count();
    manifest.objects = made.into_iter().map(|(entry, _)| entry).collect();
    manifest.write(dir)?;
    let bytes = manifest.objects.iter().map(|entry| entry.bytes).sum();
    Ok(Written { manifest, kept, bytes })
}

/// Opens the folder: a new one, or one with the same parameters.
fn begin(dir: &Path, parameters: &Parameters) -> Result<Manifest, DatasetError> {
    let occupied = |why: &str| DatasetError::Occupied { path: dir.to_owned(), why: why.to_owned() };
    if dir.exists() && !dir.is_dir() {
        return Err(occupied("is a file"));
    }
    let objects = dir.join("objects");
    if dir.join(MANIFEST).exists() {
        let found = Manifest::read(dir)?;
        if found.parameters != *parameters {
            return Err(occupied("holds a data set of other parameters"));
        }
        if found.generator != Manifest::unfinished(parameters.clone()).generator {
            return Err(occupied("holds a data set that another version made"));
        }
    } else if fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(occupied("is not empty"));
    }
    fs::create_dir_all(&objects).map_err(|error| DatasetError::io("create", &objects, error))?;
    let manifest = Manifest::unfinished(parameters.clone());
    if !dir.join(MANIFEST).exists() {
        manifest.write(dir)?;
    }
    Ok(manifest)
}

/// One object's shard, unless it is there; its entry, and whether it was there.
fn one(
    dir: &Path,
    from: Option<&Path>,
    parameters: &Parameters,
    tag: shard::Tag,
) -> Result<(Entry, bool), DatasetError> {
    let assignment = parameters.assignment(tag.number);
    let shard_name = shard_name(tag.number);
    let path = dir.join(&shard_name);
    let entry = |faces: usize, bytes: &[u8]| Entry {
        number: tag.number,
        name: assignment.name.clone(),
        class: assignment.class.clone(),
        seed: assignment.seed,
        split: assignment.split,
        faces,
        shard: shard_name.clone(),
        bytes: bytes.len() as u64,
        crc32: hex(shard::checksum(bytes)),
    };
    if path.exists() {
        // What does not check is made again.
        let bytes = read_at_most(&path, 1 << 30)?;
        if let Ok(data) = shard::decode(&bytes, parameters.image_size, tag) {
            return Ok((entry(data.faces.len(), &bytes), true));
        }
    }
    let bad = |why: String| DatasetError::BadObject { name: assignment.name.clone(), why };
    let mesh = match (from, parameters.files.get(tag.number as usize)) {
        (Some(from), Some(file)) => {
            let loaded = mesh::load(from.join(&file.name));
            loaded
                .map_err(|error| DatasetError::BadObject {
                    name: file.name.clone(),
                    why: error.to_string(),
                })?
                .mesh
        }
        _ => mesh::class(&assignment.class, assignment.seed)
            .ok_or_else(|| bad("there is no such class".to_owned()))?,
    };
    let (name, class) = (assignment.name.clone(), assignment.class.clone());
    let data = make::object(name, class, mesh, assignment.seed, parameters)
        .map_err(|error| bad(format!("{error:#}")))?;
    let bytes = shard::encode(&data, parameters.image_size, tag);
    write_whole(&path, &bytes)?;
    Ok((entry(data.faces.len(), &bytes), false))
}

/// The meshes of a folder (GLB, glTF, OBJ) by name; subfolders are not looked into.
pub fn files_of(folder: &Path) -> Result<Vec<SourceFile>, DatasetError> {
    let read = || {
        let mut files = Vec::new();
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let Ok(name) = entry.file_name().into_string() else { continue };
            let extension = Path::new(&name).extension().map(|e| e.to_ascii_lowercase());
            let is_mesh = extension.is_some_and(|e| e == "glb" || e == "gltf" || e == "obj");
            let found = fs::metadata(entry.path())?;
            if is_mesh && found.is_file() {
                files.push(SourceFile { name, bytes: found.len() });
            }
        }
        files.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(files)
    };
    read().map_err(|error| DatasetError::io("read", folder, error))
}
