//! Are the intervals reliable? Virtual campaigns whose truth is known, fitted many times over.

mod plan;
mod report;

pub use plan::{CoveragePlan, Truth};
pub use report::{CoverageReport, IntervalCoverage};

use super::coefficients::{CoefficientUncertainty, spread_over};
use super::model::derivative_intervals;
use super::onset::{OnsetError, onset_error};
use super::record_covariance::record_uncertainty;
use super::scattered::ScatteredTunnel;
use crate::aerodynamics::{FlatPlate, RationalModel, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{Onset, OnsetSearch, determinant_onset, find_onset};
use crate::identification::samples::part_of;
use crate::identification::{Fitted, TimeFit, fit_records};
use crate::numbered::{OnDone, numbered};
use crate::section::SectionModel;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{Record, RecordSource, TunnelPlan};

/// Highest wind speed at which an onset is looked for, m/s.
const SPEED_MAX_M_S: f64 = 80.0;
/// Reduced frequencies at which derivatives are compared.
const DERIVATIVE_POINTS: usize = 8;

/// Runs the campaign over and over, each time with noise of its own, in parallel.
///
/// # Errors
/// [`Error::Input`] for impossible plans; [`Error::Numerical`] when no fit or no search gives an onset.
pub fn coverage(plan: &CoveragePlan, progress: OnDone<'_>) -> Result<CoverageReport> {
    let campaign = KnownDeck::new(plan)?;
    let runs = numbered(plan.repetitions, progress, |r| campaign.repeat(r))?;
    campaign.summary(plan, &runs)
}

struct KnownDeck {
    section: SectionModel,
    model: Box<dyn Transfer + Sync>,
    records: ScatteredTunnel,
    tunnel: TunnelPlan,
    fit: TimeFit,
    tested: ReducedFrequencyRange,
    true_onset_m_s: f64,
    bias_m_s: f64,
}

/// One repetition.
struct Repetition {
    error: OnsetError,
    derivatives_inside: Vec<bool>,
    speeds_differ: bool,
}

impl KnownDeck {
    fn new(plan: &CoveragePlan) -> Result<Self> {
        plan.validate()?;
        let section = SectionModel::table_4_1();
        let model: Box<dyn Transfer + Sync> = match plan.truth {
            Truth::Jones => Box::new(RationalModel::jones_flat_plate()),
            Truth::Theodorsen => Box::new(FlatPlate::default()),
        };
        let quiet = TunnelPlan {
            noise_fraction: 0.0,
            ..plan.tunnel.clone()
        };
        let (width_m, speeds, runs) = (section.width_m, plan.speed_scatter, plan.run_scatter);
        let records = ScatteredTunnel::new(&quiet, model.as_ref(), width_m, speeds, runs)?;
        let mut campaign = Self {
            true_onset_m_s: 0.0,
            bias_m_s: 0.0,
            section,
            model,
            records,
            tunnel: plan.tunnel.clone(),
            fit: plan.time_fit(),
            tested: ReducedFrequencyRange::between(
                ReducedFrequency::from_full_width(0.02),
                ReducedFrequency::from_full_width(10.0),
            ),
        };
        let structure = campaign.section.structure()?;
        let found = determinant_onset(
            "truth",
            &structure,
            campaign.model.as_ref(),
            campaign.tested,
            SPEED_MAX_M_S,
        )?;
        campaign.true_onset_m_s = found
            .onset()
            .ok_or_else(|| Error::Numerical("coverage: the truth does not flutter".into()))?
            .at
            .speed_m_s;
        let (_, onset, tested) = campaign.fitted(&campaign.records.straight)?;
        campaign.tested = tested;
        let onset = onset
            .ok_or_else(|| Error::Numerical("coverage: the fit without noise is stable".into()))?;
        campaign.bias_m_s = onset.at.speed_m_s - campaign.true_onset_m_s;
        Ok(campaign)
    }

    /// Fit, its uncertainty, its onset and its tested range.
    fn fitted(
        &self,
        records: &[Record],
    ) -> Result<(CoefficientUncertainty, Option<Onset>, ReducedFrequencyRange)> {
        let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
        let Fitted { model, report } = fit_records(&sources, &self.fit, &|_| ())?;
        let estimate = record_uncertainty(&sources, &self.fit, &report, &|_| ())?;
        let section = CoupledSection::with_model(&self.section.structure()?, &model)?;
        let search = OnsetSearch {
            speed_max_m_s: SPEED_MAX_M_S,
            ..OnsetSearch::default()
        };
        let found = find_onset("", &section, &search, Some(report.tested_range))?;
        Ok((estimate, found.onset().cloned(), report.tested_range))
    }

    fn repeat(&self, repetition: usize) -> Result<Option<Repetition>> {
        let seed = self.tunnel.seed.wrapping_add(repetition as u64);
        let mut records = self.records.draw(seed);
        let plan = TunnelPlan {
            seed,
            ..self.tunnel.clone()
        };
        for (index, record) in records.iter_mut().enumerate() {
            plan.add_noise(record, index);
        }
        let (estimate, onset, _) = self.fitted(&records)?;
        let Some(onset) = onset else {
            return Ok(None);
        };
        let error = onset_error(&estimate, &self.section.structure()?, &onset, None)?;
        Ok(Some(Repetition {
            error,
            derivatives_inside: self.derivatives(&estimate)?,
            speeds_differ: estimate
                .speeds
                .as_ref()
                .is_some_and(|s| s.ratio.is_some_and(|r| r > 1.0)),
        }))
    }

    fn derivatives(&self, estimate: &CoefficientUncertainty) -> Result<Vec<bool>> {
        let ks = spread_over(self.tested, DERIVATIVE_POINTS);
        let mut inside = Vec::new();
        for interval in derivative_intervals(estimate, &ks)? {
            let k = ReducedFrequency::from_full_width(interval.k);
            let g = self.model.transfer(k)?;
            let place = |dof| estimate.dofs.iter().position(|d| *d == dof).unwrap_or(0);
            let which = interval.derivative;
            let z = g[(place(which.force()), place(which.motion()))];
            let truth = part_of(z, which.part()) / interval.k.powi(2);
            inside.push(interval.low <= truth && truth <= interval.high);
        }
        Ok(inside)
    }

    fn summary(&self, plan: &CoveragePlan, runs: &[Option<Repetition>]) -> Result<CoverageReport> {
        let good: Vec<&Repetition> = runs.iter().flatten().collect();
        if good.len() < 2 {
            return Err(Error::Numerical(
                "coverage: fewer than two repetitions have an onset".into(),
            ));
        }
        let count = good.len() as f64;
        let mean = |f: &dyn Fn(&Repetition) -> f64| good.iter().map(|r| f(r)).sum::<f64>() / count;
        let onset = |r: &Repetition| r.error.speed_m_s;
        let average = mean(&onset);
        let scatter = (mean(&|r| (onset(r) - average).powi(2)) * count / (count - 1.0)).sqrt();
        let variance = mean(&|r| r.error.standard_error_m_s.powi(2));
        let inside =
            |r: &Repetition, target: f64| (onset(r) - target).abs() <= r.error.half_width_m_s();
        let holds = |target: f64| IntervalCoverage::count(good.iter().map(|r| inside(r, target)));
        let mut report = CoverageReport {
            plan: plan.clone(),
            true_onset_m_s: self.true_onset_m_s,
            bias_m_s: self.bias_m_s,
            mean_error_m_s: average - self.true_onset_m_s,
            standard_error_of_mean_m_s: scatter / count.sqrt(),
            scatter_m_s: scatter,
            stated_standard_error_m_s: variance.sqrt(),
            mean_half_width_m_s: mean(&|r| r.error.half_width_m_s()),
            mean_degrees_of_freedom: mean(&|r| r.error.degrees_of_freedom),
            observed_degrees_of_freedom: 2.0 * variance * variance
                / (mean(&|r| r.error.standard_error_m_s.powi(4)) - variance * variance),
            holds_truth: holds(self.true_onset_m_s),
            holds_fit_without_noise: holds(self.true_onset_m_s + self.bias_m_s),
            derivatives_hold_truth: IntervalCoverage::count(
                good.iter()
                    .flat_map(|r| r.derivatives_inside.iter().copied()),
            ),
            speeds_differ: IntervalCoverage::count(good.iter().map(|r| r.speeds_differ)),
            without_onset: runs.len() - good.len(),
            warnings: Vec::new(),
        };
        report.judge();
        Ok(report)
    }
}
