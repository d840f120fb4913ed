//! Moves a scene that is far from the origin to it, without an error.
//!
//! Light paths start at points on surfaces, and a point at the coordinate 10⁶ is 0.06 off in 32-bit
//! floats. Near the origin it is not. The difference of two floats of about the same size is exact,
//! so that most scenes can be moved without changing anything; those that cannot stay where they
//! are.

use glam::Vec3;
use spherule_kernel::Sphere;

use crate::scene::{Scene, View, origin};

/// The scene, moved so that what its camera looks at is near the origin; `None` if it is near it
/// already, or if some coordinate would be rounded.
pub(super) fn rebased(scene: &Scene) -> Option<Scene> {
    let view = scene.view_or_framed();
    let origin = origin::of(&view)?;
    let moved = |point: Vec3| {
        let difference = point.as_dvec3() - origin;
        let rounded = difference.as_vec3();
        (rounded.as_dvec3() == difference).then_some(rounded)
    };
    let (eye, target) = (moved(view.eye)?, moved(view.target)?);
    // Where a sphere in motion is would be rounded in another place; other shapes stay where they
    // are.
    if !scene.world.velocities.is_empty() || !scene.world.shapes.is_empty() {
        return None;
    }
    let spheres = scene.world.spheres.iter();
    let spheres: Option<Vec<Sphere>> = spheres
        .map(|sphere| Some(Sphere::new(moved(sphere.center())?, sphere.radius())))
        .collect();
    let spheres = spheres?;
    let mut scene = scene.clone();
    scene.origin += origin;
    scene.world.spheres = spheres;
    for light in &mut scene.lights {
        light.position = moved(light.position)?;
    }
    if let Some(fog) = &mut scene.fog
        && fog.medium.radius > 0.0
    {
        fog.medium.center = moved(fog.medium.center)?;
    }
    scene.view = Some(View {
        eye,
        target,
        ..view
    });
    Some(scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{PointLight, World};
    use spherule_kernel::Material;

    fn scene(at: Vec3) -> Scene {
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::ONE));
        world.add(Sphere::new(at, 0.5), white);
        world.add(Sphere::new(at - Vec3::Y * 6_371_000.0, 6_371_000.0), white);
        let mut scene = Scene::new(world);
        scene.lights.push(PointLight {
            position: at + Vec3::Y * 4.0,
            intensity: Vec3::ONE,
        });
        scene.view = Some(View {
            eye: at + Vec3::Z * 8.0,
            target: at,
            up: Vec3::Y,
            vertical_fov: 40.0,
        });
        scene
    }

    /// Every distance stays what it was.
    #[test]
    fn far_scenes_move_without_an_error() {
        let moved = rebased(&scene(Vec3::new(1e6, -1e6, 1e6))).expect("a scene");
        let view = moved.view.expect("a view");
        assert!(view.target.abs().max_element() <= 8.0, "{view:?}");
        let near = scene(view.target);
        assert_eq!(moved.world.spheres, near.world.spheres);
        assert_eq!(moved.lights[0].position, near.lights[0].position);
        assert_eq!(moved.view, near.view);
    }

    #[test]
    fn others_stay() {
        assert!(rebased(&scene(Vec3::ONE)).is_none());
        let mut fine = scene(Vec3::splat(1e6));
        fine.world.add(Sphere::new(Vec3::splat(0.1), 0.5), 0);
        assert!(rebased(&fine).is_none());
        let mut moving = scene(Vec3::splat(1e6));
        moving.world.velocities = vec![Vec3::X; 2];
        assert!(rebased(&moving).is_none());
    }
}
