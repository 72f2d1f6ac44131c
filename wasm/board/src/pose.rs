//! Where the camera stands, from tags of a board whose intrinsics are known.
//!
//! A small plane in perspective looks almost the same tilted towards the camera as away from it:
//! its pose has two roots. Both come in closed form from the homography ("infinitesimal plane-based
//! pose estimation", Collins and Bartoli, IJCV 2014, section 4), here from all corners together and
//! from each tag alone. Every root is a guess at the whole board's pose; the one that leaves most
//! corners where they were seen is refined on all of them (Levenberg-Marquardt on the reprojection
//! error, Huber's weights), tags that it does not explain are left out, and so is the best guess on
//! the other side of the ambiguity. When that one fits nearly as well the pose is called ambiguous,
//! and so it is of a single tag.
//!
//! Inside this module the camera has the axes of computer vision: x right, y down, z forward.
//!
//! Not handled: lens distortion, rolling shutter, a board that is not flat.

use core::slice;

use nalgebra::{
    Matrix2, Matrix2x3, Matrix3, Point2, Rotation3, SMatrix, SVector, Vector2, Vector3,
};

use crate::homography;

/// A camera with square pixels and no distortion, in pixels from the frame's upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length.
    pub focal_px: f64,
    /// Principal point from the left edge.
    pub cx: f64,
    /// Principal point from the upper edge.
    pub cy: f64,
}

impl Intrinsics {
    /// A point of the picture on the plane at unit distance before the camera.
    fn normalise(&self, pixel: Point2<f64>) -> Point2<f64> {
        Point2::new((pixel.x - self.cx) / self.focal_px, (pixel.y - self.cy) / self.focal_px)
    }
}

/// The four corners of a tag, on the board (metres) and in the frame (pixels).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Which tag.
    pub id: u32,
    /// On the board, z = 0.
    pub board: [Point2<f64>; 4],
    /// In the frame.
    pub pixels: [Point2<f64>; 4],
}

impl Sighting {
    fn pairs(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + Clone + '_ {
        self.board.iter().copied().zip(self.pixels)
    }
}

/// All pairs of corners of some sightings.
pub(crate) fn pairs(
    sightings: &[Sighting],
) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + Clone + '_ {
    sightings.iter().flat_map(Sighting::pairs)
}

/// `camera_from_board`, with the axes of computer vision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrinsics {
    /// Takes the board's directions to the camera's.
    pub rotation: Rotation3<f64>,
    /// The board's origin in the camera's frame, metres.
    pub translation: Vector3<f64>,
}

impl Extrinsics {
    /// The camera's place in the board's frame, metres.
    pub fn camera_in_board(&self) -> Vector3<f64> {
        -(self.rotation.inverse() * self.translation)
    }

    /// The rows of `world_from_camera` with OpenGL's camera axes, shape (3, 4).
    pub fn world_from_camera(&self) -> [[f64; 4]; 3] {
        let r = self.rotation.matrix().transpose();
        let c = self.camera_in_board();
        core::array::from_fn(|i| [r[(i, 0)], -r[(i, 1)], -r[(i, 2)], c[i]])
    }

    fn camera_from_board(&self, point: Point2<f64>) -> Vector3<f64> {
        self.rotation * Vector3::new(point.x, point.y, 0.0) + self.translation
    }
}

/// A pose with how well it fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The pose.
    pub extrinsics: Extrinsics,
    /// Root mean square of the corners' distances to where the pose puts them, pixels.
    pub rms_px: f64,
    /// Whether another pose fits nearly as well, or a single tag is all there is.
    pub is_ambiguous: bool,
    /// The tags that the pose explains.
    pub inliers: Vec<Sighting>,
}

/// Corners that are off by more than this many pixels tell of a wrong pose or a wrong tag.
const FAR_OFF_PX: f64 = 4.0;

/// Guesses that are followed up, the likeliest first, while some tags remain unexplained.
const MOST_GUESSES: usize = 8;

/// Distances up to this many pixels count squared, larger ones linearly (Huber).
const HUBER_PX: f64 = 1.0;

/// Standard deviation of a corner in a steady frame, pixels: what a better fit is measured by.
const CORNER_SIGMA_PX: f64 = 0.2;

/// The pose that explains the most tags; `None` if none explains any.
pub fn estimate(sightings: &[Sighting], intrinsics: &Intrinsics) -> Option<Estimate> {
    let mut guesses = roots(sightings, intrinsics);
    if sightings.len() > 1 {
        guesses.extend(sightings.iter().flat_map(|tag| roots(slice::from_ref(tag), intrinsics)));
    }
    let mut scored: Vec<(f64, Extrinsics)> = guesses
        .into_iter()
        .filter(is_in_front)
        .map(|guess| (truncated_error(sightings, intrinsics, &guess, 4.0 * FAR_OFF_PX), guess))
        .collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut explained: Option<(f64, Extrinsics, Vec<Sighting>)> = None;
    for (_, guess) in scored.iter().take(MOST_GUESSES) {
        let Some((pose, inliers)) = narrow_down(sightings, intrinsics, guess) else { continue };
        let error = truncated_error(sightings, intrinsics, &pose, FAR_OFF_PX);
        let has_all = inliers.len() == sightings.len();
        if explained.as_ref().is_none_or(|(least, ..)| error < *least) {
            explained = Some((error, pose, inliers));
        }
        // No wrong tag among them: other guesses lead here or to the other root, which is tried
        // below.
        if has_all {
            break;
        }
    }
    let (_, best, inliers) = explained?;
    let other = other_side(&best);
    let others = scored.iter().map(|(_, guess)| *guess).filter(|guess| is_other(guess, &best));
    let other = others.chain([other]).min_by(|a, b| {
        error_of(&inliers, intrinsics, a).total_cmp(&error_of(&inliers, intrinsics, b))
    });
    let other = refine(&inliers, intrinsics, other.unwrap_or(best));
    let (mut chosen, mut error) = (best, error_of(&inliers, intrinsics, &best));
    let mut is_ambiguous = inliers.len() == 1;
    if is_other(&other, &best) && is_in_front(&other) {
        let other_error = error_of(&inliers, intrinsics, &other);
        let (low, high) = (error.min(other_error), error.max(other_error));
        // Both an absolute and a relative margin: the first for frames of little noise, the second
        // because a wrong focal length or a bent board leaves errors that are no noise.
        is_ambiguous |= high < 2.0 * low || high - low < 16.0 * CORNER_SIGMA_PX.powi(2);
        if other_error < error {
            (chosen, error) = (other, other_error);
        }
    }
    let corners = 4 * inliers.len();
    let rms_px = (error / corners as f64).sqrt();
    (is_in_front(&chosen) && rms_px.is_finite()).then_some(Estimate {
        extrinsics: chosen,
        rms_px,
        is_ambiguous,
        inliers,
    })
}

/// Refines a guess on the tags that it explains, ever more closely; `None` if it explains none.
///
/// A guess from one tag may be some pixels off at the board's far end; each refinement lets the next
/// look closer, so that a wrong tag does not pull at the others for long.
fn narrow_down(
    sightings: &[Sighting],
    intrinsics: &Intrinsics,
    guess: &Extrinsics,
) -> Option<(Extrinsics, Vec<Sighting>)> {
    let mut pose = *guess;
    let mut inliers = Vec::new();
    for tolerance_px in [4.0 * FAR_OFF_PX, 2.0 * FAR_OFF_PX, FAR_OFF_PX] {
        let is_near = |tag: &&Sighting| {
            error_of(slice::from_ref(*tag), intrinsics, &pose) <= 4.0 * tolerance_px.powi(2)
        };
        inliers = sightings.iter().filter(is_near).copied().collect();
        if inliers.is_empty() {
            return None;
        }
        pose = refine(&inliers, intrinsics, pose);
    }
    Some((pose, inliers))
}

/// Whether the camera sees the board's printed side.
fn is_in_front(pose: &Extrinsics) -> bool {
    pose.camera_in_board().z > 0.0
}

/// Whether two poses differ by more than noise can move one: 5 degrees.
fn is_other(a: &Extrinsics, b: &Extrinsics) -> bool {
    angle_between(&a.rotation, &b.rotation) > 0.087
}

/// The angle that turns one rotation into another, radians.
///
/// From the distance of the matrices, `2 sqrt(2) sin(angle / 2)`: exact for small angles, where the
/// arc cosine of a trace is not.
pub(crate) fn angle_between(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    let distance = (a.matrix() - b.matrix()).norm();
    2.0 * (distance / 8.0f64.sqrt()).min(1.0).asin()
}

/// The mirror image of a pose's tilt: the board's normal on the other side of the line of sight.
fn other_side(pose: &Extrinsics) -> Extrinsics {
    let sight = pose.translation.normalize();
    let normal = pose.rotation * Vector3::z();
    let axis = normal.cross(&sight);
    let Some(axis) = nalgebra::Unit::try_new(axis, 1e-9) else { return *pose };
    // From the normal to the direction against sight, and as far again.
    let tilt = normal.angle(&-sight);
    let turn = Rotation3::from_axis_angle(&axis, -2.0 * tilt);
    Extrinsics { rotation: turn * pose.rotation, translation: pose.translation }
}

/// Both roots of the pose, from the homography of all pairs.
fn roots(sightings: &[Sighting], intrinsics: &Intrinsics) -> Vec<Extrinsics> {
    let count = 4.0 * sightings.len() as f64;
    let middle = pairs(sightings).map(|(board, _)| board.coords).sum::<Vector2<f64>>() / count;
    let centred =
        pairs(sightings).map(|(board, pixel)| (board - middle, intrinsics.normalise(pixel)));
    let rotations = homography::fit(centred.clone()).map(|h| rotations(&(h / h[(2, 2)])));
    let poses = rotations.into_iter().flatten().flatten().filter_map(|rotation| {
        let at_middle = translation(centred.clone(), &rotation)?;
        let translation = at_middle - rotation * Vector3::new(middle.x, middle.y, 0.0);
        Some(Extrinsics { rotation, translation })
    });
    poses.collect()
}

/// The two rotations whose picture has, at the plane's origin, the derivative of `h`; its lower
/// right entry is 1.
fn rotations(h: &Matrix3<f64>) -> Option<[Rotation3<f64>; 2]> {
    let v = Vector2::new(h[(0, 2)], h[(1, 2)]);
    let derivative = Matrix2::new(
        h[(0, 0)] - h[(2, 0)] * v.x,
        h[(0, 1)] - h[(2, 1)] * v.x,
        h[(1, 0)] - h[(2, 0)] * v.y,
        h[(1, 1)] - h[(2, 1)] * v.y,
    );
    // Turns the line of sight through the origin to the optical axis's place.
    let sight = Rotation3::rotation_between(&Vector3::z(), &Vector3::new(v.x, v.y, 1.0))?;
    let project = Matrix2x3::new(1.0, 0.0, -v.x, 0.0, 1.0, -v.y);
    let b = project * sight.matrix().fixed_view::<3, 2>(0, 0);
    let a = b.try_inverse()? * derivative;
    let aa = a * a.transpose();
    let (p, q, r) = (aa[(0, 0)], aa[(0, 1)], aa[(1, 1)]);
    let gamma = (0.5 * (p + r + ((p - r).powi(2) + 4.0 * q * q).sqrt())).sqrt();
    if !(gamma > 1e-12 && gamma.is_finite()) {
        return None;
    }
    let upper = a / gamma;
    let rest = Matrix2::identity() - upper.transpose() * upper;
    let lower = Vector2::new(
        rest[(0, 0)].max(0.0).sqrt(),
        rest[(1, 1)].max(0.0).sqrt().copysign(rest[(0, 1)]),
    );
    let root = |lower: Vector2<f64>| {
        let x = Vector3::new(upper[(0, 0)], upper[(1, 0)], lower.x);
        let y = Vector3::new(upper[(0, 1)], upper[(1, 1)], lower.y);
        let columns = sight.matrix() * Matrix3::from_columns(&[x, y, x.cross(&y)]);
        nearest_rotation(&columns)
    };
    Some([root(lower)?, root(-lower)?])
}

/// Gram and Schmidt's: the columns are orthonormal but for rounding and noise.
fn nearest_rotation(columns: &Matrix3<f64>) -> Option<Rotation3<f64>> {
    let x = columns.column(0).try_normalize(1e-9)?;
    let y = (columns.column(1) - x * x.dot(&columns.column(1))).try_normalize(1e-9)?;
    Some(Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)])))
}

/// The translation that, with a rotation, fits best the pairs of a plane and its picture at unit
/// distance: least squares of `u (r3 p + tz) = r1 p + tx`, and the same of v.
fn translation(
    pairs: impl Iterator<Item = (Point2<f64>, Point2<f64>)>,
    rotation: &Rotation3<f64>,
) -> Option<Vector3<f64>> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (board, seen) in pairs {
        let p = rotation * Vector3::new(board.x, board.y, 0.0);
        for (row, value) in [
            (Vector3::new(1.0, 0.0, -seen.x), seen.x * p.z - p.x),
            (Vector3::new(0.0, 1.0, -seen.y), seen.y * p.z - p.y),
        ] {
            normal += row * row.transpose();
            right += row * value;
        }
    }
    Some(normal.cholesky()?.solve(&right))
}

/// Where a point falls, the distance from the camera's plane being at least a micrometre.
fn project(p: &Vector3<f64>, intrinsics: &Intrinsics) -> Option<Point2<f64>> {
    let Intrinsics { focal_px, cx, cy } = *intrinsics;
    (p.z > 1e-6).then(|| Point2::new(cx + focal_px * p.x / p.z, cy + focal_px * p.y / p.z))
}

/// Sum of squared distances in pixels; infinite if a corner lies behind the camera.
pub(crate) fn error_of(sightings: &[Sighting], intrinsics: &Intrinsics, pose: &Extrinsics) -> f64 {
    let squared = pairs(sightings).map(|(board, pixel)| {
        project(&pose.camera_from_board(board), intrinsics)
            .map_or(f64::INFINITY, |seen| (seen - pixel).norm_squared())
    });
    squared.sum()
}

/// The same, no corner counting as farther off than `most_px`.
fn truncated_error(
    sightings: &[Sighting],
    intrinsics: &Intrinsics,
    pose: &Extrinsics,
    most_px: f64,
) -> f64 {
    let most = most_px.powi(2);
    let squared = pairs(sightings).map(|(board, pixel)| {
        project(&pose.camera_from_board(board), intrinsics)
            .map_or(most, |seen| (seen - pixel).norm_squared().min(most))
    });
    squared.sum()
}

/// Derivatives of a corner's place in the frame.
pub(crate) struct Linearised {
    /// Seen minus predicted, pixels.
    pub residual: Vector2<f64>,
    /// By the pose: a small rotation vector from the left, then the translation. Shape (2, 6).
    pub by_pose: SMatrix<f64, 2, 6>,
    /// By focal length and principal point. Shape (2, 3).
    pub by_intrinsics: Matrix2x3<f64>,
    /// Huber's weight.
    pub weight: f64,
}

/// Linearises one corner's place about a pose; `None` behind the camera.
pub(crate) fn linearise(
    board: Point2<f64>,
    pixel: Point2<f64>,
    intrinsics: &Intrinsics,
    pose: &Extrinsics,
) -> Option<Linearised> {
    let turned = pose.rotation * Vector3::new(board.x, board.y, 0.0);
    let p = turned + pose.translation;
    let residual = pixel - project(&p, intrinsics)?;
    let (f, z) = (intrinsics.focal_px, p.z);
    let by_point = Matrix2x3::new(f / z, 0.0, -f * p.x / (z * z), 0.0, f / z, -f * p.y / (z * z));
    let mut by_pose = SMatrix::<f64, 2, 6>::zeros();
    by_pose.fixed_view_mut::<2, 3>(0, 0).copy_from(&(-by_point * turned.cross_matrix()));
    by_pose.fixed_view_mut::<2, 3>(0, 3).copy_from(&by_point);
    let by_intrinsics = Matrix2x3::new(p.x / z, 1.0, 0.0, p.y / z, 0.0, 1.0);
    let weight = (HUBER_PX / residual.norm()).min(1.0);
    Some(Linearised { residual, by_pose, by_intrinsics, weight })
}

/// A pose moved by a small rotation vector, from the left, and a translation.
pub(crate) fn moved(pose: &Extrinsics, step: &SVector<f64, 6>) -> Extrinsics {
    let turn = Rotation3::new(Vector3::new(step[0], step[1], step[2]));
    // Renormalised, so that rounding does not add up over many steps.
    let rotation = nearest_rotation((turn * pose.rotation).matrix()).unwrap_or(pose.rotation);
    Extrinsics { rotation, translation: pose.translation + Vector3::new(step[3], step[4], step[5]) }
}

/// Huber's cost of all corners; infinite if one lies behind the camera.
pub(crate) fn cost(sightings: &[Sighting], intrinsics: &Intrinsics, pose: &Extrinsics) -> f64 {
    let costs = pairs(sightings).map(|(board, pixel)| {
        let Some(seen) = project(&pose.camera_from_board(board), intrinsics) else {
            return f64::INFINITY;
        };
        let distance = (seen - pixel).norm();
        if distance <= HUBER_PX {
            distance * distance
        } else {
            HUBER_PX * (2.0 * distance - HUBER_PX)
        }
    });
    costs.sum()
}

/// Levenberg-Marquardt from a first pose; gives the best pose found, at worst the first.
fn refine(sightings: &[Sighting], intrinsics: &Intrinsics, first: Extrinsics) -> Extrinsics {
    const MOST_STEPS: usize = 20;
    let (mut pose, mut best) = (first, cost(sightings, intrinsics, &first));
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let mut normal = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        for (board, pixel) in pairs(sightings) {
            let Some(corner) = linearise(board, pixel, intrinsics, &pose) else { return pose };
            normal += corner.by_pose.transpose() * corner.by_pose * corner.weight;
            right += corner.by_pose.transpose() * corner.residual * corner.weight;
        }
        for i in 0..6 {
            normal[(i, i)] *= 1.0 + damping;
        }
        let Some(step) = normal.cholesky().map(|factor| factor.solve(&right)) else { return pose };
        let next = moved(&pose, &step);
        let next_cost = cost(sightings, intrinsics, &next);
        if next_cost < best {
            let gain = best - next_cost;
            (pose, best) = (next, next_cost);
            damping = (damping * 0.1).max(1e-9);
            if gain < 1e-9 * (1.0 + best) {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    pose
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::Board;
    use proptest::prelude::*;

    const CAMERA: Intrinsics = Intrinsics { focal_px: 560.0, cx: 320.0, cy: 240.0 };

    /// Looking at a point of the board from a place above it, turned about the line of sight.
    fn looking(eye: Vector3<f64>, target: Vector3<f64>, roll: f64) -> Extrinsics {
        let ahead = (target - eye).normalize();
        let down = Vector3::new(0.3 * roll.sin(), 0.1, -1.0);
        let right = down.cross(&ahead).normalize();
        let rows = [right.transpose(), ahead.cross(&right).transpose(), ahead.transpose()];
        let level = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), roll) * level;
        Extrinsics { rotation, translation: -(rotation * eye) }
    }

    fn eye(azimuth: f64, elevation: f64, distance: f64) -> Vector3<f64> {
        let (y, x) = azimuth.sin_cos();
        let (z, across) = elevation.sin_cos();
        Vector3::new(across * x, across * y, z) * distance
    }

    /// Tags as a pose shows them, each coordinate off by up to `noise` pixels.
    fn seen(pose: &Extrinsics, ids: &[u32], noise: f64, seed: u64) -> Vec<Sighting> {
        let mut random = seed | 1;
        let mut off = move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            noise * ((random >> 33) as f64 / f64::from(1u32 << 30) - 1.0)
        };
        ids.iter()
            .map(|&id| {
                let board = Board::default().corners(id).unwrap();
                let pixels = board.map(|corner| {
                    let exact = project(&pose.camera_from_board(corner), &CAMERA).unwrap();
                    exact + Vector2::new(off(), off())
                });
                Sighting { id, board, pixels }
            })
            .collect()
    }

    fn apart(a: &Extrinsics, b: &Extrinsics) -> (f64, f64) {
        let distance = (a.camera_in_board() - b.camera_in_board()).norm();
        (angle_between(&a.rotation, &b.rotation), distance / b.camera_in_board().norm())
    }

    proptest! {
        /// From exact corners of any two tags or more the pose comes out exactly, and is sure.
        #[test]
        fn exact_corners_give_the_exact_pose(
            azimuth in -3.1f64..3.1,
            elevation in 0.4f64..1.5,
            distance in 0.25f64..0.8,
            roll in -3.1f64..3.1,
            ids in prop::collection::btree_set(0u32..20, 2..8),
        ) {
            let ids: Vec<u32> = ids.into_iter().collect();
            let pose = looking(eye(azimuth, elevation, distance), Vector3::zeros(), roll);
            let found = estimate(&seen(&pose, &ids, 0.0, 0), &CAMERA).unwrap();
            let (angle, share) = apart(&found.extrinsics, &pose);
            prop_assert!(angle < 1e-4 && share < 1e-4, "{} {}: {:?}", angle, share, found);
            prop_assert!(found.rms_px < 1e-3);
            prop_assert_eq!(found.inliers.len(), ids.len());
        }

        /// One root or the other of a single tag is the pose, and it is called ambiguous.
        #[test]
        fn both_roots_of_a_tag_are_found(
            azimuth in -3.1f64..3.1,
            elevation in 0.5f64..1.4,
            distance in 0.2f64..0.5,
            id in 0u32..20,
        ) {
            let pose = looking(eye(azimuth, elevation, distance), Vector3::zeros(), 0.3);
            let tags = seen(&pose, &[id], 0.0, 0);
            let nearest = roots(&tags, &CAMERA)
                .iter()
                .map(|root| apart(root, &pose).0)
                .fold(9.0, f64::min);
            prop_assert!(nearest < 1e-3, "{}", nearest);
            prop_assert_eq!(roots(&tags, &CAMERA).len(), 2);
            prop_assert!(estimate(&tags, &CAMERA).unwrap().is_ambiguous);
        }

        /// With noise of a third of a pixel a pose that is called sure is not the wrong root, which
        /// would be 30 degrees off or more.
        #[test]
        fn a_sure_pose_is_not_the_wrong_root(
            azimuth in -3.1f64..3.1,
            elevation in 0.3f64..1.3,
            distance in 0.25f64..1.2,
            ids in prop::collection::btree_set(0u32..20, 2..12),
            seed in any::<u64>(),
        ) {
            let ids: Vec<u32> = ids.into_iter().collect();
            let pose = looking(eye(azimuth, elevation, distance), Vector3::zeros(), 0.0);
            let found = estimate(&seen(&pose, &ids, 0.6, seed), &CAMERA).unwrap();
            let (angle, share) = apart(&found.extrinsics, &pose);
            prop_assert!(
                found.is_ambiguous || (angle < 0.2 && share < 0.2),
                "{} degrees, {}: {:?}", angle.to_degrees(), share, found
            );
        }

        /// A tag in a wrong place does not move the pose, and is not among the inliers.
        #[test]
        fn a_wrong_tag_is_left_out(
            azimuth in -3.1f64..3.1, elevation in 0.5f64..1.4, wrong in 0usize..6, by in 25.0f64..200.0,
        ) {
            let pose = looking(eye(azimuth, elevation, 0.4), Vector3::zeros(), 0.0);
            let mut tags = seen(&pose, &[0, 3, 8, 11, 16, 19], 0.2, 7);
            for pixel in &mut tags[wrong].pixels {
                *pixel += Vector2::new(by, -0.5 * by);
            }
            let found = estimate(&tags, &CAMERA).unwrap();
            prop_assert!(found.inliers.iter().all(|tag| tag.id != tags[wrong].id));
            prop_assert_eq!(found.inliers.len(), 5);
            let (angle, share) = apart(&found.extrinsics, &pose);
            prop_assert!(angle < 0.01 && share < 0.01, "{} {}", angle, share);
        }

        /// Derivatives are those of differences.
        #[test]
        fn the_derivatives_are_right(azimuth in -3.1f64..3.1, elevation in 0.3f64..1.5, id in 0u32..20) {
            let pose = looking(eye(azimuth, elevation, 0.4), Vector3::zeros(), 0.2);
            let tag = &seen(&pose, &[id], 0.0, 0)[0];
            let (board, pixel) = (tag.board[1], tag.pixels[1]);
            let at = linearise(board, pixel, &CAMERA, &pose).unwrap();
            const STEP: f64 = 1e-6;
            for i in 0..6 {
                let mut step = SVector::<f64, 6>::zeros();
                step[i] = STEP;
                let there = project(&moved(&pose, &step).camera_from_board(board), &CAMERA).unwrap();
                let slope = (there - pixel) / STEP;
                prop_assert!((slope - at.by_pose.column(i)).norm() < 0.02, "{} {}", i, slope);
            }
            let there = |camera: Intrinsics| project(&pose.camera_from_board(board), &camera).unwrap();
            let longer = Intrinsics { focal_px: CAMERA.focal_px + STEP, ..CAMERA };
            let slope = (there(longer) - pixel) / STEP;
            prop_assert!((slope - at.by_intrinsics.column(0)).norm() < 1e-3);
        }
    }

    /// Once found by chance: the likeliest guess was a compromise that left three right tags out.
    #[test]
    fn the_likeliest_guess_is_not_always_the_best() {
        let pose = looking(eye(1.600_261_059_011_485_6, 0.5, 0.4), Vector3::zeros(), 0.0);
        let mut tags = seen(&pose, &[0, 3, 8, 11, 16, 19], 0.2, 7);
        for pixel in &mut tags[0].pixels {
            *pixel += Vector2::new(25.0, -12.5);
        }
        assert_eq!(estimate(&tags, &CAMERA).unwrap().inliers.len(), 5);
    }

    #[test]
    fn of_a_distant_board_the_other_root_fits_as_well() {
        // From 6 m two tags are 4 pixels each: their perspective is lost in the noise.
        let pose = looking(eye(0.4, 0.9, 6.0), Vector3::zeros(), 0.0);
        let found = estimate(&seen(&pose, &[0, 1], 0.3, 3), &CAMERA).unwrap();
        assert!(found.is_ambiguous);
    }

    #[test]
    fn nothing_and_nonsense_give_no_pose() {
        assert_eq!(estimate(&[], &CAMERA), None);
        let pose = looking(eye(0.4, 0.9, 0.4), Vector3::zeros(), 0.0);
        let mut tags = seen(&pose, &[0, 1], 0.0, 0);
        for tag in &mut tags {
            tag.pixels = [Point2::new(f64::NAN, 3.0); 4];
        }
        assert_eq!(estimate(&tags, &CAMERA), None);
        for tag in &mut tags {
            tag.pixels = [Point2::new(5.0, 3.0); 4];
        }
        assert_eq!(estimate(&tags, &CAMERA), None);
    }
}
