//! Small data sets, written, read, damaged and continued.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use vantage_core::objectives::{Face, Objective, Reading};
use vantage_core::{Pose, Scores, Vec3};

use super::shard::{HEADER, Tag, decode, decode_body, encode, encode_body};
use super::*;
use crate::label::Label;

fn small(objects: usize) -> Parameters {
    Parameters {
        objects,
        seed: 7,
        image_size: 12,
        resolution: 32,
        train_views: 5,
        validation_views: 3,
        test_views: 4,
        trajectories: 2,
        steps: 4,
        reading: Reading::default(),
        files: Vec::new(),
    }
}

/// Every file of a data set, by name.
fn files_in(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for folder in [dir.to_owned(), dir.join("objects")] {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            if entry.path().is_file() {
                let name = entry.path().strip_prefix(dir).unwrap().display().to_string();
                files.push((name, fs::read(entry.path()).unwrap()));
            }
        }
    }
    files.sort();
    files
}

fn sentence(error: &DatasetError) -> String {
    let text = error.to_string();
    assert!(!text.contains('\n') && !text.ends_with('.'), "{text}");
    text
}

#[test]
fn what_is_written_is_read_and_its_gains_are_the_ledgers() {
    let home = tempfile::tempdir().unwrap();
    let parameters = small(2);
    let written = write(home.path(), None, &parameters, || {}).unwrap();
    assert_eq!(written.kept, 0);

    let dataset = Dataset::open(home.path()).unwrap();
    assert_eq!(dataset.len(), 2);
    let object = dataset.load(1).unwrap();
    assert_eq!((object.class.as_str(), object.name.as_str()), ("chair", "chair-000001"));
    assert_eq!(dataset.manifest().objects[1].faces, object.faces.len());
    assert_eq!(object.train.photo(4).len(), 12 * 12 * 4);
    assert_eq!(object.validation.labels.len(), 3);
    assert!(object.train.photos.chunks_exact(4).any(|pixel| pixel[3] == 255));
    assert!(object.test.mask(3).contains(&1) && object.test.mask(3).contains(&0));
    assert_ne!(object.train.poses[0], object.validation.poses[0]);

    assert_eq!(object.trajectories.len(), 2);
    for walk in &object.trajectories {
        let mut accounts = Vec::new();
        let mut ledger = object.ledger(&mut accounts);
        assert_eq!((walk.views.len(), walk.states.len()), (4, 4));
        for (view, state) in walk.views.iter().zip(&walk.states) {
            let view = usize::from(*view);
            ledger.add(object.train.position(view), &object.train.sighting(view));
            assert_eq!(ledger.scores(), state.scores);
            assert_eq!(state.gains.len(), 5);
            for (candidate, gains) in state.gains.iter().enumerate() {
                let camera = object.train.position(candidate);
                let sighting = object.train.sighting(candidate);
                let exact = Objective::ALL.map(|o| ledger.gain(o, camera, &sighting));
                assert_eq!(exact, *gains);
            }
        }
        let mut views = walk.views.clone();
        views.sort_unstable();
        views.dedup();
        assert_eq!(views.len(), 4, "no view is taken twice");
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let with = |threads: usize| {
        let home = tempfile::tempdir().unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| write(home.path(), None, &small(3), || {})).unwrap();
        files_in(home.path())
    };
    assert!(with(1) == with(3));
}

#[test]
fn an_interrupted_run_continues_and_mends() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path();
    write(dir, None, &small(4), || {}).unwrap();
    let whole = files_in(dir);

    // As if killed: no list yet, a shard is missing, one is cut, one is damaged, one is half made.
    let mut manifest = Manifest::read(dir).unwrap();
    manifest.objects.clear();
    manifest.write(dir).unwrap();
    assert!(sentence(&Dataset::open(dir).unwrap_err()).contains("not finished"));
    let shard = |number: u32| dir.join(manifest::shard_name(number));
    fs::remove_file(shard(0)).unwrap();
    fs::write(shard(0).with_extension("partial"), "half").unwrap();
    let bytes = fs::read(shard(1)).unwrap();
    fs::write(shard(1), &bytes[..bytes.len() / 2]).unwrap();
    let mut bytes = fs::read(shard(2)).unwrap();
    bytes[HEADER + 5] ^= 1;
    fs::write(shard(2), bytes).unwrap();

    let written = write(dir, None, &small(4), || {}).unwrap();
    assert_eq!(written.kept, 1);
    assert!(files_in(dir) == whole);
    // Done: a further run changes nothing.
    assert_eq!(write(dir, None, &small(4), || {}).unwrap().kept, 4);
    assert!(files_in(dir) == whole);
}

#[test]
fn other_parameters_and_foreign_folders_are_refused() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("data");
    write(&dir, None, &small(1), || {}).unwrap();
    let before = files_in(&dir);
    let refused = |dir: &Path, parameters: Parameters| {
        sentence(&write(dir, None, &parameters, || {}).unwrap_err())
    };
    for other in
        [Parameters { seed: 8, ..small(1) }, Parameters { resolution: 33, ..small(1) }, small(2)]
    {
        assert!(refused(&dir, other).contains("other parameters"));
    }
    assert!(files_in(&dir) == before);
    assert!(refused(home.path(), small(1)).contains("not empty"));
    let file = home.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(refused(&file, small(1)).contains("is a file"));
    let steps = Parameters { steps: 6, ..small(1) };
    assert!(refused(&home.path().join("new"), steps).contains("between 1 and 5"));
    assert!(!home.path().join("new").exists());
}

#[test]
fn a_damaged_data_set_says_what_is_wrong() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path();
    let says = |error: DatasetError, words: &str| {
        let text = sentence(&error);
        assert!(text.contains(words), "{text}");
    };
    says(Dataset::open(dir).unwrap_err(), "holds no data set");
    says(Dataset::open(&dir.join("nowhere")).unwrap_err(), "holds no data set");
    write(dir, None, &small(2), || {}).unwrap();
    let dataset = Dataset::open(dir).unwrap();
    says(dataset.load(2).unwrap_err(), "no object 2");

    let path = dir.join("objects/000001.shard");
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[1..]).unwrap();
    says(dataset.load(1).unwrap_err(), "are expected");
    fs::write(&path, [bytes.as_slice(), b"more"].concat()).unwrap();
    says(dataset.load(1).unwrap_err(), "are expected");
    let mut flipped = bytes.clone();
    flipped[HEADER] ^= 4;
    fs::write(&path, flipped).unwrap();
    says(dataset.load(1).unwrap_err(), "checksum");
    fs::remove_file(&path).unwrap();
    says(dataset.load(1).unwrap_err(), "cannot read");

    let text = fs::read_to_string(dir.join("manifest.json")).unwrap();
    for (from, to, words) in [
        ("vantage-dataset", "camera", "no manifest"),
        ("\"version\": 1", "\"version\": 2", "version 2"),
        ("\"image_size\": 12", "\"image_size\": 4000000000", "image size"),
        ("\"objects\": 2", "\"objects\": 3", "2 objects of 3"),
        ("objects/000001.shard", "../../etc/passwd", "entry 1"),
        ("{", "", "not JSON"),
    ] {
        assert!(text.contains(from), "{from}");
        fs::write(dir.join("manifest.json"), text.replacen(from, to, 1)).unwrap();
        says(Dataset::open(dir).unwrap_err(), words);
    }
}

#[test]
fn objects_go_round_the_classes_and_held_out_ones_are_for_test() {
    let parameters = Parameters { objects: 640, ..small(1) };
    let all: Vec<_> = (0..640).map(|number| parameters.assignment(number)).collect();
    let of = |class: &str| all.iter().filter(|one| one.class == class).count();
    assert_eq!(of("freeform"), 180);
    assert!(crate::mesh::CLASSES.iter().all(|class| of(class) >= 22));
    for one in all.iter().filter(|one| HELD_OUT_CLASSES.contains(&one.class.as_str())) {
        assert_eq!(one.split, Split::Test);
    }
    let share = |split| all.iter().filter(|one| one.split == split).count();
    let shares = [share(Split::Train), share(Split::Validation), share(Split::Test)];
    assert_eq!(shares, SHARES_OF_640);
    // No two objects have one seed.
    let mut seeds: Vec<u64> = all.iter().map(|one| one.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    assert_eq!(seeds.len(), 640);
}

/// Train, validation and test objects of 640.
const SHARES_OF_640: [usize; 3] = [461, 59, 120];

#[test]
fn a_folder_of_files_is_taken_by_name() {
    let home = tempfile::tempdir().unwrap();
    let from = home.path().join("meshes");
    fs::create_dir(&from).unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    for name in ["b.obj", "a.OBJ", "notes.txt"] {
        fs::write(from.join(name), obj).unwrap();
    }
    let files = files_of(&from).unwrap();
    assert_eq!(files.iter().map(|file| file.name.as_str()).collect::<Vec<_>>(), ["a.OBJ", "b.obj"]);
    let parameters = Parameters { files, ..small(2) };
    let dir = home.path().join("data");
    write(&dir, Some(&from), &parameters, || {}).unwrap();
    let object = Dataset::open(&dir).unwrap().load(1).unwrap();
    assert_eq!((object.name.as_str(), object.class.as_str(), object.faces.len()), ("b", "file", 4));

    fs::write(from.join("a.OBJ"), "nonsense").unwrap();
    let files = files_of(&from).unwrap();
    let parameters = Parameters { files, ..small(2) };
    let error = write(&home.path().join("other"), Some(&from), &parameters, || {}).unwrap_err();
    assert!(sentence(&error).starts_with("a.OBJ cannot be used"));
}

/// The object of the worked example in `FORMAT.md`.
fn example() -> ObjectData {
    let pose = |eye: Vec3| Pose::looking_at(eye, Vec3::ZERO).unwrap();
    let face = |area_share: f32, complexity: f32| Face {
        centroid: Vec3::new(0.5, 0.0, -0.5),
        normal: Vec3::Z,
        area_share,
        complexity,
    };
    let label = Label::from_parts(vec![0b11], vec![3, 300], 0, 200);
    let views = |red: u8| Views {
        poses: vec![pose(Vec3::Z * 3.0)],
        labels: vec![label.clone()],
        photos: vec![red, 16, 32, 255, red, 16, 33, 255, 0, 0, 0, 0, 0, 0, 0, 0],
    };
    let scores = Scores { coverage: 1.0, geometry: 0.5, diversity: 0.0, texture: 0.75 };
    ObjectData {
        name: "b".to_owned(),
        class: "file".to_owned(),
        faces: vec![face(0.25, 1.0), face(0.75, 2.0)],
        texture_limit: 1.5,
        train: views(128),
        validation: views(64),
        test: TestViews { poses: vec![pose(Vec3::Z * 3.0)], masks: vec![1, 1, 0, 1] },
        trajectories: vec![Trajectory {
            views: vec![0],
            states: vec![State { scores, gains: vec![[0.0, 0.25, 0.0, 0.125]] }],
        }],
    }
}

const EXAMPLE_SIDE: u32 = 2;
const EXAMPLE_TAG: Tag = Tag { fingerprint: 0x1234_5678, number: 9 };

/// The bytes that a page's block of a given name shows: hexadecimal digits up to a `#`.
fn shown(name: &str) -> Vec<u8> {
    let page = include_str!("FORMAT.md");
    let block = page.split("```").find_map(|block| block.strip_prefix(name)).unwrap();
    let digits: String = block
        .lines()
        .flat_map(|line| line.split('#').next().unwrap().chars())
        .filter(char::is_ascii_hexdigit)
        .collect();
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    digits.as_bytes().chunks(2).map(byte).collect()
}

fn as_hex(bytes: &[u8]) -> String {
    let lines = bytes
        .chunks(16)
        .map(|line| line.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" "));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn the_worked_example_is_what_is_written_and_read() {
    let body = encode_body(&example(), EXAMPLE_SIDE);
    assert_eq!(as_hex(&body), as_hex(&shown("hex body")));
    assert_eq!(decode_body(&shown("hex body"), EXAMPLE_SIDE), Ok(example()));
    let shard = encode(&example(), EXAMPLE_SIDE, EXAMPLE_TAG);
    assert_eq!(as_hex(&shard), as_hex(&shown("hex shard")));
    assert_eq!(decode(&shown("hex shard"), EXAMPLE_SIDE, EXAMPLE_TAG), Ok(example()));
}

#[test]
fn a_shard_of_another_place_is_refused() {
    let shard = encode(&example(), EXAMPLE_SIDE, EXAMPLE_TAG);
    let decoded = |tag, side| decode(&shard, side, tag);
    let other = Tag { number: 8, ..EXAMPLE_TAG };
    assert_eq!(decoded(other, EXAMPLE_SIDE), Err(ShardError::Mismatch));
    let other = Tag { fingerprint: 0, ..EXAMPLE_TAG };
    assert_eq!(decoded(other, EXAMPLE_SIDE), Err(ShardError::Mismatch));
    assert_eq!(decoded(EXAMPLE_TAG, 3), Err(ShardError::Field("image size")));
    assert_eq!(decode(b"PNG", 2, EXAMPLE_TAG), Err(ShardError::Foreign));
}

proptest! {
    #[test]
    fn no_flipped_byte_passes(at in 0usize..10_000, flip in 1u8..) {
        let mut shard = encode(&example(), EXAMPLE_SIDE, EXAMPLE_TAG);
        let at = at % shard.len();
        shard[at] ^= flip;
        prop_assert!(decode(&shard, EXAMPLE_SIDE, EXAMPLE_TAG).is_err());
    }

    #[test]
    fn no_cut_or_extended_shard_passes(length in 0usize..1_000) {
        let mut shard = encode(&example(), EXAMPLE_SIDE, EXAMPLE_TAG);
        let whole = shard.len();
        shard.resize(length, 0);
        prop_assert!(length == whole || decode(&shard, EXAMPLE_SIDE, EXAMPLE_TAG).is_err());
    }

    /// Behind the checksum: a body that someone made up is refused or read, in reasonable time and
    /// memory, and never a panic.
    #[test]
    fn a_wrong_body_never_panics(
        changes in prop::collection::vec((0usize..10_000, any::<u8>()), 1..6),
        length in 0usize..1_000,
    ) {
        let mut body = encode_body(&example(), EXAMPLE_SIDE);
        for (at, value) in changes {
            let at = at % body.len();
            body[at] = value;
        }
        let cut = length.min(body.len());
        prop_assert!(decode_body(&body[..cut], EXAMPLE_SIDE).is_err() || cut == body.len());
        if let Ok(object) = decode_body(&body, EXAMPLE_SIDE) {
            prop_assert_eq!(object.train.labels.len(), object.train.poses.len());
            let _ = object.surface();
        }
    }

    #[test]
    fn a_wrong_manifest_never_panics(at in 0usize..10_000, value in any::<u8>(), cut in any::<bool>()) {
        let text = serde_json::to_string_pretty(&Manifest::unfinished(small(1))).unwrap();
        let mut bytes = text.into_bytes();
        let at = at % bytes.len();
        if cut {
            bytes.truncate(at);
        } else {
            bytes[at] = value;
        }
        if let Err(why) = Manifest::parse(&String::from_utf8_lossy(&bytes)) {
            prop_assert!(!why.is_empty());
        }
    }
}
