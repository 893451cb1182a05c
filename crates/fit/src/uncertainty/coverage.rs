//! Are the intervals reliable? Virtual campaigns whose truth is known, fitted many times over.

mod plan;
mod report;

pub use plan::{CoveragePlan, Truth};
pub use report::{CoverageReport, IntervalCoverage};

use super::coefficients::{CoefficientUncertainty, spread_over};
use super::model::derivative_intervals;
use super::onset::{OnsetError, onset_error, speed_and_omega};
use super::record_covariance::record_uncertainty;
use crate::aerodynamics::{FlatPlate, RationalModel, Transfer, TransferMatrix};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{Onset, OnsetSearch, determinant_onset, find_onset};
use crate::identification::samples::part_of;
use crate::identification::{Fitted, fit_records, sources};
use crate::numbered::{OnDone, numbered};
use crate::section::{Dof, SectionModel, Structure};
use crate::signal::random_stream;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{Record, TunnelPlan};
use nalgebra::Complex;
use rand_distr::{Distribution, StandardNormal};

/// Highest wind speed at which an onset is looked for, m/s.
const SPEED_MAX_M_S: f64 = 80.0;
/// Reduced frequencies at which derivatives are compared.
const DERIVATIVE_POINTS: usize = 8;
/// Stream of the truth's random numbers; the records' noise has the streams from zero.
const STREAM: u64 = 1 << 40;

/// Runs the campaign over and over, each time with noise of its own, in parallel.
///
/// # Errors
/// [`Error::Input`] for impossible plans; [`Error::Numerical`] when no fit or no search gives an onset.
pub fn coverage(plan: &CoveragePlan, progress: OnDone<'_>) -> Result<CoverageReport> {
    let campaign = KnownDeck::new(plan)?;
    let runs = numbered(plan.repetitions, progress, |r| campaign.repeat(r))?;
    campaign.summary(&runs)
}

/// A virtual campaign whose truth is known, and may differ between mean speeds and between runs.
struct KnownDeck<'a> {
    plan: &'a CoveragePlan,
    structure: Structure,
    model: Box<dyn Transfer + Sync>,
    /// Records of the truth itself, without noise.
    straight: Vec<Record>,
    /// The same with every force turned by a right angle: together they make records of transfer functions of other size and phase. None
    /// where nothing scatters.
    turned: Vec<Record>,
    tested: ReducedFrequencyRange,
    true_onset_m_s: f64,
    bias_m_s: f64,
}

/// `i G(K)`.
struct QuarterTurned<'a>(&'a dyn Transfer);

impl Transfer for QuarterTurned<'_> {
    fn dofs(&self) -> &[Dof] {
        self.0.dofs()
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        Ok(self.0.transfer(k)? * Complex::i())
    }
}

/// One repetition.
struct Repetition {
    error: OnsetError,
    derivatives_inside: Vec<bool>,
    speeds_differ: bool,
}

impl<'a> KnownDeck<'a> {
    fn new(plan: &'a CoveragePlan) -> Result<Self> {
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
        let [low, high] = [0.02, 10.0].map(ReducedFrequency::from_full_width);
        let records = |m: &dyn Transfer| quiet.records_from_model(m, "truth", section.width_m);
        let mut campaign = Self {
            plan,
            structure: section.structure()?,
            straight: records(model.as_ref())?,
            turned: match plan.speed_scatter > 0.0 || plan.run_scatter > 0.0 {
                true => records(&QuarterTurned(model.as_ref()))?,
                false => Vec::new(),
            },
            model,
            tested: ReducedFrequencyRange::between(low, high),
            true_onset_m_s: 0.0,
            bias_m_s: 0.0,
        };
        let found = determinant_onset(
            "truth",
            &campaign.structure,
            campaign.model.as_ref(),
            campaign.tested,
            SPEED_MAX_M_S,
        )?;
        let none = |what: &str| Error::Numerical(format!("coverage: {what}"));
        let truth = found.onset();
        let truth = truth.ok_or_else(|| none("the truth does not flutter"))?;
        campaign.true_onset_m_s = truth.at.speed_m_s;
        let (_, onset, tested) = campaign.fitted(&campaign.straight)?;
        campaign.tested = tested;
        let onset = onset.ok_or_else(|| none("the fit without noise is stable"))?;
        campaign.bias_m_s = onset.at.speed_m_s - campaign.true_onset_m_s;
        Ok(campaign)
    }

    /// Fit, its uncertainty, its onset and its tested range.
    fn fitted(
        &self,
        records: &[Record],
    ) -> Result<(CoefficientUncertainty, Option<Onset>, ReducedFrequencyRange)> {
        let sources = sources(records);
        let fit = self.plan.time_fit();
        let Fitted { model, report } = fit_records(&sources, &fit, &|_, _| ())?;
        let estimate = record_uncertainty(&sources, &fit, &report, None, &|_, _| ())?;
        let section = CoupledSection::with_model(&self.structure, &model)?;
        let search = OnsetSearch::up_to(SPEED_MAX_M_S);
        let found = find_onset("", &section, &search, Some(report.tested_range))?;
        Ok((estimate, found.onset().cloned(), report.tested_range))
    }

    /// Records of one campaign, still without noise.
    fn scattered(&self, seed: u64) -> Vec<Record> {
        let mut records = self.straight.clone();
        let mut random = random_stream(seed, STREAM);
        let mut factor = |deviation: f64| {
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            Complex::new(deviation * normal(), deviation * normal())
        };
        for (record, turned) in records.iter_mut().zip(&self.turned) {
            let run = factor(self.plan.run_scatter);
            for (force, turned) in record.force.iter_mut().zip(&turned.force) {
                // one motion per record: each force of a record is a transfer function of its own at that speed
                let change = factor(self.plan.speed_scatter) + run;
                for (f, t) in force.iter_mut().zip(turned) {
                    *f += change.re * *f + change.im * t;
                }
            }
        }
        records
    }

    fn repeat(&self, repetition: usize) -> Result<Option<Repetition>> {
        let seed = self.plan.tunnel.seed.wrapping_add(repetition as u64);
        let mut records = self.scattered(seed);
        let plan = TunnelPlan {
            seed,
            ..self.plan.tunnel.clone()
        };
        for (index, record) in records.iter_mut().enumerate() {
            plan.add_noise(record, index);
        }
        let (estimate, onset, _) = self.fitted(&records)?;
        let Some(onset) = onset else {
            return Ok(None);
        };
        let ratio = estimate.speeds.as_ref().and_then(|s| s.ratio);
        Ok(Some(Repetition {
            error: onset_error(&estimate, &self.structure, speed_and_omega(&onset), None)?,
            derivatives_inside: self.derivatives(&estimate)?,
            speeds_differ: ratio.is_some_and(|r| r > 1.0),
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

    fn summary(&self, runs: &[Option<Repetition>]) -> Result<CoverageReport> {
        let good: Vec<&Repetition> = runs.iter().flatten().collect();
        if good.len() < 2 {
            let what = "coverage: fewer than two repetitions have an onset";
            return Err(Error::Numerical(what.into()));
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
        let derivatives = good.iter().flat_map(|r| &r.derivatives_inside).copied();
        let mut report = CoverageReport {
            plan: self.plan.clone(),
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
            derivatives_hold_truth: IntervalCoverage::count(derivatives),
            speeds_differ: IntervalCoverage::count(good.iter().map(|r| r.speeds_differ)),
            without_onset: runs.len() - good.len(),
            warnings: Vec::new(),
        };
        report.judge();
        Ok(report)
    }
}
