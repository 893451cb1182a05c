//! How wide a gap between tested `K` may be: what reading smooth forces across it does to the onset.

use aerodeck::aerodynamics::derivatives::{DerivativeTable, Extrapolation, InterpolatedTable};
use aerodeck::aerodynamics::{FlatPlate, Lags, RationalModel, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{
    FlutterSearch, LinearForces, Onset, OnsetSearch, OnsetSweep, SweepOutcome, determinant_onset,
    find_onset, judged_speeds, left_tests, pk_onset,
};
use aerodeck::identification::{Fitted, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel, Structure};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};

/// Ratio of neighbouring tested `K` outside the gap.
const CLOSE: f64 = 1.25;
/// Lowest and highest tested `K` over that of the onset.
const REACH: f64 = 5.0;

const SEARCH: OnsetSearch = OnsetSearch {
    speed_max_m_s: 60.0,
    speeds: 120,
};

fn k(value: f64) -> ReducedFrequency {
    ReducedFrequency::from_full_width(value)
}

/// The flat plate, Jones's approximation, and decks that differ from it by up to a third in every coefficient, the last six
/// with a lag that feeds rotation in slow motion.
fn truths() -> Vec<Box<dyn Transfer>> {
    let mut all: Vec<Box<dyn Transfer>> = vec![
        Box::new(FlatPlate::default()),
        Box::new(RationalModel::jones_flat_plate()),
    ];
    let mut state = 5_u64;
    let mut factor = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        1.0 + 0.33 * ((state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0)
    };
    for i in 1..=9 {
        let mut model = RationalModel::jones_flat_plate();
        model.a1.apply(|x| *x *= factor());
        model.a2.apply(|x| *x *= factor());
        for lag in &mut model.lag_terms {
            lag.apply(|x| *x *= factor());
        }
        if i > 3 {
            let mut lag = model.lag_terms[0].clone() * 0.0;
            lag[(1, 1)] = 0.4 * factor();
            model.lag_terms.push(lag);
            model.lags = Lags::Shared(vec![0.091, 0.6, 0.15 * factor()]);
        }
        all.push(Box::new(model));
    }
    all
}

fn exact(structure: &Structure, truth: &dyn Transfer) -> Onset {
    let range = ReducedFrequencyRange::between(k(0.02), k(10.0));
    let found = determinant_onset("", structure, truth, range, 300.0).unwrap();
    found.onset().unwrap().clone()
}

/// A table with tests close to each other but for a gap of this ratio with the onset at `part` of it.
fn table(truth: &dyn Transfer, onset: f64, ratio: f64, part: f64) -> DerivativeTable {
    let (below, above) = (onset * ratio.powf(-part), onset * ratio.powf(1.0 - part));
    let mut ks = Vec::new();
    let (mut low, mut high) = (below, above);
    while low > onset / REACH {
        ks.push(low);
        low /= CLOSE;
    }
    while high < onset * REACH {
        ks.push(high);
        high *= CLOSE;
    }
    // reduced velocities rise
    ks.sort_by(|a, b| b.total_cmp(a));
    let frequencies: Vec<f64> = ks.iter().map(|k| k / std::f64::consts::TAU).collect();
    DerivativeTable::sampled("truth", truth, 1.0, &[1.0], &frequencies).unwrap()
}

/// What a gap costs a table on smooth truths, per cent of the onset: the worst of them, with the onset anywhere in it.
fn cost(ratio: f64) -> f64 {
    let mut worst = 0.0f64;
    for section in [SectionModel::table_4_1(), SectionModel::iabse_1_1a()] {
        let structure = section.structure().unwrap();
        for truth in truths() {
            let onset = exact(&structure, truth.as_ref());
            let at = onset.at.reduced_frequency.full_width();
            for part in [0.3, 0.5, 0.7] {
                let table = table(truth.as_ref(), at, ratio, part);
                let found = by_table(&table, &structure, 300.0);
                let speed = found.onset().unwrap().at.speed_m_s;
                worst = worst.max(100.0 * (speed / onset.at.speed_m_s - 1.0).abs());
            }
        }
    }
    worst
}

fn by_table(table: &DerivativeTable, structure: &Structure, speed_max_m_s: f64) -> FlutterSearch {
    let model = InterpolatedTable::new(table, &Dof::TWO, Extrapolation::Refuse).unwrap();
    let range = model.tested_range();
    determinant_onset("", structure, &model, range, speed_max_m_s).unwrap()
}

/// The widest step that counts as tested, a ratio of 2, costs 0.90 %; of 2.5 1.66 %.
#[test]
fn the_widest_step_between_tests_costs_a_per_cent() {
    let (widest, wider) = (cost(2.0), cost(2.5));
    assert!((0.8..1.0).contains(&widest), "{widest}");
    assert!(wider > 1.5, "{wider}");
}

/// Table, fit and sweep say that an onset lies in a gap, and between which tests.
#[test]
fn an_onset_in_a_gap_is_said_to_lie_there() {
    let section = SectionModel::table_4_1();
    let structure = section.structure().unwrap();
    let truth = RationalModel::jones_flat_plate();
    let at = exact(&structure, &truth).at.reduced_frequency.full_width();
    for (ratio, inside) in [(1.9, true), (3.0, false)] {
        let table = table(&truth, at, ratio, 0.5);
        let fit = FrequencyFit::default();
        let Fitted { model, report } =
            fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).unwrap();
        let tested = Some(report.tested_range);
        let coupled = CoupledSection::with_model(&structure, &model).unwrap();
        let by_model = find_onset("", &coupled, &SEARCH, tested).unwrap();
        for found in [by_table(&table, &structure, 60.0), by_model] {
            let onset = found.onset().unwrap();
            assert_eq!(onset.in_tested_range, Some(inside), "{onset:?}");
            let gap = onset
                .gap
                .map(|g| (g.from.full_width() / at, g.to.full_width() / at));
            assert_eq!(gap.is_none(), inside, "{gap:?}");
            if let Some((from, to)) = gap {
                assert!((from * ratio.sqrt() - 1.0).abs() < 1e-12);
                assert!((to / ratio.sqrt() - 1.0).abs() < 1e-12);
                assert!(
                    onset
                        .headline()
                        .contains("in a gap between the tested K 0.")
                );
                assert!(
                    onset
                        .warnings
                        .iter()
                        .any(|w| w.contains("in a gap between"))
                );
            }
        }
        let forces = LinearForces::of_rational(&truth, tested);
        let coefficients = forces.coefficients().to_vec();
        let sweep = OnsetSweep::new(forces, &structure, 60.0).unwrap();
        let swept = sweep.onset(&section, &coefficients).unwrap();
        assert!(matches!(swept, SweepOutcome::Onset(o) if o.in_tested_range == inside));
    }
}

/// A deck tested at K of 1.25 and more only, with an onset at 28 m/s that nothing there shows: no route calls it stable beyond
/// the speed at which its slowest mode comes to K 1.25, about 5 m/s.
#[test]
fn what_was_not_tested_is_not_called_stable() {
    let mut truth = RationalModel::jones_flat_plate();
    let mut lag = truth.lag_terms[0].clone() * 0.0;
    lag[(1, 1)] = 1.2;
    truth.lag_terms.push(lag);
    truth.lags = Lags::Shared(vec![0.091, 0.6, 0.05]);
    let section = SectionModel::table_4_1();
    let structure = section.structure().unwrap();
    let ks: Vec<f64> = (0..10).map(|i| 1.25 * 1.2f64.powi(9 - i)).collect();
    let frequencies: Vec<f64> = ks.iter().map(|k| k / std::f64::consts::TAU).collect();
    let table = DerivativeTable::sampled("", &truth, 1.0, &[1.0], &frequencies).unwrap();
    let fit = FrequencyFit::default();
    let Fitted { model, report } = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).unwrap();
    let range = report.tested_range;
    let coupled = CoupledSection::with_model(&structure, &model).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 25.0,
        speeds: 120,
    };
    let by_eigenvalues = find_onset("", &coupled, &search, Some(range)).unwrap();
    // the slowest mode by its eigenvalue alone
    let k_of_slowest = |speed: f64| {
        let all = coupled.at(speed).unwrap().eigenvalues().unwrap();
        // the air alone oscillates too, but its motion has died within a period
        let motions = all.iter().filter(|z| z.im > 1.0 && z.re > -0.5 * z.im);
        let slowest = motions.map(|z| z.im);
        slowest.fold(f64::INFINITY, f64::min) * structure.width_m / speed
    };
    let judged = |found: &FlutterSearch| {
        let FlutterSearch::StableUpTo(judged) = found else {
            panic!("{found:?}")
        };
        let said = found.explain();
        assert!(!said.contains("25.0"), "{said}");
        assert!(said.contains("can be judged up to 5.0"), "{said}");
        assert!(said.contains("above that these data say nothing"), "{said}");
        judged.to_m_s
    };
    let limit = judged(&by_eigenvalues);
    assert!((k_of_slowest(limit) / 1.25 - 1.0).abs() < 1e-3, "{limit}");
    for found in [
        pk_onset("", &structure, &model, &search, Some(range)).unwrap(),
        determinant_onset("", &structure, &model, range, 25.0).unwrap(),
        by_table(&table, &structure, 25.0),
    ] {
        // away from an onset the frequency of a damped motion is a little different by each route
        assert!((judged(&found) / limit - 1.0).abs() < 0.01, "{found:?}");
    }
    let forces = LinearForces::of_rational(&truth, Some(range));
    let sweep = OnsetSweep::new(forces, &structure, 25.0).unwrap();
    let swept = sweep
        .onset(&section, sweep.forces().coefficients())
        .unwrap();
    let SweepOutcome::Stable { judged_to_m_s } = swept else {
        panic!("{swept:?}")
    };
    assert!(
        (judged_to_m_s / limit - 1.0).abs() < 0.01,
        "{judged_to_m_s}"
    );
}

/// Near divergence, where a motion slows down, the limit moved by 0.2 m/s with the highest speed of the search.
#[test]
fn where_a_mode_leaves_the_tests_does_not_depend_on_the_search() {
    let mut section = SectionModel::table_4_1();
    section.torsion.frequency_hz = Some(1.0);
    let structure = section.structure().unwrap();
    let model = RationalModel::jones_flat_plate();
    let coupled = CoupledSection::with_model(&structure, &model).unwrap();
    let range = ReducedFrequencyRange::between(k(0.05), k(3.0));
    let limits = [15.0, 24.0, 80.0, 120.0].map(|speed_max_m_s| {
        let search = OnsetSearch {
            speed_max_m_s,
            speeds: 200,
        };
        judged_speeds(&coupled, &search, Some(range))
            .unwrap()
            .0
            .to_m_s
    });
    assert!(limits[0] < 15.0);
    assert!(
        limits.iter().all(|v| (v / limits[0] - 1.0).abs() < 1e-9),
        "{limits:?}"
    );
}

/// Where a mode stops oscillating does not depend on the speeds that were looked at, and its `K` may pass the end of the tests on the way.
#[test]
fn a_mode_is_judged_up_to_where_it_stops_oscillating() {
    let mut section = SectionModel::table_4_1();
    // soft: it turns ever more slowly up to its divergence
    section.torsion.frequency_hz = Some(1.0);
    let structure = section.structure().unwrap();
    let coupled = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate());
    let coupled = coupled.unwrap();
    for lowest in [1e-6, 0.05] {
        let range = ReducedFrequencyRange::between(k(lowest), k(100.0));
        let judged = [37, 120, 411].map(|speeds| {
            let search = OnsetSearch { speeds, ..SEARCH };
            judged_speeds(&coupled, &search, Some(range)).unwrap().0
        });
        let words = judged.each_ref().map(|range| range.not_judged.as_deref());
        let why = if lowest > 1e-3 {
            "the lowest tested"
        } else {
            "cannot be followed"
        };
        assert!(
            words.iter().all(|w| w.is_some_and(|w| w.contains(why))),
            "{words:?}"
        );
        let to = judged.map(|range| range.to_m_s);
        assert!(to.iter().all(|v| (v - to[0]).abs() < 1e-3), "{to:?}");
    }
}

/// An FMU looks at four winds on the way to an onset, a search at two hundred.
#[test]
fn four_winds_on_the_way_see_what_a_search_sees() {
    let plate = RationalModel::jones_flat_plate();
    let whole = ReducedFrequencyRange::between(k(0.1), k(6.0));
    let parts =
        [(0.02, 0.05), (0.12, 6.0)].map(|(a, b)| ReducedFrequencyRange::between(k(a), k(b)));
    let with_gap = ReducedFrequencyRange::covering(parts).unwrap();
    let mut told = [0; 2];
    for (tenths, ratio) in (2..=24).flat_map(|f| [0.003, 0.08].map(|ratio| (f, ratio))) {
        let mut section = SectionModel::table_4_1();
        section.vertical.frequency_hz = Some(0.1 * f64::from(tenths));
        section.vertical.damping_ratio = ratio;
        let coupled = CoupledSection::with_model(&section.structure().unwrap(), &plate).unwrap();
        let found = find_onset("plate", &coupled, &SEARCH, None).unwrap();
        let speed_max_m_s = found.critical_speed_m_s().unwrap_or(SEARCH.speed_max_m_s);
        let up_to = |speeds| OnsetSearch {
            speed_max_m_s,
            speeds,
        };
        for tested in [whole, with_gap] {
            let few = left_tests(&coupled, &up_to(4), tested).unwrap();
            let (many, _) = judged_speeds(&coupled, &up_to(200), Some(tested)).unwrap();
            let leaves = many.to_m_s < speed_max_m_s * (1.0 - 1e-6);
            assert_eq!(
                few.is_some(),
                leaves,
                "{tenths}, {ratio}: {few:?}, {many:?}"
            );
            told[usize::from(leaves)] += 1;
        }
    }
    assert!(told.iter().all(|times| *times > 10), "{told:?}");
}
