//! The elements inside of an element.

use super::super::kinds::ElementKind;
use super::super::tree::{Child, ElementId};
use super::ElementReader;

impl ElementReader<'_> {
    /// All children of `kind`, in the order of the file, whatever their names.
    pub fn children(&mut self, kind: ElementKind) -> Vec<ElementId> {
        let mut found = Vec::new();
        for (child, used) in self.element.children.iter().zip(&mut self.used_children) {
            if self.tree[child.element].kind == kind {
                *used = true;
                found.push(child.element);
            }
        }
        found
    }

    /// The child of `kind` where there can be one only; further ones are ignored with a warning.
    pub fn child(&mut self, kind: ElementKind) -> Option<ElementId> {
        let found = self.children(kind);
        let here = self.element.children.iter();
        for extra in here
            .filter(|child| self.tree[child.element].kind == kind)
            .skip(1)
        {
            let message = format!("{} holds one {kind} only; ignored", self.element.title());
            self.problems.warning(&extra.location, message);
        }
        found.first().copied()
    }

    /// The child called `name`, if there is one; one of another kind is an error.
    pub fn child_named(&mut self, name: &str, kind: ElementKind) -> Option<ElementId> {
        self.ask(name);
        let named = |child: &Child| {
            child
                .name
                .as_ref()
                .is_some_and(|found| found.normalised == name)
        };
        let index = self.element.children.iter().rposition(named)?;
        let child = &self.element.children[index];
        self.used_children[index] = true;
        let found = self.tree[child.element].kind;
        if found == kind {
            return Some(child.element);
        }
        let message = format!("\"{name}\" is a {found}, expected a {kind}");
        self.problems.error(&child.location, message);
        None
    }
}
