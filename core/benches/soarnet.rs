//! `cargo bench -p vantage-core --bench soarnet`: the network at its default sizes, by chance. Each
//! bench checks its result before it is timed.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a bench a panic is the finding"
)]

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../tests/common/network.rs"]
mod network;

use divan::{Bencher, black_box};
use network::OwnNetwork;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::Scorer;
use vantage_core::soarnet::features::{Direction, Stance};
use vantage_core::soarnet::{
    COVER, Dimensions, Fixed, Form, Image, Model, OUTLOOK, Photo, Pixels, SKETCH, Scratch, SoarNet,
};
use vantage_core::{Objective, Pose, Vec3};

fn main() {
    divan::main();
}

fn poses() -> Vec<Pose> {
    Pool::try_new(ViewSpace::FibonacciSphere, 100, 2.0).unwrap().iter().collect()
}

fn picture(width: usize, height: usize) -> Vec<u8> {
    (0..width * height * 3).map(|i| ((i * 31) >> 4) as u8).collect()
}

/// Reading a model file: checksum and bounds.
#[divan::bench]
fn parse_a_model(bencher: Bencher<'_, '_>) {
    let file = OwnNetwork::by_chance(Dimensions::default(), 1).file();
    assert!(Model::parse(&file).is_ok());
    bencher.bench_local(|| Model::parse(black_box(&file)).unwrap().checksum());
}

/// From a picture to what the network sees of it.
#[divan::bench(args = [(64, 64), (640, 480)])]
fn resize(bencher: Bencher<'_, '_>, (width, height): (usize, usize)) {
    let bytes = picture(width, height);
    let image = Image::try_new(width as u32, height as u32, Pixels::Rgb888, &bytes).unwrap();
    let window = image.middle().unwrap();
    let mut output = [0; vantage_core::soarnet::INPUT];
    image.resize(&window, &mut output);
    assert!(output.iter().any(|&value| value != output[0]));
    bencher.bench_local(|| image.resize(black_box(&window), &mut output));
}

/// From a picture of 64 x 64 pixels to its sketch and its embedding.
#[divan::bench]
fn encode_a_photo(bencher: Bencher<'_, '_>) {
    let file = OwnNetwork::by_chance(Dimensions::default(), 1).file();
    let model = Model::parse(&file).unwrap();
    let bytes = picture(64, 64);
    let image = Image::try_new(64, 64, Pixels::Rgb888, &bytes).unwrap();
    let window = image.middle().unwrap();
    let mut scratch = Scratch::new();
    assert_eq!(model.encode(&image, &window, &mut scratch).embedding.len(), 96);
    bencher.bench_local(|| model.encode(black_box(&image), &window, &mut scratch).embedding[0]);
}

/// Ten views from all around, and a sketch in which a round object fills half of the picture.
fn views() -> (Vec<Stance>, [i8; SKETCH]) {
    let pool = Pool::try_new(ViewSpace::FibonacciSphere, 10, 3.0).unwrap();
    let stances = pool.iter().map(|pose| Stance::try_new(&pose, Vec3::ZERO).unwrap()).collect();
    let mut sketch = [40; SKETCH];
    for (place, cover) in sketch[..COVER * COVER].iter_mut().enumerate() {
        let (x, y) = (2 * (place % COVER) as i32 - 15, 2 * (place / COVER) as i32 - 15);
        *cover = if x * x + y * y < 12 * 12 { 127 } else { 0 };
    }
    (stances, sketch)
}

/// An outline carved from the whole hull: the first photo, and so the most expensive.
#[divan::bench]
fn carve_an_outline(bencher: Bencher<'_, '_>) {
    let (stances, sketch) = views();
    let mut form = Box::new(Form::new());
    bencher.bench_local(|| {
        form.begin();
        form.take_in(black_box(&stances[3]), &sketch);
    });
}

/// What 100 candidates would see of the hull after 10 views.
#[divan::bench]
fn outlooks_of_100_candidates_after_10_views(bencher: Bencher<'_, '_>) {
    let (stances, sketch) = views();
    let mut form = Box::new(Form::new());
    form.begin();
    for stance in &stances {
        form.take_in(stance, &sketch);
    }
    let direction = |pose: &Pose| Direction::try_from_vector(pose.position()).unwrap();
    let candidates: Vec<Direction> = poses().iter().map(direction).collect();
    let mut outlooks = [[0; OUTLOOK]; 100];
    let mut compute = || {
        let seen = stances.iter().map(|stance| (stance, sketch.as_slice()));
        form.outlooks(seen, black_box(&candidates), &mut outlooks, |_, _| ());
        outlooks[0]
    };
    assert!(compute().iter().any(|&number| number != 0));
    bencher.bench_local(compute);
}

/// A photo of 64 x 64 pixels taken in, and 100 candidates scored: the first view of a session.
#[divan::bench(args = [true, false])]
fn step_with_100_candidates(bencher: Bencher<'_, '_>, images: bool) {
    let sizes = Dimensions::default();
    let sizes = if images { sizes } else { sizes.without_images() };
    let file = OwnNetwork::by_chance(sizes, 1).file();
    let model = Model::parse(&file).unwrap();
    let bytes = picture(64, 64);
    let photo = Photo::new(Image::try_new(64, 64, Pixels::Rgb888, &bytes).unwrap());
    let poses = poses();
    bencher
        .with_inputs(|| {
            let memory = Fixed::<100, 1>::new();
            SoarNet::try_new(model, memory, Vec3::ZERO, poses.iter().copied()).unwrap()
        })
        .bench_local_values(|mut scorer| {
            scorer.observe(&poses[7], black_box(&photo)).unwrap();
            assert!(scorer.gain(Objective::Coverage, 3, &poses[3]) != 0.0);
            scorer
        });
}
