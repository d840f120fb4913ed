//! Light paths: what a pixel sees by all effects that its pipeline holds. Runs on the GPU and on
//! the CPU.
//!
//! A path starts at the camera and is continued, vertex after vertex, by a random direction (J. T.
//! Kajiya, The rendering equation, SIGGRAPH 1986). At each vertex that is not a mirror, one light is
//! looked for as well, and the two ways of finding a light are weighed by the power heuristic. The
//! estimate is unbiased but for three things that a scene asks for: the limit on bounces, ambient
//! occlusion, and the headlamp. Lights without extent are not met by chance: they do not shine
//! through glass, and no mirror shows them. Beyond the third bounce dark paths end by Russian roulette, which
//! has no bias.
//!
//! | module | holds |
//! | --- | --- |
//! | [`Scenery`] | what stays the same for all paths of a launch |
//! | [`trace_pixel`] | from a pixel to its paths, vertex after vertex |
//! | `vertex` | how a vertex scatters |
//! | `seek`, `arrive` | light that is looked for, light that is met by chance |
//! | `glass` | reflection, refraction and absorption |
//! | `light_path` | a path on its way |
//! | [`random`], [`sampling`] | random numbers, and random directions made of them |

mod arrive;
mod glass;
mod light_path;
pub mod random;
pub mod sampling;
mod scenery;
mod seek;
mod step;
mod vertex;

pub use scenery::Scenery;
pub use step::trace_pixel;
