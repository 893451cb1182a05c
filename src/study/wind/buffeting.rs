//! Buffeting of a wind file: RMS over wind speed, spectra, both domains side by side.

mod verdict;

use super::{QUASI_STEADY, WindStudy};
use crate::aerodynamics::derivatives::{Extrapolation, InterpolatedTable};
use crate::aerodynamics::quasi_steady::{LinearQuasiSteady, QuasiSteady};
use crate::aerodynamics::{FlatPlate, RationalModel, Transfer};
use crate::aeroelastic::{StaticEquilibrium, static_equilibria};
use crate::buffeting::{
    BuffetingProblem, BuffetingResponse, ComponentComparison, Ensemble, FrequencyDomain,
    SpectrumCurve, compare, time_ensemble,
};
use crate::error::{Error, Result};
use crate::files::derivatives::{embedded, is_table_file, named_table_in};
use crate::identification::{Fitted, FrequencyFit, fit_table};
use crate::numbered::OnDone;
use crate::plausibility::{Finding, of_table};
use crate::section::{Dof, SectionModel, Structure};
use crate::units::{ReducedFrequencyRange, in_equal_ratios};
use serde::Serialize;
use std::f64::consts::TAU;

const FLAT_PLATE: &str = "flat plate";
const JONES: &str = "flat plate (Jones)";
/// Frequencies of the spectra, over this range about the natural ones.
const SPECTRUM_POINTS: usize = 600;
/// Lines of a table at most.
const TABLE_LINES: usize = 15;
const SPECTRUM_REACH: (f64, f64) = (0.05, 8.0);

/// Response to turbulence over wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct BuffetingStudy {
    /// The self-excited forces in words.
    pub aerodynamics: String,
    /// Degrees of freedom, in the order of all vectors.
    pub dofs: Vec<Dof>,
    /// Deck width, m.
    pub width_m: f64,
    /// Root mean squares at each speed at which the section is stable.
    pub responses: Vec<BuffetingResponse>,
    /// Static equilibria at those speeds, as far as static coefficients have one.
    pub mean: Vec<StaticEquilibrium>,
    /// Speeds of the lists that have no answer.
    pub left_out: Vec<SpeedLeftOut>,
    /// Spectra at the speeds of the time domain, else at the middle speed.
    pub spectra: Vec<SpectrumCurve>,
    /// Both domains at the speeds asked for.
    pub time: Vec<TimeDomain>,
    /// How the model that is stepped in time was fitted to the table that is the answer.
    pub fit: Option<String>,
}

impl BuffetingStudy {
    /// The wind speeds at which there is no response, and why.
    pub(crate) fn without_response(&self) -> Vec<String> {
        let groups = self.left_out.chunk_by(|a, b| a.reason == b.reason);
        let lines = groups.map(|group| {
            let speeds = group.iter().map(|s| format!("{:.2}", s.speed_m_s));
            let speeds = speeds.collect::<Vec<_>>().join(", ");
            let reason = group.first().map_or("", |s| s.reason.as_str());
            format!("at {speeds} m/s: {reason}")
        });
        lines.collect()
    }

    /// Responses for a table: at most fifteen, of finer lists of speeds every second, third, …
    pub(crate) fn shown(&self) -> impl Iterator<Item = &BuffetingResponse> {
        let every = self.responses.len().div_ceil(TABLE_LINES).max(1);
        self.responses.iter().step_by(every)
    }

    /// That not all responses are shown, where that is so.
    pub(crate) fn shortened(&self) -> Option<String> {
        let (shown, all) = (self.shown().count(), self.responses.len());
        (shown < all)
            .then(|| format!("The table has {shown} of {all} wind speeds, buffeting.json all."))
    }
}

/// A wind speed without a stationary response.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct SpeedLeftOut {
    /// The speed, m/s.
    pub speed_m_s: f64,
    /// Why.
    pub reason: String,
}

/// Both domains at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct TimeDomain {
    /// The records.
    pub ensemble: Ensemble,
    /// Degree by degree of freedom.
    pub comparison: Vec<ComponentComparison>,
    /// Root mean square in the frequency domain by the model that is stepped over that by the table, less 1, where there is a
    /// table.
    pub model_change: Option<Vec<f64>>,
}

/// What does not change with the wind speed.
struct Setting<'a> {
    study: &'a WindStudy,
    structure: Structure,
    theory: Option<QuasiSteady>,
    fixed: Option<Box<dyn Transfer>>,
    /// The model fitted to a table, which alone can be stepped, and how.
    fitted: Option<(Box<dyn Transfer>, String)>,
    tested: Option<ReducedFrequencyRange>,
    /// Mean angle of the tests of a table that states it, deg.
    angle_deg: Option<f64>,
    /// What is odd about a table.
    findings: Vec<Finding>,
}

/// RMS over these mean wind speeds, m/s, spectra, and the time domain where it is asked for. `progress` gets records done and
/// all of them.
pub(crate) fn buffeting_study(
    study: &WindStudy,
    speeds_m_s: &[f64],
    progress: OnDone<'_>,
) -> Result<BuffetingStudy> {
    let setting = Setting::new(study)?;
    let mut responses = Vec::new();
    let mut left_out = Vec::new();
    for speed in speeds_m_s {
        responses.extend(answered(*speed, setting.response(*speed), &mut left_out)?);
    }
    // the same test for the speeds of the time domain, in which an unstable section would only grow
    let mut timed = Vec::new();
    for speed in &study.time.speeds_m_s {
        timed.extend(answered(*speed, setting.response(*speed), &mut left_out)?);
    }
    let records = study.time.plan.records;
    let mut time = Vec::with_capacity(timed.len());
    for (i, response) in timed.iter().enumerate() {
        let of_all = |done: usize, _: usize| progress(i * records + done, timed.len() * records);
        let domains = setting
            .both_domains(response, &of_all)
            .map_err(|e| match e {
                // the table knows of no growth at this speed
                Error::Unstable(why) if setting.fitted.is_some() => Error::Unstable(format!(
                    "no time domain, the model fitted to the table grows: {why}"
                )),
                // what the frequency domain has found stays
                Error::Input(why) => Error::Unstable(format!("no time domain: {why}")),
                other => other,
            });
        time.extend(answered(response.speed_m_s, domains, &mut left_out)?);
    }
    left_out.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
    left_out.dedup_by(|a, b| a.speed_m_s == b.speed_m_s);
    let mut of_spectra: Vec<f64> = timed.iter().map(|r| r.speed_m_s).collect();
    if study.time.speeds_m_s.is_empty() {
        of_spectra.extend(responses.get(responses.len() / 2).map(|r| r.speed_m_s));
    }
    let spectra = of_spectra.iter().map(|speed| setting.spectra(*speed));
    let spectra = spectra.collect::<Result<_>>()?;
    Ok(BuffetingStudy {
        aerodynamics: study.aerodynamics.clone(),
        dofs: setting.structure.dofs.clone(),
        width_m: setting.structure.width_m,
        mean: setting.equilibria(&responses),
        responses,
        left_out,
        spectra,
        time,
        fit: setting.fitted.map(|(_, how)| how),
    })
}

/// What was found at a speed, unless nothing is stationary there, which is noted.
fn answered<T>(
    speed_m_s: f64,
    found: Result<T>,
    left_out: &mut Vec<SpeedLeftOut>,
) -> Result<Option<T>> {
    match found {
        Err(Error::Unstable(reason)) => {
            left_out.push(SpeedLeftOut { speed_m_s, reason });
            Ok(None)
        }
        found => found.map(Some),
    }
}

impl<'a> Setting<'a> {
    fn new(study: &'a WindStudy) -> Result<Self> {
        let section: SectionModel = study.section()?;
        let theory = study.coefficients.is_some().then(|| study.quasi_steady());
        let theory = theory.transpose()?;
        let structure = section.structure()?;
        let mut setting = Self {
            study,
            structure,
            theory,
            fixed: None,
            fitted: None,
            tested: None,
            angle_deg: None,
            findings: Vec::new(),
        };
        match study.aerodynamics.as_str() {
            // they change with the wind speed
            QUASI_STEADY => drop(study.static_coefficients()?),
            FLAT_PLATE => setting.fixed = Some(Box::new(FlatPlate::default())),
            JONES => setting.fixed = Some(Box::new(RationalModel::jones_flat_plate())),
            name if is_table_file(name) || embedded::deck(name).is_ok() => {
                setting.take_table(name)?;
            }
            other => {
                let model = study.trained_model()?.ok_or_else(|| {
                    let decks: Vec<_> = embedded::names().collect();
                    let expected = format!(
                        "`{QUASI_STEADY}`, `{FLAT_PLATE}`, `{JONES}`, a trained model (.json), a table of derivatives (.csv, \
                         .xlsx), or an embedded deck ({})",
                        decks.join(", ")
                    );
                    Error::input("aerodynamics", expected, format!("`{other}`"))
                })?;
                setting.tested = Some(model.tested_range);
                setting.fixed = Some(Box::new(model.model));
            }
        }
        Ok(setting)
    }

    /// The table between its points for the frequency domain, a model fitted to it for the time domain where that is asked for.
    fn take_table(&mut self, name: &str) -> Result<()> {
        let study = self.study;
        let table = named_table_in(name, &study.directory, study.convention, "convention")?;
        self.angle_deg = table.header.angle_deg;
        self.findings = of_table(&table, &study.convention.or_usual());
        let dofs = &self.structure.dofs;
        let by = study.interpolation;
        let between = InterpolatedTable::by(by, &table, dofs, Extrapolation::Hold)?;
        if !study.time.speeds_m_s.is_empty() {
            let fit = FrequencyFit::default();
            let Fitted { model, report } = fit_table(&table.samples(dofs), dofs, &fit)?;
            self.fitted = Some((Box::new(model), report.method));
        }
        self.tested = Some(between.tested_range());
        self.fixed = Some(Box::new(between));
        Ok(())
    }

    /// Quasi-steady theory at one speed, where there are coefficients: about the equilibrium, where it is the self-excited forces as
    /// well, else at rotation zero.
    ///
    /// # Errors
    /// [`Error::Unstable`] where there is no equilibrium.
    fn at(&self, speed_m_s: f64) -> Result<Option<LinearQuasiSteady>> {
        let Some(theory) = &self.theory else {
            return Ok(None);
        };
        if self.fixed.is_some() {
            return theory.linearised(0.0).map(Some);
        }
        let path = static_equilibria(&self.structure, theory, &[speed_m_s])?;
        let none = || path.end.map(|end| end.explain());
        let point = path.points.first().ok_or_else(|| {
            Error::Unstable(none().unwrap_or_else(|| "no equilibrium".to_owned()))
        })?;
        theory.linearised(point.rotation_rad).map(Some)
    }

    /// About which the responses are.
    fn equilibria(&self, responses: &[BuffetingResponse]) -> Vec<StaticEquilibrium> {
        let Some(theory) = &self.theory else {
            return Vec::new();
        };
        let at = |r: &BuffetingResponse| {
            let path = static_equilibria(&self.structure, theory, &[r.speed_m_s]);
            path.map_or_else(|_| Vec::new(), |path| path.points)
        };
        responses.iter().flat_map(at).collect()
    }

    /// The problem with the forces of the file, or with a model fitted to them.
    fn problem<'b>(
        &'b self,
        fitted: Option<&'b dyn Transfer>,
        at: Option<&'b LinearQuasiSteady>,
    ) -> Result<BuffetingProblem<'b>> {
        let moving = at.map(|linear| linear as &dyn Transfer);
        let model = fitted.or(self.fixed.as_deref()).or(moving);
        let turbulence = self.study.turbulence.as_ref();
        BuffetingProblem::of_section(
            &self.structure,
            model.ok_or_else(|| Error::input("aerodynamics", "a model", "none"))?,
            at,
            turbulence
                .ok_or_else(|| Error::input("turbulence", "`along`, `vertical` or both", "none"))?,
        )
    }

    /// The response.
    ///
    /// # Errors
    /// [`Error::Unstable`] where none is stationary.
    fn response(&self, speed: f64) -> Result<BuffetingResponse> {
        let at = self.at(speed)?;
        let problem = self.problem(None, at.as_ref())?;
        let domain = FrequencyDomain::turned(&problem, speed).map_err(|e| match e {
            // at an onset itself nothing can be told, which is no reason to end the other speeds
            Error::Numerical(why) => Error::Unstable(why),
            other => other,
        })?;
        match domain.growing {
            0 => domain.section_response(self.tested),
            unstable => Err(Error::Unstable(format!(
                "the section is unstable ({unstable} growing roots): no stationary response"
            ))),
        }
    }

    /// The records of a speed, beside its response.
    fn both_domains(
        &self,
        frequency: &BuffetingResponse,
        progress: OnDone<'_>,
    ) -> Result<TimeDomain> {
        let speed = frequency.speed_m_s;
        let at = self.at(speed)?;
        let fitted = self.fitted.as_ref().map(|(model, _)| model.as_ref());
        let problem = self.problem(fitted, at.as_ref())?;
        let by_model = fitted
            .map(|_| FrequencyDomain::new(&problem, speed)?.section_response(self.tested))
            .transpose()?;
        let ensemble = time_ensemble(&problem, speed, &self.study.time.plan, progress)?;
        Ok(TimeDomain {
            comparison: compare(&self.structure.dofs, frequency, &ensemble),
            ensemble,
            model_change: by_model.map(|by_model| {
                let both = by_model.rms.iter().zip(&frequency.rms);
                both.map(|(m, t)| m / t - 1.0).collect()
            }),
        })
    }

    fn spectra(&self, speed: f64) -> Result<SpectrumCurve> {
        let at = self.at(speed)?;
        let still_air_hz = || self.structure.still_air_rad_s().map(|w| w / TAU);
        let low = still_air_hz().fold(f64::INFINITY, f64::min);
        let high = still_air_hz().fold(0.0, f64::max);
        let (low, high) = (low * SPECTRUM_REACH.0, high * SPECTRUM_REACH.1);
        let frequencies = in_equal_ratios(low, high, SPECTRUM_POINTS).collect();
        let problem = self.problem(None, at.as_ref())?;
        problem.spectra_over(frequencies, speed, &[0])
    }
}
