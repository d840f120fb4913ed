//! Camera rays on the CPU, a square of pixels at once.
//!
//! The rays of a square share their origin. Four planes through the eye and the sides of the square
//! bound them all, so that boxes are tested once for 64 rays; the eight boxes of a node are tested
//! side by side. Four more planes along the square's middle tell which of its quarters a sphere may
//! be seen in. There it is tested against 16 rays side by side by the few operations of
//! [`candidates`](spherule_kernel::cull::discriminant), and only what may be a hit is asked about
//! on its rung: on [`Rung::Robust`], [`Rung::Double`] and [`Rung::Certified`] 16 rays side by side
//! again, with the very operations of the kernel, in their order. On [`Rung::Compensated`] and
//! [`Rung::Certified`] only what [`bounds`](spherule_kernel::cull::bounds) leave open is asked
//! about, and the nearest sphere of each ray at the end.
//!
//! The formulas are the kernel's, over [`Single16`] and [`Double16`]. Loops over the eight boxes of
//! a node become vector instructions; all is compiled for each instruction set, and chosen by the
//! packet's [`InstructionSet`].

use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, mask32x16, u32x16};
use glam::{DVec3, UVec2, UVec4, Vec2, Vec3};
use spherule_kernel::accel::node::{Extent, Node, Tree};
use spherule_kernel::cull::bounds::Aim;
use spherule_kernel::cull::discriminant::Target;
use spherule_kernel::cull::frustum::inward_normal;
use spherule_kernel::lane::{Lane, Lane3};
use spherule_kernel::precision::certified::corrected::Residual;
use spherule_kernel::precision::certified::wide::WideRay;
use spherule_kernel::precision::root::root_within;
use spherule_kernel::precision::{self, double, intersect, robust};
use spherule_kernel::{Camera, Hit, Launch, Ray, Rung, Sphere};

use crate::cpu::InstructionSet;
use crate::lanes::{Double16, LANES, Single16};

/// Pixels of a square's side.
pub const SIDE: usize = 8;
const RAYS: usize = SIDE * SIDE;
const GROUPS: usize = RAYS / LANES;
const WIDTH: usize = Node::WIDTH;
/// The squares of the directions' lengths for which [`bounds`](spherule_kernel::cull::bounds) hold
/// without scaling, which wants 1/|d| to be 1 at most: that of a camera's rays is, but for its
/// rounding.
const SQUARES: std::ops::Range<f32> = 0.999..(1_u64 << 40) as f32;
/// Of so many rays on, a rung is evaluated for 16 rather than one by one.
const WORTH_LANES: u32 = 3;
/// 32u, u = 2⁻²⁴: what a box test may be off by for its terms, twice over.
const SLACK: f32 = 32.0 / (1 << 24) as f32;

/// Values of 16 rays.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Lanes([f32; LANES]);

/// Rays of one origin, and what they have found.
#[derive(Clone, Debug)]
pub struct Packet {
    /// The instructions that they are traced with.
    level: Level,
    origin: Vec3,
    t_min: f32,
    x: [Lanes; GROUPS],
    y: [Lanes; GROUPS],
    z: [Lanes; GROUPS],
    /// The direction's squared length, and one over it.
    a: [Lanes; GROUPS],
    inverse: [Lanes; GROUPS],
    /// The nearest hit so far, or the end of the ray; and its sphere.
    t: [Lanes; GROUPS],
    sphere: [[u32; LANES]; GROUPS],
    /// Where a sphere must certainly be hit before to be nearer; and a bit where the rung was not
    /// asked about the nearest, so that `t` is where it is hit at most.
    low: [Lanes; GROUPS],
    are_unasked: [u32; GROUPS],
    /// Whether directions are of such length that [`bounds`](spherule_kernel::cull::bounds) hold
    /// for them as they are.
    has_bounds: bool,
    /// The largest t of each group.
    end: [f32; GROUPS],
    /// How far a hit of the rung may be from its sphere.
    widening: f32,
    frustum: Frustum,
}

/// What bounds the rays of each square of an image: what a column or a row of squares shares is
/// worked out once.
#[derive(Clone, Debug)]
pub struct Frusta {
    /// Of each column of squares the planes on its left and its right, and between its halves: on
    /// the right of the left one, on the left of the right one.
    columns: Vec<[Plane; 4]>,
    /// Of each row of squares the planes above and below it, below its upper half, and above its
    /// lower half.
    rows: Vec<[Plane; 4]>,
    /// Where the pixels of each column and row of squares are on the film; those beyond the image
    /// are repeated ones.
    across: Vec<[f32; SIDE]>,
    upwards: Vec<[f32; SIDE]>,
    forward: Plane,
}

impl Frusta {
    /// Of the squares of a launch.
    #[must_use]
    pub fn of(launch: &Launch) -> Self {
        let camera = &launch.camera;
        let in_doubles = |v: Vec3| Lane3 {
            x: f64::from(v.x),
            y: f64::from(v.y),
            z: f64::from(v.z),
        };
        let [forward, right, up] = [camera.forward, camera.right, camera.up].map(in_doubles);
        let last = launch.tile_size - UVec2::ONE;
        let film = |x: u32, y: u32| {
            let pixel = launch.tile_origin + UVec2::new(x, y).min(last);
            Camera::film(pixel, launch.image_size)
        };
        // The plane through the rays at `offset` along `across`. Its inside is on the side where
        // offsets are larger, or smaller.
        let plane = |across: Lane3<f64>, axis: Lane3<f64>, offset: f32, is_larger: bool| {
            let side = if is_larger { 1.0 } else { -1.0 };
            let offset = across.scaled(offset.into());
            let normal = inward_normal(forward, offset, axis, across.scaled(side));
            Plane::farthest(DVec3::new(normal.x, normal.y, normal.z).as_vec3())
        };
        let squares = |pixels: u32| (0..pixels).step_by(SIDE);
        let far = SIDE as u32 - 1;
        let middle = SIDE as u32 / 2;
        let column = |x: u32| {
            let at = |x, is_larger| plane(right, up, film(x, 0).x, is_larger);
            [
                at(x, true),
                at(x + far, false),
                at(x + middle - 1, false),
                at(x + middle, true),
            ]
        };
        // Rows are counted from above.
        let row = |y: u32| {
            let at = |y, is_larger| plane(up, right, film(0, y).y, is_larger);
            [
                at(y, false),
                at(y + far, true),
                at(y + middle - 1, true),
                at(y + middle, false),
            ]
        };
        let pixels = |first: u32| std::array::from_fn(|i| first + i as u32);
        let across = |x| pixels(x).map(|x| film(x, 0).x);
        let upwards = |y| pixels(y).map(|y| film(0, y).y);
        Self {
            columns: squares(launch.tile_size.x).map(column).collect(),
            rows: squares(launch.tile_size.y).map(row).collect(),
            across: squares(launch.tile_size.x).map(across).collect(),
            upwards: squares(launch.tile_size.y).map(upwards).collect(),
            forward: Plane::nearest(camera.forward),
        }
    }

    fn at(&self, corner: UVec2) -> Frustum {
        let columns = self.columns[corner.x as usize / SIDE];
        let rows = self.rows[corner.y as usize / SIDE];
        let [left, right, of_left, of_right] = columns;
        let [above, below, of_upper, of_lower] = rows;
        let sides = [left, right, above, below];
        let all = [
            left, right, above, below, of_left, of_right, of_upper, of_lower,
        ];
        Frustum {
            planes: sides,
            forward: self.forward,
            x: all.map(|plane| plane.normal.x),
            y: all.map(|plane| plane.normal.y),
            z: all.map(|plane| plane.normal.z),
        }
    }
}

/// What bounds the rays of a square.
#[derive(Clone, Copy, Debug)]
struct Frustum {
    /// Four planes through the origin, with inward normals, and of each box what is farthest along
    /// them.
    planes: [Plane; 4],
    /// The direction along which the rays' parameters are depths, and of each box what is nearest.
    forward: Plane,
    /// The normals of these planes and of those between the halves: on the right of the left one,
    /// on the left of the right one, below the upper one, above the lower one.
    x: [f32; 8],
    y: [f32; 8],
    z: [f32; 8],
}

impl Frustum {
    /// Without bounds.
    const NONE: Self = Self {
        planes: [Plane::NONE; 4],
        forward: Plane::NONE,
        x: [0.0; 8],
        y: [0.0; 8],
        z: [0.0; 8],
    };

    /// Which quarters of the square a sphere around `o`, told from the eye, may be seen in: a bit
    /// for each group of rays. It is as large as `reach`, what it may be off by counted in.
    #[inline(always)]
    fn quarters(&self, o: Vec3, reach: f32) -> u32 {
        /// By what is beyond the planes between the halves.
        const LEFT: [u32; 16] = {
            let mut left = [0; 16];
            let mut beyond = 0;
            while beyond < 16 {
                let mut group = 0;
                while group < GROUPS {
                    let across = beyond >> (group % 2) & 1;
                    let upwards = beyond >> (2 + group / 2) & 1;
                    if across | upwards == 0 {
                        left[beyond] |= 1 << group;
                    }
                    group += 1;
                }
                beyond += 1;
            }
            left
        };
        let along: [f32; 8] =
            std::array::from_fn(|i| o.x * self.x[i] + o.y * self.y[i] + o.z * self.z[i]);
        let mut beyond = 0;
        for (plane, along) in along.iter().enumerate() {
            beyond |= usize::from(*along < -reach) << plane;
        }
        if beyond & 15 != 0 {
            return 0;
        }
        LEFT[beyond >> 4]
    }
}

/// A direction, and which of a node's rows of sides make the corner of a box that is wanted.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: Vec3,
    rows: [usize; 3],
}

impl Plane {
    const NONE: Self = Self {
        normal: Vec3::ZERO,
        rows: [0, 1, 2],
    };

    fn farthest(normal: Vec3) -> Self {
        let row = |axis: usize| axis + if normal[axis] > 0.0 { 3 } else { 0 };
        Self {
            normal,
            rows: [row(0), row(1), row(2)],
        }
    }

    fn nearest(normal: Vec3) -> Self {
        Self {
            normal,
            ..Self::farthest(-normal)
        }
    }

    /// Where the corners of eight boxes are along the normal, whose sides are told from `corner`.
    #[inline(always)]
    fn along(&self, corner: Vec3, sides: &[[f32; WIDTH]; 6]) -> [f32; WIDTH] {
        let Vec3 { x, y, z } = self.normal;
        let first = corner.dot(self.normal);
        let [in_x, in_y, in_z] = self.rows.map(|row| &sides[row]);
        std::array::from_fn(|child| in_x[child] * x + (in_y[child] * y + (in_z[child] * z + first)))
    }

    /// What [`along`](Plane::along) may be off by, and boxes be wider, if coordinates are off by
    /// this.
    #[inline(always)]
    fn slack(&self, off: f32) -> f32 {
        self.normal.abs().element_sum() * off
    }
}

/// A box on the way, or spheres in one.
#[derive(Clone, Copy)]
struct Entry {
    depth: f32,
    /// A node, or the first of `count` spheres.
    first: u32,
    count: u32,
}

impl Packet {
    /// No rays yet.
    #[must_use]
    pub fn new(instructions: InstructionSet) -> Self {
        let none = [Lanes([0.0; LANES]); GROUPS];
        Self {
            level: instructions.level().unwrap_or(Level::baseline()),
            origin: Vec3::ZERO,
            t_min: 0.0,
            x: none,
            y: none,
            z: none,
            a: none,
            inverse: none,
            t: none,
            sphere: [[Hit::NONE_SPHERE; LANES]; GROUPS],
            low: none,
            are_unasked: [0; GROUPS],
            has_bounds: false,
            end: [0.0; GROUPS],
            widening: 0.0,
            frustum: Frustum::NONE,
        }
    }

    /// Takes the rays of the square whose upper left pixel is `corner`, counted from that of the
    /// tile.
    #[inline(always)]
    fn aim(&mut self, launch: &Launch, frusta: &Frusta, corner: UVec2) {
        self.frustum = frusta.at(corner);
        let camera = &launch.camera;
        let columns = &frusta.across[corner.x as usize / SIDE];
        let rows = &frusta.upwards[corner.y as usize / SIDE];
        let first = camera.ray(Vec2::new(columns[0], rows[0]));
        (self.origin, self.t_min) = (first.origin, first.t_min);
        self.t = [Lanes([first.t_max; LANES]); GROUPS];
        self.sphere = [[Hit::NONE_SPHERE; LANES]; GROUPS];
        self.low = self.t;
        self.are_unasked = [0; GROUPS];
        self.end = [first.t_max; GROUPS];
        self.has_bounds = true;
        let (forward, right, up) = (camera.forward, camera.right, camera.up);
        for group in 0..GROUPS {
            // A group is four by four pixels.
            let (left, top) = (group % 2 * 4, group / 2 * 4);
            let across = lanes(|i| columns[left + i % 4]);
            let upwards = lanes(|i| rows[top + i / 4]);
            // The sums of Camera::ray, in its order.
            let x = lanes(|i| forward.x + right.x * across[i] + up.x * upwards[i]);
            let y = lanes(|i| forward.y + right.y * across[i] + up.y * upwards[i]);
            let z = lanes(|i| forward.z + right.z * across[i] + up.z * upwards[i]);
            let a = lanes(|i| x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
            self.inverse[group] = Lanes(lanes(|i| 1.0 / a[i]));
            (self.x[group], self.y[group], self.z[group]) = (Lanes(x), Lanes(y), Lanes(z));
            self.a[group] = Lanes(a);
            self.has_bounds &= a.iter().all(|a| SQUARES.contains(a));
        }
    }

    /// The ray of a pixel, counted row by row, and what it has found.
    #[must_use]
    pub fn hit(&self, index: usize) -> (Ray, Hit) {
        let (group, lane) = place(index);
        let ray = self.ray(group, lane, Hit::NONE_T);
        let sphere = self.sphere[group][lane];
        let t = if sphere == Hit::NONE_SPHERE {
            Hit::NONE_T
        } else {
            self.t[group].0[lane]
        };
        (ray, Hit { t, sphere })
    }

    /// The largest end of all.
    #[inline(always)]
    fn end(&self) -> f32 {
        self.end.iter().copied().fold(f32::MIN, f32::max)
    }

    /// The directions of a group.
    #[inline(always)]
    fn direction<S: Simd>(&self, simd: S, group: usize) -> Lane3<Single16<S>> {
        Lane3 {
            x: Single16::load(simd, &self.x[group].0),
            y: Single16::load(simd, &self.y[group].0),
            z: Single16::load(simd, &self.z[group].0),
        }
    }

    /// Tests `count` of the spheres from `first` on.
    #[inline(always)]
    fn test<S: Simd, const RUNG: u32>(
        &mut self,
        simd: S,
        spheres: &[Sphere],
        first: u32,
        count: usize,
    ) {
        for (index, sphere) in spheres[first as usize..][..count].iter().enumerate() {
            let o = sphere.center() - self.origin;
            let radius = sphere.radius().abs();
            let target = Target::of(Lane3::of(o), radius);
            let off = (o.abs().element_sum() + radius) * SLACK + self.widening;
            let nearest = o.dot(self.frustum.forward.normal) - radius - off;
            // Of a normal's components the sum is two at most.
            let mut quarters = self.frustum.quarters(o, radius + 2.0 * off);
            while quarters != 0 {
                let group = quarters.trailing_zeros() as usize;
                quarters &= quarters - 1;
                if nearest > self.end[group] {
                    continue;
                }
                let target = Target {
                    o: Single16::splat3(simd, o),
                    c: Single16::splat(simd, target.c),
                    oo: Single16::splat(simd, target.oo),
                    rr: Single16::splat(simd, target.rr),
                };
                let a = Single16::load(simd, &self.a[group].0);
                let may_hit = target.may_hit(self.direction(simd, group), a);
                if may_hit.any_true() {
                    let index = first + index as u32;
                    if RUNG == Rung::Robust.to_u32() {
                        self.test_robust(simd, group, *sphere, index);
                    } else if RUNG == Rung::Double.to_u32() {
                        self.test_double(simd, group, *sphere, index);
                    } else {
                        let mut open = may_hit.to_bitmask() as u32;
                        if precision::is_lazy(RUNG) && self.has_bounds {
                            open = self.test_bounds(simd, group, *sphere, index);
                            self.ask::<S, RUNG>(simd, group, open, spheres);
                        }
                        if RUNG == Rung::Certified.to_u32() && open.count_ones() >= WORTH_LANES {
                            open = self.test_certified(simd, group, *sphere, index, open);
                        }
                        if open != 0 {
                            self.test_each::<RUNG>(group, *sphere, index, open);
                        }
                    }
                }
            }
        }
    }

    /// Takes the sphere where it is the nearest for certain, and tells for which rays the rung is
    /// to be asked, a bit each: [`bounds`](spherule_kernel::cull::bounds) for 16 rays.
    #[inline(always)]
    fn test_bounds<S: Simd>(&mut self, simd: S, group: usize, sphere: Sphere, index: u32) -> u32 {
        let aim = Aim {
            direction: self.direction(simd, group),
            inverse: Single16::load(simd, &self.inverse[group].0),
            start: Single16::splat(simd, self.t_min),
            behind: Single16::splat(simd, if self.t_min >= 0.0 { 0.0 } else { f32::MIN }),
        };
        let o = Single16::splat3(simd, sphere.center() - self.origin);
        let (misses, hits, low, high) = aim.bounds(o, Single16::splat(simd, sphere.radius()));
        let end = Single16::load(simd, &self.t[group].0);
        let nearest = Single16::load(simd, &self.low[group].0);
        let is_nearer = hits & high.simd_lt(nearest);
        let is_closed = misses | (hits & low.simd_gt(end));
        let end = Single16::select(is_nearer, high, end);
        end.store(&mut self.t[group].0);
        Single16::select(is_nearer, low, nearest).store(&mut self.low[group].0);
        self.put_sphere(simd, group, is_nearer, index);
        let is_nearer = is_nearer.to_bitmask() as u32;
        self.are_unasked[group] |= is_nearer;
        self.end[group] = largest(&self.t[group].0);
        (!is_closed).to_bitmask() as u32 & !is_nearer
    }

    /// Notes the sphere for the rays of a mask.
    #[inline(always)]
    fn put_sphere<S: Simd>(&mut self, simd: S, group: usize, rays: mask32x16<S>, index: u32) {
        let sphere = &mut self.sphere[group];
        let before = u32x16::load_array_ref(simd, sphere);
        rays.select(u32x16::splat(simd, index), before)
            .store_array(sphere);
    }

    /// Asks the rung about the nearest spheres of these rays, a bit each, where it was not.
    #[inline(always)]
    fn ask<S: Simd, const RUNG: u32>(
        &mut self,
        simd: S,
        group: usize,
        rays: u32,
        spheres: &[Sphere],
    ) {
        let mut asked = rays & self.are_unasked[group];
        self.are_unasked[group] &= !asked;
        if RUNG == Rung::Certified.to_u32() && asked.count_ones() >= WORTH_LANES {
            asked = self.ask_certified(simd, group, asked, spheres);
        }
        while asked != 0 {
            let lane = asked.trailing_zeros() as usize % LANES;
            asked &= asked - 1;
            let sphere = spheres[self.sphere[group][lane] as usize];
            let t = intersect(RUNG, sphere, &self.ray(group, lane, Hit::NONE_T));
            self.t[group].0[lane] = t;
            self.low[group].0[lane] = t;
        }
    }

    /// Asks the rung about what it was not.
    #[inline(always)]
    fn finish<S: Simd, const RUNG: u32>(&mut self, simd: S, spheres: &[Sphere]) {
        for group in 0..GROUPS {
            self.ask::<S, RUNG>(simd, group, u32::MAX, spheres);
        }
    }

    /// A ray up to `t_max`.
    #[inline(always)]
    fn ray(&self, group: usize, lane: usize, t_max: f32) -> Ray {
        let direction = Vec3::new(
            self.x[group].0[lane],
            self.y[group].0[lane],
            self.z[group].0[lane],
        );
        Ray::within(self.origin, direction, self.t_min, t_max)
    }

    /// Asks the rung about each of these rays, a bit each, whether it meets the sphere.
    #[inline(always)]
    fn test_each<const RUNG: u32>(
        &mut self,
        group: usize,
        sphere: Sphere,
        index: u32,
        mut rays: u32,
    ) {
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            let best = self.t[group].0[lane];
            // As near is of interest, too, if the index is lower.
            let t_max = if best < Hit::NONE_T {
                best.next_up()
            } else {
                best
            };
            let t = intersect(RUNG, sphere, &self.ray(group, lane, t_max));
            if t < t_max && (t < best || index < self.sphere[group][lane]) {
                self.t[group].0[lane] = t;
                self.low[group].0[lane] = t;
                self.sphere[group][lane] = index;
            }
        }
        self.end[group] = largest(&self.t[group].0);
    }

    /// [`robust`] for 16 rays.
    #[inline(always)]
    fn test_robust<S: Simd>(&mut self, simd: S, group: usize, sphere: Sphere, index: u32) {
        let quadratic = robust::Quadratic::of(
            Single16::splat3(simd, self.origin - sphere.center()),
            Single16::splat(simd, sphere.radius()),
            self.direction(simd, group),
            Single16::load(simd, &self.a[group].0),
            Single16::load(simd, &self.inverse[group].0),
        );
        let (meets, inner) = (quadratic.meets(), quadratic.inner());
        // Where all that meet it do so ahead, and first in the interval, the other root is not
        // asked for.
        let is_first = inner.simd_ge(Single16::splat(simd, self.t_min));
        if (meets & !(quadratic.is_ahead() & is_first)).any_true() {
            let (near, far) = quadratic.roots();
            self.take(simd, group, index, meets, near, far);
        } else {
            self.take(simd, group, index, meets, inner, inner);
        }
    }

    /// [`double`] for 16 rays.
    #[inline(always)]
    fn test_double<S: Simd>(&mut self, simd: S, group: usize, sphere: Sphere, index: u32) {
        let quadratic = double::Quadratic::of(
            splat3_wide(simd, self.origin.as_dvec3()),
            self.wide_direction(simd, group),
            splat3_wide(simd, sphere.center().as_dvec3()),
            Double16::splat(simd, sphere.radius().into()),
        );
        let meets = quadratic.meets().narrowed(simd);
        let roots = quadratic.roots();
        let (near, far) = (roots.near.rounded(), roots.far.rounded());
        self.take(simd, group, index, meets, near, far);
    }

    /// [`certified`](precision::certified) for the rays of 16 that are open, a bit each, in 64-bit
    /// floats; returns those for which it is not certain. The rung was asked about their nearest.
    #[inline(always)]
    fn test_certified<S: Simd>(
        &mut self,
        simd: S,
        group: usize,
        sphere: Sphere,
        index: u32,
        open: u32,
    ) -> u32 {
        let answer = self.wide_rays(simd, group).intersect(
            splat3_wide(simd, sphere.center().as_dvec3()),
            Double16::splat(simd, sphere.radius().into()),
        );
        let (is_hit, t) = (answer.is_hit.narrowed(simd), answer.t.rounded());
        let is_open = mask32x16::from_bitmask(simd, open.into());
        self.take(simd, group, index, is_hit & is_open, t, t);
        for lane in 0..LANES {
            if self.are_unasked[group] >> lane & 1 == 0 {
                self.low[group].0[lane] = self.t[group].0[lane];
            }
        }
        open & !answer.is_certain.narrowed(simd).to_bitmask() as u32
    }

    /// [`Packet::ask`] on [`Rung::Certified`] in 64-bit floats: returns the rays for which those
    /// are not certain.
    #[inline(always)]
    fn ask_certified<S: Simd>(
        &mut self,
        simd: S,
        group: usize,
        asked: u32,
        spheres: &[Sphere],
    ) -> u32 {
        let mut columns = [[f32::NAN; LANES]; 4];
        for lane in (0..LANES).filter(|lane| asked >> lane & 1 == 1) {
            let sphere = spheres[self.sphere[group][lane] as usize].to_vec4();
            for (column, number) in columns.iter_mut().zip(sphere.to_array()) {
                column[lane] = number;
            }
        }
        let center = Lane3 {
            x: Double16::widened(Single16::load(simd, &columns[0])),
            y: Double16::widened(Single16::load(simd, &columns[1])),
            z: Double16::widened(Single16::load(simd, &columns[2])),
        };
        let single_radius = Single16::load(simd, &columns[3]);
        let radius = Double16::widened(single_radius);
        let rays = self.wide_rays(simd, group);
        // The bounds are about the root, and their middle is near it.
        let (low, high) = (
            Single16::load(simd, &self.low[group].0),
            Single16::load(simd, &self.t[group].0),
        );
        let guess = (low + high) * Single16::splat(simd, 0.5);
        let Residual { g, h } = rays.residual(center, radius, Double16::widened(guess));
        let (g, h) = (g.rounded(), h.rounded());
        let corrected =
            Residual { g, h }.correct(guess, self.direction(simd, group), single_radius);
        let certain = (corrected.is_certain & corrected.is_near).to_bitmask() as u32 & asked;
        self.put(simd, group, certain, corrected.t);
        let asked = asked & !certain;
        if asked == 0 {
            return 0;
        }
        let answer = rays.intersect(center, radius);
        let certain = asked & answer.is_certain.narrowed(simd).to_bitmask() as u32;
        self.put(simd, group, certain, answer.t.rounded());
        asked & !certain
    }

    /// Puts the answers of a rung for these rays, a bit each.
    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, group: usize, rays: u32, found: Single16<S>) {
        let rays = mask32x16::from_bitmask(simd, rays.into());
        for values in [&mut self.t[group].0, &mut self.low[group].0] {
            Single16::select(rays, found, Single16::load(simd, values)).store(values);
        }
    }

    /// The rays of a group, which have no end, in 64-bit floats.
    #[inline(always)]
    fn wide_rays<S: Simd>(&self, simd: S, group: usize) -> WideRay<Double16<S>> {
        WideRay {
            origin: splat3_wide(simd, self.origin.as_dvec3()),
            direction: self.wide_direction(simd, group),
            t_min: Double16::splat(simd, self.t_min.into()),
            t_max: Double16::splat(simd, Hit::NONE_T.into()),
        }
    }

    #[inline(always)]
    fn wide_direction<S: Simd>(&self, simd: S, group: usize) -> Lane3<Double16<S>> {
        Lane3 {
            x: Double16::widened(Single16::load(simd, &self.x[group].0)),
            y: Double16::widened(Single16::load(simd, &self.y[group].0)),
            z: Double16::widened(Single16::load(simd, &self.z[group].0)),
        }
    }

    /// Takes the smaller of two roots that is in the interval, where the line meets the sphere, and
    /// where it is nearer than what was found, or as near and of lower index.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        simd: S,
        group: usize,
        index: u32,
        meets: mask32x16<S>,
        near: Single16<S>,
        far: Single16<S>,
    ) {
        let t_min = Single16::splat(simd, self.t_min);
        let none = Single16::splat(simd, Hit::NONE_T);
        let best = Single16::load(simd, &self.t[group].0);
        let (t, is_within) = root_within(near, far, t_min, none);
        let sphere = u32x16::load_array_ref(simd, &self.sphere[group]);
        let is_lower = u32x16::splat(simd, index).simd_lt(sphere);
        let is_nearer = t.simd_lt(best) | (t.simd_le(best) & is_lower);
        let is_new = meets & is_within & is_nearer;
        Single16::select(is_new, t, best).store(&mut self.t[group].0);
        self.put_sphere(simd, group, is_new, index);
        self.end[group] = largest(&self.t[group].0);
    }
}

/// The same vector in every lane.
#[inline(always)]
fn splat3_wide<S: Simd>(simd: S, vector: DVec3) -> Lane3<Double16<S>> {
    Lane3 {
        x: Double16::splat(simd, vector.x),
        y: Double16::splat(simd, vector.y),
        z: Double16::splat(simd, vector.z),
    }
}

/// One value for each lane.
#[inline(always)]
fn lanes<T: Copy + Default>(of: impl Fn(usize) -> T) -> [T; LANES] {
    let mut values = [T::default(); LANES];
    for (lane, value) in values.iter_mut().enumerate() {
        *value = of(lane);
    }
    values
}

/// The largest value, none of which is a NaN.
#[inline(always)]
fn largest(values: &[f32; LANES]) -> f32 {
    let mut largest = *values;
    let mut half = LANES / 2;
    while half > 0 {
        for lane in 0..half {
            let other = largest[lane + half];
            if other > largest[lane] {
                largest[lane] = other;
            }
        }
        half /= 2;
    }
    largest[0]
}

/// Pixels of a group are next to each other: the group and the lane of a pixel counted row by row.
const fn place(index: usize) -> (usize, usize) {
    let (x, y) = (index % SIDE, index / SIDE);
    (y / 4 * 2 + x / 4, y % 4 * 4 + x % 4)
}

/// Finds the nearest hits of the rays through the square of pixels at `corner`, counted from the
/// tile's upper left, on the rung `RUNG`: in a tree or, without nodes, among all spheres.
pub fn trace<const RUNG: u32>(
    packet: &mut Packet,
    launch: &Launch,
    frusta: &Frusta,
    corner: UVec2,
    tree: Tree<'_>,
    spheres: &[Sphere],
) {
    dispatch!(packet.level, simd => {
        packet.aim(launch, frusta, corner);
        trace_on::<_, RUNG>(simd, packet, tree, spheres);
    });
}

#[inline(always)]
fn trace_on<S: Simd, const RUNG: u32>(
    simd: S,
    packet: &mut Packet,
    tree: Tree<'_>,
    spheres: &[Sphere],
) {
    let nodes = tree.nodes();
    if tree.is_none() {
        // Of hits of a rung without a bound nothing is known; none is passed by for being far away.
        packet.widening = f32::MAX;
        packet.test::<S, RUNG>(simd, spheres, 0, spheres.len());
        packet.finish::<S, RUNG>(simd, spheres);
        return;
    }
    let world = Extent::of_node(&nodes[0]);
    let widening = world.widening(RUNG, packet.origin);
    packet.widening = widening;
    // As large as any node's terms, as in the kernel's `Slabs`.
    let size = world.low.abs().max(world.high.abs())
        + packet.origin.abs()
        + (world.high - world.low) * 2.0;
    let off = size.element_sum() * SLACK + widening;
    let slacks = packet.frustum.planes.map(|plane| plane.slack(off));
    let forward_slack = packet.frustum.forward.slack(off);
    let mut stack = [Entry {
        depth: 0.0,
        first: 0,
        count: 0,
    }; Node::MAX_DEPTH * WIDTH];
    stack[0].first = Node::ROOT;
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let entry = stack[height];
        if entry.depth > packet.end() {
            continue;
        }
        let first = entry.first as usize;
        if entry.count > 0 {
            packet.test::<S, RUNG>(simd, spheres, entry.first, entry.count as usize);
            continue;
        }
        let node = &nodes[first];
        let sides = node.sides.each_ref().map(side_row);
        let corner =
            Vec3::from_array([node.corner.x, node.corner.y, node.corner.z].map(f32::from_bits))
                - packet.origin;
        // How far the boxes reach into the frustum, by the plane that they reach over the least.
        let mut reach = [f32::MAX; WIDTH];
        for (plane, slack) in packet.frustum.planes.iter().zip(slacks) {
            let farthest = plane.along(corner, &sides);
            for child in 0..WIDTH {
                reach[child] = reach[child].min(farthest[child] + slack);
            }
        }
        let mut depths = packet.frustum.forward.along(corner, &sides);
        let end = packet.end();
        let end = end + end.abs() * SLACK;
        let mut met = 0;
        for child in 0..WIDTH {
            depths[child] -= forward_slack;
            met |= u32::from((reach[child] >= 0.0) & (depths[child] <= end)) << child;
        }
        met &= children(node);
        let bottom = height;
        while met != 0 {
            let child = met.trailing_zeros();
            met &= met - 1;
            let (first, count) = if node.is_node(child) {
                (node.child(child), 0)
            } else {
                node.leaf(child)
            };
            let entry = Entry {
                depth: depths[child as usize],
                first,
                count,
            };
            // The nearest on top.
            let mut at = height;
            while at > bottom && stack[at - 1].depth < entry.depth {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = entry;
            height += 1;
        }
    }
    packet.finish::<S, RUNG>(simd, spheres);
}

/// A row of a node's sides.
#[inline(always)]
fn side_row(words: &UVec4) -> [f32; WIDTH] {
    let words = words.to_array();
    std::array::from_fn(|child| {
        let word = words[child % 4];
        if child < 4 {
            Node::lower(word)
        } else {
            Node::upper(word)
        }
    })
}

/// Which children there are, a bit each.
#[inline(always)]
fn children(node: &Node) -> u32 {
    // Four bits of each; now the first says whether any was set.
    let pairs = node.corner.w | node.links.z;
    let any = pairs | pairs >> 1;
    let any = (any | any >> 2) & 0x1111_1111;
    // Bits 4c to bits c: pairs, fours, all eight.
    let any = (any | any >> 3) & 0x0303_0303;
    let any = (any | any >> 6) & 0x000f_000f;
    (any | any >> 12) & 0xff
}

#[cfg(test)]
mod tests {
    use spherule_kernel::accel::brute::nearest_hit_in;
    use spherule_kernel::precision::OnRung;

    use super::*;
    use crate::accel::build_still;
    use crate::cpu;
    use crate::random::Random;

    const SIZE: UVec2 = UVec2::new(45, 29);

    fn launch(eye: Vec3, target: Vec3) -> Launch {
        let aspect = f64::from(SIZE.x) / f64::from(SIZE.y);
        let camera = Camera::look_at(eye, target, Vec3::Y, 0.9, aspect);
        Launch {
            camera: camera.expect("a camera"),
            image_size: SIZE,
            tile_size: SIZE,
            first_of_tile: 1,
            sphere_count: u32::MAX,
            ..Launch::default()
        }
    }

    struct Square<'a>(InstructionSet, &'a Launch, &'a [Sphere]);

    impl OnRung for Square<'_> {
        type Output = usize;

        fn run<const RUNG: u32>(self) -> usize {
            finds_what_each_ray_finds::<RUNG>(self.0, self.1, self.2)
        }
    }

    /// Squares of rays find what each finds alone, with a tree and without.
    fn finds_what_each_ray_finds<const RUNG: u32>(
        instructions: InstructionSet,
        launch: &Launch,
        spheres: &[Sphere],
    ) -> usize {
        let tree = build_still(spheres, 1).expect("a tree");
        let sorted = tree.sort(spheres);
        let mut hits = 0;
        let mut packet = Packet::new(instructions);
        let frusta = Frusta::of(launch);
        for (tree, spheres) in [(tree.nodes.tree(), &sorted[..]), (Tree::NONE, spheres)] {
            for (left, top) in (0..SIZE.y)
                .step_by(SIDE)
                .flat_map(|top| (0..SIZE.x).step_by(SIDE).map(move |left| (left, top)))
            {
                let corner = UVec2::new(left, top);
                trace::<RUNG>(&mut packet, launch, &frusta, corner, tree, spheres);
                for index in 0..RAYS {
                    let (ray, hit) = packet.hit(index);
                    let alone = nearest_hit_in(RUNG, &ray, spheres, 0, u32::MAX);
                    assert_eq!(
                        hit,
                        alone,
                        "rung {RUNG}, {} nodes, {ray:?}",
                        tree.nodes().len()
                    );
                    hits += usize::from(hit.is_some());
                }
            }
        }
        hits
    }

    /// With each of the instruction sets that this machine has.
    #[test]
    fn squares_find_what_each_ray_finds() {
        let mut random = Random::new(29);
        let mut world = |of: &mut dyn FnMut(&mut Random) -> Sphere| -> Vec<Sphere> {
            (0..600).map(|_| of(&mut random)).collect()
        };
        let worlds = [
            world(&mut |r| Sphere::new(r.vec3(-4.0, 4.0), 0.3)),
            world(&mut |r| Sphere::new(r.vec3(-2.0, 2.0).round(), 0.5)),
            world(&mut |r| {
                let radius = r.log_within(1e-3, 1e3);
                Sphere::new(r.unit_vec3() * (radius + r.within(0.0, 5.0)), radius)
            }),
            world(&mut |r| Sphere::new(Vec3::ONE, r.log_within(0.1, 20.0))),
            world(&mut |r| Sphere::new(Vec3::new(0.0, 0.0, -3e3) + r.vec3(-900.0, 900.0), 40.0)),
        ];
        for instructions in InstructionSet::ALL {
            if !instructions.is_there() {
                let required = std::env::var(cpu::VARIABLE);
                assert_ne!(required.as_deref(), Ok(instructions.name()), "is required");
                println!("SKIPPED: squares with {instructions}, which this machine does not have");
                continue;
            }
            for spheres in &worlds {
                for (eye, target) in [
                    (Vec3::new(0.0, 0.5, 9.0), Vec3::ZERO),
                    (Vec3::new(0.3, 0.1, 0.2), Vec3::NEG_Z),
                ] {
                    let launch = launch(eye, target);
                    let hits: usize = Rung::ALL
                        .iter()
                        .map(|rung| rung.with(Square(instructions, &launch, spheres)))
                        .sum();
                    assert!(hits > 1000, "{instructions}: {hits} hits tell little");
                }
            }
        }
    }
}
