//! What a rung's errors move in the image of a shape beside the spheres.
//!
//! The foot of a perpendicular is off by u a few times the distance D of the shape's farthest point
//! from the eye: 17 for a sphere, and no more than 64 for any shape (`shape/capsule.rs`). It moves
//! the silhouette across the ray, and t by as much over the cosine, which is left out: what it
//! moves is where surfaces meet. Seen from the distance of the nearest point that is 64u D over
//! that. On `textbook` the square of a radius is off by 128u D² instead.

use glam::DVec3;
use rayon::prelude::*;
use spherule_kernel::Rung;
use spherule_kernel::shape::Shape;

use super::meeting::View;
use crate::scene::world::GRAIN;

/// The square of this length, times 2⁻⁴⁶, still is a normal 32-bit float.
const SMALLEST: f64 = 1e-11;

impl View<'_> {
    /// The largest shift, as an angle, on any one shape beside the spheres.
    pub(super) fn largest_shift_on_a_shape(&self) -> f64 {
        let world = &self.scene.world;
        world
            .shapes
            .par_iter()
            .enumerate()
            .with_min_len(GRAIN)
            .map(|(index, shape)| {
                let velocity = world.shape_velocities.get(index);
                let velocity = velocity.map_or(DVec3::ZERO, |velocity| velocity.as_dvec3());
                let at = |time: f64| shift(self.rung, shape, self.eye - velocity * time);
                self.shutter.map(at).into_iter().fold(0.0, f64::max)
            })
            .reduce(|| 0.0, f64::max)
    }
}

/// The largest shift, as an angle, on one shape, seen from `eye`.
fn shift(rung: Rung, shape: &Shape, eye: DVec3) -> f64 {
    let (low, high) = shape.bounds();
    let (low, high) = (low.as_dvec3() - eye, high.as_dvec3() - eye);
    let farthest = low.abs().max(high.abs()).length();
    // The box's nearest point, which is not farther away than the shape's; from inside of the box,
    // half of the thickness stands for it.
    let outside = low.max(-high).max(DVec3::ZERO).length();
    let thickness = f64::from(shape.thickness(shape.kinds()));
    let nearest = outside.max(thickness);
    let (single, double) = (f64::from(f32::EPSILON) / 2.0, f64::EPSILON / 2.0);
    let of_foot = |u: f64| 64.0 * u * farthest / nearest;
    let is_normal = thickness > SMALLEST;
    match rung {
        Rung::Textbook | Rung::Robust if !is_normal => f64::INFINITY,
        Rung::Textbook => {
            let of_square = 128.0 * single * farthest * farthest / thickness;
            of_foot(single) + of_square / nearest
        }
        Rung::Robust => of_foot(single),
        Rung::Compensated | Rung::Double | Rung::Certified => of_foot(double) + single,
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use spherule_kernel::Material;
    use spherule_kernel::shape::Capsule;

    use super::super::{DEFAULT_TOLERANCE, choose};
    use super::*;
    use crate::scene::{Scene, World};

    /// Rods near by need robust; rods through a telescope, and so small that squares of their
    /// lengths are no floats, need double.
    #[test]
    fn far_and_tiny_rods_need_double() {
        for (scale, far, expected, is_within) in [
            (1.0, 1.0, Rung::Robust, true),
            (1e6, 1.0, Rung::Robust, true),
            (1.0, 1e3, Rung::Double, true),
            // The rounding of t is more than a tenth of a pixel there.
            (1.0, 1e4, Rung::Double, false),
            (1e-15, 1.0, Rung::Double, true),
        ] {
            let mut world = World::default();
            let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
            let (start, end) = (Vec3::NEG_X * scale, Vec3::X * scale);
            world.add_shape(Capsule::new(start, end, 0.2 * scale), grey);
            let mut scene = Scene::new(world);
            let mut view = scene.view_or_framed();
            view.eye *= far;
            view.vertical_fov /= f64::from(far);
            scene.view = Some(view);
            let choice = choose(&scene, DEFAULT_TOLERANCE, true);
            assert_eq!(choice.rung, expected, "{scale:e} {far:e} {choice:?}");
            assert_eq!(choice.is_within, is_within, "{scale:e} {far:e} {choice:?}");
            // Without 64-bit floats there is no other rung.
            let choice = choose(&scene, DEFAULT_TOLERANCE, false);
            assert_eq!(choice.rung, Rung::Robust);
            assert_eq!(choice.is_within, expected == Rung::Robust);
        }
    }
}
