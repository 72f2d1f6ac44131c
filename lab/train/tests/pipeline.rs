//! From a small data set to a model file: each part against the one before.

use std::path::Path;
use std::sync::LazyLock;

use burn::module::Module;
use burn::tensor::{Device, Tensor};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use vantage_core::objectives::Reading;
use vantage_core::soarnet::{CELL, DETAIL, Model};
use vantage_lab::dataset::{self, Dataset, Parameters, Split};
use vantage_train::fit::{self, Recipe, Run};
use vantage_train::measure::{measure, measure_drawn};
use vantage_train::net::{Build, Network, OBJECTIVES, Shape};
use vantage_train::onnx;
use vantage_train::quantize::{agreement, quantize};
use vantage_train::reference::Reference;
use vantage_train::samples::{self, Ask, Batch, Object};

/// Objects enough for every split, of few views.
fn objects(split: Split) -> &'static [Object] {
    static DATA: LazyLock<[Vec<Object>; 2]> = LazyLock::new(|| {
        let home = tempfile::tempdir().unwrap();
        let parameters = Parameters {
            objects: 24,
            seed: 5,
            image_size: 64,
            resolution: 48,
            train_views: 14,
            validation_views: 1,
            test_views: 1,
            trajectories: 2,
            steps: 8,
            reading: Reading::default(),
            files: Vec::new(),
        };
        dataset::write(home.path(), None, &parameters, || {}).unwrap();
        let data = Dataset::open(home.path()).unwrap();
        [Split::Train, Split::Validation]
            .map(|split| samples::load(&data, split, None, true, || {}).unwrap())
    });
    let [train, validation] = &*DATA;
    if split == Split::Train { train } else { validation }
}

fn small() -> Shape {
    Shape {
        channels: [4, 4, 8, 8],
        embedding: 8,
        token: 16,
        head: 16,
        state: 8,
        ..Shape::default()
    }
}

fn ask(views: usize, counts: &[usize]) -> Ask {
    Ask { views, counts: counts.to_vec(), candidates: usize::MAX, augment: false, photos: true }
}

fn batch(ask: &Ask) -> Batch {
    let some: Vec<&Object> = objects(Split::Train).iter().take(3).collect();
    Batch::draw(&some, Some(0), ask, &mut Pcg64::seed_from_u64(1))
}

/// A network of random weights, the same in every run, its normalisation settled on photos.
fn settled(shape: &Shape) -> Network {
    let training = Device::flex().autodiff();
    training.seed(1);
    let net = Network::new(shape, &training);
    if shape.embedding > 0 {
        for _ in 0..6 {
            net.forward(batch(&ask(6, &[6])).question(&training));
        }
    }
    net.valid()
}

fn values<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor.into_data().try_to_vec().unwrap()
}

fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn encoders_of_every_build_tell_an_embedding_and_a_sketch() {
    for build in [Build::Plain, Build::Separable, Build::Halved] {
        let net = settled(&Shape { build, ..small() });
        let photos = batch(&ask(6, &[6])).question(&Device::flex()).photos;
        let (embeddings, cells) = net.encoder.as_ref().unwrap().forward(photos);
        assert_eq!((embeddings.dims(), cells.dims()), ([18, 8], [18, CELL, DETAIL, DETAIL]));
        assert!(values(embeddings).iter().chain(&values(cells)).all(|value| value.is_finite()));
    }
}

#[test]
fn outlines_that_are_drawn_count_where_there_are_photos() {
    let of = |shape: &Shape| {
        let (net, device) = (settled(shape), Device::flex());
        let some = &objects(Split::Train)[..2];
        (measure(&net, some, 1, &device), measure_drawn(&net, some, 1, &device))
    };
    let (given, drawn) = of(&small());
    assert_ne!(given, drawn);
    let (given, drawn) = of(&small().without_photos());
    assert_eq!(given, drawn);
}

#[test]
fn targets_have_no_mean_and_spread_1_and_undo_themselves() {
    let device = Device::flex();
    let batch = batch(&ask(6, &[2, 6]));
    let target = batch.target(false, &device);
    let (ranks, state) = (values(target.ranks), values(target.state));
    for (index, number) in batch.numbers().enumerate() {
        for objective in 0..OBJECTIVES {
            let at = |other: usize| (index * batch.others + other) * OBJECTIVES + objective;
            let of_state = &state[index * 12..(index + 1) * 12];
            let (mean, spread) = (of_state[4 + objective], of_state[8 + objective]);
            let sum: f32 = (0..batch.others).map(|other| ranks[at(other)]).sum();
            assert!(sum.abs() < 1e-3);
            let square: f32 = (0..batch.others).map(|other| ranks[at(other)].powi(2)).sum();
            let (squares, spread_once) = (square / batch.others as f32, spread / number as f32);
            // Where all gains are nearly alike they are left alike.
            assert!((squares - 1.0).abs() < 1e-3 || spread_once < 0.2, "{squares} {spread_once}");
            for other in 0..batch.others {
                let gain = (mean / number as f32) + ranks[at(other)] * (spread_once + 1e-4);
                assert!((gain - batch.truth.gains[at(other)]).abs() < 1e-4);
            }
            assert_eq!(of_state[objective], batch.truth.scores[index * 4 + objective]);
        }
    }
    let cumulative = values(batch.target(true, &device).ranks);
    let expected = batch.truth.scores[0] + batch.truth.gains[0];
    assert!((cumulative[0] - expected).abs() < 1e-6);
}

#[test]
fn a_state_does_not_depend_on_later_views_nor_on_other_objects() {
    let device = Device::flex();
    let net = Network::new(&small(), &device);
    let long = values(net.forward(batch(&ask(6, &[3, 6])).question(&device)).ranks);
    let short = values(net.forward(batch(&ask(3, &[3])).question(&device)).ranks);
    assert!(largest_difference(&long[..short.len()], &short) < 1e-4);
    let one: Vec<&Object> = objects(Split::Train).iter().take(1).collect();
    let alone = Batch::draw(&one, Some(0), &ask(3, &[3]), &mut Pcg64::seed_from_u64(1));
    let alone = values(net.forward(alone.question(&device)).ranks);
    assert!(largest_difference(&short[..alone.len()], &alone) < 1e-4);
}

#[test]
fn augmented_captures_keep_their_gains_and_stay_photos() {
    let mut chance = Pcg64::seed_from_u64(3);
    let plain = batch(&ask(6, &[6]));
    let some: Vec<&Object> = objects(Split::Train).iter().take(3).collect();
    let device = Device::flex();
    let mut changed = 0;
    for _ in 0..8 {
        let augmented = Ask { augment: true, ..ask(6, &[6]) };
        let other = Batch::draw(&some, Some(0), &augmented, &mut chance);
        assert_eq!(other.truth.gains, plain.truth.gains);
        let photos = values(other.question(&device).photos);
        assert!(photos.iter().all(|&value| (-1.0..=127.0 / 128.0).contains(&value)));
        // Whole pixel values, as a camera has them.
        assert!(photos.iter().all(|value| (value * 128.0).fract() == 0.0));
        changed += usize::from(photos != values(plain.question(&device).photos));
    }
    assert_eq!(changed, 8);
}

#[test]
fn onnx_answers_as_the_network_does_and_whole_numbers_nearly_so() {
    let home = tempfile::tempdir().unwrap();
    let device = Device::flex();
    for shape in [small(), small().without_photos()] {
        let net = settled(&shape);
        let path = home.path().join("network.onnx");
        onnx::export(&net, &path).unwrap();
        let reference = Reference::open(&path).unwrap();
        assert_eq!(reference.shape().embedding, shape.embedding);

        let batch = batch(&Ask { photos: shape.embedding > 0, ..ask(5, &[5]) });
        let answer = net.forward(batch.question(&device));
        let state = batch.state(0, 5);
        let runner = reference.runner(5, batch.others, &["ranks", "state"]).unwrap();
        let got = runner.run(&state).unwrap();
        let (ranks, states) = (values(answer.ranks), values(answer.state));
        assert!(largest_difference(&got[0], &ranks[..got[0].len()]) < 1e-4);
        assert!(largest_difference(&got[1], &states[..12]) < 1e-4);

        let file = quantize(&reference, objects(Split::Train), 1).unwrap();
        let model = Model::parse(&file).unwrap();
        assert_eq!(model.dimensions().embedding, shape.embedding);
        let near = agreement(&reference, &file, objects(Split::Validation), 3..=7).unwrap();
        // An untrained network's outlines are noise, which whole numbers change: then the heads alone
        // are held to it.
        let least = if shape.embedding > 0 { 0.6 } else { 0.97 };
        assert!(near.spearman > least && near.steps >= 20, "{near:?}");
        assert!(near.same_choice_of_outlines >= 0.8, "{near:?}");
    }
}

#[test]
fn training_learns_and_goes_on_where_it_stopped() {
    let home = tempfile::tempdir().unwrap();
    let device = Device::flex();
    let recipe = Recipe { shape: small(), epochs: 3, batch: 4, ..Recipe::default() };
    let (train, validation) = (objects(Split::Train), objects(Split::Validation));
    let whole = home.path().join("whole");
    let (run, course) = Run::open(&whole, &recipe, "data").unwrap();
    let course = fit::fit(&run, course, train, validation, &device).unwrap();
    assert_eq!(course.epochs.len(), 3);
    assert!(course.epochs[2].loss < course.epochs[0].loss);
    assert_eq!(run.course().unwrap(), course);
    fit::load_network(&recipe.shape, &run.best_file(), &device).unwrap();
    let rows = std::fs::read_to_string(whole.join("metrics.csv")).unwrap();
    assert_eq!(rows.lines().count(), 4);

    // Stopped after two epochs, then opened again.
    let parts = home.path().join("parts");
    let (run, course_of_parts) = Run::open(&parts, &recipe, "data").unwrap();
    fit::fit_until(&run, course_of_parts, train, validation, &device, 2).unwrap();
    let (run, resumed) = Run::open(&parts, &recipe, "data").unwrap();
    assert_eq!(resumed.epochs.len(), 2);
    let resumed = fit::fit(&run, resumed, train, validation, &device).unwrap();
    let losses = course.epochs.iter().zip(&resumed.epochs).map(|(a, b)| (a.loss - b.loss).abs());
    assert!(losses.fold(0.0, f32::max) < 1e-3);

    let other = Recipe { seed: 9, ..recipe };
    let refused = Run::open(&parts, &other, "data").err().unwrap().to_string();
    assert!(refused.contains("another recipe"), "{refused}");
}

#[test]
fn foreign_files_are_refused() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("network.onnx");
    let says = |path: &Path| format!("{:#}", Reference::open(path).err().unwrap());
    assert!(says(&path).contains("cannot read"), "{}", says(&path));
    std::fs::write(&path, b"not a network").unwrap();
    assert!(says(&path).contains("network.onnx"), "{}", says(&path));
    std::fs::write(&path, b"").unwrap();
    assert!(says(&path).contains("export it anew"), "{}", says(&path));
    let refused = Run::existing(home.path()).err().unwrap().to_string();
    assert!(refused.contains("cargo vantage train"), "{refused}");
}
