//! Which effects a scene calls for, and by what.

use glam::Vec3;
use spherule_kernel::filter::Filter;
use spherule_kernel::material::microfacet::SMOOTHEST;
use spherule_kernel::surface::Surface;
use spherule_kernel::{Effects, Material, Sphere};

use super::surroundings::Sun;
use super::{GlassShadows, Sampling, Scene};
use crate::plural::count_of;
use crate::shown::shown;

/// An effect, and the sentence that says what calls for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Called {
    /// The effect, a set of one.
    pub effect: Effects,
    /// Its name.
    pub name: &'static str,
    /// What in the scene calls for it.
    pub by: String,
}

/// Effects whose images are random: more than one sample is the default.
const RANDOM: Effects = Effects::SOFT_SHADOWS
    .and(Effects::AMBIENT_OCCLUSION)
    .and(Effects::ROUGH_METAL)
    .and(Effects::PLASTIC)
    .and(Effects::GLASS)
    .and(Effects::INTERREFLECTION)
    .and(Effects::DEFOCUS)
    .and(Effects::MOTION_BLUR)
    .and(Effects::FOG)
    .and(Effects::ENVIRONMENT)
    .and(Effects::FILTER);

/// Effects that a picture says of itself, because they change the light on request.
const BIASED: Effects = Effects::CLEAR_SHADOWS.and(Effects::CLAMP);

/// What in a scene calls for an effect, if anything does.
type CalledBy = fn(&Asked<'_>) -> Option<String>;

/// What calls for each effect, in the order of [`Effects`]. Antialiasing, the headlamp, large
/// spheres and the clamp are not among them: what calls for those are the others.
const CALLS: &[(Effects, CalledBy)] = &[
    (Effects::HARD_SHADOWS, |asked| {
        let lights = asked.scene.lights.len();
        let by = match asked.sun() {
            _ if !asked.seeks_light() => None,
            _ if lights > 0 => Some(format!("{lights} [[light]] without a radius")),
            None => None,
            Some(sun) if sun.size > 0.0 => None,
            Some(_) => Some("[sky] sun_size = 0".into()),
        };
        // A path meets no light without extent behind glass.
        let shadow = match asked.glass {
            Some(_) if asked.scene.sampling.caustics => "; through one sphere of glass by caustics",
            Some(_) if !asked.has_clear_glass() => {
                "; behind glass it gives no light, unless [image] glass_shadows = \"clear\""
            }
            _ => "",
        };
        by.map(|by| by + shadow)
    }),
    (Effects::SOFT_SHADOWS, |asked| {
        match (asked.lamp, asked.sun()) {
            _ if !asked.seeks_light() => None,
            (Some(index), _) => Some(format!(
                "spheres of {} shine on others",
                asked.material(index)
            )),
            (None, Some(sun)) if sun.size > 0.0 => Some(format!("[sky] sun_size = {}", sun.size)),
            _ => None,
        }
    }),
    (Effects::AMBIENT_OCCLUSION, |asked| {
        asked.diffuse?;
        let distance = asked.scene.sampling.ambient_occlusion?;
        Some(format!("[image] ambient_occlusion = {distance}"))
    }),
    (Effects::MIRROR, |asked| {
        let material = asked.material(asked.mirror?);
        Some(format!("{material} is of kind metal, without roughness"))
    }),
    (Effects::ROUGH_METAL, |asked| {
        let material = asked.material(asked.rough?);
        Some(format!("{material} is of kind metal, with roughness"))
    }),
    (Effects::GLASS, |asked| {
        let material = asked.material(asked.glass?);
        Some(format!("{material} is of kind glass"))
    }),
    (Effects::EMISSION, |asked| {
        let material = asked.material(asked.glow?);
        Some(format!("{material} is of kind emissive"))
    }),
    (Effects::INTERREFLECTION, |asked| {
        let material = asked.material(asked.diffuse?);
        let sampling = &asked.scene.sampling;
        if sampling.ambient_occlusion.is_some() || !asked.scene.has_light() {
            return None;
        }
        if sampling.max_bounces > 0 {
            let times = count_of(sampling.max_bounces as usize, "time");
            return Some(format!(
                "{material} is of kind diffuse, and light may bounce {times}"
            ));
        }
        // A path meets the sky only where it goes on.
        let sky = asked.scene.sky.as_ref()?;
        sky.is_plain_light()
            .then(|| format!("the sky shines on {material}"))
    }),
    (Effects::DEFOCUS, |asked| {
        let aperture = asked.scene.lens.aperture;
        (aperture > 0.0).then(|| format!("[camera] aperture = {aperture}"))
    }),
    (Effects::MOTION_BLUR, |asked| {
        let (open, close) = asked.scene.lens.shutter;
        let velocities = &asked.scene.world.velocities;
        let others = &asked.scene.world.shape_velocities;
        let what = if others.is_empty() {
            "[[sphere]]"
        } else {
            "spheres and shapes"
        };
        let moving = velocities
            .iter()
            .chain(others)
            .filter(|v| **v != Vec3::ZERO)
            .count();
        ((open, close) != (0.0, 0.0) && moving > 0).then(|| {
            format!("{moving} {what} with a velocity, and [camera] shutter = [{open}, {close}]")
        })
    }),
    (Effects::FOG, |asked| {
        let fog = asked.scene.fog.as_ref()?;
        Some(format!("[fog] extinction = {}", fog.medium.extinction))
    }),
    (Effects::SKY_GRADIENT, |asked| {
        let sky = asked.scene.sky.as_ref()?;
        let is_gradient = sky.image.is_none() && sky.horizon != sky.zenith;
        is_gradient.then(|| "[sky] horizon and zenith differ".into())
    }),
    (Effects::SUN, |asked| {
        let size = asked.sun()?.size;
        (size > 0.0).then(|| format!("[sky] sun_size = {size}"))
    }),
    (Effects::ENVIRONMENT, |asked| {
        let image = asked.scene.sky.as_ref()?.image.as_ref();
        image.map(|_| "[sky] image".into())
    }),
    (Effects::TRANSPARENT_BACKGROUND, |asked| {
        let is_transparent = asked.scene.transparent;
        is_transparent.then(|| "[image] transparent = true".into())
    }),
    (Effects::PLASTIC, |asked| {
        let material = asked.material(asked.plastic?);
        Some(format!("{material} is of kind plastic"))
    }),
    (Effects::NESTED_GLASS, |asked| {
        asked.glass?;
        let scene = asked.scene;
        let eye = scene.view_or_framed().eye;
        if !scene.world.glass_around(eye).is_empty() {
            return Some("the eye is in glass".into());
        }
        let (first, second) = scene.world.overlapping_glass()?;
        Some(format!(
            "the glass of spheres {first} and {second} overlaps"
        ))
    }),
    (Effects::MANY_LIGHTS, |asked| {
        let lights = asked.scene.lights.len() + asked.count_of_glowing();
        // By caustics a lamp is chosen by its power.
        let is_listed = asked.scene.sampling.caustics;
        let is_many = asked.seeks_light() && lights >= MANY && !is_listed;
        is_many.then(|| format!("{lights} lights"))
    }),
    (Effects::CLEAR_SHADOWS, |asked| {
        let is_called = asked.has_clear_glass() && asked.seeks_light() && asked.has_hard_light();
        is_called.then(|| {
            "[image] glass_shadows = \"clear\": light passes glass without bending, which is biased"
                .into()
        })
    }),
    (Effects::FILTER, |asked| {
        let Sampling {
            filter, samples, ..
        } = asked.scene.sampling;
        if filter == Filter::default() || samples == Some(1) {
            return None;
        }
        let name = filter_name(filter)?;
        Some(format!(
            "[image] filter = \"{name}\", filter_width = {}",
            filter.width
        ))
    }),
    (Effects::CAUSTICS, |asked| {
        let sampling = &asked.scene.sampling;
        let lamps = asked.scene.lights.len();
        let has_lamp = lamps > 0 || asked.lamp.is_some() || asked.sun().is_some();
        let is_possible = sampling.max_bounces > 0 && has_lamp && asked.seeks_light();
        if !sampling.caustics || !is_possible {
            return None;
        }
        let material = asked.material(asked.mirror.or(asked.glass)?);
        Some(format!(
            "[image] caustics = true, and {material} throws light onto others"
        ))
    }),
];

/// So many lights are chosen by what they may give to a place, rather than by their power alone.
const MANY: usize = 8;

/// The largest share of a scene's smallest length by which points may be beside their spheres.
const VISIBLE: f32 = 1.0 / 256.0;

/// A scene, and the first material of each kind that a sphere has.
struct Asked<'a> {
    scene: &'a Scene,
    diffuse: Option<usize>,
    mirror: Option<usize>,
    rough: Option<usize>,
    glass: Option<usize>,
    plastic: Option<usize>,
    glow: Option<usize>,
    /// The same of spheres alone: other shapes are not looked for.
    lamp: Option<usize>,
}

impl<'a> Asked<'a> {
    fn of(scene: &'a Scene) -> Self {
        let metal = |roughness: fn(f32) -> bool| {
            scene.first_material(&|m| m.kind == Material::METAL && roughness(m.parameter))
        };
        Self {
            scene,
            diffuse: scene.first_of(Material::DIFFUSE),
            mirror: metal(|roughness| roughness < SMOOTHEST),
            rough: metal(|roughness| roughness >= SMOOTHEST),
            glass: scene
                .first_of(Material::GLASS)
                .or_else(|| scene.first_of(Material::BUBBLE)),
            plastic: scene.first_of(Material::PLASTIC),
            glow: scene.first_of(Material::EMISSIVE),
            lamp: scene.first_among(&|m| m.kind == Material::EMISSIVE, &scene.world.material_ids),
        }
    }

    /// Whether anything looks for light. Mirrors and glass do not.
    fn seeks_light(&self) -> bool {
        let surface = self.diffuse.or(self.rough).or(self.plastic);
        surface.is_some() || self.scene.fog.is_some()
    }

    /// How many spheres glow.
    fn count_of_glowing(&self) -> usize {
        if self.lamp.is_none() {
            return 0;
        }
        let world = &self.scene.world;
        let materials = world.materials.iter();
        let glows: Vec<bool> = materials
            .map(|material| material.kind == Material::EMISSIVE)
            .collect();
        let ids = world.material_ids.iter();
        ids.filter(|id| glows.get(**id as usize) == Some(&true))
            .count()
    }

    /// Whether there is glass that lets light without extent through.
    fn has_clear_glass(&self) -> bool {
        self.glass.is_some() && self.scene.sampling.glass_shadows == GlassShadows::Clear
    }

    /// Whether there is a light without extent.
    fn has_hard_light(&self) -> bool {
        !self.scene.lights.is_empty() || self.sun().is_some_and(|sun| sun.size == 0.0)
    }

    fn sun(&self) -> Option<Sun> {
        self.scene.sky.as_ref()?.sun
    }

    /// What a message calls a material.
    fn material(&self, index: usize) -> String {
        match self.scene.world.material_names.get(index) {
            Some(name) if !name.is_empty() => format!("material `{}`", shown(name)),
            _ => format!("material {index}"),
        }
    }
}

impl Scene {
    /// The effects that the scene calls for. Empty for a scene that one ray a pixel shows.
    #[must_use]
    pub fn effects(&self) -> Effects {
        self.called_effects()
            .iter()
            .fold(Effects::NONE, |set, called| set.and(called.effect))
    }

    /// The effects that the scene calls for, each with what calls for it.
    #[must_use]
    pub fn called_effects(&self) -> Vec<Called> {
        let mut called = self.called_but_sampling();
        let all = |called: &[Called]| {
            called
                .iter()
                .fold(Effects::NONE, |set, one| set.and(one.effect))
        };
        called.extend(self.antialiasing(all(&called)));
        called.extend(self.headlamp(all(&called)));
        called.extend(self.large_spheres(all(&called)));
        called.extend(self.clamp(all(&called)));
        called.sort_by_key(|called| called.effect.to_bits());
        called
    }

    /// Antialiasing, if a pixel of an image with `others` has several samples.
    fn antialiasing(&self, others: Effects) -> Option<Called> {
        let by = match self.sampling.samples {
            Some(samples) if samples > 1 => format!("[image] samples = {samples}"),
            None if self.is_random(others) => format!(
                "{} samples a pixel are the default where something is random",
                Sampling::DEFAULT_SAMPLES
            ),
            _ => return None,
        };
        Some(of(Effects::ANTIALIASING, by))
    }

    /// The lamp at the eye, if nothing else shines on what light paths with `others` show.
    fn headlamp(&self, others: Effects) -> Option<Called> {
        let is_lit = |m: &Material| matches!(m.kind, Material::DIFFUSE | Material::PLASTIC);
        let is_dark =
            !others.is_empty() && !self.has_light() && self.first_material(&is_lit).is_some();
        is_dark.then(|| {
            of(
                Effects::HEADLAMP,
                "the scene has no light: no [[light]], no [sky], nothing that glows, no ambient occlusion".into(),
            )
        })
    }

    /// What large spheres call for, if light paths with `others` leave them.
    fn large_spheres(&self, others: Effects) -> Option<Called> {
        // A plain scene has no need of two more passes over its spheres.
        if others.is_empty() {
            return None;
        }
        let (largest, smallest) = (self.largest_size(), self.smallest_length());
        // How far `Surface::at` may put a point beside the sphere.
        let is_off = Surface::error(largest) > smallest * VISIBLE;
        is_off.then(|| {
            let by = format!(
                "a sphere reaches {largest:.1e} from the origin, and the smallest length is {smallest:.1e}"
            );
            of(Effects::LARGE_SPHERES, by)
        })
    }

    /// The limit on indirect light, if paths with `others` carry any.
    fn clamp(&self, others: Effects) -> Option<Called> {
        let limit = self.sampling.clamp?;
        others.any(Effects::BOUNCING).then(|| {
            let by = format!(
                "[image] clamp = {limit}: the indirect light of a sample adds no more, which is biased"
            );
            of(Effects::CLAMP, by)
        })
    }

    /// What a reader of the image should know: by what of the `shown` effects it is biased on
    /// request. Empty if it is not.
    pub(crate) fn remarks(&self, shown: Effects) -> String {
        if !shown.any(BIASED) {
            return String::new();
        }
        let called = self.called_effects();
        let biased = called
            .iter()
            .filter(|one| one.effect.within(shown).any(BIASED));
        let remarks: Vec<&str> = biased.map(|one| one.by.as_str()).collect();
        remarks.join("; ")
    }

    /// Samples a pixel.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.sampling.samples.unwrap_or_else(|| {
            if self.is_random(self.effects()) {
                Sampling::DEFAULT_SAMPLES
            } else {
                1
            }
        })
    }

    /// The effects of [`CALLS`] that the scene calls for.
    fn called_but_sampling(&self) -> Vec<Called> {
        let asked = Asked::of(self);
        CALLS
            .iter()
            .filter_map(|(effect, called_by)| Some(of(*effect, called_by(&asked)?)))
            .collect()
    }

    /// Whether an image with these effects is random. Of several hard lights one is chosen by
    /// chance.
    fn is_random(&self, effects: Effects) -> bool {
        let sun = self.sky.as_ref().and_then(|sky| sky.sun);
        let hard = self.lights.len() + usize::from(sun.is_some_and(|sun| sun.size == 0.0));
        effects.any(RANDOM) || effects.any(Effects::HARD_SHADOWS) && hard > 1
    }

    /// Whether anything shines other than the lamp at the eye.
    fn has_light(&self) -> bool {
        !self.lights.is_empty()
            || self.sky.is_some()
            || self.sampling.ambient_occlusion.is_some()
            || self.first_of(Material::EMISSIVE).is_some()
    }

    /// The largest of each sphere's radius plus the largest of its centre's coordinates.
    fn largest_size(&self) -> f32 {
        let size = |sphere: &Sphere| sphere.center().abs().max_element() + sphere.radius().abs();
        self.world.spheres.iter().map(size).fold(0.0, f32::max)
    }

    /// The smallest length of which an image may show something: the smallest radius, or the
    /// distance from the eye to what it looks at or to a light.
    fn smallest_length(&self) -> f32 {
        let view = self.view_or_framed();
        let radii = self
            .world
            .spheres
            .iter()
            .map(|sphere| sphere.radius().abs());
        let lights = self
            .lights
            .iter()
            .map(|light| light.position.distance(view.eye));
        let shapes = self.world.shapes.iter();
        radii
            .chain(shapes.map(|shape| shape.thickness(shape.kinds())))
            .chain(lights)
            .filter(|length| *length > 0.0)
            .fold(view.eye.distance(view.target), f32::min)
    }

    fn first_of(&self, kind: u32) -> Option<usize> {
        self.first_material(&|material| material.kind == kind)
    }

    /// The first material that is wanted and that a sphere or another shape has.
    fn first_material(&self, wanted: &dyn Fn(&Material) -> bool) -> Option<usize> {
        let of_spheres = self.first_among(wanted, &self.world.material_ids);
        let of_shapes = self.first_among(wanted, &self.world.shape_material_ids);
        of_spheres.into_iter().chain(of_shapes).min()
    }

    /// Whether a shape beside the spheres glows.
    pub(crate) fn has_glowing_shapes(&self) -> bool {
        let glows = |material: &Material| material.kind == Material::EMISSIVE;
        self.first_among(&glows, &self.world.shape_material_ids)
            .is_some()
    }

    /// The first material that is wanted and that is one of `ids`.
    fn first_among(&self, wanted: &dyn Fn(&Material) -> bool, ids: &[u32]) -> Option<usize> {
        let world = &self.world;
        let candidates: Vec<bool> = world.materials.iter().map(wanted).collect();
        if !candidates.contains(&true) {
            return None;
        }
        ids.iter()
            .map(|id| *id as usize)
            .filter(|id| candidates.get(*id) == Some(&true))
            .min()
    }
}

/// The name of a filter's kind, if there is one.
fn filter_name(filter: Filter) -> Option<&'static str> {
    let mut named = Filter::NAMED.iter();
    named
        .find(|(_, one)| one.kind == filter.kind)
        .map(|(name, _)| *name)
}

fn of(effect: Effects, by: String) -> Called {
    let name = Effects::NAMED
        .iter()
        .find(|(named, _)| *named == effect)
        .map_or("", |(_, name)| name);
    Called { effect, name, by }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_is_called_for_by_an_entry_in_its_place() {
        let listed: Vec<Effects> = CALLS.iter().map(|(effect, _)| *effect).collect();
        let named = Effects::NAMED.iter().map(|(effect, _)| *effect);
        let by_others = Effects::ANTIALIASING
            .and(Effects::HEADLAMP)
            .and(Effects::LARGE_SPHERES)
            .and(Effects::CLAMP);
        let expected: Vec<Effects> = named.filter(|effect| !effect.any(by_others)).collect();
        assert_eq!(listed, expected);
    }
}
