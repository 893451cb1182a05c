//! The smallest damping ratio at the present wind, which importers may read at every step.

use super::trust::shown;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{LeastDamping, aliased_below, smallest_damping};
use crate::response::{Inputs, Stepper};
use crate::state_space::{damping_ratio, write_eigenvalues};
use nalgebra::{Complex, DMatrix};

/// Damping of the present modes with room for its computation; made anew, as [`Default`] is, where the system is.
#[derive(Debug, Default)]
pub(super) struct PresentDamping {
    /// Of continuous forces.
    least: Option<LeastDamping>,
    /// Of sampled ones.
    sampled: Option<Sampled>,
    /// A wind speed, m/s, and the smallest damping ratio there.
    last: Option<[f64; 2]>,
}

/// The matrix from sample to sample, and room for its eigenvalues.
#[derive(Debug)]
struct Sampled {
    /// In slower wind, m/s, a sample lasts half a period or longer.
    lowest_m_s: f64,
    steady: Inputs,
    matrix: DMatrix<f64>,
    eigenvalues: Vec<Complex<f64>>,
}

/// Wind speed, m/s, from which on damping is told: a motion without a spring has no period in still air, which a sample could miss.
pub(super) fn told_from(section: &CoupledSection) -> f64 {
    aliased_below(section).unwrap_or(0.0)
}

impl PresentDamping {
    /// The ratio of the section of `stepper`, the same at every call, at a wind speed, m/s.
    ///
    /// # Errors
    /// Where the eigenvalues are not found.
    pub(super) fn at(&mut self, stepper: &mut Stepper, wind_m_s: f64) -> Result<f64> {
        if let Some([_, ratio]) = self.last.filter(|[at, _]| *at == wind_m_s) {
            return Ok(ratio);
        }
        if self.least.is_none() && self.sampled.is_none() {
            self.least = LeastDamping::new(stepper.section());
        }
        let ratio = match &mut self.least {
            Some(least) => least.at(stepper.section(), wind_m_s)?,
            None => {
                let sampled = self.sampled.get_or_insert_with(|| Sampled::new(stepper));
                match sampled.at(stepper, wind_m_s)? {
                    Some(ratio) => ratio,
                    None => smallest_damping(stepper.section(), wind_m_s)?,
                }
            }
        };
        self.last = Some([wind_m_s, ratio]);
        Ok(ratio)
    }

    /// What is known of the modes at the last wind.
    pub(super) fn modes(&self) -> Option<&LeastDamping> {
        self.least.as_ref()
    }
}

impl Sampled {
    fn new(stepper: &Stepper) -> Self {
        let section = stepper.section();
        let states = section.states();
        Self {
            lowest_m_s: told_from(section),
            steady: Inputs::steady(0.0, section.structure().dofs.len()),
            matrix: DMatrix::zeros(states, states),
            eigenvalues: Vec::with_capacity(states),
        }
    }

    /// By the rates `ln z/Δt`; what has died out after a sample (`z = 0`) has none. `None` where the eigenvalues are not found.
    /// Where a sample lasts longer than half a period, `ln z` is that of another motion.
    fn at(&mut self, stepper: &mut Stepper, wind_m_s: f64) -> Result<Option<f64>> {
        if wind_m_s < self.lowest_m_s {
            let expected = format!(
                "{:.3} m/s or more, below which a sample lasts half a period",
                self.lowest_m_s
            );
            let found = format!("{} m/s", shown(wind_m_s));
            return Err(Error::input("wind speed", expected, found));
        }
        self.steady.wind_speed_m_s = wind_m_s;
        let step = stepper.write_sample_matrix(&self.steady, &mut self.matrix)?;
        let found = write_eigenvalues(&mut self.matrix, &mut self.eigenvalues);
        Ok(step.zip(found).map(|(step, ())| {
            let diverges = |z: &Complex<f64>| z.im == 0.0 && z.norm() > 1.0;
            let alive = self
                .eigenvalues
                .iter()
                .filter(|z| z.im > 0.0 || diverges(z));
            let ratios = alive.map(|z| damping_ratio(z.ln() / step));
            ratios.reduce(f64::min).unwrap_or(1.0)
        }))
    }
}
