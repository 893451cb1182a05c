//! Every route answers one of: onset, unstable at and below the lowest speed that could be judged, no flutter; on decks and
//! sections that do not flutter by the book.

use crate::matrix;
use crate::three_dof;
use aerodeck::aerodynamics::derivatives::Derivative;
use aerodeck::aerodynamics::derivatives::DerivativeTable;
use aerodeck::aerodynamics::derivatives::Extrapolation;
use aerodeck::aerodynamics::derivatives::InterpolatedTable;
use aerodeck::aerodynamics::{FlatPlate, RationalModel};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{
    FlutterSearch, LinearForces, OnsetSearch, OnsetSweep, SweepOutcome, UnstableStart,
    determinant_onset, find_onset, pk_curves, pk_onset, quasi_pk_mode, trace_modes,
};
use aerodeck::identification::{Fitted, Form, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel, Structure};
use aerodeck::trained_model::Model;
use aerodeck::uncertainty::monte_carlo::{MonteCarloPlan, monte_carlo};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};

const SEARCH: OnsetSearch = OnsetSearch {
    speed_max_m_s: 60.0,
    speeds: 120,
};

fn held(table: &DerivativeTable) -> InterpolatedTable {
    InterpolatedTable::new(table, &Dof::TWO, Extrapolation::Hold).unwrap()
}

/// The points of a deck at `K` up to a limit.
fn cut(deck: &str, k_max: f64) -> DerivativeTable {
    let table = embedded::deck(deck).unwrap();
    let points = Derivative::ALL
        .into_iter()
        .map(|d| {
            let kept = table.points(d).iter().filter(|p| 1.0 / p.v_hat <= k_max);
            (d, kept.copied().collect::<Vec<_>>())
        })
        .filter(|(_, points)| !points.is_empty())
        .collect();
    DerivativeTable::new(deck, table.width_m, table.header.clone(), points).unwrap()
}

fn unstable(found: &FlutterSearch) -> &UnstableStart {
    let FlutterSearch::UnstableAtOrBelow(start) = found else {
        panic!("{found:?}")
    };
    start
}

/// Determinant and p-k on a table; both say the same, the speed to the difference between growing motions: 1.3 % for the
/// fastest growth here, 8 % of critical.
#[track_caller]
fn both_unstable(table: &DerivativeTable, structure: &Structure) -> f64 {
    let model = held(table);
    let range = model.tested_range();
    let by_determinant = determinant_onset("", structure, &model, range, 60.0).unwrap();
    let by_iteration = pk_onset("", structure, &model, &SEARCH, Some(range)).unwrap();
    let (a, b) = (unstable(&by_determinant), unstable(&by_iteration));
    assert!(
        (a.at.speed_m_s / b.at.speed_m_s - 1.0).abs() < 0.02,
        "{a:?} {b:?}"
    );
    assert_eq!((&a.branch, a.in_tested_range), (&b.branch, Some(true)));
    let at_end = range.max.full_width() / b.at.reduced_frequency.full_width() - 1.0;
    assert!(at_end.abs() < 1e-9, "{b:?}");
    b.at.speed_m_s
}

#[test]
fn a_bluff_deck_is_unstable_where_its_table_begins_by_every_route() {
    let table = matrix::bluff_table();
    let section = SectionModel::table_4_1();
    let structure = section.structure().unwrap();
    let speed = both_unstable(&table, &structure);
    // the model behind the table: its onset lies below, where nothing was tested
    let bluff = matrix::bluff_model();
    let coupled = CoupledSection::with_model(&structure, &bluff).unwrap();
    let range = held(&table).tested_range();
    let exact = find_onset("", &coupled, &SEARCH, None).unwrap();
    let onset = exact.onset().unwrap().at.speed_m_s;
    assert!((1.4..1.6).contains(&onset), "{onset}");
    let judged = find_onset("", &coupled, &SEARCH, Some(range)).unwrap();
    let start = unstable(&judged);
    assert!(
        (start.at.speed_m_s / speed - 1.0).abs() < 0.02,
        "{start:?} {speed}"
    );
    assert!(
        start
            .warnings
            .iter()
            .any(|w| w.contains("outside the tested range"))
    );
    let said = judged.explain();
    assert!(said.starts_with(&format!(
        "unstable at and below {:.3} m/s",
        start.at.speed_m_s
    )));
    let iterated = pk_onset("", &structure, &bluff, &SEARCH, Some(range)).unwrap();
    assert!((unstable(&iterated).at.speed_m_s / speed - 1.0).abs() < 0.02);
    // and the sweep behind Monte Carlo, with and without a tested range
    let sweep = |tested| {
        let forces = LinearForces::of_rational(&bluff, tested);
        let coefficients = forces.coefficients().to_vec();
        let sweep = OnsetSweep::new(forces, &structure, 60.0).unwrap();
        sweep.onset(&section, &coefficients).unwrap()
    };
    let SweepOutcome::UnstableAtOrBelow(start) = sweep(Some(range)) else {
        panic!("{:?}", sweep(Some(range)))
    };
    assert!((start.speed_m_s / speed - 1.0).abs() < 0.02, "{start:?}");
    let SweepOutcome::Onset(swept) = sweep(None) else {
        panic!("{:?}", sweep(None))
    };
    assert!(
        (swept.speed_m_s / onset - 1.0).abs() < 1e-9,
        "{swept:?} {onset}"
    );
}

#[test]
fn cut_tables_are_unstable_where_they_begin() {
    let structure = SectionModel::table_4_1().structure().unwrap();
    for (deck, k_max) in [("LN21-6100", 0.4), ("LN21-5200", 0.3)] {
        let full = held(&embedded::deck(deck).unwrap());
        let range = full.tested_range();
        let whole = determinant_onset("", &structure, &full, range, 60.0).unwrap();
        let onset = whole.onset().unwrap().at.speed_m_s;
        let speed = both_unstable(&cut(deck, k_max), &structure);
        assert!(
            onset < speed && speed < 2.0 * onset,
            "{deck}: {onset} {speed}"
        );
    }
}

/// A mode that is fed at every speed and has no damping of its own grows from still air on.
#[test]
fn a_section_unstable_at_rest_has_no_onset() {
    let mut section = SectionModel::table_4_1();
    section.vertical.damping_ratio = 0.0;
    section.torsion.damping_ratio = 0.0;
    let structure = section.structure().unwrap();
    let bluff = matrix::bluff_model();
    let coupled = CoupledSection::with_model(&structure, &bluff).unwrap();
    let found = find_onset("", &coupled, &SEARCH, None).unwrap();
    assert!(unstable(&found).at.speed_m_s < 0.1, "{found:?}");
    assert_eq!(unstable(&found).branch, "torsion");
    let found = pk_onset("", &structure, &bluff, &SEARCH, None).unwrap();
    assert!(unstable(&found).at.speed_m_s < 0.1, "{found:?}");
    let forces = LinearForces::of_rational(&bluff, None);
    let coefficients = forces.coefficients().to_vec();
    let sweep = OnsetSweep::new(forces, &structure, 60.0).unwrap();
    let swept = sweep.onset(&section, &coefficients).unwrap();
    assert!(matches!(swept, SweepOutcome::UnstableAtOrBelow(s) if s.speed_m_s < 0.1));
    // the flat plate damps every motion: without structural damping it flutters like any other
    let jones = RationalModel::jones_flat_plate();
    let plate = CoupledSection::with_model(&structure, &jones).unwrap();
    let found = find_onset("", &plate, &SEARCH, None).unwrap();
    assert!(found.onset().unwrap().at.speed_m_s > 30.0, "{found:?}");
    // a structure that feeds itself
    let mut fed = SectionModel::table_4_1().structure().unwrap();
    fed.damping[(1, 1)] *= -1.0;
    let coupled = CoupledSection::with_model(&fed, &jones).unwrap();
    let tested = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.1),
        ReducedFrequency::from_full_width(1.0),
    );
    let found = find_onset("", &coupled, &SEARCH, None).unwrap();
    assert!(unstable(&found).at.speed_m_s < 0.1, "{found:?}");
    let found = find_onset("", &coupled, &SEARCH, Some(tested)).unwrap();
    assert!(found.critical_speed_m_s().is_some(), "{found:?}");
}

/// What is not looked at is not called stable.
#[test]
fn no_flutter_is_said_only_of_what_was_judged() {
    let table = cut("LN21-5200", 2.0);
    let model = held(&table);
    let range = model.tested_range();
    let mut section = SectionModel::table_4_1();
    // stiff enough not to flutter within the table
    section.torsion.frequency_hz = Some(15.0);
    let structure = section.structure().unwrap();
    for found in [
        determinant_onset("", &structure, &model, range, 100.0).unwrap(),
        pk_onset(
            "",
            &structure,
            &model,
            &OnsetSearch {
                speed_max_m_s: 100.0,
                speeds: 200,
            },
            Some(range),
        )
        .unwrap(),
    ] {
        let FlutterSearch::StableUpTo(judged) = &found else {
            panic!("{found:?}")
        };
        // torsion comes in at V = ωB/K_max, heave leaves at ωB/K_min
        assert!(judged.from_m_s > 10.0 && judged.to_m_s < 95.0, "{judged:?}");
        let said = found.explain();
        assert!(said.contains("judged from"), "{said}");
        assert!(
            said.contains("torsion") && said.contains("vertical"),
            "{said}"
        );
    }
}

/// With the same frequencies in still air, modes cannot be told apart; the answer comes all the same.
#[test]
fn modes_that_cannot_be_told_apart_do_not_end_the_search() {
    let mut section = SectionModel::table_4_1();
    section.lateral = Some(section.vertical.clone());
    let structure = section.structure().unwrap();
    let table = embedded::deck("LN21-5200").unwrap();
    let fit = FrequencyFit::default();
    let Fitted { model, report } =
        fit_table(&table.samples(&Dof::THREE), &Dof::THREE, &fit).unwrap();
    let coupled = CoupledSection::with_model(&structure, &model).unwrap();
    let found = find_onset("", &coupled, &SEARCH, Some(report.tested_range)).unwrap();
    let onset = found.onset().unwrap();
    assert!((30.0..45.0).contains(&onset.at.speed_m_s), "{onset:?}");
}

/// A branch keeps its shape: at speeds at which heave is overdamped its branch ends instead of becoming another.
#[test]
fn a_branch_never_becomes_another() {
    let named = matrix::sections_of_three();
    let table = embedded::deck("LN21-5200").unwrap();
    let model = InterpolatedTable::new(&table, &Dof::THREE, Extrapolation::Hold).unwrap();
    for case in &named {
        let structure = case.section.structure().unwrap();
        let speed_max = if structure.width_m > 10.0 {
            110.0
        } else {
            60.0
        };
        let speeds: Vec<f64> = (1..=120)
            .map(|i| speed_max * f64::from(i) / 120.0)
            .collect();
        let curves = pk_curves("", &structure, &model, &speeds).unwrap();
        let fit = FrequencyFit::default();
        let fitted = fit_table(&table.samples(&Dof::THREE), &Dof::THREE, &fit)
            .unwrap()
            .model;
        let section = CoupledSection::with_model(&structure, &fitted).unwrap();
        let traced = trace_modes("", &section, &speeds).unwrap();
        for curves in [&curves, &traced] {
            for branch in &curves.branches {
                for pair in branch.points.windows(2) {
                    let dot: nalgebra::Complex<f64> = pair[0]
                        .shape
                        .iter()
                        .zip(&pair[1].shape)
                        .zip(&structure.dofs)
                        .map(|((a, b), dof)| {
                            let scale = dof.motion_scale(structure.width_m).powi(2);
                            let (a, b) = (
                                nalgebra::Complex::new(a.re, a.im),
                                nalgebra::Complex::new(b.re, b.im),
                            );
                            a.conj() * b * scale
                        })
                        .sum();
                    assert!(
                        dot.norm_sqr() > 0.5,
                        "{}, {} branch from {} to {} m/s: {}",
                        case.name,
                        branch.name,
                        pair[0].speed_m_s,
                        pair[1].speed_m_s,
                        dot.norm_sqr()
                    );
                }
            }
        }
    }
}

/// The iteration from the natural frequency finds some root; the branch followed from still air is the one asked for.
#[test]
fn a_single_mode_is_that_of_its_branch() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let plate = FlatPlate::default();
    let speeds: Vec<f64> = (1..=100).map(f64::from).collect();
    let curves = pk_curves("", &structure, &plate, &speeds).unwrap();
    for (dof, branch) in curves.branches.iter().enumerate() {
        for point in branch.points.iter().step_by(20) {
            let mode = quasi_pk_mode(&structure, &plate, point.speed_m_s, dof).unwrap();
            assert!((mode.im - point.eigenvalue.im).abs() < 1e-7 * mode.norm());
        }
        // where a branch has ended it says so
        if branch.points.len() < speeds.len() {
            let said = quasi_pk_mode(&structure, &plate, 100.0, dof).unwrap_err();
            assert!(said.to_string().contains(&branch.name), "{said}");
        }
    }
}

/// Points of curves know whether their reduced frequency was tested.
#[test]
fn points_of_curves_know_whether_they_were_tested() {
    let table = embedded::deck("LN21-5200").unwrap();
    let fit = FrequencyFit::default();
    let Fitted { model, report } = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).unwrap();
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::with_model(&structure, &model).unwrap();
    let speeds: Vec<f64> = (1..=50).map(f64::from).collect();
    let curves = trace_modes("", &section, &speeds)
        .unwrap()
        .marked(structure.width_m, Some(report.tested_range));
    for point in curves.branches.iter().flat_map(|b| &b.points) {
        let k =
            ReducedFrequency::from_hertz(point.frequency_hz, structure.width_m, point.speed_m_s);
        assert_eq!(point.in_tested_range, Some(report.tested_range.contains(k)));
    }
    assert!(curves.branches[1].points[0].in_tested_range == Some(false));
}

const PLAN: &str = "schema = 1\nmodel = \"model.json\"\nsamples = 500\nspeed_max_m_s = 60.0\n\
    [[parameter]]\nname = \"torsion.damping_ratio\"\n\
    distribution = { kind = \"lognormal\", coefficient_of_variation = 0.2 }\n";

/// Samples that grow where they could be judged first are flutter: below a design speed above that speed all of them, below
/// a lower one perhaps.
#[test]
fn unstable_samples_are_not_safe() {
    let mut model = three_dof::trained(Form::default(), 3.9);
    model.section = SectionModel::table_4_1();
    model.model = Model::Rational(matrix::bluff_model());
    model.tested_range = held(&matrix::bluff_table()).tested_range();
    for (design, known) in [(20.0, true), (3.0, false)] {
        let text = PLAN.replace(
            "[[parameter]]",
            &format!("design_speed_m_s = {design:.1}\n[[parameter]]"),
        );
        let plan = MonteCarloPlan::from_toml(&text, "".into()).unwrap();
        let result = monte_carlo(&plan, &model, &|_, _| ()).unwrap();
        assert_eq!((result.unstable_at_or_below, result.stable), (500, 0));
        assert!(result.nominal_or_below && result.nominal_m_s.is_some());
        // 500 samples do not tell 0.1 %
        let told = result.quantiles.iter().filter(|q| !q.too_few_samples);
        assert!(told.clone().count() >= 5 && told.clone().all(|q| q.or_below));
        let check = result.design.unwrap();
        let counted = if known { (500, 0) } else { (0, 500) };
        assert_eq!((check.below, check.undecided), counted);
        assert_eq!((check.probability, check.upper), (1.0, 1.0));
        assert_eq!(check.lower > 0.9, known, "{check:?}");
    }
}
