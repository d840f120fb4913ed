//! [`straighten`]: loops that ask at their beginning whether they go on, and end there.
//!
//! rust-gpu writes `while i < n { … }` as a loop that asks once and looks at the answer twice: goes
//! around its body, and then leaves from its last block, with what the next round would begin with
//! undefined.
//!
//! ```text
//! header   i = phi(0 from before, next from end); goto test
//! test     more = i < n; if more { goto body } else { goto skip }
//! body     after = i + 1; goto join
//! skip     goto join
//! join     next = phi(after from body, undefined from skip); goto end
//! end      if more { goto header } else { goto exit }
//! ```
//!
//! Here it becomes what other compilers write, and drivers are tested with:
//!
//! ```text
//! test     more = i < n; if more { goto body } else { goto exit }
//! body     after = i + 1; goto join
//! join     next = phi(after from body); goto end
//! end      goto header
//! ```
//!
//! NVIDIA's driver 580.159 was seen to lose the bound n of bent loops in a kernel of light paths
//! with caustics, so that they did not end.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use super::op;
use super::written::Written;

/// A function of which each loop that can be is straight.
pub(super) fn straighten(function: Vec<Written>) -> Vec<Written> {
    let mut blocks: Vec<Vec<Written>> = vec![Vec::new()];
    for it in function {
        if it.opcode == op::LABEL {
            blocks.push(Vec::new());
        }
        if let Some(block) = blocks.last_mut() {
            block.push(it);
        }
    }
    let headers: Vec<u32> = blocks.iter().filter_map(|block| header(block)).collect();
    for header in headers {
        if let Some(bent) = Loop::find(&blocks, header) {
            bent.straighten(&mut blocks);
        }
    }
    blocks.into_iter().flatten().collect()
}

/// The label of a block; what stands before a function's first has none.
fn label(block: &[Written]) -> Option<u32> {
    let first = block.first().filter(|it| it.opcode == op::LABEL)?;
    Some(first.operands[0])
}

/// The label of a block that heads a loop.
fn header(block: &[Written]) -> Option<u32> {
    let heads = block.iter().any(|it| it.opcode == op::LOOP_MERGE);
    label(block).filter(|_| heads)
}

/// A loop as rust-gpu writes it: the labels of its blocks.
struct Loop {
    header: u32,
    test: u32,
    body: u32,
    /// Where it goes around the body; the test itself if no block is between.
    skip: u32,
    join: u32,
    end: u32,
    exit: u32,
}

impl Loop {
    fn find(blocks: &[Vec<Written>], header: u32) -> Option<Self> {
        let index: HashMap<u32, usize> = blocks
            .iter()
            .enumerate()
            .filter_map(|(index, block)| Some((label(block)?, index)))
            .collect();
        let block = |label: &u32| index.get(label).map(|index| &blocks[*index][..]);
        let [.., merge, goes] = block(&header)? else {
            return None;
        };
        let (op::LOOP_MERGE, [exit, end, ..]) = (merge.opcode, &merge.operands[..]) else {
            return None;
        };
        let (op::BRANCH, [test]) = (goes.opcode, &goes.operands[..]) else {
            return None;
        };
        let [.., merge, asks] = block(test)? else {
            return None;
        };
        let (op::SELECTION_MERGE, [join, ..]) = (merge.opcode, &merge.operands[..]) else {
            return None;
        };
        let (op::BRANCH_CONDITIONAL, [more, body, otherwise]) = (asks.opcode, &asks.operands[..])
        else {
            return None;
        };
        let mut skip = test;
        if otherwise != join {
            skip = otherwise;
            let [_, goes] = block(skip)? else {
                return None;
            };
            let goes_to_join = goes.opcode == op::BRANCH && goes.operands[..] == [*join];
            if !goes_to_join {
                return None;
            }
        }
        let [_, asks] = block(end)? else {
            return None;
        };
        let asks_again =
            asks.opcode == op::BRANCH_CONDITIONAL && asks.operands[..] == [*more, header, *exit];
        let (from, to) = (index[test] + 1, *index.get(exit)?);
        let is_whole = [body, skip, join, end].into_iter().all(|label| {
            label == test || index.get(label).is_some_and(|at| (from..to).contains(at))
        });
        if !asks_again || !is_whole || from > to {
            return None;
        }
        let exit_reads = block(exit)?.iter().any(|it| it.opcode == op::PHI);
        (!exit_reads && !is_read_outside(blocks, from..to, *end)).then_some(Self {
            header,
            test: *test,
            body: *body,
            skip: *skip,
            join: *join,
            end: *end,
            exit: *exit,
        })
    }

    fn straighten(&self, blocks: &mut Vec<Vec<Written>>) {
        if self.skip != self.test {
            blocks.retain(|block| label(block) != Some(self.skip));
        }
        for block in blocks {
            let of = label(block);
            if of == Some(self.test) {
                if let Some(asks) = block.pop() {
                    block.pop();
                    let operands = [asks.operands[0], self.body, self.exit];
                    block.push(Written::new(op::BRANCH_CONDITIONAL, &operands));
                }
            } else if of == Some(self.end) {
                block.pop();
                block.push(Written::new(op::BRANCH, &[self.header]));
            } else if of == Some(self.join) {
                for phi in block.iter_mut().filter(|it| it.opcode == op::PHI) {
                    let mut operands = phi.operands[..2].to_vec();
                    let pairs = phi.operands[2..].chunks_exact(2);
                    operands.extend(pairs.filter(|pair| pair[1] != self.skip).flatten());
                    phi.operands = operands;
                }
            }
        }
    }
}

/// Whether anything outside of the blocks `inside` reads what they compute. After a straight loop
/// there may be none. The variables of the loop, which get their next values at its `end`, are
/// within.
fn is_read_outside(blocks: &[Vec<Written>], inside: Range<usize>, end: u32) -> bool {
    let within = blocks[inside.clone()].iter().flatten();
    let computed: HashSet<u32> = within.filter_map(Written::result).collect();
    let before = blocks[..inside.start].iter().flatten();
    let mut outside = before.chain(blocks[inside.end..].iter().flatten());
    outside.any(|it| match it.opcode {
        op::PHI => it.operands[2..]
            .chunks_exact(2)
            .any(|pair| pair[1] != end && computed.contains(&pair[0])),
        op::LABEL | op::LOOP_MERGE | op::SELECTION_MERGE => false,
        op::BRANCH_CONDITIONAL => computed.contains(&it.operands[0]),
        _ => it.operands.iter().any(|id| computed.contains(id)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOOL: u32 = 2;
    const WORD: u32 = 3;
    const UNDEFINED: u32 = 5;
    const ZERO: u32 = 6;
    const N: u32 = 7;
    const BEFORE: u32 = 10;
    const HEADER: u32 = 11;
    const TEST: u32 = 12;
    const BODY: u32 = 13;
    const SKIP: u32 = 14;
    const JOIN: u32 = 15;
    const END: u32 = 16;
    const EXIT: u32 = 17;
    const I: u32 = 20;
    const NEXT: u32 = 21;
    const MORE: u32 = 22;
    const AFTER: u32 = 23;

    type Lines = Vec<(u32, Vec<u32>)>;

    /// The loop above; after it, `read` is stored.
    fn bent(read: u32) -> Lines {
        let lines: [(u32, &[u32]); 22] = [
            (op::LABEL, &[BEFORE]),
            (op::BRANCH, &[HEADER]),
            (op::LABEL, &[HEADER]),
            (op::PHI, &[WORD, I, ZERO, BEFORE, NEXT, END]),
            (op::LOOP_MERGE, &[EXIT, END, 0]),
            (op::BRANCH, &[TEST]),
            (op::LABEL, &[TEST]),
            (op::U_LESS_THAN, &[BOOL, MORE, I, N]),
            (op::SELECTION_MERGE, &[JOIN, 0]),
            (op::BRANCH_CONDITIONAL, &[MORE, BODY, SKIP]),
            (op::LABEL, &[BODY]),
            (op::I_ADD, &[WORD, AFTER, I, N]),
            (op::BRANCH, &[JOIN]),
            (op::LABEL, &[SKIP]),
            (op::BRANCH, &[JOIN]),
            (op::LABEL, &[JOIN]),
            (op::PHI, &[WORD, NEXT, AFTER, BODY, UNDEFINED, SKIP]),
            (op::BRANCH, &[END]),
            (op::LABEL, &[END]),
            (op::BRANCH_CONDITIONAL, &[MORE, HEADER, EXIT]),
            (op::LABEL, &[EXIT]),
            (op::STORE, &[N, read]),
        ];
        lines
            .iter()
            .map(|(opcode, operands)| (*opcode, operands.to_vec()))
            .collect()
    }

    fn straightened(lines: &Lines) -> Lines {
        let written = lines
            .iter()
            .map(|(opcode, operands)| Written::new(*opcode, operands));
        straighten(written.collect())
            .into_iter()
            .map(|it| (it.opcode, it.operands))
            .collect()
    }

    #[test]
    fn a_loop_ends_where_it_asks() {
        let mut expected = bent(I);
        expected.retain(|line| *line != (op::LABEL, vec![SKIP]));
        let _ = expected.remove(12 + 1);
        for line in &mut expected {
            *line = match (line.0, &line.1[..]) {
                (op::BRANCH_CONDITIONAL, [_, BODY, _]) => (line.0, vec![MORE, BODY, EXIT]),
                (op::BRANCH_CONDITIONAL, [_, HEADER, _]) => (op::BRANCH, vec![HEADER]),
                (op::PHI, [_, NEXT, ..]) => (op::PHI, vec![WORD, NEXT, AFTER, BODY]),
                _ => continue,
            };
        }
        expected.retain(|(opcode, _)| *opcode != op::SELECTION_MERGE);
        assert_eq!(straightened(&bent(I)), expected);
    }

    /// The block that goes around the body may have been folded away.
    #[test]
    fn the_test_may_go_around_the_body_by_itself() {
        let mut lines = bent(I);
        lines.drain(13..15);
        lines[9].1[2] = JOIN;
        lines[14].1[5] = TEST;
        assert_eq!(lines[14].0, op::PHI);
        assert_eq!(straightened(&lines), straightened(&bent(I)));
    }

    /// A loop stays as it is if what it computes is read after it, if the last block asks something
    /// else, or if more than a branch is on the way around the body.
    #[test]
    fn other_loops_stay() {
        let mut asks_else = bent(I);
        asks_else[19].1[0] = ZERO;
        let mut does_more = bent(I);
        does_more.insert(14, (op::STORE, vec![N, I]));
        for lines in [bent(NEXT), bent(AFTER), asks_else, does_more] {
            assert_eq!(straightened(&lines), lines);
        }
    }
}
