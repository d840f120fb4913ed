//! Light paths: what a pixel sees by all effects that its pipeline holds. Runs on the GPU and on
//! the CPU.
//!
//! A path starts at the camera and is continued, vertex after vertex, by a random direction (J. T.
//! Kajiya, The rendering equation, SIGGRAPH 1986). At each vertex that is not a mirror, one light
//! is sampled as well, and the two ways of finding a light are weighted by the power heuristic. The
//! estimate is unbiased, except for what a scene asks for: the limit on bounces, ambient occlusion,
//! the headlamp, clear shadows, and the clamp. Lights without extent are never met by chance: they
//! do not shine through glass unless shadows are clear, and no mirror shows them; only [`caustic`]
//! finds the light that one sphere throws from them onto others. From the fourth bounce on, dark
//! paths end by Russian roulette, which has no bias.
//!
//! | module | holds |
//! | --- | --- |
//! | [`Scenery`] | what stays the same for all paths of a launch |
//! | [`trace_pixel`] | traces the paths of a pixel, vertex after vertex: [`start`], then [`shade`] |
//! | `vertex` | how a vertex scatters |
//! | `seek`, `shadow`, `arrive` | lights that are sampled, and the rays to them; lights that are met by chance |
//! | `clear` | sampled light that passes glass without bending |
//! | [`caustic`] | light that comes by one sphere, found exactly |
//! | `glass`, `media` | reflection, refraction and absorption; the glass that a path is in |
//! | `light_path`, `place` | the state of a path, and where it is scattered |
//! | [`random`], [`sampling`] | random numbers, and random directions made of them |

mod arrive;
pub mod caustic;
mod clear;
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
pub use step::{Samples, shade, start, trace_pixel};
