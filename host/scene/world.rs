//! [`World`]: spheres and materials in the kernel's types.

use glam::Vec3;
use spherule_kernel::{Material, Sphere};

/// With fewer spheres than this, a single thread does the work.
use crate::error::Result;
use crate::memory;
pub(crate) const GRAIN: usize = 1 << 13;

/// A world of spheres in the kernel's types, which is uploaded as it is.
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
    /// The names of the materials, for messages; empty for those without a name.
    pub material_names: Vec<String>,
    /// The velocities of the spheres, in scene units per unit of time; empty if none moves.
    pub velocities: Vec<Vec3>,
}

/// Bits that are the same exactly for equal spheres that move alike.
pub(crate) fn bits_of(sphere: &Sphere, velocity: Vec3) -> [u32; 7] {
    let [x, y, z] = sphere.center().to_array().map(f32::to_bits);
    let [u, v, w] = velocity.to_array().map(f32::to_bits);
    [x, y, z, sphere.radius().to_bits(), u, v, w]
}

impl World {
    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.add_named_material("", material)
    }

    /// Adds a material with a name for messages, and returns its index.
    pub fn add_named_material(&mut self, name: &str, material: Material) -> u32 {
        self.materials.push(material);
        self.material_names
            .resize(self.materials.len() - 1, String::new());
        self.material_names.push(name.into());
        self.materials.len() as u32 - 1
    }

    /// Adds a sphere with the material of this index.
    pub fn add(&mut self, sphere: Sphere, material: u32) {
        self.spheres.push(sphere);
        self.material_ids.push(material);
        if !self.velocities.is_empty() {
            self.velocities.push(Vec3::ZERO);
        }
    }

    /// Adds a moving sphere; `velocity` is in scene units per unit of time. At time 0 it is at its
    /// given centre.
    pub fn add_moving(&mut self, sphere: Sphere, material: u32, velocity: Vec3) {
        self.velocities.resize(self.spheres.len(), Vec3::ZERO);
        self.spheres.push(sphere);
        self.material_ids.push(material);
        self.velocities.push(velocity);
    }

    /// Adds the spheres and materials of another world.
    pub fn append(&mut self, other: &Self) {
        let offset = self.materials.len() as u32;
        let moves = !(self.velocities.is_empty() && other.velocities.is_empty());
        if moves {
            self.velocities.resize(self.spheres.len(), Vec3::ZERO);
            self.velocities.extend_from_slice(&other.velocities);
        }
        self.materials.extend_from_slice(&other.materials);
        self.material_names.resize(offset as usize, String::new());
        self.material_names.extend_from_slice(&other.material_names);
        self.material_names
            .resize(self.materials.len(), String::new());
        self.spheres.extend_from_slice(&other.spheres);
        self.material_ids.extend(
            other
                .material_ids
                .iter()
                .map(|id| id.saturating_add(offset)),
        );
        if moves {
            self.velocities.resize(self.spheres.len(), Vec3::ZERO);
        }
    }

    /// The same spheres, each with its own index in place of its material's.
    ///
    /// # Errors
    ///
    /// [`OutOfHostMemory`](crate::Error::OutOfHostMemory) if there is no room for the copy.
    pub(crate) fn numbered(&self) -> Result<Self> {
        let count = self.spheres.len();
        let mut spheres = memory::room(count as u64, "a copy of the spheres")?;
        spheres.extend_from_slice(&self.spheres);
        let mut material_ids = memory::room(count as u64, "the indices of the spheres")?;
        material_ids.extend(0..count as u32);
        Ok(Self {
            spheres,
            material_ids,
            ..Self::default()
        })
    }
}
