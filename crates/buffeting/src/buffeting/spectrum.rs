//! Spectra of the turbulence components, normalised to their variance.

use crate::aerodynamics::GustComponent;
use crate::error::{Error, Result, ensure, positive};
use serde::{Deserialize, Serialize};

/// Part by which the integral of a user's spectrum may differ from its variance.
const NORMALISATION_TOLERANCE: f64 = 0.01;

/// Shape of a spectrum over `x = fL/V`, all of the form `f S/σ² = a x (1 + e xᶜ)/(1 + b xᶜ)ᵈ`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SpectrumShape {
    /// Von Kármán: `u: 4x/(1 + 70.8x²)^(5/6)`, `w: 4x(1 + 755.2x²)/(1 + 283.2x²)^(11/6)`.
    VonKarman {},
    /// Kaimal in the form of EN 1991-1-4, B.1, and Handbook N400: `A x/(1 + 1.5 A x)^(5/3)`, `A_u = 6.8`, `A_w = 9.4`.
    Kaimal {},
    /// Constants of the user's own; the integral must be the variance within 1 %.
    General(SpectrumFormula),
}

/// A spectrum with its scales.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GustSpectrum {
    /// Shape over `fL/V`.
    pub shape: SpectrumShape,
    /// Length scale `L` of this component along the wind, m.
    pub length_m: f64,
    /// Turbulence intensity `σ/V`.
    pub intensity: f64,
}

/// `f S/σ² = a x (1 + e xᶜ)/(1 + b xᶜ)ᵈ`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpectrumFormula {
    /// Factor `a`: at low frequency `S = a σ² L/V`.
    pub a: f64,
    /// Factor `b` in the denominator.
    pub b: f64,
    /// Power `c` of `x`.
    pub c: f64,
    /// Power `d` of the denominator.
    pub d: f64,
    /// Factor `e` in the numerator.
    #[serde(default)]
    pub e: f64,
}

impl SpectrumFormula {
    /// `S V/(σ² L)`, finite at zero.
    fn density(&self, x: f64) -> f64 {
        let power = x.powf(self.c);
        self.a * (1.0 + self.e * power) / (1.0 + self.b * power).powf(self.d)
    }

    /// Integral over all frequencies, as a part of the variance: Euler's beta function.
    fn integral(&self) -> f64 {
        let Self { a, b, c, d, e } = *self;
        let beta = |p: f64, q: f64| libm::tgamma(p) * libm::tgamma(q) / libm::tgamma(p + q);
        let first = beta(1.0 / c, d - 1.0 / c);
        let second = if e == 0.0 {
            0.0
        } else {
            e / b * beta(1.0 + 1.0 / c, d - 1.0 - 1.0 / c)
        };
        a * b.powf(-1.0 / c) / c * (first + second)
    }
}

impl SpectrumShape {
    fn formula(&self, component: GustComponent) -> SpectrumFormula {
        let formula = |a, b, c, d, e| SpectrumFormula { a, b, c, d, e };
        match (*self, component) {
            (Self::VonKarman {}, GustComponent::Along) => formula(4.0, 70.8, 2.0, 5.0 / 6.0, 0.0),
            (Self::VonKarman {}, GustComponent::Vertical) => {
                formula(4.0, 283.2, 2.0, 11.0 / 6.0, 755.2)
            }
            (Self::Kaimal {}, component) => {
                let factor = match component {
                    GustComponent::Along => 6.8,
                    GustComponent::Vertical => 9.4,
                };
                formula(factor, 1.5 * factor, 1.0, 5.0 / 3.0, 0.0)
            }
            (Self::General(formula), _) => formula,
        }
    }

    fn validate(&self, place: &str) -> Result<()> {
        let Self::General(formula) = *self else {
            return Ok(());
        };
        let SpectrumFormula { a, b, c, d, e } = formula;
        for (key, value) in [("a", a), ("b", b), ("c", c), ("d", d)] {
            positive(format!("{place}.{key}"), value)?;
        }
        crate::error::non_negative(format!("{place}.e"), e)?;
        let fall = if e > 0.0 { c * (d - 1.0) } else { c * d };
        if fall <= 1.0 {
            let expected = if e > 0.0 { "c(d − 1)" } else { "c d" };
            return Err(Error::input(
                place,
                format!("{expected} above 1, so that the variance is finite"),
                fall.to_string(),
            ));
        }
        let integral = formula.integral();
        ensure(
            (integral - 1.0).abs() <= NORMALISATION_TOLERANCE,
            format!("{place}.a"),
            format_args!(
                "a = {:.6}, so that the spectrum integrates to the variance",
                a / integral
            ),
            format_args!("{a}, which gives {integral:.4} of it"),
        )?;
        Ok(())
    }
}

impl GustSpectrum {
    /// Checks scales and constants.
    pub fn validate(&self, place: &str) -> Result<()> {
        positive(format!("{place}.length_m"), self.length_m)?;
        positive(format!("{place}.intensity"), self.intensity)?;
        ensure(
            self.intensity < 1.0,
            format!("{place}.intensity"),
            "a ratio σ/V below 1, not per cent",
            self.intensity,
        )?;
        self.shape.validate(&format!("{place}.shape"))
    }

    /// `S(f)`, one-sided, m²/s² per Hz.
    pub fn density(&self, component: GustComponent, frequency_hz: f64, speed_m_s: f64) -> f64 {
        let time = self.length_m / speed_m_s;
        let sigma = self.intensity * speed_m_s;
        sigma * sigma * time * self.shape.formula(component).density(frequency_hz * time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spectrum(shape: SpectrumShape) -> GustSpectrum {
        GustSpectrum {
            shape,
            length_m: 20.0,
            intensity: 0.05,
        }
    }

    /// IABSE 1.1a: `S_w(0.278 Hz, 45 m/s) = 5.26 m²/s² / Hz`.
    #[test]
    fn the_benchmark_value() {
        let s = spectrum(SpectrumShape::VonKarman {});
        let value = s.density(GustComponent::Vertical, 0.278, 45.0);
        assert!((value - 5.26).abs() < 0.005, "{value}");
    }

    /// Sums over 10 decades against the closed integral, and both against one: constants have four digits at most.
    #[test]
    fn spectra_integrate_to_their_variance() {
        for shape in [SpectrumShape::VonKarman {}, SpectrumShape::Kaimal {}] {
            for component in GustComponent::BOTH {
                let s = spectrum(shape);
                let steps = 40_000;
                let sum: f64 = (0..steps)
                    .map(|i| {
                        let log = -7.0 + 14.0 * (f64::from(i) + 0.5) / f64::from(steps);
                        let f = 10f64.powf(log);
                        s.density(component, f, 30.0) * f * 10f64.ln() * 14.0 / f64::from(steps)
                    })
                    .sum();
                let integral = s.shape.formula(component).integral();
                // beyond 1e7 Hz and below 1e-7 Hz lie 1e-5 of the variance
                assert!((sum / 2.25 - integral).abs() < 2e-5, "{sum} {integral}");
                assert!((integral - 1.0).abs() < 1e-3, "{integral}");
            }
        }
    }

    #[test]
    fn constants_of_the_user_are_checked() {
        let general =
            |a, b, c, d, e| spectrum(SpectrumShape::General(SpectrumFormula { a, b, c, d, e }));
        assert!(
            general(6.8, 10.2, 1.0, 5.0 / 3.0, 0.0)
                .validate("w")
                .is_ok()
        );
        assert!(
            general(4.0, 283.2, 2.0, 11.0 / 6.0, 755.2)
                .validate("w")
                .is_ok()
        );
        for (bad, expected) in [
            (
                general(13.6, 10.2, 1.0, 5.0 / 3.0, 0.0),
                "w.shape.a: expected a = 6.800000",
            ),
            (
                general(6.8, 10.2, 1.0, 0.9, 0.0),
                "w.shape: expected c d above 1",
            ),
            (general(6.8, 10.2, 1.0, 5.0 / 3.0, 1.0), "c(d − 1) above 1"),
            (
                general(6.8, -1.0, 1.0, 5.0 / 3.0, 0.0),
                "w.shape.b: expected a positive number",
            ),
        ] {
            let message = bad.validate("w").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let read = serde_json::from_str::<SpectrumShape>(r#"{ "kind": "kaimal", "a": 6.8 }"#);
        let message = read.unwrap_err().to_string();
        assert!(message.contains("unknown field `a`"), "{message}");
        let mut percent = spectrum(SpectrumShape::Kaimal {});
        percent.intensity = 5.0;
        let message = percent.validate("w").unwrap_err().to_string();
        assert!(message.contains("not per cent"), "{message}");
    }
}
