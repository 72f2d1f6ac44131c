//! Objects to learn from: the 20 classes of SO-NeRF (Lee et al., 2023, from Objaverse), made here,
//! and shapes of no class.
//!
//! A seed varies shape, proportions, parts, patterns, colours and which way an object stands, and
//! means the same object everywhere. They are coarser than those of [`builtin`](super::builtin) and
//! quick to make, because a data set needs hundreds.

use vantage_core::{Quat, Vec3};

use self::maker::Maker;
use super::Mesh;
use super::kit::Chance;
use super::shapes::TURN;

mod freeform;
mod furniture;
mod gear;
mod implicit;
mod larger;
mod maker;
mod paint;
mod parts;
mod toys;
mod turned;

/// How objects of a class may lie.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Attitude {
    /// Upright, turned about the vertical.
    Standing,
    /// Mostly so; now and then on any side.
    Lying,
    /// Any way round.
    Any,
}

use Attitude::{Any, Lying, Standing};

type Entry = (fn(&mut Maker), Attitude);

/// More triangles than this would only slow a data set down.
const MOST_FACES: usize = 8_000;

/// The names that [`class`] knows: the paper's classes in its order, then `freeform`.
pub const CLASSES: &[&str] = &[
    "bookcase",
    "chair",
    "cone",
    "control",
    "die",
    "earphone",
    "fan",
    "fireplug",
    "fighter_jet",
    "globe",
    "gravestone",
    "guitar",
    "lion",
    "shoe",
    "snowman",
    "soccer_ball",
    "sunglasses",
    "teddy_bear",
    "toilet",
    "vase",
    "freeform",
];

fn entry(name: &str) -> Option<Entry> {
    Some(match name {
        "bookcase" => (furniture::bookcase, Standing),
        "chair" => (furniture::chair, Standing),
        "cone" => (turned::cone, Standing),
        "control" => (gear::control, Lying),
        "die" => (toys::die, Lying),
        "earphone" => (gear::earphone, Lying),
        "fan" => (gear::fan, Standing),
        "fireplug" => (turned::fireplug, Standing),
        "fighter_jet" => (larger::fighter_jet, Lying),
        "globe" => (turned::globe, Standing),
        "gravestone" => (larger::gravestone, Standing),
        "guitar" => (larger::guitar, Lying),
        "lion" => (toys::lion, Standing),
        "shoe" => (gear::shoe, Lying),
        "snowman" => (turned::snowman, Standing),
        "soccer_ball" => (toys::soccer_ball, Standing),
        "sunglasses" => (gear::sunglasses, Lying),
        "teddy_bear" => (toys::teddy_bear, Standing),
        "toilet" => (furniture::toilet, Standing),
        "vase" => (turned::vase, Standing),
        "freeform" => (freeform::freeform, Any),
        _ => return None,
    })
}

/// An object of a class; the seed varies everything about it.
///
/// y-up and of any size, like a loaded one; 500 to 8,000 triangles, uvs and normals for all, pictures
/// of at most 192 pixels. `None` for other names.
pub fn class(name: &str, seed: u64) -> Option<Mesh> {
    let (make, attitude) = entry(name)?;
    let salt = name.bytes().fold(0, |salt: u64, byte| salt.rotate_left(8) ^ u64::from(byte));
    let chance = seed ^ salt.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut mesh = made(make, attitude, chance, 1.0);
    // What came out too fine is made again, the same but coarser.
    for coarse in [0.8, 0.64, 0.5, 0.4] {
        if mesh.faces.len() <= MOST_FACES {
            break;
        }
        mesh = made(make, attitude, chance, coarse);
    }
    Some(mesh)
}

fn made(make: fn(&mut Maker), attitude: Attitude, seed: u64, coarse: f32) -> Mesh {
    let mut maker = Maker::new(Chance::new(seed), coarse);
    make(&mut maker);
    let mut stretch = || maker.between(0.9, 1.12);
    let stretch = Vec3::new(stretch(), stretch(), stretch());
    let yaw = Quat::from_rotation_y(maker.between(0.0, TURN));
    let tumbles = attitude == Any || attitude == Lying && maker.maybe(0.3);
    let tumble = if tumbles {
        let (x, z) = (maker.between(0.0, TURN), maker.between(0.0, TURN));
        Quat::from_rotation_x(x) * Quat::from_rotation_z(z)
    } else {
        Quat::IDENTITY
    };
    maker.finished().stretched(stretch).placed(yaw * tumble, Vec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume that a mesh encloses, positive where it is wound outwards.
    fn volume(mesh: &Mesh) -> f64 {
        let triple = |face| {
            let [a, b, c] = mesh.corners(face).map(|corner| corner.as_dvec3());
            a.cross(b).dot(c)
        };
        (0..mesh.faces.len()).map(triple).sum()
    }

    #[test]
    fn every_class_gives_sound_objects() {
        for name in CLASSES {
            for seed in 0..12 {
                let mesh = class(name, seed).unwrap();
                let faces = mesh.faces.len();
                assert!((500..=MOST_FACES).contains(&faces), "{name} {seed}: {faces} faces");
                assert_eq!(
                    [mesh.uvs.len(), mesh.normals.len(), mesh.face_material.len()],
                    [faces; 3]
                );
                assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name} {seed}");
                assert!((0..faces).all(|face| mesh.normal(face) != Vec3::ZERO));
                for material in mesh.materials.iter().filter_map(|m| m.texture.as_ref()) {
                    assert!(material.image.width() <= 256 && material.image.height() <= 256);
                }
                let agree = (0..faces).filter(|&face| {
                    mesh.normals[face].iter().all(|n| n.dot(mesh.normal(face)) > 0.0)
                });
                let agree = agree.count();
                // Crumpled shapes are not smooth, and their normals only roughly right.
                let most = if *name == "freeform" { 55 } else { 90 };
                assert!(agree * 100 > faces * most, "{name} {seed}: {agree} of {faces} outwards");
                assert!(volume(&mesh) > 0.0, "{name} {seed} is inside out");
            }
        }
        assert!(class("teapot", 0).is_none());
    }

    #[test]
    fn a_seed_means_one_object() {
        for name in CLASSES {
            assert!(class(name, 5) == class(name, 5), "{name}");
            assert!(class(name, 5) != class(name, 6), "{name}");
        }
    }
}
