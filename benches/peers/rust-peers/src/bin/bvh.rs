//! The crate bvh: a binary SAH tree. Nearest hits come from its iterator in order of distance,
//! any hits from its unordered one with a query that knows the ray's interval.

use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use nalgebra::{Point3, Vector3};
use rust_peers::{Hit, Peer, Ray, Sphere};

struct Shape {
    sphere: Sphere,
    id: u32,
    node: u32,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        Aabb::with_bounds(self.sphere.min().into(), self.sphere.max().into())
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = u32::try_from(index).expect("fewer than 2^32 nodes");
    }

    fn bh_node_index(&self) -> usize {
        self.node as usize
    }
}

/// The crate's own rays have no end. This one has, in units of the crate's t.
struct Segment {
    ray: bvh::ray::Ray<f32, 3>,
    t_min: f32,
    t_max: f32,
}

impl IntersectsAabb<f32, 3> for Segment {
    fn intersects_aabb(&self, aabb: &Aabb<f32, 3>) -> bool {
        self.ray
            .intersection_slice_for_aabb(aabb)
            .is_some_and(|(enter, leave)| leave >= self.t_min && enter <= self.t_max)
    }
}

struct Peered {
    tree: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

/// The crate's ray, whose direction has unit length, with the length of the original direction.
fn ray_of(ray: &Ray) -> (bvh::ray::Ray<f32, 3>, f32) {
    let direction = Vector3::from(ray.direction);
    (bvh::ray::Ray::new(Point3::from(ray.origin), direction), direction.norm())
}

impl Peer for Peered {
    const NAME: &str = "bvh";
    const VERSION: &str = "0.13.0";

    fn build(spheres: &[Sphere], _: Option<&str>) -> Result<Self, String> {
        let mut shapes: Vec<Shape> =
            (0..).zip(spheres).map(|(id, &sphere)| Shape { sphere, id, node: 0 }).collect();
        let tree = Bvh::build_par(&mut shapes);
        Ok(Self { tree, shapes })
    }

    fn bytes(&self) -> usize {
        self.tree.nodes.len() * size_of::<BvhNode<f32, 3>>() + size_of_val(&*self.shapes)
    }

    fn nearest(&self, ray: &Ray) -> Hit {
        let (unit, length) = ray_of(ray);
        let mut best = Hit { t: ray.t_max, id: Hit::MISS.id };
        for shape in self.tree.nearest_traverse_iterator(&unit, &self.shapes) {
            // Boxes come in order of entry: none after this one can hold a nearer hit.
            if unit.intersection_slice_for_aabb(&shape.aabb()).is_none_or(|(enter, _)| enter > best.t * length) {
                break;
            }
            let t = shape.sphere.meet(ray, best.t);
            if t < best.t {
                best = Hit { t, id: shape.id };
            }
        }
        if best.id == Hit::MISS.id { Hit::MISS } else { best }
    }

    fn any(&self, ray: &Ray) -> bool {
        let (unit, length) = ray_of(ray);
        let segment = Segment { ray: unit, t_min: ray.t_min * length, t_max: ray.t_max * length };
        self.tree
            .traverse_iterator(&segment, &self.shapes)
            .any(|shape| shape.sphere.meet(ray, ray.t_max) < ray.t_max)
    }
}

fn main() {
    rust_peers::main::<Peered>();
}
