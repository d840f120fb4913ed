//! [`Module`]: SPIR-V words, checked for structure, and specialised before they reach a driver.
//!
//! A driver may crash on words that are not a module, and wgpu does not check what it passes
//! through. So the structure is checked here: the header, the length of each instruction, and what
//! the host relies on (entry points, workgroup sizes, specialisation constants).

mod fold;
mod loops;
mod written;

use std::collections::{HashMap, HashSet};
use std::fmt;

use super::buffer::Access;
use crate::error::{Error, Result};

const MAGIC: u32 = 0x0723_0203;
const HEADER_WORDS: usize = 5;

/// Opcodes, storage classes and decorations from the SPIR-V specification.
mod op {
    pub(super) const NOP: u32 = 0;
    pub(super) const UNDEF: u32 = 1;
    pub(super) const NAME: u32 = 5;
    pub(super) const LINE: u32 = 8;
    pub(super) const EXT_INST: u32 = 12;
    pub(super) const ENTRY_POINT: u32 = 15;
    pub(super) const EXECUTION_MODE: u32 = 16;
    pub(super) const CAPABILITY: u32 = 17;
    pub(super) const TYPE_BOOL: u32 = 20;
    pub(super) const TYPE_INT: u32 = 21;
    pub(super) const CONSTANT_TRUE: u32 = 41;
    pub(super) const CONSTANT_FALSE: u32 = 42;
    pub(super) const CONSTANT: u32 = 43;
    pub(super) const SPEC_CONSTANT_TRUE: u32 = 48;
    pub(super) const SPEC_CONSTANT_FALSE: u32 = 49;
    pub(super) const SPEC_CONSTANT: u32 = 50;
    pub(super) const FUNCTION: u32 = 54;
    pub(super) const FUNCTION_PARAMETER: u32 = 55;
    pub(super) const FUNCTION_END: u32 = 56;
    pub(super) const FUNCTION_CALL: u32 = 57;
    pub(super) const VARIABLE: u32 = 59;
    pub(super) const LOAD: u32 = 61;
    pub(super) const STORE: u32 = 62;
    pub(super) const COPY_MEMORY: u32 = 63;
    pub(super) const ACCESS_CHAIN: u32 = 65;
    pub(super) const IN_BOUNDS_ACCESS_CHAIN: u32 = 66;
    pub(super) const ARRAY_LENGTH: u32 = 68;
    pub(super) const DECORATE: u32 = 71;
    pub(super) const I_ADD: u32 = 128;
    pub(super) const I_SUB: u32 = 130;
    pub(super) const I_MUL: u32 = 132;
    pub(super) const LOGICAL_EQUAL: u32 = 164;
    pub(super) const LOGICAL_NOT_EQUAL: u32 = 165;
    pub(super) const LOGICAL_OR: u32 = 166;
    pub(super) const LOGICAL_AND: u32 = 167;
    pub(super) const LOGICAL_NOT: u32 = 168;
    pub(super) const SELECT: u32 = 169;
    pub(super) const I_EQUAL: u32 = 170;
    pub(super) const I_NOT_EQUAL: u32 = 171;
    pub(super) const U_GREATER_THAN: u32 = 172;
    pub(super) const U_GREATER_THAN_EQUAL: u32 = 174;
    pub(super) const U_LESS_THAN: u32 = 176;
    pub(super) const U_LESS_THAN_EQUAL: u32 = 178;
    pub(super) const SHIFT_RIGHT_LOGICAL: u32 = 194;
    pub(super) const SHIFT_LEFT_LOGICAL: u32 = 196;
    pub(super) const BITWISE_OR: u32 = 197;
    pub(super) const BITWISE_XOR: u32 = 198;
    pub(super) const BITWISE_AND: u32 = 199;
    pub(super) const NOT: u32 = 200;
    pub(super) const CONTROL_BARRIER: u32 = 224;
    pub(super) const MEMORY_BARRIER: u32 = 225;
    pub(super) const ATOMIC_STORE: u32 = 228;
    pub(super) const PHI: u32 = 245;
    pub(super) const LOOP_MERGE: u32 = 246;
    pub(super) const SELECTION_MERGE: u32 = 247;
    pub(super) const LABEL: u32 = 248;
    pub(super) const BRANCH: u32 = 249;
    pub(super) const BRANCH_CONDITIONAL: u32 = 250;
    pub(super) const SWITCH: u32 = 251;
    pub(super) const UNREACHABLE: u32 = 255;
    pub(super) const NO_LINE: u32 = 317;
    pub(super) const DECORATION_SPEC_ID: u32 = 1;
    pub(super) const DECORATION_NON_WRITABLE: u32 = 24;
    pub(super) const DECORATION_BINDING: u32 = 33;
    pub(super) const CLASS_UNIFORM: u32 = 2;
    pub(super) const CLASS_STORAGE_BUFFER: u32 = 12;
    pub(super) const MODE_LOCAL_SIZE: u32 = 17;
    pub(super) const MODEL_GL_COMPUTE: u32 = 5;
    pub(super) const CAPABILITY_FLOAT64: u32 = 10;

    /// The id that an instruction of a function defines, or may define if it is none that is known.
    pub(super) fn may_define(opcode: u32, operands: &[u32]) -> Option<u32> {
        match opcode {
            LABEL => operands.first().copied(),
            NOP
            | LINE
            | NO_LINE
            | FUNCTION_END
            | STORE
            | COPY_MEMORY
            | ATOMIC_STORE
            | CONTROL_BARRIER
            | MEMORY_BARRIER
            | LOOP_MERGE
            | SELECTION_MERGE
            | BRANCH..=UNREACHABLE => None,
            _ => operands.get(1).copied(),
        }
    }
}

/// A compute entry point of a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// Its name.
    pub name: String,
    /// Threads in a workgroup along x, y and z.
    pub workgroup_size: [u32; 3],
}

/// A SPIR-V module whose structure has been checked.
#[derive(Clone)]
pub struct Module {
    name: String,
    words: Vec<u32>,
    entry_points: Vec<EntryPoint>,
    needs_f64: bool,
    is_trusted: bool,
}

impl fmt::Debug for Module {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Module")
            .field("name", &self.name)
            .field("words", &self.words.len())
            .field("entry_points", &self.entry_points)
            .field("needs_f64", &self.needs_f64)
            .finish()
    }
}

impl Module {
    /// Checks `bytes`, a SPIR-V binary in either byte order. Messages use `name`.
    ///
    /// # Errors
    ///
    /// [`Error::KernelInvalid`] if the bytes are not a module with a compute entry point.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self> {
        let invalid = |reason: String| Error::KernelInvalid {
            kernel: name.into(),
            reason,
        };
        if !bytes.len().is_multiple_of(4) || bytes.len() < 4 * HEADER_WORDS {
            return Err(invalid(format!(
                "{} bytes are not a whole number of 32-bit words with a header",
                bytes.len()
            )));
        }
        let mut words: Vec<u32> = bytes
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        if words[0] == MAGIC.swap_bytes() {
            words.iter_mut().for_each(|word| *word = word.swap_bytes());
        }
        if words[0] != MAGIC {
            return Err(invalid(format!(
                "it starts with {:#010x}, not with SPIR-V's {MAGIC:#010x}",
                words[0]
            )));
        }

        let mut entries: Vec<(u32, EntryPoint)> = Vec::new();
        let mut needs_f64 = false;
        let mut last_opcode = 0;
        for instruction in Instructions::of(&words) {
            let (at, opcode, operands) = instruction.map_err(|at| {
                invalid(format!(
                    "the instruction at word {at} does not fit the module"
                ))
            })?;
            last_opcode = opcode;
            match (opcode, operands) {
                (op::CAPABILITY, [op::CAPABILITY_FLOAT64]) => needs_f64 = true,
                (op::ENTRY_POINT, [op::MODEL_GL_COMPUTE, function, name @ ..]) => {
                    let name = literal_string(name).ok_or_else(|| {
                        invalid(format!("the entry point at word {at} has no name"))
                    })?;
                    entries.push((
                        *function,
                        EntryPoint {
                            name,
                            workgroup_size: [0; 3],
                        },
                    ));
                }
                (op::EXECUTION_MODE, [function, op::MODE_LOCAL_SIZE, x, y, z]) => {
                    for (id, entry) in &mut entries {
                        if id == function {
                            entry.workgroup_size = [*x, *y, *z];
                        }
                    }
                }
                _ => {}
            }
        }
        let entry_points: Vec<EntryPoint> = entries.into_iter().map(|(_, entry)| entry).collect();
        if entry_points.is_empty() {
            return Err(invalid("it has no compute entry point".into()));
        }
        if last_opcode != op::FUNCTION_END {
            return Err(invalid("it ends in the middle of a function".into()));
        }
        if let Some(entry) = entry_points
            .iter()
            .find(|entry| entry.workgroup_size.contains(&0))
        {
            return Err(invalid(format!(
                "its entry point {} has no workgroup size",
                entry.name
            )));
        }
        Ok(Self {
            name: name.into(),
            words,
            entry_points,
            needs_f64,
            is_trusted: false,
        })
    }

    /// Lets the words go to the driver unchanged, if it takes SPIR-V. A module that is not trusted
    /// always goes through naga, which validates it and does not preserve compensated arithmetic.
    ///
    /// # Safety
    ///
    /// The words must be valid SPIR-V for Vulkan, as rust-gpu emits it: with other words a driver
    /// may do anything. Buffers that a kernel only reads must be decorated with `NonWritable`, as
    /// rust-gpu does: [`Gpu::kernel`](super::Gpu::kernel) compares the declared bindings with the
    /// decorations.
    #[must_use]
    pub unsafe fn trusted(mut self) -> Self {
        self.is_trusted = true;
        self
    }

    /// Whether [`Module::trusted`] was called.
    #[must_use]
    pub fn is_trusted(&self) -> bool {
        self.is_trusted
    }

    /// The name for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The words, in this machine's byte order.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// The compute entry points.
    #[must_use]
    pub fn entry_points(&self) -> &[EntryPoint] {
        &self.entry_points
    }

    /// Whether the module declares the capability `Float64`.
    #[must_use]
    pub fn needs_f64(&self) -> bool {
        self.needs_f64
    }

    /// The module with the 32-bit specialisation constant `id` fixed to `value`, so that the driver
    /// folds it and removes what depends on its other values.
    ///
    /// The constant's default is patched in the words, because wgpu passes modules through to
    /// Vulkan without specialisation constants.
    ///
    /// # Errors
    ///
    /// [`Error::KernelInvalid`] if the module has no such constant.
    pub fn specialise(mut self, id: u32, value: u32) -> Result<Self> {
        let mut target = None;
        let mut position = None;
        for (at, opcode, operands) in Instructions::of(&self.words).flatten() {
            match (opcode, operands) {
                (op::DECORATE, [result, op::DECORATION_SPEC_ID, spec_id]) if *spec_id == id => {
                    target = Some(*result);
                }
                // Word 0 is the opcode, 1 the type, 2 the result, 3 the value.
                (op::SPEC_CONSTANT, [_, result, _]) if Some(*result) == target => {
                    position = Some(at + 3);
                }
                _ => {}
            }
        }
        let position = position.ok_or_else(|| Error::KernelInvalid {
            kernel: self.name.clone(),
            reason: format!("it has no 32-bit specialisation constant {id}"),
        })?;
        self.words[position] = value;
        Ok(self)
    }

    /// The access of each binding of the module, by the decorations of its variables, in no order.
    pub(super) fn bindings(&self) -> Vec<(u32, Access)> {
        let mut binding_of = HashMap::new();
        let mut are_read = HashSet::new();
        let mut found = Vec::new();
        for (_, opcode, operands) in Instructions::of(&self.words).flatten() {
            match (opcode, operands) {
                (op::DECORATE, [variable, op::DECORATION_BINDING, binding]) => {
                    binding_of.insert(*variable, *binding);
                }
                (op::DECORATE, [variable, op::DECORATION_NON_WRITABLE]) => {
                    are_read.insert(*variable);
                }
                // Decorations precede variables.
                (op::VARIABLE, [_, variable, class, ..]) => {
                    let access = match *class {
                        op::CLASS_UNIFORM => Access::Uniform,
                        op::CLASS_STORAGE_BUFFER if are_read.contains(variable) => Access::Read,
                        op::CLASS_STORAGE_BUFFER => Access::ReadWrite,
                        _ => continue,
                    };
                    let binding = binding_of.get(variable).copied();
                    found.extend(binding.map(|binding| (binding, access)));
                }
                _ => {}
            }
        }
        found
    }

    /// The module without its other entry points, and without the functions and variables that only
    /// those use; unchanged if it has no such entry point. Drivers compile everything in a module,
    /// and NVIDIA's gives each entry point the workgroup memory of all of them, which it takes from
    /// its caches.
    ///
    /// Only for modules that rust-gpu made: other compilers use instructions that this does not
    /// know.
    #[must_use]
    pub fn only(&self, entry_point: &str) -> Self {
        let instructions = || Instructions::of(&self.words).flatten();
        let is_entry = |name: &[u32]| literal_string(name).is_some_and(|it| it == entry_point);
        let entry = instructions().find_map(|(_, opcode, operands)| match (opcode, operands) {
            (op::ENTRY_POINT, [_, function, name @ ..]) if is_entry(name) => Some(*function),
            _ => None,
        });
        let Some(entry) = entry else {
            return self.clone();
        };

        let mut functions: HashMap<u32, Function> = HashMap::new();
        let mut current = 0;
        for (_, opcode, operands) in instructions() {
            if let (op::FUNCTION, [_, function, ..]) = (opcode, operands) {
                current = *function;
            }
            if current != 0 {
                functions.entry(current).or_default().add(opcode, operands);
            }
        }
        let mut kept = HashSet::new();
        let mut pointers = HashSet::new();
        let mut rest = vec![entry];
        while let Some(id) = rest.pop() {
            if kept.insert(id) {
                let function = functions.remove(&id).unwrap_or_default();
                rest.extend(function.calls);
                pointers.extend(function.pointers);
            }
        }
        // The functions that are left are not called.
        let mut dropped: HashSet<u32> = functions
            .into_values()
            .flat_map(|function| function.defines)
            .collect();

        let mut words = self.words[..HEADER_WORDS].to_vec();
        let mut current = 0;
        // Names and decorations precede what they apply to.
        let is_dropped_variable = |opcode: u32, operands: &[u32]| match (opcode, operands) {
            (op::VARIABLE, [_, id, ..]) => !pointers.contains(id),
            _ => false,
        };
        for (_, opcode, operands) in instructions() {
            match (opcode, operands) {
                (op::FUNCTION, _) => break,
                (_, [_, id, ..]) if is_dropped_variable(opcode, operands) => {
                    dropped.insert(*id);
                }
                _ => {}
            }
        }
        for (_, opcode, operands) in instructions() {
            if let (op::FUNCTION, [_, function, ..]) = (opcode, operands) {
                current = *function;
            }
            let is_kept = match (opcode, operands) {
                _ if current != 0 => kept.contains(&current),
                (op::ENTRY_POINT, [_, function, ..]) => *function == entry,
                (op::EXECUTION_MODE, [function, ..]) => *function == entry,
                (op::NAME | op::DECORATE, [id, ..]) => !dropped.contains(id),
                _ => !is_dropped_variable(opcode, operands),
            };
            if is_kept {
                words.push((operands.len() as u32 + 1) << 16 | opcode);
                words.extend(operands);
            }
        }
        let mut only = self.clone();
        only.words = words;
        only.entry_points.retain(|entry| entry.name == entry_point);
        only
    }

    /// The module with its specialisation constants fixed, without the code that their values rule
    /// out: what a driver has to read is a tenth as long.
    ///
    /// Only for modules that rust-gpu made, as [`Module::only`].
    #[must_use]
    pub fn folded(&self) -> Self {
        let mut folded = self.clone();
        folded.words = fold::fold(&self.words);
        folded
    }
}

/// What `Module::only` needs to know of a function.
#[derive(Default)]
struct Function {
    /// The functions that it calls.
    calls: Vec<u32>,
    /// The ids that it loads from, stores to or indexes into, and harmless others.
    pointers: Vec<u32>,
    /// The results of its instructions.
    defines: Vec<u32>,
}

impl Function {
    fn add(&mut self, opcode: u32, operands: &[u32]) {
        let defined = op::may_define(opcode, operands);
        self.defines.extend(defined);
        match (opcode, operands) {
            (op::STORE | op::COPY_MEMORY | op::ATOMIC_STORE, _) => self.pointers.extend(operands),
            (op::FUNCTION_CALL, [_, _, rest @ ..]) => {
                self.calls.extend(rest.first());
                self.pointers.extend(rest);
            }
            // The first operand of loads, access chains, atomics and array lengths is a pointer.
            (_, [_, _, rest @ ..]) if defined.is_some() => self.pointers.extend(rest.first()),
            _ => {}
        }
    }
}

/// Iterates over the instructions: position, opcode, operands. Ends after the first that does not
/// fit.
pub(crate) struct Instructions<'a> {
    words: &'a [u32],
    at: usize,
}

impl<'a> Instructions<'a> {
    pub(crate) fn of(words: &'a [u32]) -> Self {
        Self {
            words,
            at: HEADER_WORDS,
        }
    }
}

impl<'a> Iterator for Instructions<'a> {
    type Item = Result<(usize, u32, &'a [u32]), usize>;

    fn next(&mut self) -> Option<Self::Item> {
        let at = self.at;
        let first = *self.words.get(at)?;
        let count = (first >> 16) as usize;
        let Some(instruction) = (count > 0)
            .then(|| self.words.get(at..at + count))
            .flatten()
        else {
            self.at = self.words.len();
            return Some(Err(at));
        };
        self.at += count;
        Some(Ok((at, first & 0xffff, &instruction[1..])))
    }
}

/// A nul-terminated string, the first character in the lowest byte of a word.
fn literal_string(words: &[u32]) -> Option<String> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let end = bytes.iter().position(|byte| *byte == 0)?;
    (end > 0)
        .then(|| String::from_utf8(bytes[..end].to_vec()).ok())
        .flatten()
}
