//! What the scan of all eigenvalues adds to the modes that were followed.

use super::answer::{Findings, UnstableStart};
use super::critical_point::{CriticalPoint, OnsetMethod};
use super::onset::Onset;
use super::scan::{AERODYNAMIC, Scan};
use super::tracking::{SLOPE_STEP, mode_shape};
use crate::error::Result;
use crate::state_space::damping_ratio;
use nalgebra::Complex;

/// Growth of at most this part of the eigenvalue at the lower end of a band is that of a crossing, not of a mode that
/// enters the tested range.
const JUST_GROWING: f64 = 1e-6;

impl Scan<'_> {
    /// Adds growth from still air up to a speed that is not among the findings yet; what lies above an answer inside the
    /// tested range does not matter.
    pub(super) fn add_missed(&self, found: &mut Findings, to_m_s: f64) -> Result<()> {
        // without warnings the structural modes were followed
        let coarse = found.warnings.is_empty();
        let spanned = |k| self.tested.is_none_or(|range| range.spans(k));
        let crossings = found.crossings.iter().map(|o| &o.at);
        let trusted = crossings.filter(|at| spanned(at.reduced_frequency));
        let to_m_s = trusted.map(|at| at.speed_m_s).fold(to_m_s, f64::min);
        for band in self.bands(to_m_s, coarse, f64::INFINITY)? {
            let at = self.at(band.from_m_s)?;
            if let Some(lambda) = at.fastest.filter(|_| !found.knows(band.from_m_s)) {
                if band.from_start {
                    let mut start = self.start(band.from_m_s, lambda, "the lowest speed looked at");
                    start.in_tested_range = self.inside(band.from_m_s, lambda);
                    found.starts.push(start);
                } else {
                    found.crossings.push(self.crossing(band.from_m_s, lambda)?);
                }
            }
            let tested_from = band.tested_from_m_s.filter(|v| !found.knows(*v));
            let inside = tested_from.map(|v| self.at(v)).transpose()?;
            let Some((at, lambda)) = inside.and_then(|p| Some((p, p.inside?))) else {
                continue;
            };
            if lambda.re > JUST_GROWING * lambda.norm() {
                let reason = "there its motion enters the range that can be judged";
                let mut start = self.start(at.speed, lambda, reason);
                start.in_tested_range = Some(true);
                found.starts.push(start);
            } else {
                found.crossings.push(self.crossing(at.speed, lambda)?);
            }
        }
        Ok(())
    }

    fn motion(&self, speed: f64, lambda: Complex<f64>) -> CriticalPoint {
        let (s, method) = (self.section.structure(), OnsetMethod::Eigenvalues);
        CriticalPoint::of_motion(self.model, method, s, speed, lambda.im)
    }

    fn start(&self, speed: f64, lambda: Complex<f64>, reason: &str) -> UnstableStart {
        let (at, branch) = (self.motion(speed, lambda), self.branch(speed, lambda));
        UnstableStart::new(at, lambda.re, branch, reason.to_owned())
    }

    fn crossing(&self, speed: f64, lambda: Complex<f64>) -> Result<Onset> {
        let shape = mode_shape(self.section, &self.section.at(speed)?, lambda)?;
        let (at, branch) = (self.motion(speed, lambda), self.branch(speed, lambda));
        let mut onset = Onset::new(at, self.section.structure(), &shape, branch);
        let nearby = self.at(speed * (1.0 - SLOPE_STEP))?.fastest;
        let slope = |before| (damping_ratio(lambda) - damping_ratio(before)) / (speed * SLOPE_STEP);
        onset.damping_slope_s_m = nearby.map(slope);
        if onset.branch == AERODYNAMIC {
            onset.warnings.push(
                "an eigenvalue of the forces, which is no mode of still air, becomes unstable: a defect of the fit, unless static \
                 divergence is near"
                    .to_owned(),
            );
        }
        Ok(onset)
    }
}
