//! The model whose coefficients are drawn, and the factor of their covariance, which files state.
//!
//! The covariance of a fit holds all its parameters, searched poles among them: with a pole the coefficients move
//! together, and drawn at fixed poles they would be another model. The model is therefore followed along its slope with
//! respect to the poles, in chains of filters that span it ([`ModelDraws`]): a linear function of
//! the parameters, of which standard errors speak as well.

use super::coefficients;
use super::plan::MonteCarloPlan;
use crate::error::{Error, Place, Result, counted, ensure};
use crate::identification::FitReport;
use crate::json;
use crate::trained_model::{Model, TrainedModel};
use crate::uncertainty::parameters::SEARCHED_POLES;
use crate::uncertainty::statistics::covariance_root;
use crate::uncertainty::{ModelDraws, ModelUncertainty};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// An eigenvalue below this part of the largest, on the negative side, is no rounding.
const INDEFINITE: f64 = 1e-9;

/// A symmetric factor `S` of a covariance, `C = S Sᵀ`, and the coefficients it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CovarianceFactor {
    /// Places among the coefficients of the force model.
    pub(super) places: Vec<usize>,
    pub(super) factor: DMatrix<f64>,
    pub(super) draws: DrawnForces,
}

/// The draws of the force model's coefficients.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DrawnForces {
    /// Degrees of freedom of the multivariate Student's t distribution; `null` where the draws are Gaussian.
    pub degrees_of_freedom: Option<f64>,
    /// Standard deviation of every coefficient over its value, where each scatters by itself.
    pub relative_scatter: Option<f64>,
    /// What the choice of the model's form leaves open of its onset, m/s (root mean square): known, and in no draw.
    pub form_left_out_m_s: Option<f64>,
}

impl DrawnForces {
    /// Draws by the covariance of a fit, as its file knows it.
    ///
    /// The variances behind a covariance are themselves estimates from few blocks. Student's t with the degrees of freedom of the
    /// onset's variance, one scale for all parameters, gives an onset that is linear in them the distribution of its interval;
    /// those of each force by itself are in no file, and would have to be combined to these anyway.
    pub(super) fn of_fit(saved: &ModelUncertainty) -> Self {
        let onset = saved.onset.as_ref().map(|o| o.speed_m_s);
        let spread = saved.form_spread.as_ref().zip(onset);
        Self {
            degrees_of_freedom: saved.degrees_of_freedom_of_draws(),
            form_left_out_m_s: spread.and_then(|(s, speed)| s.deviation_from_m_s(speed)),
            ..Self::default()
        }
    }

    /// What was drawn, in words.
    pub fn in_words(&self) -> String {
        match (self.relative_scatter, self.degrees_of_freedom) {
            (Some(scatter), _) => format!(
                "every coefficient by itself, Gaussian, standard deviation {} % of its value",
                100.0 * scatter
            ),
            (None, Some(freedom)) => format!(
                "all parameters of the fit together, Student's t with the {freedom:.1} degrees of freedom of its covariance"
            ),
            (None, None) => "by the covariance, Gaussian: its file states no degrees of freedom, and where it is estimated from few \
                             blocks of data the tails are too thin"
                .to_owned(),
        }
    }

    /// What is known to be in no draw, in words.
    pub fn left_out(&self) -> Option<String> {
        let form = self.form_left_out_m_s.filter(|form| *form > 0.0)?;
        Some(format!(
            "the spread of the onset between forms of model that explain the data as well, {form:.3} m/s for the model itself, is in \
             no sample; the interval of its onset holds it"
        ))
    }
}

/// The model in the form in which its draws are linear, and the factor of the covariance that the plan names.
pub(super) fn drawn_model(
    plan: &MonteCarloPlan,
    trained: &TrainedModel,
) -> Result<(Model, Option<CovarianceFactor>)> {
    let Some(path) = &plan.aerodynamics.covariance else {
        return Ok((trained.model.clone(), None));
    };
    let path = plan.directory.join(path);
    let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
    if let Some((file, saved)) = all_parameters(&path, &text)? {
        let (model, factor) = follow(&saved, trained).map_err(|e| e.in_file(&file))?;
        return Ok((model, Some(factor)));
    }
    let (_, names) = coefficients::list(&trained.model);
    let factor = from_file(&path, &text, &names)?;
    Ok((trained.model.clone(), Some(factor)))
}

fn is_json(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

/// The covariance of all parameters, from the file itself or from the one beside a report.
fn all_parameters(path: &Path, text: &str) -> Result<Option<(PathBuf, ModelUncertainty)>> {
    if !is_json(path) {
        return Ok(None);
    }
    if let Ok(saved) = ModelUncertainty::from_json(text) {
        return Ok(Some((path.to_owned(), saved)));
    }
    let beside = path.with_extension("uncertainty.json");
    let Ok(text) = std::fs::read_to_string(&beside) else {
        return Ok(None);
    };
    let saved = ModelUncertainty::from_json(&text).map_err(|e| e.in_file(&beside))?;
    Ok(Some((beside, saved)))
}

/// The linear model of an estimate, and the factor of its coefficients' covariance.
fn follow(saved: &ModelUncertainty, trained: &TrainedModel) -> Result<(Model, CovarianceFactor)> {
    let estimate = &saved.coefficients;
    let (values, draws) = (estimate.values(), ModelDraws::new(estimate)?);
    let model = draws.model_at(&values)?;
    ensure(
        estimate.makes(&trained.model, trained.tested_range.min)?,
        "covariance",
        format_args!("that of the training of {}", trained.name),
        "that of another model",
    )?;
    let (base, _) = coefficients::list(&model);
    let mut slopes = DMatrix::zeros(base.len(), values.len());
    for p in 0..values.len() {
        let mut moved = values.clone();
        // the model is linear in its parameters: any step is exact
        moved[p] += 1.0;
        let (there, _) = coefficients::list(&draws.model_at(&moved)?);
        for (row, (a, b)) in there.iter().zip(&base).enumerate() {
            slopes[(row, p)] = a - b;
        }
    }
    let factor = CovarianceFactor {
        places: (0..base.len()).collect(),
        factor: slopes * factor_of(&estimate.covariance)?,
        draws: DrawnForces::of_fit(saved),
    };
    Ok((model, factor))
}

/// The covariance of coefficients whose names are among `names` from the text of a file: a table, or the report of a fit
/// whose poles were given.
fn from_file(path: &Path, text: &str, names: &[String]) -> Result<CovarianceFactor> {
    let read = match is_json(path) {
        true => from_report(path, text),
        false => from_csv(text),
    };
    let factor = read.and_then(|(own, matrix)| factorise(&own, &matrix, names));
    factor.map_err(|e| e.in_file(path))
}

/// The blocks of all transfer functions of a fit, independent of each other.
fn from_report(path: &Path, text: &str) -> Result<(Vec<String>, DMatrix<f64>)> {
    let report: FitReport = json::read("fit", text)
        .map_err(|e| Error::json("a report of a fit as written by `aerodeck train`", &e))?;
    ensure(
        !report.covariance_assumption.contains(SEARCHED_POLES),
        "",
        format_args!(
            "{} beside it: coefficients move with the searched poles, whose covariance is there",
            path.with_extension("uncertainty.json").display()
        ),
        "none",
    )?;
    let size = report.entries.iter().map(|e| e.coefficients.len()).sum();
    let mut names = Vec::with_capacity(size);
    let mut matrix = DMatrix::zeros(size, size);
    for entry in &report.entries {
        let (at, n) = (names.len(), entry.coefficients.len());
        let place = format!("{}.{}", entry.force.name(), entry.motion.name());
        ensure(
            entry.covariance.len() == n && entry.covariance.iter().all(|row| row.len() == n),
            format_args!("covariance of {place}"),
            format_args!("a {n}x{n} matrix"),
            counted(entry.covariance.len(), "row"),
        )?;
        let own = entry.coefficients.iter();
        names.extend(own.map(|c| format!("{place}.{}", c.name)));
        let block = DMatrix::from_fn(n, n, |i, j| entry.covariance[i][j]);
        matrix.view_mut((at, at), (n, n)).copy_from(&block);
    }
    Ok((names, matrix))
}

/// Names in the first line, then as many rows of as many numbers; lines that start with `#` are remarks.
fn from_csv(text: &str) -> Result<(Vec<String>, DMatrix<f64>)> {
    let says = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut lines = text.lines().zip(1..).filter(|(line, _)| says(line));
    let cells =
        |line: &str| -> Vec<String> { line.split(',').map(|c| c.trim().to_owned()).collect() };
    let none = || Error::input("line 1", "names of coefficients", "an empty file");
    let (header, _) = lines.next().ok_or_else(none)?;
    let names = cells(header);
    let mut values = Vec::with_capacity(names.len() * names.len());
    let mut rows = 0;
    for (line, number) in lines {
        let row = cells(line);
        let place = || Place::line(number);
        ensure(
            row.len() == names.len() && rows != names.len(),
            place(),
            format_args!("{0} rows of {0} numbers", names.len()),
            format_args!("{} numbers in row {}", row.len(), rows + 1),
        )?;
        for (cell, name) in row.iter().zip(&names) {
            let value = cell.parse::<f64>().ok().filter(|v| v.is_finite());
            values.push(value.ok_or_else(|| {
                Error::input(place().column(name), "a finite number", format!("`{cell}`"))
            })?);
        }
        rows += 1;
    }
    let expected = counted(names.len(), "row");
    ensure(rows == names.len(), "covariance", expected, rows)?;
    let matrix = DMatrix::from_row_slice(rows, rows, &values);
    Ok((names, matrix))
}

fn factorise(own: &[String], matrix: &DMatrix<f64>, names: &[String]) -> Result<CovarianceFactor> {
    let mut places = Vec::with_capacity(own.len());
    for name in own {
        let place = names.iter().position(|n| n == name).ok_or_else(|| {
            let expected = format!("coefficients of the model: {}", names.join(", "));
            Error::input("name of a coefficient", expected, format!("`{name}`"))
        })?;
        ensure(
            !places.contains(&place),
            "name of a coefficient",
            "every name once",
            format_args!("`{name}` a second time"),
        )?;
        places.push(place);
    }
    Ok(CovarianceFactor {
        places,
        factor: factor_of(matrix)?,
        draws: DrawnForces::default(),
    })
}

/// A factor `S` with `C = S Sᵀ`.
fn factor_of(matrix: &DMatrix<f64>) -> Result<DMatrix<f64>> {
    let finite = matrix.iter().all(|x| x.is_finite());
    ensure(finite, "covariance", "finite numbers", "others")?;
    let asymmetry = (matrix - matrix.transpose()).amax();
    ensure(
        asymmetry <= INDEFINITE * matrix.amax(),
        "covariance",
        "a symmetric matrix",
        format_args!("a difference of {asymmetry:e} between mirrored entries"),
    )?;
    let symmetric = (matrix + matrix.transpose()) * 0.5;
    let (factor, [low, high]) = covariance_root(symmetric)
        .ok_or_else(|| Error::Numerical("covariance: no eigenvalues".into()))?;
    ensure(
        low >= -INDEFINITE * high && high > 0.0,
        "covariance",
        "a positive semidefinite matrix that is not zero",
        format_args!("eigenvalues from {low:e} to {high:e}"),
    )?;
    Ok(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Vec<String> {
        ["a", "b", "c"].map(str::to_owned).to_vec()
    }

    fn write(name: &str, text: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
        folder
    }

    fn read(path: &Path) -> Result<CovarianceFactor> {
        from_file(path, &std::fs::read_to_string(path).unwrap(), &names())
    }

    /// There is nothing to draw from.
    #[test]
    fn nothing_has_no_factor() {
        assert!(factor_of(&DMatrix::zeros(0, 0)).is_err());
    }

    #[test]
    fn the_factor_gives_the_covariance_back() {
        let folder = write("c.csv", "# made up\nc, a\n4.0, 1.0\n1.0, 9.0\n");
        let read = read(&folder.path().join("c.csv")).unwrap();
        assert_eq!(read.places, [2, 0]);
        let product = &read.factor * read.factor.transpose();
        let expected = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 9.0]);
        assert!((product - expected).amax() < 1e-13);
    }

    #[test]
    fn wrong_files_are_refused_with_their_line() {
        for (text, said) in [
            ("a,b\n1,0\n", "expected 2 rows, found 1"),
            (
                "a,b\n1,0\n0,x\n",
                "line 3, column b: expected a finite number, found `x`",
            ),
            ("a,b\n1,0\n0\n", "line 3: expected 2 rows of 2 numbers"),
            ("a,d\n1,0\n0,1\n", "found `d`"),
            ("a,b\n1,2\n2,1\n", "positive semidefinite"),
            ("a,b\n1,2\n3,9\n", "symmetric"),
            ("", "an empty file"),
        ] {
            let folder = write("c.csv", text);
            let path = folder.path().join("c.csv");
            let message = read(&path).unwrap_err().to_string();
            assert!(
                message.contains(said) && message.contains("c.csv"),
                "{message}"
            );
        }
    }
}
