//! A mesh as the objectives see it: areas, centroids, normals, and the geometric complexity of each
//! face.
//!
//! Complexity is `|LoG(n)|` of eq. `obj_Q_1`, taken on the mesh and not on a rendered normal map,
//! where the silhouette dominates. For face j with the faces i that share an edge with it,
//!
//! `LoG(n)_j = sum_i w_ij (n_i - n_j) / sum_i w_ij`, `w_ij = exp(-d_ij^2 / (2 sigma_Q^2))`,
//!
//! where `d_ij` is the distance of the centroids in mean edge lengths and the norm runs over x, y
//! and z. Edges are found on welded vertices; a neighbour wound the other way is turned around
//! first, and a face's own back side is no neighbour.

use vantage_core::Vec3;
use vantage_core::objectives::Face;

use crate::mesh::Mesh;

/// The faces of a normalised mesh, in its order, shape (faces).
///
/// `sigma_q` is the standard deviation of the Gaussian in mean edge lengths.
pub fn faces(mesh: &Mesh, sigma_q: f32) -> Vec<Face> {
    let count = mesh.faces.len();
    let areas: Vec<f64> = (0..count).map(|face| f64::from(mesh.area(face))).collect();
    let total: f64 = areas.iter().sum();
    let centroids: Vec<Vec3> = (0..count).map(|face| mesh.centroid(face)).collect();
    let normals: Vec<Vec3> = (0..count)
        .map(|face| {
            let normal = mesh.normal(face);
            // Loading drops faces without area; what is left may still underflow after scaling.
            if normal.length_squared() > 0.5 { normal } else { Vec3::Z }
        })
        .collect();
    let complexity = laplacian_of_gaussian(mesh, &centroids, &normals, sigma_q);
    let mut faces = Vec::with_capacity(count);
    for (index, complexity) in complexity.into_iter().enumerate() {
        faces.push(Face {
            centroid: centroids[index],
            normal: normals[index],
            area_share: (areas[index] / total) as f32,
            complexity,
        });
    }
    faces
}

/// One side of an edge: the face it bounds, and whether the face runs from the lower vertex up.
struct Side {
    edge: (u32, u32),
    face: u32,
    upward: bool,
}

fn laplacian_of_gaussian(
    mesh: &Mesh,
    centroids: &[Vec3],
    normals: &[Vec3],
    sigma_q: f32,
) -> Vec<f32> {
    let welded = mesh.welded();
    let corners: Vec<[u32; 3]> =
        mesh.faces.iter().map(|face| face.map(|vertex| welded[vertex as usize])).collect();
    let mut sides = Vec::with_capacity(3 * corners.len());
    for (&[a, b, c], face) in corners.iter().zip(0u32..) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let edge = (from.min(to), from.max(to));
            if from != to {
                sides.push(Side { edge, face, upward: from < to });
            }
        }
    }
    sides.sort_unstable_by_key(|side| (side.edge, side.face, side.upward));

    let edges = || sides.chunk_by(|a, b| a.edge == b.edge);
    let lengths = edges().map(|sides| {
        let (from, to) = sides[0].edge;
        f64::from(mesh.positions[from as usize].distance(mesh.positions[to as usize]))
    });
    let mean_edge = lengths.sum::<f64>() / edges().count().max(1) as f64;
    let scale = 1.0 / (2.0 * (f64::from(sigma_q) * mean_edge).powi(2)).max(f64::MIN_POSITIVE);

    // Pairs of neighbours: (face, neighbour, its normal as seen from the face).
    let mut neighbours: Vec<Vec<(u32, Vec3)>> = vec![Vec::new(); corners.len()];
    let same_corners = |a: u32, b: u32| {
        let sorted = |face: u32| {
            let mut corners = corners[face as usize];
            corners.sort_unstable();
            corners
        };
        sorted(a) == sorted(b)
    };
    for sides in edges() {
        for one in sides {
            for other in sides.iter().filter(|other| other.face != one.face) {
                if !same_corners(one.face, other.face) {
                    // Two faces of one surface run along their edge in opposite directions.
                    let turn = if one.upward == other.upward { -1.0 } else { 1.0 };
                    let normal = turn * normals[other.face as usize];
                    neighbours[one.face as usize].push((other.face, normal));
                }
            }
        }
    }

    let log = |(face, around): (usize, &Vec<(u32, Vec3)>)| -> f32 {
        let squared = |other: u32| {
            f64::from(centroids[face].distance_squared(centroids[other as usize])) * scale
        };
        // Relative to the nearest neighbour, so that weights of a coarse mesh do not all underflow.
        let nearest = around.iter().map(|&(other, _)| squared(other)).fold(f64::INFINITY, f64::min);
        let (mut sum, mut weights) = (glam::DVec3::ZERO, 0.0);
        for &(other, normal) in around {
            let weight = (nearest - squared(other)).exp();
            sum += weight * (normal - normals[face]).as_dvec3();
            weights += weight;
        }
        if weights > 0.0 { (sum / weights).length() as f32 } else { 0.0 }
    };
    neighbours.iter().enumerate().map(log).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square in two triangles, with a third folded up along its right edge by an angle.
    fn folded(angle: f32, flip: bool) -> Mesh {
        let tip = Vec3::new(1.0 + angle.cos(), 0.0, angle.sin());
        let mut faces = vec![[0, 1, 2], [0, 2, 3], [1, 4, 2]];
        if flip {
            faces[2] = [1, 2, 4];
        }
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y, tip];
        let face_material = vec![0; faces.len()];
        Mesh { positions, faces, face_material, ..Mesh::default() }
    }

    #[test]
    fn a_flat_surface_has_no_complexity() {
        assert!(faces(&folded(0.0, false), 1.0).iter().all(|face| face.complexity < 1e-6));
    }

    #[test]
    fn a_fold_is_complex_on_both_its_sides_whichever_way_it_is_wound() {
        for flip in [false, true] {
            let faces = faces(&folded(std::f32::consts::FRAC_PI_2, flip), 1.0);
            // The far triangle of the square touches only its coplanar neighbour.
            assert!(faces[1].complexity < 1e-6);
            assert!(faces[0].complexity > 0.3, "{}", faces[0].complexity);
            // The folded face has one neighbour, at a right angle: |n_i - n_j| = sqrt 2.
            assert!((faces[2].complexity - 2f32.sqrt()).abs() < 1e-5);
        }
    }

    #[test]
    fn area_shares_add_up_to_one() {
        let shares: f32 = faces(&folded(0.7, false), 1.0).iter().map(|face| face.area_share).sum();
        assert!((shares - 1.0).abs() < 1e-6);
    }
}
