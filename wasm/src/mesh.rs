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
