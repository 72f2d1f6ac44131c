//! Runs the suite with the kernels that a Cortex-M gets; fails where they differ from the definition.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bare {
    use core::fmt::Write;

    use cortex_m_rt::entry;
    use kernel_firmware::{Text, exit};
    use kernel_suite::backends::Chosen;
    use kernel_suite::suite::{Room, run};

    const SEED: u64 = 1;
    const ROUNDS: usize = 100;

    #[entry]
    fn main() -> ! {
        let Ok(mut text) = Text::try_new() else { exit(false) };
        let mut room = Room::new();
        let result = run::<Chosen>(&mut room, SEED, ROUNDS);
        let written = match &result {
            Ok(count) => writeln!(text, "{count} cases agree with the definition, seed {SEED}"),
            Err(difference) => writeln!(text, "{difference}"),
        };
        exit(result.is_ok() && written.is_ok())
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
