//! Writes `scenes/one-weekend.toml`: a scene laid out like the final scene of P. Shirley, T. D.
//! Black and S. Hollasch, Ray Tracing in One Weekend, from a fixed seed.
//!
//! `cargo run --release --example one_weekend > scenes/one-weekend.toml`

use std::fmt::Write;

use spherule::kernel::glam::Vec3;
use spherule::random::Random;

fn main() {
    let mut random = Random::new(1);
    let mut materials = String::new();
    let mut spheres = String::new();
    let mut add = |center: Vec3, radius: f32, name: &str, material: Option<String>| {
        // Writing to a String cannot fail.
        if let Some(material) = material {
            let _ = write!(materials, "\n[materials.{name}]\n{material}");
        }
        let Vec3 { x, y, z } = center;
        let _ = write!(
            spheres,
            "\n[[sphere]]\ncenter = [{x:.4}, {y}, {z:.4}]\nradius = {radius}\nmaterial = \"{name}\"\n"
        );
    };
    let diffuse = |c: Vec3| {
        format!(
            "kind = \"diffuse\"\ncolor = [{:.3}, {:.3}, {:.3}]\n",
            c.x, c.y, c.z
        )
    };
    let metal = |c: Vec3, roughness: f32| {
        format!(
            "kind = \"metal\"\ncolor = [{:.3}, {:.3}, {:.3}]\nroughness = {roughness:.3}\n",
            c.x, c.y, c.z
        )
    };
    let glass = || "kind = \"glass\"\nindex = 1.5\n".to_owned();

    add(
        Vec3::new(0.0, -1000.0, 0.0),
        1000.0,
        "ground",
        Some(diffuse(Vec3::splat(0.5))),
    );
    add(Vec3::Y, 1.0, "glass", Some(glass()));
    add(
        Vec3::new(-4.0, 1.0, 0.0),
        1.0,
        "brown",
        Some(diffuse(Vec3::new(0.4, 0.2, 0.1))),
    );
    add(
        Vec3::new(4.0, 1.0, 0.0),
        1.0,
        "polished",
        Some(metal(Vec3::new(0.7, 0.6, 0.5), 0.0)),
    );
    let mut count = 0;
    // Glass that overlaps would call for more of the pipeline (`nested-glass`).
    let mut balls = vec![(Vec3::Y, 1.0)];
    for a in -11..11 {
        for b in -11..11 {
            let center = Vec3::new(
                a as f32 + 0.9 * random.within(0.0, 1.0),
                0.2,
                b as f32 + 0.9 * random.within(0.0, 1.0),
            );
            let choice = random.within(0.0, 1.0);
            let color = random.vec3(0.0, 1.0) * random.vec3(0.0, 1.0);
            let shine = random.vec3(0.5, 1.0);
            let roughness = random.within(0.0, 0.5).sqrt();
            if center.distance(Vec3::new(4.0, 0.2, 0.0)) <= 0.9 {
                continue;
            }
            count += 1;
            let name = format!("m{count}");
            if choice < 0.8 {
                add(center, 0.2, &name, Some(diffuse(color)));
            } else if choice < 0.95 {
                add(center, 0.2, &name, Some(metal(shine, roughness)));
            } else if balls.iter().all(|(c, r)| center.distance(*c) >= 0.2 + r) {
                add(center, 0.2, "glass", None);
                balls.push((center, 0.2));
            }
        }
    }
    print!(
        "# Laid out as the final scene of Ray Tracing in One Weekend (P. Shirley, T. D. Black, S. Hollasch).\n\
         # Written by `cargo run --release --example one_weekend`.\n\n\
         [image]\nwidth = 1200\nheight = 675\nsamples = 500\nmax_bounces = 50\n\n\
         [camera]\neye = [13, 2, 3]\ntarget = [0, 0, 0]\nvertical_fov = 20\naperture = 0.1047\nfocus_distance = 10\n\n\
         [sky]\nhorizon = [0.75, 0.85, 1]\nzenith = [0.5, 0.7, 1]\n{materials}{spheres}"
    );
}
