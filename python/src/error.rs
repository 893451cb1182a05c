//! Errors of the library as the exceptions of `aerodeck/_errors.py`.

use aerodeck::Error;
use aerodeck::plausibility::Finding;
use pyo3::prelude::*;

/// The exception for an error: `InputError` knows file, place, expected and found.
pub fn raised(error: Error) -> PyErr {
    Python::attach(|py| exception(py, &error).unwrap_or_else(|failed| failed))
}

/// Says what is odd by `warnings.warn`, as `AerodeckWarning`.
pub fn warned(py: Python<'_>, findings: &[Finding]) -> PyResult<()> {
    let mut texts = findings.iter().map(ToString::to_string);
    texts.try_for_each(|text| warn(py, &text))
}

/// Says this by `warnings.warn`, as `AerodeckWarning`.
pub fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let class = py.import("aerodeck._errors")?.getattr("AerodeckWarning")?;
    let warnings = py.import("warnings")?;
    warnings.call_method1("warn", (text, class, 1)).map(drop)
}

/// Wrong input at `place`.
pub fn wrong(place: &str, expected: &str, found: String) -> PyErr {
    let made = || {
        Python::attach(|py| {
            let class = py.import("aerodeck._errors")?.getattr("InputError")?;
            let file: Option<&str> = None;
            let value = class.call1((file, place, expected, found))?;
            Ok(PyErr::from_value(value))
        })
    };
    made().unwrap_or_else(|failed| failed)
}

fn exception(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let module = py.import("aerodeck._errors")?;
    let value = match error {
        Error::Input(e) => {
            let file = e.file.as_ref().map(|f| f.display().to_string());
            let class = module.getattr("InputError")?;
            class.call1((file, e.place.to_string(), &e.expected, &e.found))?
        }
        Error::Io { path, source } => {
            let class = module.getattr("FileError")?;
            class.call1((path.display().to_string(), source.to_string()))?
        }
        Error::Unstable(text) => module.getattr("UnstableError")?.call1((text,))?,
        Error::Numerical(_) | Error::NotDistinct(_) | Error::Several(_) => module
            .getattr("NumericalError")?
            .call1((error.to_string(),))?,
    };
    Ok(PyErr::from_value(value))
}
