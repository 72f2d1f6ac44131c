//! The bare WebAssembly module that `tests/same-plan/run-wasm.mjs` executes in Node.
//!
//! Two exports and no imports, as of `same-plan-wasm`: [`same_plan_run`] writes the text once and
//! returns its length in bytes, [`same_plan_text`] says where in the module's memory it begins.

use std::sync::OnceLock;

use golden_sessions::Memory;

static TEXT: OnceLock<String> = OnceLock::new();

fn text() -> &'static str {
    TEXT.get_or_init(|| {
        let mut text = String::new();
        match golden_sessions::run(&mut text, &mut Box::new(Memory::new())) {
            Ok(()) => text,
            Err(error) => format!("the text could not be written: {error}\n"),
        }
    })
}

/// Writes the text and returns its length in bytes.
// SAFETY: no other symbol of this module bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn same_plan_run() -> usize {
    text().len()
}

/// The address of the text's first byte.
// SAFETY: no other symbol of this module bears the name.
#[unsafe(no_mangle)]
pub extern "C" fn same_plan_text() -> *const u8 {
    text().as_ptr()
}
