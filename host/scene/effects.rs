//! Which effects a scene calls for, and by what.

use spherule_kernel::material::microfacet::SMOOTHEST;
use spherule_kernel::{Effects, Material};

use super::{Sampling, Scene};
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
    .and(Effects::ENVIRONMENT);

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
        let random = self.is_random(
            called
                .iter()
                .fold(Effects::NONE, |set, one| set.and(one.effect)),
        );
        let (samples, by) = match self.sampling.samples {
            Some(samples) => (samples, format!("[image] samples = {samples}")),
            None if random => (
                Sampling::DEFAULT_SAMPLES,
                format!(
                    "{} samples a pixel are the default where something is random",
                    Sampling::DEFAULT_SAMPLES
                ),
            ),
            None => (1, String::new()),
        };
        if samples > 1 {
            called.push(of(Effects::ANTIALIASING, by));
        }
        let is_lit = |m: &Material| matches!(m.kind, Material::DIFFUSE | Material::PLASTIC);
        if !called.is_empty() && !self.has_light() && self.first_material(&is_lit).is_some() {
            called.push(of(
                Effects::HEADLAMP,
                "the scene has no light: no [[light]], no [sky], nothing that glows, no ambient occlusion".into(),
            ));
        }
        called.sort_by_key(|called| called.effect.to_bits());
        called
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

    fn called_but_sampling(&self) -> Vec<Called> {
        let mut called = Vec::new();
        let mut call = |effect, by: String| called.push(of(effect, by));
        let material = |index: usize| match self.world.material_names.get(index) {
            Some(name) if !name.is_empty() => format!("material `{}`", shown(name)),
            _ => format!("material {index}"),
        };
        let first = |wanted: &dyn Fn(&Material) -> bool| self.first_material(wanted);
        let of_kind = |kind| self.first_of(kind);

        let glow = of_kind(Material::EMISSIVE);
        if let Some(index) = glow {
            call(
                Effects::EMISSION,
                format!("{} is of kind emissive", material(index)),
            );
        }
        if let Some(index) = first(&|m| m.kind == Material::METAL && m.parameter < SMOOTHEST) {
            call(
                Effects::MIRROR,
                format!("{} is of kind metal, without roughness", material(index)),
            );
        }
        let rough = first(&|m| m.kind == Material::METAL && m.parameter >= SMOOTHEST);
        if let Some(index) = rough {
            call(
                Effects::ROUGH_METAL,
                format!("{} is of kind metal, with roughness", material(index)),
            );
        }
        if let Some(index) = of_kind(Material::GLASS).or_else(|| of_kind(Material::BUBBLE)) {
            call(
                Effects::GLASS,
                format!("{} is of kind glass", material(index)),
            );
        }
        let plastic = of_kind(Material::PLASTIC);
        if let Some(index) = plastic {
            call(
                Effects::PLASTIC,
                format!("{} is of kind plastic", material(index)),
            );
        }
        let diffuse = of_kind(Material::DIFFUSE);
        // Mirrors and glass do not look for light.
        let seeks = diffuse.is_some() || rough.is_some() || plastic.is_some() || self.fog.is_some();
        if seeks && !self.lights.is_empty() {
            call(
                Effects::HARD_SHADOWS,
                format!("{} [[light]] without a radius", self.lights.len()),
            );
        }
        if seeks && let Some(index) = glow {
            call(
                Effects::SOFT_SHADOWS,
                format!("spheres of {} shine on others", material(index)),
            );
        }
        if let Some(sky) = &self.sky {
            if let Some(sun) = sky.sun {
                if sun.size > 0.0 {
                    call(Effects::SUN, format!("[sky] sun_size = {}", sun.size));
                    if seeks {
                        call(
                            Effects::SOFT_SHADOWS,
                            format!("[sky] sun_size = {}", sun.size),
                        );
                    }
                } else if seeks {
                    call(Effects::HARD_SHADOWS, "[sky] sun_size = 0".into());
                }
            }
            if sky.image.is_some() {
                call(Effects::ENVIRONMENT, "[sky] image".into());
            } else if sky.horizon != sky.zenith {
                call(
                    Effects::SKY_GRADIENT,
                    "[sky] horizon and zenith differ".into(),
                );
            }
        }
        if let Some(distance) = self.sampling.ambient_occlusion {
            if diffuse.is_some() {
                call(
                    Effects::AMBIENT_OCCLUSION,
                    format!("[image] ambient_occlusion = {distance}"),
                );
            }
        } else if let Some(index) = diffuse
            && self.has_light()
            && self.sampling.max_bounces > 0
        {
            call(
                Effects::INTERREFLECTION,
                format!(
                    "{} is of kind diffuse, and light may bounce {}",
                    material(index),
                    count_of(self.sampling.max_bounces as usize, "time")
                ),
            );
        }
        if self.lens.aperture > 0.0 {
            call(
                Effects::DEFOCUS,
                format!("[camera] aperture = {}", self.lens.aperture),
            );
        }
        let (open, close) = self.lens.shutter;
        let moving = self
            .world
            .velocities
            .iter()
            .filter(|v| **v != glam::Vec3::ZERO);
        let moving = moving.count();
        if (open, close) != (0.0, 0.0) && moving > 0 {
            call(
                Effects::MOTION_BLUR,
                format!(
                    "{moving} [[sphere]] with a velocity, and [camera] shutter = [{open}, {close}]"
                ),
            );
        }
        if let Some(fog) = &self.fog {
            call(
                Effects::FOG,
                format!("[fog] extinction = {}", fog.medium.extinction),
            );
        }
        if self.transparent {
            call(
                Effects::TRANSPARENT_BACKGROUND,
                "[image] transparent = true".into(),
            );
        }
        // One sentence an effect.
        let mut seen = Effects::NONE;
        called.retain(|one| {
            let is_new = !seen.any(one.effect);
            seen = seen.and(one.effect);
            is_new
        });
        called
    }

    /// Whether an image with these effects is random. Of several hard lights one is chosen by chance.
    fn is_random(&self, effects: Effects) -> bool {
        let sun = self.sky.as_ref().and_then(|sky| sky.sun);
        let hard = self.lights.len() + usize::from(sun.is_some_and(|sun| sun.size == 0.0));
        effects.any(RANDOM) || effects.any(Effects::HARD_SHADOWS) && hard > 1
    }

    /// Whether anything shines other than the lamp at the eye. A sky shines by way of a bounce.
    fn has_light(&self) -> bool {
        !self.lights.is_empty()
            || self
                .sky
                .as_ref()
                .is_some_and(|sky| sky.sun.is_some() || self.sampling.max_bounces > 0)
            || self.sampling.ambient_occlusion.is_some()
            || self.first_of(Material::EMISSIVE).is_some()
    }

    fn first_of(&self, kind: u32) -> Option<usize> {
        self.first_material(&|material| material.kind == kind)
    }

    /// The first material that is wanted and that a sphere has.
    fn first_material(&self, wanted: &dyn Fn(&Material) -> bool) -> Option<usize> {
        let world = &self.world;
        let candidates: Vec<bool> = world.materials.iter().map(wanted).collect();
        if !candidates.contains(&true) {
            return None;
        }
        world
            .material_ids
            .iter()
            .map(|id| *id as usize)
            .filter(|id| candidates.get(*id) == Some(&true))
            .min()
    }
}

fn of(effect: Effects, by: String) -> Called {
    let name = Effects::NAMED
        .iter()
        .find(|(named, _)| *named == effect)
        .map_or("", |(_, name)| name);
    Called { effect, name, by }
}
