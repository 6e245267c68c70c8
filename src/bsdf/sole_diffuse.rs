//! What is diffuse, and how to tell at once.

use super::diffuse::lambert;
use super::{Bsdf, Diffuse};
use crate::math::{Rgb, Vec2};

/// All there is to know about a material that is diffuse, on one side or alike on both: what surfaces keep
/// at hand, so that nothing is looked up where most of them scatter.
#[derive(Clone, Copy, Debug)]
pub struct SoleDiffuse {
    /// Whether the back scatters as the front does.
    pub is_two_sided: bool,
    /// The share of light reflected, where it is the same everywhere.
    reflectance: Option<Rgb>,
}

impl Bsdf {
    /// The material, if it is diffuse on one side or alike on both.
    pub fn sole_diffuse(&self) -> Option<SoleDiffuse> {
        let is_two_sided = matches!(self, Self::TwoSided(_));
        self.diffuse_layer().map(|diffuse| SoleDiffuse {
            is_two_sided,
            reflectance: diffuse.sole_reflectance(),
        })
    }

    /// The one diffuse material of this one's sides.
    #[inline]
    fn diffuse_layer(&self) -> Option<&Diffuse> {
        match self {
            Self::Diffuse(diffuse) => Some(diffuse),
            Self::TwoSided(sides) => match sides.sole() {
                Some(Self::Diffuse(diffuse)) => Some(diffuse),
                _ => None,
            },
            _ => None,
        }
    }
}

impl SoleDiffuse {
    /// The share of light reflected.
    ///
    /// - `bsdf`: looks up the material that this is.
    /// - `uv`: works out surface coordinates, where the texture asks for them.
    #[inline(always)]
    pub fn reflectance<'b>(
        &self,
        bsdf: impl FnOnce() -> &'b Bsdf,
        uv: impl FnOnce() -> Vec2,
    ) -> Rgb {
        self.reflectance
            .unwrap_or_else(|| varying_reflectance(bsdf(), uv()))
    }

    /// [`BsdfModel::eval`](super::BsdfModel::eval) by the signed cosines of the two directions.
    ///
    /// - `bsdf`, `uv`: as [`SoleDiffuse::reflectance`] has them.
    #[inline(always)]
    pub fn eval<'b>(
        &self,
        (cos_in, cos_out): (f32, f32),
        bsdf: impl FnOnce() -> &'b Bsdf,
        uv: Vec2,
    ) -> Rgb {
        let is_behind = self.is_two_sided && cos_in <= 0.0;
        let turn = if is_behind { -1.0 } else { 1.0 };
        let reflectance = || self.reflectance(bsdf, || uv);
        lambert(reflectance, cos_in * turn, cos_out * turn)
    }
}

#[inline(never)]
fn varying_reflectance(bsdf: &Bsdf, uv: Vec2) -> Rgb {
    let diffuse = bsdf.diffuse_layer();
    diffuse.map_or(Rgb::BLACK, |diffuse| diffuse.reflectance(uv))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{BsdfModel, Conductor, Transport, TwoSided};
    use crate::math::{Local, Mat3, warp};
    use crate::shape::{ShapeModel, TriangleMesh, primitives};
    use crate::texture::Checkerboard;

    fn grey() -> Diffuse {
        Diffuse::new(0.5)
    }

    fn both(front: impl Into<Bsdf>, back: Option<Bsdf>) -> Bsdf {
        TwoSided::new(front, back).unwrap().into()
    }

    #[test]
    fn values_are_those_of_the_material() {
        let mesh = TriangleMesh::from(primitives::rectangle());
        let (at, _) = mesh.sample_area(Vec2::new(0.3, 0.9));
        let squares = |colours| Checkerboard::new(colours, Mat3::from_scale(Vec2::splat(5.0)));
        let board = || Diffuse::new(squares([Rgb::new(0.8, 0.3, 0.1), Rgb::grey(0.2)]));
        let all = [
            Bsdf::from(grey()),
            board().into(),
            both(grey(), None),
            both(board(), None),
        ];
        let places = || (0..12).map(|i| Vec2::new(0.3, (i as f32 + 0.5) / 12.0));
        for bsdf in &all {
            let sole = bsdf.sole_diffuse().unwrap();
            let mut lit = 0;
            for wi in places().map(warp::uniform_sphere).map(Local) {
                for wo in places().map(warp::uniform_sphere).map(Local) {
                    let value = sole.eval((wi.cos(), wo.cos()), || bsdf, at.uv);
                    assert_eq!(value, bsdf.eval(wi, wo, &at, Transport::Radiance));
                    lit += usize::from(!value.is_black());
                }
            }
            assert_eq!(lit, if sole.is_two_sided { 72 } else { 36 });
        }
    }

    #[test]
    fn other_materials_are_not_taken() {
        let others = Bsdf::examples();
        let others = others
            .iter()
            .filter(|bsdf| !["Diffuse", "TwoSided"].contains(&bsdf.name()));
        assert!(others.clone().count() > 30);
        for bsdf in others {
            assert!(bsdf.sole_diffuse().is_none(), "{bsdf:?}");
        }
        let metal = || Bsdf::from(Conductor::new(None, 0.9));
        for bsdf in [
            both(grey(), Some(grey().into())),
            both(grey(), Some(metal())),
            both(metal(), Some(grey().into())),
            both(metal(), None),
        ] {
            assert!(bsdf.sole_diffuse().is_none(), "{bsdf:?}");
        }
    }
}
