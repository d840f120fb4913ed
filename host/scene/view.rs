//! [`View`]: the camera's position and direction.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use spherule_kernel::{Camera, Sphere};

use super::world::GRAIN;

/// A view, as the user describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera's position, in scene units.
    pub eye: Vec3,
    /// The point in the middle of the image.
    pub target: Vec3,
    /// The direction that points upwards in the image.
    pub up: Vec3,
    /// The angle between the image's lower and upper edge, in degrees.
    pub vertical_fov: f64,
}

impl View {
    /// The default vertical field of view, in degrees.
    pub const DEFAULT_FOV: f64 = 40.0;
    /// The fraction of the image's width or height that a framed world fills.
    const FILL: f64 = 0.94;

    /// The kernel's camera for an image `aspect` times as wide as high; `None` if
    /// [`Camera::look_at`] finds the view degenerate.
    #[must_use]
    pub fn camera(&self, aspect: f64) -> Option<Camera> {
        Camera::look_at(
            self.eye,
            self.target,
            self.up,
            self.vertical_fov.to_radians(),
            aspect,
        )
    }

    /// The nearest view along −z, with +y upwards, in which every sphere is entirely inside the
    /// image, with a small margin.
    ///
    /// A sphere is inside the view's frustum if its centre is at least a radius inside each of the
    /// four side planes. Each pair of opposite planes (left and right, lower and upper) bounds the
    /// eye by two half-planes in the plane that the pair's normals span. The apex of their
    /// intersection is the nearest eye for that pair, and the farther of the two apexes is the
    /// answer.
    #[must_use]
    pub fn framing(spheres: &[Sphere], aspect: f64) -> Self {
        let fov = Self::DEFAULT_FOV;
        let half_height = (0.5 * fov.to_radians()).tan() * Self::FILL;
        let (across, z_across) = apex(spheres, 0, half_height * aspect);
        let (upward, z_upward) = apex(spheres, 1, half_height);
        let distance_to_origin = z_across.max(z_upward);
        let eye = DVec3::new(across, upward, distance_to_origin);
        if !eye.is_finite() {
            return Self {
                eye: Vec3::ZERO,
                target: Vec3::NEG_Z,
                up: Vec3::Y,
                vertical_fov: fov,
            };
        }
        let middle =
            middle_z(spheres).min(distance_to_origin - 1e-3 * distance_to_origin.abs().max(1e-3));
        Self {
            eye: eye.as_vec3(),
            target: DVec3::new(across, upward, middle).as_vec3(),
            up: Vec3::Y,
            vertical_fov: fov,
        }
    }
}

/// The nearest eye for the two planes through it whose half-opening has the tangent `tangent` and
/// which open towards −z along `axis` (0 for x, 1 for y): its position along the axis, and its z.
fn apex(spheres: &[Sphere], axis: usize, tangent: f64) -> (f64, f64) {
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    let (low, high) = least_of_each(spheres, |center, radius| {
        // Inward normals of the planes on the low and the high side: (±cos, −sin) along (axis, z).
        // The eye e must satisfy (center − e)·n ≥ radius for both.
        (
            center[axis] * cosine - center.z * sine - radius,
            -center[axis] * cosine - center.z * sine - radius,
        )
    });
    ((low - high) / (2.0 * cosine), -(low + high) / (2.0 * sine))
}

/// The z half-way between the nearest and the farthest point of the spheres.
fn middle_z(spheres: &[Sphere]) -> f64 {
    let (behind, far) = least_of_each(spheres, |center, radius| {
        (-(center.z + radius), center.z - radius)
    });
    0.5 * (far - behind)
}

/// The minima of the two values that `of` returns for each sphere's centre and radius; on all
/// threads.
fn least_of_each(spheres: &[Sphere], of: impl Fn(DVec3, f64) -> (f64, f64) + Sync) -> (f64, f64) {
    spheres
        .par_iter()
        .with_min_len(GRAIN)
        .map(|sphere| of(sphere.center().as_dvec3(), f64::from(sphere.radius())))
        .reduce(
            || (f64::INFINITY, f64::INFINITY),
            |a, b| (a.0.min(b.0), a.1.min(b.1)),
        )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// Whether the sphere is inside the four side planes of the camera, widened by `slack`.
    fn is_inside(camera: &Camera, sphere: &Sphere, slack: f32) -> bool {
        let to_center = sphere.center() - camera.eye;
        let depth = to_center.dot(camera.forward);
        [camera.right, camera.up].iter().all(|side| {
            let half = side.length();
            let along = to_center.dot(*side / half);
            let outside = |along: f32| (along - depth * half) / half.hypot(1.0);
            outside(along) + sphere.radius() <= slack && outside(-along) + sphere.radius() <= slack
        })
    }

    #[test]
    fn framing_holds_every_sphere_and_is_tight() {
        let spheres: Vec<Sphere> = [
            Vec4::new(0.0, 0.0, 0.0, 1.0),
            Vec4::new(5.0, 1.0, -3.0, 0.5),
            Vec4::new(-2.0, -4.0, 2.0, 2.0),
            Vec4::new(1.0, 6.0, 1.0, 0.1),
        ]
        .iter()
        .map(|v| Sphere::new(v.truncate(), v.w))
        .collect();
        for aspect in [0.3, 1.0, 16.0 / 9.0] {
            let view = View::framing(&spheres, aspect);
            let camera = view.camera(aspect).expect("a camera");
            assert!(
                spheres.iter().all(|s| is_inside(&camera, s, 0.0)),
                "{view:?}"
            );
            // From a fifth of the way to the target, some sphere is not entirely inside.
            let nearer = View {
                eye: view.eye + (view.target - view.eye) * 0.2,
                ..view
            };
            let camera = nearer.camera(aspect).expect("a camera");
            assert!(
                !spheres.iter().all(|s| is_inside(&camera, s, 0.0)),
                "{nearer:?}"
            );
        }
    }

    #[test]
    fn framing_one_sphere_or_none_gives_a_camera() {
        let one = [Sphere::new(Vec3::new(1e4, -1e4, 3.0), 1e-3)];
        for spheres in [&one[..], &[]] {
            assert!(View::framing(spheres, 1.5).camera(1.5).is_some());
        }
    }
}
