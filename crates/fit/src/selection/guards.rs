//! What makes a model unfit however well it fits: spurious onsets, cancelling terms, unstable closed loops.

use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{FlutterSearch, OnsetSearch, find_onset};
use crate::identification::{CANCELLATION_LIMIT, CellFit};
use crate::section::Structure;
use crate::units::ReducedFrequencyRange;

/// Parts of the onset speed at which nothing may grow.
const CALM_PARTS: [f64; 3] = [0.5, 0.75, 0.95];
/// Growth rates up to this part of the eigenvalue are rounding.
const ROUNDING: f64 = 1e-6;

/// Onset of a cell and every reason against it.
pub(super) struct CellVerdict {
    pub onset_m_s: Option<f64>,
    pub rejected: Vec<String>,
}

/// Judges one fit on the section.
pub(super) fn judge(
    fit: &CellFit,
    structure: &Structure,
    search: &OnsetSearch,
    tested: ReducedFrequencyRange,
) -> CellVerdict {
    let mut verdict = CellVerdict {
        onset_m_s: None,
        rejected: Vec::new(),
    };
    if fit.cancellation > CANCELLATION_LIMIT {
        verdict.rejected.push(format!(
            "its coefficients cancel: the largest term is {:.0} times the fit",
            fit.cancellation
        ));
    }
    if let Err(error) = onset(fit, structure, search, tested, &mut verdict) {
        verdict
            .rejected
            .push(format!("its modes cannot be followed ({error})"));
        // what happens at lower speeds is told all the same
        let lower = OnsetSearch {
            speed_max_m_s: 0.5 * search.speed_max_m_s,
            ..*search
        };
        let _ = onset(fit, structure, &lower, tested, &mut verdict);
    }
    verdict
}

fn onset(
    fit: &CellFit,
    structure: &Structure,
    search: &OnsetSearch,
    tested: ReducedFrequencyRange,
    verdict: &mut CellVerdict,
) -> Result<()> {
    let section = CoupledSection::with_model(structure, &fit.model)?;
    let found = find_onset("", &section, search, Some(tested))?;
    let limit = match &found {
        FlutterSearch::Onset(onset) => {
            verdict.onset_m_s = Some(onset.at.speed_m_s);
            for speed in &onset.spurious_speeds_m_s {
                verdict.rejected.push(format!(
                    "spurious onset at {speed:.3} m/s outside the tested range"
                ));
            }
            if onset.in_tested_range == Some(false) {
                verdict.rejected.push(format!(
                    "spurious onset at {:.3} m/s outside the tested range, and none inside",
                    onset.at.speed_m_s
                ));
            }
            onset.at.speed_m_s
        }
        FlutterSearch::UnstableAtOrBelow(start) => {
            verdict.onset_m_s = Some(start.at.speed_m_s);
            verdict.rejected.push(start.explain());
            start.at.speed_m_s
        }
        FlutterSearch::StableUpTo(range) => range.to_m_s,
    };
    if verdict.rejected.is_empty()
        && let Some(speed) = unstable_below(&section, limit)?
    {
        verdict.rejected.push(format!(
            "the coupled system is unstable at {speed:.3} m/s, where no mode flutters"
        ));
    }
    Ok(())
}

/// A speed below the onset at which an oscillation grows.
fn unstable_below(section: &CoupledSection, onset_m_s: f64) -> Result<Option<f64>> {
    for part in CALM_PARTS {
        let speed = part * onset_m_s;
        let grows = section
            .at(speed)?
            .eigenvalues()?
            .iter()
            .any(|z| z.im.abs() > ROUNDING * z.norm() && z.re > ROUNDING * z.norm());
        if grows {
            return Ok(Some(speed));
        }
    }
    Ok(None)
}
