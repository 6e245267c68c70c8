//! Pictures of a glTF file as textures.

use std::path::Path;
use std::sync::Arc;

use gltf::texture::{Info, MagFilter, WrappingMode};

use super::super::Model;
use super::{Asset, Carrier};
use crate::image::{self, Bitmap, Texels, Transfer};
use crate::math::{Mat3, Vec2};
use crate::texture::{self, Filter, OnMesh, Texture, Wrap};

/// What of a picture a texture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// Its colours, decoded from sRGB.
    Colour,
    /// One channel's numbers: 0 to 2 for colours, 3 for alpha.
    Channel(u32),
    /// One where alpha reaches a threshold, otherwise zero.
    AlphaAbove(f32),
    /// Normals, with this factor on what leans.
    Normals(f32),
}

/// A texture of a material, wherever in the material it stands.
pub(super) struct Use<'g> {
    texture: gltf::Texture<'g>,
    set: u32,
    to_uv: Mat3,
}

impl<'g> From<Info<'g>> for Use<'g> {
    fn from(info: Info<'g>) -> Self {
        let transform = info.texture_transform();
        let to_uv = transform.as_ref().map_or(Mat3::IDENTITY, |transform| {
            let (sin, cos) = transform.rotation().sin_cos();
            // Counter-clockwise on the picture, whose v grows downwards.
            let turn = Mat3::from_cols_array(&[cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0]);
            Mat3::from_translation(transform.offset().into())
                * turn
                * Mat3::from_scale(transform.scale().into())
        });
        let set = transform.and_then(|transform| transform.tex_coord());
        Self {
            set: set.unwrap_or(info.tex_coord()),
            texture: info.texture(),
            to_uv,
        }
    }
}

impl<'g> From<gltf::material::NormalTexture<'g>> for Use<'g> {
    fn from(normals: gltf::material::NormalTexture<'g>) -> Self {
        Self {
            texture: normals.texture(),
            set: normals.tex_coord(),
            to_uv: Mat3::IDENTITY,
        }
    }
}

impl Model<'_> {
    /// A texture of a material; `None` after noting why there is none.
    ///
    /// - `carrier`: the mesh whose colours the material shows.
    pub(super) fn gltf_texture<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        used: impl Into<Use<'g>>,
        part: Part,
        carrier: Option<&Carrier>,
    ) -> Option<Texture> {
        let used = used.into();
        let index = used.texture.index();
        if used.set != 0 {
            let set = used.set;
            let message =
                format!("texture {index} uses TEXCOORD_{set}; TEXCOORD_0 is used instead");
            self.problems.replacement(&self.line(1), message);
        }
        let picture = self.gltf_image(asset, used.texture.source().index())?;
        let picture = part_of(&picture, part);
        let sampler = used.texture.sampler();
        let (across, down) = (sampler.wrap_s(), sampler.wrap_t());
        if across != down {
            let message = format!("texture {index} repeats differently across and down; as across");
            self.problems.replacement(&self.line(1), message);
        }
        let wrap = match across {
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::Repeat => Wrap::Repeat,
        };
        let filter = match sampler.mag_filter() {
            Some(MagFilter::Nearest) => Filter::Nearest,
            _ => Filter::Bilinear,
        };
        let texture = texture::Bitmap::new(picture, filter, wrap, used.to_uv).into();
        Some(match carrier {
            Some(carrier) => OnMesh::new(carrier.surface.clone(), texture).into(),
            None => texture,
        })
    }

    /// A picture of the file, read once; `None` after noting why there is none.
    fn gltf_image(&mut self, asset: &mut Asset<'_>, index: usize) -> Option<Arc<Bitmap>> {
        if let Some(known) = asset.images.get(&index) {
            return known.clone();
        }
        let what = format!("image {index}");
        let json = asset.document.as_json().images.get(index);
        let view = json.and_then(|image| image.buffer_view.as_ref());
        let bytes = match (view, json.and_then(|image| image.uri.as_ref())) {
            (Some(view), _) => {
                let view = asset.document.views().nth(view.value());
                let bytes = view.map(|view| asset.buffers.view(&view));
                let bytes = bytes.unwrap_or_else(|| Err("its bufferView is missing".to_owned()));
                bytes.map(<[u8]>::to_vec)
            }
            (None, Some(uri)) => self.gltf_resource(uri, &what),
            (None, None) => Err(format!("{what} has neither a uri nor a bufferView")),
        };
        let read = bytes.and_then(|bytes| {
            let read = image::decode_bitmap(&bytes, Path::new(&what));
            read.map_err(|error| error.to_string())
        });
        let read = read.map_err(|message| {
            self.problems
                .unsupported(&self.line(1), message, "left out");
        });
        let read = read.ok().map(Arc::new);
        let bytes = read.as_ref().map_or(0, |picture| picture.memory());
        self.builder.note_pictures(bytes);
        asset.images.insert(index, read.clone());
        read
    }
}

/// What a texture shows of a picture.
fn part_of(picture: &Arc<Bitmap>, part: Part) -> Arc<Bitmap> {
    let raw = |picture: &Bitmap| picture.clone().with_transfer(Transfer::Linear);
    let made = match part {
        Part::Colour => return Arc::clone(picture),
        Part::Channel(3) => channel(picture, |x, y| picture.alpha(x, y)),
        Part::Channel(index) => {
            let raw = raw(picture);
            let index = index.min(raw.channels() - 1);
            channel(picture, |x, y| raw.value(x, y, index))
        }
        Part::AlphaAbove(least) => channel(picture, |x, y| {
            f32::from(u8::from(picture.alpha(x, y) >= least))
        }),
        Part::Normals(1.0) => Some(raw(picture)),
        Part::Normals(scale) => leaning(&raw(picture), scale),
    };
    made.map_or_else(|| Arc::clone(picture), Arc::new)
}

/// A picture of one channel.
fn channel(picture: &Bitmap, value: impl Fn(u32, u32) -> f32) -> Option<Bitmap> {
    let texels = each(picture, |x, y| [value(x, y)]);
    let (width, height) = (picture.width(), picture.height());
    match picture.texels() {
        Texels::U8(_) => {
            let codes = texels.iter().map(|value| (value * 255.0).round() as u8);
            let made = Bitmap::new(width, height, 1, Texels::U8(codes.collect()))?;
            Some(made.with_transfer(Transfer::Linear))
        }
        _ => Bitmap::new(width, height, 1, Texels::Float(texels)),
    }
}

/// Normals that lean more or less than those of a picture.
fn leaning(normals: &Bitmap, scale: f32) -> Option<Bitmap> {
    let texels = each(normals, |x, y| {
        let across = normals.rgb(x, y).0.truncate() * 2.0 - 1.0;
        let Vec2 { x: r, y: g } = (across * scale) * 0.5 + 0.5;
        [r, g, normals.rgb(x, y).b()]
    });
    Bitmap::new(normals.width(), normals.height(), 3, Texels::Float(texels))
}

fn each<const N: usize>(picture: &Bitmap, texel: impl Fn(u32, u32) -> [f32; N]) -> Vec<f32> {
    let rows = 0..picture.height();
    let places = rows.flat_map(|y| (0..picture.width()).map(move |x| (x, y)));
    places.flat_map(|(x, y)| texel(x, y)).collect()
}
