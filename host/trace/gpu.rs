//! [`GpuTracer`]: rays on a GPU.

use std::time::Duration;

use spherule_kernel::accel::node::Node;
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use crate::accel::{self, Acceleration};
use crate::device::{Access, Buffer, Deferring, Gpu, rung};
use crate::error::Result;

/// The fewest spheres for which a tree pays, for single rays on a GPU.
const MIN_SPHERES: usize = 16;

/// Spheres on a GPU, and the tree over them if one pays.
#[derive(Debug)]
pub struct GpuTracer<'a> {
    gpu: &'a Gpu,
    spheres: Buffer<Sphere>,
    /// `None` without a tree.
    nodes: Option<Buffer<Node>>,
    /// For each sphere in the order of the leaves, its index in the input; empty without a tree.
    order: Vec<u32>,
}

/// Rays on a GPU, and buffers for their results.
#[derive(Debug)]
pub struct Batch {
    rays: Buffer<Ray>,
    hits: Buffer<Hit>,
    occluded: Buffer<u32>,
    /// The rays that a first launch leaves to a second.
    deferred: Buffer<u32>,
}

impl<'a> GpuTracer<'a> {
    /// Builds the tree and uploads it.
    ///
    /// # Errors
    ///
    /// The device's errors, here and in the other functions.
    pub fn new(gpu: &'a Gpu, spheres: &[Sphere], acceleration: Acceleration) -> Result<Self> {
        Ok(
            match accel::build_still(spheres, acceleration.min_spheres(MIN_SPHERES)) {
                Some(tree) => Self {
                    gpu,
                    spheres: gpu.upload("spheres", &tree.sort(spheres))?,
                    nodes: Some(gpu.upload("nodes", &tree.nodes)?),
                    order: tree.order,
                },
                None => Self {
                    gpu,
                    spheres: gpu.upload("spheres", spheres)?,
                    nodes: None,
                    order: Vec::new(),
                },
            },
        )
    }

    /// The memory that spheres and nodes take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let nodes = self.nodes.as_ref().map_or(0, Buffer::len);
        self.spheres.len() * size_of::<Sphere>() + nodes * size_of::<Node>()
    }

    /// Uploads rays.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn upload(&self, rays: &[Ray]) -> Result<Batch> {
        Ok(Batch {
            rays: self.gpu.upload("rays", rays)?,
            hits: self.gpu.zeroed("hits", rays.len())?,
            occluded: self.gpu.zeroed("occluded", rays.len())?,
            deferred: Deferring::list(self.gpu, rays.len())?,
        })
    }

    /// Finds the nearest hit of each ray. Returns the time on the device, or on the host if the
    /// device cannot measure it.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn nearest(&self, rung: Rung, batch: &Batch) -> Result<Duration> {
        let names = ["trace_rays", "trace_rays_in_tree"];
        self.launch(rung, names, batch, batch.hits.binding())
    }

    /// Finds whether each ray hits anything. Returns the time as [`GpuTracer::nearest`] does.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn occluded(&self, rung: Rung, batch: &Batch) -> Result<Duration> {
        let names = ["occlude_rays", "occlude_rays_in_tree"];
        self.launch(rung, names, batch, batch.occluded.binding())
    }

    /// The hits that [`GpuTracer::nearest`] found, with the spheres' indices in the input.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn hits(&self, batch: &Batch) -> Result<Vec<Hit>> {
        let mut hits = self.gpu.read(&batch.hits)?;
        if !self.order.is_empty() {
            for hit in hits.iter_mut().filter(|hit| hit.is_some()) {
                // A batch of another tracer may name spheres that are not here.
                let sphere = self.order.get(hit.sphere as usize).copied();
                hit.sphere = sphere.unwrap_or(Hit::NONE_SPHERE);
            }
        }
        Ok(hits)
    }

    /// What [`GpuTracer::occluded`] found: 1 or 0 for each ray.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn occlusions(&self, batch: &Batch) -> Result<Vec<u32>> {
        self.gpu.read(&batch.occluded)
    }

    fn launch(
        &self,
        rung: Rung,
        [brute_force, in_tree]: [&str; 2],
        batch: &Batch,
        output: crate::device::Binding<'_>,
    ) -> Result<Duration> {
        let (rays, spheres) = (batch.rays.binding(), self.spheres.binding());
        let (read, write) = (Access::Read, Access::ReadWrite);
        let threads = [batch.rays.len() as u32, 1, 1];
        let time = if let Some(nodes) = &self.nodes {
            let access = [read, read, read, write];
            let kernel = Deferring::compile(self.gpu, rung, in_tree, &access, Ok)?;
            let [groups, ..] = kernel.workgroups_for(threads);
            let bindings = vec![rays, spheres, nodes.binding(), output];
            let groups = self.gpu.rows_of(groups);
            kernel.launch(self.gpu, bindings, &batch.deferred, groups)?
        } else {
            let module = rung::module(self.gpu, rung)?;
            let kernel = self
                .gpu
                .kernel(&module, brute_force, &[read, read, write])?;
            let [groups, ..] = kernel.workgroups_for(threads);
            let bindings = [rays, spheres, output];
            self.gpu
                .launch(&kernel, &bindings, self.gpu.rows_of(groups))?
        };
        Ok(time.best())
    }
}
