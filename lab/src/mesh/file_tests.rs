//! Reading files: small ones written here, and what is left of them when they are broken.

use std::path::Path;

use image::{ImageFormat, Rgba, RgbaImage};
use vantage_core::{Vec2, Vec3};

use super::{Format, Loaded, Problem, Wrap, from_bytes, load};

fn png(pixel: [u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = RgbaImage::from_pixel(2, 2, Rgba(pixel));
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A GLB from its JSON and its buffer.
fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut buffer = buffer.to_vec();
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let length = 12 + 8 + json.len() + 8 + buffer.len();
    let mut bytes = b"glTF".to_vec();
    for word in [2, length as u32, json.len() as u32] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// A textured square: four positions and UVs, a strip of indices, a PNG.
fn square() -> (String, Vec<u8>) {
    let mut buffer = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    buffer.extend(floats(&[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]));
    buffer.extend([0u8, 1, 2, 3]);
    let picture = png([9, 99, 199, 255]);
    let size = picture.len();
    buffer.extend(picture);
    let total = buffer.len();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},
        "buffers":[{{"byteLength":{total}}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":32}},
            {{"buffer":0,"byteOffset":80,"byteLength":4}},{{"buffer":0,"byteOffset":84,"byteLength":{size}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"}},
            {{"bufferView":2,"componentType":5121,"count":4,"type":"SCALAR"}}],
        "images":[{{"bufferView":3,"mimeType":"image/png"}}],
        "samplers":[{{"wrapS":33071,"wrapT":33648}}],
        "textures":[{{"source":0,"sampler":0}}],
        "materials":[{{"name":"tile","pbrMetallicRoughness":{{"baseColorFactor":[0.5,1,1,1],
            "baseColorTexture":{{"index":0,"texCoord":1,
                "extensions":{{"KHR_texture_transform":{{"offset":[0.25,0],"scale":[2,1]}}}}}}}}}}],
        "meshes":[{{"primitives":[{{"mode":5,"indices":2,"material":0,
            "attributes":{{"POSITION":0,"TEXCOORD_1":1}}}}]}}],
        "nodes":[{{"children":[1],"translation":[0,0,5]}},{{"mesh":0,"scale":[2,2,2]}}],
        "scenes":[{{"nodes":[0]}}]}}"#
    );
    (json, buffer)
}

fn read(json: &str, buffer: &[u8]) -> Result<Loaded, Problem> {
    from_bytes(&glb(json, buffer), Format::Glb, None)
}

#[test]
fn a_glb_gives_its_surface_and_its_picture() {
    let (json, buffer) = square();
    let Loaded { mesh, warnings } = read(&json, &buffer).unwrap();
    assert_eq!(warnings, [""; 0]);
    assert_eq!(mesh.faces.len(), 2);
    // Scaled, then moved by its parent; both triangles of the strip turn the same way.
    assert!(mesh.positions.contains(&Vec3::new(2.0, 2.0, 5.0)));
    assert_eq!((mesh.normal(0), mesh.normal(1)), (Vec3::Z, Vec3::Z));
    assert_eq!(mesh.uvs[0][0], Vec2::new(0.25, 1.0));
    assert_eq!(mesh.uvs[0][1], Vec2::new(2.25, 1.0));
    assert_eq!(mesh.materials.len(), 1);
    let texture = mesh.materials[0].texture.as_ref().unwrap();
    assert_eq!(texture.image.get_pixel(1, 1).0, [9, 99, 199, 255]);
    assert_eq!(texture.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(mesh.materials[0].base_colour, [0.5, 1.0, 1.0, 1.0]);
}

#[test]
fn a_picture_that_cannot_be_had_is_a_warning() {
    let (json, buffer) = square();
    let outer = json.replace(r#""bufferView":3,"mimeType":"image/png""#, r#""uri":"lost.png""#);
    let mut broken = buffer.clone();
    broken[90..].fill(7);
    for (json, buffer) in [(outer, buffer), (json, broken)] {
        let Loaded { mesh, warnings } = read(&json, &buffer).unwrap();
        assert!(mesh.materials[0].texture.is_none() && mesh.uvs.is_empty());
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].starts_with("the texture of tile is left out ("), "{}", warnings[0]);
    }
}

#[test]
fn quantised_sparse_and_coloured_vertices_are_read() {
    let mut buffer = vec![0u8; 24]; // three positions of u16 at a stride of 8, all zero
    buffer.extend([0, 1, 0, 0]); // sparse indices of u8: two of them
    for value in [127u8, 0, 0, 0, 127, 0] {
        buffer.push(value);
    }
    buffer.extend([0, 0]);
    buffer.extend([255u8, 0, 0, 0, 255, 0, 0, 0, 255]);
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":45}],
        "bufferViews":[{"buffer":0,"byteLength":24,"byteStride":8},{"buffer":0,"byteOffset":25,"byteLength":2},
            {"buffer":0,"byteOffset":28,"byteLength":6},{"buffer":0,"byteOffset":36,"byteLength":9}],
        "accessors":[{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3",
            "sparse":{"count":2,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}}},
            {"bufferView":3,"componentType":5121,"normalized":true,"count":3,"type":"VEC3"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1}}]}],"nodes":[{"mesh":0}]}"#;
    let mesh = read(json, &buffer).unwrap().mesh;
    assert_eq!(mesh.corners(0), [Vec3::Y, Vec3::X, Vec3::ZERO].map(|p| p));
    assert_eq!(mesh.colours, [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]);
}

#[test]
fn wrong_files_say_what_is_wrong() {
    let (json, buffer) = square();
    let problem = |json: &str, buffer: &[u8]| read(json, buffer).unwrap_err();
    assert_eq!(problem(&json.replace("\"mode\":5", "\"mode\":1"), &buffer), Problem::NoFaces);
    let mut infinite = buffer.clone();
    infinite[..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(problem(&json, &infinite), Problem::NotFinite);
    let mut flat = buffer.clone();
    flat[..48].fill(0);
    assert_eq!(problem(&json, &flat), Problem::AllDegenerate(2));
    let mut outside = buffer.clone();
    outside[80] = 4;
    assert!(matches!(problem(&json, &outside), Problem::Corrupt(_)));
    // Counts that would need more memory than there is.
    for count in ["4000000000", "18446744073709551615", "15999999"] {
        let huge = json.replacen("\"count\":4", &format!("\"count\":{count}"), 1);
        assert!(matches!(problem(&huge, &buffer), Problem::Corrupt(_) | Problem::TooLarge(_)));
    }
    let draco = json.replacen('{', r#"{"extensionsRequired":["KHR_draco_mesh_compression"],"#, 1);
    assert!(matches!(problem(&draco, &buffer), Problem::NeedsExtension(_)));
    // A node that is its own grandchild is shown once.
    let cycle = json.replace(r#"{"mesh":0,"#, r#"{"mesh":0,"children":[0],"#);
    assert_eq!(read(&cycle, &buffer).unwrap().mesh.faces.len(), 2);
}

#[test]
fn a_glb_cut_off_anywhere_is_an_error() {
    let (json, buffer) = square();
    let whole = glb(&json, &buffer);
    for length in 0..whole.len() {
        assert!(from_bytes(&whole[..length], Format::Glb, None).is_err(), "{length} bytes");
    }
}

/// Flips bytes of a file again and again; whatever comes of it must be an answer.
fn survives(bytes: &[u8], format: Format, rounds: u64) {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    for round in 0..rounds {
        let mut broken = bytes.to_vec();
        for _ in 0..1 + round % 4 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let at = (state >> 20) as usize % broken.len();
            broken[at] = if round % 2 == 0 { (state >> 8) as u8 } else { b"0-9e/. \n"[at % 8] };
        }
        if let Ok(Loaded { mesh, .. }) = from_bytes(&broken, format, None) {
            assert!(!mesh.faces.is_empty());
            assert!(mesh.positions.iter().all(|p| p.is_finite()));
            assert!(mesh.uvs.is_empty() || mesh.uvs.len() == mesh.faces.len());
        }
    }
}

#[test]
fn flipped_bytes_never_panic() {
    let (json, buffer) = square();
    survives(&glb(&json, &buffer), Format::Glb, 6_000);
    survives(&glb(&json, &buffer)[20..20 + json.len()], Format::Gltf, 500);
    survives(OBJ.as_bytes(), Format::Obj, 6_000);
}

const OBJ: &str = "\
# two quads, one concave polygon
mtllib house.mtl
v 0 0 0 1 0 0
v 2 0 0 1 0 0
v 2 2 0
v 0 2 0
v 1 0.5 0
vt 0 0
vt 1 1
vn 0 0 1
o house
usemtl wall
f 1/1/1 2/2/1 3/2/1 4/1/1
usemtl lost
f -5//1 -4//1 -3//1 \\
  -1//1
";

#[test]
fn an_obj_with_its_library_and_without() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.obj");
    std::fs::write(&path, OBJ).unwrap();
    let Loaded { mesh, warnings } = load(&path).unwrap();
    assert_eq!(mesh.faces.len(), 4);
    assert_eq!(warnings.len(), 3, "library, wall, lost: {warnings:?}");

    std::fs::create_dir(folder.path().join("maps")).unwrap();
    std::fs::write(folder.path().join("maps/brick 1.png"), png([200, 0, 0, 255])).unwrap();
    let library = "newmtl wall\nKd 1 1 1\nmap_Kd -clamp on -s 1 1 1 maps\\brick 1.png\n";
    std::fs::write(folder.path().join("house.mtl"), library).unwrap();
    let Loaded { mesh, warnings } = load(&path).unwrap();
    assert_eq!(warnings, ["material lost is not defined; grey is used"]);
    assert_eq!(mesh.face_material, [1, 1, 0, 0]);
    let texture = mesh.materials[1].texture.as_ref().unwrap();
    assert_eq!(
        (texture.image.get_pixel(0, 0).0, texture.wrap),
        ([200, 0, 0, 255], [Wrap::Clamp; 2])
    );
    // v points up in the file and down here.
    let lowest = mesh.uvs[0].iter().map(|uv| uv.y).fold(f32::MAX, f32::min);
    assert_eq!((lowest, mesh.uvs[0][0].y), (0.0, 1.0));
    // The concave polygon loses none of its area to a wrong diagonal: 2 - 0.5 - 0.5.
    assert!((mesh.area(2) + mesh.area(3) - 1.5).abs() < 1e-6, "{}", mesh.area(2) + mesh.area(3));
    assert!((0..4).all(|face| mesh.normal(face) == Vec3::Z));
    assert!(mesh.colours[0].contains(&[1.0, 0.0, 0.0]) && mesh.colours[0].contains(&[1.0; 3]));
}

#[test]
fn short_and_huge_numbers_in_an_obj_are_errors() {
    for line in
        ["v 1 2", "v 1 2 x", "f 1 2 99", "f 1 2 0", "f 1 2 -9223372036854775808", "f 1/1/1/"]
    {
        let text =
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{line} 3\nf 1 2 3\n").replace("2 3\n", "2\n");
        let problem = from_bytes(text.as_bytes(), Format::Obj, None).unwrap_err();
        assert!(
            matches!(&problem, Problem::Corrupt(how) if how.starts_with("line 4")),
            "{problem:?}"
        );
    }
    assert_eq!(from_bytes(b"hello", Format::Obj, None).unwrap_err(), Problem::NoFaces);
}

#[test]
fn a_gltf_finds_the_files_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let (json, buffer) = square();
    let json = json.replace(r#"{"byteLength":"#, r#"{"uri":"the%20data.bin","byteLength":"#);
    let path = folder.path().join("square.gltf");
    std::fs::write(&path, json).unwrap();
    let sentence = load(&path).unwrap_err().to_string();
    assert!(sentence.contains("the data.bin") && sentence.contains("check that it is complete"));
    std::fs::write(folder.path().join("the data.bin"), &buffer).unwrap();
    assert_eq!(load(&path).unwrap().mesh.faces.len(), 2);
}

#[test]
fn every_error_is_one_sentence_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        load(&path).unwrap_err()
    };
    let errors = [
        load(folder.path().join("nothing.glb")).unwrap_err(),
        load(folder.path()).unwrap_err(),
        file("notes.txt", b"hello"),
        file("empty.glb", b""),
        file("half.glb", b"glTF\x02\0\0\0"),
        file("no.gltf", b"[1, 2"),
        file("no.obj", b"o nothing\n"),
    ];
    let problems: Vec<&Problem> = errors.iter().map(|error| &error.problem).collect();
    assert_eq!(problems[0], &Problem::Missing);
    assert_eq!(problems[2], &Problem::UnknownFormat);
    for error in &errors {
        let text = error.to_string();
        assert!(!text.contains('\n') && text.contains("; "), "{text}");
        assert!(text.starts_with(&Path::display(folder.path()).to_string()), "{text}");
    }
}
