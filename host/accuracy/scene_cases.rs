//! The hard cases with more than one ray or sphere: whole worlds, surfaces, glass, and what a scene
//! file may contain. The numbers are those of the catalogue, as in [`super::cases`].

use glam::Vec3;
use spherule_kernel::material::optics::Incidence;
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use super::ask;
use super::cases::{ALL, BOUNDED, CERTIFIED, UPPER, Verdict};
use super::families::Family;
use super::measure::intersect_all;
use super::oracle;
use crate::device::Device;
use crate::error::Result;
use crate::film::agreement::Agreement;
use crate::random::Random;
use crate::read::toml;
use crate::render::{QUIET, Settings, render};

/// A hard case that is judged by its own function.
#[derive(Clone, Copy, Debug)]
pub struct SceneCase {
    /// Its number in the catalogue.
    pub number: u8,
    /// Its name.
    pub name: &'static str,
    promised_by: &'static [Rung],
    /// Returns what is wrong, if anything.
    objection: fn(&Device, Rung) -> Result<Option<String>>,
}

impl SceneCase {
    /// The verdict on `rung` for this case on `device`.
    ///
    /// # Errors
    ///
    /// [`RungRefused`](crate::Error::RungRefused) if the canary objects, and the device's errors.
    pub fn judge(&self, device: &Device, rung: Rung) -> Result<Verdict> {
        let wrong = (self.objection)(device, rung)?;
        Ok(Verdict::of(wrong, self.promised_by.contains(&rung)))
    }
}

/// The cases with more than one ray or sphere.
pub const SCENE_CASES: &[SceneCase] = &[
    SceneCase {
        number: 30,
        name: "negative radius: refused at load",
        promised_by: ALL,
        objection: negative_radius,
    },
    SceneCase {
        number: 33,
        name: "concentric spheres one ulp apart: in order",
        promised_by: UPPER,
        objection: concentric,
    },
    SceneCase {
        number: 34,
        name: "coincident spheres: the lowest index",
        promised_by: ALL,
        objection: coincident,
    },
    SceneCase {
        number: 35,
        name: "overlapping and touching spheres: the nearest",
        promised_by: ALL,
        objection: overlapping,
    },
    SceneCase {
        number: 36,
        name: "normal of a sphere with huge |C|",
        promised_by: UPPER,
        objection: far_normal,
    },
    SceneCase {
        number: 37,
        name: "|p − C| − r at the hit: within its bound",
        promised_by: ALL,
        objection: drift,
    },
    SceneCase {
        number: 38,
        name: "refraction next to the critical angle: the exact choice",
        promised_by: ALL,
        objection: critical_angle,
    },
    SceneCase {
        number: 39,
        name: "Fresnel at grazing angles and as η → 1: finite",
        promised_by: ALL,
        objection: grazing_fresnel,
    },
    SceneCase {
        number: 40,
        name: "a thousand bounces inside glass: in, and out again",
        promised_by: UPPER,
        objection: thousand_bounces,
    },
    SceneCase {
        number: 41,
        name: "primary ray against shadow query: the same",
        promised_by: CERTIFIED,
        objection: shadow_query,
    },
    SceneCase {
        number: 43,
        name: "light of lamps, by tests of every sphere and by a tree",
        promised_by: ALL,
        objection: light_of_lamps,
    },
    SceneCase {
        number: 46,
        name: "sphere smaller than an ulp of t: a normal, no re-hit",
        promised_by: ALL,
        objection: small_as_rounding,
    },
    SceneCase {
        number: 47,
        name: "touching where it starts: any hit is on the sphere",
        promised_by: BOUNDED,
        objection: touching_at_the_start,
    },
];

/// Rays at spheres so small and so far away that t has no digit of their size.
fn small_as_rounding(device: &Device, rung: Rung) -> Result<Option<String>> {
    let mut random = Random::new(46);
    let mut samples = vec![(
        Ray::new(Vec3::new(-131_072.0, 0.0, 0.0), Vec3::X),
        Sphere::new(Vec3::ZERO, 0.003),
    )];
    for _ in 0..64 {
        // What a direction is off by must be less than the sphere: along an axis it is nothing.
        let axis = [Vec3::X, Vec3::NEG_Y, Vec3::Z][samples.len() % 3];
        let distance = random.log_within(1e4, 1e7);
        let sphere = Sphere::new(Vec3::ZERO, distance * random.log_within(1e-9, 1e-7));
        samples.push((Ray::new(-axis * distance, axis), sphere));
    }
    let parameters = intersect_all(device, rung, &samples)?;
    let surfaces = ask::surfaces(device, &samples, &parameters)?;
    let mut leaving = Vec::new();
    for (((ray, sphere), surface), t) in samples.iter().zip(&surfaces).zip(&parameters) {
        if *t == Hit::NONE_T {
            // The textbook's discriminant has no digit of such a sphere.
            if rung == Rung::Textbook {
                continue;
            }
            return Ok(Some(format!("missed from {}", ray.origin)));
        }
        let normal = surface.normal;
        if (normal.length() - 1.0).abs() > 1e-6 || normal.dot(ray.direction) > 0.0 {
            return Ok(Some(format!(
                "normal {normal} for a ray along {}",
                ray.direction
            )));
        }
        leaving.push((surface.leave(normal), *sphere));
    }
    let again = intersect_all(device, rung, &leaving)?;
    let mut hits = leaving.iter().zip(again).filter(|(_, t)| *t < Hit::NONE_T);
    Ok(hits
        .next()
        .map(|((ray, _), t)| format!("hit again at {t} from {}", ray.origin)))
}

/// Rays that start on a sphere, along it: b, c and Δ are all but rounding.
fn touching_at_the_start(device: &Device, rung: Rung) -> Result<Option<String>> {
    let mut random = Random::new(47);
    let mut samples = Vec::new();
    for index in 0..20_000 {
        let (center, radius) = (random.vec3(-0.4, 0.4), random.log_within(0.1, 100.0));
        let out = random.unit_vec3();
        let along = out.any_orthonormal_vector();
        let along = (along + out.cross(along) * random.within(-2.0, 2.0)).normalize();
        let tilt = out * random.log_within(1e-12, 1e-3) * [1.0, -1.0][index % 2];
        let mut ray = Ray::new(center + out * radius, along + tilt);
        if index % 3 > 0 {
            ray.t_min = radius * random.log_within(1e-9, 1.0);
        }
        samples.push((ray, Sphere::new(center, radius)));
    }
    let parameters = intersect_all(device, rung, &samples)?;
    let hits = samples
        .iter()
        .zip(&parameters)
        .filter(|(_, t)| **t < Hit::NONE_T);
    for ((ray, sphere), t) in hits {
        let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(*t);
        let (center, radius) = (sphere.center().as_dvec3(), f64::from(sphere.radius()));
        let off = ((point - center).length() - radius).abs();
        // 32u, as boxes are widened.
        if off > 2.0_f64.powi(-19) * 2.0 * radius {
            return Ok(Some(format!("t = {t:e} is {:e} radii off", off / radius)));
        }
    }
    Ok(None)
}

/// Two lamps above balls on a ground, without what makes the balls.
const LAMPS: &str = "
[image]
width = 96
height = 64
samples = 16
max_bounces = 1

[camera]
eye = [0, 3.5, 8]
target = [0, 0.3, 0]

[materials.warm]
kind = \"emissive\"
color = [120, 90, 60]

[materials.cold]
kind = \"emissive\"
color = [30, 45, 70]

[[sphere]]
center = [0, -200, 0]
radius = 200

[[sphere]]
center = [-3, 4, 1]
radius = 0.3
material = \"warm\"

[[sphere]]
center = [3.5, 3, 2]
radius = 0.3
material = \"cold\"
";

/// The light of lamps with an extent, of six spheres and of many, is that of the CPU on certified.
fn light_of_lamps(device: &Device, rung: Rung) -> Result<Option<String>> {
    for balls in [3, 30] {
        let mut random = Random::new(43);
        let mut text = LAMPS.to_owned();
        for _ in 0..balls {
            let (x, z) = (random.within(-4.0, 4.0), random.within(-4.0, 4.0));
            text += &format!("[[sphere]]\ncenter = [{x}, 0.25, {z}]\nradius = 0.25\n");
        }
        let scene = toml::parse(std::path::Path::new("lamps.toml"), text)?;
        let image = |device: &Device, rung| {
            let settings = Settings {
                rung,
                ..Settings::default()
            };
            render(&scene, settings, device, QUIET).map(|rendered| rendered.image)
        };
        let right = image(&Device::Cpu, Rung::Certified)?;
        let found = image(device, rung)?;
        if let Some(agreement) = Agreement::of(&found, &right)
            && !agreement.is_within()
        {
            let worst = agreement.worst;
            let why = format!("{balls} balls: off by {:.1} standard errors", worst.errors);
            return Ok(Some(why));
        }
    }
    Ok(None)
}

const AHEAD: (Vec3, Vec3) = (Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);

fn negative_radius(_: &Device, _: Rung) -> Result<Option<String>> {
    let text = "[[sphere]]\ncenter = [0, 0, 0]\nradius = -1\n";
    let read = toml::parse(std::path::Path::new("negative.toml"), text.into());
    Ok(read.is_ok().then(|| "a scene was read".into()))
}

/// What is wrong if the ray straight ahead does not hit this sphere of the world.
fn must_hit(device: &Device, rung: Rung, world: &[Sphere], sphere: u32) -> Result<Option<String>> {
    let ray = Ray::new(AHEAD.0, AHEAD.1);
    let found = ask::nearest(device, rung, &[ray], world)?[0];
    Ok((found.sphere != sphere).then(|| format!("{found:?}, must be sphere {sphere}")))
}

fn concentric(device: &Device, rung: Rung) -> Result<Option<String>> {
    let one = |r: f32| Sphere::new(Vec3::ZERO, r);
    let world = [one(4.0), one(4.0_f32.next_up()), one(4.0_f32.next_down())];
    must_hit(device, rung, &world, 1)
}

fn coincident(device: &Device, rung: Rung) -> Result<Option<String>> {
    must_hit(device, rung, &[Sphere::new(Vec3::ZERO, 1.0); 3], 0)
}

fn overlapping(device: &Device, rung: Rung) -> Result<Option<String>> {
    let at = |z: f32| Sphere::new(Vec3::new(0.0, 0.0, z), 1.0);
    must_hit(device, rung, &[at(-1.0), at(1.0), at(0.5)], 1)
}

/// Rays through the middle of spheres that are far from the origin.
fn far_hits() -> Vec<(Ray, Sphere)> {
    let mut random = Random::new(36);
    (0..64)
        .map(|_| {
            let sphere = Sphere::new(random.vec3(-4e6, 4e6), random.within(1.0, 4.0));
            // Along z, so that the difference of the two is exact.
            let origin = sphere.center() + Vec3::Z * 8.0;
            (Ray::new(origin, Vec3::NEG_Z), sphere)
        })
        .collect()
}

fn far_normal(device: &Device, rung: Rung) -> Result<Option<String>> {
    let samples = far_hits();
    let parameters = intersect_all(device, rung, &samples)?;
    let surfaces = ask::surfaces(device, &samples, &parameters)?;
    Ok(surfaces.iter().find_map(|surface| {
        ((surface.normal - Vec3::Z).length() > 1e-6).then(|| format!("{}", surface.normal))
    }))
}

fn drift(device: &Device, rung: Rung) -> Result<Option<String>> {
    let mut samples = far_hits();
    samples.extend(Family::Generic.sample(37, 1000));
    let parameters = intersect_all(device, rung, &samples)?;
    let surfaces = ask::surfaces(device, &samples, &parameters)?;
    let hits = samples.iter().zip(&surfaces).zip(&parameters);
    Ok(hits
        .filter(|(_, t)| **t < Hit::NONE_T)
        .find_map(|(((_, sphere), surface), _)| {
            let from_center = surface.point.as_dvec3() - sphere.center().as_dvec3();
            let off = (from_center.length() - f64::from(sphere.radius())).abs();
            (off > f64::from(surface.error)).then(|| format!("{off:e} beyond {:e}", surface.error))
        }))
}

fn critical_angle(device: &Device, _: Rung) -> Result<Option<String>> {
    let mut random = Random::new(38);
    let mut incidences = Vec::new();
    for index in 0..1000 {
        // Half of them close to one, where little is left of 1 − η².
        let step = if index % 2 == 0 { 2.0 } else { 1e-3 };
        let eta = 1.0 + random.log_within(1e-4 * step, step);
        let critical = (1.0 - 1.0 / (f64::from(eta) * f64::from(eta))).sqrt() as f32;
        let mut cosine = critical.next_down().next_down();
        for _ in 0..5 {
            incidences.push(Incidence { cosine, eta });
            cosine = cosine.next_up();
        }
    }
    let answers = ask::fresnel(device, &incidences)?;
    Ok(incidences.iter().zip(answers).find_map(|(one, found)| {
        let passes = oracle::is_transmitted(one.cosine, one.eta);
        (passes != (found.cosine_transmitted > 0.0) || !(0.0..=1.0).contains(&found.reflectance))
            .then(|| format!("{one:?}: {found:?}, light passes: {passes}"))
    }))
}

fn grazing_fresnel(device: &Device, _: Rung) -> Result<Option<String>> {
    let mut incidences = Vec::new();
    let cosines = [0.0, f32::from_bits(1), 1e-30, 1e-20, 1e-7, 0.5, 1.0];
    let up = 1.0_f32.next_up();
    let etas = [1.0, up, 1.0 / up, 1.0 + 1e-5, 0.5, 2.0, 0.4, 2.5];
    for cosine in cosines {
        for eta in etas {
            incidences.push(Incidence { cosine, eta });
        }
    }
    let answers = ask::fresnel(device, &incidences)?;
    Ok(incidences.iter().zip(answers).find_map(|(one, found)| {
        let share = found.reflectance;
        let defined =
            (0.0..=1.0).contains(&share) && (0.0..=1.0 + 1e-6).contains(&found.cosine_transmitted);
        let no_boundary = one.eta != 1.0 || share == 0.0;
        let grazing = one.eta >= 1.0 || one.cosine > 1e-20 || share > 0.999;
        // At normal incidence: ((η − 1)/(η + 1))².
        let r = f64::from((one.eta - 1.0) / (one.eta + 1.0)).powi(2);
        let normal = one.cosine != 1.0 || (f64::from(share) - r).abs() <= 1e-6 * (1.0 + r);
        (!(defined && no_boundary && grazing && normal)).then(|| format!("{one:?}: {found:?}"))
    }))
}

fn thousand_bounces(device: &Device, rung: Rung) -> Result<Option<String>> {
    let mut random = Random::new(40);
    let mut samples = Vec::new();
    let mut indices = Vec::new();
    for _ in 0..256 {
        let sphere = Sphere::new(random.vec3(-10.0, 10.0), random.log_within(0.01, 100.0));
        let away = random.unit_vec3() * (3.0 * sphere.radius());
        let aim = random.unit_vec3() * (0.95 * sphere.radius());
        samples.push((Ray::new(sphere.center() + away, aim - away), sphere));
        indices.push(random.within(1.1, 2.5));
    }
    let walks = ask::walks(device, rung, &samples, &indices)?;
    let entered = walks.iter().filter(|walk| walk.bounces > 0).count();
    if entered < 64 {
        return Ok(Some(format!("only {entered} of 256 rays entered")));
    }
    Ok(walks
        .iter()
        .filter(|walk| walk.bounces > 0 || walk.astray > 0)
        .find(|walk| walk.bounces != 1000 || walk.astray != 0 || walk.is_out != 1)
        .map(|walk| format!("{walk:?}")))
}

fn shadow_query(device: &Device, rung: Rung) -> Result<Option<String>> {
    let mut random = Random::new(41);
    let world: Vec<Sphere> = (0..64)
        .map(|_| Sphere::new(random.vec3(-3.0, 3.0), random.log_within(0.1, 1.0)))
        .collect();
    let rays: Vec<Ray> = (0..4096)
        .map(|_| {
            let origin = random.vec3(-6.0, 6.0);
            Ray::new(origin, random.vec3(-3.0, 3.0) - origin)
        })
        .collect();
    let hits = ask::nearest(device, rung, &rays, &world)?;
    let until = |end: fn(f32) -> f32| -> Vec<Ray> {
        rays.iter()
            .zip(&hits)
            .map(|(ray, hit)| {
                let t_max = if hit.is_some() { end(hit.t) } else { hit.t };
                Ray { t_max, ..*ray }
            })
            .collect()
    };
    let before = ask::occluded(device, rung, &until(|t| t), &world)?;
    let after = ask::occluded(device, rung, &until(f32::next_up), &world)?;
    let found = hits.iter().filter(|hit| hit.is_some()).count();
    if found < 1000 {
        return Ok(Some(format!("only {found} of 4096 rays hit anything")));
    }
    Ok(hits
        .iter()
        .zip(before.into_iter().zip(after))
        .find(|(hit, (before, after))| *before || *after != hit.is_some())
        .map(|(hit, (before, after))| {
            format!("{hit:?}, but occluded before it: {before}, up to it: {after}")
        }))
}
