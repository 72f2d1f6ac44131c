//! Objects made here, for when no file is named: textured, detailed, the same for the same seed.

use super::Mesh;

mod furniture;
mod round;

/// The names that [`builtin`] knows; the first is the default.
pub const BUILTIN: &[&str] = &["shelf", "chair", "vase", "knot", "blob", "ball"];

/// An object by its name; the seed varies proportions, textures and colours.
///
/// y-up and of any size, like a loaded one; 2,000 to 20,000 triangles. `None` for other names.
pub fn builtin(name: &str, seed: u64) -> Option<Mesh> {
    Some(match name {
        "shelf" => furniture::shelf(seed),
        "chair" => furniture::chair(seed),
        "vase" => round::vase(seed),
        "knot" => round::knot(seed),
        "blob" => noisy_blob(9_600, seed),
        "ball" => round::ball(seed),
        _ => return None,
    })
}

/// A lumpy sphere of about that many triangles (within 15 % from 1,000 on), for measurements.
pub fn noisy_blob(triangles: usize, seed: u64) -> Mesh {
    round::blob(triangles, seed)
}

#[cfg(test)]
mod tests {
    use vantage_core::Vec3;

    use super::*;

    #[test]
    fn every_name_gives_a_sound_textured_object() {
        for name in BUILTIN {
            for seed in 0..4 {
                let mesh = builtin(name, seed).unwrap();
                let faces = mesh.faces.len();
                assert!((2_000..=20_000).contains(&faces), "{name} {seed}: {faces} faces");
                assert_eq!(
                    [mesh.uvs.len(), mesh.normals.len(), mesh.face_material.len()],
                    [faces; 3]
                );
                assert!(mesh.positions.iter().all(|p| p.is_finite()));
                assert!((0..faces).all(|face| mesh.normal(face) != Vec3::ZERO));
                assert!(mesh.materials.iter().all(|m| m.texture.is_some()), "{name}");
                let agree = (0..faces).filter(|&face| {
                    mesh.normals[face].iter().all(|n| n.dot(mesh.normal(face)) > 0.0)
                });
                let agree = agree.count();
                assert!(agree * 100 > faces * 97, "{name} {seed}: {agree} of {faces} outwards");
            }
        }
        assert!(builtin("teapot", 0).is_none());
    }

    #[test]
    fn a_seed_means_one_object() {
        for name in BUILTIN {
            assert!(builtin(name, 5) == builtin(name, 5), "{name}");
            assert!(builtin(name, 5) != builtin(name, 6), "{name}");
        }
    }

    #[test]
    fn a_blob_has_about_the_triangles_asked_for() {
        for triangles in [1_000, 5_000, 100_000] {
            let got = noisy_blob(triangles, 1).faces.len();
            assert!(got.abs_diff(triangles) * 100 < triangles * 15, "{got} for {triangles}");
        }
    }
}
