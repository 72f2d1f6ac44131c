//! Tells the kernels whether a Cortex-M has the DSP instructions: a stable compiler does not say so to
//! the sources themselves.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(vantage_dsp)");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    let target = variable("TARGET");
    // Every thumbv7em has them; of the thumbv8m.main those that the flags say.
    let flags = variable("CARGO_ENCODED_RUSTFLAGS");
    let asked = ["target-cpu=cortex-m33", "target-cpu=cortex-m35p", "target-feature=+dsp"];
    let has_dsp = target.starts_with("thumbv7em")
        || target.starts_with("thumbv8m.main") && asked.iter().any(|flag| flags.contains(flag));
    if has_dsp && env::var_os("CARGO_FEATURE_ARCH").is_some() {
        println!("cargo::rustc-cfg=vantage_dsp");
    }
}
