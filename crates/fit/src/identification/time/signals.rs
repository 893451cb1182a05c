//! Motions and forces of one record over time: in blocks, in memory or, where they are long, in a file of their own that goes
//! with them. Whatever its length, a record then takes the memory of one block for each thread that reads it.

use crate::error::{Error, Result};
use crate::section::Dof;
use crate::signal::{check_clipping, check_finite};
use crate::wind_tunnel::RecordSource;
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Rows of a block: a multiple of what is factored together.
pub(crate) const SIGNAL_ROWS: usize = 8192;
/// Blocks in memory at most: ten minutes at 200 Hz.
const IN_MEMORY: usize = 16;

/// Dimensionless motions and forces, a channel per degree of freedom each, all of one length.
pub(crate) struct Signals {
    /// Number of degrees of freedom.
    dofs: usize,
    rows: usize,
    /// The first blocks, unless they stand in the file.
    blocks: Vec<SignalBlock>,
    file: Option<Mutex<File>>,
    /// The block that is being filled.
    last: SignalBlock,
}

/// Up to [`SIGNAL_ROWS`] consecutive samples.
#[derive(Clone, Default)]
pub(crate) struct SignalBlock {
    /// Index of the first sample.
    pub first: usize,
    /// Motions, then forces.
    pub channels: Vec<Vec<f64>>,
}

impl SignalBlock {
    /// Number of samples.
    pub(crate) fn rows(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    fn write(&self, file: &mut File) -> Result<()> {
        let channels = self.channels.iter();
        let mut written = channels.map(|channel| file.write_all(cast_slice(channel)));
        written.try_for_each(|one| one).map_err(io)
    }
}

impl Signals {
    /// None yet.
    pub(crate) fn new(dofs: usize) -> Self {
        Self {
            dofs,
            rows: 0,
            blocks: Vec::new(),
            file: None,
            last: SignalBlock {
                first: 0,
                channels: vec![Vec::new(); 2 * dofs],
            },
        }
    }

    /// Takes samples of all channels, `value(channel, sample)`, the first `rows` of them; [`Self::finish`] is to follow the last.
    pub(crate) fn extend(
        &mut self,
        rows: usize,
        value: impl Fn(usize, usize) -> f64,
    ) -> Result<()> {
        let mut from = 0;
        while from < rows {
            let to = rows.min(from + SIGNAL_ROWS - self.last.rows());
            for (c, channel) in self.last.channels.iter_mut().enumerate() {
                channel.extend((from..to).map(|k| value(c, k)));
            }
            if self.last.rows() == SIGNAL_ROWS {
                self.close()?;
            }
            from = to;
        }
        Ok(())
    }

    fn close(&mut self) -> Result<()> {
        if self.blocks.len() == IN_MEMORY {
            let mut file = tempfile::tempfile().map_err(io)?;
            for block in self.blocks.drain(..) {
                block.write(&mut file)?;
            }
            self.file = Some(Mutex::new(file));
        }
        match &self.file {
            None => self.blocks.push(self.last.clone()),
            Some(file) => self.last.write(&mut locked(file))?,
        }
        self.rows += self.last.rows();
        self.last.first = self.rows;
        self.last.channels.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    /// With what was taken last.
    pub(crate) fn finish(mut self) -> Result<Self> {
        if self.last.rows() > 0 {
            self.close()?;
        }
        self.last = SignalBlock::default();
        Ok(self)
    }

    /// All channels of a record in its own units, motions and then forces.
    ///
    /// # Errors
    /// Those of the record; [`Error::Input`] naming a sample that is not finite.
    pub(crate) fn from_record(record: &dyn RecordSource) -> Result<Self> {
        let header = record.header();
        let mut signals = Signals::new(header.dofs.len());
        record.for_each_block(&mut |block| {
            for (c, channel) in block.iter().enumerate() {
                let place = format!("record {}, channel {}", header.name, c + 1);
                check_finite(&place, signals.len(), channel)?;
            }
            signals.extend(block[0].len(), |c, k| block[c][k])
        })?;
        signals.finish()
    }

    /// Refuses channels of a record, of these degrees of freedom, that stand at their limit for more than a short while.
    ///
    /// # Errors
    /// [`Error::Input`] naming record, channel and sample; [`Error::Io`] for a file that cannot be read.
    pub(crate) fn check_clipping(&self, record: &str, dofs: &[Dof]) -> Result<()> {
        // 164 s at 200 Hz: long enough to tell a limit from a peak, little beside what stands in memory
        let part = 4 * SIGNAL_ROWS;
        for first in (0..self.rows).step_by(part) {
            let channels = self.range(first..first + part)?;
            for (c, samples) in channels.iter().enumerate() {
                let what = if c < self.dofs { "motion" } else { "force" };
                let name = dofs[c % self.dofs].name();
                check_clipping(&format!("record {record}, {name} {what}"), first, samples)?;
            }
        }
        Ok(())
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.rows + self.last.rows()
    }

    /// Number of degrees of freedom.
    pub(crate) fn dofs(&self) -> usize {
        self.dofs
    }

    /// Calls `f` with all blocks in their order.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that cannot be read, and those of `f`.
    pub(crate) fn for_each_block(
        &self,
        mut f: impl FnMut(&SignalBlock) -> Result<()>,
    ) -> Result<()> {
        let mut read = SignalBlock::default();
        let mut firsts = (0..self.rows).step_by(SIGNAL_ROWS);
        firsts.try_for_each(|first| f(self.block(first, &mut read)?))
    }

    /// All channels over some of the samples.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that cannot be read.
    pub(crate) fn range(&self, samples: Range<usize>) -> Result<Vec<Vec<f64>>> {
        // a clone of an empty list has no capacity
        let empty = || Vec::with_capacity(samples.len().min(self.rows));
        let mut channels: Vec<Vec<f64>> = (0..2 * self.dofs).map(|_| empty()).collect();
        let mut read = SignalBlock::default();
        let (start, end) = (samples.start, samples.end.min(self.rows));
        for first in (start / SIGNAL_ROWS * SIGNAL_ROWS..end).step_by(SIGNAL_ROWS) {
            let block = self.block(first, &mut read)?;
            let part = start.max(first) - first..end.min(first + block.rows()) - first;
            for (all, channel) in channels.iter_mut().zip(&block.channels) {
                all.extend_from_slice(channel.get(part.clone()).unwrap_or_default());
            }
        }
        Ok(channels)
    }

    /// Replaces every block by what `f` makes of it.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that cannot be read or written.
    pub(crate) fn change(&mut self, mut f: impl FnMut(&mut SignalBlock)) -> Result<()> {
        let Some(file) = &self.file else {
            self.blocks.iter_mut().for_each(f);
            return Ok(());
        };
        let mut block = SignalBlock::default();
        for first in (0..self.rows).step_by(SIGNAL_ROWS) {
            self.read(file, first, &mut block)?;
            f(&mut block);
            block.write(&mut *self.at(file, first)?)?;
        }
        Ok(())
    }

    fn at<'a>(&self, file: &'a Mutex<File>, first: usize) -> Result<MutexGuard<'a, File>> {
        let mut file = locked(file);
        let start = (first * 2 * self.dofs * size_of::<f64>()) as u64;
        file.seek(SeekFrom::Start(start)).map_err(io)?;
        Ok(file)
    }

    /// The block that begins with a sample, which is `read` where it stands in a file.
    fn block<'a>(&'a self, first: usize, read: &'a mut SignalBlock) -> Result<&'a SignalBlock> {
        let Some(file) = &self.file else {
            return Ok(&self.blocks[first / SIGNAL_ROWS]);
        };
        self.read(file, first, read)?;
        Ok(read)
    }

    fn read(&self, file: &Mutex<File>, first: usize, block: &mut SignalBlock) -> Result<()> {
        let rows = SIGNAL_ROWS.min(self.rows - first);
        let mut file = self.at(file, first)?;
        block.first = first;
        block.channels.resize(2 * self.dofs, Vec::new());
        for channel in &mut block.channels {
            channel.resize(rows, 0.0);
            file.read_exact(cast_slice_mut(channel)).map_err(io)?;
        }
        Ok(())
    }
}

fn locked(file: &Mutex<File>) -> MutexGuard<'_, File> {
    file.lock().unwrap_or_else(PoisonError::into_inner)
}

fn io(error: std::io::Error) -> Error {
    Error::io(std::env::temp_dir(), error)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record that stays in memory and one that does not give back what they were given, in blocks, and as changed.
    #[test]
    fn long_signals_are_those_that_were_written() {
        for rows in [10, 3 * SIGNAL_ROWS + 5, (IN_MEMORY + 2) * SIGNAL_ROWS + 7] {
            let value = |c: usize, k: usize| (10 * k + c) as f64 + 0.1;
            let mut writer = Signals::new(1);
            for first in (0..rows).step_by(5000) {
                let part = 5000.min(rows - first);
                writer.extend(part, |c, k| value(c, first + k)).unwrap();
            }
            let mut signals = writer.finish().unwrap();
            assert_eq!(signals.file.is_some(), rows > IN_MEMORY * SIGNAL_ROWS);
            for sign in [1.0, -1.0] {
                let mut seen = 0;
                let check = |block: &SignalBlock| {
                    assert_eq!(block.first, seen);
                    for (c, channel) in block.channels.iter().enumerate() {
                        for (k, x) in channel.iter().enumerate() {
                            assert_eq!(*x, sign * value(c, seen + k));
                        }
                    }
                    seen += block.rows();
                    Ok(())
                };
                signals.for_each_block(check).unwrap();
                assert_eq!((seen, signals.len()), (rows, rows));
                let negate = |x: &mut f64| *x = -*x;
                let turn = |b: &mut SignalBlock| b.channels.iter_mut().flatten().for_each(negate);
                signals.change(turn).unwrap();
            }
        }
    }
}
