//! [`Drawn`]: the random numbers of vertices, computed side by side.
//!
//! The loops go over all lanes without a branch: the compiler makes vector instructions of them.

use fearless_simd::{Level, dispatch};
use glam::Vec2;
use spherule_kernel::path::random::{Numbers, VertexNumbers};
use spherule_kernel::path::sampling::Pair;

use crate::lanes::LANES;

type Lanes = [f32; LANES];

/// The random numbers of sixteen vertices that most of them ask for.
pub(super) struct Drawn {
    vertices: [VertexNumbers; LANES],
    direction: Pairs,
    towards_light: Pairs,
    roulette: Lanes,
}

/// [`Pair`]s side by side.
struct Pairs {
    u: [Lanes; 2],
    turn: [Lanes; 2],
}

impl Drawn {
    /// The numbers of these vertices.
    pub(super) fn of(level: Level, vertices: &[VertexNumbers; LANES]) -> Self {
        dispatch!(level, _simd => Self::each(vertices))
    }

    #[inline(always)]
    fn each(vertices: &[VertexNumbers; LANES]) -> Self {
        let mut drawn = Self {
            vertices: *vertices,
            direction: Pairs::ZERO,
            towards_light: Pairs::ZERO,
            roulette: [0.0; LANES],
        };
        // One loop for each: all together would take more registers than there are.
        for (lane, numbers) in vertices.iter().enumerate() {
            drawn.direction.put(lane, numbers.direction());
        }
        for (lane, numbers) in vertices.iter().enumerate() {
            drawn.towards_light.put(lane, numbers.towards_light());
        }
        for (lane, numbers) in vertices.iter().enumerate() {
            drawn.roulette[lane] = numbers.roulette();
        }
        drawn
    }

    /// Those of one vertex.
    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> DrawnAt<'_> {
        DrawnAt { drawn: self, lane }
    }
}

impl Pairs {
    const ZERO: Self = Self {
        u: [[0.0; LANES]; 2],
        turn: [[0.0; LANES]; 2],
    };

    #[inline(always)]
    fn put(&mut self, lane: usize, pair: Pair) {
        self.u[0][lane] = pair.u.x;
        self.u[1][lane] = pair.u.y;
        self.turn[0][lane] = pair.turn.x;
        self.turn[1][lane] = pair.turn.y;
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Pair {
        Pair {
            u: Vec2::new(self.u[0][lane], self.u[1][lane]),
            turn: Vec2::new(self.turn[0][lane], self.turn[1][lane]),
        }
    }
}

/// The random numbers of one vertex among sixteen.
pub(super) struct DrawnAt<'a> {
    drawn: &'a Drawn,
    lane: usize,
}

impl Numbers for DrawnAt<'_> {
    #[inline(always)]
    fn direction(&self) -> Pair {
        self.drawn.direction.at(self.lane)
    }

    #[inline(always)]
    fn towards_light(&self) -> Pair {
        self.drawn.towards_light.at(self.lane)
    }

    #[inline(always)]
    fn roulette(&self) -> f32 {
        self.drawn.roulette[self.lane]
    }

    #[inline(always)]
    fn others(&self) -> &VertexNumbers {
        &self.drawn.vertices[self.lane]
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use spherule_kernel::path::random::Sampler;

    use super::*;
    use crate::cpu::InstructionSet;

    /// Side by side they are what each vertex computes for itself, bit for bit, with each
    /// instruction set.
    #[test]
    fn numbers_side_by_side_are_those_of_each_vertex() {
        let vertices: [VertexNumbers; LANES] = std::array::from_fn(|lane| {
            let lane = lane as u32;
            Sampler::new(7, UVec2::new(3 * lane, 5), 11 + lane).at_vertex(lane % 5)
        });
        for level in InstructionSet::ALL
            .into_iter()
            .filter_map(InstructionSet::level)
        {
            let drawn = Drawn::of(level, &vertices);
            for (lane, alone) in vertices.iter().enumerate() {
                let found = drawn.at(lane);
                assert_eq!(found.direction(), alone.direction(), "{level:?}");
                assert_eq!(found.towards_light(), alone.towards_light());
                assert_eq!(found.roulette().to_bits(), alone.roulette().to_bits());
            }
        }
    }
}
