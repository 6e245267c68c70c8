//! A place in the plane for every triangle of a mesh.

use super::Vec2;

/// Lays the triangles of a mesh out in the plane, each in a square of its own.
///
/// The coordinates are barycentrics, shifted: a point's place tells its triangle and where it lies on
/// it. The price is precision: between the triangles of a mesh of a million, barycentrics are good to
/// 2⁻¹³, of a thousand to 2⁻¹⁸.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangleChart {
    /// Squares in a row.
    columns: u32,
}

impl TriangleChart {
    /// The chart of a mesh of so many triangles.
    pub fn new(triangles: usize) -> Self {
        let columns = (triangles as f64).sqrt().ceil();
        Self {
            columns: (columns as u32).max(1),
        }
    }

    /// The place of a point.
    ///
    /// - `barycentrics`: of the second and third corner, in [0, 1].
    #[inline]
    pub fn place(self, triangle: u32, barycentrics: Vec2) -> Vec2 {
        let (row, column) = (triangle / self.columns, triangle % self.columns);
        // Half a square of margin: rounding leads to no neighbour.
        Vec2::new(column as f32, row as f32) * 2.0 + 0.5 + barycentrics
    }

    /// The triangle at a place of [`TriangleChart::place`], and the barycentrics there.
    #[inline]
    pub fn locate(self, place: Vec2) -> (u32, Vec2) {
        let square = (place * 0.5).floor();
        let barycentrics = (place - square * 2.0 - 0.5).clamp(Vec2::ZERO, Vec2::ONE);
        let (row, column) = (square.y as u32, square.x as u32);
        let triangle = row.saturating_mul(self.columns).saturating_add(column);
        (triangle, barycentrics)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lead_back_to_their_points() {
        for (triangles, tolerance) in [(1, 1e-6), (12, 1e-6), (1000, 8e-6), (1_000_000, 2.5e-4)] {
            let chart = TriangleChart::new(triangles);
            for triangle in [0, triangles / 3, triangles - 1].map(|index| index as u32) {
                for (b1, b2) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, 0.6), (-1e-7, 0.5)] {
                    let barycentrics = Vec2::new(b1, b2);
                    let (found, there) = chart.locate(chart.place(triangle, barycentrics));
                    assert_eq!(found, triangle);
                    assert!(there.distance(barycentrics) < tolerance, "{there}");
                }
            }
        }
    }
}
