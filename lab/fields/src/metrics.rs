//! How like two pictures are: PSNR and SSIM.

use crate::photos::Picture;

/// Peak signal-to-noise ratio in decibels, the peak being 1: `-10 log10(mean squared difference)`.
/// Equal pictures have infinity.
///
/// # Panics
///
/// If their sizes differ.
pub fn psnr(found: &Picture, truth: &Picture) -> f64 {
    assert_eq!(found.pixels.len(), truth.pixels.len(), "pictures of one size");
    let squares = found.pixels.iter().flatten().zip(truth.pixels.iter().flatten());
    let sum: f64 = squares.map(|(a, b)| f64::from(a.clamp(0.0, 1.0) - b).powi(2)).sum();
    -10.0 * (sum / (3 * truth.pixels.len()) as f64).log10()
}

/// Radius of SSIM's window: 3.5 standard deviations, as scikit-image cuts it.
const RADIUS: usize = 5;
/// Standard deviation of SSIM's window, pixels.
const SIGMA: f64 = 1.5;
/// SSIM's constants for a range of 1.
const C: [f64; 2] = [0.01 * 0.01, 0.03 * 0.03];

/// Structural similarity (Wang et al., 2004), the mean over three channels and over all pixels whose
/// whole window of 11 x 11 lies in the picture.
///
/// Equal to scikit-image's `structural_similarity(a, b, channel_axis=2, data_range=1,
/// gaussian_weights=True, sigma=1.5, use_sample_covariance=False)`. `None` for pictures smaller than
/// the window.
///
/// # Panics
///
/// If their sizes differ.
pub fn ssim(found: &Picture, truth: &Picture) -> Option<f64> {
    assert_eq!(found.pixels.len(), truth.pixels.len(), "pictures of one size");
    assert_eq!(found.width, truth.width, "pictures of one size");
    let width = truth.width;
    let height = truth.pixels.len() / width.max(1);
    if width.min(height) < 2 * RADIUS + 1 {
        return None;
    }
    let mut sum = 0.0;
    for channel in 0..3 {
        let channel_of = |picture: &Picture| -> Vec<f64> {
            picture.pixels.iter().map(|pixel| f64::from(pixel[channel].clamp(0.0, 1.0))).collect()
        };
        let (a, b) = (channel_of(found), channel_of(truth));
        let product = |a: &[f64], b: &[f64]| -> Vec<f64> {
            blurred(&a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>(), width)
        };
        let (mean_a, mean_b) = (blurred(&a, width), blurred(&b, width));
        let (aa, bb, ab) = (product(&a, &a), product(&b, &b), product(&a, &b));
        for (i, (&a, &b)) in mean_a.iter().zip(&mean_b).enumerate() {
            let (var_a, var_b, covariance) = (aa[i] - a * a, bb[i] - b * b, ab[i] - a * b);
            sum += (2.0 * a * b + C[0]) * (2.0 * covariance + C[1])
                / ((a * a + b * b + C[0]) * (var_a + var_b + C[1]));
        }
    }
    Some(sum / (3 * (width - 2 * RADIUS) * (height - 2 * RADIUS)) as f64)
}

/// Gaussian means of the windows that lie in the picture; shape (height - 10, width - 10).
fn blurred(values: &[f64], width: usize) -> Vec<f64> {
    let mut window: [f64; 2 * RADIUS + 1] = std::array::from_fn(|i| {
        let off = i as f64 - RADIUS as f64;
        (-0.5 * off * off / (SIGMA * SIGMA)).exp()
    });
    let all: f64 = window.iter().sum();
    window.iter_mut().for_each(|weight| *weight /= all);
    let mean = |values: &mut dyn Iterator<Item = f64>| -> f64 {
        values.zip(window).map(|(value, weight)| value * weight).sum()
    };
    let inner = width - 2 * RADIUS;
    let mut rows = Vec::with_capacity(values.len());
    for row in values.chunks_exact(width) {
        rows.extend((0..inner).map(|x| mean(&mut row[x..].iter().copied())));
    }
    let height = values.len() / width - 2 * RADIUS;
    let place = |i: usize| mean(&mut rows[i..].iter().step_by(inner).copied());
    (0..height * inner).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_everywhere_is_twenty_decibels() {
        let picture = |value: f32| Picture { width: 4, pixels: vec![[value; 3]; 12] };
        assert!((psnr(&picture(0.6), &picture(0.5)) - 20.0).abs() < 1e-5);
        assert_eq!(psnr(&picture(0.5), &picture(0.5)), f64::INFINITY);
        assert_eq!(ssim(&picture(0.5), &picture(0.5)), None);
    }
}
