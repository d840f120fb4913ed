//! A small generator of repeatable random numbers, for inputs that anybody can generate again.

use glam::Vec3;

/// PCG-XSH-RR 64/32 (M. E. O'Neill, PCG: A family of simple fast space-efficient statistically
/// good algorithms for random number generation, 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator with a stream of its own for each seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        random.next_u32();
        random
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform in `low..high`; `high` itself only if the sum is rounded to it.
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    /// A point, uniform in the cube from `low` to `high`.
    pub fn vec3(&mut self, low: f32, high: f32) -> Vec3 {
        Vec3::new(
            self.within(low, high),
            self.within(low, high),
            self.within(low, high),
        )
    }

    /// A unit vector, uniform over the sphere: a point of the cube inside the ball, normalised.
    pub fn unit_vec3(&mut self) -> Vec3 {
        loop {
            let v = self.vec3(-1.0, 1.0);
            let squared = v.length_squared();
            if squared > 0.01 && squared <= 1.0 {
                return v / squared.sqrt();
            }
        }
    }

    /// A number whose logarithm is uniform between those of `low` and `high`.
    pub fn log_within(&mut self, low: f32, high: f32) -> f32 {
        self.within(low.ln(), high.ln()).exp()
    }
}
