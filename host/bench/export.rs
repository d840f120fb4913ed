//! A world, its rays and what they hit, as plain files of 32-bit numbers, lowest byte first.
//!
//! | file | holds |
//! | --- | --- |
//! | `meta.json` | names, counts, the size of the image, the camera |
//! | `spheres.f32` | x, y, z, r of each sphere |
//! | `nodes.u32` | the nodes of the tree, 20 numbers each ([`Node`](spherule_kernel::tree::Node)); empty without one |
//! | `order.u32` | for each sphere in the order of the tree's leaves, its index in `spheres.f32` |
//! | `KIND.f32` | of each ray its origin, `t_min`, direction, `t_max` |
//! | `KIND.hits` | of each ray t and the sphere's index (`u32::MAX` for none), or 1 or 0 where any hit would do |

use std::path::Path;

use bytemuck::cast_slice;
use serde_json::json;
use spherule_kernel::Rung;

use super::rays::{Kind, RaySets};
use crate::error::{Error, Result};
use crate::render::whole_image;
use crate::scene::Scene;
use crate::trace::CpuTracer;
use crate::write::Output;
use crate::write::same::refuse_inputs;

/// Makes `folder` if need be, and checks that files can be made in it.
///
/// # Errors
///
/// [`Error::Output`] if not.
pub fn prepare(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| Error::Output {
        path: folder.into(),
        reason: format!("cannot be made: {error}"),
        help: "name a folder in a directory that may be written".into(),
    })?;
    Output::new(&folder.join("meta.json"))?;
    Ok(())
}

/// Writes the files into `folder`, which is there.
///
/// # Errors
///
/// [`Error::Output`] for a file that cannot be written, [`Error::OutputRefused`] for one that the scene was read
/// from, and as [`whole_image`].
pub fn export(
    folder: &Path,
    name: &str,
    scene: &Scene,
    sets: &RaySets,
    tracer: &CpuTracer,
    rung: Rung,
) -> Result<()> {
    let put = |file: &str, bytes: &[u8]| {
        let output = Output::new(&folder.join(file))?;
        refuse_inputs(&[&output], &scene.sources)?;
        output.write(bytes)
    };
    let camera = whole_image(scene)?.camera;
    let half_height = camera.up.length();
    let unit = |v: glam::Vec3| v.normalize_or_zero().to_array();
    let mut kinds = serde_json::Map::new();
    for kind in Kind::ALL {
        kinds.insert(kind.name().into(), sets.kind(kind).len().into());
    }
    let meta = json!({
        "scene": name,
        "spheres": scene.world.spheres.len(),
        "width": scene.width,
        "height": scene.height,
        "kinds": kinds,
        "camera": {
            "eye": camera.eye.to_array(),
            "forward": camera.forward.to_array(),
            "right": unit(camera.right),
            "up": unit(camera.up),
            "half_height": half_height,
        },
    });
    put("meta.json", meta.to_string().as_bytes())?;
    put("spheres.f32", cast_slice(&scene.world.spheres))?;
    put("nodes.u32", cast_slice(tracer.tree().nodes()))?;
    put("order.u32", cast_slice(tracer.order()))?;
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    for kind in Kind::ALL {
        let rays = sets.kind(kind);
        put(&format!("{}.f32", kind.name()), cast_slice(rays))?;
        let file = format!("{}.hits", kind.name());
        if kind.is_any() {
            tracer.occluded(rung, rays, &mut occluded);
            put(&file, cast_slice(&occluded))?;
        } else {
            tracer.nearest(rung, rays, &mut hits);
            put(&file, cast_slice(&hits))?;
        }
    }
    Ok(())
}
