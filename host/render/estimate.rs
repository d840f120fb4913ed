//! Whether an image is traced on the CPU before a GPU is so much as open.
//!
//! To open a GPU takes 30 to 300 ms, most of it the driver's start, so that for a small image it
//! has nothing to give, however fast it is. The times here are of one thread of a Sapphire Rapids
//! at 2 to 3 GHz, `spherule render --device cpu --stats -` of two spheres and of the scenes with
//! light paths, and `spherule bench` of R10k to R1M.

use std::time::Duration;

use spherule_kernel::Shading;

use crate::render::EffectChoice;
use crate::scene::Scene;

/// What opening a GPU takes at least, and some milliseconds for bringing the image back.
const OPENING: Duration = Duration::from_millis(40);
/// A camera ray and its pixel, in seconds, and what grows with the square root of the number of
/// spheres.
const RAY: f64 = 25e-9;
const RAY_AMONG_MANY: f64 = 0.1e-9;
/// A light path with its shadow rays.
const PATH: f64 = 1e-6;

/// How long tracing takes on so many threads of a CPU, by the number of pixels, samples and spheres
/// alone: right to a factor of three or so. [`Duration::MAX`] where that is too much for a
/// duration.
#[must_use]
pub fn on_cpu(scene: &Scene, shading: Shading, effects: EffectChoice, threads: usize) -> Duration {
    let pixels = f64::from(scene.width) * f64::from(scene.height);
    let many = RAY_AMONG_MANY * (scene.world.spheres.len() as f64).sqrt();
    let shown = effects.shown(scene.effects());
    let pixel = if shading == Shading::Lit && !shown.is_empty() {
        f64::from(scene.samples()) * (PATH + many)
    } else {
        RAY + many
    };
    Duration::try_from_secs_f64(pixels * pixel / threads.max(1) as f64).unwrap_or(Duration::MAX)
}

/// Whether the CPU is done before a GPU would be open.
#[must_use]
pub fn is_brief(scene: &Scene, shading: Shading, effects: EffectChoice, threads: usize) -> bool {
    on_cpu(scene, shading, effects, threads) < OPENING
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_image_is_not_brief() {
        let mut scene = Scene::load("scenes/soft-light.toml").expect("a scene");
        (scene.width, scene.height) = (u32::MAX, u32::MAX);
        scene.sampling.samples = Some(u32::MAX);
        assert_eq!(
            on_cpu(&scene, Shading::Lit, EffectChoice::Auto, 1),
            Duration::MAX
        );
        assert!(!is_brief(&scene, Shading::Lit, EffectChoice::Auto, 0));
    }

    #[test]
    fn small_images_are_brief_and_light_paths_are_not() {
        let brief = |path: &str, width, height| {
            let mut scene = Scene::load(path).expect("a scene");
            (scene.width, scene.height) = (width, height);
            is_brief(&scene, Shading::Lit, EffectChoice::Auto, 2)
        };
        assert!(brief("scenes/two-spheres.toml", 1920, 1080));
        assert!(!brief("scenes/two-spheres.toml", 7680, 4320));
        assert!(!brief("scenes/soft-light.toml", 640, 360));
        assert!(brief("scenes/soft-light.toml", 16, 9));
    }
}
