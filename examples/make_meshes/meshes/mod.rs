//! The meshes of the scenes, as formulas.
//!
//! Lengths are of no matter while a shape is made: [`Mesh::fitted`] puts it on the plane y = 0, centred
//! over the origin, with 1 as its longest side. The scenes scale it. No normals are stored: who reads
//! the file makes smooth ones, and where there are edges the scene says `max_smooth_angle`.

mod architecture;
mod dragon;
mod implicit;
mod implicit_shapes;
mod lathe;
mod mesh;
mod sweep;
mod tubes;
mod vector;
mod warped;

use mesh::Mesh;

/// A name, and what makes the mesh of that name.
type Recipe = (&'static str, fn() -> Mesh);

/// All meshes.
pub(crate) const ALL: [Recipe; 39] = [
    ("ammonite", tubes::ammonite),
    ("amphora", lathe::amphora),
    ("bird", tubes::bird),
    ("blossom", warped::blossom),
    ("borromean", tubes::borromean),
    ("bowl", lathe::bowl),
    ("buckyball", implicit_shapes::buckyball),
    ("bust", implicit_shapes::bust),
    ("column", lathe::column),
    ("conch", tubes::conch),
    ("coral", warped::coral),
    ("cornice", architecture::cornice),
    ("cushion", warped::cushion),
    ("dragon", dragon::dragon),
    ("figure-eight", tubes::figure_eight),
    ("gear", warped::gear),
    ("goblet", lathe::goblet),
    ("gyroid", implicit_shapes::gyroid),
    ("klein-bottle", warped::klein_bottle),
    ("mobius", tubes::mobius),
    ("pilaster", lathe::pilaster),
    ("plinth", architecture::plinth),
    ("reclining", implicit_shapes::reclining),
    ("relief-ripples", warped::relief_ripples),
    ("relief-sunflower", warped::relief_sunflower),
    ("relief-weave", warped::relief_weave),
    ("rippled-mirror", warped::rippled_mirror),
    ("saddle-ring", implicit_shapes::saddle_ring),
    ("serpent", tubes::serpent),
    ("spring", tubes::spring),
    ("standing", implicit_shapes::standing),
    ("star", warped::star),
    ("supertorus", warped::supertorus),
    ("torus", warped::torus),
    ("torus-knot", tubes::torus_knot),
    ("trefoil", tubes::trefoil),
    ("urn", lathe::urn),
    ("vase", lathe::vase),
    ("vault", architecture::vault),
];
