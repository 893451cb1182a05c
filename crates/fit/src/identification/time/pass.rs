//! One pass over the records: the rows of many candidate models, factored stretch by stretch. Only inputs that have moved
//! take columns; weights multiply whole stretches after they have been factored.

use super::record::DimensionlessRecord;
use super::signals::SignalBlock;
use crate::error::{Result, ensure};
use crate::identification::least_squares::{BLOCK_ROWS, Factor, StreamingQr};
use crate::identification::options::TimeWeights;
use crate::numbered::{OnDone, numbered};
use crate::wind_tunnel::Segment;
use std::ops::Range;

/// Length of the stretches of a record without segments, s: many times the memory of the forces.
const STRETCH_S: f64 = 10.0;
/// Greatest number of such stretches; the last takes the rest.
const MAX_STRETCHES: usize = 2000;

/// Columns of the whole system: an optional constant, then every column of one input for all inputs, interleaved so
/// that fewer filters are a leading subset.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColumnOrder {
    pub inputs: usize,
    pub per_input: usize,
    pub constant: bool,
}

impl ColumnOrder {
    /// Number of columns with `active` inputs.
    pub(crate) fn width(&self, active: usize) -> usize {
        self.leading(self.per_input, active)
    }

    /// Number of columns that the first `per_input` columns of each of `active` inputs take.
    pub(crate) fn leading(&self, per_input: usize, active: usize) -> usize {
        usize::from(self.constant) + per_input * active
    }

    /// Column `c` of input `j` in the whole system.
    pub(crate) fn index(&self, c: usize, j: usize) -> usize {
        usize::from(self.constant) + c * self.inputs + j
    }

    /// Columns of the whole system for which `used(c, j)`, in their order.
    pub(super) fn columns(&self, used: impl Fn(usize, usize) -> bool) -> Vec<usize> {
        let pairs = (0..self.per_input).flat_map(|c| (0..self.inputs).map(move |j| (c, j)));
        let used = pairs.filter(|(c, j)| used(*c, *j));
        let constant = self.constant.then_some(0).into_iter();
        let used = used.map(|(c, j)| self.index(c, j));
        constant.chain(used).collect()
    }
}

/// Consecutive samples, at most [`BLOCK_ROWS`], one slice per degree of freedom.
pub(crate) struct Chunk<'a> {
    pub motion: Vec<&'a [f64]>,
    pub force: Vec<&'a [f64]>,
    /// Index of the first sample in the (resampled) record.
    pub first: usize,
}

impl SignalBlock {
    fn chunk(&self, range: Range<usize>) -> Chunk<'_> {
        let (motion, force) = self.channels.split_at(self.channels.len() / 2);
        let within = range.start - self.first..range.end - self.first;
        Chunk {
            motion: motion.iter().map(|c| &c[within.clone()]).collect(),
            force: force.iter().map(|c| &c[within.clone()]).collect(),
            first: range.start,
        }
    }
}

impl Chunk<'_> {
    /// Number of samples.
    pub(crate) fn rows(&self) -> usize {
        self.motion[0].len()
    }
}

/// Makes the columns of one record, chunk after chunk.
pub(crate) trait Columns {
    /// Number of candidate models.
    fn candidates(&self) -> usize;
    /// Takes the next chunk; inputs that are not `active` have been zero so far.
    fn advance(&mut self, chunk: &Chunk<'_>, active: &[usize]);
    /// Columns of a candidate for the active inputs, in [`ColumnOrder`], followed by one per force. Called once per chunk and
    /// candidate, with the candidates in order.
    fn columns<'a>(
        &'a mut self,
        chunk: &Chunk<'a>,
        candidate: usize,
        active: &[usize],
    ) -> Vec<&'a [f64]>;
}

/// What a pass makes of the records.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PassPlan {
    pub order: ColumnOrder,
    pub weights: TimeWeights,
    /// Resample to this dimensionless step.
    pub delta_s: Option<f64>,
    /// Seconds at the start that only settle the filters.
    pub discard_s: f64,
    /// Every how many samples a row is taken.
    pub stride: usize,
    /// Into how many stretches every segment is cut; 0 cuts where the weights change only.
    pub stretches: usize,
    /// Number of the pass, and of all passes, for the progress.
    pub number: (usize, usize),
}

/// A stretch of one record between two boundaries, factored by itself.
pub(crate) struct Stretch {
    /// Index of the record.
    pub record: usize,
    /// Number of the stretch in its record.
    pub stretch: usize,
    /// Mean speed of the record, m/s.
    pub mean_speed_m_s: f64,
    /// Segment it lies in; `None` in a record without segments.
    pub segment: Option<usize>,
    /// Frequency of the motion in that segment, Hz.
    pub frequency_hz: Option<f64>,
    /// Inputs that moved.
    pub set: Vec<usize>,
    /// One factor per candidate, all forces as right-hand sides.
    pub factors: Vec<Factor>,
    /// Weight of each force.
    pub weights: Vec<f64>,
    /// Sum of squares of each force while something moved.
    squares: Vec<f64>,
    /// Rows in which something moved.
    moving_rows: usize,
}

/// What a pass yields.
pub(crate) struct Pass {
    pub order: ColumnOrder,
    /// In the order of the records.
    pub stretches: Vec<Stretch>,
}

/// One pass over all records, in parallel. `make` builds the columns of a record.
pub(crate) fn pass_over<C: Columns>(
    records: &[DimensionlessRecord],
    plan: &PassPlan,
    progress: OnDone<'_>,
    make: impl Fn(&DimensionlessRecord) -> Result<C> + Sync,
) -> Result<Pass> {
    let steps_s = records.iter().map(|record| record.step_s);
    let finest_s = steps_s.fold(f64::INFINITY, f64::min);
    let (pass, passes) = plan.number;
    let of_all = |done, count| progress((pass - 1) * count + done, passes * count);
    let parts = numbered(records.len(), &of_all, |r| {
        one_record(r, &records[r], plan, finest_s, &mut make(&records[r])?)
    })?;
    Ok(Pass {
        order: plan.order,
        stretches: parts.into_iter().flatten().collect(),
    })
}

/// The stretches of one record, where the finest step of all is `finest_s`.
fn one_record<C: Columns>(
    index: usize,
    record: &DimensionlessRecord,
    plan: &PassPlan,
    finest_s: f64,
    maker: &mut C,
) -> Result<Vec<Stretch>> {
    let (resampled, step_s) = record.at_step(plan.delta_s)?;
    let signals = resampled.as_ref().unwrap_or(&record.signals);
    let sample = |t: &f64| (t / step_s).ceil().max(0.0) as usize;
    let ends: Vec<usize> = boundaries_s(record, plan).iter().map(sample).collect();
    let mut ends = ends.into_iter().peekable();
    let discard = (plan.discard_s / step_s).ceil() as usize;
    let (mut closed, mut open) = (Vec::new(), OpenStretch::new(plan.order.inputs));
    let mut active: Vec<usize> = Vec::new();
    let mut rows = 0;
    signals.for_each_block(|block| {
        let (mut at, stop) = (block.first, block.first + block.rows());
        while at < stop {
            while ends.next_if_eq(&at).is_some() {
                open.close(index, record, &mut closed);
            }
            let whole = (at / BLOCK_ROWS + 1) * BLOCK_ROWS;
            let end = ends.peek().map_or(whole, |e| whole.min(*e));
            let range = at..end.min(stop);
            let chunk = block.chunk(range.clone());
            let moving = activate(&chunk, &mut active);
            maker.advance(&chunk, &active);
            if at >= discard {
                open.take(&chunk, moving, plan, &active, maker, at as f64 * step_s);
                rows += chunk.rows();
            }
            at = range.end;
        }
        Ok(())
    })?;
    open.close(index, record, &mut closed);
    let least = plan.order.width(1).max(16) * plan.stride;
    ensure(
        rows >= least,
        format_args!("record {}", record.header.name),
        format_args!("at least {least} samples after discard_s"),
        rows,
    )?;
    weigh(&mut closed, plan.weights);
    if plan.delta_s.is_none() {
        // a second counts the same, however often it was sampled
        let weight = (record.step_s / finest_s).sqrt();
        let weights = closed.iter_mut().flat_map(|s| &mut s.weights);
        weights.for_each(|w| *w *= weight);
    }
    Ok(closed)
}

/// Where stretches end: at the beginning of every segment and at even distances in it, or at even distances without
/// segments; and where the filters have settled.
fn boundaries_s(record: &DimensionlessRecord, plan: &PassPlan) -> Vec<f64> {
    let segments = &record.header.segments;
    let mut ends = vec![plan.discard_s];
    if plan.stretches > 0 || plan.weights == TimeWeights::PerSegment {
        ends.extend(segments.iter().skip(1).map(|s| s.start_s));
    }
    if plan.stretches > 0 && segments.is_empty() {
        ends.extend((1..MAX_STRETCHES).map(|i| i as f64 * STRETCH_S));
    }
    for s in segments {
        let (length, parts) = (s.end_s - s.start_s, plan.stretches as f64);
        ends.extend((1..plan.stretches).map(|i| s.start_s + length * i as f64 / parts));
    }
    ends.sort_by(f64::total_cmp);
    ends
}

/// Adds the inputs that begin to move in this chunk to `active`; returns from which row on something has moved.
fn activate(chunk: &Chunk<'_>, active: &mut Vec<usize>) -> usize {
    let at_rest = active.is_empty();
    let mut first = chunk.rows();
    for (j, motion) in chunk.motion.iter().enumerate() {
        if let Some(row) = motion.iter().position(|x| *x != 0.0) {
            first = first.min(row);
            if !active.contains(&j) {
                active.push(j);
            }
        }
    }
    active.sort_unstable();
    if at_rest { first } else { 0 }
}

/// A stretch whose end has not been reached.
struct OpenStretch {
    /// Inputs, and one system per candidate with all forces as right-hand sides.
    sets: Vec<(Vec<usize>, Vec<StreamingQr>)>,
    squares: Vec<f64>,
    moving_rows: usize,
    start_s: f64,
}

impl OpenStretch {
    fn new(forces: usize) -> Self {
        Self {
            sets: Vec::new(),
            squares: vec![0.0; forces],
            moving_rows: 0,
            start_s: 0.0,
        }
    }

    fn take<C: Columns>(
        &mut self,
        chunk: &Chunk<'_>,
        moving: usize,
        plan: &PassPlan,
        active: &[usize],
        maker: &mut C,
        time_s: f64,
    ) {
        let forces = plan.order.inputs;
        if self.sets.is_empty() {
            self.start_s = time_s;
        }
        if self.sets.last().is_none_or(|(set, _)| set != active) {
            let empty = StreamingQr::new(plan.order.width(active.len()), forces);
            let systems = vec![empty; maker.candidates()];
            self.sets.push((active.to_vec(), systems));
        }
        let systems = self.sets.last_mut().into_iter().flat_map(|(_, s)| s);
        for (candidate, system) in systems.enumerate() {
            let columns = maker.columns(chunk, candidate, active);
            if candidate == 0 {
                let filtered = &columns[columns.len() - forces..];
                for (sum, force) in self.squares.iter_mut().zip(filtered) {
                    *sum += force[moving..].iter().map(|x| x * x).sum::<f64>();
                }
                self.moving_rows += chunk.rows() - moving;
            }
            if plan.stride == 1 {
                system.push_columns(&columns);
                continue;
            }
            let skip = (plan.stride - chunk.first % plan.stride) % plan.stride;
            let mut thinned = Vec::with_capacity(columns.len() * (chunk.rows() / plan.stride + 1));
            for column in &columns {
                thinned.extend(column.iter().skip(skip).step_by(plan.stride));
            }
            let count = thinned.len() / columns.len();
            if count > 0 {
                system.push_columns(&thinned.chunks_exact(count).collect::<Vec<_>>());
            }
        }
    }

    /// Factors what has been taken, and starts anew. Inputs that begin to move later in a stretch make two of it, of which
    /// the last has the squares.
    fn close(&mut self, index: usize, record: &DimensionlessRecord, closed: &mut Vec<Stretch>) {
        let done = std::mem::replace(self, Self::new(self.squares.len()));
        let segments = &record.header.segments;
        // rest before the first segment belongs to it; half a step, since boundaries fall between samples
        let begun = |s: &&Segment| s.start_s <= done.start_s + 0.5 * record.step_s;
        let begun = segments.iter().take_while(begun).count().saturating_sub(1);
        let segment = (!segments.is_empty()).then_some(begun);
        let stretch = closed.last().map_or(0, |c: &Stretch| c.stretch + 1);
        let last = done.sets.len().saturating_sub(1);
        for (at, (set, systems)) in done.sets.into_iter().enumerate() {
            // of the last alone
            let own = usize::from(at == last);
            closed.push(Stretch {
                record: index,
                stretch,
                mean_speed_m_s: record.header.mean_speed_m_s,
                segment,
                frequency_hz: segment.map(|s| segments[s].frequency_hz),
                set,
                factors: systems.into_iter().map(StreamingQr::finish).collect(),
                weights: vec![1.0; done.squares.len()],
                squares: done.squares.iter().map(|s| s * own as f64).collect(),
                moving_rows: own * done.moving_rows,
            });
        }
    }
}

/// Gives all stretches of one segment, or of one record, the same weights.
fn weigh(stretches: &mut [Stretch], weights: TimeWeights) {
    // a record without segments is one
    let same =
        |a: &Stretch, b: &Stretch| weights != TimeWeights::PerSegment || a.segment == b.segment;
    if weights == TimeWeights::None {
        return;
    }
    for alike in stretches.chunk_by_mut(same) {
        let rows: usize = alike.iter().map(|c| c.moving_rows).sum();
        for i in 0..alike[0].squares.len() {
            let sum: f64 = alike.iter().map(|c| c.squares[i]).sum();
            // a force that is zero throughout cannot be scaled by its size
            let weight = match sum {
                0.0 => 1.0,
                _ => (rows as f64 / sum).sqrt(),
            };
            alike.iter_mut().for_each(|s| s.weights[i] = weight);
        }
    }
}
