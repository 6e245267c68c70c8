//! Parts of a hall. They are made in place and are not fitted; all have edges.

use std::f64::consts::FRAC_PI_2;

use super::mesh::Mesh;

/// A pedestal, 1 high and 1 wide at its foot.
pub(super) fn plinth() -> Mesh {
    let outline: [[f64; 2]; 12] = [
        [0.0, 0.0],
        [0.5, 0.0],
        [0.5, 0.07],
        [0.485, 0.085],
        [0.455, 0.1],
        [0.44, 0.12],
        [0.44, 0.9],
        [0.45, 0.915],
        [0.475, 0.93],
        [0.48, 0.945],
        [0.48, 1.0],
        [0.0, 1.0],
    ];
    let rows = (0..=4).map(|i| {
        let [x, z] = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]][i % 4];
        outline.iter().map(|[r, y]| [x * r, *y, z * r]).collect()
    });
    Mesh::rows(&rows.collect::<Vec<_>>()).outwards()
}

/// A moulding with a gutter on its top for lamps, along z from 0 to 1. It stands out from x = 0 by 0.4;
/// the bottom of the gutter is at y = 0.36, its lip at 0.5.
pub(super) fn cornice() -> Mesh {
    let mut outline: Vec<[f64; 2]> = vec![[0.0, 0.0], [0.06, 0.0], [0.06, 0.05]];
    outline.extend((0..=12).map(|i| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(i) / 12.0).sin_cos();
        [0.06 + 0.14 * (1.0 - cos), 0.05 + 0.12 * sin]
    }));
    outline.extend([[0.22, 0.17], [0.22, 0.2]]);
    outline.extend((0..=12).map(|i| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(i) / 12.0).sin_cos();
        [0.22 + 0.14 * sin, 0.2 + 0.14 * (1.0 - cos)]
    }));
    outline.extend([
        [0.4, 0.34],
        [0.4, 0.5],
        [0.35, 0.5],
        [0.35, 0.36],
        [0.0, 0.36],
    ]);
    let rows =
        [0.0, 1.0].map(|z| -> Vec<[f64; 3]> { outline.iter().map(|[x, y]| [*x, *y, z]).collect() });
    Mesh::rows(&rows)
}

/// A vault with coffers: an arc over x from -1 to 1 that rises by 0.4, along z from -1 to 1.
pub(super) fn vault() -> Mesh {
    const COFFERS: [usize; 2] = [7, 9];
    // Places within a coffer, and how deep it is there, in parts of its depth.
    const STEPS: [(f64, f64); 12] = [
        (0.0, 0.0),
        (0.1, 0.0),
        (0.11, 0.5),
        (0.19, 0.5),
        (0.2, 1.0),
        (0.35, 1.0),
        (0.5, 1.0),
        (0.65, 1.0),
        (0.8, 1.0),
        (0.81, 0.5),
        (0.89, 0.5),
        (0.9, 0.0),
    ];
    let places = |count: usize| -> Vec<(f64, f64)> {
        let inner = (0..count).flat_map(|i| {
            STEPS.map(|(x, depth)| ((i as f64 + x) / count as f64 * 2.0 - 1.0, depth))
        });
        inner.chain([(1.0, 0.0)]).collect()
    };
    // A chord of 2 and a rise of 0.4.
    let (rise, depth) = (0.4_f64, 0.035);
    let radius = (1.0 + rise * rise) / (2.0 * rise);
    let half = (1.0 / radius).asin();
    let rows = places(COFFERS[1]).into_iter().map(|(z, along)| {
        let points = places(COFFERS[0]).into_iter().map(|(a, across)| {
            let far = radius + depth * along.min(across);
            let (sin, cos) = (half * a).sin_cos();
            [far * sin, far * cos - (radius - rise), z]
        });
        points.collect()
    });
    Mesh::rows(&rows.collect::<Vec<_>>())
}
