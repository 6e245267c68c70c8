//! Textures: values that vary over a surface.

mod bitmap;
mod checkerboard;
mod constant;
mod mesh_surface;
mod product;
mod scaled;

pub use bitmap::{Bitmap, Filter, Wrap};
pub use checkerboard::Checkerboard;
pub use constant::Constant;
pub use mesh_surface::{MeshAttribute, MeshSurface, OnMesh};
pub use product::Product;
pub use scaled::Scaled;

use crate::math::{Rgb, Vec2};

/// What a texture can answer.
///
/// - `uv`: surface coordinates, before the texture's own `to_uv` transform; any finite number.
pub trait TextureModel {
    /// Colour at a point: linear Rec.709, or raw numbers where the texture was declared raw.
    fn colour(&self, uv: Vec2) -> Rgb;

    /// One number at a point: the luminance of a colour, or the channel itself.
    fn value(&self, uv: Vec2) -> f32 {
        self.colour(uv).luminance()
    }

    /// Derivatives of [`TextureModel::value`] by `u` and `v`; zero where it jumps.
    fn gradient(&self, uv: Vec2) -> Vec2;

    /// Mean colour over the unit square of `uv`.
    fn mean(&self) -> Rgb;

    /// True when the texture has one value everywhere.
    fn is_constant(&self) -> bool {
        false
    }

    /// The texture whose colours are the numbers of this one, where those lie in other places.
    fn of_numbers(self) -> Self
    where
        Self: Sized,
    {
        self
    }

    /// The same with zero in place of negative numbers, as light has it; `None` where there are none.
    fn without_negatives(&self) -> Option<Self>
    where
        Self: Sized;
}

/// Writes the enum of all textures and forwards [`TextureModel`] to its variants.
macro_rules! texture_models {
    ($($(#[$doc:meta])* $model:ident($payload:ty),)*) => {
        /// Any texture.
        #[derive(Clone, Debug)]
        pub enum Texture {
            $($(#[$doc])* $model($payload),)*
        }

        $(impl From<$payload> for Texture {
            fn from(texture: $payload) -> Self {
                Self::$model(texture)
            }
        })*

        impl Texture {
            /// The colour of a texture that is constant.
            #[inline]
            pub fn sole_colour(&self) -> Option<Rgb> {
                match self {
                    Self::Constant(texture) => Some(texture.colour(Vec2::ZERO)),
                    _ => None,
                }
            }

            #[inline(never)]
            fn varying_colour(&self, uv: Vec2) -> Rgb {
                match self { $(Self::$model(t) => t.colour(uv),)* }
            }
        }

        impl TextureModel for Texture {
            /// Most textures of a scene are constant: their code goes right where it is asked for.
            #[inline(always)]
            fn colour(&self, uv: Vec2) -> Rgb {
                if let Self::Constant(texture) = self {
                    texture.colour(uv)
                } else {
                    self.varying_colour(uv)
                }
            }
            #[inline]
            fn value(&self, uv: Vec2) -> f32 {
                match self { $(Self::$model(t) => t.value(uv),)* }
            }
            #[inline]
            fn gradient(&self, uv: Vec2) -> Vec2 {
                match self { $(Self::$model(t) => t.gradient(uv),)* }
            }
            fn mean(&self) -> Rgb {
                match self { $(Self::$model(t) => t.mean(),)* }
            }
            fn is_constant(&self) -> bool {
                match self { $(Self::$model(t) => t.is_constant(),)* }
            }
            fn of_numbers(self) -> Self {
                match self { $(Self::$model(t) => t.of_numbers().into(),)* }
            }
            fn without_negatives(&self) -> Option<Self> {
                match self { $(Self::$model(t) => t.without_negatives().map(Self::from),)* }
            }
        }
    };
}

texture_models! {
    /// A picture.
    Bitmap(Bitmap),
    /// Squares of two textures.
    Checkerboard(Checkerboard),
    /// One colour everywhere.
    Constant(Constant),
    /// Values that a mesh carries.
    MeshAttribute(MeshAttribute),
    /// A texture at the texture coordinates of a mesh whose points tell where on it they lie.
    OnMesh(OnMesh),
    /// Two textures, multiplied.
    Product(Product),
    /// A texture times a factor.
    Scaled(Scaled),
}

impl Texture {
    /// True when the texture is zero everywhere and known to be.
    pub fn is_zero(&self) -> bool {
        self.is_constant() && self.colour(Vec2::ZERO).is_black()
    }
}

/// Zero in place of negative channels; `None` where there are none.
fn clamped(colour: Rgb) -> Option<Rgb> {
    let clamped = colour.clamp(0.0, f32::INFINITY);
    (clamped != colour).then_some(clamped)
}

impl From<Rgb> for Texture {
    fn from(colour: Rgb) -> Self {
        Constant::new(colour).into()
    }
}

impl From<f32> for Texture {
    fn from(grey: f32) -> Self {
        Rgb::grey(grey).into()
    }
}
