//! Where the object stands, how large it is and which way is up, from the cameras alone.

use glam::{DMat3, DQuat, DVec3};
use vantage_core::{Pose, PoseError, Vec3};

use super::error::PhotosError;
use super::transforms::Lens;
use crate::pool::DISTANCE;

/// A camera that took a photo, in the file's coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taken {
    pub position: DVec3,
    /// The file's coordinates from the camera's, OpenGL axes.
    pub rotation: DQuat,
    pub lens: Lens,
}

impl Taken {
    fn forward(&self) -> DVec3 {
        self.rotation * DVec3::NEG_Z
    }

    /// Where a point falls in the photo, in pixels; `None` behind the camera.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        self.falls(self.rotation.inverse() * (point - self.position))
    }

    /// Where a direction, in the file's coordinates, falls in the photo.
    pub fn project_direction(&self, direction: DVec3) -> Option<[f64; 2]> {
        self.falls(self.rotation.inverse() * direction)
    }

    /// The direction of a pixel's ray, unit length.
    pub fn ray(&self, [x, y]: [f64; 2]) -> DVec3 {
        let Lens { focal: [fx, fy], centre: [cx, cy], .. } = self.lens;
        (self.rotation * DVec3::new((x - cx) / fx, -(y - cy) / fy, -1.0)).normalize()
    }

    fn falls(&self, DVec3 { x, y, z }: DVec3) -> Option<[f64; 2]> {
        let Lens { focal: [fx, fy], centre: [cx, cy], .. } = self.lens;
        (z < 0.0).then(|| [cx - fx * x / z, cy + fy * y / z])
    }

    /// The radius of the largest sphere at a point's distance that the photo could show whole;
    /// `None` where it does not show the point.
    fn frames(&self, point: DVec3) -> Option<f64> {
        let Lens { focal, size, .. } = self.lens;
        let place = self.project(point)?;
        let inside = (0..2).all(|axis| (0.0..=size[axis]).contains(&place[axis]));
        let sine = |axis: usize| 0.5 * size[axis] / focal[axis].hypot(0.5 * size[axis]);
        inside.then(|| self.position.distance(point) * sine(0).min(sine(1)))
    }
}

/// What the user knows better, in the file's coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known {
    /// The object's middle.
    pub centre: Option<[f64; 3]>,
    /// The radius of the sphere around it that holds the object.
    pub radius: Option<f64>,
    /// Its upward direction, of any length.
    pub up: Option<[f64; 3]>,
}

/// The similarity between the file's coordinates and the plan's: there the object fills the unit
/// sphere around the origin, +Z is up, and cameras stand at [`DISTANCE`].
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// The object's middle, in the file's coordinates.
    pub centre: DVec3,
    /// The radius of the sphere that holds the object, in the file's units.
    pub radius: f64,
    /// The middle distance of the cameras from it, in the file's units.
    pub distance: f64,
    /// The plan's axes from the file's.
    plan_from_file: DQuat,
}

/// An axis counts fully up to about this many times the middle distance of axes from the centre.
const OUTLIER: f64 = 3.0;

/// Below this the axes are taken for parallel: the square of the sine of one degree.
const LEAST_SPREAD: f64 = 3.0e-4;

impl Layout {
    /// From the cameras and what is known besides.
    pub(super) fn of(
        cameras: &[Taken],
        known: &Known,
        keeps_z_up: bool,
    ) -> Result<Self, PhotosError> {
        let given = |point: [f64; 3], option| {
            let point = DVec3::from_array(point);
            if point.is_finite() { Ok(point) } else { Err(PhotosError::BadOption(option)) }
        };
        let centre = match known.centre {
            Some(point) => given(point, "--centre")?,
            None => centre(cameras)?,
        };
        let up = match known.up {
            Some(up) => given(up, "--up")?.try_normalize().ok_or(PhotosError::BadOption("--up"))?,
            None if keeps_z_up => DVec3::Z,
            None => up(cameras)?,
        };
        let distance = median(cameras.iter().map(|c| c.position.distance(centre)).collect())
            .filter(|distance| *distance > 0.0)
            .ok_or(PhotosError::NotFramed)?;
        let radius = match known.radius {
            Some(radius) if radius.is_finite() && radius > 0.0 => radius,
            Some(_) => return Err(PhotosError::BadOption("--radius")),
            None => {
                let framed = cameras.iter().filter_map(|camera| camera.frames(centre));
                median(framed.collect()).ok_or(PhotosError::NotFramed)?
            }
        };
        let plan_from_file = DQuat::from_rotation_arc(up, DVec3::Z);
        Ok(Self { centre, radius, distance, plan_from_file })
    }

    /// The upward direction, in the file's coordinates.
    pub fn up(&self) -> DVec3 {
        self.plan_from_file.inverse() * DVec3::Z
    }

    /// The direction, in the plan's coordinates, in which a point of the file's lies from the
    /// centre; `None` at the centre.
    pub fn direction(&self, point: DVec3) -> Option<Vec3> {
        let direction = (self.plan_from_file * (point - self.centre)).try_normalize()?;
        Some(direction.as_vec3())
    }

    /// A camera of the plan in that direction, looking at the object.
    pub fn looking_from(&self, direction: Vec3) -> Result<Pose, PoseError> {
        Pose::looking_at(direction * DISTANCE, Vec3::ZERO)
    }

    /// A camera that took a photo, as it stands in the plan's coordinates.
    pub(super) fn pose(&self, camera: &Taken) -> Result<Pose, PoseError> {
        let position = self.plan_from_file * (camera.position - self.centre) / self.radius;
        let rotation = (self.plan_from_file * camera.rotation).normalize();
        Pose::try_new(position.as_vec3(), rotation.as_quat())
    }

    /// A camera of the plan, in the file's coordinates at the middle distance: centre and axes
    /// (right, up, back).
    pub fn in_file(&self, pose: &Pose) -> (DVec3, DMat3) {
        let file_from_plan = self.plan_from_file.inverse();
        let rotation = file_from_plan * pose.rotation().as_dquat().normalize();
        let out = file_from_plan * pose.position().as_dvec3();
        (self.centre + out * (self.distance / f64::from(DISTANCE)), DMat3::from_quat(rotation))
    }
}

/// The point nearest to all optical axes: that of the least sum of squared distances, then again
/// with each axis weighed by how near it passes (Cauchy's weights), so that a few photos of
/// something else do not draw it away.
fn centre(cameras: &[Taken]) -> Result<DVec3, PhotosError> {
    let parallel = PhotosError::Parallel(cameras.len());
    let mut weights = vec![1.0; cameras.len()];
    let mut centre = DVec3::ZERO;
    for _ in 0..30 {
        // sum w (I - d d^T) (centre - eye) = 0
        let (mut matrix, mut right, mut total) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        for (camera, &weight) in cameras.iter().zip(&weights) {
            let axis = camera.forward();
            let across =
                DMat3::IDENTITY - DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
            matrix += across * weight;
            right += across * camera.position * weight;
            total += weight;
        }
        if !(total > 0.0 && least_eigenvalue(matrix * (1.0 / total)) > LEAST_SPREAD) {
            return Err(parallel);
        }
        let next = matrix.inverse() * right;
        let moved = next.distance(centre);
        centre = next;
        let misses: Vec<f64> = cameras
            .iter()
            .map(|camera| camera.forward().cross(centre - camera.position).length())
            .collect();
        let typical = median(misses.clone()).unwrap_or(0.0);
        if moved <= 1e-9 * centre.distance(cameras[0].position) || typical <= 0.0 {
            break;
        }
        for ((weight, camera), miss) in weights.iter_mut().zip(cameras).zip(misses) {
            let ahead = camera.forward().dot(centre - camera.position) > 0.0;
            *weight = if ahead { 1.0 / (1.0 + (miss / (OUTLIER * typical)).powi(2)) } else { 0.0 };
        }
    }
    Ok(centre)
}

/// The world's upward direction: the mean of the cameras', or, where their rightward directions
/// agree better, of a camera held on its side.
fn up(cameras: &[Taken]) -> Result<DVec3, PhotosError> {
    let mean = |axis: DVec3| {
        cameras.iter().map(|camera| camera.rotation * axis).sum::<DVec3>() / cameras.len() as f64
    };
    let (upright, sideways) = (mean(DVec3::Y), mean(DVec3::X));
    if upright.length() >= sideways.length() && upright.length() > 0.3 {
        return Ok(upright.normalize());
    }
    // Turned to the left or to the right? Files have +Z up (nerfstudio's) or +Y (ARKit's).
    let sideways = sideways.try_normalize().ok_or(PhotosError::NoUp)?;
    let known = [DVec3::Z, DVec3::Y].into_iter().find(|axis| sideways.dot(*axis).abs() > 0.8);
    known.map(|axis| sideways * sideways.dot(axis).signum()).ok_or(PhotosError::NoUp)
}

/// The least eigenvalue of a symmetric matrix (Smith, 1961).
fn least_eigenvalue(m: DMat3) -> f64 {
    let mean = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let centred = m - DMat3::IDENTITY * mean;
    let square = centred.x_axis.length_squared()
        + centred.y_axis.length_squared()
        + centred.z_axis.length_squared();
    let scale = (square / 6.0).sqrt();
    if scale <= f64::EPSILON * mean.abs() {
        return mean;
    }
    let half = 0.5 * (centred * (1.0 / scale)).determinant();
    let angle = half.clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * scale * (angle + 2.0 * std::f64::consts::FRAC_PI_3).cos()
}

/// The middle value; of an even number, the upper of the two.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use vantage_core::Camera;

    pub fn lens(camera: &Camera) -> Lens {
        let pair = |x: f32, y: f32| [f64::from(x), f64::from(y)];
        Lens {
            focal: pair(camera.fx, camera.fy),
            centre: pair(camera.cx, camera.cy),
            size: [f64::from(camera.width), f64::from(camera.height)],
        }
    }

    pub fn around_origin(radius: f64, distance: f64) -> Layout {
        Layout { centre: DVec3::ZERO, radius, distance, plan_from_file: DQuat::IDENTITY }
    }

    #[test]
    fn eigenvalues_of_known_matrices() {
        let diagonal = DMat3::from_diagonal(DVec3::new(3.0, 0.5, 2.0));
        let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(-1.2);
        let turned = turn * diagonal * turn.transpose();
        assert!((least_eigenvalue(turned) - 0.5).abs() < 1e-12);
        assert_eq!(least_eigenvalue(DMat3::IDENTITY), 1.0);
    }

    #[test]
    fn the_middle_of_values() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(Vec::new()), None);
    }
}
