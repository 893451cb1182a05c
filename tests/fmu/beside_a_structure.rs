//! The forces of a section beside a structure that steps for itself, as an explicit exchange: spectral radius of one step.

use aerodeck::aerodynamics::{RationalModel, Realizable, Realization};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::fmu::prescribed::{KnownMotion, PrescribedForces, StripFlow};
use aerodeck::fmu::variables::Dual;
use aerodeck::identification::{FrequencyFit, fit_table};
use aerodeck::section::{SectionModel, Structure, Translation};
use nalgebra::{DMatrix, DVector};

/// How motion and forces are exchanged.
#[derive(Clone, Copy)]
struct Exchange {
    /// Step, s.
    h: f64,
    /// How many of displacement, rate and acceleration the forces are given.
    known: usize,
    /// How far ahead the forces are put out, in steps.
    prediction: f64,
}

impl Exchange {
    fn new(h: f64, known: usize, prediction: f64) -> Self {
        Self {
            h,
            known,
            prediction,
        }
    }
}

/// Spectral radius of one step of an explicit (Jacobi) master: a structure holds the force that the forces put out at
/// the communication point, these take the motion of that point.
fn radius(structure: &Structure, realization: &Realization, wind: f64, exchange: Exchange) -> f64 {
    let Exchange {
        h,
        known,
        prediction,
    } = exchange;
    let n = structure.dofs.len();
    let inverse = structure.mass.clone().try_inverse().unwrap();
    let mut a = DMatrix::zeros(3 * n, 3 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n))
        .copy_from(&(-&inverse * &structure.stiffness));
    a.view_mut((n, n), (n, n))
        .copy_from(&(-&inverse * &structure.damping));
    a.view_mut((n, 2 * n), (n, n)).copy_from(&inverse);
    let exact = (a.clone() * h).exp();
    let flow = StripFlow {
        width_m: structure.width_m,
        wind_factor: 1.0,
    };
    let mut forces = PrescribedForces::new(realization.clone(), structure.dofs.clone());
    // a state begins with what all strips share: points known, wind, times of the points; then comes each strip: how far it
    // has been carried, its filters, and what is known at each point of each motion
    let (rest, shared) = (forces.rest(1), forces.rest(0).len());
    let points = shared - 2;
    let size = 2 * n + rest.len() - shared;
    let first = shared + 1 + realization.states();
    let per_point = (rest.len() - first) / (n * points);
    let mut step = |x: &[f64]| -> Vec<f64> {
        let mut state = rest.clone();
        state[shared..].copy_from_slice(&x[2 * n..]);
        (state[0], state[1]) = (points as f64, wind);
        for p in 0..points {
            state[2 + p] = -h * (1.0 + p as f64);
        }
        // the phase of samples and how many are known are no part of the linear system
        state[shared] = 0.0;
        for point in state[first..].chunks_mut(per_point) {
            point[3] = known as f64;
        }
        let mut found = vec![Dual::default(); n];
        let rho = structure.air_density_kg_m3;
        forces
            .ahead(&state, &[flow], prediction * h, rho, &mut found)
            .unwrap();
        let mut y = DVector::zeros(3 * n);
        for i in 0..n {
            (y[i], y[n + i], y[2 * n + i]) = (x[i], x[n + i], found[i].value);
        }
        let moved = &exact * &y;
        let acceleration = (&a * &y).rows(n, n).into_owned();
        let motion: Vec<_> = (0..n)
            .map(|i| KnownMotion {
                values: [y[i], y[n + i], acceleration[i]],
                known,
            })
            .collect();
        let taken = forces.take(&mut state, 0.0, wind, &motion, &[flow]);
        taken.unwrap();
        for point in state[first..].chunks_mut(per_point) {
            point[3] = 0.0;
        }
        [&moved.as_slice()[..2 * n], &state[shared..]].concat()
    };
    let mut map = DMatrix::zeros(size, size);
    for c in 0..size {
        let mut unit = vec![0.0; size];
        unit[c] = 1.0;
        map.column_mut(c).copy_from_slice(&step(&unit));
    }
    let eigenvalues = aerodeck::state_space::eigenvalues(&map).unwrap();
    eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max)
}

/// The same for a flat plate and IABSE 1.1a with `mass` times its mass, inertia and stiffness.
fn radius_of_plate(mass: f64, wind: f64, exchange: Exchange) -> f64 {
    let mut structure = SectionModel::iabse_1_1a().structure().unwrap();
    structure.mass *= mass;
    structure.damping *= mass;
    structure.stiffness *= mass;
    let realization = RationalModel::jones_flat_plate().realize();
    radius(&structure, &realization, wind, exchange)
}

/// Where a function of the wind speed becomes positive.
fn crossing(mut low: f64, mut high: f64, grows: &mut dyn FnMut(f64) -> bool) -> f64 {
    assert!(!grows(low) && grows(high), "{low} {high}");
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if grows(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

fn onset(h: f64, known: usize, prediction: f64) -> f64 {
    crossing(40.0, 110.0, &mut |wind| {
        radius_of_plate(1.0, wind, Exchange::new(h, known, prediction)) > 1.0
    })
}

/// Period of IABSE 1.1a at the onset with Jones's functions, and that onset, computed independently.
const PERIOD_S: f64 = 5.15;
const ONSET_M_S: f64 = 76.679;

/// The table of `docs/coupling.md`, in percent of the onset. Asked for at a hundredth and a fiftieth of the period: 0.1
/// and 0.5 % with displacements alone, 0.05 and 0.3 % with rates. Accelerations jump with a force that is held and gain
/// nothing.
#[test]
fn an_explicit_partner_flutters_at_the_right_speed() {
    for (parts, percent) in [
        (200.0, [0.008, 0.004, 0.015]),
        (100.0, [0.042, 0.025, 0.059]),
        (50.0, [0.260, 0.157, 0.235]),
        (25.0, [1.573, 1.039, 0.939]),
    ] {
        for (known, expected) in (1..=3).zip(percent) {
            let found = 100.0 * (onset(PERIOD_S / parts, known, 1.5) / ONSET_M_S - 1.0);
            // the printed digits, and those of the onset in one piece
            assert!(
                (found - expected).abs() < 0.0012,
                "T/{parts}, {known} known: {found}"
            );
        }
    }
    // the same force a step and a half late: on the unsafe side
    let late = onset(PERIOD_S / 100.0, 1, 0.0) / ONSET_M_S - 1.0;
    assert!((late - 0.0388).abs() < 1e-4, "{late}");
}

/// Wherever the section is stable in one piece, it is stable beside its forces.
#[test]
fn stable_below_the_onset() {
    for parts in [200.0, 100.0, 50.0, 25.0] {
        for known in 1..=3 {
            for wind in [0.0, 0.05, 1.0, 10.0, 30.0, 50.0, 70.0] {
                let radius =
                    radius_of_plate(1.0, wind, Exchange::new(PERIOD_S / parts, known, 1.5));
                // in still air the filters stay where they are
                let limit = if wind == 0.0 { 1.0 + 1e-12 } else { 1.0 };
                assert!(
                    radius < limit,
                    "T/{parts}, {known} known, {wind} m/s: {radius}"
                );
            }
        }
    }
}

/// An explicit exchange of added mass diverges for sections that are light beside it.
#[test]
fn light_sections_need_iterations() {
    let section = SectionModel::iabse_1_1a();
    let added = 0.5 * 1.22 * 31.0 * 31.0 * std::f64::consts::FRAC_PI_2;
    for known in 1..=3 {
        let (mut stable, mut diverges) = (1.0, 1e-3);
        while stable / diverges > 1.001 {
            let mass = f64::sqrt(stable * diverges);
            // one hundredth of a period of the rotation, gentle wind
            if radius_of_plate(mass, 1.0, Exchange::new(0.036, known, 1.5)) < 1.0 {
                stable = mass;
            } else {
                diverges = mass;
            }
        }
        let ratio = stable * section.vertical.mass_kg_m / added;
        // two accelerations carried on by a step and a half: weights 2.5 and 1.5 against the mass
        let expected = if known == 1 { 3.05 } else { 4.0 };
        assert!((ratio / expected - 1.0).abs() < 0.01, "{known}: {ratio}");
    }
}
/// Every measured deck on sections of both scales, with two and three motions: the onset is that of the section in one
/// piece, and slower winds are stable.
#[test]
fn measured_decks_flutter_where_their_sections_do() {
    let with_sway = |mut section: SectionModel, frequency_hz| {
        section.lateral = Some(Translation {
            frequency_hz: Some(frequency_hz),
            ..section.vertical.clone()
        });
        section
    };
    let (small, large) = (SectionModel::table_4_1(), SectionModel::iabse_1_1a());
    let sections = [
        (small.clone(), 50.0, 0.4),
        (large.clone(), 110.0, 3.6),
        (with_sway(small, 1.0), 50.0, 0.4),
        (with_sway(large, 0.05), 110.0, 3.6),
    ];
    for name in embedded::names() {
        let table = embedded::deck(name).unwrap();
        for (section, fastest, period_s) in &sections {
            let structure = section.structure().unwrap();
            let dofs = structure.dofs.clone();
            let model = fit_table(&table.samples(&dofs), &dofs, &FrequencyFit::default())
                .unwrap()
                .model;
            let coupled = CoupledSection::with_model(&structure, &model).unwrap();
            let whole = crossing(1.0, *fastest, &mut |wind| {
                let values = coupled.at(wind).unwrap().eigenvalues().unwrap();
                values.iter().any(|z| z.re > 0.0)
            });
            let realization = model.realize();
            let mut grows = |wind: f64| {
                radius(
                    &structure,
                    &realization,
                    wind,
                    Exchange::new(period_s / 100.0, 2, 1.5),
                ) > 1.0
            };
            for share in [0.002, 0.02, 0.1, 0.3, 0.6, 0.9] {
                assert!(!grows(share * whole), "{name}: {} m/s", share * whole);
            }
            let beside = crossing(0.95 * whole, 1.05 * whole, &mut grows);
            let error = beside / whole - 1.0;
            println!(
                "{name}, B {} m, {} motions: {whole:.3} {:+.3} %",
                section.width_m,
                structure.dofs.len(),
                100.0 * error
            );
            assert!(error.abs() < 1e-3, "{name}: {error}");
        }
    }
}
