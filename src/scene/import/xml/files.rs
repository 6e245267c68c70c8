//! Which file on the disk a name in a scene means.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use super::diagnostics::Diagnostics;
use super::source::Location;
use super::suggest::did_you_mean;

/// Looks for files in the folder of the including file, the folder of the root file, the `<path>`
/// folders and the folders of the command line, in this order.
///
/// A name as written wins over one that differs in letter case, whatever the folder.
#[derive(Debug, Default)]
pub(in crate::scene::import) struct FileFinder {
    root: PathBuf,
    /// From `<path>`.
    paths: Vec<PathBuf>,
    /// From the command line.
    extra: Vec<PathBuf>,
    /// Names in each folder seen: scenes with hundreds of misspelt meshes ask again and again.
    listings: RefCell<HashMap<PathBuf, Vec<String>>>,
}

/// A file that was found.
struct Found {
    path: PathBuf,
    exact: bool,
}

impl FileFinder {
    pub(in crate::scene::import) fn new(root: &Path, extra: &[PathBuf]) -> Self {
        Self {
            root: root.to_path_buf(),
            extra: extra.to_vec(),
            ..Self::default()
        }
    }

    /// Adds the folder of a `<path>` element, relative to the file it stands in or to the root.
    pub(super) fn add_path(&mut self, name: &str, location: &Location, problems: &Diagnostics) {
        let name = unify_slashes(name);
        let bases = [location.source.folder(), &self.root];
        let folder = bases
            .map(|base| base.join(&name))
            .into_iter()
            .find(|path| is_dir(path));
        match folder {
            Some(folder) => self.paths.push(folder),
            None => problems.warning(location, format!("folder \"{name}\" not found; ignored")),
        }
    }

    /// Finds `name`, noting what is odd about it; `None` when it is missing, which is noted too.
    pub(in crate::scene::import) fn find_noted(
        &self,
        name: &str,
        location: &Location,
        problems: &Diagnostics,
    ) -> Option<PathBuf> {
        let Some(found) = self.find(name, location.source.folder()) else {
            let missing = self.missing(name, location.source.folder());
            problems.unsupported(location, missing, "left out");
            return None;
        };
        if !found.exact {
            problems.warning(
                location,
                format!(
                    "file \"{name}\" is written \"{}\" on disk",
                    found.path.display()
                ),
            );
        }
        Some(found.path)
    }

    fn find(&self, name: &str, base: &Path) -> Option<Found> {
        let name = unify_slashes(name);
        if name.is_empty() {
            return None;
        }
        let folders = self.folders(base);
        let exact = folders
            .iter()
            .map(|folder| folder.join(&name))
            .find(|path| path.is_file());
        if let Some(path) = exact {
            return Some(Found { path, exact: true });
        }
        let path = folders
            .iter()
            .find_map(|folder| self.ignoring_case(folder, Path::new(&name)))?;
        Some(Found { path, exact: false })
    }

    /// All folders to look in, each once.
    fn folders<'s>(&'s self, base: &'s Path) -> Vec<&'s Path> {
        let mut folders: Vec<&Path> = Vec::new();
        let all = [base, &self.root];
        let more = self.paths.iter().chain(&self.extra).map(PathBuf::as_path);
        for folder in all.into_iter().chain(more) {
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
        folders
    }

    /// Follows `name` from `folder` part by part, taking what differs in letter case only.
    fn ignoring_case(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        let mut path = folder.to_path_buf();
        for component in name.components() {
            let Component::Normal(part) = component else {
                path.push(component);
                continue;
            };
            let exact = path.join(part);
            if exact.exists() {
                path = exact;
                continue;
            }
            let wanted = part.to_string_lossy().to_lowercase();
            let names = self.listing(&path);
            path.push(names.iter().find(|name| name.to_lowercase() == wanted)?);
        }
        path.is_file().then_some(path)
    }

    /// The sorted names in a folder; none for one that cannot be read.
    fn listing(&self, folder: &Path) -> Vec<String> {
        let mut listings = self.listings.borrow_mut();
        let names = listings.entry(folder.to_path_buf()).or_insert_with(|| {
            let entries = std::fs::read_dir(readable(folder))
                .into_iter()
                .flatten()
                .flatten();
            let mut names: Vec<String> = entries
                .filter_map(|entry| entry.file_name().into_string().ok())
                .collect();
            names.sort();
            names
        });
        names.clone()
    }

    fn missing(&self, name: &str, base: &Path) -> String {
        let unified = unify_slashes(name);
        let inner = Path::new(&unified).parent().unwrap_or(Path::new(""));
        let folders = self.folders(base);
        let nearby = folders.iter().flat_map(|folder| {
            let names = self.listing(&folder.join(inner));
            names
                .into_iter()
                .map(|file| inner.join(file).to_string_lossy().into_owned())
        });
        let nearby: Vec<String> = nearby.collect();
        let hint = did_you_mean(&unified, nearby.iter().map(String::as_str));
        let shown: Vec<String> = folders
            .iter()
            .map(|folder| readable(folder).display().to_string())
            .collect();
        format!("file \"{name}\" not found in {}{hint}", shown.join(", "))
    }
}

/// Windows paths with `/`, which every system understands.
fn unify_slashes(name: &str) -> String {
    name.replace('\\', "/")
}

/// The empty path, which stands for the current folder, as one that can be read and shown.
fn readable(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}

fn is_dir(path: &Path) -> bool {
    readable(path).is_dir()
}
