//! Glass that lies in other glass or overlaps it, and glass around a point.

use std::collections::HashMap;

use glam::Vec3;
use rayon::prelude::*;
use spherule_kernel::{Material, Sphere};

use super::World;

/// A glass sphere of a world.
struct Glass {
    index: usize,
    sphere: Sphere,
    material: Material,
    velocity: Vec3,
}

impl Glass {
    /// The least distance of the centres, at any time if one moves towards the other.
    fn least_distance(&self, other: &Self) -> f64 {
        let apart = self.sphere.center().as_dvec3() - other.sphere.center().as_dvec3();
        let velocity = (self.velocity - other.velocity).as_dvec3();
        if velocity.length_squared() > 0.0 {
            apart.reject_from(velocity).length()
        } else {
            apart.length()
        }
    }

    /// Whether a point may be in both. Spheres that touch have none, but for rounding.
    fn overlaps(&self, other: &Self) -> bool {
        let radii = self.radius() + other.radius();
        self.least_distance(other) < radii * (1.0 - 1e-6)
    }

    /// Whether `other` is a hollow in this sphere, with glass of the same kind around it, as
    /// [`Material::bubble`] makes it.
    fn has_hollow(&self, other: &Self) -> bool {
        let (solid, hollow) = (&self.material, &other.material);
        (solid.kind, hollow.kind) == (Material::GLASS, Material::BUBBLE)
            && 1.0 / solid.parameter == hollow.parameter
            && solid.volume == hollow.volume
            && self.velocity == other.velocity
            && self.least_distance(other) + other.radius() < self.radius()
    }

    /// Whether `other` is a hollow about the centre of this sphere.
    fn has_hollow_within(&self, other: &Self, is_absolute: bool) -> bool {
        // Where indices are those of the glass itself, that of a hollow is one.
        let (solid, hollow) = (&self.material, &other.material);
        let relative = if is_absolute { 1.0 } else { solid.parameter };
        (solid.kind, hollow.kind) == (Material::GLASS, Material::BUBBLE)
            && (relative * hollow.parameter - 1.0).abs() < 1e-6
            && solid.volume == hollow.volume
            && self.velocity == other.velocity
            && self.least_distance(other) <= 1e-6 * other.radius()
            && other.radius() < self.radius()
    }

    fn radius(&self) -> f64 {
        f64::from(self.sphere.radius().abs())
    }

    /// The least and the largest x of the sphere.
    fn ends(&self) -> (f64, f64) {
        let x = f64::from(self.sphere.center().x);
        (x - self.radius(), x + self.radius())
    }
}

impl World {
    /// The glass spheres.
    fn glass(&self) -> Vec<Glass> {
        let is_glass: Vec<bool> = self.materials.iter().map(Material::is_glass).collect();
        let glass = |index: usize| Glass {
            index,
            sphere: self.spheres[index],
            material: self.materials[self.material_ids[index] as usize],
            velocity: self.velocities.get(index).copied().unwrap_or_default(),
        };
        let is_glass = |id: &u32| is_glass.get(*id as usize) == Some(&true);
        let ids = self.material_ids.iter().enumerate();
        let count = self.spheres.len();
        ids.filter(|(index, id)| *index < count && is_glass(id))
            .map(|(index, _)| glass(index))
            .collect()
    }

    /// The glass spheres that hold a point at time 0, by index, the smallest first; of equally
    /// large ones the one of the lower index.
    #[must_use]
    pub fn glass_around(&self, point: Vec3) -> Vec<u32> {
        let mut around = self.glass();
        around.retain(|glass| glass.sphere.contains(point));
        around.sort_by(|a, b| {
            let order = a.radius().total_cmp(&b.radius());
            order.then(a.index.cmp(&b.index))
        });
        around.iter().map(|glass| glass.index as u32).collect()
    }

    /// The world with materials in which the refractive index of glass is that of the glass itself,
    /// not relative to what surrounds it. That is the smallest glass sphere that holds all of it.
    pub(crate) fn with_absolute_glass(&self) -> Self {
        let mut glass = self.glass();
        // Those that may hold a sphere come before it.
        glass.sort_by(|a, b| {
            let order = b.radius().total_cmp(&a.radius());
            order.then(a.index.cmp(&b.index))
        });
        let holder_of = |at: usize| {
            let inner = &glass[at];
            let holds = |outer: &Glass| {
                let ends = (outer.ends(), inner.ends());
                let is_near = ends.0.0 <= ends.1.0 && ends.1.1 <= ends.0.1;
                // Up to rounding.
                is_near
                    && outer.least_distance(inner) + inner.radius() <= outer.radius() * (1.0 + 1e-6)
            };
            (0..at).rev().find(|outer| holds(&glass[*outer]))
        };
        let holders: Vec<Option<usize>> = (0..glass.len()).into_par_iter().map(holder_of).collect();
        let mut world = self.clone();
        let mut indices = Vec::with_capacity(glass.len());
        let mut made = HashMap::new();
        for (one, holder) in glass.iter().zip(holders) {
            let around: f32 = holder.map_or(1.0, |holder| indices[holder]);
            let index = one.material.parameter * around;
            indices.push(index);
            let id = self.material_ids[one.index];
            let absolute = *made.entry((id, index.to_bits())).or_insert_with(|| {
                world.add_material(Material {
                    parameter: index,
                    ..one.material
                })
            });
            world.material_ids[one.index] = absolute;
        }
        world
    }

    /// The spheres of glass that no other glass overlaps but a hollow about their centre, by index,
    /// each with the index of its hollow. `is_absolute` says whether the refractive indices are
    /// those of [`World::with_absolute_glass`].
    pub(crate) fn lone_glass(&self, is_absolute: bool) -> Vec<(u32, Option<u32>)> {
        let mut glass = self.glass();
        let moves = glass.iter().any(|one| one.velocity != Vec3::ZERO);
        glass.sort_by(|a, b| a.ends().0.total_cmp(&b.ends().0));
        let mut hollows: Vec<Option<u32>> = vec![None; glass.len()];
        let mut is_lone = vec![true; glass.len()];
        for (at, one) in glass.iter().enumerate() {
            let others = glass.iter().enumerate().skip(at + 1);
            let near = others.take_while(|(_, other)| moves || other.ends().0 <= one.ends().1);
            for (beside, other) in near.filter(|(_, other)| one.overlaps(other)) {
                let (outer, inner) = if one.radius() > other.radius() {
                    (at, beside)
                } else {
                    (beside, at)
                };
                let is_hollow = glass[outer].has_hollow_within(&glass[inner], is_absolute);
                if is_hollow && hollows[outer].is_none() {
                    hollows[outer] = Some(glass[inner].index as u32);
                } else {
                    is_lone[at] = false;
                    is_lone[beside] = false;
                }
            }
        }
        let of_glass = |at: &usize| is_lone[*at] && glass[*at].material.kind == Material::GLASS;
        (0..glass.len())
            .filter(of_glass)
            .map(|at| (glass[at].index as u32, hollows[at]))
            .collect()
    }

    /// Two glass spheres, by index, of which one is in the other or overlaps it, if there are such.
    /// A hollow in a sphere is not meant.
    #[must_use]
    pub fn overlapping_glass(&self) -> Option<(usize, usize)> {
        let mut glass = self.glass();
        let moves = glass.iter().any(|one| one.velocity != Vec3::ZERO);
        glass.sort_by(|a, b| a.ends().0.total_cmp(&b.ends().0));
        glass.iter().enumerate().find_map(|(at, one)| {
            let others = glass[at + 1..].iter();
            others
                .take_while(|other| moves || other.ends().0 <= one.ends().1)
                .find(|other| {
                    one.overlaps(other) && !one.has_hollow(other) && !other.has_hollow(one)
                })
                .map(|other| (one.index.min(other.index), one.index.max(other.index)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(spheres: &[(f32, f32, Material)]) -> World {
        let mut world = World::default();
        for (x, radius, material) in spheres {
            let id = world.add_material(*material);
            world.add(Sphere::new(Vec3::X * *x, *radius), id);
        }
        world
    }

    #[test]
    fn overlaps_are_found() {
        let glass = Material::glass(1.5, Vec3::ONE);
        let bubble = Material::bubble(1.5, Vec3::ONE);
        let clear = Material::bubble(1.5, Vec3::ZERO);
        let grey = Material::diffuse(Vec3::ONE);
        let of = |spheres: &[(f32, f32, Material)]| world(spheres).overlapping_glass();
        assert_eq!(of(&[(0.0, 1.0, glass), (2.0, 1.0, glass)]), None);
        assert_eq!(of(&[(0.0, 1.0, glass), (1.0, 1.0, grey)]), None);
        assert_eq!(of(&[(0.0, 1.0, glass), (0.1, 0.5, bubble)]), None);
        assert_eq!(of(&[(0.0, 1.0, glass), (0.1, 0.5, clear)]), Some((0, 1)));
        assert_eq!(of(&[(0.0, 1.0, glass), (0.6, 0.5, bubble)]), Some((0, 1)));
        assert_eq!(
            of(&[(9.0, 1.0, glass), (0.0, 1.0, grey), (10.5, 1.0, glass)]),
            Some((0, 2))
        );
        let mut moving = world(&[(0.0, 1.0, glass), (9.0, 1.0, glass)]);
        moving.velocities = vec![Vec3::Y, Vec3::Y];
        assert_eq!(moving.overlapping_glass(), None);
        moving.velocities = vec![Vec3::ZERO, Vec3::X];
        assert_eq!(moving.overlapping_glass(), Some((0, 1)));
    }

    #[test]
    fn lone_glass_is_found_with_its_hollow() {
        let glass = Material::glass(1.5, Vec3::ONE);
        let bubble = Material::bubble(1.5, Vec3::ONE);
        let spheres = [
            (0.0, 1.0, glass),
            (0.0, 0.5, bubble),
            (3.0, 1.0, glass),
            (6.0, 1.0, glass),
            (7.5, 1.0, glass),
            (20.0, 1.0, glass),
            (20.1, 0.5, bubble),
            (30.0, 1.0, glass),
            (30.0, 0.5, bubble),
            (30.0, 0.1, glass),
        ];
        let lone = |world: World, is_absolute| {
            let mut lone = world.lone_glass(is_absolute);
            lone.sort_unstable();
            lone
        };
        let expected = [(0, Some(1)), (2, None)];
        assert_eq!(lone(world(&spheres), false), expected);
        assert_eq!(lone(world(&spheres).with_absolute_glass(), true), expected);
    }

    /// A ball in air in a ball; and a ball beside them.
    #[test]
    fn indices_are_those_of_the_glass_itself() {
        let glass = Material::glass(1.5, Vec3::ONE);
        let spheres = [
            (0.0, 0.25, glass),
            (0.0, 1.0, glass),
            (0.1, 0.5, Material::bubble(1.5, Vec3::ONE)),
            (2.0, 1.0, glass),
        ];
        let world = world(&spheres).with_absolute_glass();
        let index = |id: &u32| world.materials[*id as usize].parameter;
        let indices: Vec<f32> = world.material_ids.iter().map(index).collect();
        assert_eq!(indices, [1.5, 1.5, 1.0, 1.5]);
    }

    #[test]
    fn the_smallest_glass_comes_first() {
        let glass = Material::glass(1.5, Vec3::ONE);
        let spheres = [
            (0.0, 3.0, glass),
            (0.0, 1.0, glass),
            (0.5, 1.0, glass),
            (9.0, 1.0, glass),
        ];
        assert_eq!(world(&spheres).glass_around(Vec3::X * 0.25), [1, 2, 0]);
    }
}
