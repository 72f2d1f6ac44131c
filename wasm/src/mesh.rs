//! What views of a known mesh have shown, exactly.

use core::fmt;

use glam::DVec3;
use self_cell::{MutBorrow, self_cell};
use vantage_core::Vec3;
use vantage_core::objectives::{
    Face, FaceAccount, FaceSet, Ledger, Reading, Scores, Sighting, Surface,
};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::{Refusal, input, output};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Exact scores of the views of a mesh: the share of its surface that was seen, and the mean spread of
 *  the directions from which it was; both 0 to 1. */
export type MeshScores = { coverage: number; diversity: number };
"#;

/// The most faces: a hundred bytes for each.
const MOST_FACES: usize = 1 << 21;

/// Faces, and what is known of each.
struct Store {
    faces: Vec<Face>,
    accounts: Vec<FaceAccount>,
}

self_cell! {
    struct Cell {
        owner: MutBorrow<Store>,

        #[covariant]
        dependent: Ledger,
    }
}

/// Exact coverage and diversity of a known mesh, for captures that are only simulated.
#[wasm_bindgen]
pub struct MeshLedger {
    ledger: Cell,
    faces: usize,
}

impl fmt::Debug for MeshLedger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MeshLedger").field("faces", &self.faces).finish_non_exhaustive()
    }
}

#[wasm_bindgen]
impl MeshLedger {
    /// A mesh of triangles: `positions` of the vertices, shape (n, 3), in world, metres, and `indices`,
    /// shape (m, 3), anticlockwise as seen from outside.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        #[wasm_bindgen(unchecked_param_type = "Float32Array")] positions: &JsValue,
        #[wasm_bindgen(unchecked_param_type = "Uint32Array")] indices: &JsValue,
    ) -> Result<MeshLedger, Refusal> {
        let positions = input::floats("positions", positions)?;
        Self::of_mesh(&positions, &input::whole_numbers("indices", indices)?)
    }

    /// Takes in a picture from `pose`: for each pixel the number of the face it shows, plus 1; 0 where
    /// it shows none.
    pub fn observe(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Float32Array")] pose: &JsValue,
        #[wasm_bindgen(js_name = faceIds, unchecked_param_type = "Uint32Array")] face_ids: &JsValue,
    ) -> Result<(), Refusal> {
        let pose = input::pose(&input::floats("pose", pose)?)?;
        self.see(pose.position(), &input::whole_numbers("faceIds", face_ids)?)
    }

    /// The scores of the pictures so far.
    #[wasm_bindgen(unchecked_return_type = "MeshScores")]
    pub fn scores(&self) -> JsValue {
        let Scores { coverage, diversity, .. } = self.ledger.borrow_dependent().scores();
        output::object([("coverage", coverage.into()), ("diversity", diversity.into())])
    }
}

impl MeshLedger {
    fn of_mesh(positions: &[f32], indices: &[u32]) -> Result<Self, Refusal> {
        let faces = faces(positions, indices)?;
        let count = faces.len();
        let accounts = input::filled(count, FaceAccount::default())?;
        let ledger = Cell::try_new(MutBorrow::new(Store { faces, accounts }), |store| {
            let Store { faces, accounts } = store.borrow_mut();
            let refused = |error: &dyn fmt::Display| Refusal::bad_mesh(error.to_string());
            let surface = Surface::try_new(faces, 0.0).map_err(|error| refused(&error))?;
            Ledger::try_new(surface, Reading::default(), accounts).map_err(|error| refused(&error))
        })?;
        Ok(Self { ledger, faces: count })
    }

    fn see(&mut self, camera: Vec3, face_ids: &[u32]) -> Result<(), Refusal> {
        let mut words = input::filled(FaceSet::words_for(self.faces), 0u32)?;
        for &id in face_ids {
            let Some(face) = id.checked_sub(1).map(|face| face as usize) else { continue };
            match words.get_mut(face / 32) {
                Some(word) if face < self.faces => *word |= 1 << (face % 32),
                _ => {
                    return Err(Refusal::bad_argument(format!(
                        "`faceIds` names face {face}; the mesh has {}",
                        self.faces
                    )));
                }
            }
        }
        let sighting = Sighting {
            faces: FaceSet::new(&words),
            textured: &[],
            textured_background: 0,
            pixels: 0,
        };
        self.ledger.with_dependent_mut(|_, ledger| ledger.add(camera, &sighting));
        Ok(())
    }
}

/// The faces as the ledger needs them. Geometric complexity, which only Q asks for, is left at 0.
fn faces(positions: &[f32], indices: &[u32]) -> Result<Vec<Face>, Refusal> {
    let (vertices, rest) = positions.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(Refusal::bad_mesh(
            "`positions` must hold three numbers for each vertex".into(),
        ));
    }
    let (triangles, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() || triangles.is_empty() {
        return Err(Refusal::bad_mesh(
            "`indices` must hold three vertices for each face, and at least one face".into(),
        ));
    }
    if triangles.len() > MOST_FACES {
        return Err(Refusal::too_large(format!(
            "the mesh has {} faces, {MOST_FACES} at most can be used: simplify it first",
            triangles.len()
        )));
    }
    let none = Face { centroid: Vec3::ZERO, normal: Vec3::Z, area_share: 0.0, complexity: 0.0 };
    let mut faces = input::filled(triangles.len(), none)?;
    let mut areas = input::filled(triangles.len(), 0.0f64)?;
    for ((face, area), triangle) in faces.iter_mut().zip(&mut areas).zip(triangles) {
        let mut corners = [Vec3::ZERO; 3];
        for (corner, &vertex) in corners.iter_mut().zip(triangle) {
            let place = vertices.get(vertex as usize).ok_or_else(|| {
                let count = vertices.len();
                Refusal::bad_mesh(format!("a face names vertex {vertex}; the mesh has {count}"))
            })?;
            *corner = Vec3::from_array(*place);
        }
        let [a, b, c] = corners;
        face.centroid = (a + b + c) / 3.0;
        // In double precision: the square of a small edge underflows a single one.
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let cross: DVec3 = (b - a).cross(c - a);
        let length = cross.length();
        // A face without area keeps any normal: it has no share in anything.
        if length > 0.0 {
            face.normal = (cross / length).as_vec3();
        }
        *area = f64::from((0.5 * length) as f32);
    }
    let total: f64 = areas.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return Err(Refusal::bad_mesh(
            "the mesh has no area, or a number that is not finite".into(),
        ));
    }
    for (face, area) in faces.iter_mut().zip(&areas) {
        face.area_share = (area / total) as f32;
    }
    Ok(faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 1 x 1 x 2, twelve triangles; the first two are its bottom.
    fn cuboid() -> (Vec<f32>, Vec<u32>) {
        let corners = (0..8u32).flat_map(|i| [i & 1, i >> 1 & 1, 2 * (i >> 2)]);
        let positions = corners.map(|c| c as f32).collect();
        let indices = vec![
            0, 2, 1, 1, 2, 3, // bottom
            4, 5, 6, 5, 7, 6, // top
            0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, // front, back
            0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5, // left, right
        ];
        (positions, indices)
    }

    fn code(positions: &[f32], indices: &[u32]) -> &'static str {
        MeshLedger::of_mesh(positions, indices).unwrap_err().code()
    }

    #[test]
    fn coverage_is_the_share_of_area_that_was_seen() {
        let (positions, indices) = cuboid();
        let mut ledger = MeshLedger::of_mesh(&positions, &indices).unwrap();
        let coverage = |ledger: &MeshLedger| ledger.ledger.borrow_dependent().scores().coverage;
        assert_eq!(coverage(&ledger), 0.0);
        ledger.see(Vec3::new(0.5, 0.5, -3.0), &[0, 1, 1, 2]).unwrap();
        assert!((coverage(&ledger) - 0.1).abs() < 1e-6);
        // Seen again, and half of the front.
        ledger.see(Vec3::new(0.5, -3.0, 0.5), &[5, 1, 0]).unwrap();
        assert!((coverage(&ledger) - 0.2).abs() < 1e-6);
    }

    #[test]
    fn the_scores_are_those_of_the_core() {
        let (positions, indices) = cuboid();
        let mut ledger = MeshLedger::of_mesh(&positions, &indices).unwrap();
        let shares = [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0].map(|a| a / 20.0);
        let normals = [Vec3::NEG_Z, Vec3::Z, Vec3::NEG_Y, Vec3::Y, Vec3::NEG_X, Vec3::X];
        let faces: Vec<Face> = (0..12)
            .map(|face| {
                let corners = [0, 1, 2].map(|corner| {
                    let vertex = 3 * indices[3 * face + corner] as usize;
                    Vec3::from_slice(&positions[vertex..vertex + 3])
                });
                Face {
                    centroid: corners.iter().sum::<Vec3>() / 3.0,
                    normal: normals[face / 2],
                    area_share: shares[face],
                    complexity: 0.0,
                }
            })
            .collect();
        let mut accounts = [FaceAccount::default(); 12];
        let surface = Surface::try_new(&faces, 0.0).unwrap();
        let mut expected = Ledger::try_new(surface, Reading::default(), &mut accounts).unwrap();
        for (camera, seen) in [
            (Vec3::new(4.0, 1.0, 2.0), 0b1100_0000_1100u32),
            (Vec3::new(3.0, 3.0, 1.0), 0b1100_1100_0000),
            (Vec3::new(-4.0, 0.5, 3.0), 0b0011_0000_1100),
        ] {
            let ids: Vec<u32> =
                (0..12).filter(|face| seen >> face & 1 == 1).map(|f| f + 1).collect();
            ledger.see(camera, &ids).unwrap();
            let words = [seen];
            expected.add(
                camera,
                &Sighting {
                    faces: FaceSet::new(&words),
                    textured: &[],
                    textured_background: 0,
                    pixels: 0,
                },
            );
        }
        let scores = ledger.ledger.borrow_dependent().scores();
        assert!(scores.diversity > 0.0);
        assert_eq!(scores, expected.scores());
    }

    #[test]
    fn a_face_that_is_not_there_is_refused_and_nothing_changes() {
        let (positions, indices) = cuboid();
        let mut ledger = MeshLedger::of_mesh(&positions, &indices).unwrap();
        for id in [13, 32, 33, u32::MAX] {
            let refused = ledger.see(Vec3::ONE, &[1, id]).unwrap_err();
            assert_eq!(refused.code(), "bad-argument");
        }
        assert_eq!(ledger.ledger.borrow_dependent().views(), 0);
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        let (positions, indices) = cuboid();
        assert_eq!(code(&positions, &[]), "bad-mesh");
        assert_eq!(code(&positions, &indices[1..]), "bad-mesh");
        assert_eq!(code(&positions[1..], &indices), "bad-mesh");
        assert_eq!(code(&positions, &[0, 1, 8]), "bad-mesh");
        assert_eq!(code(&positions, &[0, 0, 1]), "bad-mesh");
        assert_eq!(code(&[f32::NAN; 9], &[0, 1, 2]), "bad-mesh");
        assert_eq!(
            code(&[f32::MAX, 0.0, 0.0, 0.0, f32::MAX, 0.0, 0.0, 0.0, 0.0], &[0, 1, 2]),
            "bad-mesh"
        );
        assert_eq!(code(&positions, &vec![0; 3 * (MOST_FACES + 1)]), "too-large");
    }

    #[test]
    fn a_face_without_area_has_no_share() {
        let (positions, mut indices) = cuboid();
        indices.extend([3, 3, 5]);
        let mut ledger = MeshLedger::of_mesh(&positions, &indices).unwrap();
        ledger.see(Vec3::ONE, &[13]).unwrap();
        assert_eq!(ledger.ledger.borrow_dependent().scores().coverage, 0.0);
    }
}
