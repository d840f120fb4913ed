//! [`World`]: spheres, other shapes and materials in the kernel's types.

use std::borrow::Cow;

use glam::Vec3;
use spherule_kernel::shape::{Kinds, Shape};
use spherule_kernel::{Material, Sphere};

use crate::error::Result;
use crate::memory;
use crate::plural::contents_of;

/// With fewer spheres than this, a single thread does the work.
pub(crate) const GRAIN: usize = 1 << 13;

/// A world of spheres and other shapes in the kernel's types, which is uploaded as it is.
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
    /// The shapes beside the spheres.
    pub shapes: Vec<Shape>,
    /// For each shape, the index of its material.
    pub shape_material_ids: Vec<u32>,
    /// The velocities of the shapes; empty if none moves.
    pub shape_velocities: Vec<Vec3>,
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

    /// Adds a shape beside the spheres with the material of this index.
    ///
    /// A capsule whose ends are the same is a sphere, and becomes one; so does an ellipsoid with
    /// three equal half-axes.
    ///
    /// ```
    /// use spherule::kernel::{Material, glam::Vec3, shape::Capsule};
    /// use spherule::scene::World;
    ///
    /// let mut world = World::default();
    /// let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
    /// world.add_shape(Capsule::new(Vec3::NEG_X, Vec3::X, 0.25), grey);
    /// world.add_shape(Capsule::new(Vec3::Y, Vec3::Y, 0.25), grey);
    /// assert_eq!((world.shapes.len(), world.spheres.len()), (1, 1));
    /// ```
    pub fn add_shape(&mut self, shape: impl Into<Shape>, material: u32) {
        self.add_moving_shape(shape, material, Vec3::ZERO);
    }

    /// Adds a moving shape; `velocity` is in scene units per unit of time. At time 0 it is where it
    /// is given.
    pub fn add_moving_shape(&mut self, shape: impl Into<Shape>, material: u32, velocity: Vec3) {
        let shape = shape.into();
        if let Some(sphere) = shape.as_sphere() {
            if velocity == Vec3::ZERO {
                self.add(sphere, material);
            } else {
                self.add_moving(sphere, material, velocity);
            }
            return;
        }
        if velocity != Vec3::ZERO {
            self.shape_velocities.resize(self.shapes.len(), Vec3::ZERO);
        }
        if velocity != Vec3::ZERO || !self.shape_velocities.is_empty() {
            self.shape_velocities.push(velocity);
        }
        self.shapes.push(shape);
        self.shape_material_ids.push(material);
    }

    /// The spheres, and balls around which a view of the shapes is framed.
    pub(crate) fn framed(&self) -> Cow<'_, [Sphere]> {
        if self.shapes.is_empty() {
            return Cow::Borrowed(&self.spheres);
        }
        let shapes = self.shapes.iter().flat_map(Shape::hull);
        Cow::Owned(self.spheres.iter().copied().chain(shapes).collect())
    }

    /// How many spheres and other shapes there are, for messages.
    pub(crate) fn contents(&self) -> String {
        contents_of(self.spheres.len(), self.shapes.len())
    }

    /// The kinds of shapes that there are beside the spheres.
    #[must_use]
    pub fn kinds(&self) -> Kinds {
        let shapes = self.shapes.iter();
        shapes.fold(Kinds::NONE, |kinds, shape| kinds.and(shape.kinds()))
    }

    /// Adds the spheres, shapes and materials of another world.
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
        let moves = !(self.shape_velocities.is_empty() && other.shape_velocities.is_empty());
        if moves {
            self.shape_velocities.resize(self.shapes.len(), Vec3::ZERO);
            self.shape_velocities
                .extend_from_slice(&other.shape_velocities);
        }
        self.shapes.extend_from_slice(&other.shapes);
        let ids = other.shape_material_ids.iter();
        self.shape_material_ids
            .extend(ids.map(|id| id.saturating_add(offset)));
        if moves {
            self.shape_velocities.resize(self.shapes.len(), Vec3::ZERO);
        }
    }

    /// The same spheres and shapes, each with its own index in place of its material's.
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
        let shapes_end = count + self.shapes.len();
        Ok(Self {
            spheres,
            material_ids,
            shapes: self.shapes.clone(),
            shape_material_ids: (count as u32..shapes_end as u32).collect(),
            ..Self::default()
        })
    }
}
