//! A little of everything that runs on a CPU without vector instructions, with numbers so small
//! that Miri takes only minutes: `.ci/miri` runs it there. Elsewhere it takes no time.

use glam::{DVec3, Vec3};
use spherule::accel::{Acceleration, build, build_still};
use spherule::device::Device;
use spherule::kernel::accel::brute::nearest_hit_in;
use spherule::kernel::accel::node::Tree;
use spherule::kernel::accel::walk::{is_occluded_in_tree, nearest_hit_in_tree, work_in_tree};
use spherule::kernel::{Effects, Hit, Material, Ray, Rung, Shading, Sphere};
use spherule::look;
use spherule::random::Random;
use spherule::read::particles::{pdb, xyz};
use spherule::read::toml;
use spherule::render::{QUIET, render};
use spherule::scene::surroundings::{PointLight, Sun, Surroundings};
use spherule::scene::{Scene, World};
use spherule::trace::CpuTracer;

fn world(random: &mut Random, count: usize) -> Vec<Sphere> {
    (0..count)
        .map(|_| Sphere::new(random.vec3(-1.0, 1.0), random.log_within(0.01, 0.4)))
        .collect()
}

/// Ordinary rays, and one in four of any bits.
fn rays(random: &mut Random, count: usize) -> Vec<Ray> {
    (0..count)
        .map(|index| {
            let any = |random: &mut Random| f32::from_bits(random.next_u32());
            let (origin, direction) = (random.vec3(-2.0, 2.0), random.vec3(-1.0, 1.0));
            match index % 4 {
                0 => Ray::within(
                    Vec3::new(any(random), 0.5, any(random)),
                    Vec3::new(any(random), any(random), 1.0),
                    any(random),
                    any(random),
                ),
                1 => Ray::within(origin, direction, -2.0, 2.0),
                _ => Ray::new(origin, direction),
            }
        })
        .collect()
}

#[test]
fn trees_are_built_and_walked() {
    let mut random = Random::new(3);
    let counts = if cfg!(miri) {
        [0, 1, 7, 40]
    } else {
        [0, 1, 40, 900]
    };
    for count in counts {
        let mut spheres = world(&mut random, count);
        spheres.extend([Sphere::new(Vec3::ONE, 0.5); 12]);
        let tree = build_still(&spheres, 1).expect("a tree");
        assert!(Tree::of(&tree.nodes).is_some());
        let sorted = tree.sort(&spheres);
        let rays = rays(&mut random, if cfg!(miri) { 8 } else { 64 });
        let tracer = CpuTracer::new(&spheres, Acceleration::Tree);
        for rung in Rung::ALL {
            let (mut hits, mut occluded) = (Vec::new(), Vec::new());
            tracer.nearest(rung, &rays, &mut hits);
            tracer.occluded(rung, &rays, &mut occluded);
            let code = rung.to_u32();
            for (index, ray) in rays.iter().enumerate() {
                let hit = nearest_hit_in_tree(code, ray, tree.nodes.tree(), &sorted[..]);
                let any = is_occluded_in_tree(code, ray, tree.nodes.tree(), &sorted[..]);
                let _ = work_in_tree(code, false, ray, tree.nodes.tree(), &sorted[..]);
                // The tree was not built over these spheres: one, and none.
                let _ = nearest_hit_in_tree(code, ray, tree.nodes.tree(), &sorted[..1]);
                let none = nearest_hit_in_tree(code, ray, tree.nodes.tree(), &sorted[..0]);
                assert_eq!(none, Hit::NONE);
                if index % 4 != 0 {
                    let all = nearest_hit_in(code, ray, &sorted[..], 0, u32::MAX);
                    assert_eq!(hit, all);
                    assert_eq!(any, all.is_some());
                    assert_eq!(hits[index].t, all.t);
                    assert_eq!(occluded[index] == 1, all.is_some());
                }
            }
        }
    }
}

#[test]
fn trees_over_moving_spheres_are_built() {
    let mut random = Random::new(4);
    let spheres = world(&mut random, 60);
    let velocities: Vec<Vec3> = (0..40).map(|_| random.vec3(-1.0, 1.0)).collect();
    assert!(build(&spheres, &velocities, (0.0, 1.0), 1).is_some());
    assert!(build(&spheres, &velocities, (0.0, f32::NAN), 1).is_none());
}

#[test]
fn images_of_every_kind_are_rendered() {
    let mut random = Random::new(5);
    let mut world = World::default();
    let materials = [
        Material::diffuse(Vec3::splat(0.5)),
        Material::metal(Vec3::splat(0.9), 0.0),
        Material::metal(Vec3::splat(0.9), 0.3),
        Material::glass(1.5, Vec3::splat(0.1)),
        Material::emissive(Vec3::ONE),
    ]
    .map(|material| world.add_material(material));
    for index in 0..20 {
        let sphere = Sphere::new(random.vec3(-1.0, 1.0), random.log_within(0.05, 0.3));
        world.add_moving(sphere, materials[index % 5], random.vec3(-0.1, 0.1));
    }
    let mut plain = Scene::new(world);
    (plain.width, plain.height) = (9, 5);
    for shading in [Shading::Normals, Shading::Depth, Shading::Flat] {
        render(&plain, shading, &Device::Cpu, QUIET).expect("an image");
    }
    let mut lit = plain;
    (lit.width, lit.height) = (3, 2);
    lit.sampling.samples = Some(1);
    lit.lens.shutter = (0.0, 1.0);
    lit.lens.aperture = 0.1;
    lit.sky = Some(Surroundings {
        horizon: Vec3::ONE,
        zenith: Vec3::ZERO,
        sun: Some(Sun {
            direction: Vec3::Y,
            size: 2.0,
            irradiance: Vec3::ONE,
        }),
        rotation: 0.0,
        image: None,
    });
    lit.lights.push(PointLight {
        position: Vec3::splat(3.0),
        intensity: Vec3::ONE,
    });
    assert!(lit.effects().any(Effects::GLASS));
    // The table for rough metal alone takes Miri longer than everything else.
    if !cfg!(miri) {
        render(&lit, Shading::Lit, &Device::Cpu, QUIET).expect("an image");
    }
    lit.world.materials[2] = Material::metal(Vec3::ONE, 0.0);
    render(&lit, Shading::Lit, &Device::Cpu, QUIET).expect("an image");
}

#[test]
fn files_are_read() {
    let pdb_text =
        "ATOM      1  N   THR A   1      17.047  14.099   3.625  1.00 13.79           N\nEND\n";
    assert_eq!(pdb::parse(pdb_text).expect("an atom").len(), 1);
    for at in 0..pdb_text.len() {
        let _ = pdb::parse(&pdb_text[..at]);
    }
    let xyz_text = "4\nfour\nC 0 0 0\nX 1 1 1\nH 1.5 0 0\nXx 0 0 0\n";
    let atoms = xyz::parse(xyz_text).expect("atoms");
    assert_eq!(atoms.len(), 2);
    for at in 0..xyz_text.len() {
        let _ = xyz::parse(&xyz_text[..at]);
    }
    assert_eq!(look::world(&atoms, DVec3::ZERO).spheres.len(), 2);
    let scene_text = "[image]\nwidth = 4\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    for at in (0..=scene_text.len()).step_by(if cfg!(miri) { 7 } else { 1 }) {
        let _ = toml::parse("scene.toml".as_ref(), scene_text[..at].to_owned());
    }
}
