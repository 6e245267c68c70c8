//! Where and from where materials are looked at.

use lumiflow::bsdf::{Bsdf, BsdfModel, Component, Transport};
use lumiflow::math::{Frame, Local, Vec2, Vec3};
use lumiflow::random::{Purpose, Stream};
use lumiflow::shape::{Derivatives, SurfacePoint};

/// Both transports.
pub(crate) const TRANSPORTS: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// A point of a horizontal surface, whose coordinates are skew.
pub(crate) fn surface_point() -> SurfacePoint {
    SurfacePoint {
        position: Vec3::ZERO,
        geometric_normal: Vec3::Z,
        shading_normal: Vec3::Z,
        derivatives: Derivatives::new(Vec3::Z, Vec3::new(1.5, 0.0, 0.0), Vec3::new(0.4, 0.8, 0.0)),
        uv: Vec2::new(0.3, 0.7),
        error: 1e-6,
    }
}

/// A direction by its angle to the normal and its azimuth, in degrees.
pub(crate) fn direction(angle: f64, azimuth: f64) -> Local {
    let (sin, cos) = angle.to_radians().sin_cos();
    let (y, x) = azimuth.to_radians().sin_cos();
    Local::new((sin * x) as f32, (sin * y) as f32, cos as f32)
}

/// Directions to look from: along the normal, slanted, grazing; from above and from below.
pub(crate) fn views() -> Vec<Local> {
    vec![
        Local::NORMAL,
        direction(30.0, 20.0),
        direction(75.0, 110.0),
        direction(88.0, 250.0),
        Local::NORMAL.flipped(),
        direction(150.0, 300.0),
        direction(105.0, 45.0),
        direction(92.0, 160.0),
    ]
}

/// One material seen from one direction, with a name for messages and random numbers of its own.
pub(crate) struct Case {
    pub(crate) bsdf: Bsdf,
    pub(crate) wi: Local,
    pub(crate) transport: Transport,
    pub(crate) name: String,
    pub(crate) stream: Stream,
}

/// Every example of every material, from every view, for both transports.
///
/// - `seed`: of the random numbers; each test has its own.
pub(crate) fn cases(seed: u64) -> Vec<Case> {
    let mut cases = Vec::new();
    for (number, bsdf) in Bsdf::examples().into_iter().enumerate() {
        for wi in views() {
            for transport in TRANSPORTS {
                let name = format!("{} (example {number}), {wi:?}, {transport:?}", bsdf.name());
                let stream = Stream::new(seed, Purpose::Check, cases.len() as u32, 0);
                let bsdf = bsdf.clone();
                cases.push(Case {
                    bsdf,
                    wi,
                    transport,
                    name,
                    stream,
                });
            }
        }
    }
    cases
}

/// The numbers that a material is sampled with: one for the lobe, two for the direction.
pub(crate) fn numbers(stream: &mut Stream) -> (f32, Vec2) {
    let u_lobe = stream.next_f32();
    (u_lobe, Vec2::new(stream.next_f32(), stream.next_f32()))
}

/// How much wider a Dirac component makes a narrow cone around `wi`: `dσ(wo)/dσ(wi)`, by
/// differences; `None` where it ends.
pub(crate) fn spread(
    bsdf: &dyn BsdfModel,
    wi: Local,
    transport: Transport,
    component: Component,
) -> Option<f32> {
    const STEP: f32 = 1e-3;
    let at = surface_point();
    let change = |axis: Vec3| {
        let end = |step: f32| {
            let wi = Local((wi.0 + axis * step).normalize());
            let event = bsdf.follow(wi, &at, transport, component)?;
            Some(event.direction.0)
        };
        Some((end(STEP)? - end(-STEP)?) / (2.0 * STEP))
    };
    let frame = Frame::around(wi.0);
    let (along, across) = (change(frame.tangent)?, change(frame.bitangent)?);
    Some(along.cross(across).length())
}
