//! Fuzz targets: the tracers on the CPU with floats of any bits, the scene file, and each reader.
//!
//!     SPHERULE_FUZZ_SECONDS=60 cargo test --release --test fuzz -- --nocapture

mod driver;

use std::fmt::Write as _;
use std::path::Path;

use driver::{Words, fuzz};
use spherule::accel::Acceleration;
use spherule::kernel::accel::brute::{is_occluded, nearest_hit_in};
use spherule::kernel::glam::Vec3;
use spherule::kernel::{Hit, Ray, Rung, Shading, Sphere};
use spherule::look;
use spherule::random::Random;
use spherule::read::particles::{self, pdb, xyz};
use spherule::read::{environment, toml};
use spherule::render::{QUIET, Settings, render};
use spherule::scene::limits;
use spherule::trace::CpuTracer;
use spherule::{Device, Error};

/// The message of an error in the input. Checks its place and its help.
fn outcome(error: &Error) -> String {
    let (message, help) = (error.to_string(), error.help());
    assert!(!message.is_empty() && !help.is_empty(), "{error:?}");
    assert!(error.is_input(), "{error:?}");
    let Error::Scene(error) = error else {
        return message;
    };
    if let Some(place) = &error.place {
        let (line, column) = place.line_column();
        assert!(line > 0 && column > 0, "{error:?}");
        assert!(place.text.get(place.span.clone()).is_some(), "{error:?}");
    }
    // The message without the path and the line.
    error.message.clone()
}

/// Floats at which arithmetic behaves oddly.
const FLOATS: &[&[u8]] = &[
    &f32::NAN.to_le_bytes(),
    &f32::INFINITY.to_le_bytes(),
    &f32::NEG_INFINITY.to_le_bytes(),
    &f32::MAX.to_le_bytes(),
    &f32::MIN.to_le_bytes(),
    &f32::MIN_POSITIVE.to_le_bytes(),
    &1e-42_f32.to_le_bytes(),
    &0_f32.to_le_bytes(),
    &(-0_f32).to_le_bytes(),
    &1_f32.to_le_bytes(),
    &(-1_f32).to_le_bytes(),
    &1e-19_f32.to_le_bytes(),
    &1e19_f32.to_le_bytes(),
    &1e10_f32.to_le_bytes(),
    &(-1e24_f32).to_le_bytes(),
    &1e18_f32.to_le_bytes(),
    &0.5_f32.to_le_bytes(),
    &[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
];

/// Whether the squares that the rungs compute neither overflow nor underflow.
fn is_within_domain(ray: &Ray) -> bool {
    let size = ray.direction.abs().max_element();
    (1e-10..1e10).contains(&size) && ray.origin.abs().max_element() < 1e10
}

/// The input's first byte chooses how many random spheres there are, and its second how many
/// spheres follow. Then come floats: four a sphere and eight a ray.
#[test]
fn tracer() {
    let words = Words {
        words: FLOATS,
        is_text: false,
    };
    let mut random = Random::new(3);
    let more: Vec<Sphere> = (0..5000)
        .map(|_| Sphere::new(random.vec3(-2.0, 2.0), random.log_within(0.01, 0.3)))
        .collect();
    fuzz("tracer", &words, |input| {
        let [size, own, numbers @ ..] = input else {
            return "empty".into();
        };
        let size = [0, 1, 5, 30, 200, 900, 2000, 5000][usize::from(size % 8)];
        let numbers: Vec<f32> = numbers
            .chunks_exact(4)
            .map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
            .collect();
        let of_spheres = (4 * usize::from(own % 32)).min(numbers.len() / 4 * 4);
        let (of_spheres, of_rays) = numbers.split_at(of_spheres);
        let mut spheres = more[..size].to_vec();
        spheres.extend(
            of_spheres
                .chunks_exact(4)
                .map(|n| Sphere::new(Vec3::new(n[0], n[1], n[2]), n[3])),
        );
        let rays: Vec<Ray> = of_rays
            .chunks_exact(8)
            .take(16)
            .map(|n| {
                Ray::within(
                    Vec3::new(n[0], n[1], n[2]),
                    Vec3::new(n[3], n[4], n[5]),
                    n[6],
                    n[7],
                )
            })
            .collect();
        trace(&spheres, &rays)
    });
}

/// Hits name spheres that exist, and lie in the ray's interval. If no square of the inputs
/// overflows or underflows, trees find what testing every sphere finds, and a ray is occluded
/// exactly if it has a hit.
fn trace(spheres: &[Sphere], rays: &[Ray]) -> String {
    let are_within = spheres.iter().all(|sphere| {
        limits::is_within(sphere, Vec3::ZERO, (0.0, 0.0))
            && sphere.center().abs().max_element() < 1e10
            && (1e-10..1e10).contains(&sphere.radius())
    });
    let mut kinds = [0; 4];
    for acceleration in [
        Acceleration::Auto,
        Acceleration::Tree,
        Acceleration::BruteForce,
    ] {
        // Testing every sphere of a large world takes too long.
        if acceleration == Acceleration::BruteForce && spheres.len() >= 300 {
            continue;
        }
        let tracer = CpuTracer::new(spheres, acceleration);
        let (mut hits, mut occluded) = (Vec::new(), Vec::new());
        for rung in Rung::ALL {
            tracer.nearest(rung, rays, &mut hits);
            tracer.occluded(rung, rays, &mut occluded);
            let _ = tracer.work(rung, true, rays);
            for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(&occluded) {
                let name = format!(
                    "{} spheres, {acceleration:?}, {rung:?}, {ray:?}: {hit:?}",
                    spheres.len()
                );
                let is_none = hit.sphere == Hit::NONE_SPHERE && hit.t == Hit::NONE_T;
                assert!(is_none || (hit.sphere as usize) < spheres.len(), "{name}");
                // An interval whose end is NaN has no end.
                let is_beyond = hit.t < ray.t_min || hit.t >= ray.t_max;
                assert!(is_none || !is_beyond, "{name}");
                assert!(*occluded <= 1, "{name}");
                let is_checked = are_within && is_within_domain(ray);
                kinds[usize::from(is_none) + 2 * usize::from(is_checked)] += 1;
                if !is_checked {
                    continue;
                }
                assert_eq!(*occluded == 1, hit.is_some(), "{name}");
                if spheres.len() < 300 {
                    let all = nearest_hit_in(rung.to_u32(), ray, spheres, 0, u32::MAX);
                    // Of equally near spheres, trees may find any.
                    assert_eq!(hit.t, all.t, "{name}");
                    assert_eq!(
                        is_occluded(rung.to_u32(), ray, spheres),
                        all.is_some(),
                        "{name}"
                    );
                }
            }
        }
    }
    // The outcome's kind depends on the numbers of spheres and of hits.
    let mut text = String::new();
    for kind in kinds.into_iter().chain([spheres.len()]) {
        let _ = write!(text, "{}", ["a", "b", "c", "d"][kind.min(3)]);
    }
    text
}

const OF_SCENES: &[&[u8]] = &[
    b"[image]\n",
    b"[camera]\n",
    b"[sky]\n",
    b"[fog]\n",
    b"[materials.m]\n",
    b"[[sphere]]\n",
    b"[[light]]\n",
    b"[[molecule]]\n",
    b"width = ",
    b"height = ",
    b"samples = ",
    b"max_bounces = ",
    b"seed = ",
    b"exposure = ",
    b"tonemap = ",
    b"background = ",
    b"transparent = true\n",
    b"ambient_occlusion = ",
    b"caustics = ",
    b"eye = ",
    b"target = ",
    b"up = ",
    b"vertical_fov = ",
    b"aperture = ",
    b"focus_distance = ",
    b"shutter = ",
    b"horizon = ",
    b"zenith = ",
    b"sun_direction = ",
    b"sun_irradiance = ",
    b"sun_size = ",
    b"image = ",
    b"strength = ",
    b"rotation = ",
    b"extinction = ",
    b"albedo = ",
    b"anisotropy = ",
    b"center = ",
    b"radius = ",
    b"kind = ",
    b"color = ",
    b"roughness = ",
    b"index = ",
    b"absorption = ",
    b"radiance = ",
    b"thickness = ",
    b"material = ",
    b"velocity = ",
    b"position = ",
    b"intensity = ",
    b"file = ",
    b"\"diffuse\"",
    b"\"metal\"",
    b"\"glass\"",
    b"\"emissive\"",
    b"\"c60.xyz\"",
    b"\"\"",
    b"[0, 0, 0]",
    b"[1, 1, 1]",
    b"[1e18, -1e18, 0]",
    b"[0, 1]",
    b"0",
    b"1",
    b"-1",
    b"0.5",
    b"nan",
    b"inf",
    b"-inf",
    b"1e18",
    b"1e-18",
    b"1e39",
    b"1e-46",
    b"1e999",
    b"65536",
    b"65537",
    b"4294967295",
    b"4294967296",
    b"9223372036854775808",
    b"-0.0",
    b"1_0",
    b"0x10",
    b"true",
    b"\"\\u0000\"",
    b"'",
    b"\"\"\"",
    b"#",
    b"[",
    b"]",
    b"{",
    b"}",
    b"=",
    b".",
    b",",
    b"\n",
    b"\r\n",
    b"\0",
    b"\xef\xbb\xbf",
    b"\xff",
];

/// A scene that is read can be rendered, or is refused.
#[test]
fn scene_file() {
    let words = Words {
        words: OF_SCENES,
        is_text: true,
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fuzzed.toml");
    fuzz("scene_file", &words, |input| {
        let text = String::from_utf8_lossy(input).into_owned();
        let mut scene = match toml::parse(&path, text) {
            Ok(scene) => scene,
            Err(error) => return outcome(&error),
        };
        (scene.width, scene.height) = (scene.width.min(4), scene.height.min(3));
        scene.sampling.samples = scene.sampling.samples.map(|samples| samples.min(2));
        scene.sampling.max_bounces = scene.sampling.max_bounces.min(8);
        match render(&scene, Settings::from(Shading::Lit), &Device::Cpu, QUIET) {
            Ok(rendered) => {
                let _ = rendered.image.to_rgba8();
                format!("rendered {:?}", scene.called_effects().len())
            }
            Err(error) => outcome(&error),
        }
    });
}

/// Atoms that are read make a valid world.
fn atoms(atoms: &[particles::Atom]) -> String {
    assert!(
        atoms.iter().all(|atom| atom.position.is_finite()),
        "{atoms:?}"
    );
    let world = look::world(atoms, look::origin(atoms).unwrap_or_default());
    assert_eq!(world.spheres.len(), atoms.len());
    assert_eq!(world.material_ids.len(), atoms.len());
    assert!(
        world
            .material_ids
            .iter()
            .all(|id| (*id as usize) < world.materials.len())
    );
    format!("{} kinds", "x".repeat(world.materials.len().min(20)))
}

#[test]
fn pdb_file() {
    let words = Words {
        words: &[
            b"ATOM  ",
            b"HETATM",
            b"MODEL        1\n",
            b"ENDMDL\n",
            b"END\n",
            b"TER\n",
            b"ANISOU",
            b"REMARK",
            b"CONECT",
            b" CA ",
            b"CA  ",
            b" N  ",
            b"FE  ",
            b" C",
            b"ZN",
            b"1+",
            b"A",
            b"B",
            b" ",
            b"        ",
            b"  17.047",
            b"-999.999",
            b"9999.999",
            b"     nan",
            b"     inf",
            b"    1e39",
            b"1e-40",
            b"*****",
            b"\t",
            b"\r\n",
            b"\n",
            b"\0",
            b"\xc3\xa4",
            b"\xff",
            b"ATOM",
            b"atom  ",
        ],
        is_text: true,
    };
    fuzz("pdb", &words, |input| {
        match pdb::parse(&String::from_utf8_lossy(input)) {
            Ok(found) => atoms(&found),
            Err(wrong) => format!("{wrong:?}"),
        }
    });
}

#[test]
fn xyz_file() {
    let words = Words {
        words: &[
            b"0",
            b"1",
            b"2",
            b"3",
            b"60",
            b"-1",
            b"4294967296",
            b"18446744073709551615",
            b"99999999999999999999",
            b"1000000",
            b"C",
            b"Fe",
            b"C1",
            b"X",
            b"6",
            b"118",
            b"119",
            b"0.5",
            b"nan",
            b"inf",
            b"-inf",
            b"1e39",
            b"1e-46",
            b"1d0",
            b"1.0E+00",
            b"+1",
            b".",
            b"Properties=species:S:1:pos:R:3",
            b" ",
            b"\t",
            b"\n",
            b"\r\n",
            b"\n\n",
            b"\0",
            b"\xc3\xa4",
            b"\xff",
            b"\xef\xbb\xbf",
        ],
        is_text: true,
    };
    fuzz("xyz", &words, |input| {
        match xyz::parse(&String::from_utf8_lossy(input)) {
            Ok(found) => atoms(&found),
            Err(wrong) => format!("{wrong:?}"),
        }
    });
}

#[test]
fn environment_image() {
    let words = Words {
        words: &[
            b"#?RADIANCE\n",
            b"#?RGBE\n",
            b"FORMAT=32-bit_rle_rgbe\n",
            b"FORMAT=32-bit_rle_xyze\n",
            b"EXPOSURE=",
            b"GAMMA=",
            b"PRIMARIES=",
            b"-Y ",
            b"+Y ",
            b" +X ",
            b" -X ",
            b"0",
            b"1",
            b"8",
            b"32767",
            b"32768",
            b"4294967295",
            b"-1",
            b"\n",
            b"\n\n",
            &[2, 2, 0, 8],
            &[2, 2, 0x7f, 0xff],
            &[1, 1, 1, 255],
            &[128],
            &[127],
            &[255],
            &[0],
            &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0],
            b"channels\0",
            b"chlist\0",
            b"compression\0",
            b"dataWindow\0",
            b"displayWindow\0",
            b"box2i\0",
            b"tiles\0",
            b"tiledesc\0",
            b"lineOrder\0",
            b"float\0",
            &[255, 255, 255, 255],
            &[255, 255, 255, 127],
            &[0, 0, 0, 128],
            &[0, 0, 0, 0],
            &[1, 0, 0, 0],
            &[0, 0, 0xc0, 0x7f],
            &[0, 0, 0x80, 0x7f],
            &[0, 0, 1, 0],
            &[0, 0, 0, 1],
        ],
        is_text: false,
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image");
    fuzz("environment", &words, |input| {
        std::fs::write(&path, input).expect("a file");
        match environment::load(&path, 1.0) {
            Ok(image) => {
                let texels = u64::from(image.width) * u64::from(image.height);
                assert_eq!(texels, image.texels.len() as u64);
                assert!(texels > 0);
                let is_light = |texel: &Vec3| texel.is_finite() && texel.min_element() >= 0.0;
                assert!(image.texels.iter().all(is_light));
                "an image".into()
            }
            Err(error) => outcome(&error),
        }
    });
}
