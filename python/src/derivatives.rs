//! `Derivatives`: a table of measured aerodynamic derivatives.

use crate::convert::{
    Reduced, dof_names, framed, reduced, refuse_unreal, restored, rows, shown, table, word,
};
use crate::error::{raised, warned, wrong};
use aerodeck::aerodynamics::derivatives::notation::{
    Argument, Axes, Convention, ExpressedPoint, Notation,
};
use aerodeck::aerodynamics::derivatives::{DerivativeTable, Missing, TableHeader};
use aerodeck::files::derivatives::{
    ReadOptions, StatedConvention, embedded, parse_csv_in, read_table_with, write_csv, write_csv_in,
};
use aerodeck::plausibility::{Finding, of_table};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::collections::BTreeMap;
use std::path::PathBuf;

const NOTATIONS: &str = "scanlan, simiu, classical, polimi or starossek";
const ARGUMENTS: &str = "v_hat, v_star, k_full or k_semi";
const AXES: &str = "heave_up or heave_down";

/// A table of aerodynamic derivatives, each at its own reduced velocities.
///
/// Inside, the numbers are Scanlan's with ½ρV² and K², heave and lift up, over V̂ = V/(ωB). Everything else is converted when
/// it is read or written, and has to be stated.
#[pyclass(frozen, module = "aerodeck")]
pub struct Derivatives(pub DerivativeTable, pub Vec<Finding>);

#[pymethods]
impl Derivatives {
    /// Read a table: an NTNU workbook (.xlsx) or a CSV file.
    ///
    /// What the file states of its notation must not be contradicted; what it leaves open has to be stated.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// notation : {"scanlan", "simiu", "classical", "polimi", "starossek"}, optional
    /// argument : {"v_hat", "v_star", "k_full", "k_semi"}, optional
    /// axes : {"heave_up", "heave_down"}, optional
    /// width_m : float, optional
    ///     Width of the section model, m, for a file that does not state it.
    /// missing : {"zero", "quasi_steady"}, optional
    ///     What stands for H4*, A4* in a table without them.
    #[staticmethod]
    #[pyo3(signature = (path, *, notation = None, argument = None, axes = None, width_m = None, missing = None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        notation: Option<&str>,
        argument: Option<&str>,
        axes: Option<&str>,
        width_m: Option<f64>,
        missing: Option<&str>,
    ) -> PyResult<Self> {
        let options = ReadOptions {
            convention: stated(notation, argument, axes)?,
            width_m,
            missing: missing
                .map(|m| word::<Missing>("missing", "zero or quasi_steady", m))
                .transpose()?,
            ..ReadOptions::default()
        };
        let (table, convention) = read_table_with(path, &options).map_err(raised)?;
        Self::judged(py, table, &convention)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let Self(table, findings) = slf.get();
        let mut text = Vec::new();
        write_csv(table, &mut text)?;
        reduced(slf, &(String::from_utf8_lossy(&text), findings))
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        let (text, findings): (String, _) = restored(state)?;
        let (table, _) = parse_csv_in(&text, &ReadOptions::default()).map_err(raised)?;
        Ok(Self(table, findings))
    }

    /// A measured deck that comes with the package: one of `Derivatives.decks()`.
    #[staticmethod]
    fn deck(name: &str) -> PyResult<Self> {
        let table = embedded::deck(name).map_err(raised)?;
        Ok(Self(table, Vec::new()))
    }

    /// Names of the measured decks that come with the package.
    #[staticmethod]
    fn decks() -> Vec<&'static str> {
        embedded::names().collect()
    }

    /// A table from arrays, in a notation that is stated.
    ///
    /// Parameters
    /// ----------
    /// values : dict of str to array of shape (n, 2) or (n, 3), or to a pair of arrays of shape (n,)
    ///     For every derivative by its name in the notation (`"H1"`, …) its reduced velocities or frequencies and its values,
    ///     without dimension, after a first column of mean wind speeds (m/s) if there are three, as `to_numpy` returns them.
    ///     H1–H4 and A1–A4, with sway all eighteen.
    /// notation, argument : str
    ///     As in `read`.
    /// axes : str, optional
    ///     Left out, those usual for the notation.
    /// width_m : float
    ///     Width of the section model, m.
    #[staticmethod]
    #[pyo3(signature = (values, *, notation, argument, width_m, axes = None, name = "deck"))]
    fn from_arrays(
        values: &Bound<'_, PyDict>,
        notation: &str,
        argument: &str,
        width_m: f64,
        axes: Option<&str>,
        name: &str,
    ) -> PyResult<Self> {
        let convention = stated(Some(notation), Some(argument), axes)?.or_usual();
        let mut points = BTreeMap::new();
        for (key, arrays) in values {
            let key: String = key.extract()?;
            let derivative = convention.notation.derivative(&key).map_err(raised)?;
            let read = |point: &ExpressedPoint| convention.read_point(derivative, point);
            points.insert(
                derivative,
                expressed(&key, &arrays)?.iter().map(read).collect(),
            );
        }
        let header = TableHeader {
            source: "arrays".to_owned(),
            ..TableHeader::default()
        };
        let table = DerivativeTable::new(name, width_m, header, points).map_err(raised)?;
        Self::judged(values.py(), table, &convention)
    }

    /// All test points in a notation.
    ///
    /// Returns
    /// -------
    /// dict of str to ndarray
    ///     For every derivative, by its name in the notation, an array of shape (n, 3): mean wind speed (m/s; NaN where it is
    ///     not known), reduced velocity or frequency, value.
    #[pyo3(signature = (notation = "scanlan", *, argument = None, axes = None))]
    fn to_numpy<'py>(
        &self,
        py: Python<'py>,
        notation: &str,
        argument: Option<&str>,
        axes: Option<&str>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let convention = stated(Some(notation), argument, axes)?.or_usual();
        let all = PyDict::new(py);
        for derivative in self.0.derivatives() {
            let points = self.0.points(derivative).iter().map(|p| {
                let p = convention.express_point(derivative, p);
                [p.mean_speed_m_s.unwrap_or(f64::NAN), p.argument, p.value]
            });
            all.set_item(
                convention.notation.name_of(derivative),
                rows(py, 3, points)?,
            )?;
        }
        Ok(all)
    }

    /// Write the table as CSV in a notation, which its header states.
    #[pyo3(signature = (path, notation = "scanlan", *, argument = None, axes = None))]
    fn write(
        &self,
        path: PathBuf,
        notation: &str,
        argument: Option<&str>,
        axes: Option<&str>,
    ) -> PyResult<()> {
        let convention: Convention = stated(Some(notation), argument, axes)?.or_usual();
        let mut text = Vec::new();
        write_csv_in(&self.0, &convention, &mut text)?;
        std::fs::write(&path, text).map_err(|e| raised(aerodeck::Error::io(&path, e)))
    }

    /// Name of the deck.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Width of the section model, m.
    #[getter]
    fn width_m(&self) -> f64 {
        self.0.width_m
    }

    /// Where the numbers come from.
    #[getter]
    fn source(&self) -> &str {
        &self.0.header.source
    }

    /// Licence of the numbers.
    #[getter]
    fn licence(&self) -> &str {
        &self.0.header.licence
    }

    /// Motions that the table covers: two or three.
    #[getter]
    fn dofs(&self) -> Vec<&'static str> {
        dof_names(self.0.dofs())
    }

    /// Lowest and highest reduced frequency K = ωB/V at which everything was tested.
    #[getter]
    fn tested_range(&self) -> (f64, f64) {
        let range = self.0.tested_range(self.0.dofs());
        (range.min.full_width(), range.max.full_width())
    }

    fn __repr__(&self) -> String {
        format!(
            "Derivatives({}, B {:.4} m, {} derivatives)",
            self.0.name,
            self.0.width_m,
            self.0.derivatives().count()
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "derivatives_html", None)
    }

    /// A table from a pandas DataFrame: a column for every derivative by its name in the notation (`"H1"` or `"H1*"`, …), and the
    /// reduced velocities or frequencies as the index or as the column of the argument's name (`"v_hat"`, …). Empty cells are
    /// left out.
    ///
    /// Parameters
    /// ----------
    /// frame : pandas.DataFrame
    /// **keywords
    ///     `notation`, `argument`, `axes`, `width_m` and `name` as in `from_arrays`; the argument may be the index's name.
    #[staticmethod]
    #[pyo3(signature = (frame, **keywords))]
    fn from_frame<'py>(
        frame: &Bound<'py, PyAny>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        framed(frame, "derivatives_from_frame", keywords)
    }

    /// All test points as a pandas DataFrame, a row a reduced velocity or frequency and a column a derivative; keywords as in `to_numpy`.
    #[pyo3(signature = (**keywords))]
    fn to_frame<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "derivatives_frame", keywords)
    }

    /// All test points as an xarray DataArray over derivative and reduced velocity or frequency; keywords as in `to_numpy`.
    #[pyo3(signature = (**keywords))]
    fn to_xarray<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "derivatives_array", keywords)
    }

    /// Draw the derivatives over V̂ with matplotlib, with models if they are given; returns the figure.
    #[pyo3(signature = (**keywords))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "derivatives_plot", keywords)
    }
}

impl Derivatives {
    /// The table with what is odd about it, which is said.
    fn judged(py: Python<'_>, table: DerivativeTable, convention: &Convention) -> PyResult<Self> {
        let findings = of_table(&table, convention);
        warned(py, &findings)?;
        Ok(Self(table, findings))
    }
}

/// The test points of one derivative, from columns or from a pair of arrays.
fn expressed(name: &str, arrays: &Bound<'_, PyAny>) -> PyResult<Vec<ExpressedPoint>> {
    let numpy = arrays.py().import("numpy")?;
    let columns = match arrays.cast::<PyTuple>() {
        Ok(pair) => {
            pair.iter()
                .try_for_each(|column| refuse_unreal(name, &column))?;
            numpy.call_method1("column_stack", (arrays,))
        }
        Err(_) => Ok(arrays.clone()),
    };
    let columns = columns.map_err(|_| {
        let found = "columns of different lengths".to_owned();
        wrong(name, "a pair of arrays of one length", found)
    })?;
    let array = table(name, &columns)?;
    let array = array.as_array();
    let speeds = match array.ncols() {
        2 => 0,
        3 => 1,
        n => return Err(wrong(name, "two or three columns", n.to_string())),
    };
    let point = |row: numpy::ndarray::ArrayView1<'_, f64>| ExpressedPoint {
        mean_speed_m_s: (speeds == 1 && !row[0].is_nan()).then(|| row[0]),
        argument: row[speeds],
        value: row[speeds + 1],
    };
    Ok(array.rows().into_iter().map(point).collect())
}

fn stated(
    notation: Option<&str>,
    argument: Option<&str>,
    axes: Option<&str>,
) -> PyResult<StatedConvention> {
    Ok(StatedConvention {
        notation: notation
            .map(|w| word::<Notation>("notation", NOTATIONS, w))
            .transpose()?,
        argument: argument
            .map(|w| word::<Argument>("argument", ARGUMENTS, w))
            .transpose()?,
        axes: axes.map(|w| word::<Axes>("axes", AXES, w)).transpose()?,
    })
}
