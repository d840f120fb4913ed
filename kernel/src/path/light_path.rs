//! The state of a light path. Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::caustic::chain::Chain;
use super::media::{Media, Medium};
use super::place::Place;
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::film::Accumulator;
use crate::hit::Hit;
use crate::ray::Ray;

/// The state of a light path.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    pub(super) origin: Vec3,
    /// The index of the sphere that the path leaves, [`Hit::NONE_SPHERE`](crate::Hit::NONE_SPHERE)
    /// if it leaves none.
    pub(super) left: u32,
    pub(super) direction: Vec3,
    /// Where the path meets the sphere that it leaves again: see [`Place::exit`].
    pub(super) exit: f32,
    /// The weight of light that arrives here.
    pub(super) throughput: Vec3,
    /// The light that has arrived so far.
    pub(super) radiance: Vec3,
    /// The light that counts up to a limit only, if there is one.
    pub(super) indirect: Vec3,
    /// What the path is in, if no glass is nested.
    pub(super) medium: Medium,
    /// The glass that the path is in, if glass may be nested.
    pub(super) media: Media,
    /// 1 in glass and in a hollow in glass, if no glass is nested.
    pub(super) is_in_glass: u32,
    /// The density with which the direction was sampled, or zero if no light was sampled.
    pub(super) density: f32,
    /// If there are many lights, the normal where one was sampled last, on the side of the path.
    pub(super) facing: Vec3,
    /// What the path has met since, if the scene calls for caustics.
    pub(super) chain: Chain,
    pub(super) time: f32,
    /// The number of bounces, and 2¹⁶ times that of surfaces of glass that the path has passed
    /// because smaller spheres cover them.
    pub(super) events: u32,
    /// Zero for a path that met nothing but the background.
    pub(super) alpha: f32,
    /// The distance to the first sphere, [`Hit::NONE_T`](crate::Hit::NONE_T) if there was none.
    pub(super) depth: f32,
}

/// The most surfaces of glass that a path passes.
const MOST_PASSES: u32 = 1 << 12;

impl Path {
    /// How often the path has bounced.
    #[inline]
    #[must_use]
    pub fn bounces(&self) -> u32 {
        self.events & 0xffff
    }

    /// Adds light that was scattered so many times between its source and the camera. From the
    /// second scattering on it is indirect: it is what `max_bounces = 0` leaves out.
    #[inline]
    pub fn receive(&mut self, effects: Effects, light: Vec3, scatterings: u32) {
        if effects.any(Effects::CLAMP) && scatterings > 1 {
            self.indirect += light;
        } else {
            self.radiance += light;
        }
    }

    /// All the light of the sample. Indirect light that is limited keeps its hue.
    #[inline]
    pub(super) fn light<T: Traversal>(&self, scenery: &Scenery<'_, T>) -> Vec3 {
        if !scenery.effects.any(Effects::CLAMP) {
            return self.radiance;
        }
        let (limit, brightest) = (scenery.launch.indirect_limit, self.indirect.max_element());
        if brightest > limit {
            self.radiance + self.indirect * (limit / brightest)
        } else {
            self.radiance + self.indirect
        }
    }

    /// Passes a surface of glass as if nothing were there, and returns whether the path may: it has
    /// an end also among degenerate spheres.
    #[inline]
    pub(super) fn passes(&mut self, place: &Place) -> bool {
        let may_pass = self.events < MOST_PASSES << 16;
        if may_pass {
            self.leave(place, self.direction, 0.0);
            self.chain = Chain::LOST;
            self.events += (1 << 16) - 1;
        }
        may_pass
    }

    /// What the path is in.
    #[inline]
    pub(super) fn medium<T: Traversal>(&self, scenery: &Scenery<'_, T>) -> Medium {
        if scenery.effects.any(Effects::NESTED_GLASS) {
            self.media.medium(scenery)
        } else {
            self.medium
        }
    }

    /// The radiance that light of radiance one here has outside of glass, but for what is reflected
    /// and absorbed on the way: 1/n². Radiance over n² stays what it is where light is refracted
    /// (F. E. Nicodemus, Radiance, Am. J. Phys. 31 (1963)), so that clear glass adds no light.
    #[inline]
    pub(super) fn outside_of_glass<T: Traversal>(&self, scenery: &Scenery<'_, T>) -> f32 {
        if scenery.effects.any(Effects::GLASS) {
            let index = self.medium(scenery).index;
            1.0 / (index * index)
        } else {
            1.0
        }
    }

    /// The ray along which the path goes on.
    #[inline]
    #[must_use]
    pub fn ray(&self) -> Ray {
        self.ray_up_to(Hit::NONE_T)
    }

    /// The same up to a distance.
    #[inline]
    pub(super) fn ray_up_to(&self, t_max: f32) -> Ray {
        Ray::within(self.origin, self.direction, f32::MIN_POSITIVE, t_max)
    }

    /// The index of the sphere over which that ray passes, because it leaves it; otherwise
    /// [`Hit::NONE_SPHERE`](crate::Hit::NONE_SPHERE).
    #[inline]
    #[must_use]
    pub fn left(&self) -> u32 {
        self.left
    }

    /// The time at which spheres are met.
    #[inline]
    #[must_use]
    pub fn time(&self) -> f32 {
        self.time
    }

    /// The hit, or the one where the path meets again the sphere that it leaves, if that is nearer:
    /// see `Place::exit`.
    #[inline]
    #[must_use]
    pub fn or_exit(&self, hit: Hit) -> Hit {
        let (exit, left) = (self.exit, self.left);
        let is_nearer = (exit < hit.t) | ((exit == hit.t) & (left < hit.sphere));
        if is_nearer & (exit < Hit::NONE_T) {
            Hit {
                t: exit,
                sphere: left,
            }
        } else {
            hit
        }
    }

    /// The glass on the other side of the surface that the path has met.
    #[inline]
    pub(super) fn media_beyond<T: Traversal>(
        &self,
        scenery: &Scenery<'_, T>,
        place: &Place,
    ) -> Media {
        if place.surface.normal.dot(self.direction) < 0.0 {
            self.media.with(scenery, place.sphere, self.time)
        } else {
            self.media.without(place.sphere)
        }
    }

    /// Whether the path is in glass, or in a hollow in it.
    #[inline]
    pub(super) fn is_in_glass(&self, effects: Effects) -> bool {
        if effects.any(Effects::NESTED_GLASS) {
            !self.media.is_none()
        } else {
            effects.any(Effects::GLASS) && self.is_in_glass == 1
        }
    }

    /// Whether fog, where there is some, is around the path. Glass holds none.
    #[inline]
    pub(super) fn is_in_fog(&self, effects: Effects) -> bool {
        effects.any(Effects::FOG) && !self.is_in_glass(effects)
    }

    /// Counts the path as this sample of its pixel.
    #[inline]
    pub fn end<T: Traversal>(
        &self,
        scenery: &Scenery<'_, T>,
        sample: u32,
        pixel: &mut Accumulator,
    ) {
        let light = self.light(scenery);
        if scenery.launch.is_adaptive == 1 {
            pixel.add_to_group(light, self.alpha, self.depth, sample);
        } else {
            pixel.add(light, self.alpha, self.depth);
        }
    }

    /// Sends the path off in `direction`, a unit vector that was sampled with this density.
    #[inline]
    pub(super) fn leave(&mut self, place: &Place, direction: Vec3, density: f32) {
        self.origin = place.surface.point;
        self.left = place.sphere;
        self.direction = direction;
        self.exit = place.exit(direction);
        self.density = density;
        self.events += 1;
    }
}

/// Russian roulette: ends dark paths by chance, and raises the weight of those that go on.
///
/// A chance of the weight itself is the usual choice; but what it saves in time is less than what
/// it adds in noise. `benches/peers/light/run` has both, scene by scene.
#[inline]
pub(super) fn survives(path: &mut Path, u: f32) -> bool {
    let brightest = path.throughput.max_element();
    if brightest <= 0.0 {
        return false;
    }
    if path.bounces() > 3 {
        let chance = (2.0 * brightest).sqrt().clamp(0.05, 1.0);
        path.throughput *= 1.0 / chance;
        return u < chance;
    }
    true
}
