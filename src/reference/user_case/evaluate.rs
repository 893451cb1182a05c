//! Loads the forces of a case, computes its figures and judges them.

use super::super::flat_plate::WIDE;
use super::{FigureQuantity, UserCase, UserFigure};
use crate::aerodynamics::derivatives::{Extrapolation, InterpolatedTable};
use crate::aerodynamics::{Lags, RationalModel, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure};
use crate::files::derivatives::named_table;
use crate::flutter::{
    FlutterSearch, Onset, OnsetMethod, OnsetSearch, determinant_onset, divergence_speed,
    find_onset, pk_onset, quasi_pk_mode, static_part,
};
use crate::reference::{CaseResult, Citation};
use crate::section::{Dof, SectionModel, Structure};
use crate::trained_model::TrainedModel;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::verdict::sanity_lines;
use std::f64::consts::TAU;

impl UserCase {
    /// Computes every figure. A computation that fails is a result that has not passed.
    pub(crate) fn run(&self) -> Vec<CaseResult> {
        let loaded = LoadedCase::new(self).map_err(|e| e.to_string());
        let judge = |figure: &UserFigure| {
            let found = loaded.as_ref().map_err(Clone::clone);
            let found = found.and_then(|loaded| loaded.figure(figure).map_err(|e| e.to_string()));
            self.stated(figure).judged(found)
        };
        self.figures.iter().map(judge).collect()
    }

    fn stated(&self, figure: &UserFigure) -> CaseResult {
        let (name, unit) = figure.quantity.words();
        let mut quantity = name.to_owned();
        if let (Some(dof), Some(speed)) = (figure.dof, figure.speed_m_s) {
            quantity = format!("{} at {speed} m/s: {name}", dof.name());
        } else if let Some(route) = figure.route {
            quantity = format!("{name} ({})", route.name());
        }
        // as many digits as the tolerance makes sense of, and those of what was expected
        let meant = (-figure.tolerance.log10().floor()).clamp(0.0, 12.0) as usize;
        let written = figure.expected.to_string();
        let written = written.split_once('.').map_or(0, |(_, part)| part.len());
        CaseResult {
            name: self.name.clone(),
            what: self.what.clone(),
            quantity,
            unit: unit.into(),
            expected: figure.expected,
            decimals: meant.max(written.min(12)),
            found: None,
            deviation: None,
            tolerance: figure.tolerance,
            reason: figure.reason.clone(),
            passed: false,
            source: Citation::Stated(figure.source.clone()),
            headline: true,
            problem: None,
        }
    }
}

/// A case with its forces loaded.
struct LoadedCase {
    structure: Structure,
    model: Box<dyn Transfer>,
    tested: Option<ReducedFrequencyRange>,
    speed_max: f64,
}

impl LoadedCase {
    /// Reads what the case names.
    fn new(case: &UserCase) -> Result<Self> {
        let a = &case.aerodynamics;
        let mut section = case.section.clone();
        let stated = section.as_ref();
        let dofs = stated.map_or(Dof::TWO.to_vec(), SectionModel::dofs);
        let (model, tested): (Box<dyn Transfer>, _) = if let Some(path) = &a.model {
            let trained = TrainedModel::read(&case.directory.join(path))?;
            section.get_or_insert(trained.section);
            (Box::new(trained.model), Some(trained.tested_range))
        } else if let Some(name) = &a.table {
            let table = named_table(name, &case.directory)?;
            let by = a.interpolation.unwrap_or_default();
            let model = InterpolatedTable::by(by, &table, &dofs, Extrapolation::Hold)?;
            let range = model.tested_range();
            (Box::new(model), Some(range))
        } else if let Some(r) = &a.rational {
            let model = RationalModel {
                dofs,
                a1: r.a1.clone(),
                a2: r.a2.clone(),
                a3: r.a3.clone(),
                lags: Lags::Shared(r.lags.clone()),
                lag_terms: r.lag_terms.clone(),
            };
            model.validate()?;
            (Box::new(model), None)
        } else {
            (Box::new(a.flat_plate.unwrap_or_default()), None)
        };
        let section = section.ok_or_else(|| Error::input("section", "a section", "none"))?;
        let structure = section.structure()?;
        let (own, found) = (Dof::names(model.dofs()), Dof::names(&structure.dofs));
        let expected = format_args!("the degrees of freedom of the forces, {own}");
        ensure(model.dofs() == structure.dofs, "section", expected, found)?;
        Ok(Self {
            structure,
            model,
            tested,
            speed_max: case.speed_max_m_s,
        })
    }

    /// One figure.
    fn figure(&self, figure: &UserFigure) -> Result<f64> {
        let nothing = |what: &str| Error::Numerical(format!("no {what}"));
        Ok(match figure.quantity {
            FigureQuantity::DivergenceSpeed => {
                // a table says nothing about steady flow; its static part at the lowest tested K is the nearest to it
                let slowest = self.tested.filter(|_| self.model.realizable().is_none());
                let k = slowest.map_or(ReducedFrequency::from_full_width(0.0), |range| range.min);
                let mut steady = self.model.transfer(k)?;
                if slowest.is_some() {
                    steady = static_part(self.model.dofs(), &steady);
                }
                divergence_speed(&self.structure, &steady)?.ok_or_else(|| nothing("divergence"))?
            }
            FigureQuantity::Selberg | FigureQuantity::Rocard => {
                let lines = sanity_lines(&self.structure)
                    .ok_or_else(|| nothing("formula: the rotation is not faster than the heave"))?;
                match figure.quantity {
                    FigureQuantity::Selberg => lines.selberg_m_s,
                    _ => lines.rocard_m_s,
                }
            }
            FigureQuantity::ModeFrequency | FigureQuantity::ModeDampingRatio => {
                self.in_wind(figure)?
            }
            quantity => {
                let onset = self.onset(figure.route)?;
                let of_mode = |o: &Onset| o.mode.ok_or_else(|| nothing("rotation at the onset"));
                match quantity {
                    FigureQuantity::OnsetSpeed => onset.at.speed_m_s,
                    FigureQuantity::OnsetFrequency => onset.at.frequency_hz,
                    FigureQuantity::OnsetReducedVelocity => onset.at.reduced_velocity.v_star(),
                    FigureQuantity::OnsetVHat => onset.at.reduced_frequency.v_hat(),
                    FigureQuantity::ModeRatio => of_mode(&onset)?.mode_ratio,
                    FigureQuantity::Phase => of_mode(&onset)?.phase_deg,
                    _ => onset
                        .damping_slope_s_m
                        .ok_or_else(|| nothing("damping slope by this route"))?,
                }
            }
        })
    }

    fn in_wind(&self, figure: &UserFigure) -> Result<f64> {
        let speed = figure.speed_m_s.unwrap_or(0.0);
        let dofs = &self.structure.dofs;
        let place = dofs.iter().position(|d| Some(*d) == figure.dof);
        let dof = place.ok_or_else(|| {
            let expected = format!("one of {}", Dof::names(dofs));
            Error::input("dof", expected, figure.dof.map_or("none", Dof::name))
        })?;
        let mode = quasi_pk_mode(&self.structure, self.model.as_ref(), speed, dof)?;
        let k = ReducedFrequency::from_circular(mode.im, self.structure.width_m, speed);
        if let Some(known) = self.model.known_range().filter(|range| !range.contains(k)) {
            return Err(Error::Numerical(format!(
                "the mode at {speed} m/s has K = {:.4}; the table knows {:.4} to {:.4} only",
                k.full_width(),
                known.min.full_width(),
                known.max.full_width()
            )));
        }
        Ok(match figure.quantity {
            FigureQuantity::ModeFrequency => mode.im / TAU,
            _ => -mode.re / mode.norm(),
        })
    }

    fn onset(&self, route: Option<OnsetMethod>) -> Result<Onset> {
        let realizable = self.model.realizable();
        let route = route.unwrap_or(match realizable.is_some() {
            true => OnsetMethod::Eigenvalues,
            false => OnsetMethod::Determinant,
        });
        let (s, model) = (&self.structure, self.model.as_ref());
        let search = OnsetSearch::up_to(self.speed_max);
        let found: FlutterSearch = match (route, realizable) {
            (OnsetMethod::Eigenvalues, Some(aero)) => {
                let section = CoupledSection::with_model(s, aero)?;
                find_onset("", &section, &search, self.tested)?
            }
            (OnsetMethod::Eigenvalues, None) => {
                let expected = "forces with a realisation for the eigenvalues";
                let found = "forces that are only a G(K)";
                return Err(Error::input("route", expected, found));
            }
            (OnsetMethod::PkIteration, _) => pk_onset("", s, model, &search, self.tested)?,
            _ => determinant_onset("", s, model, self.tested.unwrap_or(WIDE), self.speed_max)?,
        };
        let none = || Error::Numerical(found.explain());
        found.onset().cloned().ok_or_else(none)
    }
}
