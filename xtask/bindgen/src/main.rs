//! Writes the JavaScript and TypeScript side of a wasm-bindgen module.
//!
//! Usage: `xtask-bindgen <module.wasm> <folder>`; `cargo xtask wasm` calls it. The generator must
//! be of the same version as the `wasm-bindgen` crate that the module was built with, so both are
//! pinned in the workspace and no program has to be installed.

use std::env;

use anyhow::{Context, Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [module, folder] = arguments.as_slice() else {
        bail!("usage: xtask-bindgen <module.wasm> <folder>");
    };
    let mut bindgen = Bindgen::new();
    // The package's own loader knows where its wasm files are.
    bindgen.input_path(module).web(true)?.typescript(true).omit_default_module_path(true);
    bindgen.remove_name_section(true).remove_producers_section(true);
    bindgen.generate(folder).with_context(|| format!("the bindings of {module} were not written"))
}
