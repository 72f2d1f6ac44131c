//! The four objectives from METHOD's equations, in double precision and without economy: every
//! photo, every ray and every list of faces is kept and gone through anew for each score.

use vantage_core::objectives::{Face, Form, Objective, Reading};

use super::{Photo, Scene};

/// Half the distance from 1 to the next `f32`: what one operation may be off by, relative.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// What a coordinate of a ray, or of the mean of up to thirty rays, may be off by in `f32`: eight
/// roundings of numbers of at most 1.
const RAY_ERROR: f64 = 8.0 * ROUNDING;

/// What psi may be off by in `f32`. It falls by at most 1/4 a degree, and the angle in degrees is
/// known to 3.5e-5: 57.3 times the cosine's 2e-7, 57.3 times the 1.2e-7 of the arc cosine at 80
/// degrees, and the roundings of 80 and -10.
const PSI_ERROR: f64 = 9e-6;

/// A score, and how far single precision may be off it.
#[derive(Clone, Copy, Debug)]
pub struct Score {
    pub value: f64,
    pub slack: f64,
}

/// The score of an objective after these photos.
pub fn score(scene: &Scene, reading: &Reading, photos: &[&Photo], objective: Objective) -> Score {
    match objective {
        Objective::Coverage => coverage(scene, reading, photos),
        Objective::Geometry => geometry(scene, reading, photos),
        Objective::Diversity => diversity(scene, reading, photos),
        Objective::Texture => texture(scene, reading, photos),
    }
}

/// f_C = 1/J sum_j U(sum_k V_j^k), or the same with shares of area in place of 1/J.
fn coverage(scene: &Scene, reading: &Reading, photos: &[&Photo]) -> Score {
    let faces = scene.faces.iter().enumerate();
    let seen = faces.filter(|&(j, _)| times_seen(photos, j) > 0);
    let value: f64 = seen.map(|(_, face)| weight(scene, reading, face)).sum();
    // Summed in double precision and rounded once. A gain is not clipped as the score is, where the
    // shares of area add up to a little more than 1.
    Score { value: value.min(1.0), slack: ROUNDING * value + (value - 1.0).max(0.0) }
}

/// f_Q' = |LoG| beta V + 1 with the m-th sight discounted by d^(m-1), f_Q = sum_j f_Q' / J(5 sigma)^2;
/// by default the same sum without "+ 1", over what it tends to.
fn geometry(scene: &Scene, reading: &Reading, photos: &[&Photo]) -> Score {
    let discount = f64::from(reading.geometry_discount);
    // Each step of the running `1 - d^m` has four roundings, of which d carries over.
    let step_error = 4.0 * ROUNDING / (1.0 - discount);
    let sights = |j: usize| -> f64 {
        (1..=times_seen(photos, j)).map(|m| discount.powi(m as i32 - 1)).sum()
    };
    let faces = scene.faces.iter().enumerate();
    match reading.form {
        Form::Default => {
            let mass = |face: &Face| f64::from(face.area_share) * f64::from(face.complexity);
            let total = scene.faces.iter().map(mass).sum::<f64>() / (1.0 - discount);
            if total == 0.0 {
                return Score { value: 0.0, slack: 0.0 };
            }
            let value = faces.map(|(j, face)| mass(face) * sights(j)).sum::<f64>() / total;
            // Besides: the products of mass, the total, and the result are rounded.
            Score { value, slack: step_error + 3.0 * ROUNDING }
        }
        Form::Literal => {
            let count = scene.faces.len() as f64;
            let (beta, sigma) = (f64::from(reading.beta_q), f64::from(reading.sigma_q));
            let scale = 1.0 / (count * (5.0 * sigma).powi(2));
            let primes =
                faces.clone().map(|(j, f)| f64::from(f.complexity) * beta * sights(j) + 1.0);
            let value = scale * primes.sum::<f64>();
            let mass: f64 = scene.faces.iter().map(|face| f64::from(face.complexity)).sum();
            let slack = scale * beta * mass * step_error / (1.0 - discount) + ROUNDING * value;
            Score { value, slack }
        }
    }
}

/// f_T = 1 - share of the last bin, as the share of textured pixels, the mean over hue and
/// saturation; on a face seen m times before, d^m of it. By default the sum over the views over
/// what it tends to, to the letter their mean.
fn texture(scene: &Scene, reading: &Reading, photos: &[&Photo]) -> Score {
    let discount = f64::from(reading.texture_discount);
    let share = |(k, photo): (usize, &&Photo)| -> f64 {
        let on_faces: f64 = photo
            .faces()
            .iter()
            .zip(&photo.textured)
            .map(|(&j, &textured)| {
                f64::from(textured) * discount.powi(times_seen(&photos[..k], j) as i32)
            })
            .sum();
        (on_faces + f64::from(photo.textured_background)) / 2.0 / f64::from(photo.pixels)
    };
    let sum: f64 = photos.iter().enumerate().filter(|(_, p)| p.pixels > 0).map(share).sum();
    let value = match reading.form {
        Form::Default if scene.texture_total > 0.0 => sum / f64::from(scene.texture_total),
        Form::Default => 0.0,
        Form::Literal => sum / photos.len().max(1) as f64,
    };
    // The power of d has a rounding for each time the face was seen; the rest is double precision.
    Score { value, slack: ROUNDING * (photos.len() as f64 + 1.0) * value }
}

/// f_D = 1/J sum_j delta_j phi_j.
fn diversity(scene: &Scene, reading: &Reading, photos: &[&Photo]) -> Score {
    let (mut value, mut highest) = (0.0, 0.0);
    for (j, face) in scene.faces.iter().enumerate() {
        let seen = photos.iter().filter(|photo| photo.shows(j));
        let rays: Vec<[f64; 3]> = seen.map(|photo| ray(face, photo)).collect();
        if rays.is_empty() {
            continue;
        }
        let psi = rays.iter().map(|ray| inlier_weight(face, ray, reading.form));
        let phi = psi.sum::<f64>() / rays.len() as f64;
        let deviations = [0, 1, 2].map(|axis| variance(&rays, axis).sqrt());
        let share = weight(scene, reading, face);
        value += share * spread(deviations, reading.form) * phi;
        // A cube root has no bounded slope at 0, so no bound on D can be relative or a fixed number
        // of roundings. The standard deviation of an axis has: it moves no more than the rays do.
        // One ray has no variance, and none by rounding either.
        let error = if rays.len() > 1 { RAY_ERROR } else { 0.0 };
        let moved = deviations.map(|deviation| deviation + error);
        highest += share * spread(moved, reading.form) * (phi + PSI_ERROR);
    }
    Score { value, slack: highest - value + 4.0 * ROUNDING * value }
}

/// From the face's centroid to the camera, unit length.
fn ray(face: &Face, photo: &Photo) -> [f64; 3] {
    let (from, to) = (face.centroid.to_array(), photo.camera.to_array());
    let towards = [0, 1, 2].map(|axis| f64::from(to[axis]) - f64::from(from[axis]));
    let length = towards.iter().map(|x| x * x).sum::<f64>().sqrt();
    towards.map(|x| x / length)
}

/// psi = 1 - alpha_1 / (1 + e^(-theta + alpha_2)), theta = |incidence in degrees| - 90.
fn inlier_weight(face: &Face, ray: &[f64; 3], form: Form) -> f64 {
    let normal = face.normal.to_array();
    let cosine: f64 = (0..3).map(|axis| ray[axis] * f64::from(normal[axis])).sum();
    let cosine = if form == Form::Default { cosine.abs() } else { cosine };
    let theta = cosine.clamp(-1.0, 1.0).acos().to_degrees() - 90.0;
    1.0 - 1.0 / (1.0 + (-theta - 10.0).exp())
}

/// The mean of squared differences over all pairs of rays: twice the variance, and no mean in it.
fn variance(rays: &[[f64; 3]], axis: usize) -> f64 {
    let pairs = rays.iter().flat_map(|a| rays.iter().map(move |b| (a[axis] - b[axis]).powi(2)));
    pairs.sum::<f64>() / (2.0 * (rays.len() * rays.len()) as f64)
}

fn spread(deviations: [f64; 3], form: Form) -> f64 {
    let product: f64 = deviations.iter().map(|deviation| deviation * deviation).product();
    match form {
        Form::Default => 3.0 * product.cbrt(),
        Form::Literal => product,
    }
}

fn times_seen(photos: &[&Photo], j: usize) -> usize {
    photos.iter().filter(|photo| photo.shows(j)).count()
}

fn weight(scene: &Scene, reading: &Reading, face: &Face) -> f64 {
    match reading.form {
        Form::Default => f64::from(face.area_share),
        Form::Literal => 1.0 / scene.faces.len() as f64,
    }
}
