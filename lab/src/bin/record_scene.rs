//! Records a small scene for the same-plan tests: faces and what 64 candidates see of them, as Rust
//! source on standard output. `cargo xtask golden` runs it.

use anyhow::Result;
use vantage_core::Camera;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::Reading;
use vantage_lab::exact::Labelled;
use vantage_lab::mesh;

const CANDIDATES: usize = 64;
const DISTANCE_M: f32 = 3.0;

fn main() -> Result<()> {
    let mut blob = mesh::noisy_blob(320, 5);
    mesh::normalise(&mut blob);
    let pool = Pool::try_new(ViewSpace::RandomSphere { seed: 4 }, CANDIDATES, DISTANCE_M)?;
    let camera = Camera::from_fov(64, 64, 0.7)?;
    let labelled = Labelled::new(&blob, &camera, pool.iter().collect(), Reading::default(), || {});
    let faces = labelled.faces();
    let bits = |x: f32| format!("f32::from_bits({:#010x})", x.to_bits());
    let vector =
        |v: vantage_core::Vec3| format!("Vec3::new({}, {}, {})", bits(v.x), bits(v.y), bits(v.z));

    println!("// Written by the program record_scene of vantage-lab (`cargo xtask golden`).");
    println!("//! A noisy blob of few faces, and what {CANDIDATES} candidates see of it.");
    println!("#![cfg_attr(rustfmt, rustfmt_skip)]");
    println!("#![allow(clippy::unreadable_literal)]");
    println!("use vantage_core::candidates::ViewSpace;");
    println!("use vantage_core::objectives::{{Face, FaceSet, Sighting}};");
    println!("use vantage_core::Vec3;\n");
    println!("pub const FACES: usize = {};", faces.len());
    println!("pub const CANDIDATES: usize = {CANDIDATES};");
    println!("pub const SPACE: ViewSpace = ViewSpace::RandomSphere {{ seed: 4 }};");
    println!("pub const DISTANCE_M: f32 = {DISTANCE_M:?};");
    println!("pub const TEXTURE_LIMIT: f32 = {};\n", bits(labelled.surface()?.texture_total()));
    println!("pub static SURFACE: [Face; FACES] = [");
    for face in faces {
        println!(
            "    Face {{ centroid: {}, normal: {}, area_share: {}, complexity: {} }},",
            vector(face.centroid),
            vector(face.normal),
            bits(face.area_share),
            bits(face.complexity)
        );
    }
    println!("];\n\npub static SIGHTINGS: [Sighting<'static>; CANDIDATES] = [");
    for sighting in labelled.sightings() {
        let mut words = vec![0u32; faces.len().div_ceil(32)];
        sighting.faces.iter().for_each(|face| words[face / 32] |= 1 << (face % 32));
        println!(
            "    Sighting {{ faces: FaceSet::new(&{words:?}), textured: &{:?}, \
             textured_background: {}, pixels: {} }},",
            sighting.textured, sighting.textured_background, sighting.pixels
        );
    }
    println!("];");
    Ok(())
}
