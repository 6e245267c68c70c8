//! Groups of shapes, and the instances that place them.

use super::super::loader::Loader;
use super::super::xml::{ElementId, ElementKind};
use crate::scene::{BsdfId, GroupId};
use crate::shape::Shape;

/// Shapes that hold other shapes.
pub(super) const HOLDERS: [&str; 3] = ["instance", "merge", "shapegroup"];

impl Loader<'_> {
    /// Builds a group once; `None` when it holds nothing that an instance could place.
    pub(super) fn group(&mut self, id: ElementId) -> Option<GroupId> {
        if let Some(known) = self.groups.get(&id) {
            return *known;
        }
        let mut reader = self.reader(id);
        let mut members = Vec::new();
        let children = reader.children(ElementKind::Shape);
        if children.is_empty() {
            reader.warning("", "the group holds no shapes");
        }
        for child in children {
            members.extend(self.member(child));
        }
        reader.finish();
        let group = (!members.is_empty()).then(|| self.builder.add_group(members));
        self.groups.insert(id, group);
        group
    }

    /// Builds a shape of a group.
    fn member(&mut self, id: ElementId) -> Option<(Shape, BsdfId)> {
        if !self.is_single(id, "shapegroup") {
            return None;
        }
        let mut built = self.single_shape(id)?;
        if let Some((_, emitter)) = built.emission {
            let message = "an emitter in a shapegroup: shapes that are placed by instances \
                           cannot emit light";
            self.problems.error(self.location(emitter), message);
            return None;
        }
        self.omit_coordinates(&mut built, true);
        self.members.push(id);
        Some((built.shape, built.bsdf))
    }

    /// Adds the shapes of a `merge` to the scene, each as it is: one mesh of several would look the same.
    pub(super) fn merged(&mut self, id: ElementId) {
        let mut reader = self.reader(id);
        let members = reader.children(ElementKind::Shape);
        reader.finish();
        for member in members {
            if self.is_single(member, "merge") {
                self.shape(member);
            }
        }
    }

    /// True for a shape that holds no others; notes that one which does has no place in another.
    fn is_single(&self, id: ElementId, parent: &str) -> bool {
        let element = &self.tree[id];
        let is_single = !HOLDERS.contains(&element.plugin.as_str());
        if !is_single {
            let title = element.title();
            let message = format!("found {title} in a {parent}, expected a shape by itself");
            self.problems.error(self.location(id), message);
        }
        is_single
    }

    /// Places a group in the world.
    pub(super) fn instance(&mut self, id: ElementId) {
        let mut reader = self.reader(id);
        let to_world = reader.transform("to_world").matrix();
        let group = reader.child(ElementKind::Shape);
        reader.finish();
        let Some(group) = group else {
            // Of a ref that leads nowhere, the problem is known.
            if self.problems.has_errors() {
                return;
            }
            let message = "an instance needs a ref to a shape \"shapegroup\"";
            self.problems.error(self.location(id), message);
            return;
        };
        if self.tree[group].plugin != "shapegroup" {
            let title = self.tree[group].title();
            let message = format!("an instance of {title}, expected one of a \"shapegroup\"");
            self.problems.error(self.location(id), message);
            return;
        }
        let Some(group) = self.group(group) else {
            return;
        };
        match self.builder.add_instance(group, to_world) {
            Ok(()) => self.instances.push(id),
            Err(error) => self.problems.error(self.location(id), error.to_string()),
        }
    }
}
