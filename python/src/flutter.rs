//! `flutter`: the onset of one section.

use crate::derivatives::Derivatives;
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::onset::Onset;
use crate::section::Section;
use crate::work::detached;
use aerodeck::aerodynamics::derivatives::{Extrapolation, InterpolatedTable};
use aerodeck::aerodynamics::{FlatPlate, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{
    FlutterSearch, MovedOnset, OnsetInterval, OnsetMethod, OnsetSearch, determinant_onset,
    find_onset, pk_onset,
};
use aerodeck::plausibility::{Finding, of_section};
use aerodeck::section::{Dof, SectionModel, Structure};
use aerodeck::study::FlutterBlock;
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use aerodeck::verdict::{Evidence, RequiredSpeed, Verdict};
use pyo3::prelude::*;

/// Reduced frequencies in which the flat plate is searched.
const PLATE_K: (f64, f64) = (0.02, 20.0);

/// Find the flutter onset of a section.
///
/// Parameters
/// ----------
/// section : Section
/// model : Model, Derivatives or "flat plate"
///     A trained model, a measured table (searched inside its test points) or Theodorsen's flat plate.
/// speed_max_m_s : float, optional
///     Highest wind speed searched, m/s; left out, and at least where a speed is required, well beyond the flat plate's onset.
/// required_speed_m_s : float, optional
///     Nothing critical may begin below this wind speed, m/s; the search always reaches it. `Onset.outcome` says whether that is met.
/// method : {"eigenvalues", "determinant", "pk"}, optional
///     Left out, eigenvalues for a model and the determinant for the others, which have none.
///
/// Returns
/// -------
/// Onset
#[pyfunction]
#[pyo3(signature = (section, model, *, speed_max_m_s = None, required_speed_m_s = None, method = None))]
pub fn flutter(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, PyAny>,
    speed_max_m_s: Option<f64>,
    required_speed_m_s: Option<f64>,
    method: Option<&str>,
) -> PyResult<Onset> {
    let section = &section.get().0;
    let block = FlutterBlock {
        speed_max_m_s,
        required_speed_m_s,
        ..FlutterBlock::default()
    };
    block.validate("flutter").map_err(raised)?;
    let search = block.range(section).search();
    let structure = section.structure().map_err(raised)?;
    if let Ok(model) = model.cast::<Model>() {
        let (method, model) = (method.unwrap_or("eigenvalues"), model.get());
        let judged = || {
            let found = of_model(section, model, &search, method)?;
            let verdict = verdict(section, model, &search, found.clone(), required_speed_m_s)?;
            PyResult::Ok((found, verdict))
        };
        let (found, verdict) = detached(py, judged)?;
        return Onset::new(&found, method, &verdict);
    }
    let plate = model.extract::<&str>().is_ok_and(|m| m == "flat plate");
    if plate && section.dofs() != Dof::TWO {
        let expected = "heave and rotation: the flat plate has no forces of sway";
        return Err(wrong("section", expected, "three motions".to_owned()));
    }
    let method = method.unwrap_or("determinant");
    let found = if let Ok(table) = model.cast::<Derivatives>() {
        let table = &table.get().0;
        detached(py, || {
            let dofs = section.dofs();
            let forces =
                InterpolatedTable::new(table, &dofs, Extrapolation::Refuse).map_err(raised)?;
            let range = forces.tested_range();
            let found = of_fixed(&table.name, &structure, &forces, range, &search, method)?;
            let evidence =
                Evidence::of_table("the table", &structure, &forces, range, found.clone());
            PyResult::Ok((found, evidence))
        })
    } else if plate {
        let k = ReducedFrequency::from_full_width;
        let range = ReducedFrequencyRange::between(k(PLATE_K.0), k(PLATE_K.1));
        let forces = FlatPlate::default();
        let found = detached(py, || {
            of_fixed("flat plate", &structure, &forces, range, &search, method)
        });
        found.map(FlutterSearch::of_exact_forces).map(|found| {
            let evidence = Evidence::of_exact("the flat plate", &structure, &forces, found.clone());
            (found, evidence)
        })
    } else {
        let found = model.get_type().name()?.to_string();
        return Err(wrong(
            "model",
            "a Model, Derivatives or \"flat plate\"",
            found,
        ));
    };
    let (found, mut evidence) = found?;
    evidence.searched_to_m_s = Some(search.speed_max_m_s);
    let of_deck = model.cast::<Derivatives>().ok();
    let of_deck = of_deck.map_or(&[][..], |table| &table.get().1);
    let verdict = against(evidence, required_speed_m_s, section, of_deck);
    Onset::new(&found, method, &verdict)
}

/// The verdict on a section of which this is known.
fn against(
    mut evidence: Evidence,
    required_speed_m_s: Option<f64>,
    section: &SectionModel,
    of_data: &[Finding],
) -> Verdict {
    evidence.required = required_speed_m_s.map(|speed_m_s| RequiredSpeed { speed_m_s });
    evidence.implausible = [&of_section(section)[..], of_data].concat();
    Verdict::judge(&evidence)
}

/// What a trained model, of which this was found, says of a section and the speed that is required of it.
pub fn verdict(
    section: &SectionModel,
    model: &Model,
    search: &OnsetSearch,
    found: FlutterSearch,
    required_speed_m_s: Option<f64>,
) -> PyResult<Verdict> {
    let evidence = model_evidence(section, model, search, found)?;
    Ok(against(evidence, required_speed_m_s, section, &model.odd()))
}

/// What a trained model says of a section and a speed, which the search reaches, with what is odd about samples of them.
pub fn verdict_at(
    section: &SectionModel,
    model: &Model,
    speed_m_s: f64,
    of_samples: &[Finding],
) -> PyResult<Verdict> {
    let block = FlutterBlock {
        required_speed_m_s: Some(speed_m_s),
        ..FlutterBlock::default()
    };
    let search = block.range(section).search();
    let found = of_model(section, model, &search, "eigenvalues")?;
    let evidence = model_evidence(section, model, &search, found)?;
    let findings = [&model.odd()[..], of_samples].concat();
    Ok(against(evidence, Some(speed_m_s), section, &findings))
}

/// Evidence for the verdict on a section in the forces of a trained model.
fn model_evidence(
    section: &SectionModel,
    model: &Model,
    search: &OnsetSearch,
    found: FlutterSearch,
) -> PyResult<Evidence> {
    let structure = section.structure().map_err(raised)?;
    let coupled = CoupledSection::with_model(&structure, &model.model).map_err(raised)?;
    let at_rest = ReducedFrequency::from_full_width(0.0);
    let at_rest = model.model.transfer(at_rest).map_err(raised)?;
    let report = model.report.as_ref();
    let alone = report.and_then(|r| r.constraints.as_ref()?.unconstrained.as_deref());
    let moved = alone.map(|alone| {
        let alone = CoupledSection::with_model(&structure, alone).ok();
        MovedOnset::new(alone.as_ref(), &found, search, model.tested)
    });
    let mut evidence =
        Evidence::of_section("the model", &coupled, &at_rest, model.tested, search, found);
    evidence.constraints = moved;
    Ok(evidence)
}

/// The onset of forces without a realisation, which are known in this range.
fn of_fixed(
    name: &str,
    structure: &Structure,
    forces: &dyn Transfer,
    range: ReducedFrequencyRange,
    search: &OnsetSearch,
    method: &str,
) -> PyResult<FlutterSearch> {
    match method {
        "determinant" => determinant_onset(name, structure, forces, range, search.speed_max_m_s),
        "pk" => pk_onset(name, structure, forces, search, None),
        other => return Err(wrong("method", "determinant or pk", format!("`{other}`"))),
    }
    .map_err(raised)
}

/// The onset of a trained model with its interval.
pub fn of_model(
    section: &SectionModel,
    model: &Model,
    search: &OnsetSearch,
    method: &str,
) -> PyResult<FlutterSearch> {
    let structure = section.structure().map_err(raised)?;
    let mut found = without_interval(section, model, search, method)?;
    if let FlutterSearch::Onset(onset) = &mut found {
        onset.interval = match &model.uncertainty {
            Ok(known) => {
                onset.warnings.extend(known.warning_of(&structure, onset));
                // the same motion by every method
                let mut by_modes = onset.clone();
                by_modes.at.method = OnsetMethod::Eigenvalues;
                known
                    .interval(&model.model, &structure, &by_modes)
                    .unwrap_or_else(|e| OnsetInterval::none(e.to_string()))
            }
            Err(reason) => OnsetInterval::None {
                reason: reason.clone(),
            },
        };
    }
    Ok(found)
}

/// The onset of a trained model.
fn without_interval(
    section: &SectionModel,
    model: &Model,
    search: &OnsetSearch,
    method: &str,
) -> PyResult<FlutterSearch> {
    let tested = Some(model.tested);
    let structure = section.structure().map_err(raised)?;
    match method {
        "eigenvalues" => {
            let coupled = CoupledSection::with_model(&structure, &model.model).map_err(raised)?;
            find_onset(&model.name, &coupled, search, tested)
        }
        "determinant" => determinant_onset(
            &model.name,
            &structure,
            &model.model,
            model.tested,
            search.speed_max_m_s,
        ),
        "pk" => pk_onset(&model.name, &structure, &model.model, search, tested),
        other => {
            let expected = "eigenvalues, determinant or pk";
            return Err(wrong("method", expected, format!("`{other}`")));
        }
    }
    .map_err(raised)
}
