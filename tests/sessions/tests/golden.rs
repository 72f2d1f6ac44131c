//! The host's build of tests writes the committed text. `cargo xtask test sessions` asks the same of
//! the release build, of WebAssembly, of two Cortex-M and of C.

use golden_sessions::{HEADER, Memory, Recording, RecordingError, SESSIONS};

#[test]
fn the_sessions_are_the_committed_ones() {
    let committed = include_str!("../golden/sessions.txt");
    let mut written = String::new();
    let mut memory = Box::new(Memory::new());
    golden_sessions::run(&mut written, &mut memory).expect("writing to a String does not fail");
    for (index, (ours, theirs)) in written.lines().zip(committed.lines()).enumerate() {
        assert_eq!(ours, theirs, "line {} differs; `cargo xtask golden` rewrites", index + 1);
    }
    assert_eq!(written, committed, "the texts differ in length; `cargo xtask golden` rewrites");
}

#[test]
fn every_mishap_happens_in_the_sessions() {
    let text = include_str!("../golden/sessions.txt");
    for what in ["taken", "blocked", "missed", "elsewhere", "refused a damaged snapshot"] {
        assert!(text.contains(what), "no {what}");
    }
    assert!(!text.contains("accepted"));
}

#[test]
fn a_recording_is_written_as_it_is_read() {
    for (name, bytes) in SESSIONS {
        let recording = Recording::parse(bytes).unwrap();
        let mut written = recording.header().to_bytes().to_vec();
        for index in 0..recording.header().candidates {
            let entry = recording.entry(index.into()).unwrap();
            written.extend(entry.to_bytes());
            written.extend(entry.frame);
        }
        assert!(written == bytes, "{name}");
        assert!(recording.entry(recording.header().candidates.into()).is_none());
    }
}

#[test]
fn the_worked_example_of_the_format_is_the_chair() {
    let format = include_str!("../FORMAT.md");
    let example = format.split("```").nth(1).expect("FORMAT.md has an example");
    let hex: Vec<&str> = example.lines().skip(1).map(|l| l.get(..40).unwrap_or(l)).collect();
    let hex = hex.join(" ");
    let numbers = hex.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap());
    let (_, bytes) = SESSIONS[0];
    assert!(numbers.eq(bytes[..HEADER].iter().copied()));
}

#[test]
fn what_is_no_recording_is_refused() {
    let (_, bytes) = SESSIONS[1];
    let refusal = |bytes: &[u8]| Recording::parse(bytes).unwrap_err();
    assert_eq!(refusal(b"VREC"), RecordingError::Foreign);
    let (expected, got) = (bytes.len(), bytes.len() - 1);
    assert_eq!(refusal(&bytes[..got]), RecordingError::Length { expected, got });
    for (place, value, error) in [
        (0, b'X', RecordingError::Foreign),
        (4, 9, RecordingError::Version { got: 9 }),
        (12, 9, RecordingError::Malformed),
        (13, 9, RecordingError::Malformed),
        (HEADER, 9, RecordingError::Malformed),
        (HEADER + 7, 0x7f, RecordingError::Malformed), // a coordinate beyond all numbers
    ] {
        let mut bytes = bytes.to_vec();
        bytes[place] = value;
        if place == HEADER + 7 {
            bytes[place - 1] = 0xff;
        }
        assert_eq!(refusal(&bytes), error, "{place}");
    }
}
