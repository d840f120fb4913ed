//! The tables of shapes beside spheres: `[[capsule]]`, `[[cylinder]]`, `[[cone]]`, `[[ellipsoid]]`,
//! `[[box]]`, `[[disc]]`.

use glam::{Quat, Vec3};
use serde::Deserialize;
use spherule_kernel::shape::{Capsule, Cone, Cuboid, Cylinder, Disc, Ellipsoid, Shape};
use toml::Spanned;

use super::reader::Reader;
use super::sphere::Known;
use super::value::Value;
use crate::error::Result;
use crate::scene::limits::Range;
use crate::scene::{World, limits, shapes};

/// A table of a shape, whatever its own keys are.
pub(super) trait ShapeTable {
    /// What the table says.
    fn read(&self, reader: &Reader<'_>) -> Result<Shape>;

    /// What every table may say.
    fn common(&self) -> Common<'_>;
}

/// The keys that the tables of all shapes have.
pub(super) struct Common<'a> {
    /// The key whose value is pointed at where the shape reaches too far.
    place: &'a Spanned<Value>,
    material: Option<&'a Spanned<Value>>,
    velocity: Option<&'a Spanned<Value>>,
}

/// Declares a table, and what is made of its keys.
macro_rules! table {
    ($name:ident { $($key:ident),* $(; $($optional:ident),*)? } at $place:ident, $read:expr) => {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields, expecting = "a table")]
        pub(super) struct $name {
            $($key: Spanned<Value>,)*
            $($($optional: Option<Spanned<Value>>,)*)?
            material: Option<Spanned<Value>>,
            velocity: Option<Spanned<Value>>,
        }

        impl ShapeTable for $name {
            fn read(&self, reader: &Reader<'_>) -> Result<Shape> {
                let read: fn(&Self, &Reader<'_>) -> Result<Shape> = $read;
                read(self, reader)
            }

            fn common(&self) -> Common<'_> {
                Common {
                    place: &self.$place,
                    material: self.material.as_ref(),
                    velocity: self.velocity.as_ref(),
                }
            }
        }
    };
}

table!(CapsuleTable { start, end, radius } at end, |table, reader| {
    Ok(Capsule::new(
        reader.point("start", &table.start)?,
        reader.point("end", &table.end)?,
        reader.number("radius", &table.radius, limits::RADIUS)?,
    )
    .into())
});

table!(CylinderTable { start, end, radius } at end, |table, reader| {
    let (start, end) = reader.segment(&table.start, &table.end)?;
    let radius = reader.number("radius", &table.radius, limits::RADIUS)?;
    Ok(Cylinder::new(start, end, radius).into())
});

table!(ConeTable { start, end, start_radius, end_radius } at end, |table, reader| {
    let (start, end) = reader.segment(&table.start, &table.end)?;
    let from = reader.number("start_radius", &table.start_radius, limits::LIGHT_RADIUS)?;
    let to = reader.number("end_radius", &table.end_radius, limits::LIGHT_RADIUS)?;
    if from.max(to) < limits::RADIUS.low {
        return Err(reader
            .wrong(
                &table.end_radius,
                "this cone has no radius",
                "both are zero",
                "give start_radius or end_radius a number above zero",
            )
            .into());
    }
    Ok(Cone::new(start, end, from, to).into())
});

table!(EllipsoidTable { center, half_axes; rotation } at center, |table, reader| {
    let center = reader.point("center", &table.center)?;
    let half_axes = reader.half_axes(&table.half_axes)?;
    let rotation = reader.rotation(table.rotation.as_ref())?;
    Ok(Ellipsoid::new(center, half_axes, rotation).into())
});

table!(BoxTable { center, half_axes; rotation } at center, |table, reader| {
    let center = reader.point("center", &table.center)?;
    let half_axes = reader.half_axes(&table.half_axes)?;
    let rotation = reader.rotation(table.rotation.as_ref())?;
    Ok(Cuboid::new(center, half_axes, rotation).into())
});

table!(DiscTable { center, normal, radius } at center, |table, reader| {
    let normal = reader.vector("normal", &table.normal)?;
    // Its square is a float that is not zero.
    let Some(normal) = normal.as_dvec3().try_normalize() else {
        return Err(reader
            .wrong(
                &table.normal,
                "this disc has no normal",
                "of length zero",
                "give the direction across the disc, of any length: normal = [0, 1, 0]",
            )
            .into());
    };
    Ok(Disc::new(
        reader.point("center", &table.center)?,
        normal.as_vec3(),
        reader.number("radius", &table.radius, limits::RADIUS)?,
    )
    .into())
});

impl Reader<'_> {
    /// Adds the shape of a table to `world`. `grey` is the material of those without one, once it
    /// exists.
    pub(super) fn shape(
        &self,
        table: &Spanned<impl ShapeTable>,
        known: &Known<'_>,
        world: &mut World,
        grey: &mut Option<u32>,
    ) -> Result<()> {
        let table = table.get_ref();
        let shape = table.read(self)?;
        let Common {
            place,
            material,
            velocity,
        } = table.common();
        let material = self.material_of_shape(material, known, shape.name())?;
        let velocity = match velocity {
            Some(velocity) => self.vector("velocity", velocity)?,
            None => Vec3::ZERO,
        };
        self.reaches(place, &shape, velocity, known.shutter)?;
        let id = material.unwrap_or_else(|| Known::grey(world, grey));
        world.add_moving_shape(shape, id, velocity);
        Ok(())
    }

    /// The material of a shape, which may not be hollow; `None` for grey.
    fn material_of_shape(
        &self,
        value: Option<&Spanned<Value>>,
        known: &Known<'_>,
        what: &str,
    ) -> Result<Option<u32>> {
        let Some(value) = value else {
            return Ok(None);
        };
        let (id, hollow) = self.named_material(value, known)?;
        if hollow.is_some() {
            return Err(self
                .wrong(
                    value,
                    format!("this {what} is of hollow glass"),
                    "has a thickness",
                    "give it a material without thickness: only spheres may be hollow",
                )
                .into());
        }
        Ok(Some(id))
    }

    /// Fails for a shape that reaches, or moves, too far.
    fn reaches(
        &self,
        place: &Spanned<Value>,
        shape: &Shape,
        velocity: Vec3,
        shutter: (f32, f32),
    ) -> Result<()> {
        if shapes::is_within(shape, velocity, shutter) {
            return Ok(());
        }
        Err(self.too_far(place, shape.name(), velocity).into())
    }

    /// Two points that are not the same.
    fn segment(&self, start: &Spanned<Value>, end: &Spanned<Value>) -> Result<(Vec3, Vec3)> {
        let (from, to) = (self.point("start", start)?, self.point("end", end)?);
        if from == to {
            return Err(self
                .wrong(
                    end,
                    "this shape has no length",
                    "the same point as start",
                    "move start and end apart, or use a [[sphere]] or a [[disc]]",
                )
                .into());
        }
        Ok((from, to))
    }

    /// Three lengths.
    fn half_axes(&self, value: &Spanned<Value>) -> Result<Vec3> {
        let lengths = self.vector("half_axes", value)?;
        // No more than a hundred million times as long as thick: ratios of squares are floats.
        let Range { low, high } = limits::RADIUS;
        let low = low.max(lengths.max_element() * 1e-8);
        if lengths.cmpge(Vec3::splat(low)).all() && lengths.cmple(Vec3::splat(high)).all() {
            return Ok(lengths);
        }
        Err(self
            .wrong(
                value,
                "half_axes are three lengths above zero, the longest at most 1e8 times the shortest",
                "out of range",
                "give half of the length along each axis: half_axes = [2, 1, 1]",
            )
            .into())
    }

    /// A rotation, none if there is no value.
    fn rotation(&self, value: Option<&Spanned<Value>>) -> Result<Quat> {
        let Some(value) = value else {
            return Ok(Quat::IDENTITY);
        };
        let found = match value.get_ref() {
            Value::List(numbers, None) => <[f64; 4]>::try_from(&numbers[..]).ok(),
            _ => None,
        };
        let length = found.map(|numbers| numbers.iter().map(|x| x * x).sum::<f64>().sqrt());
        match (found, length) {
            (Some(numbers), Some(length)) if length.is_finite() && length > 0.0 => {
                Ok(Quat::from_array(numbers.map(|x| (x / length) as f32)))
            }
            _ => Err(self
                .wrong(
                    value,
                    "rotation is a quaternion, four numbers that are not all zero",
                    "not a quaternion",
                    "give [x, y, z, w]: for the angle α about the unit vector v, v sin(α/2) and cos(α/2)",
                )
                .into()),
        }
    }
}
