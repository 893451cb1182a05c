//! How far the data behind the models of the sections leave the onset of a bridge open.

use super::BridgeStudy;
use super::answers::coupled;
use crate::error::{Error, Result};
use crate::flutter::{
    BetweenSpeeds, FlutterSearch, MovedOnset, NearbyOnset, Onset, OnsetInterval, find_onset,
};
use crate::uncertainty::{CoefficientUncertainty, OnsetError};
use std::sync::Arc;

/// Relative step of the difference of onsets, and the smallest coefficient that it is relative to.
const STEP: f64 = 1e-4;
const SMALLEST: f64 = 1e-2;

impl BridgeStudy {
    /// 95 % interval of an onset of the bridge by its models: the covariance of the coefficients of every section through the
    /// slopes of the onset, sections independent of each other. Slopes are differences of onsets, each found by following the
    /// mode that flutters.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the mode cannot be followed to nearby coefficients.
    pub fn onset_interval(&self, onset: &Onset) -> Result<OnsetInterval> {
        let nearby = NearbyOnset::new(&self.by_model, &onset.at)?;
        let (mut variance, mut of_each) = (0.0, 0.0);
        let mut between_speeds = None;
        for (section, forces) in self.sections.iter().enumerate() {
            let name = &self.file.sections[section].name;
            let estimate = match &forces.uncertainty {
                Ok(Some(estimate)) => estimate,
                // static coefficients are stated without errors
                Ok(None) => continue,
                Err(why) => return Ok(OnsetInterval::none(format!("section {name}: {why}"))),
            };
            let gradient = self.onset_slopes(&nearby, section, estimate)?;
            let part = estimate.standard_error(&gradient)?.powi(2);
            let freedom = estimate.degrees_of_freedom(&gradient);
            let freedom = freedom.or(forces.degrees_of_freedom).unwrap_or(1.0);
            variance += part;
            if between_speeds != Some(BetweenSpeeds::Prior) {
                between_speeds = estimate.speeds.as_ref().map(|s| s.source);
            }
            // as Satterthwaite adds them
            of_each += part * part / freedom;
        }
        if variance == 0.0 {
            let reason = "the forces are stated without errors";
            return Ok(OnsetInterval::none(reason));
        }
        let error = OnsetError {
            speed_m_s: onset.at.speed_m_s,
            standard_error_m_s: variance.sqrt(),
            degrees_of_freedom: variance * variance / of_each,
            between_speeds,
        };
        Ok(error.interval())
    }

    /// The onset that the data alone would give, beside the one under the constraints that hold fits of sections; `None` where none do.
    ///
    /// # Errors
    /// As [`find_onset`].
    pub(super) fn moved_onset(&self, with: &FlutterSearch) -> Result<Option<MovedOnset>> {
        if self.sections.iter().all(|s| s.unconstrained.is_none()) {
            return Ok(None);
        }
        let mut bridge = self.by_model.clone();
        for (group, section) in bridge.groups.iter_mut().zip(&self.section_of_group) {
            if let Some(forces) = &self.sections[*section].unconstrained {
                group.forces = forces.clone();
            }
        }
        let section = coupled(&bridge)?;
        let onset = with.onset();
        // most constraints move the onset by little: then its mode can be followed without another search
        let nearby = onset.and_then(|o| NearbyOnset::new(&self.by_model, &o.at).ok());
        let without_m_s = match nearby.and_then(|nearby| nearby.find(&section)) {
            Some(at) => Some(at.speed_m_s),
            None => find_onset("data alone", &section, &self.search(), self.tested_range())?
                .onset()
                .map(|o| o.at.speed_m_s),
        };
        Ok(Some(MovedOnset {
            without_m_s,
            with_m_s: onset.map(|o| o.at.speed_m_s),
        }))
    }

    /// Slopes of the onset over the coefficients of one section, m/s.
    fn onset_slopes(
        &self,
        nearby: &NearbyOnset,
        section: usize,
        estimate: &CoefficientUncertainty,
    ) -> Result<Vec<f64>> {
        let values = estimate.values();
        let onset_at = |p: usize, step: f64| -> Result<f64> {
            let mut moved = values.clone();
            moved[p] += step;
            let forces = Arc::new(estimate.model_at(&moved)?);
            let mut bridge = self.by_model.clone();
            let groups = bridge.groups.iter_mut().zip(&self.section_of_group);
            for (group, _) in groups.filter(|(_, of)| **of == section) {
                group.forces = forces.clone();
            }
            let found = nearby.find(&coupled(&bridge)?);
            found.map(|found| found.speed_m_s).ok_or_else(|| {
                Error::Numerical("interval: the mode that flutters cannot be followed".into())
            })
        };
        (0..values.len())
            .map(|p| {
                let step = STEP * values[p].abs().max(SMALLEST);
                Ok((onset_at(p, step)? - onset_at(p, -step)?) / (2.0 * step))
            })
            .collect()
    }
}
