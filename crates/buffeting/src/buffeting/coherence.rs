//! Coherence along the span: exponential along a line, it is that of a Markov chain, so that products with `C` and samples of the
//! turbulence cost one pass along the span instead of a factorisation.

use crate::aerodynamics::GustComponent;
use crate::bridge::Node;
use crate::error::{Result, ensure};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

/// Decay of the coherence along the span, `exp(−decay f Δs/V)` with the mean wind V of both places, for each component of the turbulence.
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
    /// [`Error::Input`](crate::error::Error::Input) naming the key below `place`.
    pub fn validate(&self, place: &str) -> Result<()> {
        for (key, value) in [("along", self.along), ("vertical", self.vertical)] {
            let expected = "a decay of the coherence in (0, ∞)";
            ensure(
                value > 0.0 && value.is_finite(),
                format!("{place}.{key}"),
                expected,
                value,
            )?;
        }
        Ok(())
    }

    /// Coherence of neighbouring nodes at a frequency, one a gap, in the winds at all nodes.
    pub(super) fn of_gaps(
        &self,
        component: GustComponent,
        nodes: &[Node],
        frequency_hz: f64,
        winds_m_s: &[f64],
    ) -> Vec<f64> {
        let twice_rate = 2.0 * self.decay(component) * frequency_hz;
        let gaps = nodes.windows(2).zip(winds_m_s.windows(2));
        gaps.map(|(n, v)| (-twice_rate * (n[1].along_m - n[0].along_m) / (v[0] + v[1])).exp())
            .collect()
    }
}

/// `vᴴ C v` with the exponential coherence of a line, in one pass: `C = T + Tᴴ − I` with a recursion for `T`.
pub(super) fn coherent_power(v: impl Iterator<Item = Complex<f64>>, gaps: &[f64]) -> f64 {
    let mut sum = 0.0;
    let mut before = Complex::default();
    for (n, z) in v.enumerate() {
        if n > 0 {
            before *= gaps[n - 1];
        }
        sum += z.norm_sqr() + 2.0 * (z.conj() * before).re;
        before += z;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pass_is_the_double_sum() {
        let along = [0.0, 3.0, 4.5, 10.0, 11.0f64];
        let v: Vec<Complex<f64>> = (0..5)
            .map(|i| Complex::new((f64::from(i) * 1.3).sin(), 0.2 * f64::from(i)))
            .collect();
        let gaps: Vec<f64> = along
            .windows(2)
            .map(|x| (-0.3 * (x[1] - x[0])).exp())
            .collect();
        let mut expected = Complex::<f64>::default();
        for (a, x) in v.iter().zip(along) {
            for (b, y) in v.iter().zip(along) {
                let coherence: f64 = (-0.3 * f64::abs(x - y)).exp();
                expected += a.conj() * b * coherence;
            }
        }
        assert!((coherent_power(v.iter().copied(), &gaps) - expected.re).abs() < 1e-13);
    }
}
