//! Aerodynamic admittance: the part of the quasi-steady gust force that a gust of finite length exerts.

use crate::aerodynamics::RationalAdmittance;
use crate::aerodynamics::flat_plate::theodorsen;
use crate::error::{Result, positive};
use crate::units::{ReducedFrequency, ReducedVelocity};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Below this argument Davenport's function is taken from its series.
const SERIES_BELOW: f64 = 1e-2;

/// A factor on the amplitude of the gust force. Square moduli, which some sources print, multiply the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Admittance {
    /// One: gusts much longer than the deck is wide.
    None {},
    /// Sears's function of the thin plate, `C(k)(J₀(k) − iJ₁(k)) + iJ₁(k)` with `k = K/2` and the gust taken at mid-chord
    /// (W. R. Sears, J. Aeronaut. Sci. 8 (1941) 104).
    Sears {},
    /// Liepmann's approximation of its modulus, `1/√(1 + 2πk)` (H. W. Liepmann, J. Aeronaut. Sci. 19 (1952) 793).
    Liepmann {},
    /// Davenport's function `2(z − 1 + e^(−z))/z²`, `z = decay · fB/V`, on the amplitude as the IABSE benchmark has it.
    Davenport {
        /// Decay factor; 7 in the benchmark.
        #[serde(default = "benchmark_decay")]
        decay: f64,
    },
}

impl Default for Admittance {
    fn default() -> Self {
        Self::None {}
    }
}

fn benchmark_decay() -> f64 {
    7.0
}

impl From<RationalAdmittance> for Admittance {
    fn from(packed: RationalAdmittance) -> Self {
        match packed {
            RationalAdmittance::None => Self::None {},
            RationalAdmittance::Sears => Self::Sears {},
            RationalAdmittance::Liepmann => Self::Liepmann {},
        }
    }
}

impl Admittance {
    /// As files spell it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None {} => "none",
            Self::Sears {} => "sears",
            Self::Liepmann {} => "liepmann",
            Self::Davenport { .. } => "davenport",
        }
    }

    /// Checks the decay factor.
    pub fn validate(&self, place: &str) -> Result<()> {
        if let Self::Davenport { decay } = self {
            positive(format!("{place}.decay"), *decay)?;
        }
        Ok(())
    }

    /// The factor at a reduced frequency; 1 at zero.
    pub fn amplitude(&self, frequency: ReducedFrequency) -> Complex<f64> {
        let k = frequency.semi_chord();
        match self {
            Self::None {} => Complex::new(1.0, 0.0),
            Self::Sears {} => {
                let (j0, j1) = (libm::j0(k), libm::j1(k));
                theodorsen(k) * Complex::new(j0, -j1) + Complex::new(0.0, j1)
            }
            Self::Liepmann {} => (1.0 / (1.0 + 2.0 * PI * k).sqrt()).into(),
            Self::Davenport { decay } => {
                // fB/V = 1/V*
                let z = if frequency.full_width() == 0.0 {
                    0.0
                } else {
                    decay / ReducedVelocity::from(frequency).v_star()
                };
                davenport(z).into()
            }
        }
    }
}

fn davenport(z: f64) -> f64 {
    if z < SERIES_BELOW {
        return 1.0 - z / 3.0 * (1.0 - z / 4.0 * (1.0 - z / 5.0 * (1.0 - z / 6.0)));
    }
    2.0 * (z + libm::expm1(-z)) / (z * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(admittance: Admittance, k: f64) -> Complex<f64> {
        admittance.amplitude(ReducedFrequency::from_semi_chord(k))
    }

    #[test]
    fn all_are_one_for_long_gusts() {
        for admittance in [
            Admittance::None {},
            Admittance::Sears {},
            Admittance::Liepmann {},
            Admittance::Davenport { decay: 7.0 },
        ] {
            assert_eq!(at(admittance, 0.0), Complex::new(1.0, 0.0));
        }
    }

    /// Liepmann's approximation is within 7 % of Sears's modulus; SciPy gives the exact values below.
    #[test]
    fn sears_against_scipy_and_liepmann() {
        for (k, re, im) in SEARS {
            let exact = at(Admittance::Sears {}, k);
            assert!(
                (exact - Complex::new(re, im)).norm() < 1e-14,
                "{k}: {exact}"
            );
            let near = at(Admittance::Liepmann {}, k).re;
            assert!(
                (near / exact.norm() - 1.0).abs() < 0.07,
                "{k}: {near} {}",
                exact.norm()
            );
        }
    }

    #[test]
    fn a_key_of_another_kind_is_refused() {
        let read = |text| serde_json::from_str::<Admittance>(text).map_err(|e| e.to_string());
        let message = read(r#"{ "kind": "sears", "decay": 7 }"#).unwrap_err();
        assert!(message.contains("unknown field `decay`"), "{message}");
        assert_eq!(read(r#"{ "kind": "none" }"#), Ok(Admittance::default()));
    }

    /// From the definition with 40 digits, and both sides of the change to the series.
    #[test]
    fn davenport_by_hand() {
        for (z, value) in DAVENPORT {
            assert!(
                (davenport(z) - value).abs() < 1e-13,
                "{z}: {}",
                davenport(z)
            );
        }
    }

    const SEARS: [(f64, f64, f64); 4] = [
        (0.02, 0.962876841180562, -0.0748376899732216),
        (0.1, 0.8212412471897388, -0.16347844792545843),
        (0.7, 0.4560753280166778, 0.03179180446572),
        (3.0, -0.14522278694325458, 0.17780332685404046),
    ];
    const DAVENPORT: [(f64, f64); 4] = [
        (0.0099, 0.9967081513549956),
        (0.0101, 0.9966418170238474),
        (1.3, 0.6775524177917309),
        (40.0, 0.04875),
    ];
}
