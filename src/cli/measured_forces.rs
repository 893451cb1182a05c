//! Forces of records beside those that the exported model predicts for the measured motion.

use super::figures;
use super::vocabulary::{
    Dof, OutputDir, PlottedSeries, Result, TimePanel, TrainedModel, time_history_figure,
};
use crate::flutter::CriticalPoint;
use crate::study::RecordSet;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, RecordHeader, predicted_forces};
use std::f64::consts::TAU;

/// Stem of the figure.
pub(super) const FORCES: &str = "forces";
/// Periods that are shown.
const PERIODS: f64 = 3.0;

/// Three periods of one record per motion, as near to the onset in reduced frequency as the tests are; nothing without records.
/// `origin` says in a word whether the forces were measured or made from a table.
pub(super) fn write(
    model: &TrainedModel,
    records: &RecordSet,
    onset: &CriticalPoint,
    origin: &str,
    out: &mut OutputDir,
) -> Result<()> {
    let wanted =
        ReducedFrequency::from_hertz(onset.frequency_hz, model.section.width_m, onset.speed_m_s);
    let mut chosen: Vec<RecordExcerpt> = Vec::new();
    for source in records.select(None)? {
        let header = source.header();
        if header.dofs != crate::aerodynamics::Transfer::dofs(&model.model) {
            continue;
        }
        let record = Record::whole(source)?;
        let Some(stretch) = RecordExcerpt::nearest(record, wanted.full_width()) else {
            continue;
        };
        match chosen.iter_mut().find(|c| c.motion == stretch.motion) {
            Some(known) if stretch.off < known.off => *known = stretch,
            Some(_) => (),
            None => chosen.push(stretch),
        }
    }
    if chosen.is_empty() {
        return Ok(());
    }
    chosen.sort_by_key(|c| c.motion.name() != Dof::Vertical.name());
    let mut panels = Vec::new();
    for stretch in &chosen {
        panels.extend(stretch.panels(model, origin)?);
    }
    let descriptions = chosen.iter().map(RecordExcerpt::describe);
    let descriptions = descriptions.collect::<Vec<_>>();
    let title = format!("Forces by motion: {}", descriptions.join(", "));
    let draw = || time_history_figure(&title, &panels, "Periods of the motion");
    figures::write(FORCES, out, draw)
}

/// A few periods of a record.
struct RecordExcerpt {
    record: Record,
    motion: Dof,
    frequency_hz: f64,
    start_s: f64,
    /// Ratio of the reduced frequencies of motion and onset, as the size of its logarithm.
    off: f64,
}

impl RecordExcerpt {
    /// The stretch of the record whose reduced frequency is nearest; of a record without harmonic stretches its middle, with
    /// periods of that reduced frequency.
    fn nearest(record: Record, k: f64) -> Option<Self> {
        let h = &record.header;
        let motion = driven(&record)?;
        let hertz = k * h.mean_speed_m_s / (TAU * h.width_m);
        let off = |f: f64| (f / hertz).ln().abs();
        let seconds = record.motion[0].len() as f64 / h.sampling_hz;
        let middle = |from: f64, to: f64, f: f64| 0.5 * (from + to - PERIODS / f);
        let harmonic = h.segments.iter();
        let nearest = harmonic.min_by(|a, b| off(a.frequency_hz).total_cmp(&off(b.frequency_hz)));
        let (frequency_hz, start_s) = match nearest {
            Some(s) => (s.frequency_hz, middle(s.start_s, s.end_s, s.frequency_hz)),
            None => (hertz, middle(0.0, seconds, hertz)),
        };
        let inside = start_s >= 0.0 && start_s + PERIODS / frequency_hz <= seconds;
        inside.then(|| Self {
            off: off(frequency_hz),
            motion,
            frequency_hz,
            start_s,
            record,
        })
    }

    fn describe(&self) -> String {
        let speed = self.record.header.mean_speed_m_s;
        let name = self.motion.name();
        format!("{name} {:.2} Hz at {speed:.1} m/s", self.frequency_hz)
    }

    /// One panel per force.
    fn panels(&self, model: &TrainedModel, origin: &str) -> Result<Vec<TimePanel>> {
        let h = &self.record.header;
        let predicted = predicted_forces(&model.model, &self.record)?;
        let first = (self.start_s * h.sampling_hz).round() as usize;
        let samples = (PERIODS / self.frequency_hz * h.sampling_hz).round() as usize;
        let last = (first + samples).min(self.record.motion[0].len());
        let panel = |i: usize| {
            let (measured, model) = (&self.record.force[i], &predicted[i]);
            let points = |label: &str, value: &dyn Fn(usize) -> f64| {
                let at = |n: usize| (n - first) as f64 / h.sampling_hz * self.frequency_hz;
                let points = (first..last).map(|n| (at(n), value(n)));
                PlottedSeries::new(label, points.collect())
            };
            let series = [
                points(origin, &|n| measured[n]),
                points("model", &|n| model[n]),
                points(&format!("{origin} less model"), &|n| measured[n] - model[n]),
            ];
            TimePanel::new(self.label(h, i), series)
        };
        Ok((0..h.dofs.len()).map(panel).collect())
    }

    fn label(&self, header: &RecordHeader, force: usize) -> String {
        let force = header.dofs[force];
        let unit = if force == Dof::Torsion { "N" } else { "N/m" };
        let (force, motion) = (force.force_name(), self.motion.name());
        format!("{force} by {motion} ({unit})")
    }
}

/// The motion that is largest over the width.
fn driven(record: &Record) -> Option<Dof> {
    let h = &record.header;
    let size = |(dof, motion): (&Dof, &Vec<f64>)| {
        let largest = motion.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        (largest * dof.motion_scale(h.width_m), *dof)
    };
    let all = h.dofs.iter().zip(&record.motion).map(size);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, dof)| dof)
}
