//! Motion and force of the section as they go through the stages.

use crate::section::Dof;

/// Place of a degree of freedom in the arrays of a [`SectionSignals`], that of [`Dof::THREE`].
pub fn index(dof: Dof) -> usize {
    match dof {
        Dof::Vertical => 0,
        Dof::Lateral => 1,
        Dof::Torsion => 2,
    }
}

/// Motion of the section and force on the cells by the whole model, each vertical, lateral, torsion; of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionSignals {
    /// Sampling frequency, Hz.
    pub sampling_hz: f64,
    /// Motion: m, m, rad; zeros where it was not recorded.
    pub motion: [Vec<f64>; 3],
    /// Force: N, N, N·m.
    pub force: [Vec<f64>; 3],
}

impl SectionSignals {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.force[0].len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Greatest absolute value and root mean square.
pub fn peak_and_rms(x: &[f64]) -> (f64, f64) {
    let peak = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let square: f64 = x.iter().map(|v| v * v).sum();
    (peak, (square / x.len().max(1) as f64).sqrt())
}
