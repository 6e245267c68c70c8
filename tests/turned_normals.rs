//! Normals that turn to the eye: whoever asks, the eye says which way they lean.

use std::sync::Arc;

use lumiflow::bsdf::{
    Bsdf, BsdfModel, BsdfSample, Conductor, Diffuse, Leaning, LobeSet, NormalMap, SampleNumbers,
    Sampled, Spare, Transport,
};
use lumiflow::image::{self, Texels};
use lumiflow::math::{Local, Mat3, Rgb, SolidAngleDensity, Vec2, Vec3};
use lumiflow::random::{Purpose, Stream};
use lumiflow::shape::SurfacePoint;
use lumiflow::texture::{self, Filter, Texture, Wrap};

use crate::scattering::{light_goes_both_ways, mean_weight_p};
use crate::support::effort::seed;
use crate::support::materials::{TRANSPORTS, direction, surface_point};

/// The normal of all tests: it leans by 50°.
fn normal() -> Vec3 {
    direction(50.0, 30.0).0
}

/// The same normal everywhere.
fn everywhere(normal: Vec3) -> Texture {
    let colour = normal * 0.5 + 0.5;
    let image = image::Bitmap::new(1, 1, 3, Texels::Float(colour.to_array().to_vec()));
    let image = Arc::new(image.expect("one pixel"));
    texture::Bitmap::new(image, Filter::Nearest, Wrap::Repeat, Mat3::IDENTITY).into()
}

fn leaning(normal: Vec3, turning: bool, nested: impl Into<Bsdf>) -> NormalMap {
    let leaning = Leaning {
        shadowing: false,
        turning,
    };
    NormalMap::new(everywhere(normal), leaning, nested)
}

fn sees(normal: Vec3, direction: Local) -> bool {
    direction.0.dot(normal) * direction.0.z > 0.0
}

/// Directions around the half of the horizon that the normal turns away from, and others.
fn views() -> Vec<Local> {
    let angles = [5.0, 35.0, 60.0, 75.0, 85.0];
    let azimuths = [30.0, 120.0, 170.0, 210.0, 250.0];
    let views = angles.map(|angle| azimuths.map(|azimuth| direction(angle, azimuth)));
    views.into_iter().flatten().collect()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    /// The known direction says which way the normal leans, be it the eye's or not.
    KnownDirection,
    /// With importance the normal never turns.
    RadianceOnly,
    /// The share of samples that go by the turned normal is left out of the density.
    NoShare,
}

/// A diffuse surface whose normal turns, with a mistake.
struct Mistaken {
    right: NormalMap,
    given: NormalMap,
    turned: NormalMap,
    mistake: Mistake,
}

impl Mistaken {
    fn new(mistake: Mistake) -> Self {
        let (x, y, z) = normal().into();
        Self {
            right: leaning(normal(), true, Diffuse::new(0.8)),
            given: leaning(normal(), false, Diffuse::new(0.8)),
            turned: leaning(Vec3::new(-x, -y, z), false, Diffuse::new(0.8)),
            mistake,
        }
    }

    fn used(&self, wi: Local, transport: Transport) -> &NormalMap {
        match (self.mistake, transport) {
            (Mistake::NoShare, _) | (_, Transport::Radiance) => &self.right,
            (Mistake::RadianceOnly, _) => &self.given,
            (Mistake::KnownDirection, _) if sees(normal(), wi) => &self.given,
            (Mistake::KnownDirection, _) => &self.turned,
        }
    }
}

impl BsdfModel for Mistaken {
    fn examples() -> Vec<Self> {
        Vec::new()
    }

    fn lobes(&self) -> LobeSet {
        self.right.lobes()
    }

    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let mut sample = self
            .used(wi, transport)
            .sample(wi, at, transport, u_lobe, u)?;
        if self.mistake == Mistake::NoShare {
            // Diffuse: the density is the cosine over π, the weight is the rest.
            let density = self.density(wi, sample.direction, at, transport).0;
            sample.weight = sample.value / density;
        }
        Some(sample)
    }

    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        self.used(wi, transport).eval(wi, wo, at, transport)
    }

    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        let used = match self.mistake {
            Mistake::NoShare if sees(normal(), wo) => &self.given,
            Mistake::NoShare => &self.turned,
            _ => self.used(wi, transport),
        };
        used.density(wi, wo, at, transport)
    }

    fn invert(
        &self,
        _wi: Local,
        _sampled: Sampled,
        _at: &SurfacePoint,
        _transport: Transport,
        _spare: Spare,
    ) -> Option<SampleNumbers> {
        None
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.right.albedo(at)
    }
}

/// Views and transports in which light does not go both ways.
fn broken(bsdf: &dyn BsdfModel) -> Vec<(Local, Transport)> {
    let mut stream = Stream::new(seed(121), Purpose::Check, 0, 0);
    let all = views()
        .into_iter()
        .flat_map(|wi| TRANSPORTS.map(|t| (wi, t)));
    all.filter(|(wi, transport)| light_goes_both_ways(bsdf, *wi, *transport, &mut stream).is_err())
        .collect()
}

#[test]
fn every_eye_sees_light() {
    let at = surface_point();
    let bright = leaning(normal(), true, Diffuse::new(1.0));
    let dark = leaning(normal(), false, Diffuse::new(1.0));
    let value = |bsdf: &NormalMap, eye| bsdf.eval(eye, Local::NORMAL, &at, Transport::Radiance).r();
    let mut turned = 0;
    for eye in views() {
        let (bright, dark) = (value(&bright, eye), value(&dark, eye));
        assert!(bright > 0.2, "{eye:?}: {bright}");
        assert_eq!(dark > 0.0, sees(normal(), eye), "{eye:?}");
        turned += u32::from(dark == 0.0);
    }
    assert!(turned > 3, "{turned}");
}

#[test]
fn a_mirror_has_two_ways_for_one_light() {
    let at = surface_point();
    let mirror = leaning(direction(35.0, 30.0).0, true, Conductor::new(None, 1.0));
    let mut stream = Stream::new(seed(122), Purpose::Check, 0, 0);
    let mut ways = [0, 0];
    for _ in 0..1000 {
        let (u_lobe, u) = (stream.next_f32(), Vec2::new(0.5, 0.5));
        let sample = mirror.sample(Local::NORMAL, &at, Transport::Importance, u_lobe, u);
        let sample = sample.expect("eyes on both sides see the light");
        ways[usize::from(sample.component.0)] += 1;
        let back = mirror.follow(sample.direction, &at, Transport::Radiance, sample.component);
        let back = back.expect("the eye sees the light").direction.0;
        assert!(back.distance(Vec3::Z) < 1e-5, "{back}");
    }
    assert!(ways.iter().all(|count| *count > 200), "{ways:?}");
}

#[test]
fn planted_errors_are_found() {
    let right = leaning(normal(), true, Diffuse::new(0.8));
    assert_eq!(broken(&right), []);
    for mistake in [Mistake::KnownDirection, Mistake::RadianceOnly] {
        assert!(broken(&Mistaken::new(mistake)).len() > 2, "{mistake:?}");
    }
    let mut stream = Stream::new(seed(123), Purpose::Check, 0, 0);
    let wi = direction(35.0, 120.0);
    let mut p = |bsdf: &dyn BsdfModel| mean_weight_p(bsdf, wi, Transport::Importance, &mut stream);
    let (right, wrong) = (p(&right), p(&Mistaken::new(Mistake::NoShare)));
    assert!(right > 1e-3 && wrong < 1e-6, "{right} {wrong}");
}
