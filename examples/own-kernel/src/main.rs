//! Measures the van der Waals volume of a molecule by counting grid points.

use own_kernel::{grid_around, rooms_on_cpu, rooms_on_gpu};
use spherule::{DeviceChoice, Error, Gpu, Scene};

fn main() -> spherule::Result<()> {
    let file = std::env::args()
        .nth(1)
        .unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/1crn.pdb").into());
    let spheres = Scene::load(file)?.world.spheres;
    let grid = grid_around(&spheres, 64);
    let (device, rooms) = match Gpu::open(&DeviceChoice::Gpu) {
        Ok(gpu) => (gpu.name().to_owned(), rooms_on_gpu(&gpu, &grid, &spheres)?),
        Err(Error::NoAdapter { .. }) => ("the CPU".into(), rooms_on_cpu(&grid, &spheres)),
        Err(error) => return Err(error),
    };
    let occupied = rooms.iter().filter(|room| room.inside > 0).count();
    let volume = occupied as f64 * f64::from(grid.spacing).powi(3);
    println!(
        "{} spheres fill {volume:.0} cubic scene units: {occupied} of {} grid points, counted on {device}",
        spheres.len(),
        rooms.len(),
    );
    Ok(())
}
