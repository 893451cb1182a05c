//! V-g and V-f curves and the onset of any `G(K)` by the p-k iteration.
//!
//! At every wind speed each mode is iterated until the forces are taken at its own frequency; from one speed to the next
//! it starts from the mode before. A table is asked only inside its range: each mode comes in at the speed that belongs
//! to the highest `K` and leaves at that of the lowest. Needs no realisation, so it draws measured tables and Theodorsen's function. Exact at an onset; between onsets its damping
//! means what measured derivatives mean.

use super::answer::{Findings, FlutterSearch, UnstableStart, choose, entry_reason};
use super::curves::{FlutterCurves, ModePoint, damping_ratio, empty_branches};
use super::determinant::damping_slope;
use super::onset::{Onset, OnsetMethod};
use super::pk_following::{Entry, Iteration, Modes};
use super::quasi_pk::PkMode;
use super::scan::growing;
use super::search::OnsetSearch;
use crate::aerodynamics::AerodynamicModel;
use crate::error::{Error, Result, positive};
use crate::section::Structure;
use crate::state_space::root;
use crate::units::ReducedFrequencyRange;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Damping at a refined crossing above which it is none.
const JUMP: f64 = 1e-6;
/// Speeds from still air to that of a single mode.
const STEPS_TO_MODE: usize = 100;

/// Frequencies, damping ratios and shapes over the increasing `speeds_m_s` by the p-k iteration. A branch ends where
/// its mode stops oscillating, and has points only where the model knows the forces
/// ([`AerodynamicModel::known_range`]).
///
/// # Errors
/// [`Error::Input`] for speeds that do not increase from above zero; those of the model.
pub fn pk_curves(
    name: &str,
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speeds_m_s: &[f64],
) -> Result<FlutterCurves> {
    let mut last = 0.0;
    for &speed in speeds_m_s {
        if positive("wind speeds", speed)? <= last {
            return Err(Error::input(
                "wind speeds",
                "increasing numbers above zero",
                format!("{speed} after {last}"),
            ));
        }
        last = speed;
    }
    let iteration = Iteration { structure, model };
    let mut branches = empty_branches(&structure.dofs, speeds_m_s.len());
    iteration.march(speeds_m_s, &mut |_, at| {
        let asked = speeds_m_s.binary_search_by(|v| v.total_cmp(&at.speed));
        for (branch, mode) in at.all.iter().filter(|_| asked.is_ok()) {
            branches[*branch].points.push(ModePoint {
                speed_m_s: at.speed,
                eigenvalue: mode.lambda.into(),
                frequency_hz: mode.lambda.im / TAU,
                damping_ratio: damping_ratio(mode.lambda),
                shape: iteration.scaled(mode),
                in_tested_range: None,
            });
        }
        Ok(())
    })?;
    Ok(FlutterCurves {
        model: name.to_owned(),
        branches,
        ended: None,
    })
}

/// Eigenvalue (rad/s) at one wind speed of the branch that moves the degree of freedom `dof` (its index) in still air,
/// followed over the wind speed from there; of a table from where that begins.
///
/// # Errors
/// [`Error::Input`] for a speed that is not positive or a `dof` that there is not; those of the model;
/// [`Error::Numerical`] when the branch has ended before that speed or is outside the range of a table.
pub fn quasi_pk_mode(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speed_m_s: f64,
    dof: usize,
) -> Result<Complex<f64>> {
    positive("wind speed", speed_m_s)?;
    let n = structure.dofs.len();
    if dof >= n {
        return Err(Error::input(
            "degree of freedom",
            format!("an index below {n}"),
            dof.to_string(),
        ));
    }
    let speeds: Vec<f64> = (1..=STEPS_TO_MODE)
        .map(|i| speed_m_s * i as f64 / STEPS_TO_MODE as f64)
        .collect();
    let (mut found, mut last) = (None, None);
    let iteration = Iteration { structure, model };
    iteration.march(&speeds, &mut |_, at| {
        let lambda = at.mode(dof).map(|m| m.lambda);
        found = lambda.filter(|_| at.speed == speed_m_s);
        last = lambda.map(|_| at.speed).or(last);
        Ok(())
    })?;
    found.ok_or_else(|| {
        let branch = iteration.name(dof);
        Error::Numerical(match last {
            Some(speed) => format!(
                "p-k: the {branch} branch ends above {speed:.3} m/s, before {speed_m_s} m/s"
            ),
            None => format!("p-k: the {branch} branch cannot be judged up to {speed_m_s} m/s"),
        })
    })
}

/// First wind speed at which a mode of the p-k iteration loses its damping; `tested` as in
/// [`find_onset`](super::find_onset).
///
/// # Errors
/// Those of [`pk_curves`]; [`Error::Input`] for a search range that is none.
pub fn pk_onset(
    name: &str,
    structure: &Structure,
    model: &dyn AerodynamicModel,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let iteration = Iteration { structure, model };
    let looking = Looking {
        name,
        iteration: &iteration,
        tested,
    };
    let (mut crossings, mut starts) = (Vec::new(), Vec::new());
    let (entries, reach) = iteration.march(&search.speeds_m_s()?, &mut |low, high| {
        for (branch, after) in &high.all {
            let Some(before) = low.mode(*branch) else {
                continue;
            };
            let ends = (before.lambda.re, after.lambda.re);
            if ends.0 < 0.0 && ends.1 >= 0.0 {
                crossings.extend(looking.refine((low, high), *branch, ends)?);
            }
            starts.extend(looking.entry(low, high, *branch)?);
        }
        Ok(())
    })?;
    starts.extend(entries.iter().filter_map(|e| looking.first(e)));
    let mut found = Findings::judged(reach.judged(search.speed_max_m_s));
    found.crossings = crossings;
    found.starts = starts;
    Ok(choose(found, tested))
}

/// What the search for an onset looks at on each step.
struct Looking<'a> {
    name: &'a str,
    iteration: &'a Iteration<'a>,
    tested: Option<ReducedFrequencyRange>,
}

impl Looking<'_> {
    fn start(&self, speed: f64, branch: usize, mode: &PkMode, reason: String) -> UnstableStart {
        let (s, at) = (self.iteration.structure, (speed, mode.lambda));
        let (method, branch) = (OnsetMethod::PkIteration, self.iteration.name(branch));
        UnstableStart::new(self.name, method, s, at, branch, reason)
    }

    /// A mode that grows where it is known first.
    fn first(&self, entry: &Entry) -> Option<UnstableStart> {
        let range = self.iteration.model.known_range();
        let reason = range.map_or("the lowest speed looked at".to_owned(), |range| {
            entry_reason(range.max)
        });
        growing(&entry.mode.lambda).then(|| {
            let mut start = self.start(entry.speed, entry.branch, &entry.mode, reason);
            let k = start.reduced_frequency;
            start.in_tested_range = self
                .tested
                .map(|tested| range.is_some() || tested.contains(k));
            start
        })
    }

    /// A mode that comes into the tested range between two speeds and grows there.
    fn entry(&self, low: &Modes, high: &Modes, branch: usize) -> Result<Option<UnstableStart>> {
        let (Some(before), Some(after)) = (low.mode(branch), high.mode(branch)) else {
            return Ok(None);
        };
        let grows = before.lambda.re >= 0.0 || after.lambda.re >= 0.0;
        let known = self.iteration.model.known_range().is_some();
        let Some(range) = self.tested.filter(|_| grows && !known) else {
            return Ok(None);
        };
        let k = |modes: &Modes, mode| self.iteration.k(modes.speed, mode);
        let (from, to) = (k(low, before), k(high, after));
        if from <= range.max || to > range.max {
            return Ok(None);
        }
        let beyond = |k: crate::units::ReducedFrequency| range.max.full_width() - k.full_width();
        let speed = root((low.speed, beyond(from)), (high.speed, beyond(to)), |v| {
            Ok(beyond(self.iteration.k(v, &self.mode_at(low, v, branch)?)))
        })?;
        let mode = self.mode_at(low, speed, branch)?;
        Ok(growing(&mode.lambda).then(|| {
            let mut start = self.start(speed, branch, &mode, entry_reason(range.max));
            start.in_tested_range = Some(true);
            start
        }))
    }

    fn mode_at(&self, low: &Modes, speed: f64, branch: usize) -> Result<PkMode> {
        let modes = self.iteration.advance(low, speed)?;
        let lost = || Error::Numerical(format!("p-k: the mode is lost at {speed} m/s"));
        modes.mode(branch).cloned().ok_or_else(lost)
    }

    fn refine(
        &self,
        (low, high): (&Modes, &Modes),
        branch: usize,
        (before, after): (f64, f64),
    ) -> Result<Option<Onset>> {
        let speed = root((low.speed, before), (high.speed, after), |speed| {
            Ok(self.mode_at(low, speed, branch)?.lambda.re)
        })?;
        let mode = self.mode_at(low, speed, branch)?;
        if mode.lambda.re.abs() > JUMP * mode.lambda.norm() {
            // the damping jumps through zero: the iteration changed to another root
            return Ok(None);
        }
        let (s, model) = (self.iteration.structure, self.iteration.model);
        let at = (speed, mode.lambda.im);
        let (method, branch) = (OnsetMethod::PkIteration, self.iteration.name(branch));
        let mut onset = Onset::new(self.name, method, s, at, &mode.shape, branch);
        onset.damping_slope_s_m = damping_slope(s, model, speed, mode.lambda.im);
        Ok(Some(onset))
    }
}
