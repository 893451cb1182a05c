//! Forces of gusts that can be stepped: static coefficients through a rational admittance.

use super::quasi_steady::{Arms, QuasiSteady, StaticCoefficients};
use crate::error::{Result, ensure, finite};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// A rational admittance on the amplitude of the gust forces, `φ(K) = Σ wⱼ pⱼ/(pⱼ + iK)` with `Σ wⱼ = 1`: first-order lags of
/// the gust, `ġⱼ = pⱼ (V/B)(u − gⱼ)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RationalAdmittance {
    /// One: gusts much longer than the deck is wide.
    #[default]
    None,
    /// The modulus of Sears's function of the thin plate, within 2 % for K from 0 to 20.
    Sears,
    /// Liepmann's `1/√(1 + πK)`, within 2.5 % for K from 0 to 20.
    Liepmann,
}

/// A component of the turbulence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GustComponent {
    /// `u`, along the mean wind.
    Along,
    /// `w`, upwards.
    Vertical,
}

impl GustComponent {
    /// Both, in the order of the columns of a buffeting matrix.
    pub const BOTH: [Self; 2] = [Self::Along, Self::Vertical];
}

/// Pole `pⱼ` and weight `wⱼ` of one lag.
pub(super) type Lag = [f64; 2];

/// Lags of an admittance that has any.
pub(crate) const LAGS: usize = 4;

/// Least squares of the logarithm of the modulus over 400 values of K from 0.001 to 20, evenly spread on a logarithmic scale.
const SEARS: [Lag; LAGS] = [
    [0.082_32, 0.1522],
    [0.4902, 0.4716],
    [2.415, 0.2428],
    [17.54, 0.1334],
];
/// As [`SEARS`].
const LIEPMANN: [Lag; LAGS] = [
    [0.054_75, 0.1690],
    [0.3888, 0.4302],
    [2.156, 0.2586],
    [16.42, 0.1422],
];

impl RationalAdmittance {
    /// Its lags; none for the admittance of one.
    pub fn lags(self) -> &'static [Lag] {
        match self {
            Self::None => &[],
            Self::Sears => &SEARS,
            Self::Liepmann => &LIEPMANN,
        }
    }
}

/// Forces by gusts `u` along the mean wind and `w` upwards on a section: `½ρV² diag(B, B, B²) A (u/V, w/V)` per unit length, about
/// the reference point of the aerodynamic forces, each gust through the admittance first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GustForce {
    /// Degrees of freedom of the rows of `coefficients`.
    pub dofs: Vec<Dof>,
    /// `A`, n×2: columns for `u` and `w`.
    pub coefficients: Vec<[f64; 2]>,
    /// On both components.
    pub admittance: RationalAdmittance,
    /// Where the coefficients come from, in words.
    pub source: String,
}

impl GustForce {
    /// The buffeting matrix of quasi-steady theory at rotation zero (1.12d): slopes and values of the static coefficients.
    ///
    /// # Errors
    /// Coefficients that do not reach rotation zero, or say nothing of one of these degrees of freedom.
    pub fn quasi_steady(
        table: StaticCoefficients,
        dofs: &[Dof],
        admittance: RationalAdmittance,
    ) -> Result<Self> {
        let of_table = format!("the static coefficients `{}`", table.name);
        let theory = QuasiSteady::new(table, Arms::default(), dofs)?.linearised(0.0)?;
        let rows = theory.buffeting.row_iter();
        Ok(Self {
            dofs: dofs.to_vec(),
            coefficients: rows.map(|row| [row[0], row[1]]).collect(),
            admittance,
            source: format!("quasi-steady theory with {of_table}"),
        })
    }

    /// Numbers of the state of the gusts at one place.
    pub fn states(&self) -> usize {
        2 * self.admittance.lags().len()
    }

    /// Checks the coefficients for a model with these degrees of freedom.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for other degrees of freedom, another number of rows and numbers that are not finite.
    pub fn validate(&self, dofs: &[Dof]) -> Result<()> {
        let (wanted, own, rows) = (
            Dof::names(dofs),
            Dof::names(&self.dofs),
            self.coefficients.len(),
        );
        ensure(
            self.dofs == dofs && rows == dofs.len(),
            "gust forces",
            format_args!("a row for each degree of freedom of the model, {wanted}"),
            format_args!("{rows} rows for {own}"),
        )?;
        for (row, dof) in self.coefficients.iter().zip(dofs) {
            let force = format!("{} force", dof.symbol());
            for (x, gust) in row.iter().zip(["u", "w"]) {
                let place = format!("gust forces: coefficient of {gust} in the {force}");
                finite(place, *x)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::flat_plate::theodorsen;
    use nalgebra::Complex;
    use std::f64::consts::PI;

    fn modulus(admittance: RationalAdmittance, k: f64) -> f64 {
        let lag = |[p, w]: &Lag| Complex::from(w * p) / Complex::new(*p, k);
        admittance
            .lags()
            .iter()
            .map(lag)
            .sum::<Complex<f64>>()
            .norm()
    }

    #[test]
    fn lags_are_near_the_functions_they_stand_for() {
        for admittance in [RationalAdmittance::Sears, RationalAdmittance::Liepmann] {
            let sum: f64 = admittance.lags().iter().map(|[_, w]| w).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        }
        for i in 0..=200 {
            let k = 0.001 * 20_000.0_f64.powf(f64::from(i) / 200.0);
            let half = 0.5 * k;
            let (j0, j1) = (libm::j0(half), libm::j1(half));
            let sears = theodorsen(half) * Complex::new(j0, -j1) + Complex::new(0.0, j1);
            let off = modulus(RationalAdmittance::Sears, k) / sears.norm() - 1.0;
            assert!(off.abs() < 0.02, "Sears, K = {k}: {off}");
            let liepmann = 1.0 / (1.0 + PI * k).sqrt();
            let off = modulus(RationalAdmittance::Liepmann, k) / liepmann - 1.0;
            assert!(off.abs() < 0.025, "Liepmann, K = {k}: {off}");
        }
    }

    #[test]
    fn coefficients_that_do_not_fit_are_refused() {
        let force = GustForce {
            dofs: Dof::TWO.to_vec(),
            coefficients: vec![[0.1, 5.0], [0.0, f64::NAN]],
            admittance: RationalAdmittance::None,
            source: "test".into(),
        };
        let message = force.validate(&Dof::TWO).unwrap_err().to_string();
        assert!(message.contains("coefficient of w in the"), "{message}");
        assert!(force.validate(&Dof::THREE).is_err());
    }
}
