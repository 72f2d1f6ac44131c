//! Counts the instructions of each layer, of encoders layer by layer, and of a whole photo. A line for
//! each, in columns parted by
//! tabs: name, products, instructions, and a digest of the result.
//!
//! QEMU's `-icount shift=0` makes an instruction a nanosecond; the timer counts at 25 MHz, so a tick is
//! 40 instructions. Each result is first compared with the definition's.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bare {
    use core::fmt::Write;

    use cortex_m::Peripherals;
    use cortex_m::peripheral::{SYST, syst::SystClkSource};
    use cortex_m_rt::entry;
    use kernel_firmware::{Text, exit};
    use kernel_suite::backends::{Chosen, Scalar};
    use kernel_suite::layers::{
        ANCHORS, Bench, ENCODER, ENCODERS, Layer, Work, digest, each_layer, encoder_products,
        picture,
    };
    use vantage_core::soarnet::{Aligned, INPUT, Image, Model, Pixels, SIDE, Scratch};

    const PER_TICK: u32 = 40;
    const DIFFERS: &str = "DIFFERS FROM THE DEFINITION";

    static FILE: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../../lab/models/soarnet.model"));

    /// Instructions of a function.
    fn count(timer: &mut SYST, function: impl FnOnce()) -> u32 {
        timer.clear_current();
        let begin = SYST::get_current();
        function();
        begin.wrapping_sub(SYST::get_current()) % (1 << 24) * PER_TICK
    }

    #[entry]
    fn main() -> ! {
        let (Ok(mut text), Some(peripherals)) = (Text::try_new(), Peripherals::take()) else {
            exit(false)
        };
        let mut timer = peripherals.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload((1 << 24) - 1);
        timer.enable_counter();
        let mut bench = Bench::new();
        let mut good = true;
        for layer in ANCHORS.iter().chain(&ENCODER) {
            let counted = count_layer(&mut bench, &mut timer, layer);
            let name = if counted.is_some() { layer.name } else { DIFFERS };
            let (instructions, digest) = counted.unwrap_or_default();
            good &= counted.is_some();
            good &= line(&mut text, name, layer.products(), instructions, digest);
        }
        for (name, build, channels) in ENCODERS {
            let (mut sum, mut products, mut last) = (0, 0, 0);
            let mut are_equal = true;
            each_layer(build, channels, |work, rows| {
                let layer = Layer { name, work, rows };
                let counted = count_layer(&mut bench, &mut timer, &layer);
                are_equal &= counted.is_some();
                let (instructions, digest) = counted.unwrap_or_default();
                (sum, last) = (sum + instructions, digest);
                products += if matches!(work, Work::Sum { .. }) { 0 } else { layer.products() };
            });
            let name = if are_equal { name } else { DIFFERS };
            good &= are_equal && line(&mut text, name, products, sum, last);
        }
        good &= count_photo(&mut text, &mut timer);
        exit(good)
    }

    /// Instructions of a layer and a digest of its result; `None` where that is not the definition's.
    fn count_layer(bench: &mut Bench, timer: &mut SYST, layer: &Layer) -> Option<(u32, u32)> {
        bench.prepare(layer);
        bench.run::<Scalar>(layer);
        let expected = bench.digest(layer);
        bench.prepare(layer);
        let instructions = count(timer, || bench.run::<Chosen>(layer));
        (bench.digest(layer) == expected).then_some((instructions, expected))
    }

    fn line(text: &mut Text, name: &str, products: usize, instructions: u32, digest: u32) -> bool {
        writeln!(text, "{name}\t{products}\t{instructions}\t{digest:08x}").is_ok()
    }

    /// The shipped network: from a picture to its embedding and sketch, and the part of it that only
    /// brings the picture to the network's size.
    fn count_photo(text: &mut Text, timer: &mut SYST) -> bool {
        let bytes = picture();
        let side = SIDE as u32;
        let (Ok(model), Ok(image)) =
            (Model::parse(&FILE.0), Image::try_new(side, side, Pixels::Rgb888, &bytes))
        else {
            return false;
        };
        let Ok(window) = image.middle() else { return false };
        let mut resized = [0; INPUT];
        let resize = count(timer, || image.resize(&window, &mut resized));
        let mut scratch = Scratch::new();
        let mut result = 0;
        let whole = count(timer, || {
            let seen = model.encode(&image, &window, &mut scratch);
            result = digest(seen.embedding.iter().chain(seen.sketch));
        });
        let products = encoder_products(model.dimensions());
        line(text, "photo to picture", resized.len(), resize, digest(&resized))
            && line(text, "whole encoder", products, whole - resize, result)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
