//! The crate obvhs: a PLOC build with reinsertion, traversed as an eight-wide compressed tree
//! (`--variant cwbvh`) or as a binary one (`--variant bvh2`). A preset of the crate may follow, as
//! in `cwbvh-medium`; the default is the slowest build, which traces fastest.

use std::time::Duration;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;
use obvhs::{Boundable, BvhBuildParams};
use rust_peers::{Hit, Peer, Ray, Sphere};

struct Bounded(Sphere);

impl Boundable for Bounded {
    fn aabb(&self) -> Aabb {
        Aabb::new(self.0.min().into(), self.0.max().into())
    }
}

enum Tree {
    Wide(CwBvh),
    Binary(Bvh2),
}

struct Obvhs {
    tree: Tree,
    // In the order of the leaves, which saves a look-up at each leaf.
    spheres: Vec<Sphere>,
}

impl Obvhs {
    fn indices(&self) -> &[u32] {
        match &self.tree {
            Tree::Wide(tree) => &tree.primitive_indices,
            Tree::Binary(tree) => &tree.primitive_indices,
        }
    }
}

fn ray_of(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(Vec3A::from(ray.origin), Vec3A::from(ray.direction), ray.t_min, ray.t_max)
}

impl Peer for Obvhs {
    const NAME: &str = "obvhs";
    const VERSION: &str = "0.4.0";

    fn build(spheres: &[Sphere], variant: Option<&str>) -> Result<Self, String> {
        let variant = variant.unwrap_or("cwbvh");
        let (layout, preset) = variant.split_once('-').unwrap_or((variant, "slowest"));
        let params = match preset {
            "fast" => BvhBuildParams::fast_build(),
            "medium" => BvhBuildParams::medium_build(),
            "slow" => BvhBuildParams::slow_build(),
            "slowest" => BvhBuildParams::very_slow_build(),
            _ => return Err(format!("no preset {preset}")),
        };
        let bounded: Vec<Bounded> = spheres.iter().copied().map(Bounded).collect();
        let mut time = Duration::ZERO;
        let tree = match layout {
            "bvh2" => Tree::Binary(build_bvh2(&bounded, params, &mut time)),
            "cwbvh" => Tree::Wide(build_cwbvh(&bounded, params, &mut time)),
            _ => return Err(format!("no layout {layout}")),
        };
        let mut peer = Self { tree, spheres: Vec::new() };
        peer.spheres = peer.indices().iter().map(|&id| spheres[id as usize]).collect();
        Ok(peer)
    }

    fn bytes(&self) -> usize {
        let nodes = match &self.tree {
            Tree::Wide(tree) => size_of_val(&*tree.nodes),
            Tree::Binary(tree) => size_of_val(&*tree.nodes),
        };
        nodes + size_of_val(self.indices()) + size_of_val(&*self.spheres)
    }

    fn nearest(&self, ray: &Ray) -> Hit {
        let mut hit = RayHit::none();
        let meet = |r: &obvhs::ray::Ray, leaf: usize| self.spheres[leaf].meet(ray, r.tmax);
        let found = match &self.tree {
            Tree::Wide(tree) => tree.ray_traverse(ray_of(ray), &mut hit, meet),
            Tree::Binary(tree) => tree.ray_traverse(ray_of(ray), &mut hit, meet),
        };
        if found { Hit { t: hit.t, id: self.indices()[hit.primitive_id as usize] } } else { Hit::MISS }
    }

    fn any(&self, ray: &Ray) -> bool {
        let meet = |r: &obvhs::ray::Ray, leaf: usize| self.spheres[leaf].meet(ray, r.tmax);
        match &self.tree {
            Tree::Wide(tree) => !tree.ray_traverse_miss(ray_of(ray), meet),
            Tree::Binary(tree) => !tree.ray_traverse_miss(ray_of(ray), meet),
        }
    }
}

fn main() {
    rust_peers::main::<Obvhs>();
}
