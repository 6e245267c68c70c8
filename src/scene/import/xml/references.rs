//! Ids, aliases and refs: which object a name means.

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::builder::{Builder, DEEPEST, FileContext, MOST_PARTS};
use super::kinds::ElementKind;
use super::names::Name;
use super::source::Location;
use super::suggest::did_you_mean;
use super::tree::{Child, Element, ElementId};

/// A child of an object before refs are resolved.
pub(super) struct DraftChild {
    pub(super) name: Option<Name>,
    pub(super) location: Location,
    pub(super) target: Target,
}

/// What a [`DraftChild`] stands for.
pub(super) enum Target {
    /// An object that stands inside its parent.
    Element(ElementId),
    /// The id of an object elsewhere.
    Reference(String),
}

/// The names of objects.
#[derive(Default)]
pub(super) struct Ids {
    /// `None` for an object that could not be read: refs to it need no further message.
    declared: BTreeMap<String, (Option<ElementId>, Location)>,
    /// In the order of the files.
    aliases: Vec<Alias>,
}

struct Alias {
    name: String,
    original: String,
    location: Location,
}

/// What an id leads to.
enum Lookup {
    Found(ElementId),
    /// Reported elsewhere.
    Broken,
    Unknown,
}

/// How far the search for circles is with an object.
#[derive(Clone, Copy)]
enum State {
    New,
    /// On the way from the start to where the search stands.
    Open,
    Done(Extent),
}

/// How much lies in an object.
#[derive(Clone, Copy)]
struct Extent {
    /// Longest way down from it.
    height: usize,
    /// It and all that it holds, each object as often as it is referred to.
    parts: usize,
}

impl Ids {
    fn names(&self) -> impl Iterator<Item = &str> {
        let aliases = self.aliases.iter().map(|alias| alias.name.as_str());
        self.declared.keys().map(String::as_str).chain(aliases)
    }

    fn lookup(&self, name: &str) -> Lookup {
        let mut name = name;
        // Each step uses up an alias, unless they go round in a circle.
        for _ in 0..=self.aliases.len() {
            if let Some((element, _)) = self.declared.get(name) {
                return element.map_or(Lookup::Broken, Lookup::Found);
            }
            match self.aliases.iter().find(|alias| alias.name == name) {
                Some(alias) => name = &alias.original,
                None => break,
            }
        }
        Lookup::Unknown
    }
}

impl Builder {
    /// Notes that `id` names `element`.
    pub(super) fn declare(&mut self, id: &str, element: Option<ElementId>, location: &Location) {
        match self.ids.declared.get(id) {
            Some((_, first)) => {
                let message = format!("the id \"{id}\" is taken: see {first}");
                self.problems.error(location, message);
            }
            None => {
                self.ids
                    .declared
                    .insert(id.to_owned(), (element, location.clone()));
            }
        }
    }

    pub(super) fn alias(&mut self, node: Node<'_, '_>, file: &FileContext<'_>) {
        let mut attributes = self.attributes(node, file);
        let original = attributes.require("id", &self.problems);
        let name = attributes.require("as", &self.problems);
        let location = attributes.location.clone();
        attributes.finish(&self.problems);
        if let (Some(original), Some(name)) = (original, name) {
            let (name, original) = (name.value, original.value);
            self.ids.aliases.push(Alias {
                name,
                original,
                location,
            });
        }
    }

    pub(super) fn reference(
        &mut self,
        node: Node<'_, '_>,
        parent: ElementId,
        file: &FileContext<'_>,
    ) {
        let mut attributes = self.attributes(node, file);
        let id = attributes.require("id", &self.problems);
        let name = attributes.take("name").map(|name| Name::new(name.value));
        let location = attributes.location.clone();
        attributes.finish(&self.problems);
        if let Some(id) = id {
            let target = Target::Reference(id.value);
            self.drafts[parent.0 as usize].push(DraftChild {
                name,
                location,
                target,
            });
        }
    }

    /// Turns drafts into children: every ref names an object of a kind that has a place there, and
    /// no object is inside itself. What does not is reported and left out.
    pub(super) fn resolve_references(&mut self) {
        self.check_aliases();
        let drafts = std::mem::take(&mut self.drafts);
        for (index, drafts) in drafts.into_iter().enumerate() {
            let children = drafts.into_iter().filter_map(|draft| {
                let element = match &draft.target {
                    Target::Element(element) => *element,
                    Target::Reference(id) => self.resolve(index, id, &draft.location)?,
                };
                Some(Child {
                    name: draft.name,
                    location: draft.location,
                    element,
                })
            });
            let children: Vec<Child> = children.collect();
            self.elements[index].children = children;
        }
        self.cut_cycles();
    }

    fn check_aliases(&self) {
        for alias in &self.ids.aliases {
            let Alias {
                name,
                original,
                location,
            } = alias;
            if let Some((_, first)) = self.ids.declared.get(name) {
                self.problems
                    .error(location, format!("the id \"{name}\" is taken: see {first}"));
            } else if matches!(self.ids.lookup(original), Lookup::Unknown) {
                let others = self.ids.names().filter(|other| other != name);
                let hint = did_you_mean(original, others);
                self.problems.error(
                    location,
                    format!("alias of the unknown id \"{original}\"{hint}"),
                );
            }
        }
    }

    fn resolve(&self, parent: usize, id: &str, location: &Location) -> Option<ElementId> {
        let parent = &self.elements[parent];
        let allowed = parent.kind.allowed_children();
        let fits = |name: &&str| match self.ids.lookup(name) {
            Lookup::Found(element) => allowed.contains(&self.elements[element.0 as usize].kind),
            _ => false,
        };
        let fitting_hint = || did_you_mean(id, self.ids.names().filter(fits));
        match self.ids.lookup(id) {
            Lookup::Broken => None,
            Lookup::Unknown => {
                let message = format!("ref to the unknown id \"{id}\"{}", fitting_hint());
                self.problems.error(location, message);
                None
            }
            Lookup::Found(found) => {
                let element = &self.elements[found.0 as usize];
                if allowed.contains(&element.kind) {
                    return Some(found);
                }
                let message = format!(
                    "\"{id}\" is a {} (see {}); {} holds {}{}",
                    element.kind,
                    element.location,
                    parent.title(),
                    list_of(allowed),
                    fitting_hint()
                );
                self.problems.error(location, message);
                None
            }
        }
    }

    /// Leaves out each child by which an object would be inside itself, nested too deep, or too large.
    fn cut_cycles(&mut self) {
        let mut states = vec![State::New; self.elements.len()];
        let mut cut = BTreeSet::new();
        for start in 0..self.elements.len() {
            let mut trail = vec![(start, 0)];
            while let Some((index, position)) = trail.pop() {
                if matches!(states[index], State::Done(_)) {
                    continue;
                }
                states[index] = State::Open;
                let Some(child) = self.elements[index].children.get(position) else {
                    states[index] = State::Done(self.extent(index, &states, &mut cut));
                    continue;
                };
                trail.push((index, position + 1));
                let inner = child.element.0 as usize;
                match states[inner] {
                    State::New => trail.push((inner, 0)),
                    State::Done(_) => {}
                    State::Open => {
                        let open = trail.iter().map(|(open, _)| *open);
                        let circle: Vec<usize> = open.skip_while(|open| *open != inner).collect();
                        self.note_circle(&circle, &child.location);
                        cut.insert((index, position));
                    }
                }
            }
        }
        for (index, position) in cut.into_iter().rev() {
            self.elements[index].children.remove(position);
        }
    }

    /// How much lies in an object whose children are done; cuts those that are too high or too much.
    fn extent(&self, index: usize, states: &[State], cut: &mut BTreeSet<(usize, usize)>) -> Extent {
        let element = &self.elements[index];
        // Others are built once, however often they are referred to.
        let is_copied = matches!(element.kind, ElementKind::Bsdf | ElementKind::Texture);
        let mut whole = Extent {
            height: 0,
            parts: 1,
        };
        for (position, child) in element.children.iter().enumerate() {
            let State::Done(inner) = states[child.element.0 as usize] else {
                continue;
            };
            let parts = whole.parts.saturating_add(inner.parts);
            let complaint = if inner.height >= DEEPEST {
                format!("objects are nested more than {DEEPEST} deep")
            } else if is_copied && parts > MOST_PARTS {
                let title = element.title();
                format!("{title} holds more than {MOST_PARTS} objects, with those of its refs")
            } else {
                let height = whole.height.max(inner.height + 1);
                whole = Extent { height, parts };
                continue;
            };
            self.problems.error(&child.location, complaint);
            cut.insert((index, position));
        }
        whole
    }

    fn note_circle(&self, circle: &[usize], location: &Location) {
        let name = |index: &usize| {
            let element: &Element = &self.elements[*index];
            element
                .id
                .as_ref()
                .map_or_else(|| element.title(), |id| format!("\"{id}\""))
        };
        let names: Vec<String> = circle.iter().chain(circle.first()).map(name).collect();
        self.problems.error(
            location,
            format!("circular reference: {}", names.join(" → ")),
        );
    }
}

/// `bsdf, emitter or medium`
fn list_of(kinds: &[ElementKind]) -> String {
    match kinds.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => last.to_string(),
        Some((last, rest)) => {
            let rest: Vec<&str> = rest.iter().map(|kind| kind.name()).collect();
            format!("{} or {last}", rest.join(", "))
        }
    }
}
