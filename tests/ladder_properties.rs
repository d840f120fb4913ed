//! Properties of each rung over arbitrary inputs in the domain. Counterexamples are shrunk.

use glam::Vec3;
use proptest::prelude::*;
use spherule::accuracy::cases::turned_axes;
use spherule::accuracy::oracle::{Intersection, Root};
use spherule::kernel::cull::bounds::Line;
use spherule::kernel::cull::cone::{Cone, Sight};
use spherule::kernel::cull::frustum::Frustum;
use spherule::kernel::glam::Vec2;
use spherule::kernel::lane::Lane3;
use spherule::kernel::precision::certified::intersect_in_single;
use spherule::kernel::precision::{
    DEFERRING, Precision, Robust, double, entry_or_defer, intersect, intersect_or_defer,
};
use spherule::kernel::{Camera, Hit, Ray, Rung, Sphere};
use spherule::ulp;

/// A coordinate in the domain: up to 2²³, with small numbers as likely as large ones.
fn coordinate() -> impl Strategy<Value = f32> {
    (-1.0_f32..1.0, -20_i32..=23).prop_map(|(m, e)| m * 2.0_f32.powi(e))
}

fn vector() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array)
}

/// A radius in the domain, 2⁻¹⁰ to 2²³.
fn radius() -> impl Strategy<Value = f32> {
    (1.0_f32..2.0, -10_i32..23).prop_map(|(m, e)| m * 2.0_f32.powi(e))
}

/// A sphere, and a ray from anywhere that passes its centre at `off` radii: most lines through
/// random points miss by far and test nothing. One in three begins before its origin.
fn aimed() -> impl Strategy<Value = (Ray, Sphere)> {
    (
        vector(),
        vector(),
        radius(),
        vector(),
        -1.2_f32..1.2,
        -10_i32..10,
        -1.0_f32..2.0,
    )
        .prop_filter_map(
            "the direction is in the domain",
            |(origin, center, radius, aside, off, scale, start)| {
                let target = center + aside.try_normalize()? * (off * radius);
                let toward = target - origin;
                let length = 2.0_f32.powi(scale);
                let mut ray = Ray::new(origin, toward.try_normalize()? * length);
                if start < 0.0 {
                    // It begins up to four times as far behind the origin as the target is ahead;
                    // half of these have the target behind the origin.
                    ray.t_min = 4.0 * start * toward.length() / length;
                    if start < -0.5 {
                        ray.direction = -ray.direction;
                    }
                }
                Some((ray, Sphere::new(center, radius)))
            },
        )
}

/// A line that touches a sphere, or passes it by 2⁻ⁿ or by units in the last place of its radius.
/// Along turned axes everything that is computed is a sum of many products that all but cancel.
fn touching() -> impl Strategy<Value = (Ray, Sphere)> {
    let part = -60_i32..=60;
    let turn = [part.clone(), part.clone(), part.clone(), part];
    (
        turn,
        -9_i32..=9,
        -75_i32..=0,
        -1_i32..=1,
        -1_i32..=1,
        -20_i32..10,
    )
        .prop_filter_map(
            "the matrix turns",
            |(turn, start, off, side, ulps, scale)| {
                let ([along, up, aside], n) = turned_axes(turn.map(|part| part as f32));
                let radius = f32::from_bits(n.to_bits().wrapping_add_signed(ulps));
                let center = aside * (side as f32 * 2.0_f32.powi(off));
                let ray = Ray::new(up + along * start as f32, along * 2.0_f32.powi(scale));
                (n > 0.0).then_some((ray, Sphere::new(center, radius)))
            },
        )
}

/// A camera with a view of any width, a point of its film, and a sphere whose centre is `off` radii
/// away from the ray through that point. In one of four cases the camera's axes are so far from a
/// right angle that they nearly cancel.
fn seen() -> impl Strategy<Value = (Camera, Vec2, Sphere, f32)> {
    let sizes = (-4_i32..4, -4_i32..4, -12_i32..16, -9_i32..3, 0_u32..4);
    let off = prop_oneof![
        0.0_f32..2.0,
        (-20_i32..-3).prop_map(|e| 1.0 + 2.0_f32.powi(e)),
        (-20_i32..-3).prop_map(|e| 1.0 - 2.0_f32.powi(e))
    ];
    (
        vector(),
        vector(),
        vector(),
        -1.0_f32..1.0,
        -1.0_f32..1.0,
        sizes,
        off,
    )
        .prop_filter_map(
            "there is such a camera",
            |(eye, forward, aside, x, y, (width, height, far, small, skew), off)| {
                let forward = forward.try_normalize()?;
                let right = forward.cross(aside).try_normalize()?;
                let up = right.cross(forward);
                let (mut right, mut up) = (right * 2.0_f32.powi(width), up * 2.0_f32.powi(height));
                if skew == 0 {
                    // The sum of the axes is a thousandth of each.
                    right *= 2.0_f32.powi(-10 - width);
                    up = (up * 2.0_f32.powi(-10 - height) - forward) / y;
                }
                let camera = Camera::from_basis(eye, forward, right, up);
                let film = Vec2::new(x, y);
                let along = camera.ray(film).direction.try_normalize()?;
                let distance = 2.0_f32.powi(far);
                let radius = distance * 2.0_f32.powi(small);
                let beside = along.cross(aside).try_normalize()?;
                let center = eye + along * distance + beside * (off * radius);
                Some((camera, film, Sphere::new(center, radius), off))
            },
        )
}

/// The ray and the sphere with lengths scaled by 2^`length`, and the direction by 2^`direction`.
fn scaled(ray: &Ray, sphere: Sphere, length: i32, direction: i32) -> (Ray, Sphere) {
    let (length, direction) = (2.0_f32.powi(length), 2.0_f32.powi(direction));
    let of_t = |t: f32| {
        if t == Hit::NONE_T {
            t
        } else {
            (f64::from(t) * f64::from(length) / f64::from(direction)) as f32
        }
    };
    let ray = Ray::within(
        ray.origin * length,
        ray.direction * direction,
        of_t(ray.t_min),
        of_t(ray.t_max),
    );
    let sphere = Sphere::new(sphere.center() * length, sphere.radius() * length);
    (ray, sphere)
}

fn answer(rung: Rung, ray: &Ray, sphere: Sphere) -> Option<f32> {
    let t = intersect(rung.to_u32(), sphere, ray);
    hit(t)
}

fn hit(t: f32) -> Option<f32> {
    assert!(!t.is_nan());
    (t < Hit::NONE_T).then_some(t)
}

/// Compares certified with the oracle, with 64-bit floats and without: both hit or both miss, and
/// the parameter is the float nearest to the exact one.
fn certified_is_right(ray: &Ray, sphere: Sphere) -> Result<(), TestCaseError> {
    let exact = Intersection::of(ray, &sphere);
    let truth = exact.and_then(|exact| exact.nearest(ray));
    let answers = [
        ("certified", answer(Rung::Certified, ray, sphere)),
        ("in 32 bits", hit(intersect_in_single(sphere, ray).0)),
    ];
    for (name, found) in answers {
        prop_assert_eq!(
            found.is_some(),
            truth.is_some(),
            "{}: {:?} {:?}",
            name,
            found,
            truth
        );
        if let (Some(found), Some(truth)) = (found, truth) {
            prop_assert!(found == truth, "{name}: {found:e} {truth:e}");
        }
    }
    Ok(())
}

/// The ray with intervals that begin or end at one of the sphere's roots, or up to two units in the
/// last place beside it.
fn with_ends_at_roots(ray: &Ray, sphere: Sphere) -> Vec<Ray> {
    let Some(exact) = Intersection::of(ray, &sphere) else {
        return Vec::new();
    };
    let near_and_far = [Root::Near, Root::Far].map(|root| exact.root(root));
    let mut rays = Vec::new();
    for root in near_and_far.into_iter().flatten().filter(|t| t.is_normal()) {
        for ulps in -2_i32..=2 {
            let end = f32::from_bits(root.to_bits().wrapping_add_signed(ulps));
            rays.push(Ray { t_min: end, ..*ray });
            rays.push(Ray {
                t_min: f32::MIN,
                t_max: end,
                ..*ray
            });
        }
    }
    rays
}

/// A ray along an axis whose roots are whole numbers and a half in units of their last place, so
/// that they lie in the middle between two floats, or a little beside it.
fn half_way() -> impl Strategy<Value = (Ray, Sphere)> {
    (
        1_i32 << 22..1 << 23,
        1_i32..64,
        1_i32..8,
        -60_i32..60,
        -80_i32..-20,
        0..3_usize,
        any::<bool>(),
    )
        .prop_map(|(far, radius, parts, length, aside, axis, is_beside)| {
            let unit = 2.0_f32.powi(length);
            let along = |x: f32, y: f32| {
                let mut vector = Vec3::ZERO;
                vector[axis] = x * unit;
                vector[(axis + 1) % 3] = y * unit;
                vector
            };
            let aside = if is_beside { 2.0_f32.powi(aside) } else { 0.0 };
            // The radius has a bit below the last one of the distance.
            let radius = radius as f32 + parts as f32 / 8.0;
            let ray = Ray::new(along(-(far as f32), aside), along(1.0, 0.0) / unit);
            (ray, Sphere::new(Vec3::ZERO, radius * unit))
        })
}

/// A ray that starts on a sphere, up to the rounding of its origin, and all but touches it there:
/// each term of its quadratic but a is all but rounding.
fn grazing_from_the_surface() -> impl Strategy<Value = (Ray, Sphere)> {
    (
        vector(),
        radius(),
        vector(),
        vector(),
        -40_i32..-10,
        -1.0_f32..1.0,
        -40_i32..0,
    )
        .prop_filter_map(
            "there are such directions",
            |(center, radius, out, aside, tilt, sign, start)| {
                let center = center * 0.001;
                let out = out.try_normalize()?;
                let along = out.cross(aside).try_normalize()?;
                let direction = along + out * (sign * 2.0_f32.powi(tilt));
                let mut ray = Ray::new(center + out * radius, direction);
                if sign > 0.5 {
                    ray.t_min = -radius;
                } else if sign > 0.0 {
                    ray.t_min = radius * 2.0_f32.powi(start);
                }
                Some((ray, Sphere::new(center, radius)))
            },
        )
}

/// How far the point of a hit is from the sphere.
fn off_the_sphere(ray: &Ray, sphere: Sphere, t: f32) -> f64 {
    let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
    ((point - sphere.center().as_dvec3()).length() - f64::from(sphere.radius())).abs()
}

/// What boxes are widened by for robust, which must hold all its hits.
fn robust_stays_near(ray: &Ray, sphere: Sphere) -> Result<(), TestCaseError> {
    if let Some(t) = answer(Rung::Robust, ray, sphere) {
        let far = (sphere.center() - ray.origin).abs() + sphere.radius();
        let off = off_the_sphere(ray, sphere, t);
        let widened = f64::from(Robust::widening(far, sphere.radius()));
        prop_assert!(off <= widened, "{off:e} off, {widened:e} allowed");
    }
    Ok(())
}

/// Found by an oracle: robust put the hit at t = 1, half a radius away from the sphere.
#[test]
fn robust_is_near_a_sphere_that_it_touches_where_it_starts() {
    let ray = Ray::within(
        Vec3::new(
            0x00af_d959 as f32 / 16_777_216.0,
            -(0x004e_c69b as f32) / 67_108_864.0,
            -(0x0011_ff11 as f32) / 2_097_152.0,
        ),
        Vec3::new(
            -(0x0081_64bf as f32) / 16_777_216.0,
            -(0x00c8_5cfb as f32) / 33_554_432.0,
            -(0x00b7_b213 as f32) / 8_388_608.0,
        ),
        0x0071_074b as f32 / 8_388_608.0,
        Hit::NONE_T,
    );
    let sphere = Sphere::new(Vec3::new(0.1, 0.2, -0.3), 0.7);
    robust_stays_near(&ray, sphere).expect("near the sphere");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn certified_is_the_truth((ray, sphere) in aimed()) {
        certified_is_right(&ray, sphere)?;
    }

    #[test]
    fn certified_is_the_truth_where_lines_touch((ray, sphere) in touching()) {
        certified_is_right(&ray, sphere)?;
    }

    #[test]
    fn robust_stays_near_its_spheres((ray, sphere) in prop_oneof![aimed(), touching(), grazing_from_the_surface()]) {
        robust_stays_near(&ray, sphere)?;
    }

    #[test]
    fn certified_is_the_truth_for_rays_that_graze_from_the_surface((ray, sphere) in grazing_from_the_surface()) {
        certified_is_right(&ray, sphere)?;
    }

    #[test]
    fn certified_is_the_truth_half_way_between_floats((ray, sphere) in half_way()) {
        certified_is_right(&ray, sphere)?;
        for ray in with_ends_at_roots(&ray, sphere) {
            certified_is_right(&ray, sphere)?;
        }
    }

    #[test]
    fn certified_is_the_truth_at_the_ends_of_intervals((ray, sphere) in prop_oneof![aimed(), touching()]) {
        for ray in with_ends_at_roots(&ray, sphere) {
            certified_is_right(&ray, sphere)?;
        }
    }

    /// The same if squares of lengths and directions overflow or underflow.
    #[test]
    fn certified_is_the_truth_in_all_units((ray, sphere) in aimed(), length in -70_i32..90, apart in -50_i32..50) {
        let (ray, sphere) = scaled(&ray, sphere, length, (length + apart).clamp(-90, 100));
        certified_is_right(&ray, sphere)?;
    }

    /// The parameter is a normal float here, and unscaled intermediate results would not be.
    #[test]
    fn parameters_keep_their_digits_whatever_the_units(height in 0.1_f32..0.5, from in 0.9_f32..1.0, length in 80_i32..100) {
        let unit = 2.0_f32.powi(length);
        let ray = Ray::new(Vec3::new(from * unit, height * unit, 0.0), Vec3::new(-1.5 * 2.0_f32.powi(126), 0.0, 0.0));
        let sphere = Sphere::new(Vec3::ZERO, unit);
        let truth = Intersection::of(&ray, &sphere).and_then(|exact| exact.nearest(&ray));
        let truth = truth.expect("the ray starts inside");
        for rung in [Rung::Compensated, Rung::Certified] {
            let found = answer(rung, &ray, sphere).unwrap_or(f32::NAN);
            prop_assert!(ulp::distance(found, truth) <= 1, "{} {found:e} {truth:e}", rung.name());
        }
    }

    /// A change of units changes no bit of what the compensated rung finds.
    #[test]
    fn compensated_is_the_same_in_all_units((ray, sphere) in aimed(), length in -40_i32..90, apart in -50_i32..50) {
        let found = answer(Rung::Compensated, &ray, sphere);
        let direction = (length + apart).clamp(-90, 100);
        let (ray, sphere) = scaled(&ray, sphere, length, direction);
        let again = answer(Rung::Compensated, &ray, sphere);
        let expected = found.map(|t| f64::from(t) * 2.0_f64.powi(length - direction));
        prop_assert_eq!(again.map(f64::from), expected);
    }

    /// Every rung above textbook finds what the bounds say is certain.
    #[test]
    fn bounds_are_certain((ray, sphere) in aimed()) {
        let line = Line::of(&ray);
        let bounds = line.bounds(sphere);
        prop_assert!(!(bounds.misses & bounds.hits));
        for rung in [Rung::Robust, Rung::Compensated, Rung::Double, Rung::Certified] {
            let found = answer(rung, &ray, sphere);
            if bounds.misses {
                prop_assert_eq!(found, None, "{} {:?}", rung.name(), bounds);
            }
            if bounds.hits {
                let t = found.map_or(f32::NAN, |t| t * line.unit);
                let is_within = (bounds.low..=bounds.high).contains(&t);
                prop_assert!(is_within, "{} {t} {bounds:?}", rung.name());
            }
        }
        let is_hit = Rung::ALL.into_iter().any(|rung| answer(rung, &ray, sphere).is_some());
        prop_assert!(line.may_hit(sphere) | !is_hit);
    }

    /// What the first of two launches decides is what the whole rung finds.
    #[test]
    fn first_steps_are_certain((ray, sphere) in prop_oneof![aimed(), touching()]) {
        let whole = intersect(Rung::Certified.to_u32(), sphere, &ray);
        let first = intersect_or_defer(DEFERRING, sphere, &ray);
        prop_assert!((first == whole) | (first == Hit::DEFERRED_T), "{first:e} {whole:e}");
        let line = Line::of(&ray);
        let bounds = line.bounds(sphere);
        if bounds.hits {
            let (low, high) = (bounds.low / line.unit, bounds.high / line.unit);
            let entry = entry_or_defer(DEFERRING, sphere, &ray, low, high);
            prop_assert!((entry == whole) | (entry == Hit::DEFERRED_T), "{entry:e} {whole:e}");
        }
    }

    /// If a rung finds a hit, the ray meets the cone, whatever the length of its direction. A ray
    /// that is far off does not meet the cone, and no ray meets the cone of no sphere.
    #[test]
    fn cones_hold_all_hits((camera, film, sphere, off) in seen(), before in any::<u32>(), exponent in -80_i32..80) {
        let ray = camera.ray(film);
        let cone = Cone::of(sphere, camera.eye);
        let sight = Sight::along(ray.direction);
        let after = sight.misses(before, cone);
        prop_assert_eq!(after >> 1, before << 1 >> 1);
        let may_meet = after & 1 == 0;
        let is_hit = Rung::ALL.into_iter().any(|rung| answer(rung, &ray, sphere).is_some());
        prop_assert!(may_meet | !is_hit, "{:?} {:?}", cone, sight);
        let scaled = Sight::along(ray.direction * 2.0_f32.powi(exponent));
        prop_assert!((scaled.misses(0, cone) == 0) | !is_hit, "{:?} {:?}", cone, scaled);
        prop_assert_eq!((sight.misses(0, Cone::none()), scaled.misses(0, Cone::none())), (1, 1));
        let (o, r) = (sphere.center() - camera.eye, sphere.radius());
        // The ray is beyond the silhouette by a fifth, the eye is outside, and the sphere is large
        // enough: a hundredth of its distance.
        if off > 1.2 && o.length() > 1.5 * r && r > 0.01 * o.length() && o.length() > 1e-3 * camera.eye.length() {
            prop_assert!(!may_meet, "{:?} {:?}", cone, sight);
        }
    }

    /// If a rung finds a hit for a ray through a rectangle of the film, the frustum does not miss
    /// the sphere. A frustum around one point misses spheres that are far off.
    #[test]
    fn frusta_hold_all_hits((camera, film, sphere, off) in seen(), around in prop::array::uniform4(0_u32..3)) {
        let ray = camera.ray(film);
        let [left, right, below, above] = around.map(|size| 0.05 * size as f32);
        let low = film - Vec2::new(left, below);
        let high = film + Vec2::new(right, above);
        let frustum = Frustum::around(&camera, low, high);
        let point = Frustum::around(&camera, film, film);
        for rung in Rung::ALL {
            let is_hit = answer(rung, &ray, sphere).is_some();
            let misses = |frustum: &Frustum| frustum.misses(rung.to_u32(), sphere);
            prop_assert!(!(is_hit & misses(&frustum)), "{} {:?}", rung.name(), frustum);
            prop_assert!(!(is_hit & misses(&point)), "{} {:?}", rung.name(), point);
        }
        let (o, r) = (sphere.center() - camera.eye, sphere.radius());
        let is_square = camera.forward.dot(camera.up).abs() < 1e-3 * camera.up.length();
        // All four planes contain the ray, and the normal of one of them is within 55° of the
        // direction from the ray to the sphere.
        let is_plain = is_square && camera.right.length().max(camera.up.length()) < 1.5;
        let is_far_off = is_plain && off > 1.8 && o.length() > 1.5 * r && o.length() > 1e-3 * camera.eye.length();
        for (rung, smallest) in [(Rung::Textbook, 0.02), (Rung::Robust, 1e-4)] {
            if is_far_off && r > smallest * o.length() {
                prop_assert!(point.misses(rung.to_u32(), sphere), "{} {:?}", rung.name(), point);
            }
        }
    }

    /// Outside of the margin on |Δ| / (a r²), hit and miss are right, and t is within 1 ulp where c
    /// and q have digits.
    #[test]
    fn compensated_and_double_are_right_outside_their_margin(
        (ray, sphere) in prop_oneof![aimed(), grazing_from_the_surface(), touching()]
    ) {
        let exact = Intersection::of(&ray, &sphere).expect("a line");
        let o = ray.origin.as_dvec3() - sphere.center().as_dvec3();
        let d = ray.direction.as_dvec3();
        let (r, a, oo) = (f64::from(sphere.radius()), d.length_squared(), o.length_squared());
        let far = 1.0 + o.length() / r;
        let c = double::residual(
            Lane3::of(ray.origin).widened(),
            Lane3::of(sphere.center()).widened(),
            r,
        );
        let root = (exact.margin() * a * r * r).sqrt();
        let q = o.dot(d).abs() + root;
        for (rung, band, of_c) in [(Rung::Compensated, -38, -19), (Rung::Double, -46, -46)] {
            let band = 2.0_f64.powi(band) * far;
            let c_has_digits = c.abs() >= 2.0_f64.powi(of_c) * (oo + r * r);
            if exact.margin() <= band * far || !c_has_digits {
                continue;
            }
            let truth = exact.nearest(&ray);
            let found = answer(rung, &ray, sphere);
            let q_has_digits = root * q >= band * 2.0_f64.powi(24) * a * r * r;
            if !q_has_digits {
                continue;
            }
            // The rounded root may be on the other side of the interval's start.
            let is_at_start = exact.root(Root::Near).is_some_and(|t| ulp::distance(t, ray.t_min) <= 1)
                || exact.root(Root::Far).is_some_and(|t| ulp::distance(t, ray.t_min) <= 1);
            prop_assert!(found.is_some() == truth.is_some() || is_at_start, "{} {:?} {:?}", rung.name(), found, truth);
            if let (Some(found), Some(truth), false) = (found, truth, is_at_start) {
                prop_assert!(ulp::distance(found, truth) <= 1, "{} {found:e} {truth:e}", rung.name());
            }
        }
    }

    /// No rung returns NaN or a parameter outside of the ray's interval, whatever its input.
    #[test]
    fn every_answer_is_in_the_rays_interval(bits in prop::array::uniform12(any::<u32>())) {
        let [ox, oy, oz, dx, dy, dz, cx, cy, cz, r, t_min, t_max] = bits.map(f32::from_bits);
        let ray = Ray::within(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz), t_min, t_max);
        let sphere = Sphere::new(Vec3::new(cx, cy, cz), r);
        for rung in Rung::ALL {
            if let Some(t) = answer(rung, &ray, sphere) {
                prop_assert!(t >= t_min && t < t_max, "{}: {t:e}", rung.name());
            }
        }
    }
}
