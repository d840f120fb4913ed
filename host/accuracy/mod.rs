//! How right the rungs of the ladder are: an exact oracle, and the cases that are hard.
//!
//! | module | holds |
//! | --- | --- |
//! | [`oracle`] | exact arithmetic that decides hit or miss and rounds t correctly |
//! | [`cases`] | the hard cases, by number and name |
//! | [`scene_cases`] | those of them that concern more than one ray and one sphere |
//! | [`ask`] | the kernel's questions, put to a device |
//! | [`families`] | families of rays, each hard in its own way |
//! | [`screen`] | 64-bit arithmetic with an error bound, to spare the oracle most of its work |
//! | [`measure`] | how far a rung's answers are from the truth |
//! | [`scene_rays`] | the rays of a scene as such a family |
//! | [`frames`] | what each rung costs and gets right in a whole frame |
//! | [`samples`] | the error of an image as its samples grow |
//! | [`price`] | what a rung costs in time |
//! | [`report`] | accuracy against time, as a page |

pub mod ask;
pub mod cases;
pub mod families;
pub mod frames;
pub mod measure;
pub mod oracle;
pub mod price;
pub mod report;
pub mod samples;
pub mod scene_cases;
pub mod scene_rays;
pub mod screen;
