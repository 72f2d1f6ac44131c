//! The network: as its plain definition has it, in any order, and across a loss of power.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::cases;
use common::network::{OwnLayer, OwnNetwork, SMALL, SUM};
use proptest::prelude::*;
use rand_core::Rng;
use rand_pcg::Pcg32;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::{self, Plan, Scorer, Session};
use vantage_core::soarnet::features::{Direction, Stance, count};
use vantage_core::soarnet::{
    Dimensions, Fixed, Form, Image, Model, Photo, PhotoError, Pixels, Scratch, SetupError, SoarNet,
    Window,
};
use vantage_core::{Objective, Pose, Vec3};

const CANDIDATES: usize = 14;
const CENTRE: Vec3 = Vec3::new(0.1, -0.2, 0.05);

type Room = Fixed<16, 8>;

fn poses() -> Vec<Pose> {
    Pool::try_new(ViewSpace::FibonacciSphere, CANDIDATES, 2.0).unwrap().iter().collect()
}

/// Coloured noise and a slope, 80 x 70 pixels.
fn picture(seed: u64) -> Vec<u8> {
    let mut chance = Pcg32::new(seed, 1);
    (0..80 * 70 * 3).map(|i| (i / 80 + (chance.next_u32() >> 25) as usize) as u8).collect()
}

fn photo(bytes: &[u8]) -> Photo<'_> {
    Photo::new(Image::try_new(80, 70, Pixels::Rgb888, bytes).unwrap())
}

/// What a scorer says: ranks, state, gains and scores as bits.
fn answers<M: vantage_core::soarnet::Memory>(scorer: &SoarNet<'_, M>) -> Vec<i64> {
    let mut all: Vec<i64> = scorer.state().iter().map(|&value| value.into()).collect();
    for (index, pose) in poses().iter().enumerate() {
        all.extend(scorer.ranks(index).unwrap().map(i64::from));
        all.extend(Objective::ALL.map(|o| i64::from(scorer.gain(o, index, pose).to_bits())));
        all.push(scorer.support(index, pose).to_bits().into());
        let (sums, maxima) = scorer.pooled(index).unwrap();
        all.extend(sums.iter().map(|&sum| i64::from(sum)));
        all.extend(maxima.iter().map(|&maximum| i64::from(maximum)));
    }
    all.extend(Objective::ALL.map(|o| i64::from(scorer.scores().get(o).to_bits())));
    all
}

/// A scorer that has taken in photos of these candidates, in this order.
fn after<'m>(model: Model<'m>, views: &[usize]) -> SoarNet<'m, Room> {
    let mut scorer = SoarNet::try_new(model, Room::new(), CENTRE, poses()).unwrap();
    for &view in views {
        scorer.observe(&poses()[view], &photo(&picture(view as u64))).unwrap();
    }
    scorer
}

// ---- the plain definition ----

fn requantized(sum: i128, multiplier: i32, shift: u32) -> i128 {
    (2 * sum * i128::from(multiplier) + (1 << shift)).div_euclid(2 << shift)
}

fn sums(layer: &OwnLayer, input: &[i8]) -> Vec<i128> {
    assert_eq!(layer.weights.len(), layer.bias.len() * input.len());
    let rows = layer.weights.chunks(input.len()).zip(&layer.bias);
    rows.map(|(row, &bias)| {
        let products = row.iter().zip(input).map(|(&w, &q)| i128::from(w) * i128::from(q));
        i128::from(bias) + products.sum::<i128>()
    })
    .collect()
}

fn bytes(layer: &OwnLayer, input: &[i8], cut: bool) -> Vec<i8> {
    let low = if cut { layer.zero } else { -128 };
    let scale = |(sum, &m): (i128, &i32)| {
        (requantized(sum, m, 32) + i128::from(layer.zero)).clamp(low.into(), 127) as i8
    };
    sums(layer, input).into_iter().zip(&layer.multipliers).map(scale).collect()
}

fn wide(layer: &OwnLayer, input: &[i8]) -> Vec<i32> {
    let scale = |(sum, &m): (i128, &i32)| requantized(sum, m, 20) as i32;
    sums(layer, input).into_iter().zip(&layer.multipliers).map(scale).collect()
}

fn convolved(
    layer: &OwnLayer,
    stride: usize,
    side: usize,
    border: i8,
    map: &[i8],
    cut: bool,
) -> Vec<i8> {
    let channels = map.len() / (side * side);
    let mut output = Vec::new();
    for (y, x) in (0..side / stride).flat_map(|y| (0..side / stride).map(move |x| (y, x))) {
        let mut window = Vec::new();
        for (dy, dx) in (0..3).flat_map(|dy| (0..3).map(move |dx| (dy, dx))) {
            let (y, x) = ((y * stride + dy).wrapping_sub(1), (x * stride + dx).wrapping_sub(1));
            if y < side && x < side {
                window.extend(&map[(y * side + x) * channels..][..channels]);
            } else {
                window.extend(vec![border; channels]);
            }
        }
        output.extend(bytes(layer, &window, cut));
    }
    output
}

/// Embedding and sketch.
fn encoded(network: &OwnNetwork, input: &[i8]) -> (Vec<i8>, Vec<i8>) {
    let layers = &network.encoder;
    let mut sketch = vec![0; 320];
    let (mut map, mut side, mut zero) = (convolved(&layers[0], 2, 64, 0, input, true), 32, -128);
    for stage in 0..3 {
        let [down, first, second] = [1, 2, 3].map(|part| &layers[3 * stage + part]);
        let x = convolved(down, 2, side, zero, &map, true);
        side /= 2;
        let a = convolved(first, 1, side, down.zero, &x, true);
        let b = convolved(second, 1, side, first.zero, &a, false);
        let (multiplier, other_multiplier, sum_zero) = SUM;
        let sum = |(&x, &b): (&i8, &i8)| {
            let x = (i64::from(x) - i64::from(down.zero)) * i64::from(multiplier);
            let b = (i64::from(b) - i64::from(second.zero)) * i64::from(other_multiplier);
            let rounded = (x + b + (1 << 17)).div_euclid(1 << 18) + i64::from(sum_zero);
            rounded.clamp(sum_zero.into(), 127) as i8
        };
        map = x.iter().zip(&b).map(sum).collect();
        zero = sum_zero;
        if stage == 1 {
            let channels = layers[11].weights.len() / 5;
            for (cell, pixel) in map.chunks(channels).enumerate() {
                let (row, column) = (cell / 8, cell % 8);
                let told = bytes(&layers[11], pixel, false);
                for (quarter, &cover) in told[..4].iter().enumerate() {
                    let (y, x) = (2 * row + quarter / 2, 2 * column + quarter % 2);
                    sketch[16 * y + x] = cover;
                }
                sketch[256 + cell] = told[4];
            }
        }
    }
    (bytes(&layers[10], &map, false), sketch)
}

fn mean(values: &[i8]) -> i8 {
    let sum: i32 = values.iter().map(|&value| i32::from(value)).sum();
    (f64::from(sum) / values.len() as f64 + 0.5).floor() as i8
}

/// Ranks of every candidate and the state, from all views at once; `outlooks` of each candidate.
fn at_once(
    network: &OwnNetwork,
    views: &[(Vec<i8>, Stance)],
    outlooks: &[Vec<i8>],
) -> (Vec<Vec<i32>>, Vec<i32>) {
    let [token_1, token_2, hidden, output, state_hidden, state_output] = &network.heads[..] else {
        unreachable!()
    };
    let counted = count(views.len());
    let (mut ranks, mut all) = (Vec::new(), Vec::new());
    for (pose, outlook) in poses().iter().zip(outlooks) {
        let direction = Direction::try_from_vector(pose.position() - CENTRE).unwrap();
        let tokens: Vec<Vec<i8>> = views
            .iter()
            .map(|(embedding, stance)| {
                let features = stance.direction.features();
                let relation = stance.relation(direction);
                let input = [embedding.as_slice(), &features, &relation].concat();
                bytes(token_2, &bytes(token_1, &input, true), true)
            })
            .collect();
        let column = |h: usize| tokens.iter().map(|token| token[h]).collect::<Vec<i8>>();
        let width = network.dimensions.width;
        let means: Vec<i8> = (0..width).map(|h| mean(&column(h))).collect();
        let maxima: Vec<i8> = (0..width).map(|h| *column(h).iter().max().unwrap()).collect();
        let pooled = [means, maxima].concat();
        let input = [pooled.as_slice(), outlook, &direction.features(), &counted].concat();
        ranks.push(wide(output, &bytes(hidden, &input, true)));
        all.push(pooled);
    }
    let context: Vec<i8> = (0..all[0].len())
        .map(|h| mean(&all.iter().map(|pooled| pooled[h]).collect::<Vec<i8>>()))
        .collect();
    let input = [context.as_slice(), &counted].concat();
    (ranks, wide(state_output, &bytes(state_hidden, &input, true)))
}

#[test]
fn the_network_is_its_plain_definition() {
    for (dimensions, seed) in [(SMALL, 1), (SMALL.without_images(), 2), (Dimensions::default(), 3)]
    {
        let network = OwnNetwork::by_chance(dimensions, seed);
        let file = network.file();
        let model = Model::parse(&file).unwrap();
        let mut scorer = SoarNet::try_new(model, Room::new(), CENTRE, poses()).unwrap();
        let mut views = Vec::new();
        for view in [3, 9, 4] {
            let pose = poses()[view];
            let bytes = picture(view as u64);
            let photo = photo(&bytes).with_window(Window::try_new(-3, 5, 71).unwrap());
            scorer.observe(&pose, &photo).unwrap();

            let mut input = [0; vantage_core::soarnet::INPUT];
            photo.image.unwrap().resize(&photo.window.unwrap(), &mut input);
            let (embedding, sketch) = match dimensions.embedding {
                0 => (vec![], None),
                _ => {
                    let (embedding, sketch) = encoded(&network, &input);
                    (embedding, Some(sketch))
                }
            };
            assert_eq!(scorer.sketch(views.len()).map(|sketch| sketch.to_vec()), sketch);
            // Not all the same, and not all at the ends of the range.
            let middle = embedding.iter().filter(|value| value.unsigned_abs() < 127).count();
            assert!(middle * 2 >= embedding.len(), "{embedding:?}");
            assert_eq!(scorer.embedding(views.len()).unwrap(), embedding);
            views.push((embedding, Stance::try_new(&pose, CENTRE).unwrap()));

            let outlooks: Vec<Vec<i8>> = (0..CANDIDATES)
                .map(|candidate| match dimensions.embedding {
                    0 => vec![],
                    _ => scorer.outlook(candidate).unwrap().map(|number| number as i8).to_vec(),
                })
                .collect();
            let told = (0..CANDIDATES).filter_map(|candidate| scorer.outlook(candidate));
            assert_eq!(told.flatten().any(|number| number != 0), dimensions.embedding > 0);
            let (ranks, state) = at_once(&network, &views, &outlooks);
            assert_eq!(scorer.state().as_slice(), state);
            for (index, expected) in ranks.iter().enumerate() {
                assert_eq!(scorer.ranks(index).unwrap().as_slice(), expected);
            }
            assert!(ranks.iter().any(|rank| *rank != ranks[0]), "every candidate ranks the same");
        }
    }
}

#[test]
fn a_photo_encodes_to_the_same_in_and_out_of_a_session() {
    let file = OwnNetwork::by_chance(SMALL, 5).file();
    let model = Model::parse(&file).unwrap();
    let bytes = picture(0);
    let image = photo(&bytes).image.unwrap();
    let mut scratch = Scratch::new();
    let seen = model.encode(&image, &image.middle().unwrap(), &mut scratch);
    let scorer = after(model, &[0]);
    assert_eq!(scorer.embedding(0).unwrap(), seen.embedding);
    assert_eq!(scorer.sketch(0).unwrap(), seen.sketch);
}

#[test]
fn gains_are_mean_and_spread_and_keep_the_order_of_ranks() {
    let file = OwnNetwork::by_chance(SMALL, 6).file();
    let scorer = after(Model::parse(&file).unwrap(), &[1, 2, 3]);
    for (o, objective) in Objective::ALL.into_iter().enumerate() {
        let state = scorer.state().map(|value| f64::from(value) / 65536.0);
        let (mean, spread) = (state[4 + o], state[8 + o].max(1.0 / 65536.0));
        let mut seen: Vec<(i32, f32)> = Vec::new();
        for (index, pose) in poses().iter().enumerate() {
            let rank = scorer.ranks(index).unwrap()[o];
            let gain = scorer.gain(objective, index, pose);
            let expected = (mean + spread * f64::from(rank) / 65536.0) / 3.0;
            assert!((f64::from(gain) - expected).abs() <= expected.abs() * 2e-7);
            seen.push((rank, gain));
        }
        seen.sort_by_key(|(rank, _)| *rank);
        assert!(seen.is_sorted_by(|(_, a), (_, b)| a <= b));
        assert_eq!(scorer.gain(objective, CANDIDATES, &poses()[0]), 0.0);
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn the_order_of_views_changes_nothing(
        views in Just((0..CANDIDATES).collect::<Vec<usize>>()).prop_shuffle(), taken in 1usize..6, seed: u64,
    ) {
        let file = OwnNetwork::by_chance(SMALL, seed).file();
        let model = Model::parse(&file).unwrap();
        let mut views = views[..taken].to_vec();
        let before = answers(&after(model, &views));
        views.reverse();
        prop_assert_eq!(&before, &answers(&after(model, &views)));
        views.rotate_left(taken / 2);
        prop_assert_eq!(&before, &answers(&after(model, &views)));
    }

    #[test]
    fn candidates_in_another_order_gain_the_same(
        order in Just((0..CANDIDATES).collect::<Vec<usize>>()).prop_shuffle(), seed: u64,
    ) {
        let file = OwnNetwork::by_chance(SMALL, seed).file();
        let model = Model::parse(&file).unwrap();
        let poses = poses();
        let moved = order.iter().map(|&index| poses[index]);
        let mut other = SoarNet::try_new(model, Room::new(), CENTRE, moved).unwrap();
        for view in [2, 7] {
            other.observe(&poses[view], &photo(&picture(view as u64))).unwrap();
        }
        let scorer = after(model, &[2, 7]);
        prop_assert_eq!(scorer.state(), other.state());
        for (place, &index) in order.iter().enumerate() {
            prop_assert_eq!(scorer.ranks(index), other.ranks(place));
            let support = |scorer: &SoarNet<'_, Room>, at| scorer.support(at, &poses[index]);
            prop_assert_eq!(support(&scorer, index), support(&other, place));
            for objective in Objective::ALL {
                let pose = &poses[index];
                prop_assert_eq!(scorer.gain(objective, index, pose), other.gain(objective, place, pose));
            }
        }
    }
}

#[test]
fn clutter_is_what_is_covered_beyond_the_ball() {
    let mut most = 0.0f64;
    for seed in 0..12 {
        let file = OwnNetwork::by_chance(SMALL, seed).file();
        let scorer = after(Model::parse(&file).unwrap(), &[1, 4, 6]);
        let middle = |place: usize| (place as f64 + 0.5) / 8.0 - 1.0;
        let (mut beside, mut covered) = (0.0, 0.0);
        for sketch in (0..3).map(|view| scorer.sketch(view).unwrap()) {
            for (row, column) in (0..16).flat_map(|row| (0..16).map(move |column| (row, column))) {
                if middle(row).hypot(middle(column)) > 1.1 {
                    beside += 1.0;
                    covered += f64::from(sketch[16 * row + column] > 63);
                }
            }
        }
        assert!(beside > 3.0 * 10.0);
        assert!((f64::from(scorer.clutter()) - covered / beside).abs() < 1e-6);
        most = most.max(covered / beside);
    }
    assert!(most > 0.05, "{most}");
}

#[test]
fn before_the_first_photo_nothing_is_known() {
    let file = OwnNetwork::by_chance(SMALL, 7).file();
    let scorer = after(Model::parse(&file).unwrap(), &[]);
    assert_eq!(scorer.scores(), vantage_core::Scores::default());
    assert_eq!(scorer.gain(Objective::Coverage, 0, &poses()[0]), 0.0);
    assert_eq!((scorer.support(0, &poses()[0]), scorer.clutter()), (0.0, 0.0));
    assert_eq!(scorer.embedding(0), None);
}

#[test]
fn after_an_error_nothing_has_changed() {
    let file = OwnNetwork::by_chance(SMALL, 8).file();
    let model = Model::parse(&file).unwrap();
    let mut scorer = SoarNet::try_new(model, Fixed::<16, 2>::new(), CENTRE, poses()).unwrap();
    let (bytes, pose) = (picture(1), poses()[1]);
    scorer.observe(&pose, &photo(&bytes)).unwrap();
    let before = answers(&scorer);

    assert_eq!(scorer.observe(&pose, &Photo::default()), Err(PhotoError::NoImage));
    let there = Pose::looking_at(CENTRE, Vec3::ZERO).unwrap();
    assert_eq!(scorer.observe(&there, &photo(&bytes)), Err(PhotoError::NoDirection));
    assert_eq!(before, answers(&scorer));

    scorer.observe(&pose, &photo(&bytes)).unwrap();
    let before = answers(&scorer);
    let full = Err(PhotoError::TooManyViews { capacity: 2 });
    assert_eq!(scorer.observe(&pose, &photo(&bytes)), full);
    assert_eq!(before, answers(&scorer));
}

#[test]
fn what_does_not_fit_the_memory_is_refused() {
    let file = OwnNetwork::by_chance(SMALL, 9).file();
    let model = Model::parse(&file).unwrap();
    let few = SoarNet::try_new(model, Fixed::<13, 2, 24, 20>::new(), CENTRE, poses());
    assert_eq!(few.err(), Some(SetupError::TooManyCandidates { capacity: 13 }));
    let inside = SoarNet::try_new(model, Room::new(), poses()[4].position(), poses());
    assert_eq!(inside.err(), Some(SetupError::NoDirection { index: 4 }));
    // A narrower memory holds fewer candidates and views.
    let narrow = SoarNet::try_new(model, Fixed::<28, 4, 12, 10>::new(), CENTRE, poses()).unwrap();
    assert_eq!(narrow.view_capacity(), 2);
}

#[test]
fn a_whole_session_is_planned() {
    let file = OwnNetwork::by_chance(SMALL, 10).file();
    let model = Model::parse(&file).unwrap();
    let mut memory = Room::new();
    let scorer = SoarNet::try_new(model, &mut memory, Vec3::ZERO, poses()).unwrap();
    let room = planner::Fixed::<16, 8>::default();
    let mut session = Session::try_new(room, poses(), scorer, Plan::ensemble(8)).unwrap();
    let mut frame = Vec::new();
    while let Some(next) = session.next_view() {
        // One buffer for every photo.
        frame.clear();
        frame.extend(picture(next.index as u64));
        session.observe(next.index, next.pose, &photo(&frame)).unwrap();
    }
    assert_eq!(session.views().len(), 8);
    assert!(session.views()[3..].iter().any(|view| view.gain != 0.0));
}

#[cfg(feature = "serde")]
#[test]
fn a_session_goes_on_after_a_loss_of_power() {
    use vantage_core::record::SnapshotError;

    let file = OwnNetwork::by_chance(SMALL, 11).file();
    let model = Model::parse(&file).unwrap();
    let scorer = || SoarNet::try_new(model, Room::new(), Vec3::ZERO, poses()).unwrap();
    let room = planner::Fixed::<16, 8>::default;
    let plan = Plan::ensemble(8).with_centre(Vec3::ZERO);
    let mut session = Session::try_new(room(), poses(), scorer(), plan).unwrap();
    let mut buffer = vec![0; 5000];
    while let Some(next) = session.next_view() {
        let used = session.snapshot(&mut buffer).unwrap();
        session = Session::restore(room(), scorer(), &buffer[..used]).unwrap();
        assert_eq!(session.next_view(), Some(next));
        session.observe(next.index, next.pose, &photo(&picture(next.index as u64))).unwrap();
    }
    let mut never = Session::try_new(room(), poses(), scorer(), plan).unwrap();
    while let Some(next) = never.next_view() {
        never.observe(next.index, next.pose, &photo(&picture(next.index as u64))).unwrap();
    }
    assert_eq!(session.views(), never.views());
    assert_eq!(session.scores(), never.scores());

    let used = session.snapshot(&mut buffer).unwrap();
    let other = OwnNetwork::by_chance(SMALL, 12).file();
    let other = Model::parse(&other).unwrap();
    let other = SoarNet::try_new(other, Room::new(), Vec3::ZERO, poses()).unwrap();
    let refused = Session::restore(room(), other, &buffer[..used]).err();
    assert_eq!(refused, Some(SnapshotError::OtherScorer));
    let small = SoarNet::try_new(model, Fixed::<16, 7>::new(), Vec3::ZERO, poses()).unwrap();
    let refused = Session::restore(room(), small, &buffer[..used]).err();
    assert_eq!(refused, Some(SnapshotError::TooLarge));
}

#[test]
fn state_and_scratch_stay_within_their_budget() {
    // As the documentation of each says.
    assert!(size_of::<Scratch>() <= 33 * 1024, "{}", size_of::<Scratch>());
    assert!(size_of::<Form>() <= 45 * 1024, "{}", size_of::<Form>());
    assert!(size_of::<Fixed<128, 64>>() <= 170 * 1024, "{}", size_of::<Fixed<128, 64>>());
    let parts = size_of::<Fixed<128, 64>>() + size_of::<planner::Fixed<128, 64>>();
    let session = size_of::<Session<SoarNet<'_, Fixed<128, 64>>, planner::Fixed<128, 64>>>();
    assert!(parts <= session && session <= 192 * 1024, "{parts} {session}");
}
