//! Ways to intersect a ray with a sphere, one file each. Runs on the GPU and on the CPU.

pub mod textbook;
