//! Metrics of the forces over the grid, as in Figures 3.18 and 3.19 of the thesis: one frequency of motion.
//!
//! The steady part of one segment is compared with what the model predicts for the motion of that record,
//! `q = |G| A sin(ωt + φ + arg G)` with amplitude and phase of the recorded motion by least squares: the harmonic motion
//! has lasted long enough there for the model's own transients to have died.

use crate::aerodynamics::Transfer;
use crate::comparison::{PhaseParameters, SignalPair, magnitude, magnitude_warped, peak, phase};
use crate::error::{Error, Result, ensure};
use crate::identification::{CellFit, Grid};
use crate::numbered::numbered;
use crate::section::Dof;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, RecordSource};
use nalgebra::DMatrix;
use serde::Serialize;
use std::f64::consts::TAU;

/// Part of the segment that is compared.
const STEADY: (f64, f64) = (0.3, 0.7);
/// Phase difference that brings the phase metric to 1/e, degrees (thesis, section 3.5.1).
const SIGNIFICANT_PHASE_DEG: f64 = 5.0;
/// Band of the warping, periods.
const WARPING_PERIODS: f64 = 0.25;

/// Metrics of one cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellMetrics {
    /// Phase `M_φ`, sub-sample lag.
    pub phase: Option<f64>,
    /// Why there is no `M_φ`.
    pub problem: Option<String>,
    /// Peak `M_p`.
    pub peak: f64,
    /// Magnitude after warping `M_m`.
    pub magnitude_warped: f64,
    /// Magnitude sample by sample `M_muw`.
    pub magnitude: f64,
}

/// Metrics of one force due to one motion over the whole grid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetricGrid {
    /// Record.
    pub record: String,
    /// Force that is compared.
    pub force: Dof,
    /// Motion that causes it.
    pub motion: Dof,
    /// Frequency of the motion, Hz.
    pub frequency_hz: f64,
    /// All numbers of filters of the first value first; `None` where there is no fit.
    pub cells: Vec<Option<CellMetrics>>,
}

/// Metrics of the force in the direction of the motion, for each motion, in the segment whose frequency is nearest to
/// `frequency_hz` at the highest mean speed. Parallel over the values of the axis.
pub fn metric_grid(
    grid: &Grid,
    records: &[&dyn RecordSource],
    frequency_hz: f64,
) -> Result<Vec<MetricGrid>> {
    let mut grids = Vec::new();
    for (i, dof) in grid.dofs.iter().enumerate() {
        let Some(steady) = SteadySegment::new(records, *dof, frequency_hz)? else {
            continue;
        };
        let metrics = |fit: Result<CellFit>| {
            let fit = fit.ok();
            fit.map(|fit| steady.compare(&fit.model, i)).transpose()
        };
        let cells = numbered(grid.values().len(), &|_, _| (), |value| {
            let fits = grid.fits(value, &|_| true).into_iter();
            fits.map(metrics).collect::<Result<Vec<_>>>()
        })?;
        grids.push(MetricGrid {
            record: steady.record,
            force: *dof,
            motion: *dof,
            frequency_hz: steady.frequency_hz,
            cells: cells.concat(),
        });
    }
    let expected = "segments of harmonic motion";
    ensure(!grids.is_empty(), "records", expected, "none")?;
    Ok(grids)
}

/// Steady part of one segment.
struct SteadySegment {
    record: String,
    frequency_hz: f64,
    k: ReducedFrequency,
    step_s: f64,
    /// Dimensionless force in the direction of the motion.
    force: Vec<f64>,
    /// Dimensionless motion, `a sin ωt + b cos ωt` with the time of the samples.
    motion: (f64, f64),
}

impl SteadySegment {
    fn new(records: &[&dyn RecordSource], dof: Dof, wanted_hz: f64) -> Result<Option<Self>> {
        let mut best: Option<(Record, usize)> = None;
        for record in records {
            let header = record.header();
            let distance = |s: usize| (header.segments[s].frequency_hz / wanted_hz).ln().abs();
            let nearest =
                (0..header.segments.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
            let channel = header.dofs.iter().position(|d| *d == dof);
            let (Some(segment), Some(channel)) = (nearest, channel) else {
                continue;
            };
            let speed = header.mean_speed_m_s;
            let faster = |(b, _): &(Record, usize)| speed > b.header.mean_speed_m_s;
            if best.as_ref().is_none_or(faster) {
                let whole = Record::whole(*record)?;
                if whole.motion[channel].iter().any(|x| *x != 0.0) {
                    best = Some((whole, segment));
                }
            }
        }
        best.map(|(record, segment)| Self::cut(&record, dof, segment))
            .transpose()
    }

    fn cut(record: &Record, dof: Dof, segment: usize) -> Result<Self> {
        let header = &record.header;
        let s = header.segments[segment];
        let length = s.end_s - s.start_s;
        let at = |part: f64| ((s.start_s + part * length) * header.sampling_hz) as usize;
        let (from, to) = (at(STEADY.0), at(STEADY.1));
        let channel = header.dofs.iter().position(|d| *d == dof).unwrap_or(0);
        let pressure = 0.5 * header.air_density_kg_m3 * header.mean_speed_m_s.powi(2);
        let force_scale = 1.0 / (pressure * dof.force_scale(header.width_m));
        let motion_scale = dof.motion_scale(header.width_m);
        let scaled = |x: &[f64], factor: f64| -> Vec<f64> {
            let (first, last) = (from.min(x.len()), to.min(x.len()));
            x[first..last].iter().map(|x| factor * x).collect()
        };
        let motion = scaled(&record.motion[channel], motion_scale);
        let force = scaled(&record.force[channel], force_scale);
        let step_s = 1.0 / header.sampling_hz;
        let omega = TAU * s.frequency_hz;
        Ok(Self {
            record: header.name.clone(),
            frequency_hz: s.frequency_hz,
            k: ReducedFrequency::from_hertz(s.frequency_hz, header.width_m, header.mean_speed_m_s),
            step_s,
            motion: harmonic(&motion, omega * step_s)?,
            force,
        })
    }

    fn compare(&self, model: &dyn Transfer, i: usize) -> Result<CellMetrics> {
        let g = model.transfer(self.k)?[(i, i)];
        let angle = TAU * self.frequency_hz * self.step_s;
        let (a, b) = self.motion;
        // q = Re(G) r + Im(G) r'/K, with r'/K a quarter of a period ahead
        let (sine, cosine) = (g.re * a - g.im * b, g.re * b + g.im * a);
        let at = |k| {
            let (s, c) = (angle * k as f64).sin_cos();
            sine * s + cosine * c
        };
        let predicted: Vec<f64> = (0..self.force.len()).map(at).collect();
        let pair = SignalPair::new(&self.force, &predicted, self.step_s)?;
        let lag = PhaseParameters {
            significant_delay_s: SIGNIFICANT_PHASE_DEG / 360.0 / self.frequency_hz,
            ..PhaseParameters::default()
        };
        let phase = phase(&pair, &lag);
        let band = (WARPING_PERIODS / self.frequency_hz / self.step_s).ceil() as usize;
        Ok(CellMetrics {
            problem: phase.as_ref().err().map(ToString::to_string),
            phase: phase.ok().map(|found| found.value),
            peak: peak(&pair)?.value,
            magnitude_warped: magnitude_warped(&pair, Some(band))?.value,
            magnitude: magnitude(&pair)?.value,
        })
    }
}

/// Coefficients of sine and cosine by least squares.
fn harmonic(samples: &[f64], angle: f64) -> Result<(f64, f64)> {
    let basis = DMatrix::from_fn(samples.len(), 2, |k, c| {
        let (s, co) = (angle * k as f64).sin_cos();
        if c == 0 { s } else { co }
    });
    let gram = basis.transpose() * &basis;
    let right = basis.transpose() * nalgebra::DVector::from_column_slice(samples);
    let still = || Error::Numerical("metrics: a segment without steady motion".into());
    let solution = gram.cholesky().ok_or_else(still)?.solve(&right);
    Ok((solution[0], solution[1]))
}
