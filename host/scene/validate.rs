//! [`Scene::validate`]: a scene that a program made is held to what a scene file is.

use std::fmt::Display;

use glam::Vec3;
use rayon::prelude::*;
use spherule_kernel::filter::Filter;
use spherule_kernel::{Material, Sphere};

use super::limits::{self, Range};
use super::shapes::{validate_glass, validate_shapes};
use super::world::{GRAIN, World};
use super::{GlassShadows, Scene, Surroundings, View};
use crate::error::{Error, Result};

impl Scene {
    /// Whether the scene can be rendered: every number is in its range of [`limits`], every index
    /// names something, and what runs in parallel is as long as it must be. That is all that a
    /// scene file is refused for, but that a scene without spheres is taken here: a frame of a
    /// simulation may be empty.
    ///
    /// [`render`](crate::render::render()) asks this first.
    ///
    /// ```
    /// use spherule::kernel::{Sphere, glam::Vec3};
    /// use spherule::{Scene, scene::World};
    ///
    /// let mut scene = Scene::new(World::default());
    /// scene.world.add(Sphere::new(Vec3::ZERO, -1.0), 0);
    /// let error = scene.validate().expect_err("no material, and no radius");
    /// assert!(error.to_string().contains("material"), "{error}");
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] says what is wrong, and how to mend it.
    pub fn validate(&self) -> Result<()> {
        for (name, side) in [("width", self.width), ("height", self.height)] {
            whole(name, side, 1, limits::MAX_IMAGE_SIDE)?;
        }
        all("the background", self.background, limits::RADIANCE)?;
        self.validate_lens()?;
        if let Some(sky) = &self.sky {
            validate_sky(sky)?;
        }
        if let Some(fog) = self.fog {
            let medium = fog.medium;
            if medium.radius != 0.0 {
                all("the fog's center", medium.center, limits::COORDINATE)?;
                one("the fog's radius", medium.radius, limits::RADIUS)?;
            }
            all("the fog's albedo", medium.albedo, limits::REFLECTANCE)?;
            one(
                "the fog's extinction",
                medium.extinction,
                limits::EXTINCTION,
            )?;
            one(
                "the fog's anisotropy",
                medium.anisotropy,
                limits::ANISOTROPY,
            )?;
        }
        for (index, light) in self.lights.iter().enumerate() {
            let of = |what| format!("{what} of light {index}");
            all(of("the position"), light.position, limits::COORDINATE)?;
            all(of("the intensity"), light.intensity, limits::INTENSITY)?;
        }
        let sampling = self.sampling;
        if let Some(samples) = sampling.samples {
            whole("samples", samples, 1, limits::MAX_SAMPLES)?;
        }
        let bounces = sampling.max_bounces;
        whole("max_bounces", bounces, 0, limits::MAX_BOUNCES)?;
        if let Some(distance) = sampling.ambient_occlusion {
            one("ambient_occlusion", distance, limits::AMBIENT_OCCLUSION)?;
        }
        if let Some(limit) = sampling.clamp {
            one("clamp", limit, limits::CLAMP)?;
        }
        if sampling.caustics && sampling.glass_shadows == GlassShadows::Clear {
            return Err(Error::of_scene(
                "clear shadows of glass and caustics both let light through it",
                "take one: [image] glass_shadows = \"clear\", or caustics = true",
            ));
        }
        validate_filter(sampling.filter)?;
        one("the exposure", self.develop.exposure, limits::EXPOSURE)?;
        if let Some(view) = &self.view {
            validate_view(view)?;
        }
        validate_world(&self.world, self.lens.shutter)?;
        validate_glass(self)
    }

    fn validate_lens(&self) -> Result<()> {
        let lens = self.lens;
        one("the aperture", lens.aperture, limits::APERTURE)?;
        if let Some(distance) = lens.focus_distance {
            one("the focus distance", distance, limits::FOCUS_DISTANCE)?;
        }
        let (open, close) = lens.shutter;
        one("the time when the shutter opens", open, limits::TIME)?;
        one("the time when the shutter closes", close, limits::TIME)?;
        if open > close {
            return Err(Error::of_scene(
                format!("the shutter closes at {close}, before it opens at {open}"),
                "give the earlier time first",
            ));
        }
        Ok(())
    }
}

fn validate_filter(filter: Filter) -> Result<()> {
    one("the filter's width", filter.width, limits::FILTER_WIDTH)?;
    if filter.kind <= Filter::BLACKMAN_HARRIS {
        return Ok(());
    }
    Err(Error::of_scene(
        format!(
            "the filter is of the kind {}, which there is not",
            filter.kind
        ),
        "take one of Filter::NAMED, or make it of Filter's constants",
    ))
}

fn validate_sky(sky: &Surroundings) -> Result<()> {
    all("the sky's horizon", sky.horizon, limits::RADIANCE)?;
    all("the sky's zenith", sky.zenith, limits::RADIANCE)?;
    if let Some(sun) = &sky.sun {
        let length = sun.direction.as_dvec3().length();
        if !(0.999..1.001).contains(&length) {
            return Err(Error::of_scene(
                format!(
                    "the direction towards the sun, {}, is no unit vector",
                    sun.direction
                ),
                "normalise it",
            ));
        }
        one("the angle across the sun", sun.size, limits::SUN_SIZE)?;
        all("the sun's irradiance", sun.irradiance, limits::IRRADIANCE)?;
        if let Some(radiance) = sun.radiance() {
            all("the radiance of the sun's disc", radiance, limits::RADIANCE)?;
        }
    }
    one("the rotation of the sky", sky.rotation, limits::ROTATION)?;
    let Some(image) = &sky.image else {
        return Ok(());
    };
    let texels = u64::from(image.width) * u64::from(image.height);
    if texels == 0 || texels > limits::MAX_TEXELS || texels != image.texels.len() as u64 {
        return Err(Error::of_scene(
            format!(
                "the image of the surroundings is {} × {} and holds {} texels",
                image.width,
                image.height,
                image.texels.len()
            ),
            format!(
                "give width × height texels, one at least, {} at most",
                limits::MAX_TEXELS
            ),
        ));
    }
    let is_wrong = |texel: &Vec3| !limits::RADIANCE.holds_all(*texel);
    match image
        .texels
        .par_iter()
        .with_min_len(GRAIN)
        .position_any(is_wrong)
    {
        None => Ok(()),
        Some(index) => all(
            format!("texel {index} of the surroundings"),
            image.texels[index],
            limits::RADIANCE,
        ),
    }
}

fn validate_view(view: &View) -> Result<()> {
    all("the eye", view.eye, limits::COORDINATE)?;
    all("the target", view.target, limits::COORDINATE)?;
    all("up", view.up, limits::COORDINATE)?;
    if !limits::is_vertical_fov(view.vertical_fov) {
        return Err(Error::of_scene(
            format!(
                "a vertical_fov of {} degrees is not possible",
                view.vertical_fov
            ),
            "give an angle in degrees above 0 and below 180, for example 40",
        ));
    }
    match view.camera(1.0) {
        Some(_) => Ok(()),
        None => Err(Error::of_scene(
            "the scene's camera is degenerate",
            "move eye and target apart, and give an up that is not along the view",
        )),
    }
}

fn validate_world(world: &World, shutter: (f32, f32)) -> Result<()> {
    let count = world.spheres.len();
    if count > limits::MAX_SPHERES {
        return Err(Error::of_scene(
            format!("the world has {count} spheres"),
            format!("{} are the most", limits::MAX_SPHERES),
        ));
    }
    if world.material_ids.len() != count {
        return Err(Error::of_scene(
            format!(
                "the world has {count} spheres and {} material indices",
                world.material_ids.len()
            ),
            "give each sphere the index of its material; World::add keeps the two in step",
        ));
    }
    let moves = !world.velocities.is_empty();
    if moves && world.velocities.len() != count {
        return Err(Error::of_scene(
            format!(
                "the world has {count} spheres and {} velocities",
                world.velocities.len()
            ),
            "give each sphere a velocity, or none any; World::add_moving keeps the two in step",
        ));
    }
    let has_material = |id: &u32| (*id as usize) < world.materials.len();
    let ids = world.material_ids.par_iter().with_min_len(GRAIN);
    if let Some(index) = ids.position_any(|id| !has_material(id)) {
        return Err(Error::of_scene(
            format!(
                "sphere {index} has the material {}, and the world has {} materials",
                world.material_ids[index],
                world.materials.len()
            ),
            "add the material first; World::add_material returns its index",
        ));
    }
    for (index, material) in world.materials.iter().enumerate() {
        validate_material(index, material)?;
    }
    validate_shapes(world, shutter)?;
    let velocity = |index: usize| world.velocities.get(index).copied().unwrap_or(Vec3::ZERO);
    let is_wrong = |index: &usize| {
        let sphere = &world.spheres[*index];
        let is_right = is_plain(sphere) && !moves;
        !is_right && validate_sphere(*index, sphere, velocity(*index), shutter).is_err()
    };
    let indices = (0..count).into_par_iter().with_min_len(GRAIN);
    match indices.find_any(is_wrong) {
        None => Ok(()),
        Some(index) => validate_sphere(index, &world.spheres[index], velocity(index), shutter),
    }
}

/// Whether a sphere at rest is right, by few operations; nearly all are.
fn is_plain(sphere: &Sphere) -> bool {
    let size = sphere.to_vec4().abs().max_element();
    sphere.radius() >= f32::MIN_POSITIVE && size < 0.25 * limits::MAX_LENGTH && sphere.is_valid()
}

fn validate_sphere(
    index: usize,
    sphere: &Sphere,
    velocity: Vec3,
    shutter: (f32, f32),
) -> Result<()> {
    let of = |what| format!("{what} of sphere {index}");
    all(of("the center"), sphere.center(), limits::COORDINATE)?;
    one(of("the radius"), sphere.radius(), limits::RADIUS)?;
    all(of("the velocity"), velocity, limits::COORDINATE)?;
    if !limits::is_within(sphere, velocity, shutter) {
        return Err(Error::of_scene(
            format!("sphere {index} reaches beyond {:e}", limits::MAX_LENGTH),
            "make it smaller, or move it towards the origin",
        ));
    }
    Ok(())
}

fn validate_material(index: usize, material: &Material) -> Result<()> {
    let of = |what| format!("{what} of material {index}");
    match material.kind {
        Material::DIFFUSE => all(of("the color"), material.color, limits::REFLECTANCE),
        Material::METAL => {
            all(of("the color"), material.color, limits::REFLECTANCE)?;
            // The square of a roughness.
            one(of("α"), material.parameter, limits::ROUGHNESS)
        }
        Material::GLASS => {
            one(of("the index"), material.parameter, limits::INDEX)?;
            all(of("the absorption"), material.volume, limits::ABSORPTION)
        }
        Material::BUBBLE => {
            let index_outside = 1.0 / material.parameter;
            one(of("the index"), index_outside, limits::INDEX)?;
            all(of("the absorption"), material.volume, limits::ABSORPTION)
        }
        Material::PLASTIC => {
            all(of("the color"), material.color, limits::REFLECTANCE)?;
            one(of("α"), material.parameter, limits::ROUGHNESS)?;
            one(of("the index"), material.volume.x, limits::COAT_INDEX)
        }
        Material::EMISSIVE => all(of("the radiance"), material.volume, limits::RADIANCE),
        kind => Err(Error::of_scene(
            format!("material {index} is of the kind {kind}, which there is not"),
            "make materials by Material's functions: diffuse, metal, plastic, glass, bubble, emissive",
        )),
    }
}

fn whole(name: &str, number: u32, low: u32, high: u32) -> Result<()> {
    if (low..=high).contains(&number) {
        return Ok(());
    }
    Err(Error::of_scene(
        format!("{name} = {number} is not possible"),
        format!("give a whole number from {low} to {high}"),
    ))
}

fn one(name: impl Display, number: f32, range: Range) -> Result<()> {
    if range.holds(number) {
        return Ok(());
    }
    Err(Error::of_scene(
        format!("{name} is {number}, which is not possible"),
        format!("give a number {range}"),
    ))
}

fn all(name: impl Display, numbers: Vec3, range: Range) -> Result<()> {
    if range.holds_all(numbers) {
        return Ok(());
    }
    Err(Error::of_scene(
        format!("{name} is {numbers}, which is not possible"),
        format!("give three numbers {range}"),
    ))
}

#[cfg(test)]
mod tests {
    use spherule_kernel::fog::Fog;

    use super::super::surroundings::{EnvironmentImage, FogBall, PointLight, Sun};
    use super::*;

    fn scene() -> Scene {
        let mut world = World::default();
        let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
        let glass = world.add_material(Material::glass(1.5, Vec3::ZERO));
        world.add(Sphere::new(Vec3::ZERO, 1.0), grey);
        world.add_moving(Sphere::new(Vec3::X, 0.5), glass, Vec3::Y);
        Scene::new(world)
    }

    fn sky() -> Surroundings {
        Surroundings {
            horizon: Vec3::ONE,
            zenith: Vec3::ONE,
            sun: Some(Sun {
                direction: Vec3::Y,
                size: 0.5,
                irradiance: Vec3::ONE,
            }),
            rotation: 0.0,
            image: None,
        }
    }

    /// What is wrong with a scene, and a word of the sentence that says so.
    type Mistake = (&'static str, fn(&mut Scene));

    #[test]
    #[expect(clippy::too_many_lines, reason = "one table, an entry a mistake")]
    fn what_a_scene_file_is_refused_for_a_scene_is() {
        assert!(scene().validate().is_ok());
        let mistakes: &[Mistake] = &[
            ("width", |s| s.width = 0),
            ("height", |s| s.height = 65_537),
            ("background", |s| s.background.y = f32::NAN),
            ("aperture", |s| s.lens.aperture = -1.0),
            ("focus", |s| s.lens.focus_distance = Some(0.0)),
            ("shutter", |s| s.lens.shutter = (1.0, 0.0)),
            ("shutter", |s| s.lens.shutter = (0.0, f32::INFINITY)),
            ("horizon", |s| {
                s.sky = Some(Surroundings {
                    horizon: Vec3::NEG_ONE,
                    ..sky()
                });
            }),
            ("sun", |s| {
                let mut sky = sky();
                sky.sun = sky.sun.map(|sun| Sun {
                    direction: Vec3::ZERO,
                    ..sun
                });
                s.sky = Some(sky);
            }),
            ("texels", |s| {
                s.sky = Some(Surroundings {
                    rotation: 0.0,
                    image: Some(EnvironmentImage {
                        width: 2,
                        height: 2,
                        texels: vec![Vec3::ONE; 3],
                    }),
                    ..sky()
                });
            }),
            ("texel 1", |s| {
                s.sky = Some(Surroundings {
                    rotation: 0.0,
                    image: Some(EnvironmentImage {
                        width: 2,
                        height: 1,
                        texels: vec![Vec3::ONE, Vec3::NAN],
                    }),
                    ..sky()
                });
            }),
            ("extinction", |s| {
                s.fog = Some(FogBall {
                    medium: Fog::default(),
                });
            }),
            ("intensity", |s| {
                s.lights.push(PointLight {
                    position: Vec3::ZERO,
                    intensity: Vec3::splat(f32::INFINITY),
                });
            }),
            ("samples", |s| s.sampling.samples = Some(0)),
            ("max_bounces", |s| s.sampling.max_bounces = u32::MAX),
            ("ambient", |s| s.sampling.ambient_occlusion = Some(f32::NAN)),
            ("clamp", |s| s.sampling.clamp = Some(0.0)),
            ("both let light through", |s| {
                s.sampling.caustics = true;
                s.sampling.glass_shadows = GlassShadows::Clear;
            }),
            ("filter's width", |s| s.sampling.filter.width = 0.0),
            ("filter is of the kind 3", |s| s.sampling.filter.kind = 3),
            ("exposure", |s| s.develop.exposure = 1e9),
            ("vertical_fov", |s| {
                s.view = Some(View {
                    vertical_fov: 180.0,
                    ..View::framing(&s.world.spheres, 1.0)
                });
            }),
            ("degenerate", |s| {
                s.view = Some(View {
                    up: Vec3::ZERO,
                    ..View::framing(&s.world.spheres, 1.0)
                });
            }),
            ("center of sphere 1", |s| {
                s.world.spheres[1] = Sphere::new(Vec3::NAN, 1.0);
            }),
            ("radius of sphere 0", |s| {
                s.world.spheres[0] = Sphere::new(Vec3::ZERO, -1.0);
            }),
            ("radius of sphere 0", |s| {
                s.world.velocities.clear();
                s.world.spheres[0] = Sphere::new(Vec3::ZERO, f32::NAN);
            }),
            ("beyond", |s| {
                s.world.velocities[0] = Vec3::splat(9e17);
                s.world.spheres[0] = Sphere::new(Vec3::splat(9e17), 1.0);
            }),
            ("velocities", |s| s.world.velocities.truncate(1)),
            ("material indices", |s| s.world.material_ids.truncate(1)),
            ("the material 7", |s| s.world.material_ids[1] = 7),
            ("color of material 0", |s| {
                s.world.materials[0].color = Vec3::splat(5.0);
            }),
            ("index of material 1", |s| {
                s.world.materials[1].parameter = 0.0;
            }),
            ("kind 9", |s| s.world.materials[0].kind = 9),
            ("radiance of material 0", |s| {
                s.world.materials[0] = Material::emissive(Vec3::splat(1e30));
            }),
        ];
        for (word, make) in mistakes {
            let mut scene = scene();
            scene.lens.shutter = (0.0, 1.0);
            make(&mut scene);
            let error = scene.validate().expect_err(word).to_string();
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}
