//! Equal spheres, of which only one can be seen.

use std::hash::{DefaultHasher, Hash, Hasher};

use glam::Vec3;
use rayon::prelude::*;

use super::World;
use super::world::{GRAIN, bits_of};

impl World {
    /// [`bits_of`] the sphere with this index.
    fn key(&self, index: usize) -> [u32; 7] {
        let sphere = &self.spheres[index];
        let velocity = self.velocities.get(index).copied().unwrap_or_default();
        bits_of(sphere, velocity)
    }

    /// The world without copies: of equal spheres that move alike, the first is kept. `None` if
    /// there are no copies.
    ///
    /// A ray that leaves a sphere passes over it, and would meet a copy of it where it starts.
    #[must_use]
    pub fn without_copies(&self) -> Option<Self> {
        let hash = |index: usize| {
            let mut hasher = DefaultHasher::new();
            self.key(index).hash(&mut hasher);
            (hasher.finish(), index)
        };
        let mut hashes: Vec<(u64, usize)> = (0..self.spheres.len())
            .into_par_iter()
            .with_min_len(GRAIN)
            .map(hash)
            .collect();
        hashes.par_sort_unstable();
        let mut is_copy = vec![false; self.spheres.len()];
        for run in hashes.chunk_by(|a, b| a.0 == b.0) {
            for (at, (_, index)) in run.iter().enumerate() {
                let mut before = run[..at].iter();
                is_copy[*index] = before.any(|(_, other)| self.key(*other) == self.key(*index));
            }
        }
        if !is_copy.contains(&true) {
            return None;
        }
        let mut world = Self {
            materials: self.materials.clone(),
            material_names: self.material_names.clone(),
            ..Self::default()
        };
        let kept = (0..self.spheres.len()).filter(|index| !is_copy[*index]);
        for index in kept {
            let sphere = self.spheres[index];
            // A world that is not valid may have fewer.
            let material = self.material_ids.get(index).copied().unwrap_or_default();
            match self.velocities.get(index) {
                Some(velocity) if *velocity != Vec3::ZERO => {
                    world.add_moving(sphere, material, *velocity);
                }
                _ => world.add(sphere, material),
            }
        }
        Some(world)
    }
}

#[cfg(test)]
mod tests {
    use spherule_kernel::{Material, Sphere};

    use super::*;

    #[test]
    fn the_first_of_equal_spheres_is_kept() {
        let mut world = World::default();
        for _ in 0..3 {
            world.add_material(Material::diffuse(Vec3::ONE));
        }
        let (one, other) = (Sphere::new(Vec3::ONE, 1.0), Sphere::new(Vec3::ONE, 2.0));
        world.add(one, 0);
        world.add(other, 0);
        assert_eq!(world.without_copies(), None);
        world.add(one, 1);
        world.add_moving(one, 2, Vec3::X);
        world.add_moving(one, 1, Vec3::X);
        let kept = world.without_copies().expect("copies");
        assert_eq!(kept.spheres, [one, other, one]);
        assert_eq!(kept.material_ids, [0, 0, 2]);
        assert_eq!(kept.velocities, [Vec3::ZERO, Vec3::ZERO, Vec3::X]);
    }
}
