//! A record whose text is read once, however often its numbers are asked for, with the motions that are asked for.

use super::time::driven::driven_motions;
use super::time::signals::Signals;
use crate::error::Result;
use crate::section::Dof;
use crate::wind_tunnel::{RecordBlock, RecordHeader, RecordSource};
use std::sync::{Arc, Mutex, PoisonError};

/// A source that is read when it is first asked for and kept from then on: in memory, or, where it is long, in a file of its own
/// that goes with it. A file that changes meanwhile is not seen: all that is fitted in one run sees the same numbers.
pub struct KeptRecord<S> {
    source: S,
    /// With some of its motions.
    header: RecordHeader,
    kept: Mutex<Option<Arc<Signals>>>,
}

impl<S: RecordSource> KeptRecord<S> {
    /// Of its motions and forces those that are among `dofs`; nothing is read yet.
    pub fn new(source: S, dofs: &[Dof]) -> Self {
        let mut header = source.header().clone();
        header.dofs.retain(|dof| dofs.contains(dof));
        let kept = Mutex::new(None);
        Self {
            source,
            header,
            kept,
        }
    }

    /// Whether a motion that is left out is driven: what it does is in the forces of the others.
    ///
    /// # Errors
    /// Those of the source.
    pub fn drives_another(&self) -> Result<bool> {
        let all = &self.source.header().dofs;
        if self.header.dofs == *all {
            return Ok(false);
        }
        let signals = self.signals()?;
        let mut motions = signals.range(0..signals.len())?;
        motions.truncate(all.len());
        for (motion, dof) in motions.iter_mut().zip(all) {
            let scale = dof.motion_scale(self.header.width_m);
            motion.iter_mut().for_each(|x| *x *= scale);
        }
        let driven = driven_motions(&motions);
        Ok(driven.iter().any(|i| !self.header.dofs.contains(&all[*i])))
    }

    /// The numbers; who comes while they are read waits.
    fn signals(&self) -> Result<Arc<Signals>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(signals) = &*kept {
            return Ok(signals.clone());
        }
        let signals = Arc::new(Signals::from_record(&self.source)?);
        *kept = Some(signals.clone());
        Ok(signals)
    }
}

impl<S: RecordSource + Send> RecordSource for KeptRecord<S> {
    fn header(&self) -> &RecordHeader {
        &self.header
    }

    fn for_each_block(&self, f: &mut dyn FnMut(RecordBlock<'_>) -> Result<()>) -> Result<()> {
        let (all, own) = (&self.source.header().dofs, &self.header.dofs);
        let only = |channels: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let each = channels.iter().zip(all).filter(|(_, d)| own.contains(d));
            each.map(|(channel, _)| channel.clone()).collect()
        };
        self.signals()?.for_each_block(|block| {
            let (motion, force) = block.channels.split_at(all.len());
            if own == all {
                return f(RecordBlock { motion, force });
            }
            let (motion, force) = (&only(motion)[..], &only(force)[..]);
            f(RecordBlock { motion, force })
        })
    }
}
