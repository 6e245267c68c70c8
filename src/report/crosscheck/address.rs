//! Which ray of a check is meant, and how rays are written.

use std::fmt;

use crate::accel::Ray;
use crate::math::Vec3;

/// What a ray is aimed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the camera; without one, from around the geometry.
    Primary,
    /// Leaves a point of a surface, off it by as much as renders keep off.
    Bounce,
    /// A piece of a line between two such points.
    Shadow,
    /// Nearly along a surface.
    Grazing,
    /// At a point of an edge, from anywhere.
    Edge,
    /// At a corner, from anywhere.
    Vertex,
    /// At a point of a surface, from 10² to 10⁵ times the size of the geometry away.
    Far,
    /// Along an axis through a point of a surface.
    Axis,
    /// Of length zero, without a direction, with tiny components, from right on a surface or a corner,
    /// within a surface, with an interval that ends where it begins or before.
    Degenerate,
}

/// Which ray of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayAddress {
    /// Its number among those of its kind.
    pub index: u32,
    /// Its kind.
    pub kind: Kind,
}

impl Kind {
    /// All kinds, in the order of tables.
    pub const ALL: [Self; 9] = [
        Self::Primary,
        Self::Bounce,
        Self::Shadow,
        Self::Grazing,
        Self::Edge,
        Self::Vertex,
        Self::Far,
        Self::Axis,
        Self::Degenerate,
    ];

    /// Its name in tables and addresses.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Shadow => "shadow",
            Self::Grazing => "grazing",
            Self::Edge => "edge",
            Self::Vertex => "vertex",
            Self::Far => "far",
            Self::Axis => "axis",
            Self::Degenerate => "degenerate",
        }
    }
}

impl RayAddress {
    /// The address of a ray of a check, counted over all kinds.
    pub fn of(number: u32) -> Self {
        let kinds = Kind::ALL.len() as u32;
        Self {
            index: number / kinds,
            kind: Kind::ALL[(number % kinds) as usize],
        }
    }

    /// Reads `INDEX/KIND`.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let names = Kind::ALL.map(Kind::name);
        let expected = "expected INDEX/KIND, such as 1042/edge";
        let (index, kind) = text.split_once('/').ok_or(expected)?;
        let index = index.trim().parse().map_err(|_| expected)?;
        let found = Kind::ALL.into_iter().find(|k| k.name() == kind.trim());
        let kind = found.ok_or_else(|| {
            let hint = names
                .into_iter()
                .filter(|name| strsim::damerau_levenshtein(name, kind.trim()) <= 2)
                .map(|name| format!(" (did you mean \"{name}\"?)"))
                .next();
            let kinds = names.join(", ");
            let hint = hint.unwrap_or_default();
            format!("no kind \"{kind}\"{hint}; there are {kinds}")
        })?;
        Ok(Self { index, kind })
    }
}

impl fmt::Display for RayAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.kind.name())
    }
}

/// Reads a ray from eight numbers with commas between: origin, direction, nearest and farthest distance.
///
/// # Errors
/// What is wrong with it, in words.
pub fn parse_ray(text: &str) -> Result<Ray, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[ox, oy, oz, dx, dy, dz, near, far]) => {
            let ray = Ray::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
            Ok(ray.between(near, far))
        }
        _ => Err("expected eight numbers: ox,oy,oz,dx,dy,dz,near,far".to_owned()),
    }
}

/// A ray as [`parse_ray`] reads it: the shortest decimal numbers that give the same floats.
pub fn ray_text(ray: &Ray) -> String {
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin().to_array(), ray.direction().to_array());
    let numbers = [ox, oy, oz, dx, dy, dz, ray.near(), ray.far()];
    numbers.map(|number| format!("{number:?}")).join(",")
}
