//! Buffeting of a whole bridge: strips in turbulence whose coherence falls along the span.
//!
//! With `P_ca(i) = w_i Σ_d φ_a,d(i) ½ρV_i diag(B, B, B²) A_dc χ(ωB/V_i) √S_c(f, V_i)` for component `c`, mode `a` and node `i`, and
//! Davenport's coherence `C_ij = exp(−C_c f |x_i − x_j|/V)`, the spectra of the modal forces are `S_Q = Σ_c P_cᴴ C P_c`, a full
//! matrix. Exponential coherence along a line is that of a Markov chain: products with `C` and samples of the turbulence cost one
//! pass along the span instead of a factorisation.

mod covariance;
mod field;
mod frequency;
mod time;

pub(crate) use covariance::ModalCovariance;
pub use field::{TurbulenceField, turbulence_field};
pub(crate) use frequency::{SpanFrequency, peak_factor};
pub use frequency::{SpanResponse, SpanSpectra};
pub(crate) use time::span_ensemble;
pub use time::{SpanEnsemble, SpanPlan, SpanRecord, span_record};

use super::problem::{Gust, Turbulence};
use super::spectrum::GustComponent;
use crate::aeroelastic::CoupledSection;
use crate::bridge::{Bridge, StripGroup, motion_index};
use crate::error::{Error, Result, counted, positive};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// Decay of the coherence along the span, `exp(−decay f Δs/V)`, for each component of the turbulence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Coherence {
    /// Of `u`.
    pub along: f64,
    /// Of `w`.
    pub vertical: f64,
}

impl Default for Coherence {
    /// What bridge codes take where nothing was measured.
    fn default() -> Self {
        Self {
            along: 10.0,
            vertical: 6.5,
        }
    }
}

impl Coherence {
    fn decay(&self, component: GustComponent) -> f64 {
        match component {
            GustComponent::Along => self.along,
            GustComponent::Vertical => self.vertical,
        }
    }

    /// Checks both decays.
    ///
    /// # Errors
    /// [`Error::Input`] naming the key below `place`.
    pub fn validate(&self, place: &str) -> Result<()> {
        for (key, value) in [("along", self.along), ("vertical", self.vertical)] {
            if !(value > 0.0 && value.is_finite()) {
                let expected = "a decay of the coherence in (0, ∞)";
                return Err(Error::input(
                    format!("{place}.{key}"),
                    expected,
                    value.to_string(),
                ));
            }
        }
        Ok(())
    }

    /// Coherence of neighbouring nodes at a frequency, one a gap.
    fn of_gaps(
        &self,
        component: GustComponent,
        bridge: &Bridge,
        frequency_hz: f64,
        speed_m_s: f64,
    ) -> Vec<f64> {
        let rate = self.decay(component) * frequency_hz / speed_m_s;
        bridge
            .nodes
            .windows(2)
            .map(|n| (-rate * (n[1].along_m - n[0].along_m)).exp())
            .collect()
    }
}

/// A bridge in turbulence.
#[derive(Debug, Clone)]
pub struct SpanProblem<'a> {
    /// The bridge with its self-excited forces.
    pub bridge: &'a Bridge,
    /// Gust forces of each group over `½ρV²` and its width (squared for the moment): rows vertical, lateral, rotation;
    /// columns `u/V`, `w/V`.
    pub gust_matrices: Vec<[[f64; 2]; 3]>,
    /// Spectra and admittances.
    pub turbulence: Turbulence,
    /// Coherence along the span.
    pub coherence: Coherence,
}

impl SpanProblem<'_> {
    fn validate(&self, speed_m_s: f64) -> Result<()> {
        positive("wind speed", speed_m_s)?;
        self.coherence.validate("coherence")?;
        self.turbulence.validate("turbulence")?;
        let (found, groups) = (self.gust_matrices.len(), self.bridge.groups.len());
        if found == groups {
            return Ok(());
        }
        let expected = format!("gust forces of {}", counted(groups, "group"));
        Err(Error::input("buffeting", expected, found.to_string()))
    }

    /// Wind factor at every node; zero outside the groups.
    fn wind_factors(&self) -> Vec<f64> {
        let mut factors = vec![0.0; self.bridge.nodes.len()];
        for group in &self.bridge.groups {
            for &n in &group.nodes {
                factors[n] = group.wind_factor;
            }
        }
        factors
    }

    /// Force on the mass-normalised modes by a gust of 1 m/s at each node (nodes×modes) that is longer than the deck is wide.
    fn force_of_long_gusts(&self, component: GustComponent, speed_m_s: f64) -> DMatrix<f64> {
        let bridge = self.bridge;
        let column = match component {
            GustComponent::Along => 0,
            GustComponent::Vertical => 1,
        };
        let mut forces = DMatrix::zeros(bridge.nodes.len(), bridge.coordinates());
        for (group, matrix) in bridge.groups.iter().zip(&self.gust_matrices) {
            let pressure = 0.5 * bridge.air_density_kg_m3 * group.wind_factor * speed_m_s;
            let of = |dof: Dof| {
                pressure * dof.force_scale(group.width_m) * matrix[motion_index(dof)][column]
            };
            let per_length = Dof::THREE.map(of);
            for &n in &group.nodes {
                let length = bridge.nodes[n].length_m;
                for (m, mode) in bridge.modes.iter().enumerate() {
                    let shape = mode.shape[n].iter().zip(per_length);
                    let work: f64 = shape.map(|(phi, f)| phi * f).sum();
                    forces[(n, m)] = length * work / mode.generalised_mass.sqrt();
                }
            }
        }
        forces
    }

    /// Part of that force that gusts of a frequency exert at the nodes of a group in wind.
    fn admittance(
        &self,
        gust: &Gust,
        group: &StripGroup,
        frequency_hz: f64,
        speed_m_s: f64,
    ) -> Complex<f64> {
        let local = group.wind_factor * speed_m_s;
        let k = ReducedFrequency::from_hertz(frequency_hz, group.width_m, local);
        gust.admittance.amplitude(k)
    }

    /// Groups that the wind blows at.
    fn blown(&self) -> impl Iterator<Item = &StripGroup> {
        self.bridge.groups.iter().filter(|g| g.wind_factor != 0.0)
    }

    /// The coupled bridge, which must be stable.
    fn coupled(&self, speed_m_s: f64) -> Result<CoupledSection> {
        let bridge = self.bridge;
        let coupled = CoupledSection::new(bridge.structure(), bridge.forces().realize()?)?;
        let roots = coupled.at(speed_m_s)?.eigenvalues()?;
        match roots.iter().filter(|z| z.re > 0.0).count() {
            0 => Ok(coupled),
            growing => Err(unstable(growing, "", speed_m_s)),
        }
    }
}

/// Only what is stable has a stationary response; `at` says where motions grow.
fn unstable(growing: usize, at: &str, speed_m_s: f64) -> Error {
    Error::Unstable(format!(
        "buffeting at {speed_m_s} m/s: the bridge is unstable there ({}{at}), no response is stationary",
        counted(growing, "growing root")
    ))
}
