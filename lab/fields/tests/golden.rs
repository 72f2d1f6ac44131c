//! PSNR and SSIM against scikit-image's: see `tests/golden/README.md`.

use std::fs;
use std::path::Path;

use vantage_fields::metrics::{psnr, ssim};
use vantage_fields::photos::Picture;

#[test]
fn similarity_is_scikit_images() {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden");
    let picture = |name: &str| {
        let bytes = fs::read(golden.join(format!("similarity/{name}.rgb"))).unwrap();
        let (pixels, rest) = bytes.as_chunks::<3>();
        assert!(pixels.len() == 40 * 28 && rest.is_empty());
        let levels = |rgb: &[u8; 3]| rgb.map(|level| f32::from(level) / 255.0);
        Picture { width: 40, pixels: pixels.iter().map(levels).collect() }
    };
    let text = fs::read_to_string(golden.join("similarity.txt")).unwrap();
    let mut compared = 0;
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split(' ').collect();
        let (name, change) = (words[0], words[1]);
        let (truth, found) = (picture(name), picture(&format!("{name}-{change}")));
        let expected: Vec<f64> = words[2..].iter().map(|word| word.parse().unwrap()).collect();
        assert!((psnr(&found, &truth) - expected[0]).abs() < 1e-5, "{line}");
        let found = ssim(&found, &truth).unwrap();
        assert!((found - expected[1]).abs() < 1e-6, "{line}: {found}");
        compared += 1;
    }
    assert_eq!(compared, 6);
}
