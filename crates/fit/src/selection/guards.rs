//! What makes a model unfit however well it fits: spurious onsets, cancelling terms, unstable closed loops.

use super::Cell;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{FlutterSearch, OnsetSearch, find_onset};
use crate::identification::{CANCELLATION_LIMIT, CellFit};
use crate::section::Structure;
use crate::units::ReducedFrequencyRange;
use nalgebra::Complex;

/// Parts of the onset speed at which nothing may grow.
const CALM_PARTS: [f64; 3] = [0.5, 0.75, 0.95];
/// Growth rates up to this part of the eigenvalue are rounding.
const ROUNDING: f64 = 1e-6;

impl Cell {
    /// Judges its fit on the section: how close it is, its onset, and every reason against it.
    pub(super) fn judge(
        &mut self,
        fit: Result<CellFit>,
        structure: &Structure,
        search: &OnsetSearch,
        tested: ReducedFrequencyRange,
    ) {
        let fit = match fit {
            Ok(fit) => fit,
            Err(error) => return self.rejected.push(format!("it cannot be fitted ({error})")),
        };
        self.residual = Some(fit.objective);
        self.cancellation = Some(fit.cancellation);
        if fit.cancellation > CANCELLATION_LIMIT {
            self.rejected.push(format!(
                "its coefficients cancel: the largest term is {:.0} times the fit",
                fit.cancellation
            ));
        }
        if let Err(error) = self.find_onset(&fit, structure, search, tested) {
            let reason = format!("its modes cannot be followed ({error})");
            self.rejected.push(reason);
            // what happens at lower speeds is told all the same
            let lower = OnsetSearch {
                speed_max_m_s: 0.5 * search.speed_max_m_s,
                ..*search
            };
            let _ = self.find_onset(&fit, structure, &lower, tested);
        }
    }

    fn find_onset(
        &mut self,
        fit: &CellFit,
        structure: &Structure,
        search: &OnsetSearch,
        tested: ReducedFrequencyRange,
    ) -> Result<()> {
        let section = CoupledSection::with_model(structure, &fit.model)?;
        let found = find_onset("", &section, search, Some(tested))?;
        self.onset_m_s = found.critical_speed_m_s().or(self.onset_m_s);
        let limit = match &found {
            FlutterSearch::Onset(onset) => {
                let speed_m_s = onset.at.speed_m_s;
                let spurious = onset.spurious_speeds_m_s.iter();
                self.rejected.extend(spurious.map(|speed| {
                    format!("spurious onset at {speed:.3} m/s outside the tested range")
                }));
                if onset.in_tested_range == Some(false) {
                    self.rejected.push(format!(
                        "spurious onset at {speed_m_s:.3} m/s outside the tested range, and none inside"
                    ));
                }
                speed_m_s
            }
            FlutterSearch::UnstableAtOrBelow(start) => {
                self.rejected.push(start.explain());
                start.at.speed_m_s
            }
            FlutterSearch::StableUpTo(range) => range.to_m_s,
        };
        if self.rejected.is_empty()
            && let Some(speed) = unstable_below(&section, limit)?
        {
            self.rejected.push(format!(
                "the coupled system is unstable at {speed:.3} m/s, where no mode flutters"
            ));
        }
        Ok(())
    }
}

/// A speed below the onset at which an oscillation grows.
fn unstable_below(section: &CoupledSection, onset_m_s: f64) -> Result<Option<f64>> {
    for part in CALM_PARTS {
        let speed = part * onset_m_s;
        let grows = |z: &Complex<f64>| z.im.abs().min(z.re) > ROUNDING * z.norm();
        if section.at(speed)?.eigenvalues()?.iter().any(grows) {
            return Ok(Some(speed));
        }
    }
    Ok(None)
}
