//! What few operations tell for certain, so that the rung need not be asked. Runs on the GPU and on the CPU.
//!
//! | module | tells |
//! | --- | --- |
//! | [`discriminant`] | which spheres a ray may meet |
//! | [`bounds`] | between which parameters a ray enters a sphere |
//! | [`cone`] | which spheres a ray from a shared eye may meet |
//! | [`frustum`] | which spheres none of a rectangle's rays meets |

pub mod bounds;
pub mod cone;
pub mod discriminant;
pub mod frustum;
