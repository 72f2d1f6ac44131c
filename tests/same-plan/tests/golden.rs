//! The host's build of tests writes the committed text. `cargo xtask test same-plan` asks the same
//! of the release build, of WebAssembly and of the Cortex-M firmware.

#[test]
fn the_plans_are_the_committed_ones() {
    let committed = include_str!("../golden/plans.txt");
    let mut written = String::new();
    same_plan::run(&mut written).expect("writing to a String does not fail");
    for (index, (ours, theirs)) in written.lines().zip(committed.lines()).enumerate() {
        assert_eq!(ours, theirs, "line {} differs; `cargo xtask golden` rewrites", index + 1);
    }
    assert_eq!(written, committed, "the texts differ in length; `cargo xtask golden` rewrites");
}
