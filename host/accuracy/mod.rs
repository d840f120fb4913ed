//! How right the rungs of the ladder are: an exact oracle, and the cases that are hard.
//!
//! | module | holds |
//! | --- | --- |
//! | [`oracle`] | exact arithmetic that decides hit or miss and rounds t correctly |
//! | [`canary`] | what a device does to the arithmetic that the upper rungs need |
//! | [`random`] | repeatable random numbers |
//! | [`ulp`] | distances between floats in units in the last place |

pub mod canary;
pub mod oracle;
pub mod random;
pub mod ulp;
