//! The practical, step 5: every GPU error is reported. The program makes three mistakes on purpose.
//! Each returns an error that says what happened and what to do, and the device still works.
//!
//! `cargo run --release --example step5_errors` writes `step5.png`.

use glam::Vec3;
use spherule::device::{Access, Module};
use spherule::kernel::{Ray, Shading};
use spherule::render::{QUIET, render};
use spherule::{Device, DeviceChoice, Error, Gpu, Scene, kernel_module};

fn report(mistake: &str, error: &Error) {
    println!("{mistake}\n  {error}\n  {}\n", error.help());
}

fn make_mistakes(gpu: &Gpu) -> spherule::Result<()> {
    if let Err(error) = Module::from_bytes("not a kernel", b"this is not a SPIR-V file") {
        report("Bytes that are not a kernel:", &error);
    }

    let kernel = gpu.kernel(
        &kernel_module::f32()?,
        "trace_rays",
        &[Access::Read, Access::Read, Access::ReadWrite],
    )?;
    if let Err(error) = gpu.launch(&kernel, &[], [u32::MAX, 1, 1]) {
        report("More workgroups than the device allows:", &error);
    }

    let rays = gpu.upload("rays", &[Ray::new(Vec3::ZERO, Vec3::X)])?;
    // A launch returns nothing. Its errors are known only when the device has finished, so `launch`
    // waits.
    if let Err(error) = gpu.launch(&kernel, &[rays.binding()], [1, 1, 1]) {
        report("A launch without all of its buffers:", &error);
    }

    gpu.read(&rays).map(|rays| {
        println!("The device still works: it returned {:?}\n", rays[0]);
    })
}

fn main() -> spherule::Result<()> {
    match Gpu::open(&DeviceChoice::Gpu) {
        Ok(gpu) => make_mistakes(&gpu)?,
        Err(error) => report("No GPU to make mistakes on:", &error),
    }

    let mut scene = Scene::load(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/two-spheres.toml"
    ))?;
    (scene.width, scene.height) = (640, 360);
    // If the GPU fails, the program goes on: the CPU renders the same image.
    let rendered = Device::open(&DeviceChoice::Gpu)
        .and_then(|(device, _)| render(&scene, Shading::Lit, &device, QUIET))
        .or_else(|error| {
            report("Falling back to the CPU:", &error);
            render(&scene, Shading::Lit, &Device::Cpu, QUIET)
        })?;
    rendered.image.save("step5.png")?;
    println!("wrote step5.png");
    Ok(())
}
