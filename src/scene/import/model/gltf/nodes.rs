//! What stands where in a glTF file: meshes, lights and cameras.

use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;
use gltf::{Camera, Node};

use super::super::view::view;
use super::super::{Model, Surface};
use super::meshes::carried;
use super::{Asset, Group};
use crate::emitter::{Beam, Directional, Point, Spot};
use crate::math::{Mat3, Mat4, Rgb, Vec2, Vec3};
use crate::scene::BsdfId;
use crate::sensor::{FieldOfViewAxis, Orthographic, Perspective, PerspectiveSettings, SensorError};
use crate::shape::Shape;
use crate::shape::mesh::MeshData;

/// Nodes below each other; more are a circle, or no file of this world.
const DEEPEST: usize = 100;

/// Height of a film in pixels, where a camera says its shape.
const FILM_HEIGHT: f32 = 576.0;

/// From cameras and lamps that look along −z to ours, which look along +z.
const TURNED: Mat4 = Mat4::from_cols_array(&[
    -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
]);

impl Model<'_> {
    /// Adds what a node and those below it hold.
    pub(super) fn gltf_node<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        node: &Node<'g>,
        parent: Mat4,
        depth: usize,
    ) {
        if depth > DEEPEST {
            let message = format!("nodes lie more than {DEEPEST} below each other");
            self.problems.error(&self.line(1), message);
            return;
        }
        let to_world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if node.skin().is_some() {
            let message = format!("node {}: its skin is left out", node.index());
            self.problems.warning(&self.line(1), message);
        }
        if let Some(mesh) = node.mesh() {
            self.gltf_mesh(asset, &mesh, to_world);
        }
        if let Some(camera) = node.camera() {
            self.gltf_camera(&camera, to_world);
        }
        if let Some(light) = node.light() {
            self.gltf_light(&light, to_world);
        }
        for child in node.children() {
            self.gltf_node(asset, &child, to_world, depth + 1);
        }
    }

    fn gltf_mesh<'g>(&mut self, asset: &mut Asset<'g>, mesh: &gltf::Mesh<'g>, to_world: Mat4) {
        let place = self.line(1);
        let is_shared = asset
            .mesh_uses
            .get(&mesh.index())
            .is_some_and(|uses| *uses > 1);
        if !is_shared {
            for primitive in mesh.primitives() {
                if let Some(data) = self.gltf_primitive(asset, mesh.index(), &primitive) {
                    self.gltf_part(asset, data, &primitive, to_world);
                }
            }
            return;
        }
        let known = asset.groups.remove(&mesh.index());
        let group = known.unwrap_or_else(|| self.gltf_group(asset, mesh));
        if let Some(id) = group.id {
            let added = self.builder.add_instance(id, to_world);
            if let Err(error) = added {
                let message = format!("mesh {} is left out: {error}", mesh.index());
                self.problems.warning(&place, message);
            }
        }
        for (data, primitive) in &group.glowing {
            if let Some(primitive) = mesh.primitives().nth(*primitive) {
                self.gltf_part(asset, data.clone(), &primitive, to_world);
            }
        }
        asset.groups.insert(mesh.index(), group);
    }

    /// Reads a mesh that stands in several places: what glows apart, since instances cannot.
    fn gltf_group<'g>(&mut self, asset: &mut Asset<'g>, mesh: &gltf::Mesh<'g>) -> Group {
        let mut members: Vec<(Shape, BsdfId)> = Vec::new();
        let mut glowing = Vec::new();
        for primitive in mesh.primitives() {
            let Some(data) = self.gltf_primitive(asset, mesh.index(), &primitive) else {
                continue;
            };
            let (mut shape, carrier) = carried(data.clone());
            let surface = self.gltf_material(asset, &primitive, carrier.as_ref());
            if surface.radiance.is_some() {
                glowing.push((data, primitive.index()));
                continue;
            }
            if surface.follows_coordinates {
                shape.follow_coordinates();
            }
            members.push((shape.into(), surface.bsdf));
        }
        let id = (!members.is_empty()).then(|| self.builder.add_group(members));
        Group { id, glowing }
    }

    /// Adds a piece of a mesh where it stands.
    fn gltf_part<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        mut data: MeshData,
        primitive: &gltf::Primitive<'g>,
        to_world: Mat4,
    ) {
        data.transform(to_world);
        let is_mirrored = Mat3::from_mat4(to_world).determinant() < 0.0;
        if is_mirrored && data.normals.is_none() {
            data.indices
                .iter_mut()
                .for_each(|corners| corners.swap(1, 2));
        }
        if let Err(flaw) = data.validate() {
            self.problems.error(&self.line(1), flaw.to_string());
            return;
        }
        let (mesh, carrier) = carried(data);
        let surface = self.gltf_material(asset, primitive, carrier.as_ref());
        self.add_mesh(mesh, &surface, &self.line(1));
    }

    /// The material of a piece of a mesh, made once unless it shows the mesh's own colours.
    fn gltf_material<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        primitive: &gltf::Primitive<'g>,
        carrier: Option<&super::Carrier>,
    ) -> Surface {
        let material = primitive.material();
        if let (None, Some(known)) = (carrier, asset.surfaces.get(&material.index())) {
            return known.clone();
        }
        let made = self.gltf_surface(asset, &material, carrier);
        let surface = self.add_surface(made);
        if carrier.is_none() {
            asset.surfaces.insert(material.index(), surface.clone());
        }
        surface
    }

    fn gltf_light(&mut self, light: &gltf::khr_lights_punctual::Light<'_>, to_world: Mat4) {
        let colour = Rgb(Vec3::from_array(light.color()).max(Vec3::ZERO));
        let radiant = colour * light.intensity().max(0.0);
        let added = match light.kind() {
            Kind::Point => {
                let position = to_world.w_axis.truncate();
                self.builder.add_emitter(Point::new(position, radiant));
                Ok(())
            }
            Kind::Directional => {
                let direction = to_world.transform_vector3(Vec3::NEG_Z);
                let made = Directional::new(direction, radiant);
                made.map(|made| _ = self.builder.add_emitter(made))
            }
            Kind::Spot {
                inner_cone_angle,
                outer_cone_angle,
            } => {
                let beam = Beam {
                    cutoff: outer_cone_angle,
                    full: inner_cone_angle,
                };
                let made = Spot::new(to_world * TURNED, radiant, beam, None);
                made.map(|made| _ = self.builder.add_emitter(made))
            }
        };
        match added {
            Ok(()) => self.has_light = true,
            Err(error) => {
                let message = format!("light {}: {error}", light.index());
                self.problems.error(&self.line(1), message);
            }
        }
    }

    fn gltf_camera(&mut self, camera: &Camera<'_>, to_world: Mat4) {
        let (aspect, made) = match camera.projection() {
            Projection::Perspective(perspective) => {
                let aspect = perspective.aspect_ratio().unwrap_or(4.0 / 3.0);
                let size = self.film_of(aspect);
                let made = Perspective::new(PerspectiveSettings {
                    to_world: to_world * TURNED,
                    field_of_view: perspective.yfov().to_degrees(),
                    axis: FieldOfViewAxis::Y,
                    near: perspective.znear(),
                    far: perspective.zfar().unwrap_or(1e9),
                    principal_point_offset: Vec2::ZERO,
                    film_size: size,
                });
                (aspect, made.map(Into::into))
            }
            Projection::Orthographic(flat) => {
                let (half_width, half_height) = (flat.xmag().abs(), flat.ymag().abs());
                let aspect = half_width / half_height;
                let axes = Mat3::from_mat4(to_world);
                let axes = [axes.x_axis, axes.y_axis, axes.z_axis].map(Vec3::normalize_or_zero);
                let axes = Mat3::from_cols(axes[0], axes[1], axes[2]);
                let stand =
                    Mat4::from_translation(to_world.w_axis.truncate()) * Mat4::from_mat3(axes);
                let scale = Mat4::from_scale(Vec3::new(half_width, half_width, 1.0));
                let clip = (flat.znear(), flat.zfar());
                let made = Orthographic::new(stand * TURNED * scale, clip, self.film_of(aspect));
                (aspect, made.map(Into::into))
            }
        };
        let size = self.film_of(aspect);
        let noted = |error: SensorError| {
            let message = format!("camera {}: {error}", camera.index());
            self.problems.error(&self.line(1), message);
        };
        let made = made.map_err(noted);
        self.views
            .extend(made.ok().map(|sensor| view(sensor, size)));
    }

    /// Width and height of a film, in pixels.
    ///
    /// - `aspect`: width over height.
    fn film_of(&self, aspect: f32) -> (u32, u32) {
        let width = (FILM_HEIGHT * aspect).round().clamp(1.0, 65_536.0);
        let made = (width as u32, FILM_HEIGHT as u32);
        self.options.film_size.unwrap_or(made)
    }
}
