//! Probes: what measures a device and a compiler. Runs on the GPU and on the CPU.
//!
//! | module | measures |
//! | --- | --- |
//! | [`canary`] | what a device keeps of the arithmetic that the ladder needs |
//! | [`throughput`] | how many operations a second a machine does at most, for `spherule bench` |
//! | [`layout`] | sizes and offsets of the shared types |
//! | [`glass_walk`] | whether a light path stays inside a sphere for a thousand reflections, for the hard cases |

pub mod canary;
pub mod glass_walk;
pub mod layout;
pub mod throughput;
