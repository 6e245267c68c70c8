//! Normals that lean, and the directions that are seen from them.

use super::Transport;
use crate::math::{Frame, Local, Vec3};

/// How the normals of a material behave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Leaning {
    /// Slanted light is darkened as facets of the normal's slope would shadow it, so that there is no
    /// hard edge where the normal turns away from light.
    pub shadowing: bool,
    /// A normal that leans away from the eye leans as far to the other side instead; otherwise the eye
    /// sees black there.
    pub turning: bool,
}

/// Which way a normal leans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// As it is given.
    Given,
    /// To the other side.
    Turned,
}

/// The normal at one point.
#[derive(Clone, Copy)]
pub(super) struct Tilt {
    pub(super) normal: Vec3,
    pub(super) leaning: Leaning,
}

/// The bump at one point.
pub(super) struct Bump {
    /// The frame that the material works in, written in the shading frame.
    frame: Frame,
    /// Squared roughness of the surface of which this bump could be a facet.
    alpha_squared: f32,
}

/// A direction in the shading frame and in that of a bump.
#[derive(Clone, Copy)]
pub(super) struct Direction {
    pub(super) plain: Local,
    pub(super) bent: Local,
}

impl Direction {
    /// Whether both normals see it from one side.
    #[inline]
    pub(super) fn is_clear(self) -> bool {
        self.plain.same_side(self.bent)
    }
}

/// The direction to the eye.
#[inline]
pub(super) fn eye(wi: Local, wo: Local, transport: Transport) -> Local {
    match transport {
        Transport::Radiance => wi,
        Transport::Importance => wo,
    }
}

impl Tilt {
    #[inline]
    fn normal(self, way: Way) -> Vec3 {
        match way {
            Way::Given => self.normal,
            Way::Turned => Vec3::new(-self.normal.x, -self.normal.y, self.normal.z),
        }
    }

    /// Whether a direction lies on one side of this normal and of the shading normal.
    #[inline]
    fn sees(self, way: Way, direction: Local) -> bool {
        direction.0.z * direction.0.dot(self.normal(way)) > 0.0
    }

    /// Which way the normal leans for an eye.
    #[inline]
    pub(super) fn way(self, eye: Local) -> Way {
        let turns = self.leaning.turning && !self.sees(Way::Given, eye);
        if turns && self.sees(Way::Turned, eye) {
            Way::Turned
        } else {
            Way::Given
        }
    }

    /// Share of the samples from `wi` that are made around the turned normal.
    ///
    /// A light does not know where the eye is. Directions to which the normal turns are the fewer the
    /// less it leans; half the sine of the tilt is near to what makes the least noise for diffuse ones.
    #[inline]
    pub(super) fn turned_share(self, wi: Local, transport: Transport) -> f32 {
        if !self.leaning.turning {
            return 0.0;
        }
        match transport {
            Transport::Radiance => f32::from(self.way(wi) == Way::Turned),
            Transport::Importance => {
                match [Way::Given, Way::Turned].map(|way| self.sees(way, wi)) {
                    [true, true] => (0.5 - 0.5 * self.normal.z).max(0.0).sqrt().min(0.5),
                    [false, true] => 1.0,
                    [_, false] => 0.0,
                }
            }
        }
    }

    /// Share of the samples from `wi` that are made around one normal.
    #[inline]
    pub(super) fn share(self, way: Way, wi: Local, transport: Transport) -> f32 {
        let turned = self.turned_share(wi, transport);
        match way {
            Way::Given => 1.0 - turned,
            Way::Turned => turned,
        }
    }

    /// The frame of the leaning normal: its tangent is as near to the surface's as it can be.
    #[inline]
    pub(super) fn bump(self, way: Way) -> Bump {
        let normal = self.normal(way);
        let alpha_squared = if self.leaning.shadowing {
            let slope_squared = (1.0 / (normal.z * normal.z) - 1.0).max(0.0);
            (0.125 * slope_squared).min(1.0)
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
    pub(super) fn bend(&self, plain: Local) -> Direction {
        Direction {
            plain,
            bent: self.frame.to_local(plain.0),
        }
    }

    #[inline]
    pub(super) fn unbend(&self, bent: Local) -> Direction {
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
    pub(super) fn factor(&self, wi: Direction, wo: Direction, transport: Transport) -> f32 {
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
