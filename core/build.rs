//! Names the instructions that the kernels may use on the target: `vantage_dsp`, `vantage_x86`,
//! `vantage_wasm`, or none.
//!
//! A stable compiler does not tell the sources whether a Cortex-M has the DSP extension, so its name
//! has to say so.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(vantage_dsp, vantage_x86, vantage_wasm)");
    if env::var_os("CARGO_FEATURE_ARCH").is_none() {
        return;
    }
    let variable = |name: &str| env::var(name).unwrap_or_default();
    let (target, arch) = (variable("TARGET"), variable("CARGO_CFG_TARGET_ARCH"));
    // Every thumbv7em has the extension. Many thumbv8m.main have it, but rustc 1.95 does not assemble
    // it for them, whatever the flags.
    let has_dsp = target.starts_with("thumbv7em");
    let features = variable("CARGO_CFG_TARGET_FEATURE");
    let has_simd = features.split(',').any(|feature| feature == "simd128");
    if has_dsp {
        println!("cargo::rustc-cfg=vantage_dsp");
    } else if arch == "x86_64" {
        println!("cargo::rustc-cfg=vantage_x86");
    } else if arch == "wasm32" && has_simd {
        println!("cargo::rustc-cfg=vantage_wasm");
    }
}
