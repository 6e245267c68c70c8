//! Weights of bidirectional techniques, from one quantity that each vertex carries along.

use crate::path::Heuristic;

/// How the weights of all techniques that make a path follow from the ratios of their densities.
///
/// The power heuristic with any exponent, of which the balance heuristic is that with one; or all to the
/// technique with the largest density. Powers are taken of each factor, so that sums need no path.
///
/// Source: van Antwerpen 2011, Eqs. 3.6, 5.1 and Sec. 5.3; Veach 1997, Sec. 9.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weighing {
    /// In proportion to the density.
    Balance,
    /// In proportion to its square.
    Square,
    /// In proportion to this power of it.
    Power(f64),
    /// All to the technique with the largest density; ties go to the one with the shorter eye subpath, as
    /// with [`Heuristic::Maximum`].
    Maximum,
}

/// Densities count as equal up to this factor.
const TIE: f64 = 1.001;

impl Weighing {
    /// The weighing of a heuristic.
    ///
    /// - `power`: exponent β of the power heuristic, positive.
    pub fn new(heuristic: Heuristic, power: f64) -> Self {
        match heuristic {
            Heuristic::Balance => Self::Balance,
            Heuristic::Maximum => Self::Maximum,
            Heuristic::Power if power == 1.0 => Self::Balance,
            Heuristic::Power if power == 2.0 => Self::Square,
            Heuristic::Power => Self::Power(power),
        }
    }

    /// A ratio of densities as it counts.
    #[inline]
    pub fn raise(self, ratio: f64) -> f64 {
        match self {
            Self::Balance | Self::Maximum => ratio,
            Self::Square => ratio * ratio,
            Self::Power(power) => ratio.powf(power),
        }
    }

    /// Two sets of raised ratios together.
    #[inline]
    pub fn join(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Maximum => a.max(b),
            _ => a + b,
        }
    }

    /// Weight of a technique.
    ///
    /// - `shorter`, `longer`: the raised densities, over its own, of all techniques with shorter and with
    ///   longer eye subpaths, joined.
    #[inline]
    pub fn weight(self, shorter: f64, longer: f64) -> f64 {
        match self {
            Self::Maximum => f64::from(u8::from(shorter * TIE < 1.0 && longer <= TIE)),
            _ => 1.0 / (1.0 + shorter + longer),
        }
    }
}

/// What a vertex of a subpath knows of the techniques with shorter subpaths of its side.
///
/// With `p` the density per area with which this subpath has made the vertex, and `D` the raised densities
/// of all techniques that end this subpath before it, over that of the one that ends it here and times the
/// density of the other side, `D = base + slope · q`. The density `q`, per solid angle, is that with which
/// the material there sends the other side's subpath back to the vertex before; it is known once the
/// direction to go on is.
///
/// Source: van Antwerpen 2011, Sec. 5.3.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Backlog {
    /// Of the technique that ends the subpath one vertex before.
    pub base: f64,
    /// Of those that end it earlier.
    pub slope: f64,
}

/// How a subpath leaves a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Density per solid angle of the direction; the probability of a Dirac event.
    pub density: f64,
    /// Density `q` of [`Backlog`]; that of a Dirac event is given as the ratio to `density` demands.
    pub backward: f64,
    /// Size of the cosine between the direction and the geometric normal; one where there is no surface.
    pub cos: f64,
    /// Whether the event is a Dirac: no connection can make it.
    pub is_dirac: bool,
}

impl Backlog {
    /// `D`, where the subpath is connected.
    #[inline]
    pub fn at_connection(self, weighing: Weighing, backward: f64) -> f64 {
        weighing.join(self.base, self.slope * weighing.raise(backward))
    }

    /// The backlog of the next vertex.
    ///
    /// - `solid_angle_per_area`: at this vertex, for the next; one for a vertex at infinity.
    /// - `distance_squared`: of the edge between in m²; one for a vertex at infinity.
    #[inline]
    pub fn after(
        self,
        weighing: Weighing,
        departure: &Departure,
        solid_angle_per_area: f64,
        distance_squared: f64,
    ) -> Self {
        let made = departure.density * solid_angle_per_area;
        let all = if departure.is_dirac {
            self.slope * weighing.raise(departure.backward)
        } else {
            self.at_connection(weighing, departure.backward)
        };
        let back = departure.cos / (distance_squared * made);
        Self {
            base: if departure.is_dirac {
                0.0
            } else {
                weighing.raise(1.0 / made)
            },
            slope: weighing.raise(back) * all,
        }
    }
}
