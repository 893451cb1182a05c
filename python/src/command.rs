//! `_command`: any command of the program, for `aerodeck.Study` and whoever wants its answers as dicts.

use crate::convert::to_python;
use crate::error::raised;
use crate::work::Work;
use pyo3::prelude::*;

/// What `aerodeck ARGUMENTS --json` answers, and its exit code.
#[pyfunction]
pub fn _command<'py>(py: Python<'py>, arguments: Vec<String>) -> PyResult<(Bound<'py, PyAny>, u8)> {
    let answer = Work::new(None).run(py, || aerodeck::cli::answer(&arguments))?;
    let (value, code) = answer.map_err(raised)?;
    Ok((to_python(py, &value)?, code))
}
