//! [`Levels`] where there is no AVX-512, which is what they are for: there are none.

use spherule_kernel::accel::node::Tree;

/// Boxes around the spheres of a tree.
#[derive(Clone, Debug)]
pub enum Levels {}

impl Levels {
    /// The levels of a tree: `None`.
    #[must_use]
    pub fn of(_: Tree<'_>) -> Option<Self> {
        None
    }

    /// The memory that the levels take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match *self {}
    }
}
