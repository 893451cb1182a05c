//! Drift of the load cells, in their own axes.
//!
//! The zero of a channel wanders slowly. In the axes of a cell that turns with the model this is a slow sum; once turned to global
//! axes, what the lift channel drifts by stands in the drag as `drift · θ(t)`, in step with the rotation, where no polynomial finds
//! it and a fit takes it for P2*, P3* (and the drag's for H2*, H3*). So each cell loses its drift before its axes are turned.
//!
//! It is found in global axes and about the centre of rotation, though: there static wind and weight are constant, while a turning
//! cell sees `lift · θ` in its drag channel, whose mean moves when the motion begins, and a polynomial takes that for drift. The
//! polynomial is that of the [coherent regression](super::coherent) on each of these components by itself, counted from the first
//! sample, and is taken from the channels of the cell as at rest: the difference is the drift times the square of a degree or two.
//!
//! What a zero has moved between the two recordings is not in it: at rest nothing tells it from static wind.

use super::cells::{self, GlobalCell};
use super::coherent::Regressors;
use super::signals::HarmonicSegment;
use crate::error::Result;
use crate::signal::{extremes, robust_deviation};
use crate::wind_tunnel::{CELL_CHANNELS, LoadCell, RawRecording, Rig};
use serde::{Deserialize, Serialize};

/// Samples that stand this many robust standard deviations off do not count: a knock is no drift.
const OUTLIER: f64 = 6.0;

/// What one cell drifted by over a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellDrift {
    /// Name of the cell.
    pub cell: String,
    /// Greatest minus least drift of fx, fy, fz (N), mx, my, mz (N·m), axes of the cell.
    pub range: [f64; 6],
}

/// Removes from every cell of `recording` a polynomial of `degree`, separated from what follows `motion` in `segments`; `rotation_rad` is
/// the rotation of the model at each sample.
pub(crate) fn remove_cell_drift(
    recording: &mut RawRecording,
    rig: &Rig,
    motion: &[f64],
    rotation_rad: &[f64],
    segments: &[HarmonicSegment],
    degree: usize,
) -> Result<Vec<CellDrift>> {
    let regressors = Regressors::new(motion, recording.sampling_hz, segments, degree);
    let ramps = ramps(segments, recording.sampling_hz, motion.len());
    let global = match degree {
        0 => Vec::new(),
        _ => cells::to_global(recording, rig, rotation_rad),
    };
    let none = |cell: &LoadCell| CellDrift {
        cell: cell.name.clone(),
        range: [0.0; CELL_CHANNELS.len()],
    };
    let mut found: Vec<CellDrift> = rig.cells.iter().map(none).collect();
    for (i, mut global) in global.into_iter().enumerate() {
        let cell = &rig.cells[i];
        cells::move_moment(&mut global, cell, rotation_rad, 1.0);
        let mut drift: GlobalCell = Default::default();
        for (drift, channel) in drift.iter_mut().zip(&global) {
            *drift = drift_of(channel, &regressors, &ramps)?;
        }
        cells::move_moment(&mut drift, cell, &[], -1.0);
        let drift = cells::to_cell_at_rest(&drift, cell);
        for (c, channel) in recording.cells[i].iter_mut().enumerate() {
            // a channel that was not measured
            if channel.iter().all(|x| *x == 0.0) {
                continue;
            }
            channel.iter_mut().zip(&drift[c]).for_each(|(f, d)| *f -= d);
            let (low, high) = extremes(drift[c].iter().copied());
            found[i].range[c] = high - low;
        }
    }
    Ok(found)
}

/// Where the amplitude changes: a force with a memory is no multiple of motion and rate there, and a polynomial takes the rest of it.
fn ramps(segments: &[HarmonicSegment], sampling_hz: f64, count: usize) -> Vec<bool> {
    let mut ramps = vec![false; count];
    for s in segments {
        let plateau = s.plateau.range();
        for k in s.range(sampling_hz, count) {
            ramps[k] = !plateau.contains(&k);
        }
    }
    ramps
}

/// The polynomial from its first sample on (what the cells had drifted before is part of their zero), fitted without `ramps` and a
/// second time without what stands far off.
fn drift_of(channel: &[f64], regressors: &Regressors, ramps: &[bool]) -> Result<Vec<f64>> {
    let first = regressors.fit(channel, ramps)?;
    let residual = |k: usize| channel[k] - first.coherent[k] - first.drift[k];
    let counted = (0..channel.len()).filter(|k| !ramps[*k]);
    let counted: Vec<f64> = counted.map(residual).collect();
    let limit = OUTLIER * robust_deviation(&counted);
    let far = |k: usize| limit > 0.0 && residual(k).abs() > limit;
    let outliers: Vec<bool> = (0..channel.len()).map(|k| ramps[k] || far(k)).collect();
    let mut drift = regressors.fit(channel, &outliers)?.drift;
    let zero = drift.first().copied().unwrap_or(0.0);
    drift.iter_mut().for_each(|d| *d -= zero);
    Ok(drift)
}
