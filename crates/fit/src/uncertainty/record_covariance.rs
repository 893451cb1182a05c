//! Uncertainty of models fitted to records: blocks are the segments.

use super::coefficients::CoefficientUncertainty;
use super::columns::Expansion;
use super::parameters::{
    Coordinates, FreePoles, Parameter, coordinates_of, free_poles, held_sentence, parameters_of,
    tangent_of,
};
use super::segments::{StretchRows, Stretched, gather, sandwich};
use crate::aerodynamics::DiscreteLaguerre;
use crate::error::{Error, Result};
use crate::identification::DiscreteFit;
use crate::identification::discrete::discrete_pass;
use crate::identification::form::Form;
use crate::identification::options::TimeFit;
use crate::identification::own::StaticTerm;
use crate::identification::report::FitReport;
use crate::identification::time::continuous::{RecordFit, Rows, padded};
use crate::identification::time::pass::{ColumnOrder, OnProgress, Stretch};
use crate::identification::time::record::{DimensionlessRecord, Records};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::wind_tunnel::RecordSource;
use nalgebra::{DMatrix, DVector};

/// Stretches into which a segment is cut: long against the memory of turbulence, and enough of them for narrow intervals.
const STRETCHES: usize = 4;

/// Covariance of the coefficients of a continuous model that [`crate::identification::fit_records`] fitted to the same
/// records with the same options, from one more pass over them.
///
/// # Errors
/// [`Error::Input`] naming a record that cannot be read; [`Error::Numerical`] when there are too few segments to judge
/// the scatter.
pub fn record_uncertainty(
    records: &[&dyn RecordSource],
    fit: &TimeFit,
    report: &FitReport,
    progress: OnProgress<'_>,
) -> Result<CoefficientUncertainty> {
    let records = Records::read(records, fit.static_term)?;
    let together = report.search.iter().any(|s| s.entry.is_none());
    if fit.static_term == StaticTerm::Estimated || (together && !fit.own.is_empty()) {
        return Err(Error::Numerical(
            "covariance: not known for a constant estimated along, nor where some transfer functions share a searched \
             pole and others have their own"
                .into(),
        ));
    }
    let task = RecordFit {
        fit,
        records: &records,
        progress,
    };
    let form = report.form_fitted(&fit.form, &fit.own);
    let poles = free_poles(&form, &fit.poles, report);
    let (parameters, first) = parameters_of(report, &poles);
    let entries = Entries::new(&form, first, parameters.len(), report, &poles)?;
    let rows = Rows {
        orthonormal: true,
        thinned: false,
        stretches: STRETCHES,
    };
    let closed = task.pass(&entries.candidates(), rows, 1, 1)?.stretches;
    let (design, blocks) = sandwich(
        entries.blocks(&records.each, &closed)?,
        entries.tangent.clone(),
    )?;
    let searched = poles.sentence() + &held_sentence(report);
    CoefficientUncertainty::new(
        format!("{blocks}; motions are exact; {searched}"),
        Some(report.tested_range),
        records.dofs,
        coordinates_of(&form, report, poles.searched),
        parameters,
        design,
    )
}

/// Transfer functions with their columns in the chains of the pass.
struct Entries {
    inputs: usize,
    expansions: Vec<Expansion>,
    values: Vec<Vec<f64>>,
    /// Slopes with respect to the searched poles, E×(number of searched poles).
    slopes: Vec<DMatrix<f64>>,
    /// First parameter of each entry.
    first: Vec<usize>,
    parameters: usize,
    /// Whether all entries share one chain.
    shared: bool,
    /// What active constraints leave free.
    tangent: Option<DMatrix<f64>>,
}

impl Entries {
    fn new(
        form: &Form,
        first: Vec<usize>,
        parameters: usize,
        report: &FitReport,
        poles: &FreePoles,
    ) -> Result<Self> {
        let inputs = report.entries.len().isqrt();
        let searched = !poles.searched.is_empty();
        let mut entries = Self {
            inputs,
            expansions: Vec::new(),
            values: Vec::new(),
            slopes: Vec::new(),
            tangent: tangent_of(report, form, poles, &first, parameters)?,
            first,
            parameters,
            shared: report.entries.windows(2).all(|w| w[0].poles == w[1].poles),
        };
        for (e, entry) in report.entries.iter().enumerate() {
            let expansion = Expansion::new(form, &entry.poles, searched)?;
            let values: Vec<f64> = entry.coefficients.iter().map(|c| c.value).collect();
            let (i, j, searched) = (e / inputs, e % inputs, &poles.searched);
            let slopes = expansion.slopes(form, &entry.poles, &values, i, j, searched)?;
            entries.expansions.push(expansion);
            entries.values.push(values);
            entries.slopes.push(slopes);
        }
        Ok(entries)
    }

    /// Chains of the pass, for all inputs: one, or one an entry.
    fn candidates(&self) -> Vec<Vec<Vec<f64>>> {
        let count = if self.shared {
            1
        } else {
            self.expansions.len()
        };
        let chains = self.expansions.iter().map(|e| &e.extended).take(count);
        let longest = chains.clone().map(Vec::len).max().unwrap_or(0);
        chains
            .map(|c| vec![padded(c, longest); self.inputs])
            .collect()
    }

    fn blocks(&self, records: &[DimensionlessRecord], closed: &[Stretch]) -> Result<Stretched> {
        let mut parts = Vec::new();
        for stretch in closed.iter().filter(|c| !c.set.is_empty()) {
            if !self.shared && stretch.set.len() > 1 {
                return Err(Error::Numerical(
                    "covariance: poles per transfer function need records of single motions".into(),
                ));
            }
            for i in 0..self.inputs {
                let (rows, residual, total) = self.part(stretch, i)?;
                parts.push(StretchRows {
                    record: stretch.record,
                    stretch: stretch.stretch,
                    segment: stretch.segment,
                    group: (stretch.set.clone(), i),
                    weight: stretch.weights[i],
                    rows,
                    residual,
                    total,
                });
            }
        }
        Ok(gather(records, parts))
    }

    /// Weighted rows, residuals and sum of squares of force `i` in one stretch.
    fn part(&self, stretch: &Stretch, i: usize) -> Result<(DMatrix<f64>, DVector<f64>, f64)> {
        let moving = stretch.set.len();
        let which = if self.shared {
            0
        } else {
            i * self.inputs + stretch.set[0]
        };
        let factor = &stretch.factors[which];
        let weight = stretch.weights[i];
        let mut columns = DMatrix::zeros(factor.columns(), self.parameters);
        let mut fitted = DVector::zeros(factor.columns());
        for (s, &j) in stretch.set.iter().enumerate() {
            let e = i * self.inputs + j;
            let (native, slopes) = (&self.expansions[e].native, &self.slopes[e]);
            for c in 0..native.nrows() {
                let row = c * moving + s;
                for a in 0..native.ncols() {
                    columns[(row, self.first[e] + a)] = native[(c, a)];
                    fitted[row] += native[(c, a)] * self.values[e][a];
                }
                for m in 0..slopes.ncols() {
                    columns[(row, self.parameters - slopes.ncols() + m)] = slopes[(c, m)];
                }
            }
        }
        let rows = factor.upper() * columns * weight;
        let residual = (factor.projected().column(i) - factor.upper() * fitted) * weight;
        Ok((rows, residual, factor.total_sum(i) * weight * weight))
    }
}

/// Covariance of the coefficients of the discrete model that [`crate::identification::fit_discrete`] fitted to the same
/// records with the same options, from one more pass over them.
pub fn discrete_uncertainty(
    records: &[&dyn RecordSource],
    fit: &DiscreteFit,
    model: &Model,
    progress: OnProgress<'_>,
) -> Result<CoefficientUncertainty> {
    let Model::DiscreteLaguerre(model) = model else {
        return Err(Error::input(
            "model",
            "a discrete Laguerre model",
            model.kind(),
        ));
    };
    let Some((alpha, filters)) = model
        .shared_parameters()
        .filter(|_| fit.static_term == StaticTerm::Estimated)
    else {
        return Err(Error::Numerical(
            "covariance: known for discrete models whose filters are shared and whose constant was estimated along".into(),
        ));
    };
    let records = Records::read(records, fit.static_term)?;
    let inputs = records.dofs.len();
    let order = ColumnOrder {
        inputs,
        per_input: filters,
        constant: true,
    };
    let closed = discrete_pass(
        &records,
        order,
        &[vec![alpha; inputs]],
        fit.weights,
        STRETCHES,
        progress,
    )?
    .stretches;
    let parameters = discrete_parameters(order, model, &records.dofs);
    let values = DVector::from_iterator(parameters.len(), parameters.iter().map(|p| p.value));
    let parts = closed
        .iter()
        .flat_map(|stretch| (0..inputs).map(move |i| (stretch, i)))
        .map(|(stretch, i)| discrete_rows(order, stretch, i, &values))
        .collect();
    let (design, blocks) = sandwich(gather(&records.each, parts), None)?;
    CoefficientUncertainty::new(
        format!("{blocks}; motions are exact; α is given"),
        Some(records.tested_range()?),
        records.dofs.clone(),
        Coordinates::Discrete {
            alpha,
            delta_s: model.delta_s,
            filters,
        },
        parameters,
        design,
    )
}

/// The parameters of a discrete model, force by force: its constant, then the filters of every input.
fn discrete_parameters(
    order: ColumnOrder,
    model: &DiscreteLaguerre,
    dofs: &[Dof],
) -> Vec<Parameter> {
    let mut parameters = Vec::with_capacity(order.inputs * order.width(order.inputs));
    for (i, &force) in dofs.iter().enumerate() {
        let mut push = |name: String, motion, value| {
            parameters.push(Parameter {
                name,
                force: Some(force),
                motion,
                value,
                standard_error: 0.0,
            });
        };
        push("static".into(), None, model.static_term[i]);
        for (term, &motion) in model.terms.iter().zip(dofs) {
            for l in 0..order.per_input {
                push(format!("c{l}"), Some(motion), term.coefficients[(i, l)]);
            }
        }
    }
    parameters
}

/// Rows of force `i` in one stretch: a constant, then the filters of the inputs that move.
fn discrete_rows(
    order: ColumnOrder,
    stretch: &Stretch,
    i: usize,
    values: &DVector<f64>,
) -> StretchRows {
    let factor = &stretch.factors[0];
    let weight = stretch.weights[i];
    let first = i * order.width(order.inputs);
    let mut columns = DMatrix::zeros(factor.columns(), values.len());
    columns[(0, first)] = 1.0;
    for (s, &j) in stretch.set.iter().enumerate() {
        for l in 0..order.per_input {
            let row = 1 + l * stretch.set.len() + s;
            columns[(row, first + 1 + j * order.per_input + l)] = 1.0;
        }
    }
    let fitted = &columns * values;
    StretchRows {
        record: stretch.record,
        stretch: stretch.stretch,
        segment: stretch.segment,
        group: (stretch.set.clone(), i),
        weight,
        rows: factor.upper() * columns * weight,
        residual: (factor.projected().column(i) - factor.upper() * fitted) * weight,
        total: factor.total_sum(i) * weight * weight,
    }
}
