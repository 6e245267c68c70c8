//! Which files the scenes of a call are rendered to.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::image::AtomicFile;
use crate::output::FileKind;

/// A scene to render and the files that it goes to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Target {
    /// The scene file.
    pub(super) scene: PathBuf,
    /// The scene's name.
    pub(super) name: String,
    /// The files to write.
    pub(super) files: Vec<PathBuf>,
}

/// Stands for the scene's name in the names of files.
const NAME: &str = "{name}";

/// Works out all files that will be written.
///
/// # Errors
/// Unknown extensions, and files that would be written twice.
pub(super) fn targets(scenes: &[PathBuf], outputs: &[String]) -> Result<Vec<Target>, Failure> {
    let default = [format!("{NAME}.exr")];
    let outputs = if outputs.is_empty() {
        &default
    } else {
        outputs
    };
    let mut owners: HashMap<PathBuf, &Path> = HashMap::new();
    let mut targets = Vec::new();
    for scene in scenes {
        let name = scene_name(scene);
        let mut files = Vec::new();
        for output in outputs {
            let file = PathBuf::from(output.replace(NAME, &name));
            check_extension(&file)?;
            if let Some(other) = owners.insert(identity(&file), scene) {
                return Err(written_twice(&file, scene, other, output));
            }
            files.push(file);
        }
        targets.push(Target {
            scene: scene.clone(),
            name,
            files,
        });
    }
    Ok(targets)
}

/// Tries whether all files can be written, so that no render is lost at its end.
///
/// # Errors
/// For a folder that is missing or not writable, and for a name that is not that of a file.
pub(super) fn check_writable(targets: &[Target]) -> Result<(), Failure> {
    for file in targets.iter().flat_map(|target| &target.files) {
        check_file(file)?;
    }
    Ok(())
}

/// Tries whether a file can be written; leaves nothing behind.
pub(super) fn check_file(file: &Path) -> Result<(), Failure> {
    AtomicFile::create(file)?;
    Ok(())
}

/// Name of a scene: that of its file without extension; the folder's for a file called `scene`.
pub(super) fn scene_name(scene: &Path) -> String {
    let text = |part: &std::ffi::OsStr| part.to_string_lossy().into_owned();
    let stem = scene.file_stem().map_or_else(String::new, text);
    if !stem.eq_ignore_ascii_case("scene") {
        return stem;
    }
    let absolute = std::path::absolute(scene).ok();
    let folder = absolute.as_deref().and_then(Path::parent);
    folder.and_then(Path::file_name).map_or(stem, text)
}

fn check_extension(file: &Path) -> Result<(), Failure> {
    if FileKind::of(file).is_some() {
        return Ok(());
    }
    let known: Vec<String> = FileKind::EXTENSIONS
        .iter()
        .map(|(extension, _)| format!(".{extension}"))
        .collect();
    let file = file.display();
    Err(Failure::Usage(format!(
        "{file}: unknown kind of image, expected one of {}",
        known.join(", ")
    )))
}

/// Makes two ways to write one file's name equal, where its folder exists.
fn identity(file: &Path) -> PathBuf {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    folder.join(file.file_name().unwrap_or_default())
}

fn written_twice(file: &Path, scene: &Path, other: &Path, output: &str) -> Failure {
    let file = file.display();
    if scene == other {
        return Failure::Usage(format!(
            "{file} would be written twice for {}",
            scene.display()
        ));
    }
    let hint = if output.contains(NAME) {
        ""
    } else {
        "; put {name} into the name of the file"
    };
    let (scene, other) = (scene.display(), other.display());
    Failure::Usage(format!(
        "{file} would be written for both {other} and {scene}{hint}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(scenes: &[&str], outputs: &[&str]) -> Result<Vec<Vec<String>>, String> {
        let scenes: Vec<PathBuf> = scenes.iter().map(PathBuf::from).collect();
        let outputs: Vec<String> = outputs.iter().map(|o| (*o).to_owned()).collect();
        match targets(&scenes, &outputs) {
            Ok(targets) => Ok(targets
                .iter()
                .map(|t| t.files.iter().map(|f| f.display().to_string()).collect())
                .collect()),
            Err(Failure::Usage(message)) => Err(message),
            Err(other) => panic!("{other:?}"),
        }
    }

    #[test]
    fn names_come_from_the_file_or_its_folder() {
        let both = files(&["a/box.xml", "veach-door/scene.xml"], &["out/{name}.exr"]).unwrap();
        assert_eq!(both, [["out/box.exr"], ["out/veach-door.exr"]]);
        assert_eq!(files(&["b.v2.xml"], &[]).unwrap(), [["b.v2.exr"]]);
        let two = files(&["a.xml"], &["x.exr", "{name}.PNG"]).unwrap();
        assert_eq!(two, [["x.exr", "a.PNG"]]);
    }

    #[test]
    fn one_file_for_two_renders_is_refused() {
        let message = files(&["a.xml", "b.xml"], &["x.exr"]).unwrap_err();
        assert_eq!(
            message,
            "x.exr would be written for both a.xml and b.xml; put {name} into the name of the file"
        );
        let message = files(&["p/a.xml", "q/a.xml"], &[]).unwrap_err();
        assert_eq!(
            message,
            "a.exr would be written for both p/a.xml and q/a.xml"
        );
        let message = files(&["a.xml"], &["x.exr", "./x.exr"]).unwrap_err();
        assert_eq!(message, "./x.exr would be written twice for a.xml");
    }

    #[test]
    fn unknown_extensions_list_the_known_ones() {
        assert_eq!(
            files(&["a.xml"], &["a.jpg"]).unwrap_err(),
            "a.jpg: unknown kind of image, expected one of .exr, .png"
        );
        assert!(files(&["a.xml"], &["a"]).is_err());
    }

    #[test]
    fn folders_are_checked_without_leaving_a_trace() {
        let folder = tempfile::tempdir().unwrap();
        check_file(&folder.path().join("a.exr")).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let missing = check_file(&folder.path().join("b/a.exr"));
        assert_eq!(missing.unwrap_err().exit_code(), 4);
    }
}
