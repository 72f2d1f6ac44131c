//! What happens on a panic on bare metal: it halts; or the program does not link, to prove that there
//! is none.

use core::panic::PanicInfo;

#[panic_handler]
fn panic(_info: &PanicInfo<'_>) -> ! {
    #[cfg(feature = "prove-no-panic")]
    {
        unsafe extern "C" {
            fn vantage_has_a_way_to_panic() -> !;
        }
        // SAFETY: a program that could reach this call does not link.
        unsafe { vantage_has_a_way_to_panic() }
    }
    #[cfg(not(feature = "prove-no-panic"))]
    loop {
        core::hint::spin_loop();
    }
}
