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

use bytemuck::Pod;
use serde_json::json;
use spherule_kernel::Rung;

use super::rays::{Kind, RaySets};
use crate::error::{Error, Result};
use crate::render::whole_image;
use crate::scene::Scene;
use crate::trace::CpuTracer;

/// Writes the files into `folder`, which is made if need be.
///
/// # Errors
///
/// [`Error::Image`] for a file that cannot be written, and as [`whole_image`].
pub fn export(
    folder: &Path,
    name: &str,
    scene: &Scene,
    sets: &RaySets,
    tracer: &CpuTracer,
    rung: Rung,
) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
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
    put(&folder.join("meta.json"), meta.to_string().as_bytes())?;
    put_all(&folder.join("spheres.f32"), &scene.world.spheres)?;
    put_all(&folder.join("nodes.u32"), tracer.tree().nodes())?;
    put_all(&folder.join("order.u32"), tracer.order())?;
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    for kind in Kind::ALL {
        let rays = sets.kind(kind);
        put_all(&folder.join(format!("{}.f32", kind.name())), rays)?;
        let path = folder.join(format!("{}.hits", kind.name()));
        if kind.is_any() {
            tracer.occluded(rung, rays, &mut occluded);
            put_all(&path, &occluded)?;
        } else {
            tracer.nearest(rung, rays, &mut hits);
            put_all(&path, &hits)?;
        }
    }
    Ok(())
}

fn put_all<T: Pod>(path: &Path, values: &[T]) -> Result<()> {
    put(path, bytemuck::cast_slice(values))
}

fn put(path: &Path, bytes: &[u8]) -> Result<()> {
    std::fs::write(path, bytes).map_err(|error| failed(path, &error))
}

fn failed(path: &Path, error: &std::io::Error) -> Error {
    Error::Image {
        path: path.into(),
        reason: format!("cannot be written: {error}"),
        help: "check that the folder may be written, and that there is room".into(),
    }
}
