//! A record whose text is read once, however often its numbers are asked for, with the motions that are asked for.

use super::time::driven::driven;
use super::time::signals::Signals;
use crate::error::Result;
use crate::section::Dof;
use crate::signal::extremes;
use crate::wind_tunnel::{RecordHeader, RecordSource};
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
        Self {
            source,
            header,
            kept: Mutex::default(),
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
        let mut ends = vec![(f64::INFINITY, f64::NEG_INFINITY); all.len()];
        self.signals()?.for_each_block(|block| {
            for ((low, high), motion) in ends.iter_mut().zip(&block.channels) {
                let (least, greatest) = extremes(motion.iter().copied());
                (*low, *high) = (low.min(least), high.max(greatest));
            }
            Ok(())
        })?;
        let half = |((low, high), dof): (&(f64, f64), &Dof)| {
            0.5 * (high - low) * dof.motion_scale(self.header.width_m)
        };
        let driven = driven(ends.iter().zip(all).map(half).collect());
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

    fn for_each_block(&self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        let (all, own) = (&self.source.header().dofs, &self.header.dofs);
        self.signals()?.for_each_block(|block| {
            // of motions, and then of forces
            let dofs = all.iter().cycle();
            let only = block
                .channels
                .iter()
                .zip(dofs)
                .filter(|(_, d)| own.contains(d));
            f(&only.map(|(channel, _)| &channel[..]).collect::<Vec<_>>())
        })
    }
}
