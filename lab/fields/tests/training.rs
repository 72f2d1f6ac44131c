//! Every field learns a scene whose photos follow from a formula.

use vantage_core::Camera;
use vantage_fields::metrics::psnr;
use vantage_fields::photos::{Photos, dense_views, test_circle};
use vantage_fields::recipe::{FieldConfig, Kind, Preset, Recipe};
use vantage_fields::scene;
use vantage_fields::train::{EVERY, Trainer};
use vantage_lab::pool::FOV_X_RAD;

/// 30 photos around the scene, and what is seen from 6 other places.
fn photos() -> [Photos; 2] {
    let camera = Camera::from_fov(40, 40, FOV_X_RAD).unwrap();
    let of = |poses| scene::photos(camera, poses).unwrap();
    [of(dense_views(30).unwrap()), of(test_circle(6).unwrap())]
}

fn recipe(kind: Kind, steps: usize) -> Recipe {
    let mut recipe = Recipe { steps, rays: 512, samples: 64, ..Recipe::new(kind, Preset::Small) };
    match &mut recipe.field {
        FieldConfig::Tensorf(config) => config.nodes = vec![16, 40],
        FieldConfig::Plenoxels(config) => config.nodes = vec![16, 40],
        FieldConfig::Nerf(config) => config.width = 32,
    }
    recipe
}

/// Mean PSNR over the test views.
fn quality(trainer: &mut Trainer, test: &Photos) -> f64 {
    let found = trainer.render(&test.camera, &test.poses);
    let of_each = found.iter().zip(&test.pictures).map(|(found, truth)| psnr(found, truth));
    of_each.sum::<f64>() / found.len() as f64
}

#[test]
fn every_field_learns_three_spheres() {
    let [train, test] = photos();
    for (kind, steps, least) in
        [(Kind::Plenoxels, 300, 24.0), (Kind::Tensorf, 300, 25.0), (Kind::Nerf, 300, 18.0)]
    {
        let mut trainer = Trainer::new(&recipe(kind, steps), &train, 1);
        let before = quality(&mut trainer, &test);
        while !trainer.is_over() {
            trainer.advance();
        }
        let after = quality(&mut trainer, &test);
        println!("{}: {before:.2} -> {after:.2} dB", kind.name());
        assert!(before < 16.0 && after > least, "{}: {before} {after}", kind.name());
    }
}

#[test]
fn the_same_seed_gives_the_same_field_also_when_interrupted() {
    let [train, test] = photos();
    for kind in [Kind::Plenoxels, Kind::Tensorf, Kind::Nerf] {
        let recipe = recipe(kind, 2 * EVERY + 10);
        let run = |seed: u64| {
            let mut trainer = Trainer::new(&recipe, &train, seed);
            while !trainer.is_over() {
                trainer.advance();
            }
            trainer.render(&test.camera, &test.poses[..1])
        };
        let whole = run(1);
        assert!(run(2) != whole);

        let home = tempfile::tempdir().unwrap();
        let mut first = Trainer::new(&recipe, &train, 1);
        (0..EVERY).for_each(|_| {
            first.advance();
        });
        first.field().save(home.path()).unwrap();
        let mut second = Trainer::new(&recipe, &train, 1);
        second.resume(EVERY, |field| field.load(home.path())).unwrap();
        while !second.is_over() {
            second.advance();
        }
        assert!(second.render(&test.camera, &test.poses[..1]) == whole, "{}", kind.name());
    }
}
