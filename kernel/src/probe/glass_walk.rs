//! A light path inside a glass sphere, bounce after bounce, to see whether it stays inside. Runs on
//! the GPU and on the CPU; the host judges the result.

use bytemuck::{Pod, Zeroable};

use crate::hit::Hit;
use crate::material::optics::{Incidence, reflect};
use crate::precision::intersect;
use crate::ray::Ray;
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// The result of a path inside a sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Walk {
    /// How many times the path met the sphere from inside.
    pub bounces: u32,
    /// How many times the path met the sphere from the wrong side, or not at all.
    pub astray: u32,
    /// 1 if the path, refracted out of the sphere at its end, did not meet the sphere again.
    pub is_out: u32,
    /// The cosine between path and normal at the last bounce. In exact arithmetic it is the same at
    /// every bounce.
    pub cosine: f32,
}

/// Refracts `ray` into `sphere`, whose refractive index is `index`, reflects it inside `bounces`
/// times, and refracts it out. A ray that misses has zero bounces.
#[inline]
#[must_use]
pub fn walk_inside(rung: u32, ray: &Ray, sphere: Sphere, index: f32, bounces: u32) -> Walk {
    let mut walk = Walk::default();
    let t = intersect(rung, sphere, ray);
    if t >= Hit::NONE_T {
        return walk;
    }
    let surface = Surface::at(ray, t, sphere);
    let direction = unit(ray.direction);
    let incidence = Incidence {
        cosine: -direction.dot(surface.normal),
        eta: 1.0 / index,
    };
    if incidence.cosine < 0.0 {
        walk.astray += 1;
    }
    let inwards = incidence
        .fresnel()
        .refract(incidence, direction, surface.normal);
    let mut inside = surface.leave(inwards);
    while walk.bounces < bounces {
        let t = intersect(rung, sphere, &inside);
        if t >= Hit::NONE_T {
            walk.astray += 1;
            return walk;
        }
        let surface = Surface::at(&inside, t, sphere);
        let direction = unit(inside.direction);
        walk.cosine = direction.dot(surface.normal);
        if walk.cosine <= 0.0 {
            walk.astray += 1;
        }
        walk.bounces += 1;
        if walk.bounces == bounces {
            let out = Incidence {
                cosine: walk.cosine,
                eta: index,
            };
            let outwards = out.fresnel().refract(out, direction, -surface.normal);
            let again = intersect(rung, sphere, &surface.leave(outwards));
            walk.is_out = u32::from(again >= Hit::NONE_T);
        }
        inside = surface.leave(reflect(direction, surface.normal));
    }
    walk
}

const _: () = assert!(size_of::<Walk>() == 16);
