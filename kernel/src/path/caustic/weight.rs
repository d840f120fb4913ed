//! The weight of light that a path meets by chance and that a connection by a sphere finds, too.
//! Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::ball::{HOLLOW, MIRROR, SOLID};
use super::casters::Entry;
use super::chain::NO_KIND;
use super::ways::Caster;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::light;
use crate::material::{Material, material_of};
use crate::path::light_path::Path;
use crate::path::sampling::{cone_density, power_heuristic};
use crate::path::scenery::Scenery;
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// The density with which [`connect`](super::connect) chooses the point of a lamp where its normal
/// is this, per area, for light that comes by `ball`.
///
/// It falls linearly with the cosine, to zero at the edge of the cap. So does the largest cosine at
/// the lamp of any light that reaches the ball: with z the cosine between n and the way to C, D the
/// distance of the centres and the edge at z = (ρ − r) / D, a point P of the ball has (P − y) · n ≤
/// D z − ρ + r. So what a sample adds has a bound, and next to none is spent on grazing light.
#[inline]
pub(super) fn lamp_density(lamp: Sphere, ball: Sphere, normal: Vec3) -> f32 {
    let height = light::cap_height(lamp, ball);
    // Half of the squared distance of unit vectors is 1 − cos.
    let apart = unit(ball.center() - lamp.center()) - normal;
    let above = (1.0 - 0.5 * apart.dot(apart) / height).max(0.0);
    2.0 * above * cone_density(height) / (lamp.radius() * lamp.radius())
}

/// What the sphere of an entry is made of.
#[inline]
pub(super) fn caster_of<T: Traversal>(
    scenery: &Scenery<'_, T>,
    entry: Entry,
    ball: Sphere,
) -> Caster {
    let index = entry.sphere as usize;
    let material = material_of(index, scenery.material_ids, scenery.materials);
    let is_mirror = material.kind == Material::METAL;
    let mut hollow = 0.0;
    if entry.is_hollow() {
        hollow = scenery.sphere(entry.hollow as usize, 0.0).radius();
    }
    Caster {
        kind: if is_mirror { MIRROR } else { SOLID },
        radius: ball.radius(),
        hollow,
        index: if is_mirror { 1.0 } else { material.parameter },
    }
}

/// Whether connections by spheres may find light where the path has arrived.
#[inline]
fn is_found<T: Traversal>(scenery: &Scenery<'_, T>, path: &Path) -> bool {
    let effects = scenery.effects;
    effects.any(Effects::SOFT_SHADOWS)
        && (path.chain.kind() != NO_KIND) & !path.is_in_glass(effects)
}

/// The weight of the light of a glowing sphere, which a path has met at `surface`. `chosen` is the
/// probability that the lamp is chosen.
#[inline]
pub(in crate::path) fn weight_at_lamp<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    lamp: Sphere,
    surface: &Surface,
    chosen: f32,
) -> f32 {
    if !is_found(scenery, path) {
        return 1.0;
    }
    let ball = scenery.sphere(path.chain.caster as usize, path.time);
    let cosine = -surface.normal.dot(path.direction);
    let far = surface.point - ball.center();
    let density = chosen * lamp_density(lamp, ball, surface.normal) / cosine.max(f32::MIN_POSITIVE);
    weight(scenery, path, ball, far, false, density)
}

/// The weight of the sun's light, for a path that meets it.
#[inline]
pub(in crate::path) fn weight_at_sun<T: Traversal>(scenery: &Scenery<'_, T>, path: &Path) -> f32 {
    if !is_found(scenery, path) {
        return 1.0;
    }
    let sky = &scenery.launch.sky;
    let ball = scenery.sphere(path.chain.caster as usize, path.time);
    let density = sky.sun_probability * cone_density(sky.sun_height);
    weight(scenery, path, ball, path.direction, true, density)
}

/// Whether both ends of a path are outside of the sphere, of which these are seen from the centre;
/// a sun is.
#[inline]
pub(super) fn is_around(radius: f32, near: Vec3, far: Vec3, is_sun: bool) -> bool {
    (near.length() > radius) & (is_sun | (far.length() > radius))
}

/// The weight of a path that arrives where a connection would have ended with this density, per
/// area across the path or per solid angle of a sun; one if no connection finds it.
#[inline]
fn weight<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    ball: Sphere,
    far: Vec3,
    is_sun: bool,
    density: f32,
) -> f32 {
    let kind = path.chain.kind();
    let (first, caster) = (scenery.launch.first_caster, path.chain.caster);
    let entry = Entry::find(scenery.tables, first, caster);
    let near = path.chain.vertex() - ball.center();
    let is_possible = (entry.probability > 0.0) & ((kind != HOLLOW) | entry.is_hollow());
    if !(is_possible & is_around(ball.radius(), near, far, is_sun)) {
        return 1.0;
    }
    let far_length = if is_sun { f32::MAX } else { far.length() };
    let caster = caster_of(scenery, entry, ball);
    let way = caster.ball(kind, near.length(), far_length);
    // Its distance from the centre is that of its last piece.
    let aside = (path.origin - ball.center()).cross(path.direction).length();
    let sine = (aside / way.unit).min(1.0);
    let w = sine / (1.0 + (1.0 - sine * sine).max(0.0).sqrt());
    let spread = way.spread(w, near, far, is_sun);
    power_heuristic(path.chain.density, density * entry.probability / spread)
}
