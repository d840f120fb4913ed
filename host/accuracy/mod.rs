//! How right the rungs of the ladder are: an exact oracle, and the cases that are hard.
//!
//! | module | holds |
//! | --- | --- |
//! | [`oracle`] | exact arithmetic that decides hit or miss and rounds t correctly |
//! | [`canary`] | what a device does to the arithmetic that the upper rungs need |
//! | [`families`] | families of rays, each hard in its own way |
//! | [`screen`] | 64-bit arithmetic with an error bound, to spare the oracle most of its work |
//! | [`measure`] | how far a rung's answers are from the truth |
//! | [`random`] | repeatable random numbers |
//! | [`ulp`] | distances between floats in units in the last place |

pub mod canary;
pub mod families;
pub mod measure;
pub mod oracle;
pub mod random;
pub mod screen;
pub mod ulp;
