//! What each technique brings, in layers of their own.

use crate::film::{Canvas, Filter, Layer, PassBuffer};
use crate::path::Connection;

/// Layers that are made on demand.
pub(in crate::integrator) const OWN_LAYERS: &[&str] = &["techniques"];

/// Layers of the techniques that make paths up to some length, and one of all longer paths: their sum is the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct TechniqueLayers {
    /// Most edges of paths whose techniques have layers of their own.
    edges: usize,
    /// Place of the first among the layers.
    first: usize,
}

impl TechniqueLayers {
    /// Layers of paths of at most so many edges, the first of them at a place among all.
    pub(super) fn new(edges: usize, first: usize) -> Self {
        Self { edges, first }
    }

    /// Number of layers.
    pub(super) fn count(self) -> usize {
        self.place(self.edges + 1, 0) + 1
    }

    /// Place among them of a technique.
    ///
    /// - `eye`, `light`: as in [`Connection`].
    fn place(self, eye: usize, light: usize) -> usize {
        let edges = eye + light;
        // Before paths of k edges there are the 2 + … + k techniques of shorter ones.
        let before = |edges: usize| edges * (edges + 1) / 2 - 1;
        if edges <= self.edges {
            before(edges) + light
        } else {
            before(self.edges + 1)
        }
    }

    /// The layers, in the order of their places.
    pub(super) fn layers(self) -> impl Iterator<Item = Layer> {
        let names = (1..=self.edges).flat_map(|edges| {
            (0..=edges).map(move |light| format!("techniques.s{}t{light}", edges - light))
        });
        names
            .chain(["techniques.longer".to_owned()])
            .map(|name| Layer::new(&name, "RGB"))
    }

    /// Lets what a path brings land on the layer of its technique.
    pub(super) fn land(self, layers: &[PassBuffer], filter: &Filter, path: &Connection) {
        let place = self.first + self.place(path.eye, path.light);
        layers[place].add(filter, path.raster, path.energy().to_array());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_technique_has_a_place_of_its_own() {
        let layers = TechniqueLayers::new(4, 1);
        let names: Vec<String> = layers.layers().map(|layer| layer.name).collect();
        assert_eq!(names.len(), layers.count());
        for edges in 1..=4 {
            for light in 0..=edges {
                let name = format!("techniques.s{}t{light}", edges - light);
                assert_eq!(names[layers.place(edges - light, light)], name);
            }
        }
        assert_eq!(names[layers.place(2, 3)], "techniques.longer");
        assert_eq!(names[layers.place(0, 9)], "techniques.longer");
    }
}
