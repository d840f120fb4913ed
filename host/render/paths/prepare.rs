//! [`Prepared`]: what the kernel is told of a scene.

use std::borrow::Cow;
use std::f32::consts::PI;
use std::sync::LazyLock;

use glam::{DVec3, UVec4, Vec3, Vec4};
use spherule_kernel::color::luminance;
use spherule_kernel::fog::Fog;
use spherule_kernel::material::microfacet::{ALBEDO_LEN, Albedo};
use spherule_kernel::path::caustic::casters::Entry;
use spherule_kernel::{Effects, Hit, Light, PathLaunch};

use super::lights::lights;
use super::rebase::rebased;
use crate::accel::{self, Acceleration, Nodes, ShapeTree};
use crate::error::Result;
use crate::render::EffectChoice;
use crate::render::whole_image;
use crate::scene::surroundings::EnvironmentImage;
use crate::scene::{Scene, World};

/// What the kernel is told of a scene, besides its world.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The world, in the order of the tree's leaves if there is a tree. The materials of shapes
    /// follow those of spheres.
    pub world: World,
    /// The nodes of the tree; empty if there is none.
    pub nodes: Nodes,
    /// The shapes beside the spheres, and the tree over them.
    pub shapes: ShapeTree,
    /// The launch that covers the whole image and no samples yet.
    pub launch: PathLaunch,
    /// For each sphere and then for each shape, how it moves; empty if none does.
    pub velocities: Vec<Vec4>,
    /// The lights that are looked for.
    pub lights: Vec<Light>,
    /// The tables of rough metal, of the environment, and of what casts caustics.
    pub tables: Vec<f32>,
    /// The channels of the environment, three a texel.
    pub texels: Vec<f32>,
    /// The effects that the image shows.
    pub shown: Effects,
    /// The effects that the pipeline is compiled for.
    pub compiled: Effects,
    /// Samples a pixel.
    pub samples: u32,
}

impl Prepared {
    /// Prepares `scene`.
    ///
    /// # Errors
    ///
    /// As [`whole_image`].
    pub fn new(scene: &Scene, choice: EffectChoice, acceleration: Acceleration) -> Result<Self> {
        let mut whole = whole_image(scene)?;
        let moved = rebased(scene);
        let scene = moved.as_ref().unwrap_or(scene);
        if moved.is_some() {
            whole = whole_image(scene)?;
        }
        let called = scene.effects();
        let shown = choice.shown(called);
        let view = scene.view_or_framed();
        let lens = scene.lens;
        // Without motion blur spheres are where they are at time 0.
        let shutter = if shown.any(Effects::MOTION_BLUR) {
            lens.shutter
        } else {
            (0.0, 0.0)
        };
        let world = scene.world.without_copies();
        let mut world = Cow::Borrowed(world.as_ref().unwrap_or(&scene.world));
        if shown.any(Effects::NESTED_GLASS) {
            world = Cow::Owned(world.with_absolute_glass());
        }
        let shapes = ShapeTree::of(&world, shutter);
        let (mut world, nodes) = match accel::build(
            &world.spheres,
            &world.velocities,
            shutter,
            acceleration.min_spheres(accel::MIN_SPHERES),
        ) {
            Some(tree) => (tree.sort_world(&world), tree.nodes),
            None => (world.into_owned(), Nodes::default()),
        };
        let (lights, sky, sphere_light_probability) = lights(scene, &world, shutter, shown);
        let (mut tables, texels) = tables(scene, shown);
        let first_caster = add_casters(&world, shown, &mut tables);
        let launch = PathLaunch {
            camera: whole.camera,
            image_size: whole.image_size,
            tile_origin: whole.tile_origin,
            tile_size: whole.tile_size,
            seed: scene.sampling.seed,
            max_bounces: scene.sampling.max_bounces,
            lens_radius: 0.5 * lens.aperture,
            focus_distance: lens
                .focus_distance
                .unwrap_or_else(|| view.eye.distance(view.target)),
            shutter_open: lens.shutter.0,
            shutter_close: lens.shutter.1,
            ambient_distance: scene.sampling.ambient_occlusion.unwrap_or(0.0),
            sphere_light_probability,
            called_effects: shown.to_bits(),
            has_ambient_sky: scene.sky.is_some().into(),
            first_caster,
            first_shape: world.spheres.len() as u32,
            has_plain_sky: u32::from(has_plain_sky(scene) || scene.has_glowing_shapes()),
            indirect_limit: scene.sampling.clamp.unwrap_or(0.0),
            glass_at_eye: glass_at_eye(&world, view.eye),
            sky,
            fog: fog(scene, view.eye),
            filter: scene.sampling.filter,
            ..PathLaunch::default()
        };
        let velocities = velocities(&world, &shapes, shown);
        world.material_ids.resize(world.spheres.len(), 0);
        world.material_ids.extend(&shapes.material_ids);
        Ok(Self {
            world,
            nodes,
            shapes,
            launch,
            velocities,
            lights,
            tables,
            texels,
            shown,
            compiled: choice.compiled(called),
            samples: if shown.any(Effects::ANTIALIASING) {
                scene.samples()
            } else {
                1
            },
        })
    }
}

/// How each sphere and then each shape moves; empty if none does.
fn velocities(world: &World, shapes: &ShapeTree, shown: Effects) -> Vec<Vec4> {
    if !shown.any(Effects::MOTION_BLUR) {
        return Vec::new();
    }
    let mut velocities: Vec<Vec4> = world.velocities.iter().map(|v| v.extend(0.0)).collect();
    if !shapes.velocities.is_empty() {
        velocities.resize(world.spheres.len(), Vec4::ZERO);
        velocities.extend(shapes.velocities.iter().map(|v| v.extend(0.0)));
    }
    velocities
}

/// The glass spheres that hold the eye, as [`PathLaunch::glass_at_eye`] has them.
fn glass_at_eye(world: &World, eye: Vec3) -> UVec4 {
    let mut around = world.glass_around(eye);
    around.resize(4, Hit::NONE_SPHERE);
    UVec4::from_slice(&around)
}

/// Appends the table of the spheres that cast caustics, and returns where it begins.
fn add_casters(world: &World, shown: Effects, tables: &mut Vec<f32>) -> u32 {
    let first = tables.len() as u32;
    if shown.any(Effects::CAUSTICS) {
        let casters = world.casters(shown.any(Effects::NESTED_GLASS));
        tables.extend(Entry::table(&casters));
    }
    first
}

/// Whether light comes from a sky that is not an image.
fn has_plain_sky(scene: &Scene) -> bool {
    match &scene.sky {
        Some(sky) => sky.is_plain_light(),
        None => scene.background != Vec3::ZERO,
    }
}

/// The medium, in the ball that it is said to fill or else in the one around the box of everything.
fn fog(scene: &Scene, eye: Vec3) -> Fog {
    let Some(fog) = scene.fog else {
        return Fog::default();
    };
    let mut medium = fog.medium;
    if medium.radius == 0.0 {
        let eye = eye.as_dvec3();
        let (mut low, mut high) = (eye, eye);
        for sphere in &scene.world.spheres {
            let center = sphere.center().as_dvec3();
            let radius = DVec3::splat(sphere.radius().into());
            low = low.min(center - radius);
            high = high.max(center + radius);
        }
        for shape in &scene.world.shapes {
            let (lowest, highest) = shape.bounds();
            low = low.min(lowest.as_dvec3());
            high = high.max(highest.as_dvec3());
        }
        medium.center = ((low + high) * 0.5).as_vec3();
        medium.radius = ((high - low).length() * 0.5) as f32;
    }
    medium
}

/// The tables, and the texels of the environment.
fn tables(scene: &Scene, shown: Effects) -> (Vec<f32>, Vec<f32>) {
    let (mut tables, mut texels) = (Vec::new(), Vec::new());
    if shown.any(Effects::ROUGH_METAL.and(Effects::PLASTIC)) {
        // It takes a fifth of a second.
        static ALBEDO: LazyLock<[f32; ALBEDO_LEN]> = LazyLock::new(Albedo::table);
        tables.extend_from_slice(&*ALBEDO);
    }
    if shown.any(Effects::ENVIRONMENT)
        && let Some(image) = scene.sky.as_ref().and_then(|sky| sky.image.as_ref())
    {
        tables.resize(ALBEDO_LEN, 1.0);
        environment(image, &mut tables);
        texels = bytemuck::cast_slice(&image.texels).to_vec();
    }
    (tables, texels)
}

/// The cumulative probabilities of rows and of texels in rows.
///
/// A texel counts by its solid angle and by the mean luminance of what is shown in it, which is
/// linear between the middles of texels: ¾ of the texel's own and ⅛ of each neighbour's, along both
/// axes. It never counts for nothing.
fn environment(image: &EnvironmentImage, tables: &mut Vec<f32>) {
    let (width, height) = (image.width as usize, image.height as usize);
    let light = |row: usize, column: usize| {
        let texel =
            |row: usize, column: usize| f64::from(luminance(image.texels[row * width + column]));
        let (before, after) = ((column + width - 1) % width, (column + 1) % width);
        let across = |row: usize| {
            0.75 * texel(row, column) + 0.125 * (texel(row, before) + texel(row, after))
        };
        let (above, below) = (row.saturating_sub(1), (row + 1).min(height - 1));
        0.75 * across(row) + 0.125 * (across(above) + across(below))
    };
    let mut rows = Vec::with_capacity(height);
    let mut columns = Vec::with_capacity(width * height);
    let mut total = 0.0;
    for row in 0..height {
        let half = 0.5 * f64::from(PI) / height as f64;
        let solid = 2.0 * (half * (2 * row + 1) as f64).sin() * half.sin();
        let weights: Vec<f64> = (0..width)
            .map(|column| light(row, column).max(1e-12))
            .collect();
        let sum: f64 = weights.iter().sum();
        let mut cumulative = 0.0;
        columns.extend(weights.iter().map(|weight| {
            cumulative += weight;
            (cumulative / sum) as f32
        }));
        total += sum * solid;
        rows.push(total);
    }
    tables.extend(rows.iter().map(|sum| (sum / total) as f32));
    tables.extend(columns);
}
