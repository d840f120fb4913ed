//! The spheres that cast caustics.

use spherule_kernel::Material;
use spherule_kernel::material::microfacet::SMOOTHEST;
use spherule_kernel::path::caustic::casters::Entry;

use super::World;

/// The most spheres whose caustics are looked for: the largest. Light by others is found by
/// chance, as without caustics. More would share out the samples too thinly, and the probabilities
/// of so many keep their digits in 32-bit floats.
const MOST: usize = 4096;

/// No sphere counts for more than so many times the area of the median: a mirror that is the ground
/// would leave nothing to the others.
const LARGEST: f64 = 16.0;

impl World {
    /// The spheres that cast caustics, by index, with their probabilities: mirrors, and balls of
    /// glass that no other glass overlaps, solid or with a hollow about their centre. They share
    /// the choice by the area that they show. `is_absolute` is that of [`World::lone_glass`].
    pub(crate) fn casters(&self, is_absolute: bool) -> Vec<Entry> {
        let is_mirror: Vec<bool> = self
            .materials
            .iter()
            .map(|m| m.kind == Material::METAL && m.parameter < SMOOTHEST)
            .collect();
        let ids = self.material_ids.iter().zip(0_u32..);
        let mirrors = ids
            .filter(|(id, _)| is_mirror.get(**id as usize) == Some(&true))
            .map(|(_, index)| (index, None));
        // Where glass is thinner than what surrounds it, the ways are not counted.
        let is_dense = |index: u32| {
            let id = self.material_ids[index as usize];
            self.materials[id as usize].parameter >= 1.0
        };
        let mut found = self.lone_glass(is_absolute);
        found.retain(|(index, _)| is_dense(*index));
        found.extend(mirrors);
        let area = |index: u32| {
            let sphere = self
                .spheres
                .get(index as usize)
                .copied()
                .unwrap_or_default();
            f64::from(sphere.radius()).powi(2)
        };
        found.sort_by(|a, b| area(b.0).total_cmp(&area(a.0)).then(a.0.cmp(&b.0)));
        found.truncate(MOST);
        let median = found
            .get(found.len() / 2)
            .map_or(0.0, |middle| area(middle.0));
        let weight = |index: u32| area(index).min(LARGEST * median);
        found.sort_unstable();
        let total: f64 = found.iter().map(|(index, _)| weight(*index)).sum();
        let entry = |(sphere, hollow): (u32, Option<u32>)| {
            let probability = (weight(sphere) / total) as f32;
            Entry::new(sphere, hollow, probability)
        };
        found.into_iter().map(entry).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use spherule_kernel::Sphere;

    #[test]
    fn large_mirrors_leave_a_share_to_the_others() {
        let mut world = World::default();
        let kinds = [
            Material::metal(Vec3::ONE, 0.0),
            Material::metal(Vec3::ONE, 0.5),
            Material::glass(1.5, Vec3::ZERO),
            Material::glass(0.9, Vec3::ZERO),
        ];
        let ids = kinds.map(|kind| world.add_material(kind));
        let at = |x: f32, radius: f32| Sphere::new(Vec3::X * x, radius);
        world.add(at(1005.0, 1000.0), ids[0]);
        world.add(at(0.0, 1.0), ids[2]);
        world.add(at(-5.0, 1.0), ids[1]);
        world.add(at(-10.0, 1.0), ids[3]);
        world.add(at(-15.0, 1.0), ids[0]);
        let casters = world.casters(false);
        let found: Vec<(u32, f32)> = casters.iter().map(|c| (c.sphere, c.probability)).collect();
        let share = 1.0 / 18.0;
        assert_eq!(found, [(0, 16.0 * share), (1, share), (4, share)]);
    }
}
