//! What goes into a step and what comes out of it.

use crate::error::{Error, Result, non_negative};

/// A wind below zero by this part of the wind before it (of 1 m/s at least) is at rest: what rounding leaves of a ramp
/// of some ten thousand steps.
const REST: f64 = 1e-9;
/// `wind_speed_m_s`, or zero where rounding alone has taken a wind that comes to rest below zero; `before_m_s` is the wind
/// it came from.
pub fn wind_at_rest(wind_speed_m_s: f64, before_m_s: f64) -> f64 {
    if (-REST * before_m_s.max(1.0)..0.0).contains(&wind_speed_m_s) {
        0.0
    } else {
        wind_speed_m_s
    }
}

/// Gust of a channel.
pub(super) fn stated(gusts: &[f64], channel: usize) -> f64 {
    gusts.get(channel).copied().unwrap_or(0.0)
}

/// Wind speed and external forces at the start of a step, and their constant rates over it.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Wind speed, m/s.
    pub wind_speed_m_s: f64,
    /// Rate of the wind speed over the step, m/s².
    pub wind_speed_rate_m_s2: f64,
    /// External forces per unit length (n): N/m, N·m/m.
    pub force: Vec<f64>,
    /// Rates of the external forces over the step (n): per second.
    pub force_rate: Vec<f64>,
    /// Gusts `u` along the mean wind and `w` upwards, m/s (on a bridge the forces of all gusts on each mode, per 1 m/s of
    /// wind), for a stepper that knows their forces; what is not stated is zero.
    pub gust_m_s: Vec<f64>,
    /// Their rates over the step, per second.
    pub gust_rate_m_s2: Vec<f64>,
}

impl SectionState {
    /// Becomes equal to `other`; takes no memory where there is room.
    pub fn set_to(&mut self, other: &Self) {
        self.values.clone_from(&other.values);
        self.gusts.clone_from(&other.gusts);
        (self.phase, self.last_wind_m_s) = (other.phase, other.last_wind_m_s);
    }

    /// All numbers in one list: those of the section, then the lagging gusts.
    pub fn all(&self) -> Vec<f64> {
        [self.values.as_slice(), &self.gusts].concat()
    }

    /// Number `i` of [`SectionState::all`].
    pub fn number(&self, i: usize) -> f64 {
        let behind = i.checked_sub(self.values.len());
        behind.map_or_else(|| self.values[i], |behind| self.gusts[behind])
    }

    /// Replaces number `i` of [`SectionState::all`].
    pub fn set_number(&mut self, i: usize, number: f64) {
        let behind = i.checked_sub(self.values.len());
        match behind {
            Some(behind) => self.gusts[behind] = number,
            None => self.values[i] = number,
        }
    }

    /// The same state with other numbers in [`SectionState::all`].
    #[must_use]
    pub fn with_all(&self, numbers: &[f64]) -> Self {
        let mut other = self.clone();
        let (values, gusts) = numbers.split_at(self.values.len());
        other.values.copy_from_slice(values);
        other.gusts.copy_from_slice(gusts);
        other
    }
}

impl Inputs {
    /// Steady wind on a section of `dofs` degrees of freedom without external force.
    pub fn steady(wind_speed_m_s: f64, dofs: usize) -> Self {
        Self {
            wind_speed_m_s,
            wind_speed_rate_m_s2: 0.0,
            force: vec![0.0; dofs],
            force_rate: vec![0.0; dofs],
            gust_m_s: Vec::new(),
            gust_rate_m_s2: Vec::new(),
        }
    }

    /// Becomes equal to `other`; takes no memory where there is room.
    pub fn set_to(&mut self, other: &Self) {
        self.wind_speed_m_s = other.wind_speed_m_s;
        self.wind_speed_rate_m_s2 = other.wind_speed_rate_m_s2;
        self.force.clone_from(&other.force);
        self.force_rate.clone_from(&other.force_rate);
        self.gust_m_s.clone_from(&other.gust_m_s);
        self.gust_rate_m_s2.clone_from(&other.gust_rate_m_s2);
    }

    /// Whether they can be those of a step of so many seconds, or, of none, of an instant.
    pub(super) fn check(&self, dofs: usize, step_s: f64) -> Result<()> {
        let wind = self.wind_speed_m_s;
        non_negative("wind speed", wind_at_rest(wind, 0.0))?;
        let finite = |values: &[f64]| values.len() == dofs && values.iter().all(|x| x.is_finite());
        let gusts = self.gust_m_s.iter().chain(&self.gust_rate_m_s2);
        let steady = gusts.chain([&self.wind_speed_rate_m_s2]);
        if finite(&self.force)
            && finite(&self.force_rate)
            && steady.into_iter().all(|x| x.is_finite())
        {
            let end = wind_at_rest(wind + self.wind_speed_rate_m_s2 * step_s, wind);
            non_negative("wind speed at the end of the step", end).map(drop)
        } else {
            Err(Error::input(
                "inputs",
                format!("{dofs} finite forces and rates, finite gusts and rate of the wind"),
                format!(
                    "forces {:?}, rates {:?}, gusts {:?}, rates {:?}, rate of the wind {}",
                    self.force,
                    self.force_rate,
                    self.gust_m_s,
                    self.gust_rate_m_s2,
                    self.wind_speed_rate_m_s2
                ),
            ))
        }
    }
}

/// State of the section in motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SectionState {
    /// `[q, q̇, x]`: displacements (m, rad), rates, filter states (dimensionless).
    pub values: Vec<f64>,
    /// Gusts behind the lags of their admittance: those of `u`, then those of `w`, m/s.
    pub gusts: Vec<f64>,
    /// Part of `Δs` that has passed since the last sample of the discrete model, in `[0, 1)`; 0 for continuous models.
    pub phase: f64,
    /// Wind speed at the start of the last step, m/s; none since the release. A wind that stays is
    /// worth a matrix. It is part of the state, so that a step from here always gives the same bits.
    pub last_wind_m_s: Option<f64>,
}

/// What the section does at an instant; vectors in the order of the degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outputs {
    /// Displacements: m, rad.
    pub displacement: Vec<f64>,
    /// Rates: m/s, rad/s.
    pub rate: Vec<f64>,
    /// Accelerations: m/s², rad/s².
    pub acceleration: Vec<f64>,
    /// Self-excited forces per unit length: N/m, N·m/m.
    pub self_excited_force: Vec<f64>,
}

impl Outputs {
    /// Displacements, rates, accelerations and self-excited forces.
    pub fn lists(&self) -> [&Vec<f64>; 4] {
        [
            &self.displacement,
            &self.rate,
            &self.acceleration,
            &self.self_excited_force,
        ]
    }
}
