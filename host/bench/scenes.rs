//! The worlds that are timed: each made from a fixed seed, so that anybody times the same.

use glam::Vec3;
use spherule_kernel::{Material, Sphere};

use crate::accuracy::random::Random;
use crate::error::{Result, SceneError};
use crate::scene::{Scene, View, World, toml_file};

/// A world that is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchScene {
    /// Two spheres: a ball on a ground.
    S2,
    /// 45 balls on a ground.
    S46,
    /// The last picture of Ray Tracing in One Weekend, about 500 balls.
    S500,
    /// So many balls, uniform in the cube from −1 to 1, of radius 0.5 N^(−1/3).
    Uniform(u32),
    /// A lattice of 100³ balls that do not touch, seen along an axis.
    Lattice,
    /// The same, seen along no axis.
    LatticeRotated,
    /// A million balls of radii over four decades, nine tenths of them in a thousandth of the volume, inside of
    /// one that encloses all.
    Clustered,
}

impl BenchScene {
    /// Every one, the small first.
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

    /// The name, as the command line takes it.
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

    /// The scene with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let listed = Self::ALL
            .into_iter()
            .find(|scene| scene.name().eq_ignore_ascii_case(name));
        listed.or_else(|| {
            // Any other number of balls.
            let number = name.strip_prefix(['R', 'r'])?;
            let (number, unit) = if let Some(thousands) = number.strip_suffix('k') {
                (thousands, 1000)
            } else if let Some(millions) = number.strip_suffix('M') {
                (millions, 1_000_000)
            } else {
                (number, 1)
            };
            let count = number.parse::<u32>().ok()?.checked_mul(unit)?;
            (count > 0).then_some(Self::Uniform(count))
        })
    }

    /// How far away something must be, in scene units, to be no ambient occluder.
    #[must_use]
    pub fn reach(self) -> f32 {
        match self {
            Self::S2 | Self::S46 | Self::S500 => 2.0,
            _ => 0.3,
        }
    }

    /// Makes the scene for an image of this size.
    ///
    /// # Errors
    ///
    /// None but for mistakes of spherule's own: the scene files that it carries are sound.
    pub fn make(self, width: u32, height: u32) -> Result<Scene> {
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
                toml_file::parse("one-weekend.toml".as_ref(), text.into())?
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

/// The scene that was named: one of [`BenchScene::ALL`], or a file.
///
/// # Errors
///
/// [`Error::Scene`](crate::Error::Scene) for a file that is wrong, and for a name of neither.
pub fn load(name: &str, width: u32, height: u32) -> Result<(Scene, f32)> {
    if let Some(scene) = BenchScene::named(name) {
        return Ok((scene.make(width, height)?, scene.reach()));
    }
    if !name.contains('.') {
        let names = BenchScene::ALL.map(BenchScene::name).join(", ");
        return Err(SceneError::without_place(
            name,
            "is no bench scene",
            format!(
                "give one of {names}, R and another number of spheres such as R300k, or a scene file (.toml, .pdb, .ent or .xyz)"
            ),
        )
        .into());
    }
    let mut scene = Scene::load(name)?;
    (scene.width, scene.height) = (width, height);
    let (mut low, mut high) = (Vec3::splat(f32::MAX), Vec3::splat(f32::MIN));
    for sphere in &scene.world.spheres {
        low = low.min(sphere.center());
        high = high.max(sphere.center());
    }
    // As much of it as of the cubes.
    let reach = 0.15 * (high - low).max_element().max(f32::MIN_POSITIVE);
    Ok((scene, reach))
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

    /// As far away, along no axis of the cube.
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
