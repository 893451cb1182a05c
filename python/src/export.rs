//! `export_fmu`: an FMU; its runtime is part of this module.

use crate::convert::{from_python, word};
use crate::error::{raised, wrong};
use crate::flutter::{of_model, verdict};
use crate::model::Model;
use crate::section::Section;
use crate::work::detached;
use aerodeck::files::coefficients::gust_force;
use aerodeck::flutter::OnsetSearch;
use aerodeck::fmu::force_options::{ForceOptions, StripOptions};
use aerodeck::fmu::onset_bounds::OnsetBounds;
use aerodeck::fmu::package::{Export, FmiVersion, Label, Runtime, write_fmu};
use aerodeck::trained_model::TrainedModel;
use aerodeck::verdict::Verdict;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Write an FMU for FMI 2.0 or 3.0, as `aerodeck fmu export` does.
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
/// prediction : float, optional
///     How far ahead of the motion forces are put out, in communication steps, for `kind="force"`; left out, 1.5.
/// gusts : str or os.PathLike, optional
///     Take gusts as inputs, whose forces follow from these static coefficients: a table (CSV), an embedded one, or "flat plate".
/// admittance : {"none", "sears", "liepmann"}, optional
///     Of the gusts; left out, none.
/// fmi : {2, 3}
///     Version of the standard.
/// reals_only : bool
///     List real variables only, for importers that take no others.
/// platforms : sequence of str, optional
///     Platforms to pack for: "linux64", "win64", …, "arm-linux"; left out, all whose runtime is here.
/// name, author, copyright : str, optional
///     What the description says of its origin.
/// overwrite : bool
///     Replace a file that is there.
/// allow_unstable : bool
///     Export a model that grows below its onset, at reduced frequencies that were not tested.
/// **experiment
///     `wind_speed_m_s`, `initial_vertical_m`, `initial_rotation_rad`, `stop_time_s`, `step_size_s`,
///     `onset_search_limit_m_s` of the default experiment.
#[pyfunction]
#[pyo3(signature = (path, section, model, *, kind = "section", strips = None, prediction = None, gusts = None,
    admittance = None, fmi = 2, reals_only = false, platforms = None, name = None, author = None, copyright = None,
    overwrite = false, allow_unstable = false, **experiment))]
#[allow(clippy::too_many_arguments)] // keywords of Python, not positions
pub fn export_fmu(
    py: Python<'_>,
    path: PathBuf,
    section: Option<&Bound<'_, Section>>,
    model: &Bound<'_, Model>,
    kind: &str,
    strips: Option<Vec<(f64, f64)>>,
    prediction: Option<f64>,
    gusts: Option<PathBuf>,
    admittance: Option<&str>,
    fmi: u32,
    reals_only: bool,
    platforms: Option<Vec<String>>,
    name: Option<String>,
    author: Option<String>,
    copyright: Option<String>,
    overwrite: bool,
    allow_unstable: bool,
    experiment: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let mut trained = model.get().exported(section.map(|s| s.get()))?;
    if let Some(stated) = experiment {
        let all = crate::convert::to_python(py, &trained.experiment)?;
        all.call_method1("update", (stated,))?;
        trained.experiment = from_python("experiment", &all)?;
    }
    let admittance = admittance.map(|a| word("admittance", "none, sears or liepmann", a));
    let gusts = gusts.map(|g| g.to_string_lossy().into_owned());
    let dofs = trained.section.dofs();
    let gusts = gust_force(gusts.as_deref(), admittance.transpose()?, &dofs).map_err(raised)?;
    let label = Label {
        name,
        author,
        copyright,
        generated: None,
    };
    let force = force(kind, strips, prediction, trained.section.width_m)?;
    let (bounds, verdict) = match force {
        None => {
            let model = model.get();
            let (bounds, verdict) = detached(py, || bounds(&trained, model))?;
            (bounds, Some(verdict))
        }
        Some(_) => {
            let model = model.get();
            let judged = detached(py, || bounds(&trained, model));
            (None, judged.ok().map(|(_, verdict)| verdict))
        }
    };
    let export = Export {
        force,
        bounds,
        gusts,
        verdict,
        reals_only,
        label: label.dated().map_err(raised)?,
        version: version(fmi)?,
        allow_unstable,
        ..Export::default()
    };
    detached(py, || {
        let runtimes = match platforms {
            Some(platforms) => Runtime::chosen(&platforms)?,
            None => Runtime::available()?,
        };
        write_fmu(&path, &trained, &runtimes, overwrite, export)
    })
    .map_err(raised)
}

/// The interval of the onset, which the archive carries where the data give one, and the verdict, which it states.
fn bounds(trained: &TrainedModel, model: &Model) -> PyResult<(Option<OnsetBounds>, Verdict)> {
    let search = OnsetSearch::up_to(trained.experiment.onset_search_limit_m_s);
    let found = of_model(&trained.section, model, &search, "eigenvalues")?;
    let onset = found.onset();
    let bounds = onset.and_then(|onset| OnsetBounds::from_interval(&onset.interval));
    let verdict = verdict(&trained.section, model, &search, found, None)?;
    Ok((bounds, verdict))
}

fn version(fmi: u32) -> PyResult<FmiVersion> {
    match fmi {
        2 => Ok(FmiVersion::Two),
        3 => Ok(FmiVersion::Three),
        other => Err(wrong("fmi", "2 or 3", other.to_string())),
    }
}

fn force(
    kind: &str,
    strips: Option<Vec<(f64, f64)>>,
    prediction: Option<f64>,
    width_m: f64,
) -> PyResult<Option<ForceOptions>> {
    match (kind, &strips, prediction) {
        ("section", None, None) => return Ok(None),
        ("section", Some(_), _) => {
            let expected = "kind=\"force\" with them: a coupled section has no strips";
            return Err(wrong("strips", expected, "kind=\"section\"".to_owned()));
        }
        ("section", None, Some(_)) => {
            let expected = "kind=\"force\" with it: a coupled section predicts nothing";
            return Err(wrong("prediction", expected, "kind=\"section\"".to_owned()));
        }
        ("force", _, _) => (),
        (other, _, _) => return Err(wrong("kind", "section or force", format!("`{other}`"))),
    }
    let mut options = ForceOptions::single(width_m);
    options.prediction_steps = prediction.unwrap_or(options.prediction_steps);
    if let Some(strips) = strips {
        let strip = |(width_m, length_m)| StripOptions {
            width_m,
            length_m,
            wind_factor: 1.0,
            model: 0,
        };
        options.strips = strips.into_iter().map(strip).collect();
        options.named_strips = true;
    }
    options.validate().map_err(raised)?;
    Ok(Some(options))
}
