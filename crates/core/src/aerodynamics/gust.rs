//! Gusts over time: the turbulence components `u` along the mean wind and `w` upwards.

use crate::error::{Result, ensure, positive};

/// Gusts at equal time steps, on straight lines in between.
#[derive(Debug, Clone, PartialEq)]
pub struct GustSeries {
    step_s: f64,
    along_m_s: Vec<f64>,
    vertical_m_s: Vec<f64>,
}

impl GustSeries {
    /// Gusts `u`, `w` (m/s) every `step_s` seconds from time zero.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for a step that is not positive, series of different length, fewer than two samples, and
    /// numbers that are not finite, with the sample.
    pub fn new(step_s: f64, along_m_s: Vec<f64>, vertical_m_s: Vec<f64>) -> Result<Self> {
        positive("gusts: step", step_s)?;
        ensure(
            along_m_s.len() == vertical_m_s.len() && along_m_s.len() >= 2,
            "gusts",
            "two series of the same length, at least 2 samples",
            format_args!("{} and {}", along_m_s.len(), vertical_m_s.len()),
        )?;
        let pairs = along_m_s.iter().zip(&vertical_m_s).enumerate();
        for (i, (u, w)) in pairs {
            ensure(
                u.is_finite() && w.is_finite(),
                format_args!("gusts: sample {}", i + 1),
                "finite speeds",
                format_args!("u = {u}, w = {w}"),
            )?;
        }
        Ok(Self {
            step_s,
            along_m_s,
            vertical_m_s,
        })
    }

    /// No gusts for at least `duration_s` seconds.
    pub fn calm(duration_s: f64) -> Result<Self> {
        let step_s = positive("duration", duration_s)?;
        Self::new(step_s, vec![0.0; 2], vec![0.0; 2])
    }

    /// Time step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Time of the last sample, s.
    pub fn duration_s(&self) -> f64 {
        self.step_s * (self.along_m_s.len() - 1) as f64
    }

    /// `u` at the samples, m/s.
    pub fn along_m_s(&self) -> &[f64] {
        &self.along_m_s
    }

    /// `w` at the samples, m/s.
    pub fn vertical_m_s(&self) -> &[f64] {
        &self.vertical_m_s
    }

    /// `(u, w)` at a time, m/s; held before the first and after the last sample.
    pub fn at(&self, time_s: f64) -> (f64, f64) {
        let last = self.along_m_s.len() - 1;
        let place = (time_s / self.step_s).clamp(0.0, last as f64);
        let i = (place as usize).min(last - 1);
        let t = place - i as f64;
        let line = |v: &[f64]| v[i] * (1.0 - t) + v[i + 1] * t;
        (line(&self.along_m_s), line(&self.vertical_m_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_between_samples() {
        let gusts = GustSeries::new(0.5, vec![0.0, 1.0, -1.0], vec![2.0, 2.0, 4.0]).unwrap();
        assert_eq!(gusts.at(0.25), (0.5, 2.0));
        assert_eq!(gusts.at(0.75), (0.0, 3.0));
        assert_eq!(gusts.at(1.0), (-1.0, 4.0));
        assert_eq!(gusts.at(9.0), (-1.0, 4.0));
        assert_eq!(gusts.duration_s(), 1.0);
    }

    #[test]
    fn bad_series_are_refused() {
        let message = GustSeries::new(0.1, vec![0.0, f64::NAN], vec![0.0; 2])
            .unwrap_err()
            .to_string();
        assert_eq!(
            message,
            "gusts: sample 2: expected finite speeds, found u = NaN, w = 0"
        );
        assert!(GustSeries::new(0.0, vec![0.0; 2], vec![0.0; 2]).is_err());
        assert!(GustSeries::new(0.1, vec![0.0; 3], vec![0.0; 2]).is_err());
    }
}
