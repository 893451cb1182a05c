//! What is known of the section of a study, as evidence for its verdict.

use super::intervals::{interval_of, saved_moved_onset, uncertainty_beside};
use super::{Deck, FlutterStudy, KnownUncertainty, Study, study_findings};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::quasi_steady::QuasiSteady;
use crate::aeroelastic::{CoupledSection, EquilibriumEnd, static_equilibria};
use crate::error::{Error, Result};
use crate::flutter::{
    FlutterSearch, Instability, OnsetMethod, OnsetSearch, QuasiSteadyOnset, find_onset,
    judged_speeds, table_tested_from,
};
use crate::plausibility::{self, of_trained};
use crate::section::{SectionModel, Structure};
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequency;
use crate::verdict::{
    CriticalSpeed, Divergence, Evidence, FlutterReading, ForceBasis, MeanRotation, Reach,
    StageFailure,
};
use std::path::Path;

/// Stages that draw and write, and the response to turbulence, without which the answer is the same.
const DRAWING: [&str; 3] = ["figure", "curves", "buffeting"];

/// Everything that the stages of a study have found on the section in the forces of its own model, whose onset is the answer and which the
/// data leave open as far as `known`; `None` where it was not trained.
pub(crate) fn section_evidence(
    study: &Study,
    deck: &Deck,
    results: &FlutterStudy,
    own: Option<&TrainedModel>,
    known: Option<&KnownUncertainty>,
    failed: &[StageFailure],
) -> Evidence {
    let name = own.map(|m| m.name.as_str());
    let mut implausible = [&deck.findings[..], &study_findings(study)[..]].concat();
    let odd =
        own.map(|m| plausibility::of_model(&m.name, &m.model, m.tested_range, &deck.findings));
    implausible.extend(odd.into_iter().flatten());
    let of_own = own.and_then(|m| of_model(study, results, m));
    let table = deck.own_model_name();
    let flutter = of_own.into_iter();
    let flutter = flutter.chain(of_deck(study, deck, results));
    let mut growth = results.growth.iter();
    let growth = growth.find(|g| Some(g.model.as_str()) == name);
    let of_answer = |model: &str| Some(model) == name || model == table;
    let divergence = results.divergence.iter();
    let divergence = divergence.filter(|d| of_answer(&d.forces));
    let divergence = divergence.map(|d| Divergence {
        forces: forces(&d.forces, &table),
        ..d.clone()
    });
    let mut evidence = Evidence {
        required: study.flutter.required(),
        flutter: flutter.collect(),
        searched_to_m_s: Some(study.speeds().searched_to_m_s),
        divergence: divergence.collect(),
        growth: growth.cloned(),
        failures: failures(study, failed, name),
        test_speeds: known.and_then(one_test_speed),
        implausible,
        tested_rotation_deg: deck.table().and_then(|t| t.header.rotation_amplitude_deg),
        remarks: deck.notes.clone(),
        ..Evidence::default()
    };
    if let (Some(block), Some(found)) = (&study.coefficients, &results.quasi_steady) {
        let angle_deg = deck.table().and_then(|t| t.header.angle_deg);
        let added = study.section.structure().and_then(|structure| {
            let theory = block.theory(&study.directory, &structure.dofs)?;
            let source = &block.source;
            add_coefficients(&mut evidence, source, &structure, &theory, found, angle_deg)
        });
        evidence.failures.extend(added.err().map(of_theory));
    }
    evidence
}

/// What the model of a file answers for a section by itself, with what training left beside the file: the onset with its interval,
/// divergence, growth, and what is odd about the section. The table it was fitted to is not known any more.
///
/// # Errors
/// [`Error::Input`] for a section that is wrong, and for files beside that of the model that are.
pub(crate) fn saved_evidence(
    file: &Path,
    model: &TrainedModel,
    section: &SectionModel,
    search: &OnsetSearch,
) -> Result<Evidence> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_owned(), folder.join("..")];
    let known = uncertainty_beside(file, model)?;
    let structure = section.structure()?;
    let coupled = CoupledSection::with_model(&structure, &model.model)?;
    let tested = model.tested_range;
    let mut found = find_onset(&model.name, &coupled, search, Some(tested))?;
    if let FlutterSearch::Onset(onset) = &mut found {
        onset.interval = interval_of(&structure, model, &known, onset);
        let known = known.as_ref().ok();
        let warning = known.and_then(|k| k.warning_of(&structure, onset));
        onset.warnings.extend(warning);
    }
    let constraints = saved_moved_onset(model, &folders, section, search, &found)?;
    let still = ReducedFrequency::from_full_width(0.0);
    let (at_rest, name) = (model.model.transfer(still)?, forces(&model.name, ""));
    Ok(Evidence {
        constraints,
        test_speeds: one_test_speed(&known),
        implausible: of_trained(section, model),
        ..Evidence::of_section(&name, &coupled, &at_rest, tested, search, found)
    })
}

fn forces(model: &str, table: &str) -> String {
    match model == table {
        true => format!("the {table}"),
        false => format!("the model “{model}”"),
    }
}

fn of_model(study: &Study, results: &FlutterStudy, model: &TrainedModel) -> Option<FlutterReading> {
    let reach = reach(study, results, model).unwrap_or_else(|_| Reach::nowhere());
    Some(FlutterReading {
        forces: forces(&model.name, ""),
        search: results.search_of(&model.name, OnsetMethod::Eigenvalues)?,
        basis: ForceBasis::tested(model.tested_range, reach),
    })
}

/// The speeds at which every mode of the section is among the tests of the model.
fn reach(study: &Study, results: &FlutterStudy, model: &TrainedModel) -> Result<Reach> {
    let section = CoupledSection::with_model(&study.section.structure()?, &model.model)?;
    let search = study.speeds().search();
    let (range, from) = judged_speeds(&section, &search, Some(model.tested_range))?;
    let curves = results.curves.iter().find(|c| c.model == model.name);
    let curves = curves.ok_or_else(|| Error::Numerical("no modes".to_owned()))?;
    Ok(Reach::new(range, from, curves, study.section.width_m))
}

fn of_deck(study: &Study, deck: &Deck, results: &FlutterStudy) -> Option<FlutterReading> {
    let (table, tested) = deck.model().ok()?;
    let name = &deck.own_model_name();
    Some(FlutterReading {
        forces: forces(name, name),
        search: results.search_of(name, OnsetMethod::Determinant)?,
        basis: match tested {
            // a table is searched no further than it reaches
            Some(range) => {
                let structure = study.section.structure().ok()?;
                let from = table_tested_from(&structure, &*table, range).ok()?;
                ForceBasis::tested(range, Reach::of_table(from))
            }
            None => ForceBasis::Exact,
        },
    })
}

fn failures(study: &Study, failed: &[StageFailure], own: Option<&str>) -> Vec<StageFailure> {
    let names = study.models.iter().map(|m| m.name.as_str());
    let others: Vec<&str> = names.filter(|m| Some(*m) != own).collect();
    let is_beside = |stage: &str| {
        let draws = DRAWING.iter().any(|d| stage.starts_with(d));
        let of_another = own.is_some() && others.iter().any(|m| stage.ends_with(&format!(" {m}")));
        draws || of_another
    };
    let all = failed.iter().map(|f| StageFailure {
        beside_answer: is_beside(&f.stage),
        ..f.clone()
    });
    all.collect()
}

/// 1 where the tests behind an interval are at one mean speed; else not known here.
fn one_test_speed(known: &KnownUncertainty) -> Option<usize> {
    let known = known.as_ref().ok()?;
    (known.onset.is_some() && known.speeds.each.is_empty()).then_some(1)
}

/// Quasi-steady theory beside the derivatives that failed.
pub(super) fn of_theory(error: Error) -> StageFailure {
    StageFailure::new("quasi-steady theory", error)
}

/// What static coefficients say beside the derivatives: galloping, divergence about the equilibrium, mean rotation.
pub(super) fn add_coefficients(
    evidence: &mut Evidence,
    source: &str,
    structure: &Structure,
    theory: &QuasiSteady,
    found: &QuasiSteadyOnset,
    tested_deg: Option<f64>,
) -> Result<()> {
    let forces = format!("static coefficients ({source})");
    let kind = found.mode.as_ref().map(|m| m.kind);
    let gallops = kind
        .is_some_and(|kind| matches!(kind, Instability::Galloping | Instability::LateralGalloping));
    if let Some(speed_m_s) = found.search.critical_speed_m_s() {
        // quasi-steady theory of coupled motions is no answer beside derivatives
        if gallops || found.search.onset().is_none() {
            evidence.galloping = Some(CriticalSpeed::galloping(&forces, speed_m_s));
        } else {
            let said = format!("By {forces}: {}", found.search.explain());
            evidence.remarks.push(said);
        }
    }
    match found.equilibrium_end {
        Some(EquilibriumEnd::Divergence { speed_m_s, .. }) => {
            evidence.divergence.push(Divergence {
                measured: true,
                ..Divergence::at(&forces, Some(speed_m_s))
            });
        }
        Some(end @ EquilibriumEnd::OutsideTable { .. }) => {
            let said = format!("By {forces}: {}", end.explain());
            evidence.remarks.push(said);
        }
        None => {}
    }
    let first = evidence.flutter.first();
    let critical = first.and_then(|r| r.search.critical_speed_m_s());
    // without an onset the speed that is required is the one that counts
    if let Some(speed) = critical.or(evidence.required.map(|r| r.speed_m_s)) {
        let path = static_equilibria(structure, theory, &[speed])?;
        evidence.mean_rotation = path.points.first().map(|p| MeanRotation {
            speed_m_s: speed,
            rotation_deg: p.rotation_rad.to_degrees(),
            tested_deg,
        });
    }
    Ok(())
}

impl FlutterStudy {
    /// The answer of one search.
    pub(crate) fn search_of(&self, model: &str, method: OnsetMethod) -> Option<FlutterSearch> {
        let own = |name: &str, by: OnsetMethod| name == model && by == method;
        let mut onsets = self.onsets.iter().chain(&self.undetermined);
        if let Some(onset) = onsets.find(|o| own(&o.at.model, o.at.method)) {
            return Some(FlutterSearch::Onset(Box::new(onset.clone())));
        }
        let mut starts = self.unstable.iter();
        if let Some(start) = starts.find(|s| own(&s.at.model, s.at.method)) {
            return Some(FlutterSearch::UnstableAtOrBelow(Box::new(start.clone())));
        }
        let mut stable = self.stable.iter();
        let stable = stable.find(|s| own(&s.model, s.method))?;
        Some(FlutterSearch::StableUpTo(stable.range()))
    }
}
