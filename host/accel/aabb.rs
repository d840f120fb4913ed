//! Axis-aligned boxes, as the tree's builder uses them.

use glam::{DVec3, Vec3, Vec4};
use spherule_kernel::Sphere;
use spherule_kernel::shape::Shape;

/// An axis-aligned box. The fourth coordinates are not used.
#[derive(Clone, Copy)]
pub(super) struct Aabb {
    pub(super) low: Vec4,
    pub(super) high: Vec4,
}

impl Aabb {
    pub(super) const EMPTY: Self = Self {
        low: Vec4::splat(f32::MAX),
        high: Vec4::splat(f32::MIN),
    };

    /// The box around a sphere at rest, rounded outwards.
    pub(super) fn of(sphere: &Sphere) -> Self {
        let (center, radius) = (sphere.center(), sphere.radius().abs());
        let low = (center - radius).to_array().map(f32::next_down);
        let high = (center + radius).to_array().map(f32::next_up);
        Self {
            low: Vec3::from_array(low).extend(0.0),
            high: Vec3::from_array(high).extend(0.0),
        }
    }

    /// The box around every position of a moving sphere while the shutter is open, rounded
    /// outwards.
    pub(super) fn of_moving(sphere: &Sphere, velocity: Vec3, shutter: (f32, f32)) -> Self {
        let radius = DVec3::splat(f64::from(sphere.radius().abs()));
        let at = |time: f32| sphere.center().as_dvec3() + velocity.as_dvec3() * f64::from(time);
        let (first, last) = (at(shutter.0), at(shutter.1));
        // The kernel moves a sphere in 32 bits, which rounds its centre twice.
        let size = sphere.center().as_dvec3().abs() + first.abs().max(last.abs());
        let low = first.min(last) - radius - size * 4e-7;
        let high = first.max(last) + radius + size * 4e-7;
        Self::outwards(low, high)
    }

    /// The box around every position of a shape while the shutter is open, rounded outwards.
    pub(super) fn of_shape(shape: &Shape, velocity: Vec3, shutter: (f32, f32)) -> Self {
        let (low, high) = shape.bounds();
        if velocity == Vec3::ZERO {
            return Self {
                low: low.extend(0.0),
                high: high.extend(0.0),
            };
        }
        let at =
            |corner: Vec3, time: f32| corner.as_dvec3() + velocity.as_dvec3() * f64::from(time);
        let (first, last) = (
            (at(low, shutter.0), at(high, shutter.0)),
            (at(low, shutter.1), at(high, shutter.1)),
        );
        // As for a sphere.
        let size = low.abs().max(high.abs()).as_dvec3()
            + first
                .0
                .abs()
                .max(first.1.abs())
                .max(last.0.abs())
                .max(last.1.abs());
        let low = first.0.min(last.0) - size * 4e-7;
        let high = first.1.max(last.1) + size * 4e-7;
        Self::outwards(low, high)
    }

    /// The box between two corners, rounded outwards.
    fn outwards(low: DVec3, high: DVec3) -> Self {
        Self {
            low: Vec3::from_array(low.to_array().map(|x| (x as f32).next_down())).extend(0.0),
            high: Vec3::from_array(high.to_array().map(|x| (x as f32).next_up())).extend(0.0),
        }
    }

    pub(super) fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    pub(super) fn of_all(items: &[Item]) -> Self {
        items
            .iter()
            .fold(Self::EMPTY, |bounds, item| bounds.with(item.bounds()))
    }

    /// The box around twice the middles of the items.
    pub(super) fn of_middles(items: &[Item]) -> Self {
        items
            .iter()
            .fold(Self::EMPTY, |bounds, item| bounds.with_point(item.middle()))
    }

    pub(super) fn with_point(self, point: Vec4) -> Self {
        Self {
            low: self.low.min(point),
            high: self.high.max(point),
        }
    }

    /// Half of the surface area; 0 for an empty box.
    pub(super) fn area(self) -> f32 {
        let side = (self.high - self.low).max(Vec4::ZERO);
        side.x * (side.y + side.z) + side.y * side.z
    }
}

/// A sphere's box. The bits of `low`'s fourth coordinate hold the sphere's index.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub(super) low: Vec4,
    pub(super) high: Vec4,
}

impl Item {
    pub(super) const NONE: Self = Self {
        low: Vec4::ZERO,
        high: Vec4::ZERO,
    };

    pub(super) fn new(index: u32, bounds: Aabb) -> Self {
        Self {
            low: bounds.low.truncate().extend(f32::from_bits(index)),
            high: bounds.high,
        }
    }

    pub(super) fn index(&self) -> u32 {
        self.low.w.to_bits()
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb {
            low: self.low,
            high: self.high,
        }
    }

    /// Twice the middle of the box.
    pub(super) fn middle(&self) -> Vec4 {
        self.low + self.high
    }
}
