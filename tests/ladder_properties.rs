//! Properties of each rung over arbitrary inputs in the domain. Counterexamples are shrunk.

use glam::Vec3;
use proptest::prelude::*;
use spherule::accuracy::cases::turned_axes;
use spherule::accuracy::oracle::Intersection;
use spherule::kernel::cull::bounds::Line;
use spherule::kernel::cull::cone::{Cone, Sight};
use spherule::kernel::cull::frustum::Frustum;
use spherule::kernel::glam::Vec2;
use spherule::kernel::precision::intersect;
use spherule::kernel::{Camera, Hit, Ray, Rung, Sphere};
use spherule::ulp;

/// A coordinate in the domain: up to 2²⁰, with small numbers as likely as large ones.
fn coordinate() -> impl Strategy<Value = f32> {
    (-1.0_f32..1.0, -20_i32..=20).prop_map(|(m, e)| m * 2.0_f32.powi(e))
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
    assert!(!t.is_nan());
    (t < Hit::NONE_T).then_some(t)
}

/// Compares certified with the oracle: both hit or both miss, and the parameters are within one
/// unit in the last place.
fn certified_is_right(ray: &Ray, sphere: Sphere) -> Result<(), TestCaseError> {
    let truth = Intersection::of(ray, &sphere).and_then(|exact| exact.nearest(ray));
    let found = answer(Rung::Certified, ray, sphere);
    prop_assert_eq!(found.is_some(), truth.is_some(), "{:?} {:?}", found, truth);
    if let (Some(found), Some(truth)) = (found, truth) {
        prop_assert!(ulp::distance(found, truth) <= 1, "{found:e} {truth:e}");
    }
    Ok(())
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
        let is_hit = Rung::ALL.into_iter().any(|rung| answer(rung, &ray, sphere).is_some());
        let [left, right, below, above] = around.map(|size| 0.05 * size as f32);
        let low = film - Vec2::new(left, below);
        let high = film + Vec2::new(right, above);
        let frustum = Frustum::around(&camera, low, high);
        prop_assert!(!(is_hit & frustum.misses(sphere)), "{:?}", frustum);
        let point = Frustum::around(&camera, film, film);
        prop_assert!(!(is_hit & point.misses(sphere)), "{:?}", point);
        let (o, r) = (sphere.center() - camera.eye, sphere.radius());
        let is_square = camera.forward.dot(camera.up).abs() < 1e-3 * camera.up.length();
        // All four planes contain the ray, and the normal of one of them is within 45° of the
        // direction from the ray to the sphere.
        let is_plain = is_square && camera.right.length().max(camera.up.length()) < 1.5;
        if is_plain && off > 1.7 && o.length() > 1.5 * r && r > 0.02 * o.length() && o.length() > 1e-3 * camera.eye.length() {
            prop_assert!(point.misses(sphere), "{:?}", point);
        }
    }

    /// Outside of the margin on |Δ| / (a r²), hit and miss are right, and t is within 1 ulp where c
    /// has digits.
    #[test]
    fn compensated_and_double_are_right_outside_their_margin((ray, sphere) in aimed()) {
        let exact = Intersection::of(&ray, &sphere).expect("a line");
        let o = ray.origin.as_dvec3() - sphere.center().as_dvec3();
        let r = f64::from(sphere.radius());
        let relative = 1.0 + o.length() / r;
        let c_has_digits = (o.length_squared() - r * r).abs()
            >= 2.0_f64.powi(-19) * (o.length_squared() + r * r);
        for (rung, bits) in [(Rung::Compensated, -38), (Rung::Double, -46)] {
            if exact.margin() <= 2.0_f64.powi(bits) * relative * relative || !c_has_digits {
                continue;
            }
            let truth = exact.nearest(&ray);
            let found = answer(rung, &ray, sphere);
            prop_assert_eq!(found.is_some(), truth.is_some(), "{} {:?} {:?}", rung.name(), found, truth);
            // The error of √Δ counts only where Δ is not tiny.
            if let (Some(found), Some(truth)) = (found, truth)
                && exact.margin() > 2.0_f64.powi(bits / 2)
            {
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
