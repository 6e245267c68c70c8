//! What may vary along a mutation: logarithms of the factors of all targets, each computed from the
//! positions of a path's vertices, and where the path is seen.

use lumiflow::math::Vec3;
use lumiflow::path::{Event, Path, PathSpace, PathVertex};
use lumiflow::sensor::SensorModel;

use super::stages::SIDE;

/// Names of the factors.
pub(crate) const NAMES: [&str; 19] = [
    "image cosine",
    "image distance²",
    "pixels/sr",
    "head cosine",
    "first cosine",
    "adjoint",
    "shading part",
    "largest angle",
    "first edge²",
    "connection cosine",
    "connection distance²",
    "aimed area",
    "turned cosine",
    "Dirac coefficients",
    "selection",
    "luminance",
    "raster x",
    "raster y",
    "left half",
];

/// The functions of a path.
pub(crate) type Factors = [f64; NAMES.len()];

/// The functions at a path; zero where a path has no such factor.
pub(crate) fn factors(space: &PathSpace<'_>, path: &Path) -> Factors {
    let vertices = path.vertices();
    let edge = |a: usize, b: usize| space.edge(&vertices[a], &vertices[b]).expect("an edge");
    let cos = |at: usize, direction: Vec3| f64::from(vertices[at].geometric_cos(direction));
    let last = path.edges();
    let (seen, squared) = edge(0, 1);
    let mut of = [0.0; NAMES.len()];
    of[0] = cos(1, seen).ln();
    of[1] = f64::from(squared).ln();
    of[2] = f64::from(space.sensor.pixels_per_steradian(seen)).ln();
    if let Some(head) = head(vertices) {
        of[3] = cos(head, edge(head, head - 1).0).ln();
        let (in_1, first) = edge(1, 2);
        of[4] = cos(1, in_1).ln();
        for (index, vertex) in vertices.iter().enumerate().take(head).skip(2) {
            of[5] += f64::from(vertex.adjoint).ln();
            of[6] += space.shading_factor(path, index).map_or(0.0, f64::ln);
        }
        let length =
            |a: usize| f64::from(vertices[a].position().distance(vertices[a + 1].position()));
        of[7] = (length(0) / (1..head).map(length).sum::<f64>()).ln();
        of[8] = f64::from(first).ln();
    }
    let finite = |at: usize| vertices[at].event == Event::Finite;
    let connected = (1..last).find(|i| finite(*i) && !vertices[i + 1].event.is_dirac());
    if let Some(at) = connected {
        let (direction, squared) = edge(at, at + 1);
        of[9] = cos(at + 1, direction).ln();
        of[10] = f64::from(squared).ln();
    }
    for index in (1..connected.unwrap_or(last)).filter(|i| finite(*i)) {
        of[11] += space
            .solid_angle_per_area(&vertices[index], &vertices[index + 1])
            .ln();
        let (direction, _) = edge(index, index + 1);
        of[12] += f64::from(vertices[index].point.shading_normal.dot(direction).abs()).ln();
    }
    for index in (1..last).filter(|i| vertices[*i].event.is_dirac()) {
        of[13] += f64::from(vertices[index].value.luminance()).ln();
        of[14] += space
            .selection(path, index)
            .map_or(0.0, |s| f64::from(s.probability).ln());
    }
    of[15] = path.luminance().ln();
    let raster = path.raster() / SIDE as f32;
    of[16] = f64::from(raster.x) * 3.0;
    of[17] = f64::from(raster.y) * 3.0;
    of[18] = f64::from(u8::from(raster.x < 0.5));
    of
}

/// Index of the vertex where a caustic perturbation starts.
fn head(vertices: &[PathVertex]) -> Option<usize> {
    if vertices.len() < 3 || vertices[1].event != Event::Finite {
        return None;
    }
    (2..vertices.len()).find(|i| !vertices[*i].event.is_dirac())
}
