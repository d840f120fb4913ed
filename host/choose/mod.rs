//! Chooses the rung for a scene: the cheapest whose bound keeps the image within a tolerance.
//!
//! The choice starts at `robust`, not at `textbook`. On a CPU `textbook` takes two to three times
//! as long, because it has none of robust's loops over many spheres at once. On a GPU that tests
//! every sphere it saves an eighth, but gets a hundred times as many pixels of a molecule wrong
//! (`docs/numerics.md`).
//!
//! An error of t does not move a point across the image of a primary ray. It moves the curve in
//! which two surfaces meet. Where the ray makes the angle α with a surface, an error of δt at
//! distance t shifts its curve with a surface across the ray by (δt/t) tan α, and with others by
//! δt/t at most. For a camera at o from the centre of a sphere of radius r, and a direction of unit
//! length, the roots are t = c/q and t = q. So δt/t is at most δc/|c| + δq/|q|, where |q| ≥ √|c|,
//! because the roots have the product c. With the unit roundoff u of the rung:
//!
//! - `robust`: c = o·o − r² is off by 2u o·o from o, 3u o·o and u r² from its products and sums,
//!   and u|c|. q = |b| + √Δ is off by 4u|o| from b = o·d. Δ = r² − f·f is off by
//!   E = 34u r|o| + 6u r² ([`bounds`](spherule_kernel::cull::bounds)), and √Δ by E/2√Δ. But
//!   sin α = √Δ/r, so that what is seen of that is at most √2 E/2r|q|, below
//!   u(25|o| + 5r)/√|c|. The silhouette shifts by the error of the foot, 17u|o|.
//! - `textbook`: its nearer root is a difference: t is off by 8u (o·o + r²)/√|c|, and not below
//!   |c|/(|o| + r). Its discriminant is off by 16u o·o, which shifts the silhouette by 8u o·o / r.
//! - `double`: as `robust`, with u = 2⁻⁵³ and an exact o.
//! - `certified`: half a unit in the last place of t.
//!
//! The centre of a sphere that moves is rounded on every rung: C + v t is off by two u of its
//! largest coordinate, seen at the distance of its surface.
//!
//! Away from the middle of the image an angle is more pixels: at the angle β from it 1/cos² β times
//! as many. The bound is that of the corners.
//!
//! Where two surfaces meet at an angle θ between their normals, the errors of both move the curve.
//! Across the image, t of a surface with normal n changes by t n/(d·n) an angle, up to what all
//! surfaces have in common. So the curve shifts by (δt₁ + δt₂)/t over |n₁/(d·n₁) − n₂/(d·n₂)|,
//! which is |n₁ − n₂| at least; and sin α times it is sin θ at least where θ is below a right
//! angle, else 1. With the shift above for each, that makes (s₁ + s₂)/sin θ, or s₁ + s₂. The radii
//! and the distance D of the centres give θ: 2 r₁ r₂ cos θ = r₁² + r₂² − D². Where the angle is so
//! small that the curvature counts, or where one sphere is inside of the other and all but touches
//! it, the errors decide in a band around the circle: |P − C₂|² − r₂² is linear in the height x of
//! a point P of the first sphere over the plane of the circle, 2D x, so that the surfaces are
//! t(s₁ + s₂) apart at x = t(s₁ + s₂) r₂/D (`meeting.rs`).
//!
//! Other shapes are bounded one by one (`shapes.rs`), not where they meet.
//!
//! Rays that start on surfaces are not in the bound: what an error of theirs moves is light, or a
//! shadow, by as little.

mod meeting;
mod neighbours;
mod shapes;
mod sight;

use spherule_kernel::Rung;

use self::meeting::View;
use crate::scene::Scene;

/// The default tolerance, in pixels.
pub const DEFAULT_TOLERANCE: f64 = 0.1;

/// Where surfaces meet, shifts below this share of the tolerance are not told apart.
const RESOLUTION: f64 = 0.5;

/// A rung, and why it was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The rung.
    pub rung: Rung,
    /// The bound of the rung on this scene, in pixels.
    pub bound: f64,
    /// Whether the bound is within the tolerance. If no rung's is, the most exact rung is chosen.
    pub is_within: bool,
    /// The next cheaper rung, if there is one, and its bound, which was not within the tolerance.
    pub cheaper: Option<(Rung, f64)>,
}

/// The rungs that are tried, the cheapest first, and the one that is taken if none of them is
/// enough. If `robust` is not enough, most rays need more digits, and then `double` was cheaper
/// than
/// `certified` on every device that was measured. `compensated` is never the cheapest. Shapes
/// beside spheres have no rung above `double`.
fn rungs(has_f64: bool, has_shapes: bool) -> (&'static [Rung], Rung) {
    match (has_f64, has_shapes) {
        (true, false) => (&[Rung::Robust, Rung::Double], Rung::Certified),
        (false, false) => (&[Rung::Robust], Rung::Certified),
        (true, true) => (&[Rung::Robust], Rung::Double),
        (false, true) => (&[], Rung::Robust),
    }
}

/// The cheapest rung whose bound is within `tolerance` pixels for the scene and its camera, on a
/// device with or without 64-bit floats; the most exact one that the scene can have if there is
/// none.
#[must_use]
pub fn choose(scene: &Scene, tolerance: f64, has_f64: bool) -> Choice {
    let (cheap, most_exact) = rungs(has_f64, !scene.world.shapes.is_empty());
    let mut cheaper = None;
    for rung in cheap {
        let bound = bound(scene, *rung, tolerance);
        if bound <= tolerance {
            return Choice {
                rung: *rung,
                bound,
                is_within: true,
                cheaper,
            };
        }
        cheaper = Some((*rung, bound));
    }
    let bound = bound(scene, most_exact, tolerance);
    Choice {
        rung: most_exact,
        bound,
        is_within: bound <= tolerance,
        cheaper,
    }
}

/// The most pixels by which the rung's errors may move anything in the scene's image, while the
/// shutter is open. Of several spheres it is at least half of `tolerance`, in pixels: where
/// surfaces meet, what is below is not searched for. Once one sphere is beyond the tolerance,
/// where spheres meet is not asked at all.
#[must_use]
pub fn bound(scene: &Scene, rung: Rung, tolerance: f64) -> f64 {
    let [open, close] = <[f32; 2]>::from(scene.lens.shutter).map(f64::from);
    let within_shutter = bound_between(scene, rung, tolerance, [open, close]);
    // Images of one ray a pixel show the time zero.
    let is_shown = scene.world.velocities.is_empty() || (open..=close).contains(&0.0);
    if is_shown {
        within_shutter
    } else {
        within_shutter.max(bound_between(scene, rung, tolerance, [0.0; 2]))
    }
}

/// The bound for the times of a shutter.
fn bound_between(scene: &Scene, rung: Rung, tolerance: f64, shutter: [f64; 2]) -> f64 {
    let camera = scene.view_or_framed();
    let (width, height) = (f64::from(scene.width), f64::from(scene.height));
    let up = (0.5 * camera.vertical_fov.to_radians()).tan();
    let across = up * width / height;
    // The angle of a pixel in a corner: the tangent of a small angle there grows by 1/cos² β.
    let pixel = 2.0 * up / height / (1.0 + up * up + across * across);
    let eye = camera.eye.as_dvec3();
    let view = View {
        scene,
        eye,
        rung,
        shutter,
    };
    let count = scene.world.spheres.len();
    let (of_spheres, around) = view.largest_shift_on_one();
    let of_one = of_spheres.max(view.largest_shift_on_a_shape());
    let within = tolerance * pixel;
    if count < 2 || of_one.is_nan() || of_one > within {
        return of_one / pixel;
    }
    let floor = within * RESOLUTION;
    of_one
        .max(floor)
        .max(view.largest_shift_between(of_one, floor, &around))
        / pixel
}

#[cfg(test)]
mod tests {
    use super::sight::Sight;
    use super::*;
    use crate::scene::{View, World};
    use glam::{DVec3, Vec3};
    use spherule_kernel::precision::{Precision, Robust};
    use spherule_kernel::{Hit, Material, Ray, Sphere};

    use crate::random::Random;

    fn scene(sphere: Sphere, eye: Vec3) -> Scene {
        let mut world = World::default();
        let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
        world.add(sphere, grey);
        let mut scene = Scene::new(world);
        scene.view = Some(View {
            eye,
            target: eye + Vec3::NEG_Z,
            up: Vec3::Y,
            vertical_fov: 40.0,
        });
        scene
    }

    #[test]
    fn molecules_get_robust_and_the_earth_more() {
        for molecule in ["1crn.pdb", "2hhb.pdb", "c60.xyz"] {
            let molecule = Scene::load(format!("scenes/{molecule}")).expect("a molecule");
            for has_f64 in [true, false] {
                let choice = choose(&molecule, DEFAULT_TOLERANCE, has_f64);
                assert_eq!(choice.rung, Rung::Robust, "{choice:?}");
                assert!(choice.is_within && choice.bound <= DEFAULT_TOLERANCE);
                assert_eq!(choice.cheaper, None);
            }
        }
        let earth = scene(
            Sphere::new(Vec3::new(0.0, -6.4e6, 0.0), 6.4e6),
            Vec3::Y * 1.7,
        );
        let choice = choose(&earth, DEFAULT_TOLERANCE, true);
        assert_eq!(choice.rung, Rung::Double);
        assert_eq!(choice.cheaper.map(|(rung, _)| rung), Some(Rung::Robust));
        assert_eq!(
            choose(&earth, DEFAULT_TOLERANCE, false).rung,
            Rung::Certified
        );
    }

    #[test]
    fn a_far_small_sphere_is_beyond_the_textbook() {
        let marble = scene(Sphere::new(Vec3::new(0.0, 0.0, -1e4), 0.5), Vec3::ZERO);
        assert!(bound(&marble, Rung::Textbook, DEFAULT_TOLERANCE) > DEFAULT_TOLERANCE);
        assert_eq!(choose(&marble, DEFAULT_TOLERANCE, false).rung, Rung::Robust);
    }

    #[test]
    fn a_camera_on_a_surface_ends_at_certified() {
        let touching = scene(Sphere::new(Vec3::NEG_Y, 1.0), Vec3::ZERO);
        let choice = choose(&touching, DEFAULT_TOLERANCE, true);
        assert_eq!((choice.rung, choice.is_within), (Rung::Certified, true));
        assert_eq!(choose(&touching, 1e9, false).rung, Rung::Certified);
    }

    /// What errors of rays from the eye move in the image is within the bound, and the bound is not
    /// many times as large.
    #[test]
    fn errors_are_within_the_bound_and_near_it() {
        let mut random = Random::new(21);
        let mut nearest = 0.0_f64;
        for _ in 0..400 {
            let radius = random.log_within(1e-2, 1e6);
            let height = radius * random.log_within(1e-6, 1e2);
            let up = random.unit_vec3();
            let center = random.unit_vec3() * random.within(0.0, 10.0);
            let sphere = Sphere::new(center, radius);
            let eye = center + up * (radius + height);
            let still = [DVec3::ZERO; 2];
            let sight = Sight::of(eye.as_dvec3(), &sphere, still);
            let bound = sight.shift(Rung::Robust);
            let o = eye.as_dvec3() - center.as_dvec3();
            for _ in 0..400 {
                // More of them graze the sphere than chance would have.
                let across = up.any_orthonormal_vector();
                let across = (across + up.cross(across) * random.within(-2.0, 2.0)).normalize();
                let sine = random.within(0.0, 1.0).powf(0.125) * radius / (radius + height);
                let direction = across * sine - up * (1.0 - sine * sine).sqrt();
                let ray = Ray::new(eye, direction);
                let robust = f64::from(Robust::intersect(sphere, &ray));
                let (d, rr) = (direction.as_dvec3(), f64::from(radius).powi(2));
                let a = d.length_squared();
                let delta = (a * rr - o.cross(d).length_squared()).max(0.0);
                let exact = (o.length_squared() - rr) / (delta.sqrt() - o.dot(d));
                if robust == f64::from(Hit::NONE_T) || exact <= 0.0 || delta == 0.0 {
                    continue;
                }
                let sine = (delta / (a * rr)).sqrt().min(1.0);
                let tangent = sine / (1.0 - sine * sine).sqrt();
                let seen = ((robust - exact) / exact).abs() * tangent.min(1.0);
                assert!(
                    seen <= bound,
                    "{seen} {bound}, radius {radius}, height {height}, sine {sine}"
                );
                nearest = nearest.max(seen / bound);
            }
        }
        assert!(nearest > 0.2, "{nearest}");
    }

    /// A sphere that is far at time 0, and all but touches the eye while the shutter is open.
    #[test]
    fn the_bound_is_that_of_the_nearest_moment() {
        let ball = |x: f32, y: f32| Sphere::new(Vec3::new(x, y, 0.0), 1000.0);
        let mut passing = scene(ball(0.0, -10.0), Vec3::new(0.0, 1000.2, 0.0));
        let rung = |scene: &Scene| choose(scene, DEFAULT_TOLERANCE, true).rung;
        assert_eq!(rung(&passing), Rung::Robust);
        passing.world.velocities = vec![Vec3::new(0.0, 10.0, 0.0)];
        assert_eq!(rung(&passing), Rung::Robust);
        passing.lens.shutter = (0.5, 1.0);
        assert_eq!(rung(&passing), Rung::Double);
        // It passes through the eye.
        passing.lens.shutter = (0.5, 1.5);
        assert_eq!(rung(&passing), Rung::Certified);
        // It crosses the view at a distance, nearest in the middle of its way.
        passing.world.spheres[0] = ball(-10.0, 0.0);
        passing.world.velocities = vec![Vec3::new(20.0, 0.0, 0.0)];
        passing.lens.shutter = (0.0, 1.0);
        assert_eq!(rung(&passing), Rung::Double);
    }

    /// Images of one ray a pixel show the time zero, whatever the shutter is.
    #[test]
    fn the_bound_is_that_of_time_zero_too() {
        let near = Sphere::new(Vec3::new(0.0, -1e6 - 1.0, 0.0), 1e6);
        let mut leaving = scene(near, Vec3::ZERO);
        assert_eq!(choose(&leaving, DEFAULT_TOLERANCE, true).rung, Rung::Double);
        leaving.world.velocities = vec![Vec3::new(0.0, -1e7, 0.0)];
        leaving.lens.shutter = (1.0, 1.0);
        assert_ne!(choose(&leaving, DEFAULT_TOLERANCE, true).rung, Rung::Robust);
    }

    /// Far from the origin the centre of a sphere that moves is rounded by more than a pixel.
    #[test]
    fn no_rung_is_within_the_rounding_of_a_motion() {
        let center = Vec3::new(-1_003_702.7, -802_962.5, -10.0);
        let mut far = scene(Sphere::new(center, 1.0), Vec3::ZERO);
        far.world.velocities = vec![Vec3::new(1_234_567.0, 987_654.0, 0.0)];
        far.lens.shutter = (0.813, 0.813);
        assert!(!choose(&far, DEFAULT_TOLERANCE, true).is_within);
    }

    /// In a corner of a wide image an angle is more pixels than in its middle.
    #[test]
    fn the_bound_is_that_of_the_corners() {
        let mut wide = scene(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 1.0), Vec3::ZERO);
        let narrow = bound(&wide, Rung::Robust, DEFAULT_TOLERANCE);
        wide.width *= 10;
        assert!(bound(&wide, Rung::Robust, DEFAULT_TOLERANCE) > 10.0 * narrow);
    }

    /// Beads that touch a shell from inside shift by no more than their size.
    #[test]
    fn beads_inside_of_a_shell_have_a_bound() {
        let mut beads = scene(Sphere::new(Vec3::ZERO, 2.0), Vec3::Z * 80.0);
        let grey = beads.world.material_ids[0];
        for bead in 0..300 {
            let turned = bead as f32 * 0.1;
            let (sine, cosine) = turned.sin_cos();
            let at = Vec3::new(cosine * cosine, sine * cosine, sine) * 1.9;
            beads.world.add(Sphere::new(at, 0.1), grey);
        }
        let choice = choose(&beads, DEFAULT_TOLERANCE, true);
        assert!(choice.is_within, "{choice:?}");
    }

    /// A fast sphere among many that rest, and one that is far from all others.
    #[test]
    fn few_odd_spheres_do_not_spoil_the_bound() {
        let mut world = scene(Sphere::new(Vec3::Z * -50.0, 0.02), Vec3::ZERO);
        let grey = world.world.material_ids[0];
        for index in 0..20_000 {
            let at = Vec3::new((index % 200) as f32, (index / 200) as f32, -60.0);
            world.world.add(Sphere::new(at, 0.02), grey);
        }
        world.world.add(Sphere::new(Vec3::Z * -1e5, 0.02), grey);
        let choice = choose(&world, DEFAULT_TOLERANCE, true);
        assert_eq!(choice.rung, Rung::Robust, "{choice:?}");
        let fast = Sphere::new(Vec3::new(-5.0, 3.3, -20.0), 0.01);
        world.world.add_moving(fast, grey, Vec3::X * 20.0);
        world.lens.shutter = (0.0, 1.0);
        let choice = choose(&world, DEFAULT_TOLERANCE, true);
        assert_eq!(choice.rung, Rung::Robust, "{choice:?}");
    }

    /// If pixels are smaller than the rounding errors of a ray, no rung is within the tolerance,
    /// and the choice says so.
    #[test]
    fn no_rung_is_within_less_than_a_ray_can_tell() {
        let mut telescope = scene(Sphere::new(Vec3::new(0.0, 0.0, -1e4), 0.5), Vec3::ZERO);
        telescope.view = telescope.view.map(|view| View {
            vertical_fov: 1e-4,
            ..view
        });
        let choice = choose(&telescope, DEFAULT_TOLERANCE, true);
        assert_eq!((choice.rung, choice.is_within), (Rung::Certified, false));
        assert!(choice.bound > DEFAULT_TOLERANCE);
    }
}
