//! [`Odd`]: makes values of every type that a public function takes: ordinary values, extreme
//! values and any bits.

use std::ffi::OsString;
use std::fmt::Debug;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;

use spherule::accel::{self, Acceleration, BuiltTree, Nodes};
use spherule::accuracy::cases::{Case, catalogue};
use spherule::accuracy::measure::RungErrors;
use spherule::accuracy::oracle::Intersection;
use spherule::accuracy::price::Price;
use spherule::accuracy::report::{FamilyResults, Row};
use spherule::accuracy::samples;
use spherule::accuracy::scene_cases::{SCENE_CASES, SceneCase};
use spherule::bench::measure::Plan;
use spherule::bench::scenes::BenchScene;
use spherule::device::{Access, Buffer, GpuOptions, Kernel, Module};
use spherule::kernel::accel::brute::MovingSpheres;
use spherule::kernel::accel::node;
use spherule::kernel::accel::node::Node;
use spherule::kernel::accel::traversal::OneByOne;
use spherule::kernel::cull::cone::{Cone, Sight};
use spherule::kernel::cull::frustum::{Frustum, Plane};
use spherule::kernel::filter::Filter;
use spherule::kernel::glam::{DVec3, Quat, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};
use spherule::kernel::material::microfacet::{Albedo, RoughMetal};
use spherule::kernel::material::plastic::Plastic;
use spherule::kernel::path::caustic::ball::Ball;
use spherule::kernel::path::caustic::ways::Ways;
use spherule::kernel::path::random::{Sampler, VertexNumbers};
use spherule::kernel::path::{Path, Scenery, start};
use spherule::kernel::shape;
use spherule::kernel::shape::{
    Capsule, Cuboid, Cylinder, Disc, Ellipsoid, Kinds, Shape, Shapes, Span,
};
use spherule::kernel::{
    Accumulator, Camera, Effects, Launch, Light, Material, PathLaunch, Pixel, Rung, Shading, Sphere,
};
use spherule::random::Random;
use spherule::read::particles::elements::{Element, UNKNOWN, by_number};
use spherule::read::particles::{PARTICLE_FORMATS, ParticleFormat};
use spherule::render::pace::Pace;
use spherule::render::{EffectChoice, Settings};
use spherule::render::{cpu, gpu, paths};
use spherule::scene::surroundings::{Develop, EnvironmentImage, Lens, Sun, Surroundings, Tonemap};
use spherule::scene::{FogBall, GlassShadows, PointLight, Sampling, View, World};
use spherule::trace::gpu::Batch;
use spherule::trace::{CpuTracer, GpuTracer};
use spherule::{Gpu, Image, Scene, kernel_module};

/// Numbers at which arithmetic behaves oddly.
const NUMBERS: [f32; 26] = [
    f32::NAN,
    -f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-45,
    -1e-42,
    0.0,
    -0.0,
    f32::EPSILON,
    1e-19,
    1.152_921_5e18,
    -1.152_921_5e18,
    8.673_617e-19,
    1e24,
    -1e24,
    1e10,
    -1e10,
    16_777_216.0,
    4_294_967_296.0,
    1.0,
    -1.0,
    0.5,
];

/// The source of the values of one call.
pub struct Source {
    state: u64,
    /// How many of 16 numbers are odd: there must be calls in which only one is.
    oddness: u64,
    /// Whether arguments are printed.
    tells: bool,
}

impl Source {
    /// The source for a call with this seed.
    pub fn new(seed: u64, tells: bool) -> Self {
        let mut source = Self {
            state: seed,
            oddness: 0,
            tells,
        };
        source.oddness = [0, 1, 1, 2, 4, 8, 16, 1][source.below(8)];
        source
    }

    /// Any bits (splitmix64).
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    fn is_odd(&mut self) -> bool {
        self.bits() % 16 < self.oddness
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }

    /// From 0 to 1.
    fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    fn tell<T: Debug>(&self, value: T) -> T {
        if self.tells {
            let text = format!("{value:?}");
            println!("    {}", text.chars().take(4000).collect::<String>());
        }
        value
    }

    /// A value; prints it if arguments are printed.
    pub fn draw<T: Odd + Debug>(&mut self) -> T {
        let value = T::odd(self);
        self.tell(value)
    }

    /// Several values.
    pub fn many<T: Odd + Debug>(&mut self) -> Vec<T> {
        self.draw()
    }

    /// An amount of work.
    pub fn few<T: TryFrom<u32> + Debug>(&mut self) -> T {
        let count = match self.below(8) {
            0 => 0,
            1 => 1,
            2 => self.below(200) as u32,
            _ => self.below(20) as u32,
        };
        let count = T::try_from(count).unwrap_or_else(|_| unreachable!("below 200"));
        self.tell(count)
    }

    /// A side of an image for which at most memory is allocated.
    pub fn side(&mut self) -> u32 {
        let side = match self.below(4) {
            0 => self.pick(&[0, 1, u32::MAX, 1 << 31, 65_536]),
            _ => self.below(64) as u32,
        };
        self.tell(side)
    }

    /// Any text.
    pub fn text(&mut self) -> String {
        let value = String::odd(self);
        self.tell(value)
    }

    /// Any path, in the current folder.
    pub fn path(&mut self) -> PathBuf {
        let value = PathBuf::odd(self);
        self.tell(value)
    }

    /// A path that can be written, or not.
    pub fn folder(&mut self) -> PathBuf {
        let value = self.pick(&[
            "folder",
            "folder",
            "folder/in/folder",
            "file.toml",
            "a\0b",
            "",
        ]);
        self.tell(value.into())
    }

    /// Possible contents of a file of this kind.
    pub fn file(&mut self, kind: &str) -> String {
        let whole = match kind {
            "pdb" => PDB,
            "xyz" => XYZ,
            _ => self.pick(&[TOML, include_str!("../../../scenes/fog.toml")]),
        };
        let mut bytes = whole.as_bytes().to_vec();
        for _ in 0..self.below(6) {
            let at = self.below(bytes.len() + 1);
            let to = (at + self.below(20)).min(bytes.len());
            let put = match self.below(4) {
                0 => String::odd(self),
                1 => f32::odd(self).to_string(),
                2 => self
                    .pick(&[
                        "\n",
                        "",
                        "99999999999",
                        "-1",
                        "nan",
                        "1e39",
                        "[",
                        "]]",
                        "=",
                        " ",
                    ])
                    .into(),
                _ => String::from_utf8_lossy(&bytes[at..to]).into_owned(),
            };
            bytes.splice(at..to, put.bytes());
        }
        let value = String::from_utf8_lossy(&bytes).into_owned();
        self.tell(value)
    }

    /// The bytes of a SPIR-V module, perhaps damaged.
    pub fn module(&mut self) -> Vec<u8> {
        let mut bytes = match self.below(4) {
            0 => Vec::<u8>::odd(self),
            _ => spherule::kernel::spirv::F32.to_vec(),
        };
        for _ in 0..self.below(5) {
            if bytes.is_empty() {
                break;
            }
            // The first bytes matter most.
            let end = if self.one_in(2) {
                bytes.len().min(2000)
            } else {
                bytes.len()
            };
            let at = self.below(end);
            match self.below(4) {
                0 => bytes.truncate(at),
                1 => bytes[at] = self.pick(&[0, 255, 1, 128]),
                _ => bytes[at] = self.bits() as u8,
            }
        }
        bytes
    }

    /// A launch of a small image.
    pub fn launch(&mut self) -> Launch {
        let camera = Camera::odd(self);
        let mut size = || UVec2::new(self.below(24) as u32, self.below(24) as u32);
        let (image_size, tile_size) = (size(), size());
        let is_whole = self.one_in(2);
        let value = Launch {
            camera,
            background: Vec3::odd(self),
            first_of_tile: self.below(2) as u32,
            image_size,
            tile_origin: if is_whole {
                UVec2::ZERO
            } else {
                Odd::odd(self)
            },
            tile_size: if is_whole { image_size } else { tile_size },
            first_sphere: if is_whole { 0 } else { Odd::odd(self) },
            sphere_count: if is_whole { u32::MAX } else { Odd::odd(self) },
        };
        self.tell(value)
    }

    /// The adapter that all calls share.
    pub fn gpu(&mut self) -> &'static Gpu {
        gpu_of_all().expect("only called if there is one")
    }

    /// A kernel on that adapter.
    pub fn kernel(&mut self) -> &'static Kernel {
        static KERNEL: OnceLock<Kernel> = OnceLock::new();
        KERNEL.get_or_init(|| {
            let module = kernel_module::f32().expect("the module is embedded");
            let access = [Access::Read, Access::ReadWrite];
            let gpu = gpu_of_all().expect("only called if there is one");
            gpu.kernel(&module, "cross_boundaries", &access)
                .expect("one of spherule's kernels")
        })
    }
}

/// The adapter for calls that need one.
pub fn gpu_of_all() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open(&spherule::DeviceChoice::Gpu).ok())
        .as_ref()
}

/// A type whose values can be made, ordinary or odd.
pub trait Odd {
    /// Makes one value.
    fn odd(s: &mut Source) -> Self;
}

impl Odd for f32 {
    fn odd(s: &mut Source) -> Self {
        if !s.is_odd() {
            return match s.below(4) {
                0 => s.unit(),
                1 => 4.0 * s.unit() - 2.0,
                2 => s.below(9) as f32 - 4.0,
                _ => s.unit() * 100.0,
            };
        }
        match s.below(3) {
            0 => Self::from_bits(s.bits() as u32),
            1 => s.pick(&NUMBERS),
            _ => {
                let scale = 2_f32.powi(s.below(280) as i32 - 150);
                (s.unit() - 0.5) * scale
            }
        }
    }
}

impl Odd for f64 {
    fn odd(s: &mut Source) -> Self {
        if s.is_odd() && s.one_in(2) {
            return match s.below(3) {
                0 => Self::from_bits(s.bits()),
                1 => s.pick(&[
                    Self::MAX,
                    Self::MIN,
                    Self::MIN_POSITIVE,
                    5e-324,
                    1e300,
                    -1e-300,
                ]),
                _ => Self::NAN,
            };
        }
        f32::odd(s).into()
    }
}

macro_rules! integers {
    ($($integer:ty),*) => {$(
        impl Odd for $integer {
            fn odd(s: &mut Source) -> Self {
                match s.below(8) {
                    0 => s.bits() as $integer,
                    1 => s.pick(&[<$integer>::MAX, <$integer>::MIN, 0, 1, <$integer>::MAX - 1, <$integer>::MAX / 2]),
                    2 => (1 as $integer) << s.below(<$integer>::BITS as usize),
                    _ => s.below(10) as $integer,
                }
            }
        }
    )*};
}
integers!(u8, u16, u32, u64, usize, i32);

impl Odd for bool {
    fn odd(s: &mut Source) -> Self {
        s.one_in(2)
    }
}

impl Odd for Duration {
    fn odd(s: &mut Source) -> Self {
        match s.below(8) {
            0 => s.pick(&[Self::MAX, Self::ZERO, Self::from_nanos(1)]),
            1 => Self::new(s.bits(), s.below(1_000_000_000) as u32),
            _ => Self::from_nanos(s.bits() % 1_000_000),
        }
    }
}

impl Odd for std::time::Instant {
    /// Now or soon.
    fn odd(s: &mut Source) -> Self {
        Self::now() + Duration::from_nanos(s.bits() % 1_000_000)
    }
}

impl Odd for String {
    fn odd(s: &mut Source) -> Self {
        match s.below(8) {
            0 => String::new(),
            1 => "\0".into(),
            2 => "x".repeat(s.below(3000)),
            3 => String::from_utf8_lossy(&Vec::<u8>::odd(s)).into_owned(),
            4 => "ä\u{202e}𝄞\n\r\t\"\\'<&>".into(),
            5 => f32::odd(s).to_string(),
            _ => s
                .pick(&[
                    "auto",
                    "cpu",
                    "gpu",
                    "gpu:0",
                    "C",
                    "He",
                    "UNK",
                    "X",
                    "s2",
                    "s46",
                    "uniform-100",
                    "lattice",
                    "main",
                    "trace_rays",
                    "cross_boundaries",
                    "toml",
                    "PDB",
                    "llvmpipe",
                ])
                .into(),
        }
    }
}

impl Odd for &'static str {
    fn odd(s: &mut Source) -> Self {
        s.pick(&["", "certified", "ä\0<&>", "a name"])
    }
}

impl Odd for ParticleFormat {
    fn odd(s: &mut Source) -> Self {
        PARTICLE_FORMATS[s.below(PARTICLE_FORMATS.len())]
    }
}

impl Odd for &'static Element {
    fn odd(s: &mut Source) -> Self {
        by_number(s.below(130)).unwrap_or(&UNKNOWN)
    }
}

impl Odd for PathBuf {
    fn odd(s: &mut Source) -> Self {
        let name = match s.below(6) {
            0 => String::odd(s).replace(['/', '.'], ""),
            1 => "long".repeat(s.below(1500)),
            2 => {
                use std::os::unix::ffi::OsStringExt as _;
                let bytes = Vec::<u8>::odd(s)
                    .into_iter()
                    .filter(|byte| !b"/.".contains(byte));
                let mut name = OsString::from_vec(bytes.collect());
                name.push(s.pick(&["", ".png", ".toml", ".exr", ".hdr", ".pdb"]));
                return name.into();
            }
            _ => s
                .pick(&["file", "broken", "folder", "missing", "nowhere/file", ""])
                .into(),
        };
        let kind = s.pick(&[
            "", ".toml", ".pdb", ".ent", ".xyz", ".hdr", ".exr", ".png", ".PNG", ".",
        ]);
        (name + kind).into()
    }
}

impl<T: Odd> Odd for Vec<T> {
    fn odd(s: &mut Source) -> Self {
        let count = match s.below(32) {
            0..4 => 0,
            4..8 => 1,
            8..31 => s.below(20),
            _ => s.below(300),
        };
        (0..count).map(|_| T::odd(s)).collect()
    }
}

impl<T: Odd> Odd for Option<T> {
    fn odd(s: &mut Source) -> Self {
        (!s.one_in(4)).then(|| T::odd(s))
    }
}

impl<T: Odd> Odd for Box<T> {
    fn odd(s: &mut Source) -> Self {
        Self::new(T::odd(s))
    }
}

impl<T: Odd> Odd for Range<T> {
    fn odd(s: &mut Source) -> Self {
        T::odd(s)..T::odd(s)
    }
}

impl<T: Odd, const N: usize> Odd for [T; N] {
    fn odd(s: &mut Source) -> Self {
        std::array::from_fn(|_| T::odd(s))
    }
}

impl<A: Odd, B: Odd> Odd for (A, B) {
    fn odd(s: &mut Source) -> Self {
        (A::odd(s), B::odd(s))
    }
}

impl Odd for Vec2 {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for Vec3 {
    fn odd(s: &mut Source) -> Self {
        let vector = Self::new(Odd::odd(s), Odd::odd(s), Odd::odd(s));
        match s.below(4) {
            // Directions.
            0 if vector.is_finite() => vector.normalize_or_zero(),
            1 => s.pick(&[Self::X, Self::NEG_Y, Self::Z, Self::ZERO, Self::ONE]),
            _ => vector,
        }
    }
}

impl Odd for samples::Plan {
    fn odd(s: &mut Source) -> Self {
        Self {
            most: s.below(5) as u32,
            denoiser: None,
            compiling: Odd::odd(s),
            until: Odd::odd(s),
        }
    }
}

impl Odd for DVec3 {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for Vec4 {
    fn odd(s: &mut Source) -> Self {
        Vec3::odd(s).extend(Odd::odd(s))
    }
}

impl Odd for Quat {
    fn odd(s: &mut Source) -> Self {
        Self::from_vec4(Odd::odd(s))
    }
}

impl Odd for UVec2 {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for UVec3 {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for UVec4 {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s), Odd::odd(s), Odd::odd(s))
    }
}

// Types of the kernel.

impl Odd for Camera {
    fn odd(s: &mut Source) -> Self {
        if s.one_in(2) {
            let aspect = f64::odd(s);
            let fov = f64::odd(s);
            let camera = Self::look_at(Odd::odd(s), Odd::odd(s), Vec3::Y, fov, aspect);
            return camera.unwrap_or_default();
        }
        Self::from_basis(Odd::odd(s), Odd::odd(s), Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for Cone {
    fn odd(s: &mut Source) -> Self {
        if s.one_in(2) {
            Self::of(Odd::odd(s), Odd::odd(s))
        } else {
            Self::from_vec4(Odd::odd(s))
        }
    }
}

impl Odd for Sight {
    fn odd(s: &mut Source) -> Self {
        Self::along(Odd::odd(s))
    }
}

impl Odd for Effects {
    fn odd(s: &mut Source) -> Self {
        if s.one_in(4) {
            Self::ALL
        } else {
            Self::from_bits(s.bits() as u32)
        }
    }
}

impl Odd for Accumulator {
    fn odd(s: &mut Source) -> Self {
        let mut sum = Self::default();
        for _ in 0..s.below(4) {
            sum.add(Odd::odd(s), Odd::odd(s), Odd::odd(s));
        }
        sum
    }
}

impl Odd for Pixel {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for Plane {
    fn odd(s: &mut Source) -> Self {
        Self::from_vec4(Odd::odd(s))
    }
}

impl Odd for Frustum {
    fn odd(s: &mut Source) -> Self {
        if s.one_in(2) {
            Self::around(&Camera::odd(s), Odd::odd(s), Odd::odd(s))
        } else {
            Self::within(Odd::odd(s), Odd::odd(s))
        }
    }
}

impl Odd for RoughMetal {
    fn odd(s: &mut Source) -> Self {
        let table = table(s);
        Self::new(Odd::odd(s), Odd::odd(s), Odd::odd(s), &table)
    }
}

impl Odd for Plastic {
    fn odd(s: &mut Source) -> Self {
        let table = table(s);
        let (color, index, alpha) = (Odd::odd(s), Odd::odd(s), Odd::odd(s));
        Self::new(color, index, alpha, Odd::odd(s), &table)
    }
}

/// The tables that the kernel reads, or tables of odd values.
fn table(s: &mut Source) -> Vec<f32> {
    static ALBEDO: OnceLock<Vec<f32>> = OnceLock::new();
    if s.one_in(2) {
        return Odd::odd(s);
    }
    let mut table = ALBEDO.get_or_init(|| Albedo::table().to_vec()).clone();
    let more: Vec<f32> = Odd::odd(s);
    table.extend(more);
    table
}

impl Odd for Sampler {
    fn odd(s: &mut Source) -> Self {
        Self::new(Odd::odd(s), Odd::odd(s), Odd::odd(s))
    }
}

impl Odd for Path {
    fn odd(s: &mut Source) -> Self {
        let scenery = OddScenery::odd(s);
        start(&scenery.get(), Odd::odd(s), &Odd::odd(s))
    }
}

impl Odd for Ball {
    fn odd(s: &mut Source) -> Self {
        let kind = s.below(4) as u32;
        Self::new(kind, s.draw(), s.draw(), s.draw(), s.draw(), s.draw())
    }
}

impl Odd for Ways {
    fn odd(s: &mut Source) -> Self {
        Self::new(s.draw(), s.draw(), s.draw(), s.draw())
    }
}

impl Odd for VertexNumbers {
    fn odd(s: &mut Source) -> Self {
        Sampler::odd(s).at_vertex(Odd::odd(s))
    }
}

impl Odd for Sphere {
    fn odd(s: &mut Source) -> Self {
        let radius = if s.is_odd() { Odd::odd(s) } else { s.unit() };
        Self::new(Odd::odd(s), radius)
    }
}

impl Odd for Span<f32> {
    fn odd(s: &mut Source) -> Self {
        Self {
            near: Odd::odd(s),
            far: Odd::odd(s),
            meets: Odd::odd(s),
        }
    }
}

impl Odd for Kinds {
    fn odd(s: &mut Source) -> Self {
        if s.one_in(4) {
            Self::ALL
        } else {
            Self::from_bits(s.bits() as u32)
        }
    }
}

impl Odd for Shape {
    fn odd(s: &mut Source) -> Self {
        let (start, end): (Vec3, Vec3) = (Odd::odd(s), Odd::odd(s));
        let mut length = || if s.is_odd() { Odd::odd(s) } else { s.unit() };
        let half = Vec3::new(length(), length(), length());
        let rotation = Odd::odd(s);
        match s.below(7) {
            0 => Capsule::new(start, end, half.x).into(),
            1 => Cylinder::new(start, end, half.x).into(),
            2 => shape::Cone::new(start, end, half.x, half.y).into(),
            3 => Ellipsoid::new(start, half, rotation).into(),
            4 => Cuboid::new(start, half, rotation).into(),
            5 => Disc::new(start, end, half.x).into(),
            _ => {
                let rows: [Vec4; 3] = Odd::odd(s);
                bytemuck::cast(rows)
            }
        }
    }
}

/// Owns what [`Shapes`] borrow.
#[derive(Debug)]
pub struct OddShapes {
    kinds: Kinds,
    shapes: Vec<Shape>,
    tree: OddTree,
    first: u32,
}

impl Odd for OddShapes {
    fn odd(s: &mut Source) -> Self {
        Self {
            kinds: Odd::odd(s),
            shapes: Odd::odd(s),
            tree: Odd::odd(s),
            first: if s.is_odd() {
                Odd::odd(s)
            } else {
                s.below(9) as u32
            },
        }
    }
}

impl OddShapes {
    /// The shapes.
    pub fn get(&self) -> Shapes<'_> {
        Shapes {
            kinds: self.kinds,
            shapes: &self.shapes,
            tree: self.tree.get(),
            first: self.first,
        }
    }
}

impl Odd for Material {
    fn odd(s: &mut Source) -> Self {
        let color = Vec3::new(s.unit(), s.unit(), s.unit());
        let mut material = match s.below(6) {
            0 => Self::diffuse(color),
            1 => Self::metal(color, s.unit()),
            2 => Self::glass(1.0 + s.unit(), color),
            3 => Self::bubble(1.0 + s.unit(), color),
            4 => Self::plastic(color, s.unit(), 1.1 + s.unit()),
            _ => Self::emissive(color),
        };
        if s.is_odd() {
            match s.below(4) {
                0 => material.color = Odd::odd(s),
                1 => material.kind = Odd::odd(s),
                2 => material.volume = Odd::odd(s),
                _ => material.parameter = Odd::odd(s),
            }
        }
        material
    }
}

/// Owns what [`MovingSpheres`] borrow.
#[derive(Debug)]
pub struct OddMovingSpheres(Vec<Sphere>, Vec<Vec4>, f32, Effects, u32, u32);

impl Odd for OddMovingSpheres {
    fn odd(s: &mut Source) -> Self {
        Self(
            Odd::odd(s),
            Odd::odd(s),
            Odd::odd(s),
            Odd::odd(s),
            Odd::odd(s),
            Odd::odd(s),
        )
    }
}

impl OddMovingSpheres {
    /// The spheres.
    pub fn get(&self) -> MovingSpheres<'_> {
        MovingSpheres {
            spheres: &self.0,
            velocities: &self.1,
            time: self.2,
            effects: self.3,
            left: self.4,
            target: self.5,
        }
    }
}

/// Owns what a tree borrows: nodes with odd bits.
#[derive(Debug)]
pub struct OddTree(Vec<Node>);

impl Odd for OddTree {
    fn odd(s: &mut Source) -> Self {
        let mut nodes = match s.below(8) {
            0 => Odd::odd(s),
            _ => Nodes::odd(s).to_vec(),
        };
        for _ in 0..s.below(4) {
            let at = s.below(nodes.len().max(1));
            let Some(node) = nodes.get_mut(at) else {
                break;
            };
            let row = s.below(4);
            match s.below(4) {
                0 => node.sides[s.below(6)][row] = Odd::odd(s),
                1 => node.corner[row] = Odd::odd(s),
                2 => node.links[row] = Odd::odd(s),
                _ => node.links[1] = s.bits() as u32,
            }
        }
        Self(nodes)
    }
}

impl OddTree {
    /// The tree; `Tree::NONE` if the nodes are not a tree.
    pub fn get(&self) -> node::Tree<'_> {
        node::Tree::of(&self.0).unwrap_or(node::Tree::NONE)
    }
}

/// Owns what [`OneByOne`] borrows.
#[derive(Debug)]
pub struct OddOneByOne(u32, u32, OddTree);

impl Odd for OddOneByOne {
    fn odd(s: &mut Source) -> Self {
        Self(Odd::odd(s), s.below(3) as u32, Odd::odd(s))
    }
}

impl OddOneByOne {
    /// The traversal.
    pub fn get(&self) -> OneByOne<'_> {
        OneByOne {
            rung: self.0,
            has_tree: self.1,
            tree: self.2.get(),
        }
    }
}

/// Owns what [`Scenery`] borrows.
#[derive(Debug)]
pub struct OddScenery {
    effects: Effects,
    rung: u32,
    launch: PathLaunch,
    traversal: OddOneByOne,
    shapes: OddShapes,
    spheres: Vec<Sphere>,
    velocities: Vec<Vec4>,
    material_ids: Vec<u32>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    tables: Vec<f32>,
    texels: Vec<f32>,
}

impl Odd for OddScenery {
    fn odd(s: &mut Source) -> Self {
        let launch = PathLaunch {
            sample_count: s.below(4) as u32,
            max_bounces: s.below(12) as u32,
            ..Odd::odd(s)
        };
        Self {
            effects: Odd::odd(s),
            rung: Odd::odd(s),
            launch,
            traversal: Odd::odd(s),
            shapes: Odd::odd(s),
            spheres: Odd::odd(s),
            velocities: Odd::odd(s),
            material_ids: Odd::odd(s),
            materials: Odd::odd(s),
            lights: Odd::odd(s),
            tables: table(s),
            texels: table(s),
        }
    }
}

impl OddScenery {
    /// The scenery.
    pub fn get(&self) -> Scenery<'_, OneByOne<'_>> {
        Scenery {
            effects: self.effects,
            rung: self.rung,
            launch: &self.launch,
            traversal: self.traversal.get(),
            shapes: self.shapes.get(),
            spheres: &self.spheres,
            velocities: &self.velocities,
            material_ids: &self.material_ids,
            materials: &self.materials,
            lights: &self.lights,
            tables: &self.tables,
            texels: &self.texels,
        }
    }
}

// Types of the host.

impl Odd for Nodes {
    fn odd(s: &mut Source) -> Self {
        BuiltTree::odd(s).nodes
    }
}

impl Odd for BuiltTree {
    fn odd(s: &mut Source) -> Self {
        let mut spheres: Vec<Sphere> = Odd::odd(s);
        spheres.push(Odd::odd(s));
        let velocities: Vec<Vec3> = if s.one_in(2) { Vec::new() } else { Odd::odd(s) };
        let tree = accel::build(&spheres, &velocities, Odd::odd(s), 0);
        let mut tree = tree.unwrap_or_else(|| Self {
            nodes: Nodes::default(),
            order: Vec::new(),
        });
        if s.is_odd() {
            tree.order = Odd::odd(s);
        }
        tree
    }
}

impl Odd for World {
    fn odd(s: &mut Source) -> Self {
        let materials: Vec<Material> = if s.is_odd() {
            Odd::odd(s)
        } else {
            (0..1 + s.below(3)).map(|_| Odd::odd(s)).collect()
        };
        let spheres: Vec<Sphere> = Odd::odd(s);
        let mut velocities: Vec<Vec3> = Vec::new();
        if s.one_in(3) {
            velocities = spheres.iter().map(|_| Odd::odd(s)).collect();
        }
        let id = |s: &mut Source| {
            if s.is_odd() && s.one_in(8) {
                Odd::odd(s)
            } else {
                s.below(materials.len().max(1)) as u32
            }
        };
        let mut material_ids: Vec<u32> = spheres.iter().map(|_| id(s)).collect();
        let shapes: Vec<Shape> = if s.one_in(2) { Odd::odd(s) } else { Vec::new() };
        let mut shape_material_ids: Vec<u32> = shapes.iter().map(|_| id(s)).collect();
        let mut shape_velocities: Vec<Vec3> = Vec::new();
        if s.one_in(3) {
            shape_velocities = shapes.iter().map(|_| Odd::odd(s)).collect();
        }
        if s.is_odd() {
            match s.below(6) {
                4 => shape_velocities = Odd::odd(s),
                5 => shape_material_ids = Odd::odd(s),
                0 => velocities = Odd::odd(s),
                1 => {
                    material_ids.pop();
                }
                2 => material_ids.push(0),
                _ => {}
            }
        }
        let material_names = if s.is_odd() {
            Odd::odd(s)
        } else {
            vec![String::from("name"); materials.len()]
        };
        Self {
            spheres,
            material_ids,
            materials,
            material_names,
            velocities,
            shapes,
            shape_material_ids,
            shape_velocities,
        }
    }
}

impl Odd for spherule::kernel::precision::double::Quadratic<f32> {
    fn odd(s: &mut Source) -> Self {
        Self {
            a: Odd::odd(s),
            b: Odd::odd(s),
            c: Odd::odd(s),
            discriminant: Odd::odd(s),
            oo: Odd::odd(s),
            rr: Odd::odd(s),
            c_has_digits: Odd::odd(s),
        }
    }
}

impl Odd for GpuOptions {
    fn odd(s: &mut Source) -> Self {
        Self::default()
            .through_naga(Odd::odd(s))
            .without_f64(Odd::odd(s))
            .timeout(Odd::odd(s))
    }
}

impl Odd for Settings {
    fn odd(s: &mut Source) -> Self {
        let (shading, rung): (Shading, Rung) = (Odd::odd(s), Odd::odd(s));
        let settings = Self::from((shading, rung))
            .acceleration(Odd::odd(s))
            .effects(Odd::odd(s));
        match s.below(3) {
            0 => settings.time_limit(Odd::odd(s)),
            1 => settings.noise(Odd::odd(s)),
            _ => settings,
        }
    }
}

impl Odd for Scene {
    /// Mostly a scene that can be rendered, with few pixels and samples.
    fn odd(s: &mut Source) -> Self {
        let mut scene = small_scene(s);
        make_parts_odd(&mut scene, s);
        scene
    }
}

/// A scene that can be rendered, with few pixels and samples.
fn small_scene(s: &mut Source) -> Scene {
    let mut scene = Scene::new(Odd::odd(s));
    (scene.width, scene.height) = (1 + s.below(12) as u32, 1 + s.below(12) as u32);
    scene.sampling.samples = Some(1 + s.below(4) as u32);
    scene.sampling.max_bounces = s.below(9) as u32;
    let mut color = || Vec3::new(s.unit(), s.unit(), s.unit());
    let (first, second, third) = (color(), color(), color());
    scene.background = first;
    if s.one_in(2) {
        scene.view = Some(View {
            eye: Vec3::new(0.0, 1.0, 8.0 * s.unit()),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov: 40.0,
        });
    }
    if s.one_in(3) {
        scene.transparent = true;
    }
    if s.one_in(3) {
        scene.lens = Lens {
            aperture: s.unit(),
            focus_distance: s.one_in(2).then_some(1.0),
            shutter: (0.0, s.unit()),
        };
    }
    if s.one_in(2) {
        let sun = Sun {
            direction: Vec3::Y,
            size: s.unit(),
            irradiance: third,
        };
        let image = s.one_in(2).then(|| EnvironmentImage {
            width: 4,
            height: 2,
            texels: vec![second; 8],
        });
        scene.sky = Some(Surroundings {
            rotation: 0.0,
            horizon: first,
            zenith: second,
            sun: s.one_in(2).then_some(sun),
            image,
        });
    }
    if s.one_in(3) {
        let mut fog = FogBall {
            medium: spherule::kernel::fog::Fog::default(),
        };
        fog.medium.radius = s.unit() * 4.0;
        fog.medium.albedo = second;
        fog.medium.extinction = s.unit();
        fog.medium.anisotropy = s.unit() - 0.5;
        scene.fog = Some(fog);
    }
    if s.one_in(3) {
        scene.lights = vec![PointLight {
            position: Vec3::splat(3.0),
            intensity: first * 20.0,
        }];
    }
    if s.one_in(4) {
        scene.sampling.ambient_occlusion = Some(s.unit() + 0.1);
    }
    scene
}

/// Gives none, one or several parts of a scene odd values.
fn make_parts_odd(scene: &mut Scene, s: &mut Source) {
    let changes = if s.oddness == 0 { 0 } else { s.below(4) };
    for _ in 0..changes {
        match s.below(16) {
            0 => scene.width = s.pick(&[0, 1, u32::MAX, 1 << 31, 1_000_000]),
            1 => scene.height = s.pick(&[0, 1, u32::MAX, 1 << 31, 1_000_000]),
            2 => scene.background = Odd::odd(s),
            3 => scene.view = Odd::odd(s),
            4 => scene.lens = Odd::odd(s),
            5 => {
                scene.sky = Some(Surroundings {
                    rotation: Odd::odd(s),
                    horizon: Odd::odd(s),
                    zenith: Odd::odd(s),
                    sun: Odd::odd(s),
                    image: Odd::odd(s),
                });
            }
            6 => {
                scene.fog = Some(FogBall {
                    medium: Odd::odd(s),
                });
            }
            7 => scene.lights = Odd::odd(s),
            8 => scene.sampling = Odd::odd(s),
            9 => {
                scene.develop = Develop {
                    exposure: Odd::odd(s),
                    tonemap: s.pick(&[Tonemap::Clamp, Tonemap::Reinhard, Tonemap::Aces]),
                };
            }
            10 => scene.world.velocities = Odd::odd(s),
            11 => scene.world.material_ids = Odd::odd(s),
            12 => scene.world.materials = Odd::odd(s),
            13 => scene.world.material_names = Odd::odd(s),
            14 => scene.world.spheres.push(Odd::odd(s)),
            _ => scene.world.spheres.clear(),
        }
    }
}

impl Odd for Sampling {
    fn odd(s: &mut Source) -> Self {
        Self {
            samples: s.pick(&[
                None,
                Some(0),
                Some(1),
                Some(9),
                Some(u32::MAX),
                Some(1 << 31),
            ]),
            max_bounces: s.pick(&[0, 1, 20, u32::MAX, 1 << 31]),
            ambient_occlusion: Odd::odd(s),
            glass_shadows: s.pick(&[GlassShadows::Dark, GlassShadows::Clear]),
            clamp: Odd::odd(s),
            filter: Filter::new(s.below(4) as u32, Odd::odd(s)),
            caustics: Odd::odd(s),
            seed: Odd::odd(s),
        }
    }
}

impl Odd for Lens {
    fn odd(s: &mut Source) -> Self {
        Self {
            aperture: Odd::odd(s),
            focus_distance: Odd::odd(s),
            shutter: Odd::odd(s),
        }
    }
}

impl Odd for PointLight {
    fn odd(s: &mut Source) -> Self {
        Self {
            position: Odd::odd(s),
            intensity: Odd::odd(s),
        }
    }
}

impl Odd for EnvironmentImage {
    fn odd(s: &mut Source) -> Self {
        let texels: Vec<Vec3> = Odd::odd(s);
        let fits = !s.one_in(4);
        Self {
            width: if fits {
                texels.len() as u32
            } else {
                Odd::odd(s)
            },
            height: if fits { 1 } else { Odd::odd(s) },
            texels,
        }
    }
}

impl Odd for Image {
    fn odd(s: &mut Source) -> Self {
        let (width, height) = (s.below(12) as u32, s.below(12) as u32);
        let count = width * height;
        let pixels = (0..count).map(|_| Odd::odd(s)).collect();
        let shading = s.pick(&[
            Shading::Lit,
            Shading::Normals,
            Shading::Depth,
            Shading::Flat,
        ]);
        let mut image =
            Self::new(width, height, shading, pixels).expect("the image has this many pixels");
        if s.one_in(3) {
            image
                .set_alpha((0..count).map(|_| Odd::odd(s)).collect())
                .expect("there is one for each pixel");
        }
        image.develop.exposure = Odd::odd(s);
        image.develop.tonemap = s.pick(&[Tonemap::Clamp, Tonemap::Reinhard, Tonemap::Aces]);
        image
    }
}

impl Odd for CpuTracer {
    fn odd(s: &mut Source) -> Self {
        let spheres: Vec<Sphere> = Odd::odd(s);
        Self::new(
            &spheres,
            s.pick(&[
                Acceleration::Auto,
                Acceleration::Tree,
                Acceleration::BruteForce,
            ]),
        )
    }
}

impl Odd for Pace {
    fn odd(s: &mut Source) -> Self {
        Self::starting_at(Odd::odd(s))
    }
}

impl Odd for paths::Prepared {
    /// A prepared scene with some odd changes.
    fn odd(s: &mut Source) -> Self {
        static PLAIN: OnceLock<paths::Prepared> = OnceLock::new();
        let choice = s.pick(&[EffectChoice::Auto, EffectChoice::All]);
        let scene = Scene::odd(s);
        let mut prepared = Self::new(&scene, choice, Acceleration::Auto).unwrap_or_else(|_| {
            let plain = || {
                let mut scene = Scene::new(World::default());
                (scene.width, scene.height) = (3, 2);
                Self::new(&scene, EffectChoice::All, Acceleration::Auto).expect("a scene")
            };
            PLAIN.get_or_init(plain).clone()
        });
        for _ in 0..s.below(3) {
            match s.below(10) {
                0 => prepared.world.spheres = Odd::odd(s),
                1 => prepared.world.materials = Odd::odd(s),
                2 => prepared.world.material_ids = Odd::odd(s),
                3 => prepared.nodes = Odd::odd(s),
                4 => prepared.velocities = Odd::odd(s),
                5 => prepared.lights = Odd::odd(s),
                6 => (prepared.tables, prepared.texels) = (Odd::odd(s), Odd::odd(s)),
                7 => prepared.samples = s.below(4) as u32,
                8 => {
                    let plain = prepared.launch;
                    prepared.launch = PathLaunch {
                        sample_count: s.below(4) as u32,
                        max_bounces: s.below(9) as u32,
                        ..Odd::odd(s)
                    };
                    if s.below(3) > 0 {
                        prepared.launch.image_size = plain.image_size;
                        prepared.launch.tile_size = plain.tile_size;
                        prepared.launch.tile_origin = plain.tile_origin;
                    }
                }
                _ => prepared.compiled = Odd::odd(s),
            }
        }
        prepared
    }
}

/// Owns what a prepared world borrows.
#[derive(Debug)]
pub struct OddPrepared(World, Acceleration);

impl Odd for OddPrepared {
    fn odd(s: &mut Source) -> Self {
        let acceleration = s.pick(&[
            Acceleration::Auto,
            Acceleration::Tree,
            Acceleration::BruteForce,
        ]);
        Self(Odd::odd(s), acceleration)
    }
}

impl OddPrepared {
    /// The prepared world.
    pub fn get(&self) -> cpu::Prepared<'_> {
        cpu::Prepared::new(&self.0, self.1)
    }
}

/// A family's name, its note, and its rows.
type OddFamily = (String, String, Vec<(Price, RungErrors)>);

/// Owns what the report's families borrow.
#[derive(Debug)]
pub struct OddFamilies(Vec<OddFamily>);

impl Odd for OddFamilies {
    fn odd(s: &mut Source) -> Self {
        let row = |s: &mut Source| (Odd::odd(s), Odd::odd(s));
        let family = |s: &mut Source| {
            let rows = (0..s.below(4)).map(|_| row(s)).collect();
            (Odd::odd(s), Odd::odd(s), rows)
        };
        Self((0..s.below(4)).map(|_| family(s)).collect())
    }
}

impl OddFamilies {
    /// The families.
    pub fn get(&self) -> Vec<FamilyResults<'_>> {
        self.0
            .iter()
            .map(|(name, note, rows)| FamilyResults {
                name,
                note: note.clone(),
                rungs: rows
                    .iter()
                    .map(|(price, measured)| Row {
                        rung: "certified",
                        price: *price,
                        measured,
                    })
                    .collect(),
            })
            .collect()
    }
}

impl Odd for Case {
    fn odd(s: &mut Source) -> Self {
        let mut all = catalogue();
        all.swap_remove(s.below(all.len()))
    }
}

impl Odd for SceneCase {
    fn odd(s: &mut Source) -> Self {
        s.pick(SCENE_CASES)
    }
}

impl Odd for Intersection {
    fn odd(s: &mut Source) -> Self {
        for _ in 0..20 {
            if let Some(found) = Self::of(&Odd::odd(s), &Odd::odd(s)) {
                return found;
            }
        }
        let ray = spherule::kernel::Ray::new(Vec3::ZERO, Vec3::X);
        Self::of(&ray, &Sphere::new(Vec3::X, 0.5)).expect("an intersection")
    }
}

impl Odd for Random {
    fn odd(s: &mut Source) -> Self {
        Self::new(s.bits())
    }
}

impl Odd for Plan {
    fn odd(s: &mut Source) -> Self {
        Self {
            rung: s.pick(&[
                Rung::Textbook,
                Rung::Robust,
                Rung::Compensated,
                Rung::Double,
                Rung::Certified,
            ]),
            acceleration: s.pick(&[
                Acceleration::Auto,
                Acceleration::Tree,
                Acceleration::BruteForce,
            ]),
            rounds: s.below(3),
        }
    }
}

impl Odd for BenchScene {
    /// Never one with a million spheres.
    fn odd(s: &mut Source) -> Self {
        match s.below(4) {
            0 => Self::S2,
            1 => Self::S46,
            2 => Self::S500,
            _ => Self::Uniform(s.below(2000) as u32),
        }
    }
}

impl Odd for Module {
    fn odd(s: &mut Source) -> Self {
        let bytes = s.module();
        let module = Self::from_bytes("odd", &bytes);
        module.unwrap_or_else(|_| kernel_module::f32().expect("the module is embedded"))
    }
}

impl Odd for Buffer<u32> {
    fn odd(s: &mut Source) -> Self {
        let data: Vec<u32> = Odd::odd(s);
        let data = if data.is_empty() { vec![0] } else { data };
        s.gpu().upload("odd", &data).expect("a small buffer")
    }
}

impl Odd for GpuTracer<'static> {
    fn odd(s: &mut Source) -> Self {
        let mut spheres: Vec<Sphere> = Odd::odd(s);
        spheres.push(Odd::odd(s));
        Self::new(s.gpu(), &spheres, Acceleration::Auto).expect("a small world")
    }
}

impl Odd for Batch {
    fn odd(s: &mut Source) -> Self {
        let mut rays: Vec<spherule::kernel::Ray> = Odd::odd(s);
        rays.push(Odd::odd(s));
        GpuTracer::odd(s).upload(&rays).expect("few rays")
    }
}

impl Odd for gpu::Prepared {
    fn odd(s: &mut Source) -> Self {
        Self::new(s.gpu(), &Odd::odd(s), spherule::render::Settings::default())
            .expect("a small world")
    }
}

/// Files for paths to name, in the current folder.
pub fn write_files() -> std::io::Result<()> {
    std::fs::create_dir_all("folder.toml")?;
    std::fs::create_dir_all("folder.pdb")?;
    std::fs::create_dir_all("folder.png")?;
    std::fs::write("file.toml", TOML)?;
    std::fs::write("file.pdb", PDB)?;
    std::fs::write("file.ent", PDB)?;
    std::fs::write("file.xyz", XYZ)?;
    let hdr = include_bytes!("../../fuzz/corpus/environment/small.hdr");
    std::fs::write("file.hdr", hdr)?;
    std::fs::write(
        "file.exr",
        include_bytes!("../../fuzz/corpus/environment/small.exr"),
    )?;
    for kind in ["toml", "pdb", "ent", "xyz", "hdr", "exr", "png"] {
        std::fs::write(format!("broken.{kind}"), b"\0\xff#?RADIANCE\n= 1 [\n")?;
    }
    Ok(())
}

const TOML: &str = include_str!("../../../scenes/two-spheres.toml");
const XYZ: &str = "3\nwater\nO 0 0 0\nH 0.76 0.59 0\nH -0.76 0.59 0\n";
const PDB: &str = "\
ATOM      1  N   THR A   1      17.047  14.099   3.625  1.00 13.79           N  
HETATM    2  CA  MSE A   1      16.967  12.784   4.338  1.00 10.80           C  
END
";
