//! How far the data behind the models of the sections leave the onset of a bridge open.

use super::answers::coupled;
use super::{BridgeStudy, SectionForceModels};
use crate::aerodynamics::Transfer;
use crate::bridge::Bridge;
use crate::error::{Error, Result};
use crate::flutter::{
    BetweenSpeeds, FlutterSearch, MovedOnset, NearbyOnset, Onset, OnsetInterval, OnsetSearch,
    find_onset, pk_onset,
};
use crate::trained_model::Model;
use crate::uncertainty::{
    AdmissibleForm, CoefficientUncertainty, FormEnsemble, FormOnset, FormSpread, OnsetError,
    interval_with_forms, speed_onsets_by,
};
use std::sync::Arc;

/// Relative step of the difference of onsets, and the smallest coefficient that it is relative to.
const STEP: f64 = 1e-4;
const SMALLEST: f64 = 1e-2;

/// How far above the onset those of other forms are looked for.
const REACH: f64 = 2.0;

impl BridgeStudy {
    /// 95 % interval of an onset of the bridge by its models: the covariance of the coefficients of every section through the
    /// slopes of the onset, and the onsets with the other forms that explain the data of a section as well, sections of other tests
    /// independent of each other. Slopes are differences of onsets, each found by following the mode that flutters.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the mode cannot be followed to nearby coefficients.
    pub fn onset_interval(&self, onset: &Onset) -> Result<OnsetInterval> {
        let nearby = NearbyOnset::new(&self.by_model, &onset.at)?;
        let (mut variance, mut of_each, mut spreads) = (0.0, 0.0, Vec::new());
        let mut between_speeds = None;
        for (section, forces) in self.fits() {
            let name = &self.file.sections[section].name;
            let known = match &forces.uncertainty {
                Ok(Some(known)) => known,
                // static coefficients are stated without errors
                Ok(None) => continue,
                Err(why) => return Ok(OnsetInterval::none(format!("section {name}: {why}"))),
            };
            let estimate = &known.coefficients;
            let gradient = self.onset_slopes(&nearby, section, estimate)?;
            let part = estimate.standard_error(&gradient)?.powi(2);
            // those of the section of the training stand in where a covariance on file no longer knows its data
            let trained = known.onset.as_ref().map(|o| o.degrees_of_freedom);
            let freedom = estimate.degrees_of_freedom(&gradient);
            let freedom = freedom.or(trained).unwrap_or(1.0);
            let spread = |forms| self.form_spread(section, forms, onset);
            spreads.extend(known.forms.as_ref().map(spread).transpose()?);
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
        Ok(interval_with_forms(&error, &spreads))
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
        let without_m_s = match nearby.and_then(|nearby| nearby.follow(&section)) {
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

    /// The first section that has the same fit to the same tests: what these leave open is open of all such sections together.
    pub(super) fn first_of_fit(&self, section: usize) -> usize {
        let known = |s: usize| self.sections[s].uncertainty.as_ref().ok()?.as_ref();
        let same = |s: &usize| known(*s).is_some() && known(*s) == known(section);
        (0..section).find(same).unwrap_or(section)
    }

    /// The first section of every fit.
    fn fits(&self) -> impl Iterator<Item = (usize, &SectionForceModels)> {
        let all = self.sections.iter().enumerate();
        all.filter(|(section, _)| self.first_of_fit(*section) == *section)
    }

    /// The bridge by its models with other forces of the sections of one fit.
    fn with_forces(&self, section: usize, forces: Arc<dyn Transfer>) -> Bridge {
        let mut bridge = self.by_model.clone();
        let groups = bridge.groups.iter_mut().zip(&self.section_of_group);
        for (group, _) in groups.filter(|(_, of)| self.first_of_fit(**of) == section) {
            group.forces = forces.clone();
        }
        bridge
    }

    /// Onsets with every form that explains the data of the sections of a fit as well.
    fn form_spread(
        &self,
        section: usize,
        forms: &FormEnsemble,
        onset: &Onset,
    ) -> Result<FormSpread> {
        let search = OnsetSearch::up_to(REACH * onset.at.speed_m_s);
        let tested = self.tested_range();
        let of_fit = |f: &AdmissibleForm| {
            let bridge = self.with_forces(section, Arc::new(f.model.clone()));
            let found = find_onset(&f.form, &coupled(&bridge)?, &search, tested)?;
            Ok(FormOnset::new(&f.form, Some(f.residual_ratio), &found))
        };
        forms.spread_by(of_fit, |by, table| {
            let bridge = self.with_forces(section, Arc::new(table.clone()));
            let found = pk_onset(by, &bridge.structure(), &bridge.forces(), &search, tested)?;
            Ok(FormOnset::new(by, None, &found))
        })
    }

    /// What a reader must know of an onset: where the mean speeds of the tests of a section contradict each other.
    pub(super) fn contradictions(&self, onset: &Onset) -> Result<Vec<String>> {
        let nearby = NearbyOnset::new(&self.by_model, &onset.at)?;
        let mut found = Vec::new();
        for (section, forces) in self.fits() {
            let (Ok(Some(known)), Some(tested)) = (&forces.uncertainty, forces.tested) else {
                continue;
            };
            let estimate = &known.coefficients;
            let slopes = |of: &CoefficientUncertainty| self.onset_slopes(&nearby, section, of);
            let alone = |own: &CoefficientUncertainty| -> Result<OnsetError> {
                let gradient = slopes(own)?;
                Ok(OnsetError {
                    speed_m_s: self.nearby_onset(&nearby, section, own.model_at(&own.values())?)?,
                    standard_error_m_s: own.standard_error(&gradient)?,
                    degrees_of_freedom: own.degrees_of_freedom(&gradient).unwrap_or(1.0),
                    between_speeds: None,
                })
            };
            let speeds = speed_onsets_by(estimate, tested, alone, || slopes(estimate))?;
            // a covariance on file knows no more of its tests than that of the training
            let warning = match speeds.each.is_empty() {
                true => known.warning(),
                false => speeds.contradiction.map(|c| c.explain()),
            };
            let name = &self.file.sections[section].name;
            found.extend(warning.map(|w| format!("section {name}: {w}")));
        }
        Ok(found)
    }

    /// The onset of the same mode with another model of one section, m/s.
    fn nearby_onset(&self, nearby: &NearbyOnset, section: usize, model: Model) -> Result<f64> {
        let bridge = self.with_forces(section, Arc::new(model));
        let found = nearby.follow(&coupled(&bridge)?);
        found.map(|found| found.speed_m_s).ok_or_else(|| {
            Error::Numerical("interval: the mode that flutters cannot be followed".into())
        })
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
            self.nearby_onset(nearby, section, estimate.model_at(&moved)?)
        };
        (0..values.len())
            .map(|p| {
                let step = STEP * values[p].abs().max(SMALLEST);
                Ok((onset_at(p, step)? - onset_at(p, -step)?) / (2.0 * step))
            })
            .collect()
    }
}
