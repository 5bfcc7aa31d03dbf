//! The primitives, as steps of a few kernels each.

use backend_api::{BufferId, Error, Primitive};
use bytemuck::{Pod, Zeroable};
use wgpu::Buffer;

use crate::WgpuBackend;
use crate::backend::create_buffer;
use crate::pipeline::{MAX_STORAGE, Program};
use crate::recording::{Count, Range, Step};

const R: Option<bool> = Some(false);
const W: Option<bool> = Some(true);

macro_rules! programs {
    ($($id:ident: $name:literal, $file:literal, $entry:literal, [$($writes:expr),*], params $params:literal;)*) => {
        $(static $id: Program = Program {
            name: $name,
            modules: &[include_str!(concat!("../wgsl/primitives/", $file, ".wgsl"))],
            entry: $entry,
            workgroup_size: GROUP,
            writes: pad(&[$($writes),*]),
            has_params: $params,
        };)*
    };
}

programs! {
    FILL: "fill", "fill", "pr_fill_main", [W], params true;
    SCAN: "scan", "scan", "pr_scan_main", [R, W, W], params true;
    SCAN_ADD: "scan.add", "scan_add", "pr_scan_add_main", [R, W], params true;
    COMPACT_MARK: "compact.mark", "compact_mark", "pr_mark_main", [R, W], params false;
    COMPACT_WRITE: "compact.write", "compact_write", "pr_compact_main", [R, R, W, W], params false;
    RUNS_MARK: "reduce_by_key.mark", "runs_mark", "pr_runs_mark_main", [R, W], params false;
    RUNS_WRITE: "reduce_by_key.write", "runs_write", "pr_runs_write_main", [R, R, W, W], params false;
    RUNS_SUM: "reduce_by_key.sum", "runs_sum", "pr_runs_sum_main", [R, R, R, W, W], params false;
    SORT_COUNT: "sort_pairs.count", "sort_count", "pr_sort_count_main", [R, W], params true;
    SORT_MOVE: "sort_pairs.move", "sort_move", "pr_sort_move_main", [R, R, R, W, W], params true;
}

const fn pad(writes: &[Option<bool>]) -> [Option<bool>; MAX_STORAGE] {
    let mut all = [None; MAX_STORAGE];
    let mut k = 0;
    while k < writes.len() {
        all[k] = writes[k];
        k += 1;
    }
    all
}

/// Invocations of a workgroup, in all these kernels.
const GROUP: u32 = 256;
/// Words that one workgroup of `scan.wgsl` sums up.
const SCAN_BLOCK: u32 = 1024;
/// Values of a digit of the sort; four digits make a key.
const DIGITS: u32 = 256;

/// A parameter block of four words.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Words([u32; 4]);

/// What a scratch buffer is for. A buffer serves one purpose at a time; primitives run one after the other.
#[derive(Clone, Copy)]
enum Use {
    Marks,
    Places,
    Prefix,
    Starts,
    KeysAside,
    ValuesAside,
    /// Sums of blocks, by level of the scan.
    BlockSums(usize),
    /// What stands before each block, by level of the scan.
    BeforeBlock(usize),
}

/// Levels of a scan: 1024⁴ words are more than 2³².
const LEVELS: usize = 4;

impl Use {
    const fn slot(self) -> usize {
        match self {
            Self::Marks => 0,
            Self::Places => 1,
            Self::Prefix => 2,
            Self::Starts => 3,
            Self::KeysAside => 4,
            Self::ValuesAside => 5,
            Self::BlockSums(level) => 6 + level,
            Self::BeforeBlock(level) => 6 + LEVELS + level,
        }
    }
}

/// Scratch buffers, kept from call to call and grown when needed.
#[derive(Default)]
pub(crate) struct Scratch {
    buffers: [Option<Buffer>; 6 + 2 * LEVELS],
}

impl WgpuBackend {
    /// Appends the steps of a checked primitive. After an error some may be recorded.
    pub(crate) fn record_primitive(&mut self, primitive: Primitive) -> Result<(), Error> {
        let at = primitive.name();
        match primitive {
            Primitive::Fill { buffer, word } => {
                let buffer = self.whole(at, buffer)?;
                let words = (buffer.size / 4) as u32;
                self.push(&FILL, &[&buffer], Words([word, 0, 0, 0]), words)
            }
            Primitive::Scan { input, output, count } => {
                let (input, output) = (self.whole(at, input)?, self.whole(at, output)?);
                self.scan(&input, &output, count, 0)
            }
            Primitive::Compact { flags, indices, kept, count } => {
                let (flags, indices, kept) = (self.whole(at, flags)?, self.whole(at, indices)?, self.whole(at, kept)?);
                if count == 0 {
                    return self.zero(&kept);
                }
                let marks = self.scratch(Use::Marks, count)?;
                let places = self.scratch(Use::Places, count + 1)?;
                self.push(&COMPACT_MARK, &[&flags, &marks], NO_PARAMS, count)?;
                self.scan(&marks, &places, count, 0)?;
                self.push(&COMPACT_WRITE, &[&flags, &places, &indices, &kept], NO_PARAMS, count)
            }
            Primitive::ReduceByKey { keys, values, unique, sums, runs, count } => {
                let (keys, values) = (self.whole(at, keys)?, self.whole(at, values)?);
                let (unique, sums, runs) = (self.whole(at, unique)?, self.whole(at, sums)?, self.whole(at, runs)?);
                if count == 0 {
                    return self.zero(&runs);
                }
                let marks = self.scratch(Use::Marks, count)?;
                let places = self.scratch(Use::Places, count + 1)?;
                let prefix = self.scratch(Use::Prefix, count + 1)?;
                let starts = self.scratch(Use::Starts, count)?;
                self.push(&RUNS_MARK, &[&keys, &marks], NO_PARAMS, count)?;
                self.scan(&marks, &places, count, 0)?;
                self.scan(&values, &prefix, count, 0)?;
                self.push(&RUNS_WRITE, &[&keys, &places, &unique, &starts], NO_PARAMS, count)?;
                self.push(&RUNS_SUM, &[&places, &starts, &prefix, &sums, &runs], NO_PARAMS, count)
            }
            Primitive::SortPairs { keys, values, count } => {
                let (keys, values) = (self.whole(at, keys)?, self.whole(at, values)?);
                self.sort(&keys, &values, count)
            }
        }
    }

    /// Prefix sums of `count` words: of each block, of the blocks' sums (a level up), and both added.
    fn scan(&mut self, input: &Range, output: &Range, count: u32, level: usize) -> Result<(), Error> {
        let blocks = count.div_ceil(SCAN_BLOCK).max(1);
        let params = Words([count, blocks, 0, 0]);
        let sums = self.scratch(Use::BlockSums(level), blocks)?;
        self.push(&SCAN, &[input, output, &sums], params, blocks * GROUP)?;
        if blocks == 1 {
            return Ok(());
        }
        let before = self.scratch(Use::BeforeBlock(level), blocks + 1)?;
        self.scan(&sums, &before, blocks, level + 1)?;
        self.push(&SCAN_ADD, &[&before, output], params, count + 1)
    }

    /// Least significant digit first; each pass is stable. Four passes end where they began.
    fn sort(&mut self, keys: &Range, values: &Range, count: u32) -> Result<(), Error> {
        if count < 2 {
            return Ok(());
        }
        let blocks = count.div_ceil(GROUP);
        let table_words = blocks * DIGITS;
        let table = self.scratch(Use::Marks, table_words)?;
        let places = self.scratch(Use::Places, table_words + 1)?;
        let aside = (self.scratch(Use::KeysAside, count)?, self.scratch(Use::ValuesAside, count)?);
        let mut from = (keys.clone(), values.clone());
        let mut to = aside;
        for shift in (0..32).step_by(8) {
            let params = Words([count, blocks, shift, 0]);
            self.push(&SORT_COUNT, &[&from.0, &table], params, count)?;
            self.scan(&table, &places, table_words, 0)?;
            self.push(&SORT_MOVE, &[&from.0, &from.1, &places, &to.0, &to.1], params, count)?;
            std::mem::swap(&mut from, &mut to);
        }
        Ok(())
    }

    fn zero(&mut self, word: &Range) -> Result<(), Error> {
        let word = Range { size: 4, ..word.clone() };
        self.push(&FILL, &[&word], Words([0; 4]), 1)
    }

    fn push(&mut self, program: &'static Program, ranges: &[&Range], params: Words, count: u32) -> Result<(), Error> {
        let pipeline = self.pipelines.get(&self.device, program, &mut self.message)?;
        let params = if program.has_params { bytemuck::bytes_of(&params).to_vec() } else { Vec::new() };
        let ranges = ranges.iter().map(|&range| range.clone()).collect();
        self.steps.push(Step {
            name: program.name,
            pipeline,
            ranges,
            params,
            count: Count::Known(count),
            listed: false,
        });
        Ok(())
    }

    fn whole(&self, at: &'static str, id: BufferId) -> Result<Range, Error> {
        let buffer = self.buffers.get(id).ok_or(Error::UnknownBuffer { at })?.clone();
        let size = buffer.size();
        Ok(Range { buffer, offset: 0, size })
    }

    fn scratch(&mut self, purpose: Use, words: u32) -> Result<Range, Error> {
        let size = u64::from(words) * 4;
        let limit = self.limits.max_binding_size;
        if size > limit {
            return Err(Error::BadSize { at: "scratch", size, limit });
        }
        let slot = purpose.slot();
        let kept = self.scratch.buffers[slot].take().filter(|buffer| buffer.size() >= size);
        let buffer = match kept {
            Some(buffer) => buffer,
            None => self.catch(size, |this| create_buffer(&this.device, "hashcache scratch", size))?,
        };
        self.scratch.buffers[slot] = Some(buffer.clone());
        let size = buffer.size();
        Ok(Range { buffer, offset: 0, size })
    }
}

/// For programs without parameters.
const NO_PARAMS: Words = Words([0; 4]);
