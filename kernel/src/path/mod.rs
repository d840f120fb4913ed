//! Light paths: what a pixel sees by all effects that its pipeline holds. Runs on the GPU and on
//! the CPU.
//!
//! A path starts at the camera and is continued, vertex after vertex, by a random direction (J. T.
//! Kajiya, The rendering equation, SIGGRAPH 1986). At each vertex that is not a mirror, one light
//! is sampled as well, and the two ways of finding a light are weighted by the power heuristic. The
//! estimate is unbiased, except for three things that a scene asks for: the limit on bounces,
//! ambient occlusion, and the headlamp. Lights without extent are never met by chance: they do not
//! shine through glass, and no mirror shows them. From the fourth bounce on, dark paths end by
//! Russian roulette, which has no bias.
//!
//! | module | holds |
//! | --- | --- |
//! | [`Scenery`] | what stays the same for all paths of a launch |
//! | [`trace_pixel`] | traces the paths of a pixel, vertex after vertex: [`start`], then [`shade`] |
//! | `vertex` | how a vertex scatters |
//! | `seek`, `shadow`, `arrive` | lights that are sampled, and the rays to them; lights that are met by chance |
//! | `glass`, `media` | reflection, refraction and absorption; the glass that a path is in |
//! | `light_path`, `place` | the state of a path, and where it is scattered |
//! | [`random`], [`sampling`] | random numbers, and random directions made of them |

mod arrive;
mod glass;
mod light_path;
mod media;
mod place;
pub mod random;
pub mod sampling;
mod scenery;
mod seek;
mod shadow;
mod step;
mod vertex;

pub use light_path::Path;
pub use scenery::Scenery;
pub use shadow::Shadow;
pub use step::{shade, start, trace_pixel};
