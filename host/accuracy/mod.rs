//! How right the rungs of the ladder are: an exact oracle, and the cases that are hard.
//!
//! | module | holds |
//! | --- | --- |
//! | [`oracle`] | exact arithmetic that decides hit or miss and rounds t correctly |
//! | [`ulp`] | distances between floats in units in the last place |

pub mod oracle;
pub mod ulp;
