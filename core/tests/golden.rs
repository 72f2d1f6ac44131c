//! Against values that others' programs computed: see tests/golden/README.md.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::{Photo, Scene};
use vantage_core::objectives::{
    FLAT, Face, Form, Reading, hue_saturation, local_binary_pattern, smoothing,
};
use vantage_core::{Objective, Vec3};

macro_rules! golden {
    ($name:literal) => {
        include_str!(concat!("../../tests/golden/", $name))
    };
}

macro_rules! crop {
    ($name:literal) => {
        Crop {
            name: $name,
            rgb: include_bytes!(concat!("../../tests/golden/texture/", $name, ".rgb")),
            codes: include_bytes!(concat!("../../tests/golden/texture/", $name, ".lbp")),
        }
    };
}

/// A picture and scikit-image's codes of its inner pixels.
struct Crop {
    name: &'static str,
    rgb: &'static [u8; SIZE * SIZE * 3],
    codes: &'static [u8; INSIDE * INSIDE],
}

const SIZE: usize = 48;
const MARGIN: usize = 3;
const INSIDE: usize = SIZE - 2 * MARGIN;
const CROPS: [Crop; 4] = [crop!("astronaut"), crop!("coffee"), crop!("chelsea"), crop!("rocket")];

/// The lines of a file as words, without comments.
fn records(text: &str) -> impl Iterator<Item = Vec<&str>> {
    text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(' ').collect())
}

fn numbers<const N: usize>(words: &[&str]) -> [f64; N] {
    core::array::from_fn(|index| words[index].parse().unwrap())
}

fn vector(words: &[&str]) -> Vec3 {
    Vec3::from(numbers::<3>(words).map(|x| x as f32))
}

impl Crop {
    /// A pixel of hue (channel 0) or saturation (1).
    fn sample(&self, channel: usize, x: i32, y: i32) -> Option<u8> {
        let inside = 0..SIZE as i32;
        (inside.contains(&x) && inside.contains(&y)).then(|| {
            let place = 3 * (y as usize * SIZE + x as usize);
            hue_saturation([0, 1, 2].map(|colour| self.rgb[place + colour]))[channel]
        })
    }

    fn codes(&self, channel: usize) -> [Vec<u8>; 2] {
        let ours = (0..INSIDE * INSIDE).map(|place| {
            let (x, y) = (place % INSIDE + MARGIN, place / INSIDE + MARGIN);
            local_binary_pattern(x as i32, y as i32, |x, y| self.sample(channel, x, y))
        });
        [ours.collect(), self.codes.iter().map(|code| code >> (3 * channel) & 7).collect()]
    }
}

#[test]
fn the_local_binary_pattern_is_that_of_scikit_image() {
    // All of them, though scikit-image places the neighbours to 1e-5 pixel and interpolates in
    // floating point, and we to 1/4096 pixel in integers: only a near tie could tell the two apart.
    let mut flat = 0;
    for (crop, channel) in CROPS.iter().flat_map(|crop| [(crop, 0), (crop, 1)]) {
        let [ours, theirs] = crop.codes(channel);
        let differ = ours.iter().zip(&theirs).filter(|(ours, theirs)| ours != theirs).count();
        assert_eq!(differ, 0, "{}, channel {channel}: of {}", crop.name, ours.len());
        flat += ours.iter().filter(|&&code| code == FLAT).count();
    }
    // Of 14112.
    assert!(flat > 2000, "{flat} pixels with the last bin's code say too little");
}

#[test]
fn the_share_of_textured_pixels_is_that_of_scikit_image() {
    for (words, crop) in records(golden!("texture.txt")).zip(&CROPS) {
        assert_eq!(words[0], crop.name);
        for channel in [0, 1] {
            let [ours, _] = crop.codes(channel);
            let textured = ours.iter().filter(|&&code| code != FLAT).count();
            let expected: f64 = words[1 + channel].parse().unwrap();
            // Nine decimals are recorded.
            assert!((textured as f64 / ours.len() as f64 - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn hue_and_saturation_are_within_half_a_step_of_the_textbooks() {
    let mut count = 0;
    for words in records(golden!("hue_saturation.txt")) {
        let [r, g, b, hue, saturation] = numbers(&words);
        let [h, s] = hue_saturation([r as u8, g as u8, b as u8]).map(f64::from);
        // Seven decimals are recorded.
        let off = (h - 256.0 * hue).rem_euclid(256.0);
        assert!(off.min(256.0 - off) <= 0.5 + 1e-4, "{words:?}: hue {h}");
        assert!((s - 255.0 * saturation).abs() <= 0.5 + 1e-4, "{words:?}: saturation {s}");
        count += 1;
    }
    assert_eq!(count, 364);
}

#[test]
fn smoothing_is_the_papers_xi() {
    let mut count = 0;
    for words in records(golden!("smoothing.txt")) {
        let [x, xi] = numbers(&words);
        // Eight roundings at arguments of up to 12 before the exponential, where xi is not flat.
        assert!((f64::from(smoothing(x as f32)) - xi).abs() < 5e-7, "{words:?}");
        count += 1;
    }
    assert_eq!(count, 85);
}

#[test]
fn scores_are_those_that_numpy_computes() {
    let mut scene = Scene { faces: Vec::new(), texture_total: 0.0, photos: Vec::new() };
    let mut expected: Vec<(Reading, Vec<[f64; 4]>)> = Vec::new();
    for words in records(golden!("scores.txt")) {
        let rest = &words[1..];
        match words[0] {
            "texture_total" => scene.texture_total = rest[0].parse().unwrap(),
            "face" => scene.faces.push(Face {
                centroid: vector(rest),
                normal: vector(&rest[3..]),
                area_share: rest[6].parse().unwrap(),
                complexity: rest[7].parse().unwrap(),
            }),
            "view" => {
                let (mut words, mut textured) = (vec![0u32; 1], Vec::new());
                for shown in &rest[5..] {
                    let (face, count) = shown.split_once(':').unwrap();
                    words[0] |= 1 << face.parse::<u32>().unwrap();
                    textured.push(count.parse().unwrap());
                }
                scene.photos.push(Photo {
                    camera: vector(rest),
                    words,
                    textured,
                    textured_background: rest[3].parse().unwrap(),
                    pixels: rest[4].parse().unwrap(),
                });
            }
            "reading" => {
                let form = if rest[0] == "literal" { Form::Literal } else { Form::Default };
                let [geometry_discount, texture_discount, sigma_q, beta_q] =
                    numbers::<4>(&rest[1..]).map(|x| x as f32);
                let reading =
                    Reading { form, geometry_discount, texture_discount, sigma_q, beta_q };
                expected.push((reading, Vec::new()));
            }
            "scores" => expected.last_mut().unwrap().1.push(numbers(rest)),
            other => panic!("unknown record {other}"),
        }
    }
    assert_eq!((scene.faces.len(), scene.photos.len(), expected.len()), (24, 10, 4));
    let mut largest = [0.0f64; 4];
    for (reading, rows) in expected {
        let mut accounts = scene.accounts();
        let mut ledger = scene.ledger(reading, &mut accounts);
        assert_eq!(rows.len(), scene.photos.len());
        for (photo, row) in scene.photos.iter().zip(rows) {
            ledger.add(photo.camera, &photo.sighting());
            let scores = ledger.scores();
            for (place, (objective, expected)) in Objective::ALL.into_iter().zip(row).enumerate() {
                let off = (f64::from(scores.get(objective)) - expected).abs();
                largest[place] = largest[place].max(off);
                // Nine digits are recorded, of sums in double precision over f32 accounts; no face
                // here is seen along a plane, where D's cube root would magnify a rounding.
                assert!(off < 2e-6, "{objective}: {} is not {expected}", scores.get(objective));
            }
        }
    }
    println!("largest differences in C, Q, D, T: {largest:?}");
}
