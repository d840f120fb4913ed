//! Scenes: what is rendered, and from where.
//!
//! | module | holds |
//! | --- | --- |
//! | [`world`] | [`World`]: the spheres and their materials, in the device's own types |
//! | [`view`] | [`View`]: where the camera is, given or framed around the world |
//! | [`limits`] | what the numbers of a scene may be |
//! | [`surroundings`] | light, sky, fog, lens: what there is besides spheres |
//! | [`mod@effects`] | which effects a scene calls for, and by what |
//! | `validate` | whether a scene can be rendered |

pub mod effects;
pub mod limits;
pub mod surroundings;
mod validate;
pub mod view;
pub mod world;

use std::path::PathBuf;

use glam::Vec3;

pub use surroundings::{Develop, FogBall, Lens, PointLight, Sampling, Surroundings};
pub use view::View;
pub use world::World;

/// A world, a view of it, and the image to make.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The spheres and their materials.
    pub world: World,
    /// Where the camera is; `None` frames the whole world.
    pub view: Option<View>,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// The colour of a ray that hits nothing, linear Rec. 709.
    pub background: Vec3,
    /// Whether the image shows what is behind it where there is no sphere.
    pub transparent: bool,
    /// The camera's lens and shutter.
    pub lens: Lens,
    /// The light of the surroundings, instead of the background; `None` for none.
    pub sky: Option<Surroundings>,
    /// A medium that fills a ball.
    pub fog: Option<FogBall>,
    /// Points of light.
    pub lights: Vec<PointLight>,
    /// How many samples, how many bounces.
    pub sampling: Sampling,
    /// From light to the colours of an 8-bit image.
    pub develop: Develop,
    /// The files that the scene was read from: its own, and what that names. No output may replace them.
    pub sources: Vec<PathBuf>,
}

impl Scene {
    /// The width and height of an image when nothing is said.
    pub const DEFAULT_SIZE: (u32, u32) = (1280, 720);
    /// The background when nothing is said: a light grey, linear Rec. 709.
    pub const DEFAULT_BACKGROUND: Vec3 = Vec3::splat(0.85);

    /// A scene of `world` at the default size, framed as a whole, on the default background.
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
            sources: Vec::new(),
        }
    }

    /// The view that is rendered: the one given, or else one that frames the world.
    #[must_use]
    pub fn view_or_framed(&self) -> View {
        self.view
            .unwrap_or_else(|| View::framing(&self.world.spheres, self.aspect()))
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}
