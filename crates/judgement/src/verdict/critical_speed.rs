//! What begins at which wind speed.

use serde::{Deserialize, Serialize};

/// What begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phenomenon {
    /// An oscillation that grows.
    Flutter,
    /// An oscillation that grows by extrapolation alone, below the onset.
    Growth,
    /// Static divergence.
    Divergence,
    /// Galloping by quasi-steady theory.
    Galloping,
}

impl Phenomenon {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flutter => "flutter",
            Self::Growth => "growth outside the tests",
            Self::Divergence => "static divergence",
            Self::Galloping => "galloping",
        }
    }
}

/// A wind speed at which something critical begins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CriticalSpeed {
    /// What begins.
    pub phenomenon: Phenomenon,
    /// By which forces.
    pub forces: String,
    /// Best estimate, m/s.
    pub best_m_s: f64,
    /// Lower end, m/s; `None` where it is not known, zero where nothing tells at which lower speed it begins.
    pub lower_m_s: Option<f64>,
    /// Whether it lies where nothing was tested.
    pub extrapolated: bool,
}

impl CriticalSpeed {
    /// Galloping by quasi-steady theory; `forces` says whose coefficients, as part of a sentence.
    pub fn galloping(forces: impl Into<String>, best_m_s: f64) -> Self {
        Self {
            phenomenon: Phenomenon::Galloping,
            forces: forces.into(),
            best_m_s,
            lower_m_s: None,
            extrapolated: false,
        }
    }

    /// The lower end, or the best estimate where there is none, m/s.
    pub fn least_m_s(&self) -> f64 {
        self.lower_m_s
            .map_or(self.best_m_s, |l| l.min(self.best_m_s))
    }
}
