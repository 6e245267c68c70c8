//! One technique alone.

use super::subpath::{Lit, Reach};
use super::{Bidirection, Bidirectional, Connection, LightImage};
use crate::math::Vec2;
use crate::path::{PathSpace, PathVertex};
use crate::random::Numbers;
use crate::sensor::CameraRay;

impl Bidirectional {
    /// Traces subpaths as far as one technique needs them, and returns the path that they make; `None` where
    /// they make none.
    ///
    /// Numbers have the same meaning as with [`Bidirectional::trace`], and make the same path with the same weight: but
    /// there is no Russian roulette, whose numbers come last at each vertex, so that the value is that of a
    /// path which nothing could have ended.
    ///
    /// - `sample`: the subpaths, made anew.
    /// - `camera`: the camera sample.
    /// - `technique`: numbers of vertices of the eye's and of the light's side, as in [`Connection`].
    /// - `samplers`: the numbers of the eye and of the light subpath.
    ///
    /// Source: Hachisuka et al. 2014.
    pub fn trace_technique<'s>(
        &self,
        space: &PathSpace<'s>,
        sample: &mut Bidirection<'s>,
        camera: (Vec2, &CameraRay),
        image: &LightImage,
        technique: (usize, usize),
        samplers: [&mut impl Numbers; 2],
    ) -> Option<Connection> {
        let whole = Self {
            rr_depth: u32::MAX,
            connection_threshold: 0.0,
            ..*self
        };
        whole.trace_alone(space, sample, camera, image, technique, samplers)
    }

    /// As [`Bidirectional::trace_technique`], without changing how paths are traced.
    fn trace_alone<'s>(
        &self,
        space: &PathSpace<'s>,
        sample: &mut Bidirection<'s>,
        (raster, camera_ray): (Vec2, &CameraRay),
        image: &LightImage,
        (eye, light): (usize, usize),
        [eye_numbers, light_numbers]: [&mut impl Numbers; 2],
    ) -> Option<Connection> {
        sample.lens = PathVertex::sensor(camera_ray.origin);
        sample.eye.clear();
        if eye == 0 && !self.techniques.light_image {
            return None;
        }
        if eye > 0 {
            let lit = if light == 1 { Lit::Last } else { Lit::Nowhere };
            let vertices = eye as u32;
            let guide = (image, Reach { vertices, lit });
            let subpath = &mut sample.eye;
            self.trace_eye(space, (raster, camera_ray), guide, eye_numbers, subpath);
        }
        if light == 0 {
            return self.meet_light(space, &sample.eye, eye, raster);
        }
        let vertices = &sample.eye.vertices;
        let is_open = |number: usize| vertices.get(number - 1).is_some_and(|v| v.met.lobes.finite);
        if eye > 0 && !is_open(eye) {
            return None;
        }
        if eye == 0 || light > 1 || !self.techniques.sample_direct {
            self.start_light(space, light as u32, light_numbers, sample);
            if sample.light.vertices.len() + 1 < light {
                return None;
            }
        }
        sample.clear();
        match (eye, light) {
            (0, _) => self.see(space, sample, light, image),
            (_, 1) => self.sample_light(space, sample, eye, raster),
            pair => self.join_pair(space, sample, pair, raster),
        }
        let mut found = None;
        let mut take = |_: &Bidirection<'s>, connection: &Connection| found = Some(*connection);
        self.complete(space, sample, light_numbers, &mut take);
        found
    }
}
