//! Measures how exact the rungs of the ladder are, with an exact oracle and hard cases.
//!
//! | module | holds |
//! | --- | --- |
//! | [`oracle`] | exact arithmetic that decides hit or miss and rounds t correctly |
//! | [`cases`] | the hard cases, by number and name |
//! | [`scene_cases`] | the hard cases with more than one ray or sphere |
//! | [`ask`] | functions of the kernel, run on a device |
//! | [`families`] | families of rays, each hard in its own way |
//! | [`hard_rays`] | hard rays with exact answers, as files for other programs |
//! | [`shape_oracle`] | the same for shapes beside spheres |
//! | [`shape_families`] | families of rays and shapes, and the errors of a rung on them |
//! | [`screen`] | 64-bit arithmetic with an error bound, which saves most of the oracle's work |
//! | [`measure`] | the errors of a rung |
//! | [`scene_rays`] | the rays of a scene as a family |
//! | [`frames`] | the time and the errors of a whole frame on each rung |
//! | [`samples`] | the error of an image for more and more samples |
//! | [`price`] | the time of one intersection on each rung |
//! | [`report`] | the HTML page of accuracy against time |

pub mod ask;
pub mod cases;
pub mod families;
pub mod frames;
pub mod hard_rays;
pub mod measure;
pub mod oracle;
pub mod price;
pub mod report;
pub mod samples;
pub mod scene_cases;
pub mod scene_rays;
pub mod screen;
pub mod shape_families;
pub mod shape_oracle;
