//! What the tests of all grids have in common.

use vantage_core::Vec3;

use crate::adam::Rows;
use crate::field::Field;

/// Points, the indices of some of them, and directions.
fn question() -> (Vec<Vec3>, Vec<u32>, Vec<Vec3>) {
    let point = |i: usize| {
        let at = |c: usize| ((7 * i + 3 * c) as f32 * 0.9).sin() * 0.8;
        Vec3::new(at(0), at(1), at(2))
    };
    let points: Vec<Vec3> = (0..12).map(point).collect();
    let shown: Vec<u32> = vec![0, 2, 3, 7, 11];
    let directions = shown.iter().map(|&i| point(i as usize + 20).normalize()).collect();
    (points, shown, directions)
}

/// Compares the gradient of a weighted sum of what a field gives with finite differences, for every
/// parameter.
pub fn gradient<F: Field>(field: &mut F, rows: fn(&mut F) -> Vec<&mut Rows>) {
    let (points, shown, directions) = question();
    let by_density: Vec<f32> = (0..points.len()).map(|i| (i as f32 * 2.1).cos()).collect();
    let by_colour: Vec<[f32; 3]> =
        (0..shown.len()).map(|i| [0.3, 0.7, 1.1].map(|c: f32| (i as f32 + c).sin())).collect();
    let value = |field: &mut F| -> f64 {
        let density = field.density(&points);
        let colour = field.colour(&shown, &directions);
        let of_density = density.iter().zip(&by_density);
        let of_colour = colour.iter().flatten().zip(by_colour.as_flattened());
        of_density.chain(of_colour).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
    };
    value(field);
    field.accumulate(&by_density, &by_colour);
    let mut moved = 0;
    for place in 0..rows(field).len() {
        for index in 0..rows(field)[place].len() {
            let (&mut at, told) = rows(field)[place].at(index);
            let h = 1e-2;
            let mut with = |at: f32| {
                *rows(field)[place].at(index).0 = at;
                value(field)
            };
            let found = (with(at + h) - with(at - h)) / f64::from(2.0 * h);
            with(at);
            let told = f64::from(told);
            assert!(
                (found - told).abs() < 2e-4 + 2e-3 * told.abs(),
                "{place}, {index}: {found} {told}"
            );
            moved += usize::from(told.abs() > 1e-3);
        }
    }
    assert!(moved > 20, "only {moved} parameters matter");
}

/// A finer level gives what the coarser one gave.
pub fn refinement(field: &mut impl Field) {
    let (points, shown, directions) = question();
    let before = (field.density(&points), field.colour(&shown, &directions));
    field.refine(0.9);
    let after = (field.density(&points), field.colour(&shown, &directions));
    let pairs = before.0.iter().chain(before.1.as_flattened());
    for (a, b) in pairs.zip(after.0.iter().chain(after.1.as_flattened())) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

/// A field that was saved and read goes on as the one that was not.
pub fn resumption<F: Field>(new: fn() -> F) {
    let (points, shown, directions) = question();
    let step = |field: &mut F, size: f32| {
        let given = (field.density(&points), field.colour(&shown, &directions));
        field.accumulate(&vec![size; points.len()], &vec![[size, -size, size]; shown.len()]);
        field.advance(1.0);
        given
    };
    let mut field = new();
    step(&mut field, 1.0);
    step(&mut field, -0.4);
    let home = tempfile::tempdir().unwrap();
    field.save(home.path()).unwrap();
    let mut read = new();
    read.load(home.path()).unwrap();
    for size in [0.3, 0.2, 0.0] {
        assert_eq!(step(&mut field, size), step(&mut read, size));
    }
    for file in std::fs::read_dir(home.path()).unwrap() {
        let path = file.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    }
    assert!(read.load(home.path()).is_err());
}
