//! Brings a mesh from its file's frame into the world: +Z up, the unit sphere around the origin.

use glam::{DMat4, DVec3, DVec4};
use vantage_core::Vec3;

use super::Mesh;

/// Turns y-up into +Z up, moves the bounding sphere's centre to the origin and scales its radius to 1.
///
/// Gives `world_from_object`, which takes points of the mesh as it was to the mesh as it is now.
/// The sphere is the smallest one around all vertices that a face uses. Deterministic. A mesh
/// without faces or without extent is turned and moved, not scaled.
pub fn normalise(mesh: &mut Mesh) -> DMat4 {
    let turn = |p: DVec3| DVec3::new(p.x, -p.z, p.y);
    let mut is_used = vec![false; mesh.positions.len()];
    for &vertex in mesh.faces.iter().flatten() {
        is_used[vertex as usize] = true;
    }
    let used = mesh.positions.iter().zip(&is_used).filter(|(_, used)| **used);
    let points: Vec<DVec3> = used.map(|(p, _)| turn(p.as_dvec3())).collect();

    let centre = bounding_sphere(&points).centre;
    let radius = points.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let scale = if radius > 0.0 { 1.0 / radius } else { 1.0 };

    for position in &mut mesh.positions {
        *position = ((turn(position.as_dvec3()) - centre) * scale).as_vec3();
    }
    // A rotation: normals turn like points.
    for normal in mesh.normals.iter_mut().flatten() {
        *normal = Vec3::new(normal.x, -normal.z, normal.y);
    }
    let moved = -centre * scale;
    DMat4::from_cols(
        DVec4::new(scale, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, scale, 0.0),
        DVec4::new(0.0, -scale, 0.0, 0.0),
        moved.extend(1.0),
    )
}

#[derive(Clone, Copy, Debug)]
struct Sphere {
    centre: DVec3,
    radius: f64,
}

/// The smallest sphere around the points (up to 1e-9 of its radius); a point for none or one.
///
/// Farthest-point pivoting: keep a support of at most four points and the smallest sphere around
/// it; while some point lies outside, add the farthest one and solve the five-point problem by
/// trying every subset that has the new point on its surface. The radius grows with every step, so
/// no support returns; the bound on steps only guards against rounding.
fn bounding_sphere(points: &[DVec3]) -> Sphere {
    let Some(&first) = points.first() else {
        return Sphere { centre: DVec3::ZERO, radius: 0.0 };
    };
    let mut sphere = Sphere { centre: first, radius: 0.0 };
    let mut support = vec![first];
    for _ in 0..200 {
        let mut farthest = (sphere.radius, first);
        for &point in points {
            let distance = point.distance(sphere.centre);
            if distance > farthest.0 {
                farthest = (distance, point);
            }
        }
        let (distance, point) = farthest;
        if distance <= sphere.radius * (1.0 + 1e-9) {
            break;
        }
        let Some((next, kept)) = smallest_through(point, &support) else { break };
        if next.radius <= sphere.radius {
            break;
        }
        (sphere, support) = (next, kept);
    }
    sphere
}

/// The smallest sphere around `others` and `point` with `point` on its surface, and its support.
fn smallest_through(point: DVec3, others: &[DVec3]) -> Option<(Sphere, Vec<DVec3>)> {
    let mut best: Option<(Sphere, Vec<DVec3>)> = None;
    for subset in 0u32..1 << others.len() {
        if subset.count_ones() > 3 {
            continue;
        }
        let chosen = others.iter().enumerate().filter(|(i, _)| subset >> i & 1 == 1);
        let mut surface: Vec<DVec3> = chosen.map(|(_, p)| *p).collect();
        surface.push(point);
        let Some(sphere) = circumscribed(&surface) else { continue };
        let reach = sphere.radius * (1.0 + 1e-10);
        let holds_all = others.iter().all(|p| p.distance(sphere.centre) <= reach);
        if holds_all && best.as_ref().is_none_or(|(b, _)| sphere.radius < b.radius) {
            best = Some((sphere, surface));
        }
    }
    best
}

/// The smallest sphere with all of one to four points on its surface; `None` where they are
/// affinely dependent.
///
/// With `p_0` as the origin the centre is `Σ λ_i q_i` where `2 q_j · Σ λ_i q_i = |q_j|²`.
fn circumscribed(points: &[DVec3]) -> Option<Sphere> {
    let (&origin, rest) = points.split_first()?;
    let q: Vec<DVec3> = rest.iter().map(|p| *p - origin).collect();
    let n = q.len();
    // Rows of the augmented system, solved by elimination with partial pivoting.
    let mut rows = [[0.0f64; 4]; 3];
    for j in 0..n {
        for i in 0..n {
            rows[j][i] = 2.0 * q[j].dot(q[i]);
        }
        rows[j][3] = q[j].length_squared();
    }
    let largest = rows.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))?;
        rows.swap(column, pivot);
        if rows[column][column].abs() <= 1e-14 * largest {
            return None;
        }
        let pivot = rows[column];
        for (j, row) in rows.iter_mut().enumerate().take(n) {
            if j != column {
                let factor = row[column] / pivot[column];
                for (value, below) in row.iter_mut().zip(&pivot) {
                    *value -= factor * below;
                }
            }
        }
    }
    let mut offset = DVec3::ZERO;
    for i in 0..n {
        offset += q[i] * (rows[i][3] / rows[i][i]);
    }
    Some(Sphere { centre: origin + offset, radius: offset.length() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Material;

    fn mesh_of(positions: Vec<Vec3>) -> Mesh {
        let faces: Vec<[u32; 3]> =
            (0..positions.len() as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
        Mesh {
            face_material: vec![0; faces.len()],
            positions,
            faces,
            materials: vec![Material::plain("grey", [0.5; 3])],
            ..Mesh::default()
        }
    }

    #[test]
    fn the_box_ends_up_in_the_unit_sphere_with_its_top_up() {
        let corners = (0..8).map(|i| {
            let (x, y, z) = ((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32);
            Vec3::new(5.0 + 2.0 * x, 1.0 + 9.0 * y, 3.0 * z)
        });
        let before = mesh_of(corners.collect());
        let mut mesh = before.clone();
        let world_from_object = normalise(&mut mesh);
        let radius = (4.0f32 + 81.0 + 9.0).sqrt() / 2.0;
        for (old, new) in before.positions.iter().zip(&mesh.positions) {
            assert!((new.length() - 1.0).abs() < 1e-6);
            assert_eq!(new.z > 0.0, old.y > 5.0, "the file's +y is up");
            let again = world_from_object.transform_point3(old.as_dvec3()).as_vec3();
            assert!((again - *new).length() < 1e-6);
        }
        assert!((world_from_object.x_axis.x - 1.0 / f64::from(radius)).abs() < 1e-6);
    }

    #[test]
    fn vertices_no_face_uses_do_not_count() {
        let mut mesh = mesh_of(vec![Vec3::ZERO, Vec3::X, Vec3::Y]);
        mesh.positions.push(Vec3::splat(100.0));
        normalise(&mut mesh);
        assert!((mesh.positions[1].length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn no_sphere_is_smaller() {
        // Points on a unit sphere, spread enough that it is their smallest one, and some inside.
        let mut points = Vec::new();
        for i in 0..500u32 {
            let angle = f64::from(i) * 2.399_963;
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 500.0;
            let ring = (1.0 - z * z).sqrt();
            let direction = DVec3::new(ring * angle.cos(), ring * angle.sin(), z);
            points.push(DVec3::new(3.0, -2.0, 1.0) + direction * f64::from(1 + i % 2) * 0.5);
        }
        let sphere = bounding_sphere(&points);
        assert!(points.iter().all(|p| p.distance(sphere.centre) <= sphere.radius * 1.000_001));
        assert!(sphere.centre.distance(DVec3::new(3.0, -2.0, 1.0)) < 0.02);
        assert!(sphere.radius <= 1.0 + 1e-6);
    }

    #[test]
    fn flat_and_repeated_points_have_a_sphere() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0), DVec3::X];
        let sphere = bounding_sphere(&square);
        assert!((sphere.radius - 0.5f64.sqrt()).abs() < 1e-9);
        assert_eq!(bounding_sphere(&[DVec3::ONE; 3]).radius, 0.0);
    }
}
