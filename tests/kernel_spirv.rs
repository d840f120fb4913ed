//! The committed SPIR-V: it is what the sources compile to, and has the host's memory layout.
//!
//! With the feature `compile-kernel` the sources have just been compiled, and the test compares the
//! modules bit by bit. `SPHERULE_RENEW_KERNEL=1` overwrites the committed modules with the compiled
//! ones.

use std::collections::{BTreeMap, HashSet};

use spherule::device::Module;
use spherule::kernel::{probe::layout, spirv};
use spherule_kernel::{Effects, Rung};

#[cfg(feature = "compile-kernel")]
#[test]
fn committed_modules_are_the_output_of_the_sources() {
    use std::path::Path;

    let compiled = Path::new(env!("OUT_DIR")).join("spirv");
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernel/spirv");
    for file in ["f32.spv", "f64.spv", "manifest.toml"] {
        let fresh = std::fs::read(compiled.join(file)).expect("the build script wrote it");
        if std::env::var_os("SPHERULE_RENEW_KERNEL").is_some_and(|value| value != "0") {
            std::fs::write(committed.join(file), &fresh)
                .expect("the kernel's folder can be written");
            continue;
        }
        let old = std::fs::read(committed.join(file)).unwrap_or_default();
        assert!(
            fresh == old,
            "kernel/spirv/{file} is not what the sources compile to; SPHERULE_RENEW_KERNEL=1 renews it"
        );
    }
}

#[test]
fn the_manifest_names_the_committed_modules() {
    let manifest: toml::Table = spirv::MANIFEST.parse().expect("the manifest is TOML");
    for (name, bytes) in [("f32", spirv::F32), ("f64", spirv::F64)] {
        let module = manifest[name].as_table().expect("a table for the module");
        assert_eq!(module["bytes"].as_integer(), Some(bytes.len() as i64));
    }
}

#[test]
fn the_modules_have_the_entry_points_that_the_host_calls() {
    for (bytes, needs_f64) in [(spirv::F32, false), (spirv::F64, true)] {
        let module = Module::from_bytes("committed", bytes).expect("a module");
        let mut names: Vec<&str> = module
            .entry_points()
            .iter()
            .map(|entry| entry.name.as_str())
            .collect();
        names.sort_unstable();
        let mut expected = vec![
            "cross_boundaries",
            "find_surfaces",
            "intersect_pairs",
            "intersect_shapes",
            "make_camera_rays",
            "measure_arithmetic",
            "measure_copying",
            "measure_layout",
            "measure_multiplications",
            "occlude_rays",
            "occlude_rays_in_tree",
            "render",
            "render_by_tiles",
            "render_shapes",
            "shade_hits",
            "trace_paths",
            "trace_rays",
            "trace_rays_in_tree",
            "walk_inside_spheres",
        ];
        if needs_f64 {
            expected.push("measure_wide_arithmetic");
            expected.push("measure_wide_multiplications");
            expected.sort_unstable();
        }
        assert_eq!(names, expected);
        assert_eq!(module.needs_f64(), needs_f64);
    }
}

/// Every struct with several members in a buffer of the module must be one of the shared types,
/// with the offsets that rustc gives it. Every array's stride must be a shared type's size. Structs
/// that are in no buffer do not matter.
#[test]
fn the_modules_offsets_are_the_hosts() {
    for bytes in [spirv::F32, spirv::F64] {
        check_offsets(bytes);
    }
}

fn check_offsets(bytes: &[u8]) {
    let found = Buffers::of(bytes);
    let value = layout_of_host();
    let has_f64 = Module::from_bytes("committed", bytes).is_ok_and(|module| module.needs_f64());
    let expected = offsets_of_host(&value, has_f64);
    assert!(!found.structs.is_empty());
    for offsets in &found.structs {
        assert!(
            expected.contains(offsets),
            "no shared type has the offsets {offsets:?}"
        );
    }
    for offsets in &expected {
        assert!(
            found.structs.contains(offsets),
            "the module has no struct with {offsets:?}"
        );
    }
    let sizes: Vec<u32> = layout::NAMES
        .iter()
        .filter(|entry| entry.starts_with("size of "))
        .map(|entry| value[entry])
        .chain([size_of::<u32>() as u32])
        .collect();
    assert!(!found.strides.is_empty());
    for stride in found.strides {
        assert!(sizes.contains(&stride), "no shared type has {stride} bytes");
    }
}

/// What a module says of the types that its buffers hold.
struct Buffers {
    /// The offsets of the members of each struct that has several.
    structs: Vec<Vec<u32>>,
    /// The strides of the arrays.
    strides: Vec<u32>,
}

impl Buffers {
    fn of(bytes: &[u8]) -> Self {
        const MEMBER_DECORATE: u32 = 72;
        const DECORATE: u32 = 71;
        const OFFSET: u32 = 35;
        const ARRAY_STRIDE: u32 = 6;
        const BLOCK: u32 = 2;
        const TYPE_ARRAY: u32 = 28;
        const TYPE_RUNTIME_ARRAY: u32 = 29;
        const TYPE_STRUCT: u32 = 30;
        let words: Vec<u32> = bytes
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut in_buffers: Vec<u32> = Vec::new();
        let mut structs: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut strides = Vec::new();
        let mut at = 5;
        while at < words.len() {
            let (count, opcode) = ((words[at] >> 16) as usize, words[at] & 0xffff);
            match (opcode, &words[at + 1..at + count]) {
                (MEMBER_DECORATE, [id, _member, OFFSET, offset]) => {
                    structs.entry(*id).or_default().push(*offset);
                }
                (DECORATE, [id, ARRAY_STRIDE, stride]) => strides.push((*id, *stride)),
                (DECORATE, [id, BLOCK]) => in_buffers.push(*id),
                (TYPE_STRUCT, [id, members @ ..]) => {
                    parts.insert(*id, members.to_vec());
                }
                (TYPE_RUNTIME_ARRAY, [id, element]) | (TYPE_ARRAY, [id, element, _]) => {
                    parts.insert(*id, vec![*element]);
                }
                _ => {}
            }
            at += count;
        }

        // All types in buffers, down to the last member.
        let mut index = 0;
        while index < in_buffers.len() {
            let inner = parts.get(&in_buffers[index]).cloned().unwrap_or_default();
            in_buffers.extend(inner);
            index += 1;
        }
        structs.retain(|id, offsets| in_buffers.contains(id) && offsets.len() > 1);
        strides.retain(|(id, _)| in_buffers.contains(id));
        Self {
            structs: structs.into_values().collect(),
            strides: strides.into_iter().map(|(_, stride)| stride).collect(),
        }
    }
}

/// The offsets of the members of the shared types, by rustc's layout, as a module states them.
fn offsets_of_host(value: &BTreeMap<&str, u32>, has_f64: bool) -> Vec<Vec<u32>> {
    let fields = |name: &str| -> Vec<u32> {
        let prefix = format!("{name}.");
        let mut offsets: Vec<u32> = layout::NAMES
            .iter()
            .filter(|entry| entry.starts_with(&prefix))
            .map(|entry| value[entry])
            .collect();
        offsets.sort_unstable();
        offsets
    };
    // In the module, padding is a member, too.
    let mut expected: Vec<Vec<u32>> = vec![
        fields("Operands"),
        fields("Outcome"),
        fields("Ray"),
        fields("Hit"),
        fields("Launch"),
        fields("Incidence"),
        fields("Fresnel"),
        fields("Walk"),
        with_padding(&fields("Camera"), 12),
        fields("Material"),
        // These have their padding at the end.
        [fields("Light"), vec![44]].concat(),
        [fields("Sky"), vec![72]].concat(),
        [fields("Fog"), vec![36, 40]].concat(),
        [fields("Filter"), vec![8]].concat(),
        [fields("PathLaunch"), vec![316]].concat(),
        [vec![0], fields("Shape")].concat(),
        fields("Accumulator"),
        fields("Node"),
    ];
    if has_f64 {
        expected.push(fields("WideOutcome"));
    }
    expected
}

fn layout_of_host() -> BTreeMap<&'static str, u32> {
    let mut table = vec![0; layout::COUNT];
    layout::write(&mut table);
    layout::NAMES.iter().copied().zip(table).collect()
}

/// Adds padding after each field, at its offset plus `size`.
fn with_padding(offsets: &[u32], size: u32) -> Vec<u32> {
    offsets
        .iter()
        .flat_map(|offset| [*offset, offset + size])
        .collect()
}

/// A module reduced to one entry point is a valid module, without what only the others need.
#[test]
fn a_module_reduced_to_one_entry_point_has_only_what_that_needs() {
    const ENTRY_POINT: u32 = 15;
    const FUNCTION: u32 = 54;
    const VARIABLE: u32 = 59;
    const DECORATE: u32 = 71;
    const WORKGROUP: u32 = 4;
    for (bytes, is_f32) in [(spirv::F32, true), (spirv::F64, false)] {
        let module = Module::from_bytes("committed", bytes).expect("a module");
        for entry in module.entry_points() {
            let name = &entry.name;
            let only = module.only(name);
            assert_eq!(only.entry_points(), std::slice::from_ref(entry));
            assert_eq!(only.only(name).words(), only.words());
            let (mut entries, mut functions, mut shared) = (0, 0, 0);
            let mut decorated = Vec::new();
            let mut named: HashSet<u32> = HashSet::new();
            let mut at = 5;
            while at < only.words().len() {
                let count = (only.words()[at] >> 16) as usize;
                let operands = &only.words()[at + 1..at + count];
                match only.words()[at] & 0xffff {
                    ENTRY_POINT => entries += 1,
                    FUNCTION => functions += 1,
                    VARIABLE if operands[2] == WORKGROUP => shared += 1,
                    DECORATE => decorated.push(operands[0]),
                    _ => {}
                }
                if only.words()[at] & 0xffff != DECORATE {
                    named.extend(operands.iter().copied());
                }
                at += count;
            }
            assert_eq!((entries, functions), (1, 1), "{name}");
            assert_eq!(shared > 0, name == "render_by_tiles", "{name}");
            assert!(decorated.iter().all(|id| named.contains(id)), "{name}");
            if is_f32 {
                let naga = wgpu::naga::front::spv::parse_u8_slice(
                    bytemuck::cast_slice(only.words()),
                    &wgpu::naga::front::spv::Options::default(),
                );
                assert_eq!(naga.expect("a module").entry_points.len(), 1);
            }
        }
    }
    let module = Module::from_bytes("committed", spirv::F32).expect("a module");
    assert_eq!(module.only("none").words(), module.words());
}

/// A module whose constants are folded is a valid module without specialisation constants, and
/// holds a fraction of the code.
#[test]
fn a_folded_module_has_only_what_its_constants_ask_for() {
    const SPEC_CONSTANT: u32 = 50;
    let sets = [
        Effects::NONE,
        Effects::ANTIALIASING.and(Effects::HEADLAMP),
        Effects::ANTIALIASING
            .and(Effects::SOFT_SHADOWS)
            .and(Effects::EMISSION)
            .and(Effects::INTERREFLECTION),
        Effects::GLASS.and(Effects::NESTED_GLASS).and(Effects::FOG),
        Effects::CAUSTICS
            .and(Effects::GLASS)
            .and(Effects::SOFT_SHADOWS)
            .and(Effects::MANY_LIGHTS),
        Effects::ALL,
    ];
    for (bytes, is_f32) in [(spirv::F32, true), (spirv::F64, false)] {
        let module = Module::from_bytes("committed", bytes).expect("a module");
        for entry in module.entry_points() {
            let has_effects = entry.name == "trace_paths";
            for set in &sets[..if has_effects { sets.len() } else { 1 }] {
                for rung in Rung::ALL {
                    if is_f32 && rung == Rung::Double {
                        continue;
                    }
                    let constants = [
                        (Rung::SPEC_ID, rung.to_u32()),
                        (Effects::SPEC_ID, set.to_bits()),
                        (Effects::IS_EXACT_SPEC_ID, 1),
                    ];
                    let special = constants
                        .into_iter()
                        .fold(module.clone(), |module, (id, to)| {
                            module.specialise(id, to).expect("it has this constant")
                        });
                    let only = special.only(&entry.name);
                    let folded = only.folded();
                    let what = format!("{}, {rung:?}, {:#x}", entry.name, set.to_bits());
                    let bytes = bytemuck::cast_slice(folded.words());
                    let again = Module::from_bytes("folded", bytes).expect("a module");
                    assert_eq!(again.entry_points(), std::slice::from_ref(entry), "{what}");
                    assert!(folded.words().len() <= only.words().len(), "{what}");
                    if has_effects && *set != Effects::ALL {
                        let share = folded.words().len() as f32 / only.words().len() as f32;
                        assert!(share < 0.4, "{what}: {share} of the words are left");
                    }
                    assert!(count(&only, SPEC_CONSTANT) > 0, "{what}");
                    assert_eq!(count(&folded, SPEC_CONSTANT), 0, "{what}");
                    assert!(
                        folded.clone().specialise(Rung::SPEC_ID, 0).is_err(),
                        "{what}"
                    );
                    if is_f32 {
                        let naga = wgpu::naga::front::spv::parse_u8_slice(
                            bytes,
                            &wgpu::naga::front::spv::Options::default(),
                        )
                        .unwrap_or_else(|error| panic!("{what}: {error}"));
                        wgpu::naga::valid::Validator::new(
                            wgpu::naga::valid::ValidationFlags::all(),
                            wgpu::naga::valid::Capabilities::all(),
                        )
                        .validate(&naga)
                        .unwrap_or_else(|error| panic!("{what}: {error}"));
                    }
                }
            }
        }
    }
}

/// How many instructions of a kind a module has.
fn count(module: &Module, opcode: u32) -> usize {
    let (words, mut at, mut found) = (module.words(), 5, 0);
    while at < words.len() {
        found += usize::from(words[at] & 0xffff == opcode);
        at += (words[at] >> 16) as usize;
    }
    found
}
