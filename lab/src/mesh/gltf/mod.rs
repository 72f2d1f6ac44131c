//! Reads glTF 2.0, binary or JSON: nodes, skins in their resting pose, meshes and materials.
//!
//! Only the JSON types of the `gltf` crate are used. Its documents refuse files whose textures are
//! missing and panic on counts that lie, so every reference and length is checked here instead.
//! Left out: morph targets, animation, lights, all material properties but the base colour.

use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::json::Root;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use vantage_core::{Vec2, Vec3};

use self::accessor::{Buffers, corrupt, floats, integers};
use self::surface::{Surface, Surfaces};
use super::Mesh;
use super::source::{Files, MAX_ELEMENTS, Problem, Warnings};

mod accessor;
mod surface;

/// Extensions without which a file's surface cannot be had.
const UNREADABLE_EXTENSIONS: [&str; 4] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
];

/// Reads a GLB: a 12-byte header, a JSON chunk, and maybe a chunk of bytes.
pub(super) fn read_glb(
    bytes: &[u8],
    files: Files<'_>,
    warnings: &mut Warnings,
) -> Result<Mesh, Problem> {
    let word = |at: usize| -> Option<u32> {
        Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
    };
    if !bytes.starts_with(b"glTF") {
        return Err(Problem::UnknownFormat);
    }
    if word(4) != Some(2) {
        return Err(corrupt("its glTF version is not 2"));
    }
    let length = word(8).ok_or_else(|| corrupt("its header is cut off"))? as usize;
    if length > bytes.len() {
        let have = bytes.len();
        return Err(Problem::Corrupt(format!("it should have {length} bytes and has {have}")));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while let (Some(size), Some(kind)) = (word(at), word(at + 4)) {
        let start = at + 8;
        let Some(chunk) = bytes.get(start..).and_then(|rest| rest.get(..size as usize)) else {
            return Err(corrupt("a chunk is cut off"));
        };
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {} // the format allows further chunks, to be ignored
        }
        at = start + size as usize;
    }
    read_root(json.ok_or_else(|| corrupt("it has no JSON chunk"))?, binary, files, warnings)
}

/// Reads a glTF file in JSON.
pub(super) fn read_gltf(
    bytes: &[u8],
    files: Files<'_>,
    warnings: &mut Warnings,
) -> Result<Mesh, Problem> {
    read_root(bytes, None, files, warnings)
}

fn read_root(
    json: &[u8],
    binary: Option<&[u8]>,
    files: Files<'_>,
    warnings: &mut Warnings,
) -> Result<Mesh, Problem> {
    let root: Root = gltf::json::deserialize::from_slice(json)
        .map_err(|error| Problem::Corrupt(format!("its JSON is not glTF: {error}")))?;
    for name in &root.extensions_required {
        if UNREADABLE_EXTENSIONS.contains(&name.as_str()) {
            return Err(Problem::NeedsExtension(name.clone()));
        }
    }
    let buffers = read_buffers(&root, binary, files)?;
    let surfaces = Surfaces::read(&root, &buffers, files, warnings);
    if surfaces.len() > usize::from(u16::MAX) {
        return Err(corrupt("it has more than 65,535 materials"));
    }
    let world_from_node = place_nodes(&root);
    let mut mesh = Mesh::default();
    let mut scene = Scene { root: &root, buffers: &buffers, surfaces: &surfaces, warnings };
    if root.nodes.is_empty() {
        for index in 0..root.meshes.len() {
            scene.append_mesh(&mut mesh, index, &Placement::Rigid(DMat4::IDENTITY))?;
        }
    }
    for (node, placed) in root.nodes.iter().zip(&world_from_node) {
        let (Some(index), Some(placed)) = (&node.mesh, placed) else { continue };
        let placement = match &node.skin {
            Some(skin) => scene.skin_placement(skin.value(), &world_from_node, *placed)?,
            None => Placement::Rigid(*placed),
        };
        scene.append_mesh(&mut mesh, index.value(), &placement)?;
    }
    mesh.materials = surfaces.into_materials();
    // The last one is for primitives that name none.
    let last = mesh.materials.len() - 1;
    if last > 0 && mesh.face_material.iter().all(|&material| usize::from(material) != last) {
        mesh.materials.pop();
    }
    Ok(mesh)
}

fn read_buffers(
    root: &Root,
    binary: Option<&[u8]>,
    files: Files<'_>,
) -> Result<Vec<Vec<u8>>, Problem> {
    let read = |(index, buffer): (usize, &gltf::json::Buffer)| match (&buffer.uri, binary) {
        (Some(uri), _) => resource(uri, files)
            .map_err(|why| Problem::Unreadable(format!("its buffer {index}: {why}"))),
        (None, Some(bytes)) if index == 0 => Ok(bytes.to_vec()),
        // Left empty, for whoever uses it to fail: fallback buffers of extensions have no data.
        (None, _) => Ok(Vec::new()),
    };
    root.buffers.iter().enumerate().map(read).collect()
}

/// The bytes behind a URI: base64 data, or a file relative to the mesh's folder.
fn resource(uri: &str, files: Files<'_>) -> Result<Vec<u8>, String> {
    use base64::Engine;
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or("a data URI is not base64")?;
        return base64::engine::general_purpose::STANDARD
            .decode(text.trim())
            .map_err(|error| format!("a data URI is broken: {error}"));
    }
    let name = percent_decoded(uri);
    files.read(&name).or_else(|why| files.read(uri).map_err(|_| format!("{name}: {why}")))
}

/// `%20` and its like as the bytes they stand for.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) if *first == b'%' => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// `object_from_node` of every node that some scene shows; a node is placed once, whatever a
/// broken file's cycles say. Without scenes, every node that is nobody's child is a root.
fn place_nodes(root: &Root) -> Vec<Option<DMat4>> {
    let mut placed = vec![None; root.nodes.len()];
    let mut open: Vec<(usize, DMat4)> = if root.scenes.is_empty() {
        let mut is_child = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
            if let Some(flag) = is_child.get_mut(child.value()) {
                *flag = true;
            }
        }
        (0..root.nodes.len()).filter(|&i| !is_child[i]).map(|i| (i, DMat4::IDENTITY)).collect()
    } else {
        let tops = root.scenes.iter().flat_map(|scene| &scene.nodes);
        tops.map(|node| (node.value(), DMat4::IDENTITY)).collect()
    };
    while let Some((index, object_from_parent)) = open.pop() {
        let Some(node) = root.nodes.get(index) else { continue };
        if placed[index].is_some() {
            continue;
        }
        let object_from_node = object_from_parent * parent_from_node(node);
        placed[index] = Some(object_from_node);
        for child in node.children.iter().flatten() {
            open.push((child.value(), object_from_node));
        }
    }
    placed
}

fn parent_from_node(node: &gltf::json::Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let scale = node.scale.map_or(DVec3::ONE, vector);
    let translation = node.translation.map_or(DVec3::ZERO, vector);
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| {
        let q = DQuat::from_array(q.0.map(f64::from));
        if q.length_squared() > 1e-12 { q.normalize() } else { DQuat::IDENTITY }
    });
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}

/// Where the vertices of a mesh go.
enum Placement {
    Rigid(DMat4),
    /// By the weighted mean of these, one for each joint.
    Skinned(Vec<DMat4>),
}

struct Scene<'a> {
    root: &'a Root,
    buffers: &'a Buffers,
    surfaces: &'a Surfaces,
    warnings: &'a mut Warnings,
}

impl Scene<'_> {
    /// The joints' `object_from_rest`; the node's own place where the skin has none.
    fn skin_placement(
        &mut self,
        skin: usize,
        world_from_node: &[Option<DMat4>],
        node: DMat4,
    ) -> Result<Placement, Problem> {
        let skin = self.root.skins.get(skin).ok_or_else(|| corrupt("a skin is missing"))?;
        let rest = match &skin.inverse_bind_matrices {
            Some(index) => floats::<16>(self.root, self.buffers, index.value())?,
            None => Vec::new(),
        };
        let joints = skin.joints.iter().enumerate().map(|(i, joint)| {
            let placed = world_from_node.get(joint.value()).copied().flatten()?;
            let rest = rest.get(i).map(|m| DMat4::from_cols_array(&m.map(f64::from)));
            Some(placed * rest.unwrap_or(DMat4::IDENTITY))
        });
        Ok(match joints.collect::<Option<Vec<DMat4>>>() {
            Some(joints) => Placement::Skinned(joints),
            None => {
                self.warnings.add("a skin's joints are not in the scene; it is ignored".to_owned());
                Placement::Rigid(node)
            }
        })
    }

    fn append_mesh(
        &mut self,
        mesh: &mut Mesh,
        index: usize,
        placement: &Placement,
    ) -> Result<(), Problem> {
        let source = self.root.meshes.get(index).ok_or_else(|| corrupt("a mesh is missing"))?;
        for primitive in &source.primitives {
            if let Some(part) = self.part(primitive, placement)? {
                mesh.append(part);
            }
            if mesh.faces.len() > MAX_ELEMENTS || mesh.positions.len() > MAX_ELEMENTS {
                return Err(Problem::TooLarge(MAX_ELEMENTS));
            }
        }
        Ok(())
    }

    /// One primitive as a mesh without materials; `None` where it has no triangles.
    fn part(
        &mut self,
        primitive: &Primitive,
        placement: &Placement,
    ) -> Result<Option<Mesh>, Problem> {
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic));
        let Some(position_index) = attribute(Semantic::Positions) else {
            self.warnings.add("a primitive without positions was skipped".to_owned());
            return Ok(None);
        };
        let mode = match &primitive.mode {
            Checked::Valid(mode) => *mode,
            Checked::Invalid => return Err(corrupt("a primitive's mode is unknown")),
        };
        if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.warnings.add("points and lines were skipped: only triangles are used".to_owned());
            return Ok(None);
        }
        let (root, buffers) = (self.root, self.buffers);
        let positions: Vec<[f32; 3]> = floats(root, buffers, position_index.value())?;
        let sequence: Vec<u32> = match &primitive.indices {
            Some(index) => integers::<1>(root, buffers, index.value())?.into_flattened(),
            None => (0..positions.len() as u32).collect(),
        };
        let mut faces = triangles(mode, &sequence);
        let count = positions.len();
        if let Some(vertex) = faces.iter().flatten().find(|vertex| **vertex as usize >= count) {
            return Err(Problem::Corrupt(format!("a face names vertex {vertex} of {count}")));
        }

        let material = primitive.material.as_ref().map(|index| index.value());
        let (material, surface) = self
            .surfaces
            .get(material)
            .ok_or_else(|| corrupt("a primitive's material is missing"))?;
        let uvs = match surface.uv_set.and_then(|set| attribute(Semantic::TexCoords(set))) {
            Some(index) => floats::<2>(root, buffers, index.value())?,
            None => Vec::new(),
        };
        let normals = match attribute(Semantic::Normals) {
            Some(index) => floats::<3>(root, buffers, index.value())?,
            None => Vec::new(),
        };
        let colours = match attribute(Semantic::Colors(0)) {
            Some(index) => floats::<3>(root, buffers, index.value())?,
            None => Vec::new(),
        };
        for (length, name) in
            [(uvs.len(), "TEXCOORD"), (normals.len(), "NORMAL"), (colours.len(), "COLOR")]
        {
            if length != 0 && length < count {
                return Err(Problem::Corrupt(format!("{name} has {length} of {count} vertices")));
            }
        }
        let places = match placement {
            Placement::Rigid(matrix) => Places::Same(*matrix),
            Placement::Skinned(joints) => {
                let both = (attribute(Semantic::Joints(0)), attribute(Semantic::Weights(0)));
                match both {
                    (Some(which), Some(weights)) => Places::Blended(blend(
                        joints,
                        &integers(root, buffers, which.value())?,
                        &floats(root, buffers, weights.value())?,
                    )),
                    _ => Places::Same(DMat4::IDENTITY),
                }
            }
        };
        if let Places::Same(matrix) = &places
            && matrix.determinant() < 0.0
        {
            // A mirrored copy: keep its outside outside.
            for face in &mut faces {
                face.swap(1, 2);
            }
        }

        let mut part = Mesh { face_material: vec![material; faces.len()], ..Mesh::default() };
        // Primitives often share one large set of vertices; take only those used here.
        let mut new_index = vec![u32::MAX; count];
        for face in &faces {
            part.faces.push(face.map(|vertex| {
                let slot = &mut new_index[vertex as usize];
                if *slot == u32::MAX {
                    *slot = part.positions.len() as u32;
                    let point = DVec3::from_array(positions[vertex as usize].map(f64::from));
                    let matrix = places.of(vertex);
                    part.positions.push(matrix.transform_point3(point).as_vec3());
                }
                *slot
            }));
        }
        if !uvs.is_empty() {
            let uv_of = |vertex: u32| surface.uv(Vec2::from_array(uvs[vertex as usize]));
            part.uvs = faces.iter().map(|face| face.map(uv_of)).collect();
        }
        if !normals.is_empty() {
            let normal_of = |vertex: u32| places.turned(vertex, normals[vertex as usize]);
            part.normals = faces.iter().map(|face| face.map(normal_of)).collect();
        }
        if !colours.is_empty() {
            let colour_of = |vertex: u32| colours[vertex as usize];
            part.colours = faces.iter().map(|face| face.map(colour_of)).collect();
        }
        Ok(Some(part))
    }
}

/// `object_from_vertex` of a primitive.
enum Places {
    Same(DMat4),
    Blended(Vec<DMat4>),
}

impl Places {
    fn of(&self, vertex: u32) -> DMat4 {
        match self {
            Self::Same(matrix) => *matrix,
            Self::Blended(matrices) => {
                matrices.get(vertex as usize).copied().unwrap_or(DMat4::IDENTITY)
            }
        }
    }

    /// A normal goes with the inverse transpose; zero where that is no direction.
    fn turned(&self, vertex: u32, normal: [f32; 3]) -> Vec3 {
        let linear = DMat3::from_mat4(self.of(vertex));
        // The cofactor matrix is the inverse transpose times the determinant, and always exists.
        let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
        let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
        let turned = cofactors * DVec3::from_array(normal.map(f64::from));
        turned.normalize_or_zero().as_vec3()
    }
}

/// Each vertex's weighted mean of its four joints' matrices; joints that are not there weigh nothing.
fn blend(joints: &[DMat4], which: &[[u32; 4]], weights: &[[f32; 4]]) -> Vec<DMat4> {
    let blended = which.iter().zip(weights).map(|(which, weights)| {
        let (mut sum, mut total) = (DMat4::ZERO, 0.0);
        for (&joint, &weight) in which.iter().zip(weights) {
            if let Some(matrix) = joints.get(joint as usize) {
                sum += *matrix * f64::from(weight);
                total += f64::from(weight);
            }
        }
        if total > 1e-6 { sum * (1.0 / total) } else { DMat4::IDENTITY }
    });
    blended.collect()
}

/// The triangles of a list, strip or fan; every second one of a strip turns the other way round.
fn triangles(mode: Mode, sequence: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let windows = sequence.windows(3).enumerate();
            windows
                .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
                .collect()
        }
        Mode::TriangleFan => match sequence.split_first() {
            Some((hub, rim)) => rim.windows(2).map(|w| [*hub, w[0], w[1]]).collect(),
            None => Vec::new(),
        },
        _ => sequence.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
    }
}

impl Surface {
    /// A texture coordinate after the material's own transform of it.
    fn uv(&self, uv: Vec2) -> Vec2 {
        let [u, v] = self.uv_rows;
        Vec2::new(u[0] * uv.x + u[1] * uv.y + u[2], v[0] * uv.x + v[1] * uv.y + v[2])
    }
}
