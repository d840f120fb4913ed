//! Renders that end early: by a time limit, by their progress callback, or by a signal.

mod common;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use spherule::Device;
use spherule::accel::Acceleration;
use spherule::kernel::{Rung, Shading};
use spherule::render::EffectChoice;
use spherule::render::paths::StoppedBy;
use spherule::render::{QUIET, Rendered, Settings, render};
use spherule::scene::Scene;

/// A scene of the folder `scenes`, in this size.
fn scene(name: &str, width: u32, height: u32) -> Scene {
    let mut scene = Scene::load(format!("scenes/{name}")).expect("a scene");
    (scene.width, scene.height) = (width, height);
    scene
}

/// One sample of this takes minutes, so a short render is cut within it.
fn endless() -> Scene {
    scene("fog.toml", 4096, 2048)
}

fn small(width: u32, height: u32) -> Scene {
    let mut scene = scene("soft-light.toml", width, height);
    scene.sampling.samples = Some(16);
    scene
}

fn lit() -> Settings {
    Settings::from((Shading::Lit, Rung::Robust))
}

fn lit_within(time_limit: Duration) -> Settings {
    lit().time_limit(time_limit)
}

/// The CPU, and every adapter.
fn devices(test: &str) -> Vec<Device> {
    let mut devices = vec![Device::Cpu];
    if !common::skips(test) {
        devices.extend(common::all_adapters().iter().map(common::device));
    }
    devices
}

fn opacities(rendered: &Rendered) -> (u64, u64) {
    let alpha = common::opacities(&rendered.image);
    let opaque = alpha.iter().filter(|alpha| **alpha == 1.0).count();
    let clear = alpha.iter().filter(|alpha| **alpha == 0.0).count();
    assert_eq!(opaque + clear, alpha.len());
    (opaque as u64, clear as u64)
}

#[test]
fn a_time_limit_cuts_a_sample() {
    for device in devices("a_time_limit_cuts_a_sample") {
        let scene = endless();
        let settings = lit_within(Duration::from_millis(300));
        let rendered = render(&scene, settings, &device, QUIET).expect("an image");
        // Without the time limit it takes minutes.
        let took = rendered.timings.trace;
        assert!(took < Duration::from_secs(20), "{took:?}");
        let reached = rendered.reached.expect("samples");
        assert_eq!(reached.stopped_by, StoppedBy::TimeLimit);
        if reached.samples > 0 {
            assert!(is_fast(&device), "{}", device.name());
            continue;
        }
        assert_eq!(rendered.rays, rendered.traced);
        assert!(reached.noise.is_infinite());
        assert!(!rendered.is_complete());
        let pixels = u64::from(scene.width) * u64::from(scene.height);
        assert!(rendered.traced > 0 && rendered.traced < pixels);
        // The preview fills the rest: no pixel is black or missing.
        assert!(!rendered.image.has_alpha());
        let last = rendered.image.pixels().last().expect("pixels");
        assert!(last.is_written() && last.color().max_element() > 0.0);
    }
}

#[test]
fn a_time_limit_that_is_not_reached_changes_nothing() {
    for device in devices("a_time_limit_that_is_not_reached_changes_nothing") {
        // The width is such that rows begin where no launch on a GPU may begin.
        let scene = small(213, 121);
        let free = render(&scene, lit(), &device, QUIET).expect("an image");
        let settings = lit_within(Duration::from_secs(1000));
        let limited = render(&scene, settings, &device, QUIET).expect("an image");
        assert!(free.is_complete() && limited.is_complete());
        assert_eq!(free.image, limited.image);
        let reached = limited.reached.expect("samples");
        assert_eq!((reached.samples, reached.asked), (16, 16));
        assert_eq!(limited.rays, 16 * limited.traced);
        assert_eq!(reached.stopped_by, StoppedBy::Samples);
    }
}

/// Whether the device is a real GPU, which renders in a moment what takes the others minutes.
fn is_fast(device: &Device) -> bool {
    matches!(device, Device::Gpu(gpu) if !gpu.is_software())
}

/// A number of calls of a progress callback, which depends on the kind of the device.
fn calls_on(device: &Device, cpu: usize, gpu: usize) -> usize {
    match device {
        Device::Cpu => cpu,
        Device::Gpu(_) => gpu,
    }
}

/// A progress callback that interrupts the render after this many calls.
fn after(calls: usize) -> impl Fn(f64) -> ControlFlow<()> + Sync {
    let count = AtomicUsize::new(0);
    move |done| {
        assert!((0.0..=1.0).contains(&done), "{done}");
        if count.fetch_add(1, Ordering::Relaxed) >= calls {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn interrupted_camera_rays_keep_the_pixels_that_are_done() {
    for device in devices("interrupted_camera_rays_keep_the_pixels_that_are_done") {
        let scene = scene("two-spheres.toml", 1024, 8192);
        // Measurements would be transparent where nothing is hit, too.
        for shading in [Shading::Lit, Shading::Flat] {
            let settings = Settings::from((shading, Rung::Robust))
                .effects(EffectChoice::Auto)
                .acceleration(Acceleration::Auto);
            let whole = render(&scene, settings, &device, QUIET).expect("an image");
            assert!(whole.is_complete());
            assert!(!whole.image.has_alpha());
            let calls = calls_on(&device, 200, 2);
            let part = render(&scene, settings, &device, &after(calls)).expect("an image");
            if part.is_complete() {
                // A GPU may render everything in one launch.
                assert!(!matches!(device, Device::Cpu));
                assert_eq!(part.image, whole.image);
                continue;
            }
            let (opaque, clear) = opacities(&part);
            assert!(opaque > 0 && clear > 0, "{}", device.name());
            assert_eq!(part.traced, opaque);
            let alpha = common::opacities(&part.image);
            for (index, alpha) in alpha.iter().enumerate() {
                let pixel = part.image.pixels()[index];
                if *alpha == 1.0 {
                    assert_eq!(pixel, whole.image.pixels()[index]);
                } else {
                    assert!(!pixel.is_hit() && pixel.color().max_element() == 0.0);
                }
            }
        }
    }
}

#[test]
fn a_time_limit_cuts_camera_rays() {
    for device in devices("a_time_limit_cuts_camera_rays") {
        let scene = scene("c60.xyz", 4096, 4096);
        let within = |limit| render(&scene, lit_within(limit), &device, QUIET).expect("an image");
        let none = within(Duration::ZERO);
        assert_eq!((none.traced, none.rays), (0, 0));
        let part = within(Duration::from_millis(2));
        let pixels = u64::from(scene.width) * u64::from(scene.height);
        assert_eq!(part.rays, part.traced);
        if !part.is_complete() {
            let (opaque, clear) = opacities(&part);
            assert_eq!((opaque, clear), (part.traced, pixels - part.traced));
        }
        assert!(!part.is_complete() || is_fast(&device));
    }
}

#[test]
fn light_paths_are_interrupted_in_the_first_sample_and_later() {
    for device in devices("light_paths_are_interrupted_in_the_first_sample_and_later") {
        let scene = small(512, 512);
        let calls = calls_on(&device, 200, 2);
        let part = render(&scene, lit(), &device, &after(calls)).expect("an image");
        assert!(!part.is_complete());
        let reached = part.reached.expect("samples");
        assert_eq!(reached.stopped_by, StoppedBy::Interrupted);
        if reached.samples > 0 {
            // A GPU may trace the first sample in one launch.
            assert!(!matches!(device, Device::Cpu));
            continue;
        }
        let (opaque, clear) = opacities(&part);
        assert!(opaque > 0 && clear > 0, "{}", device.name());
        assert_eq!(part.traced, opaque);
        let alpha = common::opacities(&part.image);
        for (index, alpha) in alpha.iter().enumerate() {
            let pixel = part.image.pixels()[index];
            // A pixel that was traced may be black, too: its sample may be in a shadow.
            assert!(*alpha == 1.0 || pixel.color() == glam::Vec3::ZERO);
        }

        // A call comes after at most 16 pixels, and after fewer at first and on a busy machine. So
        // this interrupts in the midst of the second launch.
        let calls = calls_on(&device, 27_000, 12);
        let part = render(&scene, lit(), &device, &after(calls)).expect("an image");
        let reached = part.reached.expect("samples");
        if !part.is_complete() {
            assert_eq!(reached.stopped_by, StoppedBy::Interrupted);
            let in_samples = part.rays / part.traced;
            assert!((u64::from(reached.samples)..16).contains(&in_samples));
            assert!((1..16).contains(&reached.samples), "{}", reached.samples);
            assert!(!part.image.has_alpha());
        }
        // The noise is that of the pixels so far.
        assert!(reached.noise > 0.0);
    }
}

#[test]
fn a_render_that_is_interrupted_at_once_traces_nothing() {
    for device in devices("a_render_that_is_interrupted_at_once_traces_nothing") {
        for scene in ["scenes/two-spheres.toml", "scenes/soft-light.toml"] {
            let scene = Scene::load(scene).expect("a scene");
            let settings = lit_within(Duration::from_secs(1));
            for settings in [lit(), settings] {
                let rendered = render(&scene, settings, &device, &after(0)).expect("an image");
                assert_eq!(rendered.traced, 0);
                assert!(!rendered.is_complete());
                let (opaque, _) = opacities(&rendered);
                assert_eq!(opaque, 0);
            }
        }
    }
}

#[cfg(unix)]
mod signals {
    use std::fmt::Write as _;
    use std::io::{BufRead, BufReader, Read};
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    /// Renders over an existing file, sends the signal some time after tracing has begun, and
    /// checks that the image so far was written.
    fn is_kept(
        scene: &Path,
        device: &str,
        arguments: &[&str],
        signal: &str,
        code: i32,
        says: &str,
    ) {
        let folder = tempfile::tempdir().expect("a folder");
        let output = folder.path().join("out.png");
        let before = b"what was there before";
        let mut wait = Duration::from_millis(500);
        loop {
            std::fs::write(&output, before).expect("a file");
            let mut child = Command::new(env!("CARGO_BIN_EXE_spherule"))
                .arg("render")
                .arg(scene)
                .args(["--device", device, "-o"])
                .arg(&output)
                .args(arguments)
                .stderr(Stdio::piped())
                .spawn()
                .expect("it starts");
            let mut stderr = BufReader::new(child.stderr.take().expect("a pipe"));
            let mut said = String::new();
            // This line is printed just before tracing, or before a GPU's kernel is compiled.
            while !said.contains("precision ") {
                let read = stderr.read_line(&mut said).expect("text");
                assert!(read > 0, "{said}");
            }
            std::thread::sleep(wait);
            let sent = Command::new("kill")
                .args(["-s", signal, &child.id().to_string()])
                .status()
                .expect("kill runs");
            assert!(sent.success(), "the command ended before the signal");
            let started = Instant::now();
            stderr.read_to_string(&mut said).expect("text");
            let status = child.wait().expect("it ends");
            let took = started.elapsed();
            assert_eq!(status.code(), Some(code), "{said}");
            // Work in progress is finished, then the image is encoded. Without the signal it takes
            // minutes.
            assert!(took < Duration::from_secs(20), "{took:?}");
            if said.contains("before the first pixel was done") && wait.as_secs() < 60 {
                assert_eq!(std::fs::read(&output).expect("a file"), before);
                wait *= 2;
                continue;
            }
            assert!(said.contains("interrupted: wrote "), "{said}");
            // A busy machine may still be in the first sample.
            if !said.contains(says) && wait.as_secs() < 60 {
                wait *= 2;
                continue;
            }
            assert!(said.contains(says), "{said}");
            let image = image::open(&output).expect("an image");
            let is_whole = says.contains("samples");
            assert_eq!(image.color().has_alpha(), !is_whole);
            let others = std::fs::read_dir(folder.path()).expect("a folder").count();
            assert_eq!(others, 1, "files are left behind");
            break;
        }
    }

    const LONG: [&str; 4] = ["--size", "256x256", "--samples", "60000"];
    const SAMPLES: &str = " of 60000 samples a pixel";
    const PIXELS: &str = " % of the pixels";

    fn soft_light() -> &'static Path {
        Path::new("scenes/soft-light.toml")
    }

    #[test]
    fn sigint_keeps_light_paths() {
        is_kept(soft_light(), "cpu", &LONG, "INT", 130, SAMPLES);
        if !super::common::skips("sigint_keeps_light_paths") {
            is_kept(soft_light(), "gpu", &LONG, "INT", 130, SAMPLES);
        }
    }

    #[test]
    fn sigterm_and_sighup_keep_light_paths() {
        is_kept(soft_light(), "cpu", &LONG, "TERM", 143, SAMPLES);
        is_kept(soft_light(), "cpu", &LONG, "HUP", 129, SAMPLES);
    }

    #[test]
    fn sigint_keeps_the_pixels_of_a_first_sample() {
        let large = ["--size", "4096x2048", "--samples", "1"];
        let fog = Path::new("scenes/fog.toml");
        is_kept(fog, "cpu", &large, "INT", 130, PIXELS);
    }

    /// Each ray is tested against every sphere here: one sphere is so far away that all boxes are
    /// too coarse to cull.
    #[test]
    fn sigint_keeps_camera_rays() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = folder.path().join("many.toml");
        let mut text = String::from("[camera]\neye = [0, 0, 20]\ntarget = [0, 0, 0]\n");
        for index in 0..20_000 {
            let (x, y) = (index % 141 - 70, index / 141 - 70);
            let z = if index == 0 { "-1e17" } else { "0" };
            writeln!(text, "[[sphere]]\ncenter = [{x}, {y}, {z}]\nradius = 0.4").expect("text");
        }
        std::fs::write(&scene, text).expect("a file");
        let robust = |size| ["--size", size, "--precision", "robust"];
        is_kept(&scene, "cpu", &robust("2048x2048"), "INT", 130, PIXELS);
        let skips = super::common::skips("sigint_keeps_camera_rays");
        if !skips && super::common::gpus()[0].is_software() {
            let molecule = Path::new("scenes/2hhb.pdb");
            is_kept(molecule, "gpu", &robust("8192x4096"), "INT", 130, PIXELS);
        }
    }
}
