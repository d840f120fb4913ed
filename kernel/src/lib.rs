//! The device code of spherule, and the types that it shares with the host.
//!
//! One crate, two compilers: rust-gpu turns it into SPIR-V for the GPU, rustc turns it into
//! machine code for the CPU. Every line that decides a pixel is in here and nowhere else, as a
//! CUDA program would mark it `__host__ __device__`.
//!
//! # Map, in reading order
//!
//! | module | holds |
//! | --- | --- |
//! | [`ray`] | [`Ray`]: an origin, a direction, an interval |
//! | [`sphere`] | [`Sphere`]: a centre and a radius in one 16-byte load |
//! | [`hit`] | [`Hit`]: how far along the ray, and which sphere |
//! | [`camera`] | [`Camera`]: from a pixel to a ray |
//! | [`surface`] | [`Surface`]: the point and the normal at a hit |
//! | [`film`] | what a launch is told, what it writes |
//! | [`pixel`] | from a pixel to its colour, with one ray a pixel |
//! | [`shading`] | [`Shading`]: what the image shows of a hit |
//! | [`effects`] | [`Effects`]: which effects exist in a compiled pipeline |
//! | [`lane`] | [`lane::Lane`]: the numbers that formulas are written in, one or several side by side |
//! | [`arithmetic`] | floats whose rounding errors are kept |
//! | [`precision`] | the ladder: ways to intersect a ray with a sphere, one file a rung |
//! | [`shape`] | what a ray may hit beside spheres, one file a shape |
//! | [`cull`] | what few operations tell for certain, so that the rung need not be evaluated |
//! | [`accel`] | which spheres a ray is tested against: all, or those in the boxes that it meets |
//! | [`path`] | light paths: what a pixel sees by all effects |
//! | [`material`] | [`Material`]: what a sphere is made of, and how light is scattered there |
//! | [`light`], [`fog`] | what shines and what surrounds the scene, what fills it |
//! | [`color`] | luminance |
//! | [`probe`] | what measures a device |
//! | [`gpu`] | the `#[spirv]` entry points, behind the feature `entry-points`, and instructions that only a GPU has |
//! | `spirv` | the committed modules, for the host only |
//!
//! # Units
//!
//! Lengths are scene units, colours are linear Rec. 709, angles are radians unless a name says
//! otherwise. A parameter along a ray counts in lengths of the ray's direction, which need not
//! be a unit vector.

#![no_std]
#![cfg_attr(target_arch = "spirv", feature(asm_experimental_arch))]
#![deny(missing_docs)]

#[cfg(not(target_arch = "spirv"))]
extern crate alloc;

pub mod accel;
pub mod arithmetic;
pub mod camera;
pub mod color;
pub mod cull;
pub mod effects;
pub mod film;
pub mod filter;
pub mod fog;
pub mod gpu;
pub mod hit;
pub mod lane;
pub mod light;
pub mod material;
pub mod path;
pub mod pixel;
pub mod precision;
pub mod probe;
pub mod ray;
pub mod shading;
pub mod shape;
pub mod sphere;
#[cfg(not(target_arch = "spirv"))]
pub mod spirv;
pub mod surface;

pub use accel::brute::nearest_hit;
pub use camera::Camera;
pub use effects::Effects;
pub use film::{Accumulator, Launch, PathLaunch, Pixel};
pub use glam;
pub use hit::Hit;
pub use light::Light;
pub use material::Material;
pub use precision::{Precision, Rung};
pub use ray::Ray;
pub use shading::Shading;
pub use sphere::Sphere;
pub use surface::Surface;
