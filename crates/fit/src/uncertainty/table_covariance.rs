//! Uncertainty of models fitted to a table: blocks are its test runs.

use super::coefficients::CoefficientUncertainty;
use super::design::{Block, Design};
use super::parameters::{FitParameters, STEP, constraint_sentence, moved_pole};
use crate::aerodynamics::derivatives::TransferSample;
use crate::error::{Error, Result};
use crate::identification::EntryReport;
use crate::identification::basis::Basis;
use crate::identification::form::Form;
use crate::identification::options::FrequencyFit;
use crate::identification::report::FitReport;
use crate::identification::samples::{EntrySample, EntrySamples, sort_by_entry, unit_scale};
use crate::section::Dof;
use nalgebra::{Complex, DMatrix, DVector};

/// Samples of one motion belong to one test run when `K` and speed agree within this fraction.
const SAME_RUN: f64 = 0.03;

/// Covariance of the coefficients of a model that [`crate::identification::fit_table`] fitted to the same samples with
/// the same options; `deck` as of [`super::record_uncertainty`].
///
/// A table states no errors: the scatter of its points around the fit stands for them, so that measuring errors and
/// what the form cannot follow are counted together.
///
/// # Errors
/// [`Error::Numerical`] when there are too few test runs to judge the scatter, and for fits that are not plain least
/// squares in their coefficients: limits, a ridge, weights of entries, lags of each force, minimum state.
pub fn table_uncertainty(
    samples: &[TransferSample],
    dofs: &[Dof],
    fit: &FrequencyFit,
    report: &FitReport,
    deck: Option<&str>,
) -> Result<CoefficientUncertainty> {
    if !fit.is_plain() {
        let what = "covariance over test runs: not available for limits, regularisation, weights of entries, lags of each force and the \
                    minimum-state form";
        return Err(Error::Numerical(what.into()));
    }
    let (entries, _) = sort_by_entry(samples, dofs, fit.weights)?;
    let parameters = FitParameters::new(&fit.form, &fit.poles, &fit.own, report);
    let count = parameters.all.len();
    let first_pole = count - parameters.searched.len();
    // rows of one motion at one frequency and speed
    let mut runs: Vec<(Dof, Vec<Block>)> = Vec::new();
    for (e, entry) in entries.iter().enumerate() {
        let (i, j) = (e / dofs.len(), e % dofs.len());
        let searched = parameters.searched.iter().zip(first_pole..);
        let searched = searched.filter(|(pole, _)| pole.is_of(i, j));
        let searched: Vec<_> = searched.map(|(pole, at)| (at, pole.index)).collect();
        let (report, first) = (&report.entries[e], parameters.first[e]);
        let mut rows = vec![vec![0.0; count]; entry.rows.len()];
        let (residuals, variance) =
            rows_of(entry, report, &parameters.form, &searched, first, &mut rows)?;
        for ((sample, line), residual) in entry.rows.iter().zip(rows).zip(residuals) {
            let row = Block {
                name: String::new(),
                speed_m_s: sample.mean_speed_m_s,
                k: Some(sample.k),
                rows: DMatrix::from_row_slice(1, count, &line),
                residual: DVector::from_element(1, residual),
                variance: DVector::from_element(1, variance),
            };
            let own = |(motion, run): &&mut (Dof, Vec<Block>)| {
                *motion == entry.motion && of_one_run(&run[0], &row)
            };
            match runs.iter_mut().find(own) {
                Some((_, run)) => run.push(row),
                None => runs.push((entry.motion, vec![row])),
            }
        }
    }
    let tangent = parameters.tangent(report)?;
    let block = |(motion, rows): &(Dof, Vec<Block>)| {
        let k = rows[0].k.unwrap_or_default();
        let speed = rows[0].speed_m_s.map(|v| format!(", {v:.2} m/s"));
        let speed = speed.unwrap_or_default();
        Block::joined(format!("{} motion, K = {k:.3}{speed}", motion.name()), rows)
    };
    let blocks = runs.iter().map(block).collect();
    let searched = parameters.sentence() + &constraint_sentence(report);
    CoefficientUncertainty::new(
        format!(
            "the table states no errors: the scatter of its points around the fit stands for measuring errors and lack of \
             fit together; correlated in any way within a test run (one motion, frequency and speed), independent \
             from run to run; sandwich of the runs with the small-sample correction CR2; {searched}"
        ),
        Some(report.tested_range),
        deck,
        dofs.to_vec(),
        parameters.coordinates(report),
        parameters.all,
        Design::new(blocks, tangent)?,
    )
}

/// Whether rows of one motion are of one test run: frequency and, where it is known, speed are the same.
fn of_one_run(a: &Block, b: &Block) -> bool {
    let near = |a: f64, b: f64| (a / b).ln().abs() < SAME_RUN;
    let alike = |a: Option<f64>, b: Option<f64>| a.zip(b).is_none_or(|(a, b)| near(a, b));
    alike(a.k, b.k) && alike(a.speed_m_s, b.speed_m_s)
}

/// Weighted residuals of one transfer function and their variance; its columns are written into `rows`, from the parameter `first` on and
/// where its searched poles are (parameter, place among the free poles).
fn rows_of(
    entry: &EntrySamples,
    report: &EntryReport,
    form: &Form,
    searched: &[(usize, usize)],
    first: usize,
    rows: &mut [Vec<f64>],
) -> Result<(Vec<f64>, f64)> {
    let (basis, values) = (Basis::new(form, &report.poles)?, report.values());
    let total = entry.total();
    let scale = unit_scale(total);
    let weighted = |r: f64, row: &EntrySample| scale * row.weight * r;
    let residuals = entry.residuals(&basis, &values);
    let residuals = residuals.iter().zip(&entry.rows);
    let residuals: Vec<f64> = residuals.map(|(r, row)| weighted(*r, row)).collect();
    let seen = |b: &Basis, row: &EntrySample| -> Vec<f64> {
        row.seen(&b.columns(Complex::new(0.0, row.k))).collect()
    };
    for (line, row) in rows.iter_mut().zip(&entry.rows) {
        for (to, x) in line[first..].iter_mut().zip(seen(&basis, row)) {
            *to = weighted(x, row);
        }
    }
    for &(at, index) in searched {
        let (up, down) = moved_pole(form, &report.poles, index)?;
        for (line, row) in rows.iter_mut().zip(&entry.rows) {
            let (above, below) = (seen(&up, row), seen(&down, row));
            let changes = above.iter().zip(below).zip(&values);
            let change: f64 = changes.map(|((a, b), c)| (a - b) * c).sum();
            line[at] = weighted(change / (2.0 * STEP * report.poles[index]), row);
        }
    }
    let sum: f64 = residuals.iter().map(|r| r.powi(2)).sum();
    // an entry that is zero throughout tells nothing of the errors of the others
    let exact = if total > 0.0 { 1.0 } else { 0.0 };
    Ok((residuals, if sum > 0.0 { sum } else { exact }))
}
