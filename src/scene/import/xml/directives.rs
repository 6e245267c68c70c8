//! Elements that steer the reading: `<default>`, `<path>`, `<include>`.

use roxmltree::Node;

use super::builder::{Builder, DEEPEST, FileContext};
use super::tree::ElementId;

impl Builder {
    pub(super) fn default(&mut self, node: Node<'_, '_>, file: &FileContext<'_>) {
        let mut attributes = self.attributes(node, file);
        let name = attributes.require("name", &self.problems);
        let value = attributes.require("value", &self.problems);
        let location = attributes.location.clone();
        attributes.finish(&self.problems);
        if let (Some(name), Some(value)) = (name, value) {
            self.parameters.define(&name.value, value.value, location);
        }
    }

    pub(super) fn path(&mut self, node: Node<'_, '_>, file: &FileContext<'_>) {
        let mut attributes = self.attributes(node, file);
        if let Some(folder) = attributes.require("value", &self.problems) {
            self.files
                .add_path(&folder.value, &folder.location, &self.problems);
        }
        attributes.finish(&self.problems);
    }

    pub(super) fn include(
        &mut self,
        node: Node<'_, '_>,
        parent: ElementId,
        file: &FileContext<'_>,
    ) {
        let mut attributes = self.attributes(node, file);
        let name = attributes.require("filename", &self.problems);
        attributes.finish(&self.problems);
        let Some(name) = name else { return };
        let at = &name.location;
        let Some(path) = self.files.find_noted(&name.value, at, &self.problems) else {
            return;
        };
        let canonical = path.canonicalize().unwrap_or_else(|_| path.clone());
        if let Some(first) = self.open.iter().position(|(_, open)| *open == canonical) {
            let chain = self.open[first..]
                .iter()
                .map(|(shown, _)| shown)
                .chain([&path]);
            let chain: Vec<String> = chain.map(|file| file.display().to_string()).collect();
            return self
                .problems
                .error(at, format!("recursive include: {}", chain.join(" → ")));
        }
        if self.open.len() > DEEPEST {
            return self
                .problems
                .error(at, format!("more than {DEEPEST} files include each other"));
        }
        match std::fs::read(&path) {
            Ok(bytes) => {
                self.read_source(&path, &bytes, parent, Some(file.version));
            }
            Err(reason) => {
                self.problems
                    .error(at, format!("cannot read {}: {reason}", path.display()));
            }
        }
    }
}
