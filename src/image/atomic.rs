//! Files that appear whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::error::ImageError;

/// Counts the temporary files of this process.
static COUNTER: AtomicU64 = AtomicU64::new(0);

/// Attempts at a free name before giving up; a second one is hardly ever needed.
const ATTEMPTS: u32 = 16;

/// A file that is written under a temporary name beside its target and renamed at the end.
///
/// Any number of threads and processes may write in one folder at once. Dropped without
/// [`persist`](Self::persist), it leaves nothing behind and the target as it was.
///
/// Writing is not buffered: wrap a `&mut AtomicFile` in a [`std::io::BufWriter`] for small pieces.
#[derive(Debug)]
pub struct AtomicFile {
    file: File,
    target: PathBuf,
    /// Empty once renamed.
    temporary: Option<PathBuf>,
}

impl AtomicFile {
    /// Creates the temporary file.
    ///
    /// - `target`: the final name. A regular file there is replaced, and so is a symbolic link
    ///   itself, not what it points to.
    ///
    /// # Errors
    /// [`ImageError::Write`] when the folder is missing or may not be written to, and when the
    /// target is a folder or a device.
    pub fn create(target: &Path) -> Result<Self, ImageError> {
        Self::open(target).map_err(|source| ImageError::write(target, source))
    }

    fn open(target: &Path) -> io::Result<Self> {
        if target.file_name().is_none() {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "not the name of a file",
            ));
        }
        // Renaming onto a device such as /dev/null would replace the device.
        if fs::metadata(target).is_ok_and(|metadata| !metadata.is_file()) {
            let message = "it exists and is not a regular file";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
        let mut last = None;
        for _ in 0..ATTEMPTS {
            let temporary = target.with_file_name(temporary_name());
            match OpenOptions::new()
                .write(true)
                .create_new(true)
                .open(&temporary)
            {
                Ok(file) => {
                    return Ok(Self {
                        file,
                        target: target.to_owned(),
                        temporary: Some(temporary),
                    });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => last = Some(error),
                Err(error) => return Err(error),
            }
        }
        Err(last.unwrap_or_else(|| io::Error::from(io::ErrorKind::AlreadyExists)))
    }

    /// The open temporary file, for what needs a [`File`].
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Flushes to the disk and gives the file its final name.
    ///
    /// # Errors
    /// [`ImageError::Write`] when either fails; the target is then as it was.
    pub fn persist(mut self) -> Result<(), ImageError> {
        let failed = |source| ImageError::write(&self.target, source);
        self.file.sync_all().map_err(failed)?;
        if let Some(temporary) = &self.temporary {
            fs::rename(temporary, &self.target).map_err(failed)?;
        }
        self.temporary = None;
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // The error that led here matters more than a file that cannot be removed.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// A hidden name that no other thread or process, on this host or another, is likely to use.
fn temporary_name() -> String {
    let count = COUNTER.fetch_add(1, Ordering::Relaxed);
    // The standard library seeds each state from the system's random numbers.
    let random = RandomState::new().build_hasher().finish();
    format!(".lumiflow-{}-{count}-{random:016x}.tmp", process::id())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_when_it_is_persisted() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.json");
        fs::write(&target, "old").unwrap();
        let mut file = AtomicFile::create(&target).unwrap();
        file.write_all(b"new").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"old");
        file.persist().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.json"]);
    }

    #[test]
    fn a_dropped_file_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = AtomicFile::create(&folder.path().join("a.json")).unwrap();
        file.write_all(b"half").unwrap();
        assert_eq!(names(folder.path()).len(), 1);
        drop(file);
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn what_cannot_be_replaced_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing/a.json");
        let error = AtomicFile::create(&missing).unwrap_err().to_string();
        assert!(error.contains("missing/a.json: No such file"), "{error}");
        let error = AtomicFile::create(folder.path()).unwrap_err().to_string();
        assert!(error.contains("not a regular file"), "{error}");
        assert!(AtomicFile::create(Path::new("/dev/null")).is_err());
        assert!(AtomicFile::create(Path::new("..")).is_err());
        assert!(AtomicFile::create(Path::new("")).is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_failed_rename_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.json");
        let file = AtomicFile::create(&target).unwrap();
        fs::create_dir(&target).unwrap();
        assert!(file.persist().is_err());
        assert_eq!(names(folder.path()), ["a.json"]);
    }

    #[test]
    fn temporary_names_differ() {
        assert_ne!(temporary_name(), temporary_name());
    }
}
