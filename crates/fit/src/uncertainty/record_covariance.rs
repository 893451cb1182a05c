//! Uncertainty of models fitted to records: blocks are the segments.

use super::coefficients::CoefficientUncertainty;
use super::columns::Expansion;
use super::design::Block;
use super::parameters::{Coordinates, FitParameters, Parameter, constraint_sentence};
use super::segments::{StretchRows, sandwich};
use crate::aerodynamics::DiscreteLaguerre;
use crate::error::{Error, Result};
use crate::identification::basis::Basis;
use crate::identification::discrete::discrete_pass;
use crate::identification::form::Form;
use crate::identification::options::TimeFit;
use crate::identification::own::StaticTerm;
use crate::identification::report::FitReport;
use crate::identification::time::continuous::{RecordFit, padded};
use crate::identification::time::pass::{ColumnOrder, Stretch};
use crate::identification::time::record::{DimensionlessRecord, Records};
use crate::identification::{DiscreteFit, EntryReport};
use crate::numbered::OnDone;
use crate::trained_model::Model;
use crate::wind_tunnel::RecordSource;
use nalgebra::{DMatrix, DVector};

/// Stretches into which a segment is cut: long against the memory of turbulence, and enough of them for narrow intervals.
const STRETCHES: usize = 4;

/// Covariance of the coefficients of a continuous model that [`crate::identification::fit_records`] fitted to the same
/// records with the same options, from one more pass over them. What an embedded measured `deck` says of the scatter between mean speeds
/// is left out, for it is no witness of its own.
///
/// # Errors
/// [`Error::Input`] naming a record that cannot be read; [`Error::Numerical`] when there are too few segments to judge
/// the scatter.
pub fn record_uncertainty(
    records: &[&dyn RecordSource],
    fit: &TimeFit,
    report: &FitReport,
    deck: Option<&str>,
    progress: OnDone<'_>,
) -> Result<CoefficientUncertainty> {
    let records = Records::read(records, fit.static_term)?;
    if fit.static_term == StaticTerm::Estimated {
        let what = "covariance: not known for a constant estimated along";
        return Err(Error::Numerical(what.into()));
    }
    let task = RecordFit {
        fit,
        records: &records,
        progress,
    };
    let parameters = FitParameters::new(&fit.form, &fit.poles, &fit.own, report);
    let entries = Entries::new(report, &parameters)?;
    let bases = entries.bases(&fit.form)?;
    let closed = task.pass(&bases, 1, STRETCHES, 1, 1)?.stretches;
    let tangent = parameters.tangent(report)?;
    let (design, blocks) = sandwich(entries.rows(&records.each, &closed)?, tangent)?;
    let searched = parameters.sentence() + &constraint_sentence(report);
    CoefficientUncertainty::new(
        format!("{blocks}; motions are exact; {searched}"),
        Some(report.tested_range),
        deck,
        records.dofs,
        parameters.coordinates(report),
        parameters.all,
        design,
    )
}

/// Transfer functions with their columns in the chains of the pass.
struct Entries {
    inputs: usize,
    /// Each in its chain, of one length where they share it.
    each: Vec<Expansion>,
    values: Vec<Vec<f64>>,
    /// First parameter of each entry.
    first: Vec<usize>,
    /// Parameter and value of the constant of each force; none where none was estimated along.
    constants: Vec<(usize, f64)>,
    parameters: usize,
    /// Whether all entries share one chain.
    shared: bool,
}

impl Entries {
    fn new(report: &FitReport, parameters: &FitParameters) -> Result<Self> {
        let entries = report.entries.iter();
        let chains: Vec<Vec<f64>> = entries.clone().map(|e| e.poles.clone()).collect();
        let values: Vec<Vec<f64>> = entries.map(EntryReport::values).collect();
        let (form, searched) = (&parameters.form, &parameters.searched);
        Ok(Self {
            inputs: chains.len().isqrt(),
            each: Expansion::each(form, &chains, &values.concat(), searched)?,
            values,
            first: parameters.first.clone(),
            constants: Vec::new(),
            parameters: parameters.all.len(),
            shared: chains.windows(2).all(|w| w[0] == w[1]),
        })
    }

    /// Those of a discrete model, whose columns are the filters themselves, and its parameters: of each force its constant, then
    /// the filters of every input.
    fn discrete(model: &DiscreteLaguerre, filters: usize) -> (Self, Vec<Parameter>) {
        let inputs = model.dofs.len();
        let (mut parameters, mut first, mut constants) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &force) in model.dofs.iter().enumerate() {
            let parameter =
                |name: String, motion, value| Parameter::new(name, Some(force), motion, value);
            constants.push((parameters.len(), model.static_term[i]));
            parameters.push(parameter("static".into(), None, model.static_term[i]));
            for (term, &motion) in model.terms.iter().zip(&model.dofs) {
                first.push(parameters.len());
                let coefficients = term.coefficients.row(i);
                let named = coefficients.iter().enumerate();
                parameters.extend(named.map(|(l, c)| parameter(format!("c{l}"), Some(motion), *c)));
            }
        }
        let of_entry = |&at: &usize| parameters[at..at + filters].iter().map(|p| p.value);
        let columns = Expansion {
            extended: Vec::new(),
            native: DMatrix::identity(filters, filters),
            slopes: DMatrix::zeros(filters, 0),
        };
        let entries = Self {
            inputs,
            each: vec![columns; first.len()],
            values: first.iter().map(|at| of_entry(at).collect()).collect(),
            first,
            constants,
            parameters: parameters.len(),
            shared: true,
        };
        (entries, parameters)
    }

    /// Bases of the pass, for all inputs: one, or one an entry.
    fn bases(&self, form: &Form) -> Result<Vec<Vec<Basis>>> {
        let count = if self.shared { 1 } else { self.each.len() };
        let chains = self.each.iter().take(count).map(|e| &e.extended);
        let longest = chains.clone().map(Vec::len).max().unwrap_or(0);
        let of_inputs = |chain: &Vec<f64>| {
            let basis = Basis::orthonormal(form, &padded(chain, longest))?;
            Ok(vec![basis; self.inputs])
        };
        chains.map(of_inputs).collect()
    }

    /// Rows of every force in every stretch that tells something.
    fn rows<'a>(
        &self,
        records: &'a [DimensionlessRecord],
        closed: &'a [Stretch],
    ) -> Result<Vec<StretchRows<'a>>> {
        let mut parts = Vec::new();
        // a stretch at rest tells of the constants alone
        let tells = |c: &&Stretch| !(c.set.is_empty() && self.constants.is_empty());
        for stretch in closed.iter().filter(tells) {
            if !self.shared && stretch.set.len() > 1 {
                let what = "covariance: poles per transfer function need records of single motions";
                return Err(Error::Numerical(what.into()));
            }
            let record = &records[stretch.record];
            parts.extend((0..self.inputs).map(|i| self.part(record, stretch, i)));
        }
        Ok(parts)
    }

    /// Rows of force `i` in one stretch.
    fn part<'a>(
        &self,
        record: &'a DimensionlessRecord,
        stretch: &'a Stretch,
        i: usize,
    ) -> StretchRows<'a> {
        let moving = stretch.set.len();
        let which = match self.shared {
            true => 0,
            false => i * self.inputs + stretch.set[0],
        };
        let factor = &stretch.factors[which];
        let weight = stretch.weights[i];
        let mut columns = DMatrix::zeros(factor.columns(), self.parameters);
        let mut fitted = DVector::zeros(factor.columns());
        let constant = self.constants.get(i);
        if let Some((at, value)) = constant {
            columns[(0, *at)] = 1.0;
            fitted[0] = *value;
        }
        for (s, &j) in stretch.set.iter().enumerate() {
            let e = i * self.inputs + j;
            let Expansion { native, slopes, .. } = &self.each[e];
            for c in 0..native.nrows() {
                let row = usize::from(constant.is_some()) + c * moving + s;
                for a in 0..native.ncols() {
                    columns[(row, self.first[e] + a)] = native[(c, a)];
                    fitted[row] += native[(c, a)] * self.values[e][a];
                }
                for m in 0..slopes.ncols() {
                    columns[(row, self.parameters - slopes.ncols() + m)] = slopes[(c, m)];
                }
            }
        }
        StretchRows {
            of: stretch,
            name: &record.header.name,
            rate: record.rate,
            force: i,
            block: Block {
                name: String::new(),
                speed_m_s: None,
                k: None,
                rows: &factor.r * columns * weight,
                residual: (factor.qtb.column(i) - &factor.r * fitted) * weight,
                variance: DVector::zeros(factor.columns()),
            },
            total: factor.total_sum(i) * weight * weight,
        }
    }
}

/// Covariance of the coefficients of the discrete model that [`crate::identification::fit_discrete`] fitted to the same
/// records with the same options, from one more pass over them; `deck` as of [`record_uncertainty`].
pub fn discrete_uncertainty(
    records: &[&dyn RecordSource],
    fit: &DiscreteFit,
    model: &Model,
    deck: Option<&str>,
    progress: OnDone<'_>,
) -> Result<CoefficientUncertainty> {
    let Model::DiscreteLaguerre(model) = model else {
        let expected = "a discrete Laguerre model";
        return Err(Error::input("model", expected, model.kind()));
    };
    let estimated = fit.static_term == StaticTerm::Estimated;
    let shared = model.shared_parameters().filter(|_| estimated);
    let Some((alpha, filters)) = shared else {
        let what = "covariance: known for discrete models whose filters are shared and whose constant was estimated along";
        return Err(Error::Numerical(what.into()));
    };
    let records = Records::read(records, fit.static_term)?;
    let inputs = records.dofs.len();
    let order = ColumnOrder {
        inputs,
        per_input: filters,
        constant: true,
    };
    let alphas = [vec![alpha; inputs]];
    let pass = discrete_pass(&records, order, &alphas, fit.weights, STRETCHES, progress)?;
    let (entries, parameters) = Entries::discrete(model, filters);
    let free = DMatrix::identity(parameters.len(), parameters.len());
    let (design, blocks) = sandwich(entries.rows(&records.each, &pass.stretches)?, free)?;
    CoefficientUncertainty::new(
        format!("{blocks}; motions are exact; α is given"),
        Some(records.tested_range()?),
        deck,
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
