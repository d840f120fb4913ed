//! [`fold`]: decides the branches of a module that its constants decide, and removes what is left
//! without a use.
//!
//! A kernel holds every rung and every effect behind branches on specialisation constants. A driver
//! removes the code of those that a pipeline does not have, but it reads and transforms all of it
//! first, which takes seconds. Here that code is gone before.
//!
//! Values are followed through phis and branches together: sparse conditional constant propagation
//! (M. N. Wegman and F. K. Zadeck, Constant propagation with conditional branches, ACM Trans. Prog.
//! Lang. Syst. 13 (1991)), for booleans and 32-bit integers. Control flow stays structured as
//! Vulkan demands: a branch that heads a selection keeps its merge block, and becomes one on
//! `true`. What is left of loops is [straightened](straighten).

use std::collections::{HashMap, HashSet};

use super::loops::straighten;
use super::written::{Written, is_pure, result_of};
use super::{HEADER_WORDS, Instructions, op};

/// A module with its specialisation constants fixed to their values, without the code that these
/// rule out.
///
/// Only for modules that rust-gpu made: other compilers use instructions that this does not know.
pub(super) fn fold(words: &[u32]) -> Vec<u32> {
    let mut instructions = Vec::new();
    for (_, opcode, operands) in Instructions::of(words).flatten() {
        instructions.push(Instruction { opcode, operands });
    }
    let first_function = instructions
        .iter()
        .position(|it| it.opcode == op::FUNCTION)
        .unwrap_or(instructions.len());
    let (globals, functions) = instructions.split_at(first_function);
    let mut module = Module::of(globals, words[3], words.len());

    let mut bodies = Vec::new();
    let mut removed = HashSet::new();
    for function in functions.split_inclusive(|it| it.opcode == op::FUNCTION_END) {
        let body = module.fold(function);
        let kept: HashSet<u32> = body.iter().filter_map(Written::result).collect();
        let all = function.iter().filter_map(Instruction::result);
        removed.extend(all.filter(|id| !kept.contains(id)));
        bodies.extend(body);
    }

    let mut folded = words[..HEADER_WORDS].to_vec();
    folded[3] = module.bound;
    for it in globals {
        match (it.opcode, it.operands) {
            (op::DECORATE, [_, op::DECORATION_SPEC_ID, ..]) => {}
            (op::NAME | op::DECORATE, [id, ..]) if removed.contains(id) => {}
            (op::SPEC_CONSTANT, _) => push(&mut folded, op::CONSTANT, it.operands),
            (op::SPEC_CONSTANT_TRUE, _) => push(&mut folded, op::CONSTANT_TRUE, it.operands),
            (op::SPEC_CONSTANT_FALSE, _) => push(&mut folded, op::CONSTANT_FALSE, it.operands),
            _ => push(&mut folded, it.opcode, it.operands),
        }
    }
    for it in module.made.iter().chain(&bodies) {
        push(&mut folded, it.opcode, &it.operands);
    }
    folded
}

fn push(words: &mut Vec<u32>, opcode: u32, operands: &[u32]) {
    words.push((operands.len() as u32 + 1) << 16 | opcode);
    words.extend(operands);
}

/// An instruction of the module that is folded.
#[derive(Clone, Copy)]
struct Instruction<'a> {
    opcode: u32,
    operands: &'a [u32],
}

impl Instruction<'_> {
    /// The id that it defines.
    fn result(&self) -> Option<u32> {
        result_of(self.opcode, self.operands)
    }

    fn to_written(self) -> Written {
        Written {
            opcode: self.opcode,
            operands: self.operands.to_vec(),
        }
    }
}

/// What is known of a value.
#[derive(Clone, Copy, PartialEq)]
enum Value {
    /// It has not been computed yet.
    Unset,
    /// It is always this: an integer's bits, or 1 for true and 0 for false.
    Known(u32),
    /// It varies, or it is no boolean and no 32-bit integer.
    Varying,
}

use Value::{Known, Unset, Varying};

impl Value {
    fn of(is_true: bool) -> Self {
        Known(is_true.into())
    }

    /// What is known where the value is this one or that one.
    fn or(self, other: Self) -> Self {
        match (self, other) {
            (Unset, value) | (value, Unset) => value,
            (Known(a), Known(b)) if a == b => self,
            _ => Varying,
        }
    }
}

/// What an instruction makes of two known values; `None` if it is not followed.
fn operation(opcode: u32) -> Option<fn(u32, u32) -> Value> {
    let operation: fn(u32, u32) -> Value = match opcode {
        op::I_ADD => |a, b| Known(a.wrapping_add(b)),
        op::I_SUB => |a, b| Known(a.wrapping_sub(b)),
        op::I_MUL => |a, b| Known(a.wrapping_mul(b)),
        op::LOGICAL_EQUAL | op::I_EQUAL => |a, b| Value::of(a == b),
        op::LOGICAL_NOT_EQUAL | op::I_NOT_EQUAL => |a, b| Value::of(a != b),
        op::LOGICAL_OR | op::BITWISE_OR => |a, b| Known(a | b),
        op::LOGICAL_AND | op::BITWISE_AND => |a, b| Known(a & b),
        op::BITWISE_XOR => |a, b| Known(a ^ b),
        op::U_GREATER_THAN => |a, b| Value::of(a > b),
        op::U_GREATER_THAN_EQUAL => |a, b| Value::of(a >= b),
        op::U_LESS_THAN => |a, b| Value::of(a < b),
        op::U_LESS_THAN_EQUAL => |a, b| Value::of(a <= b),
        op::SHIFT_LEFT_LOGICAL => |a, b| a.checked_shl(b).map_or(Varying, Known),
        op::SHIFT_RIGHT_LOGICAL => |a, b| a.checked_shr(b).map_or(Varying, Known),
        _ => return None,
    };
    Some(operation)
}

/// What an instruction makes of these values.
fn evaluate(opcode: u32, values: &[Value]) -> Value {
    match (opcode, values) {
        (op::LOGICAL_AND | op::BITWISE_AND, [Known(0), _] | [_, Known(0)]) => return Known(0),
        (op::LOGICAL_OR, [Known(1), _] | [_, Known(1)]) => return Known(1),
        (op::SELECT, [Known(condition), yes, no]) => {
            return if *condition == 1 { *yes } else { *no };
        }
        (op::SELECT, [_, yes, no]) if yes == no => return *yes,
        (op::LOGICAL_NOT, [Known(a)]) => return Known(a ^ 1),
        (op::NOT, [Known(a)]) => return Known(!a),
        _ => {}
    }
    let operation = operation(opcode);
    match (operation, values) {
        (Some(operation), [Known(a), Known(b)]) => operation(*a, *b),
        (None, _) if !matches!(opcode, op::SELECT | op::LOGICAL_NOT | op::NOT) => Varying,
        _ if values.contains(&Unset) => Unset,
        _ => Varying,
    }
}

/// What functions share.
struct Module {
    /// Of each id.
    values: Vec<Value>,
    /// One more than the largest id.
    bound: u32,
    /// The types `bool` and constants of it.
    bool_type: Option<u32>,
    true_id: Option<u32>,
    /// Constants that were not there.
    made: Vec<Written>,
    /// An undefined value of each type that needed one.
    undefined: HashMap<u32, u32>,
}

impl Module {
    fn of(globals: &[Instruction<'_>], bound: u32, words: usize) -> Self {
        let mut module = Self {
            // Few modules have more ids than words; what is beyond varies.
            values: vec![Unset; words.min(bound as usize)],
            bound,
            bool_type: None,
            true_id: None,
            made: Vec::new(),
            undefined: HashMap::new(),
        };
        let mut words = HashSet::new();
        for it in globals {
            if let [_, id, ..] = it.operands {
                module.set(*id, Varying);
            }
            match (it.opcode, it.operands) {
                (op::TYPE_BOOL, [id]) => module.bool_type = Some(*id),
                (op::TYPE_INT, [id, 32, _]) => {
                    words.insert(*id);
                }
                (op::CONSTANT | op::SPEC_CONSTANT, [kind, id, value]) if words.contains(kind) => {
                    module.set(*id, Known(*value));
                }
                (op::CONSTANT_TRUE | op::SPEC_CONSTANT_TRUE, [_, id]) => {
                    module.true_id = Some(*id);
                    module.set(*id, Known(1));
                }
                (op::CONSTANT_FALSE | op::SPEC_CONSTANT_FALSE, [_, id]) => {
                    module.set(*id, Known(0));
                }
                _ => {}
            }
        }
        module
    }

    fn value(&self, id: u32) -> Value {
        self.values.get(id as usize).copied().unwrap_or(Varying)
    }

    fn set(&mut self, id: u32, value: Value) {
        if let Some(known) = self.values.get_mut(id as usize) {
            *known = value;
        }
    }

    fn new_id(&mut self) -> u32 {
        let id = self.bound;
        self.bound = id.saturating_add(1);
        id
    }

    /// The constant `true`; `None` in a module without booleans.
    fn true_id(&mut self) -> Option<u32> {
        if self.true_id.is_none() {
            let bool_type = self.bool_type?;
            let id = self.new_id();
            self.made
                .push(Written::new(op::CONSTANT_TRUE, &[bool_type, id]));
            self.true_id = Some(id);
        }
        self.true_id
    }

    fn undefined(&mut self, kind: u32) -> u32 {
        if let Some(id) = self.undefined.get(&kind) {
            return *id;
        }
        let id = self.new_id();
        self.made.push(Written::new(op::UNDEF, &[kind, id]));
        self.undefined.insert(kind, id);
        id
    }

    fn fold(&mut self, function: &[Instruction<'_>]) -> Vec<Written> {
        let first_block = function
            .iter()
            .position(|it| it.opcode == op::LABEL)
            .unwrap_or(function.len());
        let (head, blocks) = function.split_at(first_block);
        for parameter in head.iter().filter_map(Instruction::result) {
            self.set(parameter, Varying);
        }
        let (blocks, end) = match blocks.split_last() {
            Some((end, blocks)) => (Block::all(blocks), Some(end)),
            None => (Vec::new(), None),
        };
        let flow = self.follow(&blocks);
        let mut written: Vec<Written> = head.iter().map(|it| it.to_written()).collect();
        written.extend(self.write(&blocks, &flow));
        written.extend(end.map(|it| it.to_written()));
        straighten(without_unused(written))
    }

    /// Follows values along all branches that can be taken.
    fn follow(&mut self, blocks: &[Block<'_>]) -> Flow {
        let mut flow = Flow::default();
        flow.reached.extend(blocks.first().map(|block| block.label));
        loop {
            let mut changes = false;
            for block in blocks {
                if !flow.reached.contains(&block.label) {
                    continue;
                }
                for it in block.instructions {
                    let Some(id) = it.result() else {
                        // What is not known stays, and so does what it uses.
                        if let Some(id) = op::may_define(it.opcode, it.operands) {
                            changes |= self.value(id) != Varying;
                            self.set(id, Varying);
                        }
                        continue;
                    };
                    let known = self.value(id);
                    let found = known.or(self.evaluate(it, block.label, &flow));
                    if found != known {
                        self.set(id, found);
                        changes = true;
                    }
                }
                for target in self.targets(block) {
                    changes |= flow.edges.insert((block.label, target));
                    flow.reached.insert(target);
                }
            }
            if !changes {
                return flow;
            }
        }
    }

    fn evaluate(&self, it: &Instruction<'_>, block: u32, flow: &Flow) -> Value {
        if it.opcode == op::PHI {
            return it.operands[2..]
                .chunks_exact(2)
                .filter(|pair| flow.edges.contains(&(pair[1], block)))
                .fold(Unset, |value, pair| value.or(self.value(pair[0])));
        }
        let mut values = [Varying; 3];
        let operands = &it.operands[2..];
        for (value, id) in values.iter_mut().zip(operands) {
            *value = self.value(*id);
        }
        evaluate(it.opcode, &values[..operands.len().min(3)])
    }

    /// Where a block can go.
    fn targets(&self, block: &Block<'_>) -> Vec<u32> {
        match (self.chosen(block), self.selector(block)) {
            (Some(target), _) => vec![target],
            // The condition is not computed yet.
            (None, Unset) => Vec::new(),
            _ => block.targets(),
        }
    }

    fn selector(&self, block: &Block<'_>) -> Value {
        match (block.end.opcode, block.end.operands) {
            (op::BRANCH_CONDITIONAL | op::SWITCH, [condition, ..]) => self.value(*condition),
            _ => Varying,
        }
    }

    /// The only block to which a block with several can go.
    fn chosen(&self, block: &Block<'_>) -> Option<u32> {
        let Known(value) = self.selector(block) else {
            return None;
        };
        match (block.end.opcode, block.end.operands) {
            (op::BRANCH_CONDITIONAL, [_, yes, no, ..]) => Some(if value == 1 { *yes } else { *no }),
            (op::SWITCH, [_, default, cases @ ..]) => {
                let mut cases = cases.chunks_exact(2);
                let case = cases.find(|case| case[0] == value);
                Some(case.map_or(*default, |case| case[1]))
            }
            _ => None,
        }
    }

    /// Writes the blocks that are reached, and those that structured control flow demands.
    fn write(&mut self, blocks: &[Block<'_>], flow: &Flow) -> Vec<Written> {
        let reached = || {
            blocks
                .iter()
                .filter(|block| flow.reached.contains(&block.label))
        };
        // Blocks that must exist though nothing leads there: with the header of the loop to which
        // they go back, or none.
        let mut demanded = HashMap::new();
        // Edges that are written though they are not taken.
        let mut extra: HashMap<u32, Vec<u32>> = HashMap::new();
        for block in reached() {
            match block.merge.map(|it| (it.opcode, it.operands)) {
                Some((op::SELECTION_MERGE, [merge, ..])) => {
                    demanded.entry(*merge).or_insert(None);
                    if self.is_if_true(block, *merge)
                        && !flow.edges.contains(&(block.label, *merge))
                    {
                        extra.entry(*merge).or_default().push(block.label);
                    }
                }
                Some((op::LOOP_MERGE, [merge, goes_on, ..])) => {
                    demanded.entry(*merge).or_insert(None);
                    if !flow.reached.contains(goes_on) {
                        demanded.insert(*goes_on, Some(block.label));
                        extra.entry(block.label).or_default().push(*goes_on);
                    }
                }
                _ => {}
            }
        }
        let mut written = Vec::new();
        for block in blocks {
            if flow.reached.contains(&block.label) {
                let extra = extra.remove(&block.label).unwrap_or_default();
                self.write_block(block, flow, &extra, &mut written);
            } else if let Some(back_to) = demanded.get(&block.label) {
                written.push(Written::new(op::LABEL, &[block.label]));
                written.push(match back_to {
                    Some(header) => Written::new(op::BRANCH, &[*header]),
                    None => Written::new(op::UNREACHABLE, &[]),
                });
            }
        }
        written
    }

    /// Whether a block heads a selection of which only one way is left, and becomes an `if true`.
    fn is_if_true(&self, block: &Block<'_>, merge: u32) -> bool {
        block.end.opcode == op::BRANCH_CONDITIONAL
            && self.chosen(block).is_some_and(|target| target != merge)
    }

    fn write_block(
        &mut self,
        block: &Block<'_>,
        flow: &Flow,
        extra: &[u32],
        written: &mut Vec<Written>,
    ) {
        written.push(Written::new(op::LABEL, &[block.label]));
        for it in block.instructions {
            if it.opcode == op::PHI && it.operands.len() >= 2 {
                written.push(self.phi(it, block.label, flow, extra));
            } else {
                written.push(it.to_written());
            }
        }
        let merge = block.merge.map(|it| it.to_written());
        let Some(target) = self.chosen(block) else {
            written.extend(merge);
            written.push(block.end.to_written());
            return;
        };
        let selects = block.merge.filter(|it| it.opcode == op::SELECTION_MERGE);
        match selects.and_then(|it| it.operands.first().copied()) {
            // What is in the selection may leave it for its merge block.
            Some(to) if block.end.opcode == op::SWITCH => {
                written.extend(merge);
                let selector = block.end.operands[0];
                let end = if target == to {
                    // The selection is empty.
                    written.pop();
                    Written::new(op::BRANCH, &[to])
                } else {
                    Written::new(op::SWITCH, &[selector, target])
                };
                written.push(end);
            }
            Some(to) if target != to => {
                written.extend(merge);
                let condition = self.true_id().unwrap_or(block.end.operands[0]);
                let operands = [condition, target, to];
                written.push(Written::new(op::BRANCH_CONDITIONAL, &operands));
            }
            Some(_) => written.push(Written::new(op::BRANCH, &[target])),
            None => {
                written.extend(merge);
                written.push(Written::new(op::BRANCH, &[target]));
            }
        }
    }

    /// A phi with the edges that are left, and with those that were added.
    fn phi(&mut self, it: &Instruction<'_>, block: u32, flow: &Flow, extra: &[u32]) -> Written {
        let kind = it.operands[0];
        let mut operands = it.operands[..2].to_vec();
        let mut missing: Vec<u32> = extra.to_vec();
        for pair in it.operands[2..].chunks_exact(2) {
            let is_extra = missing.contains(&pair[1]);
            if flow.edges.contains(&(pair[1], block)) {
                operands.extend(pair);
            } else if is_extra && flow.reached.contains(&pair[1]) {
                operands.extend(pair);
                missing.retain(|from| *from != pair[1]);
            }
        }
        for from in missing {
            operands.extend([self.undefined(kind), from]);
        }
        Written {
            opcode: op::PHI,
            operands,
        }
    }
}

/// Which blocks are reached, and by which branches, from block to block.
#[derive(Default)]
struct Flow {
    reached: HashSet<u32>,
    edges: HashSet<(u32, u32)>,
}

/// A basic block.
struct Block<'a> {
    label: u32,
    /// Without the label, the merge instruction and the last.
    instructions: &'a [Instruction<'a>],
    merge: Option<Instruction<'a>>,
    end: Instruction<'a>,
}

impl<'a> Block<'a> {
    fn all(instructions: &'a [Instruction<'a>]) -> Vec<Self> {
        let is_end = |it: &Instruction<'_>| (op::BRANCH..=op::UNREACHABLE).contains(&it.opcode);
        instructions
            .split_inclusive(is_end)
            .filter_map(|all| {
                let (label, rest) = all.split_first()?;
                let (end, mut rest) = rest.split_last()?;
                let mut merge = None;
                if let Some((last, before)) = rest.split_last()
                    && matches!(last.opcode, op::SELECTION_MERGE | op::LOOP_MERGE)
                {
                    merge = Some(*last);
                    rest = before;
                }
                Some(Self {
                    label: *label.operands.first()?,
                    instructions: rest,
                    merge,
                    end: *end,
                })
            })
            .collect()
    }

    fn targets(&self) -> Vec<u32> {
        match (self.end.opcode, self.end.operands) {
            (op::BRANCH, [target]) => vec![*target],
            (op::BRANCH_CONDITIONAL, [_, yes, no, ..]) => vec![*yes, *no],
            (op::SWITCH, [_, default, cases @ ..]) => {
                let cases = cases.chunks_exact(2).map(|case| case[1]);
                std::iter::once(*default).chain(cases).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// A function without instructions whose results nothing uses, and without stores to its own
/// variables that nothing loads from.
fn without_unused(function: Vec<Written>) -> Vec<Written> {
    let mut defined: HashMap<u32, usize> = HashMap::new();
    for (index, it) in function.iter().enumerate() {
        defined.extend(it.result().map(|id| (id, index)));
    }
    // The variable of this function to which a pointer leads.
    let variable_of = |store: &Written| {
        let mut pointer = *store.operands.first()?;
        // No chain is longer.
        for _ in 0..function.len() {
            let it = &function[*defined.get(&pointer)?];
            match it.opcode {
                op::VARIABLE => return Some(pointer),
                op::ACCESS_CHAIN | op::IN_BOUNDS_ACCESS_CHAIN => pointer = *it.operands.get(2)?,
                _ => return None,
            }
        }
        None
    };
    let mut stores: HashMap<u32, Vec<usize>> = HashMap::new();
    let mut is_used = vec![false; function.len()];
    let mut rest = Vec::new();
    for (index, it) in function.iter().enumerate() {
        let variable = if it.opcode == op::STORE {
            variable_of(it)
        } else {
            None
        };
        if let Some(variable) = variable {
            stores.entry(variable).or_default().push(index);
        } else if it.result().is_none() || !is_pure(it.opcode, &it.operands) {
            is_used[index] = true;
            rest.push(index);
        }
    }
    while let Some(index) = rest.pop() {
        let it = &function[index];
        // Literals among the operands are taken for ids: that keeps a few more.
        let mut used: Vec<usize> = it
            .operands
            .iter()
            .filter_map(|id| defined.get(id).copied())
            .collect();
        if let (op::VARIABLE, Some(id)) = (it.opcode, it.result()) {
            used.extend(stores.remove(&id).unwrap_or_default());
        }
        for index in used {
            if !is_used[index] {
                is_used[index] = true;
                rest.push(index);
            }
        }
    }
    let mut is_used = is_used.into_iter();
    let keep = |_: &Written| is_used.next().unwrap_or(true);
    let mut function = function;
    function.retain(keep);
    function
}

#[cfg(test)]
mod tests {
    use super::*;

    const VOID: u32 = 1;
    const BOOL: u32 = 2;
    const WORD: u32 = 3;
    const SPECIAL: u32 = 4;
    const SEVEN: u32 = 5;
    const FUNCTION_TYPE: u32 = 6;
    const VARIABLE: u32 = 7;
    const FUNCTION: u32 = 10;
    const BOUND: u32 = 40;

    /// A module with one function of these instructions, which may use the specialisation constant
    /// [`SPECIAL`] and the constant [`SEVEN`].
    fn module(special: u32, body: &[(u32, &[u32])]) -> Vec<u32> {
        let mut words = vec![0x0723_0203, 0x0001_0300, 0, BOUND, 0];
        let head: [(u32, &[u32]); 8] = [
            (op::DECORATE, &[SPECIAL, op::DECORATION_SPEC_ID, 2]),
            (op::TYPE_BOOL, &[BOOL]),
            (op::TYPE_INT, &[WORD, 32, 0]),
            (op::SPEC_CONSTANT, &[WORD, SPECIAL, special]),
            (op::CONSTANT, &[WORD, SEVEN, 7]),
            (op::VARIABLE, &[WORD, VARIABLE, 12]),
            (op::FUNCTION, &[VOID, FUNCTION, 0, FUNCTION_TYPE]),
            (op::LABEL, &[11]),
        ];
        for (opcode, operands) in head.iter().chain(body) {
            push(&mut words, *opcode, operands);
        }
        push(&mut words, op::FUNCTION_END, &[]);
        words
    }

    /// The instructions of the folded function, opcode and operands.
    fn folded(special: u32, body: &[(u32, &[u32])]) -> Vec<(u32, Vec<u32>)> {
        let words = fold(&module(special, body));
        Instructions::of(&words)
            .flatten()
            .skip_while(|(_, opcode, _)| *opcode != op::LABEL)
            .map(|(_, opcode, operands)| (opcode, operands.to_vec()))
            .collect()
    }

    const RETURN: (u32, &[u32]) = (253, &[]);

    /// `if special & 7 != 0 && special == 7 { store }`, where the second condition is asked only if
    /// the first is true, as a phi.
    fn nested() -> Vec<(u32, &'static [u32])> {
        vec![
            (op::BITWISE_AND, &[WORD, 20, SPECIAL, SEVEN]),
            (op::I_EQUAL, &[BOOL, 21, 20, SPECIAL]),
            (op::SELECTION_MERGE, &[13, 0]),
            (op::BRANCH_CONDITIONAL, &[21, 12, 13]),
            (op::LABEL, &[12]),
            (op::I_EQUAL, &[BOOL, 22, SPECIAL, SEVEN]),
            (op::BRANCH, &[13]),
            (op::LABEL, &[13]),
            (op::PHI, &[BOOL, 23, 21, 11, 22, 12]),
            (op::SELECTION_MERGE, &[15, 0]),
            (op::BRANCH_CONDITIONAL, &[23, 14, 15]),
            (op::LABEL, &[14]),
            (op::STORE, &[VARIABLE, SEVEN]),
            (op::BRANCH, &[15]),
            (op::LABEL, &[15]),
            RETURN,
        ]
    }

    #[test]
    fn what_a_constant_rules_out_goes() {
        let stores = |special: u32| {
            let all = folded(special, &nested());
            all.iter()
                .filter(|(opcode, _)| *opcode == op::STORE)
                .count()
        };
        assert_eq!(stores(7), 1);
        // The first condition is false.
        assert_eq!(stores(8), 0);
        // The first is true, and the second is false.
        assert_eq!(stores(3), 0);
        // Not even the conditions are left.
        let all = folded(8, &nested());
        assert!(
            all.iter()
                .all(|(opcode, _)| *opcode != op::I_EQUAL && *opcode != op::PHI),
            "{all:?}"
        );
    }

    /// A way that is left keeps its selection, with the merge block that structured control flow
    /// demands.
    #[test]
    fn selections_keep_their_form() {
        let all = folded(7, &nested());
        let merges = all
            .iter()
            .filter(|(opcode, _)| *opcode == op::SELECTION_MERGE);
        assert_eq!(merges.count(), 2);
        let conditions: Vec<u32> = all
            .iter()
            .filter(|(opcode, _)| *opcode == op::BRANCH_CONDITIONAL)
            .map(|(_, operands)| operands[0])
            .collect();
        // `true` was not there: it has the first free id.
        assert_eq!(conditions, [BOUND, BOUND]);
    }

    /// A phi has an entry for each block that is written to lead to it, of an undefined value where
    /// it led elsewhere before.
    #[test]
    fn phis_have_an_entry_for_each_block_that_leads_there() {
        let body: Vec<(u32, &[u32])> = vec![
            (op::I_EQUAL, &[BOOL, 20, SPECIAL, SEVEN]),
            (op::SELECTION_MERGE, &[14, 0]),
            (op::BRANCH_CONDITIONAL, &[20, 12, 13]),
            (op::LABEL, &[12]),
            (op::BRANCH, &[14]),
            (op::LABEL, &[13]),
            (op::BRANCH, &[14]),
            (op::LABEL, &[14]),
            (op::PHI, &[WORD, 21, SEVEN, 12, SPECIAL, 13]),
            (op::STORE, &[VARIABLE, 21]),
            RETURN,
        ];
        for (special, value, from) in [(7, SEVEN, 12), (8, SPECIAL, 13)] {
            let all = folded(special, &body);
            let phi = all.iter().find(|(opcode, _)| *opcode == op::PHI);
            let (_, operands) = phi.expect("the stored value");
            // `true` has the first free id here, too.
            let mut expected = vec![WORD, 21, value, from, 0, 11];
            expected[4] = operands[4];
            assert_eq!(operands, &expected);
            assert!([BOUND, BOUND + 1].contains(&operands[4]));
        }
    }

    /// A loop that is never repeated keeps its continue block, with an undefined value for its phi.
    #[test]
    fn loops_keep_their_form() {
        let body: Vec<(u32, &[u32])> = vec![
            (op::BRANCH, &[12]),
            (op::LABEL, &[12]),
            (op::PHI, &[WORD, 20, SEVEN, 11, 21, 14]),
            (op::LOOP_MERGE, &[15, 14, 0]),
            (op::BRANCH, &[13]),
            (op::LABEL, &[13]),
            (op::STORE, &[VARIABLE, 20]),
            (op::I_EQUAL, &[BOOL, 22, SPECIAL, SEVEN]),
            (op::BRANCH_CONDITIONAL, &[22, 15, 14]),
            (op::LABEL, &[14]),
            (op::I_ADD, &[WORD, 21, 20, SEVEN]),
            (op::BRANCH, &[12]),
            (op::LABEL, &[15]),
            RETURN,
        ];
        let once = folded(7, &body);
        let phi = once.iter().find(|(opcode, _)| *opcode == op::PHI);
        let (_, operands) = phi.expect("the stored value");
        assert_eq!(operands, &[WORD, 20, SEVEN, 11, BOUND, 14]);
        let goes_on = once.iter().position(|it| *it == (op::LABEL, vec![14]));
        let next = &once[goes_on.expect("the continue block") + 1];
        assert_eq!(next, &(op::BRANCH, vec![12]));
        assert!(once.iter().all(|(opcode, _)| *opcode != op::I_ADD));
        // Here it is repeated for ever, and the value varies.
        let many = folded(8, &body);
        assert!(many.iter().any(|(opcode, _)| *opcode == op::I_ADD));
        assert!(many.contains(&(op::UNREACHABLE, vec![])));
    }

    /// The one way of a switch that is left stays a switch: what is inside may break out of it.
    #[test]
    fn a_switch_stays_one() {
        let body: Vec<(u32, &[u32])> = vec![
            (op::SELECTION_MERGE, &[14, 0]),
            (op::SWITCH, &[SPECIAL, 12, 1, 13]),
            (op::LABEL, &[12]),
            (op::STORE, &[VARIABLE, SEVEN]),
            (op::BRANCH, &[14]),
            (op::LABEL, &[13]),
            (op::STORE, &[VARIABLE, SPECIAL]),
            (op::BRANCH, &[14]),
            (op::LABEL, &[14]),
            RETURN,
        ];
        for (special, block, stored) in [(1, 13, SPECIAL), (2, 12, SEVEN)] {
            let all = folded(special, &body);
            assert!(all.contains(&(op::SWITCH, vec![SPECIAL, block])), "{all:?}");
            assert!(all.contains(&(op::STORE, vec![VARIABLE, stored])));
            let stores = all.iter().filter(|(opcode, _)| *opcode == op::STORE);
            assert_eq!(stores.count(), 1);
        }
    }

    /// An instruction that is not known stays, with what it uses, and its result varies.
    #[test]
    fn what_is_not_known_stays() {
        const IMAGE_WRITE: u32 = 99;
        const GROUP_ALL: u32 = 261;
        let body: Vec<(u32, &[u32])> = vec![
            (op::I_ADD, &[WORD, 20, SPECIAL, SEVEN]),
            (op::I_ADD, &[WORD, 21, SPECIAL, SPECIAL]),
            (IMAGE_WRITE, &[VARIABLE, 20, SEVEN]),
            (GROUP_ALL, &[BOOL, 22, SEVEN, 21]),
            (op::SELECTION_MERGE, &[13, 0]),
            (op::BRANCH_CONDITIONAL, &[22, 12, 13]),
            (op::LABEL, &[12]),
            (op::STORE, &[VARIABLE, SEVEN]),
            (op::BRANCH, &[13]),
            (op::LABEL, &[13]),
            RETURN,
        ];
        let all = folded(1, &body);
        assert_eq!(all.len(), body.len() + 2, "{all:?}");
    }

    /// Each operation gives what a device computes.
    #[test]
    fn operations_are_those_of_spir_v() {
        let known = |opcode, a, b| evaluate(opcode, &[Known(a), Known(b)]);
        assert!(known(op::I_ADD, u32::MAX, 2) == Known(1));
        assert!(known(op::I_SUB, 1, 2) == Known(u32::MAX));
        assert!(known(op::I_MUL, 1 << 31, 2) == Known(0));
        assert!(known(op::BITWISE_XOR, 6, 3) == Known(5));
        assert!(known(op::SHIFT_LEFT_LOGICAL, 3, 31) == Known(1 << 31));
        // Not defined.
        assert!(known(op::SHIFT_RIGHT_LOGICAL, 3, 32) == Varying);
        for (opcode, [less, same, more]) in [
            (op::U_LESS_THAN, [1, 0, 0]),
            (op::U_LESS_THAN_EQUAL, [1, 1, 0]),
            (op::U_GREATER_THAN, [0, 0, 1]),
            (op::U_GREATER_THAN_EQUAL, [0, 1, 1]),
            (op::I_EQUAL, [0, 1, 0]),
            (op::I_NOT_EQUAL, [1, 0, 1]),
        ] {
            assert!(known(opcode, 2, 3_000_000_000) == Known(less));
            assert!(known(opcode, 2, 2) == Known(same));
            assert!(known(opcode, 3_000_000_000, 2) == Known(more));
        }
        assert!(evaluate(op::LOGICAL_AND, &[Varying, Known(0)]) == Known(0));
        assert!(evaluate(op::LOGICAL_OR, &[Known(1), Unset]) == Known(1));
        assert!(evaluate(op::LOGICAL_OR, &[Known(0), Varying]) == Varying);
        assert!(evaluate(op::SELECT, &[Known(0), Varying, Known(9)]) == Known(9));
        assert!(evaluate(op::NOT, &[Known(0)]) == Known(u32::MAX));
    }
}
