//! The worlds that are timed. Each is made from a fixed seed, so that everybody times the same.

use std::path::{Path, PathBuf};

use glam::Vec3;
use spherule_kernel::accel::node::Node;
use spherule_kernel::{Material, Sphere};

use crate::error::{Result, SceneError, nearest};
use crate::memory;
use crate::random::Random;
use crate::read::{self, toml};
use crate::scene::{Scene, View, World};

/// The memory for each sphere while the tree is built, by the largest resident set of `bench
/// --scene R10M`.
const BYTES_PER_SPHERE: u64 = 300;

/// A world that is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchScene {
    /// Two spheres: a ball on a ground.
    S2,
    /// 45 balls on a ground.
    S46,
    /// The last image of Ray Tracing in One Weekend, about 500 balls.
    S500,
    /// This many balls, uniform in the cube from −1 to 1, of radius 0.5 N^(−1/3).
    Uniform(u32),
    /// A lattice of 100³ balls that do not touch, seen along an axis.
    Lattice,
    /// The same lattice, not seen along an axis.
    LatticeRotated,
    /// A million balls of radii over four decades, nine tenths of them in a thousandth of the
    /// volume, inside a ball that encloses all.
    Clustered,
}

impl BenchScene {
    /// Every listed world, the small ones first.
    pub const ALL: [Self; 10] = [
        Self::S2,
        Self::S46,
        Self::S500,
        Self::Uniform(10_000),
        Self::Uniform(100_000),
        Self::Uniform(1_000_000),
        Self::Uniform(10_000_000),
        Self::Lattice,
        Self::LatticeRotated,
        Self::Clustered,
    ];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::S2 => "S2".into(),
            Self::S46 => "S46".into(),
            Self::S500 => "S500".into(),
            Self::Uniform(count) if count % 1_000_000 == 0 => format!("R{}M", count / 1_000_000),
            Self::Uniform(count) if count % 1000 == 0 => format!("R{}k", count / 1000),
            Self::Uniform(count) => format!("R{count}"),
            Self::Lattice => "L1M".into(),
            Self::LatticeRotated => "L1M-rotated".into(),
            Self::Clustered => "X1M".into(),
        }
    }

    /// The world with this name; `None` if there is none.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let listed = Self::ALL
            .into_iter()
            .find(|scene| scene.name().eq_ignore_ascii_case(name));
        listed.or_else(|| {
            // R and any other number of balls.
            let number = name.strip_prefix(['R', 'r'])?;
            let (number, unit) = if let Some(thousands) = number.strip_suffix('k') {
                (thousands, 1000)
            } else if let Some(millions) = number.strip_suffix('M') {
                (millions, 1_000_000)
            } else {
                (number, 1)
            };
            let count = number.parse::<u32>().ok()?.checked_mul(unit)?;
            (1..=Node::MAX_SPHERES)
                .contains(&count)
                .then_some(Self::Uniform(count))
        })
    }

    /// The length of ambient rays, in scene units: what is farther away does not occlude.
    #[must_use]
    pub fn reach(self) -> f32 {
        match self {
            Self::S2 | Self::S46 | Self::S500 => 2.0,
            _ => 0.3,
        }
    }

    /// Fails if the spheres and their tree would not fit into memory.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory) if they do not fit.
    pub fn check_room(self) -> Result<()> {
        match self {
            Self::Uniform(count) => memory::require(
                u64::from(count) * BYTES_PER_SPHERE,
                &format!("making {count} spheres and their tree"),
            ),
            Self::S2
            | Self::S46
            | Self::S500
            | Self::Lattice
            | Self::LatticeRotated
            | Self::Clustered => Ok(()),
        }
    }

    /// Makes the scene for an image of this size.
    ///
    /// # Errors
    ///
    /// As [`Self::check_room`].
    pub fn make(self, width: u32, height: u32) -> Result<Scene> {
        self.check_room()?;
        let mut scene = match self {
            Self::S2 => Scene {
                view: Some(View {
                    eye: Vec3::ZERO,
                    target: Vec3::NEG_Z,
                    up: Vec3::Y,
                    vertical_fov: 90.0,
                }),
                ..Scene::new(world_of([
                    Sphere::new(Vec3::new(0.0, 0.0, -1.0), 0.5),
                    Sphere::new(Vec3::new(0.0, -100.5, -1.0), 100.0),
                ]))
            },
            Self::S46 => Scene {
                view: Some(View {
                    eye: Vec3::new(0.0, 3.0, 9.0),
                    target: Vec3::new(0.0, 0.5, 0.0),
                    up: Vec3::Y,
                    vertical_fov: 45.0,
                }),
                ..Scene::new(world_of(balls_on_a_ground(45)))
            },
            Self::S500 => {
                let text = include_str!("../../scenes/one-weekend.toml");
                toml::parse("one-weekend.toml".as_ref(), text.into())?
            }
            Self::Uniform(count) => cube(uniform(count), View::straight()),
            Self::Lattice => cube(lattice(), View::straight()),
            Self::LatticeRotated => cube(lattice(), View::from_a_corner()),
            Self::Clustered => cube(clustered(), View::straight()),
        };
        (scene.width, scene.height) = (width, height);
        Ok(scene)
    }
}

/// A scene to time: one of [`BenchScene::ALL`], another number of spheres, or a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A world that is made.
    Made(BenchScene),
    /// A file that is read.
    File(PathBuf),
}

impl Source {
    /// The scene with this name. A file must exist, but is not read yet.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`](crate::Error::Scene) for a name that is neither.
    pub fn named(name: &str) -> Result<Self> {
        if let Some(scene) = BenchScene::named(name) {
            return Ok(Self::Made(scene));
        }
        let path = Path::new(name);
        if path.exists() && !path.is_dir() {
            return Ok(Self::File(path.into()));
        }
        let names = BenchScene::ALL.map(BenchScene::name);
        let is_count =
            name.starts_with(['R', 'r']) && name[1..].starts_with(|c: char| c.is_ascii_digit());
        let (message, likely) = if is_count {
            let most = Node::MAX_SPHERES;
            (
                format!("`{name}` is not R and a number of spheres from 1 to {most}"),
                None,
            )
        } else if path.is_dir() {
            (format!("`{name}` is a folder"), None)
        } else if path.extension().is_some() {
            (format!("there is no file `{name}`"), None)
        } else {
            let likely = nearest(name, names.iter().map(String::as_str));
            (format!("there is no bench scene `{name}`"), likely)
        };
        let likely = likely.map_or_else(String::new, |name| format!("did you mean {name}? Or "));
        Err(SceneError::without_place(
            "",
            message,
            format!(
                "{likely}give one of {}, R and another number of spheres such as R300k, or a {}",
                names.join(", "),
                read::inputs()
            ),
        )
        .into())
    }

    /// The scene for an image of this size, and the length of its ambient rays in scene units.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`](crate::Error::Scene) for an invalid file, and the errors of
    /// [`BenchScene::make`].
    pub fn load(&self, width: u32, height: u32) -> Result<(Scene, f32)> {
        let path = match self {
            Self::Made(scene) => return Ok((scene.make(width, height)?, scene.reach())),
            Self::File(path) => path,
        };
        let mut scene = Scene::load(path)?;
        scene.require_spheres_alone("bench")?;
        (scene.width, scene.height) = (width, height);
        let (mut low, mut high) = (Vec3::splat(f32::MAX), Vec3::splat(f32::MIN));
        for sphere in &scene.world.spheres {
            low = low.min(sphere.center());
            high = high.max(sphere.center());
        }
        // The same share of the world's size as for the cubes.
        let reach = 0.15 * (high - low).max_element().max(f32::MIN_POSITIVE);
        Ok((scene, reach))
    }
}

/// Loads the scene of this [name](Source::named).
///
/// # Errors
///
/// As [`Source::named`] and [`Source::load`].
pub fn load(name: &str, width: u32, height: u32) -> Result<(Scene, f32)> {
    Source::named(name)?.load(width, height)
}

impl View {
    /// From (0, 0, −3.5) along +z, with an image plane of half-height 0.5 at distance 1.
    fn straight() -> Self {
        Self {
            eye: Vec3::new(0.0, 0.0, -3.5),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov: 2.0 * 0.5_f64.atan().to_degrees(),
        }
    }

    /// From the same distance, but not along an axis of the cube.
    fn from_a_corner() -> Self {
        Self {
            eye: Vec3::new(1.3, 1.9, -2.64),
            ..Self::straight()
        }
    }
}

fn cube(spheres: Vec<Sphere>, view: View) -> Scene {
    Scene {
        view: Some(view),
        ..Scene::new(world_of(spheres))
    }
}

fn world_of(spheres: impl IntoIterator<Item = Sphere>) -> World {
    let mut world = World::default();
    let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
    world.spheres.extend(spheres);
    world.material_ids.resize(world.spheres.len(), grey);
    world
}

fn balls_on_a_ground(count: u32) -> Vec<Sphere> {
    let mut random = Random::new(46);
    let mut spheres = vec![Sphere::new(Vec3::new(0.0, -1000.0, 0.0), 1000.0)];
    spheres.extend((0..count).map(|_| {
        let radius = random.within(0.2, 0.6);
        let (x, z) = (random.within(-5.0, 5.0), random.within(-5.0, 5.0));
        Sphere::new(Vec3::new(x, radius, z), radius)
    }));
    spheres
}

fn uniform(count: u32) -> Vec<Sphere> {
    let mut random = Random::new(u64::from(count));
    let radius = (0.5 / f64::from(count).cbrt()) as f32;
    (0..count)
        .map(|_| Sphere::new(random.vec3(-1.0, 1.0), radius))
        .collect()
}

fn lattice() -> Vec<Sphere> {
    const SIDE: u32 = 100;
    let at = |index: u32| (2 * index + 1) as f32 / SIDE as f32 - 1.0;
    (0..SIDE.pow(3))
        .map(|index| {
            let (x, y, z) = (index % SIDE, index / SIDE % SIDE, index / SIDE.pow(2));
            Sphere::new(Vec3::new(at(x), at(y), at(z)), 0.4 / SIDE as f32)
        })
        .collect()
}

fn clustered() -> Vec<Sphere> {
    const COUNT: u32 = 1_000_000;
    let mut random = Random::new(1);
    let mut spheres = vec![Sphere::new(Vec3::ZERO, 4.0)];
    spheres.extend((1..COUNT).map(|index| {
        // A tenth of the side is a thousandth of the volume.
        let side = if index % 10 == 0 { 1.0 } else { 0.1 };
        let radius = random.log_within(1e-6, 1e-2) * side;
        Sphere::new(random.vec3(-side, side), radius)
    }));
    spheres
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_scenes_files_or_refused_with_the_nearest() {
        let made = |name| Source::named(name).expect(name);
        assert_eq!(made("r1m"), Source::Made(BenchScene::Uniform(1_000_000)));
        assert_eq!(made("R300k"), Source::Made(BenchScene::Uniform(300_000)));
        let file = "scenes/c60.xyz";
        assert_eq!(made(file), Source::File(file.into()));
        for (wrong, help) in [
            ("L1M-rotatd", "did you mean L1M-rotated?"),
            ("S5000", "did you mean S500?"),
            ("nope.toml", "or a scene (.toml)"),
            ("", "give one of S2"),
            ("scenes", "or a scene (.toml)"),
            ("R0", "R300k"),
            ("R-1", "R300k"),
            // More than a tree can index, and more than 32 bits hold.
            ("R2000M", "R300k"),
            ("R5000M", "R300k"),
        ] {
            let error = Source::named(wrong).expect_err(wrong);
            assert!(error.is_input() && error.help().contains(help), "{error:?}");
        }
    }
}
