//! Files that appear whole or not at all.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

/// Writes a file under another name and gives it its own by one rename; what fails leaves nothing.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let partial = path.with_extension("partial");
    let written = fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        // The error that counts is told already.
        let _ = fs::remove_file(&partial);
    }
    written.with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_leaves_nothing() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("folder.onnx");
        fs::create_dir(&folder).unwrap();
        let error = write_whole(&folder, b"bytes").unwrap_err().to_string();
        assert!(error.contains("folder.onnx"), "{error}");
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
        let file = home.path().join("network.onnx");
        write_whole(&file, b"bytes").unwrap();
        assert_eq!(fs::read(file).unwrap(), b"bytes");
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 2);
    }
}
