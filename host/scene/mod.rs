//! Scenes: what is rendered, and the view of it.
//!
//! | module | holds |
//! | --- | --- |
//! | [`world`] | [`World`]: the spheres and their materials, in the kernel's types |
//! | [`view`] | [`View`]: the camera's position and direction, given or framed around the world |
//! | [`limits`] | the ranges of a scene's numbers |
//! | [`surroundings`] | light, sky, fog, lens: everything besides spheres |
//! | [`mod@effects`] | which effects a scene calls for, and what calls for them |
//! | `casters` | the spheres that throw light onto others |
//! | `copies` | equal spheres, of which one can be seen |
//! | `glass` | glass in glass, and glass around a point |
//! | `origin` | which point becomes the origin of a scene that is far from its own |
//! | [`shapes`] | what the shapes beside the spheres may be |
//! | `validate` | checks whether a scene can be rendered |

mod casters;
mod copies;
pub mod effects;
mod glass;
pub mod limits;
pub(crate) mod origin;
pub mod shapes;
pub mod surroundings;
mod validate;
pub mod view;
pub mod world;

use std::path::PathBuf;

use glam::{DVec3, Vec3};

pub use surroundings::{Develop, FogBall, GlassShadows, Lens, PointLight, Sampling, Surroundings};
pub use view::View;
pub use world::World;

/// A world, a view of it, and the image to render.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Scene {
    /// The spheres and their materials.
    pub world: World,
    /// The camera's view; `None` frames the whole world.
    pub view: Option<View>,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// The colour of a ray that hits nothing, linear Rec. 709.
    pub background: Vec3,
    /// Whether the image is transparent where there is no sphere.
    pub transparent: bool,
    /// The camera's lens and shutter.
    pub lens: Lens,
    /// The light of the surroundings, which replaces the background; `None` for none.
    pub sky: Option<Surroundings>,
    /// A medium that fills a ball; `None` for none.
    pub fog: Option<FogBall>,
    /// The point lights.
    pub lights: Vec<PointLight>,
    /// The number of samples and bounces.
    pub sampling: Sampling,
    /// How light becomes the colours of an 8-bit image.
    pub develop: Develop,
    /// The point of the scene's files at which the origin of all coordinates here is: not zero if
    /// what a file shows is far from its own origin, where 32-bit floats would round coordinates.
    pub origin: DVec3,
    /// The files that the scene was read from: its own, and those that it names. No output may
    /// replace them.
    pub sources: Vec<PathBuf>,
}

impl Scene {
    /// The default width and height of an image, in pixels.
    pub const DEFAULT_SIZE: (u32, u32) = (1280, 720);
    /// The default background: a light grey, linear Rec. 709.
    pub const DEFAULT_BACKGROUND: Vec3 = Vec3::splat(0.85);

    /// A scene of `world` with the default size, view and background.
    #[must_use]
    pub fn new(world: World) -> Self {
        let (width, height) = Self::DEFAULT_SIZE;
        Self {
            world,
            view: None,
            width,
            height,
            background: Self::DEFAULT_BACKGROUND,
            transparent: false,
            lens: Lens::default(),
            sky: None,
            fog: None,
            lights: Vec::new(),
            sampling: Sampling::default(),
            develop: Develop::default(),
            origin: DVec3::ZERO,
            sources: Vec::new(),
        }
    }

    /// The scene's view, or else one that frames the world.
    #[must_use]
    pub fn view_or_framed(&self) -> View {
        self.view
            .unwrap_or_else(|| View::framing(&self.world.framed(), self.aspect()))
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}
