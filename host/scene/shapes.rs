//! What the shapes beside the spheres of a scene may be, and what is not computed for them.

use glam::{DVec3, Vec3};
use spherule_kernel::shape::{Kinds, Shape};
use spherule_kernel::{Material, Rung};

use super::{Scene, World, limits};
use crate::error::{Error, Result};
use crate::plural::count_of;

/// Rungs that shapes beside spheres are intersected on.
pub const RUNGS_OF_SHAPES: [Rung; 3] = [Rung::Textbook, Rung::Robust, Rung::Double];

impl Scene {
    /// Whether everything in the scene can be intersected on this rung: `compensated` and
    /// `certified` are for spheres alone.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] says which shapes the rung is not for.
    pub fn require_rung(&self, rung: Rung) -> Result<()> {
        let Some(shape) = self.world.shapes.first() else {
            return Ok(());
        };
        if RUNGS_OF_SHAPES.contains(&rung) {
            return Ok(());
        }
        let others = self.world.shapes.len() - 1;
        let more = match others {
            0 => String::new(),
            _ => format!(" and {} more", count_of(others, "shape")),
        };
        Err(Error::of_scene(
            format!(
                "the precision {} is for spheres alone, and the scene has a {}{more}",
                rung.name(),
                shape.name()
            ),
            "use --precision double: its answers for other shapes are those of 64-bit floats, rounded once",
        ))
    }
}

#[cfg(feature = "lab")]
impl Scene {
    /// Whether the scene has spheres alone, for `what`, which measures nothing else.
    pub(crate) fn require_spheres_alone(&self, what: &str) -> Result<()> {
        match self.world.shapes.first() {
            None => Ok(()),
            Some(shape) => Err(Error::of_scene(
                format!(
                    "{what} measures spheres alone, and the scene has a {}",
                    shape.name()
                ),
                "leave the other shapes out of the scene; `render --stats -` says what it takes with them",
            )),
        }
    }
}

/// Whether the shapes can be rendered, as [`Scene::validate`] has it.
pub(super) fn validate_shapes(world: &World, shutter: (f32, f32)) -> Result<()> {
    let count = world.shapes.len();
    if count > limits::MAX_SPHERES {
        return Err(Error::of_scene(
            format!("the world has {count} shapes beside its spheres"),
            format!("{} are the most", limits::MAX_SPHERES),
        ));
    }
    if world.shape_material_ids.len() != count {
        return Err(Error::of_scene(
            format!(
                "the world has {count} shapes beside its spheres and {} material indices for them",
                world.shape_material_ids.len()
            ),
            "give each shape the index of its material; World::add_shape keeps the two in step",
        ));
    }
    let moving = world.shape_velocities.len();
    if moving != 0 && moving != count {
        return Err(Error::of_scene(
            format!(
                "the world has {count} shapes beside its spheres and {moving} velocities for them"
            ),
            "give each shape a velocity, or none any; World::add_moving_shape keeps the two in step",
        ));
    }
    for (index, (shape, id)) in world
        .shapes
        .iter()
        .zip(&world.shape_material_ids)
        .enumerate()
    {
        if *id as usize >= world.materials.len() {
            return Err(Error::of_scene(
                format!(
                    "shape {index} has the material {id}, and the world has {} materials",
                    world.materials.len()
                ),
                "add the material first; World::add_material returns its index",
            ));
        }
        if !shape.is_valid() {
            return Err(Error::of_scene(
                format!(
                    "shape {index}, a {}, has a number that is not possible",
                    shape.name()
                ),
                "give finite coordinates, and lengths above zero",
            ));
        }
        let velocity = world
            .shape_velocities
            .get(index)
            .copied()
            .unwrap_or_default();
        if !is_within(shape, velocity, shutter) {
            return Err(Error::of_scene(
                format!(
                    "shape {index}, a {}, reaches beyond {:e}",
                    shape.name(),
                    limits::MAX_LENGTH
                ),
                "make it smaller, or move it towards the origin",
            ));
        }
    }
    Ok(())
}

/// [`limits::is_within`] for a shape.
pub(crate) fn is_within(shape: &Shape, velocity: Vec3, (open, close): (f32, f32)) -> bool {
    let (low, high) = shape.bounds();
    let reach = |time: f32| {
        let by = velocity.as_dvec3() * f64::from(time);
        let far = (low.as_dvec3() + by)
            .abs()
            .max((high.as_dvec3() + by).abs());
        // A NaN is beyond, too.
        far.cmple(DVec3::splat(limits::MAX_LENGTH.into())).all()
    };
    reach(0.0) && (velocity == Vec3::ZERO || reach(open) && reach(close))
}

/// Whether glass that is no sphere stands alone: where it overlaps other glass or holds the eye, it
/// is not computed. Boxes are asked, which overlap where shapes need not.
pub(super) fn validate_glass(scene: &Scene) -> Result<()> {
    let world = &scene.world;
    let is_glass: Vec<bool> = world.materials.iter().map(Material::is_glass).collect();
    let is_glass = |id: &u32| is_glass.get(*id as usize) == Some(&true);
    let of_shapes = world.shapes.iter().zip(&world.shape_material_ids);
    let mut boxes: Vec<Bounds> = of_shapes
        .filter(|(_, id)| is_glass(id))
        .map(|(shape, _)| Bounds::of(shape.bounds(), Some(shape.name())))
        .collect();
    if boxes.is_empty() {
        return Ok(());
    }
    let mut discs = world.shapes.iter().zip(&world.shape_material_ids);
    let is_open = |shape: &Shape| shape.kinds() == Kinds::DISC;
    if let Some(index) = discs.position(|(shape, id)| is_open(shape) && is_glass(id)) {
        return Err(Error::of_scene(
            format!("shape {index} is a disc of glass"),
            "give it another material, or use a thin [[cylinder]]: a disc has no inside",
        ));
    }
    let eye = scene.view_or_framed().eye;
    if let Some((shape, _)) = world
        .shapes
        .iter()
        .zip(&world.shape_material_ids)
        .find(|(shape, id)| is_glass(id) && shape.contains(eye))
    {
        return Err(Error::of_scene(
            format!("the eye is in a {} of glass", shape.name()),
            "move the eye out of it: only glass spheres may hold the eye",
        ));
    }
    let spheres = world.spheres.iter().zip(&world.material_ids);
    boxes.extend(spheres.filter(|(_, id)| is_glass(id)).map(|(sphere, _)| {
        let (center, radius) = (sphere.center(), sphere.radius().abs());
        Bounds::of((center - radius, center + radius), None)
    }));
    boxes.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    for (index, one) in boxes.iter().enumerate() {
        let after = boxes[index + 1..].iter();
        for other in after.take_while(|other| other.low.x < one.high.x) {
            if let Some(name) = one.name.or(other.name)
                && one.overlaps(other)
            {
                return Err(Error::of_scene(
                    format!("a {name} of glass is so near to other glass that they may overlap"),
                    "move them apart until boxes around them do not overlap: only glass spheres may be nested",
                ));
            }
        }
    }
    Ok(())
}

/// A box around glass, and the name of what is in it unless that is a sphere.
struct Bounds {
    low: Vec3,
    high: Vec3,
    name: Option<&'static str>,
}

impl Bounds {
    fn of((low, high): (Vec3, Vec3), name: Option<&'static str>) -> Self {
        Self { low, high, name }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_kernel::Sphere;
    use spherule_kernel::shape::{Capsule, Disc};

    fn scene() -> Scene {
        let mut world = World::default();
        let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
        world.add_material(Material::glass(1.5, Vec3::ZERO));
        world.add(Sphere::new(Vec3::ZERO, 1.0), grey);
        world.add_shape(Capsule::new(Vec3::ZERO, Vec3::X * 4.0, 0.5), grey);
        Scene::new(world)
    }

    #[test]
    fn only_some_rungs_are_for_shapes() {
        for rung in Rung::ALL {
            let is_for_shapes = scene().require_rung(rung).is_ok();
            assert_eq!(is_for_shapes, RUNGS_OF_SHAPES.contains(&rung), "{rung:?}");
            let mut spheres = scene();
            spheres.world.shapes.clear();
            assert!(spheres.require_rung(rung).is_ok());
        }
        let error = scene()
            .require_rung(Rung::Certified)
            .expect_err("a capsule");
        assert!(error.to_string().contains("a capsule"), "{error}");
        #[cfg(feature = "lab")]
        assert!(scene().require_spheres_alone("bench").is_err());
    }

    /// What is wrong with the shapes of a scene, and a word of the sentence that says so.
    type Mistake = (&'static str, fn(&mut World));

    #[test]
    fn a_scene_is_refused_for_its_shapes() {
        assert!(scene().validate().is_ok());
        let mistakes: &[Mistake] = &[
            ("material indices for them", |w| {
                w.shape_material_ids.clear();
            }),
            ("velocities for them", |w| {
                w.shape_velocities = vec![Vec3::X; 2];
            }),
            ("the material 7", |w| w.shape_material_ids[0] = 7),
            ("not possible", |w| {
                w.shapes[0] = Capsule::new(Vec3::ZERO, Vec3::X, -1.0).into();
            }),
            ("not possible", |w| {
                w.shapes[0] = Capsule::new(Vec3::NAN, Vec3::X, 1.0).into();
            }),
            ("reaches beyond", |w| {
                w.shapes[0] = Capsule::new(Vec3::ZERO, Vec3::X * 1e18, 1e17).into();
            }),
            ("reaches beyond", |w| {
                w.shape_velocities = vec![Vec3::Y * 1e18];
            }),
            ("may overlap", |w| {
                w.material_ids[0] = 1;
                w.shape_material_ids[0] = 1;
            }),
            ("a disc of glass", |w| {
                w.shape_material_ids[0] = 1;
                w.shapes[0] = Disc::new(Vec3::ZERO, Vec3::Y, 1.0).into();
            }),
            ("the eye is in a capsule", |w| {
                w.shape_material_ids[0] = 1;
                w.shapes[0] = Capsule::new(Vec3::ZERO, Vec3::Z * 20.0, 0.5).into();
            }),
        ];
        for (word, make) in mistakes {
            let mut scene = scene();
            scene.lens.shutter = (0.0, 2.0);
            scene.view = Some(super::super::View {
                eye: Vec3::Z * 10.0,
                target: Vec3::ZERO,
                up: Vec3::Y,
                vertical_fov: 40.0,
            });
            make(&mut scene.world);
            let error = scene.validate().expect_err(word).to_string();
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}
