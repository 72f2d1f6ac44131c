//! The bare WebAssembly module that `tests/same-plan/run-wasm.mjs` executes in Node.
//!
//! Two exports and no imports: [`same_plan_run`] writes the text once and returns its length in
//! bytes, [`same_plan_text`] says where in the module's memory it begins (UTF-8).

use std::sync::OnceLock;

static TEXT: OnceLock<String> = OnceLock::new();

fn text() -> &'static str {
    TEXT.get_or_init(|| {
        let mut text = String::new();
        match same_plan::run(&mut text) {
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
