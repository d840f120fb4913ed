//! [`World`]: spheres and materials as the kernel takes them.

use spherule_kernel::{Material, Sphere};

/// A world of spheres, made on the host out of the device's own types and uploaded as it is.
///
/// ```
/// use spherule::scene::World;
/// use spherule::kernel::{Material, Sphere, glam::Vec3};
///
/// let mut world = World::default();
/// let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
/// world.add(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5), grey);
/// assert_eq!(world.spheres.len(), 1);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    /// The spheres.
    pub spheres: Vec<Sphere>,
    /// For each sphere, the index of its material.
    pub material_ids: Vec<u32>,
    /// The materials.
    pub materials: Vec<Material>,
}

impl World {
    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Adds a sphere of the material with this index.
    pub fn add(&mut self, sphere: Sphere, material: u32) {
        self.spheres.push(sphere);
        self.material_ids.push(material);
    }

    /// Adds the spheres and materials of another world.
    pub fn append(&mut self, other: &Self) {
        let offset = self.materials.len() as u32;
        self.materials.extend_from_slice(&other.materials);
        self.spheres.extend_from_slice(&other.spheres);
        self.material_ids
            .extend(other.material_ids.iter().map(|id| id + offset));
    }
}
