//! The Python package `aerodeck`: the library's own names, with NumPy arrays.
//!
//! One file a noun. Nothing is computed here: each function takes arrays apart, releases the interpreter, calls the
//! library and puts arrays together. Plots and pages for notebooks are Python (`aerodeck/_show.py`).

mod bridge;
mod bridge_scatter;
mod buffeting;
mod command;
mod convert;
mod derivatives;
mod error;
mod export;
mod fit;
mod flutter;
mod model;
mod monte_carlo;
mod onset;
mod onsets;
mod process;
mod records;
mod response;
mod section;
mod sweep;
mod work;

use pyo3::prelude::*;

/// The compiled half of the package.
#[pymodule]
fn _aerodeck(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // loads NumPy's interface, which must not be interrupted half way by a Ctrl-C in the first call
    // (imported first, so that one that cannot be imported is an error and no panic)
    m.py().import("numpy")?;
    numpy::PyArray1::<f64>::from_slice(m.py(), &[]);
    m.add_class::<derivatives::Derivatives>()?;
    m.add_class::<records::Records>()?;
    m.add_class::<section::Section>()?;
    m.add_class::<model::Model>()?;
    m.add_class::<onset::Onset>()?;
    m.add_class::<sweep::Sweep>()?;
    m.add_class::<onsets::Onsets>()?;
    m.add_class::<bridge::Bridge>()?;
    m.add_class::<buffeting::Buffeting>()?;
    m.add_class::<bridge_scatter::BridgeScatter>()?;
    m.add_class::<response::Motion>()?;
    m.add_class::<response::Stepper>()?;
    m.add_class::<monte_carlo::MonteCarlo>()?;
    m.add_class::<process::Processing>()?;
    m.add_function(wrap_pyfunction!(fit::fit_laguerre, m)?)?;
    m.add_function(wrap_pyfunction!(fit::fit_rational, m)?)?;
    m.add_function(wrap_pyfunction!(flutter::flutter, m)?)?;
    m.add_function(wrap_pyfunction!(sweep::sweep, m)?)?;
    m.add_function(wrap_pyfunction!(onsets::onsets, m)?)?;
    m.add_function(wrap_pyfunction!(response::simulate, m)?)?;
    m.add_function(wrap_pyfunction!(monte_carlo::monte_carlo, m)?)?;
    m.add_function(wrap_pyfunction!(monte_carlo::_monte_carlo_part, m)?)?;
    m.add_function(wrap_pyfunction!(monte_carlo::_monte_carlo_of, m)?)?;
    m.add_function(wrap_pyfunction!(command::_command, m)?)?;
    m.add_function(wrap_pyfunction!(export::export_fmu, m)?)?;
    m.add_function(wrap_pyfunction!(process::process, m)?)
}
