//! A turntable with a Raspberry Pi Pico 2. Built, not run on hardware.
//!
//! | pin | to |
//! |---|---|
//! | GPIO 0, 1 | serial port, 115,200 bits a second: sends, receives |
//! | GPIO 2, 3, 4 | stepper driver: step, direction, enable (low) |
//! | GPIO 5 | optocoupler across the camera's remote release |
//! | GPIO 18, 19 | 12 WS2812 lights: GPIO 19 to their data input, GPIO 18 stays free |
//! | GPIO 22 | to ground while it starts: a device for `cargo vantage device` instead |
//! | GPIO 25 | the board's light, on while the program runs |
//!
//! The turntable takes 3,200 steps a turn; the camera stands half a metre from the middle, 25 degrees
//! up. The session is kept in flash after every view: switched off and on, it goes on.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bare {
    use embedded_hal::digital::{InputPin, OutputPin};
    use rp235x_hal as hal;

    use hal::fugit::RateExtU32;
    use hal::uart::{DataBits, StopBits, UartConfig, UartPeripheral};
    use hal::{Clock, pac};
    use static_cell::ConstStaticCell;
    use vantage_core::Vec3;
    use vantage_core::candidates::{Pool, ViewSpace};
    use vantage_core::planner::{self, Contents, Persist, Plan, Session};
    use vantage_core::soarnet::{self, Aligned, Model, SoarNet};
    use vantage_device::{Device, Store};
    use vantage_firmware::pico2::{Flash, LENGTH};
    use vantage_firmware::{LedRing, Place, Ramp, Rig, Shutter, Stepper, Turntable, guide};
    use ws2812_spi::Ws2812;

    #[cfg(feature = "defmt")]
    use defmt_rtt as _;

    /// Says to the boot ROM that this is a program for the Arm cores.
    #[unsafe(link_section = ".start_block")]
    #[used]
    pub static IMAGE_DEF: hal::block::ImageDef = hal::block::ImageDef::secure_exe();

    const CRYSTAL_HZ: u32 = 12_000_000;
    const RADIUS_M: f32 = 0.5;
    const ELEVATION_RAD: f32 = 0.436;
    const CANDIDATES: usize = 48;
    const VIEWS: usize = 24;

    /// The network that looks at poses alone, for a camera whose photos stay in the camera.
    static POSES: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../lab/models/soarnet-poses.model"));
    /// The network that looks at photos, for photos that come over the serial port.
    static PHOTOS: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../lab/models/soarnet.model"));

    static DEVICE: ConstStaticCell<vantage_device::Memory<128, 64, 40_960>> =
        ConstStaticCell::new(vantage_device::Memory::new());

    struct Memory {
        network: soarnet::Fixed<CANDIDATES, VIEWS>,
        lists: planner::Fixed<CANDIDATES, VIEWS>,
        snapshot: [u8; 8192],
    }

    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory {
        network: soarnet::Fixed::new(),
        lists: planner::Fixed::new(),
        snapshot: [0; 8192],
    });

    #[hal::entry]
    fn main() -> ! {
        // The board has all of it, once: nothing else takes peripherals.
        let mut pac = pac::Peripherals::take().expect("the peripherals are taken once");
        let mut watchdog = hal::Watchdog::new(pac.WATCHDOG);
        let clocks = hal::clocks::init_clocks_and_plls(
            CRYSTAL_HZ,
            pac.XOSC,
            pac.CLOCKS,
            pac.PLL_SYS,
            pac.PLL_USB,
            &mut pac.RESETS,
            &mut watchdog,
        )
        .ok()
        .expect("the crystal starts"); // 150 MHz
        let timer = hal::Timer::new_timer0(pac.TIMER0, &mut pac.RESETS, &clocks);
        let sio = hal::Sio::new(pac.SIO);
        let bank = sio.gpio_bank0;
        let pins = hal::gpio::Pins::new(pac.IO_BANK0, pac.PADS_BANK0, bank, &mut pac.RESETS);

        let mut light = pins.gpio25.into_push_pull_output();
        light.set_high().ok();
        // SAFETY: the only one; the other core does not run and nothing uses DMA.
        let flash = unsafe { Flash::new() };
        let store = Store::try_new(flash, 0, LENGTH).expect("the part of the flash is whole pages");

        let mut is_device = pins.gpio22.into_pull_up_input();
        if is_device.is_low().unwrap_or(false) {
            let uart = UartPeripheral::new(
                pac.UART0,
                (pins.gpio0.into_function(), pins.gpio1.into_function()),
                &mut pac.RESETS,
            );
            let config = UartConfig::new(115_200.Hz(), DataBits::Eight, None, StopBits::One);
            let uart = uart
                .enable(config, clocks.peripheral_clock.freq())
                .expect("the clock is fast enough for the port");
            let mut device = Device::new(&PHOTOS.0, DEVICE.take(), store);
            let mut byte = [0];
            loop {
                if uart.read_raw(&mut byte).is_ok()
                    && let Some(answer) = device.receive(byte[0])
                {
                    uart.write_full_blocking(answer);
                }
            }
        }

        let mut enable = pins.gpio4.into_push_pull_output();
        enable.set_low().ok();
        let motor = Stepper::new(
            pins.gpio2.into_push_pull_output(),
            pins.gpio3.into_push_pull_output(),
            3200,
            Ramp::default(),
        );
        let camera = Place { azimuth_rad: 0.0, elevation_rad: ELEVATION_RAD };
        let spi = hal::Spi::<_, _, _, 8>::new(
            pac.SPI0,
            (pins.gpio19.into_function(), pins.gpio18.into_function()),
        )
        .init(&mut pac.RESETS, clocks.peripheral_clock.freq(), 3.MHz(), ws2812_spi::MODE);
        let mut rig = Rig {
            camera: Shutter::new(pins.gpio5.into_push_pull_output(), timer, 150, 800),
            mount: Turntable::new(motor, timer, Vec3::ZERO, camera, RADIUS_M, 400),
            indicator: LedRing::<_, 12>::new(Ws2812::new(spi)),
        };
        let Memory { network, lists, snapshot } = MEMORY.take();
        capture(&mut rig, network, lists, snapshot, store);
        enable.set_high().ok();
        light.set_low().ok();
        loop {
            core::hint::spin_loop();
        }
    }

    /// A capture from where it was left.
    fn capture<C, M, I>(
        rig: &mut Rig<C, M, I>,
        network: &'static mut soarnet::Fixed<CANDIDATES, VIEWS>,
        lists: &'static mut planner::Fixed<CANDIDATES, VIEWS>,
        snapshot: &mut [u8],
        mut store: Store<Flash>,
    ) where
        C: vantage_firmware::Camera,
        M: vantage_firmware::Mount,
        I: vantage_firmware::Indicator,
    {
        let model = Model::parse(&POSES.0).expect("the model comes with the program");
        let (min_elevation_rad, max_elevation_rad) = (ELEVATION_RAD, ELEVATION_RAD);
        let space = ViewSpace::Rings { rings: 1, min_elevation_rad, max_elevation_rad };
        let pool = Pool::try_new(space, CANDIDATES, RADIUS_M).expect("the ring is a pool");
        let kept = store.load(snapshot).ok().flatten();
        let kept = kept.and_then(|length| snapshot.get(..length));
        let scorer = SoarNet::try_new(model, network, Vec3::ZERO, pool.iter())
            .expect("the memory is made for the pool");
        // A finished capture is not gone on with.
        let kept = kept.filter(|bytes| {
            Contents::parse(bytes).is_ok_and(|kept| kept.fingerprint() == scorer.fingerprint())
        });
        let mut session = match kept {
            Some(bytes) => Session::restore(lists, scorer, bytes).unwrap_or_else(|_| {
                // It is of a program with other candidates: begin anew.
                store.save(&[]).ok();
                cortex_m::peripheral::SCB::sys_reset()
            }),
            None => Session::try_new(lists, pool.iter(), scorer, Plan::support(VIEWS))
                .expect("the memory is made for the plan"),
        };
        guide(&mut session, rig, &mut [], |session, _| {
            // A view that cannot be kept is taken again after a loss of power.
            if let Ok(used) = session.snapshot(snapshot) {
                store.save(snapshot.get(..used).unwrap_or_default()).ok();
            }
        });
        // The next start begins anew.
        store.save(&[]).ok();
    }

    /// Stands still with the light on.
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            core::hint::spin_loop();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "firmware: this program runs on a Raspberry Pi Pico 2: see examples/firmware/README.md"
    );
}
