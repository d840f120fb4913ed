//! The crate parry3d: its binary tree, built by binned SAH, or with `--variant ploc` by PLOC. The
//! crate recommends PLOC for casting rays, but for spheres like these SAH traces faster.

use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use rust_peers::{Hit, Peer, Ray, Sphere};

struct Parry {
    tree: Bvh,
    spheres: Vec<Sphere>,
}

fn ray_of(ray: &Ray) -> parry3d::query::Ray {
    parry3d::query::Ray::new(ray.origin.into(), ray.direction.into())
}

impl Peer for Parry {
    const NAME: &str = "parry3d";
    const VERSION: &str = "0.31.1";

    fn build(spheres: &[Sphere], variant: Option<&str>) -> Result<Self, String> {
        let strategy = match variant {
            None | Some("binned") => BvhBuildStrategy::Binned,
            Some("ploc") => BvhBuildStrategy::Ploc,
            Some(other) => return Err(format!("no variant {other}")),
        };
        let boxes = spheres.iter().map(|sphere| Aabb::new(sphere.min().into(), sphere.max().into()));
        Ok(Self { tree: Bvh::from_iter(strategy, boxes.enumerate()), spheres: spheres.to_vec() })
    }

    fn bytes(&self) -> usize {
        self.tree.total_memory_size() + size_of_val(&*self.spheres)
    }

    fn nearest(&self, ray: &Ray) -> Hit {
        let meet = |id: u32, t_max: f32| {
            let t = self.spheres[id as usize].meet(ray, t_max);
            (t < t_max).then_some(t)
        };
        self.tree.cast_ray(&ray_of(ray), ray.t_max, meet).map_or(Hit::MISS, |(id, t)| Hit { t, id })
    }

    fn any(&self, ray: &Ray) -> bool {
        // The first hit is reported as nearer than everything else, which ends the traversal.
        let meet = |id: u32, _: f32| {
            (self.spheres[id as usize].meet(ray, ray.t_max) < ray.t_max).then_some(f32::NEG_INFINITY)
        };
        self.tree.cast_ray(&ray_of(ray), ray.t_max, meet).is_some()
    }
}

fn main() {
    rust_peers::main::<Parry>();
}
