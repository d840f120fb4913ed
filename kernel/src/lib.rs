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
//! | [`lane`] | [`lane::Lane`]: the numbers that formulas are written in, one or several side by side |
//! | [`arithmetic`] | floats whose rounding errors are kept |
//! | [`precision`] | the ladder: ways to intersect a ray with a sphere |
//! | [`nearest`] | the nearest hit of a ray among a slice of spheres, and whether there is any |
//! | [`bounds`] | what few operations tell of a ray and a sphere for certain |
//! | [`candidates`], [`cone`] | which of many spheres a rung must be asked about: by any ray, by a camera's |
//! | [`frustum`] | which spheres none of a tile's rays meets |
//! | `by_tiles` | brute force by workgroups, which share what their pixels do not need to know each, behind the feature `entry-points` |
//! | [`tree`] | [`tree::Node`]: boxes around spheres, so that a ray looks at few |
//! | [`traversal`] | what finds the hits of light paths |
//! | [`surface`] | the point and the normal at a hit |
//! | [`camera`] | [`Camera`]: from a pixel to a ray |
//! | [`material`] | [`Material`]: what a sphere is made of |
//! | [`optics`] | refraction and reflection between transparent media |
//! | [`shading`] | [`Shading`]: from a hit to a colour |
//! | [`effects`] | [`Effects`]: which effects exist in a compiled pipeline |
//! | [`random`] | the random numbers of a sample |
//! | [`sampling`] | random directions |
//! | [`microfacet`] | rough metal |
//! | [`light`], [`sky`], [`fog`] | what shines, what surrounds the scene, what fills it |
//! | [`integrate`] | light paths: what a pixel sees by all effects |
//! | [`film`] | what a launch is told, what it writes |
//! | [`canary`] | what a device does to the arithmetic that the ladder needs |
//! | [`throughput`] | what a machine does at most, for `spherule bench` |
//! | [`walk`] | a light path inside a glass sphere, for the hard cases |
//! | [`layout`] | sizes and offsets of the shared types, as numbers |
//! | `entry` | the `#[spirv]` entry points, behind the feature `entry-points` |
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

pub mod arithmetic;
pub mod bounds;
#[cfg(all(feature = "entry-points", target_arch = "spirv"))]
mod by_tiles;
pub mod camera;
pub mod canary;
pub mod candidates;
pub mod cone;
pub mod effects;
#[cfg(all(feature = "entry-points", target_arch = "spirv"))]
pub mod entry;
pub mod film;
pub mod fog;
pub mod frustum;
pub mod hit;
pub mod instructions;
pub mod integrate;
pub mod lane;
pub mod layout;
pub mod light;
pub mod material;
pub mod microfacet;
pub mod nearest;
pub mod optics;
pub mod precision;
pub mod random;
pub mod ray;
pub mod sampling;
pub mod shading;
pub mod sky;
pub mod sphere;
#[cfg(not(target_arch = "spirv"))]
pub mod spirv;
pub mod surface;
pub mod throughput;
pub mod traversal;
pub mod tree;
pub mod walk;

pub use camera::Camera;
pub use effects::Effects;
pub use film::{Accumulator, Launch, PathLaunch, Pixel};
pub use glam;
pub use hit::Hit;
pub use light::Light;
pub use material::Material;
pub use nearest::nearest_hit;
pub use precision::{Precision, Rung};
pub use ray::Ray;
pub use shading::Shading;
pub use sphere::Sphere;
pub use surface::Surface;
