//! The thesis's discrete Laguerre model fitted to records (2.30–2.33, 3.2–3.6).

use super::basis::once_an_input;
use super::form::{PoleSearch, number_of_filters};
use super::least_squares::BLOCK_ROWS;
use super::options::TimeWeights;
use super::own::{OwnDecay, StaticTerm, describe_own, each_once, place_of};
use super::report::{AlphaGuideline, FitReport, Fitted, MemoryReport};
use super::time::fitted::FittedSystems;
use super::time::pass::{Chunk, ColumnOrder, Columns, Pass, PassPlan, pass_over};
use super::time::record::{DimensionlessRecord, Records};
use super::time::systems::ForceSystems;
use crate::aerodynamics::DiscreteLaguerre;
use crate::aerodynamics::laguerre::{
    DiscreteTerm, advance_filters, alpha_lower_bound, discrete_memory,
};
use crate::error::{Result, counted, ensure};
use crate::numbered::OnDone;
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Fit of the thesis's discrete Laguerre model to records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DiscreteFit {
    /// Number of filters `L`.
    pub filters: usize,
    /// Decay factor, `0 < α < 1`.
    pub alpha: f64,
    /// Weighting; the thesis has none.
    pub weights: TimeWeights,
    /// What is done about a constant in the forces.
    pub static_term: StaticTerm,
    /// Transfer functions with a number of filters or a decay factor of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnDecay>,
}

impl Default for DiscreteFit {
    /// The thesis's choice: three filters, α = 0.6; the constant of (2.23) is estimated along.
    fn default() -> Self {
        Self {
            filters: 3,
            alpha: 0.6,
            weights: TimeWeights::None,
            static_term: StaticTerm::Estimated,
            own: Vec::new(),
        }
    }
}

impl DiscreteFit {
    /// Checks every value.
    pub fn validate(&self) -> Result<()> {
        each_once(self.own.iter().map(|o| (o.force, o.motion)))?;
        let own = self.own.iter().map(|o| ("own.", o.filters, o.alpha));
        for (key, filters, alpha) in own.chain([("", Some(self.filters), Some(self.alpha))]) {
            if let Some(filters) = filters {
                number_of_filters(&format!("{key}filters"), filters)?;
            }
            if let Some(a) = alpha {
                let place = format_args!("{key}alpha");
                ensure(a > 0.0 && a < 1.0, place, "0 < alpha < 1", a)?;
            }
        }
        Ok(())
    }

    /// Decay factor and number of filters of every transfer function, row by row.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for degrees of freedom that the records do not have.
    pub(crate) fn parameters(&self, dofs: &[Dof]) -> Result<Vec<(f64, usize)>> {
        let mut all = vec![(self.alpha, self.filters); dofs.len() * dofs.len()];
        for own in &self.own {
            let alpha = own.alpha.unwrap_or(self.alpha);
            let filters = own.filters.unwrap_or(self.filters);
            all[place_of(dofs, own.force, own.motion)?] = (alpha, filters);
        }
        Ok(all)
    }
}

/// Fits the discrete Laguerre model: records of lower speeds are resampled to the longest `Δs = VΔt/B` (3.2), the filters
/// run recursively (2.33), a constant column takes the static term, least squares gives the coefficients: `9L` of them
/// from three motions (3.5), with `α` and `L` of its own for any transfer function.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for impossible options and for records as in [`super::fit_records`].
pub fn fit_discrete(
    records: &[&dyn RecordSource],
    fit: &DiscreteFit,
    progress: OnDone<'_>,
) -> Result<Fitted> {
    fit.validate()?;
    let records = Records::read(records, fit.static_term)?;
    let (dofs, spanned) = (&records.dofs, records.spanned_range()?);
    let delta_s = records.longest_step();
    let parameters = fit.parameters(dofs)?;
    let rows = parameters.chunks(dofs.len());
    let mut alphas: Vec<Vec<f64>> = rows.map(|r| r.iter().map(|(a, _)| *a).collect()).collect();
    // filters that serve all forces are filtered once
    if alphas.iter().all(|row| *row == alphas[0]) {
        alphas.truncate(1);
    }
    let order = ColumnOrder {
        inputs: dofs.len(),
        per_input: parameters.iter().map(|(_, l)| *l).max().unwrap_or(0),
        constant: fit.static_term == StaticTerm::Estimated,
    };
    let pass = discrete_pass(&records, order, &alphas, fit.weights, 0, progress)?;
    let systems = ForceSystems {
        counts: parameters.iter().map(|(_, filters)| *filters).collect(),
        systems: pass.systems(),
    };
    let names = |(_, filters): &(f64, usize)| (0..*filters).map(|l| format!("c{l}")).collect();
    let names = parameters.iter().map(names).collect();
    let chains = vec![Vec::new(); parameters.len()];
    let fitted = FittedSystems::new(dofs, systems, chains, names, 1.0, "the filters")?;
    let model = model(&fitted, dofs, &parameters, delta_s)?;
    let shared = parameters.iter().all(|p| *p == parameters[0]);
    let report = FitReport {
        method: format!(
            "discrete Laguerre as in the thesis, L = {}, α = {}{}, Δs = {delta_s:.6}, fitted to {}",
            fit.filters,
            fit.alpha,
            describe_own(fit.own.len()),
            counted(records.each.len(), "record")
        ),
        weights: fit.weights.describe().into(),
        samples: fitted.systems.whole(0).rows,
        orders: if shared { fitted.orders(0) } else { Vec::new() },
        alpha_guideline: Some(guideline(&parameters, spanned, delta_s, &records)),
        static_terms: [records.removed_means.clone(), fitted.constants()?].concat(),
        memory: memory(&parameters, &records, delta_s)?,
        covariance_assumption: "white residuals, exact motions".into(),
        notes: records.odd_air(),
        ..FitReport::new(records.tested_range()?, fitted.reports()?, Vec::new())
    };
    Ok(Fitted {
        model: Model::DiscreteLaguerre(model),
        report: with_notes(report),
    })
}

/// One pass over the records, resampled to one step, with the filters (2.33) of the given decay factors, one for each
/// input of each candidate; `stretches` as in [`PassPlan`].
pub(crate) fn discrete_pass(
    records: &Records,
    order: ColumnOrder,
    alphas: &[Vec<f64>],
    weights: TimeWeights,
    stretches: usize,
    progress: OnDone<'_>,
) -> Result<Pass> {
    let plan = PassPlan {
        order,
        weights,
        delta_s: Some(records.longest_step()),
        discard_s: 0.0,
        stride: 1,
        stretches,
        number: (1, 1),
    };
    pass_over(&records.each, &plan, progress, |_| {
        Ok(DiscreteColumns::new(alphas, order))
    })
}

/// Columns of the discrete model by the recursion (2.33); a candidate is a decay factor for each input.
struct DiscreteColumns<'a> {
    /// One per candidate and input.
    alphas: &'a [Vec<f64>],
    filters: usize,
    /// The constant, if there is one.
    ones: Option<Vec<f64>>,
    /// Filter states at the last sample, one vector per candidate and input.
    states: Vec<Vec<Vec<f64>>>,
    /// Filter columns of the candidate asked for last, one stretch of [`BLOCK_ROWS`] per filter, one vector per input.
    columns: Vec<Vec<f64>>,
}

impl<'a> DiscreteColumns<'a> {
    fn new(alphas: &'a [Vec<f64>], order: ColumnOrder) -> Self {
        let (inputs, filters) = (order.inputs, order.per_input);
        Self {
            alphas,
            filters,
            ones: order.constant.then(|| vec![1.0; BLOCK_ROWS]),
            states: vec![vec![vec![0.0; filters]; inputs]; alphas.len()],
            columns: vec![vec![0.0; filters * BLOCK_ROWS]; inputs],
        }
    }
}

impl Columns for DiscreteColumns<'_> {
    fn candidates(&self) -> usize {
        self.alphas.len()
    }

    fn advance(&mut self, _: &Chunk<'_>, _: &[usize]) {}

    fn columns<'a>(
        &'a mut self,
        chunk: &Chunk<'a>,
        candidate: usize,
        active: &[usize],
    ) -> Vec<&'a [f64]> {
        for &j in active {
            let state = &mut self.states[candidate][j];
            let (alpha, columns) = (self.alphas[candidate][j], &mut self.columns[j]);
            advance_filters(alpha, state, chunk.motion[j], columns, BLOCK_ROWS);
        }
        let rows = chunk.rows();
        let mut columns: Vec<&[f64]> = Vec::new();
        columns.extend(self.ones.as_ref().map(|ones| &ones[..rows]));
        for l in 0..self.filters {
            let stretch = l * BLOCK_ROWS..l * BLOCK_ROWS + rows;
            columns.extend(active.iter().map(|&j| &self.columns[j][stretch.clone()]));
        }
        columns.extend(&chunk.force);
        columns
    }
}

/// One chain per motion for all forces that share its parameters (`α` and `L` of every transfer function, row by row).
fn model(
    fitted: &FittedSystems<'_>,
    dofs: &[Dof],
    parameters: &[(f64, usize)],
    delta_s: f64,
) -> Result<DiscreteLaguerre> {
    let n = dofs.len();
    let term = |(input, own): (usize, &(f64, usize))| {
        let mut coefficients = DMatrix::zeros(n, own.1);
        for row in (0..n).filter(|row| parameters[row * n + input] == *own) {
            let values = DVector::from_vec(fitted.values(row, input));
            coefficients.set_row(row, &values.transpose());
        }
        DiscreteTerm {
            input,
            alpha: own.0,
            coefficients,
        }
    };
    let terms = once_an_input(n, parameters).into_iter().map(term);
    let constants = (0..n).map(|i| fitted.constant(i).unwrap_or(0.0));
    let model = DiscreteLaguerre {
        dofs: dofs.to_vec(),
        delta_s,
        terms: terms.collect(),
        static_term: constants.collect(),
    };
    model.validate()?;
    Ok(model)
}

/// Memory of the slowest chain against the rest before the motion, at the step of the model.
fn memory(
    parameters: &[(f64, usize)],
    records: &Records,
    delta_s: f64,
) -> Result<Vec<MemoryReport>> {
    let memories = parameters.iter().map(|(a, l)| discrete_memory(*a, *l));
    let longest = memories.max().unwrap_or(0);
    let memory_of = |record: &DimensionlessRecord| {
        let resampled = record.at_step(Some(delta_s))?.0;
        let signals = resampled.as_ref().unwrap_or(&record.signals);
        Ok(MemoryReport {
            record: record.header.name.to_owned(),
            memory_samples: longest,
            available_samples: signals.still_samples()?,
            step_s: delta_s / record.rate,
        })
    };
    records.each.iter().map(memory_of).collect()
}

/// (2.36) at the highest reduced frequency: `f_max/f_s = K Δs/2π`, whatever the speed; for the smallest `α` in use.
fn guideline(
    parameters: &[(f64, usize)],
    tested: ReducedFrequencyRange,
    delta_s: f64,
    records: &Records,
) -> AlphaGuideline {
    let rate = records.each.iter().map(|r| r.rate).fold(0.0, f64::max);
    let sampling_hz = rate / delta_s;
    let highest_frequency_hz = tested.max.full_width() * rate / TAU;
    AlphaGuideline {
        alpha: parameters.iter().map(|(a, _)| *a).fold(1.0, f64::min),
        lower_bound: alpha_lower_bound(highest_frequency_hz, sampling_hz),
        highest_frequency_hz,
        sampling_hz,
    }
}

/// What is known to be biased in every such fit.
const BIAS: &str = "bias of this formulation: without feed-through the lift due to vertical motion is poorly fitted at low K, and in the \
                    coupled section the force is held over each step Δt = Δs·B/V, a delay of half a step; on the flat plate of Table \
                    4.1 three filters put the onset 4.5 % below the exact one";

fn with_notes(mut report: FitReport) -> FitReport {
    report.notes.push(BIAS.to_owned());
    if let Some(g) = &report.alpha_guideline
        && g.alpha < g.lower_bound
    {
        report.notes.push(format!(
            "α = {} is below the guideline (2.36), {:.4} for {:.2} Hz sampled at {:.0} Hz",
            g.alpha, g.lower_bound, g.highest_frequency_hz, g.sampling_hz
        ));
    }
    report.judge(&PoleSearch::default());
    report
}

#[cfg(test)]
mod tests;
