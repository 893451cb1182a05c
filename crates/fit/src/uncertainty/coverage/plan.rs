//! A virtual campaign that is repeated.

use crate::error::{Result, ensure, non_negative, positive};
use crate::identification::{Constraints, Form, PoleSearch, TimeFit, TimeWeights};
use crate::wind_tunnel::TunnelPlan;
use serde::{Deserialize, Serialize};

/// What the forces of the virtual tunnel follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Truth {
    /// R. T. Jones's rational function: poles 0.091 and 0.6.
    Jones,
    /// Theodorsen's function: outside every class of finitely many filters.
    Theodorsen,
}

/// A virtual campaign that is repeated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CoveragePlan {
    /// What the forces follow.
    pub truth: Truth,
    /// Poles of the fitted Takenaka–Malmquist filters.
    pub poles: Vec<f64>,
    /// Whether the poles are searched, from those.
    pub search_poles: bool,
    /// Weights of the fit.
    pub weights: TimeWeights,
    /// The tunnel; noise and seed among it.
    pub tunnel: TunnelPlan,
    /// Standard deviation of every transfer function between mean speeds, relative, in size and in phase.
    pub speed_scatter: f64,
    /// The same between runs (one motion at one speed), for all forces of a run together.
    pub run_scatter: f64,
    /// Number of repetitions.
    pub repetitions: usize,
}

impl Default for CoveragePlan {
    fn default() -> Self {
        Self {
            truth: Truth::Jones,
            poles: vec![0.091, 0.6],
            search_poles: false,
            weights: TimeWeights::default(),
            tunnel: TunnelPlan {
                noise_fraction: 0.05,
                ..TunnelPlan::default()
            },
            speed_scatter: 0.0,
            run_scatter: 0.0,
            repetitions: 500,
        }
    }
}

/// More are hours, and their results no longer fit into memory.
const MOST_REPETITIONS: usize = 1_000_000;

impl CoveragePlan {
    pub(super) fn validate(&self) -> Result<()> {
        ensure(
            (2..=MOST_REPETITIONS).contains(&self.repetitions),
            "repetitions",
            format_args!("2 to {MOST_REPETITIONS}"),
            self.repetitions,
        )?;
        // without any the repetitions are one, and their scatter is rounding
        positive("tunnel.noise_fraction", self.tunnel.noise_fraction)?;
        for p in &self.poles {
            positive("poles", *p)?;
        }
        non_negative("speed_scatter", self.speed_scatter)?;
        non_negative("run_scatter", self.run_scatter).map(drop)
    }

    /// The fit whose intervals are judged.
    pub(super) fn time_fit(&self) -> TimeFit {
        let given = PoleSearch {
            start: Some(self.poles.clone()),
            ..PoleSearch::default()
        };
        TimeFit {
            // −(e₁ + e₁ᵀ) of a flat plate is singular: the truth lies on a constraint, which would bind now and then
            constraints: Constraints::None,
            form: Form::takenaka_malmquist(self.poles.len()),
            poles: match self.search_poles {
                true => given,
                false => PoleSearch::fixed(&self.poles),
            },
            weights: self.weights,
            ..TimeFit::default()
        }
    }
}
