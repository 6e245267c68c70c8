//! Small scenes, put together by hand.

use lumiflow::bsdf::{
    Bsdf, Dielectric, Diffuse, MicrofacetKind, Plastic, RelativeIor, RoughConductor, Roughness,
};
use lumiflow::emitter::{Constant, Point};
use lumiflow::math::{Mat4, Rgb, Transform, Vec2, Vec3};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::sensor::{FieldOfViewAxis, Perspective, PerspectiveSettings, Sensor, ThinLens};
use lumiflow::shape::mesh::MeshData;
use lumiflow::shape::{Shape, Sphere, TriangleMesh, primitives};
use lumiflow::texture::Texture;

/// One surface of a scene.
pub(crate) struct Part {
    pub(crate) shape: Shape,
    pub(crate) bsdf: Bsdf,
    /// What its front emits.
    pub(crate) radiance: Option<Rgb>,
}

/// A surface that does not emit.
pub(crate) fn part(shape: impl Into<Shape>, bsdf: impl Into<Bsdf>) -> Part {
    Part {
        shape: shape.into(),
        bsdf: bsdf.into(),
        radiance: None,
    }
}

impl Part {
    pub(crate) fn glowing(self, radiance: Rgb) -> Self {
        Self {
            radiance: Some(radiance),
            ..self
        }
    }
}

/// Puts surfaces together, after `more` has added other lights.
pub(crate) fn scene(
    parts: impl IntoIterator<Item = Part>,
    more: impl FnOnce(&mut SceneBuilder),
) -> Scene {
    let mut builder = SceneBuilder::new();
    more(&mut builder);
    for part in parts {
        let bsdf = builder.add_bsdf(part.bsdf);
        builder
            .add_shape(part.shape, bsdf, part.radiance.map(Texture::from))
            .expect("the shape has an area");
    }
    builder.build().expect("the tracer takes the geometry")
}

/// A square film's camera.
///
/// - `degrees`: field of view.
/// - `side`: width and height of the film in pixels.
pub(crate) fn camera(from: Vec3, to: Vec3, degrees: f32, side: u32) -> Sensor {
    let settings = camera_settings(from, to, degrees, side);
    Perspective::new(settings)
        .expect("the camera is one")
        .into()
}

/// A square film's camera with a lens.
///
/// - `degrees`, `side`: as for [`camera`].
/// - `radius`, `focus`: of the lens, and the distance of the plane that is sharp.
pub(crate) fn thin_lens(
    from: Vec3,
    to: Vec3,
    (degrees, side): (f32, u32),
    (radius, focus): (f32, f32),
) -> Sensor {
    let settings = camera_settings(from, to, degrees, side);
    ThinLens::new(settings, radius, focus)
        .expect("the camera is one")
        .into()
}

fn camera_settings(from: Vec3, to: Vec3, degrees: f32, side: u32) -> PerspectiveSettings {
    let up = if (to - from).normalize().y.abs() > 0.99 {
        Vec3::Z
    } else {
        Vec3::Y
    };
    let to_world = Transform::look_at(from.as_dvec3(), to.as_dvec3(), Some(up.as_dvec3()))
        .expect("the camera looks somewhere");
    PerspectiveSettings {
        to_world: to_world.matrix(),
        field_of_view: degrees,
        axis: FieldOfViewAxis::X,
        near: 0.0,
        far: f32::MAX,
        principal_point_offset: Vec2::ZERO,
        film_size: (side, side),
    }
}

/// A sphere with its front outside.
pub(crate) fn sphere(centre: Vec3, radius: f32) -> Sphere {
    Sphere::new(centre, radius, Mat4::IDENTITY).expect("the sphere is one")
}

/// A sphere with its front inside.
pub(crate) fn hollow_sphere(centre: Vec3, radius: f32) -> Sphere {
    let mut sphere = sphere(centre, radius);
    sphere.flip_normals();
    sphere
}

/// A sphere of few triangles with normals as if it were round.
pub(crate) fn faceted_sphere(rings: u32, to_world: Mat4) -> TriangleMesh {
    let segments = 2 * rings;
    let mut mesh = MeshData::default();
    for ring in 0..=rings {
        let (sin, cos) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
        for segment in 0..segments {
            let turn = std::f32::consts::TAU * segment as f32 / segments as f32;
            mesh.positions
                .push([sin * turn.cos(), cos, -sin * turn.sin()]);
        }
    }
    let vertex = |ring: u32, segment: u32| ring * segments + segment % segments;
    for ring in 0..rings {
        for s in 0..segments {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(r, t)| vertex(ring + r, s + t));
            mesh.indices.push([corners[0], corners[1], corners[2]]);
            mesh.indices.push([corners[0], corners[2], corners[3]]);
        }
    }
    mesh.normals = Some(mesh.positions.clone());
    moved(mesh, to_world)
}

/// A rectangle by its middle and half its edges; the front is where `along_u` × `along_v` points.
pub(crate) fn rectangle(middle: Vec3, along_u: Vec3, along_v: Vec3) -> TriangleMesh {
    let normal = along_u.cross(along_v).normalize();
    moved(
        primitives::rectangle(),
        Mat4::from_cols(
            along_u.extend(0.0),
            along_v.extend(0.0),
            normal.extend(0.0),
            middle.extend(1.0),
        ),
    )
}

/// A box around `middle` with its front outside.
pub(crate) fn cuboid(middle: Vec3, half: Vec3) -> TriangleMesh {
    let place = Mat4::from_translation(middle) * Mat4::from_scale(half);
    moved(primitives::cube(), place)
}

/// The six walls around the box from −1 to 1, fronts inside: x−, x+, y−, y+, z−, z+.
pub(crate) fn walls(to_world: Mat4) -> [TriangleMesh; 6] {
    let axes = [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)];
    let sides = axes.map(|(x, y)| {
        let z = x.cross(y);
        [(-z, x, y), (z, y, x)].map(|(middle, u, v)| (z, middle, u, v))
    });
    let mut walls: Vec<_> = sides.into_iter().flatten().collect();
    walls.sort_by_key(|(axis, ..)| axis.abs().to_array().iter().position(|c| *c == 1.0));
    let walls: Vec<_> = walls
        .into_iter()
        .map(|(_, middle, u, v)| {
            let square = Mat4::from_cols(
                u.extend(0.0),
                v.extend(0.0),
                u.cross(v).extend(0.0),
                middle.extend(1.0),
            );
            moved(primitives::rectangle(), to_world * square)
        })
        .collect();
    walls.try_into().expect("a box has six walls")
}

/// A mesh after a transform.
pub(crate) fn moved(mut data: MeshData, to_world: Mat4) -> TriangleMesh {
    data.transform(to_world);
    data.validate().expect("the mesh is sound");
    data.into()
}

/// An open box with coloured walls, a lamp under its ceiling, and two blocks: light goes around.
///
/// It fills −1 to 1, open towards +z, before `to_world`.
pub(crate) fn cornell(to_world: Mat4) -> Scene {
    let white = Rgb::new(0.7, 0.7, 0.7);
    let [red, green, floor, ceiling, back, _front] = walls(to_world);
    let colours = [
        Rgb::new(0.6, 0.1, 0.1),
        Rgb::new(0.1, 0.5, 0.1),
        white,
        white,
        white,
    ];
    let shell = [red, green, floor, ceiling, back]
        .into_iter()
        .zip(colours)
        .map(|(wall, colour)| part(wall, Diffuse::new(colour)));
    let block = |middle: Vec3, half: Vec3, degrees: f32| {
        let turn = Mat4::from_rotation_y(degrees.to_radians());
        let place = Mat4::from_translation(middle) * turn * Mat4::from_scale(half);
        part(
            moved(primitives::cube(), to_world * place),
            Diffuse::new(white),
        )
    };
    let lamp = Mat4::from_cols(
        (Vec3::X * 0.3).extend(0.0),
        (Vec3::Z * 0.3).extend(0.0),
        (-Vec3::Y).extend(0.0),
        Vec3::new(0.0, 0.98, 0.0).extend(1.0),
    );
    let lamp = part(
        moved(primitives::rectangle(), to_world * lamp),
        Diffuse::new(0.0),
    );
    let inside = [
        block(Vec3::new(-0.35, -0.4, -0.4), Vec3::new(0.3, 0.6, 0.3), 20.0),
        block(Vec3::new(0.4, -0.7, 0.3), Vec3::splat(0.3), -15.0),
        lamp.glowing(Rgb::new(12.0, 10.0, 6.0)),
    ];
    scene(shell.chain(inside), |_| {})
}

/// The camera that looks into [`cornell`].
pub(crate) fn cornell_camera(to_world: Mat4, side: u32) -> Sensor {
    let from = to_world.transform_point3(Vec3::new(0.0, 0.0, 3.6));
    let to = to_world.transform_point3(Vec3::ZERO);
    camera(from, to, 40.0, side)
}

/// A floor with bodies of several materials under lights of several kinds.
///
/// - `strength`: of all lights.
pub(crate) fn studio(strength: f32, more: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    let roughness = Roughness::isotropic(MicrofacetKind::Ggx, 0.2);
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 4.0);
    let lamp = rectangle(Vec3::new(-1.0, 3.0, 0.5), Vec3::X, Vec3::Z * 0.8);
    let parts = [
        part(floor, Plastic::new(ior, 1.0, Rgb::new(0.6, 0.5, 0.4), true)),
        part(
            sphere(Vec3::new(-0.9, 0.6, 0.0), 0.6),
            RoughConductor::new(roughness, None, 0.9),
        ),
        part(
            sphere(Vec3::new(0.6, 0.5, 0.5), 0.5),
            Dielectric::new(ior, 1.0, 1.0),
        ),
        part(
            sphere(Vec3::new(0.5, 0.4, -1.2), 0.4),
            Diffuse::new(Rgb::new(0.2, 0.5, 0.8)),
        ),
        part(lamp, Diffuse::new(0.0)).glowing(Rgb::new(5.0, 4.0, 3.0) * strength),
        part(sphere(Vec3::new(2.0, 1.5, 0.0), 0.3), Diffuse::new(0.5))
            .glowing(Rgb::new(2.0, 3.0, 6.0) * strength),
    ];
    scene(parts, |builder| {
        builder.add_emitter(Constant::new(Rgb::new(0.2, 0.25, 0.3) * strength));
        builder.add_emitter(Point::new(
            Vec3::new(0.0, 2.5, 2.0),
            Rgb::grey(1.5) * strength,
        ));
        more(builder);
    })
}

/// The camera that looks at [`studio`].
pub(crate) fn studio_camera(side: u32) -> Sensor {
    camera(
        Vec3::new(0.5, 2.0, 4.5),
        Vec3::new(0.0, 0.5, 0.0),
        45.0,
        side,
    )
}
