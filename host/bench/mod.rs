//! Measures the speed of rays of every kind, in worlds from two spheres to ten million.
//!
//! | module | holds |
//! | --- | --- |
//! | [`scenes`] | the worlds |
//! | [`rays`] | the rays: primary, shadow, ambient, incoherent |
//! | [`measure`] | the times of rays and of building the tree |
//! | [`limit`] | the peak throughput of the device, and the rays that it would allow |
//! | [`verify`] | checks that the tree loses no hit |
//! | [`export`] | worlds, rays and hits as files, for other programs |

pub mod export;
pub mod limit;
pub mod measure;
pub mod rays;
pub mod scenes;
pub mod verify;
