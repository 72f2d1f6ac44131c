//! A device behind the first serial port, for `cargo vantage device`: 128 candidates, 64 views, and
//! photos of up to 40 KiB, such as 160 x 120 pixels of two bytes. Its flash memory is the file that the
//! debugger's command line names.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use static_cell::ConstStaticCell;
    use vantage_core::soarnet::Aligned;
    use vantage_device::{Device, Memory, Store};
    use vantage_firmware::{FileFlash, Uart, argument, exit};

    /// The network, where its weights lie best.
    static MODEL: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../lab/models/soarnet.model"));
    const FLASH: u32 = 128 * 1024;
    static MEMORY: ConstStaticCell<Memory<128, 64, 40_960>> = ConstStaticCell::new(Memory::new());

    let mut line = [0; 256];
    let flash = argument(&mut line).and_then(|path| FileFlash::try_new(path, FLASH).ok());
    let store = flash.and_then(|flash| Store::try_new(flash, 0, FLASH).ok());
    // Without its flash the program cannot keep what it promises.
    let Some(store) = store else { exit(Err(core::fmt::Error)) };
    let mut device = Device::new(&MODEL.0, MEMORY.take(), store);
    // SAFETY: this is an mps2 board, and the only port that is made.
    let mut uart = unsafe { Uart::new() };
    loop {
        if let Some(byte) = uart.receive()
            && let Some(answer) = device.receive(byte)
        {
            uart.send(answer);
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("firmware: this program runs on a Cortex-M; `cargo xtask firmware` runs it in QEMU");
}
