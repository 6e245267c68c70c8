//! Tests of the binding through its safe face, against whichever Embree the build found.

mod analytic;
mod curves;
mod packets;
mod raw;
mod referee;
mod scenes;
mod triangles;

use embree4_sys::{CommittedScene, Device, Error, Hit, Ray, SceneBuilder};

const IDENTITY: [[f32; 4]; 3] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

/// A ray from 0 to infinity.
fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
    Ray {
        origin,
        direction,
        near: 0.0,
        far: f32::INFINITY,
    }
}

/// Builds a scene of what `fill` adds.
fn build(
    fill: impl FnOnce(&mut SceneBuilder) -> Result<(), Error>,
) -> Result<CommittedScene, Error> {
    let mut builder = SceneBuilder::new(&Device::new("threads=1")?)?;
    fill(&mut builder)?;
    builder.commit()
}

/// Asserts that a number is another one but for rounding: Embree divides by approximate reciprocals, the
/// last bits of which depend on the processor.
#[track_caller]
fn assert_close(found: f32, expected: f32) {
    let error = (found - expected).abs();
    assert!(error <= 1e-6 * expected.abs(), "{found}, not {expected}");
}

/// Asserts that a hit is as expected, but for rounding.
#[track_caller]
fn assert_hit(found: Option<Hit>, expected: Hit) {
    let Some(found) = found else {
        panic!("nothing is hit, not {expected:?}")
    };
    assert_close(found.distance, expected.distance);
    assert_close(found.u, expected.u);
    assert_close(found.v, expected.v);
    let Hit { distance, u, v, .. } = found;
    let rest = Hit {
        distance,
        u,
        v,
        ..expected
    };
    assert_eq!(found, rest);
}

/// Uniform numbers from a fixed seed.
struct Numbers(u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// In [-1, 1).
    fn signed(&mut self) -> f32 {
        let fraction = (self.bits() >> 40) as f32 / (1u64 << 24) as f32;
        2.0 * fraction - 1.0
    }

    /// In the cube [-1, 1)³.
    fn point(&mut self) -> [f32; 3] {
        [self.signed(), self.signed(), self.signed()]
    }
}
