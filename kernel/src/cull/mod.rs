//! Culling: what a few operations tell for certain, so that the rung need not be evaluated. Runs on
//! the GPU and on the CPU.
//!
//! | module | tells |
//! | --- | --- |
//! | [`discriminant`] | which spheres a ray may meet |
//! | [`bounds`] | between which parameters a ray enters a sphere |
//! | [`cone`] | which spheres a ray from a shared eye may meet |
//! | [`frustum`] | which spheres no ray through a rectangle of the film meets |

pub mod bounds;
pub mod cone;
pub mod discriminant;
pub mod frustum;
