//! Diffuse reflection at four surfaces at once.

use std::f32::consts::FRAC_1_PI;

use crate::math::lanes::{self, LaneMask, Lanes, Vec3Lanes};

/// [`Diffuse`](super::Diffuse) in each lane, on one or on both sides, as seen from directions.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseLanes {
    /// Shares of light reflected.
    reflectance: Vec3Lanes,
    /// Lanes that see a side that reflects.
    is_lit: LaneMask,
    /// Factors on the normal's part of a direction, as in [`TwoSided`](super::TwoSided).
    turn: Lanes,
}

impl DiffuseLanes {
    /// The materials.
    ///
    /// - `cos_in`: cosines of the angles between the known directions and the shading normals.
    #[inline(always)]
    pub fn new(reflectance: Vec3Lanes, is_two_sided: LaneMask, cos_in: Lanes) -> Self {
        let is_behind = is_two_sided & !cos_in.cmpgt(Lanes::ZERO);
        let turn = Lanes::select(is_behind, Lanes::NEG_ONE, Lanes::ONE);
        Self {
            reflectance,
            is_lit: !(cos_in * turn).cmple(Lanes::ZERO),
            turn,
        }
    }

    /// Shares of light reflected: what each sample weighs.
    #[inline(always)]
    pub fn reflectance(&self) -> Vec3Lanes {
        self.reflectance
    }

    /// Values times the cosine, and densities in 1/sr; the mask has the lanes whose value is not black.
    ///
    /// - `cos_out`: cosines of the angles between the directions asked about and the normals.
    #[inline(always)]
    pub fn eval_with_density(&self, cos_out: Lanes) -> (Vec3Lanes, Lanes, LaneMask) {
        let cos_out = cos_out * self.turn;
        let value = self.reflectance * (FRAC_1_PI * cos_out);
        let is_bright = self.is_lit & !cos_out.cmple(Lanes::ZERO) & !is_black(value);
        (value, lanes::cosine_hemisphere_density(cos_out), is_bright)
    }

    /// Directions in the shading frames, and their densities in 1/sr; the mask has the lanes that
    /// scatter anything. What a sample weighs is the reflectance.
    ///
    /// - `u`: uniform in the unit square.
    #[inline(always)]
    pub fn sample(&self, u: [Lanes; 2]) -> (Vec3Lanes, Lanes, LaneMask) {
        let mut direction = lanes::cosine_hemisphere(u);
        let density = lanes::cosine_hemisphere_density(direction.z);
        direction.z *= self.turn;
        (
            direction,
            density,
            self.is_lit & !is_black(self.reflectance),
        )
    }
}

#[inline(always)]
fn is_black(colour: Vec3Lanes) -> LaneMask {
    let zero = Lanes::ZERO;
    colour.x.cmpeq(zero) & colour.y.cmpeq(zero) & colour.z.cmpeq(zero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, BsdfModel, Diffuse, Transport, TwoSided};
    use crate::math::lanes::{LANES, each, gather};
    use crate::math::{Local, Rgb, Vec2, Vec3, warp};
    use crate::shape::{ShapeModel, SurfacePoint, TriangleMesh, primitives};

    fn somewhere() -> SurfacePoint {
        TriangleMesh::from(primitives::rectangle())
            .sample_area(Vec2::splat(0.3))
            .0
    }

    /// Directions on both sides, and one in the plane.
    fn directions() -> [Vec3; 5] {
        [0.1, 0.4, 0.6, 0.9, 0.5].map(|y| warp::uniform_sphere(Vec2::new(0.3, y)))
    }

    #[test]
    fn four_surfaces_scatter_as_they_do_alone() {
        let colours = [Rgb::new(0.9, 0.5, 0.1), Rgb::new(0.0, 0.3, 0.0), Rgb::BLACK];
        let one_sided = colours.map(|colour| Bsdf::from(Diffuse::new(colour)));
        let two_sided = colours.map(|colour| TwoSided::new(Diffuse::new(colour), None).unwrap());
        let bsdfs: Vec<Bsdf> = one_sided
            .into_iter()
            .chain(two_sided.map(Bsdf::from))
            .collect();
        let at = somewhere();
        for (index, wi) in directions().into_iter().cycle().take(30).enumerate() {
            let four = each(|lane| &bsdfs[(index + lane) % bsdfs.len()]);
            let found = four.map(|bsdf| bsdf.sole_diffuse().expect("all are diffuse"));
            let lanes = DiffuseLanes::new(
                Vec3Lanes::gather(|lane| found[lane].reflectance(|| four[lane], || at.uv).0),
                lanes::mask(|lane| found[lane].is_two_sided),
                gather(|_| wi.z),
            );
            let u = Vec2::new(0.7, 0.2 + 0.02 * index as f32);
            let (direction, density, scatters) = lanes.sample([u.x, u.y].map(Lanes::splat));
            for lane in 0..LANES {
                let alone = four[lane].sample(Local(wi), &at, Transport::Radiance, 0.0, u);
                let alone = alone.filter(|sample| !sample.weight.is_black());
                assert_eq!(
                    scatters.test(lane),
                    alone.is_some(),
                    "{wi}, {:?}",
                    four[lane]
                );
                let Some(alone) = alone else { continue };
                assert_eq!(direction.vectors()[lane], alone.direction.0);
                assert_eq!(density[lane], alone.density);
                assert_eq!(lanes.reflectance().vectors()[lane], alone.weight.0);
            }
            for wo in directions() {
                let (value, density, is_bright) = lanes.eval_with_density(Lanes::splat(wo.z));
                for lane in 0..LANES {
                    let (wi, wo) = (Local(wi), Local(wo));
                    let alone = four[lane].eval_with_density(wi, wo, &at, Transport::Radiance);
                    assert_eq!(is_bright.test(lane), !alone.0.is_black());
                    if is_bright.test(lane) {
                        assert_eq!(value.vectors()[lane], alone.0.0);
                        assert_eq!(density[lane], alone.1.0);
                    }
                }
            }
        }
    }
}
