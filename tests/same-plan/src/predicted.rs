//! Whole plans by a network: what it makes of photos, every gain, and the views that follow.
//!
//! Network and photos come from a generator of numbers by chance, so they mean nothing; what counts is
//! that every target makes the same of them.

use core::fmt::{self, Write};

use rand_core::Rng;
use rand_pcg::Pcg32;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::{self, NextView, Plan, Scorer, Session};
use vantage_core::soarnet::{
    Dimensions, EncoderParts, Fixed, Image, Layer, Model, Network, OUTLOOK, Photo, Pixels, SoarNet,
    Stage, Window,
};
use vantage_core::{Objective, Pose, Scores, Vec3};

use crate::line;

/// Candidates of a session.
pub const CANDIDATES: usize = 40;
const VIEWS: usize = 10;
const CENTRE: Vec3 = Vec3::new(0.05, -0.1, 0.02);

const SIZES: Dimensions =
    Dimensions { channels: [4, 8, 12, 8], embedding: 16, width: 24, head: 16, context: 8 };

type Room = planner::Fixed<CANDIDATES, VIEWS>;
type Memory = Fixed<CANDIDATES, VIEWS, 24, 16>;

/// Bytes of a model file, at most.
pub const FILE: usize = 24 * 1024;

const WIDTH: usize = 90;
const HEIGHT: usize = 70;

/// Bytes of a picture, shape (70, 90, 3).
pub const PICTURE: usize = WIDTH * HEIGHT * 3;

/// Numbers by chance that all layers share: each begins at another place.
struct Numbers {
    weights: [i8; 2400],
    biases: [i32; 64],
    multipliers: [i32; 64], // 2^20 / 16 and a little more
    layers: usize,          // handed out so far
}

impl Numbers {
    fn new(seed: u64) -> Self {
        let mut chance = Pcg32::new(seed, 0xda3e_39cb_94b9_5bdb);
        let mut below = |bound: u32| (chance.next_u32() >> 8) % bound;
        Self {
            weights: [0; 2400].map(|_: i8| (below(255) as i32 - 127) as i8),
            biases: [0; 64].map(|_: i32| below(20_000) as i32 - 10_000),
            multipliers: [0; 64].map(|_: i32| 65_536 + below(1_000) as i32),
            layers: 0,
        }
    }
}

/// Where a layer's numbers begin, and its multipliers: sums are about 5500 roots of its columns.
#[derive(Clone, Copy)]
struct Made {
    multipliers: [i32; 64],
    first: usize,
    rows: usize,
    columns: usize,
    zero: i8,
}

impl Made {
    /// A layer whose outputs are about `gain`: units of 2^-32, or of 2^-20 where they are wide.
    fn new(numbers: &mut Numbers, rows: usize, columns: usize, zero: i8, gain: u64) -> Self {
        let typical = 5_476 * (columns as u64).isqrt();
        let scale = gain.checked_div(typical).unwrap_or_default();
        numbers.layers += 1;
        Self {
            multipliers: numbers.multipliers.map(|m| ((scale * m as u64) >> 16) as i32),
            first: 17 * numbers.layers,
            rows,
            columns,
            zero,
        }
    }

    fn layer<'a>(&'a self, numbers: &'a Numbers) -> Layer<'a> {
        let last = self.first + self.rows * self.columns;
        Layer {
            weights: numbers.weights.get(self.first..last).unwrap_or_default(),
            bias: numbers.biases.get(..self.rows).unwrap_or_default(),
            multipliers: self.multipliers.get(..self.rows).unwrap_or_default(),
            zero: self.zero,
        }
    }
}

/// Writes the file of the network, with images or without, that the section "plans by a network" goes
/// by, and gives its length.
pub fn network(with_images: bool, file: &mut [u8; FILE]) -> Result<usize, fmt::Error> {
    write(if with_images { SIZES } else { SIZES.without_images() }, 2, file)
}

/// Writes a network by chance and gives the length of its file.
fn write(sizes: Dimensions, seed: u64, file: &mut [u8]) -> Result<usize, fmt::Error> {
    let numbers = &mut Numbers::new(seed);
    let Dimensions { channels: [c0, c1, c2, c3], embedding, width, head, context } = sizes;
    let (byte, wide) = (60 << 32, 1 << 35);
    let mut make = |rows, columns, zero, gain| Made::new(numbers, rows, columns, zero, gain);
    let stem = make(c0, 27, -128, byte);
    let stages = [(c0, c1), (c1, c2), (c2, c3)].map(|(from, to)| {
        [make(to, 9 * from, -128, byte), make(to, 9 * to, -90, byte), make(to, 9 * to, 5, byte)]
    });
    // Above 0, so that a few photos leave something of the hull.
    let sketch = make(5, c2, 40, byte);
    let embed = make(embedding, 16 * c3, -3, byte);
    let token = [make(width, embedding + 32, -128, byte), make(width, width, -120, byte)];
    let outlook = if embedding > 0 { OUTLOOK } else { 0 };
    let candidate = [make(head, 2 * width + outlook + 20, -128, byte), make(4, head, 0, wide)];
    let state = [make(context, 2 * width + 4, -128, byte), make(12, context, 0, wide)];

    let numbers = &*numbers;
    let [one, two, three] = &stages;
    let network = Network {
        dimensions: sizes,
        encoder: (embedding > 0).then(|| EncoderParts {
            stem: stem.layer(numbers),
            stages: [residual(one, numbers), residual(two, numbers), residual(three, numbers)],
            sketch: sketch.layer(numbers),
            embed: embed.layer(numbers),
        }),
        token: token.each_ref().map(|made| made.layer(numbers)),
        candidate: candidate.each_ref().map(|made| made.layer(numbers)),
        state: state.each_ref().map(|made| made.layer(numbers)),
    };
    network.write(file).map_err(|_| fmt::Error)
}

fn residual<'a>([down, first, second]: &'a [Made; 3], numbers: &'a Numbers) -> Stage<'a> {
    Stage {
        down: down.layer(numbers),
        first: first.layer(numbers),
        second: second.layer(numbers),
        multiplier: 200_000,
        second_multiplier: 150_000,
        zero: -100,
    }
}

/// A picture that differs from candidate to candidate: slopes, a bright square and noise.
pub fn paint(index: usize, bytes: &mut [u8; PICTURE]) {
    let mut chance = Pcg32::new(index as u64, 7);
    let (left, top) = (index * 11 % 60, index * 7 % 40);
    let (pixels, _) = bytes.as_chunks_mut::<3>();
    for (place, pixel) in pixels.iter_mut().enumerate() {
        let (x, y) = (place % WIDTH, place / WIDTH);
        let inside = (left..left + 25).contains(&x) && (top..top + 25).contains(&y);
        let colours = [x + 4 * index, 2 * y, if inside { 200 } else { 20 + x / 2 }];
        for (value, colour) in pixel.iter_mut().zip(colours) {
            *value = (colour as u32 + (chance.next_u32() >> 27)).min(255) as u8;
        }
    }
}

/// A short number that stands for many: FNV-1a.
fn digest(bytes: impl IntoIterator<Item = u8>) -> u32 {
    bytes
        .into_iter()
        .fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

fn poses() -> impl Iterator<Item = Pose> {
    let pool = Pool::try_new(ViewSpace::FibonacciSphere, CANDIDATES, 1.5);
    (0..CANDIDATES).filter_map(move |index| pool.as_ref().ok()?.iter().nth(index))
}

/// Embeddings and every gain after each of a few photos, in both formats and several windows.
pub fn gains(out: &mut dyn Write) -> fmt::Result {
    for (name, sizes) in [("with images", SIZES), ("without", SIZES.without_images())] {
        let mut file = [0; FILE];
        let length = write(sizes, 1, &mut file)?;
        let model = Model::parse(file.get(..length).unwrap_or_default()).map_err(|_| fmt::Error)?;
        writeln!(out, "{name}: {length} bytes, checksum {:08x}", model.checksum())?;
        let mut scorer =
            SoarNet::try_new(model, Memory::new(), CENTRE, poses()).map_err(|_| fmt::Error)?;
        let windows = [None, Some((-10, 3, 64)), Some((20, -8, 100)), Some((30, 30, 9))];
        let mut picture = [0; PICTURE];
        for (view, (pose, window)) in poses().step_by(9).zip(windows).enumerate() {
            paint(view, &mut picture);
            let pixels = if view == 2 { Pixels::Rgb565 } else { Pixels::Rgb888 };
            let bytes = picture.get(..WIDTH * HEIGHT * pixels.bytes());
            let image =
                Image::try_new(WIDTH as u32, HEIGHT as u32, pixels, bytes.unwrap_or_default())
                    .map_err(|_| fmt::Error)?;
            let mut photo = Photo::new(image);
            if let Some((left, top, side)) = window {
                photo =
                    photo.with_window(Window::try_new(left, top, side).map_err(|_| fmt::Error)?);
            }
            scorer.observe(&pose, &photo).map_err(|_| fmt::Error)?;

            let embedding = scorer.embedding(view).unwrap_or_default();
            let embedding = digest(embedding.iter().map(|value| *value as u8));
            let sketch = scorer.sketch(view).into_iter().flatten();
            let sketch = digest(sketch.map(|value| *value as u8));
            let outlooks = (0..CANDIDATES).filter_map(|candidate| scorer.outlook(candidate));
            let outlooks = digest(outlooks.flatten().map(|number| number as u8));
            write!(out, "  view {view}: embedding {embedding:08x}, sketch {sketch:08x}, ")?;
            writeln!(out, "outlooks {outlooks:08x}, state {:?}", scorer.state())?;
            for (index, pose) in poses().enumerate() {
                let gains = Objective::ALL.map(|o| scorer.gain(o, index, &pose));
                line(out, format_args!("  {index}"), &gains)?;
            }
        }
    }
    Ok(())
}

/// Whole sessions, with a snapshot on the way.
pub fn plans(out: &mut dyn Write) -> fmt::Result {
    let plans = [
        ("ensemble", SIZES, Plan::ensemble(VIEWS)),
        ("ensemble without images", SIZES.without_images(), Plan::ensemble(VIEWS)),
        ("sum", SIZES, Plan::sum(VIEWS)),
        ("support", SIZES, Plan::support(VIEWS)),
        ("support without images: farthest", SIZES.without_images(), Plan::support(VIEWS)),
        (
            "diversity, movement costs 0.3",
            SIZES,
            Plan::single(Objective::Diversity, VIEWS).with_movement_cost(0.3),
        ),
    ];
    for (name, sizes, plan) in plans {
        writeln!(out, "{name}")?;
        let mut file = [0; FILE];
        let length = write(sizes, 2, &mut file)?;
        let model = Model::parse(file.get(..length).unwrap_or_default()).map_err(|_| fmt::Error)?;
        let (mut memory, mut other) = (Memory::new(), Memory::new());
        let scorer =
            SoarNet::try_new(model, &mut memory, CENTRE, poses()).map_err(|_| fmt::Error)?;
        let mut session =
            Session::try_new(Room::default(), poses(), scorer, plan.with_centre(CENTRE))
                .map_err(|_| fmt::Error)?;
        for _ in 0..5 {
            take(out, &mut session)?;
        }
        let mut kept = [0; 4096];
        let used = session.snapshot(&mut kept).map_err(|_| fmt::Error)?;
        let kept = kept.get(..used).unwrap_or_default();
        writeln!(out, "  snapshot: {used} bytes, {:08x}", digest(kept.iter().copied()))?;
        let scorer =
            SoarNet::try_new(model, &mut other, CENTRE, poses()).map_err(|_| fmt::Error)?;
        let mut session =
            Session::restore(Room::default(), scorer, kept).map_err(|_| fmt::Error)?;
        for _ in 5..VIEWS {
            take(out, &mut session)?;
        }
    }
    Ok(())
}

/// Takes the next view; a line of index, objective, gain and scores.
fn take(out: &mut dyn Write, session: &mut Session<SoarNet<'_, &mut Memory>, Room>) -> fmt::Result {
    let Some(NextView { index, pose, objective, gain, .. }) = session.next_view() else {
        return writeln!(out, "  no view");
    };
    let mut picture = [0; PICTURE];
    paint(index, &mut picture);
    let image = Image::try_new(WIDTH as u32, HEIGHT as u32, Pixels::Rgb888, &picture);
    let photo = Photo::new(image.map_err(|_| fmt::Error)?);
    session.observe(index, pose, &photo).map_err(|_| fmt::Error)?;
    let Scores { coverage, geometry, diversity, texture } = session.scores();
    let letter = objective.map_or('-', Objective::letter);
    line(out, format_args!("  {index} {letter}"), &[gain, coverage, geometry, diversity, texture])
}
