//! Gives the linker the board's memory and cortex-m-rt's script, for bare-metal targets only.

use std::{env, fs, path::PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=boards");
    println!("cargo::rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let has = |feature: &str| env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    let target = env::var("TARGET").expect("cargo sets TARGET");
    let board = match (has("PICO2"), target.starts_with("thumbv8m")) {
        (true, _) => "boards/pico2.x",
        (false, true) => "boards/an505.x",
        (false, false) => "boards/mps2.x",
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(board, out.join("memory.x")).expect("the board's memory is copied to OUT_DIR");
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // Sections aligned to no more than a word, so that the image in flash has no padding.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    if has("DEFMT") {
        println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    }
}
