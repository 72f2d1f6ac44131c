//! A whole guided capture on a Cortex-M, with all that the core offers a device, and nothing else: no
//! text, no formatting. The proof also holds `vantage-device`: its protocol, session and flash store. `cargo xtask size` tells what it takes in flash, RAM and stack, and
//! `cargo xtask panic-free` that it links, which it can only if it has no way to panic: see `board`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod capture;
#[cfg(all(target_os = "none", feature = "everything"))]
mod device;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // Too large for the stack. The attribute hands it over as `&'static mut`, once.
    static mut MEMORY: capture::Memory = capture::Memory::new();
    #[cfg(feature = "everything")]
    static mut ROOM: device::Room = device::Room::new();

    let done = capture::run(MEMORY).is_some();
    #[cfg(feature = "everything")]
    let done = done && device::converse(ROOM).is_some();
    // First of all: what comes after it is not the capture's.
    board::tell("stack", board::stack_high_water());
    for (name, bytes) in capture::sizes() {
        board::tell(name, bytes);
    }
    board::exit(done)
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("footprint: this program runs on a Cortex-M; `cargo xtask size` builds and runs it");
}
