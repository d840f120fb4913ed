//! The light that a vertex gets from a lamp by one sphere. Runs on the GPU and on the CPU.

use glam::{Vec2, Vec3};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::ball::{HOLLOW, MIRROR};
use super::casters::Entry;
use super::ways::{Way, Ways};
use super::weight::{caster_of, is_around, lamp_density};
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::hit::Hit;
use crate::light::{self, Light};
use crate::material::microfacet::schlick;
use crate::material::optics::{Incidence, reflect};
use crate::material::{Material, material_of};
use crate::path::glass::absorb;
use crate::path::light_path::Path;
use crate::path::place::Place;
use crate::path::random::Numbers;
use crate::path::sampling::{Pair, cone, cone_density, power_heuristic};
use crate::path::scenery::Scenery;
use crate::path::vertex::Vertex;
use crate::precision::intersect;
use crate::ray::Ray;
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// A point of a lamp, or a direction of a sun.
struct End {
    /// The point; the unit vector towards the sun.
    at: Vec3,
    /// The normal of a glowing sphere.
    normal: Vec3,
    /// The glowing sphere.
    lamp: Sphere,
    /// Its index.
    index: u32,
    /// Radiance; of a light without extent, intensity or irradiance.
    radiance: Vec3,
    /// Per area or solid angle; of a light without extent, the probability of choosing it. Zero if
    /// there is none.
    density: f32,
    is_sun: bool,
    is_delta: bool,
    is_sphere: bool,
}

/// A light path that goes by a sphere.
struct Passage {
    /// The share of light that it carries.
    carried: Vec3,
    /// The probability that a path of random reflections and refractions takes it.
    share: f32,
    /// The direction of its last piece.
    direction: Vec3,
}

impl Passage {
    /// Reflects the path at a mirror, or refracts it at the surface of glass or of a hollow in it.
    #[inline]
    fn meet(&mut self, is_mirror: bool, is_hollow: bool, material: &Material, surface: &Surface) {
        let cosine = surface.normal.dot(self.direction);
        if is_mirror {
            self.carried *= schlick(material.color, cosine.abs());
            self.direction = unit(reflect(self.direction, surface.normal));
            return;
        }
        let is_into_glass = (cosine < 0.0) != is_hollow;
        let incidence = Incidence {
            cosine: cosine.abs().min(1.0),
            eta: if is_into_glass {
                1.0 / material.parameter
            } else {
                material.parameter
            },
        };
        let fresnel = incidence.fresnel();
        let share = 1.0 - fresnel.reflectance;
        self.share *= share;
        self.carried *= share;
        let normal = surface.facing(self.direction);
        self.direction = unit(fresnel.refract(incidence, self.direction, normal));
    }
}

/// The light of one lamp by one sphere, both chosen at random, that the vertex scatters into the
/// path.
#[inline]
pub(in crate::path) fn light_by_sphere<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    place: &Place,
    vertex: &Vertex,
    numbers: &impl Numbers,
) -> Vec3 {
    let mut light = Vec3::ZERO;
    let (first, u) = (scenery.launch.first_caster, numbers.others().which_sphere());
    let entry = Entry::choose(scenery.tables, first, u);
    let ball = scenery.sphere(entry.sphere as usize, path.time);
    let end = choose_end(scenery, path.time, ball, numbers);
    let radius = ball.radius();
    let near = place.surface.point - ball.center();
    let far = if end.is_sun {
        end.at
    } else {
        end.at - ball.center()
    };
    let is_possible = (end.density > 0.0) & (entry.probability > 0.0);
    if !(is_possible & is_around(radius, near, far, end.is_sun)) {
        return light;
    }
    let caster = caster_of(scenery, entry, ball);
    let mut ways = Ways::new(caster, near, far, end.is_sun);
    let most = if caster.kind == MIRROR {
        1
    } else if entry.is_hollow() {
        Ways::MOST
    } else {
        Ways::MOST - 1
    };
    let mut number = 0;
    while number < most {
        let way = ways.way(number);
        if way.w >= 0.0 {
            light += light_of_way(scenery, path, place, vertex, entry, &end, &way);
        }
        number += 1;
    }
    light
}

/// The light that comes along one way.
#[inline]
fn light_of_way<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    place: &Place,
    vertex: &Vertex,
    entry: Entry,
    end: &End,
    way: &Way,
) -> Vec3 {
    // As many bounces as a path by chance has there.
    let bounces = surfaces(way.kind);
    let (value, density) = vertex.evaluate(scenery, way.direction);
    let is_possible = (path.bounces() + bounces <= scenery.most_bounces())
        & (value.max_element() > 0.0)
        & (way.spread > 0.0);
    if !is_possible {
        return Vec3::ZERO;
    }
    let passage = pass(scenery, path.time, place, entry, end, way);
    let mut spread = way.spread;
    if end.is_sphere {
        spread *= (-end.normal.dot(passage.direction)).max(0.0);
    }
    // Written so that a NaN carries nothing.
    let is_lit = passage.share * spread > 0.0;
    if !is_lit {
        return Vec3::ZERO;
    }
    let chosen = end.density * entry.probability / spread;
    let mut weight = 1.0;
    if !end.is_delta {
        weight = power_heuristic(chosen, density * passage.share);
    }
    value * end.radiance * passage.carried * (weight / chosen)
}

/// How many surfaces a path meets at a sphere.
#[inline]
fn surfaces(kind: u32) -> u32 {
    if kind == MIRROR {
        1
    } else if kind == HOLLOW {
        4
    } else {
        2
    }
}

/// Chooses a lamp, and where on it a path ends that comes by `ball`.
#[inline]
fn choose_end<T: Traversal>(
    scenery: &Scenery<'_, T>,
    time: f32,
    ball: Sphere,
    numbers: &impl Numbers,
) -> End {
    let effects = scenery.effects;
    let (lamp, _) = light::choose(scenery.lights, numbers.others().which_light());
    let pair = numbers.others().on_lamp();
    let mut end = End {
        at: lamp.position,
        normal: Vec3::ZERO,
        lamp: ball,
        index: Hit::NONE_SPHERE,
        radiance: lamp.color,
        density: lamp.probability,
        is_sun: lamp.kind == Light::SUN,
        is_delta: true,
        is_sphere: false,
    };
    if effects.any(Effects::SOFT_SHADOWS)
        && lamp.kind == Light::SPHERE
        && (lamp.sphere as usize) < scenery.spheres.len()
    {
        let sphere = scenery.sphere(lamp.sphere as usize, time);
        let height = light::cap_height(sphere, ball);
        // Linear in the cosine: the density of what is nearer to the middle is a square.
        let within = Pair {
            u: Vec2::new(1.0 - (1.0 - pair.u.x).sqrt(), pair.u.y),
            turn: pair.turn,
        };
        end.normal = cone(
            unit(ball.center() - sphere.center()),
            height.max(0.0),
            within,
        );
        end.at = sphere.center() + end.normal * sphere.radius();
        end.lamp = sphere;
        end.index = lamp.sphere;
        end.density *= if height > 0.0 {
            lamp_density(sphere, ball, end.normal)
        } else {
            0.0
        };
        end.is_delta = false;
        end.is_sphere = true;
    } else if effects.any(Effects::SOFT_SHADOWS) && end.is_sun && lamp.height > 0.0 {
        end.at = cone(lamp.position, lamp.height, pair);
        end.density *= cone_density(lamp.height);
        end.is_delta = false;
    } else if !effects.any(Effects::HARD_SHADOWS) | !(end.is_sun | (lamp.kind == Light::POINT)) {
        end.density = 0.0;
    }
    end
}

/// Sends light from a vertex along a way, surface after surface, as a path by chance goes. Carries
/// nothing if something else is in the way.
#[inline]
fn pass<T: Traversal>(
    scenery: &Scenery<'_, T>,
    time: f32,
    place: &Place,
    entry: Entry,
    end: &End,
    way: &Way,
) -> Passage {
    const BLOCKED: Passage = Passage {
        carried: Vec3::ZERO,
        share: 0.0,
        direction: Vec3::ZERO,
    };
    let effects = scenery.effects;
    let material = material_of(
        entry.sphere as usize,
        scenery.material_ids,
        scenery.materials,
    );
    let mut passage = Passage {
        carried: Vec3::ONE,
        share: 1.0,
        direction: way.direction,
    };
    let (mut point, mut left) = (place.surface.point, place.sphere);
    let surfaces = surfaces(way.kind);
    let mut met = 0;
    while met <= surfaces {
        let is_last = met == surfaces;
        // The hollow is met between the two surfaces of the glass.
        let is_hollow = (way.kind == HOLLOW) & ((met == 1) | (met == 2));
        let index = if is_hollow {
            entry.hollow
        } else {
            entry.sphere
        };
        let mut sphere = scenery.sphere(index as usize, time);
        let mut distance = Hit::NONE_T;
        if is_last & !end.is_sun {
            passage.direction = unit(end.at - point);
            distance = (end.at - point).length();
            sphere = end.lamp;
        } else if is_last {
            passage.direction = end.at;
        }
        let direction = passage.direction;
        let whole = Ray::within(point, direction, f32::MIN_POSITIVE, Hit::NONE_T);
        if (!is_last) & (index == left) {
            // A chord.
            distance = -2.0 * (point - sphere.center()).dot(direction);
        } else if !is_last | end.is_sphere {
            // Up to where the sphere itself begins: the interval is half-open.
            let hit = intersect(scenery.rung, sphere, &whole);
            if hit < Hit::NONE_T {
                distance = hit;
            } else if !is_last {
                return BLOCKED;
            }
        }
        let ray = Ray::within(point, direction, f32::MIN_POSITIVE, distance);
        let is_within = (met == 0) & (place.exit(direction) < distance);
        let target = if is_last { end.index } else { index };
        if is_within || scenery.is_blocked(&ray, left, target, time) {
            return BLOCKED;
        }
        let is_outside = is_last | (met == 0);
        if effects.any(Effects::FOG) && is_outside {
            let fog = &scenery.launch.fog;
            passage.carried *= fog.transmittance(point, direction, distance);
        }
        if !is_outside & (met != 2) {
            passage.carried *= absorb(material.volume, distance);
        }
        if is_last {
            return passage;
        }
        let surface = scenery.surface(&ray, distance, sphere);
        (point, left) = (surface.point, index);
        passage.meet(way.kind == MIRROR, is_hollow, &material, &surface);
        met += 1;
    }
    BLOCKED
}
