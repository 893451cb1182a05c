//! A record whose text is read once, however often its numbers are asked for.

use super::time::signals::Signals;
use crate::error::Result;
use crate::wind_tunnel::{RecordBlock, RecordHeader, RecordSource};
use std::sync::{Arc, Mutex, PoisonError};

/// A source that is read when it is first asked for and kept from then on: in memory, or, where it is long, in a file of its own
/// that goes with it. A file that changes meanwhile is not seen: all that is fitted in one run sees the same numbers.
pub struct KeptRecord<S> {
    source: S,
    kept: Mutex<Option<Arc<Signals>>>,
}

impl<S: RecordSource> KeptRecord<S> {
    /// Nothing is read yet.
    pub fn new(source: S) -> Self {
        let kept = Mutex::new(None);
        Self { source, kept }
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
        self.source.header()
    }

    fn for_each_block(&self, f: &mut dyn FnMut(RecordBlock<'_>) -> Result<()>) -> Result<()> {
        let dofs = self.header().dofs.len();
        self.signals()?.for_each_block(|block| {
            let (motion, force) = block.channels.split_at(dofs);
            f(RecordBlock { motion, force })
        })
    }
}
