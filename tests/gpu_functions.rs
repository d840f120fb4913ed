//! Compares each device function on every adapter of this machine with the CPU.

mod common;

use common::{gpus, skips};
use glam::{UVec2, Vec3, Vec4};
use spherule::device::{Access, Gpu};
use spherule::kernel::shading::{Seen, shade};
use spherule::kernel::{
    Camera, Hit, Launch, Material, Ray, Shading, Sphere, Surface, nearest_hit, probe::layout,
};
use spherule::kernel_module;
use spherule::random::Random;

const COUNT: usize = 10_000;

/// How far apart two correct answers may be, for a hit at `t`.
///
/// Vulkan lets quotients and square roots be off by a few units in the last place, and products be
/// fused with sums. 16 roundings more than cover each quantity below:
///
/// - The discriminant D = b² − ac of the halved quadratic is a difference, so it is off by 16 u S
///   with S = b² + a·|O − C|².
/// - Its root is off by 16 u S / 2√D.
/// - t is off by that over a, plus the roundings of its own terms.
fn allowed_difference(ray: &Ray, sphere: &Sphere) -> f32 {
    let oc = (ray.origin - sphere.center()).as_dvec3();
    let d = ray.direction.as_dvec3();
    let (a, b) = (d.dot(d), oc.dot(d));
    let c = oc.dot(oc) - f64::from(sphere.radius()).powi(2);
    let root = (b * b - a * c).max(0.0).sqrt();
    let rounding = 16.0 * f64::from(f32::EPSILON) / 2.0;
    let of_root = rounding * (b * b + a * oc.dot(oc)) / (2.0 * root);
    ((of_root + rounding * (b.abs() + root)) / a) as f32
}

fn random_rays(seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    (0..COUNT)
        .map(|_| Ray::new(random.vec3(-4.0, 4.0), random.vec3(-1.0, 1.0)))
        .collect()
}

fn random_spheres(seed: u64, count: usize) -> Vec<Sphere> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| Sphere::new(random.vec3(-3.0, 3.0), random.within(0.1, 2.0)))
        .collect()
}

/// Whether the discriminant is so close to zero, relative to its terms, that rounding may decide
/// it.
fn is_grazing(ray: &Ray, sphere: &Sphere) -> bool {
    let oc = (ray.origin - sphere.center()).as_dvec3();
    let d = ray.direction.as_dvec3();
    let radius = f64::from(sphere.radius());
    let (a, b) = (d.dot(d), oc.dot(d));
    let c = oc.dot(oc) - radius * radius;
    let discriminant = b * b - a * c;
    // 16 roundings of the largest term.
    discriminant.abs() <= 16.0 * f64::from(f32::EPSILON) * (b * b).max(a * oc.dot(oc))
}

/// Whether the ray starts so close to the surface that rounding decides on which side it starts.
fn starts_on_surface(ray: &Ray, sphere: &Sphere) -> bool {
    let distance = (ray.origin - sphere.center()).as_dvec3().length();
    (distance - f64::from(sphere.radius())).abs() < 1e-4
}

fn run<T: bytemuck::Pod>(
    gpu: &Gpu,
    entry: &str,
    inputs: &[spherule::device::Binding<'_>],
    output: &spherule::device::Buffer<T>,
    threads: usize,
) -> Vec<T> {
    let module = kernel_module::f32().expect("the kernel");
    let mut access = vec![Access::Read; inputs.len()];
    access.push(Access::ReadWrite);
    let kernel = gpu.kernel(&module, entry, &access).expect(entry);
    let mut bindings = inputs.to_vec();
    bindings.push(output.binding());
    gpu.launch(
        &kernel,
        &bindings,
        kernel.workgroups_for([threads as u32, 1, 1]),
    )
    .expect(entry);
    gpu.read(output).expect(entry)
}

#[test]
fn sphere_intersect_agrees() {
    if skips("sphere_intersect_agrees") {
        return;
    }
    // Every second ray is aimed at its sphere.
    let spheres = random_spheres(2, COUNT);
    let mut rays = random_rays(1);
    for (ray, sphere) in rays.iter_mut().zip(&spheres).step_by(2) {
        ray.direction = (sphere.center() - ray.origin) + ray.direction * sphere.radius();
    }
    for gpu in gpus() {
        let output = gpu.zeroed::<f32>("parameters", COUNT).expect("a buffer");
        let on_gpu = run(
            gpu,
            "intersect_pairs",
            &[
                gpu.upload("rays", &rays).expect("rays").binding(),
                gpu.upload("spheres", &spheres).expect("spheres").binding(),
            ],
            &output,
            COUNT,
        );
        let mut hits = 0;
        for ((ray, sphere), t) in rays.iter().zip(&spheres).zip(on_gpu) {
            let expected = sphere.intersect(ray);
            if is_grazing(ray, sphere) || starts_on_surface(ray, sphere) {
                continue;
            }
            hits += usize::from(expected < Hit::NONE_T);
            let same_class = (expected < Hit::NONE_T) == (t < Hit::NONE_T);
            assert!(
                t == expected
                    || same_class && (t - expected).abs() <= allowed_difference(ray, sphere),
                "{}: {ray:?} {sphere:?} {t} {expected}",
                gpu.name()
            );
        }
        assert!(hits > COUNT / 10, "only {hits} hits");
    }
}

#[test]
fn nearest_hit_agrees() {
    if skips("nearest_hit_agrees") {
        return;
    }
    let rays = random_rays(3);
    for count in [0, 1, 7, 300] {
        let spheres = random_spheres(4, count);
        for gpu in gpus() {
            let output = gpu
                .upload("hits", &vec![Hit { t: -1.0, sphere: 7 }; COUNT])
                .expect("hits");
            let on_gpu = run(
                gpu,
                "trace_rays",
                &[
                    gpu.upload("rays", &rays).expect("rays").binding(),
                    gpu.upload("spheres", &spheres).expect("spheres").binding(),
                ],
                &output,
                COUNT,
            );
            let mut differing = 0;
            for (ray, hit) in rays.iter().zip(on_gpu) {
                assert_ne!(hit.t, -1.0, "a thread wrote nothing");
                differing += usize::from(hit.sphere != nearest_hit(ray, &spheres).sphere);
            }
            // The result may differ only for a ray that grazes a sphere or starts on one.
            let excusable = rays
                .iter()
                .filter(|ray| {
                    spheres
                        .iter()
                        .any(|sphere| is_grazing(ray, sphere) || starts_on_surface(ray, sphere))
                })
                .count();
            assert!(
                differing <= excusable,
                "{}: {differing} of {excusable}",
                gpu.name()
            );
        }
    }
}

#[test]
fn surfaces_agree() {
    if skips("surfaces_agree") {
        return;
    }
    let (rays, spheres, parameters) = hits();
    for gpu in gpus() {
        let output = gpu
            .zeroed::<Vec4>("surfaces", 2 * rays.len())
            .expect("surfaces");
        let on_gpu = run(
            gpu,
            "find_surfaces",
            &[
                gpu.upload("rays", &rays).expect("rays").binding(),
                gpu.upload("spheres", &spheres).expect("spheres").binding(),
                gpu.upload("parameters", &parameters)
                    .expect("parameters")
                    .binding(),
            ],
            &output,
            rays.len(),
        );
        for (index, found) in on_gpu.chunks_exact(2).enumerate() {
            let expected = Surface::at(&rays[index], parameters[index], spheres[index]);
            let [point, normal] = [found[0].truncate(), found[1].truncate()];
            assert!(
                point.distance(expected.point) <= 1e-5,
                "{point} {expected:?}"
            );
            assert!(
                normal.distance(expected.normal) <= 1e-4,
                "{normal} {expected:?}"
            );
            assert!((normal.length() - 1.0).abs() <= 1e-6);
        }
    }
}

#[test]
fn shading_agrees_in_every_mode() {
    if skips("shading_agrees_in_every_mode") {
        return;
    }
    let (rays, spheres, parameters) = hits();
    let mut random = Random::new(9);
    let materials: Vec<Material> = rays
        .iter()
        .map(|_| Material::diffuse(random.vec3(0.0, 1.0)))
        .collect();
    for gpu in gpus() {
        let output = gpu
            .zeroed::<Vec4>("colors", Shading::ALL.len() * rays.len())
            .expect("colors");
        let on_gpu = run(
            gpu,
            "shade_hits",
            &[
                gpu.upload("rays", &rays).expect("rays").binding(),
                gpu.upload("spheres", &spheres).expect("spheres").binding(),
                gpu.upload("parameters", &parameters)
                    .expect("parameters")
                    .binding(),
                gpu.upload("materials", &materials)
                    .expect("materials")
                    .binding(),
            ],
            &output,
            rays.len(),
        );
        for (index, colors) in on_gpu.chunks_exact(Shading::ALL.len()).enumerate() {
            let surface = Surface::at(&rays[index], parameters[index], spheres[index]);
            for (mode, color) in colors.iter().enumerate() {
                let seen = Seen {
                    ray: rays[index],
                    hit: Hit {
                        t: parameters[index],
                        sphere: index as u32,
                    },
                    surface,
                    material: materials[index],
                    tag: index as u32,
                };
                let expected = shade(mode as u32, seen);
                assert!(
                    color.truncate().distance(expected) <= 1e-4 * expected.length().max(1.0),
                    "mode {mode}: {color} {expected}"
                );
            }
        }
    }
}

#[test]
fn camera_rays_agree() {
    if skips("camera_rays_agree") {
        return;
    }
    let size = UVec2::new(67, 31);
    let launch = Launch {
        camera: Camera::look_at(
            Vec3::new(1.0, 2.0, 3.0),
            Vec3::new(-0.5, 0.25, -4.0),
            Vec3::new(0.1, 1.0, 0.0),
            0.7,
            67.0 / 31.0,
        )
        .expect("a camera"),
        image_size: size,
        ..Launch::default()
    };
    let count = (size.x * size.y) as usize;
    let module = kernel_module::f32().expect("the kernel");
    for gpu in gpus() {
        let kernel = gpu
            .kernel(
                &module,
                "make_camera_rays",
                &[Access::Uniform, Access::ReadWrite],
            )
            .expect("a kernel");
        let uniform = gpu.upload_uniform("launch", &launch).expect("a uniform");
        let output = gpu.zeroed::<Ray>("rays", count).expect("rays");
        gpu.launch(
            &kernel,
            &[uniform.binding(), output.binding()],
            kernel.workgroups_for([count as u32, 1, 1]),
        )
        .expect("a launch");
        for (index, ray) in gpu.read(&output).expect("rays").iter().enumerate() {
            let pixel = UVec2::new(index as u32 % size.x, index as u32 / size.x);
            let expected = launch.camera.pixel_ray(pixel, size);
            assert_eq!(ray.origin, expected.origin);
            assert_eq!((ray.t_min, ray.t_max), (expected.t_min, expected.t_max));
            assert!(
                ray.direction.distance(expected.direction) <= 1e-6,
                "{ray:?} {expected:?}"
            );
        }
    }
}

/// Every shared type has the same layout for the GPU's compiler as for the host's.
#[test]
fn layout_agrees() {
    if skips("layout_agrees") {
        return;
    }
    let mut expected = vec![0; layout::COUNT];
    layout::write(&mut expected);
    for gpu in gpus() {
        let output = gpu.zeroed::<u32>("layout", layout::COUNT).expect("a table");
        let on_gpu = run(gpu, "measure_layout", &[], &output, 1);
        for ((name, on_gpu), on_host) in layout::NAMES.iter().zip(on_gpu).zip(&expected) {
            assert_eq!(on_gpu, *on_host, "{name}");
        }
    }
}

/// Rays, a sphere for each that it hits well inside the silhouette, and the parameters of the hits.
fn hits() -> (Vec<Ray>, Vec<Sphere>, Vec<f32>) {
    let mut random = Random::new(5);
    let mut found = (Vec::new(), Vec::new(), Vec::new());
    while found.0.len() < COUNT {
        let sphere = Sphere::new(random.vec3(-3.0, 3.0), random.within(0.5, 2.0));
        let origin = random.vec3(-4.0, 4.0);
        let inside = sphere.center() + random.vec3(-0.5, 0.5) * sphere.radius();
        let ray = Ray::new(origin, (inside - origin) * random.within(0.1, 2.0));
        let t = sphere.intersect(&ray);
        if t < Hit::NONE_T {
            found.0.push(ray);
            found.1.push(sphere);
            found.2.push(t);
        }
    }
    found
}
