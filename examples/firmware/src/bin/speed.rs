//! Counts the instructions of a step: a line for each part, in columns parted by tabs: name, products
//! of signed bytes, instructions.
//!
//! QEMU's `-icount shift=0` makes an instruction a nanosecond; the timer counts at 25 MHz, so a tick is
//! 40 instructions, and counts that are longer than its 24 bits are counted by its interrupt.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bare {
    use core::fmt::{self, Write};
    use core::hint::black_box;
    use core::sync::atomic::{AtomicU32, Ordering};

    use cortex_m::Peripherals;
    use cortex_m::peripheral::{SYST, syst::SystClkSource};
    use cortex_m_rt::{entry, exception};
    use golden_sessions::{Recording, SESSIONS};
    use kernel_suite::layers::encoder_products;
    use static_cell::ConstStaticCell;
    use vantage_core::Vec3;
    use vantage_core::candidates::{Pool, ViewSpace};
    use vantage_core::planner::{self, Plan, Session};
    use vantage_core::soarnet::{
        self, Aligned, Dimensions, Image, Model, OUTLOOK, Photo, Scratch, SoarNet, features,
    };
    use vantage_firmware::{Console, exit};

    static MODEL: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../lab/models/soarnet.model"));
    static POSES: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../lab/models/soarnet-poses.model"));

    const PER_TICK: u64 = 40;
    const PERIOD: u32 = 1 << 24;
    const CANDIDATES: usize = 100;
    const VIEWS: usize = 12;

    static WRAPS: AtomicU32 = AtomicU32::new(0);

    #[exception]
    fn SysTick() {
        WRAPS.store(WRAPS.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    }

    /// Ticks since the counter was switched on.
    fn ticks() -> u64 {
        loop {
            let wraps = WRAPS.load(Ordering::Relaxed);
            let left = SYST::get_current();
            if wraps == WRAPS.load(Ordering::Relaxed) {
                return u64::from(wraps) * u64::from(PERIOD) + u64::from(PERIOD - 1 - left);
            }
        }
    }

    /// Instructions of a function, to the next tick.
    fn count<T>(function: impl FnOnce() -> T) -> (T, u64) {
        let begin = ticks();
        let result = function();
        (result, (ticks() - begin) * PER_TICK)
    }

    /// Products that one further view takes for all candidates: a token of each, its part of the view
    /// once, then the heads.
    fn score_products(sizes: &Dimensions) -> usize {
        let (h, e, k, g) = (sizes.width, sizes.embedding, sizes.head, sizes.context);
        let outlook = if e > 0 { OUTLOOK } else { 0 };
        let (direction, relation, count) =
            (features::DIRECTION, features::RELATION, features::COUNT);
        let view = (e + direction) * h;
        let token = relation * h + h * h;
        let rank = (2 * h + outlook + direction + count) * k + k * 4;
        let state = (2 * h + count) * g + g * 12;
        view + CANDIDATES * (token + rank) + state
    }

    struct Memory {
        network: soarnet::Fixed<CANDIDATES, VIEWS>,
        lists: planner::Fixed<CANDIDATES, VIEWS>,
        scratch: Scratch,
    }

    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory {
        network: soarnet::Fixed::new(),
        lists: planner::Fixed::new(),
        scratch: Scratch::new(),
    });

    fn run(out: &mut dyn Write) -> fmt::Result {
        let Memory { network, lists, scratch } = MEMORY.take();
        let (_, empty) = count(|| ());
        let model = Model::parse(&MODEL.0).map_err(|_| fmt::Error)?;
        let (_, bytes) = SESSIONS.first().ok_or(fmt::Error)?;
        let recording = Recording::parse(bytes).map_err(|_| fmt::Error)?;
        let header = recording.header();
        let frame = |view: usize| {
            let entry = recording.entry(view).ok_or(fmt::Error)?;
            let (width, height) = (header.width.into(), header.height.into());
            Image::try_new(width, height, header.pixels, entry.frame).map_err(|_| fmt::Error)
        };

        let image = frame(0)?;
        let window = image.middle().map_err(|_| fmt::Error)?;
        let (_, encode) = count(|| {
            black_box(model.encode(&image, &window, scratch));
        });

        let taken = step(model, network, lists, |view| frame(view).map(Photo::new))?;
        let blind = Model::parse(&POSES.0).map_err(|_| fmt::Error)?;
        let blind_taken = step(blind, network, lists, |_| Ok(Photo::default()))?;
        let (scored, chosen) = (taken.observe - encode, taken.choose - empty);
        let products = encoder_products(model.dimensions());
        let scores = score_products(model.dimensions());
        let blind_scores = score_products(blind.dimensions());
        for (name, products, instructions) in [
            ("encode a photo of 64 x 64", products, encode - empty),
            ("score 100 candidates", scores, scored),
            ("choose among 100", 0, chosen),
            ("whole step by poses alone", blind_scores, blind_taken.observe - empty + chosen),
            ("whole step", products + scores, encode - empty + scored + chosen),
        ] {
            writeln!(out, "{name}\t{products}\t{instructions}")?;
        }
        Ok(())
    }

    /// Instructions of the step after eight views, as in the middle of a capture.
    struct Taken {
        choose: u64,
        observe: u64,
    }

    fn step<'p>(
        model: Model<'_>,
        network: &mut soarnet::Fixed<CANDIDATES, VIEWS>,
        lists: &mut planner::Fixed<CANDIDATES, VIEWS>,
        photo: impl Fn(usize) -> Result<Photo<'p>, fmt::Error>,
    ) -> Result<Taken, fmt::Error> {
        let pool = Pool::try_new(ViewSpace::FibonacciSphere, CANDIDATES, 3.0);
        let pool = pool.map_err(|_| fmt::Error)?;
        let scorer = SoarNet::try_new(model, network, Vec3::ZERO, pool.iter());
        let scorer = scorer.map_err(|_| fmt::Error)?;
        let mut session = Session::try_new(lists, pool.iter(), scorer, Plan::support(VIEWS))
            .map_err(|_| fmt::Error)?;
        let mut last = Taken { choose: 0, observe: 0 };
        for view in 0..9 {
            let photo = photo(view)?;
            let (next, choose) = count(|| session.next_view());
            let next = next.ok_or(fmt::Error)?;
            let (observed, observe) = count(|| session.observe(next.index, next.pose, &photo));
            observed.map_err(|_| fmt::Error)?;
            last = Taken { choose, observe };
        }
        Ok(last)
    }
    #[entry]
    fn main() -> ! {
        let (Ok(mut console), Some(peripherals)) = (Console::try_new(), Peripherals::take()) else {
            exit(Err(fmt::Error))
        };
        let mut timer = peripherals.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(PERIOD - 1);
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();
        exit(run(&mut console).and_then(|()| console.flush()))
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("firmware: this program runs on a Cortex-M; `cargo xtask firmware` runs it in QEMU");
}
