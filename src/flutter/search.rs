//! Onset by the eigenvalues of the coupled state matrix.

use super::answer::{Findings, FlutterSearch, UnstableStart, choose, entry_reason};
use super::curves::damping_ratio;
use super::onset::{Onset, OnsetMethod};
use super::scan::{Scan, growing};
use super::tracking::{TrackedMode, Tracker, branch_name};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::state_space::root;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::{Deserialize, Serialize};

/// Where and how densely to look.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OnsetSearch {
    /// Highest wind speed searched, m/s.
    pub speed_max_m_s: f64,
    /// Number of speeds between still air and the highest.
    pub speeds: usize,
}

impl Default for OnsetSearch {
    fn default() -> Self {
        Self {
            speed_max_m_s: 100.0,
            speeds: 200,
        }
    }
}

impl OnsetSearch {
    /// The wind speeds that are looked at, m/s: equally spaced, still air left out.
    ///
    /// # Errors
    /// [`Error::Input`] for a highest speed that is not positive or fewer than two speeds.
    pub(super) fn speeds_m_s(&self) -> Result<Vec<f64>> {
        let highest = positive("flutter.speed_max_m_s", self.speed_max_m_s)?;
        if self.speeds < 2 {
            return Err(Error::input(
                "flutter.speeds",
                "at least 2",
                self.speeds.to_string(),
            ));
        }
        let speed = |i: usize| highest * i as f64 / self.speeds as f64;
        Ok((1..=self.speeds).map(speed).collect())
    }
}

/// First wind speed at which a mode of `section` loses its damping.
///
/// Modes are followed from nearly still air and every crossing up to the highest speed is refined; beside that all
/// eigenvalues are looked at ([`growth_scan`](super::growth_scan)), so that growth of what is not followed, between the
/// speeds, or of modes that cannot be told apart, is found too. See [`FlutterSearch`] for which one is the answer.
/// `tested` is the range of reduced frequencies in which the model was tested: a mode that grows already where it
/// enters it is unstable at and below that speed, whatever the model says outside.
///
/// # Errors
/// [`Error::Input`] for a search range that is none; those of the eigenvalues.
pub fn find_onset(
    model: &str,
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let speeds = search.speeds_m_s()?;
    let scan = Scan::new(model, section, tested);
    let mut found = Findings::judged(scan.judged(search.speed_max_m_s)?);
    let following = Following {
        model,
        section,
        tested,
    };
    match following.run(scan.lowest(search.speed_max_m_s)?, &speeds, &mut found) {
        // without names the answer still stands
        Err(Error::Numerical(why)) => found.warnings.push(format!(
            "{why}: modes beyond that were not followed but found among all eigenvalues"
        )),
        other => other?,
    }
    scan.add_missed(&mut found, search.speed_max_m_s)?;
    Ok(choose(found, tested))
}

/// The structural modes, followed by what they are.
struct Following<'a> {
    model: &'a str,
    section: &'a CoupledSection,
    tested: Option<ReducedFrequencyRange>,
}

impl Following<'_> {
    fn run(&self, lowest: f64, speeds: &[f64], found: &mut Findings) -> Result<()> {
        let mut tracker = Tracker::start(self.section)?.advance(lowest)?;
        for mode in tracker.modes.iter().filter(|m| growing(&m.lambda)) {
            found
                .starts
                .push(self.start(lowest, mode, "the lowest speed looked at".to_owned()));
        }
        for &speed in speeds.iter().filter(|v| **v > lowest) {
            let next = tracker.advance(speed)?;
            for after in &next.modes {
                let Some(before) = tracker.mode(after.branch) else {
                    continue;
                };
                let ends = (before.lambda.re, after.lambda.re);
                if ends.0 < 0.0 && ends.1 >= 0.0 {
                    found.crossings.push(structural_crossing(
                        self.model,
                        &tracker,
                        &next,
                        after.branch,
                        ends,
                    )?);
                }
                found
                    .starts
                    .extend(self.entry(&tracker, &next, before, after)?);
            }
            tracker = next;
        }
        Ok(())
    }

    fn k(&self, speed: f64, mode: &TrackedMode) -> ReducedFrequency {
        let width = self.section.structure().width_m;
        ReducedFrequency::from_circular(mode.lambda.im, width, speed)
    }

    fn start(&self, speed: f64, mode: &TrackedMode, reason: String) -> UnstableStart {
        let structure = self.section.structure();
        let at = (speed, mode.lambda);
        let branch = branch_name(structure.dofs[mode.branch]);
        let method = OnsetMethod::Eigenvalues;
        let mut start = UnstableStart::new(self.model, method, structure, at, branch, reason);
        start.in_tested_range = self.tested.map(|range| range.contains(self.k(speed, mode)));
        start
    }

    /// A mode that comes into the tested range between two speeds and grows there.
    fn entry(
        &self,
        low: &Tracker<'_>,
        high: &Tracker<'_>,
        before: &TrackedMode,
        after: &TrackedMode,
    ) -> Result<Option<UnstableStart>> {
        let grows = before.lambda.re >= 0.0 || after.lambda.re >= 0.0;
        let Some(range) = self.tested.filter(|_| grows) else {
            return Ok(None);
        };
        let (from, to) = (self.k(low.speed, before), self.k(high.speed, after));
        if from <= range.max || to > range.max {
            return Ok(None);
        }
        let beyond = |k: ReducedFrequency| range.max.full_width() - k.full_width();
        let mode_at = |speed: f64| lost(low.advance(speed)?.mode(after.branch).cloned(), speed);
        let speed = root((low.speed, beyond(from)), (high.speed, beyond(to)), |v| {
            Ok(beyond(self.k(v, &mode_at(v)?)))
        })?;
        let mode = mode_at(speed)?;
        Ok(growing(&mode.lambda).then(|| {
            let mut start = self.start(speed, &mode, entry_reason(range.max));
            start.in_tested_range = Some(true);
            start
        }))
    }
}

fn lost<T>(mode: Option<T>, speed: f64) -> Result<T> {
    mode.ok_or_else(|| {
        Error::Numerical(format!("onset: the mode does not oscillate at {speed} m/s"))
    })
}

/// Refines the zero of `Re λ` of one structural mode.
fn structural_crossing(
    model: &str,
    low: &Tracker<'_>,
    high: &Tracker<'_>,
    branch: usize,
    (before, after): (f64, f64),
) -> Result<Onset> {
    let structure = low.section.structure();
    let mode_at = |speed: f64| lost(low.advance(speed)?.mode(branch).cloned(), speed);
    let speed = root((low.speed, before), (high.speed, after), |speed| {
        Ok(mode_at(speed)?.lambda.re)
    })?;
    let at = mode_at(speed)?;
    let nearby = mode_at(speed * (1.0 - 1e-5))?;
    let slope = (damping_ratio(at.lambda) - damping_ratio(nearby.lambda)) / (speed * 1e-5);
    let mut onset = Onset::new(
        model,
        OnsetMethod::Eigenvalues,
        structure,
        (speed, at.lambda.im),
        &at.shape,
        branch_name(structure.dofs[branch]),
    );
    onset.damping_slope_s_m = Some(slope);
    if single_dof(structure.dofs[branch], onset.mode_ratio) {
        onset.warnings.push(format!(
            "the mode is almost purely {}: a one-degree-of-freedom instability",
            structure.dofs[branch].name()
        ));
    }
    Ok(onset)
}

/// Whether the mode hardly moves any other degree of freedom than its own.
fn single_dof(dof: Dof, mode_ratio: f64) -> bool {
    match dof {
        Dof::Torsion => mode_ratio < 0.05,
        Dof::Vertical => mode_ratio > 20.0,
        Dof::Lateral => false,
    }
}
