//! Models asked for the forces of records, and the metrics of these against what was measured, one set per frequency of the motion.

use super::options::{CompareOptions, Scoring, TestedDeck};
use crate::comparison::{
    PhaseParameters, SignalPair, WaveletParameters, magnitude, magnitude_warped, peak, phase,
    probability_density, rms, wavelet,
};
use crate::error::{Result, ensure, positive};
use crate::files::text::csv_cell;
use crate::section::Dof;
use crate::trained_model::Model;
use crate::wind_tunnel::{Record, Segment, predicted_forces};
use serde::Serialize;
use std::fmt::Write as _;
use std::ops::Range;

/// How alike two forces are: 1 for equal ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForceMetrics {
    /// `M_φ`.
    pub phase: f64,
    /// `M_p`.
    pub peak: f64,
    /// `M_rms`.
    pub rms: f64,
    /// `M_muw`, unwarped.
    pub magnitude: f64,
    /// `M_mw`, after dynamic time warping.
    pub magnitude_warped: f64,
    /// `M_w`, wavelet, from half to twice the frequency of the motion.
    pub wavelet: f64,
    /// `M_pdf`.
    pub probability_density: f64,
    /// Lag behind the phase metric, degrees of the frequency of the motion; positive if the prediction is late.
    pub lag_deg: f64,
}

impl ForceMetrics {
    /// Names of the metrics as the thesis and the toolbox write them, in the order of `ForceMetrics::values`.
    pub const NAMES: [&str; 7] = ["M_phi", "M_p", "M_rms", "M_muw", "M_mw", "M_w", "M_pdf"];

    /// The metrics without the lag.
    pub(crate) fn values(&self) -> [f64; 7] {
        [
            self.phase,
            self.peak,
            self.rms,
            self.magnitude,
            self.magnitude_warped,
            self.wavelet,
            self.probability_density,
        ]
    }
}

/// A force due to a motion, as one model predicts it for one deck at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// Deck.
    pub deck: String,
    /// Model that predicts.
    pub model: String,
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Whether the model was not trained on this record.
    pub held_out: bool,
    /// Motion.
    pub motion: Dof,
    /// Force.
    pub force: Dof,
}

/// Metrics at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// What is predicted.
    #[serde(flatten)]
    pub case: Case,
    /// Frequency of the motion, Hz.
    pub frequency_hz: f64,
    /// The metrics.
    pub metrics: ForceMetrics,
}

impl Scoring {
    /// Samples of the steady motion that are compared: whole periods in the middle between the ramps.
    fn window(&self, record: &Record, segment: &Segment, ramp_s: f64) -> Result<Range<usize>> {
        let length = positive("window_s", self.window_s)?;
        let (start, end) = (segment.start_s + ramp_s, segment.end_s - ramp_s);
        let periods = ((end - start).min(length) * segment.frequency_hz + 1e-6).floor();
        ensure(
            periods >= 1.0,
            format_args!("record {}, {} Hz", record.header.name, segment.frequency_hz),
            "a window and a steady motion of at least one period",
            format_args!("{:.2} s", (end - start).min(length)),
        )?;
        let half = 0.5 * periods / segment.frequency_hz;
        let at = |t: f64| (t * record.header.sampling_hz).round() as usize;
        let middle = 0.5 * (start + end);
        Ok(at(middle - half)..at(middle + half))
    }

    /// Metrics of one force in a window of samples.
    pub(crate) fn metrics(
        &self,
        measured: &[f64],
        predicted: &[f64],
        sampling_hz: f64,
        frequency_hz: f64,
    ) -> Result<ForceMetrics> {
        let pair = SignalPair::new(measured, predicted, 1.0 / sampling_hz)?;
        let lag = PhaseParameters {
            significant_delay_s: self.significant_phase_deg / (360.0 * frequency_hz),
            ..PhaseParameters::default()
        };
        let phase = phase(&pair, &lag)?;
        // a mother wavelet of one cycle: its cone leaves room in a window of three periods
        let levels = WaveletParameters {
            level_count: 24,
            frequency_min_hz: 0.5 * frequency_hz,
            frequency_max_hz: 2.0 * frequency_hz,
            central_frequency: 1.0,
            ..WaveletParameters::default()
        };
        Ok(ForceMetrics {
            phase: phase.value,
            peak: peak(&pair)?.value,
            rms: rms(&pair)?.value,
            magnitude: magnitude(&pair)?.value,
            magnitude_warped: magnitude_warped(&pair, None)?.value,
            wavelet: wavelet(&pair, &levels)?.value,
            probability_density: probability_density(&pair, true)?.value,
            lag_deg: phase.details.lag_s * frequency_hz * 360.0,
        })
    }
}

/// Mean and lowest metrics over the frequencies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScoreSummary {
    /// What is predicted.
    #[serde(flatten)]
    pub case: Case,
    /// Mean of each metric, in the order of [`ForceMetrics::NAMES`].
    pub mean: [f64; 7],
    /// Lowest value of each metric.
    pub lowest: [f64; 7],
}

/// One summary per case, in the order of the scores.
pub(crate) fn summaries(scores: &[Score]) -> Vec<ScoreSummary> {
    let mut all: Vec<Vec<&Score>> = Vec::new();
    for score in scores {
        match all.iter_mut().find(|group| group[0].case == score.case) {
            Some(group) => group.push(score),
            None => all.push(vec![score]),
        }
    }
    let summary = |group: Vec<&Score>| {
        let of = |m: usize| group.iter().map(move |s| s.metrics.values()[m]);
        ScoreSummary {
            case: group[0].case.clone(),
            mean: std::array::from_fn(|m| of(m).sum::<f64>() / group.len() as f64),
            lowest: std::array::from_fn(|m| of(m).fold(f64::INFINITY, f64::min)),
        }
    };
    all.into_iter().map(summary).collect()
}

/// The scores as a CSV table.
pub fn score_table(scores: &[Score]) -> String {
    let mut text = format!(
        "deck,model,speed_m_s,held_out,motion,force,frequency_hz,{},lag_deg\n",
        ForceMetrics::NAMES.join(",")
    );
    for Score {
        case,
        frequency_hz,
        metrics,
    } in scores
    {
        let values = metrics.values().map(|v| format!("{v:.6}")).join(",");
        let _ = writeln!(
            text,
            "{},{},{:.3},{},{},{},{frequency_hz:.4},{values},{:.4}",
            csv_cell(&case.deck),
            csv_cell(&case.model),
            case.speed_m_s,
            case.held_out,
            case.motion.name(),
            case.force.name(),
            metrics.lag_deg
        );
    }
    text
}

impl TestedDeck {
    /// What a model predicts for a record, one vector per force, and its scores, one per force and frequency. `name` is that of the model
    /// in the results; it is `held_out` where it was not trained on this record.
    pub(super) fn scores(
        &self,
        record: &Record,
        name: &str,
        model: &Model,
        held_out: bool,
        options: &CompareOptions,
    ) -> Result<(Vec<Vec<f64>>, Vec<Score>)> {
        let predicted = predicted_forces(model, record)?;
        let h = &record.header;
        let motion = record.moving().next().unwrap_or(h.dofs[0]);
        let mut scores = Vec::new();
        for (i, &force) in h.dofs.iter().enumerate() {
            let case = Case {
                deck: self.table.name.clone(),
                model: name.to_owned(),
                speed_m_s: h.mean_speed_m_s,
                held_out,
                motion,
                force,
            };
            for segment in &h.segments {
                let (scoring, frequency_hz) = (&options.scoring, segment.frequency_hz);
                let window = scoring.window(record, segment, self.plan.ramp_s)?;
                let measured = &record.force[i][window.clone()];
                let predicted = &predicted[i][window];
                let metrics = scoring.metrics(measured, predicted, h.sampling_hz, frequency_hz);
                let which = || format!("{}, {} force, {frequency_hz} Hz", case.deck, force.name());
                scores.push(Score {
                    case: case.clone(),
                    frequency_hz,
                    metrics: metrics.map_err(|e| e.within(which()))?,
                });
            }
        }
        Ok((predicted, scores))
    }
}
