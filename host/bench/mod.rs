//! How fast rays of every kind are, by worlds from two spheres to ten million.
//!
//! | module | holds |
//! | --- | --- |
//! | [`scenes`] | the worlds |
//! | [`rays`] | the rays: primary, shadow, ambient, incoherent |
//! | [`measure`] | their times |
//! | [`limit`] | what the device does at most, and how many rays that would be |
//! | [`verify`] | whether the tree loses a hit |
//! | [`export`] | worlds, rays and hits as files, for other programs |

pub mod export;
pub mod limit;
pub mod measure;
pub mod rays;
pub mod scenes;
pub mod verify;
