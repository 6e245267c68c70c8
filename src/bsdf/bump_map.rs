//! A material on bumps that a texture describes.

use std::sync::Arc;

use super::{
    Bsdf, BsdfModel, BsdfSample, Component, Conductor, Dielectric, Diffuse, DiracEvent, Lobe,
    LobeSet, Mask, MicrofacetKind, Plastic, RoughConductor, RoughDielectric, Roughness, Transport,
    TwoSided,
};
use crate::image::{self, Texels};
use crate::math::{Frame, Local, Mat3, Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::SurfacePoint;
use crate::texture::{self, Filter, Texture, TextureModel, Wrap};

/// A material whose normal leans as if a texture raised the surface; the surface stays where it is.
///
/// The material works in the frame of the leaning normal, its cosine included. A direction that lies
/// on different sides of the leaning and of the shading normal is black, known or sampled. Holes
/// have no normal: a [`Lobe::Null`] goes straight on whatever the bumps are.
///
/// With [`Transport::Importance`] values belong to the shading normal all the same, as the module's
/// contract has it: `docs/math.md`, "Bumps".
///
/// Components: those of the material.
#[derive(Clone, Debug)]
pub struct BumpMap {
    height: Texture,
    /// Metres for each unit of `height`.
    scale: f32,
    shadowing: bool,
    nested: Box<Bsdf>,
}

/// The bump at one point.
struct Bump {
    /// The frame that the material works in, written in the shading frame.
    frame: Frame,
    /// Squared roughness of the surface of which this bump could be a facet.
    alpha_squared: f32,
}

/// A direction in the shading frame and in that of a bump.
#[derive(Clone, Copy)]
struct Direction {
    plain: Local,
    bent: Local,
}

impl Direction {
    /// Whether both normals see it from one side.
    #[inline]
    fn is_clear(self) -> bool {
        self.plain.same_side(self.bent)
    }
}

impl BumpMap {
    /// Makes the material.
    ///
    /// - `height`: how far the surface is raised along its normal.
    /// - `scale`: metres for each unit of `height`.
    /// - `shadowing`: darken slanted light as facets of the bump's slope would shadow it, so that
    ///   there is no hard edge where the bump turns away from light.
    /// - `nested`: the material of the bumps.
    pub fn new(
        height: impl Into<Texture>,
        scale: f32,
        shadowing: bool,
        nested: impl Into<Bsdf>,
    ) -> Self {
        Self {
            height: height.into(),
            scale,
            shadowing,
            nested: Box::new(nested.into()),
        }
    }

    /// The leaning frame: its normal is `n − ∇h`, its tangent as near to the surface's as it can be.
    ///
    /// Source: Blinn 1978.
    #[inline]
    fn bump(&self, at: &SurfacePoint) -> Bump {
        let by_uv = self.height.gradient(at.uv) * self.scale;
        let slope = at.gradient(by_uv).unwrap_or(Vec2::ZERO);
        let normal = (-slope).extend(1.0).normalize_or(Vec3::Z);
        let alpha_squared = if self.shadowing {
            (0.125 * slope.length_squared()).min(1.0)
        } else {
            0.0
        };
        Bump {
            frame: Frame::with_tangent(normal, Vec3::X),
            alpha_squared,
        }
    }
}

impl Bump {
    #[inline]
    fn bend(&self, plain: Local) -> Direction {
        Direction {
            plain,
            bent: self.frame.to_local(plain.0),
        }
    }

    #[inline]
    fn unbend(&self, bent: Local) -> Direction {
        Direction {
            plain: Local(self.frame.to_world(bent)),
            bent,
        }
    }

    /// Share of the light from a direction that other facets let through.
    ///
    /// Source: Conty Estevez, Lecocq & Stein 2019.
    #[inline]
    fn unshadowed(&self, light: Local) -> f32 {
        if self.alpha_squared == 0.0 {
            return 1.0;
        }
        let cos = light.abs_cos();
        2.0 * cos / (cos + (cos * cos + self.alpha_squared * light.sin_squared()).sqrt())
    }

    /// What the material's values are multiplied by; zero where a direction is black.
    #[inline]
    fn factor(&self, wi: Direction, wo: Direction, transport: Transport) -> f32 {
        if !(wi.is_clear() && wo.is_clear()) {
            return 0.0;
        }
        match transport {
            Transport::Radiance => self.unshadowed(wo.plain),
            Transport::Importance => {
                let plain = wo.plain.abs_cos() / wi.plain.abs_cos();
                let bent = wi.bent.abs_cos() / wo.bent.abs_cos();
                self.unshadowed(wi.plain) * plain * bent
            }
        }
    }
}

impl BsdfModel for BumpMap {
    fn examples() -> Vec<Self> {
        let bumps = example_heights;
        let rough = |along, across| Roughness::new(MicrofacetKind::Ggx, along, across);
        let metal = || RoughConductor::new(rough(0.15, 0.4), None, 0.9);
        let glass = Dielectric::examples().into_iter().take(1);
        let coat = Plastic::examples().into_iter().take(1);
        let rough_glass = RoughDielectric::examples().into_iter().take(1);
        let two_sided = TwoSided::new(metal(), Some(Diffuse::new(0.6).into()));
        let nested = [
            Bsdf::from(Conductor::new(None, 0.9)),
            metal().into(),
            Mask::new(0.6, Diffuse::new(0.7)).into(),
        ];
        let nested = nested
            .into_iter()
            .chain(glass.map(Bsdf::from))
            .chain(coat.map(Bsdf::from))
            .chain(rough_glass.map(Bsdf::from))
            .chain(two_sided.ok().map(Bsdf::from));
        let diffuse = [0.6, 1.5].map(|scale| Self::new(bumps(), scale, true, Diffuse::new(0.8)));
        let flat = Self::new(0.5, 1.0, true, Diffuse::new(0.8));
        let nested = nested
            .enumerate()
            .map(|(number, nested)| Self::new(bumps(), 0.3, number % 2 == 0, nested));
        diffuse.into_iter().chain(nested).chain([flat]).collect()
    }

    fn lobes(&self) -> LobeSet {
        self.nested.lobes()
    }

    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let bump = self.bump(at);
        let wi = bump.bend(wi);
        let mut sample = self.nested.sample(wi.bent, at, transport, u_lobe, u)?;
        if sample.lobe == Lobe::Null {
            sample.direction = wi.plain.straight_on();
            return Some(sample);
        }
        let wo = bump.unbend(sample.direction);
        let factor = bump.factor(wi, wo, transport);
        sample.direction = wo.plain;
        sample.value *= factor;
        sample.weight *= factor;
        (factor > 0.0).then_some(sample)
    }

    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        self.eval_with_density(wi, wo, at, transport).0
    }

    fn density(&self, wi: Local, wo: Local, at: &SurfacePoint) -> SolidAngleDensity {
        let bump = self.bump(at);
        let (wi, wo) = (bump.bend(wi), bump.bend(wo));
        if wi.is_clear() && wo.is_clear() {
            self.nested.density(wi.bent, wo.bent, at)
        } else {
            SolidAngleDensity::ZERO
        }
    }

    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        let bump = self.bump(at);
        let (wi, wo) = (bump.bend(wi), bump.bend(wo));
        let factor = bump.factor(wi, wo, transport);
        if factor == 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let nested = self
            .nested
            .eval_with_density(wi.bent, wo.bent, at, transport);
        (nested.0 * factor, nested.1)
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let bump = self.bump(at);
        let wi = bump.bend(wi);
        let event = self.nested.follow(wi.bent, at, transport, component)?;
        if event.lobe == Lobe::Null {
            let direction = wi.plain.straight_on();
            return Some(DiracEvent { direction, ..event });
        }
        let wo = bump.unbend(event.direction);
        let factor = bump.factor(wi, wo, transport);
        (factor > 0.0).then(|| DiracEvent {
            direction: wo.plain,
            coefficient: event.coefficient * factor,
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        self.nested.component_count()
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.nested.albedo(at)
    }
}

/// A few uneven heights.
fn example_heights() -> Texture {
    let heights = vec![0.1, 0.25, 0.4, 0.35, 0.8, 0.2];
    let image = image::Bitmap::new(3, 2, 1, Texels::Float(heights)).expect("3 × 2 heights");
    let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
    texture::Bitmap::new(Arc::new(image), filter, wrap, Mat3::IDENTITY).into()
}
