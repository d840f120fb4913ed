//! Compares the kernel on every adapter with the same function on the CPU, and that with a sphere
//! whose volume is known.

use own_kernel::{grid_around, rooms_on_cpu, rooms_on_gpu};
use spherule::device::GpuOptions;
use spherule::device::adapter::{adapters, instance};
use spherule::kernel::{Hit, Sphere, glam::Vec3};
use spherule::{Gpu, Scene};

#[test]
fn every_adapter_agrees_with_the_cpu() {
    let spheres = Scene::load(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenes/1crn.pdb"
    ))
    .expect("crambin")
    .world
    .spheres;
    let grid = grid_around(&spheres, 24);
    let on_cpu = rooms_on_cpu(&grid, &spheres);
    let adapters = adapters(&instance());
    if adapters.is_empty() {
        assert!(std::env::var_os("SPHERULE_REQUIRE_GPU").is_none_or(|value| value == "0"));
        eprintln!("SKIPPED every_adapter_agrees_with_the_cpu: there is no GPU adapter");
    }
    for adapter in &adapters {
        let gpu = Gpu::from_adapter(adapter, GpuOptions::default()).expect("a device");
        let on_gpu = rooms_on_gpu(&gpu, &grid, &spheres).expect("rooms");
        let same = on_gpu
            .iter()
            .zip(&on_cpu)
            .filter(|(gpu, cpu)| {
                gpu.inside == cpu.inside
                    && (gpu.clearance - cpu.clearance).abs() <= 1e-3 * cpu.clearance.max(1.0)
            })
            .count();
        // Rounding may decide differently for a point on a surface or a ray that grazes one.
        assert!(
            same * 1000 >= on_cpu.len() * 999,
            "{same} of {}",
            on_cpu.len()
        );
    }
}

#[test]
fn a_ball_has_its_volume_and_its_clearance() {
    let ball = [Sphere::new(Vec3::new(1.0, 2.0, 3.0), 2.0)];
    let grid = grid_around(&ball, 81);
    let rooms = rooms_on_cpu(&grid, &ball);
    let volume = rooms.iter().filter(|room| room.inside == 1).count() as f32 * grid.spacing.powi(3);
    let expected = 4.0 / 3.0 * std::f32::consts::PI * 8.0;
    assert!(
        (volume / expected - 1.0).abs() < 0.01,
        "{volume} {expected}"
    );
    // From the middle, the next surface is a radius away; from a corner there is none.
    let middle = rooms[(40 * 81 + 40) * 81 + 40];
    assert!((middle.clearance - 2.0).abs() < 1e-5);
    assert_eq!(rooms[0].clearance, Hit::NONE_T);
}
