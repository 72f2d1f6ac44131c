//! The suite with every instruction set of the host.

use kernel_suite::backends::{Chosen, Kernels, Scalar};
use kernel_suite::suite::{Room, run};

const SEED: u64 = 1;
const ROUNDS: usize = 400;

fn try_out<K: Kernels>() {
    if !K::are_here() {
        println!("{}: not on this processor", K::NAME);
        return;
    }
    match run::<K>(&mut Box::new(Room::new()), SEED, ROUNDS) {
        Ok(count) => println!("{}: {count} cases agree, seed {SEED}", K::NAME),
        Err(difference) => panic!("{difference}"),
    }
}

#[test]
fn chosen() {
    try_out::<Chosen>();
}

#[test]
fn scalar() {
    try_out::<Scalar>();
}

#[cfg(all(feature = "arch", target_arch = "x86_64"))]
#[test]
fn sse2() {
    try_out::<kernel_suite::backends::Sse2>();
}

#[cfg(all(feature = "arch", target_arch = "x86_64"))]
#[test]
fn avx2() {
    try_out::<kernel_suite::backends::Avx2>();
}

#[cfg(all(feature = "arch", target_arch = "x86_64"))]
#[test]
fn vnni() {
    try_out::<kernel_suite::backends::Vnni>();
}
