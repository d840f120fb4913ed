//! Writes a world, its rays and their hits as plain files of 32-bit numbers, lowest byte first.
//!
//! | file | holds |
//! | --- | --- |
//! | `meta.json` | names, counts, the size of the image, the camera |
//! | `spheres.f32` | x, y, z, r of each sphere |
//! | `nodes.u32` | the nodes of the tree, 20 numbers each ([`Node`](spherule_kernel::accel::node::Node)); empty without a tree |
//! | `order.u32` | for each sphere in the order of the tree's leaves, its index in `spheres.f32` |
//! | `KIND.f32` | origin, `t_min`, direction, `t_max` of each ray |
//! | `KIND.hits` | t and the sphere's index (`u32::MAX` for a miss) of each ray; for kinds that accept any hit, 1 or 0 |

use std::path::{Path, PathBuf};

use bytemuck::cast_slice;
use serde_json::json;
use spherule_kernel::Rung;

use super::rays::{Kind, RaySets};
use super::scenes::Source;
use crate::error::{Error, Result};
use crate::render::whole_image;
use crate::scene::Scene;
use crate::trace::CpuTracer;
use crate::write::same::{refuse_clashes, refuse_inputs};
use crate::write::{Output, create_folder};

/// Creates `folder` if necessary, and checks that files can be created in it.
///
/// # Errors
///
/// [`Error::Output`] if they cannot.
pub fn prepare(folder: &Path) -> Result<()> {
    create_folder(folder)?;
    outputs(folder)?;
    Ok(())
}

/// The names of the files.
fn names() -> impl Iterator<Item = String> {
    let of_scene = ["meta.json", "spheres.f32", "nodes.u32", "order.u32"];
    let of_kinds = Kind::ALL
        .into_iter()
        .flat_map(|kind| ["f32", "hits"].map(|end| format!("{}.{end}", kind.name())));
    of_scene.into_iter().map(Into::into).chain(of_kinds)
}

/// The outputs in the existing `folder`, before anything is written.
///
/// # Errors
///
/// [`Error::Output`] for one that cannot be written.
pub(crate) fn outputs(folder: &Path) -> Result<Vec<Output>> {
    names()
        .map(|name| Output::new(&folder.join(name)))
        .collect()
}

/// The folder of each scene: `folder` itself for a single scene, else a folder in it for each.
///
/// # Errors
///
/// [`Error::OutputRefused`] if two scenes would share a folder.
#[cfg_attr(
    not(feature = "cli"),
    expect(dead_code, reason = "only the command uses it")
)]
pub(crate) fn folders(folder: &Path, scenes: &[Source]) -> Result<Vec<PathBuf>> {
    if scenes.len() == 1 {
        return Ok(vec![folder.into()]);
    }
    let folders: Vec<PathBuf> = scenes
        .iter()
        .map(|scene| match scene {
            Source::Made(scene) => folder.join(scene.name()),
            Source::File(file) => folder.join(file.file_name().unwrap_or(file.as_os_str())),
        })
        .collect();
    for (index, one) in folders.iter().enumerate() {
        if folders[..index].contains(one) {
            return Err(Error::OutputRefused {
                path: one.clone(),
                reason: "is the folder of two scenes".into(),
                help: "give each scene once; for files with the same name, run the command once for each, with different folders".into(),
            });
        }
    }
    Ok(folders)
}

/// Writes the files into the existing `folder`.
///
/// # Errors
///
/// [`Error::Output`] for a file that cannot be written, [`Error::OutputRefused`] for one that the
/// scene was read from or that is another output, and the errors of [`whole_image`].
pub fn export(
    folder: &Path,
    name: &str,
    scene: &Scene,
    sets: &RaySets,
    tracer: &CpuTracer,
    rung: Rung,
) -> Result<()> {
    // All of them are checked before any is written.
    let outputs = outputs(folder)?;
    let all: Vec<&Output> = outputs.iter().collect();
    refuse_clashes(&all)?;
    refuse_inputs(&all, &scene.sources)?;
    let put = |file: &str, bytes: &[u8]| {
        let path = folder.join(file);
        match outputs.iter().find(|output| output.path() == path) {
            Some(output) => output.write(bytes),
            None => Output::new(&path)?.write(bytes),
        }
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
