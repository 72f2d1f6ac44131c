//! The model file: the page's example in both directions, and nothing else is read.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::cases;
use common::network::{OwnLayer, OwnNetwork, SMALL};
use proptest::prelude::*;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::Scorer;
use vantage_core::soarnet::{
    Dimensions, Fault, Fixed, Image, Model, ModelError, Photo, Pixels, SoarNet, WriteError,
};
use vantage_core::{Objective, Vec3};

/// The network of the page's example.
fn example() -> OwnNetwork {
    let layer = |rows: usize, columns: usize, zero: i8| OwnLayer {
        weights: [3, -2, 1, 0, -1, 2, -3].into_iter().cycle().take(rows * columns).collect(),
        bias: [1000, -1000].into_iter().cycle().take(rows).collect(),
        multipliers: (0..rows as i32).map(|row| (1 << 26) + row).collect(),
        zero,
    };
    let dimensions = Dimensions { width: 4, head: 4, context: 4, ..Dimensions::default() };
    OwnNetwork {
        dimensions: dimensions.without_images(),
        encoder: Vec::new(),
        heads: vec![
            layer(4, 32, -128),
            layer(4, 4, -128),
            layer(4, 28, -128),
            layer(4, 4, 0),
            layer(4, 12, -128),
            layer(12, 4, 0),
        ],
    }
}

/// The bytes in the last block of the page: two digits each, up to a `|`.
fn page() -> Vec<u8> {
    let page = include_str!("../src/soarnet/FORMAT.md");
    let block = page.rsplit("```").nth(1).unwrap();
    let lines = block.lines().skip(1).map(|line| line.split('|').next().unwrap());
    lines
        .flat_map(str::split_whitespace)
        .map(|digits| u8::from_str_radix(digits, 16).unwrap())
        .collect()
}

#[test]
fn the_page_shows_the_example_byte_for_byte() {
    assert_eq!(example().file(), page(), "written");
    let page = page();
    let model = Model::parse(&page).unwrap();
    assert_eq!(*model.dimensions(), example().dimensions);
    assert_eq!(model.checksum().to_le_bytes(), page[page.len() - 4..]);
}

#[test]
#[ignore = "prints the example for the page, to be pasted there"]
fn print_the_example() {
    let file = example().file();
    let print = |bytes: &[u8], what: &str| {
        for (index, line) in bytes.chunks(16).enumerate() {
            let hex: Vec<String> = line.iter().map(|byte| format!("{byte:02x}")).collect();
            let text = if index == 0 { what } else { "" };
            println!("{}", format!("{:47} | {text}", hex.join(" ")).trim_end_matches([' ', '|']));
        }
    };
    print(&file[..4], "magic");
    print(&file[4..8], "version 3, reserved");
    print(&file[8..12], "length of the file");
    print(&file[12..20], "no channels");
    print(&file[20..28], "E = 0, H = K = G = 4");
    let layers = [
        ("token 1", 4, 32),
        ("token 2", 4, 4),
        ("candidate hidden", 4, 28),
        ("candidate output", 4, 4),
        ("state hidden", 4, 12),
        ("state output", 12, 4),
    ];
    let mut at = 28;
    for (name, rows, columns) in layers {
        let parts = [
            ("zero point", 4),
            ("biases", 4 * rows),
            ("multipliers", 4 * rows),
            ("weights", rows * columns),
        ];
        for (part, length) in parts {
            print(&file[at..at + length], &format!("{name}: {part}"));
            at += length;
        }
    }
    print(&file[at..], "CRC-32");
}

/// CRC-32 (ISO-HDLC) bit by bit, as its definition has it.
fn crc(bytes: &[u8]) -> u32 {
    let mut register = u32::MAX;
    for byte in bytes {
        register ^= u32::from(*byte);
        for _ in 0..8 {
            register = (register >> 1) ^ if register & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    !register
}

/// The same body with the right checksum.
fn sealed(mut file: Vec<u8>) -> Vec<u8> {
    let end = file.len() - 4;
    let checksum = crc(&file[..end]).to_le_bytes();
    file[end..].copy_from_slice(&checksum);
    file
}

/// Why the example with some bytes changed and a right checksum is refused.
fn refusal(at: usize, bytes: &[u8]) -> ModelError {
    let mut file = page();
    file[at..at + bytes.len()].copy_from_slice(bytes);
    Model::parse(&sealed(file)).unwrap_err()
}

#[test]
fn every_field_out_of_its_range_is_named() {
    let field = |layer, fault| ModelError::Field { layer, fault };
    assert_eq!(refusal(0, b"X"), ModelError::Foreign);
    assert_eq!(refusal(4, &[1]), ModelError::Version { got: 1 });
    assert_eq!(refusal(6, &[1]), field("header", Fault::Reserved));
    assert_eq!(refusal(8, &[0, 0]), ModelError::Length { expected: 0, got: page().len() });
    let dimension = |name, got, most| ModelError::Dimension { name, got, most };
    assert_eq!(refusal(22, &[6]), dimension("token width", 6, 128));
    assert_eq!(refusal(22, &[132]), dimension("token width", 132, 128));
    assert_eq!(refusal(26, &[0]), dimension("width of the state head", 0, 128));
    assert_eq!(refusal(12, &[4]), dimension("channels of the stem", 4, 0));
    assert_eq!(refusal(20, &[4]), dimension("channels of the stem", 0, 16));
    assert_eq!(refusal(24, &[8]), ModelError::Length { expected: 840, got: page().len() });
    // The first layer: zero point at 28, biases at 32, multipliers at 48, weights at 64.
    assert_eq!(refusal(29, &[1]), field("token 1", Fault::Reserved));
    assert_eq!(refusal(51, &[0x80]), field("token 1", Fault::Multiplier));
    assert_eq!(refusal(64, &[0x80]), field("token 1", Fault::Weight));
    assert_eq!(refusal(36, &[0, 0, 0, 0x80]), field("token 1", Fault::Overflow { row: 1 }));
    assert_eq!(refusal(39, &[0x7f]), field("token 1", Fault::Overflow { row: 1 }));
}

#[test]
fn padding_and_sums_of_maps_are_checked() {
    let file = OwnNetwork::by_chance(SMALL, 1).file();
    // The stem: zero point at 28, four biases, four multipliers, then tiles of 16 bytes. The tenth
    // lane is the first of padding: in the third tile the second lane, of the first two rows.
    let mut bad = file.clone();
    assert_eq!(bad[64 + 2 * 16 + 2..][..2], [0; 2]);
    bad[64 + 2 * 16 + 2] = 1;
    let refused = ModelError::Field { layer: "stem", fault: Fault::Reserved };
    assert_eq!(Model::parse(&sealed(bad)).unwrap_err(), refused);
    // The sketch has 5 rows, the file 8: bias, multiplier and weights of the others are 0.
    let at = sketch_at();
    for place in [at + 4 + 5 * 4, at + 4 + 8 * 4 + 7 * 4, at + 4 + 8 * 8 + 16 * 3 + 9] {
        let mut bad = file.clone();
        assert_eq!(bad[place], 0);
        bad[place] = 1;
        let refused = ModelError::Field { layer: "sketch", fault: Fault::Reserved };
        assert_eq!(Model::parse(&sealed(bad)).unwrap_err(), refused, "{}", place - at);
    }

    let mut network = OwnNetwork::by_chance(SMALL, 1);
    let mut buffer = vec![0; 100_000];
    let mut large = network.network();
    large.encoder.as_mut().unwrap().stages[1].multiplier = i32::MAX;
    let fault = ModelError::Field { layer: "stage 2 second", fault: Fault::Multiplier };
    assert_eq!(large.write(&mut buffer), Err(WriteError::Model(fault)));

    let needed = file.len();
    let room = network.network().write(&mut buffer[..needed - 1]);
    assert_eq!(room, Err(WriteError::NoRoom { needed, got: needed - 1 }));
    let without = vantage_core::soarnet::Network { encoder: None, ..network.network() };
    assert_eq!(without.write(&mut buffer), Err(WriteError::Encoder));
    network.heads[1].bias.pop();
    let shape = WriteError::Shape { layer: "token 2", rows: 24, columns: 24 };
    assert_eq!(network.network().write(&mut buffer), Err(shape));
}

#[test]
fn the_sketch_lies_between_the_stages_and_the_embedding() {
    let file = OwnNetwork::by_chance(SMALL, 1).file();
    let [_, _, c2, _] = SMALL.channels;
    let sketch = sketch_at();
    for (name, at) in [("sketch", sketch), ("embed", sketch + layer(5, c2))] {
        let mut bad = file.clone();
        bad[at + 1] = 1; // the first reserved byte
        let refused = ModelError::Field { layer: name, fault: Fault::Reserved };
        assert_eq!(Model::parse(&sealed(bad)).unwrap_err(), refused);
    }
}

#[test]
fn only_a_network_with_images_is_told_outlooks() {
    for (dimensions, columns) in [(SMALL, 2 * 24 + 8 + 20), (SMALL.without_images(), 2 * 24 + 20)] {
        let mut network = OwnNetwork::by_chance(dimensions, 1);
        network.heads[2].weights.pop();
        let shape = WriteError::Shape { layer: "candidate hidden", rows: 12, columns };
        assert_eq!(network.network().write(&mut vec![0; 100_000]), Err(shape));
    }
}

#[test]
fn a_model_lies_at_any_address() {
    let file = OwnNetwork::by_chance(SMALL, 2).file();
    let mut shifted = vec![0; file.len() + 4];
    for offset in 0..4 {
        shifted[offset..offset + file.len()].copy_from_slice(&file);
        let model = Model::parse(&shifted[offset..offset + file.len()]).unwrap();
        assert_eq!(gains(model), gains(Model::parse(&file).unwrap()));
    }
}

/// Bytes of a layer of so many columns in memory.
fn layer(rows: usize, columns: usize) -> usize {
    4 + rows.next_multiple_of(4) * (8 + columns)
}

/// Where the sketch's layer begins in the file of the small network.
fn sketch_at() -> usize {
    let [c0, c1, c2, c3] = SMALL.channels;
    let window = |rows: usize, channels: usize| layer(rows, 72 * channels.div_ceil(8));
    let stage = |from, to| window(to, from) + 2 * window(to, to) + 12;
    28 + layer(c0, 32) + stage(c0, c1) + stage(c1, c2) + stage(c2, c3)
}

#[test]
fn sums_that_could_leave_their_bits_are_refused() {
    // 128 times the weights' sum: 24 bits with a sign for every second row, 32 with the bias for all.
    let mut network = OwnNetwork::by_chance(Dimensions::default(), 1);
    let mut buffer = vec![0; 400_000];
    let columns = 16 * 48;
    for (row, weights, fault) in [
        (0, 127, None),
        (1, 85, None),
        (1, 86, Some(Fault::Second { row: 1 })),
        (95, 127, Some(Fault::Second { row: 95 })),
    ] {
        let kept = network.encoder[10].weights.clone();
        network.encoder[10].weights[columns * row..][..columns].fill(-weights);
        let expected = match fault {
            Some(fault) => Err(WriteError::Model(ModelError::Field { layer: "embed", fault })),
            None => Ok(Dimensions::default().file_length()),
        };
        assert_eq!(network.network().write(&mut buffer), expected, "row {row}, {weights}");
        network.encoder[10].weights = kept;
    }
    network.encoder[10].weights[..columns].fill(127);
    for (bias, fault) in [(i32::MAX - 128 * 127 * 768, false), (i32::MIN + 128 * 127 * 768, true)] {
        network.encoder[10].bias[0] = bias;
        let fault = fault.then_some(Fault::Overflow { row: 0 });
        let expected =
            fault.map(|fault| WriteError::Model(ModelError::Field { layer: "embed", fault }));
        assert_eq!(network.network().write(&mut buffer).err(), expected);
    }
}

/// Every gain after two photos.
fn gains(model: Model<'_>) -> Vec<u32> {
    let poses: Vec<_> = Pool::try_new(ViewSpace::FibonacciSphere, 6, 2.0).unwrap().iter().collect();
    let memory = Fixed::<6, 2, 128, 128>::new();
    let mut scorer = SoarNet::try_new(model, memory, Vec3::ZERO, poses.clone()).unwrap();
    let bytes: Vec<u8> = (0..32 * 32 * 2).map(|i| ((i * 7) >> 2) as u8).collect();
    let image = Image::try_new(32, 32, Pixels::Rgb565, &bytes).unwrap();
    scorer.observe(&poses[0], &Photo::new(image)).unwrap();
    scorer.observe(&poses[3], &Photo::new(image)).unwrap();
    let all = poses.iter().enumerate();
    all.flat_map(|(i, pose)| Objective::ALL.map(|o| scorer.gain(o, i, pose).to_bits())).collect()
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn a_flipped_byte_is_refused(at: prop::sample::Index, flip in 1u8..) {
        let mut file = page();
        let at = at.index(file.len());
        file[at] ^= flip;
        prop_assert!(Model::parse(&file).is_err());
    }

    #[test]
    fn a_cut_or_longer_file_is_refused(cut: prop::sample::Index, more in 1usize..20, fill: u8) {
        let mut file = page();
        prop_assert!(Model::parse(&file[..cut.index(file.len())]).is_err());
        file.resize(file.len() + more, fill);
        prop_assert!(Model::parse(&file).is_err());
        let sealed = sealed(file);
        prop_assert!(Model::parse(&sealed).is_err());
    }

    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(Model::parse(&bytes).is_err());
    }
}

proptest! {
    #![proptest_config(cases(60))]

    /// Whatever is accepted runs: overflow checks are on in tests.
    #[test]
    fn a_wrong_body_behind_a_right_checksum_never_panics(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..40),
        images: bool, header: bool,
    ) {
        let dimensions = if images { SMALL } else { SMALL.without_images() };
        let mut file = OwnNetwork::by_chance(dimensions, 3).file();
        let from = if header { 0 } else { 28 };
        let length = file.len() - from;
        for (index, byte) in changes {
            file[from + index.index(length)] = byte;
        }
        let file = sealed(file);
        if let Ok(model) = Model::parse(&file) {
            gains(model);
        }
    }
}
