//! What `auto` promises: where it says that a rung keeps an image within the tolerance, the rung
//! shows the sphere that is there, but for pixels at an edge.

use spherule::choose::{DEFAULT_TOLERANCE, bound, choose};
use spherule::kernel::glam::Vec3;
use spherule::kernel::shading::index_of;
use spherule::kernel::{Material, Rung, Shading, Sphere};
use spherule::random::Random;
use spherule::render::{QUIET, Settings, render};
use spherule::scene::{View, World};
use spherule::{Device, Scene};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 180;

/// The indices that the pixels of an image hold; `u32::MAX` where nothing is hit.
fn seen(scene: &Scene, rung: Rung) -> Vec<u32> {
    let settings = Settings::default().shading(Shading::Id).rung(rung);
    let rendered = render(scene, settings, &Device::Cpu, QUIET).expect("an image");
    let pixels = rendered.image.pixels();
    pixels
        .iter()
        .map(|pixel| {
            if pixel.is_hit() {
                index_of(pixel.color())
            } else {
                u32::MAX
            }
        })
        .collect()
}

/// The pixels that show another sphere than the exact image, and none of whose neighbours there
/// shows another one.
fn wrong_away_from_edges(exact: &[u32], found: &[u32]) -> usize {
    let (width, height) = (WIDTH as usize, HEIGHT as usize);
    let is_uniform = |x: usize, y: usize| {
        let own = exact[y * width + x];
        (y.saturating_sub(1)..(y + 2).min(height))
            .all(|y| (x.saturating_sub(1)..(x + 2).min(width)).all(|x| exact[y * width + x] == own))
    };
    (0..width * height)
        .filter(|index| exact[*index] != found[*index])
        .filter(|index| is_uniform(index % width, index / width))
        .count()
}

/// Spheres that overlap, many with surfaces at small angles to each other, seen from outside or
/// from between them.
fn overlapping(random: &mut Random) -> Scene {
    let mut world = World::default();
    let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
    let scale = random.log_within(1e-3, 1e3);
    let spread = scale * random.log_within(1e-6, 1.0);
    let offset = random.vec3(-1.0, 1.0) * scale * random.log_within(0.1, 1e3);
    let count = 2 + (random.next_u32() % 6);
    for _ in 0..count {
        let radius = scale + random.within(-1.0, 1.0) * spread;
        world.add(
            Sphere::new(offset + random.vec3(-1.0, 1.0) * spread, radius),
            grey,
        );
    }
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (WIDTH, HEIGHT);
    let distance = scale * random.log_within(1.5, 1e3);
    let fov = (2.5 * (scale / distance).atan().to_degrees()).min(90.0);
    scene.view = Some(View {
        eye: offset + random.unit_vec3() * distance,
        target: offset,
        up: Vec3::new(0.3, 0.9, 0.1),
        vertical_fov: f64::from(fov),
    });
    scene
}

/// Both sides of the promise: no rung that is chosen is wrong, and where `robust` is refused by
/// far, it is wrong more often than not.
#[test]
fn the_chosen_rung_shows_what_is_there() {
    let mut random = Random::new(7);
    let (mut chosen_robust, mut refused, mut refused_rightly) = (0, 0, 0);
    for index in 0..300 {
        let scene = overlapping(&mut random);
        let exact = seen(&scene, Rung::Certified);
        let wrong_on = |rung| wrong_away_from_edges(&exact, &seen(&scene, rung));
        for has_f64 in [true, false] {
            let choice = choose(&scene, DEFAULT_TOLERANCE, has_f64);
            assert_eq!(wrong_on(choice.rung), 0, "scene {index}: {choice:?}");
            chosen_robust += usize::from(choice.rung == Rung::Robust);
        }
        if bound(&scene, Rung::Robust, DEFAULT_TOLERANCE) > 100.0 {
            refused += 1;
            refused_rightly += usize::from(wrong_on(Rung::Robust) > 0);
        }
    }
    assert!(chosen_robust > 30, "{chosen_robust}");
    assert!(
        refused > 50 && 2 * refused_rightly > refused,
        "{refused_rightly} of {refused}"
    );
}
