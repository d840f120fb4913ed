//! Writes `src/calls.rs`: a call of each public function of spherule and of its kernel, from
//! rustdoc's JSON.
//!
//!     generate spherule_kernel.json spherule.json > src/calls.rs
//!
//! It fails if it cannot make the arguments of a function, unless [`LEFT_OUT`] says why the
//! function is not called. It also fails if no function needs an entry of a table here any more.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::error::Error;
use std::fmt::Write as _;

use rustdoc_types::{
    Attribute, Crate, Function, GenericArg, GenericArgs, GenericBound, Generics, Id, Impl, Item,
    ItemEnum, StructKind, Type, VariantKind, Visibility, WherePredicate,
};

/// Functions that are not called, and the reason.
const LEFT_OUT: &[(&str, &str)] = &[
    (
        "spherule_kernel::shape::among::Motion",
        "moves shapes for Shapes, whose functions are called",
    ),
    (
        "spherule_kernel::shape::span::Span::narrowed",
        "is of the type with 64-bit floats alone; Shape::span calls it",
    ),
    (
        "spherule_kernel::accel::primitives::Primitives",
        "for all spheres at once: its methods are called by the walks, which are called with these",
    ),
    (
        "spherule::cli::run",
        "is a whole command: tests/command_line_as_a_function.rs",
    ),
    (
        "spherule::film::denoise::Denoiser",
        "is dropped by the library that made it: tests/denoise",
    ),
    (
        "spherule::film::denoise::Denoiser::open",
        "loads a library that the machine may not have: tests/denoise",
    ),
    (
        "spherule::film::denoise::Denoiser::denoise",
        "needs that library: tests/denoise",
    ),
    (
        "spherule::film::denoise::Denoiser::name",
        "needs that library: tests/denoise",
    ),
    (
        "spherule::threads::start",
        "starts the threads of the process, once: tests/memory.rs",
    ),
    (
        "spherule::cli::main",
        "takes the process' command line: tests/command_line.rs",
    ),
    (
        "spherule::device::adapter::adapters",
        "takes wgpu's own types: list_adapters is called",
    ),
    (
        "spherule::device::gpu::Gpu::from_adapter",
        "takes wgpu's own types: tests/gpu_errors.rs",
    ),
    (
        "spherule::device::gpu::Gpu::destroy",
        "takes the GPU from the calls that follow: tests/gpu_errors.rs",
    ),
    (
        "spherule_kernel::lane::Lane::select",
        "takes a mask: host/lanes.rs",
    ),
    (
        "spherule_kernel::lane::Lane::choose_pair",
        "takes a mask: host/lanes.rs",
    ),
    (
        "spherule_kernel::accel::slabs::Sides",
        "is for three numbers side by side: host/trace/walk.rs",
    ),
    (
        "spherule_kernel::accel::slabs::Boxes::enter_and_leave",
        "takes what implements Sides: host/trace/walk.rs",
    ),
    (
        "spherule::device::gpu::GpuOptions::limits",
        "takes a type of wgpu: tests/gpu_errors.rs",
    ),
    (
        "spherule_kernel::precision::Rung::with",
        "takes code: host/trace/search.rs",
    ),
    (
        "spherule_kernel::path::step::shade",
        "takes code: trace_pixel calls it",
    ),
    (
        "spherule_kernel::shading::Shading::with",
        "takes code: host/render/cpu.rs",
    ),
    (
        "spherule::device::gpu::Gpu::launch",
        "runs for as long as a kernel says: tests/gpu_errors.rs",
    ),
];

/// The type arguments for generic types and functions, unless [`WRITTEN`] has the call.
const NUMBER: &str = "f32";

/// Calls written by hand, if a generic argument must be chosen, or if arguments must fit or borrow
/// one another.
const WRITTEN: &[(&str, &[&str])] = &[
    (
        "spherule_kernel::arithmetic::distill::distill",
        &[
            "distill(&mut s.draw::<[f32; 1]>())",
            "distill(&mut s.draw::<[f32; 2]>())",
            "distill(&mut s.draw::<[f32; 9]>())",
        ],
    ),
    (
        "spherule_kernel::arithmetic::elements::get",
        &["get(&s.draw::<[u32; 5]>(), s.draw())"],
    ),
    (
        "spherule_kernel::arithmetic::elements::set",
        &["set(&mut s.draw::<[u32; 5]>(), s.draw(), s.draw())"],
    ),
    (
        "spherule_kernel::arithmetic::elements::read",
        &["read::<u32>(&s.many()[..], s.draw())"],
    ),
    (
        "spherule::accuracy::cases::Case::samples",
        &["samples(&s.draw()).count()"],
    ),
    (
        "spherule::accuracy::report::page",
        &[
            "page(&s.text(), s.draw(), &s.draw::<odd::OddFamilies>().get(), Some((&s.text(), &s.many()[..])), &s.many()[..], &s.text())",
        ],
    ),
    (
        "spherule::device::gpu::Gpu::upload",
        &["upload::<u32>(s.gpu(), &s.text(), &s.many()[..])"],
    ),
    (
        "spherule::device::gpu::Gpu::upload_uniform",
        &["upload_uniform::<u32>(s.gpu(), &s.text(), &s.draw())"],
    ),
    (
        "spherule::device::gpu::Gpu::update",
        &["update::<u32>(s.gpu(), &s.draw(), &s.draw())"],
    ),
    (
        "spherule::device::gpu::Gpu::zeroed",
        &["zeroed::<u32>(s.gpu(), &s.text(), s.few())"],
    ),
    (
        "spherule::device::gpu::Gpu::clear",
        &["clear::<u32>(s.gpu(), &s.draw())"],
    ),
    (
        "spherule::device::gpu::Gpu::read",
        &["read::<u32>(s.gpu(), &s.draw())"],
    ),
    (
        "spherule::device::gpu::Gpu::read_first",
        &["read_first::<u32>(s.gpu(), &s.draw(), s.draw())"],
    ),
    (
        "spherule::device::gpu::Gpu::read_into",
        &["read_into::<u32>(s.gpu(), &s.draw(), &mut s.many()[..])"],
    ),
    (
        "spherule::film::allocate",
        &["allocate::<f32>(s.side(), s.side())"],
    ),
    (
        "spherule::render::fit::fit",
        &["fit(&mut s.draw(), s.draw(), |_| Ok(s.draw()))"],
    ),
    (
        "spherule::accel::tree::BuiltTree::sort",
        &["sort(&s.draw(), &s.many::<u32>()[..])"],
    ),
];

/// Expressions for arguments, by function and argument name.
const ARGUMENTS: &[(&str, &str, &str)] = &[
    (
        "spherule::scene::world::World::add_shape",
        "shape",
        "s.draw::<spherule_kernel::shape::Shape>()",
    ),
    (
        "spherule::scene::world::World::add_moving_shape",
        "shape",
        "s.draw::<spherule_kernel::shape::Shape>()",
    ),
    (
        "spherule::accuracy::hard_rays::export",
        "folder",
        "&s.folder()",
    ),
    (
        "spherule::accuracy::hard_rays::export",
        "rays",
        "usize::from(s.draw::<u8>())",
    ),
    ("spherule::bench::export::export", "folder", "&s.folder()"),
    ("spherule::render::cpu::render", "launch", "&s.launch()"),
    ("spherule::render::cpu::render_to", "launch", "&s.launch()"),
    ("spherule::render::gpu::render", "launch", "&s.launch()"),
    (
        "spherule::render::gpu::render_paced",
        "launch",
        "&s.launch()",
    ),
    ("spherule::render::gpu::time", "launch", "&s.launch()"),
    (
        "spherule::read::particles::pdb::parse",
        "text",
        "&s.file(\"pdb\")",
    ),
    (
        "spherule::read::particles::xyz::parse",
        "text",
        "&s.file(\"xyz\")",
    ),
    ("spherule::read::toml::parse", "text", "s.file(\"toml\")"),
    (
        "spherule::device::spirv::Module::from_bytes",
        "bytes",
        "&s.module()[..]",
    ),
];

/// Names of arguments that say how much work is done: these are small.
const WORK: &[&str] = &["bounces", "count", "height", "most", "rounds", "width"];

/// Functions that take long whatever their arguments: the largest number of calls, and the seconds
/// that one may take.
const FEW: &[(&str, u64, u64)] = &[
    // This measures the machine.
    ("spherule::bench::limit::Limit::of", 2, 20),
    // These compile the largest kernel, which takes a minute on a software adapter.
    ("spherule::render::paths::gpu::compile", 2, 240),
    ("spherule::render::paths::gpu::render", 2, 240),
];

/// Types that `src/odd.rs` makes.
const BY_HAND: &[&str] = &[
    "spherule::accuracy::cases::Case",
    "spherule::accuracy::oracle::Intersection",
    "spherule::random::Random",
    "spherule::accuracy::scene_cases::SceneCase",
    "spherule::accuracy::samples::Plan",
    "spherule::bench::measure::Plan",
    "spherule::bench::scenes::BenchScene",
    "spherule::device::buffer::Buffer",
    "spherule_kernel::precision::double::Quadratic",
    "spherule::device::spirv::Module",
    "spherule::film::Image",
    "spherule::render::gpu::Prepared",
    "spherule::render::pace::Pace",
    "spherule::render::paths::prepare::Prepared",
    "spherule::scene::Scene",
    "spherule::device::gpu::GpuOptions",
    "spherule::read::particles::ParticleFormat",
    "spherule::render::settings::Settings",
    "spherule::accel::tree::Nodes",
    "spherule::accel::tree::BuiltTree",
    "spherule::scene::world::World",
    "spherule::trace::cpu::CpuTracer",
    "spherule::trace::gpu::Batch",
    "spherule::trace::gpu::GpuTracer",
    "spherule_kernel::camera::Camera",
    "spherule_kernel::cull::cone::Cone",
    "spherule_kernel::cull::cone::Sight",
    "spherule_kernel::effects::Effects",
    "spherule_kernel::film::Accumulator",
    "spherule_kernel::film::Pixel",
    "spherule_kernel::cull::frustum::Frustum",
    "spherule_kernel::cull::frustum::Plane",
    "spherule_kernel::material::Material",
    "spherule_kernel::material::microfacet::RoughMetal",
    "spherule_kernel::material::plastic::Plastic",
    "spherule_kernel::path::random::Sampler",
    "spherule_kernel::path::random::VertexNumbers",
    "spherule_kernel::path::light_path::Path",
    "spherule_kernel::path::caustic::ball::Ball",
    "spherule_kernel::path::caustic::ways::Ways",
    "spherule_kernel::shape::Kinds",
    "spherule_kernel::shape::Shape",
    "spherule_kernel::shape::span::Span",
    "spherule_kernel::sphere::Sphere",
];

/// Types that `src/odd.rs` needs and no function takes.
const ALSO: &[&str] = &[
    "spherule::accuracy::frames::Frame",
    "spherule::accuracy::measure::RungErrors",
    "spherule::accuracy::price::Price",
    "spherule::accuracy::samples::Step",
    "spherule_kernel::film::PathLaunch",
    "spherule_kernel::light::Light",
];

/// Types that borrow, and the types in `src/odd.rs` that own their parts.
const OWNED: &[(&str, &str)] = &[
    ("spherule::render::cpu::Prepared", "OddPrepared"),
    ("spherule_kernel::path::scenery::Scenery", "OddScenery"),
    (
        "spherule_kernel::accel::brute::MovingSpheres",
        "OddMovingSpheres",
    ),
    ("spherule_kernel::accel::traversal::OneByOne", "OddOneByOne"),
    ("spherule_kernel::accel::node::Tree", "OddTree"),
    ("spherule_kernel::shape::among::Shapes", "OddShapes"),
];

/// Types whose values are written literally.
const GIVEN: &[(&str, &str)] = &[
    ("spherule::device::Device", "&spherule::Device::Cpu"),
    ("spherule::device::gpu::Gpu", "s.gpu()"),
    ("spherule::device::kernel::Kernel", "s.kernel()"),
    (
        "spherule::render::settings::Progress",
        "spherule::render::QUIET",
    ),
];

/// Types of other crates that `src/odd.rs` makes.
const FOREIGN: &[&str] = &[
    "Box", "DVec3", "Duration", "Element", "Instant", "Option", "PathBuf", "Range", "String",
    "Quat", "UVec2", "UVec3", "UVec4", "Vec", "Vec2", "Vec3", "Vec4",
];

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    let mut crates = Vec::new();
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{path}: {error}"))?;
        crates.push(serde_json::from_str(&text)?);
    }
    let mut generator = Generator::default();
    for krate in &crates {
        generator.module(krate, krate.root, &[]);
    }
    print!("{}", generator.finish()?);
    Ok(())
}

#[derive(Default)]
struct Generator<'a> {
    /// Public types by where they are defined: their public path and their item.
    types: HashMap<String, (String, &'a Crate, &'a Item)>,
    seen: BTreeSet<(String, Id)>,
    /// Public functions: where each is defined, its public path, and the type of a method.
    functions: Vec<(String, String, &'a Crate, &'a Item, Option<String>)>,
    impls: Vec<(String, &'a Crate, &'a Impl)>,
    traits: Vec<(String, &'a Crate, &'a Item)>,
    /// The entries of the tables that were needed.
    used: RefCell<BTreeSet<String>>,
}

impl<'a> Generator<'a> {
    /// Finds the public items.
    fn module(&mut self, krate: &'a Crate, id: Id, path: &[&str]) {
        let Some(item) = krate.index.get(&id) else {
            return;
        };
        let name = item.name.as_deref().unwrap_or_default();
        let mut own = path.to_vec();
        own.push(name);
        let own_path = own.join("::");
        if let ItemEnum::Use(used) = &item.inner {
            if let (Some(id), Visibility::Public) = (used.id, &item.visibility) {
                self.module(krate, id, path);
            }
            return;
        }
        if item.visibility != Visibility::Public || !self.seen.insert((krate_name(krate), id)) {
            return;
        }
        match &item.inner {
            ItemEnum::Module(module) => {
                for id in &module.items {
                    self.module(krate, *id, &own);
                }
            }
            ItemEnum::Function(it) => {
                let path = own_path.clone() + turbofish(&it.generics);
                self.functions.push((own_path, path, krate, item, None));
            }
            ItemEnum::Struct(it) => {
                let own_path = own_path + turbofish(&it.generics);
                self.of_type(krate, item, own_path, &it.impls);
            }
            ItemEnum::Enum(it) => self.of_type(krate, item, own_path, &it.impls),
            ItemEnum::Union(it) => self.of_type(krate, item, own_path, &it.impls),
            ItemEnum::Trait(_) => self.traits.push((own_path, krate, item)),
            _ => {}
        }
    }

    fn of_type(&mut self, krate: &'a Crate, item: &'a Item, path: String, impls: &'a [Id]) {
        let defined = definition(krate, item.id);
        self.types
            .insert(defined.clone(), (path.clone(), krate, item));
        for id in impls {
            let Some(Item {
                inner: ItemEnum::Impl(it),
                attrs,
                ..
            }) = krate.index.get(id)
            else {
                continue;
            };
            if it.is_synthetic || it.blanket_impl.is_some() {
                continue;
            }
            // Those of other types that name this one are listed, too.
            if let Type::ResolvedPath(of) = &it.for_
                && definition(krate, of.id) != defined
            {
                continue;
            }
            if it.trait_.is_none() {
                for id in &it.items {
                    let method = &krate.index[id];
                    if method.visibility == Visibility::Public
                        && matches!(method.inner, ItemEnum::Function(_))
                    {
                        let name = method.name.as_deref().unwrap_or_default();
                        self.functions.push((
                            format!("{defined}::{name}"),
                            format!("{path}::{name}"),
                            krate,
                            method,
                            Some(defined.clone()),
                        ));
                    }
                }
            } else if !attrs.contains(&Attribute::AutomaticallyDerived) {
                self.impls.push((defined.clone(), krate, it));
            }
        }
    }

    fn finish(self) -> Result<String> {
        let mut needed = BTreeSet::new();
        let mut calls: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let mut mistakes = Vec::new();
        for (defined, path, krate, item, of) in &self.functions {
            // A function is identified by where it is defined, and may be called by another path.
            let defined = if of.is_some() {
                defined.clone()
            } else {
                definition(krate, item.id)
            };
            let ItemEnum::Function(function) = &item.inner else {
                continue;
            };
            if function.header.is_unsafe
                || self.is_in(LEFT_OUT.iter().map(|(name, _)| *name), &defined)
            {
                continue;
            }
            if let Some((_, written)) = WRITTEN.iter().find(|(name, _)| *name == defined) {
                self.used.borrow_mut().insert(defined.clone());
                let parent = path.rsplit_once("::").map_or("", |(parent, _)| parent);
                let written = written.iter().map(|call| format!("{parent}::{call}"));
                calls.insert(defined, written.collect());
                continue;
            }
            match self.call(krate, &defined, path, function, of.as_deref(), &mut needed) {
                Ok(call) => {
                    calls.insert(defined, call);
                }
                Err(error) => mistakes.push(format!("{defined}: {error}")),
            }
        }
        for (defined, krate, it) in &self.impls {
            if self.is_in(LEFT_OUT.iter().map(|(name, _)| *name), defined) {
                continue;
            }
            if let Err(error) = self.trait_calls(krate, defined, it, &mut needed, &mut calls) {
                mistakes.push(format!("{defined}: {error}"));
            }
        }
        for (path, krate, item) in &self.traits {
            if self.is_in(LEFT_OUT.iter().map(|(name, _)| *name), path) {
                continue;
            }
            if let Err(error) = self.impls_of(path, krate, item, &mut needed, &mut calls) {
                mistakes.push(format!("{path}: {error}"));
            }
        }
        needed.extend(ALSO.iter().map(|name| (*name).to_string()));
        let few = FEW
            .iter()
            .map(|row| row.0)
            .filter(|name| calls.contains_key(*name));
        self.used.borrow_mut().extend(few.map(String::from));
        let odd = self.odd_types(needed, &mut mistakes);
        let used = self.used.borrow();
        let tables = (LEFT_OUT.iter().map(|row| row.0))
            .chain(WRITTEN.iter().map(|row| row.0))
            .chain(ARGUMENTS.iter().map(|row| row.0))
            .chain(FEW.iter().map(|row| row.0))
            .chain(BY_HAND.iter().copied())
            .chain(OWNED.iter().map(|row| row.0));
        for name in tables {
            if !used.contains(name) {
                mistakes.push(format!(
                    "{name}: in a table of the generator, but not needed"
                ));
            }
        }
        if !mistakes.is_empty() {
            return Err(format!(
                "say in tests/every-function/src/bin/generate.rs how these are called, or why they are not:\n{}",
                mistakes.join("\n")
            )
            .into());
        }
        Ok(write(&calls, &odd))
    }

    fn is_in(&self, mut names: impl Iterator<Item = &'static str>, name: &str) -> bool {
        let found = names.any(|one| one == name);
        if found {
            self.used.borrow_mut().insert(name.into());
        }
        found
    }

    /// Makes the calls of a function.
    fn call(
        &self,
        krate: &Crate,
        defined: &str,
        path: &str,
        function: &Function,
        of: Option<&str>,
        needed: &mut BTreeSet<String>,
    ) -> Result<Vec<String>> {
        let mut calls = vec![String::new()];
        for (name, ty) in &function.sig.inputs {
            let given = ARGUMENTS
                .iter()
                .find(|(function, argument, _)| *function == defined && argument == name);
            let choices = if let Some((_, _, given)) = given {
                self.used.borrow_mut().insert(defined.into());
                vec![(*given).into()]
            } else if WORK.contains(&name.as_str())
                && matches!(ty, Type::Primitive(name) if name.starts_with('u'))
            {
                vec!["s.few()".into()]
            } else {
                self.argument(krate, ty, &function.generics, of, needed)?
            };
            calls = calls
                .iter()
                .flat_map(|call| {
                    choices
                        .iter()
                        .map(move |choice| format!("{call}{choice}, "))
                })
                .collect();
        }
        Ok(calls
            .into_iter()
            .map(|arguments| format!("{path}({})", arguments.trim_end_matches(", ")))
            .collect())
    }

    /// Makes the expressions for an argument.
    fn argument(
        &self,
        krate: &Crate,
        ty: &Type,
        generics: &Generics,
        of: Option<&str>,
        needed: &mut BTreeSet<String>,
    ) -> Result<Vec<String>> {
        let one = |expression: &str| Ok(vec![expression.to_string()]);
        let name_of = |ty: &Type| match ty {
            Type::ResolvedPath(path) => Some(definition(krate, path.id)),
            Type::Generic(name) if name == "Self" => of.map(String::from),
            _ => None,
        };
        let known = |ty: &Type| {
            let name = name_of(ty)?;
            let owned = OWNED.iter().find(|(owned, _)| *owned == name);
            if owned.is_some() {
                self.used.borrow_mut().insert(name.clone());
            }
            let given = GIVEN.iter().find(|(given, _)| *given == name);
            given
                .map(|(_, given)| (*given).to_string())
                .or(owned.map(|(_, owner)| format!("s.draw::<odd::{owner}>().get()")))
        };
        match ty {
            Type::BorrowedRef {
                is_mutable, type_, ..
            } => {
                let mutable = if *is_mutable { "mut " } else { "" };
                match &**type_ {
                    Type::Slice(of_what) => {
                        self.need(krate, of_what, needed)?;
                        Ok(vec![format!("&{mutable}s.many()[..]")])
                    }
                    Type::Primitive(name) if name == "str" => one("&s.text()"),
                    Type::ResolvedPath(path) if path.path.ends_with("Path") => one("&s.path()"),
                    Type::Generic(name)
                        if ["Spheres", "Primitives"]
                            .iter()
                            .any(|known| bounds(generics, name).contains(*known)) =>
                    {
                        Ok(vec![
                            "&s.many::<spherule_kernel::Sphere>()[..]".into(),
                            "&s.draw::<odd::OddMovingSpheres>().get()".into(),
                        ])
                    }
                    inner => {
                        if let Some(known) = known(inner) {
                            let borrow = if known.starts_with("s.draw") { "&" } else { "" };
                            return Ok(vec![format!("{borrow}{mutable}{known}")]);
                        }
                        self.need_of(krate, inner, of, needed)?;
                        Ok(vec![format!("&{mutable}s.draw()")])
                    }
                }
            }
            Type::ImplTrait(bounds) => match bounds.first() {
                Some(GenericBound::TraitBound { trait_, .. }) if trait_.path == "AsRef" => {
                    one("s.path()")
                }
                Some(GenericBound::TraitBound { trait_, .. })
                    if trait_.path.ends_with("Motion") =>
                {
                    one("spherule_kernel::shape::among::Resting")
                }
                Some(GenericBound::TraitBound { trait_, .. }) if trait_.path == "Into" => {
                    one("s.draw::<spherule::render::Settings>()")
                }
                _ => Err("an argument of any type with an unknown trait".into()),
            },
            Type::ResolvedPath(path) if path.path == "Option" => {
                let inner = first_argument(path.args.as_deref());
                if let Some(Type::BorrowedRef { type_, .. }) = inner {
                    self.need_of(krate, type_, of, needed)?;
                    return one("Some(&s.draw())");
                }
                self.need(krate, ty, needed)?;
                one("s.draw()")
            }
            _ => {
                if let Some(known) = known(ty) {
                    return Ok(vec![known]);
                }
                self.need_of(krate, ty, of, needed)?;
                one("s.draw()")
            }
        }
    }

    fn need_of(
        &self,
        krate: &Crate,
        ty: &Type,
        of: Option<&str>,
        needed: &mut BTreeSet<String>,
    ) -> Result<()> {
        match (ty, of) {
            (Type::Generic(name), Some(of)) if name == "Self" => {
                needed.insert(of.into());
                Ok(())
            }
            _ => self.need(krate, ty, needed),
        }
    }

    /// Notes that values of a type must be made.
    fn need(&self, krate: &Crate, ty: &Type, needed: &mut BTreeSet<String>) -> Result<()> {
        match ty {
            Type::Primitive(name) if name != "never" => Ok(()),
            Type::Array { type_, .. } | Type::Slice(type_) => self.need(krate, type_, needed),
            Type::Tuple(types) => types.iter().try_for_each(|ty| self.need(krate, ty, needed)),
            Type::BorrowedRef { type_, .. }
                if matches!(&**type_, Type::Primitive(name) if name == "str")
                    || matches!(&**type_, Type::ResolvedPath(path) if path.path.ends_with("Element")) =>
            {
                Ok(())
            }
            Type::ResolvedPath(path) => {
                let name = path.path.rsplit("::").next().unwrap_or_default();
                if FOREIGN.contains(&name) {
                    return match first_argument(path.args.as_deref()) {
                        Some(inner) => self.need(krate, inner, needed),
                        None => Ok(()),
                    };
                }
                needed.insert(definition(krate, path.id));
                Ok(())
            }
            // A generic type is a number, or chosen by the call.
            Type::Generic(_) => Ok(()),
            _ => Err(format!("no way is known to make {ty:?}").into()),
        }
    }

    /// Makes calls of the methods of other crates' traits that are implemented by hand.
    fn trait_calls(
        &self,
        krate: &Crate,
        defined: &str,
        it: &Impl,
        needed: &mut BTreeSet<String>,
        calls: &mut BTreeMap<String, Vec<String>>,
    ) -> Result<()> {
        let Some(of) = &it.trait_ else { return Ok(()) };
        let is_ours = definition(krate, of.id).starts_with("spherule");
        if is_ours || it.is_unsafe || !it.items.iter().any(|id| is_function(krate, *id)) {
            return Ok(());
        }
        let path = &self.types[defined].0;
        let owner = OWNED.iter().find(|(owned, _)| *owned == defined);
        let value = match owner {
            Some((_, owner)) => format!("s.draw::<odd::{owner}>().get()"),
            None => format!("s.draw::<{path}>()"),
        };
        let name = of.path.rsplit("::").next().unwrap_or_default();
        let call = match name {
            "Display" => format!("{value}.to_string()"),
            "Debug" => format!("format!(\"{{:?}}\", {value})"),
            "Deref" => format!("std::ops::Deref::deref(&{value})"),
            "Error" => format!("std::error::Error::source(&{value})"),
            "Drop" => format!("drop({value})"),
            // Its functions are unsafe.
            "GlobalAlloc" => return Ok(()),
            "Default" => format!("<{path} as Default>::default()"),
            "FromStr" => format!("s.text().parse::<{path}>()"),
            "From" => {
                let from = first_argument(of.args.as_deref()).ok_or("From what?")?;
                self.need(krate, from, needed)?;
                format!(
                    "<{path} as From<{}>>::from(s.draw())",
                    self.spell(krate, from)?
                )
            }
            _ => return Err(format!("unknown trait: {name}").into()),
        };
        if !matches!(name, "Default" | "FromStr" | "From") && owner.is_none() {
            needed.insert(defined.into());
        }
        calls
            .entry(format!("{defined} as {name}"))
            .or_default()
            .push(call);
        Ok(())
    }

    /// Makes calls of the methods of our own traits, on every type that implements them.
    fn impls_of(
        &self,
        path: &str,
        krate: &Crate,
        item: &Item,
        needed: &mut BTreeSet<String>,
        calls: &mut BTreeMap<String, Vec<String>>,
    ) -> Result<()> {
        let ItemEnum::Trait(of) = &item.inner else {
            return Ok(());
        };
        for id in &of.implementations {
            let Some(Item {
                inner: ItemEnum::Impl(it),
                ..
            }) = krate.index.get(id)
            else {
                continue;
            };
            let on = self.spell(krate, &it.for_)?;
            for id in &it.items {
                let method = &krate.index[id];
                let (ItemEnum::Function(function), Some(name)) = (&method.inner, &method.name)
                else {
                    continue;
                };
                if function.header.is_unsafe
                    || self.is_in(
                        LEFT_OUT.iter().map(|(name, _)| *name),
                        &format!("{path}::{name}"),
                    )
                {
                    continue;
                }
                let mut function = function.clone();
                for (name, ty) in &mut function.sig.inputs {
                    if let (true, Type::BorrowedRef { type_, .. }) = (name == "self", ty) {
                        **type_ = it.for_.clone();
                    }
                }
                let key = format!("{on} as {path}::{name}");
                let call = self.call(
                    krate,
                    &key,
                    &format!("<{on} as {path}>::{name}"),
                    &function,
                    None,
                    needed,
                )?;
                calls.insert(key, call);
            }
        }
        Ok(())
    }

    /// A type as it is written in calls.rs.
    fn spell(&self, krate: &Crate, ty: &Type) -> Result<String> {
        Ok(match ty {
            Type::Primitive(name) => name.clone(),
            Type::Generic(_) => NUMBER.into(),
            Type::Slice(inner) => format!("[{}]", self.spell(krate, inner)?),
            Type::Tuple(types) => {
                let types: Result<Vec<_>> = types.iter().map(|ty| self.spell(krate, ty)).collect();
                format!("({})", types?.join(", "))
            }
            Type::ResolvedPath(path) if path.path == "Box" => {
                match first_argument(path.args.as_deref()) {
                    Some(inner) => format!("Box<{}>", self.spell(krate, inner)?),
                    None => return Err("a box of what?".into()),
                }
            }
            Type::ResolvedPath(path) => {
                let defined = definition(krate, path.id);
                let (public, ..) = self
                    .types
                    .get(&defined)
                    .ok_or(format!("{defined} is not public"))?;
                public.clone()
            }
            _ => return Err(format!("no spelling for {ty:?}").into()),
        })
    }

    /// Writes how calls.rs makes types with public fields, field by field.
    fn odd_types(&self, needed: BTreeSet<String>, mistakes: &mut Vec<String>) -> Vec<String> {
        let mut written = Vec::new();
        let mut done = BTreeSet::new();
        let mut left: Vec<String> = needed.into_iter().collect();
        while let Some(defined) = left.pop() {
            if !done.insert(defined.clone()) || self.is_in(BY_HAND.iter().copied(), &defined) {
                continue;
            }
            match self.odd_type(&defined) {
                Ok((text, more)) => {
                    written.push(text);
                    left.extend(more);
                }
                Err(error) => mistakes.push(format!("{defined}: {error}")),
            }
        }
        written.sort();
        written
    }

    fn odd_type(&self, defined: &str) -> Result<(String, BTreeSet<String>)> {
        let (path, krate, item) = self.types.get(defined).ok_or("no public type")?;
        let mut needed = BTreeSet::new();
        let fields = |ids: &[Id], needed: &mut BTreeSet<String>| -> Result<String> {
            let mut text = String::new();
            for id in ids {
                let field = krate.index.get(id).ok_or("a private field")?;
                let ItemEnum::StructField(ty) = &field.inner else {
                    return Err("an item that is not a field".into());
                };
                self.need(krate, ty, needed)?;
                let name = field.name.as_deref().unwrap_or_default();
                write!(text, "{name}: Odd::odd(s), ")?;
            }
            Ok(text)
        };
        let body = match &item.inner {
            ItemEnum::Struct(it) => match &it.kind {
                StructKind::Unit => path.clone(),
                StructKind::Plain {
                    fields: ids,
                    has_stripped_fields: false,
                } => format!("{path} {{ {} }}", fields(ids, &mut needed)?),
                _ => return Err("has private fields: make it in src/odd.rs".into()),
            },
            ItemEnum::Enum(it) => {
                let mut text = format!("match s.below({}) {{", it.variants.len());
                for (index, id) in it.variants.iter().enumerate() {
                    let variant = &krate.index[id];
                    let ItemEnum::Variant(kind) = &variant.inner else {
                        return Err("an item that is not a variant".into());
                    };
                    let name = variant.name.as_deref().unwrap_or_default();
                    let made = match &kind.kind {
                        VariantKind::Plain => String::new(),
                        VariantKind::Tuple(ids) => {
                            let ids: Vec<Id> = ids.iter().flatten().copied().collect();
                            fields(&ids, &mut needed)?;
                            format!("({})", vec!["Odd::odd(s)"; ids.len()].join(", "))
                        }
                        VariantKind::Struct { fields: ids, .. } => {
                            format!("{{ {} }}", fields(ids, &mut needed)?)
                        }
                    };
                    let at = if index + 1 == it.variants.len() {
                        "_".into()
                    } else {
                        index.to_string()
                    };
                    write!(text, "{at} => {path}::{name}{made},")?;
                }
                text + "}"
            }
            _ => return Err("neither a struct nor an enum".into()),
        };
        let source = if body.contains("(s)") || body.contains("s.below") {
            "s"
        } else {
            "_"
        };
        Ok((
            format!(
                "impl Odd for {path} {{ fn odd({source}: &mut Source) -> Self {{ {body} }} }}\n"
            ),
            needed,
        ))
    }
}

/// The type argument for functions that are generic over lanes.
fn turbofish(generics: &Generics) -> &'static str {
    use rustdoc_types::GenericParamDefKind;
    let is_lane = |kind: &GenericParamDefKind| matches!(kind, GenericParamDefKind::Type { .. });
    let has_lanes = generics
        .params
        .iter()
        .any(|param| param.name == "L" && is_lane(&param.kind));
    // As [`NUMBER`].
    if has_lanes { "::<f32>" } else { "" }
}

fn krate_name(krate: &Crate) -> String {
    krate.index[&krate.root].name.clone().unwrap_or_default()
}

/// Where something is defined.
fn definition(krate: &Crate, id: Id) -> String {
    krate
        .paths
        .get(&id)
        .map(|summary| summary.path.join("::"))
        .unwrap_or_default()
}

fn is_function(krate: &Crate, id: Id) -> bool {
    krate
        .index
        .get(&id)
        .is_some_and(|item| matches!(item.inner, ItemEnum::Function(_)))
}

fn first_argument(args: Option<&GenericArgs>) -> Option<&Type> {
    let Some(GenericArgs::AngleBracketed { args, .. }) = args else {
        return None;
    };
    args.iter().find_map(|arg| match arg {
        GenericArg::Type(ty) => Some(ty),
        _ => None,
    })
}

/// The traits that a generic argument must implement.
fn bounds(generics: &Generics, name: &str) -> BTreeSet<String> {
    use rustdoc_types::GenericParamDefKind;
    let own = generics
        .params
        .iter()
        .filter(|param| param.name == name)
        .flat_map(|param| match &param.kind {
            GenericParamDefKind::Type { bounds, .. } => bounds.clone(),
            _ => Vec::new(),
        });
    let others = generics.where_predicates.iter().flat_map(|one| match one {
        WherePredicate::BoundPredicate { type_, bounds, .. }
            if *type_ == Type::Generic(name.into()) =>
        {
            bounds.clone()
        }
        _ => Vec::new(),
    });
    own.chain(others)
        .filter_map(|bound| match bound {
            GenericBound::TraitBound { trait_, .. } => Some(trait_.path),
            _ => None,
        })
        .collect()
}

fn write(calls: &BTreeMap<String, Vec<String>>, odd: &[String]) -> String {
    let mut text = String::from(
        "//! Made by `generate` out of rustdoc's JSON: tests/every-function/run --generate.\n\n#![expect(\n    clippy::semicolon_if_nothing_returned,\n    clippy::unit_arg,\n    reason = \"a call is one expression\"\n)]\n#![expect(clippy::too_many_lines, reason = \"an enum has as many variants as it has\")]\n\nuse crate::odd::{self, Odd, Source};\nuse crate::{Call, seen};\n\n/// A call of each public function.\npub const CALLS: &[Call] = &[\n",
    );
    for (name, calls) in calls {
        for (index, call) in calls.iter().enumerate() {
            let number = if calls.len() > 1 {
                format!("#{index}")
            } else {
                String::new()
            };
            let source = if call.contains("s.") && call.replace("::", "").contains("s.") {
                "s"
            } else {
                "_"
            };
            let needs_gpu = call.contains("s.gpu()")
                || call.contains("s.kernel()")
                || name.contains("gpu::GpuTracer")
                || name.contains("buffer::Buffer");
            let on_gpu = if needs_gpu { ".on_gpu()" } else { "" };
            let few = FEW
                .iter()
                .find(|(few, ..)| few == name)
                .map_or(String::new(), |(_, most, seconds)| {
                    format!(".at_most({most}, {seconds})")
                });
            let _ = writeln!(
                text,
                "Call::new(\"{name}{number}\", |{source}| seen({call})){on_gpu}{few},"
            );
        }
    }
    text += "];\n\n";
    for one in odd {
        text += one;
        text += "\n";
    }
    text
}
