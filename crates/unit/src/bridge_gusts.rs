//! Gusts that an exported bridge takes: as inputs of strips, and from a field in its archive.

use crate::aerodynamics::RationalAdmittance;
use crate::bridge::Bridge;
use crate::error::{Error, Result, ensure, finite, positive};
use crate::gust_channels::GustChannels;
use serde::{Deserialize, Serialize};

/// The file of the turbulence in `resources/`; an archive without it brings none of its own.
pub const TURBULENCE_FILE: &str = "turbulence.json";

/// Gusts of a bridge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeGusts {
    /// Buffeting matrix of each group over `½ρV²`: rows vertical, lateral, rotation; columns `u/V`, `w/V`.
    pub coefficients: Vec<[[f64; 2]; 3]>,
    /// On both components.
    pub admittance: RationalAdmittance,
    /// Indices of the nodes in one gust; two inputs each.
    pub strips: Vec<Vec<usize>>,
    /// Where the coefficients come from, in words.
    pub source: String,
}

impl BridgeGusts {
    /// Checks numbers and strips.
    pub(super) fn validate(&self, bridge: &Bridge) -> Result<()> {
        for (group, matrix) in self.coefficients.iter().enumerate() {
            for x in matrix.iter().flatten() {
                finite(format!("gusts: coefficients of group {}", group + 1), *x)?;
            }
        }
        GustChannels::new(bridge, &self.coefficients, &self.strips).map(drop)
    }
}

/// A field of turbulence that blows whenever the unit runs, one gust per node. It begins at the time zero and repeats itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurbulenceOptions {
    /// Time from sample to sample, s.
    pub step_s: f64,
    /// `u` of every node of the bridge, m/s: a row of samples per node.
    pub u: Vec<Vec<f64>>,
    /// `w`.
    pub w: Vec<Vec<f64>>,
}

impl TurbulenceOptions {
    /// Reads a field for a bridge of so many nodes, with the forces of its gusts.
    ///
    /// # Errors
    /// [`Error::Input`] for text that is none, for a bridge without such forces, and for another number of nodes or of
    /// samples.
    pub fn from_json(text: &str, nodes: usize, gusts: Option<&BridgeGusts>) -> Result<Self> {
        let field: Self =
            serde_json::from_str(text).map_err(|e| Error::json("a field of turbulence", &e))?;
        positive("step_s", field.step_s)?;
        let expected = "a bridge with gust forces";
        ensure(gusts.is_some(), "turbulence", expected, "one without")?;
        let samples = field.samples();
        for (name, rows) in [("u", &field.u), ("w", &field.w)] {
            let even = rows.iter().all(|r| r.len() == samples);
            ensure(
                rows.len() == nodes && samples >= 2 && even,
                name,
                format_args!("{nodes} rows of at least 2 samples, all of one length"),
                format_args!("{} rows, the first of {samples} samples", rows.len()),
            )?;
            for (i, row) in rows.iter().enumerate() {
                let finite = row.iter().all(|x| x.is_finite());
                ensure(
                    finite,
                    format_args!("{name}[{i}]"),
                    "finite gusts",
                    "others",
                )?;
            }
        }
        Ok(field)
    }

    fn samples(&self) -> usize {
        self.u.first().map_or(0, Vec::len)
    }

    /// What it does to the channels of a bridge, sample by sample.
    pub(super) fn channels(&self, bridge: &Bridge, gusts: &BridgeGusts) -> Result<GustRecord> {
        let strips: Vec<Vec<usize>> = (0..bridge.nodes.len()).map(|n| vec![n]).collect();
        let all = GustChannels::new(bridge, &gusts.coefficients, &strips)?;
        let sample = |i: usize| {
            let mut channels = vec![0.0; all.convection_per_width.len() * bridge.coordinates()];
            let nodes = self.u.iter().zip(&self.w);
            all.add(nodes.flat_map(|(u, w)| [u[i], w[i]]), &mut channels);
            channels
        };
        Ok(GustRecord {
            step_s: self.step_s,
            samples: (0..self.samples()).map(sample).collect(),
        })
    }
}

/// Channels over time, on straight lines from sample to sample, over and over again.
#[derive(Debug, Clone)]
pub(super) struct GustRecord {
    step_s: f64,
    samples: Vec<Vec<f64>>,
}

/// A sample closer than this part of the step is the next one: times are sums of steps.
const SAME_SAMPLE: f64 = 1e-9;
/// So is one closer than this part of the time, a few roundings: a piece of less would not move the time on.
const SAME_TIME: f64 = 4.0 * f64::EPSILON;

impl GustRecord {
    /// Adds `factor` times the channels at a time, and their rates from there on.
    pub(super) fn add(&self, time: f64, factor: f64, channels: &mut [f64], rates: &mut [f64]) {
        let (sample, part) = self.sample_at(time);
        let count = self.samples.len();
        let (now, next) = (&self.samples[sample], &self.samples[(sample + 1) % count]);
        for (i, (a, b)) in now.iter().zip(next).enumerate() {
            channels[i] += factor * (a + part * (b - a));
            rates[i] += factor * (b - a) / self.step_s;
        }
    }

    /// Time left at `time` until the next sample, s.
    pub(super) fn to_next(&self, time: f64) -> f64 {
        (1.0 - self.sample_at(time).1) * self.step_s
    }

    /// Pieces into which a time is cut.
    pub(super) fn pieces(&self, duration: f64) -> f64 {
        duration / self.step_s
    }

    /// Sample at or before a time, and the part of a step since.
    fn sample_at(&self, time: f64) -> (usize, f64) {
        let steps = time / self.step_s;
        let mut whole = steps.floor();
        let mut part = steps - whole;
        if part > 1.0 - SAME_SAMPLE.max(SAME_TIME * steps.abs()) {
            (whole, part) = (whole + 1.0, 0.0);
        }
        let sample = whole.rem_euclid(self.samples.len() as f64);
        (sample as usize % self.samples.len(), part)
    }
}
