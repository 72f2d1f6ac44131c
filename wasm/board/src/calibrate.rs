//! The camera's intrinsics from views of the board.
//!
//! Zhang's closed form ("A flexible new technique for camera calibration", PAMI 2000, section 3.1)
//! with square pixels and the principal point in the middle leaves one unknown, `u = 1 / f^2`, and
//! two equations a view, for `h1` and `h2` the first columns of a homography in pixels from the
//! middle:
//!
//! ```text
//! (h11 h12 + h21 h22) u = -h31 h32
//! (h11^2 + h21^2 - h12^2 - h22^2) u = h32^2 - h31^2
//! ```
//!
//! Then focal length and all poses are refined together on the reprojection error
//! (Levenberg-Marquardt; each view's pose is eliminated by the Schur complement), and the principal
//! point with them where the views say enough of it. Standard deviations come from the same
//! complement; a calibration that is not sure of its focal length to two per cent is none.
//!
//! Not handled: lens distortion, and a focal length that changes between views.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::homography;
use crate::pose::{self, Estimate, Extrinsics, Intrinsics, Sighting};

/// A camera that views of the board agree on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// The camera.
    pub intrinsics: Intrinsics,
    /// Root mean square of all corners' distances to where the calibration puts them, pixels.
    pub rms_px: f64,
    /// Views used.
    pub views: usize,
    /// Standard deviation of the focal length, pixels, as far as the corners' noise tells it.
    pub focal_sigma_px: f64,
}

/// Fewer views than these give no calibration.
pub const LEAST_VIEWS: usize = 4;

/// The largest standard deviation of a focal length that is given, as a share of it.
const MOST_FOCAL_SIGMA: f64 = 0.02;

/// The largest standard deviation of a principal point that is used, as a share of the frame's
/// width. Phones and webcams are centred to about a hundredth of it.
const MOST_CENTRE_SIGMA: f64 = 0.004;

/// The most that corners may disagree, in pixels: above, it is no pinhole camera or no flat board.
const MOST_RMS_PX: f64 = 2.0;

/// What the corners say of focal length and principal point, once every pose is at its best.
struct Reduced {
    normal: Matrix3<f64>,
    right: Vector3<f64>,
}

/// Intrinsics of frames of one size; `None` where the views do not tell them.
pub fn calibrate(views: &[Vec<Sighting>], width: usize, height: usize) -> Option<Calibration> {
    if views.len() < LEAST_VIEWS {
        return None;
    }
    let (width, height) = (width as f64, height as f64);
    let middle = [0.5 * width, 0.5 * height];
    let focal_px = closed_form(views, middle)?;
    // Views from one side only may give any focal length: what no camera has is refused.
    if !(0.3 * width.max(height)..=10.0 * width.max(height)).contains(&focal_px) {
        return None;
    }
    let centred = Intrinsics { focal_px, cx: middle[0], cy: middle[1] };
    let mut used: Vec<&[Sighting]> = Vec::new();
    let mut poses = Vec::new();
    for view in views {
        if let Some(Estimate { extrinsics, .. }) = pose::estimate(view, &centred) {
            used.push(view);
            poses.push(extrinsics);
        }
    }
    if used.len() < LEAST_VIEWS {
        return None;
    }
    let (intrinsics, poses) = refine(&used, centred, poses, 1)?;
    let focal_only = finish(&used, intrinsics, &poses, 1)?;
    // The principal point as well, if that is sure.
    let with_centre = refine(&used, intrinsics, poses, 3)
        .and_then(|(intrinsics, poses)| finish(&used, intrinsics, &poses, 3))
        .filter(|(_, sigmas)| sigmas.y.max(sigmas.z) <= MOST_CENTRE_SIGMA * width)
        .filter(|(c, _)| {
            let Intrinsics { cx, cy, .. } = c.intrinsics;
            (cx - middle[0]).abs() <= 0.1 * width && (cy - middle[1]).abs() <= 0.1 * height
        });
    let (calibration, sigmas) = with_centre.unwrap_or(focal_only);
    let sure = sigmas.x <= MOST_FOCAL_SIGMA * calibration.intrinsics.focal_px;
    (sure && calibration.rms_px <= MOST_RMS_PX).then_some(calibration)
}

/// Zhang's focal length.
fn closed_form(views: &[Vec<Sighting>], middle: [f64; 2]) -> Option<f64> {
    let (mut squares, mut products) = (0.0, 0.0);
    for view in views {
        let Some(h) = homography::fit(pose::pairs(view)) else { continue };
        let to_middle = Matrix3::new(1.0, 0.0, -middle[0], 0.0, 1.0, -middle[1], 0.0, 0.0, 1.0);
        let h = to_middle * h;
        // Equal weight to equal tilt: the scale of a homography means nothing.
        let h = h / h.fixed_view::<2, 2>(0, 0).norm();
        let (a, b) = (h.column(0), h.column(1));
        for (factor, value) in [
            (a.x * b.x + a.y * b.y, -a.z * b.z),
            (a.x * a.x + a.y * a.y - b.x * b.x - b.y * b.y, b.z * b.z - a.z * a.z),
        ] {
            squares += factor * factor;
            products += factor * value;
        }
    }
    let u = products / squares;
    (u > 0.0 && u.is_finite()).then(|| 1.0 / u.sqrt())
}

/// Refines the first `free` of focal length, cx and cy with all poses.
fn refine(
    views: &[&[Sighting]],
    first: Intrinsics,
    poses: Vec<Extrinsics>,
    free: usize,
) -> Option<(Intrinsics, Vec<Extrinsics>)> {
    const MOST_STEPS: usize = 30;
    let total = |intrinsics: &Intrinsics, poses: &[Extrinsics]| -> f64 {
        let costs = views.iter().zip(poses).map(|(view, pose)| pose::cost(view, intrinsics, pose));
        costs.sum()
    };
    let (mut intrinsics, mut poses) = (first, poses);
    let mut best = total(&intrinsics, &poses);
    let mut damping = 1e-4;
    for _ in 0..MOST_STEPS {
        let (reduced, blocks) = linearise(views, &intrinsics, &poses, damping)?;
        let shared = solve(&reduced, free, damping)?;
        let next = Intrinsics {
            focal_px: intrinsics.focal_px + shared.x,
            cx: intrinsics.cx + shared.y,
            cy: intrinsics.cy + shared.z,
        };
        let moved = poses
            .iter()
            .zip(&blocks)
            .map(|(pose, block)| pose::moved(pose, &(block.right - block.coupling * shared)));
        let moved: Vec<Extrinsics> = moved.collect();
        let cost = if next.focal_px > 1.0 { total(&next, &moved) } else { f64::INFINITY };
        if cost < best {
            let gain = best - cost;
            (intrinsics, poses, best) = (next, moved, cost);
            damping = (damping * 0.1).max(1e-9);
            if gain < 1e-7 * (1.0 + best) {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    Some((intrinsics, poses))
}

/// One view's pose, solved for: its step is `right - coupling * (step of the intrinsics)`.
struct Block {
    right: SVector<f64, 6>,
    coupling: SMatrix<f64, 6, 3>,
}

/// The normal equations with every pose eliminated.
fn linearise(
    views: &[&[Sighting]],
    intrinsics: &Intrinsics,
    poses: &[Extrinsics],
    damping: f64,
) -> Option<(Reduced, Vec<Block>)> {
    let mut reduced = Reduced { normal: Matrix3::zeros(), right: Vector3::zeros() };
    let mut blocks = Vec::with_capacity(views.len());
    for (view, pose) in views.iter().zip(poses) {
        let mut own = SMatrix::<f64, 6, 6>::zeros();
        let mut cross = SMatrix::<f64, 6, 3>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        for (board, pixel) in pose::pairs(view) {
            let corner = pose::linearise(board, pixel, intrinsics, pose)?;
            let (p, k, w) = (corner.by_pose, corner.by_intrinsics, corner.weight);
            own += p.transpose() * p * w;
            cross += p.transpose() * k * w;
            right += p.transpose() * corner.residual * w;
            reduced.normal += k.transpose() * k * w;
            reduced.right += k.transpose() * corner.residual * w;
        }
        for i in 0..6 {
            own[(i, i)] *= 1.0 + damping;
        }
        let factor = own.cholesky()?;
        let block = Block { right: factor.solve(&right), coupling: factor.solve(&cross) };
        reduced.normal -= cross.transpose() * block.coupling;
        reduced.right -= cross.transpose() * block.right;
        blocks.push(block);
    }
    Some((reduced, blocks))
}

/// The step of the first `free` intrinsics; the others stay.
fn solve(reduced: &Reduced, free: usize, damping: f64) -> Option<Vector3<f64>> {
    let mut normal = reduced.normal;
    let mut right = reduced.right;
    for i in 0..3 {
        normal[(i, i)] *= 1.0 + damping;
    }
    hold(&mut normal, free);
    for i in free..3 {
        right[i] = 0.0;
    }
    Some(normal.cholesky()?.solve(&right))
}

/// Takes all but the first `free` unknowns out of a matrix.
fn hold(normal: &mut Matrix3<f64>, free: usize) {
    for i in free..3 {
        normal.row_mut(i).fill(0.0);
        normal.column_mut(i).fill(0.0);
        normal[(i, i)] = 1.0;
    }
}

/// The calibration and the standard deviations of focal length, cx and cy.
fn finish(
    views: &[&[Sighting]],
    intrinsics: Intrinsics,
    poses: &[Extrinsics],
    free: usize,
) -> Option<(Calibration, Vector3<f64>)> {
    let squares =
        views.iter().zip(poses).map(|(view, pose)| pose::error_of(view, &intrinsics, pose));
    let squares: f64 = squares.sum();
    let corners = 4 * views.iter().map(|view| view.len()).sum::<usize>();
    let freedom = 2.0 * corners as f64 - 6.0 * views.len() as f64 - free as f64;
    let (reduced, _) = linearise(views, &intrinsics, poses, 0.0)?;
    let mut normal = reduced.normal;
    hold(&mut normal, free);
    let inverse = normal.try_inverse()?;
    // Corners of tags that seem perfect still have been rounded to bytes of luma.
    let variance = (squares / freedom.max(1.0)).max(0.05f64.powi(2));
    let sigma = |i: usize| (inverse[(i, i)].max(0.0) * variance).sqrt();
    let sigmas = Vector3::new(sigma(0), sigma(1), sigma(2));
    let rms_px = (squares / corners as f64).sqrt();
    let calibration =
        Calibration { intrinsics, rms_px, views: views.len(), focal_sigma_px: sigmas.x };
    (rms_px.is_finite() && sigmas.iter().all(|s| s.is_finite())).then_some((calibration, sigmas))
}
