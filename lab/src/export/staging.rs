//! A folder that appears whole or not at all.
//!
//! Files are written to a hidden sibling, `.NAME.partial-XXXXXX`, which takes the folder's name by one
//! `rename`. A run that fails removes the sibling; one that is killed leaves it, under a name that no
//! one takes for a result.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::ExportError;

/// A folder in the making. Dropped before [`commit`](Self::commit), it is removed.
#[derive(Debug)]
pub struct Staging {
    partial: TempDir,
    target: PathBuf,
}

impl Staging {
    /// Starts a folder that shall become `dir`: missing so far, or an empty folder.
    ///
    /// Call it before the long work: a bad `dir` is refused here. Parents of `dir` that are missing
    /// are made by [`commit`](Self::commit), not before; until then the files stand in the nearest
    /// folder above that exists.
    pub fn begin(dir: &Path) -> Result<Self, ExportError> {
        let target = match fs::metadata(dir) {
            Ok(found) if !found.is_dir() => return Err(ExportError::NotAFolder(dir.to_owned())),
            Ok(_) => {
                if !is_empty(dir).map_err(|error| ExportError::io("read", dir, error))? {
                    return Err(ExportError::NotEmpty(dir.to_owned()));
                }
                // `.` gets a name and a link is followed, so that the rename replaces the folder.
                fs::canonicalize(dir).map_err(|error| ExportError::io("read", dir, error))?
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                std::path::absolute(dir).map_err(|error| ExportError::io("create", dir, error))?
            }
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
                return Err(ExportError::NotAFolder(first_file(dir)));
            }
            Err(error) => return Err(ExportError::io("create", dir, error)),
        };
        let Some(name) = target.file_name() else {
            return Err(ExportError::NoName(dir.to_owned()));
        };
        let mut prefix = OsString::from(".");
        prefix.push(name);
        prefix.push(".partial-");
        let home = nearest_folder(&target);
        let partial = new_folder(&prefix, home)
            .map_err(|error| ExportError::io("create a folder in", home, error))?;
        Ok(Self { partial, target })
    }

    /// Where to write for now.
    pub fn path(&self) -> &Path {
        self.partial.path()
    }

    /// Gives the folder its name, and returns it as an absolute path.
    ///
    /// Fails, and removes what was staged, if something has appeared in the folder meanwhile.
    pub fn commit(self) -> Result<PathBuf, ExportError> {
        let Self { partial, target } = self;
        if let Some(parent) = target.parent() {
            super::make_folder(parent)?;
        }
        if cfg!(not(unix)) {
            // Elsewhere a rename does not replace an empty folder. A missing one is no error.
            let _ = fs::remove_dir(&target);
        }
        fs::rename(partial.path(), &target).map_err(|error| match error.kind() {
            io::ErrorKind::DirectoryNotEmpty | io::ErrorKind::AlreadyExists => {
                ExportError::NotEmpty(target.clone())
            }
            io::ErrorKind::NotADirectory => ExportError::NotAFolder(target.clone()),
            _ => ExportError::io("create", &target, error),
        })?;
        let _ = partial.keep(); // its path is gone: nothing is left to remove
        Ok(target)
    }
}

fn is_empty(dir: &Path) -> io::Result<bool> {
    Ok(fs::read_dir(dir)?.next().is_none())
}

/// The file that stands where `dir` needs a folder.
fn first_file(dir: &Path) -> PathBuf {
    dir.ancestors().find(|path| path.is_file()).unwrap_or(dir).to_owned()
}

/// The nearest folder above `target` that exists.
fn nearest_folder(target: &Path) -> &Path {
    target.ancestors().skip(1).find(|path| path.is_dir()).unwrap_or(Path::new("."))
}

/// A new folder with the permissions that `mkdir` would give it: by default only its owner could
/// read a temporary one, and the rename would keep that.
fn new_folder(prefix: &OsString, home: &Path) -> io::Result<TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    builder.tempdir_in(home)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(dir: &Path) -> Vec<String> {
        let entries = fs::read_dir(dir).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_committed_folder_is_whole_and_alone() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("out");
        let staging = Staging::begin(&dir).unwrap();
        fs::write(staging.path().join("a.txt"), "a").unwrap();
        assert!(!dir.exists());
        staging.commit().unwrap();
        assert_eq!(names_in(home.path()), ["out"]);
        assert_eq!(names_in(&dir), ["a.txt"]);
    }

    #[test]
    fn a_dropped_folder_leaves_nothing() {
        let home = tempfile::tempdir().unwrap();
        let staging = Staging::begin(&home.path().join("new/out")).unwrap();
        fs::write(staging.path().join("a.txt"), "a").unwrap();
        drop(staging);
        assert!(names_in(home.path()).is_empty());
    }

    #[test]
    fn missing_parents_are_made_at_the_end() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("some/where/out");
        let staging = Staging::begin(&dir).unwrap();
        assert!(!home.path().join("some").exists());
        staging.commit().unwrap();
        assert!(dir.is_dir());
    }

    #[test]
    fn an_empty_folder_is_replaced_and_a_full_one_refused() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("out");
        fs::create_dir(&dir).unwrap();
        let staging = Staging::begin(&dir).unwrap();
        fs::write(staging.path().join("a.txt"), "a").unwrap();
        staging.commit().unwrap();
        let refused = Staging::begin(&dir).unwrap_err();
        assert!(matches!(refused, ExportError::NotEmpty(_)), "{refused}");
        assert!(refused.to_string().contains("is not empty"));
    }

    #[test]
    fn a_folder_filled_meanwhile_is_kept() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("out");
        let staging = Staging::begin(&dir).unwrap();
        fs::create_dir(&dir).unwrap();
        fs::write(dir.join("theirs.txt"), "theirs").unwrap();
        assert!(matches!(staging.commit(), Err(ExportError::NotEmpty(_))));
        assert_eq!(names_in(home.path()), ["out"]);
        assert_eq!(names_in(&dir), ["theirs.txt"]);
    }

    #[test]
    fn a_file_is_refused_as_folder_and_as_parent() {
        let home = tempfile::tempdir().unwrap();
        let file = home.path().join("file");
        fs::write(&file, "").unwrap();
        for dir in [file.clone(), file.join("out"), file.join("deeper/out")] {
            let refused = Staging::begin(&dir).unwrap_err();
            assert!(refused.to_string().contains("file is a file"), "{refused}");
        }
        assert_eq!(names_in(home.path()), ["file"]);
    }

    #[test]
    fn the_root_is_no_folder_to_create() {
        let refused = Staging::begin(Path::new("/"));
        assert!(matches!(refused, Err(ExportError::NotEmpty(_) | ExportError::NoName(_))));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_an_empty_folder_is_followed() {
        let home = tempfile::tempdir().unwrap();
        let (real, link) = (home.path().join("real"), home.path().join("link"));
        fs::create_dir(&real).unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        let staging = Staging::begin(&link).unwrap();
        fs::write(staging.path().join("a.txt"), "a").unwrap();
        staging.commit().unwrap();
        assert_eq!(names_in(&link), ["a.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn an_unwritable_parent_is_refused_in_words() {
        use std::os::unix::fs::PermissionsExt;
        let home = tempfile::tempdir().unwrap();
        let locked = home.path().join("locked");
        fs::create_dir(&locked).unwrap();
        fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
        if fs::write(locked.join("probe"), "").is_ok() {
            return; // the superuser may write anywhere
        }
        let refused = Staging::begin(&locked.join("out")).unwrap_err();
        assert!(refused.to_string().contains("choose a place where you may write"), "{refused}");
    }
}
