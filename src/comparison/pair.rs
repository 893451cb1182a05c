//! Two records of the same length, checked once.

use crate::error::{Error, Result, positive};

/// A reference signal and the signal compared with it, sampled together.
///
/// Both have the same unit, which is free. If the length is odd the last sample of both is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalPair<'a> {
    reference: &'a [f64],
    compared: &'a [f64],
    time_step_s: f64,
}

impl<'a> SignalPair<'a> {
    /// `reference` (`X₁`) and `compared` (`X₂`), sampled every `time_step_s`.
    ///
    /// # Errors
    /// [`Error::Input`] for unequal lengths, fewer than two samples, a sample that is not finite (named),
    /// or a time step that is not positive.
    pub fn new(reference: &'a [f64], compared: &'a [f64], time_step_s: f64) -> Result<Self> {
        positive("time step of the compared signals, s", time_step_s)?;
        if reference.len() != compared.len() {
            return Err(Error::input(
                "compared signal",
                format!("{} samples, as in the reference", reference.len()),
                format!("{} samples", compared.len()),
            ));
        }
        if reference.len() < 2 {
            return Err(Error::input(
                "reference signal",
                "at least 2 samples",
                format!("{} samples", reference.len()),
            ));
        }
        check_finite("reference signal", reference)?;
        check_finite("compared signal", compared)?;
        let even = reference.len() & !1;
        Ok(Self {
            reference: &reference[..even],
            compared: &compared[..even],
            time_step_s,
        })
    }

    /// Reference signal `X₁`.
    pub const fn reference(&self) -> &'a [f64] {
        self.reference
    }

    /// Compared signal `X₂`.
    pub const fn compared(&self) -> &'a [f64] {
        self.compared
    }

    /// Time between samples, s.
    pub(crate) const fn time_step_s(&self) -> f64 {
        self.time_step_s
    }

    /// Number of samples used, even.
    pub const fn sample_count(&self) -> usize {
        self.reference.len()
    }
}

fn check_finite(place: &str, signal: &[f64]) -> Result<()> {
    match signal.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(index) => Err(Error::input(
            format!("{place}, sample {index}"),
            "a finite number",
            signal[index].to_string(),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_length_loses_its_last_sample() {
        let x = [1.0, 2.0, 3.0];
        let pair = SignalPair::new(&x, &x, 0.1).unwrap();
        assert_eq!(pair.reference(), &[1.0, 2.0]);
        assert_eq!(pair.sample_count(), 2);
    }

    #[test]
    fn unusable_signals_are_named() {
        let x = [1.0, 2.0, 3.0, 4.0];
        let message = |r: Result<SignalPair<'_>>| r.unwrap_err().to_string();
        assert_eq!(
            message(SignalPair::new(&x, &x[1..], 0.1)),
            "compared signal: expected 4 samples, as in the reference, found 3 samples"
        );
        assert_eq!(
            message(SignalPair::new(&x, &[0.0, 1.0, f64::NAN, 0.0], 0.1)),
            "compared signal, sample 2: expected a finite number, found NaN"
        );
        assert!(SignalPair::new(&x, &x, 0.0).is_err());
        assert!(SignalPair::new(&x[..1], &x[..1], 0.1).is_err());
    }
}
