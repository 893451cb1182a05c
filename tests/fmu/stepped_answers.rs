//! Stepping the exported FMU answers as the eigenvalues do, also where it used to give up.

use crate::matrix;
use crate::three_dof;
use aerodeck::aerodynamics::RationalModel;
use aerodeck::flutter::{FlutterSearch, OnsetSearch, divergence_by_eigenvalues, find_onset};
use aerodeck::fmu::importer::Fmu;
use aerodeck::fmu::importer::{SteppedSearch, onset_by_stepping};
use aerodeck::fmu::package::{Export, Runtime, write_fmu};
use aerodeck::identification::Form;
use aerodeck::section::SectionModel;
use aerodeck::study::stepped_onset;
use aerodeck::trained_model::{Model, TrainedModel};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};

fn wide() -> ReducedFrequencyRange {
    ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.01),
        ReducedFrequency::from_full_width(100.0),
    )
}

fn rational(model: RationalModel, section: SectionModel) -> TrainedModel {
    let mut trained = three_dof::trained(Form::default(), 3.9);
    trained.name = "stepped".into();
    trained.model = Model::Rational(model);
    trained.section = section;
    trained.tested_range = wide();
    trained
}

fn answers(model: &TrainedModel, speed_max: f64) -> (FlutterSearch, FlutterSearch) {
    let section = three_dof::coupled(model);
    let search = OnsetSearch {
        speed_max_m_s: speed_max,
        ..OnsetSearch::default()
    };
    let expected = find_onset("", &section, &search, Some(model.tested_range)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stepped.fmu");
    let runtimes = [Runtime::embedded().unwrap()];
    write_fmu(
        &path,
        model,
        &runtimes,
        false,
        Export {
            allow_unstable: true,
            ..Export::default()
        },
    )
    .unwrap();
    let (stepped, _) = stepped_onset(model, &path, speed_max).unwrap();
    (expected, stepped)
}

#[track_caller]
fn same_onset(model: &TrainedModel, speed_max: f64) {
    let (expected, found) = answers(model, speed_max);
    let section = three_dof::coupled(model);
    let divergence = divergence_by_eigenvalues(&section, speed_max).unwrap();
    match (&expected, &found) {
        (FlutterSearch::Onset(a), FlutterSearch::Onset(b)) => {
            let off = b.at.speed_m_s / a.at.speed_m_s - 1.0;
            assert!(off.abs() < 1e-4, "{a:?} {b:?}");
        }
        // stepping ends where divergence hides every oscillation, and says so
        (FlutterSearch::Onset(a), FlutterSearch::StableUpTo(b)) => {
            assert!(
                divergence.is_some_and(|v| v < a.at.speed_m_s),
                "{a:?} {b:?}"
            );
            assert!(b.not_judged.is_some() && b.to_m_s < a.at.speed_m_s);
        }
        (FlutterSearch::StableUpTo(_), FlutterSearch::StableUpTo(_)) => {}
        (FlutterSearch::UnstableAtOrBelow(a), FlutterSearch::UnstableAtOrBelow(b)) => {
            assert!(
                (b.at.speed_m_s / a.at.speed_m_s - 1.0).abs() < 0.01,
                "{a:?} {b:?}"
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn torsion_slower_than_heave() {
    let mut section = SectionModel::table_4_1();
    section.vertical.frequency_hz = Some(2.0);
    section.torsion.frequency_hz = Some(1.0);
    same_onset(&rational(RationalModel::jones_flat_plate(), section), 40.0);
}

#[test]
fn a_slow_lateral_mode() {
    for lateral_hz in [1.0, 3.9] {
        same_onset(&three_dof::trained(Form::default(), lateral_hz), 60.0);
    }
}

/// The bluff deck: its onset lies far below the speed at which the search begins.
#[test]
fn growth_at_the_first_speed_sends_the_search_down() {
    let model = rational(matrix::bluff_model(), SectionModel::table_4_1());
    let (expected, found) = answers(&model, 60.0);
    let (a, b) = (expected.onset().unwrap(), found.onset().unwrap());
    assert!((b.at.speed_m_s / a.at.speed_m_s - 1.0).abs() < 1e-4);
    // tested from K = 1 down: unstable at and below the speed that belongs to it, by both
    let mut tested = model;
    tested.tested_range.max = ReducedFrequency::from_full_width(1.0);
    let (expected, found) = answers(&tested, 60.0);
    let FlutterSearch::UnstableAtOrBelow(a) = expected else {
        panic!("{expected:?}")
    };
    let FlutterSearch::UnstableAtOrBelow(b) = found else {
        panic!("{found:?}")
    };
    assert!(
        (b.at.speed_m_s / a.at.speed_m_s - 1.0).abs() < 1e-3,
        "{a:?} {b:?}"
    );
}

/// Without damping of its own the bluff deck grows in every wind.
#[test]
fn growth_at_every_speed_is_an_answer() {
    let mut section = SectionModel::table_4_1();
    section.vertical.damping_ratio = 0.0;
    section.torsion.damping_ratio = 0.0;
    let model = rational(matrix::bluff_model(), section);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stepped.fmu");
    let runtimes = [Runtime::embedded().unwrap()];
    write_fmu(
        &path,
        &model,
        &runtimes,
        false,
        Export {
            allow_unstable: true,
            ..Export::default()
        },
    )
    .unwrap();
    let fmu = Fmu::open(&path).unwrap();
    let found = onset_by_stepping(&fmu, 5.0, 30.0, 0.01).unwrap();
    let SteppedSearch::UnstableAtOrBelow(point) = found else {
        panic!("{found:?}")
    };
    assert!(
        point.speed_m_s < 0.1 && point.growth_rate_per_s > 0.0,
        "{point:?}"
    );
}
