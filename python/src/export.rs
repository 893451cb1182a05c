//! `export_fmu`: an FMU; its runtime is part of this module.

use crate::convert::from_python;
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::section::Section;
use aerodeck::fmu::force_options::{ForceOptions, StripOptions};
use aerodeck::fmu::package::{Export, Growing, Overwrite, Runtime, write_fmu};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Write an FMI 2.0 FMU.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
/// section : Section or None
///     None for a model that was read from a file with its section.
/// model : Model
/// kind : {"section", "force"}
///     The section in its forces, or the forces alone for a structure of another program.
/// strips : sequence of (float, float), optional
///     Width and length of every strip, m, for `kind="force"`; left out, one strip of the section's width and a metre.
/// overwrite : bool
///     Replace a file that is there.
/// allow_unstable : bool
///     Export a model that grows below its onset, at reduced frequencies that were not tested.
/// **experiment
///     `wind_speed_m_s`, `initial_vertical_m`, `initial_rotation_rad`, `stop_time_s`, `step_size_s`,
///     `onset_search_limit_m_s` of the default experiment.
#[pyfunction]
#[pyo3(signature = (path, section, model, *, kind = "section", strips = None, overwrite = false,
    allow_unstable = false, **experiment))]
#[allow(clippy::too_many_arguments)] // keywords of Python, not positions
pub fn export_fmu(
    py: Python<'_>,
    path: PathBuf,
    section: Option<&Bound<'_, Section>>,
    model: &Bound<'_, Model>,
    kind: &str,
    strips: Option<Vec<(f64, f64)>>,
    overwrite: bool,
    allow_unstable: bool,
    experiment: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let mut trained = model.get().trained(section.map(|s| s.get()))?;
    if let Some(stated) = experiment {
        let all = crate::convert::to_python(py, &trained.experiment)?;
        all.call_method1("update", (stated,))?;
        trained.experiment = from_python("experiment", &all)?;
    }
    let force = match kind {
        "section" => None,
        "force" => Some(force_options(strips, trained.section.width_m)),
        other => return Err(wrong("kind", "section or force", format!("`{other}`"))),
    };
    let growing = if allow_unstable {
        Growing::Allow
    } else {
        Growing::Refuse
    };
    let existing = if overwrite {
        Overwrite::Replace
    } else {
        Overwrite::Refuse
    };
    let export = Export {
        force,
        ..growing.into()
    };
    py.detach(|| {
        let runtimes = Runtime::available()?;
        write_fmu(&path, &trained, &runtimes, existing, export)
    })
    .map_err(raised)
}

fn force_options(strips: Option<Vec<(f64, f64)>>, width_m: f64) -> ForceOptions {
    let mut options = ForceOptions::single(width_m);
    if let Some(strips) = strips {
        let strip = |(width_m, length_m)| StripOptions {
            width_m,
            length_m,
            wind_factor: 1.0,
        };
        options.strips = strips.into_iter().map(strip).collect();
        options.named_strips = true;
    }
    options
}
